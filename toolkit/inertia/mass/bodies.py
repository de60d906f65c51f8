"""Part → groups of equal density, each with its moments, after checking that the question has an answer."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.errors import GeometryError, UsageError
from inertia.mass.exact import METHOD as EXACT
from inertia.mass.exact import exact_moments
from inertia.mass.moments import Moments, moments_of
from inertia.mass.sums import Sums, sum_triangles
from inertia.mesh.check import cell_bodies, check
from inertia.mesh.closure import Closure, closure
from inertia.mesh.part import Cells, Float, Part, Regions, Triangles
from inertia.mesh.shells import Shell, absolute_orientation, shells
from inertia.mesh.shells import bodies as bodies_of

FLOAT64 = "float64, a-priori bound"

Progress = Callable[[float], None] | None


@dataclass(frozen=True)
class Group:
    """A body or region of one density: its name and its moments in the file's unit."""

    name: str
    moments: Moments


@dataclass(frozen=True, eq=False)
class Found:
    """What integrating a part found; lengths in the file's unit.

    `area` is the surface area, `extents` (2, 3) the smallest and largest coordinates, `method` the arithmetic.
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


def surface_groups(
    part: Part,
    named: Iterable[str],
    *,
    shell: bool = False,
    accuracy: float | str | None = None,
    absolute: bool = False,
    progress: Progress = None,
) -> Found:
    """Integrate a triangle surface as a solid, or as a `shell` (whose "volume" is its area).

    Raises `GeometryError` where the surface does not bound a solid that faces outward; with `absolute` an inward
    one, or one with inverted bodies, is integrated by its absolute orientation.
    """
    triangles = part.triangles
    exact = accuracy == "exact"
    if shell and exact:
        raise UsageError("exact arithmetic cannot give a shell's area, which holds square roots: leave it out")
    hangs = closure(triangles, _part_of(progress, 0.0, 0.6))
    sums = sum_triangles(triangles, surface=shell, progress=_part_of(progress, 0.6, 1.0))
    if not shell and hangs.open_edges:
        check(part).require_fit()
    named = list(named)
    pieces = shells(triangles, hangs) if hangs.components != 1 else ()
    whole = exact_moments(triangles, progress) if exact else moments_of(sums, surface=shell)
    notes: list[str] = []
    if shell:
        groups = _shell_groups(part, named, whole)
    elif pieces:
        groups = _body_groups(part, named, hangs, pieces, whole, exact=exact, absolute=absolute, notes=notes)
    else:
        _refuse_unknown(named, ["1"], part.regions)
        groups = (Group("1", _outward(part, whole, absolute, notes)),)
    return Found(
        groups=groups,
        method=EXACT if exact else FLOAT64,
        triangles=triangles.count,
        cells=0,
        closed=hangs.open_edges == 0,
        bodies=len(bodies_of(pieces)) if pieces else hangs.components,
        area=_area(sums),
        extents=np.array([sums.low, sums.high]),
        notes=tuple(notes),
    )


def _outward(part: Part, whole: Moments, absolute: bool, notes: list[str]) -> Moments:
    if abs(whole.zeroth) <= whole.zeroth_bound:
        check(part).require_fit()
        raise GeometryError(
            f"{part.name} has no volume: {float(whole.zeroth):.3g} {part.unit.name}3 with an error bound of "
            f"{float(whole.zeroth_bound):.3g}; use --shell THICKNESS if it is a sheet"
        )
    if whole.zeroth > 0:
        return whole
    if not absolute:
        check(part).require_fit()
    notes.append("the surface faces inward: integrated by its absolute orientation, as asked")
    return whole.scaled(Fraction(-1))


def _body_groups(
    part: Part,
    named: list[str],
    hangs: Closure,
    pieces: tuple[Shell, ...],
    whole: Moments,
    *,
    exact: bool,
    absolute: bool,
    notes: list[str],
) -> tuple[Group, ...]:
    """Integrate a surface of several shells: as one group, or apart where densities are given by name."""
    triangles = part.triangles
    flip = sorted(int(k) for k in absolute_orientation(pieces)) if absolute else []
    check(part).require_fit(orientation="absolute" if absolute else "stored")
    if flip:
        notes.append(f"{len(flip)} of {len(pieces)} shells face the wrong way: integrated by absolute orientation")
    if not named and not flip:
        return (Group("1", whole),)

    def integrate(chosen: Triangles) -> Moments:
        return exact_moments(chosen) if exact else moments_of(sum_triangles(chosen))

    if named and part.regions is not None and set(named) <= set(part.regions.names):
        return _region_groups(part, part.regions, integrate)
    groups = {str(body.number + 1): body.shells for body in bodies_of(pieces)}
    _refuse_unknown(named, groups, part.regions)
    found = []
    for name, members in groups.items():
        moments = None
        for number in members:
            shell = integrate(triangles.select(np.flatnonzero(hangs.labels == number)))
            shell = shell.scaled(Fraction(-1)) if number in flip else shell
            moments = shell if moments is None else moments + shell
        if moments is not None:
            found.append(Group(name, moments))
    return tuple(found)


def _region_groups(part: Part, regions: Regions, integrate: Callable[[Triangles], Moments]) -> tuple[Group, ...]:
    found = []
    names, index = _named_regions(regions)
    for number, name in enumerate(names):
        chosen = part.triangles.select(np.flatnonzero(index == number))
        if chosen.count == 0:
            continue
        if (edges := closure(chosen).open_edges) != 0:
            raise GeometryError(
                f"region {name!r} of {part.name} is not closed by itself: {edges} of its edges have no partner, "
                "so it has no volume of its own to give a density; close it, or give one density for the part"
            )
        found.append(Group(name, integrate(chosen)))
    return tuple(found)


def _shell_groups(part: Part, named: list[str], whole: Moments) -> tuple[Group, ...]:
    if not named:
        return (Group("1", whole),)
    regions = part.regions
    _refuse_unknown(named, [], regions)
    assert regions is not None
    names, index = _named_regions(regions)
    chosen = [part.triangles.select(np.flatnonzero(index == number)) for number in range(len(names))]
    return tuple(
        Group(name, moments_of(sum_triangles(triangles, surface=True), surface=True))
        for name, triangles in zip(names, chosen, strict=True)
        if triangles.count
    )


def cell_groups(part: Part, named: Iterable[str], *, progress: Progress = None) -> Found:
    """Integrate a volume mesh, region by region where densities are given by name."""
    from inertia.mass.cells import boundary_area, cell_moments

    cells = part.geometry
    assert isinstance(cells, Cells)
    if all(block.kind in ("line", "line3", "vertex") for block in cells.blocks):
        raise GeometryError(f"{part.name} holds lines or points only, which have no volume: use --wire AREA for lines")
    check(part).require_fit()
    named = list(named)
    regions = part.regions
    if named:
        _refuse_unknown(named, [], regions)
    names, index = _named_regions(regions) if named and regions is not None else (("1",), None)
    result = cell_moments(cells, index, len(names), progress)
    groups = tuple(
        Group(name, moments) for name, moments in zip(names, result.moments, strict=True) if moments.zeroth != 0
    )
    notes = []
    if result.reversed:
        notes.append(f"{result.reversed} cells number their nodes the other way round: their volume counts positive")
    return Found(
        groups=groups,
        method="float64 quadrature exact for each cell's map, a-priori bound",
        triangles=0,
        cells=cells.count,
        closed=True,
        bodies=int(cell_bodies(cells).max()) + 1,
        area=boundary_area(cells),
        extents=_extents(cells),
        notes=tuple(notes),
    )


def wire_group(part: Part) -> Found:
    """Integrate the lines of a mesh as wires; the "volume" of the group is its length."""
    from inertia.mass.cells import wire_moments

    cells = part.geometry
    if not isinstance(cells, Cells) or not any(block.kind.startswith("line") for block in cells.blocks):
        raise GeometryError(f"{part.name} holds no lines for a wire: leave --wire out, or use --shell THICKNESS")
    return Found(
        groups=(Group("1", wire_moments(cells)),),
        method="float64 lengths, exact moments",
        triangles=0,
        cells=cells.count,
        closed=False,
        bodies=1,
        area=0.0,
        extents=_extents(cells),
    )


def _named_regions(regions: Regions) -> tuple[tuple[str, ...], NDArray[np.int32]]:
    """Return the regions' names and each element's number, with the elements of no region as region ""."""
    if (regions.index >= 0).all():
        return regions.names, regions.index
    rest = np.int32(len(regions.names))
    return (*regions.names, ""), np.where(regions.index < 0, rest, regions.index)


def _area(sums: Sums) -> float:
    """Return the surface area Σ|n|/2 in the file's unit."""
    try:
        return float(Fraction(float(sums.sums[11])) / 2 * Fraction(4) ** -sums.exponent)
    except OverflowError:
        raise GeometryError("the surface area is above 1.8e308: give the coordinates in a larger unit") from None


def _extents(cells: Cells) -> Float:
    used = np.unique(np.concatenate([block.nodes.ravel() for block in cells.blocks]))
    points = cells.points[used]
    return np.array([points.min(axis=0), points.max(axis=0)])


def _refuse_unknown(named: Iterable[str], known: Mapping[str, Any] | list[str], regions: Regions | None) -> None:
    names = [*known, *(regions.names if regions is not None else ())]
    for key in named:
        if key not in names:
            close = get_close_matches(key, names, n=1)
            hint = f" (did you mean {close[0]!r}?)" if close else ""
            there = f"it has {', '.join(map(repr, names[:12]))}" if names else "it names none"
            raise UsageError(f"the part has no region or body called {key!r}{hint}: {there}")


def _part_of(progress: Progress, start: float, stop: float) -> Progress:
    return None if progress is None else lambda done: progress(start + done * (stop - start))
