"""Errors of the command line: one message and an exit code, a traceback only with --debug."""

from __future__ import annotations

import errno
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated

import typer

from stickslip.cli.process import StoppedBySignal, plain_warnings, stopping_signals
from stickslip.core.errors import InputError, StickslipError
from stickslip.core.input_files import shortened
from stickslip.core.terminal import echo
from stickslip.core.thread_variables import require_thread_variables

EXIT_FAULT = 1  # a defect of the program
EXIT_INTERRUPTED = 130  # 128 + 2, as shells report Ctrl-C
LOG_NAME = "stickslip-error.log"
# Errors of the system that a wrong path or its permissions cause, not the program or a full disk.
_PATH_ERRORS = {errno.ENAMETOOLONG, errno.EACCES, errno.EPERM, errno.ELOOP, errno.ENOTDIR, errno.EISDIR, errno.EROFS}
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


@contextmanager
def error_messages(debug: bool, log_folder: Path | None = None, closing: str = "") -> Iterator[None]:
    """Turn any error into a message on stderr and an exit code; tracebacks go to a log or to --debug.

    ``closing`` is the note on the results of an interrupted or stopped command.
    """
    try:
        with stopping_signals(), plain_warnings():
            require_thread_variables()
            yield
    except (typer.Exit, typer.Abort):
        raise
    except StickslipError as error:
        _show_traceback(debug)
        echo(f"Error: {error}", err=True)
        raise typer.Exit(error.exit_code) from error
    except StoppedBySignal as error:
        with suppress(OSError):  # a lost terminal shows no message
            _show_traceback(debug)
            echo(f"Stopped by {error}; the study is not complete. {closing}".rstrip(), err=True)
        raise typer.Exit(128 + error.number) from error
    except KeyboardInterrupt as error:
        _show_traceback(debug)
        echo(f"Interrupted; the study is not complete. {closing}".rstrip(), err=True)
        raise typer.Exit(EXIT_INTERRUPTED) from error
    except MemoryError as error:
        _show_traceback(debug)
        echo(
            "Error: the memory is too small. Use fewer elements, harmonics or samples, or a machine with more memory.",
            err=True,
        )
        raise typer.Exit(InputError.exit_code) from error
    except Exception as error:
        _show_traceback(debug)
        if isinstance(error, OSError) and error.errno in _PATH_ERRORS and error.filename is not None:
            name = shortened(str(error.filename))
            echo(f'Error: "{name}" cannot be used: {error.strerror}. Check this path and its permissions.', err=True)
            raise typer.Exit(InputError.exit_code) from error
        where = "Run it again with --debug to see the traceback" if log_folder is None else _write_log(log_folder)
        if isinstance(error, OSError):
            echo(f"Error: a file could not be read or written: {error}. {where}.", err=True)
            raise typer.Exit(EXIT_FAULT) from error
        echo(
            f"Defect of stickslip ({type(error).__name__}: {error}), not of your input. {where}, "
            "and please report the defect to the developers together with the study file.",
            err=True,
        )
        raise typer.Exit(EXIT_FAULT) from error


def _show_traceback(debug: bool) -> None:
    if debug:
        echo(traceback.format_exc(), err=True)


def _write_log(folder: Path) -> str:
    """Write the traceback of the current exception into ``folder``; returns the start of a sentence with its path."""
    log = folder / LOG_NAME
    try:
        log.write_text(traceback.format_exc(), encoding="utf-8")
    except OSError:
        return "Run it again with --debug to see the traceback"
    return f"The traceback is in {log}"
