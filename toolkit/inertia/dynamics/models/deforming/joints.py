"""Parts, and the joints with prescribed angles that hang them on one another.

Every part is described in one set of axes, the *assembly axes*: those of the root part, in the pose where every joint
is at zero. A part hangs on its parent by joints in series, the first one nearest the parent, so that three of them
with a common point make a ball joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import InitVar, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.documents import FieldError, number, numbers
from inertia.errors import GeometryError
from inertia.mass.tensor import faults
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Joint:
    """A hinge (`angles` given) or a slide (`displacements` given) that follows keyframes.

    Between two keyframes the value is the quintic that has the rates stated and no acceleration at both, so that rate
    and acceleration are continuous throughout. Without rates it comes to rest at every keyframe: the motion of minimum
    jerk (Flash and Hogan, J. Neurosci. 5 (1985) 1688). Before the first and after the last keyframe the joint goes on
    at the rate it has there; a single keyframe with a rate is a wheel that turns steadily.

    Attributes
    ----------
    axis : (3,) assembly axes, any length but zero: the hinge turns right-handed about it, the slide moves along it
    times : (k,) s, ascending, at least one
    angles : (k,) rad, of a hinge
    displacements : (k,) m, of a slide
    point : (3,) m, assembly axes, on the hinge's axis; of no meaning for a slide
    rates : (k,) rad/s or m/s at the keyframes; zero without
    path : what errors call the joint

    Raises `FieldError`, which names the entry, where a field is not usable.

    >>> hinge = Joint(axis=[0, 0, 1], times=[0, 2], angles=[0, 1])
    >>> [x.tolist() for x in hinge.at([0.0, 1.0, 2.0, 9.0])]
    [[0.0, 0.5, 1.0, 1.0], [0.0, 0.9375, 0.0, 0.0]]
    """

    axis: Float
    times: Float
    angles: Float | None = None
    displacements: Float | None = None
    point: Float = (0.0, 0.0, 0.0)  # type: ignore[assignment]
    rates: Float | None = None
    path: InitVar[str] = field(default="joint", kw_only=True)

    def __post_init__(self, path: str) -> None:
        if (self.angles is None) == (self.displacements is None):
            says = "has neither angles nor displacements" if self.angles is None else "has both"
            raise FieldError(path, f"{says}: give angles for a hinge, displacements for a slide")
        axis: Float = numbers((3,), "any unit")(self.axis, f"{path}.axis")
        length = float(np.linalg.norm(axis))
        if not 0 < length < np.inf:
            raise FieldError(f"{path}.axis", f"is {axis.tolist()}: it must have a direction")
        times = _column(self.times, f"{path}.times", "s")
        if not times.size:
            raise FieldError(f"{path}.times", "is empty: give one keyframe or more")
        for k in range(1, len(times)):
            if times[k] <= times[k - 1]:
                says = f"is {times[k]:.6g} s, not after the {times[k - 1]:.6g} s before it: put them in order"
                raise FieldError(f"{path}.times[{k}]", says)
        name, unit = ("angles", "rad") if self.revolute else ("displacements", "m")
        values = _column(getattr(self, name), f"{path}.{name}", unit)
        rates = np.zeros(len(times)) if self.rates is None else _column(self.rates, f"{path}.rates", f"{unit}/s")
        for what, column in ((name, values), ("rates", rates)):
            if len(column) != len(times):
                raise FieldError(f"{path}.{what}", f"has {len(column)} entries for {len(times)} times: give one each")
        object.__setattr__(self, "_typed_axis", axis)
        for what, value in (("axis", axis / length), ("times", times), (name, values), ("rates", rates)):
            object.__setattr__(self, what, value)
        object.__setattr__(self, "point", numbers((3,), "m")(self.point, f"{path}.point"))

    @property
    def typed_axis(self) -> Float:
        """The axis (3,) as it was given, of any length."""
        typed: Float = self.__dict__["_typed_axis"]
        return typed

    @property
    def revolute(self) -> bool:
        """Whether this is a hinge."""
        return self.angles is not None

    @cached_property
    def moves(self) -> bool:
        """Whether the joint ever leaves its first value."""
        values, rates = self.columns
        return bool(np.any(rates) or np.any(values != values[0]))

    @property
    def columns(self) -> tuple[Float, Float]:
        """The values (k,) and the rates (k,) at the keyframes."""
        values = self.displacements if self.angles is None else self.angles
        assert values is not None
        assert self.rates is not None
        return values, self.rates

    def at(self, time: ArrayLike, later: ArrayLike = 0.0) -> tuple[Float, Float]:
        """Return the value, rad or m, and its rate at times (n,) s, or `later` (n,) s than them: (n,) each.

        What is later is added to the time since the last keyframe, which two that are close leave few digits of in
        their sum. It must not lead past the next keyframe.
        """
        values, rates = self.columns
        t, more = np.broadcast_arrays(np.asarray(time, dtype=np.float64), np.asarray(later, dtype=np.float64))
        ended = (t >= self.times[-1]) | (t < self.times[0])
        within = np.clip(t, self.times[0], self.times[-1])
        inside = np.where(ended, 0.0, more)
        if len(self.times) == 1:
            value, rate = np.full(t.shape, values[0]), np.full(t.shape, rates[0])
        else:
            k = np.searchsorted(self.times[1:-1], within, side="right")
            length = self.times[k + 1] - self.times[k]
            s = (within - self.times[k] + inside) / length
            rise = values[k + 1] - values[k] - rates[k] * length
            gain = (rates[k + 1] - rates[k]) * length
            c3, c4, c5 = 10 * rise - 4 * gain, 7 * gain - 15 * rise, 6 * rise - 3 * gain
            value = values[k] + s * (rates[k] * length + s * s * (c3 + s * (c4 + s * c5)))
            rate = rates[k] + s * s * (3 * c3 + s * (4 * c4 + s * 5 * c5)) / length
            over = t >= self.times[-1]  # where what rounding leaves of the quintic would go on
            value, rate = np.where(over, values[-1], value), np.where(over, rates[-1], rate)
        return value + rate * (t - within + (more - inside)), rate


def _column(value: object, path: str, unit: str) -> Float:
    entries = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(entries, Sequence) or isinstance(entries, str):
        raise FieldError(path, f"must be a list of numbers, {unit}")
    read = number(unit)
    return np.array([read(one, f"{path}[{k}]") for k, one in enumerate(entries)], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class JointedPart:
    """A rigid part of an assembly.

    Attributes
    ----------
    name : by which other parts call it their parent
    mass : kg
    inertia : (3, 3) kg m² about the part's own centre of mass, assembly axes; zero for a point mass
    center_of_mass : (3,) m, assembly axes
    parent : None for the root
    joints : from the parent outwards; a part without joints is fixed to its parent
    bounds : how far mass (kg), centre of mass (m) and tensor (kg m², Frobenius norm) may be from what they are
    covariance : (11, 11), as `StandardUncertainty.covariance`, independent of that of other parts; None where nothing
        is stated to be uncertain

    Raises `FieldError` where a field is not usable, `GeometryError` where mass or tensor are not physical.
    """

    name: str
    mass: float
    inertia: Float
    center_of_mass: Float = (0.0, 0.0, 0.0)  # type: ignore[assignment]
    parent: str | None = None
    joints: tuple[Joint, ...] = ()
    bounds: tuple[float, float, float] = (0.0, 0.0, 0.0)
    covariance: Float | None = None

    def __post_init__(self) -> None:
        path = f'part "{self.name}"'
        object.__setattr__(self, "joints", tuple(self.joints))
        object.__setattr__(self, "mass", number("kg", positive=True)(self.mass, f"{path}.mass"))
        object.__setattr__(self, "inertia", numbers((3, 3), "kg m²")(self.inertia, f"{path}.inertia"))
        com = numbers((3,), "m")(self.center_of_mass, f"{path}.center_of_mass")
        object.__setattr__(self, "center_of_mass", com)
        if reasons := faults(self.inertia):
            raise GeometryError(f"{path}.inertia is not physical: {reasons[0]}", code="unphysical")
        if self.joints and self.parent is None:
            raise FieldError(f"{path}.parent", "is missing: joints hang a part on another one, which must be named")

    def altered(self, inertia: Float, center_of_mass: Float, mass: float | None) -> JointedPart:
        """Return the part with other mass properties, which need be no body's: that of a point mass has no tensor."""
        other = copy(self)
        for name, value in (("inertia", inertia), ("center_of_mass", center_of_mass), ("mass", mass)):
            object.__setattr__(other, name, value)
        return other
