"""The rotor from the side, 0° on top: outline, bearings, tolerance and correction planes with their distances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from inertia.arrays import Float
from inertia.records import dataclass
from inertia.report.balance.data import BearingRow, PlaneRow
from inertia.report.numerals import plain
from inertia.report.svg.canvas import Canvas, levels, text_width

_WIDTH = 186.0
_SIDE = 24.0
_HALF = 16.5  # mm on paper, the largest half height
_TEXT = 2.7
_LEVEL = 3.6
_GAP = 0.5  # mm on paper: planes closer than this share a mark


@dataclass(frozen=True)
class _Place:
    """A plane on the sketch: its label, z in mm, and whether it is a tolerance plane."""

    label: str
    z: float
    bearing: bool


def sketch(outline: Float, center: float, bearings: Sequence[BearingRow], planes: Sequence[PlaneRow]) -> Markup:
    """Return the sketch: z to the right, from bearing A towards B.

    Parameters
    ----------
    outline : (n, 3) mm, as `ReportData.outline`
    center : mm, the centre of mass
    bearings, planes : what is marked
    """
    places = [_Place(k.name, k.z, True) for k in bearings] + [_Place(k.id, k.z, False) for k in planes]
    places.sort(key=lambda k: k.z)
    low = min(float(outline[0, 0]), places[0].z)
    high = max(float(outline[-1, 0]), places[-1].z)
    largest = float(np.abs(outline[:, 1:]).max())
    scale = min((_WIDTH - 2 * _SIDE) / (high - low), _HALF / largest)
    left = 0.5 * (_WIDTH - scale * (high - low)) - scale * low
    texts = [f"{k.label}: z {plain(k.z, 2)}" for k in places]
    at = [left + scale * k.z for k in places]
    deep = levels(at, [text_width(k, _TEXT) + 1.5 for k in texts])
    axis = 6.0 + _LEVEL * (max(deep) + 1) + scale * largest
    chain = _chain(places, at)
    bottom = axis + scale * largest + 7.0
    canvas = Canvas(_WIDTH, bottom + _LEVEL * 2 + 4.5, "the rotor from the side, with its planes")

    upper = [(left + scale * z, axis - scale * top) for z, top, _ in outline.tolist()]
    lower = [(left + scale * z, axis - scale * base) for z, _, base in reversed(outline.tolist())]
    canvas.polygon([*upper, *lower], "rotor")
    ends = left + scale * low - 8.0, left + scale * high + 8.0
    canvas.line((ends[0], axis), (ends[1], axis), "centre")
    for place, x, level in zip(places, at, deep, strict=True):
        top = axis - scale * largest - 3.0 - _LEVEL * level
        style = "tolerance-plane" if place.bearing else "correction-plane"
        canvas.line((x, top), (x, bottom + 1.0), style)
        if place.bearing:
            tip = axis + scale * _depth(outline, place.z)
            canvas.polygon([(x, tip), (x - 2.4, tip + 4.2), (x + 2.4, tip + 4.2)], "bearing")
    for x, text, level in zip(at, texts, deep, strict=True):
        canvas.text((x, axis - scale * largest - 4.0 - _LEVEL * level), text, size=_TEXT, style="strong halo")
    _center(canvas, left + scale * center, axis)
    if len(chain) > 1:
        _dimensions(canvas, chain, bottom)
    _overall(canvas, places, at, bottom + _LEVEL * 2)
    _eye(canvas, ends[1] + 3.0, axis)
    canvas.text((ends[0] - 1.0, axis + 0.9), "A end", size=_TEXT, anchor="end")
    return canvas.markup()


def _chain(places: Sequence[_Place], at: Sequence[float]) -> list[tuple[float, float, str]]:
    """Return the distances between planes side by side: ends on paper, and the text."""
    pairs = zip(places[:-1], places[1:], at[:-1], at[1:], strict=True)
    return [(x, y, plain(b.z - a.z, 2)) for a, b, x, y in pairs if y - x > _GAP]


def _dimensions(canvas: Canvas, chain: Sequence[tuple[float, float, str]], y: float) -> None:
    middles = [0.5 * (a + b) for a, b, _ in chain]
    deep = levels(middles, [text_width(text, _TEXT) for *_, text in chain])
    for (start, end, text), level in zip(chain, deep, strict=True):
        _dimension(canvas, start, end, y)
        canvas.text((0.5 * (start + end), y + 3.0 + 3.0 * level), text, size=_TEXT, style="halo")


def _overall(canvas: Canvas, places: Sequence[_Place], at: Sequence[float], y: float) -> None:
    a, b = (k for k, place in enumerate(places) if place.bearing)
    start, end = at[a], at[b]
    for x in (start, end):
        canvas.line((x, y - _LEVEL * 2), (x, y + 1.0), "tolerance-plane")
    _dimension(canvas, start, end, y)
    text = f"A to B {plain(places[b].z - places[a].z, 2)} mm"
    canvas.text((0.5 * (start + end), y + 3.2), text, size=_TEXT, style="halo")


def _dimension(canvas: Canvas, start: float, end: float, y: float) -> None:
    middle = 0.5 * (start + end)
    canvas.arrow((middle, y), (start, y), "dimension", head=1.6)
    canvas.arrow((middle, y), (end, y), "dimension", head=1.6)


def _center(canvas: Canvas, x: float, y: float) -> None:
    canvas.circle((x, y), 1.3, "center-of-mass")
    canvas.line((x - 2.2, y), (x + 2.2, y), "thin")
    canvas.line((x, y - 2.2), (x, y + 2.2), "thin")
    canvas.text((x + 1.8, y - 1.6), "G", size=_TEXT, anchor="start", style="strong halo")


def _eye(canvas: Canvas, x: float, y: float) -> None:
    canvas.arrow((x + 9.0, y), (x, y), "view")
    canvas.text((x + 4.5, y - 1.6), "B end", size=_TEXT)
    canvas.text((x + 4.5, y + 3.4), "view", size=_TEXT)


def _depth(outline: Float, z: float) -> float:
    """Return how far the outline reaches below the axis at z, mm; 0 beyond its ends."""
    return max(0.0, -float(np.interp(z, outline[:, 0], outline[:, 2], left=0.0, right=0.0)))
