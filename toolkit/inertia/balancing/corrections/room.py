"""Room for a tool at every angle around the rotor: how deep it may go before less than the wall is left of the part.

Rays run beside each other where the tool would run: along its axis, along its wall, and as far outside of that as the
wall is thick. All of them have to meet the surface near where the tool starts, or it starts in air or breaks out of a
side, and to stay in material as deep as the tool goes, and the wall below. A tool that runs towards the shaft ends
there at the latest. What lies between the rays limits it as well: see `obstacles`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.corrections.correction_plane import FULL_TURN, CorrectionPlane
from inertia.balancing.corrections.cutter_clearance import arc_room, arc_wall, flat_room, flat_wall
from inertia.balancing.corrections.drill_clearance import drill_room, drill_wall, goes_through
from inertia.balancing.corrections.drilling import Drill
from inertia.balancing.corrections.milling import ArcCutter, FlatCutter
from inertia.balancing.corrections.obstacles import Obstacles, obstacles
from inertia.balancing.corrections.sweeps import pairs
from inertia.balancing.corrections.tool import Ray, Tool
from inertia.balancing.corrections.workpiece import Body, run
from inertia.errors import GeometryError
from inertia.records import dataclass

_TOUCHING = 1e-6  # m: bodies with a gap no wider than this are one wall
PROUD = 0.01  # of the radius: how far the surface may be from where the file says; of a thickness as well
_ROUNDED = 1e-6  # of the radius: what float32 leaves of a place
_TINY = 1e-12
_OFTEN = 0.1
_AROUND = 720  # angles at which the rim is looked at for an arc
_BESIDE = 1.7e-8  # m or rad: rays run beside the edges of round parts, which stand at round angles


@dataclass(frozen=True, eq=False)
class Metal:
    """What is met along the axis of a plane's tools at angles (m,); nan where nothing is.

    Attributes
    ----------
    enter, leave : m, under the plane's own surface, where metal begins and ends
    density : kg/m³
    sag : m; facets that lie no farther than this from the plane's surface stand for it
    """

    enter: Float
    leave: Float
    density: Float
    sag: float

    @property
    def starts(self) -> Float:
        """Where depths are counted from, m."""
        return np.where(np.abs(self.enter) > self.sag, self.enter, 0.0)

    @property
    def thickness(self) -> Float:
        """How much there is, m."""
        return self.leave - self.enter


def metal(bodies: Sequence[Body], tool: Tool, angles: Float, sag: float) -> Metal:
    """Return what a tool of a plane meets along its axis at angles (m,) rad.

    Parameters
    ----------
    sag : m, by which the facets of a round surface miss it; faces that holes along the shaft enter are true
    """
    least = max(sag if tool.towards_shaft else 0.0, _ROUNDED * tool.plane.radius)
    return Metal(*_material(bodies, tool, tool.rays()[0], angles), least)


def rooms(bodies: Sequence[Body], tools: Sequence[Tool], angles: Float, sag: float) -> tuple[list[Float], Metal]:
    """Return the greatest setting of each tool at angles (m,) rad, −∞ where it cannot start, and the metal there.

    Parameters
    ----------
    bodies : in shaft axes
    tools : of one plane, those that cut
    angles : ascending
    sag : m, as for `metal`
    """
    found = metal(bodies, tools[0], angles, sag)
    near = obstacles(bodies, tools[0], _begins(tools[0], found))
    if not isinstance(tools[0], ArcCutter):
        return [_clear(near, tool, angles, found, _deepest(bodies, tool, angles, found)) for tool in tools], found
    around = FULL_TURN * np.arange(_AROUND) / _AROUND
    bottom = _deepest(bodies, tools[0], around, metal(bodies, tools[0], around, sag))
    away = np.abs((angles[:, None] - around + math.pi) % FULL_TURN - math.pi)
    room = []
    for tool in tools:
        assert isinstance(tool, ArcCutter)
        # An arc stays as far from the shaft as it is in its middle, where its depth is counted from the metal.
        bad = ~(bottom >= (tool.depth + found.starts)[:, None] - _TINY)
        half = np.where(bad, away, math.inf).min(axis=1) - FULL_TURN / _AROUND
        start = float(found.starts[np.isfinite(found.starts)].max(initial=0.0))
        room.append(tool.within(np.minimum(half, arc_room(near, tool, angles, start))))
    return room, found


def _begins(tool: Tool, found: Metal) -> Float:
    """Return where metal begins under a plane's surface near that, m."""
    near = np.abs(found.enter) <= max(PROUD * tool.plane.radius, _TOUCHING)
    return found.enter[near]


