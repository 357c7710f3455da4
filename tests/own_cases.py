"""The example of an own mesh as a case that solves in seconds, and the same structure as matrices."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from stickslip.case import Case, load_case
from stickslip.model import build_model, load_joint, set_up
from stickslip.structure.matrix_files.exchange import write_superelement

EXAMPLE = Path(__file__).parents[1] / "examples" / "own_mesh"
QUICK = {"solver.harmonics": 1, "solver.samples": 64, "output.figure_formats": []}


def mesh_case(**changes: Any) -> Case:
    """The example with few harmonics; changes as ``section__key`` or ``section__name__key``."""
    return load_case(EXAMPLE / "study.toml").replace(
        QUICK | {key.replace("__", "."): value for key, value in changes.items()}
    )


def write_matrices(folder: Path, case: Case) -> Path:
    """The reduced structure of a mesh case as a superelement file, with the sets that its study needs."""
    setup = set_up(case)
    model = build_model(case, setup.assemble(), load_joint(case, setup.layout))
    reduced, mesh = model.superelement, setup.mesh
    sets = {"lid": mesh.node_set("damper_top")}
    whole = replace(reduced, recovery=None, positions=mesh.points[reduced.boundary_nodes], node_sets=sets)
    return write_superelement(folder / "superelement.npz", whole)
