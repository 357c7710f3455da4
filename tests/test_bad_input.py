"""Every wrong study file gets sentences with key, value and advice, exit code 2, and no traceback."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.load import load_case
from stickslip.cli.main import app
from stickslip.core.errors import StudyFileError

WRONG = {
    "misspelt key": ("[material]\nyoungs_modulus = 1", ("material.youngs_modulus",)),
    "other capitals": ("[material]\nDensity = 1", ("material.Density",)),
    "misspelt section": ("[materiel]\ndensity = 1", ("materiel",)),
    "unknown section": ("[qqq]\nx = 1", ("qqq",)),
    "unknown key": ("[friction]\nqqq = 1", ("friction.qqq",)),
    "key of another section": ("[solver]\nseed = 1", ("solver.seed",)),
    "key before the first section": ("coefficient = 0.3", ("coefficient",)),
    "section without keys": ("geometry = 5", ("geometry",)),
    "G without unit": (
        "[roughness]\nfractal_roughness = 1e-8",
        ("roughness.fractal_roughness",),
    ),
    "G as text without unit": ('[roughness]\nfractal_roughness = "1e-8"', ("roughness.fractal_roughness",)),
    "D above its range": ("[roughness]\nfractal_dimension = 3.2", ("roughness.fractal_dimension",)),
    "D of a profile": ("[roughness]\nfractal_dimension = 1.4", ("roughness.fractal_dimension",)),
    "D at its limit": ("[roughness]\nfractal_dimension = 2", ("roughness.fractal_dimension",)),
    "zero hardness": ("[roughness]\nhardness = 0", ("roughness.hardness",)),
    "short wave above sample": ('[roughness]\nshortest_length = "1 m"', ("roughness.shortest_length",)),
    "negative friction": ("[friction]\ncoefficient = -0.3", ("friction.coefficient",)),
    "zero friction": ("[friction]\ncoefficient = 0", ("friction.coefficient",)),
    "negative modulus": ('[material]\nyoung_modulus = "-197 GPa"', ("material.young_modulus",)),
    "zero modulus": ("[material]\nyoung_modulus = 0", ("material.young_modulus",)),
    "zero density": ("[material]\ndensity = 0", ("material.density",)),
    "negative density": ("[material]\ndensity = -7800", ("material.density",)),
    "zero face width, so no area": (
        '[geometry]\ncontact_face_width = "0 mm"',
        ("geometry.contact_face_width",),
    ),
    "incompressible": ("[material]\npoisson_ratio = 0.5", ("material.poisson_ratio",)),
    "NaN": ("[material]\ndensity = nan", ("material.density",)),
    "infinite": ("[preload]\ncentrifugal_force = inf", ("preload.centrifugal_force",)),
    "NaN in an array": ("[preload]\nvalues = [1.0, nan]", ("preload.values",)),
    "unit of another kind": (
        '[geometry]\nblade_length = "145 N"',
        ("geometry.blade_length",),
    ),
    "unknown unit": ('[geometry]\nblade_length = "145 mmm"', ("geometry.blade_length",)),
    "millimetres without unit": ("[geometry]\nblade_length = 145", ("geometry.blade_length",)),
    "angle without unit": ("[geometry]\nplatform_angle = 30", ("geometry.platform_angle",)),
    "circular frequency": ('[solver]\nfrequency_start = "2764 rad/s"', ("solver.frequency_start",)),
    "too few samples": (
        "[solver]\nsamples = 10\nharmonics = 5",
        ("solver.samples",),
    ),
    "too many harmonics for the default": (
        "[solver]\nharmonics = 150",
        ("solver.samples",),
    ),
    "zero width": (
        '[solver]\nfrequency_start = 500\nfrequency_stop = "0.5 kHz"',
        ("solver.frequency_stop",),
    ),
    "negative frequency": ("[solver]\nfrequency_start = -440", ("solver.frequency_start",)),
    "zero frequency": ("[solver]\nfrequency_start = 0", ("solver.frequency_start",)),
    "steps out of order": ("[solver]\nlargest_step = 0.001", ("solver.largest_step",)),
    "not a choice": (
        '[mesh]\nelement = "incompatable"',
        ("mesh.element",),
    ),
    "half an element": ("[mesh]\nairfoil_rows = 2.5", ("mesh.airfoil_rows",)),
    "true for a number": ("[reduction]\nmodes = true", ("reduction.modes",)),
    "text for a number": ('[friction]\ncoefficient = "slippery"', ("friction.coefficient",)),
    "number for a text": ("[study]\ntitle = 3", ("study.title",)),
    "number for a list": ("[preload]\nvalues = 3", ("preload.values",)),
    "no direction": ("[excitation]\ndirection = [0, 0, 0]", ("excitation.direction",)),
    "direction in a plane": ("[excitation]\ndirection = [1, 0]", ("excitation.direction",)),
    "unknown figure format": ('[output]\nfigure_formats = ["bmp"]', ("output.figure_formats",)),
    "two preloads": (
        "[preload]\ncentrifugal_force = 5\nvalues = [1]",
        ("preload.values",),
    ),
    "two dampings": (
        "[damping]\nmodal_damping_ratio = 0.1\nrayleigh_beta = 1e-6",
        ("damping.rayleigh_beta",),
    ),
    "two stiffnesses": (
        "[roughness]\nseed = 1\n[contact_stiffness]\nnormal_stiffness = 1e8\ntangential_stiffness = 1e8",
        ("contact_stiffness",),
    ),
    "half a stiffness": ("[contact_stiffness]\nnormal_stiffness = 1e8", ("contact_stiffness.tangential_stiffness",)),
    "zero stiffness": (
        "[contact_stiffness]\nnormal_stiffness = 0\ntangential_stiffness = 1e8",
        ("contact_stiffness.normal_stiffness",),
    ),
    "syntax": ("[geometry]\nblade_length = 145 mm", ()),
    "key twice": ("[friction]\ncoefficient = 1\ncoefficient = 2\n", ()),
    "section twice": ('[friction]\ncoefficient = 1\n[geometry]\n[friction]\nlaw = "coulomb"\n', ()),
    "endless number": (f"[friction]\ncoefficient = {'9' * 5000}", ()),
    "brackets without end": (f"[friction]\ncoefficient = {'[' * 100_000}", ()),
    "empty": ("", ()),
    "comments only": ("# nothing\n\n", ()),
}


@pytest.mark.slow
@pytest.mark.parametrize(("text", "keys"), WRONG.values(), ids=WRONG.keys())
def test_wrong_study_file(text: str, keys: tuple[str, ...], tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    _assert_rejected(path, *keys)


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
    _assert_rejected(tmp_path / "nowhere.toml")


def test_folder_for_a_file(tmp_path: Path) -> None:
    _assert_rejected(tmp_path)


def test_not_utf8(tmp_path: Path) -> None:
    path = tmp_path / "latin.toml"
    path.write_bytes("[study]\ntitle = 'Dämpfer'".encode("latin-1"))
    _assert_rejected(path)


def _assert_rejected(path: Path, *keys: str) -> None:
    """The command line prints the sentence of the Python function, and nothing else."""
    with rejects(StudyFileError, *keys) as caught:
        load_case(path)
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr == f"Error: {caught.value}\n"
