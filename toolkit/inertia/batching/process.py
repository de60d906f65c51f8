"""The worker process: it answers for bundles of files, one after the other, until nobody asks any more."""

from __future__ import annotations

import os
import pickle
import re
import signal
import sys
from contextlib import suppress
from pathlib import Path

from inertia.batching.answer import Setup, answer
from inertia.batching.sources import Task

READY = "ready"

_MMAP_THRESHOLD, _OWN_MAPPING = -3, 2**20
"""M_MMAP_THRESHOLD of malloc.h, and the bytes from which a block is a mapping of its own."""


def main() -> None:
    """Read a `Setup` and then lists of `Task` from standard input; write `READY` and an `Answer` for each task."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that started this one
    requests, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # libraries may print
    setup: Setup = pickle.load(requests)
    _warm_up(setup)
    if setup.memory is not None:
        limit_memory(setup.memory)
    pickle.dump(READY, answers)
    answers.flush()
    while True:
        try:
            bundle: list[Task] = pickle.load(requests)
        except EOFError:
            return
        for task in bundle:
            pickle.dump(answer(task, setup), answers)
            answers.flush()


def _warm_up(setup: Setup) -> None:
    """Import what the verb takes, and load the kernels that are compiled already: many small files repay that."""
    if setup.verb not in ("analyse", "check"):
        return
    import inertia.mass.analyse
    import inertia.mesh.check
    import inertia.mesh.read  # noqa: F401
    from inertia.mass.triangles.sums import KERNEL
    from inertia.mesh.geometry.corner_keys import FACES, FACETS, KEYS
    from inertia.mesh.geometry.intersect import CODES, COMPILED, ENCLOSE
    from inertia.mesh.geometry.pairing import CLOSE, ROWS
    from inertia.mesh.geometry.waiting_edges import EDGES, REPEATED
    from inertia.native import LOAD_ABOVE

    pairing = (FACETS, FACES, KEYS, ROWS, CLOSE, EDGES, REPEATED)
    for kernel in (KERNEL.facets, KERNEL.faces, *pairing, CODES, ENCLOSE, COMPILED):
        if kernel.worthwhile(LOAD_ABOVE):
            kernel.function  # noqa: B018  # it is loaded by being asked for
    if setup.memory is not None:
        _import_for_refusals()


def _import_for_refusals() -> None:
    """Import what a refusal takes, 100 MB that would count for the file, and for all that follow it."""
    from inertia.errors import GeometryError
    from inertia.mass.analyse import analyse
    from inertia.mesh.part import Part

    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    with suppress(GeometryError):
        analyse(Part.from_arrays(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3]]))


def limit_memory(extra: int) -> None:
    """Let this process take no more than `extra` bytes beside what it takes now (Linux).

    What a file has taken is given back when it is freed, so that the next one may take as much.
    """
    import ctypes
    import resource

    with suppress(AttributeError):  # glibc alone raises the size from which blocks are mappings of their own
        ctypes.CDLL(None).mallopt(_MMAP_THRESHOLD, _OWN_MAPPING)
    data = re.search(r"VmData:\s*(\d+) kB", Path("/proc/self/status").read_text())
    assert data is not None
    most = resource.getrlimit(resource.RLIMIT_DATA)[1]  # nobody but root may go beyond it
    limit = min(1024 * int(data[1]) + extra, sys.maxsize if most == resource.RLIM_INFINITY else most)
    resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
