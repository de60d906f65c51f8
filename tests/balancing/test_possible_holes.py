"""Holes that can be drilled: beside each other, in what is there, and with a wall; the sheet states what they take."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import (
    STEEL,
    drilled,
    on_z,
    permits,
    plate,
    round_part,
    unbalance_of,
)
from tests.balancing.rotors import two_disc_part

from inertia.balancing.balance import balance
from inertia.balancing.correction_loop import correct
from inertia.balancing.corrections.correction_plane import CorrectionPlane, Sector
from inertia.balancing.rotor import Rotor
from inertia.balancing.tolerance import iso_21940_11
from inertia.balancing.unbalance import PointMass
from inertia.errors import GeometryError
from inertia.mesh.cut import block, cut
from inertia.mesh.write import write_stl

RING = [(60, 80), (100, 80), (100, 120), (60, 120), (60, 80)]


def heavy(part, grams=20.0, z=90.0, degrees=50.0):
    """Return the unbalance of a part with a mass on its rim."""
    return unbalance_of(part).with_masses([PointMass(1e-3 * grams, 0.1, math.radians(degrees), 1e-3 * z)])


def corrected(part, start, planes, gmm=20.0, **options):
    """Return the correction, its sheet checked: what it says was taken is what the part lost."""
    correction = correct([part], [STEEL], on_z(), start, planes, permits(gmm), **options)
    lost = start.mass - correction.residual.mass
    assert sum(k.mass for k in correction.operations) == pytest.approx(lost, rel=1e-7)
    left = start.with_vectors([(k.unbalance_z, k.unbalance) for k in correction.operations])
    assert np.allclose(left.in_many_planes([0.02, 0.28]), correction.residual.in_many_planes([0.02, 0.28]), atol=1e-11)
    return correction


def axis_points(work):
    """Return places along the axis of a radial hole, from its rim to its shoulder."""
    radii = work.radius - np.linspace(0, work.depth, 50)
    direction = np.array([math.cos(work.angle), math.sin(work.angle), 0.0])
    return radii[:, None] * direction + [0.0, 0.0, work.z]


@pytest.mark.parametrize("apart", [0.0, 6.0, 10.0, 14.0])
def test_holes_of_two_planes_keep_their_web(apart):
    ring = round_part((40, 60), (100, 60), (100, 140), (40, 140), (40, 60))
    start = heavy(ring, 40.0, 100.0)
    planes = [
        drilled("I", 100 - apart / 2, 100, 12, max_depth=20),
        drilled("II", 100.1 + apart / 2, 100, 12, max_depth=20),
    ]
    correction = corrected(ring, start, planes)
    assert correction.within
    for one, other in itertools.combinations(correction.operations, 2):
        gaps = np.linalg.norm(axis_points(one)[:, None] - axis_points(other), axis=2)
        assert gaps.min() >= 0.012 + 0.001 - 1e-6


@pytest.mark.parametrize(("z", "diameter"), [(84, 12), (96, 12), (90, 20)])
def test_a_drill_that_would_break_out_of_an_end_face_is_refused(z, diameter):
    with pytest.raises(GeometryError, match="break out of the part, or leave less than 1 mm"):
        correct([plate()], [STEEL], on_z(), heavy(plate()), [drilled("I", z, 100, diameter)], permits(20))


def test_the_next_smaller_drill_is_taken_where_one_breaks_out():
    correction = corrected(plate(), heavy(plate(), z=86.0), [drilled("I", 86, 100, 8, 20)])
    assert {k.tool_diameter for k in correction.operations} == {0.008}


def test_a_flat_that_meets_a_hole_is_said():
    start = heavy(plate(), 60.0, 90.0)
    planes = [
        CorrectionPlane("I", 0.09, "mill", 0.1, width=0.018, max_depth=0.003, angles=(math.radians(50),)),
        drilled("II", 91, 100, 8, max_depth=20, angles=(math.radians(50),)),
    ]
    correction = correct([plate()], [STEEL], on_z(), start, planes, permits(20))
    assert len(correction.operations) == 2
    assert "; tools meet: " in correction.why


def test_holes_keep_clear_of_a_keyway_and_of_a_bore():
    ring = round_part(*RING, unit="mm")
    keyway = block([85.0, -6.0, 70.0], np.diag([30.0, 12.0, 60.0]))  # in the rim, at 0°
    slotted = cut(ring, [keyway])
    start = heavy(slotted, 15.0, 100.0, degrees=3.0)
    correction = corrected(slotted, start, [drilled("I", 100, 100, 10)])
    for work in correction.operations:
        # The keyway is 12 mm wide, a hole 10, and 1 mm stays between them.
        assert abs(0.1 * math.sin(work.angle)) >= 0.006 + 0.005 + 0.001 - 1e-4 or math.cos(work.angle) < 0
        assert work.remaining_wall >= 0.001 - 1e-9


def test_arcs_keep_clear_of_a_keyway_of_sectors_and_of_the_other_plane():
    slotted = cut(round_part(*RING, unit="mm"), [block([85.0, -6.0, 70.0], np.diag([30.0, 12.0, 60.0]))])
    arc = {"method": "mill_arc", "radius": 0.1, "width": 0.012, "max_depth": 0.002, "cutter": 0.03}
    planes = [
        CorrectionPlane("I", 0.098, forbidden=(Sector(math.radians(20), math.radians(25)),), **arc),
        CorrectionPlane("II", 0.105, **arc),
    ]
    correction = corrected(slotted, heavy(slotted, 60.0, 100.0, degrees=3.0), planes)
    ends = [
        (k.plane, (math.degrees(k.angle - k.half_angle) + 180) % 360 - 180, math.degrees(2 * k.half_angle))
        for k in correction.operations
    ]
    assert {plane for plane, _, _ in ends} == {"I", "II"}
    turn = np.zeros(3600)
    for plane, start, length in ends:
        around = np.arange(round(10 * start), round(10 * (start + length))) % 3600
        turn[around] += 1
        in_degrees = np.where(around > 1800, around - 3600, around) / 10
        # The keyway is 12 mm wide at the radius of 100 mm.
        assert (np.abs(in_degrees) > math.degrees(math.asin(0.06)) - 0.1).all()
        assert plane == "II" or not ((in_degrees > 20) & (in_degrees < 25)).any()
    assert turn.max() <= 1
    assert "tools meet" not in correction.why


def test_deeper_and_shorter_arcs_are_taken_where_their_depth_is_what_scatters(tmp_path):
    part = plate()
    write_stl([part], tmp_path / "plate.stl", part.unit)
    fields = {
        "body": [{"file": "plate.stl", "material": "steel"}],
        "axis": {"bearing_a": [0, 0, 20], "bearing_b": [0, 0, 160]},
        "service": {"rpm": 3000},
        "tolerance": {"e_um": 20},
        "key": [{"convention": "F", "width": 20, "height": 6, "length": 10, "floor": 90, "z": 90}],
        "plane": [{"id": "I", "z": 90, "method": "mill_arc", "width": 12, "max_depth": 3}],
    }
    result = balance(Rotor.from_dict(fields, folder=tmp_path))
    assert result.verdict.outcome == "pass"
    assert all(work.depth >= 0.0015 for work in result.correction.operations)


def test_no_hole_starts_in_air_on_a_part_that_is_round_in_part():
    web = cut(plate(60, 90, 120), [block([-100.0, -100.0, 0.0], np.diag([75.0, 200.0, 300.0]))])
    # What is measured, with its heavy spot beside the flat, which goes from 115° to 245°.
    start = replace(unbalance_of(web), static=8e-4 * complex(np.exp(1j * math.radians(125))), couple=0j)
    correction = corrected(web, start, [drilled("I", 105, 60, 8, 10, 12, max_depth=20)], gmm=100)
    assert correction.operations
    for work in correction.operations:
        # The flat is 25 mm from the shaft; a drill begins wholly on the rim.
        assert 60 * math.cos(work.angle) > -25 + 3.5
        assert work.mass == pytest.approx(work.tool_diameter**2 * math.pi / 4 * STEEL * work.depth, rel=0.2, abs=1e-3)


def test_faces_of_any_length_take_axial_holes(tmp_path):
    for length in (30.1, 30.3, 30.7, 31.1, 33.3, 34.7, 41.9, 57.7):
        part = round_part((0, 0), (50, 0), (50, length), (0, length), sides=48)
        write_stl([part], tmp_path / f"{length}.stl", part.unit)
        fields = {
            "body": [{"file": f"{length}.stl", "material": "steel", "chord_tolerance": 0}],
            "axis": {"bearing_a": [0, 0, 3.7], "bearing_b": [0, 0, length - 7.3]},
            "service": {"rpm": 3000},
            "tolerance": {"grade": 6.3},
            "plane": [
                {"id": "A", "z": 0, "method": "drill_axial", "radius": 40, "diameters": [8], "face": "a"},
                {"id": "B", "z": length, "method": "drill_axial", "radius": 40, "diameters": [8], "face": "b"},
            ],
        }
        assert balance(Rotor.from_dict(fields, folder=tmp_path)).correction is not None


@pytest.mark.parametrize(("face_z", "at"), [(90, 0.09), ("find", 0.09), (None, None)])
def test_a_web_beside_the_plane_takes_axial_holes(tmp_path, face_z, at):
    """A wheel with a rim from 80 to 100 mm along the shaft, a hub, and a web from 90 to 98 between them."""
    profile = [(0, 60), (25, 60), (25, 90), (70, 90), (70, 80), (90, 80), (90, 100), (70, 100), (70, 98), (25, 98)]
    wheel = round_part(*profile, (25, 110), (0, 110), sides=180)
    write_stl([wheel], tmp_path / "wheel.stl", wheel.unit)
    plane = {"id": "web", "z": 80, "method": "drill_axial", "radius": 50, "diameters": [8], "face": "a"}
    fields = {
        "body": [{"file": "wheel.stl", "material": "steel"}],
        "axis": {"bearing_a": [0, 0, 62], "bearing_b": [0, 0, 108]},
        "service": {"rpm": 3000},
        "tolerance": {"e_um": 10},
        "key": [{"convention": "F", "width": 8, "height": 3, "length": 5, "floor": 70, "z": 92, "angle": 100}],
        "plane": [plane | ({} if face_z is None else {"face_z": face_z})],
    }
    if face_z is None:
        with pytest.raises(GeometryError, match=r"at that radius the faces to A are at z = 90 mm: give one .* face_z"):
            balance(Rotor.from_dict(fields, folder=tmp_path))
        return
    correction = balance(Rotor.from_dict(fields, folder=tmp_path)).correction
    assert correction.operations
    for work in correction.operations:
        assert work.z == pytest.approx(at, abs=1e-6)
        assert work.mass == pytest.approx(work.tool_diameter**2 * math.pi / 4 * STEEL * work.depth, rel=0.7)
        assert work.remaining_wall >= 0.001 - 1e-9
        assert work.unbalance_z > at


def test_the_wall_goes_to_the_next_surface():
    part = two_disc_part()
    start = unbalance_of(part)
    limits = iso_21940_11(6.3, start, (0.02, 0.28), 100 * math.pi)
    planes = [drilled("I", 90, 100, 10), drilled("II", 215, 80, 16)]
    for wall in (1.0, 3.0):
        walled = [replace(k, min_wall=1e-3 * wall) for k in planes]
        correction = correct([part], [STEEL], on_z(), start, walled, limits)
        # 20 and 30 mm of disc about the holes, not 148 and 117 through the shaft.
        assert [k.remaining_wall for k in correction.operations] == pytest.approx([0.005, 0.007], abs=1e-6)


def test_limits_that_are_looser_drill_no_more_holes():
    part = two_disc_part()
    start = unbalance_of(part)
    limits = iso_21940_11(6.3, start, (0.02, 0.28), 100 * math.pi)
    numbers = []
    for depth in (20, 40, 60, 72, 74, 90):
        planes = [drilled("I", 90, 100, 8, max_depth=depth), drilled("II", 215, 80, 8, max_depth=min(depth, 75))]
        correction = correct([part], [STEEL], on_z(), start, planes, limits)
        assert correction.within
        numbers.append(len(correction.operations))
    assert numbers == sorted(numbers, reverse=True)


def test_the_plan_aims_lower_where_too_few_parts_are_within_tolerance(tmp_path):
    profile = [(0, 0), (20, 0), (20, 80), (120, 80), (120, 110), (114, 110), (114, 86), (0, 86)]
    fan = cut(round_part(*profile, sides=180), [block([60, -5, 60], np.diag([20.0, 10.0, 60.0]))])
    write_stl([fan], tmp_path / "fan.stl", fan.unit)

    def of_fan(confidence):
        fields = {
            "body": [{"file": "fan.stl", "material": "steel"}],
            "axis": {"bearing_a": [0, 0, 5], "bearing_b": [0, 0, 40]},
            "service": {"rpm": 3000},
            "tolerance": {"grade": 6.3},
            "plane": [
                {"id": name, "z": z, "method": "drill_radial", "diameters": [4, 6, 8]}
                for name, z in (("I", 83), ("II", 98))
            ],
            "uncertainty": {"confidence": confidence},
        }
        return balance(Rotor.from_dict(fields, folder=tmp_path))

    few, many = of_fan(0.5), of_fan(0.95)
    assert 0.5 <= few.scatter.within < 0.95 <= many.scatter.within
    assert (few.verdict.outcome, many.verdict.outcome) == ("pass", "pass")
    assert len(few.correction.operations) < len(many.correction.operations)
