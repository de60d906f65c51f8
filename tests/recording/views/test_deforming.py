"""A recording of a body that changes its shape holds each part where it is, and the tensor as it changes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.recording.kinds import FLOAT32, drawable, errors_seen, place, series, tips, turn, written
from tests.recording.reading import Recorded

from inertia import Run, Scene, simulate
from inertia.recording import entities
from inertia.recording.views.deforming import screen
from inertia_meshes import path

ARM, TRUNK = 4.0, 52.0


def of(name: str) -> Run:
    return simulate(Scene.load(path(f"scenes/{name}.toml")))


@pytest.fixture(scope="module")
def skater(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return written(screen(of("skater")), tmp_path_factory.mktemp("deforming") / "run.rrd")


def where(recording: Recorded, name: str) -> np.ndarray:
    """Return where a part's centre is, (m, 3), from the centre of mass, space axes."""
    center = recording.values(f"/{entities.PARTS}/{name}/solid", "Ellipsoids3D:centers")[0, 0].astype(float)
    part = f"/{entities.PARTS}/{name}"
    in_root = turn(recording, part).apply(center) + place(recording, part)
    return turn(recording, f"/{entities.BODY}").apply(in_root) + place(recording, f"/{entities.BODY}")


def pulled_in(t: np.ndarray) -> np.ndarray:
    """Return how far from the axis the skater's arms are: minimum jerk from 0.7 to 0.2 m and back."""

    def shape(s: np.ndarray) -> np.ndarray:
        s = np.clip(s, 0.0, 1.0)
        return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)

    return 0.7 - 0.5 * shape(t - 1.0) + 0.5 * shape((t - 3.0) / 2.0)


def test_it_applies_to_bodies_that_change_their_shape() -> None:
    assert of("cat").plan.view == "deforming"
    table = {"body": {"principal_moments": [1.0, 2.0, 3.0]}, "start": {"angular_velocity": [0, 0, 1]}}
    assert simulate(Scene.from_dict(table | {"run": {"duration": 1.0, "samples": 11}})).plan.view == "tumbling"


def test_the_arms_go_in_and_out(skater: Recorded) -> None:
    t = skater.time(f"/{entities.PARTS}/left\\ arm")
    left, right = where(skater, "left\\ arm"), where(skater, "right\\ arm")
    np.testing.assert_allclose(np.linalg.norm(left[:, :2], axis=1), pulled_in(t), atol=1e-6)
    np.testing.assert_allclose(left[:, :2], -right[:, :2], atol=1e-6)
    height = 1.3 - (TRUNK * 0.85 + 2 * ARM * 1.3) / (TRUNK + 2 * ARM)
    np.testing.assert_allclose(left[:, 2], height, atol=1e-6)


def test_the_centre_of_mass_stays_in_the_middle(skater: Recorded) -> None:
    moment = TRUNK * where(skater, "trunk") + ARM * (where(skater, "left\\ arm") + where(skater, "right\\ arm"))
    np.testing.assert_allclose(moment / (TRUNK + 2 * ARM), 0.0, atol=1e-6)


def test_the_ellipsoid_has_the_moments_of_the_whole(skater: Recorded) -> None:
    t = skater.time(f"/{entities.ELLIPSOID}")
    sizes = skater.values(f"/{entities.ELLIPSOID}", "Ellipsoids3D:half_sizes")[:, 0].astype(float)
    squares = np.sort(sizes**2, axis=1)
    mass, r, level = TRUNK + 2 * ARM, pulled_in(t), 1.3 - 0.85
    reduced = TRUNK * 2 * ARM / mass * level**2  # of the arms' height over the trunk's centre
    arms = 2 * ARM * r**2
    across = 12.815833333 + reduced
    moments = np.stack([np.full_like(arms, across), across + arms, 0.585 + arms], axis=1)
    expected = np.sort(2.5 * (moments.sum(axis=1)[:, None] - 2 * moments) / mass, axis=1)
    np.testing.assert_allclose(squares[:, 1:], expected[:, 1:], rtol=1e-5)
    np.testing.assert_allclose(squares[:, 0], expected[:, 0], rtol=1e-4)


