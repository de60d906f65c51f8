"""Mass properties of many small meshes in memory: one compiled pass over all, arrays as the answer, no mesh in the way.

What `inertia.mass.small` does for one is done for all at once; how sums become results with bounds,
`inertia.mass.triangles.results_kernel` says. A mesh that is not small and simple, or too slender for that, goes its way
through `inertia.mass_properties` alone, and where that refuses it, its sentence takes the place of its figures.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Bool, Float, Int
from inertia.errors import InertiaError, UsageError
from inertia.mass.analyse import mass_properties
from inertia.mass.density import ASSUMED
from inertia.mass.integrand import ELEMENTS
from inertia.mass.small import small_sums
from inertia.mass.triangles.kernels import BLOCK
from inertia.mesh.geometry.simple import at_hand
from inertia.mesh.part import Part
from inertia.mesh.surface import indices
from inertia.native import Kernel, place
from inertia.records import dataclass
from inertia.units import length_unit

_KERNEL = Kernel("inertia.mass.triangles.results_kernel", "mass_results", "pippp")
_RESULTS = 18  # as `results_kernel.RESULTS`
_SHOWN = 10  # refusals, in a notebook


@dataclass(frozen=True, eq=False)
class Many:
    """Mass properties of n meshes, SI units; not a number where a mesh was refused.

    Attributes
    ----------
    volume, mass : (n,) m³, kg
    center_of_mass : (n, 3) m
    inertia : (n, 3, 3) kg m² about the centre of mass
    volume_error, inertia_error : (n,) relative bounds: of volume and mass, and of the tensor in the Frobenius norm
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
    for name, array in (("vertices", vertices), ("faces", faces)):
        if not hasattr(array, "__len__"):
            raise UsageError(f"{name} must be arrays, one of each mesh, not {array!r}")
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
        done[which[_fill(answer, which, rows[which], size.metres, weights[which])]] = True
    for k in np.flatnonzero(~done).tolist():
        _answer_alone(answer, k, points[k], corners[k], float(weights[k]), unit)
    return answer


def _split(vertices: Any, faces: Any, offsets: tuple[ArrayLike, ArrayLike]) -> list[list[Any]]:
    """Return the rows of each mesh, in two arrays that hold those of all."""
    if not hasattr(offsets, "__len__") or len(offsets) != 2:
        raise UsageError(f"offsets must be two arrays, of vertices and of faces, not a {type(offsets).__name__}")
    meshes = []
    for name, array, starts in zip(("vertices", "faces"), (vertices, faces), offsets, strict=True):
        rows, at = np.asarray(array), np.asarray(starts)
        if at.ndim != 1 or at.dtype.kind not in "iu" or len(at) == 0 or at[0] < 0 or (at[1:] < at[:-1]).any():
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
    return indices(array) if array.ndim == 2 else None


def _weights(density: ArrayLike, count: int) -> Float:
    weights = np.asarray(density)
    if weights.dtype.kind not in "fiu":
        raise UsageError(f"density is {density!r}: it must be a number of kg/m³, or one of each mesh")
    weights = weights.astype(np.float64)
    if weights.shape not in ((), (count,)):
        raise UsageError(f"density must be one number or {count} of them, not of shape {weights.shape}")
    wrong = ~((weights > 0) & np.isfinite(weights))
    if wrong.any():
        raise UsageError(f"density is {weights[wrong].flat[0]:g} kg/m³: it must be positive and finite")
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
        if rows.ndim == 2 and rows.shape[1] == 3 and rows.dtype.kind in ("fiu" if kind is np.float64 else "iu"):
            return rows.astype(kind, copy=False)
    except (TypeError, ValueError):
        pass
    return np.empty((0, 3), kind)  # whoever is asked about it alone says what is wrong


def _answer_alone(answer: Many, k: int, vertices: Any, faces: Any, density: float, unit: str) -> None:
    try:
        part = Part.from_arrays(vertices, faces, unit)
    except (InertiaError, TypeError, ValueError) as error:
        answer.refusals[k] = str(error) if isinstance(error, InertiaError) else f"the arrays hold no mesh: {error}"
        return
    try:
        one = mass_properties(part, density)
    except InertiaError as error:
        answer.refusals[k] = str(error)
        return
    answer.volume[k], answer.mass[k], answer.center_of_mass[k] = one.volume, one.mass, one.center_of_mass
    answer.inertia[k], answer.volume_error[k] = one.inertia, max(one.error.volume, one.error.mass)
    answer.center_of_mass_error[k], answer.inertia_error[k] = one.error.center_of_mass, one.error.inertia


def _fill(answer: Many, which: Int, rows: Float, metres: Fraction, density: Float) -> Int:
    """Write the results of these meshes, and return which of them are certain (see `MassProperties.moments_within`)."""
    powers = [metres**3 / 6, metres, metres**5 / 480]
    units = np.array([*(part for power in powers for part in _parts(power)), float(metres) ** 5])
    results = np.empty((len(rows), _RESULTS))
    _KERNEL.function(place(rows), len(rows), place(density), place(units), place(results))
    certain = results[:, -1] > 0
    at, some = which[certain], results[certain]
    answer.volume[at], answer.mass[at], answer.center_of_mass[at] = some[:, 0], some[:, 1], some[:, 2:5]
    answer.inertia[at] = some[:, 5:14].reshape(-1, 3, 3)
    answer.volume_error[at], answer.center_of_mass_error[at], answer.inertia_error[at] = some[:, 14:17].T
    return np.flatnonzero(certain)


def _parts(value: Fraction) -> tuple[float, float]:
    """Return a number as the sum of two float64."""
    high = float(value)
    return high, float(value - Fraction(high)) if math.isfinite(high) else 0.0
