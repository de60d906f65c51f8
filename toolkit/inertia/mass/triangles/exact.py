"""Exact moments of a closed surface: integer arithmetic modulo primes, put together once at the end.

A float64 is an integer times a power of two, so over a common power of two the coordinates are integers X, and the
sums that `inertia.mass.triangles.sums` forms are polynomials of them of degree 3 to 5 with integer coefficients. Each
is summed modulo several primes below 2³⁰, in 64-bit integers that vectorise, and the Chinese remainder theorem gives
the integer itself once the product of the primes is more than twice the largest magnitude that it can have (J. von zur
Gathen and J. Gerhard, *Modern Computer Algebra*, 3rd ed., § 5.5). Nothing is rounded, and no order of summation
matters.

What the sums can reach: with |X| ≤ R relative to the origin, |d| ≤ 24 R³, |s| ≤ 3 R and the brackets at most 12 R²,
so over n triangles no sum is beyond 288 n R⁵.

What the residues can reach: each lies between −p and p, p < 2³⁰, so differences are below 2³¹, no sum of products is
above 4·2⁶⁰ + 2·2⁶⁰, and a float64 quotient of such a number by p is off by less than one.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int, Progress
from inertia.errors import GeometryError
from inertia.mass.moments import Moments
from inertia.mesh.surface import Triangles, first_non_finite
from inertia.native import Kernel
from inertia.records import dataclass

METHOD = "exact (integer arithmetic)"

_KERNEL = Kernel("inertia.mass.triangles.residue_kernel", "sum_residues", "pi" + "pp" + "id" + "p")
_COEFFICIENT = 288
CHUNK = 4096
_LARGEST_PRIME = 2**30


@dataclass(frozen=True, eq=False)
class _Grid:
    """The common power of two, the origin (in units of it), and the largest distance from it along an axis."""

    exponent: int
    origin: tuple[int, int, int]
    reach: int


def exact_moments(triangles: Triangles, progress: Progress | None = None) -> Moments:
    """Return the exact moments of the solid inside a closed surface, in the file's unit; all bounds are zero.

    Raises `GeometryError` where a coordinate is infinite or not a number.
    """
    grid = _grid(triangles)
    primes = _primes(2 * _COEFFICIENT * triangles.count * max(grid.reach, 1) ** 5)
    powers = [_powers(prime, grid.exponent) for prime in primes]
    origins = [np.array([k % prime for k in grid.origin]) for prime in primes]
    totals = [[0] * 10 for _ in primes]
    add = _compiled if _KERNEL.worthwhile(triangles.count) else _vectorised
    for stop, corners in _chunks(triangles):
        for k, prime in enumerate(primes):
            sums = add(corners.view(np.int64), powers[k], origins[k], prime)
            totals[k] = [total + term for total, term in zip(totals[k], sums.tolist(), strict=True)]
        if progress is not None:
            progress(stop / triangles.count)
    return _moments([_lifted(residues, primes) for residues in zip(*totals, strict=True)], grid)


def _moments(sums: list[int], grid: _Grid) -> Moments:
    unit = Fraction(2) ** grid.exponent
    x, y, z = (unit * k for k in grid.origin)
    fx, fy, fz = (unit**4 * k / 24 for k in sums[1:4])
    xx, yy, zz = (unit**5 * k / 60 for k in sums[4:7])
    yz, zx, xy = (unit**5 * k / 120 for k in sums[7:10])
    return Moments((x, y, z), unit**3 * sums[0] / 6, (fx, fy, fz), (xx, yy, zz, yz, zx, xy))


def _grid(triangles: Triangles) -> _Grid:
    """Find the lowest bit of any coordinate, and the box."""
    lowest = 1024
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for _, corners in _chunks(triangles):
        low = np.minimum(low, corners.min(axis=1).reshape(3, 3).min(axis=0))
        high = np.maximum(high, corners.max(axis=1).reshape(3, 3).max(axis=0))
        if not np.isfinite(low + high).all():
            _refuse_non_finite(triangles)
        lowest = min(lowest, _lowest_bit(corners.view(np.int64)))
    origin = [_whole(float(value), lowest) for value in low]
    reach = max(_whole(float(value), lowest) - k for value, k in zip(high, origin, strict=True))
    half = reach // 2
    x, y, z = (k + half for k in origin)
    return _Grid(lowest, (x, y, z), reach - half)


def _chunks(triangles: Triangles) -> Iterator[tuple[int, Float]]:
    """Yield the corners as (9, k) arrays, with the number of triangles so far."""
    for start in range(0, triangles.count, CHUNK):
        stop = min(start + CHUNK, triangles.count)
        corners = np.ascontiguousarray(triangles.corners(start, stop).reshape(-1, 9).T)
        yield stop, corners


def _parts(bits: Int) -> tuple[Int, Int]:
    """Return the mantissas as integers and the exponent fields of float64 given as bits."""
    field = (bits >> 52) & 0x7FF
    mantissa = (bits & ((1 << 52) - 1)) | ((field > 0).astype(np.int64) << 52)
    return mantissa, field


def _lowest_bit(bits: Int) -> int:
    """Return the exponent of the lowest bit that is set in any coordinate."""
    mantissa, field = _parts(bits)
    trailing = ((mantissa & -mantissa).astype(np.float64).view(np.int64) >> 52) - 1023
    exponents = np.maximum(field, 1) - 1075 + trailing
    return int(np.where(mantissa == 0, 1024, exponents).min())


def _whole(value: float, exponent: int) -> int:
    number = Fraction(value) / Fraction(2) ** exponent
    assert number.denominator == 1
    return number.numerator


def _refuse_non_finite(triangles: Triangles) -> None:
    where = first_non_finite(triangles)
    assert where is not None
    raise GeometryError(
        f"triangle {where[0]}, corner {where[1]} has a coordinate that is not finite: export the mesh again",
        code="non_finite",
    )


def _primes(product: int) -> list[int]:
    """Return primes below 2³⁰, largest first, whose product is above `product`."""
    primes: list[int] = []
    reached = 1
    candidates: Iterator[int] = iter(range(_LARGEST_PRIME - 1, 3, -2))
    while reached <= product:
        candidate = next(candidate for candidate in candidates if _is_prime(candidate))
        primes.append(candidate)
        reached *= candidate
    return primes


def _is_prime(number: int) -> bool:
    """Miller and Rabin's test with the bases 2, 3, 5, 7, which is no test but a proof below 3 215 031 751."""
    odd = number - 1
    twos = (odd & -odd).bit_length() - 1
    odd >>= twos
    for base in (2, 3, 5, 7):
        power = pow(base, odd, number)
        if power not in (1, number - 1) and all(
            (power := power * power % number) != number - 1 for _ in range(twos - 1)
        ):
            return False
    return True


