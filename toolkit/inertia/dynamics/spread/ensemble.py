"""`ensemble`: a scene followed many times with numbers that are drawn or swept, and the spread of what comes out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from typing import Any

import numpy as np

from inertia.arrays import Float, Progress
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.dynamics.spread.fields import changed, value_at
from inertia.dynamics.spread.follow import STATES, Task
from inertia.dynamics.spread.inputs import Input, Law, inputs_of, values_of
from inertia.dynamics.spread.many import method_for
from inertia.dynamics.spread.quantities import Reference, States, quantity, require_names
from inertia.dynamics.spread.results import Results, gathered
from inertia.dynamics.spread.workers import blocks_of
from inertia.errors import GeometryError, UsageError, require_kind
from inertia.records import dataclass

_USUAL = ("deviation", "tilt", "spin")
_REGRESSED = 1_000_000  # draws that a regression takes, at most
_LEAST_ROWS = 3  # beyond the inputs, for a regression


@dataclass(frozen=True, eq=False)
class Drivers:
    """What the spread of a quantity at the end comes from, of the inputs in their order.

    Attributes
    ----------
    share : (k,) of its variance, by linear regression on the inputs, which are independent
    rank : (k,) rank correlations (Spearman) with the inputs, −1 … 1: the sense, and whether the relation is monotonic
    explained : R², the share of the variance that the regression explains; the rest is not linear in the inputs
    """

    share: Float
    rank: Float
    explained: float


@dataclass(frozen=True, eq=False)
class Ensemble(Results):
    """The runs of a scene with numbers that were drawn or swept: N draws at n instants, and what became of them.

    Attributes
    ----------
    nominal : `Run` with every input at its middle
    inputs : what varied; values : (N, k), what was drawn
    seed : of the draws
    """

    nominal: Run
    inputs: tuple[Input, ...]
    values: Float
    seed: int

    @property
    def scene(self) -> Scene:
        """The scene with every input at its middle."""
        return self.nominal.scene

    @property
    def time(self) -> Float:
        """The instants (n,) s of the quantities."""
        return self.nominal.time

    def _repr_html_(self) -> str:
        """Return a small table of what varied and what came of it, as a notebook shows it."""
        from inertia.notebook import html_of

        counts = ", ".join(f"{count} {state}" for state, count in self.state_counts.items())
        rows = [
            ("Scene", self.scene.name),
            *(("Varied", f"{each.path}: {each.described}") for each in self.inputs),
            ("Draws", f"{len(self.values)}, seed {self.seed}: {counts}"),
        ]
        for name, ends in self.ends.items():
            if (some := ends[self.followed & np.isfinite(ends)]).size:
                low, middle, high = np.percentile(some, [2.5, 50.0, 97.5])
                rows.append((name.capitalize(), f"{middle:.6g} at the end, 95 % from {low:.6g} to {high:.6g}"))
        return html_of(rows)

    def nominal_quantity(self, name: str) -> Float:
        """Return a quantity (n,) of the run with every input at its middle."""
        return quantity(name, States.of(self.nominal), Reference.of(self.nominal))

    def drivers(self, name: str) -> Drivers | None:
        """Return what the spread of a quantity at the end comes from; None where it has none, or draws are too few.

        With y = b₀ + Σ bᵢ xᵢ by least squares, the share of an input is bᵢ cov(xᵢ, y)/var(y), for independent inputs
        bᵢ² var(xᵢ)/var(y). Of the deviation, which has no sign, the components of its rotation vector are taken
        together. Pratt, Proc. 2nd Tampere Conf. Statistics (1987) 245; Saltelli et al., *Global Sensitivity Analysis*
        (2008), § 1.2. Of more than a million draws, that many are taken by chance, the same ones every time.
        """
        end = self.ends[name]
        rows = np.flatnonzero(np.isfinite(end) & self.followed)
        if rows.size > _REGRESSED:
            rows = rows[np.random.default_rng(self.seed).integers(rows.size, size=_REGRESSED)]
        inputs = self.values[rows]
        if len(rows) < len(self.inputs) + _LEAST_ROWS:
            return None
        results = self.turned[rows] if name == "deviation" else end[rows, None]
        spread = inputs.std(axis=0)
        scaled = (inputs - inputs.mean(axis=0)) / np.where(spread > 0, spread, 1.0)
        centred = results - results.mean(axis=0)
        total = float((centred**2).mean(axis=0).sum())
        if not total > 1e-24 * float((results**2).mean(axis=0).sum()):
            return None
        slopes = np.linalg.lstsq(scaled, centred, rcond=None)[0]
        left = float(((centred - scaled @ slopes) ** 2).mean(axis=0).sum())
        ranks = np.array([_rank_correlation(column, end[rows]) for column in inputs.T])
        shares = (slopes * (scaled.T @ centred)).sum(axis=1) / (total * len(rows))
        return Drivers(shares, ranks, 1.0 - left / total)

    def columns(self, rows: slice = slice(None)) -> dict[str, Any]:
        """Return a table with a row for each draw: what was drawn, what came of it, each quantity at the end and most.

        Where a draw was not followed, `message` says why. With `rows`, it has these alone.
        """
        draws = range(len(self.values))[rows]
        table: dict[str, Any] = {"draw": np.array(draws), "state": [STATES[k] for k in self.state[rows].tolist()]}
        table |= {each.path: self.values[rows, k] for k, each in enumerate(self.inputs)}
        table |= {"model": [self.model_names[k] for k in self.model[rows].tolist()], "reached": self.reached[rows]}
        for name in self.ends:
            table |= {name: self.ends[name][rows], f"{name} largest": self.most[name][rows]}
        table |= {f"first {name}": instants[rows] for name, instants in self.events.items()}
        table["message"] = [self.sentences.get(k, "") for k in draws]
        return table


def ensemble(
    scene: Scene,
    vary: Mapping[str, Law],
    draws: int | None = None,
    *,
    seed: int = 0,
    quantities: Sequence[str] = (),
    reaches: Mapping[str, float] | None = None,
    samples: int = 101,
    jobs: int | None = None,
    dask: str | None = None,
    memory: float = 2**30,
    progress: Progress | None = None,
) -> Ensemble:
    """Follow a scene many times, with numbers in it drawn or swept, each draw to the accuracy that the scene asks for.

    Parameters
    ----------
    scene : the scene
    vary : {path of a field: how it varies}: ``1±0.01`` or ``±1%`` (normal, with this standard deviation, the latter
        about what the scene states), ``0.9..1.1`` (uniform), ``0:1:11`` or numbers (a sweep); an `Estimate` is normal.
        Sweeps make a grid, and all draws are made at each of its points.
    draws : how many; 1000 without, one at each point where all inputs are swept
    seed : of the random numbers; a draw depends on it, its number and the path alone
    quantities : by name: deviation (rad from the run without deviations), tilt (rad), spin (rad/s), energy,
        angular_velocity[0] … and what the model states; the first three without
    reaches : {quantity: a level}: when a draw first reaches it, from above or below, becomes one of the events; between
        the instants the quantity counts as a straight line
    samples : instants, evenly spaced, at which they are taken
    jobs : processes; as many as there are processors where the work repays them
    dask : address of a scheduler to send the draws to
    memory : bytes, beyond which the quantities do not stay at all instants: what remains of a draw is each of them at
        the end and at its largest, and percentiles at the other instants are those of histograms (`Histogram`)
    progress : told the share that is done

    Raises `UsageError` where a field, a law or a quantity is none, `GeometryError` where no draw can be followed, and
    what `simulate` raises for the run without deviations. A draw that makes no sense is counted and says why.

    >>> scene = Scene.from_dict({"body": {"principal_moments": [1, 1, 2]}, "start": {"angular_velocity": [0.1, 0, 5]},
    ...                          "run": {"duration": 2}})
    >>> spread = ensemble(scene, {"start.angular_velocity[2]": "±1%"}, 200)
    >>> spread.percentiles("spin")[:, -1].round(1).tolist(), spread.drivers("spin").share.round(3).tolist()
    ([4.9, 5.0, 5.1], [1.0])
    """
    require_kind(scene, Scene, "scene", "inertia.Scene.load(path)")
    inputs = inputs_of(scene, vary)
    values = values_of(inputs, draws, seed)
    levels = {name: float(level) for name, level in (reaches or {}).items()}
    for name, level in levels.items():
        if not np.isfinite(level):
            raise UsageError(f"the level of {name} is {level}: it must be finite")
    task, nominal = _task(scene, inputs, (*(quantities or _USUAL), *levels), samples)
    series = 8.0 * len(values) * len(task.names) * samples <= memory
    with closing(blocks_of(task, values, jobs, dask, progress)) as blocks:
        results = gathered(blocks, task, len(values), nominal.time, levels, series=series)
    made = Ensemble(**vars(results), nominal=nominal, inputs=inputs, values=values, seed=seed)
    if not made.followed.any():
        draw, sentence = next(iter(made.sentences.items()))
        raise GeometryError(
            f"none of the {len(values)} draws can be followed; draw {draw}: {sentence}", places=(scene.name,)
        )
    return made


def _task(scene: Scene, inputs: tuple[Input, ...], names: tuple[str, ...], samples: int) -> tuple[Task, Run]:
    middle = {each.path: each.middle(float(value_at(scene, each.path))) for each in inputs}
    centred = changed(scene, middle)
    nominal = simulate(replace(centred, run=replace(centred.run, samples=samples)))
    require_names(States.of(nominal), names)
    paths = tuple(each.path for each in inputs)
    asked_for = tuple(dict.fromkeys(names))
    # What is relative to the scene as it stands must not be applied to one that it has been applied to.
    relative = any(path.startswith(("body.scale", "body.uncertainty")) for path in paths)
    base = replace(scene, run=nominal.scene.run) if relative else nominal.scene
    return Task(base, paths, asked_for, Reference.of(nominal), method_for(nominal, paths, asked_for)), nominal


def _rank_correlation(x: Float, y: Float) -> float:
    """Return Spearman's coefficient; 0 where one of them is constant."""
    if np.ptp(x) == 0 or np.ptp(y) == 0:
        return 0.0
    return float(np.corrcoef(_ranks(x), _ranks(y))[0, 1])


def _ranks(values: Float) -> Float:
    """Return ranks (N,), those of equal values averaged."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    middle: Float = np.cumsum(counts) - 0.5 * (counts - 1.0)
    return middle[inverse]
