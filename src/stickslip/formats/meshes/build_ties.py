"""From the ties of a model file to equations between the displacements of its mesh."""

from __future__ import annotations

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.raw_ties import RawDistributing, RawEquation, RawRigid, RawTie
from stickslip.structure.cell_kinds import IntArray
from stickslip.structure.equations import DependsTwice, Equations, add_distributing, add_rigid
from stickslip.structure.face_ties import add_tie, tie_nodes
from stickslip.structure.faces import face_geometry
from stickslip.structure.mesh import Mesh


def build_equations(
    raw: RawModel, labels: IntArray, mesh: Mesh, length: float, messages: list[str], doubts: list[str]
) -> Equations | None:
    """Equations in m of all ties of a file; None without any. ``labels`` (n_nodes,) are those of the mesh.
    A tie adds a sentence to ``messages``, to ``doubts`` if nodes of it remain free.

    Raises ImportFileError that names the line of a tie with a node or a face that does not exist, of a displacement
    that depends twice, and of a coupling without rotation.
    """
    if not raw.ties.any():
        return None
    writer = _Writer(raw, labels, mesh, length)
    # Rigid bodies first, because they define the rotations of reference nodes; a tie comes last, because its nodes may
    # follow something else.
    for rigid in raw.ties.rigid:
        writer.rigid(rigid)
    for coupling in raw.ties.distributing:
        writer.distributing(coupling)
    for equation in raw.ties.equations:
        writer.equation(equation)
    for tie in raw.ties.faces:
        sentence, is_complete = writer.tie(tie)
        (messages if is_complete else doubts).append(sentence)
    writer.fix()
    return writer.equations


