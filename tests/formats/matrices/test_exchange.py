"""The exchange format comes back as written, in any order of unknowns; wrong arrays are refused by a sentence."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import ImportFileError, InputError
from stickslip.formats.matrices.exchange import read_superelement, write_superelement
from stickslip.formats.matrices.model import MatrixModel
from stickslip.structure.superelement import Superelement


def arrays(**changed: Any) -> dict[str, Any]:
    """The arrays of a file with two nodes, in the order 9, 4, and a mode."""
    rows = np.array([9, 9, 9, 4, 4, 4, -1])
    good = {
        "format": np.array("stickslip superelement"),
        "format_version": np.array(1),
        "mass": np.diag(np.arange(1.0, 8.0)),
        "stiffness": np.diag(np.arange(2.0, 9.0)),
        "node": rows,
        "direction": np.array([0, 1, 2, 0, 1, 2, 6]),
    }
    return {name: value for name, value in (good | changed).items() if value is not None}


def test_what_is_written_comes_back(tmp_path: Path, small: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    element = Superelement(
        mass=small[1][:8, :8],
        stiffness=small[0][:8, :8],
        damping=1e-6 * small[0][:8, :8],
        boundary_nodes=np.array([70, 3]),
        positions=np.array([[1.0, 2.0, 3.0], [0.5, 0.0, -1.0]]),
        node_sets={"face": np.array([3])},
    )
    assert write_superelement(tmp_path, element) == tmp_path / "superelement.npz"
    actual = read_superelement(tmp_path)
    for name in ("mass", "stiffness", "damping", "boundary_nodes", "positions"):
        np.testing.assert_array_equal(getattr(actual, name), getattr(element, name))
    assert {name: part.tolist() for name, part in actual.node_sets.items()} == {"face": [3]}


def test_rows_in_any_order_come_out_node_by_node(tmp_path: Path) -> None:
    order = np.array([6, 4, 0, 2, 5, 1, 3])
    plain = arrays()
    shuffled = {name: plain[name][np.ix_(order, order)] for name in ("mass", "stiffness")}
    np.savez(tmp_path / "a.npz", **arrays(**shuffled, node=plain["node"][order], direction=plain["direction"][order]))
    actual = read_superelement(tmp_path / "a.npz")
    np.testing.assert_array_equal(actual.boundary_nodes, [4, 9])
    np.testing.assert_array_equal(actual.mass.diagonal(), [4.0, 5.0, 6.0, 1.0, 2.0, 3.0, 7.0])


@pytest.mark.parametrize(
    "changed",
    [
        {"format": None},
        {"format_version": np.array(2)},
        {"mass": None},
        {"mass": np.eye(3)},
        {"mass": np.full((7, 7), np.nan)},
        {"stiffness": np.ones(7)},
        {"damping": np.triu(np.ones((7, 7))) + 2 * np.tril(np.ones((7, 7)))},
        {"node": np.zeros(7)},
        {"node": np.array([9, 9, 9, 9, 4, 4, -1])},
        {"direction": np.array([0, 1, 2, 0, 1, 7, 6])},
        {"position": np.ones((2, 3))},
        {"position": np.ones((1, 3)), "node_labels": np.array([9])},
        {"position": np.ones((2, 2)), "node_labels": np.array([9, 4])},
        {"set_tip": np.array([5])},
    ],
)
def test_wrong_arrays(tmp_path: Path, changed: dict[str, Any]) -> None:
    path = tmp_path / "bad.npz"
    np.savez(path, **arrays(**changed))
    with rejects(ImportFileError):
        read_superelement(path)


def test_no_file_and_no_folder(tmp_path: Path) -> None:
    with rejects(ImportFileError):
        read_superelement(tmp_path / "none.npz")
    with rejects(ImportFileError):
        write_superelement(tmp_path / "no" / "such.npz", Superelement(np.eye(3), np.eye(3)))


@pytest.mark.parametrize(
    ("options", "keys"),
    [
        ({"boundary_nodes": np.array([1, 2, 3])}, ("boundary_nodes",)),
        ({"boundary_nodes": np.array([1, 1])}, ("boundary_nodes",)),
        ({"boundary_nodes": np.array([1, 2]), "positions": np.ones((1, 3))}, ("positions",)),
        ({"boundary_nodes": np.array([1]), "node_sets": {"a": np.array([2])}}, ()),
    ],
)
def test_nodes_that_do_not_fit_a_superelement(options: dict[str, Any], keys: tuple[str, ...]) -> None:
    with rejects(InputError, *keys):
        Superelement(np.eye(6), np.eye(6), **options)


def test_a_model_finds_the_unknowns_of_its_nodes() -> None:
    model = MatrixModel(np.eye(4), np.eye(4), node=np.array([7, 7, 7, 2]), direction=np.array([2, 0, 1, 0]))
    np.testing.assert_array_equal(model.unknowns_of([7]), [[1, 2, 0]])
    with rejects(InputError):
        model.unknowns_of([7, 2])
    with rejects(InputError):
        model.unknowns_of([3])
