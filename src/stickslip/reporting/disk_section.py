"""The disk on the page: natural frequencies by nodal diameter, the line of the engine order, and words on the wave."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE, VERMILLION
from stickslip.reporting.look import Figure, axis_look, figure_of, line_trace, plain_list
from stickslip.reporting.section import Section
from stickslip.reporting.style import shown_number
from stickslip.reporting.view import View
from stickslip.results.campbell import SPEED_KEY
from stickslip.results.disk import Disk
from stickslip.results.measures import summary

_ROOM = 1.08  # of the highest frequency
_UNKNOWN = "The stability of the points is not known, and motions in which sectors differ are not in the equations."


def _disk(view: View) -> Disk:
    assert view.study.disk is not None  # else the page has no such section
    return view.study.disk


def _peak_hz(view: View) -> float:
    return summary(view.response, view.study.outputs[view.study.response_output]).peak.frequency_hz


def _families(disk: Disk) -> Iterator[dict[str, Any]]:
    """Lines of one number from below; the names are in the legend once."""
    families = [("contacts stuck", disk.stuck_hz, BLUE, "solid"), ("no contact", disk.free_hz, ORANGE, "dot")]
    if disk.opposite_hz is not None:
        families.append(("stuck, waves against the excitation", disk.opposite_hz, BLUE, "dash"))
    for name, table, colour, dash in families:
        for number, row in enumerate(table.T):
            trace = line_trace(
                name, disk.diameters, row, colour, dash, 1.2, mode="lines+markers",
                hovertemplate="%{y:.2f} Hz<br>nodal diameter %{x}", showlegend=number == 0, legendgroup=name,
            )  # fmt: skip
            yield trace | {"marker": {"size": 6, "color": colour}}


def _line(disk: Disk, speed_hz: float, top: float) -> Any:
    """The frequencies that all engine orders have at one speed (Hz), at the nodal diameters that they excite."""
    orders = np.arange(int(top / speed_hz) + 2)
    # The corners are at multiples of N / 2, which an odd N does not have as a nodal diameter.
    folded = np.abs((orders + 0.5 * disk.sectors) % disk.sectors - 0.5 * disk.sectors)
    name = f"engine orders at {shown_number(60.0 * speed_hz, 'rpm')} rpm"
    return line_trace(
        name, folded, orders * speed_hz, VERMILLION, "dash", 1.2,
        mode="lines+markers", text=[f"engine order {order}" for order in orders],
        hovertemplate="%{text}: %{y:.1f} Hz",
    )  # fmt: skip


def _figures(view: View) -> dict[str, Figure]:
    disk, peak_hz = _disk(view), _peak_hz(view)
    top = _ROOM * float(max(disk.stuck_hz.max(), disk.free_hz.max()))
    traces = list(_families(disk))
    if disk.engine_order:
        traces.append(_line(disk, peak_hz / disk.engine_order, top))
    traces.append(
        {
            "type": "scatter", "mode": "markers", "name": "peak of the curve", "x": plain_list([disk.diameter]),
            "y": plain_list([peak_hz]), "marker": {"symbol": "diamond", "size": 11, "color": INK},
            "hovertemplate": "peak at %{y:.2f} Hz<br>nodal diameter %{x}<extra></extra>",
        }
    )  # fmt: skip
    most, words = int(disk.diameters[-1]), f"Nodal diameter of {disk.sectors} sectors"
    return {
        "nodal-diameters": figure_of(
            traces, 440, hovermode="closest",
            xaxis=axis_look(words, range=[-0.3, most + 0.3], dtick=max(1, most // 12)),
            yaxis=axis_look("Natural frequency, Hz", range=[0.0, top]),
        )
    }  # fmt: skip


def _words(view: View) -> list[str]:
    disk, peak_hz = _disk(view), _peak_hz(view)
    other = "after" if disk.direction == "forward" else "before"
    words = [
        f"The disk has {disk.sectors} equal sectors. Engine order {disk.engine_order} travels {disk.direction}, so the "
        f"first harmonic has {disk.diameter} nodal diameters. Every sector has the same amplitude, the same contact "
        f"states and the same energies; the next sector has them {disk.engine_order}/{disk.sectors} of a period "
        f"{other} this one. Curves, maps and loops of this page are those of one sector, and energies are per sector.",
    ]
    if disk.engine_order:
        words.append(
            f"The dashed line contains the excitation by all engine orders at the speed at which order "
            f"{disk.engine_order} has the frequency of the peak, {shown_number(peak_hz, 'Hz')} Hz "
            f"({shown_number(60.0 * peak_hz / disk.engine_order, 'rpm')} rpm): a resonance is possible where a mark of "
            "it meets a natural frequency of the same nodal diameter (SAFE diagram)."
        )
    words += [_of_speed(view), _UNKNOWN]
    return words


def _of_speed(view: View) -> str:
    """The speed whose effects the frequencies contain."""
    inputs = view.study.input_values()
    speed = inputs.get(SPEED_KEY)
    if speed is None:
        return (
            "The frequencies are those of the disk at rest: stress stiffening, spin softening and Coriolis forces are "
            "not included. A section [rotation] adds the first two."
        )
    effects = "stress stiffening, spin softening and Coriolis forces"
    if inputs.get("rotation.coriolis", "").lower() != "true":
        effects = "stress stiffening and spin softening. Coriolis forces are not included"
    loads = "are those of the static state at this speed"
    if inputs.get("preload.method") != "solved":
        loads = "are those that the study gives: the speed does not change them"
    return (
        f"The frequencies are those at {speed}, with {effects}. The normal loads {loads}. If the dashed line belongs "
        "to another speed, repeat the study with that one."
    )


DISK = Section(
    "Disk: nodal diameters",
    """\
{%- for sentence in words %}
  <p class="note">{{ sentence }}</p>
{%- endfor %}
  {{ parts.panel("nodal-diameters", "Natural frequencies by nodal diameter") }}
""",
    lambda view: {"words": _words(view)},
    _figures,
    lambda view: view.study.disk is not None,
)
