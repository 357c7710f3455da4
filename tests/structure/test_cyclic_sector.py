import os
import re
import shutil
import subprocess
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers import absent_tool
from sectors import SmallDisk, annulus
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.structure.constraints import eliminate
from stickslip.structure.cyclic_sector import (
    CyclicSector,
    LaggedMatrices,
    nodal_diameters,
)
from stickslip.structure.elasticity import Material, assemble, natural_frequencies
from stickslip.structure.equations import Equations
from stickslip.structure.mesh import Mesh
from stickslip.structure.sector_boundaries import cyclic_symmetry
from stickslip.structure.sector_reduction import cyclic_sector, sector_frequencies

STEEL = Material(200e9, 0.33, 7850.0)
SECTORS, RADII, THICKNESS, COUNTS = 6, (0.05, 0.2), 0.02, (3, 2, 1)


def clamped(mesh: Any, element: Any = "incompatible") -> Any:
    if element == "serendipity":
        mesh = mesh.quadratic()
    inner = np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < mesh.points[mesh.node_sets["inner"][0], 0] + 1e-9
    return assemble(mesh, STEEL, element, np.flatnonzero(inner))


def boundaries(structure: Any, sectors: Any) -> tuple[Any, Any]:
    """Nodes of the left and of the right boundary, those between the corners included."""
    x, y, _ = structure.mesh.points.T
    angle = np.arctan2(y, x)
    return np.flatnonzero(np.abs(angle) < 1e-9), np.flatnonzero(np.abs(angle - 2.0 * np.pi / sectors) < 1e-9)


@pytest.fixture(scope="module")
def sector() -> Any:
    return clamped(annulus(SECTORS, RADII, THICKNESS, COUNTS, of=1))


@pytest.fixture(scope="module")
def ring_hz() -> Any:
    ring = clamped(annulus(SECTORS, RADII, THICKNESS, COUNTS, of=SECTORS))
    return natural_frequencies(ring.stiffness, ring.mass, 24)[0]


def of_all_diameters(frequencies: Any, sectors: Any, count: Any) -> Any:
    """The lowest frequencies of a ring from those of its nodal diameters: waves in both directions are two modes."""
    both = [np.repeat(hz, 1 if 2 * diameter % sectors == 0 else 2) for diameter, hz in frequencies.items()]
    return np.sort(np.concatenate(both))[:count]


def symmetry_of(structure: Any) -> Any:
    return cyclic_symmetry(structure.mesh.points, *boundaries(structure, SECTORS))


@pytest.mark.slow
def test_the_frequencies_of_all_nodal_diameters_are_those_of_the_ring(sector: Any, ring_hz: Any) -> None:
    symmetry = cyclic_symmetry(sector.mesh.points, *boundaries(sector, SECTORS))
    found = sector_frequencies(sector, symmetry, range(4), 8)
    np.testing.assert_allclose(of_all_diameters(found, SECTORS, 24), ring_hz, rtol=1e-8)


def test_a_reduction_with_all_modes_has_the_frequencies_of_the_ring(sector: Any, ring_hz: Any) -> None:
    _, right = boundaries(sector, SECTORS)
    free = sector.free_unknowns.size - 3 * np.setdiff1d(right, sector.fixed_nodes).size
    # All but the highest two, which an iteration for complex matrices cannot give.
    reduced = cyclic_sector(sector, symmetry_of(sector), tip_nodes(sector), n_modes=free - 6 - 2)
    found = {diameter: reduced.natural_frequencies(diameter, 8) for diameter in reduced.diameters}
    np.testing.assert_allclose(of_all_diameters(found, SECTORS, 12), ring_hz[:12], rtol=1e-8)


def tip_nodes(structure: Any) -> Any:
    """Two nodes at the rim, off the boundaries."""
    x, y, _ = structure.mesh.points.T
    rim = np.hypot(x, y) > 0.999 * np.hypot(x, y).max()
    inside = (np.arctan2(y, x) > 0.1) & (np.arctan2(y, x) < 2.0 * np.pi / SECTORS - 0.1)
    return np.flatnonzero(rim & inside)[:2]


