"""`Scene`: a body, how it starts, what holds it and loads it, and for how long it is followed.

A scene comes from a TOML file, from its text, from a dictionary of the same layout, or is put together in Python.
Every field is checked, unknown ones are refused, and an error names the field by its path.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, fields
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from inertia.arrays import Float
from inertia.documents import Document, FieldError, require_known, section_of
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.catalogue import acting, load_of
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.losses import Damping
from inertia.dynamics.loads.orbit import Orbit
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.scene.body import SceneBody, build
from inertia.dynamics.scene.parts import build_parts
from inertia.dynamics.scene.sections import BodySource, Constraint, Frame, Settings, Start
from inertia.errors import FieldPath, GeometryError, ReadError, UsageError, placed
from inertia.records import dataclass

_SECTIONS = ("schema", "body", "part", "start", "constraint", "load", "run")
_FAR = 10.0  # sizes of the body, beyond which a point may be in another unit
_ALONG = 1e-9  # of a velocity along a plane, that may point out of it

NO_THICKNESS = 1e-30
"""Of the largest moment: less is none, and such an axis turns faster than can be followed."""


@dataclass(frozen=True, eq=False)
class Scene(Document):
    """Everything that a run needs.

    Parameters
    ----------
    body : `SceneBody`: of a tensor, by `SceneBody.of` from `MassProperties`, by `SceneBody.of_assembly` from parts on
        joints, or by `build` from a `BodySource`
    start : `Start`
    run : `Settings`
    constraint : `Constraint`; free without it
    applied_loads : gravity, torques, damping, ... (see `inertia.dynamics.loads`)
    text : the scene file as it was read, None without one
    name : the file's path, or "the scene"

    Raises `UsageError` naming the field, `ReadError` for files, `GeometryError` for what is not physical.

    >>> import numpy as np
    >>> scene = Scene(SceneBody(np.diag([1.0, 2.0, 3.0])), Start([0.0, 0.0, 1.0]), Settings(1.0))
    >>> scene.angular_velocity.tolist(), scene.constraint.kind
    ([0.0, 0.0, 1.0], 'free')
    """

    noun: ClassVar[str] = "scene"

    body: SceneBody
    start: Start
    run: Settings
    constraint: Constraint = field(default_factory=Constraint)
    applied_loads: tuple[Load, ...] = ()
    text: str | None = None
    name: str = "the scene"

    def __post_init__(self) -> None:
        object.__setattr__(self, "applied_loads", tuple(self.applied_loads))
        _require_sense(self)

    @classmethod
    def _from_table(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> Scene:
        require_known(table, _SECTIONS, "")
        if "body" in table and "part" in table:
            raise FieldError("part", "is given beside [body]: a body is either one part or several")
        for section in ("part" if "part" in table else "body", "start", "run"):
            if section not in table:
                raise FieldError(section, f"is missing: the scene needs a section [{section}]")
        loads = table.get("load", [])
        if not isinstance(loads, Sequence) or isinstance(loads, str):
            raise FieldError("load", "must be a list of tables: write [[load]] in double brackets")
        return cls(
            start=section_of(Start, table["start"]),
            run=section_of(Settings, table["run"]),
            constraint=section_of(Constraint, table.get("constraint", {})),
            applied_loads=tuple(_load(load, f"load[{k}]", folder, name) for k, load in enumerate(loads)),
            body=build_parts(table["part"], folder)
            if "part" in table
            else build(section_of(BodySource, table["body"]), folder),
            text=text,
            name=name,
        )

    def to_dict(self) -> dict[str, Any]:
        """Return a dictionary laid out as a scene file is that gives the same motion; a part comes as its tensor.

        Raises `UsageError` where a torque is a function or a table.

        >>> scene = Scene.from_dict({"body": {"principal_moments": [1, 2, 3]},
        ...                          "start": {"angular_velocity": [0, 10, 0.001]}, "run": {"duration": 60}})
        >>> Scene.loads(scene.to_toml()).angular_velocity.tolist()
        [0.0, 10.0, 0.001]
        """
        return {
            "schema": self.version,
            **self._bodies(),
            "start": {**_fields(self.start), "angular_velocity": self.angular_velocity, "frame": "part"},
            "constraint": _fields(self.constraint),
            "run": _fields(self.run),
            "load": [load.entries(self.body.axes) for load in self.applied_loads],
        }

    def _bodies(self) -> dict[str, Any]:
        tensor = ("inertia", "mass", "center_of_mass")
        if self.body.assembly is None:
            return {"body": {name: getattr(self.body, name) for name in tensor}}
        parts = []
        for part in self.body.assembly.parts:
            joints = [_fields(joint) | {"axis": joint.typed_axis} for joint in part.joints]
            parts.append({name: getattr(part, name) for name in ("name", "parent", *tensor)})
            parts[-1] |= {"joint": joints} if joints else {}
        return {"part": parts}

    @property
    def source_text(self) -> str | None:
        """The text of a scene file that gives the same motion: as it was read, or written anew; None where none can."""
        try:
            return self.to_toml() if self.text is None else self.text
        except UsageError:
            return None

    @property
    def angular_velocity(self) -> Float:
        """Angular velocity at t = 0, (3,) rad/s, part axes."""
        return self.in_part_axes(self.start.angular_velocity, self.start.frame)

    @cached_property
    def acting_loads(self) -> tuple[Load, ...]:
        """The loads without those that are zero, or add up to zero."""
        return acting(self.applied_loads)

    @property
    def gravity(self) -> Float:
        """Acceleration of gravity, (3,) m/s², space axes."""
        total: Float = sum((load.acceleration for load in self.applied_loads if isinstance(load, Gravity)), np.zeros(3))
        return total

    @property
    def orbit(self) -> Orbit | None:
        """The orbit that the centre of mass goes on; None where it goes on none."""
        return next((load for load in self.applied_loads if isinstance(load, Orbit)), None)

    @property
    def arm(self) -> Float:
        """From the point of the constraint to the centre of mass, (3,) m, part axes."""
        return self.body.center_of_mass - self.constraint.fixed_point

    @cached_property
    def is_pendulum(self) -> bool:
        """Whether all mass lies on one line through a fixed point: a point mass, or a thin rod, that swings."""
        held_off = self.constraint.kind == "fixed_point" and self.arm.any()
        return bool(held_off and _has_no_moment(self, self.arm / np.linalg.norm(self.arm)))

    @property
    def notes(self) -> tuple[str, ...]:
        """What the scene leaves to ask, in sentences: those of the body, and whether the point is in another unit."""
        body, arm = self.body, float(np.linalg.norm(self.arm))
        if not self.constraint.holds or not arm or body.mass is None:
            return body.notes
        size = 2.0 * float(np.sqrt(5.0 * body.principal.second_moments.max() / body.mass))
        if not 0 < _FAR * size < arm:
            return body.notes
        far = f"constraint.point is {arm:.4g} m from the centre of mass of a body that is about {size:.3g} m long"
        return (*body.notes, f"{far}: it counts in m, along the part axes")

    def in_part_axes(self, vector: Float, frame: Frame) -> Float:
        """Return the part components (3,) of a vector given in `frame` at t = 0."""
        if frame == "part":
            return vector
        if frame == "space":
            return quaternion.to_body(self.start.attitude, vector)
        resolved: Float = self.body.axes @ vector
        return resolved


def _load(load: object, path: str, folder: Path, name: str) -> Load:
    """Make one load; a file that it names and cannot be read is named after the scene and the field."""
    try:
        return load_of(load, path, folder)
    except ReadError as error:
        raise placed(error, name, FieldPath(f"{path}.table")) from None


def _require_sense(scene: Scene) -> None:
    """Raise `UsageError` where fields contradict each other or one is lacking, `GeometryError` for what cannot be."""
    _require_mass(scene)
    _require_moments(scene)
    if scene.body.deforms and scene.constraint.kind != "free":
        raise FieldError("constraint.kind", f'is "{scene.constraint.kind}": a body that changes its shape must be free')
    _require_loads_that_fit(scene)
    if scene.start.velocity is not None and scene.constraint.kind not in ("free", "sliding"):
        raise FieldError("start.velocity", "is given, but the constraint decides it: leave it out")
    if scene.constraint.kind == "sliding":
        _require_ball(scene)
    if not np.any(scene.start.angular_velocity) and not _is_turned(scene):
        raise FieldError("start.angular_velocity", "is zero, and nothing makes the body turn: give a spin or a torque")


def _is_turned(scene: Scene) -> bool:
    """Whether a load can set a body in motion that is at rest."""
    if scene.body.deforms or any(load.starts_motion for load in scene.acting_loads):
        return True
    if scene.constraint.stiffness and scene.constraint.rest_angle:
        return True
    if scene.constraint.kind == "rolling" or (scene.constraint.friction and scene.start.velocity is not None):
        return bool(scene.gravity.any())
    return scene.constraint.kind != "free" and bool(scene.gravity.any() and scene.arm.any())


def _has_no_moment(scene: Scene, axis: Float) -> bool:
    """Whether no mass is away from an axis (3,), of unit length, through the point of the constraint."""
    principal, mass, arm = scene.body.principal, scene.body.mass or 0.0, scene.arm
    # Squares: what rounding leaves of a moment that vanishes is far below the limit.
    along, off = principal.axes.T @ axis, np.cross(axis, arm)
    moment = float(principal.moments @ along**2 + mass * (off @ off))
    return not moment > NO_THICKNESS * float(principal.moments[2] + mass * (arm @ arm))


def _require_moments(scene: Scene) -> None:
    """Raise `GeometryError` where there is no moment about an axis that the body may turn about."""
    least, _, largest = scene.body.principal.moments
    if scene.constraint.kind == "hinge":
        assert scene.constraint.axis is not None  # the constraint saw to it
        if _has_no_moment(scene, scene.constraint.axis):
            raise GeometryError(
                "no mass is away from the axle, about which there is no rotation to follow then: give the body a "
                "thickness, or ",
                FieldPath("constraint.point"),
                " another place",
            )
    elif scene.constraint.kind == "fixed_point" and scene.arm.any():
        return  # there are moments about it, or it is a pendulum
    elif not largest:
        raise GeometryError("the inertia tensor is zero: a point has no attitude to follow, unless it is held off it")
    elif not least > NO_THICKNESS * largest:
        raise GeometryError(
            f"the smallest principal moment is {least:.3g} kg m², and about an axis that no mass is away from there "
            "is no rotation to follow: give the body a thickness"
        )


def _require_mass(scene: Scene) -> None:
    body, constraint = scene.body, scene.constraint
    if body.mass is not None:
        return
    for k, load in enumerate(scene.applied_loads):
        if load.acts_on_mass:
            raise FieldError("body.mass", f"is missing: load[{k}], {load.kind}, acts on mass")
    if constraint.kind in ("rolling", "sliding"):
        raise FieldError("body.mass", f"is missing: a {constraint.kind} body needs it")
    if constraint.holds and np.any(scene.arm):
        raise FieldError("body.mass", f"is missing: the moments about {constraint.held_at} need it")


def _require_loads_that_fit(scene: Scene) -> None:
    kind = scene.constraint.kind
    for k, load in enumerate(scene.applied_loads):
        if scene.body.deforms and not isinstance(load, Gravity):
            raise FieldError(f"load[{k}]", f"is {load.kind}: a body that changes its shape takes gravity only")
        if kind != "free" and load.free_bodies_only:
            raise FieldError(f"load[{k}]", f"is {load.kind}, which acts on a free body, not on one that is held")
        if kind == "hinge" and not (
            isinstance(load, Gravity | Damping) or (isinstance(load, Torque) and load.constant)
        ):
            raise FieldError(
                f"load[{k}]", f"is {load.kind}: a body on an axle takes gravity, damping and constant torques"
            )
        if kind in ("rolling", "sliding") and not isinstance(load, Gravity):
            raise FieldError(f"load[{k}]", f"is {load.kind}: a {kind} body takes gravity only")
        load.require_span(scene.run.duration, f"load[{k}]")
    if scene.is_pendulum:
        _require_gravity_alone(scene)
    if scene.orbit is not None:
        _require_orbit_alone(scene)
    if kind == "rolling":
        x, y, z = scene.gravity.tolist()
        if x or y or not z < 0:
            raise FieldError("load", 'needs one of kind = "gravity" along −z: the body rolls on the plane z = 0')


def _require_ball(scene: Scene) -> None:
    """Raise `FieldError` where a ball that slides is not on its plane, or its centre of mass not within it."""
    held, velocity = scene.constraint, scene.start.velocity
    radius, arm = held.radius or 0.0, float(np.linalg.norm(scene.arm))
    if arm >= radius:
        raise FieldError(
            "constraint.point", f"is {arm:.6g} m from the centre of mass, which lies within the ball of {radius:.6g} m"
        )
    if not scene.gravity @ held.plane < 0:
        raise FieldError("load", 'needs one of kind = "gravity" that presses the body on the plane it slides on')
    if velocity is not None and abs(float(velocity @ held.plane)) > _ALONG * float(np.linalg.norm(velocity)):
        raise FieldError("start.velocity", "points out of the plane or into it: the part along the normal follows")


def _require_gravity_alone(scene: Scene) -> None:
    """Raise `FieldError` where something else than gravity turns a body that has no moment about the line it is on."""
    what = "a body whose mass lies on one line through the fixed point"
    for k, load in enumerate(scene.applied_loads):
        if not isinstance(load, Gravity):
            raise FieldError(f"load[{k}]", f"is {load.kind}: {what} takes gravity only, give it a thickness")
    assert scene.body.mass is not None  # an arm needs one
    if not scene.body.mass * float(np.linalg.norm(scene.gravity)) * float(np.linalg.norm(scene.arm)):
        raise FieldError("load", f'needs one of kind = "gravity" for {what}: give it a thickness without')


def _require_orbit_alone(scene: Scene) -> None:
    """Raise `FieldError` where something beside an orbit says how the centre of mass moves."""
    for k, load in enumerate(scene.applied_loads):
        if isinstance(load, Gravity) or (isinstance(load, Orbit) and load is not scene.orbit):
            raise FieldError(
                f"load[{k}]", f"is {load.kind} beside an orbit, which the centre of mass follows: keep one"
            )
    for name in ("position", "velocity"):
        if getattr(scene.start, name) is not None:
            raise FieldError(f"start.{name}", "is given beside an orbit, which decides it: leave it out")


def _fields(section: Any) -> dict[str, Any]:
    return {each.name: getattr(section, each.name) for each in fields(section)}
