"""Solids made by OpenCASCADE, and taken over as plain data without a file."""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from OCP import (
    BRepAlgoAPI,
    BRepBuilderAPI,
    BRepFilletAPI,
    BRepGProp,
    BRepMesh,
    BRepOffsetAPI,
    BRepPrimAPI,
    GeomAPI,
    GProp,
    TopAbs,
    TopExp,
    gp,
)

from inertia.mesh.readers.opencascade.kernel import bounds_something, cast, collection, shape_map
from inertia.mesh.readers.opencascade.surfaces import Edges, face_data
from inertia.mesh.shape import Shape, Solid

Point = Sequence[float]


def pieces(shape: Any, kind: str) -> Iterator[Any]:
    """The solids, faces or edges of a shape."""
    walk = TopExp.TopExp_Explorer(shape, getattr(TopAbs, f"TopAbs_{kind.upper()}"))
    while walk.More():
        yield cast(walk.Current(), kind)
        walk.Next()


def taken_over(shape: Any) -> Shape:
    """The solids of a shape, each by itself."""
    solids, tolerances = [], []
    for solid in pieces(shape, "Solid"):
        edges = Edges(len(tolerances), shape_map())
        faces = [
            face_data(face, edges, k + 1) for k, face in enumerate(pieces(solid, "Face")) if bounds_something(face)
        ]
        tolerances += edges.tolerances
        solids.append(Solid(str(len(solids) + 1), tuple(faces), np.eye(3, 4), True))
    return Shape(tuple(solids), np.array(tolerances))


def gprops(shape: Any) -> float:
    """The volume by OpenCASCADE's usual quadrature."""
    properties = GProp.GProp_GProps()
    BRepGProp.BRepGProp.VolumeProperties_s(shape, properties)
    return float(properties.Mass())


def gauss_kronrod(shape: Any, relative: float) -> float:
    """The volume by OpenCASCADE's adaptive quadrature; on splines it may take minutes."""
    properties = GProp.GProp_GProps()
    BRepGProp.BRepGProp.VolumePropertiesGK_s(shape, properties, relative, False, False, True, True, False)
    return float(properties.Mass())


def meshed(shape: Any, sag: float = 0.001, angle: float = 0.05) -> Any:
    """A copy with triangles, as the reader of STEP asks for them: sag relative to an edge, angle in rad."""
    copy = BRepBuilderAPI.BRepBuilderAPI_Copy(shape).Shape()
    BRepMesh.BRepMesh_IncrementalMesh(copy, sag, True, angle, False)
    return copy


def facets(shape: Any) -> float:
    """The volume of the triangles of a shape that has them."""
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    volume = 0.0
    for face in pieces(shape, "Face"):
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, place)
        way = place.Transformation()
        nodes = np.array([xyz(mesh.Node(k).Transformed(way)) for k in range(1, mesh.NbNodes() + 1)])
        corners = np.array([mesh.Triangle(k).Get() for k in range(1, mesh.NbTriangles() + 1)]) - 1
        a, b, c = (nodes[corners[:, k]] for k in range(3))
        sign = -1.0 if face.Orientation() == TopAbs.TopAbs_REVERSED else 1.0
        volume += sign * float((a * np.cross(b, c)).sum()) / 6.0
    return volume


def xyz(point: Any) -> list[float]:
    return [point.X(), point.Y(), point.Z()]


def axes(at: Point = (0, 0, 0), along: Point = (0, 0, 1)) -> Any:
    return gp.gp_Ax2(gp.gp_Pnt(*at), gp.gp_Dir(*along))


def box(size: Point, at: Point = (0, 0, 0)) -> Any:
    return BRepPrimAPI.BRepPrimAPI_MakeBox(gp.gp_Pnt(*at), *size).Solid()


def cylinder(radius: float, height: float, at: Point = (0, 0, 0), along: Point = (0, 0, 1)) -> Any:
    return BRepPrimAPI.BRepPrimAPI_MakeCylinder(axes(at, along), radius, height).Solid()


def cone(low: float, high: float, height: float, at: Point = (0, 0, 0), along: Point = (0, 0, 1)) -> Any:
    return BRepPrimAPI.BRepPrimAPI_MakeCone(axes(at, along), low, high, height).Solid()


def sphere(radius: float, at: Point = (0, 0, 0)) -> Any:
    return BRepPrimAPI.BRepPrimAPI_MakeSphere(gp.gp_Pnt(*at), radius).Solid()


def torus(major: float, minor: float, at: Point = (0, 0, 0), along: Point = (0, 0, 1)) -> Any:
    return BRepPrimAPI.BRepPrimAPI_MakeTorus(axes(at, along), major, minor).Solid()


