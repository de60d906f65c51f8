"""The wall around tools, against what lies between any rays: distances of points of the tool, and openings of the cut.

What a tool makes of the part is looked at by itself: points are spread over its surface, and their distance is taken to
the triangles of the part that it does not enter.
"""

import math

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import STEEL, on_z, permits, round_part, unbalance_of

from inertia.balancing.correction_loop import correct
from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.unbalance import PointMass
from inertia.errors import GeometryError
from inertia.mesh.check import check
from inertia.mesh.cut import block, cut, drill
from inertia.mesh.part import Part
from inertia.mesh.unite import unite

MM = 1e-3
R, LOW, HIGH = 100.0, 80.0, 110.0
POINT = math.radians(118)
ACROSS = 0.94  # normals along the shaft: the faces beside a flat or an arc, which its width leaves


def bored(x, y, diameter, low=70.0, high=120.0):
    """Return a drill along the shaft, mm."""
    return drill([x, y, low], [x, y, high], diameter, 0.0)


def disc(*tools, ribs=()):
    """Return a disc with tools cut out, and ribs on its face to B; mm."""
    part = round_part((0, LOW), (R, LOW), (R, HIGH), (0, HIGH), sides=360)
    part = cut(part, list(tools)) if tools else part
    for rib in ribs:
        both = np.concatenate([part.triangles.corners(), rib.corners()])
        part = unite(Part.from_arrays(both.reshape(-1, 3), np.arange(3 * len(both)).reshape(-1, 3), "mm")).part
    return part


def corrected(part, plane, degrees=0.0, grams=20.0):
    start = unbalance_of(part)
    spot = PointMass(MM * grams, 0.1, math.radians(degrees), 0.095)
    start = start.with_masses([PointMass(abs(start.static) / 0.1, 0.1, math.pi + np.angle(start.static), 0.095), spot])
    return correct([part], [STEEL], on_z(), start, [plane], permits(20), seconds=1.0)


def openings(part):
    """Return the Euler number of a closed surface, which an opening more lowers by 2."""
    vertices = len(np.unique(np.round(part.triangles.corners().reshape(-1, 3), 7), axis=0))
    return vertices - part.triangles.count // 2


def surface_points(work):
    """Return points of what a tool cuts, mm, as it is below the surface that it enters."""
    turn = np.array([[math.cos(work.angle), -math.sin(work.angle)], [math.sin(work.angle), math.cos(work.angle)]])
    radius, depth = work.radius / MM, work.depth / MM
    if work.kind.startswith("drill"):
        half, round_ = 0.5 * work.tool_diameter / MM, np.radians(np.arange(0, 360, 5))
        tip = 0.0 if work.point_angle >= math.pi - 1e-9 else half / math.tan(0.5 * work.point_angle)
        stations = [(half, t) for t in np.linspace(0, depth, 30)]
        stations += [(half * k, depth + tip * (1 - k)) for k in np.linspace(0, 1, 20)]
        rings = np.array([[(r * math.cos(a), r * math.sin(a), t) for a in round_] for r, t in stations]).reshape(-1, 3)
        if work.kind == "drill_radial":
            flat, z = np.column_stack([radius - rings[:, 2], rings[:, 0]]), work.z / MM + rings[:, 1]
        else:
            flat, z = np.column_stack([radius + rings[:, 0], rings[:, 1]]), work.z / MM + rings[:, 2]
    elif work.kind == "mill_flat":
        chord = math.sqrt(radius**2 - (radius - depth) ** 2)
        y, z = (k.ravel() for k in np.meshgrid(np.linspace(-chord, chord, 200), along(work)))
        flat = np.column_stack([np.full(len(y), radius - depth), y])
    else:
        a, s = np.linspace(-0.5, 0.5, 200) * work.arc, np.linspace(radius - depth, radius, 20)
        line = np.concatenate([
            (radius - depth) * np.exp(1j * a), *(s * np.exp(1j * end) for end in (a[0], a[-1]))
        ])  # fmt: skip
        points, z = (k.ravel() for k in np.meshgrid(line, along(work)))
        flat = np.column_stack([points.real, points.imag])
    return np.column_stack([flat @ turn.T, z])


