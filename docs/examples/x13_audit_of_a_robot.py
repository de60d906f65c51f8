"""
What a robot's file states, against its meshes
==============================================

The tensors in a URDF were typed by someone. ``audit`` integrates the meshes of each link, compares, and where they
differ looks for the mistake that leads from one to the other: a unit, a sign, a point, a forgotten rotation.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

audit = inertia.audit(path("robots/arm.urdf"))
print(f"the robot is {audit.verdict}")
for link in audit.links:
    print(f"{link.name:>12}: {link.state}", *(f"- {each.sentence}" for each in link.findings), sep="\n  ")

# %%
# A link that is consistent has the moments of its mesh, to the digits that the file writes.

states = [link.state for link in audit.links]
assert audit.verdict == "inconsistent"
for link in audit.links:
    if link.state == "consistent":
        np.testing.assert_allclose(link.stated.mass, link.computed.mass, rtol=0.02)
        assert link.difference.inertia < 0.02

# %%
# Bars beyond the line are off by more than the 2 % that are allowed. Try ``tolerance=1e-6``: then the digits that the
# file rounded away count too.

fig, ax = plt.subplots(figsize=(6.4, 4))
audit.plot(ax=ax)
plt.show()
