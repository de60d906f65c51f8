"""Solids of cadquery and build123d, and shapes of OpenCASCADE's binding, are taken over as true shapes.

cadquery wants version 7 of the binding and build123d version 8, so that one environment has one of them at most.
"""

import math
from typing import Any

import numpy as np
import pytest

import inertia

pytest.importorskip("OCP", reason="OpenCASCADE's binding is not installed")

from OCP import BRep, BRepPrimAPI, TopAbs, TopExp, TopLoc, TopoDS, gp

from inertia.mesh.readers.opencascade.kernel import cast

BALL, HOLE = 10.0, 3.0
BEAD = 4 / 3 * math.pi * (BALL**2 - HOLE**2) ** 1.5  # a ball with a hole through its middle
BEAD_PER_VOLUME = 0.2 * (2 * BALL**2 + 3 * HOLE**2)  # about the axis of the hole: ∫r² dV / V


def ball(radius: float = BALL) -> Any:
    return BRepPrimAPI.BRepPrimAPI_MakeSphere(radius).Solid()


def is_bead(part: inertia.Part) -> None:
    properties = inertia.mass_properties(part, 1000.0)
    assert properties.volume == pytest.approx(BEAD * 1e-9, rel=1e-12)
    assert properties.inertia[2, 2] == pytest.approx(BEAD * BEAD_PER_VOLUME * 1e-12, rel=1e-12)
    assert part.shape is not None


def compound(*shapes: Any) -> Any:
    whole, builder = TopoDS.TopoDS_Compound(), BRep.BRep_Builder()
    builder.MakeCompound(whole)
    for shape in shapes:
        builder.Add(whole, shape)
    return whole


def place(x: float, angle: float = 0.0) -> Any:
    motion, turn = gp.gp_Trsf(), gp.gp_Trsf()
    motion.SetTranslation(gp.gp_Vec(x, 0, 0))
    turn.SetRotation(gp.gp_Ax1(gp.gp_Pnt(0, 0, 0), gp.gp_Dir(1, 0, 0)), angle)
    return TopLoc.TopLoc_Location(motion.Multiplied(turn))


def test_a_shape_of_the_kernel_is_a_true_shape() -> None:
    part = inertia.read(ball(), unit="in")
    assert part.source.format == "OCP"
    assert part.shape is not None
    volume = 4 / 3 * math.pi * (BALL * 0.0254) ** 3
    assert inertia.mass_properties(part).volume == pytest.approx(volume, rel=1e-14)
    assert inertia.read(ball()).unit_from == "assumed"
    assert any("triangles stand for curved faces" in note and " in off" in note for note in part.notes)


def test_shapes_are_where_their_places_put_them() -> None:
    cylinder = BRepPrimAPI.BRepPrimAPI_MakeCylinder(1.0, 4.0).Solid()
    part = inertia.read(compound(cylinder, cylinder.Moved(place(10.0, math.pi / 2)).Reversed().Reversed()), unit="m")
    properties = inertia.mass_properties(part, 1.0)
    assert properties.volume == pytest.approx(8 * math.pi, rel=1e-14)
    assert properties.center_of_mass == pytest.approx([5.0, -1.0, 1.0], rel=1e-13)


def test_the_triangles_that_a_shape_had_remain() -> None:
    from OCP import BRepMesh

    def triangles() -> int:
        walk = TopExp.TopExp_Explorer(shape, TopAbs.TopAbs_FACE)
        mesh = BRep.BRep_Tool.Triangulation_s(cast(walk.Current(), "Face"), TopLoc.TopLoc_Location())
        return 0 if mesh is None else int(mesh.NbTriangles())

    shape = ball()
    inertia.read(shape)
    assert triangles() == 0
    BRepMesh.BRepMesh_IncrementalMesh(shape, 3.0)
    few = triangles()
    assert inertia.read(shape).triangles.count > 2 * few > 0
    assert triangles() == few