def along(work):
    return np.linspace(work.z - 0.499 * work.width, work.z + 0.499 * work.width, 15) / MM


def distance(points, corners):
    """Return the distance of points (n, 3) from the nearest of triangles (m, 3, 3)."""
    nearest = np.inf
    for triangle in corners:
        middle = triangle.mean(axis=0)
        size = np.linalg.norm(triangle - middle, axis=1).max()
        near = points[np.linalg.norm(points - middle, axis=1) < nearest + size]
        if not len(near):
            continue
        a, edges = triangle[0], np.roll(triangle, -1, axis=0) - triangle
        normal = np.cross(edges[0], triangle[2] - a)
        normal /= np.linalg.norm(normal)
        height = (near - a) @ normal
        foot = near - height[:, None] * normal
        inside = np.all([np.cross(e, foot - c) @ normal >= 0 for c, e in zip(triangle, edges, strict=True)], axis=0)
        away = np.where(inside, np.abs(height), np.inf)
        for corner, edge in zip(triangle, edges, strict=True):
            share = np.clip((near - corner) @ edge / (edge @ edge), 0, 1)
            away = np.minimum(away, np.linalg.norm(near - corner - share[:, None] * edge, axis=1))
        nearest = min(nearest, float(away.min()))
    return nearest


def not_entered(part, plane):
    """Return the triangles that a plane's tools do not enter, mm."""
    corners = part.triangles.corners()
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    if plane.method == "drill_axial":
        return corners[~(np.abs(corners[..., 2] - plane.z / MM) < plane.min_wall / MM).all(axis=1)]
    rim = (np.abs(np.hypot(corners[..., 0], corners[..., 1]) - R) < plane.min_wall / MM).all(axis=1)
    beside = (np.abs(normals[:, 2]) > ACROSS) & (plane.method in ("mill", "mill_arc"))
    return corners[~rim & ~beside]


def keeps_its_wall(part, plane, correction):
    assert correction.operations
    assert openings(correction.parts[0]) == openings(part)
    corners = not_entered(part, plane)
    for work in correction.operations:
        left = distance(surface_points(work), corners)
        assert left >= plane.min_wall / MM - 1e-3
        assert left >= work.remaining_wall / MM - 1e-3
        assert work.remaining_wall >= plane.min_wall - 1e-9


def radial(**more):
    return CorrectionPlane("I", 0.095, "drill_radial", 0.1, diameters=(0.016,), max_depth=0.04, **more)


def axial(**more):
    return CorrectionPlane("I", MM * LOW, "drill_axial", 0.07, diameters=(0.014,), face="a", **more)


def test_a_radial_hole_keeps_off_a_tapped_hole_between_rays():
    part, plane = disc(bored(90.0, 3.5, 3.3)), radial(angles=(0.0,))
    correction = corrected(part, plane)
    keeps_its_wall(part, plane, correction)
    assert correction.operations[0].depth < 0.006


def test_an_axial_hole_in_front_of_a_rib_does_not_open_beside_it():
    rib = block([30.0, -2.0, HIGH - 1], np.diag([60.0, 4.0, 20.0]))
    part, plane = disc(ribs=[rib]), axial(angles=(0.0,))
    correction = corrected(part, plane, grams=60.0)
    keeps_its_wall(part, plane, correction)
    assert correction.operations[0].remaining_wall < 0.0015


