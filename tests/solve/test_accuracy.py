"""A wanted accuracy in place of a number of harmonics: honest estimates, and harmonics that follow along the curve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castings import casting_case
from helpers import Blade, benchmark_module
from sentences import printed_sentence, rejects
from stickslip.core.errors import InputError
from stickslip.model.model import build_model
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic import neglected, varying_harmonics
from stickslip.solve.harmonic.checks import ResolutionCheck

pytestmark = pytest.mark.slow

make = benchmark_module("torture_problems").make
benchmark = benchmark_module("accuracy")
GAPS_HZ = (415.0, 490.0)  # the pairs close at 424 Hz and open at 478 Hz
FIRST_RISE_HZ = (420.0, 432.0)


@pytest.fixture(scope="module")
def gaps() -> ForcedResponse:
    """A chain with pairs that close and open, to 0.2 %."""
    response: ForcedResponse = make("gaps", 1).solve(window_hz=GAPS_HZ, harmonics=None, accuracy=0.002)
    return response


@pytest.mark.long
def test_each_point_has_as_many_harmonics_as_it_requires(gaps: ForcedResponse) -> None:
    assert gaps.converged
    assert gaps.point_harmonics is not None
    assert gaps.estimated_error is not None
    assert gaps.estimated_error.max() <= 0.002
    assert gaps.point_harmonics.min() == 3
    assert gaps.point_harmonics.max() == gaps.harmonics > 5
    order = (np.arange(gaps.displacement.shape[2]) + 1) // 2
    above = order[None, :] > gaps.point_harmonics[:, None]
    assert not gaps.displacement.transpose(0, 2, 1)[above].any()
    assert gaps.residual.max() < 1e-7
    assert not [sentence for sentence in gaps.warnings if "harmonics" in sentence]


@pytest.mark.long
def test_points_before_a_rise_have_an_estimate_of_their_own() -> None:
    """That of a neighbour with more harmonics says nothing about them."""
    response = make("sdof", 4).solve(harmonics=None, accuracy=0.001)
    rises = np.flatnonzero(np.diff(response.point_harmonics) > 0)
    assert rises.size
    assert (response.estimated_error[rises] != response.estimated_error[rises + 1]).all()


def test_no_estimate_is_below_a_tenth_of_the_accuracy(gaps: ForcedResponse) -> None:
    assert gaps.estimated_error is not None
    linear = gaps.moving_pairs == 0
    assert not gaps.estimated_error[linear].any()
    errors = gaps.estimated_error[gaps.estimated_error > 0.0]
    assert errors.size > gaps.n_points / 3
    assert errors.min() >= 0.1 * 0.002


def test_harmonics_rise_and_fall_along_the_curve(gaps: ForcedResponse) -> None:
    assert gaps.point_harmonics is not None
    change = np.diff(gaps.point_harmonics)
    assert change.max() > 0 > change.min()


def test_the_curve_says_what_it_reached(gaps: ForcedResponse) -> None:
    assert gaps.estimated_error is not None
    assert gaps.settings["accuracy"] == 0.002
    assert 0.0 < float(gaps.settings["estimated_error_of_the_peak"]) <= 0.002
    assert gaps.settings["error_by_neglected_harmonics"] == gaps.estimated_error.max()
    assert gaps.provenance["accuracy"].startswith(
        f"0.2 %, up to {gaps.harmonics} harmonics, estimated error of the peak"
    )


def test_a_file_contains_harmonics_and_errors_of_the_points(gaps: ForcedResponse, tmp_path: Path) -> None:
    gaps.save(tmp_path / "results.nc")
    assert ForcedResponse.load(tmp_path / "results.nc") == gaps


@pytest.mark.long
def test_points_with_different_harmonics_have_the_multipliers_of_one_number(gaps: ForcedResponse) -> None:
    fixed = make("gaps", 1).solve(window_hz=GAPS_HZ, harmonics=gaps.harmonics)
    assert gaps.stable is not None
    assert gaps.multipliers is not None
    assert gaps.stable.all()
    assert (np.diff(fixed.frequency_hz) > 0.0).all()
    sizes = np.interp(gaps.frequency_hz, fixed.frequency_hz, np.abs(fixed.multipliers[:, 0]))
    away = np.abs(np.abs(gaps.multipliers[:, 0]) - sizes)
    assert away.max() < 0.05
    assert away.mean() < 0.002


@pytest.mark.long
def test_a_traction_band_of_a_curve_with_different_harmonics_has_the_most_of_them(blade: Blade) -> None:
    response = blade.response(frequency_hz=(675.0, 700.0), samples=64, accuracy=0.002, traction_band=blade.tip)
    assert response.point_harmonics is not None
    assert response.point_harmonics.min() < response.harmonics
    assert response.traction_band is not None
    assert response.traction_band.complete.all()
    assert response.traction_band.displacement.shape[2] == 2 * response.harmonics + 1


@pytest.mark.long
def test_folds_where_the_harmonics_vary(blade: Blade) -> None:
    """The same folds as with a fixed number; the points between are unstable.

    Folds are 0.03 of their distance uncertain by the distance of the points.
    """
    window = {"frequency_hz": (675.0, 700.0), "samples": 128}
    varying, fixed = blade.response(accuracy=0.001, **window), blade.response(harmonics=7, **window)
    assert varying.point_harmonics is not None
    assert varying.point_harmonics.min() == 3
    assert varying.harmonics >= 5
    assert [each.kind for each in varying.bifurcations] == ["fold", "fold"] == [e.kind for e in fixed.bifurcations]
    actual, expected = (np.array([each.frequency_hz for each in r.bifurcations]) for r in (varying, fixed))
    assert actual == pytest.approx(expected, abs=0.03 * np.ptp(expected))
    assert varying.stable is not None
    between = np.diff(varying.frequency_hz) < 0.0
    assert not varying.stable[1:-1][between[:-1] & between[1:]].any()


@pytest.mark.long
def test_a_fixed_number_of_harmonics_has_no_errors_of_points(blade: Blade) -> None:
    """The default is five harmonics, exactly."""
    five, default = (blade.response(frequency_hz=(690.0, 735.0), samples=64, **more) for more in ({"harmonics": 5}, {}))
    assert five.point_harmonics is None
    assert five.estimated_error is None
    assert "accuracy" not in five.settings
    np.testing.assert_array_equal(five.displacement, default.displacement)


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "seed", "accuracy"), [("gaps", 1, 0.005), ("sdof", 4, 0.0005), ("close", 2, 0.0005), ("chain", 0, 0.0005)]
)
def test_the_estimate_is_never_below_half_of_the_true_error(kind: str, seed: int, accuracy: float) -> None:
    """Against 25 harmonics; benchmarks/accuracy.py does the same with 20 problems."""
    row = benchmark.measure(f"{kind}:{seed}", accuracy, with_cost=False)
    assert row.estimate <= accuracy
    assert row.true <= accuracy
    assert row.peak_true <= 2.0 * row.peak_estimate + benchmark.NEGLIGIBLE * accuracy
    assert 0.5 <= row.honesty < 9.0


@pytest.mark.long
def test_a_limit_of_the_work_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """Harmonics that would make the equations too large are not used, and the message says so."""
    monkeypatch.setattr(varying_harmonics, "ALWAYS_HARMONICS", 3)
    monkeypatch.setattr(varying_harmonics, "MOST_ROWS", 0)
    response = make("gaps", 1).solve(harmonics=None, accuracy=0.002)
    assert response.converged
    assert response.harmonics == 3
    assert response.estimated_error.max() > 0.002
    printed_sentence("\n".join(response.warnings), numbers=False)


@pytest.mark.long
def test_without_steps_that_help_the_tangent_alone_gives_the_estimate(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is of the size of the usual one, not zero."""
    name = "error_by_neglected_harmonics"
    usual = float(make("gaps", 1).solve(window_hz=FIRST_RISE_HZ, harmonics=3).settings[name])
    monkeypatch.setattr(neglected, "MOST_STEPS", 0)
    tangent_alone = float(make("gaps", 1).solve(window_hz=FIRST_RISE_HZ, harmonics=3).settings[name])
    assert 0.5 * usual < tangent_alone < 3.0 * usual


