"""Facts about an imported mesh before anything is solved: parts, volumes, masses, size, rigid motions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph

from stickslip.core.plausible import OddValue, odd_value
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.shapes import consistent_mass

_CELLS_AT_ONCE = 5000  # chosen to bound the memory
# chosen: ranges of solid machine parts, with a wide margin; values outside are most likely in another unit.
DENSITY_RANGE = (100.0, 30_000.0)  # kg/m3
MODULUS_RANGE = (1e6, 2e12)  # Pa
SIZE_RANGE = (1e-4, 1e2)  # m, diagonal of the bounding box
MASS_RANGE = (1e-6, 1e6)  # kg, of a body
FREQUENCY_RANGE = (1.0, 1e7)  # Hz, half a wave of compression along the diagonal of the bounding box
NODE_FREQUENCY_RANGE = (1.0, 1e9)  # Hz, a node of matrices against its neighbours: compression along one element


def connected_parts(cells: Sequence[IntArray]) -> IntArray:
    """Number of the part (m,) of each cell of all arrays (m, k); cells that share a node belong to one part."""
    size = 1 + max(int(block.max()) for block in cells if block.size)
    rows = np.concatenate([np.repeat(block[:, 0], block.shape[1] - 1) for block in cells])
    columns = np.concatenate([block[:, 1:].ravel() for block in cells])
    graph = scipy.sparse.coo_matrix((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(size, size))
    _, part_of_node = scipy.sparse.csgraph.connected_components(graph, directed=False)
    part = part_of_node[np.concatenate([block[:, 0] for block in cells])]
    _, first, position = np.unique(part, return_index=True, return_inverse=True)
    # numbered in the order of their first cells
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[position.ravel()]


def bounding_box(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Smallest and largest coordinates (3,), (3,) of points (n, 3)."""
    return points.min(axis=0), points.max(axis=0)


def body_volumes(mesh: Mesh) -> FloatArray:
    """(n_bodies,) m3, by the quadrature of the mass, so that density times volume is the mass of the model."""
    volume = np.zeros(len(mesh.body_names))
    for block in mesh.blocks:
        for start in range(0, len(block.cells), _CELLS_AT_ONCE):
            part = slice(start, start + _CELLS_AT_ONCE)
            cell_volume = consistent_mass(mesh.points[block.cells[part]], 1.0).sum(axis=(1, 2))
            np.add.at(volume, block.body[part], cell_volume)
    return volume


def size_oddities(points: FloatArray) -> Iterator[OddValue]:
    """Extents of points (n, 3) m that only a wrong unit explains."""
    low, high = bounding_box(points)
    diagonal = float(np.linalg.norm(high - low))
    yield from odd_value("the model's bounding box has the diagonal", diagonal, "m", SIZE_RANGE, "the length unit")


def material_oddities(about: str, material: Material, cause: str, section: str = "") -> Iterator[OddValue]:
    """Values of density and modulus that only a wrong unit explains; ``section`` is that of the study file, if any."""
    density, modulus = (f"{section}.{key}" if section else "" for key in ("density", "young_modulus"))
    yield from odd_value(f"{about} has the density", material.density, "kg/m3", DENSITY_RANGE, cause, density)
    words = f"{about} has Young's modulus"
    yield from odd_value(words, material.young_modulus, "Pa", MODULUS_RANGE, cause, modulus)


def wave_oddities(about: str, material: Material, points: FloatArray) -> Iterator[OddValue]:
    """Frequencies of a body with the nodes (n, 3) m that only a wrong unit explains."""
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    wave = float(np.sqrt(material.young_modulus / material.density)) / (2.0 * size)
    words = f"{about} has estimated frequencies of compression of about"
    yield from odd_value(words, wave, "Hz", FREQUENCY_RANGE, "the units")


def model_oddities(mesh: Mesh, materials: Mapping[str, Material]) -> Iterator[OddValue]:
    """Sizes, densities, moduli, masses and frequencies of a model file that only wrong units can explain."""
    yield from size_oddities(mesh.points)
    volumes = dict(zip(mesh.body_names, body_volumes(mesh), strict=True))
    for name, material in materials.items():
        about = f"body '{name}'"
        yield from material_oddities(about, material, "the unit system")
        nodes = mesh.nodes_of_body(mesh.body_names.index(name))
        yield from odd_value(f"{about} has the mass", material.density * volumes[name], "kg", MASS_RANGE, "the units")
        yield from wave_oddities(about, material, mesh.points[nodes])


def matrix_oddities(
    stiffness_diagonal: FloatArray, mass_diagonal: FloatArray, moving_mass: float, places: FloatArray | None
) -> Iterator[OddValue]:
    """Size, mass and frequencies of matrices that only wrong units can explain.

    Diagonals (n,) in N/m and kg of displacements, the mass that moves along an axis in kg, optional positions (k, 3) m.
    """
    units = "structure.length_unit and structure.unit_system"
    if places is not None and len(places) > 1:
        diagonal = float(np.linalg.norm(np.ptp(places, axis=0)))
        yield from odd_value("the nodes of the matrices span", diagonal, "m", SIZE_RANGE, units)
    yield from odd_value("the matrices contain the mass", moving_mass, "kg", MASS_RANGE, units)
    heavy = mass_diagonal > 0.0
    if heavy.any():
        typical = float(np.sqrt(np.median(stiffness_diagonal[heavy] / mass_diagonal[heavy]))) / (2.0 * np.pi)
        words = "a typical node of the matrices, with fixed neighbours, vibrates at about"
        yield from odd_value(words, typical, "Hz", NODE_FREQUENCY_RANGE, units)
