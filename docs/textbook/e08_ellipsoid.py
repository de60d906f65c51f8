r"""
Exercise 8: the moments of an ellipsoid
=======================================

What are the principal moments of a uniform solid with the surface :math:`x^2/a^2 + y^2/b^2 + z^2/c^2 = 1`?

Stretched from the unit ball, in which :math:`\int x^2\,dm = \tfrac15 M`, its second moments are
:math:`\tfrac15 M a^2`, :math:`\tfrac15 M b^2` and :math:`\tfrac15 M c^2`, so that

.. math::

   \begin{aligned}
   I_1 & = \tfrac15 M (b^2 + c^2), \\
   I_2 & = \tfrac15 M (c^2 + a^2), \\
   I_3 & = \tfrac15 M (a^2 + b^2) .
   \end{aligned}

The other way round, every body has an ellipsoid with its mass and moments (section 13.10): what it looks like to a
torque.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# A mesh of the unit ball, stretched. Flat faces leave something out; the error falls by 4 with each halving, and what
# is left of it by 16, by 64 and so on: three meshes and Richardson's rule take away the first two.


def ball(slices):
    """Return the corners (m, 3) of the triangles of a globe, three for each."""
    tilt, turn = np.linspace(0, np.pi, slices + 1), np.linspace(0, 2 * np.pi, 2 * slices + 1)
    sine, around = np.sin(tilt) * (tilt % np.pi > 0), np.where(turn < 2 * np.pi, turn, 0.0)
    height = np.cos(tilt)[:, None] + 0 * turn
    grid = np.stack([np.outer(sine, np.cos(around)), np.outer(sine, np.sin(around)), height], axis=2)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3)


globes = [ball(slices) for slices in (12, 24, 48)]


def ellipsoid(semi_axes, density):
    """Return mass and moments (4,) of a round ellipsoid, from three with flat faces."""
    rows = []
    for corners in globes:
        part = inertia.Part.from_arrays(corners * semi_axes, np.arange(len(corners)).reshape(-1, 3))
        body = inertia.mass_properties(part, density, intersections=False)
        rows.append([body.mass, *np.diag(body.inertia)])
    for order in (2, 4):
        rows = (2**order * np.array(rows)[1:] - np.array(rows)[:-1]) / (2**order - 1)
    return rows[0]


semi_axes, density = np.array([0.3, 0.2, 0.1]), 2700.0
mass, *moments = ellipsoid(semi_axes, density)
a, b, c = semi_axes
assert abs(mass / (4 / 3 * np.pi * a * b * c * density) - 1) < 2e-6
closed_form = 4 / 15 * np.pi * a * b * c * density * np.array([b**2 + c**2, c**2 + a**2, a**2 + b**2])
np.testing.assert_allclose(moments, closed_form, rtol=5e-6)
print("moments     ", *(f"{moment:.6f}" for moment in moments), "kg m²")
print("closed form ", *(f"{moment:.6f}" for moment in closed_form), "kg m²")

# %%
# From the moments back to the semi-axes: ``equivalent_ellipsoid`` of any body.
body = inertia.MassProperties(mass, 0.0, [0, 0, 0], np.diag(closed_form * mass / (4 / 3 * np.pi * a * b * c * density)))
np.testing.assert_allclose(body.equivalent_ellipsoid, semi_axes, rtol=1e-13)
print("semi-axes: ", body.equivalent_ellipsoid.round(12), "m")

# %%
# **To look at**: from a lens to a ball to a cigar. Where the curves cross the body is a spherical top; left of it an
# oblate, right of it a prolate one.
#
# **To try**: three different semi-axes; about which one is the intermediate moment?
lengths = np.linspace(0.05, 0.4, 8)
dots = np.array([ellipsoid([0.2, 0.2, length], density) for length in lengths])
per_mass = dots[:, [1, 3]] / dots[:, :1]
np.testing.assert_allclose(per_mass[:, 0], (0.2**2 + lengths**2) / 5, rtol=1e-5)
np.testing.assert_allclose(per_mass[:, 1], (0.2**2 + 0.2**2) / 5, rtol=1e-5)
fine = np.linspace(0.01, 0.42, 100)
fig, ax = plt.subplots(figsize=(6.4, 4))
for k, (name, curve) in enumerate((("$I_1 = I_2$", (0.2**2 + fine**2) / 5), ("$I_3$", 0.08 / 5 + 0 * fine))):
    ax.plot(fine, curve, color=f"C{k}", label=f"{name}, closed form")
    ax.plot(lengths, per_mass[:, k], "o", color=f"C{k}", label=f"{name}, meshes")
ax.set(xlabel="semi-axis c / m, with a = b = 0.2 m", ylabel="moment over mass / m²")
ax.legend()
plt.show()
