"""The answer of a forced-response run as plain labelled data: amplitudes, signals, contact states and energies.

Displacements are Fourier coefficients in the order mean, cos 1, sin 1, cos 2, sin 2, ...:
``u(t) = c_0 + sum_k c_k cos(k w t) + s_k sin(k w t)``, ``w = 2 pi f``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.plain_data import same_content
from stickslip.core.validation import FloatArray, finite_array, require_choice

if TYPE_CHECKING:
    from stickslip.contact.law.coulomb_harmonics import Update
    from stickslip.contact.law.law import ContactCycle

STATE_NAMES = ("stuck", "stick-slip", "separating")


@dataclass(frozen=True, eq=False)
class LinearCurves:
    """The two linear limits beside the computed curve: all pairs that are closed at rest stuck, and no contact at all.

    Parameters
    ----------
    frequency_hz:
        (n_linear,) Hz.
    stuck, free:
        (n_linear, n, 2 * harmonics + 1) m, displacement coefficients under the same force.
    stuck_frequency_hz, free_frequency_hz:
        (n_modes,) Hz, natural frequencies without damping.
    """

    frequency_hz: FloatArray
    stuck: FloatArray
    free: FloatArray
    stuck_frequency_hz: FloatArray
    free_frequency_hz: FloatArray

    def __post_init__(self) -> None:
        for name in ("frequency_hz", "stuck", "free", "stuck_frequency_hz", "free_frequency_hz"):
            object.__setattr__(self, name, finite_array(f"linear.{name}", getattr(self, name)))

    def __eq__(self, other: object) -> bool:
        return same_content(self, other) if isinstance(other, LinearCurves) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, eq=False)
class ForcedResponse:
    """Forced response along a curve of ``n_points`` points, in the order in which the curve was walked.

    The curve may fold, so ``frequency_hz`` need not rise; neighbours in the index are neighbours on the curve.

    Parameters
    ----------
    frequency_hz:
        (n_points,) Hz.
    displacement:
        (n_points, n, 2 * harmonics + 1) m, coefficients mean, cos 1, sin 1, ...
    contact_state:
        (n_points, n_pairs) 0 stuck, 1 stick-slip, 2 separating.
    dissipated_energy:
        (n_points, n_pairs) J per cycle that the contact force of each pair takes: friction, and ``normal_work``. With
        it the energies of the balance add up: dissipated + viscous = input.
    normal_work:
        (n_points, n_pairs) J per cycle, the part of the normal force. A force that only depends on the closing does
        no work in a period, so this is the error of sampling it; where it is not small beside the input, samples are
        too few.
    closure:
        (n_points, n_pairs) relative distance between the slider at the start and at the end of the period.
    residual, iterations:
        (n_points,) relative residual of the balance, Newton iterations.
    input_energy, viscous_energy:
        (n_points,) J per cycle, work of the excitation and loss in the damping matrix.
    converged, message:
        whether the whole range was walked, and the sentence that says how it ended.
    warnings:
        sentences, for example too few harmonics.
    harmonics, samples:
        highest harmonic kept, samples per period of the friction law.
    pairs:
        the joint.
    linear:
        the linear limits.
    force:
        (n, 2 * harmonics + 1) N, coefficients of the excitation; of one that depends on the frequency at the middle of
        the curve.
    settings, provenance:
        what the run was asked to do, and which software on which machine did it.
    load_factor:
        (n_points,) the excitation at a point over ``force``; 1 unless the response was held and the force followed.

    Raises
    ------
    InputError
        for an array of the wrong shape or with an entry that is not finite.
    """

    frequency_hz: FloatArray
    displacement: FloatArray
    contact_state: NDArray[np.int8]
    dissipated_energy: FloatArray
    normal_work: FloatArray
    closure: FloatArray
    residual: FloatArray
    iterations: NDArray[np.int64]
    input_energy: FloatArray
    viscous_energy: FloatArray
    converged: bool
    message: str
    warnings: tuple[str, ...]
    harmonics: int
    samples: int
    pairs: ContactPairs
    linear: LinearCurves
    force: FloatArray
    settings: dict[str, str | float | int]
    provenance: dict[str, str]
    load_factor: FloatArray = field(default_factory=lambda: np.ones(1))

    def __post_init__(self) -> None:
        points, n_pairs = np.shape(self.frequency_hz), (self.pairs.n_pairs,)
        coefficients = (self.pairs.operator.shape[1], 2 * self.harmonics + 1)
        curve = np.shape(self.linear.frequency_hz)
        if len(points) != 1 or not points[0]:
            raise InputError(f"frequency_hz must be a list of at least one point, but its shape is {points}.")
        if np.shape(self.load_factor) == (1,):
            object.__setattr__(self, "load_factor", np.repeat(self.load_factor, points[0]))
        expected: dict[str, tuple[int, ...]] = {
            "frequency_hz": points,
            "displacement": points + coefficients,
            "contact_state": points + n_pairs,
            "dissipated_energy": points + n_pairs,
            "normal_work": points + n_pairs,
            "closure": points + n_pairs,
            "residual": points,
            "iterations": points,
            "input_energy": points,
            "viscous_energy": points,
            "load_factor": points,
            "force": coefficients,
        }
        for name, shape in expected.items():
            array = finite_array(name, getattr(self, name))
            _require_shape(name, array, shape)
            kind = {"contact_state": np.int8, "iterations": np.int64}.get(name, np.float64)
            object.__setattr__(self, name, array.astype(kind))
        _require_shape("linear.stuck", self.linear.stuck, curve + coefficients)
        _require_shape("linear.free", self.linear.free, curve + coefficients)
        if self.contact_state.min() < 0 or self.contact_state.max() >= len(STATE_NAMES):
            raise InputError("contact_state must hold 0 (stuck), 1 (stick-slip) or 2 (separating) only.")

    def __eq__(self, other: object) -> bool:
        return same_content(self, other) if isinstance(other, ForcedResponse) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    @property
    def n_points(self) -> int:
        """Number of points on the curve."""
        return int(self.frequency_hz.size)

    @property
    def friction_energy(self) -> FloatArray:
        """(n_points, n_pairs) J per cycle that friction takes, the work of the tangential forces."""
        return self.dissipated_energy - self.normal_work

    @property
    def n_unknowns(self) -> int:
        """Number of unknowns n of the structure."""
        return int(self.displacement.shape[1])

    def amplitude(self, output: ArrayLike) -> FloatArray:
        """(n_points,) 0-to-peak amplitude of ``output @ u(t)``: its largest absolute value over the period.

        The mean is included, and the maximum is refined between samples. ``output`` is a row (n,); its unit sets the
        unit of the answer (m for a row that reads a displacement). Raises InputError.
        """
        return periodic_amplitude(self.coefficients(output))

    def linear_amplitude(self, output: ArrayLike, limit: str) -> FloatArray:
        """(n_linear,) the same amplitude on the linear curve ``limit``: "stuck" or "free". Raises InputError."""
        require_choice("limit", limit, ("stuck", "free"))
        curve: FloatArray = getattr(self.linear, limit)
        return periodic_amplitude(np.einsum("pic,i->pc", curve, self._row(output)))

    def harmonic_amplitude(self, output: ArrayLike, harmonic: int) -> FloatArray:
        """(n_points,) ``sqrt(c_k^2 + s_k^2)`` of ``output @ u``, and ``|c_0|`` for harmonic 0. Raises InputError."""
        if not 0 <= harmonic <= self.harmonics:
            raise InputError(
                f"harmonic is {harmonic}, but this response holds harmonics 0 to {self.harmonics}. "
                "Solve with more harmonics to see higher ones."
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
        row = self._row(output)
        signal: FloatArray = synthesis_matrix(self.harmonics, n_samples) @ (row @ self.displacement[self._point(point)])
        return signal

    def pair_coefficients(self, point: int) -> FloatArray:
        """(n_pairs, 3, 2 * harmonics + 1) m, relative displacement t1, t2, n of each pair. Raises InputError."""
        relative: FloatArray = self.pairs.operator @ self.displacement[self._point(point)]
        return relative.reshape(self.pairs.n_pairs, 3, -1)

    def pair_displacement(self, point: int, n_samples: int) -> FloatArray:
        """(n_samples, n_pairs, 3) m, relative displacement t1, t2, n over one period. Raises InputError."""
        synthesis = synthesis_matrix(self.harmonics, n_samples)
        return np.moveaxis(self.pair_coefficients(point) @ synthesis.T, 2, 0)

    def pair_cycle(self, point: int) -> ContactCycle:
        """Force, slider, state and energy of every pair over one period at one point. Raises InputError.

        The friction law is marched again to its periodic state on the displacement of that point, with the samples and
        the update rule of the solve (``settings["update"]``), so nothing of this size need be stored.
        """
        displacement = self.pair_displacement(point, self.samples)
        return self.pairs.with_update(cast("Update", self.settings["update"])).cycle(displacement)

    def save(self, path: str | PathLike[str]) -> None:
        """Write one NetCDF-4 file, whole or not at all; see :func:`stickslip.results.storage.save_results`."""
        from stickslip.results.storage import save_results

        save_results(path, self)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> ForcedResponse:
        """Read back what :meth:`save` wrote: an equal object. Raises ResultsFileError."""
        from stickslip.results.storage import load_results

        return load_results(path).response

    def _row(self, output: ArrayLike) -> FloatArray:
        row = finite_array("output", output)
        _require_shape("output", row, (self.n_unknowns,))
        return row

    def _point(self, point: int) -> int:
        if not -self.n_points <= point < self.n_points:
            raise InputError(f"point is {point}, but this response has {self.n_points} points, numbered from 0.")
        return point


def periodic_amplitude(coefficients: FloatArray) -> FloatArray:
    """(m,) largest absolute value over the period of each row of Fourier coefficients (m, 2 * harmonics + 1).

    Each local maximum on a grid of 32 samples per highest harmonic is refined by a parabola; the best of them is then
    polished by Newton steps on ``x'(tau) = 0``, so the answer is exact to round-off where that maximum is smooth.
    """
    harmonics = (coefficients.shape[1] - 1) // 2
    if harmonics == 0:
        return np.abs(coefficients[:, 0])
    samples = 32 * harmonics
    values = np.abs(coefficients @ synthesis_matrix(harmonics, samples).T)
    before, after = np.roll(values, 1, axis=1), np.roll(values, -1, axis=1)
    bend = 2.0 * values - before - after
    peaks = (values >= before) & (values >= after) & (bend > 0)
    offset = np.divide(0.5 * (after - before), bend, out=np.zeros_like(values), where=peaks)
    height = np.where(peaks, values + 0.25 * (after - before) * offset, values)
    best = height.argmax(axis=1)
    rows = np.arange(len(values))
    step = 2.0 * np.pi / samples
    angle = (best + offset[rows, best]) * step
    order = np.arange(1, harmonics + 1)
    cosine, sine = coefficients[:, 1::2], coefficients[:, 2::2]
    for _ in range(4):
        c, s = np.cos(np.outer(angle, order)), np.sin(np.outer(angle, order))
        slope = ((sine * c - cosine * s) * order).sum(axis=1)
        curvature = -((cosine * c + sine * s) * order**2).sum(axis=1)
        move = np.divide(-slope, curvature, out=np.zeros_like(slope), where=curvature != 0)
        angle = angle + np.clip(move, -step, step)
    c, s = np.cos(np.outer(angle, order)), np.sin(np.outer(angle, order))
    polished = np.abs(coefficients[:, 0] + (cosine * c + sine * s).sum(axis=1))
    amplitude: FloatArray = np.maximum(polished, values[rows, best])
    return amplitude


def _require_shape(name: str, array: NDArray[Any], shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise InputError(f"{name} must have shape {shape}, but its shape is {array.shape}.")
