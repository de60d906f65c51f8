"""How fast a run is played, and the run at the instants that are shown, by its own model, in float64 and SI units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np

from inertia.arrays import Float, Int
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.run import Run
from inertia.errors import GeometryError, InertiaError
from inertia.recording import entities
from inertia.recording.drawing import thinned
from inertia.recording.sampling import points_note
from inertia.recording.summary import figure, sentence
from inertia.recording.writer import Recording, blocks
from inertia.records import dataclass

PATH = (130, 130, 130)

RATE = 60.0
"""Poses a second of playback, at least: the viewer does not interpolate."""
NEAR = 0.05
"""Radians that a body turns from one pose to the next, at most."""
MOST = 20_000
"""Poses that may be drawn so near to each other: a loop is as long as they last."""
TRIES = 3
"""How often poses are taken anew where they are farther apart than samples had it."""
SHORTEST, LONGEST = 4.0, 3600.0
"""Seconds that a playback lasts."""

_FOLLOWED = 2.0 * math.pi, 0.2  # rad/s on the screen: the fastest turn that can be followed, the slowest that is seen
_EVEN = 1e-7  # s between two rows, less than which is scaled
_LATEST = 9e9  # s: Rerun counts nanoseconds in 64 bits
_NEAREST = 2e-9  # s between two rows that nanoseconds tell apart
_PREFIXES = {-3: "ms", -6: "µs", -9: "ns", -12: "ps", -15: "fs"}
_SLENDER = 0.05  # of the middle moment: a body with less about its long axis is a needle
_SINGLE = 2.0**-23  # rad: twice the length of what rounding to float32 adds to a quaternion
_LATE = 0.1 * _SINGLE  # rad that a body may turn between a sample and the nanosecond that it is shown at
_ON_TIME, _ULP = 1e-4, 2.0**-52  # of a nanosecond of the timeline, and of an instant: less is rounding
_FLASHES = 12.0  # at most, of a stroboscope
_SLACK = 1.02  # times `NEAR`, up to which poses are near each other: nanoseconds part them by up to a hundredth more
_JOINED = 1.0  # rad between two poses, beyond which no line is drawn from one to the next


@dataclass(frozen=True, eq=False)
class Playback:
    """How a run is played.

    Attributes
    ----------
    speed : seconds of the run in a second of playback
    frames : (m,) s, the instants shown: whole nanoseconds of the timeline
    near : how many of them, from the first on, are so near each other that they show the motion
    notes : sentences
    second : s of the run that a second on the timeline stands for
    end : s on the timeline
    loop : s on the timeline, from when to when it is played; None for all of the run
    """

    speed: float
    frames: Float
    near: int
    notes: tuple[str, ...]
    second: float = 1.0
    end: float = 0.0
    loop: tuple[float, float] | None = None

    @property
    def pace(self) -> float:
        """Seconds on the timeline in a second of playback."""
        return self.speed / self.second


def playback(time: Float, fastest: float, turning: Float | float | None = None, known: Float | None = None) -> Playback:
    """Choose how to play a run sampled at `time` (n,) s, so that what moves at `fastest` rad/s can be followed.

    In real time where that will do, else the nearest of 1, 2 and 5 times a power of ten on the safe side, such that the
    playback lasts from `SHORTEST` to `LONGEST`. Poses are no farther apart than a body turns by `NEAR` at `turning`
    (k,) rad/s (`fastest` without it), which it has at instants `known` (k,) s from the first sample to the last
    (`time` without them); and they are `RATE` to a second of playback or more, or as many as `MOST` give to each. They
    are samples where these are as many. Where more than `MOST` would be needed for turning, the loop ends with them;
    after it are samples, at most so many.

    Raises `GeometryError` where no scale of time has nanoseconds that tell all rows apart.
    """
    known = time if known is None else known
    rate = np.broadcast_to(fastest if turning is None else turning, known.shape) / NEAR
    duration = float(time[-1] - time[0])
    span = _instant(_counted(known, rate), known, MOST) - float(time[0])
    speed = 1.0
    if fastest > _FOLLOWED[0]:
        speed = round_down(_FOLLOWED[0] / fastest)
    elif 0 < fastest < _FOLLOWED[1]:
        speed = max(1.0, min(round_down(math.sqrt(_FOLLOWED[0] * _FOLLOWED[1]) / fastest), round_down(duration)))
    if span > LONGEST * speed:
        speed = 1.0 / round_down(LONGEST / span)
    if span < SHORTEST * speed:
        speed = round_down(span / SHORTEST)
    least = min(RATE / speed, MOST / span)
    frames = _instants(time, known, _counted(known, np.maximum(rate, least)), float(time[0]) + span)
    play = Playback(speed, frames, len(frames), ())
    if span < duration:
        later = time[time > frames[-1]]
        later = later[:: -(-len(later) // MOST)]
        note = (
            f"the loop is the first {span:.4g} s, as so many poses are drawn where they are near each other; later "
            f"ones, every {np.diff(later).max(initial=0.0):.4g} s, are there for the time to be set by hand"
        )
        loop = float(time[0]), float(frames[-1])
        play = replace(play, frames=np.concatenate([frames, later]), notes=(note,), loop=loop)
    return _on_timeline(play, time)


def _counted(known: Float, rate: Float) -> Float:
    """Return how many poses are needed up to each instant (k,) at so many (k,) a second, never fewer between two of
    them than the larger rate asks for."""
    return np.concatenate([[0.0], np.cumsum(np.diff(known) * np.maximum(rate[1:], rate[:-1]))])


def _instant(count: Float, known: Float, number: float) -> float:
    """Return when so many poses have been needed, the end of the run at the latest."""
    return float(np.interp(number, count, known)) if count[-1] > number else float(known[-1])


def _instants(time: Float, known: Float, count: Float, end: float) -> Float:
    """Return instants from the start to `end`, one or more for each unit of `count` (k,) at instants `known` (k,):
    samples `time` (n,) where these do."""
    counted = np.interp(time, known, count)
    coarsest = float(np.diff(counted).max())
    if coarsest <= 1.0:
        samples = int(np.searchsorted(time, end, side="right"))
        targets = np.arange(0.0, counted[samples - 1], 1.0 - coarsest) if coarsest <= 0.5 else counted[:samples]
        rows = np.unique(np.searchsorted(counted[:samples], targets, side="right") - 1)
        chosen: Float = time[np.union1d(rows, [0, samples - 1])]
        return chosen
    needed = float(np.interp(end, known, count))
    instants = np.interp(np.linspace(0.0, needed, max(2, math.ceil(needed) + 1)), count, known)
    instants[-1] = end
    return instants


def _on_timeline(play: Playback, time: Float) -> Playback:
    """Say the pace, scale time where nanoseconds in 64 bits do not suit it, and show only what these count."""
    nearest = min(float(np.diff(each).min()) for each in (time, play.frames))
    power = scale_of(nearest, float(time[-1]))
    second = 10.0**power
    if nearest < _NEAREST * second:
        raise GeometryError(
            f"samples lie {nearest:.3g} s from each other in a run that ends at {time[-1]:.3g} s: a recording counts "
            "time in 64 bits, which do not tell them apart; ask for fewer samples, or a shorter run"
        )
    notes = (pace_of(play.speed), *play.notes)
    if power:
        notes = (f"on the timeline 1 s is {_named(power)} of the run", *notes)
    loop = None if play.loop is None else (play.loop[0] / second, play.loop[1] / second)
    frames = to_ticks(play.frames, second)
    return replace(play, frames=frames, notes=notes, second=second, end=float(time[-1]) / second, loop=loop)


def to_ticks(time: Float, second: float) -> Float:
    """Return instants (m,) s that ascend, moved to whole nanoseconds of a timeline on which a second is `second` s.

    The last is never later than it was: a run ends there. What is off by rounding alone stays.

    >>> to_ticks(np.array([0.0, 0.4e-9, 2.6e-9, 5.7e-9]), 1.0).tolist()
    [0.0, 0.0, 3e-09, 5e-09]
    """
    ticks = time / (1e-9 * second)
    number, rounding = np.round(ticks), np.maximum(_ON_TIME, _ULP * np.abs(ticks))
    number[-1] -= number[-1] - ticks[-1] > rounding[-1]
    return np.where(np.abs(number - ticks) <= rounding, time, 1e-9 * second * number)


def scale_of(nearest: float, last: float) -> int:
    """Return the power of ten of seconds that a second on the timeline stands for.

    `nearest` is the least from one row to the next, `last` the end, s.
    """
    power = 0 if nearest >= _EVEN and last <= _LATEST else 3 * math.floor(math.log10(last) / 3.0 + 1e-9)
    if nearest < _EVEN * 10.0**power:
        power = 3 * math.ceil(math.log10(last / _LATEST) / 3.0)
    return power


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
    series : (m, …), the quantities of the run that go with time
    note : how many poses are drawn, and to how many rad; that samples are plotted as points, where they are
    """

    play: Playback
    time: Float
    attitude: Float
    angular_velocity: Float
    angular_momentum: Float
    position: Float | None
    series: Mapping[str, Float]
    note: str = ""

    @property
    def near(self) -> slice:
        """The instants that lines are drawn through; none where samples are all there is, and far apart."""
        return slice(self.play.near)

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
        recording.static(entities.PATH, rr.LineStrips3D([thinned(place[self.near])], colors=[PATH], radii=[-1.0]))


