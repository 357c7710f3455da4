"""From measured hysteresis loops to the constants of a Jenkins element: what ``stickslip fit`` prints and writes."""

from __future__ import annotations

import csv
from os import PathLike
from pathlib import Path

from stickslip.contact.law.loop_fit import Interval, LoopFit, fit_loops
from stickslip.core.errors import InputError, concerning
from stickslip.core.files import whole_file
from stickslip.core.units import LARGEST_FORCE, Quantity
from stickslip.formats.table_file import read_table

TABLE = "fitted_loops.csv"
FORMATS = ("svg", "png")
# Larger than any joint, so that a wrong unit is reported here and not as an overflow of squares.
LARGEST_TRAVEL = 1e3  # m
COLUMNS = {
    "displacement": Quantity("length", at_least=-LARGEST_TRAVEL, at_most=LARGEST_TRAVEL),
    "force": Quantity("force", at_least=-LARGEST_FORCE, at_most=LARGEST_FORCE),
}
_LOAD = Quantity("force", above=0.0, at_most=LARGEST_FORCE, unit_required="A force needs its unit.")


def fit_file(path: str | PathLike[str], normal_load: str | None = None) -> LoopFit:
    """Read loops and fit them; ``normal_load`` is a text with a unit. Raises InputError."""
    load = None if normal_load is None else _load("--normal-load", normal_load)
    columns = read_table(str(path), COLUMNS, "loops")
    with concerning("loops"):
        try:
            return fit_loops(columns["displacement"], columns["force"], normal_load=load)
        except InputError as error:
            raise InputError(f"{path}: {error}", arguments=error.keys) from error


def _load(option: str, text: str) -> float:
    try:
        return _LOAD.parse(text)
    except InputError as error:
        raise InputError(f'{option} "{text}" {error}') from error


def rows(fit: LoopFit) -> list[tuple[str, str]]:
    """(label, value) of the result."""
    low, high = 1e3 * float(fit.cycle_amplitude.min()), 1e3 * float(fit.cycle_amplitude.max())
    table = [
        ("cycles", f"{fit.cycle_amplitude.size}, amplitude {low:.4g} to {high:.4g} mm, {fit.force.size} samples"),
        ("tangential stiffness", _with(fit.tangential_stiffness, fit.tangential_stiffness_interval, "N/m")),
        ("friction limit", _with(fit.friction_limit, fit.friction_limit_interval, "N")),
    ]
    if fit.friction_coefficient is not None and fit.friction_coefficient_interval is not None:
        table.append(("friction coefficient", _with(fit.friction_coefficient, fit.friction_coefficient_interval, "")))
    if fit.backlash:
        table.append(("backlash", _with(1e3 * fit.backlash, _scaled(1e3, fit.backlash_interval), "mm")))
    else:
        table.append(("backlash", "none that is significant"))
    return [
        *table,
        ("offset of the force", f"{fit.force_offset:.4g} N, subtracted"),
        ("misfit", f"{100.0 * fit.misfit:.3g} % of the force (rms), {_jenkins(fit)}"),
        ("independent samples", f"one in {fit.samples_per_independent:.3g}, in the intervals"),
        *_energy(fit),
    ]


def _jenkins(fit: LoopFit) -> str:
    return f"{100.0 * fit.misfit_without_backlash:.3g} % without backlash"


def _energy(fit: LoopFit) -> list[tuple[str, str]]:
    measured, model = float(fit.cycle_energy.mean()), float(fit.fitted_energy.mean())
    return [
        (
            "energy per cycle",
            f"measured {measured:.4g} J, fit {model:.4g} J (mean), {100 * (model / measured - 1):+.2g} %",
        )
    ]


def predicted_rows(fit: LoopFit, normal_load: str | None) -> list[tuple[str, str]]:
    """(amplitude, energy per cycle) at another normal load, a text with a unit; none without it. Raises InputError."""
    if normal_load is None:
        return []
    load = _load("--predict", normal_load)
    if fit.normal_load is None:
        raise InputError('--predict requires the normal load of the measurement, such as --normal-load "90 N".')
    shown = {f"{1e3 * amplitude:.3g} mm": float(amplitude) for amplitude in sorted(fit.cycle_amplitude)}
    return [(label, f"{fit.energy_per_cycle(amplitude, load):.4g} J per cycle") for label, amplitude in shown.items()]


def study_lines(fit: LoopFit) -> str:
    """Lines of a study file for the interface; the laws of stickslip have no backlash."""
    lines = (
        f'[interfaces.NAME]\nlaw = "jenkins"\ntangential_stiffness = "{fit.tangential_stiffness:.4g} N/m"\n\n'
        f'[interfaces.NAME.constants]\nfriction_limit = "{fit.friction_limit:.4g} N"'
    )
    return lines + ("\n# The backlash is not included: no contact law has one." if fit.backlash else "")


def write(folder: str | PathLike[str], fit: LoopFit) -> tuple[Path, ...]:
    """Write fitted_loops.svg, .png and .csv into an existing folder. Raises InputError if that fails."""
    from stickslip.reporting.figures import fitted_loops, save

    out = Path(folder)
    figure = fitted_loops(fit)
    files = [save(figure, out / f"fitted_loops.{ending}") for ending in FORMATS]
    with whole_file(out / TABLE, "table", InputError) as part, part.open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream)
        table.writerow(["displacement_m", "force_n", "fitted_n"])
        table.writerows(zip(fit.displacement, fit.force, fit.fitted, strict=True))
    return (*files, out / TABLE)


def _with(value: float, interval: Interval, unit: str) -> str:
    """A value with its interval."""
    low, high = interval
    after = f" {unit}" if unit else ""
    return f"{value:.4g}{after} (95 %: {low:.4g} to {high:.4g}{after})"


def _scaled(factor: float, interval: Interval) -> Interval:
    return factor * interval[0], factor * interval[1]
