"""
An open mesh, refused and repaired
==================================

A surface with a hole encloses no volume, and a number for it would depend on where the origin is. So the part is
refused with a sentence that says where the hole is; the repair fills it, and states by how much the answer moved.
"""

import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import inertia
from inertia_meshes import path

part = inertia.read(path("broken/missing_face.stl"), unit="mm")
try:
    inertia.mass_properties(part)
except inertia.GeometryError as error:
    print(str(error).rpartition("/")[2])

# %%
# It is the cube of 10 mm without one of its twelve triangles, so that what the repair has to come to is known.

mended = inertia.repair(part)
for change in mended.changes:
    print(change)
cube = inertia.mass_properties(mended.part, 1000)
np.testing.assert_allclose(cube.volume, 0.010**3, rtol=1e-14)
np.testing.assert_allclose(cube.inertia, 0.001 * 0.01**2 / 6 * np.eye(3), atol=1e-21)

# %%
# Seen from the side of the hole: through it one looks into the cube. A hole that a scanner left is rarely flat: look at
# ``mended.volume_between``, which bounds the volume that the new triangles may have added.

fig, axes = plt.subplots(1, 2, figsize=(6.4, 4), subplot_kw={"projection": "3d"})
for ax, each, title in zip(axes, (part, mended.part), ("11 triangles", "repaired"), strict=True):
    corners = each.triangles.corners()
    ax.add_collection3d(Poly3DCollection(corners, facecolors="C2", edgecolors="white", alpha=0.85, shade=True))
    ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title=title)
    ax.set(xlim=(-6, 6), ylim=(-6, 6), zlim=(-6, 6))
    ax.view_init(elev=25, azim=-150)
plt.show()
