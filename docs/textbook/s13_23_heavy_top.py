r"""
13.23 The heavy symmetric top
=============================

A top stands on its tip, its centre of mass a height :math:`h` up the axis. Gravity exerts no torque about the vertical
nor about the axis, so that :math:`p_\phi` and :math:`p_\psi = I_3 \omega_3` stay, besides the energy. What is left is
a single angle in an effective potential (§ 13.23):

.. math::

   E - \frac{p_\psi^2}{2 I_3} = \tfrac{1}{2} I_1 \dot\theta^2 + V(\theta),

.. math::

   V(\theta) = \frac{(p_\phi - p_\psi\, \cos\theta)^2}{2 I_1\, \sin^2\theta} + M g h\, \cos\theta .

The axis nods between two tilts as it goes round. :math:`I_1` and :math:`I_3` are moments about the *tip*.
"""

# %%
# A top of 100 g, :math:`h` = 4 cm, that spins at 120 rad/s. Steiner's theorem adds :math:`M h^2` to the moments across
# the axis; the library does so by itself, from where the top is held. Set down 0.5 rad off the vertical, with its axis
# at rest, it starts to fall; with :math:`a = p_\psi^2/(2 I_1 M g h)` it must turn back at
# :math:`\cos\theta_2 = \tfrac{1}{2} \bigl(a - \sqrt{a^2 - 4 a\, \cos\theta_1 + 4}\bigr)`.

import matplotlib.pyplot as plt
import numpy as np

import inertia

gravity, mass, height = 9.80665, 0.1, 0.04
I1, I3, mgh = 2e-4 + mass * height**2, 1.25e-4, mass * gravity * height


def follow(angular_velocity, tilt, duration=1.0, accuracy=1e-10):
    """Follow the top from a tilt."""
    scene = {
        "body": {"principal_moments": [2e-4, 2e-4, 1.25e-4], "mass": mass, "center_of_mass": [0, 0, height]},
        "start": {"angular_velocity": angular_velocity, "attitude": inertia.euler_angles.from_angles([0, tilt, 0])},
        "constraint": {"kind": "fixed_point"},
        "load": [{"kind": "gravity"}],
        "run": {"duration": duration, "accuracy": accuracy},
    }
    return inertia.simulate(inertia.Scene.from_dict(scene))


tilt, spin = 0.5, 120.0  # rad, rad/s
cusp = follow([0, 0, spin], tilt)
a = (I3 * spin) ** 2 / (2 * I1 * mgh)
lowest = np.arccos((a - np.sqrt(a * a - 4 * a * np.cos(tilt) + 4)) / 2)
turning = cusp.quantities["turning theta"]
print(f"set down at {tilt} rad it nods down to {turning[1]:.12f} rad")
print(f"by the formula, to {lowest:.12f} rad")
np.testing.assert_allclose(turning, [tilt, lowest], rtol=1e-12)
np.testing.assert_allclose(cusp.canonical_momenta()[:, 2], I3 * spin, rtol=1e-12)
np.testing.assert_allclose(cusp.canonical_momenta()[:, 0], I3 * spin * np.cos(tilt), rtol=1e-12)

# %%
# There are two rates at which it precesses without nodding, the roots of :math:`I_1\, \cos\theta\, \dot\phi^2 - p_\psi
# \dot\phi + M g h = 0`. The slow one is what one usually sees.

root = np.sqrt(1 - 4 * mgh * I1 * np.cos(tilt) / (I3 * spin) ** 2)
for name, sign in (("slow", -1), ("fast", 1)):
    rate = I3 * spin / (2 * I1 * np.cos(tilt)) * (1 + sign * root)
    run = follow([0, rate * np.sin(tilt), spin], tilt)
    phi, theta, _ = run.euler_angles().T
    np.testing.assert_allclose(theta, tilt, atol=1e-10)
    np.testing.assert_allclose(phi - phi[0], rate * run.time, atol=1e-9)
    print(f"{name} steady precession: {rate:.6f} rad/s; θ strays by {np.abs(theta - tilt).max():.0e} rad")

# %%
# Upright it sleeps if :math:`p_\psi^2 \ge 4 M g h I_1`. Below, a slight tilt grows as :math:`e^{\lambda t}` with
# :math:`\lambda = \sqrt{4 M g h I_1 - p_\psi^2} / (2 I_1)`, until the top falls far over, and rises again.

sleeps_from = np.sqrt(4 * mgh * I1) / I3  # rad/s
growth = np.sqrt(4 * mgh * I1 - (I3 * 0.6 * sleeps_from) ** 2) / (2 * I1)
asleep, awake = (follow([0, 0, share * sleeps_from], 1e-3, 2.0, 1e-8) for share in (1.1, 0.6))
early = awake.at([0.35, 0.45]).quantities["theta"]
pace = np.log(early[1] / early[0]) / 0.1  # 1/s
print(f"it sleeps from {sleeps_from:.3f} rad/s on")
print(f"at 0.6 of that a tilt grows at {pace:.3f} 1/s; by the formula {growth:.3f} 1/s")
assert abs(pace / growth - 1) < 2e-3
assert asleep.quantities["theta"].max() < 4e-3

# %%
# The path of the axis on the unit sphere, seen from above, depends on the start. Pushed backwards it loops, let go it
# stops in cusps, pushed forwards it runs in waves.
#
# **To try**: at which push does the wave become a circle? (It is printed above.)

fig, axes = plt.subplots(2, 2, figsize=(6.4, 6.6), layout="constrained")
for ax, push, kind in zip(axes.flat, (-3.0, 0.0, 1.6), ("loops", "cusp", "no reversal"), strict=False):
    run = follow([0, push * np.sin(tilt), spin], tilt)
    top = inertia.HeavyTop.of_state((I1, I3), mgh, run.attitude[0], run.angular_velocity[0])
    assert top.kind == kind
    x, y, _ = inertia.quaternion.to_space(run.attitude, [0, 0, 1]).T
    ax.plot(x, y)
    for edge in np.sin(top.turning_angles):
        ax.add_patch(plt.Circle((0, 0), edge, fill=False, linestyle=":", color="0.5"))
    ax.set(aspect="equal", xlim=(-0.75, 0.75), ylim=(-0.75, 0.75), title=f"push {push:g} rad/s: {kind}")
    ax.set(xlabel="x of the axis", ylabel="y of the axis")
for run, label in ((asleep, "1.1 of the limit"), (awake, "0.6 of the limit")):
    axes[1, 1].plot(run.time, np.degrees(run.quantities["theta"]), label=label)
axes[1, 1].set(xlabel="time, s", ylabel="tilt, degrees", ylim=(-5, 150), title="Asleep and awake")
axes[1, 1].legend(fontsize="small", loc="upper left")
plt.show()