def test_what_has_no_face_is_refused_and_wires_beside_faces_are_named() -> None:
    vertex = BRepPrimAPI.BRepPrimAPI_MakeBox(1, 1, 1).Solid()
    walk = TopExp.TopExp_Explorer(vertex, TopAbs.TopAbs_EDGE)
    with pytest.raises(inertia.UsageError, match="this TopoDS_Edge has no solid and no face"):
        inertia.read(cast(walk.Current(), "Edge"))
    for nothing in (compound(), TopoDS.TopoDS_Shape(), gp.gp_Pnt(0, 0, 0)):
        with pytest.raises(inertia.UsageError, match="has no solid and no face"):
            inertia.read(nothing)
    assert "1 piece of wire was left out" in inertia.read(compound(ball(), walk.Current())).notes


def test_cadquery() -> None:
    cq = pytest.importorskip("cadquery", reason="cadquery is not installed", exc_type=ImportError)
    bead = cq.Workplane().sphere(BALL).cut(cq.Workplane().cylinder(3 * BALL, HOLE))
    for model in (bead, bead.val(), bead.val().wrapped):
        is_bead(inertia.read(model, unit="mm"))
    gadget = cq.Assembly(name="gadget", loc=cq.Location((0, 0, 100)), color=cq.Color(1, 0, 0))
    gadget.add(cq.Workplane().box(1, 2, 3), name="box", loc=cq.Location((10, 0, 0)), color=cq.Color(0, 0, 1))
    gadget.add(cq.Workplane().circle(1).extrude(4), name="rod", loc=cq.Location((0, 0, 0), (1, 0, 0), 90))
    part = inertia.read(gadget, unit="mm")
    is_gadget(part, [(0, 0, 1), (1, 0, 0)])
    with pytest.raises(inertia.UsageError, match="this Workplane has no solid and no face"):
        inertia.read(cq.Workplane().rect(1, 2))


def test_build123d() -> None:
    b = pytest.importorskip("build123d", reason="build123d is not installed", exc_type=ImportError)
    with b.BuildPart() as builder:
        b.Sphere(BALL)
        b.Cylinder(HOLE, 3 * BALL, mode=b.Mode.SUBTRACT)
    for model in (builder, builder.part, builder.part.solids(), builder.part.wrapped):
        is_bead(inertia.read(model, unit="mm"))
    box = b.Box(1, 2, 3).moved(b.Location((10, 0, 0)))
    rod = b.Cylinder(1, 4).moved(b.Location((0, -2, 0), (90, 0, 0)))
    box.label, rod.label, box.color = "box", "rod", b.Color(0, 0, 1)
    gadget = b.Compound(label="gadget", children=[box, rod])
    gadget.color, gadget.location = b.Color(1, 0, 0), b.Location((0, 0, 100))
    part = inertia.read(gadget, unit="mm")
    is_gadget(part, [(0, 0, 1), (1, 0, 0)])
    for nothing in (b.Line((0, 0), (1, 1)), b.Compound(), b.BuildPart(), b.Vector(1, 2, 3)):
        with pytest.raises(inertia.UsageError, match="has no solid and no face"):
            inertia.read(nothing)


def is_gadget(part: inertia.Part, colours: list[tuple[float, float, float]]) -> None:
    """A box of 6 mm³ at x = 10 mm and a rod of 4π mm³ along −y, each by its name, 100 mm up."""
    assert part.shape is not None
    assert [(solid.name, solid.path) for solid in part.shape.solids] == [("box", ("gadget",)), ("rod", ("gadget",))]
    assert [solid.colour for solid in part.shape.solids] == colours
    properties = inertia.mass_properties(part, {"box": 1000.0, "rod": 2000.0})
    box, rod = 6e-6, 8e-6 * math.pi
    assert properties.mass == pytest.approx(box + rod, rel=1e-13)
    center = np.array([10e-3 * box, -2e-3 * rod, 0.1 * (box + rod)]) / (box + rod)
    assert properties.center_of_mass == pytest.approx(center, rel=1e-12)
