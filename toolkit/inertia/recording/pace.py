"""Resampling a run for a speed at which something else than its fastest turn can be followed."""

from __future__ import annotations

from inertia.dynamics.run import Run
from inertia.recording.frames import Frames, frames_at, frames_of
from inertia.recording.playback import largest, playback


def frames_followed(run: Run, rate: float) -> Frames:
    """Choose a speed at which `rate` (rad/s) can be followed, and resample a run for that.

    Where the samples are too far apart to go between them, it is that of the fastest turn, as of any run.
    """
    spacing = float(run.time[-1] - run.time[0]) / (len(run.time) - 1)
    return frames_of(run) if largest(run.angular_velocity) * spacing > 1 else frames_at(run, playback(run.time, rate))
