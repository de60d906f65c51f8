"""Repair of a surface, step by step: vertices merged, triangles removed and turned, holes filled, bodies united.

What is right is left alone: a sound part comes back as it went in, bit for bit. The steps, in their order:

1. vertices with equal coordinates become one (by itself no change: all that reads them takes them for one);
2. vertices within the tolerance become one; without a tolerance, those at open edges that are no farther
   apart than 1e-6 of the diagonal of the part's box (cracks), or, where cracks part the surface in pieces, the least
   distance up to 1e-3 of it that closes all of them;
3. triangles with a repeated corner, copies of triangles, and fins without thickness are removed;
4. triangles are turned until neighbours agree, the fewer ones in each piece;
5. holes are filled (see `inertia.mesh.repairs.holes`);
6. shells that are inside out are turned;
7. bodies that overlap are united (see `inertia.mesh.unite`).

A shell that crosses itself stays as it is: `inertia.mesh.unite` unites it with itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import UNION, GeometryError, placed
from inertia.mesh.checks.findings import counted
from inertia.mesh.doubt import Doubt, Guess
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.edges import pair_edges
from inertia.mesh.geometry.faces import components, merge_equal_vertices, repeated_corners
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.intersect import overlap
from inertia.mesh.part import Part, Regions, Rounding
from inertia.mesh.repairs.closures import breadth, closures, displaced, hull
from inertia.mesh.repairs.copies import copies, facing
from inertia.mesh.repairs.holes import around, fill, refuse_sheets, rims, sheets
from inertia.mesh.repairs.orientation import Nest, inconsistent, nest
from inertia.mesh.repairs.weld import (
    close_vertices,
    clusters,
    compact,
    diagonal,
    require_finite,
    rim_distance,
    weld_within,
)
from inertia.mesh.surface import Surface, Triangles
from inertia.mesh.unite import unite
from inertia.records import dataclass

_CRACK = 1e-6  # width of a crack that is closed unasked, over the diagonal of the part's box
_CHAIN = 4  # times the distance that closes cracks, that a vertex may go
_FEW = 100  # bodies whose boxes are compared one by one
_ROUNDING = 2.0**-51  # of the largest coordinate
_NAMED = 5  # triangles named in a change


@dataclass(frozen=True)
class Change:
    """One thing that was changed.

    Attributes
    ----------
    what : what was done to what, as in "triangles turned to agree with their neighbours"
    count : to how many
    where : the first triangles concerned, by their numbers in the part as given, or a place in file units
    largest_move : the longest way that a vertex went, in file units
    doubt : the volume that there may be more or less for it, where it is a guess
    code : of what is mended where there is a doubt: "crack", "sheet", "hole", "inverted_body" or "overlapping_bodies"
    """

    what: str
    count: int
    where: str
    largest_move: float = 0.0
    doubt: Doubt | None = None
    code: str = ""

    def __str__(self) -> str:
        moved = f", moved by at most {self.largest_move:.3g}" if self.largest_move else ""
        return f"{self.what}: {self.count} ({self.where}){moved}"


@dataclass(frozen=True, eq=False)
class Repair:
    """The repaired part, and what was changed; the same part if nothing was."""

    part: Part
    changes: tuple[Change, ...]


@dataclass(frozen=True, eq=False)
class _Mesh:
    """A surface under repair; each face comes from, or was put beside, the given triangle `origin`.

    `rounding` is how far vertices may be from where uniting puts them, in file units.
    """

    vertices: Float
    faces: Int
    origin: Int
    filling: Doubt | None = None
    rounding: float = 0.0

    def without(self, which: Int) -> _Mesh:
        remaining = np.ones(len(self.faces), bool)
        remaining[which] = False
        return replace(self, faces=self.faces[remaining], origin=self.origin[remaining])

    def turned(self, which: Int) -> _Mesh:
        faces = self.faces.copy()
        faces[which] = faces[which, ::-1]
        return replace(self, faces=faces)

    def at(self, which: Int) -> str:
        """Name the triangles that faces come from."""
        numbers = np.unique(self.origin[which])
        more = len(numbers) - _NAMED
        named = ", ".join(map(str, numbers[:_NAMED].tolist()))
        return f"triangle{'s' if len(numbers) > 1 else ''} {named}{f' and {more} more' if more > 0 else ''}"


_Step = tuple[_Mesh, list[Change]]


def repair(
    part: Part, *, tolerance: float | None = None, unite: bool = True, bounded: bool = False, alike: bool = False
) -> Repair:
    """Repair the surface of a part, and say what was changed.

    Parameters
    ----------
    tolerance : vertices within this distance of each other, in file units, become one
    unite : whether bodies that overlap are united, which takes most of the time where there are many
    bounded : whether cracks are merged that are wider, of up to a thousandth of the diagonal of the part's box, if that
        closes the surface, open pieces that bound nothing are left out, and shells are turned though they share space
        with others: what that leaves open is the doubt of the change; closures of a hole stay near it then
    alike : whether all regions are of one density, so that it does not matter which of them has what several claim

    Raises
    ------
    GeometryError : the surface cannot be closed (an open sheet, a one-sided surface, a hole too large),
        overlapping bodies or copies of triangles are of different regions, or a coordinate is not finite
    UsageError : the tolerance is not usable

    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    >>> for change in repair(part).changes:
    ...     print(change)
    holes filled: 1 (of 3 edges around (0, 0.333333333, 0.333333333))
    """
    triangles = part.triangles
    try:
        mesh, changes = _repaired(triangles, None if alike else part.regions, tolerance, unite, bounded)
    except GeometryError as fault:
        raise placed(fault, f"{part.name} cannot be repaired") from None
    result = _rebuilt(part, Surface(*compact(mesh.vertices, mesh.faces)), mesh.origin, changes, mesh.filling)
    if mesh.rounding == 0.0:
        return result
    read = 0.0 if part.rounding is None else part.rounding.distance
    return replace(result, part=replace(result.part, rounding=Rounding(read + mesh.rounding)))


def weld(part: Part, tolerance: float) -> Repair:
    """Make one of the vertices of a part's surface that lie within `tolerance` (file units), and nothing else.

    Raises as `inertia.mesh.repairs.weld.weld_within`.
    """
    result = weld_within(part.triangles, tolerance)
    if result.merged == 0:
        return Repair(part, ())
    where = f"{counted(result.collapsed, 'triangle')} collapsed and left out"
    change = Change("vertices within the tolerance merged", result.merged, where, result.largest_move)
    return _rebuilt(part, result.surface, result.remaining, [change])


def _rebuilt(part: Part, surface: Surface, origin: Int, changes: list[Change], filling: Doubt | None = None) -> Repair:
    if not changes:
        return Repair(part, ())
    regions = part.regions
    if regions is not None:
        regions = Regions(regions.names, regions.index[origin])
    chord = part.chord
    if chord is not None:
        chord = chord[origin] + max(change.largest_move for change in changes)
    notes = (*part.notes, *(f"repaired: {change}" for change in changes))
    rounding = part.rounding if part.rounding is None else Rounding(part.rounding.distance)
    filling = Doubt.joined([part.filling, filling])
    guesses = [
        Guess(f"{change}{f' {part.unit.name}' if change.largest_move else ''}", change.code, change.count, change.doubt)
        for change in changes
        if change.doubt is not None and change.code != "hole"
    ]
    mended = replace(
        part,
        geometry=surface,
        regions=regions,
        notes=notes,
        chord=chord,
        rounding=rounding,
        filling=filling,
        guesses=(*part.guesses, *guesses),
        shape=None,
    )
    return Repair(mended, tuple(changes))


def _repaired(
    triangles: Triangles, regions: Regions | None, tolerance: float | None, unite: bool, bounded: bool
) -> _Step:
    require_finite(triangles)
    mesh, joined = _joined(triangles)
    changes: list[Change] = []
    steps: list[Callable[[_Mesh], _Step]] = [
        lambda mesh: _without(mesh, _repeating(mesh.faces), "triangles with a repeated corner removed"),
        _without_cracks if tolerance is None else lambda mesh: _welded(mesh, tolerance),
        lambda mesh: _without_wide_cracks(mesh, not bounded) if bounded or tolerance is None else (mesh, []),
        lambda mesh: _without_copies(mesh, regions),
        _without_doubles_and_fins,
        _wound_alike,
        _without_sheets if bounded else lambda mesh: (mesh, []),
        lambda mesh: _without_holes(mesh, bounded),
        lambda mesh: _turned_outward(mesh, bounded),
        lambda mesh: _united(mesh, regions) if unite else (mesh, []),
    ]
    for step in steps:
        mesh, made = step(mesh)
        changes += made
        if len(mesh.faces) == 0:
            raise GeometryError("no triangle bounds anything: export the part as a solid")
    edges = half_edges(mesh.faces)
    still = np.flatnonzero(edges.surplus[edges.edge])
    if len(still):
        place = around(mesh.vertices[edges.tail[still[:1]]])
        raise GeometryError(f"{len(still)} edges, the first {place}, are open after all: close them by hand")
    return mesh, [*joined, *changes] if changes else []


def _joined(triangles: Triangles) -> _Step:
    """Give equal vertices one number; that is no change where the format numbers no vertices."""
    vertices, faces = merge_equal_vertices(triangles)
    mesh = _Mesh(vertices, faces, np.arange(len(faces)))
    if not isinstance(triangles, Surface):
        return mesh, []
    first = np.full(len(vertices), len(triangles.vertices))
    np.minimum.at(first, faces, triangles.faces)
    joined = np.flatnonzero((triangles.faces != first[faces]).any(axis=1))
    if len(joined) == 0:
        return mesh, []
    count = len(np.unique(triangles.faces)) - len(vertices)
    return mesh, [Change("vertices with equal coordinates joined", count, mesh.at(joined))]


def _called(regions: Regions, numbers: NDArray[np.int32]) -> str:
    return " and ".join(repr(regions.names[k]) if k >= 0 else "none" for k in numbers)


def _without(mesh: _Mesh, which: Int, what: str) -> _Step:
    if len(which) == 0:
        return mesh, []
    return mesh.without(which), [Change(what, len(which), mesh.at(which))]


def _without_copies(mesh: _Mesh, regions: Regions | None) -> _Step:
    pairs = copies(mesh.faces)
    if regions is not None:
        claims = regions.index[mesh.origin[pairs]]
        contested = claims[:, 0] != claims[:, 1]
        if contested.any():
            names = _called(regions, claims[np.argmax(contested)])
            raise GeometryError(
                f"{mesh.at(pairs[contested, 1])} repeat others of another region, the first of the regions {names}, "
                "and which of them is to have that place is not known: leave one of them out, or give one density for "
                "the part"
            )
    return _without(mesh, np.unique(pairs[:, 1]), "copies of triangles removed")


def _repeating(faces: Int) -> Int:
    return np.flatnonzero(repeated_corners(faces))


def _without_cracks(mesh: _Mesh) -> _Step:
    edges = half_edges(mesh.faces)
    rim = edges.uses[edges.edge] == 1
    if not rim.any():
        return mesh, []
    points = np.unique([edges.tail[rim], edges.head[rim]])
    into = np.arange(len(mesh.vertices))
    into[points] = points[clusters(mesh.vertices[points], _CRACK * diagonal(mesh.vertices))]
    return _merged(mesh, into, "vertices at cracks merged")


def _without_wide_cracks(mesh: _Mesh, parting: bool) -> _Step:
    """Merge cracks; where `parting`, only such that part a surface in pieces, each of which would be filled by itself.

    Only vertices at open edges become others, so that whatever else lies near is left alone.
    """
    edges = pair_edges(mesh.faces)
    surplus = edges.forward - edges.backward
    distance = rim_distance(mesh.vertices, edges.ends, surplus)
    if distance is None:
        return mesh, []
    points, into = np.unique(edges.ends[surplus != 0]), np.arange(len(mesh.vertices))
    into[points] = points[clusters(mesh.vertices[points], distance)]
    if np.linalg.norm(mesh.vertices - mesh.vertices[into], axis=1).max() > _CHAIN * distance:
        return mesh, []
    merged, changes = _merged(mesh, into, "cracks merged")
    closed = pair_edges(merged.faces).balanced.all() and not len(copies(merged.faces))
    fewer = not parting or _pieces(merged.faces) < _pieces(mesh.faces)
    return (merged, changes) if closed and fewer else (mesh, [])


def _pieces(faces: Int) -> int:
    """Return how many pieces hang together by their edges."""
    whole = faces[~repeated_corners(faces)]
    return len(np.unique(components(half_edges(whole).neighbours() // 3, len(whole))))


def _welded(mesh: _Mesh, tolerance: float) -> _Step:
    return _merged(mesh, close_vertices(mesh.vertices, tolerance), "vertices within the tolerance merged")


def _merged(mesh: _Mesh, into: Int, what: str) -> _Step:
    """Let vertices become others; drop the triangles that this leaves without area."""
    count = int((into != np.arange(len(into))).sum())
    if count == 0:
        return mesh, []
    faces = into[mesh.faces]
    where = mesh.at(np.flatnonzero((faces != mesh.faces).any(axis=1)))
    move = float(np.linalg.norm(mesh.vertices - mesh.vertices[into], axis=1).max())
    moves = np.where(np.bincount(into, minlength=len(into))[into] > 1, move, 0.0)
    doubt = displaced(mesh.vertices, mesh.faces, moves)
    mesh, lost = _without(replace(mesh, faces=faces), _repeating(faces), "triangles that collapsed removed")
    return mesh, [Change(what, count, where, move, doubt, "crack"), *lost]


def _without_doubles_and_fins(mesh: _Mesh) -> _Step:
    doubled, fins = facing(mesh.faces)
    _, first = _without(mesh, doubled, "copies of triangles, wound the other way, removed")
    _, second = _without(mesh, fins, "triangles of fins without thickness removed")
    return mesh.without(np.concatenate([doubled, fins])), first + second


def _wound_alike(mesh: _Mesh) -> _Step:
    which = np.flatnonzero(inconsistent(mesh.vertices, mesh.faces, half_edges(mesh.faces)))
    if len(which) == 0:
        return mesh, []
    what = "triangles turned to agree with their neighbours"
    return mesh.turned(which), [Change(what, len(which), mesh.at(which))]


def _without_sheets(mesh: _Mesh) -> _Step:
    """Leave out open pieces that are no solids: in doubt is all of the convex hull of each."""
    doubts, count, origin = [], 0, [np.empty(0, np.int64)]
    while True:
        edges = half_edges(mesh.faces)
        loops = rims(edges)
        vertices, fillings = fill(mesh.vertices, mesh.faces, edges, loops)
        pieces = sheets(vertices, mesh.faces, edges, loops, fillings)
        if not pieces:
            break
        doubts += [hull(mesh.vertices[np.unique(mesh.faces[piece])]) for piece in pieces]
        count += len(pieces)
        origin.append(mesh.origin[np.concatenate(pieces)])
        mesh = mesh.without(np.concatenate(pieces))
    if count == 0:
        return mesh, []
    named = replace(mesh, origin=np.concatenate(origin)).at(np.arange(sum(map(len, origin))))
    change = Change("open pieces that bound nothing left out", count, named, doubt=Doubt.joined(doubts), code="sheet")
    return mesh, [change]


def _without_holes(mesh: _Mesh, bounded: bool) -> _Step:
    edges = half_edges(mesh.faces)
    loops = rims(edges)
    if not loops:
        return mesh, []
    vertices, fillings = fill(mesh.vertices, mesh.faces, edges, loops)
    if not bounded:
        refuse_sheets(vertices, mesh.faces, edges, loops, fillings)
    beside = [np.full(len(new), mesh.origin[loop[0] // 3]) for loop, new in zip(loops, fillings, strict=True)]
    largest = max(loops, key=len)
    where = f"of {len(largest)} edges {around(vertices[edges.head[largest]])}"
    size = diagonal(mesh.vertices[np.unique(mesh.faces)])
    holes = zip(loops, fillings, strict=True)
    doubts = [closures(vertices, mesh.faces, edges, *hole, size, small=bounded) for hole in holes]
    moves = np.zeros(len(vertices))
    rounding = _ROUNDING * float(np.abs(vertices).max())  # as a hanging vertex is off the edge that it stands on
    for loop, new in zip(loops, fillings, strict=True):
        rim = edges.head[loop]
        moves[rim] = np.maximum(moves[rim], breadth(vertices, rim, new) + rounding)
    doubt = Doubt.joined([*doubts, displaced(vertices, mesh.faces, moves)])
    mesh = _Mesh(vertices, np.concatenate([mesh.faces, *fillings]), np.concatenate([mesh.origin, *beside]), doubt)
    where = where if len(loops) == 1 else f"the largest {where}"
    return mesh, [Change("holes filled", len(loops), where, doubt=doubt, code="hole")]


def _turned_outward(mesh: _Mesh, bounded: bool) -> _Step:
    shells = nest(mesh.vertices, mesh.faces, half_edges(mesh.faces))
    turn = shells.to_turn()
    if not turn:
        return mesh, []
    if not bounded:
        _refuse_cutters(mesh, shells, turn)
    which = np.concatenate([shells.members[shell] for shell in turn])
    mesh = replace(mesh.turned(which), filling=mesh.filling and mesh.filling.either_way())
    change = Change("inside-out shells turned", len(turn), mesh.at(which))
    if (shells.volumes <= 0).all():
        return mesh, [change]
    doubts = [_either_way(mesh, shells, shell) for shell in turn]
    return mesh, [replace(change, doubt=Doubt.joined(doubts), code="inverted_body")]


def _either_way(mesh: _Mesh, shells: Nest, shell: int) -> Doubt:
    """Return the doubt about a shell that was turned: it may be material, a void, or nothing."""
    points = mesh.vertices[mesh.faces[shells.members[shell]]]
    box = np.stack([points.min(axis=(0, 1)), points.max(axis=(0, 1))])
    corners = points - box.mean(axis=0)
    twice = 2 * abs(float(np.linalg.det(corners).sum())) / 6
    outward = shells.volumes[shell] < 0
    return Doubt.within(box, 0.0 if outward else twice, twice if outward else 0.0)


def _refuse_cutters(mesh: _Mesh, shells: Nest, turn: list[int]) -> None:
    """Raise `GeometryError` where a shell to be turned outward shares space with another that is outward already."""
    inward = [shell for shell in turn if shells.volumes[shell] < 0]
    for one in inward:
        cutter = Surface(mesh.vertices, mesh.faces[shells.members[one], ::-1])
        for other in np.flatnonzero(shells.volumes > 0).tolist():
            if other in shells.containers[one] or one in shells.containers[other] or other in turn:
                continue
            place = overlap(cutter, Surface(mesh.vertices, mesh.faces[shells.members[other]]))
            if place is not None:
                raise GeometryError(
                    f"two bodies {around(np.array([place]))} share space, and one of them faces inward: it may be a "
                    "cavity that sticks out or a body stored inside out, so cut or unite them where the part was made, "
                    "or use ",
                    UNION,
                    ", which cuts",
                )


def _united(mesh: _Mesh, regions: Regions | None) -> _Step:
    bodies = nest(mesh.vertices, mesh.faces, half_edges(mesh.faces)).bodies()
    groups, where = _overlapping_groups(mesh.vertices, mesh.faces, bodies)
    vertices, faces, origin, rounding = [mesh.vertices], [], [], 0.0
    doubts = []
    for group in groups:
        sources = mesh.origin[np.concatenate(group)]
        if regions is not None and len(several := np.unique(regions.index[sources])) > 1:
            names = _called(regions, several)
            raise GeometryError(
                f"bodies of the regions {names} overlap {where}, and which of them is to have that place is "
                "not known: cut one out of the other, or give one density for the part"
            )
        union = unite(Part(Surface(mesh.vertices, mesh.faces[np.concatenate(group)]))).part
        own, corners = merge_equal_vertices(union.triangles)
        doubts.append(_more_than_once(mesh, group, own[corners]))
        faces.append(corners + sum(map(len, vertices)))
        vertices.append(own)
        origin.append(np.full(len(corners), sources.min()))
        rounding = max(rounding, 0.0 if union.rounding is None else union.rounding.distance)
    if not groups:
        return mesh, []
    rest = mesh.without(np.concatenate([body for group in groups for body in group]))
    every = np.concatenate(vertices), np.concatenate([rest.faces, *faces]), np.concatenate([rest.origin, *origin])
    mesh = _Mesh(*every, mesh.filling, rounding)
    doubt = Doubt.joined(doubts)
    return mesh, [
        Change("overlapping bodies united", sum(map(len, groups)), where, doubt=doubt, code="overlapping_bodies")
    ]


def _more_than_once(mesh: _Mesh, group: list[Int], union: Float) -> Doubt:
    """Return the doubt about what bodies share, of which triangles (m, 3, 3) are the union: it may count twice, or be
    a void."""
    corners = [mesh.vertices[mesh.faces[body]] for body in group]
    low, high = (np.array([side(body, axis=(0, 1)) for body in corners]) for side in (np.min, np.max))
    box = np.stack([low.min(axis=0), high.max(axis=0)])
    middle = box.mean(axis=0)
    shared = max(sum(np.linalg.det(body - middle).sum() for body in corners) - np.linalg.det(union - middle).sum(), 0.0)
    if len(group) <= _FEW:
        i, j = np.triu_indices(len(group), 1)
        common = np.stack([np.maximum(low[i], low[j]), np.minimum(high[i], high[j])], axis=1)
        common = common[(common[:, 0] < common[:, 1]).all(axis=1)]
        box = np.stack([common[:, 0].min(axis=0), common[:, 1].max(axis=0)])
    return Doubt.within(box, shared / 6, shared / 6)


def _overlapping_groups(vertices: Float, faces: Int, bodies: list[Int]) -> tuple[list[list[Int]], str]:
    """Group the bodies (their faces) that overlap; say in words where the first two do."""
    if len(bodies) < 2:
        return [], ""
    corners = [vertices[faces[body]] for body in bodies]
    low = np.array([body.min(axis=(0, 1)) for body in corners])
    high = np.array([body.max(axis=(0, 1)) for body in corners])
    meeting = [np.column_stack([i, j]) for i, j, _ in overlapping(BoxTree(low, high))]
    pairs, places = [], []
    for one, other in sorted(np.concatenate(meeting).tolist()):
        place = overlap(Surface(vertices, faces[bodies[one]]), Surface(vertices, faces[bodies[other]]))
        if place is not None:
            pairs.append((one, other))
            places.append(place)
    if not pairs:
        return [], ""
    first = components(np.array(pairs), len(bodies))
    groups = [np.flatnonzero(first == body) for body in np.unique(first[np.array(pairs)])]
    return [[bodies[body] for body in group] for group in groups], around(np.array(places[:1]))
