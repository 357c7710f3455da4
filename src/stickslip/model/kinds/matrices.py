"""The study of kind "matrices": a superelement or sparse matrices of another program, joints between its nodes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stickslip.case.case import MatrixCase
from stickslip.case.interface_sections import GROUND, PairsInterfaceSection, SetInterfaceSection
from stickslip.case.own_sections import PlaceSection, SuperelementSection
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.pairing.local_axes import local_tangents, map_position
from stickslip.core.errors import ImportFileError, InputError, concerning, keys_of_section
from stickslip.core.input_files import read_input
from stickslip.core.plausible import OddValue, suspecting
from stickslip.core.validation import FloatArray
from stickslip.formats.matrices.exchange import boundary_unknowns, read_superelement
from stickslip.formats.matrices.model import MatrixModel
from stickslip.formats.matrices.read import read_matrices
from stickslip.formats.matrices.reduce import reduce_matrices
from stickslip.formats.matrices.source import quoted
from stickslip.model.kinds.own import OwnKind
from stickslip.model.layout import Layout, NodeGroup
from stickslip.model.nearest import nearest_node
from stickslip.model.overlap import require_single_pairs
from stickslip.model.rough_face import case_material
from stickslip.structure.elasticity import Material
from stickslip.structure.floating_parts import require_contact_bodies
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.model_facts import material_oddities, matrix_oddities
from stickslip.structure.superelement import Superelement

_COINCIDENT = 1e-6  # m between the nodes of a pair, unless search_distance is larger
_NODE_NUMBER = re.compile(r"-?\d{1,18}", flags=re.ASCII)
_MOST_BYTES = 100_000_000  # of a file of pairs
_MAP_STEP = 1e-3  # m between pairs on a map, if the matrices have no positions


@dataclass(frozen=True)
class _NodeTable:
    """Nodes of matrices that have x, y and z: numbers (k,), positions (k, 3) m or None, and named sets."""

    labels: IntArray
    positions: FloatArray | None
    node_sets: Mapping[str, IntArray]

    @classmethod
    def of(cls, matrices: Superelement | MatrixModel) -> _NodeTable:
        """The nodes of matrices."""
        if isinstance(matrices, Superelement):
            return cls(matrices.boundary_nodes, matrices.positions, matrices.node_sets)
        nodes, _ = boundary_unknowns(matrices)
        return cls(nodes, matrices.positions_of(nodes), matrices.node_sets)


@dataclass(frozen=True)
class MatrixSetup:
    """Matrices with node and direction of their unknowns, and the number of modes of a reduction."""

    matrices: Superelement | MatrixModel
    layout: Layout
    n_modes: int

    def assemble(self) -> Superelement:
        """A superelement as it is; sparse matrices reduced to the nodes of the layout and some modes.

        Raises InputError where the stiffness is singular and rigid bodies with contact do not explain it.
        """
        contact = self.layout.face_pairs.nodes
        if isinstance(self.matrices, Superelement):
            with concerning("structure.file"):
                require_contact_bodies(self.matrices, contact)
            return self.matrices
        nodes = self._retained_nodes
        with concerning("structure.stiffness"), keys_of_section("reduction", {"n_modes": "modes"}):
            return reduce_matrices(self.matrices, nodes, self.n_modes, contact_nodes=contact)

    @property
    def _retained_nodes(self) -> IntArray:
        places = [node_group.nodes for node_group in self.layout.node_groups.values()]
        return np.unique(np.concatenate([self.layout.face_pairs.nodes, *places]))

    def most_unknowns(self, n_modes: int) -> int:
        """All unknowns of a superelement; else those of the nodes and modes that the reduction retains."""
        if isinstance(self.matrices, Superelement):
            return self.matrices.size
        return 3 * self._retained_nodes.size + self.n_modes

    def sizes(self) -> tuple[tuple[str, str], ...]:
        """Nodes with three displacements, other unknowns, mass, named sets."""
        matrices, lookup = self.matrices, _NodeTable.of(self.matrices)
        nodes = lookup.labels.size
        sets = ", ".join(f"{name} ({members.size})" for name, members in lookup.node_sets.items())
        return (
            ("nodes with x, y, z", f"{nodes}"),
            ("other unknowns", f"{matrices.size - 3 * nodes}"),
            ("mass for a common motion along x", f"{_mass_along_x(matrices):.4g} kg"),
            ("node sets", sets or "none"),
        )

    def write_places(self, folder: Path) -> tuple[Path, ...]:
        """Nothing: there is no mesh."""
        return ()


class MatrixKind(OwnKind[MatrixCase]):
    """Matrices of another program. Their support cannot move, because they do not contain the mass of its nodes."""

    def set_up(self, case: MatrixCase) -> MatrixSetup:
        """Read the matrices, pair their nodes, and locate forces and responses.

        Raises ImportFileError for a file; InputError that names the wrong entry of the study file.
        """
        matrices = _read(case)
        if matrices.damping is not None and case.damping.modal_damping_ratio is not None:
            raise InputError(
                f"damping.modal_damping_ratio = {case.damping.modal_damping_ratio:g} cannot be added to the damping "
                "in the matrix files. Set damping.rayleigh_alpha = 0 to use only that of the files, or remove it from "
                "the files.",
                ("damping.modal_damping_ratio",),
            )
        lookup, pairs, messages = _NodeTable.of(matrices), [], []
        if not lookup.labels.size:
            raise InputError(
                "structure.unknown_map: no node of the matrices has unknowns along x, y and z, so no node can be "
                "selected. Give a file with the node and direction of each row.",
                ("structure.unknown_map",),
            )
        odd_values = _odd_values(case, matrices, lookup)
        with suspecting(odd_values):
            for name, section in case.interfaces.items():
                face_pairs, words = _pairs(lookup, name, section)
                pairs.append(face_pairs)
                messages += words
            node_groups = {name: _node_group(lookup, name, section) for name, section in case.places.items()}
        materials = _face_materials(case)
        joined = FacePairs.concatenate(pairs)
        require_single_pairs(tuple(case.interfaces), joined)
        layout = Layout(
            joined,
            tuple(case.interfaces),
            materials,
            node_groups,
            messages=(*getattr(matrices, "messages", ()), *messages),
            odd_values=odd_values,
        )
        return MatrixSetup(matrices, layout, case.reduction.modes)

    def find_layout(self, case: MatrixCase, mesh: Mesh) -> Layout:
        """The layout of :func:`set_up`; matrices have no mesh."""
        return self.set_up(case).layout


def _read(case: MatrixCase) -> Superelement | MatrixModel:
    """The matrices of the files. Raises ImportFileError, and InputError for an unknown unit."""
    section = case.structure
    if isinstance(section, SuperelementSection):
        with concerning("structure.file"):
            return read_superelement(section.file)
    with keys_of_section("structure"):
        return read_matrices(
            section.stiffness,
            section.mass,
            section.damping,
            section.unknown_map,
            section.node_positions,
            length_unit=section.length_unit,
            unit_system=section.unit_system,
        )


def _displacements(matrices: Superelement | MatrixModel, axis: int | None = None) -> IntArray:
    """Positions of the unknowns along an axis (0, 1, 2) at a node, or along any."""
    if isinstance(matrices, Superelement):
        rows = np.arange(3 * matrices.boundary_nodes.size)
        return rows if axis is None else rows[axis::3]
    return np.flatnonzero(matrices.direction < 3 if axis is None else matrices.direction == axis)


def _mass_along_x(matrices: Superelement | MatrixModel) -> float:
    """kg that move when all nodes move along x."""
    along_x = np.zeros(matrices.size)
    along_x[_displacements(matrices, 0)] = 1.0
    return float(along_x @ (matrices.mass @ along_x))


def _odd_values(case: MatrixCase, matrices: Superelement | MatrixModel, lookup: _NodeTable) -> tuple[OddValue, ...]:
    """Values of the matrices, and of the material of the rough faces, that only wrong units explain."""
    rows = _displacements(matrices)
    stiffness, mass = (np.asarray(each.diagonal())[rows] for each in (matrices.stiffness, matrices.mass))
    of_matrices = matrix_oddities(stiffness, mass, _mass_along_x(matrices), lookup.positions)
    if case.material is None:
        return tuple(of_matrices)
    return (*of_matrices, *material_oddities("the material", case_material(case), "its unit", "material"))


def _face_materials(case: MatrixCase) -> tuple[tuple[Material, Material], ...]:
    """The material of [material] on both sides; only the roughness needs it, so faces with stiffness have none."""
    material = case_material(case) if case.rough_interfaces or case.material is not None else Material()
    return ((material, material),) * len(case.interfaces)


def _nodes(lookup: _NodeTable, entry: str, name: str) -> IntArray:
    """Nodes of a set. Raises InputError that names the entry."""
    if name not in lookup.node_sets:
        names = ", ".join(lookup.node_sets) or "none"
        raise InputError(f"{entry}: the matrices have no node set '{name}'; they have: {names}.", [entry])
    nodes = np.asarray(lookup.node_sets[name], dtype=np.int64)
    if not nodes.size:
        raise InputError(f"{entry}: node set '{name}' is empty. Add nodes to it, or use another set.", [entry])
    return nodes


def _pairs(
    lookup: _NodeTable, name: str, section: SetInterfaceSection | PairsInterfaceSection
) -> tuple[FacePairs, list[str]]:
    """Node-to-node pairs of an interface, or pairs of nodes and the ground; messages on assumptions."""
    entry = f"interfaces.{name}"
    messages: list[str] = []
    first, second = _sides(lookup, entry, section)
    count = first.size
    weight = np.full((count, 1), 0.0 if second is None else 1.0)
    second = first if second is None else second
    normal = np.tile(section.normal, (count, 1))
    area = np.full(count, section.area / count)
    places = _places(lookup, first)
    points = np.zeros((count, 3)) if places is None else places
    with concerning(f"{entry}.tangent"):
        tangent1, tangent2 = local_tangents(points, normal, area, section.tangent)
    if places is None:
        position = np.column_stack([np.zeros(count), _MAP_STEP * np.arange(count)])
        messages.append(
            f"{entry}: the matrices contain no node positions, so maps show the pairs in a row in their order."
        )
        if isinstance(section, SetInterfaceSection) and section.second != GROUND:
            messages.append(f"{entry}: its nodes are paired in the order of the two sets, without positions.")
    else:
        position = map_position(points, tangent1, tangent2, area)
    gap = np.full(count, section.gap or 0.0)
    pairs = FacePairs(
        first[:, None], np.ones((count, 1)), second[:, None], weight, gap, points, area, normal,
        tangent1, tangent2, np.zeros(count, dtype=np.int64), position,
    )  # fmt: skip
    return pairs, messages


def _sides(
    lookup: _NodeTable, entry: str, joint: SetInterfaceSection | PairsInterfaceSection
) -> tuple[IntArray, IntArray | None]:
    """First and second node of each pair, from a file or from sets; None for the ground."""
    if isinstance(joint, PairsInterfaceSection):
        with concerning(f"{entry}.pairs"):
            return _listed_pairs(lookup, entry, Path(joint.pairs))
    first = _nodes(lookup, f"{entry}.first", joint.first)
    if joint.second == GROUND:
        return first, None
    others = _nodes(lookup, f"{entry}.second", joint.second)
    return first, _partners(lookup, entry, joint, first, others)


def _listed_pairs(lookup: _NodeTable, entry: str, path: Path) -> tuple[IntArray, IntArray | None]:
    """Pairs of a text file: two node numbers a line, or one for the ground. Raises ImportFileError with the line."""
    try:
        lines = read_input(path, "Give a text file with pairs of nodes.", _MOST_BYTES).decode("utf-8-sig").splitlines()
    except InputError as error:
        raise ImportFileError(f"{entry}.pairs: {error}") from error
    except UnicodeDecodeError as error:
        raise ImportFileError(f"{entry}.pairs: {path} is not a text file in UTF-8. Give one.") from error
    rows: list[list[int]] = []
    for number, line in enumerate(lines, start=1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        where = f"{entry}.pairs: {path}, line {number}:"
        if not all(map(_NODE_NUMBER.fullmatch, words)) or len(words) != len(rows[0] if rows else words):
            raise ImportFileError(
                f"{where} {quoted(line)} must be two node numbers, or one in each line for the ground."
            )
        rows.append([int(word) for word in words])
        missing = np.setdiff1d(rows[-1], lookup.labels)
        if len(words) > 2 or missing.size:
            what = (
                f"the matrices have no node {missing[0]} with x, y and z" if missing.size else "more than two numbers"
            )
            raise ImportFileError(f"{where} {what}.")
    if not rows:
        raise ImportFileError(f"{entry}.pairs: {path} contains no pair. Write two node numbers on each line.")
    table = np.array(rows, dtype=np.int64)
    different, count = np.unique(table, axis=0, return_counts=True)
    if count.max() > 1:
        twice = ", ".join(map(str, different[count.argmax()]))
        raise ImportFileError(
            f"{entry}.pairs: {path} has the pair {twice} in {count.max()} lines. Name each pair once."
        )
    return table[:, 0], table[:, 1] if table.shape[1] == 2 else None


def _places(lookup: _NodeTable, nodes: IntArray) -> FloatArray | None:
    """(k, 3) m of nodes, None without positions."""
    if lookup.positions is None:
        return None
    order = np.argsort(lookup.labels)
    positions = order[np.searchsorted(lookup.labels, nodes, sorter=order)]
    return np.asarray(lookup.positions)[positions]


def _partners(
    lookup: _NodeTable, entry: str, joint: SetInterfaceSection, first: IntArray, others: IntArray
) -> IntArray:
    """The partner of each first node: the node at its position, or, without positions, the one at its index in the set.

    Raises InputError for sets of different size, and for a node without a partner within the distance.
    """
    if first.size != others.size:
        raise InputError(
            f"{entry}: '{joint.first}' has {first.size} nodes and '{joint.second}' has {others.size}; each node "
            "requires one partner. Use sets of equal size.",
            (f"{entry}.first", f"{entry}.second"),
        )
    places, opposite = _places(lookup, first), _places(lookup, others)
    if places is None or opposite is None:
        return others  # _pairs reports that they are paired by their order
    distance = np.linalg.norm(places[:, None] - opposite[None], axis=2)
    nearest = distance.argmin(axis=1)
    reach = joint.search_distance or _COINCIDENT
    smallest = distance[np.arange(first.size), nearest]
    if smallest.max() > reach or np.unique(nearest).size != nearest.size:
        worst = int(smallest.argmax())
        raise InputError(
            f"{entry}: node {first[worst]} of '{joint.first}' is {1e3 * smallest[worst]:.4g} mm from the nearest node "
            f"of '{joint.second}' ({1e3 * reach:.4g} mm are allowed), or two nodes have the same partner. Check the "
            "sets, or raise search_distance.",
            (f"{entry}.first", f"{entry}.second"),
        )
    return np.asarray(others[nearest])


def _node_group(lookup: _NodeTable, name: str, section: PlaceSection) -> NodeGroup:
    """The nodes of a place. Raises InputError that names the entry."""
    if section.set is not None:
        return NodeGroup.equal(_nodes(lookup, f"{name}.set", section.set))
    if section.node is not None:
        if section.node not in lookup.labels:
            raise InputError(
                f"{name}.node: the matrices have no node {section.node} with x, y and z among their "
                f"{lookup.labels.size} such nodes.",
                (f"{name}.node",),
            )
        return NodeGroup.single(section.node)
    with concerning(f"{name}.point"):
        return _nearest(lookup, name, np.array(section.point))


def _nearest(lookup: _NodeTable, name: str, point: FloatArray) -> NodeGroup:
    """The node nearest to a point. Raises InputError without positions, and if the node is far or ambiguous."""
    if lookup.positions is None:
        raise InputError(f"{name}.point: the matrices contain no node positions. Give node or set.")
    try:
        return NodeGroup.single(int(lookup.labels[nearest_node(lookup.positions, point)]))
    except InputError as error:
        raise error.reworded(f"{name}.point: {error}") from error
