"""How fast a peak rises with the parameter of a ridge: one more solution of the equations of its last point.

The modes stay those of the point. With the motion u, the contact force f and the excitation P, the equation of motion
changes by ``P' - C' u' - B^T f'`` at fixed motion; a prime is the derivative by the logarithm of the parameter, and the
damping C of modal ratios follows the modes (docs/theory_gradients.md).
"""

from __future__ import annotations

import math

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.damping import DAMPED_RANGE, modal_damping_change
from stickslip.solve.harmonic.peak import CurvePeak, PeakSearch
from stickslip.solve.setting_up import Balances
from stickslip.structure.superelement import Superelement

# chosen: step of the logarithm of the parameter for differences of the contact force: its error is of this size,
# relative, a tenth of the demand on a ridge.
STEP = 1e-4
# chosen: the damping of modes up to this multiple of the damped range counts; higher ones are quasi-static.
MODES = 2.0


def has_same_structure(first: Superelement, second: Superelement) -> bool:
    """Whether two structures have the same matrices, so that their motions have the same coordinates and modes."""
    return first is second or (
        all(np.array_equal(*pair) for pair in ((first.mass, second.mass), (first.stiffness, second.stiffness)))
        and all(
            a is b or (a is not None and b is not None and np.array_equal(a, b))
            for a, b in ((first.damping, second.damping), (first.gyroscopic, second.gyroscopic))
        )
    )


def rise_of_peak(
    peak: CurvePeak,
    search: PeakSearch,
    balances: Balances,
    changed: tuple[Superelement, ContactPairs, Excitation],
) -> float:
    """Derivative of the logarithm of a peak by that of the parameter, from the input ``changed`` by ``STEP`` of it.

    Not a number at a corner, whose place moves with it, and where the structure itself changes.
    """
    superelement, pairs, excitation = changed
    if peak.is_corner or not has_same_structure(superelement, balances.superelement):
        return math.nan
    trial = peak.probe.point.trial
    pairs = pairs.with_update(balances.update)
    if not balances.pairs.released:
        pairs = pairs.retaining()
    coefficients = np.ascontiguousarray(trial.relative.T).reshape(pairs.n_pairs, 3, -1)
    moved = pairs.period(coefficients, search.balance.samples).force
    contact_force = (moved - trial.contact.force).reshape(3 * pairs.n_pairs, -1).T / STEP
    force = -_viscous(trial, balances, pairs)
    applied = excitation.on(superelement, search.balance.harmonics).coefficients(trial.omega)
    growth = applied - balances.force.with_harmonics(search.balance.harmonics).coefficients(trial.omega)
    if growth.any():
        force += search.balance.compliance.external(growth / STEP).modal
    return search.rise(peak.probe, force, contact_force)


def _viscous(trial: Trial, balances: Balances, pairs: ContactPairs) -> FloatArray:
    """(2H, n) modal force ``C' u'`` of damping that follows the modes, zero without modal ratios."""
    force, stuck = np.zeros_like(trial.amplitude), balances.stuck
    ratio = balances.modal_damping_ratio
    change = (pairs.resting_stiffness() - balances.pairs.resting_stiffness()) / STEP
    if not ratio or not change.any():
        return force
    omega = stuck.circular_frequency
    count = int(np.searchsorted(omega, MODES * DAMPED_RANGE * stuck.highest_omega))
    rows = stuck.contact_modes[:, :count]
    damping = modal_damping_change(
        omega[:count], ratio, stuck.highest_omega, stiffness=rows.T @ (change[:, None] * rows)
    )
    product = trial.amplitude[:, :count] @ damping
    order = np.arange(1, len(product) // 2 + 1)[:, None] * trial.omega
    # The velocity of c cos + s sin is h w (s cos - c sin).
    force[0::2, :count], force[1::2, :count] = order * product[1::2], -order * product[0::2]
    return force
