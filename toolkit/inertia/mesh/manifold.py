"""Solids of manifold3d from closed surfaces, for cutting, uniting and simplifying: scaled so that nothing overflows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import CHECK, GeometryError, Word


def exponent_of(vertices: Float) -> int:
    """Return the e for which the largest coordinate times 2⁻ᵉ lies between 1/2 and 1.

    Products of coordinates must not overflow, and a power of two changes no digit.

    >>> exponent_of(np.array([[0.5, -3.0, 2.0]]))
    2
    """
    return int(np.frexp(np.abs(vertices).max())[1])


def solid(
    vertices: Float,
    faces: Int,
    exponent: int,
    fault: str = "manifold3d does not take it",
    advice: Sequence[Word] = ("run ", CHECK, " to see why"),
    **runs: Any,
) -> Any:
    """Return the solid that a closed surface bounds, its coordinates times 2⁻ᵉ.

    Parameters
    ----------
    fault, advice : what a `GeometryError` says of a surface that manifold3d does not take, before and after its reason
    runs : what else the mesh is to know, as where runs of triangles begin
    """
    from manifold3d import Error, Manifold, Mesh64

    result = Manifold(Mesh64(np.ldexp(vertices, -exponent), faces.astype(np.uint64), **runs))
    if result.status() != Error.NoError:
        raise GeometryError(f"{fault} ({result.status().name}): ", *advice)
    return result


def union(solids: Sequence[Any]) -> Any:
    """Return the solid that solids are together; planes that they share but for rounding can lose some of them."""
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean(solids, OpType.Add)
