"""Constraint equations and coupled sets of Ansys archives: the commands CE and CP.

Source: Ansys Mechanical APDL command reference, CE and CP. Both act along the directions of their nodes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.ansys_archive import Entry
from stickslip.formats.meshes.raw_ties import RawEquation, Term, basic_terms, combined

DIRECTIONS = {"UX": 0, "UY": 1, "UZ": 2, "ROTX": 3, "ROTY": 4, "ROTZ": 5}


@dataclass
class _Equation:
    entry: Entry  # its first command
    number_of_terms: int | None  # as the archive announces it
    constant: float
    terms: list[Term] = field(default_factory=list)


class ConstraintEquations:
    """Reads CE; :meth:`equations` gives them after the last command."""

    def __init__(self) -> None:
        self._equations: dict[int, _Equation] = {}
        self._open: _Equation | None = None  # the one whose terms CE,R5.0,NODE adds

    def take(self, entry: Entry) -> None:
        """Read one command CE. Raises ImportFileError."""
        if not entry.word(0).startswith("R"):  # CE,number,constant,node,direction,coefficient,...
            number = entry.label(entry.word(0))
            equation = self._equations.get(number)
            if equation is None:
                equation = self._equations[number] = _Equation(entry, None, entry.number(entry.word(1)))
            self._add(equation, entry, 2)
        elif entry.word(1) == "DEFI":  # CE,R5.0,DEFI,number of terms,number,constant
            number = entry.label(entry.word(3))
            if number in self._equations:
                entry.fail(f"equation {number} is defined twice.")
            self._open = _Equation(entry, entry.whole(entry.word(2)), entry.number(entry.word(4)))
            self._equations[number] = self._open
        elif entry.word(1) == "NODE" and self._open is not None:  # CE,R5.0,NODE,node,direction,coefficient,...
            self._add(self._open, entry, 2)
        else:
            entry.fail("it must be CE,R5.0,DEFI, then CE,R5.0,NODE with the terms. Write the archive with CDWRITE,DB.")

    def equations(self, frames: Mapping[int, FloatArray]) -> tuple[list[RawEquation], list[int]]:
        """The equations in basic directions, and the lines of those whose constant is not 0.

        ``frames`` are the directions (3, 3) of rotated nodes by label. Raises ImportFileError for an equation without
        its terms.
        """
        found, driven = [], []
        for number, equation in self._equations.items():
            terms, announced = equation.terms, equation.number_of_terms
            if announced is not None and len(terms) != announced:
                equation.entry.fail(f"equation {number} has {len(terms)} terms, but announces {announced}.")
            basic = combined(term for each in terms for term in basic_terms(frames, *each))
            if not basic:
                equation.entry.fail(f"equation {number} has no coefficient other than 0.")
            if equation.constant != 0.0:
                driven.append(equation.entry.line)
            # Ansys makes the first term dependent where it can, and chooses another one where that is constrained.
            found.append(RawEquation(f"CE {number}", basic, equation.entry.line, is_free=True))
        return found, driven

    def _add(self, equation: _Equation, entry: Entry, first: int) -> None:
        for at in range(first, len(entry.words), 3):
            if not entry.word(at):
                continue
            name = entry.word(at + 1)
            if name not in DIRECTIONS:
                entry.fail(f'"{name[:10]}" is not a direction; it must be one of {", ".join(DIRECTIONS)}.')
            term = (entry.label(entry.word(at)), DIRECTIONS[name], entry.number(entry.word(at + 2)))
            equation.terms.append(term)


@dataclass
class _CoupledSet:
    entry: Entry  # its first command
    direction: int
    nodes: list[int] = field(default_factory=list)


class CoupledSets:
    """Reads CP: the nodes of a set have one displacement; :meth:`equations` gives them after the last command."""

    def __init__(self) -> None:
        self._sets: dict[int, _CoupledSet] = {}

    def take(self, entry: Entry) -> None:
        """Read one command CP,set,direction,node,...; a further one of a set adds nodes. Raises ImportFileError."""
        number, name = self._number(entry), entry.word(1)
        if name == "ALL":  # a new set for each displacement of a solid
            if number in self._sets:
                entry.fail(f"set {number} exists already, so that the direction ALL needs another number, or NEXT.")
            names = ["UX", "UY", "UZ"]
        elif name or number not in self._sets:
            names = [name]
        else:
            names = [list(DIRECTIONS)[self._sets[number].direction]]
        nodes = [entry.label(word) for word in entry.words[2:] if word]
        for at, each in enumerate(names):
            if each not in DIRECTIONS:
                entry.fail(f'"{each[:10]}" is not a direction; it must be one of {", ".join(DIRECTIONS)} or ALL.')
            if number + at in self._sets and len(names) > 1:
                entry.fail(f"set {number + at} exists already; the direction ALL requires the numbers up to it.")
            coupled = self._sets.setdefault(number + at, _CoupledSet(entry, DIRECTIONS[each]))
            coupled.direction = DIRECTIONS[each]  # a new direction replaces that of the set
            coupled.nodes += [node for node in nodes if node not in coupled.nodes]

    def equations(self, frames: Mapping[int, FloatArray]) -> list[RawEquation]:
        """``u_k - u_1 = 0`` for each further node k of a set, in basic directions. Raises ImportFileError.

        ``frames`` are the directions (3, 3) of rotated nodes by label.
        """
        found = []
        for number, coupled in self._sets.items():
            if len(coupled.nodes) < 2:
                coupled.entry.fail(f"set {number} has one node or none; at least two must be coupled.")
            first, line = coupled.nodes[0], coupled.entry.line
            for node in coupled.nodes[1:]:
                terms = [(node, coupled.direction, 1.0), (first, coupled.direction, -1.0)]
                basic = combined(term for each in terms for term in basic_terms(frames, *each))
                found.append(RawEquation(f"CP {number}", basic, line, is_free=True))
        return found

    def _number(self, entry: Entry) -> int:
        """The number of the set; NEXT is the highest one plus 1, HIGH the highest one."""
        word, highest = entry.word(0), max(self._sets, default=0)
        if word == "NEXT":
            return highest + 1
        if word == "HIGH" and highest:
            return highest
        return entry.label(word)
