"""Edges of more than two triangles: which of these belong together, by their angles around the edge, exactly.

Around an edge each triangle is a half-plane: going round, it leads into material or out of it. One that leads in
belongs to the next that leads out, as brackets pair: shells that are paired so never cross, whatever the order of the
triangles. How deep the brackets nest is how often the material counts there; a sound solid has it once or not at all.

On which side of one half-plane another lies, `inertia.mesh.geometry.triangle_pairs.orient3d` says without error.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.contact_depth import CONTACT, are_single, last_digits
from inertia.mesh.geometry.halfedges import HalfEdges
from inertia.mesh.geometry.triangle_pairs import Sign, orient3d
from inertia.native import Kernel, place
from inertia.records import dataclass

SORT = Kernel("inertia.mesh.geometry.fan_kernel", "sort_fans", "pipippi" + "ppppp" + "ppppp" + "pp")
_WORK = 4  # times what integrating a triangle costs
_MOST, _ROOM = 64, 18 + 192  # as the kernel has them
_AT_ONCE = 1 << 18  # signs decided at a time
_TELLING = 1e-12  # of the lengths of two sides: above a thousand times what the rounding of their product is


@dataclass(frozen=True, eq=False)
class Fans:
    """Directed edges in groups, each group sorted by the angles of its triangles around the edge.

    Attributes
    ----------
    half_edge : (k,), the numbers of the directed edges; triangles without area are not among them
    group : (k,), ascending
    plane : (k,), ascending; the same for triangles of one group that lie in one half-plane
    opens : (k,), whether material begins behind the triangle as the angle grows
    angle : (k,), rad, from the first triangle of the group on, rounded
    height : (k,), distance of the triangle's third corner from the edge
    blur : (k,), rad, what the rounding of stored coordinates turns the triangle by, at most
    """

    half_edge: Int
    group: Int
    plane: Int
    opens: Bool
    angle: Float
    height: Float
    blur: Float

    def select(self, which: Bool | Int) -> Fans:
        """Return the directed edges that a mask or numbers pick."""
        return Fans(*(each[which] for each in vars(self).values()))


_Tie = tuple[tuple[int, list[int]], tuple[int, list[int]]]
"""Triangles in one half-plane that begin, and those in another that end, each with the number of the half-plane."""


def fans(vertices: Float, faces: Int, edges: HalfEdges, half_edge: Int, group: Int) -> Fans:
    """Sort directed edges by angle; those of one group (k,) run along one edge, one way or the other."""
    largest, single, left = 0.0, True, np.ones(len(group), bool)
    parts = []
    if SORT.worthwhile(_WORK * len(group)):
        around, left, largest, single = _compiled(vertices, faces, half_edge, group)
        parts.append(around)
    if left.any() or not parts:
        around, points = _vectorised(vertices, faces, edges, half_edge[left], group[left])
        parts.append(around)
        largest, single = max(largest, float(np.abs(points).max(initial=0.0))), single and are_single(points)
    around = parts[0] if len(parts) == 1 else _merged(*parts)
    # By these points alone, so that the answer is the same whatever else is known of a surface.
    with np.errstate(over="ignore"):
        blur = np.nan_to_num(around.blur * (last_digits(largest, single=single) / 4))
    return replace(around, blur=blur)


def _compiled(vertices: Float, faces: Int, half_edge: Int, group: Int) -> tuple[Fans, Bool, float, bool]:
    """Return what `_vectorised` does, less some (k,) that are left; the largest coordinate; whether all are single."""
    order = np.argsort(group, kind="stable")
    starts, _ = _runs(group[order])
    stops, each, faces = np.append(starts, len(order)), half_edge[order], np.ascontiguousarray(faces)
    scratch = np.empty((_MOST + 2, 9)), np.empty((6, _MOST)), np.empty((3, _MOST), np.int64), np.empty(_ROOM)
    (extent, state), counts = np.empty((2, 2)), np.empty(len(starts), np.int64)
    (twice, plane), (angle, height, blur) = np.empty((2, len(order)), np.int64), np.empty((3, len(order)))
    SORT.function(
        *(place(vertices), len(vertices), place(faces), len(faces), place(each), place(stops), len(starts)),
        *map(place, (*scratch, extent, twice, plane, angle, height, blur, counts, state)),
    )
    done = counts >= 0
    left = np.zeros(len(order), bool)
    left[order] = np.repeat(~done, np.diff(stops))
    groups = np.repeat(group[order][starts[done]], counts[done])
    some = slice(len(groups))
    twice = twice[some]
    around = Fans(twice >> 1, groups, plane[some], twice % 2 == 1, angle[some], height[some], blur[some])
    return around, left, float(state[0]), bool(state[1])


def _merged(one: Fans, other: Fans) -> Fans:
    """Return directed edges of different groups, in the order of these."""
    both = Fans(*(np.concatenate([getattr(one, name), getattr(other, name)]) for name in vars(one)))
    plane = np.concatenate([one.plane, other.plane + one.plane.max(initial=-1) + 1])
    order = np.argsort(both.group, kind="stable")
    starts, _ = _runs(plane[order])
    counts = np.diff(np.append(starts, len(order)))
    return replace(both.select(order), plane=np.repeat(np.arange(len(starts)), counts))


def _vectorised(vertices: Float, faces: Int, edges: HalfEdges, half_edge: Int, group: Int) -> tuple[Fans, Float]:
    """Return what `fans` does, with blurs over the last digit of coordinates, and the points (3, k, 3) of triangles."""
    x, y, z = vertices[_apex(faces, half_edge)].T
    order = np.lexsort((z, y, x, group))
    half_edge, group = half_edge[order], group[order]
    tail, head = vertices[edges.tail[half_edge]], vertices[edges.head[half_edge]]
    upwards = _precedes(tail, head)
    u, v = np.where(upwards[:, None], tail, head), np.where(upwards[:, None], head, tail)
    w = vertices[_apex(faces, half_edge)]
    normal, height, sure = _normals(u, v, w)
    solid = sure.copy()
    solid[~sure] = _normal_signs(u[~sure], v[~sure], w[~sure]).any(axis=1)
    half_edge, group, upwards, sure = half_edge[solid], group[solid], upwards[solid], sure[solid]
    u, v, w, normal, height = u[solid], v[solid], w[solid], normal[:, solid], height[solid]
    _, reference = _runs(group)
    side = _orientation(u, v, w[reference], w)
    level = np.flatnonzero(side == 0)
    first = reference[level]
    with np.errstate(over="ignore", invalid="ignore"):  # where they are not sure
        facing = (normal[:, level] * normal[:, first]).sum(axis=0) > 0
    doubtful = np.flatnonzero(~(sure[level] & sure[first]))
    one, other = (_normal_signs(u[k], v[k], w[k]) for k in (level[doubtful], first[doubtful]))
    facing[doubtful] = (one == other).all(axis=1)
    quarter = np.array([3, 2, 1])[side + 1]
    quarter[level[facing]] = 0
    angle = _angles(v - u, normal, reference)
    low, high = np.array([[0, 0], [0, np.pi], [np.pi, np.pi], [np.pi, 2 * np.pi]])[quarter].T
    # Rounding may take an angle across the reference: a full turn off.
    angle = np.clip(angle - 2 * np.pi * np.round((angle - (low + high) / 2) / (2 * np.pi)), low, high)
    order = np.lexsort((angle, quarter, group))
    beyond = _sorted_exactly(order, group, quarter, u, v, w)
    plane = np.concatenate([[0], np.cumsum(beyond)]) if len(order) else order
    opens = ~upwards
    # In one half-plane, what ends comes before what begins: bodies that touch there stay apart.
    first = np.lexsort((opens[order], plane))
    order, plane = order[first], plane[first]
    blur = _blur(u, v, w, height)
    sorted_fans = Fans(half_edge[order], group[order], plane, opens[order], angle[order], height[order], blur[order])
    return sorted_fans, np.stack([u, v, w])


def links(vertices: Float, faces: Int, edges: HalfEdges, piece: Int) -> Int:
    """Return pairs of triangles (k, 2) that belong together at edges of more than two triangles.

    A piece of surface that has such an edge both ways equally often is closed there by itself, unless it is a sheet of
    no thickness, as all such are one. The others are joined by angle, and of several in one half-plane those that hang
    together already; half-planes that rounding alone tells apart, so that material lies on material, are one. Where
    that leaves an edge open, all of them are joined; so are triangles without area there.

    Parameters
    ----------
    piece : (m,), the pieces of surface that hang together by edges of two triangles
    """
    member = edges.by_edge[(edges.uses > 2)[edges.edge[edges.by_edge]]]
    edge, way = edges.edge[member], edges.direction[member]
    around = fans(vertices, faces, edges, member, edge)
    own = np.zeros(len(edges.tail), np.int64)
    own[member] = _numbered(edge, piece[member // 3])
    # The two sides of a sheet, which cancel in every half-plane, are one sheet with others that end at the edge.
    plane = _numbered(own[around.half_edge], around.plane)
    thick = np.bincount(plane, np.where(around.opens, 1, -1))[plane] != 0
    has_thickness = np.zeros(own.max(initial=0) + 1, bool)
    has_thickness[own[around.half_edge[thick]]] = True
    sheet = ~has_thickness[own[member]]
    unbalanced = np.bincount(own[member], way)[own[member]] != 0
    sheets = _chain(member[sheet] // 3, edge[sheet])
    member, edge = member[unbalanced], edge[unbalanced]
    lies = np.zeros(len(edges.tail), bool)
    lies[around.half_edge] = True
    around = around.select(np.isin(around.half_edge, member))
    surplus = np.bincount(around.group, np.where(around.opens, 1, -1), minlength=len(edges.uses))
    entangled = surplus[edge] != 0
    clumped = entangled | ~lies[member]
    together = _chain(member[clumped] // 3, 2 * edge[clumped] + entangled[clumped])
    around = _as_if_exact(around.select(surplus[around.group] == 0))
    pairs, ties = _brackets(vertices, faces, edges, around)
    pairs = np.concatenate([sheets, together, pairs])
    return np.concatenate([pairs, _untied(ties, pairs, piece)]) if ties else pairs


def crowded(
    vertices: Float,
    faces: Int,
    edges: HalfEdges,
    body: Int,
    turned: Bool,
    contact: float,
    among: Bool | None = None,
) -> tuple[Int, Float]:
    """Find edges around which the material of one body counts twice.

    Parameters
    ----------
    body : (m,), the body of each face; −1 leaves it out
    turned : (m,), faces to be read with the opposite winding
    contact : wedges of material that are no deeper than this do not count
    among : (3 m,), the directed edges that are looked at; all unless given

    Returns
    -------
    triangles, places : (k,) a face at each such edge, (k, 3) the middles of the edges
    """
    member = edges.by_edge[(edges.uses > 2)[edges.edge[edges.by_edge]]]
    member = member[body[member // 3] >= 0]
    if among is not None:
        member = member[among[member]]
    around = fans(vertices, faces, edges, member, _numbered(edges.edge[member], body[member // 3]))
    if len(around.group) == 0:
        return np.empty(0, np.int64), np.empty((0, 3))
    planes, groups, _, times, _, depth = _wedges(around, np.where(around.opens != turned[around.half_edge // 3], 1, -1))
    deep = depth > contact
    most = np.maximum.reduceat(np.where(deep, times, -len(times)), groups)
    least = np.minimum.reduceat(np.where(deep, times, len(times)), groups)
    half_edge = around.half_edge[planes[groups[most - least > 1]]]
    ends = np.stack([vertices[edges.tail[half_edge]], vertices[edges.head[half_edge]]])
    return half_edge // 3, ends[0] / 2 + ends[1] / 2


def _wedges(around: Fans, step: Int) -> tuple[Int, Int, Int, Int, Float, Float]:
    """Look at the wedges between half-planes, each behind one of them as the angle grows.

    Returns
    -------
    planes, groups : (p,) where triangles of a half-plane begin, (g,) where half-planes of a group do among these
    after : (p,), the half-plane behind the wedge
    times : (p,), how often material counts in it, more than ahead of the group's first half-plane
    width, depth : (p,), its angle, and its thickness at the lower one of the triangles beside it; 0 where rounding may
        have made it
    """
    planes, _ = _runs(around.plane)
    groups, _ = _runs(around.group[planes])
    count = np.diff(np.append(groups, len(planes)))
    times = np.cumsum(np.add.reduceat(step, planes))
    times -= np.repeat(np.append(0, times)[groups], count)
    height, angle = np.maximum.reduceat(around.height, planes), around.angle[planes]
    after = np.arange(1, len(planes) + 1)
    after[groups + count - 1] = groups
    width = np.where(after > np.arange(len(planes)), angle[after] - angle, angle[after] + 2 * np.pi - angle)
    depth = np.sin(np.clip(width, 0, np.pi / 2)) * np.minimum(height, height[after])
    blur = np.minimum.reduceat(around.blur, planes)
    depth[width <= blur + blur[after]] = 0
    return planes, groups, after, times, width, depth


def _as_if_exact(around: Fans) -> Fans:
    """Make one half-plane of two between which material lies on other material, as thin as rounding makes it.

    As where they are one exactly, what ends there comes before what begins then. Where material fills the space around
    an edge or none does, but for such wedges, it is taken to fill it.
    """
    if len(around.group) == 0:
        return around
    planes, groups, after, times, width, depth = _wedges(around, np.where(around.opens, 1, -1))
    thin = (width <= CONTACT) | (depth == 0)
    count = np.diff(np.append(groups, len(planes)))
    most = np.maximum.reduceat(np.where(thin, -len(times), times), groups)
    least = np.minimum.reduceat(np.where(thin, len(times), times), groups)
    base = np.minimum.reduceat(times, groups)
    level = times - np.repeat(np.where(most == least, np.minimum(base, least - 1), base), count)
    begins, ends = (np.add.reduceat(which.astype(np.int64), planes) for which in (around.opens, ~around.opens))
    joined = thin & (level > 1) & (ends[after] <= level - begins)
    if not joined.any():
        return around
    new, last = np.ones(len(planes), bool), groups + count - 1
    new[1:] = ~joined[:-1]
    new[groups] = True
    plane = np.cumsum(new) - 1
    number = np.arange(len(plane))
    wraps = joined[last]
    number[plane[last[wraps]]] = plane[groups[wraps]]  # round the whole turn
    plane = number[np.repeat(plane, np.diff(np.append(planes, len(around.plane))))]
    around = replace(around, plane=plane)
    return around.select(np.lexsort((around.opens, plane)))


def layered(vertices: Float, faces: Int, edges: HalfEdges, body: Int, turned: Bool) -> Bool:
    """Say around which edges (e,) of more than two triangles material may count twice, however thin a wedge of it is.

    Parameters
    ----------
    body : (m,), the body of each face, each of which has material somewhere around its edges and none elsewhere
    turned : (m,), faces to be read with the opposite winding
    """
    member = np.flatnonzero((edges.uses > 2)[edges.edge])
    around = fans(vertices, faces, edges, member, edges.edge[member])
    face = around.half_edge // 3
    step = np.where(around.opens != turned[face], 1, -1)
    there, solid = (np.bincount(which, minlength=len(edges.uses)) for which in (edges.edge[member], around.group))
    unsure: Bool = there != solid  # where a triangle has no area
    if len(face) == 0:
        return unsure
    # How often each body has material from a half-plane on, less what it has before the first one.
    own = np.lexsort((around.plane, body[face], around.group))
    starts, _ = _runs(np.column_stack([around.group, body[face], around.plane])[own])
    before = np.cumsum(step[own])[np.append(starts[1:], len(own)) - 1]
    of_body, first = _runs(np.column_stack([around.group, body[face]])[own][starts])
    before -= np.append(0, before)[first]
    group = around.group[own][starts][of_body]
    last = np.append(of_body[1:], len(starts)) - 1
    unsure[group[before[last] != 0]] = True
    outside = np.bincount(group, np.minimum.reduceat(before, of_body), len(edges.uses))
    planes, _ = _runs(around.plane)
    times = np.cumsum(step)[np.append(planes[1:], len(step)) - 1]
    groups, first = _runs(around.group[planes])
    times -= np.append(0, times)[first]
    most = np.maximum.reduceat(times, groups)
    which = around.group[planes][groups]
    unsure[which] |= most - outside[which] > 1
    return unsure


def _apex(faces: Int, half_edge: Int) -> Int:
    """Return the third corner of the triangle of each directed edge."""
    apex: Int = faces.ravel()[half_edge // 3 * 3 + (half_edge + 2) % 3]
    return apex


def _precedes(a: Float, b: Float) -> Bool:
    """Say which points (k, 3) come before others in the order of their coordinates."""
    differs = a != b
    first = differs.argmax(axis=1)[:, None]
    before: Bool = (np.take_along_axis(a, first, 1) < np.take_along_axis(b, first, 1))[:, 0]
    return before


def _runs(values: Int) -> tuple[Int, Int]:
    """Return where runs of equal numbers (k,) or rows (k, n) start, and for each place the start of its run."""
    first = np.ones(len(values), bool)
    differs = values[1:] != values[:-1]
    first[1:] = differs if differs.ndim == 1 else differs.any(axis=1)
    starts = np.flatnonzero(first)
    return starts, starts[np.cumsum(first) - 1]


def _orientation(a: Float, b: Float, c: Float, d: Float) -> Sign:
    signs = [orient3d(*(p[k : k + _AT_ONCE] for p in (a, b, c, d))) for k in range(0, len(a), _AT_ONCE)]
    return np.concatenate([np.empty(0, np.int8), *signs])


def _normal_signs(u: Float, v: Float, w: Float) -> Sign:
    """Return the signs of the components of (v − u) × (w − u), (k, 3); all zero where the points lie on a line."""
    signs = []
    for axis in range(3):
        flat = [np.column_stack([p[:, (axis + 1) % 3], p[:, (axis + 2) % 3], np.zeros(len(p))]) for p in (u, v, w)]
        # The fourth point is right above the first: what is left is the determinant in the plane.
        signs.append(_orientation(flat[0], flat[1], flat[2], flat[0] + [0, 0, 1]))
    return np.stack(signs, axis=1)


def _normals(u: Float, v: Float, w: Float) -> tuple[Float, Float, Bool]:
    """Return rounded unit normals (3, k) of triangles, heights of w over u→v, and where the directions are sure."""
    with np.errstate(all="ignore"):
        along, arm = (np.ascontiguousarray((p - u).T) for p in (v, w))
        exponent = int(np.frexp(max(np.abs(along).max(initial=0.0), np.abs(arm).max(initial=0.0)))[1])
        (ax, ay, az), (bx, by, bz) = np.ldexp(along, -exponent), np.ldexp(arm, -exponent)
        normal = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
        size, base, side = (np.sqrt(x * x + y * y + z * z) for x, y, z in (normal, (ax, ay, az), (bx, by, bz)))
        sure = (size > _TELLING * base * side) & (size < np.inf)
        return np.nan_to_num(normal / size), np.ldexp(np.nan_to_num(size / base), exponent), sure


def _angles(along: Float, normal: Float, reference: Int) -> Float:
    """Return rounded angles of half-planes around an edge (k, 3) from the one at `reference` on, by normals (3, k)."""
    (ax, ay, az), (x, y, z), (px, py, pz) = along.T, normal, normal[:, reference]
    with np.errstate(all="ignore"):
        sine = ax * (py * z - pz * y) + ay * (pz * x - px * z) + az * (px * y - py * x)
        cosine = px * x + py * y + pz * z
        angle = np.arctan2(sine / np.sqrt(ax * ax + ay * ay + az * az), cosine)
    turned: Float = np.nan_to_num(angle % (2 * np.pi))
    return turned


def _blur(u: Float, v: Float, w: Float, height: Float) -> Float:
    """Return by what angle a last digit of points turns half-planes from u→v through w, (k,) heights above it.

    Where w lies beyond an end of a short edge, that of its ends counts as often as it is far.
    """
    with np.errstate(over="ignore", under="ignore", divide="ignore", invalid="ignore"):
        (ax, ay, az), (bx, by, bz) = (np.ascontiguousarray((p - u).T) for p in (v, w))
        share = (ax * bx + ay * by + az * bz) / (ax * ax + ay * ay + az * az)
        blur: Float = (1 + np.abs(share) + np.abs(1 - share)) / height
    return blur


def _sorted_exactly(order: Int, group: Int, quarter: Sign, u: Float, v: Float, w: Float) -> Bool:
    """Mend an order (k,) that rounded angles gave, in place; say where the next triangle lies in another half-plane."""
    before, after = order[:-1], order[1:]
    beyond = (group[before] != group[after]) | (quarter[before] != quarter[after])
    open_half = ~beyond & (quarter[before] % 2 == 1)
    sign = np.zeros(len(beyond), np.int8)
    check = np.flatnonzero(open_half)
    while len(check):
        i, j = order[check], order[check + 1]
        sign[check] = _orientation(u[i], v[i], w[i], w[j])
        wrong = np.flatnonzero(sign < 0)
        # Of neighbouring exchanges every other one at a time.
        _, start = _runs(wrong - np.arange(len(wrong)))
        swap = wrong[(np.arange(len(wrong)) - start) % 2 == 0]
        order[swap], order[swap + 1] = order[swap + 1], order[swap]
        check = np.unique(np.concatenate([swap - 1, swap, swap + 1]))
        check = check[(check >= 0) & (check < len(sign))]
        check = check[open_half[check]]
    apart: Bool = beyond | (sign > 0)
    return apart


def _numbered(one: Int, other: Int) -> Int:
    """Number the different pairs of two arrays (k,), whose entries are no less than 0, in their order."""
    return np.unique(one * (other.max(initial=0) + 1) + other, return_inverse=True)[1]


def _chain(triangle: Int, group: Int) -> Int:
    """Return pairs that link all triangles of a group."""
    order = np.argsort(group, kind="stable")
    same = np.diff(group[order]) == 0
    return np.column_stack([triangle[order][:-1][same], triangle[order][1:][same]])


def _brackets(vertices: Float, faces: Int, edges: HalfEdges, around: Fans) -> tuple[Int, list[_Tie]]:
    """Pair each triangle that opens with the one that closes it.

    Returns
    -------
    pairs : (k, 2), triangles
    ties : the pairs in which several triangles lie in one half-plane, in an order of their coordinates
    """
    # On each level what begins and what ends take turns, round and round.
    level = np.cumsum(np.where(around.opens, 1, -1)) + ~around.opens
    order = np.lexsort((level, around.group))
    _, start = _runs(np.column_stack([around.group, level])[order])
    last = np.append(start[1:] != start[:-1], True)[: len(order)]
    partner = np.empty_like(order)
    partner[order] = order[np.where(last, start, np.arange(1, len(order) + 1))]
    triangle = around.half_edge // 3
    alike = np.column_stack([around.plane, around.opens])
    starts, run = _runs(alike)
    several = np.diff(np.append(starts, len(run)))[np.searchsorted(starts, run)] > 1
    opening = np.flatnonzero(around.opens)
    tied = several[opening] | several[partner[opening]]
    simple = opening[~tied]
    pairs = np.column_stack([triangle[simple], triangle[partner[simple]]])
    opening = opening[tied]
    half_edge = around.half_edge[opening]
    ends = vertices[edges.tail[half_edge]], vertices[edges.head[half_edge]]
    closing_end, other_end = (end.T for end in ends)  # what opens runs downwards
    ranked = np.lexsort((opening, *closing_end[::-1], *other_end[::-1]))
    apex = vertices[_apex(faces, around.half_edge)]
    stop = np.append(starts[1:], len(run))[np.searchsorted(starts, run)]

    @cache
    def candidates(first: int, last: int) -> tuple[int, list[int]]:  # one list for all ties of a half-plane
        own = np.arange(first, last)
        return first, triangle[own[np.lexsort(apex[own].T[::-1])]].tolist()

    both = zip(opening[ranked].tolist(), partner[opening[ranked]].tolist(), strict=True)
    return pairs, [(candidates(run[one], stop[one]), candidates(run[other], stop[other])) for one, other in both]


def _untied(ties: list[_Tie], pairs: Int, piece: Int) -> Int:
    """Choose who belongs together in ties: those of one piece, if there are two, and else the first."""
    root: dict[int, int] = {}

    def find(number: int) -> int:
        while (above := root.get(number, number)) != number:
            root[number] = root.get(above, above)
            number = above
        return number

    def join(a: int, b: int) -> None:
        root[find(a)] = find(b)

    for a, b in piece[pairs].tolist():
        join(a, b)
    unpaired: dict[int, list[int]] = {}
    partners = []
    for (first, opening), (second, closing) in ties:
        ones, others = unpaired.setdefault(first, opening), unpaired.setdefault(second, closing)
        first_of = {find(int(piece[b])): b for b in reversed(others)}
        one = next((a for a in ones if find(int(piece[a])) in first_of), ones[0])
        other = first_of.get(find(int(piece[one])), others[0])
        ones.remove(one)
        others.remove(other)
        join(int(piece[one]), int(piece[other]))
        partners.append((one, other))
    return np.array(partners, np.int64).reshape(-1, 2)
