"""Evidence of bodies that share space, and of surfaces that cross."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, groupby

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.errors import SEPARATE, Word
from inertia.mesh.checks.findings import Evidence, listed, middle
from inertia.mesh.checks.near_bodies import Pair, meeting_boxes, near_bodies
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.doubt import Doubt
from inertia.mesh.geometry.closure import Closure, closure
from inertia.mesh.geometry.contact_depth import CONTACT
from inertia.mesh.geometry.edges import Place
from inertia.mesh.geometry.faces import components
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.shells import (
    SLIVER,
    Body,
    absolute_orientation,
    members,
)
from inertia.mesh.geometry.simple import at_hand, not_simple
from inertia.mesh.geometry.winding import misplaced_volume
from inertia.mesh.surface import Surface
from inertia.once import once

TOGETHER = 1 << 14
"""Triangles of pairs of bodies that are looked at together."""

SHARING = 10_000
"""Pairs of bodies that share space that are counted: a second or two."""

_NEXT_TO_NONE = 2.0**-40  # of the smaller of two bodies: a volume that is not measured
_LAST_DIGITS = 2.0**-21  # depth of a contact of float32, at most, over the largest coordinate
_TRIED = 3  # places on a patch at which the winding number is asked for
_CLEAR = 100.0  # how many times deeper than a contact rays must find a crossing, to leave no doubt that it is one
_CROSSINGS = 10_000  # crossings listed
_ROUNDING = 1e-13  # of a volume: less than that is what rays find by rounding alone


_InColumns = tuple[Pair, tuple[Int, Int]]
"""Two bodies, and the triangles of each above and below the other's box."""


def overlapping_bodies(surface: SurfaceTopology) -> Evidence | None:
    """Find bodies that are wound alike and share space, every shell being turned as its depth asks."""
    return _sharing_space(surface, alike=True)


def cutters(surface: SurfaceTopology) -> Evidence | None:
    """Find bodies wound inwards that share space with others that are wound outwards, as a cutter does."""
    return _sharing_space(surface, alike=False)


def contacts(surface: SurfaceTopology) -> Evidence | None:
    """Measure what bodies share that are wound alike, in columns; where it is no fault, it is in doubt."""
    from inertia.mesh.geometry.near_triangles import crossing_triangles, touching_triangles

    doubts, first, places = [], [], []
    for several in near_bodies(surface, alike=True):
        several = [pair for pair in several if pair.depth > 0]
        if not several:
            continue
        corners = several[0].corners
        of_pair, i, j = touching_triangles(corners, [pair.inside_boxes for pair in several])
        asked = range(len(several)) if surface.separate else np.unique(of_pair).tolist()
        shared = _shared(surface, several, asked)
        unclear = [k for k, (_, clear) in shared.items() if not clear]
        which = np.flatnonzero(np.isin(of_pair, unclear))
        crossed = of_pair[which[crossing_triangles(corners, i[which], j[which])]]
        for k in np.setdiff1d(asked, np.setdiff1d(unclear, crossed)).tolist():
            pair = several[k]
            common = np.stack([pair.boxes[:, 0].max(axis=0), pair.boxes[:, 1].min(axis=0)])
            doubts.append(Doubt.within(common, 0.0, shared[k][0]))
            first += [group[0] for group in pair.groups]
            places.append(middle(common))
    doubt = Doubt.joined(doubts)
    if doubt is None:
        return None
    figures = {"tolerance": CONTACT, "least": SLIVER, "volume": doubt.volume, "unit": surface.unit}
    return Evidence(len(doubts), listed(np.array(first)), places[0], figures, doubt=doubt)


