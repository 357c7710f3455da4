"""Checks of a nonlinear mode with more samples and with more harmonics, with warnings where they change it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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


def harmonics_warnings(points: Sequence[ModePoint], fine: ModeCurve, settings: NewtonSettings) -> tuple[str, ...]:
    """A warning where the mode with the harmonics of ``fine`` has another frequency or damping ratio.

    Three points are solved again at their amplitude: those of the largest damping ratio, of the largest amplitude, and
    between both along the branch.
    """
    ratio = [point.trial.growth / point.trial.omega for point in points]
    ends = int(np.argmax(ratio)), int(np.argmax([point.modal_amplitude for point in points]))
    changes = []
    for index in sorted({*ends, sum(ends) // 2}):
        point = points[index]
        moving = point.trial.contact.moves.any()
        if not moving:
            continue
        start = fine.evaluate(with_rows(point.unknowns, 2 * fine.balance.harmonics + 1), point.parameters)
        correction = Newton(fine, settings).correct(start, Plane.fixed(start.unknowns, float(point.parameters[0])))
        again = correction.point.trial
        name = fine.named(float(point.parameters[0]))
        if not correction.converged:
            return (
                f"The harmonics were not checked: the solver found no mode with {fine.balance.harmonics} harmonics at "
                f"{name}. Compare with a run that has more harmonics.",
            )
        frequency = abs(again.omega / point.trial.omega - 1.0)
        damping = abs(again.growth / again.omega - ratio[index]) / max(abs(ratio[index]), 1e-300)
        worst = max(frequency / LARGEST_FREQUENCY_CHANGE, damping / LARGEST_RATIO_CHANGE)
        changes.append((worst, frequency, damping, name))
    if not changes or max(changes)[0] <= 1.0:
        return ()
    _, frequency, damping, name = max(changes)
    return (
        f"Too few harmonics: {fine.balance.harmonics} instead of {fine.balance.harmonics - 2} change the frequency by "
        f"{100 * frequency:.2g} % and the damping ratio by {100 * damping:.2g} % of its value, at {name} (required: "
        f"below {100 * LARGEST_FREQUENCY_CHANGE:g} % and {100 * LARGEST_RATIO_CHANGE:g} %). Run again with harmonics = "
        f"{fine.balance.harmonics}.",
    )
