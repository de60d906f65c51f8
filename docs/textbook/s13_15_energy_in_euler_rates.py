r"""
13.15 Kinetic energy in Euler rates
===================================

The kinetic energy of a rotation is :math:`T = \tfrac{1}{2} \sum_i I_i \omega_i^2`, with :math:`\omega` along the
principal axes. Lagrange's method wants it in terms of the Euler angles and their rates. Putting in the components of
§ 13.14,

.. math::

   \begin{aligned}
   2T = {} & I_1 (\dot\phi\, \sin\theta\, \sin\psi + \dot\theta\, \cos\psi)^2 \\
     & + I_2 (\dot\phi\, \sin\theta\, \cos\psi - \dot\theta\, \sin\psi)^2 \\
     & + I_3 (\dot\phi\, \cos\theta + \dot\psi)^2 .
   \end{aligned}

Each line is the spin about one principal axis. As a free body tumbles, energy moves from one line to another; their
sum stays.
"""

# %%
# One attitude and three rates are enough to try the formula by hand: at φ = 30°, θ = 60°, ψ = 90° and rates of 4, 2 and
# 6 rad/s, :math:`\omega = (2\sqrt3, -2, 8)` rad/s. For moments of 1, 2 and 3 kg m² this is
# :math:`\tfrac{1}{2} (12 + 8 + 192) = 106` J.

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments = np.array([1.0, 2.0, 3.0])  # kg m²
by_hand = inertia.canonical.rotational_energy(moments, np.radians([30, 60, 90]), [4, 2, 6])
print(f"at 30°, 60°, 90° and 4, 2, 6 rad/s: T = {by_hand:.12g} J")
assert abs(by_hand - 106) < 1e-12 * 106

# %%
# Now the same body thrown up with :math:`\omega = (1, 1.5, 0.5)` rad/s. The run states its attitude; the Euler angles
# and their rates follow from it, and the three lines of the formula from them.

scene = inertia.Scene.from_dict(
    {
        "body": {"principal_moments": moments},
        "start": {
            "angular_velocity": [1.0, 1.5, 0.5],
            "attitude": inertia.euler_angles.from_angles([0.0, 1.2, 0.3]),
        },
        "run": {"duration": 12.0, "samples": 601},
    }
)
run = inertia.simulate(scene)
angles = run.euler_angles()
rates = inertia.euler_angles.rates(angles, run.angular_velocity)

phi, theta, psi = angles.T
phi_rate, theta_rate, psi_rate = rates.T
about_1 = 0.5 * 1.0 * (phi_rate * np.sin(theta) * np.sin(psi) + theta_rate * np.cos(psi)) ** 2
about_2 = 0.5 * 2.0 * (phi_rate * np.sin(theta) * np.cos(psi) - theta_rate * np.sin(psi)) ** 2
about_3 = 0.5 * 3.0 * (phi_rate * np.cos(theta) + psi_rate) ** 2

total = 0.5 * (1 * 1.0**2 + 2 * 1.5**2 + 3 * 0.5**2)  # J, at the start
drift = np.abs(about_1 + about_2 + about_3 - total).max() / total
print(f"T = {total} J at the start; the sum of the three lines stays within {drift:.0e} of it")
print(f"meanwhile the rate of φ goes from {phi_rate.min():.2f} to {phi_rate.max():.2f} rad/s")
assert drift < 1e-12

# %%
# The three stacked on one another: their upper edge is level. Where the body nearly spins about axis 2 alone, the
# middle band takes up almost all of it.
#
# **To try**: start at :math:`\theta = 0.05` instead of 1.2. The rates of :math:`\phi` and :math:`\psi` grow large and
# opposite whenever axis 3 passes close to the vertical, and yet the edge stays level: it is the angles that are awkward
# there, not the motion.

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.stackplot(run.time, about_1, about_2, about_3, labels=[f"about axis {k}" for k in (1, 2, 3)], alpha=0.85)
ax.plot(run.time, run.energy, color="black", linewidth=1, label="T of the run")
ax.set(xlabel="time, s", ylabel="kinetic energy, J", xlim=(0, 12), ylim=(0, 1.35 * total), title="Where the energy is")
ax.legend(ncols=2, loc="upper center")
plt.show()
