"""A recording of a body that is driven holds what becomes of L and of the energy."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.recording.kinds import drawable, errors_seen, place, series, tips, written

from inertia import Run, Scene, simulate
from inertia.recording import entities
from inertia.recording.views.driven import screen
from inertia_meshes import path


def made(moments: list[float], spin: list[float], load: list[dict[str, Any]], **settings: float) -> Run:
    table = {"body": {"principal_moments": moments}, "start": {"angular_velocity": spin}, "load": load}
    return simulate(Scene.from_dict(table | {"run": {"duration": 10.0, "samples": 201, "accuracy": 1e-9} | settings}))


def test_it_applies_where_something_acts() -> None:
    assert made([1, 2, 3], [0, 0, 1], [{"kind": "damping", "coefficient": 0.1}]).plan.view == "driven"
    assert made([1, 2, 3], [0, 0, 1], []).plan.view == "tumbling"


def test_a_damped_sphere_loses_its_momentum_exponentially(tmp_path: Path) -> None:
    run = made([2.0, 2.0, 2.0], [0.3, 0.0, 0.4], [{"kind": "damping", "coefficient": 0.4}])
    recording = written(screen(run), tmp_path / "run.rrd")
    decay = np.exp(-0.2 * recording.time(f"/{entities.PLOT_MOMENTUM}"))
    np.testing.assert_allclose(
        series(recording, f"/{entities.PLOT_MOMENTUM}"), decay[:, None] * [0.6, 0.0, 0.8, 1.0], atol=1e-8
    )
    np.testing.assert_allclose(series(recording, f"/{entities.PLOT_ENERGY}")[:, 0], 0.25 * decay**2, atol=1e-8)
    arrow = np.linalg.norm(tips(recording, f"/{entities.CURRENT}"), axis=1)
    np.testing.assert_allclose(arrow, np.exp(-0.2 * recording.time(f"/{entities.CURRENT}")), atol=2e-4)
    radius = recording.values(f"/{entities.MOMENTUM_SPHERE}", "Ellipsoids3D:half_sizes")[:, 0, 0]
    np.testing.assert_allclose(radius, arrow, rtol=1e-5)
    assert sorted(recording.views) == ["3D", "3D", "TextDocument", *7 * ["TimeSeries"]]


@pytest.mark.parametrize("name", ["boom_satellite", "detumbling", "gravity_gradient", "manoeuvre"])
def test_the_torque_is_the_rate_of_the_angular_momentum(name: str, tmp_path: Path) -> None:
    run = simulate(Scene.load(path(f"scenes/{name}.toml")))
    recording = written(screen(run), tmp_path / "run.rrd")
    torque = series(recording, f"/{entities.PLOT_TORQUE}")
    rate = np.gradient(run.angular_momentum, run.time, axis=0, edge_order=2)
    size = np.linalg.norm(rate, axis=1).max()
    assert len(torque) == len(run.time)
    np.testing.assert_allclose(torque[:, 3], np.linalg.norm(torque[:, :3], axis=1), rtol=1e-9)
    off = np.linalg.norm(torque[:, :3] - rate, axis=1)
    assert np.median(off) < 1e-4 * size
    assert off.max() < 2e-2 * size  # the table has kinks, where differences of samples are no rate
    arrow = tips(recording, f"/{entities.TORQUE}")
    at = np.searchsorted(run.time, recording.time(f"/{entities.TORQUE}")).clip(0, len(run.time) - 1)
    large = np.linalg.norm(arrow, axis=1) > 0
    cosine = (arrow[large] * torque[at[large], :3]).sum(axis=1)
    assert np.median(cosine / np.linalg.norm(arrow[large], axis=1) / torque[at[large], 3].clip(1e-300)) > 0.999


def test_the_forces_that_hold_an_axle_are_those_of_the_couple(tmp_path: Path) -> None:
    """A disc 1° off its axle: (I₃ − I₁) ω² sin τ cos τ over the 0.2 m from bearing to bearing, on each."""
    run = simulate(Scene.load(path("scenes/tilted_disc.toml")))
    recording = written(screen(run), tmp_path / "run.rrd")
    tilt, speed = np.radians(1.0), 100.0 * np.pi
    forces = series(recording, f"/{entities.PLOT_REACTION}")
    assert forces.shape == (401, 1)  # both are the same, and one would hide the other
    each = 0.05 * speed**2 * np.sin(tilt) * np.cos(tilt) / 0.2
    np.testing.assert_allclose(forces, each, rtol=1e-9)
    np.testing.assert_allclose(recording.property("ScalarAxis:range"), [[0.0, 1.15 * each]], rtol=1e-9)


def test_a_rod_askew_on_its_axle_has_a_flat_ellipsoid_of_its_energy(tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [0, 1, 1]},
        "start": {"angular_velocity": [6, 0, 8]},
        "constraint": {"kind": "hinge", "axis": [0.6, 0, 0.8], "drive": "constant_speed"},
        "run": {"duration": 1.0, "samples": 11},
    }
    with np.errstate(all="raise"):
        recording = written(screen(simulate(Scene.from_dict(table))), tmp_path / "run.rrd")
    ellipsoids = recording.values(f"/{entities.ENERGY_ELLIPSOID}", "Ellipsoids3D:half_sizes").astype(float)
    np.testing.assert_allclose(ellipsoids.reshape(-1, 3), [[0, 1, 1]] * len(ellipsoids), atol=1e-6)


def test_what_is_lost_inside_is_no_torque(tmp_path: Path) -> None:
    run = made([1.0, 2.0, 3.0], [1.0, 0.1, 0.0], [{"kind": "dissipation", "rate": 0.1}])
    recording = written(screen(run), tmp_path / "run.rrd")
    assert f"/{entities.TORQUE}" not in recording.columns
    assert f"/{entities.PLOT_TORQUE}" not in recording.columns


def test_the_primary_of_a_fixed_gradient_is_shown(tmp_path: Path) -> None:
    load = {"kind": "gravity_gradient", "mu": 3.986e14, "position": [0.0, -7e6, 0.0]}
    recording = written(screen(made([1.0, 2.0, 3.0], [0, 0, 1e-3], [load])), tmp_path / "run.rrd")
    down = tips(recording, f"/{entities.PRIMARY}")
    np.testing.assert_allclose(down / np.linalg.norm(down, axis=1)[:, None], [[0.0, 1.0, 0.0]] * len(down), atol=1e-6)
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "7e+06 m away" in text


def test_a_body_that_starts_at_rest_is_shown(tmp_path: Path) -> None:
    run = made([1.0, 2.0, 3.0], [0, 0, 0], [{"kind": "torque", "torque": [0.0, 0.0, 0.3]}])
    recording = written(screen(run), tmp_path / "run.rrd")
    t = recording.time(f"/{entities.CURRENT}")
    np.testing.assert_allclose(tips(recording, f"/{entities.CURRENT}")[:, 2], t / 10.0, atol=1e-6)


def test_a_body_in_orbit_is_shown_with_the_way_down(tmp_path: Path) -> None:
    orbit = {"kind": "orbit", "mu": 1.0, "semi_major_axis": 1.0}
    run = made([1.0, 2.0, 3.0], [0, 0, 1.0], [orbit])
    recording = written(screen(run), tmp_path / "run.rrd")
    down = tips(recording, f"/{entities.PRIMARY}")
    t = recording.time(f"/{entities.PRIMARY}")
    expected = -np.stack([np.cos(t), np.sin(t), 0.0 * t], axis=1)
    np.testing.assert_allclose(down / np.linalg.norm(down, axis=1)[:, None], expected, atol=2e-3)


@pytest.mark.parametrize("name", ["boom_satellite", "explorer_1", "gravity_gradient", "manoeuvre"])
def test_the_samples_are_written_whole(name: str, tmp_path: Path) -> None:
    run = simulate(Scene.load(path(f"scenes/{name}.toml")))
    recording = written(screen(run), tmp_path / "run.rrd")
    assert (f"/{entities.PLOT_ENERGY}" in recording.columns) == ("energy" not in run.invariants)
    assert (f"/{entities.PLOT_DRIFT}" in recording.columns) == bool(run.invariants)
    assert f"/{entities.TRAIL_OF_MOMENTUM}" in recording.columns


@drawable
def test_the_viewer_shows_it_without_an_error(tmp_path: Path) -> None:
    run = made([1.0, 2.0, 3.0], [0.1, 1.0, 0.2], [{"kind": "damping", "coefficient": 0.1}])
    assert errors_seen(screen(run), tmp_path, 5.0) == []


def test_a_pendulum_goes_round_its_axle_and_runs_through_its_phase_portrait(tmp_path: Path) -> None:
    """A rod of 1 m on a pin at its end: ½ J ω² + V, with J = I + m d² and V = m g d cos θ, its tilt from upright."""
    run = simulate(Scene.load(path("scenes/pendulum.toml")))
    recording = written(screen(run), tmp_path / "run.rrd")
    assert sorted(recording.views) == ["2D", "3D", "TextDocument", *6 * ["TimeSeries"]]
    time = recording.time(f"/{entities.CENTER}")
    there = run.at(time)
    tilt = there.quantities["angle"] + np.radians(1.0)
    expected = 5.0 * np.stack([0.0 * tilt, -np.sin(tilt), np.cos(tilt)], axis=1)  # one unit is 0.1 m
    np.testing.assert_allclose(place(recording, f"/{entities.CENTER}"), expected, atol=1e-5)
    below, above = (
        recording.values(f"/{name}/point", "Points2D:positions")[:, 0].astype(float)
        for name in (entities.PHASE_PORTRAIT, entities.EFFECTIVE_POTENTIAL)
    )
    np.testing.assert_allclose(below[:, 0], above[:, 0], atol=1e-4)
    potential = 9.80665 * 0.5 * np.cos(tilt)
    rate = there.angular_velocity[:, 0]
    for drawn, values in ((above[:, 1], potential), (below[:, 1], rate), (below[:, 0], tilt)):
        slope, offset = np.polyfit(values, drawn, 1)
        np.testing.assert_allclose(drawn, slope * values + offset, atol=1e-3)
    level = recording.values(f"/{entities.EFFECTIVE_POTENTIAL}/energy", "LineStrips2D:strips")[:, 0, :, 1].astype(float)
    slope, offset = np.polyfit(potential, above[:, 1], 1)
    energy = 0.5 * (0.0834 + 0.25) * rate**2 + potential
    np.testing.assert_allclose(level, (slope * energy + offset)[:, None].repeat(2, 1), atol=1e-3)


def swinging(spin: float, samples: int, **held: float) -> Run:
    """Return a pendulum with m g l = 9.80665 J and 2 kg m² about its axle, that starts below."""
    table = {
        "body": {"principal_moments": [1.0, 2.0, 2.5], "mass": 1.0, "center_of_mass": [0.0, 0.0, -1.0]},
        "start": {"angular_velocity": [spin, 0.0, 0.0]},
        "constraint": {"kind": "hinge", "axis": [1.0, 0.0, 0.0], **held},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 60.0, "samples": samples},
    }
    return simulate(Scene.from_dict(table))


@pytest.mark.parametrize("samples", [2, 61, 6001])
def test_the_curve_of_a_phase_portrait_does_not_depend_on_the_samples(samples: int, tmp_path: Path) -> None:
    """½·2·θ̇² − m g l cosθ = ½·2·2² − m g l: one closed curve through θ̇ = ±2 rad/s and θ = ±0.937 rad."""
    recording = written(screen(swinging(2.0, samples)), tmp_path / "run.rrd")
    (curve,) = recording.values(f"/{entities.PHASE_PORTRAIT}/run", "LineStrips2D:strips")[0].astype(float)
    labels = recording.texts(f"/{entities.PHASE_PORTRAIT}/numbers", "Points2D:labels")
    point = recording.values(f"/{entities.PHASE_PORTRAIT}/point", "Points2D:positions")[:, 0].astype(float)
    there = swinging(2.0, 2).at(recording.time(f"/{entities.PHASE_PORTRAIT}/point").clip(max=60.0))
    theta, rate = there.quantities["angle"], there.angular_velocity[:, 0]
    assert np.abs(point[:, None] - curve[None, ::7]).max(axis=2).min(axis=1).max() < 8.0  # of 400 either way
    (across, left), (up, middle) = (
        np.polyfit(drawn, values, 1) for drawn, values in zip(point.T, (theta, rate), strict=True)
    )
    theta, rate = across * curve[:, 0] + left, up * curve[:, 1] + middle
    energy = rate**2 - 9.80665 * np.cos(theta)
    np.testing.assert_allclose(energy, 4.0 - 9.80665, atol=1e-3)
    assert np.abs(theta).max() == pytest.approx(np.arccos(1.0 - 4.0 / 9.80665), abs=1e-3)
    assert np.abs(rate).max() == pytest.approx(2.0, abs=1e-3)
    assert labels


@pytest.mark.parametrize(("spin", "seen"), [(2.0, False), (4.2, True), (4.5, True), (12.0, False)])
def test_a_separatrix_is_named_where_it_is_seen(spin: float, seen: bool, tmp_path: Path) -> None:
    """It is at |θ̇| = 2 √(m g l/J) |cos ½θ|, 4.43 rad/s at most."""
    recording = written(screen(swinging(spin, 301)), tmp_path / "run.rrd")
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert ("a separatrix" in text) == seen
    assert (f"/{entities.PHASE_PORTRAIT}/separatrix" in recording.columns) == seen


def test_a_loop_that_ends_early_says_how_far_the_curve_of_its_phase_portrait_goes(tmp_path: Path) -> None:
    """Of 2,400 rad in 300 s; the separatrix of 400 turns would be a band."""
    run = swinging(8.0, 9)
    run = simulate(replace(run.scene, run=replace(run.scene.run, duration=300.0, accuracy=1e-7)))
    recording = written(screen(run), tmp_path / "run.rrd")
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "the yellow curve of the phase portrait, which is drawn as far as the loop goes." in text
    assert not {f"/{entities.PHASE_PORTRAIT}/{name}" for name in ("levels", "separatrix")} & recording.columns.keys()


@pytest.mark.parametrize(
    ("load", "course"),
    [
        ({"kind": "damping", "coefficient": 0.3}, "falls"),
        ({"kind": "torque", "torque": [3.0, 0.0, 0.0]}, "goes up and down"),
        ({"kind": "torque", "torque": [30.0, 0.0, 0.0]}, "grows"),
    ],
)
def test_the_energy_of_a_driven_hinge_goes_as_it_is_said_to(load: dict[str, Any], course: str, tmp_path: Path) -> None:
    """From rest below: with N > m g l it goes round for good, with less it comes back."""
    scene = swinging(2.0 if course == "falls" else 0.0, 9).scene
    table = scene.to_dict()
    table["load"] = [*table["load"], load]
    table["run"] = table["run"] | {"duration": 5.0}
    recording = written(screen(simulate(Scene.from_dict(table))), tmp_path / "run.rrd")
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert f"its energy (orange), which {course}, and along the yellow curve" in text
    energy = series(recording, f"/{entities.PLOT_ENERGY}")[:, 0]
    assert (energy[-1] > energy[0]) == (course != "falls")


def test_a_hinged_body_at_rest_has_no_polhodes(tmp_path: Path) -> None:
    recording = written(screen(swinging(0.0, 21)), tmp_path / "run.rrd")
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert "L is zero at all times, so that the body view has neither momentum sphere nor energy ellipsoid" in text
    assert "polhode" not in text
    assert f"/{entities.SEPARATRIX}" not in recording.columns


def test_the_forces_on_bearings_are_equal_and_opposite_arrows(tmp_path: Path) -> None:
    recording = written(screen(simulate(Scene.load(path("scenes/tilted_disc.toml")))), tmp_path / "run.rrd")
    first, second = (tips(recording, f"/{entities.AXLE}/{name}/force") for name in "AB")
    np.testing.assert_allclose(first, -second, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(first, axis=1), np.linalg.norm(first[0]), rtol=1e-5)
    places = [recording.values(f"/{entities.AXLE}/{name}", "Transform3D:translation")[0, 0] for name in "AB"]
    axle = np.array([np.sin(np.radians(1.0)), 0.0, np.cos(np.radians(1.0))])
    np.testing.assert_allclose(places[1] - places[0], 2.0 * axle, atol=1e-6)  # 0.2 m, one unit is 0.1 m
    np.testing.assert_allclose(first @ axle, 0.0, atol=1e-4)


def test_a_spring_has_no_separatrix(tmp_path: Path) -> None:
    table = {
        "body": {"principal_moments": [1.0, 1.0, 2.0], "mass": 1.0},
        "start": {"angular_velocity": [0, 0, 1.0]},
        "constraint": {"kind": "hinge", "axis": [0, 0, 1.0], "stiffness": 8.0},
        "run": {"duration": 6.0, "samples": 301, "accuracy": 1e-9},
    }
    recording = written(screen(simulate(Scene.from_dict(table))), tmp_path / "run.rrd")
    assert f"/{entities.PHASE_PORTRAIT}/levels" in recording.columns
    assert f"/{entities.PHASE_PORTRAIT}/separatrix" not in recording.columns
    angle, rate = series(recording, f"/{entities.PLOT_ANGLE}").T
    np.testing.assert_allclose(angle, 0.5 * np.sin(2.0 * recording.time(f"/{entities.PLOT_ANGLE}")), atol=1e-8)
    np.testing.assert_allclose(rate**2 + 4.0 * angle**2, 1.0, atol=1e-8)
