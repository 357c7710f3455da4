"""Nonlinear modes: closed form of one slider, published modes, linear limits, energies, peaks of forced responses."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import scipy.linalg
from scipy.interpolate import CubicSpline

import stickslip as ss
from helpers import Blade
from known_modes import BEAM_RATIO, friction_beam, one_mass, two_masses
from sentences import printed_sentence, rejects
from stickslip.contact.law.closed_forms import jenkins_loop
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.solve.modes import nonlinear_mode as modes
from stickslip.solve.path.stepping import ContinuationSettings

# Two masses (Krack's concept, GitHub Nidish96/twodoffrict, rigid friction, 33 harmonics): modal amplitude, rad/s, xi.
TWO_MASSES = np.array(
    [
        [1.370348e-01, 1.018286e00, 7.404490e-01],
        [2.630208e-01, 1.010220e00, 3.965798e-01],
        [5.582304e-01, 1.004806e00, 2.116181e-01],
        [1.371646e00, 1.002272e00, 1.156196e-01],
        [1.000000e01, 1.000852e00, 5.899744e-02],
    ]
)


def energy_ratio(result: NonlinearMode, mass: np.ndarray) -> np.ndarray:
    """Damping ratio of the dissipated energy: that of ``-xi M u'`` over all harmonics."""
    order = np.repeat(np.arange(1, result.harmonics + 1), 2)
    motion = result.displacement[:, :, 1:]
    square = np.einsum("pih,ij,pjh->ph", motion, mass, motion) @ order**2
    omega = 2.0 * np.pi * result.frequency_hz
    return np.asarray(
        (result.dissipated_energy.sum(axis=1) + result.viscous_energy) / (2.0 * np.pi * omega**2 * square)
    )


