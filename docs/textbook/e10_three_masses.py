r"""
Exercise 10: three masses on a triangle
=======================================

Three equal masses :math:`m` are at the corners of an equilateral triangle of side :math:`L`, in the :math:`yz` plane,
with the centre of mass at the origin and one corner on :math:`z`. What are the principal moments and axes, and what
are they when the triangle is turned by 45° about :math:`z`?

Flat bodies have :math:`I_y + I_z = I_x` (section 13.9), and a threefold symmetry makes every axis in the plane of the
triangle as good as any other: the moments are :math:`\tfrac12 m L^2` twice in the plane and :math:`m L^2` along its
normal. To turn a body turns its principal axes with it and leaves its moments as they are, so that the second
question has its answer without a tensor: the normal goes from :math:`\hat x` to :math:`(\hat x + \hat y)/\sqrt2`.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

mass, side = 3.0, 2.0
low, half = -side / (2 * np.sqrt(3)), side / 2
corners = np.array([[0, 0, side / np.sqrt(3)], [0, half, low], [0, -half, low]])

# %%
# **(a)** As it stands. The moments of axes 1 and 2 are equal, and ``equal`` says so: any two axes in the plane will do.
triangle = inertia.point_masses(corners, [mass] * 3)
np.testing.assert_allclose(triangle.inertia, mass * side**2 * np.diag([1, 0.5, 0.5]), atol=1e-14)
print("moments:", triangle.principal_moments, "kg m²,", triangle.principal.kind)
print("m L²:", mass * side**2, "kg m²; equal:", triangle.principal.equal)

# %%
# **(b)** Turned by 45°: from the places of the masses, and by turning the body as a whole.
part = half / np.sqrt(2)
turned = inertia.point_masses([corners[0], [-part, part, low], [part, -part, low]], [mass] * 3)
np.testing.assert_allclose(turned.principal_moments, mass * side**2 * np.array([0.5, 0.5, 1]), rtol=1e-14)
np.testing.assert_allclose(turned.principal_axes[:, 2], np.array([1, 1, 0]) / np.sqrt(2), atol=1e-14)
turn = inertia.quaternion.matrix(inertia.quaternion.from_rotation_vector([0, 0, np.pi / 4]))
np.testing.assert_allclose(inertia.reexpress(triangle.inertia, turn.T), turned.inertia, atol=1e-14)
print("axis 3, turned:", turned.principal_axes[:, 2])

# %%
# **To look at**: the moment about a horizontal axis as its direction goes round :math:`z`, by its distance from the
# middle; turning the triangle turns the curve and changes nothing else.
#
# **To try**: four masses on a square, or unequal masses.
azimuth = np.linspace(0, 2 * np.pi, 181)
axes = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1)
fig, ax = plt.subplots(figsize=(6.4, 4.2), subplot_kw={"projection": "polar"})
for k, (body, shift, label) in enumerate(((triangle, 0, "in the yz plane"), (turned, np.pi / 4, "turned by 45°"))):
    about = np.einsum("ni,ij,nj->n", axes, body.inertia, axes)
    closed_form = mass * side**2 * (1 + np.cos(azimuth - shift) ** 2) / 2
    np.testing.assert_allclose(about, closed_form, rtol=1e-13)
    ax.plot(azimuth, about, color=f"C{k}", linewidth=2, label=label)
    ax.plot([shift, shift + np.pi], [mass * side**2] * 2, "o", color=f"C{k}")
ax.set_rlim(0, 13)
ax.set_rlabel_position(112)
ax.set_xlabel("direction of the axis; moment / kg m² outwards")
ax.legend(loc="upper left", bbox_to_anchor=(1.05, 1.05), fontsize="small")
plt.show()
