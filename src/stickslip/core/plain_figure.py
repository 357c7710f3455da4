"""Figures of matplotlib without a backend, with the colours and axes that all figures share."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK = "#1b2a41"
GREY = "#6b7787"
# The palette of Okabe and Ito, which readers with colour blindness can distinguish.
BLUE, GREEN, VERMILLION, ORANGE, PURPLE = "#0072B2", "#009E73", "#D55E00", "#E69F00", "#CC79A7"
UPWARD, DOWNWARD = GREEN, PURPLE  # slow sweeps of the frequency


def blank_figure(width: float, height: float) -> Figure:
    """A figure of ``width`` by ``height`` inches without axes; the file format writes it, so it needs no backend."""
    _import_matplotlib()
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def _import_matplotlib() -> None:
    """Import matplotlib without MPLBACKEND, because it rejects the name of a backend that it does not have.

    Jupyter sets a backend of its own for every command that it starts. Windows that a script opens itself still get
    that backend, if it exists.
    """
    if "matplotlib" in sys.modules:
        return
    backend = os.environ.pop("MPLBACKEND", None)
    try:
        import matplotlib
    finally:
        if backend is not None:
            os.environ["MPLBACKEND"] = backend
    if backend:
        with suppress(ValueError):
            matplotlib.rcParams["backend"] = backend


def one_panel(width: float, height: float) -> tuple[Figure, Axes]:
    """A figure of ``width`` by ``height`` inches with one pair of axes."""
    figure = blank_figure(width, height)
    return figure, plain_axes(figure.subplots())


def plain_axes(axes: Any) -> Any:
    """Grid behind the lines, no frame at the top and on the right."""
    axes.grid(color="#e8ecf0")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(GREY)
    return axes
