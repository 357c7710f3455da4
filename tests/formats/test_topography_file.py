"""Maps of instruments: units, form and missing points, and the files that are rejected."""

from __future__ import annotations

import struct
import sys
import zipfile
from hashlib import md5
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from helpers import absent_tool
from sentences import rejects
from stickslip.formats.topography_file import Topography, is_topography, read_topography

# NuMPI, which SurfaceTopography uses, warns that MPI is not installed.
pytestmark = pytest.mark.filterwarnings("ignore:Could not import mpi4py:ImportWarning")

X3P = """<?xml version="1.0" encoding="UTF-8"?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2"><Record1><Revision>ISO5436 - 2000</Revision>
<FeatureType>SUR</FeatureType><Axes>
<CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{x}</Increment><Offset>0</Offset></CX>
<CY><AxisType>I</AxisType><DataType>D</DataType><Increment>{y}</Increment><Offset>0</Offset></CY>
<CZ><AxisType>A</AxisType><DataType>D</DataType></CZ></Axes></Record1>
<Record2><Date>2026-01-01T00:00:00</Date><Instrument><Manufacturer>none</Manufacturer><Model>none</Model>
<Serial>none</Serial><Version>0</Version></Instrument><CalibrationDate>2026-01-01T00:00:00</CalibrationDate>
<ProbingSystem><Type>NonContacting</Type><Identification>none</Identification></ProbingSystem></Record2>
<Record3><MatrixDimension><SizeX>{nx}</SizeX><SizeY>{ny}</SizeY><SizeZ>1</SizeZ></MatrixDimension>
<DataLink><PointDataLink>bindata/data.bin</PointDataLink><MD5ChecksumPointData>{sum}</MD5ChecksumPointData></DataLink>
</Record3><Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4></p:ISO5436_2>"""


@pytest.fixture
def package() -> None:
    if find_spec("SurfaceTopography") is None:
        absent_tool("SurfaceTopography", 'pip install "stickslip[topography]".')


def write_x3p(path: Path, heights: np.ndarray, spacing: tuple[float, float]) -> Path:
    """A file of ISO 25178-72 with heights (n_y, n_x) in m; NaN is a missing point."""
    data = heights.astype("<f8").tobytes()
    text = X3P.format(
        x=spacing[1], y=spacing[0], nx=heights.shape[1], ny=heights.shape[0], sum=md5(data).hexdigest().upper()
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("main.xml", text)
        archive.writestr("bindata/data.bin", data)
        archive.writestr("md5checksum.hex", f"{md5(text.encode()).hexdigest()} *main.xml")
    return path


def write_gwy(path: Path, heights: np.ndarray, spacing: tuple[float, float]) -> Path:
    """A file of Gwyddion with heights (n_y, n_x) in m, by the chapter "Gwyddion native format" of its user guide."""

    def item(name: str, kind: str, data: bytes) -> bytes:
        return name.encode() + b"\0" + kind.encode() + data

    def thing(name: str, *items: bytes) -> bytes:
        body = b"".join(items)
        return name.encode() + b"\0" + struct.pack("<I", len(body)) + body

    metre = thing("GwySIUnit", item("unitstr", "s", b"m\0"))
    field = [
        *(item(f"{axis}res", "i", struct.pack("<i", count)) for axis, count in zip("yx", heights.shape, strict=True)),
        *(
            item(f"{axis}real", "d", struct.pack("<d", count * step))
            for axis, count, step in zip("yx", heights.shape, spacing, strict=True)
        ),
        *(item(f"si_unit_{axes}", "o", metre) for axes in ("xy", "z")),
        item("data", "D", struct.pack("<I", heights.size) + heights.astype("<f8").tobytes()),
    ]
    entries = item("/0/data", "o", thing("GwyDataField", *field)), item("/0/data/title", "s", b"height\0")
    path.write_bytes(b"GWYP" + thing("GwyContainer", *entries))
    return path


def bumps(rows: int = 60, columns: int = 90) -> np.ndarray:
    """Waves of 1 um without any tilt or curvature over the map."""
    y, x = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    return np.asarray(1e-6 * np.cos(2 * np.pi * x / 9) * np.cos(2 * np.pi * y / 6))


@pytest.mark.slow
@pytest.mark.usefixtures("package")
def test_a_file_of_gwyddion_has_its_own_units_and_axes(tmp_path: Path) -> None:
    found = read_topography(write_gwy(tmp_path / "face.gwy", bumps(), (2e-6, 1e-6)))
    assert found.heights.shape == (60, 90)
    assert found.spacing == pytest.approx((2e-6, 1e-6))
    assert found.missing == 0
    assert found.heights == pytest.approx(bumps(), abs=0.02e-6)


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
