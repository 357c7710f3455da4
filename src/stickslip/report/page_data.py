"""The numbers behind the page, packed small: typed arrays in base64 that page.js unpacks.

States and energies go in for every point. For the loops the page holds the displacement coefficients of each pair, and
the friction force only of pairs that slip or separate, as 16-bit numbers: a stuck pair's force is that of its spring.
Where all of that would be too much, loops are held for fewer points, spread evenly along the curve and with the peak.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.report.plots import group_labels
from stickslip.report.style import MICRO, STATES
from stickslip.report.view import View

LOOP_BYTES = 6_000_000
LOOP_SAMPLES = 128
_FULL_SCALE = 32767


def packed(array: NDArray[Any], kind: str) -> str:
    """Base64 of an array in little-endian ``kind``: "i1", "i2", "i4" or "f4"."""
    return base64.b64encode(np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()).decode("ascii")


def page_data(view: View) -> dict[str, Any]:
    """Everything that page.js needs, ready for JSON. Lengths in µm, energies in ``view.energy_unit``."""
    response, study = view.response, view.study
    n_coefficients = 2 * response.harmonics + 1
    signals = {name: MICRO * response.coefficients(study.outputs[name]) for name in _signal_names(view)}
    return {
        "points": response.n_points,
        "nPairs": response.pairs.n_pairs,
        "coefficients": n_coefficients,
        "point": view.point,
        "pair": view.pair,
        "frequency": response.frequency_hz.round(6).tolist(),
        "amplitude": [float(f"{value:.7g}") for value in view.amplitude_um],
        "energyUnit": view.energy_unit,
        "energyTotal": [float(f"{value:.7g}") for value in view.energy_factor * response.friction_energy.sum(axis=1)],
        "states": packed(response.contact_state, "i1"),
        "energy": packed(view.energy_factor * response.friction_energy, "f4"),
        "stateStyles": [{"name": s.name, "colour": s.colour, "symbol": s.plotly_symbol} for s in STATES],
        "faces": len(study.face_names),
        "pairFace": study.pair_face.tolist(),
        "pairPosition": (1e3 * study.pair_position).round(4).tolist(),
        "pairLabel": [view.pair_label(pair) for pair in range(response.pairs.n_pairs)],
        "springs": packed(np.column_stack([response.pairs.tangential_springs, response.pairs.normal_stiffness]), "f4"),
        "friction": packed(response.pairs.friction_coefficient, "f4"),
        "preload": packed(response.pairs.preload, "f4"),
        "groups": [list(names) for names in study.signal_groups.values()],
        "groupLabels": [list(group_labels(names)) for names in study.signal_groups.values()],
        "signals": {name: packed(values, "f4") for name, values in signals.items()},
        "loops": _loops(view),
    }


def _signal_names(view: View) -> list[str]:
    return sorted({name for names in view.study.signal_groups.values() for name in names})


def _loops(view: View) -> dict[str, Any]:
    response = view.response
    stride = max(1, round(response.samples / LOOP_SAMPLES))
    times = np.arange(0, response.samples, stride)
    # The page draws stuck released pairs itself; where tractions at rest are kept it needs all forces.
    moving = (response.contact_state != 0) | (not response.pairs.released)
    relative_size = response.pairs.n_pairs * 3 * (2 * response.harmonics + 1) * 4
    size = relative_size + moving.sum(axis=1) * 2 * times.size * 2
    points = _points_within(size, view.point)
    slots = np.full((points.size, response.pairs.n_pairs), -1)
    forces: list[NDArray[np.float64]] = []
    scales: list[NDArray[np.float64]] = []
    coefficients = []
    for position, point in enumerate(points):
        coefficients.append(MICRO * response.pair_coefficients(int(point)))
        active = np.flatnonzero(moving[point])
        if not active.size:
            continue
        force = response.pair_cycle(int(point)).force[times][:, active, :2]
        scale = np.maximum(np.abs(force).max(axis=(0, 2)), 1e-30) / _FULL_SCALE
        slots[position, active] = sum(held.size for held in scales) + np.arange(active.size)
        scales.append(scale)
        forces.append(np.rint(force / scale[None, :, None]).transpose(1, 2, 0))
    return {
        "points": points.tolist(),
        "times": (times / response.samples).tolist(),
        "relative": packed(np.array(coefficients), "f4"),
        "slots": packed(slots, "i4"),
        "scales": packed(np.concatenate(scales) if scales else np.empty(0), "f4"),
        "forces": packed(np.concatenate(forces) if forces else np.empty(0), "i2"),
    }


def _points_within(size: NDArray[np.int64], always: int) -> NDArray[np.int64]:
    """Points along the curve, evenly thinned until their loops fit, with ``always`` among them."""
    for step in range(1, size.size + 1):
        points = np.union1d(np.arange(0, size.size, step), [always])
        if size[points].sum() <= LOOP_BYTES:
            return points
    return np.array([always])
