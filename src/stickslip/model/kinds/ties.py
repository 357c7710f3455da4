"""Ties of a study on a mesh: those of its file and of its study file, eliminated with the contact nodes retained."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip.case.own_sections import TieSection
from stickslip.core.errors import InputError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.model.layout import Derived, NodeGroup
from stickslip.structure.constraints import Constraints, eliminate
from stickslip.structure.equations import Equations
from stickslip.structure.face_ties import TiedNodes, add_tie, tie_nodes
from stickslip.structure.mesh import IntArray, Mesh


@dataclass(frozen=True)
class StudyTies:
    """Equations of a study before they are eliminated, the facts of each tie, and messages on nodes that stay free."""

    equations: Equations
    facts: tuple[Derived, ...] = ()
    messages: tuple[str, ...] = ()


def study_ties(mesh: Mesh, of_file: Equations | None, sections: Mapping[str, TieSection]) -> StudyTies | None:
    """The ties of the file and of the sections [ties.NAME]; None without any.

    Raises InputError that names the section for a face that does not exist or is too far away.
    """
    if of_file is None and not sections:
        return None
    equations = Equations(mesh.n_nodes) if of_file is None else of_file.copied()
    facts: list[Derived] = []
    messages = []
    for name, section in sections.items():
        tied = _tied(mesh, name, section)
        before = add_tie(equations, equations.owner(f"[ties.{name}]"), tied)
        words = f"the nodes of {section.dependent} follow {section.independent}"
        facts.append((f"Tied nodes, {name}", int(tied.nodes.size - before), "-", words))
        facts.append((f"Largest distance of a tied node, {name}", 1e3 * float(tied.distance.max()), "mm", words))
        if tied.untied.size or before:
            messages.append(f"ties.{name}: {tied.words(section.dependent, section.independent, before)}.")
    return StudyTies(equations, tuple(facts), tuple(messages))


def _tied(mesh: Mesh, name: str, section: TieSection) -> TiedNodes:
    """The tied nodes of one section."""
    key = f"ties.{name}"
    try:
        nodes, sides = mesh.node_set(section.dependent), mesh.sides(section.independent)
    except InputError as error:
        raise InputError(f"{key}: {error}", (key,)) from error
    tied = tie_nodes(mesh.points, nodes, sides, section.tolerance)
    if not tied.nodes.size:
        raise InputError(
            f"{key}: none of the {nodes.size} nodes of '{section.dependent}' is within {1e3 * tied.tolerance:.3g} mm "
            f"of '{section.independent}'. Give a larger tolerance, or check the two sets.",
            (key,),
        )
    return tied


def eliminated(
    ties: StudyTies | None, fixed: IntArray, contact: Mapping[str, IntArray], groups: Mapping[str, NodeGroup]
) -> Constraints | None:
    """The ties, where possible with the nodes of contact pairs, forces and responses as independent ones.

    ``contact`` are the nodes of each interface."""
    if ties is None:
        return None
    nodes = list(contact.values())
    nodes += [group.nodes for group in groups.values() if group.is_single]
    avoided = (3 * np.concatenate([np.empty(0, dtype=np.int64), *nodes])[:, None] + np.arange(3)).ravel()
    return eliminate(ties.equations, fixed, set(avoided.tolist()))


def require_independent(
    constraints: Constraints | None, source: ImportedModel, contact: Mapping[str, IntArray]
) -> None:
    """Raise InputError that names the interface for contact nodes that follow other nodes in any elimination.

    ``contact`` are the nodes of each interface."""
    if constraints is None:
        return
    dependent = constraints.dependent_unknowns
    for name, nodes in contact.items():
        wrong = np.intersect1d(nodes, dependent // 3)
        if wrong.size:
            leaders = np.unique(constraints.leaders(int(dependent[dependent // 3 == wrong[0]][0])) // 3)
            node, leader = (source.shown(source.node_labels[at]) for at in (wrong[0], leaders[0]))
            raise InputError(
                f"interfaces.{name}: node {node} of the file is in a contact pair and follows {leaders.size} other "
                f"nodes ({leader}, ...) by a tie, a rigid body or an equation ({wrong.size} nodes of this interface "
                "do). Remove these nodes from one of the two.",
                (f"interfaces.{name}",),
            )


def following_group(group: NodeGroup, mesh: Mesh, constraints: Constraints | None) -> NodeGroup:
    """The group of one node that follows others by the nodes that it follows; other groups as they are."""
    if constraints is None or not group.is_single:
        return group
    node = int(group.nodes[0])
    unknowns = 3 * node + np.arange(3)
    if not np.isin(unknowns, constraints.dependent_unknowns).any():
        return group
    return NodeGroup.following(constraints.rows(unknowns), mesh.points[node])


def reference_group(label: int, equations: Equations, constraints: Constraints) -> NodeGroup:
    """The group of a reference node of the file. Raises InputError where nothing of the mesh moves it."""
    keys = [(label, axis) for axis in range(3)]
    missing = [key for key in keys if key not in constraints.further]
    if missing:
        raise InputError(
            f"node {label} of the file is a reference node, but no tie, rigid body or coupling determines its "
            "displacement from nodes of solid elements. Give another node."
        )
    rows = constraints.reference[[constraints.further[key] for key in keys]]
    if not rows.nnz:
        raise InputError(f"node {label} of the file is a reference node that is constrained and cannot move.")
    return NodeGroup.following(rows, equations.places[label])
