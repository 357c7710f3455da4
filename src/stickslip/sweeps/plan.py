"""The cases of a sweep: every combination of the varied keys, validated before anything is solved, and its name."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from stickslip.case.case import Case
from stickslip.case.key_kinds import UNSWEPT_SECTIONS
from stickslip.core.errors import InputError, StudyFileError
from stickslip.results.groups import FORMAT_VERSION
from stickslip.results.sweep_table import SweptKey, Value
from stickslip.sweeps.axes import study_value
from stickslip.sweeps.work import worker_version

KEY_DIGITS = 12  # of the hash of a case, at the end of its name
LARGEST_SWEEP = 20_000  # cases; chosen: every case is validated and hashed before the first one is solved
_SHOWN_ERRORS = 10  # chosen: lines of a message
_STRUCTURE_SECTIONS = ("structure", "geometry", "mesh", "material", "bodies", "ties", "reduction")
# Keys of other sections that determine pairs and places; their other keys do not change the structure.
_PLACE_KEYS = ("set", "point", "node", "spread")
_LAYOUT_KEYS = {
    "interfaces": (
        "first", "second", "points", "search_distance", "edge_tolerance", "gap_tolerance", "gap", "adjust", "tangent",
        "normal", "area", "pairs",
    ),
    "forces": _PLACE_KEYS,
    "responses": _PLACE_KEYS,
    "static_loads": _PLACE_KEYS,
    "unbalance": _PLACE_KEYS,
    "pressures": _PLACE_KEYS,
}  # fmt: skip


@dataclass(frozen=True)
class PlannedCase:
    """One case of a sweep.

    name:
        short and readable, with the first digits of ``key``; the name of its folder.
    key:
        hash of every input that can change its results, and of the version and the code of stickslip.
    structure:
        hash of all inputs of the reduced structure: geometry, mesh, material, reduction; files, pairs and places.
    values:
        its value of each swept key.
    checks:
        whether multipliers and a search for missed peaks belong to its results.
    harmonics:
        those that a similar case required, with which it is solved first; None if none is known.
    wants_stress:
        whether the stress at its peak belongs to its results.
    """

    name: str
    key: str
    structure: str
    values: tuple[Value, ...]
    case: Case
    checks: bool = True
    harmonics: int | None = None
    wants_stress: bool = False


def plan_cases(case: Case, keys: tuple[SweptKey, ...]) -> tuple[PlannedCase, ...]:
    """Every combination of the values of ``keys``, the last key running fastest.

    Raises StudyFileError that names the combinations which are not valid, InputError for too many cases.
    """
    count = math.prod(len(key.values) for key in keys)
    if count > LARGEST_SWEEP:
        sizes = " x ".join(str(len(key.values)) for key in keys)
        raise InputError(
            f"the sweep has {sizes} = {count} cases; at most {LARGEST_SWEEP} are allowed. Use fewer values."
        )
    return plan_rows(case, keys, itertools.product(*(range(len(key.values)) for key in keys)))


def plan_table(
    case: Case, keys: tuple[SweptKey, ...], rows: Sequence[tuple[int, ...]], names: Mapping[str, str]
) -> tuple[tuple[SweptKey, ...], tuple[PlannedCase, ...]]:
    """The keys, and a case for each of the ``rows`` of a table; a case with a folder retains the name of it.

    ``names``: first digits of the key of a case -> name of its folder. Raises as :func:`plan_cases`.
    """
    if len(rows) > LARGEST_SWEEP:
        raise InputError(
            f"the table has {len(rows)} cases with those of the earlier sweeps in this folder; at most {LARGEST_SWEEP} "
            "are allowed. Use fewer values, or another folder."
        )
    planned = plan_rows(case, keys, rows)
    return keys, tuple(replace(each, name=names.get(each.key[:KEY_DIGITS], each.name)) for each in planned)


def plan_rows(
    case: Case, keys: tuple[SweptKey, ...], rows: Iterable[tuple[int, ...]], of: str = "sweep"
) -> tuple[PlannedCase, ...]:
    """A case for each of the ``rows``, which are positions in the values of each key; ``of`` names them in messages.

    Raises StudyFileError that names the rows which are not valid.
    """
    require_one_curve(case, of)
    planned, wrong = [], []
    for places in rows:
        chosen = list(zip(keys, places, strict=True))
        try:
            valid = case.replace({key.name: study_value(key, place) for key, place in chosen})
        except StudyFileError as error:
            where = ", ".join(f"{key.name} = {key.labels[place]}" for key, place in chosen)
            sentences = str(error).splitlines()[1:]
            wrong.append(f"  {where}: {' '.join(sentence.strip() for sentence in sentences)}")
            continue
        key_of_case, structure = case_hashes(valid)
        name = case_name([(key.name, key.labels[place]) for key, place in chosen], key_of_case)
        values = tuple(key.values[place] for key, place in chosen)
        planned.append(PlannedCase(name, key_of_case, structure, values, valid))
    if wrong:
        more = [f"  and {len(wrong) - _SHOWN_ERRORS} more"] if len(wrong) > _SHOWN_ERRORS else []
        count = len(wrong) + len(planned)
        heading = f"{len(wrong)} of {count} cases of the {of} are not valid; nothing was solved."
        raise StudyFileError("\n".join([heading, *wrong[:_SHOWN_ERRORS], *more]))
    return tuple(planned)


def require_one_curve(case: Case, of: str) -> None:
    """Raise InputError for an analysis of more than the frequency curve that no table of cases contains."""
    if case.analysis.gradients:
        raise InputError(
            f"gradients is true, but the cases of a {of} have no gradients: they share a reduced structure without its "
            f"mesh. Set it to false for the {of}, and compute the gradients of single cases with stickslip run.",
            ("analysis.gradients",),
        )
    if case.reduction.pairs == "moving":
        raise InputError(
            f'pairs is "moving", but the cases of a {of} share a reduced structure, and other pairs move in each. Set '
            f'pairs = "all" for the {of}.',
            ("reduction.pairs",),
        )
    if case.analysis.kind != "forced":
        raise InputError(
            f'kind is "{case.analysis.kind}", but the table of a {of} contains only forced responses. Set kind = '
            f'"forced" for the {of}, and compute the other analysis of single cases with stickslip run.',
            ("analysis.kind",),
        )


def case_name(labelled: Iterable[tuple[str, str]], key_of_case: str) -> str:
    """The name of a case with these keys and words for their values."""
    words = "_".join(f"{name.split('.', 1)[1]}-{label}" for name, label in labelled)
    return f"{re.sub(r'[^A-Za-z0-9.+_-]', '', words)[:80]}_{key_of_case[:KEY_DIGITS]}"


def case_hashes(case: Case) -> tuple[str, str]:
    """Hash of the case, version and code, hash of its structure."""
    inputs = case.to_dict()
    answer = {name: section for name, section in inputs.items() if name not in UNSWEPT_SECTIONS}
    structure = {name: inputs[name] for name in _STRUCTURE_SECTIONS if name in inputs}
    for section, keys in _LAYOUT_KEYS.items():
        structure[section] = {
            name: {key: value for key, value in entry.items() if key in keys}
            for name, entry in inputs.get(section, {}).items()
        }
    structure["preload"] = {"method": case.preload.method}  # a solved one has node groups for its load
    structure["excited_at"] = {"base": "base_motion" in inputs}  # its influence needs the mass of the whole mesh
    structure["mistuning"] = {"blade": inputs.get("mistuning", {}).get("blade")}
    structure["weighs"] = {"given": "gravity" in inputs}
    rotation = dict(inputs.get("rotation", {}))
    if rotation.get("top_speed"):  # one reduction for all speeds; else the stiffness is that at the speed
        del rotation["speed"]
    structure["rotation"] = rotation
    files = {name: _content(file) for name, file in case.input_files.items()}
    if files:
        answer["files"], structure["files"] = files, files
    whole = {"stickslip": worker_version(), "results_format": FORMAT_VERSION, "inputs": answer}
    return hash_of(whole), hash_of(structure)


def _content(file: str) -> str:
    """Hash of the content of a file of the structure, or of the files of a folder; a missing file is reported later."""
    path = Path(file.partition("#")[0])
    parts = sorted(path.iterdir()) if path.is_dir() else [path]
    return hashlib.sha256(b"".join(part.read_bytes() for part in parts if part.is_file())).hexdigest()


def hash_of(value: object) -> str:
    """Hash of plain data."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()
