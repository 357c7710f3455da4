"""Data of a solved case for the report, beside its response."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from stickslip.case.case import Case
from stickslip.contact.pairing.pairing import FacePairs
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import Progress
from stickslip.core.validation import FloatArray
from stickslip.model.layout import Derived
from stickslip.model.model import ReducedModel, kind_of
from stickslip.model.solved_preload import resting_pairs
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.structure.craig_bampton import ReductionRow, reduction_table
from stickslip.structure.elasticity import Structure
from stickslip.structure.superelement import Superelement
from stickslip.study.analyses import solve
from stickslip.study.facts import (
    compared_tractions,
    derived_quantities,
    natural_frequencies_found,
    resting_state,
    study_warnings,
)

MODE_COUNT = 10  # rows of the mode table
TIED, CLOSED_AT_REST = "tied", "(pairs closed at rest)"


def study_record(
    case: Case, model: ReducedModel, table: tuple[ReductionRow, ...], response: ForcedResponse
) -> StudyRecord:
    """Data for the report beside the response, without the sketch, which the cases of a sweep have in common."""
    pairs = model.joint.face_pairs
    held = held_contact(pairs, bool(model.pairs.closed_at_rest.all()))
    return StudyRecord(
        title=case.study.title,
        description=kind_of(case).description(case),
        inputs=case.to_text(),
        outputs=dict(model.outputs),
        signal_groups=dict(model.signal_groups),
        face_names=model.joint.face_names,
        pair_face=pairs.face,
        pair_position=pairs.face_position[:, ::-1],  # along the damper first, then up the slope
        pair_area=pairs.area,
        mode_table=tuple(_mode_rows(table, fitted=held == TIED and kind_of(case).is_fitted(case))),
        mode_contact=held,
        derived=(*derived_quantities(case, model.joint), *resting_state(model), *natural_frequencies_found(response)),
        warnings=study_warnings(case, model.joint),
    )


def with_other_tractions(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int
) -> tuple[Derived, ...]:
    """The peak with the other treatment of tractions at rest, if the preload was solved."""
    if model.preload is None:
        return ()
    output, other = next(iter(model.outputs.values())), model.preload.other
    if other is None:
        return compared_tractions(case, response, model.preload.why, output)
    kept = case.preload.residual_traction != "kept"
    changed = replace(model, pairs=resting_pairs(model.joint, model.superelement, other, kept))
    try:
        return compared_tractions(case, response, solve(case, changed, progress, threads), output)
    except ConvergenceError as error:
        return compared_tractions(case, response, str(error), output)


def compare_modes(
    structure: Structure | Superelement, superelement: Superelement, pairs: FacePairs, springs: FloatArray | None = None
) -> tuple[ReductionRow, ...]:
    """Frequencies of the full and the reduced model, with the contact of :func:`held_contact`.

    ``springs`` (3 * n_pairs,) N/m are 0 where a pair is open at rest; None means that all pairs are closed. Empty for a
    structure from matrices, and for pairs that are not tied without ``springs``.
    """
    tied = held_contact(pairs, springs is None or bool(springs.all())) == TIED
    if isinstance(structure, Superelement) or not (tied or springs is not None):
        return ()
    return reduction_table(structure, superelement, pairs, count=MODE_COUNT, springs=None if tied else springs)


def held_contact(pairs: FacePairs, all_closed: bool) -> str:
    """Contact in the mode table: tied if all pairs are node to node, else stuck on their springs.

    A pair that is open at rest stays open, as in the linear stuck curve; a joint with such a pair (not ``all_closed``)
    is never tied, because ties would close it.
    """
    if not all_closed:
        return f"stuck {CLOSED_AT_REST}"
    return TIED if pairs.is_matching else "stuck"


def _mode_rows(table: tuple[ReductionRow, ...], fitted: bool) -> Iterator[dict[str, str | float | int]]:
    """Rows of the mode table; the paper's column only beside tied contact of the geometry that was fitted to it."""
    for row in table:
        cells: dict[str, str | float | int] = {
            "mode": row.mode,
            "full_hz": row.full_hz,
            "reduced_hz": row.reduced_hz,
        }
        if not math.isnan(row.difference_percent):  # it is for a body that moves freely
            cells |= {"difference_percent": row.difference_percent, "mac": row.mac}
        if fitted and row.paper_full_hz is not None:
            cells["table2_hz"] = row.paper_full_hz
        yield cells