def at_amplitude(result: NonlinearMode, amplitude: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values of a mode at other amplitudes, by a cubic over its logarithm."""
    rising = np.argsort(result.modal_amplitude)
    return np.asarray(CubicSpline(np.log(result.modal_amplitude[rising]), values[rising])(np.log(amplitude)))


@pytest.mark.slow
def test_an_amplitude_at_which_a_spring_no_longer_resists_is_rejected() -> None:
    """``k + 3 k3 x^2 = 0`` at 1 mm; the mass of 4 kg moves by half of the modal amplitude."""
    structure = ss.Superelement(np.array([[4.0]]), np.array([[1e5]]))
    springs = ss.CubicSpring(np.array([[3e5, 0.0, 0.0]]), np.array([[-1e11, 0.0, 0.0]]))
    pairs = ss.ContactPairs.with_laws(np.array([[1.0], [0.0], [0.0]]), [springs])
    with rejects(ss.InputError, "amplitude"):
        ss.nonlinear_mode(structure, pairs, 1, (1e-5, 2.02e-3))
    below = ss.nonlinear_mode(structure, pairs, 1, (1e-4, 1e-3), harmonics=1, samples=64)
    assert below.frequency_hz[-1] < below.frequency_hz[0]


@pytest.mark.long
def test_one_mass_with_a_slider_is_its_closed_form() -> None:
    """With one harmonic the balance is that of the first harmonic of the friction force."""
    superelement, pairs = one_mass(ratio=0.002)
    result = ss.nonlinear_mode(superelement, pairs, 1, (1e-6, 1e-3), harmonics=1, samples=2048)
    assert result.converged, result.message
    for point in range(result.n_points):
        length = result.modal_amplitude[point] / np.sqrt(2.0)
        omega, viscous = 2.0 * np.pi * result.frequency_hz[point], 2.0 * 0.002 * np.sqrt(0.75e6)
        if 5e5 * length <= 10.0:
            assert result.contact_state[point, 0] == ss.ContactState.STUCK
            assert omega == pytest.approx(np.sqrt(0.75e6), rel=1e-8)
            assert result.damping_ratio[point] == pytest.approx(0.002, rel=1e-6)
            continue
        loop = jenkins_loop(5e5, 0.5, 20.0, length)
        assert omega**2 * 2.0 * length == pytest.approx(1e6 * length + loop.coefficients[1], rel=2e-5)
        growth = viscous + loop.dissipated_energy / (np.pi * omega * 2.0 * length**2)
        assert result.damping_ratio[point] == pytest.approx(growth / (2.0 * omega), rel=2e-4)
    assert 0 < result.moving_pairs.sum() < result.n_points


@pytest.mark.slow
def test_the_limit_of_small_amplitude_is_the_linear_stuck_mode(blade: Blade) -> None:
    size = blade.superelement.size
    stuck = blade.superelement.stiffness + blade.operator.T @ (
        blade.pairs.resting_stiffness()[:, None] * blade.operator
    )

    squares, modes = scipy.linalg.eigh(stuck, blade.superelement.mass)
    for mode in (1, 2):
        result = ss.nonlinear_mode(blade.superelement, blade.pairs, mode, (1e-9, 1e-8), harmonics=1, samples=64)
        omega, shape = np.sqrt(squares[mode - 1]), modes[:, mode - 1]
        ratio = shape @ blade.superelement.damping @ shape / (2.0 * omega)
        assert result.frequency_hz == pytest.approx(omega / (2.0 * np.pi), rel=1e-6)
        assert result.damping_ratio == pytest.approx(ratio, rel=1e-6)
        assert result.stuck_mac[:, mode - 1] == pytest.approx(1.0, abs=1e-6)
        assert not result.moving_pairs.any()
        assert result.displacement.shape == (result.n_points, size, 3)


@pytest.mark.slow
def test_the_energy_of_a_cycle_gives_the_same_damping() -> None:
    superelement, pairs, _ = friction_beam()
    result = ss.nonlinear_mode(superelement, pairs, 1, (10**-5.5, 10**-3.1), harmonics=7)
    assert result.converged, result.message
    assert energy_ratio(result, superelement.mass) == pytest.approx(result.damping_ratio, rel=1e-6)
    supplied = result.dissipated_energy.sum(axis=1) + result.viscous_energy
    assert result.input_energy == pytest.approx(supplied, rel=1e-6)
    assert result.residual.max() < 1e-7


@pytest.mark.long
@pytest.mark.parametrize("rest", ["gaps", "retained tractions", "coupled damping", "modal ratio"])
def test_a_mode_about_any_rest_balances_its_energies(blade: Blade, rest: str) -> None:
    """From stuck pairs to full separation, for the kinds of rest and of damping."""
    pairs, damping, ratio = blade.pairs, blade.superelement.damping, None
    if rest == "gaps":
        preload = pairs.preload.copy()
        preload[::3] = -3.0
        pairs = blade.pairs_with(preload)
    elif rest == "retained tractions":
        limit = pairs.friction_coefficient * pairs.normal_load
        pairs = pairs.with_constants(residual_traction=np.column_stack([0.5 * limit, np.zeros(limit.size)]))
    elif rest == "coupled damping":
        damping = np.asarray(damping) + 30.0 * blade.operator.T @ blade.operator
    else:
        damping, ratio = None, 0.002
    superelement = ss.Superelement(blade.superelement.mass, blade.superelement.stiffness, damping)
    result = ss.nonlinear_mode(
        superelement, pairs, 1, (1e-6, 2e-4), harmonics=3, samples=128, modal_damping_ratio=ratio
    )
    assert result.converged, result.message
    assert (result.contact_state[-1] == ss.ContactState.SEPARATING).all()
    assert result.residual.max() < 1e-8
    # Also where a pair just reaches its limit and creeps by 1e-6 of its motion a cycle.
    assert energy_ratio(result, superelement.mass) == pytest.approx(result.damping_ratio, rel=1e-6)


@pytest.mark.slow
def test_the_virtual_beam_starts_at_its_published_frequency() -> None:
    superelement, pairs, _ = friction_beam()
    result = ss.nonlinear_mode(superelement, pairs, 1, (10**-5.5, 10**-3.1), harmonics=7)
    assert result.frequency_hz[0] == pytest.approx(80.368, abs=5e-4)
    assert result.damping_ratio[0] == pytest.approx(BEAM_RATIO, rel=1e-6)


@pytest.mark.long
def test_two_masses_with_rigid_friction_have_their_published_mode() -> None:
    """From full slip down to stick-slip; the slider of 1e4 N/m is rigid in effect."""
    superelement, pairs = two_masses(1e4)
    result = ss.nonlinear_mode(superelement, pairs, 1, (0.12, 10.0), limit="sliding", harmonics=33, samples=1024)
    assert result.converged, result.message
    amplitude, omega, growth = TWO_MASSES.T
    found = 2.0 * np.pi * at_amplitude(result, amplitude, result.frequency_hz)
    assert found == pytest.approx(omega, rel=2e-3)
    ratio = at_amplitude(result, amplitude, result.damping_ratio)
    assert 2.0 * found * ratio == pytest.approx(growth, rel=5e-3)


@pytest.mark.long
def test_the_mode_passes_through_the_peaks_of_forced_responses() -> None:
    superelement, pairs, tip = friction_beam()
    mode = ss.nonlinear_mode(superelement, pairs, 1, (10**-5.5, 10**-3.1), harmonics=7)
    height, hertz = mode.harmonic_amplitude(tip, 1), mode.frequency_hz
    # Levels on both sides of the amplitudes with high damping: stuck, beginning slip, and full slip.
    for amplitude_of_level in (1e-5, 1.96e-5, 2.0e-5, 3.1e-4, 7.9e-4):
        point = int(np.abs(mode.modal_amplitude / amplitude_of_level - 1.0).argmin())
        assert mode.passes_peaks[point]
        # Power of the force at phase resonance: w F X / 2 = xi w^2 a^2 / 2.
        omega = 2.0 * np.pi * hertz[point]
        force = 2.0 * mode.damping_ratio[point] * omega**2 * mode.modal_amplitude[point] ** 2 / height[point]
        response = ss.forced_response(
            superelement, pairs, force * tip, frequency_hz=(0.96 * hertz[point], 1.04 * hertz[point]), harmonics=3,
            samples=128,
        )  # fmt: skip
        amplitude = response.harmonic_amplitude(tip, 1)
        top = int(amplitude.argmax())
        near = slice(top - 2, top + 3)
        parabola = np.polynomial.Polynomial.fit(response.frequency_hz[near], amplitude[near], 4)
        peak_hz = max(
            (root.real for root in parabola.deriv().roots() if abs(root.imag) < 1e-9), key=lambda hz: parabola(hz)
        )
        expected = at_amplitude(mode, mode.modal_amplitude[point] * parabola(peak_hz) / height[point], hertz)
        assert parabola(peak_hz) == pytest.approx(height[point], rel=0.01)
        assert peak_hz == pytest.approx(expected, rel=0.01)


@pytest.mark.long
def test_the_branch_from_the_sliding_limit_is_the_same_curve() -> None:
    superelement, pairs = one_mass(ratio=0.002)
    up = ss.nonlinear_mode(superelement, pairs, 1, (1e-5, 1e-2), harmonics=3)
    down = ss.nonlinear_mode(superelement, pairs, 1, (1e-5, 1e-2), harmonics=3, limit="sliding")
    assert up.converged
    assert down.converged
    assert down.modal_amplitude[[0, -1]] == pytest.approx([1e-2, 1e-5])
    assert down.sliding_mac == pytest.approx(1.0)
    inside = up.modal_amplitude[1:-1]
    assert at_amplitude(down, inside, down.frequency_hz) == pytest.approx(up.frequency_hz[1:-1], rel=2e-3)


@pytest.mark.slow
def test_a_mode_that_exchanges_its_shape_has_a_warning() -> None:
    """A mass on a spring that stiffens passes the frequency of its neighbour, and the first mode becomes that of the
    neighbour."""
    operator = np.eye(3, 2, k=-2)
    operator[0, 1] = 1.0
    operator[2, 0] = 0.0
    spring = ss.CubicSpring(np.array([[1e5, 0.0, 0.0]]), np.array([[1e13, 0.0, 0.0]]))
    pairs = ss.ContactPairs.with_laws(operator, [spring])
    superelement = ss.Superelement(np.eye(2), np.array([[1e6, -1e4], [-1e4, 0.8e6]]))
    result = ss.nonlinear_mode(superelement, pairs, 1, (1e-6, 1e-3), harmonics=3)
    assert result.converged, result.message
    assert result.frequency_hz[-1] < np.sqrt(1e6) / (2.0 * np.pi)
    assert result.damping_ratio == pytest.approx(0.0, abs=1e-9)
    printed_sentence("\n".join(result.warnings), "stuck mode 2", numbers=False)
    closest = result.stuck_mac.argmax(axis=1) + 1
    assert closest[0] == 1
    assert closest[-1] == 2
    assert result.step_mac.min() > 0.9


@pytest.mark.long
def test_high_damping_has_a_warning() -> None:
    superelement, pairs = one_mass(ratio=0.002)
    result = ss.nonlinear_mode(superelement, pairs, 1, (1e-6, 1e-3), harmonics=1)
    high = result.damping_ratio > 0.03
    assert high.any()
    assert not high.all()
    assert (result.passes_peaks == ~high).all()
    printed_sentence("\n".join(result.warnings))


@pytest.mark.slow
def test_harmonics_grow_within_the_allowed_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without work for a second branch, the mode of the first one remains, with its error and the remedy."""
    monkeypatch.setattr(modes, "MOST_ENTRIES", 1.0)
    problem = two_masses(1e2)
    mode = ss.nonlinear_mode(*problem, 1, (0.3, 10.0), limit="sliding", accuracy=0.01)
    assert mode.harmonics == 3
    assert mode.converged
    printed_sentence("\n".join(each for each in mode.warnings if "accuracy" in each))


@pytest.mark.long
def test_harmonics_grow_until_the_accuracy_is_reached() -> None:
    """Rigid friction: beside a mode with many more harmonics, the error is below the accuracy at all points."""
    problem = two_masses(1e2)
    by_accuracy = ss.nonlinear_mode(*problem, 1, (0.3, 10.0), limit="sliding", accuracy=0.01)
    assert by_accuracy.harmonics > 3
    assert not any("accuracy" in sentence for sentence in by_accuracy.warnings)
    assert by_accuracy.settings["accuracy"] == 0.01
    exact = ss.nonlinear_mode(*problem, 1, (0.3, 10.0), limit="sliding", harmonics=21)
    ratio = at_amplitude(exact, by_accuracy.modal_amplitude, exact.damping_ratio)
    assert np.abs(by_accuracy.damping_ratio / ratio - 1.0).max() < 0.01
    assert by_accuracy.frequency_hz == pytest.approx(
        at_amplitude(exact, by_accuracy.modal_amplitude, exact.frequency_hz), rel=5e-4
    )


@pytest.mark.long
def test_an_accuracy_that_is_not_reached_has_a_warning() -> None:
    coarse = ss.nonlinear_mode(*one_mass(ratio=0.002), 1, (1e-5, 1e-4), accuracy=1e-5, samples=64)
    assert coarse.harmonics == 15
    printed_sentence("\n".join(coarse.warnings), numbers=False)


def test_harmonics_and_accuracy_together_are_rejected() -> None:
    with rejects(ss.InputError, "harmonics", "accuracy"):
        ss.nonlinear_mode(*two_masses(1e2), 1, (0.3, 10.0), harmonics=5, accuracy=0.01)


@pytest.mark.slow
def test_too_few_harmonics_have_a_warning() -> None:
    """Rigid friction excites many harmonics: the warning tells that one is not enough, and is silent with 15."""
    few = ss.nonlinear_mode(*two_masses(1e2), 1, (0.3, 10.0), harmonics=1, samples=256)
    many = ss.nonlinear_mode(*two_masses(1e2), 1, (0.3, 10.0), harmonics=15, samples=256)
    printed_sentence("\n".join(few.warnings))
    printed_sentence("\n".join(many.warnings))


def test_a_mode_that_cannot_be_followed_ends_with_a_message() -> None:
    superelement, pairs = one_mass()
    call = partial(
        ss.nonlinear_mode, superelement, pairs, 1, (1e-6, 1e-3), harmonics=1,
        continuation=ContinuationSettings(max_points=5),
    )  # fmt: skip
    with pytest.warns(ss.NotConvergedWarning):
        short = call()
    with rejects(ss.ConvergenceError):
        call(raise_on_failure=True)
    assert not short.converged
    assert short.n_points == 5
    assert "NOT converged" in repr(short)
    printed_sentence(short.message)


def test_what_is_no_mode_is_rejected() -> None:
    superelement, pairs = one_mass()
    with rejects(ss.InputError, "mode"):
        ss.nonlinear_mode(superelement, pairs, 2, (1e-6, 1e-3))
    with rejects(ss.InputError, "mode"):
        ss.nonlinear_mode(superelement, pairs, 0, (1e-6, 1e-3))
    with rejects(ss.InputError, "amplitude"):
        ss.nonlinear_mode(superelement, pairs, 1, (1e-3, 1e-6))
    with rejects(ss.InputError, "amplitude"):
        ss.nonlinear_mode(superelement, pairs, 1, (0.0, 1e-6))
    with rejects(ss.InputError, "limit"):
        ss.nonlinear_mode(superelement, pairs, 1, (1e-6, 1e-3), limit="open")  # type: ignore[arg-type]


def test_a_mode_of_two_equal_frequencies_is_rejected() -> None:
    pairs = ss.ContactPairs(np.eye(3), 1e5, 1e5, 0.3, 10.0)
    with rejects(ss.InputError, "mode"):
        ss.nonlinear_mode(ss.Superelement(np.eye(3), np.diag([1e6, 1e6, 2e6])), pairs, 2, (1e-6, 1e-3))
