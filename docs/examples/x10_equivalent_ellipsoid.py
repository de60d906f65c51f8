r"""
Parts, and the ellipsoids that turn like them
=============================================

To everything that turns it, a part is the uniform ellipsoid of the same mass and moments, of semi-axes
:math:`a_1^2 = \tfrac{5}{2m}(I_2 + I_3 - I_1)` and so on. Seeing it says at a glance whether a tensor is plausible.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

names = ["t_handle", "torus", "cone", "bent_wheel", "spinning_top", "tetrahedron"]
fig, axes = plt.subplots(2, 3, figsize=(6.4, 4.4))
for ax, name in zip(axes.flat, names, strict=True):
    analysis = inertia.analyse(inertia.read(path(f"{name}.stl"), unit="mm"), material="steel")
    body, moments = analysis.properties, analysis.principal.moments
    semi_axes = np.sqrt(5 / (2 * body.mass) * (moments.sum() - 2 * moments))
    np.testing.assert_allclose(body.equivalent_ellipsoid, semi_axes, rtol=1e-12)
    print(f"{name:>12}: {analysis.principal.kind:>10}, semi-axes {(1e3 * semi_axes).round(2)} mm")
    analysis.plot(ax=ax)
    ax.set_title(name.replace("_", " "), fontsize=10)

# %%
# Of the tetrahedron, four corners and nothing symmetric about it, the ellipsoid keeps the six numbers that matter. Try
# ``sphere.stl``: a ball and its ellipsoid are one.

fig.tight_layout()
plt.show()
