"""Simplifying a closed surface, with manifold3d: half the triangles, a quarter, an eighth, and so on.

Each mesh is made from the one before: collapsing few edges at a time keeps the triangles better shaped than collapsing
most of them at once, and costs less. The tolerance is searched, as the number of triangles does not say how far they
may move; where many triangles are flat, the smallest tolerance may leave far fewer than asked for.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from inertia.errors import CHECK
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners
from inertia.mesh.manifold import exponent_of, solid
from inertia.mesh.repairs.weld import compact, diagonal
from inertia.mesh.surface import Surface, Triangles
from inertia.records import dataclass

FEWEST = 4
"""Triangles that bound a volume."""

_LEAST, _MOST = -40.0, -2.0  # binary logarithm of the tolerances tried, over the diagonal of the part's box
_TRIES = 16
_NEAR, _CLOSE = 0.05, 0.05  # relative distance from the triangles asked for, and width of the bracket, that will do


@dataclass(frozen=True, eq=False)
class Simplified:
    """A surface with fewer triangles.

    Attributes
    ----------
    surface : its vertices are some of those of the original
    share : the power of two that is nearest to how many times fewer triangles it has
    tolerance : what manifold3d was given, in file units, added up over the surfaces that it was made from; where it
        is small beside the features of the part, the surface has moved by less
    """

    surface: Surface
    share: int
    tolerance: float


def halvings(triangles: Triangles) -> Iterator[Simplified]:
    """Yield a closed surface with about 1/2, 1/4, 1/8, ... of its triangles, until no tolerance leaves a solid.

    Raises
    ------
    GeometryError : manifold3d does not take the surface, because it is open, for instance

    >>> octahedron = Surface([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
    ...                      [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    >>> [half.surface.count for half in halvings(octahedron)]
    []
    """
    vertices, faces = merge_equal_vertices(triangles)
    vertices, faces = compact(vertices, faces[~repeated_corners(faces)])
    if not len(faces):
        return
    exponent = exponent_of(vertices)
    fault, advice = "manifold3d cannot simplify the surface", ("run ", CHECK, " to see what is wrong")
    body = solid(vertices, faces, exponent, fault, advice)
    size = diagonal(np.ldexp(vertices, -exponent))
    # Over n triangles of a smooth surface the edges are about 1/√n and the arcs about 1/n of its size high.
    halved, power, tolerance = 0, 3.0 - math.log2(len(faces)), 0.0
    while simplified := _search(body, size, power + 1.0, len(faces) / 2 ** (halved + 1)):
        body, power = simplified
        mesh = body.to_mesh64()
        halved = round(math.log2(len(faces) / len(mesh.tri_verts)))
        tolerance += math.ldexp(size * 2.0**power, exponent)
        surface = Surface(np.ldexp(mesh.vert_properties[:, :3], exponent), mesh.tri_verts)
        yield Simplified(surface, 2**halved, tolerance)


def _search(body: Any, size: float, guess: float, target: float) -> tuple[Any, float] | None:
    """Return the simplified solid nearest to `target` triangles and the binary logarithm of its tolerance.

    From `guess` the logarithm goes by doubled steps until one leaves more triangles than `target` and one fewer; what
    lies between is bisected. None where every solid met is nearer to twice the triangles, or bounds nothing.
    """
    best, nearest = None, math.inf
    low, high, step = _LEAST, _MOST, 1.0
    power = min(max(guess, low), high)
    for _ in range(_TRIES):
        simpler = body.simplify(size * 2.0**power)
        count = int(simpler.num_tri())
        distance = abs(math.log(max(count, 1) / target))
        if FEWEST <= count < math.sqrt(2) * target and distance < nearest:
            best, nearest = (simpler, power), distance
        if count > target:
            low = power
        else:
            high = power
        if nearest <= _NEAR or high - low <= _CLOSE:
            break
        if high == _MOST:
            power = min(low + step, _MOST)
        elif low == _LEAST:
            power = max(high - step, _LEAST)
        else:
            power = 0.5 * (low + high)
        step *= 2
    return best
