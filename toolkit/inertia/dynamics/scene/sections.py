"""The sections of a scene file, ``[body]``, ``[start]``, ``[constraint]`` and ``[run]``: what each field may hold."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from inertia.arrays import Float, of_rotation
from inertia.documents import FieldError, Section, choice, estimate, integer, number, numbers, text
from inertia.dynamics.kinematics import quaternion
from inertia.estimate import uncertainty_of
from inertia.records import dataclass

Frame = Literal["principal", "part", "space"]
Kind = Literal["free", "fixed_point", "hinge", "rolling", "sliding"]

FINEST = 1e-15
"""rad: no attitude in float64 is known better than the rounding of its four components."""

SLIP_SPEED = 0.01
"""m/s, below which the friction of a ball that slides is viscous, where the scene does not say."""

_MOST_SAMPLES = 10_000_000
_SOURCES = ("part", "inertia", "principal_moments")
FOR_PART = ("unit", "density", "material", "shell", "wire", "sigma", "allow_faults")
"""Fields of ``[body]`` that go with a mesh, beside its `mass`."""

_UNIT_LENGTH = 1e-6


def attitude_of(value: Any, path: str) -> Float:
    """Read a unit quaternion, scalar last; what rounding left of its length is divided out."""
    q: Float = numbers((4,), "x, y, z, w")(value, path)
    length = float(np.linalg.norm(q))
    if length == 0:
        raise FieldError(path, "is zero: it must be a unit quaternion, x, y, z, w; [0, 0, 0, 1] turns nothing")
    if abs(length - 1.0) > _UNIT_LENGTH:
        unit = (q / length).tolist()
        raise FieldError(path, f"has length {length:.9g}: it must be a unit quaternion, such as {unit}")
    return quaternion.normalise(q)


def direction(value: Any, path: str) -> Float:
    """Read a direction (3,) and give it unit length."""
    vector: Float = numbers((3,), "no unit")(value, path)
    largest = float(np.abs(vector).max())
    if largest == 0:
        raise FieldError(path, "is zero: it must point somewhere")
    vector = vector / largest
    return vector / np.linalg.norm(vector)


@dataclass(frozen=True, eq=False)
class BodySource(Section):
    """The section ``[body]``: one of `part`, `inertia` and `principal_moments`, and what goes with it.

    Attributes
    ----------
    part : path of a mesh, STEP or assembly file (TOML), relative to the scene file
    unit : length unit of its coordinates; millimetres are assumed where neither this nor the file says one
    density, material : kg/m³, or a name in the table of materials; 1000 kg/m³ is assumed without them
    mass : kg; with a part, as weighed
    shell : thickness in the part's unit: the surface of the part carries the mass, and may be open
    wire : cross-section in the part's unit squared: the lines of the part carry the mass
    sigma : standard deviation of the noise of every coordinate of the part, in its unit; with it, and with a density or
        mass as "7850±50", the standard uncertainties of the principal moments are noted
    allow_faults : relative bound up to which small faults of the part's mesh are allowed for, as `inertia.analyse` does
    inertia : (3, 3) kg m² about the centre of mass, part axes
    principal_moments : (3,) kg m²; the part axes are then the principal axes, in this order
    center_of_mass : (3,) m, part axes; with inertia or principal_moments
    """

    section: ClassVar[str] = "body"

    part: Annotated[str | None, text] = None
    unit: Annotated[str | None, text] = None
    density: Annotated[float | None, estimate("kg/m³")] = None
    material: Annotated[str | None, text] = None
    mass: Annotated[float | None, estimate("kg")] = None
    shell: Annotated[float | None, estimate("the part's unit")] = None
    wire: Annotated[float | None, estimate("the part's unit squared")] = None
    sigma: Annotated[float | None, number("the part's unit", positive=True)] = None
    allow_faults: Annotated[float | None, number("", positive=True, below=1.0)] = None
    inertia: Annotated[Float | None, numbers((3, 3), "kg m²")] = None
    principal_moments: Annotated[Float | None, numbers((3,), "kg m²")] = None
    center_of_mass: Annotated[Float | None, numbers((3,), "m")] = None

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where the body is given twice, or not at all."""
        sources = [name for name in _SOURCES if getattr(self, name) is not None]
        if len(sources) != 1:
            fault = f"has both {' and '.join(sources)}" if sources else "has no tensor"
            raise FieldError(path, f"{fault}: give one of {', '.join(_SOURCES)}")
        if not self.part and uncertainty_of(self.mass):
            raise FieldError(f"{path}.mass", "has an uncertainty, which goes with a part only: give the mass alone")
        stray = ("center_of_mass",) if self.part else FOR_PART
        for name in stray:
            if getattr(self, name) is not None:
                why = "the part has its own" if self.part else "only a part file has one"
                raise FieldError(f"{path}.{name}", f"goes with no {sources[0]}: leave it out, {why}")


