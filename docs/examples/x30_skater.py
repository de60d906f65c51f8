r"""
A skater pulls the arms in
==========================

No torque acts, so that :math:`I\omega` stays: with the arms in, :math:`I` is less and :math:`\omega` more. The energy
does not stay: the arms do work against the centrifugal force.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

run = inertia.simulate(inertia.Scene.load(path("scenes/skater.toml")))
trunk = 0.585
out, drawn = trunk + 2 * 4.0 * 0.7**2, trunk + 2 * 4.0 * 0.2**2  # kg m²
spin = run.angular_velocity[:, 2]
np.testing.assert_allclose(spin.max(), 8.0 * out / drawn, rtol=1e-9)
np.testing.assert_allclose(run.quantities["work of the joints"].max(), out * 32.0 * (out / drawn - 1), rtol=1e-3)
print(f"from 8 to {spin.max():.4f} rad/s, which takes {run.quantities['work of the joints'].max():.1f} J of the arms")

# %%
# And what the arms have put in they get back on the way out. Try lighter dumb-bells, 1 kg: less of everything.

fig, ax = plt.subplots(figsize=(6.4, 4))
ax.plot(run.time, spin)
ax.set(xlabel="time, s", ylabel="ω, rad/s", ylim=0)
ax.yaxis.label.set_color("C0")
work = ax.twinx()
work.plot(run.time, run.quantities["work of the joints"], "--", color="C2")
work.set_ylabel("work of the arms, J", color="C2")
work.set_ylim(0)
work.grid(visible=False)
plt.show()
