r"""
How well is a moment known?
===========================

Density and dimensions have tolerances, and so has the answer. A scale that is common to all lengths enters the mass
three times and a moment five times: :math:`(u_m/m)^2 = (u_\rho/\rho)^2 + (3 u_s)^2`, and 5 in place of 3 for a
moment.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

part = inertia.read(path("bent_wheel.stl"), unit="mm")
steel = inertia.Estimate.parse("7850±0.5%")
scales = np.array([0.0, 0.0003, 0.001, 0.002, 0.003])
shares = []
for scale in scales:
    analysis = inertia.analyse(part, steel, scale=inertia.Estimate(1.0, scale))
    body = analysis.properties
    covariance = sum(analysis.uncertainty.components.values())  # of volume, mass, centre (3), tensor (6)
    shares.append(np.sqrt(np.diag(covariance)[[1, 7]]) / [body.mass, body.inertia[2, 2]])
shares = np.array(shares)
for column, power in enumerate((3, 5)):
    np.testing.assert_allclose(shares[:, column], np.hypot(0.005, power * scales), rtol=1e-9)
print(f"with 0.5 % of density and 0.1 % of scale: mass ±{shares[2, 0]:.3%}, moment ±{shares[2, 1]:.3%}")

# %%
# While the scale is known to 0.03 %, the density is what matters; at 0.3 % it no longer is. Try a material instead of a
# density: its uncertainty is zero unless it is stated.

fine = np.linspace(0, 0.0033, 100)
fig, ax = plt.subplots(figsize=(6.4, 4))
for column, (what, power) in enumerate((("mass", 3), ("moment", 5))):
    ax.plot(100 * fine, 100 * np.hypot(0.005, power * fine), label=what, color=f"C{column}")
    ax.plot(100 * scales, 100 * shares[:, column], "o", color=f"C{column}")
ax.axhline(0.5, linestyle=":", color="0.5", label="density alone")
ax.set(xlabel="standard uncertainty of the scale, %", ylabel="of the result, %", ylim=0, title="What the tolerances do")
ax.legend()
plt.show()
