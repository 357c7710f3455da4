"""Common preparation of all analyses along the frequency: checked input, the stuck structure, and its balances."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Protocol, get_args

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import (
    FloatArray,
    finite_array,
    real_number,
    require_allowed,
    require_choice,
    whole_number,
)
from stickslip.solve.excitation import Excitation, ExcitationForce
from stickslip.solve.free_modes import free_modes
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.compliance import StuckStructure, stuck_structure
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.damping import DAMPED_RANGE
from stickslip.solve.harmonic.energy import EquationOfMotion, StructureEquation
from stickslip.solve.harmonic.linear import Limit, LinearLimit
from stickslip.solve.harmonic.operator_products import Rows, as_rows, own_products, row_squares
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.harmonic.soft_structure import SoftStructure, soft_static, soft_structure
from stickslip.solve.harmonic.support import KnownFactors, factor_without_friction, needs_friction
from stickslip.solve.harmonic.unbounded import unbounded_motions
from stickslip.solve.harmonic.walk import mean_without_walk, walking_points, without_walk
from stickslip.solve.motion_in_time import MotionInTime
from stickslip.solve.path.landmarks import Landmark, LandmarkSource
from stickslip.solve.stability.curve import CurveStability, curve_stability
from stickslip.solve.stability.more_harmonics import correction_of
from stickslip.structure.superelement import Superelement

# Largest ratio of contact stiffness to the stiffness of the structure at the pair. Numbers have 16 digits, and the
# balance needs nine of the deformation of the contact (NewtonSettings.tolerance).
STIFFEST_CONTACT = 1e7

# chosen: all modes of a structure with more unknowns are not computed beside its soft ones: about 10 n^3 operations are
# four minutes here, and the memory is 12 n^2 numbers, 6 GB. 15,000 unknowns would take half an hour and 22 GB.
MOST_UNKNOWNS = 8000

# Coefficients (..., 2H, k) of outputs for modal amplitudes (..., 2H, n) of a balance.
Vibration = Callable[[Balance, FloatArray], FloatArray]


class StageReport:
    """Reports progress: the finished fraction, the current stage, and the iterations of Newton's method."""

    def __init__(self, progress: ProgressCallback | None) -> None:
        self._progress: ProgressCallback = progress or (lambda fraction, detail: None)
        self._fraction, self._stage = 0.0, ""

    def stage(self, words: str, fraction: float | None = None) -> None:
        """A stage begins: its name in ``words``, and the finished ``fraction`` (0 to 1) of the work, None if
        unchanged."""
        self._stage, self._fraction = words, self._fraction if fraction is None else fraction
        self._progress(self._fraction, words)

    def iteration(self, number: int, error: float) -> None:
        """Iteration ``number`` of Newton begins at the relative residual ``error``."""
        self._progress(self._fraction, f"{self._stage}; iteration {number}, relative residual {error:.1e}")


class Landmarks(LandmarkSource[BalancePoint], Protocol):
    """Landmarks of a frequency curve, with a list of all of them."""

    @property
    def seen(self) -> Sequence[Landmark]:
        """All landmarks so far."""


class CurveBalances(Protocol):
    """The balances of a frequency curve for any number of harmonics, with what its result says of the structure.

    :class:`Balances` are those of a structure, :class:`stickslip.solve.cyclic.balances.SectorBalances` those of a
    sector of a disk. ``shown_free`` is the limit without contact of results, where ``free`` has springs of other pairs.
    ``no_stability`` is the reason why their points have no stability, or empty; ``no_static_mode`` is that why they
    have no motion under a static load in the shape of a mode. ``in_time`` is None for equations whose solutions are not
    all motions of the structure, so that a time integration shows nothing.
    """

    @property
    def pairs(self) -> ContactPairs: ...
    @property
    def excitation(self) -> Excitation: ...
    @property
    def force(self) -> ExcitationForce: ...
    @property
    def samples(self) -> int: ...
    @property
    def update(self) -> Update: ...
    @property
    def modal_damping_ratio(self) -> float | None: ...
    @property
    def damped_harmonics(self) -> int | None: ...
    @property
    def is_damped(self) -> bool: ...
    @property
    def closed(self) -> Limit: ...
    @property
    def free(self) -> Limit: ...
    @property
    def shown_free(self) -> Limit: ...
    @property
    def equation(self) -> EquationOfMotion: ...
    @property
    def shown_pairs(self) -> ContactPairs: ...
    def shown(self, coefficients: FloatArray) -> FloatArray: ...
    def vibration_of(self, outputs: FloatArray) -> Vibration: ...
    def motion(self, trials: Sequence[Trial], displacement: FloatArray) -> tuple[FloatArray, FloatArray | None]: ...
    def landmarks(self) -> Landmarks: ...
    def unbounded(self, window: tuple[float, float]) -> tuple[str, ...]: ...
    def with_harmonics(self, harmonics: int, samples: int | None = None) -> Balance: ...
    def with_samples(self, samples: int) -> CurveBalances: ...
    @property
    def no_stability(self) -> str: ...
    @property
    def no_static_mode(self) -> str: ...
    def stability(self, trials: Sequence[Trial], pairs: ContactPairs) -> CurveStability: ...
    def in_time(self) -> MotionInTime | None: ...
    def of_structure(self) -> Balances: ...


