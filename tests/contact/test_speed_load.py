import numpy as np
import pytest

import stickslip as ss
from sentences import rejects


def test_loads_grow_with_the_square_of_the_speed() -> None:
    omega = 2.0 * np.pi * 100.0
    load = ss.normal_load_at_speed([100.0, 50.0], [2e-3, -1e-5], 6000.0)
    assert load == pytest.approx([100.0 + 2e-3 * omega**2, 50.0 - 1e-5 * omega**2])
    assert ss.normal_load_at_speed(100.0, 2e-3, 0.0) == pytest.approx([100.0])


def test_bad_input() -> None:
    with rejects(ss.InputError, "speed_rpm"):
        ss.normal_load_at_speed(1.0, 1.0, -5.0)
    with rejects(ss.InputError, "mass_times_radius"):
        ss.normal_load_at_speed(1.0, -1.0, 6000.0)
