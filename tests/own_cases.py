"""The example of an own mesh as a case that solves in seconds, and the same structure as matrices."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from castings import ROUGH_CASTING
from stickslip.case.case import Case
from stickslip.case.load import load_case
from stickslip.formats.matrices.exchange import write_superelement
from stickslip.model.model import build_model, load_joint, set_up

EXAMPLE = Path(__file__).parents[1] / "examples" / "own_mesh"
# Numbers of the tests are those of rough castings, and of the beam pushed towards the block.
QUICK = {
    **{key: value for key, value in ROUGH_CASTING.items() if key.startswith(("roughness.", "analysis."))},
    "forces.push.direction": (0.0, 0.0, 1.0),
    "forces.push.amplitude": 0.2,
    "responses.tip.direction": (0.0, 0.0, 1.0),
    "responses.block.direction": (1.0, 0.0, 0.0),
    "solver.frequency_start": 1600.0,
    "solver.frequency_stop": 2000.0,
    "solver.accuracy": None,
    "solver.harmonics": 1,
    "solver.samples": 64,
    "output.figure_formats": [],
}
# A window in which nothing slips, for tests of what comes before or after the curve.
BELOW_THE_PEAK = {"solver.frequency_stop": "1700 Hz"}


def mesh_case(**changes: Any) -> Case:
    """The example with few harmonics; changes as ``section__key`` or ``section__name__key``."""
    return load_case(EXAMPLE / "study.toml").replace(
        QUICK | {key.replace("__", "."): value for key, value in changes.items()}
    )


def parts_deck(folder: Path) -> Path:
    """The deck of the example as Abaqus writes it with parts: body, sets and faces have names with a dot."""
    lines = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8").splitlines()
    starts = [at for at, line in enumerate(lines) if line.startswith("*")] + [len(lines)]
    cards = [lines[start:stop] for start, stop in pairwise(starts)]

    def of(words: str) -> list[str]:
        return [line for card in cards if card[0].startswith(words) for line in card]

    sets = [*of("*NSET, NSET=root"), *of("*SURFACE, NAME=beam_top"), *of("*SURFACE, NAME=tip")]
    loose = [*of("*SURFACE, NAME=damper_bottom"), *of("*SURFACE, NAME=damper_top")]
    nodes = of("*NODE")
    used = {int(word) for line in of("*ELEMENT, TYPE=C3D8I, ELSET=damper")[1:] for word in line.split(",") if word}
    split = next(at for at, line in enumerate(nodes[1:], start=1) if int(line.split(",")[0]) in used - set(range(118)))
    beam = [*nodes[:split], *of("*ELEMENT, TYPE=C3D8I, ELSET=beam"), *sets]
    block = ["*NODE", *nodes[split:], *of("*ELEMENT, TYPE=C3D8I, ELSET=damper"), *loose]
    text = ["*PART, NAME=Beam", *beam, *of("*SOLID SECTION, ELSET=BEAM"), "*END PART"]
    text += ["*PART, NAME=Block", *block, *of("*SOLID SECTION, ELSET=DAMPER"), "*END PART", "*ASSEMBLY, NAME=Assembly"]
    text += ["*INSTANCE, NAME=Beam-1, PART=Beam", "*END INSTANCE", "*INSTANCE, NAME=Block.1, PART=Block"]
    text += ["*END INSTANCE", "*END ASSEMBLY", *of("*MATERIAL"), *of("*ELASTIC"), *of("*DENSITY")]
    target = folder / "parts.inp"
    target.write_text("\n".join([*text, "*BOUNDARY", "Beam-1.root, 1, 3", ""]), encoding="utf-8")
    return target


def write_matrices(folder: Path, case: Case) -> Path:
    """The reduced structure of a mesh case as a superelement file, with the sets that its study needs."""
    setup = set_up(case)
    model = build_model(case, setup.assemble(), load_joint(case, setup.layout))
    reduced, mesh = model.superelement, setup.mesh  # type: ignore[attr-defined]
    sets = {"lid": mesh.node_set("damper_top")}
    whole = replace(reduced, recovery=None, positions=mesh.points[reduced.boundary_nodes], node_sets=sets)
    return write_superelement(folder / "superelement.npz", whole)


# A study of kind "matrices".
MATRIX_STUDY = """\
[structure]
kind = "matrices"
file = "superelement.npz"
[interfaces.lid]
first = "lid"
second = "ground"
normal = [0, 0, 1]
area = "160 mm^2"
normal_load = "40 N"
normal_stiffness = "2e7 N/m"
tangential_stiffness = "1.6e7 N/m"
[forces.push]
set = "lid"
direction = [1, 0, 0]
amplitude = "8 N"
[responses.block]
point = ["48 mm", "3.67 mm", "14 mm"]
direction = [1, 0, 0]
[solver]
frequency_start = "1 kHz"
frequency_stop = "9 kHz"
harmonics = 1
samples = 64
[output]
figure_formats = []
"""
