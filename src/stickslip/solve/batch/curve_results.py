"""The results of single curves: of the batch, and of those that the batch lost and that are solved alone."""

from __future__ import annotations

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.results.batch import BatchCurve
from stickslip.results.response import ForcedResponse
from stickslip.solve.batch.curve_points import CurvePoints
from stickslip.solve.batch.equations import StackedBalance
from stickslip.solve.batch.outputs import Outputs
from stickslip.solve.batch.peaks import with_peaks
from stickslip.solve.forced import unreported_response
from stickslip.solve.setting_up import Balances
from stickslip.solve.tractions.traction_band import DEFAULT_STARTS

COMPLETE = "The curve reached the stop frequency."
# chosen: a point of a curve that was solved alone is one of the equations of the batch up to this error. Tolerances are
# 1e-9, and 1e-7 where round-off is larger.
SAME_EQUATIONS = 1e-6
NO_PEAK = "The amplitude of its peak is that of its highest point, up to some percent below the maximum."


def curve_of(outputs: Outputs, place: int, points: CurvePoints) -> BatchCurve:
    """The result of curve ``place`` of the batch."""
    curves = np.full(len(points.omega), place)
    amplitude, hertz = outputs.amplitudes(curves, points), points.omega / (2.0 * np.pi)
    highest = int(amplitude.argmax())
    return BatchCurve(
        hertz, amplitude, outputs.coefficients(curves, points), points.contact_state, points.error,
        float(amplitude[highest]), float(hertz[highest]), True, COMPLETE,
    )  # fmt: skip


def curve_alone(
    balances: Balances, output: FloatArray, window: tuple[float, float], harmonics: int, threads: int, reason: str
) -> BatchCurve:
    """The result of a curve that the batch lost for a reason, from :func:`forced_response` without checks.

    Its peak has a point at its maximum too, or ``message`` reports that it has none.
    """
    try:
        response = unreported_response(
            balances.superelement, balances.pairs, balances.excitation, frequency_hz=window, harmonics=harmonics,
            accuracy=None, samples=balances.samples, modal_damping_ratio=balances.modal_damping_ratio,
            update=balances.update, newton=None, continuation=None, traction_band=None,
            traction_starts=DEFAULT_STARTS, outputs=output, checks=False, threads=threads, progress=None,
        )  # fmt: skip
    except ConvergenceError as error:
        none, width, pairs = np.empty(0), 2 * harmonics + 1, balances.pairs.n_pairs
        states = np.empty((0, pairs), dtype=np.int8)
        return BatchCurve(
            none, none, np.empty((0, width)), states, none, np.nan, np.nan, False, str(error), reason
        )  # fmt: skip
    amplitude = response.amplitude(output)
    highest = int(amplitude.argmax())
    peak = _refined_peak(balances, output, response, window)
    if peak is None:
        peak = float(amplitude[highest]), float(response.frequency_hz[highest])
        message = f"{response.message} {NO_PEAK}"
    else:
        message = response.message
    return BatchCurve(
        response.frequency_hz, amplitude, response.coefficients(output), response.contact_state, response.residual,
        *peak, response.converged, message, reason,
    )  # fmt: skip


def _refined_peak(
    balances: Balances, output: FloatArray, response: ForcedResponse, window: tuple[float, float]
) -> tuple[float, float] | None:
    """Amplitude and frequency in Hz of the highest peak of a response; None where its points are not solutions of the
    same equations (other harmonics, or bodies that walk), and where a maximum has no solution."""
    if response.point_harmonics is not None or response.n_points < 2:
        return None
    one, outputs = StackedBalance.of([balances], response.harmonics), Outputs.of([balances], [output])
    relative = np.einsum("mn,knw->kmw", balances.pairs.operator, response.displacement)
    omega = 2.0 * np.pi * response.frequency_hz
    trial = one.take(np.zeros(len(omega), dtype=np.int64)).evaluate(relative, omega)
    if not (trial.error <= SAME_EQUATIONS).all():
        return None
    points = CurvePoints.of(trial, np.arange(len(omega)))
    width = 2.0 * np.pi * abs(window[1] - window[0])
    (refined,), (lost,) = with_peaks(one, outputs, [points], [0], width)
    result = curve_of(outputs, 0, refined)
    return None if lost else (result.peak_amplitude, result.peak_frequency_hz)
