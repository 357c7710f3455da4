"""Checks of a nonlinear mode with more samples and with more harmonics, with warnings where they change it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.fourier import with_rows
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.checks import LARGEST_SAMPLE_RESIDUAL, sample_residual
from stickslip.solve.harmonic.mode_curve import ModeCurve, ModePoint
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane

# chosen: points at which the samples are doubled to check them.
CHECKED_POINTS = 24
# chosen: changes by two more harmonics above which a warning reports them: of the frequency, a tenth of what a forced
# peak of 1 % damping is wide, and of the damping ratio.
LARGEST_FREQUENCY_CHANGE, LARGEST_RATIO_CHANGE = 1e-3, 2e-2


def sample_warnings(points: Sequence[ModePoint], curve: ModeCurve, fine: Balance) -> tuple[str, ...]:
    """A warning where twice the samples, those of ``fine``, change the balance."""
    chosen = np.linspace(0, len(points) - 1, min(CHECKED_POINTS, len(points))).round().astype(int)
    residuals = [sample_residual(curve.sustained(points[i].trial.growth, fine), points[i].trial) for i in chosen]
    worst = int(np.argmax(residuals))
    if residuals[worst] <= LARGEST_SAMPLE_RESIDUAL:
        return ()
    return (
        f"Too few samples: with {fine.samples} instead of {fine.samples // 2} samples the residual is "
        f"{100 * residuals[worst]:.2f} % of the relative displacement at "
        f"{curve.named(float(points[chosen[worst]].parameters[0]))} (required: below "
        f"{100 * LARGEST_SAMPLE_RESIDUAL:.3g} %). Run again with samples = {fine.samples}.",
    )


@dataclass(frozen=True)
class HarmonicsChange:
    """Relative changes of frequency and damping ratio by more harmonics, at a point with a name."""

    frequency: float
    damping: float
    name: str

    def over(self, damping: float) -> float:
        """The larger of the changes over what is allowed: this change of the damping ratio, and as much of the
        frequency as ``LARGEST_FREQUENCY_CHANGE`` has of ``LARGEST_RATIO_CHANGE``."""
        frequency = damping * LARGEST_FREQUENCY_CHANGE / LARGEST_RATIO_CHANGE
        return max(self.frequency / frequency, self.damping / damping)


def largest_change(
    points: Sequence[ModePoint],
    fine: ModeCurve,
    settings: NewtonSettings,
    count: int,
    allowed: float,
    stops_above: bool = False,
) -> HarmonicsChange:
    """The largest change by the harmonics of ``fine``, measured by an ``allowed`` change of the damping ratio.

    Points are solved again at their amplitude: those of the largest damping ratio and of the largest amplitude, the one
    between both along the branch, and ``count`` along the whole branch. With ``stops_above`` the first change above the
    allowed one is the result, which saves most of the time where it is not reached. Raises ConvergenceError.
    """
    ratio = [point.trial.growth / point.trial.omega for point in points]
    ends = int(np.argmax(ratio)), int(np.argmax([point.modal_amplitude for point in points]))
    along = np.linspace(0, len(points) - 1, count).round().astype(int).tolist()
    changes = [HarmonicsChange(0.0, 0.0, "")]
    for index in dict.fromkeys((*ends, sum(ends) // 2, *along)):
        point = points[index]
        if not point.trial.contact.moves.any():
            continue
        start = fine.evaluate(with_rows(point.unknowns, 2 * fine.balance.harmonics + 1), point.parameters)
        correction = Newton(fine, settings).correct(start, Plane.fixed(start.unknowns, float(point.parameters[0])))
        again, name = correction.point.trial, fine.named(float(point.parameters[0]))
        if not correction.converged:
            raise ConvergenceError(f"the solver found no mode with {fine.balance.harmonics} harmonics at {name}.")
        frequency = abs(again.omega / point.trial.omega - 1.0)
        damping = abs(again.growth / again.omega - ratio[index]) / max(abs(ratio[index]), 1e-300)
        changes.append(HarmonicsChange(frequency, damping, name))
        if stops_above and changes[-1].over(allowed) > 1.0:
            return changes[-1]
    return max(changes, key=lambda change: change.over(allowed))


def harmonics_warnings(points: Sequence[ModePoint], fine: ModeCurve, settings: NewtonSettings) -> tuple[str, ...]:
    """A warning where the mode with the harmonics of ``fine`` has another frequency or damping ratio at three points:
    those of the largest damping ratio, of the largest amplitude, and between both along the branch."""
    try:
        change = largest_change(points, fine, settings, 0, LARGEST_RATIO_CHANGE)
    except ConvergenceError as error:
        return (f"The harmonics were not checked: {error} Compare with a run that has more harmonics.",)
    if change.over(LARGEST_RATIO_CHANGE) <= 1.0:
        return ()
    return (
        f"Too few harmonics: {_changed(change, fine.balance.harmonics, fine.balance.harmonics - 2)} (required: below "
        f"{100 * LARGEST_FREQUENCY_CHANGE:g} % and {100 * LARGEST_RATIO_CHANGE:g} %). Run again with harmonics = "
        f"{fine.balance.harmonics}, or with an accuracy.",
    )


def accuracy_warnings(change: HarmonicsChange | str, accuracy: float, harmonics: int) -> tuple[str, ...]:
    """A warning where the ``harmonics`` of a mode do not reach its accuracy; ``change`` is that by twice as many, or
    why they could not be solved."""
    if isinstance(change, str):
        sentence = change
    elif change.over(accuracy) <= 1.0:
        return ()
    else:
        sentence = f"{_changed(change, 2 * harmonics, harmonics)}."
    return (
        f"The accuracy of {100 * accuracy:.3g} % was not reached with {harmonics} harmonics: {sentence} Frequency and "
        "damping ratio of the mode are uncertain there; more samples allow more harmonics.",
    )


def work_warning(count: int) -> str:
    """A warning on a mode that ended with fewer harmonics than its accuracy requires."""
    return (
        f"A mode with {count} harmonics would be more work than is allowed for an accuracy. Give a smaller largest "
        f"amplitude, a coarser accuracy, or fixed harmonics = {count} instead of the accuracy."
    )


def _changed(change: HarmonicsChange, finer: int, harmonics: int) -> str:
    return (
        f"{finer} instead of {harmonics} change the frequency by {100 * change.frequency:.2g} % and the "
        f"damping ratio by {100 * change.damping:.2g} % of its value, at {change.name}"
    )
