"""Stiffness laws by name: those of this package, registered ones, and those of other packages.

Another package offers a law through an entry point of the group ``stickslip.stiffness_laws``.
"""

from __future__ import annotations

from collections.abc import Callable

from stickslip.contact.stiffness.constant_law import ConstantStiffness
from stickslip.contact.stiffness.fractal_law import FractalStiffness
from stickslip.contact.stiffness.measured_law import MeasuredStiffness
from stickslip.contact.stiffness.stiffness_law import StiffnessLaw
from stickslip.core.registry import Registry

_LAWS: Registry[StiffnessLaw] = Registry(
    "stiffness law",
    "stickslip.stiffness_laws",
    {"constant": ConstantStiffness, "fractal": FractalStiffness, "measured": MeasuredStiffness},
)

stiffness_law_names = _LAWS.names
stiffness_law = _LAWS.find


def register_stiffness_law(name: str, law: Callable[..., StiffnessLaw]) -> None:
    """Register a stiffness law in this process, so that study files can name it: ``stiffness_law = "name"``.

    ``law(**constants)`` creates the law of a face; usually it is the class (docs/extending.md). A package that is
    installed uses an entry point of the group ``stickslip.stiffness_laws`` instead. Raises InputError for the name of
    another law.
    """
    _LAWS.register(name, law)
