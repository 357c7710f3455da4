"""Maps of instruments: units, form and missing points, and the files that are rejected."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from helpers import absent_tool
from instrument_files import WRITERS, write_x3p
from sentences import rejects
from stickslip.formats.topography_file import Topography, is_topography, read_topography

# NuMPI, which SurfaceTopography uses, warns that MPI is not installed.
pytestmark = pytest.mark.filterwarnings("ignore:Could not import mpi4py:ImportWarning")


@pytest.fixture
def package() -> None:
    if find_spec("SurfaceTopography") is None:
        absent_tool("SurfaceTopography", 'pip install "stickslip[topography]".')


def bumps(rows: int = 60, columns: int = 90) -> np.ndarray:
    """Waves of 1 um without any tilt or curvature over the map."""
    y, x = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    return np.asarray(1e-6 * np.cos(2 * np.pi * x / 9) * np.cos(2 * np.pi * y / 6))


def leaning() -> np.ndarray:
    """Waves that differ from their mirror images, so wrong axes or signs show."""
    y, x = np.meshgrid(np.arange(60), np.arange(91), indexing="ij")
    return np.asarray(0.3e-6 * np.sin(2 * np.pi * (x + 2 * y) / 13) + 1e-6 * np.cos(2 * np.pi * x / 9) ** 4)


@pytest.mark.slow
@pytest.mark.usefixtures("package")
@pytest.mark.parametrize("ending", WRITERS)
def test_files_of_instruments_have_their_own_units_and_axes(ending: str, tmp_path: Path) -> None:
    given = leaning()
    found = read_topography(WRITERS[ending](tmp_path / f"face.{ending}", given, (2e-6, 1e-6)))
    assert found.heights.shape == given.shape
    assert found.spacing == pytest.approx((2e-6, 1e-6), rel=1e-6)  # .opd has single precision
    assert found.missing == 0
    assert found.heights == pytest.approx(given - given.mean(), abs=0.05e-6)  # the form takes some of the waves


@pytest.mark.slow
@pytest.mark.usefixtures("package")
@pytest.mark.parametrize("ending", ["sur", "opd", "al3d", "plu"])
def test_each_format_marks_missing_points_in_its_own_way(ending: str, tmp_path: Path) -> None:
    given = leaning()
    given[20:22, 30:33] = np.nan
    found = read_topography(WRITERS[ending](tmp_path / f"face.{ending}", given, (1e-6, 1e-6)))
    assert found.missing == 6
    assert np.abs(found.heights).max() < 1.3e-6


@pytest.mark.slow
@pytest.mark.usefixtures("package")
def test_form_is_removed_and_reported(tmp_path: Path) -> None:
    y, x = np.meshgrid(np.linspace(-1, 1, 60), np.linspace(-1, 1, 90), indexing="ij")
    given = bumps() + 20e-6 * x - 5e-6 * y + 8e-6 * x**2
    found = read_topography(write_x3p(tmp_path / "face.x3p", given, (2e-6, 1e-6)))
    assert found.heights.shape == (60, 90)
    assert found.spacing == pytest.approx((2e-6, 1e-6))
    assert found.missing == 0
    assert found.heights == pytest.approx(bumps(), abs=0.02e-6)
    total = np.var(given)
    assert found.tilt_fraction == pytest.approx((np.var(20e-6 * x) + np.var(5e-6 * y)) / total, rel=0.02)
    assert found.form_fraction == pytest.approx(np.var(8e-6 * x**2) / total, rel=0.05)


@pytest.mark.slow
@pytest.mark.usefixtures("package")
def test_missing_points_are_filled_from_their_edges(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    given = bumps()
    given[20:22, 30:33] = np.nan
    found = read_topography(write_x3p(Path("face.x3p"), given, (1e-6, 1e-6)))
    assert found.missing == 6
    assert np.isfinite(found.heights).all()
    assert np.abs(found.heights).max() < 1.1e-6
    given[:20] = np.nan
    with rejects(ss.InputError):
        read_topography(write_x3p(Path("face.x3p"), given, (1e-6, 1e-6)))


@pytest.mark.slow
@pytest.mark.usefixtures("package")
def test_files_that_cannot_be_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("broken.x3p").write_bytes(b"no archive")
    with rejects(ss.InputError):
        read_topography("broken.x3p")
    with rejects(ss.InputError):
        read_topography("missing.sur")
    write_x3p(Path("face.x3p"), bumps(), (1e-6, 1e-6))
    with rejects(ss.InputError):
        read_topography("face.x3p", unit="um")


def test_without_the_package_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with rejects(ss.InputError):
        read_topography("face.x3p")


def test_endings_of_maps() -> None:
    assert all(is_topography(f"face.{ending}") for ending in ("x3p", "sur", "SUR", "al3d", "plu", "opd", "gwy"))
    assert not any(is_topography(f"face.{ending}") for ending in ("csv", "txt", "dat", "prf"))
    assert not is_topography("face")


def test_a_flat_map_has_no_form() -> None:
    from stickslip.formats.topography_file import _without_form

    flat, tilt, form = _without_form(np.full((5, 7), 3e-6), np.ones((5, 7), dtype=bool))
    assert (tilt, form) == (0.0, 0.0)
    assert flat == pytest.approx(0.0, abs=1e-18)
    assert isinstance(Topography(flat, (1.0, 1.0), 0, tilt, form), Topography)
