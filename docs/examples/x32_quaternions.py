"""
Tumbling, in quaternions
========================

Euler angles jump where an axis passes the pole; the four components of an attitude quaternion never do. The motion is a
closed form, so that any instant can be asked for, in any order.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments, omega = [1.0, 2.0, 3.0], [0.3, 1.0, 0.2]  # kg m², rad/s
time = np.linspace(0, 60, 1201)
attitude, body_rates = inertia.free_motion(moments, omega, time)
attitude = inertia.quaternion.continuous(attitude)
np.testing.assert_allclose(np.linalg.norm(attitude, axis=1), 1, rtol=1e-14)

# %%
# L stays in space, and :math:`\dot q = \tfrac12\, q\,\omega`: the latter by a fourth-order difference.

momentum = inertia.quaternion.to_space(attitude, moments * body_rates)
np.testing.assert_allclose(momentum, np.broadcast_to(momentum[0], momentum.shape), atol=1e-13)
h = time[1]
slope = (attitude[:-4] - 8 * attitude[1:-3] + 8 * attitude[3:-1] - attitude[4:]) / (12 * h)
rates = np.column_stack([body_rates, np.zeros(len(time))])
np.testing.assert_allclose(slope, inertia.quaternion.multiply(attitude, rates)[2:-2] / 2, atol=1e-6)
print("L in space:", momentum[0].round(9), "and a minute later:", momentum[-1].round(9))

# %%
# Try to plot ``inertia.euler_angles.to_angles(attitude)``: the same motion, with corners.

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(time, attitude, label=["x", "y", "z", "w"])
ax.set(xlabel="time, s", ylabel="component", ylim=(-1.05, 1.35), title="The attitude of a tumbling body")
ax.legend(ncols=4, loc="upper center")
plt.show()
