"""Consistent systems of units for the plain numbers of a model file."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.core.errors import InputError, concerning
from stickslip.core.validation import require_choice

LENGTH_UNITS = {"m": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}  # m


@dataclass(frozen=True)
class UnitSystem:
    """Units of length (m), mass (kg) and time (s) from which all others of a file follow."""

    name: str
    length_unit: str
    mass: float
    time: float

    @property
    def length(self) -> float:
        """m in one unit of length."""
        return LENGTH_UNITS[self.length_unit]

    @property
    def density(self) -> float:
        """kg/m3 in one unit of density."""
        return self.mass / self.length**3

    @property
    def pressure(self) -> float:
        """Pa in one unit of Young's modulus."""
        return self.mass / (self.length * self.time**2)

    @property
    def force(self) -> float:
        """N in one unit of force."""
        return self.mass * self.length / self.time**2


_POUND_FORCE = 4.4482216152605  # N
UNIT_SYSTEMS = {
    system.name: system
    for system in (
        UnitSystem("SI", "m", 1.0, 1.0),
        UnitSystem("mm-t-s", "mm", 1e3, 1.0),  # N, MPa, t/mm3
        UnitSystem("mm-kg-ms", "mm", 1.0, 1e-3),  # kN, GPa, kg/mm3
        UnitSystem("mm-kg-s", "mm", 1.0, 1.0),  # mN, kPa, kg/mm3
        UnitSystem("cm-N-s", "cm", 1e2, 1.0),  # N, N/cm2
        UnitSystem("dm-N-s", "dm", 1e1, 1.0),
        UnitSystem("um-N-s", "um", 1e6, 1.0),
        UnitSystem("in-lbf-s", "in", _POUND_FORCE / 0.0254, 1.0),  # lbf, psi, lbf s2/in4
        UnitSystem("ft-lbf-s", "ft", _POUND_FORCE / 0.3048, 1.0),  # lbf, lbf/ft2, slug/ft3
    )
}
# Defaults: N and s with metric lengths, lbf and s with inches and feet.
USUAL_SYSTEM = {
    unit: next(
        name for name, system in UNIT_SYSTEMS.items() if system.length_unit == unit and not name.startswith("mm-kg")
    )
    for unit in LENGTH_UNITS
}


def find_unit_system(length_unit: str, unit_system: str | None = None) -> UnitSystem:
    """The system of a file whose lengths are in ``length_unit``: ``unit_system``, or the usual one of that unit.

    Raises InputError for an unknown unit or system, and for a system with another length.
    """
    with concerning("length_unit"):
        require_choice("length_unit", length_unit, LENGTH_UNITS)
    if unit_system is None:
        return UNIT_SYSTEMS[USUAL_SYSTEM[length_unit]]
    with concerning("unit_system"):
        require_choice("unit_system", unit_system, UNIT_SYSTEMS)
    system = UNIT_SYSTEMS[unit_system]
    if system.length_unit != length_unit:
        fitting = ", ".join(name for name, each in UNIT_SYSTEMS.items() if each.length_unit == length_unit)
        raise InputError(
            f"unit_system {unit_system!r} has lengths in {system.length_unit}, but length_unit is {length_unit!r}. "
            f"Systems with {length_unit}: {fitting}.",
            ("unit_system", "length_unit"),
        )
    return system
