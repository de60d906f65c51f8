"""Clearance of drills: how deep they may go before they, or the wall around them, meet an obstacle.

Seen with a drill, x runs around the shaft, y along it (of holes along the shaft: away from it), and t with the drill
from the surface that depths of the plane are measured from. A drill may begin in surfaces no steeper than 20° to it.

A drill with the wall around it is convex, and its depth at which it meets a triangle is the least of a convex function
on that: where the plane of the triangle touches it, if that is in the triangle, else on an edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.corrections.drilling import SLOPE, Drill
from inertia.balancing.corrections.obstacles import Obstacles, wall_of
from inertia.balancing.corrections.sweeps import facing_angles, from_shaft, gap, pairs
from inertia.records import dataclass

_AT_ONCE = 1 << 15  # pairs of a triangle and an angle
_NARROWED = 44  # times that an edge is, by the golden ratio
_GOLDEN = 0.5 * (math.sqrt(5) - 1)
_STEEP = 1e6  # of the function beyond where it is defined


@dataclass(frozen=True, eq=False)
class _Grown:
    """A drill with the wall around it, and moved around the shaft by up to `aside` to both sides.

    Attributes
    ----------
    half, tip, wall, aside : m; half the diameter, the height of the point
    """

    half: float
    tip: float
    wall: float
    aside: float = 0.0

    def across(self, x: Float, y: Float) -> Float:
        """Return the distance from its axis."""
        return np.asarray(np.hypot(np.maximum(np.abs(x) - self.aside, 0.0), y))

    def ahead(self, distance: Float) -> Float:
        """Return how far it reaches ahead of its shoulder, at a distance from its axis; −∞, nearly, outside of it."""
        half, tip, wall = self.half, self.tip, self.wall
        slant = math.hypot(half, tip)
        turned = wall * tip / slant  # where the round of the tip becomes the cone, and that the round of the shoulder
        apex = tip + np.sqrt(np.maximum(wall**2 - distance**2, 0.0))
        cone = tip * (1 - distance / half) + wall * slant / half
        shoulder = np.sqrt(np.maximum(wall**2 - np.maximum(distance - half, 0.0) ** 2, 0.0))
        body = np.where(distance < turned, apex, np.where(distance < half + turned, cone, shoulder))
        return np.asarray(body - _STEEP * np.maximum(distance - half - wall, 0.0))

    def least_depth(self, corners: Float, normals: Float) -> Float:
        """Return the depths (k,) of its shoulder at which it meets triangles (k, 3, 3) with normals (k, 3)."""
        along = normals * np.where(normals[:, 2] < 0, -1.0, 1.0)[:, None]
        touched = self._support(along) + self.wall * along[:, :2]
        touched[:, 0] += self.aside * np.sign(along[:, 0])
        at = _on_plane(corners, normals, touched)
        there = at - self.ahead(self.across(touched[:, 0], touched[:, 1]))
        on_edges = _least(lambda p: p[..., 2] - self.ahead(self.across(p[..., 0], p[..., 1])), corners)
        return np.where(_holds(corners, normals, np.column_stack([touched, at])), np.minimum(on_edges, there), on_edges)

    def distance(self, corners: Float, normals: Float, begin: float, shoulder: float) -> Float:
        """Return the distances (k,) of triangles from a drill without its wall, from `begin` to `shoulder` and the tip.

        Less than that, 0 at least, for some triangles that it cuts.
        """
        offset = corners[:, 0] - [0.0, 0.0, shoulder]
        away = normals * np.where(np.einsum("ij,ij->i", offset, normals) < 0, -1.0, 1.0)[:, None]
        support = self._support(away)
        at_tip = (support == 0).all(axis=1) & (away[:, 2] > 0)
        end = np.where(away[:, 2] < 0, begin, np.where(at_tip, shoulder + self.tip, shoulder))
        ends = np.column_stack([support, end])
        height = np.einsum("ij,ij->i", corners[:, 0] - ends, away)
        over = _holds(corners, normals, ends + height[:, None] * away)
        on_edges = _least(lambda p: self._beside(p, begin, shoulder), corners)
        return np.where(over, np.minimum(np.maximum(height, 0.0), on_edges), on_edges)

    def _support(self, along: Float) -> Float:
        """Return where across its axis the drill itself lies farthest along unit vectors (k, 3): (k, 2)."""
        flat = np.hypot(along[:, 0], along[:, 1])
        shoulder = self.half * flat > self.tip * along[:, 2]
        share = np.divide(self.half, flat, out=np.zeros_like(flat), where=shoulder & (flat > 0))
        return np.asarray(share[:, None] * along[:, :2])

    def _beside(self, points: Float, begin: float, shoulder: float) -> Float:
        """Return the distances of points (..., 3) from the drill."""
        half, tip = self.half, self.tip
        across, t = np.hypot(points[..., 0], points[..., 1]), points[..., 2] - shoulder
        shank = np.hypot(np.maximum(across - half, 0.0), np.maximum(begin - shoulder - t, 0.0))
        share = np.clip(((half - across) * half + t * tip) / (half**2 + tip**2), 0.0, 1.0)
        cone = np.hypot(across - half * (1 - share), t - tip * share)
        inside = (across - half) * tip + t * half <= 0
        return np.asarray(np.where(t <= 0, shank, np.where(inside, 0.0, cone)))


def drill_room(found: Obstacles, tool: Drill, angles: Float, most: Float, aside: float) -> Float:
    """Return how deep a drill may go under its plane's surface at angles (m,) rad, at most `most` (m,), m.

    Negative where an obstacle is in its way from the beginning.

    Parameters
    ----------
    angles : ascending
    aside : m, by which it may be set beside an angle around the shaft
    """
    grown = _Grown(0.5 * tool.diameter, tool.tip, wall_of(tool), aside)
    limits = np.array(most)
    past = _greatest(most) + grown.tip + grown.wall
    for number, corners, normals in _near(found, tool, angles, grown.half + grown.wall + aside, past):
        nearest = grown.across(gap(corners[..., 0]), gap(corners[..., 1]))
        close = corners[..., 2].min(axis=1) - grown.ahead(nearest) < limits[number]
        close &= normals[:, 2] > -_level(tool)
        np.minimum.at(limits, number[close], grown.least_depth(corners[close], normals[close]))
    return limits


def goes_through(found: Obstacles, tool: Drill, angles: Float, enter: Float, leave: Float, aside: float) -> Bool:
    """Return at which angles (m,) rad a drill that goes through meets nothing but the surfaces of both ends.

    Parameters
    ----------
    angles, aside : as for `drill_room`
    enter, leave : (m,) m under the plane's surface, where metal begins and ends along the axis; nan for none
    """
    reach, level = 0.5 * tool.diameter + wall_of(tool), _level(tool)
    free = np.isfinite(enter) & np.isfinite(leave)
    slack = SLOPE * reach + tool.plane.min_wall
    for number, corners, normals in _near(found, tool, angles, reach + aside, _greatest(leave) + tool.clearance):
        at = _on_plane(corners, normals, np.zeros((len(number), 2)))
        ends = np.where(normals[:, 2] < 0, enter[number], leave[number])
        is_end = (np.abs(normals[:, 2]) >= level) & (np.abs(at - ends) <= slack)
        met = free[number] & ~is_end & (corners[..., 2].min(axis=1) <= leave[number] + tool.clearance)
        number, corners, normals = number[met], corners[met], normals[met]
        axis = np.column_stack([np.zeros((len(number), 2)), at[met]])
        away = _least(lambda p: np.hypot(np.maximum(np.abs(p[..., 0]) - aside, 0.0), p[..., 1]), corners)
        free[number[(away < reach) | _holds(corners, normals, axis)]] = False
    return free


def drill_wall(found: Obstacles, tool: Drill, angle: float, setting: float, most: float) -> float:
    """Return how far a drill, set to a depth at an angle (rad), stays from obstacles; at most `most`, m.

    Parameters
    ----------
    tool : as it starts on the metal
    """
    through, shoulder = tool.plane.through, tool.start + setting
    itself = _Grown(0.5 * tool.diameter, 0.0 if through else tool.tip, 0.0)
    past = shoulder if through else shoulder + itself.tip + most
    for _, corners, normals in _near(found, tool, np.array([angle]), itself.half + most, past):
        level = np.abs(normals[:, 2]) if through else -normals[:, 2]
        steep = level < _level(tool)
        away = itself.distance(corners[steep], normals[steep], tool.start, shoulder)
        most = min(most, float(away.min(initial=math.inf)))
    return most


def _greatest(depths: Float) -> float:
    return float(depths[np.isfinite(depths)].max(initial=0.0))


def _level(tool: Drill) -> float:
    """Return the cosine of the angle to its axis from which on what a drill meets is a surface that it enters."""
    reach = 0.5 * tool.diameter + tool.plane.min_wall
    turned = math.asin(min(reach / tool.plane.radius, 1.0)) if tool.towards_shaft else 0.0
    return math.cos(min(math.atan(SLOPE) + turned, 0.5 * math.pi))


def _near(
    found: Obstacles, tool: Drill, angles: Float, reach: float, past: float
) -> Iterator[tuple[Int, Float, Float]]:
    """Yield triangles (k, 3, 3) near drills at angles number (k,), and their normals (k, 3), as seen with them.

    Parameters
    ----------
    reach : m, around the axis
    past : m, the depth under the plane's surface
    """
    plane, corners, normals = tool.plane, found.corners, found.normals
    sign, back = (-1.0 if plane.face == "b" else 1.0), -tool.clearance
    nearest, z = from_shaft(corners[..., :2]), corners[..., 2]
    far = np.linalg.norm(corners[..., :2], axis=2).max(axis=1)
    if tool.towards_shaft:
        beside, shallow, deep = gap(z - plane.z), plane.radius - far, plane.radius - nearest
    else:
        beside = np.maximum(np.maximum(nearest - plane.radius, plane.radius - far), 0.0)
        depth = sign * (z - plane.entry)
        shallow, deep = depth.min(axis=1), depth.max(axis=1)
    near = (beside <= reach) & (shallow <= past) & (deep >= back)
    corners, normals, nearest = corners[near], normals[near], nearest[near]
    middle, half = facing_angles(corners[..., :2])
    spread = np.where(nearest > reach, np.arcsin(np.minimum(reach / np.maximum(nearest, 1e-300), 1.0)), math.pi)
    item, number = pairs(middle - half - spread, middle + half + spread, angles)
    for low in range(0, len(item), _AT_ONCE):
        these, those = item[low : low + _AT_ONCE], number[low : low + _AT_ONCE]
        u = np.column_stack([np.cos(angles[those]), np.sin(angles[those])])
        around = [np.einsum("kvi,ki->kv", corners[these, :, :2], k) for k in (np.column_stack([-u[:, 1], u[:, 0]]), u)]
        turned = [np.einsum("ki,ki->k", normals[these, :2], k) for k in (np.column_stack([-u[:, 1], u[:, 0]]), u)]
        height, upward = corners[these, :, 2], normals[these, 2]
        if tool.towards_shaft:
            seen = np.stack([around[0], height - plane.z, plane.radius - around[1]], axis=2)
            faced = np.column_stack([turned[0], upward, -turned[1]])
        else:
            seen = np.stack([around[0], around[1] - plane.radius, sign * (height - plane.entry)], axis=2)
            faced = np.column_stack([turned[0], turned[1], sign * upward])
        keep = (gap(seen[..., 0]) <= reach) & (gap(seen[..., 1]) <= reach)
        keep &= (seen[..., 2].max(axis=1) >= back) & (seen[..., 2].min(axis=1) <= past)
        yield those[keep], seen[keep], faced[keep]


def _least(function: Callable[[Float], Float], corners: Float) -> Float:
    """Return the least of a convex function of points (..., 3) on the edges of triangles (k, 3, 3)."""
    start, edge = corners, np.roll(corners, -1, axis=1) - corners
    low, high = np.zeros(corners.shape[:2]), np.ones(corners.shape[:2])
    ends = np.minimum(function(corners), np.inf)
    left, right = high - _GOLDEN, low + _GOLDEN
    at_left, at_right = (function(start + k[..., None] * edge) for k in (left, right))
    for _ in range(_NARROWED):
        down = at_left < at_right
        low, high = np.where(down, low, left), np.where(down, right, high)
        new = np.where(down, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        value = function(start + new[..., None] * edge)
        left, right = np.where(down, new, right), np.where(down, left, new)
        at_left, at_right = np.where(down, value, at_right), np.where(down, at_left, value)
    return np.asarray(np.minimum(np.minimum(at_left, at_right), ends).min(axis=1))


def _on_plane(corners: Float, normals: Float, places: Float) -> Float:
    """Return t of the planes of triangles at places (k, 2) across the axis; infinite for planes along it."""
    rise = np.einsum("ij,ij->i", normals[:, :2], corners[:, 0, :2] - places)
    steep = np.divide(rise, normals[:, 2], out=np.full(len(rise), np.inf), where=np.abs(normals[:, 2]) > 1e-12)
    return np.asarray(corners[:, 0, 2] + steep)


def _holds(corners: Float, normals: Float, points: Float) -> Bool:
    """Return whether triangles hold points (k, 3) of their planes; not those at infinity."""
    edge = np.roll(corners, -1, axis=1) - corners
    with np.errstate(invalid="ignore"):
        side = np.einsum("kvi,ki->kv", np.cross(edge, points[:, None] - corners), normals)
    return np.asarray((side >= 0).all(axis=1) | (side <= 0).all(axis=1))
