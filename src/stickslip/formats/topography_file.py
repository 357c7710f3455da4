"""Reader of measured topographies: files of instruments, through the package SurfaceTopography (an optional extra)."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.units import Quantity
from stickslip.core.validation import FloatArray

# Endings of areal formats that SurfaceTopography reads; every other file is a profile of two columns.
ENDINGS = {
    *(".al3d", ".asc", ".datx", ".frt", ".gwy", ".h5", ".ibw", ".lext", ".mnt", ".nc", ".opd", ".opdx", ".os3d"),
    *(".plu", ".plux", ".sdf", ".spm", ".sur", ".tmd", ".vk4", ".vk6", ".vk7", ".x3p", ".xyz", ".zmg"),
}
LARGEST_FILE = 2_000_000_000  # bytes: some 250 million points
MOST_MISSING = 0.2  # fraction of the points; chosen: more would make the filling, not the face, determine the slopes
INSTALL = 'Install it with: pip install "stickslip[topography]".'


@dataclass(frozen=True)
class Topography:
    """Heights of a map on an even grid, without form."""

    heights: FloatArray  # (n_y, n_x) m, second-order form removed, missing points filled
    spacing: tuple[float, float]  # (along y, along x) m
    missing: int  # points that the instrument did not measure
    tilt_fraction: float  # fraction of the variance of the heights in the mean plane
    form_fraction: float  # fraction in the second-order surface without the plane


def is_topography(path: str | PathLike[str]) -> bool:
    """Whether the ending of a file is one of an areal format."""
    return Path(path).suffix.lower() in ENDINGS


def read_topography(path: str | PathLike[str], unit: str | None = None) -> Topography:
    """The map of a file: .x3p, .sur, .al3d, .plu, .opd, Gwyddion, text with a grid, and others (``ENDINGS``).

    ``unit`` of all lengths, for files that state none. The mean second-order surface (tilt and curvature) is removed by
    least squares over the measured points; missing points are filled by a harmonic function from their edges. Raises
    InputError for a file that cannot be read, has no unit or no map, or lacks too many points, and if the package
    SurfaceTopography is not installed.
    """
    source = Path(path)
    surface = _opened(source)
    if getattr(surface, "dim", 0) != 2 or not getattr(surface, "is_uniform", False):
        raise InputError(f"{source}: the file contains no map on an even grid. Give a profile as two columns of text.")
    scale = _metres(source, surface.unit, unit)
    steps = [
        scale * float(size) / points for size, points in zip(surface.physical_sizes, surface.nb_grid_pts, strict=True)
    ]
    given = np.ma.asarray(surface.heights(), dtype=float) * scale
    measured = ~np.ma.getmaskarray(given) & np.isfinite(given.filled(np.nan))
    missing = int(measured.size - np.count_nonzero(measured))
    if missing > MOST_MISSING * measured.size:
        raise InputError(
            f"{source}: {missing} of {measured.size} points are missing, but at most {100 * MOST_MISSING:g} % may be. "
            "Measure again, or cut out a part with fewer gaps."
        )
    heights = given.filled(np.nan)
    if missing:
        heights = scale * np.asarray(surface.interpolate_undefined_data().heights(), dtype=float)
    flat, tilt, form = _without_form(heights, measured)
    return Topography(flat.T.copy(), (steps[1], steps[0]), missing, tilt, form)


def _opened(source: Path) -> Any:
    """The first map of a file as SurfaceTopography gives it. Raises InputError."""
    try:
        from SurfaceTopography import read_topography as read
    except ImportError as error:
        raise InputError(f"{source}: the package SurfaceTopography reads such files. {INSTALL}") from error
    if not source.is_file():
        raise InputError(f'the file "{source}" does not exist. Give the path of a topography.')
    if source.stat().st_size > LARGEST_FILE:
        raise InputError(f"{source}: the file is larger than {LARGEST_FILE:g} bytes. Give a part of the face.")
    try:
        return read(str(source))
    except Exception as error:  # its readers raise what the parsers of 40 formats raise
        raise InputError(
            f"{source}: SurfaceTopography cannot read the file: {error or type(error).__name__}"
        ) from error


def _metres(source: Path, stated: str | None, wanted: str | None) -> float:
    """One unit of the file in m. Raises InputError if there is none, or two."""
    if stated and wanted:
        raise InputError(f"{source}: the file states its unit, {stated}. Omit the option --unit.")
    unit = stated or wanted
    if not unit:
        raise InputError(f"{source}: the file does not state its unit. Give it with --unit, such as --unit um.")
    try:
        return Quantity("length", at_least=1e-15, at_most=1e9).parse(f"1 {unit}")
    except InputError as error:
        raise InputError(f'the unit "{unit}" {error}') from error


def _without_form(heights: FloatArray, measured: np.ndarray) -> tuple[FloatArray, float, float]:
    """Heights without their mean second-order surface, and the fractions of the variance in its plane and its rest."""
    x, y = np.meshgrid(*(np.linspace(-1.0, 1.0, points) for points in heights.shape), indexing="ij")
    terms = np.stack([np.ones_like(x), x, y, x * y, x**2, y**2], axis=-1)
    total = float(np.var(heights[measured]))
    rest = []
    flat = heights
    for count in (3, 6):
        factors = np.linalg.lstsq(terms[measured][:, :count], heights[measured], rcond=None)[0]
        flat = heights - terms[..., :count] @ factors
        rest.append(float(np.var(flat[measured])))
    if not total > 1e-24 * float(np.mean(heights[measured] ** 2)):  # round-off of an even face
        return flat, 0.0, 0.0
    return flat, 1.0 - rest[0] / total, (rest[0] - rest[1]) / total
