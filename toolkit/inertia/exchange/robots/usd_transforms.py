"""Where the prims of a stage lie: their transform ops (translate, rotate, scale, orient, matrix) in rational numbers.

OpenUSD multiplies the matrices of ops in float64, which rounds each time; here angles become turns with 57 digits.
Where that is not what OpenUSD makes of them, up to what float64 rounds, its own matrix counts. Source: OpenUSD API
documentation, UsdGeomXformOp and UsdGeomXformable.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from inertia.mass.moments import dot
from inertia.mesh.tree import ONE, Matrix, Motion, determinant, diagonal, inverse, rotation, times
from inertia.mesh.turns import about, root

_AGREES = 1e-11  # relative: more than OpenUSD rounds, and less than any other reading of an op would change
_BITS = 256  # that are left of the largest number of a motion


class Transforms:
    """The motions of prims to the stage, in its units, each worked out once."""

    def __init__(self, geometry: Any, cache: Any) -> None:
        self._geometry, self._cache = geometry, cache
        self._time = cache.GetTime()
        self._known: dict[str, Motion] = {}

    def place(self, prim: Any) -> Motion:
        """Return where a prim lies in the stage: a point p of it at A p + t."""
        motion, below = Motion(), []
        while prim and not prim.IsPseudoRoot():
            path = str(prim.GetPath())
            if path in self._known:
                motion = self._known[path]
                break
            own, alone = self._local(prim)
            below.append((path, own))
            if alone:
                break
            prim = prim.GetParent()
        for path, own in reversed(below):
            self._known[path] = motion = _then(motion, own)
        return motion

    def _local(self, prim: Any) -> tuple[Motion, bool]:
        """Return where a prim lies in the one above it, and whether it disregards that one."""
        matrix, alone = self._cache.GetLocalTransformation(prim)
        given = _of_rows(matrix)
        if not prim.IsA(self._geometry.Xformable):
            return given, alone
        exact, reach = Motion(), 0.0
        for op in self._geometry.Xformable(prim).GetOrderedXformOps():
            motion = self._motion(op)
            if motion is None:
                return given, alone
            exact = _then(exact, motion)
            reach = max(reach, *(abs(float(k)) for each in (exact, motion) for k in each.at))
        linear, at = (np.array(k, float) for k in (given.linear, given.at))
        apart = np.abs(np.array(exact.linear, float) - linear).max(), np.abs(np.array(exact.at, float) - at).max()
        agrees = apart[0] <= _AGREES * np.abs(linear).max() and apart[1] <= _AGREES * reach
        return (exact if agrees else given), alone

    def _motion(self, op: Any) -> Motion | None:
        """Return what an op does; None of one that is not known here, or undoes what cannot be undone."""
        kind, value = str(op.GetOpType()).rpartition(".Type")[2], op.Get(self._time)
        if value is None:
            return None
        if kind.startswith("Translate"):
            motion = Motion(_along(kind.removeprefix("Translate"), value, Fraction(0)))
        elif kind.startswith("Scale"):
            motion = Motion(linear=diagonal(_along(kind.removeprefix("Scale"), value, Fraction(1))))
        elif kind == "Orient":
            motion = Motion(linear=_oriented(value))
        elif kind == "Transform":
            motion = _of_rows(value)
        elif kind.startswith("Rotate") and set(axes := kind.removeprefix("Rotate")) <= set("XYZ"):
            degrees = [float(value)] if len(axes) == 1 else [float(value["XYZ".index(axis)]) for axis in axes]
            motion = Motion()
            for axis, angle in zip(axes, degrees, strict=True):  # each about the axes of what the prim hangs on
                w, x, y, z = (Fraction(k) for k in about("XYZ".index(axis), Fraction(angle)))
                motion = _then(Motion(linear=rotation((x, y, z, w))), motion)
        else:
            return None
        if not op.IsInverseOp():
            return motion
        if not determinant(motion.linear):
            return None
        back = inverse(motion.linear)
        return Motion(tuple(-dot(row, motion.at) for row in back), back)


def _along(axis: str, value: Any, others: Fraction) -> tuple[Fraction, ...]:
    """Return the three numbers of an op, or that of one for an axis, and `others` along the others."""
    if not axis:
        return tuple(Fraction(float(k)) for k in value)
    return tuple(Fraction(float(value)) if axis == k else others for k in "XYZ")


def _then(outer: Motion, inner: Motion) -> Motion:
    """Return the motion that makes the inner one first."""
    at = tuple(dot(row, inner.at) + k for row, k in zip(outer.linear, outer.at, strict=True))
    return shortened(Motion(at, times(outer.linear, inner.linear)))


def _of_rows(matrix: Any) -> Motion:
    """Return the motion of a matrix (4, 4) that acts on rows, as those of OpenUSD do."""
    return Motion.of([[Fraction(float(matrix[j][i])) for j in range(4)] for i in range(4)])


def _oriented(quaternion: Any) -> Matrix:
    """Return the turn by 2 arccos of the real part about the imaginary one, as OpenUSD takes it (GfRotation)."""
    real = Fraction(float(quaternion.GetReal()))
    axis = [Fraction(float(k)) for k in quaternion.GetImaginary()]
    square = dot(axis, axis)
    if not square or abs(real) >= 1:
        return ONE
    sine = root(1 - real * real) / root(square)
    x, y, z = (sine * k for k in axis)
    return rotation((x, y, z, real))


def shortened(motion: Motion) -> Motion:
    """Return a motion in numbers of 77 digits: longer ones make what follows slow."""
    linear, at = _cut([k for row in motion.linear for k in row]), _cut(motion.at)
    return Motion(at, (linear[:3], linear[3:6], linear[6:]))


def _cut(values: Sequence[Fraction]) -> tuple[Fraction, ...]:
    largest = max(map(abs, values))
    if not largest or all(k.denominator.bit_length() <= _BITS // 2 for k in values):
        return tuple(values)
    unit = Fraction(2) ** (largest.numerator.bit_length() - largest.denominator.bit_length() - _BITS)
    return tuple(round(k / unit) * unit for k in values)
