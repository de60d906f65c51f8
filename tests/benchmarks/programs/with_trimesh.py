"""Volume, centre of mass and tensor with trimesh; the mesh must be watertight and consistently wound."""

import sys

import trimesh

mesh = trimesh.load(sys.argv[1])
if not mesh.is_volume:
    raise SystemExit("open")
_ = mesh.center_mass, mesh.moment_inertia
print(mesh.volume)
