"""`Motion`: what a model hands back, the motion of a set of axes fixed in the body, and how well it is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Event:
    """Something that happened at an instant: `name` as "flip" or "turning point", `time` in s, `what` a sentence."""

    name: str
    time: float
    what: str


@dataclass(frozen=True, eq=False)
class Motion:
    """A model's answer at n instants, resolved along the axes that the model works in (its docstring says which).

    Attributes
    ----------
    attitude : (n, 4) scalar-last quaternions, those axes to space
    angular_velocity : (n, 3) rad/s, along those axes
    position : (n, 3) m, the reference point (centre of mass, or the point that the model follows) in space; None where
        it stays where it is
    method : the method that ran, with its order
    reached : rad, estimate or bound of the largest attitude error over the samples
    invariants : {name: (n,) or (n, 3)} what the equations keep, evaluated at every sample; SI units
    scales : {name: a magnitude} that the drift of an invariant is relative to, where its own initial value may vanish
    quantities : {name: (n, …)} further outputs of the model; SI units, radians
    events : in the order of time
    warnings : sentences
    remarks : what kind of motion it is, in sentences
    steps : how many steps were taken; 0 for a closed form
    """

    attitude: Float
    angular_velocity: Float
    method: str
    reached: float
    position: Float | None = None
    invariants: Mapping[str, Float] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)
    quantities: Mapping[str, Float] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    warnings: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    steps: int = 0

    def turned(self, turn: Float) -> Motion:
        """Return the motion as seen from space axes that the attitude `turn` (4,) takes its own space axes to."""
        invariants = {
            name: quaternion.to_space(turn, values) if values.ndim == 2 else values
            for name, values in self.invariants.items()
        }
        return replace(self, attitude=quaternion.multiply(turn, self.attitude), invariants=invariants)
