"""
A spring of wire with weights at its ends
=========================================

What is long and thin is a line, what is small is a point: both have mass properties without any mesh, and bodies are
added by ``+``. Here a helix of steel wire of 2 mm carries 5 g at either end.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

radius, pitch, turns = 0.010, 0.006, 6  # m
angle = np.linspace(0, 2 * np.pi * turns, 40 * turns + 1)
line = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), pitch * angle / (2 * np.pi)])
spring = inertia.wire(line, 7850 * np.pi * 0.001**2)
weights = inertia.point_masses(line[[0, -1]], [0.005, 0.005])
whole = spring + weights

# %%
# A chord of the circle has its mass at :math:`R^2 (1 - \tfrac23 \sin^2(\delta/2))` from the axis on average, with
# :math:`\delta` the angle of one piece; the weights are at R.

delta = angle[1]
mean = radius**2 * (1 - 2 / 3 * np.sin(delta / 2) ** 2)
about_axis = spring.about([0, 0, 0])[2, 2]
np.testing.assert_allclose(about_axis, spring.mass * mean, rtol=1e-12)
np.testing.assert_allclose(whole.about([0, 0, 0])[2, 2], about_axis + 0.010 * radius**2, rtol=1e-12)
print(
    f"{1e3 * spring.mass:.2f} g of wire, {1e3 * whole.mass:.2f} g in all, {1e6 * about_axis:.4f} g m·mm about its axis"
)

# %%
# Long along z, so that axis 1 is nearly the spring's own. Try an odd number of half turns: the ends come to lie on
# opposite sides, and the product of inertia that they make tilts the principal axes.

fig = plt.figure(figsize=(6.4, 4))
ax = fig.add_subplot(projection="3d")
ax.plot(*(1e3 * line.T), color="0.4")
ax.plot(*(1e3 * line[[0, -1]].T), "o", color="C0", markersize=9)
center = 1e3 * whole.center_of_mass
for number, axis in enumerate(whole.principal.axes.T):
    ends = center + 18 * np.outer([-1, 1], axis)
    ax.plot(*ends.T, color=f"C{number}", label=f"axis {number + 1}")
ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", zlabel="z, mm")
ax.legend(loc="upper left")
plt.show()
