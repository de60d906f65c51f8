"""Measuring a scene: every method that can follow it, each over a ladder of accuracies."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from inertia.arrays import Progress
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import Model
from inertia.dynamics.plan import plan
from inertia.dynamics.reference.motion import NAME, Reference, reference
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError, Sentence, UsageError
from inertia.records import dataclass
from inertia.work_precision.rows import Measurement, SceneRow, Skipped
from inertia.work_precision.stopwatch import Stopwatch, Timing

LADDER = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
"""The accuracies in rad that are gone through."""

EQUATIONS = "equations of motion"
"""The model of the reference that no row is."""

_PROBES = (32, 4)
"""The first run of a method is of this part of the duration, and tells what all of it may take; where that seems too
long, a larger part is run, for which what is compiled repays."""

_QUICK = 0.01
"""s; what takes longer may be faster where it is compiled."""

_PART = 4
"""No run may take more than this part of what is left of the budget."""

_SHARE = 0.5
"""What the reference may take of what is left of the budget after the runs that the planner selects."""

_REPEATS = 0.02
"""Of the budget: what may go into the repeats of one row."""

_ORDER_ELSE = 8
"""The order that what the planner selects counts as."""


@dataclass(frozen=True, eq=False)
class _Measured:
    """A run, its time, the accuracies in rad that give this very run, and whether the planner selects it for them."""

    run: Run
    time: Timing
    asked: tuple[float, ...]
    planned: bool

    def row(self, standard: _Measured | Reference) -> SceneRow:
        """Return the row of a run, whose error is the largest angle over the samples to the standard."""
        run, error = self.run, None
        if isinstance(standard, Reference):
            error, doubt = float(standard.apart(run.attitude).max()), standard.error
        else:
            doubt = standard.run.error.reached
            if self is not standard:
                error = float(np.max(quaternion.angle_between(run.attitude, standard.run.attitude)))
        return SceneRow(
            method=run.error.method,
            time=self.time,
            reached=(error or 0.0) + doubt,
            model=run.model,
            asked=self.asked,
            planned=self.planned,
            steps=run.steps,
            estimate=run.error.reached,
            error=error,
        )


def measure_scene(
    scene: Scene, ladder: tuple[float, ...], watch: Stopwatch, progress: Progress
) -> Measurement[SceneRow]:
    """Run a scene by every method for every accuracy in rad, the coarsest first, within the budget of a watch.

    What the planner selects comes before the others. The reference is the motion in double-double, where the budget
    allows it and it is surer than any row; else the closed form, where one serves the finest accuracy, or the run with
    the least estimate of its error. Raises `GeometryError` where no method follows the scene, `UsageError` where no run
    fits into the budget.
    """
    ascent = _Ascent(scene, ladder, watch)
    ascent.run(progress)
    runs, skipped, (seconds, finer) = ascent.runs, ascent.skipped, ascent.finer
    if not runs and skipped[0].seconds is None:
        raise GeometryError(skipped[0].why, places=(scene.name,))
    if not runs:
        raise UsageError(f"{scene.name}: no run fits into the budget of {watch.budget:g} s: give a larger budget")
    closed = [item for item in runs if item.run.steps == 0 and ladder[-1] in item.asked]
    standard = min(closed or runs, key=lambda item: item.run.error.reached)
    if finer is None or finer.error >= standard.run.error.reached:
        rows = tuple(item.row(standard) for item in runs)
        return Measurement(rows, rows[runs.index(standard)], tuple(skipped))
    rows = tuple(item.row(finer) for item in runs)
    best = SceneRow(
        method=NAME,
        time=Timing(seconds, seconds, seconds, 1),
        reached=finer.error,
        model=EQUATIONS,
        asked=(),
        planned=False,
        steps=finer.steps,
        estimate=finer.error,
        error=None,
    )
    return Measurement(rows, best, tuple(skipped))


def _finer(run: Run, watch: Stopwatch) -> Reference | None:
    """Return the motion of a run in double-double, as far as the budget goes."""
    begun = watch.elapsed

    def affords(done: float) -> bool:
        """Say whether all of it fits into a part of what was left, where it goes on as fast."""
        return (watch.elapsed - begun) / done <= _SHARE * (watch.budget - begun)

    return reference(run.plan.candidates[-1], run.time, affords)


class _Ascent:
    """Runs one scene by each method for finer and finer accuracies, within the budget of a watch."""

    def __init__(self, scene: Scene, ladder: tuple[float, ...], watch: Stopwatch) -> None:
        self._scene, self._ladder, self._watch = scene, ladder, watch
        self.runs: list[_Measured] = []
        self.finer: tuple[float, Reference | None] = 0.0, None
        self.skipped: list[Skipped] = []

    def run(self, progress: Progress) -> None:
        """Run what the planner selects for each accuracy, then each method, those that are fast first."""
        self._climb(None, self._ladder, self._foreseen(None))
        planned = list(self.runs)
        if planned:
            self.finer = self._watch.once(partial(_finer, planned[-1].run, self._watch))
        reached = sum(len(item.asked) for item in planned)
        foreseen = {name: seconds for name in self._methods() if (seconds := self._foreseen(name)) is not None}
        for k, name in enumerate(sorted(foreseen, key=foreseen.__getitem__)):
            progress((k + 1) / (len(foreseen) + 1))
            own = [item.asked for item in planned if item.run.error.method == name]
            done = {rung for rungs in own for rung in rungs}
            if own and own[-1] == planned[-1].asked:
                done.update(self._ladder[reached:])  # it has failed there
            self._climb(name, tuple(rung for rung in self._ladder if rung not in done), foreseen[name])
        progress(1.0)

    def _methods(self) -> tuple[str, ...]:
        """Return the methods that a scene of this kind may ask for, beside what the planner selects."""
        return tuple(name for name in self._model.methods if name != self._model.default_method)

    @cached_property
    def _model(self) -> Model:
        """The most general model of the scene, which takes a method."""
        own = self.runs[0].run.plan if self.runs else plan(self._asking(self._ladder[0], None))
        return own.candidates[-1].model

    def _asking(self, accuracy: float, method: str | None) -> Scene:
        """Return the scene with an accuracy and a method in place of its own; without one the planner selects."""
        return replace(self._scene, run=replace(self._scene.run, accuracy=accuracy, model=None, method=method))

    def _climb(self, method: str | None, ladder: tuple[float, ...], seconds: float | None) -> None:
        """Run a method for finer and finer accuracies, until it fails or the next run would not fit."""
        if seconds is None:
            return
        for k, rung in enumerate(ladder):
            what = f"{_called(method)} at {rung:g} rad" + ("" if rung == ladder[-1] else " and finer")
            if k:
                seconds *= (ladder[k - 1] / rung) ** (1.0 / self._model.methods.get(method or "", _ORDER_ELSE))
            if not self._watch.affords(_PART * seconds):
                self.skipped.append(Skipped(what, "it does not fit into the budget", seconds))
                return
            simulated = partial(simulate, self._asking(rung, method))
            try:
                seconds, run = self._watch.once(simulated)  # this one may compile something
            except (GeometryError, UsageError) as fault:
                self.skipped.append(Skipped(what, _reason(fault)))
                return
            time = Timing(seconds, seconds, seconds, 1)
            last = self.runs[-1] if k else None
            if last is not None and np.array_equal(last.run.attitude, run.attitude):
                self.runs[-1] = replace(last, asked=(*last.asked, rung))
                continue
            if self._watch.affords(2 * seconds):
                time, _ = self._watch.timed(simulated, _REPEATS)
            seconds = time.median
            self.runs.append(_Measured(run, time, (rung,), method is None))

    def _foreseen(self, method: str | None) -> float | None:
        """Return the seconds that the coarsest run may take, from the first part of it; None where it fails."""
        run, seconds = self._scene.run, math.inf
        for share in _PROBES:
            samples = max(2, run.samples // share)
            scene = self._asking(self._ladder[0], method)
            settings = replace(scene.run, duration=run.duration / share, samples=samples)
            simulated = partial(simulate, replace(scene, run=settings))
            try:
                self._watch.once(simulated)  # this one may compile something
                spent, first = self._watch.once(simulated)
            except (GeometryError, UsageError) as fault:
                self.skipped.append(Skipped(_called(method), _reason(fault)))
                return None
            seconds = min(seconds, spent * (share if first.steps else run.samples / samples))
            if seconds < _QUICK or not self._watch.affords(2 * _PART * seconds / _PROBES[-1]):
                break
        return seconds


def _reason(fault: GeometryError | UsageError) -> str:
    """Return what an error says, without the place, and without the remedy where that is another accuracy."""
    sentence = Sentence(*fault.words)
    return sentence.partition(": ")[0] if isinstance(fault, GeometryError) else str(sentence)


def _called(method: str | None) -> str:
    return method or "what the planner selects"