@pytest.mark.slow
def test_a_reduction_with_few_modes_is_above_the_ring_and_close(sector: Any, ring_hz: Any) -> None:
    reduced = cyclic_sector(sector, symmetry_of(sector), tip_nodes(sector), n_modes=12)
    found = of_all_diameters({d: reduced.natural_frequencies(d, 4) for d in reduced.diameters}, SECTORS, 8)
    assert (found > ring_hz[:8] * (1.0 - 1e-10)).all()
    np.testing.assert_allclose(found, ring_hz[:8], rtol=1e-3)
    assert reduced.size == 6 + 12
    assert "6 sectors, 18 unknowns" in repr(reduced)


@pytest.mark.slow
def test_the_static_response_of_a_reduction_is_that_of_the_ring(sector: Any) -> None:
    nodes = tip_nodes(sector)
    reduced = cyclic_sector(sector, symmetry_of(sector), nodes, n_modes=3)
    ring = clamped(annulus(SECTORS, RADII, THICKNESS, COUNTS, of=SECTORS))
    symmetry = reduced.symmetry
    assert symmetry is not None
    force, waves = np.array([3.0, -2.0, 5.0]), 2
    load = np.zeros(ring.stiffness.shape[0], dtype=complex)
    lag = np.exp(2j * np.pi * waves / SECTORS)
    for ahead in range(SECTORS):
        place = symmetry.rotated(sector.mesh.points[nodes[:1]], ahead)
        node = int(np.linalg.norm(ring.mesh.points - place, axis=1).argmin())
        load[ring.unknowns_of([node])[0]] = lag**ahead * (symmetry.rotation(ahead) @ force)
    motion = np.linalg.solve(ring.stiffness.toarray(), load)
    here = int(np.linalg.norm(ring.mesh.points - sector.mesh.points[nodes[1]], axis=1).argmin())
    own = np.linalg.solve(reduced.lagged(waves).stiffness, np.append(force, np.zeros(6)))
    np.testing.assert_allclose(own[3:6], motion[ring.unknowns_of([here])[0]], rtol=1e-7)


@pytest.mark.slow
def test_calculix_has_the_same_frequencies(tmp_path: Any) -> None:
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    plate = clamped(annulus(SECTORS, RADII, THICKNESS, COUNTS, of=1), "serendipity")
    left, right = (np.setdiff1d(nodes, plate.fixed_nodes) for nodes in boundaries(plate, SECTORS))
    mesh = replace(plate.mesh, node_sets={"left": left, "right": right})
    deck = write_calculix_deck(tmp_path / "sector.inp", mesh, STEEL, fixed_nodes=plate.fixed_nodes)
    model = deck.read_text().partition("*STEP")[0]
    deck.write_text(
        f"{model}*SURFACE, NAME=dependent, TYPE=NODE\nset_right\n*SURFACE, NAME=independent, TYPE=NODE\nset_left\n"
        "*TIE, CYCLIC SYMMETRY, NAME=both, POSITION TOLERANCE=1e-6\ndependent, independent\n"
        f"*CYCLIC SYMMETRY MODEL, N={SECTORS}, TIE=both\n0, 0, 0, 0, 0, 1\n"
        "*STEP\n*FREQUENCY\n8\n*SELECT CYCLIC SYMMETRY MODES, NMIN=0, NMAX=3\n*END STEP\n"
    )
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    subprocess.run(
        [str(program), "-i", "sector"], cwd=tmp_path, check=True, capture_output=True, timeout=60, env=environment
    )
    pattern = r"^\s+(\d+)\s+\d+" + 4 * r"\s+(\d\.\d+E[+-]\d+)" + r"\s*$"
    table = re.findall(pattern, (tmp_path / "sector.dat").read_text(), flags=re.MULTILINE)
    symmetry = cyclic_symmetry(plate.mesh.points, *boundaries(plate, SECTORS))
    own = sector_frequencies(plate, symmetry, range(4), 4)
    for diameter, expected in own.items():
        theirs = np.sort([float(row[3]) for row in table if int(row[0]) == diameter])
        np.testing.assert_allclose(theirs[::2], expected, rtol=1e-5)  # CalculiX lists the waves in both directions