def _clear(near: Obstacles, tool: Tool, angles: Float, found: Metal, most: Float) -> Float:
    """Return how deep a tool may go at angles (m,) rad, from where its metal begins, −∞ where it may not start.

    Parameters
    ----------
    most : (m,) how deep rays let it go under its plane's surface
    """
    if isinstance(tool, FlatCutter):
        room = flat_room(near, tool, angles, most, float(_begins(tool, found).min(initial=0.0)))
    elif isinstance(tool, Drill) and tool.plane.through:
        free = goes_through(near, tool, angles, found.enter, found.leave, _between(tool, angles))
        room = np.where(free, most, -math.inf)
    elif isinstance(tool, Drill):
        room = drill_room(near, tool, angles, most, _between(tool, angles))
    else:
        room = most
    return np.where(room > found.starts, room, -math.inf) - found.starts


def _between(tool: Tool, angles: Float) -> float:
    """Return how far beside the nearest of the angles looked at a tool may be set, m."""
    plane = tool.plane
    if plane.angles != "free" or len(angles) < 2:
        return 0.0
    apart = float(angles[1] - angles[0])
    return 0.5 * apart * plane.radius if plane.angle_step < apart * (1 - _TINY) else 0.0


def _deepest(bodies: Sequence[Body], tool: Tool, angles: Float, found: Metal) -> Float:
    """Return how far under its plane's surface a tool may go at angles (m,) rad, −∞ where it cannot start."""
    plane, near = tool.plane, max(PROUD * tool.plane.radius, _TOUCHING)
    room = np.where(np.abs(found.enter) <= near, math.inf, -math.inf)
    if plane.through and plane.max_depth is not None:
        room[found.thickness > plane.max_depth * (1 + PROUD)] = -math.inf
    for ray in tool.rays():
        enter, leave, _ = _material(bodies, tool, ray, angles)
        later = enter - found.enter
        meets = np.isfinite(enter)
        deep = math.inf if plane.through else leave - ray.ahead
        limit = np.where(meets, deep, -math.inf if ray.lag is not None else math.inf)
        with np.errstate(invalid="ignore"):
            if ray.lag is not None:
                limit[~(np.abs(later) <= ray.lag + _TOUCHING)] = -math.inf
            else:  # beside the rim there may be air, but no shoulder
                limit[later < -near] = -math.inf
        room = np.minimum(room, limit)
    return np.where(room > found.starts, room, -math.inf)


def _material(bodies: Sequence[Body], tool: Tool, ray: Ray, angles: Float) -> tuple[Float, Float, Float]:
    """Return where rays enter material and leave it, from where the tool starts, and its density; nan for none."""
    hits = [_hits(body.corners, tool, ray, angles) for body in bodies]
    number = np.concatenate([k for k, _, _ in hits])
    depth = np.concatenate([k for _, k, _ in hits])
    entering = np.concatenate([k for _, _, k in hits])
    density = np.concatenate([np.full(len(k), body.density) for body, (k, _, _) in zip(bodies, hits, strict=True)])
    keep = depth >= -tool.clearance
    number, depth, entering, density = number[keep], depth[keep], entering[keep], density[keep]
    # Where one body ends and another begins, the wall goes on.
    order = np.lexsort((depth + np.where(entering, 0.0, _TOUCHING), number))
    number, depth, entering, density = number[order], depth[order], entering[order], density[order]
    level = np.cumsum(np.where(entering, 1, -1))
    first = np.searchsorted(number, np.arange(len(angles)))
    before = np.concatenate([[0], level])[first]
    enter, leave, into = (np.full(len(angles), math.nan) for _ in range(3))
    met, opening = np.unique(number, return_index=True)
    closing = np.flatnonzero(~entering & (level == before[number]))
    until = np.full(len(angles), tool.radius if tool.towards_shaft else math.nan)
    ended, ends = np.unique(number[closing], return_index=True)
    until[ended] = depth[closing[ends]]
    inside = entering[opening] & ~np.isnan(until[met])
    met, opening = met[inside], opening[inside]
    enter[met], leave[met], into[met] = depth[opening], until[met], density[opening]
    return enter, leave, into


def _hits(corners: Float, tool: Tool, ray: Ray, angles: Float) -> tuple[Int, Float, Bool]:
    """Return the angles' numbers, the depths and whether a body is entered there, for all crossings of its surface."""
    plane = tool.plane
    if tool.towards_shaft:
        first, last = _section(corners, plane.z + ray.along + _BESIDE)
        ray_number, s, entering = _across(first, last, ray.aside + _BESIDE, angles)
        return ray_number, tool.radius - s, entering
    radius = math.hypot(plane.radius + ray.along + _BESIDE, ray.aside)
    turned = math.atan2(ray.aside, plane.radius + ray.along) + _BESIDE
    ray_number, z, upward = _upward(corners, radius, angles + turned)
    if plane.face == "a":
        return ray_number, z - tool.entry, ~upward
    return ray_number, tool.entry - z, upward