def frames_of(run: Run) -> Frames:
    """Choose a speed at which the fastest turn of a run can be followed, and take its poses for that.

    A needle that spins about itself looks the same: its turn is that of its long axis.
    """
    return frames_followed(run, _fastest)


def _fastest(run: Run) -> float:
    """Return the fastest turn that is to be seen, rad/s."""
    omega = run.angular_velocity
    if not run.scene.body.deforms:
        order = np.argsort(run.plan.moments)
        thinnest, middle = run.plan.moments[order[:2]].tolist()
        across = omega @ np.delete(run.plan.axes, order[0], axis=1)
        if thinnest < _SLENDER * middle and (across.any() or not omega.any()):
            return largest(across)
    return largest(omega)


def frames_followed(run: Run, fastest: Callable[[Run], float]) -> Frames:
    """Choose a speed at which a run can be followed, and take its poses for that; `fastest` returns the rate in rad/s
    of what moves, at the samples of a run.

    What is no sample is evaluated by the model (`Run.at`). Where poses turn out to be farther apart than `NEAR`, the
    body turns faster between its samples than at them; where it turns by far less in a loop that is cut short, slower:
    they are chosen anew, by the rates at those there were. A run that cannot be followed again is shown at its samples.
    """
    rate, turning = fastest(run), turning_of(run)
    play, shown, rows = playback(run.time, rate, turning[1]), run, np.arange(len(run.time))
    try:
        shown, rows = _posed(run, play.frames)
        for _ in range(TRIES):
            if are_near(play, shown.attitude[rows]):
                break
            rate, turning = max(rate, fastest(shown)), turning_seen(run, play, shown, turning)
            play = playback(run.time, rate, turning[1], turning[0])
            shown, rows = _posed(run, play.frames)
    except InertiaError:
        shown, rows = run, np.arange(len(run.time))
        turned = _largest_turn(run.attitude)
        play = replace(
            play,
            frames=run.time,
            near=len(rows) if turned < _JOINED else 0,
            notes=(*play.notes, "the run could not be followed between its samples: only these are shown"),
        )
    points = points_note(run)
    error, run = max(run.error.reached, shown.error.reached), shown
    error += _SINGLE + float(_turned_late(run, rows, to_ticks(play.frames, play.second)).max())
    attitude = run.attitude[rows]
    of_loop = f"of the first {play.near} " if 0 < play.near < len(rows) else ""
    note = (
        f"{len(rows)} poses are drawn, each as the model has it, to {figure(error)} rad in single precision; "
        f"from one to the next {of_loop}the body turns by {_largest_turn(attitude[: play.near or None]):.2g} rad at "
        f"most, and the viewer shows nothing between them{points and f'. {sentence(points)}'}"
    )
    return Frames(
        play=play,
        time=play.frames,
        attitude=attitude,
        angular_velocity=quaternion.to_space(attitude, run.angular_velocity[rows]),
        angular_momentum=run.angular_momentum[rows],
        position=None if run.position is None else run.position[rows],
        series={name: values[rows] for name, values in run.series.items()},
        note=note,
    )


