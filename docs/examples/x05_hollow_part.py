"""
A hollow part
=============

A cavity is a surface that faces inwards, and counts with the opposite sign: nothing has to be said about it. The sample
is a ball of 20 mm radius with a cavity of 16 mm. For the same mass, a hollow ball is harder to turn than a solid one.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

hollow = inertia.mass_properties(inertia.read(path("hollow_sphere.stl"), unit="mm"), material="steel")
solid = inertia.mass_properties(inertia.read(path("sphere.stl"), unit="mm"), material="steel")
factors = [body.principal.moments.mean() / (body.mass * 0.020**2) for body in (solid, hollow)]


def factor(share):
    """Return I/(M R²) of a ball with a cavity of `share` of its radius."""
    return 0.4 * (1 - share**5) / (1 - share**3)


print(f"I/(M R²) = {factors[0]:.4f} solid, {factors[1]:.4f} hollow; of true balls 0.4000 and {factor(0.8):.4f}")
assert abs(factors[0] - 0.4) < 0.005
assert abs(factors[1] - factor(0.8)) < 0.005

# %%
# From 2/5 it rises towards 2/3, the factor of a thin shell. The dots are the two meshes: they lie a little low, as flat
# triangles cut the ball's surface short.

share = np.linspace(0, 0.999, 200)
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(share, factor(share))
ax.plot([0, 0.8], factors, "o", color="C1")
ax.axhline(2 / 3, linestyle=":", color="0.5")
ax.set(xlabel="radius of the cavity over that of the ball", ylabel="I / (M R²)", title="A hollow ball")
plt.show()
