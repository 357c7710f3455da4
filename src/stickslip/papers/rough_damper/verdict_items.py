"""The item that judges: the conclusions claim by claim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stickslip.case.case import TwoBladeCase
from stickslip.papers.rough_damper.choice_items import ChangedVerdict
from stickslip.papers.rough_damper.claim_list import CLAIMS
from stickslip.papers.rough_damper.claims import Claim, Solutions
from stickslip.papers.rough_damper.further_claims import rotation_words
from stickslip.papers.rough_damper.items import SWEEPS, Item, base, seen
from stickslip.papers.rough_damper.model_items import MODEL_CLAIMS
from stickslip.papers.rough_damper.tables import Cell, Table, columns
from stickslip.papers.rough_damper.verdicts import Answer, Judgement, Verdict

# Verdict -> largest number of lines of the summary above all items.
_SUMMARY_LINES = {Verdict.DOES_NOT_HOLD: 4, Verdict.HOLDS_IF: 3, Verdict.UNDECIDED: 1}
# What the study does not compute.
LEFT_OUT = (
    "Omitted: Table 3, which lists dimensions and material of the blade (inputs, see E29), and the schematics: Figure "
    "1 (the structure), Figure 3 (the friction element), Figure 5 (the three excitations) and Figure 6 (positions of "
    "the nodes)."
)
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


@dataclass(frozen=True)
class JudgedClaim:
    """A claim, its place in the paper, its verdict by the highest peak of each curve, by the peaks of slow sweeps
    ("up" and "down"; the same where no vibration is asked), and a remark."""

    statement: str
    place: str
    judged: Judgement
    by_sweep: Mapping[str, Judgement]
    remark: str


def judged_claims(case: TwoBladeCase, solutions: Solutions) -> list[JudgedClaim]:
    """Every claim: those about the vibration, and those that the model decides alone."""
    chosen = base(solutions)
    results = [
        JudgedClaim(
            claim.statement,
            claim.place,
            claim.judged(chosen),
            {reading: claim.judged(seen(chosen, reading)) for reading in SWEEPS},
            _remark(claim, chosen),
        )
        for claim in CLAIMS
    ]
    for model_claim in MODEL_CLAIMS:
        verdict = model_claim.judged(case, chosen)
        remark = REMARKS.get(model_claim.statement, "")
        results.append(
            JudgedClaim(model_claim.statement, model_claim.place, verdict, dict.fromkeys(SWEEPS, verdict), remark)
        )
    return results


def _remark(claim: Claim, chosen: Solutions) -> str:
    motion = rotation_words(chosen) if claim.name in ("translation", "rotation", "rotation, larger") else ""
    return " ".join(filter(None, [claim.beside_words(chosen), motion, REMARKS.get(claim.statement, "")]))


def summary_lines(claims: Sequence[JudgedClaim]) -> tuple[str, ...]:
    """At most ten lines: the number of claims with each verdict, and the first claims of each verdict but "holds"."""
    by_verdict = {verdict: [each for each in claims if each.judged.verdict is verdict] for verdict in Verdict}
    counts = ", ".join(f"{len(chosen)} {verdict.value}" for verdict, chosen in by_verdict.items() if chosen)
    lines = [f"{len(claims)} claims by the highest peak on each curve: {counts}."]
    differing = _differing(claims)
    if differing:
        lines.append(f"{differing} of them have another verdict by the peaks of a slow sweep up or down.")
    for verdict, most in _SUMMARY_LINES.items():
        chosen = by_verdict[verdict]
        lines += [f"{verdict.value.capitalize()}: {each.statement}" for each in chosen[:most]]
        if len(chosen) > most:
            lines[-1] += f" And {len(chosen) - most} more of this verdict."
    return tuple(lines)


def _differing(claims: Sequence[JudgedClaim]) -> int:
    """Number of claims with another verdict by a slow sweep."""
    return sum(any(other.verdict is not each.judged.verdict for other in each.by_sweep.values()) for each in claims)


def conclusions_item(claims: Sequence[JudgedClaim], changed: Sequence[ChangedVerdict]) -> Item:
    """Conclusions 1 to 4: a row for each claim."""
    sensitive = {each.statement: each.changes_with for each in changed}
    rows: list[tuple[Cell, ...]] = [
        (
            each.statement,
            each.judged.verdict.value,
            _by_sweeps(each),
            each.place,
            _examples(each.judged),
            f"{each.judged.reason} {each.remark}".strip(),
            sensitive[each.statement],
        )
        for each in claims
    ]
    differing = _differing(claims)
    table = Table(
        "conclusions",
        "Claims, numbers of stickslip, verdicts",
        columns(
            "claim||Claim",
            "verdict||Verdict",
            "sweeps||By slow sweeps",
            "place||In the paper",
            "numbers||Numbers of stickslip",
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
            "The paper does not say how its curves are read where they fold. The verdict is that at the highest peak "
            "on each curve; beside it are the verdicts at the peaks that a slow sweep up and a slow sweep down reach. "
            f"{differing} of {len(claims)} claims have another verdict by one of the sweeps.",
            LEFT_OUT,
        ),
        (table,),
    )


def _by_sweeps(claim: JudgedClaim) -> str:
    """The verdicts by the peaks of slow sweeps that differ from the verdict."""
    others = [
        f"{reading}: {each.verdict.value}"
        for reading, each in claim.by_sweep.items()
        if each.verdict is not claim.judged.verdict
    ]
    return "; ".join(others) or "the same"


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
    readings = {"curve": "highest on the curve", **SWEEPS}
    for claim in CLAIMS:
        for reading, words in readings.items():
            for answer in claim.judged(seen(base(solutions), reading)).answers:
                verdict = {True: "yes", False: "no", None: "no answer"}[answer.holds]
                rows.append((claim.name, words, _situation(answer), verdict, answer.numbers))
    return Table(
        "answers",
        "All situations in which a claim was checked",
        columns("claim||Claim", "peak||Peak", "situation||Situation", "holds||Holds", "numbers||Numbers"),
        tuple(rows),
    )
