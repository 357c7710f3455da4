"""Items that judge: the conclusions claim by claim, and what our choices do to every verdict."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.paper.claims import CLAIMS, Solutions
from stickslip.paper.items import Item, base
from stickslip.paper.plan import BASE_CHOICE, Scope, variant
from stickslip.paper.records import Solved
from stickslip.paper.tables import Cell, Table, columns
from stickslip.paper.verdicts import Answer, Judgement, Verdict

# What explains a verdict and does not depend on the numbers of a run, for the claims that need it.
REMARKS = {
    "Opposite directions turn the damper.": "Mirrored blades that move as mirror images cannot turn a damper that "
    "mirrors itself: it goes up and down. A turn needs a structure or a load without that symmetry.",
    "The peak falls as D grows.": "Larger D means stiffer, not rougher. Under opposite forces the second mode moves "
    "little at the place of the force for stiff faces, so its peak says more about that place than about friction.",
    "The peak falls as G falls.": "Smaller G means stiffer, not rougher; for opposite forces see D.",
    "The energy grows with D (at one frequency).": "Peaks move by more than their width, so the frequency that is held "
    "decides this.",
    "The energy first rises, then falls with D (at one frequency).": "The same: the curve that resonates at the held "
    "frequency has the most.",
    "A larger D or a smaller G raises Sq or Sdq.": "Both lower every wave longer than G.",
}

Judged = tuple[str, str, Judgement]  # statement, place in the paper, verdict


def judged_claims(solutions: Solutions, others: Sequence[Item]) -> list[Judged]:
    """Every claim: those about the vibration, and those that other items judge from the model alone."""
    found = [(claim.statement, claim.place, claim.judged(base(solutions))) for claim in CLAIMS]
    return found + [(question, item.title, judged) for item in others for question, judged in item.judgements]


def conclusions_item(claims: Sequence[Judged]) -> Item:
    """Conclusions 1 to 4: a row for each claim."""
    rows: list[tuple[Cell, ...]] = [
        (
            statement,
            place,
            _examples(judged),
            judged.verdict.value,
            f"{judged.reason} {REMARKS.get(statement, '')}".strip(),
        )
        for statement, place, judged in claims
    ]
    table = Table(
        "conclusions",
        "Claims, our numbers, verdicts",
        columns("claim||Claim", "place||In the paper", "numbers||Our numbers", "verdict||Verdict", "why||Why"),
        tuple(rows),
    )
    return Item(
        "conclusions",
        "Conclusions 1 to 4, claim by claim",
        "Same direction translates the damper and slips most; less load, larger D and smaller G give more slip, a "
        "lower peak and more energy.",
        ("Each verdict follows from all base curves under the consistent law; answers.csv has what is behind it.",),
        (table,),
    )


def _examples(judged: Judgement) -> str:
    """The first answer for and the first against, in words."""
    told = [answer for answer in judged.answers if answer.holds is not None]
    chosen = [next((a for a in told if a.holds is wanted), None) for wanted in (True, False)]
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
            told = {True: "yes", False: "no", None: "says nothing"}[answer.holds]
            rows.append((claim.name, _situation(answer), told, answer.numbers))
    return Table(
        "answers",
        "Every situation in which a claim was asked",
        columns("claim||Claim", "situation||Situation", "holds||Holds", "numbers||Numbers"),
        tuple(rows),
    )


def choices_item(solutions: Solutions, scope: Scope) -> Item:
    """The choices, and every verdict with one of them changed."""
    rows: list[tuple[Cell, ...]] = [
        (c.name, str(c.base), ", ".join(map(str, c.others)), c.reason) for c in scope.choices
    ]
    choices = Table(
        "choices",
        "Choices that the paper leaves open",
        columns("choice||Choice", "base||Base", "others||Also", "reason||Why"),
        tuple(rows),
    )
    sets = dict(changed_sets(solutions, scope))
    body = []
    for claim in CLAIMS:
        verdicts = [claim.judged(chosen).verdict for chosen in sets.values()]
        if any(verdict is not Verdict.UNDECIDED for verdict in verdicts):
            body.append((claim.statement, *(verdict.value for verdict in verdicts)))
    heads = ("claim||Claim", *(f"{name.replace(' ', '_')}||{name}" for name in sets))
    table = Table("choices_verdicts", "Verdicts with one choice changed at a time", columns(*heads), tuple(body))
    return Item(
        "choices",
        "Our choices, and what they do to the verdicts",
        "Friction coefficient, damping, hardness, centrifugal force and the place of the force are not given.",
        (
            "Each column is judged on the short series of D and G alone (the base as well), with one force and one "
            "centrifugal force, so claims that compare forces or loads are left out.",
        ),
        (choices, table),
    )


def changed_sets(solutions: Solutions, scope: Scope) -> list[tuple[str, list[Solved]]]:
    """(name, curves) of the base on the short series, of each changed choice, and of the base under other loads."""
    short = set(scope.roughness(short=True))
    force, load = scope.runs[0]

    def pick(choice: str, force_here: float, load_here: float) -> list[Solved]:
        return [
            one
            for one in solutions
            if one.setting.choice == choice
            and (one.setting.dimension, one.setting.scale) in short
            and (one.setting.force, one.setting.load) == (force_here, load_here)
            and (choice != BASE_CHOICE or one.setting.law == "consistent")
        ]

    sets = [("base", pick(BASE_CHOICE, force, load))]
    sets += [(f"{f:g} N, F_N {n:g} N", pick(BASE_CHOICE, f, n)) for f, n in scope.runs[1:]]
    for choice in scope.choices:
        for value in choice.others:
            name = variant(choice, value)
            found = [one for one in solutions if one.setting.choice == name]
            if found:
                sets.append((name, found))
    return sets
