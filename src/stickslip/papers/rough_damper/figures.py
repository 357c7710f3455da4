"""Figures of the study, one function each; the style is that of the single figures of a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.contact.law.law import ContactState
from stickslip.core.plain_figure import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, VERMILLION, blank_figure, plain_axes
from stickslip.core.validation import FloatArray
from stickslip.papers.rough_damper.claims import MICRO, energy_at, fixed_frequencies, friction_energy, series
from stickslip.papers.rough_damper.plan import EXCITATIONS
from stickslip.papers.rough_damper.records import SHOWN_PLACES, Solved
from stickslip.reporting.figures import save
from stickslip.reporting.style import STATES
from stickslip.results.sweeps_of_curve import SAME_PEAK, drawn_steps, unstable_steps

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = (BLUE, VERMILLION, GREEN, ORANGE, PURPLE, INK, GREY)
DASHES = ("-", "--", "-.", ":", "-", "--", "-.")
UNSTABLE = {"linestyle": (0, (2.0, 2.0)), "linewidth": 0.7}  # finer than the dashes that tell curves apart
FORMATS = ("svg", "png")


def panels(rows: int, columns: int, width: float, height: float, **options: Any) -> tuple[Figure, Any]:
    """A figure with (rows, columns) plain axes."""
    figure = blank_figure(width, height)
    axes = figure.subplots(rows, columns, squeeze=False, **options)
    for each in axes.ravel():
        plain_axes(each)
    return figure, axes


def label(one: Solved, along: str) -> str:
    """The value of D or G of a curve."""
    return f"D = {one.setting.dimension:g}" if along == "D" else f"G = {one.setting.scale:g} m"


def reduction(mode_table: np.ndarray[Any, Any], paper: Sequence[Any]) -> Figure:
    """Frequency difference and MAC of the reduced model, the paper's beside."""
    figure, axes = panels(1, 2, 9.0, 3.4)
    mode = mode_table[:, 0]
    axes[0, 0].bar(mode - 0.2, np.abs(mode_table[:, 3]), 0.4, color=BLUE, label="ours")
    axes[0, 0].bar(mode + 0.2, [row["frequency_difference_percent"] for row in paper], 0.4, color=ORANGE, label="paper")
    axes[0, 0].axhline(0.01, color=INK, linewidth=0.8, linestyle="--", label="1/10,000")
    axes[0, 0].set(yscale="log", xlabel="Mode", ylabel="Reduced from full, %", xticks=mode)
    axes[0, 0].legend(frameon=False)
    axes[0, 1].bar(mode - 0.2, mode_table[:, 4], 0.4, color=BLUE, label="ours")
    axes[0, 1].bar(mode + 0.2, [row["mac"] for row in paper], 0.4, color=ORANGE, label="paper")
    axes[0, 1].set(ylim=(0.98, 1.001), xlabel="Mode", ylabel="MAC", xticks=mode)
    return figure


def surfaces(faces: Sequence[tuple[str, FloatArray, FloatArray, FloatArray]]) -> Figure:
    """Heights of rough faces, each with its own colour scale: (title, x, y, heights), m."""
    figure, axes = panels(len(faces), 1, 8.0, 2.2 * len(faces))
    for panel, (title, x, y, heights) in zip(axes[:, 0], faces, strict=True):
        about_mean = MICRO * (heights - heights.mean())
        drawn = panel.pcolormesh(1e3 * x, 1e3 * y, about_mean, cmap="cividis", shading="nearest", rasterized=True)
        figure.colorbar(drawn, ax=panel, label="Height, µm")
        panel.set(aspect="equal", ylabel="y, mm")
        panel.set_title(f"{title}; Sq of this face {about_mean.std():.3g} µm", fontsize=10)
    axes[-1, 0].set_xlabel("x, mm")
    return figure


def stiffness(rows: Mapping[str, Mapping[str, Sequence[tuple[str, Sequence[float], Sequence[float]]]]]) -> Figure:
    """Normal stiffness of a face: a row for each abscissa, a panel for each law; no point where there is no stiffness.

    ``rows``: title of the abscissa -> law -> (label, abscissa, K_n in N/m) of each line.
    """
    laws = next(iter(rows.values()))
    figure, axes = panels(len(rows), len(laws), 3.7 * len(laws), 3.4 * len(rows), sharey=True)
    for panel_row, (abscissa, lines) in zip(axes, rows.items(), strict=True):
        for panel, (law, drawn) in zip(panel_row, lines.items(), strict=True):
            for place, (name, values, normal) in enumerate(drawn):
                shown = np.where(np.asarray(normal) > 0.0, normal, np.nan)
                panel.plot(values, shown, "o", color=COLOURS[place], linestyle=DASHES[place], markersize=4, label=name)
            panel.set(xscale="log", yscale="log", xlabel=abscissa)
            panel.set_title(law, fontsize=10)
        panel_row[0].set_ylabel("K_n of a face, N/m")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return figure