def test_a_wave_backward_has_conjugate_matrices() -> None:
    sector = SmallDisk.of(6).sector
    for forward, backward in ((1, 5), (2, -2), (8, -8)):
        for name in ("mass", "stiffness", "damping"):
            one, other = (getattr(sector.lagged(waves), name) for waves in (forward, backward))
            np.testing.assert_array_equal(one, other.conj())
    assert sector.lagged(3) is sector.lagged(9)
    assert np.isrealobj(sector.lagged(3).stiffness)


def test_rayleigh_damping() -> None:
    sector = SmallDisk.of(6, damped=False).sector.with_rayleigh_damping(2.0, 3e-6)
    matrices = sector.lagged(-1)
    assert matrices.damping is not None
    np.testing.assert_allclose(matrices.damping, 2.0 * matrices.mass + 3e-6 * matrices.stiffness)
    with rejects(InputError, "mass_factor", "stiffness_factor"):
        sector.with_rayleigh_damping(-1.0, 0.0)


def test_rows_of_boundary_nodes(sector: Any) -> None:
    nodes = tip_nodes(sector)
    reduced = cyclic_sector(sector, symmetry_of(sector), nodes, n_modes=2, diameters=[1])
    row = reduced.selector(int(nodes[1]), (0.0, 1.0, 0.0))
    assert np.flatnonzero(row).tolist() == [4]
    assert row.size == 2 * reduced.size
    ahead = reduced.selector(int(nodes[1]), (0.0, 1.0, 0.0), of_next=True)
    np.testing.assert_allclose(ahead[reduced.size + 3 : reduced.size + 6], [np.sqrt(0.75), 0.5, 0.0])
    with rejects(InputError, "node"):
        reduced.selector(0, (1.0, 0.0, 0.0))
    with rejects(InputError, "of_next"):
        replace(reduced, symmetry=None).selector(int(nodes[1]), (0.0, 1.0, 0.0), of_next=True)


@pytest.mark.slow
def test_the_nodal_diameter_diagram(sector: Any) -> None:
    reduced = cyclic_sector(sector, symmetry_of(sector), tip_nodes(sector), n_modes=2)
    axes = reduced.plot(3, speed_rpm=6000.0).axes[0]
    *families, orders = (np.asarray(line.get_xydata()) for line in axes.lines)
    for number, line in enumerate(families):
        expected = [[d, reduced.natural_frequencies(d)[number]] for d in range(4)]
        np.testing.assert_allclose(line, expected)
    assert len(families) == 3
    np.testing.assert_allclose(orders[:8], np.transpose([[0, 1, 2, 3, 2, 1, 0, 1], 100.0 * np.arange(8)]))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Nodal diameter of 6 sectors", "Frequency, Hz")
    with rejects(InputError, "count"):
        reduced.plot(9)
    with rejects(InputError, "speed_rpm"):
        reduced.plot(3, speed_rpm=0.0)


def test_nodal_diameters_of_an_engine_order() -> None:
    assert nodal_diameters(24, 4) == (0, 4, 8, 12)
    assert nodal_diameters(24, 20) == (0, 4, 8, 12)
    assert nodal_diameters(24, 4, 1) == (0, 4)
    assert nodal_diameters(7, 0) == (0,)
    assert nodal_diameters(5, 2) == (0, 1, 2)


def test_the_progress_names_the_diameters(sector: Any) -> None:
    seen = []
    nodes = tip_nodes(sector)
    cyclic_sector(
        sector, symmetry_of(sector), nodes, diameters=[0, 2], n_modes=1,
        progress=lambda fraction, words: seen.append((fraction, words)),
    )  # fmt: skip
    assert [fraction for fraction, _ in seen] == sorted(fraction for fraction, _ in seen)
    assert {words.split(":")[0] for _, words in seen} == {"nodal diameter 0", "nodal diameter 2"}


