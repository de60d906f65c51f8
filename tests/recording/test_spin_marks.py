"""Lines on a body lie on its surface; they, its edges and a halo make its turning visible."""

from pathlib import Path

import numpy as np
import pytest
from tests.recording.kinds import tips, written
from tests.recording.reading import Recorded

from inertia import Scene, read, simulate
from inertia.recording import entities
from inertia.recording.spin_marks import meridian, sharp_edges, spin_axes
from inertia.recording.views import driven, tumbling
from inertia_meshes import path


def corners(name: str) -> np.ndarray:
    return read(path(name), "mm").triangles.corners()


def tumbled(name: str, folder: Path) -> Recorded:
    table = {
        "body": {"part": str(path(name)), "unit": "mm", "density": 1000.0},
        "start": {"angular_velocity": [3.0, 0.2, 0.1], "frame": "principal"},
        "run": {"duration": 2.0, "samples": 101},
    }
    return written(tumbling.screen(simulate(Scene.from_dict(table))), folder / "run.rrd")


def strips(recording: Recorded, entity: str) -> list[np.ndarray]:
    return [np.array(line) for line in recording.columns[f"/{entity}"]["LineStrips3D:strips"][0][0].as_py()]


def test_a_cube_has_its_twelve_edges_and_no_diagonals() -> None:
    cube = corners("cube.stl")
    edges = sharp_edges(cube)
    assert len(edges) == 12
    np.testing.assert_allclose(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1), np.ptp(cube))


def test_a_round_body_has_none() -> None:
    assert len(sharp_edges(corners("sphere.stl"))) == 0


def test_triangles_that_miss_a_neighbour_show_it() -> None:
    assert len(sharp_edges(corners("cube.stl")[1:])) == 13  # the diagonal of the half that is left


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2, 4.0])
def test_a_meridian_is_where_the_half_plane_meets_the_surface(angle: float) -> None:
    """Of a ball it is half of a great circle, as far as facets are one."""
    ball = corners("sphere.stl")
    ball = ball - ball.reshape(-1, 3).mean(axis=0)
    radius = np.linalg.norm(ball, axis=2).max()
    lines = meridian(ball, angle)
    out, aside = [np.cos(angle), np.sin(angle), 0.0], [-np.sin(angle), np.cos(angle), 0.0]
    np.testing.assert_allclose(lines @ aside, 0.0, atol=1e-12 * radius)
    assert (lines @ out).min() > -1e-6 * radius
    length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum()
    assert length == pytest.approx(np.pi * radius, rel=0.02)


def test_the_mark_goes_from_end_to_end_of_the_axis_that_the_spin_is_nearest_to() -> None:
    axes = spin_axes(np.eye(3), np.array([0.1, -9.0, 1.0]))
    np.testing.assert_array_equal(axes[:, 2], [0.0, 1.0, 0.0])
    assert np.linalg.det(axes) == 1.0


def test_a_needle_has_a_halo_that_holds_it(tmp_path: Path) -> None:
    recording = tumbled("needle.stl", tmp_path)
    ((half_sizes,),) = recording.values(f"/{entities.HALO}", "Ellipsoids3D:half_sizes").astype(float)
    body = recording.values(f"/{entities.MESH}", "Mesh3D:vertex_positions")[0].astype(float)
    longest = np.ptp(body, axis=0).max()
    assert half_sizes.max() > 0.5 * longest
    assert np.sort(half_sizes)[0] > 0.05 * longest
    (mark,) = strips(recording, entities.MARK)
    ((center,),) = recording.values(f"/{entities.HALO}", "Ellipsoids3D:centers").astype(float)
    ((x, y, z, w),) = recording.values(f"/{entities.HALO}", "Ellipsoids3D:quaternions")[0].astype(float)
    from scipy.spatial.transform import Rotation

    along = Rotation.from_quat([x, y, z, w]).inv().apply(mark - center)
    np.testing.assert_allclose(((along / half_sizes) ** 2).sum(axis=1), 1.0, rtol=1e-4)


@pytest.mark.parametrize(("name", "edges"), [("thin_plate.stl", 12), ("t_handle.stl", None)])
def test_other_bodies_have_edges_and_a_mark_on_their_surface(name: str, edges: int | None, tmp_path: Path) -> None:
    recording = tumbled(name, tmp_path)
    assert f"/{entities.HALO}" not in recording.columns
    drawn = strips(recording, entities.EDGES)
    assert edges is None or len(drawn) == edges
    body = recording.values(f"/{entities.MESH}", "Mesh3D:vertex_positions")[0].astype(float)
    mark = np.concatenate(strips(recording, entities.MARK))
    assert (mark >= body.min(axis=0) - 1e-5).all()
    assert (mark <= body.max(axis=0) + 1e-5).all()


def test_arrows_that_shrink_stay_outside_the_body_and_keep_their_direction(tmp_path: Path) -> None:
    """Damping takes 86 % of ω; what acts is in proportion to it, so that its direction stays."""
    table = {
        "body": {"principal_moments": [2.0, 2.0, 2.0]},
        "start": {"angular_velocity": [0.3, 0.0, 0.4]},
        "load": [{"kind": "damping", "coefficient": 0.4}],
        "run": {"duration": 10.0, "samples": 201, "accuracy": 1e-9},
    }
    recording = written(driven.screen(simulate(Scene.from_dict(table))), tmp_path / "run.rrd")
    radius = np.sqrt(5.0)  # of the solid sphere of 1 kg with these moments, in m
    for entity in (entities.ANGULAR_VELOCITY, entities.ANGULAR_MOMENTUM):
        arrows = tips(recording, f"/{entity}")
        sizes = np.linalg.norm(arrows, axis=1)
        assert sizes.min() > 1.1 * radius
        assert (np.diff(sizes) < 0).all()
        np.testing.assert_allclose(arrows / sizes[:, None], np.broadcast_to([0.6, 0.0, 0.8], arrows.shape), atol=1e-5)
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "grows short" in text
