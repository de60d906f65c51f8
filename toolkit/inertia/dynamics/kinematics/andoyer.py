"""Serret–Andoyer variables (l, g, h; L, G, H) of a rotating body, both ways (textbook § 13.19).

The plane at right angles to the angular momentum meets the plane of space x, y in a first node, and the plane of body
axes 1, 2 in a second. h is the angle from space x to the first node, g from the first node to the second, l from the
second node to body axis 1. G = |L|, H and L are the components of the angular momentum along space z and along body
axis 3; (L, l), (G, g), (H, h) are canonically conjugate.

With I the angle between space z and the angular momentum, cos I = H/G, and J that between it and body axis 3,
cos J = L/G, the attitude is R_z(h) R_x(I) R_z(g) R_x(J) R_z(l) (H. Andoyer, *Cours de mécanique céleste* I, 1923;
A. Deprit, Am. J. Phys. 35 (1967) 424).

Where the angular momentum is along space z, only h ± g is defined: h = 0 and g carries all of it. Where it is along
body axis 3, only g ± l: l = 0. Where it is zero, nothing is.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.arguments import at_index, first_index, moments_of, vectors
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.euler_angles import SINGULAR_SINE, turn_about
from inertia.errors import GeometryError
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Andoyer:
    """Serret–Andoyer variables (…).

    Attributes
    ----------
    l, g, h : rad
    L, G, H : kg m²/s
    obliquity, inclination : rad, J and I; near 0 and π known better than L/G and H/G know them, which hold but half of
        their digits there
    """

    l: Float
    g: Float
    h: Float
    L: Float
    G: Float
    H: Float
    obliquity: Float
    inclination: Float

    @classmethod
    def of(cls, l: ArrayLike, g: ArrayLike, h: ArrayLike, L: ArrayLike, G: ArrayLike, H: ArrayLike) -> Andoyer:
        """Take the six variables (…); J and I follow from them.

        Raises `GeometryError` where G is not positive or is less than |L| or |H|, `UsageError` where a value is not
        finite.

        >>> Andoyer.of(0, 0, 0, 1, 2, 1).inclination.round(6).item()     # π/3
        1.047198
        """
        six = vectors(np.stack(np.broadcast_arrays(l, g, h, L, G, H), axis=-1), "(l, g, h, L, G, H)", 6)
        node_l, node_g, node_h, along_3, size, along_z = np.moveaxis(six, -1, 0)
        if not (turning := size > 0).all():
            raise GeometryError(
                f"G{at_index(first_index(~turning))} is not positive: without angular momentum no node exists"
            )
        for name, part in (("L", along_3), ("H", along_z)):
            if (beyond := np.abs(part) > size).any():
                place = first_index(beyond)
                raise GeometryError(
                    f"|{name}|{at_index(place)} is {abs(part[place]):.17g} kg m²/s and G is {size[place]:.17g}: a "
                    "component cannot exceed its vector"
                )
        obliquity, inclination = (
            np.arctan2(np.sqrt((size - part) * (size + part)), part) for part in (along_3, along_z)
        )
        return cls(node_l, node_g, node_h, along_3, size, along_z, obliquity, inclination)


def to_andoyer(attitude: ArrayLike, angular_momentum: ArrayLike) -> Andoyer:
    """Return the variables from attitudes (…, 4), body to space, and L (…, 3) kg m²/s along body axes.

    Raises `GeometryError` where the angular momentum is zero.

    >>> variables = to_andoyer([0, 0, 0, 1], [0, 3, 4])
    >>> variables.G.item(), variables.H.item(), variables.L.item()
    (5.0, 4.0, 4.0)
    """
    q, body = vectors(attitude, "attitude", 4), vectors(angular_momentum, "angular_momentum")
    if (still := ~body.any(axis=-1)).any():
        raise GeometryError(f"angular_momentum{at_index(first_index(still))} is zero: without it no node exists")
    space = quaternion.to_space(q, body)
    magnitude = np.linalg.norm(body, axis=-1)
    l, obliquity = _node(body[..., 0], body[..., 1], body[..., 2])
    h, inclination = _node(space[..., 0], -space[..., 1], space[..., 2])
    before = quaternion.multiply(turn_about(2, h), turn_about(0, inclination))
    after = quaternion.multiply(turn_about(0, obliquity), turn_about(2, l))
    middle = quaternion.multiply(quaternion.multiply(quaternion.conjugate(before), q), quaternion.conjugate(after))
    g = 2.0 * np.arctan2(middle[..., 2], middle[..., 3])
    g = g - 2.0 * np.pi * np.round(g / (2.0 * np.pi))
    along_3, along_z = (np.clip(v[..., 2], -magnitude, magnitude) for v in (body, space))
    return Andoyer(*np.broadcast_arrays(l, g, h, along_3, magnitude, along_z, obliquity, inclination))


def from_andoyer(variables: Andoyer) -> tuple[Float, Float]:
    """Return attitudes (…, 4), body to space, and L (…, 3) kg m²/s along body axes.

    >>> from_andoyer(to_andoyer([0, 0, 0, 1], [0, 3, 4]))[1].round(12).tolist()
    [0.0, 3.0, 4.0]
    """
    v = variables
    turns = (
        turn_about(2, v.h), turn_about(0, v.inclination), turn_about(2, v.g), turn_about(0, v.obliquity),
        turn_about(2, v.l),
    )  # fmt: skip
    across = v.G * np.sin(v.obliquity)
    momentum = np.stack([across * np.sin(v.l), across * np.cos(v.l), v.L], axis=-1)
    return functools.reduce(quaternion.multiply, turns), momentum


def hamiltonian(moments: ArrayLike, variables: Andoyer) -> Float:
    """Return the energy (…) in J of the free body: ½ (sin²l/I1 + cos²l/I2) (G² − L²) + L²/2I3.

    Neither g nor h nor H enters: G, H and h are kept.

    >>> hamiltonian([1, 2, 4], to_andoyer([0, 0, 0, 1], [0, 2, 4])).round(12).item()
    3.0
    """
    i1, i2, i3 = np.moveaxis(moments_of(moments), -1, 0)
    v = variables
    across = v.G * np.sin(v.obliquity)
    energy: Float = 0.5 * ((np.sin(v.l) ** 2 / i1 + np.cos(v.l) ** 2 / i2) * across**2 + v.L**2 / i3)
    return energy


def rates(moments: ArrayLike, variables: Andoyer) -> tuple[Float, Float, Float]:
    """Return (l̇, ġ, L̇) (…) of the free body, in rad/s and N m, by Hamilton's equations.

    l̇ = ∂H/∂L = L (1/I3 − w), ġ = ∂H/∂G = G w with w = sin²l/I1 + cos²l/I2, and
    L̇ = −∂H/∂l = −(G² − L²) sin l cos l (1/I1 − 1/I2); ḣ, Ġ and Ḣ are zero.

    >>> [float(rate) for rate in rates([1, 1, 2], to_andoyer([0, 0, 0, 1], [0, 3, 4]))]
    [-2.0, 5.0, 0.0]
    """
    i1, i2, i3 = np.moveaxis(moments_of(moments), -1, 0)
    v = variables
    sine, cosine = np.sin(v.l), np.cos(v.l)
    weight = sine**2 / i1 + cosine**2 / i2
    across = v.G * np.sin(v.obliquity)
    return v.L * (1.0 / i3 - weight), v.G * weight, -(across**2) * sine * cosine * (1.0 / i1 - 1.0 / i2)


def _node(sine: Float, cosine: Float, along: Float) -> tuple[Float, Float]:
    """Return the angle of a node, 0 where there is none, and the angle between the vector and the axis."""
    across = np.hypot(sine, cosine)
    tilt = np.arctan2(across, along)
    none = across <= SINGULAR_SINE * np.hypot(across, along)
    return np.where(none, 0.0, np.arctan2(sine, cosine)), tilt
