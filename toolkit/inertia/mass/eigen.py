"""Eigenvalues and eigenvectors of a symmetric 3×3 matrix that is known within bounds, with bounds that hold.

A needle's tensor holds its smallest moment as a difference of elements that are larger by the square of its
slenderness: a solver in float64 gives noise for it where the rational elements still carry it. Here float64 only
proposes a frame R. Its quaternion is rounded to integers, and the rotation of an integer quaternion is rational and
*exactly* orthogonal (Euler and Rodrigues), so no departure from orthogonality enters the bounds. T = Rᵀ A R is formed
in integers, and where it is not yet diagonal enough, Jacobi rotations, whose half-angle has a float64 tangent and is
thus rational too, are multiplied to the quaternion.

Bounds, with T = D + O (diagonal and the rest), the true matrix being T + E in this frame, |E| ≤ F = |R|ᵀ B |R| element
by element and ‖E‖ ≤ β; ε_i bounds the norm of column i of O + E without its diagonal element:

* |δλ_i| ≤ ‖O‖ + β (Weyl; R. A. Horn, C. R. Johnson, *Matrix Analysis*, 2nd ed., § 4.3);
* |δλ_i| ≤ F_ii + ε_i²/η_i, with η_i the gap between d_i and the eigenvalues of the other two rows and columns, less
  what either may be off by (C.-K. Li, R.-C. Li, *A note on eigenvalues of perturbed Hermitian matrices*, Linear Algebra
  and its Applications 395, 2005): this one knows that the errors across a needle are small;
* sin θ_i ≤ ε_i/g_i, with g_i the gap between d_i and the other true eigenvalues, less F_ii (C. Davis, W. M. Kahan;
  B. N. Parlett, *The Symmetric Eigenvalue Problem*, theorem 11.7.1).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from math import isqrt

import numpy as np

from inertia.arrays import Float
from inertia.records import dataclass

_BITS = 400
"""Bits kept below the smallest element: a part in 10⁶⁰ of the smallest moment of a needle of aspect 10³⁰."""

_NOISE = 1 << 8
"""What the bits cut off may add up to, in units of the last one kept."""

_ZERO = Fraction(0)
_SWEEPS = 12
_SMALL = 2.0**-54
_GUESS = 60
_PAIRS = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
_ELEMENTS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))

_FINE = 224
"""Bits of a gap, or of the moments, below which an element off the diagonal is none in `frame_near`.

Twice those of a double-double: of a spin along an axis, the small component across it keeps its digits, too."""

_Rows = list[list[int]]
_Quaternion = tuple[int, int, int, int]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Eigenvalues, ascending, and eigenvectors, the columns of a frame of either hand.

    Attributes
    ----------
    unit : a power of two, of which the eigenvalues and their bounds are multiples
    multiples, bounds : the eigenvalues, and how far each may be from the true one, in these units
    vectors : (3, 3), each element rounded once
    ratios : numerator and denominator of a bound on the sine of the angle between each vector and the true one, up to
        rounding; 1 where the gap does not exceed the error, so that the vector belongs to a subspace
    """

    unit: Fraction
    multiples: tuple[int, ...]
    bounds: tuple[int, ...]
    vectors: Float
    ratios: tuple[tuple[int, int], ...]

    @property
    def values(self) -> tuple[Fraction, ...]:
        """The eigenvalues."""
        return tuple(self.unit * k for k in self.multiples)

    @property
    def value_bounds(self) -> tuple[Fraction, ...]:
        """How far each may be from the true one."""
        return tuple(self.unit * k for k in self.bounds)

    @property
    def sines(self) -> tuple[Fraction, ...]:
        """The bounds on the sines."""
        return tuple(Fraction(*k) for k in self.ratios)


