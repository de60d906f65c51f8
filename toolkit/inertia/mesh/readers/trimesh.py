"""Scenes in XML that trimesh reads, and what their readers do alike; no other module of this folder knows trimesh.

What trimesh would misread in silence is refused, or put right, before it sees the file. A reader checks the numbers,
counts the triangles that the scene shows, and hands on a file with nothing in it but the shape: trimesh needs neither
materials nor animations, whose faults are no faults of the body. The loaders are called by themselves, since
`trimesh.load` merges vertices and hangs what it loads in a graph where names may collide.
"""

from __future__ import annotations

import importlib
import io
import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import field
from typing import Any, NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.part import Rounding
from inertia.mesh.readers.contents import (
    EXPANDED_LIMIT,
    Contents,
    Piece,
    assemble,
    numbers,
    plural,
    quietly,
    shown,
)
from inertia.mesh.readers.placement import Placement
from inertia.records import dataclass
from inertia.units import Unit

_DEPTH_LIMIT = 200


@dataclass(frozen=True)
class Checked:
    """A file that trimesh may see: its loader and bytes, and what has to come out of it.

    `triangles` is their number; `names` tells the names of parts from those that trimesh is given. `rounding` is how
    far a vertex may be from where the file puts it, once its numbers are float64 and the products of matrices rounded.
    """

    loader: str
    data: bytes
    triangles: int
    rounding: float
    unit: Unit | None = None
    notes: tuple[str, ...] = ()
    names: Mapping[str | None, str] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)


class Extent(NamedTuple):
    """The largest coordinate there may be in a scene, matrices taken by their sizes, after how many roundings."""

    reach: float
    roundings: float

    def placed(self, linear: Float, shift: Float, roundings: float = 1) -> Extent:
        """Return the extent after a matrix (3, 3) and a shift, their entries off by so many roundings."""
        reach = float(np.abs(linear).reshape(3, 3).sum(axis=1).max()) * self.reach + float(np.abs(shift).max())
        return Extent(reach, self.roundings + roundings + 4)

    @property
    def rounding(self) -> float:
        """How far a point may be from where the file puts it; twice what the roundings of three coordinates make."""
        return 2.0**-51 * (self.roundings + 4) * self.reach


def extent_of(coordinates: Float) -> Extent:
    """Return the extent of points whose coordinates are decimals."""
    return Extent(float(np.abs(coordinates).max(initial=0.0)), 1)


def farthest(extents: Iterable[Extent]) -> Extent:
    """Return an extent that covers all."""
    several = [Extent(0.0, 0), *extents]
    return Extent(max(each.reach for each in several), max(each.roundings for each in several))


def load(file: Checked) -> Contents:
    """Read a file with a loader of trimesh."""
    pieces: list[Piece] = []
    if file.triangles:
        with quietly("trimesh", file.loader):
            loaders = importlib.import_module("trimesh.exchange.load").mesh_loaders
            scene = loaders[file.loader](io.BytesIO(file.data), file_type=file.loader, resolver=None, **file.options)
            pieces += [Piece(file.names.get(name, name), *mesh) for name, mesh in _placed(scene, file.rounding)]
    count = sum(len(piece.faces) for piece in pieces)
    if count != file.triangles:
        raise ReadError(f"it lists {plural(file.triangles, 'triangle')}, but trimesh read {count}: export it again")
    whole, regions, rounding = assemble([piece for piece in pieces if len(piece.faces)])
    return Contents(whole, file.unit, regions, file.notes, rounding=rounding)


def _placed(scene: dict[str, Any], rounding: float) -> Iterator[tuple[str | None, tuple[Float, Int, Rounding]]]:
    """Yield the meshes that a loader of trimesh returned, each where the scene puts it."""
    if "graph" not in scene:
        yield None, (*_arrays(scene), Rounding(rounding))
    for entry in scene.get("graph", ()):
        if "geometry" in entry:
            vertices, faces = _arrays(scene["geometry"][entry["geometry"]])
            matrix = np.asarray(entry["matrix"], np.float64)
            if not np.array_equal(matrix, np.eye(4)):
                vertices, faces, _ = Placement.of(matrix, list).move(vertices, faces, list)
            yield entry["geometry"], (vertices, faces, Rounding(rounding))


