"""Keys of a study file with dots, ``section.NAME.key``: their parts, and other values for them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from stickslip.case.law_keys import CONSTANT_TABLES
from stickslip.core.errors import StudyFileError


def parts_of_key(path: str, named_sections: Collection[str]) -> tuple[str, str, str, str]:
    """Section, name of the entry, section of constants and key of a dotted key; "" where it has no such part.

    ``named_sections`` have entries with names, which may have dots of their own.
    """
    section, _, rest = path.partition(".")
    above, _, key = rest.rpartition(".")
    table = next((each for each in CONSTANT_TABLES if above == each or above.endswith(f".{each}")), "")
    name = above.removesuffix(table).removesuffix(".")
    if section not in named_sections:
        return (section, "", table, key) if not name else (section, "", "", rest)
    return (section, name, table, key) if name else (section, above, "", key)


def with_values(
    data: dict[str, Any],
    changes: Mapping[str, Any],
    sections: Mapping[str, Mapping[str, Any]],
    named_sections: Collection[str],
) -> dict[str, Any]:
    """The mapping of a study file with other values of dotted keys; ``sections`` are those of the study.

    Raises StudyFileError for a key without its section, and for an entry that the study does not have.
    """
    for path, value in changes.items():
        section, name, table, key = parts_of_key(path, named_sections)
        if not key:
            raise StudyFileError(
                f'the study: 1 error.\n  "{path}" names no key. Give each key with its section, for example '
                '"friction.coefficient".',
                (path,),
            )
        entries = sections.get(section, {})
        if name and name not in entries:
            allowed = ", ".join(entries) or "none"
            raise StudyFileError(
                f"the study: 1 error.\n  {path}: there is no [{section}.{name}] in the study; there are: {allowed}.",
                (path,),
            )
        home = data.setdefault(section, {})
        for part in (name, table):
            home = home.setdefault(part, {}) if part else home
        home[key] = value
    return data
