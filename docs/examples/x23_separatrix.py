r"""
The curves that part the ways of tumbling
=========================================

The tip of :math:`\mathbf L` moves in the body on a sphere, along curves of equal energy. They circle axis 1 or axis 3;
between them runs the separatrix, two circles through the ends of axis 2, where :math:`2 T I_2 = L^2`.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments, L = np.array([1.0, 2.0, 3.0]), 1.0
edge = inertia.separatrix(moments, L)  # ω, (2, n, 3)
momentum = edge * moments
np.testing.assert_allclose(np.linalg.norm(momentum, axis=-1), L, rtol=1e-13)
np.testing.assert_allclose(np.sum(momentum**2 / moments, axis=-1), L**2 / moments[1], rtol=1e-13)
print("on the separatrix 2 T I2 = L², as it has to be")

# %%
# Seen along axis 2. Near it curves lead away, and far over to its other end: no stable spin there. Try moments 1, 1.2,
# 3: the curves about axis 1 become slim, and a spin about it is touchy too.

fig, ax = plt.subplots(figsize=(6.4, 4.8))
for turn in np.radians(np.arange(6, 90, 12)):
    for start, colour in (([np.cos(turn), np.sin(turn), 0], "C0"), ([0, np.sin(turn), np.cos(turn)], "C2")):
        curve = inertia.polhode(moments, L * np.array(start) / moments)
        for branch in curve.branches * moments:
            front = np.where(branch[:, 1:2] > -1e-9, branch, np.nan)
            ax.plot(front[:, 0], front[:, 2], color=colour, linewidth=1)
for circle in momentum:
    front = np.where(circle[:, 1:2] > -1e-9, circle, np.nan)
    ax.plot(front[:, 0], front[:, 2], color="C1", linewidth=2.5)
ax.add_patch(plt.Circle((0, 0), L, fill=False, color="0.5"))
for place, name, colour in (((1.08, 0), "1", "C0"), ((0, 1.08), "3", "C2"), ((0.05, 0.1), "2", "k")):
    ax.annotate(name, place, color=colour, ha="center", va="center", fontsize=12)
ax.set(aspect="equal", title="The sphere of L, from the end of axis 2")
ax.set_axis_off()
plt.show()
