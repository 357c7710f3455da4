"""The joint of a study: preload, friction and stiffness of its contact pairs, face by face."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.case.case import Case
from stickslip.case.law_keys import StiffnessLawSection
from stickslip.case.values import unusual_values
from stickslip.contact.constants import FRICTION, GAP, NORMAL_LOAD, STIFFNESSES
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.exponential import ExponentialContact
from stickslip.contact.law.law import ContactLaw
from stickslip.contact.pairing.pairing import FacePairs
from stickslip.contact.preload import area_fraction, face_sum
from stickslip.contact.stiffness.hertz_line import HertzLine, HertzLineStiffness
from stickslip.contact.stiffness.stiffness_law import Allocation, StiffnessLaw, pair_pressure, springs_of_pairs
from stickslip.core.errors import InputError, concerning
from stickslip.core.plausible import OddValue
from stickslip.core.units import LARGEST_STIFFNESS
from stickslip.core.validation import FloatArray
from stickslip.model.face_laws import NamedLaw, PressureLaw, pressure_law
from stickslip.model.layout import Layout
from stickslip.model.rough_face import (
    RoughFace,
    case_roughness,
    jump_warning,
    law_of_section,
    plastic_pressure,
    rough_face,
    roughness_section,
)
from stickslip.structure.mesh import IntArray

# Pa; chosen: start of the iteration of the contact stiffness where the preload is solved.
STARTING_PRESSURE = 3e6
# chosen: between pairs with 1.5 % and ten times the mean pressure, Persson's law has a ratio of 2.
LARGEST_LENGTH_RATIO = 3.0


@dataclass(frozen=True)
class FaceSettings:
    """Friction of one face, and its stiffness (normal, tangential) in N/m; None where it follows from the pressure.

    One of the two is None where only that is given which the contact law must have. ``pressure_law`` is the law of the
    stiffness over the pressure, None for that of [roughness]; ``contact_law`` is None for Coulomb friction. ``line`` is
    the contact of a face that is a line, whose strip has the width ``layout.line_width``.
    """

    friction: float
    stiffness: tuple[float | None, float | None] | None
    load_key: str = "preload.centrifugal_force"  # the key of the study file that gives the face its load
    pressure_law: PressureLaw | None = None
    contact_law: NamedLaw | None = None
    line: HertzLine | None = None

    @classmethod
    def of_case(cls, case: Case) -> FaceSettings:
        """The settings of [friction] and [contact_stiffness]. Raises InputError for a law that cannot be made."""
        section, friction = case.contact_stiffness, case.friction.coefficient
        if isinstance(section, StiffnessLawSection):
            return cls(friction, None, pressure_law=pressure_law(section, "contact_stiffness"))
        stiffness = None if section is None else (section.normal_stiffness, section.tangential_stiffness)
        return cls(friction, stiffness)

    @property
    def needs_stiffness(self) -> bool:
        """Whether the contact law takes a stiffness of the joint."""
        return self.contact_law is None or self.contact_law.declaration.needs(*STIFFNESSES)

    @property
    def is_pressed(self) -> bool:
        """Whether the stiffness follows from the pressure."""
        return self.stiffness is None and self.needs_stiffness

    @property
    def is_rough(self) -> bool:
        """Whether the stiffness follows from [roughness]."""
        return self.is_pressed and self.pressure_law is None and self.line is None


@dataclass(frozen=True)
class Joint:
    """Constants of the contact pairs before any reduction: they follow from geometry, roughness and load alone."""

    layout: Layout
    preload: FloatArray  # (n_pairs,) N
    friction_coefficient: FloatArray  # (n_pairs,)
    normal_stiffness: FloatArray  # (n_pairs,) N/m
    tangential_stiffness: FloatArray  # (n_pairs,) N/m
    rough_faces: tuple[RoughFace | None, ...]  # one for each face; None where the stiffness is an input
    laws: tuple[tuple[NamedLaw, ContactLaw, IntArray], ...] = ()  # those beside Coulomb friction, with their pairs
    stiffness_warnings: tuple[str, ...] = ()  # messages of the stiffness laws of faces on their pressures

    @property
    def face_pairs(self) -> FacePairs:
        """The contact pairs."""
        return self.layout.face_pairs

    @property
    def face_names(self) -> tuple[str, ...]:
        """Name of each face."""
        return self.layout.face_names

    @property
    def closed_at_rest(self) -> NDArray[np.bool_]:
        """(n_pairs,) True where the preload presses the pair together, or its law has a spring at rest."""
        closed = self.preload > 0.0
        for _, law, members in self.laws:
            closed[members] = law.resting_springs().any(axis=1)
        return closed

    @property
    def resting_springs(self) -> FloatArray:
        """(3 * n_pairs,) N/m: t1, t2, n of each pair that is closed at rest, stuck; 0 for a pair that is open at rest.

        Equal to :meth:`ContactPairs.resting_stiffness`, for a joint without operator.
        """
        springs = np.column_stack([self.tangential_stiffness, self.tangential_stiffness, self.normal_stiffness])
        springs *= self.closed_at_rest[:, None]
        for _, law, members in self.laws:
            springs[members] = law.resting_springs()
        return springs.ravel()

    @property
    def faces_with_least_stiffness(self) -> tuple[bool, ...]:
        """(n_faces,) whether all spots of a face are plastic, so that the fractal law has another branch there."""
        return tuple(face is not None and face.has_least_stiffness for face in self.rough_faces)

    def contact_pairs(self, operator: FloatArray) -> ContactPairs:
        """The pairs as the solver takes them, with their operator (3 * n_pairs, n)."""
        coulomb = np.setdiff1d(np.arange(self.preload.size), [pair for _, _, group in self.laws for pair in group])
        if coulomb.size == self.preload.size:
            return ContactPairs(
                operator,
                self.normal_stiffness,
                self.tangential_stiffness,
                self.friction_coefficient,
                self.preload,
            )
        laws, members = [law for _, law, _ in self.laws], [group for _, _, group in self.laws]
        if coulomb.size:
            friction = CoulombLaw.with_preload(
                coulomb.size,
                self.normal_stiffness[coulomb],
                self.tangential_stiffness[coulomb],
                self.friction_coefficient[coulomb],
                self.preload[coulomb],
            )
            laws, members = [friction, *laws], [coulomb, *members]
        return ContactPairs.with_laws(operator, laws, members)

    def law_of(self, face: int) -> tuple[NamedLaw, ContactLaw] | None:
        """The law of a face and what the study says of it; None for Coulomb friction."""
        laws = ((named, law) for named, law, _ in self.laws if named.interface == self.face_names[face])
        return next(laws, None)

    def face_sum(self, values: FloatArray) -> FloatArray:
        """Sum of a value of the pairs for each face (n_faces,)."""
        return face_sum(values, self.face_pairs.face)


def make_joint(case: Case, layout: Layout, preload: FloatArray, settings: Sequence[FaceSettings]) -> Joint:
    """Stiffness of each face from its settings, or from the roughness and the preload.

    Raises RoughnessError where the roughness gives no usable contact.
    """
    pairs = layout.face_pairs
    friction = np.array([each.friction for each in settings])[pairs.face]
    rough_faces = describe_faces(case, layout, preload, settings)
    normal, tangential = pair_springs(case, layout, preload, settings)
    laws = _laws_beside_friction(layout, preload, settings, normal, tangential)
    # The starting pressure of a solved preload gives no warnings; its solution does.
    solved = case.preload.method == "solved"
    warnings = (
        ()
        if solved
        else (
            *pressure_warnings(layout, preload, settings),
            *_jump_warnings(case, layout, preload, settings, rough_faces),
            *_length_warnings(case, settings, layout, laws),
        )
    )
    # A pair with a gap closes when it has moved by its gap; before that it has no load. The starting pressure of a
    # solved preload is on all pairs, only for the stiffness of rough faces.
    unloaded = (preload == 0.0) | solved
    preload = np.where((pairs.gap > 0.0) & unloaded, -normal * pairs.gap, preload)
    for _, law, members in laws:
        preload[members] = law.normal_load
    return Joint(layout, preload, friction, normal, tangential, rough_faces, laws, warnings)


def _laws_beside_friction(
    layout: Layout, preload: FloatArray, settings: Sequence[FaceSettings], normal: FloatArray, tangential: FloatArray
) -> tuple[tuple[NamedLaw, ContactLaw, IntArray], ...]:
    """The contact laws that faces name, with their pairs. Raises InputError that names the key."""
    pairs, of_faces = layout.face_pairs, []
    for face, own in enumerate(settings):
        if own.contact_law is None:
            continue
        members = np.flatnonzero(pairs.face == face)
        joint = {
            NORMAL_LOAD: preload[members],
            GAP: pairs.gap[members],
            FRICTION: np.full(members.size, own.friction),
        }
        given = own.stiffness or (None, None)
        for name, values, value in zip(STIFFNESSES, (normal, tangential), given, strict=True):
            if own.is_pressed or value is not None:
                joint[name] = values[members]
        of_faces.append((own.contact_law, own.contact_law.of_pairs(pairs, members, joint), members))
    return tuple(of_faces)


def _length_warnings(
    case: Case,
    settings: Sequence[FaceSettings],
    layout: Layout,
    laws: Sequence[tuple[NamedLaw, ContactLaw, IntArray]],
) -> Iterator[str]:
    """Sentences on faces whose pairs of the exponential law have the same stiffness under very different loads."""
    for named, law, members in laws:
        own = settings[layout.face_pairs.face[members[0]]]
        if not isinstance(law, ExponentialContact) or (own.is_pressed and face_allocation(case, own) == "pressure"):
            continue
        if law.length.max() > LARGEST_LENGTH_RATIO * law.length.min():
            yield (
                f"{named.interface}: the normal force of its pairs grows by the factor e over "
                f"{1e6 * law.length.min():.3g} to {1e6 * law.length.max():.3g} um. A rough face has nearly one such "
                'length: use [roughness] or a stiffness_law with allocation = "pressure", so that the stiffness of '
                "each pair follows its own load."
            )


def pressure_warnings(
    layout: Layout, load: FloatArray, settings: Sequence[FaceSettings], of_each_pair: bool = False
) -> tuple[str, ...]:
    """What the stiffness laws that the study names say of the pressures under the loads (n_pairs,) N.

    ``of_each_pair``: pairs have their own pressure whatever the allocation of the face.
    """
    pairs, sentences = layout.face_pairs, []
    for face, own in enumerate(settings):
        law = _own_law(layout, own)
        if law is None or not own.is_pressed:
            continue
        members = pairs.face == face
        allocation = "pressure" if of_each_pair or own.pressure_law is None else own.pressure_law.allocation
        pressure = pair_pressure(pairs.area[members], load[members], allocation)
        name = layout.face_names[face]
        sentences += [f"{name}: {sentence}" for sentence in law.valid(np.unique(pressure))]
    return tuple(sentences)


def _jump_warnings(
    case: Case,
    layout: Layout,
    preload: FloatArray,
    settings: Sequence[FaceSettings],
    rough_faces: Sequence[RoughFace | None],
) -> Iterator[str]:
    """Sentences on rough faces whose law jumps between the pressures of their pairs."""
    pairs = layout.face_pairs
    for face, (own, rough) in enumerate(zip(settings, rough_faces, strict=True)):
        if rough is None or face_allocation(case, own) != "pressure":
            continue
        roughness = case_roughness(case, *layout.face_materials[face])
        plastic, members = (
            plastic_pressure(roughness, roughness_section(case), rough.reference_area),
            pairs.face == face,
        )
        if plastic is not None:
            sentence = jump_warning(plastic, pair_pressure(pairs.area[members], preload[members], "pressure"))
            if sentence is not None:
                yield f"{layout.face_names[face]}: {sentence}"


def describe_faces(
    case: Case, layout: Layout, preload: FloatArray, settings: Sequence[FaceSettings]
) -> tuple[RoughFace | None, ...]:
    """Contact stiffness and regime of each rough face under its load; None for a face with a stiffness of its own."""
    pairs = layout.face_pairs
    faces: list[RoughFace | None] = []
    for face, own in enumerate(settings):
        section, members = case.roughness, pairs.face == face
        if not own.is_rough or section is None:
            faces.append(None)
            continue
        area, load = float(pairs.area[members].sum()), float(np.maximum(preload[members], 0.0).sum())
        with concerning(*_stiffness_keys(case, own)):
            faces.append(rough_face(case_roughness(case, *layout.face_materials[face]), section, area, load))
    return tuple(faces)


def pair_springs(
    case: Case,
    layout: Layout,
    preload: FloatArray,
    settings: Sequence[FaceSettings],
    laws: Mapping[int, StiffnessLaw] | None = None,
    of_each_pair: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Normal and tangential stiffness (n_pairs,) in N/m under the loads ``preload`` (n_pairs,) in N.

    ``laws`` are those of some faces, in place of their own. ``of_each_pair``: pairs have their own pressure whatever
    the allocation of the face. Raises RoughnessError where the roughness gives no usable
    contact.
    """
    pairs = layout.face_pairs
    share = area_fraction(pairs.area, pairs.face)
    normal, tangential = np.zeros(pairs.n_pairs), np.zeros(pairs.n_pairs)
    for face, own in enumerate(settings):
        members = pairs.face == face
        if not own.needs_stiffness and own.stiffness is None:
            continue
        if own.stiffness is not None:
            normal[members], tangential[members] = ((value or 0.0) * share[members] for value in own.stiffness)
            continue
        law = (laws or {}).get(face) or face_law(case, layout, face, own)
        with concerning(*_stiffness_keys(case, own)):
            normal[members], tangential[members] = springs_of_pairs(
                law, pairs.area[members], preload[members], "pressure" if of_each_pair else face_allocation(case, own)
            )
            _require_possible(layout.face_names[face], float(normal[members].sum()), float(tangential[members].sum()))
    return normal, tangential


