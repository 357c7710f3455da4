"""From a validated case of any kind to the input of the solver: superelement, contact pairs, forces and outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any

import numpy as np

from stickslip.case.case import Case, CyclicCase, MatrixCase, MeshCase, TwoBladeCase
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import BoolArray
from stickslip.core.errors import keys_of_section
from stickslip.core.plausible import suspecting
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.model.joint import Joint, make_joint, odd_values
from stickslip.model.kinds.cyclic import CyclicKind
from stickslip.model.kinds.kind import Kind
from stickslip.model.kinds.matrices import MatrixKind
from stickslip.model.kinds.mesh import MeshKind
from stickslip.model.kinds.two_blade import TwoBladeKind
from stickslip.model.layout import AnyStructure, Layout, Setup
from stickslip.model.moving_joint import moving_pairs_of, reduced_to_moving, require_mesh_at_rest
from stickslip.model.solved_preload import SolvedPreload, resting_joint, solve_preload
from stickslip.model.study_structure import ReducedStructure, StudyStructure, study_structure
from stickslip.solve.excitation import Excitation
from stickslip.structure.elasticity import Structure
from stickslip.structure.substructure import Substructure
from stickslip.structure.superelement import Superelement

# Class of the cases of a kind -> the kind; a further kind is one more file in ``kinds`` and one more line here.
KINDS: dict[type[Case], Kind[Any]] = {
    TwoBladeCase: TwoBladeKind(),
    MeshCase: MeshKind(),
    MatrixCase: MatrixKind(),
    CyclicCase: CyclicKind(),
}


def kind_of(case: Case) -> Kind[Any]:
    """The kind of the case's structure."""
    return KINDS[type(case)]


@dataclass(frozen=True)
class ReducedModel:
    """Data to solve one case and to describe it, without the mesh and its matrices.

    ``outputs`` are rows (n,); ``static_load`` (n,) N are the constant forces and distributed loads; if the preload
    was solved from them, ``preload`` contains the state at rest, and ``joint`` and ``pairs`` are those of this state.
    Cases with other joints or forces share the ``reduced`` structure. The unknowns of a sector are those of this sector
    and of the next one.
    """

    substructure: Substructure
    joint: Joint
    pairs: ContactPairs
    excitation: Excitation
    static_load: FloatArray
    outputs: Mapping[str, FloatArray]
    signal_groups: Mapping[str, tuple[str, ...]]
    preload: SolvedPreload | None
    reduced: ReducedStructure

    def __repr__(self) -> str:
        return (
            f"{type(self).__name__}({self.substructure!r}, {self.pairs!r}, {self.excitation!r}; "
            f"{len(self.outputs)} output rows)"
        )

    @property
    def superelement(self) -> Superelement:
        """The matrices of a structure. Raises InputError for a sector of a disk, which has no single ones."""
        return self.substructure.require_structure()


@dataclass(frozen=True)
class Model(ReducedModel):
    """Data to solve one case and to show it."""

    structure: AnyStructure

    @property
    def in_study(self) -> StudyStructure:
        """The structure before its reduction, of any kind."""
        return study_structure(self.structure)


def set_up(case: Case) -> Setup:
    """The structure of a case before its matrices, with its layout. Raises InputError for entries that do not fit."""
    return kind_of(case).set_up(case)


def build_structure(case: Case) -> AnyStructure:
    """Matrices of the structure of a case. Raises InputError for entries that do not fit."""
    return set_up(case).assemble()


def build_joint(case: Case, structure: Structure) -> Joint:
    """Pairs, preload and stiffness. Raises RoughnessError where the roughness gives no usable contact."""
    return load_joint(case, kind_of(case).find_layout(case, structure.mesh))


def load_joint(case: Case, layout: Layout) -> Joint:
    """Preload and stiffness of the pairs of a layout. Raises RoughnessError where the roughness gives no usable
    contact."""
    kind = kind_of(case)
    with suspecting(odd_values(case, layout)):
        return make_joint(case, layout, kind.preload(case, layout), kind.face_settings(case))


