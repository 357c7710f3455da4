"""The plain figure of a nonlinear mode, for publications and notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.core.plain_figure import BLUE, GREEN, INK, ORANGE, blank_figure, plain_axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stickslip.results.nonlinear_mode import NonlinearMode
    from stickslip.results.quasi_static_mode import QuasiStaticMode

MODAL_AMPLITUDE = "Modal amplitude, m kg^0.5"


def mode_figure(mode: NonlinearMode, quasi_static: QuasiStaticMode | None) -> Figure:
    """Frequency above, damping ratio below, over the modal amplitude on a logarithmic axis."""
    figure = blank_figure(6.0, 6.0)
    above, below = (plain_axes(axes) for axes in figure.subplots(2, 1, sharex=True))
    above.semilogx(mode.modal_amplitude, mode.frequency_hz, ".-", color=INK, markersize=4, label="nonlinear mode")
    for name, hertz, mac, colour, dash in (
        ("stuck", mode.stuck_frequency_hz, mode.stuck_mac, BLUE, "--"),
        ("sliding", mode.sliding_frequency_hz, mode.sliding_mac, ORANGE, ":"),
    ):
        closest = int(mac.max(axis=0).argmax())
        above.axhline(hertz[closest], color=colour, linestyle=dash, label=f"linear, {name} (mode {closest + 1})")
    below.loglog(mode.modal_amplitude, 100.0 * mode.damping_ratio, ".-", color=INK, markersize=4)
    if quasi_static is not None:
        above.semilogx(quasi_static.modal_amplitude, quasi_static.frequency_hz, color=GREEN, label="quasi-static")
        below.loglog(quasi_static.modal_amplitude, 100.0 * quasi_static.damping_ratio, color=GREEN)
    above.set_ylabel("Frequency, Hz")
    above.legend(frameon=False)
    below.set(xlabel=MODAL_AMPLITUDE, ylabel="Damping ratio, %")
    return figure
