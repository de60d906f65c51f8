"""SciPy's methods against the oracle, and DOP853 by a kernel against SciPy's."""

from dataclasses import replace

import numpy as np
import pytest
from tests.dynamics.integrators.loaded import LOADS, TIMES, case

from inertia import GeometryError
from inertia.dynamics.integrators.scipy_methods import SciPy
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.sliding.equations import SlidingBall
from inertia.native import Kernel

BALL = SlidingBall(
    moments=[1.7e-6, 2e-6, 2.3e-6],
    angular_velocity=[10.0, -20.0, 160.0],
    attitude=quaternion.from_rotation_vector([0.1, 0.0, 0.0]),
    mass=0.015,
    arm=np.array([0.001, -0.002, 0.003]),
    radius=0.018,
    friction=0.3,
    slip_speed=0.02,
    gravity=np.array([0.5, -1.0, -9.8]),
    velocity=np.array([0.2, -0.1]),
)
SPAN = np.array([0.0, 1e-9, 0.01, 0.01, 0.0100001, 0.5])
JAMS = replace(
    BALL,
    moments=[1.31e-6, 0.61e-6, 0.18e-6],
    angular_velocity=[26.0, 19.0, -30.0],
    attitude=[-2.3, -0.2, -1.2, -0.7],
    arm=np.array([-0.0087, 0.0056, 0.0074]),
    friction=2.8,
    slip_speed=0.1,
    velocity=np.array([1.4, 0.3]),
)


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("scipy", ["DOP853", "LSODA", "Radau"])
def test_error_follows_the_tolerance(scipy: str, name: str) -> None:
    known = case(name)
    runs = [SciPy(scipy).run(known.problem, TIMES, tolerance) for tolerance in (1e-5, 1e-8)]
    loose, tight = (known.truth.attitude_error(run.attitude).max() for run in runs)
    assert tight < 1e-6
    assert tight < loose < 3e-3


@pytest.mark.parametrize("level", [0, 2])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_kernel_takes_the_steps_of_scipy(
    friction: float, tolerance: float, level: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = []
    for native in (True, False):
        monkeypatch.setattr(Kernel, "worthwhile", lambda self, count, native=native: native)
        runs.append(SciPy("DOP853").run(replace(BALL, friction=friction), SPAN, tolerance, level))
    compiled, scipy = runs
    assert compiled.steps == pytest.approx(scipy.steps, rel=0.02)
    assert compiled.apart(scipy) < 1e-11
    np.testing.assert_allclose(compiled.angular_velocity, scipy.angular_velocity, rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(compiled.carried, scipy.carried, rtol=1e-10, atol=1e-12)


def test_a_ball_that_jams_is_refused_with_the_same_words(path: str) -> None:
    with pytest.raises(
        GeometryError, match=r"the friction, 2.8, jams .* \(Painlevé's paradox\) about t = 0.00645\d* s; take"
    ):
        SciPy("DOP853").run(JAMS, SPAN, 1e-9)


@pytest.mark.usefixtures("compiled")
def test_a_motion_that_leaves_float64_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"DOP853 stopped between 0 and 0\.5 s \(.*spacing"):
        SciPy("DOP853").run(replace(BALL, friction=np.nan), SPAN, 1e-9)
