"""The classical Runge–Kutta method of order four, on the attitude quaternion and ω.

Kutta, Z. Math. Phys. 46 (1901) 435. The quaternion is brought back to unit length after every step.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.error_control import FixedStep
from inertia.dynamics.integrators.loop import Call, Piece
from inertia.native import Kernel, address

_KERNEL = Kernel("inertia.dynamics.integrators.stepping_kernel", "runge_kutta_4", "ppipidddipp")

STEP_COST = 100
"""A step of the Python path in units of `native.Kernel.worthwhile`."""


class RungeKutta4(FixedStep):
    """RK4; any load."""

    name = "RK4"
    order = 4

    def compiled(self, piece: Piece, control: float, level: int) -> Call | None:
        """Return the kernel where all loads are polynomial and the steps many."""
        counts = self.counts(piece, control, level)
        many = _KERNEL.worthwhile(int(counts.sum()) * STEP_COST)
        if not many or piece.problem.terms(piece.start) is None:
            return None
        return Call(_KERNEL, piece.units.figures, (address(counts),), (counts,))

    def step(self, piece: Piece) -> Callable[[float, float, Float], Float]:
        """Return y + h/6 (k₁ + 2 (k₂ + k₃) + k₄)."""
        rhs = piece.rhs()

        def advance(time: float, step: float, state: Float) -> Float:
            a = rhs(time, state)
            b = rhs(time + 0.5 * step, state + 0.5 * step * a)
            c = rhs(time + 0.5 * step, state + 0.5 * step * b)
            d = rhs(time + step, state + step * c)
            state = state + step / 6.0 * (a + 2.0 * (b + c) + d)
            state[:4] /= np.linalg.norm(state[:4])
            return state

        return advance
