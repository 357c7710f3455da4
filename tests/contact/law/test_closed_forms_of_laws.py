"""The laws against closed forms, in the law and in the curve of a mass: cubic, stop, Jenkins, Iwan."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import scipy.integrate

import stickslip as ss
from sentences import rejects

# The laws accept numbers and lists as constants; the annotations of their fields are those of the stored arrays.
CubicSpring: Callable[..., ss.CubicSpring] = ss.CubicSpring
ElasticStop: Callable[..., ss.ElasticStop] = ss.ElasticStop
JenkinsElement: Callable[..., ss.JenkinsElement] = ss.JenkinsElement
IwanJoint: Callable[..., ss.IwanJoint] = ss.IwanJoint
CoulombLaw: Callable[..., ss.CoulombLaw] = ss.CoulombLaw
MASS, SAMPLES = 1.0, 1024
ROW = np.array([1.0, 0.0, 0.0])


def first_harmonic(law: ss.ContactLaw, axis: int, amplitude: float, samples: int = SAMPLES) -> complex:
    """c - i s of the force under a cosine of an amplitude along one axis of pair 0, the others at rest."""
    coefficients = np.zeros((law.n_pairs, 3, 3))
    coefficients[:, axis, 1] = amplitude
    force = law.period(coefficients, samples).force[0, axis]
    return complex(force[1], -force[2])


def curve(
    law: ss.ContactLaw, direction: int, force: float, window: tuple[float, float], **options: float
) -> ss.ForcedResponse:
    """A mass on springs of 4e5 N/m in each direction, the law to ground, a force along one direction."""
    structure = ss.Superelement(MASS * np.eye(3), 4e5 * np.eye(3), 20.0 * np.eye(3))
    load = np.zeros(3)
    load[direction] = force
    settings: dict[str, Any] = {"harmonics": 1, "samples": SAMPLES} | options
    return ss.forced_response(
        structure, ss.ContactPairs.with_laws(np.eye(3), [law]), load, frequency_hz=window, **settings
    )


def balance_of_one_harmonic(response: ss.ForcedResponse, axis: int, law: ss.ContactLaw, force: float) -> np.ndarray:
    """|Z X + F(X)| over the force at every point, F from the closed form ``law``: must be 0."""
    coefficients = response.coefficients(np.eye(3)[axis])
    motion = coefficients[:, 1] - 1j * coefficients[:, 2]
    omega = 2 * np.pi * response.frequency_hz
    describing = np.array([first_harmonic(law, axis, abs(x)) / abs(x) for x in motion])
    return np.asarray(np.abs((4e5 - omega**2 * MASS + 20j * omega + describing) * motion - force) / force)


def test_cubic_spring_has_the_coefficient_of_duffing() -> None:
    law = CubicSpring(1e5, 1e15)
    for amplitude in (1e-6, 1e-5, 1e-4):
        expected = 1e5 * amplitude + 0.75e15 * amplitude**3
        assert first_harmonic(law, 2, amplitude) == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
def test_the_curve_of_a_duffing_oscillator() -> None:
    """Amplitude over frequency from the cubic of one harmonic, folds included (Nayfeh and Mook, sec. 4.1)."""
    response = curve(CubicSpring(1e5, 1e15), 0, 1.0, (105.0, 230.0))
    assert response.converged, response.message
    size = response.harmonic_amplitude(ROW, 1)
    omega = 2 * np.pi * response.frequency_hz
    stiffness = 5e5 + 0.75e15 * size**2 - omega**2
    assert np.hypot(stiffness, 20.0 * omega) * size == pytest.approx(1.0, rel=1e-7)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(response.frequency_hz))))
    assert turns.size == 2  # it folds
    assert response.dissipated_energy == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("two_sided", [False, True])
def test_stop_has_the_coefficient_of_a_piecewise_linear_spring(two_sided: bool) -> None:
    stiffness, gap, spring = 3e6, 2e-6, 1e5
    law = ElasticStop(stiffness, gap, spring, two_sided=two_sided)
    assert first_harmonic(law, 2, 0.99 * gap) == pytest.approx(spring * 0.99 * gap, rel=1e-12)
    for amplitude in (3e-6, 1e-5):
        angle = np.arccos(gap / amplitude)
        stop = stiffness * amplitude * (angle - np.sin(angle) * np.cos(angle)) / np.pi
        expected = spring * amplitude + (2.0 if two_sided else 1.0) * stop
        assert first_harmonic(law, 2, amplitude, 20_000) == pytest.approx(expected, rel=1e-6)


def test_stop_says_when_it_is_hit() -> None:
    law = ElasticStop([1e6, 1e6], [2e-6, 2e-5])
    coefficients = np.zeros((2, 3, 3))
    coefficients[:, 2, 1] = 1e-5
    assert law.period(coefficients, 64).state.tolist() == [ss.ContactState.SEPARATING, ss.ContactState.STUCK]


@pytest.mark.long
def test_the_curve_of_an_oscillator_with_a_stop_against_time_integration() -> None:
    """Five harmonics against scipy's Runge-Kutta on the equation of motion, which knows nothing of this code."""
    stiffness, gap, force, hertz = 4e5, 1e-5, 4.0, 112.0
    law = ElasticStop(stiffness, gap)
    response = curve(law, 2, force, (112.0, 118.0), harmonics=9)
    omega = 2 * np.pi * hertz

    def rate(t: float, y: np.ndarray) -> list[float]:
        stop = stiffness * max(y[0] - gap, 0.0)
        return [y[1], force * np.cos(omega * t) - 20.0 * y[1] - 4e5 * y[0] - stop]

    period = 2 * np.pi / omega
    settled = scipy.integrate.solve_ivp(rate, (0.0, 120 * period), [0.0, 0.0], rtol=1e-8, atol=1e-12).y[:, -1]
    last = scipy.integrate.solve_ivp(rate, (0.0, period), settled, rtol=1e-9, atol=1e-13, max_step=period / 400)
    assert response.frequency_hz[0] == pytest.approx(hertz)
    actual = response.signal([0.0, 0.0, 1.0], 0, 1000)
    assert actual.max() == pytest.approx(last.y[0].max(), rel=2e-3)
    assert actual.min() == pytest.approx(last.y[0].min(), rel=2e-3)


