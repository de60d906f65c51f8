"""Triangles in common cells, against triangles that were made to meet, and walls that are known to be apart."""

import numpy as np
import pytest
from tests.mesh.solids import sphere

from inertia import native
from inertia.mesh.geometry import common_cells
from inertia.mesh.geometry.common_cells import Groups, in_common_cells
from inertia.mesh.geometry.enclosed import FEW, measured
from inertia.mesh.geometry.touching import touching_groups
from inertia.mesh.surface import Surface


@pytest.fixture(autouse=True)
def always_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)


def numbered(groups: np.ndarray) -> Groups:
    return Groups.of(groups.astype(np.int32), np.arange(groups.max() + 1))


def soup(corners: np.ndarray) -> Surface:
    return Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


@pytest.mark.parametrize("scale", [2.0**-900, 1e-3, 1.0, 2.0**900])
@pytest.mark.parametrize("seed", range(4))
def test_triangles_that_meet_others_are_never_left_out(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    sizes = rng.choice([0.01, 0.05, 0.3], (2_000, 1, 1), p=[0.9, 0.09, 0.01])
    first = rng.uniform(0, 10, (2_000, 1, 3)) + sizes * rng.normal(size=(2_000, 3, 3))
    if seed == 3:
        first[..., 2] = 1.0  # all in one plane
    # The k-th of the second half has a corner of the k-th of the first: they meet there.
    second = first[:, [1, 1, 1]] + sizes * rng.normal(size=(2_000, 3, 3)) * [[0], [1], [1]]
    corners = scale * np.concatenate([first, second])
    groups = rng.integers(0, 40, 4_000)
    family = np.sort(rng.integers(0, 3, 40))
    meet = (groups[:2_000] != groups[2_000:]) & (family[groups[:2_000]] == family[groups[2_000:]])
    near = in_common_cells(soup(corners), numbered(groups), family)
    assert near is not None
    left_out = np.ones(4_000, bool)
    left_out[near] = False
    assert not (left_out[:2_000] & meet).any()
    assert not (left_out[2_000:] & meet).any()
    assert left_out.mean() > 0.3


@pytest.mark.parametrize("length", [1, 3, 4, 9])
@pytest.mark.parametrize("seed", range(3))
def test_runs_of_triangles_of_several_groups_are_never_left_out(seed: int, length: int) -> None:
    rng = np.random.default_rng(seed)
    along = np.cumsum(0.3 * rng.normal(size=(6_000, 1, 3)), axis=0)  # each near the one before
    corners = along + 0.2 * rng.normal(size=(6_000, 3, 3))
    groups = np.arange(6_000) // length % 3
    # Those of the last third have a corner of some of the first, of another group.
    other = rng.choice(np.flatnonzero(groups[:2_000] == 0), 2_000)
    meet = np.flatnonzero(groups[4_000:] == 1)
    corners[4_000 + meet, 0] = corners[other[meet], 1]
    surface, one_family = soup(corners), np.zeros(3, np.int64)
    boxes = measured(surface, groups.astype(np.int32), 3, few=True).few
    for few in (None, boxes):
        near = in_common_cells(surface, numbered(groups), one_family, few)
        assert near is not None
        assert set(other[meet]) | set(4_000 + meet) <= set(near.tolist())


def hollow(wall: float) -> tuple[Surface, np.ndarray]:
    outer, faces = sphere(splits=5)
    surface = Surface(np.vstack([outer, (1 - wall) * outer]), np.vstack([faces, faces + len(outer)]))
    return surface, np.repeat([0, 1], len(faces))


def test_walls_of_several_edges_are_apart_without_a_look_at_pairs() -> None:
    surface, groups = hollow(0.3)
    one_family = np.zeros(2, np.int64)
    near = in_common_cells(surface, numbered(groups), one_family)
    assert near is not None
    assert len(near) == 0
    assert len(touching_groups(surface, numbered(groups), one_family)) == 0


def test_walls_thinner_than_a_cell_are_left_to_be_looked_at() -> None:
    surface, groups = hollow(1e-3)
    near = in_common_cells(surface, numbered(groups), np.zeros(2, np.int64))
    assert near is not None
    assert len(near) > 0.9 * len(groups)
    assert in_common_cells(surface, numbered(groups), np.arange(2)).tolist() == []  # of two families


def test_a_table_that_fills_up_is_enlarged_up_to_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    scattered = soup(rng.uniform(0, 10, (4_000, 1, 3)) + 1e-2 * rng.normal(size=(4_000, 3, 3)))
    groups, one_family = np.arange(4_000) % 2, np.zeros(2, np.int64)
    near = in_common_cells(scattered, numbered(groups), one_family)
    assert near is not None
    assert len(near) < 400
    monkeypatch.setattr(common_cells, "MOST_BITS", 10)
    assert in_common_cells(scattered, numbered(groups), one_family) is None


def test_few_triangles_that_span_all_cells_make_these_larger() -> None:
    rng = np.random.default_rng(0)
    small = rng.uniform(0, 1, (4_000, 1, 3)) + 1e-3 * rng.normal(size=(4_000, 3, 3))
    large = rng.uniform(0, 1, (40, 3, 3))
    groups = np.repeat([0, 1], [4_000, 40])
    near = in_common_cells(soup(np.concatenate([small, large])), numbered(groups), np.zeros(2, np.int64))
    assert near is not None
    assert set(range(4_000, 4_040)) <= set(near.tolist())


@pytest.mark.parametrize("scale", [1e-38, 1.0, 1e30])
@pytest.mark.parametrize("count", [1, 63, 64, 130, 1_001])
def test_boxes_of_a_few_triangles_enclose_them_closely_whatever_their_shells(count: int, scale: float) -> None:
    rng = np.random.default_rng(count)
    corners = scale * (3.0 + rng.normal(size=(count, 3, 3)))
    labels = rng.choice([-1, 0, 0, 0, 1], count).astype(np.int32)
    labels[: count // 2] = 0
    boxes = measured(soup(corners), labels, 2, few=True).few.astype(float)
    assert len(boxes) == -(-count // FEW)
    starts = np.arange(0, count, FEW)
    low, high = np.minimum.reduceat(corners.min(axis=1), starts), np.maximum.reduceat(corners.max(axis=1), starts)
    assert (boxes[:, :3] <= low).all()
    assert (high <= boxes[:, 3:]).all()
    closely = 2.0**-22 * np.abs(corners).max() + 2.0**-147
    assert np.allclose(boxes, np.hstack([low, high]), rtol=0, atol=closely)
