"""Checks that the sections of a study file do not contradict each other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from stickslip.case.analysis import AnalysisSection, ModeAnalysis, RidgeAnalysis, WearAnalysis
from stickslip.case.interface_sections import InterfaceSection, MeshInterfaceSection
from stickslip.case.own_sections import OwnPreloadSection, PlaceSection, RotationSection, SectorRotationSection
from stickslip.case.sections import OutputSection, PreloadSection, ReductionSection, SolverSection
from stickslip.case.two_blade_sections import ROTATING, DamperFrictionSection, WedgePreloadSection
from stickslip.contact.constants import FRICTION, GAP, NORMAL_LOAD, STIFFNESSES, Declaration
from stickslip.core.errors import InputError
from stickslip.core.resolution import SAMPLES_PER_HARMONIC

# The frequency range of [solver].
RANGE_KEYS = ("frequency_start", "frequency_stop")


class EntryError(InputError):
    """The entry ``path`` of a study file contradicts others."""

    def __init__(self, path: tuple[str, ...], sentence: str) -> None:
        super().__init__(sentence)
        self.path = path


def wear_errors(
    analysis: WearAnalysis,
    solver: SolverSection,
    preload: PreloadSection,
    interfaces: Mapping[str, InterfaceSection],
    has_roughness: bool,
) -> Iterator[EntryError]:
    """What contradicts the wear of a study."""
    low, high = sorted((solver.frequency_start, solver.frequency_stop))
    if analysis.wear_frequency is not None and not low <= analysis.wear_frequency <= high:
        yield EntryError(
            ("analysis", "wear_frequency"),
            f"is {analysis.wear_frequency:g} Hz, outside of the sweep from {low:g} to {high:g} Hz. Give a frequency of "
            "the sweep, or widen it.",
        )
    if preload.method == "solved" and preload.residual_traction == "kept":
        yield EntryError(
            ("preload", "residual_traction"),
            'is "kept", but wear removes the material that carries tractions. Set "released" for kind = "wear".',
        )
    for name, interface in interfaces.items():
        if interface.other_law is not None:
            yield _wearing_law(("interfaces", name, "law"), interface.other_law, interface.declaration)
    if analysis.running_in_sq is not None and not has_roughness:
        yield EntryError(
            ("analysis", "running_in_sq"),
            "requires the section [roughness], which runs in. Give it, or remove this key.",
        )


def moving_pair_errors(
    reduction: ReductionSection, kind: str, analysis: AnalysisSection, preload: PreloadSection, rotates: bool
) -> Iterator[EntryError]:
    """What reduction.pairs = "moving" does not allow: the frequency curve alone shows which pairs move."""
    if reduction.pairs != "moving":
        return
    words = 'reduction.pairs is "moving", which is for the frequency curve of a mesh at rest. Set pairs = "all"'
    if kind not in ("two-blade", "mesh"):
        yield EntryError(("reduction", "pairs"), f'is "moving", but structure.kind is "{kind}". Set pairs = "all".')
    if analysis.kind != "forced":
        yield EntryError(("analysis", "kind"), f'is "{analysis.kind}", but {words}, or kind = "forced".')
    for key in ("traction_band", "search", "gradients"):
        if getattr(analysis, key):
            yield EntryError(("analysis", key), f"is true, but {words}, or {key} = false.")
    if preload.method == "solved":
        yield EntryError(("preload", "method"), f'is "solved", but {words}, or method = "prescribed".')
    if rotates:
        yield EntryError(("rotation",), f"is given, but {words}, or remove this section.")


def _wearing_law(path: tuple[str, ...], law: str, declaration: Declaration) -> EntryError:
    """A law other than Coulomb's in a joint that wears."""
    if declaration.follows_load:
        return EntryError(
            path,
            f'is "{law}", but wear opens pairs, and this law has no open pairs. Remove the key: with Coulomb friction '
            "the stiffness of a rough face follows the load of each worn state too.",
        )
    return EntryError(
        path, f'is "{law}", but wear requires Coulomb friction: this law has no slip under a normal load. Change it.'
    )


