"""The sample parts: of each the surface and the exact moments of the true solid, in millimetres."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from inertia_meshes import closed_forms, shapes
from inertia_meshes.circle import cosine, sine
from inertia_meshes.closed_forms import Number, Profile
from inertia_meshes.rational import Moments
from inertia_meshes.shapes import Corners


class Solid(NamedTuple):
    """A closed surface (n, 3, 3) and the moments of the solid that it approximates."""

    corners: Corners
    true: Moments


def box(a: Number, b: Number, c: Number, center: tuple[Number, Number, Number] = (0, 0, 0)) -> Solid:
    """Box with edges a, b, c along x, y, z."""
    surface = shapes.moved(shapes.box(float(a), float(b), float(c)), *map(float, center))
    return Solid(surface, closed_forms.box(a, b, c).moved(*center))


def revolution(profile: Profile, n: int) -> Solid:
    """Solid of revolution about z; the profile (radius, z) begins and ends on the axis."""
    line = [(float(radius), float(z)) for radius, z in profile]
    return Solid(shapes.revolved(line, n), closed_forms.revolved(profile))


def sphere(radius: int, n: int) -> Solid:
    """Ball centred at the origin."""
    return Solid(shapes.sphere(radius, n), closed_forms.ball(radius))


def ellipsoid(a: int, b: int, c: int, n: int) -> Solid:
    """Ellipsoid with semi-axes a, b, c along x, y, z."""
    return Solid(shapes.sphere(1, n) * (a, b, c), closed_forms.ball(1).scaled(a, b, c))


def torus(ring: int, tube: int, n: int) -> Solid:
    """Torus about z."""
    return Solid(shapes.torus(ring, tube, n), closed_forms.torus(ring, tube))


def hollow_ball(radius: int, cavity: int, center: tuple[int, int, int], n: int) -> Solid:
    """Ball with a spherical cavity, whose surface faces inwards."""
    hole = shapes.flipped(shapes.moved(shapes.sphere(cavity, n), *center))
    true = closed_forms.ball(radius) - closed_forms.ball(cavity).moved(*center)
    return Solid(np.concatenate([shapes.sphere(radius, n), hole]), true)


def t_handle(n: int) -> Solid:
    """Hub, a cube of edge 10, with round arms 8 × 25 along ±x and a round stem 8 × 20 along −z."""
    half, radius, arm, stem = 5, 4, 25, 20
    square = half * np.array([(1, 1, 1), (-1, 1, 1), (-1, -1, 1), (1, -1, 1)], np.float64)
    plain = square[[[0, 1, 2], [0, 2, 3]]]
    pierced = shapes.ring(square, shapes.circle(radius, half, n))
    turns = {  # the rotation that takes a face at +z to where the key says
        "+z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
        "+x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
        "-x": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
        "+y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
        "-y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    }
    lengths = {"-z": stem, "+x": arm, "-x": arm}
    faces, true = [], closed_forms.box(2 * half, 2 * half, 2 * half)
    for side, turn in turns.items():
        if side not in lengths:
            faces.append(shapes.mapped(plain, turn))
            continue
        end = half + lengths[side]
        rod = shapes.revolved([(radius, half), (radius, end), (0, end)], n)
        faces.append(shapes.mapped(np.concatenate([pierced, rod]), turn))
        true += closed_forms.cylinder(radius, half, end).mapped(turn)
    return Solid(np.concatenate(faces), true)


def bent_wheel(n: int) -> Solid:
    """Wheel of revolution tilted on its straight axle, in one body.

    The axle, radius 5, runs along z to ±30. The wheel's own axis is turned from z towards x by asin(40/401).
    The surface is built in the wheel's axes, where the axle is oblique, and then turned.
    """
    sin, cos = Fraction(40, 401), Fraction(399, 401)
    radius, hub, end = 5, 10, 30
    rim = [(10, -10), (10, -2), (40, -2), (40, -8), (50, -8), (50, 8), (40, 8), (40, 2), (10, 2), (10, 10)]
    s, c = float(sin), float(cos)
    half_turn = ((-1, 0, 0), (0, 1, 0), (0, 0, -1))  # about y: it maps the wheel and the axle to themselves

    foot = shapes.circle(radius, hub, n)
    foot[:, 0] = foot[:, 0] / c - hub * s / c
    tip, center = (shapes.mapped(shapes.circle(r, end, n), ((c, 0, -s), (0, 1, 0), (s, 0, c))) for r in (radius, 0))
    hub_face = shapes.ring(shapes.circle(10, hub, n), foot)
    upper = np.concatenate([hub_face, shapes.band(foot, tip), shapes.band(tip, center)])
    corners = np.concatenate([shapes.revolved(rim, n), upper, shapes.mapped(upper, half_turn)])

    wheel = closed_forms.revolved([(0, -10), *rim, (0, 10)]).mapped(((cos, 0, sin), (0, 1, 0), (-sin, 0, cos)))
    stub = closed_forms.cut_cylinder(radius, hub / cos, -sin / cos, end)
    corners = shapes.mapped(corners, ((c, 0, s), (0, 1, 0), (-s, 0, c)))
    return Solid(corners, wheel + stub + stub.mapped(half_turn))


def two_disc_rotor(n: int) -> Solid:
    """Shaft 30 × 300 with discs 200 × 20 at z 80–100 and 160 × 30 at z 200–230, each with one axial hole.

    The first disc has a hole of diameter 10 at radius 70 and 30°, the second one of 12 at radius 60 and 200°.
    The shaft has n/2 segments.
    """
    shaft, segments = 15, n // 2
    true = closed_forms.revolved([
        (0, 0), (shaft, 0), (shaft, 80), (100, 80), (100, 100), (shaft, 100),
        (shaft, 200), (80, 200), (80, 230), (shaft, 230), (shaft, 300), (0, 300),
    ])  # fmt: skip
    faces = [
        shapes.revolved([(0, 0), (shaft, 0), (shaft, 80)], segments),
        shapes.revolved([(shaft, 100), (shaft, 200)], segments),
        shapes.revolved([(shaft, 230), (shaft, 300), (0, 300)], segments),
    ]
    discs = ((100, 80, 100, 5, 70, Fraction(30, 360)), (80, 200, 230, 6, 60, Fraction(200, 360)))
    for radius, bottom, top, hole, distance, turn in discs:
        x, y = distance * cosine(turn), distance * sine(turn)
        true -= closed_forms.cylinder(hole, bottom, top).moved(x, y, 0)
        first = round((turn - Fraction(1, 8)) * segments)
        lines, ends = [], []
        for z in (bottom, top):
            lines.append(shapes.moved(shapes.circle(hole, z, n), float(x), float(y), 0))
            outer, inner = shapes.circle(radius, z, n), shapes.circle(shaft, z, segments)
            ends.append(shapes.pierced_ring(outer, inner, [(first, first + segments // 4, lines[-1])]))
        rim = shapes.revolved([(radius, bottom), (radius, top)], n)
        faces += [shapes.flipped(ends[0]), rim, ends[1], shapes.flipped(shapes.band(*lines))]
    return Solid(np.concatenate(faces), true)


def impeller_shaft(n: int) -> Solid:
    """Shaft of radius 8 from z 0 to 120 with a shoulder of radius 12 at z 60–70."""
    return revolution([(0, 0), (8, 0), (8, 60), (12, 60), (12, 70), (8, 70), (8, 120), (0, 120)], n)


def impeller(n: int) -> Solid:
    """Hub with a bore of radius 8, back plate of radius 45 and six straight blades 22 × 4 × 15, z 70–95."""
    bore, hub, plate, floor, face, top = 8, 16, 45, 70, 75, 95
    profile = [(hub, face), (hub, top), (bore, top), (bore, floor), (plate, floor), (plate, face)]
    middle, length, width, height, count = 31, 22, 4, 15, 6
    inner, outer = shapes.circle(hub, face, n), shapes.circle(plate, face, n)
    corners = [shapes.revolved(profile, n)]
    blade = shapes.moved(shapes.box(length, width, height), middle, 0, face + height / 2)
    blade = blade[(blade[:, :, 2] > face).any(axis=1)]  # its foot is a hole in the plate's face
    half = np.array((length / 2, width / 2, 0))
    outline = shapes.moved(half * [(1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)], middle, 0, face)
    windows = []
    for k in range(count):
        c, s = float(cosine(Fraction(k, count))), float(sine(Fraction(k, count)))
        turn = (c, -s, 0), (s, c, 0), (0, 0, 1)
        corners.append(shapes.mapped(blade, turn))
        windows.append(((2 * k - 1) * n // 12, (2 * k + 1) * n // 12, shapes.mapped(outline, turn)))
    corners.append(shapes.pierced_ring(outer, inner, windows))
    one = closed_forms.box(length, width, height).moved(middle, 0, face + Fraction(height, 2))
    return Solid(np.concatenate(corners), closed_forms.revolved(profile) + closed_forms.around(one, count))
