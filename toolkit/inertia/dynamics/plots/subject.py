"""What plots need to know of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.plan import Plan
from inertia.dynamics.scene.body import nearest

COARSE = 0.7
"""Radians between samples, from which on no line is drawn between them."""
_DIAGONAL = 1e-9
"""Of the largest moment, up to which a product of inertia is taken for zero."""


class Subject(Protocol):
    """A run, as `inertia.dynamics.run.Run` describes it."""

    @property
    def plan(self) -> Plan:
        """The model that ran, in which axes."""

    @property
    def time(self) -> Float:
        """(n,) s."""

    @property
    def attitude(self) -> Float:
        """(n, 4) part axes to space."""

    @property
    def angular_velocity(self) -> Float:
        """(n, 3) rad/s, part axes."""

    @property
    def angular_momentum(self) -> Float:
        """(n, 3) kg m²/s, space axes."""

    @property
    def quantities(self) -> Mapping[str, Float]:
        """Further outputs of the model."""


def is_coarse(time: Float, angular_velocity: Float) -> bool:
    """Say whether a body that turns at most as fast as at some instants, ω (k, 3) rad/s, turns too far between others,
    (n,) s, for a line through what they have."""
    if len(time) < 2:
        return True
    return float(np.linalg.norm(angular_velocity, axis=1).max()) * float(np.diff(time).max()) > COARSE


def numbered(plan: Plan) -> tuple[Float, Float]:
    """Return the moments (3,) kg m² about the point that the body turns about, and the axes (3, 3) as columns.

    They are numbered as those that ``frame = "principal"`` means, and are these where the model's tensor is diagonal
    along them; about another point than the centre of mass they are the nearest to them. The model has its own order,
    as the symmetry axis last.
    """
    axes = plan.problem.scene.body.axes
    turn = axes.T @ plan.axes
    along = turn * plan.moments @ turn.T
    if np.abs(along - np.diag(np.diagonal(along))).max() <= _DIAGONAL * plan.moments.max():
        moments = np.empty(3)
        moments[np.argsort(np.diagonal(along), kind="stable")] = np.sort(plan.moments)
        return moments, axes
    axes, order = nearest(plan.axes, axes)
    return plan.moments[list(order)], axes
