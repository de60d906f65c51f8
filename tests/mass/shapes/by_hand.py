"""Solids of trimmed faces, put together by hand: box, cylinder, frustum, sphere, torus, all about the origin."""

import math
from collections.abc import Sequence

import numpy as np

from inertia.mesh.shape import Curve, Face, Patch, Shape, Solid, Spline, Trim

TURN = 2 * math.pi
_PLACE = np.eye(3, 4)


def frame(origin: Sequence[float] = (0.0, 0.0, 0.0), axes: np.ndarray | None = None) -> np.ndarray:
    """The rows o, x, y, z."""
    return np.vstack([np.array(origin, float), np.eye(3) if axes is None else axes])


def line(start: Sequence[float], stop: Sequence[float]) -> Curve:
    a, b = np.array(start, float), np.array(stop, float)
    return Curve("line", np.array([a, b - a, [0.0, 0.0]]))


def circle(radius: float, center: Sequence[float] = (0.0, 0.0)) -> Curve:
    return Curve("ellipse", np.array([center, [1.0, 0.0], [0.0, 1.0]]), (radius, radius))


def ring(patch: Patch, low: float, high: float, edges: tuple[int, int, int], number: int, inward: bool = False) -> Face:
    """All the way around in u, from v = low to high, with a seam: edges below, at the seam, and above."""
    below, seam, above = edges
    loop = (
        Trim(line((0, low), (TURN, low)), 0, 1, below),
        Trim(line((TURN, low), (TURN, high)), 0, 1, seam),
        Trim(line((0, high), (TURN, high)), 1, 0, above),
        Trim(line((0, low), (0, high)), 1, 0, seam),
    )
    return Face(patch, (loop,), inward, number)


def disc(height: float, radius: float, edge: int, number: int, upward: bool, axes: np.ndarray, at: np.ndarray) -> Face:
    patch = Patch("plane", frame(at + height * axes[2], axes))
    return Face(patch, ((Trim(circle(radius), 0, TURN, edge),),), not upward, number)


def frustum(
    low: float,
    high: float,
    height: float,
    axes: np.ndarray | None = None,
    at: Sequence[float] = (0, 0, 0),
    lid: float = 0,
) -> Shape:
    """A frustum, or a cylinder, on z = 0 of its axes; its lid is larger than its side by so much."""
    turn, place = np.eye(3) if axes is None else axes, np.array(at, float)
    angle = math.atan2(high - low, height)
    kind = "cylinder" if low == high else "cone"
    side = Patch(kind, frame(place, turn), (low,) if low == high else (low, angle))
    faces = (
        ring(side, 0.0, height if low == high else height / math.cos(angle), (0, 1, 2), 1),
        disc(0.0, low, 0, 2, False, turn, place),
        disc(height, high + lid, 2, 3, True, turn, place),
    )
    return Shape((Solid("1", faces, _PLACE, True),), np.full(3, 1e-7))


def sphere(radius: float, axes: np.ndarray | None = None, at: Sequence[float] = (0, 0, 0)) -> Shape:
    faces = (ring(Patch("sphere", frame(at, axes), (radius,)), -TURN / 4, TURN / 4, (0, 1, 2), 1),)
    return Shape((Solid("1", faces, _PLACE, True),), np.full(3, 1e-7))


def torus(major: float, minor: float, axes: np.ndarray | None = None, at: Sequence[float] = (0, 0, 0)) -> Shape:
    faces = (ring(Patch("torus", frame(at, axes), (major, minor)), 0.0, TURN, (0, 1, 0), 1),)
    return Shape((Solid("1", faces, _PLACE, True),), np.full(2, 1e-7))


def box(size: Sequence[float], at: Sequence[float] = (0, 0, 0), spline: bool = False) -> Shape:
    """A box with a corner at `at`; its faces are planes, or splines of degree 1 by 2."""
    corners = np.array(at, float) + np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * size
    edges: dict[tuple[int, int], int] = {}
    faces = []
    for number, (a, b, c, d) in enumerate(
        [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)], 1
    ):
        o, u, v = corners[a], corners[b] - corners[a], corners[d] - corners[a]
        if spline:
            poles = np.array([[o + i * u + j * v / 2 for j in range(3)] for i in range(2)])
            knots = np.array([0.0, 0, 1, 1]), np.array([0.0, 0, 0, 1, 1, 1])
            patch, ends = Patch("spline", np.zeros((4, 3)), spline=Spline((1, 2), knots, poles)), (1.0, 1.0)
        else:
            ends = float(np.linalg.norm(u)), float(np.linalg.norm(v))
            patch = Patch("plane", np.array([o, u / ends[0], v / ends[1], np.cross(u, v) / ends[0] / ends[1]]))
        flat = [(0.0, 0.0), (ends[0], 0.0), ends, (0.0, ends[1])]
        loop = []
        for k, (start, stop) in enumerate([(a, b), (b, c), (c, d), (d, a)]):
            first, second = flat[k], flat[(k + 1) % 4]
            key = min(start, stop), max(start, stop)
            edge = edges.setdefault(key, len(edges))
            loop.append(
                Trim(line(first, second), 0, 1, edge) if start < stop else Trim(line(second, first), 1, 0, edge)
            )
        faces.append(Face(patch, (tuple(loop),), False, number))
    return Shape((Solid("1", tuple(faces), _PLACE, True),), np.full(12, 1e-7))
