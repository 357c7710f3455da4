"""Warnings on the shapes of a nonlinear mode and on its branch."""

from __future__ import annotations

import numpy as np

from sentences import printed_sentence
from stickslip.contact.law.law import ContactState
from stickslip.solve.harmonic.mode_shapes import exchange_warnings, fold_warnings, start_warnings, step_warnings

HERTZ, AMPLITUDE = np.array([100.0, 98.0, 95.0, 94.0]), np.array([1e-6, 2e-6, 4e-6, 8e-6])


def test_a_shape_that_stays_has_no_warning() -> None:
    macs = np.array([[0.9, 0.1], [0.8, 0.2], [0.7, 0.3], [0.6, 0.4]])
    assert not list(exchange_warnings(macs, HERTZ, np.array([100.0, 120.0]), 1, "stuck"))
    assert not list(step_warnings(np.array([1.0, 0.99, 0.98, 0.97]), HERTZ, AMPLITUDE))
    assert not list(fold_warnings(AMPLITUDE))


def test_each_exchange_has_a_warning() -> None:
    macs = np.array([[0.9, 0.1], [0.4, 0.6], [0.3, 0.7], [0.8, 0.2]])
    first, second = exchange_warnings(macs, HERTZ, np.array([100.0, 120.0]), 1, "stuck")
    printed_sentence(first)
    printed_sentence(second)


def test_a_shape_that_changes_in_one_step_has_a_warning() -> None:
    (words,) = step_warnings(np.array([1.0, 0.99, 0.5, 0.97]), HERTZ, AMPLITUDE)
    printed_sentence(words)


def test_a_branch_that_turns_back_has_a_warning() -> None:
    (words,) = fold_warnings(np.array([1.0, 2.0, 3.0, 2.5, 2.0, 2.2, 4.0]))
    printed_sentence(words)


def test_a_branch_that_begins_away_from_its_linear_mode_has_a_warning() -> None:
    stuck = np.full(3, ContactState.STUCK)
    slipping = np.array([ContactState.STUCK, ContactState.STICK_SLIP, ContactState.SEPARATING])
    assert not list(start_warnings(0.99, 99.5, 100.0, 1e-6, slipping, 1, "stuck"))
    for mac, hertz, states, limit in (
        (0.99, 98.0, slipping, "stuck"),
        (0.90, 100.0, stuck, "stuck"),
        (0.99, 102.0, slipping, "sliding"),
    ):
        (words,) = start_warnings(mac, hertz, 100.0, 1e-6, states, 1, limit)
        printed_sentence(words)
