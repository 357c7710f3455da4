"""The result of the readers of model files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stickslip.core.errors import ImportFileError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, argument_error
from stickslip.formats.meshes.raw_contacts import RawContact
from stickslip.formats.meshes.raw_model import LabelRange, shown_label
from stickslip.structure.attachments import Attachments, attach
from stickslip.structure.constraints import eliminate
from stickslip.structure.elasticity import Material, Structure, assemble_bodies
from stickslip.structure.equations import Equations
from stickslip.structure.mesh import IntArray, Mesh


@dataclass(frozen=True)
class ImportedModel:
    """A model file in SI units.

    Parameters
    ----------
    mesh:
        nodes, cells, bodies and sets, without nodes that have no solid cell.
    source, format:
        the file, and the name of its format.
    node_labels, element_labels:
        (n_nodes,) and (n_cells,) numbers of the nodes and cells in the file; a message reports offsets of instances.
    label_ranges:
        ranges of these numbers that belong to instances.
    materials:
        body name -> material, for the bodies that have one in the file.
    fixed_unknowns:
        indices among the 3 * n_nodes displacements (node, then x, y, z) that the file constrains to zero.
    node_forces:
        (n_nodes, 3) N, the file's constant loads on nodes; zero where there is none.
    reference_forces:
        reference node of ``equations`` -> (3,) N, the file's constant load on it.
    equations:
        ties, rigid bodies, couplings and equations of the file, None without any.
    contacts:
        contact pairs of the file between faces of the mesh; a study may take them over as joints.
    reference_sets:
        node set of the file that is one reference node of ``equations`` -> its number.
    attachments:
        mass points and springs of the file, None without any.
    sector:
        the entry that makes the file one sector of a disk, "" if there is none; only a study of a disk repeats it.
    length_unit, unit_system:
        units of the numbers of the file.
    messages:
        notes on what was read, on entries without effect, and on assumptions.
    doubts:
        messages on what the model lacks here, or may not intend: parts that are not connected, elements and masses that
        are not read, nodes that a tie leaves free.
    warnings:
        messages on sizes, densities, moduli and masses that only wrong units can explain.
    """

    mesh: Mesh
    source: str
    format: str
    node_labels: IntArray
    element_labels: IntArray
    length_unit: str
    unit_system: str
    materials: Mapping[str, Material] = field(default_factory=dict)
    fixed_unknowns: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    node_forces: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    reference_forces: Mapping[int, FloatArray] = field(default_factory=dict)
    label_ranges: tuple[LabelRange, ...] = ()
    equations: Equations | None = None
    contacts: tuple[RawContact, ...] = ()
    reference_sets: Mapping[str, int] = field(default_factory=dict)
    attachments: Attachments | None = None
    sector: str = ""
    messages: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    __repr__ = short_repr

    def assemble(self, materials: Mapping[str, Material] | None = None) -> Structure:
        """Stiffness and mass of the model, with its constraints, ties, mass points and springs, without contact.

        ``materials`` (body name -> material) are for bodies without one in the file, or replace those of the file.
        Raises InputError for a body without a material, and for a name that is not that of a body.
        """
        given = {**self.materials, **(materials or {})}
        bodies = ", ".join(self.mesh.body_names)
        for name in given:
            if name not in self.mesh.body_names:
                raise argument_error("materials", f'materials has "{name}", but the bodies of the model are: {bodies}.')
        for name in self.mesh.body_names:
            if name not in given:
                raise argument_error(
                    "materials",
                    f'the file has no material for the body "{name}". Give one: '
                    f'assemble({{"{name}": Material(young_modulus=..., poisson_ratio=..., density=...)}}).',
                )
        tied = None if self.equations is None else eliminate(self.equations, self.fixed_unknowns)
        solids = assemble_bodies(
            self.mesh,
            [given[name] for name in self.mesh.body_names],
            fixed_unknowns=self.fixed_unknowns,
            constraints=tied,
        )
        return attach(solids, self.attachments)

    @property
    def loads(self) -> dict[int, FloatArray]:
        """Number in the file of each loaded node, of the mesh and then of reference -> its force (3,) N."""
        loaded = np.flatnonzero(self.node_forces.any(axis=1))
        own = {int(self.node_labels[node]): self.node_forces[node] for node in loaded}
        return own | {label: force for label, force in self.reference_forces.items() if force.any()}

    def shown(self, label: int) -> str:
        """A node or element as in the file."""
        return shown_label(label, self.label_ranges)

    def node_numbers(self, labels: IntArray) -> IntArray:
        """Node numbers of the mesh from those of the file; raises ImportFileError for one that the model lacks."""
        order = np.argsort(self.node_labels)
        place = np.searchsorted(self.node_labels, labels, sorter=order).clip(max=len(order) - 1)
        numbers = order[place]
        wrong = np.flatnonzero(self.node_labels[numbers] != labels)
        if wrong.size:
            raise ImportFileError(
                f"{self.source}: there is no node {np.ravel(labels)[wrong[0]]} that belongs to a solid element."
            )
        return np.asarray(numbers, dtype=np.int64)
