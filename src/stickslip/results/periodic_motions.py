"""Common parts of results along a curve of periodic motions: amplitudes, signals, pairs, and their file.

Displacements are Fourier coefficients in the order mean, cos 1, sin 1, cos 2, sin 2, ...:
``u(t) = c_0 + sum_k c_k cos(k w t) + s_k sin(k w t)``, ``w = 2 pi f``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactState
from stickslip.core.errors import InputError
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.pair_variables import pairs_from, pairs_groups
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.results.saved import Saved
from stickslip.results.stored import StoredGroup
from stickslip.results.variables import (
    Attribute,
    Coefficients,
    HarmonicNumbers,
    InGroup,
    Json,
    Numbers,
    Text,
    WholeNumbers,
    require_shape,
    stored,
)

# Dimensions of what each point of the curve has, and each pair at each point.
CURVE, PAIRS = ("point",), ("point", "pair")
# More samples of a period than any run has: a larger number in a file is damage.
MOST_SAMPLES = 10**6
_Setting = str | float | int | None


@dataclass(frozen=True, eq=False)
class PeriodicMotions(Saved):
    """Base of results with a periodic motion at each point: what :class:`stickslip.results.response.ForcedResponse`
    describes of them."""

    frequency_hz: FloatArray = field(metadata=stored(Numbers(CURVE, "Hz", "frequency of the motion", name="frequency")))
    displacement: FloatArray = field(
        metadata=stored(
            Coefficients(
                ("point", "unknown"),
                "m",
                "displacement (m for boundary unknowns, own scaling for modal ones)",
            )
        )
    )
    contact_state: NDArray[np.int8] = field(
        metadata=stored(
            WholeNumbers(
                PAIRS, "1", f"contact state: {', '.join(f'{each:d} {each.label}' for each in ContactState)}", np.int8
            )
        )
    )
    dissipated_energy: FloatArray = field(
        metadata=stored(Numbers(PAIRS, "J", "work on the contact force per cycle: friction and normal_work"))
    )
    normal_work: FloatArray = field(
        metadata=stored(Numbers(PAIRS, "J", "work of the normal force per cycle, an error of sampling"))
    )
    closure: FloatArray = field(
        metadata=stored(Numbers(PAIRS, "1", "relative distance between slider at start and end of the period"))
    )
    residual: FloatArray = field(metadata=stored(Numbers(CURVE, "1", "relative residual of the balance")))
    iterations: NDArray[np.int64] = field(metadata=stored(WholeNumbers(CURVE, "1", "Newton iterations")))
    viscous_energy: FloatArray = field(
        metadata=stored(Numbers(CURVE, "J", "energy that viscous damping dissipates per cycle"))
    )
    converged: bool = field(metadata=stored(Attribute(0, 1, bool)))
    message: str = field(metadata=stored(Text("message of the solver at its end")))
    warnings: tuple[str, ...] = field(metadata=stored(Json(list[str], "warnings of the solver, JSON list")))
    harmonics: int = field(metadata=stored(HarmonicNumbers()))
    samples: int = field(metadata=stored(Attribute(1, MOST_SAMPLES)))
    pairs: ContactPairs = field(metadata=stored(InGroup(pairs_groups, pairs_from)))
    settings: dict[str, str | float | int] = field(
        metadata=stored(Json(dict[str, _Setting], "settings of the solve, JSON object"))
    )
    provenance: dict[str, str] = field(metadata=stored(Json(dict[str, str], "software and machine, JSON object")))

    @property
    def n_points(self) -> int:
        """Number of points on the curve."""
        return int(self.frequency_hz.size)

    @property
    def friction_energy(self) -> FloatArray:
        """(n_points, n_pairs) J per cycle dissipated by friction, the work of the tangential forces."""
        return self.dissipated_energy - self.normal_work

    @property
    def moving_pairs(self) -> NDArray[np.int64]:
        """(n_points,) number of pairs that slip or separate."""
        return np.asarray((self.contact_state != ContactState.STUCK).sum(axis=1))

    @property
    def n_unknowns(self) -> int:
        """Number of unknowns n of the structure."""
        return int(self.displacement.shape[1])

    def amplitude(self, output: ArrayLike) -> FloatArray:
        """(n_points,) 0-to-peak amplitude of ``output @ u(t)``: its largest absolute value over the period.

        The mean is included, and the maximum is refined between samples. ``output`` is a row (n,); its unit sets that
        of the result (m for a displacement). Raises InputError.
        """
        return periodic_amplitude(self.coefficients(output))

    def harmonic_amplitude(self, output: ArrayLike, harmonic: int) -> FloatArray:
        """(n_points,) ``sqrt(c_k^2 + s_k^2)`` of ``output @ u``, and ``|c_0|`` for harmonic 0. Raises InputError."""
        if not 0 <= harmonic <= self.harmonics:
            raise InputError(
                f"harmonic is {harmonic}, but this response contains harmonics 0 to {self.harmonics}. Solve with more "
                "harmonics to see higher ones.",
                arguments=["harmonic"],
            )
        coefficients = self.coefficients(output)
        if harmonic == 0:
            return np.abs(coefficients[:, 0])
        magnitude: FloatArray = np.hypot(coefficients[:, 2 * harmonic - 1], coefficients[:, 2 * harmonic])
        return magnitude

    def coefficients(self, output: ArrayLike) -> FloatArray:
        """(n_points, 2 * harmonics + 1) Fourier coefficients of ``output @ u(t)``. Raises InputError."""
        coefficients: FloatArray = np.einsum("pic,i->pc", self.displacement, self._row(output))
        return coefficients

    def signal(self, output: ArrayLike, point: int, n_samples: int) -> FloatArray:
        """(n_samples,) ``output @ u(t)`` at one point, ``t_j = j / (n_samples f)``. Raises InputError."""
        signal: FloatArray = synthesis_matrix(self.harmonics, n_samples) @ self.coefficients(output)[self._point(point)]
        return signal

    def pair_coefficients(self, point: int) -> FloatArray:
        """(n_pairs, 3, 2 * harmonics + 1) m, relative displacement t1, t2, n of each pair. Raises InputError."""
        relative: FloatArray = self.pairs.operator @ self.displacement[self._point(point)]
        return relative.reshape(self.pairs.n_pairs, 3, -1)

    def pair_displacement(self, point: int, n_samples: int) -> FloatArray:
        """(n_samples, n_pairs, 3) m, relative displacement t1, t2, n over one period. Raises InputError."""
        synthesis = synthesis_matrix(self.harmonics, n_samples)
        return np.moveaxis(self.pair_coefficients(point) @ synthesis.T, 2, 0)

    @classmethod
    def from_group(cls, group: StoredGroup, harmonics: int = 0) -> Self:
        """The result in a group of a results file, which contains its number of harmonics."""
        return super().from_group(group, group.integers("harmonic").size)

    def _checked_sizes(self) -> dict[str, int]:
        """Sizes of the dimensions of the points. Raises InputError for no points, and for unknown contact states."""
        points = np.shape(self.frequency_hz)
        if len(points) != 1 or not points[0]:
            raise InputError(
                f"frequency_hz must be a list of at least one point, but its shape is {points}.",
                arguments=["frequency_hz"],
            )
        if not np.isin(self.contact_state, list(ContactState)).all():
            states = [f"{state:d} ({state.label})" for state in ContactState]
            raise InputError(
                f"contact_state must contain only {', '.join(states[:-1])} or {states[-1]}.",
                arguments=["contact_state"],
            )
        return {
            "point": points[0],
            "pair": self.pairs.n_pairs,
            "unknown": self.pairs.operator.shape[1],
            "harmonic": self.harmonics,
        }

    def _row(self, output: ArrayLike) -> FloatArray:
        row = finite_array("output", output)
        require_shape("output", row, (self.n_unknowns,))
        return row

    def _point(self, point: int) -> int:
        if not -self.n_points <= point < self.n_points:
            raise InputError(
                f"point is {point}, but this response has {self.n_points} points, numbered from 0.", arguments=["point"]
            )
        return point
