"""From the entries of a model file to a mesh in metres, with a check of every entry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import scipy.spatial
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.build_materials import build_materials
from stickslip.formats.meshes.build_points import build_points
from stickslip.formats.meshes.build_ties import build_equations
from stickslip.formats.meshes.element_checks import require_sound_elements
from stickslip.formats.meshes.face_sets import build_face_sets
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.raw_contacts import GROUND, RawContact
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.unit_systems import UnitSystem
from stickslip.structure.cell_kinds import IntArray
from stickslip.structure.equations import Equations
from stickslip.structure.mesh import CellBlock, Mesh
from stickslip.structure.model_facts import connected_parts, model_oddities

LARGEST_COORDINATE = 1e6  # m
_ONE_PLACE = 1e-6  # fraction of a body's size below which two of its nodes coincide


def build_model(raw: RawModel, units: UnitSystem, temperature: float | None = None) -> ImportedModel:
    """Check a raw model and turn it into SI units, with material constants at a temperature of the file.

    Raises ImportFileError that names file and entry.
    """
    if not raw.blocks:
        others = ", ".join(f"{count} {name}" for name, count in raw.other_elements.items())
        share = f": 0 % of the elements are solid ({others})" if others else ""
        raw.fail(
            f"there are no solid elements{share}. stickslip reads linear and quadratic tetrahedra, wedges and "
            "hexahedra; shells and beams have no volume."
        )
    lost = np.flatnonzero(~(np.abs(units.length * raw.coordinates) < LARGEST_COORDINATE).all(axis=1))
    if lost.size:
        raw.fail(
            f"node {raw.shown(raw.node_labels[lost[0]])} has the coordinates "
            f"{', '.join(map(str, raw.coordinates[lost[0]]))}; they must be finite and below {LARGEST_COORDINATE:g} m.",
            int(raw.node_lines[lost[0]]),
        )
    used, cells = _used_nodes(raw)
    points = units.length * raw.coordinates[used]
    labels = raw.node_labels[used]
    blocks = [*zip(raw.blocks, cells, strict=True)]
    require_sound_elements(raw, points, blocks)
    element_labels = np.concatenate([block.labels for block in raw.blocks])
    messages, doubts = [*raw.messages], [*_solid_share(raw)]
    names, body = _bodies(raw, cells, element_labels)
    ends = np.cumsum([len(block.labels) for block in raw.blocks])[:-1]
    cell_blocks = tuple(
        CellBlock(block.kind, numbers, part)
        for (block, numbers), part in zip(blocks, np.split(body, ends), strict=True)
    )
    faces, face_nodes = build_face_sets(raw, labels, element_labels, cell_blocks, messages)
    elements = _members(raw, "element", raw.element_sets, element_labels)
    nodes = _members(raw, "node", raw.node_sets, labels)
    mesh = Mesh(points, tuple(cells), body, nodes | face_nodes, names, faces, elements)
    messages += _clashes(mesh, nodes, face_nodes)
    messages += _sector_words(raw)
    materials = build_materials(raw, units, temperature, names, messages)
    doubts += _parts(mesh)
    equations = build_equations(raw, labels, mesh, units.length, messages, doubts)
    numbers = _NodeNumbers(raw, labels)
    attachments = build_points(raw, units, numbers.of, len(labels), equations, messages, doubts)
    reference_sets = _reference_sets(raw, equations)
    forces, reference_forces = _forces(raw, units, numbers, len(labels))
    messages += _without_solids("element", raw.element_sets, elements)
    messages += _without_solids("node", raw.node_sets, {**nodes, **reference_sets})
    return ImportedModel(
        mesh=mesh,
        source=str(raw.source),
        format=raw.format,
        node_labels=labels,
        element_labels=element_labels,
        label_ranges=raw.label_ranges,
        sector=raw.sector,
        length_unit=units.length_unit,
        unit_system=units.name,
        materials=materials,
        fixed_unknowns=_fixed(raw, numbers, len(labels)),
        node_forces=forces,
        reference_forces=reference_forces,
        equations=equations,
        reference_sets=reference_sets,
        attachments=attachments,
        contacts=tuple(_contacts(raw, mesh, messages)),
        messages=tuple(messages),
        doubts=tuple(doubts),
        warnings=tuple(odd.sentence for odd in model_oddities(mesh, materials)),
    )


def _sector_words(raw: RawModel) -> Iterator[str]:
    if raw.sector:
        yield (
            f"the model is one sector of a disk: {raw.sector}. A study with structure.kind = "
            '"cyclic" repeats it, with left and right for its boundaries; no other kind of study accepts it.'
        )


def _solid_share(raw: RawModel) -> Iterator[str]:
    """The percentage of solid elements, if not all are solid."""
    if raw.other_elements:
        solid = sum(len(block.labels) for block in raw.blocks)
        total = solid + sum(raw.other_elements.values())
        others = ", ".join(f"{count} {name}" for name, count in raw.other_elements.items())
        yield (
            f"{100.0 * solid / total:.3g} % of the elements are solid ({solid} of {total}); the others ({others}) add "
            "no stiffness and no mass."
        )


def _used_nodes(raw: RawModel) -> tuple[IntArray, list[IntArray]]:
    """Positions of the nodes of solid elements in the file's order, and the cells in numbers of these nodes."""
    order = np.argsort(raw.node_labels, kind="stable")
    sorted_labels = raw.node_labels[order]
    twice = np.flatnonzero(sorted_labels[1:] == sorted_labels[:-1])
    if twice.size:
        first, second = order[twice[0]], order[twice[0] + 1]
        where = f" (first in {raw.where(int(raw.node_lines[first]))})" if raw.node_lines[first] else ""
        raw.fail(f"node {raw.shown(raw.node_labels[first])} is defined twice{where}.", int(raw.node_lines[second]))
    positions = []
    for block in raw.blocks:
        place = np.searchsorted(sorted_labels, block.cells).clip(max=max(len(order) - 1, 0))
        missing = np.argwhere(sorted_labels[place] != block.cells) if len(order) else np.argwhere(block.cells >= 0)
        if missing.size:
            at, column = missing[0]
            raw.fail(
                f"element {raw.shown(block.labels[at])} has node {raw.shown(block.cells[at, column])}, which the file "
                "does not define.",
                int(block.lines[at]),
            )
        positions.append(order[place])
    used = np.unique(np.concatenate([position.ravel() for position in positions]))
    return used, [np.searchsorted(used, position) for position in positions]


