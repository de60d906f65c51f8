"""
A moment about another axis
===========================

A motor turns a part about a shaft that misses its centre of mass. Steiner's theorem moves the tensor there:
:math:`I = I_C + m d^2`. The mesh is integrated once, whatever the shaft.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

torus = inertia.mass_properties(inertia.read(path("torus.stl"), unit="mm"), material="aluminium")
distances = np.linspace(0, 0.060, 61)
moments = [torus.about([d, 0, 0])[2, 2] for d in distances]
np.testing.assert_allclose(moments, torus.inertia[2, 2] + torus.mass * distances**2, rtol=1e-13)

# %%
# ``steiner`` does the same to a bare tensor, such as one in a data sheet, between any two points.

moved = inertia.steiner(torus.inertia, torus.mass, [0, 0, 0], about=[0, 0, 0], to=[0.020, 0, 0])
np.testing.assert_allclose(moved, torus.about([0.020, 0, 0]), atol=1e-13 * moved[2, 2])
ratio = moved[2, 2] / torus.inertia[2, 2]
print(f"hung on its ring of 20 mm radius, the torus is {ratio:.4f} times as hard to turn")

# %%
# The parabola is lowest at the centre of mass: no parallel axis has a smaller moment. At d = 20 mm the shaft goes
# through the middle of the material, which makes nothing special.

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(1e3 * distances, 1e6 * np.array(moments), label="about the shaft")
ax.fill_between(1e3 * distances, 1e6 * torus.inertia[2, 2], alpha=0.25, label="I about the centre of mass")
ax.fill_between(1e3 * distances, 1e6 * torus.inertia[2, 2], 1e6 * np.array(moments), alpha=0.25, label="m d²")
ax.set(xlabel="distance of the shaft, mm", ylabel="moment about it, 10⁻⁶ kg m²", ylim=0, title="Steiner's theorem")
ax.legend(loc="upper left")
plt.show()
