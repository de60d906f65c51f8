"""`Part`: coordinates as stored, their unit, and where they came from.

A part holds one of three geometries:

* `Facets`: the 50-byte records of a binary STL file, in memory or, of a large one, still in the file;
* `Surface`: vertices and triangles;
* `Cells`: a volume mesh (or wires and points) as blocks of cells, with meshio's names and node order.

Both surfaces offer the same few things (`count`, `corners`, `sample`, `select`), so that what integrates or checks
triangles needs not know where they lie. Coordinates are never multiplied by a unit.
"""

from __future__ import annotations

import os
import threading
import weakref
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Bool, Float, Int
from inertia.errors import GeometryError, ReadError, UsageError, placed, visible
from inertia.mesh.shape import Shape
from inertia.mesh.version import CHANGED, Version
from inertia.units import DEFAULT_UNIT, Unit, UnitFrom, length_unit, multiple_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DRAWN = 200_000
"""The most triangles that are drawn."""

FACET = np.dtype(
    [
        ("normal", "<f4", 3),
        *((name, "<f4") for name in ("x0", "y0", "z0", "x1", "y1", "z1", "x2", "y2", "z2")),
        ("attribute", "<u2"),
    ]
)
"""One record of a binary STL file: a normal (ignored), nine coordinates, an attribute; 50 bytes, packed."""

_CORNERS_OFFSET = 12

_NAMES_IN_TRIMESH = {
    "dm": "decimeters",
    "um": "microns",
    "nm": "nanometers",
    "km": "kilometers",
    "ft": "feet",
    "yd": "yards",
}
"""What trimesh calls the units that it knows under another name than `inertia.units`."""
_SCANNED = 65_536  # triangles looked at together
_GAP = 512  # triangles that are read along with their neighbours rather than passed over


