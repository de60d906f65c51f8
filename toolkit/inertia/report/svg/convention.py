"""The pictogram of the angles: the rotor seen from bearing B looking toward A."""

from __future__ import annotations

from typing import Literal

from markupsafe import Markup

from inertia.report.balance.data import TURNS
from inertia.report.svg.canvas import Canvas, Point, rectangular

_WIDTH, _HEIGHT = 41.0, 23.5
_CENTER = (17.5, 13.2)
_RADIUS = 6.4
_OUTER = 9.4
_STEPS = 24


def convention(rotation: Literal["ccw", "cw"]) -> Markup:
    """Return the pictogram: the 0° mark, the sense of the angles inside, and that of the rotation outside."""
    canvas = Canvas(
        _WIDTH, _HEIGHT, f"seen from B: 0° to the right, angles counter-clockwise, rotor turns {TURNS[rotation]}"
    )
    x, y = _CENTER
    canvas.circle(_CENTER, _RADIUS, "rim")
    canvas.line(_CENTER, _at(_OUTER, 0), "zero")
    canvas.polygon([_at(_RADIUS, 0), _at(_RADIUS + 2.0, 9), _at(_RADIUS + 2.0, -9)], "mark")
    canvas.text((x + _OUTER + 0.8, y + 0.9), "0° mark", size=2.7, anchor="start", style="strong")
    canvas.line(_CENTER, _at(_OUTER - 1.0, 90), "thin")
    canvas.text((x, y - _OUTER - 0.6), "90°", size=2.4)
    _arc(canvas, 4.2, 4, 84, "angle")
    canvas.text((x + 5.8, y - 4.6), "angle", size=2.4, anchor="start")
    start, stop = (130, 230) if rotation == "ccw" else (230, 130)
    _arc(canvas, _OUTER, start, stop, "rotation")
    canvas.text((x - _OUTER - 0.8, y + 0.8), "turns", size=2.4, anchor="end")
    return canvas.markup()


def _arc(canvas: Canvas, radius: float, start: float, stop: float, style: str) -> None:
    """Draw an arc between two angles (degrees) that ends in an arrow."""
    points = [_at(radius, start + (stop - start) * k / _STEPS) for k in range(_STEPS + 1)]
    canvas.polyline(points, style)
    canvas.arrow(points[-5], points[-1], style, head=1.8)


def _at(radius: float, angle: float) -> Point:
    vector = rectangular(radius, angle)
    return _CENTER[0] + vector.real, _CENTER[1] - vector.imag
