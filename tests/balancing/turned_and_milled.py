"""Turned and milled parts, as meshes whose vertices lie on the true shape, and the moments of that shape.

Everything is in metres. The moments are V = ∫ dV, S = ∫ w dV and T = ∫ w z dV with w = x + i y, by Gauss's quadrature
of arcs and lines, which is exact to rounding.
"""

import cmath
import math
from dataclasses import dataclass

import numpy as np

MM = 1e-3
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


@dataclass(frozen=True)
class Piece:
    """A closed shell, corners (n, 3, 3), and its moments (V, S, T)."""

    corners: np.ndarray
    moments: tuple[float, complex, complex]

    def __neg__(self):
        """Return the same as a hole."""
        return Piece(self.corners[:, ::-1], tuple(-k for k in self.moments))


def arc(center, turn):
    """Return a step along an arc about a centre (complex) by an angle (rad)."""
    return ("arc", center, turn)


def points(path, n):
    """Return the points of a path (complex), with n to a full turn, and its true quadrature nodes (z, dz)."""
    at, listed, nodes, steps = path[0], [path[0]], [], []
    for step in path[1:]:
        s = 0.5 * (_NODES + 1)
        if isinstance(step, tuple):
            _, center, turn = step
            radius = at - center
            count = max(1, math.ceil(abs(turn) / (2 * math.pi / n) - 1e-9))
            listed += [center + radius * cmath.exp(1j * turn * k / count) for k in range(1, count + 1)]
            nodes.append(center + radius * np.exp(1j * turn * s))
            steps.append(1j * turn * radius * np.exp(1j * turn * s) * 0.5 * _WEIGHTS)
        else:
            listed.append(step)
            nodes.append(at + s * (step - at))
            steps.append((step - at) * 0.5 * _WEIGHTS)
        at = listed[-1]
    return np.array(listed), np.concatenate(nodes), np.concatenate(steps)


def circle(radius, center=0j, hole=False):
    """Return a closed path around a circle."""
    return [center + radius, arc(center, -2 * math.pi if hole else 2 * math.pi)]


def extruded(loops, low, high, n):
    """Return a prism over closed paths: the outer counter-clockwise, holes clockwise."""
    import manifold3d

    rings, area, first = [], 0.0, 0j
    for loop in loops:
        ring, z, dz = points(loop, n)
        rings.append(ring[:-1] if abs(ring[-1] - ring[0]) < 1e-12 else ring)
        area += 0.5 * float(np.sum(z.real * dz.imag - z.imag * dz.real))
        first += 0.5 * complex(np.sum(z.real**2 * dz.imag), -np.sum(z.imag**2 * dz.real))
    flat = [np.column_stack([k.real, k.imag]) for k in rings]
    cap = np.concatenate(flat)[manifold3d.triangulate(flat)]
    at = [np.concatenate([cap, np.full((*cap.shape[:2], 1), z)], axis=2) for z in (low, high)]
    walls = []
    for ring in flat:
        a, b = ring, np.roll(ring, -1, axis=0)
        lower_a, lower_b, upper_a, upper_b = (
            np.column_stack([k, np.full(len(k), z)]) for z in (low, high) for k in (a, b)
        )
        walls += [np.stack([lower_a, lower_b, upper_b], axis=1), np.stack([lower_a, upper_b, upper_a], axis=1)]
    height = high - low
    return Piece(
        np.concatenate([at[0][:, ::-1], at[1], *walls]),
        (area * height, first * height, first * height * 0.5 * (low + high)),
    )


