"""Verdicts under a changed choice: which curves they are judged on, what changes, and what cannot."""

from __future__ import annotations

from typing import Any

import pytest

from paper_curves import curve
from stickslip.papers.rough_damper.choice_items import (
    NOT_AFFECTED,
    ChangedVerdict,
    changed_sets,
    changed_verdicts,
    choices_item,
    reasons_table,
)
from stickslip.papers.rough_damper.claim_list import CLAIMS
from stickslip.papers.rough_damper.model_items import MODEL_CLAIMS
from stickslip.papers.rough_damper.plan import Scope, computations
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.verdicts import Verdict

SLIP = "A smaller centrifugal force lets more pairs slip or open."
FORCE = "5 N leaves fewer pairs stuck than 2 N."


def slipping(load: float, force: float, factor: float) -> dict[str, Any]:
    """More pairs move where force / load is larger (factor 1), or fewer (factor -1)."""
    moving = round(50 + 200 * factor * force / load)
    return {"stuck": 110.0 - moving, "stick_slip": float(moving), "separating": 0.0}


@pytest.fixture(scope="module")
def solutions() -> list[Solved]:
    """Every curve of the whole plan with invented numbers: with the hardness of 4 GPa less load gives less slip."""
    actual = []
    for each in computations(Scope()):
        s = each.setting
        factor = -1.0 if s.choice == "hardness 4 GPa" else 1.0
        actual.append(curve(vars(s), **slipping(s.load, s.force, factor)))
    return actual


@pytest.fixture(scope="module")
def changed(solutions: list[Solved]) -> dict[str, ChangedVerdict]:
    return {each.statement: each for each in changed_verdicts(solutions, Scope())}


@pytest.mark.long
def test_every_column_is_judged_on_the_same_situations(solutions: list[Solved]) -> None:
    sets = changed_sets(solutions, Scope())
    assert [each.name for each in sets] == [
        "base", "excitation height 11.01 mm", "excitation height 25.69 mm", "damping 0.0005", "damping 0.002",
        "friction coefficient 0.15", "friction coefficient 0.5", "hardness 2 GPa", "hardness 4 GPa",
        "centrifugal force 50 N", "centrifugal force 200 N", "stiffness law paper", "preload solved",
    ]  # fmt: skip
    for each in sets:
        assert len(each.curves) == 27
        assert {one.setting.choice for one in each.curves} == {each.name}
        main = max(one.setting.load for one in each.curves)
        places = {
            (s.excitation, s.force, s.load / main, s.dimension, s.scale) for s in (c.setting for c in each.curves)
        }
        assert places == {
            (s.excitation, s.force, s.load / 100.0, s.dimension, s.scale) for s in (c.setting for c in sets[0].curves)
        }


@pytest.mark.slow
def test_every_claim_has_a_verdict_under_every_change(changed: dict[str, ChangedVerdict]) -> None:
    assert list(changed) == [claim.statement for claim in (*CLAIMS, *MODEL_CLAIMS)]
    for claim in CLAIMS:
        assert len(changed[claim.statement].verdicts) == 13
        assert None not in changed[claim.statement].verdicts.values()


@pytest.mark.slow
def test_claims_that_compare_loads_and_forces_follow_the_change(changed: dict[str, ChangedVerdict]) -> None:
    for statement in (SLIP, FORCE):
        verdicts = {name: judged.verdict for name, judged in changed[statement].verdicts.items() if judged}
        assert verdicts.pop("hardness 4 GPa") is Verdict.DOES_NOT_HOLD
        assert set(verdicts.values()) == {Verdict.HOLDS}
        assert changed[statement].changes_with == "hardness 4 GPa"
    judged = changed[SLIP].verdicts["centrifugal force 50 N"]
    assert judged is not None
    assert {answer.numbers.split(" N:")[0] for answer in judged.answers} == {"25"}


@pytest.mark.slow
def test_what_cannot_depend_on_a_choice_reports_it_with_the_reason(changed: dict[str, ChangedVerdict]) -> None:
    surfaces, reduction, stiffness = (changed[claim.statement] for claim in MODEL_CLAIMS)
    affected = [
        [name for name, judged in each.verdicts.items() if judged is not None]
        for each in (surfaces, reduction, stiffness)
    ]
    assert affected == [
        ["base"],
        ["base", "excitation height 11.01 mm", "excitation height 25.69 mm"],
        ["base", "hardness 2 GPa", "hardness 4 GPa", "stiffness law paper"],
    ]
    assert all(each.reason for each in (surfaces, reduction, stiffness))
    hard, soft = (stiffness.verdicts[f"hardness {value} GPa"] for value in (4, 2))
    assert hard is not None
    assert soft is not None
    assert [a.numbers for a in hard.answers] != [a.numbers for a in soft.answers]


@pytest.mark.slow
def test_tables_have_a_cell_for_every_claim_and_change(changed: dict[str, ChangedVerdict]) -> None:
    verdicts = list(changed.values())
    table = choices_item(verdicts, Scope()).tables[1]
    assert [column.heading for column in table.columns][0:2] == ["Claim", "base"]
    assert len(table.rows) == len(CLAIMS) + len(MODEL_CLAIMS)
    words = {cell for row in table.rows for cell in row[1:13]}
    assert words <= {*(verdict.value for verdict in Verdict), NOT_AFFECTED}
    reasons = reasons_table(verdicts).rows
    assert len(reasons) == 13 * len(verdicts)
    assert all(reason for *_, reason in reasons)
