"""Parameters of a model by which a peak can be differentiated."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, cast

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.solve.excitation import Excitation
from stickslip.solve.solver_input import SolverInput

# Relative step of a parameter: differences of matrices and forces have an error of about 1e-8 by this step, and 1e-11
# by round-off.
STEP = 1e-4


@dataclass(frozen=True)
class Parameter:
    """A parameter of a model.

    name, unit:
        for results.
    value:
        its value, in that unit.
    change:
        gives the input of the solver for another value.
    step:
        change of the value for differences to both sides; None for 1e-4 of the value.
    """

    name: str
    unit: str
    value: float
    change: Callable[[float], SolverInput]
    step: float


def factor(name: str, change: Callable[[float], SolverInput]) -> Parameter:
    """A factor of a quantity, 1 at present."""
    return Parameter(f"factor of {name}", "1", 1.0, change, STEP)


def parameters_of(base: SolverInput) -> tuple[Parameter, ...]:
    """Factors of each excitation, of the constants of each contact law, and the damping."""
    return (*_of_excitation(base), *_of_pairs(base), *_of_damping(base))


def _of_excitation(base: SolverInput) -> Iterator[Parameter]:
    parts = base.excitation.parts
    for place, part in enumerate(parts):

        def change(value: float, place: int = place) -> SolverInput:
            changed = [each.times(value) if at == place else each for at, each in enumerate(parts)]
            return replace(base, excitation=Excitation(tuple(changed)))

        yield factor(part.words, change)


def _of_pairs(base: SolverInput) -> Iterator[Parameter]:
    pairs = base.pairs
    for group, law in enumerate(pairs.laws):
        for item in fields(cast("Any", law)):
            values = getattr(law, item.name)
            if not isinstance(values, np.ndarray) or values.dtype != float or not values.any():
                continue

            def change(value: float, group: int = group, name: str = item.name) -> SolverInput:
                changed = [
                    replace(cast("Any", each), **{name: value * getattr(each, name)}) if at == group else each
                    for at, each in enumerate(pairs.laws)
                ]
                return replace(base, pairs=ContactPairs.with_laws(pairs.operator, changed, pairs.members))

            words = item.name.replace("_", " ")
            yield factor(words if len(pairs.laws) == 1 else f"{words}, law {group + 1} ({law.name})", change)


def _of_damping(base: SolverInput) -> Iterator[Parameter]:
    if base.modal_damping_ratio:
        ratio = base.modal_damping_ratio
        yield Parameter(
            "modal damping ratio", "1", ratio, lambda value: replace(base, modal_damping_ratio=value), STEP * ratio
        )
    damping = base.superelement.damping
    if damping is not None and damping.any():
        yield factor(
            "damping matrix",
            lambda value: replace(base, superelement=replace(base.superelement, damping=value * damping)),
        )
