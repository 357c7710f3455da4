"""Ties of Nastran decks: multi-point constraints, rigid bars and bodies, and interpolation elements."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.bulk_data import BulkCard
from stickslip.formats.meshes.nastran_case import CaseControl, active_entries
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.raw_ties import (
    RawDistributing,
    RawEquation,
    RawRigid,
    basic_terms,
    combined,
    equal_distance,
    linearised,
)

_ALL = "123456"


class NastranTies:
    """Reads MPC, MPCADD, RBAR, RROD, RBE2 and RBE3; :meth:`write` resolves them after the last grid."""

    def __init__(self) -> None:
        self._mpcs: dict[int, list[BulkCard]] = {}
        self._added: dict[int, BulkCard] = {}
        self._elements: list[BulkCard] = []
        self.cards: dict[str, Callable[[BulkCard], None]] = {
            "MPC": lambda card: self._mpcs.setdefault(card.integer(0), []).append(card),
            "MPCADD": self._add,
            **dict.fromkeys(("RBAR", "RROD", "RBE2", "RBE3"), self._elements.append),
        }

    def write(self, raw: RawModel, case: CaseControl, frames: Mapping[int, FloatArray]) -> None:
        """Add the ties that act to ``raw``; ``frames`` are the directions of grids with a CD, by label."""
        for card in self._elements:
            {"RBAR": _rbar, "RROD": _rrod, "RBE2": _rbe2, "RBE3": _rbe3}[card.name](card, raw, frames)
        if not self._mpcs:
            return
        if not case.ties_nodes():
            numbers = ", ".join(map(str, self._mpcs))
            raw.messages.append(f"the case control selects no MPC, so those of the file (set {numbers}) do not act.")
            return
        sets = {number: [_mpc(card, frames) for card in cards] for number, cards in self._mpcs.items()}
        raw.ties.equations += active_entries(raw, case, "MPC", sets, self._added)

    def _add(self, card: BulkCard) -> None:
        if self._added.setdefault(card.integer(0), card) is not card:
            card.fail(f"set {card.integer(0)} is defined twice.")


def _components(card: BulkCard, word: str) -> tuple[int, ...]:
    """Directions 0 to 5 of components of 1 to 6."""
    if not word or set(word) - set(_ALL):
        card.fail(f'"{word[:12]}" are not components; they are digits of 1 to 6.')
    return tuple(sorted({int(each) - 1 for each in word}))


def _is_partial(components: Collection[int]) -> bool:
    """Whether some but not all translations, or rotations, are among components 0 to 5: they depend on the axes."""
    return any(0 < len(three & set(components)) < 3 for three in ({0, 1, 2}, {3, 4, 5}))


def _mpc(card: BulkCard, frames: Mapping[int, FloatArray]) -> RawEquation:
    """``sum A u = 0``: grid, component and coefficient in fields 3 to 5 and 6 to 8 of each line; the first depends."""
    terms: list[tuple[int, int, float]] = []
    for start in range(0, len(card.fields), 8):
        for at in (start + 1, start + 4):
            if not card.word(at):
                continue
            component = card.word(at + 1) or "0"
            if component == "0" or len(component) != 1:
                card.fail(f'field {at + 3} is "{component[:12]}"; it must be one component from 1 to 6 of a grid.')
            terms.append((card.integer(at), _components(card, component)[0], card.real(at + 2, 0.0)))
    basic = combined(term for each in terms for term in basic_terms(frames, *each))
    if not terms or terms[0][2] == 0.0 or not basic:
        card.fail("the coefficient of its first grid must be given and must not be 0.")
    return RawEquation(f"MPC {card.integer(0)}", basic, card.line, is_free=terms[0][0] in frames)


def _rigid(
    card: BulkCard, raw: RawModel, frames: Mapping[int, FloatArray], reference: int, nodes: list[int], word: str
) -> None:
    components = _components(card, word)
    turned = [label for label in nodes if label in frames]
    if turned and _is_partial(components):
        card.fail(
            f"grid {turned[0]} has a coordinate system of displacements (CD), and only the components {word} of it are "
            "rigid. Give 123, all six, or the grid a CD with axes along x, y, z."
        )
    raw.ties.rigid.append(RawRigid(card.name, reference, np.array(nodes, dtype=np.int64), components, card.line))


def _rbe2(card: BulkCard, raw: RawModel, frames: Mapping[int, FloatArray]) -> None:
    words = [word for word in card.fields[3:] if word]
    if words and not words[-1].isdecimal():
        card.real(max(at for at, word in enumerate(card.fields) if word))  # the coefficient of expansion
        words = words[:-1]
        card.fields = [*card.fields[:3], *words]
    nodes = card.numbers(3)
    if not nodes:
        card.fail("it has no dependent grids.")
    _rigid(card, raw, frames, card.integer(1), nodes, card.word(2))


def _rbar(card: BulkCard, raw: RawModel, frames: Mapping[int, FloatArray]) -> None:
    first, second = card.integer(1), card.integer(2)
    independent, dependent = [card.word(at) for at in (3, 4)], [card.word(at) for at in (5, 6)]
    for reference, node, own, other, follows in (
        (first, second, independent[0], independent[1], dependent[1]),
        (second, first, independent[1], independent[0], dependent[0]),
    ):
        if set(own) == set(_ALL) and not other.strip("0"):
            _rigid(card, raw, frames, reference, [node], follows.strip("0") or _ALL)
            return
    card.fail(
        f'the independent components are "{independent[0]}" and "{independent[1]}"; one end must have 123456 and the '
        "other none. Write it as RBE2, or with all independent components at one end."
    )


def _rrod(card: BulkCard, raw: RawModel, frames: Mapping[int, FloatArray]) -> None:
    first, second = card.integer(1), card.integer(2)
    row = {label: at for at, label in enumerate(raw.node_labels.tolist())}
    for label in (first, second):
        if label not in row:
            card.fail(f"grid {label} is not defined.")
    arm = raw.coordinates[row[first]] - raw.coordinates[row[second]]
    raw.ties.equations += linearised("RROD", equal_distance(first, second, arm), card.line)


def _rbe3(card: BulkCard, raw: RawModel, frames: Mapping[int, FloatArray]) -> None:
    """EID, blank, REFGRID, REFC, then weight, components and grids, repeated."""
    nodes: list[int] = []
    weights: list[float] = []
    at, weight = 4, 0.0
    while at < len(card.fields):
        word = card.word(at).upper()
        if word in ("UM", "ALPHA"):
            if word == "UM":
                card.fail("UM moves dependent components to other grids, which is not read. Leave it out.")
            break
        if not word:
            at += 1
        elif not word.isdecimal():
            weight = card.real(at)
            components = set(card.word(at + 1))
            if not components >= set("123"):
                card.fail(f'the components of its grids are "{card.word(at + 1)[:12]}"; 123 are read.')
            at += 2
        else:
            nodes.append(card.integer(at))
            weights.append(weight)
            at += 1
    if not nodes:
        card.fail("it has no grids with weights.")
    reference = card.integer(2)
    directions = _components(card, card.word(3))
    if reference in frames and _is_partial(directions):
        card.fail(f"grid {reference} has a coordinate system of displacements (CD). Give all components of REFC.")
    raw.ties.distributing.append(
        RawDistributing("RBE3", reference, np.array(nodes, dtype=np.int64), directions, card.line, np.array(weights))
    )
