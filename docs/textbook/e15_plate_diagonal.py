r"""
Exercise 15: a plate about its diagonal
=======================================

What torque does it take to turn a thin rectangular plate (edges :math:`a`, :math:`b`, mass :math:`M`) about its
diagonal at a steady :math:`\omega`? What happens for :math:`a = b`?

Along the edges the moments are :math:`\tfrac1{12} M b^2` and :math:`\tfrac1{12} M a^2`, and
:math:`\boldsymbol\omega = \omega (a, b, 0)/\sqrt{a^2 + b^2}`. Then :math:`\boldsymbol\omega\times\mathbf{L}` is along
the normal of the plate, and goes round with it:

.. math:: |\mathbf{N}| = \frac{M \omega^2\, a b\, |a^2 - b^2|}{12\, (a^2 + b^2)} .

A square has equal moments along its edges, so that *every* axis in its plane is a principal one, its diagonals too:
no torque. The centre of mass is on the axle in any case; what is out of balance is dynamic (section 13.25).
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

omega, areal_density, width = 11.0, 4.0, 1.0


def turned(length):
    """Return the run, over one turn, of a plate on an axle along its diagonal."""
    plate = inertia.lamina([[0, 0], [length, 0], [length, width], [0, width]], areal_density)
    axle = np.array([length, width, 0]) / np.hypot(length, width)
    hinge = inertia.Constraint("hinge", axis=axle, drive="constant_speed")
    start, settings = inertia.Start(omega * axle, frame="part"), inertia.Settings(2 * np.pi / omega, samples=9)
    return inertia.simulate(inertia.Scene(inertia.SceneBody.of(plate), start, settings, hinge))


def closed_form(length):
    """Return the torque in N m."""
    mass = areal_density * length * width
    return mass * omega**2 * length * width * abs(length**2 - width**2) / (12 * (length**2 + width**2))


# %%
# The run has the force and the torque by which the axle holds the plate. The centre of mass is on the axle: no force.
run = turned(2.0)
torque = np.linalg.norm(run.quantities["reaction torque"], axis=1)
np.testing.assert_allclose(torque, closed_form(2.0), rtol=1e-13)
np.testing.assert_allclose(run.quantities["reaction force"], 0, atol=1e-12)
normal = inertia.quaternion.to_space(run.attitude, [0, 0, 1])
np.testing.assert_allclose(np.abs(np.sum(run.quantities["reaction torque"] * normal, axis=1)), torque, rtol=1e-13)
print(f"2 m × 1 m:   {torque[0]:.9f} N m along the normal")
print(f"closed form: {closed_form(2.0):.9f} N m")
print(f"a square:    {np.linalg.norm(turned(1.0).quantities['reaction torque'], axis=1).max():.1e} N m")

# %%
# **To look at**: plates of one mass per area and one width. The torque vanishes for the square, and at both sides of
# it changes its sense, which the magnitude does not show.
#
# **To try**: the same for one mass; is there a worst plate?
lengths = np.linspace(0.25, 2.0, 8)
dots = [np.linalg.norm(turned(length).quantities["reaction torque"][0]) for length in lengths]
np.testing.assert_allclose(dots, [closed_form(length) for length in lengths], rtol=1e-12, atol=1e-13)
fine = np.linspace(0.01, 2.1, 200)
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(fine, [closed_form(length) for length in fine], label="closed form")
ax.plot(lengths, dots, "o", color="C1", label="runs")
ax.set(xlabel="length a / m, with b = 1 m", ylabel="torque / N m")
ax.legend()
plt.show()
