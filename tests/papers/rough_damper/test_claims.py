"""Every claim of the paper study is true and false of synthetic curves that show it and deny it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paper_curves import SAMPLES, curve
from stickslip.papers.rough_damper.claim_list import CLAIMS
from stickslip.papers.rough_damper.claims import energy_at, friction_energy, series
from stickslip.papers.rough_damper.curve_items import folded_words
from stickslip.papers.rough_damper.further_claims import rotation_words
from stickslip.papers.rough_damper.items import judged, peak_table, seen
from stickslip.papers.rough_damper.plan import Scope, base_case
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.verdict_items import answers_table, judged_claims
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
        pairs: dict[str, Any] = {number: value}
        curves.append(curve({key: place, **setting}, **pairs))
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
    verdict_of = claim.judged(falling + rising)
    assert verdict_of.verdict is Verdict.HOLDS_IF
    assert verdict_of.reason.startswith("Always for excitation same, never for opposite.")


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
    verdict_of = claim.judged(curves)
    assert verdict_of.verdict is Verdict.HOLDS_IF
    assert "frequency fixed at the middle curve's peak" in verdict_of.reason


def test_energy_at_a_frequency_interpolates_takes_the_upper_branch_and_is_zero_outside() -> None:
    one = curve()
    folded = type(one)(
        **{**vars(one), "frequency_hz": np.array([440.0, 460.0, 440.0]), "energy_j": np.array([0.0, 2e-6, 4e-6])}
    )
    assert energy_at(folded, 450.0) == pytest.approx(3e-6)
    assert energy_at(folded, 470.0) == 0.0
    assert friction_energy(curve(friction_energy_j=-1e-10)) == 0.0


def three(number: str, single: float, same: float, opposite: float) -> list[Solved]:
    values: dict[str, dict[str, Any]] = {
        "single": {number: single},
        "same": {number: same},
        "opposite": {number: opposite},
    }
    return [curve({"excitation": name}, **value) for name, value in values.items()]


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


@pytest.mark.parametrize(("weak", "strong", "expected"), [(1.0, 3.0, Verdict.HOLDS), (3.0, 1.0, Verdict.DOES_NOT_HOLD)])
def test_force_separates(weak: float, strong: float, expected: Verdict) -> None:
    curves = [curve({"force": 2.0}, separating=weak), curve({"force": 5.0}, separating=strong)]
    assert verdict("force, separation", curves) is expected
    assert verdict("force, separation", [curve({"force": force}) for force in (2.0, 5.0)]) is Verdict.UNDECIDED


@pytest.mark.parametrize(
    ("second", "small", "steady"),
    [
        ((4e-6, 4.1e-6, 3.9e-6), Verdict.HOLDS, Verdict.HOLDS),
        ((2e-6, 3e-6, 4e-6), Verdict.HOLDS, Verdict.DOES_NOT_HOLD),
        ((8e-6, 8.1e-6, 7.9e-6), Verdict.DOES_NOT_HOLD, Verdict.HOLDS),
    ],
)
def test_the_reverse_peak_is_small_and_steady(second: tuple[float, ...], small: Verdict, steady: Verdict) -> None:
    curves = [
        curve({"dimension": d, "excitation": "single"}, ((440.0, 1e-5), (480.0, height)))
        for d, height in zip(D, second, strict=True)
    ]
    assert (verdict("reverse, small", curves), verdict("reverse, steady", curves)) == (small, steady)
    one_peak = [curve({"dimension": d, "excitation": "single"}) for d in D]
    assert verdict("reverse, small", one_peak) is verdict("reverse, steady", one_peak) is Verdict.UNDECIDED


def test_the_law_of_roughness_is_unchanged_where_every_run_has_the_same_trend() -> None:
    falling, rising, flat = (3e-5, 2e-5, 1e-5), (1e-5, 2e-5, 3e-5), (1e-5, 1e-5, 1e-5)
    base = line("D", "peak_m", falling)
    assert verdict("unchanged law", base) is Verdict.UNDECIDED  # one run is no comparison
    assert verdict("unchanged law", base + line("D", "peak_m", falling, load=50.0)) is Verdict.HOLDS
    assert verdict("unchanged law", base + line("D", "peak_m", rising, load=50.0)) is Verdict.DOES_NOT_HOLD
    assert verdict("unchanged law", base + line("D", "peak_m", rising, force=2.0)) is Verdict.DOES_NOT_HOLD
    assert verdict("unchanged law", base + line("D", "peak_m", flat, force=2.0)) is Verdict.UNDECIDED
    # without the law there would be nothing to compare: D and G are not mixed
    assert verdict("unchanged law", base + line("G", "peak_m", rising)) is Verdict.UNDECIDED


def test_rotation_is_asked_of_both_directions_and_the_inverse_is_named() -> None:
    shares = {"single": (1.0, 0.0, 0.0), "same": (0.7, 0.3, 0.0), "opposite": (1.0, 0.0, 0.0)}
    curves = [curve({"excitation": name}, shares=share) for name, share in shares.items()]
    assert verdict("translation", curves) is Verdict.HOLDS
    assert verdict("rotation, larger", curves) is Verdict.DOES_NOT_HOLD
    words = rotation_words(curves)
    assert words.startswith("Rotation is 30 to 30 % of the motion in the same direction, and 0 to 0 % under opposite")
    assert words.endswith("the inverse of the picture in the paper.")
    shares["opposite"] = (0.2, 0.8, 0.0)
    curves = [curve({"excitation": name}, shares=share) for name, share in shares.items()]
    assert verdict("rotation, larger", curves) is Verdict.HOLDS
    assert "inverse" not in rotation_words(curves)


@pytest.mark.parametrize("along", ["D", "G"])
def test_beside_a_falling_peak_stands_what_stiffness_and_friction_do_alone(along: str) -> None:
    key, places = ("dimension", D) if along == "D" else ("scale", G)
    # the peak falls with the linear stuck peak, and by less: of friction alone it rises
    numbers = zip(places, (3e-5, 2.5e-5, 2e-5), (6e-5, 4e-5, 2.5e-5), strict=True)
    curves = [curve({key: place}, peak_m=peak, stuck_peak_m=stuck) for place, peak, stuck in numbers]
    claim = next(each for each in CLAIMS if each.name == f"peak, {along}")
    verdict_of = claim.judged(curves)
    assert verdict_of.verdict is Verdict.HOLDS
    assert verdict_of.answers[0].numbers.endswith("30, 25, 20 µm; linear stuck 60, 40, 25 µm")
    stiffness, friction = claim.beside_words(curves).split("Of friction alone")
    assert "linear stuck peak falls: holds (" in stiffness
    assert "falls: does not hold (" in friction


def test_verdicts_are_asked_of_both_sweeps() -> None:
    """The highest peaks fall along D; those of a slow sweep up rise, and one curve has no stable point for it."""
    ups = (1e-5, 1.2e-5, 1.4e-5)
    curves = [
        replace(one, swept={"up": replace(one, numbers={**one.numbers, "peak_m": up})})
        for one, up in zip(line("D", "peak_m", (3e-5, 2e-5, 1.5e-5)), ups, strict=True)
    ]
    statement = "The peak falls as D grows."
    (claim,) = (each for each in judged_claims(base_case(Scope()), curves) if each.statement == statement)
    assert claim.judged.verdict is claim.by_sweep["down"].verdict is Verdict.HOLDS
    assert claim.by_sweep["up"].verdict is Verdict.DOES_NOT_HOLD
    rows = [row for row in answers_table(curves).rows if row[0] == "peak, D"]
    assert [(row[1], row[3]) for row in rows] == [
        ("highest on the curve", "yes"), ("slow sweep up", "no"), ("slow sweep down", "yes")
    ]  # fmt: skip
    assert judged(curves, "peak, D")[1][0] == f"{statement} Of a slow sweep up:"
    words = folded_words(curves)
    assert words.startswith(
        "On 3 of 3 curves a slow sweep up does not reach the highest peak; its peak is lower by 40 %"
    )
    unseen = [replace(curves[0], swept={"up": None}), *curves[1:]]
    assert len(seen(unseen, "up")) == 2
    table = peak_table("peaks", "Peaks", unseen)
    places = {column.name: place for place, column in enumerate(table.columns)}
    assert np.isnan(table.rows[0][places["upward_peak"]])
    assert table.rows[1][places["upward_peak"]] == pytest.approx(12.0)
