"""Bands with limits of a stress: against proportionality, a design and a study; resumed; rejected without a mesh."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray

import stickslip as ss
from band_cases import DAMPING, linear_study
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.model.model import reduce_structure
from stickslip.study.solution import solve_case
from stickslip.sweeps import full_structure, work
from stickslip.sweeps.band import Band
from stickslip.sweeps.design_task import DesignTask, solve_design
from stress_cases import FORCE, linear_mesh_case
from sweep_cases import quick_case

SCATTER = {FORCE: "0.1 N .. 0.3 N"}
SAMPLES = 16


def stresses_of_design(case: Case) -> dict[str, float]:
    outcome = solve_design(DesignTask(case, "key", "name", (), True, 1, False))
    assert outcome.converged, outcome.message
    return dict(outcome.details["stresses"])


@pytest.fixture(scope="module")
def per_newton() -> dict[str, float]:
    """Pa for each N of the linear case."""
    stresses = stresses_of_design(linear_mesh_case().replace({FORCE: "0.5 N"}))
    return {name: value / 0.5 for name, value in stresses.items()}


@pytest.fixture(scope="module")
def linear(per_newton: dict[str, float], tmp_path_factory: pytest.TempPathFactory) -> tuple[Band, Path]:
    """Limits that the stress of 0.25 N and of 0.15 N reaches."""
    folder = tmp_path_factory.mktemp("band")
    limits = [f"stress < {0.25 * per_newton['stress']:.9g} Pa"]
    limits += [f"alternating_stress > {0.15 * per_newton['alternating_stress']:.9g} Pa"]
    return ss.band(linear_mesh_case(), SCATTER, out=folder, samples=SAMPLES, limits=limits, workers=1), folder


@pytest.mark.slow
def test_the_stress_of_a_linear_case_is_proportional_to_the_force(
    linear: tuple[Band, Path], per_newton: dict[str, float]
) -> None:
    """A uniform force, one sample in each sixteenth of its range: 4 of 16 above 0.25 N, and 4 of 16 below 0.15 N."""
    band = linear[0]
    force = np.array(band.table.column(FORCE))
    for name, column in (("stress", "stress_pa"), ("alternating_stress", "alternating_stress_pa")):
        np.testing.assert_allclose(band.table.column(column), per_newton[name] * force, rtol=1e-6)
        expected = per_newton[name] * np.percentile(force, (5.0, 50.0, 95.0), method="hazen")
        assert band.percentiles[name].values == pytest.approx(expected.tolist(), rel=1e-6)
        # quantiles of the uniform distribution, within one of 16 parts of the range of 0.2 N
        exact = per_newton[name] * np.array([0.11, 0.2, 0.29])
        np.testing.assert_allclose(band.percentiles[name].values, exact, atol=per_newton[name] * 0.2 / SAMPLES)
        assert band.influences[name].first == pytest.approx((1.0,), abs=1e-6)
    assert [each.probability for each in band.exceedances] == [0.25, 0.25]
    assert all(each.interval[0] < 0.25 < each.interval[1] for each in band.exceedances)


@pytest.mark.slow
def test_the_stresses_are_in_all_files(linear: tuple[Band, Path]) -> None:
    band, folder = linear
    with (folder / "band.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["stress_pa"]) for row in rows] == band.table.column("stress_pa")
    with xarray.load_dataset(folder / "band.nc", engine="h5netcdf") as data:
        assert data["stress_pa"].attrs["units"] == "Pa"
        assert data["stress_percentile"].values.tolist() == list(band.percentiles["stress"].values)
        assert data["alternating_stress_sobol_total"].sel(input=FORCE) == band.influences["alternating_stress"].total[0]
        assert data["exceedance_probability"].values.tolist() == [0.25, 0.25]
    assert "Largest von Mises stress at the peak" in (folder / "band.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_samples_with_and_without_stress_resume_apart(linear: tuple[Band, Path]) -> None:
    """In either order each kind of sample uses its own results again, without a notice."""
    band, folder = linear
    kept = {FORCE: band.inputs[0][1]}
    plain = ss.band(linear_mesh_case(), kept, out=folder, samples=8, limits=["peak_amplitude < 1 mm"], workers=1)
    assert (plain.reused, plain.notices) == (0, ())
    assert "stress_pa" not in plain.table.columns
    assert not {"stress", "alternating_stress"} & {*plain.percentiles, *plain.influences}
    slow = ["stress < 1 GPa", "upward_peak_amplitude < 1 mm"]
    for reused in (0, 8):  # with checks too
        checked = ss.band(linear_mesh_case(), kept, out=folder, samples=8, limits=slow, workers=1)
        assert (checked.reused, checked.notices) == (reused, ())
    assert len([*folder.glob("cases/stress_checked_*")]) == 8
    again = ss.band(linear_mesh_case(), kept, out=folder, samples=8, limits=["stress < 1 GPa"], workers=1)
    assert (again.reused, again.notices) == (8, ())
    assert again.table.column("stress_pa") == band.table.column("stress_pa")[:8]
    assert again.table.column("peak_amplitude_m") == plain.table.column("peak_amplitude_m")
    plain_again = ss.band(linear_mesh_case(), kept, out=folder, samples=8, workers=1)
    assert (plain_again.reused, plain_again.notices) == (8, ())


@pytest.mark.slow
def test_without_a_limit_of_a_stress_no_sample_computes_one(monkeypatch: pytest.MonkeyPatch) -> None:
    def unwanted(*arguments: object) -> None:
        raise AssertionError("not wanted")

    monkeypatch.setattr(work, "full_structure", unwanted)
    monkeypatch.setattr(work, "largest_stresses_at_peak", unwanted)
    band = ss.band(linear_mesh_case(), SCATTER, samples=8, limits=["peak_amplitude < 1 mm"], workers=1)
    assert not band.table.failed


@pytest.mark.slow
def test_a_sample_has_the_stress_of_a_design_and_of_a_study() -> None:
    """Two rough blades whose damper slips, with the stress of the state at rest."""
    case = quick_case().replace({"solver.frequency_start": "450 Hz", "solver.frequency_stop": "470 Hz"})
    name = "friction.coefficient"
    band = ss.band(case, {name: "0.2 | 0.3"}, samples=8, limits=["alternating_stress < 100 MPa"], workers=1)
    row = next(row for row in band.table.rows if row.values == (0.2,))
    same = case.replace({name: 0.2})
    found = {each: row.measures[f"{each}_pa"] for each in ("stress", "alternating_stress")}
    assert found == pytest.approx(stresses_of_design(same), rel=1e-9)
    summary = solve_case(same, threads=1).record.stress
    assert summary is not None
    assert summary.static == "prescribed"
    # a study has the stress at the highest computed point, a sample at the peak between points
    factor = row.measures["peak_amplitude_m"] / summary.displacement
    assert 1.0 <= factor < 1.01
    expected = factor * summary.extreme("alternating stress").value
    assert found["alternating_stress"] == pytest.approx(expected, rel=1e-3)
    assert found["stress"] == pytest.approx(summary.extreme("largest von Mises stress").value, rel=0.01)


@pytest.mark.slow
def test_a_process_makes_a_structure_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    def counted(*arguments: object) -> object:
        made.append(arguments)
        return reduce_structure(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(full_structure, "_structures", {})
    monkeypatch.setattr(full_structure, "reduce_structure", counted)
    ss.band(linear_mesh_case(), SCATTER, samples=8, limits=["stress < 1 GPa"], workers=1)
    assert len(made) == 1


def test_a_structure_without_stress_is_rejected_before_a_folder_is_made(tmp_path: Path) -> None:
    out = tmp_path / "out"
    matrices = ss.load_case(linear_study(tmp_path))
    with rejects(InputError, "structure.kind"):
        ss.band(matrices, {FORCE: "1 mN .. 3 mN"}, out=out, limits=["stress < 300 MPa"])
    sector = ss.load_case(Path(__file__).parents[2] / "examples" / "bladed_disk.toml")
    with rejects(InputError, "structure.kind"):
        ss.band(sector, {DAMPING: "1 % .. 3 %"}, out=out, limits=["alternating_stress < 300 MPa"])
    assert not out.exists()
