"""Implicit time integration of the structure with its frictional contacts, to the periodic steady state.

Solves ``M u'' + C u' + K u + B^T f(B u) = p(t)`` step by step with the generalised-alpha scheme (Chung and Hulbert,
J. Appl. Mech. 60, 1993). It shares no code with the harmonic balance and its friction law, so that each checks the
other; pairs of other laws go through :meth:`ContactLaw.step`. Use it for verification and for motions that are not
periodic at the excitation frequency.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import (
    FloatArray,
    argument_error,
    finite_array,
    positive_number,
    real_number,
    require_allowed,
    whole_number,
)
from stickslip.results.response import ForcedResponse
from stickslip.solve.transient.marches import MAX_STEP_ITERATIONS, CoulombMarch, LawMarch, March
from stickslip.solve.transient.scheme import Scheme, generalised_alpha
from stickslip.structure.superelement import Superelement


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
    dissipated_energy:
        (n_pairs,) J, the work of the contact force on the relative motion over the period, by the trapezoidal rule.
        Elastic forces give back what they took once the period closes.
    period_change:
        (n_periods,) change of the motion from each period to the next, over its vibration about the mean, in the
        strain-energy norm of the stuck structure. With a decay factor r per period the distance to the steady state is
        about r / (1 - r) times the last entry.
    period_starts:
        (n_periods, n) m, displacement at the start of each period.
    converged, message:
        whether ``period_change`` fell to the tolerance, and a sentence about it.
    """

    time: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    contact_force: FloatArray
    dissipated_energy: FloatArray
    period_change: FloatArray
    period_starts: FloatArray
    converged: bool
    message: str

    __repr__ = short_repr

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
                f"of the superelement, but its shape is {np.shape(value)}.",
                arguments=[name],
            )
        order = np.arange(1, amplitude.shape[1] + 1)
        load += function(angle[:, None] * order) @ amplitude.T
    return load


def _relative_change(motion: FloatArray, previous: FloatArray, stiffness: FloatArray) -> float:
    """Strain energy of ``motion - previous`` over that of the vibration in ``motion``, both (n_steps, n), as a ratio
    of amplitudes.

    The mean does not count: a body that has walked far from its place would hide every change of its vibration.
    """
    difference, vibration = motion - previous, motion - motion.mean(axis=0)
    energy = float(np.sum(vibration * (vibration @ stiffness)))
    return float(np.sqrt(abs(np.sum(difference * (difference @ stiffness))) / energy)) if energy > 0.0 else 0.0


def _closed_work(force: FloatArray, relative: FloatArray) -> FloatArray:
    """(n_pairs,) J of forces along a closed motion, both (n_steps, n_pairs, 3), by the trapezoidal rule."""
    step = np.roll(relative, -1, axis=0) - relative
    return np.asarray((0.5 * (force + np.roll(force, -1, axis=0)) * step).sum(axis=(0, 2)))


def _start_vector(name: str, value: ArrayLike | None, shape: tuple[int, ...]) -> FloatArray:
    """``value`` as an array of ``shape``, or zeros for None; raises InputError for another shape."""
    if value is None:
        return np.zeros(shape)
    array = finite_array(name, value)
    if array.shape != shape:
        raise argument_error(name, f"{name} must have shape {shape}, but its shape is {array.shape}.")
    return array.copy()


def check_integration(superelement: Superelement, pairs: ContactPairs) -> None:
    """Raise InputError for a structure and a joint that time integration does not take."""
    # A sector of a disk has a size, but no mass matrix: it raises its own error.
    if pairs.operator.shape[1] != len(superelement.mass):
        raise InputError(
            f"the operator of the contact pairs has {pairs.operator.shape[1]} columns, but the superelement has "
            f"{superelement.size} unknowns; both must be equal.",
            arguments=["operator"],
        )
    springs = pairs.tangential_springs
    unequal = np.flatnonzero((springs[:, 0] != springs[:, 1]) & ~np.isnan(springs[:, 0]))
    if unequal.size and coulomb_alone(pairs):
        pair = int(unequal[0])
        raise InputError(
            f"tangential_stiffness[{pair}] is {springs[pair, 0]:g} N/m along t1 and {springs[pair, 1]:g} N/m along t2; "
            "time integration requires pairs that are equally stiff in both directions. Use forced_response for "
            "others, or set both to one value.",
            arguments=["tangential_stiffness"],
        )