def _posed(run: Run, instants: Float) -> tuple[Run, Int]:
    """Return a run that has samples at instants (m,) s, and their rows (m,): the run itself where it has them, or has
    them so near that the body turns by `_LATE` at most in between."""
    rows = np.searchsorted(0.5 * (run.time[1:] + run.time[:-1]), instants)
    if (_turned_late(run, rows, instants) <= _LATE).all():
        return run, rows
    return run.at(instants), np.arange(len(instants))


def _turned_late(run: Run, rows: Int, instants: Float) -> Float:
    """Return by how many rad (m,) the body of a run turns from its samples `rows` (m,) to instants (m,) s."""
    return np.asarray(np.linalg.norm(run.angular_velocity[rows], axis=1) * np.abs(run.time[rows] - instants))


def turning_of(run: Run) -> tuple[Float, Float]:
    """Return how fast a body turns at the samples of a run: instants (k,) s and |ω| (k,) rad/s there."""
    return run.time, np.linalg.norm(run.angular_velocity, axis=1)


def turning_seen(run: Run, play: Playback, shown: Run, before: tuple[Float, Float]) -> tuple[Float, Float]:
    """Return how fast the body of a run turns, as `turning_of` does: as was known before, at the poses `shown`, and
    where the loop is cut short at even instants too, up to the end of the run."""
    seen = [before, turning_of(shown)]
    if play.loop is not None:
        with suppress(InertiaError):
            seen.append(turning_of(run.at(np.linspace(run.time[0], run.time[-1], MOST))))
    instants, rates = (np.concatenate(each) for each in zip(*seen, strict=True))
    known, rows = np.unique(instants, return_index=True)
    return known, rates[rows]


