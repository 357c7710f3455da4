"""The forced response of a structure with friction joints: one call from matrices to a labelled curve."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.completeness import reported
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.resolution import COARSEST_ACCURACY, FINEST_ACCURACY, LEAST_SAMPLES, SAMPLES_PER_HARMONIC
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import real_number, require_allowed, whole_number
from stickslip.results.response import ForcedResponse
from stickslip.solve.curve_result import follower, response_of
from stickslip.solve.curve_structures import CurveInput, curve_structure
from stickslip.solve.evidence import Settling
from stickslip.solve.excitation import Excitation, force_of_arrays
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.checks import points_at_peak
from stickslip.solve.harmonic.curves import BalancePoint, BalancePointT, FrequencyCurve
from stickslip.solve.harmonic.missed_peaks import search_missed_peaks
from stickslip.solve.harmonic.neglected import CurveAccuracy
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.harmonic.varying_harmonics import LEAST_HARMONICS, HarmonicsByAccuracy, VaryingPoint
from stickslip.solve.lent_harmonics import LentHarmonics, LentNumbers
from stickslip.solve.output_maxima import AddedMaxima, OutputMaxima, output_rows
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.path.work import Work
from stickslip.solve.pieces import Pieces
from stickslip.solve.setting_up import Balances, StageReport, checked_window
from stickslip.solve.sharp_peaks import sharpen
from stickslip.solve.tractions.traction_band import DEFAULT_STARTS, TractionBandSearch
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.substructure import Substructure
from stickslip.structure.superelement import Superelement

# The number of harmonics if neither it nor an accuracy is given.
DEFAULT_HARMONICS = 5
NO_CHECKS = "No multipliers were computed, because checks are omitted."
# chosen: allowed work on a curve, in iterations of Newton's method, for each allowed point of a branch. Complete curves
# with rigid free dampers, the hardest class of the torture set, take 950 in the median and up to 11,900.
WORK_PER_POINT = 7


def forced_response(
    superelement: Superelement | CyclicSector,
    pairs: ContactPairs,
    excitation: Excitation | ArrayLike | None = None,
    force_sin: ArrayLike | None = None,
    *,
    force_cos: ArrayLike | None = None,
    frequency_hz: tuple[float, float],
    harmonics: int | None = None,
    accuracy: float | None = None,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    continuation: ContinuationSettings | None = None,
    traction_band: ArrayLike | None = None,
    traction_starts: int = DEFAULT_STARTS,
    outputs: ArrayLike | None = None,
    checks: bool = True,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
    raise_on_failure: bool = False,
) -> ForcedResponse:
    """Follow the periodic response to a harmonic excitation along the frequency.

    Solves ``M u'' + C u' + K u + B^T f(B u) = p(t)`` by harmonic balance (a mean and harmonics), with the friction
    force of ``pairs`` sampled ``samples`` times a period in its periodic state, along the frequency by pseudo-arc
    length. Theory: docs/theory.md.

    Parameters
    ----------
    superelement:
        (n, n) matrices in SI units, without contact stiffness. Or a :class:`CyclicSector` for a whole disk of equal
        sectors under :meth:`Excitation.travelling_wave` (docs/theory_cyclic.md): the unknowns of the response are then
        those of this sector and of the next one, 2n in all, and energies are those of one sector.
    pairs:
        the joint, with ``operator`` of shape (3 * n_pairs, n); on a sector (3 * n_pairs, 2n) if pairs have a side in
        the next one.
    excitation, force_sin, force_cos:
        an :class:`Excitation`; or, in its place or by name as ``force_cos``, the force
        ``p(t) = sum_k cos[:, k-1] cos(k w t) + sin[:, k-1] sin(k w t)`` as arrays in N, (n,) for the first harmonic or
        (n, n_harmonics) for several. ``force_sin`` None means zero.
    frequency_hz:
        (start, stop) of the first harmonic; start above stop sweeps downward.
    harmonics:
        harmonics of the solution, 5 if neither they nor ``accuracy`` are given.
    accuracy:
        instead of ``harmonics``: each point has as many as it requires, so that its estimated error by neglected
        harmonics is below this fraction of its motion, for example 0.005 (``response.estimated_error``).
    samples:
        time samples of a period; ``samples >= 2 * harmonics + 1``, and at least 64 with ``accuracy``; 256 for smooth
        curves, 512 with much separation.
    modal_damping_ratio:
        the same ratio for every mode of the stuck structure, instead of a damping matrix in ``superelement``.
    update:
        "tractrix" (second order) or "radial" return of the friction law.
    newton, continuation:
        tolerances and step control.
    traction_band:
        row (n,) of an output: compute how far the curve around the peak of this output can move with the residual
        tractions of its pairs (``response.traction_band``), several times as long as the curve itself takes.
    traction_starts:
        random tractions from which the band is optimised, beside zero and the extreme ones to first order.
    outputs:
        row (n,) of an output, or rows (n_outputs, n): where the amplitude of one of them has a maximum between two
        points, at least 1 % above both, the curve gets a point. Steps follow the vibration of the whole structure, so
        an output that moves little may have such a maximum. None looks for none; studies give all of theirs.
    checks:
        False omits the Floquet multipliers and the search for peaks that the curve missed: for curves that only show
        the effect of an input beside one with these checks.
    threads:
        threads that share pairs and points, and those of the linear algebra of a large joint; None takes the
        environment variable STICKSLIP_THREADS, or else the usable cores, at most 4.
    progress:
        called with the finished fraction of the window and a message.
    raise_on_failure:
        true: ConvergenceError for a curve that ends early; false: NotConvergedWarning.

    Returns
    -------
    ForcedResponse
        with Floquet multipliers of every point and whether it is ``stable``, if all laws have ``linear_steps`` and
        ``checks`` is true. Of a curve that ends early ``converged`` is False and ``message`` gives the frequency and
        the reason; all its points are converged.

    Raises
    ------
    InputError
        for inputs that cannot be used, and for a resonance in the range that neither damping nor friction bounds.
    ConvergenceError
        if there is no first point, and for a curve that ends early with ``raise_on_failure``.
    """
    response = unreported_response(
        superelement, pairs, as_excitation(excitation, force_sin, force_cos), frequency_hz=frequency_hz,
        harmonics=harmonics, accuracy=accuracy, samples=samples, modal_damping_ratio=modal_damping_ratio, update=update,
        newton=newton, continuation=continuation, traction_band=traction_band, traction_starts=traction_starts,
        outputs=outputs, checks=checks, threads=threads, progress=progress,
    )  # fmt: skip
    return reported(response, raise_on_failure)


def unreported_response(
    superelement: Substructure, pairs: ContactPairs, excitation: Excitation, *,
    frequency_hz: tuple[float, float], harmonics: int | None, accuracy: float | None, samples: int,
    modal_damping_ratio: float | None, update: Update, newton: NewtonSettings | None,
    continuation: ContinuationSettings | None, traction_band: ArrayLike | None, traction_starts: int,
    outputs: ArrayLike | None, checks: bool, threads: int | None, progress: ProgressCallback | None,
    few_digits: NewtonSettings | None = None,
) -> ForcedResponse:  # fmt: skip
    """:func:`forced_response`, for a caller that reports a curve that ends early itself.

    ``few_digits`` is for one of many curves with fixed harmonics: Newton's method has these settings along the curve,
    and those of ``newton`` at its highest points only; the points before pairs move need no iteration; and samples and
    harmonics are checked at the peak, not over the whole curve.
    """
    began = time.perf_counter()
    window = checked_window(frequency_hz)
    threads = thread_count(threads)
    whole_number("traction_starts", traction_starts, 0)
    structure = curve_structure(superelement)
    band_output = None if traction_band is None else structure.band_output(pairs, traction_band)
    rows = output_rows(outputs, superelement.row_size)
    newton = newton or NewtonSettings()
    settings = continuation or ContinuationSettings()
    report = StageReport(progress)
    start_omega, stop_omega = (2.0 * np.pi * f for f in window)
    least = least_harmonics(harmonics, accuracy, samples, excitation)
    with solver_threads(threads), UnboundedMotions() as motions:
        highest = max(start_omega, stop_omega)
        given = CurveInput(
            pairs, excitation, highest, least, accuracy is not None, samples, modal_damping_ratio, update
        )
        balances = structure.balances(given, report.stage)
        if band_output is not None and isinstance(balances, Balances):
            balances.require_all_modes("traction_band")  # now, not after the curve
        motions.sentences = balances.unbounded(window)
        work = Work(2 * least + 1, WORK_PER_POINT * settings.max_points)
        curve = FrequencyCurve(balances.with_harmonics(least), work=work)
        solver = Newton(curve, few_digits or newton, report.iteration)
        resonances = balances.landmarks()

        def walk(point: BalancePoint) -> Branch[BalancePoint]:
            return Branch(solver, point, start_omega, settings, landmarks=resonances, work=work)

        report.stage("first point")
        start: BalancePoint | None = None
        try:
            start, how = first_point(solver, curve, start_omega, balances.with_harmonics, walk)
        except ConvergenceError as error:
            how = str(error)
        listen = follower(window, report)

        def sharpened(
            curve: Pieces[BalancePointT],
            solver: Newton[BalancePointT],
            added: AddedMaxima,
            begin: Callable[[BalancePointT], None] = lambda point: None,
        ) -> None:
            if few_digits:
                highest = points_at_peak([each.point.trial for each in curve.points])
                sharp = Newton(solver.problem, newton, report.iteration)
                sharpen(curve.points, {*highest, *added.highest}, sharp, abs(stop_omega - start_omega), begin)

        def finished(
            curve: Pieces[BalancePointT],
            solver: Newton[BalancePointT],
            balance: Balance,
            added: AddedMaxima,
            reached: CurveAccuracy | None = None,
            begin: Callable[[BalancePointT], None] = lambda point: None,
            lent: LentNumbers | None = None,
        ) -> ForcedResponse:
            peaks = None
            if checks:
                report.stage("search for missed peaks")
                peaks = search_missed_peaks(solver, [each.point for each in curve.points], resonances.seen, begin)
            return response_of(
                curve, balances, balance, window, newton, how, report,
                peaks=peaks, added=added, accuracy=reached,
                no_stability="" if checks else NO_CHECKS,
                breaks=curve.breaks, warnings=curve.warnings, lent=lent,
                few_digits=few_digits,
            )  # fmt: skip

        settling = Settling(solver, curve, balances, report.stage, any_samples=accuracy is None)
        window_omega = (start_omega, stop_omega)
        if accuracy is None:
            lent = LentHarmonics(solver, curve, balances)

            def fixed(point: BalancePoint, stop: float) -> Branch[BalancePoint]:
                known = curve.stuck if few_digits else None
                return lent.follow(point, stop, settings, listen, resonances, known)

            pieces = Pieces(fixed, window_omega, settling).follow(start, how)
            width = abs(stop_omega - start_omega)
            if lent.has_more(pieces.points):
                mixed = cast("Pieces[VaryingPoint]", pieces)
                mixed.points = lent.lifted(pieces.points)
                mixed.warnings.append(lent.warning(mixed.points))
                added = OutputMaxima(lent.newton, balances, rows, width, work, lent.begin).add(mixed)
                sharpened(mixed, lent.newton, added, lent.begin)
                widest, numbers = lent.widest(mixed.points), lent.numbers(mixed.points)
                response = finished(mixed, lent.newton, widest, added, begin=lent.begin, lent=numbers)
            else:
                added = OutputMaxima(solver, balances, rows, width, work).add(pieces)
                sharpened(pieces, solver, added)
                response = finished(pieces, solver, curve.balance, added)
            points: Sequence[BalancePoint] = [each.point for each in pieces.points]
        else:
            varying = HarmonicsByAccuracy(
                balances.with_harmonics,
                accuracy,
                least,
                samples,
                newton,
                report.iteration,
                balances.damped_harmonics,
                work,
            )

            def by_accuracy(point: BalancePoint, stop: float) -> Branch[VaryingPoint]:
                return varying.follow(point, stop, settings, listen, resonances)

            accurate = Pieces(by_accuracy, window_omega, settling, varies=True).follow(start, how)
            added = OutputMaxima(
                varying.newton, balances, rows, abs(stop_omega - start_omega), work, varying.begin, varying.revised
            ).add(accurate)
            varying.end()
            points = accurate_points = [each.point for each in accurate.points]
            widest, reached = varying.widest(accurate_points), varying.reached(accurate_points)
            response = finished(accurate, varying.newton, widest, added, reached)
        if band_output is not None:
            resolution = response.resolution_at([int(response.amplitude(band_output).argmax())])
            search = TractionBandSearch(
                balances.of_structure().with_samples(resolution.samples), resolution.harmonics, resonances,
                window_omega, band_output, newton, settings, report, traction_starts,
            )  # fmt: skip
            band = search.band(points)
            response = replace(response, traction_band=band and band.with_harmonics(response.harmonics))
            response = replace(response, warnings=(*response.warnings, *search.warnings))
    cost = {"solve_seconds": f"{time.perf_counter() - began:.2f}", "solve_work": f"{work.total:.0f} iterations"}
    return replace(response, warnings=motions.sentences + response.warnings, provenance=response.provenance | cost)


class UnboundedMotions:
    """The ``sentences`` on motions that hardly anything bounds; a ConvergenceError inside the block ends with them."""

    def __init__(self) -> None:
        self.sentences: tuple[str, ...] = ()

    def __enter__(self) -> UnboundedMotions:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, ConvergenceError) and self.sentences:
            raise ConvergenceError(" ".join([str(error), *self.sentences])) from error


def least_harmonics(harmonics: int | None, accuracy: float | None, samples: int, excitation: Excitation) -> int:
    """The harmonics of the solution, or the fewest of it with an accuracy. Raises InputError."""
    if accuracy is None:
        return DEFAULT_HARMONICS if harmonics is None else harmonics
    if harmonics is not None:
        raise InputError(
            "harmonics and accuracy cannot both be given: a fixed number of harmonics has the accuracy that it has. "
            "Remove one of them.",
            arguments=["harmonics", "accuracy"],
        )
    value = real_number("accuracy", accuracy)
    is_possible = FINEST_ACCURACY <= value <= COARSEST_ACCURACY
    require_allowed(
        "accuracy", value, is_possible, f"a fraction from {FINEST_ACCURACY:g} to {COARSEST_ACCURACY:g}, such as 0.005"
    )
    whole_number("samples", samples, 1)
    least = max(LEAST_HARMONICS, excitation.harmonics)
    if samples < max(LEAST_SAMPLES, SAMPLES_PER_HARMONIC * least):
        raise InputError(
            f"samples is {samples}, but accuracy requires at least {max(LEAST_SAMPLES, SAMPLES_PER_HARMONIC * least)} "
            "samples per period, which resolve the harmonics that it may choose. Use 256.",
            arguments=["samples"],
        )
    return least


def as_excitation(
    excitation: Excitation | ArrayLike | None, force_sin: ArrayLike | None, force_cos: ArrayLike | None
) -> Excitation:
    """The excitation, or that of arrays of force. Raises InputError for both or neither."""
    if isinstance(excitation, Excitation):
        if force_sin is not None or force_cos is not None:
            raise InputError(
                "force_cos and force_sin belong to a force given as arrays; an Excitation has its own force.",
                arguments=["force_cos", "force_sin"],
            )
        return excitation
    cosine = force_cos if excitation is None else excitation
    if cosine is None:
        raise InputError("give an excitation: an Excitation, or the cosine part of a force as an array (n,).")
    if excitation is not None and force_cos is not None:
        raise InputError("give the excitation once: an Excitation, or the cosine part of a force as an array (n,).")
    return force_of_arrays(cosine, force_sin, ("force_cos", "force_sin"))
