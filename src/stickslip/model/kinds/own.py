"""What studies of a user's own mesh and of a user's own matrices share: loads of faces, forces, responses, words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stickslip.contact.preload import prescribed_preload
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.model.joint import STARTING_PRESSURE, FaceSettings
from stickslip.model.layout import Layout, PortForce, Reading

if TYPE_CHECKING:
    from stickslip.case.case import Case
    from stickslip.case.own_sections import PortSection

PORT_SECTIONS = ("forces", "responses", "static_loads")


def port_sections(case: Case) -> dict[str, PortSection]:
    """section.NAME -> the place of every force and response of a case."""
    return {f"{section}.{name}": port for section in PORT_SECTIONS for name, port in getattr(case, section).items()}


def preload(case: Case, layout: Layout) -> FloatArray:
    """(n_pairs,) N: each face's normal load with uniform pressure on the pairs that touch, or as prescribed; where it
    is solved, a pressure to start from.

    Raises InputError for a number of values that is not that of the pairs, and for a load on a face that is apart.
    """
    pairs = layout.face_pairs
    if case.preload.method == "solved":
        return STARTING_PRESSURE * pairs.area
    if case.preload.values is not None:
        count = np.bincount(pairs.face)
        if len(case.preload.values) != pairs.n_pairs:
            parts = ", ".join(f"{n} of {name}" for n, name in zip(count, layout.face_names, strict=True))
            raise InputError(
                f"preload.values has {len(case.preload.values)} entries, but there are {pairs.n_pairs} contact pairs "
                f"({parts}). Give one force for each, in this order, or normal_load of each interface instead.",
                ("preload.values",),
            )
        return prescribed_preload(case.preload.values, pairs.n_pairs)
    load = np.zeros(pairs.n_pairs)
    for face, (name, given) in enumerate(case.interfaces.items()):
        touching = (pairs.face == face) & (pairs.gap <= 0.0)
        if given.normal_load is None or not touching.any():
            raise InputError(
                f"interfaces.{name}: the normal load cannot rest on this face, because all of its pairs are apart by "
                f"{1e3 * pairs.gap[pairs.face == face].min():.3g} mm or more. If the bodies touch and only their "
                'meshes differ, set adjust = "closed".',
                (f"interfaces.{name}.normal_load",),
            )
        load[touching] = given.normal_load * pairs.area[touching] / pairs.area[touching].sum()
    return load


def face_settings(case: Case) -> tuple[FaceSettings, ...]:
    """Friction and stiffness of each interface, its own or those of [friction] and [contact_stiffness]."""
    common = FaceSettings.of_case(case)
    settings = []
    for each in case.interfaces.values():
        stiffness = common.stiffness
        if each.normal_stiffness is not None and each.tangential_stiffness is not None:
            stiffness = (each.normal_stiffness, each.tangential_stiffness)
        settings.append(FaceSettings(common.friction if each.friction is None else each.friction, stiffness))
    return tuple(settings)


def forces(case: Case) -> tuple[PortForce, ...]:
    """The harmonic forces."""
    return tuple(
        PortForce(f"forces.{name}", each.direction, each.amplitude, each.phase) for name, each in case.forces.items()
    )


def static_forces(case: Case) -> tuple[PortForce, ...]:
    """The constant forces."""
    return tuple(
        PortForce(f"static_loads.{name}", each.direction, each.force) for name, each in case.static_loads.items()
    )


def outputs(case: Case) -> tuple[dict[str, Reading], dict[str, tuple[str, ...]]]:
    """The responses, the first one that of the curve; all are drawn together."""
    readings = {name: Reading(f"responses.{name}", each.direction) for name, each in case.responses.items()}
    return readings, {"Responses": tuple(readings)}


def force_amplitude(case: Case) -> float:
    """N of the largest force."""
    return max(each.amplitude for each in case.forces.values())


def description(case: Case) -> str:
    """Forces, normal loads and friction in one sentence."""
    acting = " and ".join(f"{each.amplitude:g} N at {name}" for name, each in case.forces.items())
    settings = face_settings(case)
    joints = "; ".join(
        f"{name}: "
        + ("" if each.normal_load is None else f"normal load {each.normal_load:g} N, ")
        + f"friction {given.friction:g}"
        for (name, each), given in zip(case.interfaces.items(), settings, strict=True)
    )
    return f"Force {acting}. {joints}.{_preload_words(case)}"


def _preload_words(case: Case) -> str:
    """What a preload that no interface gives comes from."""
    given = case.preload
    if given.method == "prescribed":
        return "" if given.values is None else " Prescribed preload."
    loads = [f"{each.force:g} N at {name}" for name, each in case.static_loads.items()]
    loads += [] if case.rotation is None else [f"rotation at {case.rotation.speed:g} rad/s"]
    return f" Preload solved from {' and '.join(loads)}, tractions at rest {given.residual_traction}."


def rough_face_size(case: Case) -> tuple[float, float]:
    """m: a patch as long as the longest wave of the surface, and a quarter as wide."""
    assert case.roughness is not None
    return case.roughness.sample_length, 0.25 * case.roughness.sample_length


def is_fitted(case: Case) -> bool:
    """Only the two blades were fitted to the paper."""
    return False
