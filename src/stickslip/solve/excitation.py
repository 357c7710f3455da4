"""Excitations of a structure: harmonic forces, motion of its base, rotating unbalance, and sums of them.

Every excitation is a force whose Fourier coefficients are a polynomial in the circular frequency,
``p_h(w) = sum_k w^k c_hk``: constant for a force and for a base acceleration, ``w^2`` for an unbalance and for a base
displacement.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.fourier import with_rows
from stickslip.core.validation import (
    FloatArray,
    argument_error,
    finite_array,
    positive_number,
    require_choice,
    whole_number,
)
from stickslip.structure.cyclic_sector import Direction

BaseMotion = Literal["acceleration", "displacement"]


class Unknowns(Protocol):
    """The unknowns that a force acts on: those of a superelement, or all displacements of a mesh."""

    @property
    def size(self) -> int:
        """Number n of unknowns."""

    @property
    def mass(self) -> FloatArray:
        """(n, n) kg."""


@dataclass(frozen=True, eq=False)
class _Part:
    """One term ``w^power (cos cos(h w t) + sin sin(h w t))``, each (n, n_harmonics); ``inertial``: times minus M."""

    power: int
    cos: FloatArray
    sin: FloatArray
    inertial: bool
    words: str

    def times(self, factor: float) -> _Part:
        """The term with another size."""
        return replace(self, cos=factor * self.cos, sin=factor * self.sin)


@dataclass(frozen=True, eq=False)
class ExcitationForce:
    """The force of an excitation on a structure, as a polynomial in the circular frequency.

    ``terms`` are pairs of a power k and coefficients (2H+1, n) in N s^k, in the order mean, cos 1, sin 1, ...; the mean
    is zero: constant forces are part of the state at rest.
    """

    terms: tuple[tuple[int, FloatArray], ...]

    @property
    def harmonics(self) -> int:
        """Number H of harmonics."""
        return int(self.terms[0][1].shape[0] - 1) // 2

    @property
    def is_constant(self) -> bool:
        """Whether the force is the same at all frequencies."""
        return all(power == 0 for power, _ in self.terms)

    def coefficients(self, omega: float) -> FloatArray:
        """(2H+1, n) N at the circular frequency ``omega`` in rad/s."""
        return np.asarray(sum(omega**power * array for power, array in self.terms))

    def slope(self, omega: float) -> FloatArray:
        """(2H+1, n) N s, derivative of :meth:`coefficients` by ``omega``."""
        return np.asarray(sum(power * omega ** max(power - 1, 0) * array for power, array in self.terms))

    def with_harmonics(self, harmonics: int) -> ExcitationForce:
        """The same force with fewer harmonics, or with more that are zero."""

        return ExcitationForce(tuple((power, with_rows(array, 2 * harmonics + 1)) for power, array in self.terms))


@dataclass(frozen=True)
class TravellingWave:
    """An excitation that travels round a disk of N sectors.

    ``engine_order`` k is the number of waves of its first harmonic round the disk: sector s (s sectors ahead of the
    first one) has the force ``p(t - s T k / N)`` if it travels forward, to the next sectors, ``p(t + s T k / N)``
    backward, with the period T.
    """

    engine_order: int
    direction: Direction = "forward"

    def waves(self, harmonic: int) -> int:
        """Signed number of waves d of a harmonic: its complex amplitudes have the lag ``e^{2 pi i d / N}`` from sector
        to sector."""
        return (-1 if self.direction == "forward" else 1) * harmonic * self.engine_order

    def lag(self, harmonic: int, sectors: int, ahead: int = 1) -> complex:
        """``e^{2 pi i d ahead / N}``: complex amplitude of the sector so many sectors ahead, over that of this one."""
        return lag_of(self.waves(harmonic) * ahead, sectors)

    def shifted(self, coefficients: FloatArray, sectors: int, ahead: int) -> FloatArray:
        """Fourier coefficients (..., 2H+1) of the sector so many sectors ahead, in its own axes, from those of this
        one: mean, cos 1, sin 1, ..."""
        answer = coefficients.copy()
        for order in range(1, coefficients.shape[-1] // 2 + 1):
            lag = self.lag(order, sectors, ahead)
            cosine, sine = coefficients[..., 2 * order - 1], coefficients[..., 2 * order]
            answer[..., 2 * order - 1] = lag.real * cosine + lag.imag * sine
            answer[..., 2 * order] = lag.real * sine - lag.imag * cosine
        return answer


def lag_of(waves: int, sectors: int) -> complex:
    """``e^{2 pi i waves / N}``; exactly 1 or -1 where that is its value."""
    rest = waves % sectors
    if rest == 0:
        return 1.0
    return -1.0 if 2 * rest == sectors else complex(np.exp(2j * np.pi * rest / sectors))


@dataclass(frozen=True, eq=False)
class Excitation:
    """A harmonic excitation, from :meth:`force`, :meth:`travelling_wave`, :meth:`base_motion` or :meth:`unbalance`.

    Excitations can be added.

    ``Excitation.force(cos) + Excitation.unbalance(y, z, 1e-5)`` is the sum of both. Phases refer to the same ``t = 0``.
    """

    parts: tuple[_Part, ...]
    wave: TravellingWave | None = None

    @classmethod
    def travelling_wave(
        cls, engine_order: int, cos: ArrayLike, sin: ArrayLike | None = None, direction: Direction = "forward"
    ) -> Excitation:
        """A force of an engine order, which travels round a disk, on a :class:`stickslip.CyclicSector`.

        Parameters
        ----------
        engine_order:
            number k of waves round the disk, such as the number of vanes in front; 0 excites all sectors alike.
        cos, sin:
            N, the force on the first sector as in :meth:`force`, (n,) or (n, n_harmonics). Rows of ``2n`` unknowns
            contain the next sector, as those of :meth:`stickslip.CyclicSector.selector` do.
        direction:
            "forward": the force reaches the next sector (rotated by +2 pi / N about the axis) k / N of a period after
            this one; "backward": before it. Vanes that stand before a disk which rotates in the positive sense give a
            backward wave.

        Raises InputError for an engine order that is not a whole number from 0, another direction, and for arrays
        that :meth:`force` rejects.
        """
        whole_number("engine_order", engine_order, 0)
        require_choice("direction", direction, get_args(Direction))
        part = replace(cls.force(cos, sin).parts[0], words=f"{direction} wave of engine order {engine_order}")
        return cls((part,), TravellingWave(engine_order, direction))

    @classmethod
    def force(cls, cos: ArrayLike, sin: ArrayLike | None = None) -> Excitation:
        """``p(t) = sum_k cos[:, k-1] cos(k w t) + sin[:, k-1] sin(k w t)``.

        ``cos`` and ``sin`` in N, (n,) for the first harmonic or (n, n_harmonics) for several; ``sin`` None means zero.
        Raises InputError for arrays of different size or with an entry that is not finite.
        """
        return force_of_arrays(cos, sin, ("cos", "sin"))

    @classmethod
    def base_motion(cls, direction: ArrayLike, amplitude: float, kind: BaseMotion = "acceleration") -> Excitation:
        """The support moves by ``amplitude cos(w t)`` along ``direction``; displacements are relative to the support.

        In these coordinates the force is ``-M r a(t)``, with the acceleration ``a`` of the base and the influence
        vector r: the displacements of the unknowns when base and structure move by 1 m as one rigid body.

        Parameters
        ----------
        direction:
            (n,) m/m, the influence vector r.
        amplitude:
            0-to-peak, m/s2 for ``kind="acceleration"``, m for ``kind="displacement"``.

        Raises InputError for an amplitude that is not above zero, or another kind.
        """
        return cls((_base_part("direction", direction, amplitude, kind, inertial=True),))

    @classmethod
    def carried_base_motion(cls, inertia: ArrayLike, amplitude: float, kind: BaseMotion = "acceleration") -> Excitation:
        """:meth:`base_motion` of a structure whose constrained unknowns are no longer in its matrices.

        Their mass contributes too, so the force is ``-i a(t)`` with ``inertia`` i (n,) in kg: ``M r`` of the structure
        with its constrained unknowns, in the remaining unknowns (for a reduction ``T^T M r``).
        """
        part = _base_part("inertia", inertia, amplitude, kind, inertial=False)
        return cls((replace(part, cos=-part.cos),))

    @classmethod
    def unbalance(cls, first: ArrayLike, second: ArrayLike, mass_times_radius: float) -> Excitation:
        """A rotating unbalance ``m e`` at a point whose displacements along two directions are rows ``first``,
        ``second`` (n,).

        ``p(t) = m e w^2 (first cos(w t) + second sin(w t))``: it turns from ``first`` to ``second``, once a period.
        ``mass_times_radius`` in kg m. Raises InputError unless it is above zero and the rows have one size.
        """
        size = positive_number("mass_times_radius", mass_times_radius, "kg m")
        rows = _columns("first", first), _columns("second", second)
        if rows[0].shape != rows[1].shape or rows[0].shape[1] != 1:
            raise InputError(
                f"first and second must have the same shape (n,), but the shapes are {rows[0].shape} and "
                f"{rows[1].shape}.",
                arguments=["first", "second"],
            )
        return cls((_Part(2, size * rows[0], size * rows[1], False, f"unbalance of {size:g} kg m"),))

    def __add__(self, other: Excitation) -> Excitation:
        if self.wave != other.wave:
            raise InputError(
                f"{self.describe()} and {other.describe()} do not travel alike round a disk, so their sum does not "
                "repeat from sector to sector. Add waves of one engine order and direction, or give the full ring.",
                arguments=["excitation"],
            )
        return Excitation(self.parts + other.parts, self.wave)

    @property
    def harmonics(self) -> int:
        """The highest harmonic of the force."""
        return max(int(array.shape[1]) for part in self.parts for array in (part.cos, part.sin))

    def __repr__(self) -> str:
        return f"Excitation({self.describe()}; {len(self.parts[0].cos)} unknowns)"

    def describe(self) -> str:
        """The excitation in words."""
        return " and ".join(part.words for part in self.parts)

    def on(self, superelement: Unknowns, harmonics: int) -> ExcitationForce:
        """The force on a structure, with ``harmonics`` harmonics.

        Raises InputError for another number of unknowns, more harmonics than ``harmonics``, or no force at all.
        """
        if self.wave is not None:
            raise InputError(
                "an excitation that travels round a disk requires a CyclicSector; for a structure use "
                "Excitation.force.",
                arguments=["excitation"],
            )
        return ExcitationForce(self.terms_on(superelement, superelement.size, harmonics))

    def terms_on(self, superelement: Unknowns, size: int, harmonics: int) -> tuple[tuple[int, FloatArray], ...]:
        """The terms of an :class:`ExcitationForce` on ``size`` unknowns. Raises InputError, see :meth:`on`."""
        terms: dict[int, FloatArray] = {}
        for part in self.parts:
            target = terms.setdefault(part.power, np.zeros((2 * harmonics + 1, size)))
            for offset, name, columns in ((1, "cosine", part.cos), (2, "sine", part.sin)):
                if columns.shape[0] != size:
                    raise InputError(
                        f"the {name} of the excitation has {columns.shape[0]} rows, but the structure has {size} "
                        "unknowns. Give one row for each unknown.",
                        arguments=["excitation"],
                    )
                if columns.shape[1] > harmonics:
                    raise InputError(
                        f"the {name} of the excitation has {columns.shape[1]} harmonics, but the solution has only "
                        f"harmonics = {harmonics}. Raise harmonics.",
                        arguments=["excitation"],
                    )
                force = -(superelement.mass @ columns) if part.inertial else columns
                target[offset : offset + 2 * columns.shape[1] : 2] += force.T
        if not any(array.any() for array in terms.values()):
            raise InputError(
                "the excitation is zero everywhere; without a force there is no forced response.",
                arguments=["excitation"],
            )
        return tuple(sorted(terms.items(), key=lambda term: term[0]))


def force_of_arrays(cos: ArrayLike, sin: ArrayLike | None, names: tuple[str, str]) -> Excitation:
    """:meth:`Excitation.force` of the arguments with these ``names``, for messages. Raises InputError."""
    cosine, sine = _columns(names[0], cos), None if sin is None else _columns(names[1], sin)
    if sine is not None and sine.shape[0] != cosine.shape[0]:
        raise InputError(
            f"{names[1]} has {sine.shape[0]} rows and {names[0]} {cosine.shape[0]}; both must have shape (n,) or "
            "(n, n_harmonics).",
            arguments=[names[1]],
        )
    zero = np.zeros((len(cosine), 1))
    return Excitation((_Part(0, cosine, zero if sine is None else sine, False, "harmonic force"),))


def _base_part(name: str, vector: ArrayLike, amplitude: float, kind: BaseMotion, inertial: bool) -> _Part:
    """``vector`` (n,) times the acceleration of a support. Raises InputError."""
    require_choice("kind", kind, get_args(BaseMotion))
    unit = "m/s2" if kind == "acceleration" else "m"
    size = positive_number("amplitude", amplitude, unit)
    column = size * _columns(name, vector)
    if column.shape[1] != 1:
        raise argument_error(
            name, f"{name} must have shape (n,), one entry for each unknown, but its shape is {column.shape}."
        )
    # A displacement X cos(w t) is an acceleration -w^2 X cos(w t).
    power, sign = (0, 1.0) if kind == "acceleration" else (2, -1.0)
    return _Part(power, sign * column, np.zeros_like(column), inertial, f"base {kind} of {size:g} {unit}")


def _columns(name: str, value: ArrayLike) -> FloatArray:
    """A copy (n, n_harmonics) of an array (n,) or (n, n_harmonics)."""
    array = finite_array(name, value)
    columns = array[:, None] if array.ndim == 1 else array
    if columns.ndim != 2:
        raise argument_error(name, f"{name} must have shape (n,) or (n, n_harmonics), but its shape is {array.shape}.")
    return columns.copy()