def _shared(surface: SurfaceTopology, pairs: Sequence[Pair], asked: Sequence[int]) -> dict[int, tuple[float, bool]]:
    """Return the volume that pairs of bodies share at most, and whether it is sure that they share any."""
    from inertia.mesh.columns.common_volume import common_volumes

    some = [pairs[k] for k in asked]
    smaller = np.array([_smaller(surface, pair.groups) for pair in some])
    most = np.minimum(smaller, _within(some, np.array([pair.depth for pair in some])))
    shared = {k: (least, False) for k, least in zip(asked, most.tolist(), strict=True)}
    more = np.flatnonzero(most > _NEXT_TO_NONE * smaller).tolist()
    volumes = common_volumes(pairs[0].corners, [some[at].in_columns(range(3)) for at in more])
    for at, measured in zip(more, volumes, strict=True):
        pair, least = some[at], float(most[at])
        if measured is not None:
            volume, rounding = measured
            shared[asked[at]] = min(least, max(volume, 0.0) + rounding), volume > rounding
            continue
        if not surface.separate:
            size = float(np.ptp(pair.boxes, axis=1).max(axis=1).min())
            depth = max(CONTACT * size, surface.digits)
            least = min(least, float(_within([pair], np.array([depth]))[0]))
        shared[asked[at]] = least, True
    return shared


def _within(pairs: Sequence[Pair], depth: Float) -> Float:
    """Return the volume that pairs of bodies share at most that share no place deeper than (k,).

    It is near the surface of either, which is that of triangles in the other's box, but for what is at the box's sides.
    """
    most = np.full(len(pairs), np.inf)
    known = np.flatnonzero(depth < np.inf)
    if len(known) == 0:
        return most
    some, deep = [pairs[k] for k in known.tolist()], depth[known]
    boxes = np.array([pair.boxes for pair in some])
    x, y, z = np.maximum(boxes[:, :, 1].min(axis=1) - boxes[:, :, 0].max(axis=1), 0.0).T
    near = np.full(len(some), np.inf)
    for body in range(2):
        which = [pair.inside_boxes[body] for pair in some]
        owner = np.repeat(np.arange(len(some)), [len(own) for own in which])
        corners = some[0].corners[np.concatenate(which)]
        sides = corners - np.roll(corners, 1, axis=1)
        areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)  # of their two faces
        lengths = np.linalg.norm(sides, axis=2).sum(axis=1)
        number, area, length = (np.bincount(owner, each, len(some)) for each in (None, areas, lengths))
        near = np.minimum(near, deep * area + np.pi * deep**2 * length / 2 + 4 / 3 * np.pi * deep**3 * number)
    most[known] = near + 2 * deep * (x * y + y * z + z * x)
    return most


