"""With how many decimals the work of the shop is printed, wherever it is: what is printed is what is planned.

A figure that is set in steps, or that the user gave, has the decimals that it takes. One without a step would take all
of a float: it has so many that a rotor worked on as printed keeps its verdict.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import fields

import numpy as np

from inertia.balancing.balance import Balance
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.machine_angles import MachineAngles
from inertia.balancing.shop_units import decimals_needed
from inertia.balancing.unbalance import plane_weights
from inertia.balancing.verdict import PlaneVerdict
from inertia.records import dataclass

_SHARE = 0.01  # of the limit: no more of it may be lost by printing
_FIGURES = 4  # of an operation: depth or mass, radius, angle, ends of an arc
_STEEPEST = 1.5  # dln U/dln depth of a flat; of holes and arcs it is 1 at most
_LEAST = 1e-300  # kg m


@dataclass(frozen=True)
class ShopDigits:
    """Decimals that the figures of all work take; a place that prints more of one does so.

    Attributes
    ----------
    depth, place, tool : of mm: depths, radii and places along the shaft, diameters and widths
    angle, ends : of degrees: where work is done, and where arcs begin and end
    mass : of g, of masses that are weighed
    """

    depth: int = 0
    place: int = 0
    tool: int = 0
    angle: int = 0
    ends: int = 0
    mass: int = 0


def shop_digits(balance: Balance, machine: MachineAngles | None = None) -> ShopDigits:
    """Return the decimals of the work on a rotor.

    Parameters
    ----------
    balance : what `inertia.balance` returned
    machine : how angles are counted where the work is done; as in the rotor file without it
    """
    works = () if balance.correction is None else balance.correction.operations
    if not works:
        return ShopDigits()
    lost = min(map(_to_lose, balance.verdict.planes)) / (_FIGURES * len(works))
    return together(_of_work(work, lost / _seen(balance, work), machine or MachineAngles()) for work in works)


def mounting_digits(masses: Sequence[tuple[float, float]], permissible: float | None) -> ShopDigits:
    """Return the decimals of the masses that are mounted in a plane.

    Parameters
    ----------
    masses : (kg, rad) of each
    permissible : kg, as a mass at their radius; None where nothing says
    """
    lost = math.inf if permissible is None else _SHARE * permissible / (2.0 * max(1, len(masses)))
    return ShopDigits(
        angle=max((decimals_needed(math.degrees(k), math.degrees(lost / size)) for size, k in masses), default=0),
        mass=max((decimals_needed(1e3 * size, 1e3 * lost) for size, _ in masses), default=0),
    )


def together(each: Iterable[ShopDigits]) -> ShopDigits:
    """Return decimals that are enough for all."""
    some = tuple(each)
    return ShopDigits(*(max((getattr(k, field.name) for k in some), default=0) for field in fields(ShopDigits)))


def _of_work(work: Operation, within: float, machine: MachineAngles) -> ShopDigits:
    """Return the decimals of one operation, each of whose figures may be off by so much: relative, and rad."""
    degrees, turn = math.degrees(work.angle), math.degrees(within)
    half = math.degrees(work.half_angle or 0.0)
    depth, mass, radius = (1e3 * k for k in (work.depth or 0.0, work.mass, work.radius))
    weighed = work.kind in ("point_mass", "weight")
    # Radial tools go in from the surface wherever that is: nobody sets it.
    set_there = weighed or work.kind == "drill_axial"
    return ShopDigits(
        depth=decimals_needed(depth, within / _STEEPEST * depth),
        place=max(decimals_needed(1e3 * work.z), decimals_needed(radius, within * radius) if set_there else 0),
        tool=max(decimals_needed(1e3 * (k or 0.0)) for k in (work.tool_diameter, work.width)),
        angle=max(decimals_needed(k, turn) for k in (degrees, machine.of(degrees))),
        ends=max(decimals_needed(k, turn) for k in (degrees - half, degrees + half, 2.0 * half)) if half else 0,
        mass=decimals_needed(mass, within * mass) if weighed else 0,
    )


def _to_lose(plane: PlaneVerdict) -> float:
    """Return what may be lost in a tolerance plane, kg m, without another verdict, and no more than a share."""
    spare = abs(plane.permissible - abs(plane.residual)) - math.fsum(plane.bounds.values())
    share = _SHARE * plane.permissible
    return min(spare, share) if spare > 0 else share


def _seen(balance: Balance, work: Operation) -> float:
    """Return what an operation does in the tolerance plane where it does more, kg m."""
    residual = balance.residual
    p, q = plane_weights(residual.z, balance.tolerance_planes)
    weight = float(np.abs(p + q * (work.unbalance_z - residual.z)).max())
    return max(weight * abs(work.unbalance), _LEAST)
