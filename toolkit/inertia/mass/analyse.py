"""Part → `Analysis`: check that the question has an answer, integrate, and say what was done.

`analyse` is the verb behind ``inertia analyse``; `mass_properties` returns its central result alone.
"""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from operator import itemgetter
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float, Orientation, Parts, Progress
from inertia.errors import (
    TESSELLATED,
    GeometryError,
    Remedy,
    UsageError,
    Word,
    require_kind,
    reworded,
)
from inertia.estimate import is_number, uncertainty_of, written
from inertia.mass.density import Densities, densities
from inertia.mass.integration import Integral, cell_integrals, surface_integrals, wire_integrals
from inertia.mass.moments import dyadic
from inertia.mass.principal import CLASS_TOLERANCE, require_tolerance
from inertia.mass.properties import MassProperties
from inertia.mass.small import small_properties
from inertia.mass.tensor import exact_point
from inertia.mass.triangles.arithmetic import FINEST
from inertia.mesh.checks.findings import Finding
from inertia.mesh.external.memory import require_memory
from inertia.mesh.geometry.simple import MOST
from inertia.mesh.part import Cells, Part
from inertia.mesh.surface import Facets, Surface
from inertia.once import checking_once

if TYPE_CHECKING:
    from inertia.mesh.external.shuffle import DaskWorkers  # seldom needed

from inertia.mass.allowance import allowing, with_allowance
from inertia.mass.analysis import Accuracy, Analysis
from inertia.mass.weighed import Weighed, doubted, good_enough

_ANALYSE = Remedy("analyse")
_COARSE = 1e-5  # of the size of a part: what coordinates lie apart, in single precision, from which on it is said


