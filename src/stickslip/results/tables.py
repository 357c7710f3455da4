"""The results of a study as plain tables: columns with names and units, for spreadsheets and MATLAB."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from stickslip.contact.law.law import ContactState
from stickslip.results.measures import SUMMARY_COLUMNS, energy_imbalance, equivalent_damping, state_counts, summary
from stickslip.results.other_solutions import OtherSolutions
from stickslip.results.pair_measures import pair_measures
from stickslip.results.record import MODE_COLUMNS, StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.table import Table, column_of


def study_tables(response: ForcedResponse, study: StudyRecord) -> tuple[Table, ...]:
    """All tables of a solved study that have rows, in SI units."""
    tables = [
        _curve(response, study),
        _linear(response, study),
        _measures(response, study),
        _outputs_at_peak(response, study),
        _pairs_at_peak(response, study),
        _jumps(response, study),
        _rows("bifurcations", "changes of stability along the curve", _BIFURCATION, response.bifurcations),
        _natural_frequencies(response),
        _nodal_diameters(study),
        _modes(study),
        *_side_curves(response, study),
        *(table for name, part in response.parts.items() for table in part.tables(name, study.outputs)),
        *_stress(study),
        _tuples("derived", "derived quantities", ("quantity", "value", "unit", "meaning"), study.derived),
        _tuples("inputs", "the study file", ("key", "value"), list(study.input_values().items())),
        _tuples("settings", "settings of the solver", ("setting", "value"), list(response.settings.items())),
        _tuples("provenance", "software and date", ("name", "value"), list(response.provenance.items())),
        _tuples("warnings", "warnings of the study and of the solver", ("warning",), _warnings(response, study)),
        _tuples("notes", "notes on the model file", ("note",), [(words,) for words in study.notes]),
    ]
    return tuple(table for table in tables if table is not None and len(table.columns[0].values))


def _curve(response: ForcedResponse, study: StudyRecord) -> Table:
    counts = state_counts(response.contact_state)
    row = study.outputs[study.response_output]
    coefficients = response.coefficients(row)
    columns = [
        column_of("point", "", np.arange(1, response.n_points + 1)),
        column_of("frequency", "Hz", response.frequency_hz),
        *(column_of(f"amplitude of {name}", "m", response.amplitude(each)) for name, each in study.outputs.items()),
        column_of(f"first harmonic of {study.response_output}, cosine", "m", coefficients[:, 1]),
        column_of(f"first harmonic of {study.response_output}, sine", "m", coefficients[:, 2]),
        column_of(f"mean of {study.response_output}", "m", coefficients[:, 0]),
        *(column_of(f"pairs {state.name.lower().replace('_', '-')}", "", counts[:, state]) for state in ContactState),
        column_of("friction energy", "J", response.friction_energy.sum(axis=1)),
        column_of("viscous energy", "J", response.viscous_energy),
        column_of("input energy", "J", response.input_energy),
        column_of("kinetic energy", "J", response.kinetic_energy),
        column_of("equivalent damping ratio", "1", equivalent_damping(response)),
        column_of("energy imbalance", "1", energy_imbalance(response)),
        column_of("load factor", "1", response.load_factor),
        column_of("stable", "", response.stable_points.astype(int)),
        column_of("part", "", response.part),
        column_of("residual", "1", response.residual),
        column_of("iterations", "", response.iterations),
    ]
    if response.doubtful is not None:
        columns.append(column_of("doubtful stability", "", response.doubtful.astype(int)))
    if response.point_harmonics is not None:
        columns.append(column_of("harmonics", "", response.point_harmonics))
    if response.estimated_error is not None:
        columns.append(column_of("estimated error", "1", response.estimated_error))
    return Table("curve", "points of the curve, in its order; amplitudes 0-to-peak, energies per cycle", tuple(columns))


def _linear(response: ForcedResponse, study: StudyRecord) -> Table:
    row = study.outputs[study.response_output]
    limits = [
        column_of(f"amplitude of {study.response_output}, {limit}", "m", response.linear_amplitude(row, limit))
        for limit in ("stuck", "free")
    ]
    columns = (column_of("frequency", "Hz", response.linear.frequency_hz), *limits)
    return Table("linear_limits", "linear responses, pairs closed at rest stuck, and without contact", columns)


def _measures(response: ForcedResponse, study: StudyRecord) -> Table:
    measures = summary(response, study.outputs[study.response_output])
    rows = []
    for name, (unit, meaning, value) in SUMMARY_COLUMNS.items():
        number = value(measures)
        rows.append((name, None if number is None else float(number), unit, meaning))
    return _tuples("measures", "measures at the highest peak", ("measure", "value", "unit", "meaning"), rows)


def _outputs_at_peak(response: ForcedResponse, study: StudyRecord) -> Table:
    """Fourier coefficients of all outputs at the highest peak."""
    point = summary(response, study.outputs[study.response_output]).peak.point
    names, series = list(study.outputs), [response.coefficients(row)[point] for row in study.outputs.values()]
    columns = [column_of("output", "", names), column_of("mean", "m", [each[0] for each in series])]
    for harmonic in range(1, response.harmonics + 1):
        columns.append(column_of(f"cosine {harmonic}", "m", [each[2 * harmonic - 1] for each in series]))
        columns.append(column_of(f"sine {harmonic}", "m", [each[2 * harmonic] for each in series]))
    return Table("outputs_at_peak", "Fourier coefficients of the responses at the highest peak", tuple(columns))


def _pairs_at_peak(response: ForcedResponse, study: StudyRecord) -> Table:
    point = summary(response, study.outputs[study.response_output]).peak.point
    pairs, measured = response.pairs, pair_measures(response, point)
    names = pairs.state_names
    states = [names.get(ContactState(code), "") for code in response.contact_state[point].tolist()]
    columns = (
        column_of("pair", "", np.arange(1, pairs.n_pairs + 1)),
        column_of("face", "", [study.face_names[face] for face in study.pair_face]),
        column_of("position along", "m", study.pair_position[:, 0]),
        column_of("position across", "m", study.pair_position[:, 1]),
        column_of("area", "m2", study.pair_area),
        column_of("normal load at rest", "N", pairs.normal_load),
        column_of("state", "", states),
        column_of("stick fraction", "1", measured.stick_fraction),
        column_of("slip fraction", "1", measured.slip_fraction),
        column_of("separated fraction", "1", measured.separated_fraction),
        column_of("slip distance", "m", measured.slip_distance),
        column_of("mean normal pressure", "Pa", measured.mean_normal_force / study.pair_area),
        column_of("dissipated energy", "J", response.dissipated_energy[point]),
        column_of("work of the normal force", "J", response.normal_work[point]),
    )
    words = "contact pairs at the highest peak; fractions of the period; slip distance, energy and work per cycle"
    return Table("pairs_at_peak", words, columns)


def _jumps(response: ForcedResponse, study: StudyRecord) -> Table:
    jumps = response.jumps(study.outputs[study.response_output])
    columns = (
        column_of("sweep", "", [jump.direction for jump in jumps]),
        column_of("frequency", "Hz", [jump.frequency_hz for jump in jumps]),
        column_of("amplitude before", "m", [jump.amplitude_from for jump in jumps]),
        column_of("amplitude after", "m", [jump.amplitude_to for jump in jumps]),
    )
    return Table("jumps", "jumps of slow sweeps up and down", columns)


_BIFURCATION = (("kind", ""), ("frequency_hz", "Hz"), ("position", "1"))


def _natural_frequencies(response: ForcedResponse) -> Table:
    stuck, free = response.linear.stuck_frequency_hz, response.linear.free_frequency_hz
    count = max(stuck.size, free.size)
    padded = [np.pad(each, (0, count - each.size), constant_values=np.nan) for each in (stuck, free)]
    columns = (
        column_of("mode", "", np.arange(1, count + 1)),
        column_of("stuck", "Hz", padded[0]),
        column_of("free", "Hz", padded[1]),
    )
    words = "natural frequencies without damping, pairs closed at rest stuck, and without contact"
    return Table("natural_frequencies", words, columns)


def _nodal_diameters(study: StudyRecord) -> Table | None:
    """None for a structure that is no disk."""
    if study.disk is None:
        return None
    disk = study.disk
    tables = (("stuck", disk.stuck_hz), ("free", disk.free_hz), ("opposite", disk.opposite_hz))
    columns = [
        column_of(f"{words} {number}", "Hz", row)
        for words, table in tables
        if table is not None
        for number, row in enumerate(table.T, start=1)
    ]
    words = "lowest natural frequencies of each nodal diameter, pairs closed at rest stuck, and without contact"
    return Table("nodal_diameters", words, (column_of("nodal diameter", "", disk.diameters), *columns))


def _modes(study: StudyRecord) -> Table:
    used = [key for key in MODE_COLUMNS if any(key in row for row in study.mode_table)]
    units = {"difference_percent": "%"} | {key: "Hz" for key in MODE_COLUMNS if key.endswith("_hz")}
    columns = [
        column_of(
            key.removesuffix("_hz").removesuffix("_percent"),
            units.get(key, ""),
            [row.get(key) for row in study.mode_table],
        )
        for key in used
    ]
    return Table(
        "modes", f"full and reduced model, contact {study.mode_contact}", tuple(columns or [column_of("mode", "", [])])
    )


def _side_curves(response: ForcedResponse, study: StudyRecord) -> Iterator[Table]:
    """Curves with extreme tractions, and motions that are not on the curve."""
    row = study.outputs[study.response_output]
    sides = {
        "stiffness_band": response.stiffness_band,
        "residual_tractions": response.traction_band,
        "other_solutions": response.other_solutions,
    }
    for name, side in sides.items():
        curves = () if side is None else side.curves(row)
        columns = [
            column_of("curve", "", [curve.name for curve in curves for _ in curve.frequency_hz]),
            column_of("frequency", "Hz", [value for curve in curves for value in curve.frequency_hz]),
            column_of(f"amplitude of {study.response_output}", "m", [a for curve in curves for a in curve.amplitude]),
            column_of("stable", "", [flag for curve in curves for flag in curve.stable]),
        ]
        if isinstance(side, OtherSolutions) and side.doubtful_points is not None:
            columns.append(column_of("doubtful stability", "", side.doubtful_points.astype(int)))
        yield Table(name, f"{name.replace('_', ' ')} beside the curve", tuple(columns))


def _stress(study: StudyRecord) -> Iterator[Table]:
    if study.stress is None:
        return
    for name, words, rows in (
        ("stress", "away from contacts and loads", study.stress.extremes),
        ("stress_whole_mesh", "on the whole mesh", study.stress.everywhere),
        ("safety_factors", "smallest safety factors of the Goodman check", study.stress.goodman),
    ):
        columns = (
            column_of("measure", "", [row.quantity for row in rows]),
            column_of("value", "1" if name == "safety_factors" else "Pa", [row.value for row in rows]),
            column_of("body", "", [row.body for row in rows]),
            *(column_of(axis, "m", [row.position[at] for row in rows]) for at, axis in enumerate("xyz")),
        )
        yield Table(name, f"extremes of stress at the peak, {words}", columns)


def _warnings(response: ForcedResponse, study: StudyRecord) -> list[tuple[str]]:
    return [(words,) for words in (*study.warnings, *response.warnings)]


def _rows(name: str, meaning: str, columns: Sequence[tuple[str, str]], rows: Sequence[Any]) -> Table:
    """A table of attributes of objects."""
    made = (column_of(key.removesuffix("_hz"), unit, [getattr(row, key) for row in rows]) for key, unit in columns)
    return Table(name, meaning, tuple(made))


def _tuples(name: str, meaning: str, columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> Table:
    """A table of rows whose cells have no units, or whose units are in a column."""
    made = (column_of(column, "", [row[at] for row in rows]) for at, column in enumerate(columns))
    return Table(name, meaning, tuple(made))
