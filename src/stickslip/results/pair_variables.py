"""The joint in a results file: Coulomb pairs by their own variables, any other law by its name and constants.

    pairs           operator, and for Coulomb pairs their constants
    pairs/law_0     of each law, where there are others: its pairs, and ``constant_<name>`` for each constant

A law is created from its name: a law of another package must be installed, or registered, when a file is read.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.constants import units_of
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.contact.law.law import ContactLaw
from stickslip.contact.law.registry import contact_law, contact_law_names, law_constants
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.core.plain_data import plain as plain_data
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.stored import StoredGroup, UnreadableError
from stickslip.results.variables import Json, Labelled, Numbers, Text, WholeNumbers, stored

if TYPE_CHECKING:
    import xarray

_OPERATOR = stored(Numbers(("row", "unknown"), "1", "relative displacement t1, t2, n of each pair"))
_PAIR = ("pair",)
_Plain = str | float | int | bool | None
_CONSTANT = "constant_"


@dataclass(frozen=True, eq=False)
class _CoulombVariables(Labelled):
    """Pairs with the Coulomb law only. ``gap`` is None if no pair has one, ``update`` for the usual return."""

    operator: FloatArray = field(metadata=_OPERATOR)
    normal_stiffness: FloatArray = field(metadata=stored(Numbers(_PAIR, "N m-1", "normal stiffness")))
    tangential_stiffness: FloatArray = field(
        metadata=stored(Numbers(("pair", "tangent"), "N m-1", "tangential stiffness"))
    )
    friction_coefficient: FloatArray = field(metadata=stored(Numbers(_PAIR, "1", "friction coefficient")))
    preload: FloatArray = field(metadata=stored(Numbers(_PAIR, "N", "normal force at rest")))
    residual_traction: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(("pair", "tangent"), "N", "retained traction at rest", optional=True)),
    )
    gap: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(_PAIR, "m", "gap at rest; preload is minus the force that closes it", optional=True)),
    )
    update: str | None = field(default=None, metadata=stored(Text("return of the friction law", optional=True)))

    @classmethod
    def of(cls, operator: FloatArray, law: CoulombLaw) -> _CoulombVariables:
        return cls(
            operator,
            law.normal_stiffness,
            law.tangential_stiffness,
            law.friction_coefficient,
            law.offset_force,
            law.residual_traction,
            law.gap if law.gap.any() else None,
            law.update if law.update != CoulombLaw.update else None,
        )

    def pairs(self) -> ContactPairs:
        update = CoulombLaw.update if self.update is None else self.update
        if update not in get_args(Update):
            raise UnreadableError('the text "update" does not have the expected content')
        pairs = ContactPairs(
            self.operator,
            self.normal_stiffness,
            self.tangential_stiffness,
            self.friction_coefficient,
            self.preload if self.gap is None else None,
            self.residual_traction,
            normal_load=None if self.gap is None else np.maximum(self.preload, 0.0),
            gap=self.gap,
        )
        return pairs.with_update(cast("Update", update))


@dataclass(frozen=True, eq=False)
class _MixedVariables(Labelled):
    """Pairs of other laws, or of several; each law has a group of its own."""

    operator: FloatArray = field(metadata=_OPERATOR)
    laws: list[str] = field(metadata=stored(Json(list[str], "names of the contact laws, JSON list")))


@dataclass(frozen=True, eq=False)
class _LawVariables(Labelled):
    """Pairs and scalar constants of a law, and the names ``arrays`` of its other constants."""

    members: NDArray[np.int64] = field(metadata=stored(WholeNumbers(_PAIR, "1", "pairs that follow the law")))
    plain: dict[str, _Plain] = field(
        metadata=stored(Json(dict[str, _Plain], "constants that are not arrays, JSON object"))
    )
    arrays: dict[str, str] = field(
        metadata=stored(Json(dict[str, Literal["b", "i", "u", "f"]], "constants that are arrays, and their kind"))
    )


def pairs_groups(pairs: ContactPairs, group: str) -> dict[str, xarray.Dataset]:
    """The groups of the joint in a results file. Raises InputError for a constant that a file cannot store."""
    if pairs.law_names == (CoulombLaw.name,) and len(pairs.laws) == 1:
        return _CoulombVariables.of(pairs.operator, pairs.coulomb).to_groups(group)
    groups = _MixedVariables(pairs.operator, [law.name for law in pairs.laws]).to_groups(group)
    for number, (law, members) in enumerate(zip(pairs.laws, pairs.members, strict=True)):
        groups[_law_group(group, number)] = _law_dataset(law, members)
    return groups


def pairs_from(group: StoredGroup, harmonics: int) -> ContactPairs:
    """The joint in a group of a results file.

    Raises UnreadableError for content that no run writes, and ResultsFileError for an unknown law.
    """
    if "laws" not in group:
        return _CoulombVariables.from_group(group).pairs()
    mixed = _MixedVariables.from_group(group)
    unknown = sorted(set(mixed.laws) - set(contact_law_names()))
    if unknown:
        raise ResultsFileError(
            f'the results file has pairs of the contact law "{unknown[0]}", which is not registered. Install the '
            "package of this law, or call stickslip.register_contact_law before you read the file."
        )
    parts = [group.subgroup(_law_group("", number)) for number in range(len(mixed.laws))]
    laws, members = zip(*(_law_from(name, part) for name, part in zip(mixed.laws, parts, strict=True)), strict=True)
    return ContactPairs.with_laws(mixed.operator, laws, members)


def _law_group(group: str, number: int) -> str:
    return f"{group}/law_{number}".removeprefix("/")


def _law_dataset(law: ContactLaw, members: NDArray[np.int64]) -> xarray.Dataset:
    constants = _storable_constants(law)
    arrays = {name: value for name, value in constants.items() if isinstance(value, np.ndarray)}
    plain = {name: value for name, value in constants.items() if name not in arrays}
    units = units_of(type(law))
    kinds = {name: value.dtype.kind for name, value in arrays.items()}
    dataset = _LawVariables(members, plain, kinds).to_dataset()
    for name, value in arrays.items():
        dims = tuple(
            "pair" if axis == 0 and size == members.size else f"{name}_{axis}" for axis, size in enumerate(value.shape)
        )
        stored_value = value.astype(np.int8) if value.dtype.kind == "b" else value
        attributes = {"long_name": f'{name} of the contact law "{law.name}"'}
        if name in units:
            attributes["units"] = units[name]
        dataset[_CONSTANT + name] = (dims, stored_value, attributes)
    return dataset


def _storable_constants(law: ContactLaw) -> dict[str, Any]:
    """The constants of a law. Raises InputError for one that a file cannot store."""
    constants: dict[str, Any] = plain_data(law_constants(law))
    for name, value in constants.items():
        is_array = isinstance(value, np.ndarray)
        if isinstance(value, float) or (is_array and value.dtype.kind in "biuf"):
            finite_array(f'constant "{name}" of the contact law "{law.name}"', value)
        elif is_array or not isinstance(value, _Plain):
            raise InputError(
                f'the contact law "{law.name}" has the constant "{name}", which is of the kind {type(value).__name__}: '
                "a results file contains numbers, texts and arrays of real numbers."
            )
    return constants


def _law_from(name: str, group: StoredGroup) -> tuple[ContactLaw, NDArray[np.int64]]:
    parts = _LawVariables.from_group(group)
    constants: dict[str, Any] = dict(parts.plain)
    for each, kind in parts.arrays.items():
        stored_name = _CONSTANT + each
        if kind == "f":
            constants[each] = group.numbers(stored_name)
        else:
            constants[each] = group.integers(stored_name).astype({"b": bool, "i": np.int64, "u": np.uint64}[kind])
    return contact_law(name)(**constants), parts.members
