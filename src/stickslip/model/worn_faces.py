"""Stiffness of the faces of a study while they wear: under their load at each moment, with a roughness that runs in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip.case.case import Case
from stickslip.contact.preload import face_sum
from stickslip.contact.stiffness.stiffness_law import StiffnessLaw
from stickslip.contact.stiffness.surface import sq
from stickslip.core.errors import ConvergenceError, InputError, RoughnessError
from stickslip.core.validation import FloatArray
from stickslip.model.joint import FaceSettings, Joint, face_allocation, pair_springs
from stickslip.model.rough_face import case_roughness, law_of_section, roughness_section, waves_of
from stickslip.model.solved_preload import LOWEST_PRESSURE


@dataclass(frozen=True)
class RunningIn:
    """Roughness that falls from Sq ``before`` (m) towards ``end`` with the mean worn depth h of a face:
    Sq(h) = end + (before - end) exp(-h / depth)."""

    before: float
    end: float
    depth: float

    def sq_after(self, worn: float) -> float:
        """Sq in m after a mean worn depth in m."""
        return self.end + (self.before - self.end) * math.exp(-worn / self.depth)

    @classmethod
    def of(cls, case: Case, end: float, depth: float) -> RunningIn:
        """The running-in of [roughness] towards Sq ``end`` over a ``depth``. Raises InputError if it would rise."""
        before = sq(*waves_of(roughness_section(case)))
        if not end < before:
            raise InputError(
                f"running_in_sq is {1e6 * end:.4g} um, but the faces have Sq {1e6 * before:.4g} um before "
                "the wear, and running in makes them smoother. Give a smaller running_in_sq.",
                ("analysis.running_in_sq",),
            )
        return cls(before, end, depth)


@dataclass(frozen=True)
class WornFaces:
    """The springs of the faces of a joint under any loads and worn depths: those at rest without wear, times the ratio
    of the stiffness law of each face to its value there.

    ``running_in`` None keeps the roughness.
    """

    case: Case
    joint: Joint
    settings: Sequence[FaceSettings]
    running_in: RunningIn | None = None

    def stiffness(self, normal_force: FloatArray, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Normal and tangential stiffness (n_pairs,) in N/m. Raises ConvergenceError where the law gives none."""
        joint = self.joint
        before = np.maximum(joint.preload, 0.0)
        try:
            fresh = pair_springs(self.case, joint.layout, self._with_floor(before), self.settings)
            worn = pair_springs(
                self.case, joint.layout, self._with_floor(normal_force), self.settings, self._laws_after(depth)
            )
        except RoughnessError as error:
            raise ConvergenceError(str(error)) from error
        return (
            joint.normal_stiffness * worn[0] / fresh[0],
            joint.tangential_stiffness * worn[1] / fresh[1],
        )

    def _laws_after(self, depth: FloatArray) -> dict[int, StiffnessLaw]:
        """The stiffness laws of the rough faces with their mean worn depths."""
        if self.running_in is None:
            return {}
        pairs, section = self.joint.face_pairs, roughness_section(self.case)
        area = face_sum(pairs.area, pairs.face)
        mean = face_sum(pairs.area * depth, pairs.face) / area
        laws = {}
        for face, own in enumerate(self.settings):
            if not own.is_rough:
                continue
            fresh = case_roughness(self.case, *self.joint.layout.face_materials[face])
            # Sq is proportional to G^(D-2): the spectrum keeps its form.
            worn = waves_of(section).with_sq(self.running_in.sq_after(float(mean[face])))
            rough = replace(fresh, fractal_roughness=worn.fractal_roughness)
            laws[face] = law_of_section(rough, section, float(area[face]))
        return laws

    def _with_floor(self, normal_force: FloatArray) -> FloatArray:
        """Loads (n_pairs,) N for the law: pairs with their own pressure, and faces that lose their load, have at least
        a small fraction of the mean pressure before the wear."""
        pairs = self.joint.face_pairs
        before = face_sum(np.maximum(self.joint.preload, 0.0), pairs.face)
        least = LOWEST_PRESSURE * before
        share = (least / face_sum(pairs.area, pairs.face))[pairs.face] * pairs.area
        own = np.array([each.is_pressed and face_allocation(self.case, each) == "pressure" for each in self.settings])
        is_bare = face_sum(normal_force, pairs.face) < least
        return np.where((own | is_bare)[pairs.face], np.maximum(normal_force, share), normal_force)
