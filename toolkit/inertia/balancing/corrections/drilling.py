"""Holes drilled towards the shaft or along it, with the point that a drill has.

The depth h of a hole is measured to its shoulder, where the full diameter d ends; the point, a cone of height
h_c = (d/2)/tan(angle/2), goes deeper. A = π d²/4.

Radial, from the surface of radius R. With s the distance from the shaft along the hole, the cylinder from s = R − h
to R moves ∫ s A ds = A (R h − h²/2), and the cone of volume A h_c/3, whose centroid is a quarter of its height
from its base, A (h_c/3)(R − h − h_c/4):

    U(h) = ρ A [R h − h²/2 + (h_c/3)(R − h − h_c/4)].

That is for a flat face. On a round part the hole begins at s = √(R² − y²) at a distance y beside its axis, so that
∬ ∫ s ds dA with s from √(R² − y²) to R, that is ∬ y²/2 dA = π d⁴/128, is missing, exactly.

Axial, at radius r: U(h) = ρ A r (h + h_c/3).
"""

from __future__ import annotations

import cmath
import math
from abc import abstractmethod

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import angle_of, point_length
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.tool import Ray, Tool
from inertia.mesh.cut import drill
from inertia.mesh.surface import Surface
from inertia.records import dataclass

_AROUND = 8  # rays along the wall of a hole
_WITHIN = 0.999  # of the radius, where they run
SLOPE = math.tan(math.radians(20))
"""Of the surface that a hole begins in: a drill runs off on a steeper one."""

_DEEPEST = 0.5  # of the radius, where no limit is given for a radial hole
_SMALL = 1e-18


def radial_unbalance(
    density: float, radius: float, diameter: float, depth: float, point_angle: float, *, curved: bool = True
) -> float:
    """Return the unbalance that a radial hole takes away, kg m.

    Parameters
    ----------
    density : kg/m³
    radius : R, m
    diameter : d, m
    depth : h, m, to the shoulder
    point_angle : rad; π is flat
    curved : whether the hole begins in a cylinder about the shaft rather than in a flat face

    >>> 1e6 * radial_unbalance(7850, 0.1, 0.012, 0.01, math.radians(118), curved=False)
    938.4832414...
    """
    tip = point_length(diameter, point_angle)
    lever = radius * depth - 0.5 * depth**2 + tip / 3 * (radius - depth - tip / 4)
    return density * (_area(diameter) * lever - (math.pi * diameter**4 / 128 if curved else 0.0))


def radial_depth(
    density: float, radius: float, diameter: float, unbalance: float, point_angle: float, *, curved: bool = True
) -> float:
    """Return the depth h (m) of a radial hole that takes away an unbalance (kg m), the inverse of `radial_unbalance`.

    Negative where the point alone takes more; not a number where no hole up to the shaft's axis takes so much.
    """
    tip = point_length(diameter, point_angle)
    middle = radius - tip / 3
    rest = tip / 3 * (radius - tip / 4) - (diameter**2 / 32 if curved else 0.0)
    square = middle**2 - 2 * (unbalance / (density * _area(diameter)) - rest)
    return middle - math.sqrt(square) if square >= 0 else math.nan


def radial_volume(radius: float, diameter: float, depth: float, point_angle: float, *, curved: bool = True) -> float:
    """Return the volume of a radial hole, m³: A (h + h_c/3), less what a round face leaves out.

    That is ∬ R − √(R² − y²) dA = R Σ cₖ ∬ (y/R)²ᵏ dA with c₁ = 1/2, cₖ₊₁ = cₖ (2k − 1)/(2k + 2), and
    ∬ y²ᵏ dA = π a²ᵏ⁺²/(k + 1) · (2k)!/(4ᵏ k!²), a = d/2.

    >>> 1e9 * radial_volume(0.1, 0.012, 0.01, math.pi)  # mm³
    1125.881...
    """
    full = _area(diameter) * (depth + point_length(diameter, point_angle) / 3)
    if not curved:
        return full
    ratio = (0.5 * diameter / radius) ** 2
    missing, power, share, k = 0.0, ratio, 0.25, 1  # share = c_k (2k)!/(4^k k!^2)
    while (term := power * share / (k + 1)) > _SMALL * ratio:
        missing += term
        share *= (2 * k - 1) / (2 * k + 2) * (2 * k + 1) / (2 * k + 2)
        power *= ratio
        k += 1
    return full - radius * _area(diameter) * missing


def axial_volume(diameter: float, depth: float, point_angle: float) -> float:
    """Return the volume of an axial hole, A (h + h_c/3), m³."""
    return _area(diameter) * (depth + point_length(diameter, point_angle) / 3)


def axial_middle(diameter: float, depth: float, point_angle: float) -> float:
    """Return how far the centroid of an axial hole lies under the face, m."""
    tip = point_length(diameter, point_angle)
    return (0.5 * depth**2 + tip / 3 * (depth + tip / 4)) / (depth + tip / 3)


