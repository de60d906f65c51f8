"""Shells (connected components) of a closed surface, which of them contain which, and the bodies that they bound.

The components of a closed surface are its shells. Let w be the sum, over the shells that contain a shell, of
the sign of their volumes. In a sound solid w = 0 around every outward shell (positive volume) and w = 1
around every inward one (the wall of a cavity). An outward shell at w ≥ 1 counts its inside twice; an inward
one at w = 0 is inside out.

Where one shell lies on another, what counts is the material just under it, and of a body its middle: an
insert is inside the cavity that it fills, and the cavity is not inside the insert.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.mesh.geometry.boxes import nested, within
from inertia.mesh.geometry.closure import Closure
from inertia.mesh.geometry.contact_depth import CONTACT, are_single, last_digits
from inertia.mesh.geometry.enclosed import NOISE, Local, boxes_of, drawn, enclosed, members_of, scaling
from inertia.mesh.geometry.senses import senses
from inertia.mesh.geometry.sound_shells import Nesting, sound_nesting
from inertia.mesh.geometry.touching import touching_bodies
from inertia.mesh.geometry.winding import windings, windings_each, windings_under
from inertia.mesh.surface import Facets, Triangles
from inertia.records import dataclass

_CHUNK = 1 << 16
WOUND: tuple[Literal["outward"], Literal["inward"]] = ("outward", "inward")
"""A shell, by its depth modulo 2."""

SLIVER = 1e-9
"""Volume, over that of all shells, up to which a shell that is wound wrongly does not keep a part from an answer.

