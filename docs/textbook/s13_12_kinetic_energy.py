r"""
13.12 Kinetic energy, with its cross term
=========================================

About any point O of a body, which moves with :math:`\mathbf V`, the kinetic energy is
:math:`T = \tfrac{1}{2} M V^2 + M \mathbf V \cdot (\mathbf\omega \times \mathbf R)
+ \tfrac{1}{2}\, \mathbf\omega \cdot \mathbf J\, \mathbf\omega` (eq. 13.58), with :math:`\mathbf R` the lever
from O to the centre of mass. The first term is that of a particle, the last that of a turn about O, the middle one what
they have to do with each other. It is zero about the centre of mass, and about a point at rest. The sum is the same
about every O: that is the check.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# The body is a bat in mid-swing: a shaft of 0.85 m and 0.6 kg/m with 0.4 kg near its end. It lies along x, the hands
# are at 0; they move at 4 m/s along y, and the bat turns at 30 rad/s about z.

bat = inertia.wire([[0, 0, 0], [0.85, 0, 0]], 0.6) + inertia.point_masses([[0.7, 0, 0]], [0.4])
hands, omega = np.array([0.0, 4.0, 0.0]), np.array([0.0, 0.0, 30.0])

# %%
# **Particle by particle**: with the speed :math:`v(x) = 4 + 30 x` the shaft has
# :math:`\tfrac{1}{2} \lambda \int v^2 dx` and the weight :math:`\tfrac{1}{2} m v^2`.

by_particles = 0.5 * 0.6 * ((4 + 30 * 0.85) ** 3 - 4**3) / (3 * 30) + 0.5 * 0.4 * (4 + 30 * 0.7) ** 2
print(f"T = {by_particles:.3f} J, particle by particle")

# %%
# **About a point**: ``kinetic_energy`` takes the tensor about O, the lever and the velocity of O, which is
# :math:`\mathbf V = \mathbf V_0 + \mathbf\omega \times \mathbf r`. Here for 111 points along the bat
# and beyond both of its ends.

along = np.linspace(-0.2, 0.9, 111)
points = np.stack([along, 0 * along, 0 * along], axis=1)
terms = [
    inertia.canonical.kinetic_energy(bat.about(o), bat.mass, bat.center_of_mass - o, hands + np.cross(omega, o), omega)
    for o in points
]
translation, cross, rotation, total = np.transpose([(t.translation, t.cross, t.rotation, t.total) for t in terms])
np.testing.assert_allclose(total, by_particles, rtol=1e-12)

# %%
# **Where the cross term is zero**: at the centre of mass, where T is the sum of two, and at the point at rest,
# :math:`x = -V_0/\omega`, about which the whole motion is a turn and T is the last term alone.

middle, still = bat.center_of_mass[0], -4.0 / 30.0
speed = 4.0 + 30.0 * along
np.testing.assert_allclose(cross, bat.mass * speed * 30.0 * (middle - along), atol=1e-12 * by_particles)
turn_alone = 0.5 * 30.0**2 * bat.about([still, 0, 0])[2, 2]
assert abs(turn_alone - by_particles) < 1e-12 * by_particles
carried, turning = 0.5 * bat.mass * (4 + 30 * middle) ** 2, 0.5 * 30**2 * bat.inertia[2, 2]
print(f"centre of mass at {middle:.4f} m: {carried:.2f} + {turning:.2f} J")
print(f"at rest at {still:.4f} m: {turn_alone:.2f} J")

# %%
# Look at the three curves, whose sum is level. The turn has least at the centre of mass (section 13.8); beyond it the
# point moves faster than the bat as a whole, and the cross term takes back what the first counts too much.
#
# **To try**: a ball that is hit stops the weight at 0.7 m for a moment. About which point is T simplest then?

fig, ax = plt.subplots(figsize=(6.4, 4))
for curve, name in ((translation, "translation of O"), (rotation, "rotation about O"), (cross, "cross term")):
    ax.plot(along, curve, label=name)
ax.plot(along, total, "k--", label="sum")
for place, name in ((middle, "centre of mass"), (still, "at rest")):
    ax.axvline(place, color="0.7", linewidth=1)
    ax.annotate(name, (place, -190), (4, 0), textcoords="offset points")
ax.set(xlabel="O along the bat, from the hands / m", ylabel="energy / J", title="One energy, about any point")
ax.set_ylim(-320, 640)
ax.legend(loc="upper center", ncols=2)
plt.show()
