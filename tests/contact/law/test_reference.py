"""The closed forms: printed numbers, their own integrals by quadrature, continuity, and refused input."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.law.closed_forms import (
    FrictionLoop,
    circular_force,
    hertz_sphere,
    in_phase_loop,
    jenkins_loop,
    mindlin_stiffness,
    quadrature_loop,
)
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray

SPRING, FRICTION, AMPLITUDE = 3.0, 0.4, 1.1

LOOPS: dict[str, tuple[FrictionLoop, Callable[[FloatArray], FloatArray]]] = {
    "jenkins": (jenkins_loop(SPRING, FRICTION, 2.0, AMPLITUDE), lambda t: 2.0 + 0.0 * t),
    "in phase": (in_phase_loop(SPRING, FRICTION, 2.0, 1.1, AMPLITUDE), lambda t: 2.0 + 1.1 * np.cos(t)),
    "in phase, negative": (in_phase_loop(SPRING, FRICTION, 2.0, -0.7, AMPLITUDE), lambda t: 2.0 - 0.7 * np.cos(t)),
    "quadrature": (quadrature_loop(SPRING, FRICTION, 2.0, 1.1, AMPLITUDE), lambda t: 2.0 + 1.1 * np.sin(t)),
    "quadrature, negative": (quadrature_loop(SPRING, FRICTION, 2.0, -0.8, AMPLITUDE), lambda t: 2.0 - 0.8 * np.sin(t)),
    "separation": (
        in_phase_loop(SPRING, FRICTION, 1.0, 2.5, AMPLITUDE),
        lambda t: np.maximum(1.0 + 2.5 * np.cos(t), 0.0),
    ),
}


def test_jenkins_numbers() -> None:
    loop = LOOPS["jenkins"][0]
    np.testing.assert_allclose(loop.coefficients, [0.0, 0.6177283305, -0.7716603301], atol=6e-11)
    assert loop.dissipated_energy == pytest.approx(4.0 * 0.8 * (AMPLITUDE - 0.8 / SPRING), rel=1e-14)
    share = 1.0 - 2.0 * 0.8 / (SPRING * AMPLITUDE)
    stick = math.acos(share)
    first = SPRING * AMPLITUDE / np.pi * (stick - 0.5 * math.sin(2.0 * stick))
    assert loop.coefficients[1] == pytest.approx(first, rel=1e-14)


def test_in_phase_numbers() -> None:
    loop = LOOPS["in phase"][0]
    np.testing.assert_allclose(loop.coefficients, [0.2594312585, 0.6458754273, -0.7280143839], atol=6e-11)
    assert loop.dissipated_energy == pytest.approx(2.515837104, rel=4e-10)


def test_quadrature_numbers() -> None:
    loop = LOOPS["quadrature"][0]
    assert loop.coefficients[0] == pytest.approx(-0.2134267024, rel=4e-10)
    assert loop.dissipated_energy == pytest.approx(2.650694263, rel=4e-10)


def test_separation_numbers() -> None:
    loop = LOOPS["separation"][0]
    assert loop.coefficients[0] == pytest.approx(0.351444191, rel=4e-10)
    assert loop.dissipated_energy == pytest.approx(1.153209302, rel=4e-10)


def test_circular_numbers() -> None:
    circle = circular_force(SPRING, FRICTION, 2.0, AMPLITUDE)
    assert math.hypot(circle.radial, circle.tangential) == pytest.approx(0.8, rel=1e-14)
    assert circle.radial / 0.8 == pytest.approx(0.8 / (SPRING * AMPLITUDE), rel=1e-14)
    energy = 2.0 * np.pi * 0.8 * math.sqrt(AMPLITUDE**2 - (0.8 / SPRING) ** 2)
    assert circle.dissipated_energy == pytest.approx(energy, rel=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("name", LOOPS)
def test_coefficients_are_the_integrals_of_the_signal(name: str) -> None:
    loop = LOOPS[name][0]
    t = 2.0 * np.pi * (np.arange(200_000) + 0.5) / 200_000
    force = loop.force(t)
    by_sum = [force.mean(), 2.0 * np.mean(force * np.cos(t)), 2.0 * np.mean(force * np.sin(t))]
    np.testing.assert_allclose(loop.coefficients, by_sum, atol=2e-8)


@pytest.mark.parametrize("name", LOOPS)
def test_signal_keeps_the_friction_law(name: str) -> None:
    """Within the limit always; where inside it the force follows the spring, where on it the work is not negative."""
    loop, normal = LOOPS[name]
    t = 2.0 * np.pi * (np.arange(20_000) + 0.5) / 20_000
    force, limit = loop.force(t), FRICTION * normal(t)
    assert np.all(np.abs(force) <= limit + 1e-12)
    slider = AMPLITUDE * np.cos(t) - force / SPRING
    moved, middle = np.diff(slider), 0.5 * (force[1:] + force[:-1])
    stick = (np.abs(force) < limit - 1e-3)[1:]
    assert stick.any()
    assert np.all(np.abs(moved[stick]) < 1e-12)
    touchdown = np.abs(np.diff(force)) > 1e-2
    assert np.all((moved * middle)[~touchdown] > -1e-12)


@pytest.mark.parametrize("name", LOOPS)
def test_signal_is_continuous(name: str) -> None:
    loop: FrictionLoop = LOOPS[name][0]
    after, before = loop.force(loop.start[:-1] + 1e-9), loop.force(loop.start[:-1] - 1e-9)
    np.testing.assert_allclose(after, before, atol=1e-7)


@pytest.mark.parametrize(
    ("build", "arguments", "keys"),
    [
        (jenkins_loop, (3.0, 0.4, 2.0, 0.2), ()),
        (jenkins_loop, (-3.0, 0.4, 2.0, 1.1), ("stiffness",)),
        (jenkins_loop, (3.0, math.nan, 2.0, 1.1), ("friction_coefficient",)),
        (in_phase_loop, (3.0, 0.4, 2.0, -2.5, 1.1), ()),
        (in_phase_loop, (3.0, 0.4, 2.0, 9.0, 1.1), ()),
        (quadrature_loop, (3.0, 0.4, 2.0, 2.5, 1.1), ()),
        (quadrature_loop, (3.0, 0.4, 2.0, 1.1, 0.1), ()),
        (circular_force, (3.0, 0.4, 2.0, 0.2), ()),
        (hertz_sphere, (0.0, 1.0, 1.0), ("load",)),
        (mindlin_stiffness, (1.0, 1.0, 0.6), ("poisson_ratio",)),
    ],
)
def test_outside_the_closed_form_is_rejected(
    build: object, arguments: tuple[float, ...], keys: tuple[str, ...]
) -> None:
    with rejects(InputError, *keys):
        build(*arguments)  # type: ignore[operator]


def test_hertz_sphere_is_consistent() -> None:
    """Load from the approach, stiffness from the difference of approaches, load from the pressure dome."""
    load, radius, modulus = 12.0, 3e-3, 108.2417582e9
    contact = hertz_sphere(load, radius, modulus)
    assert 4.0 / 3.0 * modulus * math.sqrt(radius) * contact.approach**1.5 == pytest.approx(load, rel=1e-13)
    assert contact.contact_radius**2 == pytest.approx(radius * contact.approach, rel=1e-13)
    step = 1e-4 * load
    approaches = [hertz_sphere(load + sign * step, radius, modulus).approach for sign in (1.0, -1.0)]
    assert 2.0 * step / (approaches[0] - approaches[1]) == pytest.approx(contact.normal_stiffness, rel=1e-8)
    assert 2.0 / 3.0 * contact.peak_pressure * np.pi * contact.contact_radius**2 == pytest.approx(load, rel=1e-13)


def test_mindlin_is_eight_g_star_a() -> None:
    young, poisson, contact_radius = 197e9, 0.3, 5e-5
    shear = young / (2.0 * (1.0 + poisson))
    shear_star = shear / (2.0 * (2.0 - poisson))
    reduced = young / (2.0 * (1.0 - poisson**2))
    tangential = mindlin_stiffness(contact_radius, reduced, poisson)
    assert tangential == pytest.approx(8.0 * shear_star * contact_radius, rel=1e-13)
    assert tangential / (2.0 * reduced * contact_radius) == pytest.approx(0.8235294, rel=1e-7)
