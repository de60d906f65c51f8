"""Shells that meet at common corners and edges alone, against linear programmes; what is left to compare one by one."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation
from tests.mesh.checks.test_crossings import boundary_of

from inertia import native
from inertia.arrays import Float
from inertia.mesh.check import check
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.columns import common_volume
from inertia.mesh.geometry import contact_planes, intersect, near_triangles
from inertia.mesh.geometry.corner_contacts import beyond_corners

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.fixture(autouse=True)
def always_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)


def tetrahedra(seed: int, count: int = 24) -> Float:
    """Return tetrahedra (n, 4, 3) between points of a grid, facing outward: many share corners, edges, sides, space."""
    rng = np.random.default_rng(seed)
    corners = (rng.integers(0, 4, (8 * count, 1, 3)) + rng.integers(0, 2, (8 * count, 4, 3))).astype(float)
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1])
    corners[volume < 0] = corners[volume < 0][:, [1, 0, 2, 3]]
    return np.unique(corners[np.abs(volume) > 0.5][:count], axis=0)


def pairs_beyond(solids: Float) -> set[tuple[int, int]]:
    """Return the pairs of tetrahedra that may meet beyond their common corners, or share space at their edges."""
    vertices, faces = np.unique(solids[:, TETRAHEDRON].reshape(-1, 3), axis=0, return_inverse=True)
    shell = np.repeat(np.arange(len(solids)), 4)
    boxes = np.stack([solids.min(axis=1), solids.max(axis=1)], axis=1)
    every = np.column_stack(np.triu_indices(len(solids), 1))
    turned = np.zeros(len(shell), bool)
    return set(map(tuple, beyond_corners(vertices, faces.reshape(-1, 3), shell, shell, turned, boxes, every).tolist()))


def common_depth(one: Float, other: Float) -> float:
    """Return the radius of the largest ball inside two tetrahedra; none is negative."""
    rows, limits = [], []
    for corners in (one[TETRAHEDRON], other[TETRAHEDRON]):
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        rows.append(np.column_stack([normals, np.ones(4)]))
        limits.append((normals * corners[:, 0]).sum(axis=1))
    best = linprog(
        [0, 0, 0, -1], A_ub=np.concatenate(rows), b_ub=np.concatenate(limits), bounds=[(-9, 9)] * 3 + [(-99, 9)]
    )
    return -float(best.fun)


def holds(outer: Float, inner: Float) -> bool:
    shares = np.linalg.solve((outer[1:] - outer[0]).T, (inner - outer[0]).T)
    return bool((shares > -1e-9).all() and (shares.sum(axis=0) < 1 + 1e-9).all())


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("turn", [False, True])
def test_those_that_are_left_out_share_no_space(seed: int, turn: bool) -> None:
    solids = tetrahedra(seed)
    if turn:
        solids = solids @ Rotation.random(random_state=seed).as_matrix().T
    beyond = pairs_beyond(solids)
    left_out = 0
    for i in range(len(solids)):
        for j in range(i + 1, len(solids)):
            if (i, j) not in beyond and not holds(solids[i], solids[j]) and not holds(solids[j], solids[i]):
                assert common_depth(solids[i], solids[j]) < 1e-9
                left_out += len(np.unique(solids[[i, j]].reshape(-1, 3), axis=0)) < 8
    assert left_out  # though they have corners in common


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("size", [1.0, 2.0**310])
def test_pairs_are_the_same_without_the_kernel(seed: int, size: float, monkeypatch: pytest.MonkeyPatch) -> None:
    solids = tetrahedra(seed, 60) * size  # the kernel forms no products of coordinates so large
    if seed % 2:
        solids = solids @ Rotation.random(random_state=seed).as_matrix().T
    compiled = pairs_beyond(solids)
    assert 0 < len(compiled) < len(solids) * (len(solids) - 1) // 2
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    assert pairs_beyond(solids) == compiled


@pytest.mark.parametrize(
    ("moved", "beyond"),
    [((1, 1, 0), False), ((1, 1, 1), False), ((1, 0, 0), False), ((1, 1, 0.5), True), ((0, 0, 0), True)],
)
def test_cubes_that_have_corners_an_edge_or_a_side_in_common(moved: tuple[float, float, float], beyond: bool) -> None:
    once = boundary_of(np.ones((1, 1, 1), bool)).triangles.corners()
    corners = np.concatenate([once, once + np.array(moved), once + 9.0]).reshape(-1, 3)
    vertices, faces = np.unique(corners, axis=0, return_inverse=True)
    shell, nothing = np.repeat([0, 1, 2], 12), np.zeros(36, bool)
    boxes = np.array([[move, np.add(move, 1)] for move in ((0, 0, 0), moved, (9, 9, 9))], float)
    pairs = beyond_corners(vertices, faces.reshape(-1, 3), shell, shell, nothing, boxes, np.array([[0, 1]]))
    assert pairs.tolist() == ([[0, 1]] if beyond else [])


@pytest.mark.parametrize(("start", "shared"), [(90, True), (170, False), (180, False)])
def test_wedges_around_one_edge_are_left_out_where_none_lies_on_another(start: int, shared: bool) -> None:
    angles = np.deg2rad([[0, 50], [50, 80], [100, 170], [start, start + 50]])
    rim = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=2)
    solids = np.concatenate([np.tile([[0, 0, -1.0], [0, 0, 1.0]], (4, 1, 1)), rim], axis=1)
    assert ((2, 3) in pairs_beyond(solids)) == shared
    assert bool(pairs_beyond(solids)) == shared


def test_bodies_of_voxels_are_not_compared_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    filled = np.random.default_rng(1).random((14, 14, 14)) < 0.4
    compared: list[int] = []
    for module, name in (
        (intersect, "overlap"),
        (contact_planes, "touching_depths"),
        (near_triangles, "touching_triangles"),
        (common_volume, "common_volumes"),
    ):
        monkeypatch.setattr(module, name, lambda a, b, *rest: compared.append(len(a)))
    assert check(boundary_of(filled)).fit
    assert not compared


def test_bodies_in_cavities_that_touch_their_walls_at_edges_are_not_either() -> None:
    filled = np.ones((7, 7, 7), bool)
    filled[2:5, 2:5, 2:5] = False
    filled[1, 1, 3], filled[3, 3, 3], filled[2, 4, 3] = False, True, True
    surface = SurfaceTopology.of(boundary_of(filled))
    assert len(surface.shells) > 2
    assert surface.touching is not None
    assert surface.touching.tolist() == []


def test_shells_that_share_no_corner_are_left_to_be_compared_without_being_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from inertia.mesh.geometry import corner_contacts

    rng = np.random.default_rng(9)
    solids = rng.uniform(0, 1, (12, 4, 3))
    inward = np.linalg.det(solids[:, 1:] - solids[:, :1]) < 0
    solids[inward] = solids[inward][:, [1, 0, 2, 3]]
    monkeypatch.delattr(corner_contacts, "overlapping")
    assert pairs_beyond(solids) == set(zip(*np.triu_indices(12, 1), strict=True))
