"""How fast a run is played, and its poses between samples."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from tests.recording.reading import Recorded
from tests.recording.scenes import scene_table

from inertia import Scene, record, simulate
from inertia.errors import GeometryError
from inertia.recording import entities
from inertia.recording.playback import LONGEST, MOST, NEAR, RATE, SHORTEST, frames_of, playback


@pytest.mark.parametrize(
    ("fastest", "duration", "speed", "message"),
    [
        (3.0, 10.0, 1.0, "played in real time"),
        (10.0, 60.0, 0.5, "played 2 times slower than it is"),
        (1257.0, 0.1, 0.002, "played 500 times slower than it is"),
        (1e-3, 5400.0, 1000.0, "played 1000 times faster than it is"),
        (1e-3, 4.0, 1.0, "played in real time"),
        (1e-3, 0.1, 0.02, "played 50 times slower than it is"),
    ],
)
def test_the_speed_lets_the_motion_be_followed(fastest: float, duration: float, speed: float, message: str) -> None:
    play = playback(np.linspace(0, duration, 10_001), fastest)
    assert play.speed == pytest.approx(speed)
    assert play.notes == (message,)


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e6))
def test_frames_are_near_each_other_and_the_playback_ends(fastest: float, duration: float) -> None:
    time = np.linspace(0, duration, 101)
    play = playback(time, fastest)
    tick = 1e-9 * play.second
    assert play.frames[0] == 0
    assert duration - 1.01 * tick <= play.frames[-1] <= duration
    near = play.frames[: play.near]
    assert np.diff(near).max() <= min(NEAR / fastest, max(play.speed / RATE, near[-1] / MOST)) * (1 + 1e-6) + tick
    assert len(play.frames) <= 3 * MOST
    assert near[-1] == pytest.approx(play.loop[1] * play.second if play.loop else duration, abs=1.01 * tick)
    assert SHORTEST * (1 - 1e-9) <= near[-1] / play.speed <= LONGEST * 2.6


def test_what_turns_too_often_to_be_drawn_loops_while_poses_are_near() -> None:
    time = np.linspace(0, 1e4, 101)
    play = playback(time, 5.0)
    end = MOST * NEAR / 5.0
    assert play.loop == pytest.approx((0.0, end))
    assert f"the loop is the first {end:g} s" in play.notes[1]
    assert np.diff(play.frames[: play.near]).max() <= NEAR / 5.0 * (1 + 1e-9)
    assert play.frames[play.near - 1] == pytest.approx(end)
    assert np.array_equal(play.frames[play.near :], time[time > end + 1e-9])


def test_samples_that_are_near_enough_are_the_poses() -> None:
    time = np.linspace(0, 10, 100_001)
    play = playback(time, 3.0)
    assert set(play.frames) <= set(time)
    assert (play.frames[0], play.frames[-1]) == (0, 10)
    assert np.diff(play.frames).max() <= 1 / 60
    assert len(play.frames) <= 10 * 61


def precession(time: np.ndarray) -> Rotation:
    """The attitude of a body of moments 2, 2, 3 kg m² with ω = (1, 0, 20) rad/s, its own axes being those of space at
    first: about L at |L|/I₁, and about its own axis at ω₃ (1 − I₃/I₁)."""
    momentum = np.array([2.0, 0.0, 60.0])
    return Rotation.from_rotvec(np.outer(time, momentum / 2.0)) * Rotation.from_rotvec(
        np.outer(time, [0.0, 0.0, 20.0 * (1.0 - 3.0 / 2.0)])
    )


@pytest.mark.parametrize("samples", [3, 40, 4001])
def test_poses_are_the_model_s_however_far_apart_the_samples_are(samples: int) -> None:
    scene = {
        "body": {"principal_moments": [2.0, 2.0, 3.0]},
        "start": {"angular_velocity": [1.0, 0.0, 20.0]},
        "run": {"duration": 7.0, "samples": samples},
    }
    run = simulate(Scene.from_dict(scene))
    frames = frames_of(run)
    drawn = Rotation.from_quat(frames.attitude)
    assert (drawn * precession(frames.time).inv()).magnitude().max() < 1e-12
    turned = (drawn[1:] * drawn[:-1].inv()).magnitude().max()
    assert turned <= NEAR * (1 + 1e-9)
    assert f"the body turns by {turned:.2g} rad at most" in frames.note
    assert "to 1.2·10⁻⁷ rad in single precision" in frames.note


@pytest.mark.parametrize("duration", [0.01, 0.01 / 3.0, 1e-5])
@pytest.mark.parametrize(("samples", "spin"), [(4, 1e5), (2401, 1e4), (7, 3e3)])
def test_poses_are_the_model_s_at_the_nanoseconds_that_they_are_filed_under(
    tmp_path: Path, samples: int, spin: float, duration: float
) -> None:
    """The motion is exact: a steady spin, which turns by up to 5e-5 rad in half a nanosecond."""
    scene = Scene.from_dict(
        {
            "body": {"principal_moments": [1.0, 2.0, 3.0]},
            "start": {"angular_velocity": [0.0, 0.0, spin]},
            "run": {"duration": duration, "samples": samples},
        }
    )
    run = simulate(scene)
    record(run, tmp_path / "spin.rrd")
    recorded = Recorded(tmp_path / "spin.rrd")
    (second,) = recorded.values("/__properties/timeline", "second_s").ravel()
    filed = second * recorded.time(f"/{entities.BODY}")
    drawn = recorded.values(f"/{entities.BODY}", "Transform3D:quaternion")[:, 0].astype(float)
    exact = Rotation.from_rotvec(np.outer(filed, [0.0, 0.0, spin]))
    assert duration - 1.01e-9 * second <= filed[-1] <= duration * (1 + 1e-15)
    assert (Rotation.from_quat(drawn) * exact.inv()).magnitude().max() < 1.2e-7
    assert "to 1.2·10⁻⁷ rad in single precision" in frames_of(run).note


def test_a_run_that_cannot_be_followed_says_what_it_turns_on_the_way_to_a_nanosecond() -> None:
    """Its samples are whole sevenths of a microsecond, three sevenths of a nanosecond off at most."""
    scene = {
        "body": {"principal_moments": [1.0, 2.0, 3.0]},
        "start": {"angular_velocity": [0.0, 0.0, 1e5]},
        "run": {"duration": 1e-3, "samples": 7001},
    }
    frames = frames_of(replace(simulate(Scene.from_dict(scene)), follow=None))
    assert "to 4.3·10⁻⁵ rad in single precision" in frames.note


@pytest.mark.parametrize("samples", [2, 5, 61])
@pytest.mark.parametrize("look", ["pendulum", "top"])
def test_poses_are_near_where_the_body_turns_faster_than_at_its_samples(look: str, samples: int) -> None:
    """A pendulum that nearly goes over is fast below and slow above, a top that falls is fast at its lowest."""
    if look == "pendulum":  # whose period is 2 s: it rests at each of the 61 samples, or at every 30th
        held: dict[str, Any] = {"kind": "hinge", "axis": [1.0, 0.0, 0.0]}
        body = {"principal_moments": [0.02, 0.02, 0.01], "mass": 1.0, "center_of_mass": [0.0, 0.0, -0.5]}
        start = {"angular_velocity": [0.0, 0.0, 0.0], "attitude": [0.9, 0.0, 0.0, np.sqrt(1.0 - 0.81)]}
    else:
        held = {"kind": "fixed_point"}
        body = {"principal_moments": [1.0, 1.0, 0.5], "mass": 1.0, "center_of_mass": [0.0, 0.0, 1.0]}
        start = {"angular_velocity": [0.0, 0.0, 3.0], "attitude": [0.2, 0.0, 0.0, np.sqrt(1.0 - 0.04)]}
    table = {"body": body, "start": start, "constraint": held, "load": [{"kind": "gravity"}]}
    run = simulate(Scene.from_dict(table | {"run": {"duration": 60.0, "samples": samples, "accuracy": 1e-6}}))
    frames = frames_of(run)
    drawn = Rotation.from_quat(frames.attitude[: frames.play.near])
    assert (drawn[1:] * drawn[:-1].inv()).magnitude().max() <= 1.01 * NEAR
    fastest = np.linalg.norm(run.at(np.linspace(0.0, 60.0, 2001)).angular_velocity, axis=1).max()
    assert fastest * frames.play.speed <= 2.0 * np.pi * 1.01  # one turn a second on the screen


@pytest.mark.parametrize("samples", [3, 61])
def test_a_loop_goes_on_where_a_body_at_rest_begins_to_turn_fast(samples: int) -> None:
    """At rest up to 30 s, 250 rad/s about an axis for half a second, and at rest again."""
    rows = [[0, 0], [30, 0], [30, 500], [30.5, 500], [30.5, 0], [31, 0], [31, -500], [31.5, -500], [31.5, 0], [60, 0]]
    table = [[time, torque, 0, 0] for time, torque in rows]
    run = simulate(
        Scene.from_dict(
            {
                "body": {"principal_moments": [1.0, 2.0, 2.5]},
                "start": {"angular_velocity": [1e-3, 0.0, 0.0]},
                "load": [{"kind": "torque", "table": table}],
                "run": {"duration": 60.0, "samples": samples},
            }
        )
    )
    frames = frames_of(run)
    assert frames.play.loop is None
    assert frames.play.near == len(frames.time) <= 2 * MOST
    drawn = Rotation.from_quat(frames.attitude)
    assert (drawn[1:] * drawn[:-1].inv()).magnitude().max() <= 1.01 * NEAR
    assert ((frames.time > 30.0) & (frames.time < 31.5)).sum() > 250.0 / NEAR


def test_a_loop_is_as_long_as_its_poses_last_where_a_body_is_fast_at_its_end_alone() -> None:
    table = [[0, 0, 0, 0], [59, 0, 0, 0], [60, 400, 0, 0]]
    scene = {
        "body": {"principal_moments": [1.0, 2.0, 2.5]},
        "start": {"angular_velocity": [1e-3, 0.0, 0.0]},
        "load": [{"kind": "torque", "table": table}],
        "run": {"duration": 60.0, "samples": 3},
    }
    frames = frames_of(simulate(Scene.from_dict(scene)))
    assert frames.play.loop is None
    assert ((frames.time > 59.0) & (frames.time <= 60.0)).sum() > 400.0 / 6.0 / NEAR


def test_a_run_that_cannot_be_followed_again_is_shown_at_its_samples(tmp_path: Path) -> None:
    scene = Scene.from_dict(scene_table("asymmetric"))
    for samples in (101, 12):
        run = replace(simulate(replace(scene, run=replace(scene.run, samples=samples))), follow=None)
        frames = frames_of(run)
        assert np.array_equal(frames.attitude, run.attitude)
        assert frames.play.near == (samples if samples == 101 else 0)
        assert "could not be followed between its samples" in frames.play.notes[-1]
        record(run, tmp_path / f"{samples}.rrd")


@pytest.mark.parametrize(
    ("duration", "second", "message"),
    [
        (60.0, 1.0, None),
        (9e9, 1.0, None),
        (9.3e9, 1e9, "on the timeline 1 s is 1e9 s of the run"),
        (1e20, 1e18, "on the timeline 1 s is 1e18 s of the run"),
        (1e-3, 1.0, None),
        (9e-5, 1e-6, "on the timeline 1 s is 1 µs of the run"),
        (1e-9, 1e-9, "on the timeline 1 s is 1 ns of the run"),
        (1e-20, 1e-21, "on the timeline 1 s is 1e-21 s of the run"),
    ],
)
def test_time_is_scaled_where_nanoseconds_do_not_suit_it(duration: float, second: float, message: str | None) -> None:
    time = np.linspace(0, duration, 1001)
    play = playback(time, 1.0 / duration)
    assert play.second == pytest.approx(second)
    assert play.end == pytest.approx(duration / second)
    assert play.pace == pytest.approx(play.speed / second)
    assert play.end / play.pace >= SHORTEST * (1 - 1e-9)
    assert (play.notes[0] == message) == (message is not None)
    for each in (time, play.frames):
        assert len(set(np.round(each / second * 1e9).astype(np.int64))) == len(each)


def test_a_run_of_years_with_samples_within_nanoseconds_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"samples lie 1e-09 s from each other in a run that ends at 1e\+10 s"):
        playback(np.array([0.0, 1e-9, 1e10]), 1.0)


def test_a_needle_is_played_as_fast_as_its_long_axis_turns() -> None:
    table = {
        "start": {"angular_velocity": [80.0, 0.5, 0.0]},
        "run": {"duration": 20.0, "samples": 401, "accuracy": 1e-8},
    }
    needle = {"body": {"principal_moments": [0.02, 1.0, 1.0]}}
    bar = {"body": {"principal_moments": [0.2, 1.0, 1.0]}}
    assert frames_of(simulate(Scene.from_dict(table | needle))).play.speed == 1.0
    assert frames_of(simulate(Scene.from_dict(table | bar))).play.speed == 0.05