def are_near(play: Playback, *attitudes: Float) -> bool:
    """Say whether poses, attitudes (m, 4) of each body, are near each other, and none of them wasted: where the loop is
    cut short, some body turns by half of `NEAR` or more from one to the next that turning asks for, on average."""
    turns = [_turns(attitude[: play.near]) for attitude in attitudes]
    if any(turn.max(initial=0.0) > _SLACK * NEAR for turn in turns):
        return False
    return play.loop is None or max(float(turn.sum()) for turn in turns) >= 0.5 * NEAR * MOST


def _largest_turn(attitude: Float) -> float:
    """Return the largest angle from one attitude (m, 4) to the next."""
    return float(_turns(attitude).max(initial=0.0))


def _turns(attitude: Float) -> Float:
    """Return the angles (m - 1,) from one attitude (m, 4) to the next."""
    return np.asarray(quaternion.angle_between(attitude[:-1], attitude[1:]))


def largest(vectors: Float) -> float:
    """Return the largest length among vectors (n, k)."""
    return max(float(np.linalg.norm(vectors[block], axis=1).max()) for block in blocks(len(vectors)))


def strobe(time: Float) -> tuple[Int, float]:
    """Return the rows of instants (m,) s nearest to even ones, and how far apart these are: a round number of s.

    >>> rows, apart = strobe(np.linspace(0.0, 0.8, 801))
    >>> rows.tolist(), apart
    ([0, 100, 200, 300, 400, 500, 600, 700, 800], 0.1)
    """
    duration = float(time[-1] - time[0])
    apart = 1.0 / round_down(_FLASHES / duration)
    targets = time[0] + apart * np.arange(math.floor(duration / apart * (1.0 + 1e-9)) + 1)
    after = np.clip(np.searchsorted(time, targets), 1, len(time) - 1)
    rows: Int = np.unique(after - (targets - time[after - 1] < time[after] - targets))
    return rows, apart


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
    return lengthened, "grows short, so that its length tells only more from less"


def round_down(value: float) -> float:
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