def _check_settings(
    frequency_hz: float, steps_per_period: int, max_periods: int, tolerance: float, spectral_radius: float
) -> None:
    """Raise InputError for invalid settings."""
    positive_number("frequency_hz", frequency_hz, "Hz")
    positive_number("tolerance", tolerance)
    whole_number("max_periods", max_periods, 1)
    steps = whole_number("steps_per_period", steps_per_period, 1)
    require_allowed("steps_per_period", steps, steps >= 20, "20 or above; 500 to 2000 are usual")
    radius = real_number("spectral_radius", spectral_radius)
    allowed = "between 0 (fast modes vanish in one step) and 1 (no numerical dissipation)"
    require_allowed("spectral_radius", radius, 0.0 <= radius <= 1.0, allowed)


def coulomb_alone(pairs: ContactPairs) -> bool:
    """Whether the compiled march can take the pairs."""
    return len(pairs.laws) == 1 and isinstance(pairs.laws[0], CoulombLaw)


def _march(
    scheme: Scheme,
    pairs: ContactPairs,
    relative: FloatArray,
    initial_slider: ArrayLike | None,
    initial_cycle: ArrayLike | None,
) -> March:
    """The contacts at the start. Raises InputError for a start that the laws do not take."""
    if coulomb_alone(pairs):
        if initial_cycle is not None:
            raise InputError(
                "initial_cycle is for joints with other laws; give Coulomb pairs initial_slider.",
                arguments=["initial_cycle"],
            )
        at_rest = -pairs.resting_traction / pairs.tangential_springs
        shape = (pairs.n_pairs, 2)
        slider = at_rest if initial_slider is None else _start_vector("initial_slider", initial_slider, shape)
        return CoulombMarch(scheme, pairs, relative, slider)
    if initial_slider is not None:
        raise InputError(
            f"initial_slider is for joints of Coulomb pairs alone, and these follow {', '.join(pairs.law_names)}; give "
            "initial_cycle, a period of the relative motion before the start.",
            arguments=["initial_slider"],
        )
    if initial_cycle is None:
        return LawMarch(scheme, pairs, relative, None)
    cycle = finite_array("initial_cycle", initial_cycle)
    if cycle.ndim != 3 or cycle.shape[1:] != (pairs.n_pairs, 3) or not len(cycle):
        raise InputError(
            f"initial_cycle must have shape (n_samples, {pairs.n_pairs}, 3), t1, t2, n of each pair in m, but its "
            f"shape is {cycle.shape}.",
            arguments=["initial_cycle"],
        )
    return LawMarch(scheme, pairs, relative, cycle)


def start_from_response(response: ForcedResponse, point: int) -> dict[str, Any]:
    """Time 0 of one point of a harmonic-balance curve, as ``initial_...`` arguments of integrate_to_steady_state.

    It includes the memory of the laws (sliders of Coulomb pairs, a period of the motion for others), so that a pair
    that sticks has the mean traction of the harmonic balance; from rest it would end with another one, and both are
    valid steady states. Raises InputError for a point that does not exist.
    """
    n_points = response.frequency_hz.size
    if not 0 <= point < n_points:
        raise InputError(
            f"point is {point}, but it must be between 0 and {n_points - 1}, the points of the curve.",
            arguments=["point"],
        )
    walk = np.zeros(response.n_unknowns) if response.walk is None else response.walk[point]
    pairs = response.pairs.with_update(cast("Update", response.settings["update"]))
    return start_of_motion(
        pairs, response.displacement[point], walk, float(response.frequency_hz[point]), response.samples
    )


