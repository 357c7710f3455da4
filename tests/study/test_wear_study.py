"""Wear of a study: from its file to results, tables and page; keys that are rejected before anything runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import stickslip as ss
from law_studies import REST, interface_text, write_masses, write_study
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError, StudyFileError
from stickslip.core.progress import SilentProgress
from stickslip.model.model import load_joint, set_up
from stickslip.results.storage import load_results
from stickslip.results.tables import study_tables
from stickslip.study import analyses
from stickslip.study import run as study
from stickslip.study import wear as wear_module
from stickslip.study.check import check
from stickslip.study.wear import energy_coefficients
from sweep_cases import quick_case
from synthetic import synthetic_response

WEAR: dict[str, Any] = {
    "analysis.kind": "wear",
    "analysis.wear_coefficient": "2e-5 mm^3/(N m)",
    "analysis.wear_cycles": 3e7,
    "excitation.amplitude": "250 N",
    "output.stress": False,
}


@pytest.mark.long
def test_run_writes_the_wear_and_its_section(tmp_path: Path) -> None:
    running_in = {"analysis.running_in_sq": "20 um", "analysis.running_in_depth": "5 um"}
    outcome = study.run(quick_case().replace(WEAR | running_in), tmp_path)
    saved = load_results(tmp_path / "results.nc")
    worn = saved.response.wear
    assert worn is not None
    assert saved.response == outcome.response
    assert worn.converged, worn.message
    assert saved.study is not None
    # It begins at the highest peak of the curve.
    row = saved.study.outputs["blade tip A"]
    assert worn.amplitude[0] == pytest.approx(saved.response.amplitude(row).max(), rel=3e-3)
    assert worn.energy_volume[-1] == pytest.approx(worn.volume[-1], rel=0.03)
    # The faces run in, and their normal force remains that of the damper.
    assert worn.normal_stiffness[-1].sum() > 1.05 * worn.normal_stiffness[0].sum()
    assert worn.normal_load[-1].sum() == pytest.approx(worn.normal_load[0].sum(), rel=1e-6)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<h2>Wear</h2>" in page
    before, after = worn.normal_stiffness[[0, -1]].sum(axis=1)
    said = "The normal stiffness of all pairs goes from"
    assert said in page
    assert f"{said} {before:.4g} to {after:.4g} N/m" in " ".join(worn.words())
    for name in ("wear-amplitude", "wear-frequency", "wear-depth", "wear-stiffness", "wear-map-0", "wear-map-1"):
        assert f'id="{name}"' in page
    assert f"Wear: {worn.message}" in outcome.message
    tables = {table.name: table for table in study_tables(saved.response, saved.study)}
    assert len(list(tables["wear"].rows)) == worn.n_states
    assert tables["worn_pairs"].columns[1].values == pytest.approx(worn.depth[-1])


def test_archard_is_divided_by_the_friction_coefficient() -> None:
    case = quick_case().replace(WEAR | {"friction.coefficient": 0.4})
    joint = load_joint(case, set_up(case).layout)
    assert energy_coefficients(case.analysis, joint) == pytest.approx(np.full(joint.preload.size, 5e-14))  # type: ignore[arg-type]
    energy = {"analysis.wear_coefficient": None, "analysis.energy_wear_coefficient": "3e-5 mm^3/J"}
    same = case.replace(energy)
    assert energy_coefficients(same.analysis, joint) == pytest.approx(np.full(joint.preload.size, 3e-14))  # type: ignore[arg-type]


def test_it_has_the_harmonics_and_samples_of_its_place_on_the_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    """A piece of a curve may have more harmonics than the study; the wear has them only where it acts there."""
    given: list[tuple[int, int]] = []

    def wear(*arguments: Any, **options: Any) -> Any:
        given.append((options["harmonics"], options["samples"]))
        raise ConvergenceError("not solved")

    monkeypatch.setattr(wear_module, "unreported_wear", wear)
    response = synthetic_response(columns=4, rows=3, n_points=20)
    row = np.eye(response.n_unknowns)[0]
    model = SimpleNamespace(
        superelement=None, pairs=None, excitation=None, outputs={"tip": row},
        joint=SimpleNamespace(face_pairs=SimpleNamespace(area=None), friction_coefficient=np.ones(1)),
    )  # fmt: skip
    monkeypatch.setattr(wear_module, "worn_faces", lambda *arguments: None)
    top = int(response.amplitude(row).argmax())
    hertz = response.frequency_hz
    window = {"solver.frequency_start": float(hertz.min()), "solver.frequency_stop": float(hertz.max())}
    at_peak = quick_case().replace(WEAR | window)
    beside = at_peak.replace({"analysis.wear_frequency": float(hertz[top - 3])})
    numbers = np.ones(response.n_points, dtype=int)
    numbers[top] = response.harmonics
    lent = replace(response, point_harmonics=numbers, settings=response.settings | {"harmonics": 1, "samples": 16})
    for case in (at_peak, beside):
        with pytest.raises(ConvergenceError):
            wear_module.wear_of_study(case, cast(Any, model), lent, SilentProgress(), 1)
    assert given == [(response.harmonics, response.samples), (1, 16)]


@pytest.mark.slow
def test_the_file_of_a_study_comes_back() -> None:
    case = quick_case().replace(WEAR | {"analysis.wear_frequency": "455 Hz"})
    assert Case.from_text(case.to_text()) == case
    sections = dict(check(case))
    assert ("wear", "3e+07 cycles at 455 Hz, 6.67e-05 mm^3/J") in sections["Would run"]


@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("analysis.wear_coefficient", {"analysis.wear_coefficient": None}),
        ("analysis.wear_coefficient", {"analysis.wear_coefficient": 0.0}),
        ("analysis.wear_coefficient", {"analysis.wear_coefficient": "1e-5 mm^2"}),
        ("analysis.wear_coefficient", {"analysis.energy_wear_coefficient": 1e-14}),
        ("analysis.wear_cycles", {"analysis.wear_cycles": 0}),
        ("analysis.wear_frequency", {"analysis.wear_frequency": "600 Hz"}),
        ("analysis.running_in_depth", {"analysis.running_in_sq": "1 um"}),
        ("analysis.over", {"analysis.over": "friction.coefficient"}),
        ("preload.residual_traction", {"preload.method": "solved", "preload.residual_traction": "kept"}),
    ],
)  # fmt: skip
def test_keys_that_contradict_wear_are_rejected(key: str, changes: dict[str, Any]) -> None:
    with rejects(StudyFileError, key):
        quick_case().replace(WEAR | changes)


def test_running_in_without_roughness_is_rejected() -> None:
    wear = {"kind": "wear", "wear_coefficient": 1e-14, "running_in_sq": "1 um", "running_in_depth": "1 um"}
    stiffness = {"normal_stiffness": 1e8, "tangential_stiffness": 1e8}
    with rejects(StudyFileError, "analysis.running_in_sq"):
        Case.from_mapping({"analysis": wear, "contact_stiffness": stiffness})


def test_keys_of_wear_belong_to_its_kind() -> None:
    with rejects(StudyFileError, "analysis.wear_cycles"):
        Case.from_text("[analysis]\nwear_cycles = 10\n")


@pytest.mark.slow
def test_running_in_to_a_rougher_face_is_rejected_before_anything_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_run(*_: object, **__: object) -> None:
        raise AssertionError("nothing runs before the wear is checked")

    monkeypatch.setattr(analyses, "unreported_response", no_run)
    case = quick_case().replace(WEAR | {"analysis.running_in_sq": "1 mm", "analysis.running_in_depth": "1 um"})
    with rejects(ss.InputError, "analysis.running_in_sq"):
        check(case)
    with rejects(ss.InputError, "analysis.running_in_sq"):
        ss.solve_case(case)


def test_another_contact_law_is_rejected(tmp_path: Path) -> None:
    write_masses(tmp_path)
    wear = '[analysis]\nkind = "wear"\nwear_coefficient = 1e-14\n'
    with rejects(StudyFileError, "interfaces.damper.law"):
        ss.load_case(write_study(tmp_path, interface_text("damper", "jenkins"), rest=REST + wear))
