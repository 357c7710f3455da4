"""All statistics of the samples of a band, and their file."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np

from stickslip.core.errors import ResultsFileError
from stickslip.core.files import whole_file
from stickslip.results.band import (
    LIMITED_MEASURES,
    MEASURES,
    PERCENTILES,
    CurveBand,
    Exceedance,
    Limit,
    Percentiles,
    TractionRange,
    curve_band,
    exceedance,
    percentiles,
    wants_stress,
)
from stickslip.results.influence import Coordinate, Influence, influence
from stickslip.results.netcdf import netcdf_bytes
from stickslip.results.sweep_table import Again, SweepCurve, SweepTable

if TYPE_CHECKING:
    import xarray

_NUMBER = re.compile(r"\d[\d.,e+-]*")


@dataclass(frozen=True, eq=False)
class BandStatistics:
    """The samples of a band and their statistics.

    table:
        one row for each sample; ``table.to_csv(path)``, ``table.column(name)``.
    curves:
        amplitude curve of each row, None for a sample without result.
    inputs:
        (key, text, form of the distribution, range) of each input.
    percentiles:
        name of a measure (``results.band.MEASURES``, with a limit of a stress also ``STRESS_MEASURES``) -> its
        percentiles.
    influences:
        the same -> its Sobol indices.
    exceedances:
        of each limit.
    curve_band:
        percentiles of the curves; None if no curve is complete.
    tractions:
        range of the peak over residual tractions with central inputs; None if not asked for, or not computed.
    missing_tractions:
        why it was not computed, "" otherwise.
    """

    table: SweepTable
    curves: tuple[SweepCurve | None, ...]
    inputs: tuple[tuple[str, str, str, str], ...]
    percentiles: dict[str, Percentiles]
    influences: dict[str, Influence]
    exceedances: tuple[Exceedance, ...]
    curve_band: CurveBand | None
    tractions: TractionRange | None
    missing_tractions: str

    @classmethod
    def of(
        cls,
        table: SweepTable,
        curves: tuple[SweepCurve | None, ...],
        inputs: Sequence[tuple[str, str, str, str]],
        coordinates: Sequence[Coordinate],
        limits: Sequence[Limit],
        tractions: TractionRange | str | None = None,
    ) -> Self:
        """The statistics of samples; ``tractions`` is the range over them, or why there is none."""
        measures = LIMITED_MEASURES if wants_stress(limits) else MEASURES
        complete = [curve for curve, row in zip(curves, table.rows, strict=True) if curve is not None and row.converged]
        return cls(
            table,
            curves,
            tuple(inputs),
            {name: percentiles(measure, table) for name, measure in measures.items()},
            {name: influence(coordinates, measure.of(table)) for name, measure in measures.items()},
            tuple(exceedance(limit, table) for limit in limits),
            curve_band(complete),
            tractions if isinstance(tractions, TractionRange) else None,
            tractions if isinstance(tractions, str) else "",
        )

    @property
    def open_peaks(self) -> int:
        """Number of complete samples whose largest amplitude is at an end of the range."""
        bracketed = self.table.column("peak_bracketed")
        return sum(row.converged and value != 1.0 for row, value in zip(self.table.rows, bracketed, strict=True))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on all samples together."""
        return tuple(self._remarks())

    def _remarks(self) -> Iterator[str]:
        count, failed = len(self.table.rows), len(self.table.failed)
        if failed:
            yield (
                f"{failed} of {count} samples failed: percentiles and indices are those of the other "
                f"{count - failed}, and the interval of a probability contains both outcomes of the failed ones."
            )
        if self.open_peaks:
            yield (
                f"The largest amplitude of {self.open_peaks} of {count} samples is at an end of the frequency range, "
                "so their true peak may be higher. Extend solver.frequency_start and frequency_stop."
            )
        band = self.curve_band
        if band is not None and int(band.count.min()) < count - failed:
            yield (
                f"At some frequencies only {int(band.count.min())} of {count - failed} complete curves have a point; "
                "the band there is that of these curves."
            )
        if self.missing_tractions:
            yield f"The range over residual tractions with central inputs was not computed: {self.missing_tractions}"
        warned = sum(bool(row.warnings) for row in self.table.rows)
        if warned:
            yield (
                f"{warned} of {count} samples have warnings of the study or of the solver; the table has them. "
                f"{self._most_frequent_warning()}"
            )
        if count & (count - 1):
            yield (
                f"{count} samples are not a power of two; low-discrepancy points are balanced best with "
                f"{2 ** (count.bit_length() - 1)} or {2 ** count.bit_length()}."
            )

    @property
    def solved_again(self) -> str:
        """How many samples were solved again and why, each first reason without its number; "" for none."""
        reasons = [row.again_because[0] for row in self.table.rows if row.again_because]
        if not reasons:
            return ""
        kinds = Counter(reasons)
        found = ", ".join(f"{kind.words()} ({kinds[kind]})" for kind in Again if kinds[kind])
        number = f"{len(reasons)} of {len(self.table.rows)} samples {'was' if len(reasons) == 1 else 'were'}"
        return (
            f"{number} solved again, with more harmonics, more samples of a period or as a single case, because the "
            f"first curve was not accurate enough: {found}. Their rows have the figures."
        )

    def _most_frequent_warning(self) -> str:
        """The first of those that agree but for their numbers, with the number of samples that have it."""
        alike: dict[str, list[str]] = {}
        for row in self.table.rows:
            for sentence in row.warnings:
                alike.setdefault(_NUMBER.sub("0", sentence), []).append(sentence)
        most = max(alike.values(), key=len)
        return f"The most frequent one, of {len(most)} samples, in the words of the first: {most[0]}"

    def to_dataset(self) -> xarray.Dataset:
        """The samples along ``case``, statistics along ``percentile``, ``band_frequency_hz``, ``input`` and ``end``."""
        import xarray

        names = [name for name, *_ in self.inputs]
        data = xarray.Dataset(
            coords={"percentile": ("percentile", list(PERCENTILES), {"units": "percent"}), "input": ("input", names)}
        )
        for name, result in self.percentiles.items():
            about = {"units": result.measure.unit, "long_name": f"{result.measure.words}, of {result.count} samples"}
            data[f"{name}_percentile"] = (("percentile",), list(result.values), about)
            ends = np.array(result.intervals)
            data[f"{name}_percentile_interval"] = (("percentile", "end"), ends, {"units": result.measure.unit})
        for name, indices in self.influences.items():
            data[f"{name}_unexplained"] = ((), indices.unexplained, {"units": "1", "remark": indices.reason})
            for kind in ("first", "total"):
                data[f"{name}_sobol_{kind}"] = (("input",), list(getattr(indices, kind)), {"units": "1"})
                ends = np.array(getattr(indices, f"{kind}_interval"))
                data[f"{name}_sobol_{kind}_interval"] = (("input", "end"), ends, {"units": "1"})
        if self.exceedances:
            data["limit"] = (("limit_number",), np.array([each.limit.text for each in self.exceedances], dtype=object))
            probabilities = [each.probability for each in self.exceedances]
            data["exceedance_probability"] = (("limit_number",), probabilities, {"units": "1"})
            ends = np.array([each.interval for each in self.exceedances])
            data["exceedance_probability_interval"] = (("limit_number", "end"), ends, {"units": "1"})
        if self.curve_band is not None:
            data["band_frequency_hz"] = (("band_frequency_hz",), self.curve_band.frequency_hz, {"units": "Hz"})
            about = {"units": "m", "long_name": "amplitude, 0-to-peak, mean included, highest branch of each curve"}
            data["band_amplitude"] = (("percentile", "band_frequency_hz"), self.curve_band.amplitude_m, about)
            about = {"units": "1", "long_name": "number of complete curves"}
            data["band_count"] = (("band_frequency_hz",), self.curve_band.count, about)
        if self.tractions is not None:
            about = {"units": "m", "long_name": "lowest and highest peak over residual tractions, central inputs"}
            data["traction_peak"] = (("end",), [self.tractions.low, self.tractions.high], about)
        whole = xarray.merge([self.table.to_dataset(), data])
        return whole.assign_attrs(title="Band of stickslip", remarks=" ".join(self.remarks))

    def to_netcdf(self, path: str | PathLike[str]) -> None:
        """Write ``to_dataset`` as NetCDF-4, completely or not at all. Raises ResultsFileError."""
        content = netcdf_bytes([("", self.to_dataset())])
        with whole_file(Path(path), "statistics", ResultsFileError) as part:
            part.write_bytes(content)
