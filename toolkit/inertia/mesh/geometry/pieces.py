"""Pieces of surface: what hangs together at edges of two triangles, and at those of more, of bodies as if turned."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.edge_fans import links
from inertia.mesh.geometry.faces import components
from inertia.mesh.geometry.halfedges import HalfEdges, half_edges
from inertia.mesh.geometry.senses import senses_of
from inertia.mesh.surface import Surface, usable


def pieces_of_surface(vertices: Float, faces: Int, edges: HalfEdges) -> Int:
    """Return for each face (m, 3) the first of those that it hangs together with by paired edges.

    Edges of two triangles that run opposite ways are paired; those of more as `inertia.mesh.geometry.edge_fans` says,
    of bodies that are inside out as when they are turned.
    """
    two = (edges.uses == 2) & (edges.surplus == 0)
    pairs = edges.by_edge[two[edges.edge[edges.by_edge]]].reshape(-1, 2) // 3
    piece = components(pairs, len(faces))
    if (edges.uses > 2).any():
        shared = sharing(edges)
        whole, labels = np.unique(components(np.concatenate([pairs, shared]), len(faces)), return_inverse=True)
        asked = np.unique(labels[shared])
        sense = senses_of(Surface(vertices, faces), labels.astype(np.int32), len(whole), asked)
        more = links_turned(vertices, faces, edges, piece, sense[labels] < 0)
        piece = components(np.concatenate([pairs, more]), len(faces))
    return piece


def sharing(edges: HalfEdges) -> Int:
    """Return pairs of triangles (k, 2) that link all that have an edge in common which more than two have."""
    member = edges.by_edge[(edges.uses > 2)[edges.edge[edges.by_edge]]]
    same = np.diff(edges.edge[member]) == 0
    return np.column_stack([member[:-1][same], member[1:][same]]) // 3


def links_turned(vertices: Float, faces: Int, edges: HalfEdges, piece: Int, turned: Bool) -> Int:
    """Return what `links` does where faces (m,) are turned, with all that have edges in common with them.

    Around edges of a surface with coordinates that are not usable, which is refused, all belong together.
    """
    if not usable(vertices).all():
        return sharing(edges)
    if turned.any():
        faces = np.where(turned[:, None], faces[:, ::-1], faces)
        edges = half_edges(faces)
    return links(vertices, faces, edges, piece)