def spectrum(matrix: Sequence[Sequence[Fraction]], elements: Sequence[Sequence[Fraction]], norm: Fraction) -> Spectrum:
    """Diagonalise a symmetric matrix.

    Parameters
    ----------
    matrix : (3, 3), symmetric
    elements : (3, 3), how far each element may be from the true one
    norm : how far the matrix may be from the true one, in the spectral norm
    """
    unit = _unit([x for row in matrix for x in row if x] or [norm])
    a = _symmetric(_units(matrix[i][j], unit) for i, j in _ELEMENTS)
    b = _symmetric(1 - _units(-elements[i][j], unit) for i, j in _ELEMENTS)
    beta = 6 - _units(-norm, unit)  # the bits cut off, here and in T, are below one unit for each element
    q = _proposed(a)
    turn = _rotation(q)
    t, f = _within(turn, a, b, beta)
    for _ in range(_SWEEPS):
        start = q
        for i, j, k in _PAIRS:
            if not _negligible(t, f, i, j):
                q = _turned(q, k, t[i][j], t[i][i] - t[j][j])
                turn = _rotation(q)
                t, f = _within(turn, a, b, beta)
        if q == start:
            break
    order = sorted(range(3), key=lambda k: t[k][k])
    t, f = ([[rows[i][j] for j in order] for i in order] for rows in (t, f))
    beside = [_beside(t, f, beta, i) for i in range(3)]
    bounds = _value_bounds(t, f, beta, beside)
    return Spectrum(
        unit,
        (t[0][0], t[1][1], t[2][2]),
        tuple(bounds),
        np.array([[row[k] / turn[1] for k in order] for row in turn[0]]),
        _sines(t, f, bounds, beside),
    )


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame in rational arithmetic, exactly orthonormal.

    Attributes
    ----------
    turn : the integer quaternion (w, x, y, z), of any length, that takes the frame's axes to those of the matrix
    values : the diagonal of the matrix in it, all else of which is less than a part in 10⁶⁷
    """

    turn: _Quaternion
    values: tuple[Fraction, ...]

    @property
    def rows(self) -> list[list[Fraction]]:
        """The rotation matrix, whose columns are the axes."""
        rotation, size = _rotation(self.turn)
        return [[Fraction(x, size) for x in row] for row in rotation]

    def along(self, vector: Sequence[Fraction]) -> list[Fraction]:
        """Return the components of a vector along the frame's axes."""
        return [
            sum((x * y for x, y in zip(column, vector, strict=True)), _ZERO) for column in zip(*self.rows, strict=True)
        ]


def frame_near(matrix: Sequence[Sequence[Fraction]], axes: Float) -> Frame:
    """Return the frame next to the columns of `axes` (3, 3) in which a symmetric matrix is diagonal, to 33 digits.

    What `spectrum` gives is rounded to float64; where that is multiplied by a long time, more digits count.

    >>> rows = [[Fraction(k) for k in row] for row in ((2, 1, 0), (1, 2, 0), (0, 0, 5))]
    >>> root = math.sqrt(0.5)
    >>> [float(k) for k in frame_near(rows, np.array([[root, root, 0], [-root, root, 0], [0, 0, 1]])).values]
    [1.0, 3.0, 5.0]
    """
    unit = _unit([x for row in matrix for x in row if x])
    a = _symmetric(_units(matrix[i][j], unit) for i, j in _ELEMENTS)
    nothing = [[0] * 3] * 3
    q = _quaternion(axes.tolist())
    t, _ = _within(_rotation(q), a, nothing, 0)
    for _ in range(_SWEEPS):
        start = q
        for i, j, k in _PAIRS:
            off, gap = abs(t[i][j]) << _FINE, t[i][i] - t[j][j]
            if off > abs(gap) and off > min(abs(t[i][i]), abs(t[j][j])) and abs(t[i][j]) > _NOISE:
                q = _turned(q, k, t[i][j], gap)
                t, _ = _within(_rotation(q), a, nothing, 0)
        if q == start:
            break
    return Frame(q, tuple(unit * t[k][k] for k in range(3)))