def damper_law_errors(friction: DamperFrictionSection, preload: PreloadSection, wears: bool) -> Iterator[EntryError]:
    """What a contact law of the damper other than Coulomb's does not allow."""
    if friction.other_law is None:
        return
    if preload.method == "solved":
        law = f'friction.law is "{friction.other_law}"'
        if not friction.declaration.follows_load:
            yield EntryError(("preload", "method"), f'is "solved", but {law}, which requires "prescribed".')
        elif preload.normal_law == "spring":
            yield _needs_curve(law)
    if wears:
        yield _wearing_law(("friction", "law"), friction.other_law, friction.declaration)


def _needs_curve(law: str) -> EntryError:
    """A law that takes its load from the joint, under a preload that is solved with springs."""
    return EntryError(
        ("preload", "normal_law"),
        f'is "spring", but {law}, which requires the stiffness that each pair has under its own load. Set normal_law '
        '= "pressure-gap".',
    )


def preload_errors(preload: PreloadSection, loads: Sequence[str], pressed: bool) -> Iterator[EntryError]:
    """Keys that a prescribed preload does not use, and missing keys of a solved one.

    ``loads`` are the sections with static loads of the study; ``pressed`` says whether the stiffness of any face
    follows from its pressure.
    """
    if isinstance(preload, WedgePreloadSection):
        yield from _mass_errors(preload, rotates="rotation" in loads and preload.method == "solved")
    if preload.method == "prescribed":
        for name in loads:
            if name == "rotation":  # the structure has its stiffness at the speed
                continue
            yield EntryError((name,), 'applies only to preload.method = "solved". Set it, or remove the section.')
        for key in ("residual_traction", "normal_law"):
            if key in preload.model_fields_set and getattr(preload, key) != type(preload).model_fields[key].default:
                yield EntryError(("preload", key), 'belongs to method = "solved". Set the method, or remove the key.')
        return
    if preload.values is not None:
        yield EntryError(("preload", "values"), 'are a result of method = "solved". Remove one of the two.')
    wedge_force = None
    if isinstance(preload, WedgePreloadSection):
        wedge_force = preload.damper_force
        yield from _wedge_errors(preload, rotates="rotation" in loads)
    if wedge_force is None and not loads:
        yield EntryError(
            ("preload", "method"),
            'is "solved", but there is no static load. Give [static_loads.NAME], [pressures.NAME], [gravity] or '
            "[rotation], or for two blades preload.centrifugal_force.",
        )
    if preload.normal_law == "pressure-gap" and not pressed:
        yield EntryError(
            ("preload", "normal_law"),
            'is "pressure-gap", which requires a roughness or another law of stiffness over pressure. Give '
            "[roughness].",
        )


def _mass_errors(preload: WedgePreloadSection, rotates: bool) -> Iterator[EntryError]:
    """A part of the keys of a damper's mass, or a source of its load beside them."""
    given = [key for key in ROTATING if getattr(preload, key) is not None]
    lacking = [key for key in ROTATING if key not in given]
    if not given:
        return
    if lacking:
        yield EntryError(
            ("preload", lacking[0]),
            f"is missing: {given[0]} gives the centrifugal force only together with {' and '.join(lacking)}.",
        )
    elif not preload.damper_force:
        yield EntryError(("preload", "speed_of_rotation"), "is 0, so the damper has no centrifugal force. Raise it.")
    if preload.values is not None:
        yield EntryError(("preload", given[0]), "and preload.values are both given. Remove one of the two.")
    if rotates:
        yield EntryError(("preload", given[0]), "and [rotation] would load the damper twice. Remove one of the two.")


def _wedge_errors(preload: WedgePreloadSection, rotates: bool) -> Iterator[EntryError]:
    """Keys that would load the wedge under a solved preload twice."""
    if preload.friction_coefficient_at_assembly:
        yield EntryError(
            ("preload", "friction_coefficient_at_assembly"),
            'belongs to method = "prescribed"; a solved preload uses [friction]. Remove it.',
        )
    if preload.centrifugal_force is not None and rotates:
        yield EntryError(
            ("preload", "centrifugal_force"),
            "and [rotation] would load the damper twice. Remove one of the two.",
        )


