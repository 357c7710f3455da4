"""Makes the meshes of this folder again: ``python examples/joints/make_meshes.py``; needs numpy alone.

Each mesh is a deck of bricks in mm, t and s. A body consists of blocks whose nodes at one position are one node. Change
the dimensions here and run the script to try another joint.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
Place = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
Point = tuple[float, float]
# Sides of a brick in a deck, by the coordinate i, j or k of its block and the end of it.
SIDES = {"i0": "S6", "i1": "S4", "j0": "S3", "j1": "S5", "k0": "S1", "k1": "S2"}


class Body:
    """Bricks with the faces and node sets that a study names."""

    def __init__(self, deck: Deck, name: str) -> None:
        self.deck, self.name = deck, name
        self.numbers: dict[tuple[float, float, float], int] = {}

    def block(self, place: Place, *axes: np.ndarray, faces: dict[str, tuple[str, Point, Point]] | None = None) -> None:
        """Add bricks between the values of three axes; ``place`` gives the positions (..., 3) in mm of a grid of them.

        ``faces`` are sides of the block by their name: the side, as in SIDES, and the range of the bricks on it along
        both other axes, as values of these axes.
        """
        points = np.round(place(*np.meshgrid(*axes, indexing="ij")), 6) + 0.0
        number = np.array([self._number(*point) for point in points.reshape(-1, 3)]).reshape(points.shape[:3])
        shape = np.array(number.shape) - 1
        corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
        bricks = np.empty(shape, dtype=int)
        for at in np.ndindex(*shape):
            nodes = [int(number[tuple(np.add(at, corner))]) for corner in corners]
            bricks[at] = self.deck.add_brick(self.name, nodes)
        middles = [0.5 * (axis[1:] + axis[:-1]) for axis in axes]
        for name, (side, *ranges) in (faces or {}).items():
            axis = "ijk".index(side[0])
            layer = np.take(bricks, -int(side[1]), axis=axis)
            others = [middle for at, middle in enumerate(middles) if at != axis]
            inside = [(low < middle) & (middle < high) for middle, (low, high) in zip(others, ranges, strict=True)]
            chosen = layer[np.ix_(*inside)].ravel()
            self.deck.faces.setdefault(name, []).extend((int(brick), SIDES[side]) for brick in chosen)

    def nodes(self, name: str, condition: Callable[[float, float, float], bool]) -> None:
        """Name the nodes at the positions in mm that satisfy a condition."""
        chosen = [number for point, number in self.numbers.items() if condition(*point)]
        self.deck.sets.setdefault(name, []).extend(chosen)

    def _number(self, *point: float) -> int:
        if point not in self.numbers:
            self.deck.points.append(point)
            self.numbers[point] = len(self.deck.points)
        return self.numbers[point]


class Deck:
    """A mesh of several bodies, as the deck of another program."""

    def __init__(self, heading: str) -> None:
        self.heading = heading
        self.points: list[tuple[float, ...]] = []
        self.bricks: dict[str, list[list[int]]] = {}
        self.faces: dict[str, list[tuple[int, str]]] = {}
        self.sets: dict[str, list[int]] = {}
        self.number_of_bricks = 0

    def add_brick(self, body: str, nodes: list[int]) -> int:
        """Add a brick of a body and return its number."""
        self.number_of_bricks += 1
        self.bricks.setdefault(body, []).append([self.number_of_bricks, *nodes])
        return self.number_of_bricks

    def text(self) -> str:
        """The deck."""
        lines = ["*HEADING", f"{self.heading}; mm, t, s; made by make_meshes.py", "*NODE"]
        lines += [", ".join([str(n), *(f"{x:.8g}" for x in point)]) for n, point in enumerate(self.points, start=1)]
        for body, bricks in self.bricks.items():
            lines += [f"*ELEMENT, TYPE=C3D8I, ELSET={body}", *(", ".join(map(str, brick)) for brick in bricks)]
        for name, nodes in self.sets.items():
            lines += [
                f"*NSET, NSET={name}",
                *(", ".join(map(str, nodes[at : at + 12])) for at in range(0, len(nodes), 12)),
            ]
        for name, sides in self.faces.items():
            lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{brick}, {side}" for brick, side in sides)]
        lines += ["*MATERIAL, NAME=steel", "*ELASTIC", "210000.0, 0.3", "*DENSITY", "7.85e-09"]
        lines += [f"*SOLID SECTION, ELSET={body}, MATERIAL=steel" for body in self.bricks]
        return "\n".join([*lines, ""])


def graded(*ends: float, bricks: tuple[int, ...]) -> np.ndarray:
    """Values from end to end, with a number of bricks between each two."""
    parts = [np.linspace(low, high, n + 1)[:-1] for (low, high), n in zip(pairwise(ends), bricks, strict=True)]
    return np.append(np.concatenate(parts), ends[-1])


def straight(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Positions that are the values of the axes."""
    return np.stack([x, y, z], axis=-1)


def prism(lower: tuple[Point, Point], upper: tuple[Point, Point]) -> Place:
    """A block whose section in x and z is between two lines: i goes along them, k from the lower to the upper one."""
    (a, b), (d, c) = (np.array(line) for line in (lower, upper))

    def place(i: np.ndarray, y: np.ndarray, k: np.ndarray) -> np.ndarray:
        i, k = i[..., None], k[..., None]
        section = (1 - k) * ((1 - i) * a + i * b) + k * ((1 - i) * d + i * c)
        return np.stack([section[..., 0], y, section[..., 1]], axis=-1)

    return place


