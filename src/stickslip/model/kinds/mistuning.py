"""The blades of a study with [mistuning]: their nodes, and the deviations of each pattern."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip.case.cyclic_sections import DEVIATION, MistuningSection
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.formats.table_file import read_table
from stickslip.model.kinds.entry import named_entry
from stickslip.structure.mesh import IntArray, Mesh

_COLUMN = "deviation"


def blade_nodes(section: MistuningSection, mesh: Mesh, sectors: int) -> IntArray:
    """The nodes of the blade of a sector. Raises InputError for a set that the mesh does not have, and for values of
    another number of blades."""
    _given_pattern(section, sectors)
    if section.damper_loads is not None:
        _require_all("mistuning.damper_loads", "values", section.damper_loads, sectors)
    with named_entry("mistuning.blade"):
        return mesh.node_set(section.blade)


def deviations(section: MistuningSection, sectors: int) -> FloatArray:
    """(n_patterns, N) relative deviations of the natural frequencies of the blades alone.

    Raises InputError for a pattern of another number of blades, ImportFileError for its file.
    """
    given = _given_pattern(section, sectors)
    if given is not None:
        return given[None]
    assert section.standard_deviation is not None  # the section has one of the three
    random = np.random.default_rng(section.seed)
    return np.asarray(section.standard_deviation * random.standard_normal((section.patterns, sectors)))


def mistuning_words(section: MistuningSection) -> str:
    """The source of the deviations."""
    if section.standard_deviation is None:
        return "the pattern of the study" if section.file is None else f"the pattern of {section.file}"
    noun = "pattern" if section.patterns == 1 else "patterns"
    return (
        f"{section.patterns} random {noun} with a standard deviation of {100.0 * section.standard_deviation:g} %, seed "
        f"{section.seed}"
    )


def unequal_dampers(section: MistuningSection, pairs: ContactPairs) -> ContactPairs | list[ContactPairs]:
    """The pairs of each sector, whose normal loads are those of the study times ``damper_loads``."""
    if section.damper_loads is None:
        return pairs
    return [pairs.with_constants(normal_load=factor * pairs.normal_load) for factor in section.damper_loads]


def _given_pattern(section: MistuningSection, sectors: int) -> FloatArray | None:
    """(N,) the deviations of the study; None for random ones."""
    if section.standard_deviation is not None:
        return None
    key = "mistuning.pattern" if section.file is None else "mistuning.file"
    values = section.pattern
    if section.file is not None:
        values = read_table(section.file, {_COLUMN: DEVIATION}, key)[_COLUMN]
    return _require_all(key, "deviations", values or (), sectors)


def _require_all(key: str, noun: str, values: Sequence[float], sectors: int) -> FloatArray:
    """The values (N,) of all sectors. Raises InputError for another number of them."""
    if len(values) != sectors:
        raise InputError(
            f"{key} has {len(values)} {noun}, but the disk has {sectors} blades: give one for each, in the order of "
            "the sectors.",
            (key,),
        )
    return np.array(values)
