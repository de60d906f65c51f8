"""The report's pictures: vectors point where they should, the strip reads as the surface does, the outline is true."""

import math
import re
from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest

import inertia
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.shop_digits import ShopDigits
from inertia.report.balance.data import BearingRow, OperationRow, PlaneRow
from inertia.report.svg.canvas import Canvas, levels
from inertia.report.svg.convention import convention
from inertia.report.svg.end_view import end_view
from inertia.report.svg.polar import Arrow, Mark, polar
from inertia.report.svg.section import section
from inertia.report.svg.silhouette import silhouette
from inertia.report.svg.sketch import sketch
from inertia.report.svg.strip import strip
from inertia.report.svg.wrap import wrap
from inertia_meshes import path

PLANES = (
    PlaneRow("I", 90.0, "drill_radial", 100.0),
    PlaneRow("II", 215.0, "drill_radial", 80.0, forbidden=((350.0, 10.0),)),
)


def tree(picture):
    return ElementTree.fromstring(str(picture))


def styled(picture, tag, style):
    return [k for k in tree(picture).iter(tag) if style in k.get("class", "").split()]


def number(element, *names):
    return tuple(float(element.get(name)) for name in names)


def points(element):
    return np.array([list(map(float, pair.split(","))) for pair in element.get("points").split()])


def place(picture, label):
    """Return where a text of a picture is."""
    return number(next(k for k in tree(picture).iter("text") if k.text == label), "x", "y")


def widest(letter):
    """Return how wide a letter is in DejaVu Sans Bold, the widest of the fonts, of its height; of others, at most."""
    exact = {"W": 1.103, "M": 0.995, "m": 1.042, "w": 0.924, "@": 1.0, "%": 1.002, "校": 1.0, "Ш": 1.11, " ": 0.348}
    return exact.get(letter, 0.85 if letter.isupper() else 0.717)


def operation(name, angle, method="remove", plane="I"):
    return OperationRow(
        name, plane, method, "drill_radial", 90.0, angle, radius=100.0, mass=1.0, unbalance=-1e-4, diameter=10.0
    )


@pytest.mark.parametrize(("vector", "x", "y"), [(10, 1, 0), (10j, 0, -1), (-10, -1, 0), (-10j, 0, 1)])
def test_a_vector_is_drawn_with_0_to_the_right_and_90_on_top(vector, x, y):
    picture = polar("plane", [Arrow(complex(vector), "before")])
    (shaft,) = styled(picture, "line", "before")
    (head,) = styled(picture, "polygon", "before")
    tip = points(head)[0] - number(shaft, "x1", "y1")
    assert tip / np.hypot(*tip) == pytest.approx([x, y], abs=1e-3)


def test_vectors_circles_and_discs_share_one_scale():
    picture = polar("plane", [Arrow(50.0, "after", 20.0)], tolerance=100.0, scatter=80.0)
    (tolerance,), (scatter,) = styled(picture, "circle", "tolerance"), styled(picture, "circle", "scatter")
    (disc,) = styled(picture, "circle", "disc")
    (head,) = styled(picture, "polygon", "after")
    scale = number(tolerance, "r")[0] / 100.0
    assert number(scatter, "r")[0] == pytest.approx(80.0 * scale, abs=0.01)
    assert number(disc, "r")[0] == pytest.approx(20.0 * scale, abs=0.01)
    assert points(head)[0][0] - number(tolerance, "cx")[0] == pytest.approx(50.0 * scale, abs=0.02)


def test_what_is_too_short_for_an_arrow_is_a_dot():
    assert len(styled(polar("plane", [Arrow(0.01, "after")], tolerance=100.0), "circle", "dot")) == 1


def test_a_plot_of_nothing_at_all_can_be_drawn():
    assert not styled(polar("plane", [Arrow(0j, "before")]), "polygon", "before")


@pytest.mark.parametrize(
    "name",
    [
        "I",
        "II, turbine wheel side, reachable through the volute",
        "a_name_without_any_place_to_break_it_at_all",
        "WWWWWWWWWWWWWWWWWWWW 1",
        60 * "A",
        "MITTE-WELLE-GROSS " * 3,
        20 * "m@%",
        40 * "校",
        40 * "Ш",
    ],
)
@pytest.mark.parametrize("kind", ["polar", "end view"])
def test_a_heading_stands_in_the_picture_however_long_it_is(name, kind):
    loops = [100.0 * np.exp(1j * np.linspace(0.0, 2 * np.pi, 60)).view(float).reshape(-1, 2)]
    plane = PlaneRow(name, 90.0, radius=100.0)
    picture = polar(f"plane {name}", []) if kind == "polar" else end_view(plane, loops, [])
    _, top, width, height = map(float, tree(picture).get("viewBox").split())
    lines = [k for k in styled(picture, "text", "strong") if not k.text.endswith("°")]
    assert re.sub(r"\s", "", "".join(line.text for line in lines)).startswith(re.sub(r"\s", "", f"plane{name}"))
    for line in lines:
        size, y = number(line, "font-size", "y")
        assert size * sum(widest(letter) for letter in line.text) <= width + 1e-9
        assert y - 0.8 * size >= top - 1e-9
    assert top + height == pytest.approx(60.0 if kind == "polar" else 68.0)


