"""The model of a heavy symmetric top: a body on a fixed point, symmetric about the line to its centre of mass."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import NEARLY_EQUAL, Candidate, Model, Problem, across
from inertia.dynamics.models.neighbours import InputBound, growth, instants_of, nudge_of, value_at
from inertia.dynamics.models.rational import (
    Quaternion,
    product,
    rationals,
    root,
    rotated,
    rounded,
    shortest_turn,
)
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError

if TYPE_CHECKING:
    from inertia.dynamics.models.heavy.top import HeavyTop

_State = tuple[tuple[Fraction, Fraction], Fraction, Quaternion, tuple[Fraction, ...]]

_NUTATION = {
    "sleeping": "the top sleeps: its axis stays vertical",
    "steady precession": "its axis keeps its tilt: a steady precession",
    "pendulum": "it has no angular momentum along the vertical or its axis: it swings as a pendulum",
    "over the top": "it has no angular momentum along the vertical or its axis: a pendulum that goes over the top",
    "cusp": "its axis stops at the top of every nod: the path has cusps",
    "loops": "its axis moves backwards at the top of every nod: the path has loops",
    "no reversal": "its axis moves on all the time: the path is a wave without cusps or loops",
}
_WHY = (
    "The body is symmetric about the line from the fixed point to its centre of mass: energy and two momenta are kept, "
    "and the closed form in elliptic functions gives every sample directly."
)
_WHY_PENDULUM = (
    "All mass lies on the line from the fixed point to its centre: it is a spherical pendulum, with the closed form of "
    "a top that has no moment about that line; about it, where nothing acts, the body goes on as it starts."
)
_UP = (Fraction(0), Fraction(0), Fraction(1))
_HALF_TURN = tuple(map(Fraction, (1, 0, 0, 0)))
_BEYOND = 1e300  # of what grows without bound
_MARGIN = 3.0  # of what the growth of a change of the start says about a lack of symmetry


class HeavySymmetricTop(Model):
    """A symmetric body that its weight turns about a fixed point on its axis."""

    name = "heavy symmetric top"

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return what taking the body as symmetric about the line to its centre of mass costs, where it has an arm.

        What breaks the symmetry disturbs the motion as a change of the start does, and grows as neighbours part.
        """
        height = float(np.linalg.norm(problem.arm))
        pendulum = problem.scene.is_pendulum
        if not (problem.rigid or pendulum) or problem.torques or problem.weight * height == 0:
            return None
        direction = problem.arm / height
        axes = problem.axes @ np.column_stack([*across(direction), direction])
        moments, defect = _symmetric(problem)
        candidate = Candidate(
            self,
            problem,
            axes,
            np.array([float(moments[0]), float(moments[0]), float(moments[1])]),
            0.0,
            _WHY_PENDULUM if pendulum else _WHY,
        )
        rate, noise = problem.pace, problem.relative_bound
        if not defect and not noise:
            return candidate
        near_miss = f"The moments about the line to the centre of mass are symmetric to within {defect:.2g}"
        candidate = replace(candidate, near_miss=near_miss if defect < NEARLY_EQUAL else "")
        instants, accuracy = instants_of(problem.duration), problem.scene.run.accuracy
        if not noise and (least := _MARGIN * defect * rate * problem.duration) > accuracy:
            return replace(candidate, cost=least, unseen=least)  # however neighbours part
        moments, mgh, attitude, omega = _state(candidate, axes)

        def follow(start: Float, spin: Float) -> tuple[Float, Float]:
            from inertia.dynamics.models.heavy import motion
            from inertia.dynamics.models.heavy.initial_conditions import of_state

            pace = float(moments[1] / moments[0]) * float(spin[2])
            return motion.follow(of_state(moments, mgh, start.tolist(), spin.tolist()), pace, start, spin, instants)

        nudge, start, spin = nudge_of(defect + noise, accuracy), rounded(attitude)[0], rounded(omega)[0]
        grown = growth(follow, start, spin, rate, nudge)
        # What disturbs it while it leans over tells more, the nearer to the vertical it passes afterwards.
        attitudes, spins = follow(start, spin)
        lowest = int(np.argmax((attitudes[:, :2] ** 2).sum(axis=1)))
        later = growth(follow, attitudes[lowest], spins[lowest], rate, nudge)
        grown = np.maximum(
            grown, np.interp(instants - instants[lowest], instants, np.minimum(later, _BEYOND), left=0.0)
        )
        grown = _MARGIN * np.maximum(grown, rate * instants)
        inputs = InputBound(instants, noise * grown) if noise else InputBound.none(problem.duration)
        cost = defect * value_at(instants, grown, inputs.until(accuracy)) if defect else 0.0
        return replace(candidate, cost=cost, unseen=cost, inputs=inputs)

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return the closed form, turned so that gravity points along −z."""
        from inertia.dynamics.models.heavy.top import HeavyTop, solve_heavy_top

        exact = _state(candidate, candidate.axes)
        moments, mgh = (float(exact[0][0]), float(exact[0][1])), float(exact[1])
        upright, omega = quaternion.normalise(rounded(exact[2])[0]), rounded(exact[3])[0]
        quantities, remarks = characteristics(HeavyTop.of_state(moments, mgh, upright, omega, exact))
        motion = solve_heavy_top(moments, mgh, upright, omega, time, exact)
        motion = replace(motion, quantities={**motion.quantities, **quantities}, remarks=remarks)
        level = quaternion.normalise(rounded(_to_vertical(candidate.problem.scene.gravity))[0])
        return motion.turned(quaternion.conjugate(level))


def characteristics(top: HeavyTop) -> tuple[dict[str, Float], tuple[str, ...]]:
    """Return the kind of nutation, the steady precessions at the least tilt, and whether the top could sleep.

    >>> from inertia.dynamics.models.heavy.top import HeavyTop
    >>> top = HeavyTop.of_state((1.0, 0.5), 2.0, [0.3, 0, 0, 0.9], [0, 0, 8.0])
    >>> characteristics(top)[1][0]
    'Seen from the fixed point, its axis stops at the top of every nod: the path has cusps.'
    """
    kind = "over the top" if top.kind == "pendulum" and top.energy > abs(top.mgh) else top.kind
    remarks = [f"Seen from the fixed point, {_NUTATION[kind]}."]
    figures = {}
    tilt = top.turning_angles[0]
    if 0 < tilt < math.pi:
        try:
            figures["steady precession, slow and fast"] = np.array(top.steady_precession(tilt))
        except GeometryError:
            remarks.append("It spins too slowly for a steady precession at its least tilt.")
    if top.mgh > 0:
        sleeps = "would sleep stably" if top.sleeps_stably else "would not stay"
        limit = f": that takes a spin of {top.least_p_psi(0.0) / top.I3:.6g} rad/s about its axis" if top.I3 else ""
        remarks.append(f"Upright it {sleeps}{limit}.")
    return figures, tuple(remarks)


def _symmetric(problem: Problem) -> tuple[tuple[Fraction, Fraction], float]:
    """Return the moments (I1, I3) of the symmetric body that is nearest, and how far from it the tensor is.

    The latter is what the tensor lacks of I1 + (I3 − I1) r rᵀ, r being the direction of the arm, relative to the
    smallest moment that does not vanish; zero where the body is symmetric to the last digit.
    """
    arm, tensor = problem.exact.arm, problem.exact.tensor
    square = sum((k * k for k in arm), Fraction(0))
    along = sum((tensor[i][j] * arm[i] * arm[j] for i in range(3) for j in range(3)), Fraction(0)) / square
    along = Fraction(0) if problem.scene.is_pendulum else max(along, Fraction(0))
    beside = (tensor[0][0] + tensor[1][1] + tensor[2][2] - along) / 2
    lacking = Fraction(0)
    for i in range(3):
        for j in range(3):
            symmetric = (beside if i == j else 0) + (along - beside) * arm[i] * arm[j] / square
            lacking += (tensor[i][j] - symmetric) ** 2
    return (beside, along), float(root(lacking) / Fraction(problem.least))


def _state(candidate: Candidate, axes: Float) -> _State:
    """Return moments (I1, I3), mgh, attitude and ω at t = 0 as rationals, the vertical as z and the arm as axis 3."""
    exact, gravity = candidate.problem.exact, rationals(candidate.problem.scene.gravity)
    height = root(sum((k * k for k in exact.arm), Fraction(0)))
    near = rationals(quaternion.from_matrix(axes))
    turn = product(shortest_turn(rotated(near, _UP), [k / height for k in exact.arm]), near)
    attitude = product(_to_vertical(candidate.problem.scene.gravity), product(exact.attitude, turn))
    x, y, z, w = turn
    weight = exact.mass * root(sum((k * k for k in gravity), Fraction(0)))
    return _symmetric(candidate.problem)[0], weight * height, attitude, tuple(rotated((-x, -y, -z, w), exact.spin))


def _to_vertical(gravity: Float) -> Quaternion:
    """Return the quaternion of a turn that brings `gravity` (3,) to −z."""
    pull = rationals(gravity)
    size = root(sum((k * k for k in pull), Fraction(0)))
    up = [-k / size for k in pull]
    if up[2] < 0:  # half a turn first, for the shortest turn from straight down is any
        return product(shortest_turn(rotated(_HALF_TURN, up), _UP), _HALF_TURN)
    return shortest_turn(up, _UP)
