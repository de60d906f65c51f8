r"""
13.20 The free symmetric top
============================

With :math:`I_1 = I_2` Euler's equations are linear (§ 13.20). :math:`\omega_3` stays, and :math:`{\boldsymbol\omega}`
goes round axis 3 *in the body* at :math:`\Omega = (I_3 - I_1)\, \omega_3 / I_1`. *In space* axis 3 goes round
:math:`\mathbf L`, tilted by :math:`\theta` with :math:`\tan\theta = (I_1/I_3)\, \tan\alpha`, at

.. math::

   \dot\phi = \frac{L}{I_1} = \omega \sqrt{1 + \bigl( (I_3/I_1)^2 - 1 \bigr)\, \cos^2\alpha} ,

where :math:`\alpha` is the angle between :math:`{\boldsymbol\omega}` and axis 3. Picture it as a cone fixed in the body
that rolls on a cone fixed in space: outside it for a rod, and with its inside around it for a plate.
"""

# %%
# A rod and a plate, each turning at 2 rad/s, 0.6 rad off its axis. With :math:`\mathbf L` upright the Euler angles are
# the motion itself: :math:`\phi = \dot\phi t`, :math:`\theta` constant, :math:`\psi = -\Omega t`.

import matplotlib.pyplot as plt
import numpy as np

import inertia

alpha, spin = 0.6, 2.0  # rad, rad/s


def upright(across, along, alpha, spin, duration):
    """Follow a symmetric body whose angular momentum points straight up."""
    theta = np.arctan2(across * np.sin(alpha), along * np.cos(alpha))
    scene = {
        "body": {"principal_moments": [across, across, along]},
        "start": {
            "angular_velocity": [0.0, spin * np.sin(alpha), spin * np.cos(alpha)],
            "attitude": inertia.euler_angles.from_angles([0.0, theta, 0.0]),
        },
        "run": {"duration": duration},
    }
    return theta, inertia.simulate(inertia.Scene.from_dict(scene))


for name, along in (("rod", 0.25), ("plate", 2.0)):
    theta, run = upright(1.0, along, alpha, spin, 10.0)
    precession = spin * np.sqrt(1 + (along**2 - 1) * np.cos(alpha) ** 2)
    in_body = (along - 1) * spin * np.cos(alpha)
    phi, tilt, psi = run.euler_angles().T
    np.testing.assert_allclose(tilt, theta, atol=1e-12)
    np.testing.assert_allclose(phi - phi[0], precession * run.time, atol=1e-12)
    np.testing.assert_allclose(psi - psi[0], -in_body * run.time, atol=1e-12)
    print(f"{name}: α = {alpha} rad, θ = {theta:.4f} rad")
    print(f"    in the body {in_body:+.4f} rad/s, in space {precession:.4f} rad/s")

# %%
# The cones, cut through the plane in which :math:`\mathbf L`, :math:`{\boldsymbol\omega}` and axis 3 lie.
# :func:`inertia.cones` has the half angles.

fig, axes = plt.subplots(1, 2, figsize=(6.4, 4), layout="constrained")
for ax, (name, along) in zip(axes, (("rod", 0.25), ("plate", 2.0)), strict=True):
    cones = inertia.cones([1.0, 1.0, along], [0.0, spin * np.sin(alpha), spin * np.cos(alpha)])
    assert abs(cones.theta - np.arctan(np.tan(alpha) / along)) < 1e-14
    assert abs(cones.space_half_angle - abs(cones.theta - alpha)) < 1e-14
    for middle, half, colour, what in (
        (0.0, cones.space_half_angle, "C0", "space cone"),
        (cones.theta, cones.body_half_angle, "C1", "body cone"),
    ):
        edge = np.linspace(middle - half, middle + half, 31)
        ax.fill(np.r_[0, np.sin(edge)], np.r_[0, np.cos(edge)], color=colour, alpha=0.35, label=what)
    for angle, label in ((0.0, "L"), (cones.theta, "axis 3"), (cones.theta - alpha, "ω")):
        ax.annotate("", (1.2 * np.sin(angle), 1.2 * np.cos(angle)), (0, 0), arrowprops={"arrowstyle": "->"})
        ax.text(1.3 * np.sin(angle), 1.3 * np.cos(angle), label, ha="center")
    ax.set(aspect="equal", xlim=(-0.7, 1.4), ylim=(-0.3, 1.5), title=f"{name}: rolls {cones.rolling}")
    ax.set_axis_off()
fig.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
plt.show()

# %%
# Feynman watched a plate thrown up in a canteen: it wobbled as it spun, and the wobble was the faster. A flat body has
# :math:`I_3 = I_1 + I_2 = 2 I_1`; with a slight tilt the wobble is :math:`\dot\phi = L/I_1 \approx 2 \omega_3`, while
# the plate itself turns at :math:`\dot\phi + \dot\psi = \omega_3`: two wobbles to a turn. (In his book he has it the
# other way round.)
#
# **To try**: how far from two is the ratio with ``alpha`` at 0.5 rad?

_, plate = upright(1e-3, 2e-3, 1e-4, 20.0, 1.0)
phi, _, psi = plate.euler_angles().T
wobbles, turns = (phi[-1] - phi[0]) / (2 * np.pi), (phi + psi)[-1] / (2 * np.pi)
ratio = np.sqrt(1 + 3 * np.cos(1e-4) ** 2) * 20 / (20 * (np.sqrt(1 + 3 * np.cos(1e-4) ** 2) - np.cos(1e-4)))
print(f"in a second {wobbles:.4f} wobbles and {turns:.4f} turns: {wobbles / turns:.8f} to 1")
assert abs(wobbles / turns - ratio) < 1e-12
assert abs(ratio - 2) < 1e-7
