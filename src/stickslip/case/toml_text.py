"""Reader of study files, with one message that has one line for each error."""

from __future__ import annotations

import difflib
import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

from pydantic_core import ErrorDetails

from stickslip.core.errors import InputError, StudyFileError
from stickslip.core.input_files import read_input

LARGEST_STUDY = 10_000_000  # bytes; a study file with every key has some 10 kB
STATED = "stated"  # type of an error whose context contains the message after the name of the entry
_KEY = re.compile(r"\s*([\w-]+)\s*=")
_OF_THE_NAME = "[key]"  # how pydantic marks an error in the name of an entry
_LONG_WORD = re.compile(r"\S{200,}")
_SYNTAX = (
    'Texts and values with a unit need quotes: blade_length = "145 mm"; a section is [geometry]; a comment starts with '
    "#."
)
_TWICE = re.compile(r"Cannot (overwrite|declare)")
_NEW_FILE = '"stickslip new FILE" writes a commented one to start from.'


def read_text(path: str | PathLike[str]) -> str:
    """The text of a study file. Raises StudyFileError if it cannot be read or is not UTF-8."""
    raw = read_input(path, f"Give the path of a study file; {_NEW_FILE}", LARGEST_STUDY, StudyFileError)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise StudyFileError(
            f"{path}, line {line}: the text is not UTF-8 (byte 0x{raw[error.start]:02x}). "
            "Save it as UTF-8; if it is not a text file, give the path of a study file."
        ) from error


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """The sections of a study file's text. Raises StudyFileError for a syntax error or a file without any section."""
    try:
        data = tomllib.loads(text)
    except RecursionError as error:
        raise StudyFileError(f"{source}: not valid TOML: brackets are nested too deeply. {_SYNTAX}") from error
    except tomllib.TOMLDecodeError as error:
        if _TWICE.match(str(error)) and (repeated := _repeated(text)):
            raise StudyFileError(f"{source}, {repeated}") from error
        raise StudyFileError(f"{source}: not valid TOML: {error}. {_SYNTAX}") from error
    except ValueError as error:  # of int(), whose words are about Python
        raise StudyFileError(f"{source}: not valid TOML: a number has thousands of digits. {_SYNTAX}") from error
    if not data:
        raise StudyFileError(f"{source}: the file is empty; it has no section. {_NEW_FILE}")
    return data


def _repeated(text: str) -> str:
    """The sentence on the first key or section that the file has twice, "" if none is seen, one key a line."""
    first: dict[tuple[str, ...], int] = {}
    section: tuple[str, ...] = ()
    for number, line in enumerate(text.splitlines(), start=1):
        header, key = _header(line), _KEY.match(line)
        section = header or section
        if not header and not key:
            continue
        name = section if header else (*section, key[1] if key else "")
        if name in first:
            shown = f"the section [{'.'.join(name)}]" if header else ".".join(name)
            return f"line {number}: {shown} is given twice (first in line {first[name]}). Remove one of the two."
        first[name] = number
    return ""


def key_lines(text: str) -> dict[tuple[str, ...], int]:
    """(section,) and (section, key) -> line number, for files with one key a line; others get messages without line."""
    lines: dict[tuple[str, ...], int] = {}
    section: tuple[str, ...] = ()
    for number, line in enumerate(text.splitlines(), start=1):
        header, key = _header(line), _KEY.match(line)
        if header:
            section = header
            lines.setdefault(section, number)
        elif key:
            lines.setdefault((*section, key[1]), number)
    return lines