def lap_joint() -> Deck:
    """Two plates of 8 x 24 mm that overlap by 36 mm, with the faces of a washer of 12 x 12 mm above and below."""
    deck = Deck("Two plates with a bolted lap joint")
    y, washer = graded(0.0, 24.0, bricks=(8,)), ((104.0, 116.0), (6.0, 18.0))
    lower = Body(deck, "lower_plate")
    x = graded(0.0, 92.0, 128.0, bricks=(9, 12))
    faces = {"lower_contact": ("k1", (92.0, 128.0), (0.0, 24.0)), "washer_below": ("k0", *washer)}
    lower.block(straight, x, y, graded(0.0, 8.0, bricks=(3,)), faces=faces)
    lower.nodes("root", lambda x, y, z: x == 0.0)
    upper = Body(deck, "upper_plate")
    x = graded(92.0, 128.0, 220.0, bricks=(12, 9))
    faces = {"upper_contact": ("k0", (92.0, 128.0), (0.0, 24.0)), "washer_above": ("k1", *washer)}
    upper.block(straight, x, y, graded(8.0, 16.0, bricks=(3,)), faces=faces)
    upper.nodes("tip", lambda x, y, z: x == 220.0)
    return deck


def blade_root() -> Deck:
    """A blade with a dovetail root in the slot of a disk: two flanks of 45 degrees, each 4.95 x 20 mm."""
    deck = Deck("A blade with a dovetail root in its slot")
    y = graded(-10.0, 10.0, bricks=(8,))
    through, whole = np.linspace(0.0, 1.0, 5), (-10.0, 10.0)
    blade = Body(deck, "blade")
    # half widths in x at heights z, from the bottom of the root to the tip, and the bricks between them
    section = [(7.5, 4.0), (8.0, 8.0), (4.5, 11.5), (3.5, 13.5), (3.0, 20.0), (1.5, 90.0)]
    for (low, high), bricks in zip(pairwise(section), (1, 8, 1, 2, 10), strict=True):
        flanks = {"blade_right": ("i1", whole, (0.0, 1.0)), "blade_left": ("i0", whole, (0.0, 1.0))}
        place = prism(((-low[0], low[1]), low), ((-high[0], high[1]), high))
        blade.block(place, through, y, np.linspace(0.0, 1.0, bricks + 1), faces=flanks if bricks == 8 else None)
    blade.nodes("tip", lambda x, y, z: z == 90.0)
    disk = Body(deck, "disk")
    for sign, name in ((1.0, "disk_right"), (-1.0, "disk_left")):
        # the slot from its bottom to the top of the lug; the outer side of the lug is straight
        slot = [(8.5, 2.0), (8.0, 8.0), (4.5, 11.5), (5.0, 15.0)]
        for (low, high), bricks in zip(pairwise(slot), (2, 8, 2), strict=True):
            lines = [[(sign * x, z), (sign * 16.0, z)] for x, z in (low, high)]
            if sign < 0.0:  # so that i rises with x
                lines = [line[::-1] for line in lines]
            face = {name: ("i0" if sign > 0.0 else "i1", whole, (0.0, 1.0))} if bricks == 8 else None
            disk.block(
                prism(*map(tuple, lines)), np.linspace(0.0, 1.0, 4), y, np.linspace(0.0, 1.0, bricks + 1), faces=face
            )
    disk.block(straight, graded(-16.0, -8.5, 8.5, 16.0, bricks=(3, 4, 3)), y, graded(-6.0, 2.0, bricks=(2,)))
    disk.nodes("bore", lambda x, y, z: z == -6.0)
    return deck


def shroud() -> Deck:
    """One of 60 sectors of a disk whose blades have shrouds with contact faces at 35 degrees to the axis."""
    deck = Deck("One of 60 sectors with a shrouded blade")
    half, slope = math.radians(3.0), math.tan(math.radians(35.0)) / 260.0  # rad; rad per mm along the axis

    def place(r: np.ndarray, a: np.ndarray, z: np.ndarray) -> np.ndarray:
        angle = a + slope * z
        return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1)

    sector = Body(deck, "sector")
    blade = 0.009  # rad, half of the thickness of the blade: 4.7 mm at the shroud, 3.2 mm at the rim
    whole, z = graded(-half, -blade, blade, half, bricks=(3, 2, 3)), graded(-12.0, 12.0, bricks=(8,))
    sector.block(place, graded(165.0, 180.0, bricks=(2,)), whole, z)
    sector.block(place, graded(180.0, 260.0, bricks=(10,)), graded(-blade, blade, bricks=(2,)), z)
    ends = (260.0, 266.0), (-12.0, 12.0)
    faces = {"shroud_left": ("j0", *ends), "shroud_right": ("j1", *ends)}
    sector.block(place, graded(260.0, 266.0, bricks=(4,)), whole, z, faces=faces)

    def turned(x: float, y: float, z: float) -> float:
        return math.atan2(y, x) - slope * z

    sector.nodes("bore", lambda x, y, z: abs(math.hypot(x, y) - 165.0) < 1e-3)
    for name, angle in (("left", -half), ("right", half)):
        sector.nodes(name, lambda x, y, z, a=angle: abs(turned(x, y, z) - a) < 1e-6 and math.hypot(x, y) < 181.0)  # type: ignore[misc]
    sector.nodes(
        "middle", lambda x, y, z: abs(math.hypot(x, y) - 220.0) < 1e-3 and abs(turned(x, y, z)) < 1e-6 and z == 0.0
    )
    return deck


MESHES = {"lap_joint": lap_joint, "blade_root": blade_root, "shroud": shroud}


def main(folder: Path = HERE) -> None:
    """Write all meshes to a folder."""
    for name, make in MESHES.items():
        (folder / f"{name}.inp").write_text(make().text(), encoding="utf-8")


if __name__ == "__main__":
    main()
