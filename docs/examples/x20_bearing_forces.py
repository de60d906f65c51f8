r"""
What an unbalance does to the bearings, against speed
=====================================================

A disc whose own axis is 1° off its shaft pulls at both bearings with :math:`\omega^2 (I_3 - I_1) \sin\alpha
\cos\alpha / l`, opposite on either side and going round with it: four times as much at twice the speed.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

I1, I3, mass, apart = 0.05, 0.10, 10.0, 0.2  # kg m², kg, m
tilt = np.radians(1.0)
axis = np.array([np.sin(tilt), 0, np.cos(tilt)])


def force(speed):
    """Return the force in N on bearing A of a disc at a speed in rad/s."""
    scene = {
        "body": {"principal_moments": [I1, I1, I3], "mass": mass},
        "start": {"angular_velocity": speed * axis, "frame": "part"},
        "constraint": {"kind": "hinge", "axis": axis, "drive": "constant_speed", "bearings": [-apart / 2, apart / 2]},
        "run": {"duration": 2 * np.pi / speed, "samples": 9},
    }
    run = inertia.simulate(inertia.Scene.from_dict(scene))
    return np.linalg.norm(run.quantities["force on bearing A"], axis=1).max()


rpm = np.array([500, 1000, 2000, 3000, 4000, 5000])
forces = np.array([force(speed) for speed in rpm * np.pi / 30])
expected = (rpm * np.pi / 30) ** 2 * (I3 - I1) * np.sin(tilt) * np.cos(tilt) / apart
np.testing.assert_allclose(forces, expected, rtol=1e-10)
carried = mass * 9.80665 / 2
print(f"at 3000 r/min {forces[3]:.1f} N, {forces[3] / carried:.2f} times the weight that the bearing carries")

# %%
# From some 1000 r/min on the bearing is pulled harder than the disc weighs. Try half a degree: half the force.

fine = np.linspace(0, 5200, 100)
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(fine, expected[0] * (fine / rpm[0]) ** 2, label="by the formula")
ax.plot(rpm, forces, "o", color="C1", label="simulated")
ax.axhline(carried, linestyle=":", color="0.4", label="half the weight")
ax.set(xlabel="speed, r/min", ylabel="force on a bearing, N", ylim=0, title="A disc 1° off its shaft")
ax.legend()
plt.show()
