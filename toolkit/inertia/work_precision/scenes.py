"""`trade_scene`: what accuracy costs on one scene, measured."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real

import numpy as np

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import FINEST, Scene
from inertia.errors import GeometryError, UsageError
from inertia.work_precision.machine import Machine, this_machine
from inertia.work_precision.rows import Skipped
from inertia.work_precision.scene_measure import LADDER, Measured, Measurement
from inertia.work_precision.scene_recommend import SceneRecommendation, scene_recommendations
from inertia.work_precision.scene_rows import SceneRow

_COARSEST = 1.0


@dataclass(frozen=True, eq=False)
class SceneTrade:
    """What accuracy costs on one scene.

    Attributes
    ----------
    scene : as given
    accuracy : rad, as asked for, or None
    machine : where the times were measured
    repeats, budget : runs of each row, and s of CPU time for all
    rows : what the planner selects for each accuracy, then every method over the ladder of accuracies
    reference : the row that the errors are measured against
    skipped : what was not measured, or did not reach what it was asked for
    recommendations : one for the accuracy asked for; without one, for every accuracy of the ladder
    """

    scene: Scene
    accuracy: float | None
    machine: Machine
    repeats: int
    budget: float
    rows: tuple[SceneRow, ...]
    reference: SceneRow
    skipped: tuple[Skipped, ...]
    recommendations: tuple[SceneRecommendation, ...]


def trade_scene(
    scene: Scene,
    accuracy: float | None = None,
    *,
    repeats: int = 5,
    budget: float = 30.0,
    progress: Callable[[float], None] | None = None,
    clock: Callable[[], float] = time.process_time,
) -> SceneTrade:
    """Measure CPU time against attitude error for every method that can follow a scene, and recommend one.

    Every row is a whole `inertia.simulate` for a stated accuracy: planning, the motion, and the estimate of its error.
    A first run, which may compile or load code, counts only where there is no time for a second one. The error is the
    largest angle over the samples to the closed form, where the scene has one that serves every accuracy, else to the
    run with the least estimate of its own error.

    Parameters
    ----------
    scene : what `inertia.Scene.load` returned; a model or method that it asks for is one of the rows
    accuracy : rad, to recommend a row for; without it, each of 1e-3, 1e-5, … 1e-13 is gone through
    repeats : runs of each row; fewer where they would take more than a tenth of the method's share of the budget
    budget : s of CPU time, for all of it
    progress : called with the fraction done
    clock : tells the time in s

    Raises
    ------
    UsageError : an argument is not usable
    GeometryError : no method follows the scene

    >>> scene = Scene.from_dict({"body": {"principal_moments": [1, 2, 3]},
    ...                          "start": {"angular_velocity": [1, 2, 3]}, "run": {"duration": 0.1, "samples": 2}})
    >>> found = trade_scene(scene, 1e-6, repeats=1, budget=1.0)
    >>> found.reference.model, all(row.reached < 1e-3 for row in found.rows)
    ('asymmetric top', True)
    """
    asked = _accuracy(accuracy)
    ladder = tuple(sorted({*LADDER, scene.run.accuracy if asked is None else asked}, reverse=True))
    measurement = Measurement(scene, ladder, repeats, budget, clock)
    measurement.run(progress or _nothing)
    found, skipped = measurement.found, measurement.skipped
    if not found and skipped[0].seconds is None:
        raise GeometryError(f"{scene.name}: {skipped[0].why}")
    if not found:
        raise UsageError(f"{scene.name}: no run fits into the budget of {budget:g} s: give a larger budget")
    standard = _reference(found, ladder[-1])
    rows = tuple(_row(item, standard) for item in found)
    return SceneTrade(
        scene=scene,
        accuracy=asked,
        machine=this_machine(),
        repeats=repeats,
        budget=budget,
        rows=rows,
        reference=rows[found.index(standard)],
        skipped=tuple(skipped),
        recommendations=scene_recommendations(rows, ladder, asked),
    )


def _nothing(done: float) -> None:
    """Take a fraction done and show it nowhere."""


def _accuracy(accuracy: float | None) -> float | None:
    if accuracy is None:
        return None
    if not (isinstance(accuracy, Real) and FINEST <= accuracy <= _COARSEST):
        raise UsageError(
            f"accuracy is {accuracy!r}: for a scene give an angle in rad from {FINEST:g} to {_COARSEST:g}, such as 1e-9"
        )
    return float(accuracy)


def _reference(found: list[Measured], finest: float) -> Measured:
    """Return the closed form that serves the finest accuracy, else the run with the least estimate of its error."""
    closed = [item for item in found if item.run.steps == 0 and finest in item.asked]
    return min(closed or found, key=lambda item: item.run.error.reached)


def _row(item: Measured, standard: Measured) -> SceneRow:
    error = None if item is standard else _apart(item.run, standard.run)
    run = item.run
    return SceneRow(
        model=run.model,
        method=run.error.method,
        asked=item.asked,
        planned=item.planned,
        time=item.time,
        steps=run.steps,
        estimate=run.error.reached,
        error=error,
        reached=(error or 0.0) + standard.run.error.reached,
    )


def _apart(one: Run, other: Run) -> float:
    return float(np.max(quaternion.angle_between(one.attitude, other.attitude)))
