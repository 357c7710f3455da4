"""``stickslip paper``: compute the plan, judge the claims, write page, figures and numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.core.errors import ConvergenceError
from stickslip.core.files import require_disk_space, require_folder
from stickslip.core.progress import Progress, SilentProgress
from stickslip.model.kinds.two_blade import TwoBladeKind
from stickslip.papers.rough_damper import choice_items, curve_items, figures, model_items, motion_items, verdict_items
from stickslip.papers.rough_damper.compute import FOLDER as COMPUTATIONS
from stickslip.papers.rough_damper.compute import Computed, Failure, compute
from stickslip.papers.rough_damper.errata import errata_item
from stickslip.papers.rough_damper.items import Item, base, peak_table
from stickslip.papers.rough_damper.motion_items import main_series
from stickslip.papers.rough_damper.page import FIGURE_FOLDER, TABLE_FOLDER, write_page
from stickslip.papers.rough_damper.plan import Scope, base_case, computations
from stickslip.papers.rough_damper.records import Solved
from stickslip.papers.rough_damper.table2 import table2
from stickslip.papers.rough_damper.tables import Table, write_csv, write_netcdf
from stickslip.papers.rough_damper.verdicts import Verdict
from stickslip.reporting.templates import StudyText
from stickslip.results.record import run_provenance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE_FILE = "paper.html"
NUMBERS_FILE = "paper.nc"
SPACE_BYTES = 50_000_000  # for page, figures, tables and computations of the whole study


@dataclass(frozen=True)
class PaperOutcome:
    """What the study wrote, what has no result, and sentences about files of an earlier run that were of no use."""

    files: tuple[Path, ...]
    curves: int
    reused: int
    failures: tuple[Failure, ...]
    verdicts: dict[Verdict, int]
    notices: tuple[str, ...]


def paper_study(
    out: str | PathLike[str], workers: int = 2, progress: Progress | None = None, scope: Scope | None = None
) -> PaperOutcome:
    """Compute the whole study and write DIR/paper.html, figures, tables and paper.nc.

    What an earlier run into the same folder finished is not computed again. Raises InputError, ResultsFileError;
    ConvergenceError where not one curve was found.
    """
    folder, listener, wanted = Path(out), progress or SilentProgress(), scope or Scope()
    plan = computations(wanted)
    require_folder(folder, (PAGE_FILE, NUMBERS_FILE), (FIGURE_FOLDER, TABLE_FOLDER, COMPUTATIONS))
    require_disk_space(folder, SPACE_BYTES, SPACE_BYTES)
    computed = compute(plan, folder, workers, listener)
    if not computed.solved:
        raise ConvergenceError(f"no curve of {len(plan)} has a result. The first: {computed.failures[0].message}")
    return _written(folder, wanted, computed, listener)


def _written(folder: Path, scope: Scope, computed: Computed, listener: Progress) -> PaperOutcome:
    listener.update("Files", 0.0, "verdicts")
    shown, claims, changed = _items(scope, computed.solved)
    counts = Counter(each.judged.verdict for each in claims)
    verdicts = {verdict: counts[verdict] for verdict in Verdict}
    listener.update("Files", 0.1, FIGURE_FOLDER)
    wanted = [picture.name for item in shown for picture in item.figures]
    drawn = _drawn(folder / FIGURE_FOLDER, wanted, _drawings(scope, computed.solved), listener)
    tables = [table for item in shown for table in item.tables]
    tables += [
        verdict_items.answers_table(computed.solved),
        choice_items.reasons_table(changed),
        peak_table("curves", "All curves", computed.solved),
    ]
    listener.update("Files", 0.8, TABLE_FOLDER)
    files = [*_tables(folder / TABLE_FOLDER, tables), write_netcdf(tables, computed.solved, folder / NUMBERS_FILE)]
    page = folder / PAGE_FILE
    pictures = {name: written[-1] for name, written in drawn.items()}
    case = base_case(scope)
    summary = verdict_items.summary_lines(claims)
    study = StudyText(case.to_text(), case.changed_keys())
    write_page(page, shown, pictures, verdicts, computed.failures, summary, study, run_provenance())
    listener.update("Files", 1.0, PAGE_FILE)
    files = [page, *files, *(file for written in drawn.values() for file in written)]
    return PaperOutcome(
        tuple(files), len(computed.solved), computed.reused, computed.failures, verdicts, computed.notices
    )


def _items(
    scope: Scope, solved: Sequence[Solved]
) -> tuple[tuple[Item, ...], list[verdict_items.JudgedClaim], list[choice_items.ChangedVerdict]]:
    """The items of the page in its order, the claims that they judge, and these under every changed choice."""
    case = base_case(scope)
    setup = TwoBladeKind().set_up(case)
    surfaces, stiffness = model_items.surface_item(case), model_items.stiffness_item(case)
    reduction = model_items.reduction_item(case, solved, 3 * setup.mesh.n_nodes, setup.layout.face_pairs.n_pairs)
    claims = verdict_items.judged_claims(case, solved)
    changed = choice_items.changed_verdicts(solved, scope)
    items = (
        verdict_items.conclusions_item(claims, changed),
        choice_items.choices_item(changed, scope),
        reduction,
        surfaces,
        stiffness,
        motion_items.period_item(solved, scope),
        motion_items.damper_item(solved, scope),
        motion_items.states_item(solved, scope),
        curve_items.curves_item(solved),
        curve_items.energy_item(solved),
        curve_items.laws_item(solved),
        errata_item(solved, surfaces.tables[0], stiffness.tables[0]),
    )
    return items, claims, changed


def _tables(folder: Path, tables: Sequence[Table]) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    return [write_csv(table, folder) for table in tables]


def _drawn(
    folder: Path, wanted: Sequence[str], drawings: dict[str, Callable[[], Figure]], listener: Progress
) -> dict[str, tuple[Path, ...]]:
    """Write the wanted figures, in every format."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn = {}
    for place, name in enumerate(wanted):
        listener.update("Files", 0.1 + 0.7 * place / len(wanted), name)
        drawn[name] = figures.write(folder, name, drawings[name])
    return drawn