@dataclass(frozen=True, eq=False)
class Start(Section):
    """The section ``[start]``: the state at t = 0.

    Attributes
    ----------
    angular_velocity : (3,) rad/s, resolved in `frame`
    frame : "principal" (the principal axes, moments ascending; the part axes where the scene gave the principal
        moments), "part" or "space"
    attitude : (4,) unit quaternion, scalar last, part axes to space; or a `Rotation` of scipy
    position : (3,) m in space: of the centre of mass, of the fixed point, or of the point of contact
    velocity : (3,) m/s in space, of the centre of mass of a free body, or along the plane of a ball that slides
    """

    section: ClassVar[str] = "start"

    angular_velocity: Annotated[Float, numbers((3,), "rad/s")]
    frame: Annotated[Frame, choice("principal", "part", "space")] = "principal"
    attitude: Annotated[Float, attitude_of] = quaternion.IDENTITY  # type: ignore[assignment]
    position: Annotated[Float | None, numbers((3,), "m")] = None
    velocity: Annotated[Float | None, numbers((3,), "m/s")] = None

    def __post_init__(self, path: str | None) -> None:
        object.__setattr__(self, "_typed_attitude", self.attitude)
        super().__post_init__(path)

    @property
    def typed_attitude(self) -> Float:
        """The attitude (4,) as it was given, of nearly unit length."""
        return np.asarray(of_rotation(self.__dict__["_typed_attitude"], 4), dtype=np.float64)


_OWNERS = {
    "point": ("fixed_point", "hinge", "sliding"),
    "axis": ("hinge", "rolling"),
    "radius": ("rolling", "sliding"),
    "offset": ("rolling",),
    **dict.fromkeys(("drive", "stiffness", "rest_angle", "bearings"), ("hinge",)),
    **dict.fromkeys(("friction", "slip_speed", "normal"), ("sliding",)),
}
"""The kinds of constraint that each field goes with."""


def _is_stated(value: Any) -> bool:
    """Whether a field of a constraint says something of its own."""
    return isinstance(value, np.ndarray) or value not in (None, 0.0, "free")


