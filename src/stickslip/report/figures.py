"""Single figures for papers and slides (SVG, PDF, PNG) by matplotlib; each function returns one figure."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.errors import InputError
from stickslip.report.style import (
    AXIS_NAMES,
    BLUE,
    GREY,
    INK,
    LINE_COLOURS,
    MICRO,
    ORANGE,
    STATES,
    VERMILLION,
)
from stickslip.report.view import View
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.validation import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FREQUENCY = "Excitation frequency, Hz"
_LOOK: Any = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "grid.color": "#e6eaee",
    "axes.axisbelow": True,
    "svg.hashsalt": "stickslip",  # the same figure gives the same file
    "savefig.bbox": "tight",
}


def amplitude_frequency(view: View) -> Figure:
    """Amplitude against frequency, 0-to-peak, with the linear stuck and free limits and the peak marked."""
    figure, axes = _axes(6.4, 3.6)
    linear, peak = view.response.linear, view.summary.peak
    axes.plot(linear.frequency_hz, view.stuck_um, "--", color=BLUE, lw=1.4, label="linear, all stuck")
    axes.plot(linear.frequency_hz, view.free_um, ":", color=ORANGE, lw=1.8, label="linear, no contact")
    axes.plot(view.response.frequency_hz, view.amplitude_um, "-", color=INK, lw=1.8, label="with friction")
    top = MICRO * peak.amplitude
    axes.plot([peak.frequency_hz], [top], "D", color=VERMILLION, ms=6)
    words = f"{'peak' if peak.bracketed else 'highest'} {top:.4g} µm\nat {peak.frequency_hz:.2f} Hz"
    axes.annotate(words, (peak.frequency_hz, top), xytext=(12, 4), textcoords="offset points", color=INK)
    axes.set(xlabel=FREQUENCY, ylabel=f"Amplitude at {view.study.response_output}, 0-to-peak, µm", xlim=view.window_hz)
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False)
    return figure


def contact_states(view: View) -> Figure:
    """State of every pair at the peak, one panel for each face."""
    figure, panels = _face_panels(view)
    state = view.response.contact_state[view.point]
    for face, axes in enumerate(panels):
        members = view.study.pair_face == face
        for code, style in enumerate(STATES):
            chosen = members & (state == code)
            along, across = 1e3 * view.study.pair_position[chosen].T
            axes.plot(along, across, style.matplotlib_marker, color=style.colour, ms=6, ls="", label=style.name)
    panels[-1].legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def energy_map(view: View) -> Figure:
    """Energy that every pair takes out in one cycle at the peak, one panel for each face, one colour scale."""
    figure, panels = _face_panels(view)
    energy = view.energy_factor * view.response.dissipated_energy[view.point]
    top = float(energy.max())
    for face, axes in enumerate(panels):
        members = view.study.pair_face == face
        along, across = 1e3 * view.study.pair_position[members].T
        dots = axes.scatter(
            along, across, c=energy[members], cmap="cividis", vmin=0.0, vmax=top or 1.0, marker="s", s=42
        )
    figure.colorbar(dots, ax=panels, label=f"Dissipated energy, {view.energy_unit} per cycle", shrink=0.85)
    return figure


def energy_curve(view: View) -> Figure:
    """Energy per cycle along the curve: friction, viscous damping, input."""
    figure, axes = _axes(6.4, 3.2)
    response, factor = view.response, view.energy_factor
    frequency = response.frequency_hz
    axes.plot(frequency, factor * response.input_energy, "-", color=GREY, lw=2.4, label="input")
    axes.plot(frequency, factor * response.dissipated_energy.sum(axis=1), "-", color=VERMILLION, label="friction")
    axes.plot(frequency, factor * response.viscous_energy, "--", color=BLUE, label="viscous damping")
    axes.set(xlabel=FREQUENCY, ylabel=f"Energy, {view.energy_unit} per cycle", xlim=view.window_hz)
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False)
    return figure


def hysteresis(view: View) -> Figure:
    """Loop and normal force of the pair that dissipates most at the peak."""
    figure, (loop, normal) = _axes(6.8, 3.0, columns=2)
    cycle = view.response.pair_cycle(view.point)
    samples = cycle.force.shape[0]
    motion = MICRO * view.response.pair_displacement(view.point, samples)[:, view.pair]
    closed = np.append(np.arange(samples), 0)
    for axis in (0, 1):
        colour, name = LINE_COLOURS[axis], f"along {AXIS_NAMES[axis]}"
        loop.plot(motion[closed, axis], cycle.force[closed, view.pair, axis], color=colour, label=name)
    loop.set(xlabel="Relative displacement, µm", ylabel="Friction force, N", title=view.pair_label(view.pair))
    loop.legend(frameon=False)
    normal.plot(np.arange(samples) / samples, cycle.force[:, view.pair, 2], color=INK)
    normal.set(xlabel="Time over period", ylabel="Normal force, N")
    return figure


def surface(x: FloatArray, y: FloatArray, heights: FloatArray, title: str = "") -> Figure:
    """A rough face as a map of its heights; x, y, heights (n, m) in m. Raises InputError for shapes that differ."""
    if not (np.shape(x) == np.shape(y) == np.shape(heights)) or np.ndim(x) != 2:
        raise InputError(
            f"x, y and heights must be grids of one shape, found {np.shape(x)}, {np.shape(y)}, {np.shape(heights)}."
        )
    figure, axes = _axes(5.2, 3.6)
    height_um = MICRO * (heights - np.mean(heights))
    mesh = axes.pcolormesh(1e3 * np.asarray(x), 1e3 * np.asarray(y), height_um, cmap="cividis", shading="auto")
    figure.colorbar(mesh, ax=axes, label="Height above the mean, µm")
    axes.set(xlabel="x, mm", ylabel="y, mm", title=title, aspect="equal")
    axes.grid(False)
    return figure


FIGURES: dict[str, Callable[[View], Figure]] = {
    "amplitude_frequency": amplitude_frequency,
    "contact_states": contact_states,
    "dissipated_energy_map": energy_map,
    "energy_per_cycle": energy_curve,
    "hysteresis": hysteresis,
}


def write_figures(
    folder: str | os.PathLike[str], response: ForcedResponse, study: StudyRecord, formats: Iterable[str]
) -> Iterator[Path]:
    """Write every single figure in each format ("svg", "pdf", "png") into ``folder``; yields the files."""
    wanted = tuple(formats)
    if not wanted:
        return
    view = View.of(response, study)
    for name, draw in FIGURES.items():
        yield from save_figure(draw(view), Path(folder), name, wanted)


def save_figure(figure: Figure, folder: Path, name: str, formats: Iterable[str]) -> Iterator[Path]:
    """Write one figure in each format, each file whole or not at all. Raises InputError where that is not possible."""
    import matplotlib as mpl

    try:
        folder.mkdir(parents=True, exist_ok=True)
        for suffix in formats:
            target = folder / f"{name}.{suffix}"
            with (
                tempfile.NamedTemporaryFile(dir=folder, suffix=f".{suffix}", delete=False) as part,
                mpl.rc_context(_LOOK),
            ):
                # A date would make two files of one figure differ.
                metadata = {} if suffix == "png" else {"Date": None} if suffix == "svg" else {"CreationDate": None}
                figure.savefig(part, format=suffix, dpi=200, metadata=metadata)
            os.chmod(part.name, 0o644)
            os.replace(part.name, target)
            yield target
    except OSError as error:
        raise InputError(f"the figure {folder / name} could not be written: {error.strerror or error}.") from error


def _axes(width: float, height: float, columns: int = 1) -> tuple[Figure, Any]:
    """A figure without a window, and its axes (one, or a row of them)."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_LOOK):
        figure = Figure(figsize=(width, height), layout="constrained")
        return figure, figure.subplots(1, columns)


def _face_panels(view: View) -> tuple[Figure, list[Axes]]:
    """One panel for each face, with its axes in mm."""
    names = view.study.face_names
    figure, panels = _axes(3.4 * len(names) + 0.8, 2.4, columns=len(names))
    panels = list(np.atleast_1d(panels))
    frequency = view.response.frequency_hz[view.point]
    for name, axes in zip(names, panels, strict=True):
        axes.set(xlabel="Along the damper, mm", title=f"{name}, {frequency:.2f} Hz")
        axes.margins(0.08)
    panels[0].set_ylabel("Up the slope, mm")
    return figure, panels
