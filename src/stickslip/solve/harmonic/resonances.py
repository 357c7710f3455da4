"""Natural frequencies of the stuck, the free and the present tangent structure as landmarks of a frequency curve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.path.landmarks import Landmark

# chosen: the width of an undamped resonance, over its frequency; friction or its distance limits it.
LEAST_WIDTH = 1e-6
# chosen: an undamped resonance is approached to this fraction of that width: the compliance of the stuck structure is
# singular on its own natural frequencies, and a point this close to them still has eight digits.
BESIDE = 0.1
# Modes up to this multiple of the highest frequency of the range, of both limits, span those of the tangent structure:
# exact at both limits, and from above between them. Modes of both that differ by less are one.
NEAR_MODES, SAME_MODES = 3.0, 1e-8
# Landmarks up to this multiple of the highest frequency: a curve may turn, and a first point may come from, beyond it.
BEYOND = 1.25


class StuckModes(Protocol):
    """The stuck structure of one harmonic or of all, real or complex: n modes, m rows of pairs."""

    @property
    def pairs(self) -> ContactPairs: ...
    @property
    def circular_frequency(self) -> FloatArray: ...
    @property
    def modes(self) -> NDArray[Any]: ...
    @property
    def mass(self) -> NDArray[Any]: ...
    @property
    def modal_damping(self) -> NDArray[Any]: ...
    @property
    def contact_modes(self) -> NDArray[Any]: ...
    @property
    def highest_omega(self) -> float: ...


class Resonances:
    """The landmarks of a frequency curve: circular frequencies and half-power widths in rad/s.

    At a natural frequency ``w_j`` of mode j, harmonic h of the force excites it at ``w_j / h``. With friction the
    resonance is between those of the stuck and the free structure. The tangent structure at a point has the springs of
    the rows that do not move there; it counts once two successive points have the same moving rows, since before that
    the structure changes from step to step, and changing contact dissipates. Its modes are combinations of the near
    modes of both limits (Rayleigh-Ritz), because those of all unknowns would cost more than the curve.
    """

    def __init__(self, stuck: LinearLimit, free: LinearLimit, structure: StuckModes, force: ExcitationForce) -> None:
        self._structure, self._force = structure, force
        near = [limit.circular_frequency <= NEAR_MODES * structure.highest_omega for limit in (stuck, free)]
        from_free = structure.modes.conj().T @ (structure.mass @ free.modes[:, near[1]])
        both = np.hstack([np.eye(len(from_free))[:, near[0]], from_free])
        self._basis = scipy.linalg.orth(both, rcond=SAME_MODES)  # (n, r) in the coordinates of the stuck modes
        self._shapes = structure.contact_modes @ self._basis
        self._squares = (self._basis.conj().T * structure.circular_frequency**2) @ self._basis
        damping = structure.modal_damping
        across = self._basis.conj().T
        self._damping = (across * damping if damping.ndim == 1 else across @ damping) @ self._basis
        self._of_limits = [*self._landmarks(stuck), *self._landmarks(free)]
        self._moving = b""
        self._of_tangent: dict[bytes, list[Landmark]] = {}

    @property
    def seen(self) -> list[Landmark]:
        """All landmarks so far."""
        return sum(self._of_tangent.values(), list(self._of_limits))

    def of(self, point: BalancePoint) -> Sequence[Landmark]:
        """Those of both limits, and of the tangent structure at a point if it is that of the point before."""
        moves = point.trial.contact.moves.ravel()
        moving, before = moves.tobytes(), self._moving
        self._moving = moving
        if moving != before or not moves.any():
            return self._of_limits
        return self._of_limits + self.of_moving(moves)

    def of_moving(self, moves: BoolArray) -> list[Landmark]:
        """Those of the tangent structure whose rows ``moves`` (m,) have no springs."""
        moving = moves.tobytes()
        if moving not in self._of_tangent:
            self._of_tangent[moving] = self._tangent(np.flatnonzero(moves))
        return self._of_tangent[moving]

    def _tangent(self, rows: NDArray[np.intp]) -> list[Landmark]:
        """The landmarks of the structure without the springs of some rows."""
        springs = self._structure.pairs.resting_stiffness().ravel()[rows]
        shapes = self._shapes[rows]
        squares, turns = scipy.linalg.eigh(self._squares - (shapes.conj().T * springs) @ shapes, check_finite=False)
        modal = turns.conj().T @ self._damping @ turns
        modes = self._structure.modes @ (self._basis @ turns)
        limit = LinearLimit(np.sqrt(np.maximum(squares, 0.0)), modes, modal)
        return self._landmarks(limit)

    def _landmarks(self, limit: LinearLimit) -> list[Landmark]:
        """The resonances that the force excites, up to a little beyond the range: every step looks through them."""
        orders, modes = np.nonzero(limit.moved_by(self._force) & (limit.resonant.circular_frequency > 0.0))
        answer = []
        for order, mode in zip(1 + orders, modes, strict=True):
            omega = float(limit.resonant.circular_frequency[mode])
            width, least = float(limit.resonant.half_power_width[mode]), LEAST_WIDTH * omega
            if width < least:
                width, omega = least, omega + BESIDE * least
            if omega <= order * BEYOND * self._structure.highest_omega:
                answer.append(Landmark(omega / order, width / order))
        return answer
