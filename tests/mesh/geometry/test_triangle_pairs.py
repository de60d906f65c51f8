"""Listed pairs of triangles, and winding numbers: kernels against numpy, and both against rational arithmetic."""

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from inertia import native
from inertia.mesh.geometry.near_triangles import crossing_triangles, touching_triangles
from inertia.mesh.geometry.triangle_pairs import UNSURE, cross_signs, crossing, orient3d, parted
from inertia.mesh.geometry.winding import windings

from .test_intersect import interiors_cross, rational_sign, whole

PAIRS = 300


def on_a_grid(rng: np.random.Generator) -> np.ndarray:
    """Return points of which many lie on lines and in planes with others."""
    return np.unique(rng.integers(-2, 3, (40, 3)).astype(float), axis=0)


def turned(rng: np.random.Generator) -> np.ndarray:
    """Return the same, but for what rounding does to them when they are turned."""
    return on_a_grid(rng) @ np.linalg.qr(rng.normal(size=(3, 3)))[0]


def far_off(rng: np.random.Generator) -> np.ndarray:
    return np.unique(turned(rng) + 1e9, axis=0)


def tiny(rng: np.random.Generator) -> np.ndarray:
    return on_a_grid(rng) * 2.0**-350


def huge(rng: np.random.Generator) -> np.ndarray:
    return on_a_grid(rng) * 2.0**450


PLACES = [on_a_grid, turned, far_off, tiny, huge]


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    for limit in ("SHIPPED_ABOVE", "LOAD_ABOVE", "COMPILE_ABOVE"):
        monkeypatch.setattr(native, limit, 0)
    monkeypatch.delenv("INERTIA_NATIVE", raising=False)


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("points", PLACES)
class TestKernels:
    def test_sides_of_planes_are_those_of_rational_arithmetic(self, points: Callable, seed: int) -> None:
        rng = np.random.default_rng(seed)
        table = points(rng)
        some = table[rng.integers(0, len(table), (8, 4, 5))]
        some[-1, 0, 0] = 2.0**600  # too large for the kernel
        a, b, c, d = (
            some[:, 0],
            some[:, 1, :1],
            some[:, 2, ::-1],
            some[0, 3],
        )
        sign = orient3d(a, b, c, d)
        expected = [
            [rational_sign(*(point.tolist() for point in four)) for four in zip(*row, strict=True)]
            for row in zip(*(np.broadcast_to(each, some[:, 0].shape) for each in (a, b, c, d)), strict=True)
        ]
        assert sign.tolist() == expected
        assert orient3d(a, b, np.ascontiguousarray(c), d).tolist() == expected

    def test_crossings_are_those_of_rational_arithmetic(self, points: Callable, seed: int) -> None:
        rng = np.random.default_rng(seed)
        vertices = points(rng)
        one, other = rng.integers(0, len(vertices), (2, PAIRS, 3))
        exact = whole(vertices[np.concatenate([one, other])].tolist())
        expected = [
            len({*map(int, a)} & {*map(int, b)}) < 2 and interiors_cross(p, q)
            for a, b, p, q in zip(one, other, exact[:PAIRS], exact[PAIRS:], strict=True)
        ]
        sign = cross_signs(vertices, one, other)
        known = sign != UNSURE
        assert (sign == 1)[known].tolist() == np.array(expected)[known].tolist()
        assert known.any() or points in (tiny, huge)
        assert crossing(vertices, one, other)[0].tolist() == np.flatnonzero(expected).tolist()
        both = vertices[np.concatenate([one, other])]
        numbers = np.arange(PAIRS)
        assert crossing_triangles(both, numbers, numbers + PAIRS).tolist() == np.flatnonzero(expected).tolist()

    def test_planes_that_part_triangles_do_so_in_rational_arithmetic(self, points: Callable, seed: int) -> None:
        rng = np.random.default_rng(seed)
        vertices = points(rng)
        one, other = rng.integers(0, len(vertices), (2, PAIRS, 3))
        for a, b in zip(
            *(vertices[faces[parted(vertices, one, other)]].tolist() for faces in (one, other)), strict=True
        ):
            sides = [{rational_sign(*p, corner) for corner in q} for p, q in ((a, b), (b, a))]
            assert {1} in sides or {-1} in sides

    def test_numpy_says_the_same(self, points: Callable, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
        rng = np.random.default_rng(seed)
        vertices = points(rng)
        one, other = rng.integers(0, len(vertices), (2, PAIRS, 3))
        corners = vertices[one]
        sides = [(np.arange(20 * k, 20 * k + 10), np.arange(20 * k + 10, 20 * k + 20)) for k in range(5)]
        local = corners / np.abs(corners).max()
        places = np.concatenate([local.mean(axis=1), local[::3, 0], rng.uniform(-1, 1, (50, 3))])

        def answers() -> list[np.ndarray]:
            return [
                *crossing(vertices, one, other),
                parted(vertices, one, other),
                *touching_triangles(corners, sides),
                *windings(places, local, 1e-3),
            ]

        kernels = answers()
        monkeypatch.setenv("INERTIA_NATIVE", "0")
        for compiled, plain in itertools.zip_longest(kernels, answers()):
            assert np.array_equal(compiled, plain)


def test_some_planes_part_triangles() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 2], [0, 0, -1]], float)
    faces = np.array([[0, 1, 2]] * 3)
    assert parted(vertices, faces, np.array([[3, 4, 5], [3, 4, 6], [0, 4, 5]])).tolist() == [True, False, False]


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_points_that_are_no_numbers_leave_the_memory_beside_alone(value: float) -> None:
    kernel = native.Kernel("inertia.mesh.geometry.pair_kernel", "orient_points", "piippp")
    points = np.random.default_rng(0).normal(size=(4, 200, 3))
    points[0, :, 1] = value
    table = np.zeros((4, 4), np.int64)
    table[:, 0], table[:, 2:] = native.place(points) + 8 * 600 * np.arange(4), [3, 1]
    own, work, signs = np.empty((4, 3)), np.full(1024, 7.0), np.empty(200, np.int8)
    kernel.function(native.place(table), 1, 200, *map(native.place, (own, work, signs)))
    assert (signs == UNSURE).all()
    assert (work[256:] == 7.0).all()  # beyond the numbers that it needs
