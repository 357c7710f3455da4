"""The item that judges: the conclusions claim by claim."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.case.case import TwoBladeCase
from stickslip.papers.rough_damper.choice_items import ChangedVerdict
from stickslip.papers.rough_damper.claims import CLAIMS, Solutions
from stickslip.papers.rough_damper.items import Item, base
from stickslip.papers.rough_damper.model_items import MODEL_CLAIMS
from stickslip.papers.rough_damper.tables import Cell, Table, columns
from stickslip.papers.rough_damper.verdicts import Answer, Judgement

# What explains a verdict and does not depend on the numbers of a run, for the claims that need it.
REMARKS = {
    "Opposite directions rotate the damper.": "Mirrored blades that move as mirror images cannot rotate a damper that "
    "mirrors itself: it moves up and down. A rotation requires a structure or a load without that symmetry.",
    "The peak falls as D grows.": "Larger D means stiffer, not rougher. Under opposite forces the second mode moves "
    "little at the position of the force for stiff faces, so its peak depends more on that position than on friction.",
    "The peak falls as G falls.": "Smaller G means stiffer, not rougher; for opposite forces see D.",
    "The energy grows with D (at one frequency).": "Peaks move by more than their width, so the fixed frequency "
    "decides this.",
    "The energy first rises, then falls with D (at one frequency).": "The same: the curve that resonates at the fixed "
    "frequency has the most.",
    "A larger D or a smaller G raises Sq or Sdq.": "Both reduce the height of each wave longer than G.",
}

Judged = tuple[str, str, Judgement]  # statement, place in the paper, verdict


def judged_claims(case: TwoBladeCase, solutions: Solutions) -> list[Judged]:
    """Every claim: those about the vibration, and those that the model decides alone."""
    chosen = base(solutions)
    results = [(claim.statement, claim.place, claim.judged(chosen)) for claim in CLAIMS]
    return results + [(claim.statement, claim.place, claim.judged(case, chosen)) for claim in MODEL_CLAIMS]


def conclusions_item(claims: Sequence[Judged], changed: Sequence[ChangedVerdict]) -> Item:
    """Conclusions 1 to 4: a row for each claim."""
    sensitive = {each.statement: each.changes_with for each in changed}
    rows: list[tuple[Cell, ...]] = [
        (
            statement,
            place,
            _examples(judged),
            judged.verdict.value,
            f"{judged.reason} {REMARKS.get(statement, '')}".strip(),
            sensitive[statement],
        )
        for statement, place, judged in claims
    ]
    table = Table(
        "conclusions",
        "Claims, numbers of stickslip, verdicts",
        columns(
            "claim||Claim",
            "place||In the paper",
            "numbers||Numbers of stickslip",
            "verdict||Verdict",
            "why||Why",
            "changes_with||Another verdict with",
        ),
        tuple(rows),
    )
    return Item(
        "conclusions",
        "Conclusions 1 to 4, claim by claim",
        "Same direction translates the damper and slips most; less load, larger D and smaller G give more slip, a "
        "lower peak and more energy.",
        (
            "Each verdict follows from all base curves under the consistent law; answers.csv has the answers behind "
            "it. The last column names the varied choices with another verdict, see the next item.",
        ),
        (table,),
    )


def _examples(judged: Judgement) -> str:
    """The first answer for and the first against, in words."""
    decided = [answer for answer in judged.answers if answer.holds is not None]
    chosen = [next((a for a in decided if a.holds is wanted), None) for wanted in (True, False)]
    return " | ".join(
        f"{'for' if answer.holds else 'against'}: {_situation(answer)}: {answer.numbers}" for answer in chosen if answer
    )


def _situation(answer: Answer) -> str:
    return ", ".join(
        value if name in ("excitation", "law") else f"{name} {value}" for name, value in answer.where.items()
    )


def answers_table(solutions: Solutions) -> Table:
    """Every answer behind every verdict."""
    rows: list[tuple[Cell, ...]] = []
    for claim in CLAIMS:
        for answer in claim.judged(base(solutions)).answers:
            verdict = {True: "yes", False: "no", None: "no answer"}[answer.holds]
            rows.append((claim.name, _situation(answer), verdict, answer.numbers))
    return Table(
        "answers",
        "All situations in which a claim was checked",
        columns("claim||Claim", "situation||Situation", "holds||Holds", "numbers||Numbers"),
        tuple(rows),
    )
