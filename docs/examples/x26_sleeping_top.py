r"""
How fast must a top spin to sleep?
==================================

Upright, a top stands still as long as :math:`I_3\omega > 2\sqrt{I_1 m g h}`; below that the least tilt grows. The
threshold is no matter of taste: one simulation for each speed shows the edge.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

I1, I3, mgh = 2e-4 + 0.1 * 0.04**2, 1.25e-4, 0.1 * 9.80665 * 0.04
threshold = 2 * np.sqrt(I1 * mgh) / I3


def largest_tilt(spin):
    """Return the largest tilt in degrees within 4 s of a top that starts a twentieth of a degree off."""
    scene = inertia.Scene.load(path("scenes/sleeping_top.toml")).to_dict()
    scene["start"]["angular_velocity"] = [0, 0, spin]
    run = inertia.simulate(inertia.Scene.from_dict(scene))
    return np.degrees(run.quantities["theta"].max())


spins = np.array([0.3, 0.5, 0.7, 0.85, 0.95, 1.05, 1.2, 1.4]) * threshold
tilts = np.array([largest_tilt(spin) for spin in spins])
assert np.all(tilts[spins < threshold] > 10)
assert np.all(tilts[spins > threshold] < 1)

# %%
# Below the edge it falls to where :math:`\cos\theta = (I_3\omega)^2/(2 I_1 mgh) - 1`, the other root of the energy.

fall = np.degrees(np.arccos(np.clip((I3 * spins) ** 2 / (2 * I1 * mgh) - 1, -1, 1)))
np.testing.assert_allclose(tilts[spins < threshold], fall[spins < threshold], atol=0.5)
print(f"it sleeps above {threshold:.2f} rad/s; at half of that it falls to {tilts[1]:.1f}°")

fine = np.linspace(0.25, 1.45, 400) * threshold
curve = np.degrees(np.arccos(np.clip((I3 * fine) ** 2 / (2 * I1 * mgh) - 1, -1, 1)))
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(fine, curve, label="by the energy")
ax.plot(spins, tilts, "o", color="C1", label="simulated, 4 s")
ax.axvline(threshold, linestyle=":", color="0.4", label="threshold")
ax.set(xlabel="spin, rad/s", ylabel="largest tilt, degrees", ylim=(-5, 180), title="Asleep or falling")
ax.legend()
plt.show()
