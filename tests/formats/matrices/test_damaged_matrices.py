"""Damaged files: a sentence that names the file, or the model that was written; never a traceback or another model."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from matrix_writers import MAPS, WRITERS
from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.matrices.exchange import read_superelement, write_superelement
from stickslip.formats.matrices.read import read_matrices
from stickslip.structure.superelement import Superelement

CUTS = 25


@pytest.fixture
def good(tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> tuple[Path, None, Path]:
    """A mass and a map that are in order; what is damaged is the stiffness."""
    np.save(tmp_path / "m.npy", small[1])
    (tmp_path / "map.csv").write_text(MAPS["map.csv"]())
    return tmp_path / "m.npy", None, tmp_path / "map.csv"


def damaged_versions(content: bytes, seed: int) -> Iterator[bytes]:
    """Shuffled lines and blocks, changed bytes, and bytes at random, from a fixed seed."""
    random = np.random.default_rng(seed)
    lines = content.splitlines(keepends=True)
    for _ in range(6):
        yield b"".join(lines[i] for i in random.permutation(len(lines)))
        blocks = [content[at : at + 64] for at in range(0, len(content), 64)]
        yield b"".join(blocks[i] for i in random.permutation(len(blocks)))
        changed = bytearray(content)
        for at in random.integers(0, len(content), 8):
            changed[at] = random.integers(0, 256)
        yield bytes(changed)
        head = int(random.integers(0, min(400, len(content))))
        yield content[:head] + random.bytes(200)
        yield random.bytes(300)


@pytest.mark.slow
@pytest.mark.parametrize("kind", WRITERS)
def test_a_truncated_file_is_rejected_or_complete(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], good: tuple[Path, None, Path], kind: str
) -> None:
    suffix, write = WRITERS[kind]
    path = tmp_path / f"k{suffix}"
    write(path, small[0])
    content = path.read_bytes()
    rejected = 0
    for at in np.unique(np.linspace(0, len(content) - 1, CUTS).astype(int)):
        path.write_bytes(content[:at])
        try:
            model = read_matrices(path, *good)
        except ImportFileError as error:
            assert path.name in str(error)  # noqa: PT017  a damaged file may also give a valid model
            rejected += 1
        else:
            np.testing.assert_allclose(model.stiffness.toarray(), small[0], atol=1e-12 * np.abs(small[0]).max())
    assert rejected >= CUTS - 2


@pytest.mark.slow
@pytest.mark.parametrize("kind", WRITERS)
def test_a_shuffled_or_binary_file_is_rejected_by_a_sentence(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], good: tuple[Path, None, Path], kind: str
) -> None:
    suffix, write = WRITERS[kind]
    path = tmp_path / f"k{suffix}"
    write(path, small[0])
    content = path.read_bytes()
    for damaged in damaged_versions(content, seed=len(kind)):
        path.write_bytes(damaged)
        try:
            model = read_matrices(path, *good)
        except ImportFileError as error:
            assert path.name in str(error)  # noqa: PT017  a damaged file may also give a valid model
        else:  # a digit that changed cannot be seen; the model must still be one
            assert model.stiffness.shape == (36, 36)
            assert np.isfinite(model.stiffness.data).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", MAPS)
def test_damaged_maps(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], good: tuple[Path, None, Path], name: str
) -> None:
    np.save(tmp_path / "k.npy", small[0])
    content = MAPS[name]().encode()
    path = tmp_path / name
    cuts = [content[:at] for at in range(0, len(content) - 1, 7)]
    for damaged in cuts:
        path.write_bytes(damaged)
        with rejects(ImportFileError, "unknown_map"):
            read_matrices(tmp_path / "k.npy", good[0], unknown_map=path)
    for damaged in damaged_versions(content, seed=1):
        path.write_bytes(damaged)
        with contextlib.suppress(ImportFileError):
            model = read_matrices(tmp_path / "k.npy", good[0], unknown_map=path)
            assert len(set(zip(model.node, model.direction, strict=True))) == 36


@pytest.mark.slow
def test_a_damaged_superelement(tmp_path: Path) -> None:
    element = Superelement(np.eye(8), 2.0 * np.eye(8), boundary_nodes=np.array([7, 3]))
    path = write_superelement(tmp_path / "part.npz", element)
    content = path.read_bytes()
    for at in range(0, len(content) - 1, 37):
        path.write_bytes(content[:at])
        with rejects(ImportFileError):
            read_superelement(path)
    for damaged in damaged_versions(content, seed=2):
        path.write_bytes(damaged)
        try:
            actual = read_superelement(path)
        except ImportFileError as error:
            assert path.name in str(error)  # noqa: PT017  a damaged file may also give a valid model
        else:
            np.testing.assert_array_equal(actual.stiffness, element.stiffness)
