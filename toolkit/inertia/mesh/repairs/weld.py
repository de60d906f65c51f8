"""Welding within a tolerance: vertices that lie close together become one.

Closeness chains: where a is close to b and b to c, all three become one vertex, however far c is from a. The
largest move says how far it went.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import GeometryError, UsageError
from inertia.mesh.geometry.closure import components, merge_equal_vertices, repeated_corners
from inertia.mesh.part import Surface, Triangles, first_non_finite

_LARGEST = 0.1  # tolerance, over the diagonal of the part's box
_PAIRS = 50_000_000  # close vertices found at most: one gigabyte


@dataclass(frozen=True, eq=False)
class WeldResult:
    """A surface after welding.

    Attributes
    ----------
    surface : the triangles that remain
    merged : vertices that became another one
    largest_move : the longest way that one of them went, in file units
    collapsed : triangles dropped because two of their corners became one
    remaining : (m,), numbers of the triangles that remain
    """

    surface: Surface
    merged: int
    largest_move: float
    collapsed: int
    remaining: Int


def weld_within(surface: Triangles, tolerance: float) -> WeldResult:
    """Merge the vertices that lie within `tolerance` (file units) of each other into the first of them.

    Raises
    ------
    UsageError : the tolerance is not above 0, exceeds a tenth of the diagonal of the part's box, or is so far
        above the distance of the vertices that millions of pairs are close
    GeometryError : a coordinate is not finite

    >>> sliver = Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1e-9, 0], [1, 1, 0]], [[0, 1, 2], [3, 4, 2]])
    >>> welded = weld_within(sliver, 1e-6)
    >>> welded.merged, welded.largest_move, welded.surface.faces.tolist()
    (1, 1e-09, [[0, 1, 2], [1, 3, 2]])
    """
    require_finite(surface)
    vertices, faces = merge_equal_vertices(surface)
    into = close_vertices(vertices, tolerance)
    moves = np.linalg.norm(vertices - vertices[into], axis=1)
    faces = into[faces]
    remaining = np.flatnonzero(~repeated_corners(faces))
    return WeldResult(
        surface=Surface(*compact(vertices, faces[remaining])),
        merged=int((into != np.arange(len(into))).sum()),
        largest_move=float(moves.max(initial=0.0)),
        collapsed=len(faces) - len(remaining),
        remaining=remaining,
    )


def close_vertices(vertices: Float, tolerance: float) -> Int:
    """Return for each vertex (n, 3) the first of those that become one with it; see `weld_within`."""
    limit = _LARGEST * diagonal(vertices)
    if not 0 < tolerance <= limit:
        raise UsageError(
            f"the weld tolerance {tolerance:g} must be above 0 and at most a tenth of the diagonal of the "
            f"part's box, {limit:.4g} in file units: give another one"
        )
    return clusters(vertices, tolerance)


def clusters(points: Float, tolerance: float) -> Int:
    """Return for each point (n, 3) the first of those that steps of at most `tolerance` connect it with."""
    from scipy.spatial import cKDTree

    tree = cKDTree(points)
    pairs = (tree.count_neighbors(tree, tolerance) - len(points)) // 2
    if pairs > _PAIRS:
        raise UsageError(
            f"{pairs} pairs of vertices lie within the weld tolerance {tolerance:g}, more than the limit of "
            f"{_PAIRS}: give a smaller one"
        )
    return components(tree.query_pairs(tolerance, output_type="ndarray"), len(points))


def require_finite(triangles: Triangles) -> None:
    """Raise `GeometryError` where a coordinate is NaN or infinite."""
    where = first_non_finite(triangles)
    if where is not None:
        raise GeometryError(
            f"triangle {where[0]} has at corner {where[1]} a coordinate that is not finite: export it again"
        )


def diagonal(vertices: Float) -> float:
    """Return the diagonal of the box around vertices (n, 3); 0 where there are none."""
    return float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 0.0


def compact(vertices: Float, faces: Int) -> tuple[Float, Int]:
    """Leave out the vertices that no face uses; the others keep their order."""
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    return vertices[used], (np.cumsum(used) - 1)[faces]
