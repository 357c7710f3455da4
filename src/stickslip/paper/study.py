"""``stickslip paper``: compute the plan, judge the claims, write page, figures and numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.errors import ConvergenceError
from stickslip.model import build_mesh, find_pairs
from stickslip.paper import figures, items
from stickslip.paper.claims import CLAIMS
from stickslip.paper.compute import Computed, Failure, compute
from stickslip.paper.items import Item, base
from stickslip.paper.page import write_page
from stickslip.paper.plan import Scope, base_case, computations
from stickslip.paper.records import Solved
from stickslip.paper.tables import Table, write_csv, write_netcdf
from stickslip.paper.verdicts import Verdict
from stickslip.progress import Progress, SilentProgress
from stickslip.results.record import run_provenance
from stickslip.structure.craig_bampton import paper_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE_FILE = "paper.html"
NUMBERS_FILE = "paper.nc"
FIGURE_FOLDER = "figures"
TABLE_FOLDER = "tables"


@dataclass(frozen=True)
class PaperOutcome:
    """What the study wrote, and what has no result."""

    files: tuple[Path, ...]
    curves: int
    found: int
    failures: tuple[Failure, ...]
    verdicts: dict[Verdict, int]


def paper_study(
    out: str | PathLike[str], workers: int = 2, progress: Progress | None = None, scope: Scope | None = None
) -> PaperOutcome:
    """Compute the whole study and write DIR/paper.html, figures, tables and paper.nc.

    What an earlier run into the same folder finished is not computed again. Raises InputError, ResultsFileError;
    ConvergenceError where not one curve was found.
    """
    folder, told, wanted = Path(out), progress or SilentProgress(), scope or Scope()
    plan = computations(wanted)
    computed = compute(plan, folder, workers, told)
    if not computed.solved:
        raise ConvergenceError(f"none of {len(plan)} curves has a result. The first: {computed.failures[0].message}")
    return _written(folder, wanted, computed, told)


def _written(folder: Path, scope: Scope, computed: Computed, told: Progress) -> PaperOutcome:
    told.update("Files", 0.0, "verdicts")
    shown = _items(scope, computed.solved)
    verdicts: dict[Verdict, int] = {}
    for claim in CLAIMS:
        verdict = claim.judged(base(computed.solved)).verdict
        verdicts[verdict] = verdicts.get(verdict, 0) + 1
    told.update("Files", 0.1, FIGURE_FOLDER)
    drawn = _drawn(folder / FIGURE_FOLDER, scope, computed.solved)
    tables = [table for item in shown for table in item.tables]
    tables += [items.answers_table(computed.solved), items.peak_table("curves", "All curves", computed.solved)]
    told.update("Files", 0.8, TABLE_FOLDER)
    files = [*_tables(folder / TABLE_FOLDER, tables), write_netcdf(tables, computed.solved, folder / NUMBERS_FILE)]
    page = folder / PAGE_FILE
    pictures = {name: written[-1] for name, written in drawn.items()}
    write_page(page, shown, pictures, verdicts, computed.failures, base_case(scope).to_text(), run_provenance())
    told.update("Files", 1.0, PAGE_FILE)
    files = [page, *files, *(file for written in drawn.values() for file in written)]
    return PaperOutcome(tuple(files), len(computed.solved), computed.found, computed.failures, verdicts)


def _items(scope: Scope, solved: Sequence[Solved]) -> tuple[Item, ...]:
    mesh = build_mesh(base_case(scope))
    pairs = find_pairs(mesh).n_pairs
    return (
        items.reduction_item(solved, 3 * mesh.n_nodes, pairs),
        items.conclusions_item(solved),
        items.choices_item(solved, scope),
    )


def _tables(folder: Path, tables: Sequence[Table]) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    return [write_csv(table, folder) for table in tables]


def _drawn(folder: Path, scope: Scope, solved: Sequence[Solved]) -> dict[str, tuple[Path, ...]]:
    folder.mkdir(parents=True, exist_ok=True)
    drawings: dict[str, Callable[[], Figure]] = {
        "fig02_reduction": lambda: figures.reduction(solved[0].mode_table, paper_table()),
    }
    return {name: figures.write(folder, name, draw) for name, draw in drawings.items()}
