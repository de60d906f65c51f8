"""Draws of a scene followed one by one, each by the model that it needs, or many at once."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.dynamics.spread.fields import changed
from inertia.dynamics.spread.many import Motions, follow_many
from inertia.dynamics.spread.quantities import Reference, States, quantity
from inertia.errors import InertiaError, reworded
from inertia.records import dataclass

STATES: tuple[str, ...] = ("followed", "refused", "not followed")
"""What becomes of a draw: it is in the results; its numbers make no scene; no model reaches the accuracy."""

FOLLOWED, REFUSED, LEFT = STATES


@dataclass(frozen=True, eq=False)
class Task:
    """What is done with each draw.

    Attributes
    ----------
    scene : the one that numbers are changed in, with the instants of the results as its samples
    paths : of the numbers; names : of the quantities
    reference : what draws are compared with
    method : by which draws are followed all at once (`many.method_for`); None where each is its own run
    """

    scene: Scene
    paths: tuple[str, ...]
    names: tuple[str, ...]
    reference: Reference
    method: str | None

    def of(self, values: Float) -> Scene:
        """Return the scene with numbers (k,)."""
        return changed(self.scene, dict(zip(self.paths, values.tolist(), strict=True)))


@dataclass(frozen=True, eq=False)
class Block:
    """What became of m draws at n instants.

    Attributes
    ----------
    quantities : {name: (m, n)}, not a number where a draw was not followed
    turned : (m, 3) rad, the rotation vector from the nominal attitude at the end
    reached : (m,) rad; model : (m,) of text, "" where a draw was not followed
    events : {name: (m,) s}, when it first happened
    states : (m,) of text; sentences : {row: why a draw was not followed}
    """

    quantities: dict[str, Float]
    turned: Float
    reached: Float
    model: list[str]
    events: dict[str, Float]
    states: list[str]
    sentences: dict[int, str]

    @classmethod
    def empty(cls, count: int, instants: int, names: tuple[str, ...]) -> Block:
        """Make one in which no draw is followed."""
        return cls(
            {name: np.full((count, instants), np.nan) for name in names},
            np.full((count, 3), np.nan),
            np.full(count, np.nan),
            [""] * count,
            {},
            [LEFT] * count,
            {},
        )

    def put(self, task: Task, rows: Any, states: States) -> None:
        """Enter the motion of some draws."""
        for name, values in self.quantities.items():
            values[rows] = quantity(name, states, task.reference)
        self.turned[rows] = task.reference.deviation(states.attitude)[..., -1, :]

    def refuse(self, row: int, state: str, sentence: str) -> None:
        """Say why a draw is left out."""
        self.states[row], self.sentences[row] = state, sentence


def follow(task: Task, values: Float) -> Block:
    """Follow draws (m, k), and return what is asked of them."""
    block = Block.empty(len(values), task.scene.run.samples, task.names)
    if task.method is not None:
        _enter_many(block, task, follow_many(task.scene, task.paths, values, task.method, "energy" in task.names))
    for row, scene in _scenes(task, values, block):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                run = simulate(scene)
        except InertiaError as error:
            block.refuse(row, LEFT, _bare(error, task.scene))
        except (RuntimeWarning, OverflowError) as beyond:
            block.refuse(row, LEFT, f"its figures lead beyond what float64 holds ({beyond})")
        else:
            _enter(block, task, row, run)
    return block


def _scenes(task: Task, values: Float, block: Block) -> Iterator[tuple[int, Scene]]:
    """Yield the scenes of the draws, but for those that make no sense."""
    for row, figures in enumerate(values):
        if block.states[row] == FOLLOWED:
            continue
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                scene = task.of(figures)
        except InertiaError as error:
            block.refuse(row, REFUSED, _bare(error, task.scene))
        except (RuntimeWarning, OverflowError) as beyond:
            block.refuse(row, REFUSED, f"its figures lead beyond what float64 holds ({beyond})")
        else:
            yield row, scene


def _enter_many(block: Block, task: Task, motions: Motions) -> None:
    block.put(task, motions.rows, motions.states)
    block.reached[motions.rows] = motions.reached
    for row in motions.rows.tolist():
        block.model[row], block.states[row] = motions.model, FOLLOWED
    for name, instants in motions.events.items():
        first = block.events.setdefault(name, np.full(len(block.states), np.nan))
        first[motions.rows] = instants


def _enter(block: Block, task: Task, row: int, run: Run) -> None:
    states = States.of(run)
    block.put(task, slice(row, row + 1), states)
    block.reached[row], block.model[row], block.states[row] = run.error.reached, run.model, FOLLOWED
    for event in run.events:
        first = block.events.setdefault(event.name, np.full(len(block.states), np.nan))
        first[row] = np.fmin(first[row], event.time)


def _bare(error: InertiaError, scene: Scene) -> str:
    """Return the sentence of an error without the name of the scene, which all draws share."""
    return str(reworded(error, error.words, [place for place in error.places if place != scene.name]).sentence)
