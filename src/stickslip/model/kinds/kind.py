"""Interface of a kind of structure: its structure and joints, loads, responses and descriptions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, TypeVar

from stickslip.case.case import Case
from stickslip.core.validation import FloatArray
from stickslip.model.joint import FaceSettings
from stickslip.model.layout import BaseMotionOfSupport, Derived, GroupForce, GroupUnbalance, Layout, Output, Setup
from stickslip.solve.excitation import TravellingWave
from stickslip.structure.mesh import Mesh

CaseT = TypeVar("CaseT", bound=Case, contravariant=True)


class Kind(Protocol[CaseT]):
    """One kind of structure; it is registered in :data:`stickslip.model.model.KINDS` under the class of its cases."""

    def set_up(self, case: CaseT) -> Setup:
        """Mesh or matrices, and the layout on them. Raises InputError."""

    def find_layout(self, case: CaseT, mesh: Mesh) -> Layout:
        """The layout on an existing mesh. Raises InputError."""

    def preload(self, case: CaseT, layout: Layout) -> FloatArray:
        """(n_pairs,) N at rest. Raises InputError."""

    def face_settings(self, case: CaseT) -> tuple[FaceSettings, ...]:
        """Friction and stiffness of each face."""

    def rotation_speed(self, case: CaseT) -> float:
        """rad/s; 0 where nothing rotates."""

    def load_sizes(self, case: CaseT) -> Mapping[str, tuple[float, ...]]:
        """Sizes of each distributed static load of the layout, by the name of its section; N = unit load times size."""

    def static_forces(self, case: CaseT) -> tuple[GroupForce, ...]:
        """The constant forces, beside distributed loads."""

    def forces(self, case: CaseT) -> tuple[GroupForce, ...]:
        """The harmonic forces."""

    def unbalances(self, case: CaseT) -> tuple[GroupUnbalance, ...]:
        """The rotating unbalances."""

    def base_motion(self, case: CaseT) -> BaseMotionOfSupport | None:
        """The motion of the support; None if it is fixed."""

    def wave(self, case: CaseT) -> TravellingWave | None:
        """How the harmonic forces travel round a disk; None for a structure."""

    def outputs(self, case: CaseT) -> tuple[dict[str, Output], dict[str, tuple[str, ...]]]:
        """Name -> output, the response of the curve first; heading -> names in one plot."""

    def force_amplitude(self, case: CaseT) -> float:
        """N, the force by which a response is divided to compare several forces."""

    def excitation_keys(self, case: CaseT) -> dict[str, float]:
        """Key of each size of the excitation -> value in its SI unit; the response is proportional to all together."""

    def description(self, case: CaseT) -> str:
        """One sentence on excitation, load and friction."""

    def facts(self, case: CaseT) -> tuple[Derived, ...]:
        """(name, value, unit, explanation) of this kind, beside those of all joints."""

    def warnings(self, case: CaseT) -> tuple[str, ...]:
        """Sentences on values that are allowed but doubtful."""

    def rough_face_size(self, case: CaseT) -> tuple[float, float]:
        """m along and across a face, for a picture of its roughness."""
