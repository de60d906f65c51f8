"""Quadrature rules against powers; nodes, shape functions and faces against VTK's."""

import itertools
from decimal import localcontext
from fractions import Fraction

import numpy as np
import pytest
from tests.mass.cells.textbook_cells import shape_functions

from inertia.mass.cells.shape_functions import gauss, table
from inertia.mesh.geometry.cell_shapes import KINDS


@pytest.mark.parametrize("power", [0, 1, 2])
@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_gauss_rules_integrate_powers(count, power):
    with localcontext(prec=60):
        points, weights = gauss(count, power)
        for degree in range(2 * count):
            total = sum(w * t**degree for t, w in zip(points, weights, strict=True))
            assert abs(Fraction(total) - Fraction(1, degree + power + 1)) < Fraction(1, 10**50)


VTK = {
    "tetra10": "vtkQuadraticTetra",
    "hexahedron": "vtkHexahedron",
    "hexahedron20": "vtkQuadraticHexahedron",
    "hexahedron24": "vtkBiQuadraticQuadraticHexahedron",
    "hexahedron27": "vtkTriQuadraticHexahedron",
    "wedge": "vtkWedge",
    "wedge15": "vtkQuadraticWedge",
    "wedge18": "vtkBiQuadraticQuadraticWedge",
    "pyramid": "vtkPyramid",
    "pyramid13": "vtkQuadraticPyramid",
    "quad8": "vtkQuadraticQuad",
    "quad9": "vtkBiQuadraticQuad",
    "triangle6": "vtkQuadraticTriangle",
    "line3": "vtkQuadraticEdge",
}


@pytest.mark.parametrize("kind", VTK)
def test_nodes_and_shape_functions_are_vtks(kind):
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    cell = getattr(vtk, VTK[kind])()
    nodes = np.array(cell.GetParametricCoords()).reshape(-1, 3)
    ours = np.array([[float(x) for x in node] for node in KINDS[kind].nodes])
    dimension = ours.shape[1]
    if kind.startswith("pyramid"):
        ours = np.column_stack([(ours[:, :2] + 1) / 2, 1 - ours[:, 2]])
        ours[4] = nodes[4]  # all of ξ and η are the apex
        np.testing.assert_array_equal(ours, nodes)
        return
    box = nodes.shape[0] == len(ours) and KINDS[kind].reference != "simplex"
    flat = [KINDS[kind].reference == "box" or axis == 2 for axis in range(dimension)]
    ours = np.where(np.array(flat) & box, (ours + 1) / 2, ours)
    np.testing.assert_array_equal(ours, nodes[:, :dimension])
    shape = table(kind)
    weights = [0.0] * len(nodes)
    for values in shape.values[:: max(1, len(shape.values) // 7)]:
        cell.InterpolateFunctions((values @ nodes).tolist(), weights)
        np.testing.assert_allclose(values, weights, atol=1e-13)


def test_vtks_own_13_node_pyramid_has_the_same_faces():
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    cell, weights = vtk.vtkQuadraticPyramid(), [0.0] * 13
    for a, b in itertools.product((Fraction(1, 8), Fraction(2, 3)), repeat=2):
        for place in ((a, b, 0), (a, 0, b), (a, 1, b), (0, a, b), (1, a, b)):
            cell.InterpolateFunctions([float(x) for x in place], weights)
            np.testing.assert_allclose([float(n) for n in shape_functions("pyramid13", *place)], weights, atol=1e-15)
