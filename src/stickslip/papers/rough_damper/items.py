"""Common parts of the items of the page: their form, and their curves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from stickslip.case.case import TwoBladeCase
from stickslip.papers.rough_damper.claim_list import CLAIMS
from stickslip.papers.rough_damper.claims import MICRO, Solutions, friction_energy
from stickslip.papers.rough_damper.plan import BASE_CHOICE
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.tables import Cell, Table, columns
from stickslip.papers.rough_damper.verdicts import Judgement

# Readings of a curve beside the highest peak on it.
SWEEPS = {"up": "slow sweep up", "down": "slow sweep down"}


@dataclass(frozen=True)
class Picture:
    """A figure of the page: its name, what it shows in words, and the table with its numbers."""

    name: str
    words: str
    table: str


@dataclass(frozen=True)
class Item:
    """One item of the page; ``judgements`` are questions with their verdicts."""

    anchor: str
    title: str
    statement: str
    notes: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[Picture, ...] = ()
    judgements: tuple[tuple[str, Judgement], ...] = ()


@dataclass(frozen=True)
class ModelClaim:
    """A claim that the model decides before any vibration.

    statement, place:
        the claim in our words, and the item of the page that judges it.
    depends_on:
        keys of the study file among the choices that can change its verdict.
    reason:
        why the other choices cannot.
    judged:
        the verdict for a case and curves of it.
    """

    statement: str
    place: str
    depends_on: frozenset[str]
    reason: str
    judged: Callable[[TwoBladeCase, Solutions], Judgement]


def judged(solutions: Solutions, *names: str) -> tuple[tuple[str, Judgement], ...]:
    """The statements of these claims with the verdicts of these curves, and where a slow sweep has another one, it."""
    by_name = {claim.name: claim for claim in CLAIMS}
    rows = []
    for claim in (by_name[name] for name in names):
        verdict = claim.judged(solutions)
        rows.append((claim.statement, verdict))
        for reading, words in SWEEPS.items():
            other = claim.judged(seen(solutions, reading))
            if other.verdict is not verdict.verdict:
                rows.append((f"{claim.statement} Of a {words}:", other))
    return tuple(rows)


def seen(solutions: Solutions, reading: str) -> list[Solved]:
    """The curves as a reading sees them, without those that it does not see at all."""
    answers = (one.seen_by(reading) for one in solutions)
    return [one for one in answers if one is not None]


def base(solutions: Solutions, law: str = "consistent") -> list[Solved]:
    """The curves without a varied choice, under one law."""
    return [one for one in solutions if one.setting.choice == BASE_CHOICE and one.setting.law == law]


def peak_table(name: str, caption: str, solutions: Solutions) -> Table:
    """Peak, frequency, states and energies of curves."""
    rows: list[tuple[Cell, ...]] = []
    for one in solutions:
        s, n = one.setting, one.numbers
        rows.append(
            (
                s.choice,
                s.excitation,
                s.force,
                s.load,
                s.dimension,
                s.scale,
                s.law,
                n["normal_stiffness"],
                MICRO * n["peak_m"],
                n["peak_hz"],
                *(value for reading in SWEEPS for value in _peak_of(one.seen_by(reading))),
                MICRO * n["stuck_peak_m"],
                100.0 * n["equivalent_damping"],
                n["first_stuck_hz"],
                n["second_stuck_hz"],
                int(n["stuck"]),
                int(n["stick_slip"]),
                int(n["separating"]),
                MICRO * friction_energy(one),
                MICRO * n["viscous_energy_j"],
            )
        )
    return Table(
        name,
        caption,
        columns(
            "choice||Choice",
            "excitation||Excitation",
            "force|N|Force",
            "load|N|F_N",
            "dimension||D",
            "scale|m|G",
            "law||Law",
            "normal_stiffness|N/m|K_n of a face",
            "peak|um|Highest peak",
            "peak_frequency|Hz|at",
            "upward_peak|um|Peak, slow sweep up",
            "upward_frequency|Hz|at",
            "downward_peak|um|Peak, slow sweep down",
            "downward_frequency|Hz|at",
            "stuck_peak|um|Peak, linear stuck",
            "equivalent_damping|%|Equivalent damping",
            "first_stuck|Hz|Stuck mode 1",
            "second_stuck|Hz|Stuck mode 2",
            "stuck||Stuck",
            "stick_slip||Stick-slip",
            "separating||Separating",
            "friction_energy|uJ|Friction energy",
            "viscous_energy|uJ|Viscous energy",
        ),
        tuple(rows),
    )


def _peak_of(one: Solved | None) -> tuple[float, float]:
    """µm and Hz of the peak, not a number for a sweep without a stable point."""
    return (float("nan"), float("nan")) if one is None else (MICRO * one.numbers["peak_m"], one.numbers["peak_hz"])
