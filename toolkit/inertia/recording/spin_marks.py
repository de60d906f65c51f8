"""What makes the turning of a body visible: its edges, a mark on its surface, and a halo around a needle."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.recording import entities
from inertia.recording.display import Display, facet_normals
from inertia.recording.drawing import write_lines
from inertia.recording.writer import Recording

MARK, FAINT, EDGE, HALO = (235, 235, 240), (75, 78, 86), (205, 212, 224), (150, 165, 185, 80)

_SHARP = math.cos(math.radians(40.0))  # of normals across an edge that is drawn
_LARGEST, _MOST = 20_000, 4_000  # triangles that are searched for edges, and edges that are drawn
_NEEDLE = 0.06  # of its length: a body that is thinner both ways has a halo
_WIDTH = 0.09  # of a needle's length: its halo's semi-axis
_THICK = 0.012  # over the body's radius
_SAMPLES = 49
_BETWEEN = math.sqrt(0.5) * np.array([[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, math.sqrt(2.0)]])


def write_marks(recording: Recording, body: Display, axes: Float) -> Iterator[str]:
    """Write what shows how a body turns; yield what it is.

    Parameters
    ----------
    body : as it is shown
    axes : (3, 3) in part axes; the mark runs from end to end of the last column, between the first and the second
    """
    axes = axes @ _BETWEEN
    halo = _halo(body)
    if body.triangles is None or halo is not None:
        center, semi_axes, attitude = halo or (np.zeros(3), body.semi_axes, body.attitude)
        assert semi_axes is not None
        lines = [_half_ellipse(center, semi_axes, attitude, axes)]
    else:
        lines = [*(meridian(body.triangles @ axes, 0.0) @ axes.T)]
        edges = sharp_edges(body.triangles)
        if len(edges):
            write_lines(recording, entities.EDGES, list(edges), EDGE, -0.7)
        else:
            others = [line for k in (1, 2, 3) for line in meridian(body.triangles @ axes, 0.5 * k * math.pi) @ axes.T]
            write_lines(recording, entities.EDGES, others, FAINT, 0.4 * _THICK * body.radius)
    write_lines(recording, entities.MARK, lines, MARK, _THICK * body.radius)
    yield "the white line on the body turns with it"
    if halo is not None:
        _write_halo(recording, *halo)
        yield "the pale halo shows where the body is, which is too thin to be seen"


def spin_axes(axes: Float, omega: Float) -> Float:
    """Return principal axes (3, 3), columns, in an order that ends with the one nearest to ω (3,), right-handed.

    >>> spin_axes(np.eye(3), np.array([5.0, 0.1, 0.0])).tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    """
    last = int(np.abs(omega @ axes).argmax())
    return axes[:, [(last + 1) % 3, (last + 2) % 3, last]]


def sharp_edges(corners: Float) -> Float:
    """Return the edges (n, 2, 3) of triangles (k, 3, 3) that are sharp, or that one alone has; none of very many.

    >>> square = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]])
    >>> len(sharp_edges(square))  # without the diagonal
    4
    """
    if len(corners) > _LARGEST:
        return np.empty((0, 2, 3))
    points, place = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = place.reshape(-1, 3)
    pairs = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    keys, first, at, count = np.unique(
        pairs[:, 0] * len(points) + pairs[:, 1], return_index=True, return_inverse=True, return_counts=True
    )
    total = np.zeros((len(keys), 3))
    np.add.at(total, at.ravel(), np.repeat(facet_normals(corners), 3, axis=0))
    # The sum of two unit normals has the length 2 cos of half the angle between them.
    sharp = (count != 2) | ((total**2).sum(axis=1) < 2.0 + 2.0 * _SHARP)
    edges: Float = points[pairs[first[sharp]]]
    return edges if len(edges) <= _MOST else edges[:0]


def meridian(corners: Float, angle: float) -> Float:
    """Return the lines (n, 2, 3) in which triangles (k, 3, 3) meet the half-plane at this angle (rad) about z.

    >>> edge = meridian(np.array([[[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 2.0]]]), 0.0)
    >>> edge.tolist()
    [[[1.0, 0.0, 1.0], [1.0, 0.0, 0.0]]]
    """
    out, aside = np.array([math.cos(angle), math.sin(angle), 0.0]), np.array([-math.sin(angle), math.cos(angle), 0.0])
    off = corners @ aside
    crossed = (off >= 0).any(axis=1) & (off < 0).any(axis=1)
    some, off = corners[crossed], off[crossed]
    before, after = some[:, [2, 0, 1]], some
    left, right = off[:, [2, 0, 1]], off
    edges = (left >= 0) != (right >= 0)  # two of the three of each
    share = (left[edges] / (left[edges] - right[edges]))[:, None]
    points = before[edges] + share * (after[edges] - before[edges])
    lines = points.reshape(-1, 2, 3)
    outside: Float = lines[(lines @ out).sum(axis=1) > 0]
    return outside


def _halo(body: Display) -> tuple[Float, Float, Float] | None:
    """Return the centre, semi-axes and attitude of an ellipsoid around a needle; None where the body is none."""
    if body.triangles is None:
        return None
    axes = quaternion.matrix(body.attitude)
    along = body.triangles.reshape(-1, 3) @ axes
    low, high = along.min(axis=0), along.max(axis=0)
    sizes = high - low
    length = float(sizes.max())
    if np.sort(sizes)[1] >= _NEEDLE * length:
        return None
    semi_axes = np.where(sizes == length, 0.52 * length, _WIDTH * length)
    return axes @ (0.5 * (low + high)), semi_axes, body.attitude


def _half_ellipse(center: Float, semi_axes: Float, attitude: Float, axes: Float) -> Float:
    """Return the points (k, 3) of an ellipsoid in the half-plane through the last of `axes`, towards the first."""
    turn = np.linspace(0.0, math.pi, _SAMPLES)[:, None]
    directions = np.cos(turn) * axes[:, 2] + np.sin(turn) * axes[:, 0]
    scaled = directions @ quaternion.matrix(attitude) / semi_axes
    points: Float = center + directions / np.linalg.norm(scaled, axis=1)[:, None]
    return points


def _write_halo(recording: Recording, center: Float, semi_axes: Float, attitude: Float) -> None:
    import rerun as rr

    halo = rr.Ellipsoids3D(
        centers=[center],
        half_sizes=[semi_axes],
        quaternions=[rr.Quaternion(xyzw=attitude)],
        colors=[HALO],
        line_radii=[0.0],
        fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
    )
    recording.static(entities.HALO, halo)
