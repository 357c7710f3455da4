"""The study file of a model of another program: filled in as far as the model goes, the rest as lines to complete."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from stickslip.case.examples import RESOLUTION
from stickslip.case.template import bare_name
from stickslip.core.errors import InputError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.raw_contacts import GROUND, RawContact
from stickslip.structure.constraints import eliminate
from stickslip.structure.equations import Equations
from stickslip.structure.face_ties import tie_nodes
from stickslip.structure.mesh import Mesh
from stickslip.structure.model_facts import bounding_box

_OPENING = """\
# A study of stickslip on the model {model}.
# No model file contains the excitation, the response, the load of a joint and its contact stiffness. Complete the lines
# that begin with "# GIVE" and remove these words there. Then: stickslip check FILE, stickslip run FILE --out DIR.
# "stickslip new OTHER --from FILE" writes the completed study with the frequency range that check proposes.
"""
_UNUSABLE = re.compile(r"[^\w .+()-]")
_LONGEST_NAME = 60  # of a joint; a study allows 64
_INTERNAL = "_"  # Abaqus/CAE begins the names of the sets with it that it makes for surfaces
_SHOWN = 12  # chosen: names of sets in a comment
_MOST_FACES = 40  # chosen: of which faces that touch are searched
_NEAR = 0.01  # chosen: of a face, distance of the boxes around two faces that may touch
_LIES_ON = 0.5  # chosen: fraction of the nodes of each face that lies on the other one
_MATERIAL = ('young_modulus = "... GPa"', "poisson_ratio = ...", 'density = "... kg/m^3"')
_STIFFNESS = (
    "# The contact stiffness follows from [roughness]. Instead, each joint may have normal_stiffness and",
    "# tangential_stiffness, or a law.",
)
_RESOLUTION = (
    "# frequency_start and frequency_stop: those that check proposes, until they are given.",
    *(f"{key} = {json.dumps(value)}" for key, value in RESOLUTION.items()),
)
_LOADS = (
    "# Normal loads at rest: normal_load in each joint, or solved from static loads with [preload] method = "
    '"solved" and [static_loads.NAME], [pressures.NAME], [gravity] or [rotation]; a study uses no load of the model.',
)


def study_of_model(model: ImportedModel, file: str, own_system: str | None) -> str:
    """The text of the study file on ``model``.

    Contact pairs become [interfaces], bonded ones [ties]. Materials, friction coefficients and constraints that the
    model lacks, the normal loads, the contact stiffness, forces and responses are lines to complete.

    Parameters
    ----------
    file:
        path of the model as the study file names it.
    own_system:
        system of units of materials and forces if it was given, else None.

    Raises InputError for one sector of a disk.
    """
    if model.sector:
        raise InputError(
            f"{file} is one sector of a disk: {model.sector}. --from writes studies of complete models. Write the "
            'study with structure.kind = "cyclic" as in docs/bladed_disks.md.'
        )
    where = ('set = "..."', "direction = [0, 0, 1]")
    parts = [
        _OPENING.format(model=_text(file)),
        _section("study", [f"title = {_text(Path(file).stem)}"]),
        _section("structure", _structure(model, file, own_system)),
        *_bodies(model),
        *_joints(model),
        "\n".join(_STIFFNESS) + "\n" + _to_complete("roughness", ('sq = "... um"', 'sample_length = "... mm"')),
        *_excitation(model, where),
        _to_complete("responses.output", where),
        _section("solver", _RESOLUTION),
    ]
    return "\n".join(parts)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False)


def _section(heading: str, lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in (f"[{heading}]", *lines))


def _to_complete(heading: str, lines: Iterable[str]) -> str:
    return "".join(f"# GIVE {line}\n" for line in (f"[{heading}]", *lines))


def _structure(model: ImportedModel, file: str, own_system: str | None) -> Iterator[str]:
    yield 'kind = "mesh"'
    yield f"file = {_text(file)}"
    yield f"length_unit = {_text(model.length_unit)}"
    if own_system is not None:
        yield f"unit_system = {_text(own_system)}"
    zero = model.fixed_unknowns
    if model.equations is not None:
        zero = eliminate(model.equations, zero).zero_unknowns
    if zero.size:
        yield f"# The model constrains {zero.size} displacements of {np.unique(zero // 3).size} nodes."
    else:
        yield '# GIVE fixed = ["..."]'
    yield from _sets(model)


def _sets(model: ImportedModel) -> Iterator[str]:
    """The names that a study may use."""
    mesh = model.mesh
    faces = sorted(mesh.face_sets)
    others = sorted(
        (name for name in mesh.node_sets.keys() - mesh.face_sets.keys() if name[0] not in _INTERNAL),
        key=lambda name: (name in mesh.element_sets, name),
    )
    for words, names in (("Face sets", faces), ("Other sets", others)):
        if names:
            more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
            yield f"# {words}: {', '.join(map(_text, names[:_SHOWN]))}{more}."
    labels = [] if model.equations is None else _moving(model.equations)
    if labels:
        of_sets = {label: f" (set {_text(name)})" for name, label in model.reference_sets.items()}
        more = f" and {len(labels) - _SHOWN} more" if len(labels) > _SHOWN else ""
        listed = ", ".join(f"node = {label}{of_sets.get(label, '')}" for label in labels[:_SHOWN])
        yield f"# Reference nodes, positions of forces and responses: {listed}{more}."


def _moving(equations: Equations) -> list[int]:
    """The reference nodes that are not clamped, rising."""
    clamped = {key for key, unknown in equations.further.items() if unknown in equations.fixed}
    return sorted(label for label in equations.places if not {(label, axis) for axis in range(3)} <= clamped)


def _bodies(model: ImportedModel) -> Iterator[str]:
    """The bodies with material as comments, those without as sections to complete."""
    for name in model.mesh.body_names:
        material = model.materials.get(name)
        if material is None:
            yield _to_complete(f"bodies.{bare_name(name)}", _MATERIAL)
        else:
            yield (
                f"# Body {_text(name)} has the material of the model: {1e-9 * material.young_modulus:.4g} GPa, "
                f"Poisson's ratio {material.poisson_ratio:.4g}, {material.density:.4g} kg/m^3.\n"
            )


def _joints(model: ImportedModel) -> Iterator[str]:
    names: set[str] = set()
    ties = [pair for pair in model.contacts if pair.is_bonded and pair.second != GROUND]
    joints = [pair for pair in model.contacts if pair not in ties]
    for pair in ties:
        yield _section(
            f"ties.{bare_name(_new_name(pair, names))}",
            ["# Bonded in the model.", f"dependent = {_text(pair.first)}", f"independent = {_text(pair.second)}"],
        )
    if joints:
        yield "".join(f"{line}\n" for line in _LOADS)
    for pair in joints:
        friction = "# GIVE friction = ..." if pair.friction is None else f"friction = {pair.friction!r}"
        sides = [f"first = {_text(pair.first)}", f"second = {_text(pair.second)}"]
        notes = [f"# {note[0].upper()}{note[1:]}." for note in pair.notes]
        lines = [*notes, *sides, friction, '# GIVE normal_load = "... N"']
        yield _section(f"interfaces.{bare_name(_new_name(pair, names))}", lines)
    if not joints:
        yield from _proposed_joints(model.mesh)


def _proposed_joints(mesh: Mesh) -> Iterator[str]:
    """Joints to complete of a model without contact pairs: between faces that touch, else without faces."""
    rest = ("friction = ...", 'normal_load = "... N"')
    touching = list(_touching_faces(mesh))
    for number, (first, second) in enumerate(touching, start=1):
        heading = "interfaces.joint" + (f"_{number}" if len(touching) > 1 else "")
        sides = (f"first = {_text(first)}", f"second = {_text(second)}")
        yield "# The model contains no contact pair; these faces touch.\n" + _to_complete(heading, (*sides, *rest))
    if not touching:
        empty = ('first = "..."', 'second = "..."', *rest)
        yield "# The model contains no contact pairs that slide.\n" + _to_complete("interfaces.joint", empty)


def _touching_faces(mesh: Mesh) -> Iterator[tuple[str, str]]:
    """Pairs of face sets without a common node that lie on each other, the finer one first."""
    names = sorted(mesh.face_sets)[:_MOST_FACES]
    for place, one in enumerate(names):
        for other in names[place + 1 :]:
            nodes = [mesh.node_sets[one], mesh.node_sets[other]]
            if np.isin(nodes[0], nodes[1]).any():
                continue
            boxes = [bounding_box(mesh.points[each]) for each in nodes]
            low, high = np.max([box[0] for box in boxes], axis=0), np.min([box[1] for box in boxes], axis=0)
            size = min(float((box[1] - box[0]).max()) for box in boxes)
            if (low > high + _NEAR * size).any():
                continue
            shares = [
                tie_nodes(mesh.points, here, mesh.face_sets[there]).nodes.size / here.size
                for here, there in zip(nodes, (other, one), strict=True)
            ]
            if min(shares) >= _LIES_ON:
                yield (one, other) if nodes[0].size >= nodes[1].size else (other, one)


def _new_name(pair: RawContact, used: set[str]) -> str:
    """A name that a study allows and no pair has yet."""
    name = _UNUSABLE.sub("_", pair.name)[:_LONGEST_NAME].strip(" .-+()") or "joint"
    number = 2
    chosen = name
    while chosen in used:
        chosen, number = f"{name[: _LONGEST_NAME - 4]} {number}", number + 1
    used.add(chosen)
    return chosen


def _excitation(model: ImportedModel, where: tuple[str, str]) -> Iterator[str]:
    """The force to complete. A study takes over no force of the model; where the model has a single one, the lines have
    its values."""
    rest = (*where, 'amplitude = "... N"')
    comment = ""
    if model.loads:
        force = np.sum(list(model.loads.values()), axis=0)
        place, size = _loaded_place(model), float(np.abs(force).max())
        total = ", ".join(f"{each:.6g}" for each in force)
        nodes = f"{len(model.loads)} nodes" if len(model.loads) > 1 else "a node"
        comment = f"# The model has a force of ({total}) N on {nodes}, which a study does not use by itself"
        if place is None or not size > 0.0:
            comment += ".\n"
        else:
            comment += "; these lines have\n# its values. Keep them if it is the excitation.\n"
            direction = ", ".join(f"{each / size + 0.0:.6g}" for each in force)
            amplitude = f"{np.linalg.norm(force):.6g} N"
            rest = (place, f"direction = [{direction}]", f"amplitude = {_text(amplitude)}")
    yield comment + _to_complete("forces.drive", rest)


def _loaded_place(model: ImportedModel) -> str | None:
    """The place of the model's forces as a key of a study; None unless it is one node, or a node set under equal
    forces."""
    labels, forces = list(model.loads), np.array(list(model.loads.values()))
    if len(labels) == 1:
        return f"node = {labels[0]}"
    if np.isin(labels, list(model.reference_forces)).any() or not np.allclose(forces, forces[0]):
        return None
    loaded = np.sort(model.node_numbers(np.array(labels)))
    names = (name for name, nodes in model.mesh.node_sets.items() if np.array_equal(np.sort(nodes), loaded))
    name = next(names, None)
    return None if name is None else f"set = {_text(name)}"
