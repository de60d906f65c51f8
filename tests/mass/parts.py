"""Parts made of triangles, and how far mass properties may lie from their exact moments."""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from inertia.mass.properties import MassProperties
from inertia.mesh.part import CellBlock, Cells, Part, Regions, Source
from inertia.mesh.surface import FACET, Facets, Surface
from inertia.units import length_unit
from inertia_meshes.rational import NOTHING, Moments, moments
from inertia_meshes.shapes import Corners, box, moved


def cube(x: float = 0, y: float = 0, z: float = 0, size: float = 1) -> Corners:
    """Return a cube with its least corner at (x, y, z)."""
    return moved(size * (box(1, 1, 1) + 0.5), x, y, z)


def surface(*pieces: Corners, unit: str = "m", regions: Sequence[str] = ()) -> Part:
    """Return a part of triangles with corners of their own; `regions` names the pieces."""
    corners = np.concatenate(pieces)
    index = np.repeat(np.arange(len(pieces), dtype=np.int32), [len(piece) for piece in pieces])
    return Part(
        Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)),
        length_unit(unit),
        "option",
        Source("bracket.obj", "obj"),
        Regions(tuple(regions), index) if regions else None,
    )


def facets(*pieces: Corners, unit: str = "m") -> Part:
    """Return a part as binary STL stores it, in float32."""
    corners = np.concatenate(pieces)
    stored = Facets(np.zeros(len(corners), FACET))
    stored.corners_f4()[...] = corners
    return Part(stored, length_unit(unit), "option", Source("bracket.stl", "stl"))


def cells(kind: str, *nodes: Sequence[Sequence[float]], regions: Sequence[str] = ()) -> Part:
    """Return a mesh of cells of one kind, in metres, with nodes of their own; `regions` names each cell's."""
    points = np.array(nodes, float)
    count, each, _ = points.shape
    block = CellBlock(kind, np.arange(count * each).reshape(count, each))
    names = tuple(dict.fromkeys(regions))
    index = np.array([names.index(name) for name in regions], np.int32)
    return Part(
        Cells(points.reshape(-1, 3), (block,)),
        length_unit("m"),
        "option",
        Source("bar.vtk", "vtk"),
        Regions(names, index) if regions else None,
    )


def exact(part: Part, density: Fraction | int = 1000) -> Moments:
    """Return the exact moments of a part's stored triangles, in kg and metres."""
    return weighed((part.triangles.corners(), density), unit=part.unit.metres)


def weighed(*pieces: tuple[Corners, Fraction | int], unit: Fraction | int = 1) -> Moments:
    """Return the exact moments of pieces with a density (kg/m³) each, in kg and metres."""
    return sum((moments(corners).scaled(unit, unit, unit).weighted(rho) for corners, rho in pieces), NOTHING)


def assert_within_bound(properties: MassProperties, truth: Moments, volume: Fraction | None = None) -> None:
    """Compare with exact moments of mass in kg and metres; nothing beyond the stated bound is forgiven."""
    limit = properties.error
    if volume is not None:
        assert abs(Fraction(properties.volume) - volume) <= Fraction(limit.volume) * abs(volume) * _SLACK
    assert abs(Fraction(properties.mass) - truth.volume) <= Fraction(limit.mass) * truth.volume * _SLACK
    shift = [Fraction(a) - b for a, b in zip(properties.center_of_mass.tolist(), truth.center_of_mass, strict=True)]
    assert sum(d * d for d in shift) <= (Fraction(limit.center_of_mass) * _SLACK) ** 2
    error, size = squares(properties, truth)
    assert error <= (Fraction(limit.inertia) * _SLACK) ** 2 * size


_SLACK = 1 + Fraction(1, 10**9)  # the bounds themselves are rounded


def squares(properties: MassProperties, truth: Moments) -> tuple[Fraction, Fraction]:
    """Return the squares of the Frobenius norms of the tensor's error and of the true tensor."""
    computed = [Fraction(value) for value in properties.inertia.ravel().tolist()]
    true = [value for row in truth.inertia for value in row]
    return sum((a - b) ** 2 for a, b in zip(computed, true, strict=True)), sum(b * b for b in true)


def relative(properties: MassProperties, truth: Moments) -> tuple[float, float]:
    """Return the relative errors of the mass and of the tensor (Frobenius norm)."""
    error, size = squares(properties, truth)
    return abs(float(Fraction(properties.mass) / truth.volume - 1)), math.sqrt(error / size)
