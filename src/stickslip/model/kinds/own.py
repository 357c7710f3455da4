"""Common parts of studies of a user's own mesh or matrices: loads of faces, forces, responses, descriptions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Generic, TypeVar

import numpy as np

from stickslip.case.case import OwnCase
from stickslip.case.interface_sections import InterfaceSection
from stickslip.contact.preload import prescribed_preload
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.model.face_laws import NamedLaw, pressure_law
from stickslip.model.joint import STARTING_PRESSURE, FaceSettings
from stickslip.model.layout import BaseMotionOfSupport, Derived, GroupForce, GroupUnbalance, Layout, Output
from stickslip.model.rough_face import roughness_section
from stickslip.solve.excitation import TravellingWave

OwnCaseT = TypeVar("OwnCaseT", bound=OwnCase)


class OwnKind(Generic[OwnCaseT]):
    """Common parts of the kinds "mesh" and "matrices"."""

    def preload(self, case: OwnCaseT, layout: Layout) -> FloatArray:
        """(n_pairs,) N: each face's normal load with uniform pressure on the pairs that touch, or as prescribed; if it
        is solved, a starting pressure.

        Raises InputError for a wrong number of values, and for a load on a face whose pairs are all open.
        """
        pairs = layout.face_pairs
        if case.preload.method == "solved":
            return STARTING_PRESSURE * pairs.area
        if case.preload.values is not None:
            count = np.bincount(pairs.face)
            if len(case.preload.values) != pairs.n_pairs:
                parts = ", ".join(f"{n} of {name}" for n, name in zip(count, layout.face_names, strict=True))
                raise InputError(
                    f"preload.values has {len(case.preload.values)} entries, but there are {pairs.n_pairs} contact "
                    f"pairs ({parts}). Give one force for each, in this order, or normal_load of each interface "
                    "instead.",
                    ("preload.values",),
                )
            return self._prescribed(case, layout, prescribed_preload(case.preload.values, pairs.n_pairs))
        load = np.zeros(pairs.n_pairs)
        for face, (name, section) in enumerate(case.interfaces.items()):
            if section.normal_load is None and section.other_law is not None:
                continue  # neither its law nor its stiffness follows from a load
            touching = (pairs.face == face) & (pairs.gap <= 0.0)
            if section.normal_load is None or not touching.any():
                raise InputError(
                    f"interfaces.{name}: this face cannot carry the normal load, because all of its pairs have a gap "
                    f"of {1e3 * pairs.gap[pairs.face == face].min():.3g} mm or more. If the bodies touch and only "
                    'their meshes differ, set adjust = "closed".',
                    (f"interfaces.{name}.normal_load",),
                )
            load[touching] = section.normal_load * pairs.area[touching] / pairs.area[touching].sum()
        return load

    def _prescribed(self, case: OwnCaseT, layout: Layout, load: FloatArray) -> FloatArray:
        """The loads of all pairs. Raises InputError for one on a pair that nothing takes it from."""
        for face, (name, given) in enumerate(case.interfaces.items()):
            here = np.flatnonzero(layout.face_pairs.face == face)
            loaded = here[load[here] != 0.0]
            if loaded.size and not case.uses_load(name):
                raise InputError(
                    f"preload.values[{loaded[0]}] is {load[loaded[0]]:g} N, but interfaces.{name} follows the law "
                    f'"{given.other_law}", which has no normal load. Write 0 for each of its {here.size} pairs.',
                    ("preload.values",),
                )
        return load

    def face_settings(self, case: OwnCaseT) -> tuple[FaceSettings, ...]:
        """Laws, friction and stiffness of each interface, its own or those of [friction] and [contact_stiffness].

        Raises InputError for a stiffness law that cannot be made.
        """
        common = FaceSettings.of_case(case)
        settings = []
        for name, each in case.interfaces.items():
            section = f"interfaces.{name}"
            named = None
            if each.other_law is not None and each.constants is not None:
                named = NamedLaw(name, each.other_law, each.declaration, each.constants, section)
            stiffness, law = common.stiffness, common.pressure_law
            if each.has_own_stiffness:
                # A law may require one of the two alone; [contact_stiffness] gives the other one if it has it.
                given = (each.normal_stiffness, each.tangential_stiffness)
                own = tuple(a if a is not None else b for a, b in zip(given, common.stiffness or given, strict=True))
                stiffness = None if each.stiffness_law is not None else (own[0], own[1])
                law = pressure_law(each, section)
            friction = common.friction if each.friction is None else each.friction
            settings.append(FaceSettings(friction, stiffness, f"{section}.normal_load", law, named))
        return tuple(settings)

    def static_forces(self, case: OwnCaseT) -> tuple[GroupForce, ...]:
        """The constant forces."""
        return tuple(
            GroupForce(f"static_loads.{name}", each.direction, each.force) for name, each in case.static_loads.items()
        )

    def outputs(self, case: OwnCaseT) -> tuple[dict[str, Output], dict[str, tuple[str, ...]]]:
        """The responses, the first one that of the curve; all are drawn together."""
        named_outputs = {name: Output(f"responses.{name}", each.direction) for name, each in case.responses.items()}
        return named_outputs, {"Responses": tuple(named_outputs)}

    def facts(self, case: OwnCaseT) -> tuple[Derived, ...]:
        """None beside those of all joints."""
        return ()

    def warnings(self, case: OwnCaseT) -> tuple[str, ...]:
        """None."""
        return ()

    def rough_face_size(self, case: OwnCaseT) -> tuple[float, float]:
        """m: a patch as long as the longest wave of the surface, and a quarter as wide."""
        length = roughness_section(case).sample_length
        return length, 0.25 * length

    def forces(self, case: OwnCaseT) -> tuple[GroupForce, ...]:
        """The harmonic forces."""
        return tuple(
            GroupForce(f"forces.{name}", each.direction, each.amplitude, each.phase, each.harmonic)
            for name, each in case.forces.items()
        )

    def unbalances(self, case: OwnCaseT) -> tuple[GroupUnbalance, ...]:
        """The rotating unbalances."""
        return tuple(
            GroupUnbalance(f"unbalance.{name}", each.axis, each.mass_times_radius)
            for name, each in case.unbalance.items()
        )

    def base_motion(self, case: OwnCaseT) -> BaseMotionOfSupport | None:
        """The motion of the support, where the structure knows what it carries along."""
        return None

    def wave(self, case: OwnCaseT) -> TravellingWave | None:
        """How the forces travel round a disk; None for a structure."""
        return None

    def rotation_speed(self, case: OwnCaseT) -> float:
        """rad/s; 0 where nothing rotates."""
        return 0.0

    def load_sizes(self, case: OwnCaseT) -> Mapping[str, tuple[float, ...]]:
        """None: only meshes have distributed loads."""
        return {}

    def force_amplitude(self, case: OwnCaseT) -> float:
        """N of the largest force, or the size of what excites the structure instead, in its SI unit."""
        motion = self.base_motion(case)
        others = [each.mass_times_radius for each in case.unbalance.values()]
        others += [] if motion is None else [motion.amplitude]
        return max([each.amplitude for each in case.forces.values()] or others)

    def excitation_keys(self, case: OwnCaseT) -> dict[str, float]:
        """Key of each force, unbalance and motion of the support -> value in its SI unit."""
        motion = self.base_motion(case)
        return {
            **{f"forces.{name}.amplitude": each.amplitude for name, each in case.forces.items()},
            **{f"unbalance.{name}.mass_times_radius": each.mass_times_radius for name, each in case.unbalance.items()},
            **({} if motion is None else {"base_motion.amplitude": motion.amplitude}),
        }

    def description(self, case: OwnCaseT) -> str:
        """Excitations, normal loads and friction in one sentence."""
        joints = "; ".join(
            f"{name}: " + ", ".join(self._joint_words(case.interfaces[name], settings))
            for name, settings in zip(case.interfaces, self.face_settings(case), strict=True)
        )
        excitations = " and ".join(self._excitation_words(case))
        return f"{excitations[0].upper()}{excitations[1:]}. {joints}.{self._preload_words(case)}"

    def _joint_words(self, given: InterfaceSection, settings: FaceSettings) -> list[str]:
        """Load, and friction or the other law with its constants."""
        words = [] if given.normal_load is None else [f"normal load {given.normal_load:g} N"]
        if settings.contact_law is None:
            return [*words, f"friction {settings.friction:g}"]
        constants = settings.contact_law.constants.words()
        return [*words, f"law {settings.contact_law.name}" + (f" ({constants})" if constants else "")]

    def _excitation_words(self, case: OwnCaseT) -> list[str]:
        """Each kind of excitation that the study has, in words."""
        forces = [
            f"{each.amplitude:g} N at {name}" + (f" (harmonic {each.harmonic})" if each.harmonic > 1 else "")
            for name, each in case.forces.items()
        ]
        words = [f"Force {' and '.join(forces)}"] if forces else []
        words += [f"unbalance {each.mass_times_radius:g} kg m at {name}" for name, each in case.unbalance.items()]
        motion = self.base_motion(case)
        if motion is not None:
            unit = "m/s^2" if motion.kind == "acceleration" else "m"
            words.append(f"base {motion.kind} {motion.amplitude:g} {unit}")
        return words

    def _distributed_words(self, case: OwnCaseT) -> list[str]:
        """The distributed static loads in words."""
        return []

    def _preload_words(self, case: OwnCaseT) -> str:
        """What a preload that no interface gives comes from."""
        section = case.preload
        if section.method == "prescribed":
            return "" if section.values is None else " Prescribed preload."
        loads = [f"{each.force:g} N at {name}" for name, each in case.static_loads.items()]
        loads += self._distributed_words(case)
        return f" Preload solved from {' and '.join(loads)}, tractions at rest {section.residual_traction}."
