"""The evaluations of a design: planned as cases, solved on any executor, stored, and used again."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from stickslip.core.errors import StickslipError
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.shown_numbers import SHOWN, number
from stickslip.core.validation import FloatArray
from stickslip.results.band import STRESS_MEASURES, BandMeasure, Limit, wants_stress
from stickslip.results.design import DesignCase, DesignPeak, Evaluation
from stickslip.sweeps.design_space import DesignSpace, LoadCase
from stickslip.sweeps.design_task import DesignTask, solve_design
from stickslip.sweeps.folder import SweepFolder
from stickslip.sweeps.plan import PlannedCase, case_hashes, case_name, hash_of
from stickslip.sweeps.run import SolvedCases
from stickslip.sweeps.work import CaseOutcome

AT_AN_END = (
    "The largest amplitude is at an end of the frequency range, so the peak is not known. Widen solver.frequency_start "
    "and frequency_stop."
)


@dataclass(frozen=True, eq=False)
class Request:
    """A design that an optimiser requests; ``stage`` as in :class:`Evaluation`."""

    coordinates: FloatArray
    stage: str
    wants_gradients: bool = False


@dataclass(frozen=True)
class Requirements:
    """The measure to minimise, and the limits."""

    measure: BandMeasure
    limits: tuple[Limit, ...]

    @property
    def wants_stress(self) -> bool:
        """Whether a stress is minimised or limited."""
        return self.measure.name in STRESS_MEASURES or wants_stress(self.limits)

    def worst(self, cases: Sequence[DesignCase], measure: BandMeasure, is_upper: bool) -> float:
        """The worst value of a measure over load cases."""
        values = [case.value(measure.name) for case in cases]
        return max(values) if is_upper else min(values)

    def evaluated(
        self, number: int, request: Request, values: tuple[float, ...], cases: tuple[DesignCase, ...]
    ) -> Evaluation:
        """The evaluation of solved cases."""
        failed = any(case.failure for case in cases)
        objective = math.nan if failed else self.worst(cases, self.measure, True)
        required = tuple(
            math.nan if failed else self.worst(cases, limit.measure, limit.is_upper) for limit in self.limits
        )
        excess = [
            value / limit.value - 1.0 if limit.is_upper else limit.value / value - 1.0
            for value, limit in zip(required, self.limits, strict=True)
        ]
        largest = math.nan if failed else max([0.0, *excess])
        at = tuple(float(each) for each in request.coordinates)
        gradient = "exact" if request.wants_gradients and not failed else "none"
        return Evaluation(number, request.stage, at, values, cases, objective, required, largest, gradient)


class DesignCases:
    """Evaluates designs; ``evaluations`` are all of them, in the order of the requests.

    ``solved`` and ``reused`` count the cases that were solved now and those of an earlier run, ``notices`` are messages
    on files that could not be used.
    """

    def __init__(
        self,
        space: DesignSpace,
        requirements: Requirements,
        folder: SweepFolder | None,
        executor: Executor,
        at_a_time: Callable[[], int],
        threads: int,
        progress: Progress,
    ) -> None:
        self.space, self.requirements = space, requirements
        self._folder, self._executor, self._at_a_time = folder, executor, at_a_time
        self._threads, self._progress = threads, progress
        self.evaluations: list[Evaluation] = []
        self.solved = self.reused = 0
        self.notices: list[str] = []
        self._numbers: dict[tuple[tuple[float, ...], bool], int] = {}

    def evaluate(self, requests: Sequence[Request]) -> list[Evaluation]:
        """The evaluations of the requests; those that are new are solved together."""
        places = []
        new: list[tuple[Request, tuple[float, ...], list[PlannedCase | str]]] = []
        for request in requests:
            values = self.space.values(request.coordinates)
            place = self._place(values, request.wants_gradients)
            if place is None:
                place = len(self.evaluations) + len(new)
                self._numbers[values, request.wants_gradients] = place
                new.append((request, values, [self._planned(request, values, each) for each in self.space.load_cases]))
            places.append(place)
        outcomes = self._solve([each for _, _, row in new for each in row if isinstance(each, PlannedCase)], new)
        for request, values, row in new:
            cases = tuple(self._case(each, outcomes) for each in row)
            number = len(self.evaluations) + 1
            self.evaluations.append(self.requirements.evaluated(number, request, values, cases))
        return [self.evaluations[place] for place in places]

    def used_differences(self, evaluation: Evaluation, words: str) -> None:
        """Note that derivatives at an evaluation are differences."""
        place = evaluation.number - 1
        self.evaluations[place] = replace(self.evaluations[place], gradient=words)

    def _place(self, values: tuple[float, ...], wants_gradients: bool) -> int | None:
        """The position of an earlier evaluation with at least what is requested."""
        with_gradients = self._numbers.get((values, True))
        return with_gradients if wants_gradients or with_gradients is not None else self._numbers.get((values, False))

    def _planned(self, request: Request, values: tuple[float, ...], load_case: LoadCase) -> PlannedCase | str:
        """The case of a design, or the reason why it is not valid."""
        try:
            case = self.space.case_at(values, load_case)
        except StickslipError as error:
            return str(error)
        key, structure = case_hashes(case)
        differentiated = [each.name for each in self.space.keys] if request.wants_gradients else []
        key = hash_of({"case": key, "gradients": differentiated, "stress": self.requirements.wants_stress})
        labels = [(each.name, each.label(value)) for each, value in zip(self.space.keys, values, strict=True)]
        return PlannedCase(case_name(labels, key), key, structure, values, case)

    def _solve(
        self,
        planned: list[PlannedCase],
        new: list[tuple[Request, tuple[float, ...], list[PlannedCase | str]]],
    ) -> dict[str, tuple[CaseOutcome, str]]:
        """Outcome and file of each planned case, by its key."""
        different = {each.key: each for each in planned}
        run = SolvedCases(tuple(different.values()), self._folder, SilentProgress())
        run.find_finished()
        self.notices += run.notices
        self.reused += run.reused
        left = [each for each in different.values() if each.key not in run.outcomes]
        stage = new[0][0].stage if new else ""
        self._report(stage, len(left))
        wanted = {
            each.key: request.wants_gradients
            for request, _, row in new
            for each in row
            if isinstance(each, PlannedCase)
        }
        tasks = [(each, self._task(each, wanted[each.key])) for each in left]
        if tasks:
            run.solve([], self._executor, self._at_a_time, tasks, solve_design)
            self.solved += len(tasks)
        return {each.key: (run.outcomes[each.key], run.row(each).file) for each in different.values()}

    def _task(self, planned: PlannedCase, wants_gradients: bool) -> DesignTask:
        return DesignTask(
            planned.case,
            planned.key,
            planned.name,
            tuple(each.name for each in self.space.keys) if wants_gradients else (),
            self.requirements.wants_stress,
            self._threads,
            self._folder is not None,
        )

    @staticmethod
    def _case(planned: PlannedCase | str, outcomes: dict[str, tuple[CaseOutcome, str]]) -> DesignCase:
        """The case of an evaluation, from its outcome."""
        if isinstance(planned, str):
            return DesignCase("", "", planned)
        outcome, file = outcomes[planned.key]
        if not outcome.converged:
            return DesignCase(planned.name, file, outcome.message, curve=outcome.curve)
        rows = outcome.details["peaks"]
        peaks = tuple(
            DesignPeak(
                row["amplitude_m"], row["frequency_hz"], row.get("by_amplitude", {}), row.get("by_frequency_hz", {})
            )
            for row in rows
        )
        failure = "" if rows[0]["bracketed"] else AT_AN_END
        return DesignCase(
            planned.name,
            file,
            failure,
            peaks,
            outcome.details.get("stresses", {}),
            outcome.curve,
            tuple(outcome.details["messages"]),
        )

    def _report(self, stage: str, count: int) -> None:
        """Progress: the stage, and the best design so far."""
        allowed = [each for each in self.evaluations if each.is_allowed]
        words = f"{len(self.evaluations)} designs"
        if allowed:
            best = min(allowed, key=lambda each: each.objective)
            factor, unit = SHOWN[self.requirements.measure.unit]
            words += f", best {number(factor * best.objective)} {unit}"
        self._progress.update("Design", 0.0, f"{stage}: {count} cases; {words}")
