"""`Scene`: a body, how it starts, what holds it and loads it, and for how long it is followed.

A scene comes from a TOML file, from its text, from a dictionary of the same layout, or is put together in Python.
Every field is checked, unknown ones are refused, and an error names the field by its path.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from inertia.arrays import Float
from inertia.documents import (
    Document,
    FieldError,
    Section,
    choice,
    integer,
    number,
    numbers,
    require_known,
    section_of,
    text,
)
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.catalogue import load_of
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.load import Load
from inertia.dynamics.scene.body import BodySource, SceneBody, build
from inertia.dynamics.scene.consistency import require_sense
from inertia.dynamics.scene.fields import attitude_of, direction
from inertia.dynamics.scene.parts import build_parts

Frame = Literal["principal", "part", "space"]
Kind = Literal["free", "fixed_point", "rolling"]

FINEST = 1e-15
"""rad: no attitude in float64 is known better than the rounding of its four components."""

_SECTIONS = ("schema", "body", "part", "start", "constraint", "load", "run")
_MOST_SAMPLES = 10_000_000


@dataclass(frozen=True, eq=False)
class Start(Section):
    """The section ``[start]``: the state at t = 0.

    Attributes
    ----------
    angular_velocity : (3,) rad/s, resolved in `frame`
    frame : "principal" (the principal axes, moments ascending; the part axes where the scene gave the principal
        moments), "part" or "space"
    attitude : (4,) unit quaternion, scalar last, part axes to space
    position : (3,) m in space: of the centre of mass, of the fixed point, or of the point of contact
    velocity : (3,) m/s in space, of the centre of mass of a free body
    """

    section: ClassVar[str] = "start"

    angular_velocity: Annotated[Float, numbers((3,), "rad/s")]
    frame: Annotated[Frame, choice("principal", "part", "space")] = "principal"
    attitude: Annotated[Float, attitude_of] = quaternion.IDENTITY  # type: ignore[assignment]
    position: Annotated[Float | None, numbers((3,), "m")] = None
    velocity: Annotated[Float | None, numbers((3,), "m/s")] = None


@dataclass(frozen=True, eq=False)
class Constraint(Section):
    """The section ``[constraint]``: what holds the body.

    Attributes
    ----------
    kind : "free", "fixed_point" or "rolling" (without slip, on its rim, on the plane z = 0 of space)
    point : (3,) m, part axes, of a fixed point; the origin of the part axes without it
    radius : m, of the rim that rolls
    offset : m, of the rim's plane from the centre of mass, along `axis`, which it needs
    axis : (3,) of the body of revolution that rolls, part axes; without it that of the two equal moments
    """

    section: ClassVar[str] = "constraint"

    kind: Annotated[Kind, choice("free", "fixed_point", "rolling")] = "free"
    point: Annotated[Float | None, numbers((3,), "m")] = None
    radius: Annotated[float | None, number("m", positive=True)] = None
    offset: Annotated[float | None, number("m")] = None
    axis: Annotated[Float | None, direction] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where a field goes with another constraint, or is missing."""
        owners = {"point": "fixed_point", "radius": "rolling", "offset": "rolling", "axis": "rolling"}
        for name, kind in owners.items():
            if getattr(self, name) is not None and self.kind != kind:
                raise FieldError(f"{path}.{name}", f'goes with kind = "{kind}" only, not with "{self.kind}"')
        if self.kind == "rolling" and self.radius is None:
            raise FieldError(f"{path}.radius", "is missing: a rolling body needs the radius of its rim, in m")
        if self.offset and self.axis is None:
            raise FieldError(f"{path}.axis", f"is missing: {path}.offset says how far along it the rim is")

    @property
    def fixed_point(self) -> Float:
        """The fixed point (3,) m, part axes."""
        return np.zeros(3) if self.point is None else self.point


