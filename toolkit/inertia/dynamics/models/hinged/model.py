"""The model of a body on a fixed axle: one angle, and the forces and torques that the axle holds it with."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_equations import inverse_dynamics
from inertia.dynamics.loads.losses import Damping
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.hinged.angle import axle_of, solve_angle
from inertia.dynamics.models.hinged.axle import Axle
from inertia.dynamics.models.hinged.period import recurrence
from inertia.dynamics.models.model import Candidate, Model, Problem
from inertia.dynamics.models.rational import cross, dot, principal_rows, rationals, root, rotated
from inertia.dynamics.motion import Motion

_EPS = 2.0**-52
_ALONG = 1e-6  # of the spin, that may point off the axle


class HingedBody(Model):
    """A body that turns about an axle which is fixed in it and in space."""

    name = "hinged body"

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return the model of every body on an axle; a spin that is off the axle by rounding is along it."""
        if not problem.hinged:
            return None
        axis = problem.axes.T @ problem.axle
        spin = float(problem.angular_velocity @ axis)
        off = float(np.linalg.norm(problem.angular_velocity - spin * axis))
        if off > _ALONG * abs(spin):
            raise FieldError(
                "start.angular_velocity",
                f"points {np.degrees(np.arctan2(off, abs(spin))):.3g}° off constraint.axis: a body on an axle turns "
                "about it only, give a spin along it",
            )
        steady = problem.scene.constraint.drive == "constant_speed"
        why = "The body is held on an axle: one angle describes it, and the axle's force and torque follow from that."
        if steady:
            why = "The axle is driven at a constant speed: no equation is solved, and what it takes follows."
        return Candidate(self, problem, problem.axes, problem.moments, 0.0, why)

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return the motion from the angle, with the reactions in space."""
        problem, held = candidate.problem, candidate.problem.scene.constraint
        axis, start, mass = candidate.axes.T @ problem.axle, candidate.attitude, candidate.mass
        loads = [load.along(candidate.axes, problem.scene.body.axes) for load in problem.torques]
        torques = [load for load in loads if isinstance(load, Torque)]
        figures = figures_of(problem)
        axle = axle_of(figures)
        damping = axle.damping
        steady = held.drive == "constant_speed"
        if steady:
            zeros = dict.fromkeys(figures, Fraction(0))
            figures = {**zeros, "inertia": Fraction(1), "spin": figures["spin"]}
        swing = solve_angle(figures, time, {} if steady else _known(axle, problem))
        angle, rate = swing.angle, swing.rate
        turned = quaternion.from_rotation_vector(swing.turn[:, None] * quaternion.to_space(start, axis))
        attitude = quaternion.multiply(turned, start)
        omega, alpha = rate[:, None] * axis, axle_of(figures).acceleration(angle, rate)[:, None] * axis
        weight = quaternion.to_body(attitude, mass * problem.scene.gravity)
        force = mass * (np.cross(alpha, candidate.arm) + np.cross(omega, np.cross(omega, candidate.arm))) - weight
        applied = np.cross(candidate.arm, weight) + sum(_turned(load, attitude) for load in torques) - damping * omega
        torque = inverse_dynamics(candidate.moments, omega, alpha) - applied
        drive = torque @ axis
        torque = torque - drive[:, None] * axis
        quantities = {
            "angle": angle,
            "reaction force": quaternion.to_space(attitude, force),
            "reaction torque": quaternion.to_space(attitude, torque),
        }
        spring = angle - held.rest_angle
        if steady:
            quantities["drive torque"] = drive + held.stiffness * spring
        if held.bearings is not None:
            for name, one in zip("AB", _shared(force, torque, axis, held.bearings), strict=True):
                quantities[f"force on bearing {name}"] = -quaternion.to_space(attitude, one)
        if held.stiffness:
            quantities["energy of the spring"] = 0.5 * held.stiffness * spring**2
        motion = Motion(attitude, omega, swing.method, swing.off + 8.0 * _EPS, quantities=quantities)
        if steady or damping or torques:
            return motion
        if (back := recurrence(figures)) is not None:
            motion = replace(motion, quantities=quantities | back.quantities, remarks=(back.remark,))
        energy = self.energy(candidate, motion)
        turning = 0.5 * axle.inertia * float((rate**2).max()) + held.stiffness * float((spring**2).max())
        # The weight has a potential of the whole arm, which along the axle turns nothing, yet rounds.
        potential = problem.weight * float(np.linalg.norm(candidate.arm))
        return replace(motion, invariants={"energy": energy}, scales={"energy": turning + potential})

    def energy(self, candidate: Candidate, motion: Motion) -> Float:
        """Return the energy (n,) of the rotation, the weight and the spring, J."""
        energy: Float = super().energy(candidate, motion) + motion.quantities.get("energy of the spring", 0.0)
        return energy

    def view(self, problem: Problem) -> str:
        """Show what becomes of L and the energy."""
        return "driven"


def figures_of(problem: Problem) -> dict[str, Fraction]:
    """Return what decides the angle: a·(r(θ) × m g) = A cos θ + B sin θ, as r turns about a, and so on."""
    held, exact, body = problem.scene.constraint, problem.exact, problem.scene.body
    direction = rationals(held.typed_axis)
    length = root(dot(direction, direction))
    axis = [k / length for k in direction]
    x, y, z, w = exact.attitude
    to_body = (-x, -y, -z, w)
    pull = rotated(to_body, [exact.mass * k for k in rationals(problem.scene.gravity)])
    across = cross(axis, exact.arm)
    torque = Fraction(held.stiffness) * Fraction(held.rest_angle)
    damping = Fraction(0)
    for load in problem.torques:
        if isinstance(load, Damping):
            damping += Fraction(load.coefficient)
        elif isinstance(load, Torque):
            applied = rationals(np.asarray(load.torque))
            if load.frame == "space":
                applied = rotated(to_body, applied)
            elif load.frame == "principal":
                applied = [dot(row, applied) for row in principal_rows(body)]
            torque += dot(applied, axis)
    return {
        "inertia": dot(axis, [dot(row, axis) for row in exact.tensor]),
        "spin": dot(exact.spin, axis),
        "torque": torque,
        "damping": damping,
        "stiffness": Fraction(held.stiffness),
        "cosine": dot(across, pull),
        "sine": dot(cross(axis, across), pull),
    }


def _known(axle: Axle, problem: Problem) -> dict[str, float]:
    """Return how far figures of an axle may be off by the bounds of the mass properties."""
    gravity = problem.weight * float(np.linalg.norm(problem.arm)) * problem.relative_weight_bound if axle.pull else 0.0
    stated = problem.scene.body.properties is None
    inertia = problem.exact.tensor_bound
    if not stated:
        inertia = min(inertia, problem.uncertainty * axle.inertia)
    return {"inertia": inertia, "cosine": gravity, "sine": gravity}


def _turned(load: Torque, attitude: Float) -> Float:
    """Return a constant torque along the body's axes, (3,) or (n, 3)."""
    torque = np.asarray(load.torque)
    return quaternion.to_body(attitude, torque) if load.frame == "space" else torque


def _shared(force: Float, torque: Float, axis: Float, bearings: Float) -> tuple[Float, Float]:
    """Return the forces (n, 3) of the bearings A and B at places along the axle; A takes what is along it.

    With F⊥ = A + B and a × (z_A A + z_B B) = N, it is z_A A + z_B B = N × a.
    """
    along = (force @ axis)[:, None] * axis
    lever = np.cross(torque, axis)
    second = (lever - bearings[0] * (force - along)) / (bearings[1] - bearings[0])
    return force - second, second
