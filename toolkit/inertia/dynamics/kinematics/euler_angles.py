"""Euler angles (φ, θ, ψ) and their rates, in three conventions (textbook § 13.13–14).

A convention names the axes of three turns, each about an axis that the earlier ones have carried along: first φ, then
θ, then ψ. The matrix of direction cosines that takes space components to body components is λ = λψ λθ λφ.

=========  ==================================  =========================  ========
name       turns about                         range of θ                 singular
=========  ==================================  =========================  ========
``z-x-z``  z, the line of nodes, axis 3        0 … π                      sin θ = 0
``z-y-z``  z, the carried y, axis 3            0 … π                      sin θ = 0
``x-y-z``  x, the carried y, axis 3            −π/2 … π/2                 cos θ = 0
=========  ==================================  =========================  ========

Where the axes of φ and ψ are parallel, only φ + ψ is defined; where they are opposite, only φ − ψ. Such a singular
attitude is given with φ carrying all of it and ψ = 0. The same holds for the rates: see `rates`.
"""

from __future__ import annotations

import functools
import itertools
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float
from inertia.dynamics.arguments import at_index, first_index, vectors
from inertia.dynamics.kinematics import quaternion
from inertia.errors import GeometryError, UsageError

Convention = Literal["z-x-z", "z-y-z", "x-y-z"]
Frame = Literal["body", "space"]

SINGULAR_SINE = 1e-15
"""Attitudes count as singular below this sine between the axes of φ and ψ: the rounding of a quaternion."""

_AXES = {"z-x-z": (2, 0, 2), "z-y-z": (2, 1, 2), "x-y-z": (0, 1, 2)}
_TURN = 2.0 * np.pi


def from_angles(angles: ArrayLike, convention: Convention = "z-x-z") -> Float:
    """Return the attitude (…, 4), body to space, of Euler angles (…, 3) in rad: q = q_i(φ) q_j(θ) q_k(ψ).

    >>> from_angles([0, 0, np.pi]).round(15).tolist()
    [0.0, 0.0, 1.0, 0.0]
    """
    angles = vectors(angles, "angles")
    turns = (turn_about(axis, angles[..., number]) for number, axis in enumerate(_axes(convention)))
    return functools.reduce(quaternion.multiply, turns)


def turn_about(axis: int, angle: ArrayLike) -> Float:
    """Return the quaternion (…, 4) of turns by angles (…) in rad about coordinate axis 0, 1 or 2."""
    half = 0.5 * np.asarray(angle, dtype=np.float64)
    turn = np.zeros((*half.shape, 4))
    turn[..., axis], turn[..., 3] = np.sin(half), np.cos(half)
    return turn


def to_angles(attitude: ArrayLike, convention: Convention = "z-x-z") -> Float:
    """Return the Euler angles (…, 3) in rad of attitudes (…, 4), body to space; φ and ψ within −π … π.

    Half sums and half differences of φ and ψ are arguments of pairs of the quaternion's components, and θ the argument
    of the lengths of these pairs, so that nothing is lost near the singular attitudes (E. Bernardes, S. Viollet, PLoS
    ONE 17 (2022) e0276302). Singular attitudes get ψ = 0; `is_singular` flags them.

    >>> to_angles(from_angles([0.3, 1e-9, -0.1])).round(12).tolist()
    [0.3, 1e-09, -0.1]
    """
    i, j, k = _axes(convention)
    q = vectors(attitude, "attitude", 4)
    sign = _handedness(i, j)
    a, b, c, d = q[..., 3], q[..., i], q[..., j], sign * q[..., 3 - i - j]
    if k != i:  # a quarter turn about j takes the third axis onto the first
        a, b, c, d = a - c, b - d, a + c, b + d
    theta = 2.0 * np.arctan2(np.hypot(c, d), np.hypot(a, b))
    half_sum, half_difference = np.arctan2(b, a), np.arctan2(d, c)
    phi, psi = half_sum + half_difference, half_sum - half_difference
    if k != i:
        theta, psi = theta - 0.5 * np.pi, -sign * psi
    cosine, sine = _between(theta, (i, j, k))
    singular = np.abs(sine) < SINGULAR_SINE
    phi = np.where(singular, phi + np.sign(cosine) * psi, phi)
    psi = np.where(singular, 0.0, psi)
    return np.stack([_wrapped(phi), theta, _wrapped(psi)], axis=-1)


