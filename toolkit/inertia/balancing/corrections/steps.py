"""What the shop can do in a plane, step by step: every angle and setting of every tool, and which go side by side.

Two holes keep their web where their axes are as far apart as both radii and the web are together, as deep as both of
them go. So how close they may be depends on how deep they *are*, not on how deep they might be.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from inertia.arrays import Bool, Float
from inertia.balancing.corrections.correction_plane import FULL_TURN, CorrectionPlane
from inertia.balancing.corrections.drilling import Drill, RadialDrill
from inertia.balancing.corrections.milling import ArcCutter, Cutter
from inertia.balancing.corrections.tool import Tool
from inertia.records import dataclass

_FINE = math.radians(0.5)  # between angles where any may be set
_ANGLES = 1440  # tried around the shaft; finer steps are set where the places are known
_SETTINGS = 512
_SAME = 1e-9
_RIM = Cutter | RadialDrill
_ALONG = 64  # places along a tool at which its distance from another is taken


@dataclass(frozen=True, eq=False)
class Steps:
    """One tool of a plane at the angles and settings that the shop can set.

    Attributes
    ----------
    plane : its number
    tool : with its plane
    angles : (m,) rad, ascending
    settings : (s,) ascending
    sizes : (s,) kg m, the unbalance that each takes or adds
    most : (m,) the greatest setting at each angle; −∞ where it may not be used
    starts : (m,) m, how far under the plane's surface the metal begins, which depths are counted from
    """

    plane: int
    tool: Tool
    angles: Float
    settings: Float
    sizes: Float
    most: Float
    starts: Float

    @property
    def count(self) -> int:
        """How many angles there are times how many settings."""
        return len(self.angles) * len(self.settings)

    @property
    def complete(self) -> bool:
        """Whether these are all angles and settings that the shop can set, and not some of them."""
        tool, plane = self.tool, self.tool.plane
        near = _within(self.angles, plane.angle_step)
        every = _within(self.settings, tool.step) and math.isfinite(tool.greatest)
        return (plane.angles != "free" or near) and (tool.least == tool.greatest or every)

    def on_metal(self, number: int) -> Tool:
        """Return the tool as it starts at angle `number`."""
        start = float(self.starts[number])
        return replace(self.tool, start=start) if start else self.tool


def _within(values: Float, step: float) -> bool:
    """Say whether ascending values lie no farther apart than a step."""
    return bool(np.diff(values).max(initial=0.0) <= step * (1 + _SAME))


def steps_of(
    number: int, tool: Tool, need: float, room: Float | float = math.inf, starts: Float | float = 0.0
) -> Steps:
    """Return the steps of a tool.

    Parameters
    ----------
    number : of its plane
    need : kg m, what is to be made up at most; a tool without limits is not set to more than a few times that
    room, starts : greatest setting that the part leaves, and m under the plane's surface where it begins, at all angles
        or at each of `angles_of` the plane
    """
    angles = angles_of(tool.plane)
    settings = _settings(tool, need, angles)
    greatest = np.minimum(_clear_of_sectors(tool, angles, settings), room)
    sizes = np.array([tool.unbalance(setting) for setting in settings.tolist()])
    return Steps(number, tool, angles, settings, sizes, greatest, np.broadcast_to(starts, angles.shape))


def angles_of(plane: CorrectionPlane) -> Float:
    """Return the angles that are tried in a plane, ascending, rad."""
    if plane.angles != "free":
        return np.unique(np.array(plane.angles) % FULL_TURN)
    step = plane.angle_step or _FINE
    count = math.ceil(FULL_TURN / step - _SAME)
    stride = math.ceil(count / _ANGLES)
    return np.arange(0.0, count, stride) * step


def _settings(tool: Tool, need: float, angles: Float) -> Float:
    least, greatest, count = tool.least, tool.greatest, _SETTINGS
    if not math.isfinite(greatest):
        # What two positions share takes no more of either than the whole, unless they are far apart.
        apart = float(np.diff(angles, append=angles[:1] + FULL_TURN).max(initial=0.0))
        widest = 1.0 if apart <= 0.5 * math.pi else min(4.0, 1.0 / max(math.sin(apart), 0.25))
        greatest, count = tool.setting(widest * need), 16 * _SETTINGS
    if greatest <= least:
        return np.array([greatest])
    step = tool.step or (greatest - least) / count
    stride = math.ceil((greatest - least) / step / (16 * _SETTINGS))
    first, last = math.ceil(least / step - _SAME), math.floor(greatest / step + _SAME)
    # 0.0124 rather than 0.012400000000000001
    return np.round(step * np.arange(first, last + 1, stride), 15) if last >= first else np.array([greatest])


def _clear_of_sectors(tool: Tool, angles: Float, settings: Float) -> Float:
    """Return the greatest setting at each angle that keeps out of the forbidden sectors."""
    greatest = np.full(len(angles), float(settings[-1]))
    if tool.plane.forbidden:
        halves = np.array([tool.half_angle_at(setting) for setting in settings.tolist()])
        for k, angle in enumerate(angles.tolist()):
            room = min(sector.distance(angle) for sector in tool.plane.forbidden)
            fits = int(np.searchsorted(halves, room + _SAME, side="right"))
            greatest[k] = settings[fits - 1] if fits and room >= 0 else -math.inf
    return greatest


def room_beside(steps: Steps, other: Tool, angle: float, setting: float) -> Float:
    """Return the greatest setting (m,) at the angles of steps beside a tool that is at work; −∞ where there is none.

    Parameters
    ----------
    other, angle, setting : what is there
    """
    tool, angles = steps.tool, steps.angles
    room = np.full(len(angles), math.inf)
    if isinstance(tool, Drill) and isinstance(other, Drill):
        # Seen from the plane's surface a hole goes deeper by as much as the metal begins under it.
        return _between_drills(tool, angles, float(steps.starts.max()), other, angle, setting) - steps.starts
    if tool.plane.id == other.plane.id:
        away = np.abs((angles - angle + math.pi) % FULL_TURN - math.pi)
        if isinstance(tool, Cutter):
            return tool.within(away - other.half_angle_at(setting))
        room[away < 0.5 * (tool.apart_at(0.0) + other.apart_at(0.0)) - _SAME] = -math.inf
    elif _meet_along(tool, other):
        away = np.abs((angles - angle + math.pi) % FULL_TURN - math.pi) - other.half_angle_at(setting)
        if isinstance(tool, Cutter):
            return tool.within(away)
        room[away < tool.half_angle_at(tool.greatest) - _SAME] = -math.inf
    return room


def _meet_along(tool: Tool, other: Tool) -> bool:
    """Say whether an arc and other work on the rim in another plane reach into each other's width."""
    widths = [k.along if isinstance(k, Cutter) else 0.5 * k.diameter for k in (tool, other) if isinstance(k, _RIM)]
    arcs = isinstance(tool, ArcCutter) or isinstance(other, ArcCutter)
    return arcs and len(widths) == 2 and abs(tool.plane.z - other.plane.z) < sum(widths)


