"""The response at a prescribed amplitude or phase of an output, with the force as unknown: it passes every fold."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.completeness import reported
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import FloatArray, finite_array, positive_number, real_number
from stickslip.results.response import ForcedResponse
from stickslip.solve.curve_result import follower, response_of
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint, Control, ControlledCurve
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import StageReport, checked_window, prepare_balances
from stickslip.structure.superelement import Superelement

# chosen: the start raises the prescribed amplitude from FIRST_FRACTION of its value, at which few pairs slip, at first
# by FIRST_FACTOR a step; it fails where a step would raise the amplitude by less than SMALLEST_FACTOR.
FIRST_FRACTION, FIRST_FACTOR, SMALLEST_FACTOR = 0.01, 2.0, 1.001
NO_STABILITY = (
    "Stability was not computed: it is that of motions under a constant force, and a control changes the force."
)


def controlled_response(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation,
    output: ArrayLike,
    *,
    frequency_hz: tuple[float, float],
    amplitude: float | None = None,
    phase_deg: float | None = None,
    harmonics: int = 5,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    continuation: ContinuationSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
    raise_on_failure: bool = False,
) -> ForcedResponse:
    """Follow the periodic response along the frequency with a prescribed first harmonic of an output.

    The size of the excitation is an unknown: the force at a point is ``load_factor`` times ``excitation``. At a
    prescribed amplitude the force is a single-valued function of the frequency where the ordinary response folds, as in
    response-controlled tests (T. Karaagacli, H. N. Ozguven, Mech. Syst. Signal Process. 148 (2021) 107156).

    Parameters
    ----------
    superelement, pairs, frequency_hz, harmonics, samples, modal_damping_ratio, update, newton, continuation, threads,
    progress, raise_on_failure:
        as in :func:`forced_response`.
    excitation:
        the excitation at a load factor of 1.
    output:
        (n,) row; the solver controls ``output @ u``.
    amplitude:
        0-to-peak of the first harmonic of the output (m for a displacement).
    phase_deg:
        instead of ``amplitude``: the phase lag of the first harmonic of the output behind ``cos(w t)``; 90 is the phase
        resonance of a cosine force. The curve starts where the response at ``load_factor`` = 1 has this phase.

    Returns
    -------
    ForcedResponse
        with ``load_factor`` (n_points,); ``converged`` and ``message`` as in :func:`forced_response`.

    Raises
    ------
    InputError
        for inputs that cannot be used.
    ConvergenceError
        if there is no first point.
    """
    began = time.perf_counter()
    window = checked_window(frequency_hz)
    control, target = _checked_target(amplitude, phase_deg)
    row = finite_array("output", output)
    if row.shape != (superelement.size,) or not row.any():
        raise InputError(
            f"output must have shape ({superelement.size},) with an entry that is not zero.", arguments=["output"]
        )
    threads = thread_count(threads)
    newton = newton or NewtonSettings()
    report = StageReport(progress)
    start_omega, stop_omega = (2.0 * np.pi * f for f in window)
    with solver_threads(threads):
        balances = prepare_balances(
            superelement, pairs, excitation, max(start_omega, stop_omega), harmonics, samples, modal_damping_ratio,
            update, report.stage,
        )  # fmt: skip
        balance = balances.with_harmonics(harmonics)
        report.stage("first point")
        start = _first_point(balance, row, control, target, start_omega, newton, report)
        curve = ControlledCurve(balance, row, control, target)
        solver = Newton(curve, newton, report.iteration)
        branch = Branch(solver, start, stop_omega, continuation or ContinuationSettings(), follower(window, report))
        branch.follow()
        how = f"The first point converged with a load factor of {start.trial.load:.4g}."
        response = response_of(branch, balances, balance, window, newton, how, report, no_stability=NO_STABILITY)
    settings = {**response.settings, f"held_{control}": target if control == "amplitude" else -math.degrees(target)}
    provenance = {"solve_seconds": f"{time.perf_counter() - began:.2f}"}
    return reported(replace(response, settings=settings, provenance=provenance), raise_on_failure)


def _checked_target(amplitude: float | None, phase_deg: float | None) -> tuple[Control, float]:
    """The controlled quantity, and its value in SI units."""
    if (amplitude is None) == (phase_deg is None):
        raise InputError(
            "give either amplitude or phase_deg: the solver controls one of them.", arguments=["amplitude", "phase_deg"]
        )
    if amplitude is not None:
        return "amplitude", positive_number("amplitude", amplitude, "of the output")
    # An output that lags by an angle has the complex amplitude |o| exp(-i angle).
    return "phase", -math.radians(real_number("phase_deg", phase_deg))


def _first_point(
    balance: Balance, output: FloatArray, control: Control, target: float, omega: float, newton: NewtonSettings,
    report: StageReport,
) -> BalancePoint:  # fmt: skip
    """A solution at ``omega`` that satisfies the condition. Raises ConvergenceError."""
    modes = balance.compliance.output_modes(output)
    linear = balance.linear(omega)
    cosine, sine = (float(row @ modes) for row in balance.load_amplitude(omega)[:2])
    size = math.hypot(cosine, sine)
    if size == 0.0:
        raise InputError(
            "the excitation does not move the output, so its amplitude and phase cannot be controlled. Choose another "
            "output.",
            arguments=["output"],
        )

    def solved(goal: float, unknowns: FloatArray, load: float) -> BalancePoint | None:
        curve = ControlledCurve(balance, output, control, goal)
        guess = curve.evaluate(unknowns, np.array([omega, load]))
        correction = Newton(curve, newton, report.iteration).correct(guess, Plane.fixed(unknowns, omega))
        return correction.point if correction.converged and not curve.is_opposite(correction.point) else None

    if control == "phase":
        point = solved(target, linear, 1.0)
        if point is None:
            raise ConvergenceError(
                f"the solver found no response with this phase at the first frequency, {omega / (2 * math.pi):.3f} Hz, "
                "near a load factor of 1. Start at a resonance of the linear stuck response, where the phase is 90 "
                "degrees."
            )
        return point
    fraction, factor = FIRST_FRACTION, FIRST_FACTOR
    load = fraction * target / size
    point = solved(fraction * target, load * linear, load)
    while point is not None and fraction < 1.0:
        wanted = min(1.0, fraction * factor)
        ahead = solved(wanted * target, point.unknowns * (wanted / fraction), point.trial.load * (wanted / fraction))
        if ahead is not None:
            point, fraction = ahead, wanted
            continue
        factor = math.sqrt(factor)
        if factor < SMALLEST_FACTOR:
            point = None
    if point is None:
        raise ConvergenceError(
            f"the solver found no response with this amplitude at the first frequency, {omega / (2 * math.pi):.3f} Hz; "
            f"it reached {100 * fraction:.3g} % of the amplitude. Start farther from the resonance, or give a smaller "
            "amplitude."
        )
    return point
