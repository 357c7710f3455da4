"""A coarse two-blade case whose every curve takes about half a second, for the tests of sweeps."""

from __future__ import annotations

from pathlib import Path

from rough_casting import ROUGH_CASTING
from stickslip.case.case import Case

COARSE_MESH = {
    "mesh.shank_columns": 1,
    "mesh.shank_rows": 4,
    "mesh.platform_rows": 2,
    "mesh.airfoil_rows": 6,
    "mesh.inner_columns": 1,
    "mesh.contact_columns": 2,
    "mesh.chordwise": 4,
    "mesh.damper_columns": 2,
    "mesh.damper_flank_rows": 1,
}
QUICK = {
    **ROUGH_CASTING,
    **COARSE_MESH,
    "reduction.modes": 8,
    "geometry.excitation_height": "9 mm",
    "excitation.amplitude": "50 N",
    "solver.frequency_start": "440 Hz",
    "solver.frequency_stop": "480 Hz",
    "solver.largest_step": 0.15,
    "solver.harmonics": 1,
    "solver.samples": 128,
    "output.figure_formats": [],  # to draw takes longer than the curve
    "analysis.performance_curve": False,  # so does this
}


def quick_case() -> Case:
    """The coarse case; its first resonance with stuck contact lies inside the range."""
    return Case().replace(QUICK)


def quick_file(folder: Path, **solver: object) -> Path:
    """The same as a study file; ``solver`` replaces keys of that section."""
    path = folder / "study.toml"
    changes = {f"solver.{key}": value for key, value in solver.items()}
    path.write_text(quick_case().replace(changes).to_text(), encoding="utf-8")
    return path
