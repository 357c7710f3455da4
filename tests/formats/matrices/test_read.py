"""Every kind of file gives the same model; wrong content is refused by a sentence with file and line or entry."""

import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
import scipy.sparse

from helpers import absent_tool
from matrix_writers import MAPS, NODES, WRITERS, coordinates, write_calculix, write_harwell_boeing, write_op4_text
from sentences import rejects
from stickslip.core.errors import ImportFileError, InputError, MissingPackageError
from stickslip.formats.matrices.read import read_matrices


def written(tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], kind: str) -> tuple[Path, Path]:
    """Paths of stiffness and mass in one kind of file."""
    suffix, write = WRITERS[kind]
    paths = (tmp_path / f"k{suffix}", tmp_path / f"m{suffix}")
    for path, matrix in zip(paths, small[:2], strict=True):
        write(path, matrix)
    return paths


@pytest.mark.slow
@pytest.mark.parametrize("kind", WRITERS)
def test_every_kind_of_file_gives_the_same_model(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], kind: str
) -> None:
    (tmp_path / "map.csv").write_text(MAPS["map.csv"]())
    model = read_matrices(*written(tmp_path, small, kind), unknown_map=tmp_path / "map.csv")
    for actual, matrix in zip((model.stiffness, model.mass), small[:2], strict=True):
        np.testing.assert_allclose(actual.toarray(), matrix, atol=1e-12 * np.abs(matrix).max())
    np.testing.assert_array_equal(model.node, np.repeat(NODES, 3))
    np.testing.assert_array_equal(model.direction, np.tile([0, 1, 2], 12))
    # a triangle that was completed is told, and only that
    half = kind in ("Matrix Market", "Matrix Market array", "CalculiX", "RSA")
    assert [("triangle" in message) for message in model.messages] == [True] * (2 * half)


@pytest.mark.parametrize("name", MAPS)
def test_every_kind_of_map_names_the_same_unknowns(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], name: str
) -> None:
    (tmp_path / name).write_text(MAPS[name]())
    model = read_matrices(*written(tmp_path, small, "npy"), unknown_map=tmp_path / name)
    np.testing.assert_array_equal(model.node, np.repeat(NODES, 3))
    np.testing.assert_array_equal(model.direction, np.tile([0, 1, 2], 12))


