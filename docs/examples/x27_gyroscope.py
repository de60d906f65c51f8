r"""
Why a gyroscope precesses slowly
================================

Held at its end, a spinning wheel does not fall but goes round: :math:`\dot\phi = mgl/I_3\omega`, the slower the faster
it spins. The exact law has a second, fast branch, and no steady precession below a least spin.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

I1, I3, mgl = 2.5e-4, 1.5e-4, 0.02  # kg m² about the pivot, N m
tilt = np.radians(60)
least = 2 * np.sqrt(I1 * mgl * np.cos(tilt)) / I3
spins = least * np.geomspace(1.0001, 12, 120)
slow, fast = [], []
for spin in spins:
    attitude = inertia.euler_angles.from_angles([0, tilt, 0])
    top = inertia.HeavyTop.of_state((I1, I3), mgl, attitude, [0, 0, spin])
    both = np.sort(np.abs(top.steady_precession(tilt)))
    slow.append(both[0])
    fast.append(both[1])

# %%
# They are the roots of :math:`I_1 \cos\theta\,\dot\phi^2 - I_3\omega_3\,\dot\phi + mgl = 0`.

for rates in (slow, fast):
    residual = I1 * np.cos(tilt) * np.square(rates) - I3 * spins * rates + mgl
    np.testing.assert_allclose(residual, 0, atol=1e-9)
rule = mgl / (I3 * spins)
print(
    f"no steady precession below {least:.2f} rad/s; at ten times that the rule is off by {slow[-1] / rule[-1] - 1:.2%}"
)

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.loglog(spins, fast, label="fast")
ax.loglog(spins, slow, label="slow")
ax.loglog(spins, rule, "--", color="0.4", label="mgl / I₃ω")
ax.axvline(least, linestyle=":", color="0.4")
ax.set(xlabel="spin ω₃, rad/s", ylabel="precession, rad/s", title="A gyroscope at 60° from the vertical")
ax.legend()
plt.show()
