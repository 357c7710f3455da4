"""Runs the computations of the plan in a few processes; each finished one is a file, so a stopped run continues."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from threadpoolctl import threadpool_limits

from stickslip.case.case import Case
from stickslip.core.errors import ResultsFileError, RoughnessError, StickslipError
from stickslip.core.files import write_solved
from stickslip.core.progress import Progress
from stickslip.model.joint import Joint
from stickslip.model.model import connect, load_joint, set_up
from stickslip.model.rough_face import case_roughness
from stickslip.model.study_structure import ReducedStructure
from stickslip.papers.rough_damper.no_stiffness import why_no_stiffness
from stickslip.papers.rough_damper.plan import Computation, Setting
from stickslip.papers.rough_damper.records import Solved, record
from stickslip.study.analyses import solve
from stickslip.study.facts import study_warnings
from stickslip.sweeps.plan import PlannedCase
from stickslip.sweeps.run import local_executor
from stickslip.sweeps.schedule import Schedule, StructureGroup
from stickslip.sweeps.work import CaseOutcome, CaseTask

FOLDER = "computations"


@dataclass(frozen=True)
class SettingTask(CaseTask):
    """A case to solve, with its labels."""

    setting: Setting


@dataclass(frozen=True)
class Failure:
    """A computation without a result, and a message with the reason."""

    setting: Setting
    message: str


@dataclass(frozen=True)
class Computed:
    """What came of the plan: curves in its order, failures, how many an earlier run had finished, and sentences about
    files of it that could not be used."""

    solved: tuple[Solved, ...]
    failures: tuple[Failure, ...]
    reused: int
    notices: tuple[str, ...]


def compute(plan: Sequence[Computation], out: Path, workers: int, progress: Progress) -> Computed:
    """Compute what no earlier run finished. Raises ResultsFileError where files cannot be written."""
    folder = out / FOLDER
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResultsFileError(
            f'the folder "{folder}" cannot be created ({error.strerror}). Give another --out.'
        ) from error
    run = _Run(plan, folder, progress)
    run.find_finished()
    groups = run.check()
    if groups:
        with local_executor(workers) as executor:
            Schedule(executor, lambda: executor.tasks_at_a_time, run.finish, run.fail, solve_setting).run(groups)
    solved = tuple(run.solved[each.planned.key] for each in plan if each.planned.key in run.solved)
    return Computed(solved, tuple(run.failures), run.reused, tuple(run.notices))


def solve_setting(task: CaseTask, reduced: ReducedStructure) -> CaseOutcome:
    """Solve one case; its file contains a record. An error of stickslip becomes the message."""
    assert isinstance(task, SettingTask)
    try:
        with threadpool_limits(limits=task.threads):
            model = connect(task.case, reduced, task.joint)
            response = solve(task.case, model, threads=task.threads)
            warnings = (*study_warnings(task.case, task.joint), *response.warnings)
            solved = record(task.setting, model, response, reduced.mode_table, warnings)
    except StickslipError as error:
        return CaseOutcome(converged=False, message=str(error), measures={})
    return CaseOutcome(response.converged, response.message, {}, file=solved.to_bytes(task.key))


def _require_published_stiffness(case: Case, joint: Joint) -> None:
    """Raise RoughnessError for a face to which the published sums give no stiffness.

    Other studies use the least stiffness of its real area. This one is about the published equations.
    """
    for face, materials in zip(joint.rough_faces, joint.layout.face_materials, strict=True):
        if face is not None and face.has_least_stiffness:
            reason = why_no_stiffness(case_roughness(case, *materials), face.pressure * face.reference_area)
            raise RoughnessError(f"the published sums give a face no stiffness: {reason}")


class _Run:
    """The computations and their outcomes so far."""

    def __init__(self, plan: Sequence[Computation], folder: Path, progress: Progress) -> None:
        self._plan, self._folder, self._progress = plan, folder, progress
        self._setting = {each.planned.key: each.setting for each in plan}
        self.solved: dict[str, Solved] = {}
        self.failures: list[Failure] = []
        self.notices: list[str] = []
        self.reused = 0

    def _file(self, planned: PlannedCase) -> Path:
        return self._folder / f"{planned.name}.npz"

    def find_finished(self) -> None:
        """Take over the files of an earlier run; one that cannot be used is named and computed again."""
        for each in self._plan:
            file = self._file(each.planned)
            if not file.exists():
                continue
            try:
                self.solved[each.planned.key] = Solved.from_bytes(file.read_bytes(), each.planned.key)
            except (OSError, ResultsFileError) as error:
                problem = f"{error.strerror}." if isinstance(error, OSError) else error
                self.notices.append(f'"{file}" is not used: {problem} This curve is computed again.')
        self.reused = len(self.solved)

    def check(self) -> list[StructureGroup]:
        """Joints of the remaining cases, grouped by structure; a joint without stiffness is a failure at once."""
        groups: dict[str, StructureGroup] = {}
        for each in self._plan:
            planned = each.planned
            if planned.key in self.solved:
                continue
            if planned.structure not in groups:
                groups[planned.structure] = StructureGroup(set_up(planned.case))
            group = groups[planned.structure]
            try:
                joint = load_joint(planned.case, group.setup.layout)
                _require_published_stiffness(planned.case, joint)
            except StickslipError as error:
                self.failures.append(Failure(each.setting, str(error)))
                continue
            task = SettingTask(planned.case, planned.key, joint, 1, True, each.setting, name=planned.name)
            group.cases.append((planned, task))
        return [group for group in groups.values() if group.cases]

    def finish(self, planned: PlannedCase, outcome: CaseOutcome) -> None:
        """Keep a result as a file, or its message; a curve that was not followed to its end counts as a failure."""
        if outcome.converged:
            file = self._file(planned)
            write_solved(file, outcome.file, "computation", ResultsFileError, then="start the same command again")
            self.solved[planned.key] = Solved.from_bytes(outcome.file, planned.key)
        else:
            self.failures.append(Failure(self._setting[planned.key], outcome.message))
        done, total = len(self.solved) + len(self.failures), len(self._plan)
        self._progress.update("Curves", done / total, f"{done} of {total}, {self.reused} from an earlier run")

    def fail(self, planned: PlannedCase, error: BaseException) -> None:
        """A computation that ended with another exception; it is tried again by the next run."""
        self.failures.append(Failure(self._setting[planned.key], f"{type(error).__name__}: {error}"))
