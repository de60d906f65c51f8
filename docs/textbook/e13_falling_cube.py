r"""
Exercise 13: a cube falls off its edge
======================================

A uniform cube of edge :math:`l` stands on one of its edges, in unstable equilibrium, and tips over. How fast does it
turn when a face meets the floor, if the edge cannot slide, and if it slides without friction?

The centre sinks by :math:`\tfrac12 l(\sqrt2 - 1)`. On an edge that cannot slide all of the energy goes into rotation
about it, :math:`\tfrac12\cdot\tfrac23 M l^2\omega^2`. On ice nothing pushes sideways and the centre falls straight
down: as the edge stays on the floor its height is :math:`\tfrac{l}{\sqrt2}\cos\vartheta`, so that at the end
(:math:`\vartheta = 45°`) it moves at :math:`\tfrac12 l\omega`, and
:math:`\tfrac12(\tfrac16 + \tfrac14) M l^2\omega^2` takes the energy:

.. math:: \omega^2 = A \frac{g}{l} (\sqrt2 - 1), \qquad
   A = \tfrac32 \text{ (held)}, \quad A = \tfrac{12}{5} \text{ (ice)} .
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

edge, mass, gravity = 0.3, 1.7, 9.80665

# %%
# The cube from its corners, the x axis along the edge that it stands on, with the centre above it.
corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * edge
faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
cube = inertia.mass_properties(inertia.Part.from_arrays(corners, faces), mass=mass)
about_edge = cube.about([0, 0, 0])[0, 0]
np.testing.assert_allclose([cube.inertia[0, 0], about_edge], [mass * edge**2 / 6, mass * edge**2 * 2 / 3], rtol=1e-14)

# %%
# **Held**: a hinge along the edge. At rest at the top it would stay there for ever; so it is sent off with a small
# spin, whose energy is taken off at the end. It meets the floor when the angle has become 45°.
nudge = 0.05
start = inertia.Start([nudge, 0, 0], frame="part", attitude=inertia.quaternion.from_rotation_vector([np.pi / 4, 0, 0]))
hinge = inertia.Constraint("hinge", axis=[1, 0, 0])
settings, body = inertia.Settings(1.0, samples=101), inertia.SceneBody.of(cube)
run = inertia.simulate(inertia.Scene(body, start, settings, hinge, (inertia.Gravity(),)))


def left_to_fall(instant):
    """Return the angle from the floor at an instant of the run."""
    return run.at([0, instant]).quantities["angle"][1] - np.pi / 4


impact = inertia.find_events(lambda angle: angle, run.time, run.quantities["angle"] - np.pi / 4, left_to_fall)[0]
held = run.at([0, impact]).angular_velocity[1, 0] ** 2 - nudge**2
unit = gravity / edge * (np.sqrt(2) - 1)
assert abs(held / unit - 3 / 2) < 1e-12
print(f"held: A = {held / unit:.12f}, closed form 1.5")

# %%
# **On ice**: the toolkit has no edge that slides, but tensor and energy do for this question, at any angle of tilt.
tilt = np.linspace(0, np.pi / 4, 91)
energy = mass * gravity * edge / np.sqrt(2) * (1 - np.cos(tilt))
ice = 2 * energy / (cube.inertia[0, 0] + mass * (edge / np.sqrt(2) * np.sin(tilt)) ** 2)
assert abs(ice[-1] / unit - 12 / 5) < 1e-13
print(f"on ice: A = {ice[-1] / unit:.12f}, closed form 2.4")

# %%
# **To look at**: held, a good part of the cube's energy carries its centre sideways; on ice it turns faster
# throughout. The dots are the run.
#
# **To try**: would it lift off the edge? The run's ``quantities["reaction force"]`` says.
falling = (run.time > 0) & (run.time < impact)
angle, squares = run.quantities["angle"][falling], run.angular_velocity[falling, 0] ** 2 - nudge**2
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(np.degrees(tilt), 2 * energy / about_edge * edge / gravity, color="C0", label="edge held, closed form")
ax.plot(np.degrees(angle), squares * edge / gravity, "k.", label="edge held, run")
ax.plot(np.degrees(tilt), ice * edge / gravity, "--", color="C1", label="on ice")
ax.plot([45, 45], np.array([1.5, 2.4]) * (np.sqrt(2) - 1), "o", color="C2", label="at the floor, A = 3/2 and 12/5")
ax.set(xlabel="tilt / °", ylabel=r"$\omega^2\, l / g$")
ax.legend()
plt.show()
