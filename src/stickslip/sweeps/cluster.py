"""A Dask cluster as an executor: the only module that knows ``distributed``, from the extra ``[cluster]``."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from stickslip.errors import InputError, MissingPackageError

CONNECT_SECONDS = 20
# Each task carries the matrices of its structure (some 10 MB), about which the client would warn.
_CONFIG = {"distributed.admin.large-graph-warning-threshold": "1GB"}


@contextmanager
def cluster_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Executor of the cluster whose scheduler has this address ("tcp://host:8786"), and its number of worker threads.

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
            yield client.get_executor(), sum(client.nthreads().values())
