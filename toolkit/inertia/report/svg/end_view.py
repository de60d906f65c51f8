"""A correction plane as seen from bearing B: the rotor's own section there, and the work at the same scale."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from inertia.arrays import Float
from inertia.report.balance.data import OperationRow, PlaneRow
from inertia.report.numerals import plain
from inertia.report.svg.canvas import Canvas, Point, rectangular

_WIDTH, _HEIGHT = 66.0, 68.0
_CENTER = (33.0, 36.0)
_REACH = 23.5  # mm on paper, of what is drawn
_FINEST = 0.04  # mm on paper between points
_TEXT = 2.3
_AWAY = 2.6  # mm on paper, of a step's number from its work
_STEPS = 24  # of an arc


def end_view(plane: PlaneRow, loops: Sequence[Float], operations: Sequence[tuple[int, OperationRow]]) -> Markup:
    """Return the view: 0° to the right, angles counter-clockwise.

    Parameters
    ----------
    plane : what it is a view of
    loops : (k, 2) mm, the section of the rotor
    operations : those of the plane, each with the number of its step
    """
    far = [float(np.hypot(*loop.T).max()) for loop in loops] + [k.radius for _, k in operations]
    largest = max([*far, plane.radius or 0.0]) or 1.0
    scale = _REACH / largest
    canvas = Canvas(_WIDTH, _HEIGHT, f"plane {plane.id} seen from B, with the work at scale")
    canvas.heading(f"plane {plane.id}, z {plain(plane.z, 2)} mm", 4.0, size=3.2)
    canvas.path([[_at(scale * complex(*point)) for point in _thinned(loop, scale)] for loop in loops], "rotor")
    for start, stop in plane.forbidden:
        canvas.polygon(_sector(start, stop), "forbidden")
    for angle in range(0, 360, 30):
        canvas.line(_at(rectangular(_REACH + 1.0, angle)), _at(rectangular(_REACH + 2.5, angle)), "spoke")
        x, y = _at(rectangular(_REACH + 5.0, angle))
        canvas.text((x, y + 0.9), f"{angle}°", size=2.2, style="strong" if angle == 0 else "")
    canvas.line((_CENTER[0] - 2, _CENTER[1]), (_CENTER[0] + 2, _CENTER[1]), "thin")
    canvas.line((_CENTER[0], _CENTER[1] - 2), (_CENTER[0], _CENTER[1] + 2), "thin")
    for step, work in operations:
        _draw(canvas, work, scale)
        inward = work.kind in ("drill_radial", "mill_arc")
        beside = -(work.depth or 0.0) if inward else 0.5 * (work.diameter or 0.0)
        away = -_AWAY if inward else _AWAY
        x, y = _at(rectangular(scale * (work.radius + beside) + away, work.angle))
        canvas.text((x, y + 1.0), str(step), size=_TEXT, style="strong halo")
    length = next(k for k in _round_lengths() if k * scale > 8.0)
    base = _HEIGHT - 1.0
    canvas.line((3.0, base), (3.0 + length * scale, base), "rim")
    canvas.text((3.0, base - 1.0), f"{length:g} mm", size=2.3, anchor="start")
    return canvas.markup()


def _draw(canvas: Canvas, work: OperationRow, scale: float) -> None:
    """Draw one operation in its true size."""
    out = rectangular(1.0, work.angle)
    if work.kind == "drill_radial" and work.diameter and work.depth:
        half, shoulder = 0.5 * work.diameter, work.radius - work.depth
        tip = shoulder - half / math.tan(math.radians(0.5 * (work.point or 180.0)))
        corners = [(work.radius, half), (shoulder, half), (tip, 0.0), (shoulder, -half), (work.radius, -half)]
        canvas.polygon([_at(scale * complex(*corner) * out) for corner in corners], "removed")
    elif work.kind == "drill_axial" and work.diameter:
        canvas.circle(_at(scale * work.radius * out), 0.5 * scale * work.diameter, "removed")
    elif work.kind == "mill_flat" and work.depth:
        half = math.acos(max(-1.0, 1.0 - work.depth / work.radius))
        arc = [cmath.rect(scale * work.radius, half * (2.0 * k / _STEPS - 1.0)) * out for k in range(_STEPS + 1)]
        canvas.polygon(map(_at, arc), "removed")
    elif work.ends is not None and work.depth:
        angles = [work.ends[0] + work.span * k / _STEPS for k in range(_STEPS + 1)]
        outer = [_at(rectangular(scale * work.radius, angle)) for angle in angles]
        inner = [_at(rectangular(scale * (work.radius - work.depth), angle)) for angle in reversed(angles)]
        canvas.polygon([*outer, *inner], "removed")
    else:
        canvas.circle(_at(scale * work.radius * out), 1.4, "added" if work.method == "add" else "removed")


def _sector(start: float, stop: float) -> list[Point]:
    """Return the outline of a forbidden sector of the rim, degrees."""
    turn = (stop - start) % 360.0 or 360.0
    angles = [start + turn * k / _STEPS for k in range(_STEPS + 1)]
    outer = [_at(rectangular(_REACH + 1.0, angle)) for angle in angles]
    return [*outer, *(_at(rectangular(_REACH - 0.5, angle)) for angle in reversed(angles))]


def _thinned(loop: Float, scale: float) -> list[list[float]]:
    """Return a loop without points that lie closer to the last one than can be seen."""
    points: list[list[float]] = []
    for point in loop.tolist():
        if not points or scale * math.dist(point, points[-1]) > _FINEST:
            points.append(point)
    return points


def _round_lengths() -> list[float]:
    return [step * 10.0**power for power in range(-4, 7) for step in (1.0, 2.0, 5.0)]


def _at(vector: complex) -> Point:
    return _CENTER[0] + vector.real, _CENTER[1] - vector.imag
