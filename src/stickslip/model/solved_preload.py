"""The preload of a study, solved from its static load: pressure, gaps and tractions of every pair at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.normal_law import FaceLaws, NormalLaw, PressureGapLaw, SpringLaw
from stickslip.core.errors import ConvergenceError
from stickslip.core.threads import single_library_thread
from stickslip.core.validation import FloatArray
from stickslip.model.joint import (
    FaceSettings,
    Joint,
    describe_faces,
    face_allocation,
    face_law,
    pair_springs,
    pressure_warnings,
)
from stickslip.model.loaded_laws import laws_at_rest, with_loaded_laws, without_loaded_laws
from stickslip.model.rough_face import case_roughness, plastic_pressure
from stickslip.solve.static.ramp_to_rest import static_preload
from stickslip.solve.static.state import StaticState
from stickslip.structure.substructure import Substructure, rows_of_mean
from stickslip.structure.superelement import Superelement

if TYPE_CHECKING:
    from stickslip.case.case import Case

# chosen: the stiffness of a pair is constant below this fraction of the mean pressure of its face, because the law
# vanishes at zero pressure, and below this multiple of the pressure at which all spots are plastic, where it vanishes
# too. On a face whose mean pressure leaves all spots plastic, no pair has a pressure above that one. So the pairs of a
# face never stand on both sides of it, where the law jumps.
LOWEST_PRESSURE = 0.01
LOWEST_ABOVE_PLASTIC = 2.0
HIGHEST_BELOW_PLASTIC = 1.0 - 1e-9  # the law jumps at 1
SECANT_WARNING = (
    'allocation = "pressure" with a solved preload uses the stiffness at the pressure of a pair as a linear spring '
    "from zero load, N = A kappa(p) closure. The curve of a rough face is flatter at first, so this concentrates the "
    'load on few pairs. preload.normal_law = "pressure-gap" follows the complete curve.'
)
# chosen: largest pressure of the pressure-gap table over the mean pressure of the face.
HIGHEST_PRESSURE = 1e3


@dataclass(frozen=True)
class SolvedPreload:
    """The state at rest with the tractions of the case, and the other one for comparison.

    ``other`` is None if it does not exist; ``why`` is then the reason. ``unloaded`` are the pairs before the load in
    the unknowns of motions that are constant in time, ``operator`` (m, row_size) are their rows in all motions, and
    ``joint`` is that of ``case`` before the load.
    """

    case: Case
    joint: Joint
    unloaded: ContactPairs
    state: StaticState
    operator: FloatArray
    other: StaticState | None
    why: str = ""

    def pairs_about(self, state: StaticState, kept: bool) -> ContactPairs:
        """The contact pairs about one of the two states at rest, with its tractions ``kept`` or released."""
        pairs = state.about(self.unloaded, keep_traction=kept)
        pairs = ContactPairs.with_laws(self.operator, pairs.laws, pairs.members)
        return with_loaded_laws(self.joint, pairs, _load_range(self.case, self.joint, state.normal_force)[0])


def solve_preload(
    case: Case,
    joint: Joint,
    settings: Sequence[FaceSettings],
    substructure: Substructure,
    static_load: FloatArray,
    compare: bool = True,
) -> SolvedPreload:
    """The joint at rest under ``static_load`` (row_size,) N, and the other state to ``compare``. Raises
    ConvergenceError."""
    # Pairs that just touch, or stand apart by their gap.
    touching = replace(without_loaded_laws(joint), preload=-joint.normal_stiffness * joint.face_pairs.gap)
    operator, superelement = substructure.operator(joint.face_pairs), substructure.mean_structure()
    unloaded = touching.contact_pairs(rows_of_mean(operator, substructure.size))
    load = rows_of_mean(static_load, substructure.size)
    retained = case.preload.residual_traction == "kept"
    with single_library_thread(superelement.size):
        state = _state(case, joint, settings, superelement, unloaded, load, friction=retained)
        if not compare:
            return SolvedPreload(case, joint, unloaded, state, operator, None, "not computed")
        try:
            other = _state(case, joint, settings, superelement, unloaded, load, friction=not retained)
        except ConvergenceError as error:
            return SolvedPreload(case, joint, unloaded, state, operator, None, str(error))
    return SolvedPreload(case, joint, unloaded, state, operator, other)


def resting_joint(
    case: Case, joint: Joint, settings: Sequence[FaceSettings], state: StaticState, pairs: ContactPairs
) -> Joint:
    """The joint with the forces, gaps, stiffness and laws of its ``pairs`` about a state at rest."""
    faces = describe_faces(case, joint.layout, state.normal_force, settings)
    layout = joint.layout
    secant = any(own.is_pressed and face_allocation(case, own) == "pressure" for own in settings)
    if secant and case.preload.normal_law == "spring":
        layout = replace(layout, messages=(*layout.messages, SECANT_WARNING))
    return replace(
        joint,
        layout=layout,
        preload=state.preload,
        normal_stiffness=state.normal_stiffness,
        tangential_stiffness=np.where(
            np.isnan(state.tangential_stiffness), joint.tangential_stiffness, state.tangential_stiffness
        ),
        rough_faces=faces,
        laws=tuple(laws_at_rest(joint, pairs)),
        stiffness_warnings=_pressure_warnings(case, joint, settings, state),
    )


def _state(
    case: Case,
    joint: Joint,
    settings: Sequence[FaceSettings],
    superelement: Superelement,
    pairs: ContactPairs,
    load: FloatArray,
    friction: bool,
) -> StaticState:
    if not any(own.is_pressed for own in settings):
        return static_preload(superelement, pairs, load, friction=friction)

    def local(normal_force: FloatArray) -> tuple[FloatArray, FloatArray]:
        return pair_springs(case, joint.layout, _with_range(case, joint, settings, normal_force), settings)

    def local_of_each_pair(normal_force: FloatArray) -> tuple[FloatArray, FloatArray]:
        load = np.clip(normal_force, *_load_range(case, joint, normal_force))
        return pair_springs(case, joint.layout, load, settings, of_each_pair=True)

    state = static_preload(superelement, pairs, load, friction=friction, local_stiffness=local)
    if case.preload.normal_law == "spring":
        return state
    law = _pressure_gap_law(case, joint, settings, state)
    # The tangential stiffness of a pair follows its own pressure, as the slope of its curve does.
    normal, tangential = local_of_each_pair(state.normal_force)
    gap = -normal * joint.face_pairs.gap
    start = ContactPairs(pairs.operator, normal, tangential, joint.friction_coefficient, gap)
    return static_preload(
        superelement, start, load, friction=friction, local_stiffness=local_of_each_pair, normal_law=law
    )


def _mean_pressure(joint: Joint, normal_force: FloatArray) -> FloatArray:
    """(n_faces,) Pa."""
    pressure: FloatArray = joint.face_sum(normal_force) / joint.face_sum(joint.face_pairs.area)
    return pressure


def _pressure_range(case: Case, joint: Joint, normal_force: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n_faces,) Pa, below and above which the stiffness of a pair is constant; the mean pressure lies between."""
    mean = _mean_pressure(joint, normal_force)
    lowest, highest = LOWEST_PRESSURE * mean, np.full(mean.size, np.inf)
    for face, rough in enumerate(joint.rough_faces):
        section = case.roughness
        if rough is None or section is None:
            continue
        roughness = case_roughness(case, *joint.layout.face_materials[face])
        plastic = plastic_pressure(roughness, section, rough.reference_area)
        if plastic is None:
            continue
        if mean[face] <= plastic:
            highest[face] = max(HIGHEST_BELOW_PLASTIC * plastic, mean[face])
        else:
            lowest[face] = min(max(lowest[face], LOWEST_ABOVE_PLASTIC * plastic), mean[face])
    return lowest, highest


