"""Quantities of runs by name: of one run, or of many draws at once."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field

import numpy as np

from inertia.arrays import Bool, Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.run import Run
from inertia.errors import UsageError
from inertia.records import dataclass

_VECTORS = {"attitude": 4, "angular_velocity": 3, "angular_momentum": 3, "position": 3}
_COMPONENT = re.compile(r"(.+)\[(\d+)\]")


@dataclass(frozen=True, eq=False)
class States:
    """The motion of m draws at n instants, in part axes and SI units, as `Run` has that of one.

    Attributes
    ----------
    attitude : (…, n, 4); angular_velocity, angular_momentum : (…, n, 3); energy : (…, n)
    position : (…, n, 3) m, or None
    further : {name: (…, n) or (…, n, k)} of the model
    """

    attitude: Float
    angular_velocity: Float
    angular_momentum: Float
    energy: Float
    position: Float | None = None
    further: Mapping[str, Float] = field(default_factory=dict)

    def some(self, rows: Bool) -> States:
        """Return some of the draws, without what only single runs have."""
        return States(self.attitude[rows], self.angular_velocity[rows], self.angular_momentum[rows], self.energy[rows])

    @classmethod
    def of(cls, run: Run) -> States:
        """Take those of a run; numbers that hold for all of it, one or a row of them, are the same at every instant."""
        series = run.series
        further = {}
        for name, values in run.quantities.items():
            array = np.asarray(values, dtype=np.float64)
            if name not in series and array.ndim <= 1:
                array = np.broadcast_to(array, (len(run.time), *array.shape))
            if array.ndim in (1, 2) and len(array) == len(run.time):
                further[name] = array
        return cls(run.attitude, run.angular_velocity, run.angular_momentum, run.energy, run.position, further)


@dataclass(frozen=True, eq=False)
class Reference:
    """What the motion of a draw is compared with.

    Attributes
    ----------
    attitude : (n, 4), that of the run without deviations
    axis : (3,) in the body, part axes, and `upright` (3,) in space, that `tilt` is the angle between
    """

    attitude: Float
    axis: Float
    upright: Float

    @classmethod
    def of(cls, run: Run) -> Reference:
        """Take the axis from a held body's point to its centre of mass against gravity, or that of the first spin."""
        scene = run.scene
        held, gravity = scene.constraint, scene.gravity
        up = -gravity if gravity.any() and held.kind != "free" else None
        arm = scene.body.center_of_mass - held.fixed_point
        if up is not None and held.holds and arm.any():
            axis = arm
        elif up is not None and held.axis is not None:
            axis = held.axis
        else:
            spin = run.angular_velocity[0]
            axis = spin if spin.any() else run.plan.axes[:, 2]
            up = quaternion.to_space(run.attitude[0], axis)
        return cls(run.attitude, _unit(axis), _unit(up))

    def deviation(self, attitude: Float) -> Float:
        """Return the rotation vectors (…, n, 3) rad, in space, from the reference to attitudes (…, n, 4)."""
        turn = quaternion.multiply(attitude, quaternion.conjugate(self.attitude))
        size = np.linalg.norm(turn[..., :3], axis=-1, keepdims=True)
        angle = 2.0 * np.arctan2(size, np.abs(turn[..., 3:]))
        sign = np.where(turn[..., 3:] < 0, -1.0, 1.0)
        vector: Float = sign * turn[..., :3] * np.divide(angle, size, out=np.full_like(size, 2.0), where=size > 0)
        return vector

    def tilt(self, attitude: Float) -> Float:
        """Return the angles (…, n) rad between the axis and what was upright."""
        axis = quaternion.to_space(attitude, self.axis)
        across = np.linalg.norm(np.cross(axis, self.upright), axis=-1)
        return np.asarray(np.arctan2(across, axis @ self.upright))


def names_of(states: States) -> tuple[str, ...]:
    """Return the names of all quantities that there are; one with components is followed by the index of one."""
    names = ["deviation", "tilt", "spin", "energy"]
    vectors = {name: size for name, size in _VECTORS.items() if name != "position" or states.position is not None}
    for name, values in states.further.items():
        if values.ndim > states.energy.ndim:
            vectors[name] = values.shape[-1]
        else:
            names.append(name)
    return (*names, *(f"{name}[{k}]" for name, size in vectors.items() for k in range(size)))


def require_names(states: States, names: tuple[str, ...]) -> None:
    """Raise `UsageError` where a quantity is none of a run."""
    known = names_of(states)
    for name in names:
        if name not in known:
            listed = [
                f"{one[:-3]}[0] …" if one.endswith("[0]") else one for one in known if not re.search(r"\[[1-9]", one)
            ]
            raise UsageError(f"the run has no quantity {name!r}: ask for {', '.join(listed)}")


def quantity(name: str, states: States, reference: Reference) -> Float:
    """Return a quantity (…, n); not a number where the model has none of that name.

    ``deviation`` is the angle from the reference, ``tilt`` that of `Reference.tilt`, ``spin`` |ω|; others are those of
    a run, with the index of a component.
    """
    if name == "deviation":
        return quaternion.angle_between(states.attitude, reference.attitude)
    if name == "tilt":
        return reference.tilt(states.attitude)
    if name == "spin":
        return np.asarray(np.linalg.norm(states.angular_velocity, axis=-1))
    if name == "energy":
        return states.energy
    match = _COMPONENT.fullmatch(name)
    whole = match[1] if match else name
    values = getattr(states, whole) if whole in _VECTORS else states.further.get(whole)
    if values is None:
        return np.full(states.energy.shape, np.nan)
    return np.asarray(values[..., int(match[2])] if match else values)


def _unit(vector: Float) -> Float:
    largest = np.abs(vector).max()
    vector = vector / largest
    unit: Float = vector / np.linalg.norm(vector)
    return unit
