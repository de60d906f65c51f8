"""
A coin rolls on its rim
=======================

Leaning a little, a coin runs along a curve and wobbles, but does not fall, as long as it is fast enough:
:math:`v^2 > gR/3` for a thin disc. Here it starts 80° from lying flat.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

run = inertia.simulate(inertia.Scene.load(path("scenes/rolling_disc.toml")))
radius, mass = 0.025, 0.01
coin = inertia.RollingBody(mass, mass * radius**2 / 4, mass * radius**2 / 2, radius)
least = inertia.straight_rolling_threshold(coin) * radius
np.testing.assert_allclose(least, np.sqrt(9.80665 * radius / 3), rtol=1e-12)
print(f"straight on it is stable from {least:.3f} m/s on; here it rolls at {40 * radius:.3f} m/s")

# %%
# The rim touches the table wherever it goes: contact and centre are a radius apart, always.

contact = run.quantities["contact"]
np.testing.assert_allclose(np.linalg.norm(contact - run.position, axis=1), radius, rtol=1e-9)
np.testing.assert_allclose(run.energy, run.energy[0], rtol=1e-9)

# %%
# The path from above, dark where the coin stands up. Try a spin of 20 rad/s: barely enough, and large wobbles.

fig, ax = plt.subplots(figsize=(6.4, 4.4))
lean = 90 - np.degrees(run.quantities["theta"])
points = ax.scatter(1e3 * contact[:, 0], 1e3 * contact[:, 1], c=np.abs(lean), s=4, cmap="viridis")
ax.plot(*(1e3 * contact[0, :2]), "o", color="C0", label="start")
ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title="Where the rim touches the table")
fig.colorbar(points, label="lean from upright, degrees")
ax.legend()
plt.show()
