"""Ranges of keys that change continuously: those of a design, and that of a ridge of peaks."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.case.analysis import RidgeAnalysis
from stickslip.case.case import Case, CyclicCase
from stickslip.case.continuous_keys import PHYSICAL
from stickslip.case.key_kinds import kind_of_key
from stickslip.core.errors import InputError
from stickslip.core.units import Quantity, number_or_text

# (from, to), each as in a study file: a number in SI units, or a text with a unit.
Limits = tuple[float | str, float | str]

# Sections whose keys change neither the mesh nor its reduction.
JOINT_SECTIONS = ("roughness", "contact_stiffness", "friction", "preload", "excitation", "damping")


def continuous_quantity(name: str, case: Case, purpose: str) -> Quantity:
    """The quantity of a key that a ``purpose``, such as "a design", changes continuously.

    Raises InputError for a key that does not exist, is no quantity, or does not describe structure, joint or loads.
    """
    kind = kind_of_key(name, case)
    if not isinstance(kind, Quantity):
        raise InputError(
            f"{name} is not a quantity; {purpose} requires a key that changes continuously, for example "
            "preload.centrifugal_force.",
            arguments=[name],
        )
    if Case.parts_of_key(name)[0] not in PHYSICAL:
        raise InputError(
            f"{name} describes the computation, not the structure, its joint or its loads; {purpose} requires a key of "
            "these. Choose another one.",
            arguments=[name],
        )
    return kind


def rising_range(name: str, quantity: Quantity, limits: Limits) -> tuple[float, float]:
    """The range of a key in SI units. Raises InputError for values without meaning and a range that does not rise."""
    ends = []
    for end in limits:
        try:
            ends.append(quantity.parse(number_or_text(end) if isinstance(end, str) else end))
        except InputError as error:
            raise InputError(f"{name} = {end} {error}", arguments=[name]) from error
    low, high = ends
    if not low < high:
        raise InputError(
            f"{name} has the range from {limits[0]} to {limits[1]}. The first value must be below the second.",
            arguments=[name],
        )
    return low, high


@dataclass(frozen=True)
class CaseFamily:
    """The cases that differ in the value of one key, a quantity."""

    case: Case
    key: str
    quantity: Quantity

    @classmethod
    def of(cls, case: Case, key: str) -> CaseFamily:
        """Raises InputError for a key along which no ridge of peaks can be followed, and for a sector of a disk."""
        if isinstance(case, CyclicCase):
            raise InputError(
                'a ridge of peaks is not computed for a sector of a disk (structure.kind = "cyclic"). Use a sweep, or '
                "a mesh of the full ring.",
                ("structure.kind",),
            )
        return cls(case, key, continuous_quantity(key, case, "a ridge of peaks"))

    @property
    def changes_structure(self) -> bool:
        """Whether each value requires its own structure."""
        return Case.parts_of_key(self.key)[0] not in JOINT_SECTIONS

    def at(self, value: float) -> Case:
        """The case with a value in SI units. Raises StudyFileError."""
        return self.case.replace({self.key: f"{value!r} {self.quantity.si_unit}".rstrip()})

    def bounds(self, limits: Limits) -> tuple[float, float]:
        """The range in SI units. Raises InputError, and StudyFileError where its ends contradict other keys."""
        low, high = rising_range(self.key, self.quantity, limits)
        if not low > 0.0:
            raise InputError(
                f"the ridge over {self.key} has the range from {limits[0]} to {limits[1]}. Give values above zero: the "
                "steps are in the logarithm.",
                arguments=[self.key],
            )
        for value in (low, high):
            self.at(value)
        return low, high


def ridge_of_study(case: Case) -> tuple[CaseFamily, tuple[float, float]] | None:
    """The family and the range in SI units of the ridge that a study has; None for another analysis.

    Raises InputError, StudyFileError for a key or a range that cannot be used; builds no mesh.
    """
    analysis = case.analysis
    if not isinstance(analysis, RidgeAnalysis):
        return None
    family = CaseFamily.of(case, analysis.over)
    return family, family.bounds((analysis.over_from, analysis.over_to))
