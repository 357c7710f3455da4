"""Small text files with node and direction of each row of a matrix, and with positions of nodes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.matrices.source import quoted, text_lines
from stickslip.structure.mesh import IntArray

# Names of directions: those of stickslip, of Ansys, and numbers as CalculiX and Nastran count them.
_NAMES = (
    ("x", "ux", "1"),
    ("y", "uy", "2"),
    ("z", "uz", "3"),
    ("rx", "rotx", "4"),
    ("ry", "roty", "5"),
    ("rz", "rotz", "6"),
)
_OTHER = ("other", "q")
_DIRECTION = {name: number for number, names in enumerate((*_NAMES, _OTHER)) for name in names}
_WORD = re.compile(r"[,;\s]+")
_WHOLE = re.compile(r"-?\d{1,18}")


def read_unknown_map(path: Path) -> tuple[IntArray, IntArray]:
    """Node (n,) and direction (n,), 0 to 6, of each matrix row, from a map file.

    ``.dof`` (CalculiX): ``node.direction`` a line. ``.mapping`` (Ansys HBMAT): row, node and direction a line. Any
    other file: node and direction a line, with comma or blank, directions x, y, z, rx, ry, rz, other (or UX ... ROTZ,
    or 1 to 6); a first line of words and lines that begin with ``#`` are ignored.

    Raises ImportFileError, which names the line.
    """
    # A cut direction is never a valid one, and the caller compares the number of lines with that of the rows.
    lines = text_lines(path, may_lack_end=True)
    kind = path.suffix.lower()
    nodes: list[int] = []
    directions: list[int] = []
    for number, line in enumerate(lines, start=1):
        words = [word for word in _WORD.split(line.split("#")[0].strip()) if word]
        if not words or (not nodes and not any(_WHOLE.fullmatch(word) for word in words) and "." not in line):
            continue  # blank, a comment, or the titles of the columns
        if kind == ".dof":
            match = re.fullmatch(r"(\d{1,18})\.([1-6])", words[0]) if len(words) == 1 else None
            words = list(match.groups()) if match else []
            expected = "node.direction, such as 17.2"
        elif kind == ".mapping":
            words = words[1:] if len(words) == 3 and words[0] == str(len(nodes) + 1) else []
            expected = f"row {len(nodes) + 1}, a node and a direction, such as {len(nodes) + 1} 17 UY"
        else:
            expected = "a node and a direction, such as 17, y"
        if len(words) != 2 or not _WHOLE.fullmatch(words[0]) or words[1].lower() not in _DIRECTION:
            raise ImportFileError(
                f'"{path}", line {number}: {quoted(line)} must be {expected}. Directions are x, y, z, rx, ry, '
                "rz, other; UX ... ROTZ; or 1 to 6."
            )
        nodes.append(int(words[0]))
        directions.append(_DIRECTION[words[1].lower()])
        if kind == ".dof" and len(nodes) > 1 and (nodes[-2], directions[-2]) >= (nodes[-1], directions[-1]):
            raise ImportFileError(
                f'"{path}", line {number}: {line.strip()} comes after {nodes[-2]}.{directions[-2] + 1}, but CalculiX '
                "writes rising nodes and directions. The lines are out of order."
            )
    if not nodes:
        raise ImportFileError(f'"{path}" contains no unknown; each line must have the node and direction of a row.')
    return np.array(nodes, dtype=np.int64), np.array(directions, dtype=np.int64)


def read_node_positions(path: Path) -> tuple[IntArray, FloatArray]:
    """Node numbers (k,) and positions (k, 3), in the file's length unit, from lines ``node, x, y, z``.

    A first line of words and lines that begin with ``#`` or ``*`` are ignored, so the node lines of an ``.inp`` file
    are valid. Raises ImportFileError, which names the line, for other lines, and for a node that occurs twice.
    """
    labels: dict[int, int] = {}
    positions = []
    for number, line in enumerate(text_lines(path), start=1):
        words = [word for word in _WORD.split(line.strip()) if word]
        if not words or words[0].startswith(("#", "*")) or (not labels and not _WHOLE.fullmatch(words[0])):
            continue
        try:
            position = [float(word) for word in words[1:]]
        except ValueError:
            position = []
        if len(position) != 3 or not _WHOLE.fullmatch(words[0]) or not np.isfinite(position).all():
            raise ImportFileError(
                f'"{path}", line {number}: {quoted(line)} must be a node and three coordinates, such as '
                "17, 0.5, 1.0, 0.0."
            )
        node = int(words[0])
        if node in labels:
            raise ImportFileError(f'"{path}": node {node} is in two lines, {labels[node]} and {number}.')
        labels[node] = number
        positions.append(position)
    if not labels:
        raise ImportFileError(f'"{path}" contains no node; each line must contain a node number, x, y and z.')
    return np.array(list(labels), dtype=np.int64), np.array(positions)
