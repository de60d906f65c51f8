r"""
Exercise 14: how fast the axis of a free body goes round
========================================================

A symmetric body moves free of torques. :math:`\boldsymbol\omega` is at an angle :math:`\alpha` to its axis 3. At
which rate does this axis go round :math:`\mathbf{L}`, in terms of :math:`I_1`, :math:`I_3`, :math:`\omega` and
:math:`\alpha`?

With :math:`\mathbf{L}` along :math:`z` the axis keeps its angle :math:`\theta` to it, and the part of
:math:`\boldsymbol\omega` across the axis is :math:`\dot\phi\sin\theta`, that of :math:`\mathbf{L}` is :math:`I_1`
times as much, and :math:`L \sin\theta` as well. So (section 13.20)

.. math:: \dot\phi = \frac{L}{I_1} = \omega \sqrt{\sin^2\alpha + \left(\frac{I_3}{I_1}\right)^2 \cos^2\alpha},

.. math:: \tan\theta = \frac{I_1}{I_3} \tan\alpha .

Feynman's plate is the case :math:`I_3 = 2 I_1`, :math:`\alpha \to 0`: it wobbles twice as fast as it spins.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

I1, I3, alpha, omega = 4.0, 3.0, np.radians(45), 8.0

# %%
# From moments and spin by ``cones``, and as an angle that grows with time in a run that starts with L along
# :math:`z`.
spin = omega * np.array([0, np.sin(alpha), np.cos(alpha)])
closed_form = omega * np.sqrt(np.sin(alpha) ** 2 + (I3 / I1) ** 2 * np.cos(alpha) ** 2)
theta = np.arctan(I1 / I3 * np.tan(alpha))
cones = inertia.cones([I1, I1, I3], spin)
assert abs(cones.precession - closed_form) < 1e-14

start = inertia.Start(spin, frame="part", attitude=inertia.euler_angles.from_angles([0, theta, 0]))
run = inertia.simulate(inertia.Scene(inertia.SceneBody(np.diag([I1, I1, I3])), start, inertia.Settings(2.0)))
phi, tilt, _ = run.euler_angles().T
np.testing.assert_allclose(phi, closed_form * run.time, atol=1e-12)
np.testing.assert_allclose(tilt, theta, atol=1e-13)
momentum = np.linalg.norm(run.angular_momentum[0])
np.testing.assert_allclose(run.angular_momentum, np.tile([0, 0, momentum], (len(run.time), 1)), atol=1e-13)
print(f"φ' of the run: {phi[-1] / run.time[-1]:.12f} rad/s")
print(f"L/I₁:          {momentum / I1:.12f} rad/s")
print(f"closed form:   {closed_form:.12f} rad/s")

# %%
# **To look at**: a ball (:math:`I_3 = I_1`) has no axis of its own, and everything goes round at :math:`\omega`.
# Across the axis (90°) every body does. The dot is the run above.
#
# **To try**: a rod, :math:`I_3 \to 0`, and the sense in which :math:`\boldsymbol\omega` goes round in the body,
# ``cones.body_precession``.
angles = np.linspace(0, np.pi / 2, 91)
directions = np.stack([0 * angles, np.sin(angles), np.cos(angles)], axis=1)
fig, ax = plt.subplots(figsize=(6.4, 4))
for k, ratio in enumerate((2.0, 1.5, 1.0, 0.75, 0.25)):
    rates = inertia.cones([1, 1, ratio], directions).precession
    np.testing.assert_allclose(rates, np.sqrt(np.sin(angles) ** 2 + (ratio * np.cos(angles)) ** 2), rtol=1e-14)
    ax.plot(np.degrees(angles), rates, color=f"C{k}", label=f"$I_3/I_1$ = {ratio:g}")
ax.plot(45, phi[-1] / run.time[-1] / omega, "ko", label="the run")
ax.set(xlabel=r"angle $\alpha$ from axis 3 to ω / °", ylabel=r"$\dot\phi\,/\,\omega$", ylim=(0, 2.1))
ax.legend(ncols=2)
plt.show()
