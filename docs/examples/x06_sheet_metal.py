"""
A bracket of sheet metal
========================

CAD models thin parts as surfaces without a thickness. Such a surface may be open: with ``shell=`` it carries the mass
itself. The bracket is an angle of two rectangles, 60 × 40 mm and 60 × 30 mm, of sheet 1.5 mm thick.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

corners = [[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0], [0, 0, 30], [60, 0, 30]]
faces = [[0, 1, 2], [0, 2, 3], [0, 4, 5], [0, 5, 1]]
part = inertia.Part.from_arrays(corners, faces, unit="mm")
analysis = inertia.analyse(part, material="steel", shell=1.5)
bracket = analysis.properties

# %%
# Two flat plates by hand: each has :math:`m a^2/12` about its own middle, and is moved by Steiner's theorem.

a, b, h, areal = 0.060, 0.040, 0.030, 7850 * 0.0015
flat, upright = areal * a * b, areal * a * h
center = np.array([a / 2, flat * b / 2 / (flat + upright), upright * h / 2 / (flat + upright)])
np.testing.assert_allclose(bracket.mass, flat + upright, rtol=1e-14)
np.testing.assert_allclose(bracket.center_of_mass, center, rtol=1e-13)
about_x = flat * b**2 / 3 + upright * h**2 / 3 - (flat + upright) * (center[1] ** 2 + center[2] ** 2)
np.testing.assert_allclose(bracket.inertia[0, 0], about_x, rtol=1e-13)
print(f"{1e3 * bracket.mass:.2f} g, {1e6 * about_x:.4f} g m·mm about its long edge's direction")

# %%
# The centre of mass is in the air between the two plates, and the ellipsoid about it leans. Try ``shell=3``: twice the
# mass and twice the moments, as a surface has no thickness of its own that could matter.

fig, ax = plt.subplots(figsize=(6.4, 4))
analysis.plot(ax=ax)
plt.show()
