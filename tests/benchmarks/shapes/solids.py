"""Thirty solids made by OpenCASCADE, with their volumes where these are known without integrating over faces."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Curve

from . import kernel as k


@dataclass(frozen=True)
class Sample:
    """A solid: its name, what makes it, and its volume, or None."""

    name: str
    make: Callable[[], Any]
    volume: Callable[[], float] | None
    kind: str = "analytic"


def _over_area(wire: Any, of: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> float:
    """∮ f dy along a wire in the plane z = 0, counter-clockwise, with ∂f/∂x what is integrated over the area."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    total = 0.0
    for edge in k.pieces(wire, "Edge"):
        curve = BRepAdaptor_Curve(edge)
        spline = curve.BSpline()
        for low, high in pairwise(spline.Knot(i) for i in range(1, spline.NbKnots() + 1)):
            for node, weight in zip(nodes, weights, strict=True):
                point, rate = _jet(spline, 0.5 * (low + high) + 0.5 * (high - low) * node)
                total += 0.5 * (high - low) * weight * float(of(*point[:2])) * rate[1]
    return abs(total)


def _jet(spline: Any, t: float) -> tuple[list[float], list[float]]:
    from OCP.gp import gp_Pnt, gp_Vec

    point, rate = gp_Pnt(), gp_Vec()
    spline.D1(t, point, rate)
    return k.xyz(point), k.xyz(rate)


def _two_cylinders(large: float, small: float, apart: float) -> float:
    """What two cylinders at right angles share, their axes so far apart: ∫ 4 √(R² − y²) √(r² − (y − d)²) dy."""
    angles, weights = np.polynomial.legendre.leggauss(200)
    y = apart + small * np.sin(0.5 * math.pi * angles)
    rate = 0.5 * math.pi * small * np.cos(0.5 * math.pi * angles)
    chord = small * np.cos(0.5 * math.pi * angles)
    return float((weights * rate * 4.0 * np.sqrt(large**2 - y**2) * chord).sum())


def _tooth_points(teeth: int, inner: float, outer: float) -> np.ndarray:
    angles = 2 * math.pi / teeth * (np.arange(teeth)[:, None] + np.array([0.0, 0.28, 0.36, 0.64, 0.72]))
    radii = np.array([inner, inner, outer, outer, inner]) * np.ones((teeth, 1))
    return np.column_stack([(radii * np.cos(angles)).ravel(), (radii * np.sin(angles)).ravel(), 0 * angles.ravel()])


def _gear() -> Any:
    body = k.extruded(k.polygon(_tooth_points(24, 18.0, 22.0).tolist()), (0, 0, 8))
    return k.cut(body, k.cylinder(5.0, 10.0, (0, 0, -1)))


def _gear_volume() -> float:
    x, y, _ = _tooth_points(24, 18.0, 22.0).T
    return 8.0 * (0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) - 25.0 * math.pi)


def _impeller() -> Any:
    hub = k.cone(6.0, 3.0, 10.0)
    blades = hub
    for number in range(5):
        wires = []
        for z, turn in ((1.0, 0.0), (4.0, 0.3), (8.0, 0.8)):
            c, s = math.cos(turn), math.sin(turn)
            corners = [(2.0, -0.4), (14.0, -0.3), (14.0, 0.3), (2.0, 0.4)]
            wires.append(k.polygon([(c * x - s * y, s * x + c * y, z) for x, y in corners]))
        blades = k.fused(blades, k.moved(k.lofted(wires), (0, 0, 0), angle=2 * math.pi * number / 5))
    return blades


_CROSSED = lambda r: (k.cylinder(r, 10, (0, 0, -5)), k.cylinder(r, 10, (-5, 0, 0), (1, 0, 0)))  # noqa: E731
_WAVE = k.wavy(5, 0.3)
_AREA = lambda: _over_area(_WAVE, lambda x, y: x)  # noqa: E731
_LOFT = lambda: k.lofted([k.ring(2.0, 0.0), k.ring(1.0, 3.0, 0.5), k.ring(1.5, 6.0)])  # noqa: E731
_BALL = 4.0 / 3.0 * math.pi

