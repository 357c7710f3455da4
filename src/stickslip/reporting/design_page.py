"""The page of a design: one self-contained HTML file with its optimum, its sharpness, the path and all designs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.shown_numbers import SHOWN, capital, number, small
from stickslip.reporting import design_plots as plots
from stickslip.reporting.look import plain_figures
from stickslip.reporting.style import shown_number
from stickslip.reporting.templates import Notice, StudyText, Tile, when, whole_page
from stickslip.results.band import BandMeasure, Limit
from stickslip.results.design import (
    BETTER_POSSIBLE,
    DesignCase,
    DesignKey,
    DesignResult,
    Evaluation,
    Sharpness,
    StartResult,
)

MANY_TIMES = 10.0  # chosen: from this ratio to a limit on, a multiple is easier to read than a percentage


def write_design_page(
    path: str | PathLike[str], result: DesignResult, title: str, inputs: StudyText, provenance: Mapping[str, str]
) -> None:
    """Write the page of a design to ``path``, completely or not at all. Raises InputError if it cannot be written.

    ``inputs`` is the study file.
    """
    text = design_page(result, title, inputs, provenance)
    with whole_file(Path(path), "page of the design", InputError) as part:
        part.write_text(text, encoding="utf-8")


def design_page(result: DesignResult, title: str, inputs: StudyText, provenance: Mapping[str, str]) -> str:
    """The page of a design as HTML."""
    failed = sum(bool(each.failure) for each in result.evaluations)
    has_optimum = result.optimum is not None
    keys = ", ".join(key.name for key in result.keys)
    limits = "; ".join(each.text for each in result.limits)
    values = {
        "title": title,
        "description": f"Smallest {small(result.measure.words)} over {keys}" + (f", with {limits}." if limits else "."),
        "byline": f"{when(provenance)} · {len(result.evaluations)} designs · {failed} failed",
        "notices": list(_notices(result)),
        "answer": list(_answer(result)),
        "tiles": list(_tiles(result)),
        "has_optimum": has_optimum,
        "has_results": result.has_results,
        "shown_design": "The optimum" if has_optimum else "The nearest design" if result.has_results else "The ranges",
        "key_headings": _key_headings(result),
        "remarks": result.remarks,
        "keys": [_key_row(result, place) for place in range(len(result.keys))],
        "limits": [_limit_row(result, place) for place in range(len(result.limits))],
        "load_headings": ["Highest peak, µm", "Frequency, Hz", "Next peak, µm", "Next, Hz", "Stress, MPa"],
        "load_cases": [_load_row(words, case) for words, case in _load_cases(result)],
        "starts": [_start_row(result, place, each) for place, each in enumerate(result.starts)],
        "drawn_keys": [(place, key.name) for place, key in enumerate(result.keys)],
        "headings": ["Stage", *map(_heading, result.keys), plots.axis_words(result.measure), "Gradient"],
        "rows": [_design_row(result, each) for each in result.evaluations],
        "inputs": inputs,
    }
    figures = {}
    if result.has_results:
        figures = {"path": plots.path(result)}
        figures |= {f"key-{place}": plots.against_key(result, place) for place in range(len(result.keys))}
    if has_optimum:
        figures["curves"] = plots.curves(result)
    return whole_page(
        "design.html",
        "Design of a structure with friction joints",
        values,
        provenance,
        head_title=f"{title}: design",
        scripts=("sweep.js",),
        data={"page-figures": plain_figures(figures)},
    )


def _notices(result: DesignResult) -> Iterator[Notice]:
    if not result.has_results:
        yield Notice("bad", "No design has a result", result.remarks[:1])
    elif result.optimum is None:
        yield Notice("bad", "No design satisfies the limits", result.remarks[:1])
    else:
        doubts = [sentence for sentence in result.remarks if "wider range" in sentence or BETTER_POSSIBLE in sentence]
        if doubts:
            yield Notice("warn", "Before you use this design", doubts)
    if result.cautions:
        yield Notice("warn", "About the ranges", result.cautions)


def _answer(result: DesignResult) -> Iterator[str]:
    """The optimum in plain words."""
    best, before = result.optimum, plots.start_design(result)
    if best is None:
        return
    unit = SHOWN[result.measure.unit][1]
    worst = f" in the worst of {len(best.cases)} load cases" if len(best.cases) > 1 else ""
    values = zip(result.keys, best.values, strict=True)
    keys = ", ".join(f"{_short(key)} {number(key.shown(value))} {key.unit}".rstrip() for key, value in values)
    value = _value(result.measure, best.objective)
    words = f"The best design has {keys}: {small(result.measure.words)} {value} {unit}{worst}"
    if before is None:
        yield f"{words}."
    else:
        yield f"{words}, against {_value(result.measure, before.objective)} {unit} in the study."


def _tiles(result: DesignResult) -> Iterator[Tile]:
    best = result.optimum
    if best is None:
        return
    before = plots.start_design(result)
    more = ""
    if before is not None:
        change = 100.0 * (best.objective / before.objective - 1.0)
        more = f"{_with_unit(result.measure, before.objective)} in the study, {number(change, 3)} %"
    unit = SHOWN[result.measure.unit][1]
    yield Tile(result.measure.words, _value(result.measure, best.objective), unit, more)
    for key, value, along in zip(result.keys, best.values, result.sharpness, strict=True):
        yield Tile(capital(_short(key)), number(key.shown(value)), key.unit, f"5 % more at: {_cost(key, along)}")


def _value(measure: BandMeasure, value: float) -> str:
    factor, unit = SHOWN[measure.unit]
    return "–" if math.isnan(value) else shown_number(factor * value, unit)


def _with_unit(measure: BandMeasure, value: float) -> str:
    return f"{_value(measure, value)} {SHOWN[measure.unit][1]}".rstrip()


def _cost(key: DesignKey, along: Sharpness) -> str:
    """The values of a key at which the objective is 5 % higher."""
    low, high = (
        "none in the range" if end is None else f"{number(key.shown(end))} {key.unit}".rstrip()
        for end in (along.lower, along.upper)
    )
    return f"{low} below, {high} above"


def _key_headings(result: DesignResult) -> list[str]:
    if result.optimum is not None:
        return ["Study", "Optimum", "Range", "5 % more at", "Shape"]
    return ["Study", "Range"] if result.nearest is None else ["Study", "Nearest design", "Range"]


def _key_row(result: DesignResult, place: int) -> list[str]:
    key, shown = result.keys[place], result.optimum or result.nearest
    study = f"{number(key.shown(key.start))} {key.unit}".rstrip()
    spacing = "by factors" if key.is_logarithmic else "by steps"
    ends = f"{number(key.shown(key.low))} to {number(key.shown(key.high))} {key.unit}".rstrip() + f", {spacing}"
    if shown is None:
        return [key.name, study, ends]
    row = [key.name, study, f"{number(key.shown(shown.values[place]))} {key.unit}".rstrip(), ends]
    if result.optimum is None:
        return row
    along = result.sharpness[place]
    return [*row, _cost(key, along), along.shape]


def _limit_row(result: DesignResult, place: int) -> list[str]:
    limit: Limit = result.limits[place]
    shown = result.optimum or result.nearest
    if shown is None:
        return [limit.text, "–", "–"]
    value = shown.required[place]
    ratio = value / limit.value
    of_limit = f"{number(100.0 * ratio, 3)} %" if ratio < MANY_TIMES else f"{number(ratio, 3)} times"
    return [limit.text, _with_unit(limit.measure, value), of_limit]


def _load_cases(result: DesignResult) -> Iterator[tuple[str, DesignCase]]:
    best = result.optimum
    if best is not None:
        yield from zip(result.load_cases, best.cases, strict=True)


def _load_row(words: str, case: DesignCase) -> list[str]:
    peaks = [*case.peaks, None][:2]
    cells = [words or "the study"]
    for peak in peaks + [None] * (2 - len(peaks)):
        cells += ["–", "–"] if peak is None else [number(1e6 * peak.amplitude_m), shown_number(peak.frequency_hz, "Hz")]
    stress = case.stresses.get("stress")
    return [*cells, "–" if stress is None else number(1e-6 * stress), case.name]


def _start_row(result: DesignResult, place: int, start: StartResult) -> list[str]:
    first, last = result.evaluations[start.first], result.evaluations[start.best]
    agreement = "another optimum" if last.is_allowed else "–"
    if start.same_value:
        agreement = "same optimum" if start.same_place else "same value, other design"
    return [
        str(place + 1),
        _words(result, first),
        _words(result, last),
        _with_unit(result.measure, first.objective),
        _with_unit(result.measure, last.objective) + ("" if last.is_allowed else " (limit not satisfied)"),
        agreement,
        start.message,
    ]


def _words(result: DesignResult, each: Evaluation) -> str:
    return ", ".join(key.label(value) for key, value in zip(result.keys, each.values, strict=True))


def _short(key: DesignKey) -> str:
    return key.name.split(".", 1)[1].replace("_", " ")


def _heading(key: DesignKey) -> str:
    return f"{_short(key)}{', ' + key.unit if key.unit else ''}"


def _design_row(result: DesignResult, each: Evaluation) -> dict[str, Any]:
    inputs = [number(key.shown(value), 5) for key, value in zip(result.keys, each.values, strict=True)]
    remark = ""
    if each.failure:
        remark = f"No result: {each.failure}"
    elif not each.is_allowed:
        remark = f"A limit is violated: {result.violations(each)}."
    if each is result.nearest:
        remark = f"Nearest to the limits. {remark}"
    if each is result.optimum:
        remark = "optimum"
    cells = [str(each.number), each.stage, *inputs, _value(result.measure, each.objective), each.gradient]
    return {"cells": cells, "remark": remark, "warnings": [words for case in each.cases for words in case.messages]}
