"""How much the response of a linear disk grows because its blades differ.

The ring moves in the modes of the tuned disk with stuck contacts (component mode mistuning, Lim et al. 2007, see
:mod:`stickslip.structure.blade_alone`): those of all nodal diameters up to a few times the frequencies of interest.
In them the stiffness is ``diag(w^2) + P^H diag(c) P`` with the participations P of the blades alone and their changes c
of stiffness, a matrix of some hundred rows, so thousands of patterns take minutes.

The amplification factor is the highest amplitude of any blade at any frequency over that of the tuned disk. Under one
engine order it is at most ``(1 + sqrt(N)) / 2`` where one family of modes responds (D. S. Whitehead, Effect of
mistuning on the vibration of turbomachine blades induced by wakes, J. Mech. Eng. Sci. 8 (1966) 15-21).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.optimize
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.completeness import reported
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, positive_number
from stickslip.solve.cyclic.balances import force_on_sector
from stickslip.solve.cyclic.ring_input import require_modes_without_coupling, row_of_sector
from stickslip.solve.cyclic.stuck_sector import wide_pairs
from stickslip.solve.excitation import Excitation, TravellingWave, lag_of
from stickslip.solve.harmonic.damping import modal_basis
from stickslip.solve.harmonic.gain import ComplexArray, to_complex
from stickslip.solve.setting_up import checked_window
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.cyclic_sector import CyclicSector

# chosen: tuned modes up to this multiple of the highest frequency take part.
TAKES_PART = 4.0
# chosen: a peak closer to an end of the range, relative, is at this end.
AT_END = 1e-6
# chosen: points about each natural frequency, in multiples of its half-power half-width, between which a peak is
# searched. Two modes closer than a half-width have a peak between them.
ABOUT = np.linspace(-3.0, 3.0, 13)


@dataclass(frozen=True)
class Amplification:
    """Amplification of patterns of mistuning.

    Attributes
    ----------
    blade_factor:
        (n_patterns, N) highest amplitude of each sector over that of the tuned disk.
    peak_hz, sector:
        (n_patterns,) frequency and sector of the highest amplitude of all.
    tuned_peak, tuned_peak_hz:
        m, amplitude and frequency of the peak of the tuned disk.
    sectors:
        number N of sectors.
    at_end:
        number of patterns, with the tuned disk, whose highest amplitude is at an end of the range.
    """

    blade_factor: FloatArray
    peak_hz: FloatArray
    sector: NDArray[np.int64]
    tuned_peak: float
    tuned_peak_hz: float
    sectors: int
    at_end: int = 0

    @property
    def factor(self) -> FloatArray:
        """(n_patterns,) highest amplitude of any sector over that of the tuned disk."""
        return np.asarray(self.blade_factor.max(axis=1))

    @property
    def converged(self) -> bool:
        """Whether all highest amplitudes are inside the range."""
        return self.at_end == 0

    @property
    def message(self) -> str:
        """A message on highest amplitudes at an end of the range."""
        if self.converged:
            return "All highest amplitudes are inside the range."
        return (
            f"{self.at_end} of {self.factor.size + 1} disks, with the tuned one, have their highest amplitude at an "
            "end of the range of frequencies. A higher amplitude may be outside: widen frequency_hz."
        )

    @property
    def whitehead_limit(self) -> float:
        """``(1 + sqrt(N)) / 2``, the largest factor of one family of modes."""
        return float(1.0 + np.sqrt(self.sectors)) / 2.0

    def __repr__(self) -> str:
        return (
            f"Amplification({self.factor.size} patterns: factor {self.factor.min():.3g} to {self.factor.max():.3g}, "
            f"Whitehead's limit {self.whitehead_limit:.3g})"
        )


def amplification_factors(
    sector: CyclicSector,
    blade: BladeAlone,
    deviations: ArrayLike,
    wave: Excitation,
    output: ArrayLike,
    *,
    frequency_hz: tuple[float, float],
    modal_damping_ratio: float,
    pairs: ContactPairs | None = None,
    raise_on_failure: bool = False,
) -> Amplification:
    """Amplification factors of a linear disk for patterns of mistuning.

    Parameters
    ----------
    sector:
        one sector, reduced for all nodal diameters.
    blade:
        its blade alone (:func:`blade_alone`).
    deviations:
        (n_patterns, N) relative deviations of the natural frequencies of the blades alone, such as
        ``0.02 * random.standard_normal((500, N))``.
    wave:
        :meth:`Excitation.travelling_wave`, first harmonic only.
    output:
        (n,) or (2n,) the displacement of a sector whose amplitude counts, such as ``CyclicSector.selector``.
    frequency_hz:
        the range of frequencies.
    modal_damping_ratio:
        of each mode, of the mistuned disk too.
    pairs:
        pairs of one sector, all of which stick; None for no contact.
    raise_on_failure:
        whether highest amplitudes at an end of the range are an error instead of a warning.

    Raises
    ------
    InputError
        for a sector without some nodal diameters, with damping matrices or Coriolis forces, arrays of another shape, a
        deviation above 0.3, an excitation that does not travel or has higher harmonics, a damping ratio that is not
        above zero, and a range without resonance of the tuned disk. ConvergenceError instead of a warning with
        ``raise_on_failure``.
    """
    result = unreported_factors(
        sector, blade, deviations, wave, output, frequency_hz=frequency_hz, modal_damping_ratio=modal_damping_ratio,
        pairs=pairs,
    )  # fmt: skip
    return reported(result, raise_on_failure)


def unreported_factors(
    sector: CyclicSector, blade: BladeAlone, deviations: ArrayLike, wave: Excitation, output: ArrayLike, *,
    frequency_hz: tuple[float, float], modal_damping_ratio: float, pairs: ContactPairs | None,
) -> Amplification:  # fmt: skip
    """:func:`amplification_factors`, for a caller that reports highest amplitudes at an end of the range itself."""
    require_modes_without_coupling(sector)
    positive_number("modal_damping_ratio", modal_damping_ratio)
    low, high = sorted(checked_window(frequency_hz))
    patterns = finite_array("deviations", deviations)
    if patterns.ndim != 2 or patterns.shape[1] != sector.sectors or not len(patterns):
        raise InputError(
            f"deviations must have shape (n_patterns, {sector.sectors}), but its shape is {patterns.shape}.",
            arguments=["deviations"],
        )
    row = row_of_sector("output", output, sector)
    disk = TunedDisk.of(sector, blade, wave, row.reshape(2, -1), 2.0 * np.pi * TAKES_PART * high, pairs)
    window = 2.0 * np.pi * low, 2.0 * np.pi * high
    count = sector.sectors
    if not disk.is_excited_in(window):
        raise InputError(
            f"the engine order excites no mode of the tuned disk between {low:g} and {high:g} Hz. Choose another "
            "range.",
            arguments=["frequency_hz"],
        )
    tuned, tuned_omega = disk.highest(np.zeros((count, blade.frequency_hz.size)), window, modal_damping_ratio)
    best = int(tuned.argmax())
    changes = (blade.stiffness_changes(pattern, count) for pattern in patterns)
    found = [disk.highest(each, window, modal_damping_ratio) for each in changes]
    amplitude, omega = (np.array(each) for each in zip(*found, strict=True))
    place = amplitude.argmax(axis=1)
    peak = omega[np.arange(len(patterns)), place]
    return Amplification(
        amplitude / tuned[best], peak / (2.0 * np.pi), place, float(tuned[best]),
        float(tuned_omega[best]) / (2.0 * np.pi), count,
        int((~_is_inside(np.append(peak, tuned_omega[best]), window)).sum()),
    )  # fmt: skip


@dataclass(frozen=True)
class TunedDisk:
    """The modes of the tuned disk that take part, r in all.

    ``circular_frequency`` (r,); ``participation`` (N k, r) of the blades; ``output`` (N, r); ``force`` (r,).
    """

    circular_frequency: FloatArray
    participation: ComplexArray
    output: ComplexArray
    force: ComplexArray

    @classmethod
    def of(
        cls,
        sector: CyclicSector,
        blade: BladeAlone,
        wave: Excitation,
        rows: FloatArray,
        highest: float,
        pairs: ContactPairs | None,
    ) -> TunedDisk:
        """From the reduced sector; modes up to ``highest`` rad/s take part.

        ``rows`` (2, n) are the output in this sector and in the next one.
        """
        travelling, load = _first_harmonic(sector, wave)
        count = sector.sectors
        sides = None if pairs is None else np.hsplit(wide_pairs(pairs, sector.size).operator, 2)
        springs = None if pairs is None else pairs.resting_stiffness()[:, None]
        frequencies, participations, outputs, forces = [], [], [], []
        bases: dict[int, tuple[FloatArray, NDArray[Any]]] = {}  # of one direction; the other one has conjugate modes
        for waves in range(count):
            matrices, lag, diameter = sector.lagged(waves), lag_of(waves, count), min(waves, count - waves)
            if diameter not in bases:
                stiffness = matrices.stiffness
                if sides is not None:
                    operator = sides[0] + lag * sides[1]
                    stiffness = stiffness + operator.conj().T @ (springs * operator)
                bases[diameter] = modal_basis(matrices.mass, stiffness)
            omega, modes = bases[diameter]
            kept = modes[:, omega <= highest] if waves == diameter else modes[:, omega <= highest].conj()
            alone = blade.in_wave(waves, count)
            # In sector s a wave has the lag to the power s.
            turns = np.array([lag_of(waves * place, count) for place in range(count)]) / np.sqrt(count)
            frequencies.append(omega[omega <= highest])
            participations.append(np.vstack([turn * (alone @ kept) for turn in turns]))
            outputs.append(turns[:, None] * (sum(lag**ahead * part for ahead, part in enumerate(rows)) @ kept))
            travels = waves == travelling.waves(1) % count
            forces.append(np.sqrt(count) * (kept.conj().T @ load) if travels else np.zeros(kept.shape[1], complex))
        return cls(*(np.hstack(each) for each in (frequencies, participations, outputs, forces)))

    def is_excited_in(self, window: tuple[float, float]) -> bool:
        """Whether the force moves a mode of the tuned disk in a window (rad/s)."""
        inside = (self.circular_frequency >= window[0]) & (self.circular_frequency <= window[1])
        return bool(self.force[inside].any())

    def natural_omega(self, changes: FloatArray) -> FloatArray:
        """Natural circular frequencies of the disk with changes (N, k) of the stiffness of the blades, rising."""
        return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(self._stiffness(changes)), 0.0)))

    def _stiffness(self, changes: FloatArray) -> ComplexArray:
        matrix = self.participation.conj().T @ (changes.reshape(-1, 1) * self.participation)
        matrix[np.diag_indices_from(matrix)] += self.circular_frequency**2
        return np.asarray(matrix)

    def highest(self, changes: FloatArray, window: tuple[float, float], ratio: float) -> tuple[FloatArray, FloatArray]:
        """(N,) highest amplitude of each sector in a window (rad/s), and its circular frequency.

        ``changes`` (N, k) are those of the stiffness of the blades alone.
        """
        squares, modes = np.linalg.eigh(self._stiffness(changes))
        omega = np.sqrt(np.maximum(squares, 0.0))
        gains = (self.output @ modes) * (modes.conj().T @ self.force)

        def amplitudes(rows: ComplexArray, at: FloatArray) -> FloatArray:
            resonance = squares[:, None] - at**2 + 2j * ratio * omega[:, None] * at
            return np.asarray(np.abs(rows @ (1.0 / resonance)))

        inside = omega[(omega >= window[0]) & (omega <= window[1])]
        around = (inside[:, None] * (1.0 + ratio * ABOUT)).ravel()
        grid = np.unique(np.clip(np.append(around, window), *window))
        sampled = amplitudes(gains, grid)
        top, place = np.empty(len(gains)), np.empty(len(gains))
        for sector, row in enumerate(gains):
            best = int(sampled[sector].argmax())
            bounds = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
            refined = scipy.optimize.minimize_scalar(
                lambda at, row=row: -float(amplitudes(row[None], np.array([at]))[0, 0]), bounds=bounds,
                method="bounded", options={"xatol": 1e-4 * ratio * float(grid[best])},
            )  # fmt: skip
            reached = (float(sampled[sector, best]), float(grid[best]))
            top[sector], place[sector] = max((-float(refined.fun), float(refined.x)), reached)
        return top, place


def _is_inside(omega: FloatArray, window: tuple[float, float]) -> NDArray[np.bool_]:
    """Whether circular frequencies are inside a window, not at its ends; False for no frequency."""
    return np.asarray((omega > window[0] * (1.0 + AT_END)) & (omega < window[1] * (1.0 - AT_END)))


def _first_harmonic(sector: CyclicSector, excitation: Excitation) -> tuple[TravellingWave, ComplexArray]:
    """The wave, and the complex amplitude (n,) of its force on the first sector. Raises InputError."""
    wave = excitation.wave
    if wave is None or excitation.harmonics > 1:
        raise InputError(
            "wave must be an Excitation.travelling_wave with one harmonic: a linear disk responds to each alone.",
            arguments=["wave"],
        )
    force = force_on_sector(sector, excitation, wave, 1).coefficients(1.0)
    return wave, to_complex(force[1:])[0]
