"""Results of many pairs and points, for tests of the size of pages: a small solved case, repeated."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response, synthetic_study


def large_result(n_pairs: int, n_points: int) -> tuple[ForcedResponse, StudyRecord]:
    """At least ``n_pairs`` pairs and ``n_points`` points: the pairs stand side by side, the curve is gone along again.

    No equation of motion is met, but every array has the size and the digits of a real one.
    """
    response, study = synthetic_response(), synthetic_study()
    old = response.pairs
    copies = -(-n_pairs // old.n_pairs)
    rounds = -(-n_points // response.n_points)

    def again(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values] * rounds)[:n_points]

    def each(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values] * copies)

    pairs = ContactPairs(
        np.vstack([old.operator] * copies),
        each(old.normal_stiffness),
        each(old.tangential_stiffness),
        each(old.friction_coefficient),
        each(old.preload),
    )
    along_curve: dict[str, Any] = {
        name: again(getattr(response, name))
        for name in (
            "displacement",
            "load_factor",
            "residual",
            "iterations",
            "input_energy",
            "viscous_energy",
            "kinetic_energy",
            "part",
        )
    }
    for name in ("contact_state", "dissipated_energy", "normal_work", "closure"):
        along_curve[name] = np.tile(again(getattr(response, name)), (1, copies))
    frequency = np.linspace(response.frequency_hz[0], response.frequency_hz[-1], n_points)
    length = np.ptp(study.pair_position[:, 0]) * 1.1
    shift = np.repeat(np.arange(copies), old.n_pairs)[:, None] * np.array([length, 0.0])
    return (
        dataclasses.replace(response, pairs=pairs, frequency_hz=frequency, **along_curve),
        dataclasses.replace(
            study,
            pair_face=each(study.pair_face),
            pair_position=np.vstack([study.pair_position] * copies) + shift,
            pair_area=each(study.pair_area),
        ),
    )
