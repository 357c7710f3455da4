"""The contact pairs of a solved study as points for ParaView, at the peak or at another frequency of the curve."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.results.measures import summary
from stickslip.results.pair_measures import pair_measures, point_at_frequency
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.structure.export import write_points

NO_POSITIONS = (
    "the results contain no positions of the contact pairs in space: the study has matrices without node positions, or "
    "an earlier version of stickslip wrote the results. In the second case, solve again."
)


def contact_fields(response: ForcedResponse, study: StudyRecord, point: int) -> dict[str, FloatArray]:
    """Name and unit -> values (n_pairs,) of all pairs at a point of the curve, for a file of ParaView."""
    pairs = pair_measures(response, point)
    return {
        "face": study.pair_face.astype(float),
        "state (0 stuck, 1 stick-slip, 2 separating)": pairs.state.astype(np.int32),
        "stick, fraction of the period": pairs.stick_fraction,
        "slip, fraction of the period": pairs.slip_fraction,
        "separated, fraction of the period": pairs.separated_fraction,
        "slip distance per cycle, m": pairs.slip_distance,
        "mean normal pressure, Pa": pairs.mean_normal_force / study.pair_area,
        "normal load at rest, N": pairs.normal_load,
        "dissipated energy per cycle, J": pairs.dissipated_energy,
        "area, m2": study.pair_area,
        "frequency, Hz": np.full(study.pair_area.size, response.frequency_hz[point]),
    }


def write_contact(
    path: str | PathLike[str], response: ForcedResponse, study: StudyRecord, frequency_hz: float | None = None
) -> Path:
    """Write the contact pairs with their states, slip, pressure and energy as points of one .vtu file.

    Parameters
    ----------
    frequency_hz:
        of the point of the curve; None for the highest peak of the first response. The file contains the frequency of
        the point that is next to it.

    Raises
    ------
    InputError
        for a frequency that is not on the curve, results without positions of the pairs, another suffix, or a file that
        cannot be written.
    """
    if study.pair_point is None:
        raise InputError(NO_POSITIONS)
    output = study.outputs[study.response_output]
    if frequency_hz is None:
        point = summary(response, output).peak.point
    else:
        point = point_at_frequency(response, output, frequency_hz)
    return write_points(Path(path), study.pair_point, contact_fields(response, study, point))
