"""Every claim of the paper study is true and false of synthetic curves that show it and deny it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from paper_curves import SAMPLES, curve
from stickslip.papers.rough_damper.claims import CLAIMS, energy_at, friction_energy, series
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.verdicts import Verdict

D = (2.3, 2.4, 2.49)
G = (1e-8, 1e-9, 1e-10)


def verdict(name: str, curves: list[Solved]) -> Verdict:
    claim = next(each for each in CLAIMS if each.name == name)
    return claim.judged(curves).verdict


def line(along: str, number: str, values: tuple[float, ...], **setting: Any) -> list[Solved]:
    """A series of D or G whose number takes the values."""
    key, places = ("dimension", D) if along == "D" else ("scale", G)
    curves = []
    for place, value in zip(places, values, strict=True):
        curves.append(curve({key: place, **setting}, **{number: value}))
    return curves


@pytest.mark.parametrize("along", ["D", "G"])
@pytest.mark.parametrize(
    ("values", "expected"),
    [((3e-5, 2e-5, 1e-5), Verdict.HOLDS), ((1e-5, 2e-5, 3e-5), Verdict.DOES_NOT_HOLD)],
)
def test_peak_along_a_series(along: str, values: tuple[float, ...], expected: Verdict) -> None:
    assert verdict(f"peak, {along}", line(along, "peak_m", values)) is expected


def test_peak_along_d_depends_on_the_excitation() -> None:
    falling = line("D", "peak_m", (3e-5, 2e-5, 1e-5)) + line("D", "peak_m", (4e-5, 2e-5, 1e-5), force=2.0)
    rising = line("D", "peak_m", (1e-5, 2e-5, 3e-5), excitation="opposite")
    claim = next(each for each in CLAIMS if each.name == "peak, D")
    judged = claim.judged(falling + rising)
    assert judged.verdict is Verdict.HOLDS_IF
    assert judged.reason.startswith("Always for excitation same, never for opposite.")


@pytest.mark.parametrize("along", ["D", "G"])
@pytest.mark.parametrize(
    ("values", "expected"),
    [((0.0, 1.0, 3.0), Verdict.HOLDS), ((3.0, 2.0, 1.0), Verdict.DOES_NOT_HOLD), ((2.0, 2.0, 2.0), Verdict.UNDECIDED)],
)
def test_slip_along_a_series(along: str, values: tuple[float, ...], expected: Verdict) -> None:
    curves = [
        curve(vars(one.setting), stick_slip=value, separating=0.0)
        for one, value in zip(line(along, "stuck", values), values, strict=True)
    ]
    assert verdict(f"slip, {along}", curves) is expected


@pytest.mark.parametrize(
    ("values", "rises", "hump"),
    [
        ((1e-6, 2e-6, 3e-6), Verdict.HOLDS, Verdict.DOES_NOT_HOLD),
        ((1e-6, 3e-6, 2e-6), Verdict.DOES_NOT_HOLD, Verdict.HOLDS),
        ((1e-12, 1e-13, 1e-12), Verdict.UNDECIDED, Verdict.UNDECIDED),  # below what the balance tells
    ],
)
def test_energy_along_d(values: tuple[float, ...], rises: Verdict, hump: Verdict) -> None:
    curves = line("D", "friction_energy_j", values)
    assert (verdict("energy, D", curves), verdict("hump, D", curves)) == (rises, hump)
    assert verdict("energy, G", line("G", "friction_energy_j", values)) is rises


def test_energy_at_a_fixed_frequency_depends_on_the_frequency() -> None:
    peaks = (430.0, 450.0, 470.0)
    curves = [curve({"dimension": d}, ((f, 1e-5),), viscous_energy_j=1e-6) for d, f in zip(D, peaks, strict=True)]
    curves += [curve({"dimension": d, "force": 2.0}, ((f, 1e-5),)) for d, f in zip(D, peaks, strict=True)]
    claim = next(each for each in CLAIMS if each.name == "hump, D, fixed")
    judged = claim.judged(curves)
    assert judged.verdict is Verdict.HOLDS_IF
    assert "frequency fixed at the middle curve's peak" in judged.reason


def test_energy_at_a_frequency_interpolates_takes_the_upper_branch_and_is_zero_outside() -> None:
    one = curve()
    folded = type(one)(
        **{**vars(one), "frequency_hz": np.array([440.0, 460.0, 440.0]), "energy_j": np.array([0.0, 2e-6, 4e-6])}
    )
    assert energy_at(folded, 450.0) == pytest.approx(3e-6)
    assert energy_at(folded, 470.0) == 0.0
    assert friction_energy(curve(friction_energy_j=-1e-10)) == 0.0


def three(number: str, single: float, same: float, opposite: float) -> list[Solved]:
    values = {"single": single, "same": same, "opposite": opposite}
    return [curve({"excitation": name}, **{number: value}) for name, value in values.items()]


@pytest.mark.parametrize(
    ("values", "expected"),
    [((1.0, 3.0, 2.0), Verdict.HOLDS), ((3.0, 1.0, 2.0), Verdict.DOES_NOT_HOLD), ((2.0, 2.0, 2.0), Verdict.UNDECIDED)],
)
def test_same_direction_is_largest(values: tuple[float, float, float], expected: Verdict) -> None:
    assert verdict("same, slip", three("stick_slip", *values)) is expected
    assert verdict("same, energy", three("friction_energy_j", *(1e-6 * value for value in values))) is expected


@pytest.mark.parametrize(
    ("single", "two", "pairs"),
    [
        (((440.0, 2e-5), (470.0, 1e-5)), Verdict.HOLDS, Verdict.HOLDS),
        (((440.0, 1e-5), (470.0, 2e-5)), Verdict.DOES_NOT_HOLD, Verdict.HOLDS),
        (((440.0, 2e-5), (500.0, 1e-5)), Verdict.HOLDS, Verdict.DOES_NOT_HOLD),
        (((440.0, 2e-5),), Verdict.DOES_NOT_HOLD, Verdict.DOES_NOT_HOLD),
    ],
)
def test_two_peaks(single: tuple[tuple[float, float], ...], two: Verdict, pairs: Verdict) -> None:
    curves = [
        curve({"excitation": "single"}, single),
        curve({"excitation": "same"}, ((440.5, 1e-5),)),
        curve({"excitation": "opposite"}, ((469.0, 1e-5),)),
    ]
    assert (verdict("two peaks", curves), verdict("peak pairs", curves)) == (two, pairs)


@pytest.mark.parametrize(
    ("shares", "expected"), [((0.9, 0.1, 0.0), Verdict.HOLDS), ((0.1, 0.9, 0.0), Verdict.DOES_NOT_HOLD)]
)
def test_translation_and_rotation(shares: tuple[float, float, float], expected: Verdict) -> None:
    assert verdict("translation", [curve(shares=shares)]) is expected
    turned = (shares[1], shares[0], 0.0)
    assert verdict("rotation", [curve({"excitation": "opposite"}, shares=turned)]) is expected


def test_three_states_must_be_those_of_one_pair() -> None:
    mixed = np.zeros((3, SAMPLES), dtype=int)
    mixed[1, :4], mixed[1, 4:6] = 1, 2
    assert verdict("three states", [curve(phases=mixed)]) is Verdict.HOLDS
    apart = np.zeros((3, SAMPLES), dtype=int)
    apart[1], apart[2] = 1, 2
    assert verdict("three states", [curve(phases=apart)]) is Verdict.DOES_NOT_HOLD


@pytest.mark.parametrize(("light", "heavy", "expected"), [(3.0, 1.0, Verdict.HOLDS), (1.0, 3.0, Verdict.DOES_NOT_HOLD)])
def test_load(light: float, heavy: float, expected: Verdict) -> None:
    curves = [curve({"load": 50.0}, stick_slip=light), curve({"load": 100.0}, stick_slip=heavy)]
    assert verdict("load, slip", curves) is expected
    peaks = [curve({"load": load}, ((450.0, 1e-5 / value),)) for load, value in ((50.0, light), (100.0, heavy))]
    assert verdict("load, suppression", peaks) is expected


@pytest.mark.parametrize(("weak", "strong", "expected"), [(3.0, 1.0, Verdict.HOLDS), (1.0, 3.0, Verdict.DOES_NOT_HOLD)])
def test_force(weak: float, strong: float, expected: Verdict) -> None:
    curves = [curve({"force": 2.0}, stuck=weak), curve({"force": 5.0}, stuck=strong)]
    assert verdict("force, slip", curves) is expected


@pytest.mark.parametrize(
    ("shift", "expected"), [(-1.0, Verdict.HOLDS), (1.0, Verdict.DOES_NOT_HOLD), (0.0, Verdict.UNDECIDED)]
)
def test_left_shift(shift: float, expected: Verdict) -> None:
    assert verdict("left shift", [curve(stuck_peak_hz=450.0 - shift)]) is expected


@pytest.mark.parametrize(("energy", "expected"), [(0.0, Verdict.HOLDS), (1e-9, Verdict.DOES_NOT_HOLD)])
def test_opposite_forces_dissipate_nothing(energy: float, expected: Verdict) -> None:
    curves = line("G", "friction_energy_j", (energy,) * 3, excitation="opposite")
    assert verdict("opposite, stuck", curves) is expected


def test_series_are_ordered_towards_stiffer_and_need_three_curves() -> None:
    shuffled = line("G", "peak_m", (1e-5, 2e-5, 3e-5))[::-1]
    (actual,) = series(shuffled, "G")
    assert [one.setting.scale for one in actual] == list(G)
    assert list(series(shuffled[:2], "G")) == []
