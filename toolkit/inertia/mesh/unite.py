"""Union of a solid with itself: every point with a winding number of 1 or more counts once.

The triangles that meet others are divided where they do, into convex cells, in integers. On either side of each cell
the surface goes around the places so many times (the winding number), and so it does on either side of each patch of
triangles that meet none. What parts the places around which it goes at least once from the others is the surface of
the union. Its vertices are rounded to float64 once, and how far is known (`Rounding`).

Triangles are put in an order that depends on their coordinates alone, so that the union does too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from inertia.arrays import Bool, Float, Int, Progress
from inertia.errors import REPAIR, GeometryError
from inertia.mesh.arrangement.boundary import Polygon, Vertices, closed_surface, is_closed
from inertia.mesh.arrangement.cells import Cell, Division, Segment, divide
from inertia.mesh.arrangement.contacts import Contacts, contacts, edge_name
from inertia.mesh.arrangement.integers import Triangles, scaled, side, through
from inertia.mesh.arrangement.uncovered import growth, of_meeting_shells
from inertia.mesh.arrangement.windings import Probe, Sides, probe, sides
from inertia.mesh.check import check
from inertia.mesh.geometry.faces import components, repeated_corners
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.part import Part, Regions, Rounding
from inertia.mesh.surface import Surface, counts_once, usable
from inertia.records import dataclass

_EPSILON = 2.0**-53
_FLAT = 16 * _EPSILON  # more than the rounding of a cross product, over its terms


@dataclass(frozen=True, eq=False)
class Union:
    """A part whose inside counts once.

    Attributes
    ----------
    part : the united part; the one given where all counted once already
    crossings : pairs of triangles that cross or lie on one another
    more_than_once : ∫ max(w − 1, 0) dV over the winding number w, what counting more than once added to the volume, in
        file units cubed
    negative : ∫ max(−w, 0) dV, what counting less than not at all took from it
    origins : (m,) which of the triangles given each triangle of `part` lies in; None where that is the part given
    """

    part: Part
    crossings: int
    more_than_once: float
    negative: float
    origins: Int | None = None

    @property
    def changed(self) -> bool:
        """Whether anything counted more than once, or less than not at all."""
        return self.more_than_once > 0 or self.negative > 0

    def _repr_html_(self) -> str:
        """Return a small table, as a notebook shows it."""
        from inertia.notebook import html_of

        cubed = f"{self.part.unit.name}³"
        return html_of(
            [
                ("United", self.part.name),
                ("Crossings", f"{self.crossings} pairs of triangles"),
                ("Counted more than once", f"{self.more_than_once:.6g} {cubed}"),
                ("Counted negative", f"{self.negative:.6g} {cubed}"),
            ]
        )


class _Face(NamedTuple):
    """A cell of a triangle, and its neighbourhood."""

    triangle: int
    cell: Cell
    division: Division
    sides: Sides


def unite(part: Part, progress: Progress | None = None) -> Union:
    """Unite the bodies of a part with one another, and its shells with themselves.

    Parameters
    ----------
    progress : called with the fraction done

    Raises
    ------
    GeometryError : the surface is open or wound inconsistently, or faces inward everywhere

    >>> from inertia.mesh.cut import block
    >>> corners = np.concatenate([block([0, 0, 0], np.eye(3)).corners(), block([0.5, 0, 0], np.eye(3)).corners()])
    >>> union = unite(Part.from_arrays(corners.reshape(-1, 3), np.arange(72).reshape(-1, 3)))
    >>> union.more_than_once, check(union.part).fit
    (0.5, True)
    """
    if counts_once(part.triangles):
        return Union(part, 0, 0.0, 0.0)
    vertices, faces, origin = _in_order(part)
    triangles = Triangles(vertices, faces)
    solid = np.flatnonzero(~_flat(triangles))
    if not len(solid):
        raise GeometryError(
            f"{part.name}: none of its triangles has an area, so that they bound nothing: export a solid"
        )
    meetings = contacts(triangles, solid, _part_of(progress, 0.0, 0.4))
    free = np.zeros(len(faces), bool)
    free[solid] = True
    free[list(meetings.segments)] = False
    patch, leaders = _patches(triangles, solid, free, meetings.touched)
    divisions: dict[int, Division] = {}
    probes: list[Probe] = []
    cells: list[tuple[int, Cell, int]] = []
    for number in [*leaders.tolist(), *sorted(meetings.segments)]:
        division = _divided(triangles, number, meetings.segments.get(number, []))
        divisions[number] = division
        largest: dict[int, Cell] = {}
        for cell, group in zip(division.cells, division.group, strict=True):
            largest[group] = max(cell, largest.get(group, cell), key=lambda cell: cell.area(triangles.exponent))
        places = {group: len(probes) + k for k, group in enumerate(largest)}
        probes += [probe(triangles, number, cell, division.lines) for cell in largest.values()]
        cells += [(number, cell, places[group]) for cell, group in zip(division.cells, division.group, strict=True)]
    around = sides(triangles, probes, _part_of(progress, 0.5, 0.9))
    if all({at.above, at.below} <= {0, 1} for at in around):
        part.triangles.counts_once = True
        return Union(part, meetings.crossings, 0.0, 0.0)
    facing_up = np.array([triangles.plane(k).normal[triangles.plane(k).axis] > 0 for k in leaders.tolist()], bool)
    front, behind = np.zeros((2, len(faces)), np.int64)
    for k, (leader, at) in enumerate(zip(leaders.tolist(), around, strict=False)):
        members = patch == leader
        front[members], behind[members] = (at.above, at.below) if facing_up[k] else (at.below, at.above)
    divided = [
        _Face(number, cell, divisions[number], around[place])
        for number, cell, place in cells[len(leaders) :]
        if around[place].first == number
    ]
    whole = patch >= 0
    more, negative = _beyond_once(triangles, faces[whole], front[whole], behind[whole], divided)
    keeps, turns = (behind > 0) & (front <= 0) & whole, (front > 0) & (behind <= 0) & whole
    faces = np.where(turns[:, None], faces[:, ::-1], faces)
    stays = np.flatnonzero(keeps | turns)
    surface = _surface(triangles, faces[stays], stays, divided)
    if surface is None:
        raise GeometryError(
            f"{part.name}: it has no union, as its surface faces inward and no point has a winding number of 1 "
            "or more: turn all triangles, or use ",
            REPAIR,
        )
    coordinates, rests, pieces, sources = surface
    meeting = _meeting(part, triangles, meetings, origin, origin[sources])
    united = _rebuilt(part, coordinates, rests, pieces, origin[sources], meeting)
    return Union(united, meetings.crossings, more, negative, origin[sources])


def _in_order(part: Part) -> tuple[Float, Int, Int]:
    """Return the vertices and triangles in an order of their coordinates, and which triangle each was.

    Raises `GeometryError` where they do not bound anything, so that winding numbers could not be counted.
    """
    points = part.triangles.corners().reshape(-1, 3) + 0.0
    if len(points) == 0 or not usable(points).all():
        check(part).require_fit()
    order = np.lexsort(points.T[::-1])
    first = np.ones(len(points), bool)
    first[1:] = (points[order][1:] != points[order][:-1]).any(axis=1)
    numbers = np.empty(len(points), np.int64)
    numbers[order] = np.cumsum(first) - 1
    faces = numbers.reshape(-1, 3)
    faces = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    origin = np.flatnonzero(~repeated_corners(faces))
    region = np.zeros(len(faces), np.int32) if part.regions is None else part.regions.index
    a, b, c = faces[origin].T
    origin = origin[np.lexsort((region[origin], c, b, a))]
    if not is_closed(faces[origin]):
        check(part, intersections=False).require_fit()
    return points[order[first]], faces[origin], origin


def _flat(triangles: Triangles) -> Bool:
    """Say which triangles have no area, exactly."""
    a, b, c = triangles.vertices[triangles.faces].transpose(1, 2, 0)
    u, v = b - a, c - a
    flat = np.ones(len(triangles.faces), bool)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        for i, j in ((1, 2), (2, 0), (0, 1)):
            left, right = u[i] * v[j], u[j] * v[i]
            flat &= ~(np.abs(left - right) > _FLAT * (np.abs(left) + np.abs(right)) + 2.0**-1000)
    for number in np.flatnonzero(flat).tolist():
        flat[number] = not any(triangles.plane(number).normal)
    return flat


def _patches(triangles: Triangles, solid: Int, free: Bool, touched: set[tuple[int, int]]) -> tuple[Int, Int]:
    """Return for each triangle the first of its patch (−1 where it is not free), and the largest of each patch."""
    faces = triangles.faces[solid]
    edges = half_edges(faces)
    ordinary = (edges.uses == 2) & (edges.surplus == 0)
    if touched:
        low, high = np.array(sorted(touched)).T
        base = len(triangles.vertices)
        keys = np.minimum(edges.tail, edges.head) * base + np.maximum(edges.tail, edges.head)
        ordinary[edges.edge[np.isin(keys, low * base + high)]] = False
    pairs = edges.by_edge[ordinary[edges.edge[edges.by_edge]]].reshape(-1, 2) // 3
    pairs = pairs[free[solid[pairs]].all(axis=1)]
    corners = triangles.vertices[faces]
    scale = np.ldexp(1.0, -int(np.frexp(np.abs(corners).max(initial=0.0))[1]))
    area = np.linalg.norm(
        np.cross(scale * (corners[:, 1] - corners[:, 0]), scale * (corners[:, 2] - corners[:, 0])), axis=1
    )
    label = components(pairs, len(solid))
    order = np.lexsort((solid, -area, label))
    order = order[free[solid[order]]]
    leads = np.ones(len(order), bool)
    leads[1:] = label[order][1:] != label[order][:-1]
    leaders = solid[order[leads]]
    patch = np.full(len(triangles.faces), -1)
    patch[solid[order]] = leaders[np.cumsum(leads) - 1]
    return patch, leaders


def _divided(triangles: Triangles, number: int, segments: list[Segment]) -> Division:
    ends, corners = triangles.faces[number].tolist(), triangles.seen(number)
    if side(through(corners[0], corners[1]), corners[2]) < 0:
        corners, ends = (corners[0], corners[2], corners[1]), [ends[0], ends[2], ends[1]]
    around = [(k, (k + 1) % 3) for k in range(3)]
    lines = [through(corners[i], corners[j]) for i, j in around]
    names = [edge_name(min(ends[i], ends[j]), max(ends[i], ends[j])) for i, j in around]
    return divide(corners, lines, names, segments, triangles.exponent)


def _beyond_once(
    triangles: Triangles, faces: Int, front: Int, behind: Int, divided: list[_Face]
) -> tuple[float, float]:
    """Return ∫ max(w − 1, 0) dV and ∫ max(−w, 0) dV over the winding number w, by the divergence theorem."""
    low = triangles.vertices.min(axis=0)
    corners = [triangles.vertices[faces] - low]
    before, beyond = [front], [behind]
    for face in divided:
        normal, offset, k = triangles.plane(face.triangle)
        plane = scaled(offset, normal[k], triangles.exponent), normal[k - 2] / normal[k], normal[k - 1] / normal[k]
        points = np.empty((len(face.cell.corners), 3))
        points[:, [k - 2, k - 1]] = face.cell.points(triangles.exponent)
        points[:, k] = plane[0] - plane[1] * points[:, k - 2] - plane[2] * points[:, k - 1]
        fan = np.stack([np.broadcast_to(points[0], points[2:].shape), points[1:-1], points[2:]], axis=1)
        corners.append(fan)
        before.append(np.full(len(fan), face.sides.above))
        beyond.append(np.full(len(fan), face.sides.below))
    a, b, c = (np.concatenate(corners) - np.ptp(triangles.vertices, axis=0) / 2).transpose(1, 0, 2)
    volume = np.einsum("ki,ki->k", a, np.cross(b, c)) / 6
    outside, inside = np.concatenate(before), np.concatenate(beyond)
    more = np.maximum(inside - 1, 0) - np.maximum(outside - 1, 0)
    negative = np.maximum(-inside, 0) - np.maximum(-outside, 0)
    # Where nothing counts so, the sum is zero and not what rounding makes of it.
    return max(float((more * volume).sum()), 0.0), max(float((negative * volume).sum()), 0.0)


def _surface(
    triangles: Triangles, faces: Int, origins: Int, divided: list[_Face]
) -> tuple[Float, Float, Int, Int] | None:
    """Return vertices, what their rounding took from them, triangles, and which triangle each of these comes from."""
    vertices = Vertices(triangles)
    polygons = []
    for face in divided:
        if (face.sides.above > 0) == (face.sides.below > 0):
            continue
        loop = [vertices.number(triangles.place(face.triangle, corner)) for corner in face.cell.corners]
        names = [face.division.names[line] for line in face.cell.lines]
        if face.sides.above > 0:
            loop, names = loop[::-1], names[-2::-1] + names[-1:]
        polygons.append(Polygon(loop, names, face.triangle))
    if len(faces) + len(polygons) == 0:
        return None
    faces, origins = closed_surface(vertices, faces, origins, polygons)
    if not is_closed(faces):
        raise RuntimeError("the cells of an arrangement do not close a surface")
    used, numbers = np.unique(faces, return_inverse=True)
    coordinates = np.empty((len(used), 3))
    rests = np.zeros((len(used), 3))
    old = used < vertices.first
    coordinates[old] = triangles.vertices[used[old]]
    for k in np.flatnonzero(~old).tolist():
        coordinates[k], rests[k] = triangles.rounded(vertices.place(int(used[k])))
    return coordinates, rests, numbers.reshape(-1, 3), origins


def _rebuilt(part: Part, vertices: Float, rests: Float, faces: Int, origins: Int, meeting: Bool) -> Part:
    """Return the union as a part; `meeting` says which of the given triangles may be off so that others come to light.

    Those that are left of them are taken for as much farther off as bounds what comes to light, too.
    """
    surface = Surface(vertices, faces)
    surface.counts_once = True
    distance = float(np.linalg.norm(rests, axis=1).max()) * (1 + 8 * _EPSILON)
    rounding = Rounding(distance, lambda: rests) if distance else None
    left, chord = meeting[origins], part.chord

    def farther(off: float) -> float:
        """Return how far what is left is to be taken for off, where what others come to light of is off so far."""
        if not meeting.any():
            return off
        corners = surface.corners()
        return off * growth(part.triangles.corners()[meeting], corners[left], corners, off)

    if part.rounding is not None:
        rounding = Rounding(distance + farther(part.rounding.distance) * _reach(part, surface) ** 3)
    if chord is not None:
        chord = np.where(left, farther(float(chord[meeting].max(initial=0.0))), chord[origins]) + distance
    regions = part.regions
    if regions is not None:
        regions = Regions(regions.names, regions.index[origins])
    return replace(part, geometry=surface, regions=regions, rounding=rounding, chord=chord, shape=None)


def _meeting(part: Part, triangles: Triangles, found: Contacts, origin: Int, origins: Int) -> Bool:
    """Say which triangles of a part are of shells that meet others, or may where they are off by what is stated.

    Where nothing is left of these shells, all are; `origins` are the triangles of which something is left.
    """
    meeting = np.zeros(part.triangles.count, bool)
    if part.chord is not None or part.rounding is not None:
        reach = np.zeros(len(origin)) if part.chord is None else part.chord[origin]
        reach = reach + (0.0 if part.rounding is None else part.rounding.distance)
        meeting[origin] = of_meeting_shells(triangles, found, reach)
    return meeting if meeting[origins].any() else np.full(len(meeting), meeting.any())


def _reach(part: Part, union: Surface) -> float:
    """Return how much longer the arms of a part may be than those of its union, smaller where it is negative."""
    extent, smaller = (np.ptp(triangles.corners(), axis=(0, 1)) for triangles in (part.triangles, union))
    return 1.0 if (extent == smaller).all() else 2.0 * float((extent / smaller).max())


def _part_of(progress: Progress | None, start: float, stop: float) -> Progress | None:
    return None if progress is None else lambda done: progress(start + done * (stop - start))