@pytest.mark.parametrize("at", [5.0, 9.0, 14.0])
def test_flats_and_arcs_keep_off_a_bore_beside_their_middle(at):
    turned = math.radians(at)
    part = disc(bored(95.0 * math.cos(turned), 95.0 * math.sin(turned), 3.3))
    for plane in (
        CorrectionPlane("I", 0.095, "mill", 0.1, width=0.03, max_depth=0.006),
        CorrectionPlane("I", 0.095, "mill_arc", 0.1, width=0.03, max_depth=0.005, angles=(0.0,)),
        CorrectionPlane("I", 0.095, "mill_arc", 0.1, width=0.03, max_depth=0.005, cutter=0.03),
    ):
        try:
            keeps_its_wall(part, plane, corrected(part, plane))
        except GeometryError:
            assert plane.angles == (0.0,)
            assert at < 14


def test_a_hole_through_cuts_no_rib_and_no_bore():
    rib = block([30.0, -2.0, HIGH - 1], np.diag([60.0, 4.0, 20.0]))
    part = disc(bored(70.0 * math.cos(0.4), 70.0 * math.sin(0.4), 5.0), ribs=[rib])
    correction = corrected(part, axial(through=True))
    assert correction.operations
    for work in correction.operations:
        y, x = 70 * math.sin(work.angle), 70 * math.cos(work.angle)
        assert abs(y) >= 2 + 7 + 1 - 1e-3 or x < 0
        assert math.hypot(x - 70 * math.cos(0.4), y - 70 * math.sin(0.4)) >= 2.5 + 7 + 1 - 1e-2
    assert openings(correction.parts[0]) == openings(part) - 2 * len(correction.operations)


@pytest.mark.parametrize("seed", range(6))
def test_no_tool_comes_nearer_than_its_wall_to_what_it_does_not_enter(seed):
    random = np.random.default_rng(seed)
    tools = []
    for _ in range(6):
        place, turned = random.uniform(40, 97), random.uniform(-1, 1)
        low = random.choice([70.0, random.uniform(84, 106)])
        tools.append(bored(place * math.cos(turned), place * math.sin(turned), random.uniform(2, 7), low))
    for _ in range(3):
        turned, depth = random.uniform(-1, 1), random.uniform(3, 20)
        way = np.array([math.cos(turned), math.sin(turned), random.uniform(-0.2, 0.2)])
        start = np.array([0.0, 0.0, random.uniform(85, 105)])
        tools.append(drill(start + (R - depth) * way, start + 1.2 * R * way, random.uniform(1.5, 5), 1.0))
    part = disc(*tools)
    wall = float(random.uniform(0.5, 2.0)) * MM
    step = float(random.choice([0.0, math.radians(0.5)]))
    for plane in (
        radial(min_wall=wall, angle_step=step),
        axial(min_wall=wall, angle_step=step),
        CorrectionPlane("I", 0.095, "mill", 0.1, width=0.03, max_depth=0.008, min_wall=wall),
        CorrectionPlane("I", 0.095, "mill_arc", 0.1, width=0.03, max_depth=0.006, min_wall=wall),
    ):
        keeps_its_wall(part, plane, corrected(part, plane, grams=40.0))


def test_what_bodies_that_touch_have_in_common_is_no_wall():
    ring = round_part((60, LOW), (R, LOW), (R, HIGH), (60, HIGH), (60, LOW), sides=360)
    hub = round_part((0, LOW), (60, LOW), (60, HIGH), (0, HIGH), sides=360)
    start = unbalance_of(ring).with_masses([PointMass(0.08, 0.1, 0.0, 0.095)])
    plane = radial(angles=(0.0,))
    correction = correct([ring, hub], [STEEL, STEEL], on_z(), start, [plane], permits(20), seconds=1.0)
    (work,) = correction.operations
    assert work.depth > 0.035


def test_flats_as_wide_as_the_part_leave_no_skin():
    part = disc()
    for method, more in (("mill", {}), ("mill_arc", {"angles": (0.0,)})):
        plane = CorrectionPlane("I", 0.095, method, 0.1, width=0.03, max_depth=0.005, **more)
        left = corrected(part, plane).parts[0]
        assert check(left).fit
        assert openings(left) == openings(part)