def mass_properties(
    part: Part,
    density: float | Mapping[str, float] | None = None,
    *,
    material: str | Mapping[str, str] | None = None,
    mass: float | None = None,
    accuracy: Accuracy = None,
    shell: float | None = None,
    wire: float | None = None,
    orientation: Orientation = "stored",
    intersections: bool | None = None,
    union: bool = False,
    parts: Parts = "together",
    allow_faults: float | None = None,
    tessellated: bool = False,
) -> MassProperties:
    """Integrate a part to its mass, centre of mass and inertia tensor.

    A closed surface is a solid: V = ∮ x·n dA/3 and its moments, by the divergence theorem over the triangles about
    a local origin (see `inertia.mass.triangles.sums`). A volume mesh is integrated cell by cell by the exact quadrature
    of each cell's map. A part with a true shape (STEP) is integrated on its own faces (see `inertia.mass.shapes`).

    Parameters
    ----------
    part : what `inertia.read` returned
    density : kg/m³, or one for each region by name, or for each body of a surface by number ("1", "2", ... in file
        order); "" is the rest; 1000 if neither it nor `material` nor `mass` is given
    material : name(s) in the table of materials, instead of density
    mass : kg, the total weighed; densities then count as proportions
    accuracy : None for float64 with its bound, and more digits only where the volume or a principal moment is not
        certain to a part in 10⁹; or "exact"; or a relative figure that the bounds of volume, mass, tensor and, over the
        size of the part, of `center_of_mass_pair` must reach, by the cheapest method that reaches it
    shell : thickness in the part's unit: the surface itself carries the mass (it may be open)
    wire : cross-section in the part's unit squared: the lines carry the mass
    orientation : "absolute" integrates an inward surface as if it faced outward
    intersections : whether to look for triangles of a solid that cross one another, and refuse it then; without it, up
        to 200,000 triangles are looked through
    union : whether to integrate the union of the bodies, and of each shell with itself: all places of winding number 1
        or more, each once (see `inertia.unite`)
    parts : "separate" integrates each body by itself, also where bodies share space, which then is in the bounds
    allow_faults : relative figure, between 0 and 1, that the bounds of volume, mass, tensor and, over the size of the
        part, centre of mass may reach for faults of the mesh (open, wound inconsistently, overlapping): they cover
        what the faults leave open (see `inertia.mass.faults`), and a part of which that is more is refused;
        `accuracy` is then that of the arithmetic alone
    tessellated : whether to integrate the triangles of a part that has a true shape, in its place

    Raises
    ------
    GeometryError : the surface is open, wound inconsistently, inward, overlaps, has no volume, ...
    UsageError : an argument is not usable

    >>> import inertia
    >>> cube = inertia.Part.from_arrays(
    ...     [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]],
    ...     [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
    ...      [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])
    >>> inertia.mass_properties(cube, 6.0).inertia.tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    plain = mass is None and accuracy is None and shell is None and wire is None and allow_faults is None
    if plain and not union and orientation == "stored" and parts == "together" and isinstance(part, Part):
        properties = _of_small_solid(part, density, material)
        if properties is not None:
            return properties
    return analyse(
        part,
        density,
        material=material,
        mass=mass,
        accuracy=accuracy,
        shell=shell,
        wire=wire,
        orientation=orientation,
        intersections=intersections,
        union=union,
        parts=parts,
        allow_faults=allow_faults,
        tessellated=tessellated,
    ).properties


def _of_small_solid(
    part: Part, density: float | Mapping[str, float] | None, material: str | Mapping[str, str] | None
) -> MassProperties | None:
    """Return the properties of a small surface in memory of one density; None where nothing is known at once."""
    surface = part.geometry
    if type(surface) is not Surface or surface.count > MOST or part.rounding is not None or part.shape is not None:
        return None
    stated = densities(density, material)
    if stated.named or type(stated.default) is not float:
        return None
    return small_properties(surface, part.unit, stated.default)


@checking_once()
def analyse(
    part: Part,
    density: float | Mapping[str, float] | None = None,
    *,
    material: str | Mapping[str, str] | None = None,
    mass: float | None = None,
    accuracy: Accuracy = None,
    shell: float | None = None,
    wire: float | None = None,
    orientation: Orientation = "stored",
    intersections: bool | None = None,
    union: bool = False,
    parts: Parts = "together",
    allow_faults: float | None = None,
    tessellated: bool = False,
    about: ArrayLike | Sequence[Fraction] | None = None,
    class_tolerance: float | None = None,
    chord: float | None = None,
    sigma: float | None = None,
    scale: float | None = None,
    coverage: float | None = None,
    memory: float | None = None,
    dask: str | None = None,
    progress: Progress | None = None,
) -> Analysis:
    """Integrate a part and gather what a report states; parameters as for `mass_properties`, and these.

    A density, mass, thickness or cross-section given as an `Estimate` is uncertain, and so are then the results; see
    `inertia.mass.uncertainty`.

    Parameters
    ----------
    about : (3,) a further point, in the part's unit, for the tensor; `Fraction` coordinates count as they are
    class_tolerance : relative tolerance within which principal moments count as equal: 1e-6, or the bound on the
        tensor that follows from the chord tolerance of a reader whose triangles are integrated
    chord : the tolerance that the mesh was made with, in the part's unit: how far the true surface may be from it;
        without it, what the reader states that made the triangles (`Part.chord`)
    sigma : standard deviation of each coordinate of each vertex, in the part's unit, independent of all others
    scale : 1 with the standard uncertainty of a factor common to all coordinates, as ``Estimate(1, 0.001)``
    coverage : the factor k of the expanded uncertainties that are stated beside the standard ones
    memory : bytes that this process may take. A part that takes more is integrated and checked piece by piece, with
        temporary files where these do not fit either (TMPDIR names their place): a solid or a shell of one density, of
        a binary STL file, or of a binary PLY file of triangles that was read with the same limit. Triangles that cross
        are not looked for then
    dask : address of a Dask scheduler whose workers do that, all of which can read the file by its path; "local" for
        one in this process
    progress : called with the fraction done
    """
    require_kind(part, Part, "part", "inertia.read(path)")
    stated = densities(density, material, mass)
    cells = isinstance(part.geometry, Cells)
    exact = not cells and wire is None and shell is None and (tessellated or part.shape is None)
    _require_accuracy(accuracy, exact=exact)
    if class_tolerance is not None:
        require_tolerance(class_tolerance)
    point = None if about is None else exact_point(about, "about")
    if orientation not in ("stored", "absolute"):
        raise UsageError(f"orientation is {orientation!r}: use 'stored' or 'absolute'")
    if parts not in ("together", "separate"):
        raise UsageError(f"parts is {parts!r}: use 'together' or 'separate'")
    if parts == "separate" and union:
        raise UsageError("both separate bodies and their union are asked for: give one")
    if shell is not None and wire is not None:
        raise UsageError("both a shell and a wire are asked for: give one")
    if accuracy == "exact" and (wire is not None or cells):
        raise UsageError("exact arithmetic is for triangle surfaces: give a relative accuracy for cells and wires")

    if chord is not None and (shell is not None or wire is not None or isinstance(part.geometry, Cells)):
        raise UsageError("a chord tolerance bounds the error of the surface of a solid only: leave it out")
    if chord is not None and not (is_number(chord) and 0 < chord < math.inf):
        raise UsageError(f"the chord tolerance is {chord!r}: it must be positive and finite")
    _require_uncertain(part, sigma, scale, coverage)
    if union:
        if shell is not None or wire is not None or isinstance(part.geometry, Cells):
            raise UsageError("a union is one of the solids that a surface bounds: leave it out")
        if orientation == "absolute":
            raise UsageError("a union and an absolute orientation are two answers to one question: give one")
    if tessellated:
        part = replace(part, shape=None)
    if allow_faults is not None:
        from inertia.mass.faults import require_allowance  # it mends: slow to import, and seldom needed

        require_allowance(allow_faults)
        if shell is not None or wire is not None:
            carrier = Remedy("analyse", "shell") if shell is not None else Remedy("analyse", "wire")
            raise UsageError(
                f"faults are allowed for in the surface of a solid only, and a {carrier.argument} is none: leave ",
                Remedy("analyse", "allow_faults"),
                " or ",
                carrier,
                " out",
            )

    if memory is not None:
        require_memory(memory)
    limit = math.inf if memory is None and dask is not None else memory
    if limit is not None:
        from inertia.mass.external import answered_at_once, require_external

        if dask is None and answered_at_once(part, limit):
            limit = None
        else:
            asked = {
                "densities by name": bool(stated.named),
                "what carries the mass as a wire": wire is not None,
                "a search for crossings": intersections is True,
                "a union": union,
                "separate bodies": parts == "separate",
                "an absolute orientation": orientation == "absolute",
                "an allowance for faults": allow_faults is not None,
                "a chord tolerance": chord is not None,
                "the uncertainty of each vertex": sigma is not None,
            }
            require_external(part, limit, [words for words, given in asked.items() if given])

    workers: DaskWorkers | None = None

    def answer(part: Part, parts: Parts, doubts: tuple[Finding, ...] = (), allowance: float = 0.0) -> Analysis:
        return _answer(
            part,
            stated,
            accuracy=accuracy,
            shell=shell,
            wire=wire,
            orientation=orientation,
            intersections=intersections,
            union=union,
            parts=parts,
            point=point,
            class_tolerance=class_tolerance,
            chord=chord,
            sigma=sigma,
            scale=scale,
            coverage=coverage,
            progress=progress,
            doubts=doubts,
            allowance=allowance,
            faults_apart=allow_faults is not None,
            memory=limit,
            workers=workers,
        )

    if dask is not None:
        from inertia.mesh.external.shuffle import DaskWorkers, StoredTriangles
        from inertia.scheduler import connected

        file = StoredTriangles.of(part)
        with connected(dask, os.cpu_count() or 1) as client:
            workers = DaskWorkers(client, file)
            return answer(part, parts)
    if limit is not None or shell is not None or wire is not None or isinstance(part.geometry, Cells):
        return answer(part, parts)
    if allow_faults is None:
        try:
            return answer(part, parts)
        except GeometryError as fault:
            raise with_allowance(part, parts, answer, fault, alike=not stated.named) from None
    return allowing(part, parts, answer, allow_faults, alike=not stated.named)


def _coarse(part: Part, extents: Float) -> tuple[str, ...]:
    """Say that single precision leaves few digits to the shape of a part far from the origin, where it does."""
    if not isinstance(part.geometry, Facets):
        return ()
    low, high = extents.tolist()
    farthest, size = max(map(abs, (*low, *high))), max(b - a for a, b in zip(low, high, strict=True))
    with np.errstate(over="ignore"):
        step = float(np.spacing(np.float32(farthest)))
    if not step > _COARSE * size:
        return ()
    unit = part.unit.name
    return (
        f"stored in single precision {farthest:.3g} {unit} from the origin, where coordinates are {step:.2g} {unit} "
        f"apart, {step / size:.1g} of its size: export it nearer to the origin, or with more digits",
    )


def _answer(
    part: Part,
    stated: Densities,
    *,
    accuracy: Accuracy,
    shell: float | None,
    wire: float | None,
    orientation: Orientation,
    intersections: bool | None,
    union: bool,
    parts: Parts,
    point: list[Fraction] | None,
    class_tolerance: float | None,
    chord: float | None,
    sigma: float | None,
    scale: float | None,
    coverage: float | None,
    progress: Progress | None,
    doubts: tuple[Finding, ...],
    allowance: float,
    faults_apart: bool,
    memory: float | None,
    workers: DaskWorkers | None,
) -> Analysis:
    """Return the analysis of a part as it is; parameters as for `analyse`, and these.

    Parameters
    ----------
    doubts : what is in doubt of the part before it is integrated
    allowance : volume, in the part's unit, that a shell may enclose twice and be in doubt only
    faults_apart : whether doubts count for the accuracy that is asked for
    memory : bytes within which the part is integrated and checked piece by piece
    workers : who does that
    """
    united = origin = None
    if union:
        from inertia.mass.union import united_for

        if chord is not None:  # before it is united, as what is hidden is off as well
            part = _off_by(part, chord)
        united, stated = united_for(part, stated, _part_of(progress, 0.0, 0.8))
        origin = None if united.origins is None else (part, united.origins)
        part, progress = united.part, _part_of(progress, 0.8, 1.0)
    f = part.unit.metres
    model, factor, integrals = _integrals(
        part,
        stated.named,
        accuracy=accuracy,
        shell=shell,
        wire=wire,
        absolute=orientation == "absolute",
        intersections=intersections,
        parts=parts,
        chord=None if union else chord,
        allowance=allowance,
        memory=memory,
        workers=workers,
        progress=progress,
    )
    integrals = (replace(integral, doubts=(*doubts, *integral.doubts)) for integral in integrals)

    limit = None if accuracy is None or isinstance(accuracy, str) else accuracy
    weighed = (Weighed(part, integral, stated, factor) for integral in integrals)
    answer = good_enough(weighed, limit, allowed=faults_apart)
    integral, properties = answer.integral, answer.properties
    reached = answer.undoubted if faults_apart else answer
    if limit is not None and (missed := max(reached.bounds.items(), key=itemgetter(1)))[1] > limit:
        quantity, bound = missed
        raise GeometryError(
            f"{part.name}: the bound of the {quantity} reached by {integral.method} is {bound:.2g}, above the accuracy "
            f"asked for, {accuracy:g}{_rounded(part, integral)}",
            *doubted(answer),
            ": ask for a larger figure",
            code="accuracy",
        )
    tolerance = part.chord if chord is None or union else float(chord)
    if model != "solid" or integral.shape is not None:
        tolerance = None
    tessellation = None if tolerance is None else answer.tessellation(tolerance)
    if class_tolerance is None:  # what the reader's own triangles blur is no property of the body
        blur = tessellation.inertia if tessellation is not None and chord is None else 0.0
        class_tolerance = min(max(CLASS_TOLERANCE, blur), 0.5)
    there = about_bound = None
    if point is not None:
        tensor, about_bound = properties.about_with_bound([k * f for k in point])
        there = tuple(map(float, point)), tensor
    analysis = Analysis(
        part=part,
        model=model,
        density=float(answer.mean_density),
        density_from=stated.source,
        triangles=integral.triangles,
        cells=integral.cells,
        closed=integral.closed,
        bodies=integral.bodies,
        area=float(Fraction(integral.area) * f**2),
        extents=_scaled(integral.extents, f),
        properties=properties,
        tessellation=tessellation,
        repair=None if part.filling is None or model != "solid" or faults_apart else answer.repair(),
        accuracy=accuracy,
        class_tolerance=class_tolerance,
        shares=answer.shares() if len(integral.groups) > 1 else (),
        about=there,
        about_bound=about_bound,
        notes=(*part.notes, *_coarse(part, integral.extents), *integral.notes),
        crossings_examined=integral.crossings_examined or united is not None,
        doubts=integral.doubts,
        union=united,
        shape=integral.shape,
        integrand=replace(answer.integrand(model), origin=origin),
    )
    thickness = shell if shell is not None else wire
    named = *stated.named.values(), stated.default, stated.mass, thickness, scale
    if not sigma and not any(map(uncertainty_of, named)):
        if coverage is not None:
            raise UsageError(
                "expanded uncertainties are asked for, and no input is uncertain: give one with its own",
            )
        return analysis
    from inertia.mass.uncertainty import standard_uncertainty

    uncertainty = standard_uncertainty(
        analysis.integrand,
        analysis.principal,
        stated,
        sigma=sigma or 0.0,
        scale=uncertainty_of(scale),
        thickness=uncertainty_of(thickness) / thickness if thickness else 0.0,
        coverage=coverage,
    )
    return replace(analysis, uncertainty=uncertainty)


def _integrals(
    part: Part,
    named: Mapping[str, float],
    *,
    accuracy: Accuracy,
    shell: float | None,
    wire: float | None,
    absolute: bool,
    intersections: bool | None,
    parts: Parts,
    chord: float | None,
    allowance: float,
    memory: float | None,
    workers: DaskWorkers | None,
    progress: Progress | None,
) -> tuple[Literal["solid", "shell", "wire"], Fraction, Iterator[Integral]]:
    """Return what carries the mass, the volume (m³) of a unit of its integrals, and these, ever more accurate."""
    volume = part.unit.metres**3
    if wire is not None:
        factor = volume * _length(wire, "wire cross-section", f"{part.unit.name}²")
        return "wire", factor, wire_integrals(part, named, progress)
    model: Literal["solid", "shell"] = "solid"
    if shell is not None:
        model, volume = "shell", volume * _length(shell, "shell thickness", part.unit.name)
    if part.shape is not None:
        from inertia.mass.shapes.integral import shape_integrals

        if chord is not None:
            raise UsageError(
                "a chord tolerance is one of triangles, and the true shape is integrated: leave it out, or use ",
                TESSELLATED,
            )
        if isinstance(accuracy, str):
            raise UsageError(
                "exact arithmetic is for triangle surfaces, and the true shape is integrated: give a relative "
                "accuracy, or use ",
                TESSELLATED,
            )
        return (
            model,
            volume,
            shape_integrals(
                part,
                named,
                shell=shell is not None,
                accuracy=accuracy,
                absolute=absolute,
                intersections=intersections,
                parts=parts,
                progress=progress,
            ),
        )
    if memory is not None:
        from inertia.mass.external import external_integrals

        streamed = external_integrals(
            part, memory, shell=shell is not None, accuracy=accuracy, workers=workers, progress=progress
        )
        return model, volume, streamed
    if shell is not None:
        return model, volume, surface_integrals(part, named, shell=True, accuracy=accuracy, progress=progress)
    if isinstance(part.geometry, Cells):
        return model, volume, cell_integrals(part, named, intersections=intersections, progress=progress)
    if chord is not None:
        part = _off_by(part, chord)
    solid = surface_integrals(
        part,
        named,
        accuracy=accuracy,
        absolute=absolute,
        intersections=intersections,
        parts=parts,
        allowance=allowance,
        progress=progress,
    )
    return model, volume, solid


def _off_by(part: Part, chord: float) -> Part:
    """Return a part whose triangles are off by up to a length in its unit."""
    return replace(part, chord=np.full(part.triangles.count, float(chord)))


@contextmanager
def sound_solids_only(why: str, but: Collection[str] = ()) -> Iterator[None]:
    """Say of the remedies that `analyse` has, and what is done within has not, that they belong there, and why.

    What is done within has the arguments `but` too: beside one of these, what belongs to `analyse` is named.
    """
    try:
        yield
    except GeometryError as error:
        foreign = [k for k in error.remedies if k.verb in ("analyse", "repair", "weld") and k.argument not in but]
        if not foreign:
            raise
        named: tuple[Word, ...] = ()
        if any(k.argument in but for k in error.remedies):
            named = (foreign[0], *(word for each in foreign[1:] for word in (" and ", each)), " ")
        raise reworded(error, (*error.words, " (", *named, "with ", _ANALYSE, f": {why})"), error.places) from None


def _part_of(progress: Progress | None, start: float, stop: float) -> Progress | None:
    return None if progress is None else lambda done: progress(start + done * (stop - start))


def _scaled(values: Float, factor: Fraction) -> Float:
    """Return values times a rational, each rounded once."""
    numerators, d = dyadic(values.ravel().tolist())
    return np.array([k * factor.numerator / (d * factor.denominator) for k in numerators]).reshape(values.shape)


def _rounded(part: Part, integral: Integral) -> str:
    if integral.shape is not None:
        if not integral.shape.loose:
            return ""
        return f" (the faces of the shape are up to {integral.shape.gap:.2g} {part.unit.name} apart at their edges)"
    if part.rounding is None:
        return ""
    return (
        f" (the file's decimals were rounded by up to {part.rounding.distance:.2g} {part.unit.name} when it was read)"
    )


def _require_accuracy(accuracy: Accuracy, *, exact: bool) -> None:
    """Raise `UsageError` for what is no accuracy; `exact` says whether there is an exact answer to ask for."""
    if accuracy is None or accuracy == "exact":
        return
    if not is_number(accuracy) or not 0 < accuracy < math.inf:
        raise UsageError(f"accuracy is {accuracy!r}: give a positive relative figure such as 1e-12, or 'exact'")
    if accuracy < FINEST:
        raise UsageError(
            f"accuracy is {accuracy:g}, finer than results in float64 can be, {FINEST:g}: "
            + ("ask for 'exact', which rounds each number once" if exact else "give a larger figure")
        )


def _require_uncertain(part: Part, sigma: float | None, scale: float | None, coverage: float | None) -> None:
    """Raise `UsageError` where what is said to be uncertain cannot be."""
    if sigma is not None and not (is_number(sigma) and 0 < sigma < math.inf):
        raise UsageError(f"sigma is {written(sigma)} {part.unit.name}: it must be positive and finite")
    if sigma is not None and (part.shape is not None or part.chord is not None):
        raise UsageError(
            f"the vertices of {part.name} were made from its true shape when it was read, and have no noise of their "
            "own: give the uncertainty of its scale, density or mass"
        )
    if scale is not None and (not is_number(scale) or scale != 1):
        raise UsageError(
            f"the scale is {written(scale)}: coordinates are taken as stored, so that it is 1 with an uncertainty, as "
            "1±0.001"
        )
    if coverage is not None and not (is_number(coverage) and 0 < coverage < math.inf):
        raise UsageError(f"the coverage factor is {written(coverage)}: it must be positive and finite, as 2")


def _length(value: float, name: str, unit: str) -> Fraction:
    if not (is_number(value) and 0 < value < math.inf):
        raise UsageError(f"the {name} is {written(value)} {unit}: it must be positive and finite")
    return Fraction(float(value))
