"""The modelling choices on the page: numbers of this run where it has them, else the documented order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from law_makers import exponential
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactLaw
from stickslip.core.shown_numbers import number
from stickslip.reporting.assumption_section import Assumption, assumptions
from stickslip.reporting.page import page
from stickslip.reporting.view import View
from stickslip.results.peak_gradients import PeakGradients
from stickslip.results.record import CONSTANT_STIFFNESS_PEAK
from stickslip.results.response import ForcedResponse
from stickslip.results.stiffness_band import StiffnessBand
from synthetic import synthetic_response, synthetic_study

STUDY = synthetic_study(columns=4, rows=3)


def response() -> ForcedResponse:
    return synthetic_response(columns=4, rows=3, n_points=20)


def rows_of(curve: ForcedResponse, inputs: str = STUDY.inputs) -> dict[str, Assumption]:
    return {row.choice: row for row in assumptions(View.of(curve, replace(STUDY, inputs=inputs)))}


def test_the_effect_of_the_stiffness_is_its_band_if_the_run_has_it() -> None:
    curve = response()
    rough = "[roughness]\nsq = 1e-6\n"
    without = rows_of(curve, rough)["Contact stiffness"]
    assert not without.computed
    assert "analysis.stiffness_band" in without.effect
    displacement = np.concatenate([0.9 * curve.displacement, 1.2 * curve.displacement])
    band = StiffnessBand(
        ("× 1/3", "× 3"), np.array([True, True]), np.repeat([0, 1], curve.n_points), np.tile(curve.frequency_hz, 2),
        displacement, np.array([1 / 3, 3.0]),
    )  # fmt: skip
    banded = replace(curve, stiffness_band=band)
    row, measures = rows_of(banded, rough)["Contact stiffness"], View.of(banded, STUDY).summary
    assert row.computed
    assert f"{0.9e6 * measures.peak.amplitude:.4g} to {1.2e6 * measures.peak.amplitude:.4g} µm" in row.effect
    assert "not measured" in row.here
    assert rows_of(curve, "[contact_stiffness]\nnormal_stiffness = 1e8\n")["Contact stiffness"].here == (
        "given in the study"
    )


def test_gradients_give_the_effect_of_friction_and_damping() -> None:
    curve = response()
    plain = rows_of(curve)["Friction coefficient"]
    assert not plain.computed
    value, zero = np.array([0.3, 1e-3]), np.zeros(2)
    gradients = PeakGradients(
        ("friction.coefficient", "damping.modal_damping_ratio"), ("", ""), value, np.array(1e-4), np.array(450.0),
        np.array(1e-5), np.array([-2e-4, -0.02]), zero, zero, zero, zero, zero,
    )  # fmt: skip
    rows = rows_of(replace(curve, gradients=gradients))
    assert rows["Friction coefficient"].computed
    assert "10 % more: −6 % of the peak" in rows["Friction coefficient"].effect  # 0.1 * 0.3 * -2e-4 / 1e-4
    assert "10 % more: −2 % of the peak" in rows["Damping of the structure"].effect


def test_the_variation_of_the_normal_force_is_that_of_the_cycle_at_the_peak() -> None:
    curve = response()
    force = curve.pair_cycle(View.of(curve, STUDY).point).force[:, :, 2]
    load = curve.pairs.normal_load
    varies = 50.0 * np.ptp(force, axis=0)[load > 0.0] / load[load > 0.0]
    assert f"largest ±{number(varies.max(), 2)} %" in rows_of(curve)["Contact stiffness during the cycle"].effect


def test_a_law_that_follows_the_pressure_says_so() -> None:
    curve = response()
    one = np.ones(curve.pairs.n_pairs)
    law = exponential(1e6 * one, 1e6 * one, 0.3 * one, 10.0 * one)
    followed = replace(curve, pairs=ContactPairs.with_laws(curve.pairs.operator, [law]))
    row = rows_of(followed)["Contact stiffness during the cycle"]
    assert "follows the momentary pressure" in row.here
    assert not row.computed
    peak = View.of(followed, STUDY).summary.peak
    constant = (
        (CONSTANT_STIFFNESS_PEAK, 1e6 * peak.amplitude / 1.1, "µm", ""),
        (f"{CONSTANT_STIFFNESS_PEAK}: frequency", peak.frequency_hz + 2.0, "Hz", ""),
    )
    view = View.of(followed, replace(STUDY, derived=constant))
    beside = {each.choice: each for each in assumptions(view)}["Contact stiffness during the cycle"]
    assert beside.computed
    assert beside.effect.startswith("10 % of the peak and −2")


def test_a_joint_with_some_pairs_of_that_law_gives_their_number() -> None:
    curve = response()
    n_pairs = curve.pairs.n_pairs
    some = np.ones(n_pairs - 1)
    laws: list[ContactLaw] = [
        curve.pairs.coulomb.of_members(np.array([0])),
        exponential(1e6 * some, 1e6 * some, 0.3 * some, 10.0 * some),
    ]
    mixed = replace(curve, pairs=ContactPairs.with_laws(curve.pairs.operator, laws))
    here = rows_of(mixed)["Contact stiffness during the cycle"].here
    assert f"in {n_pairs - 1} of {n_pairs} pairs" in here


@pytest.mark.slow
def test_what_this_run_computed_comes_first_and_the_page_has_all_rows() -> None:
    view = View.of(response(), STUDY)
    rows = assumptions(view)
    computed = [row.computed for row in rows]
    assert computed == sorted(computed, reverse=True)
    assert {row.source for row in rows} == {"this run", "documented"}
    text = page(view.response, STUDY)
    section = text[text.index("<h2>Modelling choices and their effect on the peak</h2>") :].partition("</section>")[0]
    assert section.count('<th scope="row">') == len(rows)


@pytest.mark.slow
@pytest.mark.parametrize("choice", ["Pressure at rest", "Mean traction of stuck pairs", "Wear", "Small displacements"])
def test_the_choices_that_a_tribologist_asks_about_are_there(choice: str) -> None:
    assert choice in rows_of(response())
