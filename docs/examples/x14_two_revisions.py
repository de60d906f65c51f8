"""
Two revisions of a part
=======================

A tube loses two millimetres of its wall. By how much does it become lighter, and by how much easier to turn? The
question is about a difference, so that both are compared relative to the first.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia


def tube(inner):
    """Return the mass properties of a steel tube of 100 mm, 140 mm long, by its inner radius."""
    shape = {"name": "tube", "shape": "tube", "size": [50, inner, 140], "material": "steel"}
    return inertia.Assembly.from_dict({"name": "revision", "unit": "mm", "part": [shape]}).mass_properties()


old, new = tube(42), tube(44)


def by_hand(inner, outer=0.050, length=0.140):
    """Return mass, moment across and moment along, from the formulas of a cylinder less a cylinder."""
    mass = [7850 * np.pi * r**2 * length for r in (outer, inner)]
    along = [m * r**2 / 2 for m, r in zip(mass, (outer, inner), strict=True)]
    across = [m * (r**2 / 4 + length**2 / 12) for m, r in zip(mass, (outer, inner), strict=True)]
    return np.array([mass[0] - mass[1], along[0] - along[1], across[0] - across[1]])


for body, inner in ((old, 0.042), (new, 0.044)):
    moments = body.principal.moments
    np.testing.assert_allclose([body.mass, moments[0], moments[2]], by_hand(inner), rtol=1e-12)

# %%
# The wall that is gone was the inner one, near the axis: the moment about the tube's axis falls by less than the mass.

change = 100 * (by_hand(0.044) / by_hand(0.042) - 1)
for what, percent in zip(("mass", "moment along the axis", "moment across it"), change, strict=True):
    print(f"{what}: {percent:+.2f} %")
assert change[0] < change[1] < 0

fig, ax = plt.subplots(figsize=(6.4, 3.4))
bars = ax.barh(["mass", "moment along\nthe axis", "moment\nacross it"], change, color=["C0", "C1", "C2"])
ax.bar_label(bars, fmt="%.1f %%", padding=4)
ax.set(xlabel="change from revision A to B, %", xlim=(-32, 0), title="Wall of 8 mm down to 6 mm")
ax.invert_yaxis()
plt.show()
