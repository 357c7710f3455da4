"""The results of the laws of groups of pairs, joined in the order of the pairs.

``members[i]`` are the pairs with the law ``laws[i]``; each pair has one law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from stickslip.contact.law.law import ContactCycle, ContactLaw, IndexArray, LawPeriod, LawStep
from stickslip.core.validation import FloatArray

Laws = Sequence[ContactLaw]
Members = Sequence[IndexArray]


class Stepping(Protocol):
    """A source of forces step by step: a law, or pairs whose whole forces count."""

    def step(self, displacement: FloatArray, before: Any) -> LawStep: ...


def joined_values(
    laws: Laws, members: Members, value: Callable[[ContactLaw], Any], shape: tuple[int, ...]
) -> FloatArray:
    """(n_pairs, *shape) a value of each pair's law; NaN where the law has none (None)."""
    values = [value(law) for law in laws]
    if len(values) == 1 and values[0] is not None:
        return np.asarray(values[0])
    result = np.full((sum(group.size for group in members), *shape), np.nan)
    for each, group in zip(values, members, strict=True):
        if each is not None:
            result[group] = each
    return result


def joined_period(laws: Laws, members: Members, coefficients: FloatArray, samples: int) -> LawPeriod:
    """Force over a period for coefficients (n_pairs, 3, 2H+1); the memory is a list with the period of each law."""
    if len(laws) == 1:
        return laws[0].period(coefficients, samples)
    parts = [law.period(coefficients[group], samples) for law, group in zip(laws, members, strict=True)]
    joined = {}
    for name in ("force", "moves", "state", "closure"):
        arrays = [getattr(part, name) for part in parts]
        joined[name] = np.empty((len(coefficients), *arrays[0].shape[1:]), dtype=arrays[0].dtype)
        for array, group in zip(arrays, members, strict=True):
            joined[name][group] = array
    return LawPeriod(**joined, memory=parts)


def joined_tangent(
    laws: Laws, members: Members, coefficients: FloatArray, samples: int, select: IndexArray, period: LawPeriod
) -> FloatArray:
    """Derivative (k, 3, 2H+1, 3, 2H+1) of the force of the pairs ``select``, after :func:`joined_period`."""
    if len(laws) == 1:
        return laws[0].tangent(coefficients, samples, select, period)
    width = coefficients.shape[2]
    result = np.empty((select.size, 3, width, 3, width))
    for law, group, part in zip(laws, members, period.memory, strict=True):
        chosen = np.flatnonzero(np.isin(select, group))
        if chosen.size:
            order = np.argsort(group)
            inside = order[np.searchsorted(group, select[chosen], sorter=order)]
            result[chosen] = law.tangent(coefficients[group], samples, inside, part)
    return result


def joined_hidden_springs(laws: Laws, members: Members, period: LawPeriod) -> FloatArray:
    """(n_pairs, 3) N/m that act and are not among the resting springs, after :func:`joined_period`."""
    if len(laws) == 1:
        return laws[0].hidden_springs(period)
    result = np.empty((len(period.state), 3))
    for law, group, part in zip(laws, members, period.memory, strict=True):
        result[group] = law.hidden_springs(part)
    return result


def joined_cycle(laws: Laws, members: Members, displacement: FloatArray) -> ContactCycle:
    """The periodic state under a motion (n_samples, n_pairs, 3) m."""
    if len(laws) == 1:
        return laws[0].cycle(displacement)
    parts = [law.cycle(displacement[:, group]) for law, group in zip(laws, members, strict=True)]
    order = np.argsort(np.concatenate(members))
    joined = {}
    for name, axis in (("force", 1), ("slider", 1), ("state", 0), ("dissipated_energy", 0), ("closure", 0)):
        together = np.concatenate([getattr(part, name) for part in parts], axis=axis)
        joined[name] = np.take(together, order, axis=axis)
    return ContactCycle(**joined)


def joined_step(laws: Sequence[Stepping], members: Members, displacement: FloatArray, before: Sequence[Any]) -> LawStep:
    """A step to displacements (n_pairs, 3) m; the memory is a tuple with that of each law."""
    if len(laws) == 1:
        step = laws[0].step(displacement, before[0])
        return replace(step, memory=(step.memory,))
    n_pairs, memories = len(displacement), []
    force, derivative, state = np.empty((n_pairs, 3)), np.empty((n_pairs, 3, 3)), np.empty(n_pairs, dtype=np.int8)
    for law, group, memory in zip(laws, members, before, strict=True):
        step = law.step(displacement[group], memory)
        force[group], derivative[group], state[group] = step.force, step.derivative, step.state
        memories.append(step.memory)
    return LawStep(force, derivative, state, tuple(memories))
