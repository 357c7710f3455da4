"""The examples of joints: stickslip computes what their comments promise, and their meshes can be made again."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

from stickslip.case.load import load_case
from stickslip.results.measures import summary
from stickslip.study.solution import solve_case

EXAMPLES = Path(__file__).parents[1] / "examples"
JOINTS = EXAMPLES / "joints"
# The warnings that a study explains itself; any other one would make its result doubtful.
EXPECTED_WARNINGS = {"joints/blade_root.toml": ("[rotation]: contact alone", "[rotation] at 3000 rpm")}
PROMISE = re.compile(
    r"^# Peak: (\S+) um at (\S+) Hz, against (\S+) um with stuck pairs; friction dissipates (\S+) % of the loss\.$",
    flags=re.MULTILINE,
)
# Numbers in comments have three digits.
LAST_DIGIT = 6e-3


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [
        "own_mesh/study.toml",
        "joints/lap_joint.toml",
        "joints/blade_root.toml",
        "joints/shroud.toml",
        "strip_damper.toml",
        "cylindrical_damper.toml",
    ],
)
def test_a_joint_does_what_its_comment_promises(name: str) -> None:
    path = EXAMPLES / name
    (numbers,) = PROMISE.findall(path.read_text(encoding="utf-8"))
    peak_um, peak_hz, stuck_um, friction_percent = map(float, numbers)
    solution = solve_case(load_case(path))
    assert solution.converged
    record, response = solution.record, solution.response
    measures = summary(response, record.outputs[record.response_output])
    assert 1e6 * measures.peak.amplitude == pytest.approx(peak_um, rel=LAST_DIGIT)
    assert measures.peak.frequency_hz == pytest.approx(peak_hz, abs=0.06)
    assert 1e6 * measures.stuck_peak.amplitude == pytest.approx(stuck_um, rel=LAST_DIGIT)
    assert 100.0 * measures.friction_share == pytest.approx(friction_percent, abs=0.6)
    assert friction_percent > 20.0  # a joint that damps
    warnings = [*record.warnings, *response.warnings]
    expected = EXPECTED_WARNINGS.get(name, ())
    assert len(warnings) == len(expected), warnings
    assert all(words.startswith(start) for words, start in zip(warnings, expected, strict=True)), warnings


def numbers_and_words(deck: str) -> tuple[list[float], list[str]]:
    """The coordinates of a deck, and all other lines of it."""
    lines = deck.splitlines()
    nodes = [line for line in lines if line.count(",") == 3 and "*" not in line and "." in line]
    others = [line for line in lines if line not in set(nodes)]
    return [float(word) for line in nodes for word in line.split(",")], others


@pytest.mark.slow
@pytest.mark.parametrize("name", ["lap_joint", "blade_root", "shroud"])
def test_the_script_makes_the_meshes_again(name: str, tmp_path: Path) -> None:
    runpy.run_path(str(JOINTS / "make_meshes.py"))["main"](tmp_path)
    stored, made = (numbers_and_words((folder / f"{name}.inp").read_text("utf-8")) for folder in (JOINTS, tmp_path))
    assert stored[0] == pytest.approx(made[0], abs=2e-5)  # mm; the last digit may round otherwise elsewhere
    assert stored[1] == made[1]
