"""Clients of a Dask scheduler: one that runs somewhere, or one of its own in this process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from inertia.errors import UsageError, visible

_PATIENCE = "10 s"  # for the scheduler to answer


@contextmanager
def connected(address: str, threads: int) -> Iterator[Any]:
    """Yield a `distributed.Client`.

    Parameters
    ----------
    address : of the scheduler, "local" for one in this process
    threads : of that one

    Raises `UsageError` where Dask is not installed, or no scheduler answers.
    """
    try:
        import dask
        import distributed
    except ImportError:
        raise UsageError("Dask is not installed: run pip install 'inertia[dask]'", code="needs_package") from None
    with ExitStack() as stack:
        scheduler: Any = address
        if address == "local":
            stack.enter_context(dask.config.set({"distributed.worker.profile.enabled": False}))
            scheduler = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=1,
                    threads_per_worker=threads,
                    processes=False,
                    dashboard_address="127.0.0.1:0",
                    silence_logs=50,
                )
            )
        try:
            client = distributed.Client(scheduler, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise UsageError(f"no Dask scheduler answers at {visible(address)}: {error}") from None
        yield stack.enter_context(client)
