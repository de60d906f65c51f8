"""A million bodies are a body a million times."""

import numpy as np
import pytest

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.free import ensemble
from inertia.dynamics.models.free.ensemble import free_ensemble
from inertia.dynamics.models.free.motion import free_motion
from inertia.errors import GeometryError, UsageError

TIMES = [0.0, 10.0, 1e6]


def bodies(count: int) -> tuple[np.ndarray, np.ndarray]:
    chance = np.random.default_rng(7)
    second = chance.random((count, 3)) + 0.01
    return second.sum(axis=-1, keepdims=True) - second, chance.normal(size=(count, 3))


def test_each_body_moves_as_it_does_alone() -> None:
    moments, spins = bodies(2 * ensemble.BLOCK + 100)
    attitude, omega = free_ensemble(moments, spins, TIMES)
    assert attitude.shape == (len(spins), 3, 4)
    for k in (0, 1, ensemble.BLOCK - 1, ensemble.BLOCK, len(spins) - 1):
        alone = free_motion(moments[k], spins[k], TIMES)
        assert quaternion.angle_between(attitude[k], alone[0]).max() < 3e-15
        assert omega[k] == pytest.approx(alone[1], abs=3e-15)


def test_momentum_in_space_is_kept_by_all() -> None:
    moments, spins = bodies(5000)
    attitude, omega = free_ensemble(moments, spins, TIMES)
    momentum = quaternion.to_space(attitude, moments[:, None] * omega)
    drift = np.linalg.norm(momentum - (moments * spins)[:, None], axis=-1)
    assert (drift / np.linalg.norm(moments * spins, axis=-1)[:, None]).max() < 4e-15


def test_one_body_with_many_spins_and_progress() -> None:
    _, spins = bodies(ensemble.BLOCK + 1)
    told: list[float] = []
    _, omega = free_ensemble((1.0, 2.0, 2.5), spins, [0.0], told.append)
    assert omega[:, 0] == pytest.approx(spins, abs=3e-15)
    assert told == [pytest.approx(ensemble.BLOCK / len(spins)), 1.0]


@pytest.mark.parametrize(
    ("moments", "spins", "time"),
    [
        ((1, 2, 3), (1, 0, 0), [1.0]),
        ((1, 2, 3), [(1, 0, 0)], 1.0),
        ([(1, 2, 3)], [(1, 0, 0)] * 2, [1.0]),
    ],
)
def test_shapes_that_are_no_ensemble_are_refused(moments: object, spins: object, time: object) -> None:
    with pytest.raises(UsageError, match="an ensemble takes"):
        free_ensemble(moments, spins, time)  # type: ignore[arg-type]


def test_a_body_that_cannot_be_is_named() -> None:
    moments, spins = bodies(10)
    moments[7] = 1.0, 1.0, 3.0
    with pytest.raises(GeometryError, match=r"moments\[7\]"):
        free_ensemble(moments, spins, TIMES)
