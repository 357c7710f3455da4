"""Where the words of a sketch stand: beside what they name, off each other, off marks, off bodies if there is room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.reporting.svg import Element

# Words are set in this size (px of the view) at most: the style sheet makes them smaller in a wide window.
LETTER_PX = 15.5
_LETTER_WIDTH = 0.57  # of the size, a mean
_LONGEST = 34  # letters
_REACH = (14.0, 30.0, 52.0, 80.0, 110.0)  # px from the mark to the words
_DIRECTIONS = ((1, 0), (-1, 0), (1, -1), (-1, -1), (1, 1), (-1, 1), (0, -1), (0, 1))
_SHIFTS = (0.0, -0.4, 0.4)  # of the width of words above or below their mark
_OVER_BODY, _OVER_WORDS, _PER_REACH = 40.0, 1000.0, 0.35


@dataclass(frozen=True)
class Label:
    """Words for a place (2,) px; they may stand on it if it is that of a face."""

    words: str
    place: FloatArray
    may_cover: bool = False


class _Choice(NamedTuple):
    """Where words may stand: how far, on which side (1 right, -1 left), 1 below or -1 above, and shifted sideways."""

    reach: float
    side: int
    down: int
    shift: float


_CHOICES = [
    _Choice(reach, side, down, shift)
    for reach in _REACH
    for side, down in _DIRECTIONS
    for shift in (_SHIFTS if not side else (0.0,))
]

Box = tuple[float, float, float, float]  # left, top, right, bottom


def text_size(words: str) -> tuple[float, float]:
    """Width and height in px that a label needs at most, if its letters are of common width."""
    return _LETTER_WIDTH * LETTER_PX * len(_shortened(words)), 1.15 * LETTER_PX


def _shortened(words: str) -> str:
    return words if len(words) <= _LONGEST else words[: _LONGEST - 1] + "…"


def words_at(x: float, y: float, anchor: str, *words: Element | str) -> Element:
    """Words with the middle of their letters at the height ``y`` px and their end ``anchor`` at ``x`` px."""
    place = {"x": f"{x:.1f}", "y": f"{y:.1f}", "dy": ".36em", "text-anchor": anchor}
    return Element("text", place, words)


class Labels:
    """Sets labels one after the other into a view, each where it disturbs least.

    ``covered`` (rows, columns) says which pixels of the size ``pixel`` px hold bodies; ``taken`` are boxes that other
    marks need; ``width`` and ``height`` of the view are in px.
    """

    def __init__(self, covered: NDArray[np.bool_], pixel: float, width: int, height: int, taken: list[Box]) -> None:
        self._pixel, self._width, self._height = pixel, width, height
        self._sum = np.pad(covered.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
        self._taken = list(taken)

    def svg(self, label: Label) -> tuple[Element, ...]:
        """The label with a line to its place where it does not stand right beside it."""
        words = _shortened(label.words)
        width, height = text_size(label.words)
        choices = [_Choice(0.0, 0, 0, 0.0)] if label.may_cover else []
        choices += _CHOICES
        boxes = [self._box(label.place, choice, width, height) for choice in choices]
        costs = [self._cost(choice, box) for choice, box in zip(choices, boxes, strict=True)]
        best = int(np.argmin(costs))
        box, (reach, side, down, _) = boxes[best], choices[best]
        self._taken.append(box)
        anchor = {1: "start", -1: "end", 0: "middle"}[side]
        x = {1: box[0], -1: box[2], 0: 0.5 * (box[0] + box[2])}[side]
        y = 0.5 * (box[1] + box[3])
        leader: tuple[Element, ...] = ()
        if reach > _REACH[0]:
            to_y = y if side else (box[3] if down < 0 else box[1])
            to_x = x - 2.0 * side if side else float(np.clip(label.place[0], box[0], box[2]))
            line = f"M{label.place[0]:.1f} {label.place[1]:.1f}L{to_x:.1f} {to_y:.1f}"
            leader = (Element("path", {"class": "leader", "d": line}),)
        whole = (Element("title", {}, (label.words,)),) if words != label.words else ()
        return *leader, words_at(x, y, anchor, *whole, words)

    @staticmethod
    def _box(place: FloatArray, choice: _Choice, width: float, height: float) -> Box:
        slanted = 0.75 if choice.side and choice.down else 1.0
        x, y = place[0] + slanted * choice.side * choice.reach, place[1] + slanted * choice.down * choice.reach
        left = {1: x, -1: x - width, 0: x + (choice.shift - 0.5) * width}[choice.side]
        return (left, y - 0.5 * height, left + width, y + 0.5 * height)

    def _cost(self, choice: _Choice, box: Box) -> float:
        left, top, right, bottom = box
        outside = max(0.0, 3.0 - left) + max(0.0, right - self._width + 3.0)
        outside += max(0.0, 3.0 - top) + max(0.0, bottom - self._height + 3.0)
        cost = _PER_REACH * choice.reach + (_OVER_WORDS + outside if outside else 0.0)
        for other in self._taken:
            wide = min(right, other[2]) - max(left, other[0])
            high = min(bottom, other[3]) - max(top, other[1])
            cost += _OVER_WORDS if wide > 0.0 and high > 0.0 else 0.0
        if not choice.reach:
            return cost
        rows, columns = (
            np.clip(np.divide(limits, self._pixel), 0, most).astype(np.int64)
            for limits, most in zip(((top, bottom), (left, right)), np.array(self._sum.shape) - 1, strict=True)
        )
        area = self._sum[rows[1], columns[1]] - self._sum[rows[0], columns[1]]
        area += self._sum[rows[0], columns[0]] - self._sum[rows[1], columns[0]]
        return cost + _OVER_BODY * float(area) * self._pixel**2 / max((right - left) * (bottom - top), 1.0)
