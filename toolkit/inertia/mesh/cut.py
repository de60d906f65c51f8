"""Cutting tools out of a part, with manifold3d.

A tool is a closed, outward `Surface` in the part's unit. What the tools do not reach is left as it was, bit for bit;
where a body is cut, its surface is that of the solids' difference, in float64.

Round tools are prisms of `SEGMENTS` sides. Their polygon has the circle's *area*, so that the volume of a drill is
exact: with x = π/n its vertices lie r(√(2x/sin 2x) − 1) ≈ r x²/3 outside the circle, the middles of its sides about
half as far inside. Its second moment of area is too large by a share of about 4x⁴/45.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float, Int
from inertia.errors import GeometryError, placed
from inertia.mesh.check import check
from inertia.mesh.geometry.closure import Closure, closure
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners
from inertia.mesh.geometry.shells import bodies, members, shells
from inertia.mesh.manifold import exponent_of, solid
from inertia.mesh.part import Part, Regions, Rounding
from inertia.mesh.repairs.holes import around
from inertia.mesh.repairs.weld import compact
from inertia.mesh.surface import Surface, Triangles
from inertia.records import dataclass

SEGMENTS = 64
"""Sides of a round tool: its vertices are 0.08 % of the radius outside the circle."""

_NO_REGION = -1
_BLOCK_FACES = [
    [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
    [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
]  # fmt: skip


def drill(shoulder: ArrayLike, back: ArrayLike, diameter: float, point_length: float) -> Surface:
    """Return a drill: a cylinder from `shoulder` to `back`, and before the shoulder a cone.

    Its volume is π (d/2)² (length + point_length/3).

    Parameters
    ----------
    shoulder : (3,), where the full diameter begins
    back : (3,), the other end, which has to lie outside the part
    diameter : d
    point_length : height of the cone; 0 for a flat end

    >>> from inertia.mass.triangles.moments_from_sums import moments_of
    >>> from inertia.mass.triangles.sums import sum_triangles
    >>> float(moments_of(sum_triangles(drill([0, 0, 0], [0, 0, 5], 2.0, 0.6))).zeroth) / np.pi
    5.2
    """
    low, high = np.asarray(shoulder, float), np.asarray(back, float)
    axis = (high - low) / np.linalg.norm(high - low)
    aside = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    aside /= np.linalg.norm(aside)
    step = 2 * np.pi / SEGMENTS
    angles = step * np.arange(SEGMENTS)[:, None]
    radius = 0.5 * diameter * np.sqrt(step / np.sin(step))
    ring = radius * (np.cos(angles) * aside + np.sin(angles) * np.cross(axis, aside))
    vertices = np.concatenate([low + ring, high + ring, [low - point_length * axis, high]])
    here = np.arange(SEGMENTS)
    beside, tip, end = np.roll(here, -1), np.full(SEGMENTS, 2 * SEGMENTS), np.full(SEGMENTS, 2 * SEGMENTS + 1)
    faces = [
        (here, beside, beside + SEGMENTS),
        (here, beside + SEGMENTS, here + SEGMENTS),
        (beside, here, tip),
        (here + SEGMENTS, beside + SEGMENTS, end),
    ]
    return Surface(vertices, np.concatenate([np.column_stack(corners) for corners in faces]))


def block(corner: ArrayLike, edges: ArrayLike) -> Surface:
    """Return a box: from `corner` (3,) along the rows of `edges` (3, 3), a right-handed set of vectors.

    >>> block([0, 0, 0], np.eye(3)).vertices[-1].tolist()
    [1.0, 1.0, 1.0]
    """
    ends = np.array([[number >> axis & 1 for axis in range(3)] for number in range(8)], float)
    return Surface(np.asarray(corner, float) + ends @ np.asarray(edges, float), _BLOCK_FACES)


def ring_segment(angles: Float, inner: Float, outer: float, low: float, high: float) -> Surface:
    """Return a part of a ring about z: at angles (n,) from distances (n,) to `outer`, between two heights.

    >>> from inertia.mass.triangles.moments_from_sums import moments_of
    >>> from inertia.mass.triangles.sums import sum_triangles
    >>> quarter = ring_segment(np.array([0.0, np.pi / 2]), np.array([1.0, 1.0]), 2.0, 0.0, 2.0)
    >>> round(float(moments_of(sum_triangles(quarter)).zeroth), 12)
    3.0

    Parameters
    ----------
    angles : rad, ascending
    inner : distances from z
    outer : a distance that is larger than all of them
    low, high : heights
    """
    turns = np.column_stack([np.cos(angles), np.sin(angles)])
    flat = np.concatenate([inner[:, None] * turns, outer * turns])
    vertices = np.concatenate([np.column_stack([flat, np.full(len(flat), height)]) for height in (low, high)])
    n = len(angles)
    here = np.arange(n - 1)
    i, o, j, p = (here + k * n for k in range(4))  # inner and outer at the low end, inner and outer at the high one
    first, last = np.arange(4) * n, np.arange(4) * n + n - 1
    quads = [
        (j, p, p + 1, j + 1), (i, i + 1, o + 1, o), (o, o + 1, p + 1, p), (i, j, j + 1, i + 1),
        tuple(first[[0, 1, 3, 2], None]), tuple(last[[0, 2, 3, 1], None]),
    ]  # fmt: skip
    corners = np.concatenate([np.column_stack(quad) for quad in quads])
    return Surface(vertices, np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]]))


@dataclass(frozen=True, eq=False)
class _Body:
    """One body of a part: its triangles, its box (2, 3), and its solid, scaled by 2^−exponent.

    The triangles stand region by region; `regions` are the regions' places among the names, `lengths` their numbers of
    triangles, and each is a run of manifold3d's, with ids from `first_run` on.
    """

    members: Int
    box: Float
    solid: Any
    regions: Int
    lengths: Int
    first_run: int


@dataclass(frozen=True, eq=False)
class Stock:
    """A part made ready for cutting, as often as one likes; see `stock`."""

    part: Part
    _vertices: Float
    _faces: Int
    _exponent: int
    _bodies: tuple[_Body, ...]

    def cut(self, tools: Sequence[Surface]) -> Part:
        """Return the part with the tools cut out, its unit, name and regions kept.

        The walls of a cut belong to the region of the body that they are in, if that is one region, else to none.

        Raises
        ------
        GeometryError : a tool is not a solid, or the tools leave nothing of a body
        """
        reach = [np.stack([tool.vertices.min(axis=0), tool.vertices.max(axis=0)]) for tool in tools]
        solids = [solid(tool.vertices, tool.faces, self._exponent) for tool in tools]
        vertices: list[Float] = []
        faces: list[Int] = []
        regions: list[Int] = []
        for body in self._bodies:
            meeting = [
                tool
                for tool, box in zip(solids, reach, strict=True)
                if ((box[0] <= body.box[1]) & (body.box[0] <= box[1])).all()
            ]
            points, corners, region = self._cut_body(body, meeting)
            faces.append(corners + sum(len(earlier) for earlier in vertices))
            vertices.append(points)
            regions.append(region)
        surface = Surface(np.concatenate(vertices), np.concatenate(faces))
        regions_after = self.part.regions
        if regions_after is not None:
            regions_after = Regions(regions_after.names, np.concatenate(regions).astype(np.int32))
        chord = self.part.chord if self.part.chord is None else np.full(surface.count, self.part.chord.max())
        rounding = self.part.rounding if self.part.rounding is None else Rounding(self.part.rounding.distance)
        return replace(self.part, geometry=surface, regions=regions_after, chord=chord, rounding=rounding, shape=None)

    def common(self, tool: Surface) -> Part | None:
        """Return what the part and a tool have in common, which the tool takes away; None where that is nothing.

        Raises
        ------
        GeometryError : the tool is not a solid
        """
        from manifold3d import Manifold, OpType

        cutter = solid(tool.vertices, tool.faces, self._exponent)
        low, high = tool.vertices.min(axis=0), tool.vertices.max(axis=0)
        meeting = [body.solid for body in self._bodies if ((low <= body.box[1]) & (body.box[0] <= high)).all()]
        meshes = [Manifold.batch_boolean([body, cutter], OpType.Intersect).to_mesh64() for body in meeting]
        meshes = [mesh for mesh in meshes if len(mesh.tri_verts)]
        if not meshes:
            return None
        starts = np.cumsum([0, *(len(mesh.vert_properties) for mesh in meshes)])
        vertices = np.ldexp(np.concatenate([mesh.vert_properties[:, :3] for mesh in meshes]), self._exponent)
        faces = [mesh.tri_verts.astype(np.int64) + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
        surface = Surface(vertices, np.concatenate(faces))
        return replace(self.part, geometry=surface, regions=None, chord=None, rounding=None, shape=None)

    def _cut_body(self, body: _Body, tools: list[Any]) -> tuple[Float, Int, Int]:
        """Return a body's vertices, faces and their regions, after cutting."""
        if not tools:
            index = np.repeat(body.regions, body.lengths)
            return (*compact(self._vertices, self._faces[body.members]), index)
        from manifold3d import Manifold, OpType

        mesh = Manifold.batch_boolean([body.solid, *tools], OpType.Subtract).to_mesh64()
        if len(mesh.tri_verts) == 0:
            raise GeometryError(f"{self.part.name}: nothing is left of the body {around(body.box)}: cut less deep")
        walls = int(body.regions[0]) if len(body.regions) == 1 else _NO_REGION
        runs = np.asarray(mesh.run_original_id, np.int64) - body.first_run
        own = (runs >= 0) & (runs < len(body.regions))
        region = np.where(own, body.regions[np.where(own, runs, 0)], walls)
        ends = np.asarray(mesh.run_index, np.int64) // 3
        points = np.ldexp(mesh.vert_properties[:, :3], self._exponent)
        return points, mesh.tri_verts.astype(np.int64), np.repeat(region, ends[1:] - ends[:-1])


