"""Design: the values of some keys, within ranges and limits, that minimise the worst peak of several load cases."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass, fields
from os import PathLike
from pathlib import Path

from stickslip.case.case import Case, CyclicCase
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.core.files import whole_file
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.threads import usable_cores
from stickslip.core.validation import whole_number
from stickslip.reporting.templates import StudyText
from stickslip.results.band import Limit, limit_of
from stickslip.results.design import (
    DESIGN_MEASURES,
    PEAK,
    DesignResult,
    agreement_sentence,
    optimum_sentences,
)
from stickslip.results.record import run_provenance
from stickslip.study.stress import require_stress
from stickslip.sweeps.axes import Vary
from stickslip.sweeps.design_cases import DesignCases, Requirements
from stickslip.sweeps.design_lock_up import lock_up_in_ranges
from stickslip.sweeps.design_search import best_place, search
from stickslip.sweeps.design_space import DesignSpace, Range
from stickslip.sweeps.folder import SweepFolder
from stickslip.sweeps.pool import SizedExecutor
from stickslip.sweeps.run import SolvedCases, free_workers, local_executor

TABLE_FILE, PAGE_FILE, OPTIMUM_FILE = "design.csv", "design.html", "optimum.toml"
SAMPLES_PER_KEY = 8  # chosen: low-discrepancy samples of the box, times the number of keys
DEFAULT_STARTS = 3  # chosen: the number that agrees shows whether the optimum is a local one
MOST_SAMPLES, MOST_STARTS = 4096, 64  # chosen: each sample is a frequency curve of seconds


@dataclass(frozen=True, eq=False, repr=False)
class Design(DesignResult):
    """The result of a design (:class:`DesignResult`) and its files.

    case:
        the study with the values of the optimum, None if no design satisfies the limits or has a result.
    files:
        table, page and study file of the optimum.
    solved, reused:
        numbers of cases that were solved now, and by an earlier run.
    notices:
        messages on files that could not be used.
    """

    case: Case | None
    files: tuple[Path, ...]
    solved: int
    reused: int
    notices: tuple[str, ...]

    @property
    def converged(self) -> bool:
        """Whether a design satisfies the limits."""
        return self.best is not None


def design(
    case: Case,
    over: Mapping[str, Range],
    executor: Executor | None = None,
    out: str | PathLike[str] | None = None,
    progress: Progress | None = None,
    *,
    minimise: str = PEAK,
    subject_to: Sequence[str] = (),
    worst_of: Vary | None = None,
    samples: int | None = None,
    starts: int = DEFAULT_STARTS,
    workers: int | None = None,
    threads: int = 1,
) -> Design:
    """Minimise a result of a case over some of its keys, within ranges and limits.

    Low-discrepancy samples of the ranges are solved first. From the best of them, sequential quadratic programming
    minimises the largest of all high peaks of all load cases; their derivatives are exact
    (:func:`stickslip.peak_gradients`). Each evaluation is a whole frequency curve. Method: docs/design.md.

    Parameters
    ----------
    case:
        the study; keys that are not in ``over`` are constant.
    over:
        "section.key" -> (from, to) or "FROM:TO", each as in a study file.
    minimise:
        "peak", "peak_frequency", "stress" (largest von Mises stress at the highest peak, away from contacts and loads)
        or "alternating_stress".
    subject_to:
        limits "stress < 300 MPa" of the same measures, with < or >.
    worst_of:
        keys and values of load cases, as for :func:`stickslip.sweep`; the worst of all combinations counts.
    samples, starts:
        number of low-discrepancy samples, by default 8 for each key; number of descents.
    executor, out, progress, workers, threads:
        as for :func:`stickslip.sweep`. The same call into the same folder resumes.

    Raises
    ------
    InputError
        for keys, ranges, limits or geometries that are not valid, before anything is solved. ResultsFileError if files
        cannot be written. A design without any result raises nothing; ``converged`` is False.
    """
    space, requirements = checked_design(case, over, minimise, subject_to, worst_of or {})
    count = min(MOST_SAMPLES, SAMPLES_PER_KEY * len(space.keys)) if samples is None else samples
    for name, number, most in (("samples", count, MOST_SAMPLES), ("starts", starts, MOST_STARTS)):
        whole_number(name, number, 1)
        if number > most:
            raise InputError(f"{name} is {number}, but at most {most} are allowed.", arguments=[name])
    for name, wanted in (("workers", workers), ("threads", threads)):
        if wanted is not None:
            whole_number(name, wanted, 1)
    space.require_valid_box()
    folder = None if out is None else SweepFolder(Path(out))
    if folder is not None:
        folder.make((TABLE_FILE, PAGE_FILE, OPTIMUM_FILE))
    listener = progress or SilentProgress()
    with _workers(executor, workers, threads, listener) as pool:
        cases = DesignCases(space, requirements, folder, pool, free_workers(pool, workers), threads, listener)
        ends, sharpness = search(cases, count, starts)
    summary = DesignResult(
        space.keys,
        tuple(each.words for each in space.load_cases),
        requirements.measure,
        requirements.limits,
        tuple(cases.evaluations),
        best_place(cases.evaluations),
        tuple(ends),
        tuple(sharpness),
        remarks=(),
        cautions=tuple(lock_up_in_ranges(space)),
    )
    content = {field.name: getattr(summary, field.name) for field in fields(summary)} | {
        "remarks": tuple(_remarks(summary))
    }
    optimum = None if summary.optimum is None else space.case_at(summary.optimum.values, space.load_cases[0])
    result = Design(
        **content, case=optimum, files=(), solved=cases.solved, reused=cases.reused, notices=tuple(cases.notices)
    )
    return result if folder is None else _written(folder.path, case, result)


def checked_design(
    case: Case, over: Mapping[str, Range], minimise: str, subject_to: Sequence[str], worst_of: Vary
) -> tuple[DesignSpace, Requirements]:
    """The ranges and limits of a design. Raises InputError for those that cannot be used; builds no mesh."""
    measure = DESIGN_MEASURES.get(minimise)
    if measure is None:
        raise InputError(
            f'minimise is "{minimise}", but it must be one of {", ".join(DESIGN_MEASURES)}.', arguments=["minimise"]
        )
    limits: list[Limit] = [limit_of(text, DESIGN_MEASURES, "design", "subject_to") for text in subject_to]
    requirements = Requirements(measure, tuple(limits))
    if isinstance(case, CyclicCase):
        raise InputError(
            'a design follows gradients, which are not computed for a sector of a disk (structure.kind = "cyclic"). '
            "Use a sweep, or a mesh of the full ring.",
            ("structure.kind",),
        )
    if requirements.wants_stress:
        require_stress(case, "a design")
    return DesignSpace.of(case, over, worst_of), requirements


@contextmanager
def _workers(executor: Executor | None, workers: int | None, threads: int, progress: Progress) -> Iterator[Executor]:
    """The executor of the caller, after a check of its version, or processes of this machine."""
    if executor is None:
        with local_executor(workers or max(1, usable_cores() // threads)) as local:
            yield local
        return
    if not isinstance(executor, SizedExecutor):
        SolvedCases((), None, progress).require_same_version(executor)
    yield executor


def _remarks(result: DesignResult) -> Iterator[str]:
    """Sentences on the optimum and the search."""
    count = len(result.evaluations)
    failed = [each for each in result.evaluations if each.failure]
    if not result.has_results:
        yield (
            f"None of {count} designs has a result, so there is no optimum. The first: {failed[0].failure} The table "
            "of all designs gives the reason of each. Change what these reasons name in the study or in the ranges, "
            "and give the command again."
        )
        return
    nearest = result.nearest
    if nearest is not None:
        values = ", ".join(f"{key.name} = {key.label(at)}" for key, at in zip(result.keys, nearest.values, strict=True))
        yield (
            f"No design of {count} satisfies all limits. The nearest design has {result.violations(nearest)}, with "
            f"{values}."
        )
    else:
        yield from optimum_sentences(result)
        yield agreement_sentence(result)
    differences = sum(each.gradient.startswith("differences") for each in result.evaluations)
    exact = sum(each.gradient == "exact" for each in result.evaluations)
    if differences:
        yield (
            f"{differences} gradients contain central differences of whole solutions, for stresses, corners of the "
            f"curve, and keys without a derivative; {exact} gradients are exact."
        )
    if failed:
        yield f"{len(failed)} of {count} designs have no result and do not count. The first: {failed[0].failure}"


def _written(folder: Path, case: Case, result: Design) -> Design:
    """The result with its files: table, study file of the optimum, page."""
    from dataclasses import replace

    from stickslip.reporting.design_page import write_design_page

    files = [folder / TABLE_FILE]
    result.to_csv(files[0])
    if result.case is not None:
        files.append(folder / OPTIMUM_FILE)
        with whole_file(files[-1], "study file", ResultsFileError) as part:
            part.write_text(result.case.to_text(), encoding="utf-8")
    else:
        (folder / OPTIMUM_FILE).unlink(missing_ok=True)  # of an earlier design with other limits
    files.append(folder / PAGE_FILE)
    write_design_page(
        files[-1], result, case.study.title, StudyText(case.to_text(), case.changed_keys()), run_provenance()
    )
    return replace(result, files=tuple(files))