def test_joints_moments_and_work_are_plotted(skater: Recorded) -> None:
    t = skater.time(f"/{entities.PLOT_SLIDES}")
    for column in series(skater, f"/{entities.PLOT_SLIDES}").T:
        np.testing.assert_allclose(column, pulled_in(t) - 0.7, atol=1e-12)
    assert f"/{entities.PLOT_JOINTS}" not in skater.columns
    assert series(skater, f"/{entities.PLOT_MOMENTS}").shape == (601, 3)
    energy, work = series(skater, f"/{entities.PLOT_WORK}").T
    np.testing.assert_allclose(energy - energy[0], work, atol=1e-9)
    spin = series(skater, f"/{entities.PLOT_ANGULAR_VELOCITY}")[:, 2]
    about_axis = 0.585 + 2 * ARM * pulled_in(t) ** 2
    np.testing.assert_allclose(spin, 8.0 * about_axis[0] / about_axis, rtol=1e-9)


def test_the_screen_has_its_views(skater: Recorded) -> None:
    assert sorted(skater.views) == ["3D", "3D", "TextDocument", *5 * ["TimeSeries"]]


def test_a_body_in_flight_is_shown_where_it_is(tmp_path: Path) -> None:
    recording = written(screen(of("diver")), tmp_path / "run.rrd")
    assert recording.views.count("3D") == 3
    t, center = recording.time(f"/{entities.CENTER}"), place(recording, f"/{entities.CENTER}")
    fall = np.stack([t, 0 * t, 3.0 * t - 0.5 * 9.80665 * t**2], axis=1)
    np.testing.assert_allclose(center, fall, atol=2e-4)  # between samples on straight lines
    momentum = tips(recording, f"/{entities.ANGULAR_MOMENTUM}")
    np.testing.assert_allclose(momentum, np.broadcast_to(momentum[0], momentum.shape), atol=8 * FLOAT32)


def test_no_arrow_is_drawn_of_a_momentum_that_is_zero(tmp_path: Path) -> None:
    recording = written(screen(of("cat")), tmp_path / "run.rrd")
    assert f"/{entities.ANGULAR_MOMENTUM}" not in recording.columns
    assert f"/{entities.ANGULAR_VELOCITY}" in recording.columns
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "The angular momentum is zero and has no arrow." in text


def test_parts_with_a_file_are_shown_as_they_are(tmp_path: Path) -> None:
    table = {
        "part": [
            {"name": "base", "part": str(path("cube.stl")), "unit": "mm", "density": 1000.0},
            {
                "name": "lid",
                "parent": "base",
                "part": str(path("box.stl")),
                "unit": "mm",
                "density": 1000.0,
                "joint": [{"axis": [0, 0, 1], "times": [0.0, 1.0], "angles": [0.0, 1.0]}],
            },
        ],
        "start": {"angular_velocity": [0.0, 0.0, 1.0], "frame": "part"},
        "run": {"duration": 1.0, "samples": 11, "accuracy": 1e-8},
    }
    run = simulate(Scene.from_dict(table))
    recording = written(screen(run), tmp_path / "run.rrd")
    part = run.scene.body.meshes[1]
    stored = part.triangles.corners().reshape(-1, 3) * 1e-3
    drawn = recording.values(f"/{entities.PARTS}/lid/solid", "Mesh3D:vertex_positions")[0]
    scale = np.abs(stored).max() / np.abs(drawn).max()
    assert np.log10(scale) == pytest.approx(np.round(np.log10(scale)), abs=1e-6)
    np.testing.assert_allclose(drawn * scale, stored, atol=4 * FLOAT32 * np.abs(stored).max())
    turned = turn(recording, f"/{entities.PARTS}/lid").as_rotvec()[-1]
    np.testing.assert_allclose(turned, [0, 0, 1], atol=1e-6)


@drawable
def test_the_viewer_shows_it_without_an_error(tmp_path: Path) -> None:
    scene = Scene.load(path("scenes/diver.toml"))
    run = simulate(replace(scene, run=replace(scene.run, duration=0.8)))
    assert errors_seen(screen(run), tmp_path, 0.5) == []
