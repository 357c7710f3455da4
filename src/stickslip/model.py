"""From a validated case to what the solver needs: mesh, superelement, contact pairs, forces and outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.interface.contact_pairs import ContactPairs
from stickslip.interface.pairing import FacePairs, pair_faces
from stickslip.interface.preload import area_share, face_sum, prescribed_preload, uniform_preload
from stickslip.interface.stiffness import (
    ContactStiffness,
    Roughness,
    contact_stiffness,
    pair_stiffness,
    reduced_modulus,
)
from stickslip.interface.surface import SurfaceStatistics, surface_statistics
from stickslip.progress import ProgressCallback
from stickslip.solve.damping import rayleigh_damping_matrix
from stickslip.structure.blade_pair import BladePairElements, BladePairGeometry, blade_pair_mesh
from stickslip.structure.cache import cached_superelement
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Material, Structure, assemble
from stickslip.structure.factor import best_backend
from stickslip.structure.finite_element_mesh import AnyMesh
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.superelement import Superelement
from stickslip.validation import FloatArray

if TYPE_CHECKING:
    from stickslip.case import Case

FACES = (("damper_left_face", "left_face"), ("damper_right_face", "right_face"))
FACE_NAMES = ("left face", "right face")
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class RoughFace:
    """What the roughness says of one contact face under its preload."""

    stiffness: ContactStiffness
    statistics: SurfaceStatistics


@dataclass(frozen=True)
class Joint:
    """Constants of the contact pairs before any reduction: they follow from geometry, roughness and load alone."""

    face_pairs: FacePairs
    preload: FloatArray  # (n_pairs,) N
    normal_stiffness: FloatArray  # (n_pairs,) N/m
    tangential_stiffness: FloatArray  # (n_pairs,) N/m
    rough_faces: tuple[RoughFace, ...]  # one for each face; empty where the stiffness was given

    def face_sum(self, values: FloatArray) -> FloatArray:
        """Sum of a value of the pairs for each face (n_faces,)."""
        return face_sum(values, self.face_pairs.face)


@dataclass(frozen=True)
class ReducedModel:
    """What is needed to solve one case and to describe it; the mesh and its matrices are no longer part of it."""

    superelement: Superelement
    joint: Joint
    pairs: ContactPairs
    force_sin: FloatArray  # (n,) N: the excitation is P sin(w t)
    outputs: Mapping[str, FloatArray]
    signal_groups: Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class Model(ReducedModel):
    """Everything that is needed to solve one case and to show it."""

    structure: Structure


def build_mesh(case: Case) -> Mesh:
    """Mesh of the two blades and the damper. Raises InputError for a geometry that does not fit."""
    dimensions = case.geometry.model_dump()
    dimensions["platform_angle_deg"] = float(np.degrees(dimensions.pop("platform_angle")))
    counts = case.mesh.model_dump()
    element = counts.pop("element")
    mesh = blade_pair_mesh(BladePairGeometry(**dimensions), BladePairElements(**counts))
    return mesh.quadratic() if element == "serendipity" else mesh


def build_structure(case: Case, mesh: Mesh | None = None) -> Structure:
    """Matrices on ``mesh``, or on the case's own. Raises InputError for a geometry that does not fit."""
    material = Material(case.material.young_modulus, case.material.poisson_ratio, case.material.density)
    return assemble(build_mesh(case) if mesh is None else mesh, material, element=case.mesh.element)


def find_pairs(mesh: AnyMesh) -> FacePairs:
    """Contact pairs of both faces: left face first."""
    return FacePairs.concatenate([pair_faces(mesh, *names) for names in FACES])


def build_joint(case: Case, structure: Structure) -> Joint:
    """Pairs, preload and stiffness. Raises RoughnessError where the roughness gives no usable contact."""
    return load_joint(case, find_pairs(structure.mesh))


def load_joint(case: Case, face_pairs: FacePairs) -> Joint:
    """Preload and stiffness of given pairs. Raises RoughnessError where the roughness gives no usable contact."""
    preload = _preload(case, face_pairs)
    if case.contact_stiffness is not None:
        share = area_share(face_pairs.area, face_pairs.face)
        given = case.contact_stiffness
        return Joint(face_pairs, preload, share * given.normal_stiffness, share * given.tangential_stiffness, ())
    assert case.roughness is not None  # one of the two is always given
    roughness = case_roughness(case)
    rough_faces = []
    for face in range(len(FACES)):
        members = face_pairs.face == face
        area, load = float(face_pairs.area[members].sum()), float(np.maximum(preload[members], 0.0).sum())
        rough_faces.append(
            RoughFace(
                contact_stiffness(roughness, load, mode=case.roughness.mode, nominal_area=area),
                surface_statistics(roughness, case.roughness.sample_length, case.roughness.shortest_length),
            )
        )
    normal, tangential = pair_stiffness(
        roughness,
        face_pairs.area,
        preload,
        mode=case.roughness.mode,
        allocation=case.roughness.allocation,
        face=face_pairs.face,
    )
    return Joint(face_pairs, preload, normal, tangential, tuple(rough_faces))


