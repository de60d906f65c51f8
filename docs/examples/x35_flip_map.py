r"""
How long until it turns over?
=============================

The nearer the spin to the axis of the intermediate moment, the longer a body spins before it turns over, without any
bound. One call gives the period for every direction of :math:`\boldsymbol\omega`, here sixty thousand of them.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

moments, speed = np.array([1.0, 2.0, 3.0]), 10.0  # kg m², rad/s
longitude, latitude = np.meshgrid(np.radians(np.linspace(0.25, 359.75, 361)), np.radians(np.linspace(-89.5, 89.5, 180)))
direction = np.stack(
    [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], axis=-1
)
period = inertia.flip_period(moments, speed * direction)

# %%
# Near axis 3 a body only wobbles, at :math:`\omega\sqrt{(I_3 - I_1)(I_3 - I_2)/I_1 I_2}`; half a turn of that is the
# limit there.

wobble = speed * np.sqrt((moments[2] - moments[0]) * (moments[2] - moments[1]) / (moments[0] * moments[1]))
near = inertia.flip_period(moments, [1e-4, 1e-4, speed])
np.testing.assert_allclose(near, np.pi / wobble, rtol=1e-6)
print(f"half a wobble about axis 3 takes {near:.4f} s, the longest time on the map is {np.max(period):.2f} s")

fig, ax = plt.subplots(figsize=(6.4, 4))
image = ax.pcolormesh(np.degrees(longitude), np.degrees(latitude), period, cmap="viridis", vmax=2.0, rasterized=True)
for place, name in (((180, 0), "1"), ((90, 0), "2"), ((270, 0), "2"), ((180, 84), "3")):
    ax.annotate(name, place, color="white", ha="center", va="center", fontsize=13)
ax.set(xlabel="longitude of ω, degrees", ylabel="latitude of ω, degrees", title="Time from flip to flip")
ax.grid(visible=False)
fig.colorbar(image, label="s", extend="max")
plt.show()
