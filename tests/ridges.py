"""Ridges of peaks from closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np

import stickslip as ss
from stickslip.core.validation import FloatArray


def ridge_of(*curves: tuple[FloatArray, FloatArray], **changes: Any) -> ss.PeakRidge:
    """Ridges of peaks at 50 Hz from values of the parameter and amplitudes."""
    parameter, amplitude = (np.concatenate(each) for each in zip(*curves, strict=True))
    count, limits = parameter.size, np.array([parameter.min(), parameter.max()])
    fields: dict[str, Any] = {
        "parameter": parameter,
        "amplitude": amplitude,
        "frequency_hz": np.full(count, 50.0),
        "ridge": np.repeat(np.arange(len(curves)), [len(each) for each, _ in curves]),
        "is_corner": np.zeros(count, dtype=bool),
        "curvature": np.full(count, -1.0),
        **dict.fromkeys(("pairs_stuck", "pairs_stick_slip", "pairs_separating"), np.ones(count, dtype=int)),
        "residual": np.zeros(count),
        "iterations": np.ones(count, dtype=int),
        **{
            f"{name}_{what}": np.full(2, value) if what != "parameter" else limits
            for name, value in (("stuck", 2e-5), ("free", 3e-5))
            for what in ("parameter", "amplitude", "frequency_hz")
        },
        "parameter_name": "load",
        "parameter_unit": "N",
        "output_name": "tip",
        "start": limits[0],
        "stop": limits[1],
        "ends": (("", ""),) * len(curves),
        "converged": True,
        "message": "The highest peak is known over the whole range.",
        "warnings": (),
        "settings": {"harmonics": 1},
        "provenance": {"solve_seconds": "1"},
    }
    return ss.PeakRidge(**fields | changes)


def valley(load: FloatArray, best: float = 10.0) -> FloatArray:
    """An amplitude in m with its minimum at the load ``best``."""
    return np.asarray(1e-5 * np.sqrt(load / best + best / load))
