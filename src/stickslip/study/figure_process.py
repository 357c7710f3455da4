"""The single figures of a study, drawn in a second process while the first one solves and writes its other files.

Importing and drawing with matplotlib takes as long as solving. The second process starts with the study, imports what
it needs beside the solver, and draws while the results file, the page and the shapes are written. It receives pickled
data through its standard input and answers through its standard output; it never runs a user's script, nor modules in
the current folder. It ends with the first process, also if that is killed, because its input ends then.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
import time
import traceback
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import IO, TYPE_CHECKING, Any, cast

import numpy as np

from stickslip.contact.stiffness.surface import draw_phases, fractal_surface, frequency_count, sdq, sq
from stickslip.core.errors import InputError, StickslipError
from stickslip.core.files import remove_abandoned, remove_own_unfinished
from stickslip.core.processes import leave_signals_to_parent, python_command
from stickslip.model.model import kind_of
from stickslip.model.rough_face import waves_of
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.rough_patch import RoughPatch

if TYPE_CHECKING:
    from stickslip.case.case import Case

FIGURE_GRID = (98, 420)  # points across and along, of the single figure
PAGE_GRID = (40, 140)  # of the page, which contains every height
LAST_SECONDS = 2.0  # between the end of the pipe and the end of the first process, at most


def rough_patch(case: Case, grid: tuple[int, int]) -> RoughPatch | None:
    """Heights of one rough face of a case from its roughness, ridges and seed, on a grid of points across and along.

    None if no face of the case follows from a roughness. Raises InputError for a roughness without a surface.
    """
    section = case.roughness
    if section is None or not case.has_rough_faces:
        return None
    waves = waves_of(section)
    along, across = kind_of(case).rough_face_size(case)
    x, y = np.meshgrid(np.linspace(0.0, along, grid[1]), np.linspace(0.0, across, grid[0]))
    phases = draw_phases(section.seed, section.ridges, frequency_count(*waves[2:]))
    return RoughPatch(
        along,
        across,
        fractal_surface(x, y, *waves[:3], section.ridges, phases, waves.ratio),
        sq=sq(*waves),
        sdq=sdq(*waves),
    )


@dataclass(frozen=True)
class Drawing:
    """The figures of a case, written into a folder in the formats of the case."""

    folder: Path
    case: Case

    def of_response(self, response: ForcedResponse, record: StudyRecord) -> list[Path]:
        """Write every figure of a response; returns the files. Raises InputError."""
        from stickslip.reporting.figures import save_all

        self._make_folder()
        return save_all(self.folder, response, record, self.case.output.figure_formats)

    def of_roughness(self) -> list[Path]:
        """Write a picture of one rough face: heights from the roughness, its ridges and its seed. Raises InputError."""
        patch = rough_patch(self.case, FIGURE_GRID)
        if patch is None:
            return []
        from stickslip.reporting.figures import save, surface

        self._make_folder()
        figure = surface(*np.meshgrid(patch.along, patch.across), patch.height)
        return [save(figure, self.folder / f"rough_face.{ending}") for ending in self.case.output.figure_formats]

    def _make_folder(self) -> None:
        """Make the folder, but not its parents: a user who removed them during the solution needs no figures."""
        try:
            self.folder.mkdir(exist_ok=True)
        except OSError as error:
            raise InputError(
                f'the folder "{self.folder}" of the figures cannot be created ({error.strerror}). Give a '
                "writable folder."
            ) from error


class SecondProcess:
    """A process that draws the rough face at once, and the rest when it gets the response.

    Leaving the ``with`` block ends it.
    """

    def __init__(self, drawing: Drawing) -> None:
        self._drawing = drawing

    def __enter__(self) -> SecondProcess:
        self._process = subprocess.Popen(
            python_command("from stickslip.study.figure_process import serve; serve()"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        self._send(self._drawing)
        return self

    def start(self, response: ForcedResponse, record: StudyRecord) -> None:
        """Send the data to draw, without waiting."""
        self._send((response, record))

    def _send(self, data: object) -> None:
        stream = cast(IO[bytes], self._process.stdin)
        try:
            pickle.dump(data, stream)
            stream.flush()
        except BrokenPipeError:
            return  # it died; files() reports it

    def files(self) -> list[Path]:
        """Wait for the figures; returns the files. Raises what the drawing raised, RuntimeError if the process died."""
        answer = cast(IO[bytes], self._process.stdout).read()
        code = self._process.wait()
        if not answer:
            raise RuntimeError(f"the process of the figures stopped with code {code} and without an answer.")
        outcome = pickle.loads(answer)
        if isinstance(outcome, StickslipError):
            raise outcome
        if isinstance(outcome, str):
            raise RuntimeError(f"the figures could not be created:\n{outcome}")
        return cast("list[Path]", outcome)

    def __exit__(self, *details: object) -> None:
        self._process.kill()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
        self._process.wait()
        remove_abandoned(self._drawing.folder)  # its unfinished files


class NoFigures:
    """In place of a :class:`SecondProcess` for a case without figures."""

    def __enter__(self) -> NoFigures:
        return self

    def start(self, response: ForcedResponse, record: StudyRecord) -> None:
        """Nothing is drawn."""

    def files(self) -> list[Path]:
        """None."""
        return []

    def __exit__(self, *details: object) -> None:
        """Nothing ends."""


def artist_of(drawing: Drawing) -> SecondProcess | NoFigures:
    """The process that draws the figures of a case; a case without figures starts none."""
    return SecondProcess(drawing) if drawing.case.output.figure_formats else NoFigures()


def serve() -> None:
    """Main function of the second process: read a drawing, draw the rough face, read a response, draw it, answer."""
    leave_signals_to_parent()
    messages: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_receive, args=(messages, os.getppid()), daemon=True).start()
    answer: Any
    try:
        drawing = _next(messages)
        files = drawing.of_roughness()
        response, record = _next(messages)
        answer = [*drawing.of_response(response, record), *files]
    except StickslipError as error:
        answer = error
    except Exception:  # the first process raises any error again: see files()
        answer = traceback.format_exc()
    pickle.dump(answer, sys.stdout.buffer)
    sys.stdout.buffer.flush()


def _next(messages: SimpleQueue[Any]) -> Any:
    """The next message. Raises an error of its reading."""
    message = messages.get()
    if isinstance(message, Exception):
        raise message
    return message


def _receive(messages: SimpleQueue[Any], parent: int) -> None:
    """Forward the messages of the first process until it closes the pipe or dies; then this process ends, also while it
    draws."""
    folder = None
    # not sys.stdin, which Python closes at its end, while this thread still reads
    with open(0, "rb", closefd=False) as stream:
        while True:
            try:
                message = pickle.load(stream)
            except (EOFError, OSError, pickle.UnpicklingError):  # the end, or an incomplete message of a killed process
                break
            except Exception as error:
                messages.put(error)
                return
            folder = folder or message.folder
            messages.put(message)
    _end_after(parent, folder)


def _end_after(parent: int, folder: Path | None) -> None:
    """Wait for the end of the first process, remove the unfinished files of both, and end."""
    deadline = time.monotonic() + LAST_SECONDS
    while os.getppid() == parent and time.monotonic() < deadline:
        time.sleep(0.01)  # it has the locks of its unfinished files until its end
    remove_own_unfinished()
    if folder is not None:
        remove_abandoned(folder.parent)
    os._exit(0)
