r"""
13.9 Plane laminae
==================

For any body :math:`I_x + I_y = I_z + 2 \int z^2\,dm`, so that no principal moment is above the sum of the other two:
the *triangle rule*. What is flat, with z = 0 everywhere, has equality, :math:`I_x + I_y = I_z` (eq. 13.45), whatever
its outline. A needle is at the other end of the rule: one moment near zero, and two equal. In a map of the ratios of
moments all bodies lie in one triangle.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# **Any outline.** A star, a thin triangle and a polygon of 120 corners, a disc for nearly all purposes: the two moments
# in the plane add up to the third.


def ring(radii):
    """Return corners (n, 2) at these radii, evenly spaced in angle."""
    angle = 2 * np.pi * np.arange(len(radii)) / len(radii)
    return np.stack([radii * np.cos(angle), radii * np.sin(angle)], axis=1)


outlines = {
    "star": ring(np.tile([1.0, 0.4], 5)),
    "triangle": [[0, 0], [3, 0], [1, 0.8]],
    "disc": ring(np.ones(120)),
}
shown = {}
for name, outline in outlines.items():
    i1, i2, i3 = inertia.lamina(outline, 2.0).principal_moments
    assert abs(i1 + i2 - i3) < 1e-14 * i3
    shown[name] = (i1 / i3, i2 / i3)
    print(f"{name:8} I1 + I2 = I3 = {i3:.4f} kg m²")

# %%
# **Thickness.** A solid plate of 2 by 1 m has :math:`I_1 + I_2 - I_3 = \tfrac{1}{6} M t^2`: a sheet of a hundredth of
# its width is flat to a part in ten thousand. A solid is a mesh, here of eight corners and twelve triangles.

triangles = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]]
triangles += [[2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]


def box(a, b, c):
    """Return the mass properties of a box of 1 kg."""
    corners = [[x, y, z] for z in (0, c) for y in (0, b) for x in (0, a)]
    return inertia.mass_properties(inertia.Part.from_arrays(corners, triangles), mass=1.0)


thicknesses = np.geomspace(0.001, 1.0, 31)
plates = np.array([box(2.0, 1.0, t).principal_moments for t in thicknesses])
np.testing.assert_allclose(plates[:, 0] + plates[:, 1] - plates[:, 2], thicknesses**2 / 6, atol=1e-14)
np.testing.assert_allclose(plates[:, 2], (2**2 + 1**2) / 12, rtol=1e-13)

# %%
# **The other end**: a needle of 1 m by 1 mm. And what cannot be: nobody can build a body with moments 1, 1 and 2.1, and
# the library refuses the tensor.

needle = box(0.001, 0.001, 1.0).principal_moments
np.testing.assert_allclose(needle, np.array([2e-6, 1 + 1e-6, 1 + 1e-6]) / 12, rtol=1e-12)
shown |= {"needle": (needle[0] / needle[2], 1.0), "cube": (1.0, 1.0)}
try:
    inertia.MassProperties(1.0, 1.0, [0, 0, 0], np.diag([1.0, 1.0, 2.1]))
except inertia.GeometryError as refusal:
    print(refusal)

# %%
# Look at the lower edge: all laminae lie on it, and the plate comes down to it as it gets thinner. The star and
# the disc share the corner: five-fold symmetry leaves no direction. Prolate bodies lie on the upper edge, oblate ones
# on the right one.
#
# **To try**: a wire, straight and then bent to a plane curve. Where do they lie?

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.fill([0, 0.5, 1], [1, 0.5, 1], color="0.92", label="solids")
ax.plot([0, 0.5], [1, 0.5], color="C0", label="I1 + I2 = I3: flat")
ax.plot(plates[:, 0] / plates[:, 2], plates[:, 1] / plates[:, 2], color="C2", label="2 × 1 m plate")
for name, (x, y) in shown.items():
    ax.plot(x, y, "ko", markersize=5)
    right = name in ("disc", "star")
    place = {"disc": (8, -12), "star": (8, 2)}.get(name, (-8, -12))
    ax.annotate(name, (x, y), place, textcoords="offset points", ha="left" if right else "right")
ax.set(xlabel="I1 / I3", ylabel="I2 / I3", xlim=(-0.2, 1.05), ylim=(0.4, 1.05), title="Where bodies can be")
ax.legend(loc="lower left")
plt.show()
