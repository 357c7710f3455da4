"""Output files of a run, and checks before the solution that they can be written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.core.files import require_disk_space, require_folder
from stickslip.model.kinds.mesh import PAIRS_FILE
from stickslip.model.model import Model

if TYPE_CHECKING:
    from stickslip.case.case import Case

CASES_FOLDER = "cases"  # of a sweep
RESULTS_FILE = "results.nc"
REPORT_FILE = "report.html"
FIGURE_FOLDER = "figures"
MODES_FILE = "mode_shapes.vtu"
STRESS_FILE = "stress.vtu"
CONTACT_FILE = "contact_at_peak.vtu"
FRD_FILE = "peak.frd"
PERIOD_FILE = "deflected_shape.pvd"
PERIOD_FOLDER = "deflected_shape_frames"

# Measured on the two-blade study and on meshes of 1,000 to 50,000 nodes.
REPORT_BYTES = 11_000_000  # plotly.js and the data of the page
FIGURES_BYTES = 1_500_000
_BYTES_OF_NODE = 45  # in one field of a compressed file for ParaView
_FRD_BYTES = 280  # of a node in one step of peak.frd: four lines with 50 or 86 letters
_STRESS_FIELDS = 4  # scalar fields take a third of a vector field
_POINTS = 200  # of a curve; the linear limits have about as many of two coefficients each
_HARMONICS = 24  # with an accuracy: more than curves usually require
_BYTES = 8  # of a number; those of a curve can hardly be compressed


def require_places(out: Path) -> None:
    """Make the folder of a run. Raises OutputError if its files cannot be written or the disk is nearly full."""
    require_folder(
        out,
        files=(RESULTS_FILE, REPORT_FILE, MODES_FILE, STRESS_FILE, CONTACT_FILE, FRD_FILE, PERIOD_FILE, PAIRS_FILE),
        folders=(FIGURE_FOLDER, PERIOD_FOLDER),
    )
    require_disk_space(out, REPORT_BYTES, REPORT_BYTES)


def require_space_for(case: Case, model: Model, out: Path) -> None:
    """Raise OutputError unless the disk has space for the estimated size of all files of a run of this model."""
    coefficients = 2 * (case.solver.harmonics or _HARMONICS) + 1
    results = _BYTES * _POINTS * model.pairs.operator.shape[1] * coefficients
    fields = case.output.mode_shapes + case.output.deflected_shape_frames
    fields += _STRESS_FIELDS if case.output.stress else 0
    mesh = model.in_study.mesh
    nodes = 0 if mesh is None else mesh.n_nodes
    frd = _FRD_BYTES * nodes * (1 + coefficients // 2) if case.output.frd else 0
    whole = frd + results + REPORT_BYTES + FIGURES_BYTES + _BYTES_OF_NODE * fields * nodes
    require_disk_space(out, whole, max(results, REPORT_BYTES))