def reduce_structure(
    case: Case,
    structure: AnyStructure,
    layout: Layout,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> ReducedStructure:
    """The structure in the unknowns of its contact nodes, its groups of one node and a few modes. Raises InputError."""
    with suspecting(odd_values(case, layout)), keys_of_section("reduction", {"n_modes": "modes"}):
        return study_structure(structure).reduced(layout, case.reduction.modes, threads, progress)


def build_model(
    case: Case,
    structure: AnyStructure | None = None,
    joint: Joint | None = None,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Model:
    """The model of a case: superelement, contact pairs, excitation, and outputs by name.

    ``model.outputs["tip"] @ response.displacement`` is an output. ``structure`` and ``joint`` are those of the case, if
    they already exist; ``threads`` is for the reduction, and ``progress`` receives the finished fraction. Raises
    InputError for entries that do not fit, RoughnessError where the roughness gives no usable contact, and
    ConvergenceError if the solution of the preload does not converge.
    """
    if structure is None or joint is None:
        setup = set_up(case)
        structure, joint = structure or setup.assemble(), joint or load_joint(case, setup.layout)
    if case.reduction.pairs == "moving":
        moving = _estimated_moving_pairs(case, structure, joint, threads)
        return model_of_moving_pairs(case, structure, joint, moving, threads, progress)
    reduced = reduce_structure(case, structure, joint.layout, threads, progress)
    return Model(**vars(connect(case, reduced, joint)), structure=structure)


def _estimated_moving_pairs(case: Case, structure: AnyStructure, joint: Joint, threads: int) -> BoolArray:
    """(n_pairs,) the pairs that can move."""
    layout = joint.layout

    def excitation_of(modes: FloatArray) -> Excitation:
        rows = {name: group.unit_loads(len(modes)).T @ modes for name, group in layout.node_groups.items()}
        inertia = layout.base_inertia
        return make_excitation(case, rows, None if inertia is None else modes.T @ inertia)

    return moving_pairs_of(case, require_mesh_at_rest(structure), joint, excitation_of, threads)


def model_of_moving_pairs(
    case: Case,
    structure: AnyStructure,
    joint: Joint,
    moving: BoolArray,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Model:
    """The model whose pairs rest but for the ``moving`` ones (n_pairs,). Raises InputError."""
    with keys_of_section("reduction", {"n_modes": "modes"}):
        reduced = reduced_to_moving(case, require_mesh_at_rest(structure), joint, moving, threads, progress)
    return Model(**vars(connect(case, reduced, joint)), structure=structure)


def connect(case: Case, reduced: ReducedStructure, joint: Joint, compare: bool = True) -> ReducedModel:
    """Connect joint, damping, forces and outputs of a case to a reduced structure, which may belong to several cases.

    A solved preload has both states at rest to ``compare``, which takes twice the time.
    """
    kind, damping = kind_of(case), case.damping
    substructure = reduced.at(kind.rotation_speed(case))
    if damping.modal_damping_ratio is None:
        substructure = substructure.with_rayleigh_damping(damping.rayleigh_alpha or 0.0, damping.rayleigh_beta or 0.0)
    excitation = make_excitation(case, reduced.node_groups, reduced.base_inertia)
    static_load = make_static_load(case, reduced.node_groups, reduced.unit_loads)
    named_outputs, groups = kind.outputs(case)
    outputs = {
        name: np.asarray(each.direction) @ reduced.node_groups[each.node_group] for name, each in named_outputs.items()
    }
    solved = None
    if case.preload.method == "solved":
        settings = kind.face_settings(case)
        solved = solve_preload(case, joint, settings, substructure, static_load, compare)
        pairs = solved.pairs_about(solved.state, case.preload.residual_traction == "kept")
        joint = resting_joint(case, joint, settings, solved.state, pairs)
    else:
        pairs = joint.contact_pairs(substructure.operator(joint.face_pairs))
    return ReducedModel(substructure, joint, pairs, excitation, static_load, outputs, groups, solved, reduced)


def make_static_load(
    case: Case, node_groups: Mapping[str, FloatArray], unit_loads: Mapping[str, FloatArray]
) -> FloatArray:
    """(n,) N of the constant forces and distributed loads, on the unknowns of ``node_groups``, name -> rows (3, n).

    ``unit_loads`` are section -> (n, k) N for each unit of the sizes of a distributed load.
    """
    kind = kind_of(case)
    load = np.zeros(next(iter(node_groups.values())).shape[1])
    for section, sizes in kind.load_sizes(case).items():
        load = load + unit_loads[section] @ np.array(sizes)
    for force in kind.static_forces(case):
        load = load + force.amplitude * (np.asarray(force.direction) @ node_groups[force.node_group])
    return load


def make_excitation(case: Case, node_groups: Mapping[str, FloatArray], base_inertia: FloatArray | None) -> Excitation:
    """The excitation of a case on the unknowns of ``node_groups``, name -> rows (3, n).

    ``base_inertia`` (n, 3) kg resists an acceleration of the support of 1 m/s2 along x, y, z.
    """
    kind = kind_of(case)
    forces, motion = kind.forces(case), kind.base_motion(case)
    parts = []
    if forces:
        size = next(iter(node_groups.values())).shape[1]
        shape = (size, max(force.harmonic for force in forces))
        cosine, sine = np.zeros(shape), np.zeros(shape)
        for force in forces:
            row = np.asarray(force.direction) @ node_groups[force.node_group]
            cosine[:, force.harmonic - 1] += force.amplitude * np.sin(force.phase) * row
            sine[:, force.harmonic - 1] += force.amplitude * np.cos(force.phase) * row
        wave = kind.wave(case)
        parts.append(
            Excitation.force(cosine, sine)
            if wave is None
            else Excitation.travelling_wave(wave.engine_order, cosine, sine, wave.direction)
        )
    for each in kind.unbalances(case):
        first, second = (across @ node_groups[each.node_group] for across in each.turning)
        parts.append(Excitation.unbalance(first, second, each.mass_times_radius))
    if motion is not None and base_inertia is not None:
        carried = base_inertia @ np.asarray(motion.direction)
        parts.append(Excitation.carried_base_motion(carried, motion.amplitude, motion.kind))
    return reduce(add, parts)
