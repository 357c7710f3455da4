"""The study file as one frozen, validated ``Case``, everything SI after load: a class for each kind of structure."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any, ClassVar, Self, cast, get_args

from pydantic import (
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from stickslip.case import toml_text as case_file
from stickslip.case.analysis import Analysis, ForcedAnalysis, WearAnalysis
from stickslip.case.case_content import CaseContent
from stickslip.case.consistency import (
    EntryError,
    coriolis_errors,
    damper_law_errors,
    excitation_errors,
    frd_errors,
    joint_errors,
    moving_pair_errors,
    place_errors,
    preload_errors,
    rotation_errors,
    unchosen_range_errors,
    unchosen_stiffness_errors,
    wear_errors,
)
from stickslip.case.cyclic_consistency import mistuning_errors, sector_errors
from stickslip.case.cyclic_sections import CyclicStructure, MistuningSection, TravellingWaveSection
from stickslip.case.damper_rules import damper_errors, with_two_blade_defaults
from stickslip.case.dotted_keys import parts_of_key, with_values
from stickslip.case.explained import explained
from stickslip.case.interface_sections import InterfaceSection, MatrixInterface, MeshInterfaceSection
from stickslip.case.law_keys import FaceStiffness, StiffnessLawKeys, table_file
from stickslip.case.own_sections import (
    BaseMotion,
    BodyName,
    BodySection,
    ForceSection,
    GravitySection,
    MatrixStructure,
    MeshRotationSection,
    MeshStructureSection,
    Name,
    OwnMaterialSection,
    OwnPreloadSection,
    PlaceSection,
    PressureSection,
    ResponseSection,
    RotationSection,
    SectorRotationSection,
    StaticLoadSection,
    TieSection,
    UnbalanceSection,
)
from stickslip.case.plain import titled_by_its_file, with_absolute_files
from stickslip.case.pressed_interfaces import PressedInterfaces
from stickslip.case.reference import ReferenceSection
from stickslip.case.section import instead_of, without_default
from stickslip.case.sections import (
    ContactStiffnessSection,
    DampingSection,
    FrictionSection,
    OutputSection,
    PreloadSection,
    ReductionSection,
    RoughnessSection,
    SolverSection,
    StructureSection,
    StudySection,
)
from stickslip.case.structure_kind import CaseOfSomeKind, Kind, kind_in
from stickslip.case.two_blade_sections import (
    Damper,
    DamperFrictionSection,
    ExcitationSection,
    GeometrySection,
    MaterialSection,
    MeshSection,
    TwoBladeStructureSection,
    WedgePreloadSection,
    WedgeSection,
)


class Case(CaseContent):
    """One study, validated, all values SI floats; what studies of every kind of structure have.

    Each kind is a class of its own with its sections: :class:`TwoBladeCase`, :class:`MeshCase`, :class:`MatrixCase`,
    :class:`CyclicCase`. ``Case()`` is the default study, of two blades. ``load_case(path)`` and
    ``Case.from_text(text)`` read a study file, ``Case.from_mapping`` the same as nested dictionaries; they raise
    StudyFileError with one line for each error.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    study: StudySection = StudySection()
    structure: StructureSection = TwoBladeStructureSection()
    analysis: Analysis = ForcedAnalysis()
    reduction: ReductionSection = ReductionSection()
    roughness: RoughnessSection | None = RoughnessSection()
    contact_stiffness: FaceStiffness | None = Field(default=None, description=ContactStiffnessSection.__doc__)
    friction: FrictionSection = FrictionSection()
    preload: PreloadSection = PreloadSection()
    damping: DampingSection = DampingSection()
    reference: ReferenceSection | None = Field(default=None, description=ReferenceSection.__doc__)
    solver: SolverSection = SolverSection()
    output: OutputSection = OutputSection()

    finer_faces: ClassVar[str] = "a finer mesh of the face"  # what gives a contact face more rows of pairs

    def __new__(cls, **sections: Any) -> Self:
        """A case of the class for its kind of structure."""
        kind = kind_in(sections)
        chosen = KINDS[kind] if cls is Case and kind in get_args(Kind) else cls
        return cast(Self, super().__new__(chosen))

    @model_validator(mode="wrap")
    @classmethod
    def _of_its_kind(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        if cls is not Case or isinstance(data, Case):
            return handler(data)
        return cast(Self, _class_of(data).model_validate(data))

    @model_validator(mode="before")
    @classmethod
    def _measured_stiffness_replaces_roughness(cls, data: Any) -> Any:
        return without_default(data, ("contact_stiffness",), "roughness")

    @model_validator(mode="after")
    def _sections_fit_each_other(self) -> Self:
        """Raise EntryError for the first entry that contradicts another one."""
        rotates = self.sections.get("rotation") is not None
        partial = moving_pair_errors(self.reduction, self.structure.kind, self.analysis, self.preload, rotates)
        for error in chain(self._misfits(), partial):
            raise error
        if isinstance(self.analysis, WearAnalysis):
            interfaces = self.sections.get("interfaces", {})
            for error in wear_errors(self.analysis, self.solver, self.preload, interfaces, self.has_rough_faces):
                raise error
        return self

    @field_validator("contact_stiffness")
    @classmethod
    def _one_source(cls, value: Any, info: ValidationInfo) -> Any:
        return instead_of(value, info, "roughness")

    @property
    def has_rough_faces(self) -> bool:
        """Whether the stiffness of any face follows from [roughness]."""
        return self.roughness is not None

    def _misfits(self) -> Iterator[EntryError]:
        """Contradictions between the sections of this kind."""
        return iter(())

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Self:
        """The case of nested dictionaries, section -> key -> value as in a study file. Raises StudyFileError."""
        return cls._validated(dict(data), source="the study", lines={})

    @classmethod
    def from_text(cls, text: str, source: str = "the study file") -> Self:
        """The case of a study file's text; ``source`` is its name in messages. Raises StudyFileError."""
        return cls._validated(case_file.parse_toml(text, source), source, case_file.key_lines(text))

    @classmethod
    def in_folder(cls, data: dict[str, Any], folder: Path, source: str, lines: Mapping[tuple[str, ...], int]) -> Self:
        """The case of a file in ``folder``: names of files become absolute. Raises StudyFileError."""
        return cls._validated(with_absolute_files(data, folder), source, lines)

    @classmethod
    def _validated(cls, data: dict[str, Any], source: str, lines: Mapping[tuple[str, ...], int]) -> Self:
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            own, problems = _class_of(data) if cls is Case else cls, error.errors(include_url=False)
            details = [part for each in problems for part in explained(each, data, own, KINDS)]
            raise case_file.report(details, source, data, Case.allowed_keys(), lines, Case.named_sections()) from error

    def __hash__(self) -> int:
        """Cases can be keys of dictionaries, although their named sections are dictionaries."""
        return hash(json.dumps(self.to_dict()))

    @classmethod
    def case_classes(cls) -> tuple[type[CaseContent], ...]:
        """The class itself; for ``Case`` those of every kind of structure."""
        return tuple(KINDS.values()) if cls is Case else (cls,)

    @property
    def input_files(self) -> dict[str, str]:
        """Key or name of an interface -> file that the case reads."""
        return {**self.structure.files, **table_file("contact_stiffness", self.contact_stiffness)}

    @classmethod
    def parts_of_key(cls, path: str) -> tuple[str, str, str, str]:
        """Section, name of the entry, section of constants and key, see :func:`parts_of_key`."""
        return parts_of_key(path, Case.named_sections())

    def replace(self, changes: Mapping[str, Any]) -> Self:
        """A validated copy with other values, ``case.replace({"preload.centrifugal_force": "300 N"})``.

        Keys are ``section.key`` or ``section.NAME.key``, constants of a law ``section.NAME.constants.key``; values as
        in a study file. Raises StudyFileError.
        """
        data = with_values(self.as_mapping(only_explicit=True), changes, self.sections, Case.named_sections())
        return cast(Self, Case.from_mapping(data))


class TwoBladeCase(Case):
    """A study of two blades and the damper between them: the parametric structure, and the default of a study.

    Sections as in a study file, all values in SI units; a wrong value raises StudyFileError (docs/studies.md).
    """

    structure: TwoBladeStructureSection = TwoBladeStructureSection()
    geometry: GeometrySection = GeometrySection()
    damper: Damper = WedgeSection()
    mesh: MeshSection = MeshSection()
    material: MaterialSection = MaterialSection()
    friction: DamperFrictionSection = DamperFrictionSection()
    preload: WedgePreloadSection = WedgePreloadSection()
    excitation: ExcitationSection = ExcitationSection()
    rotation: RotationSection | None = Field(default=None, description=RotationSection.__doc__)

    finer_faces: ClassVar[str] = "mesh.contact_columns = 8"

    @model_validator(mode="before")
    @classmethod
    def _keys_replace_defaults(cls, data: Any) -> Any:
        return with_two_blade_defaults(data)

    def _misfits(self) -> Iterator[EntryError]:
        yield from rotation_errors(self.rotation, self.analysis)
        loads = () if self.rotation is None else ("rotation",)
        follows = self.contact_stiffness is None or isinstance(self.contact_stiffness, StiffnessLawKeys)
        yield from preload_errors(self.preload, loads, follows)
        yield from damper_law_errors(self.friction, self.preload, isinstance(self.analysis, WearAnalysis))
        is_rough, stiffness = self.roughness is not None, self.contact_stiffness
        yield from damper_errors(self.damper, self.geometry, self.analysis, stiffness, is_rough)


class OwnCase(PressedInterfaces, Case):
    """A study of a structure of the user's own, with interfaces, excitations and responses that have names."""

    own_examples: ClassVar[Mapping[str, str | None]] = {
        "analysis.performance_curve": None,
        "analysis.over": '"interfaces.NAME.normal_load"',
    }

    material: OwnMaterialSection | None = None
    roughness: RoughnessSection | None = Field(default=None, description=RoughnessSection.__doc__)
    preload: OwnPreloadSection = OwnPreloadSection()
    interfaces: Mapping[Name, InterfaceSection]
    forces: dict[Name, ForceSection] = Field(default={}, description=ForceSection.__doc__)
    unbalance: dict[Name, UnbalanceSection] = Field(default={}, description=UnbalanceSection.__doc__)
    responses: dict[Name, ResponseSection] = Field(default={}, description=ResponseSection.__doc__)
    static_loads: dict[Name, StaticLoadSection] = Field(default={}, description=StaticLoadSection.__doc__)

    @model_validator(mode="before")
    @classmethod
    def _titled_by_its_file(cls, data: Any) -> Any:
        return titled_by_its_file(data)

    @property
    def places(self) -> dict[str, PlaceSection]:
        """section.NAME -> every place of the study."""
        return {
            f"{section}.{name}": place
            for section in ("forces", "responses", "static_loads", "unbalance")
            for name, place in self.sections[section].items()
        }

    @property
    def input_files(self) -> dict[str, str]:
        """Key or name of an interface -> file that the case reads."""
        listed = {name: getattr(each, "pairs", None) for name, each in self.interfaces.items()}
        found = {**super().input_files, **{name: file for name, file in listed.items() if file is not None}}
        for name, each in self.interfaces.items():
            found |= table_file(f"interfaces.{name}", each)
        return found

    def _own_misfits(self, loads: tuple[str, ...], excitations: Mapping[str, Any], has_areas: bool) -> Any:
        """Contradictions in the sections with static loads and with excitations."""
        yield from preload_errors(self.preload, loads, bool(self.pressed_interfaces))
        yield from joint_errors(self.interfaces, self.preload, self.pressed_interfaces)
        if self.roughness is None:
            yield from unchosen_stiffness_errors(self.rough_interfaces)
        harmonics = {name: force.harmonic for name, force in self.forces.items()}
        yield from excitation_errors(excitations, harmonics, self.solver)
        if not self.responses:
            yield EntryError(("responses",), "has no entry. Give at least one section [responses.NAME].")
        for section in ("forces", "responses", "static_loads", "unbalance"):
            yield from place_errors(section, self.sections[section], has_areas)
        yield from unchosen_range_errors(self.solver)


class SolidCase(OwnCase):
    """A study of bodies of a mesh, with interfaces, forces and responses on its sets of nodes and faces."""

    bodies: dict[BodyName, BodySection] = Field(default={}, description=BodySection.__doc__)
    interfaces: dict[Name, MeshInterfaceSection] = Field(default={}, description=MeshInterfaceSection.__doc__)
    ties: dict[Name, TieSection] = Field(default={}, description=TieSection.__doc__)


class MeshCase(SolidCase):
    """A study of bodies from a mesh file.

    Sections as in a study file, all values in SI units; a wrong value raises StudyFileError (docs/models.md).
    """

    structure: MeshStructureSection
    base_motion: BaseMotion | None = None
    pressures: dict[Name, PressureSection] = Field(default={}, description=PressureSection.__doc__)
    gravity: GravitySection | None = Field(default=None, description=GravitySection.__doc__)
    rotation: MeshRotationSection | None = Field(default=None, description=MeshRotationSection.__doc__)

    def _misfits(self) -> Iterator[EntryError]:
        yield from rotation_errors(self.rotation, self.analysis)
        loads = tuple(name for name in ("rotation", "gravity", "pressures", "static_loads") if getattr(self, name))
        excitations = {"forces": self.forces, "unbalance": self.unbalance, "base_motion": self.base_motion}
        yield from self._own_misfits(loads, excitations, has_areas=True)
        if self.rotation is not None and self.rotation.coriolis:
            yield from coriolis_errors(self.analysis)


class CyclicCase(SolidCase):
    """A study of a disk of equal sectors under a travelling wave: one sector is solved.

    Sections as in a study file, all values in SI units; a wrong value raises StudyFileError (docs/bladed_disks.md).
    """

    structure: CyclicStructure
    travelling_wave: TravellingWaveSection | None = Field(default=None, description=TravellingWaveSection.__doc__)
    rotation: SectorRotationSection | None = Field(default=None, description=SectorRotationSection.__doc__)
    mistuning: MistuningSection | None = Field(default=None, description=MistuningSection.__doc__)

    @property
    def input_files(self) -> dict[str, str]:
        """Key or name of an interface -> file that the case reads."""
        own = self.mistuning.file if self.mistuning is not None else None
        return super().input_files if own is None else {**super().input_files, "mistuning.file": own}

    def _misfits(self) -> Iterator[EntryError]:
        if self.travelling_wave is None:
            yield EntryError(
                ("travelling_wave",),
                "is missing. Give this section with engine_order, the number of waves round the disk.",
            )
        yield from frd_errors(self.output, "a sector of a disk")
        yield from rotation_errors(self.rotation, self.analysis)
        yield from sector_errors(self.analysis, self.damping, self.unbalance)
        if self.mistuning is not None:
            yield from mistuning_errors(self.mistuning, self.damping, self.forces, self.interfaces, self.rotation)
        loads = tuple(name for name in ("rotation", "static_loads") if getattr(self, name))
        yield from self._own_misfits(loads, {"forces": self.forces}, has_areas=True)


class MatrixCase(OwnCase):
    """A study of mass and stiffness matrices of another program, with contact pairs between their unknowns.

    Sections as in a study file, all values in SI units; a wrong value raises StudyFileError (docs/matrices.md).
    """

    structure: MatrixStructure
    interfaces: dict[Name, MatrixInterface] = Field(default={})

    def _misfits(self) -> Iterator[EntryError]:
        yield from frd_errors(self.output, "matrices")
        for key in ("fatigue_limit", "tensile_strength"):
            if self.material is not None and getattr(self.material, key) is not None:
                yield EntryError(("material", key), "belongs to the stress of a mesh; matrices have none. Remove it.")
        loads = ("static_loads",) if self.static_loads else ()
        yield from self._own_misfits(loads, {"forces": self.forces, "unbalance": self.unbalance}, has_areas=False)


KINDS: dict[str, type[Case]] = {
    "two-blade": TwoBladeCase,
    "mesh": MeshCase,
    "matrices": MatrixCase,
    "cyclic": CyclicCase,
}


def _class_of(data: Any) -> Any:
    """The class of the kind of structure in the mappings of a study file; TwoBladeCase where there is none."""
    kind = kind_in(data)
    return KINDS[kind] if kind in get_args(Kind) else CaseOfSomeKind
