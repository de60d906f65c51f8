"""Volume and area with VTK; the reader welds the vertices, and there may be no boundary or non-manifold edge."""

import sys

from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties
from vtkmodules.vtkIOGeometry import vtkSTLReader

reader = vtkSTLReader()
reader.SetFileName(sys.argv[1])
edges = vtkFeatureEdges()
edges.SetInputConnection(reader.GetOutputPort())
edges.FeatureEdgesOff()
edges.ManifoldEdgesOff()
edges.BoundaryEdgesOn()
edges.NonManifoldEdgesOn()
edges.Update()
if edges.GetOutput().GetNumberOfCells():
    raise SystemExit("open")
measure = vtkMassProperties()
measure.SetInputConnection(reader.GetOutputPort())
measure.Update()
print(measure.GetVolume())
