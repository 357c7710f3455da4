"""The section of the page on the stress at the peak: its extremes, the picture of it and the Goodman check."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.reporting.section import Section
from stickslip.reporting.structure_picture import STRESS_WORDS
from stickslip.reporting.structure_still import Paint, still_picture
from stickslip.reporting.style import MICRO, number, shown_number
from stickslip.reporting.view import View
from stickslip.results.stress import REGION_WORDS, Region, StressExtreme, StressSummary

_MPA = 1e-6  # Pa to MPa
_STATIC = {
    "solved": "It contains the stress of the state at rest, solved from the static load.",
    "none": "Nothing loads the structure at rest, so this is the complete stress.",
    "unknown": (
        "It is the stress of the vibration alone: the preload is prescribed, which does not define the displacements at "
        'rest. With preload.method = "solved" the stress at rest is included.'
    ),
}


def _values(view: View) -> dict[str, Any]:
    stress, sketch = view.study.stress, view.study.sketch
    assert stress is not None  # the section applies only where there is one
    still = ""
    if sketch is not None and sketch.stress is not None:
        paint = Paint(_MPA * np.asarray(sketch.stress.alternating, dtype=float), STRESS_WORDS["alternating"])
        still = base64.b64encode(still_picture(view.study, sketch, paint)).decode("ascii")
    return {
        "frequency": shown_number(stress.frequency_hz, "Hz"),
        "static": _STATIC[stress.static],
        "rows": list(_rows(stress)),
        "per_force": list(_per_force(stress)),
        "goodman": [(row.body, number(row.value), _position(row)) for row in stress.goodman],
        "goodman_message": stress.goodman_message,
        "truncation": number(100.0 * stress.truncation, 2),
        "still": still,
    }


def _rows(stress: StressSummary) -> Iterator[tuple[str, str, str, str, str]]:
    """Measure; value and position away from contacts and loads; value and position on the whole mesh."""
    apart = {row.quantity: row for row in stress.extremes}
    for row in stress.everywhere:
        inside = apart.get(row.quantity)
        words = ("–", "–") if inside is None else (_mpa(inside), _position(inside))
        yield (row.quantity[0].upper() + row.quantity[1:], *words, _mpa(row), _position(row))


def _per_force(stress: StressSummary) -> Iterator[tuple[str, str]]:
    """Peak stress and displacement for 1 N of the excitation."""
    if not stress.force > 0.0:
        return
    alternating = [row for row in stress.extremes if row.quantity == "alternating stress"]
    for row in alternating:
        yield "Alternating stress per unit of force", f"{number(_MPA * row.value / stress.force)} MPa/N"
    yield "Displacement per unit of force", f"{number(MICRO * stress.displacement / stress.force)} µm/N"
    yield "Force amplitude", f"{number(stress.force)} N"


def _mpa(row: StressExtreme) -> str:
    return number(_MPA * row.value).replace("-", "−")


def _position(row: StressExtreme) -> str:
    x, y, z = (f"{1e3 * each:.1f}".replace("-", "−") for each in row.position)
    words = REGION_WORDS[Region(row.region)]
    return f"{row.body} ({x}, {y}, {z}) mm{', ' + words if words else ''}"


STRESS = Section(
    "Stress at the peak",
    """\
  <p class="note">Stress of the full mesh over one period at {{ frequency }} Hz, at the nodes, as the mean over the cells
  of a body. {{ static }} The alternating stress is half of the largest von Mises stress of the difference of the stress
  tensors at two instants; the mean stress is the von Mises stress of their mean. The range of von Mises stress is no
  measure of fatigue, because von Mises stress has no sign.</p>
  {% if still %}
  <figure class="panel"><img class="stress" alt="Alternating stress on the surface of the structure" src="data:image/png;base64,{{ still }}">
  <figcaption class="note">Alternating stress, at contacts and loads too. In the picture of the structure above, the list
  “Colour” shows it from all sides, and the largest von Mises stress.</figcaption></figure>
  {% endif %}
{% call parts.scrolled("Stress at the peak") %}<table><thead><tr><th class="word">Measure</th>
<th>Away from contacts and loads, MPa</th><th class="word">Position (x, y, z)</th><th>Whole mesh, MPa</th>
<th class="word">Position (x, y, z)</th></tr></thead><tbody>
{%- for measure, value, position, whole, whole_position in rows %}<tr><th scope="row" class="word">{{ measure }}</th>
<td>{{ value }}</td><td class="word">{{ position }}</td><td>{{ whole }}</td><td class="word">{{ whole_position }}</td></tr>
{%- endfor -%}
</tbody></table>{% endcall %}
  <p class="note">In the cells at a contact or at a concentrated load, the stress depends on the mesh: it grows without
  limit as the cells become smaller, like that of a point force. Therefore the first column excludes these cells. At the
  edge of a constrained face, and in sharp inner corners, the same is true, but the column includes them. Modes that the
  reduction omits contribute up to {{ truncation }} % of the largest alternating stress; the values contain this part, as
  if these modes had no mass.</p>
  {% if per_force %}{{ parts.named_values("Per unit of force", per_force, "Per unit of force") }}
  <p class="note">A joint is nonlinear: these quotients are those of this force amplitude.</p>{% endif %}
  <h3>Goodman check</h3>
  <p class="note">{{ goodman_message }}</p>
  {% if goodman %}
{% call parts.scrolled("Goodman check") %}<table><thead><tr><th class="word">Body</th><th>Smallest safety factor S</th>
<th class="word">Position (x, y, z)</th></tr></thead><tbody>
{%- for body, factor, position in goodman %}<tr><th scope="row" class="word">{{ body }}</th><td>{{ factor }}</td>
<td class="word">{{ position }}</td></tr>{% endfor -%}
</tbody></table>{% endcall %}
  <p class="note">The factor multiplies alternating and mean stress alike. It contains no factors of notch, surface, size
  or temperature. A compressive mean stress counts as if it were tensile. Cells at contacts and loads are excluded;
  fretting there is a separate check.</p>
  {% endif %}
""",
    _values,
    applies=lambda view: view.study.stress is not None,
    identity="stress",
)
