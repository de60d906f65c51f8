"""Intersections of triangle surfaces, and whether two bodies overlap.

Bodies can overlap without a crossing, one inside the other or with faces in common planes. Whatever is common
to two bodies is bounded by parts of their surfaces, and where no triangles cross, a triangle is cut into
parts only by edges that lie in its plane. So a place is tried just inside each triangle, beside each such
edge and inside each crossing: if the bodies overlap, one of these places is inside both.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int, Progress
from inertia.mesh.geometry.boxes import CELLS, BoxTree, overlapping
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.contact_depth import contact_depth
from inertia.mesh.geometry.edges import first_equal
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.hubs import hubs, near_around
from inertia.mesh.geometry.oriented_boxes import OrientedBoxes
from inertia.mesh.geometry.triangle_pairs import crossing, heights_over, held_apart, unit, unit_normals
from inertia.mesh.geometry.winding import windings
from inertia.mesh.surface import Surface, Triangles
from inertia.native import Kernel
from inertia.records import dataclass

_MODULE = "inertia.mesh.geometry.crossing_kernel"
CODES = Kernel(_MODULE, "morton_codes", "pipidpp")
ENCLOSE = Kernel(_MODULE, "enclose", "pippi" + "dddd" + "pp")
COMPILED = Kernel(_MODULE, "find_crossings", "ppppi" + "pppp" + "iip")

_WORK = (
    4  # times what integrating a triangle costs: compiling, 6 s once for a machine, is for 100,000 triangles or more
)
_STEPS = 1 << 22  # pairs of boxes opened in a call, and
_CROSSED = 1 << 16  # crossings listed at most
_PATIENCE = 32  # pairs of boxes, over the number of triangles, that are opened before it is asked whether these slant
_SAMPLE = 64  # triangles of which this is asked,
_MANY = 1000  # how many others' boxes overlap theirs on average where it matters, and
_FEW = 0.02  # what share of those overlap along other axes too, at most
_SCRATCH = 18 + 192  # numbers, as `crossing_kernel.exact_sign` asks
_STEPPED = 1 << 16  # triangles whose keys are computed at a time, by
_FACTORS = np.array([0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB], np.uint64)  # of SplitMix64
_LARGEST = 1000  # exponent of a power of two that coordinates are multiplied by
EXAMINED = 200_000
"""Triangles up to which crossings are looked for without being asked: a tenth of a second."""
FACING = 0.02
"""|Sum of two unit normals| below which two faces face each other."""


def to_be_examined(triangles: Triangles, intersections: bool | None, crowded: int = 0) -> bool:
    """Say whether crossings are to be looked for: as is asked, or else in a surface of up to 200,000 triangles.

    Where there are `crowded` edges, of more than two triangles, they are looked for in any.
    """
    return triangles.count <= EXAMINED or crowded > 0 if intersections is None else bool(intersections)


@dataclass(frozen=True, eq=False)
class Crossings:
    """Pairs of triangles that cross.

    Attributes
    ----------
    pairs : (k, 2), triangle numbers in a and in b; the first k in ascending order
    points : (k, 3), the middle of the segment that the two share, in file units
    total : number of pairs that cross, those not listed included
    truncated : whether `total` exceeds k
    """

    pairs: Int
    points: Float
    total: int
    truncated: bool


def crossings(
    a: Triangles,
    b: Triangles | None = None,
    limit: int = 100,
    progress: Progress | None = None,
    labels: NDArray[np.integer[Any]] | None = None,
) -> Crossings:
    """Find the triangles of `a` that cross triangles of `b`, or one another where `b` is None.

    What a crossing is, `inertia.mesh.geometry.triangle_pairs` says; triangles that overlap in one plane are not among
    them, and triangles without area cross nothing. Coordinates must be finite.

    Parameters
    ----------
    limit : pairs listed at most; all are counted
    labels : (n,) of the triangles of `a`, where those of different labels are not to be compared with one another

    >>> from inertia.mesh.part import Surface
    >>> flat = Surface([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> upright = Surface([[1, 1, -1], [1, 1, 1], [9, 9, 1]], [[0, 1, 2]])
    >>> crossings(flat, upright).points
    array([[1.5, 1.5, 0. ]])
    """
    copies, runs = _searched(a, b, None if labels is None else np.asarray(labels, np.int64))
    pairs, points, total = np.empty((0, 2), np.int64), np.empty((0, 3)), 0
    for crossed, places, done in runs:
        if len(crossed):
            if copies is None:
                total += len(crossed)
            else:
                crossed, places, number = copies.crossed(crossed, places, limit)
                total += number
            pairs, points = np.vstack([pairs, crossed]), np.vstack([points, places])
            first = np.lexsort(pairs.T[::-1])[:limit]
            pairs, points = pairs[first], points[first]
        if progress is not None:
            progress(done)
    return Crossings(pairs, points, total, total > len(pairs))


def crosses(a: Triangles, b: Triangles | None = None, *, labels: NDArray[np.integer[Any]] | None = None) -> bool:
    """Say whether a triangle of `a` crosses one of `b`, or another of `a` where `b` is None: see `crossings`."""
    of = None if labels is None else np.asarray(labels, np.int64)
    return any(len(crossed) for crossed, _, _ in _searched(a, b, of)[1])


Crossed = Iterator[tuple[Int, Float, float]]
"""Pairs (k, 2) of triangles that cross, the middles (k, 3) of their common segments, and the fraction done."""


@dataclass(frozen=True, eq=False)
class _Copies:
    """Triangles of the same corners, which cross the same others and not one another.

    Attributes
    ----------
    first : (k,), the first of each
    count : (k,), how many there are of each
    members : (n,), all of them, those of one kind together and ascending; kind k begins at `start[k]`
    """

    first: Int
    count: Int
    members: Int
    start: Int

    @classmethod
    def among(cls, triangles: Triangles, labels: Int | None) -> _Copies | None:
        """Find the copies among triangles, of one label each; None where there are none."""
        keys = np.empty(triangles.count, np.uint64)
        for at in range(0, len(keys), _STEPPED):
            words = (triangles.corners(at, at + _STEPPED) + 0.0).view(np.uint64)
            words = (words * _FACTORS).sum(axis=2)
            keys[at : at + _STEPPED] = ((words ^ words >> np.uint64(29)) * _FACTORS[0]).sum(axis=1)
        ranked = np.sort(keys)
        again = ranked[1:][ranked[1:] == ranked[:-1]]
        if len(again) == 0:
            return None
        which = np.flatnonzero(np.isin(keys, again))
        first = np.arange(len(keys))
        rows = np.sort(merge_equal_vertices(triangles.select(which))[1], axis=1)
        if labels is not None:
            rows = np.column_stack([rows, labels[which]])
        first[which] = which[first_equal(rows)]
        members = np.argsort(first, kind="stable")
        firsts, start, count = np.unique(first[members], return_index=True, return_counts=True)
        return None if len(firsts) == len(keys) else cls(firsts, count, members, start)

    def crossed(self, pairs: Int, places: Float, limit: int) -> tuple[Int, Float, int]:
        """Return, for pairs (k, 2) of kinds that cross, pairs of triangles with the first `limit` among them.

        Returns their places and the number of all pairs too. The pair of the a-th copy of one kind and the b-th of the
        other comes after a·b others of the two.
        """
        count = self.count[pairs]
        crossed, where = [], []
        for a in range(min(int(count[:, 0].max()), limit)):
            for b in range(min(int(count[:, 1].max()), limit // (a + 1))):
                here = np.flatnonzero((count > (a, b)).all(axis=1))
                crossed.append(self.members[self.start[pairs[here]] + (a, b)])
                where.append(places[here])
        return np.sort(np.concatenate(crossed), axis=1), np.concatenate(where), int((count[:, 0] * count[:, 1]).sum())


def _crossings_at_hubs(triangles: Triangles, vertices: Float, faces: Int, hub: Int, labels: Int | None) -> Crossed:
    """Yield what `vectorised_crossings` does, of triangles that meet in great numbers at some vertices."""
    left = np.flatnonzero(hub < 0)
    plain = compiled_crossings if COMPILED.worthwhile(_WORK * len(left)) else vectorised_crossings
    for pairs, places, done in plain(triangles.select(left), None if labels is None else labels[left]):
        yield left[pairs], places, 0.5 * done
    vertices_of = np.unique(hub[hub >= 0]).tolist()
    for k, vertex in enumerate(vertices_of):
        own = np.flatnonzero(hub == vertex)
        among = near_around(vertices, faces[own], vertex)
        between = near_pairs(vertices, faces[own], faces[left], crossing=True)
        for near, those in ((among, own), (between, left)):
            for i, j, _ in near:
                i, j = _of_one_label(labels, own[i], those[j])
                crossed, places = crossing(vertices, faces[i], faces[j])
                pairs = np.column_stack([i[crossed], j[crossed]])
                yield np.sort(pairs, axis=1), places, 0.5 + 0.5 * k / len(vertices_of)
        left = np.concatenate([left, own])


def _of_one_label(labels: Int | None, i: Int, j: Int) -> tuple[Int, Int]:
    """Return those of pairs of triangles that are to be compared."""
    same = slice(None) if labels is None else labels[i] == labels[j]
    return i[same], j[same]


def vectorised_crossings(triangles: Triangles, labels: Int | None = None) -> Crossed:
    """Yield the triangles that cross one another, of one label where there are `labels` (n,), by numpy."""
    vertices, faces = merge_equal_vertices(triangles)
    for i, j, done in near_pairs(vertices, faces, None, crossing=True):
        i, j = _of_one_label(labels, i, j)
        crossed, places = crossing(vertices, faces[i], faces[j])
        yield np.column_stack([i[crossed], j[crossed]]), places, done


@dataclass(frozen=True, eq=False)
class CompiledTree:
    """Triangles in order along a space-filling curve, under boxes that enclose 1, 2, 4, ... of them, for kernels.

    Attributes
    ----------
    order : (n,), numbers of the triangles in order
    corners : (n, 9), theirs, times a power of two
    boxes : (2 n + 64, 6) float32, least and greatest coordinates; those of level k begin at `starts[k]`
    levels : how many there are
    """

    order: Int
    corners: Float
    boxes: NDArray[np.float32]
    starts: Int
    levels: int

    @classmethod
    def over(cls, triangles: Triangles, rank: Int | None = None) -> CompiledTree | None:
        """Build it, of triangles by their `rank` (n,) first where there is one; None where a power of two rounds."""
        count = triangles.count
        if isinstance(triangles, Surface):
            vertices, faces = triangles.vertices, triangles.faces
        else:
            vertices, faces = triangles.corners().reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)
        surface = _address(vertices), len(vertices), _address(faces)
        box, codes = np.empty((2, 3)), np.empty(count, np.uint64)
        CODES.function(*surface, count, CELLS, _address(box), _address(codes))
        if rank is not None:
            bits = int(rank.max()).bit_length()
            codes >>= np.uint64(bits)
            codes |= rank.astype(np.uint64) << np.uint64(64 - bits) if bits else np.uint64(0)
        order = np.argsort(codes)
        scale = 2.0 ** -min(max(int(np.frexp(np.abs(box).max())[1]), -_LARGEST), _LARGEST)
        own, boxes = np.empty((count, 9)), np.empty((2 * count + 64, 6), np.float32)
        middle = (scale * box[0] / 2 + scale * box[1] / 2).tolist()
        if ENCLOSE.function(*surface, _address(order), count, *middle, scale, _address(own), _address(boxes)):
            return None
        starts = np.zeros(64, np.int64)
        levels, size = 0, count
        while size > 0:
            levels += 1
            starts[levels] = starts[levels - 1] + size
            size = (size + 1) // 2 if size > 1 else 0
        return cls(order, own, boxes, starts, levels)


def _searched(a: Triangles, b: Triangles | None, labels: Int | None = None) -> tuple[_Copies | None, Crossed]:
    """Return what finds the crossings by whatever takes least, and the copies of triangles that it leaves out."""
    if b is not None:
        return None, _crossings_between(a, b)
    copies = _Copies.among(a, labels)
    if copies is None:
        alone = a
    else:
        alone, labels = a.select(copies.first), None if labels is None else labels[copies.first]
    if (fans := hubs(alone)) is not None:
        return copies, _crossings_at_hubs(alone, *fans, labels)
    plain = compiled_crossings if COMPILED.worthwhile(_WORK * a.count) else vectorised_crossings
    return copies, plain(alone, labels)


def compiled_crossings(triangles: Triangles, labels: Int | None = None) -> Crossed:
    """Yield what `vectorised_crossings` does, in another order, by the compiled kernel."""
    count = triangles.count
    if not count:
        return
    tree = CompiledTree.over(triangles)
    if tree is None:
        yield from vectorised_crossings(triangles, labels)
        return
    stack, state = np.zeros((256, 3), np.int64), np.zeros(9, np.int64)
    stack[0, 0], state[0] = tree.levels - 1, 1
    work, pairs = np.empty(_SCRATCH), np.empty((_CROSSED, 2), np.int64)
    own = np.zeros(count, np.int64) if labels is None else labels
    of_tree = _address(tree.corners), _address(tree.boxes), _address(tree.order), _address(own), count
    tables = *of_tree, _address(work), _address(stack), _address(tree.starts)
    COMPILED.function(*tables, _address(pairs), _CROSSED, _PATIENCE * count, _address(state))
    if state[0] and state[1] < _CROSSED // 2 and slanted(triangles, tree.order):
        yield from vectorised_crossings(triangles, labels)
        return
    while True:
        done = float(state[2] / count) if state[0] else 1.0
        crossed = pairs[: state[1]]
        if not len(crossed):
            yield crossed, np.empty((0, 3)), done
        else:
            vertices, faces = merge_equal_vertices(triangles.select(crossed.ravel()))
            which, places = crossing(vertices, faces[0::2], faces[1::2])
            yield crossed[which], places, done
        if not state[0]:
            return
        COMPILED.function(*tables, _address(pairs), _CROSSED, _STEPS, _address(state))


def slanted(triangles: Triangles, order: Int) -> bool:
    """Say whether far more boxes of triangles overlap along the axes of coordinates than along their own.

    Some of the triangles, taken evenly in `order`, are compared with all others.
    """
    some = order[:: max(len(order) // _SAMPLE, 1)]
    [corners] = _scaled(triangles.corners())
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = [np.flatnonzero((low[k] < high).all(axis=1) & (low < high[k]).all(axis=1)) for k in some.tolist()]
    if np.mean([len(others) for others in near]) < _MANY:
        return False
    near = [others[:: len(others) // _SAMPLE + 1] for others in near]
    own, others = np.repeat(some, [len(others) for others in near]), np.concatenate(near)
    one, other = (OrientedBoxes.around(corners[which], highest=0) for which in (own, others))
    every = np.arange(len(own))
    return bool(one.meeting(other, 0, every, every).mean() < _FEW)


def _address(array: NDArray[Any]) -> int:
    return int(array.ctypes.data)


def _crossings_between(a: Triangles, b: Triangles) -> Crossed:
    """Yield the triangles of `a` that cross triangles of `b`, by numpy."""
    numbers_a, numbers_b = _in_common_box(a, b)
    vertices, faces_a, faces_b = _welded_together(a.select(numbers_a), b.select(numbers_b))
    for i, j, done in near_pairs(vertices, faces_a, faces_b, crossing=True):
        crossed, places = crossing(vertices, faces_a[i], faces_b[j])
        yield np.column_stack([numbers_a[i[crossed]], numbers_b[j[crossed]]]), places, done


def overlap(a: Triangles, b: Triangles, contact: float = 0.0) -> tuple[float, float, float] | None:
    """Return a place inside both of two bodies, or None.

    The bodies are bounded by closed, outward surfaces (cavities inward) with finite coordinates. They only
    touch where they share no place deeper in both than 1e-6 of the smaller one's extent, or four times the
    last digit of the largest coordinate, if that is more: rounding alone makes faces that touch cross. Where that is
    still less than `contact`, a length, `contact` counts: meshes of one curved surface cross as deep as their chords.

    >>> from inertia.mesh.part import Surface
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    >>> one = Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces)
    >>> overlap(one, Surface(one.vertices + 0.1, faces)) is None
    False
    >>> overlap(one, Surface(one.vertices + [1, 0, 0], faces)) is None
    True
    """
    if a.count == 0 or b.count == 0:
        return None
    vertices, faces_a, faces_b = _welded_together(a, b)
    boxes = [(vertices[faces].min(axis=(0, 1)), vertices[faces].max(axis=(0, 1))) for faces in (faces_a, faces_b)]
    low, high = np.maximum(boxes[0][0], boxes[1][0]), np.minimum(boxes[0][1], boxes[1][1])
    if (high <= low).any():
        return None
    size = min(float((most - least).max()) for least, most in boxes)
    depth = max(contact, contact_depth(vertices, size))
    # Only what is above or below a place counts in its winding number.
    faces_a, faces_b = (_above_and_below(vertices, faces, low, high) for faces in (faces_a, faces_b))
    centre, exponent = low / 2 + high / 2, int(np.frexp(size)[1])
    vertices, depth = np.ldexp(vertices - centre, -exponent), float(np.ldexp(depth, -exponent))
    for inside, least in _places(vertices, faces_a, faces_b, depth):
        for faces in (faces_a, faces_b):
            if len(inside):
                winding, clearance = windings(inside, vertices[faces], depth)
                inside = inside[(winding > 0) & (clearance >= least)]
        if len(inside):
            x, y, z = (np.ldexp(inside[0], exponent) + centre).tolist()
            return x, y, z
    return None


def _above_and_below(vertices: Float, faces: Int, low: Float, high: Float) -> Int:
    """Return the faces that meet lines along z through a box."""
    corners = vertices[faces][:, :, :2]
    meets = ((corners.min(axis=1) <= high[:2]) & (low[:2] <= corners.max(axis=1))).all(axis=1)
    return faces[np.flatnonzero(meets)]


def _in_common_box(a: Triangles, b: Triangles) -> tuple[Int, Int]:
    """Return the triangles of each surface that reach into the box of the other."""
    boxes = [(corners.min(axis=1), corners.max(axis=1)) for corners in (a.corners(), b.corners())]
    in_a, in_b = (
        np.flatnonzero(
            ((low <= highs.max(axis=0, initial=-np.inf)) & (lows.min(axis=0, initial=np.inf) <= high)).all(axis=1)
        )
        for (low, high), (lows, highs) in zip(boxes, reversed(boxes), strict=True)
    )
    return in_a, in_b


def _welded_together(a: Triangles, b: Triangles) -> tuple[Float, Int, Int]:
    """Return common vertices, and the faces of both surfaces over them."""
    corners = np.concatenate([a.corners(), b.corners()]).reshape(-1, 3)
    vertices, faces = merge_equal_vertices(Surface(corners, np.arange(len(corners)).reshape(-1, 3)))
    return vertices, faces[: a.count], faces[a.count :]


def near_pairs(
    vertices: Float, faces_a: Int, faces_b: Int | None, *, touching: bool = False, crossing: bool = False
) -> Iterator[tuple[Int, Int, float]]:
    """Yield pairs of faces whose boxes overlap, and the fraction done; see `overlapping`.

    Those that are sure not to cross may be left out where `crossing` is what matters.
    """
    if len(faces_a) == 0 or (faces_b is not None and len(faces_b) == 0):
        return
    both = [vertices[faces] for faces in (faces_a, faces_b) if faces is not None]
    local = _scaled(*both) if crossing else [None, None]
    trees = [BoxTree(k.min(axis=1), k.max(axis=1), corners=own) for k, own in zip(both, local, strict=False)]
    yield from overlapping(*trees, touching=touching)


def _scaled(*surfaces: Float) -> list[Float]:
    """Return triangles about one middle, times a power of two with which no coordinate is larger than 1."""
    low = np.min([corners.min(axis=(0, 1)) for corners in surfaces], axis=0)
    high = np.max([corners.max(axis=(0, 1)) for corners in surfaces], axis=0)
    exponent = int(np.frexp((high / 2 - low / 2).max())[1])
    return [np.ldexp(corners - (low / 2 + high / 2), -exponent) for corners in surfaces]


def _places(vertices: Float, faces_a: Int, faces_b: Int, depth: float) -> Iterator[tuple[Float, float]]:
    """Yield places (k, 3), and how clear of the surfaces one must be to show that the bodies overlap.

    Of all the places one is inside both bodies, if anything is and lies deeper than `depth`.
    """
    normals_a, normals_b = unit_normals(vertices[faces_a]), unit_normals(vertices[faces_b])
    near_a, near_b = np.zeros(len(faces_a), bool), np.zeros(len(faces_b), bool)
    for i, j, _ in near_pairs(vertices, faces_a, faces_b, touching=True):
        corners_a, corners_b = vertices[faces_a[i]], vertices[faces_b[j]]
        over_a = heights_over(corners_a, normals_a[i], corners_b)
        over_b = heights_over(corners_b, normals_b[j], corners_a)
        passes_a, passes_b = (~held_apart(over, depth) for over in (over_a, over_b))
        both, of_a, of_b = (np.flatnonzero(which) for which in (passes_a & passes_b, passes_a, passes_b))
        near_a[i[both]] = near_b[j[both]] = True
        crossed, middles = crossing(vertices, faces_a[i[both]], faces_b[j[both]])
        crossed = both[crossed]
        inwards = -(normals_a[i[crossed]] + normals_b[j[crossed]])
        size = np.linalg.norm(inwards, axis=1, keepdims=True)
        apart = size[:, 0] > FACING
        yield middles[apart] + 2 * depth * inwards[apart] / size[apart] ** 2, depth / 2
        beside = [
            beside_edges(vertices, faces_a[i[of_a]], normals_a[i[of_a]], faces_b[j[of_a]], over_a[of_a], depth),
            beside_edges(vertices, faces_b[j[of_b]], normals_b[j[of_b]], faces_a[i[of_b]], over_b[of_b], depth),
        ]
        yield np.concatenate(beside), depth / 2
    for faces, normals, near in ((faces_a, normals_a, near_a), (faces_b, normals_b, near_b)):
        clear = np.flatnonzero(~near & normals.any(axis=1))
        # What hangs together without coming near the other body is inside it all or not at all.
        _, first = np.unique(closure(Surface(vertices, faces[clear])).labels, return_index=True)
        tried = np.concatenate([np.flatnonzero(near), clear[first]])
        yield vertices[faces[tried]].mean(axis=1) - depth * normals[tried], 0.0


def beside_edges(vertices: Float, faces: Int, normals: Float, others: Int, over: Float, depth: float) -> Float:
    """Return places under `faces`, on both sides of those edges of `others` that lie in and cut them.

    `over` (k, 3) are the heights of the corners of `others` over `faces`.
    """
    level = np.abs(over) < depth / 2
    places = []
    for tail, head in ((0, 1), (1, 2), (2, 0)):
        # A closed surface has every edge both ways: one of them is enough.
        lies = np.flatnonzero(level[:, tail] & level[:, head] & (others[:, tail] < others[:, head]))
        u, v = (vertices[others[lies, end]] for end in (tail, head))
        inside, normal = vertices[faces[lies]], normals[lies]
        start, stop = np.zeros(len(u)), np.ones(len(u))
        for k in range(3):
            inwards = unit(np.cross(normal, inside[:, (k + 1) % 3] - inside[:, k]))
            at_u, at_v = (np.einsum("kj,kj->k", end - inside[:, k], inwards) - depth for end in (u, v))
            rise = at_v - at_u
            root = np.divide(-at_u, rise, out=np.where(at_u < 0, np.inf, -np.inf), where=rise != 0)
            start = np.where(rise >= 0, np.maximum(start, root), start)
            stop = np.where(rise < 0, np.minimum(stop, root), stop)
        cuts = start < stop
        u, v, normal = u[cuts], v[cuts], normal[cuts]
        middle = u + ((start + stop)[cuts] / 2)[:, None] * (v - u) - depth * normal
        aside = 8 * depth * unit(np.cross(normal, v - u))
        places += [middle + aside, middle - aside]
    return np.concatenate(places)
