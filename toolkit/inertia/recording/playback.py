"""How fast a run is played, and the run at the evenly spaced instants that are shown, in float64 and SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.run import Run
from inertia.errors import GeometryError
from inertia.recording import entities
from inertia.recording.drawing import thinned
from inertia.recording.writer import Recording, blocks

PATH = (130, 130, 130)

RATE = 60.0
"""Poses a second of playback: the viewer does not interpolate."""
SHORTEST, LONGEST = 4.0, 3600.0
"""Seconds that a playback lasts."""

_FOLLOWED = 2.0 * math.pi, 0.2  # rad/s on the screen: the fastest turn that can be followed, the slowest that is seen
_EVEN = 1e-7  # s between two rows, less than which is scaled
_LATEST = 9e9  # s: Rerun counts nanoseconds in 64 bits
_NEAREST = 2e-9  # s between two rows that nanoseconds tell apart
_PREFIXES = {-3: "ms", -6: "µs", -9: "ns", -12: "ps", -15: "fs"}
_COARSE = 1.0  # rad between two samples, beyond which the shortest turn between them need not be the true one


@dataclass(frozen=True, eq=False)
class Playback:
    """How a run is played.

    Attributes
    ----------
    speed : seconds of the run in a second of playback
    frames : (m,) s, the instants shown
    smooth : whether they show the motion, or only instants of it that are far from each other
    notes : sentences
    second : s of the run that a second on the timeline stands for
    end : s on the timeline
    """

    speed: float
    frames: Float
    smooth: bool
    notes: tuple[str, ...]
    second: float = 1.0
    end: float = 0.0

    @property
    def pace(self) -> float:
        """Seconds on the timeline in a second of playback."""
        return self.speed / self.second


def playback(time: Float, fastest: float) -> Playback:
    """Choose the speed at which a body can be followed that turns at `fastest` rad/s, sampled at `time` (n,) s.

    Real time where that will do, else the nearest of 1, 2 and 5 times a power of ten on the safe side, such that the
    playback lasts from `SHORTEST` to `LONGEST`.

    Raises `GeometryError` where no scale of time has nanoseconds that tell all rows apart.
    """
    duration = float(time[-1] - time[0])
    spacing = duration / (len(time) - 1)
    if fastest * spacing > _COARSE:
        speed = _round_down(RATE * spacing)
        note = (
            f"the body turns by up to {fastest * spacing:.2g} rad between samples: its motion between them is not "
            "shown, ask for more of them"
        )
        return _on_timeline(Playback(min(speed, _round_down(duration / SHORTEST)), time, False, (note,)), time)
    speed = 1.0
    if fastest > _FOLLOWED[0]:
        speed = _round_down(_FOLLOWED[0] / fastest)
    elif 0 < fastest < _FOLLOWED[1]:
        speed = max(1.0, min(_round_down(math.sqrt(_FOLLOWED[0] * _FOLLOWED[1]) / fastest), _round_down(duration)))
    if duration > LONGEST * speed:
        speed = 1.0 / _round_down(LONGEST / duration)
    if duration < SHORTEST * speed:
        speed = _round_down(duration / SHORTEST)
    count = max(2, math.ceil(RATE * duration / speed) + 1)
    return _on_timeline(Playback(speed, np.linspace(time[0], time[-1], count), True, ()), time)


def _on_timeline(play: Playback, time: Float) -> Playback:
    """Say the pace, and scale time where nanoseconds in 64 bits do not suit it."""
    nearest = min(float(np.diff(each).min()) for each in (time, play.frames))
    suits = nearest >= _EVEN and time[-1] <= _LATEST
    power = 0 if suits else 3 * math.floor(math.log10(float(time[-1])) / 3.0 + 1e-9)
    second = 10.0**power
    if nearest < _NEAREST * second:
        raise GeometryError(
            f"samples lie {nearest:.3g} s from each other in a run that ends at {time[-1]:.3g} s: a recording counts "
            "time in 64 bits, which do not tell them apart; ask for fewer samples, or a shorter run"
        )
    notes = (pace_of(play.speed), *play.notes)
    if power:
        notes = (f"on the timeline 1 s is {_named(power)} of the run", *notes)
    return replace(play, notes=notes, second=second, end=float(time[-1]) / second)


def _named(power: int) -> str:
    """Return a power of ten of seconds in words."""
    return f"1 {_PREFIXES[power]}" if power in _PREFIXES else f"1e{power} s"


@dataclass(frozen=True, eq=False)
class Frames:
    """The motion of a body at m instants.

    Attributes
    ----------
    play : `Playback`: how fast, and why not faster
    time : (m,) s
    attitude : (m, 4) part axes to space
    angular_velocity : (m, 3) rad/s, space axes
    angular_momentum : (m, 3) kg m²/s, space axes
    position : (m, 3) m, the centre of mass in space; None where it stays
    """

    play: Playback
    time: Float
    attitude: Float
    angular_velocity: Float
    angular_momentum: Float
    position: Float | None

    def write_attitude(self, recording: Recording) -> None:
        """Write how the part axes are turned."""
        import rerun as rr

        rotation = self.attitude.astype(np.float32)
        recording.columns(entities.BODY, self.time, lambda rows: rr.Transform3D.columns(quaternion=rotation[rows]))

    def write_position(self, recording: Recording, unit: float, origin: Float) -> None:
        """Write where the centre of mass is, from `origin` (3,) m in `unit`, and its path."""
        import rerun as rr

        if self.position is None:
            return
        place = ((self.position - origin) / unit).astype(np.float32)
        recording.columns(entities.CENTER, self.time, lambda rows: rr.Transform3D.columns(translation=place[rows]))
        recording.static(entities.PATH, rr.LineStrips3D([thinned(place)], colors=[PATH], radii=[-1.0]))


def frames_of(run: Run) -> Frames:
    """Choose a speed at which the fastest turn of a run can be followed, and resample it for that."""
    return frames_at(run, playback(run.time, largest(run.angular_velocity)))


def frames_at(run: Run, play: Playback) -> Frames:
    """Resample a run."""
    attitude = attitudes_at(run.time, run.attitude, play.frames)
    return Frames(
        play=play,
        time=play.frames,
        attitude=attitude,
        angular_velocity=quaternion.to_space(attitude, values_at(run.time, run.angular_velocity, play.frames)),
        angular_momentum=values_at(run.time, run.angular_momentum, play.frames),
        position=None if run.position is None else values_at(run.time, run.position, play.frames),
    )


def frames_followed(run: Run, rate: float) -> Frames:
    """Choose a speed at which `rate` (rad/s) can be followed, and resample a run for that.

    Where the samples are too far apart to go between them, it is that of the fastest turn, as of any run.
    """
    spacing = float(run.time[-1] - run.time[0]) / (len(run.time) - 1)
    return frames_of(run) if largest(run.angular_velocity) * spacing > 1 else frames_at(run, playback(run.time, rate))


def attitudes_at(time: Float, attitude: Float, instants: Float) -> Float:
    """Return the attitudes (m, 4) at instants, along the shortest turn at an even rate between samples (n, 4)."""
    if np.array_equal(time, instants):
        return attitude
    before, share = _bracket(time, instants)
    p, q = attitude[before], attitude[before + 1]
    cosine = np.einsum("ij,ij->i", p, q)
    q = np.where(cosine[:, None] < 0, -q, q)
    half = 0.5 * quaternion.angle_between(p, q)
    near = half < 1e-6  # where the sines below cancel, and a straight line will do
    sine = np.where(near, 1.0, np.sin(half))
    weights = [np.where(near, w, np.sin(w * half) / sine)[:, None] for w in (1.0 - share, share)]
    return quaternion.normalise(weights[0] * p + weights[1] * q)


def values_at(time: Float, values: Float, instants: Float) -> Float:
    """Return values (m, k) at instants, on a straight line between samples (n, k)."""
    if np.array_equal(time, instants):
        return values
    before, share = _bracket(time, instants)
    between: Float = values[before] + share[:, None] * (values[before + 1] - values[before])
    return between


def largest(vectors: Float) -> float:
    """Return the largest length among vectors (n, k)."""
    return max(float(np.linalg.norm(vectors[block], axis=1).max()) for block in blocks(len(vectors)))


def longest_as(length: float, vectors: Float) -> Float:
    """Return vectors (m, 3) scaled so that the longest has this length; all zero where they are."""
    size = largest(vectors)
    return length / size * vectors if size else vectors


def never_short(length: float, least: float, vectors: Float) -> tuple[Float, str]:
    """Return vectors (m, 3) whose longest has `length`, and what else was done so that none is shorter than `least`.

    Proportional where that will do; else their lengths, from `least` to `length`, tell only more from less. Zero stays.

    >>> never_short(2.0, 1.0, np.array([[4.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]))[0].tolist()
    [[2.0, 0.0, 0.0], [0.0, 1.25, 0.0], [0.0, 0.0, 0.0]]
    """
    drawn = longest_as(length, vectors)
    sizes = np.linalg.norm(drawn, axis=1)
    if not ((sizes > 0) & (sizes < least)).any():
        return drawn, ""
    lengthened: Float = (
        drawn * (np.divide(least, sizes, where=sizes > 0, out=np.zeros_like(sizes)) + 1.0 - least / length)[:, None]
    )
    return lengthened, "it grows short and is drawn by its direction: its length tells only more from less"


def _bracket(time: Float, instants: Float) -> tuple[np.ndarray, Float]:
    """Return for each instant the sample before it, and the share of the way to the next."""
    before = np.clip(np.searchsorted(time, instants, side="right") - 1, 0, len(time) - 2)
    share = (instants - time[before]) / (time[before + 1] - time[before])
    return before, share


def _round_down(value: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten that is no larger."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-9))


def pace_of(speed: float) -> str:
    """Say how fast a run is played."""
    if speed == 1:
        return "played in real time"
    if speed < 1:
        return f"played {1 / speed:.6g} times slower than it is"
    return f"played {speed:.6g} times faster than it is"
