"""The blades of a study with [mistuning]: their nodes, and the deviations of each pattern."""

from __future__ import annotations

import numpy as np

from stickslip.case.cyclic_sections import DEVIATION, MistuningSection
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.formats.table_file import read_table
from stickslip.model.kinds.entry import named_entry
from stickslip.structure.mesh import IntArray, Mesh

_COLUMN = "deviation"


def blade_nodes(section: MistuningSection, mesh: Mesh, sectors: int) -> IntArray:
    """The nodes of the blade of a sector. Raises InputError for a set that the mesh does not have, and a pattern of
    another number of blades."""
    _given_pattern(section, sectors)
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


def _given_pattern(section: MistuningSection, sectors: int) -> FloatArray | None:
    """(N,) the deviations of the study; None for random ones."""
    if section.standard_deviation is not None:
        return None
    key = "mistuning.pattern" if section.file is None else "mistuning.file"
    values = section.pattern
    if section.file is not None:
        values = read_table(section.file, {_COLUMN: DEVIATION}, key)[_COLUMN]
    if values is None or len(values) != sectors:
        raise InputError(
            f"{key} has {len(values or ())} deviations, but the disk has {sectors} blades: give one for each, in the "
            "order of the sectors, or standard_deviation for random ones.",
            (key,),
        )
    return np.array(values)
