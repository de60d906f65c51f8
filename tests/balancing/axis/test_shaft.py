"""The shaft's axes, its places along z, and what it refuses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia import UsageError
from inertia.balancing.axis.shaft import Shaft

COORDINATE = st.floats(-2, 2).map(lambda x: round(x, 6))
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE)


def test_along_the_parts_own_z_axis_places_are_the_parts_own():
    shaft = Shaft([0, 0, 0.02], [0, 0, 0.28], [1, 0, 0])
    assert (shaft.axes == np.eye(3)).all()
    assert (shaft.z_a, shaft.z_b, shaft.z_of([5, 7, 0.09])) == (0.02, 0.28, 0.09)


def test_z_points_from_a_to_b_and_the_axes_follow_the_right_hand():
    shaft = Shaft([0.1, 0, 0], [-0.3, 0, 0], [5, 0, 2])
    np.testing.assert_allclose(shaft.axes, [[0, 0, -1], [0, 1, 0], [1, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(shaft.axes), 1)
    assert (shaft.z_a, shaft.z_b) == (-0.1, 0.3)


@settings(deadline=None, max_examples=60)
@given(POINT, POINT, POINT, POINT)
def test_to_the_shaft_and_back_is_the_same_point(a, b, mark, point):
    across = np.cross(np.subtract(b, a), mark)
    if np.linalg.norm(np.subtract(b, a)) < 1e-2 or np.linalg.norm(across) < 1e-3:
        return
    shaft = Shaft(a, b, mark)
    local = shaft.to_shaft(point)
    np.testing.assert_allclose(shaft.to_part(local), point, atol=1e-13)
    assert local[2] == pytest.approx(shaft.z_of(point), abs=1e-13)
    # The distance from the line through A and B, by the cross product.
    along = np.subtract(b, a) / np.linalg.norm(np.subtract(b, a))
    distance = np.linalg.norm(np.cross(np.subtract(point, a), along))
    assert np.hypot(*local[:2]) == pytest.approx(distance, abs=1e-12)


def test_angles_are_counter_clockwise_seen_from_b():
    shaft = Shaft([0, 0, 0], [0, 1, 0], [0, 0, 1])  # along y, 0° at z: 90° is x, as seen from +y
    np.testing.assert_allclose(shaft.place(0.5, 2.0, np.pi / 2), [2, 0.5, 0], atol=1e-15)


@pytest.mark.parametrize(
    ("a", "b", "mark", "says"),
    [
        ([1, 2, 3], [1, 2, 3], [1, 0, 0], r"0 mm apart at \(1000, 2000, 3000\) mm.*two separate bearings"),
        ([0, 0, 0], [0, 0, 0], [1, 0, 0], "0 mm apart"),
        ([1e6, 0, 0], [1e6, 0, 1e-4], [1, 0, 0], "apart"),
        ([0, 0, 0], [0, 0, 1], [0, 0, -3], "zero_mark .* along the shaft.*across the shaft"),
        ([0, 0, 0], [0, 0, 1], [0, 0, 0], "zero_mark has no length"),
        ([0, 0], [0, 0, 1], [1, 0, 0], "bearing_a must have shape"),
        ([0, 0, 0], [0, np.nan, 1], [1, 0, 0], "bearing_b .* not finite"),
    ],
)
def test_what_gives_no_axis_is_refused(a, b, mark, says):
    with pytest.raises(UsageError, match=says):
        Shaft(a, b, mark)


def test_a_sense_of_rotation_that_is_none_is_refused():
    with pytest.raises(UsageError, match="'ccw' or 'cw', seen from B"):
        Shaft([0, 0, 0], [0, 0, 1], [1, 0, 0], "clockwise")
    assert Shaft([0, 0, 0], [0, 0, 1], [1, 0, 0], "cw").turn == -1
