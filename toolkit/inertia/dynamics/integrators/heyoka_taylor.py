"""heyoka's compiled Taylor method (the extra `heyoka`): a second, independent Taylor integrator.

Biscani & Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614.
"""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.integrators.error_control import Adaptive, walk
from inertia.dynamics.integrators.loop import Piece, States, Stepper, pieces
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.terms import HEAD, VECTOR
from inertia.dynamics.kinematics import quaternion
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
        solver = _compiled(units.vectors, tolerance)
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
def _compiled(vectors: int, tolerance: float) -> Any:
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


_FINE = ("1e-33", "1e-28")
"""Tolerances of the two runs in quadruple precision."""

_MOST_STEPS = 20_000


class Quadruple(NamedTuple):
    """Attitudes (n, 4) as sums of two float64 each, and in rad how far they may be off."""

    high: Float
    low: Float
    error: float

    def apart(self, attitude: Float) -> Float:
        """Return the angles (n,) in rad to attitudes (n, 4), to many digits however small they are.

        >>> identity = np.array([[0.0, 0.0, 0.0, 1.0]])
        >>> Quadruple(identity, np.array([[1e-20, 0.0, 0.0, 0.0]]), 0.0).apart(identity).tolist()
        [2e-20]
        """
        sign = np.where((attitude * self.high).sum(axis=1) < 0, -1.0, 1.0)[:, None]
        off = (sign * attitude - self.high) - self.low
        off = off - (off * self.high).sum(axis=1)[:, None] * self.high  # what is along it is no turn
        near = 2.0 * np.linalg.norm(off, axis=1)
        return np.where(near < 1e-4, near, quaternion.angle_between(attitude, self.high))


def quadruple(problem: RotationProblem, time: Float, turn: Float) -> Quadruple | None:
    """Follow a body under polynomial loads in quadruple precision, 113 bits, at the instants (n,) s.

    The figures of the problem and of its `terms.Terms` are taken as the float64 numbers that they are. The error is how
    far two runs with other tolerances, and so with other orders and steps, are apart.

    Parameters
    ----------
    problem : what is followed
    time : (n,) s, ascending from its start
    turn : (4,) by which the attitudes are multiplied from the right

    Returns
    -------
    None where heyoka is not there or has no such numbers, where a load is no polynomial, or after too many steps.
    """
    try:
        import heyoka

        number = heyoka.real128
    except (ImportError, AttributeError):
        return None
    if problem.terms(problem.start) is None:
        return None
    one, other = (_followed(problem, time, turn, heyoka, number, tolerance) for tolerance in _FINE)
    if one is None or other is None:
        return None
    apart = [max(abs(float(x)) for x in row) for row in one - other]
    high = np.array(one, dtype=np.float64)
    low = np.array(one - np.vectorize(number, otypes=[object])(high), dtype=np.float64)
    return Quadruple(high, low, 4.0 * max(apart) + 1e-30)


def _followed(problem: RotationProblem, time: Float, turn: Float, heyoka: Any, number: Any, tolerance: str) -> Any:
    """Return the attitudes (n, 4) of one run, as objects; None after too many steps."""
    quad = np.vectorize(number, otypes=[object])
    state = np.array([*problem.attitude, *problem.angular_velocity / problem.rate])
    now = quad(state)
    now[:4] = now[:4] / sum(x * x for x in now[:4]) ** number("0.5")
    rows = np.tile(now[:4], (len(time), 1))
    for piece in pieces(problem, time):
        units = piece.units
        pars = quad(np.concatenate([units.moments, units.packed]))
        solver = _quadruple(units.vectors, tolerance)
        solver.time, solver.state[:], solver.pars[:] = number(0), np.array(list(now)), np.array(list(pars))
        samples = time[piece.first : piece.last]
        instants, at = np.unique([piece.start, *samples, piece.end], return_inverse=True)
        grid = np.array([(number(t) - number(piece.start)) * number(piece.problem.rate) for t in instants.tolist()])
        result = solver.propagate_grid(grid, max_steps=_MOST_STEPS)
        if result[0] != heyoka.taylor_outcome.time_limit:
            return None
        rows[piece.first : piece.last] = result[5][at[1:-1], :4]
        now = np.array(solver.state, dtype=object)
    x, y, z, w = (quad(np.array([each]))[0] for each in turn.tolist())
    a, b, c, d = rows.T
    turned = np.stack(
        [
            d * x + a * w + b * z - c * y,
            d * y + b * w + c * x - a * z,
            d * z + c * w + a * y - b * x,
            d * w - a * x - b * y - c * z,
        ],
        axis=1,
    )
    return turned / (turned * turned).sum(axis=1)[:, None] ** number("0.5")


@functools.lru_cache(maxsize=4)
def _quadruple(vectors: int, tolerance: str) -> Any:
    """Return an integrator in quadruple precision, as `_compiled`."""
    import heyoka

    number = heyoka.real128
    equations = _equations(heyoka, vectors)
    start = np.array([number(x) for x in (0, 0, 0, 1, 0, 0, 0)])
    pars = np.array([number(0)] * (3 + HEAD + VECTOR * vectors))
    return heyoka.taylor_adaptive(equations, start, pars=pars, fp_type=number, tol=number(tolerance), compact_mode=True)


def _cross(a: list[Any], b: list[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
