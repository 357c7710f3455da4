"""Every wrong study file gets sentences with key, value and advice, exit code 2, and no traceback."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from sentences import rejects
from stickslip.case.case import Case
from stickslip.cli.main import app
from stickslip.core.errors import StudyFileError

WRONG = {
    "misspelt key": ("[material]\nyoungs_modulus = 1", ["material.youngs_modulus", "Did you mean young_modulus?"]),
    "other capitals": ("[material]\nDensity = 1", ["material.Density", "Did you mean density?"]),
    "misspelt section": ("[materiel]\ndensity = 1", ["[materiel]", "Did you mean [material]?"]),
    "unknown section": ("[qqq]\nx = 1", ["[qqq]", "Sections are study, structure, geometry"]),
    "unknown key": ("[friction]\nqqq = 1", ["friction.qqq", "Keys of [friction] are coefficient"]),
    "key of another section": ("[solver]\nseed = 1", ["solver.seed", "belongs to [roughness]"]),
    "key before the first section": ("coefficient = 0.3", ["coefficient", "belongs below the line [friction]"]),
    "section without keys": ("geometry = 5", ["geometry = 5", "must be a section", "[geometry]"]),
    "G without unit": (
        "[roughness]\nfractal_roughness = 1e-8",
        ["roughness.fractal_roughness = 1e-08", "no unit", "m and mm", "1000", '"1e-8 m"'],
    ),
    "G as text without unit": ('[roughness]\nfractal_roughness = "1e-8"', ["fractal_roughness", "no unit", '"1e-8 m"']),
    "D above its range": ("[roughness]\nfractal_dimension = 3.2", ["fractal_dimension = 3.2", "above 2 and below 3"]),
    "D of a profile": ("[roughness]\nfractal_dimension = 1.4", ["fractal_dimension = 1.4", "above 2 and below 3"]),
    "D at its limit": ("[roughness]\nfractal_dimension = 2", ["fractal_dimension = 2", "above 2 and below 3"]),
    "zero hardness": ("[roughness]\nhardness = 0", ["roughness.hardness = 0", "above 0 Pa"]),
    "short wave above sample": ('[roughness]\nshortest_length = "1 m"', ['shortest_length = "1 m"', "sample_length"]),
    "negative friction": ("[friction]\ncoefficient = -0.3", ["friction.coefficient = -0.3", "above 0"]),
    "zero friction": ("[friction]\ncoefficient = 0", ["friction.coefficient = 0", "above 0"]),
    "negative modulus": ('[material]\nyoung_modulus = "-197 GPa"', ['young_modulus = "-197 GPa"', "above 0 Pa"]),
    "zero modulus": ("[material]\nyoung_modulus = 0", ["young_modulus = 0", "above 0 Pa"]),
    "zero density": ("[material]\ndensity = 0", ["material.density = 0", "above 0 kg/m^3"]),
    "negative density": ("[material]\ndensity = -7800", ["material.density = -7800", "above 0 kg/m^3"]),
    "zero face width, so no area": (
        '[geometry]\ncontact_face_width = "0 mm"',
        ['geometry.contact_face_width = "0 mm"', "above 0"],
    ),
    "incompressible": ("[material]\npoisson_ratio = 0.5", ["poisson_ratio = 0.5", "below 0.5"]),
    "NaN": ("[material]\ndensity = nan", ["material.density = nan", "finite"]),
    "infinite": ("[preload]\ncentrifugal_force = inf", ["preload.centrifugal_force = inf", "finite"]),
    "NaN in an array": ("[preload]\nvalues = [1.0, nan]", ["preload.values[1] = nan", "finite"]),
    "unit of another kind": (
        '[geometry]\nblade_length = "145 N"',
        ['geometry.blade_length = "145 N"', "a unit of force", "a length is needed"],
    ),
    "unknown unit": ('[geometry]\nblade_length = "145 mmm"', ["unknown unit", "mmm"]),
    "millimetres without unit": ("[geometry]\nblade_length = 145", ["blade_length = 145", "at most 3 m", '"145 mm"']),
    "angle without unit": ("[geometry]\nplatform_angle = 30", ["platform_angle = 30", "no unit", '"30 deg"']),
    "circular frequency": ('[solver]\nfrequency_start = "2764 rad/s"', ["frequency_start", "rad/s", "2 pi"]),
    "too few samples": (
        "[solver]\nsamples = 10\nharmonics = 5",
        ["solver.samples = 10", "at least 11", "Take 256"],
    ),
    "too many harmonics for the default": (
        "[solver]\nharmonics = 150",
        ["solver.samples = 256 (the default)", "harmonics = 150", "at least 301"],
    ),
    "zero width": (
        '[solver]\nfrequency_start = 500\nfrequency_stop = "0.5 kHz"',
        ["solver.frequency_stop", "zero width", "downward"],
    ),
    "negative frequency": ("[solver]\nfrequency_start = -440", ["solver.frequency_start = -440", "above 0 Hz"]),
    "zero frequency": ("[solver]\nfrequency_start = 0", ["solver.frequency_start = 0", "above 0 Hz"]),
    "steps out of order": ("[solver]\nlargest_step = 0.001", ["solver.largest_step", "first_step = 0.01"]),
    "not a choice": (
        '[mesh]\nelement = "incompatable"',
        ["mesh.element", '"incompatable"', "'serendipity'", 'Did you mean "incompatible"?'],
    ),
    "half an element": ("[mesh]\nairfoil_rows = 2.5", ["mesh.airfoil_rows = 2.5", "whole number"]),
    "true for a number": ("[reduction]\nmodes = true", ["reduction.modes = true", "whole number"]),
    "text for a number": ('[friction]\ncoefficient = "slippery"', ["friction.coefficient", "slippery", "number"]),
    "number for a text": ("[study]\ntitle = 3", ["study.title = 3", "text in quotes"]),
    "number for a list": ("[preload]\nvalues = 3", ["preload.values = 3", "list"]),
    "no direction": ("[excitation]\ndirection = [0, 0, 0]", ["excitation.direction", "length zero"]),
    "direction in a plane": ("[excitation]\ndirection = [1, 0]", ["excitation.direction", "three numbers"]),
    "unknown figure format": ('[output]\nfigure_formats = ["bmp"]', ["output.figure_formats[0]", "'svg'"]),
    "two preloads": (
        "[preload]\ncentrifugal_force = 5\nvalues = [1]",
        ["preload.values", "centrifugal_force cannot both be given"],
    ),
    "two dampings": (
        "[damping]\nmodal_damping_ratio = 0.1\nrayleigh_beta = 1e-6",
        ["damping.rayleigh_beta", "modal_damping_ratio cannot both be given"],
    ),
    "two stiffnesses": (
        "[roughness]\nseed = 1\n[contact_stiffness]\nnormal_stiffness = 1e8\ntangential_stiffness = 1e8",
        ["contact_stiffness", "roughness cannot both be given"],
    ),
    "half a stiffness": ("[contact_stiffness]\nnormal_stiffness = 1e8", ["tangential_stiffness is missing"]),
    "zero stiffness": (
        "[contact_stiffness]\nnormal_stiffness = 0\ntangential_stiffness = 1e8",
        ["contact_stiffness.normal_stiffness = 0", "above 0 N/m"],
    ),
    "syntax": ("[geometry]\nblade_length = 145 mm", ["not valid TOML", "line 2", '"145 mm"']),
    "key twice": ("[friction]\ncoefficient = 1\ncoefficient = 2\n", ["not valid TOML", "line 3"]),
    "endless number": (f"[friction]\ncoefficient = {'9' * 5000}", ["not valid TOML"]),
    "empty": ("", ["empty", "stickslip new"]),
    "comments only": ("# nothing\n\n", ["empty", "stickslip new"]),
}


@pytest.mark.parametrize(("text", "parts"), WRONG.values(), ids=WRONG.keys())
def test_wrong_study_file(text: str, parts: list[str], tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    _assert_refused(path, parts)


def test_every_error_is_reported_at_once_in_the_order_of_the_file() -> None:
    text = (
        "[solver]\nsamples = 4\n[geometry]\nblade_lenght = 1\nwidth = -1\n"
        "[friction]\ncoefficient = nan\n[materiel]\nx = 1\n"
    )
    with rejects(
        StudyFileError, "solver.samples", "geometry.blade_lenght", "geometry.width", "friction.coefficient", "materiel"
    ) as caught:
        Case.from_text(text, "study.toml")
    head, *lines = str(caught.value).splitlines()
    assert head == "study.toml: 5 errors."
    assert [line.split(":")[0].strip() for line in lines] == ["line 2", "line 4", "line 5", "line 7", "line 8"]


def test_missing_file(tmp_path: Path) -> None:
    _assert_refused(tmp_path / "nowhere.toml", ["nowhere.toml", "no such file", "stickslip new"])


def test_folder_for_a_file(tmp_path: Path) -> None:
    _assert_refused(tmp_path, ["cannot be read"])


def test_not_utf8(tmp_path: Path) -> None:
    path = tmp_path / "latin.toml"
    path.write_bytes("[study]\ntitle = 'Dämpfer'".encode("latin-1"))
    _assert_refused(path, ["line 2", "UTF-8", "0xe4"])


def _assert_refused(path: Path, parts: list[str]) -> None:
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert result.stderr.startswith("Error: ")
    assert [part for part in parts if part not in result.stderr] == []
