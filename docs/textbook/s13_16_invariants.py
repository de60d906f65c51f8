r"""
13.16 Rotational invariants
===========================

Components of a vector depend on the axes along which it is resolved; scalar products do not. The angular velocity has
other components along the body's axes than along those of the room, but its square is the same (§ 13.16):

.. math::

   \begin{aligned}
   \omega^2 & = \omega_1^2 + \omega_2^2 + \omega_3^2 = \omega_x^2 + \omega_y^2 + \omega_z^2 \\
            & = \dot\phi^2 + \dot\theta^2 + \dot\psi^2 + 2 \dot\phi \dot\psi\, \cos\theta .
   \end{aligned}

The last form shows the Euler rates to be no ordinary components: the axes of :math:`\phi` and :math:`\psi` are
:math:`\theta` apart, not at right angles.
"""

# %%
# A free body, followed for ten seconds, and :math:`\omega` as three observers have it: one rides on the body along its
# principal axes, one has scratched other axes into it, and one stands in the room.

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments, start = np.array([1.0, 2.0, 3.0]), np.array([1.0, 1.5, 0.5])  # kg m², rad/s
run = inertia.simulate(
    inertia.Scene.from_dict(
        {
            "body": {"principal_moments": moments},
            "start": {
                "angular_velocity": start,
                "attitude": inertia.euler_angles.from_angles([0.6, 0.4, 0.9]),
            },
            "run": {"duration": 10.0, "samples": 501},
        }
    )
)
other_axes = inertia.quaternion.matrix(inertia.euler_angles.from_angles([0.7, 0.4, -1.1]))
principal = run.angular_velocity
other = principal @ other_axes
space = inertia.quaternion.to_space(run.attitude, principal)

# %%
# Their components differ; the squares agree, with one another and with the form in Euler rates. So does every other
# scalar product: :math:`\mathbf L \cdot \mathbf L`, and :math:`{\boldsymbol\omega} \cdot \mathbf L = 2T`.

angles = run.euler_angles()
phi_rate, theta_rate, psi_rate = inertia.euler_angles.rates(angles, principal).T
in_rates = phi_rate**2 + theta_rate**2 + psi_rate**2 + 2 * phi_rate * psi_rate * np.cos(angles[:, 1])

square = np.sum(principal**2, axis=1)
for name, result in (("principal", principal), ("scratched", other), ("space", space)):
    np.testing.assert_allclose(np.sum(result**2, axis=1), square, rtol=1e-13)
    print(f"along {name} axes ω = {result[100].round(3).tolist()} rad/s at 2 s, ω² = {np.sum(result[100] ** 2):.12g}")
np.testing.assert_allclose(in_rates, square, rtol=1e-12)

twice_energy = np.sum(space * run.angular_momentum, axis=1)
np.testing.assert_allclose(twice_energy, np.sum(moments * start**2), rtol=1e-13)
np.testing.assert_allclose(np.sum(run.angular_momentum**2, axis=1), np.sum((moments * start) ** 2), rtol=1e-13)
print(f"ω·L = {twice_energy[0]:.12g} J throughout")
print(f"ω² goes from {square.min():.3f} to {square.max():.3f} (rad/s)²")

# %%
# At three tilts the formula is plain: with axis 3 upright, level, and upside down.

rates = np.array([4.0, 2.0, 6.0])
for theta, expected in ((0.0, (4 + 6) ** 2 + 2**2), (np.pi / 2, 4**2 + 2**2 + 6**2), (np.pi, (4 - 6) ** 2 + 2**2)):
    result = inertia.canonical.squared_speed([0.5, theta, 1.0], rates)
    print(f"θ = {np.degrees(theta):3.0f}°: ω² = {result:.12g} (rad/s)²")
    assert abs(result - expected) < 1e-13 * expected

# %%
# In the picture the components are six curves that have little in common, and the thick line is what all agree on.
# It moves, for :math:`\omega^2` is an invariant of the *axes*, not of the motion; only :math:`T` and :math:`L^2` are
# both.
#
# **To try**: make two moments equal, and the thick line becomes level (§ 13.20).

fig, ax = plt.subplots(figsize=(6.4, 4))
for k, colour in enumerate(("C0", "C1", "C2")):
    ax.plot(run.time, principal[:, k], color=colour, label=f"$\\omega_{k + 1}$")
for k, colour in enumerate(("C0", "C1", "C2")):
    ax.plot(run.time, space[:, k], color=colour, linestyle=":", label=f"$\\omega_{'xyz'[k]}$")
ax.plot(run.time, np.sqrt(square), color="black", linewidth=3, label="|ω|")
ax.set(xlabel="time, s", ylabel="rad/s", ylim=(None, 3.0), title="Components along body and space axes, and their size")
ax.legend(ncols=7, fontsize="small", loc="upper center", handlelength=1.4, columnspacing=1.0)
plt.show()
