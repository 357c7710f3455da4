"""Fixtures of meshes, for tests of structures and of the two blades."""

import csv
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from solid_cells import CORNERS
from stickslip.contact.pairing.pairing import FacePairs, pair_faces
from stickslip.core.validation import FloatArray
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Material, Structure, assemble
from stickslip.structure.mesh import Mesh
from stickslip.structure.superelement import Superelement

DATA = Path(__file__).parent / "data"


def brick_block(counts: Sequence[int], lengths: Sequence[float], distortion: float = 0.0) -> Mesh:
    """A free block of bricks; every node is moved at random by up to ``distortion`` element sizes."""
    axes = [np.linspace(0.0, length, count + 1) for count, length in zip(counts, lengths, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    size = np.array(lengths) / np.array(counts)
    points = points + distortion * size * np.random.default_rng(7).uniform(-1.0, 1.0, points.shape)
    number = np.arange(points[..., 0].size).reshape(points.shape[:3])
    offset = ((CORNERS + 1) / 2).astype(int)
    nx, ny, nz = counts
    corners = [number[i : nx + i, j : ny + j, k : nz + k].ravel() for i, j, k in offset]
    return Mesh(points.reshape(-1, 3), np.stack(corners, axis=1), node_sets={"all": number.ravel()})


@pytest.fixture(scope="session")
def make_block() -> Callable[..., Mesh]:
    return brick_block


@pytest.fixture(scope="session")
def reference_mesh() -> dict[str, np.ndarray]:
    with np.load(DATA / "two_blade_mesh.npz") as data:
        return dict(data)


@pytest.fixture(scope="session")
def reference_frequencies() -> dict[str, FloatArray]:
    with open(DATA / "two_blade_frequencies.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name.endswith("_hz")}


@pytest.fixture(scope="session")
def blade_mesh() -> Mesh:
    return blade_pair_mesh()


@pytest.fixture(scope="session")
def pairs_of() -> Callable[[Mesh], FacePairs]:
    def both_faces(mesh: Mesh) -> FacePairs:
        sides = ("left", "right")
        return FacePairs.concatenate([pair_faces(mesh, f"damper_{side}_face", f"{side}_face") for side in sides])

    return both_faces


@pytest.fixture(scope="session")
def blade_structure(blade_mesh: Mesh) -> Structure:
    return assemble(blade_mesh, Material())


@pytest.fixture(scope="session")
def blade_superelement(
    blade_mesh: Mesh, blade_structure: Structure, pairs_of: Callable[[Mesh], FacePairs]
) -> Superelement:
    points = [blade_mesh.node_set(name) for name in ("excitation_left", "excitation_right", "response")]
    return craig_bampton(blade_structure, np.concatenate([pairs_of(blade_mesh).nodes, *points]), n_modes=30)


@pytest.fixture(scope="module")
def held_block(make_block: Callable[..., Mesh]) -> Structure:
    return assemble(make_block((4, 2, 2), (2.0, 1.0, 1.0)), Material(), fixed_nodes=np.arange(9))
