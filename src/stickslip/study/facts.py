"""Quantities of a case before the solution, in words and numbers: for `check` and for the report."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from stickslip.case.case import Case, TwoBladeCase
from stickslip.case.key_ranges import ridge_of_study
from stickslip.contact.constants import NORMAL_LOAD
from stickslip.contact.law.law import BoolArray, ContactLaw, ContactState
from stickslip.contact.pairing.pairing import FacePairs
from stickslip.contact.pairing.rows import EFFECT_OF_FEW_ROWS, faces_with_few_rows, rows_of_pairs
from stickslip.core.validation import FloatArray
from stickslip.model.face_laws import NamedLaw
from stickslip.model.joint import Joint, odd_values
from stickslip.model.kinds.damper_words import LOCK_UP_KEYS, lock_up_sentences
from stickslip.model.layout import AnyStructure, Derived, Setup
from stickslip.model.model import kind_of
from stickslip.model.rough_face import RoughFace, waves_of
from stickslip.model.study_structure import study_structure
from stickslip.results.measures import hertz, summary
from stickslip.results.response import ForcedResponse
from stickslip.solve.static.state import StaticState
from stickslip.study.form import form_rows, form_warnings
from stickslip.study.mode import reduced_unknowns

if TYPE_CHECKING:
    from stickslip.model.model import ReducedModel


# chosen: a resultant below this fraction of the sum of its parts is their round-off
ROUND_OFF = 1e-12


def derived_quantities(case: Case, joint: Joint) -> tuple[Derived, ...]:
    """(name, value, unit, explanation) of preload, stiffness and roughness of each face, and of its pairs."""
    loads = _distributed_loads(case, joint)
    return (*_faces(joint), *_roughness(case, joint), *joint.layout.facts, *loads, *kind_of(case).facts(case))


def _distributed_loads(case: Case, joint: Joint) -> Iterator[Derived]:
    """The resultants of rotation, gravity and pressures, which show a wrong unit, set or direction."""
    for section, load in joint.layout.distributed_forces(kind_of(case).load_sizes(case)).items():
        total = load.sum(axis=0)
        total[np.abs(total) <= ROUND_OFF * np.abs(load).sum()] = 0.0
        words = "along x, y, z; with the part on constrained nodes"
        yield f"Static force, {section}", ", ".join(f"{part:.4g}" for part in total), "N", words


def _faces(joint: Joint) -> Iterator[Derived]:
    area = joint.face_sum(joint.face_pairs.area)
    load = joint.face_sum(np.maximum(joint.preload, 0.0))  # a gap carries no force
    normal, tangential = joint.face_sum(joint.normal_stiffness), joint.face_sum(joint.tangential_stiffness)
    open_pairs = joint.face_sum(np.where(joint.closed_at_rest, 0.0, 1.0))
    for face, name in enumerate(joint.face_names):
        other = joint.law_of(face)
        if other is not None:
            yield from _law_of_face(name, *other, int((joint.face_pairs.face == face).sum()))
            continue
        pressure = load[face] / area[face]
        description = "all pairs of the face, "
        if open_pairs[face]:
            description += f"as if the {int(open_pairs[face])} open ones were "
        yield f"Normal load, {name}", float(load[face]), "N", "sum of the preload of its pairs"
        yield f"Mean pressure, {name}", float(1e-6 * pressure), "MPa", "normal load over nominal area"
        yield f"Normal stiffness, {name}", float(normal[face]), "N/m", f"{description}closed"
        yield f"Tangential stiffness, {name}", float(tangential[face]), "N/m", f"{description}stuck"
        yield (
            f"Normal stiffness per unit area, {name}",
            float(1e-9 * normal[face] / area[face]),
            "N/mm³",
            "the usual form of a contact stiffness",
        )


def _stiffness_by_laws(face: RoughFace) -> Iterator[Derived]:
    """The stiffness per area of a rough face by its own law, by the fractal law and by Persson's, with the band."""
    found = face.believable
    if found is None:
        return
    low, high = (float(1e-9 * end) for end in found.band)
    fractal = face.stiffness.normal / face.reference_area
    yield "Stiffness per unit area by Persson's law", float(1e-9 * found.persson), "N/mm³", "of one face, normal"
    if fractal > 0.0:
        yield "Stiffness per unit area by the fractal law", float(1e-9 * fractal), "N/mm³", "of the same face"
    else:
        yield "Stiffness per unit area by the fractal law", "none", "N/mm³", "all spots are plastic, see mode"
    yield "Believable stiffness per unit area", f"{_plain(low)} to {_plain(high)}", "N/mm³", "1/3 to 3 of Persson's law"
    yield "Stiffness of this study over Persson's law", float(found.ratio), "-", "believable: 1/3 to 3"


