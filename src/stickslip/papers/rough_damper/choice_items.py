"""The effect of the choices of this study on the verdicts: each claim with one of them changed, low and high."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from stickslip.case.case import TwoBladeCase
from stickslip.papers.rough_damper.claim_list import CLAIMS
from stickslip.papers.rough_damper.claims import Solutions
from stickslip.papers.rough_damper.items import Item
from stickslip.papers.rough_damper.model_items import MODEL_CLAIMS
from stickslip.papers.rough_damper.plan import (
    BASE_CHOICE,
    LOAD_KEY,
    Roughnesses,
    Scope,
    base_case,
    changed_load,
    changes,
    variant,
    words_of,
)
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.tables import Cell, Table, columns
from stickslip.papers.rough_damper.verdicts import Judgement

NOT_AFFECTED = "not affected"


@dataclass(frozen=True)
class ChangedVerdict:
    """A claim under the base and every changed choice.

    verdicts:
        "base" or the changed choice -> verdict; None where the claim cannot depend on that choice.
    reason:
        why it cannot; empty where it can depend on all of them.
    """

    statement: str
    verdicts: Mapping[str, Judgement | None]
    reason: str

    @property
    def changes_with(self) -> str:
        """The changed choices under which the verdict is another one, in words."""
        base = self.verdicts[BASE_CHOICE]
        choices = [
            name
            for name, judged in self.verdicts.items()
            if judged is not None and base is not None and judged.verdict is not base.verdict
        ]
        return ", ".join(choices) or "no varied choice"


@dataclass(frozen=True)
class ChangedSet:
    """The case and the curves with one choice changed; ``key`` is that of the choice, empty for the base."""

    name: str
    key: str
    case: TwoBladeCase
    curves: tuple[Solved, ...]


def changed_verdicts(solutions: Solutions, scope: Scope) -> list[ChangedVerdict]:
    """Every claim, judged with the same curves under the base and under every changed choice."""
    sets = changed_sets(solutions, scope)
    changed = [ChangedVerdict(claim.statement, {s.name: claim.judged(s.curves) for s in sets}, "") for claim in CLAIMS]
    for claim in MODEL_CLAIMS:
        verdicts = {
            s.name: claim.judged(s.case, s.curves) if not s.key or s.key in claim.depends_on else None for s in sets
        }
        changed.append(ChangedVerdict(claim.statement, verdicts, claim.reason))
    return changed


def changed_sets(solutions: Solutions, scope: Scope) -> list[ChangedSet]:
    """The base with the runs and roughness of a changed choice, and each changed choice that has curves.

    Curves are relabelled with the change, so that those which the base has computed already count with the others.
    """
    case = base_case(scope)
    sets = [ChangedSet(BASE_CHOICE, "", case, _picked(solutions, BASE_CHOICE, {BASE_CHOICE}, scope.changed_runs()))]
    for choice, value in changes(scope):
        name, changed = variant(choice, value), case.replace({choice.key: value})
        # curves of the base under the changed load are those of the change
        labels = {name, BASE_CHOICE} if choice.key == LOAD_KEY else {name}
        curves = _picked(solutions, name, labels, scope.changed_runs(changed_load(choice, changed)))
        if curves:
            sets.append(ChangedSet(name, choice.key, changed, curves))
    return sets


def _picked(
    solutions: Solutions, name: str, labels: set[str], runs: Sequence[tuple[float, float, Roughnesses]]
) -> tuple[Solved, ...]:
    wanted = {(force, load, *point) for force, load, points in runs for point in points}
    return tuple(
        replace(one, setting=replace(one.setting, choice=name))
        for one in solutions
        if one.setting.choice in labels
        and (one.setting.choice != BASE_CHOICE or one.setting.law == "consistent")
        and (one.setting.force, one.setting.load, one.setting.dimension, one.setting.scale) in wanted
    )


def choices_item(changed: Sequence[ChangedVerdict], scope: Scope) -> Item:
    """The choices, and every verdict with one of them changed."""
    rows: list[tuple[Cell, ...]] = [
        (c.name, str(c.base), ", ".join(words_of(c, value) for value in c.others), c.reason) for c in scope.choices
    ]
    choices = Table(
        "choices",
        "Choices that the paper leaves open",
        columns("choice||Choice", "base||Base", "others||Also", "reason||Why"),
        tuple(rows),
    )
    names = list(changed[0].verdicts)
    heads = (
        "claim||Claim",
        *(f"{name.replace(' ', '_')}||{name}" for name in names),
        "changes_with||Another verdict with",
        "not_affected||Why not affected",
    )
    body = tuple(
        (each.statement, *map(_word, each.verdicts.values()), each.changes_with, each.reason) for each in changed
    )
    table = Table("choices_verdicts", "Verdicts with one varied choice at a time", columns(*heads), body)
    runs = "; ".join(f"{force:g} N, F_N {load:g} N" for force, load, _ in scope.changed_runs())
    points = " and ".join(f"D {dimension:g}, G {scale:g} m" for dimension, scale in scope.compared)
    return Item(
        "choices",
        "Choices of stickslip, and their effect on the verdicts",
        "Friction coefficient, damping, hardness, centrifugal force and the position of the force are not given.",
        (
            f"Each column, also the base, uses the same curves: the short series of D and G under the first of "
            f"the runs {runs}; under the others {points}, so the verdicts include claims that compare forces or loads. "
            "With another centrifugal force the loads of all runs change in proportion, so each comparison uses the "
            "same fraction of it. The base column has fewer curves than the verdicts above, and may differ. The "
            "law of stiffness has one other value, not a low and a high one.",
            "Undecided: no situation gives an answer, for example because all compared values are equal. "
            "choices_reasons.csv has the reason of each verdict.",
        ),
        (choices, table),
    )


def _word(judged: Judgement | None) -> str:
    return NOT_AFFECTED if judged is None else judged.verdict.value


def reasons_table(changed: Sequence[ChangedVerdict]) -> Table:
    """Verdict and reason of every claim under every changed choice."""
    rows = [
        (each.statement, name, _word(judged), each.reason if judged is None else judged.reason)
        for each in changed
        for name, judged in each.verdicts.items()
    ]
    return Table(
        "choices_reasons",
        "Reason of each verdict with one varied choice at a time",
        columns("claim||Claim", "choice||Choice", "verdict||Verdict", "reason||Why"),
        tuple(rows),
    )
