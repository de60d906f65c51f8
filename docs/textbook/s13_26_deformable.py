r"""
13.26 Rotation of deformable bodies
===================================

A skater, a cat and a diver have no torque to use, and yet they spin up, turn over and twist. They change their shape.
With the tensor :math:`\mathbf I(t)` of all limbs together and the angular momentum :math:`\mathbf h(t)` that the limbs
have in their motion within the body,

.. math::

   \mathbf L = \mathbf I(t)\, {\boldsymbol\omega} + \mathbf h(t)

stays fixed in space, and each of the two terms can be traded for the other (§ 13.26). A scene lists the limbs as parts,
and how each joint moves.
"""

# %%
# *The skater* pulls in her arms. That is :math:`\mathbf I` alone: :math:`I \omega` stays, so the spin rises as
# :math:`1/I`, the energy too, and the arms do the work. The arms are 4 kg each, at 0.7 m and then at 0.2 m, beside
# 0.585 kg m² of the rest.

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path


def arm(name, side):
    """Return an arm that is pulled in from 1 s to 2 s."""
    pull = {"axis": [side, 0, 0], "times": [1.0, 2.0], "displacements": [0.0, -0.5]}
    hand = {"center_of_mass": [0.7 * side, 0, 1.3], "mass": 4.0, "principal_moments": [0, 0, 0]}
    return {"name": name, "parent": "trunk", "joint": [pull], **hand}


trunk = {"name": "trunk", "mass": 52.0, "principal_moments": [12.8, 12.8, 0.585], "center_of_mass": [0, 0, 0.85]}
skater = inertia.simulate(
    inertia.Scene.from_dict(
        {
            "part": [trunk, arm("left", 1), arm("right", -1)],
            "start": {"angular_velocity": [0, 0, 8.0], "frame": "part"},
            "run": {"duration": 3.0, "samples": 301},
        }
    )
)
wide, close = 0.585 + 8 * 0.7**2, 0.585 + 8 * 0.2**2  # kg m²
momentum = 8 * wide
work = momentum**2 / 2 * (1 / close - 1 / wide)
print(f"skater: 8 rad/s become {skater.angular_velocity[-1, 2]:.6f}; the arms do {work:.3f} J of work")
np.testing.assert_allclose(skater.angular_velocity[-1], [0, 0, 8 * wide / close], atol=1e-11)
np.testing.assert_allclose(skater.quantities["work of the joints"][-1], work, rtol=1e-11)

# %%
# *The cat* is let go upside down with :math:`\mathbf L = 0`. That is :math:`\mathbf h` alone: it bends, and turns front
# and rear about the bent spine; the whole must go round the other way. With moments :math:`A` and :math:`B` of either
# half, about its own axis and across it, and a bend :math:`\beta`, one turn of the halves turns the cat by
# :math:`A c / (A c^2 + B s^2)` of a turn, :math:`c` and :math:`s` of :math:`\beta/2`: half a turn for the bend that
# ``scenes/cat.toml`` has.

A, B, bend = 0.00288, 0.1184 / 15, 1.2683476041568686
share = A * np.cos(bend / 2) / (A * np.cos(bend / 2) ** 2 + B * np.sin(bend / 2) ** 2)
cat = inertia.simulate(inertia.Scene.load(path("scenes/cat.toml")))
feet = inertia.quaternion.to_space(cat.attitude, [1, 0, 0])
print(f"cat: by the formula {share:.12f} of a turn")
print(f"its hind feet point along {feet[0].round(9) + 0} and then {feet[-1].round(9) + 0}")
assert abs(share - 0.5) < 1e-14
np.testing.assert_allclose(feet[[0, -1]], [[0, 0, 1], [0, 0, -1]], atol=1e-11)
np.testing.assert_allclose(cat.angular_momentum, 0, atol=1e-15)

# %%
# *The diver* leaves the board with a somersault and no twist. She swings one arm down, which tilts her body off
# :math:`\mathbf L`; from then on she is a free, nearly symmetric top (§ 13.20), and such a top turns about its own axis
# at :math:`(1/I_1 - 1/I_\perp)\, L\, \cos\theta`: the twist. Three turns later the arm goes up again, and it stops.

diver = inertia.simulate(inertia.Scene.load(path("scenes/diver.toml")))
L = np.linalg.norm(diver.angular_momentum[0])
np.testing.assert_allclose(diver.angular_momentum, np.broadcast_to(diver.angular_momentum[0], (341, 3)), atol=1e-10)
y_to_z = inertia.quaternion.from_rotation_vector([np.pi / 2, 0, 0])  # L, along y, becomes the axis of the somersault
angles = inertia.euler_angles.to_angles(inertia.quaternion.multiply(y_to_z, diver.attitude))
somersault, tilt, twist = inertia.euler_angles.unwrap(angles).T
turns = (twist - twist[0]) / (2 * np.pi)
middle = (diver.time > 0.6) & (diver.time < 1.2)
long, *across = diver.quantities["principal moments"][middle].mean(axis=0)
rate = (1 / long - 2 / sum(across)) * L * np.cos(tilt[middle]).mean()
pace = (twist[middle][-1] - twist[middle][0]) / (diver.time[middle][-1] - diver.time[middle][0])
print(f"diver: {turns[-1]:.6f} twists, at {pace:.2f} rad/s")
print(f"by the formula for a symmetric top, at {rate:.2f} rad/s")
assert abs(abs(turns[-1]) - 3) < 1e-6
assert abs(pace / rate - 1) < 0.02

# %%
# Three motions without a torque. The skater speeds up with her arms; the cat's hind feet come down in
# three strokes: bend, turn, straighten. The diver's twist runs for as long as she is tilted; the somersault goes on.
#
# **To try**: let the skater stretch her arms out again, ``times`` 1, 2, 3, 4 s: the energy goes back into them.

fig, (one, two, three) = plt.subplots(1, 3, figsize=(8.4, 3.4), layout="constrained")
one.plot(skater.time, skater.angular_velocity[:, 2])
one.set(xlabel="time, s", ylabel="spin, rad/s", ylim=(0, 45), title="Skater")
two.plot(cat.time, np.degrees(np.arccos(np.clip(-feet[:, 2], -1, 1))), color="C1")
two.set(xlabel="time, s", ylabel="hind feet, degrees from down", ylim=(-5, 185), title="Cat")
three.plot(diver.time, np.abs(turns), color="C2", label="twist")
three.plot(diver.time, (somersault - somersault[0]) / (2 * np.pi), color="C3", label="somersault")
three.set(xlabel="time, s", ylabel="turns", title="Diver")
three.legend()
plt.show()
