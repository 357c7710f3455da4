"""Checks of arrays and numbers that several modules share; each raises InputError."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import isfinite
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike, NDArray

from stickslip.core.errors import InputError

FloatArray = NDArray[np.float64]

BAND = 128  # chosen: rows of a matrix at a time, which are few megabytes of a large one


def set_fields(instance: object, **values: Any) -> None:
    """Set fields of a frozen dataclass whose constructor is written out, because it accepts more than a field contains:
    numbers and lists for arrays."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)


def argument_error(name: str, sentence: str) -> InputError:
    """The error about the argument ``name``. Callers may name an entry of it, "outputs[0]", or use words instead, which
    are no argument's name."""
    argument = name.partition("[")[0]
    return InputError(sentence, arguments=[argument] if argument.isidentifier() else [])


def real_number(name: str, value: Any) -> float:
    """``value`` as a float. Raises InputError unless it is one finite number."""
    try:
        if isinstance(value, (str, bytes, bool)):
            raise TypeError("text and truth values are not numbers here, even where float() would read them")
        number = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise argument_error(name, f"{name} is {value!r}, but it must be one number, without a unit.") from error
    if not isfinite(number):
        raise argument_error(name, f"{name} is {number:g}, but it must be a finite number.")
    return number


def positive_number(name: str, value: Any, unit: str = "") -> float:
    """``value`` as a float. Raises InputError, with the ``unit``, unless it is one finite number above 0."""
    number = real_number(name, value)
    require_allowed(name, number, number > 0, f"above 0 {unit}".rstrip())
    return number


def whole_number(name: str, value: Any, at_least: int) -> int:
    """``value`` as an int. Raises InputError unless it is a whole number, not below ``at_least``."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < at_least:
        raise argument_error(name, f"{name} is {value!r}, but it must be a whole number of at least {at_least}.")
    return int(value)


def require_allowed(name: str, value: float, is_allowed: bool, allowed: str) -> None:
    """Raise InputError unless ``is_allowed``; the message gives the ``allowed`` values, such as "between 0 and 1"."""
    if not is_allowed:
        raise argument_error(name, f"{name} is {value:g}, but it must be {allowed}.")


def require_choice(name: str, value: str, allowed: Iterable[str]) -> None:
    """Raise InputError unless ``value`` is one of the ``allowed`` names."""
    if value not in (names := tuple(allowed)):
        raise argument_error(name, f"{name} is {value!r}, but it must be one of: {', '.join(names)}.")


def finite_array(name: str, value: ArrayLike) -> FloatArray:
    """Return ``value`` as a float array after checking that every entry is a finite number.

    Raises InputError that names the array and the first bad entry.
    """
    if np.iscomplexobj(value):
        raise argument_error(
            name,
            f"{name} must contain real numbers, but it is complex. Give structural damping as a viscous matrix.",
        )
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise argument_error(name, f"{name} must contain real numbers, but the conversion fails: {error}.") from error
    finite = np.isfinite(array)
    if not finite.all():
        bad = np.argwhere(~finite)  # a single number has no index, so bad has no columns
        where = f"[{', '.join(str(i) for i in bad[0])}]" if array.ndim else ""
        entry = array[tuple(bad[0])]
        raise argument_error(
            name,
            f"{name}{where} is {entry}; each entry must be a finite number ({len(bad)} of {array.size} are not). "
            "Look for a division by zero or an empty cell in the source of the array.",
        )
    return array


def symmetric_matrix(name: str, value: Any, tolerance: float = 1e-8) -> FloatArray:
    """Return ``value`` as a dense, square, symmetric float matrix (n, n) of its own; raises InputError otherwise."""
    return _with_symmetry(name, value, tolerance, 1.0)


def skew_matrix(name: str, value: Any, tolerance: float = 1e-8) -> FloatArray:
    """Return ``value`` as a dense, square, skew-symmetric float matrix (n, n); raises InputError otherwise."""
    return _with_symmetry(name, value, tolerance, -1.0)


def _with_symmetry(name: str, value: Any, tolerance: float, sign: float) -> FloatArray:
    """A matrix (n, n) that equals ``sign`` times its transpose, without the round-off that differs from it."""
    dense = value.toarray() if scipy.sparse.issparse(value) else value
    matrix = finite_array(name, dense)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise argument_error(name, f"{name} must be a square matrix, but its shape is {matrix.shape}.")
    largest, asymmetry = 0.0, 0.0
    for part, mirrored in _bands(matrix):  # a large matrix has no room for a second one
        largest = max(largest, float(np.abs(part).max(initial=0.0)))
        asymmetry = max(asymmetry, float(np.abs(part - sign * mirrored).max(initial=0.0)))
    if asymmetry > tolerance * largest:
        i, j = np.unravel_index(int(np.abs(matrix - sign * matrix.T).argmax()), matrix.shape)
        words, operation, other = ("symmetric", "+", "") if sign > 0.0 else ("skew-symmetric", "-", "minus ")
        raise argument_error(
            name,
            f"{name} must be {words}, but entry [{i}, {j}] = {matrix[i, j]:.6g} and {other}entry [{j}, {i}] = "
            f"{sign * matrix[j, i]:.6g} "
            f"differ by {asymmetry / largest:.1e} of the largest entry (allowed: {tolerance:.0e}). "
            f"If the difference is round-off, pass 0.5 * ({name} {operation} {name}.T).",
        )
    if asymmetry == 0.0:  # a caller may change an array of its own afterwards
        shared = not scipy.sparse.issparse(value) and np.may_share_memory(matrix, np.asarray(value))
        return matrix.copy() if shared else matrix
    answer = np.empty(matrix.shape)
    for (part, mirrored), (target, _) in zip(_bands(matrix), _bands(answer), strict=True):
        target[...] = 0.5 * (part + sign * mirrored)
    return answer


def _bands(matrix: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Some rows of a square matrix at a time, and the same rows of its transpose."""
    for start in range(0, len(matrix), BAND):
        yield matrix[start : start + BAND], matrix[:, start : start + BAND].T


def per_pair(name: str, value: ArrayLike, n_pairs: int) -> FloatArray:
    """Return ``value`` as an array (n_pairs,); a single number applies to all pairs. Raises InputError otherwise."""
    array = finite_array(name, value)
    if array.ndim == 0:
        return np.full(n_pairs, float(array))
    if array.shape != (n_pairs,):
        raise argument_error(
            name,
            f"{name} must be one number or an array of shape ({n_pairs},), one entry for each pair, "
            f"but its shape is {array.shape}.",
        )
    return array.copy()


def require_positive(name: str, array: FloatArray, advice: str) -> None:
    """Raise InputError unless every entry of ``array`` is above zero; the message ends with ``advice``."""
    bad = np.flatnonzero(~(array > 0))
    if bad.size:
        where = f"[{bad[0]}]" if array.ndim else ""
        raise argument_error(
            name,
            f"{name}{where} is {array.flat[bad[0]]:g}, but it must be above 0 ({bad.size} of {array.size} entries are "
            f"not). {advice}",
        )
