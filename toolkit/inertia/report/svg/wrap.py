"""Strips in the size of the rim, to be taped round the rotor: where each operation goes, a strip a correction plane."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

from markupsafe import Markup

from inertia.balancing.shop_digits import ShopDigits
from inertia.report.balance.data import OperationRow, PlaneRow
from inertia.report.numerals import direction, plain
from inertia.report.svg.canvas import Canvas, levels, text_width

_WIDTH = 270.0
_LENGTH = 250.0  # of rim on one piece
_HEIGHT, _TOP, _BAND = 31.0, 7.0, 19.0
_LEFT = 10.0
_MOST = 8  # pieces of a strip
_RULER = 100.0
_TEXT = 2.6
_TICKS = (1, 2, 5, 10, 30, 90)  # degrees
_CLOSEST = 2.5  # mm between ticks
_LABEL, _DIGIT = 17.0, 1.6  # mm, of a step with its angle, and of each decimal beyond the first
_BESIDE = 9.0  # mm between their labels
_LINE = 3.2  # mm from a line of labels to the next


def wrap(
    plane: PlaneRow,
    operations: Sequence[tuple[int, OperationRow]],
    shown: Callable[[float], float],
    digits: ShopDigits,
) -> list[Markup]:
    """Return the pieces of a strip, as seen from outside with bearing B on top, in millimetres of the rim.

    There are none where it would take more than eight.

    Parameters
    ----------
    plane : with its radius
    operations : those of the plane, each with the number of its step
    shown : what the machine calls an angle, degrees
    digits : decimals that the angles take
    """
    radius = plane.radius or 0.0
    around = 2.0 * math.pi * radius
    count = math.ceil(around / _LENGTH)
    if not 0 < count <= _MOST:
        return []
    return [_piece(plane, operations, shown, digits, (number, count)) for number in range(count)]


def _piece(
    plane: PlaneRow,
    operations: Sequence[tuple[int, OperationRow]],
    shown: Callable[[float], float],
    digits: ShopDigits,
    piece: tuple[int, int],
) -> Markup:
    number, count = piece
    decimals, of_ends = max(1, digits.angle), max(1, digits.ends)
    degree = math.radians(plane.radius or 0.0)  # mm
    start, stop = 360.0 * degree * number / count, 360.0 * degree * (number + 1) / count
    canvas = Canvas(_WIDTH, _HEIGHT, f"strip to tape round plane {plane.id}, piece {number + 1} of {count}")
    top, bottom, middle = _TOP, _TOP + _BAND, _TOP + 0.5 * _BAND
    canvas.rectangle((_LEFT, top), stop - start, _BAND, "cut")
    canvas.line((_LEFT, middle), (_LEFT + stop - start, middle), "centre")
    tick = next(k for k in _TICKS if k * degree > _CLOSEST or k == _TICKS[-1])
    named = next((k for k in (10, 30, 90, 180) if k * degree > _BESIDE), 360)
    for angle in range(0, 361, tick):
        at = angle * degree - start
        if not -1e-9 <= at <= stop - start + 1e-9:
            continue
        tall = 4.0 if angle % named == 0 else 2.0
        canvas.line((_LEFT + at, bottom), (_LEFT + at, bottom - tall), "rim" if angle % named == 0 else "spoke")
        if angle % named == 0:
            # Both ends of a rim that is shorter than their names have them outside.
            anchor = "middle" if stop > _BESIDE else ("end", "start")[angle > 0]
            canvas.text((_LEFT + at, bottom + 3.0), f"{shown(angle):g}°", size=_TEXT, anchor=anchor, style="strong")
    for low, high in plane.forbidden:
        for first, last in [(low, high)] if low <= high else [(low, 360.0), (0.0, high)]:
            a, b = max(first * degree, start), min(last * degree, stop)
            if a < b:
                canvas.rectangle((_LEFT + a - start, top), b - a, _BAND, "forbidden")
    here = sorted(
        ((step, work) for step, work in operations if start <= work.angle * degree < stop and work.ends is None),
        key=lambda each: each[1].angle,
    )
    places = [_LEFT + work.angle * degree - start for _, work in here]
    roomy = all(b - a > _LABEL + _DIGIT * (decimals - 1) for a, b in pairwise(places))
    for step, work in operations:
        if work.ends is not None:
            _arc(canvas, step, work, lambda angle: direction(shown(angle), of_ends), (degree, start, stop))
    texts = [f"{step}: {direction(shown(work.angle), decimals)}°" if roomy else str(step) for step, work in here]
    lines = levels(places, [text_width(text, _TEXT) + 1.0 for text in texts])
    for (_, work), x in zip(here, places, strict=True):
        _mark(canvas, work, (x, middle))
    for text, x, line in zip(texts, places, lines, strict=True):
        canvas.text((x + 1.0, _TOP + 3.2 + _LINE * line), text, size=_TEXT, anchor="start", style="strong halo")
    title = f"plane {plane.id}, z {plain(plane.z, 2)} mm, Ø {plain(2 * (plane.radius or 0.0), 2)} mm"
    pieces = "" if count == 1 else f", piece {number + 1} of {count}"
    canvas.text((_LEFT, top - 2.0), f"B end ↑   {title}{pieces}", size=_TEXT, anchor="start", style="strong")
    if number == 0:
        _ruler(canvas)
    return canvas.markup()


def _mark(canvas: Canvas, work: OperationRow, at: tuple[float, float]) -> None:
    x, y = at
    radius = 0.5 * work.diameter if work.diameter and work.kind == "drill_radial" else 1.2
    canvas.circle(at, min(radius, 0.5 * _BAND), "added" if work.method == "add" else "bore")
    canvas.line((x - radius - 1.5, y), (x + radius + 1.5, y), "thin")
    canvas.line((x, _TOP), (x, _TOP + _BAND), "thin")


def _arc(
    canvas: Canvas, step: int, work: OperationRow, written: Callable[[float], str], piece: tuple[float, float, float]
) -> None:
    """Draw what of an arc lies on a piece: its length on the rim, its width, and the angles of its ends."""
    degree, start, stop = piece
    low, high = work.ends or (0.0, 0.0)
    half = min(0.5 * (work.width or 4.0), 0.5 * _BAND)
    y = _TOP + 0.5 * _BAND - half
    labelled = False
    for first, last in [(low, high)] if low <= high else [(low, 360.0), (0.0, high)]:
        a, b = max(first * degree, start), min(last * degree, stop)
        if a >= b:
            continue
        canvas.rectangle((_LEFT + a - start, y), b - a, 2.0 * half, "removed")
        if not labelled:
            canvas.text(
                (_LEFT + a - start + 1.0, _TOP + 3.2), str(step), size=_TEXT, anchor="start", style="strong halo"
            )
            labelled = True
        for angle, anchor in ((low, "start"), (high, "end")):
            x = angle * degree
            if a - 1e-9 <= x <= b + 1e-9 and (angle == low) == (x < 0.5 * (a + b)):
                canvas.line((_LEFT + x - start, _TOP), (_LEFT + x - start, _TOP + _BAND), "thin")
                text = f"{written(angle)}°"
                line = anchor == "end" and b - a < 2.0 * (text_width(text, _TEXT) + 1.0)
                place = (_LEFT + x - start + (1.0 if anchor == "start" else -1.0), _TOP + 6.6 + _LINE * line)
                canvas.text(place, text, size=_TEXT, anchor=anchor, style="halo")


def _ruler(canvas: Canvas) -> None:
    """Draw a line to be measured on the paper."""
    start, y = _WIDTH - _RULER - 2.0, 3.6
    canvas.line((start, y), (start + _RULER, y), "rim")
    for x in (start, start + _RULER):
        canvas.line((x, y - 1.2), (x, y + 1.2), "rim")
    text = f"measures {_RULER:g} mm where it was printed at 100 %"
    canvas.text((start + 0.5 * _RULER, y - 0.9), text, size=2.2, style="halo")