def _between_drills(tool: Drill, angles: Float, past: float, other: Drill, angle: float, setting: float) -> Float:
    need = 0.5 * (tool.diameter + other.diameter) + max(tool.plane.web, other.plane.web)
    starts, along = tool.axes(angles)
    start, direction = (k[0] for k in other.axes(np.array([angle])))
    deepest = tool.greatest + past
    setting, other = setting + other.start, replace(other, start=0.0)
    if tool.plane.id == other.plane.id:  # both run towards the shaft, or along it
        away = np.abs((angles - angle + math.pi) % FULL_TURN - math.pi)
        depth = tool.depth_beside(need, away, setting)
        return np.where(depth >= 0, depth, -math.inf)
    if np.linalg.norm(starts - start, axis=1).min() > need + deepest + setting:
        return np.full(len(angles), math.inf)
    places = deepest * np.arange(_ALONG + 1) / _ALONG
    points = starts[:, None] + places[:, None] * along[:, None]
    reach = np.clip((points - start) @ direction, 0.0, setting)
    apart = np.linalg.norm(points - start - reach[..., None] * direction, axis=2)
    near = apart < need + 0.5 * deepest / _ALONG
    first = np.where(near.any(axis=1), near.argmax(axis=1), _ALONG + 1)
    return np.where(first > _ALONG, math.inf, np.where(first > 0, places[np.maximum(first - 1, 0)], -math.inf))


def allowed(steps: Steps) -> Bool:
    """Return which settings are allowed at which angles, (m, s)."""
    allowed: Bool = steps.settings <= steps.most[:, None] + _SAME
    return allowed
