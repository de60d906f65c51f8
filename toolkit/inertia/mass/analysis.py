"""Part → `Analysis`: check that the question has an answer, integrate, and say what was done.

`analyse` is the verb behind ``inertia analyse``; `mass_properties` returns its central result alone.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float, Orientation, Progress
from inertia.errors import GeometryError, UsageError, require_kind
from inertia.mass.density import Densities, DensityFrom, densities
from inertia.mass.integration import Found, Group, cell_groups, naming, surface_groups, wire_group
from inertia.mass.moments import ZERO, Moments, total
from inertia.mass.principal import CLASS_TOLERANCE, Principal
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.mass.tensor import array_of
from inertia.mass.tessellation import chord_error
from inertia.mass.triangles.arithmetic import FINEST
from inertia.mesh.part import Cells, Part

Accuracy = float | Literal["exact"] | None


@dataclass(frozen=True)
class BodyShare:
    """What one body or region contributes: density kg/m³, volume m³, mass kg, centre of mass (3,) m."""

    name: str
    density: float
    volume: float
    mass: float
    center_of_mass: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Analysis:
    """Everything that a report on one part states; SI units.

    Attributes
    ----------
    part : the part analysed
    model : "solid", "shell" (of `thickness`) or "wire" (of `section`)
    density : kg/m³; the mean where several were given
    density_from : who said so
    triangles, cells : number of elements
    closed : whether the surface bounds a solid
    bodies : number of separate bodies
    area : surface area, m²
    extents : (2, 3) smallest and largest coordinates, m
    properties : `MassProperties`
    tessellation : bounds on what the triangles left out or added, if a chord tolerance was given
    principal : `Principal`, at the tolerance asked for
    shares : one entry a body or region, where there are several densities
    about : (point in the part's unit, tensor about it), if asked for
    notes : what was decided on the way, in sentences
    """

    part: Part
    model: Literal["solid", "shell", "wire"]
    density: float
    density_from: DensityFrom
    triangles: int
    cells: int
    closed: bool
    bodies: int
    area: float
    extents: Float
    properties: MassProperties
    tessellation: ErrorBound | None
    principal: Principal
    shares: tuple[BodyShare, ...]
    about: tuple[tuple[float, ...], Float] | None
    notes: tuple[str, ...]


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
) -> MassProperties:
    """Integrate a part to its mass, centre of mass and inertia tensor.

    A closed surface is a solid: V = ∮ x·n dA/3 and its moments, by the divergence theorem over the triangles about
    a local origin (see `inertia.mass.triangles.sums`). A volume mesh is integrated cell by cell by the exact quadrature
    of each cell's map.

    Parameters
    ----------
    part : what `inertia.read` returned
    density : kg/m³, or one for each region by name, or for each body of a surface by number ("1", "2", ... in file
        order); "" is the rest; 1000 if neither it nor `material` nor `mass` is given
    material : name(s) in the table of materials, instead of density
    mass : kg, the total weighed; densities then count as proportions
    accuracy : None for float64 with its bound, and more digits only where the volume or a slender solid's smallest
        principal moment would drown; a relative figure that the bound must reach, by the cheapest method that reaches
        it; or "exact"
    shell : thickness in the part's unit: the surface itself carries the mass (it may be open)
    wire : cross-section in the part's unit squared: the lines carry the mass
    orientation : "absolute" integrates an inward surface as if it faced outward

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
    return analyse(
        part,
        density,
        material=material,
        mass=mass,
        accuracy=accuracy,
        shell=shell,
        wire=wire,
        orientation=orientation,
    ).properties


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
    about: ArrayLike | None = None,
    class_tolerance: float = CLASS_TOLERANCE,
    chord: float | None = None,
    progress: Progress | None = None,
) -> Analysis:
    """Integrate a part and gather what a report states; parameters as for `mass_properties`, and these.

    Parameters
    ----------
    about : (3,) a further point, in the part's unit, for the tensor
    class_tolerance : relative tolerance within which principal moments count as equal
    chord : the tolerance that the mesh was made with, in the part's unit: how far the true surface may be from it
    progress : called with the fraction done
    """
    require_kind(part, Part, "part", "inertia.read(path)")
    chosen = densities(density, material, mass)
    _require_accuracy(accuracy)
    if not 0 <= class_tolerance < 1:
        raise UsageError(f"the class tolerance is {class_tolerance!r}: it must be at least 0 and below 1")
    point = None if about is None else array_of(about, (3,), "about")
    if orientation not in ("stored", "absolute"):
        raise UsageError(f"orientation is {orientation!r}: use 'stored' or 'absolute'")
    if shell is not None and wire is not None:
        raise UsageError("both a shell and a wire are asked for: give one")
    if accuracy == "exact" and (wire is not None or isinstance(part.geometry, Cells)):
        raise UsageError("exact arithmetic is for triangle surfaces: give a relative accuracy for cells and wires")

    if chord is not None and (shell is not None or wire is not None or isinstance(part.geometry, Cells)):
        raise UsageError("a chord tolerance bounds the error of the surface of a solid only: leave it out")

    f = part.unit.metres
    model: Literal["solid", "shell", "wire"] = "solid"
    factor = f**3
    if shell is not None:
        model, factor = "shell", f**3 * _length(shell, "shell thickness", part.unit.name)
        found = surface_groups(part, chosen.named, shell=True, accuracy=accuracy, progress=progress)
    elif wire is not None:
        model, factor = "wire", f**3 * _length(wire, "wire cross-section", f"{part.unit.name}2")
        found = wire_group(part, chosen.named, progress)
    elif isinstance(part.geometry, Cells):
        found = cell_groups(part, chosen.named, progress=progress)
    else:

        def enough(found: Found) -> bool:
            properties = _properties(part, found, chosen, factor)
            return _reached(properties, found, f) <= _figure(accuracy) and not properties.loses_smallest_moment

        found = surface_groups(
            part,
            chosen.named,
            accuracy=accuracy,
            reached=enough,
            absolute=orientation == "absolute",
            progress=progress,
        )

    weights = _weights(found.groups, chosen, factor)
    moments, volume, _ = _moments(part, found, chosen, factor)
    properties = _properties(part, found, chosen, factor)
    if (reached := _reached(properties, found, f)) > _figure(accuracy):
        raise GeometryError(
            f"{part.name}: the bound reached by {found.method} is {reached:.2g}, above the accuracy asked for, "
            f"{accuracy:g}: ask for a larger figure"
        )
    return Analysis(
        part=part,
        model=model,
        density=float(_mean(weights, found.groups)),
        density_from=chosen.source,
        triangles=found.triangles,
        cells=found.cells,
        closed=found.closed,
        bodies=found.bodies,
        area=_area(found.area, f),
        extents=np.array([[float(Fraction(float(x)) * f) for x in row] for row in found.extents]),
        properties=properties,
        tessellation=None
        if chord is None
        else chord_error(part, chord, moments, volume, max(weights), None if chosen.mass is None else moments.zeroth),
        principal=properties.principal_within(class_tolerance),
        shares=_shares(found.groups, weights, factor, f) if len(found.groups) > 1 else (),
        about=None if point is None else (tuple(point.tolist()), _about(properties, point, f)),
        notes=(*part.notes, *found.notes),
    )


