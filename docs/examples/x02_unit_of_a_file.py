"""
The unit of a file
==================

An STL file holds numbers without a unit, and a wrong guess is no small mistake: a length that is :math:`k` times as
long makes the mass :math:`k^3` times and the moments :math:`k^5` times as large. Millimetres are assumed where nothing
is said, and the report says that they are assumed.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

units = {"mm": 1.0, "cm": 10.0, "in": 25.4, "m": 1000.0}  # mm
parts = [inertia.read(path("t_handle.stl"), unit=unit) for unit in units]
bodies = [inertia.mass_properties(part, 7850) for part in parts]
first = bodies[0]
for (unit, k), body in zip(units.items(), bodies, strict=True):
    np.testing.assert_allclose(body.mass, first.mass * k**3, rtol=1e-14)
    np.testing.assert_allclose(body.principal.moments, first.principal.moments * k**5, rtol=1e-13)
    print(f"read in {unit:>2}: {body.mass:12.6g} kg, largest moment {body.principal.moments[2]:.6g} kg m²")

# %%
# On logarithmic scales both are straight lines, of slopes 3 and 5. The dots are the same file read in four units.

k = np.geomspace(0.7, 1500, 50)
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.loglog(k, first.mass * k**3, label="mass, kg")
ax.loglog(k, first.principal.moments[2] * k**5, label="largest moment, kg m²")
for (unit, length), body in zip(units.items(), bodies, strict=True):
    ax.plot(length, body.mass, "o", color="C0")
    ax.plot(length, body.principal.moments[2], "s", color="C1")
    ax.annotate(unit, (length, body.mass), xytext=(-4, 8), textcoords="offset points", ha="right")
ax.set(xlabel="what one unit of the file is taken for, mm", ylabel="kg, or kg m²", title="One file, four units")
ax.legend()
plt.show()
