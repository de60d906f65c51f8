r"""
13.21 The free asymmetric top
=============================

Two things stay while a free body tumbles, and in the body both are surfaces for the tip of :math:`\mathbf L` (§ 13.21):

.. math::

   L_1^2 + L_2^2 + L_3^2 = L^2 \ \text{(a sphere),}

.. math::

   \frac{L_1^2}{2 I_1} + \frac{L_2^2}{2 I_2} + \frac{L_3^2}{2 I_3} = T \ \text{(an ellipsoid).}

The tip runs along the curve in which they meet; seen in terms of :math:`{\boldsymbol\omega}` it is called the polhode.
The surfaces meet for :math:`L^2/2I_3 \le T \le L^2/2I_1` only. At :math:`2 T I_2 = L^2` they touch at the ends of axis
2, and two curves cross there: the separatrix.
"""

# %%
# A body with moments 1, 2, 3 and :math:`{\boldsymbol\omega} = (1, 1, 1)`: :math:`L^2 = 14` and :math:`2T = 6`. As
# :math:`2 T I_2 = 12 < 14`, the curve closes about axis 3.

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments = np.array([1.0, 2.0, 3.0])  # kg m²


def follow(angular_velocity, duration):
    """Follow the body, free."""
    scene = {
        "body": {"principal_moments": moments},
        "start": {"angular_velocity": angular_velocity},
        "run": {"duration": duration},
    }
    return inertia.simulate(inertia.Scene.from_dict(scene))


run = follow([1.0, 1.0, 1.0], 20.0)
momentum = run.angular_velocity * moments  # kg m²/s
np.testing.assert_allclose(np.sum(momentum**2, axis=1), 14, rtol=1e-13)
np.testing.assert_allclose(np.sum(momentum**2 / (2 * moments), axis=1), 3, rtol=1e-13)
least, most = inertia.energy_bounds(moments, np.sqrt(14))
print(f"T = 3 J, between L²/2I₃ = {least:.4f} J and L²/2I₁ = {most:.4f} J")
np.testing.assert_allclose([least, most], [14 / 6, 14 / 2], rtol=1e-14)

# %%
# Once round takes :math:`4 K(m)/\lambda`, with
#
# .. math::
#
#    \lambda^2 = \frac{(I_3 - I_2)(L^2 - 2 T I_1)}{I_1 I_2 I_3},
#
# .. math::
#
#    m = \frac{(I_2 - I_1)(2 T I_3 - L^2)}{(I_3 - I_2)(L^2 - 2 T I_1)} .
#
# The complete elliptic integral :math:`K(m)` is :math:`\pi/2` over the arithmetic-geometric mean of 1 and
# :math:`\sqrt{1 - m}`.

rate = np.sqrt((3 - 2) * (14 - 6 * 1) / (1 * 2 * 3))
m = (2 - 1) * (6 * 3 - 14) / ((3 - 2) * (14 - 6 * 1))
a, b = 1.0, np.sqrt(1 - m)
for _ in range(6):
    a, b = (a + b) / 2, np.sqrt(a * b)
expected = 4 * (np.pi / (2 * a)) / rate
period = inertia.polhode_period(moments, [1.0, 1.0, 1.0])
print(f"period of the polhode: {period:.12f} s")
print(f"by the mean:           {expected:.12f} s")
assert abs(period - expected) < 1e-13 * expected
np.testing.assert_allclose(run.at(expected).angular_velocity[0], [1, 1, 1], atol=1e-12)

# %%
# On the separatrix the motion ends, and has a closed form without elliptic functions: for
# :math:`{\boldsymbol\omega} = w (\sqrt3, 0, 1)`, at which :math:`2 T I_2 = L^2`, it is
# :math:`w (\sqrt3\, \mathrm{sech}\, wt, \sqrt3\, \tanh wt, \mathrm{sech}\, wt)`: a last turn towards axis 2, for ever.

w = 2.0  # rad/s
last = follow([w * np.sqrt(3), 0.0, w], 2.5)
wt = w * last.time
closed_form = w * np.stack([np.sqrt(3) / np.cosh(wt), np.sqrt(3) * np.tanh(wt), 1 / np.cosh(wt)], axis=1)
error = np.abs(last.angular_velocity - closed_form).max()
print(f"on the separatrix: within {error:.0e} rad/s of sech and tanh")
print("(√3 is known to 1e-16, and that grows by e⁵ = 148)")
assert error < 1e-13

# %%
# The library draws the momentum sphere. Every curve is a motion with the same :math:`L` and another energy: the run
# goes round axis 3, those beyond the separatrix round axis 1.
#
# **To try**: draw ``follow([1.0, 2.0, 0.1], 20.0)``: with more energy for its :math:`L` the path has changed sides.

fig, ax = plt.subplots(figsize=(6.4, 5.4))
run.plot("momentum sphere", ax=ax)
plt.show()
