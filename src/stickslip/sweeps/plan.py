"""The cases of a sweep: every combination of the varied keys, validated before anything is solved, and its name."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from dataclasses import dataclass

from stickslip.case import Case
from stickslip.errors import InputError, StudyFileError
from stickslip.results.storage import FORMAT_VERSION
from stickslip.results.sweep_table import SweptKey, Value
from stickslip.sweeps.axes import UNSWEPT_SECTIONS, study_value
from stickslip.sweeps.work import worker_version

LARGEST_SWEEP = 20_000
_SHOWN_ERRORS = 10
_STRUCTURE_SECTIONS = ("geometry", "mesh", "material", "reduction")


@dataclass(frozen=True)
class PlannedCase:
    """One case of a sweep.

    name:
        short and readable, with the first digits of ``key``; the name of its folder.
    key:
        hash of every input that can change its results, and of the version and the code of stickslip.
    structure:
        hash of what the reduced structure follows from: geometry, mesh, material, reduction.
    values:
        its value of each swept key.
    """

    name: str
    key: str
    structure: str
    values: tuple[Value, ...]
    case: Case


def plan_cases(case: Case, keys: tuple[SweptKey, ...]) -> tuple[PlannedCase, ...]:
    """Every combination of the values of ``keys``, the last key running fastest.

    Raises StudyFileError that names the combinations which are not valid, InputError for too many cases.
    """
    count = math.prod(len(key.values) for key in keys)
    if count > LARGEST_SWEEP:
        sizes = " x ".join(str(len(key.values)) for key in keys)
        raise InputError(f"the sweep has {sizes} = {count} cases; at most {LARGEST_SWEEP} are possible. Vary less.")
    planned, wrong = [], []
    for places in itertools.product(*(range(len(key.values)) for key in keys)):
        chosen = list(zip(keys, places, strict=True))
        try:
            valid = case.replace({key.name: study_value(key, place) for key, place in chosen})
        except StudyFileError as error:
            where = ", ".join(f"{key.name} = {key.labels[place]}" for key, place in chosen)
            sentences = str(error).splitlines()[1:]
            wrong.append(f"  {where}: {' '.join(sentence.strip() for sentence in sentences)}")
            continue
        key_of_case, structure = case_hashes(valid)
        words = "_".join(f"{_bare(key.name)}-{key.labels[place]}" for key, place in chosen)
        name = f"{re.sub(r'[^A-Za-z0-9.+_-]', '', words)[:80]}_{key_of_case[:12]}"
        values = tuple(key.values[place] for key, place in chosen)
        planned.append(PlannedCase(name, key_of_case, structure, values, valid))
    if wrong:
        more = [f"  and {len(wrong) - _SHOWN_ERRORS} more"] if len(wrong) > _SHOWN_ERRORS else []
        heading = f"{len(wrong)} of {count} cases of the sweep are not valid; nothing was solved."
        raise StudyFileError("\n".join([heading, *wrong[:_SHOWN_ERRORS], *more]))
    return tuple(planned)


def _bare(name: str) -> str:
    return name.split(".")[1]


def case_hashes(case: Case) -> tuple[str, str]:
    """Hash of the case, version and code, hash of its structure."""
    inputs = case.to_dict()
    answer = {name: section for name, section in inputs.items() if name not in UNSWEPT_SECTIONS}
    structure = {name: inputs[name] for name in _STRUCTURE_SECTIONS}
    whole = {"stickslip": worker_version(), "results_format": FORMAT_VERSION, "inputs": answer}
    return _hash(whole), _hash(structure)


def _hash(value: object) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()