def test_jenkins_equals_the_closed_form() -> None:
    """Describing function of an elastic-dry-friction element (T. K. Caughey, J. Appl. Mech. 27 (1960) 640)."""
    k, limit = 1e6, 4.0
    law = JenkinsElement(k, limit)
    assert first_harmonic(law, 0, 3.9e-6) == pytest.approx(k * 3.9e-6, rel=1e-12)
    for amplitude in (6e-6, 2e-5):
        angle = np.arccos(1.0 - 2.0 * limit / (k * amplitude))
        real = k * amplitude * (angle - 0.5 * np.sin(2.0 * angle)) / np.pi
        energy = 4.0 * limit * (amplitude - limit / k)
        actual = first_harmonic(law, 0, amplitude, 20_000)
        assert actual.real == pytest.approx(real, rel=1e-6)
        assert actual.imag == pytest.approx(energy / (np.pi * amplitude), rel=1e-6)
        path = np.zeros((20_000, 1, 3))
        path[:, 0, 1] = amplitude * np.cos(2 * np.pi * np.arange(20_000) / 20_000)
        cycle = law.cycle(path)
        assert cycle.dissipated_energy[0] == pytest.approx(energy, rel=1e-12)
        assert np.abs(cycle.force[:, 0, 1]).max() == limit


@pytest.mark.slow
def test_jenkins_equals_coulomb_friction_under_a_constant_load() -> None:
    """Two implementations: the element by itself, and the cone of Coulomb pairs that move along t1 alone."""
    jenkins = curve(JenkinsElement(2e5, 3.0, 1e6), 0, 8.0, (95.0, 130.0), harmonics=5)
    coulomb = curve(CoulombLaw([1e6], [2e5], [0.3], [10.0], [0.0]), 0, 8.0, (95.0, 130.0), harmonics=5)
    assert jenkins.converged
    # To the error of sums of samples, (2 pi / 1024)^2 / 12: the Coulomb pairs know the instants of their events.
    assert jenkins.frequency_hz == pytest.approx(coulomb.frequency_hz, rel=1e-5)
    assert jenkins.harmonic_amplitude(ROW, 1) == pytest.approx(coulomb.harmonic_amplitude(ROW, 1), rel=1e-4)
    assert jenkins.dissipated_energy == pytest.approx(
        coulomb.dissipated_energy, abs=1e-4 * coulomb.dissipated_energy.max()
    )
    assert jenkins.contact_state.tolist() == coulomb.contact_state.tolist()


IWAN = {"tangential_stiffness": 1.5e7, "slip_force": 4000.0, "exponent": -0.6, "ratio": 0.02}


def test_iwan_backbone_and_energy_equal_the_integrals_of_its_distribution() -> None:
    """By quadrature over the elements: F = int phi rho + x int rho, D = int 4 phi (X - phi) rho (Segalman 2005)."""
    law = IwanJoint(**IWAN)
    density, chi, largest = float(law._density[0, 0]), -0.6, float(law.macroslip_displacement[0, 0])
    spike = 1.5e7 - density * largest ** (chi + 1) / (chi + 1)
    assert spike > 0
    assert spike / (density * largest ** (chi + 1) / (chi + 1)) == pytest.approx(0.02, rel=1e-9)
    for x in (0.01 * largest, 0.5 * largest, 0.999 * largest):
        slipping, _ = scipy.integrate.quad(lambda phi: density * phi ** (chi + 1), 0.0, x)
        sticking, _ = scipy.integrate.quad(lambda phi: density * phi**chi, x, largest)
        assert law.backbone(x)[0, 0] == pytest.approx(slipping + x * (sticking + spike), rel=1e-6)
        energy, _ = scipy.integrate.quad(lambda phi, x=x: 4 * (x - phi) * density * phi ** (chi + 1), 0.0, x)
        assert law.dissipation(x)[0, 0] == pytest.approx(energy, rel=1e-6)
    assert law.backbone(largest)[0, 0] == pytest.approx(4000.0)
    assert law.backbone(3 * largest)[0, 0] == pytest.approx(4000.0)


