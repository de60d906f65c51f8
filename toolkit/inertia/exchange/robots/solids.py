"""Geometries weighed in the axes of their link, and what is stated in part completed by what they have together.

That is as OpenUSD has it (`UsdPhysicsRigidBodyAPI::ComputeMassProperties`, tried with usd-core): a tensor that is not
stated is the shapes' own about the centre of mass as stated; moments that are stated without axes lie along those of
the shapes, and those of the shapes along axes that are stated without moments.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from operator import add
from pathlib import Path

import numpy as np

from inertia.arrays import Float
from inertia.errors import GeometryError, reworded
from inertia.exchange.robots.links import Geometry, Inertial, Partial, Placement, Primitive
from inertia.mass.analyse import analyse, sound_solids_only
from inertia.mass.properties import ErrorBound, MassProperties, stretched
from inertia.mesh.geometry.hull import convex_hull
from inertia.mesh.part import Part, Rounding
from inertia.mesh.read import read
from inertia.mesh.tree import ONE, determinant

_CLOSED_FORM = 2.0**-50
_ROUNDED = 2.0**-50  # of the largest: more than multiplying three numbers by rounded factors changes
_TURNS = 24  # of Jacobi's method, which squares what is left with every third


def inertial_of(geometries: Sequence[Geometry], mass: float | None, stated: Partial) -> Inertial:
    """Return the mass properties of a link that are stated in part, completed by what weighs of it.

    Parameters
    ----------
    mass : kg, as stated; None where the geometries have it
    """
    whole = reduce(add, (weighed(geometry, geometry.name) for geometry in geometries))
    return _completed(whole if mass is None else whole.with_mass(mass), stated)


def weighed(geometry: Geometry, name: str) -> MassProperties:
    """Return what a geometry has, in the axes of its link."""
    shape = geometry.shape
    if isinstance(shape, str):
        raise GeometryError(f"{name}: {shape}")
    if isinstance(shape, Primitive):
        properties = solid(shape)
        if geometry.mass is not None:
            properties = properties.with_mass(geometry.mass)
        else:
            properties = stretched(properties, ONE, Fraction(geometry.density or 1.0))
    else:
        properties = of_mesh(geometry, shape, name)
    if geometry.transform is not None:
        properties = properties.expressed_in(np.eye(3), -np.array(geometry.transform.at, object))
    turned = geometry.placement.rotation.T
    properties = properties.expressed_in(turned, -turned @ geometry.placement.origin)
    if geometry.stated is None:
        return properties
    whole = _completed(properties, geometry.stated)
    error = whole.error or properties.error
    try:
        return MassProperties(whole.mass, properties.volume, whole.placement.origin, whole.inertia, error)
    except GeometryError as error:
        raise reworded(error, error.words, (name,)) from None


def solid(shape: Primitive) -> MassProperties:
    """Return a primitive of 1 kg/m³ in its own axes, in closed form."""
    sizes, center, volume = np.array(shape.sizes), np.zeros(3), shape.volume
    if not (sizes > 0).all():
        raise GeometryError(f"a {shape.kind} of {', '.join(f'{size:g}' for size in sizes)} m encloses nothing")
    if shape.kind == "box":
        squares = sizes**2 / 12
    elif shape.kind in ("sphere", "ellipsoid"):
        squares = np.broadcast_to(sizes, 3) ** 2 / 5
    elif shape.kind == "cylinder":
        radius, length = sizes
        squares = np.array([radius**2 / 4, radius**2 / 4, length**2 / 12])
    elif shape.kind == "cone":
        radius, height = sizes
        squares = np.array([3 / 20 * radius**2, 3 / 20 * radius**2, 3 / 80 * height**2])
        center = np.array([0.0, 0.0, -height / 4])
    else:
        radius, length = sizes
        barrel, ball = np.pi * radius**2 * length, 4 / 3 * np.pi * radius**3
        beside = (barrel * radius**2 / 4 + ball * radius**2 / 5) / volume
        # Two half balls, each 3r/8 beyond its face: ∫z² of a half ball about the middle of the barrel.
        along = (barrel * length**2 / 12 + ball * (radius**2 / 5 + length**2 / 4 + 3 / 8 * length * radius)) / volume
        squares = np.array([beside, beside, along])
    inertia = volume * (squares.sum() * np.eye(3) - np.diag(squares))
    error = ErrorBound("closed form", _CLOSED_FORM, _CLOSED_FORM, 0.0, _CLOSED_FORM)
    return MassProperties(volume, volume, center, inertia, error)


def of_mesh(geometry: Geometry, mesh: Path | Part, name: str) -> MassProperties:
    """Return what a mesh weighs, or its surface, or its convex hull, in its own axes.

    Scale and transform are applied to the moments: coordinates that are multiplied or moved are rounded.
    """
    part = mesh if isinstance(mesh, Part) else read(mesh, "m")
    linear, density = geometry.linear, Fraction(1)
    if not determinant(linear):
        raise GeometryError(f"{name} is scaled to nothing: leave it out")
    if geometry.filling == "hull":
        hull = convex_hull(part.triangles.corners().reshape(-1, 3))
        if hull is None:
            raise GeometryError(f"{name} is flat: its convex hull encloses nothing")
        part = _of_corners(hull, 0.0 if part.rounding is None else part.rounding.distance)
    elif geometry.filling == "surface":
        sizes = {abs(linear[k][k]) for k in range(3)}
        if len(sizes) > 1:  # areas have no rule for that, so that it is the coordinates that are multiplied
            part, linear = _scaled(part, [float(linear[k][k]) for k in range(3)]), ONE
        else:
            density /= sizes.pop()  # of an area, which grows by one power less than a volume
    thickness = 1.0 if geometry.filling == "surface" else None
    try:
        with sound_solids_only("a link weighs by sound solids only"):
            properties = analyse(part, geometry.density or 1.0, shell=thickness).properties
    except GeometryError as error:
        raise reworded(error, error.words, (name,)) from None
    if linear != ONE:
        properties = stretched(properties, linear, density)
    return properties if geometry.mass is None else properties.with_mass(geometry.mass)


def _of_corners(corners: Float, distance: float) -> Part:
    """Return triangles (m, 3, 3) as a part whose vertices may be `distance` from where they belong, m."""
    part = Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), unit="m")
    return replace(part, rounding=Rounding(distance)) if distance else part


def _scaled(part: Part, scale: Sequence[float]) -> Part:
    """Return a mesh with its coordinates multiplied, and how far that rounds them."""
    corners = part.triangles.corners() * scale
    own = 0.0 if part.rounding is None else part.rounding.distance * max(map(abs, scale))
    return _of_corners(corners, own + _ROUNDED * float(np.abs(corners).max()))


def _completed(whole: MassProperties, stated: Partial) -> Inertial:
    """Return what is stated, and where it is not what shapes have, with its bound, along the axes of the link."""
    known, center = whole.error, whole.center_of_mass
    tensor, bound, place = whole.inertia, known.inertia, known.center_of_mass
    if stated.center is not None:
        tensor, bound = whole.about_with_bound(stated.center)
        center, place = stated.center, 0.0
    if stated.moments is not None or stated.axes is not None:
        size = float(np.linalg.norm(tensor))
        loose = (bound + _ROUNDED) * size
        own, turn = _diagonalised(stated.frame.T @ tensor @ stated.frame, loose)
        moments = own if stated.moments is None else stated.moments
        axes = stated.frame @ turn if stated.axes is None else stated.axes
        if stated.moments is None:
            bound *= 2  # of three moments, none off by more than the tensor
        elif stated.axes is None:
            bound = _askew(own, turn, moments, loose)
        else:
            bound = 0.0
        bound += _ROUNDED
        tensor = (axes * moments) @ axes.T
        tensor = (tensor + tensor.T) / 2
    error = ErrorBound(known.method, known.volume, known.mass, place, bound)
    return Inertial(whole.mass, Placement(origin=center), tensor, error=error)


def _diagonalised(tensor: Float, loose: float) -> tuple[Float, Float]:
    """Return the moments (3,) and axes (3, 3) of a tensor in the order in which Jacobi's method leaves them.

    Products that are no larger than `loose` count as zero: what lies along x, y and z is not turned.
    """
    axes = np.eye(3)
    for _ in range(_TURNS):
        rows = axes.T @ tensor @ axes
        i, j = max(((1, 2), (0, 2), (0, 1)), key=lambda pair: abs(rows[pair]))
        if abs(rows[i, j]) <= loose:
            break
        apart = rows[i, i] - rows[j, j]
        angle = 0.5 * math.atan2(math.copysign(2.0, apart) * rows[i, j], abs(apart))
        turn = np.eye(3)
        turn[[i, j], [i, j]], turn[j, i] = math.cos(angle), math.sin(angle)
        turn[i, j] = -turn[j, i]
        axes = axes @ turn
    return np.diag(axes.T @ tensor @ axes), axes


def _askew(own: Float, turn: Float, moments: Float, loose: float) -> float:
    """Return how far a tensor of these moments is open, relative, whose axes are those of one that is off by `loose`.

    An axis is off by at most that over the gap to the next moment (Davis and Kahan), where it matters which it is.
    """
    if np.array_equal(turn, np.eye(3)):
        return 0.0
    gaps = [abs(own[i] - own[j]) for i, j in ((0, 1), (0, 2), (1, 2)) if moments[i] != moments[j]]
    angle = min(1.0, 6 * loose / max(min(gaps, default=math.inf), loose))
    return float(4 * angle * np.linalg.norm(moments - moments.mean()) / np.linalg.norm(moments))
