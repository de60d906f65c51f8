"""Flats and arcs milled, or ground, on a round part.

A flat of depth h and width w on the radius R takes away a circular segment with the chord c = 2 √(2 R h − h²). Its
first moment about the shaft is ∫ 2 s √(R² − s²) ds from R − h to R = c³/12, so that U(h) = ρ w c³/12.

An arc takes the depth h over an angle φ of the rim: U = 2 ρ w sin(φ/2) ∫ s² ds from R − h to R. That is less than its
mass on its mean radius by sin(φ/2)/(φ/2), and most at 180°. A cutter of diameter d, whose axis is parallel to the
shaft and goes from one end of the arc to the other, takes more on either side: at the distance s from the shaft as
far as the angle β(s), cos β = (s² + a² − d²/4)/(2 s a) with a = R − h + d/2, so that

    U(φ) = 2 ρ w ∫ s² sin(φ/2 + β) ds = 2 ρ w √(A² + B²) sin(φ/2 + δ),

A = ∫ s² cos β ds, B = ∫ s² sin β ds, tan δ = B/A.
"""

from __future__ import annotations

import cmath
import math
from abc import abstractmethod
from functools import lru_cache

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import angle_of
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.tool import Ray, Tool
from inertia.mesh.cut import block, ring_segment
from inertia.mesh.surface import Surface
from inertia.records import dataclass

_DEEPEST = 0.5  # of the radius, where no limit is given: the chord then spans 120°
_NODES = 32
_STATION = math.radians(0.5)  # between the corners of an arc as it is cut
_STATIONS = 24  # on what a cutter takes beyond either end
_SAME = 1e-9
_PAST = 1e-8  # of the radius
_ALONG = 0.999  # of the width, where rays run


def flat_unbalance(density: float, radius: float, width: float, depth: float) -> float:
    """Return the unbalance that a flat takes away, ρ w c³/12, kg m.

    Parameters
    ----------
    density : kg/m³
    radius : R, m
    width : w, m along the shaft
    depth : h, m under the round surface
    """
    half_chord_squared = depth * (2 * radius - depth)
    return density * width * 2 / 3 * half_chord_squared * math.sqrt(half_chord_squared)


def flat_depth(density: float, radius: float, width: float, unbalance: float) -> float:
    """Return the depth (m) of a flat that takes away an unbalance (kg m); not a number where none takes so much.

    >>> round(1e3 * flat_depth(7850, 0.1, 0.02, flat_unbalance(7850, 0.1, 0.02, 0.005)), 9)
    5.0
    """
    half_chord_squared = math.cbrt(1.5 * unbalance / (density * width)) ** 2
    distance_squared = radius**2 - half_chord_squared
    return half_chord_squared / (radius + math.sqrt(distance_squared)) if distance_squared >= 0 else math.nan


def flat_volume(radius: float, width: float, depth: float) -> float:
    """Return the volume that a flat takes away, w (R² φ − (R − h) c/2) with cos φ = 1 − h/R, m³."""
    half = math.acos(1 - depth / radius)
    return width * (radius**2 * half - (radius - depth) * math.sqrt(depth * (2 * radius - depth)))


@dataclass(frozen=True)
class ArcIntegrals:
    """What an arc takes, over its width: ∫ s ds, ∫ s β ds (m²), ∫ s² cos β ds and ∫ s² sin β ds (m³)."""

    even: float
    beside: float
    cosine: float
    sine: float

    @property
    def turn(self) -> float:
        """δ, rad."""
        return math.atan2(self.sine, self.cosine)


@lru_cache(maxsize=256)
def arc_integrals(radius: float, depth: float, cutter: float | None = None) -> ArcIntegrals:
    """Integrate over the depth of an arc, by Gauss's rule in √(s − R + h) where a cutter has a diameter.

    Parameters
    ----------
    radius : R, m
    depth : h, m
    cutter : d, m; None for square ends
    """
    low = radius - depth
    even = 0.5 * depth * (radius + low)
    if cutter is None:
        return ArcIntegrals(even, 0.0, depth * (radius**2 + radius * low + low**2) / 3, 0.0)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    t = 0.5 * (nodes + 1)
    s = low + depth * t**2
    weights = weights * depth * t
    beta = _beyond(s, radius, depth, cutter)
    sums = (weights @ (s * beta), weights @ (s**2 * np.cos(beta)), weights @ (s**2 * np.sin(beta)))
    return ArcIntegrals(even, *map(float, sums))


def _beyond(s: Float, radius: float, depth: float, cutter: float) -> Float:
    """Return the angle β by which a cutter reaches beyond its axis at a distance from the shaft."""
    low = radius - depth
    square = (s - low) * (low + cutter - s) / (4 * s * (low + 0.5 * cutter))
    angles: Float = 2 * np.arcsin(np.sqrt(np.maximum(square, 0.0)))
    return angles


