"""Consistent, outward winding of a surface: which triangles and shells to turn.

Neighbours at an edge of two triangles must run along it in opposite directions. With a node for either side
of every triangle and links between the sides that belong together, the pieces of the graph are the sides of
the surface: a triangle lies with its front on one and with its back on the other, or with both on the same if
the surface is one-sided. The fewer triangles are turned, in a tie those that do not agree with the first.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.errors import GeometryError
from inertia.mesh.geometry.faces import components
from inertia.mesh.geometry.halfedges import HalfEdges
from inertia.mesh.geometry.pieces import pieces_of_surface
from inertia.mesh.geometry.triangle_pairs import unit_normals
from inertia.mesh.geometry.winding import windings
from inertia.mesh.repairs.holes import around
from inertia.records import dataclass

_NOISE = 1e-13  # rounding of a volume, over the sum of the largest that its terms could be
_UNDER = 1e-9  # how far under a shell it is asked what is around it, over the shell's extent


def inconsistent(vertices: Float, faces: Int, edges: HalfEdges) -> Bool:
    """Say which faces (m, 3) to turn for a consistent winding; raise `GeometryError` for a one-sided surface.

    >>> from inertia.mesh.geometry.halfedges import half_edges
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 2, 3]])
    >>> inconsistent(np.zeros((4, 3)), faces, half_edges(faces)).tolist()
    [False, False, False, True]
    """
    count = len(faces)
    pairs = edges.by_edge[edges.uses[edges.edge[edges.by_edge]] == 2].reshape(-1, 2)
    against = edges.direction[pairs[:, 0]] == edges.direction[pairs[:, 1]]
    if not against.any():
        return np.zeros(count, bool)
    one, other = (pairs // 3).T
    front = np.column_stack([one, other + count * against])
    back = np.column_stack([one + count, other + count * ~against])
    side = components(np.concatenate([front, back]), 2 * count)
    one_sided = np.flatnonzero(side[:count] == side[count:])
    if len(one_sided):
        raise GeometryError(
            f"the surface {around(vertices[faces[one_sided[0]]])} is one-sided, like a Möbius strip, and "
            "bounds nothing: export the part as a solid"
        )
    piece = components(pairs // 3, count)
    turned: Bool = side[:count] != piece
    majority = 2 * np.bincount(piece, turned, count) > np.bincount(piece, minlength=count)
    return np.logical_xor(turned, majority[piece])


@dataclass(frozen=True, eq=False)
class Nest:
    """The shells of a closed surface.

    Attributes
    ----------
    members : the faces of each shell
    volumes : (k,), signed, in units of the part's extent cubed; 0 where it is no more than rounding
    containers : the numbers of the shells around each; none are looked for where every shell is outward
    """

    members: list[Int]
    volumes: Float
    containers: list[list[int]]

    def to_turn(self) -> list[int]:
        """Return the shells to turn: inward ones with none around, and in those what is against its depth."""
        outer = {k for k, outside in enumerate(self.containers) if not outside and self.volumes[k] < 0}
        inner = [
            k
            for k, outside in enumerate(self.containers)
            if outer.intersection(outside) and self.volumes[k] * (-1) ** len(outside) < 0
        ]
        return sorted([*outer, *inner])

    def bodies(self) -> list[Int]:
        """Return the faces of each outward shell together with those of the cavities in it."""
        groups = {k: [self.members[k]] for k in np.flatnonzero(self.volumes > 0).tolist()}
        for k in np.flatnonzero(self.volumes < 0).tolist():
            outward = [outside for outside in self.containers[k] if outside in groups]
            if outward:
                groups[min(outward, key=lambda shell: self.volumes[shell])].append(self.members[k])
        return [np.concatenate(group) for group in groups.values()]


def nest(vertices: Float, faces: Int, edges: HalfEdges) -> Nest:
    """Take a closed surface apart into its shells."""
    _, label = np.unique(pieces_of_surface(vertices, faces, edges), return_inverse=True)
    order = np.argsort(label, kind="stable")
    members = np.split(order, np.searchsorted(label[order], np.arange(1, label.max(initial=0) + 1)))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    vertices = (vertices - (low / 2 + high / 2)) / (high - low).max()
    volumes = _volumes(vertices, faces, label, len(members))
    containers: list[list[int]] = [[] for _ in members]
    if (volumes < 0).any():
        containers = _containers(vertices[faces], members, volumes)
    return Nest(members, volumes, containers)


def _volumes(vertices: Float, faces: Int, label: Int, count: int) -> Float:
    """Return ∑ a·(b−a)×(c−a) / 6 over each shell, about a corner of its own."""
    _, first = np.unique(label, return_index=True)
    a, b, c = (vertices[faces] - vertices[faces[first, 0]][label, None]).transpose(1, 0, 2)
    terms = np.einsum("ki,ki->k", a, np.cross(b - a, c - a)) / 6
    largest = np.prod([np.linalg.norm(side, axis=1) for side in (a, b - a, c - a)], axis=0)
    volumes = np.bincount(label, terms, count)
    return np.where(np.abs(volumes) > _NOISE * np.bincount(label, largest, count), volumes, 0.0)


def _containers(corners: Float, members: list[Int], volumes: Float) -> list[list[int]]:
    """Return the shells around each shell, asked at a place just under its largest triangle.

    There is the material: an insert is inside the cavity that it fills, and the cavity is not inside it.
    """
    low = np.array([corners[member].min(axis=(0, 1)) for member in members])
    high = np.array([corners[member].max(axis=(0, 1)) for member in members])
    nestings: set[tuple[int, int]] = set()
    for inner, member in enumerate(members):
        nests = (low <= low[inner]).all(axis=1) & (high[inner] <= high).all(axis=1) & (volumes != 0)
        nests[inner] = False
        sides = corners[member][:, 1:] - corners[member][:, :1]
        largest = corners[member[np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).argmax()]][None]
        place = largest.mean(axis=1) - _UNDER * (high[inner] - low[inner]).max() * unit_normals(largest)
        for outer in np.flatnonzero(nests).tolist():
            if windings(place, corners[members[outer]], 0.0)[0][0] != 0:
                nestings.add((outer, inner))
    containers: list[list[int]] = [[] for _ in members]
    for outer, inner in sorted(nestings):
        if (inner, outer) not in nestings:  # two that coincide do not contain each other
            containers[inner].append(outer)
    return containers
