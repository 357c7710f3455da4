"""A Dask cluster as an executor: the only module that imports ``distributed``, from the extra ``[cluster]``."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Future
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

from stickslip.core.errors import InputError, MissingPackageError, WorkersError
from stickslip.core.progress import Progress, SilentProgress
from stickslip.sweeps.pool import SizedExecutor
from stickslip.sweeps.work import open_parcel, parcel, worker_version

P = ParamSpec("P")
T = TypeVar("T")

CONNECT_SECONDS = 20  # chosen: a scheduler that does not answer by then is reported as missing
# chosen: a scheduler answers in milliseconds, but may need seconds while it receives the matrices of many tasks.
ANSWER_SECONDS = 60
# Workers of a batch system may all end at once and be replaced minutes later.
WITHOUT_WORKER_SECONDS = 600
# Each task contains the matrices of its structure (about 10 MB), about which the client would warn.
_CONFIG = {"distributed.admin.large-graph-warning-threshold": "1GB"}


class ClusterExecutor(SizedExecutor):
    """Submits tasks to a Dask client; workers may start and stop meanwhile."""

    def __init__(self, client: Any, address: str) -> None:
        self._client, self._address = client, address
        # not pure: a repeated task must not receive the cached result of the scheduler
        self._executor = client.get_executor(pure=False)
        self._last_worker = time.monotonic()

    @property
    def tasks_at_a_time(self) -> int:
        """One for each thread of the present workers, and one in reserve."""
        return max(2, 2 * self._threads())

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Submit a task to the cluster. Raises WorkersError if the scheduler does not answer."""
        self._require_connection()
        future: Future[T] = self._executor.submit(fn, *args, **kwargs)
        return future

    def waiting_for(self) -> str:
        """The time without a worker. Raises WorkersError if it is too long, or the scheduler does not answer."""
        if self._threads():
            return ""
        waited = time.monotonic() - self._last_worker
        if waited >= WITHOUT_WORKER_SECONDS:
            raise WorkersError(
                f'the Dask scheduler at "{self._address}" has had no worker for {waited:.0f} s. Check why its workers '
                f'stopped (too little memory, or the time limit of a job), and start some with "dask worker '
                f'{self._address}".'
            )
        return f"no worker is available; waiting for {waited:.0f} s (at most {WITHOUT_WORKER_SECONDS:.0f} s)"

    def meaning(self, error: BaseException) -> BaseException:
        """The client cancels submitted tasks when it loses its scheduler, and gives up a task that killed its
        workers."""
        from distributed.scheduler import KilledWorker

        if isinstance(error, CancelledError):
            return self._connection_error()
        return BrokenExecutor(str(error)) if isinstance(error, KilledWorker) else error

    def _threads(self) -> int:
        """Threads of the present workers. Raises WorkersError if the scheduler does not answer."""
        self._require_connection()
        try:
            threads: dict[str, int] = self._client.nthreads(callback_timeout=ANSWER_SECONDS)
        except Exception as error:  # a closing client raises many kinds of errors
            raise self._connection_error() from error
        if threads:
            self._last_worker = time.monotonic()
        return sum(threads.values())

    def _require_connection(self) -> None:
        if self._client.status != "running":
            raise self._connection_error()

    def _connection_error(self) -> WorkersError:
        return WorkersError(
            f'the Dask scheduler at "{self._address}" no longer responds: it stopped, or the network failed.'
        )


@contextmanager
def cluster_executor(address: str, progress: Progress | None = None) -> Iterator[ClusterExecutor]:
    """Executor of the cluster whose scheduler has this address, for example "tcp://host:8786" or "tls://host:8786".

    Certificates for "tls://" are those of Dask's own configuration (``distributed.comm.tls``). Raises
    MissingPackageError without the extra, InputError if no scheduler or no worker answers, and WorkersError if a worker
    does not run this version and code of stickslip.
    """
    try:
        import dask
        from distributed import Client
    except ImportError as error:
        raise MissingPackageError(
            'a Dask cluster requires the package distributed. Install it: pip install "stickslip[cluster]".'
        ) from error
    progress = progress or SilentProgress()
    with dask.config.set(_CONFIG):
        progress.update("Cluster", 0.0, f"connecting to {address}")
        _require_answer(address)
        with _without_log(), Client(address, timeout=CONNECT_SECONDS, set_as_default=False) as client:
            workers = _workers_of_this_version(client, address, progress)
            _require_passage(client, address)
            progress.update("Cluster", 1.0, f"{workers} workers with the same version")
            yield ClusterExecutor(client, address)