def arc_unbalance(
    density: float, radius: float, width: float, depth: float, arc: float, cutter: float | None = None
) -> float:
    """Return the unbalance that an arc takes away, kg m.

    Parameters
    ----------
    density : kg/m³
    radius : R, m
    width : w, m along the shaft
    depth : h, m under the round surface
    arc : φ, rad, between the ends; with a cutter between its axes at the ends
    cutter : d, m; None for square ends

    >>> full = arc_unbalance(7850, 0.1, 0.02, 0.001, 1e-6) / 1e-6
    >>> round(arc_unbalance(7850, 0.1, 0.02, 0.001, 1.0) / full, 6), round(math.sin(0.5) / 0.5, 6)
    (0.958851, 0.958851)
    """
    of = arc_integrals(radius, depth, cutter)
    return 2 * density * width * (of.cosine * math.sin(0.5 * arc) + of.sine * math.cos(0.5 * arc))


def arc_volume(radius: float, width: float, depth: float, arc: float, cutter: float | None = None) -> float:
    """Return the volume that an arc takes away, m³."""
    of = arc_integrals(radius, depth, cutter)
    return width * (arc * of.even + 2 * of.beside)


@dataclass(frozen=True)
class Cutter(Tool):
    """A mill or a grinding wheel on the rim of a part."""

    @property
    def width(self) -> float:
        """Width along the shaft, m."""
        assert self.plane.width is not None, "a plane that is milled has a width"
        return self.plane.width

    @property
    def along(self) -> float:
        """Half of its width, m."""
        return 0.5 * self.width

    @property
    def _half_cut(self) -> float:
        """Half of the width that is cut: past the faces of a part as wide, where rounding would leave a skin of it."""
        return self.along + _PAST * self.radius

    @property
    def clearance(self) -> float:
        """Half of the radius."""
        return 0.5 * self.radius

    @abstractmethod
    def within(self, half: Float) -> Float:
        """Return the greatest setting that reaches to both sides of its angle by half-angles (m,); −∞ for none."""


@dataclass(frozen=True)
class FlatCutter(Cutter):
    """A mill that makes flats, set in m of depth."""

    @property
    def greatest(self) -> float:
        """The largest depth, m."""
        deepest = _DEEPEST * self.radius if self.plane.max_depth is None else self.plane.max_depth
        return max(deepest if self.limit is None else min(deepest, self.limit), 0.0)

    def half_angle_at(self, setting: float) -> float:
        """Half the angle that a flat of this depth takes."""
        return math.acos(1 - setting / self.radius)

    def apart_at(self, setting: float) -> float:
        """The angle at which two flats of this depth meet."""
        return 2 * self.half_angle_at(setting)

    def unbalance(self, setting: float) -> float:
        """Return the unbalance taken, kg m."""
        return flat_unbalance(self.density, self.radius, self.width, setting)

    def setting(self, unbalance: float) -> float:
        """Return the depth, m."""
        return flat_depth(self.density, self.radius, self.width, unbalance)

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the flat."""
        plane = self.plane
        return Operation(
            id=name,
            plane=plane.id,
            z=plane.z,
            method="remove",
            kind="mill_flat",
            angle=angle_of(cmath.rect(1.0, angle)),
            radius=self.radius,
            mass=self.density * flat_volume(self.radius, self.width, setting),
            unbalance=-cmath.rect(self.unbalance(setting), angle),
            unbalance_z=plane.z,
            depth=setting,
            width=self.width,
        )

    def within(self, half: Float) -> Float:
        """Return the depth of a flat over twice a half-angle."""
        deep = self.radius * (1.0 - np.cos(np.clip(half, 0.0, 0.5 * math.pi)) + _SAME)
        return np.where(half > 0, deep, -math.inf)

    def solid(self, angle: float, setting: float) -> Surface:
        """Return the block above the flat."""
        radius = self.radius
        outward, aside, along = self._axes(angle)
        half = self._half_cut
        corner = (radius - setting) * outward - radius * aside + (self.plane.z - half) * along
        return block(corner, [(self.clearance + setting) * outward, 2 * radius * aside, 2 * half * along])

    def rays(self) -> tuple[Ray, ...]:
        """Return the rays at the flat's middle and at both of its ends, which may lie off the part."""
        least, end = self.plane.min_wall, 0.5 * _ALONG * self.width
        middle = Ray(0.0, 0.0, least, under=0.0)
        return middle, Ray(end, 0.0, least, None, 0.0), Ray(-end, 0.0, least, None, 0.0)

    def _axes(self, angle: float) -> Float:
        cosine, sine = math.cos(angle), math.sin(angle)
        return np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])


