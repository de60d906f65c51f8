"""From a STEP file to triangles and the true shape, in the unit of the file; run as a process of its own.

A solid that is in the tree of products more than once is taken over once.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float, Int
from inertia.mesh.shape import Face, Patch, Shape, Solid
from inertia.records import dataclass

if TYPE_CHECKING:
    from inertia.mesh.readers.opencascade.facets import Facets


def main() -> None:
    """Convert a STEP file into a folder.

    The further arguments are sag relative to an edge, angle; s, bytes; the process that started this; and "tree" where
    each solid is to come once, in its own frame, with the tree of products that places it.
    """
    source, target, linear, angular, seconds, size, parent, *tree = sys.argv[1:]
    _limit(int(seconds), int(size), int(parent))
    try:
        _convert(source, Path(target), float(linear), float(angular), bool(tree))
    except ValueError as error:
        (Path(target) / "refusal.txt").write_text(str(error))


def _limit(seconds: int, size: int, parent: int) -> None:
    try:
        import resource

        for name, most in (("CPU", seconds), ("AS", size), ("CORE", 0)):
            kind = getattr(resource, "RLIMIT_" + name)
            hard = resource.getrlimit(kind)[1]
            resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    except (ImportError, ValueError, OSError):  # Windows, and systems that do not limit one of them
        pass
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(1, 9)  # PR_SET_PDEATHSIG, SIGKILL
        if os.getppid() != parent:
            sys.exit(1)


@dataclass(frozen=True, eq=False)
class _Body:
    """A solid, or faces that belong to none, as it is in its own frame."""

    facets: Facets
    faces: tuple[Face, ...]
    closed: bool


def _convert(source: str, target: Path, linear: float, angular: float, tree: bool) -> None:
    from inertia.mesh.readers.opencascade.document import Document
    from inertia.mesh.readers.opencascade.facets import matrix
    from inertia.mesh.readers.opencascade.plain import Pool, shape_to_json

    def place(location: Any) -> list[list[float]]:
        motion = matrix(location.Transformation())
        motion[:, 3] *= document.scale
        rows: list[list[float]] = motion.tolist()
        return rows

    document = Document(source)
    bodies = Bodies(linear, angular, document.scale)
    instances = []
    for piece in document.pieces():
        if tree:
            instances.append((piece.name, piece.node, place(piece.within), bodies.add_once(piece)))
        else:
            bodies.add(piece)
    pool = Pool()
    answer = {
        "millimetres": document.millimetres,
        "units": document.units,
        "loose": document.loose,
        "runs": bodies.runs,
        "without_triangles": bodies.without_triangles,
        "faults": document.faults,
        "untrue": bodies.fault,
        "nodes": [(name, above, place(location)) for name, above, location in document.nodes] if tree else [],
        "instances": instances,
        "vertices": bodies.sizes,
        "shape": shape_to_json(Shape(tuple(bodies.solids), np.array(bodies.tolerances)), pool),
    }
    vertices, triangles, distances = bodies.surface()
    np.savez(target / "arrays.npz", vertices=vertices, faces=triangles, distances=distances, numbers=pool.numbers())
    (target / "part.json").write_text(json.dumps(answer))


class Bodies:
    """Solids and open surfaces, each where the tree of products puts it.

    Parameters
    ----------
    linear, angular : sag of the triangles relative to an edge, angle; rad
    scale : of the shapes, see `Document`
    in_memory : whether the shapes are those of somebody who may have put triangles on them already

    Attributes
    ----------
    solids : true shapes
    tolerances : of edges
    runs, sizes : name and count of triangles, and count of vertices, one a solid
    without_triangles : faces that OpenCASCADE could not mesh
    fault : why the true shape cannot be stated, if so
    """

    def __init__(self, linear: float, angular: float, scale: float, *, in_memory: bool = False) -> None:
        from inertia.mesh.readers.opencascade.kernel import shape_map

        self._sag, self._scale, self._in_memory = (linear, angular), scale, in_memory
        self._known = shape_map()
        self._bodies: dict[tuple[int, Any], _Body] = {}
        self._surfaces: list[tuple[Float, Int, Float]] = []
        self._count = self._faces = 0
        self.solids: list[Solid] = []
        self.tolerances: list[float] = []
        self.runs: list[tuple[str | None, int]] = []
        self.sizes: list[int] = []
        self._numbers: dict[int, int] = {}
        self.without_triangles = 0
        self.fault: str | None = None

    def add(self, piece: Any) -> None:
        """Take over a piece of the document."""
        from OCP import BRepBuilderAPI

        from inertia.mesh.readers.opencascade.facets import matrix

        shape, motion = piece.shape, piece.location.Transformation()
        placement = matrix(motion)
        if motion.IsNegative() or abs(motion.ScaleFactor() - 1) > 1e-12:
            shape = BRepBuilderAPI.BRepBuilderAPI_Transform(shape, motion, True).Shape()
            placement = np.eye(3, 4)
        self._place(piece, self._own(shape), placement)

    def add_once(self, piece: Any) -> int:
        """Take over a piece in its own frame, where none like it is there yet, and return its number."""
        body = self._own(piece.shape)
        if id(body) not in self._numbers:
            self._numbers[id(body)] = len(self.solids)
            self._place(piece, body, np.eye(3, 4))
        return self._numbers[id(body)]

    def _own(self, shape: Any) -> _Body:
        key = int(self._known.Add(shape)), shape.Orientation()
        if key not in self._bodies:
            self._bodies[key] = self._body(shape)
        return self._bodies[key]

    def _place(self, piece: Any, body: _Body, placement: Float) -> None:
        from inertia.mesh.readers.opencascade.facets import placed

        placement[:, 3] *= self._scale
        name = piece.name or str(len(self.solids) + 1)
        self.solids.append(Solid(name, body.faces, placement, body.closed, piece.colour, piece.path))
        facets = body.facets
        self.runs.append((piece.name, len(facets.triangles)))
        vertices = placed(facets.vertices, placement)
        self._surfaces.append((vertices, facets.triangles + self._count, facets.distances))
        self.sizes.append(len(vertices))
        self._count += len(vertices)

    def surface(self) -> tuple[Float, Int, Float]:
        """Return the vertices (n, 3), triangles (m, 3) and their distances from the true faces (m,) of all."""
        if not self._surfaces:
            return np.empty((0, 3)), np.empty((0, 3), np.int64), np.empty(0)
        vertices, triangles, distances = map(np.concatenate, zip(*self._surfaces, strict=True))
        return vertices, triangles, distances

    def _body(self, shape: Any) -> _Body:
        from OCP import BRepBuilderAPI, TopAbs, TopExp

        from inertia.mesh.readers.opencascade.facets import triangulated
        from inertia.mesh.readers.opencascade.kernel import bounds_something, cast, shape_map
        from inertia.mesh.readers.opencascade.surfaces import Edges, face_data, scaled_face

        if self._in_memory:  # its triangles stay as they are
            shape = BRepBuilderAPI.BRepBuilderAPI_Copy(shape, False, False).Shape()
        walk, faces = TopExp.TopExp_Explorer(shape, TopAbs.TopAbs_FACE), []
        while walk.More():
            if bounds_something(walk.Current()):
                faces.append(cast(walk.Current(), "Face"))
            walk.Next()
        edges = Edges(len(self.tolerances), shape_map())
        data: list[Face] = []
        for face in faces:
            self._faces += 1
            try:
                data.append(face_data(face, edges, self._faces))
            except Exception as error:  # the kernel's own, of many kinds
                self.fault = self.fault or f"face {self._faces}: {str(error).strip() or type(error).__name__}"
        self.tolerances += [self._scale * tolerance for tolerance in edges.tolerances]
        whole = len(data) == len(faces)
        patches: list[Patch | None] = [face.patch for face in data] if whole else [None] * len(faces)
        closed = _closed(data, edges.points)
        facets = triangulated(shape, faces, patches, closed and whole, *self._sag)
        self.without_triangles += facets.missing
        facets = replace(facets, vertices=self._scale * facets.vertices, distances=self._scale * facets.distances)
        return _Body(facets, tuple(scaled_face(face, self._scale) for face in data), closed)


def _closed(faces: list[Face], points: set[int]) -> bool:
    """Whether each edge is walked as often one way as the other, but for those that are points."""
    balance: dict[int, int] = {}
    for face in faces:
        for trim in (trim for loop in face.loops for trim in loop if trim.edge not in points):
            ahead = (trim.start < trim.stop) != face.inward
            balance[trim.edge] = balance.get(trim.edge, 0) + (1 if ahead else -1)
    return not any(balance.values())
