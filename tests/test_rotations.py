"""Attitudes and orientations may be scipy's `Rotation`, and go back into one, in the same order."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import inertia

TURN = Rotation.from_euler("zxz", [0.3, 1.1, -0.7])
SPIN = [0.1, 0.2, 3.0]
TENSOR = np.array([[3.0, 0.2, 0.1], [0.2, 4.0, -0.3], [0.1, -0.3, 5.0]])


def test_a_scene_starts_as_it_says() -> None:
    start = inertia.Start(SPIN, attitude=TURN)  # type: ignore[arg-type]
    assert start.attitude == pytest.approx(TURN.as_quat(), abs=1e-15)
    assert start.typed_attitude.tolist() == TURN.as_quat().tolist()
    run = {"duration": 1.0, "samples": 5}
    tables = [{"attitude": each, "angular_velocity": SPIN} for each in (TURN, TURN.as_quat())]
    scenes = [
        inertia.Scene.from_dict({"body": {"inertia": TENSOR.tolist()}, "start": table, "run": run}) for table in tables
    ]
    runs = [inertia.simulate(scene) for scene in scenes]
    assert np.array_equal(runs[0].attitude, runs[1].attitude)
    back = Rotation.from_quat(runs[0].attitude)
    vector = back.apply([1.0, 2.0, 3.0])
    assert inertia.quaternion.to_space(back, [1.0, 2.0, 3.0]) == pytest.approx(vector, abs=1e-14)


def test_quaternions_angles_and_variables_take_it() -> None:
    q = TURN.as_quat()
    assert inertia.quaternion.multiply(TURN, TURN) == pytest.approx((TURN * TURN).as_quat(), abs=1e-15)
    assert inertia.quaternion.conjugate(TURN).tolist() == inertia.quaternion.conjugate(q).tolist()
    assert inertia.quaternion.matrix(TURN) == pytest.approx(TURN.as_matrix(), abs=1e-15)
    assert inertia.quaternion.angle_between(TURN, Rotation.identity()) == pytest.approx(TURN.magnitude(), rel=1e-14)
    assert inertia.euler_angles.to_angles(TURN).tolist() == inertia.euler_angles.to_angles(q).tolist()
    assert inertia.andoyer.to_andoyer(TURN, SPIN) is not None


def test_tensors_and_parts_of_assemblies_are_turned_by_it() -> None:
    turned = inertia.reexpress(TENSOR, TURN)
    matrix = TURN.as_matrix()
    assert turned == pytest.approx(matrix.T @ TENSOR @ matrix, abs=1e-14)
    part = {"name": "a", "mass": 2.0, "inertia": TENSOR.tolist(), "quaternion": TURN}
    whole = inertia.Assembly.from_dict({"unit": "m", "part": [part]}).mass_properties()
    assert whole.inertia == pytest.approx(matrix @ TENSOR @ matrix.T, abs=1e-13)


def test_models_start_as_it_says() -> None:
    top = [inertia.solve_heavy_top((1.0, 0.5), 2.0, start, SPIN, [0.0, 1.0]) for start in (TURN, TURN.as_quat())]
    assert np.array_equal(top[0].attitude, top[1].attitude)


def test_what_turns_many_ways_is_no_attitude_of_one_body() -> None:
    with pytest.raises(inertia.UsageError, match=r"start\.attitude"):
        inertia.Start(SPIN, attitude=Rotation.identity(3))  # type: ignore[arg-type]