@dataclass(frozen=True, kw_only=True)
class ArcCutter(Cutter):
    """A cutter or a grinding wheel at one depth (m), set in rad of arc."""

    depth: float

    @property
    def step(self) -> float:
        """What the shop can set the arc to, rad."""
        return self.plane.arc_step

    @property
    def least(self) -> float:
        """The smallest arc: with round ends none, where the cutter only goes in."""
        return 0.0 if self.plane.cutter is not None else self.plane.arc_step or math.radians(1.0)

    @property
    def greatest(self) -> float:
        """The largest arc, rad: a longer one takes less."""
        most = min(self.plane.max_arc, math.pi - 2 * self._of.turn)
        return max(most if self.limit is None else min(most, self.limit), 0.0)

    @property
    def _of(self) -> ArcIntegrals:
        return arc_integrals(self.radius, self.depth, self.plane.cutter)

    @property
    def beyond(self) -> float:
        """How far it reaches beyond either end of its arc at the rim, rad."""
        plane = self.plane
        if plane.cutter is None:
            return 0.0
        return float(_beyond(np.array(self.radius), self.radius, self.depth, plane.cutter))

    def half_angle_at(self, setting: float) -> float:
        """Half the angle that an arc takes of the rim."""
        return 0.5 * setting + self.beyond

    def apart_at(self, setting: float) -> float:
        """The angle at which two arcs of this length meet."""
        return 2 * self.half_angle_at(setting)

    def within(self, half: Float) -> Float:
        """Return the length of an arc over twice a half-angle."""
        return np.where(half >= self.half_angle_at(self.least) - _SAME, 2 * (half - self.beyond) + _SAME, -math.inf)

    def unbalance(self, setting: float) -> float:
        """Return the unbalance taken, kg m."""
        plane = self.plane
        return arc_unbalance(self.density, self.radius, self.width, self.depth, setting, plane.cutter)

    def setting(self, unbalance: float) -> float:
        """Return the arc, rad; not a number where none takes so much, negative where its ends alone take more."""
        share = unbalance / (2 * self.density * self.width * math.hypot(self._of.cosine, self._of.sine))
        return 2 * (math.asin(share) - self._of.turn) if share <= 1 else math.nan

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the arc."""
        plane = self.plane
        return Operation(
            id=name,
            plane=plane.id,
            z=plane.z,
            method="remove",
            kind="mill_arc",
            angle=angle_of(cmath.rect(1.0, angle)),
            radius=self.radius,
            mass=self.density * arc_volume(self.radius, self.width, self.depth, setting, plane.cutter),
            unbalance=-cmath.rect(self.unbalance(setting), angle),
            unbalance_z=plane.z,
            tool_diameter=plane.cutter,
            depth=self.depth,
            width=self.width,
            arc=setting,
            half_angle=self.half_angle_at(setting),
            passes=1 if plane.pass_depth is None else math.ceil(self.depth / plane.pass_depth - _SAME),
        )

    def solid(self, angle: float, setting: float) -> Surface:
        """Return the ring segment that is milled away, with what the cutter takes beyond its ends."""
        plane, low = self.plane, self.radius - self.depth
        count = max(2, math.ceil(setting / _STATION))
        step = setting / count
        angles = angle + step * (np.arange(count + 1) - 0.5 * count)
        # A polygon with the area of the sector.
        inner = np.full(count + 1, low * math.sqrt(step / math.sin(step) if step else 1.0), dtype=np.float64)
        if plane.cutter is not None:
            s = low + self.depth * (np.arange(1, _STATIONS + 1) / _STATIONS) ** 2
            beyond = _beyond(s, self.radius, self.depth, plane.cutter)
            middle = angles if setting else angles[:1]
            inner = np.concatenate([s[::-1], inner[: len(middle)], s])
            angles = np.concatenate([middle[0] - beyond[::-1], middle, middle[-1] + beyond])
        outer, half = self.radius + self.clearance, self._half_cut
        return ring_segment(np.asarray(angles, float), inner, outer, plane.z - half, plane.z + half)

    def rays(self) -> tuple[Ray, ...]:
        """Return the rays at the middle of its width and at both ends, which may lie off the part."""
        least, end = self.plane.min_wall, _ALONG * self.along
        middle = Ray(0.0, 0.0, least, under=0.0)
        return middle, Ray(end, 0.0, least, None, 0.0), Ray(-end, 0.0, least, None, 0.0)

    def under(self, angle: float, setting: float) -> tuple[Float, float]:
        """Return angles all along the arc, and its depth."""
        count = max(2, math.ceil(setting / _STATION))
        return angle + setting * (np.arange(count + 1) / count - 0.5), self.depth
