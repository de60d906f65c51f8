r"""
13.19 Hamilton's equations and the Andoyer-Deprit variables
===========================================================

Hamilton's form takes the Euler angles and their momenta :math:`p_\phi, p_\theta, p_\psi` as coordinates. It works, but
a free body does not use up so many: only how :math:`\mathbf L` lies in the body is of interest, as it stays at rest in
space. Andoyer and Deprit chose variables with that in mind (§ 13.19). :math:`G = |\mathbf L|`, :math:`H = L_z` and
:math:`L = L_3` are momenta; :math:`g, h, l` are the angles conjugate to them. Of these :math:`g`, :math:`h` and
:math:`H` do not occur in the energy of a free body,

.. math::

   \mathcal H(l, L) = \tfrac{1}{2} \Bigl( \frac{\sin^2 l}{I_1} + \frac{\cos^2 l}{I_2} \Bigr) (G^2 - L^2)
   + \frac{L^2}{2 I_3} ,

so that a problem of three degrees of freedom has become a single curve in the plane of :math:`l` and :math:`L`.
"""

# %%
# A body goes round near the axis of its greatest moment. First the Hamiltonian in Euler angles, written out, at every
# sample: it is the energy of the start.

import matplotlib.pyplot as plt
import numpy as np

import inertia

I1, I2, I3 = moments = np.array([1.0, 2.0, 3.0])  # kg m²
attitude = inertia.euler_angles.from_angles([0.4, 0.9, -0.3])


def follow(moments, angular_velocity):
    """Let a body go, and follow it for six seconds."""
    start = {"angular_velocity": angular_velocity, "attitude": attitude}
    body = {"principal_moments": moments}
    return inertia.simulate(inertia.Scene.from_dict({"body": body, "start": start, "run": {"duration": 6.0}}))


run = follow(moments, [1.0, 2.0, 3.0])
energy = 0.5 * (1 * 1 + 2 * 4 + 3 * 9)  # J
(phi, theta, psi), (p_phi, p_theta, p_psi) = run.euler_angles().T, run.canonical_momenta().T
L1 = (p_phi - p_psi * np.cos(theta)) * np.sin(psi) / np.sin(theta) + p_theta * np.cos(psi)
L2 = (p_phi - p_psi * np.cos(theta)) * np.cos(psi) / np.sin(theta) - p_theta * np.sin(psi)
hamiltonian = L1**2 / (2 * I1) + L2**2 / (2 * I2) + p_psi**2 / (2 * I3)
np.testing.assert_allclose(hamiltonian, energy, rtol=1e-12)
print(f"H(φ, θ, ψ, p) = {hamiltonian[0]:.12g} J, to {np.abs(hamiltonian / energy - 1).max():.0e} at every sample")

# %%
# Then the same run in the variables of Andoyer and Deprit: G, H and h stay, and the short formula gives the energy.

v = run.andoyer()
np.testing.assert_allclose(v.G, np.sqrt(1 + 16 + 81), rtol=1e-13)
for steady in (v.H, v.h):
    np.testing.assert_allclose(steady, steady[0], rtol=1e-12)
short = (np.sin(v.l) ** 2 / I1 + np.cos(v.l) ** 2 / I2) * (v.G**2 - v.L**2) / 2 + v.L**2 / (2 * I3)
np.testing.assert_allclose(short, energy, rtol=1e-12)
print(f"G = √98 = {v.G[0]:.6f}, H = {v.H[0]:.6f} kg m²/s and h = {v.h[0]:.6f} rad stay")

# %%
# With two equal moments :math:`l` drops out as well, and both angles grow evenly: :math:`\dot l = L (1/I_3 - 1/I_1)`
# and :math:`\dot g = G / I_1`. These are the precessions of § 13.20.

round_one = follow([1.0, 1.0, 2.0], [3.0, 0.0, 2.0]).andoyer()  # L = 4, G = 5
for name, angle, rate in (("l", round_one.l, 4 * (1 / 2 - 1)), ("g", round_one.g, 5 / 1)):
    np.testing.assert_allclose(np.unwrap(angle) - angle[0], rate * run.time, atol=1e-11)
    print(f"a symmetric body: d{name}/dt = {rate:g} rad/s")

# %%
# All motions with one :math:`G` at once: curves of equal :math:`\mathcal H`. The run follows one of those that go all
# the way round; a start near axis 1 is trapped about l = ±90°; the dashed curve between the two kinds is the
# separatrix of § 13.21.
#
# **To try**: start the second one near axis 2, with ``[0.01, 2.0, 0.01]``, and it hugs the separatrix.

tumbling = follow(moments, [3.0, 1.0, 0.6]).andoyer()
l_axis, share = np.meshgrid(np.linspace(-np.pi, np.pi, 181), np.linspace(-1, 1, 121))
level = ((np.sin(l_axis) ** 2 / I1 + np.cos(l_axis) ** 2 / I2) * (1 - share**2) + share**2 / I3) / 2
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.contour(np.degrees(l_axis), share, level, 12, colors="0.7", linewidths=0.8)
ax.contour(np.degrees(l_axis), share, level, [1 / (2 * I2)], colors="black", linestyles="--", linewidths=1)
for each, name in ((v, "near axis 3"), (tumbling, "near axis 1")):
    ax.plot(np.degrees(each.l), each.L / each.G, ".", markersize=3, label=name)
ax.set(xlabel="l, degrees", ylabel="L / G", xticks=range(-180, 181, 60), title="The phase plane of a free body")
ax.legend(loc="lower center", markerscale=4, frameon=True, framealpha=1)
plt.show()
