"""Samples of a band are solved with the harmonics of the central curve, and again where that is not accurate enough."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from band_cases import FORCE, linear_study, peak_m
from law_studies import REST, interface_text, write_masses, write_study
from stickslip.case.case import Case
from stickslip.core.progress import SilentProgress
from stickslip.model.model import build_model
from stickslip.results.peaks import Peak, peaks
from stickslip.results.response import ForcedResponse
from stickslip.results.sweep_table import Again
from stickslip.study import analyses
from stickslip.study.analyses import SOLVED_AGAIN, again_because, forced_curve, sample_curve, solve
from stickslip.sweeps import work
from stickslip.sweeps.band import Band

pytestmark = pytest.mark.slow

ACCURACY = 0.02
OUTPUT = np.array([1.0, 0.0, 0.0])
SCATTER = {FORCE: "1.5 N .. 2 N"}


@pytest.fixture(scope="module")
def slipping(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """One mass whose joint slips at the peak, with an accuracy."""
    folder = tmp_path_factory.mktemp("slipping")
    write_masses(folder)
    rest = REST.replace("[solver]", '[solver]\naccuracy = "2 %"\nsamples = 256')
    return ss.load_case(write_study(folder, interface_text("joint", "coulomb"), rest=rest))


@pytest.fixture(scope="module")
def whole(slipping: Case) -> ForcedResponse:
    """The curve of a single case, with points as accurate as the study asks."""
    return forced_curve(slipping, build_model(slipping), SilentProgress(), 1, checks=False)


def sample(case: Case, harmonics: int) -> ForcedResponse:
    return sample_curve(case, build_model(case), SilentProgress(), 1, harmonics)


def highest(response: ForcedResponse) -> Peak:
    return peaks(response.frequency_hz, response.amplitude(OUTPUT))[0]


def test_a_sample_that_only_sticks_is_exact_and_needs_no_iteration(tmp_path: Path) -> None:
    case = ss.load_case(linear_study(tmp_path)).replace(
        {"solver.harmonics": None, "solver.accuracy": "2 %", "solver.samples": 64}
    )
    response = sample(case, 3)
    assert highest(response).amplitude == pytest.approx(peak_m(2e-3, 0.02), rel=1e-5)
    assert response.residual.max() < 1e-12
    assert response.iterations[:-1].tolist() == [0] * (response.n_points - 1)
    assert response.frequency_hz[[0, -1]] == pytest.approx([19.0, 24.0], rel=1e-12)
    assert SOLVED_AGAIN not in response.settings


def test_a_sample_agrees_with_the_whole_curve_within_the_accuracy(slipping: Case, whole: ForcedResponse) -> None:
    response = sample(slipping, whole.harmonics)
    assert (response.contact_state != 0).any()  # it slips
    settings = response.settings
    assert (settings["harmonics"], settings["samples"]) == (whole.harmonics, 128)
    assert settings["newton_tolerance"] == 1e-4 * ACCURACY
    assert settings["newton_tolerance_away_from_peaks"] == 2e-2 * ACCURACY
    assert response.n_points < whole.n_points
    assert response.point_harmonics is None
    quick, known = highest(response), highest(whole)
    assert quick.amplitude == pytest.approx(known.amplitude, rel=ACCURACY)
    assert quick.frequency_hz == pytest.approx(known.frequency_hz, rel=1e-3)
    # no point between the two curves is further away than the accuracy and the interpolation of both
    at = np.linspace(16.0, 29.0, 60)
    ours, other = (np.interp(at, each.frequency_hz, each.amplitude(OUTPUT)) for each in (response, whole))
    np.testing.assert_allclose(ours, other, atol=ACCURACY * known.amplitude)


def test_only_the_peaks_of_a_sample_have_many_digits(
    slipping: Case, whole: ForcedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = sample(slipping, whole.harmonics)
    monkeypatch.setattr(analyses, "DIGITS_ELSEWHERE", analyses.DIGITS)
    many = sample(slipping, whole.harmonics)
    assert few.iterations.sum() < many.iterations.sum()
    ours, other = highest(few), highest(many)
    assert ours.amplitude == pytest.approx(other.amplitude, rel=0.02 * ACCURACY)
    assert ours.frequency_hz == pytest.approx(other.frequency_hz, rel=1e-4)
    at_peak = int(few.amplitude(OUTPUT).argmax())
    assert few.residual[at_peak] <= 1e-2 * few.residual.max()


def test_a_sample_with_too_few_harmonics_is_solved_again_with_more(slipping: Case, whole: ForcedResponse) -> None:
    response = sample(slipping, 1)
    kinds = again_because(response.settings)
    assert set(kinds) == {Again.HARMONICS}
    assert response.harmonics == 1 + 2 * len(kinds)
    assert response.n_points < whole.n_points
    assert float(response.settings["error_by_neglected_harmonics"]) <= ACCURACY
    assert highest(response).amplitude == pytest.approx(highest(whole).amplitude, rel=ACCURACY)
    first = str(response.settings[SOLVED_AGAIN]).split("; then ")[0]
    assert float(first.removeprefix("the estimated error by neglected harmonics is ").removesuffix(" %")) > 2.0


def test_a_sample_whose_harmonics_remain_too_few_is_solved_as_a_single_case(
    slipping: Case, whole: ForcedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(analyses, "MOST_TRIES", 0)
    response = sample(slipping, 1)
    assert np.array_equal(response.frequency_hz, whole.frequency_hz)
    assert np.array_equal(response.displacement, whole.displacement)
    assert again_because(response.settings) == (Again.HARMONICS,)


def test_a_sample_with_too_few_samples_of_a_period_is_solved_again(
    slipping: Case, whole: ForcedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(analyses, "SAMPLED_SHARE", 0.0)
    response = sample(slipping, whole.harmonics)
    assert np.array_equal(response.displacement, whole.displacement)
    assert str(response.settings[SOLVED_AGAIN]).startswith("the residual with doubled samples is ")


def test_where_only_the_samples_are_too_few_a_quick_curve_with_more_follows(
    slipping: Case, whole: ForcedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick = sample(slipping, whole.harmonics)
    coarse = float(quick.settings["residual_with_doubled_samples"])
    monkeypatch.setattr(analyses, "SAMPLED_SHARE", 0.7 * coarse / ACCURACY)  # that of more samples is smaller
    response = sample(slipping, whole.harmonics)
    assert response.settings["samples"] == 256
    assert response.settings["newton_tolerance"] == 1e-4 * ACCURACY
    assert float(response.settings["residual_with_doubled_samples"]) < 0.7 * coarse
    assert response.settings[SOLVED_AGAIN] == f"the residual with doubled samples is {100.0 * coarse:.2g} %"
    assert response.n_points < whole.n_points


def test_the_linear_limits_of_a_sample_have_few_points_and_the_same_peaks(
    slipping: Case, whole: ForcedResponse
) -> None:
    response = sample(slipping, whole.harmonics)
    assert response.linear.frequency_hz.size < 0.5 * whole.linear.frequency_hz.size
    for limit in ("stuck", "free"):
        ours, other = (
            peaks(each.linear.frequency_hz, each.linear_amplitude(OUTPUT, limit))[0] for each in (response, whole)
        )
        assert ours.bracketed == other.bracketed
        assert ours.amplitude == pytest.approx(other.amplitude, rel=1e-4)
        assert ours.frequency_hz == pytest.approx(other.frequency_hz, rel=1e-6)


@pytest.mark.long
def test_a_sample_whose_quick_curve_ends_early_is_solved_again(
    slipping: Case, whole: ForcedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    numbers = analyses.CurveNumbers(whole.harmonics, 128, 1e-300, 1e-300, 0.1)  # no digits reach this tolerance
    monkeypatch.setattr(analyses, "_quick_numbers", lambda *arguments: numbers)
    response = sample(slipping, whole.harmonics)
    assert response.converged
    assert np.array_equal(response.displacement, whole.displacement)
    assert response.settings[SOLVED_AGAIN]


@pytest.mark.long
def test_samples_have_the_harmonics_of_the_central_curve(
    slipping: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The central curve is solved before them; a second band into the folder reuses it."""
    given: list[object] = []

    def seen(*arguments: object, **options: object) -> object:
        given.append(options["harmonics"])
        return solve(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(work, "solve", seen)

    def banded(samples: int, *limits: str) -> Band:
        return ss.band(slipping, SCATTER, out=tmp_path, samples=samples, limits=limits, workers=1)

    first = banded(8)
    assert given == [None, *8 * given[1:2]]
    assert isinstance(given[1], int)
    assert len(first.table.rows) == 8
    given.clear()
    more = banded(10)
    assert (more.reused, len(given)) == (8, 2)
    assert more.table.rows[:8] == first.table.rows
    given.clear()
    banded(8, "upward_peak_amplitude < 1 m")  # stability decides, so each sample is a whole curve
    assert given == [None] * 8
