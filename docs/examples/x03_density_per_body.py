"""
Two materials in one part
=========================

A bar of 40 mm is steel on its left half and aluminium on its right. The file, a volume mesh, holds both as regions, and
each gets its material by name. Where is the centre of mass?
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

part = inertia.read(path("two_region_bar.vtk"), unit="mm")
bar = inertia.mass_properties(part, material={"1": "steel", "2": "aluminium"})
alike = inertia.mass_properties(part, material="steel")

# %%
# By hand: two halves of the same volume, with their centres at 10 and 30 mm.

steel, aluminium = 7850, 2700
center = (steel * 0.010 + aluminium * 0.030) / (steel + aluminium)
np.testing.assert_allclose(bar.mass, (steel + aluminium) * 0.02 * 0.01 * 0.01, rtol=1e-14)
np.testing.assert_allclose(bar.center_of_mass[0], center, rtol=1e-14)
print(f"centre of mass at {1e3 * center:.4f} mm; of steel alone at {1e3 * alike.center_of_mass[0]:.4f} mm")

# %%
# The two ellipsoids have the mass and the moments of the bar as it is, and of one that were steel throughout. Try to
# give the second half a density of 0.1 kg/m³: the centre comes to rest at 10 mm, and the ellipsoid becomes that of a
# half.

fig, axes = plt.subplots(2, 1, figsize=(6.4, 4))
for ax, body, title in zip(axes, (bar, alike), ("steel and aluminium", "steel"), strict=True):
    ax.add_patch(plt.Rectangle((0, -5), 20, 10, color="0.55"))
    ax.add_patch(plt.Rectangle((20, -5), 20, 10, color="0.85" if body is bar else "0.55"))
    along, across = 1e3 * body.equivalent_ellipsoid[:2]
    angle = np.linspace(0, 2 * np.pi, 181)
    middle = 1e3 * body.center_of_mass[0]
    ax.plot(middle + along * np.cos(angle), across * np.sin(angle), color="C1")
    ax.plot(middle, 0, "o", color="C0")
    ax.annotate(f"{middle:.2f} mm", (middle, 0), xytext=(0, 7), textcoords="offset points", ha="center", color="C0")
    ax.set(aspect="equal", xlim=(-8, 48), ylim=(-9, 9), ylabel="y, mm", title=title)
axes[1].set_xlabel("x, mm")
fig.tight_layout()
plt.show()