def test_marks_on_the_rim_tell_adding_from_removing():
    picture = polar("plane", [], marks=[Mark(90.0, True), Mark(180.0, False)])
    (added,), (removed,) = styled(picture, "circle", "added"), styled(picture, "circle", "removed")
    (rim,) = styled(picture, "circle", "rim")
    x, y = number(rim, "cx", "cy")
    assert number(added, "cx")[0] == pytest.approx(x)
    assert number(added, "cy")[0] < y
    assert number(removed, "cx")[0] < x
    assert number(removed, "cy")[0] == pytest.approx(y)


@pytest.mark.parametrize(("rotation", "down"), [("ccw", True), ("cw", False)])
def test_the_pictogram_turns_as_the_rotor_does(rotation, down):
    """On the left of the shaft a rotor that turns counter-clockwise goes down."""
    picture = convention(rotation)
    (head,) = styled(picture, "polygon", "rotation")
    (rim,) = styled(picture, "circle", "rim")
    tip = points(head)[0]
    assert tip[0] < number(rim, "cx")[0]
    assert (tip[1] > number(rim, "cy")[0]) == down
    (angle,) = styled(picture, "polygon", "angle")
    assert points(angle)[0][1] < number(rim, "cy")[0]


def test_on_the_strip_angles_grow_to_the_right_with_b_on_top():
    """From outside, with B up, the near side moves to the right while the angle grows."""
    works = [operation("I-1", 30.0), operation("I-2", 200.0, "add"), operation("II-1", 30.0, plane="II")]
    picture = strip(PLANES, works)
    (added,) = styled(picture, "circle", "added")
    first, other = sorted((number(k, "cx", "cy") for k in styled(picture, "circle", "removed")), key=lambda k: k[1])
    assert first[0] == other[0] < number(added, "cx")[0]
    assert first[1] < other[1], "plane II lies nearer B"
    width = number(added, "cx")[0] - other[0]
    assert width / 170.0 == pytest.approx((place(picture, "360°")[0] - place(picture, "0°")[0]) / 360.0, rel=1e-3)


def test_a_forbidden_sector_through_0_is_drawn_at_both_ends():
    assert len(styled(strip(PLANES, []), "rect", "forbidden")) == 2


def test_crowded_labels_leave_out_their_angles_and_none_lies_on_another():
    works = [operation(f"I-{k}", 3.0 * k) for k in range(40)]
    labels = [k for k in tree(strip(PLANES, works)).iter("text") if re.fullmatch(r"I-\d+", k.text)]
    assert len(labels) == 40
    places = [number(k, "x", "y") for k in labels]
    assert len(set(places)) == 40
    lonely = [k.text for k in tree(strip(PLANES, works[:1])).iter("text")]
    assert "I-0: 0.0°" in lonely


def test_labels_that_would_overlap_go_to_levels_of_their_own():
    level_of = levels([0.0, 1.0, 2.0, 30.0], [4.0, 4.0, 4.0, 4.0])
    assert level_of == [0, 1, 2, 0]


def bearing(name, z):
    return BearingRow(name, z, 100e-6, None, 0.0, "pass")


def test_the_sketch_shows_distances_between_neighbouring_planes():
    outline = np.array([[0.0, 15.0, -15.0], [300.0, 15.0, -15.0]])
    picture = sketch(outline, 150.0, (bearing("A", 20.0), bearing("B", 280.0)), PLANES)
    labels = [k.text for k in tree(picture).iter("text")]
    for expected in ("A: z 20", "I: z 90", "II: z 215", "B: z 280", "70", "125", "65", "A to B 260 mm", "G"):
        assert expected in labels
    assert place(picture, "A: z 20")[0] < place(picture, "I: z 90")[0] < place(picture, "B: z 280")[0]


def test_an_overhung_plane_is_on_the_sketch():
    outline = np.array([[0.0, 15.0, -15.0], [100.0, 15.0, -15.0]])
    planes = [PlaneRow("I", -40.0, "drill_radial", 50.0)]
    picture = sketch(outline, 10.0, (bearing("A", 20.0), bearing("B", 80.0)), planes)
    assert 0 < place(picture, "I: z -40")[0] < place(picture, "A: z 20")[0]