def _plain(value: float) -> str:
    """Three digits without exponent: 1250, 0.0125."""
    return f"{float(f'{value:.3g}'):g}" if 1e-3 <= value < 1e5 else f"{value:.3g}"


def _law_of_face(name: str, named: NamedLaw, law: ContactLaw, n_pairs: int) -> Iterator[Derived]:
    """A face of ``n_pairs`` whose contact law is not Coulomb's: its load where the law has one, its springs at rest,
    its constants."""
    of_pairs = "of all pairs of the face"
    if law.n_pairs < n_pairs:
        of_pairs = f"of {law.n_pairs} of {n_pairs} pairs; the others carry almost no load and have Coulomb friction"
    yield f"Contact law, {name}", named.name, "-", of_pairs
    if NORMAL_LOAD in named.declaration.of_joint:
        yield f"Normal load, {name}", float(law.normal_load.sum()), "N", "sum over its pairs"
    springs = law.resting_springs().sum(axis=0)
    for direction, value in zip(("t1", "t2", "n"), springs, strict=True):
        yield (
            f"Stiffness of small motions along {direction}, {name}",
            float(value),
            "N/m",
            "sum over its pairs, at rest",
        )
    for key, text, unit in named.constants.rows():
        yield f"{key[0].upper()}{key[1:].replace('_', ' ')}, {name}", text, unit or "-", f"constant {key} of the law"


def _roughness(case: Case, joint: Joint) -> Iterator[Derived]:
    rough = [face for face in joint.rough_faces if face is not None]
    if not rough or case.roughness is None:
        return
    section, first = case.roughness, rough[0]
    waves = waves_of(section)
    yield "Fractal dimension D", section.fractal_dimension, "-", "of the surface; a measure of its fine-scale content"
    yield "Fractal roughness G", waves.fractal_roughness, "m", "scale of the heights"
    yield "Sq", float(1e6 * first.statistics.sq), "µm", "root mean square height between the longest and shortest wave"
    yield "Sdq", float(first.statistics.sdq), "-", "root mean square slope"
    if section.sdq is not None:
        yield (
            "Shortest wave",
            float(1e6 * waves.shortest),
            "µm",
            "from Sq and Sdq; credible if it is about twice the spacing of the measurement",
        )
    yield (
        "Critical spot area",
        float(1e6 * first.stiffness.critical_area),
        "mm²",
        "smaller spots are plastic, larger ones elastic",
    )
    area, where = first.reference_area, "of one face under its preload"
    if section.reference_area is not None:
        where = "of the reference area under the mean pressure of one face"
        yield "Reference area", float(1e6 * area), "mm²", "area for which the contact law uses the pressure of a pair"
    yield "Largest spot area", float(1e6 * first.stiffness.largest_area), "mm²", where
    yield "Real over nominal area", float(first.stiffness.real_area / area), "-", "of one face"
    yield from _stiffness_by_laws(first)
    yield from form_rows(case, joint)
    yield "Load on plastic spots", float(100.0 * first.stiffness.plastic_load_share), "%", "fraction of the preload"


