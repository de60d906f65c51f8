"""Meshes and primitives of a link weighed at 1 kg/m³ in the axes of the link."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body, Shape
from inertia.auditing.judge import Finding, Weighed, placed
from inertia.errors import GeometryError, InertiaError
from inertia.exchange.robots.links import Geometry, Primitive
from inertia.exchange.robots.mjcf_masses import shell
from inertia.exchange.robots.solids import solid
from inertia.mass.analyse import analyse
from inertia.mass.faults import widths
from inertia.mass.properties import MassProperties, stretched
from inertia.mesh import primitives
from inertia.mesh.part import Part
from inertia.mesh.read import read
from inertia.mesh.tree import ONE, determinant, diagonal
from inertia.mesh.tree import Motion as Transform
from inertia.records import dataclass
from inertia.units import METRE, Unit, scaled

_NODES = 96  # of the quadrature over an ellipsoid, each way: 1e-12 at 1 : 3, 1e-4 at 1 : 100
_ALLOWED = 0.999  # for faults: what is more leaves nothing certain


@dataclass(frozen=True, eq=False)
class _Mesh:
    """A mesh in its own axes.

    Mass properties at 1 kg/m³, triangles (m, 3, 3) in m, what had to be done to it, and what that leaves open
    (relative, of mass and tensor); the metres of its file's own unit, where a scale multiplies these once more; the
    surface of a primitive with 1 kg/m².
    """

    properties: MassProperties
    corners: Float
    note: Finding | None = None
    room: float = 0.0
    unit: float = 1.0
    surface: Body | None = None


class Scales:
    """Weighs geometries, each mesh once."""

    def __init__(self) -> None:
        self._meshes: dict[tuple[object, ...], _Mesh | InertiaError] = {}

    def weigh(self, geometry: Geometry) -> tuple[Weighed, Finding | None]:
        """Return a geometry weighed, and what had to be done to it; raise as `inertia.read` and `mass_properties`."""
        if isinstance(geometry.shape, str):
            raise GeometryError(geometry.shape)
        with np.errstate(all="ignore"):  # what leaves float64 is refused as mass properties
            mesh = (
                _primitive(geometry.shape)
                if isinstance(geometry.shape, Primitive)
                else self._mesh(geometry.shape, geometry)
            )
        where = geometry.placement
        properties = placed(mesh.properties, where)
        corners = mesh.corners @ where.rotation.T + where.origin
        solid = Body(properties.mass, properties.center_of_mass, properties.inertia)
        note = mesh.note and Finding(mesh.note.code, f"{geometry.name}: {mesh.note.sentence}")
        surface = mesh.surface and mesh.surface.placed(where.rotation, where.origin)
        shape = Shape(geometry.name, corners, solid, where.rotation, where.origin, mesh.unit, surface)
        return Weighed(shape, properties, mesh.room), note

    def _mesh(self, source: Path | Part, geometry: Geometry) -> _Mesh:
        scale = geometry.scale
        key = source, scale, geometry.transform
        if key not in self._meshes:
            try:
                part = source if isinstance(source, Part) else read(source)
                twice = (
                    part.unit_from == "file"
                    and scale is not None
                    and scale != (Fraction(1),) * 3
                    and isinstance(source, Path)
                )
                unit = float(part.unit.metres) if twice else 1.0
                self._meshes[key] = replace(_weighed(*_scaled(part, geometry)), unit=unit)
            except InertiaError as error:
                self._meshes[key] = error
        mesh = self._meshes[key]
        if isinstance(mesh, InertiaError):
            raise mesh
        return mesh


def _scaled(part: Part, geometry: Geometry) -> tuple[Part, Transform]:
    """Return the part in a unit of length, and how it is mirrored, stretched and shifted then.

    A factor that is common to x, y and z goes to the unit, in which findings tell lengths and volumes.
    """
    base = part.unit if part.unit_from == "file" else METRE
    if geometry.transform is None and 0 in (scale := geometry.scale or (1, 1, 1)):
        factors = " ".join(f"{float(each):g}" for each in scale)
        raise GeometryError(f"{part.name} is scaled by {factors}: nothing is left of it")
    to = geometry.transform or Transform(linear=geometry.linear)
    size = abs(to.linear[0][0])
    signs = diagonal([Fraction(-1 if to.linear[k][k] < 0 else 1) for k in range(3)])
    if size and to.linear == tuple(tuple(size * each for each in row) for row in signs):
        return replace(part, unit=scaled(base, size), unit_from="file"), replace(to, linear=signs)
    if part.unit_from != "file":
        base = Unit("(unit of its file)", METRE.metres)  # a factor of its own along each axis makes it no length
    return replace(part, unit=base, unit_from="file"), to


def _weighed(part: Part, to: Transform) -> _Mesh:
    """Weigh a mesh, small faults allowed for: what they leave open is in the bounds.

    Its moments are stretched and shifted, and not its coordinates, which that would round.
    """
    if not determinant(to.linear):
        raise GeometryError("the mesh is scaled to nothing")
    analysis = analyse(part, 1.0, allow_faults=_ALLOWED)
    properties = analysis.properties
    if to.linear != ONE:
        properties = stretched(properties, to.linear)
    if any(to.at):
        properties = properties.expressed_in(np.eye(3), -np.array(to.at, object))
    corners = analysis.part.triangles.corners() * float(part.unit.metres)
    corners = corners @ np.array(to.linear, float).T + np.array(to.at, float)
    if determinant(to.linear) < 0:
        corners = corners[:, ::-1]
    if analysis.refusal is None:
        return _Mesh(properties, corners)
    size = float(np.ptp(corners, axis=(0, 1)).max())
    room = max(widths(properties.error, size).values())
    changes = "; ".join(analysis.part.notes[len(part.notes) :]) or "each body counted by itself"
    words = f"{cause(analysis.refusal)}; weighed nevertheless, {changes}; that leaves it open to {100 * room:.2g} %"
    return _Mesh(properties, corners, Finding("mesh_mended", words), room)


def cause(error: InertiaError) -> str:
    """Return what an error says is the matter with a mesh, without its place and its remedy."""
    words = str(error.words[0]) if error.words else str(error)
    return words.rpartition(": ")[0] or words


def _primitive(shape: Primitive) -> _Mesh:
    """Return a primitive of density 1 about its own centre, in closed form."""
    properties = solid(shape)
    if shape.kind == "box":
        corners = primitives.box(np.array(shape.sizes) / 2)
    elif shape.kind in ("sphere", "ellipsoid"):
        corners = primitives.ball() * np.broadcast_to(shape.sizes, 3)
    elif shape.kind in ("cylinder", "cone"):
        radius, length = shape.sizes
        ends = np.array([1.0, 0.0]) if shape.kind == "cone" else np.ones(2)
        corners = primitives.revolved(np.array([-1.0, 1.0]), ends) * [radius, radius, length / 2]
    else:
        radius, length = shape.sizes
        ball = primitives.ball() * radius
        corners = ball + np.sign(ball[..., 2:]) * np.array([0, 0, length / 2])
    return _Mesh(properties, corners, surface=_surface(shape))


def _surface(shape: Primitive) -> Body:
    """Return the surface of a primitive with 1 kg/m², in closed form; that of an ellipsoid by quadrature."""
    if shape.kind == "ellipsoid":
        heights, weights = np.polynomial.legendre.leggauss(_NODES)
        angles = np.arange(_NODES) * (2 * np.pi / _NODES)
        x, y = (np.sqrt(1 - heights**2)[:, None] * of(angles) for of in (np.cos, np.sin))
        sphere = np.array([x, y, np.broadcast_to(heights[:, None], x.shape)])
        axes = np.array(shape.sizes)[:, None, None]
        # On the unit sphere the area is abc times the length of (x/a, y/b, z/c).
        areas = np.prod(axes) * np.sqrt(np.sum((sphere / axes) ** 2, axis=0)) * weights[:, None] * (2 * np.pi / _NODES)
        squares = np.sum((sphere * axes) ** 2 * areas, axis=(1, 2))
        return Body(float(areas.sum()), np.zeros(3), np.diag(squares.sum() - squares))
    if shape.kind == "cone":
        radius, height = shape.sizes
        side, base = math.pi * radius * math.hypot(radius, height), math.pi * radius**2
        # From the apex: the side has its centre at 2/3 of the height and ∫z² = ½ h² a square metre, the base has all.
        down, along = (2 / 3 * side + base) * height, (side / 2 + base) * height**2
        beside = (side + base) * radius**2 / 4
        along -= down**2 / (side + base)
        inertia = np.diag([beside + along, beside + along, 2 * beside])
        return Body(side + base, np.array([0.0, 0.0, height / 2 - down / (side + base)]), inertia)
    area, moments = shell(shape)
    return Body(area, np.zeros(3), np.diag(area * moments))
