r"""
Static balance, by one weight
=============================

A wheel with its centre of mass off the axle swings its heavy side down. The unbalance is the vector :math:`\sum m\,
\mathbf r` across the axle, and one weight opposite to it, at a radius one can reach, brings the centre back.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

angles = np.radians([20, 95, 170, 250, 310])
masses = np.array([0.030, 0.021, 0.044, 0.025, 0.038])  # kg, of five bolts on a circle
circle = 0.080 * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
bolts = inertia.point_masses(circle, masses)
unbalance = bolts.mass * bolts.center_of_mass[:2]
np.testing.assert_allclose(unbalance, masses @ circle[:, :2], atol=1e-17)

# %%
# The weight goes on the rim of 95 mm, straight opposite.

rim = 0.095
size = np.hypot(*unbalance)
place = np.append(-rim * unbalance / size, 0.0)
weight = inertia.point_masses([place], [size / rim])
whole = bolts + weight
angle = np.degrees(np.arctan2(place[1], place[0]))
print(f"unbalance {1e6 * size:.2f} g mm, taken away by {1e3 * size / rim:.3f} g at {angle:.2f}°")
np.testing.assert_allclose(whole.center_of_mass, 0, atol=1e-16)

# %%
# Laid end to end, the contributions of the bolts come to the unbalance, and the weight closes the polygon. Try to move
# one bolt: only its side turns.

corners = 1e6 * np.vstack([[0, 0], np.cumsum(masses[:, None] * circle[:, :2], axis=0)])
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(*corners.T, "o-", label="bolts")
ax.annotate("", (0, 0), corners[-1], arrowprops={"arrowstyle": "->", "color": "C1", "linewidth": 2.5})
ax.plot([], [], color="C1", linewidth=2.5, label="weight")
ax.set(aspect="equal", xlabel="Σ m x, g mm", ylabel="Σ m y, g mm", title="The polygon closes")
ax.legend()
plt.show()
