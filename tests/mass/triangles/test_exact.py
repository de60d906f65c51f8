"""Moments in integer arithmetic equal the rational oracle's: as fractions, not nearly."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import cube, facets, inside_out, joined, ring, sphere

from inertia.mass.triangles import exact
from inertia.mass.triangles.exact import exact_moments
from inertia.mesh.surface import Surface, Triangles
from inertia_meshes import rational

ORIGIN = (Fraction(0),) * 3


def assert_exact(triangles: Triangles) -> None:
    moments = exact_moments(triangles)
    expected = rational.moments(triangles.corners())
    assert moments.zeroth == expected.volume
    about = moments.about(ORIGIN)
    assert (about.first, about.second) == (expected.first, expected.second)
    assert (moments.zeroth_bound, moments.first_bound, moments.second_bound) == (0, ORIGIN, ORIGIN * 2)


def star(seed: int) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = sphere(splits=1)
    return vertices * np.random.default_rng(seed).uniform(0.3, 1, (len(vertices), 1)), faces


@pytest.mark.parametrize("offset", [0.0, 1.0, 1e6, -1e15, 1e150])
@pytest.mark.parametrize("scale", [1.0, 1e-30, 1e60])
def test_equal_at_any_offset_and_size(offset: float, scale: float) -> None:
    vertices, faces = star(1)
    assert_exact(Surface(vertices * scale + np.array([offset, -offset, offset / 3]), faces))


@settings(deadline=None, max_examples=15)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=12, max_size=12))
def test_equal_for_a_tetrahedron_of_any_coordinates(numbers: list[float]) -> None:
    assert_exact(Surface(np.array(numbers).reshape(4, 3), [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))


def test_equal_for_the_smallest_and_largest_numbers_together() -> None:
    least, most = 5e-324, 1.7976931348623157e308
    vertices = [[least, -0.0, 0.0], [most, 3 * least, 0.0], [0.0, 1.0, 2.2e-308], [1e-160, 0.0, -most]]
    surface = Surface(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    assert_exact(surface)
    assert exact_moments(surface).zeroth != 0


@pytest.mark.parametrize("around", [64, 65], ids=["whole chunks", "and a rest"])
def test_equal_over_several_chunks(around: int) -> None:
    surface = joined(ring(around, 64, radius=3.1))
    assert (surface.count > exact.CHUNK, surface.count % exact.CHUNK == 0) == (True, around == 64)
    assert_exact(surface)


def test_equal_for_float32_records() -> None:
    assert_exact(facets(joined(ring(12, 7), inside_out(cube((100, 0, 0))))))


def test_a_surface_collapsed_to_the_origin_has_no_moments() -> None:
    assert exact_moments(Surface(np.zeros((3, 3)), [[0, 1, 2]])).zeroth == 0


def test_the_answer_does_not_depend_on_the_order_of_the_triangles() -> None:
    surface = joined(star(4))
    shuffled = Surface(surface.vertices, np.random.default_rng(0).permutation(surface.faces))
    here, there = (exact_moments(s).about(ORIGIN) for s in (surface, shuffled))
    assert here == there


def test_progress_rises_to_one() -> None:
    fractions: list[float] = []
    exact_moments(joined(sphere(splits=5)), fractions.append)
    assert fractions == sorted(set(fractions))
    assert 0 < fractions[0] < fractions[-1] == 1.0
