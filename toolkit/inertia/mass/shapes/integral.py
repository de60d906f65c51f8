"""Integration of a part's true shape: the moments of its solids, each where it is placed, grouped by density."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from inertia.arrays import Float, Int, Parts, Progress
from inertia.errors import SEPARATE, TESSELLATED, GeometryError, visible
from inertia.mass.integration import Group, Integral, TrueShape, refuse_unknown, surface_integrals
from inertia.mass.moments import ZERO, Moments, total
from inertia.mass.shapes.solids import SolidMoments, solid_moments
from inertia.mass.tessellation import chord_bound
from inertia.mesh.part import Part
from inertia.mesh.readers.contents import UNNAMED
from inertia.mesh.shape import Shape

METHOD = "the faces of the true shape, by Gauss–Kronrod quadrature along their edges"

_USUAL, _FINEST = 1e-10, 1e-15
_RIGID = 1e-9  # that a placement may be off a rotation
_SLACK = 2  # times the chord, that triangles may be off
_COARSE = Fraction(1, 10)  # of the volume, that they may be off where no chord is stated


def shape_integrals(
    part: Part,
    named: Collection[str],
    *,
    shell: bool = False,
    accuracy: float | None = None,
    absolute: bool = False,
    intersections: bool | None = None,
    parts: Parts = "together",
    progress: Progress | None = None,
) -> Iterator[Integral]:
    """Integrate the true shape of a part, its solids or with `shell` its faces, as `surface_integrals` does triangles.

    Its triangles are looked at too: by them solids are refused that share space deeper than the chord, and their volume
    has to agree within the chord. They take the place of a shape that cannot be integrated, and a note says why, unless
    an accuracy is asked for.

    Raises `GeometryError` where there is none such, or the triangles contradict the shape.
    """
    shape = part.shape
    assert shape is not None

    def of_triangles(names: Collection[str], parts: Parts) -> Iterator[Integral]:
        return surface_integrals(
            part, names, shell=shell, absolute=absolute, intersections=intersections, parts=parts, progress=progress
        )

    try:
        triangles = next(of_triangles((), parts))
        doubts, notes = triangles.doubts, triangles.notes
    except GeometryError as fault:
        if SEPARATE not in fault.remedies:
            raise
        triangles, doubts = next(of_triangles((), "separate")), ()
        notes = (
            *triangles.notes,
            "solids touch or overlap no deeper than the chord of their triangles; each counts whole",
        )
    keys = _keys(part, shape, named)
    coarsest = _USUAL if accuracy is None else 0.5 * accuracy
    for step in (coarsest, *(k for k in (1e-2 * coarsest, _FINEST) if k < coarsest)):
        try:
            solids, alone = _placed(shape, step, shell)
            agrees = step != coarsest or shell or _agrees(part, triangles, total(solids))
            if not agrees and triangles.turned is not None:
                raise GeometryError("an absolute orientation makes cavities of triangles alone")
        except GeometryError as fault:
            if accuracy is not None:
                raise GeometryError(f"{part.name}: {fault}: use ", TESSELLATED, " for its triangles") from None
            note = f"the triangles were integrated, as the true shape cannot be: {fault}"
            yield from (replace(integral, notes=(*integral.notes, note)) for integral in of_triangles(named, parts))
            return
        if not agrees:
            raise _disagreement(part, triangles, total(solids))
        groups = {"1": list(range(len(solids)))}
        if named:
            groups = {key: [k for k, own in enumerate(keys) if own == key] for key in dict.fromkeys(keys)}
        yield replace(
            triangles,
            groups=tuple(
                Group(key, total(solids[k] for k in own), _triangles_of(part, key) if named else None)
                for key, own in groups.items()
            ),
            method=METHOD,
            closed=all(solid.closed for solid in shape.solids),
            bodies=len(solids),
            area=math.fsum(one.area for one in alone),
            doubts=doubts,
            notes=notes,
            shape=TrueShape(
                tuple(zip(shape.solids, solids, strict=True)),
                max(one.gap for one in alone),
                any(one.loose for one in alone),
                sum(len(solid.faces) for solid in shape.solids),
            ),
        )
        if all(one.settled for one in alone):
            return


def _keys(part: Part, shape: Shape, named: Collection[str]) -> list[str]:
    """Return by which name the density of each solid is stated; refuse names that none has."""
    numbers = [str(k + 1) for k in range(len(shape.solids))]
    regions = () if part.regions is None else part.regions.names
    names = [UNNAMED if regions and solid.name not in regions else solid.name for solid in shape.solids]
    keys = numbers if named and not set(named) & set(names) and set(named) <= set(numbers) else names
    refuse_unknown(named, dict.fromkeys(keys))
    return keys


def _triangles_of(part: Part, name: str) -> Int | None:
    regions = part.regions
    if regions is None or name not in regions.names:
        return None
    return np.flatnonzero(regions.index == regions.names.index(name))


def _placed(shape: Shape, accuracy: float, shell: bool) -> tuple[list[Moments], list[SolidMoments]]:
    """Return the moments of each solid where it is, and in its own frame; those that are the same are computed once."""
    if not shape.solids:
        raise GeometryError("it has no solids")
    known: dict[int, SolidMoments] = {}
    placed = []
    for number, solid in enumerate(shape.solids, 1):
        try:
            if id(solid.faces) not in known:
                known[id(solid.faces)] = solid_moments(solid, shape.tolerances, accuracy, surface=shell)
            placed.append(_moved(known[id(solid.faces)].moments, solid.placement))
        except GeometryError as fault:
            raise GeometryError(f"solid {number} ({visible(solid.name)}): {fault}") from None
    return placed, [known[id(solid.faces)] for solid in shape.solids]


def _moved(moments: Moments, placement: Float) -> Moments:
    """Return the moments of a solid that is placed, x → R x + t by the columns R and t of the placement."""
    turn, shift = placement[:, :3], placement[:, 3]
    if not np.isfinite(placement).all() or np.abs(turn @ turn.T - np.eye(3)).max() > _RIGID:
        raise GeometryError("its place is given by what is no rotation and translation")
    if (turn != np.eye(3)).any():
        moments = moments.turned([[Fraction(k) for k in row] for row in turn.T.tolist()], (ZERO,) * 3)
    x, y, z = (k + Fraction(d) for k, d in zip(moments.origin, shift.tolist(), strict=True))
    return replace(moments, origin=(x, y, z))


def _agrees(part: Part, triangles: Integral, whole: Moments) -> bool:
    """Say whether the triangles of a shape have its volume, as far as their chord allows."""
    mesh = total(group.moments for group in triangles.groups)
    between = _COARSE * mesh.zeroth
    if part.chord is not None:
        between = chord_bound(part.triangles, _SLACK * part.chord, mesh.origin).zeroth_bound
    between += sum((Fraction(finding.doubt.volume) for finding in triangles.doubts if finding.doubt), ZERO)
    return abs(whole.zeroth - mesh.zeroth) <= between + whole.zeroth_bound + mesh.zeroth_bound


def _disagreement(part: Part, triangles: Integral, whole: Moments) -> GeometryError:
    mesh = total(group.moments for group in triangles.groups)
    return GeometryError(
        f"{part.name}: the faces of the true shape enclose {float(whole.zeroth):.6g} {part.unit.name}³, and the "
        f"triangles in their place {float(mesh.zeroth):.6g}, which is farther apart than their chord tolerance "
        "allows: the file is damaged; export it again, or use ",
        TESSELLATED,
        " for the triangles",
    )
