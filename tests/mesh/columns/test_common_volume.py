"""The volume that two surfaces share, against boxes in closed form and convex hulls of their common corners."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.spatial.transform import Rotation
from tests.mesh.solids import box, ring, sphere

from inertia.mesh.columns import common_volume as module
from inertia.mesh.columns.common_volume import common_volume, common_volumes, surplus_volume


def corners(mesh: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return mesh[0][mesh[1]]


@pytest.mark.parametrize("seed", range(60))
def test_boxes_in_any_attitude_share_their_common_box(seed: int) -> None:
    rng = np.random.default_rng(seed)
    low = rng.uniform(-0.5, 0.9, 3)
    high = low + rng.uniform(0.05, 1, 3)
    if seed % 2:  # sunk in by next to nothing
        low[2], high[2] = 1 - 10.0 ** rng.uniform(-12, 0), 1.5
    turned = Rotation.random(rng=rng).as_matrix() if seed % 3 else np.eye(3)
    away = rng.normal(size=3) * 10 ** rng.uniform(-1, 3)
    volume, rounding = common_volume(
        *(corners(solid) @ turned.T + away for solid in (box((0, 0, 0), (1, 1, 1)), box(tuple(low), tuple(high))))
    )
    # What the coordinates lose when they are turned is up to their last digit times the area.
    lost = 8 * np.spacing(np.abs(away).max() + 2)
    assert abs(volume - np.prod(np.maximum(np.minimum(high, 1) - np.maximum(low, 0), 0))) <= rounding + lost
    assert rounding < 1e-8


@pytest.mark.parametrize("seed", range(20))
def test_convex_bodies_share_the_hull_of_their_common_corners(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies, planes = [], []
    for k in range(2):
        points = rng.normal((0.8 * k, 0, 0), size=(60, 3))
        hull = ConvexHull(points)
        normals = np.cross(*(points[hull.simplices[:, i]] - points[hull.simplices[:, 0]] for i in (1, 2)))
        inward = (normals * hull.equations[:, :3]).sum(axis=1) < 0
        faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
        bodies.append(points[faces])
        planes.append(hull.equations)
    shared = HalfspaceIntersection(np.concatenate(planes), np.array([0.4, 0, 0]))
    volume, rounding = common_volume(*bodies)
    assert volume == pytest.approx(ConvexHull(shared.intersections).volume, rel=1e-9)
    assert rounding < 1e-9 * volume


def test_order_of_triangles_and_of_their_corners_does_not_matter() -> None:
    rng = np.random.default_rng(0)
    one, other = corners(sphere(splits=3)), corners(ring(24, 8, 1.0, 0.3))
    volume, rounding = common_volume(one, other)
    for _ in range(5):
        shuffled = [np.roll(body[rng.permutation(len(body))], rng.integers(3), axis=1) for body in (one, other)]
        assert abs(common_volume(*shuffled)[0] - volume) <= 2 * rounding


def test_surfaces_that_only_touch_share_nothing() -> None:
    turned = Rotation.from_rotvec([0.3, 0.5, -0.2]).as_matrix()
    ball = corners(sphere(splits=3)) @ turned.T
    shell = np.concatenate([corners(sphere(radius=2, splits=3)) @ turned.T, ball[:, ::-1]])
    volume, rounding = common_volume(ball, shell)
    assert abs(volume) <= rounding < 1e-9


def test_too_many_pairs_are_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_PAIRS", 100)
    ball = corners(sphere(splits=3))
    assert common_volume(ball, ball + 0.1) is None
    monkeypatch.setattr(module, "MOST_OF_ITSELF", 100)
    both = np.concatenate([ball, ball + 0.1])
    assert surplus_volume(both, np.array([both.min(axis=(0, 1)), both.max(axis=(0, 1))])) is None


def test_pairs_that_are_looked_at_together_have_what_each_has_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(1)
    solids = [corners(mesh) for mesh in (sphere(splits=2), ring(24, 8, 1.0, 0.3), box((0, 0, 0), (1, 2, 0.5)))]
    bodies = [2.0 ** rng.integers(-2, 3) * (solids[k % 3] + rng.normal(0, 0.4, 3)) for k in range(60)]
    ends = np.cumsum([len(body) for body in bodies])
    groups = [np.arange(end - len(body), end) for body, end in zip(bodies, ends, strict=True)]
    pairs = [tuple(rng.choice(60, 2, replace=False)) for _ in range(200)]
    alone = [common_volume(bodies[i], bodies[j]) for i, j in pairs]
    assert sum(volume > rounding for volume, rounding in filter(None, alone)) > 20
    every = np.concatenate(bodies), [(groups[i], groups[j]) for i, j in pairs]
    assert common_volumes(*every) == alone
    assert common_volumes(every[0], []) == []
    monkeypatch.setattr(module, "MOST_PAIRS", 800)
    fewer = [common_volume(bodies[i], bodies[j]) for i, j in pairs]
    assert 0 < fewer.count(None) < 100
    assert common_volumes(*every) == fewer


@pytest.mark.parametrize("kind", ["anyhow", "on a lattice", "the same", "below the plane"])
def test_compiled_and_vectorised_sums_agree_within_their_bounds(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(len(kind))
    one, other = rng.uniform(0, 1, (2, 120, 3, 3))
    if kind == "on a lattice":
        one, other = np.round(3 * one) / 3, np.round(3 * other) / 3
    elif kind == "the same":
        other = one[:, ::-1]
    elif kind == "below the plane":
        one[:, :, 2] -= 0.5
    every, box = np.concatenate([one, other]), np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.9]])
    compiled = common_volume(one, other), surplus_volume(every, box)
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    for these, those in zip(compiled, (common_volume(one, other), surplus_volume(every, box)), strict=True):
        assert these is not None
        assert those is not None
        assert those[0] != 0
        assert these == pytest.approx(those, rel=1e-13, abs=1e-14)
        assert max(these[1], those[1]) < 1e-9


def test_bodies_of_which_no_triangle_lies_above_one_of_the_other_share_nothing() -> None:
    around, within = corners(ring(64, 8, 1.0, 0.25)), 0.6 * corners(sphere(splits=3))
    volume, rounding = common_volume(around, within)
    assert abs(volume) <= rounding < 1e-12
    beside = np.array([[0.5, 0.5, -0.1], [0.6, 0.6, 0.1]])  # a box that the ring reaches into, and the ball does not
    assert surplus_volume(within, beside) == (0.0, 0.0)
