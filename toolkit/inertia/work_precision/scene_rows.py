"""The rows of a scene's trade: what was measured, and what is worth having."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from inertia.work_precision.stopwatch import Timing


@dataclass(frozen=True, eq=False)
class SceneRow:
    """One run of a scene.

    Attributes
    ----------
    model : that ran
    method : that ran; a closed form says which
    asked : rad, the accuracies that all give this very run, the coarsest first
    planned : whether the planner selects it for these
    time : of the whole simulation, the estimate of its error included
    steps : that were taken; 0 for a closed form
    estimate : rad, what the run itself says of its error
    error : rad, the largest angle to the reference over the samples; None where the row is the reference
    reached : rad, what the row can be relied on for: the error and the doubt about the reference
    """

    model: str
    method: str
    asked: tuple[float, ...]
    planned: bool
    time: Timing
    steps: int
    estimate: float
    error: float | None
    reached: float


def front(rows: Sequence[SceneRow]) -> list[SceneRow]:
    """Return the rows on the Pareto front, the fastest first: no other row is as fast and reaches as much."""
    best: list[SceneRow] = []
    for row in sorted(rows, key=lambda row: (row.time.median, row.reached)):
        if not best or row.reached < best[-1].reached:
            best.append(row)
    return best
