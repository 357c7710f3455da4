"""Contact stiffness from measured values: the table, between and beyond its rows, and as springs of pairs."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.contact.stiffness.registry import stiffness_law, stiffness_law_names

PRESSURE = np.array([1e6, 4e6, 1.6e7])  # Pa
NORMAL = np.array([2e13, 4e13, 1e14])  # N/m3
TANGENTIAL = 0.7 * NORMAL


def law() -> ss.MeasuredStiffness:
    return ss.MeasuredStiffness(PRESSURE, NORMAL, TANGENTIAL)


def test_it_passes_through_its_rows() -> None:
    assert law().normal(PRESSURE) == pytest.approx(NORMAL, rel=1e-14)
    assert law().tangential(PRESSURE) == pytest.approx(TANGENTIAL, rel=1e-14)


def test_a_power_law_comes_back_at_every_pressure() -> None:
    """Two rows of 3e9 p^0.64 give that law within the table and beyond its ends."""

    def exact(pressure: np.ndarray) -> np.ndarray:
        return np.asarray(3e9 * pressure**0.64)

    ends = np.array([1e6, 1e8])
    table = ss.MeasuredStiffness(ends, exact(ends), exact(ends))
    wanted = np.geomspace(1e4, 1e10, 31)
    assert table.normal(wanted) == pytest.approx(exact(wanted), rel=1e-12)


def test_it_says_which_pressures_are_not_measured() -> None:
    assert law().valid(np.array([1e6, 1.6e7])) == ()
    below, above = law().valid(np.array([2e6, 5e5, 2e7]))
    printed_sentence(below, "5e+05 to 5e+05 Pa", "1e+06 to 1.6e+07 Pa")
    printed_sentence(above, "2e+07 to 2e+07 Pa", "1e+06 to 1.6e+07 Pa")
    assert law().valid(np.array([40.0 / 160e-6 * 4.0 * (1.0 - 1e-15)])) == ()  # round-off of an end of the table


def test_springs_of_pairs_take_the_pressure_of_the_face_or_of_the_pair() -> None:
    area, preload = np.array([1e-6, 3e-6]), np.array([4.0, 12.0])  # 4 MPa each
    for allocation in ("area", "pressure"):
        normal, tangential = ss.springs_of_pairs(law(), area, preload, allocation)
        assert normal == pytest.approx(4e13 * area, rel=1e-14)
        assert tangential == pytest.approx(2.8e13 * area, rel=1e-14)
    uneven = np.array([1.0, 15.0])  # 1 MPa and 5 MPa, 4 MPa in the mean
    assert ss.springs_of_pairs(law(), area, uneven, "area")[0] == pytest.approx(4e13 * area, rel=1e-14)
    assert ss.springs_of_pairs(law(), area, uneven, "pressure")[0][0] == pytest.approx(2e13 * area[0], rel=1e-14)


def test_its_name_finds_it() -> None:
    assert "measured" in stiffness_law_names()
    actual = stiffness_law("measured")(pressure=PRESSURE, normal_stiffness=NORMAL, tangential_stiffness=TANGENTIAL)
    assert isinstance(actual, ss.StiffnessLaw)
    assert actual.describe() == law().describe()
    assert "3 measured points from 1e+06 to 1.6e+07 Pa" in actual.describe()


@pytest.mark.parametrize(
    ("pressure", "normal", "key"),
    [
        ([1e6], [1e13], "pressure"),
        ([1e6, 2e6], [1e13, 0.0], "normal_stiffness"),
        ([1e6, 2e6], [1e13, np.nan], "normal_stiffness"),
        ([2e6, 1e6], [1e13, 1e13], "pressure"),
        ([1e6, 2e6, 3e6], [1e13, 1e13], "pressure"),
        ([-1e6, 2e6], [1e13, 1e13], "pressure"),
    ],
)
def test_a_wrong_table_is_rejected(pressure: list[float], normal: list[float], key: str) -> None:
    with rejects(ss.InputError, key):
        ss.MeasuredStiffness(pressure, normal, normal)
