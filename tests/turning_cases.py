"""Studies with [rotation]: a cantilever of a mesh, and a sector of a disk."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np

from model_writers import write_inp
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.structure.mesh import Mesh
from structure_fixtures import brick_block

TURN: dict[str, Any] = {"axis": [0, 0, 1], "point": ["-100 mm", "5 mm", "4 mm"]}


def beam_case(folder: Path, **rotation: Any) -> Case:
    """A cantilever of 300 x 20 x 10 mm, which turns at its clamped end, with a pad on the ground below its tip."""
    block: Any = brick_block((20, 1, 1), (0.3, 0.02, 0.01))
    below = block.points[:, 2] < 1e-9
    sets = {
        "root": np.flatnonzero(block.points[:, 0] < 1e-9),
        "pad": np.flatnonzero(below & (block.points[:, 0] > 0.28)),
        "tip": np.flatnonzero(block.points[:, 0] > 0.2999)[:1],
    }
    mesh = Mesh(block.points, block.cells, node_sets=sets)
    write_inp(folder / "beam.inp", mesh, ["beam"], ["pad"], "root")
    return Case.from_mapping(
        {
            "structure": {"kind": "mesh", "file": str(folder / "beam.inp"), "length_unit": "mm"},
            "interfaces": {
                "pad": {
                    "first": "pad", "second": "ground", "normal_load": "10 N",
                    "normal_stiffness": "1e6 N/m", "tangential_stiffness": "1e6 N/m",
                }
            },
            "forces": {"shaker": {"set": "tip", "direction": [0, 0, 1], "amplitude": "1 N"}},
            "responses": {"tip": {"set": "tip", "direction": [0, 0, 1]}},
            "damping": {"modal_damping_ratio": 0.001},
            "solver": {"frequency_start": "50 Hz", "frequency_stop": "200 Hz"},
            "reduction": {"modes": 10},
            **({"rotation": {**TURN, **rotation}} if rotation else {}),
        }
    )  # fmt: skip


def disk_case(**rotation: Any) -> Case:
    content = copy.deepcopy(EXAMPLES["bladed-disk"])
    content["structure"] = {"kind": "cyclic", "contact_columns": 2, "contact_rows": 1, "sectors": 20}
    content["reduction"] = {"modes": 8}
    return Case.from_mapping({**content, **({"rotation": rotation} if rotation else {})})
