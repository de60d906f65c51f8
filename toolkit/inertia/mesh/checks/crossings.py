"""Evidence of bodies that share space, and of surfaces that cross."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby

import numpy as np

from inertia.arrays import Float, Int
from inertia.mesh.checks.findings import Evidence, listed, middle
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.shells import Body, absolute_orientation, bodies, members
from inertia.mesh.geometry.winding import misplaced_volume
from inertia.mesh.part import Surface, Triangles

EXAMINED = 200_000
"""Triangles up to which crossings are looked for without being asked: a tenth of a second."""

_CROSSINGS = 10_000  # crossings looked for, before those between different shells are taken out


def to_be_examined(triangles: Triangles, intersections: bool | None) -> bool:
    """Say whether crossings are to be looked for: as is asked, or else in a surface of up to 200,000 triangles."""
    return triangles.count <= EXAMINED if intersections is None else bool(intersections)


def overlapping_bodies(surface: SurfaceTopology) -> Evidence | None:
    """Find bodies that share space, every shell being turned as its depth asks."""
    from inertia.mesh.geometry.intersect import overlap

    parts = _turned_bodies(surface)
    boxes = np.array([surface.shells[body.shells[0]].box for body in parts])
    meeting = _meeting(boxes)
    if not meeting:
        return None
    triangles_of = members(surface.closure)
    groups = [np.concatenate([triangles_of[number] for number in body.shells]) for body in parts]
    turned = _turned(surface)
    corners = surface.vertices[surface.faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    places, first = [], []
    for one, other in meeting:
        near = [
            (low[group] <= box[1]) & (box[0] <= high[group])
            for group, box in ((groups[one], boxes[other]), (groups[other], boxes[one]))
        ]
        # Where no triangle of one comes near the other, they are apart or nested, which their shells show.
        if not all(meets.all(axis=1).any() for meets in near):
            continue
        # What lies above or below the other body matters for winding numbers, what lies beside it does not.
        a, b = (groups[k][meets[:, :2].all(axis=1)] for k, meets in zip((one, other), near, strict=True))
        place = overlap(turned.select(a), turned.select(b))
        if place is not None:
            places.append(place)
            first += [groups[one][0], groups[other][0]]
    if not places:
        return None
    return Evidence(len(places), listed(np.array(first)), places[0])


def crossing_cavities(surface: SurfaceTopology) -> Evidence | None:
    """Find cavities that break through the wall of their body or into one another."""
    from inertia.mesh.geometry.intersect import crossings

    triangles_of = members(surface.closure)
    total = 0
    pairs, points = [], []
    for body in _turned_bodies(surface):
        boxes = np.array([surface.shells[number].box for number in body.shells])
        for one, others in groupby(_meeting(boxes), key=lambda pair: pair[0]):
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


def self_intersections(surface: SurfaceTopology) -> Evidence | None:
    """Find triangles of one shell (of any piece, where there are no shells) that cross each other."""
    from inertia.mesh.geometry.intersect import crossings

    pairs = crossings(surface.triangles, limit=_CROSSINGS)
    labels = surface.closure.labels[pairs.pairs]
    same = (labels[:, 0] == labels[:, 1]) | (not surface.shells)
    if not same.any():
        return None
    pair, place = pairs.pairs[same], middle(pairs.points[same][:1])
    count = int(same.sum())
    figures = {
        "at_least": "at least " if pairs.truncated else "",
        "one": pair[0, 0],
        "other": pair[0, 1],
        "doubt": _doubt(surface, np.unique(pair)) if surface.shells else "",
    }
    return Evidence(count, listed(np.unique(pair)), place, figures)


def _doubt(surface: SurfaceTopology, crossed: Int) -> str:
    """Say how much of the volume is in doubt: what counts more than once, or less than not at all, by rays."""
    corners = surface.vertices[_turned(surface).faces]
    volume = abs(sum(shell.signed_volume for shell in surface.shells))
    for near in (corners, corners[crossed]):
        misplaced = misplaced_volume(corners, np.stack([near.min(axis=(0, 1)), near.max(axis=(0, 1))]))
        if misplaced > 0:
            share = f" ({100 * misplaced / volume:.2g} % of the stored volume)" if volume > 0 else ""
            return f": about {misplaced:.2g} {surface.unit}³{share}"
    return ": too little for rays to meet it"


def _turned(surface: SurfaceTopology) -> Surface:
    """Return the triangles with every shell turned as its depth asks."""
    faces = surface.faces.copy()
    wrong = np.isin(surface.closure.labels, absolute_orientation(surface.shells))
    faces[wrong] = faces[wrong, ::-1]
    return Surface(surface.vertices, faces)


def _turned_bodies(surface: SurfaceTopology) -> tuple[Body, ...]:
    """Return the bodies that there are when every shell is turned as its depth asks."""
    return bodies(
        [
            shell if shell.kind == "sheet" else replace(shell, kind=("outward", "inward")[shell.depth % 2])
            for shell in surface.shells
        ]
    )


def _meeting(boxes: Float) -> list[tuple[int, int]]:
    """Return the pairs of boxes (n, 2, 3) that overlap, ascending."""
    if len(boxes) < 2:
        return []
    tree = BoxTree(boxes[:, 0], boxes[:, 1])
    return sorted((int(i), int(j)) for ones, others, _ in overlapping(tree) for i, j in zip(ones, others, strict=True))