def _powers(prime: int, exponent: int) -> Int:
    """Return for each exponent field of a float64 the residue of its last bit's weight over 2^exponent.

    Fields of coordinates that have low bits unset may lie below the grid: there 2 is inverted, modulo the prime.
    """
    half = pow(2, -1, prime)
    first = -1074 - exponent
    weight = pow(2, first, prime) if first >= 0 else pow(half, -first, prime)
    table = np.empty(2048, np.int64)
    for field in range(2048):
        table[field] = weight
        if field > 0:
            weight = weight * 2 % prime
    return table


def _compiled(corners: Int, power: Int, origin: Int, prime: int) -> Int:
    out = np.zeros(10, np.int64)
    at = (power.ctypes.data, origin.ctypes.data)
    _KERNEL.function(corners.ctypes.data, corners.shape[1], *at, prime, 1.0 / prime, out.ctypes.data)
    return out


def _vectorised(corners: Int, power: Int, origin: Int, prime: int) -> Int:
    inverse = 1.0 / prime

    def reduced(value: Int) -> Int:
        residue: Int = value - (value * inverse).astype(np.int64) * prime
        return residue

    mantissa, field = _parts(corners)
    residue = reduced(mantissa) * power[field]
    signed = np.where(corners < 0, -residue, residue).reshape(3, 3, -1)
    a, b, c = reduced(signed - origin[None, :, None])
    u, v = b - a, c - a
    n = reduced(np.stack([u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]))
    d = reduced(a[0] * n[0] + a[1] * n[1] + a[2] * n[2])
    t = a + b
    s = reduced(t + c)
    diagonal = reduced(a * a + b * t + c * s)
    mixed = [s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j] for i, j in ((1, 2), (2, 0), (0, 1))]
    terms = [d[None], reduced(d * s), reduced(d * diagonal), reduced(d * reduced(np.stack(mixed)))]
    total: NDArray[np.int64] = np.concatenate(terms).sum(axis=1)
    return total


def _lifted(residues: tuple[int, ...], primes: list[int]) -> int:
    """Return the integer nearest to zero with these residues, prime by prime (Garner's form)."""
    value, modulus = 0, 1
    for residue, prime in zip(residues, primes, strict=True):
        value += modulus * ((residue - value) * pow(modulus, -1, prime) % prime)
        modulus *= prime
    return value - modulus if 2 * value > modulus else value
