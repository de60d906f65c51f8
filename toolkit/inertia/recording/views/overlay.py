"""Recording of two runs on one timeline: both bodies in one space, ω of both, and the angle between their attitudes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inertia import palette
from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.run import Run
from inertia.errors import InertiaError, UsageError
from inertia.recording import entities
from inertia.recording.display import Display, display_of
from inertia.recording.drawing import write_arrow, write_place, write_text
from inertia.recording.playback import (
    TRIES,
    Playback,
    are_near,
    largest,
    playback,
    to_ticks,
    turning_of,
    turning_seen,
)
from inertia.recording.sampling import points_note, write_series
from inertia.recording.screen import Screen, eye, finished, plot, space_view, text_view
from inertia.recording.summary import figure, markdown, sentence, title
from inertia.recording.writer import Recording
from inertia.records import dataclass

if TYPE_CHECKING:
    import rerun.blueprint as rrb

COLORS = palette.rgb(palette.BLUE), palette.rgb(palette.VERMILLION)
"""Of the first run and of the other."""

_SHADES = palette.rgb(palette.SKY), (*palette.rgb(palette.ORANGE), 110)
_NAMES = "first", "other"
_COLOR_NAMES = "blue", "orange"
_SAME = 1e-3  # of the time between samples, less than which instants of both runs are apart by rounding
_LARGER = 1.01
_OMEGA, _THICK, _ROOM = 1.35, 0.012, 1.25  # over the radius


@dataclass(frozen=True, eq=False)
class Pair:
    """Two runs as they are drawn.

    Attributes
    ----------
    runs : as they were simulated
    play : how fast, of both
    poses : each at the instants that are shown, up to its own end
    apart : (k,) s and (k,) rad, the angle between the attitudes while both go on; empty where they have no instant in
        common and cannot be followed between their samples
    """

    runs: tuple[Run, Run]
    play: Playback
    poses: tuple[Run, Run]
    apart: tuple[Float, Float]


def screen(run: Run, other: Run) -> Screen:
    """Return the recording of two rigid bodies.

    Raises `UsageError` where one of them changes its shape.
    """
    for each in (run, other):
        if each.scene.body.deforms:
            raise UsageError(
                f"{title(each)}: its body changes its shape, and only rigid ones are shown over each other: record "
                "each run by itself"
            )
    pair = _pair(run, other)
    bodies = _in_one_unit(display_of(run.scene.body), display_of(other.scene.body))
    size = max(body.radius for body in bodies)

    def write(recording: Recording) -> None:
        notes = [*pair.play.notes, f"1 unit is {bodies[0].unit:g} m, from the centre of mass of each body"]
        notes += _write_bodies(recording, pair, bodies, size)
        _write_plots(recording, pair)
        write_text(recording, _text(pair, notes))

    name = f"{title(run)} and {title(other)}"
    return Screen("inertia-overlay", name, _blueprint(pair, size), write, pair.play.second)


def _pair(run: Run, other: Run) -> Pair:
    """Choose one pace for both, and the instants at which each is drawn."""
    least = _SAME * min(float(np.diff(each.time).min()) for each in (run, other))
    time = np.union1d(run.time, other.time)
    time = time[np.diff(time, append=np.inf) > least]
    rates = [turning_of(each) for each in (run, other)]
    for _ in range(1 + TRIES):
        known = np.union1d(rates[0][0], rates[1][0])
        turning = np.maximum(*(np.interp(known, *rate) for rate in rates))
        play = playback(time, float(turning.max()), turning, known)
        poses = [_followed(each, play, least) for each in (run, other)]
        if are_near(play, *(each.attitude for each in poses)):
            break
        seen = zip((run, other), poses, rates, strict=True)
        rates = [turning_seen(each, play, shown, rate) for each, shown, rate in seen]
    return Pair((run, other), play, (poses[0], poses[1]), _apart(run, other, least))


def _followed(run: Run, play: Playback, least: float) -> Run:
    """Return a run at the instants shown, and at its end, which is `least` s or more after these, as the model has it;
    at its samples where it cannot be followed."""
    end = float(run.time[-1])
    try:
        return run.at(to_ticks(np.append(play.frames[play.frames < end - least], end), play.second))
    except InertiaError:
        return run


def _apart(run: Run, other: Run, least: float) -> tuple[Float, Float]:
    """Return the angle between the attitudes at the samples of the first run, up to the end of whichever ends first."""
    end = min(float(run.time[-1]), float(other.time[-1]))
    time = np.append(run.time[run.time < end - least], end)
    try:
        attitudes = [_at(each, time) for each in (run, other)]
    except InertiaError:
        time = np.intersect1d(run.time, other.time)
        attitudes = [_at(each, time) for each in (run, other)]
    return time, quaternion.angle_between(*attitudes)


def _at(run: Run, time: Float) -> Float:
    """Return the attitudes (k, 4) at instants (k,) s, which are samples or are followed."""
    rows = np.minimum(np.searchsorted(run.time, time), len(run.time) - 1)
    return run.attitude[rows] if np.array_equal(run.time[rows], time) else run.at(time).attitude


def _in_one_unit(*bodies: Display) -> list[Display]:
    unit = max(body.unit for body in bodies)
    scaled = []
    for body in bodies:
        ratio = body.unit / unit
        scaled.append(
            replace(
                body,
                unit=unit,
                radius=ratio * body.radius,
                triangles=None if body.triangles is None else ratio * body.triangles,
                semi_axes=None if body.semi_axes is None else ratio * body.semi_axes,
            )
        )
    return scaled


def _blueprint(pair: Pair, size: float) -> rrb.Blueprint:
    import rerun.blueprint as rrb

    end = pair.play.end
    view = space_view(entities.WORLD, "Both bodies", eye(_ROOM * size))
    plots = [plot(_path(axis), f"ω{axis}, part axes, rad/s", end) for axis in "xyz"]
    if len(pair.apart[0]):
        plots.insert(0, plot(entities.PLOT_APART, "Angle between the attitudes, rad", end))
    left = rrb.Vertical(view, text_view(), row_shares=[3, 1])
    return finished(left, rrb.Vertical(*plots), pair.play.pace, loop=pair.play.loop)


def _path(axis: str) -> str:
    return f"{entities.PLOT_ANGULAR_VELOCITY}/{axis}"


def _write_bodies(recording: Recording, pair: Pair, bodies: list[Display], size: float) -> Iterator[str]:
    import rerun as rr

    recording.static(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    fastest = max(largest(each.angular_velocity) for each in pair.runs) or 1.0
    for k, (run, body) in enumerate(zip(pair.poses, bodies, strict=True)):
        place = f"{entities.WORLD}/{_NAMES[k]}"
        drawn = body if k == 0 else _grown(body)
        recording.static(f"{place}/body/mesh", drawn.archetype(_SHADES[k]))
        still = np.zeros((len(run.time), 3))
        write_place(recording, f"{place}/body", run.time, still, run.attitude)
        omega = quaternion.to_space(run.attitude, run.angular_velocity) * (_OMEGA * size / fastest)
        write_arrow(recording, f"{place}/angular_velocity", run.time, omega, "ω", COLORS[k], _THICK * size)
        yield from body.notes
    yield f"both arrows of ω are to one scale, {fastest:.4g} rad/s where the longest is longest"
    ends = [float(run.time[-1]) for run in pair.runs]
    if ends[0] != ends[1]:
        k = int(ends[1] < ends[0])
        yield f"the {_NAMES[k]} run ends at {ends[k]:g} s and its body stays as it is then"


def _grown(body: Display) -> Display:
    """Return a body a little larger, so that faces of both in one place do not flicker."""
    if body.triangles is not None:
        return replace(body, triangles=_LARGER * body.triangles)
    assert body.semi_axes is not None
    return replace(body, semi_axes=_LARGER * body.semi_axes)


def _write_plots(recording: Recording, pair: Pair) -> None:
    for axis, name in enumerate("xyz"):
        for k, run in enumerate(pair.runs):
            values = run.angular_velocity[:, axis : axis + 1]
            write_series(
                recording,
                f"{_path(name)}/{_NAMES[k]}",
                run,
                values.__getitem__,
                [f"{_NAMES[k]}, rad/s"],
                COLORS[k : k + 1],
            )
    time, angle = pair.apart
    if len(time):
        color = palette.rgb(palette.GREEN)
        faster = max(pair.runs, key=lambda run: largest(run.angular_velocity))
        names = ["angle, rad"]
        write_series(recording, entities.PLOT_APART, faster, lambda rows: angle[rows, None], names, [color], time=time)


def _text(pair: Pair, notes: list[str]) -> str:
    """Say which is which, how far they are apart, and how well that is known."""
    lines = []
    for run, name, color in zip(pair.runs, _NAMES, _COLOR_NAMES, strict=True):
        lines.append(
            f"**The {name}, {color}: {markdown(title(run))}.** {run.model}, {run.time[-1]:g} s, attitude to "
            f"{figure(run.error.reached)} rad."
        )
        if note := points_note(run):
            lines[-1] += f" {sentence(note)}"
    time, angle = pair.apart
    if len(time):
        worst = int(np.argmax(angle))
        known = sum(run.error.reached for run in pair.runs)
        lines.append(
            f"**Apart** by {angle[worst]:.3g} rad at most, at {time[worst]:.4g} s, and {angle[-1]:.3g} rad at "
            f"{time[-1]:.4g} s; what the accuracies leave open is {figure(known)} rad."
        )
    else:
        lines.append("The runs have no instant in common at which their attitudes could be compared.")
    return "\n\n".join([*lines, markdown(" ".join(map(sentence, dict.fromkeys(notes))))])
