"""Clearance of flats and arcs: how deep and far they may go before the wall under and beside them meets an obstacle.

What is left beside a cutter along the shaft follows from its width, so that faces across the shaft are no obstacles
to it; nor are surfaces that look away from the shaft: what lies under these is metal.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import FULL_TURN
from inertia.balancing.corrections.milling import ArcCutter, Cutter, FlatCutter
from inertia.balancing.corrections.obstacles import Obstacles, wall_of
from inertia.balancing.corrections.sweeps import facing_angles, gap

_ACROSS = 0.94  # cosine: walls that are no more than 20° off stand across the shaft, or look outward
_AT_ONCE = 1 << 18  # pairs of an obstacle and an angle
_SMALL = 0.02  # of the radius: obstacles are divided down to that for arcs
_DIVIDED = 8  # times at most


def flat_room(found: Obstacles, tool: FlatCutter, angles: Float, most: Float, rim: float) -> Float:
    """Return how deep a flat may go under its plane's surface at angles (m,) rad, at most `most` (m,), m.

    Parameters
    ----------
    rim : m under the plane's surface, negative above it: where the highest of the metal begins
    """
    wall, limits, outer = wall_of(tool), np.array(most), tool.plane.radius - min(rim, 0.0)
    past = float(most[np.isfinite(most)].max(initial=0.0)) + wall
    half = tool.along + wall
    places = _between(_in_the_way(found, past, tool), tool.plane.z - half, tool.plane.z + half)
    stride = max(_AT_ONCE // max(len(angles), 1), 1)
    for low in range(0, len(places), stride):
        x, t = _turned(places[low : low + stride], tool, angles)
        beside = np.minimum(np.maximum(gap(x) - wall, 0.0), outer)
        # An obstacle lies under the flat, or else beside the chord in which that meets the rim.
        chord = tool.plane.radius - np.sqrt(outer**2 - beside**2)
        limits = np.minimum(limits, np.maximum(t.min(axis=2) - wall, chord).min(axis=0))
    return limits


def flat_wall(found: Obstacles, tool: FlatCutter, angle: float, setting: float, most: float) -> float:
    """Return how far a flat stays from obstacles at least; at most `most`, m.

    Parameters
    ----------
    tool : as it starts on the metal
    """
    bottom = tool.start + setting
    chord = math.sqrt(max(tool.radius**2 - (tool.radius - setting) ** 2, 0.0))
    for places, along in _strips(_in_the_way(found, bottom + most, tool), tool):
        x, t = _turned(places, tool, np.array([angle]))
        away = np.maximum(np.maximum(t.min(axis=2) - bottom, gap(x) - chord), along)
        most = min(most, max(float(away.min(initial=math.inf)), 0.0))
    return most


def arc_room(found: Obstacles, tool: ArcCutter, angles: Float, start: float) -> Float:
    """Return how far an arc may reach to both sides of angles (m,), rad; negative for nowhere.

    Parameters
    ----------
    start : m under the plane's surface, where the lowest of the metal begins
    """
    wall = wall_of(tool)
    past, half = start + tool.depth + wall, tool.along + wall
    places = _between(_small(_in_the_way(found, past, tool), tool), tool.plane.z - half, tool.plane.z + half)
    middle, spread = facing_angles(places[_far(places) > tool.plane.radius - past])
    gaps = np.full(len(angles), math.pi)
    stride = max(_AT_ONCE // max(len(angles), 1), 1)
    for low in range(0, len(middle), stride):
        some = slice(low, low + stride)
        gaps = np.minimum(gaps, (_away(angles, middle[some, None]) - spread[some, None]).min(axis=0))
    lowest = max(tool.plane.radius - past, wall)
    return gaps - (math.asin(wall / lowest) if wall else 0.0)


def arc_wall(found: Obstacles, tool: ArcCutter, angle: float, setting: float, most: float) -> float:
    """Return how far an arc stays from obstacles at least; at most `most`, m.

    Parameters
    ----------
    tool : as it starts on the metal
    """
    bottom = tool.radius - tool.depth
    for places, along in _strips(_small(_in_the_way(found, tool.start + tool.depth + most, tool), tool), tool):
        far = _far(places)
        middle, spread = facing_angles(places)
        beyond = np.clip(_away(angle, middle) - spread - tool.half_angle_at(setting), 0.0, 0.5 * math.pi)
        beside = np.linalg.norm(places, axis=2).min(axis=1) * np.sin(beyond)
        away = np.maximum(np.maximum(bottom - far, beside), along)
        most = min(most, max(float(away.min(initial=math.inf)), 0.0))
    return most


def _in_the_way(found: Obstacles, past: float, tool: Cutter) -> Float:
    """Return the triangles (k, 3, 3) in a cutter's way, no deeper than `past` (m) under its plane's surface."""
    steep = (np.abs(found.normals[:, 2]) <= _ACROSS) & (found.outward <= _ACROSS)
    return found.corners[steep & (tool.plane.radius - _far(found.corners[..., :2]) <= past)]


def _far(places: Float) -> Float:
    """Return the distance from the shaft of the farthest of places (k, v, 2) each."""
    return np.asarray(np.linalg.norm(places, axis=2).max(axis=1))


def _away(angle: Float | float, other: Float) -> Float:
    return np.asarray(np.abs((angle - other + math.pi) % FULL_TURN - math.pi))


def _between(triangles: Float, low: float, high: float) -> Float:
    """Return places (k, 9, 2) across the shaft whose hull is what lies of triangles between two heights."""
    start, stop = triangles, np.roll(triangles, -1, axis=1)
    rise = stop[..., 2] - start[..., 2]
    points, counts = [start], [(start[..., 2] >= low) & (start[..., 2] <= high)]
    for height in (k for k in (low, high) if math.isfinite(k)):
        share = np.divide(height - start[..., 2], rise, out=np.full_like(rise, -1.0), where=rise != 0)
        points.append(start + share[..., None] * (stop - start))
        counts.append((share >= 0) & (share <= 1))
    places, count = np.concatenate(points, axis=1)[..., :2], np.concatenate(counts, axis=1)
    some = count.any(axis=1)
    places, count = places[some], count[some]
    first = places[np.arange(len(places)), count.argmax(axis=1)]
    return np.where(count[..., None], places, first[:, None])


def _strips(triangles: Float, tool: Cutter) -> Iterator[tuple[Float, float]]:
    """Yield what lies of triangles beside a cutter and the wall around it, and beyond, and how far along the shaft."""
    z, half = tool.plane.z, tool.along + wall_of(tool)
    yield _between(triangles, z - half, z + half), 0.0
    yield _between(triangles, z + half, math.inf), wall_of(tool)
    yield _between(triangles, -math.inf, z - half), wall_of(tool)


def _turned(places: Float, tool: Cutter, angles: Float) -> tuple[Float, Float]:
    """Return x and t of places (k, v, 2) as seen at angles (m,) rad, (k, m, v) each."""
    u = np.column_stack([np.cos(angles), np.sin(angles)])
    v = np.column_stack([-u[:, 1], u[:, 0]])
    return np.einsum("kvi,mi->kmv", places, v), tool.plane.radius - np.einsum("kvi,mi->kmv", places, u)


def _small(triangles: Float, tool: Cutter) -> Float:
    """Divide triangles (k, 3, 3) until they are short across the shaft."""
    most, done = _SMALL * tool.plane.radius, []
    for _ in range(_DIVIDED):
        edges = np.roll(triangles, -1, axis=1) - triangles
        long = np.linalg.norm(edges[..., :2], axis=2).max(axis=1) > most
        done.append(triangles[~long])
        corners = triangles[long]
        a, b, c = (corners[:, k] for k in range(3))
        ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.concatenate([*done, triangles])
