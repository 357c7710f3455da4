"""The table of a sweep: columns, cells without value, and its files."""

from __future__ import annotations

import csv
import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
import xarray

import stickslip as ss
from law_makers import iwan
from sentences import rejects
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.results.measures import SUMMARY_COLUMNS, summary
from stickslip.results.sweep_table import MEASURES, curve_and_measures
from sweep_tables import MODE, load_key, sweep_view
from synthetic import synthetic_response, synthetic_study

TABLE = sweep_view((load_key((100.0, 300.0)), MODE), [1e-4, None, 3e-4, 4e-4]).table


def test_columns_are_keys_measures_and_the_end() -> None:
    assert TABLE.columns[:3] == ("case", "preload.centrifugal_force", "excitation.mode")
    assert TABLE.columns[3 : 3 + len(MEASURES)] == MEASURES
    assert TABLE.column("excitation.mode") == ["single", "same", "single", "same"]
    peaks = TABLE.column("peak_amplitude_m")
    assert math.isnan(peaks[1])
    assert peaks[2:] == [3e-4, 4e-4]
    assert [row.name for row in TABLE.failed] == ["case-1"]
    with rejects(InputError):
        TABLE.column("peak")


def test_csv_keeps_every_digit_and_leaves_cells_empty(tmp_path: Path) -> None:
    TABLE.to_csv(tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert tuple(rows[0]) == TABLE.columns
    assert float(rows[3]["peak_frequency_hz"]) == 463.0
    assert (rows[0]["pairs_stuck"], rows[0]["converged"], rows[0]["warnings"]) == ("3", "yes", "Too few samples.")
    assert (rows[1]["peak_amplitude_m"], rows[1]["converged"], rows[1]["message"]) == ("", "no", "No <first> point.")
    assert [path.name for path in tmp_path.iterdir()] == ["t.csv"]


@pytest.mark.slow
def test_netcdf_has_units_and_words(tmp_path: Path) -> None:
    TABLE.to_netcdf(tmp_path / "t.nc")
    data = xarray.load_dataset(tmp_path / "t.nc", engine="h5netcdf")
    xarray.testing.assert_identical(data, TABLE.to_dataset())
    assert data["preload.centrifugal_force"].attrs["units"] == "N"
    assert data["shift_from_stuck_hz"].attrs["units"] == "Hz"
    np.testing.assert_array_equal(data["converged"], [1, 0, 1, 1])
    assert all("long_name" in data[name].attrs for name in data.variables)


@pytest.mark.slow
def test_a_body_with_a_slash_in_its_name_loses_no_table(tmp_path: Path) -> None:
    key = dataclasses.replace(load_key((100.0, 300.0)), name="bodies.Part/Body.density")
    table = sweep_view((key, MODE), [1e-4, None, 3e-4, 4e-4]).table
    table.to_netcdf(tmp_path / "t.nc")
    data = xarray.load_dataset(tmp_path / "t.nc", engine="h5netcdf")
    np.testing.assert_array_equal(data["bodies.Part%2FBody.density"], [100.0, 100.0, 300.0, 300.0])
    assert data["bodies.Part%2FBody.density"].attrs["long_name"].startswith("bodies.Part/Body.density")


@pytest.mark.slow
def test_a_place_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    for write in (TABLE.to_csv, TABLE.to_netcdf):
        with rejects(ResultsFileError):
            write(tmp_path / "nowhere" / "t")


def test_an_iwan_joint_in_microslip_is_in_the_column_of_stick_slip() -> None:
    """A part of its patch slips at any amplitude; the description of the column says so."""
    response = ss.forced_response(
        ss.Superelement(np.eye(3), 4e5 * np.eye(3), 60.0 * np.eye(3)),
        ss.ContactPairs.with_laws(np.eye(3), [iwan(2e5, 5.0, -0.5, 0.1, 5e5)]),
        np.array([1e-3, 0.0, 0.0]), frequency_hz=(112.0, 112.5), harmonics=1, samples=64,
    )  # fmt: skip
    _, words, count = SUMMARY_COLUMNS["pairs_stick_slip"]
    assert count(summary(response, np.array([1.0, 0.0, 0.0]))) == 1
    assert response.pairs.state_names[ss.ContactState.STICK_SLIP] == "microslip"
    assert "Iwan" in words


def test_measures_that_are_not_defined_are_left_out() -> None:
    response, study = synthetic_response(), synthetic_study()
    curve, measures = curve_and_measures(response, study)
    assert curve.amplitude_m.shape == curve.frequency_hz.shape == (response.n_points,)
    assert set(measures) <= set(MEASURES)
    assert not any(math.isnan(value) for value in measures.values())
    assert measures["pairs_stuck"] + measures["pairs_stick_slip"] + measures["pairs_separating"] == 110
