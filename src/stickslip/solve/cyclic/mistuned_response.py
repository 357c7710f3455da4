"""The response of a mistuned disk with friction: all sectors, one curve, amplitudes of each sector."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.completeness import reported
from stickslip.core.progress import ProgressCallback
from stickslip.core.short_repr import short_repr
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import FloatArray, finite_array, positive_number
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.solve.cyclic.amplification import TAKES_PART, TunedDisk
from stickslip.solve.cyclic.balances import force_on_sector
from stickslip.solve.cyclic.ring_input import (
    pairs_of_sectors,
    require_modes_without_coupling,
    row_of_sector,
    travelling,
)
from stickslip.solve.cyclic.stuck_ring import ring_force, stuck_ring
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import WORK_PER_POINT
from stickslip.solve.harmonic.curve_warnings import neighbour_warnings
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.missed_peaks import PeakCheck, search_missed_peaks
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.landmarks import Landmark
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import Accepted, ContinuationSettings
from stickslip.solve.path.work import Work
from stickslip.solve.setting_up import StageReport, check_options, checked_window
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.cyclic_sector import CyclicSector

UNCHECKED = (
    "The curve of the mistuned disk was computed with harmonics = {harmonics}, without an estimate of the error: "
    "repeat it with more harmonics. Its stability is not computed: parts of it may be motions that do not last. Peaks "
    "were searched at the natural frequencies of the stuck and of the free disk, not at those of the disk whose "
    "contacts partly slip: repeat it with a smaller largest_step."
)
LIMITS = ("stuck", "free")


@dataclass(frozen=True)
class MistunedResponse:
    """The curve of a mistuned disk.

    Attributes
    ----------
    frequency_hz:
        (n_points,) along the curve, may fold.
    amplitude:
        (n_points, N) m, 0-to-peak with the mean, of the output in each sector.
    converged, message:
        whether the curve reaches its end, and a message.
    iterations:
        of Newton's method, weighted with the harmonics.
    peaks:
        the search for peaks between points; None if the curve does not reach its end.
    warnings:
        what is not known of the curve.
    """

    frequency_hz: FloatArray
    amplitude: FloatArray
    converged: bool
    message: str
    iterations: int
    peaks: PeakCheck | None
    warnings: tuple[str, ...] = ()

    __repr__ = short_repr


@dataclass(frozen=True)
class _Resonances:
    """The natural frequencies of both linear limits, which no step crosses unseen."""

    marks: Sequence[Landmark]

    def of(self, point: BalancePoint) -> Sequence[Landmark]:
        """The same at each point."""
        return self.marks


def mistuned_response(
    sector: CyclicSector,
    blade: BladeAlone,
    deviations: ArrayLike,
    pairs: ContactPairs | Sequence[ContactPairs],
    wave: Excitation,
    output: ArrayLike,
    *,
    frequency_hz: tuple[float, float],
    modal_damping_ratio: float,
    harmonics: int = 3,
    samples: int = 256,
    newton: NewtonSettings | None = None,
    continuation: ContinuationSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
    raise_on_failure: bool = False,
) -> MistunedResponse:
    """Follow the response of a mistuned disk with friction along the frequency.

    The equations are those of ``full_ring(sector).mistuned(blade, deviations)``, in the waves of the tuned disk: no
    matrix has the size of the ring (docs/theory_mistuning.md). Viscous damping is that of the tuned disk.

    Parameters
    ----------
    sector, blade, deviations:
        as for :meth:`FullRing.mistuned`; deviations of one pattern.
    pairs:
        those of one sector, or of each; their springs at rest are the same, friction and normal loads may differ.
    wave:
        :meth:`Excitation.travelling_wave`, first harmonic only.
    output:
        (n,) or (2n,) the displacement of a sector whose amplitude is computed, such as ``CyclicSector.selector``.
    frequency_hz, modal_damping_ratio, harmonics, samples, newton, continuation, threads, progress:
        as for :func:`forced_response`.
    raise_on_failure:
        whether a curve that ends early is an error instead of a warning.

    Raises
    ------
    InputError
        for a sector without some nodal diameters or with damping matrices, arrays of another shape, a deviation above
        0.3, pairs with other springs, and an excitation that does not travel. ConvergenceError without a first point,
        and instead of a warning with ``raise_on_failure``.
    """
    result = unreported_mistuned(
        sector, blade, deviations, pairs, wave, output, frequency_hz=frequency_hz,
        modal_damping_ratio=modal_damping_ratio, harmonics=harmonics, samples=samples, newton=newton,
        continuation=continuation, threads=threads, progress=progress,
    )  # fmt: skip
    return reported(result, raise_on_failure)


def unreported_mistuned(
    sector: CyclicSector, blade: BladeAlone, deviations: ArrayLike, pairs: ContactPairs | Sequence[ContactPairs],
    wave: Excitation, output: ArrayLike, *, frequency_hz: tuple[float, float], modal_damping_ratio: float,
    harmonics: int, samples: int, newton: NewtonSettings | None, continuation: ContinuationSettings | None,
    threads: int | None, progress: ProgressCallback | None,
) -> MistunedResponse:  # fmt: skip
    """:func:`mistuned_response`, for a caller that reports a curve that ends early itself."""
    require_modes_without_coupling(sector)
    check_options(harmonics, samples, "tractrix", modal_damping_ratio)
    positive_number("modal_damping_ratio", modal_damping_ratio)
    start, stop = (2.0 * np.pi * each for each in checked_window(frequency_hz))
    row = row_of_sector("output", output, sector)
    of_sectors = pairs_of_sectors(pairs, sector)
    travels = travelling(wave)
    force = ring_force(force_on_sector(sector, wave, travels, harmonics).coefficients(1.0), travels, sector.sectors)
    report, settings, newton = StageReport(progress), continuation or ContinuationSettings(), newton or NewtonSettings()
    pattern = finite_array("deviations", deviations)
    limits = [
        TunedDisk.of(sector, blade, wave, row.reshape(2, -1), TAKES_PART * max(start, stop), contact)
        for contact in (of_sectors[0], None)
    ]
    with solver_threads(thread_count(threads)):
        report.stage(f"waves of the disk, {sector.sectors} of {sector.size} unknowns", 0.0)
        ring = stuck_ring(sector, blade, pattern, of_sectors, row, max(start, stop), modal_damping_ratio)
        balance = ring.balance(force, samples)
        work = Work(2 * harmonics + 1, WORK_PER_POINT * settings.max_points)
        curve = FrequencyCurve(balance, work=work)
        solver = Newton(curve, newton, report.iteration)
        marks = [
            Landmark(float(omega), 2.0 * modal_damping_ratio * float(omega))
            for disk in limits
            for omega in disk.natural_omega(blade.stiffness_changes(pattern, sector.sectors))
            if omega > 0.0
        ]

        def listen(event: object) -> None:
            if isinstance(event, Accepted):
                at = float(event.point.trial.omega)
                report.stage(f"{at / (2.0 * np.pi):.2f} Hz", abs(at - start) / abs(stop - start))

        first, how = first_point(solver, curve, start, lambda few: ring.balance(force.with_harmonics(few), samples))
        branch = Branch(solver, first, stop, settings, listen, _Resonances(marks), work=work)
        branch.follow()
        peaks = search_missed_peaks(solver, [each.point for each in branch.points], marks) if branch.complete else None
        trials = [each.point.trial for each in branch.points]
        amplitude = [periodic_amplitude(ring.outputs(each.amplitude, each.deviation).T) for each in trials]
    searched = "" if peaks is None else f" Search for missed peaks: {peaks.words(LIMITS)}."
    warnings = () if peaks is None else peaks.warnings()
    neighbours = neighbour_warnings(_hz(branch.retreats), _hz(branch.corners), branch.crossings)
    return MistunedResponse(
        np.array([each.omega for each in trials]) / (2.0 * np.pi), np.array(amplitude), branch.complete,
        f"{how} {branch.message}{searched}", round(work.total), peaks,
        (UNCHECKED.format(harmonics=harmonics), *warnings, *neighbours),
    )  # fmt: skip


def _hz(omega: Sequence[float]) -> list[float]:
    return [each / (2.0 * np.pi) for each in omega]
