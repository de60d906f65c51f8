"""The model of a free body whose joints move as prescribed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import JointedPart
from inertia.dynamics.models.model import Candidate, Model, Problem
from inertia.dynamics.models.neighbours import InputBound, instants_of, left_open
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError, placed

_FIGURES = 10  # of a part: mass, centre of mass and tensor
_MARGIN = 3.0  # of what some changes by the bounds do

_NO_MOMENTUM = 1e-13
"""Relative to what the motion of the parts, or the whole, has at its largest."""


class DeformingBody(Model):
    """A free body that changes its shape."""

    name = "deforming body"

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return the model of every body whose joints move; it leaves nothing out."""
        if problem.rolls or not problem.scene.body.deforms:
            return None
        why = (
            "The shape changes in a prescribed way: the angular momentum stays fixed in space, the tensor and the "
            "momentum of the parts within follow from the joints, and the attitude alone is integrated."
        )
        return Candidate(self, problem, problem.axes, problem.moments, 0.0, why)

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Follow the root part; its axes are the part axes of the scene."""
        from inertia.dynamics.models.deforming.motion import solve_deforming

        scene = candidate.problem.scene
        assert scene.body.assembly is not None  # it deforms
        try:
            motion = solve_deforming(
                scene.body.assembly,
                time,
                scene.run.accuracy,
                angular_velocity=scene.angular_velocity,
                attitude=scene.start.attitude,
            )
        except GeometryError as error:
            raise placed(error, scene.name) from None
        moments: Float = np.asarray(np.linalg.eigvalsh(motion.quantities["inertia"]), dtype=np.float64)
        turn = quaternion.from_matrix(candidate.axes)
        return replace(
            motion,
            attitude=quaternion.multiply(motion.attitude, turn),
            angular_velocity=motion.angular_velocity @ candidate.axes,
            position=None,  # of the root; the centre of mass goes its own way
            quantities={**motion.quantities, "principal moments": moments},
            remarks=_remarks(motion),
        )

    def input_bound(self, candidate: Candidate) -> InputBound:
        """Return how far the bounds of the parts' mass properties may move the attitude, as changes by them do."""
        from inertia.dynamics.models.deforming.motion import solve_deforming

        problem, scene = candidate.problem, candidate.problem.scene
        assembly = scene.body.assembly
        assert assembly is not None  # it deforms
        moved = [k for k, part in enumerate(assembly.parts) if any(part.bounds)]
        relative = [_relative(part) for part in assembly.parts]
        unknown = max(largest for _, largest in relative)
        if not unknown:
            return InputBound.none(problem.duration)
        instants = instants_of(problem.duration)

        def follow(change: Float, tolerance: float) -> Float:
            parts = list(assembly.parts)
            for row, k in zip(change.reshape(-1, _FIGURES), moved, strict=True):
                parts[k] = _changed(parts[k], row * np.repeat(relative[k][0] / unknown, (1, 3, 6)))
            there = JointedBody(tuple(parts))
            attitude, spin = scene.start.attitude, scene.angular_velocity
            return solve_deforming(there, instants, tolerance, angular_velocity=spin, attitude=attitude).attitude

        angle = left_open(follow, _FIGURES * len(moved), _MARGIN * unknown)
        return InputBound(instants, np.maximum(angle, _MARGIN * unknown * problem.pace * instants))

    def view(self, problem: Problem) -> str:
        """Show the parts as they move."""
        return "deforming"

    def angular_momentum(self, candidate: Candidate, motion: Motion) -> Float:
        """Return that of all parts, which is kept."""
        return motion.invariants["angular momentum"]

    def energy(self, candidate: Candidate, motion: Motion) -> Float:
        """Return that of all parts, about the centre of mass."""
        return motion.quantities["kinetic energy"]


def _relative(part: JointedPart) -> tuple[Float, float]:
    """Return the bounds (3,) of mass, centre of mass and tensor over mass, radius and size, and the largest of them."""
    size = float(np.linalg.norm(part.inertia))
    sizes = np.array([part.mass, np.sqrt(size / part.mass), size])
    bounds = np.divide(part.bounds, sizes, out=np.zeros(3), where=sizes > 0)
    return bounds, float(bounds.max())


def _changed(part: JointedPart, change: Float) -> JointedPart:
    """Return a part with other figures, by changes (10,) relative to those of `_relative`."""
    size = float(np.linalg.norm(part.inertia))
    tensor = np.zeros((3, 3))
    tensor[np.triu_indices(3)] = change[4:]
    return part.altered(
        part.inertia + size * (tensor + np.triu(tensor, 1).T),
        part.center_of_mass + np.sqrt(size / part.mass) * change[1:4],
        part.mass * (1.0 + change[0]),
    )


def _remarks(motion: Motion) -> tuple[str, ...]:
    """Say that nothing but the parts turns the body, and what the joints do."""
    momentum = float(np.linalg.norm(motion.invariants["angular momentum"][0]))
    remarks = []
    if momentum <= _NO_MOMENTUM * motion.scales["angular momentum"]:
        remarks.append("The angular momentum is zero: what turns the body is the motion of its parts alone.")
    work = motion.quantities["work of the joints"]
    rounding = _NO_MOMENTUM * float(motion.quantities["kinetic energy"].max())
    if np.abs(work).max() > rounding:
        least, most, last = (0.0 if abs(x) <= rounding else x for x in (work.min(), work.max(), work[-1]))
        remarks.append(f"The joints do work, between {least:.6g} and {most:.6g} J, and {last:.6g} J by the end.")
    return tuple(remarks)
