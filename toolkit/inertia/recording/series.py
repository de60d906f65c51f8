"""The plots of a run: angular velocity, Euler angles, energy, and how far what is kept drifts."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from inertia import palette
from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import to_angles
from inertia.dynamics.run import Invariant, Run
from inertia.errors import InertiaError
from inertia.recording import entities
from inertia.recording.drawing import COLORS
from inertia.recording.sampling import write_series
from inertia.recording.summary import figure, symbol
from inertia.recording.writer import Recording, blocks

_EVENT = palette.rgb(palette.PLUM)
_LEAST = 1e-16  # unit of drifts, about one rounding


def write_angular_velocity(recording: Recording, run: Run, axes: Float) -> None:
    """Write ω at every sample, along axes (3, 3) whose columns are in part axes."""
    write_series(
        recording,
        entities.PLOT_ANGULAR_VELOCITY,
        run,
        lambda rows: run.angular_velocity[rows] @ axes,
        ["ω1, rad/s", "ω2, rad/s", "ω3, rad/s"],
        COLORS[:3],
    )


def write_angles_from_momentum(recording: Recording, run: Run, axes: Float) -> None:
    """Write at every sample how far axes (3, 3), columns in part axes, are from L, the first drawn over the others."""
    names = [f"axis {k}, rad" for k in (3, 2, 1)]

    def angles(rows: slice) -> Float:
        along = quaternion.to_body(run.attitude[rows], run.angular_momentum[rows]) @ axes[:, ::-1]
        others = np.stack([np.linalg.norm(np.delete(along, k, axis=1), axis=1) for k in range(3)], axis=1)
        return np.asarray(np.arctan2(others, along))

    write_series(recording, entities.PLOT_FROM_MOMENTUM, run, angles, names, COLORS[2::-1])


def write_euler_angles(recording: Recording, run: Run) -> None:
    """Write the z-x-z angles at every sample, φ and ψ in −π…π."""
    names = ["φ, rad", "θ, rad", "ψ, rad"]
    write_series(
        recording,
        entities.PLOT_EULER_ANGLES,
        run,
        lambda rows: to_angles(run.attitude[rows], "z-x-z"),
        names,
        COLORS[:3],
    )


def write_events(recording: Recording, path: str, run: Run, name: str, values: Callable[[Run], Float]) -> None:
    """Mark the events of a name on a plot, where the model has the series that they lie on, which is not on the line
    through samples that are far apart; `values` takes a run to the series (n,) at its samples."""
    import rerun as rr

    time = np.array([event.time for event in run.events if event.name == name])
    if not len(time):
        return
    try:
        marks = values(run.at(time))
    except InertiaError:  # a run that cannot be followed again
        marks = np.interp(time, run.time, values(run))
    look = rr.SeriesPoints(names=[name], colors=[_EVENT], markers=["diamond"], marker_sizes=[4.0])
    recording.static(f"{path}/events", look)
    recording.columns(f"{path}/events", time, lambda rows: rr.Scalars.columns(scalars=marks[rows]))


def write_energy(recording: Recording, run: Run) -> None:
    """Write the energy at every sample."""
    write_series(recording, entities.PLOT_ENERGY, run, lambda rows: run.energy[rows, None], ["energy, J"], COLORS[3:4])


def drift_unit(run: Run) -> float:
    """Return a power of ten that makes readable numbers of the largest drift: 1e-16 of 4e-16, for instance."""
    drift = max((each.largest_relative_drift for each in run.invariants.values()), default=0.0)
    return max(10.0 ** math.floor(math.log10(drift)), _LEAST) if 0 < drift < math.inf else _LEAST


def write_drift(recording: Recording, run: Run) -> None:
    """Write how far each invariant is from its value at the start, in `drift_unit`, at every sample."""
    invariants = list(run.invariants.values())
    scales = [drift_unit(run) * _scale(each) for each in invariants]

    def drifts(rows: slice) -> Float:
        return np.stack([_change(each, rows) / scale for each, scale in zip(invariants, scales, strict=True)], axis=1)

    names = [f"{symbol(name)}, {figure(drift_unit(run))}" for name in run.invariants]
    colors = [COLORS[(3 + k) % len(COLORS)] for k in range(len(invariants))]
    write_series(recording, entities.PLOT_DRIFT, run, drifts, names, colors)


def _change(invariant: Invariant, rows: slice) -> Float:
    """Return value − initial, of a vector its length."""
    change: Float = invariant.values[rows] - invariant.initial
    return change if change.ndim == 1 else np.asarray(np.linalg.norm(change, axis=1))


def _scale(invariant: Invariant) -> float:
    """Return what the drift of an invariant is relative to."""
    if not 0 < invariant.largest_relative_drift < math.inf:
        return 1.0
    change = max(float(np.abs(_change(invariant, rows)).max()) for rows in blocks(len(invariant.values)))
    return change / invariant.largest_relative_drift or 1.0