def test_the_map_beside_the_matrix_is_found_and_without_one_unknowns_are_numbered(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> None:
    paths = written(tmp_path, small, "CalculiX")
    bare = read_matrices(*paths)
    np.testing.assert_array_equal(bare.node, np.arange(36))
    assert set(bare.direction) == {6}
    (tmp_path / "k.dof").write_text(MAPS["map.dof"]())
    np.testing.assert_array_equal(read_matrices(*paths).node, np.repeat(NODES, 3))


def test_names_in_one_file_units_and_positions(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> None:
    stiffness, mass, points = small
    path = tmp_path / "model.mat"
    # in mm, t, s: N/mm and t
    scipy.io.savemat(path, {"K": 1e-3 * stiffness, "M": 1e-3 * mass, "C": 1e-6 * stiffness, "other": np.eye(2)})
    (tmp_path / "map.csv").write_text(MAPS["map.csv"]())
    table = np.column_stack([NODES, 1e3 * points])
    (tmp_path / "nodes.csv").write_text("*NODE\n" + "".join(f"{int(n)}, {x}, {y}, {z}\n" for n, x, y, z in table))
    model = read_matrices(f"{path}#K", path, path, tmp_path / "map.csv", tmp_path / "nodes.csv", length_unit="mm")
    np.testing.assert_allclose(model.stiffness.toarray(), stiffness, rtol=1e-12, atol=1e-3)
    np.testing.assert_allclose(model.mass.toarray(), mass, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(model.damping.toarray(), 1e-3 * stiffness, rtol=1e-12, atol=1e-6)
    positions = model.positions_of([12, 3])
    assert positions is not None
    np.testing.assert_allclose(positions, points[[3, 0]])


def test_rotations_keep_their_energy_when_lengths_change_unit(tmp_path: Path) -> None:
    # a beam element in mm and N: deflection (mm) and rotation (rad) of a free end, E I = 1 N mm2, length 2 mm
    bending = np.array([[12 / 8, -6 / 4], [-6 / 4, 4 / 2]])
    np.save(tmp_path / "k.npy", bending)
    np.save(tmp_path / "m.npy", np.eye(2))
    (tmp_path / "map.csv").write_text("1, y\n1, rz\n")
    model = read_matrices(tmp_path / "k.npy", tmp_path / "m.npy", unknown_map=tmp_path / "map.csv", length_unit="mm")
    stiff, length = 1e-6, 2e-3
    expected = stiff * np.array([[12 / length**3, -6 / length**2], [-6 / length**2, 4 / length]])
    np.testing.assert_allclose(model.stiffness.toarray(), expected, rtol=1e-12)
    np.testing.assert_allclose(model.mass.toarray(), np.diag([1e3, 1e-3]))


BAD_CALCULIX = {
    "word": "2 2 1.0\n1 x 3\n",
    "columns": "1 1 1.0\n2 2\n",
    "zero": "0 0 1.0\n0 1 0.5\n1 1 1.0\n",
    "fraction": "1.5 1 1.0\n",
    "twice": "1 1 1.0\n2 2 1.0\n\n1 1 1.0\n",
    "both sides": "1 1 1.0\n1 2 0.1\n2 1 0.1\n2 2 1.0\n",
    "no diagonal": "1 1 1.0\n1 2 0.1\n",
    "infinite": "1 1 inf\n",
    "negative": "1 1 1.0\n2 2 -1.0\n",
    "minor": "1 1 1.0\n2 2 1.0\n1 2 1.5\n",
    "eigenvalue": "1 1 1.0\n2 2 1.0\n3 3 1.0\n1 2 0.9\n1 3 0.9\n2 3 -0.9\n",
    "cut": "1 1 1.0\n2 2 1.",
    "blank": "\n\n",
    "empty": "",
    "binary": "1 1 1\0\n",
}


@pytest.mark.parametrize("name", BAD_CALCULIX)
def test_bad_storage_of_calculix(tmp_path: Path, name: str) -> None:
    path = tmp_path / "bad.sti"
    path.write_text(BAD_CALCULIX[name])
    rejected(path, path)


BAD_MARKET = {
    "kind": "%%MatrixMarket matrix coordinate complex symmetric\n1 1 1\n1 1 1 0\n",
    "skew": "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 1\n",
    "count": "%%MatrixMarket matrix coordinate real general\n2 2 3\n1 1 1\n2 2 1\n",
    "shape": "%%MatrixMarket matrix coordinate real general\n2 3 1\n1 1 1\n",
    "range": "%%MatrixMarket matrix coordinate real general\n% c\n2 2 2\n1 1 1\n3 3 1\n",
    "size": "%%MatrixMarket matrix coordinate real general\n99999999 99999999 1\n1 1 1\n",
    "no size": "%%MatrixMarket matrix coordinate real general\n",
    "symmetric": "%%MatrixMarket matrix coordinate real symmetric\n2 2 4\n1 1 2\n1 2 1\n2 1 1\n2 2 2\n",
    "array": "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n",
    "unsymmetric": "%%MatrixMarket matrix array real general\n2 2\n2\n1\n0.5\n2\n",
}


@pytest.mark.parametrize("name", BAD_MARKET)
def test_bad_matrix_market(tmp_path: Path, name: str) -> None:
    path = tmp_path / "bad.mtx"
    path.write_text(BAD_MARKET[name])
    rejected(path, path)


def rejected(*arguments: Any, keys: Sequence[str] = ("stiffness",), **options: Any) -> None:
    with rejects(ImportFileError, *keys):
        read_matrices(*arguments, **options)


def test_a_mass_with_the_wrong_sign_names_the_file_of_the_mass(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> None:
    np.save(tmp_path / "k.npy", small[0])
    np.save(tmp_path / "m.npy", -small[1])
    rejected(tmp_path / "k.npy", tmp_path / "m.npy", keys=["mass"])


def test_sizes_names_and_suffixes(tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    for name, matrix in (("k.npy", small[0]), ("small.npy", np.eye(3)), ("line.npy", np.ones(3))):
        np.save(tmp_path / name, matrix)
    np.savez(tmp_path / "two.npz", one=small[0], two=small[1])
    np.savez(tmp_path / "cut.npz", M=small[1])
    np.save(tmp_path / "complex.npy", 1j * small[0])
    k = tmp_path / "k.npy"
    rejected(k, tmp_path / "small.npy", keys=["mass", "stiffness"])
    rejected(tmp_path / "line.npy", k)
    rejected(tmp_path / "two.npz", k)
    rejected(tmp_path / "cut.npz", k)
    rejected(tmp_path / "complex.npy", k)
    rejected(tmp_path / "k.abc", k)
    rejected(tmp_path / "none.npy", k)
    with rejects(InputError, "length_unit"):
        read_matrices(k, k, length_unit="km")


@pytest.mark.parametrize(
    ("name", "text", "key"),
    [
        ("map.dof", "3.1\n3.7\n", "unknown_map"),
        ("map.dof", "3.2\n3.1\n", "unknown_map"),
        ("map.dof", "3.1\n3.2\n", "unknown_map"),
        ("map.mapping", "1 3 UX\n3 3 UY\n", "unknown_map"),
        ("map.csv", "3, x\n3, sideways\n", "unknown_map"),
        ("map.csv", "node, direction\n", "unknown_map"),
        ("map.csv", "3, x\n" * 36, "stiffness"),
    ],
)
def test_bad_maps(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], name: str, text: str, key: str
) -> None:
    path = tmp_path / name
    path.write_text(text)
    with rejects(ImportFileError, key):
        read_matrices(*written(tmp_path, small, "npy"), unknown_map=path)


@pytest.mark.parametrize(
    "text",
    [
        "3, 0, 0, 0\n3, 1, 0, 0\n",
        "3, 0, 0\n",
        "3, 0, 0, nan\n",
        "node, x, y, z\n",
    ],
)
def test_bad_node_positions(tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], text: str) -> None:
    path = tmp_path / "nodes.csv"
    path.write_text(text)
    rejected(*written(tmp_path, small, "npy"), keys=["node_positions"], node_positions=path)


def test_bad_harwell_boeing(tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    path = tmp_path / "k.matrix"
    write_harwell_boeing(path, small[0])
    lines = path.read_text().splitlines()
    for row, old, new in (
        (2, "RSA", "CSA"),
        (3, "(8I10)", "(8X10)"),
        (5, "         1", "         2"),
        (5, "        ", "  wrong "),
    ):
        changed = [line.replace(old, new, 1) if i == row else line for i, line in enumerate(lines)]
        path.write_text("\n".join(changed) + "\n")
        rejected(path, path)
    path.write_text("\n".join(lines[:-60]) + "\n")
    rejected(path, path)


def test_bad_output4(tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    path = tmp_path / "k.op4"
    write_op4_text(path, small[0])
    lines = path.read_text().splitlines()
    for row, new in (
        (0, f"{36:8d}{36:8d}{6:8d}{7:8d}KRED    1P,3E23.16"),
        (0, f"{36:8d}{36:8d}{6:8d}{2:8d}KRED    1P,3X23.16"),
        (1, f"{1:8d}{2:8d}{36:8d}"),
        (14, f"{1:8d}{1:8d}{36:8d}"),
        (2, "nothing"),
    ):
        path.write_text("\n".join([*lines[:row], new, *lines[row + 1 :]]) + "\n")
        rejected(path, path)
    path.write_text("\n".join(lines + lines) + "\n")
    rejected(path, path)


def test_sparse_npz_with_an_index_out_of_range_is_rejected(tmp_path: Path) -> None:
    path = tmp_path / "k.npz"
    np.savez(path, format=b"csr", shape=(2, 2), data=np.ones(2), indices=np.array([0, 9]), indptr=np.array([0, 1, 2]))
    rejected(path, path)


def test_full_file_without_the_extra_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stickslip.formats.matrices.ansys_full.find_spec", lambda name: None)
    path = tmp_path / "file.full"
    path.write_bytes(b"\0" * 100)
    with rejects(MissingPackageError):
        read_matrices(path, path)


@pytest.mark.long
def test_full_file_of_ansys(tmp_path: Path) -> None:
    """The example of ansys-mapdl-reader, a clamped square beam: 300 free nodes, bending modes in equal pairs."""
    if importlib.util.find_spec("ansys") is None:
        absent_tool("ansys-mapdl-reader", 'pip install "stickslip[ansys]".')
    from ansys.mapdl.reader import examples

    from stickslip.structure.elasticity import natural_frequencies

    model = read_matrices(examples.fullfile, examples.fullfile)
    assert np.bincount(model.direction).tolist() == [300, 300, 300]
    actual, _ = natural_frequencies(model.stiffness, model.mass, 4)
    assert actual[0] == pytest.approx(actual[1], rel=1e-9)
    damaged = tmp_path / "damaged.full"
    content = Path(examples.fullfile).read_bytes()
    damaged.write_bytes(content[: len(content) // 2])
    # the reader of that package dies of something else each time, so its words are in no snapshot
    with pytest.raises(ImportFileError) as caught:
        read_matrices(damaged, damaged)
    assert caught.value.keys == ("stiffness",)


def test_both_triangles_of_calculix_coordinates_are_the_same_model(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> None:
    for upper in (True, False):
        lines = "".join(f"{i} {j} {value:.16e}\n" for i, j, value in coordinates(small[0], upper))
        (tmp_path / f"k{upper}.sti").write_text(lines)
    write_calculix(tmp_path / "m.mas", small[1])
    models = [read_matrices(tmp_path / f"k{upper}.sti", tmp_path / "m.mas") for upper in (True, False)]
    assert abs(models[0].stiffness - models[1].stiffness).max() == 0.0
    assert scipy.sparse.issparse(models[0].stiffness)


@pytest.mark.parametrize("name", MAPS)
def test_a_map_may_lack_its_last_line_end_but_nothing_else(
    tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray], name: str
) -> None:
    whole = MAPS[name]().rstrip("\n")
    path, files = tmp_path / name, written(tmp_path, small, "npy")
    path.write_text(whole)
    np.testing.assert_array_equal(read_matrices(*files, unknown_map=path).node, np.repeat(NODES, 3))
    path.write_text(whole[:-1])
    with rejects(ImportFileError, "unknown_map"):
        read_matrices(*files, unknown_map=path)
