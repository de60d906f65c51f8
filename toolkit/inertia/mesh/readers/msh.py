"""MSH of MuJoCo (binary): four counts, then vertices, normals, texture coordinates and faces.

Its name ends as Gmsh's does; a file is one of these when its size is what its counts ask for. Source: MuJoCo
documentation, XML reference, asset/mesh, "MSH file format".
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.readers.contents import Contents, surface

_COUNTS = struct.Struct("<4i")  # vertices, normals, texture coordinates, faces
_TRIPLE, _PAIR = 12, 8


def is_mujoco_msh(head: bytes, size: int) -> bool:
    """Say whether the size of a file is exactly what the four counts at its beginning ask for."""
    if len(head) < _COUNTS.size:
        return False
    vertices, normals, textures, faces = _COUNTS.unpack_from(head)
    if min(vertices, faces) < 1 or min(normals, textures) < 0:
        return False
    return bool(size == _COUNTS.size + _TRIPLE * (vertices + normals + faces) + _PAIR * textures)


def read_mujoco_msh(path: Path) -> Contents:
    """Read the vertices and faces of a mesh; normals and texture coordinates are left aside."""
    data = path.read_bytes()
    if not is_mujoco_msh(data[: _COUNTS.size], len(data)):
        raise ReadError("its size is not what its counts of vertices and faces ask for: export it again")
    vertices, normals, textures, faces = _COUNTS.unpack_from(data)
    points = np.frombuffer(data, "<f4", 3 * vertices, _COUNTS.size).reshape(-1, 3)
    offset = _COUNTS.size + _TRIPLE * (vertices + normals) + _PAIR * textures
    corners = np.frombuffer(data, "<i4", 3 * faces, offset).reshape(-1, 3)
    return Contents(surface(points.astype(np.float64), corners.astype(np.int64)))
