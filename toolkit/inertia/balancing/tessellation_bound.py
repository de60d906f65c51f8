"""Bound on the error of an unbalance from triangles in place of curved surfaces, and the sag of a mesh's facets.

Between the mesh and the true surface lies, over a triangle of area A, at most the volume h A of a layer, h being the
chord tolerance, and at its rim what `inertia.mass.tessellation` counts. Layers on opposite sides of the shaft cancel
only if they are alike, so the bound takes the worst direction n: |δU| ≤ ρ h max_n ∮ |r · n| dA, slab by slab along
the shaft, so that a plane feels each slab by its own lever. Faces that can only be true planes have no such layer.

That is for a chord tolerance that says more than the mesh shows. Where the vertices lie on the true surface, the layers
on cylinders and cones are summed as vectors (`inertia.balancing.facet_error`), and the bound is for what is left.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.bounds import Uncertainty
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.facet_error import FacetLayers, Mode
from inertia.errors import UsageError
from inertia.mesh.geometry.edges import pair_edges
from inertia.mesh.geometry.faces import components, merge_equal_vertices
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface

_SLABS = 24
_SECTORS = 256
_CHUNK = 1 << 14
_SHARP = math.radians(60.0)
_STORED = 2.0**-21  # of the coordinates: four roundings to float32


def chord_uncertainty(part: Part, chord: float, density: float, shaft: Shaft, z: float) -> Uncertainty:
    """Return what a chord tolerance leaves uncertain of the unbalance of a solid of triangles.

    Parameters
    ----------
    part : a closed surface
    chord : h, m: no point of the true surface is farther from the mesh, and it projects on it one to one
    density : kg/m³, the largest of any body
    shaft : in part axes
    z : m, the plane that the couple is about

    Raises `UsageError` where a figure is not positive and finite.
    """
    for name, value, unit in (("chord tolerance", chord, "m"), ("density", density, "kg/m³")):
        if not 0 < value < math.inf:
            raise UsageError(f"the {name} is {value!r} {unit}: it must be positive and finite")
    surface = Surface(*merge_equal_vertices(part.triangles))
    faces = surface.faces[curved_faces(surface)]
    if not len(faces):
        return Uncertainty("tessellation", (), chord)
    points = shaft.to_shaft(surface.vertices * float(part.unit.metres)) - [0.0, 0.0, z]
    return _tessellation(_modes(points, faces, np.full(len(faces), chord), density), chord)


def facet_uncertainty(layers: FacetLayers, density: float, shaft: Shaft, z: float) -> Uncertainty:
    """Return what facets leave uncertain of the unbalance of a solid whose vertices lie on its true surface.

    Parameters
    ----------
    layers : of a closed surface
    density : kg/m³, the largest of any body
    shaft : in part axes
    z : m, the plane that the couple is about
    """
    modes = layers.modes(density, shaft, z)
    unknown = layers.unknown_sag > 0
    if unknown.any():
        points = shaft.to_shaft(layers.mesh.vertices) - [0.0, 0.0, z]
        modes += _modes(points, layers.mesh.faces[unknown], layers.unknown_sag[unknown], density)
    return _tessellation(modes, layers.sag or None)


def _tessellation(modes: Sequence[Mode], cause: float | None) -> Uncertainty:
    return Uncertainty(
        "tessellation", tuple((g, h) for g, h, _, _ in modes), cause, masses=tuple((m, s) for _, _, m, s in modes)
    )


def curved_faces(surface: Surface) -> Bool:
    """Return which triangles (m,) may stand for a curved surface.

    A plane face is a patch of coplanar triangles that turns by 60° or more at each of its edges: circles of seven
    segments and more count as curved, at whatever size.

    Parameters
    ----------
    surface : welded
    """
    vertices, faces = surface.vertices, surface.faces
    _, first, second, normals = _hinges(vertices, faces)
    corners = vertices[faces]
    sizes = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(sizes, np.finfo(float).tiny)[:, np.newaxis]
    turning = np.einsum("ki,ki->k", normals[first], normals[second])
    # The larger triangle tells its plane best; a sliver's own normal is noise.
    larger = sizes[first] >= sizes[second]
    plane, other = np.where(larger, first, second), np.where(larger, second, first)
    height = np.abs(np.einsum("kij,kj->ki", corners[other] - corners[plane, :1], normals[plane])).max(axis=1)
    flat = height <= _STORED * np.abs(vertices).max()
    patch = components(np.column_stack([first, second])[flat], len(faces))
    smooth = ~flat & (turning > math.cos(_SHARP))
    bent = np.zeros(len(faces), bool)
    bent[patch[first[smooth]]] = True
    bent[patch[second[smooth]]] = True
    curved: Bool = bent[patch]
    return curved


def _hinges(vertices: Float, faces: Int) -> tuple[Int, Int, Int, Float]:
    """Return the ends (k, 2) of edges of two triangles, these (k,), (k,), and all normals (m, 3), of twice the area."""
    edges = pair_edges(faces)
    start = (np.cumsum(edges.uses) - edges.uses)[edges.uses == 2]
    corners = vertices[faces]
    normals: Float = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return edges.ends[edges.uses == 2], edges.users[start], edges.users[start + 1], normals


def _modes(points: Float, faces: Int, chord: Float, density: float) -> tuple[Mode, ...]:
    """Return, for each slab, what its layer can do at the slab's middle, and for all of them what their depth adds.

    First to the unbalance, then to the mass. The chord (m,) is that of each face.
    """
    low, high = float(points[faces, 2].min()), float(points[faces, 2].max())
    width = max((high - low) / _SLABS, float(chord.max()))
    middles = low + width * (np.arange(_SLABS) + 0.5)
    sectors = np.zeros((_SLABS, _SECTORS))
    nearby, reach, volume = np.zeros(_SLABS), np.zeros(_SLABS), np.zeros(_SLABS)
    for begin in range(0, len(faces), _CHUNK):
        corners = points[faces[begin : begin + _CHUNK]]
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).sum(axis=1)
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        thick = chord[begin : begin + _CHUNK]
        layer = thick * area + 0.5 * math.pi * thick**2 * sides + 4.0 / 3.0 * math.pi * thick**3
        corners, layer, thick = _cut_short(corners, layer, thick, width)
        slab = np.minimum(((corners[:, :, 2].mean(axis=1) - low) / width).astype(np.int64), _SLABS - 1)
        np.maximum.at(reach, slab, np.abs(corners[:, :, 2] - middles[slab, np.newaxis]).max(axis=1))
        across = corners[:, :, 0] + 1j * corners[:, :, 1]
        sector = np.rint(np.angle(across) * (_SECTORS / math.pi)).astype(np.int64) % _SECTORS
        # The mean over the corners of a convex function is at least its mean over the triangle.
        arm = layer[:, np.newaxis] * np.abs(across) / 3.0
        place = (slab[:, np.newaxis] * _SECTORS + sector).ravel()
        sectors += np.bincount(place, arm.ravel(), sectors.size).reshape(sectors.shape)
        nearby += np.bincount(slab, thick * layer, _SLABS)
        volume += np.bincount(slab, layer, _SLABS)
    step = math.pi / _SECTORS
    turned = np.abs(np.cos(step * (np.arange(_SECTORS)[:, np.newaxis] - np.arange(_SECTORS))))
    # Angles are rounded to half a step, and the worst direction lies within half a step of one of these.
    worst = (sectors @ turned).max(axis=1) + step * sectors.sum(axis=1)
    most, masses, deep = density * (worst + nearby), density * volume, reach + float(chord.max())
    levers = tuple((complex(g), complex(g * at), 0.0, 0.0) for g, at in zip(most, middles, strict=True) if g)
    heavier = tuple((0j, 0j, float(m), float(m * at)) for m, at in zip(masses, middles, strict=True) if m)
    return (*levers, *heavier, (0j, complex(most @ deep), 0.0, 0.0), (0j, 0j, 0.0, float(masses @ deep)))


def _cut_short(corners: Float, layer: Float, thick: Float, depth: float) -> tuple[Float, Float, Float]:
    """Cut up triangles (k, 3, 3) until none climbs over `depth`, and share out what lies over each, (k,).

    A triangle is halved at the middle of the edge that climbs most; the halves are as thick as it is.
    """
    pieces = []
    while len(corners):
        climbs = np.abs(np.roll(corners, -1, axis=1)[:, :, 2] - corners[:, :, 2])
        steep = climbs.max(axis=1) > depth
        pieces.append((corners[~steep], layer[~steep], thick[~steep]))
        edge = climbs[steep].argmax(axis=1)
        a, b, c = (corners[steep][np.arange(len(edge)), (edge + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        layer, thick = np.tile(0.5 * layer[steep], 2), np.tile(thick[steep], 2)
    short, over, each = zip(*pieces, strict=True)
    return np.concatenate(short), np.concatenate(over), np.concatenate(each)


def surface_cut_away(operations: Sequence[Operation], layer: float, z: float) -> Uncertainty | None:
    """Return what tools may take beside what they take of the mesh: the layer over the facets where they start.

    A depth counts from the true surface, which stands out of facets that are cut by up to their sag: each tool takes so
    much more over its footprint on the rim, at most. Holes along the shaft start in flat faces.

    Parameters
    ----------
    operations : as cut
    layer : kg/m², the density of a body times the sag of its facets, the largest
    z : m, the plane that couples are about
    """
    modes = []
    for work in operations:
        if area := _footprint(work):
            size = layer * area * work.radius
            modes.append((complex(size), complex(size * (work.unbalance_z - z))))
    return Uncertainty("tessellation", tuple(modes), bodies=("the surface cut",)) if modes and layer else None


def _footprint(work: Operation) -> float:
    """Return the area that a tool takes of the rim, m²; none along the shaft."""
    match work.kind:
        case "drill_radial":
            return 0.25 * math.pi * (work.tool_diameter or 0.0) ** 2
        case "mill_flat":
            return 2 * work.radius * math.acos(1 - (work.depth or 0.0) / work.radius) * (work.width or 0.0)
        case "mill_arc":
            return 2 * (work.half_angle or 0.0) * work.radius * (work.width or 0.0)
        case _:
            return 0.0
