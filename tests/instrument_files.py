"""Writers of small files of instruments for areal topography, each from the published layout of its format.

Heights are (n_y, n_x) in m with the spacing (along y, along x) in m; NaN is a missing point. The layouts of .sur, .opd,
.al3d and .plu are those that the modules surffile, opdfile, alicona and sensofar of Gwyddion document.
"""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Callable
from hashlib import md5
from pathlib import Path

import numpy as np

from stickslip.core.validation import FloatArray

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


def write_x3p(path: Path, heights: FloatArray, spacing: tuple[float, float]) -> Path:
    """A file of ISO 25178-72."""
    data = heights.astype("<f8").tobytes()
    text = X3P.format(
        x=spacing[1], y=spacing[0], nx=heights.shape[1], ny=heights.shape[0], sum=md5(data).hexdigest().upper()
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("main.xml", text)
        archive.writestr("bindata/data.bin", data)
        archive.writestr("md5checksum.hex", f"{md5(text.encode()).hexdigest()} *main.xml")
    return path


def write_gwy(path: Path, heights: FloatArray, spacing: tuple[float, float]) -> Path:
    """A file of Gwyddion, by the chapter "Gwyddion native format" of its user guide; without missing points."""

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


def write_sur(path: Path, heights: FloatArray, spacing: tuple[float, float]) -> Path:
    """A file of Digital Surf: 512 bytes of header, whole numbers of 1e-4 um; missing points are zmin - 2."""
    step = 1e-10
    rows, columns = heights.shape
    measured = np.isfinite(heights)
    levels = np.round(np.where(measured, heights, 0.0) / step).astype("<i4")
    low, high = int(levels[measured].min()), int(levels[measured].max())
    levels[~measured] = low - 2
    units = [text.encode().ljust(16) for text in ("X", "Y", "Z", *6 * ["um"])]
    header = b"".join(
        (
            struct.pack("<12s4H30s30s", b"DIGITAL SURF", 0, 1, 1, 2, b"face".ljust(30), b"none".ljust(30)),
            struct.pack("<5H8xH", 0, 0, 0, 0 if measured.all() else 1, 1, 32),  # ..., bits of a point
            struct.pack("<4iI", low, high, columns, rows, rows * columns),
            struct.pack("<3f", 1e6 * spacing[1], 1e6 * spacing[0], 1e6 * step),
            *units,
            struct.pack("<3f3H12x", 1.0, 1.0, 1.0, 0, 0, 0),  # ratios of the units; imprint, inversion, levelling
            struct.pack("<7Hf10x2H", 0, 0, 0, 1, 1, 2026, 4, 0.0, 0, 0),  # date; sizes of the comments
            struct.pack("<128s3f34x", b"", 0.0, 0.0, 0.0),
        )
    )
    assert len(header) == 512
    path.write_bytes(header + levels.tobytes())
    return path


def write_opd(path: Path, heights: FloatArray, spacing: tuple[float, float]) -> Path:
    """A file of Wyko: a directory, then its blocks; heights in wavelengths (nm), by columns from below, sizes in mm."""
    wavelength = 500.0
    rows, columns = heights.shape
    # 1e38 and above is a missing point.
    points = np.where(np.isfinite(heights), heights / (1e-9 * wavelength), 1e38 * 1.01)[::-1].T.astype("<f4")
    blocks = [
        ("RAW_DATA", 3, struct.pack("<3H", columns, rows, 4) + points.tobytes()),
        ("Wavelength", 7, struct.pack("<f", wavelength)),
        ("Mult", 6, struct.pack("<h", 1)),
        ("Aspect", 7, struct.pack("<f", spacing[0] / spacing[1])),
        ("Pixel_size", 7, struct.pack("<f", 1e3 * spacing[1])),
    ]
    entries = [("Directory", 1, 24 * (len(blocks) + 1)), *((name, kind, len(data)) for name, kind, data in blocks)]
    directory = b"".join(struct.pack("<16shlH", name.encode(), kind, size, 0) for name, kind, size in entries)
    path.write_bytes(b"\x01\x00" + directory + b"".join(data for _, _, data in blocks))
    return path


def write_al3d(path: Path, heights: FloatArray, spacing: tuple[float, float]) -> Path:
    """A file of Alicona: tags of text, a comment, then heights in m in rows of a multiple of 8 bytes."""
    rows, columns = heights.shape
    values = {
        "Cols": columns,
        "Rows": rows,
        "PixelSizeXMeter": repr(spacing[1]),
        "PixelSizeYMeter": repr(spacing[0]),
        "InvalidPixelValue": "NaN",
    }
    magic = b"AliconaImaging\x00\r\n"
    offset = len(magic) + 52 * (len(values) + 3) + 256
    tags = {"Version": 1, "TagCount": len(values) + 1, **values, "DepthImageOffset": offset}
    text = b"".join(struct.pack("20s30s2s", key.encode(), str(value).encode(), b"\r\n") for key, value in tags.items())
    padded = np.zeros((rows, columns + columns % 2), dtype="<f4")
    padded[:, :columns] = heights
    path.write_bytes(magic + text + bytes(254) + b"\r\n" + padded.tobytes())
    return path


def write_plu(path: Path, heights: FloatArray, spacing: tuple[float, float]) -> Path:
    """A file of Sensofar with one layer and no images; heights and spacing in um, 1000001 is a missing point."""
    rows, columns = heights.shape
    layer = np.where(np.isfinite(heights), 1e6 * heights, 1000001.0).astype("<f4")
    parts = (
        struct.pack("<128sI256s", b"Thu Jan 01 00:00:00 2026", 0, b""),
        struct.pack("<3I7f", rows, columns, rows, 1.0, 1e6 * spacing[1], 1e6 * spacing[0], 0.0, 0.0, 1.0, 0.0),
        struct.pack("<5I", 3, 0, 0, 0, 0),  # 3: a topography
        struct.pack("<5Id1f2I", columns, rows, columns, rows, 0, 1.0, 10.0, 1, 0),  # of the scan
        struct.pack("<8BI", 0, 1, 0xFA, 0, 0, 0, 0, 0, 1),  # one layer, version 2013, no images
        struct.pack("<2I", rows, columns) + layer.tobytes() + struct.pack("<2f", 0.0, 1.0),
    )
    path.write_bytes(b"".join(parts))
    return path


WRITERS: dict[str, Callable[[Path, FloatArray, tuple[float, float]], Path]] = {
    "x3p": write_x3p,
    "gwy": write_gwy,
    "sur": write_sur,
    "opd": write_opd,
    "al3d": write_al3d,
    "plu": write_plu,
}
