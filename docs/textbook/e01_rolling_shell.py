r"""
Exercise 1: a rolling shell meets a step
========================================

A thin hollow ball of mass :math:`m` and radius :math:`R` rolls at speed :math:`v` against a step of height
:math:`h < R`. What it hits sticks to the edge of the step, but the ball may still turn about that edge. How fast must
it come to get up?

Its tensor about the centre is :math:`\tfrac23 m R^2` about every axis (section 13.4), and by Steiner's theorem (13.8)
:math:`\tfrac53 m R^2` about the edge. Angular momentum about the edge is the one quantity that the impact keeps,

.. math:: L = m v (R - h) + \tfrac23 m R^2 \frac{v}{R} = m v \left(\tfrac53 R - h\right),

and the energy that is left, :math:`L^2 / 2 I`, has to lift the centre by :math:`h`:

.. math:: v_{\min}^2 = \frac{30\, g\, h R^2}{(5R - 3h)^2} .
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

mass, radius, height, gravity = 2.0, 0.3, 0.1, 9.80665

# %%
# **The tensor.** A surface with a thickness is a shell: its triangles carry the mass. A ball of 24, 48 and 96 slices
# comes ever closer to the round one, by a quarter of the error each time, which Richardson's rule takes away.


def shell(slices):
    """Return the mass properties of a globe of flat triangles, all its mass in its skin."""
    tilt, turn = np.linspace(0, np.pi, slices + 1), np.linspace(0, 2 * np.pi, 2 * slices + 1)
    sine, around = np.sin(tilt) * (tilt % np.pi > 0), np.where(turn < 2 * np.pi, turn, 0.0)
    height = np.cos(tilt)[:, None] + 0 * turn
    grid = radius * np.stack([np.outer(sine, np.cos(around)), np.outer(sine, np.sin(around)), height], axis=2)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    corners = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3)
    part = inertia.Part.from_arrays(corners, np.arange(len(corners)).reshape(-1, 3))
    return inertia.mass_properties(part, mass=mass, shell=0.001)


tensors = np.array([shell(slices).inertia for slices in (24, 48, 96)])
for order in (2, 4):
    tensors = (2**order * tensors[1:] - tensors[:-1]) / (2**order - 1)
np.testing.assert_allclose(tensors[0], 2 / 3 * mass * radius**2 * np.eye(3), atol=1e-8)
print(f"I of the shell: {tensors[0, 0, 0]:.9f} kg m²")
print(f"2/3 m R²:       {2 / 3 * mass * radius**2:.9f} kg m²")

# %%
# **The climb.** Bodies with the same mass, centre and tensor move alike (section 13.10), so six masses at the ends of
# three axes stand for the shell, exactly. After the impact it is a pendulum upside down, hinged at the edge.
body = inertia.point_masses(radius * np.vstack([np.eye(3), -np.eye(3)]), [mass / 6] * 6)
edge = np.array([np.sqrt(radius**2 - (radius - height) ** 2), 0, height - radius])
about_edge = body.about(edge)[1, 1]
momentum_per_speed = mass * (radius - height) + body.inertia[1, 1] / radius
least = np.sqrt(2 * mass * gravity * height * about_edge) / momentum_per_speed
closed_form = np.sqrt(30 * gravity * height) * radius / (5 * radius - 3 * height)
assert abs(least - closed_form) < 1e-14
print(f"it gets up from v = {least:.6f} m/s on")
print(f"closed form:        {closed_form:.6f} m/s")


def climb(speed):
    """Return the run of the shell about the edge from the impact on."""
    spin = [0, momentum_per_speed * speed / about_edge, 0]
    hinge = inertia.Constraint("hinge", point=edge, axis=[0, 1, 0])
    start, settings = inertia.Start(spin, frame="part"), inertia.Settings(1.0, samples=201)
    scene = inertia.Scene(inertia.SceneBody.of(body), start, settings, hinge, (inertia.Gravity(),))
    return inertia.simulate(scene)


# %%
# **To look at**: just below :math:`v_{\min}` the shell comes to rest short of the dashed line, where its centre is
# over the edge, and rolls back; just above it creeps over.
#
# **To try**: a solid ball (:math:`\tfrac25 m R^2`), or a higher step.
top = np.arccos(1 - height / radius)
fig, ax = plt.subplots(figsize=(6.4, 4))
for share in (0.8, 0.98, 1.02, 1.2):
    run = climb(share * least)
    angle = run.quantities["angle"]
    assert (angle.max() > top) == (share > 1)
    ax.plot(run.time, np.degrees(angle), label=f"v = {share:g} $v_{{min}}$")
ax.axhline(np.degrees(top), color="0.4", linestyle="--", label="centre over the edge")
ax.set(xlabel="time after the impact / s", ylabel="angle turned about the edge / °", ylim=(-20, 110))
ax.legend()
plt.show()
