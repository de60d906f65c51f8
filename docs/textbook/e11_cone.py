r"""
Exercise 11: a cone about its apex and its centre of mass
=========================================================

What is the inertia tensor of a uniform cone of mass :math:`M`, height :math:`h` and base radius :math:`R` about its
apex, and what are its principal moments about its centre of mass?

Sliced into discs of radius :math:`R z/h` at the distance :math:`z` from the apex, it has about the apex

.. math:: I_1 = I_2 = \tfrac35 M \left(h^2 + \tfrac14 R^2\right), \qquad I_3 = \tfrac{3}{10} M R^2 .

The centre of mass is :math:`\tfrac34 h` from the apex, and Steiner's theorem (section 13.8) takes
:math:`M (\tfrac34 h)^2` off the first two there: :math:`I_1 = I_2 = \tfrac{3}{20} M (R^2 + \tfrac14 h^2)`.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

radius, height, density = 0.1, 0.12, 2700.0

# %%
# A pyramid of 24, 48 and 96 sides, its apex at the origin and its base above; Richardson's rule makes it round.


def pyramid(sides):
    """Return the mass properties of a cone with a base of many corners."""
    turn = 2 * np.pi * np.arange(sides) / sides
    base = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(sides, height)], axis=1)
    corner = np.arange(sides)
    after = np.roll(corner, -1)
    apex, middle = np.full(sides, sides), np.full(sides, sides + 1)
    faces = np.concatenate([np.stack([apex, after, corner], axis=1), np.stack([middle, corner, after], axis=1)])
    return inertia.mass_properties(inertia.Part.from_arrays([*base, [0, 0, 0], [0, 0, height]], faces), density)


rows = np.array([[body.mass, *np.diag(body.inertia)] for body in map(pyramid, (24, 48, 96))])
for order in (2, 4):
    rows = (2**order * rows[1:] - rows[:-1]) / (2**order - 1)
mass, *moments = rows[0]
i1, i3 = 3 / 20 * mass * (radius**2 + height**2 / 4), 3 / 10 * mass * radius**2
assert abs(mass / (np.pi * radius**2 * height * density / 3) - 1) < 1e-7
np.testing.assert_allclose(moments, [i1, i1, i3], rtol=1e-7)
centre = pyramid(24).center_of_mass
np.testing.assert_allclose(centre, [0, 0, 0.75 * height], atol=1e-15)
print(f"centre of mass: {centre[2]:.9f} m from the apex")
print(f"closed form:    {0.75 * height:.9f} m")

# %%
# About the apex: ``steiner`` from the centre of mass.
about_apex = inertia.steiner(np.diag(moments), mass, centre, about=centre, to=[0, 0, 0])
closed_form = 3 / 5 * mass * (height**2 + radius**2 / 4)
np.testing.assert_allclose(about_apex, np.diag([closed_form, closed_form, i3]), rtol=1e-7, atol=1e-12)
print(f"I₁ about the centre of mass: {moments[0]:.9f} kg m²")
print(f"closed form:                 {i1:.9f} kg m²")
print(f"I₁ about the apex:           {about_apex[0, 0]:.9f} kg m²")
print(f"closed form:                 {closed_form:.9f} kg m²")

# %%
# **To look at**: the transverse moment is least about the centre of mass, and grows by the square of the distance
# from it. Where it meets the dotted line all three moments are equal: held there, the cone is a ball to any torque.
#
# **To try**: the cone for which that is the centre of mass itself, :math:`R = \tfrac12 h`.
place = np.linspace(-0.02, 1.1 * height, 60)
across = [inertia.steiner(np.diag(moments), mass, centre, about=centre, to=[0, 0, z])[0, 0] for z in place]
np.testing.assert_allclose(across, i1 + mass * (place - 0.75 * height) ** 2, rtol=1e-7)
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(1e3 * place, 1e3 * np.array(across), label="$I_1 = I_2$ about a point on the axis")
ax.axhline(1e3 * i3, color="C2", linestyle=":", label="$I_3$")
ax.plot(0, 1e3 * closed_form, "o", color="C1", label="apex, closed form")
ax.plot(750 * height, 1e3 * i1, "s", color="C1", label="centre of mass, closed form")
ax.set(xlabel="distance of the point from the apex / mm", ylabel="moment / g m²", ylim=(0, None))
ax.legend()
plt.show()
