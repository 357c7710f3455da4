"""Pairs that rest as springs: the curve of all pairs, and what a pair that does not rest makes of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers import Blade
from sentences import printed_sentence, rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.jenkins import JenkinsElement
from stickslip.core.errors import InputError
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.solve.partial_joint import not_resting, partial_response
from stickslip.structure.superelement import Superelement

pytestmark = pytest.mark.slow


def curve(superelement: Superelement, pairs: ContactPairs, blade: Blade, **options: Any) -> ForcedResponse:
    settings: dict[str, Any] = {"frequency_hz": blade.window_hz, "harmonics": 3, "samples": 64} | options
    return forced_response(superelement, pairs, blade.force_cos, blade.force_sin, **settings)


def moved(response: ForcedResponse) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """The pairs that slip, open or come to another traction."""
    none = np.zeros(response.pairs.n_pairs, dtype=bool)
    none[0] = True  # the check takes at least one as moving
    return not_resting(response, none) | none


@pytest.fixture(scope="module")
def pressed(blade: Blade) -> tuple[Blade, ContactPairs]:
    """The blade with some pairs under so much load that they stick."""
    load = blade.pairs.normal_load.copy()
    load[4:] *= 20.0
    return blade, blade.pairs_with(load)


@pytest.mark.parametrize("retained", [False, True], ids=["released", "retained"])
def test_the_curve_is_that_of_all_pairs(pressed: tuple[Blade, ContactPairs], retained: bool) -> None:
    blade, pairs = pressed
    pairs = pairs.retaining() if retained else pairs
    whole = curve(blade.superelement, pairs, blade)
    moving = moved(whole)
    assert 1 < moving.sum() < 10
    part = partial_response(blade.superelement, pairs, moving, lambda structure, joint: curve(structure, joint, blade))
    assert part.converged
    assert not not_resting(part, moving).any()
    assert part.settings["pairs_that_could_move"] == moving.sum()
    tip = blade.tip
    assert part.amplitude(tip).max() == pytest.approx(whole.amplitude(tip).max(), rel=1e-3)  # other points
    # from the same frequency on the same motions, states, energies and multipliers
    here = float(part.frequency_hz[part.amplitude(tip).argmax()])
    options = {"frequency_hz": (here, here + 1e-3)}
    near = curve(blade.superelement, pairs, blade, **options)
    own = partial_response(
        blade.superelement, pairs, moving, lambda structure, joint: curve(structure, joint, blade, **options)
    )
    assert np.abs(near.displacement[0] - own.displacement[0]).max() < 1e-7 * np.abs(near.displacement[0]).max()
    np.testing.assert_array_equal(near.contact_state[0], own.contact_state[0])
    np.testing.assert_allclose(near.dissipated_energy[0], own.dissipated_energy[0], rtol=1e-6, atol=1e-15)
    assert own.residual.max() < 1e-7
    np.testing.assert_allclose(own.linear.free_frequency_hz, near.linear.free_frequency_hz, rtol=1e-10)
    assert near.multipliers is not None
    assert own.multipliers is not None
    np.testing.assert_allclose(np.abs(own.multipliers[0]), np.abs(near.multipliers[0]), rtol=1e-6)


def test_a_pair_that_does_not_rest_ends_the_result(pressed: tuple[Blade, ContactPairs]) -> None:
    blade, pairs = pressed
    moving = moved(curve(blade.superelement, pairs, blade, checks=False))
    fewer = moving.copy()
    fewer[np.flatnonzero(moving)[-1]] = False
    part = partial_response(
        blade.superelement, pairs, fewer, lambda structure, joint: curve(structure, joint, blade, checks=False)
    )
    assert not part.converged
    printed_sentence(part.message)
    assert not_resting(part, fewer)[np.flatnonzero(moving)[-1]]


def test_all_pairs_are_the_ordinary_curve(pressed: tuple[Blade, ContactPairs]) -> None:
    blade, pairs = pressed

    def ordinary(superelement: Superelement, joint: ContactPairs) -> ForcedResponse:
        assert superelement is blade.superelement
        return curve(superelement, joint, blade, checks=False)

    every = np.ones(10, dtype=bool)
    part = partial_response(blade.superelement, pairs, every, ordinary)
    assert not not_resting(part, every).any()


def test_no_pair_and_parts_of_other_laws_are_rejected(blade: Blade) -> None:
    def never(superelement: Superelement, joint: ContactPairs) -> ForcedResponse:
        raise AssertionError("nothing may be solved")

    with rejects(InputError, "moving"):
        partial_response(blade.superelement, blade.pairs, np.zeros(10, dtype=bool), never)
    with rejects(InputError, "moving"):
        partial_response(blade.superelement, blade.pairs, np.ones(3, dtype=bool), never)
    law = JenkinsElement(np.full(10, 1e6), np.full(10, 10.0))
    pairs = ContactPairs.with_laws(blade.operator, [law])
    half = np.arange(10) < 5
    with rejects(InputError, "moving"):
        partial_response(replace(blade.superelement), pairs, half, never)
