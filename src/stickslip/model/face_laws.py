"""The laws that a study names for its faces: contact laws beside Coulomb friction, and stiffness over pressure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stickslip.case.law_constants import TABLE_FILE, LawConstants
from stickslip.case.law_keys import StiffnessLawKeys
from stickslip.contact.constants import FRICTION, GAP, Constant, Declaration
from stickslip.contact.law.law import ContactLaw
from stickslip.contact.law.registry import contact_law
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.contact.preload import area_fraction
from stickslip.contact.shared_constants import shared_constants
from stickslip.contact.stiffness.registry import stiffness_law
from stickslip.contact.stiffness.stiffness_law import Allocation, StiffnessLaw
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.formats.table_file import read_table
from stickslip.structure.mesh import IntArray


@dataclass(frozen=True)
class PressureLaw:
    """A stiffness law that a study names, how pairs take it, and the section of the study file that names it."""

    law: StiffnessLaw
    allocation: Allocation
    section: str


def pressure_law(given: StiffnessLawKeys, section: str) -> PressureLaw | None:
    """The stiffness law of a section; None where it names none. Raises InputError that names the key."""
    if given.stiffness_law is None or given.stiffness_constants is None:
        return None
    maker, constants = stiffness_law(given.stiffness_law), given.stiffness_constants
    table = f"{section}.stiffness_constants"
    values = dict(constants.values)
    key_of = {name: f"{table}.{name}" for name in constants.declared}
    if constants.file is not None:
        where = f"{table}.{TABLE_FILE}"
        del values[TABLE_FILE]
        columns = {name: each.quantity for name, each in constants.declared.items() if each.is_table and each.quantity}
        key_of |= dict.fromkeys(columns, where)
        values |= read_table(constants.file, columns, where)
    try:
        law = maker(**shared_constants(constants.declared, values, np.ones(1)))
    except InputError as error:
        raise _about(error, key_of, section) from error
    return PressureLaw(law, given.allocation or "area", section)


@dataclass(frozen=True)
class NamedLaw:
    """A contact law that a study names for a face, with its constants for the whole face.

    ``section`` is the one of the study file that names it; ``keys`` are those of the values that the joint gives, where
    they are not keys of this section.
    """

    interface: str
    name: str
    declaration: Declaration
    constants: LawConstants
    section: str
    keys: Mapping[str, str] = field(default_factory=dict)

    @property
    def declared(self) -> Mapping[str, Constant]:
        """The declarations of the constants of the law."""
        return self.declaration.constants

    def of_pairs(self, pairs: FacePairs, members: IntArray, joint: Mapping[str, FloatArray]) -> ContactLaw:
        """The law of the pairs ``members`` of this face; ``joint`` contains the constants of the joint, by name.

        Raises InputError that names the key.
        """
        gap = pairs.gap[members]
        if GAP not in self.declaration.of_joint and (gap > 0.0).any():
            raise InputError(
                f"{self.section}: {np.count_nonzero(gap > 0.0)} of {members.size} pairs have a gap, of up to "
                f'{1e3 * gap.max():.3g} mm, but the law "{self.name}" has no gap. If the bodies touch and only their '
                'meshes differ, set adjust = "closed".',
                (self.section,),
            )
        share = area_fraction(pairs.area[members], pairs.face[members])
        arguments = shared_constants(self.declared, self.constants.values, share)
        try:
            law: ContactLaw = contact_law(self.name)(
                **arguments, **{name: joint[name] for name in self.declaration.of_joint if name in joint}
            )
        except InputError as error:
            key_of = {name: f"{self.section}.constants.{name}" for name in self.declared}
            key_of |= {name: f"{self.section}.{_KEYS.get(name, name)}" for name in self.declaration.of_joint}
            key_of |= self.keys
            raise _about(error, key_of, self.section) from error
        if law.n_pairs != members.size:
            raise InputError(
                f'{self.section}: the law "{self.name}" is for {law.n_pairs} pairs, but the face has {members.size}. A '
                "law gets the number of pairs from a constant that it declares with of_face=True, or from the joint.",
                (f"{self.section}.law",),
            )
        return law


_KEYS = {FRICTION: "friction"}  # constants that the keys of an interface call otherwise


def _about(error: InputError, key_of: Mapping[str, str], section: str) -> InputError:
    """The error of a law about keys of the study file."""
    keys = tuple(key_of.get(name, name) for name in error.keys) or (section,)
    named = error.reworded(f"{', '.join(keys)}: {error}")
    named.keys = keys
    return named