@dataclass(frozen=True, eq=False)
class Settings(Section):
    """The section ``[run]``: how long, how often, how accurately, and by which model if not by the smallest.

    Attributes
    ----------
    duration : s
    samples : how many instants, evenly spaced from 0 to `duration`, both included
    accuracy : rad, of the attitude at every sample
    model : the model to use, in place of the one that `plan` picks
    method : the integrator to use, which makes the run a stepped one
    """

    section: ClassVar[str] = "run"

    duration: Annotated[float, number("seconds", positive=True)]
    samples: Annotated[int, integer(2, _MOST_SAMPLES)] = 1001
    accuracy: Annotated[float, number("rad", positive=True)] = 1e-10
    model: Annotated[str | None, text] = None
    method: Annotated[str | None, text] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where the accuracy is none that can be reached."""
        if self.accuracy < FINEST:
            raise FieldError(
                f"{path}.accuracy",
                f"is {self.accuracy:g} rad, finer than an attitude in float64 can be: ask for {FINEST:g} or more",
            )
        if self.accuracy > 1:
            raise FieldError(f"{path}.accuracy", f"is {self.accuracy:g} rad: that is no accuracy, ask for 1 or less")


@dataclass(frozen=True, eq=False)
class Scene(Document):
    """Everything that a run needs.

    Parameters
    ----------
    body : `SceneBody`, made by `SceneBody.of` from a `Body` or `MassProperties`, by `SceneBody.of_assembly` from parts
        on joints, or by `build` from a `BodySource`
    start : `Start`
    run : `Settings`
    constraint : `Constraint`; free without it
    applied_loads : gravity, torques, damping, ... (see `inertia.dynamics.loads`)
    text : the scene file as it was read, None without one
    name : the file's path, or "the scene"

    Raises `UsageError` naming the field, `ReadError` for files, `GeometryError` for what is not physical.

    >>> import numpy as np
    >>> from inertia.dynamics.body import Body
    >>> scene = Scene(SceneBody.of(Body(np.diag([1.0, 2.0, 3.0]))), Start([0.0, 0.0, 1.0]), Settings(1.0))
    >>> scene.angular_velocity.tolist(), scene.constraint.kind
    ([0.0, 0.0, 1.0], 'free')
    """

    noun: ClassVar[str] = "scene"

    body: SceneBody
    start: Start
    run: Settings
    constraint: Constraint = Constraint()
    applied_loads: tuple[Load, ...] = ()
    text: str | None = None
    name: str = "the scene"

    def __post_init__(self) -> None:
        object.__setattr__(self, "applied_loads", tuple(self.applied_loads))
        require_sense(self)

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
            applied_loads=tuple(load_of(load, f"load[{k}]", folder) for k, load in enumerate(loads)),
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
            "body": _fields(self.body.body),
            "start": {**_fields(self.start), "angular_velocity": self.angular_velocity, "frame": "part"},
            "constraint": _fields(self.constraint),
            "run": _fields(self.run),
            "load": [load.entries(self.body.axes) for load in self.applied_loads],
        }

    @property
    def angular_velocity(self) -> Float:
        """Angular velocity at t = 0, (3,) rad/s, part axes."""
        return self.in_part_axes(self.start.angular_velocity, self.start.frame)

    @property
    def gravity(self) -> Float:
        """Acceleration of gravity, (3,) m/s², space axes."""
        total: Float = sum((load.acceleration for load in self.applied_loads if isinstance(load, Gravity)), np.zeros(3))
        return total

    def in_part_axes(self, vector: Float, frame: Frame) -> Float:
        """Return the part components (3,) of a vector given in `frame` at t = 0."""
        if frame == "part":
            return vector
        if frame == "space":
            return quaternion.to_body(self.start.attitude, vector)
        resolved: Float = self.body.axes @ vector
        return resolved


def _fields(section: Any) -> dict[str, Any]:
    return {each.name: getattr(section, each.name) for each in fields(section)}
