"""Figures for publications and reports, one function a figure; ``save`` writes SVG, PNG or PDF by matplotlib.

Amplitudes are 0-to-peak in µm, frequencies in Hz. The page has its own, interactive ones in ``plots.py``. A "$" in a
name of a user does not start mathematics.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.loop_fit import LoopFit
from stickslip.contact.stiffness.roughness_fit import RoughnessFit
from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.plain_figure import BLUE, GREY, INK, ORANGE, blank_figure, one_panel, plain_axes
from stickslip.core.shown_numbers import MICRO, raised
from stickslip.core.validation import FloatArray, finite_array
from stickslip.reporting.disk_figures import disk_figures
from stickslip.reporting.face_axes import map_titles
from stickslip.reporting.look import map_range, mark_size
from stickslip.reporting.style import LINE_COLOURS, STATES
from stickslip.reporting.view import View
from stickslip.results.record import StudyRecord, compared_model, reference_deviation
from stickslip.results.response import ForcedResponse

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = ("svg", "png", "pdf")
_MAP_WIDTH_INCHES = 5.4  # of one face's map beside its axes and scale
_MAP_INCHES = (0.8, 2.6)  # chosen: smallest and largest height of a map
_AROUND_MAP_INCHES = 0.75  # for the title and the lower axis of a map


def amplitude_frequency(response: ForcedResponse, study: StudyRecord) -> Figure:
    """Amplitude of the first output against frequency, linear stuck and free beside it, the peak marked."""
    study.require_fit(response)
    return response.plot(study.outputs[study.response_output], study.response_output)


def contact_states(response: ForcedResponse, study: StudyRecord, point: int | None = None) -> Figure:
    """Map of the contact states on each face at one computed point, the peak unless another is given."""
    view = View.of(response, study)
    at = view.point if point is None else point
    figure, panels = _face_panels(study, f"{response.frequency_hz[at]:.2f} Hz, {view.amplitude_um[at]:.4g} µm")
    for face, axes in enumerate(panels):
        size = _mark_area(1e3 * study.pair_position[study.pair_face == face], 7.4)
        for state, name in response.pairs.state_names.items():
            here = (study.pair_face == face) & (response.contact_state[at] == state)
            x, y = 1e3 * study.pair_position[here].T
            look = STATES[state]
            axes.scatter(x, y, marker=look.matplotlib_marker, color=look.colour, s=size, label=name)
    panels[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.12), ncols=3, frameon=False, borderaxespad=0.0)
    return figure


def rest_pressure(response: ForcedResponse, study: StudyRecord) -> Figure:
    """Map of the pressure at rest on each face; pairs that are open there are hollow."""
    view = View.of(response, study)
    pressure = view.rest_pressure_mpa
    figure, panels = _face_panels(study, "at rest")
    top = max(float(np.nanmax(pressure)), 1e-30)
    for face, axes in enumerate(panels):
        here = study.pair_face == face
        size = _mark_area(1e3 * study.pair_position[here], 8.4)
        opened = here & np.isnan(pressure)
        x, y = 1e3 * study.pair_position[opened].T
        axes.scatter(x, y, marker="s", s=size, facecolor="none", edgecolor=GREY)
        closed = here & ~opened
        x, y = 1e3 * study.pair_position[closed].T
        dots = axes.scatter(x, y, c=pressure[closed], marker="s", s=size, cmap="cividis", vmin=0.0, vmax=top)
    figure.colorbar(dots, ax=panels, label=f"Pressure at rest, MPa (hollow: {view.unloaded_words})")
    return figure


def energy_map(response: ForcedResponse, study: StudyRecord, point: int | None = None) -> Figure:
    """Map of the energy that each pair dissipates per cycle at one computed point, the peak unless another is given."""
    view = View.of(response, study)
    at = view.point if point is None else point
    energy = view.energy_factor * response.friction_energy[at]
    figure, panels = _face_panels(study, f"{response.frequency_hz[at]:.2f} Hz")
    top = max(float(energy.max()), 1e-30)
    for face, axes in enumerate(panels):
        here = study.pair_face == face
        x, y = 1e3 * study.pair_position[here].T
        size = _mark_area(np.column_stack([x, y]), 8.4)
        dots = axes.scatter(x, y, c=energy[here], marker="s", s=size, cmap="cividis", vmin=0.0, vmax=top)
    figure.colorbar(dots, ax=panels, label=f"Friction energy, {view.energy_unit} per cycle")
    return figure


def hysteresis_loop(
    response: ForcedResponse, study: StudyRecord, point: int | None = None, pair: int | None = None
) -> Figure:
    """Friction force against relative displacement of one pair along t1 and t2.

    The point is the peak and the pair the one that dissipates most there, unless others are given. Displacements are
    about their mean over the period.
    """
    view = View.of(response, study)
    at = view.point if point is None else point
    which = view.pair if pair is None else pair
    if not 0 <= which < response.pairs.n_pairs:
        raise InputError(
            f"pair is {which}, but the pairs are numbered 0 to {response.pairs.n_pairs - 1}.", arguments=["pair"]
        )
    force = response.pair_cycle(at).force[:, which, :2]
    motion = MICRO * response.pair_displacement(at, response.samples)[:, which, :2]
    motion = motion - motion.mean(axis=0)
    figure, axes = one_panel(4.8, 4.2)
    for axis in range(2):
        loop = np.vstack([np.column_stack([motion[:, axis], force[:, axis]]), [motion[0, axis], force[0, axis]]])
        axes.plot(*loop.T, color=LINE_COLOURS[axis], label=f"along t{axis + 1}")
    axes.set(xlabel="Relative displacement about the mean, µm", ylabel=view.tangential_words)
    axes.set_title(f"{view.pair_label(which)}, {response.frequency_hz[at]:.2f} Hz", fontsize=9, parse_math=False)
    axes.legend(frameon=False)
    return figure


def energy_curve(response: ForcedResponse, study: StudyRecord) -> Figure:
    """Energy per cycle along the curve: friction, viscous damping, and the work of the excitation."""
    view = View.of(response, study)
    figure, axes = one_panel(7.0, 3.6)
    factor = view.energy_factor
    axes.plot(response.frequency_hz, factor * response.friction_energy.sum(axis=1), color=INK, label="friction")
    axes.plot(response.frequency_hz, factor * response.viscous_energy, "--", color=BLUE, label="viscous")
    axes.plot(response.frequency_hz, factor * response.input_energy, ":", color=ORANGE, linewidth=2.0, label="input")
    axes.set(xlabel="Excitation frequency, Hz", ylabel=f"Energy per cycle, {view.energy_unit}", ylim=(0.0, None))
    axes.legend(frameon=False)
    return figure


def mode_comparison(study: StudyRecord) -> Figure:
    """Deviation of each natural frequency of the model from its reference, with the source of the reference.

    Raises InputError if no row of the mode table has a frequency of the model and ``reference_hz``.
    """
    found = [(row, reference_deviation(row)) for row in study.mode_table]
    compared = [(row, percent) for row, percent in found if percent is not None]
    if not compared:
        raise InputError("the mode table has no row with full_hz and reference_hz, so there is nothing to compare.")
    rows, deviation = zip(*compared, strict=True)
    labels = [f"{row.get('mode', i + 1)}: {float(row['reference_hz']):.1f} Hz" for i, row in enumerate(rows)]
    figure, axes = one_panel(7.0, 3.4)
    axes.bar(range(len(rows)), deviation, color=BLUE)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_xticks(range(len(rows)), labels, rotation=45, ha="right")
    axes.set(xlabel="Mode: reference", ylabel=f"{compared_model(study.mode_table)} against reference, %")
    axes.set_title(f"Natural frequencies against {study.mode_reference}", fontsize=10, parse_math=False)
    return figure


def surface(x: ArrayLike, y: ArrayLike, heights: ArrayLike) -> Figure:
    """Heights of a rough face as a colour map; x, y and heights in m, all of one shape (n, m) on a grid.

    Raises InputError for shapes that differ or are not two-dimensional.
    """
    grid = [finite_array(name, value) for name, value in (("x", x), ("y", y), ("heights", heights))]
    if grid[2].ndim != 2 or grid[0].shape != grid[2].shape or grid[1].shape != grid[2].shape:
        raise InputError(
            f"x, y and heights must have the same shape (n, m), but their shapes are {grid[0].shape}, {grid[1].shape} "
            f"and {grid[2].shape}. Make x and y with numpy.meshgrid."
        )
    figure, axes = one_panel(7.0, 3.2)
    about_mean = MICRO * (grid[2] - grid[2].mean())
    mesh = axes.pcolormesh(1e3 * grid[0], 1e3 * grid[1], about_mean, cmap="cividis", shading="nearest", rasterized=True)
    figure.colorbar(mesh, ax=axes, label="Height about the mean, µm")
    axes.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
    axes.set_title(f"Sq = {about_mean.std():.3g} µm on this grid", fontsize=10)
    return figure


def structure_function(fit: RoughnessFit) -> Figure:
    """Measured structure function and the fit of D and G against the lag; a map has one curve for each direction."""
    figure, axes = one_panel(6.0, 4.2)
    split = fit.points_along_x
    directions = (("x", slice(0, split), "o", BLUE), ("y", slice(split, None), "s", ORANGE))
    shown = [each for each in directions if fit.lag[each[1]].size]
    for axis, part, marker, colour in shown:
        label = "measured" if len(shown) == 1 else f"measured along {axis}"
        axes.loglog(MICRO * fit.lag[part], MICRO**2 * fit.structure_function[part], marker, color=colour, label=label)
        constants = raised(f"D = {fit.fractal_dimension:.3f}, G = {fit.fractal_roughness:.3g} m")
        words = f"fit: {constants}" if axis == shown[0][0] else None
        axes.loglog(MICRO * fit.lag[part], MICRO**2 * fit.fitted[part], color=INK, label=words)
    axes.set(xlabel="Lag, µm", ylabel="Structure function, µm²\nmean line removed")
    axes.legend(frameon=False)
    return figure


def fitted_loops(fit: LoopFit) -> Figure:
    """Measured force over displacement, and the fit."""
    figure, axes = one_panel(6.0, 4.2)
    small = float(fit.cycle_amplitude.max()) < 1e-3
    scale, unit = (MICRO, "µm") if small else (1e3, "mm")
    along = scale * fit.displacement
    axes.plot(along, fit.force, ".", color=ORANGE, markersize=2.0, label="measured")
    words = "spring with play and slider" if fit.backlash else "Jenkins element"
    axes.plot(along, fit.fitted, color=BLUE, linewidth=1.2, label=words)
    axes.set(xlabel=f"Relative displacement, {unit}", ylabel="Force, N\noffset removed")
    axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, 1.12), ncols=2)
    return figure


def save(figure: Figure, path: str | PathLike[str]) -> Path:
    """Write a figure; the ending of the name says how: .svg, .png or .pdf. Raises InputError."""
    target = Path(path)
    if target.suffix.lstrip(".") not in FORMATS:
        raise InputError(f'the figure "{target}" must end in one of .{", .".join(FORMATS)}.')
    with whole_file(target, "figure", InputError) as part:
        ending = target.suffix.lstrip(".")
        quick: dict[str, Any] = {"pil_kwargs": {"compress_level": 1}} if ending == "png" else {}
        figure.savefig(part, format=ending, dpi=200, **quick)
    figure.set_layout_engine("none")  # laid out once; the next format takes it as it is
    return target


def save_all(
    folder: str | PathLike[str], response: ForcedResponse, study: StudyRecord, formats: tuple[str, ...] = ("svg", "png")
) -> list[Path]:
    """Write every figure of one run into a folder, in each format; returns the files. Raises InputError."""
    drawn = {
        "amplitude_frequency": amplitude_frequency(response, study),
        "contact_states": contact_states(response, study),
        "energy_map": energy_map(response, study),
        "hysteresis_loop": hysteresis_loop(response, study),
        "energy_curve": energy_curve(response, study),
    }
    drawn |= disk_figures(response, study)
    if View.of(response, study).rest_varies:
        drawn["rest_pressure"] = rest_pressure(response, study)
    if any(reference_deviation(row) is not None for row in study.mode_table):
        drawn["mode_comparison"] = mode_comparison(study)
    return [save(figure, Path(folder) / f"{name}.{ending}") for name, figure in drawn.items() for ending in formats]


def _face_panels(study: StudyRecord, heading: str) -> tuple[Figure, list[Axes]]:
    """A panel for the map of each face, all to one scale along both of their axes."""
    heights = [_map_inches(1e3 * study.pair_position[study.pair_face == face]) for face in range(len(study.face_names))]
    figure = blank_figure(7.0, sum(heights) + _AROUND_MAP_INCHES * len(heights))
    panels = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights).ravel()
    for face, axes in enumerate(map(plain_axes, panels)):
        position = 1e3 * study.pair_position[study.pair_face == face]
        across, up = map_titles(study, face)
        axes.set_title(f"{study.face_names[face]}, {heading}", fontsize=10, loc="left", parse_math=False)
        axes.set(xlim=map_range(position)[0], ylim=map_range(position)[1], aspect="equal", xlabel=across, ylabel=up)
    return figure, list(panels)


def _map_inches(position: FloatArray) -> float:
    """Height of the map of a face with pairs at ``position`` (n, 2) mm, to scale, within limits."""
    width, height = np.ptp(map_range(position), axis=1)
    return float(np.clip(_MAP_WIDTH_INCHES * height / width, *_MAP_INCHES))


def _mark_area(position: FloatArray, largest: float) -> float:
    """Area in square points of the marks of a map with pairs at ``position`` (n, 2) mm; ``largest`` is their width."""
    return mark_size(position, (72.0 * _MAP_WIDTH_INCHES, 72.0 * _map_inches(position)), largest) ** 2
