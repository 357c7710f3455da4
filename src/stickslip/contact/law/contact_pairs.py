"""The joint as the solver sees it: an operator to relative displacements, and the law of each contact pair."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike

from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.contact.law.joined_laws import (
    joined_cycle,
    joined_hidden_springs,
    joined_period,
    joined_step,
    joined_tangent,
    joined_values,
)
from stickslip.contact.law.law import BoolArray, ContactCycle, ContactLaw, ContactState, IndexArray, LawPeriod, LawStep
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, per_pair

# What a contact law has: the members of the protocol.
_MEMBERS = sorted(name for name in {*ContactLaw.__annotations__, *vars(ContactLaw)} if not name.startswith("_"))


@dataclass(frozen=True)
class ContactPairs:
    """Contact pairs with their laws: 3-D Coulomb friction with separation, or others (:meth:`with_laws`).

    Relative displacement ``x = operator @ u`` (t1, t2, n of each pair; n > 0 closes). The force on the left-hand side
    of the equation of motion is ``operator.T @ f``; for Coulomb pairs ``f = (T1, T2, N - normal_load)`` and ``N =
    max(normal_load + normal_stiffness * (n - gap), 0)``, ``|T| <= friction_coefficient * N``: displacements are
    relative to the state at rest, where the structure balances a normal load and a gap carries no force.

    Parameters
    ----------
    operator:
        (3 * n_pairs, n), rows t1, t2, n of pair 0, then of pair 1, ...
    normal_stiffness:
        (n_pairs,) N/m, above zero; a number applies to all pairs.
    tangential_stiffness:
        (n_pairs,) N/m, above zero, or (n_pairs, 2) for different stiffness along t1 and t2.
    friction_coefficient:
        (n_pairs,), above zero.
    normal_load, gap:
        (n_pairs,) N and m at rest, 0 or above, by default 0; a number applies to all pairs. A pair under load has no
        gap.
    preload:
        instead of both: (n_pairs,) N, the normal load, or below zero a gap of ``-preload / normal_stiffness``.
    residual_traction:
        None (released): the slider of a pair starts each period at the mean of its motion, so the traction at rest has
        no effect. Or (n_pairs, 2) N along t1, t2 (retained): the traction of friction at rest, in equilibrium with the
        static state of the structure; it stays in a pair that never slips. It must not exceed ``mu * normal_load``.
        Where friction alone supports a body, an analysis retains tractions in any case, with None from zero.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, zero stiffness, a friction coefficient that is not positive, or
        a residual traction beyond the friction limit.
    """

    operator: FloatArray
    laws: tuple[ContactLaw, ...]
    members: tuple[IndexArray, ...]

    def __init__(
        self,
        operator: Any,
        normal_stiffness: ArrayLike,
        tangential_stiffness: ArrayLike,
        friction_coefficient: ArrayLike,
        preload: ArrayLike | None = None,
        residual_traction: ArrayLike | None = None,
        *,
        normal_load: ArrayLike | None = None,
        gap: ArrayLike | None = None,
    ) -> None:
        matrix = _checked_operator(operator)
        n_pairs = matrix.shape[0] // 3
        if preload is None and normal_load is None and gap is None:
            raise InputError(
                "normal_load is missing: give it in N, or a gap in m, for the state at rest.", arguments=["normal_load"]
            )
        if preload is not None and (normal_load is not None or gap is not None):
            raise InputError(
                "preload replaces normal_load and gap; give either preload or these two.",
                arguments=["preload", "normal_load"],
            )
        law = CoulombLaw.with_preload(
            n_pairs, normal_stiffness, tangential_stiffness, friction_coefficient, 0.0 if preload is None else preload
        )
        if preload is None:
            law = replace(
                law,
                normal_load=per_pair("normal_load", 0.0 if normal_load is None else normal_load, n_pairs),
                gap=per_pair("gap", 0.0 if gap is None else gap, n_pairs),
            )
        if residual_traction is not None:
            law = replace(law, residual_traction=finite_array("residual_traction", residual_traction))
        self._set(matrix, (law,), (np.arange(n_pairs),))

    @classmethod
    def with_laws(
        cls, operator: Any, laws: Sequence[ContactLaw], members: Sequence[ArrayLike] | None = None
    ) -> ContactPairs:
        """Pairs with any laws: ``members[i]`` are the pairs with the law ``laws[i]``.

        Without ``members`` the pairs of the first law come first, then those of the second, and so on. Raises
        InputError unless each pair has exactly one law, and for a law without a member of :class:`ContactLaw`.
        """
        matrix = _checked_operator(operator)
        for law in laws:
            missing = [name for name in _MEMBERS if not hasattr(law, name)]
            if missing:
                raise InputError(
                    f"{type(law).__name__} is not a contact law: it has no {', '.join(missing)} (docs/extending.md)."
                )
        n_pairs = matrix.shape[0] // 3
        counts = [law.n_pairs for law in laws]
        if members is None:
            starts = np.cumsum([0, *counts])
            members = [np.arange(start, start + count) for start, count in zip(starts, counts, strict=False)]
        groups = tuple(np.asarray(group, dtype=np.int64) for group in members)
        together = np.sort(np.concatenate(groups)) if groups else np.empty(0)
        if [group.size for group in groups] != counts or not np.array_equal(together, np.arange(n_pairs)):
            raise InputError(
                f"the laws are for {' + '.join(map(str, counts)) or 'no'} pairs, but the operator has {n_pairs}: each "
                "pair requires exactly one law."
            )
        if len(laws) == 1 and not np.array_equal(groups[0], together):
            raise InputError("a single law has its pairs in order; sort members, or omit it.")
        pairs = cls.__new__(cls)
        pairs._set(matrix, tuple(laws), groups)
        return pairs

    def _set(self, operator: FloatArray, laws: tuple[ContactLaw, ...], members: tuple[IndexArray, ...]) -> None:
        object.__setattr__(self, "operator", operator)
        object.__setattr__(self, "laws", laws)
        object.__setattr__(self, "members", members)

    def __repr__(self) -> str:
        parts = [f"{law.n_pairs} {law.name}" for law in self.laws]
        noun = "pair" if self.n_pairs == 1 else "pairs"
        return f"ContactPairs({' + '.join(parts)} {noun} on {self.operator.shape[1]} unknowns)"

    @property
    def largest_motion(self) -> FloatArray:
        """(n_pairs, 3) m, displacements from rest up to which the laws resist; infinite for laws without such a limit
        (``largest_motion`` of a law is optional)."""
        motion = np.full((self.n_pairs, 3), np.inf)
        for law, members in zip(self.laws, self.members, strict=True):
            motion[members] = getattr(law, "largest_motion", np.inf)
        return motion

    def with_update(self, update: Update) -> ContactPairs:
        """The pairs with another return of their laws of Coulomb friction."""
        laws = tuple(law.with_update(update) if isinstance(law, FrictionLaw) else law for law in self.laws)
        return ContactPairs.with_laws(self.operator, laws, self.members)

    def with_constants(self, **constants: Any) -> ContactPairs:
        """The pairs with other constants of their Coulomb law, for example ``residual_traction``. Raises InputError."""
        return ContactPairs.with_laws(self.operator, [replace(self.coulomb, **constants)])

    def subset(self, chosen: BoolArray) -> ContactPairs:
        """The pairs of a mask (n_pairs,). Raises InputError for one that takes a part of the pairs of a law without
        friction, whose force has no linear part."""
        laws, members, place = [], [], np.cumsum(chosen) - 1
        for law, group in zip(self.laws, self.members, strict=True):
            own = chosen[group]
            if isinstance(law, FrictionLaw):
                law = law.subset(own)
            elif not own.all():
                raise InputError(
                    f'the pairs of the law "{law.name}" always move, because its force is not that of springs; give '
                    "all of them in moving.",
                    arguments=["moving"],
                )
            laws.append(law)
            members.append(place[group[own]])
        present = [each for each, group in enumerate(members) if group.size]
        return ContactPairs.with_laws(
            self.operator[np.repeat(chosen, 3)], [laws[each] for each in present], [members[each] for each in present]
        )

    @property
    def n_pairs(self) -> int:
        """Number of contact pairs."""
        return int(self.operator.shape[0] // 3)

    @property
    def law_names(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(dict.fromkeys(law.name for law in self.laws))

    @property
    def is_coulomb(self) -> bool:
        """Whether all pairs follow Coulomb's law."""
        return self.law_names == (CoulombLaw.name,)

    @property
    def state_names(self) -> dict[ContactState, str]:
        """Names of the states that the pairs can have, as their laws call them."""
        names = {
            state: dict.fromkeys(law.states[state] for law in self.laws if state in law.states)
            for state in ContactState
        }
        return {state: " or ".join(words) for state, words in names.items() if words}

    @property
    def coulomb(self) -> CoulombLaw:
        """The one Coulomb law of all pairs. Raises InputError where there are others."""
        if len(self.laws) == 1 and isinstance(self.laws[0], CoulombLaw):
            return self.laws[0]
        raise InputError(
            f"the pairs follow the law(s) {', '.join(self.law_names)}; this requires Coulomb friction in all pairs."
        )

    def collect(self, value: Callable[[ContactLaw], Any], shape: tuple[int, ...] = ()) -> FloatArray:
        """(n_pairs, *shape) a value of each pair's law; NaN where the law has none (None)."""
        return joined_values(self.laws, self.members, value, shape)

    @property
    def normal_stiffness(self) -> FloatArray:
        """(n_pairs,) N/m of Coulomb pairs, NaN for others."""
        return self.collect(lambda law: getattr(law, "normal_stiffness", None))

    @property
    def tangential_stiffness(self) -> FloatArray:
        """(n_pairs,) or (n_pairs, 2) N/m, as in the constructor. Raises InputError unless all pairs follow the Coulomb
        law."""
        return self.coulomb.tangential_stiffness

    @property
    def tangential_springs(self) -> FloatArray:
        """(n_pairs, 2) N/m along t1 and t2 of Coulomb pairs, NaN for others."""
        return self.collect(lambda law: getattr(law, "tangential_springs", None), (2,))

    @property
    def friction_coefficient(self) -> FloatArray:
        """(n_pairs,) of Coulomb pairs, NaN for others."""
        return self.collect(lambda law: getattr(law, "friction_coefficient", None))

    @property
    def normal_load(self) -> FloatArray:
        """(n_pairs,) N at rest."""
        return self.collect(lambda law: law.normal_load)

    @property
    def gap(self) -> FloatArray:
        """(n_pairs,) m at rest, 0 for a law without gap."""
        return np.nan_to_num(self.collect(lambda law: getattr(law, "gap", None)))

    @property
    def offset_force(self) -> FloatArray:
        """(n_pairs,) N, the normal force at ``n = 0`` with its sign: the load, or minus the force that closes the
        gap."""
        return self.collect(lambda law: getattr(law, "offset_force", law.normal_load))

    @property
    def preload(self) -> FloatArray:
        """(n_pairs,) N, the load at rest, or below zero minus normal stiffness times gap: :attr:`offset_force`."""
        return self.offset_force

    @property
    def largest_slip_force(self) -> FloatArray:
        """(n_pairs,) N, the largest tangential force at rest that slip can release."""
        return self.collect(lambda law: law.largest_slip_force)

    @property
    def residual_traction(self) -> FloatArray | None:
        """(n_pairs, 2) N, traction of Coulomb pairs at rest, or None."""
        return self.coulomb.residual_traction if self.law_names == ("coulomb",) else None

    @property
    def resting_traction(self) -> FloatArray:
        """(n_pairs, 2) N along t1, t2 at rest: the residual traction; zero if released."""
        return np.nan_to_num(self.collect(lambda law: getattr(law, "resting_traction", None), (2,)))

    @property
    def released(self) -> bool:
        """True if no law has a traction at rest."""
        return all(getattr(law, "released", True) for law in self.laws)

    @property
    def closed_at_rest(self) -> BoolArray:
        """(n_pairs,) True where springs act on small motions about the rest."""
        return np.asarray(self.collect(lambda law: law.resting_springs(), (3,)).any(axis=1))

    def stuck_stiffness(self) -> FloatArray:
        """(3 * n_pairs,) N/m: k_t1, k_t2, k_n of each Coulomb pair, closed and stuck; the resting springs of others."""
        return self.collect(
            lambda law: law.stuck_springs() if isinstance(law, FrictionLaw) else law.resting_springs(), (3,)
        ).ravel()

    def resting_stiffness(self) -> FloatArray:
        """(3 * n_pairs,) N/m: the springs that act on small motions about the rest; zero for a pair that is open
        there."""
        return self.collect(lambda law: law.resting_springs(), (3,)).ravel()

    def frictional(self) -> BoolArray:
        """(n_pairs, 3) True for springs that slip can release."""
        return self.collect(lambda law: law.frictional(), (3,)).astype(bool)

    def undetermined(self) -> BoolArray:
        """(n_pairs, 3) True for mean displacements that no force depends on."""
        return self.collect(lambda law: law.undetermined(), (3,)).astype(bool)

    def walking(self) -> BoolArray:
        """(n_pairs, 3) True for mean displacements that are the way of many cycles (:meth:`FrictionLaw.walking`)."""
        return self.collect(
            lambda law: law.walking() if isinstance(law, FrictionLaw) else np.zeros((law.n_pairs, 3)), (3,)
        ).astype(bool)

    def walk(self, mean: FloatArray) -> FloatArray:
        """(..., n_pairs, 3) m that a body slides on in each cycle, where the mean (..., 3 n_pairs) is that of many."""
        return np.asarray(mean.reshape(*mean.shape[:-1], -1, 3) * self.walking() / CYCLES)

    def way(self, walk: FloatArray) -> FloatArray:
        """(n_pairs, 3) m, mean relative displacements, those of many cycles, of unknowns that slide on by ``walk`` (n,)
        m in each."""
        return np.asarray(CYCLES * (self.operator @ walk).reshape(-1, 3))

    def retaining(self) -> ContactPairs:
        """The pairs with the tractions of their friction retained; those that are released have none at rest."""
        laws = tuple(law.retaining() if isinstance(law, FrictionLaw) else law for law in self.laws)
        return ContactPairs.with_laws(self.operator, laws, self.members)

    def period(self, coefficients: FloatArray, samples: int) -> LawPeriod:
        """Force over a period for coefficients (n_pairs, 3, 2H+1); see :class:`ContactLaw`."""
        return joined_period(self.laws, self.members, coefficients, samples)

    def tangent(self, coefficients: FloatArray, samples: int, select: IndexArray, period: LawPeriod) -> FloatArray:
        """Derivative (k, 3, 2H+1, 3, 2H+1) of the force of the pairs ``select``; see :class:`ContactLaw`."""
        return joined_tangent(self.laws, self.members, coefficients, samples, select, period)

    def hidden_springs(self, period: LawPeriod) -> FloatArray:
        """(n_pairs, 3) N/m that act and are not among the resting springs."""
        return joined_hidden_springs(self.laws, self.members, period)

    def cycle(self, displacement: FloatArray) -> ContactCycle:
        """The periodic state under a motion (n_samples, n_pairs, 3) m."""
        return joined_cycle(self.laws, self.members, displacement)

    def walking_cycle(self, displacement: FloatArray, walk: FloatArray | None) -> ContactCycle:
        """:meth:`cycle` of unknowns that slide on by ``walk`` (n,) m in each cycle, with its motion and sliders without
        this way; None if nothing walks."""
        if walk is None:
            return self.cycle(displacement)
        way = self.way(walk)
        cycle = self.cycle(displacement + way)
        return replace(cycle, slider=cycle.slider - way[:, :2])

    def memory_at_rest(self) -> tuple[Any, ...]:
        """The memory of each law at rest."""
        return tuple(law.memory_at_rest() for law in self.laws)

    def step(self, displacement: FloatArray, before: tuple[Any, ...]) -> LawStep:
        """The force after a step to displacements (n_pairs, 3) m; see :class:`ContactLaw`."""
        return joined_step(self.laws, self.members, displacement, before)


def _checked_operator(operator: Any) -> FloatArray:
    matrix = finite_array("operator", operator.toarray() if scipy.sparse.issparse(operator) else operator)
    if matrix.ndim != 2 or matrix.shape[0] % 3 or matrix.shape[0] == 0:
        raise InputError(
            "operator must have shape (3 * n_pairs, n): rows t1, t2, n for each pair, but its shape is "
            f"{matrix.shape}.",
            arguments=["operator"],
        )
    return matrix
