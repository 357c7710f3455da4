"""Linear limits of a sector under a travelling wave, and their natural frequencies as landmarks of a curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.results.peaks import Peak, peaks
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.solve.cyclic.stuck_sector import StuckSector
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.gain import to_complex
from stickslip.solve.harmonic.linear import LinearLimit, refined_grid
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.path.landmarks import Landmark


class SectorLimit:
    """The response of a linear sector; ``limit_of`` gives the limit of the nodal diameter of a harmonic.

    Natural frequencies and damping are those of the first harmonic.
    """

    def __init__(self, limit_of: Callable[[int], LinearLimit], stuck: StuckSector) -> None:
        self._limit_of, self._stuck = limit_of, stuck

    @property
    def natural_hz(self) -> FloatArray:
        """(n,) natural frequencies of the nodal diameter of the engine order."""
        return self._limit_of(1).natural_hz

    @property
    def rigid(self) -> NDArray[np.bool_]:
        """(n,) whether a mode is a motion of a free body."""
        return self._limit_of(1).rigid

    def damping_ratio(self, window_hz: tuple[float, float]) -> float | None:
        """Largest modal damping ratio inside a window; None without modes there."""
        return self._limit_of(1).damping_ratio(window_hz)

    def peaks(self, window_hz: tuple[float, float], force: ExcitationForce, output: FloatArray) -> list[Peak]:
        """The peaks of an output (2n,) in a window, highest first; not bracketed at an end."""
        orders = range(1, force.harmonics + 1)
        natural = np.concatenate([self._limit_of(order).natural_hz / order for order in orders])
        frequency_hz = refined_grid(window_hz, natural)
        signal = np.einsum("n,fnk->fk", output, self.response_to(2.0 * np.pi * frequency_hz, force))
        return peaks(frequency_hz, periodic_amplitude(signal))

    def response_to(self, omega: FloatArray, force: ExcitationForce) -> FloatArray:
        """Coefficients (n_frequencies, 2n, 2H+1) of this sector and the next one; the mean is zero."""
        size = force.terms[0][1].shape[1]
        answer = np.zeros((omega.size, 2 * force.harmonics + 1, size))
        for power, array in force.terms:
            amplitudes = to_complex(array[1:])
            for order in np.flatnonzero(np.abs(amplitudes).any(axis=1)) + 1:
                limit = self._limit_of(int(order))
                modal = limit.modes.conj().T @ amplitudes[order - 1]
                motion = omega**power * (limit.modes @ limit.modal(order * omega, modal))
                answer[:, 2 * order - 1] += motion.real.T
                answer[:, 2 * order] -= motion.imag.T
        return self._stuck.expanded(answer).transpose(0, 2, 1)


class SectorLandmarks:
    """The natural frequencies that a force excites, in the nodal diameter of each of its harmonics."""

    def __init__(self, stuck: StuckSector, force: ExcitationForce) -> None:
        self._of_orders = []
        for order in range(1, force.harmonics + 1):
            alone = force_of_order(force, order)
            if any(array.any() for _, array in alone.terms):
                part = stuck.of_order(order)
                self._of_orders.append(Resonances(part.closed, part.free, part, alone))

    @property
    def seen(self) -> list[Landmark]:
        """All landmarks so far."""
        return [mark for each in self._of_orders for mark in each.seen]

    def of(self, point: BalancePoint) -> Sequence[Landmark]:
        """Those of both limits, and of the tangent structure at a point, see :class:`Resonances`."""
        return [mark for each in self._of_orders for mark in each.of(point)]


def force_of_order(force: ExcitationForce, order: int) -> ExcitationForce:
    """The force with one harmonic alone."""
    terms = []
    for power, array in force.terms:
        alone = np.zeros_like(array)
        alone[2 * order - 1 : 2 * order + 1] = array[2 * order - 1 : 2 * order + 1]
        terms.append((power, alone))
    return ExcitationForce(tuple(terms))
