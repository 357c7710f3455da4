"""Mass points and springs of a model file, by node labels, in its own units."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.structure.cell_kinds import IntArray


@dataclass(frozen=True)
class RawMass:
    """A mass at each of the nodes (k,).

    ``offset`` is the position of its centre of gravity from the node, ``inertia`` its tensor about this centre: 11, 22,
    33, 12, 13, 23. ``in_basic``: both are along x, y, z; else they cannot be used.
    """

    nodes: IntArray
    mass: float
    line: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    in_basic: bool = True

    @property
    def is_point(self) -> bool:
        """Whether it has no effect on rotations."""
        return not (any(self.offset) or any(self.inertia))


@dataclass(frozen=True)
class RawSpring:
    """A spring along a direction 0 to 5 of the nodes (k,), to the ground or to a direction of a second node."""

    nodes: IntArray
    direction: int
    stiffness: float
    line: int
    other: tuple[int, int] | None = None  # node and direction