class Facets:
    """Triangles as binary STL records in memory.

    Parameters
    ----------
    records : (n,) array of `FACET`
    """

    counts_once = False
    """As of `Surface`."""

    def __init__(self, records: NDArray[Any]) -> None:
        self._records = records

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self._records)

    @property
    def records(self) -> NDArray[Any]:
        """All records, (n,)."""
        return self.block(0, self.count)

    def block(self, start: int, stop: int) -> NDArray[Any]:
        """Return the records of triangles `start:stop`."""
        return self._records[start:stop]

    def corners_f4(self, start: int = 0, stop: int | None = None) -> NDArray[np.float32]:
        """Return the stored corners of triangles `start:stop`, (k, 3, 3) float32, as a view of a block."""
        block = self.block(start, self.count if stop is None else min(stop, self.count))
        if len(block) == 0:
            return np.empty((0, 3, 3), "<f4")
        return np.ndarray(
            (len(block), 3, 3), "<f4", buffer=block, offset=_CORNERS_OFFSET, strides=(FACET.itemsize, 12, 4)
        )

    def corners(self, start: int = 0, stop: int | None = None) -> Float:
        """Return the corners of triangles `start:stop`, (k, 3, 3), widened exactly to float64."""
        with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
            return self.corners_f4(start, stop).astype(np.float64)

    def sample(self, count: int) -> Float:
        """Return the corners of at least `count` triangles (or all), evenly spread, (k, 3, 3)."""
        return self.select(np.arange(0, self.count, max(1, self.count // count))).corners()

    def select(self, index: NDArray[Any]) -> Facets:
        """Return the triangles picked by an index or mask array, as a copy in memory."""
        return Facets(self._records[index])


class RowsInFile:
    """Rows of one length in a file, read block by block.

    They are not mapped: to touch a page of a file that was cut short meanwhile ends the process. Each block is known
    to be that of the version of the file that was opened; `ReadError` says so where it has changed.

    Parameters
    ----------
    path : the file
    row : the type of a row
    count : of rows
    offset : byte at which they begin
    """

    def __init__(self, path: Path, row: np.dtype[Any], count: int, offset: int) -> None:
        self._name, self._version, self._row, self._offset = str(path), Version(path), row, offset
        self.count = count
        self._file = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        self._seeking = threading.Lock()
        weakref.finalize(self, os.close, self._file)

    def block(self, start: int, stop: int) -> NDArray[Any]:
        """Return rows `start:stop`; raises `ReadError` where the file has changed."""
        size, at = self._row.itemsize * (stop - start), self._offset + self._row.itemsize * start
        try:
            data = self._read(size, at)
            self._version.require(os.fstat(self._file), links=False)
            if len(data) < size:
                raise ReadError(CHANGED, code="changed")
        except OSError as error:
            raise ReadError(f"cannot read {self._name}: {error.strerror}: check the disk") from error
        except ReadError as error:
            raise placed(error, f"cannot read {self._name}") from None
        return np.frombuffer(data, self._row)

    def select(self, index: NDArray[Any]) -> NDArray[Any]:
        """Return the rows picked by an index or mask array."""
        places = np.flatnonzero(index) if index.dtype == bool else index
        order = np.argsort(places, kind="stable")
        ordered = places[order]
        rows = np.empty(len(places), self._row)
        ends = np.flatnonzero(np.diff(ordered, append=self.count + _GAP) >= _GAP) + 1
        for first, last in pairwise([0, *ends.tolist()]):
            for some in range(first, last, _SCANNED):
                run = ordered[some : min(some + _SCANNED, last)]
                block = self.block(int(run[0]), int(run[-1]) + 1)
                rows[order[some : some + len(run)]] = block[run - run[0]]
        return rows

    def _read(self, size: int, at: int) -> bytes:
        data = self._some(size, at)
        if not 0 < len(data) < size:
            return data
        pieces = [data]  # a system reads 2 GB at a time at most, and some file systems less
        while data:
            size, at = size - len(data), at + len(data)
            data = self._some(size, at)
            pieces.append(data)
        return b"".join(pieces)

    def _some(self, size: int, at: int) -> bytes:
        if hasattr(os, "pread"):
            return os.pread(self._file, size, at)
        with self._seeking:
            os.lseek(self._file, at, os.SEEK_SET)
            return os.read(self._file, size)


class FacetsInFile(Facets):
    """Triangles as binary STL records in a file, read block by block where they are used; raises as `RowsInFile`.

    Parameters
    ----------
    path : the file
    count : of triangles
    offset : byte at which the records begin
    """

    def __init__(self, path: Path, count: int, offset: int) -> None:
        self._rows = RowsInFile(path, FACET, count, offset)

    @property
    def count(self) -> int:
        """Number of triangles."""
        return self._rows.count

    def block(self, start: int, stop: int) -> NDArray[Any]:
        """Return the records of triangles `start:stop`; raises `ReadError` where the file has changed."""
        return self._rows.block(start, stop)

    def select(self, index: NDArray[Any]) -> Facets:
        """Return the triangles picked by an index or mask array, as a copy in memory."""
        return Facets(self._rows.select(index))


class Surface:
    """Triangles over shared vertices.

    Parameters
    ----------
    vertices : (n, 3) float64
    faces : (m, 3) int64, indices into `vertices`; counter-clockwise seen from outside

    Attributes
    ----------
    counts_once : whether it is known to go around each place once or not at all, but for the rounding of its vertices
    """

    counts_once = False

    def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None:
        self.vertices: Float = np.ascontiguousarray(vertices, dtype=np.float64)
        self.faces: Int = np.ascontiguousarray(faces, dtype=np.int64)
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3:
            raise UsageError(f"vertices must have shape (n, 3), not {self.vertices.shape}")
        if self.faces.ndim != 2 or self.faces.shape[1] != 3:
            raise UsageError(f"faces must have shape (m, 3), not {self.faces.shape}")
        if self.faces.size:
            out_of_range = (self.faces < 0) | (self.faces >= len(self.vertices))
            if out_of_range.any():
                face, corner = (int(i) for i in np.argwhere(out_of_range)[0])
                raise GeometryError(
                    f"face {face} names vertex {self.faces[face, corner]}, "
                    f"but the vertices are 0 to {len(self.vertices) - 1}: export the mesh again"
                )

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self.faces)

    def block(self, start: int, stop: int) -> Int:
        """Return the faces of triangles `start:stop`, (k, 3)."""
        return self.faces[start:stop]

    def corners(self, start: int = 0, stop: int | None = None) -> Float:
        """Return the corners of triangles `start:stop`, (k, 3, 3)."""
        return self.vertices[self.faces[start:stop]]

    def sample(self, count: int) -> Float:
        """Return the corners of at least `count` triangles (or all), evenly spread, (k, 3, 3)."""
        return self.vertices[self.faces[:: max(1, self.count // count)]]

    def select(self, index: NDArray[Any]) -> Surface:
        """Return the triangles picked by an index or mask array; the vertices are shared."""
        return Surface(self.vertices, self.faces[index])


class FacesInFile(Surface):
    """Triangles over shared vertices, of which the vertices are in memory and the faces in a file.

    Parameters
    ----------
    vertices : (n, 3) float64
    rows : with the fields `count`, which is 3, and `corners`, (3,), indices into `vertices`
    """

    def __init__(self, vertices: Float, rows: RowsInFile) -> None:
        self.vertices, self._rows = vertices, rows

    @property
    def faces(self) -> Int:  # type: ignore[override]  # read anew each time
        """All faces, (m, 3)."""
        return self.block(0, self.count)

    @property
    def count(self) -> int:
        """Number of triangles."""
        return self._rows.count

    def block(self, start: int, stop: int) -> Int:
        """Return the faces of triangles `start:stop`, (k, 3)."""
        return self._faces(self._rows.block(start, min(stop, self.count)), start)

    def corners(self, start: int = 0, stop: int | None = None) -> Float:
        """Return the corners of triangles `start:stop`, (k, 3, 3)."""
        return self.vertices[self.block(start, self.count if stop is None else stop)]

    def sample(self, count: int) -> Float:
        """Return the corners of at least `count` triangles (or all), evenly spread, (k, 3, 3)."""
        return self.select(np.arange(0, self.count, max(1, self.count // count))).corners()

    def select(self, index: NDArray[Any]) -> Surface:
        """Return the triangles picked by an index or mask array; the vertices are shared."""
        return Surface(self.vertices, self._faces(self._rows.select(index), None))

    def _faces(self, rows: NDArray[Any], first: int | None) -> Int:
        """Return the faces of rows, which begin with face `first` where they follow on one another."""
        wrong = rows["count"] != 3
        if wrong.any():
            where = "" if first is None else f" {first + int(wrong.argmax())}"
            raise ReadError(f"face{where} has {rows['count'][wrong][0]} corners, not 3: write triangles only")
        faces = rows["corners"].astype(np.int64)
        beyond = ((faces < 0) | (faces >= len(self.vertices))).any(axis=1)
        if beyond.any():
            where = "" if first is None else f" {first + int(beyond.argmax())}"
            raise GeometryError(
                f"face{where} names one of the vertices {faces[beyond][0].tolist()}, but these are 0 to "
                f"{len(self.vertices) - 1}: export the mesh again"
            )
        return faces


Triangles = Facets | Surface


LARGEST = 1e75
"""The largest coordinate that is computed with: the inertia of anything larger leaves float64, whatever the unit."""


def usable(coordinates: Float) -> Bool:
    """Say which coordinates are numbers that a volume can be computed from."""
    with np.errstate(invalid="ignore"):  # a signalling NaN
        return np.abs(coordinates) <= LARGEST


def counts_once(triangles: Triangles) -> bool:
    """Say whether triangles are known to go around each place once or not at all, but for rounding."""
    return triangles.counts_once


def first_non_finite(triangles: Triangles) -> tuple[int, int] | None:
    """Return (triangle, corner 0 to 2) of the first NaN or infinite coordinate, or None.

    Reading does not scan a binary STL file; whoever integrates one sees a sum that is not finite and asks here.

    >>> first_non_finite(Surface([[0, 0, 0], [1, 0, 0], [0, float("nan"), 0]], [[0, 1, 2]]))
    (0, 2)
    """
    corners = triangles.corners_f4 if isinstance(triangles, Facets) else triangles.corners
    for start in range(0, triangles.count, _SCANNED):
        stop = min(start + _SCANNED, triangles.count)
        finite = np.isfinite(corners(start, stop)).all(axis=2)
        if not finite.all():
            face, corner = np.argwhere(~finite)[0]
            return start + int(face), int(corner)
    return None


@dataclass(frozen=True, eq=False)
class CellBlock:
    """Cells of one kind: `kind` is meshio's name (`"tetra"`, `"hexahedron20"`, ...), `nodes` is (m, k) int64."""

    kind: str
    nodes: Int


@dataclass(frozen=True, eq=False)
class Cells:
    """A mesh of cells: `points` (n, 3) float64 and blocks of cells over them.

    The volume cells carry mass as solids; `line` cells as wires, `vertex` cells as points.
    """

    points: Float
    blocks: tuple[CellBlock, ...]

    @property
    def count(self) -> int:
        """Number of cells."""
        return sum(len(block.nodes) for block in self.blocks)


@dataclass(frozen=True, eq=False)
class Regions:
    """Named groups of elements, as the file names them.

    `index[i]` is the place in `names` of element i's group; elements are triangles, or cells in block order.
    """

    names: tuple[str, ...]
    index: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Rounding:
    """What reading rounded: the coordinates of the part are not those that the file writes, but the nearest float64.

    `distance` is how far a vertex may be, in the file's unit, from where the file puts it; `remainder` returns how far
    each is, (n, 3), to a part in 2⁵⁰ of that, where the file can be read exactly.
    """

    distance: float
    remainder: Callable[[], Float] | None = None


@dataclass(frozen=True)
class Source:
    """Where a part came from: `path` (None for arrays in memory) and `format` (`"stl"`, `"vtk"`, ...)."""

    path: str | None
    format: str
    version: Version | None = field(default=None, repr=False, compare=False)
    """The file as it was when it was read."""

    @cached_property
    def sha256(self) -> str | None:
        """SHA-256 of the file, in hexadecimal; None for arrays in memory.

        Raises `ReadError` where the file is no longer there, or no longer the one that was read.
        """
        return None if self.path is None else _hash(Path(self.path), self.version)

    @cached_property
    def files(self) -> dict[str, str]:
        """SHA-256 of the files that the file refers to, by the names that it has for them; raises as `sha256`."""
        others = {} if self.version is None else self.version.others
        return {name: _hash(other.path, other) for name, other in others.items()}

    def to_dict(self) -> dict[str, Any]:
        """Return what outputs say of it."""
        files = {"files": [{"path": name, "sha256": digest} for name, digest in self.files.items()]}
        return {"path": self.path, "sha256": self.sha256, "format": self.format, **(files if self.files else {})}


def _hash(path: Path, version: Version | None) -> str:
    try:
        return (version or Version(path)).sha256
    except OSError as error:
        raise ReadError(f"cannot read {path} a second time, for its SHA-256: {error.strerror}") from error
    except ReadError as error:
        raise placed(error, f"cannot read {path}") from None


@dataclass(frozen=True, eq=False)
class Doubt:
    """Volume that a solid may have or not have, around k places; file units.

    It is what lies between a surface that was made up and the one that was lost, or what counts more than once.

    Attributes
    ----------
    places : (k, 3)
    outward, inward : (k,), volumes that the solid may have more, and less
    reach : (k,), root mean square of how far from its place that is, if it is all there
    either : (k,), volumes that may be one or the other, in all; the sum of both unless that is more than there is
    """

    places: Float
    outward: Float
    inward: Float
    reach: Float
    either: Float = None  # type: ignore[assignment]  # made of the others

    def __post_init__(self) -> None:
        """Add up both sides where their sum is not given."""
        if self.either is None:
            object.__setattr__(self, "either", self.outward + self.inward)

    @classmethod
    def joined(cls, doubts: Iterable[Doubt | None]) -> Doubt | None:
        """Return all of them together, if there are any."""
        columns = [(one.places, one.outward, one.inward, one.reach, one.either) for one in doubts if one is not None]
        return cls(*map(np.concatenate, zip(*columns, strict=True))) if columns else None

    @classmethod
    def anywhere_in(cls, simplices: Float, thickness: Float | float = 0.0) -> Doubt:
        """Return the doubt about all that lies in tetrahedra (k, 4, 3), or within a thickness of triangles (k, 3, 3).

        Within h of a triangle of area A and perimeter P, a surface whose corners move there sweeps at most
        h (A + h P + 2 h²); h is (k,) or one for all.
        """
        count = simplices.shape[1]
        places = simplices.mean(axis=1)
        sides = simplices[:, 1:] - simplices[:, :1]
        across = np.cross(sides[:, 0], sides[:, 1])
        spread = np.sqrt(((simplices - places[:, None]) ** 2).sum(axis=(1, 2)) / (count * (count + 1)))
        if count == 4:
            volume = np.abs(np.einsum("ij,ij->i", across, sides[:, 2])) / 6
        else:
            perimeter = np.linalg.norm(simplices - np.roll(simplices, 1, axis=1), axis=2).sum(axis=1)
            volume = thickness * (np.linalg.norm(across, axis=1) / 2 + thickness * perimeter + 2 * thickness**2)
            spread = np.sqrt(((simplices - places[:, None]) ** 2).sum(axis=2).max(axis=1)) + thickness
        return cls(places, volume, volume, spread, volume)

    @classmethod
    def within(cls, box: Float, outward: float, inward: float) -> Doubt:
        """Return the doubt about volumes somewhere in a box (2, 3)."""
        half = (box[1] - box[0]) / 2
        return cls((box[0] + half)[None], np.array([outward]), np.array([inward]), np.array([np.linalg.norm(half)]))

    @property
    def volume(self) -> float:
        """The volume that there may be more or less, in all."""
        return float(max(self.outward.sum(), self.inward.sum()))

    def either_way(self) -> Doubt:
        """Return the doubt about a surface whose winding is not known."""
        most = np.maximum(self.outward, self.inward)
        return Doubt(self.places, most, most, self.reach, self.either)


@dataclass(frozen=True, eq=False)
class Part:
    """A geometry as stored, its unit and its source."""

    geometry: Facets | Surface | Cells
    unit: Unit = DEFAULT_UNIT
    unit_from: UnitFrom = "assumed"
    source: Source = field(default_factory=lambda: Source(None, "arrays"))
    regions: Regions | None = None
    notes: Sequence[str] = ()
    """What reading had to decide, in sentences (parts of the file left out, faces split, ...)."""
    chord: Float | None = None
    """How far the true surface may be from each triangle (m,), in the unit, where reading made the triangles (STEP)."""
    rounding: Rounding | None = None
    """What reading rounded; None where every coordinate is a float64 in the file."""
    filling: Doubt | None = None
    """What the fillings of holes may be off by, where repair filled some."""
    shape: Shape | None = None
    """The true shape, in the unit, that the triangles stand for, where the file stores it (STEP)."""

    @classmethod
    def from_arrays(cls, vertices: ArrayLike, faces: ArrayLike, unit: str = "m") -> Part:
        """Make a part from a triangle mesh in memory, `vertices` (n, 3) in `unit` and `faces` (m, 3).

        >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], unit="mm")
        >>> part.triangles.count
        4
        """
        return cls(Surface(vertices, faces), length_unit(unit), "option")

    @classmethod
    def from_trimesh(cls, mesh: Any, unit: str | None = None) -> Part:
        """Make a part from a `trimesh.Trimesh`: the same coordinates and faces, and the regions, where it has them.

        Parameters
        ----------
        mesh : the mesh; of a scene, pass `scene.to_mesh()`
        unit : the unit of its coordinates, in place of its own `units`; without either, millimetres are assumed

        Examples
        --------
        >>> import trimesh
        >>> box = trimesh.creation.box((1, 2, 3))
        >>> box.units = "inches"
        >>> part = Part.from_trimesh(box)
        >>> part.triangles.count, part.unit.name
        (12, 'in')
        """
        if not hasattr(mesh, "vertices") or not hasattr(mesh, "faces"):
            raise UsageError(f"a {type(mesh).__name__} is no trimesh.Trimesh: of a scene, give scene.to_mesh()")
        own = getattr(mesh, "units", None)
        stated = own if unit is None else unit
        number, times, name = (stated or DEFAULT_UNIT.name).rpartition("*")  # trimesh states "0.3 * meters"
        size = multiple_of(number, length_unit(name)) if times else length_unit(name)
        unit_from: UnitFrom = "assumed" if stated is None else "option" if unit is not None else "file"
        regions = None
        names = mesh.face_attributes.get("region") if hasattr(mesh, "face_attributes") else None
        if names is not None and len(names) == len(mesh.faces):
            titles, index = np.unique(np.asarray(names, str), return_inverse=True)
            regions = Regions(tuple(map(visible, titles.tolist())), index.astype(np.int32))
        surface = Surface(np.array(mesh.vertices, np.float64), np.array(mesh.faces, np.int64))
        return cls(surface, size, unit_from, Source(None, "trimesh"), regions)

    def to_trimesh(self) -> Any:
        """Return the surface as a `trimesh.Trimesh`: every coordinate as stored, in the part's unit, nothing merged.

        A unit that was assumed is not stated; the name of each triangle's region is in `face_attributes["region"]`.
        Raises `GeometryError` where the part is a mesh of cells.

        >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], unit="cm")
        >>> mesh = part.to_trimesh()
        >>> mesh.units, round(float(mesh.volume), 6)
        ('cm', 0.166667)
        """
        import trimesh

        vertices, faces = self._indexed()
        mesh = trimesh.Trimesh(vertices.copy(), faces.copy(), process=False, validate=False)
        if self.unit_from != "assumed":
            number, _, base = self.unit.name.rpartition(" ")
            base = _NAMES_IN_TRIMESH.get(base, base)
            mesh.units = f"{number} * {base}" if number else base
        if self.regions is not None:
            mesh.face_attributes["region"] = np.array(self.regions.names)[self.regions.index]
        return mesh

    def to_meshio(self) -> Any:
        """Return the part as a `meshio.Mesh`, in its unit, without the names of its regions.

        >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
        >>> part.to_meshio().cells_dict["triangle"].shape
        (4, 3)
        """
        import meshio

        if isinstance(self.geometry, Cells):
            return meshio.Mesh(self.geometry.points, [(block.kind, block.nodes) for block in self.geometry.blocks])
        vertices, faces = self._indexed()
        return meshio.Mesh(vertices, [("triangle", faces)])

    def to_manifold(self) -> Any:
        """Return the surface as a `manifold3d.Manifold`, in its unit; vertices at one place become one.

        Raises `GeometryError` where it is not closed, or the part is a mesh of cells.
        """
        from inertia.mesh.manifold import solid

        vertices, faces = self._indexed()
        unique, number = np.unique(vertices, axis=0, return_inverse=True)
        return solid(unique, number.reshape(-1)[faces], 0)

    def to_pyvista(self) -> Any:
        """Return the surface as a `pyvista.PolyData`, in its unit.

        Raises `UsageError` where PyVista is not installed, `GeometryError` where the part is a mesh of cells.
        """
        try:
            import pyvista
        except ImportError:
            raise UsageError(
                "PyVista is not installed: install it by pip install pyvista", code="needs_package"
            ) from None
        return pyvista.PolyData.from_regular_faces(*self._indexed())

    def _indexed(self) -> tuple[Float, Int]:
        """Return the vertices (n, 3) of the surface, as stored, and its faces (m, 3)."""
        surface = self.triangles
        if isinstance(surface, Surface):
            return surface.vertices, surface.faces
        return surface.corners().reshape(-1, 3), np.arange(3 * surface.count).reshape(-1, 3)

    def plot(self, ax: Axes | None = None) -> Figure:
        """Draw the surface as seen from the side and above, z upright, and return the figure.

        Of more than 200,000 triangles that many are drawn. Raises `GeometryError` where the part is a mesh of cells,
        `UsageError` where matplotlib is not installed.
        """
        from inertia.plotting import draw_triangles, figure_of

        corners = self.triangles.sample(DRAWN)
        return figure_of(lambda axes: draw_triangles(axes, corners), ax, visible(Path(self.name).name))

    def _repr_html_(self) -> str:
        """Return a small table, as a notebook shows it."""
        from inertia.notebook import html_of

        elements = self.geometry.count
        rows = [
            ("Part", f"{self.name} ({self.source.format})"),
            ("Unit", f"{self.unit.name}{', assumed' if self.unit_from == 'assumed' else ''}"),
            ("Mesh", f"{elements} {'cells' if isinstance(self.geometry, Cells) else 'triangles'}"),
            *([("Regions", ", ".join(self.regions.names))] if self.regions is not None else []),
            *([("Shape", "true faces, integrated in place of the triangles")] if self.shape is not None else []),
            *(("Note", note) for note in self.notes),
        ]
        return html_of(rows)

    @property
    def triangles(self) -> Triangles:
        """The surface; raises `GeometryError` where the part is a mesh of cells."""
        if isinstance(self.geometry, Cells):
            raise GeometryError(f"{self.name} is a mesh of cells, which has no surface of its own")
        return self.geometry

    @property
    def name(self) -> str:
        """The file's path as it may be printed, or `"the part"`."""
        return visible(self.source.path or "the part")
