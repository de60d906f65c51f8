r"""
Exercise 7: a spinning wheel that is turned
===========================================

A solid disc of mass :math:`m` and radius :math:`r` spins at :math:`\omega_A` about its axis :math:`\hat n`, which is
itself carried round the vertical at :math:`\omega_B`, at a constant angle :math:`\beta` to it. What torque does that
take?

Principal axes that suit: 1 along :math:`\hat n`, 2 in the plane of :math:`\hat n` and :math:`\hat z`, 3 across both;
they go round with :math:`\omega_B` and not with the spin, which the symmetry of the disc allows. Then
:math:`I_1 = \tfrac12 m r^2`, :math:`I_2 = I_3 = \tfrac14 m r^2`,

.. math:: \boldsymbol\omega = \begin{pmatrix} \omega_A + \omega_B\cos\beta \\ \omega_B\sin\beta \\ 0 \end{pmatrix},

.. math:: \mathbf{L} = \tfrac14 m r^2 \begin{pmatrix} 2\omega_A + 2\omega_B\cos\beta \\ \omega_B\sin\beta \\ 0
   \end{pmatrix},

and :math:`\mathbf{N} = \omega_B\hat z\times\mathbf{L}` lies along :math:`\hat z\times\hat n` with the magnitude

.. math:: N = \tfrac14 m r^2\, \omega_B \sin\beta\, (2 \omega_A + \omega_B \cos\beta) .
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

mass, radius, spin, carried, beta = 2.0, 0.3, 30.0, 5.0, np.radians(70)
axial, transverse = mass * radius**2 / 2, mass * radius**2 / 4

# %%
# The motion in Euler angles: :math:`\phi = \omega_B t`, :math:`\theta = \beta`, :math:`\psi = \omega_A t`. The
# toolkit has the symmetry axis last, and gives ω along axes fixed in the disc; its rate of change is carried round by
# the spin.
time = np.linspace(0, np.pi / carried, 121)
angles = np.stack([carried * time, np.full_like(time, beta), spin * time], axis=1)
attitude = inertia.euler_angles.from_angles(angles)  # its matrix is the rotation from disc to space
omega = inertia.euler_angles.angular_velocity(angles, [carried, 0, spin])
change = spin * np.stack([omega[:, 1], -omega[:, 0], 0 * time], axis=1)
np.testing.assert_allclose(omega[:, 2], spin + carried * np.cos(beta), rtol=1e-14)
np.testing.assert_allclose(np.hypot(omega[:, 0], omega[:, 1]), carried * np.sin(beta), rtol=1e-13)

# %%
# Angular momentum and torque, in space.
moments = np.array([transverse, transverse, axial])
momentum = inertia.quaternion.to_space(attitude, moments * omega)
torque = inertia.quaternion.to_space(attitude, inertia.inverse_dynamics(moments, omega, change))
np.testing.assert_allclose(torque, np.cross([0, 0, carried], momentum), atol=1e-12)
closed_form = transverse * carried * np.sin(beta) * (2 * spin + carried * np.cos(beta))
np.testing.assert_allclose(np.linalg.norm(torque, axis=1), closed_form, rtol=1e-13)
nodes = np.stack([np.cos(carried * time), np.sin(carried * time), 0 * time], axis=1)  # along z × n
np.testing.assert_allclose(torque, closed_form * nodes, atol=1e-12)
print(f"torque:      {np.linalg.norm(torque[0]):.9f} N m")
print(f"closed form: {closed_form:.9f} N m")

# %%
# Put to the proof: a free disc under this torque, as a function of time, goes round as it was meant to.


def driving(instant, _attitude, _omega):
    """Return the torque at an instant, space axes."""
    return closed_form * np.array([np.cos(carried * instant), np.sin(carried * instant), 0])


start = inertia.Start(omega[0], attitude=attitude[0], frame="part")
scene = inertia.Scene(
    inertia.SceneBody(np.diag(moments)),
    start,
    inertia.Settings(time[-1], samples=len(time)),
    applied_loads=(inertia.Torque(driving, frame="space", longest_step=0.05),),
)
run = inertia.simulate(scene)
assert inertia.quaternion.angle_between(run.attitude, attitude).max() < run.error.reached + 1e-13
print("under it the disc keeps to the motion,")
print(f"its attitude to {run.error.reached:.1g} rad")

# %%
# **To look at**: the tip of the axis, left to itself under this torque, goes round at one height.
#
# **To try**: an angle at which no torque is needed; with :math:`\omega_A = -\tfrac12\omega_B\cos\beta` there is one
# for every :math:`\beta`.
tip = inertia.quaternion.to_space(run.attitude, [0, 0, 1])
fig, ax = plt.subplots(figsize=(6.4, 4))
for k, name in enumerate(("x", "y", "z")):
    ax.plot(run.time, tip[:, k], color=f"C{k}", label=f"$n_{name}$ of the run")
ax.plot(time, np.sin(beta) * np.sin(carried * time), "k:", label=r"$\sin\beta\,\sin\omega_B t$")
ax.set(xlabel="time / s", ylabel="component of the disc's axis", ylim=(-1.1, 1.6))
ax.legend(ncols=2)
plt.show()
