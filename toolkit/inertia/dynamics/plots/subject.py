"""What plots need to know of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.plan import Plan


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


def ascending(plan: Plan) -> tuple[Float, Float]:
    """Return the moments (3,) kg m² about the point that the body turns about, and the axes (3, 3) as columns.

    The model has its own order, as the symmetry axis last; the axes stay right-handed.
    """
    order = np.argsort(plan.moments, kind="stable")
    axes = plan.axes[:, order]
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1.0
    return plan.moments[order], axes
