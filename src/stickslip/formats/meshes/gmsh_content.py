"""Checks of Gmsh files before meshio reads them, and small changes to content that it would reject or misread.

meshio makes a table as long as the largest node number of a 4.1 file; takes the version "4", as Gmsh writes 4.0, for
4.1; and stops where only some of the entities belong to a physical group, which is so with Mesh.SaveAll.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.input_files import read_regular
from stickslip.formats.meshes.gmsh_version_1 import as_version_2
from stickslip.formats.meshes.raw_model import fail

_LARGEST_TAG = 10_000_000  # meshio's table then takes 80 MB
_VERSIONS = (b"2", b"2.2", b"4.0", b"4", b"4.1")
_COMMENTS = re.compile(rb"\s*\$Comments\r?\n.*?\$EndComments[^\n]*\n", re.DOTALL)
_PARAMETRIC = (
    "its nodes have parametric coordinates, which stickslip does not read. Write it again with Mesh.SaveParametric = 0 "
    "(in Gmsh's export window: without 'Save parametric coordinates')."
)


def readable_content(source: Path) -> bytes:
    """The content of a Gmsh file as meshio reads it right.

    Raises ImportFileError for an unreadable file, a foreign header or version, parametric nodes, damaged sections, huge
    node numbers, and, in version 4.0, entities in several groups.
    """
    try:
        content = read_regular(source)
    except OSError as error:
        fail(source, f"the file cannot be read ({error.strerror}). Give the path of a model file.")
    start = 0
    while comments := _COMMENTS.match(content, start):
        start = comments.end()
    content = content[start:]
    if content.startswith(b"$NOD"):
        content = as_version_2(source, content)
    words = content[: content.find(b"\n", content.find(b"\n") + 1) + 1].split()
    if (
        words[:1] != [b"$MeshFormat"]
        or words[1:2] not in [[v] for v in _VERSIONS]
        or words[2:]
        not in (
            [b"0", b"8"],
            [b"1", b"8"],
        )
    ):
        fail(source, "the first two lines are not those of a Gmsh file of version 1, 2.2, 4.0 or 4.1.")
    version, is_text = words[1], words[2] == b"0"
    content = content.replace(b"\r\n", b"\n") if is_text else content
    if b"$ParametricNodes\n" in content:
        fail(source, _PARAMETRIC)
    nodes = _section(source, content, b"Nodes")
    if version == b"4" and is_text and len(nodes.split(b"\n", 1)[0].split()) == 2:
        version, content = b"4.0", content.replace(b"4 0 8", b"4.0 0 8", 1)
    if version in (b"4", b"4.1"):
        _require_node_numbers(source, _Text(nodes) if is_text else _Binary(nodes))
    if version in (b"4.0", b"4", b"4.1") and b"$Entities\n" in content:
        entities = _section(source, content, b"Entities")
        try:
            grouped, most = _with_groups(
                _Text(entities) if is_text else _Binary(entities), 6 if version == b"4.0" else 3
            )
        except (ValueError, OverflowError):
            fail(source, _damaged("Entities"))
        if most > 1 and version == b"4.0":
            fail(
                source,
                "it has entities in several physical groups, but stickslip reads only one of them in version 4.0. "
                "Write it again as version 4.1.",
            )
        content = content.replace(entities, grouped, 1)
    return content


def _damaged(section: str) -> str:
    return f"the file is damaged or truncated: its ${section} section is incomplete. Write the file again."


def _section(source: Path, content: bytes, name: bytes) -> bytes:
    """The content of a section that must occur once. Raises ImportFileError."""
    head = b"$" + name + b"\n"
    start, end = content.find(head), content.find(b"$End" + name)
    if start < 0 or end < start or content.find(head, start + 1) > 0:
        fail(source, _damaged(name.decode()))
    return content[start + len(head) : end]


def _require_node_numbers(source: Path, numbers: _Binary | _Text) -> None:
    """Raise ImportFileError where the nodes of a 4.1 file are not those that it announces, or have huge numbers."""
    try:
        problem = _node_problem(numbers)
    except (ValueError, OverflowError):
        problem = _damaged("Nodes")
    if problem:
        fail(source, problem)


def _node_problem(numbers: _Binary | _Text) -> str:
    """The error in the $Nodes section of a 4.1 file, or "". Raises ValueError if it cannot be read."""
    n_blocks, missing, _, _ = numbers.take(4, "u8").tolist()
    for _ in range(n_blocks):
        if numbers.take(3, "i4")[2]:
            return _PARAMETRIC
        (count,) = numbers.take(1, "u8").tolist()
        tags = numbers.take(count, "u8")
        smallest, largest = int(tags.min(initial=1)), int(tags.max(initial=1))
        missing -= count
        numbers.take(3 * count, "f8")
        if largest > _LARGEST_TAG:
            return f"there is a node {largest}; the largest allowed number is {_LARGEST_TAG}. Renumber the nodes."
        if smallest < 1:
            raise ValueError("node 0")
    return _damaged("Nodes") if missing else ""


def _with_groups(numbers: _Binary | _Text, point_size: int) -> tuple[bytes, int]:
    """The $Entities section with the physical group 0, which is none, where an entity has no group; most groups of one.

    Each point has ``point_size`` coordinates, all other entities 6. Raises ValueError.
    """
    counts = numbers.take(4, "u8")
    parts, most = [counts], 0
    for dimension, count in enumerate(counts.tolist()):
        for _ in range(count):
            parts += [numbers.take(1, "i4"), numbers.take(6 if dimension else point_size, "f8")]
            (n_groups,) = numbers.take(1, "u8").tolist()
            most = max(most, n_groups)
            groups = numbers.take(n_groups, "i4") if n_groups else np.zeros(1, dtype="i4")
            parts += [np.array([groups.size], dtype="u8"), groups]
            if dimension:
                (n_borders,) = numbers.take(1, "u8").tolist()
                parts += [np.array([n_borders], dtype="u8"), numbers.take(n_borders, "i4")]
    return numbers.written(parts), most


class _Binary:
    """Numbers of a binary section, one after the other."""

    def __init__(self, content: bytes) -> None:
        self._content, self._at = content, 0

    def take(self, count: int, kind: str) -> NDArray[Any]:
        """The next numbers; raises ValueError beyond the end."""
        size = count * np.dtype(kind).itemsize
        if size > len(self._content) - self._at:
            raise ValueError("too short")
        values: NDArray[Any] = np.frombuffer(self._content, kind, count, self._at)
        self._at += size
        return values

    @staticmethod
    def written(parts: list[NDArray[Any]]) -> bytes:
        """Numbers as such a section contains them."""
        return b"".join(part.tobytes() for part in parts) + b"\n"


class _Text:
    """Numbers of a text section, one after the other."""

    def __init__(self, content: bytes) -> None:
        self._words, self._at = content.split(), 0

    def take(self, count: int, kind: str) -> NDArray[Any]:
        """The next numbers; raises ValueError beyond the end and for other words."""
        if not 0 <= count <= len(self._words) - self._at:
            raise ValueError("too short")
        words = self._words[self._at : self._at + count]
        self._at += count
        return np.array([float(word) if kind == "f8" else int(word) for word in words], dtype=kind)

    @staticmethod
    def written(parts: list[NDArray[Any]]) -> bytes:
        """Numbers as such a section contains them."""
        return "\n".join(" ".join(map(repr, part.tolist())) for part in parts if part.size).encode() + b"\n"
