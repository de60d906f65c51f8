"""What each rung answers, and whether its error is within its bound."""

from __future__ import annotations

import math
from fractions import Fraction

import inertia
from inertia.errors import InertiaError
from inertia.mass.moments import Moments, inertia_bound, inertia_tensor
from inertia.mass.properties import MassProperties
from inertia.mass.triangles.arithmetic import METHODS, Arithmetic
from inertia.mesh.part import Part, Source
from inertia.mesh.surface import Triangles
from inertia.units import length_unit

from .answers import Answer
from .truth import Truth

RUNGS: tuple[Arithmetic, ...] = ("float64", "double-double", "exact")


def properties(
    moments: Moments, rung: Arithmetic, metres: Fraction = Fraction(1), density: Fraction = Fraction(1)
) -> MassProperties:
    """Return the mass properties for coordinates in a unit of `metres` and a density in kg/m³."""
    body = moments.in_unit(metres).scaled(metres**3 * density)
    return MassProperties.from_moments(body, body.zeroth / density, body.zeroth_bound / density, rung)


def answer(result: MassProperties) -> Answer:
    """Return the numbers alone."""
    principal = result.principal
    return Answer(result.volume, result.center_of_mass, result.inertia, principal.moments, principal.axes)


def bounds(result: MassProperties, size: float) -> dict[str, float]:
    """Return the bounds in the terms of `truth.errors`."""
    principal = result.principal
    return {
        "volume": result.error.volume,
        "centre": result.error.center_of_mass / size,
        "tensor": result.error.inertia,
        "smallest moment": float(principal.moment_bounds[0] / principal.moments[0]),
    }


def chosen(triangles: Triangles, accuracy: float | None) -> str:
    """Return the rung that runs for an accuracy asked for, or the sentence of the refusal."""
    part = Part(triangles, length_unit("m"), "option", Source("part", "array"))
    try:
        method = inertia.mass_properties(part, density=1.0, accuracy=accuracy).error.method
    except InertiaError as refusal:
        return str(refusal)
    return next((rung for rung, name in METHODS.items() if name == method), method)


def ratios(result: MassProperties, truth: Truth, density: Fraction) -> dict[str, list[float]]:
    """Return bound over error; infinite where there is no error, below 1 where the bound does not hold.

    `truth` has the moments of mass. A bound is relative to the number reported. Of the axes only those count that
    have a bound below a right angle.
    """
    exact, limit, principal = truth.moments, result.error, result.principal
    volume, mass = Fraction(result.volume), Fraction(result.mass)
    tensor = [Fraction(x) for x in result.inertia.ravel().tolist()]
    shift = [Fraction(a) - b for a, b in zip(result.center_of_mass.tolist(), exact.center_of_mass, strict=True)]
    off = [a - b for a, b in zip(tensor, (x for row in exact.inertia for x in row), strict=True)]
    moments, axes = [], []
    for k in range(3):
        error = truth.moment_error(float(principal.moments[k]), k)
        bound = Fraction(float(principal.moment_bounds[k])) / truth.largest
        moments.append(float(bound / error) if error else math.inf)
        if principal.axis_bounds[k] < 0.5 * math.pi:
            angle = truth.angle(principal.axes[:, k].tolist(), k)
            axes.append(float(principal.axis_bounds[k]) / angle if angle else math.inf)
    return {
        "volume": [_ratio((Fraction(limit.volume) * volume) ** 2, (volume - exact.volume / density) ** 2)],
        "mass": [_ratio((Fraction(limit.mass) * mass) ** 2, (mass - exact.volume) ** 2)],
        "centre of mass": [_ratio(Fraction(limit.center_of_mass) ** 2, _squares(shift))],
        "tensor": [_ratio(Fraction(limit.inertia) ** 2 * _squares(tensor), _squares(off))],
        "principal moments": moments,
        "principal axes": axes,
    }


def ratios_before_rounding(moments: Moments, truth: Truth) -> dict[str, list[float]]:
    """Return what `ratios` does for the sums themselves, whose bound the result's own rounding does not hide."""
    volume, limit = moments.zeroth, moments.zeroth_bound
    result = {"volume, before rounding": [_ratio(limit**2, (volume - truth.moments.volume) ** 2)]}
    if abs(volume) > limit:
        central = moments.central()
        pairs = zip(inertia_tensor(central.second), truth.moments.inertia, strict=True)
        off = [a - b for row, true in pairs for a, b in zip(row, true, strict=True)]
        result["tensor, before rounding"] = [_ratio(inertia_bound(central.second_bound) ** 2, _squares(off))]
    return result


def _squares(values: list[Fraction]) -> Fraction:
    return sum((x * x for x in values), Fraction(0))


def _ratio(bound: Fraction, error: Fraction) -> float:
    """Return the root of a ratio of squares, below 1 if and only if the ratio is."""
    if not error:
        return math.inf
    root = math.sqrt(bound / error)
    return max(root, 1.0) if bound >= error else min(root, math.nextafter(1.0, 0.0))
