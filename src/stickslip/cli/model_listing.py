"""Output of `stickslip import` for a model file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.terminal import printable
from stickslip.formats.meshes.build import build_model
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.read import read_raw
from stickslip.formats.meshes.unit_systems import LENGTH_UNITS, UNIT_SYSTEMS, find_unit_system
from stickslip.structure.constraints import eliminate
from stickslip.structure.faces import face_geometry
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.model_facts import body_volumes, bounding_box
from stickslip.structure.tied_parts import supported_groups

_AXES = ("x", "y", "z")
Rows = list[tuple[str, ...]]


def print_model(
    path: Path,
    length_unit: str | None,
    unit_system: str | None,
    includes_outside: bool,
    temperature: float | None = None,
) -> None:
    """Print bodies, sets, constraints and messages of a model file as tables. Raises ImportFileError and InputError.

    Without a length unit there are no sizes, but two guesses of the size with a request for the unit.
    """
    from rich.console import Console
    from rich.table import Table

    if unit_system is not None and length_unit is None:
        raise InputError("--unit-system requires --length-unit. Give both.")
    units_known = length_unit is not None
    units = find_unit_system(length_unit or "m", unit_system)
    raw = read_raw(path, includes_outside)
    model = build_model(raw, units, temperature)
    console = Console(soft_wrap=True)
    console.print(printable(f"{model.source}: {model.format}"), markup=False)
    for title, heading, rows in _tables(model, units_known):
        if rows:
            table = Table(title=title, title_justify="left")
            for column, name in enumerate(heading):
                table.add_column(name, justify="left" if column == 0 else "right", overflow="fold")
            for row in rows:
                table.add_row(*map(printable, row))
            console.print(table, markup=False)
    for sentence in _messages(model, units_known):
        console.print(printable(sentence), markup=False)
    if not units_known:
        console.print(printable(_ask_for_unit(raw)), markup=False)


def _tables(model: ImportedModel, units_known: bool) -> Iterator[tuple[str, tuple[str, ...], Rows]]:
    mesh = model.mesh
    low, high = bounding_box(mesh.points)
    if units_known:
        limits: Rows = [
            (axis, f"{1e3 * start:.6g}", f"{1e3 * stop:.6g}", f"{1e3 * (stop - start):.6g}")
            for axis, start, stop in zip(_AXES, low, high, strict=True)
        ]
        yield "Bounding box", ("axis", "from, mm", "to, mm", "size, mm"), limits
    yield "Bodies", ("name", "elements", "nodes", "free faces", "kinds"), _bodies(model)
    if units_known:
        yield "Masses", ("name", "volume, mm3", "mass, kg", "E, GPa", "density, kg/m3"), _masses(model)
    yield (
        "Face sets",
        ("name", "sides", "nodes", *(("area, mm2",) if units_known else ()), "body"),
        [_face(mesh, name, units_known) for name in mesh.face_sets],
    )
    others = [name for name in mesh.node_sets if name not in mesh.face_sets and name not in mesh.element_sets]
    yield "Node sets", ("name", "nodes"), [(name, f"{mesh.node_sets[name].size}") for name in others]
    yield "Reference nodes", ("node", "set", "position, mm"), _reference_nodes(model) if units_known else []
    yield "Element sets", ("name", "elements"), [(name, f"{cells.size}") for name, cells in mesh.element_sets.items()]


def _reference_nodes(model: ImportedModel) -> Rows:
    """Number, node set and position of each reference node of a coupling or rigid body."""
    if model.equations is None:
        return []
    names = {label: name for name, label in model.reference_sets.items()}
    return [
        (f"{label}", names.get(label, ""), ", ".join(f"{1e3 * value:.6g}" for value in place))
        for label, place in sorted(model.equations.places.items())
    ]


def _bodies(model: ImportedModel) -> Rows:
    mesh = model.mesh
    rows: Rows = []
    for number, name in enumerate(mesh.body_names):
        kinds = dict.fromkeys(block.kind for block in mesh.blocks if (block.body == number).any())
        free = sum(len(side) for side in mesh.outer_sides(number))
        nodes = mesh.nodes_of_body(number).size
        rows.append((name, f"{(mesh.body == number).sum()}", f"{nodes}", f"{free}", ", ".join(kinds)))
    return rows


def _face(mesh: Mesh, name: str, units_known: bool) -> tuple[str, ...]:
    """Row of a face set: sides, nodes, area and the bodies that its nodes belong to."""
    nodes, area, _ = face_geometry(mesh, name)
    sides = sum(len(side) for side in mesh.sides(name))
    bodies = [each for number, each in enumerate(mesh.body_names) if np.isin(nodes, mesh.nodes_of_body(number)).any()]
    size = (f"{1e6 * area.sum():.6g}",) if units_known else ()
    return name, f"{sides}", f"{nodes.size}", *size, ", ".join(bodies)


def _masses(model: ImportedModel) -> Rows:
    rows: Rows = []
    for name, volume in zip(model.mesh.body_names, body_volumes(model.mesh), strict=True):
        material = model.materials.get(name)
        if material is None:
            rows.append((name, f"{1e9 * volume:.6g}", "no material", "", ""))
        else:
            modulus = f"{1e-9 * material.young_modulus:.6g}"
            modulus += "" if material.elastic is None else " (average)"
            mass = f"{material.density * volume:.6g}"
            rows.append((name, f"{1e9 * volume:.6g}", mass, modulus, f"{material.density:.6g}"))
    return rows


def _messages(model: ImportedModel, units_known: bool) -> Iterator[str]:
    mesh = model.mesh
    if units_known:
        yield f"Units: lengths in {model.length_unit}, materials and forces in the system {model.unit_system}."
    tied = None if model.equations is None else eliminate(model.equations, model.fixed_unknowns)
    supported, spring_constraints = model.fixed_unknowns, None
    if model.attachments is not None:
        supported, spring_constraints = model.attachments.supports(supported, tied)
    for number, group in enumerate(supported_groups(mesh, supported, tied, spring_constraints), start=1):
        bodies = ", ".join(mesh.body_names[body] for body in np.unique(mesh.body[group.cells]))
        for part in group.parts:
            if part.is_hinged:
                element = model.shown(model.element_labels[part.cells[0]])
                yield (
                    f"Warning: connected part {number} ({bodies}; for example element {element}) consists of "
                    f"{part.n_regions} regions that are connected at nodes or edges only, like hinges. Its stiffness "
                    "is singular with any contact. Connect their faces, or separate them."
                )
        if group.free:
            yield (
                f"Connected part {number} ({bodies}) has {group.free} rigid-body motions that the file leaves free: "
                "contact or the study must constrain them."
            )
    if tied is not None:
        yield f"Ties and equations of the file make {tied.dependent_unknowns.size} displacements follow others."
    constrained: IntArray = model.fixed_unknowns if tied is None else tied.zero_unknowns
    if constrained.size:
        yield f"The file sets {constrained.size} displacements of {np.unique(constrained // 3).size} nodes to zero."
    if model.loads:
        total = ", ".join(f"{force:.6g}" for force in np.sum(list(model.loads.values()), axis=0))
        yield f"Forces act on {len(model.loads)} nodes" + (f"; their sum is ({total}) N." if units_known else ".")
    yield from (f"Note: {message}" for message in model.messages)
    yield from (f"Warning: {message}" for message in model.doubts)
    if units_known:
        yield from (f"Warning: {message}" for message in model.warnings)


def _ask_for_unit(raw: RawModel) -> str:
    size = np.ptp(raw.coordinates, axis=0)
    in_metres = " x ".join(f"{value:.4g}" for value in size)
    return (
        f"The file does not state its length unit. The bounding box would be {in_metres} m with --length-unit m, and "
        f"{in_metres} mm with --length-unit mm. Give it: {', '.join(LENGTH_UNITS)}; --unit-system gives the system of "
        f"materials and forces if it is not the usual one: {', '.join(UNIT_SYSTEMS)}."
    )
