"""The symmetric-top splitting: its coefficients, and what it keeps over a million steps."""

import numpy as np
import pytest
from tests.dynamics.integrators.loaded import ARM, ATTITUDE, MASS, MOMENTS, SPIN, TIMES, case, rotations

from inertia.dynamics.integrators.loop import States
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.splitting import COMPOSITIONS, Splitting
from inertia.dynamics.loads.losses import Dissipation
from inertia.errors import UsageError

MILLION = 1_000_000


@pytest.mark.parametrize("order", COMPOSITIONS)
def test_compositions_are_symmetric_and_make_one_step(order: int) -> None:
    pairs = COMPOSITIONS[order]
    assert pairs.sum() == pytest.approx(1.0, abs=1e-15)
    assert (pairs == pairs[::-1, ::-1]).all()


def million_steps(order: int, problem: RotationProblem, step: float) -> States:
    run = Splitting(order).run(problem, np.linspace(0.0, MILLION * step, 1001), step)
    assert run.steps >= MILLION
    return run


def momentum_of(run: States) -> np.ndarray:
    """Return L = R I ω in space, (n, 3)."""
    return np.einsum("nij,nj->ni", rotations(run.attitude), MOMENTS * run.angular_velocity)


def kinetic(run: States) -> np.ndarray:
    return 0.5 * (MOMENTS * run.angular_velocity**2).sum(axis=1)


@pytest.mark.parametrize("order", [2, 4])
def test_momentum_of_a_free_body_is_kept_over_a_million_steps(order: int, compiled: None) -> None:
    run = million_steps(order, RotationProblem(MOMENTS, SPIN, ATTITUDE), 0.05)
    momentum = momentum_of(run)
    size = np.linalg.norm(momentum[0])
    assert np.abs(np.linalg.norm(momentum, axis=1) / size - 1).max() < 1e-12
    assert np.linalg.norm(momentum - momentum[0], axis=1).max() < 1e-10 * size
    assert_error_does_not_grow(kinetic(run))


def test_energy_of_a_heavy_body_is_kept_over_a_million_steps(compiled: None) -> None:
    run = million_steps(2, case("heavy").problem, 0.02)
    height = rotations(run.attitude)[:, 2] @ ARM
    assert_error_does_not_grow(kinetic(run) + MASS * 9.8 * height)
    upright = momentum_of(run)[:, 2]
    assert np.abs(upright - upright[0]).max() < 1e-11


def assert_error_does_not_grow(energy: np.ndarray) -> None:
    off = np.abs(energy / energy[0] - 1)
    assert off[-200:].max() < 1.5 * off[:200].max() + 1e-12


def test_dissipation_is_refused() -> None:
    with pytest.raises(UsageError, match="no exact flow for internal dissipation: use Taylor"):
        Splitting(2).run(RotationProblem(MOMENTS, SPIN, loads=(Dissipation(0.1),)), TIMES, 0.1)