def _unit(values: Sequence[Fraction]) -> Fraction:
    """Return the power of two that is the last bit kept."""
    sizes = [value.numerator.bit_length() - value.denominator.bit_length() for value in values]
    return Fraction(2) ** (min(sizes) - _BITS)


def _units(value: Fraction, unit: Fraction) -> int:
    """Return how many whole units there are in a value, rounded down; the unit is a power of two."""
    return value.numerator * unit.denominator // (value.denominator * unit.numerator)


def _symmetric(elements: Iterable[int]) -> _Rows:
    """Return the matrix of the elements on the diagonal and above it, row by row."""
    xx, xy, xz, yy, yz, zz = elements
    return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]


def _proposed(a: _Rows) -> _Quaternion:
    """Return the quaternion (w, x, y, z), of any length, of the frame that Jacobi rotations in float64 give.

    They add, multiply, divide and take roots only, so that the frame has the same bits on any processor.
    """
    size = max(abs(x) for row in a for x in row) or 1
    t = [[x / size for x in row] for row in a]
    r = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    for _ in range(_SWEEPS):
        turned = False
        for i, j, k in _PAIRS:
            off, gap = t[i][j], t[i][i] - t[j][j]
            if abs(off) <= _SMALL * min(abs(t[i][i]), abs(t[j][j])):
                continue
            turned = True
            tangent = _tangent(off, gap)
            cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
            sine = tangent * cosine
            t[i][i] += tangent * off
            t[j][j] -= tangent * off
            t[i][j] = t[j][i] = 0.0
            t[i][k], t[j][k] = cosine * t[i][k] + sine * t[j][k], cosine * t[j][k] - sine * t[i][k]
            t[k][i], t[k][j] = t[i][k], t[j][k]
            for line in r:
                line[i], line[j] = cosine * line[i] + sine * line[j], cosine * line[j] - sine * line[i]
        if not turned:
            break
    return _quaternion(r)