def turned(profile, n, center=0j, angles=None):
    """Return what a path (r + i z), its inside on the left, sweeps about an axis along z through a centre."""
    line, z, dz = points(profile, n)
    angles = 2 * math.pi * np.arange(n) / n if angles is None else angles
    around = np.exp(1j * np.asarray(angles))
    across = center + np.multiply.outer(line.real, around)
    grid = np.stack([across.real, across.imag, np.broadcast_to(line.imag[:, None], across.shape)], axis=2)
    grid[np.abs(line.real) < 1e-15] = grid[np.abs(line.real) < 1e-15][:, :1]
    a, b = grid[:-1], np.roll(grid[:-1], -1, axis=1)
    d, c = grid[1:], np.roll(grid[1:], -1, axis=1)
    corners = np.concatenate(
        [np.stack([a, b, c], axis=2).reshape(-1, 3, 3), np.stack([a, c, d], axis=2).reshape(-1, 3, 3)]
    )
    proper = (corners != np.roll(corners, 1, axis=1)).any(axis=2).all(axis=1)
    volume = math.pi * float(np.sum(z.real**2 * dz.imag))
    lever = math.pi * float(np.sum(z.real**2 * z.imag * dz.imag))
    return Piece(corners[proper], (volume, center * volume, center * lever))


def cylinder(radius, low, high, n, center=0j, angles=None):
    """Return a cylinder along z."""
    return turned([1j * low, radius + 1j * low, radius + 1j * high, 1j * high], n, center, angles)


def tilted(radius, height, tilt, n, shift):
    """Return a cylinder about the origin, tilted about y and shifted along z."""
    piece = cylinder(radius, -height / 2, height / 2, n)
    c, s = math.cos(tilt), math.sin(tilt)
    corners = piece.corners @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T + [0, 0, shift]
    volume = piece.moments[0]
    return Piece(corners, (volume, 0j, complex(volume * (height**2 / 12 - radius**2 / 4) * s * c)))