SAMPLES = (
    Sample("box", lambda: k.box((1, 2, 3)), lambda: 6.0),
    Sample("sphere", lambda: k.sphere(3.0), lambda: 27 * _BALL),
    Sample("sphere far from the origin", lambda: k.sphere(3.0, (1000, -700, 300)), lambda: 27 * _BALL),
    Sample("cylinder", lambda: k.cylinder(2, 5), lambda: 20 * math.pi),
    Sample("frustum", lambda: k.cone(2, 1, 5), lambda: 35 * math.pi / 3),
    Sample("pointed cone, askew", lambda: k.cone(2, 0, 5, along=(1, 2, 3)), lambda: 20 * math.pi / 3),
    Sample("torus", lambda: k.torus(5, 2), lambda: 40 * math.pi**2),
    Sample("disc, 1000 : 1", lambda: k.cylinder(50, 0.1), lambda: 250 * math.pi),
    Sample("box, all edges rounded", lambda: k.filleted(k.box((10, 20, 30)), 2.0), lambda: _steiner((6, 16, 26), 2.0)),
    Sample("two cylinders shared", lambda: k.common(*_CROSSED(2)), lambda: 128 / 3),
    Sample("two cylinders united", lambda: k.fused(*_CROSSED(2)), lambda: 80 * math.pi - 128 / 3),
    Sample(
        "shaft with an eccentric cross hole",
        lambda: k.cut(k.cylinder(2, 10, (0, 0, -5)), k.cylinder(1.5, 10, (-5, 0.3, 0), (1, 0, 0))),
        lambda: 40 * math.pi - _two_cylinders(2, 1.5, 0.3),
    ),
    Sample("drilled sphere", lambda: k.cut(k.sphere(5), k.cylinder(3, 20, (0, 0, -10))), lambda: math.pi * 8**3 / 6),
    Sample("spherical cap", lambda: k.common(k.sphere(3), k.box((8, 8, 8), (-4, -4, 1))), lambda: math.pi * 28 / 3),
    Sample("lens of two spheres", lambda: k.common(k.sphere(3), k.sphere(3, (4, 0, 0))), lambda: 16 * math.pi / 3),
    Sample("half torus", lambda: k.cut(k.torus(5, 2), k.box((20, 20, 20), (-10, 0, -10))), lambda: 20 * math.pi**2),
    Sample("gear of 24 teeth, bored", _gear, _gear_volume),
    Sample("box hollowed", lambda: k.shelled(k.box((10, 20, 30)), 5, 1.0), lambda: 6000.0 - 8 * 18 * 29),
    Sample("cup hollowed", lambda: k.shelled(k.cylinder(5, 10), 1, 1.0), lambda: math.pi * (250 - 16 * 9)),
    Sample(
        "assembly of forty",
        lambda: _several([k.moved(k.cylinder(3, 1), (10 * n, 0, 0), (1, 1, n), n) for n in range(40)]),
        lambda: 360 * math.pi,
    ),
    Sample("spline extruded", lambda: k.extruded(_WAVE, (0, 0, 4)), lambda: 4 * _AREA(), "spline"),
    Sample("spline extruded askew", lambda: k.extruded(_WAVE, (1, 0.5, 4)), lambda: 4 * _AREA(), "spline"),
    Sample(
        "spline revolved",
        lambda: k.revolved(_WAVE, (5, 0, 0), (0, 1, 0)),
        lambda: 2 * math.pi * _over_area(_WAVE, lambda x, y: 5 * x - x * x / 2),
        "spline",
    ),
    Sample(
        "spline revolved by 2 rad",
        lambda: k.revolved(_WAVE, (5, 0, 0), (0, 1, 0), 2.0),
        lambda: 2 * _over_area(_WAVE, lambda x, y: 5 * x - x * x / 2),
        "spline",
    ),
    Sample("sphere as a rational spline", lambda: k.nurbs(k.sphere(3.0)), lambda: 27 * _BALL, "spline"),
    Sample("torus as a rational spline", lambda: k.nurbs(k.torus(5, 2)), lambda: 40 * math.pi**2, "spline"),
    Sample("two cylinders shared, as splines", lambda: k.nurbs(k.common(*_CROSSED(2))), lambda: 128 / 3, "spline"),
    Sample("loft of three circles", _LOFT, None, "spline"),
    Sample("loft, hollowed", lambda: k.shelled(_LOFT(), 1, 0.2), None, "spline"),
    Sample("loft, drilled", lambda: k.cut(_LOFT(), k.cylinder(0.5, 10, (-5, 0, 2), (1, 0.1, 0))), None, "spline"),
    Sample("impeller of five twisted blades", _impeller, None, "spline"),
    Sample("spline extruded, edges rounded", lambda: k.filleted(k.extruded(_WAVE, (0, 0, 4)), 0.2), None, "spline"),
)


def _steiner(size: tuple[float, float, float], radius: float) -> float:
    """All that is within a radius of a box: Steiner's formula."""
    a, b, c = size
    return a * b * c + 2 * radius * (a * b + b * c + c * a) + math.pi * radius**2 * (a + b + c) + _BALL * radius**3


def _several(shapes: list[Any]) -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound
