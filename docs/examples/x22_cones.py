r"""
The cones of a free top
=======================

A free symmetric body rolls a cone fixed in it on a cone fixed in space, and the two touch along :math:`\boldsymbol
\omega`. Of a flat body the body cone rolls around the space cone from inside, of a long one on its outside.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

fig, axes = plt.subplots(1, 2, figsize=(6.4, 4))
for ax, moments, title in zip(axes, ([2.0, 2.0, 1.0], [1.0, 1.0, 1.8]), ("long", "flat"), strict=True):
    omega = np.array([0.5, 0.0, 1.0])
    pair = inertia.cones(moments, omega)
    I1, _, I3 = moments

    # L is at θ from axis 3, ω at α; in space ω keeps the angle between the two
    alpha, theta = np.arctan2(omega[0], omega[2]), np.arctan2(I1 * omega[0], I3 * omega[2])
    np.testing.assert_allclose([pair.alpha, pair.theta], [alpha, theta], rtol=1e-12)
    np.testing.assert_allclose(pair.body_half_angle, alpha, rtol=1e-12)
    np.testing.assert_allclose(pair.space_half_angle, abs(alpha - theta), rtol=1e-12)
    np.testing.assert_allclose(pair.precession, np.hypot(I1 * omega[0], I3 * omega[2]) / I1, rtol=1e-12)
    print(f"{title}: it precesses at {pair.precession:.4f} rad/s, the cone rolls {pair.rolling}")

    # cut along the plane of L (upright) and axis 3, which leans by θ; ω is at θ − α from L
    for middle, half, colour, name in ((theta, alpha, "C0", "body"), (0.0, abs(theta - alpha), "C2", "space")):
        edge = np.array([middle - half, middle + half])
        ax.fill([0, *np.sin(edge)], [0, *np.cos(edge)], color=colour, alpha=0.3, label=f"{name} cone")
    for angle, colour, name in ((0.0, "C2", "L"), (theta, "C0", "axis 3"), (theta - alpha, "C1", "ω")):
        ax.annotate(name, (1.22 * np.sin(angle), 1.22 * np.cos(angle)), color=colour, ha="center", va="center")
        ax.plot([0, 1.12 * np.sin(angle)], [0, 1.12 * np.cos(angle)], color=colour, linewidth=2)
    ax.set(aspect="equal", xlim=(-0.6, 1.2), ylim=(-0.05, 1.35), title=title)
    ax.set_axis_off()

# %%
# Cut lengthwise. Try ``[1, 1, 2]`` with a small tilt: the wobble of Feynman's plate, twice as fast as its spin.

axes[1].legend(loc="lower right", fontsize="small")
plt.show()
