"""Mass properties of many small meshes in memory: one compiled pass over all, arrays as the answer, no mesh in the way.

What `inertia.mass.small` does for one is done for all at once. From the float64 sums to the results the arithmetic is
double-double, rounded once; the bounds are the distances of the sums from double-double ones, carried through to the
results as in `inertia.mass.moments.Moments.central`. A mesh that is not small and simple, or too slender for that, goes
its way through `inertia.mass_properties` alone, and where that refuses it, its sentence takes the place of its figures.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Bool, Float, Int
from inertia.errors import InertiaError, UsageError
from inertia.mass.analyse import mass_properties
from inertia.mass.density import ASSUMED
from inertia.mass.double_words import Pair
from inertia.mass.integrand import ELEMENTS
from inertia.mass.moments import PAIRS
from inertia.mass.properties import CERTAIN
from inertia.mass.small import small_sums
from inertia.mass.triangles.kernels import BLOCK
from inertia.mass.triangles.sums import SUMS
from inertia.mesh.geometry.simple import at_hand
from inertia.mesh.part import Part
from inertia.units import length_unit

_A_PRIORI = 1e-28
"""More than a term of the sums loses, 2⁻⁹⁵ (see `double_double_kernel.terms`), and 70 roundings of double-double, 2⁻¹⁰³
each: no term passes through more."""

_ROUNDED = 2.0**-52  # once to float64, and all that double-double leaves
_INFLATED = 1.0 + 1e-9  # more than the arithmetic of the bounds can lose
_SHOWN = 10  # refusals, in a notebook
_OTHERS = ((1, 2), (2, 0), (0, 1))


@dataclass(frozen=True, eq=False)
class Many:
    """Mass properties of n meshes, SI units; not a number where a mesh was refused.

    Attributes
    ----------
    volume, mass : (n,) m³, kg
    center_of_mass : (n, 3) m
    inertia : (n, 3, 3) kg m² about the centre of mass
    volume_error, inertia_error : (n,) relative bounds, that of the tensor in the Frobenius norm; the mass has that of
        the volume
    center_of_mass_error : (n,) m
    refusals : the sentence of each mesh that has no answer, by its number
    """

    volume: Float
    mass: Float
    center_of_mass: Float
    inertia: Float
    volume_error: Float
    center_of_mass_error: Float
    inertia_error: Float
    refusals: dict[int, str]

    @property
    def answered(self) -> Bool:
        """Which meshes have an answer, (n,)."""
        return np.isfinite(self.mass)

    def _repr_html_(self) -> str:
        """Return a small table, as a notebook shows it."""
        from inertia.notebook import html_of

        answered = self.answered
        rows = [("Bodies", f"{len(self.mass)}, {int(answered.sum())} of them answered")]
        for name, values, unit in (("Mass", self.mass, "kg"), ("Volume", self.volume, "m³")):
            if answered.any():
                some = values[answered]
                rows.append((name, f"{some.min():.6g} to {some.max():.6g} {unit}, in all {some.sum():.10g} {unit}"))
        if answered.any():
            worst = [float(each[answered].max()) for each in (self.volume_error, self.inertia_error)]
            rows.append(("Bound", f"at most {worst[0]:.2g} of a volume, {worst[1]:.2g} of a tensor (relative)"))
        return html_of([*rows, *((f"Mesh {k}", says) for k, says in list(self.refusals.items())[:_SHOWN])])

    @property
    def columns(self) -> dict[str, Any]:
        """All figures by the names of columns, each (n,), as data frames take them; `refusal` is None where none is."""
        return {
            "volume": self.volume,
            "mass": self.mass,
            **dict(zip(("com_x", "com_y", "com_z"), self.center_of_mass.T, strict=True)),
            **{f"i{'xyz'[j]}{'xyz'[k]}": self.inertia[:, j, k] for j, k in ELEMENTS},
            "volume_error": self.volume_error,
            "center_of_mass_error": self.center_of_mass_error,
            "inertia_error": self.inertia_error,
            "refusal": [self.refusals.get(k) for k in range(len(self.mass))],
        }


def many(
    vertices: ArrayLike | Sequence[ArrayLike],
    faces: ArrayLike | Sequence[ArrayLike],
    density: ArrayLike = ASSUMED,
    *,
    unit: str = "m",
    offsets: tuple[ArrayLike, ArrayLike] | None = None,
) -> Many:
    """Return the mass properties of many small solids, with their bounds; one that is refused does not stop the others.

    Parameters
    ----------
    vertices : (n, v, 3), or n arrays (v, 3)
    faces : n arrays (m, 3), counter-clockwise seen from outside, or one that all share
    density : kg/m³, one or (n,)
    unit : of the coordinates
    offsets : with them `vertices` (v, 3) and `faces` (f, 3) hold all meshes one after another, of any sizes: the first
        row of each mesh in either, and how many there are, (n + 1,) each; faces count the vertices of their mesh from 0

    Raises
    ------
    UsageError : the numbers of vertex and face arrays differ, offsets do not ascend, or a density is not positive

    >>> import inertia
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    >>> answer = inertia.many([corners, np.multiply(corners, 2), np.multiply(corners, -1)], faces, 6.0)
    >>> answer.mass.tolist()
    [1.0, 8.0, nan]
    >>> answer.refusals[2].split(":")[:2]
    ['the part', ' inside out']
    """
    size = length_unit(unit)
    if offsets is not None:
        vertices, faces = _split(vertices, faces, offsets)
    shared = None if offsets is not None else _shared(faces)
    points: Any = vertices if _is_stack(vertices) else list(vertices)  # type: ignore[arg-type]
    corners = [shared] * len(points) if shared is not None else list(faces)  # type: ignore[arg-type]
    if len(points) != len(corners):
        raise UsageError(f"there are {len(points)} arrays of vertices and {len(corners)} of faces: give as many")
    weights = _weights(density, len(points))
    answer = Many(
        np.full(len(points), np.nan), np.full(len(points), np.nan), np.full((len(points), 3), np.nan),
        np.full((len(points), 3, 3), np.nan), np.full(len(points), np.nan), np.full(len(points), np.nan),
        np.full(len(points), np.nan), {},
    )  # fmt: skip
    done = np.zeros(len(points), bool)
    if at_hand() and len(points):
        meshes = _stacked(points, corners, shared)
        meshes[2][meshes[2][:, 3] > BLOCK, 3] = 0  # which are not summed in one pass, and so not checked here
        rows, usable = small_sums(*meshes)
        which = np.flatnonzero(usable & (rows[:, 3] > 0))
        with np.errstate(all="ignore"):
            done[which[_fill(answer, which, rows[which], size.metres, weights[which])]] = True
    for k in np.flatnonzero(~done).tolist():
        _answer_alone(answer, k, points[k], corners[k], float(weights[k]), unit)
    return answer


def _split(vertices: Any, faces: Any, offsets: tuple[ArrayLike, ArrayLike]) -> list[list[Any]]:
    """Return the rows of each mesh, in two arrays that hold those of all."""
    meshes = []
    for name, array, starts in zip(("vertices", "faces"), (vertices, faces), offsets, strict=True):
        rows, at = np.asarray(array), np.asarray(starts)
        if at.ndim != 1 or at.dtype.kind not in "iu" or len(at) == 0 or at[0] < 0 or (np.diff(at) < 0).any():
            raise UsageError(f"the offsets of {name} must be whole numbers from 0 on that ascend")
        if rows.ndim != 2 or rows.shape[1] != 3 or at[-1] > len(rows):
            raise UsageError(
                f"{name} with offsets must be of shape (n, 3) with at least {at[-1]} rows, not {rows.shape}"
            )
        meshes.append([rows[start:stop] for start, stop in pairwise(at.tolist())])
    return meshes


def _shared(faces: Any) -> Int | None:
    """Return the faces that all meshes share, where there is one array (m, 3) of them."""
    try:
        array = np.asarray(faces)
    except ValueError:
        return None  # of several lengths
    return np.ascontiguousarray(array, np.int64) if array.ndim == 2 and array.dtype.kind in "iu" else None


def _weights(density: ArrayLike, count: int) -> Float:
    weights = np.asarray(density, dtype=np.float64)
    if weights.shape not in ((), (count,)):
        raise UsageError(f"density must be one number or {count} of them, not of shape {weights.shape}")
    wrong = ~((weights > 0) & np.isfinite(weights))
    if wrong.any():
        raise UsageError(f"density is {weights[wrong].flat[0]:g} kg/m3: it must be positive and finite")
    return np.broadcast_to(weights, (count,))


def _is_stack(vertices: Any) -> bool:
    """Say whether the vertices of all meshes are one array (n, v, 3) of numbers."""
    return isinstance(vertices, np.ndarray) and vertices.shape[1:][1:] == (3,) and vertices.dtype.kind in "fiu"


def _stacked(points: Sequence[Any], corners: Sequence[Any], shared: Int | None) -> tuple[Float, Int, Int]:
    """Return all vertices, all faces, and the table of which are whose; what has another shape has none."""
    faces = [_as(each, np.int64) for each in corners] if shared is None else [shared]
    if isinstance(points, np.ndarray):
        vertices, sizes = points.astype(np.float64, copy=False).reshape(-1, 3), np.full(len(points), points.shape[1])
    else:
        several = [_as(each, np.float64) for each in points]
        vertices, sizes = np.concatenate(several), np.array([len(each) for each in several])
    counts = np.array([len(each) for each in faces])
    starts, begins = np.cumsum(sizes) - sizes, np.cumsum(counts) - counts
    table = np.empty((len(points), 4), np.int64)
    table[:, 0], table[:, 1], table[:, 2], table[:, 3] = starts, sizes, begins, counts
    return np.ascontiguousarray(vertices), np.concatenate(faces), table


def _as(array: Any, kind: Any) -> Any:
    try:
        rows = np.asarray(array)
        if rows.ndim == 2 and rows.shape[1] == 3 and (kind is np.float64 or rows.dtype.kind in "iu"):
            return rows.astype(kind, copy=False)
    except (TypeError, ValueError):
        pass
    return np.empty((0, 3), kind)  # whoever is asked about it alone says what is wrong


def _answer_alone(answer: Many, k: int, vertices: Any, faces: Any, density: float, unit: str) -> None:
    try:
        one = mass_properties(Part.from_arrays(vertices, faces, unit), density)
    except InertiaError as error:
        answer.refusals[k] = str(error)
        return
    except (TypeError, ValueError) as error:
        answer.refusals[k] = f"the arrays hold no mesh: {error}"
        return
    answer.volume[k], answer.mass[k], answer.center_of_mass[k] = one.volume, one.mass, one.center_of_mass
    answer.inertia[k], answer.volume_error[k] = one.inertia, one.error.volume
    answer.center_of_mass_error[k], answer.inertia_error[k] = one.error.center_of_mass, one.error.inertia


def _fill(answer: Many, which: Int, rows: Float, metres: Fraction, density: Float) -> Int:
    """Write the results of these meshes, and return which of them are certain (see `MassProperties.moments_within`)."""
    origin, sums, low, high = rows[:, :3].T, rows[:, 3 : 3 + SUMS].T, rows[:, 16:19].T, rows[:, 19:22].T
    v, first, second = sums[0], sums[1:4], sums[4:10]
    volume = Pair.of(v) * _pair(metres**3 / 6)
    ratio = _over(Pair.of(first), Pair.of(4.0 * v))
    center = (ratio + Pair.of(origin)) * _pair(metres)
    factor = _pair(metres**5 / 480) * Pair.of(density)
    five = Pair.of(np.full_like(first, 5.0))
    one, other = np.array(_OTHERS).T
    square, eight, four = Pair.of(first) * Pair.of(first), Pair.of(8.0 * v), Pair.of(4.0 * v)
    diagonal = eight * Pair.sum_of(second[one], second[other]) - (square[one] + square[other]) * five
    mixed = Pair.of(first[one]) * Pair.of(first[other]) * five - four * Pair.of(second[3:])
    top = Pair(np.concatenate([diagonal.high, mixed.high]), np.concatenate([diagonal.low, mixed.low]))
    elements = _over(top, Pair.of(v)) * factor
    volumes, masses, centers, tensor = volume.high, (volume * Pair.of(density)).high, center.high, elements.high

    reach = np.maximum(origin - low, high - origin).max(axis=0)
    size = _A_PRIORI * (sums[10] + sums[12])
    accurate = rows[:, 22:].T
    apart = abs((sums[:10] - accurate[0::2]) - accurate[1::2])
    off = (apart[0] + size) / 6.0
    off_first = (apart[1:4] + 3.0 * reach * size) / 24.0
    off_second = (apart[4:10] + 12.0 * reach * reach * size) / np.array([60.0] * 3 + [120.0] * 3)[:, None]
    least, along = v / 6.0 - off, abs(ratio.high)
    moved = off_first + along * off
    weight = (v / 6.0 + off) / least**2
    i, j = np.array(PAIRS).T
    bounds = off_second + along[i] * off_first[j] + along[j] * moved[i] + moved[i] * moved[j] * weight
    scale = float(metres) ** 5 * density
    squares = ((bounds[one] + bounds[other]) ** 2).sum(axis=0) + 2.0 * (bounds[3:] ** 2).sum(axis=0)
    norm = np.sqrt((tensor[:3] ** 2).sum(axis=0) + 2.0 * (tensor[3:] ** 2).sum(axis=0))
    volume_error = off / (v / 6.0) * _INFLATED + _ROUNDED
    inertia_error = np.sqrt(squares) * scale / norm * _INFLATED + _ROUNDED
    distance = np.sqrt((moved**2).sum(axis=0)) / least + _A_PRIORI * reach
    center_error = distance * float(metres) * _INFLATED + _ROUNDED * np.sqrt((centers**2).sum(axis=0))

    certain = _certain(tensor, inertia_error) & (volume_error <= CERTAIN) & np.isfinite(center_error)
    certain &= np.isfinite(tensor).all(axis=0) & (volumes > 0) & (masses > 0) & np.isfinite(masses)
    at = which[certain]
    answer.volume[at], answer.mass[at] = volumes[certain], masses[certain]
    answer.center_of_mass[at] = centers.T[certain]
    xx, yy, zz, yz, zx, xy = tensor[:, certain]
    answer.inertia[at] = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]).transpose(2, 0, 1)
    answer.volume_error[at], answer.inertia_error[at] = volume_error[certain], inertia_error[certain]
    answer.center_of_mass_error[at] = center_error[certain]
    return np.flatnonzero(certain)


def _certain(tensor: Float, error: Float) -> Bool:
    """Say which tensors have principal moments certain to a part in 10⁹ and are those of some body."""
    xx, yy, zz, yz, zx, xy = tensor / (tensor[0] + tensor[1] + tensor[2])
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
    p, q, r = 0.5 - xx, 0.5 - yy, 0.5 - zz
    body = p * (q * r - yz * yz) - xy * (xy * r + yz * zx) - zx * (xy * yz + q * zx)
    positive: Bool = (p > 0) & (q > 0) & (r > 0) & (body > 3.0 * error + 1e-14)
    positive &= 2.0 * error < CERTAIN * (determinant - 1e-13)
    return positive


def _pair(value: Fraction) -> Pair:
    high = float(value)
    return Pair(np.array(high), np.array(float(value - Fraction(high)) if math.isfinite(high) else 0.0))


def _over(a: Pair, b: Pair) -> Pair:
    """Return a/b: the float64 quotient and one step of Newton's method."""
    quotient = a.high / b.high
    rest = a - Pair.of(quotient) * b
    return Pair.sum_of(quotient, rest.high / b.high)
