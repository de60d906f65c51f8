r"""
13.5 Matrix and tensor formulation
==================================

Three sums become one product: :math:`\mathbf L = \mathbf I \cdot \mathbf\omega`, a matrix and a column. It is a
*linear map* of the angular velocity to the angular momentum. Along other axes both columns have other components and
the matrix other elements, :math:`\mathbf I' = \mathbf R^T \mathbf I\, \mathbf R`, but the arrows that they stand for
are the same: that makes it a tensor. Nothing is divided: :math:`\mathbf L` over :math:`\mathbf\omega` is a manner
of speaking, for nine elements cannot follow from one pair of vectors.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# The body is an L-shaped plate of 2 mm steel, 0.4 m by 0.3 m with legs of 0.1 m, in the plane x, y.

plate = inertia.lamina([[0, 0], [0.4, 0], [0.4, 0.1], [0.1, 0.1], [0.1, 0.3], [0, 0.3]], 7850 * 0.002)
tensor = plate.inertia
print(f"mass {plate.mass:.3f} kg, tensor in g m²:")
print((1e3 * tensor).round(4))

# %%
# **The matrix is the sum.** The product of matrix and column is :math:`L_i = \sum_j I_{ij} \omega_j`, for one
# :math:`\mathbf\omega` or for many, which stand in rows.

around = np.linspace(0.0, 2.0 * np.pi, 361)
omegas = np.stack([np.cos(around), np.sin(around), 0.0 * around], axis=1)  # 1 rad/s, every way in the plane
momenta = omegas @ tensor.T
by_sums = [[sum(tensor[i, j] * omega[j] for j in range(3)) for i in range(3)] for omega in omegas[::40]]
np.testing.assert_allclose(momenta[::40], by_sums, atol=1e-16)

# %%
# **Other axes, same arrows.** Turn the axes by 30° about z and by 50° about the new x; the columns of R are the new
# axes in the old ones. ``reexpress`` gives the tensor along them.

a, b = np.radians([30, 50])
about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
rotation = about_z @ about_x
turned = inertia.reexpress(tensor, rotation)
np.testing.assert_allclose((omegas @ rotation) @ turned.T @ rotation.T, momenta, atol=1e-15)

# %%
# What does not depend on the axes: the trace, the sum of the three principal minors, and the determinant.


def invariants(matrix):
    """Return the three coefficients of the secular equation."""
    return np.trace(matrix), 0.5 * (np.trace(matrix) ** 2 - np.trace(matrix @ matrix)), np.linalg.det(matrix)


np.testing.assert_allclose(invariants(turned), invariants(tensor), rtol=1e-12)
i1, i2, i3 = plate.principal_moments
np.testing.assert_allclose(invariants(tensor), (i1 + i2 + i3, i1 * i2 + i2 * i3 + i3 * i1, i1 * i2 * i3), rtol=1e-12)

# %%
# **A circle becomes an ellipse**, whose half-axes are the principal moments, times 1 rad/s.

along = momenta @ plate.principal_axes
np.testing.assert_allclose((along[:, 0] / i1) ** 2 + (along[:, 1] / i2) ** 2, 1.0, rtol=1e-12)
lengths = 1e3 * np.linalg.norm(momenta, axis=1)
print(f"|L| is {lengths.min():.3f} to {lengths.max():.3f} g m²/s")

# %%
# Look at the circle and what becomes of it. Where the arrow of
# :math:`\mathbf L` (coloured) is parallel to that of :math:`\mathbf\omega` (grey), the direction is principal
# (section 13.6).
#
# **To try**: legs of equal length. Which way does the ellipse lie then, and why?

fig, ax = plt.subplots(figsize=(6.4, 4))
circle = 1e3 * i2 * omegas  # ω, drawn as large as the ellipse
ax.plot(*circle[:, :2].T, color="0.75", linewidth=1, label="ω, 1 rad/s every way")
ax.plot(1e3 * momenta[:, 0], 1e3 * momenta[:, 1], color="C2", label="L = I·ω")
for k in range(0, 360, 45):
    ax.plot([0, circle[k, 0]], [0, circle[k, 1]], color="0.75", linewidth=1)
    tip = 1e3 * momenta[k, :2]
    ax.annotate("", tip, (0, 0), arrowprops={"arrowstyle": "-|>", "color": "C2", "shrinkA": 0, "shrinkB": 0})
for number in (0, 1):
    axis = 1e3 * i2 * plate.principal_axes[:2, number]
    ax.plot(*np.array([-axis, axis]).T, ":", color=f"C{number}", label=f"principal axis {number + 1}")
ax.set(xlabel="$L_x$ / (g m²/s)", ylabel="$L_y$ / (g m²/s)", aspect="equal", title="From circle to ellipse")
ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
plt.show()
