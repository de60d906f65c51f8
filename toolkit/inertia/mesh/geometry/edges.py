"""Edges of a triangle surface by their number of triangles, boundary loops, duplicate and flat triangles.

It works by sorting, on the faces that `inertia.mesh.geometry.faces.merge_equal_vertices` returns, and is for the
details; whether a surface is closed at all, `inertia.mesh.geometry.closure` says sooner. Triangles with a repeated
corner have no edges here.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.faces import components, repeated_corners
from inertia.records import dataclass

Place = tuple[float, float, float]

_FLAT = 1e-14
"""Area over longest edge squared below which a triangle is flat: fifty times what rounding makes of it."""


@dataclass(frozen=True, eq=False)
class Edges:
    """The undirected edges of a surface, and how often each is used.

    Attributes
    ----------
    ends : (e, 2), vertex numbers, the lower first; rows ascending
    forward : (e,), triangles that run from the lower end to the higher
    backward : (e,), triangles that run the other way
    users : (sum of uses,), the triangles edge by edge, ascending for each edge
    """

    ends: Int
    forward: Int
    backward: Int
    users: Int

    @property
    def uses(self) -> Int:
        """Triangles at each edge, (e,)."""
        return self.forward + self.backward

    @property
    def boundary(self) -> Bool:
        """Edges of one triangle, (e,)."""
        once: Bool = self.uses == 1
        return once

    @property
    def inconsistent(self) -> Bool:
        """Edges of two triangles that run the same way, (e,): one of the two is wound wrongly."""
        same_way: Bool = (self.uses == 2) & ~self.balanced
        return same_way

    @property
    def non_manifold(self) -> Bool:
        """Edges of more than two triangles, (e,)."""
        many: Bool = self.uses > 2
        return many

    @property
    def at_crowded(self) -> Int:
        """The triangles with an edge that more than two have, ascending."""
        return np.unique(self.users[np.repeat(self.non_manifold, self.uses)])

    @property
    def balanced(self) -> Bool:
        """Edges used equally often both ways, (e,); a surface that bounds a solid has no others."""
        both_ways: Bool = self.forward == self.backward
        return both_ways

    def triangles(self, edges: Int, limit: int = 10) -> tuple[int, ...]:
        """Return the first `limit` different triangles at the numbered edges, in that order."""
        uses = self.uses
        start = np.cumsum(uses) - uses
        users: dict[int, None] = {}
        for edge in edges:
            users.update(dict.fromkeys(self.users[start[edge] : start[edge] + uses[edge]].tolist()))
            if len(users) >= limit:
                break
        return tuple(users)[:limit]


@dataclass(frozen=True)
class Loop:
    """A line of edges that only one triangle has: the rim of a hole.

    Attributes
    ----------
    edges : number of edges
    length : in file units
    place : centroid of the line, in file units
    start : coordinates of its first vertex, in file units
    triangle : the triangle at its first edge
    closed : False for a line that ends at an edge of more than two triangles
    """

    edges: int
    length: float
    place: Place
    start: Place
    triangle: int
    closed: bool


def flat(vertices: Float, faces: Int) -> Bool:
    """Say which faces (m, 3) with three different corners have no area: below 1e-14 × longest edge²."""
    a, b, c = (vertices[corner] for corner in faces.T)
    sides = np.stack([b - a, c - b, a - c])
    longest = np.hypot(np.hypot(sides[..., 0], sides[..., 1]), sides[..., 2]).max(axis=0)
    # Dividing first keeps the area of a very small or large triangle inside float64.
    unit = sides[:2] / np.where(longest > 0, longest, 1)[:, None]
    area = np.linalg.norm(np.cross(unit[0], unit[1]), axis=1) / 2
    without_area: Bool = (area < _FLAT) & ~repeated_corners(faces)
    return without_area


def first_equal(rows: Int) -> Int:
    """Return for each row of a (n, k) array the number of the first row that equals it."""
    order = np.lexsort(rows.T[::-1])
    ranked = rows[order]
    leads = np.ones(len(rows), bool)
    leads[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
    first = np.empty(len(rows), np.int64)
    first[order] = order[leads][np.cumsum(leads) - 1]
    return first


def duplicates(faces: Int) -> tuple[Int, Int]:
    """Return the faces that repeat an earlier one: wound the same way, and (only) the opposite way."""
    corners, number = np.sort(faces, axis=1), np.arange(len(faces))
    again = first_equal(corners) != number
    if not again.any():
        return number[:0], number[:0]
    turned = np.take_along_axis(faces, (np.argmin(faces, axis=1)[:, None] + 1) % 3, axis=1) != corners[:, 1:2]
    distinct = ~repeated_corners(faces)
    same = (first_equal(np.hstack([corners, turned])) != number) & distinct
    opposite = again & distinct & ~same
    return np.flatnonzero(same), np.flatnonzero(opposite)


def pair_edges(faces: Int) -> Edges:
    """Count the uses of every edge of welded faces (m, 3).

    >>> edges = pair_edges(np.array([[0, 1, 2], [0, 2, 3]]))
    >>> edges.ends.tolist(), edges.uses.tolist()
    ([[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]], [1, 2, 1, 1, 1])
    """
    distinct = np.flatnonzero(~repeated_corners(faces))
    tail = faces[distinct].ravel()
    head = np.roll(faces[distinct], -1, axis=1).ravel()
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort((high, low))
    ends = np.column_stack([low, high])[order]
    leads = np.ones(len(ends), bool)
    leads[1:] = (ends[1:] != ends[:-1]).any(axis=1)
    start = np.flatnonzero(leads)
    uses = np.diff(np.append(start, len(ends)))
    number = np.cumsum(leads) - 1
    forward = np.bincount(number[(tail < head)[order]], minlength=len(start))
    return Edges(ends[start], forward, uses - forward, np.repeat(distinct, 3)[order])


def pieces(edges: Edges) -> int:
    """Count the pieces of surface that hang together by their edges, whatever their winding."""
    edge = np.repeat(np.arange(len(edges.ends)), edges.uses)
    same = edge[1:] == edge[:-1]
    triangles, user = np.unique(edges.users, return_inverse=True)
    labels = components(np.column_stack([user[1:][same], user[:-1][same]]), len(triangles))
    return len(np.unique(labels))


def boundary_loops(vertices: Float, edges: Edges) -> tuple[Loop, ...]:
    """Chain the boundary edges into simple loops, the longest first.

    Where several rims meet in one vertex they are taken apart there, always in the same way. Winding plays no
    part, so that a rim whose triangles are wound inconsistently is still one loop.
    """
    rim = np.flatnonzero(edges.boundary)
    if len(rim) == 0:
        return ()
    ends = np.where(edges.forward[rim, None] == 1, edges.ends[rim], edges.ends[rim, ::-1])
    chains = list(_chains(ends))
    size = np.array([len(chain) for chain, _, _ in chains])
    number = np.repeat(np.arange(len(chains)), size)
    member = np.concatenate([chain for chain, _, _ in chains])
    tail, head = vertices[ends[member, 0]], vertices[ends[member, 1]]
    x, y, z = (head - tail).T
    lengths = np.hypot(np.hypot(x, y), z)
    length = np.bincount(number, lengths)
    share = (lengths / length[number])[:, None] * (tail + (head - tail) / 2)
    place = np.stack([np.bincount(number, share[:, axis]) for axis in range(3)], axis=1)
    first = np.array([chain[0] for chain, _, _ in chains])
    triangle = edges.users[(np.cumsum(edges.uses) - edges.uses)[rim[first]]]
    start = vertices[[vertex for _, vertex, _ in chains]]
    loops = [
        Loop(edges=int(n), length=float(s), place=_place(p), start=_place(v), triangle=int(t), closed=chain[2])
        for n, s, p, v, t, chain in zip(size, length, place, start, triangle, chains, strict=True)
    ]
    return tuple(sorted(loops, key=lambda loop: -loop.length))


def _place(point: Float) -> Place:
    x, y, z = point.tolist()
    return x, y, z


def _chains(ends: Int) -> Iterator[tuple[list[int], int, bool]]:
    """Split a graph, edges `ends` (k, 2), into simple chains: (edges in order, first vertex, closed).

    A walk cuts a loop off whenever it meets itself. Open chains run from one vertex with an odd number of
    edges to another, so walks begin at those.
    """
    tail, head = ends.T.tolist()
    unused: dict[int, list[int]] = defaultdict(list)
    for number in reversed(range(len(ends))):  # a walk takes the last first
        unused[tail[number]].append(number)
        unused[head[number]].append(number)
    used = [False] * len(ends)

    def leave(vertex: int) -> int | None:
        while unused[vertex]:
            edge = unused[vertex].pop()
            if not used[edge]:
                used[edge] = True
                return edge
        return None

    odd = [vertex for vertex, at in unused.items() if len(at) % 2]
    for origin in sorted(odd) + tail:
        path: list[int] = []
        visited = [origin]
        position = {origin: 0}
        while (edge := leave(visited[-1])) is not None:
            path.append(edge)
            vertex = head[edge] if tail[edge] == visited[-1] else tail[edge]
            if vertex not in position:
                position[vertex] = len(visited)
                visited.append(vertex)
                continue
            at = position[vertex]
            yield path[at:], vertex, True
            del path[at:]
            for passed in visited[at + 1 :]:
                del position[passed]
            del visited[at + 1 :]
        if path:
            yield path, origin, False
