"""A sketch of ω(t) of a run, for notebooks, in colours for light and for dark pages."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float
from inertia.notebook import COLORS, text

_WIDTH, _HEIGHT, _LEFT, _TOP = 420, 130, 52, 8  # of the sketch's box
_LINE = 12  # the height of a line of text
_COLUMNS = 210  # over which the extent of the samples is drawn


def curves_svg(time: Float, curves: Float, names: Sequence[str], unit: str) -> str:
    """Return curves (n, k) over time (n,) s."""
    low, high = float(curves.min(initial=0.0)), float(curves.max(initial=0.0))
    room = 0.08 * (high - low) or 1.0
    low, high = low - room, high + room
    first, last = float(time.min()), float(time.max())

    def across(t: Float) -> Float:
        return np.asarray(_LEFT + _WIDTH * (t - first) / ((last - first) or 1.0))

    def down(value: Float) -> Float:
        return np.asarray(_TOP + _HEIGHT * (high - value) / (high - low))

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_LEFT + _WIDTH + 8}" height="{_TOP + _HEIGHT + 38}" '
        f'role="img" font-family="sans-serif" font-size="11" fill="currentColor">'
        f"<title>{text(', '.join(names))}, {text(unit)}, over time</title>"
        f'<rect x="{_LEFT}" y="{_TOP}" width="{_WIDTH}" height="{_HEIGHT}" fill="none" stroke="currentColor" '
        'stroke-opacity="0.35"/>'
    ]
    least, most = float(curves.min()), float(curves.max())
    marks = dict.fromkeys((least, most))
    if min(abs(float(down(np.asarray(0.0)) - down(np.asarray(end)))) for end in marks) > _LINE:
        marks[0.0] = None
    for value in marks:
        y = float(down(np.asarray(value)))
        parts.append(
            f'<line x1="{_LEFT}" x2="{_LEFT + _WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="currentColor" '
            f'stroke-opacity="0.2"/><text x="{_LEFT - 5}" y="{y + 4:.1f}" text-anchor="end">{value:.3g}</text>'
        )
    for k, curve in enumerate(curves.T):
        t, values = _thinned(time, curve)
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across(t), down(values), strict=True))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{COLORS[k]}" stroke-width="1.5"/>')
    base = _TOP + _HEIGHT + 14
    parts.append(f'<text x="{_LEFT}" y="{base}">{first:.4g} s</text>')
    parts.append(f'<text x="{_LEFT + _WIDTH}" y="{base}" text-anchor="end">{last:.4g} s</text>')
    for k, name in enumerate(names):
        x = _LEFT + 60 * k
        parts.append(f'<line x1="{x}" x2="{x + 16}" y1="{base + 14}" y2="{base + 14}" stroke="{COLORS[k]}" ')
        parts.append(f'stroke-width="2"/><text x="{x + 20}" y="{base + 18}">{text(name)}</text>')
    parts.append(f'<text x="{_LEFT + _WIDTH}" y="{base + 18}" text-anchor="end">{text(unit)}</text></svg>')
    return "".join(parts)


def _thinned(time: Float, values: Float) -> tuple[Float, Float]:
    """Return the samples, or, of many, the least and the largest of each column of the sketch."""
    if len(time) <= 2 * _COLUMNS:
        return time, values
    edges = np.linspace(0, len(time), _COLUMNS + 1).astype(int)[:-1]
    ends = np.stack([np.minimum.reduceat(values, edges), np.maximum.reduceat(values, edges)], axis=1)
    return np.repeat(time[edges], 2), ends.ravel()