def _area(diameter: float) -> float:
    return 0.25 * math.pi * diameter**2


@dataclass(frozen=True, kw_only=True)
class Drill(Tool):
    """A drill of a diameter, m."""

    diameter: float

    @property
    def tip(self) -> float:
        """Height of the point, m."""
        return point_length(self.diameter, self.plane.point_angle)

    @abstractmethod
    def axes(self, angles: Float) -> tuple[Float, Float]:
        """Return where holes at angles (m,) rad begin and where they go, (m, 3) each, in shaft axes and m."""

    @abstractmethod
    def depth_beside(self, need: float, away: Float, setting: float) -> Float:
        """Return how deep a hole may go, (m,) m, at angles (m,) rad, 0 … π, from one of this plane that is `setting`
        deep, so that their axes come no nearer than `need`, in m.

        Negative where they are too near from the beginning, infinite where they are never.
        """

    def _deepest(self, unless: float) -> float:
        deepest = unless if self.plane.max_depth is None else self.plane.max_depth
        return max(deepest if self.limit is None else min(deepest, self.limit), 0.0)

    def rays(self) -> tuple[Ray, ...]:
        """Return the rays along the axis, along the hole's wall, and as far outside of it as the wall is thick."""
        least, half = self.plane.min_wall, 0.5 * self.diameter
        rays = [Ray(0.0, 0.0, self.tip + least, under=self.tip)]
        for distance, ahead, under in ((_WITHIN * half, least, 0.0), (half + least, 0.0, None)):
            lag = SLOPE * distance + (distance**2 / self.radius if self.towards_shaft else 0.0)
            for angle in (2 * np.pi * np.arange(_AROUND) / _AROUND).tolist():
                along, aside = distance * math.cos(angle), distance * math.sin(angle)
                rays.append(Ray(along, aside, ahead, lag, under))
        return tuple(rays)

    def sideways(self, angle: float, setting: float) -> list[tuple[Float, Float, float]]:
        """Return rays from the shoulder: along the shaft, and of holes along it all around."""
        (start,), (direction,) = self.axes(np.array([angle]))
        origin = start + setting * direction
        ways = [np.array([0.0, 0.0, sign]) for sign in (1.0, -1.0)]
        if not self.towards_shaft:
            turns = angle + 2 * np.pi * np.arange(_AROUND) / _AROUND
            origin = start + 0.999 * setting * direction
            ways = [np.array([math.cos(k), math.sin(k), 0.0]) for k in turns.tolist()]
        return [(origin, way, 0.5 * self.diameter) for way in ways]