def test_an_error_of_the_whole_motion_is_reported() -> None:
    check = ResolutionCheck(1e-4, 1.0, neglected.UNKNOWN, 2.0 * np.pi * 50.0, None, accuracy=0.005)
    (sentence,) = check.warnings(7, 256)
    printed_sentence(sentence, "or not known")


@pytest.mark.parametrize(
    ("harmonics", "samples", "damped", "more"),
    [
        (3, 128, None, 7),
        (5, 256, 20, 10),
        (15, 256, None, 30),
        (15, 256, 20, 20),
        (21, 256, 20, 25),
        (21, 64, None, 31),
    ],
)
def test_estimates_have_twice_the_harmonics_within_samples_and_damping(
    harmonics: int, samples: int, damped: int | None, more: int
) -> None:
    assert neglected.more_harmonics(harmonics, samples, damped) == more


@pytest.mark.long
def test_an_accuracy_that_the_samples_do_not_allow_is_reported() -> None:
    coarse = make("gaps", 1).solve(window_hz=FIRST_RISE_HZ, harmonics=None, accuracy=1e-5, samples=64)
    assert coarse.estimated_error.max() > 1e-5
    printed_sentence("\n".join(coarse.warnings), "0.001 %", f"{coarse.harmonics} harmonics", numbers=False)
    assert coarse.harmonics <= 16


def test_wrong_accuracies_are_rejected(blade: Blade) -> None:
    def solve(**more: object) -> None:
        forced_response(blade.superelement, blade.pairs, blade.force_cos, frequency_hz=(690.0, 735.0), **more)  # type: ignore[arg-type]

    with rejects(InputError, "harmonics", "accuracy"):
        solve(harmonics=5, accuracy=0.005)
    for value in (0.0, 0.5, 1e-7, "0.5 %"):
        with rejects(InputError, "accuracy"):
            solve(accuracy=value)
    with rejects(InputError, "samples"):
        solve(accuracy=0.005, samples=32)


@pytest.mark.long
def test_resonances_without_damping_are_no_false_alarm() -> None:
    """The default case with 15 harmonics: the stuck modes above 20 times the excitation have no damping, but the
    amplitude is that with 9 harmonics to 0.1 %."""
    model = build_model(casting_case())
    (many, few) = (
        forced_response(
            model.superelement, model.pairs, model.excitation, frequency_hz=(454.5, 452.3), harmonics=harmonics,
            modal_damping_ratio=0.001, samples=128,
        )
        for harmonics in (15, 9)
    )  # fmt: skip
    output = next(iter(model.outputs.values()))
    assert many.amplitude(output).max() == pytest.approx(few.amplitude(output).max(), rel=1e-3)
    assert not [sentence for sentence in many.warnings if "Too few harmonics" in sentence]
    assert float(many.settings["error_by_neglected_harmonics"]) < 0.01
