"""The forced response of a structure with friction joints: one call from matrices to a labelled curve."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import blas_threads, thread_count
from stickslip.results.response import ForcedResponse
from stickslip.solve.curve_result import follower, response_of
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.missed_peaks import search_missed_peaks
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.harmonic.unbounded import unbounded_motions
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import StageReport, checked_window, prepare_balances
from stickslip.solve.traction_band import TractionBandSearch, checked_band_output
from stickslip.structure.superelement import Superelement


def forced_response(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation | ArrayLike | None = None,
    force_sin: ArrayLike | None = None,
    *,
    force_cos: ArrayLike | None = None,
    frequency_hz: tuple[float, float],
    harmonics: int = 5,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    continuation: ContinuationSettings | None = None,
    traction_band: ArrayLike | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
) -> ForcedResponse:
    """Follow the periodic response to a harmonic excitation along the frequency.

    Solves ``M u'' + C u' + K u + B^T f(B u) = p(t)`` by harmonic balance (mean and ``harmonics`` harmonics), with the
    friction force of ``pairs`` sampled ``samples`` times a period in its periodic state, along the frequency by
    pseudo-arc length. Theory: docs/theory.md.

    Parameters
    ----------
    superelement:
        (n, n) matrices in SI units, without contact stiffness.
    pairs:
        the joint, with ``operator`` of shape (3 * n_pairs, n).
    excitation, force_sin, force_cos:
        an :class:`Excitation`; or, in its place or by name as ``force_cos``, the force
        ``p(t) = sum_k cos[:, k-1] cos(k w t) + sin[:, k-1] sin(k w t)`` as arrays in N, (n,) for the first harmonic or
        (n, n_harmonics) for several. ``force_sin`` None means zero.
    frequency_hz:
        (start, stop) of the first harmonic; start above stop sweeps downward.
    harmonics, samples:
        harmonics of the solution and time samples; ``samples >= 2 * harmonics + 1``, 256 for smooth curves, 512 with
        much separation.
    modal_damping_ratio:
        the same ratio for every mode of the stuck structure, instead of a damping matrix in ``superelement``.
    update:
        "tractrix" (second order) or "radial" return of the friction law.
    newton, continuation:
        tolerances and step control.
    traction_band:
        row (n,) of an output: compute how far the curve around the peak of this output can move with the residual
        tractions of its pairs (``response.traction_band``), several times as long as the curve itself takes.
    threads:
        threads of the linear algebra, used where the joint is large enough; None takes the environment variable
        STICKSLIP_THREADS, or else the usable cores, at most 4.
    progress:
        called with the finished fraction of the window and a message.

    Returns
    -------
    ForcedResponse
        with Floquet multipliers of every point and whether it is ``stable``, if all laws have ``linear_steps``. Also if
        the curve ends early: ``converged`` is then False and ``message`` gives the frequency and the reason; all its
        points are converged.

    Raises
    ------
    InputError
        for inputs that cannot be used, and for a resonance in the range that neither damping nor friction bounds.
        ConvergenceError if there is no first point.
    """
    began = time.perf_counter()
    window = checked_window(frequency_hz)
    threads = thread_count(threads)
    excitation = as_excitation(excitation, force_sin, force_cos)
    band_output = None if traction_band is None else checked_band_output(pairs, traction_band, superelement.size)
    newton = newton or NewtonSettings()
    settings = continuation or ContinuationSettings()
    report = StageReport(progress)
    start_omega, stop_omega = (2.0 * np.pi * f for f in window)
    with threadpool_limits(limits=blas_threads(3 * pairs.n_pairs, threads)):
        balances = prepare_balances(
            superelement, pairs, excitation, max(start_omega, stop_omega), harmonics, samples, modal_damping_ratio,
            update, report.stage,
        )  # fmt: skip
        unbounded = unbounded_motions(balances.free, balances.closed, pairs, balances.force, window)
        curve = FrequencyCurve(balances.with_harmonics(harmonics))
        solver = Newton(curve, newton, report.iteration)
        resonances = Resonances(balances.closed, balances.free, balances.stuck, balances.force)

        def walk(point: BalancePoint) -> Branch[BalancePoint]:
            return Branch(solver, point, start_omega, settings, landmarks=resonances)

        report.stage("first point")
        start, how = first_point(solver, curve, start_omega, balances.with_harmonics, walk)
        branch = Branch(solver, start, stop_omega, settings, follower(window, report), resonances)
        branch.follow()
        report.stage("search for missed peaks")
        peaks = search_missed_peaks(solver, [each.point for each in branch.points], resonances.seen)
        response = response_of(branch, balances, curve.balance, window, newton, how, report, peaks=peaks)
        if band_output is not None:
            search = TractionBandSearch(
                balances, harmonics, resonances, (start_omega, stop_omega), band_output, newton, settings, report
            )
            band = search.band([each.point for each in branch.points])
            response = replace(response, traction_band=band, warnings=(*response.warnings, *search.warnings))
    seconds = {"solve_seconds": f"{time.perf_counter() - began:.2f}"}
    return replace(response, warnings=unbounded + response.warnings, provenance=seconds)


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
    if cosine is None or (excitation is not None and force_cos is not None):
        raise InputError("give the excitation once: an Excitation, or the cosine part of a force as an array (n,).")
    return Excitation.force(cosine, force_sin)
