"""The full structure of a case where a task runs: its mesh, matrices and recovery, for stress and gradients.

They are too large to send with each task, so each process makes its own and uses it again. The reduction itself is read
from the disk.
"""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.case.case import Case
from stickslip.model.joint import Joint
from stickslip.model.layout import AnyStructure, Setup
from stickslip.model.model import Model, connect, kind_of, reduce_structure, set_up
from stickslip.model.study_structure import ReducedStructure

_STORED_STRUCTURES = 2  # chosen: of a process; the joint alone changes between most cases, or the structure each time
_structures: dict[str, FullStructure] = {}


@dataclass(frozen=True, eq=False)
class FullStructure:
    """A structure before and after its reduction, with its recovery."""

    setup: Setup
    structure: AnyStructure
    reduced: ReducedStructure

    def model(self, case: Case, joint: Joint) -> Model:
        """The model of a case with this structure."""
        return Model(**vars(connect(case, self.reduced, joint)), structure=self.structure)


def full_structure(key: str, case: Case, threads: int) -> FullStructure:
    """The full structure of a case, whose inputs have the hash ``key``; those of the last cases of this process are
    used again. Raises InputError."""
    # A structure at a speed has the stress and the gradients of this speed, also where a reduction is valid for others.
    key = f"{key} {kind_of(case).rotation_speed(case)}"
    if key not in _structures:
        setup = set_up(case)
        structure = setup.assemble()
        while len(_structures) >= _STORED_STRUCTURES:
            del _structures[next(iter(_structures))]
        _structures[key] = FullStructure(setup, structure, reduce_structure(case, structure, setup.layout, threads))
    return _structures[key]
