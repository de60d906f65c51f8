r"""
Is a stated tensor possible?
============================

No body has moments of which one exceeds the sum of the other two: :math:`I_1 + I_2 \ge I_3`, with equality for flat
plates alone. Tensors typed into robots' and satellites' files break this rule more often than one would think.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

stated = np.array([1.0, 2.0, 3.5])  # kg m², from a data sheet
try:
    inertia.free_motion(stated, [0, 1, 0], [0.0, 1.0])
except inertia.GeometryError as error:
    print(error)
else:
    raise AssertionError("such a body does not exist")

# %%
# Divided by the largest, two moments are left, and every body is a point of a triangle: a ball at its top corner, rods
# at its left one, flat plates on its lower edge.

names = ["sphere", "needle", "disc", "thin_plate", "t_handle", "cone", "tetrahedron", "torus"]
fig, ax = plt.subplots(figsize=(6.4, 4.4))
ax.fill([0, 1, 0.5], [1, 1, 0.5], alpha=0.15, color="C2", label="possible")
for name in names:
    moments = inertia.mass_properties(inertia.read(path(f"{name}.stl"), unit="mm")).principal.moments
    assert moments[0] + moments[1] >= moments[2] * (1 - 1e-12)
    x, y = moments[:2] / moments[2]
    ax.plot(x, y, "o", color="C2")
    left = x > 0.9 or name == "disc"
    ax.annotate(
        name.replace("_", " "),
        (x, y),
        xytext=(-6 if left else 6, -12),
        textcoords="offset points",
        ha="right" if left else "left",
        fontsize=8,
    )
x, y = stated[:2] / stated[2]
ax.plot(x, y, "x", color="C0", markersize=10, markeredgewidth=3, label="as stated")
ax.plot([0, 0.5], [1, 0.5], color="0.5", linestyle=":")
ax.set(
    xlabel="I₁ / I₃", ylabel="I₂ / I₃", xlim=(-0.06, 1.06), ylim=(0.42, 1.08), title="Every body is in this triangle"
)
ax.legend(loc="lower right")
plt.show()
