"""
Who weighs what in an assembly
==============================

A small satellite as a list of parts: shapes, weighed masses and allowances in one TOML file. Its budget adds them up,
with the uncertainty of each, and holds the sum against the limits that the file states.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

assembly = inertia.Assembly.load(path("assemblies/cubesat.toml"))
budget = assembly.budget()
print(f"{budget.total.basic_mass:.4f} kg, with {1e3 * budget.total.sigma.mass:.1f} g of standard uncertainty")
for limit in budget.limits:
    print(f"  {limit.what}: {limit.value:.6g}, allowed {limit.low} to {limit.high}")

# %%
# The whole is the sum of its lines, and each coordinate of the centre their mean by mass.

lines = budget.total.children
np.testing.assert_allclose(sum(line.basic_mass for line in lines), budget.total.basic_mass, rtol=1e-12)
centers = [line.basic_mass * np.asarray(line.center_of_mass) for line in lines]
np.testing.assert_allclose(sum(centers) / budget.total.basic_mass, assembly.mass_properties().center_of_mass, atol=1e-6)

# %%
# The picture has each line with its allowance: where a gram is to be saved, one looks at the longest bar first.

fig, ax = plt.subplots(figsize=(6.4, 4))
budget.plot(ax=ax)
plt.show()
