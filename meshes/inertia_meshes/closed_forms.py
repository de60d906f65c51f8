"""Moments of true solids, for unit density: rational up to π, which is taken to 65 digits."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from inertia_meshes.circle import PI
from inertia_meshes.rational import Moments

Number = Fraction | int
Profile = Sequence[tuple[Number, Number]]
_ZERO = Fraction(0)


def _symmetric(volume: Number, xx: Number, yy: Number, zz: Number) -> Moments:
    """Moments of a solid with three planes of symmetry through the origin."""
    second = (Fraction(xx), Fraction(yy), Fraction(zz), _ZERO, _ZERO, _ZERO)
    return Moments(Fraction(volume), (_ZERO, _ZERO, _ZERO), second)


def box(a: Number, b: Number, c: Number) -> Moments:
    """Box with edges a, b, c along x, y, z, centred at the origin: ∫x² = V a²/12."""
    volume = Fraction(a) * b * c
    return _symmetric(volume, volume * a * a / 12, volume * b * b / 12, volume * c * c / 12)


def corner_tetrahedron(a: Number, b: Number, c: Number) -> Moments:
    """Tetrahedron with corners (0,0,0), (a,0,0), (0,b,0), (0,0,c).

    V = abc/6, ∫x² = V a²/10, ∫xy = V ab/20.
    """
    a, b, c = Fraction(a), Fraction(b), Fraction(c)
    volume = a * b * c / 6
    second = (a * a / 10, b * b / 10, c * c / 10, b * c / 20, c * a / 20, a * b / 20)
    return Moments(Fraction(1), (a / 4, b / 4, c / 4), second).weighted(volume)


def ball(radius: Number) -> Moments:
    """Ball centred at the origin: V = 4/3 π R³, ∫x² = V R²/5."""
    volume = Fraction(4, 3) * PI * radius**3
    square = volume * radius**2 / 5
    return _symmetric(volume, square, square, square)


def torus(ring: Number, tube: Number) -> Moments:
    """Torus about z, ring radius R, tube radius r: V = 2π²Rr², ∫z² = V r²/4, ∫x² = V (R²/2 + 3r²/8)."""
    volume = 2 * PI**2 * ring * tube**2
    across = volume * (Fraction(ring**2) / 2 + Fraction(3, 8) * tube**2)
    return _symmetric(volume, across, across, volume * tube**2 / 4)


def revolved(profile: Profile) -> Moments:
    """Solid swept by turning a polygon of (radius, z) about the z axis.

    The polygon has its inside on the left. Each edge adds the conical frustum between itself and the axis,
    negative where z falls: V = π∫r² dz, ∫z = π∫r²z dz, ∫z² = π∫r²z² dz, ∫x² = ∫y² = π/4 ∫r⁴ dz. Along an edge
    these are of degree four at most, which Boole's rule integrates exactly.
    """
    volume = along = height = across = _ZERO
    for (r0, z0), (r1, z1) in pairwise((*profile, profile[0])):
        for quarter, weight in enumerate((7, 32, 12, 32, 7)):
            part = Fraction(quarter, 4)
            r, z = r0 + part * (r1 - r0), z0 + part * (z1 - z0)
            area = Fraction(weight, 90) * PI * (z1 - z0) * r * r
            volume += area
            along += area * z
            height += area * z * z
            across += area * r * r / 4
    return Moments(volume, (_ZERO, _ZERO, along), (across, across, height, _ZERO, _ZERO, _ZERO))


def cylinder(radius: Number, bottom: Number, top: Number) -> Moments:
    """Cylinder about the z axis."""
    return revolved([(0, bottom), (radius, bottom), (radius, top), (0, top)])


def cut_cylinder(radius: Number, level: Number, slope: Number, top: Number) -> Moments:
    """Cylinder about the z axis from the oblique plane z = level + slope·x up to z = top.

    Integrated along z first; over the disc the odd moments vanish and ∫x² = ∫y² = πr⁴/4.
    """
    r, h, k, t = Fraction(radius), Fraction(level), Fraction(slope), Fraction(top)
    disc, square = PI * r**2, PI * r**4 / 4
    volume = disc * (t - h)
    first = (-k * square, _ZERO, (disc * (t**2 - h**2) - k**2 * square) / 2)
    across = square * (t - h)
    along = (disc * (t**3 - h**3) - 3 * h * k**2 * square) / 3
    return Moments(volume, first, (across, across, along, _ZERO, -h * k * square, _ZERO))


def around(moments: Moments, count: int) -> Moments:
    """Return three or more copies of a solid, spread evenly around the z axis; ∫x² and ∫y² become equal."""
    across = (moments.second[0] + moments.second[1]) / 2
    second = (across, across, moments.second[2], _ZERO, _ZERO, _ZERO)
    return Moments(moments.volume, (_ZERO, _ZERO, moments.first[2]), second).weighted(count)