def curves(solutions: Sequence[Solved], along: str) -> Figure:
    """Amplitude against frequency: a column for each excitation, a row for each force, load and fixed G or D.

    Unstable parts are thin and finely dashed.
    """
    lines = list(series(solutions, along))
    runs = list(dict.fromkeys(_run_words(line, along) for line in lines))
    figure, axes = panels(len(runs), len(EXCITATIONS), 11.0, 2.9 * len(runs), sharex=True)
    for line in lines:
        s = line[0].setting
        panel = axes[runs.index(_run_words(line, along)), EXCITATIONS.index(s.excitation)]
        for place, one in enumerate(line):
            unstable = unstable_steps(one.stable)
            look = {"linestyle": DASHES[place % 7], "linewidth": 1.3, "label": label(one, along)}
            for drawn, style in ((~unstable, look), (unstable, UNSTABLE)):
                heights = drawn_steps(MICRO * one.amplitude_m, drawn)
                panel.plot(drawn_steps(one.frequency_hz, drawn), heights, color=COLOURS[place % 7], **style)
            up = one.seen_by("up")
            if up is not None and up.numbers["peak_m"] < (1.0 - SAME_PEAK) * one.numbers["peak_m"]:
                panel.plot(up.numbers["peak_hz"], MICRO * up.numbers["peak_m"], "^", color=COLOURS[place % 7])
        panel.set_title(f"{s.excitation}, {_run_words(line, along)}", fontsize=9)
        panel.set(ylim=(0.0, None))
    for panel in axes[-1]:
        panel.set_xlabel("Excitation frequency, Hz")
    for panel in axes[:, 0]:
        panel.set_ylabel("Tip amplitude, 0-to-peak, µm")
        panel.legend(frameon=False, fontsize=7)
    return figure


def _run_words(line: Sequence[Solved], along: str) -> str:
    """Force, load and the fixed one of D and G of a series."""
    s = line[0].setting
    fixed = f"G = {s.scale:g} m" if along == "D" else f"D = {s.dimension:g}"
    return f"{s.force:g} N, F_N {s.load:g} N, {fixed}"


def energies(solutions: Sequence[Solved], along: str) -> Figure:
    """Friction energy for each period against D or G: at the peak, and at three fixed frequencies."""
    figure, axes = panels(2, 2, 10.0, 7.0, sharex=True)
    runs = list(dict.fromkeys((one.setting.force, one.setting.load) for one in solutions))
    for line in series(solutions, along):
        s = line[0].setting
        value = [one.setting.dimension if along == "D" else one.setting.scale for one in line]
        style = {
            "color": COLOURS[EXCITATIONS.index(s.excitation)],
            "linestyle": DASHES[runs.index((s.force, s.load)) % 7],
            "marker": ("o", "s", "^")[EXCITATIONS.index(s.excitation)],
            "markersize": 4,
        }
        fixed = fixed_frequencies(line).values()
        energy = [[friction_energy(one) for one in line]] + [[energy_at(one, hz) for one in line] for hz in fixed]
        for panel, values in zip(axes.ravel(), energy, strict=True):
            name = f"{s.excitation}, {s.force:g} N, F_N {s.load:g} N"
            panel.plot(value, [MICRO * joule for joule in values], label=name, **style)
    titles = (
        "each curve at its peak",
        *(f"all at the peak of the {name}" for name in ("softest", "middle", "stiffest")),
    )
    for panel, title in zip(axes.ravel(), titles, strict=True):
        panel.set_title(title, fontsize=10)
        panel.set_yscale("symlog", linthresh=1e-2)
        panel.set_ylabel("Friction energy per cycle, µJ")
    if along == "G":
        axes[0, 0].set_xscale("log")
        axes[0, 0].invert_xaxis()
    for panel in axes[1]:
        panel.set_xlabel("D" if along == "D" else "G, m (falling to the right)")
    handles, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return figure


