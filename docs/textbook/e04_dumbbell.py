r"""
Exercise 4: a dumbbell askew on its axle
========================================

Two masses :math:`M` at the ends of a light rod of length :math:`2A` turn at a constant rate :math:`\omega` about an
axle through the middle of the rod, at an angle :math:`\theta` to it. What are the tensor, the angular momentum, the
torque on the axle and the energy?

With :math:`z` along the axle and the rod in the :math:`xz` plane of the body (at :math:`t = 0` that of space as well)

.. math:: \mathbf{I} = 2 M A^2 \begin{pmatrix} \cos^2\theta & 0 & -\sin\theta\cos\theta \\ 0 & 1 & 0 \\
   -\sin\theta\cos\theta & 0 & \sin^2\theta \end{pmatrix},

.. math:: \mathbf{L} = 2 M A^2 \omega \sin\theta \begin{pmatrix} -\cos\theta\cos\omega t \\ -\cos\theta\sin\omega t
   \\ \sin\theta \end{pmatrix} .

:math:`\mathbf{L}` goes round with the rod, and that takes the torque
:math:`\dot{\mathbf{L}} = \boldsymbol\omega\times \mathbf{L}`, of magnitude
:math:`2 M A^2 \omega^2 \sin\theta\cos\theta`, across the axle. The energy is :math:`M A^2 \omega^2 \sin^2\theta`.
This is the rotor of section 13.25 that is balanced statically and not dynamically.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

mass, half, theta, omega = 2.0, 0.5, np.radians(35), 7.0
s, c, unit = np.sin(theta), np.cos(theta), 2 * mass * half**2

# %%
# **(a)** The tensor, of two point masses.
end = half * np.array([s, 0, c])
dumbbell = inertia.point_masses([end, -end], [mass, mass])
closed_form = unit * np.array([[c * c, 0, -s * c], [0, 1, 0], [-s * c, 0, s * s]])
np.testing.assert_allclose(dumbbell.inertia, closed_form, atol=1e-15)

# %%
# **(b)** The angular momentum :math:`\mathbf{I}\cdot\boldsymbol\omega` is at rest in the body; an attitude turns it
# into space. **(c)** The same from :math:`\sum \mathbf{r}\times\mathbf{p}` of both ends.
spin = np.array([0, 0, omega])
time = np.linspace(0, 2 * np.pi / omega, 121)
attitude = inertia.quaternion.from_rotation_vector(time[:, None] * spin)
momentum = inertia.quaternion.to_space(attitude, dumbbell.inertia @ spin)
turn = np.stack([np.cos(omega * time), np.sin(omega * time), 0 * time], axis=1)
np.testing.assert_allclose(momentum, unit * omega * s * (s * np.array([0, 0, 1]) - c * turn), atol=1e-13)
place = half * (s * turn + c * np.array([0, 0, 1]))
np.testing.assert_allclose(2 * mass * np.cross(place, np.cross(spin, place)), momentum, atol=1e-13)

# %%
# **(d)** What the axle has to do to keep the body turning like this, in space. **(e)** The energy.
torque = inertia.quaternion.to_space(attitude, inertia.inverse_dynamics(dumbbell.inertia, spin, [0, 0, 0]))
across = np.stack([np.sin(omega * time), -np.cos(omega * time), 0 * time], axis=1)
np.testing.assert_allclose(torque, unit * omega**2 * s * c * across, atol=1e-12)
energy = spin @ dumbbell.inertia @ spin / 2
assert abs(energy - mass * half**2 * omega**2 * s * s) < 1e-13
print(f"torque:      {np.linalg.norm(torque[0]):.9f} N m")
print(f"closed form: {unit * omega**2 * s * c:.9f} N m")
print(f"energy:      {energy:.9f} J")
print(f"closed form: {mass * half**2 * omega**2 * s * s:.9f} J")

# %%
# **To look at**: the torque has no part along the axle, and points across the plane of rod and axle.
#
# **To try**: the angle at which it is largest, and why a rod at 90° needs none.
fig, ax = plt.subplots(figsize=(6.4, 4))
for k, name in enumerate("xyz"):
    ax.plot(time, torque[:, k], color=f"C{k}", label=f"torque of the axle, {name}")
ax.plot(time, unit * omega**2 * s * c * np.sin(omega * time), "k:", label="closed form, x")
ax.set(xlabel="time / s", ylabel="torque / N m", ylim=(-26, 40))
ax.legend(ncols=2, fontsize="small", loc="upper right")
plt.show()
