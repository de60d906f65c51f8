"""Bodies that change their shape as prescribed: the cat that turns over, the diver that twists, the skater.

Resolved along the axes of the root part. With I(t) the tensor of all parts about their centre of mass and h(t) the
angular momentum of their motion within, both from the joints alone (`JointedBody.shape`), the angular momentum L about
the centre of mass is fixed in space where nothing but uniform gravity acts (textbook § 13.26), and
ω = I⁻¹ (qᵀ L q − h). The attitude alone is integrated; L is exact by construction, whatever the steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float, Int
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.collocation import NODES, Trajectory, collocate
from inertia.dynamics.models.deforming.jointed_body import JointedBody, Shape
from inertia.dynamics.motion import Motion
from inertia.dynamics.observer import observing
from inertia.errors import GeometryError, UsageError
from inertia.mass.tensor import array_of
from inertia.records import dataclass

_EPSILON = 2.0**-52
_PHASE = 2.0  # rad, at most, by which anything turns in one of the first, longest steps
_MOST_STEPS = 100_000  # at first
_PROBES = 33  # instants between two keyframes at which the speed of the motion is looked at
_ASTRAY = 1e-2  # rad, of steps that are too long for their difference to say anything
_NUDGE = 2.0**-26  # rad, by which a neighbouring motion starts off
_NUDGED = quaternion.from_rotation_vector(np.full(3, _NUDGE / math.sqrt(3.0)))
_SINGULAR = 1e-13
_BLOCK = 4096  # samples that are worked on at once: what is made of them on the way takes far more than the answer


def solve_deforming(
    assembly: JointedBody,
    time: ArrayLike,
    accuracy: float,
    *,
    angular_velocity: ArrayLike | None = None,
    angular_momentum: ArrayLike | None = None,
    attitude: ArrayLike = quaternion.IDENTITY,
    position: ArrayLike = (0.0, 0.0, 0.0),
    velocity: ArrayLike = (0.0, 0.0, 0.0),
    gravity: ArrayLike = (0.0, 0.0, 0.0),
) -> Motion:
    """Follow an assembly on which no torque acts, from t = 0, along its root axes.

    Steps end at keyframes and are halved until the attitude at all samples agrees with that of steps twice as long
    to `accuracy`, as far as float64 goes.

    Parameters
    ----------
    assembly : `JointedBody`
    time : (n,) s, ascending, from 0 on
    accuracy : rad, of the attitude at every sample
    angular_velocity : (3,) rad/s of the root at t = 0, root axes; or
    angular_momentum : (3,) kg m²/s about the centre of mass, in space
    attitude : (4,) root axes to space at t = 0
    position : (3,) m, the origin of the root axes in space at t = 0
    velocity : (3,) m/s of the centre of mass at t = 0, in space
    gravity : (3,) m/s², uniform, in space: the centre of mass moves on a parabola

    Returns
    -------
    Motion of the root, `position` being that of the origin of its axes. Its quantities, per sample:

    - "inertia" (3, 3), "internal angular momentum" (3,), "center of mass" (3,): see `Shape`, root axes
    - "joint values" (j,): rad or m, in the order of the parts and of their joints
    - "part poses" (parts, 7): x, y, z in m and the quaternion, assembly axes to root axes
    - "kinetic energy": ½ ω·I ω + ω·h and the internal energy, J, about the centre of mass
    - "work of the joints": the kinetic energy less that at t = 0, J

    Raises `UsageError` where an argument is not usable, `GeometryError` where all parts come to lie on one line.

    A man on a stool without friction turns a wheel above his head, and so himself the other way:

    >>> from inertia.dynamics.models.deforming.joints import Joint, JointedPart
    >>> man = JointedPart("man", 80.0, np.diag([9.0, 9.0, 3.0]))
    >>> spun = Joint(axis=[0, 0, 1], times=[0.0, 1.0], angles=[0.0, 2 * np.pi])
    >>> wheel = JointedPart("wheel", 1.0, np.diag([0.5, 0.5, 1.0]), parent="man", joints=[spun])
    >>> motion = solve_deforming(JointedBody([man, wheel]), [0.0, 1.0], 1e-12, angular_velocity=[0, 0, 0])
    >>> motion.attitude[-1].round(12).tolist()  # a quarter of a turn back
    [0.0, 0.0, -0.707106781187, 0.707106781187]
    """
    instants = array_of(time, (np.size(time),), "time")
    if not instants.size or instants[0] < 0 or (np.diff(instants) < 0).any():
        raise UsageError("the times of a deforming body must ascend from 0 or later")
    if not 0 < accuracy < np.inf:
        raise UsageError(f"the accuracy is {accuracy} rad: it must be positive and finite")
    start = array_of(attitude, (4,), "attitude")
    if not start.any():
        raise UsageError("attitude is the zero quaternion: give one of unit length")
    start = quaternion.normalise(start)
    first = assembly.shape(np.zeros(1))
    momentum = _momentum(first, start, angular_velocity, angular_momentum)
    trajectory, reached = _refined(_Flow(assembly, momentum), start, instants, accuracy)

    origin = array_of(position, (3,), "position"), array_of(velocity, (3,), "velocity")
    pull = array_of(gravity, (3,), "gravity")

    def samples(t: Float) -> list[Float]:
        """Return all that goes with the time, at instants (k,)."""
        shape, q = assembly.shape(t), trajectory.at(t)
        omega = _spin(shape, quaternion.to_body(q, momentum))
        carried = _times(shape.inertia, omega) + shape.internal_angular_momentum
        offset = quaternion.to_space(start, first.center_of_mass) - quaternion.to_space(q, shape.center_of_mass)
        flight, fall = np.multiply.outer(t, origin[1]), np.multiply.outer(0.5 * t**2, pull)
        return [
            q,
            omega,
            origin[0] + offset + flight + fall,
            quaternion.to_space(q, carried),
            _energy(shape, omega),
            shape.inertia,
            shape.internal_angular_momentum,
            shape.center_of_mass,
            shape.joint_values,
            np.concatenate([shape.part_position, shape.part_attitude], axis=-1),
        ]

    q, omega, place, carried, energy, tensor, internal, center, joint_values, poses = _by_blocks(samples, instants)
    at_start = _energy(first, _spin(first, quaternion.to_body(start, momentum)))
    inside = assembly.shape(trajectory.edges).internal_angular_momentum  # which may vanish at all samples
    return Motion(
        attitude=q,
        angular_velocity=omega,
        method=f"Gauss collocation on {NODES} nodes (order {NODES + 1}, at keyframes {2 * NODES}), L fixed in space",
        reached=reached,
        position=place,
        invariants={"angular momentum": carried} | ({} if assembly.keyframes.size else {"energy": energy}),
        scales={"angular momentum": float(max(np.linalg.norm(momentum), np.linalg.norm(inside, axis=1).max()))},
        quantities={
            "inertia": tensor,
            "internal angular momentum": internal,
            "center of mass": center,
            "joint values": joint_values,
            "part poses": poses,
            "kinetic energy": energy,
            "work of the joints": energy - at_start,
        },
        steps=len(trajectory.edges) - 1,
    )


def _by_blocks(function: Callable[[Float], list[Float]], time: Float) -> list[Float]:
    """Return the arrays that a function of instants (k,) gives, for all of them (n,)."""
    whole: list[Float] = []
    for first in range(0, len(time), _BLOCK):
        rows = slice(first, first + _BLOCK)
        part = function(time[rows])
        whole = whole or [np.empty((len(time), *each.shape[1:])) for each in part]
        for there, each in zip(whole, part, strict=True):
            there[rows] = each
    return whole


def _momentum(first: Shape, start: Float, angular_velocity: ArrayLike | None, momentum: ArrayLike | None) -> Float:
    """Return L (3,) in space from whichever of the two was given."""
    if momentum is not None and angular_velocity is None:
        return array_of(momentum, (3,), "angular_momentum")
    if angular_velocity is None or momentum is not None:
        raise UsageError("a deforming body starts with an angular_velocity or an angular_momentum: give one of the two")
    omega = array_of(angular_velocity, (3,), "angular_velocity")
    return quaternion.to_space(start, first.inertia[0] @ omega + first.internal_angular_momentum[0])


def _times(tensor: Float, vector: Float) -> Float:
    product: Float = (tensor @ vector[..., None])[..., 0]
    return product


def _moments(shape: Shape, time: Float) -> Float:
    """Return principal moments (n, 3), ascending, or refuse a shape that is a line."""
    moments = np.asarray(np.linalg.eigvalsh(shape.inertia), dtype=np.float64)
    line = moments[:, 0] <= _SINGULAR * moments[:, 2]
    if line.any():
        k = int(line.argmax())
        raise GeometryError(
            f"at t = {time[k]:.6g} s all parts lie on one line, with principal moments {moments[k].tolist()} kg m²: "
            "about it there is no rotation to follow, give a part a thickness"
        )
    return moments


def _inverse(shape: Shape) -> Float:
    inverse = np.asarray(np.linalg.inv(shape.inertia), dtype=np.float64)
    return 0.5 * (inverse + np.swapaxes(inverse, 1, 2))


def _spin(shape: Shape, momentum: Float) -> Float:
    """Return ω (n, 3) from the total angular momentum (n, 3) along root axes."""
    return _times(_inverse(shape), momentum - shape.internal_angular_momentum)


def _energy(shape: Shape, omega: Float) -> Float:
    """Return the kinetic energy (n,) about the centre of mass."""
    carried = 0.5 * _times(shape.inertia, omega) + shape.internal_angular_momentum
    energy: Float = np.sum(omega * carried, axis=-1) + shape.internal_energy
    return energy


@dataclass(frozen=True, eq=False)
class _Flow:
    """What the attitude follows, and how fast things go."""

    assembly: JointedBody
    momentum: Float

    def coefficients(self, time: Float, later: Float) -> tuple[Float, Float]:
        """Return I⁻¹ (n, 3, 3) and I⁻¹ h (n, 3) at times (n,) s, or later."""
        shape = self.assembly.shape(time, later)
        _moments(shape, time + later)
        inverse = _inverse(shape)
        return inverse, _times(inverse, shape.internal_angular_momentum)

    def hand_on(self, time: Float) -> Callable[[Trajectory], None] | None:
        """Return what hands on the samples (n,) s that lie within a trajectory; None where nobody observes the run."""
        observer = observing()
        if observer is None:
            return None

        def reached(piece: Trajectory) -> None:
            first, last = np.searchsorted(time, piece.edges[[0, -1]], side="right")
            for begin in range(first, last, _BLOCK):
                instants = time[begin : min(begin + _BLOCK, last)]
                q = piece.at(instants)
                observer(instants, q, _spin(self.assembly.shape(instants), quaternion.to_body(q, self.momentum)))

        return reached

    def paces(self, time: Float) -> tuple[float, float]:
        """Return the largest rates, rad/s, at which things turn and at which rounding grows, at times (n,) s.

        A change of attitude by δ changes the spin about the axis of the least moment by δ |L| / I₁, and that changes
        the attitude against L at |L| / I₃ at most: errors that steps make turn with |L| / √(I₁ I₃), rounding does
        with |L| / I₁.
        """
        shape = self.assembly.shape(time)
        moments = _moments(shape, time)
        momenta = np.linalg.norm(self.momentum) + np.linalg.norm(shape.internal_angular_momentum, axis=1)
        hinges = [k for k, joint in enumerate(self.assembly.joints) if joint.revolute]
        turning = np.abs(shape.joint_rates[:, hinges]).sum(axis=1)
        mean = np.sqrt(moments[:, 0]) * np.sqrt(moments[:, 2])
        return float((momenta / mean + turning).max()), float((momenta / moments[:, 0] + turning).max())


def _refined(flow: _Flow, start: Float, time: Float, accuracy: float) -> tuple[Trajectory, float]:
    """Halve the steps until it suffices or rounding is all that is left; return the trajectory and its error."""
    end = max(float(time[-1]), float(np.finfo(np.float64).tiny))  # a step without length has no inside
    keyframes = flow.assembly.keyframes
    stops = np.concatenate([[0.0], keyframes[(keyframes > 0) & (keyframes < end)], [end]])
    paces = np.array([flow.paces(np.linspace(a, b, _PROBES)) for a, b in pairwise(stops)])
    phases, growths = (np.diff(stops)[:, None] * paces).T
    if phases.sum() > _PHASE * _MOST_STEPS:
        raise GeometryError(
            f"in {end:.6g} s the parts turn through some {phases.sum():.3g} rad, and the limit is "
            f"{_PHASE * _MOST_STEPS:.3g} rad: end the run earlier"
        )
    counts = np.ceil(np.maximum(phases, 1.0) / _PHASE).astype(int)
    growth = 1.0 + float(growths.sum())
    edges, nudged = _divided(stops, counts), quaternion.normalise(quaternion.multiply(start, _NUDGED))
    trajectory, error = collocate(flow.momentum, flow.coefficients, start, edges, flow.hand_on(time)), np.inf
    # What steps are rounded by walks at random, and parts as neighbouring motions do.
    parted = _apart(collocate(flow.momentum, flow.coefficients, nudged, edges), trajectory, time) / _NUDGE
    rounding = 6.0 * _EPSILON * (growth + parted * math.sqrt(growth))
    while True:
        counts = 2 * counts
        coarse, before = trajectory, error
        trajectory = collocate(flow.momentum, flow.coefficients, start, _divided(stops, counts))
        apart = _apart(trajectory, coarse, time)
        error = apart + rounding
        if error <= accuracy or 0.25 * before <= error < _ASTRAY or counts.sum() > _MOST_STEPS:
            return trajectory, min(error, np.pi)


def _apart(trajectory: Trajectory, other: Trajectory, time: Float) -> float:
    """Return the largest angle in rad between two trajectories at the instants (n,)."""
    (angles,) = _by_blocks(lambda t: [quaternion.angle_between(trajectory.at(t), other.at(t))], time)
    return float(angles.max())


def _divided(stops: Float, counts: Int) -> Float:
    """Return the edges of `counts` equal steps from each stop to the next."""
    steps = [np.linspace(a, b, n, endpoint=False) for (a, b), n in zip(pairwise(stops), counts, strict=True)]
    return np.concatenate([*steps, stops[-1:]])
