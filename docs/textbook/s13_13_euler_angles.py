r"""
13.13 Euler angles
==================

Three turns bring the space axes onto those of any body: by :math:`\phi` about z, which carries x to the *line of
nodes* n; by :math:`\theta` about n, which carries z to the body's axis 3; by :math:`\psi` about axis 3, which carries n
to axis 1. Their product :math:`\lambda = \lambda_\psi \lambda_\theta \lambda_\phi` (eq. 13.81) takes components along
space axes to components along body axes; its rows are the body axes in space, and its inverse is its transpose.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# **By hand**: the three matrices as the chapter has them, each turning the axes, and their product at 30°, 50°, 70°.

angles = np.radians([30.0, 50.0, 70.0])
(cf, ct, cp), (sf, st, sp) = np.cos(angles), np.sin(angles)
turn_phi = np.array([[cf, sf, 0], [-sf, cf, 0], [0, 0, 1]])
turn_theta = np.array([[1, 0, 0], [0, ct, st], [0, -st, ct]])
turn_psi = np.array([[cp, sp, 0], [-sp, cp, 0], [0, 0, 1]])
product = turn_psi @ turn_theta @ turn_phi

# %%
# **By the library**: ``direction_cosines`` is that matrix. A run keeps its attitude as a quaternion, which has no
# singular place; ``to_angles`` and ``from_angles`` go between the two.

cosines = inertia.euler_angles.direction_cosines(angles)
np.testing.assert_allclose(cosines, product, atol=1e-14)
np.testing.assert_allclose(cosines @ cosines.T, np.eye(3), atol=1e-14)
assert abs(np.linalg.det(cosines) - 1.0) < 1e-14
print(cosines.round(4))

attitude = inertia.euler_angles.from_angles(angles)
np.testing.assert_allclose(inertia.euler_angles.to_angles(attitude), angles, atol=1e-14)
vector = np.array([1.0, -2.0, 0.5])  # along space axes
np.testing.assert_allclose(inertia.quaternion.to_body(attitude, vector), product @ vector, atol=1e-14)

# %%
# **Other conventions** name the same attitude by other numbers: z-y-z turns about the carried y in place of n, and
# x-y-z about three different axes, as is done for ships and aircraft. Papers and programs differ: look it up.

for convention in ("z-x-z", "z-y-z", "x-y-z"):
    degrees = np.degrees(inertia.euler_angles.to_angles(attitude, convention))
    print(f"{convention}: {degrees.round(3)}°")
    if convention == "z-y-z":  # the carried y is a quarter turn from the line of nodes
        np.testing.assert_allclose(degrees, [30 - 90, 50, 70 + 90], atol=1e-12)

# %%
# **The singular place**: at :math:`\theta = 0` z and axis 3 are one, and only :math:`\phi + \psi` is defined. The
# library gives it as :math:`\phi`, and says so.

flat = inertia.euler_angles.to_angles(inertia.euler_angles.from_angles(np.radians([30.0, 0.0, 70.0])))
np.testing.assert_allclose(np.degrees(flat), [100.0, 0.0, 0.0], atol=1e-12)
assert inertia.euler_angles.is_singular(flat)
assert not inertia.euler_angles.is_singular(angles)

# %%
# Look at the line of nodes: it lies in both discs, the grey x-y plane of space and the coloured 1-2 plane of the body,
# and is at right angles to z and to axis 3.
#
# **To try**: :math:`\theta = 170^\circ`. Which way does axis 3 point, and where has the line of nodes gone?

node = turn_phi[0]
np.testing.assert_allclose(np.cross([0, 0, 1], cosines[2]), st * node, atol=1e-14)
fig, ax = plt.subplots(figsize=(6.4, 4.6), subplot_kw={"projection": "3d"})
around = np.linspace(0, 2 * np.pi, 121)
circle = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1)
ax.plot(*circle.T, color="0.6")
ax.plot(*(circle @ cosines).T, color="C2")
ax.plot(*np.stack([-1.1 * node, 0 * node]).T, color="C0")
lines = [*zip(np.eye(3), "xyz", strict=True), *zip(cosines, "123", strict=True), (node, "n")]
for (axis, name), color in zip(lines, ["0.45"] * 3 + ["C2"] * 3 + ["C0"], strict=True):
    ax.plot(*np.stack([0 * axis, 1.25 * axis]).T, color=color)
    ax.text(*(1.35 * axis), name, color=color, ha="center", va="center")
arc = np.linspace(0, 1, 31)[:, None]
upright, past = np.array([0, 0, 1.0]), np.cross(cosines[2], node)
for angle, first, second, name in (
    (angles[0], np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), "φ"),
    (angles[1], upright, np.cross(node, upright), "θ"),
    (angles[2], node, past, "ψ"),
):
    path = 0.6 * (np.cos(angle * arc) * first + np.sin(angle * arc) * second)
    ax.plot(*path.T, color="k", linewidth=1)
    ax.text(*(1.25 * path[15]), name, ha="center", va="center")
ax.set_box_aspect((1, 1, 1), zoom=1.25)
ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
ax.view_init(elev=22, azim=-30)
ax.set_axis_off()
plt.show()
