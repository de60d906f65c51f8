"""heyoka's compiled Taylor method (the extra `heyoka`): a second, independent Taylor integrator.

Biscani & Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614.
"""

from __future__ import annotations

import copy
import functools
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.error_control import Adaptive, walk
from inertia.dynamics.integrators.loop import Piece, States, Stepper
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import HEAD, VECTOR
from inertia.errors import UsageError


class Heyoka(Adaptive):
    """heyoka's `taylor_adaptive`; polynomial loads. It compiles once for each form of the loads and each tolerance."""

    name = "heyoka"
    order = 20
    tightest = 1e-16
    coarsest = 3e-15

    def solve(self, problem: RotationProblem, time: Float, control: float) -> tuple[States, float]:
        """Return the run at `control` and its estimate, with what rounding costs."""
        fine, estimate = super().solve(problem, time, control)
        return fine, estimate + walk(problem, fine, float(time[-1] - problem.start))

    def stepper(self, piece: Piece, state: Float, control: float, level: int) -> Stepper:
        """Return heyoka's integrator; the tolerance is rounded, so that fewer of them are compiled."""
        tolerance = float(10.0 ** np.round(np.log10(self.tolerance(control, level)), 1))
        units = piece.units
        solver = copy.copy(compiled(units.vectors, tolerance))  # another thread may be in one of the same form
        solver.pars[:] = np.concatenate([units.moments, units.packed])
        solver.time = 0.0
        solver.state[:] = state
        return _Solver(solver, float(piece.targets[-1]))


class _Solver(Stepper):
    """heyoka's integrator under way to `end`."""

    def __init__(self, solver: Any, end: float) -> None:
        self._solver, self._end = solver, end

    def step(self, target: float) -> str | None:
        """Take a step of the length that heyoka chooses."""
        outcome, _ = self._solver.step(self._end - self._solver.time, True)
        self.steps += 1
        limited = "time_limit" in str(outcome)
        self.time = self._end if limited else self._solver.time
        return None if limited or "success" in str(outcome) else f"with {outcome}"

    def values(self, times: Float) -> Float:
        """Return values of the step's polynomial."""
        return np.array([self._solver.update_d_output(time).copy() for time in times.tolist()])


@functools.lru_cache(maxsize=16)
def compiled(vectors: int, tolerance: float) -> Any:
    """Return an integrator in float64 whose parameters are the moments and the packed terms."""
    try:
        import heyoka
    except ImportError:
        raise UsageError("heyoka is not installed: pip install 'inertia[heyoka]', or use the method Taylor") from None
    start = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    return heyoka.taylor_adaptive(_equations(heyoka, vectors), start, tol=tolerance, compact_mode=vectors > 2)


def _equations(heyoka: Any, vectors: int) -> list[tuple[Any, Any]]:
    """Return the equations of q and ω, with the moments and the packed terms as parameters."""
    q, w = list(heyoka.make_vars("x", "y", "z", "s")), list(heyoka.make_vars("p", "q", "r"))
    moments, terms = ([heyoka.par[k] for k in span] for span in (range(3), range(3, 3 + HEAD + VECTOR * vectors)))
    momentum = [i * o for i, o in zip(moments, w, strict=True)]
    free = [(moments[j] - moments[k]) * w[j] * w[k] for j, k in ((1, 2), (2, 0), (0, 1))]
    slip = [terms[9] * e / (i * i) for e, i in zip(free, moments, strict=True)]
    turn = [o + u for o, u in zip(w, slip, strict=True)]
    torque = [terms[k] + heyoka.time * terms[3 + k] - terms[6 + k] * w[k] for k in range(3)]
    for j in range(vectors):
        row = terms[HEAD + VECTOR * j : HEAD + VECTOR * (j + 1)]
        u = [-x for x in q[:3]]
        side = [c + q[3] * v for c, v in zip(_cross(u, row[:3]), row[:3], strict=True)]
        v = [a + 2.0 * b for a, b in zip(row[:3], _cross(u, side), strict=True)]
        square = _cross(v, [b * c for b, c in zip(row[12:15], v, strict=True)])
        weight = row[15] + row[16] * heyoka.time
        for k in range(3):
            pull = row[3 + 3 * k] * v[0] + row[4 + 3 * k] * v[1] + row[5 + 3 * k] * v[2] + square[k]
            torque[k] = torque[k] + weight * pull
    swung = [e + u for e, u in zip(free, _cross(momentum, slip), strict=True)]
    x, y, z, s = q
    a, b, c = turn
    rates = [
        0.5 * (s * a + y * c - z * b),
        0.5 * (s * b + z * a - x * c),
        0.5 * (s * c + x * b - y * a),
        -0.5 * (x * a + y * b + z * c),
        *((e + n) / i for e, n, i in zip(swung, torque, moments, strict=True)),
    ]
    return list(zip([*q, *w], rates, strict=True))


def _cross(a: list[Any], b: list[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
