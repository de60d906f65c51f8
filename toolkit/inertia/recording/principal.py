"""The principal axes as every view and plot numbers them: 1, 2, 3 by ascending moments."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.plan import Plan


def ascending(plan: Plan) -> tuple[Float, Float]:
    """Return the moments (3,) kg m² about the point that the body turns about, and the axes (3, 3) as columns.

    The model has its own order, as the symmetry axis last; the axes stay right-handed.
    """
    order = np.argsort(plan.moments, kind="stable")
    axes = plan.axes[:, order]
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1.0
    return plan.moments[order], axes