@pytest.mark.slow
def test_iwan_equals_a_thousand_jenkins_elements_on_any_path() -> None:
    """The walk along turning points against the sum of the elements of its distribution."""
    law = IwanJoint(**IWAN)
    density, chi, largest = float(law._density[0, 0]), -0.6, float(law.macroslip_displacement[0, 0])
    edges = largest * np.linspace(0.0, 1.0, 3001) ** 3
    stiffness = density * np.diff(edges ** (chi + 1)) / (chi + 1)
    limits = density * np.diff(edges ** (chi + 2)) / (chi + 2)
    stiffness = np.append(stiffness, 1.5e7 - stiffness.sum())
    limits = np.append(limits, stiffness[-1] * largest)
    angle = 2 * np.pi * np.arange(400) / 400
    for size in (0.2, 0.8, 3.0):
        path = size * largest * (np.cos(angle) + 0.7 * np.sin(3 * angle) - 0.4 * np.cos(5 * angle + 1.0))
        motion = np.zeros((400, 1, 3))
        motion[:, 0, 0] = path
        actual = law.cycle(motion)
        many = np.zeros((400, stiffness.size, 3))
        many[:, :, 0] = path[:, None]
        elements = JenkinsElement(stiffness, limits).cycle(many)
        total = elements.force[:, :, 0].sum(axis=1)
        assert actual.force[:, 0, 0] == pytest.approx(total, abs=2e-3 * np.abs(total).max())
        assert actual.dissipated_energy[0] == pytest.approx(elements.dissipated_energy.sum(), rel=3e-3)


@pytest.mark.slow
def test_the_curve_of_an_iwan_joint_dissipates_as_its_closed_form() -> None:
    law = IwanJoint(2e5, 5.0, -0.5, 0.1)
    response = curve(law, 0, 3.0, (105.0, 130.0))
    assert response.converged, response.message
    size = response.harmonic_amplitude(ROW, 1)
    assert response.dissipated_energy[:, 0] == pytest.approx(law.dissipation(size[:, None])[:, 0], rel=1e-3)
    assert balance_of_one_harmonic(response, 0, law, 3.0).max() < 1e-5
    assert (response.contact_state == ss.ContactState.STICK_SLIP).all()
    balance = response.dissipated_energy.sum(axis=1) + response.viscous_energy
    assert balance == pytest.approx(response.input_energy, rel=1e-6)


@pytest.mark.parametrize(
    ("make", "keys"),
    [
        (lambda: CubicSpring(-1.0, 1.0), ("stiffness",)),
        (lambda: CubicSpring([1.0, 2.0], np.ones((3, 3))), ()),
        (lambda: ElasticStop(1e6, 0.0), ("gap",)),
        (lambda: ElasticStop(0.0, 1e-6), ("stiffness",)),
        (lambda: ElasticStop(1e6, 1e-6, two_sided=1), ("two_sided",)),
        (lambda: JenkinsElement(1e6, 0.0), ("friction_limit",)),
        (lambda: JenkinsElement(-1e6, 1.0), ("tangential_stiffness",)),
        (lambda: IwanJoint(1e6, 1.0, -1.0, 0.0), ("exponent",)),
        (lambda: IwanJoint(1e6, 1.0, 0.2, 0.0), ("exponent",)),
        (lambda: IwanJoint(1e6, 1.0, -0.2, -0.1), ("ratio",)),
        (lambda: IwanJoint(1e6, 0.0, -0.2, 0.1), ("slip_force",)),
        (lambda: IwanJoint(1e6, np.nan, -0.2, 0.1), ("slip_force",)),
        (
            lambda: CoulombLaw([1.0], [1.0], [0.3], [1.0], [1.0]),
            ("normal_load", "gap"),
        ),
        (lambda: CoulombLaw([1.0], [1.0], [0.3], [-1.0], [0.0]), ("normal_load",)),
        (lambda: ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3), ("normal_load",)),
        (
            lambda: ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 5.0, gap=0.0),
            ("preload", "normal_load"),
        ),
    ],
)
def test_constants_out_of_range_are_rejected(make: object, keys: tuple[str, ...]) -> None:
    with rejects(ss.InputError, *keys):
        make()  # type: ignore[operator]


def test_gap_and_normal_load_say_what_the_sign_of_the_preload_reported() -> None:
    old = ss.ContactPairs(np.eye(6), [2e6, 2e6], 1e6, 0.3, [5.0, -4.0])
    new = ss.ContactPairs(np.eye(6), [2e6, 2e6], 1e6, 0.3, normal_load=[5.0, 0.0], gap=[0.0, 2e-6])
    assert new.preload == pytest.approx(old.preload)
    assert old.gap == pytest.approx([0.0, 2e-6])
    assert new.normal_load.tolist() == [5.0, 0.0]
    only_gap = ss.ContactPairs(np.eye(3), 2e6, 1e6, 0.3, gap=1e-6)
    assert only_gap.preload.tolist() == [-2.0]
    assert not only_gap.closed_at_rest.any()
