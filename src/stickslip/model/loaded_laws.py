"""Contact laws that take their normal load from the joint, under a solved preload.

The static solution follows the pressure-gap curve of the faces. About the state at rest, a pair that this curve loads
gets the law of its face, with its load and the slope of the curve there. A pair that is open, or on the linear start of
the curve, keeps Coulomb friction with the spring of this start: such a law has no open pairs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from stickslip.contact.constants import FRICTION, GAP, NORMAL_LOAD, STIFFNESSES
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.contact.law.law import ContactLaw
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.model.face_laws import NamedLaw
from stickslip.model.joint import Joint
from stickslip.structure.mesh import IntArray


def without_loaded_laws(joint: Joint) -> Joint:
    """The joint under its static load: faces whose law takes its load from the joint have Coulomb friction."""
    return replace(joint, laws=tuple(each for each in joint.laws if not each[0].declaration.follows_load))


def with_loaded_laws(joint: Joint, pairs: ContactPairs, least: FloatArray) -> ContactPairs:
    """The Coulomb ``pairs`` about a state at rest, with the laws that faces of the ``joint`` name.

    ``least`` (n_pairs,) N is the load at the end of the linear start of the curve. Raises InputError for a law that
    cannot retain the traction of the state.
    """
    named = [(each, members) for each, _, members in joint.laws if each.declaration.follows_load]
    if not named:
        return pairs
    rest = pairs.coulomb
    follows = rest.normal_load > least
    laws: list[ContactLaw] = []
    groups: list[IntArray] = []
    for each, members in named:
        group = members[follows[members]]
        if group.size:
            laws.append(_law_about(joint, each, rest, group))
            groups.append(group)
    others = np.setdiff1d(np.arange(pairs.n_pairs), np.concatenate([[], *groups]))
    if others.size:
        laws, groups = [rest.of_members(others), *laws], [others, *groups]
    return ContactPairs.with_laws(pairs.operator, laws, groups)


def _law_about(joint: Joint, named: NamedLaw, rest: CoulombLaw, group: IntArray) -> ContactLaw:
    """The law of some pairs of a face about the state at rest that ``rest`` has."""
    values = {name: getattr(rest, name)[group] for name in (NORMAL_LOAD, GAP, FRICTION, *STIFFNESSES)}
    law = named.of_pairs(joint.face_pairs, group, values)
    if rest.residual_traction is None:
        return law
    if not isinstance(law, FrictionLaw):
        raise InputError(
            f'preload.residual_traction is "kept", but the law "{named.name}" of {named.section} retains no traction. '
            'Use "released".',
            ("preload.residual_traction",),
        )
    return law.with_traction(rest.residual_traction[group])


def laws_at_rest(joint: Joint, pairs: ContactPairs) -> Iterator[tuple[NamedLaw, ContactLaw, IntArray]]:
    """The laws beside Coulomb's that the faces of the ``joint`` name, as ``pairs`` have them at rest."""
    for named, _, members in joint.laws:
        for law, group in zip(pairs.laws, pairs.members, strict=True):
            if not isinstance(law, CoulombLaw) and np.isin(group, members).all():
                yield named, law, group