def faces(bodies: Sequence[Body], tool: Tool, angles: Float) -> Float:
    """Return where along the shaft the faces are that a tool along it could enter at its radius, ascending, m.

    Faces within a hundredth of the radius are one; each has to be there at a tenth of the angles.
    """
    sign = 1.0 if tool.plane.face == "a" else -1.0
    hits = [_hits(body.corners, tool, tool.rays()[0], angles) for body in bodies]
    z = np.sort(tool.entry + sign * np.concatenate([depth[entering] for _, depth, entering in hits]))
    groups = np.split(z, np.flatnonzero(np.diff(z) > PROUD * tool.plane.radius) + 1) if len(z) else []
    return np.array([np.median(k) for k in groups if len(k) >= _OFTEN * len(angles)])


def _section(corners: Float, z: float) -> tuple[Float, Float]:
    """Return the segments (k, 2) and (k, 2) in which triangles cut a plane across the shaft, the body on their left."""
    above = corners[:, :, 2] > z
    count = above.sum(axis=1)
    triangles = corners[(count == 1) | (count == 2)]
    up = triangles[:, :, 2] > z
    lone = np.where(up.sum(axis=1) == 1, up.argmax(axis=1), (~up).argmax(axis=1))
    rows = np.arange(len(triangles))
    tip, left, right = (triangles[rows, (lone + k) % 3] for k in range(3))
    flip = up.sum(axis=1) == 1
    points = []
    for other in (left, right):
        share = (z - tip[:, 2]) / (other[:, 2] - tip[:, 2])
        points.append(tip[:, :2] + share[:, None] * (other - tip)[:, :2])
    first = np.where(flip[:, None], points[0], points[1])
    last = np.where(flip[:, None], points[1], points[0])
    return first, last


def _across(first: Float, last: Float, aside: float, angles: Float) -> tuple[Int, Float, Bool]:
    """Return where lines towards the shaft, `aside` from it, cross segments with a body on their left."""
    near = np.minimum(np.linalg.norm(first, axis=1), np.linalg.norm(last, axis=1))
    edge = last - first
    length = np.maximum(np.einsum("ij,ij->i", edge, edge), 1e-300)
    foot = np.clip(-np.einsum("ij,ij->i", first, edge) / length, 0.0, 1.0)
    near = np.minimum(near, np.linalg.norm(first + foot[:, None] * edge, axis=1))
    spread = np.where(near > abs(aside), np.arcsin(np.minimum(abs(aside) / np.maximum(near, 1e-300), 1.0)), math.pi)
    one = np.arctan2(first[:, 1], first[:, 0]) % FULL_TURN
    turn = (np.arctan2(last[:, 1], last[:, 0]) - one + math.pi) % FULL_TURN - math.pi
    item, number = pairs(one + np.minimum(turn, 0) - spread, one + np.maximum(turn, 0) + spread, angles)
    turns = np.exp(-1j * angles)[number]
    here, there = ((points[:, 0] + 1j * points[:, 1])[item] * turns for points in (first, last))
    low, high = here.imag > aside, there.imag > aside
    met = low != high
    item, number, here, there = item[met], number[met], here[met], there[met]
    s = here.real + (aside - here.imag) / (there.imag - here.imag) * (there - here).real
    entering = there.imag > here.imag
    outside = s > 0
    return number[outside], s[outside], entering[outside]


def _upward(corners: Float, radius: float, angles: Float) -> tuple[Int, Float, Bool]:
    """Return where lines along the shaft at a radius and angles cross triangles, z and whether they face upward."""
    flat = corners[:, :, :2]
    far = np.linalg.norm(flat, axis=2).max(axis=1)
    corners = corners[far >= radius]
    flat = corners[:, :, 0] + 1j * corners[:, :, 1]
    one = np.angle(flat[:, 0])
    turns = (np.angle(flat) - one[:, None] + math.pi) % FULL_TURN - math.pi
    low, high = turns.min(axis=1), turns.max(axis=1)
    whole = high - low >= math.pi  # the shaft's axis may run through it
    order = np.argsort(angles % FULL_TURN, kind="stable")
    low, high = np.where(whole, 0.0, (one + low) % FULL_TURN), np.where(whole, FULL_TURN, high - low)
    item, place = pairs(low, low + high, (angles % FULL_TURN)[order])
    number = order[place]
    point = radius * np.exp(1j * angles[number])
    a, b, c = (flat[item, k] - point for k in range(3))
    areas = np.array([(b.conj() * c).imag, (c.conj() * a).imag, (a.conj() * b).imag])
    total = areas.sum(axis=0)
    inside = ((areas >= 0).all(axis=0) | (areas <= 0).all(axis=0)) & (total != 0)
    item, number, areas, total = item[inside], number[inside], areas[:, inside], total[inside]
    z = np.einsum("ki,ik->i", areas / total, corners[item, :, 2])
    return number, z, total > 0