def _preload(case: Case, face_pairs: FacePairs) -> FloatArray:
    if case.preload.values is not None:
        if len(case.preload.values) != face_pairs.n_pairs:
            first = int((face_pairs.face == 0).sum())
            raise InputError(
                f"preload.values has {len(case.preload.values)} entries, but this mesh has {face_pairs.n_pairs} "
                f"contact pairs. Give one force for each: {first} of the left face, then "
                f"{face_pairs.n_pairs - first} of the right one; or give centrifugal_force instead."
            )
        return prescribed_preload(case.preload.values, face_pairs.area.size)
    assert case.preload.centrifugal_force is not None
    return uniform_preload(
        case.preload.centrifugal_force,
        case.geometry.platform_angle,
        face_pairs.area,
        face_pairs.face,
        friction_coefficient=case.preload.friction_coefficient_at_assembly,
    )


def case_roughness(case: Case) -> Roughness:
    """Roughness and material of a case that has a roughness."""
    given, material = case.roughness, case.material
    assert given is not None
    return Roughness(
        fractal_dimension=given.fractal_dimension,
        fractal_roughness=given.fractal_roughness,
        hardness=given.hardness,
        reduced_modulus=reduced_modulus(
            material.young_modulus, material.poisson_ratio, material.young_modulus, material.poisson_ratio
        ),
        poisson_ratio=material.poisson_ratio,
        domain_extension=given.domain_extension,
        sample_length=given.sample_length,
        shortest_length=given.shortest_length,
    )


def boundary_nodes(mesh: AnyMesh, face_pairs: FacePairs) -> NDArray[np.int64]:
    """Nodes that keep their displacements in the reduction: contact nodes, N1, N2 and A."""
    sets = mesh.node_sets
    points = np.concatenate([sets[name] for name in ("excitation_left", "excitation_right", "response")])
    return np.unique(np.concatenate([face_pairs.nodes, points])).astype(np.int64)


def reduce_structure(
    case: Case,
    structure: Structure,
    face_pairs: FacePairs,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Superelement:
    """The structure in the unknowns of its contact nodes, N1, N2, A and a few modes, from the disk if known."""
    nodes, n_modes = boundary_nodes(structure.mesh, face_pairs), case.reduction.modes
    backend = best_backend(structure.stiffness.shape[0])
    return cached_superelement(
        structure, nodes, n_modes, lambda: craig_bampton(structure, nodes, n_modes, backend, threads, progress)
    )


def build_model(
    case: Case, structure: Structure, joint: Joint, threads: int = 1, progress: ProgressCallback | None = None
) -> Model:
    """Reduce the structure and connect joint, forces and outputs to the reduced unknowns."""
    superelement = reduce_structure(case, structure, joint.face_pairs, threads, progress)
    connected = connect(case, superelement, structure.mesh.node_sets, joint)
    return Model(**vars(connected), structure=structure)


def connect(case: Case, superelement: Superelement, node_sets: Mapping[str, IntArray], joint: Joint) -> ReducedModel:
    """Connect joint, damping, forces and outputs of a case to a reduced structure, which several cases may share."""
    pairs = ContactPairs(
        joint.face_pairs.operator(superelement),
        joint.normal_stiffness,
        joint.tangential_stiffness,
        case.friction.coefficient,
        joint.preload,
    )
    if case.damping.modal_damping_ratio is None:
        damping = rayleigh_damping_matrix(
            superelement, case.damping.rayleigh_alpha or 0.0, case.damping.rayleigh_beta or 0.0
        )
        superelement = replace(superelement, damping=damping)
    outputs, groups = _outputs(case, node_sets, superelement)
    return ReducedModel(superelement, joint, pairs, _force(case, node_sets, superelement), outputs, groups)


def _force(case: Case, sets: Mapping[str, IntArray], superelement: Superelement) -> FloatArray:
    """(n,) N at N1 and N2: single (N1 alone), same direction, or opposite."""
    excitation = case.excitation
    second = {"single": 0.0, "same": 1.0, "opposite": -1.0}[excitation.mode]
    left = superelement.selector(int(sets["excitation_left"][0]), excitation.direction)
    right = superelement.selector(int(sets["excitation_right"][0]), excitation.direction)
    return excitation.amplitude * (left + second * right)


def _outputs(
    case: Case, sets: Mapping[str, IntArray], superelement: Superelement
) -> tuple[dict[str, FloatArray], dict[str, tuple[str, ...]]]:
    """Rows that read A along the excitation's direction and both sides of the damper along x, y, z."""
    outputs = {"blade tip A": superelement.selector(int(sets["response"][0]), case.excitation.direction)}
    groups = {}
    for side in ("left", "right"):
        node = int(sets[f"damper_{side}_mid"][0])
        names = tuple(f"damper {side} {axis}" for axis in AXES)
        outputs |= {name: superelement.selector(node, AXES[name[-1]]) for name in names}
        groups[f"Damper, middle of its {side} face"] = names
    return outputs, groups
