"""Solids made by OpenCASCADE, as STEP files; points of curves and surfaces by the formulas of `inertia.mesh.shape`."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from inertia.arrays import Float
from inertia.mesh.shape import Curve, Patch, Spline

OCP = pytest.importorskip("OCP")

from OCP import (  # noqa: E402
    BRep,
    BRepAlgoAPI,
    BRepBuilderAPI,
    BRepFilletAPI,
    BRepOffsetAPI,
    BRepPrimAPI,
    Geom,
    GeomAPI,
    Interface,
    Quantity,
    STEPCAFControl,
    STEPControl,
    TCollection,
    TDataStd,
    TDocStd,
    TopAbs,
    TopExp,
    TopLoc,
    TopoDS,
    XCAFDoc,
    gp,
)

from inertia.mesh.readers.opencascade.kernel import cast, collection, shape_map  # noqa: E402

Shape = Any
Z = gp.gp_Dir(0, 0, 1)


def explored(shape: Shape, kind: str) -> list[Shape]:
    """Return the faces or edges of a shape, each as often as it is used."""
    walk, parts = TopExp.TopExp_Explorer(shape, getattr(TopAbs, f"TopAbs_{kind.upper()}")), []
    while walk.More():
        parts.append(cast(walk.Current(), kind))
        walk.Next()
    return parts


def axes(x: float, y: float, z: float, direction: Any = Z) -> Any:
    return gp.gp_Ax2(gp.gp_Pnt(x, y, z), direction)


def box(a: float, b: float, c: float) -> Shape:
    return BRepPrimAPI.BRepPrimAPI_MakeBox(a, b, c).Shape()


def cylinder(radius: float, height: float, at: Any = None) -> Shape:
    return BRepPrimAPI.BRepPrimAPI_MakeCylinder(at or axes(0, 0, 0), radius, height).Shape()


def moved(shape: Shape, x: float, y: float, z: float) -> Shape:
    shift = gp.gp_Trsf()
    shift.SetTranslation(gp.gp_Vec(x, y, z))
    return BRepBuilderAPI.BRepBuilderAPI_Transform(shape, shift, True).Shape()


def rounded(shape: Shape, radius: float) -> Shape:
    """Return a solid with all its edges filleted."""
    fillet, known = BRepFilletAPI.BRepFilletAPI_MakeFillet(shape), shape_map()
    for edge in explored(shape, "Edge"):
        if not known.Contains(edge):
            known.Add(edge)
            fillet.Add(radius, edge)
    return fillet.Shape()


def drilled_ball() -> Shape:
    ball = BRepPrimAPI.BRepPrimAPI_MakeSphere(10.0).Shape()
    return BRepAlgoAPI.BRepAlgoAPI_Cut(ball, cylinder(3, 50, axes(4, 0, -25))).Shape()


def tee() -> Shape:
    """Two cylinders that meet obliquely."""
    across = cylinder(3, 20, axes(0, 0, 0, gp.gp_Dir(1, 0.2, 0.1)))
    return BRepAlgoAPI.BRepAlgoAPI_Fuse(cylinder(5, 40, axes(0, 0, -20)), across).Shape()


def spline(points: list[tuple[float, float, float]], periodic: bool) -> Any:
    given = collection("HArray1_gp_Pnt", "TColgp", "TColgp_HArray1OfPnt", 1, len(points))
    for place, point in enumerate(points, 1):
        given.SetValue(place, gp.gp_Pnt(*point))
    through = GeomAPI.GeomAPI_Interpolate(given, periodic, 1e-9)
    through.Perform()
    return BRepBuilderAPI.BRepBuilderAPI_MakeEdge(through.Curve()).Edge()


def ring(radius: float, z: float) -> Shape:
    """A closed wire, one periodic spline."""
    angles = 2 * np.pi * np.arange(8) / 8
    reach = radius + 2 * np.cos(3 * angles)
    points = [(float(r * np.cos(a)), float(r * np.sin(a)), z) for r, a in zip(reach, angles, strict=True)]
    return BRepBuilderAPI.BRepBuilderAPI_MakeWire(spline(points, True)).Wire()


def loft(solid: bool = True) -> Shape:
    sections = BRepOffsetAPI.BRepOffsetAPI_ThruSections(solid, False)
    for radius, z in ((10, 0), (8, 10), (12, 25)):
        sections.AddWire(ring(radius, z))
    return sections.Shape()


def hollow() -> Shape:
    """A loft of one thickness, whose inner side is an offset surface."""
    body, opening = loft(), collection("List_TopoDS_Shape", "TopTools", "TopTools_ListOfShape")
    opening.Append(explored(body, "Face")[-1])
    maker = BRepOffsetAPI.BRepOffsetAPI_MakeThickSolid()
    maker.MakeThickSolidByJoin(body, opening, 0.5, 1e-3)
    return maker.Shape()


def prism() -> Shape:
    face = BRepBuilderAPI.BRepBuilderAPI_MakeFace(ring(10, 0)).Face()
    return BRepPrimAPI.BRepPrimAPI_MakePrism(face, gp.gp_Vec(3, 1, 12)).Shape()


def conic_prism(kind: str) -> Shape:
    """A prism over half of an ellipse, or a piece of a parabola or hyperbola."""
    at = axes(1, 2, 0)
    conic = {
        "ellipse": lambda: Geom.Geom_Ellipse(at, 5.0, 3.0),
        "parabola": lambda: Geom.Geom_Parabola(at, 2.0),
        "hyperbola": lambda: Geom.Geom_Hyperbola(at, 4.0, 3.0),
    }[kind]()
    first, last = (0.0, math.pi) if kind == "ellipse" else (-1.0, 1.5)
    arc = BRepBuilderAPI.BRepBuilderAPI_MakeEdge(conic, first, last).Edge()
    chord = BRepBuilderAPI.BRepBuilderAPI_MakeEdge(conic.Value(last), conic.Value(first)).Edge()
    face = BRepBuilderAPI.BRepBuilderAPI_MakeFace(BRepBuilderAPI.BRepBuilderAPI_MakeWire(arc, chord).Wire()).Face()
    return BRepPrimAPI.BRepPrimAPI_MakePrism(face, gp.gp_Vec(0, 0, 7)).Shape()


def turned(angle: float = 2 * math.pi) -> Shape:
    curve = spline([(5, 0, 0), (8, 0, 3), (6, 0, 6), (9, 0, 9), (5, 0, 12)], False)
    inner = BRepBuilderAPI.BRepBuilderAPI_MakeEdge(gp.gp_Pnt(5, 0, 12), gp.gp_Pnt(5, 0, 0)).Edge()
    face = BRepBuilderAPI.BRepBuilderAPI_MakeFace(BRepBuilderAPI.BRepBuilderAPI_MakeWire(curve, inner).Wire()).Face()
    return BRepPrimAPI.BRepPrimAPI_MakeRevol(face, gp.gp_Ax1(gp.gp_Pnt(0, 0, 0), Z), angle).Shape()


def as_nurbs(shape: Shape) -> Shape:
    return BRepBuilderAPI.BRepBuilderAPI_NurbsConvert(shape, True).Shape()


SOLIDS: dict[str, Callable[[], Shape]] = {
    "rounded box": lambda: rounded(box(10, 20, 30), 2),
    "frustum": lambda: BRepPrimAPI.BRepPrimAPI_MakeCone(9.0, 2.0, 5.0).Shape(),
    "cone": lambda: BRepPrimAPI.BRepPrimAPI_MakeCone(0.0, 9.0, 5.0).Shape(),
    "ball": lambda: BRepPrimAPI.BRepPrimAPI_MakeSphere(10.0).Shape(),
    "piece of a ball": lambda: BRepPrimAPI.BRepPrimAPI_MakeSphere(axes(0, 0, 0), 10.0, -0.5, 0.7, 2.0).Shape(),
    "piece of a torus": lambda: BRepPrimAPI.BRepPrimAPI_MakeTorus(axes(0, 0, 0), 10.0, 3.0, -0.5, 1.7, 2.0).Shape(),
    "drilled ball": drilled_ball,
    "tee": tee,
    "loft": loft,
    "hollow": hollow,
    "prism": prism,
    "half ellipse": lambda: conic_prism("ellipse"),
    "parabola": lambda: conic_prism("parabola"),
    "hyperbola": lambda: conic_prism("hyperbola"),
    "turned": turned,
    "turned in part": lambda: turned(2.0),
    "rational": lambda: as_nurbs(moved(BRepPrimAPI.BRepPrimAPI_MakeSphere(4.0).Shape(), 1, 2, 3)),
    "rational box": lambda: as_nurbs(rounded(box(10, 20, 30), 2)),
}


def bezier(points: list[list[tuple[float, float, float]]]) -> Any:
    """Return a Bézier surface through corners, and near the rest, of a square of points."""
    rows = collection("Array2_gp_Pnt", "TColgp", "TColgp_Array2OfPnt", 1, len(points), 1, len(points[0]))
    for i, row in enumerate(points, 1):
        for j, point in enumerate(row, 1):
            rows.SetValue(i, j, gp.gp_Pnt(*point))
    return Geom.Geom_BezierSurface(rows)


def unbounded(surface: Any) -> Shape:
    """Return a face of all of a surface, without a loop."""
    face = TopoDS.TopoDS_Face()
    BRep.BRep_Builder().MakeFace(face, surface, 1e-7)
    return face


def together(shapes: list[Shape]) -> Shape:
    """Return several shapes as one."""
    compound, builder = TopoDS.TopoDS_Compound(), BRep.BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def write_step(shape: Shape, path: Path, unit: str = "MM") -> None:
    """Write a shape, whose lengths are millimetres, in another unit."""
    writer = STEPControl.STEPControl_Writer()
    Interface.Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, STEPControl.STEPControl_AsIs)
    writer.Write(str(path))
    Interface.Interface_Static.SetCVal_s("write.step.unit", "MM")


def write_assembly(path: Path) -> None:
    """Write two plates with four bolts each, one of them red, and a product of two solids and an edge."""
    document = TDocStd.TDocStd_Document(_extended("XmlXCAF"))
    shapes = XCAFDoc.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc.XCAFDoc_DocumentTool.ColorTool_s(document.Main())

    def product(name: str, shape: Shape = None) -> Any:
        label = shapes.NewShape() if shape is None else shapes.AddShape(shape, False)
        TDataStd.TDataStd_Name.Set_s(label, _extended(name))
        return label

    def place(above: Any, label: Any, x: float, y: float, z: float, angle: float = 0.0) -> Any:
        motion = gp.gp_Trsf()
        motion.SetRotation(gp.gp_Ax1(gp.gp_Pnt(0, 0, 0), gp.gp_Dir(1, 1, 0)), angle)
        motion.SetTranslationPart(gp.gp_Vec(x, y, z))
        return shapes.AddComponent(above, label, TopLoc.TopLoc_Location(motion))

    def paint(label: Any, red: float, green: float, blue: float) -> None:
        colour = Quantity.Quantity_Color(red, green, blue, Quantity.Quantity_TOC_sRGB)
        colours.SetColor(label, colour, XCAFDoc.XCAFDoc_ColorSurf)

    bolt, plate = product("bolt", cylinder(3, 20)), product("plate", box(50, 50, 5))
    paint(bolt, 0.5, 0.25, 0.125)
    bolted, whole = product("bolted plate"), product("machine")
    for number in range(4):
        one = place(bolted, bolt, 10 + 30 * (number % 2), 10 + 30 * (number // 2), 6)
        if number == 2:
            paint(one, 1.0, 0.0, 0.0)
    place(bolted, plate, 0, 0, 0)
    place(whole, bolted, 0, 0, 0)
    place(whole, bolted, 100, 0, 0, 1.0)
    wire = BRepBuilderAPI.BRepBuilderAPI_MakeEdge(gp.gp_Pnt(0, 0, 0), gp.gp_Pnt(1, 0, 0)).Edge()
    place(whole, product("pair", together([box(1, 2, 3), moved(cylinder(2, 2), 20, 0, 0), wire])), 0, 200, 0)
    shapes.UpdateAssemblies()
    writer = STEPCAFControl.STEPCAFControl_Writer()
    writer.Transfer(document, STEPControl.STEPControl_AsIs)
    writer.Write(str(path))


def _extended(text: str) -> Any:
    return TCollection.TCollection_ExtendedString(text)


def spline_point(spline: Spline, *at: float) -> Float:
    """Return a point of a spline, by de Boor's algorithm."""
    points = spline.poles
    if spline.weights is not None:
        points = np.concatenate([points * spline.weights[..., None], spline.weights[..., None]], axis=-1)
    for degree, knots, t in zip(spline.degrees, spline.knots, at, strict=True):
        span = int(np.clip(np.searchsorted(knots, t, "right") - 1, degree, len(knots) - degree - 2))
        row = list(points[span - degree : span + 1])
        for r in range(1, degree + 1):
            for j in range(degree, r - 1, -1):
                low = knots[j + span - degree]
                share = (t - low) / (knots[j + 1 + span - r] - low)
                row[j] = (1 - share) * row[j - 1] + share * row[j]
        points = row[degree]
    return points if spline.weights is None else points[:-1] / points[-1]


