"""Items that need no curve: sizes and frequencies, rough faces, contact stiffness."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from math import cos

import numpy as np

from stickslip.case.case import TwoBladeCase
from stickslip.contact.stiffness.fractal import ContactStatus, ContactStiffness, Roughness, published_contact
from stickslip.contact.stiffness.surface import draw_phases, fractal_surface, frequency_count, surface_statistics
from stickslip.core.validation import FloatArray
from stickslip.model.rough_face import case_material, case_roughness, roughness_section, waves_of
from stickslip.papers.rough_damper.claims import MICRO, Solutions
from stickslip.papers.rough_damper.items import Item, ModelClaim, Picture
from stickslip.papers.rough_damper.plan import MODES, law_of
from stickslip.papers.rough_damper.table2 import table2
from stickslip.papers.rough_damper.tables import Cell, Table, columns
from stickslip.papers.rough_damper.verdicts import Answer, Judgement, judge, rises
from stickslip.results.record import frequency_deviation

PAPER_DIMENSIONS = (2.2, 2.3, 2.49)
PAPER_SCALE = 1e-8
DIMENSIONS = (2.2, 2.3, 2.4, 2.49)
SCALES = (1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
LOADS = (50.0, 100.0, 500.0, 2000.0)  # N of the damper; a face carries 0.577 of it


def reduction_item(case: TwoBladeCase, solutions: Solutions, full_size: int, pairs: int) -> Item:
    """Tables 1 and 2, Figure 2."""
    reduced = int(solutions[0].numbers["unknowns_reduced"])
    rows: list[tuple[Cell, ...]] = []
    for mode, paper in zip(solutions[0].mode_table, table2(), strict=False):
        number, full_hz, reduced_hz, difference, mac = (float(value) for value in mode)
        rows.append(
            (
                int(number),
                full_hz,
                paper["full_hz"],
                frequency_deviation(full_hz, paper["full_hz"]),
                reduced_hz,
                difference,
                paper["frequency_difference_percent"],
                mac,
                paper["mac"],
            )
        )
    sizes = Table(
        "table1_sizes",
        "Sizes, with the paper's reduction by about 20",
        columns("quantity||Quantity", "value||Ours"),
        (
            ("unknowns of the full model", full_size),
            ("unknowns after reduction", reduced),
            ("ratio", full_size / reduced),
            ("contact pairs", pairs),
        ),
    )
    frequencies = Table(
        "table2_frequencies",
        "Natural frequencies with tied contact, full and reduced, against Table 2",
        columns(
            "mode||Mode",
            "full|Hz|Full",
            "paper_full|Hz|Paper, full",
            "from_paper|%|stickslip from paper",
            "reduced|Hz|Reduced",
            "difference|%|Reduced from full",
            "paper_difference|%|Paper",
            "mac||MAC",
            "paper_mac||Paper, MAC",
        ),
        tuple(rows),
    )
    notes = (
        "The geometry is inferred: seven dimensions were fitted to these ten frequencies, so their agreement proves "
        "nothing about the model. Of the paper's own differences three (modes 8 to 10) exceed its bound.",
    )
    return Item(
        "reduction",
        REDUCTION.place,
        "The reduced model has the first ten frequencies within 1/10,000 and MAC near 1, with about 20 times fewer "
        "unknowns.",
        notes,
        (sizes, frequencies),
        (
            Picture(
                "fig02_reduction",
                "Frequency difference of the reduced from the full model in percent, and MAC, for modes 1 to 10: "
                "stickslip and the paper.",
                frequencies.name,
            ),
        ),
        ((REDUCTION.statement, REDUCTION.judged(case, solutions)),),
    )


def _judged_reduction(_case: TwoBladeCase, solutions: Solutions) -> Judgement:
    answers = []
    for mode, paper in zip(solutions[0].mode_table, table2(), strict=False):
        number, difference = int(mode[0]), float(mode[3])
        words = f"{difference:.2e} % (paper {paper['frequency_difference_percent']:.2e} %)"
        answers.append(Answer({"mode": f"{number}"}, abs(difference) < 0.01, words))
    return judge(answers)


REDUCTION = ModelClaim(
    "Each difference is below 1/10,000 in the model of stickslip.",
    "Tables 1 and 2, Figure 2: reduction of the model",
    frozenset({"geometry.excitation_height"}),
    "follows from mesh, material and the retained nodes, with tied contact",
    _judged_reduction,
)


def rough_case(base: TwoBladeCase, dimension: float, scale: float) -> TwoBladeCase:
    """The base with another roughness."""
    changes = {"roughness.fractal_dimension": dimension, "roughness.fractal_roughness": f"{scale!r} m"}
    return base.replace(changes)


def _heights(base: TwoBladeCase, dimension: float, scale: float) -> tuple[float, float]:
    """Sq in m and Sdq of a rough face between the longest and the shortest wave of the case."""
    case = rough_case(base, dimension, scale)
    waves = waves_of(roughness_section(case))
    statistics = surface_statistics(_roughness(case), waves.longest, waves.shortest)
    return statistics.sq, statistics.sdq


def surface_item(base: TwoBladeCase) -> Item:
    """Figure 4, and whether a larger D and a smaller G are rougher."""
    rows: list[tuple[Cell, ...]] = []
    for scale in (1e-8, 1e-9, 1e-11):
        for dimension in DIMENSIONS:
            sq, sdq = _heights(base, dimension, scale)
            rows.append((dimension, scale, MICRO * sq, sdq, _roughness_words(sq, sdq)))
    table = Table(
        "fig04_surfaces",
        "Root mean square height and slope over 28 mm, waves from 28 mm to 1 um",
        columns("dimension||D", "scale|m|G", "sq|um|Sq", "sdq||Sdq", "meaning||Meaning"),
        tuple(rows),
    )
    return Item(
        "surfaces",
        ROUGHER.place,
        "A larger D and a smaller G make the face rougher.",
        (
            "Both reduce the height of each wave longer than G, so Sq and Sdq fall: the face is smoother and stiffer. "
            "D alone raises the fraction of short waves, not their height. In the paper, rougher means stiffer.",
        ),
        (table,),
        (
            Picture(
                "fig04_surfaces",
                "Heights of the contact face for D = 2.2, 2.3 and 2.49 at G = 1e-8 m, each with its own colour scale.",
                table.name,
            ),
        ),
        ((ROUGHER.statement, ROUGHER.judged(base, ())),),
    )


def _judged_surfaces(base: TwoBladeCase, _solutions: Solutions) -> Judgement:
    answers = []
    for name, place in (("Sq", 0), ("Sdq", 1)):
        for scale in (1e-8, 1e-9, 1e-11):
            values = [_heights(base, dimension, scale)[place] for dimension in DIMENSIONS]
            shown = ", ".join(f"{value:.3g}" for value in values)
            answers.append(Answer({"measure": name, "along": "D"}, rises(values), f"G {scale:g} m: {shown}"))
        for dimension in DIMENSIONS:
            values = [_heights(base, dimension, scale)[place] for scale in (1e-8, 1e-9, 1e-11)]
            shown = ", ".join(f"{value:.3g}" for value in values)
            answers.append(Answer({"measure": name, "along": "G"}, rises(values), f"D {dimension:g}: {shown}"))
    return judge(answers)


ROUGHER = ModelClaim(
    "A larger D or a smaller G raises Sq or Sdq.",
    "Figure 4: rough faces, and the word rougher (E9)",
    frozenset(),
    "follows from D, G and the range of waves alone",
    _judged_surfaces,
)


def _roughness_words(sq: float, sdq: float) -> str:
    if sdq > 1.0:
        return "slopes above 1: not a machined face"
    if sq > 50e-6:
        return "rougher than a casting or a rough cut"
    return "a machined face" if sq < 10e-6 else "a coarse machined face"


def _face_load(base: TwoBladeCase, load: float) -> tuple[float, float]:
    """Normal load N and area m2 of one face under a centrifugal force, without friction."""
    geometry = base.geometry
    return load / (2.0 * cos(geometry.platform_angle)), geometry.damper_length * geometry.contact_face_width


def _roughness(case: TwoBladeCase) -> Roughness:
    """Roughness of a case whose bodies are of one material."""
    material = case_material(case)
    return case_roughness(case, material, material)


@cache
def _stiffness(base: TwoBladeCase, dimension: float, scale: float, load: float, law: str) -> ContactStiffness:
    force, area = _face_load(base, load)
    roughness = _roughness(rough_case(base, dimension, scale))
    return published_contact(roughness, force, mode=MODES[law], area=area)


def stiffness_item(base: TwoBladeCase) -> Item:
    """K_n and K_t against D, G and load in three modes; where the law fails; equation 8 against Hertz."""
    rows = []
    for dimension, scale, load in _grid():
        by_law = {law: _stiffness(base, dimension, scale, load, law) for law in MODES}
        plain = by_law["consistent"]
        ratio = by_law["paper"].normal / plain.normal if plain.normal else float("nan")
        rows.append(
            (
                dimension,
                scale,
                load,
                by_law["consistent"].normal,
                by_law["paper"].normal,
                by_law["unloading"].normal,
                plain.tangential,
                by_law["unloading"].tangential,
                ratio,
                100.0 * plain.plastic_load_share,
                plain.status.value,
            )
        )
    table = Table(
        "contact_stiffness",
        "Stiffness of one face (182 mm2)",
        columns(
            "dimension||D",
            "scale|m|G",
            "load|N|F_N",
            "kn_consistent|N/m|K_n, Hertz",
            "kn_paper|N/m|K_n, eq 8",
            "kn_unloading|N/m|K_n, unloading",
            "kt|N/m|K_t",
            "kt_unloading|N/m|K_t, unloading",
            "eq8_over_hertz||Eq 8 / Hertz",
            "plastic_share|%|Load on plastic spots",
            "status||Status",
        ),
        tuple(rows),
    )
    ratios = [row[8] for row in rows if row[8] == row[8]]
    return Item(
        "stiffness",
        STIFFNESS.place,
        "The law gives K_n and K_t for D = 2.2, 2.3 and 2.49 at G = 1e-8 (unit not printed; metre assumed).",
        (
            "Without elastic spots the law has no stiffness, and a formal evaluation would give a negative one; "
            "these cases use the unloading mode (plastic spots respond too) and a smaller G.",
            f"Equation 8 differentiates along the family of asperities and exceeds Hertz at fixed curvature by "
            f"{min(ratios):.2f} to {max(ratios):.2f} here; equation 9 uses Hertz, so the two are inconsistent.",
        ),
        (table,),
        (
            Picture(
                "contact_stiffness",
                "Normal stiffness of a face against G (above) and centrifugal force (below) in the three modes, a line "
                "for each D; no point if the law gives none.",
                table.name,
            ),
        ),
        ((STIFFNESS.statement, STIFFNESS.judged(base, ())),),
    )


def _judged_stiffness(base: TwoBladeCase, _solutions: Solutions) -> Judgement:
    answers = []
    for dimension in PAPER_DIMENSIONS:
        for load in LOADS:
            stiffness = _stiffness(base, dimension, PAPER_SCALE, load, law_of(base))
            holds = stiffness.status is not ContactStatus.FULLY_PLASTIC
            where = {"D": f"{dimension:g}", "F_N": f"{load:g} N"}
            answers.append(Answer(where, holds, f"K_n {stiffness.normal:.3g} N/m"))
    return judge(answers)


STIFFNESS = ModelClaim(
    "The law gives these faces a stiffness.",
    "Contact stiffness, equations 5 to 10",
    frozenset({"roughness.hardness", "roughness.mode"}),
    "is checked for F_N from 50 to 2000 N, and the law contains no friction, damping or position of the force",
    _judged_stiffness,
)
MODEL_CLAIMS = (ROUGHER, REDUCTION, STIFFNESS)


def _grid() -> Iterator[tuple[float, float, float]]:
    for dimension in DIMENSIONS:
        for scale in SCALES:
            for load in LOADS:
                yield dimension, scale, load


def drawn_faces(base: TwoBladeCase) -> list[tuple[str, FloatArray, FloatArray, FloatArray]]:
    """(title, x, y, heights) of the paper's three faces, all with the phases of the case's seed, m."""
    section, geometry = roughness_section(base), base.geometry
    waves = waves_of(section)
    phases = draw_phases(section.seed, section.ridges, frequency_count(*waves[2:]))
    along, across = np.linspace(0.0, geometry.damper_length, 280), np.linspace(0.0, geometry.contact_face_width, 66)
    x, y = np.meshgrid(along, across)
    return [
        (
            f"D = {dimension:g}, G = {PAPER_SCALE:g} m",
            x,
            y,
            fractal_surface(x, y, dimension, PAPER_SCALE, waves.longest, section.ridges, phases, waves.ratio),
        )
        for dimension in PAPER_DIMENSIONS
    ]


Line = tuple[str, list[float], list[float]]


def stiffness_over_load(base: TwoBladeCase, scale: float) -> dict[str, list[Line]]:
    """The same over the centrifugal force in N, at one G."""
    return {
        law: [
            (f"D = {d:g}", list(LOADS), [_stiffness(base, d, scale, load, law).normal for load in LOADS])
            for d in DIMENSIONS
        ]
        for law in MODES
    }


def stiffness_over_scale(base: TwoBladeCase) -> dict[str, list[Line]]:
    """Lines of the stiffness figure: law -> (label, G in m, K_n in N/m) at the base load, one line for each D."""
    load = float(base.preload.centrifugal_force or 0.0)
    result = {}
    for law in MODES:
        result[law] = [
            (f"D = {d:g}", list(SCALES), [_stiffness(base, d, g, load, law).normal for g in SCALES]) for d in DIMENSIONS
        ]
    return result
