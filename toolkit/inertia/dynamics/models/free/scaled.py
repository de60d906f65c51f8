"""The model of a body whose torque acts along its angular momentum throughout: a free motion in a time of its own.

Euler's equations I ω̇ = I ω × ω + N are of second degree in ω. With N = (ġ/g) I ω they are therefore solved by

    ω(t) = g(t) ω₀(τ(t)),    q(t) = q₀(τ(t)),    τ̇ = g,

where ω₀, q₀ is the free motion from the same start: L keeps its direction in space, and |L| changes as g. That is so of
a spin about a principal axis (about any axis of a body with three equal moments), with torques along it and viscous
damping, and of any body with a torque that is constant in space along L, from rest for instance. With the moment J of
the axis, c of the damping and N of the torque, g follows from the linear equation J s ġ = N − c s g (s = 1 rad/s from
rest, else |ω₀|), which `inertia.dynamics.models.hinged.angle.linear` solves.

No other driven or damped body has so simple a solution. A torque along the axis of a symmetric body that spins about
another leaves its attitude to parabolic cylinder functions, damping to confluent hypergeometric ones (both are
q̇ = ½ q ω with ω known): those are slower and less certain than Taylor series, by which such a body is stepped.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.stability import growth_rate
from inertia.dynamics.loads.losses import Damping
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.hinged.angle import linear
from inertia.dynamics.models.hinged.axle import Axle
from inertia.dynamics.models.model import Candidate, Model, Problem
from inertia.dynamics.motion import Motion

_EPS = 2.0**-52
_ROUNDING = 4.0 * _EPS
_NEARLY = 1e-9  # rad, of directions that may be one
_MOST = 700.0  # exp of more is no float64


class ScaledFreeMotion(Model):
    """A rigid body, free or held at its centre of mass, whose torque acts along its angular momentum."""

    name = "scaled free motion"

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return what leaving out the torque across the momentum costs; None where that is no small part."""
        if not problem.rigid or problem.weight or not problem.torques:
            return None
        damping, body, space = _loads(problem)
        if damping is None:
            return None
        moments, torque = problem.moments, body + space
        along, least = _direction(problem, torque), float(moments[0])
        off = _across(torque, along) if problem.angular_velocity.any() else 0.0
        axis = int(np.abs(along).argmax())
        wobble = _across(along, np.eye(3)[axis]) * float(moments[2]) / least
        unequal = float(moments[2] - moments[0]) / least
        tilt = min(wobble, unequal)  # of the angular velocity against the momentum
        pull = float(np.linalg.norm(torque))
        turned = _turned(_axle(problem, along, damping, torque), problem.duration)
        off += _across(body, along) * min(turned, 1.0)  # what the body carries away from what is fixed in space
        in_space = not (damping or body.any() or any(load.dissipation for load in problem.torques))
        if not turned < 1.0 / _EPS or off > _NEARLY * pull or (tilt > _NEARLY and not in_space):
            return None
        if in_space and off <= _ROUNDING * pull:
            cost = 0.0
        else:
            grown = float(growth_rate(moments)) * turned if axis == 1 or tilt > _NEARLY else 0.0
            pushed = 0.5 * off / least * problem.duration * problem.duration
            cost = (pushed + (0.0 if in_space else tilt)) * (1.0 + turned) * math.exp(min(grown, _MOST))
        if tilt > _NEARLY:
            how = "The torque is constant in space and along the angular momentum: the body turns as a free one does, "
            why = how + "in a time that runs as |L|."
        else:
            how = "three moments are equal" if unequal <= wobble else "spin is about a principal axis"
            why = f"The {how}, and what drives or brakes it acts along it: one linear equation gives its speed."
        return Candidate(self, problem, problem.axes, moments, cost, why, unseen=cost)

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return the free motion at the times τ, with its angular velocity times g."""
        from inertia.dynamics.models.free.motion import free_motion, input_rounding, rounding, unstable

        problem, moments, omega = candidate.problem, candidate.moments, candidate.angular_velocity
        damping, body, space = _loads(problem)
        assert damping is not None
        along = _direction(problem, body + space)
        axle = _axle(problem, along, damping, body + space)
        angle, rate, off = linear(axle, time)
        first = axle.spin or 1.0
        start = omega if omega.any() else along * axle.inertia / moments
        clock, pace = angle / first, rate / first
        attitude, spin = free_motion(moments, start, clock)
        spins = float(np.linalg.norm(start))
        late = np.abs(clock).argsort()[-64:]
        warnings: tuple[str, ...] = ()
        reached = float(np.max(rounding(moments, start, clock)))
        if _across(start, along) > _NEARLY * spins:  # elsewhere the cost holds what becomes of rounding
            reached += 4.0 * float(np.max(input_rounding(moments, start, clock[late])))
        else:
            warnings = unstable(moments, start, float(np.abs(clock).max()), float(np.abs(pace).max()))
        reached += spins * (off / abs(first) + _EPS * float(np.abs(clock).max()))
        motion = Motion(
            attitude=attitude,
            angular_velocity=pace[:, None] * spin,
            method="closed form: free motion in scaled time",
            reached=reached,
            warnings=warnings,
        ).turned(candidate.attitude)
        momentum = self.angular_momentum(candidate, motion)
        direction = quaternion.to_space(candidate.attitude, along)
        sideways = momentum - (momentum @ direction)[:, None] * direction
        return replace(motion, invariants={"angular momentum across its direction": sideways})

    def view(self, problem: Problem) -> str:
        """Show what becomes of L and the energy."""
        return "driven"


def _loads(problem: Problem) -> tuple[float | None, Float, Float]:
    """Return the damping, and the torques (3,) along the principal axes that are fixed in the body and in space.

    The damping is None where another load acts, or a torque is not constant.
    """
    damping, body, space = 0.0, np.zeros(3), np.zeros(3)
    start = quaternion.multiply(problem.scene.start.attitude, quaternion.from_matrix(problem.axes))
    for load in problem.torques:
        if isinstance(load, Damping):
            damping += load.coefficient
        elif isinstance(load, Torque) and load.constant:
            turned = load.along(problem.axes, problem.scene.body.axes)
            if load.frame == "space":
                space += quaternion.to_body(start, np.asarray(turned.torque))
            else:
                body += np.asarray(turned.torque)
        elif not load.dissipation:
            return None, body, space
    return damping, body, space


def _direction(problem: Problem, torque: Float) -> Float:
    """Return the direction (3,) of the angular momentum along the principal axes, at once after the start."""
    momentum = problem.moments * problem.angular_velocity
    momentum = momentum if momentum.any() else torque
    direction: Float = momentum / np.linalg.norm(momentum)
    return direction


def _axle(problem: Problem, along: Float, damping: float, torque: Float) -> Axle:
    """Return what decides the scale of the motion, as that of a body on an axle; `along` (3,) is that of L."""
    speed = float(np.linalg.norm(problem.angular_velocity))
    momentum = float(np.linalg.norm(problem.moments * problem.angular_velocity))
    inertia = momentum / speed if speed else 1.0 / float(np.linalg.norm(along / problem.moments))
    return Axle(inertia, speed, torque=float(torque @ along), damping=damping)


def _turned(axle: Axle, duration: float) -> float:
    """Return a bound in rad on the angle that the body turns through."""
    return abs(axle.spin) * duration + 0.5 * abs(axle.torque) / axle.inertia * duration * duration


def _across(vector: Float, unit: Float) -> float:
    """Return how long the part of a vector (3,) across a unit vector is."""
    return float(np.linalg.norm(vector - (vector @ unit) * unit))
