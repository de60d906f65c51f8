"""
A cat turns over without any spin
=================================

Let go upside down and at rest, a cat has no angular momentum, and gets none. It bends, turns both halves about its bent
spine, and straightens: half a turn of the whole remains. Two cylinders are enough to do it.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

run = inertia.simulate(inertia.Scene.load(path("scenes/cat.toml")))
feet = inertia.quaternion.to_space(run.attitude, [1, 0, 0])  # they point to x in the body
turned = np.degrees(np.arccos(np.clip(feet @ feet[0], -1, 1)))
print(f"after {run.time[-1]} s the feet have turned by {turned[-1]:.6f}°")
assert abs(turned[-1] - 180) < 1e-3
np.testing.assert_allclose(run.angular_momentum, 0, atol=1e-9)

# %%
# Meanwhile it falls as a stone would.

height = run.position[:, 2]
drop = height[0] - height[-1]
print(f"it falls {drop:.4f} m, g t²/2 = {9.80665 * run.time[-1] ** 2 / 2:.4f} m")

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(run.time, turned, label="turn of the feet, degrees")
for column, name in zip(np.degrees(run.quantities["joint values"]).T, ("rear", "bend", "front"), strict=True):
    ax.plot(run.time, column, "--", linewidth=1, label=f"joint: {name}, degrees")
ax.set(xlabel="time, s", ylabel="angle, degrees", yticks=range(-360, 361, 90), title="From upside down to its feet")
ax.legend(loc="upper left", fontsize="small")
plt.show()
