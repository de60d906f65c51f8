"""Recording of a body that changes its shape: every part in motion, and the ellipsoid of the whole body's moments."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody, Shape
from inertia.dynamics.run import Run
from inertia.recording import entities
from inertia.recording.display import Solid, equivalent_ellipsoid, solids_of
from inertia.recording.drawing import COLORS, MOMENTUM, OMEGA, write_arrow, write_ellipsoid, write_place, write_text
from inertia.recording.playback import Frames, frames_of, largest, longest_as, strobe
from inertia.recording.sampling import write_series
from inertia.recording.screen import Screen, drift_plot, eye, finished, plot, space_view, text_view, whole_path
from inertia.recording.series import drift_unit, write_angular_velocity, write_drift
from inertia.recording.summary import summary, title
from inertia.recording.writer import Recording
from inertia.records import dataclass

if TYPE_CHECKING:
    import rerun.blueprint as rrb

ELLIPSOID = COLORS[0]

_OMEGA, _MOMENTUM = 1.1, 1.25  # lengths of arrows, over the reach of the body
_THICK = 0.01
_NO_MOMENTUM = 1e-12  # of |I ω|, at most: an L that is nothing but rounding is not drawn
_ROOM = 1.25  # around the body, for the arrows


@dataclass(frozen=True, eq=False)
class Motion:
    """What moves, at the instants that are shown.

    Attributes
    ----------
    frames : the root axes and the centre of mass
    shape : where the parts are, exactly: the joints are evaluated at these instants
    unit : m, one unit of the views
    reach : of the body from its centre of mass at any instant, in `unit`
    """

    frames: Frames
    shape: Shape
    unit: float
    reach: float

    def from_center(self, points: Float) -> Float:
        """Return places (m, 3) m of root axes, in `unit` from the centre of mass, root axes."""
        placed: Float = (points - self.shape.center_of_mass) / self.unit
        return placed


def screen(run: Run) -> Screen:
    """Return the recording of a body that changes its shape."""
    assembly = run.scene.body.assembly
    assert assembly is not None  # the plan saw to it
    frames = frames_of(run)
    solids, motion = _solids_in_motion(run, assembly, frames)

    def write(recording: Recording) -> None:
        notes = [*frames.play.notes, f"1 unit is {motion.unit:g} m"]
        notes += _write_parts(recording, assembly, solids, motion)
        notes += _write_arrows(recording, motion)
        notes += _write_tensor(recording, motion)
        _write_plots(recording, run, assembly)
        write_drift(recording, run)
        write_text(recording, summary(run, [*notes, frames.note]))

    return Screen("inertia-deforming", title(run), _blueprint(run, assembly, motion), write, frames.play.second)


def _blueprint(run: Run, assembly: JointedBody, motion: Motion) -> rrb.Blueprint:
    """Arrange the parts, the tensor, the flight, plots and text."""
    import rerun.blueprint as rrb

    duration = motion.frames.play.end
    parts = space_view(
        entities.CENTER,
        contents=[f"/{entities.WORLD}/**", f"- /{entities.GHOSTS}/**", f"- /{entities.PATH}"],
        name="About the centre of mass",
        eye_controls=eye(_ROOM * motion.reach),
    )
    beside = space_view(
        entities.TENSOR,
        name="Ellipsoid of the same moments",
        eye_controls=eye(_ROOM * motion.reach),
    )
    position = motion.frames.position
    below: list[Any] = [text_view()]
    if position is not None and _flies(motion):
        below.insert(0, _flight((position - position[0]) / motion.unit, motion.reach))
    plots: list[Any] = []
    if any(joint.revolute for joint in assembly.joints):
        plots.append(plot(entities.PLOT_JOINTS, "Angles of the joints, rad", duration))
    if not all(joint.revolute for joint in assembly.joints):
        plots.append(plot(entities.PLOT_SLIDES, "Displacements of the joints, m", duration))
    plots += [
        plot(entities.PLOT_MOMENTS, "Principal moments of the whole body, kg m²", duration),
        plot(entities.PLOT_ANGULAR_VELOCITY, "Angular velocity of the root part, part axes, rad/s", duration),
        plot(entities.PLOT_WORK, "Kinetic energy and work of the joints, J", duration),
        drift_plot(drift_unit(run), duration),
    ]
    left = rrb.Vertical(rrb.Horizontal(parts, beside), rrb.Horizontal(*below), row_shares=[3, 2])
    return finished(left, rrb.Vertical(*plots), motion.frames.play.pace, loop=motion.frames.play.loop)


def _flight(path: Float, reach: float) -> rrb.Spatial3DView:
    """Look from the side at the whole path (m, 3) of a body that reaches so far from its centre of mass."""
    contents = [f"/{path}/**" for path in (entities.GHOSTS, entities.PATH, entities.PARTS)]
    return space_view(entities.WORLD, contents=contents, name="Stroboscope", eye_controls=whole_path(path, reach))


def _solids_in_motion(run: Run, assembly: JointedBody, frames: Frames) -> tuple[list[Solid], Motion]:
    """Return the parts as shown, and how they move."""
    shape = assembly.shape(frames.time)
    solids = solids_of(assembly, run.scene.body.meshes)
    farthest = 0.0
    for k, solid in enumerate(solids):
        place = quaternion.to_space(shape.part_attitude[:, k], solid.center) + shape.part_position[:, k]
        farthest = max(farthest, largest(place - shape.center_of_mass) + solid.radius)
    unit = 10.0 ** math.floor(math.log10(farthest))
    return solids, Motion(frames, shape, unit, farthest / unit)


def _flies(motion: Motion) -> bool:
    position = motion.frames.position
    return position is not None and bool(np.ptp(position, axis=0).any())


def _write_ghosts(recording: Recording, assembly: JointedBody, solids: list[Solid], motion: Motion) -> str:
    """Write the parts, dim, at instants that are equally far apart; say so."""
    frames, shape, unit = motion.frames, motion.shape, motion.unit
    assert frames.position is not None  # it flies
    rows, apart = strobe(frames.time[frames.near])
    root = frames.attitude[rows]
    origin = (frames.position[rows] - frames.position[0]) / unit
    origin = origin + quaternion.to_space(root, motion.from_center(np.zeros(3))[rows])
    for k, solid in enumerate(solids):
        places = origin + quaternion.to_space(root, shape.part_position[rows, k] / unit)
        attitudes = quaternion.multiply(root, shape.part_attitude[rows, k])
        recording.static(f"{entities.GHOSTS}/{k + 1}", *solid.copies(unit, k, places, attitudes))
    return f"the dim bodies are where it is every {apart:.4g} s"


def _write_parts(recording: Recording, assembly: JointedBody, solids: list[Solid], motion: Motion) -> Iterator[str]:
    import rerun as rr

    frames, shape, unit = motion.frames, motion.shape, motion.unit
    recording.static(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    if frames.position is not None:
        frames.write_position(recording, unit, frames.position[0])
        yield "the grey line is the path of the centre of mass"
        if _flies(motion):
            yield _write_ghosts(recording, assembly, solids, motion)
    root = quaternion.to_space(frames.attitude, motion.from_center(np.zeros(3)))
    write_place(recording, entities.BODY, frames.time, root, frames.attitude)
    for k, (part, solid) in enumerate(zip(assembly.parts, solids, strict=True)):
        path = f"{entities.PARTS}/{rr.escape_entity_path_part(part.name)}"
        recording.static(f"{path}/solid", solid.archetype(unit, k))
        write_place(recording, path, frames.time, shape.part_position[:, k] / unit, shape.part_attitude[:, k])
    if any(solid.triangles is None for solid in solids):
        yield "parts without a file are shown as the solid ellipsoids of the same moments, points as small spheres"
    for solid, part in zip(solids, assembly.parts, strict=True):
        if solid.note:
            yield f"{part.name}: {solid.note}"


def _write_arrows(recording: Recording, motion: Motion) -> Iterator[str]:
    """Write ω of the root and L, about the centre of mass and beside the ellipsoid."""
    frames, size = motion.frames, motion.reach
    at_rest = quaternion.to_body(frames.attitude, frames.angular_velocity)
    carried = largest((motion.shape.inertia @ at_rest[:, :, None])[:, :, 0])
    fastest, most = largest(frames.angular_velocity), largest(frames.angular_momentum)
    thick = _THICK * size
    if fastest:
        for path in (entities.ANGULAR_VELOCITY, entities.TENSOR_OMEGA):
            arrow = longest_as(_OMEGA * size, frames.angular_velocity)
            write_arrow(recording, path, frames.time, arrow, "ω", OMEGA, thick)
        yield f"the arrow of ω (orange, of the root part) is {fastest:.4g} rad/s where it is longest"
    if most <= _NO_MOMENTUM * carried:
        yield "the angular momentum is zero and has no arrow"
        return
    for path in (entities.ANGULAR_MOMENTUM, entities.TENSOR_MOMENTUM):
        arrow = longest_as(_MOMENTUM * size, frames.angular_momentum)
        write_arrow(recording, path, frames.time, arrow, "L", MOMENTUM, thick)
    yield f"that of L (blue) is {most:.4g} kg m²/s and stays"


def _write_tensor(recording: Recording, motion: Motion) -> Iterator[str]:
    """Write the solid ellipsoid that has the moments of the whole body, as it changes."""
    import rerun as rr

    moments, axes = np.linalg.eigh(motion.shape.inertia)
    axes[:, :, 0] *= np.linalg.det(axes)[:, None]
    sizes = np.stack([equivalent_ellipsoid(each, motion.shape.mass) for each in moments]) / motion.unit
    attitude = quaternion.multiply(motion.frames.attitude, quaternion.from_matrix(axes))
    recording.static(entities.TENSOR, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    line = 0.3 * _THICK * motion.reach
    write_ellipsoid(recording, entities.ELLIPSOID, motion.frames.time, sizes, ELLIPSOID, line, attitude)
    yield "the ellipsoid on the right is solid and uniform, of the body's own mass and moments at every instant"


def _write_plots(recording: Recording, run: Run, assembly: JointedBody) -> None:
    named = [
        (f"{part.name} {number}" if len(part.joints) > 1 else part.name, joint.revolute)
        for part in assembly.parts
        for number, joint in enumerate(part.joints, 1)
    ]
    values = run.quantities["joint values"]
    for path, unit, revolute in ((entities.PLOT_JOINTS, "rad", True), (entities.PLOT_SLIDES, "m", False)):
        columns = [k for k, (_, turns) in enumerate(named) if turns == revolute]
        if columns:
            names = [f"{named[k][0]}, {unit}" for k in columns]
            colors = [COLORS[k % len(COLORS)] for k in range(len(columns))]
            write_series(recording, path, run, values[:, columns].__getitem__, names, colors)
    moments, work = run.quantities["principal moments"], run.quantities["work of the joints"]
    names = [f"I{k}, kg m²" for k in (1, 2, 3)]
    write_series(recording, entities.PLOT_MOMENTS, run, lambda rows: moments[rows], names, COLORS[:3])
    write_angular_velocity(recording, run, np.eye(3))
    write_series(
        recording,
        entities.PLOT_WORK,
        run,
        lambda rows: np.stack([run.energy[rows], work[rows]], axis=1),
        ["kinetic energy, J", "work of the joints, J"],
        COLORS[3:5],
    )
