"""Distribution of a correction among planes, each with its tools and limits."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.disc_constrained_milp import Complex
from inertia.balancing.corrections.drilling import AxialDrill, RadialDrill
from inertia.balancing.corrections.layout import Arrangement, arrange
from inertia.balancing.corrections.masses import MassTool
from inertia.balancing.corrections.milling import FlatCutter
from inertia.balancing.corrections.tool import Tool
from inertia.balancing.corrections.workpiece import Body, under, wall
from inertia.errors import GeometryError

_REACHED = 1e-6  # of a vector: planes that leave no more of it have no limit
_SETTLED = 1e-9
_ROUNDS = 200


@dataclass(frozen=True)
class Plan:
    """What each plane is to do: arrangements by plane number, their vectors (n,) kg m, and the limits that bound."""

    arrangements: Mapping[int, Arrangement]
    vectors: Complex
    limits_hit: tuple[str, ...]


def tools_of(plane: CorrectionPlane, angle: float, bodies: Sequence[Body]) -> tuple[Tool, ...]:
    """Return the tools of a plane, the smallest first, for the material at an angle (rad).

    Raises `GeometryError` where there is no material.
    """
    tools = _tools(plane, 0.0)
    density = under(bodies, tools[0], angle) if bodies else None
    return tools if density is None else _tools(plane, density)


def _tools(plane: CorrectionPlane, density: float) -> tuple[Tool, ...]:
    if plane.method == "mill":
        return (FlatCutter(plane, density),)
    if plane.method in ("add", "remove"):
        return (MassTool(plane, density),)
    kind = RadialDrill if plane.method == "drill_radial" else AxialDrill
    return tuple(kind(plane, density, diameter=diameter) for diameter in sorted(plane.diameters))


def share(effects: Complex, start: Complex, limits: Float) -> Complex:
    """Return vectors w (n,) for which |start + effects w| is least over the limits, in the worst plane.

    Where nothing need be left, it is the w of least Σ|w|²; otherwise the weighted least squares of Lawson's iteration,
    which gives the planes that are worst more weight until they are level.

    Parameters
    ----------
    effects : (t, n)
    start : (t,)
    limits : (t,)

    >>> w = share(np.array([[1.0], [0.0]]), np.array([3j, 1.0]), np.ones(2))
    >>> bool(np.abs(w + 3j).max() < 1e-9)
    True
    """
    matrix, target = effects / limits[:, None], -start / limits
    vectors: Complex = np.linalg.pinv(matrix) @ target
    best, worst = vectors, np.abs(target - matrix @ vectors).max(initial=0.0)
    weights = np.ones(len(limits))
    for _ in range(_ROUNDS):
        rest = np.abs(target - matrix @ vectors)
        if rest.max(initial=0.0) < worst:
            best, worst = vectors, rest.max()
        if worst <= _SETTLED * np.abs(target).max(initial=0.0):
            break
        weights *= rest
        weights /= weights.max()
        root = np.sqrt(weights)
        vectors = np.linalg.pinv(matrix * root[:, None]) @ (target * root)
    return best


def plan(
    tools: Mapping[int, tuple[Tool, ...]],
    effects: Complex,
    start: Complex,
    limits: Float,
    bodies: Sequence[Body],
    previous: Mapping[int, Arrangement],
) -> Plan:
    """Share a correction among planes; a plane that cannot do its share does what it can, and others the rest.

    Parameters
    ----------
    tools : of each plane at work, by its number
    effects : (t, n) what a unit vector in each plane adds in each tolerance plane
    start : (t,) kg m, what is there when no plane does anything
    limits : (t,) kg m
    bodies : the bodies that are cut
    previous : arrangements that stay as they are, but for angle and settings, where they reach
    """
    arrangements: dict[int, Arrangement] = {}
    vectors = np.zeros(effects.shape[1], complex)
    hit: list[str] = []
    open_planes = sorted(tools)
    while open_planes:
        shares = share(effects[:, open_planes], start + effects @ vectors, limits)
        short = []
        for number, vector in zip(open_planes, shares.tolist(), strict=True):
            arrangement, why = _walled(tools[number], vector, bodies, previous.get(number))
            arrangements[number] = arrangement
            if abs(arrangement.short) > _REACHED * abs(vector):
                short.append(number)
                hit.append(why)
        stay = short or open_planes
        for number in stay:
            vectors[number] = arrangements[number].tool.sign * arrangements[number].vector
        open_planes = [number for number in open_planes if number not in stay]
    return Plan(arrangements, vectors, tuple(dict.fromkeys(hit)))


def _walled(
    tools: tuple[Tool, ...], vector: complex, bodies: Sequence[Body], previous: Arrangement | None
) -> tuple[Arrangement, str]:
    """Arrange a plane's places no deeper than the wall allows; say what bounds it."""
    plane = tools[0].plane
    why = _bound(plane)
    while True:
        arrangement = arrange(tools, plane.sign * vector, previous)
        rooms = [
            (wall(bodies, arrangement.tool, angle) - plane.min_wall, angle, setting)
            for angle, setting in arrangement.places
        ]
        deep = [place for place in rooms if place[2] > place[0]]
        if not deep:
            return arrangement, why
        room, angle, setting = min(deep)
        smaller = tuple(k for k in tools if k.half_angle < arrangement.tool.half_angle)
        if plane.max_depth is not None or (room <= 0 and not smaller):
            raise _too_deep(arrangement.tool, room, angle, setting)
        why = f"plane {plane.id!r}: the wall at {math.degrees(angle):.4g} degrees"
        previous = None
        others = [] if room <= 0 else [replace(k, limit=room) for k in tools if k not in smaller]
        tools = (*smaller, *others)


def _bound(plane: CorrectionPlane) -> str:
    which = f"plane {plane.id!r}: "
    if plane.method in ("add", "remove") and plane.max_mass is not None:
        return which + f"max_mass {plane.max_mass:g} kg"
    if plane.angles != "free":
        return which + "the angles allowed"
    if plane.max_depth is not None:
        return which + f"max_depth {1e3 * plane.max_depth:g} mm"
    return which + "its forbidden sectors" if plane.forbidden else which + "its tools"


def _too_deep(tool: Tool, room: float, angle: float, setting: float) -> GeometryError:
    plane = tool.plane
    least = f", {1e3 * plane.min_wall:g} mm of it to stay" if plane.min_wall else ""
    remedy = f"set max_depth to {math.floor(1e4 * room) / 10:g} mm or less" if room > 0 else "use a smaller tool"
    return GeometryError(
        f"plane {plane.id!r}: a depth of {1e3 * setting:.4g} mm at {math.degrees(angle):.4g} degrees is too deep for "
        f"the wall, which allows {1e3 * max(room, 0.0):.4g} mm{least}: {remedy}"
    )
