"""
Principal axes, and their angles
================================

In axes that are askew a tensor has products of inertia. The principal axes are those without any, and where they point
can be given as a matrix, a quaternion or Euler angles. Here a box is turned by known angles, which have to come back.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

box = inertia.mass_properties(inertia.read(path("box.stl"), unit="mm"), material="steel")
angles = np.radians([30, 50, 20])  # φ, θ, ψ about z, x', z''
turn = inertia.quaternion.matrix(inertia.euler_angles.from_angles(angles))
askew = turn @ box.inertia @ turn.T

principal = inertia.principal(askew)
np.testing.assert_allclose(principal.moments, box.principal.moments, rtol=1e-13)
alignment = np.abs(principal.axes.T @ turn)  # 1 where an axis is the other's, whichever way it points
np.testing.assert_allclose(alignment, np.eye(3), atol=1e-7)
straight = inertia.reexpress(askew, principal.axes)
np.testing.assert_allclose(straight, np.diag(principal.moments), atol=1e-20)

back = inertia.quaternion.from_matrix(turn)
print("φ, θ, ψ =", np.degrees(inertia.euler_angles.to_angles(back)).round(9), "degrees")
print("moments", principal.moments, "kg m²")

# %%
# The same tensor twice: askew every entry counts, along the principal axes only the diagonal does. Try angles of zero
# and one of 90 degrees: no products appear, the moments merely change places.

fig, axes = plt.subplots(1, 2, figsize=(6.4, 4))
limit = 1e6 * principal.moments[2]
for ax, tensor, title in zip(axes, (askew, straight), ("part axes", "principal axes"), strict=True):
    image = ax.imshow(1e6 * tensor, cmap="PuOr", vmin=-limit, vmax=limit)
    for row, column in np.ndindex(3, 3):
        value = 1e6 * tensor[row, column]
        ax.text(
            column,
            row,
            f"{value + 0.0:.3f}".replace("-0.000", "0.000"),
            ha="center",
            va="center",
            color="w" if value > 0.6 * limit else "k",
        )
    ax.set(xticks=range(3), yticks=range(3), xticklabels="xyz" if ax is axes[0] else "123", title=title)
    ax.set_yticklabels("xyz" if ax is axes[0] else "123")
    ax.grid(visible=False)
fig.colorbar(image, ax=axes, shrink=0.6, label="10⁻⁶ kg m²")
plt.show()
