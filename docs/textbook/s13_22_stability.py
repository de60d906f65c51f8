r"""
13.22 Stability of free rotation
================================

Spin a body about a principal axis and disturb it slightly. Linearised, Euler's equations say (§ 13.22) that the wobble
goes round at

.. math::

   \Omega_1 = \omega \sqrt{\frac{(I_1 - I_3)(I_1 - I_2)}{I_2 I_3}} , \qquad \text{and cyclic.}

About the axes of the smallest and the greatest moment this is real: the wobble stays small. About the intermediate
axis it is imaginary: the wobble grows as :math:`e^{|\Omega_2| t}`. If the body can lose energy inside, only
the spin about the axis of the greatest moment stays stable.
"""

# %%
# A box with moments 2, 3, 4, at 6 rad/s, disturbed by a millionth of that about each axis in turn:
# :math:`\Omega_1 = \sqrt6`, :math:`\Omega_3 = 2\sqrt3`, and growth at :math:`3/\sqrt2` per second about axis 2.

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments, spin, small = [2.0, 3.0, 4.0], 6.0, 6e-6
frequencies, growth = inertia.wobble_frequencies(moments, spin), inertia.growth_rate(moments, spin)
np.testing.assert_allclose(frequencies, [np.sqrt(6), 0, np.sqrt(12)], rtol=1e-14)
assert abs(growth - 3 / np.sqrt(2)) < 1e-14
print(f"about axis 1 a wobble has {frequencies[0]:.6f} rad/s, about axis 3 {frequencies[2]:.6f} rad/s")
print(f"about axis 2 it grows at {growth:.6f} 1/s")


def follow(body, angular_velocity, duration, **more):
    """Follow a body."""
    scene = {
        "body": {"principal_moments": body},
        "start": {"angular_velocity": angular_velocity},
        "run": {"duration": duration, "samples": 501, "accuracy": 1e-7},
    }
    return inertia.simulate(inertia.Scene.from_dict(scene | more))


wobbles = []
for axis, beside, law in (
    (0, 1, lambda t: np.cos(np.sqrt(6) * t)),
    (1, 0, lambda t: np.cosh(3 / np.sqrt(2) * t)),
    (2, 1, lambda t: np.cos(np.sqrt(12) * t)),
):
    start = np.zeros(3)
    start[axis], start[beside] = spin, small
    run = follow(moments, start, 4.0)
    wobble = run.angular_velocity[:, beside] / small
    np.testing.assert_allclose(wobble, law(run.time), rtol=1e-4, atol=1e-6)
    print(f"about axis {axis + 1}, after 4 s: {wobble[-1]:.4f} times the first wobble")
    wobbles.append(np.abs(wobble))

# %%
# Explorer 1, a rod of 2 m, was spun about its long axis in 1958: axis 1, stable as above. Its whip antennas bent as it
# wobbled, and warmed up. That takes energy but no angular momentum, so :math:`T` falls from nearly :math:`L^2/2I_1` to
# :math:`L^2/2I_3`, and the rod ends tumbling end over end. (Hours became minutes here.)
#
# For a rod that is exactly symmetric, and loses :math:`\kappa\, (\mathrm{d}{\boldsymbol\omega}/\mathrm{d}t)^2` watts,
# the tilt of its axis to :math:`\mathbf L` follows from the energy alone:
# :math:`\tan\theta = \tan\theta_0\, e^{t/\tau}` with :math:`1/\tau = \kappa L^2 (I_\perp - I_1) / (I_1 I_\perp^3)`.


def tilt_of(run, moments):
    """Return the angle in radians between axis 1 and L."""
    along, across = moments[0] * run.angular_velocity[:, 0], moments[1:] * run.angular_velocity[:, 1:]
    return np.arctan2(np.linalg.norm(across, axis=1), along)


kappa, start, losses = 0.004, [78.5, 0.08, 0.0], [{"kind": "dissipation", "rate": 0.004}]  # kg m² s, rad/s
rod = np.array([0.0476, 4.8, 4.8])  # kg m²
symmetric = follow(rod, start, 100.0, load=losses)
momentum = np.hypot(rod[0] * start[0], rod[1] * start[1])
pace = kappa * momentum**2 * (rod[1] - rod[0]) / (rod[0] * rod[1] ** 3)  # 1/s
law = np.arctan(rod[1] * start[1] / (rod[0] * start[0]) * np.exp(pace * symmetric.time))
error = np.abs(tilt_of(symmetric, rod) - law).max()
print(f"a symmetric rod: τ = {1 / pace:.3f} s; farthest from the law: {error:.0e} rad")
assert error < 1e-10

satellite = np.array([0.0476, 4.79, 4.81])
explorer = follow(satellite, start, 300.0, load=losses)
size = np.linalg.norm(explorer.angular_momentum, axis=1)
np.testing.assert_allclose(size, size[0], rtol=1e-9)
least, most = size[0] ** 2 / (2 * satellite[[2, 0]])
print(f"Explorer 1: T falls from {explorer.energy[0]:.3f} J to {explorer.energy[-1]:.5f} J")
print(f"L²/2I₁ = {most:.3f} J and L²/2I₃ = {least:.5f} J")
print(f"at the end ω = {explorer.angular_velocity[-1].round(3)} rad/s")
assert abs(explorer.energy[-1] / least - 1) < 1e-4
assert inertia.stable_axes(satellite, dissipation=True).tolist() == [False, False, True]

# %%
# Left: two wobbles that stay and one that grows, a straight line on this scale. Right: the angle between the long axis
# and :math:`\mathbf L` goes to 90°.
#
# **To try**: ``follow(satellite, [0.0, 0.05, 1.1], 300.0, load=losses)``, a start about axis 3: now the losses calm it.

fig, (left, right) = plt.subplots(1, 2, figsize=(6.4, 4), layout="constrained")
for axis, wobble in enumerate(wobbles, 1):
    left.plot(run.time, wobble, label=f"axis {axis}")
left.set(yscale="log", ylim=(1e-2, 1e4), xlabel="time, s", ylabel="wobble, times the first", title="Disturbed")
left.legend(fontsize="small")
right.plot(explorer.time, np.degrees(tilt_of(explorer, satellite)), color="C3", label="Explorer 1")
right.plot(symmetric.time, np.degrees(law), color="black", linestyle="--", linewidth=1, label="the law")
right.legend(fontsize="small")
right.set(xlabel="time, s", ylabel="long axis to L, degrees", ylim=(0, 100), title="Losing energy")
plt.show()