def direction_cosines(angles: ArrayLike, convention: Convention = "z-x-z") -> Float:
    """Return λ = λψ λθ λφ (…, 3, 3): it takes space to body components; its rows are the body axes in space."""
    return np.swapaxes(quaternion.matrix(from_angles(angles, convention)), -1, -2)


def is_singular(angles: ArrayLike, convention: Convention = "z-x-z") -> NDArray[np.bool_]:
    """Flag (…) the Euler angles at which only φ̇ + ψ̇ or φ̇ − ψ̇ is defined.

    >>> is_singular([[0, 0, 0], [0, 1, 0], [0, np.pi, 0]]).tolist()
    [True, False, True]
    """
    theta = vectors(angles, "angles")[..., 1]
    flags: NDArray[np.bool_] = np.abs(_between(theta, _axes(convention))[1]) < SINGULAR_SINE
    return flags


def rate_axes(angles: ArrayLike, convention: Convention = "z-x-z", frame: Frame = "body") -> Float:
    """Return (…, 3, 3): in its rows the unit vectors about which φ̇, θ̇, ψ̇ turn, along body or space axes.

    ω is the sum of the rows times their rates, and the canonical momenta are the components of L along them.
    """
    i, j, k = _axes(convention)
    phi, theta, psi = np.moveaxis(vectors(angles, "angles"), -1, 0)
    unit = np.eye(3)
    if frame == "space":
        rows = [unit[i], _turned(unit[j], i, phi), _turned(_turned(unit[k], j, theta), i, phi)]
    elif frame == "body":
        rows = [_turned(_turned(unit[i], j, -theta), k, -psi), _turned(unit[j], k, -psi), unit[k]]
    else:
        raise UsageError(f"frame is {frame!r}: it must be 'body' or 'space'")
    return np.stack(np.broadcast_arrays(*rows), axis=-2)


def angular_velocity(
    angles: ArrayLike, rates: ArrayLike, convention: Convention = "z-x-z", frame: Frame = "body"
) -> Float:
    """Return ω (…, 3) rad/s along body or space axes from Euler angles and rates (φ̇, θ̇, ψ̇) (…, 3) rad/s.

    For z-x-z: ω1 = φ̇ sinθ sinψ + θ̇ cosψ, ω2 = φ̇ sinθ cosψ − θ̇ sinψ, ω3 = φ̇ cosθ + ψ̇ (textbook eq. 13.86–88);
    ωx = θ̇ cosφ + ψ̇ sinθ sinφ, ωy = θ̇ sinφ − ψ̇ sinθ cosφ, ωz = φ̇ + ψ̇ cosθ (eq. 13.89–91).

    >>> angular_velocity([0, np.pi / 2, 0], [1, 2, 3]).round(12).tolist()
    [2.0, 1.0, 3.0]
    """
    omega: Float = np.einsum("...a,...ax->...x", vectors(rates, "rates"), rate_axes(angles, convention, frame))
    return omega


def rates(
    angles: ArrayLike,
    omega: ArrayLike,
    convention: Convention = "z-x-z",
    frame: Frame = "body",
    *,
    merge: bool = False,
) -> Float:
    """Return the Euler rates (φ̇, θ̇, ψ̇) (…, 3) rad/s from angles (…, 3) and ω (…, 3) along body or space axes.

    At a singular attitude only the sum φ̇ + ψ̇ (axes of φ and ψ parallel: θ = 0 or, for x-y-z, π/2) or the difference
    φ̇ − ψ̇ (opposite: θ = π or −π/2) is defined. That raises `GeometryError` naming the first such sample; with `merge`
    these samples get the sum or the difference as φ̇, the speed |θ̇| at which the two axes part as θ̇, and ψ̇ = 0.

    >>> rates([0, np.pi / 2, 0], [2, 1, 3]).round(12).tolist()
    [1.0, 2.0, 3.0]
    >>> rates([0, 0, 0], [0, 0, 7], merge=True).tolist()
    [7.0, 0.0, 0.0]
    """
    omega = vectors(omega, "omega")
    if not merge:
        raise_if_singular(angles, convention, "of their rates only φ̇ ± ψ̇ is defined there: ask for it with merge=True")
    outer, node, inner = np.moveaxis(rate_axes(angles, convention, frame), -2, 0)
    singular = is_singular(angles, convention)
    normal = np.cross(node, inner)
    volume = np.where(singular, 1.0, dot(outer, normal))
    regular = [dot(omega, normal) / volume, dot(omega, node), dot(omega, np.cross(outer, node)) / volume]
    merged = [dot(omega, outer), np.linalg.norm(np.cross(omega, outer), axis=-1), 0.0]
    return np.stack([np.where(singular, m, f) for m, f in zip(merged, regular, strict=True)], axis=-1)


