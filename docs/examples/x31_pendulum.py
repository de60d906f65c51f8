r"""
A pendulum with large swings
============================

The period of a pendulum grows with its swing: :math:`T = T_0/\operatorname{agm}(1, \cos\tfrac12\theta_0)`, with the
arithmetic-geometric mean. At 170° it is two and a half times that of small swings.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

mass, length, g = 1.0, 1.0, 9.80665  # a bar on a pin at its end
about_pin = mass * length**2 / 3
small = 2 * np.pi * np.sqrt(about_pin / (mass * g * length / 2))


def period(swing):
    """Return the exact period in s at an amplitude in rad."""
    a, b = 1.0, np.cos(swing / 2)
    for _ in range(8):
        a, b = (a + b) / 2, np.sqrt(a * b)
    return small / a


def after_a_period(swing):
    """Return the angle in rad from the vertical at T/2 and at T of a bar let go at an angle."""
    scene = {
        "body": {
            "principal_moments": [mass * length**2 / 12, mass * length**2 / 12, 1e-4],
            "mass": mass,
            "center_of_mass": [0, 0, -length / 2],
        },
        "start": {"angular_velocity": [0, 0, 0], "attitude": [np.sin(swing / 2), 0, 0, np.cos(swing / 2)]},
        "constraint": {"kind": "hinge", "axis": [1, 0, 0]},
        "load": [{"kind": "gravity"}],
        "run": {"duration": period(swing), "samples": 3, "accuracy": 1e-10},
    }
    run = inertia.simulate(inertia.Scene.from_dict(scene))
    down = inertia.quaternion.to_space(run.attitude, [0, 0, -1])
    return np.arctan2(down[1:, 1], -down[1:, 2])


swings = np.radians([20, 60, 100, 140, 170])
for swing in swings:
    half, whole = after_a_period(swing)
    np.testing.assert_allclose([half, whole], [-swing, swing], atol=1e-8)  # the other side, and back again
    print(f"{np.degrees(swing):4.0f}°: {period(swing):.6f} s")

# %%
# The dots are swings that were simulated for one exact period, and came back to where they began.

fine = np.radians(np.linspace(0, 176, 200))
fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(np.degrees(fine), [period(swing) / small for swing in fine])
ax.plot(np.degrees(swings), [period(swing) / small for swing in swings], "o", color="C1")
ax.set(xlabel="swing, degrees", ylabel="period / period of small swings", title="A bar on a pin")
plt.show()
