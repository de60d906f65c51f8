"""STEP: the true shape is the kernel's own, face by face and edge by edge, and its triangles close."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.kernel_solids import (
    SOLIDS,
    axes,
    bezier,
    box,
    cast,
    curve_point,
    explored,
    loft,
    moved,
    patch_point,
    together,
    unbounded,
    write_assembly,
    write_step,
)
from tests.mesh.readers.samples import CORNERS, QUADS
from tests.mesh.readers.step_sample import step_cone, step_of_several, step_placed, step_solid, step_sphere

import inertia
from inertia.errors import ReadError, UsageError
from inertia.mesh.part import Part
from inertia.mesh.shape import Shape

pytest.importorskip("OCP")

from OCP import BRep, BRepAdaptor, BRepBuilderAPI, BRepTools, Geom, Poly, STEPControl, TopAbs, TopoDS, gp

from inertia.mesh.readers.opencascade.kernel import shape_map
from inertia.mesh.readers.opencascade.surfaces import Edges, face_data

UNITS = {"MM": ("mm", 1.0), "M": ("m", 1e-3), "INCH": ("in", 1 / 25.4)}


def shape_of(part: Part) -> Shape:
    assert part.shape is not None
    return part.shape


@pytest.fixture(scope="module", params=UNITS)
def solids(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Part, str, float]:
    path = tmp_path_factory.mktemp("solids") / "solids.step"
    made = [moved(make(), 100.0 * place, 0, 0) for place, make in enumerate(SOLIDS.values())]
    write_step(together(made), path, request.param)
    return inertia.read(path, coarser=4.0), *UNITS[request.param]


def test_every_kind_of_face_and_curve_is_the_kernels(solids: tuple[Part, str, float]) -> None:
    part, unit, scale = solids
    assert (part.unit.name, part.unit_from) == (unit, "file")
    shape = shape_of(part)
    assert len(shape.solids) == len(SOLIDS)
    assert all(solid.closed for solid in shape.solids)
    faces = [face for solid in shape.solids for face in solid.faces]
    assert [face.number for face in faces] == list(range(1, len(faces) + 1))
    assert {face.patch.kind for face in faces} == {
        "plane", "cylinder", "cone", "sphere", "torus", "extrusion", "revolution", "offset", "spline",
    }  # fmt: skip
    curves = [trim.curve for face in faces for loop in face.loops for trim in loop]
    curves += [face.patch.profile[0] for face in faces if face.patch.profile is not None]
    assert {curve.kind for curve in curves} == {"line", "ellipse", "parabola", "hyperbola", "spline"}

    reader = STEPControl.STEPControl_Reader()
    reader.ReadFile(part.source.path)
    reader.TransferRoots()
    theirs = explored(reader.OneShape(), "Face")
    size = 100.0 * len(SOLIDS) * scale
    for ours, face in zip(faces, theirs, strict=True):
        assert ours.inward == (face.Orientation() == TopAbs.TopAbs_REVERSED)
        forward = cast(face.Oriented(TopAbs.TopAbs_FORWARD), "Face")
        surface = BRepAdaptor.BRepAdaptor_Surface(forward, False)
        trims = [trim for loop in ours.loops for trim in loop]
        mine = [
            patch_point(ours.patch, *curve_point(trim.curve, t))
            for trim in trims
            for t in np.linspace(trim.start, trim.stop, 5).tolist()
        ]
        near = 1e-9 if ours.patch.kind == "offset" else 1e-15  # its normal is taken by differences here
        bounds = np.array(BRepTools.BRepTools.UVBounds_s(face))
        lengths = {"plane": (scale, scale), "cylinder": (1, scale), "cone": (1, scale), "extrusion": (1, scale)}
        stretch = lengths.get(ours.patch.kind, (1, 1))
        if ours.patch.kind == "extrusion":  # the parameter of a parabola is a length, in whatever unit
            assert ours.patch.profile is not None
            _, first, last = ours.patch.profile
            stretch = ((last - first) / (bounds[1] - bounds[0]), scale)
        for u in np.linspace(bounds[0], bounds[1], 5)[1:-1]:
            for v in np.linspace(bounds[2], bounds[3], 5)[1:-1]:
                point = surface.Value(u, v)
                there = scale * np.array([point.X(), point.Y(), point.Z()])
                assert np.abs(patch_point(ours.patch, u * stretch[0], v * stretch[1]) - there).max() <= near * size
        points = scale * np.array([[point.X(), point.Y(), point.Z()] for point in _edge_points(forward)])
        assert len(points) == len(mine)
        apart = np.linalg.norm(points[:, None] - np.array(mine), axis=2)
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) <= max(near, 1e-14) * size


def _edge_points(face: object) -> list[object]:
    points = []
    surface = BRepAdaptor.BRepAdaptor_Surface(face, False)
    for edge in explored(face, "Edge"):
        curve = BRepAdaptor.BRepAdaptor_Curve2d(edge, face)
        for t in np.linspace(curve.FirstParameter(), curve.LastParameter(), 5):
            at = curve.Value(t)
            points.append(surface.Value(at.X(), at.Y()))
    return points


def test_faces_meet_at_their_edges_and_triangles_close(solids: tuple[Part, str, float]) -> None:
    part, _, scale = solids
    shape, size = shape_of(part), 30 * scale
    sides = defaultdict(list)
    for solid in shape.solids:
        for face in solid.faces:
            for loop in face.loops:
                for trim, after in zip(loop, (*loop[1:], loop[0]), strict=True):
                    end, start = curve_point(trim.curve, trim.stop), curve_point(after.curve, after.start)
                    assert np.abs(patch_point(face.patch, *end) - patch_point(face.patch, *start)).max() < 1e-5 * size
                    low, high = sorted((trim.start, trim.stop))
                    places = np.linspace(low, high, 7)
                    points = [patch_point(face.patch, *curve_point(trim.curve, t)) for t in places]
                    sides[trim.edge].append((trim.start < trim.stop) != face.inward)
                    sides[trim.edge, "points"].append(np.array(points))
    assert len(shape.tolerances) == sum(isinstance(key, int) for key in sides)
    for edge, tolerance in enumerate(shape.tolerances):
        points = sides[edge, "points"]
        if len(points) == 1:
            assert np.ptp(points[0], axis=0).max() < 1e-9 * size
        else:
            assert sorted(sides[edge]) == [False, True]
            assert np.linalg.norm(points[0] - points[1], axis=1).max() <= 10 * tolerance
    report = inertia.check(part)
    assert [finding.code for finding in report.findings] == ["several_bodies"]


def test_the_tree_gives_names_colours_and_places(tmp_path: Path) -> None:
    write_assembly(tmp_path / "machine.step")
    part = inertia.read(tmp_path / "machine.step", coarser=4.0)
    solids = shape_of(part).solids
    assert [solid.name for solid in solids] == [*["bolt"] * 4, "plate", *["bolt"] * 4, "plate", *["pair"] * 2]
    assert [solid.path for solid in solids] == [("machine", "bolted plate")] * 10 + [("machine",)] * 2
    red, brown = (1.0, 0.0, 0.0), (0.5, 0.25, 0.125)
    assert [solid.colour for solid in solids] == [brown, brown, red, brown, None] * 2 + [None] * 2
    assert len({id(solid.faces) for solid in solids}) == 4
    assert all(solid.closed for solid in solids)
    assert part.regions is not None
    assert part.regions.names == ("bolt", "plate", "pair")
    assert "1 piece of wire was left out" in part.notes
    whole = inertia.mass_properties(part, 1.0)
    true = 8 * math.pi * 9 * 20 + 2 * 50 * 50 * 5 + 6 + math.pi * 8
    assert whole.volume * 1e9 == pytest.approx(true, rel=2e-3)
    for solid in solids:
        assert np.allclose(solid.placement[:, :3] @ solid.placement[:, :3].T, np.eye(3), atol=1e-15)
    centre = sum(
        np.append(solid.placement[:, :3] @ at + solid.placement[:, 3], 1.0) * volume
        for solid, (volume, at) in zip(solids, VOLUMES, strict=True)
    )
    assert np.allclose(whole.center_of_mass * 1e3, centre[:3] / centre[3], atol=1e-2)


BOLT, PLATE = (math.pi * 9 * 20, (0, 0, 10)), (50 * 50 * 5, (25, 25, 2.5))
VOLUMES = [*([BOLT] * 4 + [PLATE]) * 2, (6, (0.5, 1, 1.5)), (8 * math.pi, (20, 0, 1))]


@pytest.mark.parametrize("made", ["shell", "faces"])
def test_faces_that_bound_no_solid_are_open_surfaces(made: str, tmp_path: Path) -> None:
    sides = explored(box(1, 2, 3), "Face")[:2]
    write_step(loft(solid=False) if made == "shell" else together(sides), tmp_path / "open.step")
    part = inertia.read(tmp_path / "open.step", coarser=4.0)
    assert not any(solid.closed for solid in shape_of(part).solids)
    assert [finding.code for finding in inertia.check(part).findings] == ["open"]


@pytest.mark.parametrize(
    ("scale", "axis", "message"),
    [(1.0, 1, None), (2.5, 1, "scales by 2.5 a shape that it places"), (1.0, -1, "mirrors a shape that it places")],
)
def test_a_shape_is_placed_without_scale_or_refused(
    scale: float, axis: int, message: str | None, tmp_path: Path
) -> None:
    path = tmp_path / "part.step"
    path.write_text(step_placed(step_cone(2.0, 9.0, 5.0), scale, axis))
    if message is not None:
        with pytest.raises(ReadError, match=message):
            inertia.read(path)
        return
    (solid,) = shape_of(inertia.read(path, coarser=8.0)).solids
    assert solid.placement.tolist() == [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]]
    assert (solid.name, len(solid.faces)) == ("Frustum", 3)


def test_what_the_kernel_leaves_out_is_said(tmp_path: Path) -> None:
    text = step_cone(2.0, 9.0, 5.0).replace("CONICAL_SURFACE", "COMICAL_SURFACE")
    (tmp_path / "part.step").write_text(text)
    part = inertia.read(tmp_path / "part.step")
    assert "OpenCASCADE left out what has a fault (1 fault, first 'Surface has not been created')" in (part.notes)
    assert inertia.check(part).findings[0].code == "open"


def with_entities(text: str, *entities: str) -> str:
    """Return a file with more entities, numbered from 9001, of which the last is one more item of its shape."""
    lines = "".join(f"#{9001 + k}={entity};\n" for k, entity in enumerate(entities))
    text = text.replace("ADVANCED_BREP_SHAPE_REPRESENTATION('',(", f"SHAPE_REPRESENTATION('',(#{9000 + len(entities)},")
    return text.replace("ENDSEC;\nEND-ISO", f"{lines}ENDSEC;\nEND-ISO")


@pytest.mark.parametrize(
    ("kind", "entities"),
    [
        ("CSG_SOLID", ["SPHERE('',2.,#9002)", "CARTESIAN_POINT('',(0.,0.,0.))", "CSG_SOLID('',#9001)"]),
        ("SWEPT_DISK_SOLID", ["SWEPT_DISK_SOLID('',$,1.,$,0.,1.)"]),
    ],
)
def test_solids_that_the_kernel_passes_over_are_noted(kind: str, entities: list[str], tmp_path: Path) -> None:
    text = with_entities(step_solid(CORNERS, QUADS.tolist(), "Box"), *entities)
    (tmp_path / "part.step").write_text(text)
    part = inertia.read(tmp_path / "part.step")
    assert f"1 {kind} was left out: OpenCASCADE does not read {kind}" in part.notes
    assert part.triangles.count == 12
    (tmp_path / "part.step").write_text(re.sub(r"(SHAPE_REPRESENTATION\('',\(#\d+)[^)]*", r"\1", text, count=1))
    with pytest.raises(ReadError, match=f"its {kind} is not read by OpenCASCADE: export the part with its faces"):
        inertia.read(tmp_path / "part.step")


def test_what_a_file_hides_is_counted_and_noted(tmp_path: Path) -> None:
    text = with_entities(
        step_solid(CORNERS, QUADS.tolist(), "Box"), "STYLED_ITEM('',(),#9002)", "INVISIBILITY((#9001))"
    )
    (tmp_path / "part.step").write_text(text)
    part = inertia.read(tmp_path / "part.step")
    assert "1 item marked as hidden (INVISIBILITY) was counted where solid" in part.notes
    assert part.triangles.count == 12


def test_tessellated_shapes_are_refused_and_end_no_process(tmp_path: Path) -> None:
    entities = (
        "COORDINATES_LIST('',4,((0.,0.,0.),(1.,0.,0.),(0.,1.,0.),(0.,0.,1.)))",
        "TRIANGULATED_FACE('',#9001,4,(),$,(),((1,3,2),(1,2,4),(2,3,4),(1,4,3)))",
        "TESSELLATED_SOLID('',(#9002),$)",
    )
    text = with_entities(step_solid(CORNERS, QUADS.tolist(), "Box"), *entities)
    (tmp_path / "part.step").write_text(text)
    with pytest.raises(ReadError, match="its product 'Box' has tessellated shapes, triangles without surfaces"):
        inertia.read(tmp_path / "part.step")
    mesh = Poly.Poly_Triangulation(3, 1, False)
    for k, at in enumerate(((0, 0, 0), (1, 0, 0), (0, 1, 0)), 1):
        mesh.SetNode(k, gp.gp_Pnt(*at))
    mesh.SetTriangle(1, Poly.Poly_Triangle(1, 2, 3))
    face = TopoDS.TopoDS_Face()
    BRep.BRep_Builder().MakeFace(face, mesh)
    with pytest.raises(UsageError, match="has triangles without surfaces: give the triangles as a mesh"):
        inertia.read(face)


def test_units_of_any_size_and_several_in_one_file(tmp_path: Path) -> None:
    inches, millimetres = (step_solid(CORNERS, QUADS.tolist(), name, name == "A") for name in "AB")
    (tmp_path / "odd.step").write_text(inches.replace("25.4", "7.").replace("'INCH'", "'NAIL'"))
    odd = inertia.read(tmp_path / "odd.step")
    assert (odd.unit.name, odd.unit.metres) == ("7.0 mm", Fraction(7, 1000))
    assert set(odd.triangles.corners().ravel().tolist()) == set(CORNERS.ravel().tolist())
    (tmp_path / "two.step").write_text(step_of_several(millimetres, inches, step_sphere(1.0)))
    two = inertia.read(tmp_path / "two.step", coarser=8.0)
    assert two.unit.name == "mm"
    assert any("2 units of length" in note for note in two.notes)
    box, larger, _ = (
        np.ptp([trim.curve.frame[0] for loop in solid.faces[0].loops for trim in loop], axis=0).max()
        for solid in shape_of(two).solids
    )
    assert larger == pytest.approx(25.4 * box, rel=1e-15)


def test_faces_without_loops_and_curves_without_a_formula_are_converted() -> None:
    points = [[(2.0 * i, 3.0 * j, (i - 1.0) * (j - 1.0)) for j in range(3)] for i in range(3)]
    ball, ring = Geom.Geom_SphericalSurface(gp.gp_Ax3(), 3.0), Geom.Geom_ToroidalSurface(gp.gp_Ax3(), 5.0, 1.0)
    curve = Geom.Geom_OffsetCurve(Geom.Geom_Ellipse(axes(0, 0, 0), 10.0, 6.0), 1.0, gp.gp_Dir(0, 0, 1))
    wanted = {
        "sphere": (ball, 0.0),
        "torus": (ring, 0.0),
        "spline": (bezier(points), 1e-15),
        "extrusion": (Geom.Geom_SurfaceOfLinearExtrusion(curve, gp.gp_Dir(0, 0, 1)), 1e-10),
    }
    for kind, (surface, near) in wanted.items():
        low, high = (0.0, 2.0) if kind == "extrusion" else surface.Bounds()[2:]
        if kind == "extrusion":
            face = BRepBuilderAPI.BRepBuilderAPI_MakeFace(surface, *surface.Bounds()[:2], low, high, 1e-7).Face()
        else:
            face = unbounded(surface)
        edges = Edges(0, shape_map())
        data = face_data(face, edges, 1)
        assert data.patch.kind == kind
        ((*trims,),) = data.loops
        assert len(trims) == 4
        assert len({trim.edge for trim in trims}) == {"sphere": 3, "torus": 2, "spline": 4, "extrusion": 3}[kind]
        assert edges.points == ({1, 2} if kind == "sphere" else set())
        first, last = surface.Bounds()[:2]
        for u in np.linspace(first, last, 7)[1:-1]:
            for v in np.linspace(low, high, 7)[1:-1]:
                point = surface.Value(u, v)
                there = [point.X(), point.Y(), point.Z()]
                assert np.abs(patch_point(data.patch, u, v) - there).max() <= near * 10 + 1e-15
