import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import box, joined, ring

from inertia.mesh.geometry.rays import inside
from inertia.mesh.surface import Surface


def corners(mesh) -> np.ndarray:
    return mesh[0][mesh[1]]


@given(
    st.tuples(*[st.floats(-1.9, 1.9)] * 3), st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda k: np.hypot(*k[:2]) > 0.1)
)
@settings(deadline=None, max_examples=100)
def test_a_ray_through_a_box_runs_where_the_slabs_overlap(aim, direction):
    along = np.array(direction) / np.linalg.norm(direction)
    start = np.array(aim) - 20 * along
    with np.errstate(divide="ignore", over="ignore"):
        ends = np.sort((np.array([[-2.0], [2.0]]) - start) / along, axis=0)
    expected = [ends[0].max(), ends[1].min()]
    stretches = inside(corners(box((-2, -2, -2), (2, 2, 2))), start, along)
    assert stretches.ravel() == pytest.approx(expected, rel=1e-9)


def test_a_ray_along_edges_and_through_vertices_is_not_lost_or_doubled():
    triangles = corners(box((0, 0, 0), (1, 1, 1)))
    assert inside(triangles, [-1, 0.5, 0.5], [1, 0, 0]).tolist() == [[1.0, 2.0]]
    diagonal = np.ones(3) / np.sqrt(3)
    assert inside(triangles, -diagonal, diagonal).ravel() == pytest.approx([1, 1 + np.sqrt(3)])


def test_a_ray_across_a_ring_runs_inside_twice():
    stretches = inside(corners(ring(48, 16)), [-9, 0, 0], [1, 0, 0])
    assert stretches.ravel().tolist() == pytest.approx([5, 7, 11, 13])


def test_a_ray_that_starts_inside_begins_at_zero():
    assert inside(corners(box((0, 0, 0), (1, 1, 1))), [0.25, 0.5, 0.25], [1, 0, 0]).tolist() == [[0.0, 0.75]]


def test_a_ray_that_misses_or_points_away_runs_nowhere():
    triangles = corners(box((0, 0, 0), (1, 1, 1)))
    assert inside(triangles, [-1, 3, 0.5], [1, 0, 0]).shape == (0, 2)
    assert inside(triangles, [-1, 0.5, 0.5], [-1, 0, 0]).shape == (0, 2)


def test_a_cavity_interrupts_a_ray():
    inner = box((1, 1, 1), (2, 2, 2))
    hollow = joined(box((0, 0, 0), (3, 3, 3)), (inner[0], inner[1][:, ::-1]))
    assert isinstance(hollow, Surface)
    assert inside(hollow.corners(), [-1, 1.4, 1.3], [1, 0, 0]).tolist() == [[1.0, 2.0], [3.0, 4.0]]
