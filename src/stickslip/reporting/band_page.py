"""The page of a band: one self-contained HTML file with its percentiles, limits, influences and samples."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from stickslip.core.shown_numbers import SHOWN, number, small
from stickslip.reporting import band_plots as plots
from stickslip.reporting.look import plain_figures
from stickslip.reporting.style import shown_number
from stickslip.reporting.sweep_view import peak_remark, short_name, with_unit
from stickslip.reporting.templates import Notice, StudyText, Tile, when, whole_page
from stickslip.results.band import (
    ALTERNATING_STRESS,
    MEASURES,
    PERCENTILES,
    STRESS,
    STRESS_MEASURES,
    BandMeasure,
    Exceedance,
    Percentiles,
)
from stickslip.results.band_statistics import BandStatistics

DRAWN_MEASURES = ("peak_amplitude", "peak_frequency")
# Headings of columns of the table of samples.
HEADINGS = {
    "peak_amplitude": "Highest peak",
    "peak_frequency": "Frequency",
    STRESS: "Stress",
    ALTERNATING_STRESS: "Alternating stress",
}
DRAWN_INPUTS = 6  # chosen: plots of peaks against inputs, those with the largest influence


def write_band_page(
    path: str | PathLike[str], statistics: BandStatistics, title: str, inputs: StudyText, provenance: Mapping[str, str]
) -> None:
    """Write the page of a band to ``path``, completely or not at all. Raises InputError if it cannot be written.

    ``inputs`` is the study file with the central values.
    """
    text = band_page(statistics, title, inputs, provenance)
    with whole_file(Path(path), "page of the band", InputError) as part:
        part.write_text(text, encoding="utf-8")


def band_page(statistics: BandStatistics, title: str, inputs: StudyText, provenance: Mapping[str, str]) -> str:
    """The page of a band as HTML."""
    table, measures = statistics.table, _drawn_measures(statistics)
    has_peaks = statistics.percentiles["peak_amplitude"].count > 0
    resolved = [name for name in measures if not statistics.influences[name].reason]
    drawn = _drawn_inputs(statistics) if has_peaks else []
    values = {
        "title": title,
        "description": f"Distributed inputs: {', '.join(name for name, *_ in statistics.inputs)}.",
        "distributions": statistics.inputs,
        "byline": f"{when(provenance)} · {len(table.rows)} samples · {len(table.failed)} failed",
        "notices": list(_notices(statistics)),
        "answer": list(band_in_words(statistics)),
        "tiles": list(_tiles(statistics)),
        "has_curves": statistics.curve_band is not None,
        "has_peaks": has_peaks,
        "percents": [f"{percent:g} %" for percent in PERCENTILES],
        "percentiles": [_percentile_row(each) for each in statistics.percentiles.values()],
        "has_stress": len(measures) > len(DRAWN_MEASURES),
        "tractions": list(_traction_words(statistics)),
        "limits": [_limit_row(each) for each in statistics.exceedances],
        "measures": [(name, measure.words) for name, measure in measures.items()],
        "influences": [_influence_words(statistics, name) for name in measures],
        "resolved": resolved,
        "drawn_inputs": [(place, table.keys[place].name) for place in drawn],
        "omitted_inputs": len(table.keys) - len(drawn),
        "headings": [
            *(_heading(statistics, i) for i in range(len(table.keys))),
            *(f"{HEADINGS[name]}, {SHOWN[measure.unit][1]}" for name, measure in measures.items()),
        ],
        "solved_again": statistics.solved_again,
        "rows": [_sample_row(statistics, i) for i in range(len(table.rows))],
        "inputs": inputs,
    }
    figures = {"curves": plots.curves(statistics)} if statistics.curve_band is not None else {}
    if has_peaks:
        figures |= {f"distribution-{name}": plots.distribution(statistics, each) for name, each in measures.items()}
    figures |= {f"indices-{name}": plots.indices(statistics.influences[name]) for name in resolved}
    figures |= {f"input-{place}": plots.against_input(statistics, place) for place in drawn}
    return whole_page(
        "band.html",
        "Band of forced responses with distributed inputs",
        values,
        provenance,
        head_title=f"{title}: band",
        scripts=("sweep.js",),
        data={"page-figures": plain_figures(figures)},
    )


def _drawn_measures(statistics: BandStatistics) -> dict[str, BandMeasure]:
    """Those of plots and of the table of samples: peak, frequency, and stresses where the samples have them."""
    names = (*DRAWN_MEASURES, *STRESS_MEASURES)
    return {name: statistics.percentiles[name].measure for name in names if name in statistics.percentiles}


def _drawn_inputs(statistics: BandStatistics) -> list[int]:
    total = np.nan_to_num(statistics.influences["peak_amplitude"].total)
    return [int(place) for place in np.argsort(-total, kind="stable")[:DRAWN_INPUTS]]


def _notices(statistics: BandStatistics) -> Iterator[Notice]:
    failed = [(place, row) for place, row in enumerate(statistics.table.rows) if not row.converged]
    if failed:
        heading = "1 sample failed" if len(failed) == 1 else f"{len(failed)} samples failed"
        yield Notice("bad", heading, [f"Sample {place + 1}: {row.message}" for place, row in failed])
    if statistics.remarks:
        yield Notice("warn", "Before you use these numbers", statistics.remarks)


def band_in_words(statistics: BandStatistics) -> Iterator[str]:
    """What the band says, in plain words: percentiles, limits, and the input that matters most."""
    result = statistics.percentiles["peak_amplitude"]
    if result.count:
        low, middle, high = (_number(result.measure, value) for value in result.values)
        yield (
            f"The highest peak is {middle} µm in the median, and between {low} and {high} µm in 90 % of {result.count} "
            "samples."
        )
    for name in _limited_stresses(statistics):
        stress = statistics.percentiles[name]
        if stress.count:
            low, middle, high = (_number(stress.measure, value) for value in stress.values)
            yield (
                f"The {small(stress.measure.words)} is {middle} MPa in the median, and between {low} and {high} MPa in "
                f"90 % of {stress.count} samples. It is that away from contacts and loads, on this mesh."
            )
    for each in statistics.exceedances:
        least, most = (_percent(end) for end in each.interval)
        if not each.exceeded and not each.undecided:
            yield (
                f"All {each.count} samples satisfy {each.limit.text}; of all structures, up to {most} % do not (95 % "
                "confidence)."
            )
            continue
        yield (
            f"{each.exceeded} of {each.count} samples {'does' if each.exceeded == 1 else 'do'} not satisfy "
            f"{each.limit.text}; of all structures, {least} to "
            f"{most} % do not (95 % confidence)."
        )
    stresses = _limited_stresses(statistics)
    for name in ("peak_amplitude", *stresses):
        indices = statistics.influences[name]
        if not indices.reason:
            place = int(np.argmax(indices.total))
            what = f" for the {small(statistics.percentiles[name].measure.words)}" if stresses else ""
            yield f"The input that matters most{what} is {indices.names[place]}."


def _limited_stresses(statistics: BandStatistics) -> list[str]:
    """Names of the stresses that have a limit."""
    limited = {each.limit.measure.name for each in statistics.exceedances}
    return [name for name in STRESS_MEASURES if name in limited]


def _tiles(statistics: BandStatistics) -> Iterator[Tile]:
    shown = {"peak_amplitude": "Highest peak", "peak_frequency": "Peak frequency"}
    shown |= {name: HEADINGS[name] for name in _limited_stresses(statistics)}
    for name, words in shown.items():
        result = statistics.percentiles[name]
        if result.count:
            low, middle, high = (_number(result.measure, value) for value in result.values)
            more = f"{low} to {high} in 90 % of {result.count} samples"
            yield Tile(f"{words}, median", middle, SHOWN[result.measure.unit][1], more)
    tractions = statistics.tractions
    if tractions is not None:
        ends = " to ".join(_number(MEASURES["peak_amplitude"], end) for end in (tractions.low, tractions.high))
        more = f"with central inputs, whose peak is {_number(MEASURES['peak_amplitude'], tractions.peak)} µm"
        yield Tile("Highest peak over residual tractions", ends, "µm", more)
    for each in statistics.exceedances:
        least, most = (_percent(end) for end in each.interval)
        more = f"{each.limit.text}; 95 % interval {least} to {most} %"
        yield Tile("Limit not satisfied", _percent(each.probability), "%", more)
    indices = statistics.influences["peak_amplitude"]
    if not indices.reason:
        place = int(np.argmax(indices.total))
        more = f"of the variance of the peak: {indices.names[place]}, with interactions"
        yield Tile("Largest influence", _percent(indices.total[place]), "%", more)


def _traction_words(statistics: BandStatistics) -> Iterator[str]:
    """The second band beside that of the inputs."""
    tractions = statistics.tractions
    if tractions is None:
        return
    measure = MEASURES["peak_amplitude"]
    peak, low, high = (_number(measure, value) for value in (tractions.peak, tractions.low, tractions.high))
    ends = (tractions.low, tractions.high)
    changes = " to ".join(f"{100.0 * (end / tractions.peak - 1.0):+.2g} %" for end in ends)
    yield (
        "No sample of the inputs contains the tractions that assembly locks into the joint: each pair may have any up "
        f"to its friction limit. With central inputs the highest peak is {peak} µm. Over extreme residual tractions it "
        f"is {low} to {high} µm ({changes})."
    )
    result = statistics.percentiles["peak_amplitude"]
    if result.count:
        first, _, last = (_number(measure, value) for value in result.values)
        yield f"Over the inputs alone it is {first} to {last} µm in 90 % of the samples."
    yield (
        "Both act together, so a real structure can be outside of each. The range over tractions is a lower bound: its "
        "ends are solutions that a local optimisation found, for the highest peak of one output."
    )


def _number(measure: BandMeasure, value: float) -> str:
    factor, unit = SHOWN[measure.unit]
    return "–" if math.isnan(value) else shown_number(factor * value, unit)


def _percent(fraction: float) -> str:
    return "–" if math.isnan(fraction) else number(100.0 * fraction, 3)


def _percentile_row(result: Percentiles) -> dict[str, Any]:
    measure = result.measure
    cells = [_number(measure, value) for value in result.values]
    ends = [f"{_end(measure, low)} to {_end(measure, high)}" for low, high in result.intervals]
    words = f"{measure.words}, {SHOWN[measure.unit][1]}"
    return {"words": words, "cells": list(zip(cells, ends, strict=True)), "count": result.count}


def _end(measure: BandMeasure, value: float) -> str:
    return "?" if math.isnan(value) else _number(measure, value)


def _limit_row(each: Exceedance) -> list[str]:
    low, high = (_percent(end) for end in each.interval)
    decided = each.count - each.undecided
    return [
        each.limit.text,
        _percent(each.probability),
        f"{low} to {high}",
        f"{each.exceeded} of {decided}",
        str(each.undecided),
    ]


def _influence_words(statistics: BandStatistics, name: str) -> tuple[str, str]:
    result = statistics.influences[name]
    if result.reason:
        return name, f"Not resolved. {result.reason}"
    return name, (
        f"{_percent(result.unexplained)} % of the variance remain unexplained by the fitted polynomials "
        f"({result.n_samples} samples)."
    )


def _heading(statistics: BandStatistics, place: int) -> str:
    key = statistics.table.keys[place]
    return with_unit(short_name(key), key)


def _sample_row(statistics: BandStatistics, place: int) -> dict[str, Any]:
    row = statistics.table.rows[place]
    inputs = [key.labels[place] if key.is_choice else number(key.shown[place]) for key in statistics.table.keys]
    results = [_number(each, row.measures.get(each.column, math.nan)) for each in _drawn_measures(statistics).values()]
    again = f"Solved again: {row.solved_again.rstrip('.')}." if row.solved_again else ""
    remark = " ".join(filter(None, [peak_remark(row), again]))
    return {"cells": [str(place + 1), *inputs, *results], "remark": remark, "warnings": row.warnings}
