"""Text that would run or change a page that did not escape it, in every place where a file can bring text to a page."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np

from band_tables import band_statistics
from design_tables import design_result
from sketches import shaken, stacked_boxes
from stickslip.papers.rough_damper.compute import Failure
from stickslip.papers.rough_damper.items import Item, Picture
from stickslip.papers.rough_damper.page import write_page as write_paper_page
from stickslip.papers.rough_damper.plan import Setting
from stickslip.papers.rough_damper.tables import Column, Table
from stickslip.papers.rough_damper.verdicts import Judgement, Verdict
from stickslip.reporting.band_page import write_band_page
from stickslip.reporting.design_page import write_design_page
from stickslip.reporting.page import write_page
from stickslip.reporting.sweep_page import write_sweep_page
from stickslip.reporting.sweep_view import SweepView
from stickslip.reporting.templates import StudyText
from stickslip.results.band_statistics import BandStatistics
from stickslip.results.design import DesignResult
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.sweep_table import SweptKey
from sweep_tables import sweep_view
from synthetic import synthetic_response, synthetic_study

ATTACKS = (
    "<script>window.pwned=1</script>",
    "<img src=x onerror='window.pwned=1'>",
    "</script><script>window.pwned=1</script>",
    "</style></title></textarea><script>window.pwned=1</script>",
    '"><svg onload="window.pwned=1">',
    "' autofocus tabindex=0 onfocus='window.pwned=1",
    '<a href="javascript:window.pwned=1" popup="width=1">link</a>',
    "<b style='color:red'>bold</b><br><sup>2</sup>",
    "<!--<script>",
    "{{7*7}}{% raw %}{# #}",
    "%{x}%{customdata}<extra>e</extra>&lt;i&gt;&#60;",
    "$x^{2$",
)


def _fields(names: str) -> tuple[str, ...]:
    return tuple(names.split())


def hostile(field: str) -> str:
    """A text with all attacks that names its field at its start and its end."""
    return f"{field}: {' '.join(ATTACKS)} :{field}"


def hostile_response() -> ForcedResponse:
    """A solved curve whose every text is hostile."""
    response = synthetic_response()
    return dataclasses.replace(
        response,
        converged=False,
        message=hostile("message"),
        warnings=(hostile("solver-warning"),),
        settings={**response.settings, hostile("setting"): hostile("setting-value")},
        provenance={hostile("software"): hostile("software-version"), "date": hostile("date")},
    )


def hostile_study() -> StudyRecord:
    """The record that goes with it, whose every text is hostile."""
    study = synthetic_study()
    # legends show names whole that do not end in different words
    names = {name: f"{hostile(f'output-{place}')} end" for place, name in enumerate(study.outputs)}
    modes = [{**row, "description": hostile(f"mode-{place}")} for place, row in enumerate(study.mode_table)]
    sketch = stacked_boxes(
        body_names=(hostile("body-0"), hostile("body-1")),
        load_names=(hostile("load"),),
        response_names=(hostile("response"),),
    )
    return dataclasses.replace(
        study,
        title=hostile("title"),
        description=hostile("description"),
        inputs=hostile("inputs"),
        outputs={names[name]: row for name, row in study.outputs.items()},
        signal_groups={
            hostile(f"group-{place}"): tuple(names[name] for name in group)
            for place, group in enumerate(study.signal_groups.values())
        },
        face_names=(hostile("face-0"), hostile("face-1")),
        mode_table=tuple(modes),
        mode_contact=hostile("contact"),
        mode_reference=hostile("reference"),
        derived=((hostile("quantity"), hostile("value"), hostile("unit"), hostile("meaning")),),
        warnings=(hostile("study-warning"),),
        sketch=shaken(sketch),
    )


STUDY_FIELDS = _fields(
    "message solver-warning setting setting-value software software-version date title description inputs "
    "output-0 group-0 group-1 face-0 face-1 mode-0 mode-9 contact reference quantity value unit meaning "
    "study-warning body-0 body-1 load response"
)


STUDY_TEXT = StudyText(hostile("inputs"), (hostile("changed"),))


def hostile_sweep() -> tuple[SweepView, str, StudyText, dict[str, str]]:
    """View, title, inputs and provenance of a sweep over three keys whose every text is hostile."""
    loads = (100.0, 200.0)
    keys = (
        SweptKey(f"interfaces.{hostile('key-0')}.gap", "m", loads, loads, hostile("key-unit"), _labels("first")),
        SweptKey(f"section.{hostile('key-1')}", "", _labels("second"), (), "", _labels("second")),
        SweptKey(f"section.{hostile('key-2')}", "", _labels("third"), (), "", _labels("third")),
    )
    view = sweep_view(keys, [1e-4, None, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4, 7e-4], at_end=(7,))
    rows = [
        dataclasses.replace(row, message=hostile("row-message"), warnings=(hostile("row-warning"),))
        for row in view.table.rows
    ]
    view = dataclasses.replace(view, table=dataclasses.replace(view.table, rows=tuple(rows)))
    return view, hostile("title"), STUDY_TEXT, {"date": "2026", hostile("software"): hostile("version")}


def hostile_band() -> tuple[BandStatistics, str, StudyText, dict[str, str]]:
    """Statistics, title, inputs and provenance of a band whose every text is hostile."""
    statistics = band_statistics([1e-4 * (1 + place) for place in range(15)] + [None], ["peak_amplitude < 1 mm"])
    rows = [
        dataclasses.replace(row, message=hostile("row-message"), warnings=(hostile("row-warning"),))
        for row in statistics.table.rows
    ]
    key = dataclasses.replace(
        statistics.table.keys[0], name=f"forces.{hostile('key-0')}.amplitude", shown_unit=hostile("key-unit")
    )
    names = (key.name,)
    statistics = dataclasses.replace(
        statistics,
        table=dataclasses.replace(statistics.table, keys=(key,), rows=tuple(rows)),
        inputs=((key.name, hostile("text"), hostile("form"), hostile("range")),),
        influences={name: dataclasses.replace(each, names=names) for name, each in statistics.influences.items()},
    )
    return statistics, hostile("title"), STUDY_TEXT, {"date": "2026", hostile("software"): hostile("version")}


BAND_FIELDS = _fields("title inputs changed software version key-0 text form range row-message row-warning")


def hostile_design() -> tuple[DesignResult, str, StudyText, dict[str, str]]:
    """Result, title, inputs and provenance of a design whose every text is hostile."""
    result = design_result()
    key = dataclasses.replace(result.keys[0], name=f"forces.{hostile('key-0')}.amplitude")
    evaluations = []
    for each in result.evaluations:
        failure = hostile("failure") if each.failure else ""
        cases = [
            dataclasses.replace(case, name=hostile("case"), failure=failure, messages=(hostile("case-message"),))
            for case in each.cases
        ]
        evaluations.append(dataclasses.replace(each, cases=tuple(cases)))
    result = dataclasses.replace(
        result,
        keys=(key,),
        load_cases=(hostile("load-0"), hostile("load-1")),
        evaluations=tuple(evaluations),
        starts=tuple(dataclasses.replace(each, message=hostile("end")) for each in result.starts),
        remarks=(hostile("remark"),),
    )
    return result, hostile("title"), STUDY_TEXT, {"date": "2026", hostile("software"): hostile("version")}


DESIGN_FIELDS = _fields(
    "title inputs changed software version key-0 load-0 load-1 failure case case-message end remark"
)


def _labels(name: str) -> tuple[str, str]:
    return hostile(f"{name}-0"), hostile(f"{name}-1")


SWEEP_FIELDS = _fields(
    "title inputs changed software version key-0 key-1 key-2 key-unit row-message row-warning second-0 "
    "second-1 third-0 third-1"
)


def hostile_paper_page(picture: Any) -> dict[str, Any]:
    """The arguments of ``paper.page.write_page`` but for its path; ``picture`` is a PNG file."""
    table = Table(
        "numbers",
        hostile("caption"),
        (Column("words", "", hostile("heading")), Column("size", hostile("heading-unit"), "Size")),
        ((hostile("cell"), 1.0), ("holds", float("nan"))),
    )
    judgement = Judgement(Verdict.HOLDS_IF, hostile("reason"), ())
    item = Item(
        "one",
        hostile("item"),
        hostile("statement"),
        (hostile("note"),),
        (table,),
        (Picture("sides", hostile("picture"), "numbers"),),
        ((hostile("question"), judgement),),
    )
    setting = Setting(hostile("choice"), "same", 5.0, 100.0, 2.4, 1e-9, "consistent")
    return {
        "items": [item],
        "figures": {"sides": picture},
        "counts": {},
        "failures": [Failure(setting, hostile("failure"))],
        "summary": (hostile("summary"),),
        "inputs": STUDY_TEXT,
        "provenance": {hostile("software"): hostile("version")},
    }


PAPER_FIELDS = _fields(
    "caption heading heading-unit cell reason item statement note picture question failure summary inputs changed "
    "software version"
)


def one_pixel() -> bytes:
    """A PNG file."""
    from io import BytesIO

    from matplotlib.image import imsave

    stream = BytesIO()
    imsave(stream, np.zeros((1, 1, 3)), format="png")
    return stream.getvalue()


def write_hostile_pages(folder: Path) -> dict[str, tuple[str, ...]]:
    """Write the pages report, sweep, band, design and paper; returns the name of each and the fields that must be read
    in it."""
    write_page(folder / "report.html", hostile_response(), hostile_study())
    write_sweep_page(folder / "sweep.html", *hostile_sweep())
    write_band_page(folder / "band.html", *hostile_band())
    write_design_page(folder / "design.html", *hostile_design())
    (folder / "sides.png").write_bytes(one_pixel())
    write_paper_page(folder / "paper.html", **hostile_paper_page(folder / "sides.png"))
    return {
        "report": STUDY_FIELDS,
        "sweep": SWEEP_FIELDS,
        "band": BAND_FIELDS,
        "design": DESIGN_FIELDS,
        "paper": PAPER_FIELDS,
    }
