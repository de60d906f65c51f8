"""
A T-handle turns over and over
==============================

Spun about the axis of its intermediate moment, a T-handle turns over with no torque at all (Dzhanibekov's effect). The
times between two flips are all equal: half the period of the polhode, an elliptic integral.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

scene = inertia.Scene.load(path("scenes/t_handle.toml"))
run = inertia.simulate(scene)
moments = inertia.mass_properties(inertia.read(path("t_handle.stl"), unit="mm"), material="steel").principal.moments
spin = [0.001, 10.0, 0.0]  # rad/s along the principal axes
flips = inertia.flip_times(moments, spin, 60.0)

# %%
# By hand: a flip takes :math:`2K(m)/\lambda`, and the arithmetic-geometric mean gives K.

I1, I2, I3 = moments
two_energy, square = moments @ np.square(spin), np.square(moments) @ np.square(spin)
rate2 = (I3 - I2) * (square - two_energy * I1) / (I1 * I2 * I3)  # λ² where L² > 2 T I2, else with 1 and 3 exchanged
other2 = (I2 - I1) * (two_energy * I3 - square) / (I1 * I2 * I3)
a, b = np.sqrt(max(rate2, other2)), np.sqrt(abs(rate2 - other2))
for _ in range(8):
    a, b = (a + b) / 2, np.sqrt(a * b)
np.testing.assert_allclose(np.diff(flips), np.pi / a, rtol=1e-8)
print(f"it turns over every {np.pi / a:.6f} s, {len(flips)} times in a minute")

# %%
# Most of the time it spins as if nothing were the matter. Try a start a hundred times as careful, 1e-5 rad/s: the
# pauses grow by a logarithm only, a few seconds.

omega = run.angular_velocity
early = run.time <= 20
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(run.time[early], omega[early], label=["x", "y", "z"])
for flip in flips[flips <= 20]:
    ax.axvline(flip, linestyle=":", color="0.4")
ax.set(xlabel="time, s", ylabel="ω along the part's axes, rad/s", ylim=(-11, 14), title="Dotted: the flips")
ax.legend(loc="upper right", ncols=3)
plt.show()
