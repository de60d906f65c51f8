r"""
13.25 Dynamic balancing of wheels
=================================

A rotor runs quietly if two things hold (§ 13.25). It is *statically* balanced if the centre of mass lies on the axle:
then it rests in any position. It is *dynamically* balanced if the axle is also a principal axis. Otherwise
:math:`\mathbf L` is not along :math:`{\boldsymbol\omega}`, is carried around with the rotor, and the bearings have to
turn it: for a symmetric rotor mounted :math:`\varphi` askew with

.. math::

   N = \omega^2 (I_3 - I_1)\, \sin\varphi\, \cos\varphi .
"""

# %%
# A wheel, hit by a kerb, sits 1° askew on its axle and turns at 100 rad/s in two bearings 0.2 m apart. Its centre of
# mass is where it belongs; on a knife edge nothing would show.

import matplotlib.pyplot as plt
import numpy as np

import inertia

I1, I3, mass, spin, apart = 0.30, 0.50, 10.0, 100.0, 0.2  # kg m², kg, rad/s, m
askew = np.radians(1.0)


def on_axle(body):
    """Turn a body about z through two bearings, once round."""
    scene = {
        "body": {"inertia": body.inertia, "mass": body.mass, "center_of_mass": body.center_of_mass},
        "start": {"angular_velocity": [0, 0, spin], "frame": "part"},
        "constraint": {
            "kind": "hinge",
            "axis": [0, 0, 1],
            "drive": "constant_speed",
            "bearings": [-apart / 2, apart / 2],
        },
        "run": {"duration": 2 * np.pi / spin, "samples": 181},
    }
    return inertia.simulate(inertia.Scene.from_dict(scene))


turn = inertia.quaternion.matrix(inertia.quaternion.from_rotation_vector([0, askew, 0]))
wheel = inertia.MassProperties(mass, 0.0, np.zeros(3), turn @ np.diag([I1, I1, I3]) @ turn.T)
before = on_axle(wheel)
torque = np.linalg.norm(before.quantities["reaction torque"], axis=1)
expected = spin**2 * (I3 - I1) * np.sin(askew) * np.cos(askew)
print(f"the bearings turn L with {torque[0]:.9f} N m; by the formula {expected:.9f}")
np.testing.assert_allclose(torque, expected, rtol=1e-12)

# %%
# Two weights put it right, one on each face, opposite each other: they leave the centre of mass where it is, and give
# the tensor the element that it lacks. For weights :math:`m` at a radius of 0.25 m, 0.1 m apart along the axle, that is
# :math:`2 m \cdot 0.25 \cdot 0.05 = |I_{xz}|`. They go on the
# sides that the rim has left, as the sign of :math:`I_{xz}` tells.

radius, half = 0.25, 0.05  # m
product = wheel.inertia[0, 2]
weight = abs(product) / (2 * radius * half)
side = np.sign(product)
weights = inertia.point_masses([[side * radius, 0, half], [-side * radius, 0, -half]], [weight, weight])
whole = wheel + weights
after = on_axle(whole)
left_over = np.abs(after.quantities["reaction torque"]).max()
print(f"with 2 × {1e3 * weight:.3f} g the torque is {left_over:.0e} N m")
assert abs(product - (I3 - I1) * np.sin(askew) * np.cos(askew)) < 1e-15
assert left_over < 1e-12 * expected
np.testing.assert_allclose(whole.center_of_mass, 0, atol=1e-15)

# %%
# A bearing that stands still feels a force that goes round with the wheel, sixteen times a second: half a turn up, half
# a turn down, in opposite senses at the two ends. Both are :math:`N` over the distance of the bearings.
#
# **To try**: leave out one of the weights, and the checks. The couple is halved, and a static unbalance has
# come instead: now both bearings are pulled the same way.

force = before.quantities["force on bearing A"]
np.testing.assert_allclose(np.linalg.norm(force, axis=1), expected / apart, rtol=1e-12)
fig, ax = plt.subplots(figsize=(6.4, 4))
for run, how, style in ((before, "askew", "-"), (after, "with weights", "--")):
    for name, colour in (("A", "C0"), ("B", "C1")):
        across = run.quantities[f"force on bearing {name}"][:, 0]
        ax.plot(1e3 * run.time, across, style, color=colour, label=f"{name}, {how}")
ax.set(xlabel="time, ms", ylabel="force on the bearing along x, N", ylim=(-200, 270), title="One turn of a wheel")
ax.legend(ncols=2, loc="upper center")
plt.show()
