import cmath
import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.balancing.corrections.workpieces import drilled

from inertia.balancing.corrections.correction_plane import (
    CorrectionPlane,
    KitWeight,
    Sector,
    angle_of,
    evenly,
    point_length,
)
from inertia.errors import UsageError

DRILLS = drilled("I", 90, 100, 8, 12, max_depth=20)
AXIAL = CorrectionPlane("I", 0.1, "drill_axial", 0.07, diameters=(0.01,), face="b", max_depth=0.02)
KIT = CorrectionPlane("I", 0.1, "kit", 0.07, angles=evenly(6), kit=(KitWeight("M6", 0.01),))


@given(st.floats(0, 6.28), st.floats(0.01, 5), st.floats(0, 6.28), st.floats(0, 0.3))
def test_a_tool_meets_a_sector_where_it_is_nearer_than_its_reach(start, width, angle, margin):
    away = abs(cmath.phase(cmath.exp(1j * (angle - start - width / 2)))) - width / 2 - margin
    if abs(away) > 1e-6:
        assert Sector(start, (start + width) % (2 * math.pi)).meets(angle, margin) == (away < 0)


def test_a_sector_through_zero_forbids_both_sides_of_it():
    sector = Sector(math.radians(350), math.radians(10))
    assert [sector.meets(math.radians(k)) for k in (345, 355, 0, 5, 15, 180)] == [False, True, True, True, False, False]


def test_positions_are_the_angles_that_no_sector_forbids():
    plane = replace(KIT, forbidden=(Sector(math.radians(50), math.radians(130)),))
    assert [round(math.degrees(k)) for k in plane.positions] == [0, 180, 240, 300]


def test_angles_run_from_0_up_to_360():
    assert angle_of(0j) == 0
    assert 0 <= angle_of(complex(1, -1e-20)) < 2 * math.pi
    assert angle_of(-1j) == pytest.approx(1.5 * math.pi)


def test_point_length():
    assert point_length(2.0, math.radians(90)) == pytest.approx(1.0)
    assert point_length(2.0, math.pi) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("plane", "changes", "message"),
    [
        (DRILLS, {"method": "glue"}, "plane 'I': method is 'glue': use one of add, remove, drill_radial"),
        (DRILLS, {"z": math.nan}, "z is nan m: give a finite place"),
        (DRILLS, {"radius": 0.0}, "radius is 0.0: it must be positive"),
        (DRILLS, {"depth_step": -1.0}, "depth_step is -1.0: it must be finite and not negative"),
        (DRILLS, {"diameters": ()}, "no drill is given: give their diameters"),
        (DRILLS, {"diameters": (0.01, -0.01)}, "diameters names -0.01 m"),
        (DRILLS, {"diameters": (0.3,)}, "a drill of 300 mm is wider than the part of radius 100 mm: take it out"),
        (DRILLS, {"max_depth": 0.098}, "a drill of 8 mm reaches 100.4 mm deep with its point, past the shaft's axis"),
        (DRILLS, {"point_angle": 0.0}, "point_angle is 0.0 rad"),
        (DRILLS, {"through": True}, "only axial holes can go through"),
        (DRILLS, {"angles": ()}, "angles is empty"),
        (
            DRILLS,
            {"angles": (0.1,), "forbidden": (Sector(0, 1),)},
            "every one of its angles lies in a forbidden sector",
        ),
        (AXIAL, {"face": None}, "face is None: say whether axial holes enter the face to bearing 'a' or 'b'"),
        (AXIAL, {"method": "mill"}, "a milled flat has no width"),
        (AXIAL, {"method": "mill", "width": 0.01, "max_depth": 0.07}, "max_depth 0.07 m reaches the shaft's axis"),
        (KIT, {"kit": ()}, "its kit is empty: give the masses"),
        (KIT, {"angles": "free"}, "a kit is used at free angles: give the positions"),
        (KIT, {"kit": (KitWeight("M6", 0.0),)}, "kit weight 'M6' is 0.0 kg"),
        (KIT, {"most_per_position": 0}, "most_per_position is 0"),
    ],
)
def test_refuses_in_one_line_with_the_field_and_the_remedy(plane, changes, message):
    with pytest.raises(UsageError) as caught:
        replace(plane, **changes)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_evenly_refuses_no_angles():
    with pytest.raises(UsageError, match="number of angles around the shaft is 0"):
        evenly(0)
