r"""
Exercise 9: a ball with a spherical cavity
==========================================

A ball of radius :math:`R` and density :math:`\rho` has a spherical hole of radius :math:`r`, whose centre is
:math:`\epsilon` from that of the ball. What are its principal moments?

Subtract the one ball from the other. The centre of mass moves away from the hole, and Steiner's theorem (section
13.8) takes the moments across the line of centres there:

.. math::

   \begin{aligned}
   M & = \tfrac43\pi\rho (R^3 - r^3), \\
   \bar x & = -\frac{\epsilon r^3}{R^3 - r^3}, \\
   I_\parallel & = \tfrac{8}{15}\pi\rho (R^5 - r^5), \\
   I_\perp & = I_\parallel - \tfrac43\pi\rho\, \epsilon^2 \frac{r^3 R^3}{R^3 - r^3} .
   \end{aligned}

The hole makes an oblate top of a spherical one, unless it is in the middle.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

outer, inner, density = 0.10, 0.05, 2700.0

# %%
# Bodies in one frame are added and subtracted; what is known of each ball goes in as it is.


def ball(radius, x):
    """Return the mass properties of a solid ball on the x axis."""
    volume = 4 / 3 * np.pi * radius**3
    return inertia.MassProperties(density * volume, volume, [x, 0, 0], 0.4 * density * volume * radius**2 * np.eye(3))


def closed_form(offset):
    """Return centre of mass, I∥ and I⊥."""
    rest = outer**3 - inner**3
    along = 8 / 15 * np.pi * density * (outer**5 - inner**5)
    return (
        -offset * inner**3 / rest,
        along,
        along - 4 / 3 * np.pi * density * offset**2 * inner**3 * outer**3 / rest,
    )


hollow = ball(outer, 0.0) - ball(inner, 0.04)
centre, along, across = closed_form(0.04)
np.testing.assert_allclose(hollow.center_of_mass, [centre, 0, 0], rtol=1e-14)
np.testing.assert_allclose(hollow.inertia, np.diag([along, across, across]), rtol=1e-14)
print(f"centre of mass: {hollow.center_of_mass[0] * 1e3:.6f} mm")
print(f"closed form:    {centre * 1e3:.6f} mm")
print("moments:", hollow.principal_moments, "kg m²,", hollow.principal.kind)
print(f"along:  {along:.8f} kg m², closed form")
print(f"across: {across:.8f} kg m², closed form")

# %%
# **To look at**: the hole touches the surface at :math:`\epsilon = R - r`. The moment along the line does not care
# where it is, the other two fall with the square of the offset; the dots are the toolkit's.
#
# **To try**: fill the hole with lead.
fig, (left, right) = plt.subplots(1, 2, figsize=(6.4, 3.4), width_ratios=(1, 1.3))
left.add_patch(plt.Circle((0, 0), 1e3 * outer, color="C0", alpha=0.35))
left.add_patch(plt.Circle((40, 0), 1e3 * inner, color="white"))
left.plot(0, 0, "k+", markersize=10, label="middle of the ball")
left.plot(1e3 * centre, 0, "C1o", label="centre of mass")
left.set(aspect="equal", xlim=(-115, 115), ylim=(-115, 175), xlabel="x / mm", ylabel="y / mm")
left.legend(fontsize="small", loc="upper center")
offsets = np.linspace(0, outer - inner, 51)
_, along, across = closed_form(offsets)
right.plot(1e3 * offsets, 0 * offsets + 1e3 * along, label="along the line of centres")
right.plot(1e3 * offsets, 1e3 * across, label="across it")
for offset in offsets[5::10]:
    result = ball(outer, 0.0) - ball(inner, offset)
    np.testing.assert_allclose(np.diag(result.inertia)[:2], closed_form(offset)[1:], rtol=1e-14)
    right.plot([1e3 * offset] * 2, 1e3 * np.diag(result.inertia)[:2], "k.")
right.set(xlabel=r"offset $\epsilon$ / mm", ylabel="moment / g m²")
right.legend()
plt.show()
