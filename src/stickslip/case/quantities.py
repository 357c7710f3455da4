"""The values of study files: quantities with their limits, directions, names of files.

Values with a unit are texts ("145 mm"), plain numbers are SI; after loading everything is SI floats.
"""

from __future__ import annotations

from pathlib import PurePath
from typing import Annotated, Any
from unicodedata import category

from pydantic import AfterValidator, Field, PlainValidator

from stickslip.core.errors import InputError
from stickslip.core.units import LARGEST_FORCE, LARGEST_STIFFNESS, Count, Quantity

_CONTROLS = ("Cc", "Cs", "Zl", "Zp")  # controls, halves of characters, separators of lines and paragraphs
# Limits are wide on purpose: from micromachined parts (micrometres, micrograms) to the largest turbines. Values outside
# are typing errors or in a wrong unit. ``usual`` is narrower, and leads to a warning only. A part of a blade above 3 m
# is a number in millimetres without its unit; 1 nm is below what any process makes.
Length = Annotated[float, Quantity("length", shown="mm", at_least=1e-9, at_most=3.0)]
# Distances and places in a mesh or in matrices: as large as a ship, with room for those who write "far away".
Distance = Annotated[float, Quantity("length", shown="mm", at_least=1e-12, at_most=1e6)]
Coordinate = Annotated[float, Quantity("length", shown="mm", at_least=-1e6, at_most=1e6)]
# Dampers of micromachined parts have micrograms, those of hydraulic turbines kilograms.
Mass = Annotated[float, Quantity("mass", shown="g", at_least=1e-12, at_most=1e6, usual=(1e-9, 1e3))]
Force = Annotated[float, Quantity("force", at_least=1e-15, at_most=LARGEST_FORCE, usual=(1e-6, 1e8), example='"500 N"')]
ForceOrNone = Annotated[float, Quantity("force", at_least=0.0, at_most=LARGEST_FORCE)]
PairForce = Annotated[float, Quantity("force", at_least=-LARGEST_FORCE, at_most=LARGEST_FORCE)]
# Atomic force microscopes have springs of 1e-2 N/m; 1 m2 of ground steel faces under load reaches 1e14 N/m.
Stiffness = Annotated[
    float,
    Quantity("stiffness", at_least=1e-6, at_most=LARGEST_STIFFNESS, usual=(1e-1, 1e14), example='"1.3e8 N/m"'),
]
# Buildings sway at 0.1 Hz, micromechanical resonators reach 1e9 Hz.
Frequency = Annotated[float, Quantity("frequency", at_least=1e-6, at_most=1e12, usual=(1e-2, 1e9))]
# Gels have 1 kPa, diamond 1.2 TPa (Callister, Materials Science and Engineering); more acts as a rigid body.
YoungModulus = Annotated[float, Quantity("pressure", shown="GPa", at_least=1e3, at_most=1e16)]
# Foams endure 10 kPa, whiskers 20 GPa.
Strength = Annotated[
    float, Quantity("pressure", shown="MPa", at_least=1e3, at_most=1e12, usual=(1e4, 1e11), example='"450 MPa"')
]
FatigueLimit = Annotated[
    Strength | None,
    Field(description="alternating stress endured without mean stress, for the Goodman check", examples=["450 MPa"]),
]
TensileStrength = Annotated[
    Strength | None, Field(description="ultimate strength, for the Goodman check", examples=["1000 MPa"])
]
# Aerogels have 1 kg/m^3, osmium 22,590 kg/m^3; less acts as a body without mass, more as a lumped one.
Density = Annotated[float, Quantity("density", at_least=1e-6, at_most=1e9)]
PoissonRatio = Annotated[float, Quantity("pure number", at_least=0.0, below=0.5)]
# Rubber on dry glass reaches 3 or 4, clean metals in vacuum more; 1e-9 is practically no friction.
FrictionCoefficient = Annotated[float, Quantity("pure number", at_least=1e-9, at_most=10.0)]
# Turbochargers turn at 3e4 rad/s, dental drills at 5e4, micro spindles at 1e5.
RotationSpeed = Annotated[
    float, Quantity("speed of rotation", shown="rpm", at_least=0.0, at_most=1e9, usual=(0.0, 1e6))
]
Area = Annotated[float, Quantity("area", shown="mm^2", at_least=1e-18, at_most=1e6)]
# Fraction of a window or of a response; below 1e-12 round-off decides.
Step = Annotated[float, Quantity("pure number", at_least=1e-12, at_most=1.0)]
Elements = Annotated[int, Count(at_least=1, at_most=1000)]


def _unit_vector(value: object) -> tuple[float, float, float]:
    """``value`` scaled to length 1. Raises InputError unless it is three finite numbers, not all zero."""
    number = Quantity("pure number", at_least=-1e100, at_most=1e100)  # squares of larger numbers are infinite
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise InputError("must be three numbers [x, y, z], for example [1.0, 0.0, 0.0].")
    x, y, z = (number.parse(entry) for entry in value)
    length = (x * x + y * y + z * z) ** 0.5
    if not length > 0:
        raise InputError("has length zero; a direction is for example [1.0, 0.0, 0.0].")
    if abs(length - 1.0) < 1e-12:  # a stored direction is read back to the last digit
        return (x, y, z)
    return (x / length, y / length, z / length)


Direction = Annotated[tuple[float, float, float], PlainValidator(_unit_vector)]


def require_printable(value: Any) -> Any:
    """``value``, unless it is or contains a text with a character that no file, page or terminal can show."""
    if isinstance(value, list | tuple):
        for entry in value:
            require_printable(entry)
    odd = next((letter for letter in value if category(letter) in _CONTROLS), "") if isinstance(value, str) else ""
    if odd:
        raise InputError(
            f"contains the control character U+{ord(odd):04X}, but a text is one line of printable characters. "
            "Remove it."
        )
    return value


def _file_name(value: str) -> str:
    """``value``. Raises InputError for a name that is too long for any disk."""
    longest = max(map(len, PurePath(value).parts), default=0)
    if longest > 255 or len(value) > 4000:  # what file systems of Linux, macOS and Windows take
        raise InputError(f"is not a file name: it has {len(value)} characters, and one part of it has {longest}.")
    return value


FileName = Annotated[str, AfterValidator(_file_name)]
