"""The smallest model that a scene needs, and the sentences that say why."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dynamics.scenes import DISC, PLAIN, TOP, scene

from inertia.dynamics.plan import SHARE, plan
from inertia.errors import UsageError


@pytest.mark.parametrize(
    ("moments", "spin", "model"),
    [
        ([2, 2, 2], [1, 2, 3], "spherical top"),
        ([1, 2, 3], [0, 0, 3], "steady axis"),
        ([1, 2, 3], [0, 2, 0], "steady axis"),
        ([1, 1, 2], [1, 0, 3], "symmetric top"),
        ([2, 1, 1], [1, 0, 3], "symmetric top"),
        ([1, 1, 2], [1, 3, 0], "steady axis"),  # across the axis of symmetry every axis is principal
        ([1, 2, 3], [1, 2, 3], "asymmetric top"),
        ([3, 1, 2], [1, 2, 3], "asymmetric top"),
    ],
)
def test_a_free_body_takes_the_smallest_model(moments: list, spin: list, model: str) -> None:
    selection = plan(scene(body={"principal_moments": moments}, start__angular_velocity=spin))
    assert selection.model == model
    assert "no torque acts" in selection.why[0]


@pytest.mark.parametrize(
    ("loads", "noun"),
    [
        ([{"kind": "torque", "torque": [0, 0, 1]}], "an applied torque"),
        ([{"kind": "damping", "coefficient": 0.1}], "damping"),
        ([{"kind": "dissipation", "rate": 0.1}], "energy lost inside the body"),
        ([{"kind": "gravity_gradient", "mu": 4e14, "position": [7e6, 0, 0]}], "the gravity gradient"),
        (
            [{"kind": "damping", "coefficient": 0.1}, {"kind": "torque", "torque": [0, 0, 1]}],
            "damping and an applied torque",
        ),
    ],
)
def test_loads_that_have_no_closed_form_are_integrated(loads: list, noun: str) -> None:
    selection = plan(scene(load=loads))
    assert selection.model == "Euler equations"
    assert f"There is no closed form for {noun}:" in selection.why[-1]


NO_TORQUE = {"kind": "torque", "torque": [0, 0, 0]}


@pytest.mark.parametrize(
    "loads",
    [
        [NO_TORQUE],
        [{"kind": "torque", "table": [[0, 0, 0, 0], [1e9, 0, 0, 0]]}],
        [{"kind": "damping", "coefficient": 0.0}],
        [{"kind": "dissipation", "rate": 0.0}],
        [{"kind": "gravity", "acceleration": [0, 0, 0]}],
        [{"kind": "torque", "torque": [0.1, 0.2, 0.3]}, {"kind": "torque", "torque": [-0.1, -0.2, -0.3]}],
        [
            {"kind": "torque", "torque": [1, 0, 0], "frame": "space"},
            {"kind": "torque", "torque": [-1, 0, 0], "frame": "space"},
        ],
    ],
)
def test_loads_that_are_zero_are_none(loads: list) -> None:
    selection = plan(scene(load=loads, run__duration=1e5))
    assert selection.model == "asymmetric top"
    assert "no torque acts (the loads are zero, or add up to zero)" in selection.why[0]


@pytest.mark.parametrize(
    "loads",
    [
        [{"kind": "torque", "torque": [1, 0, 0]}, {"kind": "torque", "torque": [-1, 0, 0], "frame": "space"}],
        [{"kind": "torque", "torque": [0, 0, 1e-60]}],
        [{"kind": "torque", "torque": lambda time, attitude, spin: [0.0, 0.0, 0.0]}],
    ],
)
def test_loads_that_may_be_something_are_integrated(loads: list) -> None:
    assert plan(scene(load=loads)).model == "Euler equations"


def test_a_body_at_rest_under_no_torque_is_refused() -> None:
    with pytest.raises(UsageError, match="nothing makes the body turn"):
        scene(start__angular_velocity=[0, 0, 0], load=[NO_TORQUE])


def test_gravity_leaves_the_rotation_of_a_free_body_alone() -> None:
    selection = plan(scene(load=[{"kind": "gravity"}]))
    assert selection.model == "asymmetric top"
    assert "parabola" in selection.why[0]


@pytest.mark.parametrize(
    ("changes", "model"),
    [
        ({}, "heavy symmetric top"),
        ({"load": []}, "steady axis"),
        ({"constraint__point": [0, 0, 0.04]}, "steady axis"),  # held at the centre of mass
        ({"body__center_of_mass": [0.04, 0, 0]}, "Euler equations"),
        ({"body__principal_moments": [2e-4, 2.2e-4, 1.25e-4]}, "Euler equations"),
        ({"load": [{"kind": "gravity"}, {"kind": "damping", "coefficient": 1e-6}]}, "Euler equations"),
    ],
)
def test_a_body_on_a_fixed_point(changes: dict, model: str) -> None:
    assert plan(scene(TOP, **changes)).model == model


def test_the_moments_are_those_about_the_fixed_point_with_the_weight_on_axis_3() -> None:
    hung = scene(TOP, body__principal_moments=[1.25e-4, 2e-4, 2e-4], body__center_of_mass=[-0.04, 0, 0])
    selection = plan(hung)
    assert selection.model == "heavy symmetric top"
    np.testing.assert_allclose(selection.moments, [3.6e-4, 3.6e-4, 1.25e-4], rtol=1e-14)  # 2e-4 + 0.1 · 0.04²
    np.testing.assert_allclose(selection.axes[:, 2], [-1, 0, 0], atol=1e-15)
    assert np.linalg.det(selection.axes) == pytest.approx(1)


def test_a_ball_on_a_stem_is_a_heavy_symmetric_top() -> None:
    # Two fifths m r² at the centre of mass, m d² more across the stem to the fixed point.
    ball = {"principal_moments": [4e-5] * 3, "mass": 0.1, "center_of_mass": [0.01, 0.02, 0.02]}
    selection = plan(scene(TOP, body=ball))
    assert selection.model == "heavy symmetric top"
    np.testing.assert_allclose(selection.axes[:, 2], [1 / 3, 2 / 3, 2 / 3], atol=1e-15)
    np.testing.assert_allclose(selection.moments, [1.3e-4, 1.3e-4, 4e-5], rtol=1e-14)


@pytest.mark.parametrize(("duration", "model"), [(1.0, "symmetric top"), (1e4, "asymmetric top")])
def test_nearly_equal_moments_count_as_equal_while_that_is_accurate_enough(duration: float, model: str) -> None:
    # δ |ω| T = 1e-9 · 3.74 · T rad, where 1e-7 rad are asked for.
    nearly = {"principal_moments": [1.0, 1.0 + 1e-9, 2.0]}
    selection = plan(scene(body=nearly, start__angular_velocity=[1, 2, 3], run__duration=duration, run__accuracy=1e-7))
    assert selection.model == model
    message = " ".join(selection.why)
    assert ("costs about 4e-09 rad in 1 s" in message) == (model == "symmetric top")
    assert ("differ by 1e-09 only, but that would cost about 4e-05 rad" in message) == (model == "asymmetric top")


def test_a_spin_that_is_nearly_along_an_axis_counts_as_along_it_unless_the_axis_is_unstable() -> None:
    calm = scene(start__angular_velocity=[0, 1e-13, 1], run__accuracy=1e-10)
    assert plan(calm).model == "steady axis"
    # About axis 2 the wobble grows by exp(10 · √(1·1/(1·3))) = 320; ten times longer it takes over.
    assert plan(scene(start__angular_velocity=[0, 1, 1e-15], run__accuracy=1e-10)).model == "steady axis"
    late = scene(start__angular_velocity=[0, 1, 1e-15], run__accuracy=1e-10, run__duration=100)
    assert plan(late).model == "asymmetric top"


positive = st.floats(0.5, 1.0)


@given(
    st.tuples(positive, positive, positive),
    st.tuples(*[st.floats(-10, 10)] * 3).filter(lambda spin: max(map(abs, spin)) > 1e-3),
    st.floats(1e-3, 1e6),
    st.sampled_from([1e-14, 1e-10, 1e-6, 1e-2]),
)
@settings(deadline=None, max_examples=50)
def test_a_model_never_costs_more_than_its_share(moments: tuple, spin: tuple, duration: float, accuracy: float) -> None:
    run = {"duration": duration, "accuracy": accuracy}
    selection = plan(scene(body={"principal_moments": list(moments)}, start__angular_velocity=list(spin), run=run))
    assert selection.candidate.cost <= SHARE * accuracy
    assert sorted(selection.moments) == pytest.approx(sorted(moments))
    np.testing.assert_allclose(selection.axes.T @ selection.axes, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("model", ["asymmetric top", "Euler equations"])
def test_a_larger_model_may_be_forced(model: str) -> None:
    selection = plan(scene(body={"principal_moments": [1, 1, 2]}, run__model=model))
    assert selection.model == model
    assert selection.why[-1] == "The scene asks for this model."


def test_a_method_makes_the_run_a_stepped_one() -> None:
    selection = plan(scene(run__method="DOP853"))
    assert (selection.model, selection.method) == ("Euler equations", "DOP853")
    assert selection.why[-1] == "The scene asks for this method."


@pytest.mark.parametrize(
    ("base", "changes", "message"),
    [
        (
            PLAIN,
            {"run__model": "spherical top"},
            "run.model is 'spherical top', which would be off by about a whole turn",
        ),
        (
            PLAIN,
            {"run__model": "heavy symmetric top"},
            "which does not describe this scene: use one of 'spherical top'",
        ),
        (PLAIN, {"run__model": "asymetric top"}, "which is unknown: did you mean 'asymmetric top'?"),
        (PLAIN, {"run__method": "DOP85"}, "run.method is 'DOP85', which is unknown: did you mean 'DOP853'?"),
        (PLAIN, {"run__model": "asymmetric top", "run__method": "DOP853"}, "is a closed form: leave one of them out"),
        (TOP, {"run__model": "asymmetric top"}, "'asymmetric top', which does not describe this scene"),
        (DISC, {"run__model": "Euler equations"}, "does not describe this scene: use one of 'rolling body'"),
        (DISC, {"run__method": "Taylor"}, "run.method is 'Taylor', which is unknown"),
        (DISC, {"body__principal_moments": [0.25, 0.26, 0.5]}, "off by 0.028 of its smallest moment, 0.2 rad"),
        (DISC, {"body__principal_moments": [0.4] * 3}, "constraint.axis is missing: the moments are all equal"),
    ],
)
def test_a_model_that_is_wrong_for_the_scene_is_refused(base: dict, changes: dict, message: str) -> None:
    with pytest.raises(UsageError) as caught:
        plan(scene(base, **changes))
    assert message in str(caught.value)
    assert str(caught.value).startswith("the scene: ")


def test_a_ball_rolls_about_the_axis_that_the_scene_names() -> None:
    selection = plan(scene(DISC, body__principal_moments=[0.4] * 3, constraint__axis=[0, 3, -4]))
    assert selection.model == "rolling body"
    np.testing.assert_allclose(selection.axes[:, 2], [0, 0.6, -0.8], atol=1e-15)
    assert np.linalg.det(selection.axes) == pytest.approx(1)


def test_a_named_axis_that_is_none_of_revolution_is_refused() -> None:
    with pytest.raises(UsageError, match=r"takes a body of revolution.* as constraint.axis, \[0, 0, 1\]$"):
        plan(scene(DISC, constraint__axis=[0, 1, 0]))


def test_gravity_too_weak_to_matter_leaves_a_held_body_free() -> None:
    weak = scene(TOP, body__center_of_mass=[0, 0, 1e-19], start__angular_velocity=[1, 0, 150])
    selection = plan(weak)
    assert selection.model == "symmetric top"
    assert selection.candidate.unseen == pytest.approx(0.5 * 0.1 * 9.80665 * 1e-19 / 1.25e-4)
