"""The models of a rigid body that nothing turns: spherical top, steady axis, symmetric and asymmetric top.

A spin that is off a principal axis by a small angle wobbles about it, or leaves it as exp(λ T) where the axis is the
intermediate one.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.stability import growth_rate
from inertia.dynamics.models.free.initial_conditions import NEGLIGIBLE
from inertia.dynamics.models.model import AXIS_PAIRS, NEARLY_EQUAL, Candidate, Model, Problem
from inertia.dynamics.models.neighbours import InputBound, growth, instants_of, nudge_of, parted
from inertia.dynamics.motion import Motion
from inertia.records import dataclass

_ORDINAL = ("smallest", "intermediate", "largest")
_NUDGE = 1e-9  # relative, of the spin of neighbours
_MOST = 700.0  # exp of more is no float64


@dataclass(frozen=True, eq=False)
class Idealisation:
    """A free body taken for a simpler one.

    Attributes
    ----------
    cost : rad; why : a sentence; near_miss : see `Candidate`
    order : of the principal axes; None for ascending moments
    """

    cost: float
    why: str
    near_miss: str = ""
    order: list[int] | None = None


class FreeBody(Model):
    """A rigid body on which no torque acts, or none that matters."""

    equal: ClassVar[Literal[1, 2, 3]]
    """How many of the moments count as equal."""

    @abstractmethod
    def idealised(self, problem: Problem) -> Idealisation:
        """Return what the model leaves out of a body that nothing turns."""

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return the cost of the idealisation and of leaving out a weight that hardly turns the body."""
        left_out = _left_out(problem)
        if not problem.rigid or problem.torques or left_out > math.pi:
            return None
        ideal = self.idealised(problem)
        order = ideal.order or [0, 1, 2]
        return Candidate(
            self,
            problem,
            problem.axes[:, order],
            problem.moments[order],
            ideal.cost + left_out,
            ideal.why,
            ideal.near_miss,
            unseen=left_out,
            order=tuple(order),
        )

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return the closed form, turned from the attitude at t = 0 on."""
        from inertia.dynamics.models.free.motion import solve_free

        omega = candidate.problem.angular_velocity[list(candidate.order)]
        quantities, remarks = self.characteristics(candidate.moments, omega)
        motion = solve_free(candidate.moments, omega, time, self.equal, candidate.rest)
        quantities = {**motion.quantities, **quantities}
        return replace(motion, quantities=quantities, remarks=remarks).turned(candidate.attitude)

    def input_bound(self, candidate: Candidate) -> InputBound:
        """Return how far the bounds of the tensor may move the attitude, from six neighbouring tensors."""
        problem = candidate.problem
        unknown = problem.relative_tensor_bound
        if not unknown:
            return InputBound.none(problem.duration)
        instants = instants_of(problem.duration)
        nudge = nudge_of(unknown, problem.scene.run.accuracy)
        return InputBound(
            instants, unknown * _tensors_parted(problem.moments, problem.angular_velocity, instants, nudge)
        )

    def characteristics(self, moments: Float, angular_velocity: Float) -> tuple[dict[str, Float], tuple[str, ...]]:
        """Return what the motion is known by, figures by name in SI units, and sentences on it."""
        return {}, ()


def _tensors_parted(moments: Float, angular_velocity: Float, time: Float, nudge: float) -> Float:
    """Return (n,) how far the attitude moves for a relative change of the tensor of one.

    Element ij changes by a part of √(Ii Ij), as it does in a needle too; ω along the part stays. What is flat has no
    neighbour whose largest moment is larger, but one whose is smaller.
    """
    from inertia.dynamics.models.free.motion import free_motion

    size = np.sqrt(np.outer(moments, moments))
    largest = int(moments.argmax())
    if moments[largest] * (2.0 + nudge) > moments.sum():
        size[largest, largest] *= -1.0
    change = np.zeros((6, 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))):
        change[k, i, j] = change[k, j, i] = size[i, j] * nudge * (1.0 if i == j else math.sqrt(0.5))
    values, axes = np.linalg.eigh(np.diag(moments) + change)
    axes[:, :, 2] *= np.linalg.det(axes)[:, None]
    moved, _ = free_motion(values, np.einsum("kji,j->ki", axes, angular_velocity), time)
    turn = quaternion.from_matrix(axes)[:, None]
    attitude, _ = free_motion(moments, angular_velocity, time)
    return parted(quaternion.multiply(quaternion.multiply(turn, moved), quaternion.conjugate(turn)), attitude, nudge)


def _left_out(problem: Problem) -> float:
    """Return the angle in rad by which the weight would turn the body: as without spin, and as neighbours part."""
    from inertia.dynamics.models.free.motion import free_motion

    pushed = problem.angle_by_weight
    if not 0 < pushed <= math.pi or not problem.angle_turned or problem.torques or not problem.rigid:
        return pushed
    instants = instants_of(problem.duration)

    def follow(attitude: Float, angular_velocity: Float) -> tuple[Float, Float]:
        turned, omega = free_motion(problem.moments, angular_velocity, instants)
        return quaternion.multiply(attitude, turned), omega

    grown = growth(follow, np.array(quaternion.IDENTITY), problem.angular_velocity, problem.pace, _NUDGE)[-1]
    return pushed * max(1.0, float(grown) / (problem.pace * problem.duration))


def _grown_wobble(problem: Problem) -> float:
    """Return the angle in rad to which a deviation from the spin about the intermediate axis grows: off exp(λ T)."""
    x, y, z = problem.angular_velocity.tolist()
    off = math.hypot(x, z)
    if not off:
        return 0.0
    ratio = float(problem.moments[2] / problem.moments[0])
    grown = float(growth_rate(problem.moments, math.hypot(x, y, z))) * problem.duration
    return math.exp(min(math.log(off) - math.log(abs(y)) + math.log(ratio) + grown, _MOST))


class SphericalTop(FreeBody):
    """A body with three equal moments."""

    name = "spherical top"
    equal = 3

    def idealised(self, problem: Problem) -> Idealisation:
        """Take all moments as equal."""
        least, _, most = problem.moments.tolist()
        delta = (most - least) / least
        return Idealisation(
            delta * problem.angle_turned,
            "The three principal moments are equal: the angular velocity is constant, about any axis.",
            f"The three moments differ by {delta:.2g} only" if 0 < delta < NEARLY_EQUAL else "",
        )


class SteadyAxis(FreeBody):
    """A body that spins about a principal axis."""

    name = "steady axis"
    equal = 3

    def idealised(self, problem: Problem) -> Idealisation:
        """Take the spin as along one principal axis, or across a symmetry axis."""
        moments, omega, turned = problem.moments, problem.angular_velocity, problem.angle_turned
        size = float(np.linalg.norm(omega))
        share = np.abs(omega) / size if size else np.array([0.0, 0.0, 1.0])
        ratio = float(moments[2] / moments[0])
        axis = int(np.argmax(share))
        off = math.hypot(*np.delete(share, axis))
        wobble = _grown_wobble(problem) if axis == 1 else off * ratio * (1.0 + off * turned)
        across = [
            (moments[j] - moments[i]) / moments[0] * turned + share[3 - i - j] * ratio * (1.0 + turned)
            for i, j in ((0, 1), (1, 2))
        ]
        steadily = "it stays there, and no equation is solved."
        if wobble > min(across):
            what = "across the axis of symmetry, where every axis is a principal one"
            return Idealisation(float(min(across)), f"The spin is {what}: {steadily}")
        return Idealisation(
            wobble,
            f"The spin is along the principal axis of the {_ORDINAL[axis]} moment: {steadily}",
            f"The spin is within {off:.2g} rad of the principal axis of the {_ORDINAL[axis]} moment"
            if 0 < off < NEARLY_EQUAL
            else "",
        )


class SymmetricTop(FreeBody):
    """A body with two equal moments; the third axis is that of symmetry."""

    name = "symmetric top"
    equal = 2

    def idealised(self, problem: Problem) -> Idealisation:
        """Take the two nearest moments as equal."""
        moments = problem.moments
        i, j = min(((0, 1), (1, 2)), key=lambda pair: moments[pair[1]] - moments[pair[0]])
        delta = float((moments[j] - moments[i]) / moments[0])
        return Idealisation(
            delta * problem.angle_turned,
            f"Principal moments {i + 1} and {j + 1} are equal: the motion is a steady precession, a closed form in "
            "sines.",
            f"Principal moments {i + 1} and {j + 1} differ by {delta:.2g} only" if 0 < delta < NEARLY_EQUAL else "",
            [*AXIS_PAIRS[3 - i - j], 3 - i - j],
        )

    def characteristics(self, moments: Float, angular_velocity: Float) -> tuple[dict[str, Float], tuple[str, ...]]:
        """Return the precession rates and the cones; the symmetry axis is the last of moments (3,) kg m².

        >>> figures, _ = SymmetricTop().characteristics(np.array([1.0, 1, 2]), np.array([0.01, 0, 1]))
        >>> figures["precession of the body"].round(3).item(), figures["precession in the body"].round(3).item()
        (2.0, 1.0)
        """
        from inertia.dynamics.kinematics.geometry import cones

        across = 0.5 * (moments[0] + moments[1])  # which the model takes as equal, however far apart they are
        rolling = cones([across, across, moments[2]], angular_velocity)
        return {
            "precession of the body": rolling.precession,
            "precession in the body": rolling.body_precession,
            "body cone": rolling.body_half_angle,
            "space cone": rolling.space_half_angle,
        }, ()


class AsymmetricTop(FreeBody):
    """A body with three different moments."""

    name = "asymmetric top"
    equal = 1

    def idealised(self, problem: Problem) -> Idealisation:
        """Take the body as it is, but for a wobble about the intermediate axis that is below any float."""
        size = np.abs(problem.angular_velocity)
        negligible = size[1] > 0 and max(size[0], size[2]) < NEGLIGIBLE * size[1]
        return Idealisation(
            _grown_wobble(problem) if negligible else 0.0,
            "The three principal moments differ: the closed form in Jacobi's elliptic functions gives every sample "
            "directly, attitude included, without steps.",
        )

    def characteristics(self, moments: Float, angular_velocity: Float) -> tuple[dict[str, Float], tuple[str, ...]]:
        """Return the distance from the separatrix, the period of the polhode and that of the flips."""
        from inertia.dynamics.kinematics.stability import separatrix_distance
        from inertia.dynamics.models.free.flips import flip_period, polhode_period, tumbles

        distance = separatrix_distance(moments, angular_velocity)
        figures = {"separatrix distance": distance, "polhode period": polhode_period(moments, angular_velocity)}
        if not distance:
            onward = "it goes to the axis of the intermediate moment and does not come back."
            return figures, (f"The spin is on the separatrix: {onward}",) if angular_velocity[[0, 2]].any() else ()
        side = "smallest" if distance > 0 else "largest"
        if not tumbles(moments, angular_velocity):
            return figures, (f"The spin goes round the axis of the {side} moment.",)
        figures["flip period"] = flip_period(moments, angular_velocity)
        return figures, (
            f"The body tumbles: between flips it spins about the axis of the intermediate moment, and its spin goes "
            f"round the axis of the {side} one.",
        )
