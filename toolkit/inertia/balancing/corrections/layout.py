"""Angles and depths of a plane's holes, flats or masses: fewest first, smallest tool first.

At free angles, n places side by side, an angle ψ apart and all alike, make up f = sin(nψ/2)/sin(ψ/2) times what one
makes up, in the direction of their middle. Where even the least setting is too much they move apart until they cancel
enough of each other. At listed angles, or where a forbidden sector is in the way, a mixed-integer program finds the
places: the smallest remainder, and of those choices the fewest places.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import FULL_TURN, angle_of
from inertia.balancing.corrections.disc_constrained_milp import Program
from inertia.balancing.corrections.tool import Tool

_EXACT = 1e-9  # of a vector: what rounding leaves
_LEEWAY = 1e-5  # of a vector: what the solver leaves
_BESIDE = 4  # places tried to each side of a vector and of each forbidden sector
_MUCH = 10.0  # of a vector, where a tool has no limit


@dataclass(frozen=True)
class Arrangement:
    """Places (angle rad, setting) of one tool, and the vector (kg m) that they leave of what was asked of them."""

    tool: Tool
    places: tuple[tuple[float, float], ...]
    short: complex

    @property
    def vector(self) -> complex:
        """What the places make up, as if mass were added, kg m."""
        return sum((cmath.rect(self.tool.unbalance(setting), angle) for angle, setting in self.places), 0j)


def arrange(tools: Sequence[Tool], vector: complex, previous: Arrangement | None = None) -> Arrangement:
    """Arrange places of one of the tools so that they make up a vector (kg m), or as much of it as they can.

    Parameters
    ----------
    tools : those at hand in the plane, the smallest first
    vector : towards where they work
    previous : an arrangement whose tool and number of places stay, if it still reaches
    """
    if previous is not None:
        again = _again(previous, vector)
        if again is not None:
            return again
    arrangements = [_with_tool(tool, vector) for tool in tools]
    reaching = [k for k in arrangements if abs(k.short) <= _LEEWAY * abs(vector)]
    if reaching:
        return min(reaching, key=lambda k: len(k.places))
    return min(arrangements, key=lambda k: abs(k.short))


def _again(previous: Arrangement, vector: complex) -> Arrangement | None:
    if previous.tool.plane.angles == "free" and previous.places:
        spread = _spread(previous.tool, vector, len(previous.places))
        if spread is not None and abs(spread.short) <= _EXACT * abs(vector):
            return spread
    adjusted = _set_places(previous.tool, vector, [angle for angle, _ in previous.places])
    return adjusted if abs(adjusted.short) <= _EXACT * abs(vector) else None


def _with_tool(tool: Tool, vector: complex) -> Arrangement:
    if tool.plane.angles == "free":
        spread = _spread(tool, vector)
        if spread is not None:
            return spread
        candidates = _beside(tool, vector)
    else:
        candidates = [k for k in tool.plane.angles if not tool.plane.forbids(k, tool.half_angle)]
    return _picked(tool, vector, candidates)


def _spread(tool: Tool, vector: complex, number: int | None = None) -> Arrangement | None:
    """Spread places evenly about the vector's direction; None where one of them would be in a forbidden sector."""
    size, middle = cmath.polar(vector)
    least, most = tool.unbalance(tool.least), tool.unbalance(tool.greatest)
    gap = min(tool.apart + tool.plane.angle_step, math.pi)
    if number is None:
        numbers = range(1, max(1, int(math.pi / gap)) + 1)
        number = next((n for n in numbers if size <= most * _factor(n, gap) * (1 + _EXACT)), numbers[-1])
    each = size / _factor(number, gap)
    if each < least:
        number = max(number, 2)
        gap = max(_gap(number, size / least), gap)
        each = least
    setting = min(max(tool.setting(each), tool.least), tool.greatest) if each < most else tool.greatest
    angles = [angle_of(cmath.rect(1.0, middle + (k - 0.5 * (number - 1)) * gap)) for k in range(number)]
    if any(tool.plane.forbids(angle, tool.half_angle) for angle in angles):
        return None
    return _arrangement(tool, vector, [(angle, setting) for angle in angles])


def _factor(number: int, gap: float) -> float:
    return math.sin(0.5 * number * gap) / math.sin(0.5 * gap)


