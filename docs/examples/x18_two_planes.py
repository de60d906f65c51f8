"""
Balanced in two planes
======================

A shaft with two discs, each with a hole, is off balance in two planes, and has to be corrected in two. ``balance``
judges the model against its grade, G6.3 at 3000 r/min, drills into the mesh where its file allows that, and integrates
again.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

rotor = inertia.Rotor.load(path("rotors/two_disc_rotor.toml"))
result = inertia.balance(rotor)
print(f"before: {result.initial_verdict.outcome}, after: {result.verdict.outcome}")
for operation in result.correction.operations:
    print(f"  {operation.id}")

# %%
# What grade G6.3 leaves to the whole rotor is :math:`m \cdot 6.3\,\text{mm/s}/\omega`, divided between the bearings.

omega = 3000 * 2 * np.pi / 60
np.testing.assert_allclose(rotor.speed, omega, rtol=1e-12)
np.testing.assert_allclose(result.tolerance.total, result.initial.mass * 6.3e-3 / omega, rtol=1e-12)
limits = result.tolerance.permissible
left = [abs(plane.residual) for plane in result.verdict.planes]
assert all(residue < limit for residue, limit in zip(left, limits, strict=True))
for name, residue, limit in zip("AB", left, limits, strict=True):
    print(f"left over at {name}: {1e6 * residue:.2f} g mm of {1e6 * limit:.1f} that are allowed")

# %%
# The circle is the limit. Both lines leave it before the correction, that of bearing B by far, and end in its middle
# after it. Try ``rotors/pump_rotor.toml``, or your own.

fig, ax = plt.subplots(figsize=(6.4, 4))
result.plot(ax=ax)
plt.show()
