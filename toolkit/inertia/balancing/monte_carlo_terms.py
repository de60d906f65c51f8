"""Tolerances of a rotor and of the shop's work on it, as terms of `inertia.balancing.monte_carlo`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import fields

import numpy as np

from inertia.arrays import Float
from inertia.balancing.bounds import Uncertainty
from inertia.balancing.corrections.drilling import axial_volume, radial_unbalance
from inertia.balancing.corrections.milling import arc_unbalance, flat_unbalance
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.monte_carlo import Term
from inertia.balancing.tolerance import Planes, Tolerance
from inertia.balancing.unbalance import Complex, Unbalance, plane_weights
from inertia.records import dataclass

_AXIS = ("axis at bearing A", "axis at bearing B", "axis tilt, uneven transverse moments")


@dataclass(frozen=True)
class Spread:
    """Half-widths of a tolerance: of what operations have in common, and of what each has by itself.

    With `rayleigh` they are standard deviations, in each of two directions.
    """

    common: float = 0.0
    separate: float = 0.0
    rayleigh: bool = False

    @property
    def total(self) -> float:
        """The most that a single operation may be off by."""
        return self.common + self.separate


@dataclass(frozen=True)
class ShopTolerance:
    """What the shop holds, as half-widths; 0 for what is exact.

    What is common is drawn once for all operations that share it: depth and diameter for those of one tool, radius, z
    and arc for those in one plane, the angle, which is that of the zero mark, for all of them, the mass for
    equal weights.

    Attributes
    ----------
    depth, diameter, radius, z : m
    angle : rad
    mass : relative, of a weight
    arc : rad, of the length of an arc
    """

    depth: Spread = Spread(common=1e-4)
    diameter: Spread = Spread(common=5e-5)
    radius: Spread = Spread(common=1e-4)
    z: Spread = Spread(common=1e-4)
    angle: Spread = Spread(common=math.radians(0.5))
    mass: Spread = Spread(separate=0.005)
    arc: Spread = Spread(common=math.radians(0.5))

    @property
    def separately(self) -> ShopTolerance:
        """The same with nothing in common: every operation has terms of its own."""
        return ShopTolerance(**{k.name: Spread(separate=getattr(self, k.name).total) for k in fields(self)})


_STEPS = {
    "depth": (1e-4, "0.1 mm"),
    "diameter": (1e-5, "0.01 mm"),
    "radius": (1e-4, "0.1 mm"),
    "z": (1e-4, "0.1 mm"),
    "angle": (math.radians(1.0), "1°"),
    "arc": (math.radians(1.0), "1°"),
    "mass": (0.01, "1 %"),
}


def rotor_terms(rotor: Unbalance, zs: Planes, tolerance: Tolerance | None = None) -> tuple[Term, ...]:
    """Return the terms of a rotor's own uncertainties: inputs, densities, axis, tessellation and arithmetic.

    An input with a standard uncertainty is normal, in as many terms as it has ways to move the unbalance. A density is
    uniform over its tolerance, a bearing centre over its disc. A bound (tessellation, arithmetic) is taken as a disc of
    that radius in each plane, all at once in one direction, as nothing is known of how its parts combine.

    Parameters
    ----------
    rotor : with its uncertainties
    zs : (A, B) m, the tolerance planes
    tolerance : whose limits, where they follow the mass, bounds stand beside
    """
    p, q = plane_weights(rotor.z, zs)
    if tolerance is None:
        bounds = [
            tuple(k.bound(*weight) for weight in zip(p.tolist(), q.tolist(), strict=True)) for k in rotor.uncertainties
        ]
    else:
        bounds = [*tolerance.apart(rotor, zs)]
    return tuple(
        term
        for uncertainty, bound in zip(rotor.uncertainties, bounds, strict=True)
        for term in _of_source(uncertainty, p, q, np.array(bound, dtype=np.complex128))
    )


def operation_terms(
    operations: Sequence[Operation], rotor: Unbalance, zs: Sequence[float], shop: ShopTolerance
) -> tuple[Term, ...]:
    """Return the terms of the shop's work: depth, diameter, radius, place, angle and mass.

    A part that operations have in common is one term, whose sensitivities are the sums of theirs. The unbalance
    taken is f(depth, diameter, radius), whose derivatives are central differences over the tolerance.

    Parameters
    ----------
    operations : as planned
    rotor : the rotor that they are done on; only its centre of mass counts
    zs : (k,) m, the tolerance planes
    shop : what is held
    """
    p, q = plane_weights(rotor.z, zs)
    terms = []
    together: dict[tuple[str, str], Complex] = {}
    for work in operations:
        arm = work.unbalance_z - rotor.z
        moved = {"angle": 1j * work.unbalance}
        moved |= {name: work.unbalance * rate for name, rate in _relative_rates(work, shop).items()}
        modes = {name: (vector, vector * arm) for name, vector in moved.items()} | {"z": (0j, work.unbalance)}
        for name, vectors in zip(modes, _in_planes(tuple(modes.values()), p, q), strict=True):
            spread: Spread = getattr(shop, name)
            if spread.common:
                key = (name, _shared(name, work))
                together[key] = together.get(key, np.zeros(len(zs))) + vectors
            if spread.separate:
                terms.append(Term(f"{work.id}: {name}", "uniform", spread.separate, vectors, *_STEPS[name]))
    terms += [
        Term(f"{shared}: {name}", "uniform", getattr(shop, name).common, vectors, *_STEPS[name])
        for (name, shared), vectors in together.items()
    ]
    return tuple(terms)


def _shared(name: str, work: Operation) -> str:
    """Return what an operation has an input in common with others by: the zero mark, its tool, or its plane."""
    if name == "angle":
        return "zero mark"
    if name == "mass" and work.item is not None:
        return f"weights {work.item}"
    if name in ("depth", "diameter") and work.tool_diameter is not None and work.kind != "mill_arc":
        return f"drill Ø{1e3 * work.tool_diameter:.6g}"
    return f"plane {work.plane}"


def _of_source(uncertainty: Uncertainty, p: Float, q: Float, bound: Complex) -> list[Term]:
    cause = uncertainty.cause
    masses = uncertainty.masses or ((0.0, 0.0),) * len(uncertainty.modes)
    if uncertainty.source == "input" or uncertainty.scatters:
        labels = uncertainty.bodies or (uncertainty.source,)
        labels = labels if len(labels) > 1 else labels * len(uncertainty.modes)
        return [
            Term(name, "normal", 1.0, vectors, 1.0, "its u", mass)
            for name, vectors, mass in zip(labels, _in_planes(uncertainty.modes, p, q), masses, strict=True)
        ]
    of_bodies = [f"{uncertainty.source} of {body}" for body in uncertainty.bodies]
    names = of_bodies or [uncertainty.source] * max(1, len(uncertainty.modes))
    if cause and uncertainty.source == "density":
        vectors = _in_planes(uncertainty.modes, p / cause, q / cause)
        return [
            Term(name, "uniform", cause, vector, 0.01, "1 %", (m / cause, s / cause))
            for name, vector, (m, s) in zip(names, vectors, masses, strict=True)
        ]
    if cause and uncertainty.source == "axis":
        return [
            Term(name, "disc", cause, vectors, 1e-5, "0.01 mm")
            for name, vectors in zip(_AXIS, _in_planes(uncertainty.modes, p / cause, q / cause), strict=True)
        ]
    return [Term(names[0], "disc", 1.0, bound, 1.0, "its bound")]


def _in_planes(modes: Sequence[tuple[complex, complex]], p: Float, q: Float) -> Complex:
    """Return what each mode (a change of U and of D) does in each plane, (modes, planes)."""
    vectors: Complex = np.array(modes, dtype=np.complex128).reshape(-1, 2) @ np.stack([p, q])
    return vectors


def _relative_rates(work: Operation, shop: ShopTolerance) -> dict[str, float]:
    """Return (∂U/∂x)/U for each input x of an operation."""
    radius, depth = work.radius, work.depth or 0.0
    diameter, point, width = work.tool_diameter or 0.0, work.point_angle or math.pi, work.width or 0.0
    match work.kind:
        case "drill_radial":
            return {
                "depth": _rate(lambda x: radial_unbalance(1.0, radius, diameter, x, point), depth, shop.depth.total),
                "diameter": _rate(
                    lambda x: radial_unbalance(1.0, radius, x, depth, point), diameter, shop.diameter.total
                ),
            }
        case "drill_axial":
            return {
                "depth": _rate(lambda x: axial_volume(diameter, x, point), depth, shop.depth.total),
                "diameter": _rate(lambda x: axial_volume(x, depth, point), diameter, shop.diameter.total),
                "radius": 1.0 / radius,
            }
        case "mill_flat":
            return {"depth": _rate(lambda x: flat_unbalance(1.0, radius, width, x), depth, shop.depth.total)}
        case "mill_arc":
            arc, cutter = work.arc or 0.0, work.tool_diameter
            return {
                "depth": _rate(lambda x: arc_unbalance(1.0, radius, width, x, arc, cutter), depth, shop.depth.total),
                "arc": _rate(lambda x: arc_unbalance(1.0, radius, width, depth, x, cutter), arc, shop.arc.total),
            }
        case _:
            return {"mass": 1.0, "radius": 1.0 / radius}


def _rate(function: Callable[[float], float], at: float, half_width: float) -> float:
    """Return the logarithmic derivative of a function by a central difference over its tolerance; 0 where it is 0."""
    value = function(at)
    if value == 0.0 or at == 0.0:  # a depth that was rounded to none
        return 0.0
    step = min(half_width, 0.5 * at) or 1e-6 * at
    return (function(at + step) - function(at - step)) / (2.0 * step * value)
