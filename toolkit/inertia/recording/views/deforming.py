"""A body that changes its shape: every part in motion, and the ellipsoid of the whole body's moments with it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.assembly import JointedBody, Shape
from inertia.dynamics.run import Run
from inertia.recording import paths, places
from inertia.recording.display import equivalent_ellipsoid
from inertia.recording.frames import Frames, frames_of, write_arrow
from inertia.recording.moving_parts import Solid, solids_of
from inertia.recording.panels import longest_as, write_text
from inertia.recording.playback import largest
from inertia.recording.screen import Screen
from inertia.recording.series import COLORS, drift_unit, write_angular_velocity, write_drift
from inertia.recording.summary import summary, title
from inertia.recording.views.blueprint_deforming import Layout, blueprint
from inertia.recording.views.tumbling import MOMENTUM, OMEGA
from inertia.recording.writer import Recording

APPLICATION = "inertia-deforming"

ELLIPSOID = (230, 120, 80, 90)

_OMEGA, _MOMENTUM = 1.1, 1.25  # lengths of arrows, over the reach of the body
_THICK = 0.01
_NO_MOMENTUM = 1e-12  # of |I ω|, at most: an L that is nothing but rounding is not drawn


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


def deforming(run: Run) -> Screen:
    """Return the recording of a body that changes its shape."""
    assembly = run.scene.body.assembly
    assert assembly is not None  # the plan saw to it
    frames = frames_of(run)
    solids, motion = _built(run, assembly, frames)
    hinges = [joint.revolute for joint in assembly.joints]
    travel = 0.0 if frames.position is None else float(np.ptp(frames.position, axis=0).max()) / motion.unit
    layout = Layout(
        reach=motion.reach,
        path=None if not travel else _path_box(frames, motion.unit),
        duration=float(run.time[-1]),
        speed=frames.play.speed,
        drift_unit=drift_unit(run),
        hinges=any(hinges),
        slides=not all(hinges),
    )

    def write(recording: Recording) -> None:
        said = [*frames.play.said, f"1 unit is {motion.unit:g} m"]
        said += _write_parts(recording, assembly, solids, motion)
        said += _write_arrows(recording, motion)
        said += _write_tensor(recording, motion)
        _write_plots(recording, run, assembly)
        write_drift(recording, run)
        write_text(recording, summary(run, said))

    return Screen(APPLICATION, title(run), blueprint(layout), write)


def _built(run: Run, assembly: JointedBody, frames: Frames) -> tuple[list[Solid], Motion]:
    """Return the parts as shown, and how they move."""
    shape = assembly.shape(frames.time)
    solids = solids_of(assembly, run.scene.body.meshes)
    farthest = 0.0
    for k, solid in enumerate(solids):
        place = quaternion.to_space(shape.part_attitude[:, k], solid.center) + shape.part_position[:, k]
        farthest = max(farthest, largest(place - shape.center_of_mass) + solid.radius)
    unit = 10.0 ** math.floor(math.log10(farthest))
    return solids, Motion(frames, shape, unit, farthest / unit)


def _path_box(frames: Frames, unit: float) -> tuple[Float, Float]:
    """Return the corners (3,) of the box around the path, in the view's unit from its start."""
    assert frames.position is not None  # the caller saw to it
    path = (frames.position - frames.position[0]) / unit
    return path.min(axis=0), path.max(axis=0)