@contextmanager
def _without_log() -> Iterator[None]:
    """Keep the client from writing tracebacks to stderr when it loses its scheduler: a WorkersError reports it."""
    loggers = [logging.getLogger(f"distributed.{name}") for name in ("client", "batched")]  # the second one sends
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)


def _require_answer(address: str) -> None:
    """Raise InputError unless a scheduler answers; a client that cannot connect would hang and print a traceback."""
    from distributed import Security
    from distributed.comm import connect
    from distributed.utils import LoopRunner

    async def ask() -> None:
        comm = await connect(address, timeout=CONNECT_SECONDS, **Security().get_connection_args("client"))
        await comm.close()

    runner = LoopRunner()
    runner.start()
    try:
        runner.run_sync(ask)
    # address without port or of an unknown kind, name or port without answer, missing or wrong certificates
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise InputError(
            f'no Dask scheduler responds at "{address}" ({error}). Give the address that "dask scheduler" prints, for '
            "example tcp://host:8786. An address tls://host:8786 requires certificates in Dask's configuration "
            "(distributed.comm.tls)."
        ) from error
    finally:
        runner.stop()


def _workers_of_this_version(client: Any, address: str, progress: Progress) -> int:
    """The number of present workers, all of this version. Raises InputError if none answers, WorkersError."""
    deadline = time.monotonic() + CONNECT_SECONDS
    while (left := deadline - time.monotonic()) > 0.0:
        progress.update("Cluster", 0.0, f"waiting for a worker, at most {left:.0f} s")
        try:
            client.wait_for_workers(1, timeout=left)
            answers = client.run(worker_version, on_error="return", callback_timeout=ANSWER_SECONDS)
        except (OSError, TimeoutError):
            break
        _require_this_version(answers)
        count = sum(isinstance(answer, str) for answer in answers.values())
        if count:
            return count
        time.sleep(0.2)  # until the scheduler has removed dead workers
    raise _no_worker(address)


def _require_passage(client: Any, address: str) -> None:
    """Raise WorkersError unless a task comes through, which the scheduler reads too, InputError without an answer."""
    try:
        client.submit(open_parcel, parcel(worker_version), pure=False).result(timeout=ANSWER_SECONDS)
    except WorkersError:
        raise
    except (OSError, TimeoutError) as error:
        raise _no_worker(address) from error
    except Exception as error:  # another version may raise any error
        raise WorkersError(
            f'the Dask scheduler at "{address}" or its worker cannot read a task of stickslip ({type(error).__name__}: '
            f"{' '.join(str(error).split())}). Install stickslip {worker_version()} for the scheduler and the "
            "workers."
        ) from error


def _no_worker(address: str) -> InputError:
    return InputError(
        f'the Dask scheduler at "{address}" has no worker that responds. Start some with "dask worker {address}", and '
        "check their log if they stop at once."
    )


def _require_this_version(answers: dict[str, Any]) -> None:
    """Raise WorkersError unless every worker, named by its address, answers with this version or died meanwhile."""
    wrong = []
    for worker, answer in answers.items():
        if isinstance(answer, OSError) and answer.errno is None:  # of Dask: the worker died during the call
            continue
        if isinstance(answer, Exception):
            wrong.append(f"{worker} cannot run stickslip ({type(answer).__name__}: {answer})")
        elif answer != worker_version():
            wrong.append(f"{worker} runs stickslip {answer}")
    if wrong:
        raise WorkersError(
            f"the sweep runs stickslip {worker_version()}, but of its Dask workers {'; '.join(wrong)}. Install the "
            "same version there, or stop these workers."
        )
