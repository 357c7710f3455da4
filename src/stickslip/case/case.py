"""The study file as one frozen, validated ``Case``, everything SI after load."""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_validator, model_validator

from stickslip.case import toml_text as case_file
from stickslip.case.consistency import require_fit
from stickslip.case.own_sections import (
    FILE_KEYS,
    FOREIGN_KEYS,
    BodyName,
    BodySection,
    ForceSection,
    InterfaceSection,
    Name,
    ResponseSection,
    RotationSection,
    StaticLoadSection,
    StructureSection,
    without_other_kinds,
)
from stickslip.case.sections import (
    ContactStiffnessSection,
    DampingSection,
    ExcitationSection,
    FrictionSection,
    GeometrySection,
    MaterialSection,
    MeshSection,
    OutputSection,
    PreloadSection,
    ReductionSection,
    RoughnessSection,
    SolverSection,
    StudySection,
    instead_of,
    without_default,
)
from stickslip.case.template import is_named, quantity_of, section_type, study_text
from stickslip.core.errors import StudyFileError


class Case(BaseModel):
    """One study, validated, all values SI floats.

    Sections that do not belong to the kind of its structure are None or empty. ``Case()`` is the project's two-blade
    study. ``load_case(path)`` and ``Case.from_text(text)`` read a study file, ``Case.from_mapping`` the same as nested
    dictionaries; they raise StudyFileError with one line for each error.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    study: StudySection = StudySection()
    structure: StructureSection = StructureSection()
    geometry: GeometrySection | None = GeometrySection()
    mesh: MeshSection | None = MeshSection()
    material: MaterialSection | None = MaterialSection()
    bodies: dict[BodyName, BodySection] = Field(default={}, description=BodySection.__doc__)
    reduction: ReductionSection = ReductionSection()
    roughness: RoughnessSection | None = RoughnessSection()
    contact_stiffness: ContactStiffnessSection | None = Field(default=None, description=ContactStiffnessSection.__doc__)
    friction: FrictionSection = FrictionSection()
    interfaces: dict[Name, InterfaceSection] = Field(default={}, description=InterfaceSection.__doc__)
    preload: PreloadSection = PreloadSection()
    damping: DampingSection = DampingSection()
    excitation: ExcitationSection | None = ExcitationSection()
    forces: dict[Name, ForceSection] = Field(default={}, description=ForceSection.__doc__)
    responses: dict[Name, ResponseSection] = Field(default={}, description=ResponseSection.__doc__)
    static_loads: dict[Name, StaticLoadSection] = Field(default={}, description=StaticLoadSection.__doc__)
    rotation: RotationSection | None = Field(default=None, description=RotationSection.__doc__)
    solver: SolverSection = SolverSection()
    output: OutputSection = OutputSection()

    @model_validator(mode="before")
    @classmethod
    def _measured_stiffness_replaces_roughness(cls, data: Any) -> Any:
        return without_default(without_other_kinds(data), ("contact_stiffness",), "roughness")

    @model_validator(mode="after")
    def _sections_fit_the_kind(self) -> Self:
        require_fit(self)
        return self

    @field_validator("contact_stiffness")
    @classmethod
    def _one_source(cls, value: Any, info: ValidationInfo) -> Any:
        return instead_of(value, info, "roughness")

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
        structure = data.get("structure")
        if isinstance(structure, dict):
            files = {key: str(folder / structure[key]) for key in FILE_KEYS if isinstance(structure.get(key), str)}
            data = {**data, "structure": {**structure, **files}}
        interfaces = data.get("interfaces")
        if isinstance(interfaces, dict):
            data = {**data, "interfaces": {name: _with_pairs_in(folder, each) for name, each in interfaces.items()}}
        return cls._validated(data, source, lines)

    @classmethod
    def _validated(cls, data: dict[str, Any], source: str, lines: Mapping[tuple[str, ...], int]) -> Self:
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            details = error.errors(include_url=False)
            message = case_file.report(details, source, data, cls.known_keys(), lines, cls.named_sections())
            raise StudyFileError(message) from error

    def __hash__(self) -> int:
        """Cases serve as keys; the dictionaries of named sections alone could not."""
        return hash(json.dumps(self.to_dict()))

    @classmethod
    def known_keys(cls) -> dict[str, tuple[str, ...]]:
        """Section name -> its keys, in the order of the file."""
        return {name: tuple(section_type(field).model_fields) for name, field in cls.model_fields.items()}

    @classmethod
    def named_sections(cls) -> tuple[str, ...]:
        """Sections whose entries have names of their own, [section.NAME]."""
        return tuple(name for name, field in cls.model_fields.items() if is_named(field))

    def replace(self, changes: Mapping[str, Any]) -> Self:
        """A validated copy with other values, ``case.replace({"preload.centrifugal_force": "300 N"})``.

        Keys are ``section.key`` or ``section.NAME.key``, values as in a study file. Raises StudyFileError.
        """
        data = self._as_mapping(only_given=True)
        for path, value in changes.items():
            section, _, rest = path.partition(".")
            name, _, key = rest.rpartition(".") if section in self.named_sections() else ("", "", rest)
            if name and name not in getattr(self, section):
                known = ", ".join(getattr(self, section)) or "none"
                raise StudyFileError(
                    f"the study: 1 error.\n  {path}: there is no [{section}.{name}] in the study; there are: {known}."
                )
            home = data.setdefault(section, {})
            (home.setdefault(name, {}) if name else home)[key] = value
        return type(self).from_mapping(data)

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """Every value with its SI unit ("0.145 m"), for records; ``Case.from_mapping`` reads it back exactly."""
        return self._as_mapping(only_given=False)

    def to_text(self) -> str:
        """A commented study file of this case, in the units that engineers use (15 digits)."""
        shown = [name for name in type(self).model_fields if self.shows(name)]
        return study_text(self, shown, FOREIGN_KEYS[self.structure.kind])

    def defaulted_keys(self) -> tuple[str, ...]:
        """Keys that the study file left out, as ``section.key``, or ``[section]`` where it left out all of them."""
        result: list[str] = []
        for name in type(self).model_fields:
            section = getattr(self, name)
            if section is None or name == "structure":
                continue
            if isinstance(section, dict):
                result += [
                    f"{name}.{entry}.{key}"
                    for entry, values in section.items()
                    for key, value in values
                    if key not in values.model_fields_set and value is not None
                ]
                continue
            given = section.model_fields_set if name in self.model_fields_set else set()
            missing = [key for key, value in section if key not in given and value is not None]
            if not given and missing:
                result.append(f"[{name}]")
            else:
                foreign = FOREIGN_KEYS[self.structure.kind]
                result += [f"{name}.{key}" for key in missing if f"{name}.{key}" not in foreign]
        return tuple(result)

    def _as_mapping(self, only_given: bool) -> dict[str, dict[str, Any]]:
        """Section -> key -> value as in a study file, without empty keys, or only with what the file gave."""
        data: dict[str, dict[str, Any]] = {}
        for name in type(self).model_fields:
            section = getattr(self, name)
            if not self.shows(name) or section is None or (only_given and name not in self.model_fields_set):
                continue
            if isinstance(section, dict):
                data[name] = {entry: _plain(values, only_given) for entry, values in section.items()}
            else:
                data[name] = _plain(section, only_given)
        return data

    def shows(self, name: str) -> bool:
        """Whether a section stands in the study file of this case, be it as a comment."""
        value = getattr(self, name)
        if name == "structure":
            return self.structure.kind != "two-blade"
        return bool(value) or name in ("roughness", "contact_stiffness")


def _plain(section: BaseModel, only_given: bool) -> dict[str, Any]:
    """Key -> value of one section as in a study file, without empty keys, or only with what the file gave."""
    values = {}
    for key, value in section:
        if value is None or (only_given and key not in section.model_fields_set):
            continue
        quantity = quantity_of(type(section), key)
        plain = list(value) if isinstance(value, tuple) else value
        values[key] = quantity.stored(value) if quantity and isinstance(value, float) else plain
    return values


def _with_pairs_in(folder: Path, interface: Any) -> Any:
    """An interface whose file of pairs is absolute."""
    if isinstance(interface, dict) and isinstance(interface.get("pairs"), str):
        return {**interface, "pairs": str(folder / interface["pairs"])}
    return interface


def load_case(path: str | PathLike[str]) -> Case:
    """Read and validate a study file. Raises StudyFileError with one line for each error in the file."""
    return load_case_and_places(path)[0]


def load_case_and_places(path: str | PathLike[str]) -> tuple[Case, case_file.KeyPlaces]:
    """:func:`load_case`, and where the keys of the file stand, for what is found wrong later."""
    text = case_file.read_text(path)
    places = case_file.KeyPlaces(str(path), case_file.parse_toml(text, str(path)), case_file.key_lines(text))
    return Case.in_folder(dict(places.data), Path(path).resolve().parent, places.source, places.lines), places
