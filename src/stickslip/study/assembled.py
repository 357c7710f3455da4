"""A study before the reduction of its structure."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.case.case import Case
from stickslip.model.joint import Joint
from stickslip.model.layout import AnyStructure, Setup
from stickslip.model.model import load_joint, set_up
from stickslip.study.mode import require_mode


@dataclass(frozen=True)
class Assembled:
    """Layout, joint and matrices of a case."""

    setup: Setup
    joint: Joint
    structure: AnyStructure

    @classmethod
    def of(cls, case: Case) -> Assembled:
        """Raises InputError for a wrong geometry or a mode that does not exist, RoughnessError for a contact without
        stiffness."""
        setup = set_up(case)
        joint = load_joint(case, setup.layout)
        structure = setup.assemble()
        require_mode(case, structure, joint)
        return cls(setup, joint, structure)
