"""The study file of a model of another program: filled in as far as the model goes, the rest as lines to complete."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from stickslip.case.template import bare_name
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.raw_contacts import GROUND, RawContact

_OPENING = """\
# A study of stickslip on the model {model}.
# No model file contains the excitation, the response, the load of a joint and its contact stiffness. Complete the lines
# that begin with "# GIVE" and remove these words there. Then: stickslip check FILE, stickslip run FILE --out DIR.
# "stickslip new OTHER --from FILE" writes the completed study with the frequency range that check proposes.
"""
_UNUSABLE = re.compile(r"[^\w .+()-]")
_LONGEST_NAME = 60  # of a joint; a study allows 64
_SHOWN = 12  # chosen: names of sets in a comment
_MATERIAL = ('young_modulus = "... GPa"', "poisson_ratio = ...", 'density = "... kg/m^3"')
_STIFFNESS = (
    "# The contact stiffness follows from [roughness]. Instead, each joint may have normal_stiffness and",
    "# tangential_stiffness, or a law.",
)
_LOADS = (
    "# Normal loads at rest: normal_load in each joint, or solved from static loads with [preload] method = "
    '"solved" and [static_loads.NAME].',
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
    """
    where = ('set = "..."', "direction = [0, 0, 1]")
    parts = [
        _OPENING.format(model=_text(file)),
        _section("study", [f"title = {_text(Path(file).stem)}"]),
        _section("structure", _structure(model, file, own_system)),
        *_bodies(model),
        *_joints(model),
        "\n".join(_STIFFNESS) + "\n" + _to_complete("roughness", ('sq = "... um"', 'sample_length = "... mm"')),
        "".join(f"{line}\n" for line in _forces(model)) + _to_complete("forces.drive", (*where, 'amplitude = "... N"')),
        _to_complete("responses.output", where),
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
    if model.fixed_unknowns.size:
        nodes = np.unique(model.fixed_unknowns // 3).size
        yield f"# The model constrains {model.fixed_unknowns.size} displacements of {nodes} nodes."
    else:
        yield '# GIVE fixed = ["..."]'
    yield from _sets(model)


def _sets(model: ImportedModel) -> Iterator[str]:
    """The names that a study may use."""
    mesh = model.mesh
    faces = sorted(mesh.face_sets)
    others = sorted(mesh.node_sets.keys() - mesh.face_sets.keys())
    for words, names in (("Face sets", faces), ("Other sets", others)):
        if names:
            more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
            yield f"# {words}: {', '.join(map(_text, names[:_SHOWN]))}{more}."


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
        empty = ('first = "..."', 'second = "..."', "friction = ...", 'normal_load = "... N"')
        yield "# The model contains no contact pairs that slide.\n" + _to_complete("interfaces.joint", empty)


def _new_name(pair: RawContact, used: set[str]) -> str:
    """A name that a study allows and no pair has yet."""
    name = _UNUSABLE.sub("_", pair.name)[:_LONGEST_NAME].strip(" .-+()") or "joint"
    number = 2
    chosen = name
    while chosen in used:
        chosen, number = f"{name[: _LONGEST_NAME - 4]} {number}", number + 1
    used.add(chosen)
    return chosen


def _forces(model: ImportedModel) -> Iterator[str]:
    """The forces of the model, which a study does not use, as a comment."""
    loaded = np.flatnonzero(model.node_forces.any(axis=1))
    if loaded.size:
        total = ", ".join(f"{force:.6g}" for force in model.node_forces.sum(axis=0))
        yield f"# The model has forces on {loaded.size} nodes with the sum ({total}) N, which a study does not use."
