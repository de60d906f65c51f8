"""What bodies look like on the screen: triangles about the centre of mass, few enough for a viewer, or ellipsoids.

Where a part has more than `MOST` triangles, corners in one cell of a grid are merged into their mean, and triangles
that lose a side by it are left out. Results never come from these triangles.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import JointedPart
from inertia.dynamics.scene.body import SceneBody
from inertia.mass.principal import principal
from inertia.mesh.geometry.cell_shapes import KINDS, volume_blocks
from inertia.mesh.geometry.edges import first_equal
from inertia.mesh.geometry.faces import repeated_corners
from inertia.mesh.part import Cells, Part
from inertia.mesh.surface import Surface, Triangles
from inertia.recording.drawing import Color
from inertia.records import dataclass

STEEL = (150, 165, 185)
PART_COLORS = (STEEL, (200, 150, 110), (130, 180, 140), (190, 140, 180), (180, 175, 120), (120, 170, 190))

MOST = 50_000
"""Triangles that are shown; merging aims at this number."""

_DIM = 0.6  # of its colour, that a body has at other instants than that shown
_THINNEST = 0.01  # of the largest semi-axis, for an equivalent ellipsoid that would be flat
_POINT = 0.05  # of the body, or of how far it is from the origin, the radius of a part that is a point
_BLOCK = 1 << 18
_FINEST = 1 << 20  # cells along an edge of the part's box
_STRIDES = (1 << 42, 1 << 21, 1)  # a cell's number fits an integer


@dataclass(frozen=True, eq=False)
class Display:
    """A body as it is shown, along part axes.

    Attributes
    ----------
    unit : m, a power of ten: one unit of the view
    radius : the body's largest distance from its centre of mass, in `unit`, 1 ≤ radius < 10
    triangles : (k, 3, 3) corners about the centre of mass, in `unit`; None where the body has no faces to show
    semi_axes : (3,) of the equivalent ellipsoid along its principal axes, in `unit`; None where triangles are shown
    attitude : (4,) principal axes to part axes
    notes : what was done for display only, in sentences
    """

    unit: float
    radius: float
    triangles: Float | None
    semi_axes: Float | None
    attitude: Float
    notes: tuple[str, ...]

    def archetype(self, color: Color = STEEL) -> Any:
        """Return what draws the body."""
        if self.triangles is not None:
            return facets(self.triangles, color)
        assert self.semi_axes is not None
        return _ellipsoid(self.semi_axes, self.attitude, color)

    def enlarged(self, factor: float) -> Display:
        """Return the body as it is shown so many times as large."""
        triangles, semi_axes = (None if each is None else factor * each for each in (self.triangles, self.semi_axes))
        return replace(self, radius=factor * self.radius, triangles=triangles, semi_axes=semi_axes)

    def copies(self, places: Float, attitudes: Float) -> list[Any]:
        """Return what draws the body dim at places (k, 3), turned by attitudes (k, 4)."""
        return _copies(self.triangles, self.semi_axes, np.zeros(3), self.attitude, places, attitudes, STEEL)


def display_of(body: SceneBody) -> Display:
    """Return how a body is shown: its part, or the solid ellipsoid of the same moments; a point is a sphere."""
    principal = body.principal
    attitude = quaternion.from_matrix(principal.axes)
    if body.part is not None:
        corners, count = shown_triangles(body.part, body.center_of_mass)
        if len(corners):
            unit, radius = _unit(float(np.linalg.norm(corners, axis=2).max()))
            notes = (
                ()
                if len(corners) == count
                else (f"shown with {len(corners)} of its {count} triangles: near corners are merged, for display only",)
            )
            return Display(unit, radius, corners / unit, None, attitude, notes)
    semi_axes = equivalent_ellipsoid(principal.moments, body.mass)
    if not semi_axes.any():
        semi_axes = np.full(3, _POINT * (float(np.linalg.norm(body.center_of_mass)) or 1.0))
        unit, radius = _unit(float(semi_axes[0]))
        return Display(unit, radius, None, semi_axes / unit, attitude, ("its mass is in a point, shown as a sphere",))
    unit, radius = _unit(float(semi_axes.max()))
    notes = ("shown as the solid ellipsoid of the same moments",)
    if body.mass is None:
        notes = (f"{notes[0]}, of 1 kg as no mass is given",)
    return Display(unit, radius, None, semi_axes / unit, attitude, notes)


@dataclass(frozen=True, eq=False)
class Solid:
    """A part.

    Attributes
    ----------
    center : (3,) m, its centre of mass
    radius : m, how far from there it reaches
    triangles : (k, 3, 3) m about the centre of mass; None where it has no faces to show
    semi_axes : (3,) m, of the ellipsoid that is shown then
    attitude : (4,) that takes the ellipsoid's axes to assembly axes
    note : what was done for display only
    """

    center: Float
    radius: float
    triangles: Float | None
    semi_axes: Float
    attitude: Float
    note: str = ""

    def archetype(self, unit: float, number: int) -> Any:
        """Return what draws it, in units of `unit` m, in the colour of its number."""
        color = PART_COLORS[number % len(PART_COLORS)]
        if self.triangles is not None:
            return facets(self.triangles / unit, color, self.center / unit)
        return _ellipsoid(self.semi_axes / unit, self.attitude, color, self.center / unit, fill="Solid")

    def copies(self, unit: float, number: int, places: Float, attitudes: Float) -> list[Any]:
        """Return what draws it dim, with the assembly at places (k, 3), in units of `unit` m, and attitudes (k, 4)."""
        color, triangles = PART_COLORS[number % len(PART_COLORS)], self.triangles
        if triangles is not None:
            triangles = (triangles + self.center) / unit
        center = self.center / unit
        return _copies(triangles, self.semi_axes / unit, center, self.attitude, places, attitudes, color)


def solids_of(assembly: JointedBody, meshes: Sequence[Part | None]) -> list[Solid]:
    """Return the parts as shown: their meshes, or the solid ellipsoids of the same moments; a point is a sphere."""
    files = meshes or [None] * len(assembly.parts)
    solids = [_solid(part, mesh) for part, mesh in zip(assembly.parts, files, strict=True)]
    place = np.stack([solid.center for solid in solids])
    size = max(solid.radius for solid in solids) or float(np.ptp(place, axis=0).max())
    return [solid if solid.radius else _point(solid.center, _POINT * size) for solid in solids]


def _solid(part: JointedPart, mesh: Part | None) -> Solid:
    center = np.asarray(part.center_of_mass)
    if mesh is not None:
        triangles, count = shown_triangles(mesh, center)
        if len(triangles):
            note = "" if len(triangles) == count else f"shown with {len(triangles)} of its {count} triangles"
            radius = float(np.linalg.norm(triangles, axis=2).max())
            return Solid(center, radius, triangles, np.zeros(3), np.asarray(quaternion.IDENTITY), note)
    own = principal(part.inertia)
    semi_axes = equivalent_ellipsoid(own.moments, part.mass)
    return Solid(center, float(semi_axes.max()), None, semi_axes, quaternion.from_matrix(own.axes))


def _point(center: Float, radius: float) -> Solid:
    return Solid(center, radius, None, np.full(3, radius), np.asarray(quaternion.IDENTITY))


def equivalent_ellipsoid(moments: Float, mass: float | None) -> Float:
    """Return the semi-axes (3,) in m of the uniform solid ellipsoid with these moments: a₁² = 5 (I₂ + I₃ − I₁)/2m.

    A flat body is given a little thickness, so that it can be seen from its edge; without a mass it has 1 kg.

    >>> equivalent_ellipsoid(np.array([0.4, 0.4, 0.4]), 1.0).round(12).tolist()
    [1.0, 1.0, 1.0]
    """
    squares = 2.5 * (moments.sum() - 2.0 * moments) / (mass or 1.0)
    semi_axes: Float = np.sqrt(np.maximum(squares, _THINNEST**2 * squares.max()))
    return semi_axes


def _unit(size: float) -> tuple[float, float]:
    """Return the power of ten below a size, and the size in it."""
    unit = 10.0 ** math.floor(math.log10(size))
    return unit, size / unit


def _ellipsoid(
    semi_axes: Float,
    attitude: Float,
    color: Color,
    center: Float | None = None,
    fill: str = "TransparentFillMajorWireframe",
) -> Any:
    import rerun as rr

    return rr.Ellipsoids3D(
        half_sizes=[semi_axes],
        centers=None if center is None else [center],
        quaternions=[rr.Quaternion(xyzw=attitude)],
        colors=[color],
        fill_mode=rr.components.FillMode[fill],
    )


def _copies(
    triangles: Float | None,
    semi_axes: Float | None,
    center: Float,
    attitude: Float,
    places: Float,
    attitudes: Float,
    color: Color,
) -> list[Any]:
    """Return what draws triangles (n, 3, 3), else an ellipsoid about `center` (3,), at k places and attitudes."""
    import rerun as rr

    red, green, blue = (round(_DIM * part + (1.0 - _DIM) * 13) for part in color[:3])
    dim = red, green, blue
    if triangles is not None:
        return [facets(triangles, dim), rr.InstancePoses3D(translations=places, quaternions=attitudes)]
    assert semi_axes is not None
    return [
        rr.Ellipsoids3D(
            half_sizes=np.broadcast_to(semi_axes, places.shape),
            centers=places + quaternion.to_space(attitudes, center),
            quaternions=quaternion.multiply(attitudes, attitude),
            colors=[dim],
            fill_mode=rr.components.FillMode.Solid,
        )
    ]


def facets(corners: Float, color: Color, shift: Float | float = 0.0) -> Any:
    """Return what draws triangles (k, 3, 3), each of them flat, moved by a shift (3,)."""
    import rerun as rr

    normals = np.repeat(facet_normals(corners), 3, axis=0)
    return rr.Mesh3D(
        vertex_positions=(corners.reshape(-1, 3) + shift).astype(np.float32),
        vertex_normals=normals.astype(np.float32),
        albedo_factor=color,
    )


def shown_triangles(part: Part, center: Float, most: int = MOST) -> tuple[Float, int]:
    """Return the corners (k, 3, 3) in m about `center` (3,) m of what is shown, and how many triangles the part has.

    Of a mesh of cells it is the outside. Parts without faces (wires, points) have none.
    """
    triangles = outside(part.geometry) if isinstance(part.geometry, Cells) else part.geometry
    metres = float(part.unit.metres)

    def corners() -> Iterator[Float]:
        for start in range(0, triangles.count, _BLOCK):
            stop = min(start + _BLOCK, triangles.count)
            yield metres * (triangles.corners(start, stop) - center / metres)

    if triangles.count <= most:
        return np.concatenate([np.empty((0, 3, 3)), *corners()]), triangles.count
    low, high, area = np.full(3, np.inf), np.full(3, -np.inf), 0.0
    for some in corners():
        low, high = np.minimum(low, some.min(axis=(0, 1))), np.maximum(high, some.max(axis=(0, 1)))
        area += 0.5 * float(np.linalg.norm(_normals(some), axis=1).sum())
    # A surface of area A crosses about 3A/2 of the squares of a grid, with two triangles in each.
    size = max(math.sqrt(3.0 * area / most), float((high - low).max()) / _FINEST)
    return _merged(corners(), low, size), triangles.count


def facet_normals(corners: Float) -> Float:
    """Return the unit normals (k, 3) of triangles (k, 3, 3); zero where a triangle has no area."""
    normals = _normals(corners)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Float = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    return unit


def outside(cells: Cells) -> Triangles:
    """Return the faces that only one volume cell uses, as triangles over their corners."""
    welded = first_equal((cells.points + 0.0).view(np.int64))
    faces, keys = [np.empty((0, 4), np.int64)], [np.empty((0, 4), np.int64)]
    for _, block in volume_blocks(cells):
        for kind, nodes in KINDS[block.kind].faces:
            corners = block.nodes[:, nodes[: KINDS[kind].corners]]
            fourth = (0, 0), (0, 4 - corners.shape[1])  # of a triangle, the last again
            faces.append(np.pad(corners, fourth, mode="edge"))
            keys.append(np.pad(np.sort(welded[corners], axis=1), fourth, mode="edge"))
    first = first_equal(np.concatenate(keys))
    quads = np.concatenate(faces)[np.bincount(first, minlength=len(first))[first] == 1]
    halves = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Surface(cells.points, halves[halves[:, 1] != halves[:, 2]])


def _normals(corners: Float) -> Float:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _merged(blocks: Iterator[Float], low: Float, size: float) -> Float:
    """Return the triangles that are left when all corners in one cell of the grid become their mean."""
    numbers, sums, faces = [], [], []
    for corners in blocks:
        cells = ((corners.reshape(-1, 3) - low) / size).astype(np.int64)
        keys, place = np.unique(cells @ np.array(_STRIDES), return_inverse=True)
        count = np.bincount(place)
        added = [np.bincount(place, column) for column in corners.reshape(-1, 3).T]
        numbers.append(keys)
        sums.append(np.stack([*added, count], axis=1))
        triples = keys[place.reshape(-1, 3)]
        faces.append(triples[~repeated_corners(triples)])
    keys, place = np.unique(np.concatenate(numbers), return_inverse=True)
    total = np.stack([np.bincount(place, column) for column in np.concatenate(sums).T], axis=1)
    triples = np.searchsorted(keys, np.concatenate(faces))
    first = np.argmin(triples, axis=1)[:, None]
    distinct = np.unique(np.take_along_axis(triples, (first + np.arange(3)) % 3, axis=1), axis=0)
    means: Float = total[:, :3] / total[:, 3:]
    return means[distinct]