def curve_point(curve: Curve, t: float) -> Float:
    (o, x, y), (a, b) = curve.frame, (*curve.sizes, 0.0, 0.0)[:2]
    if curve.kind == "spline":
        assert curve.spline is not None
        return spline_point(curve.spline, t)
    along, across = {
        "line": lambda: (t, 0.0),
        "ellipse": lambda: (a * math.cos(t), b * math.sin(t)),
        "parabola": lambda: (t * t / (4 * a), t),
        "hyperbola": lambda: (a * math.cosh(t), b * math.sinh(t)),
    }[curve.kind]()
    return np.asarray(o + along * x + across * y)


def patch_point(patch: Patch, u: float, v: float) -> Float:
    (o, x, y, z), (a, b) = patch.frame, (*patch.sizes, 0.0, 0.0)[:2]
    radial = math.cos(u) * x + math.sin(u) * y
    if patch.kind == "spline":
        assert patch.spline is not None
        return spline_point(patch.spline, u, v)
    if patch.kind == "offset":
        assert patch.basis is not None
        step = 1e-5
        du, dv = (
            patch_point(patch.basis, u + p, v + q) - patch_point(patch.basis, u - p, v - q)
            for p, q in ((step, 0.0), (0.0, step))
        )
        normal = np.cross(du, dv)
        return patch_point(patch.basis, u, v) + a * normal / np.linalg.norm(normal)
    if patch.kind == "extrusion":
        assert patch.profile is not None
        return curve_point(patch.profile[0], u) + v * z
    if patch.kind == "revolution":
        assert patch.profile is not None
        away = curve_point(patch.profile[0], v) - o
        along = (away @ z) * z
        return np.asarray(o + along + math.cos(u) * (away - along) + math.sin(u) * np.cross(z, away))
    return np.asarray(
        {
            "plane": lambda: o + u * x + v * y,
            "cylinder": lambda: o + a * radial + v * z,
            "cone": lambda: o + (a + v * math.sin(b)) * radial + v * math.cos(b) * z,
            "sphere": lambda: o + a * math.cos(v) * radial + a * math.sin(v) * z,
            "torus": lambda: o + (a + b * math.cos(v)) * radial + b * math.sin(v) * z,
        }[patch.kind]()
    )
