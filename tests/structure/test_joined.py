from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import InputError
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import joined_modes, tie_matrix
from stickslip.structure.mesh import Mesh
from stickslip.structure.superelement import Superelement


def test_tied_unknowns_move_together() -> None:
    tie = tie_matrix(np.array([2, 1]), np.array([[0], [3]]), np.ones((2, 1)), 5)
    assert tie.shape == (5, 3)
    motion = tie @ np.array([1.0, 2.0, 3.0])
    np.testing.assert_array_equal(motion, [1.0, 2.0, 1.0, 2.0, 3.0])


def test_a_tied_unknown_may_follow_several_or_none() -> None:
    tie = tie_matrix(np.array([0, 3]), np.array([[1, 4], [3, 3]]), np.array([[0.25, 0.75], [0.0, 0.0]]), 5)
    np.testing.assert_array_equal(tie @ np.array([4.0, 2.0, 8.0]), [7.0, 4.0, 2.0, 0.0, 8.0])


@pytest.mark.parametrize(("leaders", "followers"), [([0, 1], [2, 2]), ([0, 2], [2, 3])])
def test_unknowns_that_cannot_be_tied_one_to_one_are_rejected(leaders: list[int], followers: list[int]) -> None:
    with rejects(InputError):
        tie_matrix(np.array(followers), np.array(leaders)[:, None], np.ones((2, 1)), 5)


@pytest.mark.long
def test_very_stiff_springs_come_to_the_tied_frequencies(
    blade_mesh: Mesh, blade_superelement: Superelement, pairs_of: Callable[[Mesh], FacePairs]
) -> None:
    pairs = pairs_of(blade_mesh)
    tied, modes = joined_modes(blade_superelement, pairs, 10)
    stuck, _ = joined_modes(blade_superelement, pairs, 10, pairs.springs(1e16, 1e16))
    np.testing.assert_allclose(stuck, tied, rtol=5e-5)
    assert (stuck < tied).all()
    # Tied modes close the joint: no relative motion on the full mesh.
    assert np.abs(pairs.mesh_operator(blade_mesh.n_nodes) @ modes).max() < 1e-12 * np.abs(modes).max()


def test_springs_of_the_wrong_number_are_rejected(
    blade_mesh: Mesh, blade_structure: Structure, pairs_of: Callable[[Mesh], FacePairs]
) -> None:
    with rejects(InputError, "springs"):
        joined_modes(blade_structure, pairs_of(blade_mesh), 2, np.ones(110))


def test_a_body_that_moves_freely_has_no_frequency_and_a_soft_one_has() -> None:
    """Below 1 Hz everything counted as free."""
    from stickslip.structure.superelement import Superelement

    class Unpaired:
        """One pair between the two last nodes, along x, y, z."""

        def operator(self, superelement: Superelement) -> np.ndarray:
            rows = np.zeros((3, superelement.size))
            rows[:, -3:] = np.eye(3)
            return rows

    unpaired: Any = Unpaired()
    mass = np.eye(6)
    softly_supported = Superelement(mass, np.diag([1.0, 1.0, 1.0, 4.0, 4.0, 4.0]))
    frequency_hz, _ = joined_modes(softly_supported, unpaired, 5, np.zeros(3))
    assert (frequency_hz > 0.1).all()
    loose = Superelement(mass, np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]))
    frequency_hz, _ = joined_modes(loose, unpaired, 5, np.zeros(3))
    assert (frequency_hz[:3] == 0.0).all()
    assert (frequency_hz[3:] > 0.1).all()
