"""Mixed-integer programs in which complex numbers have to stay in discs, by `scipy.optimize.milp`.

A disc is the intersection of its tangents' half-planes. Few of them are stated at first; where a solution leaves a
disc, the tangent at that place is added and the program solved again (Kelley's cutting planes). No integer solution
is lost, and what comes back is in the discs, so it is the best of all.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.balancing.corrections.quiet_stdout import quiet_stdout
from inertia.errors import GeometryError
from inertia.records import dataclass

Complex = NDArray[np.complex128]

_DIRECTIONS = 8
_ROUNDS = 200
_OPTIMAL, _INFEASIBLE = 0, 2  # of scipy's milp
_ROOT = 130  # nodes of the tree that its root takes as long as
_INSIDE = 2e-6  # what HiGHS takes for satisfied, doubled; numbers are of the order of 1


class UnsettledError(Exception):
    """A program's search did not end within its nodes."""


class Effort:
    """What searches may spend together, in nodes times variables, so that it is the same on every machine."""

    def __init__(self, most: int) -> None:
        self._left = most

    def nodes(self, variables: int) -> int:
        """Return how many nodes below the root are left to a search; raise `UnsettledError` where none is."""
        nodes = self._left // variables - _ROOT
        if nodes < 1:
            raise UnsettledError
        return nodes

    def spend(self, variables: int, nodes: int) -> None:
        """Take off what a search took."""
        self._left -= variables * (_ROOT + nodes)


@dataclass(frozen=True, eq=False)
class Program:
    """Minimise cost·x with |start + effects x| ≤ radii + reach x, rows between their bounds, 0 ≤ x ≤ upper.

    Attributes
    ----------
    effects : (t, n) complex
    start : (t,) complex
    radii : (t,)
    reach : (t, n)
    upper : (n,); `lower` (n,) is 0 where it is not given
    integral : (n,), 1 for whole numbers
    rows : triples of coefficients (n,), least and greatest
    nodes : of the tree of choices that are looked at between two tangents; all without it
    effort : what all rounds have together with those of other programs; without it, nothing ends them but `nodes`
    """

    effects: Complex
    start: Complex
    radii: Float
    reach: Float
    upper: Float
    integral: Float
    rows: Sequence[tuple[Float, float, float]] = ()
    lower: Float | None = None
    nodes: int | None = None
    effort: Effort | None = None

    def least(self, cost: ArrayLike) -> Float | None:
        """Return the x (n,) of least cost, None where no x is allowed.

        Raises `UnsettledError` where `nodes` or `effort` are not enough, `GeometryError` where the search does not end.
        """
        from scipy.optimize import Bounds, LinearConstraint, milp

        count = len(self.upper)
        bounds = Bounds(np.zeros(count) if self.lower is None else self.lower, self.upper)
        matrix = [row for row, _, _ in self.rows]
        low, high = [least for _, least, _ in self.rows], [most for _, _, most in self.rows]
        turns = np.exp(-2j * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS)
        cuts = [(disc, turn) for disc in range(len(self.start)) for turn in turns.tolist()]
        for _ in range(_ROUNDS):
            for disc, turn in cuts:
                matrix.append((turn * self.effects[disc]).real - self.reach[disc])
                low.append(-np.inf)
                high.append(float(self.radii[disc] - (turn * self.start[disc]).real))
            options: dict[str, float] = {"mip_rel_gap": 0.0}
            if (nodes := self._nodes(count)) is not None:
                options["node_limit"] = nodes
            with quiet_stdout():
                solution = milp(
                    cost,
                    integrality=self.integral,
                    bounds=bounds,
                    constraints=LinearConstraint(np.array(matrix), low, high),
                    options=options,
                )
            if self.effort is not None:
                self.effort.spend(count, int(solution.mip_node_count or 0))
            if nodes is not None and solution.status not in (_OPTIMAL, _INFEASIBLE):
                raise UnsettledError
            if solution.x is None:
                return None
            x: Float = np.where(self.integral > 0, np.round(solution.x), solution.x)
            vectors = self.start + self.effects @ x
            outside = np.flatnonzero(np.abs(vectors) > self.radii + self.reach @ x + _INSIDE)
            if len(outside) == 0:
                return x
            cuts = [(int(disc), complex(np.exp(-1j * np.angle(vectors[disc])))) for disc in outside]
        raise GeometryError(f"the choice of weights did not settle in {_ROUNDS} rounds: allow fewer positions")

    def _nodes(self, variables: int) -> int | None:
        left = [] if self.effort is None else [self.effort.nodes(variables)]
        return min([*left, *([] if self.nodes is None else [self.nodes])], default=None)
