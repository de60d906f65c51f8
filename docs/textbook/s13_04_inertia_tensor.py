r"""
13.4 The inertia tensor of points, wires, plates and solids
===========================================================

:math:`I_{ij} = \sum m\,(r^2 \delta_{ij} - x_i x_j)` (eq. 13.12), or the same as an integral of
:math:`\rho\,(r^2 \delta_{ij} - x_i x_j)` over what has mass: corners, edges, faces or a whole volume. On the diagonal
stand moments, :math:`I_{xx} = \sum m\,(y^2 + z^2)`; off it *negative* products, :math:`I_{xy} = -\sum m\,x y`. Here a
cube of 1 m and 1 kg is made four times: of 8 particles, of 12 wires, of 6 plates, and solid.
"""

from itertools import product

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# Corners are the product of 0 and 1 with itself; an edge joins two that differ in one coordinate, and a face four that
# share one. Bodies add up, ``+``, and ``with_mass`` gives each cube its kilogram.

corners = np.array(list(product([0.0, 1.0], repeat=3)))
edges = [(p, q) for p in corners for q in corners if (q - p).sum() == 1.0 and (q >= p).all()]
square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
faces = [np.insert(square, axis, side, axis=1) for axis in range(3) for side in (0.0, 1.0)]
# The faces of the solid, in order as seen from outside.
quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
solid = inertia.Part.from_arrays(corners, [[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])

cubes = {
    "8 particles": inertia.point_masses(corners, np.full(8, 1 / 8)),
    "12 wires": sum((inertia.wire(edge, 1.0) for edge in edges[1:]), inertia.wire(edges[0], 1.0)).with_mass(1.0),
    "6 plates": sum((inertia.lamina(f, 1.0) for f in faces[1:]), inertia.lamina(faces[0], 1.0)).with_mass(1.0),
    "solid": inertia.mass_properties(solid, 1.0),
}

# %%
# **By hand.** Seen from the middle each coordinate is either :math:`\pm\tfrac{1}{2}`, with the mean square
# :math:`\tfrac{1}{4}`, or spread evenly between, with :math:`\tfrac{1}{12}`. Where what has mass has d dimensions, d of
# 3 coordinates are spread on the average: :math:`\langle x^2 \rangle = \tfrac{1}{4} - \tfrac{d}{18}`, and
# :math:`I = 2\langle x^2 \rangle = \tfrac{9 - 2d}{18}`. All four are spherical tops: any axis will do.

for d, (name, cube) in enumerate(cubes.items()):
    np.testing.assert_allclose(cube.inertia, (9 - 2 * d) / 18 * np.eye(3), atol=1e-14)
    print(f"{name:12} I = {9 - 2 * d}/18 kg m², {cube.principal.kind}")

# %%
# **About a corner** the products appear, and are the same for all four: what is even about the middle has none of its
# own, and the centre of mass, at :math:`(\tfrac{1}{2}, \tfrac{1}{2}, \tfrac{1}{2})`, adds :math:`-\tfrac{1}{4}` each.

for d, cube in enumerate(cubes.values()):
    np.testing.assert_allclose(cube.about([0, 0, 0]), ((9 - 2 * d) / 18 + 3 / 4) * np.eye(3) - 1 / 4, atol=1e-14)
print("solid, about a corner:")
print(cubes["solid"].about([0, 0, 0]).round(4))

# %%
# Look at where the mass is: the nearer to the middle, the smaller the moment, by :math:`\tfrac{1}{9}` a step.
#
# **To try**: a sphere in place of the cube, of particles, hoops, shell and solid; or corners of unequal masses.

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot([0, 3], [9 / 18, 3 / 18], "--", color="0.6")
oblique = np.array([[1.0, 0.0], [0.42, 0.3], [0.0, 1.0]]) @ np.diag([0.34, 0.075])  # cabinet projection, in axes' units
for d, (name, cube) in enumerate(cubes.items()):
    moment = cube.principal_moments[0]
    ax.plot(d, moment, "o", color=f"C{d}", markersize=9)
    ax.annotate(name, (d, moment), (10, 8), textcoords="offset points")
    there = [d - 0.4, moment - 0.13]
    for face in faces if d > 1 else []:
        ax.fill(*(face @ oblique + there).T, color=f"C{d}", alpha=0.12 if d == 2 else 0.35, linewidth=0)
    for edge in edges if d else []:
        ax.plot(*(np.array(edge) @ oblique + there).T, color=f"C{d}", linewidth=2 if d == 1 else 0.7)
    ax.plot(*(corners @ oblique + there).T, "o", color=f"C{d}", markersize=5 if d == 0 else 0)
ax.set(xlabel="dimensions of what has mass", ylabel="I about the centre / kg m²", xticks=range(4))
ax.set(xlim=(-0.5, 3.6), ylim=(0.03, 0.56), title="One cube, four ways to make it")
plt.show()
