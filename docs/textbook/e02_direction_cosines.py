r"""
Exercise 2: direction cosines and Euler angles
==============================================

Three vectors, :math:`\hat x + \hat y - 2\hat z`, :math:`-\hat x + \hat y` and :math:`\hat x + \hat y + \hat z`, are
perpendicular to one another. Which rotation takes the axes :math:`x, y, z` to them, as a matrix of direction cosines
and as Euler angles (section 13.13)?

Divided by their lengths, they are the rows of the matrix :math:`\lambda` that takes components along the old axes to
those along the new ones. In the convention z-x-z of equation 13.13.5

.. math::

   \begin{aligned}
   \lambda_{33} & = \cos\theta = \tfrac{1}{\sqrt3}, \\
   (\lambda_{31}, \lambda_{32}) & = (\sin\theta \sin\phi, -\sin\theta \cos\phi), \\
   (\lambda_{13}, \lambda_{23}) & = (\sin\theta \sin\psi, \sin\theta \cos\psi),
   \end{aligned}

so that :math:`\theta = 54.7°`, :math:`\phi = 135°` and :math:`\psi = -90°`. With :math:`+\hat x - \hat y` for the
second vector the three would be left-handed, and no rotation at all.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# The rows are the new axes; they are right-handed, as x′ × y′ = z′.
new = np.array([[1, 1, -2], [-1, 1, 0], [1, 1, 1]])
cosines = new / np.linalg.norm(new, axis=1)[:, None]
np.testing.assert_allclose(np.cross(cosines[0], cosines[1]), cosines[2], atol=1e-15)

# %%
# An attitude in `inertia` is a quaternion that takes body components to space components: its matrix is the
# transpose. From it come the Euler angles, and from these the direction cosines again.
attitude = inertia.quaternion.from_matrix(cosines.T)
angles = inertia.euler_angles.to_angles(attitude)
closed_form = np.array([3 * np.pi / 4, np.arccos(1 / np.sqrt(3)), -np.pi / 2])
np.testing.assert_allclose(angles, closed_form, atol=1e-15)
np.testing.assert_allclose(inertia.euler_angles.direction_cosines(angles), cosines, atol=1e-15)
print("φ, θ, ψ = " + ", ".join(f"{angle:.4f}°" for angle in np.degrees(angles)))
print("closed form: 135°, arccos(1/√3) = 54.7356°, −90°")

# %%
# The mirrored set is refused, with the reason.
try:
    inertia.reexpress(np.eye(3), (cosines * [[1], [-1], [1]]).T)
except inertia.UsageError as error:
    print("with x̂ − ŷ:", error)

# %%
# **To look at**: the line of nodes, dotted, is where the planes :math:`xy` and :math:`x'y'` meet. It is 135° from
# :math:`x`, and as :math:`y'` lies along it, :math:`x'` is a quarter turn behind it: that is :math:`\psi`.
#
# **To try**: the same attitude in the convention z-y-z, ``to_angles(attitude, "z-y-z")``.
fig = plt.figure(figsize=(6.4, 4))
ax = fig.add_subplot(projection="3d")
for axes, color, mark in ((np.eye(3), "0.55", ""), (cosines, "C0", "′")):
    for axis, name in zip(axes, "xyz", strict=True):
        ax.plot(*np.outer(axis, [0, 1]), color=color, linewidth=2)
        ax.text(*(1.12 * axis), name + mark, color=color, ha="center")
nodes = np.array([np.cos(closed_form[0]), np.sin(closed_form[0]), 0])
ax.plot(*np.outer(nodes, [-1.2, 1.2]), "C1:", label="line of nodes")
circle = np.linspace(0, 2 * np.pi, 73)
ax.plot(np.cos(circle), np.sin(circle), 0 * circle, color="0.8")
ax.plot(*(np.outer(cosines[0], np.cos(circle)) + np.outer(cosines[1], np.sin(circle))), "C0", alpha=0.4)
ax.set_box_aspect((1, 1, 1), zoom=1.3)
ax.set_axis_off()
ax.view_init(25, 20)
ax.legend(loc="upper left")
plt.show()