def _central(solved: Sequence[Solved], scope: Scope, along: str) -> list[Solved]:
    """The curves of the long series of D or G, of every force and load."""
    if along == "D":
        return [one for one in solved if one.setting.scale == scope.scale]
    return [one for one in solved if one.setting.dimension == scope.dimension]


def _drawings(scope: Scope, solved: Sequence[Solved]) -> dict[str, Callable[[], Figure]]:
    """Every figure of the page by its name."""
    case, chosen, main = base_case(scope), base(solved), motion_items.main_run(solved, scope)
    pairs = [one for one in main if one.setting.excitation != "single"]
    place = motion_items.shown_place(pairs)
    same, opposite = motion_items.pick_pair(main, scope)
    drawings: dict[str, Callable[[], Figure]] = {
        "fig02_reduction": lambda: figures.reduction(solved[0].mode_table, table2()),
        "fig04_surfaces": lambda: figures.surfaces(model_items.drawn_faces(case)),
        "contact_stiffness": lambda: figures.stiffness(
            {
                f"G, m (F_N {scope.runs[0][1]:g} N)": model_items.stiffness_over_scale(case),
                f"F_N, N (G = {scope.scale:g} m)": model_items.stiffness_over_load(case, scope.scale),
            }
        ),
        "fig09_damper": lambda: figures.damper_sides(same, opposite),
        "unloading_curves_D": lambda: figures.curves(base(solved, "unloading"), "D"),
    }
    for along, period, states, curves, energy in (("D", 7, 10, 12, 13), ("G", 8, 11, 14, 15)):
        drawings[f"fig{period:02d}_period_{along}"] = partial(figures.period, main_series(main, along), along, place)
        drawings[f"fig{curves}_curves_{along}"] = partial(figures.curves, chosen, along)
        drawings[f"fig{energy}_energy_{along}"] = partial(figures.energies, _central(chosen, scope, along), along)
        for force in dict.fromkeys(force for force, _ in scope.runs):
            run = main_series(motion_items.main_run(solved, scope, force), along)
            drawings[f"fig{states}_states_{along}_{force:g}N"] = partial(figures.state_maps, run, along)
    return drawings
