"""Integration of a part: the moments of its groups of equal density, after checking that there is an answer."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from difflib import get_close_matches
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, Parts, Progress
from inertia.errors import SHELL, GeometryError, Remedy, UsageError, placed
from inertia.mass.moments import Moments
from inertia.mass.triangles.arithmetic import METHODS, Arithmetic, arithmetics, shell_moments, solid_moments
from inertia.mass.triangles.block_sums import sum_block
from inertia.mass.triangles.sums import SummedFacets, Sums, sum_triangles
from inertia.mesh.checks.doubled_faces import doubled_faces
from inertia.mesh.checks.findings import Finding, Report, around, middle
from inertia.mesh.geometry.closure import Closure, closure, paired_by_keys
from inertia.mesh.geometry.intersect import crosses, to_be_examined
from inertia.mesh.geometry.irregular_edges import Irregular
from inertia.mesh.geometry.shells import Shell, absolute_orientation, shells, soundly_nested
from inertia.mesh.geometry.shells import bodies as bodies_of
from inertia.mesh.geometry.simple import MOST, PIECES, SIMPLE, at_hand, not_simple, states
from inertia.mesh.geometry.sound_shells import Nesting, nesting_of
from inertia.mesh.part import Cells, Part, Regions
from inertia.mesh.shape import Solid
from inertia.mesh.surface import Facets, Surface, Triangles, counts_once, usable
from inertia.once import once
from inertia.records import dataclass

_SMALL = 20_000  # triangles; in a larger surface, pairing the edges by themselves costs next to nothing
MOSTLY = 0.5  # of a surface: what is more is checked as a whole

_ANY_WIRE = Remedy("analyse", "wire")

_CELL_METHODS: dict[Literal["float64", "double-double"], str] = {
    "float64": "float64 quadrature exact for each cell's map, a-priori bound",
    "double-double": "double-double quadrature exact for each cell's map, a-priori bound",
}

_WIRE_METHODS: dict[Literal["float64", "double-double"], str] = {
    "float64": "float64 quadrature, a-priori bound (an estimate for curved lines)",
    "double-double": "double-double quadrature, a-priori bound",
}


@dataclass(frozen=True)
class Group:
    """A body or region of one density: its name, its moments in the file's unit, and which elements it is.

    `members` are the numbers of its triangles or cells; None where it has all of them.
    """

    name: str
    moments: Moments
    members: Int | None = None


@dataclass(frozen=True, eq=False)
class Integral:
    """The moments of a part, group by group, and what was counted on the way; lengths in the file's unit.

    `area` is the surface area, `extents` (2, 3) the smallest and largest coordinates, `method` the arithmetic;
    `crossings_examined` says whether triangles that cross one another were looked for, `doubts` what leaves some of
    the volume in doubt: that is not in the moments' bounds. `turned` says which triangles were integrated with their
    winding reversed, if some were; `shape` is there where it was integrated in place of the triangles.
    """

    groups: tuple[Group, ...]
    method: str
    triangles: int
    cells: int
    closed: bool
    bodies: int
    area: float
    extents: Float
    notes: tuple[str, ...] = ()
    crossings_examined: bool = False
    doubts: tuple[Finding, ...] = ()
    turned: Bool | None = None
    shape: TrueShape | None = None


@dataclass(frozen=True, eq=False)
class TrueShape:
    """What was integrated in place of triangles; lengths in the file's unit.

    Attributes
    ----------
    solids : each with its moments where it is placed
    gap : the largest distance between the two sides of an edge
    loose : whether such gaps count more than rounding in the bounds
    faces : how many there are
    """

    solids: tuple[tuple[Solid, Moments], ...]
    gap: float
    loose: bool
    faces: int


def surface_integrals(
    part: Part,
    named: Collection[str],
    *,
    shell: bool = False,
    accuracy: float | str | None = None,
    absolute: bool = False,
    intersections: bool | None = None,
    parts: Parts = "together",
    allowance: float = 0.0,
    turned: bool = False,
    progress: Progress | None = None,
) -> Iterator[Integral]:
    """Integrate a triangle surface as a solid, or as a `shell` (whose "volume" is its area).

    Yields an integral for each arithmetic that `accuracy` names, from the cheapest to the dearest: whoever has
    one that is good enough asks for no further.

    Raises `GeometryError` where the surface does not bound a solid that faces outward; with `absolute` an inward
    one, or one with inverted bodies, is integrated by its absolute orientation. A shell of a solid that crosses itself
    is refused too, where `intersections` are asked for, or there are so few triangles that looking costs little.
    """
    triangles = part.triangles
    if triangles.count == 0:
        _check(part).require_fit()
    if shell and accuracy == "exact":
        raise UsageError("exact arithmetic cannot give a shell's area, which holds square roots: leave it out")
    tries = arithmetics(accuracy)
    paired, summed = (0.6, 1.0) if shell or accuracy is None else (0.1, 0.2)
    looked = _looked_at(triangles, intersections) if not shell else None
    summed_meanwhile = of_block = None
    if looked == SIMPLE:
        topology = once("closure", triangles, lambda: Closure.simple(triangles.count))
        of_block = sum_block(triangles)
    else:
        with naming(part):
            summed_meanwhile = SummedFacets(triangles, surface=shell) if isinstance(triangles, Facets) else None
        pairing = _part_of(progress, 0.0, paired)
        topology = once("closure", triangles, lambda: closure(summed_meanwhile or triangles, pairing))
    with naming(part):
        summing = _part_of(progress, paired, summed)
        if summed_meanwhile is not None:
            sums = summed_meanwhile.sums(summing)
        else:
            sums = of_block or sum_triangles(triangles, surface=shell, progress=summing)
    extents = np.array([sums.low, sums.high])
    if not usable(extents).all():
        _check(part, intersections).require_fit()
    if topology.open_edges and not shell:
        _refuse_open(part, intersections, extents)
    several = not shell and (topology.components != 1 or topology.crowded > 0)
    nesting = nesting_of(triangles, topology) if several and not named else None
    near = None
    if nesting is not None and len(nesting.suspects) and parts == "together":
        near = _where_near(part, topology, nesting, extents)
    apart = nesting is not None and (near is not None or not len(nesting.suspects))
    pieces = once("shells", triangles, lambda: shells(triangles, topology)) if several and not apart else ()
    proven = counts_once(triangles)
    sound = bool(pieces) and not topology.crowded and soundly_nested(triangles, topology, pieces)
    wrong = _wrong(triangles, pieces, sums) if absolute and not (turned or shell or proven) else ()
    if len(wrong):
        if pieces:
            _check(part, intersections, parts, allowance).require_fit("absolute", turned=True)
        turn = np.isin(topology.labels, wrong)
        other = replace(part, geometry=_turned(triangles, turn))
        note = f"{len(wrong)} of {topology.components} shells turned, as absolute orientation was asked for"
        again = surface_integrals(
            other,
            named,
            accuracy=accuracy,
            absolute=True,
            intersections=intersections,
            parts=parts,
            allowance=allowance,
            turned=True,
        )
        for integral in again:
            yield replace(integral, notes=(note,), turned=turn)
        return
    examined = not shell and to_be_examined(triangles, intersections, topology.crowded)
    report = near
    if examined and not proven:
        crossed, examined = _crossed(triangles, topology, apart, intersections, looked)
        if crossed:
            report = _sound(part, intersections, parts, allowance, absolute)
    integral = Integral(
        groups=(),
        method=METHODS["float64"],
        triangles=triangles.count,
        cells=0,
        closed=topology.open_edges == 0,
        bodies=len(bodies_of(pieces)) if pieces else nesting.bodies if nesting else topology.components,
        area=surface_area(sums),
        extents=extents,
        notes=_twice(triangles) if shell else (),
        crossings_examined=examined or (proven and not shell),
    )
    for k, arithmetic in enumerate(tries[:2] if shell else tries):
        start, stop = (summed + (1.0 - summed) * step / len(tries) for step in (k, k + 1))
        further = _part_of(progress, start, stop)
        if shell:
            groups = _shell_groups(part, named, arithmetic, sums, further)
            yield replace(integral, groups=groups, method=METHODS[arithmetic])
            continue
        whole = solid_moments(triangles, arithmetic, sums, further, part.rounding)
        negative = whole.zeroth < -whole.zeroth_bound
        if report is None and negative and topology.components == 1 and not (topology.crowded or proven or absolute):
            _refuse_inward(part, topology, extents)
        if report is None and ((pieces and not proven and not sound) or negative):
            report = _sound(part, False, parts, allowance, absolute)
        if whole.zeroth > whole.zeroth_bound:
            groups = _solid_groups(part, named, topology, pieces, whole, arithmetic)
            doubts = () if report is None else report.doubts
            yield replace(integral, groups=groups, method=METHODS[arithmetic], doubts=doubts)
        elif arithmetic == tries[-1]:
            refuse_flat(part, whole, extents)


def _twice(triangles: Triangles) -> tuple[str, ...]:
    """Return a note where a shell has area that lies on its own."""
    where = doubled_faces(triangles)
    if where is None:
        return ()
    remedy = "leave copies and backs out, or give half the thickness of a sheet that has both its sides all over"
    return (f"{where}, and the area of each counts: {remedy}",)


def _looked_at(triangles: Triangles, intersections: bool | None) -> int | None:
    """Return what one pass shows a small surface to be, if crossings are to be looked for; it pairs the edges, too."""
    if triangles.count > _SMALL or not to_be_examined(triangles, intersections) or not at_hand():
        return None
    return _state(triangles)


def sums_of_small(triangles: Triangles) -> Sums | None:
    """Return the sums that a small surface which one pass shows to be simple has; None for any other."""
    return sum_block(triangles) if _looked_at(triangles, None) == SIMPLE else None


def _state(triangles: Triangles) -> int:
    """Return what `states` says of a surface."""
    count = triangles.count
    table = np.array([[0, 3 * count, 0, count]])
    return int(states(triangles.corners().reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), table)[0])


def _crossed(
    triangles: Triangles, topology: Closure, apart: bool, intersections: bool | None, looked: int | None
) -> tuple[bool, bool]:
    """Say whether triangles cross, and whether all were looked through; `apart`, where what shells do is known.

    Of a surface that is not looked through without being asked, the shells with edges of more than two triangles are.
    """
    if looked is not None and looked <= PIECES:
        return False, True
    by_a_pass = not topology.open_edges and at_hand()
    if not apart or topology.components == 1:
        once_through = by_a_pass and looked is None and not topology.crowded and triangles.count <= MOST
        return not (once_through and _state(triangles) <= PIECES) and crosses(triangles), True
    labels = topology.labels
    which = np.arange(len(labels))
    if not to_be_examined(triangles, intersections):
        which = np.flatnonzero(np.isin(labels, np.unique(labels[topology.at_crowded])))
    examined = len(which) == len(labels)
    if by_a_pass and not topology.repeated:
        which = not_simple(triangles, labels, which)
    return crosses(triangles.select(which), labels=labels[which]), examined


def _sound(part: Part, intersections: bool | None, parts: Parts, allowance: float, turned: bool) -> Report:
    report = _check(part, intersections, parts, allowance)
    report.require_fit(turned=turned)
    return report


def _where_near(part: Part, topology: Closure, nesting: Nesting, extents: Float) -> Report | None:
    """Return what is found of the shells that may meet others; None where they have faults, or are most of the part.

    Those around them are checked with them, for their depths.
    """
    if part.chord is not None or part.filling is not None:
        return None
    chosen, shells = np.zeros(topology.components + 1, bool), nesting.suspects  # the last is that of triangles in none
    while len(shells):
        chosen[shells] = True
        shells = np.setdiff1d(nesting.parent[shells], -1)
    labels = topology.labels
    which = np.flatnonzero(chosen[labels])
    if len(which) > MOSTLY * len(labels):
        return None
    from inertia.mesh.check import check_some  # slow to import, and most surfaces need none

    report = check_some(part, which, extents)
    return report if report.fit else None


def _check(part: Part, intersections: bool | None = None, parts: Parts = "together", allowance: float = 0.0) -> Report:
    from inertia.mesh.check import check  # slow to import, and most surfaces need none

    return check(part, intersections=intersections, parts=parts, allowance=allowance)


@contextmanager
def naming(part: Part) -> Iterator[None]:
    """Name the part in the errors of what knows its numbers only."""
    try:
        yield
    except GeometryError as fault:
        raise placed(fault, part.name) from None


def _wrong(triangles: Triangles, pieces: tuple[Shell, ...], sums: Sums) -> Int:
    """Return the numbers of the shells that absolute orientation turns."""
    if pieces:
        return absolute_orientation(pieces)
    whole = solid_moments(triangles, "float64", sums)
    if abs(whole.zeroth) <= whole.zeroth_bound:
        whole = solid_moments(triangles, "exact")
    return np.arange(1 if whole.zeroth < -whole.zeroth_bound else 0)


def _turned(triangles: Triangles, which: NDArray[np.bool_]) -> Triangles:
    if isinstance(triangles, Facets):
        result = Facets(triangles.records.copy())
        corners = result.corners_f4()
        corners[which] = corners[which, ::-1]
        return result
    faces = triangles.faces.copy()
    faces[which] = faces[which, ::-1]
    return Surface(triangles.vertices, faces)


def _refuse_open(part: Part, intersections: bool | None, extents: Float) -> None:
    """Raise `GeometryError` for an open surface: by what is at its irregular edges, unless it is cracked there."""
    known = None if intersections else paired_by_keys(part.triangles)
    if known is not None:
        from inertia.mesh.checks.edge_faults import edge_faults  # slow to import, and most surfaces need none
        from inertia.mesh.repairs.weld import may_close

        edges = known[1].edges
        if not may_close(known[1].vertices, extents, edges.ends, edges.forward - edges.backward):
            refuse_faults(part, edge_faults(part, *known, (), extents))
    _check(part, intersections).require_fit()


def _refuse_inward(part: Part, topology: Closure, extents: Float) -> None:
    """Raise `GeometryError` for the one shell of a surface without irregular edges, unless it is next to a sheet."""
    from inertia.mesh.checks.edge_faults import shell_findings  # slow to import, and most surfaces need none

    triangles = part.triangles
    pieces = once("shells", triangles, lambda: shells(triangles, topology))
    refuse_faults(part, shell_findings(part, topology, Irregular.none(triangles), pieces, extents))


def refuse_faults(part: Part, remarks: Iterable[Finding]) -> tuple[Finding, ...]:
    """Raise `GeometryError` for the first error; return what leaves some of the volume in doubt."""
    report = Report(part.source, part.triangles.count, 0, False, False, None, 0, (), (), tuple(remarks))
    report.require_fit()
    return report.doubts


def refuse_flat(part: Part, whole: Moments, box: Float) -> None:
    """Raise `GeometryError` for a closed surface without volume, whose box (2, 3) says where it is."""
    raise GeometryError(
        f"{part.name} has no volume: {float(whole.zeroth):.3g} {part.unit.name}³ {around(middle(box), box)}, with "
        f"an error bound of {float(whole.zeroth_bound):.3g}: use ",
        SHELL,
        " if it is a sheet",
    )


def _solid_groups(
    part: Part,
    named: Collection[str],
    topology: Closure,
    pieces: tuple[Shell, ...],
    whole: Moments,
    arithmetic: Arithmetic,
) -> tuple[Group, ...]:
    """Integrate a sound surface: as one group, or its regions or bodies apart where densities name them."""
    if not named:
        return (Group("1", whole),)

    def integrate(triangles: Triangles) -> Moments:
        return solid_moments(triangles, arithmetic, rounding=part.rounding)

    bodies = {str(body.number + 1): body.shells for body in bodies_of(pieces)} or {"1": ()}
    refuse_unknown(named, bodies, part.regions)
    if part.regions is not None and (regions := sorted(set(named) & set(part.regions.names))):
        if numbers := sorted(set(named) - set(regions)):
            raise UsageError(
                f"densities are given for regions ({regions[0]!r}) and for bodies by number ({numbers[0]!r}), which "
                f"may share volume: name regions only (it has {_listed(part.regions.names)}), or bodies only"
            )
        return _region_groups(part, part.regions, integrate)
    if not pieces:
        return (Group("1", whole),)
    owner = np.full(topology.components + 1, -1)  # the last one is that of triangles in no shell
    for number, body in enumerate(bodies.values()):
        owner[list(body)] = number
    of_triangle = owner[topology.labels]
    order = np.argsort(of_triangle, kind="stable")
    members = np.split(order, np.searchsorted(of_triangle[order], np.arange(len(bodies))))[1:]
    return tuple(
        Group(name, integrate(part.triangles.select(which)), which) for name, which in zip(bodies, members, strict=True)
    )


def _region_groups(part: Part, regions: Regions, integrate: Callable[[Triangles], Moments]) -> tuple[Group, ...]:
    groups = []
    names, index = _named_regions(regions)
    for number, name in enumerate(names):
        members = np.flatnonzero(index == number)
        surface = part.triangles.select(members)
        if surface.count == 0:
            continue
        require_closed(part, name, surface)
        moments = integrate(surface)
        if moments.zeroth < -moments.zeroth_bound:
            raise GeometryError(
                f"region {name!r} of {part.name} faces inward and has a volume of {float(moments.zeroth):.3g} "
                f"{part.unit.name}³ by itself, as the wall of a cavity has: give one density for the part, or number "
                "its bodies"
            )
        groups.append(Group(name, moments, members))
    return tuple(groups)


def require_closed(part: Part, region: str, surface: Triangles) -> None:
    """Raise `GeometryError` where the triangles of a region with a density of its own are open."""
    if (edges := closure(surface).open_edges) != 0:
        raise GeometryError(
            f"region {region!r} of {part.name} is not closed by itself: {edges} of its edges have no partner, "
            "so it has no volume of its own to give a density; close it, or give one density for the part"
        )


def _shell_groups(
    part: Part, named: Collection[str], arithmetic: Arithmetic, sums: Sums, progress: Progress | None
) -> tuple[Group, ...]:
    if not named:
        return (Group("1", shell_moments(part.triangles, arithmetic, sums, progress, part.rounding)),)
    regions = part.regions
    refuse_unknown(named, [], regions)
    assert regions is not None
    names, index = _named_regions(regions)
    members = (np.flatnonzero(index == number) for number in range(len(names)))
    return tuple(
        Group(name, shell_moments(part.triangles.select(which), arithmetic, rounding=part.rounding), which)
        for name, which in zip(names, members, strict=True)
        if len(which)
    )


def cell_integrals(
    part: Part, named: Collection[str], *, intersections: bool | None = None, progress: Progress | None = None
) -> Iterator[Integral]:
    """Integrate a volume mesh, region by region where densities are given by name: in float64, then double-double."""
    from inertia.mass.cells.moments import boundary_area, cell_moments

    cells = part.geometry
    assert isinstance(cells, Cells)
    report = _check(part, intersections)
    report.require_fit()
    regions = part.regions
    if named:
        refuse_unknown(named, [], regions)
    names, index = _named_regions(regions) if named and regions is not None else (("1",), None)
    area, extents = boundary_area(cells), _extents(cells)
    for arithmetic in _CELL_METHODS:
        with naming(part):
            result = cell_moments(cells, index, len(names), progress, arithmetic, part.rounding)
        one = result.reversed == 1
        turned = (
            f"{result.reversed} {'cell numbers its' if one else 'cells number their'} nodes the other way round: "
            f"{'its' if one else 'their'} volume counts positive"
        )
        yield Integral(
            groups=_cell_groups(names, index, result.moments),
            method=_CELL_METHODS[arithmetic],
            triangles=0,
            cells=cells.count,
            closed=True,
            bodies=report.bodies,
            area=area,
            extents=extents,
            notes=(turned,) if result.reversed else (),
            crossings_examined=report.crossings_examined,
        )


def wire_integrals(part: Part, named: Collection[str], progress: Progress | None = None) -> Iterator[Integral]:
    """Integrate the lines of a mesh as wires, region by region where densities are given by name.

    Their "volume" is their length; straight ones are integrated in double-double, too.
    """
    from inertia.mass.cells.moments import wire_moments

    cells = part.geometry
    if not isinstance(cells, Cells) or not any(block.kind.startswith("line") for block in cells.blocks):
        if isinstance(cells, Cells):
            raise GeometryError(f"{part.name} holds no lines for a wire: leave ", _ANY_WIRE, " out")
        without = f"{part.name} holds no lines for a wire (lines beside faces are not read): leave "
        raise GeometryError(without, _ANY_WIRE, " out, or use ", SHELL)
    regions = part.regions
    if named:  # where the file names no region, the whole is body 1, as one body of triangles is
        refuse_unknown(named, ["1"] if regions is None else [], regions)
    names, index = _named_regions(regions) if named and regions is not None else (("1",), None)
    notes: tuple[str, ...] | None = None
    methods = dict(_WIRE_METHODS)
    if any(block.kind == "line3" for block in cells.blocks):
        del methods["double-double"]
    for arithmetic, method in methods.items():
        with naming(part):
            moments = wire_moments(cells, index, len(names), arithmetic, part.rounding)
        if notes is None:  # the nodes are known to be there
            found = (each for each in _check(part).findings if each.code == "duplicate_cell")
            notes = tuple(each.message for each in found if each.severity == "warning")
        if progress is not None:
            progress(1.0)
        yield Integral(
            groups=_cell_groups(names, index, moments),
            method=method,
            triangles=0,
            cells=cells.count,
            closed=False,
            bodies=1,
            area=0.0,
            extents=_extents(cells),
            notes=notes,
        )


def _cell_groups(
    names: tuple[str, ...], index: NDArray[np.int32] | None, moments: tuple[Moments, ...]
) -> tuple[Group, ...]:
    """Return the groups of cells that have a volume (of lines: a length), or may have one; others need no density."""
    groups = [
        Group(name, one, None if index is None else np.flatnonzero(index == number))
        for number, (name, one) in enumerate(zip(names, moments, strict=True))
    ]
    return tuple(group for group in groups if group.moments.zeroth or group.moments.zeroth_bound) or tuple(groups)


def _named_regions(regions: Regions) -> tuple[tuple[str, ...], NDArray[np.int32]]:
    """Return the regions' names and each element's number, with the elements of no region as region ""."""
    if (regions.index >= 0).all():
        return regions.names, regions.index
    rest = np.int32(len(regions.names))
    return (*regions.names, ""), np.where(regions.index < 0, rest, regions.index)


def surface_area(sums: Sums) -> float:
    """Return the surface area Σ|n|/2 in the file's unit."""
    n, d = sums.area.as_integer_ratio()
    up, down = max(-2 * sums.exponent, 0), max(2 * sums.exponent, 0)
    return (n << up) / (d << (down + 1))


def _extents(cells: Cells) -> Float:
    used = np.unique(np.concatenate([block.nodes.ravel() for block in cells.blocks]))
    points = cells.points[used]
    return np.array([points.min(axis=0), points.max(axis=0)])


def _listed(names: Sequence[str]) -> str:
    return ", ".join(map(repr, names[:12]))


def refuse_unknown(named: Iterable[str], known: Iterable[str], regions: Regions | None = None) -> None:
    """Refuse names that are neither known nor those of regions."""
    names = [*known, *(regions.names if regions is not None else ())]
    for key in named:
        if key not in names:
            close = get_close_matches(key, names, n=1)
            hint = f" (did you mean {close[0]!r}?)" if close else ""
            there = f"it has {_listed(names)}" if names else "it names none"
            raise UsageError(f"the part has no region or body called {key!r}{hint}: {there}", code="unknown_region")


def _part_of(progress: Progress | None, start: float, stop: float) -> Progress | None:
    return None if progress is None or start == stop else lambda done: progress(start + done * (stop - start))