def remaining_wall(bodies: Sequence[Body], tool: Tool, angle: float, setting: float) -> float:
    """Return how much of the part is left between a tool and the next surface, m; infinite where it cuts nothing.

    That is to the nearest surface that the tool does not enter, in any direction, and under it no farther than to the
    shaft's axis. Holes through have a wall beside them.
    """
    limits = [math.inf]
    angles, deep = tool.under(angle, setting)
    for ray in tool.rays():
        _, leave, _ = _material(bodies, tool, ray, angles)
        if ray.under is not None and not tool.plane.through and np.isfinite(leave).any():
            limits.append(float(np.nanmin(leave)) - deep - ray.under)
    limits += [
        stretch[1] - beside
        for origin, direction, beside in tool.sideways(angle, setting)
        if (stretch := run(bodies, origin, direction)) is not None
    ]
    return _nearest(bodies, tool, angle, setting, min(limits))


def _nearest(bodies: Sequence[Body], tool: Tool, angle: float, setting: float, most: float) -> float:
    """Return how far a tool on the metal stays from all that it does not enter; at most `most`, m."""
    span = float(np.linalg.norm(np.ptp(np.concatenate([body.box for body in bodies]), axis=0)))
    near, within = obstacles(bodies, tool, np.array([tool.start])), min(most, span)
    nearest = within
    if isinstance(tool, Drill):
        nearest = drill_wall(near, tool, angle, setting, within)
    elif isinstance(tool, FlatCutter):
        nearest = flat_wall(near, tool, angle, setting, within)
    elif isinstance(tool, ArcCutter):
        nearest = arc_wall(near, tool, angle, setting, within)
    return nearest if nearest < within else most


def _there(places: Float, plane: CorrectionPlane) -> str:
    """Say where the faces are that a tool along the shaft could enter."""
    towards = (plane.face or "").upper()
    if len(places) == 0:
        return f"; no face to {towards} is at that radius"
    listed = " and ".join(f"{1e3 * z:.6g}" for z in places.tolist())
    return f"; at that radius the faces to {towards} are at z = {listed} mm: give one of them as face_z"


def no_room(bodies: Sequence[Body], tool: Tool, angle: float) -> GeometryError:
    """Return why a tool can start at no angle, said of one of them (rad)."""
    plane = tool.plane
    where = f"plane {plane.id!r} at z = {1e3 * plane.z:.6g} mm, {round(math.degrees(angle), 2) % 360:g} degrees"
    enter, leave, _ = (float(k[0]) for k in _material(bodies, tool, tool.rays()[0], np.array([angle])))
    reach = PROUD * plane.radius
    there = "" if tool.towards_shaft else _there(faces(bodies, tool, FULL_TURN * np.arange(_AROUND) / _AROUND), plane)
    if not math.isfinite(enter) or enter > reach:
        return GeometryError(
            f"{where}: there is no material for the tool under the radius of {1e3 * plane.radius:.6g} mm: move the "
            f"plane onto the part, or correct its radius{there}"
        )
    if enter < -reach:
        return GeometryError(
            f"{where}: the part begins {-1e3 * enter:.4g} mm before the surface that depths are measured from: give "
            f"the {'radius' if tool.towards_shaft else 'face'} where the tool enters{there}"
        )
    if plane.through and plane.max_depth is not None and leave - enter > plane.max_depth * (1 + PROUD):
        return GeometryError(
            f"{where}: a hole through goes {1e3 * (leave - enter):.6g} mm deep, as thick as the part is there, past "
            f"the max_depth of {1e3 * plane.max_depth:.6g} mm: correct max_depth, or leave it out"
        )
    return GeometryError(
        f"plane {plane.id!r} at z = {1e3 * plane.z:.6g} mm: at every angle its tools break out of the part, or leave "
        f"less than {1e3 * plane.min_wall:g} mm of it: use a smaller tool, a smaller wall where that is safe, or "
        "another radius or place of the plane"
    )
