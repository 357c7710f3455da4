"""Tables of a result and their files, read back by other programs: csv, openpyxl, scipy.io."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from ridges import ridge_of
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.results.measures import summary
from stickslip.results.pair_measures import pair_measures
from stickslip.results.peak_gradients import PeakGradients
from stickslip.results.storage import save_results
from stickslip.results.stress import Region, StressExtreme, StressSummary
from stickslip.results.table import Column, Table, column_of
from stickslip.results.table_files import write_matlab, write_workbook
from stickslip.results.tables import study_tables
from stickslip.results.wear import Wear
from stickslip.study.export import export_tables
from synthetic import synthetic_response, synthetic_study
from synthetic_mode import with_mode

CORNER = StressExtreme("alternating stress", 31.9e6, "left blade", (0.1, 0.0, -0.2), Region.ORDINARY)
STRESS = StressSummary((CORNER,), (CORNER,), (), "No check.", "prescribed", 450.0, 300.0, 2e-4, 0.02)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("solved")
    study = replace(synthetic_study(), stress=STRESS, warnings=("=1+1 is no formula", "Zweite Zeile\nmit µ"))
    save_results(place / "results.nc", synthetic_response(), study)
    return place


def tables() -> dict[str, Table]:
    study = replace(synthetic_study(), stress=STRESS)
    return {table.name: table for table in study_tables(synthetic_response(), study)}


def column(table: Table, name: str) -> Column:
    return next(each for each in table.columns if each.name == name)


def test_the_tables_contain_the_numbers_of_the_result() -> None:
    response, study, made = synthetic_response(), synthetic_study(), tables()
    row = study.outputs[study.response_output]
    curve = made["curve"]
    assert column(curve, "frequency").values == tuple(response.frequency_hz)
    assert column(curve, "frequency").unit == "Hz"
    assert column(curve, f"amplitude of {study.response_output}").values == tuple(response.amplitude(row))
    assert sum(len(each.values) for each in made["pairs_at_peak"].columns[:1]) == response.pairs.n_pairs
    top = int(response.amplitude(row).argmax())
    energies = np.array(column(made["pairs_at_peak"], "dissipated energy").values, dtype=float)
    assert energies == pytest.approx(response.dissipated_energy[top])
    pairs = pair_measures(response, top)
    for name, values in (
        ("stick fraction", pairs.stick_fraction),
        ("slip fraction", pairs.slip_fraction),
        ("separated fraction", pairs.separated_fraction),
        ("slip distance", pairs.slip_distance),
        ("mean normal pressure", pairs.mean_normal_force / study.pair_area),
    ):
        assert column(made["pairs_at_peak"], name).values == tuple(values)
    measures = dict(zip(made["measures"].columns[0].values, made["measures"].columns[1].values, strict=True))
    assert measures["peak_amplitude_m"] == summary(response, row).peak.amplitude
    assert made["stress"].columns[1].values == (31.9e6,)
    assert ("load.centrifugal_force", "78 N") in list(made["inputs"].rows)
    assert {"linear_limits", "outputs_at_peak", "natural_frequencies", "modes", "derived", "provenance"} <= made.keys()
    assert "safety_factors" not in made  # without rows


def test_gradients_and_ridges_are_tables() -> None:
    one = np.array([2.0])
    peak = {"amplitude": one[0], "frequency_hz": one[0], "friction_energy": one[0]}
    gradients = PeakGradients(
        ("friction.coefficient",), ("1",), one, **peak, by_amplitude=one, by_frequency_hz=one, by_friction_energy=one,
        error_amplitude=one, error_frequency_hz=one, error_friction_energy=one,
    )  # fmt: skip
    ridge = ridge_of((np.array([1.0, 2.0]), np.array([3e-5, 4e-5])), (np.array([2.0]), np.array([5e-5])))
    response = replace(synthetic_response(), gradients=gradients, peak_ridge=ridge)
    made = {table.name: table for table in study_tables(response, synthetic_study())}
    assert next(iter(made["gradients"].rows))[:3] == ("friction.coefficient", 2.0, "1")
    points = [column(made["peak_ridge"], name).values for name in ("load", "amplitude of tip", "ridge")]
    assert points == [(1.0, 2.0, 2.0), (3e-5, 4e-5, 5e-5), (1, 1, 2)]
    assert column(made["peak_ridge"], "load").unit == "N"
    assert "performance_curve" not in made


@pytest.mark.slow
def test_csv_has_every_digit_and_units_in_its_heading(folder: Path) -> None:
    files = export_tables(folder, "csv")
    assert {file.parent for file in files} == {folder / "tables"}
    with (folder / "tables" / "curve.csv").open(encoding="utf-8", newline="") as stream:
        heading, *rows = csv.reader(stream)
    assert heading[:2] == ["point", "frequency [Hz]"]
    assert [float(row[1]) for row in rows] == synthetic_response().frequency_hz.tolist()
    with (folder / "tables" / "warnings.csv").open(encoding="utf-8", newline="") as stream:
        assert ["Zweite Zeile\nmit µ"] in list(csv.reader(stream))


@pytest.mark.slow
def test_a_workbook_has_a_sheet_for_each_table_and_no_formula(folder: Path) -> None:
    from openpyxl import load_workbook

    (file,) = export_tables(folder, "xlsx")
    book = load_workbook(file)
    made = {
        table.name: table for table in study_tables(synthetic_response(), replace(synthetic_study(), stress=STRESS))
    }
    assert {"tables", "curve", "stress", "warnings"} <= set(book.sheetnames)
    frequency = [cell.value for cell in book["curve"]["B"][1:]]
    assert frequency == pytest.approx(list(column(made["curve"], "frequency").values))
    cell = book["warnings"]["A2"]
    assert (cell.value, cell.data_type) == ("=1+1 is no formula", "s")
    assert [row[0].value for row in book["tables"].iter_rows(min_row=2)] == book.sheetnames[1:]


@pytest.mark.slow
def test_matlab_has_a_structure_for_each_table(folder: Path) -> None:
    from scipy.io import loadmat

    (file,) = export_tables(folder, "mat")
    content: Any = loadmat(file, simplify_cells=True)
    np.testing.assert_array_equal(content["curve"]["frequency"], synthetic_response().frequency_hz)
    assert content["curve"]["units"]["frequency"] == "Hz"
    assert content["pairs_at_peak"]["face"][0] == "Left face"
    assert content["stress"]["value"] == 31.9e6


def test_names_of_matlab_differ_and_control_characters_do_not_stop_a_workbook(tmp_path: Path) -> None:
    from scipy.io import loadmat

    columns = (Column("a-b", "", (1.0, None)), Column("a b", "m", (2.0, 3.0)), Column("1st", "", ("x\x07", None)))
    table = Table("odd", "odd names", columns)
    write_workbook(tmp_path / "odd.xlsx", [table])
    write_matlab(tmp_path / "odd.mat", [table])
    odd: Any = loadmat(tmp_path / "odd.mat", simplify_cells=True)["odd"]
    assert odd["a_b"][0] == 1.0
    assert np.isnan(odd["a_b"][1])
    assert odd["a_b_2"].tolist() == [2.0, 3.0]
    assert odd["units"]["a_b_2"] == "m"
    assert odd["x1st"][0] == "x\x07"


@pytest.mark.slow
def test_wrong_requests_are_rejected_before_anything_is_written(folder: Path, tmp_path: Path) -> None:
    with rejects(InputError, "to"):
        export_tables(folder, "ods")
    with rejects(InputError):
        export_tables(tmp_path, "csv")
    with rejects(InputError):
        export_tables(folder, "xlsx", tmp_path / "tables.csv")
    existing = tmp_path / "tables.mat"
    existing.write_bytes(b"mine")
    with rejects(InputError):
        export_tables(folder, "mat", existing)
    assert existing.read_bytes() == b"mine"
    assert export_tables(folder, "mat", existing, force=True) == (existing,)
    save_results(tmp_path / "results.nc", synthetic_response())
    with rejects(InputError):
        export_tables(tmp_path, "csv")
    assert not (tmp_path / "tables").exists()
    with rejects(InputError):
        replace(synthetic_study(), inputs="not = = toml").input_values()
    with rejects(InputError):
        Table("uneven", "", (Column("a", "", (1,)), Column("b", "", ())))


class Counted:
    """A part of a response, as another analysis would add it."""

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        yield Table(name, "counts", (column_of("count", "", [1, 2]),))

    def closing_words(self, name: str) -> Iterator[str]:
        yield f"{name}: two counts"


def test_the_tables_of_a_part_come_from_the_part() -> None:
    response = synthetic_response()
    assert response.parts == {}
    with_part = replace(response, wear=cast("Wear", Counted()))
    assert list(with_part.parts) == ["wear"]
    extra = [table for table in study_tables(with_part, synthetic_study()) if table.name == "wear"]
    assert [table.columns[0].values for table in extra] == [(1, 2)]


def test_the_table_of_a_mode_has_the_amplitudes_of_the_responses_and_all_energies() -> None:
    response, study = with_mode(0.01), synthetic_study(columns=4, rows=3)
    mode = response.nonlinear_mode
    assert mode is not None
    (table,) = (each for each in study_tables(response, study) if each.name == "nonlinear_mode")
    for name, row in study.outputs.items():
        amplitude = column(table, f"first-harmonic amplitude of {name}")
        assert amplitude.unit == "m"
        coefficients = mode.coefficients(row)
        np.testing.assert_allclose(np.array(amplitude.values), np.hypot(coefficients[:, 1], coefficients[:, 2]))
    for name, energy in (
        ("friction energy of all pairs", mode.dissipated_energy.sum(axis=1)),
        ("viscous energy", mode.viscous_energy),
        ("supplied energy", mode.input_energy),
    ):
        np.testing.assert_array_equal(column(table, name).values, energy)
