"""heyoka's compiled Taylor method (the extra `heyoka`): a second, independent Taylor integrator.

Biscani & Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.base import Adaptive, Scaled, States, begin, pieces
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import HEAD, VECTOR
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError, UsageError


class Heyoka(Adaptive):
    """heyoka's `taylor_adaptive`; polynomial loads. It compiles once for each form of the loads and each tolerance."""

    name = "heyoka"
    order = 20
    tightest = 1e-16
    coarsest = 3e-15

    def run(self, problem: RotationProblem, time: Float, control: float, level: int = 0) -> States:
        """Return the states at `time`; the tolerance is rounded, so that fewer steppers are compiled."""
        tolerance = float(10.0 ** np.round(np.log10(self.tolerance(control, level)), 1))
        state = begin(problem, level)
        state[4:] /= problem.rate
        out = np.empty((len(time), 7))
        out[time <= problem.start] = state
        steps = 0
        for piece in pieces(problem, time):
            scaled = Scaled.of(problem, piece, time)
            stepper = _stepper(scaled.vectors, tolerance)
            stepper.pars[:] = np.concatenate([scaled.moments, scaled.packed])
            stepper.time = 0.0
            stepper.state[:] = state
            at, back = np.unique(np.append(0.0, scaled.targets), return_inverse=True)
            outcome, _, _, taken, _, grid = stepper.propagate_grid(at)
            if "time_limit" not in str(outcome):
                raise GeometryError(f"heyoka stopped with {outcome}: check the loads or shorten the run")
            values = grid[back[1:]]
            steps += taken
            out[piece.first : piece.last] = values[:-1]
            state = values[-1]
        return States(quaternion.normalise(out[:, :4]), out[:, 4:] * problem.rate, steps)


@functools.lru_cache(maxsize=16)
def _stepper(vectors: int, tolerance: float) -> Any:
    """Return an integrator whose parameters are the moments and the packed terms."""
    try:
        import heyoka
    except ImportError:
        raise UsageError("heyoka is not installed: pip install 'inertia[heyoka]', or use the method Taylor") from None
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
    system = list(zip([*q, *w], rates, strict=True))
    return heyoka.taylor_adaptive(system, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], tol=tolerance, compact_mode=vectors > 2)


def _cross(a: list[Any], b: list[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
