"""Loads on a body as they are drawn: the torque as an arrow and a plot, the weight, and where the primary is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from inertia import palette
from inertia.arrays import Float
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import GravityGradient
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.orbit import Orbit
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.drawing import COLORS, write_arrow, write_labels, write_point
from inertia.recording.playback import Frames, largest, never_short
from inertia.recording.sampling import write_series
from inertia.recording.screen import plot
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

TORQUE, WEIGHT, PRIMARY = palette.rgb(palette.PINK), COLORS[1], COLORS[2]

_MOST = 20_000  # instants at which torques are evaluated
_LENGTH, _LEAST, _WEIGHT = 1.4, 1.05, 1.2  # over the body's radius, of arrows
_GLOBE, _AWAY = 0.16, 1.75  # over the body's radius: how large the primary is drawn, and how far away


def is_turned(run: Run) -> bool:
    """Say whether loads from outside turn a free body, so that there is a torque to draw."""
    problem = run.plan.problem
    return run.scene.constraint.kind == "free" and bool(_outer(run)) and bool((problem.moments > 0).all())


def write_torque(recording: Recording, run: Run, frames: Frames, size: float, thick: float) -> Iterator[str]:
    """Write the torque about the centre of mass, along space axes, of a body of a radius `size`: arrow and plot."""
    if not is_turned(run):
        return
    rows = slice(None, None, -(-len(frames.time) // _MOST))
    omega = quaternion.to_body(frames.attitude[rows], frames.angular_velocity[rows])
    torque = torque_on(run, frames.time[rows], frames.attitude[rows], omega)
    arrow, note = never_short(_LENGTH * size, _LEAST * size, torque)
    write_arrow(recording, entities.TORQUE, frames.time[rows], arrow, "N", TORQUE, thick)

    def plotted(rows: slice) -> Float:
        some = torque_on(run, run.time[rows], run.attitude[rows], run.angular_velocity[rows])
        return np.column_stack([some, np.linalg.norm(some, axis=1)])

    names = [f"{name}, N m" for name in ("Nx", "Ny", "Nz", "|N|")]
    write_series(recording, entities.PLOT_TORQUE, run, plotted, names, COLORS[:4], step=-(-len(run.time) // _MOST))
    yield f"the torque N (pink) of the loads is {largest(torque):.4g} N m where it is largest"
    if note:
        yield f"N {note}"


def torque_on(run: Run, time: Float, attitude: Float, angular_velocity: Float) -> Float:
    """Return the torque (m, 3) N m of the loads from outside, along space axes.

    Parameters
    ----------
    time : (m,) s
    attitude : (m, 4) part axes to space
    angular_velocity : (m, 3) rad/s, part axes
    """
    problem = run.plan.problem
    axes = problem.axes
    body = RotationProblem(problem.moments, problem.angular_velocity)
    turned, along = quaternion.multiply(attitude, quaternion.from_matrix(axes)), angular_velocity @ axes
    total = np.zeros_like(along)
    for load in _outer(run):
        load = load.along(axes, run.scene.body.axes)
        if isinstance(load, Orbit) or (isinstance(load, Torque) and not load.constant):  # one instant at a time
            each = [load.torque_at(t, q, w, body) for t, q, w in zip(time.tolist(), turned, along, strict=True)]
            total += np.array(each)
        else:
            total += load.torque_at(0.0, turned, along, body)
    return quaternion.to_space(turned, total)


def write_primary(recording: Recording, run: Run, frames: Frames, size: float, thick: float) -> Iterator[str]:
    """Write the nadir, and the primary as a globe beyond it, where its gravity turns a body of a radius `size`."""
    where = "in the direction of the primary"
    if run.scene.orbit is not None and frames.position is not None:
        toward = -frames.position / np.linalg.norm(frames.position, axis=1)[:, None]
        low, high = (getattr(run.quantities["distance to the primary"], end)() for end in ("min", "max"))
        where = f"{low:.4g} to {high:.4g} m away"
    else:
        fixed = [load for load in run.plan.problem.torques if isinstance(load, GravityGradient)]
        if not fixed:
            return
        toward = np.broadcast_to(-fixed[0].position / np.linalg.norm(fixed[0].position), frames.angular_velocity.shape)
        where = f"{np.linalg.norm(fixed[0].position):.4g} m away"
    write_arrow(recording, entities.PRIMARY, frames.time, _LENGTH * size * toward, "nadir", PRIMARY, thick)
    globe = f"{entities.PRIMARY}/globe"
    write_point(recording, globe, frames.time, _AWAY * size * toward, PRIMARY, _GLOBE * size)
    yield f"the blue globe is the primary, which is {where}; it is drawn at the nadir, near and small"


def write_weight(recording: Recording, run: Run, size: float, thick: float) -> Iterator[str]:
    """Write the weight as an arrow from the centre of mass, where gravity pulls at the body."""
    import rerun as rr

    pull = float(np.linalg.norm(run.scene.gravity))
    if not pull or run.scene.body.mass is None:
        return
    arrow = _WEIGHT * size * run.scene.gravity / pull
    recording.static(entities.WEIGHT, rr.Arrows3D(vectors=[arrow], colors=[WEIGHT], radii=[thick]))
    write_labels(recording, f"{entities.WEIGHT}/name", [1.07 * arrow], ["mg"])
    yield f"the weight mg (green) is {run.scene.body.mass * pull:.4g} N"


def reactions(run: Run) -> dict[str, Float]:
    """Return how large the forces (n,) N are that hold a body on its axle, by name: in its bearings, or in all."""
    names = [name for name in ("force on bearing A", "force on bearing B") if name in run.quantities]
    names = names or [name for name in ("reaction force",) if name in run.quantities]
    sizes = {name: np.linalg.norm(run.quantities[name], axis=1) for name in names}
    if len(names) == 2 and np.allclose(sizes[names[0]], sizes[names[1]], rtol=1e-9, atol=0.0):  # one hides the other
        return {"force on each bearing": sizes[names[0]]}
    return sizes


def reaction_plot(run: Run, duration: float) -> rrb.TimeSeriesView:
    """Return the plot of these forces, from zero on."""
    most = max(float(size.max()) for size in reactions(run).values())
    return plot(entities.PLOT_REACTION, "Forces that hold the axle, N", duration, values=(0.0, 1.15 * most or 1.0))


def write_reactions(recording: Recording, run: Run) -> None:
    """Write how large these forces are, at every sample."""
    if sizes := reactions(run):
        table = np.stack(list(sizes.values()), axis=1)
        units = [f"{name}, N" for name in sizes]
        write_series(recording, entities.PLOT_REACTION, run, table.__getitem__, units, COLORS[: len(units)])


def _outer(run: Run) -> list[Load]:
    """Return the loads with a torque about the centre of mass: not those inside the body."""
    return [load for load in run.plan.problem.torques if not load.dissipation]