def raise_if_singular(angles: ArrayLike, convention: Convention, consequence: str) -> None:
    """Raise `GeometryError` with that consequence, naming the first of the angles (…, 3) that is singular."""
    if (singular := is_singular(angles, convention)).any():
        place = first_index(singular)
        theta = float(np.asarray(angles, dtype=np.float64)[(*place, 1)])
        raise GeometryError(
            f"angles{at_index(place)} are singular in the convention {convention} (θ = {theta:.6g} rad): {consequence}"
        )


def unwrap(angles: ArrayLike, convention: Convention = "z-x-z") -> Float:
    """Return Euler angles (n, 3) of successive samples with the jumps of φ and ψ by 2π taken out.

    Between samples φ and ψ change by what makes the shortest turn, Δφ² + Δψ² + 2 c Δφ Δψ with c the cosine between
    their axes (textbook § 13.16), so that φ ± ψ stays continuous near the singular attitudes, where φ and ψ each
    change fast. Samples must be less than half a turn apart. θ keeps to its range: a path straight through a singular
    attitude turns θ back there, and moves φ and ψ by half a turn each.

    >>> unwrap([[3.0, 1, 0], [-3.0, 1, 0]]).round(3).tolist()
    [[3.0, 1.0, 0.0], [3.283, 1.0, 0.0]]
    """
    angles = vectors(angles, "angles")
    if angles.ndim != 2:
        raise UsageError(f"angles has shape {angles.shape}: unwrap takes one run of samples, (n, 3)")
    steps = np.diff(angles, axis=0)
    cosine, _ = _between(angles[:-1, 1] + 0.5 * steps[:, 1], _axes(convention))
    cosine = (1.0 - 1e-9) * cosine[:, None]  # among equal turns, those of the smallest angles
    nearest = -np.round(steps[:, ::2] / _TURN)
    wholes = nearest[:, None] + np.array([(0, 0), *itertools.product((-1, 0, 1), repeat=2)])
    phi, psi = np.moveaxis(steps[:, None, ::2] + _TURN * wholes, -1, 0)
    best = np.argmin(phi * phi + psi * psi + 2.0 * cosine * phi * psi, axis=1)
    unwrapped = angles.copy()
    unwrapped[1:, ::2] += _TURN * np.cumsum(wholes[np.arange(best.size), best], axis=0)
    return unwrapped


def _axes(convention: str) -> tuple[int, int, int]:
    try:
        return _AXES[convention]
    except KeyError:
        raise UsageError(f"the convention is {convention!r}: it must be one of {', '.join(_AXES)}") from None


def _handedness(i: int, j: int) -> int:
    return 1 if (j - i) % 3 == 1 else -1


def _between(theta: Float, axes: tuple[int, int, int]) -> tuple[Float, Float]:
    """Return cosine and signed sine of the angle between the axes of φ and ψ."""
    i, j, k = axes
    if k == i:
        return np.cos(theta), np.sin(theta)
    return _handedness(i, j) * np.sin(theta), np.cos(theta)


def _wrapped(angle: Float) -> Float:
    return angle - _TURN * np.round(angle / _TURN)


def _turned(vector: Float, axis: int, angle: Float) -> Float:
    """Turn vectors (…, 3) by angles (…) about a coordinate axis."""
    p, q = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = np.empty((*angle.shape, 3))
    turned[..., axis] = vector[..., axis]
    turned[..., p] = cosine * vector[..., p] - sine * vector[..., q]
    turned[..., q] = sine * vector[..., p] + cosine * vector[..., q]
    return turned


def dot(a: Float, b: Float) -> Float:
    """Return the scalar products (…) of vectors (…, 3)."""
    product: Float = np.einsum("...x,...x->...", a, b)
    return product
