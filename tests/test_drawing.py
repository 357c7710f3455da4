"""Figures drawn in a second process: the same files, and every failure is told."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import pytest

from stickslip.case import Case
from stickslip.drawing import Drawing, SecondProcess
from stickslip.errors import InputError
from synthetic import synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def drawing(tmp_path_factory: pytest.TempPathFactory) -> Drawing:
    case = Case.from_mapping({"output": {"figure_formats": ["svg"]}})
    return Drawing(tmp_path_factory.mktemp("here"), case, synthetic_response(), synthetic_study())


def test_the_second_process_draws_what_the_first_would(drawing: Drawing, tmp_path: Path) -> None:
    here = drawing.draw()
    with SecondProcess() as artist:
        artist.start(replace(drawing, folder=tmp_path))
        there = artist.files()
    assert [file.name for file in there] == [file.name for file in here]
    assert "rough_face.svg" in {file.name for file in there}
    assert all(file.parent == tmp_path and file.stat().st_size > 1000 for file in there)


def test_no_formats_no_files(drawing: Drawing, tmp_path: Path) -> None:
    case = drawing.case.replace({"output.figure_formats": []})
    assert replace(drawing, case=case, folder=tmp_path / "none").draw() == []
    assert not (tmp_path / "none").exists()


def test_what_the_drawing_refuses_is_raised_here(drawing: Drawing, tmp_path: Path) -> None:
    (tmp_path / "amplitude_frequency.svg").mkdir()
    with SecondProcess() as artist:
        artist.start(replace(drawing, folder=tmp_path))
        with pytest.raises(InputError, match="the figure could not be written"):
            artist.files()


def test_a_fault_of_the_drawing_comes_with_its_traceback(drawing: Drawing, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a folder", encoding="utf-8")
    with SecondProcess() as artist:
        artist.start(replace(drawing, folder=tmp_path / "file"))
        with pytest.raises(RuntimeError, match=r"(?s)could not be drawn:.*FileExistsError"):
            artist.files()


def test_a_process_that_died_is_told(drawing: Drawing) -> None:
    with SecondProcess() as artist:
        artist._process.kill()
        artist._process.wait()
        artist.start(drawing)
        with pytest.raises(RuntimeError, match="ended with code -9 and no answer"):
            artist.files()


def test_a_study_without_a_response_ends_the_process() -> None:
    with SecondProcess() as artist:
        process = artist._process
    assert process.poll() is not None


def test_a_drawing_can_be_handed_over(drawing: Drawing) -> None:
    assert pickle.loads(pickle.dumps(drawing)).record.title == drawing.record.title
