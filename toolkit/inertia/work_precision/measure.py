"""Measuring the rows: every method over the whole mesh, then float64 over simpler meshes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from inertia.arrays import Progress
from inertia.errors import GeometryError, UsageError
from inertia.mass.moments import Moments
from inertia.mass.properties import MassProperties
from inertia.mass.triangles.arithmetic import METHODS, Arithmetic, solid_moments
from inertia.mass.triangles.sums import sum_triangles
from inertia.mesh.geometry.closure import closure
from inertia.mesh.part import Triangles
from inertia.mesh.repairs.simplify import FEWEST, Simplified, halvings
from inertia.native import COMPILE_ABOVE
from inertia.work_precision.compare import Scale
from inertia.work_precision.rows import Row, Simplification, Skipped
from inertia.work_precision.stopwatch import Stopwatch, Timing

_SAMPLE = 32_768  # triangles that a time is estimated from
_HALVING = 1e-5  # s a triangle that the first halving is taken to cost, until one was measured
_USELESS = 0.1  # relative error beyond which no simpler mesh is of interest


@dataclass(frozen=True, eq=False)
class Answer:
    """What one method gives for the whole mesh: the moments in the file's unit, rounded, and its time."""

    method: Arithmetic
    moments: Moments
    properties: MassProperties
    time: Timing


def answers(
    triangles: Triangles, scale: Scale, watch: Stopwatch, progress: Progress
) -> tuple[list[Answer], list[Skipped]]:
    """Integrate the whole mesh by every method that the budget allows; by float64 in any case."""
    found, skipped = [], []
    for k, method in enumerate(METHODS):
        seconds = _estimate(triangles, method, watch)
        if method != "float64" and not watch.affords(seconds):
            skipped.append(Skipped(f"{method} over the whole mesh", "it does not fit into the budget", seconds))
            continue
        time, moments = watch.timed(partial(_integrated, triangles, method))
        try:
            found.append(Answer(method, moments, scale.properties(moments, METHODS[method]), time))
        except GeometryError as fault:
            skipped.append(Skipped(f"{method} over the whole mesh", str(fault)))
        progress((k + 1) / len(METHODS))
    return found, skipped


def whole_rows(triangles: Triangles, found: list[Answer], scale: Scale) -> list[Row]:
    """Compare the answers for the whole mesh with the last of them, which is the most accurate one."""
    rows = []
    for answer in found:
        bound = scale.bound(answer.properties)
        known = answer is not found[-1] or answer.method == "exact"
        error = scale.error(answer.properties, found[-1].moments) if known else None
        rows.append(
            Row(
                method=answer.method,
                triangles=triangles.count,
                simplification=None,
                time=answer.time,
                properties=answer.properties,
                error=error,
                bound=bound,
                reached=bound.worst,
            )
        )
    return rows


def simpler_rows(
    triangles: Triangles, reference: Answer, scale: Scale, watch: Stopwatch, progress: Progress
) -> tuple[list[Row], list[Skipped]]:
    """Halve the mesh again and again, and integrate each by float64.

    It ends where the mesh cannot be halved, where the error makes it useless, or where the budget is used up.
    """
    rows: list[Row] = []
    levels = max(1.0, math.log2(triangles.count / FEWEST))
    meshes, share = halvings(triangles), 1
    next_one, spent = _HALVING * triangles.count, 0.0
    while watch.affords(next_one):
        try:
            next_one, mesh = watch.once(partial(next, meshes, None))
            if mesh is None:
                return rows, [Skipped(_coarser(share), "no tolerance leaves a solid of so few triangles")]
            spent += next_one
            rows.append(_simpler_row(mesh, spent, reference, scale, watch))
        except (UsageError, GeometryError) as fault:
            return rows, [Skipped(_coarser(share), str(fault))]
        share = mesh.share
        progress(min(1.0, math.log2(share) / levels))
        if rows[-1].reached > _USELESS:
            return rows, []
    return rows, [Skipped(_coarser(share), "they do not fit into the budget", next_one)]


def _coarser(share: int) -> str:
    return f"meshes of about 1/{2 * share} of the triangles and fewer"


def _simpler_row(mesh: Simplified, spent: float, reference: Answer, scale: Scale, watch: Stopwatch) -> Row:
    if closure(mesh.surface).open_edges:
        raise GeometryError(f"simplifying to {mesh.surface.count} triangles left the mesh open")
    run = partial(_integrated, mesh.surface, "float64")
    run()
    time, moments = watch.timed(run)
    properties = scale.properties(moments, METHODS["float64"])
    error = scale.error(properties, reference.moments)
    doubt = 0.0 if reference.method == "exact" else scale.bound(reference.properties).worst
    return Row(
        method="float64",
        triangles=mesh.surface.count,
        simplification=Simplification(mesh.share, float(mesh.tolerance * scale.metres), spent),
        time=time,
        properties=properties,
        error=error,
        bound=scale.bound(properties),
        reached=error.worst + doubt,
    )


def _integrated(triangles: Triangles, method: Arithmetic) -> Moments:
    """Integrate as an analysis does, which begins with the float64 sums whatever method is asked for."""
    return solid_moments(triangles, method, sum_triangles(triangles))


def _estimate(triangles: Triangles, method: Arithmetic, watch: Stopwatch) -> float:
    """Return the seconds that a method needs for all triangles, as measured on a sample after a first use."""
    first = COMPILE_ABOVE if triangles.count >= COMPILE_ABOVE else _SAMPLE
    _integrated(_sample(triangles, first), method)
    sample = _sample(triangles, _SAMPLE)
    seconds, _ = watch.once(partial(_integrated, sample, method))
    return seconds * triangles.count / sample.count


def _sample(triangles: Triangles, count: int) -> Triangles:
    return triangles if triangles.count <= count else triangles.select(np.arange(count))
