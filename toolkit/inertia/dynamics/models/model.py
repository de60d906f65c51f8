"""`Model`: what every model of a motion offers; `Problem`: a scene as models see it; `Candidate`: how well one fits.

The cost of a model is an estimate in rad of the attitude error after the duration T that taking the scene for so simple
makes. Moments that differ by a relative δ (of the smallest) turn the body apart at about δ |ω|, whence δ |ω| T.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.arguments import rounded_up
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.load import Load
from inertia.dynamics.models.neighbours import InputBound
from inertia.dynamics.models.rational import Exact, rounded
from inertia.dynamics.motion import Motion
from inertia.dynamics.scene.body import nearest
from inertia.dynamics.scene.document import NO_THICKNESS, Scene
from inertia.mass.principal import principal
from inertia.records import dataclass

SHARE = 0.1
"""Part of the accuracy asked for that a smaller model may cost."""

NEARLY_EQUAL = 1e-3
"""Relative difference up to which it is worth saying that moments are nearly equal."""

AXIS_PAIRS = ((1, 2), (2, 0), (0, 1))
"""The axes across each axis."""


@dataclass(frozen=True, eq=False)
class Problem:
    """The rotation that a scene asks for: about which point, with which moments, spin and weight.

    Attributes
    ----------
    scene : `Scene`
    reference : (3,) m, part axes: the centre of mass, or the fixed point
    axes : (3, 3), columns in part axes: the principal axes about the reference point
    moments : (3,) kg m², about them, ascending
    uncertainty : relative, the largest bound on a moment: what the mass properties are known to; infinite of none
    angular_velocity : (3,) rad/s at t = 0, along those axes
    arm : (3,) m, along them, from the reference point to the centre of mass
    exact : all of these before they were rounded to float64
    weight : N, mass times gravity; 0 where it has no arm to turn the body with
    """

    scene: Scene
    reference: Float
    axes: Float
    moments: Float
    uncertainty: float
    angular_velocity: Float
    arm: Float
    weight: float
    exact: Exact

    @classmethod
    def of(cls, scene: Scene) -> Problem:
        """Take the moments about the point that the scene turns about, and the spin along the principal axes there."""
        body = scene.body
        reference = scene.constraint.fixed_point if scene.constraint.holds else body.center_of_mass
        arm = body.center_of_mass - reference
        # With no tolerance nearly equal moments keep the axes that they have.
        about = principal(body.about(reference), 0.0) if arm.any() else body.principal_within(0.0)
        exact = Exact.of(scene, reference, about.axes, bool(arm.any()))
        there = about.moments > NO_THICKNESS * about.moments[2]
        unknown = np.divide(about.moment_bounds, about.moments, out=np.full(3, np.inf), where=there)
        return cls(
            scene=scene,
            reference=reference,
            axes=np.array([rounded(row)[0] for row in exact.frame.rows]),
            moments=rounded(exact.frame.values)[0],
            uncertainty=float(unknown.max()),
            angular_velocity=rounded(exact.frame.along(exact.spin))[0],
            arm=rounded(exact.frame.along(exact.arm))[0],
            exact=exact,
            weight=float(np.linalg.norm(scene.gravity)) * (body.mass or 0.0) if arm.any() else 0.0,
        )

    @property
    def duration(self) -> float:
        """How long the motion is followed, s."""
        return self.scene.run.duration

    @cached_property
    def angle_turned(self) -> float:
        """|ω| T in rad."""
        return float(np.linalg.norm(self.angular_velocity)) * self.duration

    @cached_property
    def least(self) -> float:
        """The smallest moment, kg m²; where that vanishes the one about the axle, or across the line to the mass."""
        if self.moments[0] > NO_THICKNESS * self.moments[2]:
            return float(self.moments[0])
        along = self.axes.T @ self.axle if self.hinged else np.array([0.0, 1.0, 0.0])
        return float(self.moments @ along**2)

    @cached_property
    def angle_by_weight(self) -> float:
        """The angle in rad that gravity could turn the body by: ½ M g h T²/I1."""
        pull = self.weight * float(np.linalg.norm(self.arm)) / self.least
        return 0.5 * pull * self.duration**2

    @property
    def rolls(self) -> bool:
        """Whether the body rolls on a plane."""
        return self.scene.constraint.kind == "rolling"

    @property
    def slides(self) -> bool:
        """Whether the body is a ball that slides on a plane."""
        return self.scene.constraint.kind == "sliding"

    @property
    def hinged(self) -> bool:
        """Whether the body turns about an axle."""
        return self.scene.constraint.kind == "hinge"

    @property
    def axle(self) -> Float:
        """The direction (3,) of the axle, part axes."""
        assert self.scene.constraint.axis is not None
        return self.scene.constraint.axis

    @property
    def relative_tensor_bound(self) -> float:
        """How far a moment may be off, as a part of it; 0 where the whole tensor was typed."""
        if not self.exact.tensor_bound:
            return 0.0
        bound = self.exact.tensor_bound / self.least
        return bound if self.arm.any() or self.scene.body.properties is None else min(bound, self.uncertainty)

    @property
    def relative_weight_bound(self) -> float:
        """How far mass times arm may be off, as a part of it."""
        if not self.weight:
            return 0.0
        return self.exact.mass_bound / float(self.exact.mass) + self.exact.arm_bound / float(np.linalg.norm(self.arm))

    @cached_property
    def pace(self) -> float:
        """|ω| at t = 0, or the rate in rad/s at which the weight swings or tips the body, where that is more."""
        radius = self.scene.constraint.radius
        if radius is not None:
            speed = float(np.linalg.norm(self.angular_velocity))
            return math.hypot(speed, math.sqrt(float(np.linalg.norm(self.scene.gravity)) / radius))
        swing = math.sqrt(self.weight * float(np.linalg.norm(self.arm)) / self.least)
        return max(float(np.linalg.norm(self.angular_velocity)), swing)

    @property
    def relative_contact_bound(self) -> float:
        """How far the tensor, mass and centre of mass of a body on a plane may be off, as parts of what they are."""
        radius = self.scene.constraint.radius
        if radius is None or not self.exact.mass:
            return 0.0
        mass = self.exact.mass_bound / float(self.exact.mass)
        return self.relative_tensor_bound + mass + self.center_bound / radius

    @property
    def relative_bound(self) -> float:
        """How far a moment, or the torque of the weight against the inertia, may be off, as a part of it."""
        if not self.weight:
            return self.relative_tensor_bound
        pull = self.weight * float(np.linalg.norm(self.arm)) / self.least / self.pace**2
        return self.relative_tensor_bound + pull * self.relative_weight_bound

    @property
    def center_bound(self) -> float:
        """How far the centre of mass may be from where it is said to be, m."""
        properties = self.scene.body.properties
        return self.exact.arm_bound if properties is None else properties.error.center_of_mass

    @property
    def rigid(self) -> bool:
        """Whether a rigid body turns in all ways about its centre of mass or a fixed point."""
        held = self.rolls or self.slides or self.hinged or self.scene.is_pendulum
        return not held and not self.scene.body.deforms

    @cached_property
    def torques(self) -> tuple[Load, ...]:
        """The loads that act, other than gravity."""
        return tuple(load for load in self.scene.acting_loads if not isinstance(load, Gravity))

    @property
    def acting(self) -> tuple[Load, ...]:
        """The loads that turn the body: without gravity where it has no arm."""
        return tuple(load for load in self.scene.acting_loads if self.weight or not isinstance(load, Gravity))

    @property
    def why(self) -> list[str]:
        """What the reference point and the loads need saying, in sentences."""
        body, kind = self.scene.body, self.scene.constraint.kind
        stiff = body.assembly is not None and not body.deforms
        rigid = ["No joint moves: the parts make one rigid body."] if stiff else []
        if kind == "rolling":
            how = "its velocity follows from its rotation, and the plane pushes back"
            reason = f"The body rolls without slipping: {how}."
        elif kind in ("hinge", "sliding"):
            return []
        elif kind == "fixed_point" and not self.arm.any():
            reason = "The body is held at its centre of mass, where gravity has no arm: it turns as a free body does."
        elif kind == "fixed_point":
            where = ", ".join(f"{x + 0.0:.6g}" for x in self.reference)
            reason = f"The body is held at ({where}) m of the part axes, and its moments are taken there (Steiner)."
        elif self.scene.gravity.any():
            reason = "Gravity pulls at the centre of mass: it makes the path a parabola and leaves the rotation free."
        elif not self.torques:
            free = "it turns about its centre of mass, whose path is straight"
            zero = " (the loads are zero, or add up to zero)" if self.scene.applied_loads else ""
            reason = f"The body is free and no torque acts{zero}: {free}."
        else:
            return rigid
        return [*rigid, reason]

    def symmetric_about(self, direction: Float) -> tuple[Float, Float, float]:
        """Return right-handed axes with `direction` (3,) third, the moments about them, and how far from symmetric.

        The last is what the tensor there lacks of diag(I, I, I3), relative to the smallest moment.
        """
        columns = np.column_stack([*across(direction), direction])
        tensor = columns.T @ (self.moments[:, None] * columns)
        transverse = 0.5 * (tensor[0, 0] + tensor[1, 1])
        symmetric = np.array([transverse, transverse, tensor[2, 2]])
        defect = float(np.linalg.norm(tensor - np.diag(symmetric)) / self.moments[0])
        return self.axes @ columns, symmetric, defect


@dataclass(frozen=True, eq=False)
class Candidate:
    """A model that could follow a scene, and what that would cost.

    Attributes
    ----------
    model : `Model`
    problem : `Problem`
    axes : (3, 3), columns in part axes, as the model wants them; moments (3,) kg m² about them
    cost : rad
    unseen : rad, the part of the cost that the model's own estimate of its error leaves out
    why : the reason for it, a sentence
    near_miss : what nearly holds where the cost is too high, the beginning of a sentence; empty where nothing does
    order : of the principal axes of the problem, where the axes are those
    inputs : what the bounds of the mass properties do, where that is known beforehand
    """

    model: Model
    problem: Problem
    axes: Float
    moments: Float
    cost: float
    why: str
    near_miss: str = ""
    unseen: float = 0.0
    order: tuple[int, ...] = (0, 1, 2)
    inputs: InputBound | None = None

    @property
    def mass(self) -> float:
        """The mass, kg; 0 where the scene has none."""
        return self.problem.scene.body.mass or 0.0

    @property
    def arm(self) -> Float:
        """From the reference point to the centre of mass, (3,) m along the axes."""
        return self.axes.T @ (self.problem.axes @ self.problem.arm)

    @property
    def numbers(self) -> tuple[int, ...]:
        """What the axes are called: the numbers, from 1, of the nearest of those that ``frame = "principal"`` means."""
        _, order = nearest(self.axes, self.problem.scene.body.axes)
        return tuple(order.index(k) + 1 for k in range(3))

    @property
    def attitude(self) -> Float:
        """The attitude (4,) of the axes at t = 0, to space."""
        return quaternion.multiply(self.problem.scene.start.attitude, quaternion.from_matrix(self.axes))

    @property
    def angular_velocity(self) -> Float:
        """The angular velocity (3,) rad/s at t = 0, along the axes."""
        return self.axes.T @ self.problem.scene.angular_velocity

    @cached_property
    def input_bound(self) -> InputBound:
        """How far the bounds of the mass properties may move the attitude."""
        return self.inputs or self.model.input_bound(self)

    @property
    def rest(self) -> tuple[Float, Float]:
        """What float64 leaves out of the moments (3,) and of ω (3,) at t = 0, where the axes are principal ones."""
        exact, order = self.problem.exact, list(self.order)
        return rounded(exact.frame.values)[1][order], rounded(exact.frame.along(exact.spin))[1][order]


class Model(ABC):
    """A model of a motion. Its module and the list in `inertia.dynamics.models.catalogue` are all that knows it."""

    name: ClassVar[str]
    """What ``run.model`` calls it."""

    default_method: ClassVar[str | None] = None
    """The one of `methods` that always runs where none is asked for; None where that depends on the problem."""

    @property
    def methods(self) -> Mapping[str, int]:
        """What ``run.method`` may ask for, with the orders; nothing where the model has one way of its own."""
        return {}

    @abstractmethod
    def candidate(self, problem: Problem) -> Candidate | None:
        """Return what following the problem by this model would cost, and why it can; None where it cannot."""

    @abstractmethod
    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return the motion of the candidate's axes, in space, at the instants (n,), with what is known of it."""

    def resolved(self, candidate: Candidate, time: Float, known: tuple[Float, Motion]) -> Motion | None:
        """Return the motion at other instants (n,) from that at samples (k,); None where it is to be solved again."""
        return None

    def input_bound(self, candidate: Candidate) -> InputBound:
        """Return how far the bounds of the mass properties may move the attitude: here as far as the body turns."""
        problem = candidate.problem
        time = np.array([0.0, problem.duration])
        return InputBound(time, problem.relative_tensor_bound * np.array([0.0, problem.angle_turned]))

    def view(self, problem: Problem) -> str:
        """Return the name of the view that records the motion, one of `inertia.recording.record.VIEWS`."""
        return "top" if problem.weight else "tumbling"

    def angular_momentum(self, candidate: Candidate, motion: Motion) -> Float:
        """Return the angular momentum (n, 3) in space about the reference point, kg m²/s."""
        return quaternion.to_space(motion.attitude, candidate.moments * motion.angular_velocity)

    def energy(self, candidate: Candidate, motion: Motion) -> Float:
        """Return the energy (n,) of the rotation about the reference point, and of the loads that have one, J."""
        energy: Float = 0.5 * (candidate.moments * motion.angular_velocity**2).sum(axis=1)
        for load in candidate.problem.acting:
            if load.conservative:
                energy = energy + load.potential(motion.attitude, candidate)
        return energy

    def too_costly(self, candidate: Candidate) -> FieldError:
        """Return what is wrong with a scene that no other model can follow, and this one at too high a cost only."""
        return FieldError(
            "run.accuracy",
            f"is {candidate.problem.scene.run.accuracy:g} rad, but taking the scene for a {self.name} costs some "
            f"{angle_text(candidate.cost)}: {affordable(candidate.cost)}",
        )


def affordable(cost: float) -> str:
    """Return the accuracy in rad, as advice, to which a model that costs so much may run.

    >>> affordable(0.00123), affordable(0.5)
    ('ask for 0.013 rad or more', 'ask for a shorter run')
    """
    return f"ask for {rounded_up(cost / SHARE)} rad or more" if cost < 0.1 * SHARE else "ask for a shorter run"


def angle_text(cost: float) -> str:
    """Return an angle in rad as a sentence may give it.

    >>> angle_text(0.0123), angle_text(40.0)
    ('0.01 rad', 'a whole turn')
    """
    return f"{cost:.1g} rad" if cost < np.pi else "a whole turn"


def across(direction: Float) -> tuple[Float, Float]:
    """Return two unit vectors that make a right-handed set with `direction` (3,)."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(helper, direction)
    first /= np.linalg.norm(first)
    return first, np.cross(direction, first)
