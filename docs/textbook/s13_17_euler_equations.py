r"""
13.17 Euler's equations of motion
=================================

In space a torque is the rate of change of :math:`\mathbf L`; along axes that turn with the body,
:math:`{\boldsymbol\omega} \times \mathbf L` comes in. Along principal axes this gives Euler's equations (§ 13.17),

.. math::

   N_1 = I_1 \dot\omega{}_1 - (I_2 - I_3)\, \omega_2 \omega_3, \qquad \text{and cyclic.}

They answer two questions. Given the torque, how does the body turn? And given how it turns, what torque does that take?
"""

# %%
# A spacecraft with :math:`I_1 = I_2` has two thrusters that turn it about its axis of symmetry, and wobbles.
# The equations can then be solved in full: :math:`\omega_3 = \omega_0 + N t / I_3` grows evenly, and
# :math:`\omega_1 + i \omega_2 = A e^{i\eta}` goes round faster and faster, :math:`\eta = \frac{I_3 - I_1}{I_1}
# \int \omega_3\, \mathrm{d}t`.

import matplotlib.pyplot as plt
import numpy as np

import inertia

across, along = 100.0, 160.0  # kg m²
spin, wobble, torque = 0.5, 0.6, 20.0  # rad/s, rad/s, N m
run = inertia.simulate(
    inertia.Scene.from_dict(
        {
            "body": {"principal_moments": [across, across, along]},
            "start": {"angular_velocity": [wobble, 0.0, spin]},
            "load": [{"kind": "torque", "torque": [0.0, 0.0, torque], "frame": "part"}],
            "run": {"duration": 20.0, "samples": 801},
        }
    )
)
t = run.time
eta = (along - across) / across * (spin * t + torque * t**2 / (2 * along))
expected = np.stack([wobble * np.cos(eta), wobble * np.sin(eta), spin + torque * t / along], axis=1)
error = np.abs(run.angular_velocity - expected).max()
print(f"after 20 s it spins at {run.angular_velocity[-1, 2]:.10g} rad/s")
print(f"farthest from the formula: {error:.0e} rad/s")
assert error < 1e-12

# %%
# Now the other way round. The formula is differentiated, and
# :func:`inertia.inverse_dynamics` returns the torque that such a motion takes: 20 N m about axis 3, and none across it,
# although :math:`\dot\omega{}_1` and :math:`\dot\omega{}_2` do not vanish.

eta_rate = (along - across) / across * expected[:, 2]
acceleration = np.stack(
    [-eta_rate * expected[:, 1], eta_rate * expected[:, 0], np.full_like(t, torque / along)], axis=1
)
torques = inertia.inverse_dynamics([across, across, along], expected, acceleration)
print(f"torque, from the motion: {torques[-1].round(10).tolist()} N m")
np.testing.assert_allclose(torques, np.broadcast_to([0.0, 0.0, torque], torques.shape), atol=1e-12 * torque)

# %%
# The wobble keeps its size while its pace grows with the spin: dashes are the formula, lines are the run.
#
# **To try**: say ``"frame": "space"``, so that the torque keeps its direction in the room, and drop the checks. Then
# :math:`\mathbf L = \mathbf L_0 + \mathbf N t` whatever the body, and the components along the body get complicated.

fig, ax = plt.subplots(figsize=(6.4, 4))
for k in range(3):
    ax.plot(t, run.angular_velocity[:, k], label=f"$\\omega_{k + 1}$", linewidth=2)
ax.plot(t, expected, color="black", linestyle=(0, (2, 4)), linewidth=1)
ax.set(xlabel="time, s", ylabel="angular velocity, rad/s", title="Spun up about its axis of symmetry")
ax.legend()
plt.show()
