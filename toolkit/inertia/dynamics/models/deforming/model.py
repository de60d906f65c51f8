"""The model of a free body whose joints move as prescribed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import Candidate, Model, Problem
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError, placed

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

    def view(self, problem: Problem) -> str:
        """Show the parts as they move."""
        return "deforming"

    def angular_momentum(self, candidate: Candidate, motion: Motion) -> Float:
        """Return that of all parts, which is kept."""
        return motion.invariants["angular momentum"]

    def energy(self, candidate: Candidate, motion: Motion) -> Float:
        """Return that of all parts, about the centre of mass."""
        return motion.quantities["kinetic energy"]


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