def state_maps(solutions: Sequence[Solved], along: str) -> Figure:
    """Contact states of all pairs at the peak: a row for each roughness, a column for each excitation."""
    lines = list(series(solutions, along))
    figure, axes = panels(len(lines[0]), len(EXCITATIONS), 10.0, 1.5 * len(lines[0]) + 0.6, sharex=True, sharey=True)
    for line in lines:
        column = EXCITATIONS.index(line[0].setting.excitation)
        for row, one in enumerate(line):
            panel = axes[row, column]
            x, y = 1e3 * one.pair_position.T
            span = float(np.ptp(y)) + 2.0
            for code, style in zip(ContactState, STATES, strict=True):
                here = one.pair_state == code
                panel.scatter(
                    x[here],
                    (y + np.where(one.pair_face == 0, 0.6, -0.6) * span)[here],
                    marker=style.matplotlib_marker,
                    color=style.colour,
                    s=12,
                    label=code.label,
                )
            counts = "/".join(f"{one.numbers[name]:g}" for name in ("stuck", "stick_slip", "separating"))
            panel.set_title(f"{one.setting.excitation}, {label(one, along)}: {counts}", fontsize=8)
            panel.set_yticks([])
    for panel in axes[-1]:
        panel.set_xlabel("Along the damper, mm")
    for panel in axes[:, 0]:
        panel.set_ylabel("right | left face", fontsize=8)
    handles, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False)
    return figure


def period(solutions: Sequence[Solved], along: str, place: int) -> Figure:
    """Forces and state of one pair over one period: rows T1, T2, N, state; columns same and opposite."""
    lines = [line for line in series(solutions, along) if line[0].setting.excitation != "single"]
    figure, axes = panels(4, 2, 9.5, 8.0, sharex=True)
    for line in lines:
        column = ("same", "opposite").index(line[0].setting.excitation)
        for number, one in enumerate(line):
            style = {"color": COLOURS[number % 7], "linestyle": DASHES[number % 7], "linewidth": 1.2}
            phase = np.linspace(0.0, 1.0, one.signals.shape[2], endpoint=False)
            for row in range(3):
                axes[row, column].plot(phase, one.signals[place, 3 + row], label=label(one, along), **style)
            axes[3, column].plot(phase, one.phase_state[place] + 0.06 * number, drawstyle="steps-post", **style)
        axes[0, column].set_title(f"{line[0].setting.excitation} direction, {SHOWN_PLACES[place]}", fontsize=10)
    for row, name in enumerate(("T1, N", "T2, N", "Normal force, N")):
        axes[row, 0].set_ylabel(name)
    axes[3, 0].set_yticks([0, 1, 2], ["stuck", "slipping", "open"])
    axes[3, 1].set_yticks([0, 1, 2], ["", "", ""])
    axes[0, 0].legend(frameon=False, fontsize=8)
    for panel in axes[3]:
        panel.set_xlabel("Time over period")
    return figure


def damper_sides(same: Solved, opposite: Solved) -> Figure:
    """Displacement of the damper's symmetric nodes in three directions over one period."""
    figure, axes = panels(3, 2, 9.5, 6.0, sharex=True)
    for column, one in enumerate((same, opposite)):
        phase = np.linspace(0.0, 1.0, one.sides.shape[2], endpoint=False)
        for row, axis in enumerate("xyz"):
            for side, (name, colour, dash) in enumerate((("left", BLUE, "-"), ("right", VERMILLION, "--"))):
                signal = MICRO * (one.sides[side, row] - one.sides[side, row].mean())
                axes[row, column].plot(phase, signal, dash, color=colour, label=f"{name} node")
            axes[row, column].set_ylabel(f"{axis}, µm")
        share = 100.0 * np.asarray(one.shares)
        words = f"{one.setting.excitation}: translation {share[0]:.1f} %, rotation {share[1]:.1f} %"
        axes[0, column].set_title(words, fontsize=10)
        axes[2, column].set_xlabel("Time over period")
    axes[0, 0].legend(frameon=False)
    return figure


def write(folder: Path, name: str, draw: Callable[[], Figure]) -> tuple[Path, ...]:
    """Draw a figure and write it as SVG and PNG. Raises InputError where the folder cannot be written."""
    figure = draw()
    return tuple(save(figure, folder / f"{name}.{ending}") for ending in FORMATS)
