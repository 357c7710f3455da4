"""Linear peaks of a joint with its contacts stuck and free, and the excitation at which its pairs slip.

As long as all pairs stick, the motion is the linear stuck one, so the excitation at which the first pair slips in each
period follows from it. A pair that would slip once and then stick with another traction (shakedown) does not count.

The excitation at which nearly all pairs slip has two estimates, one too low and one too high, which a run then decides.
The lower one keeps the shape of that motion, the upper one is the static motion under a load in the shape of the mode
(:func:`stickslip.solve.modes.quasi_static_mode.quasi_static_mode`), in which pairs slip in one direction only. For
both, the excitation that sustains the amplitude follows from the damping of that static mode: ``|phi^T p| = 2 zeta w^2
a``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactState
from stickslip.core.errors import StickslipError
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.peaks import Peak
from stickslip.solve.curve_structures import CurveInput, curve_structure
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.linear import Limit, elastic_hz
from stickslip.solve.modes.linear_mode import LinearMode
from stickslip.solve.modes.quasi_static_mode import unreported_static_mode
from stickslip.solve.setting_up import Balances, CurveBalances, StageReport
from stickslip.structure.substructure import Substructure

# chosen: fraction of the pairs that count as nearly all; the last ones often stick at any force, where nothing moves.
NEARLY_ALL = 0.95
# chosen: peaks are searched from this fraction of the lowest natural frequency to this multiple of the MODES-th one.
BELOW, BEYOND, MODES = 0.5, 1.2, 4
# chosen: of the lowest natural frequency without contact. An output that only inertia holds there moves as 1/w^2.
FAR_BELOW, GROWS = 0.01, 2.0
# chosen: load steps of the quasi-static mode, and its highest motion over that at which nearly all would slip in the
# shape of the stuck motion. Twice as many steps change the upper estimate by some percent.
POINTS_PER_DECADE, HIGHEST_MOTION = 20, 30.0
_DIRECTIONS = 36  # chosen: of slip in the half plane; a traction between two of them differs by 0.1 %
_SAMPLES = 64  # chosen: instants of a period; between two of them a harmonic differs by 0.1 % of its largest value


@dataclass(frozen=True)
class SlipOnset:
    """Linear peaks and the beginning of slip.

    stuck_peak, free_peak:
        highest peak of the output with all pairs that are closed at rest stuck, and without contact, m, infinite
        without viscous damping; None where there is none among the first modes. No free peak if ``is_loose``.
    first, nearly_all:
        excitation at the stuck peak, over that of the study, at which the first pair slips, and a lower and an upper
        estimate of that at which nearly all do (:data:`NEARLY_ALL`); None where it is not known.
    trouble:
        the reason why one of them is not known, else "".
    is_loose:
        whether without contact the excitation moves the output as a rigid body, as in a lap joint. Peaks without
        contact are then those of other modes.
    """

    stuck_peak: Peak | None
    free_peak: Peak | None
    first: float | None
    nearly_all: tuple[float, float] | None
    trouble: str = ""
    is_loose: bool = False


def slip_onset(
    structure: Substructure,
    pairs: ContactPairs,
    excitation: Excitation,
    output: ArrayLike,
    *,
    modal_damping_ratio: float | None = None,
    highest_hz: float | None = None,
) -> SlipOnset:
    """The linear peaks of an output among the first modes, and the excitations at which the pairs slip there.

    ``output`` is a row (n,), of a sector of a disk (2n,) with the unknowns of the next one. ``highest_hz`` is the end
    of the range of a curve, on which depends how many modes ``modal_damping_ratio`` damps; None stands for the last of
    the first modes.

    Pairs of other laws than Coulomb's, and pairs that are open at rest, do not count. Raises InputError.
    """
    row, curve = finite_array("output", output), curve_structure(structure)
    highest = highest_hz or BEYOND * curve.highest_elastic_hz(pairs, MODES)
    given = CurveInput(
        pairs, excitation, 2.0 * math.pi * highest, excitation.harmonics, True, _SAMPLES, modal_damping_ratio,
        "tractrix",
    )  # fmt: skip
    balances = curve.balances(given, StageReport(None).stage)
    window = _window((balances.closed, balances.free))
    stuck, free = (
        next((each for each in limit.peaks(window, balances.force, row) if each.bracketed), None)
        for limit in (balances.closed, balances.free)
    )
    is_loose = _moves_freely(balances, row)
    if is_loose:
        free = None
    onset = _onset(balances, stuck, free, window, row)
    return replace(onset, is_loose=is_loose)


def _moves_freely(balances: CurveBalances, output: FloatArray) -> bool:
    """Whether the response of an output without contact, over the force, grows as ``1/w^2`` towards zero frequency."""
    omega = 2.0 * math.pi * FAR_BELOW * float(elastic_hz(balances.free)[0]) * np.array([1.0, 0.5])
    motion = np.linalg.norm(output @ balances.free.response_to(omega, balances.force), axis=-1)
    force = np.array([np.linalg.norm(balances.force.coefficients(each)) for each in omega])
    return bool(motion[1] * force[0] > GROWS * motion[0] * force[1])


def _onset(
    balances: CurveBalances, stuck: Peak | None, free: Peak | None, window: tuple[float, float], row: FloatArray
) -> SlipOnset:
    is_damped = bool(balances.closed.damping_ratio(window))
    if not is_damped:
        stuck, free = (each and replace(each, amplitude=math.inf) for each in (stuck, free))
    if stuck is None:
        return SlipOnset(stuck, free, None, None, "there is no stuck peak among the first modes.")
    if not is_damped:
        return SlipOnset(stuck, free, None, None, "there is no viscous damping, so the stuck peak has no bound.")
    begins = np.sort(_slip_begins(balances, stuck))
    if not np.isfinite(begins).any():
        return SlipOnset(stuck, free, None, None, "no pair with Coulomb friction moves at the stuck peak.")
    first, last = float(begins[0]), float(np.quantile(begins, NEARLY_ALL, method="higher"))
    if balances.no_static_mode:
        return SlipOnset(stuck, free, first, None, balances.no_static_mode)
    if not math.isfinite(last):
        return SlipOnset(stuck, free, first, None, "some pairs do not move at the stuck peak.")
    try:
        nearly_all = _sustained(balances.of_structure(), stuck, last, row)
    except StickslipError as error:
        return SlipOnset(stuck, free, first, None, str(error))
    trouble = "" if nearly_all else f"some pairs stick up to {HIGHEST_MOTION:g} times the motion of the lower estimate."
    return SlipOnset(stuck, free, first, nearly_all, trouble)


def _window(limits: tuple[Limit, Limit]) -> tuple[float, float]:
    """Hz, of the first modes with stuck contacts and without contact."""
    elastic = [each for limit in limits if (each := elastic_hz(limit)).size]
    return BELOW * min(float(each[0]) for each in elastic), BEYOND * max(float(each[:MODES][-1]) for each in elastic)


def _slip_begins(balances: CurveBalances, peak: Peak) -> FloatArray:
    """(n,) motion over that of a stuck peak at which each pair begins to slip; infinite for a pair that does not move.

    Coulomb pairs that are closed at rest count.
    """
    pairs, omega = balances.shown_pairs, 2.0 * math.pi * peak.frequency_hz
    motion = balances.closed.response_to(np.array([omega]), balances.force)[0]
    relative = (pairs.operator @ motion).reshape(pairs.n_pairs, 3, -1)
    counts = np.flatnonzero((pairs.normal_load > 0.0) & ~np.isnan(pairs.friction_coefficient))
    signal = relative[counts] @ synthesis_matrix(balances.force.harmonics, _SAMPLES).T  # (n, 3, samples)
    springs, friction = pairs.resting_stiffness().reshape(-1, 3)[counts], pairs.friction_coefficient[counts]
    angle = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    across = np.einsum("de,pe,pes->pds", np.column_stack([np.cos(angle), np.sin(angle)]), springs[:, :2], signal[:, :2])
    varying = (friction[:, None] * springs[:, 2:] * signal[:, 2])[:, None]
    # A slider that rests exists while s (T - mu N') at one instant and s (T + mu N') at another are 2 mu N_0 apart.
    driving = ((across - varying).max(axis=2) - (across + varying).min(axis=2)).max(axis=1, initial=0.0)
    limit = 2.0 * friction * pairs.normal_load[counts]
    begins: FloatArray = np.divide(limit, driving, out=np.full(limit.shape, np.inf), where=driving > 0.0)
    return begins


def _sustained(balances: Balances, peak: Peak, motion: float, output: FloatArray) -> tuple[float, float] | None:
    """Lower and upper estimate of the excitation, over that of the study, under which nearly all pairs slip.

    In the shape of the stuck peak they do at ``motion``, over that of the peak. Raises InputError for a mode whose
    shape is not unique, ConvergenceError without an equilibrium.
    """
    pairs, undamped = balances.pairs, balances.closed
    moving = np.flatnonzero(~undamped.rigid)
    index = int(np.abs(undamped.natural_hz[moving] - peak.frequency_hz).argmin())
    shape = undamped.modes[:, moving[index]]
    force = balances.force.coefficients(2.0 * math.pi * peak.frequency_hz)[1:3] @ shape
    amplitude = motion * peak.amplitude / abs(float(output @ shape))
    linear = LinearMode.of(balances.superelement, pairs, index + 1, "stuck", undamped)
    structure = stuck_structure(
        balances.superelement, pairs, linear.omega, balances.modal_damping_ratio, balances.stuck
    )
    mode = unreported_static_mode(structure, linear, (amplitude, HIGHEST_MOTION * amplitude), POINTS_PER_DECADE)
    omega = 2.0 * np.pi * mode.frequency_hz
    sustained = 2.0 * mode.damping_ratio * omega**2 * mode.modal_amplitude / np.linalg.norm(force)
    counts = (pairs.normal_load > 0.0) & ~np.isnan(pairs.friction_coefficient)
    many = np.flatnonzero((mode.contact_state[:, counts] != ContactState.STUCK).mean(axis=1) >= NEARLY_ALL)
    return (float(sustained[0]), float(sustained[many[0]])) if many.size else None
