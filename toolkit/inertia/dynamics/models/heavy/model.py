"""The model of a heavy symmetric top: a body on a fixed point, symmetric about the line to its centre of mass."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import NEARLY_EQUAL, Candidate, Model, Problem
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError

if TYPE_CHECKING:
    from inertia.dynamics.models.heavy.top import HeavyTop

_NUTATION = {
    "sleeping": "the top sleeps: its axis stays vertical",
    "steady precession": "its axis keeps its tilt: a steady precession",
    "pendulum": "it has no angular momentum along the vertical or its axis: it swings as a pendulum",
    "cusp": "its axis stops at the top of every nod: the path has cusps",
    "loops": "its axis moves backwards at the top of every nod: the path has loops",
    "no reversal": "its axis moves on all the time: the path is a wave without cusps or loops",
}
_UP = (0.0, 0.0, 1.0)
_HALF_TURN = (1.0, 0.0, 0.0, 0.0)


class HeavySymmetricTop(Model):
    """A symmetric body that its weight turns about a fixed point on its axis."""

    name = "heavy symmetric top"

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return what taking the body as symmetric about the line to its centre of mass costs, where it has an arm."""
        height = float(np.linalg.norm(problem.arm))
        if not problem.rigid or problem.torques or problem.weight * height == 0:
            return None
        swing = math.sqrt(problem.weight * height / problem.moments[0])
        rate = max(float(np.linalg.norm(problem.angular_velocity)), swing)
        axes, moments, defect = problem.symmetric_about(problem.arm / height)
        cost = defect * rate * problem.duration
        why = (
            "The body is symmetric about the line from the fixed point to its centre of mass: energy and two momenta "
            "are kept, and the closed form in elliptic functions gives every sample directly."
        )
        near_miss = f"The moments about the line to the centre of mass are symmetric to within {defect:.2g}"
        return Candidate(
            self, problem, axes, moments, cost, why, near_miss if defect < NEARLY_EQUAL else "", unseen=cost
        )

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return the closed form, turned so that gravity points along −z."""
        from inertia.dynamics.models.heavy.top import HeavyTop, solve_heavy_top

        problem, omega = candidate.problem, candidate.angular_velocity
        level = _to_vertical(problem.scene.gravity)
        moments = float(candidate.moments[0]), float(candidate.moments[2])
        mgh = problem.weight * float(np.linalg.norm(problem.arm))
        upright = quaternion.multiply(level, candidate.attitude)
        quantities, remarks = characteristics(HeavyTop.of_state(moments, mgh, upright, omega))
        motion = solve_heavy_top(moments, mgh, upright, omega, time)
        motion = replace(motion, quantities={**motion.quantities, **quantities}, remarks=remarks)
        return motion.turned(quaternion.conjugate(level))


def characteristics(top: HeavyTop) -> tuple[dict[str, Float], tuple[str, ...]]:
    """Return the kind of nutation, the steady precessions at the least tilt, and whether the top could sleep.

    >>> from inertia.dynamics.models.heavy.top import HeavyTop
    >>> top = HeavyTop.of_state((1.0, 0.5), 2.0, [0.3, 0, 0, 0.9], [0, 0, 8.0])
    >>> characteristics(top)[1][0]
    'Seen from the fixed point, its axis stops at the top of every nod: the path has cusps.'
    """
    remarks = [f"Seen from the fixed point, {_NUTATION[top.kind]}."]
    figures = {}
    tilt = top.turning_angles[0]
    if 0 < tilt < math.pi:
        try:
            figures["steady precession, slow and fast"] = np.array(top.steady_precession(tilt))
        except GeometryError:
            remarks.append("It spins too slowly for a steady precession at its least tilt.")
    if top.mgh > 0:
        limit = top.least_p_psi(0.0) / top.I3
        sleeps = "would sleep stably" if top.sleeps_stably else "would not stay"
        remarks.append(f"Upright it {sleeps}: that takes a spin of {limit:.6g} rad/s about its axis.")
    return figures, tuple(remarks)


def _to_vertical(gravity: Float) -> Float:
    """Return the quaternion (4,) of a turn that brings `gravity` (3,) to −z."""
    up = -gravity / np.linalg.norm(gravity)
    if up[2] < 0:  # half a turn first, for the shortest turn from straight down is any
        return quaternion.multiply(_to_vertical(quaternion.to_space(_HALF_TURN, gravity)), _HALF_TURN)
    return quaternion.normalise(np.append(np.cross(up, _UP), 1.0 + up[2]))
