r"""
Exercise 12: four masses on a cross
===================================

Four masses :math:`m` at :math:`(\pm a, 0)` and :math:`(0, \pm 2a)` in the :math:`xy` plane are joined by light rods.
What is the tensor; what is the moment about the direction :math:`\hat n` that makes equal angles with the three axes;
and when the body turns about :math:`\hat n`, how far is :math:`\mathbf{L}` from it?

.. math::

   \begin{aligned}
   \mathbf{I} & = m a^2\, \mathrm{diag}(8, 2, 10), \\
   \hat n\cdot\mathbf{I}\cdot\hat n & = \tfrac{8 + 2 + 10}{3} m a^2 = \tfrac{20}{3} m a^2, \\
   \cos\angle(\mathbf{L}, \hat n) & = \frac{20}{\sqrt{3 \cdot 168}},
   \end{aligned}

as :math:`\mathbf{L}` lies along :math:`(8, 2, 10)`. The angle is 27.0°. That :math:`10 = 8 + 2` is the rule of flat
bodies (section 13.9).
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

mass, a = 2.0, 0.5

# %%
# **(a)** The tensor.
cross = inertia.point_masses([[a, 0, 0], [-a, 0, 0], [0, 2 * a, 0], [0, -2 * a, 0]], [mass] * 4)
np.testing.assert_allclose(cross.inertia, mass * a**2 * np.diag([8, 2, 10]), atol=1e-15)
print(cross.inertia)

# %%
# **(b)** The moment about an axis is :math:`\hat n\cdot\mathbf{I}\cdot\hat n`. **(c)** The angle from
# :math:`\boldsymbol\omega` to :math:`\mathbf{L}`: the toolkit takes ω along the principal axes.
n = np.ones(3) / np.sqrt(3)
about = n @ cross.inertia @ n
angle = inertia.momentum_angle(cross.principal_moments, cross.principal_axes.T @ n)
assert abs(about - 20 / 3 * mass * a**2) < 1e-14
assert abs(angle - np.arccos(20 / np.sqrt(3 * 168))) < 1e-14
print(f"moment about n: {about:.9f} kg m²")
print(f"closed form:    {20 / 3 * mass * a**2:.9f} kg m²")
print(f"L is off n by   {np.degrees(angle):.9f}°")
print(f"closed form:    {np.degrees(np.arccos(20 / np.sqrt(504))):.9f}°")

# %%
# **To look at**: as the axis goes from :math:`z` down to the direction half-way between :math:`x` and :math:`y`, the
# moment falls from 10 to 5 units. :math:`\mathbf{L}` is along the axis only at :math:`z`, a principal axis: half-way
# between two principal axes with different moments it never is.
#
# **To try**: go from :math:`z` down to :math:`x` instead.
polar = np.linspace(0, np.pi / 2, 91)
axes = np.stack([np.sin(polar) / np.sqrt(2), np.sin(polar) / np.sqrt(2), np.cos(polar)], axis=1)
moments = np.einsum("ni,ij,nj->n", axes, cross.inertia, axes)
np.testing.assert_allclose(moments, mass * a**2 * (5 * np.sin(polar) ** 2 + 10 * np.cos(polar) ** 2), rtol=1e-14)
angles = inertia.momentum_angle(cross.principal_moments, axes @ cross.principal_axes)
at_n = np.degrees(np.arccos(1 / np.sqrt(3)))
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(np.degrees(polar), moments / (mass * a**2), color="C0")
ax.plot(at_n, 20 / 3, "o", color="C0")
ax.set(xlabel="angle of the axis from z / °", ylim=(0, 11))
ax.set_ylabel("moment about the axis / m a²", color="C0")
right = ax.twinx()
right.plot(np.degrees(polar), np.degrees(angles), "--", color="C1")
right.plot(at_n, np.degrees(np.arccos(20 / np.sqrt(504))), "o", color="C1")
right.set_ylim(0, 60)
right.grid(visible=False)
right.spines["right"].set_visible(True)
right.set_ylabel("angle from the axis to L / °", color="C1")
ax.annotate("n", (at_n, 20 / 3), xytext=(6, 6), textcoords="offset points")
plt.show()
