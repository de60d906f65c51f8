"""Places inside both of two bodies, of many pairs at once: against the comparison of each pair by itself."""

import numpy as np

from inertia.mesh.geometry.common_places import sure_to_share
from inertia.mesh.geometry.intersect import overlap
from inertia.mesh.surface import Surface

FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def _sure(pairs):
    """Say of which pairs of closed surfaces (n, 3, 3) it is shown that they share space."""
    corners = np.concatenate([each for pair in pairs for each in pair])
    ends = np.cumsum([len(each) for pair in pairs for each in pair])
    ranges = [np.arange(stop - len(each), stop) for stop, each in zip(ends, sum(pairs, ()), strict=True)]
    boxes = np.array([[[k.min(axis=(0, 1)), k.max(axis=(0, 1))] for k in pair] for pair in pairs])
    size = np.ptp(boxes, axis=2).max(axis=2).min(axis=1)
    low, high = boxes[:, :, 0].max(axis=1), boxes[:, :, 1].min(axis=1)
    return sure_to_share(corners, list(zip(ranges[::2], ranges[1::2], strict=True)), low, high, size, 0.0)


def _tetrahedron(rng, thickness=1.0):
    points = rng.normal(size=(4, 3)) * [1, 1, thickness]
    if np.linalg.det(points[1:] - points[0]) < 0:
        points = points[[0, 2, 1, 3]]
    return points[FACES]


def _shared(one, other):
    a, b = (Surface(each.reshape(-1, 3), np.arange(12).reshape(-1, 3)) for each in (one, other))
    return overlap(a, b) is not None


def test_what_is_sure_shares_space_and_little_that_does_is_not_sure():
    rng = np.random.default_rng(3)
    pairs = [(_tetrahedron(rng), _tetrahedron(rng) + rng.normal(size=3)) for _ in range(400)]
    sure, shared = _sure(pairs), np.array([_shared(*pair) for pair in pairs])
    assert not (sure & ~shared).any()
    assert 100 < shared.sum() < 300
    assert (sure & shared).sum() >= 0.99 * shared.sum()


def test_thin_bodies_that_cross_are_sure_though_they_fill_next_to_nothing_of_their_common_box():
    rng = np.random.default_rng(4)
    swap = [2, 0, 1]
    pairs = [(_tetrahedron(rng, 1e-3), _tetrahedron(rng, 1e-3)[..., swap]) for _ in range(200)]
    sure, shared = _sure(pairs), np.array([_shared(*pair) for pair in pairs])
    assert not (sure & ~shared).any()
    assert shared.sum() > 50
    assert (sure & shared).sum() >= 0.8 * shared.sum()


def test_bodies_that_touch_face_to_face_are_not_sure():
    rng = np.random.default_rng(5)
    pairs = []
    for _ in range(100):
        one = _tetrahedron(rng)
        a, b, c = one[0]
        top = one.reshape(-1, 3)[np.argmax(np.abs((one.reshape(-1, 3) - a) @ np.cross(b - a, c - a)))]
        points = np.array([a, b, c, (a + b + c) * (2 / 3) - top])
        if np.linalg.det(points[1:] - points[0]) < 0:
            points = points[[0, 2, 1, 3]]
        pairs.append((one, points[FACES]))
    assert not _sure(pairs).any()
