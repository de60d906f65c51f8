"""Drawing in Rerun: text, lines, points, arrows, ellipsoids and trails, and the colours that views share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from inertia import palette
from inertia.arrays import Float
from inertia.recording import entities
from inertia.recording.writer import Recording

Color = tuple[int, int, int] | tuple[int, int, int, int]

COLORS = tuple(map(palette.rgb, palette.COLORS))
"""Of series and of axes 1, 2, 3."""
OMEGA, MOMENTUM, TRAIL = palette.rgb(palette.ORANGE), palette.rgb(palette.SKY), palette.rgb(palette.YELLOW)
GROUND = (110, 115, 125)
STATE_COLORS = [int(f"{color[1:]}FF", 16) for color in (palette.GREEN, palette.VERMILLION)]
"""Of the two states of a timeline, red, green, blue and opacity in one number."""

STRIPS = 256
"""Rows of lines in a chunk: readers take time that grows with the square of them."""

_LABEL = {"colors": [palette.rgb(palette.WHITE)], "radii": [-0.01], "show_labels": True}
"""Of a text in space: its plate is near-black in a dark theme, and mid-grey on dark ground in a light one."""
_BEYOND = np.float32(1.07)  # of an arrow, where its name is
_ROUND = 97  # points of a circle
_POINTS = 20_000  # of a line that does not change


def write_text(recording: Recording, text: str) -> None:
    """Write the text, in Markdown."""
    import rerun as rr

    recording.static(entities.SUMMARY, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))


def write_lines(recording: Recording, path: str, strips: Sequence[Float], color: Color, radius: float) -> None:
    """Write lines (k, 3) that stay."""
    import rerun as rr

    recording.static(path, rr.LineStrips3D([np.float32(k) for k in strips], colors=[color], radii=[radius]))


def write_point(recording: Recording, path: str, time: Float, points: Float, color: Color, radius: float) -> None:
    """Write a point (m, 3) that moves."""
    import rerun as rr

    recording.static(path, rr.Points3D.from_fields(colors=[color], radii=[radius]))
    positions = points.astype(np.float32)
    recording.columns(path, time, lambda rows: rr.Points3D.columns(positions=positions[rows]))


def write_place(recording: Recording, path: str, time: Float, places: Float, attitude: Float | None = None) -> None:
    """Write where an entity is, (m, 3), and how it is turned, (m, 4): what hangs below it goes along."""
    import rerun as rr

    fields = {"translation": places.astype(np.float32)}
    if attitude is not None:
        fields["quaternion"] = attitude.astype(np.float32)
    recording.columns(
        path, time, lambda rows: rr.Transform3D.columns(**{name: values[rows] for name, values in fields.items()})
    )


def write_arrow(
    recording: Recording,
    path: str,
    time: Float,
    vectors: Float,
    label: str,
    color: Color,
    radius: float,
) -> None:
    """Write an arrow (m, 3) that moves, in display units, with its name beyond the tip."""
    import rerun as rr

    recording.static(path, rr.Arrows3D.from_fields(colors=[color], radii=[radius]))
    recording.static(f"{path}/name", rr.Points3D.from_fields(labels=[label], **_LABEL))
    tips = vectors.astype(np.float32)
    recording.columns(path, time, lambda rows: rr.Arrows3D.columns(vectors=tips[rows]))
    recording.columns(f"{path}/name", time, lambda rows: rr.Points3D.columns(positions=_BEYOND * tips[rows]))


def write_axes(recording: Recording, path: str, axes: Float, radius: float) -> None:
    """Write arrows along the axes 1, 2, 3, the columns of (3, 3), that stay in their frame."""
    import rerun as rr

    recording.static(path, rr.Arrows3D(vectors=axes.T, colors=COLORS[:3], radii=[radius] * 3))
    write_labels(recording, f"{path}/names", _BEYOND * axes.T, ["1", "2", "3"])


def write_labels(recording: Recording, path: str, places: ArrayLike, labels: Sequence[str]) -> None:
    """Write texts at places (k, 3) that stay."""
    import rerun as rr

    recording.static(path, rr.Points3D(places, labels=list(labels), **_LABEL))


def write_trail(recording: Recording, path: str, time: Float, points: Float, color: Color, radius: float) -> None:
    """Write the curve through points (m, 3), a piece for each frame: a view shows those of a while (`trail`)."""
    import rerun as rr

    recording.static(path, rr.LineStrips3D.from_fields(colors=[color], radii=[radius]))
    ends = points.astype(np.float32)
    starts = np.concatenate([ends[:1], ends[:-1]])
    recording.columns(
        path,
        time,
        lambda rows: rr.LineStrips3D.columns(strips=np.stack([starts[rows], ends[rows]], axis=1)),
        block=STRIPS,
    )


def write_ellipsoid(
    recording: Recording,
    path: str,
    time: Float,
    semi_axes: Float,
    color: Color,
    radius: float,
    attitude: Float | None = None,
) -> None:
    """Write an ellipsoid whose semi-axes (m, 3) change, and its attitude (m, 4) where one is given."""
    import rerun as rr

    fill = rr.components.FillMode.TransparentFillMajorWireframe
    recording.static(path, rr.Ellipsoids3D.from_fields(colors=[color], line_radii=[radius], fill_mode=fill))
    fields = {"half_sizes": semi_axes.astype(np.float32)}
    if attitude is not None:
        fields["quaternions"] = attitude.astype(np.float32)
    recording.columns(
        path, time, lambda rows: rr.Ellipsoids3D.columns(**{name: values[rows] for name, values in fields.items()})
    )


def thinned(points: np.ndarray) -> np.ndarray:
    """Return a path (m, 3), or every few points of it where it has very many."""
    return points[:: max(1, -(-len(points) // _POINTS))]


def basis(axis: Float) -> Float:
    """Return a right-handed rotation (3, 3) whose last column is the unit vector `axis`; the identity for z.

    >>> basis(np.array([0.0, 0.0, 1.0])).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    beside = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = beside - axis * (axis @ beside)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


def circle(radius: float, height: float, axes: Float) -> Float:
    """Return the points (k, 3) of a circle about the last column of `axes`, so far up along it."""
    turn = np.linspace(0.0, 2.0 * np.pi, _ROUND)
    points: Float = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(_ROUND, height)], axis=1) @ axes.T
    return points
