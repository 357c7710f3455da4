"""The forced responses of many small structures at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import InputError
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.batch import BatchCurve, BatchResponse
from stickslip.solve.batch.curve_points import CurvePoints
from stickslip.solve.batch.curve_results import curve_alone, curve_of
from stickslip.solve.batch.equations import StackedBalance
from stickslip.solve.batch.following import follow
from stickslip.solve.batch.outputs import Outputs
from stickslip.solve.batch.peaks import with_peaks
from stickslip.solve.forced import DEFAULT_HARMONICS
from stickslip.solve.harmonic.walk import LARGEST_WALK
from stickslip.solve.setting_up import Balances, checked_window, prepare_balances
from stickslip.solve.solver_input import SolverInput

# chosen: curves in one lockstep. A curve of the blade with 10 contacts takes 82 ms among 32, 75 among 64, 73 among 128
# and 67 ms among 256; more would only take more memory.
MOST_TOGETHER = 256
# chosen: with more modes that damping couples, the inverse of their matrix at each frequency takes longer than all else
# (60 modes: 0.5 ms, 108 modes: 2 ms or more, where an iteration of an ordinary curve takes 1.3 to 3 ms).
MOST_COUPLED_MODES = 60
COUPLED = f"Damping couples more than {MOST_COUPLED_MODES} modes, which takes longer in a batch than alone."


def batch_response(
    inputs: Sequence[SolverInput],
    *,
    frequency_hz: tuple[float, float],
    harmonics: int = DEFAULT_HARMONICS,
    samples: int = 256,
    update: Update = "tractrix",
    threads: int | None = None,
) -> BatchResponse:
    """Follow the periodic responses of many small structures along the frequency, all of them in lockstep.

    Solves for each input what :func:`forced_response` solves: ``M u'' + C u' + K u + B^T f(B u) = p(t)`` by harmonic
    balance, along the frequency by pseudo-arc length. Each operation acts on the arrays of all curves, so that the time
    of Python counts once for all; a curve does not depend on the others. docs/scaling.md says for which sizes this
    pays. There are no multipliers, no search for missed peaks, no estimate of the error by harmonics and samples.

    Parameters
    ----------
    inputs:
        the structure, joint, excitation, output and damping of each curve. All have the same number of unknowns and of
        pairs, Coulomb friction in all pairs, and no gyroscopic matrix.
    frequency_hz:
        (start, stop) of the first harmonic; start above stop sweeps downward.
    harmonics, samples, update, threads:
        as in :func:`forced_response`.

    Returns
    -------
    BatchResponse
        with one curve for each input. The highest peak of each output has a point at its maximum: the amplitude is
        exact to 1e-4, but for the ripple of the sampled force (below 1e-3 with 64 samples). A curve that the batch
        loses is solved by :func:`forced_response` without checks; ``alone`` gives the reason.

    Raises
    ------
    InputError
        for inputs that cannot be used, before the first curve is computed.
    """
    window = checked_window(frequency_hz)
    threads = thread_count(threads)
    rows = _checked(inputs)
    omega = (2.0 * np.pi * window[0], 2.0 * np.pi * window[1])
    with solver_threads(threads):
        curves = _prepared(inputs, max(omega), harmonics, samples, update)
        sentences = [" ".join(each.unbounded(window)) for each in curves]
        answers: dict[int, BatchCurve | str] = {
            place: COUPLED for place, each in enumerate(curves) if not _pays_together(each)
        }
        for places in _groups(curves, [place for place in range(len(curves)) if place not in answers]):
            group = _solved([curves[i] for i in places], [rows[i] for i in places], omega, harmonics)
            answers.update(zip(places, group, strict=True))
    results = []
    for place, balances in enumerate(curves):
        answer = answers[place]
        if isinstance(answer, str):
            answer = curve_alone(balances, rows[place], window, harmonics, threads, answer)
        results.append(replace(answer, message=" ".join(filter(None, [answer.message, sentences[place]]))))
    return BatchResponse(tuple(results), harmonics, samples)


def _checked(inputs: Sequence[SolverInput]) -> list[FloatArray]:
    """The rows of the outputs. Raises InputError for inputs that a batch cannot contain."""
    if not inputs:
        raise InputError("inputs is empty; give at least one SolverInput.", arguments=["inputs"])
    first, rows = inputs[0], []
    for place, each in enumerate(inputs):
        for name, value, other in (
            ("pairs", each.pairs.n_pairs, first.pairs.n_pairs),
            ("unknowns", each.superelement.size, first.superelement.size),
        ):
            if value != other:
                raise _rejected(
                    place, f"has {value} {name}, but inputs[0] has {other}", "give a batch equal numbers, or several"
                )
        if not each.pairs.is_coulomb:
            laws = ", ".join(each.pairs.law_names)
            raise _rejected(place, f"has pairs with the law(s) {laws}", "a batch requires Coulomb friction")
        if each.superelement.gyroscopic is not None:
            raise _rejected(place, "has a gyroscopic matrix", "solve it by forced_response")
        if each.structure is not None:
            raise _rejected(place, "has a structure beside its superelement", "give the superelement alone")
        row = finite_array("output", each.output)
        if row.shape != (each.superelement.size,):
            raise _rejected(
                place, f"has an output of shape {row.shape}", f"it must be a row of {each.superelement.size} unknowns"
            )
        rows.append(row)
    return rows


def _rejected(place: int, fault: str, remedy: str) -> InputError:
    return InputError(f"inputs[{place}] {fault}; {remedy}.", arguments=["inputs"])


def _prepared(
    inputs: Sequence[SolverInput], highest_omega: float, harmonics: int, samples: int, update: Update
) -> list[Balances]:
    """The balances of all inputs. Raises InputError."""
    answer: list[Balances] = []
    known = None
    for each in inputs:
        balances = prepare_balances(
            each.superelement, each.pairs, each.excitation, highest_omega, harmonics, samples,
            each.modal_damping_ratio, update, lambda words: None, known,
        )  # fmt: skip
        known = balances.stuck
        answer.append(balances)
    return answer


def _pays_together(curve: Balances) -> bool:
    damping = curve.stuck.modal_damping
    return damping.ndim == 1 or len(damping) <= MOST_COUPLED_MODES


def _groups(curves: Sequence[Balances], chosen: Sequence[int]) -> list[list[int]]:
    """Chosen curves that are solved together: with retained tractions or none; damping that couples modes or none."""

    def kind(place: int) -> tuple[bool, int]:
        return curves[place].pairs.released, curves[place].stuck.modal_damping.ndim

    groups = [list(places) for _, places in groupby(sorted(chosen, key=kind), kind)]
    return [each[i : i + MOST_TOGETHER] for each in groups for i in range(0, len(each), MOST_TOGETHER)]


def _solved(
    curves: Sequence[Balances], rows: Sequence[FloatArray], omega: tuple[float, float], harmonics: int
) -> list[BatchCurve | str]:
    """The curves of a group, or the reasons why they have to be solved alone."""
    balance, outputs = StackedBalance.of(curves, harmonics), Outputs.of(curves, rows)
    followed = follow(balance, [each.landmarks() for each in curves], omega)
    reasons = [
        reason or _walk_of(each, points)
        for reason, each, points in zip(followed.reasons, curves, followed.points, strict=True)
    ]
    complete = [place for place, reason in enumerate(reasons) if not reason]
    width = abs(omega[1] - omega[0])
    points, peak_reasons = with_peaks(balance, outputs, followed.points, complete, width)
    return [
        reason or peak_reason or curve_of(outputs, place, own)
        for place, (reason, peak_reason, own) in enumerate(zip(reasons, peak_reasons, points, strict=True))
    ]


def _walk_of(curve: Balances, points: CurvePoints) -> str:
    """The reason to solve a curve alone on which a body walks; empty for others."""
    ways = np.linalg.norm(curve.pairs.walk(points.relative[:, :, 0]), axis=2).max(axis=1)
    motions = np.abs(points.relative[:, :, 1:]).max(axis=(1, 2))
    walks = bool((ways > LARGEST_WALK * motions).any())
    return "A body that friction alone supports slides on from cycle to cycle." if walks else ""