def test_the_outline_of_the_two_disc_rotor_has_its_radii():
    part = inertia.read(path("two_disc_rotor.stl"), unit="mm")
    outline = silhouette([part], Shaft([0, 0, 0.02], [0, 0, 0.28], [1, 0, 0]))
    assert outline[[0, -1], 0] == pytest.approx([0.0, 0.3])
    for z, radius in ((0.05, 0.015), (0.09, 0.1), (0.15, 0.015), (0.215, 0.08), (0.29, 0.015)):
        for reach, expected in ((outline[:, 1], radius), (outline[:, 2], -radius)):
            assert np.interp(z, outline[:, 0], reach) == pytest.approx(expected, rel=1e-3)
    assert len(outline) < 50


def test_the_outline_runs_along_the_shaft_whichever_way_it_points():
    part = inertia.read(path("two_disc_rotor.stl"), unit="mm")
    outline = silhouette([part], Shaft([0, 0, 0.28], [0, 0, 0.02], [1, 0, 0]))
    assert outline[[0, -1], 0] == pytest.approx([-0.3, 0.0])
    assert np.interp(-0.215, *outline[:, :2].T) == pytest.approx(0.08, rel=1e-3)


def crank():
    """Return a shaft of Ø 20 with a web that reaches to 50 mm on one side, 80 < z < 100, as two bodies."""
    import trimesh

    shaft = trimesh.creation.cylinder(10.0, 200.0, sections=64)
    shaft.apply_translation([0, 0, 100])
    web = trimesh.creation.box((60.0, 12.0, 20.0))
    web.apply_translation([20, 0, 90])
    return [inertia.Part.from_trimesh(k, unit="mm") for k in (shaft, web)]


@pytest.mark.parametrize(("mark", "up", "down"), [([1, 0, 0], 0.05, -0.01), ([-1, 0, 0], 0.01, -0.05)])
def test_a_crank_is_drawn_with_its_throw_to_one_side(mark, up, down):
    outline = silhouette(crank(), Shaft([0, 0, 0.01], [0, 0, 0.19], mark))
    at = [np.interp(0.09, outline[:, 0], outline[:, k]) for k in (1, 2)]
    assert at == pytest.approx([up, down], rel=1e-3)
    assert np.interp(0.15, outline[:, 0], outline[:, 1]) == pytest.approx(0.01, rel=1e-3)
    assert np.abs(outline[:, 1:]).min() > 0.0099, "no notch where nothing is cut"


def area(loop):
    x, y = loop.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_a_section_has_the_area_of_the_cut_with_its_holes():
    """The disc at z = 90 mm is a 512-gon of radius 100 mm with a bore of Ø 10 at 75 mm."""
    part = inertia.read(path("two_disc_rotor.stl"), unit="mm")
    disc, hole = section([part], Shaft([0, 0, 0.02], [0, 0, 0.28], [1, 0, 0]), 0.09)
    assert area(disc) == pytest.approx(math.pi * 0.1**2, rel=2e-4)
    assert area(hole) == pytest.approx(-math.pi * 0.005**2, rel=1e-3)
    assert np.allclose(hole.mean(axis=0), 0.07 * np.array([math.cos(math.pi / 6), math.sin(math.pi / 6)]), atol=1e-4)


def test_a_section_through_corners_and_along_faces_closes():
    part = inertia.read(path("cube.stl"), unit="mm")
    extents = inertia.analyse(part).extents[:, 2]
    shaft = Shaft([0, 0, 0], [0, 0, 1], [1, 0, 0])
    (loop,) = section([part], shaft, float(extents[1]))
    side = float(np.ptp(inertia.analyse(part).extents, axis=0)[0])
    assert area(loop) == pytest.approx(side**2)
    assert section([part], shaft, float(extents[1]) * 1.01 + 1.0) == []


def test_the_end_view_draws_holes_where_they_are_and_as_large_as_they_are():
    circle = 100.0 * np.column_stack([np.cos(np.linspace(0, 6.28, 200)), np.sin(np.linspace(0, 6.28, 200))])
    work = replace(operation("I-1", 90.0), depth=20.0, point=180.0)
    picture = end_view(PLANES[0], [circle], [(7, work)])
    (hole,) = styled(picture, "polygon", "removed")
    (ruler,) = styled(picture, "line", "rim")
    label = next(k for k in tree(picture).iter("text") if k.text.endswith(" mm") and k.text[0].isdigit())
    start, stop = number(ruler, "x1", "x2")
    scale = (stop - start) / float(label.text.split()[0])
    wide, tall = np.ptp(points(hole), axis=0)
    assert (wide, tall) == pytest.approx((10.0 * scale, 20.0 * scale), abs=0.03)
    assert "7" in [k.text for k in tree(picture).iter("text")]
    spots = [number(k, "x", "y") for k in tree(picture).iter("text") if k.text == "90°"]
    assert points(hole)[:, 1].min() > spots[0][1], "90° is on top"


