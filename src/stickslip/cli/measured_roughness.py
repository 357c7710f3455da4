"""From a measured profile or map to the lines of a study file: what ``stickslip roughness`` prints and writes."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from math import exp
from os import PathLike
from pathlib import Path

from stickslip.case.case import TwoBladeCase
from stickslip.contact.stiffness.asperities import fully_plastic_load, log_critical_area
from stickslip.contact.stiffness.believable import BesideOneSpot, beside_one_spot, compared, fraction
from stickslip.contact.stiffness.face_stiffness import law_of_roughness, persson_law
from stickslip.contact.stiffness.fractal import Roughness
from stickslip.contact.stiffness.measured_lines import Interval
from stickslip.contact.stiffness.roughness_fit import RoughnessFit, fit_roughness
from stickslip.contact.stiffness.stiffness_law import StiffnessLaw
from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.units import Quantity
from stickslip.formats.profile_file import Profile, read_profile
from stickslip.formats.topography_file import Topography, is_topography, read_topography
from stickslip.model.rough_face import case_material, case_roughness

TABLE = "structure_function.csv"
FORMATS = ("svg", "png")
FACE_AREA = 1e-4  # m2, of the face whose stiffness the command shows
PRESSURES = (1e6, 1e7, 1e8)  # Pa


@dataclass(frozen=True)
class MeasuredRoughness:
    """A profile or a map, and its fit."""

    surface: Profile | Topography
    fit: RoughnessFit

    @property
    def points(self) -> str:
        """Number of points, their spacing and the size of the measurement, in words."""
        if isinstance(self.surface, Profile):
            points, spacing = self.surface.heights.size, self.surface.spacing
            return f"{points} at {_shown(spacing)}, {_shown(points * spacing)} long"
        rows, columns = self.surface.heights.shape
        along_y, along_x = self.surface.spacing
        return (
            f"{columns} by {rows} at {_shown(along_x)} by {_shown(along_y)}, {_shown(columns * along_x)} by "
            f"{_shown(rows * along_y)}"
        )

    @property
    def waves(self) -> tuple[float, float]:
        """Longest and shortest wave of the measurement in m: its length, and two spacings."""
        if isinstance(self.surface, Profile):
            return self.surface.heights.size * self.surface.spacing, 2.0 * self.surface.spacing
        along = [n * step for n, step in zip(self.surface.heights.shape, self.surface.spacing, strict=True)]
        return max(along), 2.0 * min(self.surface.spacing)


def measure(
    path: str | PathLike[str],
    position_unit: str | None = None,
    height_unit: str | None = None,
    scales: tuple[str, str] | None = None,
    longest_wave: str | None = None,
) -> MeasuredRoughness:
    """Read a profile and fit D and G; ``scales`` and ``longest_wave`` are texts with a unit, such as "4 um".

    Raises InputError for a file, unit or value that cannot be used.
    """
    limits = None if scales is None else (_length("scale", scales[0]), _length("scale", scales[1]))
    wave = None if longest_wave is None else _length("longest wave", longest_wave)
    surface = _read(path, position_unit, height_unit)
    try:
        fit = fit_roughness(surface.heights, surface.spacing, scales=limits, longest_wave=wave)
        return MeasuredRoughness(surface, fit)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _read(path: str | PathLike[str], position_unit: str | None, height_unit: str | None) -> Profile | Topography:
    if not is_topography(path):
        return read_profile(path, position_unit, height_unit)
    if position_unit != height_unit:
        raise InputError(f"{path}: a map has one unit of length. Give --unit instead of the units of the columns.")
    return read_topography(path, height_unit)


def _length(name: str, text: str) -> float:
    try:
        limits = Quantity("length", at_least=1e-12, at_most=1e6, unit_required="A length needs its unit.")
        return limits.parse(text)
    except InputError as error:
        raise InputError(f'the {name} "{text}" {error}') from error


def rows(measured: MeasuredRoughness) -> list[tuple[str, str]]:
    """(label, value) of the result."""
    surface, fit = measured.surface, measured.fit
    low, high = fit.scale_range
    table = [("points", measured.points)]
    if isinstance(surface, Profile):
        table.append(("units", f"position in {surface.units[0]}, height in {surface.units[1]}"))
    else:
        form = f"plane ({100 * surface.tilt_fraction:.2g} % of the variance), second-order form "
        table.append(("missing points", f"{surface.missing}, filled from their edges" if surface.missing else "none"))
        table.append(("form removed", f"{form}({100 * surface.form_fraction:.2g} %)"))
    table += [
        ("removed", "mean straight line; the fit allows for it"),
        ("Sq", f"{_shown(fit.rms_height)} about that line"),
        ("Sdq", f"{fit.rms_slope:.3g} at the scale {_shown(fit.slope_scale)}, if the surface is isotropic"),
        ("scales of the fit", f"{_shown(low)} to {_shown(high)}"),
    ]
    if fit.noise_height:
        table.append(("noise", f"{_shown(fit.noise_height)} rms, not included in D and G"))
    if fit.usable:
        table += [
            ("D of the surface", f"{fit.fractal_dimension:.3f} {_between(fit.fractal_dimension_interval, '.3f')}"),
            ("G", f"{fit.fractal_roughness:.3g} m {_between(fit.fractal_roughness_interval, '.2g', ' m')}"),
        ]
    return table


def stiffness_rows(measured: MeasuredRoughness, hardness: str | None = None) -> list[tuple[str, str]]:
    """(pressure, stiffness by each law) of a face with the measured waves; the material is that of a study file.

    Raises InputError for a fit without D and G.
    """
    roughness = _face_roughness(measured, hardness)
    persson, fractal = persson_law(roughness, FACE_AREA), law_of_roughness(roughness, FACE_AREA, "fractal")
    table = []
    for pressure in PRESSURES:
        laws = compared(fractal, persson, pressure)
        low, high = (1e-9 * end for end in laws.band)
        beside = f"{1e-9 * laws.chosen:.3g} N/mm3, {laws.ratio:.3g} of it"
        if below := _below_one_spot(roughness, fractal, pressure):
            beside += f", {fraction(below.ratio)} of one round spot of its real area"
        table.append(
            (
                f"{1e-6 * pressure:g} MPa",
                f"Persson {1e-9 * laws.persson:.3g} N/mm3 (believable {low:.3g} to {high:.3g}), fractal {beside}",
            )
        )
    return table


def one_spot_messages(measured: MeasuredRoughness, hardness: str | None = None) -> list[str]:
    """A message if the fractal law of a pressure of :func:`stiffness_rows` is softer than any contact of its area."""
    roughness = _face_roughness(measured, hardness)
    fractal = law_of_roughness(roughness, FACE_AREA, "fractal")
    found = [below for each in PRESSURES if (below := _below_one_spot(roughness, fractal, each))]
    return [min(found, key=lambda each: each.ratio).message("the fractal law")] if found else []


def _below_one_spot(roughness: Roughness, fractal: StiffnessLaw, pressure: float) -> BesideOneSpot | None:
    """The fractal law beside one round spot of its real area, if it is below that."""
    found = beside_one_spot(roughness, fractal, FACE_AREA, pressure)
    return found if found.is_below else None


def require_hardness(text: str) -> None:
    """Raise InputError unless the text is a valid hardness of a study file."""
    TwoBladeCase().replace({"roughness.hardness": text})


def contact_message(measured: MeasuredRoughness, hardness: str | None = None) -> str:
    """A message on the load above which a face of this roughness has elastic spots; ``hardness`` with its unit.

    Below that load the largest spot is smaller than the critical area a_c', so every spot is plastic, and the fractal
    law gives the stiffness of one round spot of the real area. The material and, if ``hardness`` is None, the hardness
    are the defaults of a study file, the waves those of the measurement. Raises InputError for a hardness that is not
    usable or a fit without D and G.
    """
    roughness = _face_roughness(measured, hardness)
    least = fully_plastic_load(roughness)
    origin = "" if hardness else "the default "
    return (
        f"With {origin}hardness {roughness.hardness / 1e9:g} GPa spots below the critical area "
        f"{exp(log_critical_area(roughness)):.3g} m2 are plastic. A face with a load below {least:.3g} N has no "
        "other spots: there the fractal law gives only the stiffness of one round spot of the real area, a lower bound "
        "(the default law and the mode unloading compute it from the waves)."
    )


def _face_roughness(measured: MeasuredRoughness, hardness: str | None) -> Roughness:
    """Both faces of the material of a study file, with the measured waves."""
    case = _case(measured, hardness)
    return case_roughness(case, *[case_material(case)] * 2)


def _case(measured: MeasuredRoughness, hardness: str | None) -> TwoBladeCase:
    """The default case with D, G and waves of a measurement, and the hardness if one is given."""
    fit, (longest, shortest) = measured.fit, measured.waves
    chosen: dict[str, float | str] = {
        "roughness.fractal_dimension": fit.fractal_dimension,
        "roughness.fractal_roughness": f"{fit.fractal_roughness!r} m",
        "roughness.sample_length": longest,
        "roughness.shortest_length": shortest,
    }
    return TwoBladeCase().replace(chosen | ({} if hardness is None else {"roughness.hardness": hardness}))


def study_lines(measured: MeasuredRoughness, hardness: str | None = None) -> str:
    """The section of a study file, with the hardness if one is given. Raises InputError for a fit without D and G.

    It contains the waves of the measurement: the stiffness depends on them.
    """
    fit, (longest, shortest) = measured.fit, measured.waves
    if not fit.usable:
        raise InputError(f"the profile gives no D and G for a study file. {fit.warnings[0]}")
    return (
        f"[roughness]\nfractal_dimension = {fit.fractal_dimension:.4f}\n"
        f'fractal_roughness = "{fit.fractal_roughness:.4g} m"\n'
        f'sample_length = "{_shown(longest)}"\nshortest_length = "{_shown(shortest)}"\n'
        + (f'hardness = "{hardness}"\n' if hardness else "")
    )


def write(folder: str | PathLike[str], measured: MeasuredRoughness) -> tuple[Path, ...]:
    """Write structure_function.svg, .png and .csv into an existing folder. Raises InputError if that fails."""
    from stickslip.reporting.figures import save, structure_function

    out, fit = Path(folder), measured.fit
    figure = structure_function(fit)
    files = [save(figure, out / f"structure_function.{ending}") for ending in FORMATS]
    with whole_file(out / TABLE, "table", InputError) as part, part.open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream)
        table.writerow(["lag_m", "structure_function_m2", "fitted_m2"])
        for line in zip(fit.lag, fit.structure_function, fit.fitted, strict=True):
            table.writerow([f"{value:.9g}" for value in line])
    return (*files, out / TABLE)


def _between(interval: Interval, digits: str, unit: str = "") -> str:
    low, high = interval
    return f"(95 %: {low:{digits}} to {high:{digits}}{unit})"


def _shown(length: float) -> str:
    """A length in a unit with readable digits."""
    for unit, size in (("m", 1.0), ("mm", 1e-3), ("um", 1e-6)):
        if length >= 0.999 * size:
            return f"{length / size:.4g} {unit}"
    return f"{length / 1e-9:.4g} nm"
