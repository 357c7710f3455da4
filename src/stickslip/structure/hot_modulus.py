"""Young's modulus of a hot material from a table of numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.validation import argument_error, finite_array, real_number, require_allowed


def modulus_at(temperature_c: float, table: ArrayLike) -> float:
    """Young's modulus in Pa at a temperature in degrees Celsius, straight between the rows of a ``table``.

    ``table`` (n, 2) has a row (degrees Celsius, Pa) for each measurement, in rising order of temperature. The modulus
    of each isotropic body is one number: ``dataclasses.replace(material, young_modulus=modulus_at(550.0, table))``.

    Raises InputError for a table of another shape or order, moduli that are not above 0, and a temperature outside of
    it, because the modulus of a metal falls faster and faster there.
    """
    rows = finite_array("table", table)
    if rows.ndim != 2 or rows.shape[1:] != (2,) or len(rows) < 2 or (np.diff(rows[:, 0]) <= 0.0).any():
        raise argument_error(
            "table",
            "table must have two or more rows (degrees Celsius, Pa) in rising order of temperature, such as [(20.0, "
            f"205e9), (600.0, 160e9)]; its shape is {rows.shape}.",
        )
    if (rows[:, 1] <= 0.0).any():
        raise argument_error("table", f"table has the modulus {rows[:, 1].min():g} Pa; each must be above 0.")
    temperature = real_number("temperature_c", temperature_c)
    low, high = rows[0, 0], rows[-1, 0]
    require_allowed("temperature_c", temperature, low <= temperature <= high, f"within the table, {low:g} to {high:g}")
    return float(np.interp(temperature, rows[:, 0], rows[:, 1]))
