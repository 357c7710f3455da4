"""Points that do not meet the equation of motion are no results, and contact beyond the arithmetic is refused."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.solve.curve_result import LARGEST_UNBALANCE


def two_masses(
    stiffness: float, ratio: float | None, mass: float = 1.0, damping: np.ndarray | None = None
) -> ss.ForcedResponse:
    """Two masses, the second one on a friction contact, under 10 N at the first one."""
    operator = np.zeros((3, 2))
    operator[0, 1] = 1.0
    structure = ss.Superelement(np.diag([1.0, mass]), np.array([[2e6, -1e6], [-1e6, 1e6]]), damping)
    return ss.forced_response(
        structure,
        ss.ContactPairs(operator, stiffness, stiffness, 0.3, 20.0),
        [10.0, 0.0],
        frequency_hz=(200.0, 300.0),
        harmonics=1,
        samples=64,
        modal_damping_ratio=ratio,
        threads=1,
    )


@pytest.mark.long
def test_an_undamped_resonance_ends_the_curve() -> None:
    """Amplitudes grew to 1e64 m, with a residual of 1e53. The normal load varies a little, so nothing is rejected."""
    pairs = ss.ContactPairs([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]], 1e6, 1e6, 0.3, 20.0)
    with pytest.warns(ss.NotConvergedWarning):
        window = ss.forced_response(
            ss.Superelement(np.eye(2), np.array([[1e6, 1.0], [1.0, 4e7]])),
            pairs,
            [10.0, 0.0],
            frequency_hz=(150.0, 170.0),
            harmonics=1,
            samples=64,
            threads=1,
        )
    assert window.residual.max() <= LARGEST_UNBALANCE
    assert np.abs(window.displacement).max() < 1e6
    assert not window.converged
    printed_sentence(window.message, numbers=False)


@pytest.mark.slow
def test_contact_of_a_massless_unknown_is_solved_without_damping() -> None:
    response = two_masses(1e6, None, 1e-14)
    assert response.converged, response.message
    assert response.residual.max() <= LARGEST_UNBALANCE


def test_an_undamped_resonance_without_a_bound_is_rejected_before_the_curve() -> None:
    """10 N against 4/pi times 6 N, in a mode in which the contact moves less than the first mass."""
    with rejects(ss.InputError, "modal_damping_ratio"):
        two_masses(1e6, None)


@pytest.mark.parametrize("stiffness", [1e14, 1e16, 1e18])
def test_contact_beyond_the_arithmetic_is_rejected(stiffness: float) -> None:
    """The residual was 1e11."""
    with rejects(ss.InputError):
        two_masses(stiffness, 0.01)


@pytest.mark.long
def test_stiff_contact_within_the_arithmetic_is_solved() -> None:
    response = two_masses(1e9, 0.01)
    assert response.converged
    assert response.residual.max() <= LARGEST_UNBALANCE


def test_a_free_mass_on_a_contact_is_no_stiff_contact() -> None:
    response = ss.forced_response(
        ss.Superelement(np.eye(1), np.zeros((1, 1))),
        ss.ContactPairs([[1.0], [0.0], [0.0]], 1e9, 1e9, 0.3, 20.0),
        [1.0],
        frequency_hz=(100.0, 200.0),
        harmonics=1,
        samples=64,
        modal_damping_ratio=0.01,
        threads=1,
    )
    assert response.converged
