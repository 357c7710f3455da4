"""The contact laws of this package, registered when a law is looked for by name."""

from __future__ import annotations

from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.law import register_contact_law


def register_all() -> None:
    """Register them; again does nothing."""
    for law in (CoulombLaw,):
        register_contact_law(law.name, law)
