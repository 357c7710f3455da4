"""The plan: every combination once, validated first, under a name that follows from its inputs."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

import stickslip
from sentences import rejects
from stickslip.case.case import Case, TwoBladeCase
from stickslip.core.errors import InputError, StudyFileError
from stickslip.sweeps import plan, work
from stickslip.sweeps.axes import swept_keys
from stickslip.sweeps.plan import PlannedCase, plan_cases, plan_rows


def planned(vary: dict[str, Any], case: Case | None = None) -> tuple[PlannedCase, ...]:
    return plan_cases(case or Case(), swept_keys(vary))


def test_every_combination_the_last_key_fastest() -> None:
    cases = planned({"preload.centrifugal_force": "100,300", "excitation.mode": "single,same,opposite"})
    assert [case.values for case in cases][:4] == [
        (100.0, "single"),
        (100.0, "same"),
        (100.0, "opposite"),
        (300.0, "single"),
    ]
    last, second = cases[3].case, cases[1].case
    assert isinstance(last, TwoBladeCase)
    assert last.preload.centrifugal_force == 300.0
    assert isinstance(second, TwoBladeCase)
    assert second.excitation.mode == "same"
    assert len({case.name for case in cases}) == len({case.key for case in cases}) == 6


def test_names_are_short_readable_and_safe() -> None:
    name = planned({"roughness.shortest_length": "1 um,2.5 um", "material.density": "7800 kg/m^3"})[1].name
    assert re.fullmatch(r"shortest_length-2\.5um_density-7800kgm3_[0-9a-f]{12}", name)
    every = {f"geometry.{key}": "5 mm" for key in ("width", "airfoil_thickness", "inner_overhang", "damper_length")}
    assert len(planned(every)[0].name) <= 93


def test_name_and_key_follow_from_the_inputs_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    first = planned({"preload.centrifugal_force": "100,300"})[1]
    alone = planned({"preload.centrifugal_force": "0.3 kN"})[0]
    assert (first.name, first.key) == (alone.name, alone.key)
    retitled = planned({"preload.centrifugal_force": "300"}, Case().replace({"study.title": "Other"}))[0]
    assert retitled.key == first.key  # a title changes no answer
    assert planned({"preload.centrifugal_force": "300"}, Case().replace({"solver.harmonics": 3}))[0].key != first.key
    for other in ("99.0 (code 0)", plan.worker_version().replace("(code ", "(code 0")):  # type: ignore[attr-defined]
        with monkeypatch.context() as patch:
            patch.setattr(plan, "worker_version", lambda other=other: other)
            assert planned({"preload.centrifugal_force": "300"})[0].key != first.key  # another version answers anew


def test_the_earlier_name_of_a_roughness_mode_plans_the_same_cases() -> None:
    earlier, today = (planned({"roughness.mode": f"consistent,{word}"}) for word in ("paper", "varying-curvature"))
    assert earlier == today
    assert [case.values for case in earlier] == [("consistent",), ("varying-curvature",)]
    from_file = Case.from_text('[roughness]\nmode = "paper"\n')
    assert planned({"friction.coefficient": "0.3"}, from_file)[0].key == earlier[1].key
    with rejects(InputError, "roughness.mode"):
        planned({"roughness.mode": "paper,varying-curvature"})


@pytest.mark.slow
def test_the_key_follows_from_the_code_that_solves_not_from_what_shows(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    package = Path(stickslip.__file__).parent
    copy = tmp_path / "stickslip"
    shutil.copytree(package, copy, ignore=shutil.ignore_patterns("__pycache__"))

    def digest_of_copy() -> str:
        work.code_digest.cache_clear()
        return work.code_digest()

    before = digest_of_copy()
    monkeypatch.setattr(work, "__file__", str(copy / "sweeps" / "work.py"))
    assert digest_of_copy() == before
    for name, changes in (
        ("reporting/page.py", False),
        ("papers/rough_damper/claims.py", False),
        ("solve/path/newton.py", True),
    ):
        with (copy / name).open("a", encoding="utf-8") as stream:
            stream.write("# changed\n")
        assert (digest_of_copy() != before) == changes, name
    work.code_digest.cache_clear()


@pytest.mark.slow
def test_structure_is_shared_unless_geometry_mesh_material_or_reduction_changes() -> None:
    light = planned(
        {"preload.centrifugal_force": "100,300", "excitation.mode": "single,same", "friction.coefficient": "0.2,0.4"}
    )
    assert len({case.structure for case in light}) == 1
    for name, values in (
        ("geometry.width", "27 mm,28 mm"),
        ("mesh.chordwise", "6,8"),
        ("material.density", "7000,7800"),
        ("reduction.modes", "10,20"),
    ):
        assert len({case.structure for case in planned({name: values, "friction.coefficient": "0.2,0.4"})}) == 2


def test_cases_that_are_not_valid_together_are_all_named_before_anything_runs() -> None:
    with rejects(StudyFileError):
        planned({"solver.harmonics": "5,50", "solver.samples": "32,64"})
    with rejects(StudyFileError):
        planned({"solver.frequency_start": "530:549:20", "solver.largest_step": [0.001]})


@pytest.mark.slow
def test_a_sweep_without_end_is_rejected() -> None:
    with rejects(InputError):
        planned({"friction.coefficient": "0.1:0.5:10000", "preload.centrifugal_force": "1:11:11"})


@pytest.mark.parametrize("of", ["sweep", "band"])
@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("kind", {"analysis.kind": "ridge"}),
        ("kind", {"analysis.kind": "wear", "analysis.wear_coefficient": 1e-14}),
        ("kind", {"analysis.kind": "mode"}),
        ("gradients", {"analysis.gradients": True}),
    ],
)
def test_an_analysis_that_no_table_contains_is_rejected(key: str, changes: dict[str, object], of: str) -> None:
    case = Case().replace(changes)
    keys = swept_keys({"friction.coefficient": [0.2, 0.3]})
    with rejects(InputError, f"analysis.{key}"):
        plan_rows(case, keys, [(0,), (1,)], of)
