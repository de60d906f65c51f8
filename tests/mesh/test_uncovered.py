"""What a union uncovers: the chord that is left bounds as much as that of all that was there."""

import numpy as np
import pytest

from inertia.mass.moments import vector
from inertia.mass.tessellation import chord_bound
from inertia.mesh.arrangement.uncovered import growth
from inertia.mesh.cut import block
from inertia.mesh.surface import Surface


def surface(corners: np.ndarray) -> Surface:
    return Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def bounds(corners: np.ndarray, distance: float, centre: np.ndarray) -> np.ndarray:
    moments = chord_bound(surface(corners), distance, vector(map(float, centre)))
    return np.array([moments.zeroth_bound, *moments.first_bound, *moments.second_bound], float)


@pytest.mark.parametrize("distance", [1e-6, 0.01, 0.5])
@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e12])
@pytest.mark.parametrize("seed", range(6))
def test_far_from_where_most_is_left_too(seed: int, scale: float, distance: float) -> None:
    """Most of what is left lies in the middle, and most of what is hidden at one end, or beside it."""
    rng = np.random.default_rng(seed)
    solid = block([-5, -5, -5], 10 * np.eye(3)).corners()
    left = np.concatenate([solid, rng.normal(size=(200, 3, 3)), [30.0, 0, 0] + 0.1 * rng.normal(size=(3, 3, 3))])
    end = np.array([[30.0, 0, 0], [0, 4.0, 40.0], [-3.0, 25.0, 1.0]])[seed % 3]
    given = np.concatenate([left, end + rng.normal(size=(300, 3, 3))])
    given, left, solid, distance = scale * given, scale * left, scale * solid, scale * distance
    far = distance * growth(given, left, solid, distance)
    centre = np.zeros(3)  # of the block
    assert (bounds(left, far, centre) >= bounds(given, distance, centre)).all()


def test_where_nothing_is_hidden_nothing_is_farther_off() -> None:
    corners = block([1, 2, 3], np.eye(3)).corners()
    assert growth(corners, corners, corners, 0.1) == pytest.approx(1.0, abs=1e-8)