def start_of_motion(
    pairs: ContactPairs, coefficients: FloatArray, walk: FloatArray, frequency_hz: float, samples: int
) -> dict[str, FloatArray]:
    """Time 0 of a motion (n, 2H+1) with a ``walk`` (n,) in each cycle, see :func:`start_from_response`."""
    harmonics = coefficients.shape[1] // 2
    rate = 2.0 * np.pi * frequency_hz * np.arange(1, harmonics + 1)
    start = {
        "initial_displacement": coefficients[:, 0] + coefficients[:, 1::2].sum(axis=1),
        "initial_velocity": coefficients[:, 2::2] @ rate + frequency_hz * walk,
    }
    relative = synthesis_matrix(harmonics, samples) @ (pairs.operator @ coefficients).T
    cycle = relative.reshape(samples, pairs.n_pairs, 3)
    if coulomb_alone(pairs):
        return start | {"initial_slider": pairs.walking_cycle(cycle, walk).slider[0]}
    return start | {"initial_cycle": cycle}


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
    initial_cycle: ArrayLike | None = None,
) -> TransientResponse:
    """Integrate ``M u'' + C u' + K u + B^T f(B u) = p(t)`` in time until one period equals the one before.

    ``f = (T1, T2, N)`` of each pair, less what it is at rest: 3-D Coulomb friction with tangential spring, variable
    normal load and separation, integrated exactly along the straight path of each step, in a compiled march; or any
    laws, also several in one joint, by :meth:`ContactLaw.step`, which is much slower. The scheme is
    generalised-alpha: second order, unconditionally stable for the linear part, its numerical dissipation set by
    ``spectral_radius``. Each step solves the contact displacements by Newton with the exact derivative of the step law;
    the effective matrix, with stuck springs in it, is factored once.

    Parameters
    ----------
    superelement:
        mass, damping, stiffness (n, n); None for the damping matrix means none.
    pairs:
        with any laws; those of Coulomb friction alone need equal tangential stiffness in both directions.
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
        it stays as a mean traction. For joints of Coulomb pairs alone.
    spectral_radius:
        factor of the amplitude of a mode much faster than the step in one step.
    initial_cycle:
        (n_samples, n_pairs, 3) m, for joints with other laws: a period of the relative motion that ends at time 0. The
        laws go through it twice from rest, and start from the memory of that periodic state. At rest by default.

    Raises
    ------
    InputError
        for an array of another shape, entries that are not finite, or a setting out of range.
    ConvergenceError
        if the Newton iteration of a step fails; the message gives the step.
    """
    check_integration(superelement, pairs)
    _check_settings(frequency_hz, steps_per_period, max_periods, tolerance, spectral_radius)
    n, n_pairs, operator = superelement.size, pairs.n_pairs, pairs.operator
    load = _periodic_load(force_cos, force_sin, n, steps_per_period)
    time_step = 1.0 / (frequency_hz * steps_per_period)
    scheme = generalised_alpha(superelement, pairs, load, time_step, spectral_radius)

    displacement = _start_vector("initial_displacement", initial_displacement, (n,))
    velocity = _start_vector("initial_velocity", initial_velocity, (n,))
    relative = (operator @ displacement).reshape(n_pairs, 3)
    march = _march(scheme, pairs, relative, initial_slider, initial_cycle)
    unbalanced = load[0] - superelement.stiffness @ displacement - operator.T @ march.force.ravel()
    unbalanced -= superelement.velocity_matrix @ velocity
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
    starts: list[FloatArray] = []
    for period in range(max_periods):
        failed_step = march.period(motion, history, force_history)
        if failed_step >= 0:
            raise ConvergenceError(
                f"the contact iteration of step {failed_step} in period {period} did not converge in "
                f"{MAX_STEP_ITERATIONS} iterations at {frequency_hz:g} Hz. Use more than {steps_per_period} steps per "
                "period."
            )
        starts.append(history[0, :n].copy())
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
        dissipated_energy=_closed_work(force_history, (history[:, :n] @ operator.T).reshape(-1, n_pairs, 3)),
        period_change=np.array(period_change),
        period_starts=np.array(starts),
        converged=converged,
        message=message,
    )