def _gap(number: int, factor: float) -> float:
    """Return the ψ for which `_factor` has this value, between 0 and 2π/n, by halving."""
    low, high = 0.0, FULL_TURN / number
    while (gap := 0.5 * (low + high)) not in (low, high):
        if _factor(number, gap) > factor:
            low = gap
        else:
            high = gap
    return gap


def _beside(tool: Tool, vector: complex) -> list[float]:
    """Return angles about the vector and at the edges of forbidden sectors, those that are allowed."""
    gap, half = tool.apart + tool.plane.angle_step, tool.half_angle
    steps = [k * gap for k in range(_BESIDE)]
    tried = [cmath.phase(vector) + sign * step for step in steps for sign in (1, -1)]
    for sector in tool.plane.forbidden:
        tried += [sector.start - half - step for step in steps] + [sector.stop + half + step for step in steps]
    angles = {round(angle_of(cmath.rect(1.0, angle)), 12) for angle in tried}
    return sorted(angle for angle in angles if not tool.plane.forbids(angle, half))


def _picked(tool: Tool, vector: complex, candidates: Sequence[float]) -> Arrangement:
    """Pick the places among candidate angles that leave the least, and of those choices the fewest."""
    size = abs(vector)
    if not candidates or size == 0:
        return Arrangement(tool, (), vector)
    least, most = (k / size for k in (tool.unbalance(tool.least), tool.unbalance(tool.greatest)))
    most = min(most, max(_MUCH, least))
    count = len(candidates)
    turns = np.exp(1j * np.array(candidates))
    used, amount, rest = slice(count), slice(count, 2 * count), 2 * count
    rows: list[tuple[Float, float, float]] = []
    for k in range(count):
        for bound, low, high in ((least, 0.0, math.inf), (most, -math.inf, 0.0)):
            row = np.zeros(rest + 1)
            row[count + k], row[k] = 1.0, -bound
            rows.append((row, low, high))
    for angle in candidates:
        near = [j for j, other in enumerate(candidates) if (other - angle) % FULL_TURN < tool.apart - _EXACT]
        if len(near) > 1:
            row = np.zeros(rest + 1)
            row[near] = 1.0
            rows.append((row, 0.0, 1.0))
    effects = np.zeros((1, rest + 1), complex)
    effects[0, amount] = -turns
    number, remainder = np.zeros(rest + 1), np.zeros(rest + 1)
    number[used], remainder[rest] = 1.0, 1.0
    program = Program(
        effects=effects,
        start=np.array([vector / size]),
        radii=np.zeros(1),
        reach=remainder[None],
        upper=np.concatenate([np.ones(count), np.full(count, most), [math.inf]]),
        integral=number,
        rows=rows,
    )
    best = program.least(remainder)
    if best is None:  # out of all proportion to what the tool can do
        return Arrangement(tool, (), vector)
    within = np.array([float(best[rest]) + _LEEWAY])
    fewer = replace(program, radii=within, reach=np.zeros_like(remainder)[None]).least(number)
    picked = np.flatnonzero((best if fewer is None else fewer)[used]).tolist()
    return _set_places(tool, vector, [candidates[k] for k in picked])


def _set_places(tool: Tool, vector: complex, angles: Sequence[float]) -> Arrangement:
    """Set the places at these angles so that they leave the least of the vector."""
    size = abs(vector)
    if not angles or size == 0:
        return Arrangement(tool, (), vector)
    from scipy.optimize import lsq_linear

    least, most = (tool.unbalance(k) / size for k in (tool.least, tool.greatest))
    if least < most:
        turns = np.exp(1j * np.array(angles))
        matrix, target = np.vstack([turns.real, turns.imag]), np.array([vector.real, vector.imag]) / size
        shares = lsq_linear(matrix, target, (least, most), tol=1e-15).x.tolist()
    else:
        shares = [most] * len(angles)
    settings = [min(max(tool.setting(share * size), tool.least), tool.greatest) for share in shares]
    return _arrangement(tool, vector, list(zip(angles, settings, strict=True)))


def _arrangement(tool: Tool, vector: complex, places: list[tuple[float, float]]) -> Arrangement:
    arrangement = Arrangement(tool, tuple(places), 0j)
    return replace(arrangement, short=vector - arrangement.vector)
