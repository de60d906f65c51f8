"""The extreme cases: one asymmetric solid, stretched, turned, moved, scaled, hollowed out and sliced up.

Each case has the coordinates as they are stored, and the exact moments of the body that was meant, before its
coordinates were rounded to float64 or float32: the difference is lost by the storage and not by any integration.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np

from inertia.mesh.surface import FACET, Facets, Surface, Triangles
from inertia_meshes import rational

from ..meshes import Faces, Vertices

Matrix = tuple[tuple[Fraction, ...], ...]

TURN: Matrix = tuple(tuple(Fraction(k, 87) for k in row) for row in ((29, -82, 2), (58, 19, -62), (58, 22, 61)))
"""A rational rotation that leaves no coordinate plane."""

ASPECTS = (6, 9, 12)
OFFSETS = (3, 6, 8, 12)
SCALES = (-63, -60, -30, 30, 60)
OUT_OF_RANGE = (-310, -65, 62, 103)
WALLS = (6, 9, 12, 15)
SLIVERS = (6, 12)
GAPS = (3, 6, 9, 12, 15)
DIRECTION = (Fraction(3, 5), Fraction(-2, 5), Fraction(7, 10))
"""The way that parts are moved off: of length about one."""


@dataclass(frozen=True, eq=False)
class Case:
    """A part: vertices (n, 3) as stored, faces (m, 3), and the moments that were meant.

    `meant` is None where no other body was; `single` says that it is stored in float32.
    """

    family: str
    name: str
    vertices: Vertices
    faces: Faces
    meant: rational.Moments | None = None
    single: bool = False

    @property
    def triangles(self) -> Triangles:
        """The triangles as a reader would return them."""
        if not self.single:
            return Surface(self.vertices, self.faces)
        records = Facets(np.zeros(len(self.faces), FACET))
        records.corners_f4()[...] = self.vertices[self.faces]
        return records


def ball(splits: int = 3, roughness: float = 0.2, stretch: Sequence[float] = (1.0, 0.8, 0.6)) -> tuple[Vertices, Faces]:
    """Return a dented ball of 8·4^splits triangles, without any symmetry, of diameter about one."""
    points = [(1.0, 0, 0), (-1.0, 0, 0), (0, 1.0, 0), (0, -1.0, 0), (0, 0, 1.0), (0, 0, -1.0)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    number: dict[tuple[int, int], int] = {}

    def middle(a: int, b: int) -> int:
        edge = min(a, b), max(a, b)
        if edge not in number:
            number[edge] = len(points)
            point = np.add(points[a], points[b])
            points.append(tuple((point / np.sqrt((point * point).sum())).tolist()))
        return number[edge]

    for _ in range(splits):
        split = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            split += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = split
    directions = np.array(points)
    x, y, z = directions.T
    radius = 0.5 + 0.5 * roughness * (np.sin(3 * x + y + 0.5) * np.cos(2 * z - y) + 0.3 * x * y)
    return directions * radius[:, None] * stretch, np.array(faces)


def hollow(mesh: tuple[Vertices, Faces], wall: Fraction) -> tuple[Vertices, Faces, rational.Moments]:
    """Return a body with a cavity of its own shape, smaller by twice the `wall`, and the moments meant."""
    vertices, faces = mesh
    factor = 1 - 2 * wall
    inner, cavity = placed(vertices, faces, scale=factor)
    return (
        np.concatenate([vertices, inner]),
        np.concatenate([faces, faces[:, ::-1] + len(vertices)]),
        rational.moments(vertices[faces]) - cavity,
    )


def slivers(mesh: tuple[Vertices, Faces], height: float) -> tuple[Vertices, Faces]:
    """Split each triangle in three about a point that is nearer to one edge by `height` than to the others."""
    vertices, faces = mesh
    a, b, c = vertices[faces].transpose(1, 0, 2)
    points = a + 0.4 * (b - a) + height * (c - a)
    new = len(vertices) + np.arange(len(faces))
    i, j, k = faces.T
    pieces = [np.stack(corners, axis=1) for corners in ((i, j, new), (j, k, new), (k, i, new))]
    return np.concatenate([vertices, points]), np.concatenate(pieces)


def placed(
    vertices: Vertices,
    faces: Faces,
    stretch: Sequence[Fraction | int] = (1, 1, 1),
    turn: Matrix | None = None,
    offset: Fraction | int = 0,
    scale: Fraction = Fraction(1),
) -> tuple[Vertices, rational.Moments]:
    """Stretch, turn, move and scale a mesh in rational numbers, then round each coordinate once.

    Returns the rounded vertices and the exact moments before rounding.
    """
    x, y, z = (k * scale for k in stretch)
    shift = [scale * offset * k for k in DIRECTION]
    rows = turn or ((Fraction(1), 0, 0), (0, Fraction(1), 0), (0, 0, Fraction(1)))
    matrix = [[scale * row[k] * stretch[k] for k in range(3)] for row in rows]
    points = [
        [
            float(sum((m * Fraction(x) for m, x in zip(row, point, strict=True)), d))
            for row, d in zip(matrix, shift, strict=True)
        ]
        for point in vertices.tolist()
    ]
    meant = rational.moments(vertices[faces]).scaled(x, y, z).mapped(rows).moved(*shift)
    return np.array(points), meant


def cases() -> Iterator[Case]:
    """Yield every case whose answer is a number."""
    mesh = ball()
    vertices, faces = mesh
    family = "Far from the origin"
    yield Case(family, "at the origin", vertices, faces)
    for offset in OFFSETS:
        stored, meant = placed(vertices, faces, offset=10**offset)
        yield Case(family, f"1e{offset} diameters away", stored, faces, meant)
    family = "Very small and very large"
    for power in SCALES:
        stored, meant = placed(vertices, faces, scale=Fraction(10) ** power)
        yield Case(family, f"of 1e{power} m", stored, faces, meant)
    for family, (aspect, turn) in product(("Needles", "Plates"), product(ASPECTS, (None, TURN))):
        thin = Fraction(1, 10**aspect)
        stored, meant = placed(vertices, faces, (1, thin if family == "Needles" else 1, thin), turn)
        lie = "along the axes" if turn is None else "slanted"
        yield Case(family, f"1 : 1e{aspect}, {lie}", stored, faces, meant)
    for power in WALLS:
        hollowed, both, meant = hollow(mesh, Fraction(1, 10**power))
        yield Case("Thin walls", f"wall of 1e-{power} of the diameter", hollowed, both, meant)
    for power in SLIVERS:
        yield Case("Slivers", f"triangles 1 : 1e{power}", *slivers(mesh, 10.0**-power))
    for where, offset in (("at the origin", 0), ("1e3 diameters away", 10**3), ("1e6 diameters away", 10**6)):
        stored, meant = placed(vertices, faces, offset=offset)
        yield Case("Stored in float32", where, stored.astype(np.float32).astype(float), faces, meant, single=True)


def refused() -> Iterator[Case]:
    """Yield the cases that have no answer in float64."""
    mesh = ball()
    vertices, faces = mesh
    for power in OUT_OF_RANGE:
        stored, _ = placed(vertices, faces, scale=Fraction(10) ** power)
        yield Case("No answer", f"of 1e{power} m", stored, faces)
    hollowed, both, _ = hollow(mesh, Fraction(0))
    yield Case("No answer", "wall of nothing", hollowed, both)


def nearly_equal() -> Iterator[tuple[int, Case]]:
    """Yield the power of ten of the gap, and a slanted body of revolution whose two smaller moments are that near."""
    for power in GAPS:
        gap = Fraction(1, 10**power)
        vertices, faces = ball(roughness=0.0, stretch=(1.0, 1.0, 0.6))
        # I_x ∝ b² + c², I_y ∝ a² + c², I_z ∝ a² + b²: (I_x − I_y)/I_z is the gap to first order.
        stored, meant = placed(vertices, faces, (1, 1 + gap, 1), TURN)
        yield power, Case("Nearly equal moments", f"gap 1e-{power}", stored, faces, meant)
