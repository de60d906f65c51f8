r"""
13.18 Lagrange's equations of motion
====================================

With the Euler angles as coordinates, Lagrange's equations of a turning body read

.. math::

   \frac{\mathrm d}{\mathrm dt} \frac{\partial T}{\partial \dot q} - \frac{\partial T}{\partial q} = N_q ,
   \qquad q = \phi, \theta, \psi .

The momentum :math:`p_q = \partial T/\partial \dot q` is the component of :math:`\mathbf L` along the axis that
:math:`q` turns about, and the generalised force :math:`N_q` that of the torque: along the vertical for :math:`\phi`,
the line of nodes for :math:`\theta`, the body's axis 3 for :math:`\psi`. For :math:`\psi` the section finds Euler's
third equation again, as :math:`\partial T/\partial\psi = (I_1 - I_2)\, \omega_1 \omega_2`; the other two angles give
combinations of all three.
"""

# %%
# A body with three different moments, under a torque of 0.4 N m about the vertical of the room. Its part along axis 3
# is :math:`0.4\, \cos\theta`, and the line of nodes is level, so that
# :math:`N_\phi = 0.4`, :math:`N_\theta = 0`, :math:`N_\psi = 0.4\, \cos\theta` N m.

import matplotlib.pyplot as plt
import numpy as np

import inertia

I1, I2, I3 = moments = np.array([1.0, 2.0, 3.0])  # kg m²
torque, duration = 0.4, 6.0  # N m, s
run = inertia.simulate(
    inertia.Scene.from_dict(
        {
            "body": {"principal_moments": moments},
            "start": {
                "angular_velocity": [0.8, 0.3, 0.5],
                "attitude": inertia.euler_angles.from_angles([0.2, 0.8, 0.5]),
            },
            "load": [{"kind": "torque", "torque": [0.0, 0.0, torque], "frame": "space"}],
            "run": {"duration": duration, "samples": 601, "accuracy": 1e-12},
        }
    )
)
momenta = run.canonical_momenta()

# %%
# Lagrange's equations are tested as a balance: what a momentum has gained is the integral of its force and of
# :math:`\partial T/\partial q`. A run can be asked for at any instants, here those of Gauss's quadrature.

nodes, weights = np.polynomial.legendre.leggauss(40)
at = run.at(duration * (nodes + 1) / 2)
angles, (w1, w2, w3) = at.euler_angles(), at.angular_velocity.T
phi_rate = inertia.euler_angles.rates(angles, at.angular_velocity)[:, 0]
_, theta, psi = angles.T
slope_theta = phi_rate * (np.cos(theta) * (I1 * w1 * np.sin(psi) + I2 * w2 * np.cos(psi)) - I3 * w3 * np.sin(theta))
slope_psi = (I1 - I2) * w1 * w2
pushes = np.stack([np.full_like(theta, torque), slope_theta, slope_psi + torque * np.cos(theta)])
expected = duration / 2 * pushes @ weights
gain = momenta[-1] - momenta[0]
for name, each, integral in zip("φθψ", gain, expected, strict=True):
    print(f"p_{name} gains {each:+.10f} kg m²/s; force and slope of T give {integral:+.10f}")
np.testing.assert_allclose(gain, expected, atol=1e-11)
np.testing.assert_allclose(momenta[:, 0], momenta[0, 0] + torque * run.time, atol=1e-11)

# %%
# :math:`\phi` does not occur in :math:`T`: its momentum grows with the torque and with nothing else, along a straight
# line. The torque does not act on :math:`\theta` at all, and still :math:`p_\theta` is never at rest; that is
# :math:`\partial T/\partial\theta` at work.
#
# **To try**: with ``torque = 0`` :math:`p_\phi = L_z` is constant; with two equal moments :math:`p_\psi` is, too.

fig, ax = plt.subplots(figsize=(6.4, 4))
for k, name in enumerate(("\\phi", "\\theta", "\\psi")):
    ax.plot(run.time, momenta[:, k], label=f"$p_{{{name}}}$")
    ax.plot(duration, momenta[0, k] + expected[k], "o", color=f"C{k}")
ax.plot([], [], "o", color="0.4", label="balance by quadrature")
ax.set(xlabel="time, s", ylabel="canonical momentum, kg m²/s", title="A torque about the vertical")
ax.legend()
plt.show()
