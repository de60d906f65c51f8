"""A run at the instants that are shown, in float64 and SI units: poses, and the vectors drawn with them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.run import Run
from inertia.recording import paths
from inertia.recording.playback import Playback, attitudes_at, largest, playback, values_at
from inertia.recording.writer import Recording

PATH = (130, 130, 130)
_POINTS = 20_000  # of a line that does not change


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
        recording.columns(paths.BODY, self.time, lambda rows: rr.Transform3D.columns(quaternion=rotation[rows]))

    def write_position(self, recording: Recording, unit: float, origin: Float) -> None:
        """Write where the centre of mass is, from `origin` (3,) m in `unit`, and its path."""
        import rerun as rr

        if self.position is None:
            return
        place = ((self.position - origin) / unit).astype(np.float32)
        recording.columns(paths.CENTER, self.time, lambda rows: rr.Transform3D.columns(translation=place[rows]))
        recording.static(paths.PATH, rr.LineStrips3D([thinned(place)], colors=[PATH], radii=[-1.0]))


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


def write_arrow(
    recording: Recording,
    path: str,
    time: Float,
    vectors: Float,
    label: str,
    color: tuple[int, int, int],
    radius: float,
) -> None:
    """Write an arrow (m, 3) that moves, in display units."""
    import rerun as rr

    recording.static(path, rr.Arrows3D.from_fields(labels=[label], colors=[color], radii=[radius], show_labels=True))
    tips = vectors.astype(np.float32)
    recording.columns(path, time, lambda rows: rr.Arrows3D.columns(vectors=tips[rows]))


def write_trail(
    recording: Recording, path: str, time: Float, points: Float, color: tuple[int, int, int], radius: float
) -> None:
    """Write the curve through points (m, 3), a piece for each frame: a view shows those of a while (`trail`)."""
    import rerun as rr

    recording.static(path, rr.LineStrips3D.from_fields(colors=[color], radii=[radius]))
    ends = points.astype(np.float32)
    starts = np.concatenate([ends[:1], ends[:-1]])
    recording.columns(
        path, time, lambda rows: rr.LineStrips3D.columns(strips=np.stack([starts[rows], ends[rows]], axis=1))
    )


def thinned(points: np.ndarray) -> np.ndarray:
    """Return a path (m, 3), or every few points of it where it has very many."""
    return points[:: -(-len(points) // _POINTS)]
