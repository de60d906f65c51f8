"""Welding within a tolerance: vertices that lie close together become one.

Closeness chains: where a is close to b and b to c, all three become one vertex, however far c is from a. The
largest move says how far it went.
"""

from __future__ import annotations

from bisect import bisect_left
from decimal import ROUND_CEILING, Context

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import GeometryError, UsageError
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.edges import duplicates
from inertia.mesh.geometry.faces import components, merge_equal_vertices, repeated_corners
from inertia.mesh.surface import LARGEST, Surface, Triangles, usable
from inertia.records import dataclass

_LARGEST = 0.1  # tolerance, over the diagonal of the part's box
_CRACK = 1e-3  # width of a crack, over the diagonal of the part's box
_EDGES = 100_000  # open edges that are matched in a second or two
_SHRUNK = 0.01  # length of the rim of a crack that may shrink to points, over all of it
_THREE_DIGITS = Context(prec=3, rounding=ROUND_CEILING)
_SCANNED = 65_536  # triangles looked at together
_ABOVE = 1 + 1e-12  # the tree of `clusters` compares distances as rounded
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


def closing_distance(
    triangles: Triangles, vertices: Float, ends: Int, surplus: Int, collapsed: float = 1.0
) -> float | None:
    """Return the smallest tolerance, rounded up to three digits, with which `weld_within` closes a surface.

    Where welding closes a surface, any larger tolerance does too: the chain of its open edges stays zero when more of
    its vertices become one. So the tolerance is found by bisection of the distances between vertices.

    Parameters
    ----------
    triangles : the surface
    vertices : its different vertices, (n, 3)
    ends : its edges, (e, 2), vertex numbers
    surplus : how much oftener each is used from the first end to the second than back, (e,)
    collapsed : share of all edges that may be no longer than what closes the rim by itself: of more, it is not looked
        any further, which takes long where one stray vertex makes the box large and many vertices close in it

    Returns None where no tolerance of at most a thousandth of the diagonal of the part's box closes it, or it would
    do so by letting a rim shrink to a point, as that of a hole, or by laying triangles on each other. More than 10⁵
    open edges are not looked at.
    """
    every, ends, surplus = ends, ends[surplus != 0], surplus[surplus != 0]
    if len(ends) > _EDGES:
        return None
    tolerance = _closing(vertices, np.unique(ends), ends, surplus, _CRACK * diagonal(vertices) * _ABOVE)
    if tolerance is None or (_lengths(vertices, every) <= tolerance).mean() > collapsed:
        return None
    tolerance = _closing(vertices, np.arange(len(vertices)), ends, surplus, tolerance * _ABOVE)
    if tolerance is None:
        return None
    named = float(_THREE_DIGITS.create_decimal_from_float(tolerance * _ABOVE))
    try:
        result = weld_within(triangles, named).surface
    except UsageError:  # too many vertices are that close
        return None
    closed = result.count and closure(result).open_edges == 0 and not len(duplicates(result.faces)[1])
    return named if closed else None


def rim_distance(vertices: Float, ends: Int, surplus: Int) -> float | None:
    """Return the smallest distance, rounded up to three digits, that closes open edges when only their ends are merged.

    Parameters are as of `closing_distance`, and so is when there is none.
    """
    ends, surplus = ends[surplus != 0], surplus[surplus != 0]
    if not 0 < len(ends) <= _EDGES:
        return None
    distance = _closing(vertices, np.unique(ends), ends, surplus, _CRACK * diagonal(vertices) * _ABOVE)
    return None if distance is None else float(_THREE_DIGITS.create_decimal_from_float(distance * _ABOVE))


def may_close(vertices: Float, box: Float, ends: Int, surplus: Int) -> bool:
    """Say whether welding the ends of open edges closes a surface, so that `closing_distance` has to look at all of it.

    Parameters
    ----------
    vertices : those at open edges, at least, (n, 3); `box` (2, 3) is that of all
    ends, surplus : as of `closing_distance`
    """
    ends, surplus = ends[surplus != 0], surplus[surplus != 0]
    if len(ends) > _EDGES:
        return False
    return _closing(vertices, np.unique(ends), ends, surplus, _CRACK * diagonal(box) * _ABOVE) is not None


def _closing(vertices: Float, numbers: Int, ends: Int, surplus: Int, limit: float) -> float | None:
    """Return the smallest distance up to `limit` that closes the open edges when the numbered vertices are welded."""
    from scipy.spatial import cKDTree

    tree = cKDTree(vertices[numbers])
    while (tree.count_neighbors(tree, limit) - len(numbers)) // 2 > _PAIRS // 10:
        limit /= 10
    pairs = numbers[tree.query_pairs(limit, output_type="ndarray")]
    lengths = _lengths(vertices, pairs)
    distances = np.unique(lengths)

    def welded(k: int) -> Int:
        return components(pairs[lengths <= distances[k]], len(vertices))[ends]

    def closes(k: int) -> bool:
        low, high = np.sort(into := welded(k), axis=1).T
        way = np.where(low == high, 0, np.where(into[:, 0] == low, 1, -1))
        _, edge = np.unique(low * len(vertices) + high, return_inverse=True)
        return not np.bincount(edge, way * surplus).any()

    first = bisect_left(range(len(distances)), True, key=closes)
    if first == len(distances):
        return None
    along = _lengths(vertices, ends)
    shrunk = np.equal(*welded(first).T)
    return float(distances[first]) if along[shrunk].sum() <= _SHRUNK * along.sum() else None


def _lengths(vertices: Float, pairs: Int) -> Float:
    """Return how far apart the vertices of each pair (k, 2) are, (k,)."""
    lengths: Float = np.linalg.norm(vertices[pairs[:, 0]] - vertices[pairs[:, 1]], axis=1)
    return lengths


def require_finite(triangles: Triangles) -> None:
    """Raise `GeometryError` where a coordinate is NaN, infinite or too large to compute with."""
    for start in range(0, triangles.count, _SCANNED):
        fine = usable(triangles.corners(start, start + _SCANNED)).all(axis=2)
        if not fine.all():
            face, corner = (int(k) for k in np.argwhere(~fine)[0])
            raise GeometryError(
                f"triangle {start + face} has at corner {corner} a coordinate that is no usable number (NaN, infinite "
                f"or beyond {LARGEST:.0e}): export it again"
            )


def diagonal(vertices: Float) -> float:
    """Return the diagonal of the box around vertices (n, 3); 0 where there are none."""
    return float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 0.0


def compact(vertices: Float, faces: Int) -> tuple[Float, Int]:
    """Leave out the vertices that no face uses; the others keep their order."""
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    return vertices[used], (np.cumsum(used) - 1)[faces]