def _bodies(raw: RawModel, cells: list[IntArray], element_labels: IntArray) -> tuple[tuple[str, ...], IntArray]:
    """Names of the bodies and the body of each element: those of the file, else the connected parts."""
    if not raw.bodies:
        part = connected_parts(cells)
        return tuple(f"part {number + 1}" for number in range(part.max() + 1)), part
    body = np.full(len(element_labels), -1, dtype=np.int64)
    names: list[str] = []
    for each in raw.bodies:
        members = np.isin(element_labels, each.elements)
        if not members.any():
            continue  # shells and beams have sections, too
        twice = members & (body >= 0)
        if twice.any():
            label = element_labels[twice][0]
            raw.fail(
                f"element {raw.shown(label)} belongs to '{names[body[twice][0]]}' and to '{each.name}'.", each.line
            )
        body[members] = len(names)
        names.append(each.name)
    rest = np.flatnonzero(body < 0)
    if rest.size:
        raw.fail(
            f"element {raw.shown(element_labels[rest[0]])} belongs to no section or group that makes a body "
            f"({rest.size} of {len(body)} solid elements do not), so its material is missing. Give each solid element "
            "one.",
            int(np.concatenate([block.lines for block in raw.blocks])[rest[0]]),
        )
    return tuple(names), body


def _members(raw: RawModel, what: str, sets: dict[str, IntArray], labels: IntArray) -> dict[str, IntArray]:
    """Sets by number of node or element, without those that have none of a solid element."""
    order = np.argsort(labels)
    answer = {}
    for name, members in sets.items():
        if not members.size:
            raw.fail(f"{what} set '{name}' is empty. Give it members, or remove it.", raw.set_lines.get(name, 0))
        place = np.searchsorted(labels, members, sorter=order).clip(max=len(labels) - 1)
        numbers = order[place][labels[order[place]] == members]
        if numbers.size:
            answer[name] = np.unique(numbers)
    return answer


def _reference_sets(raw: RawModel, equations: Equations | None) -> dict[str, int]:
    """Name -> label of the node sets that are one reference node."""
    if equations is None:
        return {}
    single = {name: int(nodes[0]) for name, nodes in raw.node_sets.items() if np.unique(nodes).size == 1}
    return {name: label for name, label in single.items() if label in equations.places}


def _without_solids(what: str, sets: dict[str, IntArray], used: Mapping[str, object]) -> Iterator[str]:
    """Messages on the sets that a study cannot use."""
    for name in sets:
        if name not in used:
            kind = "solid element" if what == "element" else "node of a solid element"
            yield f"{what} set '{name}' contains no {kind}, so a study cannot name it."


def _clashes(mesh: Mesh, nodes: dict[str, IntArray], of_faces: dict[str, IntArray]) -> list[str]:
    """Messages on names of several kinds of sets with different nodes, of which a study uses one."""
    sentences = [
        f"the name '{name}' is that of a surface and of another node set; stickslip uses the nodes of the surface."
        for name in sorted(of_faces.keys() & nodes.keys())
        if not np.array_equal(nodes[name], of_faces[name])
    ]
    for name, cells in sorted(mesh.element_sets.items()):
        if not np.array_equal(mesh.nodes_of_cells(cells), mesh.node_sets[name]):
            kind = "surface" if name in of_faces else "node set"
            sentences.append(
                f"the name '{name}' is that of an element set and of a {kind} with other nodes; in a study it is "
                f"the name of the {kind}."
            )
    return sentences


