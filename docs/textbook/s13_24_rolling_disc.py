r"""
13.24 The rolling wheel
=======================

A disc rolls on its rim without slipping. The constraint ties velocities, not positions: the disc can get anywhere, but
not along any path (it is non-holonomic). Gravity, and the force of the plane at the point of contact, act on it. In
Euler angles, :math:`\theta` being the tilt of the disc's axis from the vertical, the first of the section's three
equations (13.199) reads

.. math::

   \begin{aligned}
   & (I_1 + M R^2)\, \ddot\theta \\
   & + (I_3 + M R^2)\, \dot\phi\, \sin\theta\, (\dot\phi\, \cos\theta + \dot\psi) \\
   & - I_1 \dot\phi^2\, \sin\theta\, \cos\theta = - M g R\, \cos\theta .
   \end{aligned}
"""

# %%
# A thin disc of 2 kg and 0.5 m radius: :math:`I_3 = \tfrac{1}{2} M R^2`, and half of that across. With
# :math:`\ddot\theta = 0` the equation tells the spin at which it rolls in a circle, here leaning by 30° and turning at
# 3 rad/s.

import matplotlib.pyplot as plt
import numpy as np

import inertia

g, M, R = 9.80665, 2.0, 0.5
I3 = M * R**2 / 2
I1 = I3 / 2


def roll(angular_velocity, theta, duration, samples=1001):
    """Let the disc roll."""
    scene = {
        "body": {"principal_moments": [I1, I1, I3], "mass": M},
        "start": {
            "angular_velocity": angular_velocity,
            "frame": "part",
            "attitude": inertia.euler_angles.from_angles([0.0, theta, 0.0]),
        },
        "constraint": {"kind": "rolling", "radius": R},
        "load": [{"kind": "gravity"}],
        "run": {"duration": duration, "samples": samples},
    }
    return inertia.simulate(inertia.Scene.from_dict(scene))


theta, rate = np.radians(60), 3.0
s, c = np.sin(theta), np.cos(theta)
omega3 = (I1 * rate**2 * s * c - M * g * R * c) / ((I3 + M * R**2) * rate * s)
circle = roll([0, rate * s, omega3], theta, 4.0)
np.testing.assert_allclose(circle.quantities["theta"], theta, atol=1e-10)
np.testing.assert_allclose(circle.quantities["phi"] - circle.quantities["phi"][0], rate * circle.time, atol=1e-9)

# %%
# The contact goes round a circle of :math:`R |\dot\psi| / \dot\phi`. The plane carries the weight and pulls the disc
# inwards: :math:`M \dot\phi^2` times the radius on which the centre of mass goes round.

radius = R * abs(omega3 - rate * c) / rate
force = circle.quantities["contact force"]
inwards = M * rate**2 * abs(radius - R * c)
print(f"the contact describes a circle of {radius:.6f} m")
print(f"the plane pushes with {inwards:.6f} N inwards")
np.testing.assert_allclose(force[:, 2], M * g, rtol=1e-10)
np.testing.assert_allclose(np.hypot(*force[:, :2].T), inwards, rtol=1e-9)
contact = circle.quantities["contact"][:, :2]
a, b = np.linalg.lstsq(np.c_[2 * contact, np.ones(len(contact))], np.sum(contact**2, axis=1))[0][:2]
np.testing.assert_allclose(np.hypot(*(contact - [a, b]).T), radius, rtol=1e-9)

# %%
# Started with a nod it wobbles along. The point of the rim that touches is at rest, so that the centre of mass, at
# :math:`-\mathbf r` from the contact, moves at :math:`\mathbf v = -{\boldsymbol\omega} \times \mathbf r`. If that holds
# at every instant, its integral by Gauss's quadrature is the way that the centre of mass has gone.

wobbly = roll([2.0, 1.0, -5.0], 1.1, 6.0)
nodes, weights = np.polynomial.legendre.leggauss(160)
at = wobbly.at(3.0 + 3.0 * nodes)
spin = inertia.quaternion.to_space(at.attitude, at.angular_velocity)
end = wobbly.position[0] + 3.0 * weights @ np.cross(at.quantities["contact"] - at.position, spin)
print(f"after 6 s its centre is at {wobbly.position[-1].round(6)} m")
print(f"by quadrature of the constraint {end.round(6)} m")
np.testing.assert_allclose(wobbly.position[-1], end, atol=1e-8)
np.testing.assert_allclose(wobbly.energy, wobbly.energy[0], rtol=1e-11)
x, y, z = wobbly.quantities["contact force"].T
print(f"not to slip it needs a coefficient of friction of {(np.hypot(x, y) / z).max():.3f}")
least = inertia.straight_rolling_threshold(inertia.RollingBody(M, I1, I3, R))
print(f"straight on it stays up from {least:.4f} rad/s on, √(g/3R) = {np.sqrt(g / (3 * R)):.4f}")
assert abs(least - np.sqrt(g / (3 * R))) < 1e-12

# %%
# Left, the track of the contact and of the centre of mass, seen from above. Right, the force of the plane: it swings
# with each nod. The ratio of friction to what carries the disc is what tyre and road must provide, or it slips.
#
# **To try**: start without a nod, ``[0.0, 1.0, -5.0]``, and the track comes close to a circle.

fig, (left, right) = plt.subplots(1, 2, figsize=(6.4, 4), layout="constrained")
left.plot(*wobbly.quantities["contact"][:, :2].T, label="contact")
left.plot(*wobbly.position[:, :2].T, label="centre of mass")
left.set(aspect="equal", xlabel="x, m", ylabel="y, m", title="From above")
left.legend(fontsize="small")
right.plot(wobbly.time, z, label="upwards")
right.plot(wobbly.time, np.hypot(x, y), label="friction")
right.axhline(M * g, color="0.5", linestyle=":", label="weight")
right.set(xlabel="time, s", ylabel="force of the plane, N", ylim=(0, 44), title="What holds it")
right.legend(fontsize="small")
plt.show()
