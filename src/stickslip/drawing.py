"""The single figures of a study, drawn in a second process while the first one solves and writes its other files.

Importing and drawing with matplotlib takes as long as solving. The second process starts with the study, imports what
it needs beside the solver, and draws while the results file, the page and the shapes are written. It receives pickled
data through its standard input and answers through its standard output; it never runs a user's script.
"""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, cast

import numpy as np

from stickslip.errors import StickslipError
from stickslip.interface.surface import draw_phases, fractal_surface, frequency_count
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse

if TYPE_CHECKING:
    from stickslip.case import Case


@dataclass(frozen=True)
class Drawing:
    """What the figures of a study are drawn from."""

    folder: Path
    case: Case
    response: ForcedResponse
    record: StudyRecord

    def draw(self) -> list[Path]:
        """Write every figure in the formats of the case; returns the files. Raises InputError."""
        formats = self.case.output.figure_formats
        if not formats:
            return []
        from stickslip.report.figures import save_all

        self.folder.mkdir(parents=True, exist_ok=True)
        return [*save_all(self.folder, self.response, self.record, formats), *self._rough_face()]

    def _rough_face(self) -> Iterator[Path]:
        """A picture of one rough face: heights from the roughness, its ridges and its seed, over the contact face."""
        if self.case.roughness is None:
            return
        from stickslip.report.figures import save, surface

        given, geometry = self.case.roughness, self.case.geometry
        n_max = frequency_count(given.sample_length, given.shortest_length)
        along = np.linspace(0.0, geometry.damper_length, 420)
        across = np.linspace(0.0, geometry.contact_face_width, 98)
        x, y = np.meshgrid(along, across)
        phases = draw_phases(given.seed, given.ridges, n_max)
        heights = fractal_surface(
            x, y, given.fractal_dimension, given.fractal_roughness, given.sample_length, given.ridges, phases
        )
        figure = surface(x, y, heights)
        for ending in self.case.output.figure_formats:
            yield save(figure, self.folder / f"rough_face.{ending}")


class SecondProcess:
    """A process that waits for one :class:`Drawing`; leaving the ``with`` block ends it."""

    def __enter__(self) -> SecondProcess:
        self._process = subprocess.Popen(
            [sys.executable, "-c", "from stickslip.drawing import serve; serve()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        return self

    def start(self, drawing: Drawing) -> None:
        """Hand over what is to be drawn, and go on."""
        stream = cast(IO[bytes], self._process.stdin)
        try:
            pickle.dump(drawing, stream)
            stream.close()
        except BrokenPipeError:
            return  # it died; files() says so

    def files(self) -> list[Path]:
        """Wait for the figures; returns the files. Raises what the drawing raised, RuntimeError if the process died."""
        answer = cast(IO[bytes], self._process.stdout).read()
        code = self._process.wait()
        if not answer:
            raise RuntimeError(f"the process that draws the figures ended with code {code} and no answer.")
        outcome = pickle.loads(answer)
        if isinstance(outcome, StickslipError):
            raise outcome
        if isinstance(outcome, str):
            raise RuntimeError(f"the figures could not be drawn:\n{outcome}")
        return cast("list[Path]", outcome)

    def __exit__(self, *details: object) -> None:
        self._process.kill()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
        self._process.wait()


def serve() -> None:
    """What the second process does: import, read one drawing, draw it, answer."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process decides what an interrupt means
    import stickslip.report.figures  # noqa: F401  the slow import, beside the solver

    try:
        drawing = pickle.load(sys.stdin.buffer)
    except EOFError:
        return  # the study ended without a response
    answer: Any
    try:
        answer = drawing.draw()
    except StickslipError as error:
        answer = error
    except Exception:
        answer = traceback.format_exc()
    pickle.dump(answer, sys.stdout.buffer)
    sys.stdout.buffer.flush()
