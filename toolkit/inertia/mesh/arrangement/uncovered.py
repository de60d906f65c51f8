"""What a surface that is off may uncover of itself: how much farther what is left of it is to be taken for off.

The places that count change where the surface is off only near triangles of the union, and where a hidden triangle and
one of another shell are both off: a wall between two shells that overlap a little may be none. A hidden shell that
comes near no other changes nothing, as the places on both sides of it count without it.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.arrangement.contacts import Contacts
from inertia.mesh.arrangement.integers import Triangles
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.faces import components
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.triangle_pairs import heights_over, unit_normals
from inertia.mesh.manifold import exponent_of

_ROUNDING = 1e-12  # of the part's size, more than that of a height in float64
_INFLATED = 1 + 1e-9


def of_meeting_shells(triangles: Triangles, found: Contacts, reach: Float) -> Bool:
    """Say which triangles are of shells that meet others or themselves, or may where they are off.

    A shell is what hangs together by edges that two triangles have.

    Parameters
    ----------
    found : where triangles meet
    reach : (m,), how far each may be off, in the file's unit
    """
    edges = half_edges(triangles.faces)
    ordinary = (edges.uses == 2) & (edges.surplus == 0)
    pairs = edges.by_edge[ordinary[edges.edge[edges.by_edge]]].reshape(-1, 2) // 3
    shell = components(pairs, len(triangles.faces))
    meets = ~ordinary[edges.edge].reshape(-1, 3).all(axis=1)
    meets[list(found.segments)] = True
    meets[_near_others(triangles.vertices[triangles.faces], shell, reach)] = True
    return np.isin(shell, shell[meets])


def _near_others(corners: Float, shell: Int, reach: Float) -> Int:
    """Return the triangles that no plane of one of two holds apart from one of another shell by what both are off."""
    exponent = exponent_of(corners)
    corners, reach = np.ldexp(corners, -exponent), np.ldexp(reach, -exponent) * _INFLATED + _ROUNDING
    normals = unit_normals(corners)
    near = [np.empty(0, np.int64)]
    tree = BoxTree(corners.min(axis=1) - reach[:, None], corners.max(axis=1) + reach[:, None])
    for i, j, _ in overlapping(tree, touching=True):
        pairs = np.stack([i, j])[:, shell[i] != shell[j]]
        for one, other in ((0, 1), (1, 0)):
            a, b = pairs[one], pairs[other]
            over = heights_over(corners[a], normals[a], corners[b])
            margin = reach[a] + reach[b]
            pairs = pairs[:, ~((over.min(axis=1) > margin) | (over.max(axis=1) < -margin))]
        near.append(pairs.ravel())
    return np.unique(np.concatenate(near))


def growth(given: Float, left: Float, union: Float, distance: float) -> float:
    """Return how many times as far triangles are to be taken for off, so that a bound of them is one for others.

    What lies between triangles and where they are is as their distance h times their areas, h² times their edges, and
    h³ times their number; of the first moments times the arms, of the second ones times two arms, about the centroid.

    Parameters
    ----------
    given, left : (k, 3, 3), (n, 3, 3), the corners of the others, and of those that are left of them
    union : (m, 3, 3), of the surface that is left, about whose centroid it is
    distance : how far triangles are off, in the file's unit
    """
    exponent = exponent_of(given)
    low, high = np.ldexp(given.min(axis=(0, 1)), -exponent), np.ldexp(given.max(axis=(0, 1)), -exponent)
    middle, off = low / 2 + high / 2, float(np.ldexp(distance, -exponent))
    centre = middle + _centroid(np.ldexp(union, -exponent) - middle)
    others, own = (_measures(np.ldexp(corners, -exponent) - centre, off) for corners in (given, left))
    ratios = np.divide(others, own, out=np.ones_like(own), where=others > 0) ** (1 / np.array([[1], [2], [3]]))
    return _INFLATED * max(float(ratios.max()), 1.0)


def _centroid(corners: Float) -> Float:
    """Return the centroid of what a surface bounds; zero where that is nothing."""
    six = np.einsum("ki,ki->k", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    volume = six.sum()
    return six @ corners.sum(axis=1) / (4.0 * volume) if volume > _ROUNDING else np.zeros(3)


def _measures(corners: Float, off: float) -> Float:
    """Return areas, edges and number of triangles, (3, 10): by themselves, times arms and times two arms."""
    edges = np.roll(corners, -1, axis=1) - corners
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    around = np.linalg.norm(edges, axis=2).sum(axis=1)
    arms = np.abs(corners).max(axis=1) + off
    weights = np.column_stack([np.ones(len(arms)), arms, arms**2, arms * np.roll(arms, 1, axis=1)])
    return np.array([area @ weights, around @ weights, weights.sum(axis=0)])