def _require_possible(name: str, *stiffness: float) -> None:
    """Raise InputError for a face that is stiffer than any joint; with a wrong unit a table gives such values."""
    for value in stiffness:
        if value > LARGEST_STIFFNESS:
            raise InputError(
                f"{name}: the stiffness law gives the face {value:.3g} N/m, but at most {LARGEST_STIFFNESS:g} N/m is "
                "possible. Check the units of the law and of the normal load. If the roughness is pressed flat "
                "(complete contact), connect the bodies there, or give the stiffness."
            )


def face_allocation(case: Case, settings: FaceSettings) -> Allocation:
    """Whether the pairs of a face take its mean pressure, or each its own."""
    given = settings.pressure_law
    if given is None and settings.line is not None:
        return "pressure"
    return roughness_section(case).allocation if given is None else given.allocation


def face_law(case: Case, layout: Layout, face: int, settings: FaceSettings) -> StiffnessLaw:
    """The stiffness law of a face that has no stiffness of its own. Raises InputError."""
    own = _own_law(layout, settings)
    if own is not None:
        return own
    section = roughness_section(case)
    if section.reference_area is not None and section.allocation != "pressure":
        raise InputError(
            f'reference_area belongs to allocation "pressure", but allocation is "{section.allocation}".',
            ("roughness.reference_area",),
        )
    area = float(layout.face_pairs.area[layout.face_pairs.face == face].sum())
    return law_of_section(case_roughness(case, *layout.face_materials[face]), section, area)


def _own_law(layout: Layout, settings: FaceSettings) -> StiffnessLaw | None:
    """The stiffness law of a face that does not follow from [roughness]; None where it does, or is an input."""
    if settings.pressure_law is not None:
        return settings.pressure_law.law
    if settings.line is None or layout.line_width is None:
        return None
    return HertzLineStiffness(settings.line, layout.line_width)


def _stiffness_keys(case: Case, settings: FaceSettings) -> tuple[str, ...]:
    """Keys that determine the stiffness of a face: the roughness or its law, and the source of its load."""
    if case.preload.method == "solved":
        load = "preload.method"
    elif case.preload.values is not None:
        load = "preload.values"
    else:
        load = settings.load_key
    if settings.pressure_law is None:
        return "roughness" if settings.line is None else "damper", load
    return settings.pressure_law.section, load


def odd_values(case: Case, layout: Layout) -> tuple[OddValue, ...]:
    """Values of the study file and of the structure that only a wrong unit explains."""
    return (*unusual_values(case), *layout.odd_values)
