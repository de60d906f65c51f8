r"""
13.11 Angular momentum and angular velocity
===========================================

:math:`\mathbf L = \mathbf I \cdot \mathbf\omega` (eq. 13.55) has two consequences: the two vectors point different
ways unless the body spins about a principal axis, and where no torque acts :math:`\mathbf L` is what stays in space.
The angular velocity, which one sees, wanders about it. Only its part along :math:`\mathbf L` is constant, for
:math:`\mathbf\omega \cdot \mathbf L = 2T`: its tip stays in a plane, in a ring.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# A box of 12 kg and 3 by 2 by 1 m has the moments 5, 10 and 13 kg m². It is let go with 1 rad/s about each of its axes.

moments, omega = np.array([5.0, 10.0, 13.0]), np.array([1.0, 1.0, 1.0])
scene = inertia.Scene(
    body=inertia.SceneBody(np.diag(moments)),
    start=inertia.Start(angular_velocity=omega),
    run=inertia.Settings(duration=40.0, samples=1601),
)
run = inertia.simulate(scene)

# %%
# **At the start** :math:`\mathbf L` has the components 5, 10 and 13, and the angle between the two follows from their
# product; ``momentum_angle`` gives it too.

size, twice_energy = np.linalg.norm(moments * omega), moments @ omega**2
angle = np.arccos(28 / np.sqrt(3 * (25 + 100 + 169)))
np.testing.assert_allclose(inertia.momentum_angle(moments, omega), angle, rtol=1e-12)
print(f"L and ω are {np.degrees(angle):.3f}° apart at first")

# %%
# **In space** L stays, and so does the part of ω along it. Along the body L goes round, and keeps its length alone.

spin = inertia.quaternion.to_space(run.attitude, run.angular_velocity)
np.testing.assert_allclose(run.angular_momentum, np.tile(moments * omega, (1601, 1)), atol=1e-12)
np.testing.assert_allclose(spin @ (moments * omega) / size, twice_energy / size, rtol=1e-12)
along_body = run.angular_velocity * moments
np.testing.assert_allclose(np.linalg.norm(along_body, axis=1), size, rtol=1e-12)
print(f"along the body L goes from {along_body.min(axis=0).round(2)}")
print(f"to {along_body.max(axis=0).round(2)} kg m²/s")

# %%
# **The ring.** As 2T I2 is less than L², ω goes round axis 3, and its length is extreme where ω1 or ω2 is zero. Energy
# and momentum then give the other two components: two linear equations for their squares.


def square(i, j):
    """Return ω² where only the components i and j are not zero."""
    return np.linalg.solve([moments[[i, j]] ** 2, moments[[i, j]]], [size**2, twice_energy]).sum()


assert inertia.separatrix_distance(moments, omega) < 0
ring = np.sqrt(np.sort([square(0, 2), square(1, 2)]) - (twice_energy / size) ** 2)
curve = inertia.herpolhode(moments, omega)
np.testing.assert_allclose([curve.least, curve.greatest], ring, rtol=1e-12)
leaning = np.degrees(np.arctan2(ring, twice_energy / size))
print(f"ω leans from L by {leaning[0]:.3f}° to {leaning[1]:.3f}°")

# %%
# Look down along L: ω goes round it between two circles, touching each in turn, and its path does not close. A
# principal axis would give a point at the centre; a symmetric top, one circle.
#
# **To try**: moments 5, 5 and 13; or ω = (0, 0.1, 1), near axis 3.

e3 = moments * omega / size
e1 = np.cross(e3, [0.0, 0.0, 1.0]) / np.linalg.norm(np.cross(e3, [0.0, 0.0, 1.0]))
x, y = spin @ e1, spin @ np.cross(e3, e1)
assert ring[0] - 1e-12 < np.hypot(x, y).min() < np.hypot(x, y).max() < ring[1] + 1e-12
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(x, y, color="C2", linewidth=1, label="tip of ω")
ax.plot(0, 0, "o", color="C0", label="L, towards the eye")
around = np.linspace(0, 2 * np.pi, 181)
for radius in ring:
    ax.plot(radius * np.cos(around), radius * np.sin(around), "--", color="0.5", linewidth=1)
ax.set(xlabel="ω across L / (rad/s)", ylabel="ω across L / (rad/s)", aspect="equal", title="ω about L, in space")
ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
plt.show()
