"""Numbers, lengths, energies and headings as a reader expects them."""

from __future__ import annotations

import re

import numpy as np

MICRO = 1e6  # m to µm
# Unit of a measure -> factor and unit in which it is shown.
SHOWN = {"m": (MICRO, "µm"), "Hz": (1.0, "Hz"), "Pa": (1e-6, "MPa")}
_PLAIN = (1e-3, 1e6)  # sizes of numbers without an exponent
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float | int | str, digits: int = 4) -> str:
    """A number as a reader expects it: no exponent between 0.001 and 1e6, a true minus sign."""
    if isinstance(value, str):
        return value
    if isinstance(value, int | np.integer):
        return f"{int(value)}"
    if value != 0 and not _PLAIN[0] <= abs(value) < _PLAIN[1]:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        return _power(_short(mantissa), exponent)
    decimals = digits - 1 - int(np.floor(np.log10(abs(value)))) if value else 0
    return _short(f"{value:.{max(decimals, 0)}f}")


def tile_number(value: float, digits: int = 4) -> str:
    """A number for a tile of the summary, which is narrow: two digits where it has an exponent."""
    has_exponent = value != 0.0 and not _PLAIN[0] <= abs(value) < _PLAIN[1]
    return number(value, min(digits, 2) if has_exponent else digits)


def length(value: float) -> tuple[str, str]:
    """A length in m as a number with readable digits and its unit: nm, µm or mm."""
    size = abs(value)
    factor, unit = (1e3, "mm") if size >= 1e-2 else (1e6, "µm") if size >= 1e-7 or not size else (1e9, "nm")
    return number(factor * value), unit


def energy(value: float) -> tuple[str, str]:
    """An energy in J as a number with readable digits and its unit: J, mJ, µJ or nJ."""
    factor, unit = energy_unit(abs(value))
    return tile_number(factor * value), unit


def energy_unit(largest: float) -> tuple[float, str]:
    """Factor and unit in which an energy of this size (J) has readable digits."""
    for factor, unit in ((1.0, "J"), (1e3, "mJ"), (1e6, "µJ")):
        if largest * factor >= 1.0:
            return factor, unit
    return 1e9, "nJ"


def raised(words: str) -> str:
    """Words with each "8.2e-04" in them as "8.2 × 10⁻⁴", and with true minus signs before numbers."""
    return re.sub(r"(?<![\w.])(-?\d[\d.]*)(?:e([-+]?\d+))?", lambda found: _power(*found.groups()), words)


def unit_on_page(unit: str) -> str:
    """A unit, or words with units, as a page shows them: µm, m², mm³ for um, m2, mm3."""
    return re.sub(
        r"(?:(?<=/)|(?<=\d )|^)(mm|m)([23])\b",
        lambda found: found[1] + "²³"[int(found[2]) - 2],
        re.sub(r"\bum\b", "µm", unit),
    )


def typeset(words: str) -> str:
    """A sentence of a terminal as a page shows it: µm, √kg, powers of ten, true minus signs; but values of keys, such
    as ``tolerance = 1e-9`` or ``sq = "5 um"``, as they are copied into a study file."""
    parts = re.split(r'(= "[^"]*"|= \S+)', words)
    parts[::2] = [raised(unit_on_page(part)) for part in parts[::2]]
    return "".join(parts).replace("kg^0.5", "√kg")


def capital(words: str) -> str:
    """Words with a capital at their beginning; names among them stay as they are."""
    return words[:1].upper() + words[1:]


def small(words: str) -> str:
    """Words with a small letter at their beginning; names among them stay as they are."""
    return words[:1].lower() + words[1:]


def _power(mantissa: str, exponent: str | None) -> str:
    power = "" if exponent is None else f" × 10{str(int(exponent)).translate(_RAISED)}"
    return f"{mantissa.replace('-', '−')}{power}"


def _short(digits: str) -> str:
    return (digits.rstrip("0").rstrip(".") if "." in digits else digits).replace("-", "−")