@dataclass(frozen=True)
class KeyPositions:
    """Lines of the keys of a study file, for errors after reading.

    ``data`` and ``lines`` are those of :func:`parse_toml` and :func:`key_lines`; for the keys ``varied`` a sweep
    replaces the values of the file, by the ``option`` of its command. ``scattered``: key -> text of each distributed
    input of the file (:mod:`stickslip.case.scatter_text`).
    """

    source: str
    data: Mapping[str, Any]
    lines: Mapping[tuple[str, ...], int]
    varied: tuple[str, ...] = ()
    option: str = "--vary"
    scattered: Mapping[str, str] = field(default_factory=dict)

    def sentence(self, error: InputError) -> str:
        """The message of an error after the file's name and the line of each of its keys."""
        if error.are_arguments:  # of a function, and the file may have a key of that name for something else
            where = []
        elif len(error.keys) == 1 and error.keys[0] in str(error) and self.line(error.keys[0]):
            where = [f"line {self.line(error.keys[0])}"]  # the message names the key itself
        else:
            where = [self._position(key) for key in error.keys]
        return f"{', '.join([self.source, *where])}: {error}"

    def _position(self, key: str) -> str:
        if key in self.varied:
            return f"{self.option} {key}"
        if not _contains(self.data, key):
            return f"{key} (not in the file: default)"
        line = self.line(key)
        return f"line {line} ({key})" if line else key

    def line(self, key: str) -> int:
        """The line of a key of the file, else of its section; 0 if it is unknown or not in the file."""
        if key in self.varied or not _contains(self.data, key):
            return 0
        around = {".".join(path): line for path, line in self.lines.items() if path}
        around_key = [name for name in around if key == name or key.startswith(f"{name}.")]
        return around[max(around_key, key=len)] if around_key else 0


def _contains(data: Any, key: str) -> bool:
    """Whether sections contain a dotted key; a name of an entry may contain dots."""
    if not isinstance(data, Mapping):
        return False
    return key in data or any(
        key.startswith(f"{name}.") and _contains(data[name], key[len(name) + 1 :]) for name in data
    )


def _header(line: str) -> tuple[str, ...]:
    """The names in a line ``[section]`` or ``[section."a name"]``; empty for another line."""
    if not line.lstrip().startswith("["):
        return ()
    try:
        table: Any = tomllib.loads(line)
    except tomllib.TOMLDecodeError:
        return ()
    names = []
    while isinstance(table, dict) and table:
        name, table = next(iter(table.items()))
        names.append(name)
    return tuple(names)


def report(
    errors: Sequence[ErrorDetails],
    source: str,
    data: Mapping[str, Any],
    allowed: Mapping[str, Sequence[str]],
    lines: Mapping[tuple[str, ...], int],
    named: Sequence[str] = (),
) -> StudyFileError:
    """One line for each of pydantic's errors, in the order of the file, about all their keys.

    ``allowed`` contains the keys of every section, ``lines`` the line of every key of the file; the entries of the
    sections ``named`` have names of their own.
    """
    numbered = []
    for details in errors:
        path = tuple(str(part) for part in details["loc"])
        if not path:  # the file as a whole: its error names the entry
            path = getattr(details["ctx"]["error"], "path", ())
            key = ".".join(path)
            sentence = f"{key} {details['ctx']['error']}"
        else:
            entry = _Entry(path, path[0] in named)
            key, sentence = entry.key, _message(entry, details, data, allowed)
        line = next((lines[path[:depth]] for depth in (4, 3, 2, 1) if path[:depth] in lines), 0)
        where = f"line {line}: " if line else ""
        numbered.append((line, key, f"  {where}{_LONG_WORD.sub(_shortened, sentence)}"))
    numbered.sort(key=lambda entry: entry[0])
    count = "1 error" if len(numbered) == 1 else f"{len(numbered)} errors"
    keys = dict.fromkeys(key for _, key, _ in numbered)
    return StudyFileError("\n".join([f"{source}: {count}.", *(text for *_, text in numbered)]), tuple(keys))


def _shortened(word: re.Match[str]) -> str:
    """The start of a very long name, so that a message stays readable."""
    return f"{word[0][:60]}..."


@dataclass(frozen=True)
class _Entry:
    """Position of an error: section, the name of the entry in a section of named ones, key, then a key of its own
    section or an index in a list."""

    path: tuple[str, ...]
    is_named: bool

    @property
    def depth(self) -> int:
        """Number of parts down to a key."""
        return 3 if self.is_named else 2

    @property
    def section(self) -> str:
        """The section as in brackets."""
        return ".".join(self.path[: self.depth - 1])

    @property
    def key(self) -> str:
        """The key, or the section or entry of a section where the error is about that as a whole."""
        below = (part for part in self.path[self.depth :] if not part.isdecimal())
        return ".".join(part for part in (*self.path[: self.depth], *below) if part != _OF_THE_NAME)

    def __str__(self) -> str:
        below = (f"[{part}]" if part.isdecimal() else f".{part}" for part in self.path[self.depth :])
        return ".".join(self.path[: self.depth]) + "".join(below)


