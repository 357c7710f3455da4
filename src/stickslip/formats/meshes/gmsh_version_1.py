"""Gmsh files of version 1 ($NOD, $ELM) as version 2.2, which meshio reads.

The elements have the same types and node orders; version 1 gives the number of nodes in place of the number of tags.
Source: Gmsh reference manual, "MSH file format version 1 (Legacy)".
"""

from __future__ import annotations

import re
from pathlib import Path

from stickslip.formats.meshes.raw_model import fail

_NODES = re.compile(rb"\s*\$NOD\s*\n(.*?)\$ENDNOD\s", re.DOTALL)
_ELEMENTS = re.compile(rb"\$ELM\s*\n(.*?)\$ENDELM\b", re.DOTALL)


def as_version_2(source: Path, content: bytes) -> bytes:
    """The content of a file of version 1 in version 2.2.

    Raises ImportFileError for a file without a complete section of each kind, and for an element without the numbers
    that its line announces.
    """
    nodes, elements = _NODES.match(content), _ELEMENTS.search(content)
    if nodes is None or elements is None:
        fail(
            source,
            "the file is of Gmsh version 1, but its $NOD or $ELM section is incomplete. Write the file again.",
        )
    lines = [line.split() for line in elements[1].splitlines() if line.strip()]
    converted = [b" ".join(lines[0])] if lines else []
    for words in lines[1:]:
        if len(words) < 6 or not words[4].isdigit() or len(words) != 5 + int(words[4]):
            fail(
                source,
                f'the element "{b" ".join(words)[:60].decode("ascii", "replace")}" must consist of its number, type, '
                "physical and elementary entity, number of nodes, and these nodes.",
            )
        converted.append(b" ".join([*words[:2], b"2", *words[2:4], *words[5:]]))
    parts = (b"$MeshFormat", b"2.2 0 8", b"$EndMeshFormat", b"$Nodes", nodes[1].strip(), b"$EndNodes", b"$Elements")
    return b"\n".join([*parts, *converted, b"$EndElements", b""])
