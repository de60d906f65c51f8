"""`Shape`: the true shape of a part, solids bounded by trimmed faces, as a CAD file stores it (ISO 10303-42).

A face is a piece of a surface x(u, v), cut out by closed loops of curves in the plane of its parameters. All numbers
are those of the file, in its unit. The parameters are those of ISO 10303-42 and OpenCASCADE:

===========  ======================================================================================
line         o + t x
ellipse      o + a cos t x + b sin t y (a circle has a = b)
parabola     o + t² / (4 a) x + t y
hyperbola    o + a cosh t x + b sinh t y
plane        o + u x + v y
cylinder     o + a (cos u x + sin u y) + v z
cone         o + (a + v sin b)(cos u x + sin u y) + v cos b z
sphere       o + a cos v (cos u x + sin u y) + a sin v z
torus        o + (a + b cos v)(cos u x + sin u y) + b sin v z
extrusion    profile(u) + v z
revolution   profile(v), turned by the angle u about the axis through o along z
offset       basis(u, v) + a n, n the unit normal along ∂x/∂u × ∂x/∂v
===========  ======================================================================================

with the origin o and the axes x, y, z of the frame, and the sizes (a, b). A frame may be left-handed; the axes of a
surface are of unit length and at right angles, those of a curve need not be.
"""

from __future__ import annotations

from typing import Literal

from inertia.arrays import Float
from inertia.records import dataclass

CurveKind = Literal["line", "ellipse", "parabola", "hyperbola", "spline"]
SurfaceKind = Literal["plane", "cylinder", "cone", "sphere", "torus", "extrusion", "revolution", "offset", "spline"]


@dataclass(frozen=True, eq=False)
class Spline:
    """A B-spline, rational where it has weights; of one parameter (a curve) or two (a surface).

    Attributes
    ----------
    degrees : one a parameter
    knots : one array a parameter, with their multiplicities written out
    poles : (n, d) of a curve, (n, m, 3) of a surface
    weights : (n,) or (n, m), or None where all are one
    """

    degrees: tuple[int, ...]
    knots: tuple[Float, ...]
    poles: Float
    weights: Float | None = None


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve in the plane of a face's parameters (d = 2) or in space (d = 3).

    Attributes
    ----------
    kind : see the module
    frame : (3, d), the rows o, x, y; of a line, y is not used; of a spline, none is
    sizes : (a, b), as far as the kind has them
    spline : of a spline
    """

    kind: CurveKind
    frame: Float
    sizes: tuple[float, ...] = ()
    spline: Spline | None = None


@dataclass(frozen=True, eq=False)
class Patch:
    """An untrimmed surface.

    Attributes
    ----------
    kind : see the module
    frame : (4, 3), the rows o, x, y, z
    sizes : (a, b), as far as the kind has them
    profile : (curve in space, first, last parameter) of an extrusion or revolution
    basis : of an offset
    spline : of a spline
    """

    kind: SurfaceKind
    frame: Float
    sizes: tuple[float, ...] = ()
    profile: tuple[Curve, float, float] | None = None
    basis: Patch | None = None
    spline: Spline | None = None


@dataclass(frozen=True, eq=False)
class Trim:
    """One piece of a loop: a curve in the plane of parameters, walked from `start` to `stop` (which may be smaller).

    `edge` numbers the edge of the shape that it runs along; the other faces at that edge have trims with that number,
    walked by the same parameter (there is one where an edge is a point, as at the pole of a sphere, and two of one face
    where it is a seam).
    """

    curve: Curve
    start: float
    stop: float
    edge: int


@dataclass(frozen=True, eq=False)
class Face:
    """A piece of a surface; along its loops, the face lies on the left, seen in the plane of parameters (u, v).

    Attributes
    ----------
    patch : the surface
    loops : the outer one and those of holes, in any order
    inward : whether ∂x/∂u × ∂x/∂v points into the solid
    number : the place of the face in the file, from 1
    """

    patch: Patch
    loops: tuple[tuple[Trim, ...], ...]
    inward: bool
    number: int


@dataclass(frozen=True, eq=False)
class Solid:
    """Faces that bound a solid, voids included, in its own frame.

    Attributes
    ----------
    name : as the file says it, or a number
    faces : all of them
    placement : (3, 4), a rotation and a translation: where it is in the part
    closed : whether every edge has its two trims
    colour : (red, green, blue), 0 to 1, where the file states one
    path : names of the assemblies that it is in, from the outermost
    """

    name: str
    faces: tuple[Face, ...]
    placement: Float
    closed: bool
    colour: tuple[float, float, float] | None = None
    path: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Shape:
    """Solids, and how far apart the faces may be at each edge, by the file's own or the kernel's tolerance (e,)."""

    solids: tuple[Solid, ...]
    tolerances: Float
