"""Natural frequencies that a higher harmonic of the contact may excite: places of narrow peaks of outputs.

Contact that slips or opens exerts forces at multiples of the excitation. At ``w_j / h`` its harmonic h excites mode j.
From a motion beside, whose harmonic h has the modal amplitude q, the resonance is predicted as if this force were
constant: with half of the half-power width b of the mode,

    q_peak = q |h w - w_j + i b| / b

so most of these places, where so little is excited that no peak can be visible, need no search.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip.core.fourier import with_rows
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.linear import Limit, LinearLimit

# chosen: a predicted motion of a mode above this fraction of the whole motion is searched. A peak 1 % higher has 14 %
# in quadrature, and the force of the contact changes with the motion.
EXCITED = 0.05
# Places, in half-power widths beside a natural frequency of the stuck structure: contact that moves lowers the
# frequency of a resonance and widens it.
PLACES = (-1.0, -0.5, -0.25, 0.0, 0.5)


def overtone_places(limit: Limit, points: Sequence[BalancePoint]) -> dict[int, list[float]]:
    """Number of the point before a step -> the frequencies in it, rad/s in its direction, at and beside those at which
    a higher harmonic may excite a mode of the stuck structure visibly.

    ``limit`` is that of the stuck structure; in a sector of a disk the harmonics belong to other waves, and it has no
    such places.
    """
    if not isinstance(limit, LinearLimit) or not any(point.trial.contact.moves.any() for point in points):
        return {}
    omega = np.array([point.trial.omega for point in points])
    sizes = np.array([np.linalg.norm(point.measured) for point in points])
    beside = np.maximum(sizes[:-1], sizes[1:])
    natural, widths = limit.resonant.circular_frequency, limit.resonant.half_power_width
    rows = max(len(point.trial.amplitude) for point in points)
    modes = np.flatnonzero((natural > 0.0) & (natural < 0.5 * rows * omega.max()) & (widths > 0.0))
    amplitude = np.array([with_rows(point.trial.amplitude[:, modes], rows) for point in points])
    found: dict[int, list[float]] = {}
    for order in range(2, rows // 2 + 1):
        motion = np.hypot(amplitude[:, 2 * order - 2], amplitude[:, 2 * order - 1])
        half = 0.5 * widths[modes]
        predicted = motion * np.hypot(order * omega[:, None] - natural[modes], half) / half
        visible = np.maximum(predicted[:-1], predicted[1:]) > EXCITED * beside[:, None]
        visible &= np.abs(np.diff(omega))[:, None] > widths[modes] / order
        for share in PLACES:
            targets = (natural[modes] + share * widths[modes]) / order
            crossed = (omega[:-1, None] - targets) * (omega[1:, None] - targets) < 0.0
            for step, mode in zip(*np.nonzero(crossed & visible), strict=True):
                found.setdefault(int(step), []).append(float(targets[mode]))
    return {step: sorted(each, reverse=bool(omega[step] > omega[step + 1])) for step, each in found.items()}
