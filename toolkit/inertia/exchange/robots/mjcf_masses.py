"""What MuJoCo has the shell of a primitive weigh (``shellinertia``), and a mesh by ``inertia="legacy"``, its default.

By the XML reference of MuJoCo's documentation (asset/mesh/inertia, body/geom/shellinertia), and tried with MuJoCo.
"""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float
from inertia.exchange.robots.links import Primitive
from inertia.mass.properties import ErrorBound
from inertia.records import dataclass

_ROUNDING = 1e-9  # of a volume
_THOMSEN = 1.6075  # exponent in the approximate area of an ellipsoid


@dataclass(frozen=True, eq=False)
class Counted:
    """Moments that MuJoCo counts a mesh with: of the pyramids on its triangles, each with its volume made positive.

    Attributes
    ----------
    volume : m³ counted
    encloses : m³, the pyramids with their signs
    center : (3,) m
    away : m, how far that is from the centre of what it encloses
    inertia : (3, 3) about it, at 1 kg/m³
    error : what rounding may have done to them
    """

    volume: float
    encloses: float
    center: Float
    away: float
    inertia: Float
    error: ErrorBound


def legacy(corners: Float) -> Counted | None:
    """Return what MuJoCo counts of a mesh (m, 3, 3) m: Σ|V| of the pyramids between its triangles and an apex.

    For the centre of mass the apex is the centroid of the surface, and for volume and tensor that centre of mass.
    None where neither counts anything twice, as in a mesh that is convex: it is what the mesh encloses then.
    """
    with np.errstate(all="ignore"):  # of coordinates whose products float64 cannot hold, nothing is known here
        return _counted(corners)


def _counted(corners: Float) -> Counted | None:
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(crosses, axis=1)
    apex = areas @ corners.mean(axis=1) / areas.sum()
    sides = corners.mean(axis=1) - apex
    first = np.abs(np.einsum("ij,ij->i", sides, crosses)) / 6
    center = apex + 0.75 * (first @ sides) / first.sum()
    largest = float(np.abs(corners).max())
    corners = corners - center
    signed = np.einsum("ij,ij->i", corners.mean(axis=1), crosses) / 6
    volumes, sums = np.abs(signed), corners.sum(axis=1)
    second = np.einsum("i,ijk,ijl->kl", volumes, corners, corners) + np.einsum("i,ik,il->kl", volumes, sums, sums)
    inertia = (np.trace(second) * np.eye(3) - second) / 20
    volume, encloses = float(volumes.sum()), abs(float(signed.sum()))
    if not max(volume, float(first.sum())) > encloses * (1 + _ROUNDING):
        return None
    away = 0.75 * float(np.linalg.norm(signed @ corners.mean(axis=1))) / encloses
    # Each coordinate, and the apex, a sum of so many terms, may be off by `moved`; a pyramid by that times its base.
    reach, area = float(np.linalg.norm(corners, axis=2).max()), float(areas.sum())
    moved = (len(corners) + 64) * 2.0**-52 * (largest + reach)
    off = moved + 1.5 * area * moved * reach / volume  # of the centre
    lost = area * (moved + off)
    tensor = (2 * lost * reach**2 + 4 * volume * reach * off) / float(np.linalg.norm(inertia))
    error = ErrorBound("pyramids of MuJoCo", lost / volume, lost / volume, off, tensor)
    return Counted(volume, encloses, center, away, inertia, error)


def shell(shape: Primitive) -> tuple[float, Float]:
    """Return the area of a primitive, m², and the diagonal (3,) of its tensor as a shell of 1 kg, m².

    MuJoCo's shell of an ellipsoid has Thomsen's approximate area, and lies between it and one with half axes that are
    longer by the same little: a tensor is 1.7 % off in one of 1 : 2 : 3.
    """
    if shape.kind == "ellipsoid":
        a, b, c = shape.sizes
        products = np.array([b * c, c * a, a * b])
        squares = (products.sum() * np.square([a, b, c]) / (a * b * c) + 2 * np.array([a, b, c])) / 5
        area = 4 * math.pi * float((products**_THOMSEN).mean() ** (1 / _THOMSEN))
        squares *= a * b * c / products.sum()
    elif shape.kind == "box":
        x, y, z = shape.sizes
        faces = np.array([y * z, z * x, x * y])
        area = 2 * float(faces.sum())
        # Two faces lie at half the length from the middle, the other four spread along it.
        squares = np.square([x, y, z]) / 12 * (1 + 4 * faces / area)
    elif shape.kind == "sphere":
        (radius,) = shape.sizes
        area, squares = 4 * math.pi * radius**2, np.full(3, radius**2 / 3)
    else:
        radius, length = shape.sizes
        barrel = 2 * math.pi * radius * length
        if shape.kind == "cylinder":
            ends = 2 * math.pi * radius**2
            beside = barrel * radius**2 / 2 + ends * radius**2 / 4
            along = barrel * length**2 / 12 + ends * length**2 / 4
        else:  # a half sphere has its centre of mass at r/2 beyond its rim
            ends = 4 * math.pi * radius**2
            beside = barrel * radius**2 / 2 + ends * radius**2 / 3
            along = barrel * length**2 / 12 + ends * (length**2 / 4 + length * radius / 2 + radius**2 / 3)
        area = barrel + ends
        squares = np.array([beside, beside, along]) / area
    return area, squares.sum() - squares
