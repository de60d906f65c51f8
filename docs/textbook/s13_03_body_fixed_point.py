r"""
13.3 Rotation about a body-fixed point
======================================

A particle of a body that turns about a point O at rest has the velocity
:math:`\mathbf v = \mathbf\omega \times \mathbf r`, so that
:math:`\mathbf L = \sum m\,\mathbf r \times (\mathbf\omega \times \mathbf r)
= \sum m\,[r^2 \mathbf\omega - \mathbf r\,(\mathbf r \cdot \mathbf\omega)]` (eq. 13.9). It is linear in
:math:`\mathbf\omega`, but need not be parallel to it, and it depends on O. A gate on its post shows both: every
point of the hinge line is at rest, and each sees another angular momentum.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# The gate is a plate of 30 kg, a = 2 m wide and b = 1.2 m high, in the plane x, y; its hinges are on the axis y. It
# swings at 1.5 rad/s.

mass, a, b = 30.0, 2.0, 1.2
gate = inertia.lamina([[0, 0], [a, 0], [a, b], [0, b]], mass / (a * b))
omega = np.array([0.0, 1.5, 0.0])
heights = np.array([0.0, b / 2, b])  # of the point O on the hinge line
momenta = np.array([gate.about([0.0, h, 0.0]) @ omega for h in heights])

# %%
# The oracle is the sum over particles, written out. Four particles of a quarter of the mass each, at
# :math:`(\tfrac{1}{2} \pm \tfrac{1}{2\sqrt3})` of width and height, stand for the whole plate: they have its mass, its
# centre of mass and all its second moments (the points of Gauss).

share = 0.5 + np.array([-1.0, 1.0]) / (2.0 * np.sqrt(3.0))
particles = np.array([[x * a, y * b, 0.0] for x in share for y in share])
for height, momentum in zip(heights, momenta, strict=True):
    r = particles - [0.0, height, 0.0]
    v = np.cross(omega, r)
    np.testing.assert_allclose(momentum, np.sum(mass / 4 * np.cross(r, v), axis=0), atol=1e-12 * mass)
    closed_form = 1.5 * mass * np.array([-a / 2 * (b / 2 - height), a**2 / 3, 0.0])
    np.testing.assert_allclose(momentum, closed_form, atol=1e-12 * mass)
    print(f"O at {height:.1f} m: L = ({momentum[0]:+.1f}, {momentum[1]:.1f}, 0) kg m²/s")

# %%
# Along the hinges all agree: :math:`L_y = \tfrac{1}{3} M a^2 \omega`. Across them
# :math:`L_x = -M \tfrac{a}{2} (\tfrac{b}{2} - h)\,\omega`, which is zero at mid-height alone. The gate carries
# that part round, so that :math:`d\mathbf L/dt = \mathbf\omega \times \mathbf L`: about its lowest point it needs
# a torque of the upper hinge to go on turning about the post. A run on that axle has the same :math:`\mathbf L`.

axle = inertia.Constraint(kind="hinge", axis=[0.0, 1.0, 0.0], drive="constant_speed")
start = inertia.Start(angular_velocity=omega, frame="part")
turn = inertia.Settings(duration=2 * np.pi / 1.5, samples=65)
run = inertia.simulate(inertia.Scene(inertia.SceneBody.of(gate), start, constraint=axle, run=turn))
np.testing.assert_allclose(run.angular_momentum[0], momenta[0], atol=1e-12 * mass)
across = mass * a * b / 4 * 1.5
angle = 1.5 * run.time
around = np.stack([-across * np.cos(angle), np.full(65, momenta[0, 1]), across * np.sin(angle)], axis=1)
np.testing.assert_allclose(run.angular_momentum, around, atol=1e-12 * mass)
print(f"O at 0.0 m: |dL/dt| = {1.5 * across:.2f} N m")

# %%
# Look at the arrows: one motion, three angular momenta. None is wrong. That about mid-height is parallel to ω because
# the hinge line is a principal axis there and nowhere else (section 13.6).
#
# **To try**: a triangular gate. At which height does :math:`\mathbf L` follow the hinges?

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.fill([0, a, a, 0], [0, 0, b, b], color="0.9")
ax.plot([0, 0], [-0.2, 2.1], color="0.75", linewidth=4, solid_capstyle="round")
for number, (height, momentum) in enumerate(zip(heights, momenta, strict=True)):
    tip = momentum[:2] / 110.0
    arrow = {"arrowstyle": "-|>", "color": f"C{number}", "linewidth": 2}
    ax.annotate("", (tip[0], height + tip[1]), (0, height), arrowprops=arrow)
    ax.plot(0, height, "o", color=f"C{number}", label=f"L about O at {height:.1f} m")
ax.plot(*particles[:, :2].T, "k.", label="four particles, same moments")
ax.set(xlabel="x / m", ylabel="y / m", aspect="equal", xlim=(-0.7, 2.9), title="One swing, three points")
ax.legend(loc="upper right")
plt.show()
