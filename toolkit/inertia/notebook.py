"""What results show in a notebook: a small table, and a sketch of an ellipsoid, for light and for dark pages."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

import numpy as np

from inertia.arrays import Float
from inertia.errors import visible
from inertia.palette import BLUE, GREEN, VERMILLION

COLORS = (BLUE, VERMILLION, GREEN)
"""Of the three components, or axes."""
EYE = np.array([0.58, 0.46, 0.67])
"""From where all three axes can be told apart."""

_SIZE, _ROOM = 150.0, 12.0  # of the sketch, and around it


def html_of(rows: Iterable[tuple[str, str]], picture: str = "") -> str:
    """Return rows of label and text, and a picture below them, as one piece of HTML; all text is escaped."""
    cells = "".join(
        '<tr><th style="text-align:left;vertical-align:top;font-weight:600;white-space:nowrap;'
        f'padding:1px 12px 1px 0">{text(label)}</th>'
        f'<td style="text-align:left;padding:1px 0">{text(value)}</td></tr>'
        for label, value in rows
    )
    return (
        '<div style="font-family:sans-serif;font-size:13px"><table style="border-collapse:collapse;border:none;'
        f'color:inherit;font-size:inherit">{cells}</table>{picture}</div>'
    )


def text(plain: str) -> str:
    """Return text with nothing in it that a page or a terminal obeys."""
    return escape(visible(plain))


def seen(points: Float) -> Float:
    """Return places (…, 2) of points (…, 3) as seen from `EYE`, with z upright."""
    toward = EYE / np.linalg.norm(EYE)
    right = np.cross([0.0, 0.0, 1.0], toward)
    right /= np.linalg.norm(right)
    return np.stack([points @ right, points @ np.cross(toward, right)], axis=-1)


def outline(semi_axes: Float, axes: Float) -> Float:
    """Return the outline (n, 2) of an ellipsoid as seen: what the unit circle becomes by the root of P Q Pᵀ.

    P projects, and Q = R diag(s²) Rᵀ has the semi-axes s along the columns of R.
    """
    half = seen((axes * semi_axes).T).T
    size, turn = np.linalg.eigh(half @ half.T)
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    circle = np.sqrt(np.maximum(size, 0.0))[:, None] * np.array([np.cos(angle), np.sin(angle)])
    return np.asarray((turn @ circle).T)


def ellipsoid_svg(semi_axes: Float, axes: Float) -> str:
    """Return a sketch of an ellipsoid, with its semi-axes in the columns of `axes`, in part axes."""
    edge, ends = outline(semi_axes, axes), seen((axes * semi_axes).T)
    scale = _SIZE / (2.0 * float(np.abs(np.vstack([edge, ends])).max() or 1.0))
    middle = _SIZE / 2 + _ROOM

    def at(place: Float) -> str:
        return f"{middle + scale * place[0]:.1f},{middle - scale * place[1]:.1f}"

    width = _SIZE + 2 * _ROOM
    lines = "".join(
        f'<polyline points="{at(-end)} {at(end)}" stroke="{color}" stroke-width="1.5"/>'
        f'<text x="{at(1.08 * end).split(",")[0]}" y="{at(1.08 * end).split(",")[1]}" stroke="none" '
        f'fill="currentColor">{number}</text>'
        for number, end, color in zip("123", ends, COLORS, strict=True)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{width:.0f}" role="img" '
        'font-family="sans-serif" font-size="11" fill="none"><title>ellipsoid of the same mass and moments, with its '
        f'principal axes, z upright</title><polygon points="{" ".join(map(at, edge))}" fill="currentColor" '
        f'fill-opacity="0.08" stroke="currentColor" stroke-opacity="0.5"/>{lines}</svg>'
    )
