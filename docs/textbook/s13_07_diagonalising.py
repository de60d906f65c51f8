r"""
13.7 Diagonalising the inertia tensor
=====================================

The best way to the principal axes is not by trial. :math:`\mathbf I \cdot \mathbf\omega = I \mathbf\omega` has
a solution other than zero where :math:`\det(\mathbf I - I\,\mathbf 1) = 0`, the *secular equation*: a cubic, whose
three roots are the principal moments; each put back (eq. 13.28) gives the direction of its axis. A symmetric matrix has
three real roots. Two bodies show what can happen: a brick about some point has three different ones, a cube about its
corner a single and a double one.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# A box has :math:`\tfrac{1}{12} M (b^2 + c^2)` about its middle, and so on: ``MassProperties`` takes mass, volume,
# centre of mass and that tensor as they are, and ``about`` shifts it to another point.


def box(size, mass):
    """Return the mass properties of a box with a corner at the origin and sides (3,) m along the axes."""
    squares = np.square(size)
    return inertia.MassProperties(mass, np.prod(size), 0.5 * size, mass / 12 * np.diag(squares.sum() - squares))


brick = box(np.array([3.0, 2.0, 1.0]), 12.0).about([1.0, 0.4, 0.2])
cube = box(np.array([1.3, 1.3, 1.3]), 12.0).about([0.0, 0.0, 0.0])
print(brick.round(4))

# %%
# **By hand**: with the trace p, the sum of minors q and the determinant r the cubic is
# :math:`I^3 - p I^2 + q I - r = 0`. Three real roots are best found by Viète's cosines.


def secular(tensor):
    """Return p, q and r."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor
    minors = xx * yy + yy * zz + zz * xx - xy**2 - yz**2 - xz**2
    return xx + yy + zz, minors, xx * yy * zz + 2 * xy * yz * xz - xx * yz**2 - yy * xz**2 - zz * xy**2


def roots(p, q, r):
    """Return the roots of the cubic, ascending."""
    spread = np.sqrt(p * p - 3 * q)
    angle = np.arccos(np.clip((2 * p**3 - 9 * p * q + 27 * r) / (2 * spread**3), -1, 1)) / 3
    return np.sort((p + 2 * spread * np.cos(angle + 2 * np.pi / 3 * np.arange(3))) / 3)


# %%
# **By the library**: ``principal`` takes any tensor. It does not go by the cubic, whose double roots lose half of the
# digits, but turns the matrix itself.

answer, double = inertia.principal(brick), inertia.principal(cube)
np.testing.assert_allclose(answer.moments, roots(*secular(brick)), rtol=1e-12)
np.testing.assert_allclose(double.moments, 1.69 * np.array([2, 11, 11]), rtol=1e-12)  # M a² (2/12, 11/12, 11/12)
for moment, axis in zip(answer.moments, answer.axes.T, strict=True):
    np.testing.assert_allclose(brick @ axis, moment * axis, atol=1e-12)  # eq. 13.28
    other = np.cross(brick[0] - [moment, 0, 0], brick[1] - [0, moment, 0])  # at right angles to two of its rows
    np.testing.assert_allclose(np.abs(axis @ other), np.linalg.norm(other), rtol=1e-12)
    print(f"I = {moment:7.4f} kg m² about {axis.round(4)}")
np.testing.assert_allclose(double.axes[:, 0], np.full(3, 3**-0.5), atol=1e-12)  # the diagonal of the cube
print(f"cube: {double.moments.round(6)}, {double.kind}, equal: {double.equal}")

# %%
# The answer says which moments are equal, for their axes are then any two across the third. It chooses those nearest
# to x, y and z, so that the same body gives the same answer every time.
#
# Look at where the curves meet zero: the brick's crosses three times; the cube's crosses once, along the diagonal, and
# only touches at the double root.
#
# **To try**: sides of 1.3, 1.3 and 1.4 m. The double root splits: how far apart are the two?

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.axhline(0.0, color="0.6", linewidth=1)
trial = np.linspace(1.0, 24.0, 400)
for color, tensor, name in (("C0", brick, "brick about a point inside"), ("C2", cube, "cube about its corner")):
    p, q, r = secular(tensor)
    ax.plot(trial, (r - q * trial + p * trial**2 - trial**3) / 100, color=color, label=name)
    ax.plot(inertia.principal(tensor).moments, [0, 0, 0], "o", color=color)
ax.set(xlabel="I / kg m²", ylabel="determinant / 100 (kg m²)³", ylim=(-8, 16), title="The secular equation")
ax.legend()
plt.show()
