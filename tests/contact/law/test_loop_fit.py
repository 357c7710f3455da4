"""Constants of hysteresis loops: closed forms, an independent element, coverage of the intervals, bad input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.contact.law.loop_fit import correlation_length, loop_force
from stickslip.core.errors import InputError

AMPLITUDE, CYCLE = 1e-3, 240
STIFFNESS, LIMIT, BACKLASH = 2e6, 500.0, 3e-4


def path(cycles: int = 3) -> np.ndarray:
    return AMPLITUDE * np.sin(2.0 * np.pi * np.arange(cycles * CYCLE) / CYCLE + 0.3)


def loops(backlash: float = BACKLASH, noise: float = 0.0, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and force, after two cycles in which the slider settles."""
    along = path(5)
    force = loop_force(along, STIFFNESS, LIMIT, backlash)
    settled = slice(2 * CYCLE, None)
    scatter = noise * np.random.default_rng(seed).standard_normal(3 * CYCLE)
    return along[settled], force[settled] + 20.0 + scatter


def test_the_constants_of_a_synthetic_loop_come_back_without_noise() -> None:
    fit = ss.fit_loops(*loops(), normal_load=1000.0)
    assert fit.tangential_stiffness == pytest.approx(STIFFNESS, rel=1e-4)
    assert fit.friction_limit == pytest.approx(LIMIT, rel=1e-5)
    assert fit.backlash == pytest.approx(BACKLASH, rel=1e-3)
    assert fit.force_offset == pytest.approx(20.0, abs=0.01)
    assert fit.friction_coefficient == pytest.approx(0.5, rel=1e-5)
    assert fit.misfit < 1e-4 < 0.05 < fit.misfit_without_backlash
    assert fit.warnings == ()


@pytest.mark.slow
@pytest.mark.parametrize("backlash", [0.0, BACKLASH])
def test_energy_of_a_cycle_is_the_closed_form(backlash: float) -> None:
    """4 F (X - F / k - g / 2): the area of the loop, from the force and from the constants."""
    fit = ss.fit_loops(*loops(backlash))
    expected = 4.0 * LIMIT * (AMPLITUDE - LIMIT / STIFFNESS - 0.5 * backlash)
    assert fit.energy_per_cycle(AMPLITUDE) == pytest.approx(expected, rel=1e-4)
    assert fit.cycle_energy == pytest.approx(expected, rel=2e-3)  # chords instead of the corners of the loop
    assert fit.energy_per_cycle(1e-5) == 0.0


def test_without_backlash_the_model_is_the_jenkins_element() -> None:
    """The law of the solver, another code, along the same path."""
    element = ss.JenkinsElement(np.array([STIFFNESS]), np.array([LIMIT]))
    memory, along, traction = element.memory_at_rest(), path(2), []
    for value in along:
        step = element.slide(np.array([[value, 0.0]]), memory)
        memory = step.memory
        traction.append(step.force[0, 0])
    own = loop_force(np.concatenate([[0.0], along]), STIFFNESS, LIMIT, 0.0)[1:]
    assert own == pytest.approx(np.array(traction), abs=1e-9 * LIMIT)


@pytest.mark.slow
def test_intervals_contain_the_truth_in_about_95_percent_of_seeds() -> None:
    truth = np.array([STIFFNESS, LIMIT, BACKLASH])
    inside = np.zeros(3)
    for seed in range(60):
        fit = ss.fit_loops(*loops(noise=25.0, seed=seed))
        intervals = np.array([fit.tangential_stiffness_interval, fit.friction_limit_interval, fit.backlash_interval])
        inside += (intervals[:, 0] <= truth) & (truth <= intervals[:, 1])
    assert (inside >= 52).all()  # 57 are expected; 51 or fewer have a probability below 1 %
    assert inside.sum() <= 178  # all 180 would be intervals without end


@pytest.mark.slow
def test_a_loop_without_backlash_is_a_jenkins_element_in_nearly_all_seeds() -> None:
    found = [ss.fit_loops(*loops(0.0, noise=25.0, seed=seed)).backlash for seed in range(20)]
    assert sum(value > 0.0 for value in found) <= 1


def test_correlated_scatter_widens_the_intervals() -> None:
    """Scatter that repeats eight times has an eighth of the independent samples: intervals are sqrt(8) as wide."""
    along, force = loops()
    scatter = 25.0 * np.random.default_rng(3).standard_normal(force.size)
    slow = np.repeat(scatter[: force.size // 8], 8)
    white, coloured = ss.fit_loops(along, force + scatter), ss.fit_loops(along, force + slow)
    width = [np.diff(fit.friction_limit_interval)[0] for fit in (white, coloured)]
    assert 1.7 < width[1] / width[0] < 4.5
    assert correlation_length(slow) == pytest.approx(8.0, rel=0.4)
    assert correlation_length(scatter) == pytest.approx(1.0, abs=0.3)
    assert correlation_length(np.zeros(50)) == 1.0


@pytest.mark.slow
def test_another_normal_load_changes_the_friction_limit_alone() -> None:
    fit = ss.fit_loops(*loops(), normal_load=1000.0)
    double = 4.0 * 2.0 * LIMIT * (AMPLITUDE - 2.0 * LIMIT / STIFFNESS - 0.5 * BACKLASH)
    assert fit.energy_per_cycle(AMPLITUDE, normal_load=2000.0) == pytest.approx(double, rel=1e-3)
    with rejects(InputError, "normal_load"):
        ss.fit_loops(*loops()).energy_per_cycle(AMPLITUDE, normal_load=2000.0)


def test_a_loop_of_another_shape_has_a_warning() -> None:
    along = path()
    ellipse = 500.0 * np.cos(2.0 * np.pi * np.arange(along.size) / CYCLE + 0.3)  # a viscous damper
    fit = ss.fit_loops(along, ellipse)
    assert fit.misfit > 0.2
    printed_sentence("\n".join(fit.warnings))


def test_a_stiffness_that_the_samples_do_not_show_has_a_warning() -> None:
    along = path()
    force = loop_force(np.concatenate([along, along]), 1e9, LIMIT, 0.0)[along.size :]
    printed_sentence("\n".join(ss.fit_loops(along, force).warnings))


def bad(case: str) -> tuple[Any, Any]:
    along, force = loops()
    return {
        "nan": (along, np.where(np.arange(force.size) == 7, np.nan, force)),
        "lengths": (along, force[:-1]),
        "few": (along[:10], force[:10]),
        "open": (along[: CYCLE // 3], force[: CYCLE // 3]),
        "coarse": (along[::20], force[::20]),
        "sign": (along, -force),
        "stuck": (along, STIFFNESS * along + 1e-4 * force),  # the area is no round-off, which differs between machines
        "constant": (along, np.where(np.arange(force.size) == 7, 1.0, 0.0) * np.sign(np.gradient(along))),
    }[case]


@pytest.mark.parametrize(
    ("case", "keys"),
    [
        ("nan", ["force"]),
        ("lengths", ["displacement", "force"]),
        ("few", ["displacement"]),
        ("open", ["displacement"]),
        ("coarse", ["displacement"]),
        ("sign", ["force"]),
        ("stuck", ["displacement"]),
        ("constant", ["force"]),
    ],
)
def test_bad_loops_end_in_a_sentence(case: str, keys: list[str]) -> None:
    with rejects(InputError, *keys):
        ss.fit_loops(*bad(case))


def test_a_normal_load_of_zero_is_rejected() -> None:
    with rejects(InputError, "normal_load"):
        ss.fit_loops(*loops(), normal_load=0.0)
