"""
The inertial of a URDF link
===========================

A simulator needs mass, centre of mass and tensor of each link, with the signs, the point and the axes that its format
means. ``export`` writes them, here as URDF, and says in comments what they are; the numbers read back as the same
floats.
"""

from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np

import inertia
from inertia_meshes import path

part = inertia.read(path("t_handle.stl"), unit="mm")
link = inertia.mass_properties(part, material="aluminium")
text = inertia.export(link, "urdf", name="handle")
print(text[text.index("<inertial>") :].strip())

# %%
# Read it back, as a simulator would.

tag = ElementTree.fromstring(text.encode()).find(".//inertial")
mass = float(tag.find("mass").get("value"))
stated = {key: float(value) for key, value in tag.find("inertia").attrib.items()}
assert mass == link.mass
assert [stated["ixx"], stated["iyy"], stated["izz"], stated["ixz"]] == [*np.diag(link.inertia), link.inertia[0, 2]]

# %%
# Simulators draw an inertial as the box that turns like it, of edges :math:`a^2 = 6 (I_y + I_z - I_x)/m`. If that box
# does not lie about the part, something is wrong: a unit, a point, a sign.

moments = np.diag(link.inertia)
edges = 1e3 * np.sqrt(6 * (moments.sum() - 2 * moments) / link.mass)
x, _, z = 1e3 * link.center_of_mass
fig, ax = plt.subplots(figsize=(6.4, 4))
corners = part.triangles.corners()[:, :, [0, 2]]
for triangle in corners:
    ax.fill(*triangle.T, facecolor="0.75", linewidth=0.2, edgecolor="0.6")
ax.add_patch(
    plt.Rectangle((x - edges[0] / 2, z - edges[2] / 2), edges[0], edges[2], fill=False, color="C0", linewidth=2)
)
ax.plot(x, z, "o", color="C0", label="centre of mass, and the box that turns like it")
ax.set(aspect="equal", xlabel="x, mm", ylabel="z, mm", ylim=(-30, 16), title="T-handle from the side")
ax.legend(loc="upper right")
plt.show()
