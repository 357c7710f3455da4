"""The result of mistuning: how much more single blades of a disk move because its blades differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray
from stickslip.results.mistuning_figure import mistuning_figure
from stickslip.results.table import Table, column_of
from stickslip.results.variables import Attribute, Count, Json, Labelled, Numbers, Text, stored

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PERCENTILE = 99.0  # chosen: the usual measure of rare patterns; fewer than 100 patterns have no such one
ENOUGH = 100
LIMITS = {"stuck": "contacts stuck", "free": "no contact"}
_PATTERNS, _RING = ("pattern", "blade"), ("ring_point", "blade")


@dataclass(frozen=True, eq=False)
class Mistuning(Labelled):
    """Amplification factors of a disk whose blades differ, over the peak of the tuned disk (docs/theory_mistuning.md).

    Parameters
    ----------
    deviation:
        (n_patterns, N) relative deviation of the natural frequencies of each blade alone.
    blade_alone_hz:
        (k,) Hz, natural frequencies of the tuned blade alone, its root fixed.
    stuck_factor, free_factor:
        (n_patterns, N) highest amplitude of each blade over that of the tuned disk, both linear, with all contacts
        stuck and without contact; None where the tuned disk has no resonance in the frequency range.
    stuck_peak_hz, free_peak_hz:
        (n_patterns,) Hz, frequency of the highest amplitude of all blades.
    shown:
        index of the pattern with the largest linear factor, the first one of those that are there: stuck, free.
    ring_hz, ring_amplitude:
        (n_points,) Hz and (n_points, N) m, 0-to-peak: the whole disk with friction for this pattern; None if it was
        not solved.
    tuned_amplitude:
        m, the peak of the tuned disk with friction, 0-to-peak.
    converged, message:
        whether the curves with friction are complete, and a message.
    warnings:
        messages, for example on a linear limit without resonance in the range.
    """

    DATASET_TITLE: ClassVar[str] = "Amplification factors of a mistuned disk"

    deviation: FloatArray = field(
        metadata=stored(Numbers(_PATTERNS, "1", "relative deviation of the natural frequencies of each blade alone"))
    )
    blade_alone_hz: FloatArray = field(
        metadata=stored(Numbers(("blade_mode",), "Hz", "natural frequencies of a blade alone", name="blade_alone"))
    )
    shown: int = field(metadata=stored(Count("index of the pattern with the largest linear factor")))
    tuned_amplitude: FloatArray = field(
        metadata=stored(Numbers((), "m", "peak of the tuned disk with friction, 0-to-peak"))
    )
    converged: bool = field(metadata=stored(Attribute(0, 1, bool)))
    message: str = field(metadata=stored(Text("message of the curve of the mistuned disk with friction")))
    warnings: tuple[str, ...] = field(metadata=stored(Json(list[str], "warnings, JSON list")))
    stuck_factor: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(_PATTERNS, "1", "amplification factor of each blade, contacts stuck", optional=True)),
    )
    stuck_peak_hz: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(("pattern",), "Hz", "frequency of the highest amplitude, stuck", optional=True)),
    )
    free_factor: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(_PATTERNS, "1", "amplification factor of each blade, no contact", optional=True)),
    )
    free_peak_hz: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(("pattern",), "Hz", "frequency of the highest amplitude, no contact", optional=True)),
    )
    ring_hz: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(("ring_point",), "Hz", "frequency along the curve of the disk", optional=True)),
    )
    ring_amplitude: FloatArray | None = field(
        default=None,
        metadata=stored(Numbers(_RING, "m", "amplitude of each blade with friction, 0-to-peak", optional=True)),
    )

    def __post_init__(self) -> None:
        patterns, blades = np.shape(self.deviation)
        points = 0 if self.ring_hz is None else np.size(self.ring_hz)
        sizes = {"pattern": patterns, "blade": blades, "blade_mode": np.size(self.blade_alone_hz), "ring_point": points}
        self._require_sizes(sizes)
        if not 0 <= self.shown < patterns:
            raise InputError(f"shown is {self.shown}, but there are {patterns} patterns.", arguments=["shown"])
        object.__setattr__(self, "warnings", tuple(self.warnings))

    __repr__ = short_repr

    @property
    def blades(self) -> int:
        """Number N of blades."""
        return int(self.deviation.shape[1])

    @property
    def whitehead_limit(self) -> float:
        """``(1 + sqrt(N)) / 2``, the largest linear factor of one family of modes under one engine order."""
        return float(1.0 + np.sqrt(self.blades)) / 2.0

    @property
    def limits(self) -> dict[str, FloatArray]:
        """Words of each linear limit that is there -> (n_patterns, N) factors."""
        found = {words: getattr(self, f"{name}_factor") for name, words in LIMITS.items()}
        return {words: factor for words, factor in found.items() if factor is not None}

    @property
    def friction_factor(self) -> FloatArray | None:
        """(N,) highest amplitude of each blade of the shown pattern with friction, over that of the tuned disk."""
        return None if self.ring_amplitude is None else self.ring_amplitude.max(axis=0) / self.tuned_amplitude

    @property
    def factor(self) -> float | None:
        """The highest factor of the shown pattern: with friction, else of the first linear limit; None without any."""
        if self.friction_factor is not None:
            return float(self.friction_factor.max())
        return next((float(factors[self.shown].max()) for factors in self.limits.values()), None)

    def words(self) -> Iterator[str]:
        """Sentences on the distribution over the patterns, and on the shown one."""
        count = len(self.deviation)
        for limit, factors in self.limits.items():
            highest = factors.max(axis=1)
            if count == 1:
                yield f"Linear, {limit}: {self._top(factors[0])}"
                continue
            rare = f", 1 % of them exceed {np.percentile(highest, PERCENTILE):.3g}" if count >= ENOUGH else ""
            yield (
                f"Linear, {limit}: the amplification factors of {count} patterns are {highest.min():.3g} to "
                f"{highest.max():.3g}; half of them exceed {np.median(highest):.3g}{rare}."
            )
        friction = self.friction_factor
        if friction is not None:
            which = "" if count == 1 else f", pattern {self.shown + 1}"
            yield f"With friction{which}: {self._top(friction)}"
        yield (
            f"Whitehead's limit for {self.blades} blades is {self.whitehead_limit:.3g}: linear factors of one family "
            "of modes under one engine order do not pass it."
        )

    def _top(self, factors: FloatArray) -> str:
        """The blade that moves most, and that which moves least."""
        most, least = int(factors.argmax()), int(factors.argmin())
        return (
            f"blade {most + 1} moves {factors[most]:.3g} times as much as the tuned disk, blade {least + 1} least, "
            f"{factors[least]:.3g} times as much."
        )

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        """See :class:`stickslip.results.part.ResultPart`: the patterns, the blades of the shown one, and its curve."""
        columns = [column_of("pattern", "", np.arange(1, len(self.deviation) + 1))]
        columns += [column_of(f"factor, {words}", "", factors.max(axis=1)) for words, factors in self.limits.items()]
        columns += [column_of(f"deviation of blade {blade + 1}", "", row) for blade, row in enumerate(self.deviation.T)]
        yield Table(name, "amplification factor of each pattern of mistuning", tuple(columns))
        own = [column_of("blade", "", np.arange(1, self.blades + 1))]
        own.append(column_of("deviation", "", self.deviation[self.shown]))
        own += [column_of(f"factor, {words}", "", factors[self.shown]) for words, factors in self.limits.items()]
        if self.friction_factor is not None:
            own.append(column_of("factor, friction", "", self.friction_factor))
        yield Table("mistuned_blades", f"blades of pattern {self.shown + 1}", tuple(own))
        if self.ring_hz is not None and self.ring_amplitude is not None:
            curve = [column_of("frequency", "Hz", self.ring_hz)]
            curve += [column_of(f"blade {each + 1}", "m", row) for each, row in enumerate(self.ring_amplitude.T)]
            yield Table("mistuned_curve", "amplitude of each blade with friction, 0-to-peak", tuple(curve))

    def closing_words(self, name: str) -> Iterator[str]:
        """See :class:`stickslip.results.part.ResultPart`: the factors."""
        yield f"Mistuning: {self.message}"
        yield from (f"  {sentence}" for sentence in self.words())
        yield from (f"Warning: {sentence}" for sentence in self.warnings)

    def plot(self) -> Figure:
        """Distribution over the patterns with Whitehead's limit, and the blades of the shown pattern, a figure of
        matplotlib."""
        blades = {words: factors[self.shown] for words, factors in self.limits.items()}
        if self.friction_factor is not None:
            blades["friction"] = self.friction_factor
        patterns = {words: factors.max(axis=1) for words, factors in self.limits.items()}
        return mistuning_figure(patterns, blades, self.whitehead_limit)
