"""Clients of a Dask scheduler: one that runs somewhere, or one of its own in this process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from inertia.errors import UsageError, visible
from inertia.output import temporary_folder

_PATIENCE = "10 s"  # for the scheduler to answer


@contextmanager
def connected(address: str, threads: int) -> Iterator[Any]:
    """Yield a `distributed.Client`.

    Parameters
    ----------
    address : of the scheduler, "local" for one in this process
    threads : of that one

    Raises `UsageError` where Dask is not installed, the address is none, or no scheduler answers.
    """
    try:
        import dask
        import distributed
        from distributed.comm import get_address_host
    except ImportError:
        raise UsageError("Dask is not installed: run pip install 'inertia[dask]'", code="needs_package") from None

    class Client(distributed.Client):  # type: ignore[misc]
        """One that is closed where it is only half made: collected as it is, it waits for long and prints its fault."""

        def __init__(self, *arguments: Any, **options: Any) -> None:
            try:
                super().__init__(*arguments, **options)
            except BaseException:
                self.close()
                raise

    with ExitStack() as stack:
        scheduler: Any = address
        if address == "local":
            folder = str(stack.enter_context(temporary_folder()))
            settings = {"distributed.worker.profile.enabled": False, "temporary-directory": folder}
            stack.enter_context(dask.config.set(settings))
            scheduler = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=1,
                    threads_per_worker=threads,
                    processes=False,
                    dashboard_address="127.0.0.1:0",
                    silence_logs=50,
                )
            )
        else:
            try:
                get_address_host(address)  # it asks for a known scheme and a port
            except (TypeError, ValueError) as error:
                shown = visible(str(address)) or "''"
                says = f"{shown} is no address of a Dask scheduler ({error}): give one as tcp://host:8786"
                raise UsageError(says) from None
        try:
            client = Client(scheduler, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise UsageError(f"no Dask scheduler answers at {visible(address)}: {error}") from None
        yield stack.enter_context(client)
