"""The response of a structure some of whose contact pairs rest: they stick, or stay open, at every point.

The force of such a pair is that of its springs at rest. They belong to the stiffness then, and the balance has the
moving pairs alone: its size is theirs. On the mean a stuck pair with a released slider has no traction, so these
springs do not act there, and neither do they in the balance of all pairs. After the curve the law itself gives the
force of each resting pair under its motion: where that is not the force of the springs, the pair does not rest, and the
curve is no result.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import BoolArray
from stickslip.core.errors import InputError
from stickslip.results.response import ForcedResponse
from stickslip.solve.curve_structures import CurveInput, StructureBalances, curve_structure
from stickslip.solve.free_modes import free_modes
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.harmonic.operator_products import add_springs
from stickslip.solve.harmonic.support import only_friction_supports
from stickslip.solve.setting_up import Balances, CurveBalances
from stickslip.structure.superelement import Superelement, require_moving

# The curve of a structure with pairs: :func:`forced_response` with its other arguments.
CurveOf = Callable[[Superelement, ContactPairs], ForcedResponse]


@dataclass(frozen=True, repr=False)
class StructureOnSprings(Superelement):
    """A superelement whose stiffness contains the springs of resting pairs.

    ``bare`` is that without them, and ``on_mean`` that with those that act on the mean.
    """

    bare: Superelement = field(kw_only=True)
    on_mean: Superelement = field(kw_only=True)

    def mean_structure(self) -> Superelement:
        """See :class:`Superelement`."""
        return self.on_mean


def partial_response(
    superelement: Superelement, pairs: ContactPairs, moving: BoolArray, curve_of: CurveOf
) -> ForcedResponse:
    """The curve of a structure whose pairs rest but for the ``moving`` ones (n_pairs,).

    Parameters
    ----------
    superelement, pairs:
        the structure without contact, for example from :func:`partial_superelement`, and all of its pairs.
    moving:
        (n_pairs,) True for pairs that may slip, open or close.
    curve_of:
        ``curve_of(structure, joint)`` gives the curve of the structure with springs and of the moving pairs:
        :func:`forced_response` with its other arguments.

    Returns
    -------
    ForcedResponse
        with all pairs. If a pair that has to rest does not, ``converged`` is False, ``message`` gives the frequency,
        and :func:`not_resting` which pairs.

    Raises
    ------
    InputError
        for ``moving`` of another shape, without a pair, or with a part of the pairs of a law without friction.
    """
    chosen = require_moving(moving, pairs.n_pairs)
    if not chosen.any():
        raise InputError(
            "moving contains no pair, so that the response is linear. Give at least the pair that slips first.",
            arguments=["moving"],
        )
    if chosen.all():
        return curve_of(superelement, pairs)
    if only_friction_supports(superelement, pairs):
        pairs = pairs.retaining()  # as the balance of all pairs does
    resting = pairs.subset(~chosen)
    response = curve_of(_on_springs(superelement, resting), pairs.subset(chosen))
    return _whole(response, pairs, chosen, *_states(response, resting))


def not_resting(response: ForcedResponse, moving: BoolArray) -> BoolArray:
    """(n_pairs,) the pairs beside the ``moving`` ones whose force is not that of springs at some point of a
    response."""
    answer = np.zeros(response.pairs.n_pairs, dtype=bool)
    if not moving.all():
        answer[~moving] = _states(response, response.pairs.subset(~moving))[1].any(axis=0)
    return answer


def _on_springs(superelement: Superelement, resting: ContactPairs) -> StructureOnSprings:
    """The superelement with the springs of resting pairs."""
    springs = resting.resting_stiffness().reshape(-1, 3)
    whole, on_mean = (
        add_springs(superelement.stiffness.copy(), resting.operator, (springs * acting).ravel())
        for acting in (np.ones_like(springs), ~resting.undetermined())
    )
    common = {item.name: getattr(superelement, item.name) for item in fields(Superelement)}
    return StructureOnSprings(
        **{**common, "stiffness": whole}, bare=superelement, on_mean=replace(superelement, stiffness=on_mean)
    )


def _states(response: ForcedResponse, resting: ContactPairs) -> tuple[NDArray[np.int8], BoolArray]:
    """(n_points, k) states of the resting pairs, and where they do not rest."""
    state = np.zeros((response.n_points, resting.n_pairs), dtype=np.int8)
    moves = np.zeros(state.shape, dtype=bool)
    for point, displacement in enumerate(response.displacement):
        coefficients = (resting.operator @ displacement).reshape(resting.n_pairs, 3, -1)
        period = resting.period(coefficients, response.samples)
        state[point], moves[point] = period.state, period.moves.any(axis=1)
    return state, moves


def _whole(
    response: ForcedResponse, pairs: ContactPairs, chosen: BoolArray, state: NDArray[np.int8], moves: BoolArray
) -> ForcedResponse:
    """The response with the states of all pairs; springs take out no energy."""

    def filled(values: NDArray[Any], others: NDArray[Any] | float) -> NDArray[Any]:
        answer = np.zeros((response.n_points, pairs.n_pairs), dtype=values.dtype)
        answer[:, chosen], answer[:, ~chosen] = values, others
        return answer

    changes: dict[str, Any] = {"settings": {**response.settings, "pairs_that_could_move": int(chosen.sum())}}
    beyond = np.flatnonzero(moves.any(axis=1))
    if beyond.size:
        count, at = int(moves.any(axis=0).sum()), float(response.frequency_hz[beyond[0]])
        changes |= {
            "converged": False,
            "message": f"{response.message} {count} of the {int((~chosen).sum())} pairs that had to rest slip or "
            f"separate, first at {at:.6g} Hz, so that the curve is no result from there on. Add them to the moving "
            "pairs.",
        }
    for name in ("dissipated_energy", "normal_work", "closure"):
        changes[name] = filled(getattr(response, name), 0.0)
    return replace(response, pairs=pairs, contact_state=filled(response.contact_state, state), **changes)


@dataclass(frozen=True)
class PartialBalances(Balances):
    """The balances of a structure with the springs of resting pairs."""

    @cached_property
    def shown_free(self) -> LinearLimit:
        """The structure without any contact."""
        assert isinstance(self.superelement, StructureOnSprings)
        bare, root = self.superelement.bare, self.stuck.damping_root
        frequency, modes = free_modes(bare.mass, bare.stiffness)
        if root is None or bare.gyroscopic is not None:
            return LinearLimit.of_modes(frequency, modes, bare.stiffness, self.stuck.velocity_matrix)
        return LinearLimit.undamped(frequency, modes, bare.stiffness).with_damping_root(root)


@curve_structure.register(StructureOnSprings)
class _OnSprings(StructureBalances):
    """A structure with the springs of resting pairs."""

    def balances(self, given: CurveInput, on_stage: Callable[[str], None]) -> CurveBalances:
        whole = super().balances(given, on_stage)
        assert isinstance(whole, Balances)
        return PartialBalances(**{item.name: getattr(whole, item.name) for item in fields(Balances)})
