"""The gradients of the peak on the page: a tornado plot, and a table of all inputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from stickslip.core.plain_figure import BLUE, INK, ORANGE
from stickslip.core.shown_numbers import MICRO, number
from stickslip.core.validation import FloatArray
from stickslip.reporting.look import Figure, PlotMarkup, axis_look, figure_of, plain_list
from stickslip.reporting.section import Section
from stickslip.reporting.view import View
from stickslip.results.measures import hertz
from stickslip.results.peak_gradients import PeakGradients

# The change of each input on the page.
CHANGE = 0.1
# chosen: bars of the plot; the table has all inputs. Inputs with a smaller effect than LEAST_SHOWN percent have no bar.
MOST_BARS, LEAST_SHOWN = 15, 0.05
# chosen: percent. Beyond this change of the peak the first order is not an estimate, and the axis ends.
BEYOND_FIRST_ORDER = 50.0
# chosen: a relative change of the peak below NO_EFFECT is none, in percent NOTHING.
NO_EFFECT, NOTHING = 1e-5, 1e-3
# chosen: half of the axis that the longest bar takes; the values beside the bars need the rest on a narrow page.
BARS = 0.6
_OF_PRINT = 0.75  # chosen: height of the plot in print, of that on the screen: each bar keeps its name


def _gradients(view: View) -> PeakGradients:
    gradients = view.response.gradients
    assert gradients is not None  # else the page has no such section
    return gradients


def labels(names: Sequence[str]) -> list[str]:
    """Short names of inputs, "blade length" for "geometry.blade_length"; whole keys where two are equal."""
    short = [_label(name) for name in names]
    return [
        words if short.count(words) == 1 else name.replace("_", " ") for words, name in zip(short, names, strict=True)
    ]


def _label(name: str) -> str:
    """The words of a key; with its section if they are one word, as "friction coefficient"."""
    parts = name.replace("_", " ").split(".")
    if len(parts) == 2 and " " not in parts[1]:
        return " ".join(parts)
    return ": ".join(parts[1:] or parts)


def _strongest(gradients: PeakGradients) -> list[int]:
    """The inputs of the plot, the strongest first."""
    percent = 100.0 * np.abs(gradients.relative_changes(CHANGE)[0])
    return [place for place in gradients.order if percent[place] >= LEAST_SHOWN][:MOST_BARS]


def tornado(view: View) -> Figure:
    """Change of the peak amplitude by a change of each input to both sides, the strongest input on top."""
    gradients = _gradients(view)
    shown = _strongest(gradients)
    percent = 100.0 * gradients.relative_changes(CHANGE)[0][shown]
    names = [labels(gradients.names)[place] for place in shown]
    most = float(np.abs(percent).max(initial=1.0))
    end = min(most, BEYOND_FIRST_ORDER) / BARS
    traces = [
        _bars(f"{sign}{100 * CHANGE:.0f} %", names, factor * percent, end, colour, pattern)
        for sign, factor, colour, pattern in (("+", 1.0, BLUE, ""), ("−", -1.0, ORANGE, "/"))
    ]
    return figure_of(
        traces,
        90 + 26 * max(len(shown), 2),
        meta={"print": _OF_PRINT},
        barmode="overlay",
        bargap=0.3,
        xaxis=axis_look("Peak amplitude, %", range=[-end, end], zeroline=True, zerolinecolor=INK),
        yaxis=axis_look("", autorange="reversed", ticks="", showline=False, showgrid=False),
        hovermode="closest",
        margin={"l": 8, "r": 16, "t": 12, "b": 44},
        dragmode=False,
    )


def _bars(name: str, names: list[str], percent: FloatArray, end: float, colour: str, pattern: str) -> dict[str, Any]:
    """Bars that end at the axis, with their true values beside them."""
    return {
        "type": "bar",
        "orientation": "h",
        "name": f"input {name}",
        "y": names,
        "x": plain_list(np.clip(percent, -BARS * end, BARS * end)),
        "text": [_percent(value) for value in percent],
        "textposition": "outside",
        "textfont": {"size": 11},
        "cliponaxis": False,
        "marker": {"color": colour, "line": {"color": INK, "width": 0.5}, "pattern": {"shape": pattern, "size": 5}},
        "hovertemplate": PlotMarkup("%{{y}} {}: %{{text}} %<extra></extra>").format(name),
    }


def _percent(value: float) -> str:
    if abs(value) < NOTHING:
        return "0"
    return (f"{value:+.2g}" if abs(value) < 99.5 else f"{value:+.0f}").replace("-", "−")


def change_rows(view: View) -> list[list[str]]:
    """Rows of all inputs, the strongest first: key, value, and what CHANGE more does to the peak."""
    gradients = _gradients(view)
    changes = gradients.relative_changes(CHANGE)
    return [
        [
            gradients.names[place],
            number(float(gradients.value[place])) + _unit(gradients, place, "\u00a0"),
            _percent(100.0 * changes[0, place]),
            _percent(float(gradients.frequency_hz) * changes[1, place]),
            _percent(100.0 * changes[2, place]),
        ]
        for place in gradients.order
    ]


def derivative_rows(view: View) -> list[list[str]]:
    """Rows of all inputs in the same order: key, its unit, and the derivatives; 0 without effect."""
    gradients = _gradients(view)
    changes = np.abs(gradients.relative_changes(CHANGE))
    derivatives = MICRO * gradients.by_amplitude, gradients.by_frequency_hz, MICRO * gradients.by_friction_energy
    return [
        [
            gradients.names[place],
            _unit(gradients, place) or "1",
            *(
                number(float(by[place]), 3) if change[place] > NO_EFFECT else "0"
                for by, change in zip(derivatives, changes, strict=True)
            ),
        ]
        for place in gradients.order
    ]


def _unit(gradients: PeakGradients, place: int, before: str = "") -> str:
    """The unit of an input after a separator; nothing for a pure number."""
    unit = gradients.units[place].replace("um", "µm")
    return "" if unit == "1" else before + unit


def _words(view: View) -> Iterator[str]:
    gradients = _gradients(view)
    yield (
        f"What an input that is 10 % larger or smaller does to the highest peak of {view.study.response_output}, "
        f"{number(MICRO * float(gradients.amplitude))} µm at {hertz(float(gradients.frequency_hz))} Hz, if all others "
        "stay. First order: derivative times 10 % of the input. The values are valid while the contact near the peak "
        "changes little and no other peak becomes the highest."
    )
    percent = 100.0 * np.abs(gradients.relative_changes(CHANGE)[0])
    far = [labels(gradients.names)[place] for place in gradients.order if percent[place] > BEYOND_FIRST_ORDER]
    if far:
        yield (
            f"Above {BEYOND_FIRST_ORDER:.0f} % the first order is not an estimate. Use the derivative by "
            f"{', '.join(far)} for smaller changes only; these bars are truncated."
        )


GRADIENTS = Section(
    "Which input matters most",
    """\
