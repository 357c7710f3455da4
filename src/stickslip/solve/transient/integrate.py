"""Implicit time integration of the structure with its frictional contacts, to the periodic steady state.

Solves ``M u'' + C u' + K u + B^T f(B u) = p(t)`` step by step with the generalised-alpha scheme (Chung and Hulbert,
J. Appl. Mech. 60, 1993). It shares no code with the harmonic balance and its friction law, so that each checks the
other; use it for verification and for motions that are not periodic at the excitation frequency.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.validation import (
    FloatArray,
    finite_array,
    positive_number,
    real_number,
    require_allowed,
    whole_number,
)
from stickslip.results.response import ForcedResponse
from stickslip.solve.transient.kernel import march_period
from stickslip.structure.superelement import Superelement

_MAX_STEP_ITERATIONS = 40  # chosen: ends a step whose Newton iteration does not converge
_STEP_TOLERANCE = 1e-10  # relative error of the contact displacements of a step, far below the truncation error


@dataclass(frozen=True)
class TransientResponse:
    """The last period of a time integration.

    Attributes
    ----------
    time:
        (n_steps,) s from the start of a period of the force, ``time[0] = 0``.
    displacement, velocity:
        (n_steps, n) of the superelement's unknowns; row 0 restarts the integration.
    contact_force:
        (n_steps, n_pairs, 3) N: T1, T2, N of each pair (N itself, not N - preload).
    period_change:
        (n_periods,) change of the motion from each period to the next, relative, in the strain-energy norm of the stuck
        structure. With a decay factor r per period the distance to the steady state is about r / (1 - r) times the
        last entry.
    converged, message:
        whether ``period_change`` fell to the tolerance, and a sentence about it.
    """

    time: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    contact_force: FloatArray
    period_change: FloatArray
    converged: bool
    message: str

    def amplitude(self, output: ArrayLike) -> float:
        """Largest ``|output @ u(t)|`` of the last period (0-to-peak, including the mean), from a parabola at the
        peak."""
        signal = self.displacement @ finite_array("output", output)
        if abs(signal.min()) > abs(signal.max()):
            signal = -signal
        peak = int(signal.argmax())
        before, here, after = signal[peak - 1], signal[peak], signal[(peak + 1) % signal.size]
        bend = before - 2.0 * here + after
        return float(here if bend == 0.0 else here - (after - before) ** 2 / (8.0 * bend))


@dataclass(frozen=True)
class _Scheme:
    """Constant matrices of one step ``u_1 = load + state_response [u_0, v_0, a_0] - force_response f``.

    ``f`` is the deviation of the contact force from stuck springs at the end of the step plus ``old_force_weight``
    times the contact force (less preload) at its start. The factored matrix contains the stuck springs, so a stuck pair
    costs nothing. The ``contact_`` arrays are ``B`` times the others.
    """

    load_response: FloatArray  # (n_steps, n), for each step of the period
    state_response: FloatArray  # (n, 3 n)
    force_response: FloatArray  # (n, 3 n_pairs)
    contact_load_response: FloatArray  # (n_steps, 3 n_pairs)
    contact_state_response: FloatArray  # (3 n_pairs, 3 n)
    contact_compliance: FloatArray  # (3 n_pairs, 3 n_pairs)
    old_force_weight: float
    acceleration_weights: FloatArray  # (5,), see march_period


def _generalised_alpha(
    superelement: Superelement, pairs: ContactPairs, load: FloatArray, time_step: float, spectral_radius: float
) -> _Scheme:
    """Factor the effective matrix once. ``load`` (n_steps, n) N at the start of each step of one period."""
    mass, stiffness, operator = superelement.mass, superelement.stiffness, pairs.operator
    damping = superelement.damping if superelement.damping is not None else np.zeros_like(mass)
    alpha_mass = (2.0 * spectral_radius - 1.0) / (spectral_radius + 1.0)
    alpha_force = spectral_radius / (spectral_radius + 1.0)
    gamma = 0.5 - alpha_mass + alpha_force
    beta = 0.25 * (1.0 - alpha_mass + alpha_force) ** 2
    # a_1 = w0 (u_1 - u_0) + w1 v_0 + w2 a_0   and   v_1 = v_0 + w3 a_0 + w4 a_1
    w0, w1, w2 = 1.0 / (beta * time_step**2), -1.0 / (beta * time_step), 1.0 - 0.5 / beta
    w3, w4 = time_step * (1.0 - gamma), time_step * gamma
    mass_weight, old = (1.0 - alpha_mass) / (1.0 - alpha_force), alpha_force / (1.0 - alpha_force)

    springs = pairs.stuck_stiffness()
    effective = stiffness + w4 * w0 * damping + mass_weight * w0 * mass + operator.T @ (springs[:, None] * operator)
    from_displacement = -old * stiffness + mass_weight * w0 * mass + w4 * w0 * damping
    from_velocity = -mass_weight * w1 * mass - (old + 1.0 + w4 * w1) * damping
    from_acceleration = -(mass_weight * w2 + alpha_mass / (1.0 - alpha_force)) * mass - (w3 + w4 * w2) * damping
    factor = scipy.linalg.cho_factor(effective)
    state_response = scipy.linalg.cho_solve(factor, np.hstack([from_displacement, from_velocity, from_acceleration]))
    force_response = scipy.linalg.cho_solve(factor, operator.T)
    load_response = scipy.linalg.cho_solve(factor, (np.roll(load, -1, axis=0) + old * load).T).T
    return _Scheme(
        load_response=np.ascontiguousarray(load_response),
        state_response=np.ascontiguousarray(state_response),
        force_response=np.ascontiguousarray(force_response),
        contact_load_response=np.ascontiguousarray(load_response @ operator.T),
        contact_state_response=np.ascontiguousarray(operator @ state_response),
        contact_compliance=np.ascontiguousarray(operator @ force_response),
        old_force_weight=old,
        acceleration_weights=np.array([w0, w1, w2, w3, w4]),
    )


def _starting_force(pairs: ContactPairs, contact_motion: FloatArray, slider: FloatArray) -> FloatArray:
    """(n_pairs, 3) T1, T2, N of a pair at ``contact_motion`` (n_pairs, 3): ``T = k_t (s - slider)`` cut to the cone."""
    normal = np.maximum(pairs.preload + pairs.normal_stiffness * contact_motion[:, 2], 0.0)
    traction = pairs.tangential_springs * (contact_motion[:, :2] - slider)
    size = np.hypot(traction[:, 0], traction[:, 1])
    limit = pairs.friction_coefficient * normal
    scale = np.where(size > limit, limit / np.where(size > 0.0, size, 1.0), 1.0)
    return np.column_stack([traction * scale[:, None], normal])


def _periodic_load(force_cos: ArrayLike, force_sin: ArrayLike, n: int, steps_per_period: int) -> FloatArray:
    """(n_steps, n) N at the samples of one period; the amplitudes are (n,) or (n, n_harmonics)."""
    angle = 2.0 * np.pi * np.arange(steps_per_period) / steps_per_period
    load = np.zeros((steps_per_period, n))
    for name, value, function in (("force_cos", force_cos, np.cos), ("force_sin", force_sin, np.sin)):
        amplitude = finite_array(name, value)
        if amplitude.ndim == 1:
            amplitude = amplitude[:, None]
        if amplitude.ndim != 2 or amplitude.shape[0] != n:
            raise InputError(
                f"{name} must have shape ({n},), or ({n}, n_harmonics) for several harmonics, one row for each unknown "
                f"of the superelement; found shape {np.shape(value)}."
            )
        order = np.arange(1, amplitude.shape[1] + 1)
        load += function(angle[:, None] * order) @ amplitude.T
    return load


def _relative_change(motion: FloatArray, previous: FloatArray, stiffness: FloatArray) -> float:
    """Strain energy of ``motion - previous`` over that of ``motion`` (both (n_steps, n)), as a ratio of amplitudes."""
    difference = motion - previous
    energy = float(np.sum(motion * (motion @ stiffness)))
    return float(np.sqrt(abs(np.sum(difference * (difference @ stiffness))) / energy)) if energy > 0.0 else 0.0


def _start_vector(name: str, value: ArrayLike | None, shape: tuple[int, ...]) -> FloatArray:
    """``value`` as an array of ``shape``, or zeros for None; raises InputError for another shape."""
    if value is None:
        return np.zeros(shape)
    array = finite_array(name, value)
    if array.shape != shape:
        raise InputError(f"{name} must have shape {shape}, but its shape is {array.shape}.")
    return array.copy()


def _check_settings(
    superelement: Superelement,
    pairs: ContactPairs,
    frequency_hz: float,
    steps_per_period: int,
    max_periods: int,
    tolerance: float,
    spectral_radius: float,
) -> None:
    """Raise InputError for invalid settings."""
    if pairs.operator.shape[1] != superelement.size:
        raise InputError(
            f"the operator of the contact pairs has {pairs.operator.shape[1]} columns, but the superelement has "
            f"{superelement.size} unknowns; both must be equal."
        )
    springs = pairs.coulomb.tangential_springs
    if (springs[:, 0] != springs[:, 1]).any():
        pair = int(np.flatnonzero(springs[:, 0] != springs[:, 1])[0])
        raise InputError(
            f"tangential_stiffness[{pair}] is {springs[pair, 0]:g} N/m along t1 and {springs[pair, 1]:g} N/m along t2; "
            "time integration takes pairs that are equally stiff in both directions. "
            "Use forced_response for others, or set both to one value."
        )
    positive_number("frequency_hz", frequency_hz, "Hz")
    positive_number("tolerance", tolerance)
    whole_number("max_periods", max_periods, 1)
    steps = whole_number("steps_per_period", steps_per_period, 1)
    require_allowed("steps_per_period", steps, steps >= 20, "20 or above; 500 to 2000 are usual")
    radius = real_number("spectral_radius", spectral_radius)
    allowed = "between 0 (fast modes vanish in one step) and 1 (no numerical dissipation)"
    require_allowed("spectral_radius", radius, 0.0 <= radius <= 1.0, allowed)


def start_from_response(response: ForcedResponse, point: int) -> dict[str, FloatArray]:
    """Time 0 of one point of a harmonic-balance curve, as ``initial_...`` arguments of integrate_to_steady_state.

    It includes the sliders, so that a pair that sticks has the mean traction of the harmonic balance; from rest it
    would end with another one, and both are valid steady states. Raises InputError for a point that does not exist.
    """
    n_points = response.frequency_hz.size
    if not 0 <= point < n_points:
        raise InputError(f"point must lie between 0 and {n_points - 1}, the points of the curve; found {point}.")
    coefficients = response.displacement[point]
    rate = 2.0 * np.pi * response.frequency_hz[point] * np.arange(1, response.harmonics + 1)
    return {
        "initial_displacement": coefficients[:, 0] + coefficients[:, 1::2].sum(axis=1),
        "initial_velocity": coefficients[:, 2::2] @ rate,
        "initial_slider": response.pair_cycle(point).slider[0],
    }


def integrate_to_steady_state(
    superelement: Superelement,
    pairs: ContactPairs,
    force_cos: ArrayLike,
    force_sin: ArrayLike,
    frequency_hz: float,
    steps_per_period: int = 1000,
    max_periods: int = 2000,
    tolerance: float = 1e-6,
    initial_displacement: ArrayLike | None = None,
    initial_velocity: ArrayLike | None = None,
    initial_slider: ArrayLike | None = None,
    spectral_radius: float = 0.9,
) -> TransientResponse:
    """Integrate ``M u'' + C u' + K u + B^T f(B u) = p(t)`` in time until one period equals the one before.

    ``f = (T1, T2, N)`` of each pair, less what it is at rest: 3-D Coulomb friction with tangential spring, variable
    normal load and separation, integrated exactly along the straight path of each step. The scheme is
    generalised-alpha: second order, unconditionally stable for the linear part, its numerical dissipation set by
    ``spectral_radius``. Each step solves the contact displacements by Newton with the exact derivative of the step law;
    the effective matrix, with stuck springs in it, is factored once.

    Parameters
    ----------
    superelement:
        mass, damping, stiffness (n, n); None for the damping matrix means none.
    pairs:
        equal tangential stiffness in both directions.
    force_cos, force_sin:
        (n,) N amplitudes of ``cos(2 pi f t)`` and ``sin(2 pi f t)``; (n, n_harmonics) for several harmonics.
    frequency_hz:
        excitation frequency.
    steps_per_period, max_periods:
        the error of an amplitude falls with the square of the step (docs/theory_transient.md).
    tolerance:
        of the relative change from one period to the next; see ``TransientResponse.period_change``.
    initial_displacement, initial_velocity:
        (n,) m and m/s at time 0, rest by default. A harmonic-balance solution shortens the transient.
    initial_slider:
        (n_pairs, 2) m: tangential displacement at which a pair carries no friction, ``T = k_t (s - slider)``. The
        slider at rest by default (zero if released). It has no effect on a pair that slips; in one that always sticks
        it stays as a mean traction.
    spectral_radius:
        factor of the amplitude of a mode much faster than the step in one step.

    Raises
    ------
    InputError
        for an array of another shape, entries that are not finite, or a setting out of range.
    ConvergenceError
        if the Newton iteration of a step fails; the message gives the step.
    """
    _check_settings(superelement, pairs, frequency_hz, steps_per_period, max_periods, tolerance, spectral_radius)
    n, n_pairs, operator = superelement.size, pairs.n_pairs, pairs.operator
    load = _periodic_load(force_cos, force_sin, n, steps_per_period)
    time_step = 1.0 / (frequency_hz * steps_per_period)
    scheme = _generalised_alpha(superelement, pairs, load, time_step, spectral_radius)

    displacement = _start_vector("initial_displacement", initial_displacement, (n,))
    velocity = _start_vector("initial_velocity", initial_velocity, (n,))
    at_rest = -pairs.resting_traction / pairs.tangential_springs
    slider = at_rest if initial_slider is None else _start_vector("initial_slider", initial_slider, (n_pairs, 2))
    contact_motion = (operator @ displacement).reshape(n_pairs, 3)
    contact_force = _starting_force(pairs, contact_motion, slider)
    offset = np.column_stack([pairs.resting_traction, pairs.normal_load])
    unbalanced = load[0] - superelement.stiffness @ displacement - operator.T @ (contact_force - offset).ravel()
    if superelement.damping is not None:
        unbalanced -= superelement.damping @ velocity
    try:
        acceleration = scipy.linalg.solve(superelement.mass, unbalanced, assume_a="pos")
    except scipy.linalg.LinAlgError as error:
        raise InputError(
            "the mass matrix is not positive definite, so the acceleration at the start is not defined. "
            "Condense the unknowns without mass first."
        ) from error
    motion = np.concatenate([displacement, velocity, acceleration])

    springs = pairs.stuck_stiffness()
    stuck_stiffness = superelement.stiffness + operator.T @ (springs[:, None] * operator)
    history = np.empty((steps_per_period, 2 * n))
    force_history = np.empty((steps_per_period, n_pairs, 3))
    previous = np.zeros((steps_per_period, n))
    period_change: list[float] = []
    for period in range(max_periods):
        failed_step = march_period(
            motion,
            contact_motion,
            contact_force,
            scheme.load_response,
            scheme.state_response,
            scheme.force_response,
            scheme.contact_load_response,
            scheme.contact_state_response,
            scheme.contact_compliance,
            scheme.old_force_weight,
            scheme.acceleration_weights,
            springs,
            pairs.friction_coefficient,
            pairs.preload,
            offset,
            _STEP_TOLERANCE,
            _MAX_STEP_ITERATIONS,
            history,
            force_history,
        )
        if failed_step >= 0:
            raise ConvergenceError(
                f"the contact iteration of step {failed_step} in period {period} did not converge in "
                f"{_MAX_STEP_ITERATIONS} iterations at {frequency_hz:g} Hz. Take more than {steps_per_period} steps "
                "per period."
            )
        period_change.append(_relative_change(history[:, :n], previous, stuck_stiffness))
        if period_change[-1] <= tolerance:
            break
        previous[:] = history[:, :n]
    converged = period_change[-1] <= tolerance
    message = (
        f"{'steady state' if converged else 'no steady state'} after {len(period_change)} periods of "
        f"{steps_per_period} steps at {frequency_hz:g} Hz: the last period differs from the one before by "
        f"{period_change[-1]:.1e} (tolerance {tolerance:.1e})."
    )
    if not converged:
        message += " Raise max_periods, or start from a harmonic-balance solution."
    return TransientResponse(
        time=np.arange(steps_per_period, dtype=np.float64) * time_step,
        displacement=history[:, :n].copy(),
        velocity=history[:, n:].copy(),
        contact_force=force_history,
        period_change=np.array(period_change),
        converged=converged,
        message=message,
    )
