"""Gmsh's element types: their names in meshio, and the order of their nodes there.

Source: "Gmsh Reference Manual" 4.13, sections 10.1 and 10.2; the order of meshio is that of VTK's cells.
"""

from __future__ import annotations

from inertia.errors import ReadError

_PRISM = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11]
_PYRAMID = [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12]
_BRICK = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]
TYPES: dict[int, tuple[str, list[int]]] = {
    1: ("line", [*range(2)]),
    2: ("triangle", [*range(3)]),
    3: ("quad", [*range(4)]),
    4: ("tetra", [*range(4)]),
    5: ("hexahedron", [*range(8)]),
    6: ("wedge", [*range(6)]),
    7: ("pyramid", [*range(5)]),
    8: ("line3", [*range(3)]),
    9: ("triangle6", [*range(6)]),
    10: ("quad9", [*range(9)]),
    11: ("tetra10", [*range(8), 9, 8]),
    12: ("hexahedron27", [*_BRICK, 22, 23, 21, 24, 20, 25, 26]),
    13: ("wedge18", [*_PRISM, 15, 17, 16]),
    14: ("pyramid14", [*_PYRAMID, 13]),
    15: ("vertex", [0]),
    16: ("quad8", [*range(8)]),
    17: ("hexahedron20", _BRICK),
    18: ("wedge15", _PRISM),
    19: ("pyramid13", _PYRAMID),
}
"""Gmsh's number of a type → meshio's name, and which of Gmsh's nodes stands at each of meshio's places."""


def nodes_of(number: int) -> int:
    """Return how many nodes an element of a type has."""
    if number not in TYPES:
        raise ReadError(f"it has elements of Gmsh's type {number}, which are not read: use first or second order")
    return len(TYPES[number][1])
