"""Faces of OpenCASCADE as plain data: surfaces, and the curves that bound them in the planes of their parameters."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from OCP import (
    BRep,
    BRepAdaptor,
    BRepBuilderAPI,
    BRepTools,
    Geom2dConvert,
    GeomAbs,
    GeomAdaptor,
    GeomConvert,
    TopAbs,
)

from inertia.arrays import Float
from inertia.mesh.readers.opencascade.kernel import bounds_something, cast, kind_of, parts_of
from inertia.mesh.shape import Curve, Face, Patch, Spline, Trim

_SAMPLES = 17  # a parameter, where a conversion is measured
_NEAR, _PIECES, _DEGREE = 1e-10, 1000, 13  # what a conversion is asked for: distance, spans, degree


class Edges:
    """Numbers of the edges of a body, in the order in which they are met; their tolerances, and which are points."""

    def __init__(self, first: int, edges: Any) -> None:
        self._first, self._edges = first, edges
        self.tolerances: list[float] = []
        self.points: set[int] = set()

    def number(self, edge: Any) -> int:
        """Return the number of an edge."""
        place = int(self._edges.Add(edge)) - 1
        if place == len(self.tolerances):
            self.tolerances.append(float(BRep.BRep_Tool.Tolerance_s(edge)))
            if BRep.BRep_Tool.Degenerated_s(edge):
                self.points.add(self._first + place)
        return self._first + place

    def widen(self, number: int, distance: float) -> None:
        """Add what a conversion is off by to the tolerance of an edge."""
        self.tolerances[number - self._first] += distance


def face_data(face: Any, edges: Edges, number: int) -> Face:
    """Return a face as plain data, in the frame of the shape that it was taken from."""
    inward = face.Orientation() == TopAbs.TopAbs_REVERSED
    face = cast(face.Oriented(TopAbs.TopAbs_FORWARD), "Face")
    wires = [wire for wire in parts_of(face) if kind_of(wire) == "WIRE" and bounds_something(wire)]
    surface = BRep.BRep_Tool.Surface_s(face)
    if not wires:
        face = BRepBuilderAPI.BRepBuilderAPI_MakeFace(surface, 1e-7).Face()
        wires = list(parts_of(face))
    bounds = BRepTools.BRepTools.UVBounds_s(face)
    patch, off = _patch(GeomAdaptor.GeomAdaptor_Surface(surface), bounds)
    loops = []
    for wire in wires:
        loop = []
        for edge in _ordered(wire, face):
            curve = BRepAdaptor.BRepAdaptor_Curve2d(edge, face)
            ends = curve.FirstParameter(), curve.LastParameter()
            plane, away = _curve(curve, *ends, 2)
            at = edges.number(edge)
            edges.widen(at, off + away)
            if edge.Orientation() == TopAbs.TopAbs_REVERSED:
                ends = ends[::-1]
            loop.append(Trim(plane, *ends, at))
        loops.append(tuple(loop))
    return Face(patch, tuple(loops), inward, number)


def scaled_face(face: Face, scale: float) -> Face:
    """Return a face in another unit of length; the parameters of edges remain, in those of surfaces lengths change."""
    if scale == 1.0:
        return face
    patch = _scaled_patch(face.patch, scale)
    stretch = _stretch(face.patch, scale)
    loops = tuple(
        tuple(replace(trim, curve=_scaled_curve(trim.curve, stretch)) for trim in loop) for loop in face.loops
    )
    return replace(face, patch=patch, loops=loops)


def _scaled_patch(patch: Patch, scale: float) -> Patch:
    frame, sizes, profile = patch.frame.copy(), tuple(scale * size for size in patch.sizes), patch.profile
    frame[0] *= scale
    if patch.kind == "cone":
        sizes = (sizes[0], patch.sizes[1])
    if profile is not None:
        profile = (_scaled_curve(profile[0], np.full(3, scale)), *profile[1:])
    basis = None if patch.basis is None else _scaled_patch(patch.basis, scale)
    spline = None if patch.spline is None else replace(patch.spline, poles=scale * patch.spline.poles)
    return Patch(patch.kind, frame, sizes, profile, basis, spline)


def _stretch(patch: Patch, scale: float) -> Float:
    """Return by what the parameters of a surface change with the unit of length."""
    if patch.basis is not None:
        return _stretch(patch.basis, scale)
    lengths = {"plane": (True, True), "cylinder": (False, True), "cone": (False, True), "extrusion": (False, True)}
    return np.where(lengths.get(patch.kind, (False, False)), scale, 1.0)


def _scaled_curve(curve: Curve, stretch: Float) -> Curve:
    """Return a curve stretched along the axes of coordinates: its formula, and its parameter, remain."""
    spline = None if curve.spline is None else replace(curve.spline, poles=stretch * curve.spline.poles)
    return replace(curve, frame=stretch * curve.frame, spline=spline)


def _ordered(wire: Any, face: Any) -> list[Any]:
    """Return the edges of a wire, one after the other where they can be put so."""
    edges = [cast(edge, "Edge") for edge in parts_of(wire) if bounds_something(edge)]
    walk, ordered = BRepTools.BRepTools_WireExplorer(cast(wire, "Wire"), face), []
    while walk.More():
        ordered.append(cast(walk.Current(), "Edge"))
        walk.Next()
    return ordered if len(ordered) == len(edges) else edges


def _xyz(point: Any) -> list[float]:
    return [point.X(), point.Y(), point.Z()]


def _frame(position: Any) -> Float:
    rows = position.Location(), position.XDirection(), position.YDirection(), position.Direction()
    return np.array([_xyz(row) for row in rows])


def _about(location: Any, direction: Any) -> Float:
    """Return a frame with an axis of which nothing but z, and the origin of a revolution, counts."""
    z = np.array(_xyz(direction))
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    return np.array([np.zeros(3) if location is None else _xyz(location), x, np.cross(z, x), z])


def _patch(surface: Any, bounds: tuple[float, float, float, float]) -> tuple[Patch, float]:
    """Return an adapted surface as plain data, and how far that is from it within the bounds (u, u, v, v)."""
    kind = surface.GetType()
    if kind == GeomAbs.GeomAbs_Plane:
        return Patch("plane", _frame(surface.Plane().Position())), 0.0
    if kind == GeomAbs.GeomAbs_Cylinder:
        cylinder = surface.Cylinder()
        return Patch("cylinder", _frame(cylinder.Position()), (cylinder.Radius(),)), 0.0
    if kind == GeomAbs.GeomAbs_Cone:
        cone = surface.Cone()
        return Patch("cone", _frame(cone.Position()), (cone.RefRadius(), cone.SemiAngle())), 0.0
    if kind == GeomAbs.GeomAbs_Sphere:
        sphere = surface.Sphere()
        return Patch("sphere", _frame(sphere.Position()), (sphere.Radius(),)), 0.0
    if kind == GeomAbs.GeomAbs_Torus:
        torus = surface.Torus()
        return Patch("torus", _frame(torus.Position()), (torus.MajorRadius(), torus.MinorRadius())), 0.0
    nowhere = np.concatenate([np.zeros((1, 3)), np.eye(3)])
    if kind in (GeomAbs.GeomAbs_SurfaceOfExtrusion, GeomAbs.GeomAbs_SurfaceOfRevolution):
        extruded = kind == GeomAbs.GeomAbs_SurfaceOfExtrusion
        basis = surface.BasisCurve()
        first, last = bounds[:2] if extruded else bounds[2:]
        curve, off = _curve(basis, first, last, 3)
        if extruded:
            return Patch("extrusion", _about(None, surface.Direction()), profile=(curve, first, last)), off
        axis = surface.AxeOfRevolution()
        frame = _about(axis.Location(), axis.Direction())
        return Patch("revolution", frame, profile=(curve, first, last)), off
    if kind == GeomAbs.GeomAbs_OffsetSurface:
        basis, off = _patch(surface.BasisSurface(), bounds)
        return Patch("offset", nowhere, (surface.OffsetValue(),), basis=basis), off
    off = 0.0
    if kind == GeomAbs.GeomAbs_BSplineSurface:
        spline = surface.BSpline()
    elif kind == GeomAbs.GeomAbs_BezierSurface:
        spline = GeomConvert.GeomConvert.SurfaceToBSplineSurface_s(surface.Bezier())
    else:
        trimmed = surface.UTrim(*bounds[:2], _NEAR).VTrim(*bounds[2:], _NEAR)
        spline = GeomConvert.GeomConvert_ApproxSurface(trimmed, _NEAR, GeomAbs.GeomAbs_C2, *[_DEGREE] * 2, _PIECES, 0)
        spline = spline.Surface()
        places = np.linspace(bounds[0::2], bounds[1::2], _SAMPLES).T.tolist()
        off = max(surface.Value(u, v).Distance(spline.Value(u, v)) for u in places[0] for v in places[1])
    return Patch("spline", nowhere, spline=_spline_surface(spline, bounds)), off


def _coordinates(point: Any, size: int) -> list[float]:
    return [point.X(), point.Y()] if size == 2 else _xyz(point)


def _curve(curve: Any, first: float, last: float, size: int) -> tuple[Curve, float]:
    """Return an adapted curve in the plane (2) or in space (3), and how far that is from it in the range."""
    kind = curve.GetType()
    if kind == GeomAbs.GeomAbs_Line:
        line = curve.Line()
        ahead = _coordinates(line.Direction(), size)
        beside = [-ahead[1], ahead[0]] if size == 2 else [0.0, 0.0, 0.0]
        return Curve("line", np.array([_coordinates(line.Location(), size), ahead, beside])), 0.0
    if kind == GeomAbs.GeomAbs_Circle:
        circle = curve.Circle()
        return Curve("ellipse", _axes(circle, size), (circle.Radius(), circle.Radius())), 0.0
    if kind == GeomAbs.GeomAbs_Ellipse:
        ellipse = curve.Ellipse()
        return Curve("ellipse", _axes(ellipse, size), (ellipse.MajorRadius(), ellipse.MinorRadius())), 0.0
    if kind == GeomAbs.GeomAbs_Parabola:
        parabola = curve.Parabola()
        return Curve("parabola", _axes(parabola, size, "Parabola"), (parabola.Focal(),)), 0.0
    if kind == GeomAbs.GeomAbs_Hyperbola:
        hyperbola = curve.Hyperbola()
        return Curve("hyperbola", _axes(hyperbola, size), (hyperbola.MajorRadius(), hyperbola.MinorRadius())), 0.0
    off = 0.0
    if kind == GeomAbs.GeomAbs_BSplineCurve:
        spline = curve.BSpline()
    elif kind == GeomAbs.GeomAbs_BezierCurve:
        to_spline = Geom2dConvert.Geom2dConvert if size == 2 else GeomConvert.GeomConvert
        spline = to_spline.CurveToBSplineCurve_s(curve.Bezier())
    else:
        approximate = Geom2dConvert.Geom2dConvert_ApproxCurve if size == 2 else GeomConvert.GeomConvert_ApproxCurve
        spline = approximate(curve.Trim(first, last, _NEAR), _NEAR, GeomAbs.GeomAbs_C2, _PIECES, _DEGREE).Curve()
        places = np.linspace(first, last, _SAMPLES**2)
        off = max(curve.Value(t).Distance(spline.Value(t)) for t in places.tolist())
    empty = np.zeros((3, size))
    return Curve("spline", empty, spline=_spline_curve(spline, first, last, size)), off


def _axes(conic: Any, size: int, kind: str = "") -> Float:
    """Return the origin and the axes of a conic."""
    if kind and size == 2:
        axes = conic.Axis()
        axis_x, axis_y = axes.XAxis().Direction(), axes.YAxis().Direction()
    else:
        axis_x, axis_y = conic.XAxis().Direction(), conic.YAxis().Direction()
    return np.array([_coordinates(point, size) for point in (conic.Location(), axis_x, axis_y)])


def _flat(knots: list[float], multiplicities: list[int]) -> Float:
    return np.repeat(np.array(knots, float), multiplicities)


def _spline_curve(spline: Any, first: float, last: float, size: int) -> Spline:
    degree, count = spline.Degree(), spline.NbPoles()
    period = spline.LastParameter() - spline.FirstParameter() if spline.IsPeriodic() else 0.0
    if period:
        spline = spline.Copy()
        spline.Segment(spline.FirstParameter(), spline.LastParameter())
        count = spline.NbPoles()
    places = range(1, spline.NbKnots() + 1)
    knots = _flat([spline.Knot(i) for i in places], [spline.Multiplicity(i) for i in places])
    poles = np.array([_coordinates(spline.Pole(i), size) for i in range(1, count + 1)])
    weights = np.array([spline.Weight(i) for i in range(1, count + 1)]) if spline.IsRational() else None
    if period:
        knots, (poles, weights) = _unrolled(knots, degree, period, first, last, 0, poles, weights)
    return Spline((degree,), (knots,), poles, weights)


def _spline_surface(spline: Any, bounds: tuple[float, float, float, float]) -> Spline:
    period_u = spline.UPeriod() if spline.IsUPeriodic() else 0.0
    period_v = spline.VPeriod() if spline.IsVPeriodic() else 0.0
    if period_u or period_v:
        ends = spline.Bounds()
        spline = spline.Copy()
        spline.Segment(*ends)
    across, along = range(1, spline.NbUKnots() + 1), range(1, spline.NbVKnots() + 1)
    knots_u = _flat([spline.UKnot(i) for i in across], [spline.UMultiplicity(i) for i in across])
    knots_v = _flat([spline.VKnot(i) for i in along], [spline.VMultiplicity(i) for i in along])
    rows, columns = range(1, spline.NbUPoles() + 1), range(1, spline.NbVPoles() + 1)
    poles = np.array([[_xyz(spline.Pole(i, j)) for j in columns] for i in rows])
    weights = None
    if spline.IsURational() or spline.IsVRational():
        weights = np.array([[spline.Weight(i, j) for j in columns] for i in rows])
    degrees = spline.UDegree(), spline.VDegree()
    if period_u:
        knots_u, (poles, weights) = _unrolled(knots_u, degrees[0], period_u, *bounds[:2], 0, poles, weights)
    if period_v:
        knots_v, (poles, weights) = _unrolled(knots_v, degrees[1], period_v, *bounds[2:], 1, poles, weights)
    return Spline(degrees, (knots_u, knots_v), poles, weights)


def _unrolled(
    knots: Float, degree: int, period: float, first: float, last: float, axis: int, *arrays: Float | None
) -> tuple[Float, list[Any]]:
    """Repeat one period of a spline, whose ends have full multiplicity, until it covers a range."""
    begin, slack = float(knots[degree]), 1e-9 * period
    before = math.floor((first - begin + slack) / period)
    after = max(before + 1, math.ceil((last - begin - slack) / period))
    shifts = period * np.arange(before, after)
    inner = [knots[degree + 1 : -1] + shift for shift in shifts]
    repeats = [
        None if array is None else np.concatenate([array, *[np.delete(array, 0, axis)] * (len(shifts) - 1)], axis=axis)
        for array in arrays
    ]
    return np.concatenate([knots[: degree + 1] + shifts[0], *inner, knots[-1:] + shifts[-1]]), repeats
