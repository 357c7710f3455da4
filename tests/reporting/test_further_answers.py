"""The words at the top of the page on the analyses beside the frequency curve."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from ridges import ridge_of, valley
from stickslip.reporting.further_answers import further_answers
from stickslip.reporting.verdict import verdict
from stickslip.reporting.view import View
from stickslip.results.checked_peak import CheckedPeak
from synthetic import synthetic_response, synthetic_study

LOADS = np.geomspace(0.1, 10.0, 15)


def answers(**parts: Any) -> list[str]:
    response = replace(synthetic_response(), **parts)
    return list(further_answers(View.of(response, synthetic_study())))


def performance(**changes: Any) -> ss.PeakRidge:
    settings = {"harmonics": 1, "centrifugal_force_n": 600.0, "excitation_force_n": 300.0}
    return ridge_of((LOADS, valley(LOADS, best=1.0)), parameter_unit="", settings=settings, **changes)


def test_a_curve_alone_has_no_further_answer() -> None:
    assert answers() == []


def test_the_best_load_is_in_newton_beside_that_of_the_study() -> None:
    (words,) = answers(performance_curve=performance())
    assert words.startswith(
        "Over the centrifugal force of the damper the highest peak has its lowest minimum with slip"
    )
    assert words.endswith("at 300 N: 14.14 µm; this study has 600 N.")
    (checked,) = answers(performance_curve=performance(checked=(CheckedPeak(1.0, 1.5e-5, 49.5, 0.004, 7),)))
    assert checked.endswith("at 300 N: 15 µm, checked by a whole curve; this study has 600 N.")


def test_a_sharp_minimum_is_called_so() -> None:
    steep = 1e-5 * (valley(LOADS, best=1.0) / valley(np.ones(1), best=1.0)) ** 40.0  # 1.64 times as high at 1.25 N
    (words,) = answers(peak_ridge=ridge_of((LOADS, steep), parameter_name="preload.force"))
    assert re.search(r" at 1 N: 10 µm\. It is sharp: (1\.25|0\.8) N has 16\.\d+ µm\.$", words)
    (flat,) = answers(peak_ridge=ridge_of((LOADS, valley(LOADS, best=1.0)), parameter_name="preload.force"))
    assert "sharp" not in flat


def test_a_minimum_without_slip_is_no_best_load() -> None:
    stuck = np.zeros(LOADS.size, dtype=int)
    (words,) = answers(performance_curve=performance(pairs_stick_slip=stuck, pairs_separating=stuck))
    assert "no minimum of the highest peak has slip" in words


def test_peaks_over_a_key_have_its_unit() -> None:
    (words,) = answers(peak_ridge=ridge_of((LOADS, valley(LOADS, best=1.0)), parameter_name="preload.force"))
    assert words == "Over preload.force the highest peak has its lowest minimum with slip at 1 N: 14.14 µm."


def view_with(**parts: Any) -> Any:
    names = ("performance_curve", "peak_ridge", "nonlinear_mode", "quasi_static_mode", "wear", "mistuning")
    return SimpleNamespace(response=SimpleNamespace(**(dict.fromkeys(names) | parts)))


def answer_of_mode(damping: list[float], **changes: Any) -> str:
    output = np.array([1e-6, 2e-6, 4e-6])
    values: dict[str, Any] = {"converged": True, "warnings": (), "frequency_hz": np.array([500.0, 490.0, 480.0])}
    mode = SimpleNamespace(
        mode=3, damping_ratio=np.array(damping), harmonic_amplitude=lambda row, harmonic: output, **(values | changes)
    )
    view = view_with(nonlinear_mode=mode)
    view.output, view.study = np.ones(1), SimpleNamespace(response_output="tip")
    (words,) = further_answers(view)
    return words


def test_a_mode_has_the_largest_damping_ratio_also_between_its_ends() -> None:
    start = "From 1 to 4 µm of tip, mode 3 goes from 500.00 to 480.00 Hz, and its damping ratio goes from 0.1 to "
    assert answer_of_mode([0.001, 0.0329, 0.0116]) == f"{start}1.16 %, with a maximum of 3.29 % at 2 µm."
    assert answer_of_mode([0.001, 0.0116, 0.0329]) == f"{start}3.29 %."
    assert answer_of_mode([0.001, 0.0329001, 0.0329]) == f"{start}3.29 %."  # the same number


def test_a_mode_that_does_not_change_remains_constant() -> None:
    constant = answer_of_mode([0.001] * 3, frequency_hz=np.array([462.791, 462.79, 462.789]))
    assert constant.endswith("mode 3 remains constant at 462.79 Hz, and its damping ratio remains constant at 0.1 %.")
    assert "goes from 462.79 to 462.79 Hz" in answer_of_mode([0.001] * 3, frequency_hz=np.array([462.79, 460, 462.79]))


@pytest.mark.parametrize(
    ("converged", "warnings", "clause"),
    [
        (True, ("A.", "B."), "; section “Nonlinear mode” has 2 warnings on it."),
        (False, (), "; it is not complete."),
        (False, ("A.",), "; it is not complete, and section “Nonlinear mode” has 1 warning on it."),
    ],
)
def test_what_limits_trust_in_a_mode_is_beside_its_answer(
    converged: bool, warnings: tuple[str, ...], clause: str
) -> None:
    assert answer_of_mode([0.001, 0.002, 0.003], converged=converged, warnings=warnings).endswith(f"0.3 %{clause}")


def test_wear_says_what_it_does_to_the_peak() -> None:
    cycles, depth = np.array([0.0, 3e6]), np.array([[0.0, 0.0], [2e-6, 6e-6]])
    wear = SimpleNamespace(cycles=cycles, depth=depth, amplitude=np.array([1e-4, 1.2e-4]))
    (words,) = further_answers(view_with(wear=wear))
    assert words == "After 3 × 10⁶ cycles of wear, up to 6 µm deep, the peak is 120 µm (+20 %)."


def test_mistuning_names_the_contact_of_its_factors() -> None:
    limits = {"contacts stuck": np.array([[1.0, 1.68], [1.2, 1.1]])}
    mistuning = SimpleNamespace(limits=limits, friction_factor=np.array([1.1, 1.31]), shown=0)
    (words,) = further_answers(view_with(mistuning=mistuning))
    assert words.endswith("blades is 1.68 at most (contacts stuck), 1.31 (with friction, pattern 1).")


@pytest.mark.parametrize("count", [0, 1])
def test_they_follow_the_answer_on_the_peak(count: int) -> None:
    response = synthetic_response()
    if count:
        response = replace(response, performance_curve=performance())
    sentences = verdict(View.of(response, synthetic_study()), warnings=0).sentences
    assert sum("centrifugal force of the damper" in each for each in sentences) == count