def resting_state(model: ReducedModel) -> tuple[Derived, ...]:
    """Quantities of each face at rest from a solved preload; empty if the preload is prescribed.

    With released tractions the state is that without friction, so no pair is on a friction limit.
    """
    if model.preload is None:
        return ()
    joint, state = model.joint, model.preload.state
    pressure = 1e-6 * state.normal_force / joint.face_pairs.area
    rows: list[Derived] = []
    for face, name in enumerate(joint.face_names):
        here = joint.face_pairs.face == face
        if (other := joint.law_of(face)) is not None and not other[0].declaration.follows_load:
            rows += _resting_face(name, other[1], state, here)
            continue
        opened = int((state.state[here] == ContactState.SEPARATING).sum())
        traction = float(np.linalg.norm(state.traction[here].sum(axis=0)))
        largest = float(pressure[here].max())
        words = "none: with released tractions the state at rest is that without friction"
        rows.append((f"Pairs open at rest, {name}", opened, "-", f"of {int(here.sum())}; solved from the static load"))
        if not model.pairs.released:
            limit = int((state.state[here] == ContactState.STICK_SLIP).sum())
            words = "resultant of the tractions of its pairs"
            meaning = "further motion in the same direction causes slip"
            rows.append((f"Pairs on the friction limit at rest, {name}", limit, "-", meaning))
        rows += [
            (f"Largest pressure at rest, {name}", largest, "MPa", "normal force over area of a pair"),
            (f"Friction force at rest, {name}", traction, "N", words),
        ]
    rows.append(("Balance of forces at rest", state.residual, "-", state.message))
    return tuple(rows)


def _resting_face(name: str, law: ContactLaw, state: StaticState, here: BoolArray) -> list[Derived]:
    """States and forces at rest of a face with another law than Coulomb's."""
    # Without friction the codes of a law with friction do not describe the pairs: all are free to slide.
    has_states = state.memory is not None or not law.frictional().any()
    codes = law.states.items() if has_states else ()
    counts = [(words, int((state.state[here] == code).sum())) for code, words in codes]
    force = (float(state.normal_force[here].sum()), float(np.linalg.norm(state.traction[here].sum(axis=0))))
    of_all = f"of {int(here.sum())}; law {law.name}"
    return [
        *((f"Pairs in the state '{words}' at rest, {name}", count, "-", of_all) for words, count in counts),
        (f"Normal force at rest, {name}", force[0], "N", "sum over its pairs, above 0 for pressure"),
        (f"Tangential force at rest, {name}", force[1], "N", "resultant over its pairs"),
    ]


def compared_tractions(
    case: Case, response: ForcedResponse, other: ForcedResponse | str, output: FloatArray
) -> tuple[Derived, ...]:
    """The peak with the traction at rest retained and released: one is that of the study, ``other`` the other one.

    ``other`` may also be a message with the reason why there is no such curve.
    """
    names = ("kept", "released") if case.preload.residual_traction == "kept" else ("released", "kept")
    label, of_study = f"Peak with tractions at rest {names[1]}", f"this study's tractions are {names[0]}"
    return compared_peaks(label, of_study, response, other, output)


def compared_peaks(
    label: str, of_study: str, response: ForcedResponse, other: ForcedResponse | str, output: FloatArray
) -> tuple[Derived, ...]:
    """The peak of a curve with another choice, ``label``, beside that of the study, which ``of_study`` describes.

    ``other`` may also be a message with the reason why there is no such curve.
    """
    own = summary(response, output)
    if isinstance(other, str):
        return ((label, "no result", "-", other),)
    there = summary(other, output)
    change = 100.0 * (there.peak.amplitude / own.peak.amplitude - 1.0)
    energy = 100.0 * (there.friction_energy / own.friction_energy - 1.0) if own.friction_energy > 0.0 else math.nan
    shift = there.peak.frequency_hz - own.peak.frequency_hz
    words = f"{of_study}; {change:+.2f} % relative to it"
    if not other.converged:
        words += f"; that curve is not complete: {other.message}"
    return (
        (label, float(1e6 * there.peak.amplitude), "µm", words),
        (
            f"{label}: frequency",
            there.peak.frequency_hz,
            "Hz",
            f"{'+' if shift >= 0.0 else ''}{hertz(shift)} Hz relative to this study",
        ),
        (f"{label}: friction energy", float(1e6 * there.friction_energy), "µJ", f"per cycle, {energy:+.1f} %"),
    )


