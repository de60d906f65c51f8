"""Measuring a part: every method of integration over the whole mesh, then float64 over simpler and simpler meshes."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from fractions import Fraction
from functools import partial

import numpy as np

from inertia.arrays import Progress
from inertia.errors import GeometryError, ReadError, UsageError
from inertia.mass.analysis import Analysis
from inertia.mass.moments import ZERO, Moments, inertia_tensor, root_above
from inertia.mass.properties import MassProperties
from inertia.mass.triangles.arithmetic import METHODS, Arithmetic, solid_moments
from inertia.mass.triangles.sums import sum_triangles
from inertia.mesh.geometry.closure import closure
from inertia.mesh.part import Part, Rounding
from inertia.mesh.read import read
from inertia.mesh.repairs.simplify import FEWEST, Simplified, halvings
from inertia.mesh.surface import Triangles
from inertia.native import COMPILE_ABOVE
from inertia.records import dataclass
from inertia.work_precision.rows import Measurement, PartRow, Relative, Simplification, Skipped
from inertia.work_precision.stopwatch import Stopwatch, Timing

_SAMPLE = 32_768  # triangles that a time is estimated from
_HALVING = 1e-5  # s a triangle that the first halving is taken to cost, until one was measured
_USELESS = 0.1  # relative error beyond which no simpler mesh is of interest
_WHOLE_MESH = 0.5  # of the progress


def measure_part(analysis: Analysis, watch: Stopwatch, progress: Progress) -> Measurement[PartRow]:
    """Measure every method over the whole mesh of an analysed part, and float64 over simplified ones.

    Raises `UsageError` where the budget of the watch allows no method that can tell the volume from zero.
    """
    part = analysis.part
    size = Fraction(float(np.ptp(analysis.extents, axis=0).max()))
    scale = _Scale(part.unit.metres, Fraction(analysis.density), size)
    steps = _steps_beside(part, watch)
    answers, skipped = _answers(part, scale, watch, lambda done: progress(_WHOLE_MESH * done))
    if not answers:
        raise UsageError(
            f"no method that can tell the volume of {part.name} from zero fits into the budget of {watch.budget:g} s: "
            "give a larger budget"
        )
    steps["results"], _ = watch.timed(lambda: scale.properties(answers[0].moments, answers[0].method))
    whole = _whole_rows(part, answers, scale)
    simpler, left_out = _simpler_rows(
        part, answers[-1], scale, watch, lambda done: progress(_WHOLE_MESH + (1.0 - _WHOLE_MESH) * done)
    )
    progress(1.0)
    return Measurement((*whole, *simpler), whole[-1], (*skipped, *left_out), steps)


def _steps_beside(part: Part, watch: Stopwatch) -> dict[str, Timing]:
    """Time what a file needs before it is integrated."""
    steps = {}
    path = part.source.path
    if path is not None:
        with contextlib.suppress(ReadError):  # the file may have gone since it was read
            steps["read"], _ = watch.timed(lambda: read(path, part.unit.name, format=part.source.format))
    steps["closedness"], _ = watch.timed(lambda: closure(part.triangles))
    return steps


@dataclass(frozen=True)
class _Scale:
    """What turns moments of volume in a file's unit into mass properties: `metres` in the unit, `density` in kg/m³.

    `size` is the largest extent of the part in metres.
    """

    metres: Fraction
    density: Fraction
    size: Fraction

    def weighed(self, moments: Moments) -> Moments:
        """Return the moments of mass, kg and metres."""
        return moments.in_unit(self.metres).scaled(self.metres**3 * self.density)

    def properties(self, moments: Moments, method: str) -> MassProperties:
        """Round to mass properties; raises `GeometryError` as `MassProperties.from_moments`."""
        cube = self.metres**3
        return MassProperties.from_moments(
            self.weighed(moments), cube * moments.zeroth, cube * moments.zeroth_bound, method
        )

    def bound(self, properties: MassProperties) -> Relative:
        """Return the certified bounds on the arithmetic error, for the centre of mass as a pair of numbers."""
        error = properties.error
        off = properties.center_of_mass_pair()[1]
        return Relative(error.volume, float(Fraction(off) / self.size), error.inertia)

    def error(self, properties: MassProperties, truth: Moments) -> Relative:
        """Return the distance of mass properties from `truth`, the moments of volume in the file's unit."""
        exact = self.weighed(truth).central()
        volume = self.metres**3 * truth.zeroth
        tensor = [value for row in inertia_tensor(exact.second) for value in row]
        stored = properties.inertia.ravel().tolist()
        high, low = properties.center_of_mass_pair()[0].tolist()
        center = [Fraction(a) + Fraction(b) for a, b in zip(high, low, strict=True)]
        return Relative(
            float(abs(Fraction(properties.volume) / volume - 1)),
            float(_distance(center, exact.origin) / self.size),
            float(_distance(stored, tensor) / _distance([0.0] * 9, tensor)),
        )


def _distance(stored: Sequence[float | Fraction], exact: list[Fraction] | tuple[Fraction, ...]) -> Fraction:
    return root_above(sum(((Fraction(a) - b) ** 2 for a, b in zip(stored, exact, strict=True)), ZERO))


