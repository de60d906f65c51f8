"""Small solids with known answers, for the tests of the mesh."""

import itertools
from pathlib import Path

import numpy as np

from inertia.mesh.part import Part, Source
from inertia.mesh.surface import FACET, Facets, Surface, Triangles
from inertia.units import length_unit

Mesh = tuple[np.ndarray, np.ndarray]

BOX_FACES = [
    [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
    [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
]  # fmt: skip


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Mesh:
    """Return a box of 12 outward triangles; vertex x + 2y + 4z is at the high ends whose x, y, z are 1."""
    vertices = [[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]
    return np.array(vertices, float), np.array(BOX_FACES)


def cube(middle: tuple[float, float, float] = (0, 0, 0), size: float = 1.0) -> Mesh:
    return box(tuple(x - size / 2 for x in middle), tuple(x + size / 2 for x in middle))


def sphere(middle: tuple[float, float, float] = (0, 0, 0), radius: float = 1.0, splits: int = 3) -> Mesh:
    """Return an octahedron split `splits` times, its vertices on the sphere."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    number = {point: i for i, point in enumerate(points)}

    def middle_of(a: int, b: int) -> int:
        point = np.add(points[a], points[b])
        unit = tuple((point / np.linalg.norm(point)).tolist())
        if unit not in number:
            number[unit] = len(points)
            points.append(unit)
        return number[unit]

    for _ in range(splits):
        split = []
        for a, b, c in faces:
            ab, bc, ca = middle_of(*sorted((a, b))), middle_of(*sorted((b, c))), middle_of(*sorted((c, a)))
            split += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = split
    return np.array(middle) + radius * np.array(points, float), np.array(faces)


def ring(around: int = 48, along: int = 16, radius: float = 3.0, tube: float = 1.0) -> Mesh:
    """Return a torus about the z axis."""
    u, v = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / along
    from_axis = radius + tube * np.cos(b)
    points = np.stack([from_axis * np.cos(a), from_axis * np.sin(a), tube * np.sin(b)], axis=-1)
    here, beside = u * along + v, (u + 1) % around * along + v
    above, across = u * along + (v + 1) % along, (u + 1) % around * along + (v + 1) % along
    faces = np.stack([here, beside, across, here, across, above], axis=-1)
    return points.reshape(-1, 3), faces.reshape(-1, 3)


def moebius(steps: int = 12) -> Mesh:
    """Return a band of 2 × steps triangles with half a turn in it, wound consistently except at one seam."""
    angle = 2 * np.pi * np.arange(steps) / steps
    middle = np.stack([4 * np.cos(angle), 4 * np.sin(angle), 0 * angle], axis=1)
    across = np.stack([np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle), np.sin(angle / 2)], axis=1)
    faces = []
    for step in range(steps):
        a, b = 2 * step, 2 * step + 1
        c, d = (a + 2, b + 2) if step + 1 < steps else (1, 0)
        faces += [[a, c, b], [b, c, d]]
    return np.stack([middle - across, middle + across], axis=1).reshape(-1, 3), np.array(faces)


def inside_out(mesh: Mesh) -> Mesh:
    return mesh[0], mesh[1][:, ::-1]


def joined(*meshes: Mesh) -> Surface:
    """Return all meshes as one surface, each with vertices of its own."""
    counts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    faces = [faces + start for (_, faces), start in zip(meshes, counts[:-1], strict=True)]
    return Surface(np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(faces))


def facets(surface: Surface) -> Facets:
    """Return the surface as binary STL records; its coordinates are rounded to float32."""
    records = np.zeros(surface.count, FACET)
    result = Facets(records)
    result.corners_f4()[...] = surface.corners()
    return result


def part(geometry: Triangles | Mesh, unit: str = "mm") -> Part:
    surface = joined(geometry) if isinstance(geometry, tuple) else geometry
    return Part(surface, length_unit(unit), "option", Source("bracket.stl", "stl"))


def cells(*sides: tuple[int, int]) -> set[tuple[int, ...]]:
    """Return the unit cells of a block, named by their low corners."""
    return set(itertools.product(*(range(*side) for side in sides)))


def blocks(*solids: set[tuple[int, ...]]) -> Surface:
    """Return solids made of unit cells, every square cut along the same diagonal: where they meet, they share edges."""
    corners = []
    for solid in solids:
        for cell, axis, way in itertools.product(sorted(solid), range(3), (0, 1)):
            beside = tuple(x + (2 * way - 1) * (k == axis) for k, x in enumerate(cell))
            if beside not in solid:
                low = np.array(cell) + way * np.eye(3)[axis]
                u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
                square = [[low, low + u, low + u + v], [low, low + u + v, low + v]]
                corners += square if way else [triangle[::-1] for triangle in square]
    return Surface(np.array(corners).reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def beside_itself(angle: float) -> Surface:
    """Return a cube of side 10 and a copy that is turned about an edge, which the two have in common."""
    vertices, faces = box((0, 0, 0), (10, 10, 10))
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turned = np.where(
        vertices[:, :2].any(axis=1, keepdims=True), vertices @ [[c, s, 0], [-s, c, 0], [0, 0, 1]], vertices
    )
    return joined((vertices, faces), (turned, faces))


def cylinder(height: float, radius: float, sides: int = 24) -> Mesh:
    """Return a prism on the z axis, its ends fans around their middles."""
    angle = 2 * np.pi * np.arange(sides) / sides
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    here, beside = np.arange(sides), np.roll(np.arange(sides), -1)
    faces = [
        (beside, here, np.full(sides, 2 * sides)),
        (here + sides, beside + sides, np.full(sides, 2 * sides + 1)),
        (here, beside, beside + sides),
        (here, beside + sides, here + sides),
    ]
    vertices = np.concatenate([rim, np.array([0, 0, height]) + rim, [[0, 0, 0], [0, 0, height]]])
    return vertices, np.concatenate([np.column_stack(face) for face in faces])


def as_ply(file: Path, vertices: np.ndarray, faces: np.ndarray, kind: str = "float", order: str = "little") -> Path:
    """Write a binary PLY file whose vertices have a colour, and whose faces a number each."""
    end, real = {"little": "<", "big": ">"}[order], {"float": "f4", "double": "f8"}[kind]
    points = np.zeros(len(vertices), [(axis, end + real) for axis in "xyz"] + [("red", "u1")])
    for axis, values in zip("xyz", vertices.T, strict=True):
        points[axis] = values
    rows = np.zeros(len(faces), [("count", "u1"), ("corners", f"{end}i4", faces.shape[1]), ("id", f"{end}i4")])
    rows["count"], rows["corners"] = faces.shape[1], faces
    header = (
        f"ply\nformat binary_{order}_endian 1.0\nelement vertex {len(points)}\n"
        + "".join(f"property {kind} {axis}\n" for axis in "xyz")
        + f"property uchar red\nelement face {len(rows)}\nproperty list uchar int vertex_indices\n"
        + "property int id\nend_header\n"
    )
    file.write_bytes(header.encode() + points.tobytes() + rows.tobytes())
    return file
