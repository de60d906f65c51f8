"""`trade`: what accuracy costs on one part, measured."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real

import numpy as np

from inertia.arrays import Progress
from inertia.errors import ReadError, UsageError, require_kind
from inertia.mass.analysis import Accuracy, Analysis, analyse
from inertia.mass.triangles.arithmetic import FINEST
from inertia.mesh.geometry.closure import closure
from inertia.mesh.part import Cells, Part
from inertia.mesh.read import read
from inertia.work_precision.compare import Scale
from inertia.work_precision.machine import Machine, this_machine
from inertia.work_precision.measure import answers, simpler_rows, whole_rows
from inertia.work_precision.recommend import Recommendation, recommendations
from inertia.work_precision.rows import Row, Skipped
from inertia.work_precision.stopwatch import Stopwatch, Timing

_CHECKED, _ANSWERED = 0.2, 0.6  # of the progress


@dataclass(frozen=True, eq=False)
class Trade:
    """What accuracy costs on one part.

    Attributes
    ----------
    analysis : of the part, as `accuracy=None` gives it
    accuracy : the relative accuracy asked for, "exact" or None
    machine : where the times were measured
    repeats, budget : runs of each row, and s for all
    steps : times of what comes beside the integration: "read", "closedness", "results" (to results with bounds)
    rows : every method over the whole mesh, then float64 over simpler and simpler meshes
    reference : the method that the errors are measured against: "exact", where the budget allowed it
    skipped : what was not measured
    recommendations : one for the accuracy asked for; without one, for every decade of accuracies
    """

    analysis: Analysis
    accuracy: Accuracy
    machine: Machine
    repeats: int
    budget: float
    steps: Mapping[str, Timing]
    rows: tuple[Row, ...]
    reference: str
    skipped: tuple[Skipped, ...]
    recommendations: tuple[Recommendation, ...]


def trade(
    part: Part,
    accuracy: Accuracy = None,
    *,
    density: float | None = None,
    material: str | None = None,
    repeats: int = 5,
    budget: float = 30.0,
    progress: Progress | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> Trade:
    """Measure time against error for every method and for simplified meshes, and recommend one.

    The time of a row is that of the integration alone, by this one method (and the float64 sums that every analysis
    begins with); a first run, which may compile or load code, does not count. Its error is the distance of the result
    from the exact answer for the whole mesh: of the arithmetic over the whole mesh, of the geometry over a simplified
    one. What does not fit into the budget is skipped, and listed.

    Parameters
    ----------
    part : what `inertia.read` returned: a surface that bounds a solid
    accuracy : a relative figure to recommend a row for, or "exact"; without it all decades are gone through
    density, material : of the whole part, as for `inertia.mass_properties`
    repeats : runs of each row; fewer where they would take more than a tenth of the budget
    budget : s, for all of it
    progress : called with the fraction done
    clock : tells the time in s

    Raises
    ------
    GeometryError : the surface bounds no solid
    UsageError : an argument is not usable, or the part is a mesh of cells

    >>> import inertia
    >>> from inertia_meshes import path
    >>> found = inertia.trade(inertia.read(path("sphere.stl")), accuracy=1e-9, repeats=1)
    >>> found.rows[0].method, found.rows[0].error.worst < found.rows[0].bound.worst < 1e-12
    ('float64', True)
    """
    require_kind(part, Part, "part", "inertia.read(path)")
    watch = Stopwatch(repeats, budget, clock)
    _require_usable(part, density, material)
    asked = _accuracy(accuracy)
    say = progress or _nothing
    analysis = analyse(part, density, material=material, progress=lambda done: say(_CHECKED * done))
    size = Fraction(float(np.ptp(analysis.extents, axis=0).max()))
    scale = Scale(part.unit.metres, Fraction(analysis.density), size)
    triangles = part.triangles
    steps = _beside(part, watch)
    found, skipped = answers(triangles, scale, watch, lambda done: say(_CHECKED + (_ANSWERED - _CHECKED) * done))
    if not found:
        raise UsageError(
            f"no method that can tell the volume of {part.name} from zero fits into the budget of {budget:g} s: "
            "give a larger budget"
        )
    steps["results"], _ = watch.timed(lambda: scale.properties(found[0].moments, found[0].method))
    simpler, left = simpler_rows(
        triangles, found[-1], scale, watch, lambda done: say(_ANSWERED + (1.0 - _ANSWERED) * done)
    )
    say(1.0)
    rows = (*whole_rows(triangles, found, scale), *simpler)
    return Trade(
        analysis=analysis,
        accuracy=asked,
        machine=this_machine(),
        repeats=repeats,
        budget=budget,
        steps=steps,
        rows=rows,
        reference=found[-1].method,
        skipped=(*skipped, *left),
        recommendations=recommendations(rows, (*skipped, *left), asked),
    )


def _nothing(done: float) -> None:
    """Take a fraction done and show it nowhere."""


def _accuracy(accuracy: Accuracy) -> Accuracy:
    if accuracy is None or accuracy == "exact":
        return accuracy
    if not (isinstance(accuracy, Real) and FINEST <= accuracy < math.inf):
        raise UsageError(
            f"accuracy is {accuracy!r}: give a relative figure from {FINEST:g} upwards, such as 1e-9, or 'exact'"
        )
    return float(accuracy)


def _require_usable(part: Part, density: float | None, material: str | None) -> None:
    if isinstance(density, Mapping) or isinstance(material, Mapping):
        raise UsageError("a trade takes one density or material for the whole part: give it without a name")
    if isinstance(part.geometry, Cells):
        raise UsageError(f"a trade measures triangle surfaces, and {part.name} is a mesh of cells: analyse it instead")


def _beside(part: Part, watch: Stopwatch) -> dict[str, Timing]:
    """Time what a file needs before it is integrated."""
    steps = {}
    path = part.source.path
    if path is not None:
        with contextlib.suppress(ReadError):  # the file may have gone since it was read
            steps["read"], _ = watch.timed(lambda: read(path, part.unit.name, format=part.source.format))
    steps["closedness"], _ = watch.timed(lambda: closure(part.triangles))
    return steps
