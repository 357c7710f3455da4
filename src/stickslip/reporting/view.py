"""Data of all figures of one run, computed once: amplitude, summary, the peak, the first pair to show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stickslip.core.shown_numbers import MICRO, energy_unit
from stickslip.core.validation import FloatArray
from stickslip.results.measures import Summary, summary
from stickslip.results.peaks import window_around
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.sweeps_of_curve import SlowSweep


@dataclass(frozen=True)
class View:
    """A response and its study, with the arrays that several figures draw.

    ``amplitude_um`` (n_points,), ``stuck_um`` and ``free_um`` (n_linear,) are 0-to-peak in µm; ``point`` is the
    computed point at the peak and ``pair`` the one that dissipates most there; energies times ``energy_factor`` are in
    ``energy_unit``; ``changed_inputs`` are lines of the inputs that differ from their defaults.
    """

    response: ForcedResponse
    study: StudyRecord
    summary: Summary
    amplitude_um: FloatArray
    stuck_um: FloatArray
    free_um: FloatArray
    point: int
    pair: int
    energy_factor: float
    energy_unit: str
    changed_inputs: tuple[str, ...]

    @classmethod
    def of(cls, response: ForcedResponse, study: StudyRecord, changed_inputs: Sequence[str] = ()) -> View:
        """Raises InputError if the study does not belong to the response."""
        study.require_fit(response)
        row = study.outputs[study.response_output]
        measures = summary(response, row)
        point = measures.peak.point
        factor, unit = energy_unit(max(measures.peak_energy, float(response.input_energy.max())))
        return cls(
            response=response,
            study=study,
            summary=measures,
            amplitude_um=MICRO * response.amplitude(row),
            stuck_um=MICRO * response.linear_amplitude(row, "stuck"),
            free_um=MICRO * response.linear_amplitude(row, "free"),
            point=point,
            pair=int(response.friction_energy[point].argmax()),
            energy_factor=factor,
            energy_unit=unit,
            changed_inputs=tuple(changed_inputs),
        )

    def shown_frequency_hz(self, frequency_hz: float) -> float:
        """The frequency of a computed point as the page shows it: that of the peak for the nearest point to it."""
        at_peak = abs(frequency_hz - float(self.response.frequency_hz[self.point])) <= 1e-9 * frequency_hz
        return self.summary.peak.frequency_hz if at_peak else frequency_hz

    @property
    def window_hz(self) -> tuple[float, float]:
        """Frequency range to show: the computed curve and the linear peaks inside their range, with a margin."""
        return window_around(self.response.frequency_hz, [self.summary.stuck_peak, self.summary.free_peak])

    @property
    def output(self) -> FloatArray:
        """(n,) row of the output of the curve."""
        return self.study.outputs[self.study.response_output]

    @cached_property
    def slow_sweeps(self) -> tuple[SlowSweep, SlowSweep]:
        """The slow sweep up and the slow sweep down of the output of the curve."""
        return self.response.slow_sweeps(self.output)

    @property
    def stuck_words(self) -> str:
        """Name of the linear stuck curve, in which pairs that are open at rest stay open."""
        return self.response.stuck_name

    @property
    def rest_pressure_mpa(self) -> FloatArray:
        """(n_pairs,) MPa at rest; not a number for a pair that is open there or whose law has no normal load."""
        pressure = 1e-6 * self.response.pairs.normal_load / self.study.pair_area
        return np.where(pressure > 0.0, pressure, np.nan)

    @property
    def unloaded_words(self) -> str:
        """The words for pairs without a pressure at rest."""
        return "open at rest" if self.response.pairs.is_coulomb else "open at rest, or of a law without a normal load"

    @property
    def tangential_words(self) -> str:
        """Title of an axis of forces along t1 and t2."""
        return "Friction force, N" if self.response.pairs.is_coulomb else "Tangential force, N"

    @property
    def rest_varies(self) -> bool:
        """Whether the pressure at rest differs within a face, so that a map of it is useful."""
        pressure = np.nan_to_num(self.rest_pressure_mpa)  # zero for pairs without any
        faces = (pressure[self.study.pair_face == face] for face in range(len(self.study.face_names)))
        return any(np.ptp(here) > 1e-6 * float(pressure.max()) for here in faces)

    def pair_label(self, pair: int) -> str:
        """Name of a pair for a reader: face, number in that face from 1, place in mm."""
        face = int(self.study.pair_face[pair])
        number = int((self.study.pair_face[:pair] == face).sum()) + 1
        along, across = np.round(1e3 * self.study.pair_position[pair], 1) + 0.0  # no minus sign before 0.0
        place = f"({along:.1f}, {across:.1f} mm)".replace("-", "−")
        return f"{self.study.face_names[face]}, pair {number} {place}"
