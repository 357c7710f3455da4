"""Curves beside the curve of a response: same structure, same excitation, and one thing that differs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, whole_number
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.results.sweeps_of_curve import stable_between_folds
from stickslip.results.variables import (
    Coefficients,
    Flags,
    Json,
    Labelled,
    Numbers,
    WholeNumbers,
    require_shape,
    stored,
)

_POINT = ("side_point",)


@dataclass(frozen=True)
class SideCurve:
    """One of the curves, for one output.

    Attributes
    ----------
    name:
        what it is.
    frequency_hz:
        (k,) Hz, in the order of the curve.
    amplitude:
        (k,) 0-to-peak of the output, mean included, or that of one harmonic.
    stable:
        (k,) False where it runs backward between two folds.
    complete:
        whether it reaches the end that it was followed to.
    """

    name: str
    frequency_hz: FloatArray
    amplitude: FloatArray
    stable: NDArray[np.bool_]
    complete: bool


@dataclass(frozen=True, eq=False)
class SideCurves(Labelled):
    """Curves one after the other: each has a number, and its points follow each other.

    Parameters
    ----------
    names:
        (n_curves,) what each curve is.
    complete:
        (n_curves,) whether it reaches the end that it was followed to.
    curve:
        (n_side_points,) number of the curve of a point, rising.
    frequency_hz:
        (n_side_points,) Hz.
    displacement:
        (n_side_points, n, 2 * harmonics + 1) m, coefficients mean, cos 1, sin 1, ...

    Raises
    ------
    InputError
        for an array of the wrong shape, or a curve without a point.
    """

    names: tuple[str, ...] = field(metadata=stored(Json(list[str], "what each curve is, JSON list")))
    complete: NDArray[np.bool_] = field(
        metadata=stored(Flags(("side_curve",), "1", "1 if the curve reaches the end that it was followed to"))
    )
    curve: NDArray[np.int64] = field(metadata=stored(WholeNumbers(_POINT, "1", "number of the curve of a point")))
    frequency_hz: FloatArray = field(metadata=stored(Numbers(_POINT, "Hz", "excitation frequency", name="frequency")))
    displacement: FloatArray = field(
        metadata=stored(Coefficients(("side_point", "unknown"), "m", "displacement", "side_harmonic"))
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        shape = np.shape(self.displacement)
        if len(shape) != 3 or not shape[2] % 2:
            raise InputError(
                f"displacement must have shape (n_side_points, n, 2 * harmonics + 1), but its shape is {shape}.",
                arguments=["displacement"],
            )
        self._require_sizes(self._sizes(shape))
        if not np.array_equal(np.unique(self.curve), np.arange(self.n_curves)) or (np.diff(self.curve) < 0).any():
            raise InputError(
                f"curve must number the {self.n_curves} curves in their order, each with at least one point.",
                arguments=["curve"],
            )

    def _sizes(self, shape: tuple[int, ...]) -> dict[str, int]:
        return {
            "side_point": shape[0],
            "unknown": shape[1],
            "harmonic": (shape[2] - 1) // 2,
            "side_curve": len(self.names),
        }

    def _stable(self, part: NDArray[np.int64]) -> NDArray[np.bool_]:
        """(k,) which points of a curve are stable: here its folds decide."""
        return stable_between_folds(self.frequency_hz[part])

    @property
    def n_curves(self) -> int:
        """Number of curves."""
        return len(self.names)

    def of(self, number: int) -> NDArray[np.int64]:
        """(k,) the points of a curve. Raises InputError for a number that none has."""
        whole_number("number", number, 0)
        if number >= self.n_curves:
            raise InputError(
                f"number is {number}, but there are {self.n_curves} curves, numbered from 0.", arguments=["number"]
            )
        return np.flatnonzero(self.curve == number)

    def with_harmonics(self, harmonics: int) -> Self:
        """The same curves with coefficients of so many harmonics, zero in those that they lack."""
        lacking = 2 * harmonics + 1 - self.displacement.shape[2]
        return replace(self, displacement=np.pad(self.displacement, ((0, 0), (0, 0), (0, lacking))))

    def curves(self, output: ArrayLike, harmonic: int | None = None) -> tuple[SideCurve, ...]:
        """Every curve for an output (n,): its 0-to-peak amplitude, or that of a ``harmonic`` above 0.

        The unit of ``output`` sets that of the amplitudes. Raises InputError for a row of another length, or a harmonic
        that the curves do not contain.
        """
        row = finite_array("output", output)
        require_shape("output", row, (self.displacement.shape[1],))
        coefficients: FloatArray = np.einsum("pic,i->pc", self.displacement, row)
        if harmonic is None:
            amplitude = periodic_amplitude(coefficients)
        else:
            most = (coefficients.shape[1] - 1) // 2
            if whole_number("harmonic", harmonic, 1) > most:
                raise InputError(
                    f"harmonic is {harmonic}, but these curves contain harmonics 1 to {most}.", arguments=["harmonic"]
                )
            amplitude = np.hypot(coefficients[:, 2 * harmonic - 1], coefficients[:, 2 * harmonic])
        parts = [self.of(number) for number in range(self.n_curves)]
        return tuple(
            SideCurve(name, self.frequency_hz[part], amplitude[part], self._stable(part), complete)
            for name, part, complete in zip(self.names, parts, self.complete.tolist(), strict=True)
        )
