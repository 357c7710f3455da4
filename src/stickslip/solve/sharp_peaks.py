"""Points of a curve of few digits at its peaks, solved again with more digits.

A curve that is one of many needs no more digits along its way than its accuracy, but its peaks are results, and the
estimates of its errors are made there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from stickslip.core.errors import ConvergenceError
from stickslip.solve.harmonic.curves import BalancePointT
from stickslip.solve.path.corrector import Corrector, parameter_of
from stickslip.solve.path.newton import Newton
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import BranchPoint, ContinuationSettings, Effort


def sharpen(
    points: list[BranchPoint[BalancePointT]],
    places: Iterable[int],
    newton: Newton[BalancePointT],
    width: float,
    begin: Callable[[BalancePointT], None] = lambda point: None,
) -> None:
    """Replace the points at some places by solutions of ``newton``, in the planes across their tangents.

    ``width`` is the range of the curve in rad/s, ``begin`` sets the harmonics of ``newton`` to those of a point, where
    they differ. Raises ConvergenceError where there is no solution.
    """
    corrector = Corrector(newton, width, Effort(ContinuationSettings()))
    for place in places:
        known = points[place]
        begin(known.point)
        if known.tangent is None:  # an end of the curve
            plane = Plane.fixed(known.point.unknowns, parameter_of(known.point))
        else:
            plane = corrector.plane(known.point, known.tangent, 0.0)
        correction = corrector.correct(known.point, plane)
        if not correction.converged:
            name = newton.problem.named(parameter_of(known.point))
            raise ConvergenceError(
                f"the point at {name}, one of the highest of the curve, is a solution to "
                f"{known.point.error:.1e} of its motion only: with more digits the solver stopped at "
                f"{correction.point.error:.1e}."
            )
        iterations = known.iterations + correction.iterations
        points[place] = replace(known, point=correction.point, iterations=iterations)
