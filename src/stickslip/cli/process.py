"""The command line as a process: signals that stop it, output that nobody reads any more, and its warnings."""

from __future__ import annotations

import io
import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TextIO

from stickslip.core.errors import show_warnings_as_lines

# Ctrl-C (SIGINT) is Python's own KeyboardInterrupt. Windows has no SIGHUP.
STOPPING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))


class StoppedBySignal(KeyboardInterrupt):
    """Another process, or the loss of the terminal, stops this one; the clean-up is that after Ctrl-C."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(signal.Signals(number).name)


@contextmanager
def stopping_signals() -> Iterator[None]:
    """Raise StoppedBySignal in the block for SIGTERM and SIGHUP, so that files and other processes are cleaned up.

    A second one is ignored, because the process is ending. A signal that is already ignored stays so (nohup).
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread receives signals
        return
    before = {number: signal.getsignal(number) for number in STOPPING}
    watched = [number for number, answer in before.items() if answer is signal.SIG_DFL]

    def stop(number: int, _: FrameType | None) -> None:
        for each in watched:
            signal.signal(each, signal.SIG_IGN)
        raise StoppedBySignal(number)

    for number in watched:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number in watched:
            signal.signal(number, before[number])


@contextmanager
def plain_warnings() -> Iterator[None]:
    """Show the warnings of stickslip as one line of stderr without file and line of the code; others as usual."""
    with warnings.catch_warnings():
        show_warnings_as_lines()
        yield


class TolerantOutput(io.TextIOWrapper):
    """Output to a reader that may close its end ("| head"): further output is dropped, and the command continues."""

    def write(self, text: str, /) -> int:
        """Write, or drop it."""
        try:
            return super().write(text)
        except BrokenPipeError:
            self._drop()
            return len(text)

    def flush(self) -> None:
        """Flush, or drop the buffer."""
        try:
            super().flush()
        except BrokenPipeError:
            self._drop()

    def _drop(self) -> None:
        """Redirect further output, including the buffer, to the null device."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        os.close(nowhere)


def tolerate_closed_output() -> None:
    """Keep the command running if the reader of stdout or stderr is gone."""
    sys.stdout, sys.stderr = _tolerant(sys.stdout), _tolerant(sys.stderr)


def _tolerant(stream: TextIO) -> TextIO:
    if not isinstance(stream, io.TextIOWrapper):
        return stream  # none at all, or not that of a process
    return TolerantOutput(
        stream.buffer,
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )
