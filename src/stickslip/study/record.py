"""Data of a solved case for the report, beside its response."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import zip_longest

import numpy as np

from stickslip.case.analysis import ForcedAnalysis
from stickslip.case.case import Case
from stickslip.case.reference import MODE_COUNT
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.exponential import ExponentialContact
from stickslip.contact.law.law import ContactState
from stickslip.contact.pairing.local_axes import mean_tangents
from stickslip.contact.pairing.pairing import FacePairs
from stickslip.contact.pairing.rows import EFFECT_OF_FEW_ROWS, FEW_ROWS, faces_with_few_rows
from stickslip.core.errors import ConvergenceError, StudyFileError
from stickslip.core.progress import Progress
from stickslip.core.validation import FloatArray
from stickslip.model.layout import AnyStructure, Derived
from stickslip.model.model import ReducedModel, kind_of
from stickslip.model.study_structure import study_structure
from stickslip.results.face_directions import FaceDirections
from stickslip.results.record import (
    CONSTANT_STIFFNESS_PEAK,
    ModeRow,
    StudyRecord,
    Value,
    model_frequency,
    reference_deviation,
)
from stickslip.results.response import ForcedResponse
from stickslip.structure.craig_bampton import ReductionRow, reduction_table
from stickslip.structure.substructure import Substructure
from stickslip.study.analyses import forced_curve, solve
from stickslip.study.facts import (
    compared_peaks,
    compared_tractions,
    derived_quantities,
    linear_natural_frequencies,
    resting_state,
    study_warnings,
)

# chosen, in percent: with a smaller deviation nobody doubts that model and reference have the same mode.
SURE_DEVIATION = 1.0
_ON_MAP = 1e-6  # of the size of a map: round-off of positions along its axes
TIED, STUCK, CLOSED_AT_REST = "tied", "stuck", "(pairs closed at rest)"


def study_record(
    case: Case, model: ReducedModel, table: tuple[ReductionRow, ...], response: ForcedResponse
) -> StudyRecord:
    """Data for the report beside the response, without the sketch, which the cases of a sweep have in common."""
    pairs = model.joint.face_pairs
    contact_model = contact_of_modes(pairs, bool(model.pairs.resting_stiffness().all()), model.substructure)
    mode_table = tuple(_mode_rows(table))
    doubts: tuple[str, ...] = ()
    if case.reference is not None:
        if not mode_table:  # a structure without a full model, or a sweep with pairs that are open at rest
            mode_table = tuple(_stuck_rows(response))
            contact_model = STUCK if contact_model == TIED else contact_model
        mode_table = tuple(_beside_reference(mode_table, case.reference.mode_frequencies))
        doubts = _doubtful_order(mode_table)
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
        # those of matrices without positions are all zero
        pair_point=pairs.points if pairs.points.any() else None,
        face_directions=_face_directions(pairs, len(model.joint.face_names)),
        mode_table=mode_table,
        mode_contact=contact_model,
        mode_reference="" if case.reference is None else case.reference.source,
        derived=(*derived_quantities(case, model.joint), *resting_state(model), *linear_natural_frequencies(response)),
        warnings=(*study_warnings(case, model.joint), *doubts, *_few_rows(case, model, response)),
        notes=model.joint.layout.notes,
    )


def _face_directions(pairs: FacePairs, n_faces: int) -> FaceDirections:
    """Position and mean sliding directions of each face; zero directions where its map is not along them: on a closed
    face, and for matrices without node positions."""
    middle, tangents = np.zeros((n_faces, 3)), np.zeros((2, n_faces, 3))
    for face in range(n_faces):
        here = pairs.face == face
        middle[face] = pairs.points[here].mean(axis=0)
        means = mean_tangents(pairs.tangent1[here], pairs.tangent2[here], pairs.area[here])
        if means is not None:
            away = pairs.points[here] @ means.T - pairs.face_position[here]
            if np.ptp(away, axis=0).max() <= _ON_MAP * np.ptp(pairs.face_position[here], axis=0).max():
                tangents[:, face] = means
    return FaceDirections(middle, *tangents)


def changed_inputs(record: StudyRecord) -> tuple[str, ...]:
    """Lines "section.key = value" of the inputs that differ from their defaults; none for the inputs of a version whose
    study files this one rejects."""
    try:
        return Case.from_text(record.inputs).changed_keys()
    except StudyFileError:
        return ()


def _few_rows(case: Case, model: ReducedModel, response: ForcedResponse) -> Iterator[str]:
    """A warning where pairs separate at the peak on faces with few rows of pairs: the border of contact is coarse."""
    pairs = model.joint.face_pairs
    few = faces_with_few_rows(pairs.face, pairs.face_position)
    peak = int(response.amplitude(next(iter(model.outputs.values()))).argmax())
    opening = response.contact_state[peak] == ContactState.SEPARATING
    coarse = {face: rows for face, rows in few.items() if opening[pairs.face == face].any()}
    if coarse:
        names = ", ".join(f"{rows} on {model.joint.face_names[face]}" for face, rows in coarse.items())
        yield (
            f"At the peak {int(opening.sum())} pairs separate, on faces with few rows of pairs: {names}. The border "
            f"of contact is then coarse: {EFFECT_OF_FEW_ROWS}. Compare with at least {FEW_ROWS} rows: "
            f"{case.finer_faces}."
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
    retained = case.preload.residual_traction != "kept"
    changed = replace(model, pairs=model.preload.pairs_about(other, retained))
    curve_only = case.model_copy(update={"analysis": ForcedAnalysis()})
    try:
        return compared_tractions(case, response, solve(curve_only, changed, progress, threads), output)
    except ConvergenceError as error:
        return compared_tractions(case, response, str(error), output)


def with_constant_stiffness(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int
) -> tuple[Derived, ...]:
    """The peak with constant springs, if the stiffness of any pair follows the momentary pressure."""
    pairs = model.pairs
    if not any(isinstance(each, ExponentialContact) for each in pairs.laws):
        return ()
    laws = [each.with_constant_stiffness() if isinstance(each, ExponentialContact) else each for each in pairs.laws]
    changed = replace(model, pairs=ContactPairs.with_laws(pairs.operator, laws, pairs.members))
    curve_only = case.model_copy(update={"analysis": ForcedAnalysis()})
    other: ForcedResponse | str
    try:
        other = forced_curve(curve_only, changed, progress, threads, checks=False)
    except ConvergenceError as error:
        other = str(error)
    output, of_study = next(iter(model.outputs.values())), "this study's stiffness follows the momentary pressure"
    return compared_peaks(CONSTANT_STIFFNESS_PEAK, of_study, response, other, output)


def compare_modes(
    structure: AnyStructure, substructure: Substructure, pairs: FacePairs, springs: FloatArray | None = None
) -> tuple[ReductionRow, ...]:
    """Frequencies of the full and the reduced model, with the contact of :func:`contact_of_modes`.

    ``springs`` (3 * n_pairs,) N/m are 0 where a pair is open at rest; None means that all pairs are closed. Empty for a
    structure from matrices, a sector of a disk, and for pairs that are not tied without ``springs``.
    """
    is_tied = contact_of_modes(pairs, springs is None or bool(springs.all()), substructure) == TIED
    full = study_structure(structure).full_model
    if full is None or not (is_tied or springs is not None):
        return ()
    superelement = substructure.require_structure()
    return reduction_table(full, superelement, pairs, count=MODE_COUNT, springs=None if is_tied else springs)


def contact_of_modes(pairs: FacePairs, all_closed: bool, substructure: Substructure) -> str:
    """Contact in the mode table: tied if all pairs are node to node and have unknowns, else stuck on their springs.

    A pair that is open at rest stays open, as in the linear stuck curve; a joint with such a pair (not ``all_closed``)
    is never tied, because ties would close it.
    """
    if not all_closed:
        return f"{STUCK} {CLOSED_AT_REST}"
    return TIED if pairs.is_matching and substructure.has_all_pairs else STUCK


def _mode_rows(table: tuple[ReductionRow, ...]) -> Iterator[dict[str, Value]]:
    """Rows of the mode table."""
    for row in table:
        cells: dict[str, Value] = {
            "mode": row.mode,
            "full_hz": row.full_hz,
            "reduced_hz": row.reduced_hz,
        }
        # Neither is a number for a body that moves freely; a sector has no modes of the full model.
        others = {"difference_percent": row.difference_percent, "mac": row.mac}
        cells |= {name: value for name, value in others.items() if not math.isnan(value)}
        yield cells


def _stuck_rows(response: ForcedResponse) -> Iterator[dict[str, Value]]:
    """Rows of the model that was solved, pairs closed at rest stuck, where no full model is compared with it."""
    for place, frequency_hz in enumerate(response.linear.stuck_frequency_hz[:MODE_COUNT]):
        yield {"mode": place + 1, "reduced_hz": float(frequency_hz)}


def _beside_reference(rows: Sequence[dict[str, Value]], reference_hz: Sequence[float]) -> Iterator[dict[str, Value]]:
    """The rows with the reference of their mode, and what the reference has beyond them; 0 Hz is no reference."""
    for place, (row, frequency_hz) in enumerate(zip_longest(rows, reference_hz, fillvalue=None)):
        cells = row or {"mode": place + 1}
        yield {**cells, "reference_hz": frequency_hz} if frequency_hz else cells


def _doubtful_order(rows: Sequence[ModeRow]) -> tuple[str, ...]:
    """A warning for references that are closer to another mode than to that of their row: rows compare by order."""
    modes = {row["mode"]: model for row in rows if (model := model_frequency(row)) is not None}
    doubtful = []
    for row in rows:
        deviation, reference = reference_deviation(row), row.get("reference_hz")
        if deviation is None or reference is None or abs(deviation) <= SURE_DEVIATION:
            continue
        closest = min(modes, key=lambda mode: abs(modes[mode] - float(reference)))
        if closest != row["mode"]:
            doubtful.append(f"{reference:g} Hz of mode {row['mode']} is closest to mode {closest} of the model")
    if not doubtful:
        return ()
    return (
        f"reference.mode_frequencies are compared in their order, but {'; '.join(doubtful)}. If the source has no "
        "frequency of a mode, give 0 there; compare the mode shapes.",
    )
