"""A recording of a heavy top holds its axis on the sphere, its effective potential, and what it keeps."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.recording.kinds import FLOAT32, drawable, errors_seen, place, series, tips, turn, written
from tests.recording.reading import Recorded

from inertia import Run, Scene, simulate
from inertia.recording import entities
from inertia.recording.views.top import screen
from inertia_meshes import path

I1, I3, MGH, SPIN, TILT = 3.6e-4, 1.25e-4, 0.1 * 9.80665 * 0.04, 150.0, math.pi / 6


def shortened(name: str, **settings: float) -> Run:
    scene = Scene.load(path(f"scenes/{name}.toml"))
    return simulate(replace(scene, run=replace(scene.run, **settings)))


@pytest.fixture(scope="module")
def run() -> Run:
    return shortened("heavy_top", duration=1.0, samples=401)


@pytest.fixture(scope="module")
def recording(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return written(screen(run), tmp_path_factory.mktemp("top") / "run.rrd")


def test_the_few_samples_of_a_top_do_not_show_in_its_phase_portrait(tmp_path: Path) -> None:
    few = shortened("heavy_top", duration=1.0, samples=7)
    recording = written(screen(few), tmp_path / "run.rrd")
    point = recording.values(f"/{entities.PHASE_PORTRAIT}/point", "Points2D:positions")[:, 0]
    curves = recording.values(f"/{entities.PHASE_PORTRAIT}/run", "LineStrips2D:strips")[0]
    assert np.concatenate(list(curves)) == pytest.approx(point, abs=1e-4)
    turning = few.at(recording.time(f"/{entities.PLOT_TILT}/events"))
    assert recording.values(f"/{entities.PLOT_TILT}/events", "Scalars:scalars")[:, 0] == pytest.approx(
        turning.quantities["theta"], abs=1e-12
    )


def test_it_applies_where_gravity_has_an_arm(run: Run) -> None:
    table = {"body": {"principal_moments": [1.0, 2.0, 3.0]}, "start": {"angular_velocity": [0, 0, 1]}}
    table["run"] = {"duration": 1.0, "samples": 11}
    assert run.plan.view == "top"
    assert simulate(Scene.from_dict(table)).plan.view == "tumbling"
    assert simulate(Scene.from_dict(table | {"constraint": {"kind": "fixed_point"}})).plan.view == "tumbling"


def test_the_screen_has_its_views(recording: Recorded) -> None:
    assert recording.recording.application_id == "inertia-top"
    assert sorted(recording.views) == ["2D", "3D", "3D", "TextDocument", *5 * ["TimeSeries"]]


def test_the_centre_of_mass_hangs_on_the_fixed_point(run: Run, recording: Recorded) -> None:
    poses = turn(recording, f"/{entities.BODY}")
    np.testing.assert_allclose(recording.time(f"/{entities.BODY}"), recording.time(f"/{entities.CENTER}"))
    centers = place(recording, f"/{entities.CENTER}")
    np.testing.assert_allclose(centers, poses.apply([0.0, 0.0, 4.0]), atol=8 * FLOAT32)  # one unit is 1 cm
    np.testing.assert_allclose(poses[0].as_quat(), run.attitude[0], atol=FLOAT32)


def test_the_axis_runs_on_the_unit_sphere_between_its_turning_circles(recording: Recorded) -> None:
    axis = tips(recording, "/unit_sphere/axis")
    np.testing.assert_allclose(np.linalg.norm(axis, axis=1), 1.0, atol=4 * FLOAT32)
    # Let go at rest at TILT: u = cosθ turns where 2 mgh (u1 − u)(1 − u²) I1 = p² (u1 − u)², p = I3 ω3.
    k = (I3 * SPIN) ** 2 / (2.0 * I1 * MGH)
    u1 = math.cos(TILT)
    u2 = next(u for u in np.roots([1.0, -k, k * u1 - 1.0]).real if -1 <= u < u1)
    circles = recording.values("/unit_sphere/turning_circles", "LineStrips3D:strips")[0]
    heights = np.array([strip[:, 2].mean() for strip in np.reshape(circles, (2, -1, 3))])
    np.testing.assert_allclose(heights, [u1, u2], atol=1e-6)
    assert axis[:, 2].max() == pytest.approx(u1, abs=1e-3)
    assert axis[:, 2].min() == pytest.approx(u2, abs=1e-3)


def test_the_tilt_is_plotted_at_every_sample(run: Run, recording: Recorded) -> None:
    space = Rotation.from_quat(run.attitude).apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(series(recording, f"/{entities.PLOT_TILT}")[:, 0], np.arccos(space[:, 2]), atol=1e-12)
    assert series(recording, f"/{entities.PLOT_EULER_ANGLES}").shape == (401, 2)
    assert series(recording, f"/{entities.PLOT_DRIFT}").shape == (401, 3)
    names = recording.texts(f"/{entities.PLOT_DRIFT}", "SeriesLines:names")
    assert [name.split(",")[0] for name in names] == ["energy", "vertical L", "L along the axis"]


def test_turning_points_that_are_left_out_are_spoken_of(tmp_path: Path) -> None:
    run = shortened("heavy_top", duration=70.0, samples=7001)
    recording = written(screen(run), tmp_path / "run.rrd")
    assert len(recording.time(f"/{entities.PLOT_TILT}/events")) == len(run.events) == 1000
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "The first 1000 turning points are marked on the plot of the tilt, no later ones" in text


def test_the_spin_is_plotted_beside_the_least_to_sleep(recording: Recorded) -> None:
    """Upright it is stable where I₃² ω₃² > 4 I₁ M g h."""
    spin, least = series(recording, f"/{entities.PLOT_SPIN}").T
    np.testing.assert_allclose(spin, SPIN, rtol=1e-9)
    np.testing.assert_allclose(least, 2.0 * math.sqrt(I1 * MGH) / I3, rtol=1e-9)
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "sleep from 60.13 rad/s about its axis on: its spin of 150 is enough" in text


def test_the_weight_hangs_from_the_centre_of_mass(recording: Recorded) -> None:
    ((arrow,),) = recording.values(f"/{entities.WEIGHT}", "Arrows3D:vectors").astype(float)
    np.testing.assert_allclose(arrow / np.linalg.norm(arrow), [0.0, 0.0, -1.0], atol=1e-6)
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "The weight mg (green) is 0.9807 N." in text


def test_the_point_stays_on_the_effective_potential_and_below_the_energy(run: Run, recording: Recorded) -> None:
    p = I3 * SPIN
    points = recording.values(f"/{entities.EFFECTIVE_POTENTIAL}/point", "Points2D:positions")[:, 0].astype(float)
    (level,) = {round(float(y), 3) for y in np.ravel(_strip(recording, "energy"))[1::2]}
    assert points[:, 1].min() > level - 1e-2  # y points down
    instants = recording.time(f"/{entities.EFFECTIVE_POTENTIAL}/point")
    spun = Rotation.from_quat(run.at(instants).attitude).apply([0.0, 0.0, 1.0])
    theta = np.arccos(spun[:, 2])
    potential = (p * math.cos(TILT) - p * np.cos(theta)) ** 2 / (2 * I1 * np.sin(theta) ** 2) + MGH * np.cos(theta)
    slope, offset = np.polyfit(potential, points[:, 1], 1)
    assert slope < 0
    np.testing.assert_allclose(points[:, 1], slope * potential + offset, atol=0.05)
    assert slope * MGH * math.cos(TILT) + offset == pytest.approx(level, abs=0.05)  # at rest, E′ = V


def _strip(recording: Recorded, name: str) -> np.ndarray:
    return recording.values(f"/{entities.EFFECTIVE_POTENTIAL}/{name}", "LineStrips2D:strips")[0]


def test_a_general_top_has_no_effective_potential(tmp_path: Path) -> None:
    recording = written(screen(shortened("kovalevskaya_top", duration=2.0)), tmp_path / "run.rrd")
    assert not any(entities.EFFECTIVE_POTENTIAL in name for name in recording.columns)
    assert not any("turning_circles" in name for name in recording.columns)
    assert "2D" not in recording.views


def test_the_tilt_is_from_the_vertical_wherever_that_points(tmp_path: Path) -> None:
    turned = Rotation.from_rotvec([0.3, 1.1, -0.4])
    tilted = Rotation.from_rotvec([0.5, 0.0, 0.0])
    recording = []
    for number, how in enumerate((Rotation.identity(), turned)):
        table = {
            "body": {"principal_moments": [0.02, 0.0175, 0.0075], "mass": 1.0, "center_of_mass": [0.05, 0.0, 0.0]},
            "start": {"angular_velocity": [1, 2, 15], "frame": "part", "attitude": (how * tilted).as_quat()},
            "constraint": {"kind": "fixed_point"},
            "load": [{"kind": "gravity", "acceleration": how.apply([0.0, 0.0, -9.8])}],
            "run": {"duration": 1.0, "samples": 101, "accuracy": 1e-9},
        }
        recording.append(written(screen(simulate(Scene.from_dict(table))), tmp_path / f"{number}.rrd"))
    first, second = (series(each, f"/{entities.PLOT_TILT}") for each in recording)
    np.testing.assert_allclose(first, second, atol=1e-8)


@pytest.mark.parametrize(("attitude", "spin"), [([1.0, 0, 0, 0], 0.0), ([0, 0, 0, 1.0], 200.0)])
def test_a_top_whose_axis_stays_vertical_is_shown(attitude: list[float], spin: float, tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [2e-4, 2e-4, 1.25e-4], "mass": 0.1, "center_of_mass": [0, 0, 0.04]},
        "start": {"angular_velocity": [0, 0, spin], "attitude": attitude},
        "constraint": {"kind": "fixed_point"},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 0.1, "samples": 101, "accuracy": 1e-9},
    }
    recording = written(screen(simulate(Scene.from_dict(table))), tmp_path / "run.rrd")
    axis = tips(recording, "/unit_sphere/axis")
    np.testing.assert_allclose(axis, np.broadcast_to([0, 0, 1 if spin else -1], axis.shape), atol=1e-6)


def test_a_spherical_pendulum_is_shown_without_a_spin_that_would_keep_it_upright(tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [0, 0, 0], "mass": 2.0, "center_of_mass": [0, 0, -1.0]},
        "start": {"angular_velocity": [1.0, 2.0, 0.5]},
        "constraint": {"kind": "fixed_point"},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 1.0, "samples": 11},
    }
    with np.errstate(all="raise"):
        recording = written(screen(simulate(Scene.from_dict(table))), tmp_path / "run.rrd")
    np.testing.assert_allclose(series(recording, f"/{entities.PLOT_SPIN}"), -0.5)
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "no spin would keep it upright" in text


@drawable
def test_the_viewer_shows_it_without_an_error(run: Run, tmp_path: Path) -> None:
    assert errors_seen(screen(run), tmp_path, 0.5) == []
