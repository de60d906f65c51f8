"""`Run`: what a simulation hands back, in part axes and SI units, with the accuracy it reached."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.andoyer import Andoyer, to_andoyer
from inertia.dynamics.kinematics.canonical import momenta
from inertia.dynamics.kinematics.euler_angles import Convention, to_angles, unwrap
from inertia.dynamics.motion import Event, Motion
from inertia.dynamics.plan import Plan
from inertia.dynamics.scene.document import Scene


@dataclass(frozen=True)
class RunError:
    """The accuracy of the attitude, rad: as asked for, as reached at the worst sample, and by which method."""

    requested: float
    reached: float
    method: str


@dataclass(frozen=True, eq=False)
class Invariant:
    """Something that the equations keep: its value at every sample, (n,) or (n, 3), and how far it strayed.

    The drift is the largest |value(t) − value(0)|, relative to |value(0)| or to the model's own scale where that may
    vanish.
    """

    values: Float
    largest_relative_drift: float

    @property
    def initial(self) -> Float:
        """Its value at t = 0, () or (3,)."""
        return np.asarray(self.values[0])


@dataclass(frozen=True, eq=False)
class Run:
    """The motion of a body at n instants.

    Attributes
    ----------
    plan : `Plan`: the model that ran, in which axes, and why
    time : (n,) s
    attitude : (n, 4) unit quaternions, scalar last, part axes to space
    angular_velocity : (n, 3) rad/s, part axes
    angular_momentum : (n, 3) kg m²/s, space axes, about the centre of mass or the fixed point
    energy : (n,) J: of the rotation about that point, and of gravity where it turns the body; of a rolling body, all;
        of a body that changes its shape, of all motion about its centre of mass
    position : (n, 3) m, the centre of mass in space; None where the scene leaves it at the origin
    error : `RunError`
    invariants : {name: `Invariant`}
    remarks : what kind of motion it is, in sentences
    events : `Event`, in the order of time
    warnings : sentences
    quantities : {name: (n, …) or a number} further outputs of the model, SI units
    steps : how many steps were taken; 0 for a closed form
    """

    plan: Plan
    time: Float
    attitude: Float
    angular_velocity: Float
    angular_momentum: Float
    energy: Float
    position: Float | None
    error: RunError
    invariants: Mapping[str, Invariant] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    events: tuple[Event, ...] = ()
    warnings: tuple[str, ...] = ()
    quantities: Mapping[str, Float] = field(default_factory=dict)
    steps: int = 0

    @property
    def scene(self) -> Scene:
        """The scene that was followed."""
        return self.plan.problem.scene

    @property
    def model(self) -> str:
        """The name of the model that ran."""
        return self.plan.model

    @property
    def why(self) -> tuple[str, ...]:
        """The reasons for it, in sentences."""
        return self.plan.why

    def euler_angles(self, convention: Convention = "z-x-z") -> Float:
        """Return Euler angles (n, 3) of the part axes, rad, without jumps (`kinematics.euler_angles`)."""
        return unwrap(to_angles(self.attitude, convention), convention)

    def canonical_momenta(self, convention: Convention = "z-x-z") -> Float:
        """Return the momenta (n, 3) conjugate to `euler_angles`, kg m²/s (`kinematics.canonical.momenta`)."""
        return momenta(to_angles(self.attitude, convention), self.angular_momentum, convention, "space")

    def andoyer(self) -> Andoyer:
        """Return the Serret–Andoyer variables of the part axes (`inertia.dynamics.kinematics.andoyer`)."""
        return to_andoyer(self.attitude, quaternion.to_body(self.attitude, self.angular_momentum))


def invariants_of(motion: Motion, angular_momentum: Float) -> dict[str, Invariant]:
    """Return what a motion keeps, with its drift; L (n, 3) and its components are measured by the largest |L|,
    or by the model's scale where that is larger."""
    largest = float(np.linalg.norm(angular_momentum, axis=1).max())
    invariants = {}
    for name, values in motion.invariants.items():
        scale = motion.scales.get(name)
        if name.startswith("angular momentum"):
            scale = max(largest, scale or 0.0)
        invariants[name] = _invariant(values, scale)
    return invariants


def _invariant(values: Float, scale: float | None) -> Invariant:
    vectors = values if values.ndim == 2 else values[:, None]
    strayed = float(np.linalg.norm(vectors - vectors[0], axis=1).max())
    size = scale or float(np.linalg.norm(vectors[0]))
    if strayed == 0:
        return Invariant(values, 0.0)
    return Invariant(values, strayed / size if size else np.inf)