def mesh_moments(corners):
    """Return (V, S, T) of a mesh."""
    volume = np.einsum("ki,ki->k", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    w, z = corners[..., 0] + 1j * corners[..., 1], corners[..., 2]
    first = volume @ w.sum(axis=1) / 4
    second = volume @ (w.sum(axis=1) * z.sum(axis=1) + (w * z).sum(axis=1)) / 20
    return float(volume.sum()), complex(first), complex(second)


def polar(radius, degrees):
    """Return a complex number from mm and degrees."""
    return cmath.rect(MM * radius, math.radians(degrees))


def disc_with_holes(n, holes, radius=60.0, low=0.0, high=15.0):
    """Return a disc with round holes (radius, centre) through it."""
    loops = [circle(MM * radius), *(circle(MM * r, at, hole=True) for r, at in holes)]
    return extruded(loops, MM * low, MM * high, n)


def slot(width, depth, radius):
    """Return the outline of a shaft with a keyway: a rectangular slot at 0°."""
    half = math.asin(0.5 * width / radius)
    r = MM * radius
    floor = MM * (radius - depth)
    corner = complex(floor, 0.5 * MM * width)
    return [
        cmath.rect(r, half), arc(0j, 2 * math.pi - 2 * half), corner.conjugate(), corner, cmath.rect(r, half),
    ]  # fmt: skip


def keyway_shaft(n):
    return [extruded([slot(8, 5, 20)], 0.0, 60 * MM, n)]


def d_shaft(n):
    half = math.radians(50)
    return [extruded([[polar(20, 50), arc(0j, 2 * math.pi - 2 * half), polar(20, 50)]], 0.0, 50 * MM, n)]


def eccentric_cylinder(n):
    return [cylinder(30 * MM, 0.0, 20 * MM, n), cylinder(12 * MM, 25 * MM, 60 * MM, n, polar(9, 35))]


def eccentric_bore(n):
    return [disc_with_holes(n, [(11.0, polar(14, 70))])]


def eccentric_taper(n):
    path = [10j * MM, (18 + 10j) * MM, (11 + 55j) * MM, 55j * MM]
    return [turned(path, n, polar(6, 200))]


def tool_holder(n):
    """A 7/24 taper, a flange with two drive slots of unequal depth, a nose with a set-screw hole beside the axis."""
    taper = turned([0j, (12.7 + 0j) * MM, (22.2 + 65j) * MM, 65j * MM], n)
    loop = [cmath.rect(31 * MM, math.asin(8 / 31))]
    half = math.asin(8 / 31)
    for k, floor in enumerate((22.5, 22.9)):
        turn = cmath.exp(1j * math.pi * (k + 1))
        loop += [
            arc(0j, math.pi - 2 * half), turn * complex(floor, -8) * MM, turn * complex(floor, 8) * MM,
            turn * cmath.rect(31 * MM, half),
        ]  # fmt: skip
    flange = extruded([loop], 66 * MM, 82 * MM, n)
    nose = extruded([circle(20 * MM), circle(4 * MM, polar(13, 120), hole=True)], 83 * MM, 110 * MM, n)
    return [taper, flange, nose]


def fan(n):
    """A hub, and seven blades that are arcs of a ring, one of them thicker."""
    pieces = [extruded([circle(25 * MM), circle(8 * MM, hole=True)], 0.0, 30 * MM, n)]
    for k in range(7):
        turn = cmath.exp(2j * math.pi * k / 7)
        center, thick = turn * (60 + 35j) * MM, (2.0 if k else 2.3) * MM
        outer, inner = 40 * MM, 40 * MM - thick
        first, last = math.radians(200) + cmath.phase(turn), math.radians(60)
        loop = [
            center + cmath.rect(outer, first), arc(center, last), center + cmath.rect(inner, first + last),
            arc(center, -last), center + cmath.rect(outer, first),
        ]  # fmt: skip
        pieces.append(extruded([loop], 0.0, 30 * MM, n))
    return pieces


def hull(center_a, radius_a, center_b, radius_b):
    """Return the outline around two circles, with their common tangents."""
    along = center_b - center_a
    lean = math.acos((radius_a - radius_b) / abs(along))
    phase = cmath.phase(along)
    return [
        center_a + cmath.rect(radius_a, phase + lean), arc(center_a, 2 * math.pi - 2 * lean),
        center_b + cmath.rect(radius_b, phase - lean), arc(center_b, 2 * lean),
        center_a + cmath.rect(radius_a, phase + lean),
    ]  # fmt: skip


def crank(n):
    pin = polar(35, 90)
    web = [hull(0j, 32 * MM, pin, 22 * MM)]
    return [
        cylinder(20 * MM, 0.0, 30 * MM, n), extruded(web, 31 * MM, 45 * MM, n),
        cylinder(15 * MM, 46 * MM, 70 * MM, n, pin), extruded(web, 71 * MM, 85 * MM, n),
        cylinder(20 * MM, 86 * MM, 116 * MM, n),
    ]  # fmt: skip


def chamfered_boss(n):
    path = [0j, 14 + 0j, 15 + 1j, 15 + 24j, 13 + 26j, 26j]
    return [turned([k * MM for k in path], n, polar(20, 15))]


def filleted_boss(n):
    path = [0j, (25 + 0j) * MM, (25 + 5j) * MM, (18 + 5j) * MM, arc((18 + 8j) * MM, -math.pi / 2), (15 + 28j) * MM,
            arc((13 + 28j) * MM, math.pi / 2), 30j * MM]  # fmt: skip
    return [turned(path, n, polar(18, 250))]


def knurled(n):
    """Ninety grooves of 90° round a grip, with a bore beside its axis: their planes are no facets."""
    tips = [cmath.rect(r * MM, math.pi * k / 90) for k in range(180) for r in [20.0 if k % 2 else 19.4]]
    return [extruded([[*tips, tips[0]], circle(6 * MM, polar(5, 300), hole=True)], 0.0, 25 * MM, n)]


def bolt_circle(n):
    """Seven holes where there is room for eight."""
    return [disc_with_holes(n, [(5.0, polar(42, 45 * k)) for k in range(7)])]


def cam(n):
    return [extruded([hull(0j, 22 * MM, polar(16, 40), 9 * MM)], 5 * MM, 25 * MM, n)]


def ball_end(n):
    path = [0j, 10 * MM + 0j, (10 + 30j) * MM, arc(30j * MM, math.pi / 2)]
    return [turned(path, n, polar(12, 160))]


def ring_groove(n):
    """A boss with a round groove, beside the axis."""
    path = [0j, 20 * MM, (20 + 8j) * MM, arc((20 + 11j) * MM, -math.pi), (20 + 22j) * MM, 22j * MM]
    return [turned(path, n, polar(10, 330))]


def chamfered_block(n):
    """A block with 45° chamfers and a hole: only the hole is round."""
    corners = [30 + 26j, 26 + 30j, -26 + 30j, -30 + 26j, -30 - 30j, 30 - 30j]
    loop = [k * MM for k in corners]
    return [extruded([[*loop, loop[0]], circle(9 * MM, polar(12, 10), hole=True)], 0.0, 20 * MM, n)]


def irregular(n):
    """A cylinder on the axis whose facets are uneven."""
    random = np.random.default_rng(n)
    angles = 2 * math.pi * (np.arange(n) + random.uniform(-0.3, 0.3, n)) / n
    return [cylinder(50 * MM, 0.0, 30 * MM, n, angles=angles)]


def swash(n):
    return [tilted(60 * MM, 12 * MM, math.radians(1.5), n, 40 * MM)]


def drilled_blind(n):
    """A disc with a blind hole beside the axis, its point 118° and its rim countersunk, as the drill leaves them."""
    tip = 6 / math.tan(math.radians(59))
    path = [(20 - tip) * 1j, 6 + 20j, 6 + 45j, 8 + 47j, 47j]
    return [cylinder(50 * MM, 0.0, 60 * MM, n), -turned([k * MM for k in path], n, polar(28, 110))]


def pocket(n):
    """A disc with a milled pocket whose corners have the cutter's radius."""
    x0, x1, y0, y1, r = 15 * MM, 45 * MM, -12 * MM, 16 * MM, 6 * MM
    quarter = -math.pi / 2
    loop = [
        complex(x0 + r, y1), complex(x1 - r, y1), arc(complex(x1 - r, y1 - r), quarter), complex(x1, y0 + r),
        arc(complex(x1 - r, y0 + r), quarter), complex(x0 + r, y0), arc(complex(x0 + r, y0 + r), quarter),
        complex(x0, y1 - r), arc(complex(x0 + r, y1 - r), quarter),
    ]  # fmt: skip
    return [extruded([circle(60 * MM), loop], 0.0, 18 * MM, n)]


def counterweight(n):
    """A sector of a ring."""
    loop = [polar(60, -70), arc(0j, math.radians(140)), polar(25, 70), arc(0j, -math.radians(140)), polar(60, -70)]
    return [extruded([loop], 0.0, 15 * MM, n), cylinder(20 * MM, 0.0, 15 * MM, n)]


def wedge(n):
    """A block whose sides lean by 8°, a true edge, beside a pin."""
    loop = [k * MM for k in (10 - 10j, 50 - 10j, 50 + 4j, 30 + 6.8j, 10 + 6.8j)]
    return [extruded([[*loop, loop[0]]], 0.0, 12 * MM, n), cylinder(5 * MM, 13 * MM, 40 * MM, n, polar(-30, 10))]


FAMILIES = {
    f.__name__: f
    for f in (
        eccentric_cylinder, eccentric_bore, keyway_shaft, d_shaft, eccentric_taper, tool_holder, fan, crank,
        chamfered_boss, filleted_boss, knurled, bolt_circle, cam, ball_end, ring_groove, chamfered_block, irregular,
        swash, drilled_blind, pocket, counterweight, wedge,
    )
}  # fmt: skip