@dataclass(frozen=True, eq=False)
class _Answer:
    """What one method gives for the whole mesh: the moments in the file's unit, rounded, and its time."""

    method: Arithmetic
    moments: Moments
    properties: MassProperties
    time: Timing


def _answers(part: Part, scale: _Scale, watch: Stopwatch, progress: Progress) -> tuple[list[_Answer], list[Skipped]]:
    """Integrate the whole mesh by every method that the budget allows; by float64 in any case."""
    answers, skipped = [], []
    for k, method in enumerate(METHODS):
        seconds = _estimate(part, method, watch)
        if method != "float64" and not watch.affords(seconds):
            skipped.append(Skipped(f"{method} over the whole mesh", "it does not fit into the budget", seconds))
            continue
        time, moments = watch.timed(partial(_integrated, part.triangles, method, part.rounding))
        try:
            answers.append(_Answer(method, moments, scale.properties(moments, METHODS[method]), time))
        except GeometryError as fault:
            skipped.append(Skipped(f"{method} over the whole mesh", fault.sentence))
        progress((k + 1) / len(METHODS))
    return answers, skipped


def _known(part: Part, answer: _Answer) -> bool:
    """Say whether an answer is the true one of the mesh that the file writes, but for the rounding of results."""
    return answer.method == "exact" and (part.rounding is None or part.rounding.remainder is not None)


def _whole_rows(part: Part, answers: list[_Answer], scale: _Scale) -> list[PartRow]:
    """Compare the answers for the whole mesh with the last of them, which is the most accurate one."""
    rows = []
    for answer in answers:
        bound = scale.bound(answer.properties)
        known = answer is not answers[-1] or _known(part, answer)
        rows.append(
            PartRow(
                method=answer.method,
                time=answer.time,
                reached=bound.worst,
                triangles=part.triangles.count,
                simplification=None,
                properties=answer.properties,
                error=scale.error(answer.properties, answers[-1].moments) if known else None,
                bound=bound,
            )
        )
    return rows


def _simpler_rows(
    part: Part, reference: _Answer, scale: _Scale, watch: Stopwatch, progress: Progress
) -> tuple[list[PartRow], list[Skipped]]:
    """Halve the mesh again and again, and integrate each by float64.

    It ends where the mesh cannot be halved, where the error makes it useless, or where the budget is used up.
    """
    rows: list[PartRow] = []
    triangles = part.triangles
    doubt = 0.0 if _known(part, reference) else scale.bound(reference.properties).worst
    levels = max(1.0, math.log2(triangles.count / FEWEST))
    meshes, share = halvings(triangles), 1
    next_one, seconds = _HALVING * triangles.count, 0.0
    while watch.affords(next_one):
        try:
            next_one, mesh = watch.once(partial(next, meshes, None))
            if mesh is None:
                return rows, [Skipped(_coarser(share), "no tolerance leaves a solid of so few triangles")]
            seconds += next_one
            rows.append(_simpler_row(mesh, seconds, reference, doubt, scale, watch))
        except (UsageError, GeometryError) as fault:
            return rows, [Skipped(_coarser(share), fault.sentence)]
        share = mesh.share
        progress(min(1.0, math.log2(share) / levels))
        if rows[-1].reached > _USELESS:
            return rows, []
    return rows, [Skipped(_coarser(share), "they do not fit into the budget", next_one)]


def _coarser(share: int) -> str:
    return f"meshes of about 1/{2 * share} of the triangles and fewer"


def _simpler_row(
    mesh: Simplified, seconds: float, reference: _Answer, doubt: float, scale: _Scale, watch: Stopwatch
) -> PartRow:
    if closure(mesh.surface).open_edges:
        raise GeometryError(f"simplifying to {mesh.surface.count} triangles left the mesh open")
    run = partial(_integrated, mesh.surface, "float64")
    run()
    time, moments = watch.timed(run)
    properties = scale.properties(moments, METHODS["float64"])
    error = scale.error(properties, reference.moments)
    return PartRow(
        method="float64",
        time=time,
        reached=error.worst + doubt,
        triangles=mesh.surface.count,
        simplification=Simplification(mesh.share, float(mesh.tolerance * scale.metres), seconds),
        properties=properties,
        error=error,
        bound=scale.bound(properties),
    )


def _integrated(triangles: Triangles, method: Arithmetic, rounding: Rounding | None = None) -> Moments:
    """Integrate as an analysis does, which begins with the float64 sums whatever method is asked for."""
    return solid_moments(triangles, method, sum_triangles(triangles), rounding=rounding)


def _estimate(part: Part, method: Arithmetic, watch: Stopwatch) -> float:
    """Return the seconds that a method needs for all triangles, as measured on a sample after a first use."""
    triangles = part.triangles
    first = COMPILE_ABOVE if triangles.count >= COMPILE_ABOVE else _SAMPLE
    _integrated(_sample(triangles, first), method, part.rounding)
    sample = _sample(triangles, _SAMPLE)
    seconds, _ = watch.once(partial(_integrated, sample, method, part.rounding))
    return seconds * triangles.count / sample.count


def _sample(triangles: Triangles, count: int) -> Triangles:
    return triangles if triangles.count <= count else triangles.select(np.arange(count))
