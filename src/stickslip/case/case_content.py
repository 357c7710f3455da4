"""The content of a case as a study file has it: its sections in their order, as mappings and as commented text."""

from __future__ import annotations

from inspect import Parameter, Signature
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from stickslip.case.plain import changed_texts, omitted_keys, plain_section
from stickslip.case.template import is_named, section_types, study_text

# Sections in the order of the file, those of every kind.
SECTIONS = (
    "study", "structure", "geometry", "damper", "mesh", "material", "bodies", "reduction", "roughness",
    "contact_stiffness", "friction", "interfaces", "ties", "preload", "damping", "excitation", "forces", "base_motion",
    "travelling_wave", "unbalance", "responses", "static_loads", "pressures", "gravity", "rotation", "mistuning",
    "reference", "analysis", "solver", "output",
)  # fmt: skip

SHOWN_CHANGES = 4  # chosen: one line of a terminal or two


class CaseContent(BaseModel):
    """Part of a case, whose fields are sections: their values as a study file has them."""

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        """A signature that a reader can take in: the name of each section and its class, without all of its keys."""
        super().__pydantic_init_subclass__(**options)
        # As an attribute by name: for the type checker `__signature__` belongs to the base class alone.
        setattr(cls, "__signature__", Signature([_parameter(name, each) for name, each in cls.model_fields.items()]))  # noqa: B010

    def __repr__(self) -> str:
        changed = self.changed_keys()
        first, more = "; ".join(changed[:SHOWN_CHANGES]), len(changed) - SHOWN_CHANGES
        keys = f"{first}{f'; and {more} further keys' if more > 0 else ''}" or "all keys have their defaults"
        return f"{type(self).__name__}({self.sections['study'].title!r}: {keys})"

    __str__ = __repr__

    @property
    def sections(self) -> dict[str, Any]:
        """Section name -> its values, or name -> values where entries have names; in the order of the file."""
        fields = type(self).model_fields
        return {name: getattr(self, name) for name in SECTIONS if name in fields}

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """Every value with its SI unit ("0.145 m"), for records; ``Case.from_mapping`` gives an equal case."""
        return self.as_mapping(only_explicit=False)

    def to_text(self) -> str:
        """A commented study file of this case, in the units that engineers use (15 digits)."""
        return study_text({name: values for name, values in self.sections.items() if self.shows(name)}, type(self))

    def defaulted_keys(self) -> tuple[str, ...]:
        """Keys that the study file omits, as ``section.key``, or ``[section]`` where it omits all of them."""
        shown = {name: section for name, section in self.sections.items() if name != "structure"}
        return tuple(path for name, section in shown.items() for path in self._omitted_keys(name, section))

    def _omitted_keys(self, name: str, section: Any) -> list[str]:
        if section is None:
            return []
        if isinstance(section, dict):
            return [f"{name}.{entry}.{key}" for entry, values in section.items() for key in omitted_keys(values)]
        missing = omitted_keys(section, everything=name not in self.model_fields_set)
        explicit = name in self.model_fields_set and section.model_fields_set
        return [f"{name}.{key}" for key in missing] if explicit else [f"[{name}]"] * bool(missing)

    def changed_keys(self) -> tuple[str, ...]:
        """Lines "section.key = value" of the keys of the study file that differ from their defaults, or have none."""
        lines: list[str] = []
        for name, section in self.sections.items():
            entries = {f"{name}.{entry}": each for entry, each in section.items()} if isinstance(section, dict) else {}
            for title, values in (entries or {name: section}).items():
                if values is not None and not isinstance(values, dict):
                    lines += [f"{title}.{text}" for text in (*self._other_kind(name, values), *changed_texts(values))]
        return tuple(lines)

    def _other_kind(self, name: str, section: BaseModel) -> list[str]:
        """The kind of a section, which is the default of its own class, where the default section has another one."""
        default = type(self).model_fields[name].get_default(call_default_factory=True)
        if not isinstance(default, BaseModel) or isinstance(section, type(default)):
            return []
        return [f'kind = "{section.kind}"'] if hasattr(section, "kind") else []

    def as_mapping(self, only_explicit: bool) -> dict[str, dict[str, Any]]:
        """Section -> key -> value as in a study file, without empty keys, or only with explicit keys of the file."""
        data: dict[str, dict[str, Any]] = {}
        for name, section in self.sections.items():
            if not self.shows(name) or section is None or (only_explicit and name not in self.model_fields_set):
                continue
            if isinstance(section, dict):
                data[name] = {entry: plain_section(values, only_explicit) for entry, values in section.items()}
            else:
                data[name] = plain_section(section, only_explicit)
        return data

    def shows(self, name: str) -> bool:
        """Whether the study file of this case contains a section, possibly as a comment."""
        if name == "structure":
            return bool(self.sections[name].kind != "two-blade")
        as_comment = ("roughness", "contact_stiffness", "mistuning", "reference")
        return bool(self.sections.get(name)) or (name in as_comment and name in self.sections)

    @classmethod
    def case_classes(cls) -> tuple[type[CaseContent], ...]:
        """The classes of cases for which the methods on keys below answer."""
        return (cls,)

    @classmethod
    def allowed_keys(cls) -> dict[str, tuple[str, ...]]:
        """Section name -> its keys, in the order of the file; of all kinds of structure for ``Case`` itself."""
        return {
            name: tuple(dict.fromkeys(key for each in classes for key in each.model_fields))
            for name, classes in cls.section_classes().items()
        }

    @classmethod
    def section_classes(cls) -> dict[str, tuple[type[BaseModel], ...]]:
        """Section name -> its classes, in the order of the file; of all kinds of structure for ``Case`` itself."""
        kinds = [kind.model_fields for kind in cls.case_classes()]
        fields = {name: [each[name] for each in kinds if name in each] for name in SECTIONS}
        return {
            name: tuple(dict.fromkeys(each for field in members for each in section_types(field.annotation)))
            for name, members in fields.items()
            if members
        }

    @classmethod
    def field_of(cls, section: str, key: str) -> tuple[type[BaseModel], FieldInfo]:
        """A key of the file: a class of its section that has it, and the field."""
        home = next(each for each in cls.section_classes()[section] if key in each.model_fields)
        return home, home.model_fields[key]

    @classmethod
    def named_sections(cls) -> tuple[str, ...]:
        """Sections whose entries have names of their own, [section.NAME]."""
        kinds = cls.case_classes()
        names = {name for kind in kinds for name, field in kind.model_fields.items() if is_named(field)}
        return tuple(name for name in SECTIONS if name in names)


class _Shown(str):
    """Words that stand for a value in a signature."""

    def __repr__(self) -> str:
        return str(self)


def _parameter(name: str, field: FieldInfo) -> Parameter:
    """A section as a parameter: ``solver=SolverSection(...)``."""
    default: Any = Parameter.empty
    if not field.is_required():
        value = field.get_default(call_default_factory=True)
        default = _Shown(f"{type(value).__name__}(...)") if isinstance(value, BaseModel) else value
    return Parameter(name, Parameter.KEYWORD_ONLY, default=default)
