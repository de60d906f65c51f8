"""Uniting bodies that overlap, with manifold3d."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import GeometryError
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.closure import components
from inertia.mesh.geometry.intersect import overlap
from inertia.mesh.part import Surface
from inertia.mesh.repairs.holes import around
from inertia.mesh.repairs.weld import compact


def overlapping_groups(vertices: Float, faces: Int, bodies: list[Int]) -> tuple[list[list[Int]], str]:
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


def united(vertices: Float, faces: Int, bodies: list[Int]) -> tuple[Float, Int]:
    """Return the vertices and faces of the union of bodies (their faces).

    Raises
    ------
    GeometryError : it does not take a body, because an edge of it has more than two triangles, for instance
    """
    from manifold3d import Error, Manifold, Mesh64, OpType

    # Products of six coordinates must not overflow; a power of two brings them near 1 and changes no digit.
    exponent = int(np.frexp(np.abs(vertices).max())[1])
    solids = []
    for body in bodies:
        own, corners = compact(vertices, faces[body])
        solid = Manifold(Mesh64(np.ldexp(own, -exponent), corners.astype(np.uint64)))
        if solid.status() != Error.NoError:
            raise GeometryError(
                f"the body {around(own)} overlaps another and cannot be united with it "
                f"({solid.status().name}): unite them where the part was made"
            )
        solids.append(solid)
    mesh = Manifold.batch_boolean(solids, OpType.Add).to_mesh64()
    return np.ldexp(mesh.vert_properties[:, :3], exponent), mesh.tri_verts.astype(np.int64)
