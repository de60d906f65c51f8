"""The model of a body of revolution that rolls without slipping on its rim."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.models.model import AXIS_PAIRS, NEARLY_EQUAL, Candidate, Model, Problem, affordable, angle_text
from inertia.dynamics.models.neighbours import InputBound, instants_of
from inertia.dynamics.motion import Motion

_MARGIN = 3.0  # of what the growth of a change of the start says about other mass properties


class Rolling(Model):
    """A body of revolution on its rim."""

    name = "rolling body"
    default_method = "nutation"

    @property
    def methods(self) -> Mapping[str, int]:
        """Integration over one nutation, which then repeats, or over the whole time."""
        from inertia.dynamics.models.rolling.motion import METHODS

        return METHODS

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return what taking the body as one of revolution costs, about the axis named or that of the nearest moments.

        Raises `FieldError` where no axis is named and any would do.
        """
        if not problem.rolls:
            return None
        moments, axis = problem.moments, problem.scene.constraint.axis
        if axis is not None:
            axis = problem.axes.T @ axis
        else:
            unequal = [abs(float(moments[i] - moments[j])) for i, j in AXIS_PAIRS]
            if max(unequal) < NEARLY_EQUAL * moments[0]:
                raise FieldError(
                    "constraint.axis", "is missing: the moments are all equal, so say which axis the rim is on"
                )
            axis = np.eye(3)[int(np.argmin(unequal))]
        axes, moments, defect = problem.symmetric_about(axis)
        why = "A body of revolution on its rim: the nonholonomic equations are integrated, contact forces included."
        cost = defect * problem.pace * problem.duration
        return Candidate(self, problem, axes, moments, cost, why, unseen=cost)

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return what integrating the nonholonomic equations gives."""
        from inertia.dynamics.models.rolling.motion import solve_rolling

        scene = candidate.problem.scene
        return solve_rolling(
            *_figures(candidate),
            candidate.attitude,
            candidate.angular_velocity,
            time,
            scene.run.accuracy,
            method,
            candidate.problem.symmetric_about(candidate.problem.axes.T @ candidate.axes[:, 2])[2],
        )

    def input_bound(self, candidate: Candidate) -> InputBound:
        """Return how far the bounds of the mass properties may move the attitude: as a change of the start does."""
        from inertia.dynamics.models.rolling.equations import RollingBody
        from inertia.dynamics.models.rolling.motion import left_open, state_of

        problem = candidate.problem
        unknown = _MARGIN * problem.relative_contact_bound
        if not unknown:
            return InputBound.none(problem.duration)
        mass, (transverse, axial), *rest = _figures(candidate)
        body, instants = RollingBody(mass, transverse, axial, *rest), instants_of(problem.duration)
        start = state_of(body, candidate.attitude, candidate.angular_velocity)
        moved = left_open(body, start, instants, True, unknown)
        return InputBound(instants, np.maximum(moved, unknown * problem.pace * instants))

    def view(self, problem: Problem) -> str:
        """Show the path and the forces of contact."""
        return "disc"

    def too_costly(self, candidate: Candidate) -> FieldError:
        """Return how far the body is from one of revolution."""
        _, _, defect = candidate.problem.symmetric_about(candidate.problem.axes.T @ candidate.axes[:, 2])
        return FieldError(
            "constraint.kind",
            f'is "rolling", which takes a body of revolution about the axis of its rim, and this one is off by '
            f"{defect:.2g} of its smallest moment, {angle_text(candidate.cost)} in the time of the run: "
            + (affordable(candidate.cost) if defect < NEARLY_EQUAL else _remedy(candidate.problem)),
        )


def _remedy(problem: Problem) -> str:
    """Return the axis that a body is one of revolution about, as advice, or that it has none."""
    defects = [problem.symmetric_about(axis)[2] for axis in np.eye(3)]
    best = int(np.argmin(defects))
    if defects[best] >= NEARLY_EQUAL:
        return "give it two equal moments"
    return f"name that axis as constraint.axis, [{', '.join(f'{x + 0.0:.6g}' for x in problem.axes[:, best])}]"


def _figures(candidate: Candidate) -> tuple[float, tuple[float, float], float, float, float]:
    """Return mass, moments, radius, offset and gravity."""
    scene = candidate.problem.scene
    mass, radius = scene.body.mass, scene.constraint.radius
    assert mass is not None and radius is not None  # noqa: PT018  # the scene saw to it
    moments = float(candidate.moments[0]), float(candidate.moments[2])
    return mass, moments, radius, scene.constraint.offset or 0.0, float(np.linalg.norm(scene.gravity))
