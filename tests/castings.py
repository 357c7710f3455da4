"""The two blades with the faces and the excitation that were the default before: a casting with Sq 54 um.

Tests with numbers of that case, and tests that need a soft joint or its quick curves, name them here.
"""

from __future__ import annotations

from typing import Any

from stickslip.case.case import Case

ROUGH_CASTING: dict[str, Any] = {
    "roughness.law": "fractal",
    "roughness.mode": "consistent",
    "roughness.fractal_dimension": 2.4,
    "roughness.fractal_roughness": "1e-8 m",
    "roughness.sample_length": "28 mm",
    "excitation.mode": "single",
    "solver.frequency_stop": "530 Hz",
    "analysis.stiffness_band": False,
}


def casting_case() -> Case:
    """The two blades with rough faces of a casting, whose stiffness the fractal law gives."""
    return Case().replace(ROUGH_CASTING)
