"""Messages on linear limits that differ between cases of a sweep with different joints only."""

from __future__ import annotations

import numpy as np

from stickslip.core.shown_numbers import MICRO, number
from stickslip.reporting.sweep_view import SweepView, value_words
from stickslip.results.sweep_table import SweptKey

# chosen: fraction of the smaller peak by which limits may differ and still count as equal.
SAME_LIMIT = 0.01
# Sections and keys of interfaces without effect on the structure without contact.
_JOINT_SECTIONS = ("preload", "roughness", "contact_stiffness", "friction", "static_loads", "pressures", "gravity")
_JOINT_KEYS = ("gap", "normal_load", "friction", "normal_stiffness", "tangential_stiffness", "allocation")
_REASONS = {
    "stuck": (
        "with all pairs stuck",
        "because the pairs that are closed at rest and their contact stiffness follow this key",
    ),
    "free": (
        "without contact",
        "because damping.modal_damping_ratio applies to the stuck modes, so that the damping matrix follows the "
        "contact stiffness and a part of it acts across the joint even without contact",
    ),
}


def differing_limits(view: SweepView) -> tuple[str, ...]:
    """A sentence for each key of the joint along which a linear limit changes its peak by more than SAME_LIMIT.

    It compares cases that differ in this key alone and whose linear peaks are inside the range; those without viscous
    damping do not count, because their linear peaks are unbounded. The structure without contact does not depend on
    such a key, so where the limit without contact does, it is its damping.
    """
    sentences = []
    for place, key in enumerate(view.table.keys):
        if not _is_of_joint(key):
            continue
        parts = [_range(view, place, limit) for limit in _REASONS]
        nonempty = [part for part in parts if part]
        if nonempty:
            sentences.append(
                f"The linear limits are not the same for all values of {key.name}: the peak "
                f"{'; the peak '.join(nonempty)}. Shifts and reductions of a case refer to its own limits."
            )
    return tuple(sentences)


def _is_of_joint(key: SweptKey) -> bool:
    section, _, rest = key.name.partition(".")
    above, _, last = rest.rpartition(".")
    of_law = above.endswith((".constants", ".stiffness_constants"))
    return section in _JOINT_SECTIONS or (section == "interfaces" and (of_law or last in _JOINT_KEYS))


def _range(view: SweepView, place: int, limit: str) -> str:
    """Smallest and largest peak of a limit, and why they differ, of the group where they differ most; "" if alike."""
    peak = view.number(f"{limit}_peak_amplitude_m")
    valid = ~np.isnan(peak) & (view.number("viscous_energy_j") > 0.0)
    words, largest = "", SAME_LIMIT
    for group in view.groups((place,)):
        rows = group.members[valid[group.members]]
        if rows.size < 2:
            continue
        low, high = int(rows[peak[rows].argmin()]), int(rows[peak[rows].argmax()])
        spread = float(peak[high] / peak[low] - 1.0)
        if spread <= largest:
            continue
        largest, (name, reason) = spread, _REASONS[limit]
        key = view.table.keys[place]
        ends = " to ".join(
            f"{number(MICRO * float(peak[row]))} µm ({value_words(key, view.positions[row, place])})"
            for row in (low, high)
        )
        others = f" with {group.label}" if group.label else ""
        words = f"{name}{others} runs from {ends}, {reason}"
    return words
