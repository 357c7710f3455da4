"""From file to joint at rest: the two blades in about 100,000 unknowns of quadratic tetrahedra, with both factors.

``python benchmarks/tetrahedral_mesh.py [superlu] [pardiso]``: each in a process of its own, with its peak memory.
Seconds are shown as wall / processor time; the second one, over all threads, is little disturbed by other work on the
machine. The mesh is made of bricks that are cut into six tetrahedra each, so no mesh generator is needed.
"""

from __future__ import annotations

import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import meshio
import numpy as np
from both_factors import with_each_factor

from stickslip.case.case import Case
from stickslip.model.kinds.two_blade_geometry import BladePairElements
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.model.model import connect, load_joint, set_up
from stickslip.model.study_structure import ReducedStructure
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.factor import Backend
from stickslip.structure.mesh import Mesh

Answer = TypeVar("Answer")

ELEMENTS = BladePairElements(
    shank_columns=4,
    shank_rows=16,
    platform_rows=5,
    airfoil_rows=54,
    inner_columns=3,
    contact_columns=2,
    chordwise=5,
    damper_columns=4,
    damper_flank_rows=2,
)
# Quadratic sides have midside nodes, so 2 x 5 of them have the 110 pairs of the default case's 4 x 10.
BODIES = ("left_blade", "right_blade", "damper")
FACES = {"left_face": 0, "right_face": 1, "damper_left_face": 2, "damper_right_face": 2}
# Corners of the six tetrahedra of a brick around its diagonal 0-6: neighbours are cut along the same lines.
_TETRAHEDRA = np.array([[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]])
_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
_SIDES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))


def quadratic_tetrahedra(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, cells (m, 10) and body (m,) of a mesh of bricks."""
    corners = mesh.cells[:, _TETRAHEDRA].reshape(-1, 4)
    edges = np.sort(corners[:, _EDGES].reshape(-1, 2), axis=1)
    ends, number = np.unique(edges, axis=0, return_inverse=True)
    middles = mesh.n_nodes + number.reshape(len(corners), 6)
    points = np.vstack([mesh.points, mesh.points[ends].mean(axis=1)])
    return points, np.hstack([corners, middles]), np.repeat(mesh.body, 6)


def write_model(path: Path) -> None:
    """A Gmsh file in mm with three bodies, four contact faces, the roots and the damper's bottom, and two points."""
    bricks = blade_pair_mesh(elements=ELEMENTS)
    points, cells, body = quadratic_tetrahedra(bricks)
    blocks: list[tuple[str, np.ndarray]] = [("tetra10", cells[body == number]) for number in range(len(BODIES))]
    names = [(name, 3) for name in BODIES]

    def add_face(name: str, part: int, nodes: np.ndarray) -> None:
        sides = cells[body == part][:, _SIDES].reshape(-1, 3)
        blocks.append(("triangle", sides[np.isin(sides, nodes).all(axis=1)]))
        names.append((name, 2))

    for name, part in FACES.items():
        add_face(name, part, bricks.node_set(name))
    add_face("left_root", 0, bricks.node_set("fixed"))
    add_face("right_root", 1, bricks.node_set("fixed"))
    damper = np.unique(bricks.cells[bricks.body == 2])
    height = bricks.points[damper, 2]
    add_face("damper_bottom", 2, damper[height < height.min() + 1e-9])
    for name in ("excitation_left", "response"):
        blocks.append(("vertex", bricks.node_set(name)[:, None]))
        names.append((name, 0))
    tags = [np.full(len(block), number) for number, (_, block) in enumerate(blocks, start=1)]
    meshio.Mesh(
        1e3 * points,
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array([number, dim]) for number, (name, dim) in enumerate(names, start=1)},
    ).write(path, file_format="gmsh22", binary=True)


def study(path: Path) -> Case:
    """The study of the file, with a solved preload."""
    sides = {"left": ("damper_left_face", "left_face"), "right": ("damper_right_face", "right_face")}
    return Case.from_mapping(
        {
            "structure": {
                "kind": "mesh",
                "file": str(path),
                "length_unit": "mm",
                "fixed": ["left_root", "right_root"],
            },
            "material": {"young_modulus": "197 GPa", "poisson_ratio": 0.3, "density": "7800 kg/m^3"},
            "roughness": {"sq": "1 um", "sample_length": "0.8 mm"},
            "interfaces": {name: {"first": first, "second": second} for name, (first, second) in sides.items()},
            "forces": {"engine": {"set": "excitation_left", "direction": [1, 0, 0], "amplitude": "300 N"}},
            "responses": {"tip": {"set": "response", "direction": [1, 0, 0]}},
            "static_loads": {
                "wedge": {"set": "damper_bottom", "spread": "area", "direction": [0, 0, 1], "force": "500 N"}
            },
            "preload": {"method": "solved"},
            "solver": {"frequency_start": "400 Hz", "frequency_stop": "530 Hz"},
        }
    )


def measure(backend: Backend, threads: int = 2) -> dict[str, float | str]:
    """Sizes, seconds (wall / processor) of each step, and peak memory."""
    row: dict[str, Any] = {"factor": backend}

    def timed(name: str, step: Callable[[], Answer]) -> Answer:
        wall, processor = time.perf_counter(), time.process_time()
        answer = step()
        row[f"{name} s"] = f"{time.perf_counter() - wall:.1f} / {time.process_time() - processor:.1f}"
        row[f"{name}, peak GB so far"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        return answer

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "two_blades.msh"
        write_model(path)
        row["file MB"] = path.stat().st_size / 1e6
        case = study(path)
        setup = timed("import and pairing", lambda: set_up(case))
    structure = timed("assembly", setup.assemble)
    layout = setup.layout
    row |= {"elements": setup.mesh.n_cells, "unknowns": structure.stiffness.shape[0]}
    row |= {"matrix entries, million": structure.stiffness.nnz / 1e6, "pairs": layout.face_pairs.n_pairs}
    superelement = timed(
        "reduction",
        lambda: craig_bampton(structure, layout.boundary_nodes, case.reduction.modes, backend, threads),
    )
    row["reduced unknowns"] = superelement.size
    reduced = ReducedStructure.of_superelement(superelement, layout)
    joint = load_joint(case, layout)
    model = timed("static preload", lambda: connect(case, reduced, joint))
    assert model.preload is not None
    row["pairs closed at rest"] = int((model.preload.state.normal_force > 0.0).sum())
    return row


if __name__ == "__main__":
    with_each_factor(__file__, measure)
