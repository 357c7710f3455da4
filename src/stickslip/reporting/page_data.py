"""The numbers behind the page, packed small: typed arrays in base64 that page.js unpacks.

For the maps the page contains state and energy of each pair. For the loops it contains the displacement coefficients of
each pair, and the friction force only of pairs that slip or separate, as 16-bit numbers: a stuck pair's force is that
of its spring. If all of that is too much, the page contains maps and loops for fewer points, spread evenly along the
curve and with the peak, and no loops if even those of the peak are too many; it reports this.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.law import ContactState
from stickslip.core.shown_numbers import MICRO
from stickslip.reporting.packing import FULL_SCALE, packed
from stickslip.reporting.plots import group_labels
from stickslip.reporting.style import STATES
from stickslip.reporting.view import View

# Characters of numbers on a page; with plotly.js (4.8 million) and its words the page is below 15 MB.
DATA_CHARACTERS = 9_000_000
# Characters of a pair and a point on any page: labels, positions and marks of a pair; curves at a point.
PAIR_CHARACTERS = 350
POINT_CHARACTERS = 150
HEIGHT_CHARACTERS = 10  # of one height of a rough face
LARGEST_MAP_FRACTION = 0.5  # chosen: of the space for maps and loops
MAP_BYTES = 5  # of a pair at a point: state and energy
LOOP_SAMPLES = 128


def page_data(view: View, picture_characters: int = 0) -> dict[str, Any]:
    """Everything that page.js needs, ready for JSON. Lengths in µm, energies in ``view.energy_unit``.

    ``picture_characters`` are those of sections with data of their own, such as the picture of the structure; they
    reduce the space for numbers.
    """
    response, study = view.response, view.study
    n_coefficients = 2 * response.harmonics + 1
    signals = {name: packed(MICRO * response.coefficients(study.outputs[name]), "f4") for name in _signal_names(view)}
    room = _free_bytes(view, picture_characters + sum(len(text) for text in signals.values()))
    map_points = _points_with_maps(view, room)
    room -= map_points.size * MAP_BYTES * response.pairs.n_pairs
    return {
        "points": response.n_points,
        "nPairs": response.pairs.n_pairs,
        "coefficients": n_coefficients,
        "point": view.point,
        "peakFrequency": round(view.summary.peak.frequency_hz, 6),
        "peakAmplitude": float(f"{MICRO * view.summary.peak.amplitude:.7g}"),
        "pair": view.pair,
        "frequency": response.frequency_hz.round(6).tolist(),
        "amplitude": [float(f"{value:.7g}") for value in view.amplitude_um],
        "energyUnit": view.energy_unit,
        "energyTotal": [float(f"{value:.7g}") for value in view.energy_factor * response.friction_energy.sum(axis=1)],
        "mapPoints": map_points.tolist(),
        "states": packed(response.contact_state[map_points], "i1"),
        "energy": packed(view.energy_factor * response.friction_energy[map_points], "f4"),
        "stateStyles": _state_styles(view),
        "lawStates": [[law.states.get(state) for state in ContactState] for law in response.pairs.laws],
        "lawOfPair": _law_of_pair(response.pairs).tolist(),
        "faces": len(study.face_names),
        "pairFace": study.pair_face.tolist(),
        "pairPosition": (1e3 * study.pair_position).round(4).tolist(),
        "pairLabel": [view.pair_label(pair) for pair in range(response.pairs.n_pairs)],
        **_coulomb_constants(response.pairs),
        "groups": [list(names) for names in study.signal_groups.values()],
        "groupLabels": [list(group_labels(names)) for names in study.signal_groups.values()],
        "signals": signals,
        "loops": _loops(view, map_points, room),
    }


def _coulomb_constants(pairs: ContactPairs) -> dict[str, Any]:
    """What the page draws Coulomb pairs from; ``coulomb`` says which they are, and others have zeros."""
    springs = np.column_stack([pairs.tangential_springs, pairs.normal_stiffness])
    return {
        "coulomb": [int(each) for each in _follows_coulomb(pairs)],
        "springs": packed(np.nan_to_num(springs), "f4"),
        "friction": packed(np.nan_to_num(pairs.friction_coefficient), "f4"),
        "preload": packed(np.nan_to_num(pairs.preload), "f4"),
    }


def _law_of_pair(pairs: ContactPairs) -> NDArray[np.int64]:
    """(n_pairs,) which of the laws a pair follows."""
    law_of_pair = np.empty(pairs.n_pairs, dtype=np.int64)
    for number, members in enumerate(pairs.members):
        law_of_pair[members] = number
    return law_of_pair


def _follows_coulomb(pairs: ContactPairs) -> NDArray[np.bool_]:
    """(n_pairs,) whether a pair follows Coulomb's law."""
    return np.array([isinstance(law, CoulombLaw) for law in pairs.laws])[_law_of_pair(pairs)]


