"""Contact laws by name: those of this package, registered ones, and those of other packages.

Another package offers a law through an entry point of the group ``stickslip.contact_laws``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.cubic_spring import CubicSpring
from stickslip.contact.law.elastic_stop import ElasticStop
from stickslip.contact.law.exponential import ExponentialContact
from stickslip.contact.law.iwan import IwanJoint
from stickslip.contact.law.jenkins import JenkinsElement
from stickslip.contact.law.law import ContactLaw
from stickslip.core.registry import Registry

_OWN = {law.name: law for law in (CoulombLaw, CubicSpring, ElasticStop, ExponentialContact, IwanJoint, JenkinsElement)}
_LAWS: Registry[ContactLaw] = Registry("contact law", "stickslip.contact_laws", _OWN)

contact_law_names = _LAWS.names
contact_law = _LAWS.find


def register_contact_law(name: str, law: Callable[..., ContactLaw]) -> None:
    """Register a contact law in this process, so that study files can name it: ``law = "name"`` on an interface.

    ``law(**constants)`` creates the law of a group of pairs; usually it is the class (docs/extending.md). A package
    that is installed uses an entry point of the group ``stickslip.contact_laws`` instead. Raises InputError for the
    name of another law.
    """
    _LAWS.register(name, law)


def law_constants(law: ContactLaw) -> dict[str, Any]:
    """The constants of a law by name, as ``contact_law(law.name)`` accepts them."""
    return {field.name: getattr(law, field.name) for field in fields(law)}  # type: ignore[arg-type]