def joint_errors(
    interfaces: Mapping[str, InterfaceSection], preload: OwnPreloadSection, pressed: Sequence[str]
) -> Iterator[EntryError]:
    """Interfaces without stiffness or load, with two, or with keys that their contact law has no use for.

    ``pressed`` are the names of those whose stiffness follows from their pressure.
    """
    if not interfaces:
        yield EntryError(
            ("interfaces",),
            'has no entry. Give at least one section [interfaces.NAME]; in a file of "stickslip new --from", complete '
            "its lines with # GIVE.",
        )
    for name, each in interfaces.items():
        where = ("interfaces", name)
        solved = preload.method == "solved"
        if solved and each.other_law is not None:
            yield from _static_load_errors(name, each, pressed, preload.normal_law)
        yield from _useless_keys(where, each)
        yield from _stiffness_errors(where, each)
        needs_load = each.other_law is None or each.declaration.needs(NORMAL_LOAD) or name in pressed
        if needs_load and each.normal_load is None and preload.values is None and not solved:
            yield EntryError((*where, "normal_load"), "is missing. Give the normal force on this face at rest.")
        if not needs_load and each.normal_load is not None and NORMAL_LOAD not in each.declaration.of_joint:
            yield EntryError(
                (*where, "normal_load"),
                f'has no effect: neither the law "{each.other_law}" nor the stiffness of this face depends on it. '
                "Remove it.",
            )
        if each.normal_load is not None and preload.values is not None:
            yield EntryError((*where, "normal_load"), "and preload.values are both given. Remove one of the two.")
        if each.normal_load is not None and solved:
            yield EntryError((*where, "normal_load"), 'is a result of preload.method = "solved". Remove it.')


def _static_load_errors(
    name: str, interface: InterfaceSection, pressed: Sequence[str], normal_law: str
) -> Iterator[EntryError]:
    """What a solved preload cannot do for an interface with another law than Coulomb's."""
    law = f'is "solved", and interfaces.{name} has the law "{interface.other_law}"'
    if interface.declaration.follows_load:
        if name not in pressed:
            yield EntryError(
                ("preload", "method"),
                f"{law}, which requires the stiffness that each pair has under its own load. Give [roughness] or a "
                "stiffness_law instead of its normal_stiffness and tangential_stiffness.",
            )
        elif normal_law == "spring":
            yield _needs_curve(f'interfaces.{name} has the law "{interface.other_law}"')
        return
    if pressed:
        yield EntryError(
            ("preload", "method"),
            f"{law}. In a joint with such a law, the stiffness must not depend on the pressure, but that of "
            f"interfaces.{pressed[0]} does. Give its normal_stiffness and tangential_stiffness.",
        )
    if NORMAL_LOAD in interface.declaration.of_joint:
        yield EntryError(
            ("preload", "method"),
            f'{law}, which requires prescribed normal loads. Use method = "prescribed" and normal_load.',
        )


def _useless_keys(where: tuple[str, str], interface: InterfaceSection) -> Iterator[EntryError]:
    """Keys of an interface that its contact law has no use for."""
    if interface.other_law is None:
        if not isinstance(interface, MeshInterfaceSection) and getattr(interface, GAP, None) is not None:
            yield EntryError(
                (*where, GAP),
                "between matrices is for contact laws with their own gap, such as elastic-stop. Give law, or for "
                "Coulomb friction a gap in preload.values (N below 0).",
            )
        return
    of_joint = interface.declaration.of_joint
    homes = {GAP: GAP, "friction": FRICTION, **{key: key for key in STIFFNESSES}}
    homes |= {key: STIFFNESSES[0] for key in ("stiffness_law",) if not interface.needs_stiffness}
    for key, constant in homes.items():
        if getattr(interface, key, None) is not None and constant not in of_joint:
            yield EntryError((*where, key), f'has no effect on the law "{interface.other_law}". Remove it.')


def _stiffness_errors(where: tuple[str, str], interface: InterfaceSection) -> Iterator[EntryError]:
    """Half a stiffness, or two of them."""
    given = [key for key in STIFFNESSES if getattr(interface, key) is not None]
    lacking = [key for key in STIFFNESSES if key not in given and interface.requires(key)]
    if given and lacking:
        yield EntryError((*where, lacking[0]), "is missing: give both stiffnesses of a face, or none.")
    if given and interface.stiffness_law is not None:
        yield EntryError((*where, given[0]), "and stiffness_law are both given. Remove one.")


