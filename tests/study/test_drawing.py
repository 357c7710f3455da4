"""Figures drawn in a second process: the same files, and every failure is told."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from helpers import unmeasured
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.model.model import load_joint, set_up
from stickslip.study.facts import derived_quantities
from stickslip.study.figure_process import Drawing, SecondProcess, artist_of, rough_patch
from strangers import is_alive, strangers
from synthetic import synthetic_response, synthetic_study

CASE = Case.from_mapping({"output": {"figure_formats": ["svg"]}})


@pytest.mark.long
@pytest.mark.slow
def test_the_second_process_draws_what_the_first_would(tmp_path: Path) -> None:
    here = Drawing(tmp_path / "here", CASE)
    expected = [*here.of_response(synthetic_response(), synthetic_study()), *here.of_roughness()]
    with SecondProcess(Drawing(tmp_path / "there", CASE)) as artist:
        artist.start(synthetic_response(), synthetic_study())
        there = artist.files()
    assert [file.name for file in there] == [file.name for file in expected]
    assert "rough_face.svg" in {file.name for file in there}
    assert all(file.parent == tmp_path / "there" and file.stat().st_size > 1000 for file in there)


@pytest.mark.slow
def test_every_grid_shows_the_same_face() -> None:
    """Figure and page draw the same heights at the points that they share, to scale, and the statistics of the law."""
    fine, coarse = rough_patch(CASE, (13, 25)), rough_patch(CASE, (5, 9))
    assert fine is not None
    assert coarse is not None
    np.testing.assert_allclose(fine.height[::3, ::3], coarse.height, rtol=1e-12, atol=1e-18)
    assert (coarse.length, coarse.width) == (0.028, 0.0065)
    assert coarse.height[0, 0] == 0.0
    statistics = derived_quantities(CASE, load_joint(CASE, set_up(CASE).layout))
    reported = {name: value for name, value, _, _ in statistics}
    assert (1e6 * coarse.sq, coarse.sdq) == pytest.approx((reported["Sq"], reported["Sdq"]), rel=1e-12)
    changed = rough_patch(CASE.replace({"roughness.seed": 2}), (5, 9))
    assert changed is not None
    assert changed.height.std() != coarse.height.std()


@pytest.mark.slow
def test_no_formats_no_files_and_no_process(tmp_path: Path) -> None:
    with artist_of(Drawing(tmp_path / "none", CASE.replace({"output.figure_formats": []}))) as artist:
        assert not isinstance(artist, SecondProcess)
        artist.start(synthetic_response(), synthetic_study())
        assert artist.files() == []
    assert not (tmp_path / "none").exists()
    assert isinstance(artist_of(Drawing(tmp_path / "some", CASE)), SecondProcess)


def test_given_stiffness_has_no_rough_face(tmp_path: Path) -> None:
    values = {"normal_stiffness": 1e8, "tangential_stiffness": 1e8}
    case = Case.from_mapping({"contact_stiffness": values})
    assert Drawing(tmp_path, case).of_roughness() == []
    assert rough_patch(case, (5, 9)) is None


@pytest.mark.long
def test_what_the_drawing_rejects_is_raised_here(tmp_path: Path) -> None:
    (tmp_path / "amplitude_frequency.svg").mkdir()
    with SecondProcess(Drawing(tmp_path, CASE)) as artist:
        artist.start(synthetic_response(), synthetic_study())
        with rejects(InputError):
            artist.files()


@pytest.mark.long
def test_a_folder_that_cannot_be_made_is_reported(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a folder", encoding="utf-8")
    with SecondProcess(Drawing(tmp_path / "file", CASE)) as artist:
        artist.start(synthetic_response(), synthetic_study())
        with rejects(InputError):
            artist.files()


@pytest.mark.long
def test_a_fault_of_the_drawing_comes_with_its_traceback(tmp_path: Path) -> None:
    with SecondProcess(Drawing(tmp_path, CASE)) as artist:
        artist.start("no response", synthetic_study())  # type: ignore[arg-type]
        with pytest.raises(RuntimeError) as caught:
            artist.files()
    sentence, *traceback = str(caught.value).splitlines()
    printed_sentence(sentence)
    assert traceback[-1].startswith("AttributeError")  # of Python, for a text in place of a response


@pytest.mark.slow
def test_a_process_that_died_is_reported(tmp_path: Path) -> None:
    with SecondProcess(Drawing(tmp_path, CASE)) as artist:
        artist._process.kill()
        artist._process.wait()
        artist.start(synthetic_response(), synthetic_study())
        with pytest.raises(RuntimeError) as caught:
            artist.files()
    printed_sentence(str(caught.value))


def test_a_study_without_a_response_ends_the_process(tmp_path: Path) -> None:
    with SecondProcess(Drawing(tmp_path, CASE)) as artist:
        process = artist._process
    assert process.poll() is not None


@pytest.mark.long
@pytest.mark.usefixtures("untraced_commands")
def test_neither_a_backend_nor_files_of_the_current_folder_are_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Jupyter sets a backend for all commands that are started in it; drawing needs none."""
    strangers(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    with SecondProcess(Drawing(tmp_path / "figures", CASE)) as artist:
        artist.start(synthetic_response(), synthetic_study())
        assert artist.files()
    assert not (tmp_path / "ran").exists()


PARENT = """
import os, sys
from pathlib import Path
from stickslip.case.case import Case
from stickslip.study.figure_process import Drawing, SecondProcess, artist_of
from stickslip.core.errors import InputError
from stickslip.core.files import whole_file
from synthetic import synthetic_response, synthetic_study
out = Path(sys.argv[1])
drawing = Drawing(out / "figures", Case.from_mapping({"output": {"figure_formats": ["svg", "png", "pdf"]}}))
with SecondProcess(drawing) as artist, whole_file(out / "results.nc", "results", InputError) as part:
    part.write_text("half")
    if sys.argv[2] == "drawing":
        artist.start(synthetic_response(), synthetic_study())
    print(artist._process.pid, flush=True)
    artist._process.wait()
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="Windows has no SIGKILL")
@pytest.mark.parametrize("when", ["solving", pytest.param("drawing", marks=pytest.mark.long)])
def test_after_the_parent_was_killed_no_process_and_no_half_file_stays(tmp_path: Path, when: str) -> None:
    paths = os.pathsep.join(["tests", os.environ.get("PYTHONPATH", "")])
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT, str(tmp_path), when],
        stdout=-1,
        text=True,
        env={**unmeasured(), "PYTHONPATH": paths},
    )
    assert parent.stdout is not None
    with parent.stdout:
        child = int(parent.stdout.readline())
        if when == "drawing":  # it is at work
            while not list(tmp_path.glob("figures/.*.part")):
                time.sleep(0.001)
        assert list(tmp_path.glob(".*.part"))
        parent.kill()
        parent.wait()
        deadline = time.monotonic() + 20.0
        while is_alive(child) and time.monotonic() < deadline:
            time.sleep(0.02)
    assert not is_alive(child)
    assert list(tmp_path.rglob(".*.part")) == []


@pytest.mark.long
def test_an_interrupt_while_it_draws_leaves_no_half_file(tmp_path: Path) -> None:
    case = Case.from_mapping({"output": {"figure_formats": ["svg", "png", "pdf"]}})
    with SecondProcess(Drawing(tmp_path / "figures", case)) as artist:
        artist.start(synthetic_response(), synthetic_study())
        while not list(tmp_path.glob("figures/.*.part")):
            time.sleep(0.001)
    assert list(tmp_path.rglob(".*.part")) == []
