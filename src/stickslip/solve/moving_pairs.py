"""Which pairs of a joint can move: an estimate from the modes of the structure whose pairs stick.

In each mode j in reach of the excitation all pairs follow the motion ``B phi_j a cos(w t)``. Its amplitude at resonance
is that at which the law and the damping of the mode take out what the force puts in,

    pi |phi_j . p| a = D(a) + 2 pi zeta_j w_j^2 a^2,

with the work D of the law on all pairs in one period, and a mass-normalised mode. A pair can move if its force at
``MARGIN`` times this amplitude is not that of springs. The shape of the mode does not change here, although pairs that
slip lose stiffness; therefore a curve checks the estimate (:mod:`stickslip.solve.partial_joint`).

Source: balance of energy in one mode, J. H. Griffin, J. Eng. Power 102 (1980) 329-333.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.core.validation import FloatArray

# chosen: on the amplitude, for what the fixed shape of the mode does not contain.
MARGIN = 1.25
# chosen: modes within this factor of the range of frequencies; slip lowers frequencies.
REACH = 1.3
SAMPLES = 64  # chosen: of a period; its error is far below that of the estimate
# chosen: factors of two on an amplitude, from where nothing moves to where friction must bound it.
DOUBLINGS = 100
ROUND_OFF = 1e-9  # chosen: a smaller force on a mode, over the largest one, is that of a symmetric mode


def estimated_moving_pairs(
    pairs: ContactPairs,
    circular_frequency: FloatArray,
    modal_force: FloatArray,
    damping_ratio: FloatArray,
    window_omega: tuple[float, float],
) -> NDArray[np.bool_]:
    """(n_pairs,) the pairs that can move in a range of circular frequencies, at least those that move first.

    Pairs of laws without friction, whose force has no linear part, are always among them.

    Parameters
    ----------
    pairs:
        all pairs, with the relative displacements (3 * n_pairs, k) of the mass-normalised modes as operator.
    circular_frequency, modal_force, damping_ratio:
        (k,) rad/s, N of the largest harmonic, and 1, of the modes with stuck pairs.
    window_omega:
        rad/s, the range of the harmonics of the excitation.
    """
    low, high = min(window_omega) / REACH, max(window_omega) * REACH
    excited = modal_force > ROUND_OFF * modal_force.max()
    reached = np.flatnonzero(excited & (circular_frequency >= low) & (circular_frequency <= high))
    if not reached.size:  # no resonance: the mode that the force excites most
        reached = np.array([int(np.argmax(modal_force / circular_frequency**2))])
    modes = [
        _Mode(pairs, pairs.operator[:, j], float(circular_frequency[j]), float(modal_force[j]), float(damping_ratio[j]))
        for j in reached
    ]
    moving = np.asarray(np.any([mode.moving(MARGIN * mode.amplitude()) for mode in modes], axis=0))
    if not moving.any():
        moving = max(modes, key=lambda mode: mode.force).first_moving()
    for law, members in zip(pairs.laws, pairs.members, strict=True):
        if not isinstance(law, FrictionLaw):
            moving[members] = True
    return moving


class _Mode:
    """One mode, with its shape at the pairs (3 * n_pairs,)."""

    def __init__(
        self, pairs: ContactPairs, shape: FloatArray, circular_frequency: float, force: float, damping_ratio: float
    ) -> None:
        self.force = force
        self._conventions = pairs, pairs.retaining()
        self._shape, self._omega, self._ratio = shape, circular_frequency, damping_ratio

    def amplitude(self) -> float:
        """The modal amplitude at resonance; infinite where neither friction nor damping bounds it."""
        high = self.force / self._omega**2  # static
        for _ in range(DOUBLINGS):
            if self._surplus(high) <= 0.0:
                break
            high *= 2.0
        else:
            return np.inf
        low = 0.5 * high
        while self._surplus(low) <= 0.0:  # near rest the force does more work than friction, which is none there
            low *= 0.5
        return float(brentq(self._surplus, low, high, rtol=1e-3))

    def moving(self, amplitude: float) -> NDArray[np.bool_]:
        """(n_pairs,) the pairs whose force is not that of springs, with released or retained tractions."""
        if not np.isfinite(amplitude):
            return np.ones(self._shape.size // 3, dtype=bool)
        periods = (each.period(self._motion(amplitude), SAMPLES) for each in self._conventions)
        return np.asarray(np.any([period.moves.any(axis=1) for period in periods], axis=0))

    def first_moving(self) -> NDArray[np.bool_]:
        """(n_pairs,) the pairs that move first as the amplitude grows; all if none ever does."""
        amplitude = self.amplitude()
        for _ in range(DOUBLINGS):
            moving = self.moving(amplitude)
            if moving.any():
                break
            amplitude *= 2.0
        return moving if moving.any() else ~moving

    def _motion(self, amplitude: float) -> FloatArray:
        """(n_pairs, 3, 3) coefficients of the motion of the pairs."""
        coefficients = np.zeros((self._shape.size // 3, 3, 3))
        coefficients[:, :, 1] = amplitude * self._shape.reshape(-1, 3)
        return coefficients

    def _surplus(self, amplitude: float) -> float:
        """Work of the force in a period less what friction and damping take out, over the amplitude."""
        motion = self._motion(amplitude)
        force = self._conventions[0].period(motion, SAMPLES).force
        friction = -np.pi * float((motion[:, :, 1] * force[:, :, 2]).sum())
        viscous = 2.0 * np.pi * self._ratio * self._omega**2 * amplitude**2
        return (np.pi * self.force * amplitude - friction - viscous) / amplitude
