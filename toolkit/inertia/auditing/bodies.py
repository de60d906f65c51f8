"""Mass, centre and tensor of the shapes of a link, and of what may have been taken for them: shell, hull, box.

Plain float64 in the axes of the link, for the search over mistakes; the certified figures stand in `MassProperties`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from inertia.arrays import Float
from inertia.exchange.robots.mjcf_masses import legacy
from inertia.mass.tensor import point_inertia
from inertia.mesh.geometry.hull import convex_hull
from inertia.records import dataclass


class Body(NamedTuple):
    """A rigid body: `mass` kg, `center` (3,) m, `inertia` (3, 3) kg m² about its own centre, one set of axes."""

    mass: float
    center: Float
    inertia: Float

    def weighed(self, density: float) -> Body:
        """Return the body with everything times `density`."""
        return Body(self.mass * density, self.center, self.inertia * density)

    def placed(self, rotation: Float, origin: Float) -> Body:
        """Return the body seen from axes in which its own are placed so."""
        return Body(self.mass, rotation @ self.center + origin, rotation @ self.inertia @ rotation.T)

    def grown(self, factor: float, dimensions: int = 3) -> Body:
        """Return the body with every length from its origin times a factor, made of what has so many dimensions."""
        size = factor**dimensions
        return Body(self.mass * size, self.center * factor, self.inertia * (size * factor**2))

    def mirrored(self, axis: int) -> Body:
        """Return the mirror image in the plane normal to a coordinate axis."""
        mirror = np.ones(3)
        mirror[axis] = -1.0
        return Body(self.mass, self.center * mirror, self.inertia * np.outer(mirror, mirror))


def norm(values: Float) -> float:
    """Return the root of the sum of squares, however small or large these are; of a tensor, its Frobenius norm."""
    return math.hypot(*values.ravel().tolist())


def together(bodies: Iterable[Body], *, steiner: bool = True) -> Body:
    """Return the bodies as one, with the terms of Steiner's theorem or, as a mistake has it, without them."""
    bodies = list(bodies)
    mass = sum(body.mass for body in bodies)
    center = sum((body.mass * body.center for body in bodies), np.zeros(3)) / mass
    inertia = sum((body.inertia for body in bodies), np.zeros((3, 3)))
    if steiner:
        inertia = inertia + sum(point_inertia(body.mass, body.center - center) for body in bodies)
    return Body(mass, center, inertia)


def solid_of(corners: Float) -> Body:
    """Return the solid of density 1 that triangles (m, 3, 3) enclose, by the divergence theorem."""
    middle = (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2
    a, b, c = (corners - middle).transpose(1, 0, 2)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    volume = float(volumes.sum())
    total = a + b + c
    first = np.einsum("i,ij->j", volumes, total) / 4
    second = sum(np.einsum("i,ij,ik->jk", volumes, each, each) for each in (a, b, c, total)) / 20
    return _of_moments(volume, first, second, middle)


def shell_of(corners: Float) -> Body:
    """Return the surface of triangles (m, 3, 3) itself, with 1 kg/m²."""
    middle = (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2
    a, b, c = (corners - middle).transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    total = a + b + c
    first = np.einsum("i,ij->j", areas, total) / 3
    second = sum(np.einsum("i,ij,ik->jk", areas, each, each) for each in (a, b, c, total)) / 12
    return _of_moments(float(areas.sum()), first, second, middle)


def _of_moments(mass: float, first: Float, second: Float, origin: Float) -> Body:
    center = first / mass
    second = second - mass * np.outer(center, center)
    return Body(mass, origin + center, np.trace(second) * np.eye(3) - second)


def cuboid(low: Float, high: Float) -> Body:
    """Return the box of density 1 between two corners (3,)."""
    square = (high - low) ** 2
    volume = float(np.prod(high - low))
    return Body(volume, (low + high) / 2, volume / 12 * (square.sum() * np.eye(3) - np.diag(square)))


@dataclass(frozen=True, eq=False)
class Shape:
    """A mesh or primitive of a link.

    Attributes
    ----------
    name : as the file has it
    corners : (m, 3, 3) m, its triangles in the axes of the link
    solid : of density 1, in the axes of the link
    rotation, origin : (3, 3), (3,) m: the axes of the mesh in those of the link, and where its origin lies there
    unit : metres of its file's own unit, where the robot's file scales it besides; 1 elsewhere
    surface : itself, with 1 kg/m², of a primitive, whose triangles are within what is round; None of a mesh
    """

    name: str
    corners: Float
    solid: Body
    rotation: Float
    origin: Float
    unit: float = 1.0
    surface: Body | None = None

    def moved(self, rotation: Float, origin: Float) -> Shape:
        """Return the shape in axes in which those of the link are placed so."""
        return replace(
            self,
            corners=self.corners @ rotation.T + origin,
            solid=self.solid.placed(rotation, origin),
            rotation=rotation @ self.rotation,
            origin=rotation @ self.origin + origin,
            surface=self.surface and self.surface.placed(rotation, origin),
        )

    def grown(self, factor: float, *, with_origin: bool = False) -> Shape:
        """Return the shape with every length from its own origin times a factor, where it is or moved out likewise."""
        own = self.moved(np.eye(3), -self.origin)
        grown = replace(
            own,
            corners=own.corners * factor,
            solid=own.solid.grown(factor),
            surface=own.surface and own.surface.grown(factor, 2),
        )
        return grown.moved(np.eye(3), self.origin * factor if with_origin else self.origin)

    @cached_property
    def box(self) -> tuple[Float, Float]:
        """The least and largest coordinates (3,) m along the axes of the link."""
        return self.corners.min(axis=(0, 1)), self.corners.max(axis=(0, 1))

    @cached_property
    def hull(self) -> Float | None:
        """The triangles (k, 3, 3) of the convex hull, wound outwards; None for what is flat."""
        return convex_hull(self.corners.reshape(-1, 3))

    @cached_property
    def shell(self) -> Body:
        """The surface itself, with 1 kg/m²."""
        return shell_of(self.corners) if self.surface is None else self.surface

    @cached_property
    def hull_solid(self) -> Body:
        """The convex hull, of density 1."""
        hull = None if self.hull is None else solid_of(self.hull)
        return self.solid if hull is None or hull.mass < self.solid.mass else hull  # facets of what is round

    @cached_property
    def legacy_solid(self) -> Body:
        """What MuJoCo's legacy rule counts of the mesh, of density 1: more than it encloses where it is not convex."""
        counted = legacy(self.corners) if self.surface is None else None
        return self.solid if counted is None else Body(counted.volume, counted.center, counted.inertia)

    @cached_property
    def box_solid(self) -> Body:
        """The box around the mesh, along the axes of the mesh, of density 1."""
        local = (self.corners - self.origin) @ self.rotation
        return cuboid(local.min(axis=(0, 1)), local.max(axis=(0, 1))).placed(self.rotation, self.origin)
