"""
A top let go with its axis at rest
==================================

It falls, which makes it precess, and precessing it is lifted again: its axis leaves cusps. Where it turns follows from
energy and momenta alone, by an effective potential.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

run = inertia.simulate(inertia.Scene.load(path("scenes/heavy_top.toml")))
theta = run.quantities["theta"]

# %%
# Let go at rest, the lower turning angle follows from :math:`\cos\theta = a - \sqrt{a^2 - 2a\cos\theta_0 + 1}` with
# :math:`a = (I_3\omega_3)^2/4 I_1 mgh`, the moments being those about the tip.

I1, I3, mgh = 2e-4 + 0.1 * 0.04**2, 1.25e-4, 0.1 * 9.80665 * 0.04
start, a = np.radians(30), (I3 * 150) ** 2 / (4 * I1 * mgh)
lowest = np.arccos(a - np.sqrt(a**2 - 2 * a * np.cos(start) + 1))
np.testing.assert_allclose(run.quantities["turning theta"], [start, lowest], rtol=1e-9)
print(
    f"it nods between 30° and {np.degrees(lowest):.6f}°; of 2001 samples the largest is {np.degrees(theta.max()):.6f}°"
)

# %%
# A ball in this well would swing from one side to the other. Try a faster spin: the well becomes narrow, and the
# nodding too small to be seen.

fig, ax = plt.subplots(figsize=(6.4, 4))
run.plot("effective potential", ax=ax)
plt.show()
