"""The content of a run, before any long computation: for ``stickslip check``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from stickslip.case.analysis import AnalysisSection, ModeAnalysis, WearAnalysis
from stickslip.case.case import Case, CyclicCase
from stickslip.case.key_ranges import ridge_of_study
from stickslip.case.load import has_range
from stickslip.core.errors import concerning
from stickslip.core.plausible import suspecting
from stickslip.model.joint import Joint, odd_values
from stickslip.model.kinds.mistuning import mistuning_words
from stickslip.model.layout import AnyStructure, Layout
from stickslip.model.model import kind_of
from stickslip.model.study_structure import study_structure
from stickslip.results.measures import hertz
from stickslip.study.assembled import Assembled
from stickslip.study.facts import (
    derived_quantities,
    sizes,
    study_warnings,
)
from stickslip.study.mode import MOST_PAIRS_BESIDE, has_estimate, require_allowed_mode, words_beyond_reduction
from stickslip.study.performance_curve import (
    HIGHEST_RATIO,
    LOWEST_RATIO,
    has_performance_curve,
    why_no_performance_curve,
)
from stickslip.study.record import CLOSED_AT_REST
from stickslip.study.stiffness_band import has_stiffness_band
from stickslip.study.wear import energy_coefficients, worn_faces

USUAL_FRICTION = 1.5  # chosen: a larger friction coefficient is hardly that of a joint
SHOWN_FREQUENCIES = 4  # chosen: the lowest ones, as a check of the model


def check(case: Case, assembled: Assembled | None = None) -> list[tuple[str, list[tuple[str, str]]]]:
    """The content of a run, as sections of (label, value); builds the mesh and the joint, unless they are given as
    ``assembled``, but solves nothing, and reduces nothing except for a mode whose law resists only up to some motion.

    Raises InputError for a wrong geometry, a mode that does not exist, or amplitudes at which its law does not resist,
    RoughnessError for a contact without stiffness.
    """
    assembled = assembled or Assembled.of(case)
    setup, joint, structure = assembled.setup, assembled.joint, assembled.structure
    require_allowed_mode(case, structure, joint)
    numbers = [
        (name, f"{_short(value)} {unit}".rstrip("- ")) for name, value, unit, _ in derived_quantities(case, joint)
    ]
    solver = case.solver
    with suspecting(odd_values(case, setup.layout)):
        stuck_hz = study_structure(structure).stuck_frequencies(
            joint.face_pairs, joint.resting_springs, kind_of(case).wave(case), SHOWN_FREQUENCIES
        )
    solved = case.preload.method == "solved"
    constraint = "" if joint.closed_at_rest.all() else " (pairs without a gap)" if solved else f" {CLOSED_AT_REST}"
    sections = [
        ("Sizes", list(sizes(case, setup, structure, joint))),
        ("Derived quantities", numbers),
        (
            "Would run",
            [
                ("sweep", _range_words(case)),
                (f"first natural frequencies, contact stuck{constraint}", ", ".join(map(hertz, stuck_hz)) + " Hz"),
                ("excitation", kind_of(case).description(case)),
                ("resolution", f"{solver.resolution}, {solver.samples} samples"),
                *_mode(case.analysis, joint.face_pairs.n_pairs),
                *_ridge(case),
                *_wear(case, joint),
                *_mistuning(case, setup.layout, structure),
            ],
        ),
    ]
    warnings = list(study_warnings(case, joint))
    if solved:
        warnings.append(
            "A run solves the preload. Normal loads, stiffness and frequencies in this table are those of the "
            "initial pressure of that solution, with all pairs without a gap closed."
        )
    if (stuck_hz == 0.0).any():
        warnings.append(
            "A frequency of 0 Hz is an unsupported body: "
            + ("pairs without a gap" if solved else "the pairs closed at rest")
            + " do not support it"
            + (", so the static load must close others." if solved else ", and a run rejects that.")
        )
    low, high = sorted((solver.frequency_start, solver.frequency_stop))
    if has_range(case) and not ((stuck_hz >= low) & (stuck_hz <= high)).any():
        warnings.append("No natural frequency of this list is in the sweep, so the sweep may contain no resonance.")
    highest = float(np.nanmax(joint.friction_coefficient, initial=0.0))
    if highest > USUAL_FRICTION:
        warnings.append(
            f"The friction coefficient {highest:g} is above {USUAL_FRICTION:g}: dry metal joints have 0.1 to 0.8, only "
            "rubber and clean metals in vacuum have more."
        )
    warnings += words_beyond_reduction(case, structure)
    if _is_undamped(case, structure):
        warnings.append(
            "There is no viscous damping: a run rejects a resonance in the sweep that friction cannot bound. Give "
            "damping.modal_damping_ratio, 0.001 is usual for metal."
        )
    if warnings:
        sections.append(("Warnings", _numbered(warnings)))
    if joint.layout.notes:
        sections.append(("Notes on the model file", _numbered(joint.layout.notes)))
    return sections


def _numbered(sentences: Sequence[str]) -> list[tuple[str, str]]:
    return [(f"{i}.", sentence) for i, sentence in enumerate(sentences, start=1)]


def _range_words(case: Case) -> str:
    if not has_range(case):
        return "the file has no frequency range; see the proposal"
    return f"{case.solver.frequency_start:g} to {case.solver.frequency_stop:g} Hz"


def _mode(analysis: AnalysisSection, n_pairs: int) -> Iterator[tuple[str, str]]:
    """The nonlinear mode of a run and its quasi-static estimate, if there are any."""
    if not isinstance(analysis, ModeAnalysis):
        return
    low, high = (f"{1e6 * value:g}" for value in (analysis.smallest_amplitude, analysis.largest_amplitude))
    words = f"mode {analysis.mode}, {low} to {high} um at the first output"
    if analysis.mode_method == "quasi-static":
        yield "quasi-static estimate", words
        return
    yield "nonlinear mode", words
    if has_estimate(analysis, n_pairs):
        yield "quasi-static estimate", "beside the nonlinear mode, as a check"
    elif analysis.limit == "stuck":
        alone = 'mode_method = "quasi-static" computes it alone'
        yield "quasi-static estimate", f"none beside a mode of more than {MOST_PAIRS_BESIDE} pairs; {alone}"


def _ridge(case: Case) -> Iterator[tuple[str, str]]:
    """The ridges of peaks of a run."""
    ridge = ridge_of_study(case)
    if ridge is not None:
        family, (low, high) = ridge
        yield "peaks over a key", f"{family.key} from {low:g} to {high:g} {family.quantity.si_unit}".rstrip()
    if has_stiffness_band(case):
        yield "stiffness band", "1/3 and 3 times the contact stiffness, which was not measured: two more curves"
    if has_performance_curve(case):
        forces = f"centrifugal force {LOWEST_RATIO:g} to {HIGHEST_RATIO:g} times the excitation force"
        is_solved = case.preload.method == "solved"
        yield (
            "performance curve",
            f"{forces}, {'a whole curve at each' if is_solved else 'and lower until the peak rises'}",
        )
    elif why_no_performance_curve(case):
        yield "performance curve", f"none: {why_no_performance_curve(case)}"


def _wear(case: Case, joint: Joint) -> Iterator[tuple[str, str]]:
    """The wear of a run. Raises InputError for a joint that cannot wear."""
    analysis = case.analysis
    if isinstance(analysis, WearAnalysis):
        worn_faces(case, joint)
        at = analysis.wear_frequency
        motion = "at the highest peak" if at is None else f"at {at:g} Hz"
        alpha = energy_coefficients(analysis, joint).max()
        yield "wear", f"{analysis.wear_cycles:.4g} cycles {motion}, {1e9 * alpha:.3g} mm^3/J"


def _mistuning(case: Case, layout: Layout, structure: AnyStructure) -> Iterator[tuple[str, str]]:
    """The mistuning of a run. Raises InputError for a blade whose root is not fixed."""
    sector = study_structure(structure).sector
    if isinstance(case, CyclicCase) and case.mistuning is not None and sector is not None:
        assert layout.blade_nodes is not None
        with concerning("mistuning.blade"):
            alone_hz = sector.blade_frequencies(layout.blade_nodes)
        limit = 0.5 * (1.0 + math.sqrt(sector.symmetry.sectors))
        yield "mistuning", f"{mistuning_words(case.mistuning)}; linear, contacts stuck and without contact"
        if case.mistuning.friction_curve:
            loads = case.mistuning.damper_loads
            own = "" if loads is None else f"; normal loads of {min(loads):.3g} to {max(loads):.3g} times those here"
            yield (
                "mistuned disk with friction",
                f"one curve of all sectors, for the pattern with the largest factor{own}",
            )
        yield "blade alone", ", ".join(map(hertz, alone_hz[:SHOWN_FREQUENCIES])) + " Hz"
        yield "Whitehead's limit", f"{limit:.3g} times the amplitude of the tuned disk"


def _is_undamped(case: Case, structure: AnyStructure) -> bool:
    """Whether neither the study nor the matrix files have any damping."""
    section = case.damping
    given = (section.modal_damping_ratio, section.rayleigh_alpha, section.rayleigh_beta)
    return not any(given) and not study_structure(structure).has_damping


def _short(value: str | float | int) -> str:
    if isinstance(value, float):
        return f"{value:.4g}" if math.isfinite(value) else "not defined"
    return str(value)
