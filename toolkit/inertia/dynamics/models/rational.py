"""A problem in rational arithmetic: principal frame, spin, arm and attitude, before any of them is rounded to float64.

What is rounded on the way into a model acts as an error of the input, which grows with the time: a relative 1e-16 of a
moment is 1e-10 rad after a million radians. Typed numbers count as the exact numbers that they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import isqrt

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.mass.eigen import Frame, frame_near
from inertia.mass.moments import inertia_tensor
from inertia.records import dataclass

Quaternion = tuple[Fraction, Fraction, Fraction, Fraction]
"""Scalar last, of any length."""

_BITS = 240
_ZERO = Fraction(0)


@dataclass(frozen=True, eq=False)
class Exact:
    """A body about the point that it turns about, as `Problem` has it, in rationals.

    Attributes
    ----------
    tensor : (3, 3) kg m² about the point, part axes
    frame : the principal axes there, and the moments about them
    spin : (3,) rad/s at t = 0, part axes
    arm : (3,) m, part axes, from the point to the centre of mass
    mass : kg; 0 where the scene has none
    attitude : part axes to space, at t = 0
    tensor_bound : kg m², on the Frobenius norm of the tensor's error
    arm_bound : m; mass_bound : kg
    """

    tensor: list[list[Fraction]]
    frame: Frame
    spin: list[Fraction]
    arm: list[Fraction]
    mass: Fraction
    attitude: Quaternion
    tensor_bound: float = 0.0
    arm_bound: float = 0.0
    mass_bound: float = 0.0

    @classmethod
    def of(cls, scene: Scene, reference: Float, axes: Float, offset: bool) -> Exact:
        """Take a scene's body about `reference` (3,), near principal axes (3, 3); without `offset`, about its centre
        of mass."""
        body = scene.body
        mass = Fraction(body.mass or 0)
        arm = [Fraction(c) - Fraction(p) for c, p in zip(body.center_of_mass.tolist(), reference.tolist(), strict=True)]
        attitude = rationals(scene.start.typed_attitude)
        bounds = (0.0, 0.0, 0.0)
        tensor = _symmetric(body.inertia)
        if body.properties is not None:
            here = body.properties.moments_about(reference.tolist() if offset else None)
            tensor = inertia_tensor(here.second)
            arm = [k / here.zeroth for k in here.first]
            mass = here.zeroth
            bounds = float(here.error_norms[1]), float(here.centroid_bound), float(here.zeroth_bound)
        elif body.assembly is not None:
            by_mass, by_place, own = body.assembly.bounds
            size = float(np.linalg.norm(np.array(arm, dtype=float))) if offset else 0.0
            own += by_mass * size**2 + float(mass) * by_place * (2.0 * size + by_place) * offset
            bounds = own, by_place, by_mass
        if body.properties is None and offset:
            square = sum((k * k for k in arm), _ZERO)
            for i in range(3):
                for j in range(3):
                    tensor[i][j] += mass * ((square if i == j else _ZERO) - arm[i] * arm[j])
        if not offset:
            arm = [_ZERO] * 3
        frame = frame_near(tensor, axes)
        return cls(tensor, frame, _spin(scene, attitude), arm, mass, (*attitude,), *bounds)  # type: ignore[arg-type]


def rationals(values: Iterable[float]) -> list[Fraction]:
    """Return numbers as they are."""
    return [Fraction(float(value)) for value in values]


def rounded(values: Iterable[Fraction]) -> tuple[Float, Float]:
    """Return numbers rounded to float64, and what that leaves out."""
    exact = list(values)
    high = [float(value) for value in exact]
    return np.array(high), np.array([float(value - Fraction(k)) for value, k in zip(exact, high, strict=True)])


def root(square: Fraction) -> Fraction:
    """Return √square, to some seventy digits.

    >>> root(Fraction(9, 4))
    Fraction(3, 2)
    """
    if not square:
        return _ZERO
    n, d = isqrt(square.numerator), isqrt(square.denominator)
    if n * n == square.numerator and d * d == square.denominator:
        return Fraction(n, d)
    shift = _BITS - (square.numerator.bit_length() - square.denominator.bit_length()) // 2
    scaled = square * Fraction(4) ** shift
    return Fraction(isqrt(scaled.numerator // scaled.denominator)) / Fraction(2) ** shift


def dot(a: Iterable[Fraction], b: Iterable[Fraction]) -> Fraction:
    """Return a·b."""
    return sum((x * y for x, y in zip(a, b, strict=True)), _ZERO)


def cross(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[Fraction]:
    """Return a × b."""
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def product(p: Sequence[Fraction], q: Sequence[Fraction]) -> Quaternion:
    """Return the quaternion p q."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy + py * qw + pz * qx - px * qz,
        pw * qz + pz * qw + px * qy - py * qx,
        pw * qw - px * qx - py * qy - pz * qz,
    )


def rotated(q: Sequence[Fraction], vector: Sequence[Fraction]) -> list[Fraction]:
    """Return a vector turned by a quaternion of any length."""
    x, y, z, w = q
    size = x * x + y * y + z * z + w * w
    return [k / size for k in product(product(q, (*vector, _ZERO)), (-x, -y, -z, w))[:3]]


def shortest_turn(start: Sequence[Fraction], end: Sequence[Fraction]) -> Quaternion:
    """Return the quaternion of the shortest turn from one unit vector to another, which is not opposite."""
    (a, b, c), (x, y, z) = start, end
    return b * z - c * y, c * x - a * z, a * y - b * x, 1 + a * x + b * y + c * z


def _symmetric(tensor: Float) -> list[list[Fraction]]:
    rows = [rationals(row) for row in tensor.tolist()]
    return [[(rows[i][j] + rows[j][i]) / 2 for j in range(3)] for i in range(3)]


def _spin(scene: Scene, attitude: Sequence[Fraction]) -> list[Fraction]:
    """Return ω (3,) at t = 0, part axes: turned there exactly, whichever axes it is given along."""
    body, spin = scene.body, rationals(scene.start.angular_velocity)
    if scene.start.frame == "space":
        x, y, z, w = attitude
        return rotated((-x, -y, -z, w), spin)
    if scene.start.frame == "principal":
        rows = principal_rows(body)
        return [sum((a * b for a, b in zip(row, spin, strict=True)), _ZERO) for row in rows]
    return spin


def principal_rows(body: SceneBody) -> list[list[Fraction]]:
    """Return the rows of the axes that "principal" means: those of the tensor, or the ones that were given."""
    if body.principal.equal or not np.array_equal(body.axes, body.principal.axes):
        return [rationals(row) for row in body.axes.tolist()]
    if body.properties is not None:
        tensor = inertia_tensor(body.properties.moments_about().second)
    else:
        tensor = _symmetric(body.inertia)
    return frame_near(tensor, body.axes).rows
