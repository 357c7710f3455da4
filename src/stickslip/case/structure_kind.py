"""The kind of structure that the mappings of a study file name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import BaseModel

from stickslip.case.sections import StructureSection

Kind = Literal["two-blade", "mesh", "matrices", "cyclic"]


class _StructureOfSomeKind(BaseModel):
    kind: Kind


class CaseOfSomeKind(BaseModel):
    """The errors of a file with an unknown kind, whose other content cannot be checked."""

    structure: _StructureOfSomeKind


def kind_in(data: Any) -> Any:
    """The kind of structure in the mappings of a study file; any value that the file gives."""
    structure = data.get("structure") if isinstance(data, Mapping) else None
    if isinstance(structure, StructureSection):
        return structure.kind
    return structure.get("kind", "two-blade") if isinstance(structure, Mapping) else "two-blade"