def moved(shape: Any, shift: Point, along: Point = (0, 0, 1), angle: float = 0.0) -> Any:
    """Turned about an axis through the origin, and moved."""
    turn, way = gp.gp_Trsf(), gp.gp_Trsf()
    turn.SetRotation(gp.gp_Ax1(gp.gp_Pnt(0, 0, 0), gp.gp_Dir(*along)), angle)
    way.SetTranslation(gp.gp_Vec(*shift))
    return BRepBuilderAPI.BRepBuilderAPI_Transform(shape, way.Multiplied(turn), True).Shape()


def fused(a: Any, b: Any) -> Any:
    return BRepAlgoAPI.BRepAlgoAPI_Fuse(a, b).Shape()


def common(a: Any, b: Any) -> Any:
    return BRepAlgoAPI.BRepAlgoAPI_Common(a, b).Shape()


def cut(a: Any, b: Any) -> Any:
    return BRepAlgoAPI.BRepAlgoAPI_Cut(a, b).Shape()


def filleted(shape: Any, radius: float) -> Any:
    """All edges rounded."""
    maker = BRepFilletAPI.BRepFilletAPI_MakeFillet(shape)
    for edge in pieces(shape, "Edge"):
        maker.Add(radius, edge)
    return maker.Shape()


def chamfered(shape: Any, width: float) -> Any:
    maker = BRepFilletAPI.BRepFilletAPI_MakeChamfer(shape)
    for edge in pieces(shape, "Edge"):
        maker.Add(width, edge)
    return maker.Shape()


def ring(radius: float, z: float, x: float = 0.0) -> Any:
    edge = BRepBuilderAPI.BRepBuilderAPI_MakeEdge(gp.gp_Circ(axes((x, 0, z)), radius)).Edge()
    return BRepBuilderAPI.BRepBuilderAPI_MakeWire(edge).Wire()


def polygon(points: Iterable[Point]) -> Any:
    maker = BRepBuilderAPI.BRepBuilderAPI_MakePolygon()
    for point in points:
        maker.Add(gp.gp_Pnt(*point))
    maker.Close()
    return maker.Wire()


def closed_spline(points: Sequence[Point]) -> Any:
    """A wire of one periodic cubic spline through points."""
    through = collection("HArray1_gp_Pnt", "TColgp", "TColgp_HArray1OfPnt", 1, len(points))
    for k, point in enumerate(points, 1):
        through.SetValue(k, gp.gp_Pnt(*point))
    maker = GeomAPI.GeomAPI_Interpolate(through, True, 1e-9)
    maker.Perform()
    edge = BRepBuilderAPI.BRepBuilderAPI_MakeEdge(maker.Curve()).Edge()
    return BRepBuilderAPI.BRepBuilderAPI_MakeWire(edge).Wire()


def wavy(waves: int, depth: float, radius: float = 2.0, points: int = 40) -> Any:
    """A closed wave about a circle, in the plane z = 0."""
    angles = np.linspace(0, 2 * math.pi, points, endpoint=False)
    radii = radius + depth * np.cos(waves * angles)
    return closed_spline(np.column_stack([radii * np.cos(angles), radii * np.sin(angles), 0 * angles]).tolist())


def plane_face(wire: Any) -> Any:
    return BRepBuilderAPI.BRepBuilderAPI_MakeFace(wire).Face()


def extruded(wire: Any, along: Point) -> Any:
    return BRepPrimAPI.BRepPrimAPI_MakePrism(plane_face(wire), gp.gp_Vec(*along)).Shape()


def revolved(wire: Any, at: Point, along: Point, angle: float = 2 * math.pi) -> Any:
    axis = gp.gp_Ax1(gp.gp_Pnt(*at), gp.gp_Dir(*along))
    return BRepPrimAPI.BRepPrimAPI_MakeRevol(plane_face(wire), axis, angle).Shape()


def lofted(wires: Iterable[Any], ruled: bool = False) -> Any:
    maker = BRepOffsetAPI.BRepOffsetAPI_ThruSections(True, ruled, 1e-6)
    for wire in wires:
        maker.AddWire(wire)
    maker.Build()
    return maker.Shape()


def shelled(shape: Any, face: int, thickness: float) -> Any:
    """Hollowed to a wall, one face taken off."""
    open_faces = collection("List_TopoDS_Shape", "TopTools", "TopTools_ListOfShape")
    open_faces.Append(list(pieces(shape, "Face"))[face])
    maker = BRepOffsetAPI.BRepOffsetAPI_MakeThickSolid()
    maker.MakeThickSolidByJoin(shape, open_faces, -thickness, 1e-4)
    return maker.Shape()


def nurbs(shape: Any) -> Any:
    """All faces as rational splines."""
    return BRepBuilderAPI.BRepBuilderAPI_NurbsConvert(shape, True).Shape()