class _Writer:
    """Writes equations and finds the unknowns of nodes by label."""

    def __init__(self, raw: RawModel, labels: IntArray, mesh: Mesh, length: float) -> None:
        self._raw, self._mesh, self._length = raw, mesh, length
        self._number = {label: number for number, label in enumerate(labels.tolist())}
        self._row = {label: row for row, label in enumerate(raw.node_labels.tolist())}
        self._size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
        self.equations = Equations(mesh.n_nodes)

    def tie(self, tie: RawTie) -> tuple[str, bool]:
        """Tie the nodes of a set to a face; returns a message with their number, and whether no other one is left."""
        raw, mesh = self._raw, self._mesh
        nodes = mesh.node_sets.get(tie.dependent, np.empty(0, dtype=np.int64))
        if tie.independent not in mesh.face_sets:
            raw.fail(
                f"{tie.what}: '{tie.independent}' is not a face of solid elements. Give a surface of element sides.",
                tie.line,
            )
        tolerance = None if tie.tolerance is None else self._length * tie.tolerance
        tied = tie_nodes(mesh.points, nodes, mesh.face_sets[tie.independent], tolerance)
        if not tied.nodes.size:
            raw.fail(
                f"{tie.what}: no node of '{tie.dependent}' is within {1e3 * tied.tolerance:.4g} mm of "
                f"'{tie.independent}' (nodes of solid elements in '{tie.dependent}': {nodes.size}). Give a larger "
                "POSITION TOLERANCE, or check the surfaces.",
                tie.line,
            )
        before = add_tie(self.equations, self._owner(tie), tied)
        words = f"{raw.where(tie.line)}: {tie.what}: {tied.words(tie.dependent, tie.independent, before)}."
        return words, not tied.untied.size

    def equation(self, equation: RawEquation) -> None:
        """Write one equation."""
        owner = self._owner(equation)
        terms = [(self._unknown(label, axis, equation.line), value) for label, axis, value in equation.terms]
        self._add(terms, -1 if equation.is_free else terms[0][0], owner, equation.line)

    def rigid(self, rigid: RawRigid) -> None:
        """Write the equations of a rigid body."""
        nodes = rigid.nodes
        if rigid.face:
            labels = np.array(list(self._number), dtype=np.int64)
            nodes = labels[self._mesh.node_sets[rigid.face]]
        nodes = nodes[nodes != rigid.reference]
        nodes = np.array(list(dict.fromkeys(nodes.tolist())), dtype=np.int64)
        if not nodes.size:
            return
        owner, line = self._owner(rigid), rigid.line
        reference = self._reference(rigid.reference, rigid.rotation, nodes, line)
        moved = [each for each in rigid.directions if each < 3]
        unknowns = np.array([[self._unknown(label, axis, line) for axis in range(3)] for label in nodes.tolist()])
        points = np.array([self._place(label, line) for label in nodes.tolist()])
        try:
            add_rigid(self.equations, owner, unknowns, points, reference, np.eye(3)[moved])
        except DependsTwice as error:
            self._fail_twice(error, line)
        for label in nodes.tolist():
            if label in self._number:
                continue  # a node of solids has no rotation
            for axis in (each for each in rigid.directions if each > 2):
                unknown = self._unknown(label, axis, line)
                self._add([(unknown, 1.0), (int(reference[2][axis - 3]), -1.0)], unknown, owner, line)

    def distributing(self, coupling: RawDistributing) -> None:
        """Write the equations of a distributing coupling."""
        owner, line = self._owner(coupling), coupling.line
        nodes, weights = coupling.nodes, coupling.weights
        if coupling.face in self._mesh.face_sets:
            numbers, weights, _ = face_geometry(self._mesh, coupling.face)
            points = self._mesh.points[numbers]
            unknowns = 3 * numbers[:, None] + np.arange(3)
        else:
            unknowns = np.array([[self._unknown(label, axis, line) for axis in range(3)] for label in nodes.tolist()])
            points = np.array([self._place(label, line) for label in nodes.tolist()])
            weights = np.ones(len(nodes)) if weights is None else weights
        size = self._extent(points)
        moved, turned = self._motion(coupling.reference, None, size, line)
        try:
            add_distributing(
                self.equations, owner, unknowns, points, weights,
                (self._place(coupling.reference, line), moved, turned), coupling.directions,
            )  # fmt: skip
        except DependsTwice as error:
            self._fail_twice(error, line)
        except InputError as error:
            self._raw.fail(f"{coupling.what}: {error}", line)

    def fix(self) -> None:
        """Set the constrained displacements and rotations of reference nodes to zero."""
        for each in self._raw.constraints:
            for label in each.nodes.tolist():
                for axis in each.directions:
                    if (label, axis) in self.equations.further:
                        self.equations.fixed.add(self.equations.further[label, axis])

    def _owner(self, tie: RawTie | RawEquation | RawRigid | RawDistributing) -> int:
        return self.equations.owner(f"{tie.what} in {self._raw.where(tie.line)}" if tie.line else tie.what)

    def _reference(
        self, label: int, rotation: int | None, nodes: IntArray, line: int
    ) -> tuple[FloatArray, IntArray, IntArray]:
        points = np.array([self._place(each, line) for each in [label, *nodes.tolist()]])
        return points[0], *self._motion(label, rotation, self._extent(points), line)

    def _extent(self, points: FloatArray) -> float:
        """m, of nodes; that of the mesh where they are at one point."""
        return float(np.ptp(points, axis=0).max()) or self._size

    def _motion(self, label: int, rotation: int | None, size: float, line: int) -> tuple[IntArray, IntArray]:
        """Unknowns of the displacement (3,) and rotation (3,) of a reference node."""
        moved = np.array([self._unknown(label, axis, line) for axis in range(3)])
        if rotation is not None:
            turned = [self.equations.unknown((rotation, axis), size) for axis in range(3)]
            # its rotations also have the numbers 4 to 6 of the reference node
            for axis in range(3):
                self.equations.further.setdefault((label, 3 + axis), turned[axis])
        else:
            turned = [self.equations.unknown((label, 3 + axis), size) for axis in range(3)]
        return moved, np.array(turned)

    def _unknown(self, label: int, axis: int, line: int) -> int:
        number = self._number.get(label)
        if number is not None and axis < 3:
            return 3 * number + axis
        place = self._place(label, line)
        if number is None:
            self.equations.places[label] = place
        return self.equations.unknown((label, axis))

    def _place(self, label: int, line: int) -> FloatArray:
        """(3,) m of a node. Raises ImportFileError if the file does not define it."""
        if label not in self._row:
            self._raw.fail(f"node {self._raw.shown(label)} does not exist.", line)
        return np.asarray(self._length * self._raw.coordinates[self._row[label]])

    def _add(self, terms: list[tuple[int, float]], dependent: int, owner: int, line: int) -> None:
        try:
            self.equations.add(terms, dependent, owner)
        except DependsTwice as error:
            self._fail_twice(error, line)

    def _fail_twice(self, error: DependsTwice, line: int) -> None:
        if error.unknown < 3 * self._mesh.n_nodes:
            labels = list(self._number)
            label, axis = labels[error.unknown // 3], error.unknown % 3
        else:
            label, axis = next(key for key, number in self.equations.further.items() if number == error.unknown)
        self._raw.fail(
            f"direction {axis + 1} of node {self._raw.shown(label)} depends on other nodes twice: in {error.first} "
            f"and in {error.second}. Remove one of the two, or make another node of it the dependent one.",
            line,
        )
