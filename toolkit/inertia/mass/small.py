"""Mass properties of small parts in memory, at once: compiled sums, and rational arithmetic where it is asked for.

What is read first, volume, mass, centre of mass and tensor, are quotients of integers made of the float64 sums, each
rounded once, so that they have the bits that `inertia.mass.analyse` gives them. Its bounds are formed where they are
read. Where the roughest of them do not say that the volume and the principal moments are certain to a part in 10⁹, as
there, it is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import inf

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.errors import GeometryError
from inertia.mass.moments import Over, dyadic
from inertia.mass.properties import CERTAIN, MassProperties
from inertia.mass.triangles.arithmetic import METHODS, solid_moments
from inertia.mass.triangles.block_sums import of_row, sum_each
from inertia.mass.triangles.kernels import BLOCK
from inertia.mass.triangles.moments_from_sums import FLOAT64, fine_values, roughest
from inertia.mass.triangles.sums import PlainSums, Sums, sum_triangles
from inertia.mesh.geometry.simple import MOST, at_hand, simple
from inertia.mesh.surface import Surface
from inertia.native import threads
from inertia.records import dataclass
from inertia.units import Unit

_SHARE = 25_000  # triangles, two milliseconds of work for a thread

_ROUNDOFF = 2.0**-53
_INFLATED = 1.0 + 1e-9


def small_sums(vertices: Float, faces: Int, table: Int) -> tuple[Float, Bool]:
    """Return a row for each surface of a batch, as `sum_each` does, and which of them are simple and could be summed.

    Many surfaces are shared out among threads.
    """
    shares = min(threads(), len(table), int(table[:, 3].sum()) // _SHARE)
    if shares < 2:
        return _sums_alone(vertices, faces, table)
    from concurrent.futures import ThreadPoolExecutor  # slow to import

    with ThreadPoolExecutor(shares) as pool:
        answers = list(pool.map(lambda share: _sums_alone(vertices, faces, share), np.array_split(table, shares)))
    return np.concatenate([rows for rows, _ in answers]), np.concatenate([usable for _, usable in answers])


def _sums_alone(vertices: Float, faces: Int, table: Int) -> tuple[Float, Bool]:
    usable = simple(vertices, faces, table)
    return sum_each(vertices, faces, table, usable), usable


@dataclass(frozen=True, eq=False)
class SmallSolid:
    """A small solid of one density, kg/m³, that was summed up already."""

    vertices: Float
    faces: Int
    sums: Sums
    unit: Unit
    density: float

    def properties(self) -> MassProperties:
        """Return what `inertia.mass.analyse` does, bounds and all."""
        factor, weight = self.unit.metres**3, Fraction(self.density)
        whole = solid_moments(Surface(self.vertices, self.faces), "float64", self.sums)
        moments = whole.in_unit(self.unit.metres).scaled(factor * weight)
        volume, bound = factor * whole.zeroth, factor * whole.zeroth_bound
        return MassProperties.from_moments(moments, volume, bound, METHODS["float64"])


def small_properties(surface: Surface, unit: Unit, density: float) -> MassProperties | None:
    """Return the mass properties of a small, simple solid; None where it is not known to be one, or not certain."""
    vertices, faces = surface.vertices, surface.faces
    if not 0 < len(faces) <= MOST or not at_hand():
        return None
    table = np.array([[0, len(vertices), 0, len(faces)]])
    if len(faces) <= BLOCK:
        rows, usable = _sums_alone(vertices, faces, table)
        sums: Sums = of_row(rows[0], len(faces))
    else:
        usable = simple(vertices, faces, table)
        if usable[0]:
            sums = sum_triangles(surface)
    if not usable[0] or sums.exponent:
        return None
    solid = SmallSolid(vertices.copy(), faces.copy(), sums, unit, density)  # which may be written to meanwhile
    known: tuple[Over, list[float]] | None
    if isinstance(sums, PlainSums):
        if not sums.sums[0] > 0:
            return None
        known = dyadic(sums.sums[:10].tolist()), roughest(sums, FLOAT64.most(len(faces)))
    else:
        known = fine_values(sums)
    if known is None or not _certain(*known):
        try:
            whole = solid.properties()
        except GeometryError:
            return None
        return whole if whole.error.volume <= CERTAIN and whole.moments_within(CERTAIN) else None
    try:
        mass, volume, center, tensor = _rounded(known[0], sums.origin.tolist(), unit.metres, density)
    except OverflowError:
        return None
    if not (0 < mass < inf and 0 < volume < inf and min(tensor[0], tensor[4], tensor[8]) > 0):
        return None
    return MassProperties.of_small(mass, volume, np.array(center), np.array(tensor).reshape(3, 3), solid)


def _certain(values: Over, bounds: Sequence[float]) -> bool:
    """Say whether the volume and each principal moment are certain to a part in 10⁹, and the tensor is physical.

    The test is that of `MassProperties.moments_within`, with a bound on the tensor's error that is never smaller.
    """
    sums = [n / values[1] for n in values[0]]
    v = sums[0]
    if not 0 <= 2 * bounds[0] < CERTAIN * v:
        return False
    size = bounds[0] / v
    x, y, z = (k / (4 * v) for k in sums[1:4])
    far = max(abs(x), abs(y), abs(z))
    first = max(bounds[1:4]) / (4 * v) + far * size  # of the centre
    second = max(bounds[4:]) / (20 * v) + size * max(sums[4:7]) / (10 * v)
    xx, yy, zz = (k / (10 * v) - c * c for k, c in zip(sums[4:7], (x, y, z), strict=True))
    yz, zx, xy = sums[7] / (20 * v) - y * z, sums[8] / (20 * v) - z * x, sums[9] / (20 * v) - x * y
    trace = 2 * (xx + yy + zz)
    if not trace > 0:
        return False
    error = 5 * (second + 3 * far * first + 2 * first * first) * _INFLATED / trace + 8 * _ROUNDOFF
    xx, yy, zz, yz, zx, xy = (k / trace for k in (xx, yy, zz, yz, zx, xy))
    # Of the second moments: positive as they are those of some body, whose tensor then keeps to the triangle rule.
    body = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
    a, b, c = yy + zz, zz + xx, xx + yy
    determinant = a * (b * c - yz * yz) - xy * (xy * c + yz * zx) - zx * (xy * yz + b * zx)
    return body > 3 * error + 1e-14 and 2 * error < CERTAIN * (determinant - 1e-13)


def _rounded(
    sums: Over, origin: Sequence[float], metres: Fraction, density: float
) -> tuple[float, float, list[float], list[float]]:
    """Return mass, volume, centre and tensor of the sums about the origin, each rounded once.

    With Σd = A₀ and so on: V = A₀/6, c = o + A₁/(4 A₀), and Ixx = (8 A₀ (A₅ + A₆) − 5 (A₂² + A₃²))/(480 A₀).
    """
    (v, x, y, z, xx, yy, zz, yz, zx, xy), unit = sums
    n, d = metres.numerator, metres.denominator
    w, e = density.as_integer_ratio()
    n3, d3 = n**3, d**3
    volume = n3 * v / (6 * d3 * unit)
    mass = w * n3 * v / (6 * d3 * unit * e)
    center = []
    for o, k in zip(origin, (x, y, z), strict=True):
        on, od = o.as_integer_ratio()
        center.append(n * (4 * on * v + k * od) / (4 * d * od * v))
    over, times = 480 * d3 * d * d * e * v * unit, w * n3 * n * n
    ixx, iyy, izz = (
        times * (8 * v * (p + q) - 5 * (f * f + g * g)) / over
        for p, q, f, g in ((yy, zz, y, z), (zz, xx, z, x), (xx, yy, x, y))
    )
    iyz, izx, ixy = (times * (5 * f * g - 4 * v * k) / over for k, f, g in ((yz, y, z), (zx, z, x), (xy, x, y)))
    return mass, volume, center, [ixx, ixy, izx, ixy, iyy, iyz, izx, iyz, izz]
