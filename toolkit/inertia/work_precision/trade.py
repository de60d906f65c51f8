"""`trade`: what accuracy costs on one part or scene, time against error for every method, with a recommendation."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from numbers import Real
from typing import TYPE_CHECKING, Generic, overload

from inertia.arrays import Progress
from inertia.errors import UsageError, require_kind
from inertia.mass.analyse import analyse
from inertia.mass.analysis import Accuracy, Analysis
from inertia.mesh.part import Cells, Part
from inertia.records import dataclass
from inertia.work_precision.machine import Machine, this_machine
from inertia.work_precision.recommend import Recommendation, part_recommendations, scene_recommendations
from inertia.work_precision.rows import PartRow, R, SceneRow, Skipped
from inertia.work_precision.stopwatch import Stopwatch, Timing

if TYPE_CHECKING:
    from inertia.dynamics.scene.document import Scene

_CHECKED = 0.2  # of the progress with a part
_COARSEST = 1.0  # rad


@dataclass(frozen=True, eq=False, kw_only=True)
class Trade(Generic[R]):
    """What accuracy costs on one part or scene.

    Attributes
    ----------
    accuracy : as asked for: relative or "exact" for a part, rad for a scene, or None
    machine : where the times were measured
    repeats, budget : runs of each row, and s for all: wall time for a part, CPU time for a scene
    rows : of a part every method over the whole mesh, then float64 over simpler and simpler meshes; of a scene what
        the planner selects for each accuracy, then every method over the ladder of accuracies
    reference : what the errors are measured against: of a part the row "exact", where the budget allowed it; of a
        scene the equations of motion in double-double, which no row is, else a row
    skipped : what was not measured, or did not reach what it was asked for
    recommendations : one for the accuracy asked for; without one, for every decade or rung of the ladder
    """

    accuracy: Accuracy
    machine: Machine
    repeats: int
    budget: float
    rows: tuple[R, ...]
    reference: R
    skipped: tuple[Skipped, ...]
    recommendations: tuple[Recommendation[R], ...]

    def _repr_html_(self) -> str:
        """Return a small table of what to take, as a notebook shows it."""
        from inertia.notebook import html_of

        rows = [("Measured", f"{len(self.rows)} ways, {self.machine}")]
        return html_of([*rows, *(("Take", str(each.sentence)) for each in self.recommendations)])


@dataclass(frozen=True, eq=False, kw_only=True)
class PartTrade(Trade[PartRow]):
    """What accuracy costs on one part.

    Attributes
    ----------
    analysis : of the part, as `accuracy=None` gives it
    steps : times of what comes beside the integration: "read", "closedness", "results" (to results with bounds)
    """

    analysis: Analysis
    steps: Mapping[str, Timing]


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneTrade(Trade[SceneRow]):
    """What accuracy costs on one scene, which is `scene`."""

    scene: Scene


@overload
def trade(
    subject: Part,
    accuracy: Accuracy = None,
    *,
    density: float | None = None,
    material: str | None = None,
    repeats: int = 5,
    budget: float = 30.0,
    progress: Progress | None = None,
    clock: Callable[[], float] | None = None,
) -> PartTrade: ...


@overload
def trade(
    subject: Scene,
    accuracy: float | None = None,
    *,
    repeats: int = 5,
    budget: float = 30.0,
    progress: Progress | None = None,
    clock: Callable[[], float] | None = None,
) -> SceneTrade: ...


def trade(
    subject: Part | Scene,
    accuracy: Accuracy = None,
    *,
    density: float | None = None,
    material: str | None = None,
    repeats: int = 5,
    budget: float = 30.0,
    progress: Progress | None = None,
    clock: Callable[[], float] | None = None,
) -> PartTrade | SceneTrade:
    """Measure time against error for every method, of a part or a scene, and recommend one.

    Of a part, the time of a row is the wall time of the integration alone, by this one method (and the float64 sums
    that every analysis begins with); a first run, which may compile or load code, does not count. Its error is the
    distance of the result from the exact answer for the whole mesh as its file writes it: of the arithmetic over the
    whole mesh, decimals that reading rounded among it, of the geometry over a simplified one.

    Of a scene, every row is a whole `inertia.simulate` for a stated accuracy: planning, the motion, and the estimate of
    its error, in CPU time. A first run counts only where there is no time for a second one. The error is the largest
    angle over the samples to the motion in double-double, where the budget allows it; else to the closed form, where
    the scene has one that serves every accuracy, or to the run with the least estimate of its own error.

    What does not fit into the budget is skipped, and listed.

    Parameters
    ----------
    subject : what `inertia.read` returned, a surface that bounds a solid; or what `inertia.Scene.load` returned, of
        which a model or method that it asks for is one of the rows
    accuracy : to recommend a row for. Of a part a relative figure or "exact"; without it all decades are gone through.
        Of a scene an angle in rad; without it each of 1e-3, 1e-5, … 1e-13
    density, material : of the whole part, as for `inertia.mass_properties`
    repeats : runs of each row; fewer where they would take more than a tenth of the budget, of a scene a fiftieth
    budget : s, for all of it
    progress : called with the fraction done
    clock : tells the time in s

    Raises
    ------
    GeometryError : the surface bounds no solid, or no method follows the scene
    UsageError : an argument is not usable, or the part is a mesh of cells

    >>> import inertia
    >>> from inertia_meshes import path
    >>> cost = inertia.trade(inertia.read(path("sphere.stl")), accuracy=1e-9, repeats=1)
    >>> cost.rows[0].method, cost.rows[0].error.worst < cost.rows[0].bound.worst < 1e-12
    ('float64', True)
    >>> scene = inertia.Scene.from_dict({"body": {"principal_moments": [1, 2, 3]},
    ...                                  "start": {"angular_velocity": [1, 2, 3]},
    ...                                  "run": {"duration": 0.1, "samples": 2}})
    >>> cost = inertia.trade(scene, 1e-6, repeats=1, budget=1.0)
    >>> cost.rows[0].model, all(row.reached < 1e-3 for row in cost.rows)
    ('asymmetric top', True)
    """
    show = progress or _nothing
    if isinstance(subject, Part):
        watch = Stopwatch(repeats, budget, clock or time.perf_counter)
        return _trade_part(subject, accuracy, density, material, watch, show)
    from inertia.dynamics.scene.document import Scene

    if not isinstance(subject, Scene):
        require_kind(subject, Part, "part", "inertia.read(path)")
    if density is not None or material is not None:
        raise UsageError("a scene says itself what its body is: give a density or material with a part only")
    return _trade_scene(subject, accuracy, Stopwatch(repeats, budget, clock or time.process_time), show)


def _trade_part(
    part: Part,
    accuracy: Accuracy,
    density: float | None,
    material: str | None,
    watch: Stopwatch,
    progress: Progress,
) -> PartTrade:
    from inertia.mass.triangles.arithmetic import FINEST
    from inertia.work_precision.parts import measure_part

    if isinstance(density, Mapping) or isinstance(material, Mapping):
        raise UsageError("a trade takes one density or material for the whole part: give it without a name")
    if isinstance(part.geometry, Cells):
        raise UsageError(f"a trade measures triangle surfaces, and {part.name} is a mesh of cells: analyse it instead")
    if not (accuracy is None or accuracy == "exact"):
        if not (isinstance(accuracy, Real) and FINEST <= accuracy < math.inf):
            raise UsageError(
                f"accuracy is {accuracy!r}: give a relative figure from {FINEST:g} upwards, such as 1e-9, or 'exact'"
            )
        accuracy = float(accuracy)
    part = replace(part, shape=None)  # what is measured is the integration of triangles
    analysis = analyse(part, density, material=material, progress=lambda done: progress(_CHECKED * done))
    measurement = measure_part(analysis, watch, lambda done: progress(_CHECKED + (1.0 - _CHECKED) * done))
    return PartTrade(
        accuracy=accuracy,
        machine=this_machine(),
        repeats=watch.repeats,
        budget=watch.budget,
        rows=measurement.rows,
        reference=measurement.reference,
        skipped=measurement.skipped,
        recommendations=part_recommendations(measurement.rows, measurement.skipped, accuracy),
        analysis=analysis,
        steps=measurement.steps,
    )


def _trade_scene(scene: Scene, accuracy: Accuracy, watch: Stopwatch, progress: Progress) -> SceneTrade:
    from inertia.dynamics.scene.sections import FINEST
    from inertia.work_precision.scenes import LADDER, measure_scene

    if accuracy is not None:
        if not (isinstance(accuracy, Real) and FINEST <= accuracy <= _COARSEST):
            raise UsageError(
                f"accuracy is {accuracy!r}: for a scene give an angle in rad from {FINEST:g} to {_COARSEST:g}, such as "
                "1e-9"
            )
        accuracy = float(accuracy)
    ladder = tuple(sorted({*LADDER, scene.run.accuracy if accuracy is None else accuracy}, reverse=True))
    measurement = measure_scene(scene, ladder, watch, progress)
    return SceneTrade(
        accuracy=accuracy,
        machine=this_machine(),
        repeats=watch.repeats,
        budget=watch.budget,
        rows=measurement.rows,
        reference=measurement.reference,
        skipped=measurement.skipped,
        recommendations=scene_recommendations(measurement.rows, ladder, accuracy),
        scene=scene,
    )


def _nothing(done: float) -> None:
    """Take a fraction done and show it nowhere."""
