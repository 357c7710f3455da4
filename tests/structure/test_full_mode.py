"""The mode of the full model that a mode of a reduction stands for, on a coarse two-blade model."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.model.model import build_model
from stickslip.structure.full_mode import closest_full_mode
from stickslip.structure.joined import joined_modes
from sweep_cases import quick_case


def test_it_is_the_mode_of_that_frequency_and_shape() -> None:
    """Two modes of the full model itself, a motion of half of each, and one without any of the modes near it."""
    model = build_model(quick_case())
    full, pairs, springs = model.in_study.full_model, model.joint.face_pairs, model.pairs.resting_stiffness()
    assert full is not None
    hertz, modes = joined_modes(full, pairs, 40, springs)
    for mode in (0, 8):
        found = closest_full_mode(full, pairs, springs, modes[:, mode], 1.02 * hertz[mode])
        assert found.frequency_hz == pytest.approx(hertz[mode], rel=1e-9)
        assert found.mac == pytest.approx(1.0, abs=1e-9)
    half = closest_full_mode(full, pairs, springs, np.sqrt(0.25) * modes[:, 0] + np.sqrt(0.75) * modes[:, 5], hertz[5])
    assert half.frequency_hz == pytest.approx(hertz[5])
    assert half.mac == pytest.approx(0.75)
    far = closest_full_mode(full, pairs, springs, modes[:, 39], hertz[0])
    assert far.mac == pytest.approx(0.0, abs=1e-9)


def test_neighbours_count_as_one() -> None:
    """A reduction may mix the shapes of modes whose frequencies hardly differ."""
    model = build_model(quick_case())
    full, pairs, springs = model.in_study.full_model, model.joint.face_pairs, model.pairs.resting_stiffness()
    assert full is not None
    hertz, modes = joined_modes(full, pairs, 60, springs)
    close = int(np.argmin(np.diff(hertz) / hertz[:-1]))
    assert hertz[close + 1] < 1.01 * hertz[close]
    mixed = closest_full_mode(full, pairs, springs, modes[:, close] + modes[:, close + 1], hertz[close])
    assert mixed.mac == pytest.approx(1.0, abs=1e-9)
