"""SciPy's adaptive methods, on (q, ω) in units of the problem's own time.

DOP853 for torques that are no polynomial, LSODA and Radau for stiff ones. Hairer, Nørsett & Wanner, *Solving ODEs I*,
§ II.5; Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136; Hairer & Wanner, *Solving ODEs II*, § IV.8.
"""

from __future__ import annotations

from typing import Any

from inertia.arrays import Float
from inertia.dynamics.integrators.error_control import Adaptive
from inertia.dynamics.integrators.loop import Piece, Stepper

ORDERS = {"DOP853": 8, "LSODA": 12, "Radau": 5}
"""The highest order that each uses."""


class SciPy(Adaptive):
    """One of SciPy's methods; any load. It begins again at every kink of the loads.

    The steps that it states are evaluations of the right-hand side: SciPy does not count its steps.
    """

    tightest = coarsest = 2.3e-14

    def __init__(self, name: str) -> None:
        self.name = name
        self.order = ORDERS[name]

    def stepper(self, piece: Piece, state: Float, control: float, level: int) -> Stepper:
        """Return SciPy's solver."""
        import scipy.integrate

        tolerance = self.tolerance(control, level)
        solver = getattr(scipy.integrate, self.name)
        return _Solver(solver(piece.rhs(), 0.0, state, piece.targets[-1], rtol=tolerance, atol=tolerance), piece)


class _Solver(Stepper):
    """A `scipy.integrate.OdeSolver` under way."""

    def __init__(self, solver: Any, piece: Piece) -> None:
        self._solver, self._piece = solver, piece

    def step(self, target: float) -> str | None:
        """Take a step of the length that the solver chooses."""
        message = self._solver.step()
        self.time, self.steps = self._solver.t, self._solver.nfev
        if self._solver.status == "failed":
            return f"between {self._piece.start:.6g} and {self._piece.end:.6g} s ({message})"
        return None

    def values(self, times: Float) -> Float:
        """Return values of the solver's interpolant."""
        values: Float = self._solver.dense_output()(times).T
        self.steps = self._solver.nfev  # some of them evaluate once more for it
        return values
