"""Data of the report's picture of a structure, as plain arrays of its mesh and of the objects of the study."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.validation import FloatArray
from stickslip.model.layout import GroupForce, Layout, NodeGroup, Output
from stickslip.model.model import Model, kind_of
from stickslip.results.peaks import peaks
from stickslip.results.response import ForcedResponse
from stickslip.results.sketch import Motion, Sketch
from stickslip.results.stress import SurfaceStress
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.outer_surface import coarsened, outer_surface
from stickslip.study.disk import DiskOfStudy
from stickslip.study.load_marks import distributed_marks, force_marks
from stickslip.study.mode_shapes import MeshShapes, ShapesOfNodes

if TYPE_CHECKING:
    from stickslip.case.case import Case

# Outer sides of a sketch; chosen: the picture takes less than 3 MB of a page and can be turned without delay.
MOST_SIDES = 22_000


# The stress at nodes (k,) of the mesh.
StressOfNodes = Callable[[IntArray], SurfaceStress]


@dataclass(frozen=True)
class MeshMotion:
    """Displacements (3 * n_nodes, 2H+1) m of a mesh over one period, as coefficients mean, cos 1, sin 1, ..."""

    displacement: FloatArray
    frequency_hz: float

    @property
    def own_coefficients(self) -> FloatArray:
        """The displacements up to the highest harmonic of the motion; those that only other points of its curve have
        are zero."""
        highest = (int(np.flatnonzero(self.displacement.any(axis=0)).max(initial=0)) + 1) // 2
        return self.displacement[:, : 2 * highest + 1]


def motion_at_peak(model: Model, response: ForcedResponse, disk: DiskOfStudy | None = None) -> MeshMotion | None:
    """Motion of the mesh at the highest point of the curve of the first response; None for matrices without a mesh.

    Of a ``disk`` it is that of its first sector.
    """
    if model.in_study.mesh is None:
        return None
    point = peaks(response.frequency_hz, response.amplitude(next(iter(model.outputs.values()))), response.part)[0].point
    reduced = response.displacement[point]
    displacement = model.superelement.recovery @ reduced if disk is None else disk.sector_motion(reduced)
    return MeshMotion(displacement, float(response.frequency_hz[point]))


def sketch_of(
    case: Case,
    model: Model,
    motion: MeshMotion | None,
    stress: StressOfNodes | None = None,
    disk: DiskOfStudy | None = None,
    shapes: MeshShapes | None = None,
) -> Sketch | None:
    """The sketch of a study, with its ``motion``, ``stress`` and ``shapes``; None for matrices without a shape.

    A ``disk`` is shown with all sectors, in which the motion of the first one arrives one after the other.
    """
    kind, structure, layout = kind_of(case), model.in_study.full_model, model.joint.layout
    if disk is not None:
        mesh, layout = disk.ring.mesh, disk.ring_layout(layout)
        motion = motion and replace(motion, displacement=disk.ring_motion(motion.displacement))
        nodes = disk.ring.number[:, np.unique(disk.structure.structure.fixed_unknowns // 3)].ravel()
        constrained = (3 * nodes[:, None] + np.arange(3)).ravel()
    elif structure is not None:
        mesh, constrained = structure.mesh, structure.fixed_unknowns
    else:
        return None
    return make_sketch(
        mesh,
        layout,
        constrained,
        kind.forces(case),
        kind.static_forces(case),
        kind.outputs(case)[0],
        layout.distributed_forces(kind.load_sizes(case)),
        motion,
        stress,
        None if shapes is None else shapes.at,
    )


def make_sketch(
    mesh: Mesh,
    layout: Layout,
    fixed_unknowns: IntArray,
    forces: tuple[GroupForce, ...],
    static_forces: tuple[GroupForce, ...],
    named_outputs: Mapping[str, Output],
    distributed: Mapping[str, FloatArray],
    motion: MeshMotion | None = None,
    stress: StressOfNodes | None = None,
    shapes: ShapesOfNodes | None = None,
) -> Sketch:
    """Outer sides of a mesh, at most ``MOST_SIDES``, the contact among them, and the positions of loads and responses.

    Loads of zero are not included; the mark of several nodes is at their mean; responses at one position have one mark.
    ``fixed_unknowns`` are indices among the 3 * n_nodes displacements; ``distributed`` are section -> (n_nodes, 3) N of
    the constant loads on faces and bodies. Raises InputError for a set of the layout that
    is not in the mesh.
    """
    carrying = [_carrying_nodes(layout.face_pairs, face) for face in range(len(layout.face_names))]
    whole = outer_surface(mesh, layout.contact_sets, carrying)
    shown = coarsened(whole, MOST_SIDES)
    constrained = np.isin(shown.node, fixed_unknowns // 3)
    loads = (
        *force_marks(layout, forces, is_constant=False),
        *force_marks(layout, static_forces, is_constant=True),
        *distributed_marks(distributed, mesh.points),
    )
    load_groups = [load.group for load in loads]
    by_group: dict[str, list[str]] = {}
    for name, output in named_outputs.items():
        by_group.setdefault(output.node_group, []).append(name)
    response_groups = [layout.node_groups[name] for name in by_group]
    return Sketch(
        points=shown.points,
        held=constrained,
        sides=shown.sides,
        body=shown.body,
        face=shown.face,
        body_names=layout.body_names,
        load_names=tuple(load.name for load in loads),
        load_places=_places(mesh, load_groups),
        loads=np.array([load.vector for load in loads]).reshape(-1, 3),
        constant=np.array([load.is_constant for load in loads], dtype=bool),
        response_names=tuple(_joined(names) for names in by_group.values()),
        response_places=_places(mesh, response_groups),
        mesh_sides=len(whole.sides),
        motion=None if motion is None else _motion(motion, shown.node, load_groups, response_groups),
        stress=None if stress is None else stress(shown.node),
        mode_shapes=None if shapes is None else shapes(shown.node),
    )


def _carrying_nodes(pairs: FacePairs, face: int) -> IntArray:
    """Nodes on both sides of the pairs of a face."""
    here = pairs.face == face
    both = ((pairs.first_nodes, pairs.first_weights), (pairs.second_nodes, pairs.second_weights))
    return np.unique(np.concatenate([nodes[here][weights[here] != 0.0] for nodes, weights in both]))


def _places(mesh: Mesh, groups: list[NodeGroup]) -> FloatArray:
    """(k, 3) m, the middle of each node group."""
    return np.array([group.mean_place(mesh.points) for group in groups], dtype=float).reshape(-1, 3)


def _motion(motion: MeshMotion, nodes: IntArray, loads: list[NodeGroup], responses: list[NodeGroup]) -> Motion:
    """The motion of nodes (n,), and of loads and responses, which is the mean over their nodes."""
    of_nodes = motion.displacement.reshape(-1, 3, motion.displacement.shape[1])

    def at(groups: list[NodeGroup]) -> FloatArray:
        means = [group.mean_of(of_nodes) for group in groups]
        return np.array(means, dtype=float).reshape(-1, *of_nodes.shape[1:])

    return Motion(
        points=of_nodes[nodes].astype(np.float32),
        loads=at(loads).astype(np.float32),
        responses=at(responses).astype(np.float32),
        frequency_hz=motion.frequency_hz,
    )


def _joined(names: list[str]) -> str:
    """Names of one place: "left x, y, z" for "left x", "left y" and "left z"."""
    starts = {name.rpartition(" ")[0] for name in names}
    if len(names) > 1 and len(starts) == 1 and "" not in starts:
        return f"{starts.pop()} {', '.join(name.rpartition(' ')[2] for name in names)}"
    return ", ".join(names)