@dataclass(frozen=True, kw_only=True)
class RadialDrill(Drill):
    """A drill that runs towards the shaft, set in m of depth."""

    @property
    def greatest(self) -> float:
        """The largest depth, m."""
        return self._deepest(_DEEPEST * self.radius)

    def half_angle_at(self, setting: float) -> float:
        """Half the angle that the hole takes at the surface."""
        return math.asin(0.5 * self.diameter / self.radius)

    def apart_at(self, setting: float) -> float:
        """The angle at which two holes of this depth keep their web at the shoulder."""
        bottom = self.radius - setting
        need = 0.5 * (self.diameter + self.plane.web)
        return 2 * math.asin(need / bottom) if need < bottom else math.pi

    def axes(self, angles: Float) -> tuple[Float, Float]:
        """Return the axes, which run towards the shaft."""
        outward = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
        return self.radius * outward + [0.0, 0.0, self.plane.z], -outward

    def depth_beside(self, need: float, away: Float, setting: float) -> Float:
        """What is nearest of the other axis is its end, at r, or the foot on it: the deeper end is r sin ψ away."""
        end, cosine, sine = self.radius - setting, np.cos(away), np.sin(away)
        level = end * cosine + np.sqrt(np.maximum(need**2 - (end * sine) ** 2, 0.0))
        foot = level * cosine > end
        level = np.where(foot, np.divide(need, sine, out=np.full_like(sine, math.inf), where=sine > 0), level)
        never = (end * sine >= need * (1 - 1e-12)) | (level <= 0)
        return np.where(never, math.inf, self.radius - level)

    def unbalance(self, setting: float) -> float:
        """Return the unbalance taken, from a round face, kg m."""
        plane = self.plane
        return radial_unbalance(self.density, self.radius, self.diameter, setting, plane.point_angle)

    def setting(self, unbalance: float) -> float:
        """Return the depth, m."""
        plane = self.plane
        return radial_depth(self.density, self.radius, self.diameter, unbalance, plane.point_angle)

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the hole."""
        plane = self.plane
        return Operation(
            id=name,
            plane=plane.id,
            z=plane.z,
            method="remove",
            kind="drill_radial",
            angle=angle_of(cmath.rect(1.0, angle)),
            radius=self.radius,
            mass=self.density * radial_volume(self.radius, self.diameter, setting, plane.point_angle),
            unbalance=-cmath.rect(self.unbalance(setting), angle),
            unbalance_z=plane.z,
            tool_diameter=self.diameter,
            point_angle=plane.point_angle,
            depth=setting,
        )

    @property
    def clearance(self) -> float:
        """Half of the radius."""
        return 0.5 * self.radius

    def solid(self, angle: float, setting: float) -> Surface:
        """Return the drill."""
        outward, base, radius = self._outward(angle), np.array([0, 0, self.plane.z]), self.radius
        shoulder, back = base + (radius - setting) * outward, base + (radius + self.clearance) * outward
        return drill(shoulder, back, self.diameter, self.tip)

    def _outward(self, angle: float) -> Float:
        return np.array([math.cos(angle), math.sin(angle), 0.0])


@dataclass(frozen=True, kw_only=True)
class AxialDrill(Drill):
    """A drill that runs along the shaft, set in m of depth; through holes have one setting only."""

    @property
    def least(self) -> float:
        """The smallest depth, m."""
        return self.greatest if self.plane.through else 0.0

    @property
    def greatest(self) -> float:
        """The largest depth, m; of a hole through the thickness, where that is known."""
        return self.limit if self.plane.through and self.limit is not None else self._deepest(math.inf)

    @property
    def step(self) -> float:
        """What the shop can set the depth to; a hole through has no depth to set."""
        return 0.0 if self.plane.through else self.plane.depth_step

    def half_angle_at(self, setting: float) -> float:
        """Half the angle that the hole takes."""
        return math.asin(0.5 * self.diameter / self.radius)

    def apart_at(self, setting: float) -> float:
        """The angle at which two holes keep their web."""
        need = 0.5 * (self.diameter + self.plane.web)
        return 2 * math.asin(need / self.radius) if need < self.radius else math.pi

    def axes(self, angles: Float) -> tuple[Float, Float]:
        """Return the axes, which run along the shaft."""
        radius = self.radius
        starts = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(len(angles), self.entry)])
        return starts, np.tile(self._ahead, (len(angles), 1))

    def depth_beside(self, need: float, away: Float, setting: float) -> Float:
        """Their axes run beside each other."""
        return np.where(2 * self.radius * np.sin(0.5 * np.abs(away)) >= need * (1 - 1e-12), math.inf, -1.0)

    @property
    def _point(self) -> float:
        """The point angle of what is taken away: that of a hole through has come out at the other side."""
        return math.pi if self.plane.through else self.plane.point_angle

    @property
    def towards_shaft(self) -> bool:
        """It runs along the shaft."""
        return False

    @property
    def entry(self) -> float:
        """Where along the shaft it begins, m."""
        return self.plane.entry + self.start * float(self._ahead[2])

    @property
    def _ahead(self) -> Float:
        return np.array([0.0, 0.0, 1.0 if self.plane.face == "a" else -1.0])

    def unbalance(self, setting: float) -> float:
        """Return ρ A r (h + h_c/3), kg m."""
        return self.density * self.radius * axial_volume(self.diameter, setting, self._point)

    def setting(self, unbalance: float) -> float:
        """Return the depth, m; that of a hole through is the thickness."""
        if self.plane.through:
            return self.greatest
        depth = unbalance / (self.density * self.radius * _area(self.diameter))
        return depth - point_length(self.diameter, self._point) / 3

    def unbalance_z(self, setting: float) -> float:
        """Return where the centroid of the hole is along the shaft, m."""
        return self.entry + float(self._ahead[2]) * axial_middle(self.diameter, setting, self._point)

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the hole."""
        plane = self.plane
        return Operation(
            id=name,
            plane=plane.id,
            z=self.entry,
            method="remove",
            kind="drill_axial",
            angle=angle_of(cmath.rect(1.0, angle)),
            radius=self.radius,
            mass=self.density * axial_volume(self.diameter, setting, self._point),
            unbalance=-cmath.rect(self.unbalance(setting), angle),
            unbalance_z=self.unbalance_z(setting),
            tool_diameter=self.diameter,
            point_angle=plane.point_angle,
            depth=setting,
        )

    @property
    def clearance(self) -> float:
        """One diameter: farther out there may be another disc."""
        return self.diameter

    def solid(self, angle: float, setting: float) -> Surface:
        """Return the drill, which comes as far out of the other side where it goes through."""
        start = self._start(angle)
        past = self.clearance if self.plane.through else 0.0
        shoulder, back = start + (setting + past) * self._ahead, start - self.clearance * self._ahead
        return drill(shoulder, back, self.diameter, self.tip)

    def _start(self, angle: float) -> Float:
        radius = self.radius
        return np.array([radius * math.cos(angle), radius * math.sin(angle), self.entry])
