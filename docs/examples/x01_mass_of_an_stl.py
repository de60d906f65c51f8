"""
Mass and inertia of an STL file
===============================

What does a part weigh, where is its centre of mass, and how hard is it to turn? An STL file holds triangles and no
unit, so the unit is stated on reading; the density turns the volume into mass. The integral over the mesh is exact, and
the answer states how large the arithmetic error can be at most.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

part = inertia.read(path("box.stl"), unit="mm")
analysis = inertia.analyse(part, material="steel")
box = analysis.properties

# %%
# The box has edges of 40, 20 and 10 mm, so that its moments are :math:`m (b^2 + c^2)/12` and so on.

a, b, c = 0.040, 0.020, 0.010
mass = 7850 * a * b * c
np.testing.assert_allclose(box.mass, mass, rtol=1e-15)
np.testing.assert_allclose(box.inertia, mass / 12 * np.diag([b**2 + c**2, a**2 + c**2, a**2 + b**2]), atol=1e-20)

print(f"{1000 * box.mass:.1f} g, centre of mass at {1000 * box.center_of_mass} mm")
print(f"principal moments {box.principal.moments} kg m²")

# %%
# The picture shows the part and, in it, the ellipsoid of the same mass and the same moments: long where the mass is far
# out. Try ``material="aluminium"``: the numbers change, the ellipsoid stays.

fig, ax = plt.subplots(figsize=(6.4, 4))
analysis.plot(ax=ax)
plt.show()