def rotation_errors(
    rotation: RotationSection | SectorRotationSection | None, analysis: AnalysisSection
) -> Iterator[EntryError]:
    """A speed above the highest one of the reduction, and gradients with a reduction for several speeds."""
    if rotation is not None and rotation.top_speed is not None and analysis.gradients:
        yield EntryError(
            ("rotation", "top_speed"),
            "gives one reduction for several speeds, which has no gradients. Remove it, or analysis.gradients.",
        )
    if rotation is not None and rotation.top_speed is not None and not rotation.speed <= rotation.top_speed > 0.0:
        shown = 60.0 / (2.0 * math.pi)
        yield EntryError(
            ("rotation", "top_speed"),
            f"is {shown * rotation.top_speed:g} rpm, but it must be above 0 and at least speed, "
            f"{shown * rotation.speed:g} rpm. Raise it, or remove it.",
        )


def coriolis_errors(analysis: AnalysisSection) -> Iterator[EntryError]:
    """Analyses that are not valid with Coriolis forces."""
    wrong = "and rotation.coriolis is true: this analysis has no Coriolis forces. Set coriolis to false."
    if isinstance(analysis, (ModeAnalysis, RidgeAnalysis)):
        yield EntryError(("analysis", "kind"), f'is "{analysis.kind}", {wrong}')
    if analysis.gradients:
        yield EntryError(("analysis", "gradients"), f"is true, {wrong}")


def frd_errors(output: OutputSection, structure: str) -> Iterator[EntryError]:
    """A result file of CalculiX of a ``structure`` whose stress is not computed."""
    if output.frd:
        yield EntryError(("output", "frd"), f"is true, but the stress of {structure} is not computed. Remove the key.")


def unchosen_stiffness_errors(interfaces: Sequence[str]) -> Iterator[EntryError]:
    """Interfaces whose stiffness nobody has chosen: the default roughness is that of the two-blade structure."""
    for name in interfaces:
        yield EntryError(
            ("interfaces", name),
            "has no contact stiffness. Give the section [roughness] of your faces (sq and sample_length of a drawing, "
            "or a measurement), or for this interface normal_stiffness and tangential_stiffness, or stiffness_law.",
        )


def unchosen_range_errors(solver: SolverSection) -> Iterator[EntryError]:
    """A range of frequencies that nobody has chosen: the default one is that of the two-blade structure."""
    for key in RANGE_KEYS:
        if key not in solver.model_fields_set:
            yield EntryError(
                ("solver", key),
                'is missing: only the two-blade structure has a default range. "stickslip check" of this file proposes '
                'one, and "stickslip new FILE --from STUDY" writes it.',
            )


def place_errors(section: str, places: Mapping[str, PlaceSection], has_areas: bool) -> Iterator[EntryError]:
    """Places that are ambiguous or missing; ``has_areas`` is True if the structure has areas."""
    for name, place in places.items():
        where = (section, name)
        choices = [key for key in ("set", "point", "node") if getattr(place, key) is not None]
        if len(choices) != 1:
            problem = " and ".join(choices) if choices else "none"
            yield EntryError(where, f"must have exactly one of set, point and node, but has {problem}.")
        if place.spread is not None and place.set is None:
            yield EntryError((*where, "spread"), "applies to the nodes of a set, but there is no set. Remove it.")
        if place.spread == "area" and not has_areas:
            yield EntryError((*where, "spread"), 'is "area", but matrices have no areas. Use "equal".')


def excitation_errors(
    excitations: Mapping[str, Any], harmonics: Mapping[str, int], solver: SolverSection
) -> Iterator[EntryError]:
    """A missing excitation, and forces in harmonics that the solver does not have.

    ``excitations`` are the sections that can excite the structure, ``harmonics`` those of the forces.
    """
    if not any(excitations.values()):
        yield EntryError(("forces",), "has no entry. Give at least one section [forces.NAME].")
    if solver.harmonics is None:
        most = solver.samples // SAMPLES_PER_HARMONIC
        limit = f"solver.accuracy allows only {most} harmonics with solver.samples = {solver.samples}. Raise samples."
    else:
        most = solver.harmonics
        limit = f"the solver uses only solver.harmonics = {most}. Raise it."
    for name, harmonic in harmonics.items():
        if harmonic > most:
            yield EntryError(("forces", name, "harmonic"), f"is {harmonic}, but {limit}")
