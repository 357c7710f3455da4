"""The items of the page: the paper's statement in our words, our tables and figures, and the verdict."""

from __future__ import annotations

from dataclasses import dataclass, field

from stickslip.paper.claims import CLAIMS, MICRO, Solutions, friction_energy
from stickslip.paper.plan import BASE_CHOICE, Scope, variant
from stickslip.paper.records import Solved
from stickslip.paper.tables import Cell, Table, columns
from stickslip.paper.verdicts import Answer, Judgement, judge
from stickslip.structure.craig_bampton import paper_table


@dataclass(frozen=True)
class Item:
    """One item of the page."""

    anchor: str
    title: str
    statement: str
    notes: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[str, ...] = ()
    judgement: Judgement | None = None
    shown_rows: int = field(default=60)


def base(solutions: Solutions, law: str = "consistent") -> list[Solved]:
    """The curves without a varied choice, under one law."""
    return [one for one in solutions if one.setting.choice == BASE_CHOICE and one.setting.law == law]


def reduction_item(solutions: Solutions, full_size: int, pairs: int) -> Item:
    """Tables 1 and 2, Figure 2."""
    reduced = int(solutions[0].numbers["unknowns_reduced"])
    rows: list[tuple[Cell, ...]] = []
    answers = []
    for mode, paper in zip(solutions[0].mode_table, paper_table(), strict=False):
        number, full_hz, reduced_hz, difference, mac = (float(value) for value in mode)
        rows.append(
            (
                int(number), full_hz, paper["full_hz"], 100.0 * (full_hz / paper["full_hz"] - 1.0), reduced_hz,
                difference, paper["frequency_difference_percent"], mac, paper["mac"],
            )
        )  # fmt: skip
        answers.append(
            Answer(
                {"mode": f"{int(number)}"},
                abs(difference) < 0.01,
                f"{difference:.2e} % (paper {paper['frequency_difference_percent']:.2e} %)",
            )
        )
    sizes = Table(
        "table1_sizes",
        "Sizes, with the paper's reduction by about 20",
        columns("quantity||Quantity", "value||Ours"),
        (
            ("unknowns of the full model", full_size),
            ("unknowns after reduction", reduced),
            ("ratio", full_size / reduced),
            ("contact pairs", pairs),
        ),
    )
    frequencies = Table(
        "table2_frequencies",
        "Natural frequencies with tied contact, full and reduced, against Table 2",
        columns(
            "mode||Mode", "full|Hz|Full", "paper_full|Hz|Paper, full", "from_paper|%|Ours from paper",
            "reduced|Hz|Reduced", "difference|%|Reduced from full", "paper_difference|%|Paper", "mac||MAC",
            "paper_mac||Paper, MAC",
        ),
        tuple(rows),
    )  # fmt: skip
    notes = (
        "The geometry is inferred: seven dimensions were fitted to these ten frequencies, so that they agree proves "
        "nothing about the model. Of the paper's own differences three (modes 8 to 10) exceed its bound.",
    )
    return Item(
        "reduction", "Tables 1 and 2, Figure 2: reduction of the model",
        "The reduced model keeps the first ten frequencies within 1/10,000 and MAC near 1, with some 20 times fewer "
        "unknowns.",
        notes, (sizes, frequencies), ("fig02_reduction",), judge(answers),
    )  # fmt: skip


def peak_table(name: str, caption: str, solutions: Solutions) -> Table:
    """Peak, frequency, states and energies of curves."""
    rows = []
    for one in solutions:
        s, n = one.setting, one.numbers
        rows.append(
            (
                s.choice, s.excitation, s.force, s.load, s.dimension, s.scale, s.law, n["normal_stiffness"],
                MICRO * n["peak_m"], n["peak_hz"], n["first_stuck_hz"], n["second_stuck_hz"], int(n["stuck"]),
                int(n["stick_slip"]), int(n["separating"]), MICRO * friction_energy(one), MICRO * n["viscous_energy_j"],
            )
        )  # fmt: skip
    return Table(
        name, caption,
        columns(
            "choice||Choice", "excitation||Excitation", "force|N|Force", "load|N|F_N", "dimension||D", "scale|m|G",
            "law||Law", "normal_stiffness|N/m|K_n of a face", "peak|um|Peak", "peak_frequency|Hz|at",
            "first_stuck|Hz|Stuck mode 1",
            "second_stuck|Hz|Stuck mode 2", "stuck||Stuck", "stick_slip||Stick-slip", "separating||Separating",
            "friction_energy|uJ|Friction energy", "viscous_energy|uJ|Viscous energy",
        ),
        tuple(rows),
    )  # fmt: skip


