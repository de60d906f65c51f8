"""Places of which a closed surface encloses one twice, if it encloses anything twice: in its crossings and contacts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.contact_depth import contact_depth
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.intersect import FACING, beside_edges, near_pairs
from inertia.mesh.geometry.triangle_pairs import crossing, heights_over, unit_normals
from inertia.mesh.surface import Triangles

_DEPTHS = (1.0, 1e2, 1e4)  # at which a crossing is looked at, over the depth of a contact


def places_of_doubt(triangles: Triangles, size: float) -> Iterator[Float]:
    """Yield places (k, 3) just inside a closed, outward surface, one of which it encloses twice if it does so anywhere.

    They lie in crossings, beside edges that lie in triangles, within triangles that lie on others, and in each piece of
    the surface, if there are several; the last of these come last. Twice may mean no deeper than `contact_depth`.

    Parameters
    ----------
    triangles : closed, facing outward, apart from cavities
    size : the extent of what is bounded
    """
    vertices, faces = merge_equal_vertices(triangles)
    depth = contact_depth(vertices, size)
    normals = unit_normals(vertices[faces])
    for i, j, _ in near_pairs(vertices, faces, None, touching=True):
        same = faces[i][:, :, None] == faces[j][:, None, :]
        shared = same.sum(axis=(1, 2))
        # Neighbours that share an edge one runs along as the other does have material on one side, both of them.
        alike = (same & np.roll(same, (-1, -1), axis=(1, 2))).any(axis=(1, 2))
        apart = (shared < 2) | ((shared == 2) & alike)
        i, j, shared = i[apart], j[apart], shared[apart]
        heights = [heights_over(vertices[faces[a]], normals[a], vertices[faces[b]]) for a, b in ((i, j), (j, i))]
        places = [np.empty((0, 3))]
        cut = np.ones(len(i), bool)
        for height in heights:  # what cuts less deep is no crossing that matters, and edges beside it are looked at
            cut &= (height.min(axis=1) < -depth / 4) & (height.max(axis=1) > depth / 4)
        pair = np.flatnonzero(cut & (shared < 2))
        crossed, middles = crossing(vertices, faces[i[pair]], faces[j[pair]])
        inwards = -(normals[i[pair[crossed]]] + normals[j[pair[crossed]]])
        length = np.linalg.norm(inwards, axis=1, keepdims=True)
        meets = length[:, 0] > FACING
        inwards = 2 * inwards[meets] / length[meets] ** 2
        places += [middles[meets] + k * depth * inwards for k in _DEPTHS]
        for (a, b), height in zip(((i, j), (j, i)), heights, strict=True):
            lies = (np.abs(height) < depth / 2).sum(axis=1) >= 2
            a, b, height = a[lies], b[lies], height[lies]
            for one, other in ((0, 1), (1, 0)):  # sides of either may hold them apart, as of neighbours in one plane
                both = a, b
                meets = ~_beside(
                    vertices[faces[both[one]]], vertices[faces[both[other]]], normals[both[one]], depth / 2
                )
                a, b, height = a[meets], b[meets], height[meets]
            places.append(beside_edges(vertices, faces[a], normals[a], faces[b], height, depth))
            covered = _under_centroid(vertices[faces[a]], vertices[faces[b]], normals[a], depth)
            places.append(vertices[faces[b[covered]]].mean(axis=1) - depth * normals[b[covered]])
        yield np.concatenate(places)
    labels = closure(triangles).labels
    pieces, first = np.unique(labels[labels >= 0], return_index=True)
    if len(pieces) > 1:
        tried = np.flatnonzero(labels >= 0)[first]
        yield vertices[faces[tried]].mean(axis=1) - depth * normals[tried]


def _beside(corners: Float, others: Float, normals: Float, slack: float) -> Bool:
    """Say which triangles with these corners (k, 3, 3) and normals have a side beyond which the others lie."""
    beside = np.zeros(len(corners), bool)
    for k in range(3):
        edge = corners[:, (k + 1) % 3] - corners[:, k]
        reach = np.einsum("kij,kj->ki", others - corners[:, k, None], np.cross(normals, edge)).max(axis=1)
        beside |= reach <= slack * np.linalg.norm(edge, axis=1)
    return beside


def _under_centroid(corners: Float, others: Float, normals: Float, depth: float) -> Int:
    """Return which triangles with these corners (k, 3, 3) and normals hold the centroids of others in their planes."""
    centroids = others.mean(axis=1)
    within = np.abs(np.einsum("kj,kj->k", centroids - corners[:, 0], normals)) < depth / 2
    for k in range(3):
        inwards = np.cross(normals, corners[:, (k + 1) % 3] - corners[:, k])
        within &= np.einsum("kj,kj->k", centroids - corners[:, k], inwards) > 0
    return np.flatnonzero(within)
