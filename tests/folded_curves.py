"""A response whose curve folds, with every other number of the synthetic one."""

from __future__ import annotations

import dataclasses

import numpy as np

from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response

FOLD_HZ, VALLEY_HZ = 428.0, 424.0


def folded_response() -> ForcedResponse:
    """Frequencies that rise to FOLD_HZ, fall to VALLEY_HZ and rise again; the highest amplitude lies on the last part.

    The amplitude grows along the middle part, so that a sweep up and a sweep down reach different peaks.
    """
    response = synthetic_response()
    top = int(response.input_energy.argmax())
    first, count = top - 12, response.n_points
    frequency = np.empty(count)
    frequency[: first + 1] = np.linspace(410.0, FOLD_HZ, first + 1)
    frequency[first : top + 1] = np.linspace(FOLD_HZ, VALLEY_HZ, top - first + 1)
    frequency[top:] = np.linspace(VALLEY_HZ, 440.0, count - top)
    return dataclasses.replace(response, frequency_hz=frequency)
