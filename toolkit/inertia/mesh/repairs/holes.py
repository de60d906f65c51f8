"""Hole filling: triangles of least area over the boundary loops of a consistently wound surface.

The rims are followed against the direction of the triangles around them and cut into simple loops. A loop of
up to 300 edges is filled with the triangles of least area that its own vertices can form (dynamic programming
over spans of the loop, after G. Barequet and M. Sharir, "Filling gaps in the boundary of a polyhedron",
Computer Aided Geometric Design 12 (1995)), which for a flat loop is any triangulation of it. A longer one is
filled from its centroid, if it is flat and every part of it can be seen from there.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import SHELL, WELD, GeometryError
from inertia.mesh.geometry.faces import components
from inertia.mesh.geometry.halfedges import HalfEdges
from inertia.mesh.geometry.triangle_pairs import unit

_EDGES = 300  # longest loop for the triangulation of least area, whose cost grows with the cube
_FLAT = 1e-6  # distance from the common plane, over the length of the rim
_SHEET = 0.8  # area of a filling, over that of the surface around it: above, that is a sheet and not a solid


def rims(edges: HalfEdges) -> list[list[int]]:
    """Return the loops that a filling must run along: directed edges, reversed and in order.

    >>> from inertia.mesh.geometry.halfedges import half_edges
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    >>> edges = half_edges(faces)
    >>> [[int(edges.head[edge]) for edge in loop] for loop in rims(edges)]
    [[3, 2, 0]]
    """
    unused: dict[int, list[int]] = defaultdict(list)
    for edge in reversed(_unmatched(edges).tolist()):
        unused[int(edges.head[edge])].append(edge)
    return [loop for start in list(unused) for loop in _loops(start, unused, edges)]


def fill(vertices: Float, faces: Int, edges: HalfEdges, loops: list[list[int]]) -> tuple[Float, list[Int]]:
    """Return the vertices with those that were added, and the new faces of each loop.

    Raises
    ------
    GeometryError : a loop is longer than 300 edges and not flat or not star-shaped
    """
    fillings: list[Int] = []
    for loop in loops:
        rim = edges.head[loop]
        if len(loop) <= _EDGES:
            fillings.append(rim[_least_area(vertices[rim])])
            continue
        centre = vertices[rim].mean(axis=0)
        fan = np.column_stack([np.full(len(rim), len(vertices)), rim, np.roll(rim, -1)])
        vertices = np.vstack([vertices, centre])
        if not _lies_flat(vertices[fan]):
            raise GeometryError(
                f"the hole {around(vertices[rim])} has {len(rim)} edges and is not flat and star-shaped, as "
                f"one of more than {_EDGES} edges must be: close it where the part was made"
            )
        fillings.append(fan)
    return vertices, fillings


def around(points: Float) -> str:
    """Say in words where the middle of points (n, 3) is."""
    return f"around ({', '.join(f'{value:.9g}' for value in points.mean(axis=0))})"


def _unmatched(edges: HalfEdges) -> Int:
    """Return the directed edges without an opposite one: of an edge with some to spare, the first."""
    spare = edges.by_edge[(edges.direction * edges.surplus[edges.edge] > 0)[edges.by_edge]]
    edge = edges.edge[spare]
    turn = np.arange(len(edge)) - np.searchsorted(edge, edge)
    return spare[turn < np.abs(edges.surplus[edge])]


def _loops(start: int, unused: dict[int, list[int]], edges: HalfEdges) -> Iterator[list[int]]:
    """Walk from a vertex until nothing waits there, cutting a loop off whenever the walk meets itself.

    At every vertex as many directed edges end as begin, so that a walk ends where it began.
    """
    path: list[int] = []
    place = {start: 0}
    vertex = start
    while unused[vertex]:
        path.append(unused[vertex].pop())
        vertex = int(edges.tail[path[-1]])
        if vertex not in place:
            place[vertex] = len(path)
            continue
        loop = path[place[vertex] :]
        del path[place[vertex] :]
        for passed in loop[1:]:
            del place[int(edges.head[passed])]
        yield loop


def _least_area(rim: Float) -> Int:
    """Return the triangles (n − 2, 3) of least area over the points of a loop (n, 3)."""
    count = len(rim)
    rim = rim - rim[0]
    rim = rim / np.abs(rim).max()
    cost, middle = np.zeros((count, count)), np.zeros((count, count), np.int64)
    for span in range(2, count):
        i = np.arange(count - span)
        j = i + span
        k = i[:, None] + np.arange(1, span)
        area = np.linalg.norm(np.cross(rim[k] - rim[i, None], rim[j, None] - rim[i, None]), axis=2)
        total = cost[i[:, None], k] + cost[k, j[:, None]] + area
        best = total.argmin(axis=1)
        cost[i, j], middle[i, j] = total[i, best], i + 1 + best
    faces, spans = [], [(0, count - 1)]
    while spans:
        first, last = spans.pop()
        if last - first > 1:
            between = int(middle[first, last])
            faces.append((first, between, last))
            spans += [(first, between), (between, last)]
    return np.array(faces)


def _lies_flat(fan: Float) -> bool:
    """Say whether triangles around one point (n, 3, 3) lie in one plane without overlapping."""
    centre, one, other = (corner - fan[0, 0] for corner in fan.transpose(1, 0, 2))
    normals = np.cross(one - centre, other - centre)
    normal = unit(normals.sum(axis=0))
    height = np.abs(one @ normal).max()
    length = np.linalg.norm(other - one, axis=1).sum()
    return bool((normals @ normal > 0).all() and height <= _FLAT * length)


def sheets(vertices: Float, faces: Int, edges: HalfEdges, loops: list[list[int]], fillings: list[Int]) -> list[Int]:
    """Return the faces of each piece of surface that a filling is nearly as large as: it is a sheet, and no solid."""
    piece, shares = _shares(vertices, faces, edges, loops, fillings)
    which = {int(piece[loop[0] // 3]) for loop, share in zip(loops, shares, strict=True) if share > _SHEET}
    return [np.flatnonzero(piece == number) for number in sorted(which)]


def refuse_sheets(vertices: Float, faces: Int, edges: HalfEdges, loops: list[list[int]], fillings: list[Int]) -> None:
    """Raise `GeometryError` where a filling is nearly as large as the surface around it."""
    _, shares = _shares(vertices, faces, edges, loops, fillings)
    for loop, share in zip(loops, shares, strict=True):
        if share > _SHEET:
            raise GeometryError(
                f"the hole of {len(loop)} edges {around(vertices[edges.head[loop]])} is {share:.0%} as large "
                f"as the surface around it, above the limit of {_SHEET:.0%} for a solid: remove this sheet, merge its "
                "corners with others by ",
                WELD,
                ", or use ",
                SHELL,
            )


def _shares(
    vertices: Float, faces: Int, edges: HalfEdges, loops: list[list[int]], fillings: list[Int]
) -> tuple[Int, list[float]]:
    """Return the piece that each face is of, and the area of each filling over that of the piece around it."""
    piece = components(edges.neighbours() // 3, len(faces))
    area = np.bincount(piece, _areas(vertices[faces]), len(faces))
    shares = []
    for loop, new in zip(loops, fillings, strict=True):
        own, whole = _areas(vertices[new]).sum(), area[piece[loop[0] // 3]]
        shares.append(float(own / whole) if whole > 0 else np.inf if own > 0 else 0.0)
    return piece, shares


def _areas(corners: Float) -> Float:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas: Float = np.linalg.norm(normals, axis=1) / 2
    return areas
