"""Triangles around an edge, sorted by exact angles: against cross products in fractions."""

from collections.abc import Iterator
from fractions import Fraction
from functools import cmp_to_key
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from inertia.mesh.cut import block
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.edge_fans import SORT, crowded, fans
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.surface import Surface
from inertia.native import COMPILE_ABOVE


def sorted_by_angle(points: np.ndarray) -> list[int]:
    """Sort points (k, 2) by angle from the first on, by the signs of cross and dot products in fractions."""
    exact = [[Fraction(x) for x in point] for point in points.tolist()]

    def half(k: int) -> int:
        (a, b), (x, y) = exact[0], exact[k]
        cross, dot = a * y - b * x, a * x + b * y
        return 0 if cross > 0 or (cross == 0 and dot > 0) else 1

    def compare(i: int, j: int) -> int:
        if half(i) != half(j):
            return half(i) - half(j)
        cross = exact[i][0] * exact[j][1] - exact[i][1] * exact[j][0]
        return -1 if cross > 0 else int(cross < 0)

    return [0, *sorted(range(1, len(exact)), key=cmp_to_key(compare))]


def around(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and faces of triangles from the edge along z to points in the plane beside it."""
    vertices = np.vstack([[0, 0, 0], [0, 0, 1], np.column_stack([points, np.full(len(points), 0.5)])])
    return vertices, np.array([[0, 1, k + 2] if k % 2 else [1, 0, k + 2] for k in range(len(points))])


def order(points: np.ndarray, seed: int) -> tuple[list[int], int]:
    """Return the points as they are sorted around the edge, from the first on, and the number of half-planes."""
    vertices, faces = around(points)
    faces = np.random.default_rng(seed).permutation(faces)
    edges = half_edges(faces)
    member = np.flatnonzero(edges.uses[edges.edge] > 2)
    result = fans(vertices, faces, edges, member, edges.edge[member])
    assert len(set(result.group.tolist())) == 1
    at = (faces.max(axis=1)[result.half_edge // 3] - 2).tolist()
    start = at.index(0)
    return at[start:] + at[:start], len(set(result.plane.tolist()))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("turn", [(1.0, 0.0), (-3.0, 4.0), (0.6, -0.7), (-1.0, -1e-9)])
def test_angles_that_differ_by_less_than_float64_holds_are_told_apart(turn: tuple[float, float], seed: int) -> None:
    """Twelve half-planes 1e-17 rad apart, opposite to another one, and four more anywhere."""
    rng = np.random.default_rng(seed)
    x, y = turn
    grid = 2.0**-52
    close = np.array([[-x * (1 + k * grid), -y] for k in range(6)] + [[-x, -y * (1 + k * grid)] for k in range(6)])
    points = np.vstack([[x, y], close, rng.normal(size=(4, 2))])
    points = np.unique(points, axis=0)
    points = points[np.argsort(np.abs(points - [x, y]).sum(axis=1), kind="stable")]
    expected = sorted_by_angle(points)
    exact = [[Fraction(v) for v in point] for point in points.tolist()]
    different = len({_direction(point) for point in exact})
    found, planes = order(points, seed)
    assert planes == different
    position = {k: expected.index(k) for k in range(len(points))}
    for i, j in pairwise(found):
        alike = exact[i][0] * exact[j][1] == exact[i][1] * exact[j][0]
        assert alike or position[i] < position[j]


def _direction(point: list[Fraction]) -> tuple[Fraction | None, bool]:
    x, y = point
    return (None, y > 0) if x == 0 else (y / x, x > 0)


@pytest.mark.parametrize("seed", range(6))
def test_wedges_of_1e_17_rad_at_one_edge_are_bodies_apart(seed: int) -> None:
    """Four tetrahedra as thin as that, with gaps as thin between them, all at one edge."""
    vertices = [[0.0, 0, -1], [0, 0, 1]] + [[1.0, k * 2.0**-57, 0] for k in range(8)]
    faces = []
    for k in range(2, 10, 2):
        faces += [[0, 1, k + 1], [1, 0, k], [0, k + 1, k], [1, k, k + 1]]
    rng = np.random.default_rng(seed)
    shuffled = rng.permutation(np.array(faces))
    surface = Surface(vertices, np.take_along_axis(shuffled, (rng.integers(0, 3, (16, 1)) + np.arange(3)) % 3, axis=1))
    result = closure(surface)
    assert (result.open_edges, result.components, result.crowded) == (0, 4, 1)
    for component in range(4):
        tips = np.unique(surface.faces[result.labels == component])[2:]
        assert tips[0] % 2 == 0
        assert tips[1] == tips[0] + 1


def test_a_thousand_copies_of_a_triangle_are_paired_with_as_many_turned_ones() -> None:
    vertices, faces = np.eye(3), np.repeat([[0, 1, 2], [2, 1, 0]], 1000, axis=0)
    pairing = closure(Surface(vertices, faces))
    assert (pairing.open_edges, pairing.components) == (0, 1000)
    assert pairing.labels.tolist() == [*range(1000)] * 2


@pytest.mark.parametrize("seed", range(20))
def test_angles_ascend_round_an_edge_however_it_is_turned(seed: int) -> None:
    """The first half-plane, others that rounding makes all but the same before and behind it, and a few anywhere."""
    rng = np.random.default_rng(seed)
    angles = np.concatenate([np.zeros(4), [np.pi / 2, np.pi, np.pi, 3 * np.pi / 2], rng.uniform(0, 2 * np.pi, 3)])
    points = rng.uniform(0.5, 2, (len(angles), 1)) * np.column_stack([np.cos(angles), np.sin(angles)])
    vertices, faces = around(points)
    vertices = vertices @ Rotation.random(random_state=rng).as_matrix().T + rng.normal(size=3)
    edges = half_edges(faces)
    member = np.flatnonzero(edges.uses[edges.edge] > 2)
    result = fans(vertices, faces, edges, member, edges.edge[member])
    assert (np.diff(result.angle) >= -1e-14).all()
    own = angles[faces.max(axis=1)[result.half_edge // 3] - 2]
    assert np.cos(result.angle) == pytest.approx(np.cos(own - own[0]), abs=1e-13)


def test_solids_side_by_side_at_an_edge_do_not_lie_on_one_another() -> None:
    """A cube and a larger block on it, turned: rounding moves their sides in one plane into each other, or apart."""
    cube = block([0, 0, 0], np.eye(3)).corners()
    both = np.concatenate([cube, np.add(cube * [1, 2, 1], [0, 0, 1])])
    for seed in range(60):
        corners = both @ Rotation.random(random_state=seed).as_matrix().T
        vertices, faces = merge_equal_vertices(Surface(corners.reshape(-1, 3), np.arange(72).reshape(-1, 3)))
        alike = np.zeros(24, np.int64)
        found, _ = crowded(vertices, faces, half_edges(faces), alike, alike > 0, 1e-6)
        assert found.tolist() == []


SIZES = 6
"""Meshes after which the next is as large as the first."""


def fan_meshes(rng: np.random.Generator) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield half-planes anywhere, at eighths of a turn, a rounding apart, of many triangles and of none; and cubes."""
    eighths = np.arange(8) * np.pi / 4
    for count in (3, 9, 40, 80):
        close = 1 + 2.0**-52 * rng.integers(0, 6, count)
        few = rng.normal(size=(3, 2))
        for points in (
            rng.normal(size=(count, 2)),
            np.round(3 * np.column_stack([np.cos(eighths), np.sin(eighths)])[rng.integers(0, 8, count)]),
            np.vstack([[1, 0.5], np.column_stack([-close, np.full(count, -0.5)])]),
            few[rng.integers(0, 3, count)] * rng.choice([0.0, 0.5, 1, 2], (count, 1)),
        ):
            vertices, faces = around(points)
            vertices[2:, 2] = rng.choice([0.25, 0.5, 3], len(points))
            turned = vertices @ Rotation.random(random_state=rng).as_matrix().T
            single = turned.astype(np.float32).astype(float)
            for mesh in (vertices, turned, single, 1e-150 * turned, 1e-95 * turned, 1e95 * turned):
                yield mesh, rng.permutation(faces)
    cubes = np.concatenate([block(place, np.eye(3)).corners() for place in np.ndindex(3, 3, 3)])
    yield cubes.reshape(-1, 3), np.arange(3 * len(cubes)).reshape(-1, 3)


@pytest.mark.parametrize("seed", range(4))
def test_compiled_fans_are_those_of_numpy(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half-planes and their order are the same, angles, heights and blurs to rounding, whatever is asked together."""
    assert SORT.worthwhile(COMPILE_ABOVE)  # and so for few from now on
    rng = np.random.default_rng(seed)
    parts = [merge_equal_vertices(Surface(*mesh)) for mesh in fan_meshes(rng)]
    parts = [(vertices, faces[(np.diff(np.sort(faces)) > 0).all(axis=1)]) for vertices, faces in parts]
    for each in [[part] for part in parts] + [parts[k::SIZES] for k in range(SIZES)]:
        vertices = np.concatenate([vertices for vertices, _ in each])
        starts = np.cumsum([0, *(len(vertices) for vertices, _ in each)])
        faces = np.concatenate([faces + start for (_, faces), start in zip(each, starts, strict=False)])
        edges = half_edges(faces)
        asked = rng.permutation(np.flatnonzero((edges.uses > 2)[edges.edge]))
        found = []
        for native in ("1", "0"):
            monkeypatch.setenv("INERTIA_NATIVE", native)
            result = fans(vertices, faces, edges, asked, edges.edge[asked])
            assert (np.diff(result.opens.astype(int))[np.diff(result.plane) == 0] >= 0).all()
            found.append(result.select(np.lexsort((result.half_edge, result.plane))))
        one, other = found
        for name in ("half_edge", "group", "plane", "opens"):
            assert np.array_equal(getattr(one, name), getattr(other, name))
        for name, rounding in (("angle", 1e-13), ("height", 0.0), ("blur", 0.0)):
            assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-12, abs=rounding)