def _parts(mesh: Mesh) -> list[str]:
    """Messages on named bodies with several parts, or with coincident nodes that are not connected."""
    sentences = []
    for number, name in enumerate(mesh.body_names):
        count = connected_parts([block.cells[block.body == number] for block in mesh.blocks]).max() + 1
        if count > 1:
            sentences.append(f"body '{name}' consists of {count} separate parts that share no node.")
        places = mesh.points[mesh.nodes_of_body(number)]
        reach = _ONE_PLACE * float(np.linalg.norm(np.ptp(places, axis=0)))
        distance, _ = scipy.spatial.KDTree(places).query(places, k=2, distance_upper_bound=reach)
        together = int(np.isfinite(distance[:, 1]).sum())
        if together:
            sentences.append(
                f"body '{name}' has {together} nodes at the position of another of its nodes that are not connected "
                "to it. If the body is one piece, merge coincident nodes in the preprocessor; if these are two faces "
                "in contact, use a separate body for each side."
            )
    return sentences


def _contacts(raw: RawModel, mesh: Mesh, messages: list[str]) -> Iterator[RawContact]:
    """The contact pairs whose faces are sets of the mesh; a message on each pair."""
    for contact in raw.contacts:
        missing = [name for name in (contact.first, contact.second) if name != GROUND and name not in mesh.node_sets]
        if missing:
            messages.append(f"contact pair '{contact.name}': there is no face '{missing[0]}' of solids; it is ignored.")
        else:
            messages.append(f"{contact.words()} The study defines the joints.")
            yield contact


class _NodeNumbers:
    """Numbers of nodes by label. The labels are sorted once, because a deck may have one line for each node."""

    def __init__(self, raw: RawModel, labels: IntArray) -> None:
        self._raw = raw
        self._sorted_labels = np.sort(raw.node_labels)
        self._order = np.argsort(labels)
        self._labels = labels[self._order]

    def of(self, wanted: IntArray, line: int) -> IntArray:
        """Numbers of nodes with labels in ``line``, rising, without nodes that belong to no solid element."""
        exists = _contains(self._sorted_labels, wanted)
        if not exists.all():
            self._raw.fail(f"node {self._raw.shown(wanted[~exists].min())} does not exist.", line)
        mine = wanted[_contains(self._labels, wanted)]
        numbers = self._order[np.searchsorted(self._labels, mine)]
        # np.unique takes 0.3 ms, and a deck may have 100,000 forces of one node
        return numbers if numbers.size < 2 else np.unique(numbers)


def _contains(sorted_labels: IntArray, wanted: IntArray) -> NDArray[np.bool_]:
    """Which of ``wanted`` (k,) are in the sorted ``sorted_labels``."""
    if not sorted_labels.size:
        return np.zeros(wanted.shape, dtype=bool)
    return np.asarray(sorted_labels[np.searchsorted(sorted_labels, wanted).clip(max=sorted_labels.size - 1)] == wanted)


def _fixed(raw: RawModel, numbers: _NodeNumbers, n_nodes: int) -> IntArray:
    """Indices among the 3 * n_nodes displacements that the file constrains to zero."""
    constrained = np.zeros((n_nodes, 3), dtype=bool)
    for each in raw.constraints:
        displacements = [direction for direction in each.directions if direction < 3]
        constrained[numbers.of(each.nodes, each.line)[:, None], displacements] = True
    return np.flatnonzero(constrained)


def _forces(
    raw: RawModel, units: UnitSystem, node_numbers: _NodeNumbers, n_nodes: int
) -> tuple[FloatArray, dict[int, FloatArray]]:
    """Forces (n_nodes, 3) N on nodes of solids, and those (3,) on reference nodes by label."""
    forces = np.zeros((n_nodes, 3))
    further: dict[int, FloatArray] = {}
    for load in raw.loads:
        numbers = node_numbers.of(load.nodes, load.line)
        if not numbers.size and not raw.ties.any():
            raw.fail(f"a force acts on node {raw.shown(load.nodes[0])}, which belongs to no solid element.", load.line)
        with np.errstate(over="ignore"):
            force = units.force * load.value
            forces[numbers, load.direction] += force
        if not np.isfinite([force, *forces[numbers, load.direction]]).all():
            raw.fail(f"the force on node {raw.shown(load.nodes[0])} is too large for a number.", load.line)
        if not numbers.size:
            for label in load.nodes.tolist():
                further.setdefault(label, np.zeros(3))[load.direction] += force
    return forces, further