def _write_parts(recording: Recording, assembly: JointedBody, solids: list[Solid], motion: Motion) -> Iterator[str]:
    import rerun as rr

    frames, shape, unit = motion.frames, motion.shape, motion.unit
    recording.static(paths.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    if frames.position is not None:
        frames.write_position(recording, unit, frames.position[0])
        yield "the grey line is the path of the centre of mass"
    root = quaternion.to_space(frames.attitude, motion.from_center(np.zeros(3)))
    _write_pose(recording, paths.BODY, frames.time, root, frames.attitude)
    for k, (part, solid) in enumerate(zip(assembly.parts, solids, strict=True)):
        path = f"{places.PARTS}/{rr.escape_entity_path_part(part.name)}"
        recording.static(f"{path}/solid", *solid.archetypes(unit, k))
        _write_pose(recording, path, frames.time, shape.part_position[:, k] / unit, shape.part_attitude[:, k])
    if any(solid.triangles is None for solid in solids):
        yield "parts without a file are shown as the solid ellipsoids of the same moments, points as small spheres"
    for solid, part in zip(solids, assembly.parts, strict=True):
        if solid.said:
            yield f"{part.name}: {solid.said}"


def _write_pose(recording: Recording, path: str, time: Float, place: Float, attitude: Float) -> None:
    import rerun as rr

    moved, turned = place.astype(np.float32), attitude.astype(np.float32)
    recording.columns(path, time, lambda rows: rr.Transform3D.columns(translation=moved[rows], quaternion=turned[rows]))


def _write_arrows(recording: Recording, motion: Motion) -> Iterator[str]:
    """Write ω of the root and L, about the centre of mass and beside the ellipsoid."""
    frames, size = motion.frames, motion.reach
    at_rest = quaternion.to_body(frames.attitude, frames.angular_velocity)
    carried = largest((motion.shape.inertia @ at_rest[:, :, None])[:, :, 0])
    fastest, most = largest(frames.angular_velocity), largest(frames.angular_momentum)
    thick = _THICK * size
    if fastest:
        for path in (paths.ANGULAR_VELOCITY, places.TENSOR_OMEGA):
            arrow = longest_as(_OMEGA * size, frames.angular_velocity)
            write_arrow(recording, path, frames.time, arrow, "ω", OMEGA, thick)
        yield f"the arrow of ω (yellow, of the root part) is {fastest:.4g} rad/s where it is longest"
    if most <= _NO_MOMENTUM * carried:
        yield "the angular momentum is zero and has no arrow"
        return
    for path in (paths.ANGULAR_MOMENTUM, places.TENSOR_MOMENTUM):
        arrow = longest_as(_MOMENTUM * size, frames.angular_momentum)
        write_arrow(recording, path, frames.time, arrow, "L", MOMENTUM, thick)
    yield f"that of L (blue) is {most:.4g} kg m²/s and stays"


def _write_tensor(recording: Recording, motion: Motion) -> Iterator[str]:
    """Write the solid ellipsoid that has the moments of the whole body, as it changes."""
    import rerun as rr

    moments, axes = np.linalg.eigh(motion.shape.inertia)
    axes[:, :, 0] *= np.linalg.det(axes)[:, None]
    sizes = np.stack([equivalent_ellipsoid(each, motion.shape.mass) for each in moments]) / motion.unit
    turned = quaternion.multiply(motion.frames.attitude, quaternion.from_matrix(axes)).astype(np.float32)
    half_sizes = sizes.astype(np.float32)
    recording.static(places.TENSOR, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    look: dict[str, Any] = {
        "colors": [ELLIPSOID],
        "line_radii": [0.3 * _THICK * motion.reach],
        "fill_mode": rr.components.FillMode.TransparentFillMajorWireframe,
    }
    recording.static(places.ELLIPSOID, rr.Ellipsoids3D.from_fields(**look))
    recording.columns(
        places.ELLIPSOID,
        motion.frames.time,
        lambda rows: rr.Ellipsoids3D.columns(half_sizes=half_sizes[rows], quaternions=turned[rows]),
    )
    yield "the ellipsoid on the right is solid and uniform, of the body's own mass and moments at every instant"


def _write_plots(recording: Recording, run: Run, assembly: JointedBody) -> None:
    named = [
        (f"{part.name} {number}" if len(part.joints) > 1 else part.name, joint.revolute)
        for part in assembly.parts
        for number, joint in enumerate(part.joints, 1)
    ]
    values = run.quantities["joint values"]
    for path, unit, revolute in ((places.PLOT_JOINTS, "rad", True), (places.PLOT_SLIDES, "m", False)):
        columns = [k for k, (_, turns) in enumerate(named) if turns == revolute]
        if columns:
            names = [f"{named[k][0]}, {unit}" for k in columns]
            colors = [COLORS[k % len(COLORS)] for k in range(len(columns))]
            recording.scalars(path, run.time, values[:, columns].__getitem__, names, colors)
    moments, work = run.quantities["principal moments"], run.quantities["work of the joints"]
    names = [f"I{k}, kg m²" for k in (1, 2, 3)]
    recording.scalars(places.PLOT_MOMENTS, run.time, lambda rows: moments[rows], names, COLORS[:3])
    write_angular_velocity(recording, run, np.eye(3))
    recording.scalars(
        places.PLOT_WORK,
        run.time,
        lambda rows: np.stack([run.energy[rows], work[rows]], axis=1),
        ["kinetic energy, J", "work of the joints, J"],
        COLORS[3:5],
    )
