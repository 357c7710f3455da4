"""Which interfaces of a study have a stiffness or a law that follows from their pressure or normal load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stickslip.case.law_keys import StiffnessLawKeys
from stickslip.contact.constants import NORMAL_LOAD

if TYPE_CHECKING:
    from stickslip.case.interface_sections import InterfaceSection


class PressedInterfaces:
    """Part of a case with ``interfaces``, ``contact_stiffness`` and ``roughness``."""

    if TYPE_CHECKING:  # the case declares them as fields
        interfaces: Mapping[str, InterfaceSection]
        contact_stiffness: Any
        roughness: Any

    @property
    def rough_interfaces(self) -> tuple[str, ...]:
        """Names of the interfaces whose stiffness follows from [roughness]."""
        if self.contact_stiffness is not None:
            return ()
        return tuple(
            name for name, each in self.interfaces.items() if each.needs_stiffness and not each.has_own_stiffness
        )

    @property
    def has_rough_faces(self) -> bool:
        """Whether the stiffness of any face follows from [roughness]."""
        return self.roughness is not None and bool(self.rough_interfaces)

    @property
    def pressed_interfaces(self) -> tuple[str, ...]:
        """Names of the interfaces whose stiffness follows a law over the pressure, rough ones among them."""
        common = isinstance(self.contact_stiffness, StiffnessLawKeys)
        return tuple(
            name
            for name, each in self.interfaces.items()
            if (each.needs_stiffness and (each.stiffness_law is not None or (common and not each.has_own_stiffness)))
            or name in self.rough_interfaces
        )

    def uses_load(self, name: str) -> bool:
        """Whether the law or the stiffness of an interface follows from a normal load."""
        each = self.interfaces[name]
        return NORMAL_LOAD in each.declaration.of_joint or name in self.pressed_interfaces
