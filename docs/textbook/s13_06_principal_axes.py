r"""
13.6 Principal axes
===================

Some axes are special: a body that spins about one has :math:`\mathbf L = I_j\,\mathbf\omega` (eq. 13.24). There are
always three at right angles, and along them the tensor is diagonal; the moments on that diagonal belong to the body,
however it lies in its part axes. One can find them by trial: turn the direction of :math:`\mathbf\omega` until
:math:`\mathbf L` falls in with it. This page does so for a Z-section, whose principal axes no drawing shows.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# The body is a slice of a Z-bar, of 20 kg/m²: a web of 10 by 100 mm and two flanges of 40 by 10 mm.

outline = np.array([[-5, -50], [45, -50], [45, -40], [5, -40], [5, 50], [-45, 50], [-45, 40], [-5, 40]]) / 1000
section = inertia.lamina(outline, 20.0)

# %%
# **By trial**: the angle from ω to L for every direction of ω in the plane, 0° along x.

direction = np.radians(np.linspace(0.0, 180.0, 721))
omega = np.stack([np.cos(direction), np.sin(direction), 0.0 * direction], axis=1)
momentum = omega @ section.inertia
cross = omega[:, 0] * momentum[:, 1] - omega[:, 1] * momentum[:, 0]
between = np.degrees(np.arctan2(cross, np.sum(omega * momentum, axis=1)))

# %%
# **By the library**: ``principal_axes`` has the axes in its columns, that of the smallest moment first.

moments, axes = section.principal_moments, section.principal_axes
found = np.degrees(np.arctan2(axes[1, :2], axes[0, :2])) % 180.0
for number in (0, 1):
    print(f"axis {number + 1} at {found[number]:7.3f}°, I = {1e6 * moments[number]:.3f} kg mm²")

# %%
# **By hand**: the three rectangles have :math:`\int y^2`, :math:`\int x^2` and :math:`\int xy` in closed form, and a
# symmetric matrix has its axes at :math:`\tan 2\beta = 2 I_{xy}/(I_{xx} - I_{yy})`.

web, flange = 10.0 * 100.0, 40.0 * 10.0  # mm²
xx = web * 100**2 / 12 + 2 * flange * (10**2 / 12 + 45**2)
yy = web * 10**2 / 12 + 2 * flange * (40**2 / 12 + 25**2)
xy = 2 * flange * 25 * 45  # minus the product of inertia: the flanges are at (25, −45) and (−25, 45)
larger = 0.5 * np.degrees(np.arctan2(2 * xy, xx - yy))
middle, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
np.testing.assert_allclose(moments[:2], 20e-12 * np.array([middle - radius, middle + radius]), rtol=1e-12)
np.testing.assert_allclose(found, [larger + 90, larger], rtol=1e-12)
signs = np.sign(between)
changes = np.degrees(direction[np.flatnonzero(signs[1:] != signs[:-1])])
np.testing.assert_allclose(changes, [larger, larger + 90], atol=0.25)  # to the spacing of the trials
farthest = np.degrees(np.arctan(radius / np.sqrt(middle**2 - radius**2)))  # (I2 − I1)/2 over √(I1 I2)
assert abs(np.abs(between).max() - farthest) < 0.01

# %%
# **What it is good for**: set spinning about a principal axis, a free body stays at it; about x it does not.


def strays(axis):
    """Return how far ω strays from its direction in the body within 2 s, in degrees."""
    start = inertia.Start(angular_velocity=10.0 * axis, frame="part")
    run = inertia.simulate(inertia.Scene(inertia.SceneBody.of(section), start, inertia.Settings(2.0, 201)))
    cosine = run.angular_velocity @ axis / np.linalg.norm(run.angular_velocity, axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).max()


assert strays(axes[:, 0]) < 1e-5
print("ω strays by less than 1e-5° from axis 1,")
print(f"and by {strays(omega[0]):.1f}° from x")

# %%
# Look at the two zeros: they are 90° apart, and neither is along an edge. In between L leans
# away from ω by up to 57°, with the tangent :math:`(I_2 - I_1)/(2 \sqrt{I_1 I_2})`.
#
# **To try**: flanges on the same side, a C. By symmetry, which axes must it have?

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.axhline(0.0, color="0.6", linewidth=1)
ax.plot(np.degrees(direction), between, color="C2")
for number in (0, 1):
    ax.plot(found[number], 0.0, "o", color=f"C{number}", markersize=9, label=f"principal axis {number + 1}")
ax.set(xlabel="direction of ω / °", ylabel="angle from ω to L / °", xticks=range(0, 181, 30), ylim=(-65, 125))
ax.set_yticks(range(-60, 61, 30))
ax.set_title("L is parallel to ω along principal axes alone")
ax.legend(loc="upper right")
inset = ax.inset_axes((0.06, 0.62, 0.25, 0.37))
inset.fill(*outline.T, color="0.8")
for number in (0, 1):
    inset.plot(*np.outer(axes[:2, number], [-0.06, 0.06]), color=f"C{number}")
inset.set(aspect="equal")
inset.set_axis_off()
plt.show()
