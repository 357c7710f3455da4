"""A strict reader of ASCII result files of CalculiX: by columns, from the description of the format alone.

K. Wittig, CalculiX GraphiX User's Manual, "Result Format": (1X,' -1',I10,6E12.5) and so on. Every column that the
description does not use must be blank.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

N_NODES_OF_TYPE = {1: 8, 2: 6, 3: 4, 4: 20, 5: 15, 6: 10}
NODES_OF_A_LINE = 10


@dataclass
class Block:
    """One result: what its header says, and the values of nodes."""

    name: str
    value: float
    kind: int
    step: int
    components: list[tuple[str, int, int, int]]
    nodes: list[int] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)

    @property
    def values(self) -> np.ndarray:
        return np.array(self.rows)


@dataclass
class FrdFile:
    """Nodes, elements (type, material, nodes) and results."""

    nodes: dict[int, tuple[float, ...]] = field(default_factory=dict)
    elements: dict[int, tuple[int, int, tuple[int, ...]]] = field(default_factory=dict)
    blocks: list[Block] = field(default_factory=list)


def read_frd(path: Path) -> FrdFile:
    lines = path.read_text(encoding="ascii").split("\n")
    assert lines[-1] == ""
    assert lines[-2] == " 9999"
    assert lines[0].startswith("    1C")
    content, at = FrdFile(), 1
    while lines[at].startswith("    1U"):
        at += 1
    at = _nodes(lines, at, content)
    at = _elements(lines, at, content)
    while lines[at] != " 9999":
        at = _block(lines, at, content)
    assert at == len(lines) - 2
    return content


def _columns(line: str, *widths: int) -> list[str]:
    """The columns of a line; nothing may follow them."""
    starts = np.cumsum([0, *widths])
    assert not line[starts[-1] :].strip(), line
    return [line[start:stop] for start, stop in pairwise(starts)]


def _count(line: str, code: str) -> int:
    key, blank, count, blank_too, form = _columns(line, 6, 18, 12, 37, 1)
    assert key == f"    {code}"
    assert not blank.strip()
    assert not blank_too.strip()
    assert form == "1"  # the long form
    return int(count)


def _floats(text: str) -> list[float]:
    assert len(text) % 12 == 0, text
    words = [text[place : place + 12] for place in range(0, len(text), 12)]
    assert all(word[8] == "E" and word[2] == "." for word in words), text
    return [float(word) for word in words]


def _nodes(lines: list[str], at: int, content: FrdFile) -> int:
    count = _count(lines[at], "2C")
    for line in lines[at + 1 : at + 1 + count]:
        assert line[:3] == " -1"
        content.nodes[int(line[3:13])] = tuple(_floats(line[13:]))
    assert lines[at + 1 + count] == " -3"
    return at + 2 + count


def _elements(lines: list[str], at: int, content: FrdFile) -> int:
    count, at = _count(lines[at], "3C"), at + 1
    for _ in range(count):
        key, number, kind, _, material = _columns(lines[at], 3, 10, 5, 5, 5)
        assert key == " -1"
        wanted = N_NODES_OF_TYPE[int(kind)]
        nodes: list[int] = []
        while len(nodes) < wanted:
            at += 1
            assert lines[at][:3] == " -2"
            width = min(NODES_OF_A_LINE, wanted - len(nodes))
            nodes += [int(word) for word in _columns(lines[at], 3, *[10] * width)[1:]]
        content.elements[int(number)] = (int(kind), int(material), tuple(nodes))
        at += 1
    assert lines[at] == " -3"
    return at + 1


def _block(lines: list[str], at: int, content: FrdFile) -> int:
    while lines[at].startswith("    1P"):
        at += 1
    key, _, value, count, text, kind, step, _, form = _columns(lines[at], 6, 6, 12, 12, 20, 2, 5, 10, 2)
    assert key == "  100C"
    assert not text.strip()
    assert form == " 1"
    key, name, n_components, real = _columns(lines[at + 1], 5, 8, 5, 5)
    assert key == " -4  "
    assert real == "    1"
    at, components = at + 2, []
    for _ in range(int(n_components)):
        line = lines[at]
        assert line[:5] == " -5  "
        numbers = [int(line[place : place + 5]) for place in range(13, 33, 5)]
        is_computed = line[33:] == "    1ALL"
        assert is_computed or line[33:].strip() in ("", "0"), line
        if not is_computed:
            components.append((line[5:13].strip(), *numbers[1:]))
        at += 1
    block = Block(name.strip(), float(value), int(kind), int(step), components)  # type: ignore[arg-type]
    for line in lines[at : at + int(count)]:
        assert line[:3] == " -1"
        block.nodes.append(int(line[3:13]))
        block.rows.append(_floats(line[13:]))
        assert len(block.rows[-1]) == len(components)
    assert lines[at + int(count)] == " -3"
    content.blocks.append(block)
    return at + int(count) + 1
