"""The resonance of a mass on one contact, and the solver that is asked where its curve is lost."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from stickslip.solve import forced
from stickslip.solve.evidence import Settling


def resonance(settings: ss.ContinuationSettings, newtons: float = 10.0, **options: Any) -> ss.ForcedResponse:
    """A mass on springs and one contact that slips at the peak."""
    force = np.array([newtons, 0.0, 0.0])
    return ss.forced_response(
        ss.Superelement(np.eye(3), 4e6 * np.eye(3)),
        ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 2000.0),
        force,
        frequency_hz=(340.0, 370.0),
        samples=64,
        continuation=settings,
        **({"harmonics": 1, "modal_damping_ratio": 1e-3} | options),
    )


def lost_resonance() -> Settling:
    """The solver that a curve of the resonance would ask where it is lost."""
    found: list[Settling] = []

    class Known(Settling):
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            found.append(self)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(forced, "Settling", Known)
        resonance(ss.ContinuationSettings())
    return found[0]
