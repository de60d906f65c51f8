r"""
13.2 Coordinates of a rigid body
================================

Six numbers say where a rigid body is: three for a point of it, three for how it is turned. Chasles' theorem says that
any motion is a shift of that point and a turn about it. With the centre of mass as the point the two come apart:
force moves it, :math:`\mathbf F = d\mathbf P/dt`, and torque about it turns the body,
:math:`\mathbf N = d\mathbf L/dt`. A thrown club shows both: its centre of mass keeps to a parabola, whatever its two
ends do.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# The club is a shaft of 0.8 m and 0.2 kg/m with a bar of 0.2 m and 3 kg/m across its end. Bodies given along the same
# axes add up.

head, tail = [0.8, 0.0, 0.0], [0.0, 0.0, 0.0]
club = inertia.wire([tail, head], 0.2) + inertia.wire([[0.8, 0.0, -0.1], [0.8, 0.0, 0.1]], 3.0)
print(f"mass {club.mass:.2f} kg, centre of mass {club.center_of_mass[0]:.3f} m from the tail")
assert abs(club.center_of_mass[0] - (0.16 * 0.4 + 0.6 * 0.8) / 0.76) < 1e-12

# %%
# It is thrown with its centre of mass 1.5 m up, at 3 m/s forward and 5 m/s upward, turning at 9 rad/s about the
# horizontal y. The scene needs just that: a body, a start and gravity.

throw = inertia.Scene(
    body=inertia.SceneBody.of(club),
    start=inertia.Start(
        angular_velocity=[0.0, 9.0, 0.0], frame="part", position=[0.0, 0.0, 1.5], velocity=[3.0, 0.0, 5.0]
    ),
    applied_loads=[inertia.Gravity()],
    run=inertia.Settings(duration=1.2, samples=121),
)
run = inertia.simulate(throw)

# %%
# The run has both halves of the motion: ``position`` of the centre of mass, ``attitude`` of the body. Any point of the
# body is where the one has moved it and the other has turned it, :math:`\mathbf R + \mathbf r'`.


def path(point):
    """Return where a point (3,) of the body, part axes, is at every sample."""
    return run.position + inertia.quaternion.to_space(run.attitude, np.subtract(point, club.center_of_mass))


t = run.time
parabola = np.stack([3.0 * t, 0.0 * t, 1.5 + 5.0 * t - 0.5 * 9.80665 * t**2], axis=1)
turned = club.center_of_mass[0] * np.stack([-np.cos(9.0 * t), 0.0 * t, np.sin(9.0 * t)], axis=1)
# The shift is that of a particle, the turn is by ωt about y, and the club is rigid.
np.testing.assert_allclose(run.position, parabola, atol=1e-12)
np.testing.assert_allclose(path(tail), parabola + turned, atol=1e-12)
np.testing.assert_allclose(np.linalg.norm(path(head) - path(tail), axis=1), 0.8, rtol=1e-12)

# Gravity has no torque about the centre of mass: L about it stays.
momentum = run.angular_momentum[:, 1]
np.testing.assert_allclose(momentum, 9.0 * club.inertia[1, 1], rtol=1e-12)
print(f"L about the centre of mass stays at {momentum[0]:.4f} kg m²/s")

# %%
# Look at the smooth line amid the loops. The ends wind round it in circles, as seen from the centre of mass, the
# tail's 8.5 times as wide as the head's, which is that much nearer to it.
#
# **To try**: a bar of 0.5 kg/m. Which point of the shaft keeps to the parabola then?

fig, ax = plt.subplots(figsize=(6.4, 4))
for row in range(0, 121, 8):
    ax.plot(*np.array([path(tail)[row], path(head)[row]])[:, ::2].T, color="0.8", linewidth=1)
ax.plot(*path(tail)[:, ::2].T, label="tail")
ax.plot(*path(head)[:, ::2].T, label="head")
ax.plot(*run.position[:, ::2].T, linewidth=2.5, label="centre of mass")
ax.set(xlabel="x / m", ylabel="z / m", aspect="equal", title="A thrown club: a shift and a turn")
ax.legend()
plt.show()
