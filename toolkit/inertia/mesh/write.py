"""Parts → one binary STL file."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from inertia.mesh.part import Part
from inertia.mesh.readers.stl import HEADER
from inertia.mesh.surface import FACET, Facets
from inertia.output import require_writable, write_whole
from inertia.units import Unit


def write_stl(parts: Sequence[Part], file: str | os.PathLike[str], unit: Unit, *, force: bool = False) -> None:
    """Write the triangles of parts to a binary STL file, whose header says the unit.

    An STL file holds float32: coordinates are rounded to 6e-8 of their size.

    Raises `UsageError` where the file exists and `force` is not set, or its name does not end in .stl, `InertiaError`
    where it cannot be written.
    """
    path = require_writable(file, ".stl", force=force)
    corners = [part.triangles.corners() * float(part.unit.metres / unit.metres) for part in parts]
    together = np.concatenate(corners)
    facets = Facets(np.zeros(len(together), FACET))
    facets.corners_f4()[:] = together
    across = np.cross(together[:, 1] - together[:, 0], together[:, 2] - together[:, 0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    facets.records["normal"] = np.divide(across, length, out=np.zeros_like(across), where=length > 0)
    head = f"written by inertia, unit {unit.name}".encode("ascii").ljust(HEADER - 4)
    write_whole(path, head + len(together).to_bytes(4, "little") + facets.records.tobytes())
