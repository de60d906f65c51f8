r"""
13.14 Angular velocity in Euler rates
=====================================

The Euler rates turn about three axes that are not at right angles: precession :math:`\dot\phi` about z, nutation
:math:`\dot\theta` about the line of nodes, spin :math:`\dot\psi` about axis 3. Resolved along the body (eq. 13.86 to
13.88) and along space (eq. 13.89 to 13.91) they add up to

.. math::

   \begin{aligned}
   \omega_1 & = \dot\phi\, \sin\theta\, \sin\psi + \dot\theta\, \cos\psi, \\
   \omega_2 & = \dot\phi\, \sin\theta\, \cos\psi - \dot\theta\, \sin\psi, \\
   \omega_3 & = \dot\phi\, \cos\theta + \dot\psi, \\
   \omega_x & = \dot\theta\, \cos\phi + \dot\psi\, \sin\theta\, \sin\phi, \\
   \omega_y & = \dot\theta\, \sin\phi - \dot\psi\, \sin\theta\, \cos\phi, \\
   \omega_z & = \dot\phi + \dot\psi\, \cos\theta .
   \end{aligned}

Solved for the rates, both have :math:`\sin\theta` below the line: where axis 3 comes near z the rates rush, though the
body does not.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# A free body with moments 3, 2 and 4 kg m² tumbles so that its axis 3 comes close to z.

scene = inertia.Scene(
    body=inertia.SceneBody(np.diag([3.0, 2.0, 4.0])),
    start=inertia.Start(
        angular_velocity=[1.0, 0.2, 0.3], frame="part", attitude=inertia.euler_angles.from_angles([0.0, 0.8, 0.8])
    ),
    run=inertia.Settings(duration=14.0, samples=1401),
)
run = inertia.simulate(scene)
angles = inertia.euler_angles.to_angles(run.attitude)
rates = inertia.euler_angles.rates(angles, run.angular_velocity)

# %%
# **There**: the rates by the library, put into the six equations as the chapter has them, give ω along the body and
# along space back. Eq. 13.90 has a minus sign that the matrix after it lacks: the run decides for the minus.

(phi, theta, psi), (d_phi, d_theta, d_psi) = angles.T, rates.T
along_body = np.stack(
    [
        d_phi * np.sin(theta) * np.sin(psi) + d_theta * np.cos(psi),
        d_phi * np.sin(theta) * np.cos(psi) - d_theta * np.sin(psi),
        d_phi * np.cos(theta) + d_psi,
    ],
    axis=1,
)
along_space = np.stack(
    [
        d_theta * np.cos(phi) + d_psi * np.sin(theta) * np.sin(phi),
        d_theta * np.sin(phi) - d_psi * np.sin(theta) * np.cos(phi),
        d_phi + d_psi * np.cos(theta),
    ],
    axis=1,
)
np.testing.assert_allclose(along_body, run.angular_velocity, atol=1e-12)
np.testing.assert_allclose(along_space, inertia.quaternion.to_space(run.attitude, run.angular_velocity), atol=1e-12)

# %%
# **And back**: ``angular_velocity`` is that sum, in either frame. That the rates are the slopes of the angles shows in
# their differences over one sample, taken from :math:`t \pm 10^{-4}` s.

np.testing.assert_allclose(inertia.euler_angles.angular_velocity(angles, rates), run.angular_velocity, atol=1e-12)
later, earlier = (inertia.euler_angles.to_angles(run.at([2.0 + step]).attitude)[0] for step in (1e-4, -1e-4))
np.testing.assert_allclose((later - earlier) / 2e-4, rates[200], atol=1e-6)

nearest = theta.argmin()
print(f"θ comes down to {np.degrees(theta[nearest]):.2f}° at {run.time[nearest]:.2f} s")
print(f"there φ' = {d_phi[nearest]:.2f} and ψ' = {d_psi[nearest]:.2f} rad/s,")
print(f"and their sum is {d_phi[nearest] + d_psi[nearest]:.3f} rad/s")
print(f"|ω| is {np.linalg.norm(run.angular_velocity, axis=1).max():.3f} rad/s at most")

# %%
# **At the pole itself** the library says what is wrong, and gives the sum where it is asked for.

try:
    inertia.euler_angles.rates([0.3, 0.0, 0.2], [0.0, 0.0, 7.0])
except inertia.GeometryError as refusal:
    print(refusal)
np.testing.assert_allclose(inertia.euler_angles.rates([0.3, 0.0, 0.2], [0.0, 0.0, 7.0], merge=True), [7.0, 0.0, 0.0])

# %%
# Look at the spikes: precession and spin are large and opposite wherever θ is small, and their sum is not. Runs are
# therefore followed as quaternions, and angles are read off them.
#
# **To try**: the same body in the convention x-y-z, ``to_angles(run.attitude, "x-y-z")``. Where are its spikes?

fig, (ax, below) = plt.subplots(2, 1, figsize=(6.4, 4.6), sharex=True, height_ratios=[2, 1])
for rate, name in ((d_phi, "precession φ'"), (d_psi, "spin ψ'"), (d_theta, "nutation θ'")):
    ax.plot(run.time, rate, label=name)
ax.plot(run.time, np.linalg.norm(run.angular_velocity, axis=1), "k--", linewidth=1, label="|ω|")
ax.set(ylabel="rate / (rad/s)", title="Rates rush where θ is small; the body does not")
ax.legend(ncols=2)
below.plot(run.time, np.degrees(theta), color="C3")
below.set(xlabel="time / s", ylabel="θ / °", ylim=(0, None))
plt.show()
