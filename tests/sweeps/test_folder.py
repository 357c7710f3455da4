"""The folder of a sweep: what is taken from an earlier sweep, and that nothing damaged ever is."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from damage import damaged
from stickslip.case.case import Case
from stickslip.results.sweep_table import SweepCurve
from stickslip.sweeps import folder as sweep_folder
from stickslip.sweeps.axes import swept_keys
from stickslip.sweeps.folder import SweepFolder
from stickslip.sweeps.plan import PlannedCase, plan_cases
from stickslip.sweeps.work import CaseOutcome

CURVE = SweepCurve(
    np.linspace(440.0, 480.0, 9), np.linspace(1e-6, 9.1e-6, 9) ** 1.5, np.arange(9) != 4, np.arange(9) // 6
)
SOLVED = CaseOutcome(
    converged=True,
    message="The whole curve was followed.",
    measures={"peak_amplitude_m": 9.123456789e-06, "equivalent_damping_ratio": float("nan")},
    curve=CURVE,
    warnings=("steep",),
    file=b"\x89HDF\r\n\x1a\n" + bytes(range(256)) * 4,
)
REJECTED = CaseOutcome(converged=False, message="damper_length is 40 mm.", measures={})


@pytest.fixture
def cases() -> tuple[PlannedCase, ...]:
    return plan_cases(Case(), swept_keys({"preload.centrifugal_force": "100,300"}))


@pytest.fixture
def folder(tmp_path: Path) -> SweepFolder:
    return SweepFolder(tmp_path)


def file_of(folder: SweepFolder, planned: PlannedCase, name: str) -> Path:
    return folder.results_file(planned).with_name(name)


def test_what_was_stored_is_found(folder: SweepFolder, cases: tuple[PlannedCase, ...]) -> None:
    assert folder.finished(cases[0]) == (None, "")
    folder.store(cases[0], SOLVED)
    folder.store(cases[1], REJECTED)
    actual, notice = folder.finished(cases[0])
    assert notice == ""
    assert actual is not None
    assert (actual.converged, actual.message, actual.warnings) == (True, SOLVED.message, SOLVED.warnings)
    assert actual.measures["peak_amplitude_m"] == SOLVED.measures["peak_amplitude_m"]
    assert np.isnan(actual.measures["equivalent_damping_ratio"])
    assert actual.curve is not None
    assert np.array_equal(actual.curve.frequency_hz, CURVE.frequency_hz)
    assert np.array_equal(actual.curve.amplitude_m, CURVE.amplitude_m)
    assert np.array_equal(actual.curve.part, CURVE.part)
    rejected, notice = folder.finished(cases[1])
    assert rejected is not None
    assert (rejected.converged, rejected.message, rejected.curve, notice) == (False, REJECTED.message, None, "")


@pytest.mark.slow
@pytest.mark.parametrize(("outcome", "name"), [(SOLVED, "row.json"), (SOLVED, "results.nc"), (REJECTED, "failed.json")])
def test_any_damage_is_named_and_never_taken(
    folder: SweepFolder, cases: tuple[PlannedCase, ...], outcome: CaseOutcome, name: str
) -> None:
    folder.store(cases[0], outcome)
    file = file_of(folder, cases[0], name)
    for what, content in damaged(file.read_bytes(), 200):
        file.write_bytes(content)
        actual, notice = folder.finished(cases[0])
        assert actual is None, what
        assert notice.startswith(f'"{file}" is not used: '), what
        assert notice.endswith(" This case is solved again.")


@pytest.mark.parametrize(
    "text",
    [
        json.dumps({"converged": True, "measures": {"peak_amplitude_m": float("nan")}}),
        "[" * 100_000,
        "[]",
        '"text"',
        json.dumps({"results": 5, "measures": [], "warnings": 3}),
        json.dumps({"message": ["no text"]}),
    ],
)
@pytest.mark.parametrize(("outcome", "name"), [(SOLVED, "row.json"), (REJECTED, "failed.json")])
def test_what_no_row_is_is_named(
    folder: SweepFolder, cases: tuple[PlannedCase, ...], outcome: CaseOutcome, name: str, text: str
) -> None:
    folder.store(cases[0], outcome)
    file = file_of(folder, cases[0], name)
    file.write_text(text, encoding="utf-8")
    sentence = "it has no digest: it is damaged or truncated, or an older version wrote it. This case is solved again."
    assert folder.finished(cases[0]) == (None, f'"{file}" is not used: {sentence}')


def test_files_of_another_case_are_not_taken(folder: SweepFolder, cases: tuple[PlannedCase, ...]) -> None:
    folder.store(cases[0], SOLVED)
    folder.store(cases[1], replace(SOLVED, measures={"peak_amplitude_m": 1.0}, file=SOLVED.file + b"other"))
    rows = [file_of(folder, planned, "row.json") for planned in cases]
    results = [folder.results_file(planned) for planned in cases]
    whole = [rows[1].read_bytes(), results[1].read_bytes()]
    shutil.copy(rows[0], rows[1])
    assert str(rows[1]) in folder.finished(cases[1])[1]
    shutil.copy(results[0], results[1])  # both of the other case now
    assert str(rows[1]) in folder.finished(cases[1])[1]
    rows[1].write_bytes(whole[0])
    actual, notice = folder.finished(cases[1])
    assert actual is None
    assert notice == (
        f'"{results[1]}" is not used: "row.json" in the same folder belongs to another file. This case is solved again.'
    )
    results[1].write_bytes(whole[1])
    assert folder.finished(cases[1])[1] == ""


@pytest.mark.parametrize("name", ["row.json", "results.nc"])
def test_a_row_without_results_or_results_without_a_row_are_no_finished_case(
    folder: SweepFolder, cases: tuple[PlannedCase, ...], name: str
) -> None:
    folder.store(cases[0], SOLVED)
    file = file_of(folder, cases[0], name)
    file.unlink()
    assert folder.finished(cases[0]) == (None, f'"{file}" is missing. This case is solved again.')
    file.mkdir()
    assert folder.finished(cases[0]) == (
        None,
        f'"{file}" cannot be read (Is a directory). This case is solved again.',
    )


def test_the_row_is_there_before_the_results(
    folder: SweepFolder, cases: tuple[PlannedCase, ...], monkeypatch: pytest.MonkeyPatch
) -> None:

    def killed_at_results(target: Path, *arguments: object, **more: object) -> None:
        assert target.name == "results.nc"
        raise KeyboardInterrupt

    monkeypatch.setattr(sweep_folder, "write_solved", killed_at_results)
    with pytest.raises(KeyboardInterrupt):
        folder.store(cases[0], SOLVED)
    assert file_of(folder, cases[0], "row.json").exists()
    assert folder.finished(cases[0])[0] is None