def stock(part: Part) -> Stock:
    """Make a part ready for cutting: find its bodies, and make a solid of each.

    Raises
    ------
    GeometryError : the part is not a closed surface, or manifold3d does not take a body
    """
    triangles = part.triangles
    topology = closure(triangles)
    if triangles.count == 0 or topology.open_edges:
        check(part).require_fit()
    vertices, faces = merge_equal_vertices(triangles)
    exponent = exponent_of(vertices)
    ready = []
    for group in pieces(triangles, topology):
        own = group[~repeated_corners(faces[group])]
        index = np.zeros(len(own), np.int64) if part.regions is None else part.regions.index[own].astype(np.int64)
        own = own[np.argsort(index, kind="stable")]
        regions, lengths = np.unique(index, return_counts=True)
        points, corners = compact(vertices, faces[own])
        box = np.stack([points.min(axis=0), points.max(axis=0)])
        try:
            body, first = _runs(points, corners, exponent, lengths)
        except GeometryError as fault:
            raise placed(fault, part.name, f"the body {around(box)} cannot be cut") from None
        ready.append(_Body(own, box, body, regions, lengths, first))
    return Stock(part, vertices, faces, exponent, tuple(ready))


def cut(part: Part, tools: Sequence[Surface]) -> Part:
    """Cut tools out of a part once; see `stock` and `Stock.cut`.

    >>> cube = Part.from_arrays(block([0, 0, 0], np.eye(3)).vertices, block([0, 0, 0], np.eye(3)).faces)
    >>> left = cut(cube, [block([0.5, -1, -1], 3 * np.eye(3))])
    >>> left.triangles.corners().max(axis=(0, 1)).tolist()
    [0.5, 1.0, 1.0]
    """
    return stock(part).cut(tools)


def pieces(surface: Triangles, topology: Closure) -> list[Int]:
    """Return the numbers of the triangles of each body of a surface, with those of its cavities."""
    if topology.components == 1:
        return [np.arange(surface.count)]
    numbers = members(topology)
    return [np.concatenate([numbers[shell] for shell in body.shells]) for body in bodies(shells(surface, topology))]


def _runs(vertices: Float, faces: Int, exponent: int, lengths: Int) -> tuple[Any, int]:
    """Return a solid of runs of triangles, `lengths` triangles each, and the id of the first run."""
    from manifold3d import Manifold

    first = int(Manifold.reserve_ids(len(lengths)))
    starts = np.concatenate([[0], 3 * np.cumsum(lengths)]).astype(np.uint64)
    ids = (first + np.arange(len(lengths))).astype(np.uint32)
    return solid(vertices, faces, exponent, run_index=starts, run_original_id=ids), first
