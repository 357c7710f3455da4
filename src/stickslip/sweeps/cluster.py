"""A Dask cluster as an executor: the only module that knows ``distributed``, from the extra ``[cluster]``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

from stickslip.core.errors import InputError, MissingPackageError
from stickslip.sweeps.pool import SizedExecutor

P = ParamSpec("P")
T = TypeVar("T")

CONNECT_SECONDS = 20
# Each task carries the matrices of its structure (some 10 MB), about which the client would warn.
_CONFIG = {"distributed.admin.large-graph-warning-threshold": "1GB"}


class ClusterExecutor(SizedExecutor):
    """Hands tasks to a Dask client; workers may come and go meanwhile."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._executor = client.get_executor()

    @property
    def tasks_at_a_time(self) -> int:
        """One for each thread of the workers that are there now, and one that waits for it."""
        threads: dict[str, int] = self._client.nthreads()
        return max(2, 2 * sum(threads.values()))

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Hand a task to the cluster."""
        future: Future[T] = self._executor.submit(fn, *args, **kwargs)
        return future


@contextmanager
def cluster_executor(address: str) -> Iterator[ClusterExecutor]:
    """Executor of the cluster whose scheduler has this address, for example "tcp://host:8786".

    Raises MissingPackageError without the extra, InputError if no scheduler or no worker answers.
    """
    try:
        import dask
        from distributed import Client
    except ImportError as error:
        raise MissingPackageError(
            'a Dask cluster needs the package distributed. Install it: pip install "stickslip[cluster]".'
        ) from error
    with dask.config.set(_CONFIG):
        try:
            client = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InputError(
                f'no Dask scheduler answers at "{address}" ({error}). Give the address that "dask scheduler" prints, '
                "for example tcp://host:8786."
            ) from error
        with client:
            try:
                client.wait_for_workers(1, timeout=CONNECT_SECONDS)
            except TimeoutError as error:
                raise InputError(
                    f'the Dask scheduler at "{address}" has no worker. Start some with "dask worker {address}".'
                ) from error
            yield ClusterExecutor(client)