def test_a_node_constrained_on_one_boundary_only(sector: Any) -> None:
    left, _ = boundaries(sector, SECTORS)
    loose = np.setdiff1d(left, sector.fixed_nodes)
    wrong = assemble(sector.mesh, STEEL, fixed_nodes=np.append(sector.fixed_nodes, loose[:1]))
    with rejects(InputError, "left", "right"):
        cyclic_sector(wrong, symmetry_of(wrong), tip_nodes(sector))


def test_a_boundary_node_of_the_right_boundary(sector: Any) -> None:
    _, right = boundaries(sector, SECTORS)
    with rejects(InputError, "boundary_nodes"):
        cyclic_sector(sector, symmetry_of(sector), np.setdiff1d(right, sector.fixed_nodes)[:1])


@pytest.mark.parametrize("diameters", [[4], [-1], [0.5]])
def test_a_nodal_diameter_that_the_disk_does_not_have(sector: Any, diameters: Any) -> None:
    with rejects(InputError, "diameters"):
        cyclic_sector(sector, symmetry_of(sector), tip_nodes(sector), diameters=diameters)


def test_a_body_without_support(sector: Any) -> None:
    mesh = annulus(SECTORS, RADII, THICKNESS, (2, 1, 1), of=1)
    loose = mesh.points[mesh.cells[0]] + [0.0, 0.0, 1.0]
    cells = np.vstack([mesh.cells, mesh.n_nodes + np.arange(8)])
    both = assemble(Mesh(np.vstack([mesh.points, loose]), cells), STEEL, fixed_nodes=mesh.node_sets["inner"])
    left, right = mesh.node_sets["left"], mesh.node_sets["right"]
    symmetry = cyclic_symmetry(both.mesh.points, left, right)
    rim = np.setdiff1d(left, mesh.node_sets["inner"])[:1]
    with rejects(InputError):
        cyclic_sector(both, symmetry, rim, diameters=[1], n_modes=2)


def test_a_reduction_without_a_diameter(sector: Any) -> None:
    reduced = cyclic_sector(sector, symmetry_of(sector), tip_nodes(sector), diameters=[0, 1], n_modes=2)
    with rejects(InputError, "diameters"):
        reduced.natural_frequencies(2)


def test_a_sector_with_ties(sector: Any) -> None:
    equations = Equations(sector.mesh.n_nodes)
    equations.add([(0, -1.0), (3, 1.0)], 0, equations.owner("one"))
    tied = replace(sector, constraints=eliminate(equations))
    with rejects(InputError, "structure"):
        sector_frequencies(tied, symmetry_of(sector), [0], 2)


def test_matrices_that_are_no_sector() -> None:
    one = np.eye(3)
    with rejects(InputError, "diameters"):
        CyclicSector(4, {}, np.empty(0, dtype=int))
    with rejects(InputError, "diameters"):
        both = {0: LaggedMatrices(one, one), 1: LaggedMatrices(one[:2, :2], one[:2, :2])}
        CyclicSector(4, both, np.empty(0, dtype=int))
    with rejects(InputError, "diameters"):
        CyclicSector(4, {0: LaggedMatrices(one, np.triu(np.ones((3, 3))))}, np.empty(0, dtype=int))
    with rejects(InputError, "diameters"):
        CyclicSector(4, {0: LaggedMatrices(one, one, one[:2, :2])}, np.empty(0, dtype=int))
    with rejects(InputError, "left", "right"):
        CyclicSector.of_matrices(one, one, left=[0, 1], right=[2], sectors=4)
    with rejects(InputError, "right"):
        CyclicSector.of_matrices(one, one, left=[0], right=[3], sectors=4)


@pytest.mark.parametrize("name", ["mass", "stiffness", "damping"])
def test_a_sector_is_no_structure_of_other_analyses(name: Any) -> None:
    with rejects(InputError, "superelement"):
        getattr(SmallDisk.of(6).sector, name)
