"""Clients of a Dask scheduler: one that runs somewhere, or one of its own in this process.

What workers run is sent by value, and looks first at what `inertia` they have: a function that is sent by its name ends
a worker without it, and is another one where the version is another.
"""

from __future__ import annotations

import pickle
import time
import warnings
from asyncio import CancelledError
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, TypeVar

from inertia import __version__
from inertia.errors import InertiaError, UsageError, WaitingWarning, visible
from inertia.output import temporary_folder

T = TypeVar("T")

_PATIENCE = "10 s"  # for the scheduler to answer
SOON, LONG = 5.0, 60.0
"""s without any worker, after which that is said, and after which nobody waits any more."""

LOOK, _STEP = 1.0, 0.01  # s between looks at the workers, and at what is done
_SILENT = 50  # the level of records that are written: whatever a connection comes to is said in a sentence
_GONE = "the Dask scheduler does not answer any more: start it again, and run again"


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
        from distributed.utils import silence_logging_cmgr
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
        stack.enter_context(silence_logging_cmgr(_SILENT))
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
                    silence_logs=_SILENT,
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


def sent(function: Callable[..., T], *arguments: object) -> Callable[..., T]:
    """Return a function of more arguments that calls one of `inertia` on a worker, if that has the same version."""
    version, packed = __version__, pickle.dumps((function, arguments))

    def call(*more: Any) -> Any:
        import pickle

        says = ""
        try:
            import inertia

            if inertia.__version__ != version:
                says = f"has version {inertia.__version__} of inertia, and this is {version}"
        except ImportError as error:
            says = f"cannot import inertia ({error})"
        if says:
            from distributed import get_worker

            where = f"the Dask worker at {get_worker().address}"
            raise ImportError(f"{where} {says}: install version {version} for it", name="inertia")
        function, arguments = pickle.loads(packed)
        return function(*arguments, *more)

    return call


def finished(done: Any, client: Any) -> list[tuple[Any, Any]]:
    """Wait for futures, and return those that finished or failed, with their results; what gets lost is made anew.

    Parameters
    ----------
    done : what they come from (`distributed.as_completed`), with results and without raising errors

    Raises `InertiaError` where the scheduler has gone, has no worker for long, or one that is not to be used.
    """
    last = looked = time.monotonic()  # when there was a worker, and when that was looked at
    said = False
    while True:
        ready = []
        for future, result in done.next_batch(block=False):
            if future.status in ("lost", "pending"):  # its worker ended with the result
                done.add(future)
            elif future.status == "error" and isinstance(error := future.exception(), InertiaError | ImportError):
                raise fault(error)
            elif future.status not in ("finished", "error") or (future.status == "error" and error is None):
                raise _gone()
            else:
                ready.append((future, result))
        if ready:
            return ready
        time.sleep(_STEP)
        if (now := time.monotonic()) - looked < LOOK:
            continue
        looked = now
        if threads(client):
            last = now
        elif now - last > LONG:
            says = f"the Dask scheduler has had no worker for {LONG:g} s: start workers, and run again"
            raise InertiaError(says, code="workers")
        elif now - last > SOON and not said:
            said = True
            warnings.warn("the Dask scheduler has no worker: waiting for one", WaitingWarning, stacklevel=2)


def threads(client: Any) -> int:
    """Return how many threads the workers have; raises `InertiaError` where the scheduler has gone."""
    try:
        return sum(client.nthreads().values())
    except (Exception, CancelledError):  # of whatever the connection is
        raise _gone() from None


def fault(error: Any) -> InertiaError:
    """Return what is said of an error that a worker had."""
    if isinstance(error, InertiaError):
        return error
    if isinstance(error, ImportError) and error.name == "inertia":
        return InertiaError(str(error), code="workers")
    return InertiaError(
        f"the Dask workers failed ({visible(type(error).__name__)}: {visible(str(error))}): look at their logs, and "
        "whether they have memory enough",
        code="workers",
    )


def _gone() -> InertiaError:
    return InertiaError(_GONE, code="workers")
