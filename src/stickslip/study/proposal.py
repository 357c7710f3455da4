"""A sensible frequency range and excitation of a study, from its linear peaks and the beginning of slip."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from stickslip.case.case import Case
from stickslip.case.consistency import RANGE_KEYS
from stickslip.case.load import has_range
from stickslip.core.errors import InputError, StickslipError
from stickslip.core.shown_numbers import length
from stickslip.core.threads import thread_count
from stickslip.model.model import build_model, kind_of
from stickslip.results.measures import hertz
from stickslip.solve.ridges.slip_onset import NEARLY_ALL, SlipOnset, slip_onset
from stickslip.study.assembled import Assembled

# chosen: the range continues by this fraction of the frequency beyond both linear peaks.
BEYOND_PEAKS = 0.08
# chosen: the same fraction below the stuck peak where no free peak bounds how far slip lowers it.
BELOW_LOOSE = 0.25
# chosen: excitation over that of the first slip where it is not known when nearly all pairs slip: many do.
MANY_SLIP = 4.0


@dataclass(frozen=True)
class Proposal:
    """What a study should contain.

    onset:
        linear peaks and the beginning of slip; None if they could not be computed, and ``trouble`` gives the reason.
    frequency_hz:
        range around both linear peaks; None without one.
    excitation:
        over that of the study, between those at which the first pair and nearly all pairs slip; None if not known.
    """

    onset: SlipOnset | None
    trouble: str
    frequency_hz: tuple[float, float] | None
    excitation: float | None

    def keys(self, case: Case) -> dict[str, float]:
        """Key -> proposed value in SI units. Raises InputError if nothing can be proposed."""
        if self.frequency_hz is None:
            raise InputError(f"no frequency range can be proposed: {self.trouble or 'there is no linear peak.'}")
        keys = dict(zip((f"solver.{key}" for key in RANGE_KEYS), self.frequency_hz, strict=True))
        if self.excitation is not None:
            now = kind_of(case).excitation_keys(case)
            keys |= {key: _rounded(self.excitation * value) for key, value in now.items()}
        return keys

    def rows(self, case: Case) -> Iterator[tuple[str, str]]:
        """(label, value) for ``stickslip check``."""
        if self.onset is None:
            yield "linear peaks", f"not computed: {self.trouble}"
            return
        for words, peak in (("contacts stuck", self.onset.stuck_peak), ("no contact", self.onset.free_peak)):
            text = "none among the first modes"
            if words == "no contact" and self.onset.is_loose:
                text = "none: without contact the excitation moves the output as a rigid body"
            if peak is not None:
                size = "no bound without viscous damping"
                if math.isfinite(peak.amplitude):
                    size = f"{' '.join(length(peak.amplitude))} under this excitation"
                text = f"{hertz(peak.frequency_hz)} Hz, {size}"
            yield f"linear peak, {words}", text
        shown = kind_of(case).excitation_keys(case)
        first, nearly_all = self.onset.first, self.onset.nearly_all
        yield "first pair slips at the stuck peak", "not known" if first is None else _sizes(shown, first)
        text = "not known"
        if nearly_all is not None:
            sizes = dict.fromkeys(_sizes(shown, each) for each in nearly_all)
            text = f"{' to '.join(sizes)} ({'lower and upper estimate' if len(sizes) > 1 else 'both estimates'})"
        yield f"nearly all ({100 * NEARLY_ALL:g} %) slip there", text
        if self.trouble:
            yield "not known", self.trouble
        if self.frequency_hz is not None:
            low, high = self.frequency_hz
            yield "proposed range", f"{low:g} to {high:g} Hz"
        if self.excitation is not None:
            yield "proposed excitation", f"{_sizes(shown, self.excitation)}; a part of the pairs slips"
        yield "to write them", '"stickslip new FILE --from STUDY"'


def proposed_section(case: Case, assembled: Assembled) -> tuple[str, list[tuple[str, str]]]:
    """The proposal as a section of ``stickslip check``. Raises InputError."""
    return "A sensible study", list(propose(case, assembled).rows(case))


def propose(case: Case, assembled: Assembled | None = None, threads: int | None = None) -> Proposal:
    """The proposal for a case; builds its structure, unless it is given as ``assembled``, and reduces it; a run uses
    the reduction again. Raises InputError for a case whose structure cannot be built."""
    assembled = assembled or Assembled.of(case)
    model = build_model(case, assembled.structure, assembled.joint, thread_count(threads))
    output = next(iter(model.outputs.values()))
    highest_hz = max(case.solver.frequency_start, case.solver.frequency_stop)
    try:
        onset = slip_onset(
            model.substructure,
            model.pairs,
            model.excitation,
            output,
            modal_damping_ratio=case.damping.modal_damping_ratio,
            highest_hz=highest_hz if has_range(case) else None,
        )
    except StickslipError as error:
        return Proposal(None, str(error), None, None)
    peaks = [each.frequency_hz for each in (onset.stuck_peak, onset.free_peak) if each is not None]
    excitation = None
    if onset.first is not None:
        last = onset.nearly_all
        excitation = MANY_SLIP * onset.first if last is None else math.sqrt(onset.first * last[1])
    below = BELOW_LOOSE if onset.is_loose else BEYOND_PEAKS
    return Proposal(onset, onset.trouble, _range_around(peaks, below) if peaks else None, excitation)


def _range_around(peaks_hz: list[float], below: float) -> tuple[float, float]:
    """A range around the peaks, from the fraction ``below`` below them, whose ends are round numbers."""
    low, high = (1.0 - below) * min(peaks_hz), (1.0 + BEYOND_PEAKS) * max(peaks_hz)
    step = 10.0 ** math.floor(math.log10(high - low)) / 10.0
    return max(step * math.floor(low / step), step), step * math.ceil(high / step)


def _rounded(value: float) -> float:
    return float(f"{value:.2g}")


def _sizes(keys: dict[str, float], factor: float) -> str:
    """The excitation of a study times a factor, in words."""
    if len(keys) == 1 and next(iter(keys)).startswith(("excitation.", "forces.")):
        return f"{factor * next(iter(keys.values())):.3g} N"
    return f"{factor:.3g} times the excitation of this study"
