"""Mass points and springs of a model file, by node labels, in its own units."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.structure.cell_kinds import IntArray


@dataclass(frozen=True)
class RawMass:
    """A mass at each of the nodes (k,)."""

    nodes: IntArray
    mass: float
    line: int


@dataclass(frozen=True)
class RawSpring:
    """A spring along a direction 0, 1, 2 of the nodes (k,), to the ground or to a direction of a second node."""

    nodes: IntArray
    direction: int
    stiffness: float
    line: int
    other: tuple[int, int] | None = None  # node and direction