@pytest.mark.parametrize("kind", ["drill_axial", "mill_flat", "weight"])
def test_the_end_view_draws_every_kind_of_work(kind):
    work = replace(operation("I-1", 0.0, "add" if kind == "weight" else "remove"), kind=kind, depth=5.0)
    shapes = [*tree(end_view(PLANES[0], [], [(1, work)]))]
    assert any({"added", "removed"} & set(k.get("class", "").split()) for k in shapes)


@pytest.mark.parametrize(("radius", "pieces"), [(20.0, 1), (100.0, 3), (318.0, 8), (319.0, 0)])
def test_strips_are_as_long_as_the_rim(radius, pieces):
    plane = replace(PLANES[0], radius=radius)
    strips = wrap(plane, [], lambda angle: angle, ShopDigits())
    assert len(strips) == pieces
    long = [number(styled(k, "rect", "cut")[0], "width")[0] for k in strips]
    assert sum(long) == pytest.approx(2 * math.pi * radius if pieces else 0.0, abs=0.01 * 8)
    for picture in strips:
        assert tree(picture).get("style") == f"width:{tree(picture).get('viewBox').split()[2]}mm", "one to one"


def test_a_hole_is_on_the_strip_where_its_angle_is_and_named_as_the_machine_counts():
    plane, work = replace(PLANES[0], radius=30.0), replace(operation("I-1", 90.0), radius=30.0)
    (picture,) = wrap(plane, [(3, work)], lambda angle: -angle % 360.0, ShopDigits())
    (edge,) = styled(picture, "rect", "cut")
    (hole,) = styled(picture, "circle", "bore")
    x, radius = number(hole, "cx", "r")
    assert (x - number(edge, "x")[0], radius) == pytest.approx((0.25 * 2 * math.pi * 30.0, 5.0), abs=0.01)
    assert "3: 270.0°" in [k.text for k in tree(picture).iter("text")]


@pytest.mark.parametrize(("start", "pieces"), [(80.0, 1), (350.0, 2)])
def test_an_arc_is_on_the_strip_from_its_start_to_its_end(start, pieces):
    plane = replace(PLANES[0], radius=30.0)
    ends = (start, (start + 25.0) % 360.0)
    work = replace(
        operation("I-1", (start + 12.5) % 360.0), kind="mill_arc", radius=30.0, width=6.0, ends=ends, arc=25.0
    )
    (picture,) = wrap(plane, [(3, work)], lambda angle: -angle % 360.0, ShopDigits())
    drawn = styled(picture, "rect", "removed")
    assert len(drawn) == pieces
    assert sum(number(k, "width")[0] for k in drawn) == pytest.approx(math.radians(25.0) * 30.0, abs=0.02)
    texts = [k.text for k in tree(picture).iter("text")]
    assert {f"{-end % 360.0:.1f}°" for end in ends} <= set(texts)
    assert "3" in texts
    shapes = [*tree(end_view(PLANES[0], [], [(1, replace(work, depth=2.0))]))]
    assert any("removed" in k.get("class", "").split() for k in shapes)


def test_on_a_very_small_rim_no_label_lies_on_another():
    plane = replace(PLANES[0], radius=0.5)
    works = [(k + 1, replace(operation(f"I-{k}", 40.0 * k), radius=0.5, diameter=0.05)) for k in range(3)]
    arc = replace(operation("I-9", 31.5), kind="mill_arc", radius=0.5, width=0.1, ends=(10.0, 53.0), arc=43.0)
    for some in (works, [(1, arc)]):
        (picture,) = wrap(plane, some, lambda angle: angle, ShopDigits())
        boxes = []
        for label in tree(picture).iter("text"):
            x, y, size = number(label, "x", "y", "font-size")
            before = {"start": 0.0, "middle": 0.5, "end": 1.0}[label.get("text-anchor")]
            boxes.append((x - before * 0.7 * size * len(label.text), y, 0.7 * size * len(label.text), size, label.text))
        for a, b in combinations(boxes, 2):
            apart = abs(a[1] - b[1]) >= 0.9 * max(a[3], b[3]) or a[0] + a[2] <= b[0] or b[0] + b[2] <= a[0]
            assert apart, (a[4], b[4])


def test_the_outline_does_not_depend_on_how_many_triangles_are_taken_at_once():
    part, shaft = inertia.read(path("cone.stl"), unit="mm"), Shaft([0, 0, 0], [0, 0, 1], [1, 0, 0])
    whole = silhouette([part], shaft)
    assert np.array_equal(silhouette([part], shaft, triangles_at_once=7, samples_at_once=100), whole)


def test_text_in_a_picture_is_escaped():
    canvas = Canvas(10.0, 10.0, "<title>")
    canvas.text((1.0, 1.0), "</text><script>")
    assert "<script>" not in canvas.markup()
    assert tree(canvas.markup()).find("text").text == "</text><script>"
