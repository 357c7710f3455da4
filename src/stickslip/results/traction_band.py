"""The range of a curve with the residual tractions of its pairs, which statics does not determine."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.validation import FloatArray, real_number, require_choice
from stickslip.results.peaks import peaks
from stickslip.results.side_curves import SideCurve, SideCurves
from stickslip.results.sweeps_of_curve import Direction, largest_jump, notable_jumps, sweeps
from stickslip.results.variables import Numbers, stored


@dataclass(frozen=True, eq=False)
class TractionBand(SideCurves):
    """Curves with the extreme residual tractions that friction at rest allows, ``|T0| <= mu * normal_load`` at a pair.

    The first curve has no traction at rest (and retains that: ``residual_traction = 0``), the others have those that
    raise and lower the peak of one output most and move its outermost folds most, to first order about computed curves,
    and those that a local optimisation of the peak from several starts found beyond them.
    Each curve is a solution, so the true band is at least as wide. Other tractions can be outside, because the
    optimisation is local; the normal loads at rest are the same for all tractions, and what vibration itself leaves in
    a stuck pair between two frequencies is not a traction at rest.

    Parameters
    ----------
    names, complete, curve, frequency_hz, displacement:
        as in :class:`SideCurves`; the curves cover the frequencies around the highest peak.
    traction:
        (n_curves, n_pairs, 2) N along t1, t2 at rest; zero for pairs of other laws than Coulomb's.
    raised_peaks, lowered_peaks:
        (k,) m, the local extremes of the peak from each start of the optimisation; None without one.
    """

    DATASET_TITLE: ClassVar[str] = "Curves with extreme residual tractions"

    traction: FloatArray = field(
        metadata=stored(Numbers(("side_curve", "side_pair", "tangent"), "N", "traction at rest"))
    )

    raised_peaks: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(("raising_start",), "m", "local maximum of the peak from each start", optional=True)),
    )
    lowered_peaks: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(("lowering_start",), "m", "local minimum of the peak from each start", optional=True)),
    )

    def _sizes(self, shape: tuple[int, ...]) -> dict[str, int]:
        pairs = np.shape(self.traction)[1] if np.ndim(self.traction) == 3 else 0
        starts = {
            name: 0 if values is None else np.size(values)
            for name, values in (("raising_start", self.raised_peaks), ("lowering_start", self.lowered_peaks))
        }
        return {**super()._sizes(shape), "side_pair": pairs, "tangent": 2, **starts}

    def __repr__(self) -> str:
        early = int((~self.complete).sum())
        ends = f"; {early} NOT complete" if early else ""
        return (
            f"TractionBand({self.n_curves} curves from {self.frequency_hz.min():.2f} to "
            f"{self.frequency_hz.max():.2f} Hz: {', '.join(self.names)}{ends})"
        )

    def peak_range(self, output: ArrayLike, harmonic: int | None = None) -> tuple[float, float]:
        """Lowest and highest peak of the curves, as amplitudes of an output (:meth:`curves`). Raises InputError.

        The lowest is that of complete curves, if there are any: one that ends early may end below its peak.
        """
        curves = self.curves(output, harmonic)
        tops = [peaks(each.frequency_hz, each.amplitude)[0].amplitude for each in curves]
        whole = [top for top, each in zip(tops, curves, strict=True) if each.complete]
        return min(whole or tops), max(tops)

    def jump_range_hz(self, direction: Direction, output: ArrayLike) -> tuple[float, float] | None:
        """Lowest and highest frequency at which a slow sweep "up" or "down" jumps most; None if no curve has a jump.

        Raises InputError.
        """
        require_choice("direction", direction, ("up", "down"))
        places = [hertz for each in self.curves(output) if (hertz := _jump_hz(each, direction)) is not None]
        return (min(places), max(places)) if places else None

    def amplitude_range(
        self, output: ArrayLike, frequency_hz: float, harmonic: int | None = None
    ) -> tuple[float, float] | None:
        """Lowest and highest amplitude on stable parts of the curves at one frequency; None where there is no curve.

        Raises InputError.
        """
        target = real_number("frequency_hz", frequency_hz)
        values = [value for each in self.curves(output, harmonic) for value in _at(each, target)]
        return (min(values), max(values)) if values else None


def _jump_hz(curve: SideCurve, direction: Direction) -> float | None:
    """The frequency of the largest jump of a slow sweep on a curve."""
    sweep = sweeps(curve.frequency_hz, curve.amplitude, curve.stable)[0 if direction == "up" else 1]
    jumps = notable_jumps(peaks(curve.frequency_hz, curve.amplitude)[0], sweep.jumps)
    return largest_jump(jumps).frequency_hz if jumps else None


def _at(curve: SideCurve, frequency_hz: float) -> list[float]:
    """Amplitudes at a frequency on steps between stable points."""
    f, a = curve.frequency_hz, curve.amplitude
    passes = (f[:-1] - frequency_hz) * (f[1:] - frequency_hz) <= 0.0
    before = np.flatnonzero(passes & curve.stable[:-1] & curve.stable[1:] & (f[:-1] != f[1:]))
    return [float(a[i] + (frequency_hz - f[i]) / (f[i + 1] - f[i]) * (a[i + 1] - a[i])) for i in before]
