r"""
Exercise 5: the least spin of a steady precession
=================================================

A heavy symmetric top (mass :math:`m`, centre of mass :math:`h` from the fixed point, :math:`I_1 = I_2 \neq I_3`)
leans at an angle :math:`\theta` and precesses steadily about the vertical. What is the least spin about its own axis
that allows this?

At the steady rate :math:`\Omega` the axis turns so that :math:`\dot{\mathbf{L}} = \Omega\hat z\times\mathbf{L}` is
the torque of gravity, :math:`m g h\sin\theta` (section 13.23):

.. math:: I_1 \cos\theta\; \Omega^2 - I_3 \omega_3\, \Omega + m g h = 0,

.. math:: \omega_3 = \dot\psi + \Omega\cos\theta .

Its roots, the slow and the fast precession, are real from :math:`(I_3 \omega_3)^2 = 4 m g h\, I_1 \cos\theta` on.
Here :math:`\omega_3` is the whole of :math:`\boldsymbol\omega` along the axis. If the spin is meant as seen from the
frame that precesses, :math:`\dot\psi`, then :math:`I_1` makes way for :math:`I_1 - I_3`:
:math:`(I_3 \dot\psi)^2 = 4 m g h\, (I_1 - I_3) \cos\theta` for a slender top, and a flat one (:math:`I_3 > I_1`) has
no least :math:`\dot\psi` at all.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

I1, I3, mgh, theta = 2.0, 1.0, 4.0, np.radians(60)
lean = inertia.euler_angles.from_angles([0, theta, 0])


def top(spin):
    """Return a top that leans by θ with ω3 = spin."""
    return inertia.HeavyTop.of_state((I1, I3), mgh, lean, [0, 0, spin])


# %%
# The least :math:`\omega_3`; below it the toolkit says that there is no steady precession.
least = top(1.0).least_p_psi(theta) / I3
closed_form = np.sqrt(4 * mgh * I1 * np.cos(theta)) / I3
assert abs(least - closed_form) < 1e-14
print(f"least ω₃:    {least:.9f} rad/s")
print(f"closed form: {closed_form:.9f} rad/s")
try:
    top(0.99 * least).steady_precession(theta)
except inertia.GeometryError as error:
    print("at 1 % less:", *str(error).split(": "), sep="\n  ")

# %%
# Started at either rate, the top keeps its tilt: ω is that of φ̇ = Ω, θ̇ = 0 and the ψ̇ that goes with it.
spins = np.append(least * (1 + 1e-12), np.linspace(1.001, 1.8, 60) * least)
rates = np.array([top(spin).steady_precession(theta) for spin in spins])
for rate in rates[-1]:
    omega = inertia.euler_angles.angular_velocity([0, theta, 0], [rate, 0, spins[-1] - rate * np.cos(theta)])
    time = np.linspace(0, 20, 101)
    motion = inertia.solve_heavy_top((I1, I3), mgh, lean, omega, time)
    np.testing.assert_allclose(motion.quantities["theta"], theta, atol=1e-12)
    np.testing.assert_allclose(np.unwrap(motion.quantities["phi"]), rate * time, atol=1e-10)

# %%
# The least :math:`\dot\psi` among all of them, where
# :math:`(I_1 - I_3)\cos\theta\,\Omega^2 - I_3\dot\psi\,\Omega + m g h = 0` has one root.
own = spins[:, None] - rates * np.cos(theta)
least_own = np.sqrt(4 * mgh * (I1 - I3) * np.cos(theta)) / I3
rate = np.sqrt(mgh / ((I1 - I3) * np.cos(theta)))  # where it is reached
spin = least_own + rate * np.cos(theta)
np.testing.assert_allclose(np.min(np.abs(np.array(top(spin).steady_precession(theta)) - rate)), 0, atol=1e-12)
assert own.min() >= least_own
print(f"least ψ':    {least_own:.9f} rad/s,")
print(f"at Ω = {rate:.6f} rad/s and ω₃ = {spin:.6f} rad/s")

# %%
# **To look at**: slow and fast precession meet where :math:`\omega_3` is least. Plotted against :math:`\dot\psi` the
# same states turn back further to the left.
#
# **To try**: :math:`I_3 > I_1`, or a top that hangs (:math:`m g h < 0`).
fig, ax = plt.subplots(figsize=(6.4, 4))
for k, (values, name) in enumerate(((np.stack([spins, spins], axis=1), r"\omega_3"), (own, r"\dot\psi"))):
    ax.plot(values[:, 0], rates[:, 0], f"C{k}", label=f"against ${name}$, slow")
    ax.plot(values[:, 1], rates[:, 1], f"C{k}--", label=f"against ${name}$, fast")
ax.plot([closed_form, least_own], [closed_form * I3 / (2 * I1 * np.cos(theta)), rate], "ko", label="least, closed form")
ax.set(xlabel="spin / (rad/s)", ylabel=r"precession $\Omega$ / (rad/s)", xlim=(0, 7.4), ylim=(0, 7))
ax.legend(fontsize="small", loc="upper left")
plt.show()
