"""A band: samples of distributed inputs, solved as the cases of a sweep, and their statistics."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, fields, replace
from os import PathLike
from pathlib import Path

import numpy as np
import scipy.stats

from stickslip.case.case import Case
from stickslip.case.load import load_case_and_positions
from stickslip.case.scatter_text import scatter_text
from stickslip.core.errors import InputError, StickslipError
from stickslip.core.progress import Progress
from stickslip.core.units import number_or_text
from stickslip.core.validation import FloatArray, whole_number
from stickslip.reporting.band_page import write_band_page
from stickslip.reporting.templates import StudyText
from stickslip.results.band import STRESS_MEASURES, Limit, TractionRange, limit_of, wants_stress
from stickslip.results.band_statistics import BandStatistics
from stickslip.results.record import run_provenance
from stickslip.results.storage import load_results
from stickslip.results.sweep_table import SweepTable
from stickslip.study.stress import require_stress
from stickslip.sweeps.distributions import Distribution, described, distributions
from stickslip.sweeps.plan import LARGEST_SWEEP, PlannedCase, hash_of, plan_rows
from stickslip.sweeps.run import SolvedCases, solve_planned
from stickslip.sweeps.work import HARMONICS

TABLE_FILE, DATASET_FILE, PAGE_FILE = "band.csv", "band.nc", "band.html"
DEFAULT_SAMPLES = 64  # chosen: a power of two, as Sobol points require
SLOW_SWEEPS = ("upward_", "downward_")  # measures for which the stability of the points decides
LEAST_SAMPLES = 8  # chosen: fewer have no percentiles
_SEED = 20_251_001  # of the scrambling: a band with more samples contains those of one with fewer


@dataclass(frozen=True, eq=False)
class Band(BandStatistics):
    """The result of a band: its statistics (:class:`BandStatistics`) and files.

    case_files:
        results file of each row, None for a sample without one.
    files:
        table as CSV, statistics as NetCDF, and the page.
    reused:
        number of samples that an earlier band had finished.
    notices:
        messages on files that could not be used.
    """

    case_files: tuple[Path | None, ...]
    files: tuple[Path, ...]
    reused: int
    notices: tuple[str, ...]


def band(
    case: Case | str | PathLike[str],
    scatter: Mapping[str, str] | None = None,
    executor: Executor | None = None,
    out: str | PathLike[str] | None = None,
    progress: Progress | None = None,
    *,
    samples: int = DEFAULT_SAMPLES,
    limits: Sequence[str] = (),
    workers: int | None = None,
    threads: int = 1,
) -> Band:
    """Percentiles of the curve, of peaks and of their frequencies of a case with distributed inputs.

    The inputs are independent. The samples are scrambled Sobol points with a fixed seed (A. B. Owen, J. Complexity 14,
    1998), mapped by the inverse distribution functions. Sobol indices are those of polynomials that are fitted to the
    samples (:mod:`stickslip.results.influence`).

    Parameters
    ----------
    case:
        the case, or the path of a study file, whose own distributions then apply. With ``analysis.traction_band`` the
        range of the peak over residual tractions is computed once, for central inputs (docs/band.md).
    scatter:
        "section.key" -> distribution: "0.3 +- 0.1", "lognormal 0.3 */ 1.5", "0.2 .. 0.4", "0.2 .. 0.4 log",
        "0.2 | 0.3 | 0.35" (docs/band.md). It replaces that of a study file.
    samples:
        number of samples, best a power of two.
    limits:
        requirements "peak_amplitude < 0.2 mm" whose probability to be exceeded is computed; < or >, and one of
        peak_amplitude, upward_peak_amplitude, downward_peak_amplitude, peak_frequency, upward_peak_frequency,
        downward_peak_frequency; stress (largest von Mises stress at the highest peak, away from contacts and loads) or
        alternating_stress. With a limit of a stress each sample has both.
    executor, out, progress, workers, threads:
        as for :func:`stickslip.sweep`. A band into a folder with finished samples solves only the others; more samples
        contain those of fewer.

    Raises
    ------
    InputError
        for keys, distributions, limits or cases that are not valid, before anything is solved. ResultsFileError where
        files cannot be written. A sample that fails raises nothing: its row has the message.
    """
    own: Mapping[str, str] = {}
    if not isinstance(case, Case):
        case, places = load_case_and_positions(case)
        own = places.scattered
    chosen = distributions({**own, **(scatter or {})}, case)
    required = require_limits(limits, samples, case)
    with_stress = wants_stress(required)
    points = sample_points(len(chosen), samples)
    keys = tuple(each.key(points[:, place]) for place, each in enumerate(chosen))
    samples_case = case.replace({"analysis.traction_band": False})
    planned = plan_rows(samples_case, keys, ((row,) * len(keys) for row in range(samples)), of="band")

    def solved(some: Iterable[PlannedCase], workers: int | None = workers) -> SolvedCases:
        # listed values can give one case several times
        different = tuple({each.key: each for each in some}.values())
        files = TABLE_FILE, DATASET_FILE, PAGE_FILE
        return solve_planned(different, out, files, executor, progress, workers=workers, threads=threads)

    if any(limit.measure.name.startswith(SLOW_SWEEPS) for limit in required):
        planned = tuple(replace(each, name=f"checked_{each.name}") for each in planned)
    else:
        first = _without_checks(_central(samples_case, chosen))
        harmonics = None if case.solver.accuracy is None else _harmonics(lambda: solved([first], workers=1), first)
        planned = tuple(_without_checks(each, harmonics) for each in planned)
    further: dict[str, tuple[str, str]] = {}
    if with_stress:
        planned = tuple(map(_with_stress, planned))
        away = "away from contacts and loads"
        further = {each.column: (each.unit, f"{each.words}, {away}") for each in STRESS_MEASURES.values()}
    central = _central(case, chosen) if case.analysis.traction_band else None
    run = solved((*planned, *([central] if central else [])))
    table = SweepTable(keys, tuple(run.row(each) for each in planned), further)
    curves = tuple(run.outcomes[each.key].curve for each in planned)
    coordinates = [each.coordinate(points[:, place]) for place, each in enumerate(chosen)]
    inputs = [described(each) for each in chosen]
    tractions = None if central is None else _traction_range(run, central)
    statistics = BandStatistics.of(table, curves, inputs, coordinates, required, tractions)
    files = () if run.folder is None else _written(run.folder.path, case, statistics)
    case_files = tuple(run.folder.path / row.file if run.folder and row.file else None for row in table.rows)
    content = {field.name: getattr(statistics, field.name) for field in fields(statistics)}
    return Band(**content, case_files=case_files, files=files, reused=run.reused, notices=tuple(run.notices))


def _without_checks(planned: PlannedCase, harmonics: int | None = None) -> PlannedCase:
    """A sample without multipliers and search for missed peaks, which take most of its time; solved first with the
    ``harmonics`` of the central curve."""
    key = hash_of({"case": planned.key, "checks": False} | ({} if harmonics is None else {HARMONICS: harmonics}))
    return replace(planned, key=key, checks=False, harmonics=harmonics)


def _with_stress(planned: PlannedCase) -> PlannedCase:
    """A sample with the stress at its peak, in a folder of its own beside that of the same sample without it."""
    key = hash_of({"case": planned.key, "stress": True})
    return replace(planned, name=f"stress_{planned.name}", key=key, wants_stress=True)


def _harmonics(solve: Callable[[], SolvedCases], central: PlannedCase) -> int | None:
    """The most harmonics that the accuracy requires along the central curve; None if that curve is not known."""
    try:
        outcome = solve().outcomes[central.key]
    except StickslipError:  # such as an unusable joint; the samples meet and report it too
        return None
    return outcome.details.get(HARMONICS) if outcome.converged else None


def _central(case: Case, chosen: Sequence[Distribution]) -> PlannedCase:
    """The case with central inputs, with the band of its residual tractions."""
    centres = {
        each.name: number_or_text(text.centre) for each in chosen if (text := scatter_text(each.text)) is not None
    }
    (planned,) = plan_rows(case.replace(centres), (), [()], of="band")
    return replace(planned, name=f"central_{planned.key[:12]}")


def _traction_range(run: SolvedCases, central: PlannedCase) -> TractionRange | str:
    """The range of peaks over residual tractions, or why there is none; its curves are in the results file."""
    row = run.row(central)
    ends = [row.measures.get(f"{end}_traction_peak_amplitude_m") for end in ("lowest", "highest")]
    if ends[0] is None or ends[1] is None:
        return " ".join([row.message, *row.warnings])
    curves: tuple[tuple[FloatArray, FloatArray], ...] = ()
    if run.folder is not None and row.file:
        saved = load_results(run.folder.path / row.file)
        if saved.study is not None and saved.response.traction_band is not None:
            output = saved.study.outputs[saved.study.response_output]
            sides = saved.response.traction_band.curves(output)
            curves = tuple((each.frequency_hz, each.amplitude) for each in sides)
    return TractionRange(row.measures["peak_amplitude_m"], ends[0], ends[1], curves)


def require_limits(limits: Sequence[str], samples: int, case: Case) -> list[Limit]:
    """The limits of a band of a case. Raises InputError for an unknown one, for that of a stress where the structure
    has none, and for a number of samples that is not possible."""
    whole_number("samples", samples, LEAST_SAMPLES)
    if samples > LARGEST_SWEEP:
        raise InputError(f"samples is {samples}, but at most {LARGEST_SWEEP} are allowed.", arguments=["samples"])
    required = [limit_of(text) for text in limits]
    if wants_stress(required):
        require_stress(case, "a band")
    return required


def sample_points(inputs: int, samples: int) -> FloatArray:
    """(samples, inputs) scrambled Sobol points in the open unit cube; the first ones of any larger number."""
    sobol = scipy.stats.qmc.Sobol(inputs, scramble=True, seed=np.random.default_rng(_SEED))
    points: FloatArray = sobol.random_base2(max(samples - 1, 1).bit_length())[:samples]
    return points


def _written(folder: Path, case: Case, statistics: BandStatistics) -> tuple[Path, ...]:
    """Table, statistics and page."""
    files = tuple(folder / name for name in (TABLE_FILE, DATASET_FILE, PAGE_FILE))
    statistics.table.to_csv(files[0])
    statistics.to_netcdf(files[1])
    write_band_page(
        files[2], statistics, case.study.title, StudyText(case.to_text(), case.changed_keys()), run_provenance()
    )
    return files