def _state_styles(view: View) -> list[dict[str, str | None]]:
    """Style of each state, by its code; without a name if no pair can have it."""
    names = view.response.pairs.state_names
    return [
        {"name": names.get(state), "colour": style.colour, "symbol": style.plotly_symbol}
        for state, style in zip(ContactState, STATES, strict=True)
    ]


def _signal_names(view: View) -> list[str]:
    return sorted({name for names in view.study.signal_groups.values() for name in names})


def _free_bytes(view: View, used: int) -> int:
    """Bytes for maps and loops, which take four characters for three bytes; ``used`` are characters of others."""
    response = view.response
    used += PAIR_CHARACTERS * response.pairs.n_pairs + POINT_CHARACTERS * response.n_points
    if view.study.rough_patch is not None:
        used += HEIGHT_CHARACTERS * view.study.rough_patch.height.size
    return max(0, (DATA_CHARACTERS - used) * 3 // 4)


def _points_with_maps(view: View, room: int) -> NDArray[np.int64]:
    """Points whose states and energies are on the page: all, or as many as fit into their part of the space."""
    response = view.response
    size = np.full(response.n_points, MAP_BYTES * response.pairs.n_pairs)
    selected = _points_within(size, np.arange(response.n_points), view.point, int(LARGEST_MAP_FRACTION * room))
    return selected if selected.size else np.array([view.point])


def _loops(view: View, map_points: NDArray[np.int64], room: int) -> dict[str, Any]:
    """Loops at points among those ``map_points`` with maps, in ``room`` bytes."""
    response = view.response
    stride = max(1, round(response.samples / LOOP_SAMPLES))
    times = np.arange(0, response.samples, stride)
    # The page draws stuck released pairs itself, on their springs; with tractions at rest, and for pairs of other laws,
    # it needs all forces.
    coulomb = _follows_coulomb(response.pairs)
    drawn = response.pairs.released & coulomb
    moving = (response.contact_state != ContactState.STUCK) | ~drawn
    relative_size = response.pairs.n_pairs * (3 * (2 * response.harmonics + 1) * 4 + 4)  # and the slots of forces
    one_force = times.size * 2 + 4  # and its scale
    size = relative_size + moving.sum(axis=1) * 2 * one_force + np.count_nonzero(~coulomb) * one_force
    points = _points_within(size, map_points, view.point, room)
    slots = np.full((points.size, response.pairs.n_pairs), -1)
    forces: list[NDArray[np.float64]] = []
    scales: list[NDArray[np.float64]] = []
    coefficients = []
    normal_forces: list[NDArray[np.float64]] = []
    normal_scales: list[NDArray[np.float64]] = []
    for position, point in enumerate(points):
        coefficients.append(MICRO * response.pair_coefficients(int(point)))
        active = np.flatnonzero(moving[point])
        if not active.size:
            continue
        whole = response.pair_cycle(int(point)).force[times]
        # The page knows the normal force of Coulomb pairs from their springs; that of others is held.
        normal = whole[:, ~coulomb, 2]
        normal_scales.append(np.maximum(np.abs(normal).max(axis=0), 1e-30) / FULL_SCALE)
        normal_forces.append(np.rint(normal / normal_scales[-1]).T)
        force = whole[:, active, :2]
        scale = np.maximum(np.abs(force).max(axis=(0, 2)), 1e-30) / FULL_SCALE
        slots[position, active] = sum(map_points.size for map_points in scales) + np.arange(active.size)
        scales.append(scale)
        forces.append(np.rint(force / scale[None, :, None]).transpose(1, 2, 0))
    return {
        "points": points.tolist(),
        "times": (times / response.samples).tolist(),
        "relative": packed(np.array(coefficients), "f4"),
        "slots": packed(slots, "i4"),
        "scales": packed(np.concatenate(scales) if scales else np.empty(0), "f4"),
        "forces": packed(np.concatenate(forces) if forces else np.empty(0), "i2"),
        "normalSlot": (np.where(coulomb, -1, np.cumsum(~coulomb) - 1)).tolist(),
        "normalPairs": int(np.count_nonzero(~coulomb)),
        "normalScales": packed(np.concatenate(normal_scales) if normal_scales else np.empty(0), "f4"),
        "normalForces": packed(np.concatenate(normal_forces) if normal_forces else np.empty(0), "i2"),
    }


def _points_within(size: NDArray[np.int64], candidates: NDArray[np.int64], always: int, room: int) -> NDArray[np.int64]:
    """Points among ``candidates``, evenly thinned until their sizes fit, with ``always``; none if it alone is too much.

    ``size`` (n_points,) bytes of each point.
    """
    for step in range(1, candidates.size + 1):
        points = np.union1d(candidates[::step], [always])
        if size[points].sum() <= room:
            return points
    return np.array([always] if size[always] <= room else [], dtype=np.int64)