Nor does it where it has little to say for the second moments, either: far from a slender part it would be most of them.
"""

FEW = 40
"""Shells of which it takes least to look at each pair."""

_ALONE = 1 << 15  # triangles of a shell, times shells that it may hold, above which it is taken by itself
_UNDER = 1e-10  # how far under the surface those places are, over the size of the part
_CLEAR = 2 * _UNDER  # of the surface around it: what is nearer is asked in integers
_TRIED = 64  # places farther under the surface of a body, where its surface does not tell
_STORED = 2.0**-50  # rounding of a stored coordinate, relative to it; what it can do to a volume is that times the area

_Corners = Callable[[Int], Float]
"""The corners (k, 3, 3) of triangles by their numbers (k,)."""


@dataclass(frozen=True, eq=False)
class Shell:
    """One component of a closed surface.

    Attributes
    ----------
    number : the component's number
    kind : "outward" (positive volume), "inward" (negative) or "sheet": none, as its faces cancel, or next to none and
        wound against its depth
    triangles : how many it has
    first : number of its first triangle
    signed_volume : in file units cubed
    box : (2, 3), least and greatest coordinates, in file units
    winding_outside : w, the sum of the signs of the shells around it
    depth : how many shells are around it (sheets bound nothing and are not counted)
    parent : the number of the innermost shell around it
    """

    number: int
    kind: Literal["outward", "inward", "sheet"]
    triangles: int
    first: int
    signed_volume: float
    box: Float
    winding_outside: int
    depth: int
    parent: int | None


@dataclass(frozen=True)
class Body:
    """A body: the numbers of its outer shell and then of its cavities."""

    number: int
    shells: tuple[int, ...]


def shells(triangles: Triangles, closure: Closure) -> tuple[Shell, ...]:
    """Measure the components of a closed surface with finite coordinates, and find what contains what.

    >>> from inertia.mesh.geometry.closure import closure
    >>> from inertia.mesh.part import Surface
    >>> corners = np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> hollow = Surface(np.vstack([corners, corners / 3 + 1]), np.vstack([faces, faces[:, ::-1] + 4]))
    >>> [(shell.kind, shell.depth) for shell in shells(hollow, closure(hollow))]
    [('outward', 0), ('inward', 1)]
    """
    count = closure.components
    if count == 0:
        return ()
    boxes = boxes_of(triangles, closure.labels, count, finite=True)
    local, exponent = scaling(boxes)
    order = members(closure)
    volumes, noise = enclosed(triangles, closure.labels, local, local(boxes).mean(axis=1))
    if (scarce := np.abs(volumes) <= noise).any():
        volumes[scarce], noise[scarce] = _exact_volumes(triangles, closure.labels, np.flatnonzero(scarce), exponent)
    signs = np.where(np.abs(volumes) > noise, np.sign(volumes), 0).astype(np.int64)
    nesting = sound_nesting(triangles, closure) if count > FEW and signs.all() else None
    if nesting is None:
        sense = senses(triangles, order, local, boxes, volumes, signs)  # what is inside out is nested as when turned
        around = _containers(triangles, order, local, boxes, sense * signs, sense[closure.labels], exponent)
    else:
        around = _ancestors(nesting)
    most = -1 if volumes.sum() < -noise.sum() else 1  # as most of the surface is wound
    slivers = set(_slivers(volumes, most * signs, around))
    if slivers:
        slivers = _of_no_weight(triangles, closure, local, local(boxes), most * volumes, sorted(slivers))
    if slivers:
        signs[list(slivers)] = 0
        around = [[outer for outer in outside if outer not in slivers] for outside in around]
    with np.errstate(over="ignore", under="ignore"):
        stored = np.ldexp(volumes, 3 * exponent)
    sign = signs.tolist()
    return tuple(
        Shell(
            number=number,
            kind=("sheet", "outward", "inward")[signs[number]],
            triangles=len(order[number]),
            first=int(order[number][0]),
            signed_volume=float(stored[number]),
            box=boxes[number],
            winding_outside=sum(sign[outer] for outer in around[number]),
            depth=len(around[number]),
            parent=max(around[number], key=lambda outer: len(around[outer]), default=None),
        )
        for number in range(count)
    )


def soundly_nested(triangles: Triangles, closure: Closure, shells: Sequence[Shell]) -> bool:
    """Say whether it is sure that no two shells meet, and that each is wound as its depth asks."""
    if any(shell.winding_outside != shell.depth % 2 or shell.kind != WOUND[shell.depth % 2] for shell in shells):
        return False
    met = touching_bodies(triangles, closure.labels, np.array([shell.box for shell in shells]), few=True)
    return met is not None and len(met) == 0


def bodies(shells: Sequence[Shell]) -> tuple[Body, ...]:
    """Group shells into bodies: an outer shell with the cavities directly inside it.

    A cavity is a shell at an odd depth, wound against the shell around it, which is at an even one. Sheets
    belong to no body. Bodies are numbered in the order of their outer shells.
    """
    groups: dict[int, list[int]] = {}
    for shell in sorted(shells, key=lambda shell: shell.depth % 2):  # outer shells first
        outer = None if shell.parent is None else shells[shell.parent]
        if shell.kind == "sheet":
            continue
        if outer is not None and shell.depth % 2 > outer.depth % 2 and shell.kind != outer.kind:
            groups[outer.number].append(shell.number)
        else:
            groups[shell.number] = [shell.number]
    return tuple(Body(number, tuple(group)) for number, group in enumerate(sorted(groups.values())))


def bodies_apart(shells: Sequence[Shell]) -> tuple[Body, ...]:
    """Group shells into bodies, however these lie in one another: outward ones, with the inward ones next inside."""
    groups = {shell.number: [shell.number] for shell in shells if shell.kind == "outward"}
    for shell in shells:
        outer = shell.parent
        while outer is not None and outer not in groups:
            outer = shells[outer].parent
        if shell.kind == "inward":
            groups.setdefault(shell.number if outer is None else outer, []).append(shell.number)
    return tuple(Body(number, tuple(group)) for number, group in enumerate(sorted(groups.values())))


def absolute_orientation(shells: Sequence[Shell]) -> Int:
    """Return the numbers of the shells to turn so that even depths are outward and odd depths inward."""
    wrong = ("inward", "outward")  # by depth modulo 2
    return np.array([s.number for s in shells if s.kind == wrong[s.depth % 2]], np.int64)


def members(closure: Closure) -> list[Int]:
    """Return the numbers of the triangles of each component, ascending."""
    return members_of(closure.labels, closure.components)


def bounds_nothing(triangles: Triangles, box: Float) -> bool:
    """Say whether the volume, in integers, is no more than the rounding of the coordinates can have made."""
    exponent = int(np.frexp((box[1] / 2 - box[0] / 2).max())[1])
    whole = np.zeros(triangles.count, np.int32)
    volume, noise = _exact_volumes(triangles, whole, np.zeros(1, np.int64), exponent)
    return bool(np.abs(volume) <= noise / 4)  # half a last digit along each axis is less than a quarter of `_STORED`


def _slivers(volumes: Float, signs: Int, around: list[list[int]]) -> list[int]:
    """Return the shells of next to no volume that lie where, as they are wound, no body and no cavity can be."""
    small = np.abs(volumes) <= SLIVER * np.abs(volumes).sum()
    return [k for k in np.flatnonzero(small).tolist() if signs[k] and signs[around[k]].sum() != (signs[k] < 0)]


def _of_no_weight(
    triangles: Triangles, closure: Closure, local: Local, boxes: Float, volumes: Float, slivers: list[int]
) -> set[int]:
    """Return the slivers that change no second moment of the rest, ∫(u·x)² dV along its principal axes u, by all of it.

    To turn a shell of volume v that is d away changes it by 2 v d². Where the slivers together changed it by more, the
    tensor could be that of no body; the largest are then shells like any other. Along axes on which the rest is thinner
    than float64 can tell there is no such limit: bounds on the moments, which have more digits, show what is left.
    """
    rest = np.ones(closure.components + 1, bool)  # the last is that of triangles in no shell
    rest[[*slivers, -1]] = False
    origin = boxes[np.abs(volumes).argmax()].mean(axis=0)
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for start in range(0, triangles.count, _CHUNK):
        chosen = rest[closure.labels[start : start + _CHUNK]]
        corners = local(triangles.corners(start, start + _CHUNK)[chosen]) - origin
        six = (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum(axis=1)
        total = corners.sum(axis=1)
        volume += six.sum() / 6
        first += six @ total / 24
        second += (
            np.einsum("n,nki,nkj->ij", six, corners, corners) + np.einsum("n,ni,nj->ij", six, total, total)
        ) / 120
    if not volume:
        return set(slivers)
    middle, sign = first / volume, np.sign(volume)
    least, axes = np.linalg.eigh(sign * (second - np.outer(first, middle)))
    told = least > NOISE * np.abs(least).sum()
    half = np.ptp(boxes[slivers], axis=1) / 2
    far = np.abs((boxes[slivers, 0] + half - origin - middle) @ axes) + np.linalg.norm(half, axis=1, keepdims=True)
    changed = 2 * np.abs(volumes[slivers, None]) * far**2 / np.where(told, least, np.inf)
    share = changed.max(axis=1)
    order = share.argsort(kind="stable")
    return {slivers[k] for k in order[np.cumsum(share[order]) < 1].tolist()}


def _exact_volumes(triangles: Triangles, labels: NDArray[np.int32], shells: Int, exponent: int) -> tuple[Float, Float]:
    """Return the signed volumes, ∑ a·b×c / 6 in integers, of the shells numbered, and what storing can do to them.

    Both are over 8^exponent. A shell that the rounding of its own coordinates can have made is no solid.
    """
    rows = np.flatnonzero(np.isin(labels, shells))
    chunks = [rows[start : start + _CHUNK] for start in range(0, len(rows), _CHUNK)]
    lowest = min(int(np.frexp(triangles.select(chunk).corners())[1].min()) for chunk in chunks)
    totals, areas, farthest = np.zeros(len(shells), object), np.zeros(len(shells)), np.zeros(len(shells))
    for chunk in chunks:
        corners = triangles.select(chunk).corners()
        place = np.searchsorted(shells, labels[chunk])
        fractions, exponents = np.frexp(corners)
        whole = np.ldexp(fractions, 53).astype(np.int64).astype(object) << (exponents - lowest).astype(object)
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = whole.transpose(1, 2, 0)
        terms = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        np.add.at(totals, place, terms)
        scaled = np.ldexp(corners, -exponent)
        sides = np.cross(scaled[:, 1] - scaled[:, 0], scaled[:, 2] - scaled[:, 0])
        np.add.at(areas, place, np.linalg.norm(sides, axis=1) / 2)
        np.maximum.at(farthest, place, np.abs(scaled).max(axis=(1, 2)))
    unit = Fraction(2) ** (3 * (lowest - 53 - exponent)) / 6
    return np.array([float(unit * total) for total in totals.tolist()]), _STORED * areas * farthest


def _ancestors(nesting: Nesting) -> list[list[int]]:
    """Return for each shell the numbers of the shells around it, ascending."""
    around: list[list[int]] = [[] for _ in nesting.parent]
    for number in np.argsort(nesting.depth).tolist():
        outer = int(nesting.parent[number])
        around[number] = [] if outer < 0 else sorted([*around[outer], outer])
    return around


def _containers(
    triangles: Triangles, order: list[Int], local: Local, boxes: Float, signs: Int, sense: Int, exponent: int
) -> list[list[int]]:
    """Return for each shell the numbers of the shells around it, triangles being turned whose `sense` (n,) is −1."""

    def corners_of(which: Int) -> Float:
        corners: Float = triangles.select(which).corners()
        turned = sense[which] < 0
        corners[turned] = corners[turned, ::-1]
        return corners

    largest, contact = float(np.abs(boxes).max()), CONTACT * np.ptp(boxes, axis=1).max(axis=1)
    pairs = nested(boxes, np.maximum(contact, last_digits(largest, single=True)))
    pairs = pairs[signs[pairs[:, 0]] != 0]
    if len(pairs) == 0:
        return [[] for _ in order]
    contact = np.maximum(contact, last_digits(largest, single=_are_single(triangles)))
    pairs = pairs[within(boxes[:, 0], boxes[:, 1], pairs[:, 1], pairs[:, 0], contact)]
    near = np.maximum(2 * np.ldexp(contact, -exponent), _CLEAR)
    inside = np.zeros(len(pairs), bool)
    shells, place = np.unique(pairs[:, 1], return_inverse=True)
    samples = drawn(triangles, order, shells)
    places = _under(corners_of, samples, local, _UNDER)
    margin = 2 * float(near[shells].max(initial=_CLEAR))
    for which, winding, clearance in _windings_around(corners_of, order, local, pairs, places[place], margin):
        every, clearest = np.arange(len(winding)), clearance.argmax(axis=1)
        around_it, clear = winding[every, clearest], clearance[every, clearest]
        for k in np.flatnonzero(clear < near[pairs[which, 1]]):
            outer, inner = pairs[which[k]].tolist()
            corners = corners_of(order[outer])
            if clear[k] < _CLEAR:
                exact, decided = windings_under(corners_of(samples[place[which[k]]]), corners)
                around_it[k] = exact[decided][0] if decided.any() else around_it[k]
            if signs[inner] > 0:  # what a contact decides at its surface, the middle of the body may show
                deep = _winding_within(corners_of, order[inner], local, local(corners), float(near[inner]))
                around_it[k] = around_it[k] if deep is None else deep
        inside[which] = around_it != 0
    return _in_turn(set(map(tuple, pairs[inside].tolist())), signs)


def _in_turn(nestings: set[tuple[int, int]], signs: Int) -> list[list[int]]:
    """Return for each shell those around it, of two that coincide the one that is around the other as they are wound.

    Inside a body, a cavity holds the insert that fills it; elsewhere, a body holds the cavity in it.
    """
    found: list[set[int]] = [set() for _ in signs]
    for outer, inner in nestings:
        found[inner].add(outer)
    around: list[list[int]] = [[] for _ in signs]
    for outer, inner in sorted(nestings):
        if (inner, outer) in nestings:
            first = 1 if sum(int(signs[k]) for k in found[outer] & found[inner]) < 1 else -1
            if not (outer < inner if signs[outer] == signs[inner] else signs[outer] == first):
                continue
        around[inner].append(outer)
    return around


def _winding_within(corners_of: _Corners, members: Int, local: Local, outer: Float, near: float) -> int | None:
    """Return the winding number of a shell, (n, 3, 3), around a place farther in a body than what is near it.

    None if no such place is found.
    """
    own, depth = local(corners_of(members)), 4 * near
    some = members[:: len(members) // _TRIED + 1]
    places = _under(corners_of, some[None], local, depth)[0]
    winding, clearance = windings(places, own, 2 * depth)
    around_it, clear = windings(places, outer, 2 * depth)
    clear = np.where(winding == 1, np.minimum(clearance, clear), 0.0)
    best = int(clear.argmax())
    return int(around_it[best]) if clear[best] >= depth / 2 else None


def _are_single(triangles: Triangles) -> bool:
    """Say whether all coordinates are numbers of float32."""
    chunks = range(0, triangles.count, _CHUNK)
    return isinstance(triangles, Facets) or all(are_single(triangles.corners(k, k + _CHUNK)) for k in chunks)


def _windings_around(
    corners_of: _Corners, order: list[Int], local: Local, pairs: Int, points: Float, margin: float
) -> Iterator[tuple[Int, Int, Float]]:
    """Yield numbers of pairs (outer, inner), and the winding numbers of the outer one around points (k, s, 3) each.

    With them comes how clear of it the points are. Shells that may hold many others are taken one by one, against all
    points at once; the rest, side by side.
    """
    sizes = np.array([len(members) for members in order])
    outers, starts, counts = np.unique(pairs[:, 0], return_index=True, return_counts=True)
    alone = counts * sizes[outers] > _ALONE
    for start, count in zip(starts[alone].tolist(), counts[alone].tolist(), strict=True):
        which, members = np.arange(start, start + count), order[pairs[start, 0]]
        inner = points[which].reshape(-1, 3)
        winding, clearance = np.zeros(len(inner), np.int64), np.full(len(inner), np.inf)
        for chunk in range(0, len(members), _CHUNK):
            corners = local(corners_of(members[chunk : chunk + _CHUNK]))
            more, distance = windings(inner, corners, margin)
            winding += more
            np.minimum(clearance, distance, out=clearance)
        yield which, winding.reshape(count, -1), clearance.reshape(count, -1)
    rest = np.flatnonzero(np.repeat(~alone, counts))
    ends = np.cumsum(sizes[pairs[rest, 0]])
    for which in np.split(rest, np.searchsorted(ends, np.arange(_CHUNK, ends[-1], _CHUNK))) if len(rest) else ():
        members = np.concatenate([order[outer] for outer in pairs[which, 0].tolist()])
        owner = np.repeat(np.arange(len(which)), sizes[pairs[which, 0]])
        yield which, *windings_each(points[which], local(corners_of(members)), owner, margin)


def _under(corners_of: _Corners, samples: Int, local: Local, depth: float) -> Float:
    """Return places (k, s, 3) under the surface at triangles (k, s), on the side of the material."""
    corners = local(corners_of(samples.ravel()))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    places: Float = corners.mean(axis=1) - depth * normal / np.where(length > 0, length, 1)
    return places.reshape(*samples.shape, 3)
