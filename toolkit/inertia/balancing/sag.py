"""How far a mesh of triangles may be from the surface that it stands for, estimated from the mesh alone.

For meshes whose chord tolerance nobody states. Facets of width w that turn by θ at their common edge, their corners on
a cylinder, leave a sag of (w/2) tan(θ/4). Edges that turn by 60° or more are taken for true ones.
"""

from __future__ import annotations

import math

import numpy as np

from inertia.mesh.geometry.closure import weld
from inertia.mesh.geometry.edges import pair_edges
from inertia.mesh.part import Part

_SHARP = math.radians(60.0)


def estimated_sag(part: Part) -> float:
    """Return the largest sag of a surface of triangles, in its own unit: an estimate and no bound.

    The narrower facet at an edge counts: the wider one may be a true plane.

    >>> from importlib.resources import files
    >>> from inertia.mesh.read import read
    >>> sag = estimated_sag(read(files("inertia_meshes") / "two_disc_rotor.stl"))
    >>> round(sag, 4) == round(100 * (1 - math.cos(math.pi / 256)), 4)
    True
    """
    vertices, faces = weld(part.triangles)
    edges = pair_edges(faces)
    start = (np.cumsum(edges.uses) - edges.uses)[edges.uses == 2]
    first, second = edges.users[start], edges.users[start + 1]
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normals, axis=1)  # areas
    length = np.linalg.norm(np.diff(vertices[edges.ends[edges.uses == 2]], axis=1)[:, 0], axis=1)
    solid = (doubled[first] > 0) & (doubled[second] > 0) & (length > 0)
    first, second, length = first[solid], second[solid], length[solid]
    sine = np.linalg.norm(np.cross(normals[first], normals[second]), axis=1)
    turn = np.arctan2(sine, np.einsum("ki,ki->k", normals[first], normals[second]))
    width = np.minimum(doubled[first], doubled[second]) / length
    sag = 0.5 * width * np.tan(0.25 * turn)
    return float(sag[turn < _SHARP].max(initial=0.0))
