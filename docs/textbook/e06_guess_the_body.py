r"""
Exercise 6: which body has this tensor?
=======================================

A body with its centre of mass at the origin has the tensor

.. math:: \mathbf{I} = I \begin{pmatrix} \tfrac12 & -\tfrac12 & 0 \\ -\tfrac12 & \tfrac12 & 0 \\ 0 & 0 & 1
   \end{pmatrix} .

What are its principal moments and axes, what is it, and what does it take to turn it about
:math:`(\hat x + \hat z)/\sqrt2` and about :math:`(\hat x - \hat y)/\sqrt2`?

The eigenvalues are 0, :math:`I`, :math:`I`: all mass lies on the line :math:`(1, 1, 0)`, a thin rod (section 13.10).
About :math:`(\hat x - \hat y)/\sqrt2`, across the rod, :math:`\mathbf{L} = I\boldsymbol\omega` and the energy is
:math:`\tfrac12 I\omega^2`: nothing has to hold it. About :math:`(\hat x + \hat z)/\sqrt2`

.. math:: \mathbf{L} = \frac{I \omega}{\sqrt2} \begin{pmatrix} \tfrac12 \\ -\tfrac12 \\ 1 \end{pmatrix},

.. math:: \mathbf{N} = \boldsymbol\omega\times\mathbf{L} = \frac{I \omega^2}{4} \begin{pmatrix} 1 \\ -1 \\ -1
   \end{pmatrix},

:math:`\mathbf{L}` is 30° off :math:`\boldsymbol\omega`, and the body turns about this axis only if it is made to.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

moment, omega = 3.0, 2.0
tensor = moment * np.array([[0.5, -0.5, 0], [-0.5, 0.5, 0], [0, 0, 1]])

# %%
# **(a)** Principal moments and axes. The class ``rotor`` is that of bodies without a moment about one axis.
result = inertia.principal(tensor)
np.testing.assert_allclose(result.moments, [0, moment, moment], atol=1e-14)
np.testing.assert_allclose(result.axes[:, 0], np.array([1, 1, 0]) / np.sqrt(2), atol=1e-15)
print(result.kind, "with moments", np.abs(result.moments.round(12)))
print("axis 1 along", result.axes[:, 0])
rod = inertia.wire(np.outer([-1, 1], result.axes[:, 0]) * np.sqrt(3 * moment / 2), 2 / np.sqrt(6 * moment))
np.testing.assert_allclose(rod.inertia, tensor, atol=1e-14)  # a rod of 2 kg that is the body

# %%
# **(b)** Along its principal axes, the columns of :math:`R`, the tensor is diagonal.
np.testing.assert_allclose(inertia.reexpress(tensor, result.axes), np.diag([0, moment, moment]), atol=1e-14)

# %%
# **(c)–(f)** Angular momentum, torque and energy about both axes.
for name, axis in (("x + z", [1, 0, 1]), ("x - y", [1, -1, 0])):
    spin = omega * np.array(axis) / np.sqrt(2)
    momentum, torque = tensor @ spin, inertia.inverse_dynamics(tensor, spin, [0, 0, 0])
    lean = np.degrees(inertia.momentum_angle(result.moments, result.axes.T @ spin))
    print(f"about {name}: L is {lean:.4f}° off ω,")
    print(f"  torque {np.linalg.norm(torque):.6f} N m, energy {spin @ momentum / 2:.6f} J")
    if name == "x + z":
        np.testing.assert_allclose(momentum, moment * omega / np.sqrt(2) * np.array([0.5, -0.5, 1]), atol=1e-14)
        np.testing.assert_allclose(torque, moment * omega**2 / 4 * np.array([1, -1, -1]), atol=1e-14)
        assert abs(lean - 30) < 1e-12
    else:
        np.testing.assert_allclose(momentum, moment * spin, atol=1e-14)
        np.testing.assert_allclose(torque, 0, atol=1e-14)
        assert abs(spin @ momentum / 2 - moment * omega**2 / 2) < 1e-14

# %%
# **To look at**: for an axis at an angle :math:`\beta` to the rod the torque is
# :math:`\tfrac12 I \omega^2 \sin 2\beta`: the axis (1, 0, 1) is at 60°, (1, −1, 0) at 90°.
#
# **To try**: the angle of greatest torque, and exercise 4, the same body on an axle.
beta = np.linspace(0, np.pi / 2, 91)
along, across = result.axes[:, 0], np.array([1, -1, 0]) / np.sqrt(2)
spins = omega * (np.outer(np.cos(beta), along) + np.outer(np.sin(beta), across))
torque = np.linalg.norm(inertia.inverse_dynamics(tensor, spins, np.zeros_like(spins)), axis=1)
np.testing.assert_allclose(torque, moment * omega**2 * np.sin(2 * beta) / 2, atol=1e-13)
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(np.degrees(beta), torque)
ax.plot(60, np.sqrt(3) / 4 * moment * omega**2, "o", color="C1", label="about x + z")
ax.plot(90, 0, "s", color="C2", label="about x − y")
ax.set(xlabel="angle from the rod to ω / °", ylabel="torque to keep it turning / N m", xlim=(0, 92), ylim=(-0.3, 6.6))
ax.legend()
plt.show()
