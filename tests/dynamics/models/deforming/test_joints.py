"""Joints follow their keyframes; parts and keyframes that cannot be used are named."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dynamics.models.deforming.particles import value

from inertia.dynamics.models.deforming.joints import Joint, JointedPart
from inertia.errors import GeometryError, UsageError

X = [1.0, 0.0, 0.0]
numbers = st.floats(-10, 10, allow_subnormal=False)


@st.composite
def hinges(draw: st.DrawFn, shortest: float = 0.1) -> Joint:
    gaps = draw(st.lists(st.floats(shortest, 3), min_size=1, max_size=5))
    columns = [draw(st.lists(numbers, min_size=len(gaps), max_size=len(gaps))) for _ in range(2)]
    return Joint(axis=X, times=np.cumsum(gaps), angles=columns[0], rates=columns[1])


@settings(deadline=None)
@given(hinges())
def test_a_joint_is_at_its_keyframes_with_the_rates_stated(joint: Joint) -> None:
    angle, rate = joint.at(joint.times)
    np.testing.assert_allclose(angle, joint.angles, atol=1e-13)
    np.testing.assert_allclose(rate, joint.rates, atol=1e-11)


@settings(deadline=None, max_examples=30)
@given(hinges(), st.floats(-2, 20))
def test_angle_and_rate_are_those_of_the_hermite_quintic(joint: Joint, time: float) -> None:
    angle, rate = joint.at([time])
    with mpmath.workdps(40):
        tick = mpmath.mpf(10) ** -15
        true = value(joint, mpmath.mpf(time))
        slope = (value(joint, time + tick) - value(joint, time - tick)) / (2 * tick)
    size = 1.0 + abs(time) + np.abs(joint.angles).max()
    assert abs(angle[0] - float(true)) < 1e-14 * 100 * size
    assert abs(rate[0] - float(slope)) < 1e-13 * 100 * size


@settings(deadline=None)
@given(hinges(shortest=0.5))
def test_rates_and_accelerations_do_not_jump_at_keyframes(joint: Joint) -> None:
    tick = 1e-6
    (_, before), (_, at), (_, after) = (joint.at(joint.times + k * tick) for k in (-1, 0, 1))
    # Jerk: at most 60 Δ/T³ + 60 v/T², here 1.2e4; a jump of the acceleration by 0.1 would show.
    assert np.abs(after - before).max() < 2e4 * tick**2
    assert np.abs(at - before).max() < 2e4 * tick**2


def test_without_rates_the_motion_is_of_minimum_jerk() -> None:
    s = np.linspace(0, 1, 11)
    angle, rate = Joint(axis=X, times=[2.0, 4.0], angles=[1.0, 4.0]).at(2.0 + 2.0 * s)
    np.testing.assert_allclose(angle, 1.0 + 3.0 * (10 * s**3 - 15 * s**4 + 6 * s**5), atol=1e-14)
    np.testing.assert_allclose(rate, 1.5 * 30 * s**2 * (1 - s) ** 2, atol=1e-14)


def test_a_joint_rests_outside_its_keyframes_or_goes_on_at_the_rate_it_has() -> None:
    rests = Joint(axis=X, times=[1.0, 2.0], angles=[0.5, 3.0])
    assert [x.tolist() for x in rests.at([0.0, 5.0])] == [[0.5, 3.0], [0.0, 0.0]]
    goes = Joint(axis=X, times=[1.0, 2.0], angles=[0.5, 3.0], rates=[1.0, -2.0])
    assert [x.tolist() for x in goes.at([0.0, 5.0])] == [[-0.5, -3.0], [1.0, -2.0]]


def test_a_single_keyframe_is_a_fixed_angle_or_a_wheel() -> None:
    assert not Joint(axis=X, times=[1.0], angles=[0.5]).moves
    wheel = Joint(axis=X, times=[1.0], angles=[0.5], rates=[2.0])
    assert wheel.moves
    assert [x.tolist() for x in wheel.at([0.0, 3.0])] == [[-1.5, 4.5], [2.0, 2.0]]


def test_the_length_of_an_axis_means_nothing() -> None:
    assert Joint(axis=[0, 3, 4], times=[0], angles=[0]).axis.tolist() == [0.0, 0.6, 0.8]


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"times": [0, 2, 1]}, r"joint\.times\[2\] is 1 s, not after the 2 s before it"),
        ({"times": [0, 1, 1]}, r"joint\.times\[2\] is 1 s, not after"),
        ({"times": [0, float("nan"), 1]}, r"joint\.times\[1\] is nan: it must be finite"),
        ({"times": []}, r"joint\.times is empty: give one keyframe or more"),
        ({"times": 3.0}, r"joint\.times must be a list"),
        ({"angles": [0, 1]}, r"joint\.angles has 2 entries for 3 times"),
        ({"angles": [0, float("inf"), 1]}, r"joint\.angles\[1\] is inf"),
        ({"angles": [0, "up", 1]}, r"joint\.angles\[1\] is 'up'"),
        ({"rates": [0, 1]}, r"joint\.rates has 2 entries for 3 times"),
        ({"axis": [0, 0, 0]}, r"joint\.axis is \[0\.0, 0\.0, 0\.0\]: it must have a direction"),
        ({"axis": [0, 1]}, r"joint\.axis has 2 entries"),
        ({"point": [0, 1, float("nan")]}, r"joint\.point\[2\] is nan"),
        ({"angles": None}, r"joint has neither angles nor displacements"),
        ({"displacements": [0, 1, 2]}, r"joint has both"),
    ],
)
def test_a_joint_that_cannot_be_used_is_refused_naming_the_entry(fields: dict[str, object], says: str) -> None:
    good = {"axis": X, "times": [0.0, 1.0, 2.0], "angles": [0.0, 1.0, 2.0]}
    Joint(**good)
    with pytest.raises(UsageError, match=says):
        Joint(**good | fields)


def test_a_part_that_cannot_be_is_refused_by_name() -> None:
    with pytest.raises(GeometryError, match=r'part "arm"\.inertia is not physical: .* triangle rule'):
        JointedPart("arm", 1.0, np.diag([1.0, 1.0, 3.0]))
    with pytest.raises(UsageError, match=r'part "arm"\.mass is 0\.0: it must be positive'):
        JointedPart("arm", 0.0, np.eye(3))
    with pytest.raises(UsageError, match=r'part "arm"\.center_of_mass\[1\] is nan'):
        JointedPart("arm", 1.0, np.eye(3), [0, float("nan"), 0])
    with pytest.raises(UsageError, match=r'part "arm"\.parent is missing'):
        JointedPart("arm", 1.0, np.eye(3), joints=(Joint(axis=X, times=[0], angles=[0]),))
