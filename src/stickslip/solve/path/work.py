"""The work on one curve, counted over all of its pieces and searches, and its limit."""

from __future__ import annotations

import math

# chosen: the limit of the work of a curve that goes on with more harmonics, over the usual one: the equations are other
# ones, and the curve has as much work for them as it had for its own.
EXTENSION = 2.0


class Work:
    """Counts work in iterations of Newton's method, the same on each machine, up to a limit.

    ``coefficients`` is the number of Fourier coefficients of an unknown with which an iteration counts as one; ``most``
    is the limit, infinite for work that has other limits, and raised once by :meth:`extend`. ``limit_words`` is a
    sentence with numbers from the limit on, "" before it. ``in_ramps`` are iterations of amplitude ramps that did not
    reach the full force.
    """

    def __init__(self, coefficients: int = 1, most: float = math.inf) -> None:
        self._coefficients, self._most = coefficients, most
        self.newton = self.in_time = self.in_ramps = 0.0
        self.limit_words = ""
        self._is_extended = False

    def __repr__(self) -> str:
        return f"<Work: {self.total:.0f} of {self._most:g} iterations>"

    @property
    def total(self) -> float:
        """Iterations so far."""
        return self.newton + self.in_time

    def extend(self) -> None:
        """Allow more work, once: a way on was found that none of the work so far had."""
        if not self._is_extended:
            self._is_extended = True
            self._most *= EXTENSION
            self.limit_words = ""
            self._compare()

    def iterate(self, coefficients: int) -> None:
        """Count an iteration with so many coefficients of an unknown."""
        self.newton += coefficients / self._coefficients
        self._compare()

    def integrate(self, iterations: float) -> None:
        """Count a time integration that takes as long as so many iterations."""
        self.in_time += iterations
        self._compare()

    def _compare(self) -> None:
        """Compare with the limit."""
        if self.total >= self._most and not self.limit_words:
            self.limit_words = (
                f"The work on the whole curve reached its limit of {self._most:.0f} iterations of Newton's method: "
                f"{self.newton:.0f} iterations, and time integrations that take as long as {self.in_time:.0f}. "
                "Narrow the range, lower the force or, in Python, raise max_points."
            )