def _message(
    entry: _Entry, details: ErrorDetails, data: Mapping[str, Any], allowed: Mapping[str, Sequence[str]]
) -> str:
    """Key, value in the file, allowed values, what to do."""
    if entry.path[-1] == _OF_THE_NAME:
        return f"[{entry.path[0]}.{_toml(entry.path[1])}] {details['ctx']['error']}"
    if details["type"] == STATED:
        return f"{'.'.join(entry.path)} {details['ctx']['sentence']}"
    statement = f"{entry} = {_toml(details['input'])}"
    match details["type"]:
        case "extra_forbidden":
            return _unknown(entry, details["input"], allowed)
        case "missing":
            return f"{entry} is missing. Add it to the section [{entry.section}]."
        case "model_type" | "dict_type":
            header = f"{entry.section}.NAME" if entry.is_named and len(entry.path) == 1 else entry.section
            return f"{statement} must be a section: write [{header}] on a line of its own and its keys below it."
        case "literal_error":
            return f"{statement} is not allowed: it must be {details['ctx']['expected']}.{_nearest_choice(details)}"
        case "value_error":
            default = "" if _contains_path(data, entry.path) else " (the default)"
            return f"{statement}{default} {details['ctx']['error']}"
        case "string_type":
            return f"{statement} must be a text in quotes."
        case "bool_parsing" | "bool_type":
            return f"{statement} must be true or false, without quotes."
        case "tuple_type":
            return f"{statement} must be a list in square brackets."
    return f"{statement} is not allowed: {details['msg']}."


def _unknown(entry: _Entry, value: object, allowed: Mapping[str, Sequence[str]]) -> str:
    """A message on an unknown section or key, with the nearest existing one."""
    path = entry.path
    if len(path) == 1:
        home = next((section for section, keys in allowed.items() if path[0] in keys), None)
        if home and not isinstance(value, Mapping):
            return f"{path[0]} is outside of a section; it belongs below the line [{home}]."
        nearest = difflib.get_close_matches(path[0].lower(), allowed, n=1)
        advice = f"Did you mean [{nearest[0]}]?" if nearest else f"Sections are {', '.join(allowed)}."
        kind = (
            f"[{path[0]}] is not a section" if isinstance(value, Mapping) else f"{path[0]} is neither section nor key"
        )
        return f"{kind} of a study file. {advice}"
    section, key = path[0], path[entry.depth - 1]
    if entry.is_named and isinstance(value, Mapping):
        name = ".".join(path[1 : entry.depth])
        return (
            f"[{entry}] is not a section of a study file: a name with a dot requires quotes. Write "
            f'[{section}."{name}"] if the name has a dot.'
        )
    nearest = difflib.get_close_matches(key.lower(), allowed[section], n=1)
    homes = [other for other, keys in allowed.items() if key in keys]
    if homes:
        advice = f"It belongs to [{homes[0]}]."
    elif nearest:
        advice = f"Did you mean {nearest[0]}?"
    else:
        everywhere = {name: other for other, keys in allowed.items() for name in keys}
        elsewhere = difflib.get_close_matches(key.lower(), everywhere, n=1)
        advice = f"Did you mean {elsewhere[0]} of [{everywhere[elsewhere[0]]}]? " if elsewhere else ""
        advice += f"Keys of [{entry.section}] are {', '.join(allowed[section])}."
    return f"{entry} is not a key of a study file. {advice}"


def _nearest_choice(details: ErrorDetails) -> str:
    choices = re.findall(r"'([^']*)'", str(details["ctx"]["expected"]))
    nearest = difflib.get_close_matches(str(details["input"]).lower(), choices, n=1)
    return f' Did you mean "{nearest[0]}"?' if nearest else ""


def _contains_path(data: Mapping[str, Any], path: tuple[str, ...]) -> bool:
    """Whether the file contains the entry at ``path``; a default can contradict another value."""
    inner: Any = data
    for part in path:
        if not isinstance(inner, Mapping):
            break  # an index in a list
        if part not in inner:
            return False
        inner = inner[part]
    return True


def _toml(value: object) -> str:
    """``value`` as in the file, shortened."""
    if isinstance(value, float):
        text = repr(value)
    elif isinstance(value, Mapping):
        text = "{...}"
    else:
        text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= 60 else f"{text[:56]} ..."
