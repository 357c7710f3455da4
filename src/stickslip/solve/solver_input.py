"""The input of an analysis for one value of a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import Excitation
from stickslip.structure.superelement import Superelement


@dataclass(frozen=True)
class SolverInput:
    """The input of an analysis for one value of a parameter.

    Attributes
    ----------
    superelement, pairs, excitation, modal_damping_ratio:
        as in :func:`forced_response`.
    output:
        (n,) row of the output.
    structure:
        None, or a structure whose full matrices ``stiffness`` and ``mass`` replace those of the superelement: they act
        through the reduction of the superelement, whose basis does not change with the parameter.
    rayleigh:
        with a structure: its damping is these factors (1/s, s) times its mass and its stiffness.
    """

    superelement: Superelement
    pairs: ContactPairs
    excitation: Excitation
    output: FloatArray
    modal_damping_ratio: float | None = None
    structure: Any = None
    rayleigh: tuple[float, float] = (0.0, 0.0)

    __repr__ = short_repr
