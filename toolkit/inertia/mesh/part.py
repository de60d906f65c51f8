"""`Part`: coordinates as stored, their unit, and where they came from.

A part holds one of three geometries:

* `Facets`: the 50-byte records of a binary STL file, in memory or, of a large one, still in the file;
* `Surface`: vertices and triangles (both of them in `surface`);
* `Cells`: a volume mesh (or wires and points) as blocks of cells, with meshio's names and node order.

Coordinates are never multiplied by a unit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float, Int
from inertia.errors import GeometryError, ReadError, UsageError, placed, visible
from inertia.mesh.doubt import Doubt, Guess
from inertia.mesh.shape import Shape
from inertia.mesh.surface import Facets, Surface, Triangles
from inertia.mesh.version import Version
from inertia.records import dataclass
from inertia.units import DEFAULT_UNIT, Unit, UnitFrom, length_unit, multiple_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DRAWN = 200_000
"""The most triangles that are drawn, or lines or points of a mesh of cells."""

_NAMES_IN_TRIMESH = {
    "dm": "decimeters",
    "um": "microns",
    "nm": "nanometers",
    "km": "kilometers",
    "ft": "feet",
    "yd": "yards",
}
"""What trimesh calls the units that it knows under another name than `inertia.units`."""


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
    guesses: tuple[Guess, ...] = ()
    """What else repair had to guess: cracks merged, shells turned, bodies united."""

    @classmethod
    def from_arrays(cls, vertices: ArrayLike, faces: ArrayLike, unit: str = "m") -> Part:
        """Make a part from a triangle mesh in memory, `vertices` (n, 3) in `unit` and `faces` (m, 3), which are copied.

        >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], unit="mm")
        >>> part.triangles.count
        4
        """
        surface = Surface(vertices, faces)
        surface.vertices, surface.faces = np.array(surface.vertices), np.array(surface.faces)
        return cls(surface, length_unit(unit), "option")

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
        whose outside the plot of its analysis draws, `UsageError` where matplotlib is not installed.
        """
        from inertia.plotting import draw_triangles, figure_of

        if isinstance(self.geometry, Cells):
            raise GeometryError(
                f"{self.name} is a mesh of cells, which has no surface of its own: draw its outside by "
                "inertia.analyse(part).plot()"
            )
        corners = self.geometry.sample(DRAWN)
        return figure_of(lambda axes: draw_triangles(axes, corners), ax, visible(Path(self.name).name))

    def _repr_html_(self) -> str:
        """Return a small table, as a notebook shows it."""
        from inertia.notebook import html_of

        count = self.geometry.count
        element = "cell" if isinstance(self.geometry, Cells) else "triangle"
        rows = [
            ("Part", f"{self.name} ({self.source.format})"),
            ("Unit", f"{self.unit.name}{', assumed' if self.unit_from == 'assumed' else ''}"),
            ("Mesh", f"{count} {element}{'' if count == 1 else 's'}"),
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
