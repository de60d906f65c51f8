"""Keys of the corners of triangles, block by block, and the threads that ask for them; see `closure`."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.mesh.surface import Facets, Surface, Triangles
from inertia.native import Kernel, address

_MODULE = "inertia.mesh.geometry.edge_kernel"
FACETS = Kernel(_MODULE, "key_facets", "pipp")
FACES = Kernel(_MODULE, "key_faces", "pipip")
KEYS = Kernel(_MODULE, "key_vertices", "pipp")

BLOCK = 8192
"""Triangles whose corners' keys are computed at a time."""

Keys = Callable[[int, int, NDArray[np.uint64]], None]
"""Writes the keys of the corners of triangles `start:stop`."""


def corner_keys(triangles: Triangles, salt: NDArray[np.uint64]) -> Keys:
    """Return what writes the keys of corners, by random numbers (15,)."""
    if isinstance(triangles, Facets):
        facets, key_facets = triangles, FACETS.function

        def of_facets(start: int, stop: int, rows: NDArray[np.uint64]) -> None:
            records = facets.block(start, stop)
            key_facets(records.ctypes.data, stop - start, address(salt), address(rows))

        return of_facets
    surface, key_faces, of = triangles, FACES.function, vertex_keys(triangles, salt)

    def of_faces(start: int, stop: int, rows: NDArray[np.uint64]) -> None:
        faces = surface.block(start, stop)
        key_faces(faces.ctypes.data, len(faces), of.ctypes.data, len(of), address(rows))

    return of_faces


def vertex_keys(surface: Surface, salt: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return the keys of vertices (n,), by random numbers (15,)."""
    of = np.empty(len(surface.vertices), np.uint64)
    KEYS.function(surface.vertices.ctypes.data, len(of), address(salt), of.ctypes.data)
    return of


def shares_of(count: int, parts: int) -> list[int]:
    """Return where the shares of threads in `count` triangles begin, at blocks, and where the last ends."""
    return [*(BLOCK * (part * count // (parts * BLOCK)) for part in range(parts)), count]


def load(*kernels: Kernel) -> None:
    """Load kernels here, before threads ask for them."""
    for kernel in kernels:
        kernel.function  # noqa: B018


def in_threads(number: int, work: Callable[[int, threading.Event], Any]) -> list[Any]:
    """Return what `work` returns for 0, 1, … `number` − 1, each in a thread; of what they raise, the first."""
    results: list[Any] = [None] * number
    errors: list[BaseException | None] = [None] * number
    stopped = threading.Event()

    def one(which: int) -> None:
        try:
            results[which] = work(which, stopped)
        except BaseException as error:  # it is raised again where the others have ended
            errors[which] = error
            stopped.set()

    others = [threading.Thread(target=one, args=(which,)) for which in range(1, number)]
    for thread in others:
        thread.start()
    one(0)
    for thread in others:
        thread.join()
    try:
        for error in errors:
            if error is not None:
                raise error
    finally:
        errors.clear()  # which refer to what the threads have had in memory
        error = None
    return results
