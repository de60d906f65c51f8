"""The unrolled strip: where on the turn each operation is, a lane for each correction plane.

The rotor's surface as seen from outside with bearing B on top: angles then grow to the right.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from markupsafe import Markup

from inertia.records import dataclass
from inertia.report.balance.data import OperationRow, PlaneRow
from inertia.report.numerals import direction, fixed, plain
from inertia.report.svg.canvas import Canvas, levels, text_width

_WIDTH = 270.0
_LEFT, _RIGHT = 34.0, 6.0
_TOP, _LANE, _LEVEL = 9.0, 12.0, 3.1
_TEXT = 2.5
_MOST_LEVELS = 1  # above the lowest, of labels with angles
_LARGEST = 8.0  # mm on paper of a hole's mark


@dataclass(frozen=True)
class _Label:
    """An operation on the strip: its text, where the middle of that is, and on which level."""

    operation: OperationRow
    text: str
    x: float
    level: int


def strip(planes: Sequence[PlaneRow], operations: Sequence[OperationRow], decimals: int = 1) -> Markup:
    """Return the strip, from 0° to 360°; angles of operations have so many decimals."""
    lanes = [(plane, _labelled(plane, operations, decimals)) for plane in sorted(planes, key=lambda k: -k.z)]
    height = _TOP + sum(_LANE + _LEVEL * deep for _, (_, deep) in lanes) + 7.0
    canvas = Canvas(_WIDTH, height, "where the operations are on the turn, a lane for each correction plane")
    bottom = height - 7.0
    for angle in range(0, 361, 10):
        style = "grid" if angle % 30 else "spoke"
        canvas.line((_x(angle), _TOP - 1.5), (_x(angle), bottom), style)
        if angle % 30 == 0:
            canvas.text((_x(angle), _TOP - 2.6), f"{angle}°", size=_TEXT, style="strong" if angle % 360 == 0 else "")
    top = _TOP
    for plane, (labels, deep) in lanes:
        _lane(canvas, plane, labels, top, _LANE + _LEVEL * deep)
        top += _LANE + _LEVEL * deep
    canvas.line((_x(0), bottom), (_x(360), bottom), "rim")
    canvas.text((1.0, _TOP - 2.6), "B end ↑", size=_TEXT, anchor="start")
    canvas.text((1.0, bottom + 3.5), "A end ↓", size=_TEXT, anchor="start")
    canvas.arrow((_x(150), bottom + 3.0), (_x(210), bottom + 3.0), "angle")
    sense = "angle, counter-clockwise seen from B looking toward A"
    canvas.text((_x(212), bottom + 3.9), sense, size=_TEXT, anchor="start")
    return canvas.markup()


def _labelled(plane: PlaneRow, operations: Sequence[OperationRow], decimals: int) -> tuple[list[_Label], int]:
    """Return the labels of a plane's operations, and how many levels there are above the lowest.

    The angles are left out where labels with them would pile up.
    """
    here = sorted((k for k in operations if k.plane == plane.id), key=lambda k: k.angle)
    deep: list[int] = []
    for with_angle in (True, False):
        texts = [f"{k.id}: {direction(k.angle, decimals)}°" if with_angle else k.id for k in here]
        widths = [text_width(text, _TEXT) + 1.0 for text in texts]
        places = [_inside(_x(k.angle), 0.5 * width) for k, width in zip(here, widths, strict=True)]
        deep = levels(places, widths)
        if max(deep, default=0) <= _MOST_LEVELS:
            break
    labels = [_Label(*label) for label in zip(here, texts, places, deep, strict=True)]
    return labels, max(deep, default=0)


def _lane(canvas: Canvas, plane: PlaneRow, labels: Sequence[_Label], top: float, height: float) -> None:
    canvas.line((_x(0), top), (_x(360), top), "rim")
    canvas.text((1.0, top + 3.6), plane.id, size=3.2, anchor="start", style="strong")
    canvas.text((1.0, top + 7.0), f"z {plain(plane.z, 2)} mm", size=2.2, anchor="start")
    if plane.radius is not None:
        canvas.text((1.0, top + 10.0), f"1° is {fixed(math.radians(plane.radius), 2)} mm", size=2.2, anchor="start")
    for start, stop in plane.forbidden:
        for low, high in [(start, stop)] if start <= stop else [(start, 360.0), (0.0, stop)]:
            canvas.rectangle((_x(low), top), _x(high) - _x(low), height, "forbidden")
    for label in labels:
        canvas.line((_x(label.operation.angle), top), (_x(label.operation.angle), top + height), "place")
    for label in labels:
        work = label.operation
        wide = math.degrees((work.diameter or 0.0) / work.radius) * (_x(1) - _x(0))
        radius = min(max(0.5 * wide, 0.9), 0.5 * _LARGEST)
        if work.ends is not None:
            start, stop = work.ends
            for low, high in [(start, stop)] if start <= stop else [(start, 360.0), (0.0, stop)]:
                canvas.rectangle((_x(low), top + 2.5), _x(high) - _x(low), 4.0, "removed")
            place = (label.x, top + height - 1.0 - _LEVEL * label.level)
            canvas.text(place, label.text, size=_TEXT, style="halo")
            continue
        canvas.circle((_x(work.angle), top + 4.5), radius, "added" if work.method == "add" else "removed")
        place = (label.x, top + height - 1.0 - _LEVEL * label.level)
        canvas.text(place, label.text, size=_TEXT, style="halo")


def _inside(x: float, half: float) -> float:
    """Return the middle of a label near x that stays on the strip."""
    return min(max(x, _LEFT + half), _WIDTH - half)


def _x(angle: float) -> float:
    return _LEFT + (_WIDTH - _LEFT - _RIGHT) * angle / 360.0