def _arrays(mesh: dict[str, Any]) -> tuple[Float, Int]:
    if mesh["vertices"].dtype != np.float64:
        raise ReadError("trimesh rounds its coordinates to float32: export it as STL or 3MF")
    return mesh["vertices"], np.asarray(mesh["faces"], np.int64)


_EMPTY_TYPE = re.compile(rb"<!DOCTYPE[^<>\[]*(?:\[\s*\]\s*)?>")


class _Builder(ElementTree.TreeBuilder):
    """XML whose document type declares nothing in the file, and so no entities; what it refers to is not fetched."""

    depth = 0

    def __init__(self, data: bytes) -> None:
        super().__init__()
        # a zero byte is that of UTF-16, in which the pattern finds nothing
        self.declares = data.count(b"<!DOCTYPE") != 1 or b"\0" in data or _EMPTY_TYPE.search(data) is None

    def doctype(self, name: str, public: str | None, system: str | None) -> None:
        if self.declares:
            raise ReadError("it declares a document type with contents, which nothing here needs: export it again")

    def start(self, tag: str, attributes: dict[str, str]) -> Element:
        self.depth += 1
        if self.depth > _DEPTH_LIMIT:
            raise ReadError(f"its elements are nested deeper than {_DEPTH_LIMIT}: export it again")
        return super().start(tag, attributes)

    def end(self, tag: str) -> Element:
        self.depth -= 1
        return super().end(tag)


def parse_xml(data: bytes) -> ElementTree.Element:
    """Return the root of an XML text, all tags without their namespaces, and that of the root as its `xmlns`."""
    parser = ElementTree.XMLParser(target=_Builder(data))
    try:
        parser.feed(data)
        root: ElementTree.Element = parser.close()
    except ReadError:
        raise
    except ElementTree.ParseError as error:
        raise ReadError(f"its XML is damaged ({error}): export it again", code="damaged_xml") from None
    except (LookupError, ValueError) as error:  # an encoding that Python does not know
        raise ReadError(f"its XML cannot be decoded ({error}): export it as UTF-8", code="encoding") from None
    namespace = root.tag.rpartition("}")[0][1:]
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    if namespace:
        root.set("xmlns", namespace)
    return root


def xml_text(root: ElementTree.Element) -> bytes:
    """Return an element as the text of a file."""
    text: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return text


def finite_numbers(element: Element, what: str) -> Float:
    """Return the numbers in an element, once they are known to be finite."""
    values: Float = numbers((element.text or "").encode(), np.float64, what)
    if not np.isfinite(values).all():
        raise ReadError(f"{what} hold a number that is not finite: export it again", code="non_finite")
    return values


def by_id(elements: Iterable[Element]) -> dict[str, Element]:
    """Return id → element; raise `ReadError` where two have the same."""
    table: dict[str, Element] = {}
    for element in elements:
        name = element.get("id")
        if name is not None and table.setdefault(name, element) is not element:
            raise ReadError(f"two of its elements have the id {shown(name)}: export it again")
    return table


def remove(root: Element, tags: Iterable[str]) -> int:
    """Remove the elements with one of `tags`, and return how many there were."""
    unwanted = frozenset(tags)
    before = 0
    for parent in list(root.iter()):
        rest = [child for child in parent if child.tag not in unwanted]
        before += len(parent) - len(rest)
        if len(rest) < len(parent):
            parent[:] = rest
    return before


class Expansion:
    """The triangles that a thing expands to, from those that the things in it do; each is counted once.

    `inside` returns the triangles of a thing itself, and the keys of the things in it.
    """

    def __init__(self, inside: Callable[[Hashable], tuple[int, Iterable[Hashable]]]) -> None:
        self.inside = inside
        self.counts: dict[Hashable, int] = {}
        self.open: set[Hashable] = set()

    def __call__(self, key: Hashable) -> int:
        """Return the triangles that a thing expands to."""
        if key in self.open or len(self.open) > _DEPTH_LIMIT:
            raise ReadError("a part of it is a part of itself, or is nested too deep: export it again", code="cycle")
        if key not in self.counts:
            self.open.add(key)
            own, parts = self.inside(key)
            self.counts[key] = own + sum(map(self, parts))
            self.open.remove(key)
            if self.counts[key] > EXPANDED_LIMIT:
                raise ReadError(
                    f"its instances make more than {EXPANDED_LIMIT} triangles: split the scene", code="too_large"
                )
        return self.counts[key]
