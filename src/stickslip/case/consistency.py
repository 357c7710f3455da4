"""Whether the sections of a study file fit its kind of structure and each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from stickslip.case.own_sections import (
    INTERFACE_OF_MESH,
    MATRIX_FILES,
    InterfaceSection,
    Kind,
    PortSection,
    StructureSection,
)
from stickslip.core.errors import InputError

if TYPE_CHECKING:
    from stickslip.case.case import Case

LONGEST_NAME = 200  # of an entry: it heads columns, and names files of a sweep

# Section -> the kinds that have it; the others are refused. Sections that stand not here belong to all kinds.
_OWNERS: dict[str, tuple[Kind, ...]] = {
    "geometry": ("two-blade",),
    "mesh": ("two-blade",),
    "excitation": ("two-blade",),
    "bodies": ("mesh",),
    "rotation": ("two-blade", "mesh"),
    "interfaces": ("mesh", "matrices"),
    "forces": ("mesh", "matrices"),
    "responses": ("mesh", "matrices"),
    "static_loads": ("mesh", "matrices"),
}


class EntryError(InputError):
    """One entry of a study file does not fit the others; ``path`` says which."""

    def __init__(self, path: tuple[str, ...], sentence: str) -> None:
        super().__init__(sentence)
        self.path = path


def require_fit(case: Case) -> None:
    """Raise EntryError for the first entry that does not fit the kind of structure or another entry."""
    for error in _errors(case):
        raise error


def _errors(case: Case) -> Iterator[EntryError]:
    kind = case.structure.kind
    for section in case.named_sections():
        for name in getattr(case, section):
            if not name.isprintable():
                yield EntryError((section, name), "has a control character in its name. Take it out.")
            if len(name) > LONGEST_NAME:
                words = f"has a name of {len(name)} characters. Take one of at most {LONGEST_NAME}."
                yield EntryError((section, name), words)
    for section, owners in _OWNERS.items():
        if kind not in owners and getattr(case, section) and section in case.model_fields_set:
            yield EntryError(
                (section,),
                f'does not belong to a structure of kind "{kind}", only to {" and ".join(owners)}. Take the section '
                "out, or set structure.kind.",
            )
    yield from _preload_errors(case)
    if kind == "two-blade":
        yield from _unwanted(case, tuple(key for key in StructureSection.model_fields if key != "kind"))
        return
    yield from _mesh_errors(case) if kind == "mesh" else _matrix_errors(case)
    yield from _material_errors(case)
    yield from _joint_errors(case)
    for name in ("forces", "responses"):
        if not getattr(case, name):
            yield EntryError((name,), f"has no entry. Give at least one section [{name}.NAME].")
    for name in ("forces", "responses", "static_loads"):
        for key, port in getattr(case, name).items():
            yield from _port_errors((name, key), port, kind)


def _unwanted(case: Case, keys: tuple[str, ...], why: str = "") -> Iterator[EntryError]:
    reason = why or f'does not belong to a structure of kind "{case.structure.kind}".'
    for key in keys:
        if getattr(case.structure, key):
            yield EntryError(("structure", key), f"{reason} Take it out.")


def _matrix_errors(case: Case) -> Iterator[EntryError]:
    given = case.structure
    yield from _unwanted(case, ("fixed", "element"))
    if given.file is not None:
        yield from _unwanted(case, (*MATRIX_FILES, "unit_system", "length_unit"), "stands in the superelement of file.")
        return
    for key in ("stiffness", "mass"):
        if getattr(given, key) is None:
            yield EntryError(("structure", key), "is missing: give file, or stiffness and mass.")
    if given.length_unit is None:
        yield EntryError(
            ("structure", "length_unit"),
            'is missing: matrix files do not say their unit of length. Give "mm", "m" or another one.',
        )


def _mesh_errors(case: Case) -> Iterator[EntryError]:
    yield from _unwanted(case, MATRIX_FILES)
    if case.structure.file is None:
        yield EntryError(("structure", "file"), 'is missing, but a structure of kind "mesh" comes from a file.')
    if case.structure.length_unit is None:
        yield EntryError(
            ("structure", "length_unit"),
            'is missing: a mesh file does not say its unit of length. Give "mm", "m" or another one.',
        )
    for name, interface in case.interfaces.items():
        yield from _missing_sides(name, interface)
        for key in ("normal", "area", "pairs"):
            if getattr(interface, key) is not None:
                yield EntryError(
                    ("interfaces", name, key), "belongs to matrices; the faces of a mesh have their own. Take it out."
                )


def _material_errors(case: Case) -> Iterator[EntryError]:
    given = case.material
    if given is None:
        return
    for key in type(given).model_fields:
        if key not in given.model_fields_set:
            yield EntryError(("material", key), "is missing: the material of your own structure has no default.")


def _joint_errors(case: Case) -> Iterator[EntryError]:
    if case.preload.centrifugal_force is not None:
        yield EntryError(
            ("preload", "centrifugal_force"),
            'is the wedge damper\'s, of kind "two-blade". Give interfaces.NAME.normal_load instead.',
        )
    if case.preload.friction_coefficient_at_assembly:
        yield EntryError(
            ("preload", "friction_coefficient_at_assembly"), 'is the wedge damper\'s, of kind "two-blade". Take it out.'
        )
    if not case.interfaces:
        yield EntryError(("interfaces",), "has no entry. Give at least one section [interfaces.NAME].")
    for name, each in case.interfaces.items():
        where = ("interfaces", name)
        if (each.normal_stiffness is None) != (each.tangential_stiffness is None):
            lacking = "normal_stiffness" if each.normal_stiffness is None else "tangential_stiffness"
            yield EntryError((*where, lacking), "is missing: give both stiffnesses of a face, or none.")
        solved = case.preload.method == "solved"
        if each.normal_load is None and case.preload.values is None and not solved:
            yield EntryError((*where, "normal_load"), "is missing. Give the normal force on this face at rest.")
        if each.normal_load is not None and case.preload.values is not None:
            yield EntryError((*where, "normal_load"), "and preload.values are both given. Take one of the two out.")
        if each.normal_load is not None and solved:
            yield EntryError((*where, "normal_load"), 'is what preload.method = "solved" finds. Take it out.')
        if case.structure.kind == "matrices":
            if each.pairs is None:
                yield from _missing_sides(name, each)
            else:
                for key in ("first", "second", "search_distance"):
                    if getattr(each, key) is not None:
                        yield EntryError((*where, key), "is not used where pairs names the nodes. Take it out.")
            for key, such in (
                ("normal", "[0, 0, 1], out of the first side"),
                ("area", '"180 mm^2", of the whole face'),
            ):
                if getattr(each, key) is None:
                    yield EntryError((*where, key), f"is missing: matrices do not say it. Give it, such as {such}.")
            for key in INTERFACE_OF_MESH:
                if getattr(each, key) is not None:
                    yield EntryError((*where, key), "belongs to faces of a mesh. Take it out.")


def _preload_errors(case: Case) -> Iterator[EntryError]:
    """What a prescribed preload has no use for, and what a solved one needs."""
    given, loads = case.preload, [name for name in ("rotation", "static_loads") if getattr(case, name)]
    if given.method == "prescribed":
        for name in loads:
            yield EntryError((name,), 'is used by preload.method = "solved" alone. Set it, or take the section out.')
        for key in ("residual_traction", "normal_law"):
            if key in given.model_fields_set and getattr(given, key) != type(given).model_fields[key].default:
                yield EntryError(("preload", key), 'belongs to method = "solved". Set it, or take the key out.')
        return
    if given.values is not None:
        yield EntryError(("preload", "values"), 'are what method = "solved" finds. Take one of the two out.')
    if given.friction_coefficient_at_assembly:
        yield EntryError(
            ("preload", "friction_coefficient_at_assembly"),
            'belongs to method = "prescribed"; a solved preload takes [friction]. Take it out.',
        )
    if given.centrifugal_force is not None and case.rotation is not None:
        yield EntryError(
            ("preload", "centrifugal_force"),
            "and [rotation] would load the damper twice. Take one of the two out.",
        )
    if given.centrifugal_force is None and not loads:
        yield EntryError(
            ("preload", "method"),
            'is "solved", but there is no static load. Give [rotation] or [static_loads.NAME], or for two blades '
            "preload.centrifugal_force.",
        )
    measured = [each.normal_stiffness is not None for each in case.interfaces.values()]
    if given.normal_law == "pressure-gap" and (case.roughness is None or (measured and all(measured))):
        yield EntryError(
            ("preload", "normal_law"), 'is "pressure-gap", which follows from a roughness. Give [roughness].'
        )


def _missing_sides(name: str, interface: InterfaceSection) -> Iterator[EntryError]:
    for key in ("first", "second"):
        if getattr(interface, key) is None:
            yield EntryError(("interfaces", name, key), 'is missing. Give the name of a set; second may be "ground".')


def _port_errors(where: tuple[str, str], port: PortSection, kind: Kind) -> Iterator[EntryError]:
    given = [key for key in ("set", "point", "node") if getattr(port, key) is not None]
    if len(given) != 1:
        found = " and ".join(given) if given else "none"
        yield EntryError(where, f"must have exactly one of set, point and node, but has {found}.")
    if port.spread is not None and port.set is None:
        yield EntryError((*where, "spread"), "says how a set is loaded, but there is no set. Take it out.")
    if port.spread == "area" and kind == "matrices":
        yield EntryError((*where, "spread"), 'is "area", but matrices have no areas. Take "equal".')
