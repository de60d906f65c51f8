"""How fast a run is played, and attitudes between its samples."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from inertia.errors import GeometryError
from inertia.recording.playback import LONGEST, RATE, SHORTEST, attitudes_at, playback, values_at


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
def test_frames_are_uniform_and_the_playback_ends(fastest: float, duration: float) -> None:
    time = np.linspace(0, duration, 101)
    play = playback(time, fastest)
    assert play.frames[0] == 0
    assert play.frames[-1] == duration
    if play.smooth:
        np.testing.assert_allclose(np.diff(play.frames), play.frames[1], rtol=1e-9)
    if play.smooth:
        assert play.speed / play.frames[1] >= RATE * (1 - 1e-9) or len(play.frames) == 2
        assert len(play.frames) <= LONGEST * RATE * 1.01 + 2
    assert duration / play.speed >= SHORTEST * (1 - 1e-9)


def test_samples_too_far_apart_are_shown_as_they_are() -> None:
    time = np.linspace(0, 10, 11)
    play = playback(time, 5.0)
    assert not play.smooth
    assert np.array_equal(play.frames, time)
    assert "the body turns by up to 5 rad between samples" in play.notes[1]


def test_attitudes_between_samples_are_on_the_shortest_turn() -> None:
    rng = np.random.default_rng(5)
    time = np.sort(rng.uniform(0, 10, 40))
    turns = Rotation.from_rotvec(rng.uniform(-0.4, 0.4, (40, 3)).cumsum(axis=0))
    instants = np.linspace(time[0], time[-1], 301)
    signs = np.where(rng.random(40) < 0.5, -1.0, 1.0)[:, None]
    attitudes = Rotation.from_quat(attitudes_at(time, turns.as_quat() * signs, instants))
    away = (attitudes * Slerp(time, turns)(instants).inv()).magnitude()
    assert away.max() < 1e-14 * 10


def test_a_body_that_hardly_turns_is_followed_too() -> None:
    q = np.array([[0, 0, 0, 1.0], [1e-9, 0, 0, 1.0], [1e-9, 0, 0, 1.0]])
    attitudes = attitudes_at(np.arange(3.0), q, np.array([0.0, 0.25, 1.5, 2.0]))
    np.testing.assert_allclose(attitudes[:, 0], [0, 0.25e-9, 1e-9, 1e-9], atol=1e-24)


def test_values_between_samples_are_on_a_line() -> None:
    time, values = np.array([0.0, 1.0, 3.0]), np.array([[0.0, 1.0], [2.0, 1.0], [4.0, 7.0]])
    assert values_at(time, values, np.array([0.5, 2.0, 3.0])).tolist() == [[1.0, 1.0], [3.0, 4.0], [4.0, 7.0]]


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
