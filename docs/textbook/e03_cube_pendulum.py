r"""
Exercise 3: a cube on a wire
============================

Three equal cubes hang on three equal wires: one by a corner, one by the middle of an edge, one by the middle of a
face. Twisted and let go, what are the ratios of their periods?

A cube has three equal principal moments, :math:`\tfrac16 M l^2`, by its symmetry. Then
:math:`\hat n\cdot\mathbf{I}\cdot \hat n` is the same about *every* axis through the centre (section 13.10: it is a
spherical top), and a wire of torsional stiffness :math:`\kappa` gives each cube the one period

.. math:: T = 2\pi \sqrt{\frac{M l^2}{6 \kappa}}, \qquad 1 : 1 : 1 .
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

edge, density, stiffness = 0.1, 2700.0, 0.02

# %%
# A box from its eight corners, and a pendulum: a body on an axle along the wire, with a torsion spring.


def box(a, b, c):
    """Return the mass properties of a box of edges a, b, c about the origin."""
    corners = np.array([[x, y, z] for x in (-a, a) for y in (-b, b) for z in (-c, c)]) / 2
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return inertia.mass_properties(inertia.Part.from_arrays(corners, faces), density)


def swing(body, wire):
    """Return the run of a body that hangs by a wire along an axis and is set off at 0.5 rad/s."""
    wire = np.array(wire) / np.linalg.norm(wire)
    spring = inertia.Constraint("hinge", axis=wire, stiffness=stiffness)
    start, settings = inertia.Start(0.5 * wire, frame="part"), inertia.Settings(5.0, samples=501)
    return inertia.simulate(inertia.Scene(inertia.SceneBody.of(body), start, settings, spring))


# %%
# The three ways of hanging, by the direction in the cube from the hook to the centre.
places = {"corner": [1, 1, 1], "middle of an edge": [1, 1, 0], "middle of a face": [1, 0, 0]}
cube = box(edge, edge, edge)
closed_form = 2 * np.pi * np.sqrt(density * edge**5 / (6 * stiffness))
runs = {place: swing(cube, wire) for place, wire in places.items()}
for place, run in runs.items():
    period = float(run.quantities["period"])
    assert abs(period - closed_form) < 1e-14 * closed_form
    print(f"by the {place}: T = {period:.9f} s, between {np.degrees(run.quantities['turning angle']).round(3)}°")
print(f"closed form: {closed_form:.9f} s; the cube is {cube.principal.kind}")

# %%
# **To look at**: three curves of the cubes, one over the other; and below what becomes of them for a box of the same
# mass that is no spherical top.
#
# **To try**: find a box that is not a cube and has two of the three periods equal.
edges = np.array([0.6, 1.6, 1 / 0.96]) * edge
fig, axs = plt.subplots(2, sharex=True, figsize=(6.4, 4.6))
for k, (place, wire) in enumerate(places.items()):
    style = {"color": f"C{k}", "linestyle": ("-", "--", ":")[k], "linewidth": (5, 3, 2)[k], "label": f"by the {place}"}
    axs[0].plot(runs[place].time, np.degrees(runs[place].quantities["angle"]), **style)
    run = swing(box(*edges), edges * wire)
    axs[1].plot(run.time, np.degrees(run.quantities["angle"]), **style | {"linewidth": 2})
axs[0].set(title="cube", ylabel="twist / °", ylim=(-32, 17))
axs[1].set(title="box of the same mass, 0.6 : 1.6 : 1.04", ylabel="twist / °", xlabel="time / s", ylim=(-22, 22))
axs[0].legend(ncols=3, fontsize="small", loc="lower left")
plt.show()
