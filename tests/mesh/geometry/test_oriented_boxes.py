"""Boxes along axes of their own: few of long, thin triangles overlap, and those of triangles that cross always do."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from inertia import native
from inertia.arrays import Float, Int
from inertia.mesh.geometry import boxes, intersect
from inertia.mesh.geometry.intersect import compiled_crossings, crossings, near_pairs, vectorised_crossings
from inertia.mesh.geometry.oriented_boxes import OrientedBoxes
from inertia.mesh.surface import Surface


def wall(sides: int, narrow: float = 1.0) -> Float:
    """Return triangles (2 n, 3, 3) of a cylinder, or of a cone that ends narrow, turned in space."""
    angle = 2 * np.pi * np.arange(sides) / sides
    foot = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    head = foot * [narrow, narrow, 1] + [0, 0, 5]
    after = np.roll(np.arange(sides), -1)
    sheets = [np.stack([foot, foot[after], head[after]], axis=1), np.stack([foot, head[after], head], axis=1)]
    return np.concatenate(sheets) @ Rotation.from_rotvec([0.7, 0.5, 0.2]).as_matrix().T


def surface(corners: Float) -> Surface:
    return Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def slivers(seed: int, count: int) -> Float:
    """Return long, thin triangles (n, 3, 3) every which way, many of which cross."""
    rng = np.random.default_rng(seed)
    start, way = rng.normal(size=(2, count, 3))
    return np.stack([start, start + way, start + way + 0.2 * rng.normal(size=(count, 3))], axis=1)


def pairs_of(runs: intersect.Crossed) -> Int:
    pairs = np.concatenate([np.empty((0, 2), np.int64), *(crossed for crossed, _, _ in runs)])
    return pairs[np.lexsort(pairs.T[::-1])]


@pytest.mark.parametrize("narrow", [1.0, 0.2])
def test_pairs_of_triangles_along_a_cylinder_or_a_cone_go_with_their_number(narrow: float) -> None:
    listed = []
    for sides in (1 << 10, 1 << 12):
        one = surface(wall(sides, narrow))
        listed.append(sum(len(i) for i, _, _ in near_pairs(one.vertices, one.faces, None, crossing=True)))
        assert listed[-1] < 200 * len(one.faces)
    assert listed[1] < 6 * listed[0]  # of four times as many triangles; all of them would be sixteen times as many


def test_pairs_between_two_such_surfaces_do_too() -> None:
    bore, pin = wall(1 << 12), 0.999 * wall(1 << 12)
    vertices = np.concatenate([bore, pin]).reshape(-1, 3)
    faces = np.arange(len(vertices)).reshape(2, -1, 3)
    assert sum(len(i) for i, _, _ in near_pairs(vertices, faces[0], faces[1], crossing=True)) < 300 * len(bore)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("scale", [1.0, 1e-200, 1e150])
def test_what_crosses_is_found_whatever_the_boxes(seed: int, scale: float, monkeypatch: pytest.MonkeyPatch) -> None:
    away = np.array([0, 0, 1e3 * (seed % 2)])
    one, other = (surface(scale * (slivers(k, 300) + away)) for k in (seed, seed + 100))
    expected = pairs_of(vectorised_crossings(one))
    between = crossings(one, other, limit=10**6).pairs
    assert min(len(expected), len(between)) > 50
    monkeypatch.setattr(boxes, "PATIENCE", -1)
    assert np.array_equal(pairs_of(vectorised_crossings(one)), expected)
    assert np.array_equal(crossings(one, other, limit=10**6).pairs, between)


@pytest.mark.parametrize("seed", range(4))
def test_boxes_hold_their_triangles(seed: int) -> None:
    corners = slivers(seed, 77) / 16
    both = OrientedBoxes.around(corners)
    for height, (middle, axes, half) in enumerate(zip(both.middle, both.axes, both.half, strict=True)):
        own = np.arange(77) >> height
        along = np.einsum("nij,nkj->nki", axes[own], corners - middle[own][:, None])
        assert (np.abs(along) <= half[own][:, None]).all()


def test_the_compiled_search_leaves_slanted_triangles_to_boxes_along_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)
    opened: list[int] = []
    kernel = intersect.COMPILED.function
    monkeypatch.setitem(intersect.COMPILED.__dict__, "function", lambda *all: opened.append(all[-2]) or kernel(*all))
    corners = wall(1 << 12)
    across = np.array([[[0, 0, 0], [4, 4, 4], [4, 4, 5]]]) + corners[10].mean(axis=0)
    one = surface(np.concatenate([corners, across - 2, across]))
    crossed = pairs_of(compiled_crossings(one))
    assert len(crossed) >= 2
    assert sum(opened) <= 64 * len(one.faces)
    monkeypatch.setattr(intersect, "slanted", lambda *_: False)
    assert np.array_equal(pairs_of(compiled_crossings(one)), crossed)
