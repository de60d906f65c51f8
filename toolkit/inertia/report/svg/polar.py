"""Polar plots: vectors across the shaft, as seen from bearing B looking toward A, 0° to the right."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from typing import Literal

from markupsafe import Markup

from inertia.records import dataclass
from inertia.report.svg.canvas import Canvas, Point, rectangular

_WIDTH, _HEIGHT = 61.0, 60.0
_CENTER = (30.5, 32.5)
_RADIUS = 22.0
_RINGS = 4  # at most
_DOT = 1.2  # mm on paper
_MARGIN = 1.12  # of the largest vector


STYLES = ("before", "after", "correction", "tolerance", "scatter", "disc", "removed", "added")
"""What the legend explains."""


@dataclass(frozen=True)
class Arrow:
    """A vector (g·mm) to draw, and the radius (g·mm) of the disc in which its tip may lie."""

    vector: complex
    style: Literal["before", "after", "correction"]
    uncertainty: float = 0.0


@dataclass(frozen=True)
class Mark:
    """An operation on the rim: its angle in degrees, and whether mass is added there."""

    angle: float
    adds: bool


def polar(
    title: str,
    arrows: Sequence[Arrow],
    *,
    tolerance: float | None = None,
    scatter: float | None = None,
    marks: Sequence[Mark] = (),
) -> Markup:
    """Return a polar plot, scaled to the largest of its vectors and circles.

    Parameters
    ----------
    title : above it
    arrows : what is drawn from the middle
    tolerance : g·mm, the circle of what is permissible
    scatter : g·mm, the circle that 95 % of the draws are in
    marks : on the rim
    """
    canvas = Canvas(_WIDTH, _HEIGHT, title)
    largest = max([tolerance or 0.0, scatter or 0.0, *(abs(k.vector) + k.uncertainty for k in arrows)])
    scale = _RADIUS / (_MARGIN * largest) if largest > 0 else 0.0
    rings = _rings(_MARGIN * largest)
    _grid(canvas, rings, scale)
    for arrow in arrows:
        if arrow.uncertainty > 0:
            canvas.circle(_at(arrow.vector * scale), max(arrow.uncertainty * scale, 0.3), "disc")
    for radius, style in ((scatter, "scatter"), (tolerance, "tolerance")):
        if radius is not None:
            canvas.circle(_CENTER, radius * scale, style)
    for arrow in arrows:
        _vector(canvas, arrow, scale)
    _labels(canvas, rings, scale, arrows)
    for mark in marks:
        _mark(canvas, mark)
    canvas.heading(title, 3.0, size=2.9)
    return canvas.markup()


def key(style: str) -> Markup:
    """Return the swatch of a style for the legend."""
    canvas = Canvas(9.0, 3.4, style)
    if style in ("before", "after", "correction"):
        canvas.arrow((0.3, 1.7), (8.5, 1.7), style)
    elif style in ("tolerance", "scatter"):
        canvas.line((0.3, 1.7), (8.7, 1.7), style)
    else:
        canvas.circle((4.5, 1.7), 1.1, style)
    return canvas.markup()


def _grid(canvas: Canvas, rings: Sequence[float], scale: float) -> None:
    for angle in range(0, 360, 30):
        out = rectangular(_RADIUS, angle)
        canvas.line(_CENTER, _at(out), "spoke" if angle % 90 == 0 else "grid")
        x, y = _at(rectangular(_RADIUS + 3.6, angle))
        canvas.text((x, y + 0.9), f"{angle}°", size=2.4, style="strong" if angle == 0 else "")
    canvas.circle(_CENTER, _RADIUS, "rim")
    canvas.polygon([_at(_RADIUS), _at(rectangular(_RADIUS + 1.8, 2.5)), _at(rectangular(_RADIUS + 1.8, -2.5))], "mark")
    for size in rings:
        canvas.circle(_CENTER, size * scale, "grid")


def _labels(canvas: Canvas, rings: Sequence[float], scale: float, arrows: Sequence[Arrow]) -> None:
    clear = _clearest(arrows)
    for size in rings:
        x, y = _at(rectangular(size * scale, clear))
        canvas.text((x, y + 0.8), f"{size:g}", size=2.2, style="halo")


def _rings(reach: float) -> list[float]:
    """Return the radii of the rings, up to `_RINGS` of them: multiples of 1, 2 or 5 times a power of ten."""
    if not 0 < reach < math.inf:
        return []
    power = 10.0 ** math.floor(math.log10(reach / _RINGS))
    step = next(k * power for k in (1.0, 2.0, 5.0, 10.0) if k * power * (_RINGS + 1) > reach)
    return [k * step for k in range(1, _RINGS + 1) if k * step < reach]


def _clearest(arrows: Sequence[Arrow]) -> float:
    """Return the angle between two spokes, degrees, that is farthest from every arrow."""
    directions = [cmath.phase(k.vector) for k in arrows if k.vector]

    def distance(angle: float) -> float:
        here = rectangular(1.0, angle)
        return min((abs(cmath.phase(here / cmath.rect(1.0, k))) for k in directions), default=0.0)

    return max((15.0 + 30.0 * k for k in range(12)), key=distance)


def _vector(canvas: Canvas, arrow: Arrow, scale: float) -> None:
    """Draw a vector; one too short for an arrow is a dot."""
    tip = _at(arrow.vector * scale)
    if math.dist(_CENTER, tip) < _DOT:
        canvas.circle(tip, 0.45, "dot")
    else:
        canvas.arrow(_CENTER, tip, arrow.style)


def _mark(canvas: Canvas, mark: Mark) -> None:
    place = _at(rectangular(_RADIUS, mark.angle))
    canvas.circle(place, 1.1, "added" if mark.adds else "removed")


def _at(vector: complex) -> Point:
    return _CENTER[0] + vector.real, _CENTER[1] - vector.imag
