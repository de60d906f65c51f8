"""
Speed against accuracy
======================

A step half as long costs twice the time, and by a method of fourth order leaves a sixteenth of the error. How many
steps does one need? The closed form of free motion gives the error itself, not a guess of it.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments, omega, duration = [1.0, 2.0, 3.0], np.array([[0.1, 3.0, 0.2]]), 5.0
exact = inertia.free_motion(moments, omega[0], [0.0, duration])[1][-1]
steps = 2 ** np.arange(5, 15)
errors = []
for count in steps:
    stepped = inertia.step_ensemble(moments, omega, duration, int(count))[1][0]
    errors.append(np.abs(stepped - exact).max())
orders = np.log2(np.array(errors[:-1]) / errors[1:])
for count, error in zip(steps, errors, strict=True):
    print(f"{count:6d} steps: {error:.1e} rad/s")
assert np.all(np.abs(orders[3:6] - 4) < 0.2)
assert min(errors) < 1e-11

# %%
# The error falls as the fourth power until roundings of float64 are left. ``inertia.trade`` measures this on a scene of
# your own, with the time that each method takes on your machine.

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.loglog(steps, errors, "o-", label="Runge–Kutta, 4th order")
ax.loglog(steps, errors[3] * (steps[3] / steps) ** 4.0, ":", color="0.4", label="steps⁻⁴")
ax.set(xlabel="steps, in proportion to the time", ylabel="error of ω after 5 s, rad/s", ylim=(1e-15, 10))
ax.legend()
plt.show()
