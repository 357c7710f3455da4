"""A study before the reduction of its structure."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.case.case import Case
from stickslip.case.key_ranges import ridge_of_study
from stickslip.model.joint import Joint
from stickslip.model.layout import AnyStructure, Setup
from stickslip.model.model import load_joint, set_up
from stickslip.study.mode import require_mode, require_possible_mode
from stickslip.study.ridge import require_joints


@dataclass(frozen=True)
class Assembled:
    """Layout, joint and matrices of a case."""

    setup: Setup
    joint: Joint
    structure: AnyStructure

    @classmethod
    def of(cls, case: Case) -> Assembled:
        """Raises InputError for a wrong geometry, a mode that does not exist, or a key or range of a ridge that cannot
        be used, RoughnessError for a contact without stiffness; each before the next longer step."""
        ridge = ridge_of_study(case)
        setup = set_up(case)
        require_possible_mode(case, setup)
        joint = load_joint(case, setup.layout)
        if ridge is not None:
            require_joints(*ridge, setup.layout)
        structure = setup.assemble()
        require_mode(case, structure, joint)
        return cls(setup, joint, structure)