def _sharing_space(surface: SurfaceTopology, *, alike: bool) -> Evidence | None:
    from inertia.mesh.geometry.intersect import overlap

    places: list[Place] = []
    first: list[int] = []
    depths: list[float] = []
    truncated = False
    for several in _several_at_once(surface, alike=alike):
        if truncated := len(first) >= 2 * SHARING:
            break
        sure = _sure_to_share(several) if places and surface.chord is None else np.zeros(len(several), bool)
        for (pair, columns), shared in zip(several, sure.tolist(), strict=True):
            if not shared:
                a, b = (pair.surface.select(which) for which in columns)
                place = overlap(a, b)
                if place is None:
                    place = _place_at_edges(surface, pair)
                if place is None:
                    continue
                places.append(place)
                depths.append(_chord_depth(surface, a, b, pair.groups))
            first += [group[0] for group in pair.groups]
    if not places:
        return None
    advice: tuple[Word, ...] = ()
    if alike and min(depths) > 0 and not truncated:
        depth = f"{max(depths):.2g} {surface.unit}"
        advice = "use ", SEPARATE, f", as they share it no deeper than their triangles' chord tolerances, {depth}, or "
    figures = {"at_least": "at least " if truncated else ""}
    return Evidence(len(first) // 2, listed(np.array(first)), places[0], figures, advice=advice)


def _several_at_once(surface: SurfaceTopology, *, alike: bool) -> Iterator[list[_InColumns]]:
    """Yield pairs of bodies that may share more than next to nothing: the first, and then several at a time."""
    least = SLIVER * sum(abs(shell.signed_volume) for shell in surface.shells)
    several: list[_InColumns] = []
    triangles, most = 0, 0
    for pair in chain.from_iterable(near_bodies(surface, alike=alike)):
        if pair.depth < np.inf or _smaller(surface, pair.groups) <= least:
            continue
        several.append((pair, pair.in_columns([2])))
        triangles += sum(map(len, several[-1][1]))
        if triangles > most:
            yield several
            several, triangles, most = [], 0, TOGETHER
    if several:
        yield several


def _sure_to_share(several: list[_InColumns]) -> Bool:
    """Say of which pairs one look shows that they share space."""
    from inertia.mesh.geometry.common_places import sure_to_share

    pairs, used = zip(*several, strict=True)
    ends = np.cumsum([len(which) for both in used for which in both]).tolist()
    ranges = [np.arange(start, stop) for start, stop in zip([0, *ends], ends, strict=False)]
    boxes = np.array([pair.boxes for pair in pairs])
    size = np.ptp(boxes, axis=2).max(axis=2).min(axis=1)
    depth = _LAST_DIGITS * float(np.abs(pairs[0].surface.vertices).max())
    corners = pairs[0].corners[np.concatenate([which for both in used for which in both])]
    sides = list(zip(ranges[::2], ranges[1::2], strict=True))
    return sure_to_share(corners, sides, boxes[:, :, 0].max(axis=1), boxes[:, :, 1].min(axis=1), size, depth)


def _chord_depth(surface: SurfaceTopology, a: Surface, b: Surface, groups: Sequence[Int]) -> float:
    """Return the depth that the chord tolerances of two bodies explain; 0 where they share space deeper than that."""
    from inertia.mesh.geometry.intersect import overlap

    if surface.chord is None:
        return 0.0
    depth = float(sum(surface.chord[group].max() for group in groups))
    return depth if overlap(a, b, depth) is None else 0.0


def _smaller(surface: SurfaceTopology, groups: Sequence[Int]) -> float:
    """Return the volume of the outer shell of the smaller of two bodies."""
    volumes = [surface.shells[surface.closure.labels[group[0]]].signed_volume for group in groups]
    return float(min(map(abs, volumes)))


def overlap_at_edges(surface: SurfaceTopology) -> Evidence | None:
    """Find edges around which material of one body lies on material of it: shells cannot tell which is which there.

    Shells that are inside out are turned for it; one inside another of the same orientation is not.
    """
    if len(surface.duplicates[0]):  # which are an error by themselves
        return None
    body_of = surface.body_of
    which = surface.crowded
    labels = surface.closure.labels[which]
    inverted = np.isin(labels, [shell.number for shell in surface.in_state("inverted")])
    first, places = _layered(surface, which, body_of[labels], inverted, float(np.ptp(surface.box, axis=0).max()))
    if len(first) == 0:
        return None
    return Evidence(len(first), listed(np.unique(first)), middle(places[np.lexsort(places.T)[:1]]))


def _place_at_edges(surface: SurfaceTopology, pair: Pair) -> Place | None:
    """Return the middle of an edge that two bodies have in common and around which they share space."""
    own = [which[np.isin(which, surface.crowded)] for which in pair.inside_boxes]
    shared = np.intersect1d(surface.faces[own[0]], surface.faces[own[1]])
    which = np.sort(np.concatenate(own))
    which = which[np.isin(surface.faces[which], shared).sum(axis=1) > 1]  # with an edge between two such vertices
    turned = np.isin(surface.closure.labels[which], absolute_orientation(surface.shells))
    size = float(np.ptp(pair.boxes, axis=1).max(axis=1).min())
    _, places = _layered(surface, which, np.zeros(len(which), np.int64), turned, size, shared)
    return middle(places[np.lexsort(places.T)[:1]]) if len(places) else None


def _layered(
    surface: SurfaceTopology, which: Int, body: Int, turned: Bool, size: float, ends: Int | None = None
) -> tuple[Int, Float]:
    """Return a triangle at each edge around which the material of a body counts twice, and the middle of the edge.

    Where `ends` are given, edges between two of these vertices are looked at alone.
    """
    from inertia.mesh.geometry.edge_fans import crowded

    if len(which) == 0:
        return np.empty(0, np.int64), np.empty((0, 3))
    faces = surface.faces[which]
    contact, edges = max(CONTACT * size, surface.digits), half_edges(faces)
    among = None if ends is None else np.isin(edges.tail, ends) & np.isin(edges.head, ends)
    first, places = crowded(surface.vertices, faces, edges, body, turned, contact, among)
    return which[first], places


def crossing_cavities(surface: SurfaceTopology) -> Evidence | None:
    """Find cavities that break through the wall of their body or into one another."""
    from inertia.mesh.geometry.intersect import crossings

    triangles_of = members(surface.closure)
    total = 0
    pairs, points = [], []
    for body, meeting in _meeting_cavities(surface):
        for one, others in groupby(meeting, key=lambda pair: pair[0]):
            a = triangles_of[body.shells[one]]
            b = np.concatenate([triangles_of[body.shells[other]] for _, other in others])
            between = crossings(surface.triangles.select(a), surface.triangles.select(b))
            total += between.total
            pairs.append(np.column_stack([a[between.pairs[:, 0]], b[between.pairs[:, 1]]]))
            points.append(between.points)
    if total == 0:
        return None
    pair, place = np.concatenate(pairs), middle(np.concatenate(points)[:1])
    return Evidence(total, listed(np.unique(pair)), place, {"one": pair[0, 0], "other": pair[0, 1]})


def _meeting_cavities(surface: SurfaceTopology) -> Iterator[tuple[Body, list[tuple[int, int]]]]:
    """Yield bodies, and which of their shells, by their places among these, come near each other."""
    parts = surface.turned_bodies
    if surface.touching is None:
        for body in parts:
            yield body, meeting_boxes(np.array([surface.shells[number].box for number in body.shells]))
        return
    body_of = surface.body_of
    pairs = surface.touching[(body_of[surface.touching[:, 0]] == body_of[surface.touching[:, 1]])]
    pairs = pairs[np.argsort(body_of[pairs[:, 0]], kind="stable")]
    for number, several in groupby(pairs.tolist(), key=lambda pair: body_of[pair[0]]):
        if number >= 0:
            place = {shell: at for at, shell in enumerate(parts[number].shells)}
            yield (
                parts[number],
                sorted((min(ends), max(ends)) for pair in several if (ends := [place[k] for k in pair])),
            )


def self_intersections(surface: SurfaceTopology) -> Evidence | None:
    """Find triangles of one shell (of any piece, where there are no shells) that cross each other."""
    from inertia.mesh.geometry.intersect import Crossings, crossings

    triangles = surface.triangles
    labels = surface.closure.labels if surface.shells else None

    def found() -> Crossings:
        if labels is None or surface.closure.repeated or not at_hand():
            return crossings(triangles, limit=_CROSSINGS, labels=labels)
        which = not_simple(triangles, labels, np.arange(len(labels)))
        among = crossings(triangles.select(which), limit=_CROSSINGS, labels=labels[which])
        return replace(among, pairs=which[among.pairs])

    pairs = once(("crossings", labels is None), triangles, found)
    pair, count = pairs.pairs, len(pairs.pairs)
    if not count:
        return None
    place = middle(pairs.points[:1])
    figures: dict[str, object] = {
        "at_least": "at least " if pairs.truncated else "",
        "one": pair[0, 0],
        "other": pair[0, 1],
    }
    crossed = np.unique(pair)
    if not surface.shells:
        return Evidence(count, listed(crossed), place, figures | {"doubt": ""})
    limit = _shallow(surface, crossed)
    about = once(("misplaced", *surface.wrong_shells), triangles, lambda: _misplaced(surface, crossed))
    # What rays find far too deep needs no exact measure, which takes ten times as long.
    clear = pairs.truncated or about > max(_CLEAR * limit, 2 * surface.room)
    doubt = None if clear else once("doubled", triangles, lambda: _doubled(surface, pair))
    if doubt is not None and doubt.volume <= max(limit, surface.room):
        depth = f"is on average no deeper than the contact tolerance ({CONTACT:g} of the shell)"
        room = "the faults that are allowed" if surface.allowed else "the fillings of the holes leave open"
        within = depth if doubt.volume <= limit else f"is less than {room}"
        figures |= {"within": within, "volume": doubt.volume, "unit": surface.unit}
    else:
        figures["doubt"] = _in_words(surface, about, doubt)
        doubt = None
    return Evidence(count, listed(crossed), place, figures, doubt=doubt)


def _doubled(surface: SurfaceTopology, pairs: Int) -> Doubt | None:
    """Return what counts more than once, or less than not at all, where triangles cross; None where that takes long.

    What else there is falls in patches at which the winding number does not change: where it is 1 just under them, all
    that counts otherwise lies between the triangles that cross.
    """
    from inertia.mesh.columns.common_volume import surplus_volume

    corners = surface.vertices[surface.faces]
    crossed = np.unique(pairs)
    rest = np.delete(np.arange(len(corners)), crossed)
    patches = closure(Surface(surface.vertices, surface.faces[rest]))
    wrong = _wrong_patches(corners, rest, patches)
    if len(wrong) > _CROSSINGS:
        return None
    suspects = np.concatenate([crossed, wrong])
    tied = np.concatenate([np.searchsorted(crossed, pairs), _sharing_vertices(surface.faces[suspects])])
    groups = components(tied, len(suspects))
    doubts = []
    for group in np.unique(groups):
        own = corners[suspects[groups == group]]
        box = np.stack([own.min(axis=(0, 1)), own.max(axis=(0, 1))])
        measured = surplus_volume(corners, box)
        if measured is None:
            return None
        volume = max(measured[0], 0.0) + measured[1]
        doubts.append(Doubt.within(box, volume, volume))
    return Doubt.joined(doubts)


def _shallow(surface: SurfaceTopology, crossed: Int) -> float:
    """Return the contact tolerance times the area of the triangles that cross: a volume that counts as a contact."""
    corners = surface.vertices[surface.faces[crossed]]
    sides = corners[:, 1:] - corners[:, :1]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2
    size = min(float(np.ptp(surface.shells[k].box, axis=0).max()) for k in np.unique(surface.closure.labels[crossed]))
    return float(max(CONTACT * size, surface.digits) * area)


def _wrong_patches(corners: Float, rest: Int, patches: Closure) -> Int:
    """Return the triangles of the patches under which the winding number is not, or cannot be told to be, 1."""
    from inertia.mesh.geometry.winding import windings_under

    order = np.argsort(patches.labels, kind="stable")
    labels, first, count = np.unique(patches.labels[order], return_index=True, return_counts=True)
    wrong = np.ones(len(labels), bool)
    for place in range(_TRIED):
        asked = np.flatnonzero(wrong & (labels >= 0))
        if len(asked) == 0:
            break
        which = rest[order[first[asked] + count[asked] * place // _TRIED]]
        winding, decided = windings_under(corners[which], corners)
        wrong[asked] = ~decided | (winding != 1)
        if (decided & (winding != 1)).any():
            break
    return rest[np.isin(patches.labels, labels[wrong & (labels >= 0)])]


def _sharing_vertices(faces: Int) -> Int:
    """Return pairs (k, 2) of faces that link all those with a vertex in common."""
    order = np.argsort(faces.ravel(), kind="stable")
    same = np.diff(faces.ravel()[order]) == 0
    return np.column_stack([order[:-1][same], order[1:][same]]) // 3


def _misplaced(surface: SurfaceTopology, crossed: Int) -> float:
    """Return about how much volume counts more than once, or less than not at all, by rays; 0 if they meet none."""
    corners = surface.turned.corners()
    for near in (corners, corners[crossed]):
        misplaced = misplaced_volume(corners, np.stack([near.min(axis=(0, 1)), near.max(axis=(0, 1))]))
        if misplaced > 0:
            return misplaced
    return 0.0


def _in_words(surface: SurfaceTopology, about: float, doubt: Doubt | None) -> str:
    """Say how much of the volume is in doubt."""
    volume = abs(sum(shell.signed_volume for shell in surface.shells))
    if about > _ROUNDING * volume:
        share = f" ({100 * about / volume:.2g} % of the stored volume)" if volume > 0 else ""
        return f": about {about:.2g} {surface.unit}³{share}"
    return ": too little for rays to meet it" if doubt is None else f": up to {doubt.volume:.2g} {surface.unit}³"
