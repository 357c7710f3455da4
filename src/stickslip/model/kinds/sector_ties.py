"""Ties, rigid bodies and equations inside the sector of a disk: those of its file and of its study file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip.case.case import CyclicCase
from stickslip.contact.pairing.pairing_result import Pairing
from stickslip.core.errors import InputError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.model.kinds.mesh_places import node_groups_of
from stickslip.model.kinds.ties import eliminated, require_independent, study_ties
from stickslip.model.layout import Derived, NodeGroup
from stickslip.structure.constraints import Constraints
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.mesh import IntArray


@dataclass(frozen=True)
class TiedSector:
    """The equations of a sector and its places: ``groups`` of nodes that are all independent."""

    groups: Mapping[str, NodeGroup]
    constraints: Constraints | None
    facts: tuple[Derived, ...] = ()
    messages: tuple[str, ...] = ()


def tied_sector(
    case: CyclicCase, source: ImportedModel, symmetry: CyclicSymmetry, fixed: IntArray, pairings: Mapping[str, Pairing]
) -> TiedSector:
    """The ties of a sector, eliminated with its contact nodes retained.

    ``pairings`` are on the mesh of this sector and the next one. Raises InputError that names the entry of the study
    file for nodes of contact, forces and responses that follow others, and for reference nodes.
    """
    require_no_attachments(source)
    groups = node_groups_of(case, source)
    _require_nodes_of_the_mesh(case, groups)
    ties = study_ties(source.mesh, source.equations, case.ties)
    contact = {name: symmetry.own_nodes(each.pairs.nodes) for name, each in pairings.items()}
    constraints = eliminated(ties, fixed, contact, groups)
    require_independent(constraints, source, contact)
    if ties is None or constraints is None:
        return TiedSector(groups, None)
    follow = np.unique(constraints.dependent_unknowns // 3)
    for name, group in groups.items():
        wrong = np.intersect1d(group.nodes, follow)
        if wrong.size:
            raise InputError(
                f"{name}: node {source.shown(source.node_labels[wrong[0]])} of the mesh follows others by a tie, a "
                f"rigid body or an equation ({wrong.size} of its nodes do). On a sector, choose nodes that do not.",
                (name,),
            )
    return TiedSector(groups, constraints, ties.facts, ties.messages)


def require_no_attachments(source: ImportedModel) -> None:
    """Raise InputError for a file with mass points or springs."""
    if source.attachments is not None:
        raise InputError(
            f"{source.source} has mass points or springs, which a sector cannot have yet. Remove them, or add "
            "the mass to the density of a body.",
            ("structure.file",),
        )


def _require_nodes_of_the_mesh(case: CyclicCase, groups: Mapping[str, NodeGroup]) -> None:
    """Raise InputError for a force or response on a reference node."""
    for name in case.places:
        if name not in groups:
            raise InputError(
                f"{name} is at a reference node of a coupling or rigid body, which is not a place of a sector. Give "
                "nodes of its mesh.",
                (name,),
            )