def linear_natural_frequencies(response: ForcedResponse, count: int = 4) -> tuple[Derived, ...]:
    """The first natural frequencies of the two linear limits of this study."""
    limits = {
        "contacts that are closed at rest stuck": ("stuck", response.linear.stuck_frequency_hz),
        "no contact; rigid-body motions omitted": ("free", response.linear.free_frequency_hz),
    }
    return tuple(
        (f"Natural frequencies, {name}", ", ".join(f"{f:.2f}" for f in values[:count]), "Hz", words)
        for words, (name, values) in limits.items()
    )


def study_warnings(case: Case, joint: Joint) -> tuple[str, ...]:
    """Warnings of the input, of the range of a ridge, and of the roughness law, each message once."""
    sentences = dict.fromkeys(message for face in joint.rough_faces if face for message in face.messages)
    found = (*(odd.sentence for odd in odd_values(case, joint.layout)), *joint.layout.messages, *sentences)
    of_case = *kind_of(case).warnings(case), *_lock_up_of_ridge(case)
    return (*found, *form_warnings(case, joint), *joint.stiffness_warnings, *of_case)


def _lock_up_of_ridge(case: Case) -> Iterator[str]:
    """A sentence on the lock-up of the damper where only a part of the range of a ridge has it."""
    ridge = ridge_of_study(case)
    if ridge is None or not isinstance(case, TwoBladeCase) or ridge[0].key not in LOCK_UP_KEYS:
        return
    family, ends = ridge
    yield from lock_up_sentences([each for end in ends if isinstance(each := family.at(end), TwoBladeCase)])


def _rows_of_pairs(pairs: FacePairs) -> Iterator[tuple[str, str]]:
    """The rows of pairs of faces with a grid of them, and what few rows mean."""
    counts = dict.fromkeys(rows_of_pairs(pairs.face, pairs.face_position))
    if counts:
        few = faces_with_few_rows(pairs.face, pairs.face_position)
        note = f"; few, if pairs separate: {EFFECT_OF_FEW_ROWS}" if few else ""
        yield "rows of pairs", " and ".join(f"{one} by {other}" for one, other in counts) + f" on a face{note}"


def sizes(case: Case, setup: Setup, structure: AnyStructure, joint: Joint) -> tuple[tuple[str, str], ...]:
    """Sizes of the model: elements, nodes, unknowns before and after reduction, pairs, and unknowns of the balance."""
    pairs, faces = joint.face_pairs, len(joint.face_names)
    harmonics = case.solver.harmonics
    rows = 3 * pairs.area.size
    unknowns_of_balance = f"{rows} for each coefficient" if harmonics is None else f"up to {rows * (2 * harmonics + 1)}"
    (boundary, modes), known = reduced_unknowns(case, structure, joint), study_structure(structure)
    if known.mesh is None or known.free_unknowns is None:
        unknowns = [("unknowns", f"{boundary}")]
    else:
        is_relative = boundary < 3 * joint.layout.boundary_nodes.size
        kept = "relative ones of pairs and those of boundary nodes" if is_relative else "of boundary nodes"
        unknowns = [
            ("unknowns of the full model", f"{known.free_unknowns.size} free of {3 * known.mesh.n_nodes}"),
            ("unknowns after reduction", f"{boundary + modes} ({boundary} {kept}, {modes} modes)"),
        ]
    return (
        *setup.sizes(),
        *unknowns,
        ("contact pairs", f"{pairs.area.size} on {faces} face{'s' if faces > 1 else ''}"),
        *_rows_of_pairs(pairs),
        ("unknowns of the balance", f"{unknowns_of_balance} ({case.solver.resolution})"),
    )
