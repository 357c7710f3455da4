"""The content of a case as a study file has it: its sections in their order, as mappings and as commented text."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from stickslip.case.plain import omitted_keys, plain_section
from stickslip.case.template import study_text

# Sections in the order of the file, those of every kind.
SECTIONS = (
    "study", "structure", "geometry", "mesh", "material", "bodies", "reduction", "roughness",
    "contact_stiffness", "friction", "interfaces", "preload", "damping", "excitation", "forces", "base_motion",
    "unbalance", "responses", "static_loads", "rotation", "reference", "analysis", "solver", "output",
)  # fmt: skip


class CaseContent(BaseModel):
    """Part of a case, whose fields are sections: their values as a study file has them."""

    @property
    def sections(self) -> dict[str, Any]:
        """Section name -> its values, or name -> values where entries have names; in the order of the file."""
        return {name: getattr(self, name) for name in SECTIONS if name in type(self).model_fields}

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
        return bool(self.sections.get(name)) or name in ("roughness", "contact_stiffness", "reference")
