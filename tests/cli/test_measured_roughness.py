"""The command ``stickslip roughness``: what it prints and writes, and what it refuses."""

from __future__ import annotations

import csv
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from helpers import absent_tool, matched
from instrument_files import WRITERS
from sentences import printed_sentence
from stickslip.case.case import Case, OwnCase, TwoBladeCase
from stickslip.cli.main import app
from stickslip.contact.stiffness import roughness_fit
from stickslip.contact.stiffness.fractal import ContactStatus, fractal_contact
from stickslip.contact.stiffness.surface import (
    draw_phases,
    fractal_roughness_from_sq,
    fractal_surface,
    frequency_count,
)
from stickslip.model.rough_face import case_material, case_roughness

PROFILE = Path(__file__).parents[2] / "examples" / "data" / "profile.csv"


def invoke(*arguments: object) -> Any:
    """Run ``stickslip roughness``."""
    return CliRunner().invoke(app, ["roughness", *map(str, arguments)])


@pytest.mark.long
def test_prints_lines_that_a_study_file_accepts_and_writes_files(tmp_path: Path) -> None:
    result = invoke(PROFILE, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    for words in ("1500 at 2 um, 3 mm long", "Sq ", "Sdq", "mean straight line", "4 um to 300 um"):
        assert words in result.stdout
    for words in ("1 MPa    Persson", "believable", "fractal"):
        assert words in result.stdout
    section = result.stdout.split("For the study file:\n")[1]
    values = Case.from_text(section).roughness
    assert values is not None
    assert 2.3 < values.fractal_dimension < 2.5
    assert values.sample_length == pytest.approx(3e-3, rel=1e-3)
    assert values.shortest_length == pytest.approx(4e-6)
    assert values.fractal_roughness is not None
    low, high = matched(r"G .*95 %: (\S+) to (\S+) m\)", result.stdout).groups()
    assert float(low) < 1e-9 < float(high)
    assert float(low) < values.fractal_roughness < float(high)
    assert {path.name for path in tmp_path.iterdir()} == {f"structure_function.{end}" for end in ("svg", "png", "csv")}
    with (tmp_path / "structure_function.csv").open(encoding="utf-8", newline="") as stream:
        table = list(csv.DictReader(stream))
    lag = np.array([float(row["lag_m"]) for row in table])
    assert lag[[0, -1]] == pytest.approx([4e-6, 3e-4])
    heights = 1e-6 * np.loadtxt(PROFILE, delimiter=",", skiprows=2)[:, 1]
    along = np.arange(heights.size)
    flat = heights - np.polyval(np.polyfit(along, heights, 1), along)
    assert float(table[0]["structure_function_m2"]) == pytest.approx(np.mean((flat[2:] - flat[:-2]) ** 2), rel=1e-6)


@pytest.fixture
def few_simulations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Enough simulated surfaces for a fit, where the width of its intervals does not matter."""
    monkeypatch.setattr(roughness_fit, "SIMULATIONS", 60)


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_options_reach_the_fit() -> None:
    result = invoke(PROFILE, "--scales", "10 um", "0.2 mm", "--longest-wave", "60 mm")
    assert result.exit_code == 0, result.output
    assert "10 um to 200 um" in result.stdout


@pytest.mark.long
@pytest.mark.usefixtures("few_simulations")
@pytest.mark.filterwarnings("ignore:Could not import mpi4py:ImportWarning")  # SurfaceTopography does without
@pytest.mark.parametrize("ending", ["sur", "opd", "al3d", "plu"])
def test_files_of_instruments(ending: str, tmp_path: Path) -> None:
    if find_spec("SurfaceTopography") is None:
        absent_tool("SurfaceTopography", 'pip install "stickslip[topography]".')
    y, x = np.meshgrid(2e-6 * np.arange(100), 1e-6 * np.arange(120), indexing="ij")
    scale = fractal_roughness_from_sq(1e-6, 2.3, 2e-4, 2e-6)
    heights = fractal_surface(x, y, 2.3, scale, 2e-4, 10, draw_phases(3, 10, frequency_count(2e-4, 2e-6)))
    heights[40:42, 60] = np.nan
    result = invoke(WRITERS[ending](tmp_path / f"face.{ending}", heights, (2e-6, 1e-6)))
    assert result.exit_code == 0, result.output
    for words in ("120 by 100 at 1 um by 2 um, 120 um by 200 um", "2, filled from their edges", "form removed"):
        assert words in result.stdout
    values = Case.from_text(result.stdout.split("For the study file:\n")[1]).roughness
    assert values is not None
    assert 2.2 < values.fractal_dimension < 2.4


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_a_profile_without_d_ends_with_a_sentence(tmp_path: Path) -> None:
    along = np.arange(400)
    np.savetxt(tmp_path / "smooth.txt", np.column_stack([along, 1e-4 * (along / 100.0) ** 4]))
    result = invoke(tmp_path / "smooth.txt", "--unit", "um")
    assert result.exit_code == 2
    printed_sentence(result.stderr)
    assert "D out of 2..3" in result.stdout
    assert "[roughness]" not in result.stdout


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        (("--unit", "um"), "mm"),
        (("--scales", "4", "0.2 mm"), "scale"),
        (("--scales", "4 um", "0.2 N"), "scale"),
        (("--scales", "4 um", "9 mm"), "scale"),
        (("--longest-wave", "-1 mm"), "longest wave"),
        (("--longest-wave", "1e300 m"), "longest wave"),
        (("--longest-wave", "5e-324 m"), "longest wave"),
        (("--longest-wave", "900 km"), "wave"),
        (("--scales", "1e-310 m", "1e300 m"), "scale"),
        (("--hardness", "1e300 GPa"), "roughness.hardness"),
        (("--hardness", "3"), "roughness.hardness"),
        (("--hardness", "3 mm"), "roughness.hardness"),
    ],
)
def test_bad_options_are_rejected(arguments: tuple[str, ...], key: str) -> None:
    result = invoke(PROFILE, *arguments)
    assert result.exit_code == 2
    assert result.stderr.startswith("Error: ")
    printed_sentence(result.stderr, key)
    assert "Traceback" not in result.stderr


def test_missing_file_is_named(tmp_path: Path) -> None:
    result = invoke(tmp_path / "none.txt", "--unit", "um")
    assert result.exit_code == 2
    printed_sentence(result.stderr, "none.txt")


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
@pytest.mark.parametrize("hardness", ["1 GPa", "3 GPa"])
def test_the_load_that_is_reported_parts_plastic_from_elastic_contact(hardness: str) -> None:
    result = invoke(PROFILE, "--hardness", hardness)
    assert result.exit_code == 0, result.output
    sentence, section = result.stdout.split("For the study file:\n")
    assert hardness in sentence
    case = Case.from_text(section)
    assert isinstance(case, TwoBladeCase | OwnCase)
    roughness = case_roughness(case, *[case_material(case)] * 2)
    least = float(matched(r"a load below (\S+) N", sentence).group(1))
    assert fractal_contact(roughness, 0.99 * least).status is ContactStatus.FULLY_PLASTIC
    assert fractal_contact(roughness, 0.99 * least).is_least
    assert not fractal_contact(roughness, 1.01 * least).is_least
    area = float(matched(r"critical area (\S+) m2", sentence).group(1))
    assert area == pytest.approx(fractal_contact(roughness, least).critical_area, rel=5e-3)


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_a_fractal_law_softer_than_one_round_spot_is_reported() -> None:
    """Soft metal: at 1 MPa the load is a few times that up to which all spots are plastic."""
    result = invoke(PROFILE, "--hardness", "0.6 GPa")
    assert result.exit_code == 0, result.output
    rows = [line for line in result.stdout.splitlines() if " MPa    Persson" in line or " MPa   Persson" in line]
    ratios = [float(matched(r", 1/(\S+) of one round spot", line).group(1)) for line in rows if "round spot" in line]
    warning = [line for line in result.stdout.splitlines() if line.startswith("Warning: Below one spot")]
    assert len(warning) == 1
    assert f"1/{max(ratios):.3g} of the" in warning[0]
    assert "round spot" not in rows[-1]  # at 100 MPa
    assert "Below one spot" not in invoke(PROFILE).stdout


@pytest.mark.slow
@pytest.mark.usefixtures("few_simulations")
def test_without_a_hardness_that_of_a_new_study_file_is_reported() -> None:
    assert "With the default hardness 3 GPa" in invoke(PROFILE).stdout