<p class="note">{{ words }}</p>
  {{ parts.panel("tornado", "Change of the peak amplitude by 10 percent of each input, as in the table below") }}
{% if messages %}<ul class="note">{% for message in messages %}<li>{{ message }}</li>{% endfor %}</ul>{% endif %}
{%- for caption, headings, rows in tables %}
{%- if not loop.first %}<details class="more"><summary>{{ caption }}</summary>{% endif %}
{% call parts.scrolled(caption) %}<table class="keys">
{%- if loop.first %}<caption>{{ caption }}</caption>{% endif %}<thead><tr>
{%- for heading in headings %}{{ parts.head_cell(heading, loop.first) }}{% endfor -%}
</tr></thead><tbody>
{%- for row in rows %}<tr><th scope="row" class="word">{{ parts.key(row[0]) }}</th>
{%- for value in row[1:] %}<td>{{ value }}</td>{% endfor -%}
</tr>{% endfor -%}
</tbody></table>{% endcall %}
{%- if not loop.first %}</details>{% endif %}
{% endfor -%}""",
    lambda view: {
        "words": " ".join(_words(view)),
        "messages": _gradients(view).messages,
        "tables": [
            (
                f"Change of the peak by {100 * CHANGE:.0f} % more of an input, first order",
                ["Input", "Value", "Amplitude, %", "Frequency, Hz", "Friction energy, %"],
                change_rows(view),
            ),
            (
                "Derivatives of the peak, over the unit of the input",
                ["Input", "Unit", "Amplitude, µm", "Frequency, Hz", "Friction energy, µJ"],
                derivative_rows(view),
            ),
        ],
    },
    lambda view: {"tornado": tornado(view)},
    applies=lambda view: view.response.gradients is not None,
)  # fmt: skip
