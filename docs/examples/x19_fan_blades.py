"""
In what order do blades go on a hub?
====================================

No two blades of a fan weigh the same. Weighed first, they can be set so that their unbalances all but cancel: here
twelve, by exchanging two at a time as long as that helps.
"""

import itertools

import matplotlib.pyplot as plt
import numpy as np

import inertia

count, radius = 12, 0.15  # m, of the blades' centres of mass
angles = 2 * np.pi * np.arange(count) / count
places = radius * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
masses = 0.200 + 0.004 * np.sin(2.3 * np.arange(1, count + 1) ** 2)  # kg: as they came out of the mould


def unbalance(order):
    """Return m r in kg m of blades in this order."""
    fan = inertia.point_masses(places, masses[order])
    return fan.mass * np.hypot(*fan.center_of_mass[:2])


order = np.arange(count)
first = best = unbalance(order)
better = True
while better:
    better = False
    for i, j in itertools.combinations(range(count), 2):
        trial = order.copy()
        trial[[i, j]] = trial[[j, i]]
        if (value := unbalance(trial)) < best:
            order, best, better = trial, value, True

np.testing.assert_allclose(best, abs(masses[order] @ np.exp(1j * angles)) * radius, atol=1e-15)
print(f"as they came {1e6 * first:.1f} g mm, in the best order found {1e6 * best:.3f} g mm")
assert best < first / 10

# %%
# How much each place is heavier or lighter than the mean: sorted right, what is heavy has its like opposite. `inertia
# balance` does this too, from a table of weighed blades.

fig, axes = plt.subplots(1, 2, figsize=(6.4, 3.6), subplot_kw={"projection": "polar"})
for ax, each, title in zip(axes, (np.arange(count), order), ("as they came", "sorted"), strict=True):
    excess = 1e3 * (masses[each] - masses.mean())
    colours = np.where(excess > 0, "C0", "C2")
    ax.bar(angles, np.abs(excess), width=0.42, color=colours)
    ax.set(xticks=angles, xticklabels=each + 1, yticks=[2, 4], title=f"{title}: {1e6 * unbalance(each):.1f} g mm")
fig.tight_layout()
plt.show()
