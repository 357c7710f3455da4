"""Contact laws by name: those of this package, registered ones, and those of other packages.

Another package offers a law through an entry point of the group ``stickslip.contact_laws``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from importlib.metadata import entry_points
from typing import Any

from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.cubic_spring import CubicSpring
from stickslip.contact.law.elastic_stop import ElasticStop
from stickslip.contact.law.iwan import IwanJoint
from stickslip.contact.law.jenkins import JenkinsElement
from stickslip.contact.law.law import ContactLaw
from stickslip.core.errors import InputError

ENTRY_POINTS = "stickslip.contact_laws"

_registered: dict[str, Callable[..., ContactLaw]] = {
    law.name: law for law in (CoulombLaw, CubicSpring, ElasticStop, IwanJoint, JenkinsElement)
}


def register_contact_law(name: str, law: Callable[..., ContactLaw]) -> None:
    """Make a law known under a name: what ``law(**constants)`` returns is a :class:`ContactLaw`.

    Raises InputError for a name that another law has.
    """
    if _registered.get(name, law) is not law:
        raise InputError(f'there is a contact law "{name}" already; register the new one under another name.')
    _registered[name] = law


def contact_law_names() -> tuple[str, ...]:
    """Names of all laws: of this package, registered, and of installed packages."""
    return tuple(sorted({*_registered, *(point.name for point in entry_points(group=ENTRY_POINTS))}))


def contact_law(name: str) -> Callable[..., ContactLaw]:
    """The law of a name. Raises InputError for a name that no law has."""
    if name in _registered:
        return _registered[name]
    points = entry_points(group=ENTRY_POINTS, name=name)
    if not points:
        raise InputError(f'there is no contact law "{name}"; there are: {", ".join(contact_law_names())}.')
    register_contact_law(name, next(iter(points)).load())
    return _registered[name]


def law_constants(law: ContactLaw) -> dict[str, Any]:
    """The constants of a law by name, as ``contact_law(law.name)`` takes them."""
    return {field.name: getattr(law, field.name) for field in fields(law)}  # type: ignore[arg-type]