@dataclass(frozen=True)
class Balances:
    """The balances of one structure, joint and excitation, for any number of harmonics and samples."""

    superelement: Superelement
    pairs: ContactPairs
    stuck: StuckStructure
    excitation: Excitation
    force: ExcitationForce
    samples: int
    update: Update
    modal_damping_ratio: float | None
    no_static_mode: ClassVar[str] = ""

    @property
    def no_stability(self) -> str:
        """Why points have no stability; empty if they have."""
        if self._lacks_modes:
            return (
                "Stability was not computed: multipliers require all modes of the structure, which are computed up to "
                f"{MOST_UNKNOWNS} unknowns; it has {self.superelement.size}."
            )
        if self.superelement.gyroscopic is None:
            return ""
        # The fast coordinates of the march over a period have no coupling by velocities (stability/march.py).
        return "Stability was not computed: the superelement has a gyroscopic matrix, which multipliers do not contain."

    @property
    def damped_harmonics(self) -> int | None:
        """Number of harmonics whose resonances have damping; None if the number does not matter."""
        return None if self.modal_damping_ratio is None else int(DAMPED_RANGE)

    @cached_property
    def closed(self) -> LinearLimit:
        """The structure with every contact that is closed at rest stuck."""
        return LinearLimit(self.stuck.circular_frequency, self.stuck.modes, self.stuck.modal_damping)

    @cached_property
    def free(self) -> LinearLimit:
        """The structure without contact."""
        mass, stiffness, stuck = self.superelement.mass, self.superelement.stiffness, self.stuck
        root = stuck.damping_root if self.superelement.gyroscopic is None else None
        if isinstance(stuck, SoftStructure):
            return stuck.free if root is None else stuck.free.with_damping_root(root)
        frequency, modes = free_modes(mass, stiffness)
        if root is None:
            return LinearLimit.of_modes(frequency, modes, stiffness, stuck.velocity_matrix)
        return LinearLimit.undamped(frequency, modes, stiffness).with_damping_root(root)

    @property
    def shown_free(self) -> LinearLimit:
        """The structure without contact, of results."""
        return self.free

    @property
    def is_damped(self) -> bool:
        """Whether the structure has viscous damping."""
        root = self.stuck.damping_root
        return bool((self.stuck.damping if root is None else root).any())

    @property
    def equation(self) -> EquationOfMotion:
        """The terms of the equation of motion."""
        root = self.stuck.damping_root if self.superelement.gyroscopic is None else None
        damping = self.stuck.velocity_matrix if root is None else root
        return StructureEquation(self.superelement, damping, self.pairs.operator, is_root=root is not None)

    @property
    def shown_pairs(self) -> ContactPairs:
        """The pairs of results."""
        return self.pairs

    def shown(self, coefficients: FloatArray) -> FloatArray:
        """Coefficients (..., 2H+1, n) of the unknowns of results: the same."""
        return coefficients

    def vibration_of(self, outputs: FloatArray) -> Vibration:
        """The outputs (k, n) of vibrations, without the unknowns, whose number is many times that of the outputs."""
        return lambda balance, amplitude: np.asarray(amplitude @ balance.compliance.output_modes(outputs).T)

    def landmarks(self) -> Resonances:
        """The natural frequencies that the force excites."""
        return Resonances(self.closed, self.free, self.stuck, self.force)

    def unbounded(self, window: tuple[float, float]) -> tuple[str, ...]:
        """See :func:`unbounded_motions`."""
        return unbounded_motions(self.free, self.closed, self.pairs, self.force, window)

    def motion(self, trials: Sequence[Trial], displacement: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        """See :func:`without_walk`."""
        return without_walk(self.superelement.mass, self.free, self.pairs, trials, displacement)

    def mean_row(self, trial: Trial, output: FloatArray) -> FloatArray:
        """See :func:`mean_without_walk`; the modes of the free structure, which take long, only where a body walks."""
        if not walking_points(self.pairs, [trial])[0].size:
            return output
        return mean_without_walk(self.superelement.mass, self.free, self.pairs, trial, output)

    def with_harmonics(self, harmonics: int, samples: int | None = None) -> Balance:
        """The balance with a number of harmonics, and of samples if they differ."""
        force = self.force.with_harmonics(harmonics)
        stuck = self.stuck
        soft = stuck.soft_compliance(harmonics) if isinstance(stuck, SoftStructure) else None
        return Balance(soft or stuck.compliance(harmonics), self.pairs, force, samples or self.samples)

    def with_samples(self, samples: int) -> Balances:
        """The same balances with another number of samples."""
        return self if samples == self.samples else replace(self, samples=samples)

    def stability(self, trials: Sequence[Trial], pairs: ContactPairs) -> CurveStability:
        """See :func:`curve_stability`; the verdicts are confirmed with more harmonics."""
        correction = correction_of(trials, self.with_harmonics, self.samples, self.damped_harmonics)
        return curve_stability(trials, pairs, self._with_all_modes.stuck, correction)

    def in_time(self) -> MotionInTime:
        """The motion in time of the structure, with the damping of the balances."""
        matrices = replace(self.superelement, damping=self.stuck.damping, recovery=None)
        return MotionInTime(matrices, self.pairs, self.force)

    def of_structure(self) -> Balances:
        """These balances with all modes, for analyses that require the matrices of a structure."""
        return self._with_all_modes

    def require_all_modes(self, argument: str) -> None:
        """Raise InputError for an ``argument`` that requires all modes of a structure with more than MOST_UNKNOWNS."""
        if self._lacks_modes:
            raise InputError(
                f"{argument} requires all modes of the structure, which are computed up to {MOST_UNKNOWNS} unknowns; "
                f"it has {self.superelement.size}. Give fewer contact pairs, or omit {argument}.",
                arguments=[argument],
            )

    @property
    def _lacks_modes(self) -> bool:
        return isinstance(self.stuck, SoftStructure) and self.superelement.size > MOST_UNKNOWNS

    @cached_property
    def _with_all_modes(self) -> Balances:
        stuck = self.stuck
        if isinstance(stuck, SoftStructure):
            stuck = stuck_structure(self.superelement, self.pairs, stuck.highest_omega, self.modal_damping_ratio)
        return replace(self, stuck=stuck)

    def exact(self, harmonics: int, samples: int) -> Balance:
        """The balance whose Newton matrix contains all modes, as adjoint solutions require."""
        force = self.force.with_harmonics(harmonics)
        return Balance(self.stuck.compliance(harmonics, near_range=math.inf), self.pairs, force, samples)


def prepare_balances(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation,
    highest_omega: float,
    harmonics: int,
    samples: int,
    modal_damping_ratio: float | None,
    update: Update,
    on_stage: Callable[[str], None],
    known: StuckStructure | None = None,
    few_modes: bool = False,
) -> Balances:
    """Check the input and compute the modes of the stuck structure, or use ``known`` ones if they are the same.

    With ``few_modes``, a large joint has its soft modes alone. Raises InputError.
    """
    check_options(harmonics, samples, update, modal_damping_ratio)
    pairs = pairs.with_update(update)
    static = soft_static(superelement, pairs) if few_modes else None
    floats = known is not None and known.needs_friction(superelement, pairs)
    floats = floats or (static is not None and needs_friction(superelement, pairs, static))
    without_friction = None if floats else factor_without_friction(superelement, pairs)
    if without_friction is None:
        # The stuck pairs of such a body carry its mean load: only they know where it is.
        pairs = pairs.retaining()
    force = excitation.on(superelement, harmonics)
    operator = as_rows(pairs.operator)
    elastic, inertial = (resistance(operator, matrix) for matrix in (superelement.stiffness, superelement.mass))
    require_comparable(pairs, elastic + highest_omega**2 * inertial)
    on_stage(f"modes of the stuck structure, {superelement.size} unknowns")
    soft = None
    if static is not None:
        soft = soft_structure(superelement, pairs, force, highest_omega, modal_damping_ratio, static, without_friction)
    factors = KnownFactors(None, without_friction)
    stuck = soft or stuck_structure(superelement, pairs, highest_omega, modal_damping_ratio, known, factors)
    on_stage(f"compliance of {pairs.n_pairs} pairs")
    return Balances(superelement, pairs, stuck, excitation, force, samples, update, modal_damping_ratio)


def resistance(operator: Rows, matrix: FloatArray) -> FloatArray:
    """(m,) ``|b A b|`` of the rows b of an operator."""
    return np.abs(own_products(operator, matrix))


def require_comparable(pairs: ContactPairs, resisting: FloatArray) -> None:
    """Raise InputError for contact so much stiffer than the structure that its deformation is round-off.

    The stiffness of the structure at a pair is that with all other unknowns fixed, or that of its inertia at the
    highest frequency: ``(b K b + w^2 b M b) / |b|^4`` for a row b of the operator; ``resisting`` (m,) is ``b K b + w^2
    b M b``.
    """
    springs, length = pairs.resting_stiffness(), row_squares(pairs.operator)
    allowed = STIFFEST_CONTACT * resisting
    wrong = np.flatnonzero((springs * length**2 > allowed) & (allowed > 0.0))
    if wrong.size:
        worst = int(wrong[(springs[wrong] * length[wrong] ** 2 / allowed[wrong]).argmax()])
        there = allowed[worst] / (STIFFEST_CONTACT * length[worst] ** 2)
        raise InputError(
            f"the contact stiffness of pair {worst // 3} is {springs[worst]:.3g} N/m, but the structure has only "
            f"{there:.3g} N/m there: more than {STIFFEST_CONTACT:.0e} times as much leaves no digits for the "
            f"deformation of the contact. {1e3 * there:.2g} N/m is rigid in effect; give this value, or less."
        )


def checked_window(frequency_hz: tuple[float, float]) -> tuple[float, float]:
    """(start, stop) in Hz. Raises InputError unless both are above zero and differ."""
    values = finite_array("frequency_hz", frequency_hz)
    if values.shape != (2,):
        raise InputError(
            f"frequency_hz must be (start, stop), but its shape is {values.shape}.", arguments=["frequency_hz"]
        )
    start, stop = float(values[0]), float(values[1])
    if start <= 0 or stop <= 0:
        raise InputError(
            f"frequency_hz is ({start:g}, {stop:g}); both ends must be above 0 Hz.", arguments=["frequency_hz"]
        )
    if start == stop:
        raise InputError(
            f"frequency_hz is ({start:g}, {stop:g}), a range of zero width. Give two different frequencies; "
            "a start above the stop sweeps downward.",
            arguments=["frequency_hz"],
        )
    return start, stop


def check_options(harmonics: int, samples: int, update: Update, modal_damping_ratio: float | None) -> None:
    """Raise InputError for options of an analysis that cannot be used."""
    _check_counts(harmonics, samples)
    require_choice("update", update, get_args(Update))
    if modal_damping_ratio is not None:
        ratio = real_number("modal_damping_ratio", modal_damping_ratio)
        require_allowed("modal_damping_ratio", ratio, ratio >= 0, "0 or above, for example 0.001")


def _check_counts(harmonics: int, samples: int) -> None:
    for name, value in (("harmonics", harmonics), ("samples", samples)):
        whole_number(name, value, 1)
    if samples < 2 * harmonics + 1:
        raise InputError(
            f"samples is {samples}, but {harmonics} harmonics require at least {2 * harmonics + 1} samples per period. "
            "Use 256 (512 with much separation): friction forces have kinks that few samples miss.",
            arguments=["samples"],
        )
