"""A recording of a rolling body holds its path, the point of contact, and the forces there."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.recording.kinds import FLOAT32, drawable, errors_seen, place, series, tips, turn, written
from tests.recording.reading import Recorded

from inertia import Run, Scene, simulate
from inertia.dynamics.scene.sections import Constraint
from inertia.recording import entities
from inertia.recording.views.disc import STATES, screen
from inertia_meshes import path

G, MASS, RADIUS = 9.80665, 0.01, 0.025


@pytest.fixture(scope="module")
def run() -> Run:
    scene = Scene.load(path("scenes/rolling_disc.toml"))
    return simulate(replace(scene, run=replace(scene.run, duration=1.0, samples=401)))


@pytest.fixture(scope="module")
def recording(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return written(screen(run), tmp_path_factory.mktemp("disc") / "run.rrd")


def test_it_applies_to_bodies_that_roll(run: Run) -> None:
    assert run.plan.view == "disc"
    free = replace(run.scene, constraint=Constraint(), applied_loads=())
    assert simulate(free).plan.view == "tumbling"


def test_the_screen_has_its_views(recording: Recorded) -> None:
    assert sorted(recording.views) == ["3D", "3D", "TextDocument", *4 * ["TimeSeries"]]
    assert f"/{entities.CONTACT_STATE}" not in recording.columns


def test_the_contact_is_the_lowest_point_of_the_rim(recording: Recorded) -> None:
    contact, center = place(recording, f"/{entities.CONTACT}"), place(recording, f"/{entities.CENTER}")
    poses = turn(recording, f"/{entities.BODY}")
    np.testing.assert_array_equal(contact[:, 2], 0.0)
    arm = contact - center
    np.testing.assert_allclose(np.linalg.norm(arm, axis=1), 2.5, atol=1e-5)  # one unit is 1 cm
    axis = poses.apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(np.einsum("ij,ij->i", arm, axis), 0.0, atol=1e-3)  # between samples
    assert contact[:, :2].max(axis=0) + contact[:, :2].min(axis=0) == pytest.approx([0, 0], abs=1e-3)


def test_the_rim_that_is_drawn_touches_the_plane(recording: Recorded) -> None:
    rim = recording.values(f"/{entities.RIM}", "LineStrips3D:strips")[0].reshape(-1, 3)
    center, poses = place(recording, f"/{entities.CENTER}"), turn(recording, f"/{entities.BODY}")
    for k in range(0, len(center), 50):
        lowest = (poses[k].apply(rim) + center[k])[:, 2].min()
        assert lowest == pytest.approx(0.0, abs=2.5 * (1 - np.cos(np.pi / 96)))


def test_forces_are_drawn_to_one_scale(run: Run, recording: Recorded) -> None:
    weight = tips(recording, f"/{entities.WEIGHT}")
    np.testing.assert_allclose(weight, np.broadcast_to([0, 0, -3.0], weight.shape), atol=8 * FLOAT32)
    force = tips(recording, f"/{entities.CONTACT_FORCE}") / 3.0 * MASS * G
    instants = recording.time(f"/{entities.CONTACT_FORCE}")
    np.testing.assert_allclose(force, run.at(instants).quantities["contact force"], atol=1e-6)


def test_normal_force_and_friction_are_plotted(run: Run, recording: Recorded) -> None:
    normal, friction, weight = series(recording, f"/{entities.PLOT_FORCE}").T
    truth = run.quantities["contact force"]
    np.testing.assert_array_equal(normal, truth[:, 2])
    np.testing.assert_allclose(friction**2 + normal**2, (truth**2).sum(axis=1))
    np.testing.assert_allclose(weight, MASS * G)


def test_a_body_that_would_lift_off_says_when(tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [0.25, 0.25, 0.5], "mass": 1.0},
        "start": {"angular_velocity": [3.0, 2.0, -4.5], "attitude": [np.sin(0.5), 0.0, 0.0, np.cos(0.5)]},
        "constraint": {"kind": "rolling", "radius": 1.0},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 1.0, "samples": 1001, "accuracy": 1e-8},
    }
    run = simulate(Scene.from_dict(table))
    recording = written(screen(run), tmp_path / "run.rrd")
    assert "StateTimeline" in recording.views
    states = recording.texts(f"/{entities.CONTACT_STATE}", "StateChange:state")
    instant = recording.time(f"/{entities.CONTACT_STATE}")[-1]
    assert states[-1] == STATES[1]
    normal = run.quantities["contact force"][:, 2]
    assert instant == pytest.approx(run.time[np.argmax(normal < 0)], abs=1e-3)


@drawable
def test_the_viewer_shows_it_without_an_error(run: Run, tmp_path: Path) -> None:
    assert errors_seen(screen(run), tmp_path, 0.5) == []


def test_a_ball_that_slides_is_shown_with_its_slip_on_its_plane(tmp_path: Path) -> None:
    scene = Scene.load(path("scenes/tippe_top.toml"))
    normal = np.array([0.6, 0.0, 0.8])
    held = replace(scene.constraint, normal=normal)
    top = simulate(replace(scene, constraint=held, run=replace(scene.run, duration=0.2, samples=401)))
    assert top.plan.view == "disc"
    recorded = written(screen(top), tmp_path / "run.rrd")
    assert sorted(recorded.views) == ["3D", "3D", "TextDocument", *5 * ["TimeSeries"]]
    contact, center = place(recorded, f"/{entities.CONTACT}"), place(recorded, f"/{entities.CENTER}")
    np.testing.assert_allclose(contact @ normal, 0.0, atol=1e-5)
    lines = recorded.values(f"/{entities.GRID}", "LineStrips3D:strips")
    np.testing.assert_allclose(np.concatenate(list(lines)).reshape(-1, 3) @ normal, 0.0, atol=1e-5)
    middle = turn(recorded, f"/{entities.BODY}").apply([0.0, 0.0, 0.4]) + center  # one unit is 1 cm
    np.testing.assert_allclose(middle - contact, np.broadcast_to(1.8 * normal, middle.shape), atol=2e-3)
    slip = series(recorded, f"/{entities.PLOT_SLIP}")[:, 0]
    np.testing.assert_allclose(slip, np.linalg.norm(top.quantities["contact velocity"], axis=1), rtol=1e-6, atol=1e-9)
    force = series(recorded, f"/{entities.PLOT_FORCE}")
    np.testing.assert_allclose(force[:, 0], top.quantities["contact force"] @ normal, rtol=1e-6)
