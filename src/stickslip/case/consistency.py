"""Checks that the sections of a study file do not contradict each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from stickslip.case.own_sections import InterfaceSection, OwnPreloadSection, PlaceSection
from stickslip.case.sections import PreloadSection
from stickslip.case.two_blade_sections import WedgePreloadSection
from stickslip.core.errors import InputError


class EntryError(InputError):
    """The entry ``path`` of a study file contradicts others."""

    def __init__(self, path: tuple[str, ...], sentence: str) -> None:
        super().__init__(sentence)
        self.path = path


def preload_errors(preload: PreloadSection, loads: Sequence[str], rough: bool) -> Iterator[EntryError]:
    """Keys that a prescribed preload does not use, and missing keys of a solved one.

    ``loads`` are the sections with static loads of the study; ``rough`` is True if the stiffness of any face follows
    from a roughness.
    """
    if preload.method == "prescribed":
        for name in loads:
            yield EntryError((name,), 'is used by preload.method = "solved" alone. Set it, or take the section out.')
        for key in ("residual_traction", "normal_law"):
            if key in preload.model_fields_set and getattr(preload, key) != type(preload).model_fields[key].default:
                yield EntryError(("preload", key), 'belongs to method = "solved". Set it, or take the key out.')
        return
    if preload.values is not None:
        yield EntryError(("preload", "values"), 'are what method = "solved" finds. Take one of the two out.')
    wedge_force = None
    if isinstance(preload, WedgePreloadSection):
        wedge_force = preload.centrifugal_force
        yield from _wedge_errors(preload, rotates="rotation" in loads)
    if wedge_force is None and not loads:
        yield EntryError(
            ("preload", "method"),
            'is "solved", but there is no static load. Give [rotation] or [static_loads.NAME], or for two blades '
            "preload.centrifugal_force.",
        )
    if preload.normal_law == "pressure-gap" and not rough:
        yield EntryError(
            ("preload", "normal_law"), 'is "pressure-gap", which follows from a roughness. Give [roughness].'
        )


def _wedge_errors(preload: WedgePreloadSection, rotates: bool) -> Iterator[EntryError]:
    """Keys that would load the wedge under a solved preload twice."""
    if preload.friction_coefficient_at_assembly:
        yield EntryError(
            ("preload", "friction_coefficient_at_assembly"),
            'belongs to method = "prescribed"; a solved preload takes [friction]. Take it out.',
        )
    if preload.centrifugal_force is not None and rotates:
        yield EntryError(
            ("preload", "centrifugal_force"),
            "and [rotation] would load the damper twice. Take one of the two out.",
        )


def joint_errors(interfaces: Mapping[str, InterfaceSection], preload: OwnPreloadSection) -> Iterator[EntryError]:
    """Interfaces without stiffness or load, or with two."""
    if not interfaces:
        yield EntryError(("interfaces",), "has no entry. Give at least one section [interfaces.NAME].")
    for name, each in interfaces.items():
        where = ("interfaces", name)
        if (each.normal_stiffness is None) != (each.tangential_stiffness is None):
            lacking = "normal_stiffness" if each.normal_stiffness is None else "tangential_stiffness"
            yield EntryError((*where, lacking), "is missing: give both stiffnesses of a face, or none.")
        solved = preload.method == "solved"
        if each.normal_load is None and preload.values is None and not solved:
            yield EntryError((*where, "normal_load"), "is missing. Give the normal force on this face at rest.")
        if each.normal_load is not None and preload.values is not None:
            yield EntryError((*where, "normal_load"), "and preload.values are both given. Take one of the two out.")
        if each.normal_load is not None and solved:
            yield EntryError((*where, "normal_load"), 'is what preload.method = "solved" finds. Take it out.')


def place_errors(section: str, places: Mapping[str, PlaceSection], has_areas: bool) -> Iterator[EntryError]:
    """Places that are ambiguous or missing; ``has_areas`` is True if the structure has areas."""
    for name, place in places.items():
        where = (section, name)
        given = [key for key in ("set", "point", "node") if getattr(place, key) is not None]
        if len(given) != 1:
            found = " and ".join(given) if given else "none"
            yield EntryError(where, f"must have exactly one of set, point and node, but has {found}.")
        if place.spread is not None and place.set is None:
            yield EntryError((*where, "spread"), "says how a set is loaded, but there is no set. Take it out.")
        if place.spread == "area" and not has_areas:
            yield EntryError((*where, "spread"), 'is "area", but matrices have no areas. Take "equal".')


def excitation_errors(excitations: Mapping[str, Any], harmonics: Mapping[str, int], kept: int) -> Iterator[EntryError]:
    """A missing excitation, and forces in harmonics above ``kept``.

    ``excitations`` are the sections that can excite the structure, ``harmonics`` those of the forces.
    """
    if not any(excitations.values()):
        yield EntryError(("forces",), "has no entry. Give at least one section [forces.NAME].")
    for name, harmonic in harmonics.items():
        if harmonic > kept:
            yield EntryError(
                ("forces", name, "harmonic"),
                f"is {harmonic}, but only solver.harmonics = {kept} are kept. Raise solver.harmonics.",
            )
