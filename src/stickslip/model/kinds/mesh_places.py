"""The places of forces and responses of a study of a mesh: groups of its nodes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stickslip.case.case import MeshCase, SolidCase
from stickslip.case.own_sections import PlaceSection
from stickslip.contact.pairing.pairing_result import Pairing
from stickslip.core.errors import InputError, concerning
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.model.kinds.entry import named_entry
from stickslip.model.kinds.ties import StudyTies, following_group, reference_group
from stickslip.model.layout import NodeGroup
from stickslip.model.nearest import nearest_node
from stickslip.structure.constraints import Constraints
from stickslip.structure.faces import face_geometry
from stickslip.structure.mesh import IntArray


def node_groups_of(case: SolidCase, source: ImportedModel) -> dict[str, NodeGroup]:
    """The groups of all places but those of reference nodes."""
    return {
        name: node_group_of(source, name, section)
        for name, section in case.places.items()
        if not _is_reference(source, section)
    }


def _is_reference(source: ImportedModel, section: PlaceSection) -> bool:
    return source.equations is not None and _reference_label(source, section) in source.equations.places


def _reference_label(source: ImportedModel, section: PlaceSection) -> int | None:
    """The number of the node of a place, if it is given by number or by a set of one reference node."""
    if section.set is not None and section.spread != "area":
        return source.reference_sets.get(section.set)
    return section.node


def following_groups(
    case: MeshCase,
    source: ImportedModel,
    groups: Mapping[str, NodeGroup],
    ties: StudyTies | None,
    constraints: Constraints | None,
) -> dict[str, NodeGroup]:
    """The groups of reference nodes, and of single nodes that follow others. Raises InputError that names the entry."""
    answer: dict[str, NodeGroup] = {}
    if ties is None or constraints is None:
        return answer
    for name, section in case.places.items():
        if name in groups:
            answer[name] = following_group(groups[name], source.mesh, constraints)
            continue
        with named_entry(name), concerning(f"{name}.{'node' if section.set is None else 'set'}"):
            label = _reference_label(source, section)
            answer[name] = reference_group(int(label or 0), ties.equations, constraints)
    return answer


def node_group_of(source: ImportedModel, name: str, section: PlaceSection) -> NodeGroup:
    """The nodes of a place with their weights. Raises InputError that names the entry."""
    mesh = source.mesh
    with named_entry(name):
        if section.node is not None:
            with concerning(f"{name}.node"):
                return NodeGroup.single(int(source.node_numbers(np.array([section.node]))[0]))
        if section.set is not None:
            with concerning(f"{name}.set"):
                if section.spread == "area":
                    nodes, area, _ = face_geometry(mesh, section.set)
                    return NodeGroup(nodes, area / area.sum())
                return NodeGroup.equal(mesh.node_set(section.set))
        with concerning(f"{name}.point"):
            return NodeGroup.single(nearest_node(mesh.points, np.array(section.point)))


def require_free(
    pairings: Mapping[str, Pairing], node_groups: Mapping[str, NodeGroup], fixed: IntArray, source: ImportedModel
) -> None:
    """Raise InputError for a contact pair, a force or a response on a constrained node."""
    constrained = np.unique(fixed // 3)
    for name, pairing in pairings.items():
        wrong = np.intersect1d(pairing.pairs.nodes, constrained)
        if wrong.size:
            raise InputError(
                f"interfaces.{name}: node {source.shown(source.node_labels[wrong[0]])} of the file is in a "
                f"constraint and in a contact pair ({wrong.size} nodes are). Remove these nodes from the "
                "faces or from the constraint.",
                (f"interfaces.{name}",),
            )
    for name, node_group in node_groups.items():
        here = np.isin(node_group.nodes, constrained)
        if node_group.blocks is None and (here.all() or (node_group.is_single and here.any())):
            raise InputError(f"{name}: its nodes are constrained and cannot move. Choose another position.", [name])