def _with_range(case: Case, joint: Joint, settings: Sequence[FaceSettings], normal_force: FloatArray) -> FloatArray:
    """Normal forces (n_pairs,) for the stiffness law: if it uses the pressure of each pair, in the range of its face.

    Open pairs have the lowest pressure too, so that their stiffness does not jump when they close.
    """
    own_pressure = np.array([own.is_pressed and face_allocation(case, own) == "pressure" for own in settings])
    bounded = np.clip(normal_force, *_load_range(case, joint, normal_force))
    return np.where(own_pressure[joint.face_pairs.face], bounded, normal_force)


def _load_range(case: Case, joint: Joint, normal_force: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n_pairs,) N of each pair under the lowest and the highest pressure of its face."""
    pairs = joint.face_pairs
    lowest, highest = _pressure_range(case, joint, normal_force)
    return lowest[pairs.face] * pairs.area, highest[pairs.face] * pairs.area


def _pressure_warnings(
    case: Case, joint: Joint, settings: Sequence[FaceSettings], state: StaticState
) -> tuple[str, ...]:
    """Messages of stiffness laws on the pressures at rest; on a pressure-gap curve each pair has its own."""
    if case.preload.normal_law == "spring":
        return pressure_warnings(joint.layout, _with_range(case, joint, settings, state.normal_force), settings)
    least, largest = _load_range(case, joint, state.normal_force)
    # The curve of pressure over closure begins at the lowest pressure.
    both = (
        *pressure_warnings(joint.layout, np.clip(state.normal_force, least, largest), settings, of_each_pair=True),
        *pressure_warnings(joint.layout, least, settings, of_each_pair=True),
    )
    return tuple(dict.fromkeys(both))


def _pressure_gap_law(case: Case, joint: Joint, settings: Sequence[FaceSettings], state: StaticState) -> NormalLaw:
    """Pressure over closure of each face, from its stiffness law; springs if its stiffness is an input."""
    pairs = joint.face_pairs
    lowest, highest = _pressure_range(case, joint, state.normal_force)
    highest = np.minimum(highest, HIGHEST_PRESSURE * _mean_pressure(joint, state.normal_force))
    laws: list[NormalLaw] = []
    for face, own in enumerate(settings):
        members = pairs.face == face
        area = pairs.area[members]
        if not own.is_pressed:
            laws.append(SpringLaw(joint.normal_stiffness[members]))
            continue
        stiffness = face_law(case, joint.layout, face, own).normal
        laws.append(PressureGapLaw.from_stiffness(area, stiffness, lowest[face], highest[face]))
    return FaceLaws(pairs.face, tuple(laws))