def conclusions_item(solutions: Solutions) -> Item:
    """Conclusions 1 to 4: a row for each claim."""
    chosen = base(solutions)
    rows: list[tuple[Cell, ...]] = []
    for claim in CLAIMS:
        judged = claim.judged(chosen)
        rows.append((claim.statement, claim.place, _examples(judged), judged.verdict.value, judged.reason))
    table = Table(
        "conclusions", "Claims, our numbers, verdicts",
        columns("claim||Claim", "place||In the paper", "numbers||Our numbers", "verdict||Verdict", "why||Why"),
        tuple(rows),
    )  # fmt: skip
    return Item(
        "conclusions", "Conclusions 1 to 4, claim by claim",
        "Same direction translates the damper and slips most; less load, larger D and smaller G give more slip, a "
        "lower peak and more energy.",
        ("Every verdict is computed from all base curves under the consistent law; answers.csv has what is behind it.",),
        (table,),
    )  # fmt: skip


def _examples(judged: Judgement) -> str:
    """The first answer for and the first against, in words."""
    told = [answer for answer in judged.answers if answer.holds is not None]
    chosen = [next((a for a in told if a.holds is wanted), None) for wanted in (True, False)]
    return " | ".join(
        f"{'for' if answer.holds else 'against'}: {_situation(answer)}: {answer.numbers}" for answer in chosen if answer
    )


def _situation(answer: Answer) -> str:
    return ", ".join(
        value if name in ("excitation", "mode") else f"{name} {value}" for name, value in answer.where.items()
    )


def answers_table(solutions: Solutions) -> Table:
    """Every answer behind every verdict."""
    rows: list[tuple[Cell, ...]] = []
    for claim in CLAIMS:
        for answer in claim.judged(base(solutions)).answers:
            told = {True: "yes", False: "no", None: "says nothing"}[answer.holds]
            rows.append((claim.name, _situation(answer), told, answer.numbers))
    return Table(
        "answers", "Every situation in which a claim was asked",
        columns("claim||Claim", "situation||Situation", "holds||Holds", "numbers||Numbers"), tuple(rows),
    )  # fmt: skip


def choices_item(solutions: Solutions, scope: Scope) -> Item:
    """The choices, and every verdict with one of them changed."""
    rows: list[tuple[Cell, ...]] = [(c.name, str(c.base), str(c.low), str(c.high), c.reason) for c in scope.choices]
    choices = Table(
        "choices", "Choices that the paper leaves open",
        columns("choice||Choice", "base||Base", "low||Low", "high||High", "reason||Why"), tuple(rows),
    )  # fmt: skip
    sets = dict(changed_sets(solutions, scope))
    body = [(claim.statement, *(claim.judged(chosen).verdict.value for chosen in sets.values())) for claim in CLAIMS]
    heads = ("claim||Claim", *(f"set_{place}||{name}" for place, name in enumerate(sets)))
    table = Table("choices_verdicts", "Verdicts with one choice changed at a time", columns(*heads), tuple(body))
    return Item(
        "choices", "Our choices, and what they do to the verdicts",
        "Friction coefficient, damping, hardness, centrifugal force and the place of the force are not given.",
        (
            "Each column is judged on the short series of D and G alone (the base as well), with one force and one "
            "centrifugal force, so claims that compare forces or loads are undecided there.",
        ),
        (choices, table),
    )  # fmt: skip


def changed_sets(solutions: Solutions, scope: Scope) -> list[tuple[str, list[Solved]]]:
    """(name, curves) of the base on the short series, of each changed choice, and of the base under other loads."""
    short = set(scope.roughness(short=True))
    force, load = scope.runs[0]

    def pick(choice: str, force_here: float, load_here: float) -> list[Solved]:
        return [
            one for one in solutions
            if one.setting.choice == choice and (one.setting.dimension, one.setting.scale) in short
            and (one.setting.force, one.setting.load) == (force_here, load_here)
            and (choice != BASE_CHOICE or one.setting.law == "consistent")
        ]  # fmt: skip

    sets = [("base", pick(BASE_CHOICE, force, load))]
    sets += [(f"{f:g} N, F_N {n:g} N", pick(BASE_CHOICE, f, n)) for f, n in scope.runs[1:]]
    for choice in scope.choices:
        for value in (choice.low, choice.high):
            name = variant(choice, value)
            found = [one for one in solutions if one.setting.choice == name]
            if found:
                sets.append((name, found))
    return sets