@dataclass(frozen=True, eq=False)
class Constraint(Section):
    """The section ``[constraint]``: what holds the body.

    Attributes
    ----------
    kind : "free", "fixed_point", "hinge" (on an axle), "rolling" (without slip, on its rim, on the plane z = 0 of
        space) or "sliding" (a ball, with friction, on a plane)
    point : (3,) m, part axes, of a fixed point, on the axle, or the centre of the ball that slides; the origin of the
        part axes without it
    radius : m, of the rim that rolls, or of the ball that slides
    offset : m, of the rim's plane from the centre of mass, along `axis`, which it needs
    axis : (3,) of the axle, or of the body of revolution that rolls, part axes; of that, without it, the axis of the
        two equal moments
    drive : of an axle: "free", or "constant_speed", which keeps the spin of the start
    stiffness : N m/rad of a torsion spring on the axle; rest_angle : rad from the start, at which it is slack
    bearings : (2,) m along the axle from `point`, of two bearings that share the force
    friction : coefficient μ between a ball that slides and the plane
    slip_speed : u₀ in m/s; at a slip u the friction is μ N u/√(u² + u₀²)
    normal : (3,) of the plane that it slides on, space axes; z without it
    """

    section: ClassVar[str] = "constraint"

    kind: Annotated[Kind, choice("free", "fixed_point", "hinge", "rolling", "sliding")] = "free"
    point: Annotated[Float | None, numbers((3,), "m")] = None
    radius: Annotated[float | None, number("m", positive=True)] = None
    offset: Annotated[float | None, number("m")] = None
    axis: Annotated[Float | None, direction] = None
    drive: Annotated[Literal["free", "constant_speed"], choice("free", "constant_speed")] = "free"
    stiffness: Annotated[float, number("N m/rad", negative=False)] = 0.0
    rest_angle: Annotated[float, number("rad")] = 0.0
    bearings: Annotated[Float | None, numbers((2,), "m")] = None
    friction: Annotated[float | None, number("", negative=False)] = None
    slip_speed: Annotated[float | None, number("m/s", positive=True)] = None
    normal: Annotated[Float | None, direction] = None

    def __post_init__(self, path: str | None) -> None:
        object.__setattr__(self, "_typed_axis", self.axis)
        object.__setattr__(self, "_typed_normal", self.normal)
        super().__post_init__(path)

    @property
    def typed_axis(self) -> Float:
        """The axis (3,) as it was given, of any length."""
        return np.asarray(self.__dict__["_typed_axis"], dtype=np.float64)

    @property
    def typed_normal(self) -> Float:
        """The normal (3,) of the plane that a ball slides on, as it was given, of any length."""
        typed = self.__dict__["_typed_normal"]
        return self.plane if typed is None else np.asarray(typed, dtype=np.float64)

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where a field goes with another constraint, or is missing."""
        for name, kinds in _OWNERS.items():
            value = getattr(self, name)
            if _is_stated(value) and self.kind not in kinds:
                owners = " or ".join(f'kind = "{kind}"' for kind in kinds)
                raise FieldError(f"{path}.{name}", f'goes with {owners} only, not with "{self.kind}"')
        if self.kind == "hinge" and self.axis is None:
            raise FieldError(f"{path}.axis", "is missing: say which way the axle runs, along the part axes")
        if self.bearings is not None and self.bearings[0] == self.bearings[1]:
            raise FieldError(f"{path}.bearings", f"are both at {self.bearings[0]:g} m: two share the force")
        if self.kind == "rolling" and self.radius is None:
            raise FieldError(f"{path}.radius", "is missing: a rolling body needs the radius of its rim, in m")
        if self.kind == "sliding" and self.radius is None:
            raise FieldError(f"{path}.radius", "is missing: a ball that slides needs its radius, in m")
        if self.kind == "sliding" and self.friction is None:
            raise FieldError(f"{path}.friction", "is missing: say how rough the plane is; 0 for a smooth one")
        if self.offset and self.axis is None:
            raise FieldError(f"{path}.axis", f"is missing: {path}.offset says how far along it the rim is")

    @property
    def holds(self) -> bool:
        """Whether a point of the body stays where it is."""
        return self.kind in ("fixed_point", "hinge")

    @property
    def plane(self) -> Float:
        """The normal (3,) of the plane that a ball slides on, space axes."""
        return np.array([0.0, 0.0, 1.0]) if self.normal is None else self.normal

    @property
    def held_at(self) -> str:
        """What holds the body, in words."""
        return "the axle" if self.kind == "hinge" else "the fixed point"

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
    time_limit : s of computing that the run may take; one that would take much more is refused as soon as that shows
    """

    section: ClassVar[str] = "run"

    duration: Annotated[float, number("seconds", positive=True)]
    samples: Annotated[int, integer(2, _MOST_SAMPLES)] = 1001
    accuracy: Annotated[float, number("rad", positive=True)] = 1e-10
    model: Annotated[str | None, text] = None
    method: Annotated[str | None, text] = None
    time_limit: Annotated[float, number("seconds", positive=True)] = 60.0

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where the accuracy is none that can be reached."""
        if self.accuracy < FINEST:
            raise FieldError(
                f"{path}.accuracy",
                f"is {self.accuracy:g} rad, finer than an attitude in float64 can be: ask for {FINEST:g} or more",
            )
        if self.accuracy > 1:
            raise FieldError(f"{path}.accuracy", f"is {self.accuracy:g} rad: that is no accuracy, ask for 1 or less")
