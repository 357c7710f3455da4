"""The modelling choices of a run on the page, each with its effect on the peak: computed in this run, or its order.

docs/assumptions.md has the same list with sources.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.contact.law.exponential import ExponentialContact
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.contact.pairing.rows import EFFECT_OF_FEW_ROWS, faces_with_few_rows, rows_of_pairs
from stickslip.core.errors import InputError
from stickslip.core.shown_numbers import MICRO, number
from stickslip.core.validation import FloatArray
from stickslip.reporting.section import Section
from stickslip.reporting.stiffness_words import stiffness_range
from stickslip.reporting.style import shown_number
from stickslip.reporting.view import View
from stickslip.results.record import CONSTANT_STIFFNESS_PEAK

PEAK_NAMES = (CONSTANT_STIFFNESS_PEAK, f"{CONSTANT_STIFFNESS_PEAK}: frequency")  # amplitude in µm, Hz
# The change of an input whose first-order effect on the peak is shown.
CHANGE = 0.1


@dataclass(frozen=True)
class Assumption:
    """A row: the choice, what this run has, its effect on the peak, and whether this run computed the effect."""

    choice: str
    here: str
    effect: str
    computed: bool = False

    @property
    def source(self) -> str:
        """The source of the effect."""
        return "this run" if self.computed else "documented"


@dataclass(frozen=True)
class _Facts:
    """The data of a run for the rows."""

    view: View

    @cached_property
    def inputs(self) -> dict[str, str]:
        """Dotted key -> text of the study."""
        try:
            return self.view.study.input_values()
        except InputError:  # the inputs of a record from Python may be any text
            return {}

    @cached_property
    def motion(self) -> FloatArray:
        """(n, n_pairs, 3) m at the peak."""
        return self.view.response.pair_displacement(self.view.point, self.view.response.samples)

    @cached_property
    def normal_variation(self) -> FloatArray:
        """Half of the range of the normal force over the period of the peak, over the load of the pair at rest."""
        load = self.view.response.pairs.normal_load
        force = self.view.response.pair_cycle(self.view.point).force[:, :, 2]
        return np.asarray(0.5 * np.ptp(force, axis=0)[load > 0.0] / load[load > 0.0])

    @property
    def has_friction(self) -> bool:
        return any(isinstance(law, FrictionLaw) for law in self.view.response.pairs.laws)

    @property
    def is_rough(self) -> bool:
        return any(key.startswith("roughness.") for key in self.inputs)

    @property
    def is_solved(self) -> bool:
        return self.inputs.get("preload.method") == "solved"

    def change(self, key: str) -> str:
        """First-order change of the peak by 10 % more of an input; "" without its gradient."""
        gradients = self.view.response.gradients
        if gradients is None or key not in gradients.names:
            return ""
        percent = 100.0 * float(gradients.relative_changes(CHANGE)[0][gradients.names.index(key)])
        return f"10 % more: {percent:+.2g} % of the peak, first order".replace("-", "−")


def assumptions(view: View) -> list[Assumption]:
    """The rows, those of the contact first."""
    facts = _Facts(view)
    rows = [*_stiffness(facts), *_state_at_rest(facts), *_friction(facts), *_structure(facts), *_solution(facts)]
    return sorted(rows, key=lambda row: not row.computed)


def _stiffness(facts: _Facts) -> Iterator[Assumption]:
    view = facts.view
    if not facts.has_friction:
        return
    band = stiffness_range(view.summary)
    here = "from the roughness, not measured" if facts.is_rough else "given in the study"
    if band:
        yield Assumption("Contact stiffness", here, f"1/3 to 3 of it: {band}", computed=True)
    elif facts.is_rough:
        words = "not computed (analysis.stiffness_band); two measurements of one contact differ by a factor 3"
        yield Assumption("Contact stiffness", here, words)
    else:
        yield Assumption("Contact stiffness", here, "that of its measurement")
    yield _stiffness_in_cycle(facts)
    yield Assumption(
        "Tangential over normal stiffness",
        "constant, the same in both directions" if facts.is_rough else "given in the study",
        "inside of the band of the stiffness: boundary elements give 0.79 to 0.87 where 2(1−ν)/(2−ν) is 0.82",
    )
    yield Assumption(
        "Damping, adhesion and heat of the contact",
        "none along the normal; friction is the only loss",
        "not computed; losses that the model omits would lower the peak",
    )


def _stiffness_in_cycle(facts: _Facts) -> Assumption:
    pairs = facts.view.response.pairs
    count = sum(law.n_pairs for law in pairs.laws if isinstance(law, ExponentialContact))
    if count:
        where = "" if count == pairs.n_pairs else f" in {count} of {pairs.n_pairs} pairs and is constant in the others"
        effect = _effect_of_momentary_stiffness(facts)
        return Assumption(
            "Contact stiffness during the cycle",
            f"normal stiffness follows the momentary pressure{where}, tangential stiffness is that at rest",
            effect
            or "compare with the law coulomb; 0.5 % on the default two blades, 9 % up or down where pairs separate",
            computed=bool(effect),
        )
    variation = facts.normal_variation
    if not variation.size:
        return Assumption("Contact stiffness during the cycle", "constant", "no pair has a normal load")
    largest, median = (number(100.0 * float(value), 2) for value in (variation.max(), np.median(variation)))
    return Assumption(
        "Contact stiffness during the cycle",
        "constant while a pair is closed",
        f"at the peak the normal force varies by ±{median} % of the load (median, largest ±{largest} %), so the "
        'stiffness of a rough face would too; the law "exponential" computes the effect: 0.5 % of the peak at ±16 % '
        "(the default two blades), 9 % up or down where pairs separate (two other studies)",
    )


def _effect_of_momentary_stiffness(facts: _Facts) -> str:
    """The peak with constant springs, which the run computed beside its own; "" without it."""
    values = {name: value for name, value, _, _ in facts.view.study.derived}
    amplitude, frequency = (values.get(name) for name in PEAK_NAMES)
    if not isinstance(amplitude, float) or not isinstance(frequency, float):
        return ""
    own = facts.view.summary.peak
    change = number(100.0 * (MICRO * own.amplitude / amplitude - 1.0), 2)
    return (
        f"{change} % of the peak and {shown_number(own.frequency_hz - frequency, 'Hz')} against constant springs "
        f"({number(amplitude)} µm at {shown_number(frequency, 'Hz')})"
    )


def _state_at_rest(facts: _Facts) -> Iterator[Assumption]:
    view, measures = facts.view, facts.view.summary
    if not facts.has_friction:
        return
    if facts.is_solved:
        yield Assumption("Pressure at rest", "solved with contact and friction", "that of the stiffness of the contact")
    else:
        yield Assumption(
            "Pressure at rest",
            "varies within a face, as given" if view.rest_varies else "uniform on each face",
            'a solved pressure (preload.method = "solved") raised the peak of rough blades by 7 to 39 %',
        )
    released = view.response.pairs.released
    here = "retained: that of the load ramp" if facts.is_solved else "retained, from none at rest"
    if released:
        here = "released: a stuck pair has no mean traction"
    if measures.traction_peaks is not None:
        low, high = (number(MICRO * value) for value in measures.traction_peaks)
        yield Assumption("Mean traction of stuck pairs", here, f"extreme tractions: {low} to {high} µm", computed=True)
    else:
        yield Assumption(
            "Mean traction of stuck pairs",
            here,
            "kept and released differed by 4 to 16 %; analysis.traction_band computes the range",
        )


def _friction(facts: _Facts) -> Iterator[Assumption]:
    if not facts.has_friction:
        return
    pairs = facts.view.response.pairs
    values = pairs.friction_coefficient[~np.isnan(pairs.friction_coefficient)]
    ends = dict.fromkeys(number(float(end), 3) for end in (values.min(), values.max()))
    change = facts.change("friction.coefficient")
    order = "analysis.gradients computes the effect; dry metal joints have 0.1 to 0.8"
    yield Assumption(
        "Friction coefficient",
        f"{' to '.join(ends)}, constant: the same at any speed, pressure, slip and time",
        change or order,
        computed=bool(change),
    )
    if facts.view.response.wear is None:
        yield Assumption(
            "Wear", "none: faces and loads stay", 'unknown until computed: analysis.kind = "wear" follows the peak'
        )


def _structure(facts: _Facts) -> Iterator[Assumption]:
    view, measures = facts.view, facts.view.summary
    change = facts.change("damping.modal_damping_ratio")
    share = number(100.0 * (1.0 - measures.friction_share), 3)
    fraction = f"at the peak it dissipates {share} % of the energy"
    has_ratio = "modal_damping_ratio" in view.response.settings
    yield Assumption(
        "Damping of the structure",
        "one ratio for every mode of the stuck structure" if has_ratio else "a viscous damping matrix",
        f"{fraction}. {change}." if change else fraction,
        computed=True,
    )
    differences = [
        abs(float(row["difference_percent"])) for row in view.study.mode_table if "difference_percent" in row
    ]
    if differences:
        yield Assumption(
            "Reduced model",
            "contact nodes and some modes of the structure",
            f"its natural frequencies are within {number(max(differences), 2)} % of those of the mesh",
            computed=True,
        )
    face, position = view.study.pair_face, view.study.pair_position
    counts = dict.fromkeys(f"{max(each)} by {min(each)}" for each in rows_of_pairs(face, position))
    if counts:
        few = bool(faces_with_few_rows(face, position))
        yield Assumption(
            "Number of contact pairs",
            f"{' and '.join(counts)} on a face",
            (f"where pairs separate: {EFFECT_OF_FEW_ROWS}" if few else "below 3 % even where pairs separate")
            + "; without separation below 0.1 %",
        )


def _solution(facts: _Facts) -> Iterator[Assumption]:
    view = facts.view
    for key, choice, here in (
        ("error_by_neglected_harmonics", "Number of harmonics", f"{view.response.harmonics}"),
        ("residual_with_doubled_samples", "Samples of the period", f"{view.response.samples}"),
    ):
        value = view.response.settings.get(key)
        if isinstance(value, float) and np.isfinite(value):
            effect = f"at most {number(100.0 * value, 2)} % of the motion on the curve, estimated"
            yield Assumption(choice, here, effect, computed=True)
    slide = 0.5 * np.ptp(facts.motion[:, :, :2], axis=0).max(initial=0.0)
    distance = _smallest_distance(view)
    if distance is not None:
        yield Assumption(
            "Small displacements",
            "the points of a pair remain the same; normals do not rotate",
            f"at the peak a pair moves by {number(MICRO * float(slide), 3)} µm, "
            f"{number(100.0 * float(slide) / distance, 2)} % of the distance to the next pair",
            computed=True,
        )


def _smallest_distance(view: View) -> float | None:
    """m, between two pairs of one face; None if no face has two."""
    nearest = []
    for face in range(len(view.study.face_names)):
        position = view.study.pair_position[view.study.pair_face == face]
        if len(position) > 1:
            sides = np.ptp(position, axis=0)
            nearest.append(float(np.sqrt(sides.prod() / len(position))) or float(sides.max() / (len(position) - 1)))
    return min(nearest) if nearest and min(nearest) > 0.0 else None


def _values(view: View) -> dict[str, Any]:
    return {"rows": assumptions(view)}


ASSUMPTIONS = Section(
    "Modelling choices and their effect on the peak",
    """\
  <p class="note">What this run assumes, and how far the peak moves with it. Effects with the source “this run” were
  computed here; the others are orders of magnitude from the documentation (assumptions.md), for other structures.</p>
{% call parts.scrolled("Modelling choices") %}<table class="plain choices"><thead><tr>
<th class="word">Choice, and what this run has</th><th class="word">Effect on the peak</th>
<th class="word">Source</th></tr></thead><tbody>
{%- for row in rows %}<tr><th scope="row">{{ row.choice }}<span>{{ row.here }}</span></th>
<td class="word long">{{ row.effect }}</td><td class="word unit">{{ row.source }}</td></tr>{% endfor -%}
</tbody></table>{% endcall %}""",
    _values,
)
