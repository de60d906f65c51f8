"""The bytes of STL, OBJ and VTK files; every function expects coordinates that its format can hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from inertia_meshes.shapes import Corners

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def normals(corners: Corners) -> NDArray[np.float64]:
    """Unit normals (n, 3); zero for a triangle without area."""
    a, b, c = np.moveaxis(corners, 1, 0)
    (ux, uy, uz), (vx, vy, vz) = (b - a).T, (c - a).T
    normal = np.column_stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx])
    x, y, z = normal.T
    length = np.sqrt(x * x + y * y + z * z)
    return normal / np.where(length == 0, 1, length)[:, None] + 0.0


def binary_stl(corners: Corners, title: str) -> bytes:
    """Binary STL: an 80-byte header, the number of triangles, and 50 bytes for each."""
    records = np.zeros(len(corners), _RECORD)
    records["normal"], records["corners"] = normals(corners), corners
    return title.encode().ljust(80) + len(corners).to_bytes(4, "little") + records.tobytes()


def ascii_stl(corners: Corners, name: str) -> bytes:
    """ASCII STL."""
    lines = [f"solid {name}"]
    for normal, triangle in zip(normals(corners), corners, strict=True):
        lines += [f"  facet normal {_text(normal)}", "    outer loop"]
        lines += [f"      vertex {_text(corner)}" for corner in triangle]
        lines += ["    endloop", "  endfacet"]
    return _joined([*lines, f"endsolid {name}"])


def obj(objects: Mapping[str, Corners], title: str) -> bytes:
    """Wavefront OBJ with one named object for each surface; equal corners of an object share a vertex."""
    lines, before = [f"# {title}"], 1
    for name, corners in objects.items():
        points = [tuple(point) for point in corners.reshape(-1, 3).tolist()]
        number = {point: before + k for k, point in enumerate(dict.fromkeys(points))}
        before += len(number)
        index = [str(number[point]) for point in points]
        lines += [f"o {name}", *(f"v {_text(point)}" for point in number)]
        lines += [f"f {' '.join(index[k : k + 3])}" for k in range(0, len(index), 3)]
    return _joined(lines)


def vtk_hexahedra(
    points: NDArray[np.float64], cells: NDArray[np.int64], field: str, values: Sequence[int], title: str
) -> bytes:
    """Legacy ASCII VTK file of hexahedra (m, 8) with one integer for each cell."""
    return _joined([
        "# vtk DataFile Version 3.0", title, "ASCII", "DATASET UNSTRUCTURED_GRID",
        f"POINTS {len(points)} double", *map(_text, points),
        f"CELLS {len(cells)} {cells.size + len(cells)}", *(_text((8, *cell)) for cell in cells),
        f"CELL_TYPES {len(cells)}", *("12" for _ in cells),
        f"CELL_DATA {len(cells)}", f"SCALARS {field} int 1", "LOOKUP_TABLE default", *map(str, values),
    ])  # fmt: skip


def _text(numbers: Sequence[float] | NDArray[np.float64]) -> str:
    return " ".join(f"{float(number)!r}".removesuffix(".0") for number in numbers)


def _joined(lines: list[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode("ascii")
