"""Findings about bodies that share space and surfaces that cross, one function for each kind."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby

import numpy as np

from inertia.arrays import Float
from inertia.mesh.checks.findings import Finding, counted, listed, middle
from inertia.mesh.checks.surface_topology import Measured
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.shells import Body, absolute_orientation, bodies, members
from inertia.mesh.part import Surface

_CROSSINGS = 10_000  # crossings looked for, before those between different shells are taken out


def overlapping_bodies(surface: Measured) -> Finding | None:
    """Find bodies that share space, every shell being turned as its depth asks."""
    from inertia.mesh.geometry.intersect import overlap

    found = _turned_bodies(surface)
    boxes = np.array([surface.shells[body.shells[0]].box for body in found])
    meeting = _meeting(boxes)
    if not meeting:
        return None
    triangles_of = members(surface.closure)
    groups = [np.concatenate([triangles_of[number] for number in body.shells]) for body in found]
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
    text = (
        f"overlapping bodies: {counted(len(places), 'pair')} of bodies share space, the first "
        f"{surface.around(places[0])} being those from triangles {first[0]} and {first[1]} on, so that it "
        "counts twice: unite the bodies or move them apart"
    )
    return Finding("overlapping_bodies", "error", text, len(places), listed(np.array(first)), places[0])


def crossing_cavities(surface: Measured) -> Finding | None:
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
            found = crossings(surface.triangles.select(a), surface.triangles.select(b))
            total += found.total
            pairs.append(np.column_stack([a[found.pairs[:, 0]], b[found.pairs[:, 1]]]))
            points.append(found.points)
    if total == 0:
        return None
    pair, place = np.concatenate(pairs), middle(np.concatenate(points)[:1])
    text = (
        f"crossing cavities: {counted(total, 'pair')} of triangles of different shells of one body cross, "
        f"the first {surface.around(place)} being triangles {pair[0, 0]} and {pair[0, 1]}, so that a cavity "
        "takes away what is not there: unite the cavities or close the wall"
    )
    return Finding("overlapping_bodies", "error", text, total, listed(np.unique(pair)), place)


def self_intersections(surface: Measured) -> Finding | None:
    """Find triangles of one shell (of any piece, where there are no shells) that cross each other."""
    from inertia.mesh.geometry.intersect import crossings

    found = crossings(surface.triangles, limit=_CROSSINGS)
    labels = surface.closure.labels[found.pairs]
    same = (labels[:, 0] == labels[:, 1]) | (not surface.shells)
    if not same.any():
        return None
    pair, place = found.pairs[same], middle(found.points[same][:1])
    count = int(same.sum())
    text = (
        f"self-intersection: {'at least ' if found.truncated else ''}{counted(count, 'pair')} of triangles "
        f"cross, the first {surface.around(place)} being triangles {pair[0, 0]} and {pair[0, 1]}, so that "
        "what is enclosed twice counts twice: repair the part where it was made"
    )
    return Finding("self_intersection", "error", text, count, listed(np.unique(pair)), place)


def _turned(surface: Measured) -> Surface:
    """Return the triangles with every shell turned as its depth asks."""
    faces = surface.faces.copy()
    wrong = np.isin(surface.closure.labels, absolute_orientation(surface.shells))
    faces[wrong] = faces[wrong, ::-1]
    return Surface(surface.vertices, faces)


def _turned_bodies(surface: Measured) -> tuple[Body, ...]:
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