def _require_accuracy(accuracy: Accuracy) -> None:
    if accuracy is None or accuracy == "exact":
        return
    if not isinstance(accuracy, Real) or not 0 < accuracy < math.inf:
        raise UsageError(f"accuracy is {accuracy!r}: give a positive relative figure such as 1e-12, or 'exact'")
    if accuracy < FINEST:
        raise UsageError(
            f"accuracy is {accuracy:g}, finer than results in float64 can be, {FINEST:g}: ask for 'exact', which "
            "rounds each number once"
        )


def _figure(accuracy: Accuracy) -> float:
    """Return the relative accuracy asked for, as a number."""
    return math.inf if accuracy is None or isinstance(accuracy, str) else accuracy


def _moments(part: Part, found: Found, chosen: Densities, factor: Fraction) -> tuple[Moments, Fraction, Fraction]:
    """Return the moments of mass (kg, m), the volume and its bound (m³)."""
    weights = _weights(found.groups, chosen, factor)
    moments = total(
        group.moments.in_unit(part.unit.metres).scaled(factor * weight)
        for group, weight in zip(found.groups, weights, strict=True)
    )
    if chosen.mass is not None and moments.zeroth > moments.zeroth_bound:
        moments = moments.weighed(Fraction(chosen.mass))
    volume = factor * sum((group.moments.zeroth for group in found.groups), ZERO)
    volume_bound = factor * sum((group.moments.zeroth_bound for group in found.groups), ZERO)
    return moments, volume, volume_bound


def _properties(part: Part, found: Found, chosen: Densities, factor: Fraction) -> MassProperties:
    with naming(part):
        return MassProperties.from_moments(*_moments(part, found, chosen, factor), found.method)


def _reached(properties: MassProperties, found: Found, f: Fraction) -> float:
    """Return the largest relative bound; the centre of mass counts relative to the size of the part."""
    error = properties.error
    size = float(Fraction(float(np.ptp(found.extents, axis=0).max())) * f)
    return max(error.volume, error.mass, error.inertia, error.center_of_mass / size)


def _mean(weights: Sequence[Fraction], groups: Sequence[Group]) -> Fraction:
    volume = sum((group.moments.zeroth for group in groups), ZERO)
    return sum((w * g.moments.zeroth for w, g in zip(weights, groups, strict=True)), ZERO) / volume


def _length(value: float, name: str, unit: str) -> Fraction:
    if not (isinstance(value, Real) and 0 < value < math.inf):
        raise UsageError(f"the {name} is {value!r} {unit}: it must be positive and finite")
    return Fraction(float(value))


def _weights(groups: Sequence[Group], chosen: Densities, factor: Fraction) -> list[Fraction]:
    """Return the density of each group, kg/m³; a weighed mass scales them all."""
    weights = [Fraction(chosen.of(group.name)) for group in groups]
    if chosen.mass is not None:
        mass = factor * sum((w * g.moments.zeroth for w, g in zip(weights, groups, strict=True)), ZERO)
        if mass <= 0:
            raise GeometryError("the solid has no volume to spread the mass over: check the mesh")
        weights = [w * Fraction(chosen.mass) / mass for w in weights]
        if max(weights) > sys.float_info.max:
            raise UsageError(f"a mass of {chosen.mass:g} kg makes a density above 1.8e308 kg/m3: check mass and unit")
    return weights


def _shares(
    groups: Sequence[Group], weights: Sequence[Fraction], factor: Fraction, f: Fraction
) -> tuple[BodyShare, ...]:
    shares = []
    for group, weight in zip(groups, weights, strict=True):
        volume = factor * group.moments.zeroth
        x, y, z = (float(f * k) for k in group.moments.centroid)
        shares.append(BodyShare(group.name, float(weight), float(volume), float(weight * volume), (x, y, z)))
    return tuple(shares)


def _area(area: float, f: Fraction) -> float:
    return float(Fraction(area) * f**2)


def _about(properties: MassProperties, point: Float, f: Fraction) -> Float:
    return properties.about([float(Fraction(k) * f) for k in point.tolist()])
