"""
A recording to play back
========================

A run can be written for Rerun's viewer: a file that plays the motion, with its scene in it, so that the run can be made
again. A box is thrown across the room: its centre goes along a parabola while it tumbles.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

run = inertia.simulate(inertia.Scene.load(path("scenes/thrown_box.toml")))
with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "box.rrd"
    inertia.record(run, file)
    print(f"{file.name}: {file.stat().st_size > 0 and 'written'}; open it by `inertia play {file.name}`")

# %%
# The centre falls by :math:`g t^2/2` below the straight line that it began on.

t = run.time
mean = (run.position[-1] - run.position[0]) / t[-1]
below = run.position[:, 2] - run.position[0, 2] - mean[2] * t
np.testing.assert_allclose(below, 9.80665 * t * (t[-1] - t) / 2, atol=1e-9)

# %%
# In the picture a longitudinal axis of the box is drawn at equal intervals of time.

fig, ax = plt.subplots(figsize=(6.4, 4))
flat = np.argmax(np.abs(mean[:2]))
ax.plot(run.position[:, flat], run.position[:, 2], label="centre of mass")
axis = 0.15 * inertia.quaternion.to_space(run.attitude, [1, 0, 0])
for k in range(0, len(t), max(1, len(t) // 24)):
    ends = run.position[k] + np.outer([-1, 1], axis[k])
    ax.plot(ends[:, flat], ends[:, 2], color="C2", linewidth=2, alpha=0.7)
ax.set(aspect="equal", xlabel="xyz"[flat] + ", m", ylabel="height, m", title="A box on its way")
ax.legend()
plt.show()
