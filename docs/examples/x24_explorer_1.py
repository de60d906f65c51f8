r"""
Explorer 1 loses energy, and its axis
=====================================

America's first satellite was to spin about its long axis. Its whip antennas lost energy, :math:`\mathbf L` stayed, and
the least energy at that :math:`L` is :math:`L^2/2I_3`: it ended up spinning end over end.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

run = inertia.simulate(inertia.Scene.load(path("scenes/explorer_1.toml")))
moments, start = np.array([0.0476, 4.79, 4.81]), np.array([78.5, 0.8, 0.0])
L = np.linalg.norm(moments * start)
np.testing.assert_allclose(np.linalg.norm(run.angular_momentum, axis=1), L, rtol=1e-7)
least, most = L**2 / (2 * moments[2]), L**2 / (2 * moments[0])
assert np.all(np.diff(run.energy) <= 1e-9 * run.energy[0])
assert least < run.energy[-1] < most
print(f"{run.energy[0]:.1f} J at first, {run.energy[-1]:.3f} J after two minutes; the least is {least:.3f} J")
rpm = np.array([start[0], L / moments[2]]) * 30 / np.pi
print(f"from {rpm[0]:.0f} r/min about its long axis to {rpm[1]:.1f} r/min across it")

# %%
# The angle between the long axis and L goes from 46 degrees to a right angle while the energy falls to a fiftieth.
# The loss is made large here; the real one took some hours.

long_axis = inertia.quaternion.to_space(run.attitude, [1, 0, 0])
along = np.sum(long_axis * run.angular_momentum, axis=1) / L
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.semilogy(run.time, run.energy, label="energy")
ax.axhline(least, linestyle=":", color="C0", label="least energy at this L")
ax.set(xlabel="time, s", ylabel="energy, J")
angle = ax.twinx()
angle.plot(run.time, np.degrees(np.arccos(np.clip(np.abs(along), 0, 1))), color="C2")
angle.set_ylabel("long axis to L, degrees", color="C2")
angle.grid(visible=False)
ax.legend(loc="center right")
plt.show()
