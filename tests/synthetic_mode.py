"""A response with a nonlinear mode that nothing computed, for the tests of pages."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response


def with_mode(highest_ratio: float) -> ForcedResponse:
    """The curve, and a mode whose motions are those of the curve."""
    response = synthetic_response(columns=4, rows=3, n_points=20)
    count = response.n_points
    mode = NonlinearMode(
        modal_amplitude=np.geomspace(1e-7, 1e-4, count),
        damping_ratio=np.linspace(0.001, highest_ratio, count),
        stuck_frequency_hz=np.array([420.0, 500.0]),
        stuck_mac=np.tile([0.1, 0.9], (count, 1)),
        sliding_frequency_hz=np.array([410.0]),
        sliding_mac=np.ones((count, 1)),
        step_mac=np.ones(count),
        mode=2,
        limit="stuck",
        warnings=("A warning of the mode.",),
        converged=True,
        **{
            name: getattr(response, name)
            for name in (
                "frequency_hz", "displacement", "contact_state", "dissipated_energy", "normal_work", "closure",
                "residual", "iterations", "input_energy", "viscous_energy", "message", "harmonics", "samples", "pairs",
                "settings", "provenance",
            )
        },
    )  # fmt: skip
    return replace(response, nonlinear_mode=mode)
