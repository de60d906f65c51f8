"""Union of a part whose regions or bodies may have densities of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inertia.arrays import Progress
from inertia.errors import GeometryError, placed
from inertia.estimate import uncertainty_of
from inertia.mass.density import Densities
from inertia.mass.integration import require_closed
from inertia.mesh.part import Part, Regions, Rounding
from inertia.mesh.surface import Surface
from inertia.mesh.unite import Union, unite

_CONTACT = 1e-9  # of the room that a part takes: what regions that touch may share by rounding


def united_for(part: Part, stated: Densities, progress: Progress | None = None) -> tuple[Union, Densities]:
    """Return the union of a part, and the densities that its parts have then.

    Regions with densities of their own are united each by itself, and may not share space; bodies that have some are
    not united with others.

    Raises
    ------
    GeometryError : as of `unite`, and where the density of some place is not known
    """
    named = {name: stated.of(name) for name in stated.named}
    if named and stated.default is not None:
        named[""] = stated.default
    certain = len(named) == 1 or not any(map(uncertainty_of, named.values()))
    if len({*named.values()}) == 1 and certain and (stated.default is not None or part.regions is None):
        stated = replace(stated, default=next(iter(named.values())), named={})
    if not stated.named:
        return unite(part, progress), stated
    if part.regions is not None and set(stated.named) <= set(part.regions.names):
        return _regions_united(part, part.regions), stated
    union = unite(part, progress)
    if union.part is not part:
        raise GeometryError(
            f"{part.name}: densities are given for bodies, and bodies that are united are one: give one density"
        )
    return union, stated


def _regions_united(part: Part, regions: Regions) -> Union:
    unions, origins = [], []
    for number in np.unique(regions.index).tolist():
        which = np.flatnonzero(regions.index == number)
        labels = Regions(regions.names, regions.index[which])
        own = replace(part, geometry=part.triangles.select(which), regions=labels, shape=None)
        if part.chord is not None:
            own = replace(own, chord=part.chord[which])
        if part.rounding is not None:
            own = replace(own, rounding=Rounding(part.rounding.distance))
        name = regions.names[number] if number >= 0 else ""
        require_closed(part, name, own.triangles)
        try:
            unions.append(unite(own))
        except GeometryError as fault:
            raise placed(fault, f"region {name!r}") from None
        origins.append(which if unions[-1].origins is None else which[unions[-1].origins])
    whole = unite(part)
    more, negative = (sum(getattr(union, name) for union in unions) for name in ("more_than_once", "negative"))
    corners = part.triangles.corners()
    room = float(np.prod(corners.max(axis=(0, 1)) - corners.min(axis=(0, 1))))
    if max(abs(whole.more_than_once - more), abs(whole.negative - negative)) > _CONTACT * room:
        raise GeometryError(
            f"{part.name}: regions of different densities share space, and which of them is to have it is not known: "
            "cut one out of the other, or give them one density"
        )
    if whole.part is part:
        return whole
    together = _together(part, [union.part for union in unions])
    return Union(together, whole.crossings, more, negative, np.concatenate(origins))


def _together(part: Part, apart: list[Part]) -> Part:
    """Return the regions of a part, united each by itself, as one part again."""
    corners = [each.triangles.corners().reshape(-1, 3) for each in apart]
    surface = Surface(np.concatenate(corners), np.arange(sum(map(len, corners))).reshape(-1, 3))
    surface.counts_once = True
    roundings = [each.rounding.distance for each in apart if each.rounding is not None]
    chords = [each.chord for each in apart if each.chord is not None]
    regions = [each.regions for each in apart if each.regions is not None]
    return replace(
        part,
        geometry=surface,
        regions=Regions(regions[0].names, np.concatenate([each.index for each in regions])),
        rounding=Rounding(max(roundings)) if roundings else None,
        chord=np.concatenate(chords) if chords else None,
        shape=None,
    )
