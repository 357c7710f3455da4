"""Table 2 of the paper as the leaf keeps it: its own columns, and the reference of the base case."""

from __future__ import annotations

from stickslip.case.case import Case
from stickslip.papers.rough_damper.plan import Scope, base_case
from stickslip.papers.rough_damper.table2 import SOURCE, table2


def test_the_base_case_has_the_frequencies_of_the_full_model_as_its_reference() -> None:
    rows = table2()
    assert [int(row["mode"]) for row in rows] == list(range(1, 11))
    assert rows[8]["frequency_difference_percent"] == 0.0416
    reference = base_case(Scope()).reference
    assert reference is not None
    assert reference.mode_frequencies == tuple(row["full_hz"] for row in rows)
    assert reference.mode_frequencies[0] == 506.83
    assert reference.source == SOURCE


def test_other_studies_know_nothing_of_it() -> None:
    assert Case().reference is None