def _quaternion(r: Sequence[Sequence[float]]) -> _Quaternion:
    """Return the quaternion (w, x, y, z), of any length, of a rotation, its elements rounded to integers."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = r
    # Four multiples of the quaternion; the one with the largest leading element loses nothing.
    rows = (
        (1 + xx + yy + zz, zy - yz, xz - zx, yx - xy),
        (zy - yz, 1 + xx - yy - zz, yx + xy, xz + zx),
        (xz - zx, yx + xy, 1 - xx + yy - zz, zy + yz),
        (yx - xy, xz + zx, zy + yz, 1 - xx - yy + zz),
    )
    row = rows[max(range(4), key=lambda k: rows[k][k])]
    w, x, y, z = (round(math.ldexp(value, _GUESS)) for value in row)
    return w, x, y, z


def _rotation(q: _Quaternion) -> tuple[_Rows, int]:
    """Return the rotation of a quaternion: integers, and what they are to be divided by."""
    w, x, y, z = q
    return [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ], w * w + x * x + y * y + z * z


def _within(turn: tuple[_Rows, int], a: _Rows, b: _Rows, beta: int) -> tuple[_Rows, _Rows]:
    """Return T = Rᵀ A R, rounded down, and the bounds F on the error of its elements."""
    rotation, size = turn
    t = _congruent(rotation, a)
    f = _congruent([[abs(x) for x in row] for row in rotation], b)
    square = size * size
    return _symmetric(x // square for x in t), _symmetric(min(x // square + 2, beta) for x in f)


def _congruent(r: _Rows, a: _Rows) -> Iterator[int]:
    """Yield the elements of Rᵀ A R on the diagonal and above it, row by row."""
    columns = list(zip(*r, strict=True))
    turned = [[p * x + q * y + s * z for p, q, s in a] for x, y, z in columns]
    return (x * p + y * q + z * s for i, (x, y, z) in enumerate(columns) for p, q, s in turned[i:])


def _negligible(t: _Rows, f: _Rows, i: int, j: int) -> bool:
    """Return whether an element off the diagonal is small beside its error, or beside what float64 can show of it."""
    off, gap = abs(t[i][j]), abs(t[i][i] - t[j][j])
    if off <= _NOISE or 16 * off <= f[i][j]:
        return True
    nearest = min(abs(t[a][a] - t[b][b]) for a, b, _ in _PAIRS)
    return off << 56 <= nearest and off * off << 60 <= gap * min(abs(t[i][i]), abs(t[j][j]))


def _turned(q: _Quaternion, axis: int, off: int, gap: int) -> _Quaternion:
    """Return the quaternion with a Jacobi rotation about its own axis that takes `off` to zero."""
    tangent = _tangent(off, gap)
    tangent, one = (tangent / (1.0 + math.sqrt(1.0 + tangent * tangent))).as_integer_ratio()
    w, x, y, z = q
    v = [0, 0, 0]
    v[axis] = tangent
    product = (
        one * w - x * v[0] - y * v[1] - z * v[2],
        one * x + w * v[0] + y * v[2] - z * v[1],
        one * y + w * v[1] + z * v[0] - x * v[2],
        one * z + w * v[2] + x * v[1] - y * v[0],
    )
    spare = max(0, max(abs(k) for k in product).bit_length() - _BITS)
    w, x, y, z = (k >> spare for k in product)
    return w, x, y, z


def _tangent(off: float, gap: float) -> float:
    """Return the tangent of the angle of a Jacobi rotation: that of twice the angle is 2 `off`/`gap`."""
    if abs(gap) > abs(off):
        double = 2 * off / gap
        return double / (1.0 + math.sqrt(1.0 + double * double))
    cotangent = gap / (2 * off)
    return math.copysign(1.0, cotangent) / (abs(cotangent) + math.sqrt(1.0 + cotangent * cotangent))


def _value_bounds(t: _Rows, f: _Rows, beta: int, beside: Sequence[int]) -> list[int]:
    """Return bounds on the errors of the diagonal of T as eigenvalues of the true matrix."""
    weyl = isqrt(2 * sum(t[i][j] ** 2 for i, j, _ in _PAIRS)) + 1 + beta
    bounds = []
    for i, j, k in _PAIRS:
        block = _norm([0, 0, t[j][k], t[k][j]], [f[j][j], f[k][k], f[j][k], f[k][j]], beta)
        gap = min(abs(t[i][i] - t[j][j]), abs(t[i][i] - t[k][k])) - f[i][i] - block
        bounds.append(min(weyl, f[i][i] + beside[i] ** 2 // gap + 1) if gap > 0 else weyl)
    return bounds


def _sines(t: _Rows, f: _Rows, bounds: Sequence[int], beside: Sequence[int]) -> tuple[tuple[int, int], ...]:
    sines = []
    for i, j, k in _PAIRS:
        gap = min(abs(t[i][i] - t[j][j]) - bounds[j], abs(t[i][i] - t[k][k]) - bounds[k]) - f[i][i]
        sines.append((beside[i], gap) if gap > beside[i] else (1, 1))
    return tuple(sines)


def _beside(t: _Rows, f: _Rows, beta: int, i: int) -> int:
    """Return a bound on the norm of column i of the true matrix without its diagonal element."""
    others = [j for j in range(3) if j != i]
    return _norm([t[j][i] for j in others], [f[j][i] for j in others], beta)


def _norm(values: Sequence[int], errors: Sequence[int], beta: int) -> int:
    """Return a bound on the norm of values whose errors are bounded one by one, and by `beta` together."""
    apart = isqrt(sum([(abs(value) + error) ** 2 for value, error in zip(values, errors, strict=True)]))
    together = isqrt(sum([value * value for value in values])) + 1 + beta
    return min(apart + 1, together)
