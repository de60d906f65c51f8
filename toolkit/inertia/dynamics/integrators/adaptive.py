"""SciPy's adaptive methods, on (q, ω) in units of the problem's own time.

DOP853 for torques that are no polynomial, LSODA and Radau for stiff ones. Hairer, Nørsett & Wanner, *Solving ODEs I*,
§ II.5; Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136; Hairer & Wanner, *Solving ODEs II*, § IV.8.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.base import Adaptive, States, begin, pieces
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError

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

    def run(self, problem: RotationProblem, time: Float, control: float, level: int = 0) -> States:
        """Return the states at `time`."""
        from scipy.integrate import solve_ivp

        tolerance = self.tolerance(control, level)
        rate = problem.rate
        unit = np.array([1.0] * 4 + [rate] * 3)

        def rhs(tau: float, state: Float) -> Float:
            return problem.rhs(min(start + tau / rate, end), state * unit) / (unit * rate)

        state = begin(problem, level) / unit
        out = np.empty((len(time), 7))
        out[time <= problem.start] = state
        steps = 0
        for piece in pieces(problem, time):
            start, end = piece.start, np.nextafter(piece.end, piece.start)
            targets = (np.append(time[piece.first : piece.last], piece.end) - start) * rate
            at, back = np.unique(targets, return_inverse=True)
            found = solve_ivp(rhs, (0.0, targets[-1]), state, self.name, t_eval=at, rtol=tolerance, atol=tolerance)
            if not found.success:
                raise GeometryError(
                    f"{self.name} stopped between {start:.6g} and {end:.6g} s ({found.message}): "
                    "check the loads or use another method"
                )
            values = found.y.T[back]
            steps += found.nfev
            out[piece.first : piece.last] = values[:-1]
            state = values[-1]
            state[:4] /= np.linalg.norm(state[:4])
        return States(quaternion.normalise(out[:, :4]), out[:, 4:] * rate, steps)
