"""
Thousands of small meshes at once
=================================

Grains, fragments, stones: ``many`` takes all meshes in one call, and one that is refused does not stop the others. Here
four thousand tetrahedra with random corners, the volume of which is a determinant.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

random = np.random.default_rng(13)
corners = random.normal(size=(4000, 4, 3))
faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
corners[volume < 0] = corners[volume < 0][:, [0, 2, 1, 3]]  # those that were inside out
corners[0, 3] = corners[0, 2]  # and one that is flat

grains = inertia.many(corners, faces, 2650.0)
ok = grains.answered
print(f"{ok.sum()} answered; the first is not: {grains.refusals[0]}")
assert list(np.flatnonzero(~ok)) == [0]
np.testing.assert_allclose(grains.volume[1:], np.abs(volume[1:]), rtol=1e-9)
np.testing.assert_allclose(grains.center_of_mass[1:], corners[1:].mean(axis=1), atol=1e-9)

# %%
# What shapes are they? Each is a point in the triangle of possible moments: most are long and flat, near its lower left
# edge, and hardly one is as round as a ball.

moments = np.linalg.eigvalsh(grains.inertia[1:])
fig, ax = plt.subplots(figsize=(6.4, 4.2))
shapes = moments[:, :2] / moments[:, 2:]
assert np.all(shapes.sum(axis=1) >= 1 - 1e-9)
bins = ax.hexbin(*shapes.T, gridsize=45, mincnt=1, cmap="viridis", linewidths=0.2)
ax.plot([0, 1, 0.5, 0], [1, 1, 0.5, 1], color="0.5", linewidth=1)
ax.set(xlabel="I₁ / I₃", ylabel="I₂ / I₃", title="Shapes of four thousand tetrahedra")
fig.colorbar(bins, label="how many")
plt.show()
