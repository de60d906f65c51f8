"""The classical Runge–Kutta method: one step by hand, what it keeps, and the steps that it refuses."""

import mpmath
import numpy as np
import pytest
from tests.dynamics.integrators.loaded import ATTITUDE, MOMENTS, SPIN, TIMES, case

from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.runge_kutta import RungeKutta4
from inertia.errors import GeometryError


def test_four_steps_are_those_of_the_classical_tableau(path: str) -> None:
    """k₁ … k₄ of Euler's equations without a load, in 30 digits; the spin alone, which needs no attitude."""
    with mpmath.workdps(30):
        a, b, c = (mpmath.mpf(i) for i in MOMENTS)
        spin, h = mpmath.matrix([mpmath.mpf(x) for x in SPIN]), mpmath.mpf(0.2) / 4

        def rate(w: mpmath.matrix) -> mpmath.matrix:
            return mpmath.matrix([(b - c) / a * w[1] * w[2], (c - a) / b * w[2] * w[0], (a - b) / c * w[0] * w[1]])

        for _ in range(4):
            k1 = rate(spin)
            k2 = rate(spin + h / 2 * k1)
            k3 = rate(spin + h / 2 * k2)
            k4 = rate(spin + h * k3)
            spin += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        run = RungeKutta4().run(RotationProblem(MOMENTS, SPIN, ATTITUDE), np.array([0.2]), 0.05)
    assert run.steps == 4
    assert run.angular_velocity[0] == pytest.approx([float(x) for x in spin], rel=1e-15)


def test_energy_of_a_free_body_is_kept_over_many_steps(compiled: None) -> None:
    problem = RotationProblem(MOMENTS, SPIN, ATTITUDE)
    run = RungeKutta4().run(problem, np.linspace(0.0, 2000.0, 101), 0.002)
    energy = 0.5 * (MOMENTS * run.angular_velocity**2).sum(axis=1)
    assert np.abs(energy / energy[0] - 1).max() < 1e-9


def test_a_run_of_too_many_steps_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"RK4 needs 5e\+09 steps"):
        RungeKutta4().run(case("free").problem, TIMES, 1e-9)
