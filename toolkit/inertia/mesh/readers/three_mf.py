"""3MF: build items place objects, which are meshes or assemblies of objects, of this model or of another.

Supports and other helpers of the printer are no part of the product and are left out, as components too: what a mesh is
its own object says, not one that is made of components (section 4), or what a slicer says of it or beside it. Items
that a slicer has marked ``printable="0"`` count: the format knows no such attribute, and to any other program they are
items as the rest.
Source: 3MF Consortium, "Core Specification" 1.3, sections 3 and 4, and "Production Extension" 1.1, section 4.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TypeVar
from xml.parsers import expat

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError, visible
from inertia.mesh.part import Rounding
from inertia.mesh.readers.contents import (
    EXPANDED_LIMIT,
    MOST_NODES,
    Contents,
    Layout,
    Piece,
    assemble,
    check_indices,
    plural,
    shown,
    was,
)
from inertia.mesh.readers.decimals import rounding_of, written
from inertia.mesh.readers.placement import Exact, Placement
from inertia.mesh.readers.slicers import ALL, SETTINGS, helpers, is_helper, run_of
from inertia.mesh.readers.zip import inflate
from inertia.mesh.tree import MeshNode, unique
from inertia.records import dataclass
from inertia.units import Unit, length_unit

_UNITS = ("micron", "millimeter", "centimeter", "inch", "foot", "meter")
_HELPERS = ("support", "solidsupport", "other")
_MARKED = "marked"
"""Among the types of what is left out: what a slicer calls modifier or support."""
_UNDERSTOOD = (
    "http://schemas.microsoft.com/3dmanufacturing/core/",
    "http://schemas.microsoft.com/3dmanufacturing/production/",
    "http://schemas.microsoft.com/3dmanufacturing/material/",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/",
    "http://schemas.microsoft.com/3dmanufacturing/beamlattice/",  # which is refused where there is one
)
"""Extensions that a file may require, by how their namespaces begin: the others may change the shape."""
_FALSE = ("0", "false")
_ROOT_NAME = "3d/3dmodel.model"
_DEPTH_LIMIT = 100

T = TypeVar("T")
_Key = tuple[str, str]
"""The part of the archive and the id that an object has there."""


@dataclass
class _Object:
    """A mesh, as the words of the file, or an assembly of (object, where it is put)."""

    name: str | None
    type: str
    coordinates: list[str] = field(default_factory=list)
    corners: list[str] = field(default_factory=list)
    components: list[tuple[_Key, Placement]] = field(default_factory=list)
    helpers: set[tuple[int, int]] = field(default_factory=set)
    marked: int = 0

    def take_out(self, helpers: set[tuple[int, int]]) -> None:
        """Take out the runs of triangles, (first, last), that a slicer calls modifiers or supports, and count them."""
        for first, last in sorted(helpers, reverse=True):
            has = len(self.corners)
            del self.corners[3 * first : 3 * (last + 1)]
            self.marked += len(self.corners) < has

    @cached_property
    def mesh(self) -> tuple[Float, Int, Rounding | None]:
        """Vertices, faces and what reading rounded; every instance shares them."""
        what = f"object {shown(self.name)}" if self.name else "an object"
        try:
            vertices = np.array(_numbers(self.coordinates, float), np.float64).reshape(-1, 3)
            faces = np.array(_numbers(self.corners, int), np.int64).reshape(-1, 3)
        except (ValueError, OverflowError):
            raise ReadError(f"{what} has {self._culprit()} must stand: export it again", code="not_a_number") from None
        check_indices(faces, len(vertices), f"{what}, triangle")
        words = self.coordinates
        return vertices, faces, rounding_of(vertices, lambda: " ".join(words).encode(), lambda: words)

    def _culprit(self) -> str:
        """Return the first word that is no number, and what must stand in its place."""
        for words, kind, says in ((self.coordinates, float, "a number"), (self.corners, np.int64, "an index")):
            for word in words:
                try:
                    kind(*_numbers([word], str))
                except (ValueError, OverflowError):
                    return f"{shown(word)} where {says}"
        raise AssertionError("the words are numbers one by one, but not together")


@dataclass
class _Model:
    """One model part: its unit, its objects, and what it builds: which, where, and whether it is to be printed."""

    unit: Unit
    objects: dict[str, _Object] = field(default_factory=dict)
    items: list[tuple[_Key, Placement, bool]] = field(default_factory=list)


def read_3mf(path: Path) -> Contents:
    """Read the build of a 3MF file, in the unit that it states (millimetres where it states none)."""
    package, model, items, notes = _build(path)
    whole, regions, rounding = assemble([piece for key, place in items for piece in package.pieces(key, place)])
    return Contents(whole, model.unit, regions, notes, rounding=rounding)


def three_mf_tree(path: Path) -> Layout:
    """Read the build of a 3MF file as a tree: its items, their components, and each mesh in its own axes."""
    package, model, items, notes = _build(path)
    nodes: list[MeshNode] = []
    keys: list[_Key] = []
    waiting: list[tuple[_Key, Placement, int | None]] = [(*item, None) for item in reversed(items)]
    while waiting:
        key, place, above = waiting.pop()
        item = package.object(key)
        waiting += [(component, inside, len(nodes)) for component, inside in reversed(item.components)]
        nodes.append(MeshNode(item.name, above, place.motion(), str(len(keys)) if item.corners else None))
        keys.append(key)
        if len(nodes) > MOST_NODES:
            raise ReadError(f"its components make more than {MOST_NODES} parts: split the build", code="too_large")
    shows = list(dict.fromkeys(key for key, node in zip(keys, nodes, strict=True) if node.mesh is not None))
    titles = unique(visible(package.object(key).name or f"object {key[1]}") for key in shows)
    called = dict(zip(shows, titles, strict=True))
    nodes = [replace(node, mesh=node.mesh and called[key]) for key, node in zip(keys, nodes, strict=True)]
    meshes = {}
    for key, title in called.items():
        whole, _, rounding = assemble([Piece(None, *package.object(key).mesh)])
        meshes[title] = Contents(whole, model.unit, rounding=rounding)
    return Layout(nodes, meshes, notes)


def _build(path: Path) -> tuple[_Package, _Model, list[tuple[_Key, Placement]], tuple[str, ...]]:
    """Return what a file holds, what it builds of that but for the printer's helpers, and the notes."""
    package = _Package(inflate(path, lambda name: name.endswith((".model", ".rels", *SETTINGS))))
    model = package.model(package.root)
    package.take_out_helpers()
    counts = [package.count(key) for key, _, _ in model.items]
    built = [item for item, (triangles, _) in zip(model.items, counts, strict=True) if triangles]
    if sum(triangles for triangles, _ in counts) > EXPANDED_LIMIT:
        raise ReadError(f"its components make more than {EXPANDED_LIMIT} triangles: split the build", code="too_large")
    types = sum((own for _, own in counts), Counter[str]())
    notes = []
    if others := package.units - {model.unit}:
        which = " and ".join(sorted(unit.name for unit in others))
        notes.append(f"a model in it states the unit {which}, but was read in that of the build, {model.unit.name}")
    if unbuilt := types.pop("other", 0):
        notes.append(f"{plural(unbuilt, 'object')} of the type other, which is not built, {was(unbuilt)} left out")
    marked = types.pop(_MARKED, 0)
    if supports := types.total():
        notes.append(f"{plural(supports, 'support')} {was(supports)} left out")
    if marked:
        notes.append(f"{plural(marked, 'volume')}, which a slicer calls modifier or support, {was(marked)} left out")
    if unprinted := sum(not printed for _, _, printed in built):
        notes.append(
            f'{plural(unprinted, "build item")} that a slicer has marked as not to be printed (printable="0") '
            f"{was(unprinted)} counted"
        )
    return package, model, [(key, place) for key, place, _ in built], tuple(notes)


class _Package:
    """The model parts of an archive, parsed when they are asked for."""

    def __init__(self, members: dict[str, bytes]) -> None:
        self._members = members
        self._models: dict[str, _Model] = {}
        self._counts: dict[_Key, tuple[int, Counter[str]]] = {}
        self._open: list[_Key] = []

    @property
    def root(self) -> str:
        """Name of the part that holds the build."""
        relations = self._members.get("_rels/.rels")
        targets = [] if relations is None else _start_parts(relations)
        models = [name for name in self._members if name.endswith(".model")]
        named = [name for name in (*targets, _ROOT_NAME, *models[:1]) if name in models]
        if not named:
            raise ReadError(
                "it is a zip archive without a 3D model, which 3MF holds as .model: export it again",
                code="wrong_format",
            )
        return named[0]

    def model(self, part: str) -> _Model:
        """Return the model that `part` holds."""
        if part not in self._models:
            if part not in self._members:
                raise ReadError(f"it refers to the part {shown(part)}, which it does not hold: export it again")
            self._models[part] = _parse_model(part, self._members[part])
        return self._models[part]

    def take_out_helpers(self) -> None:
        """Take what the settings of a slicer call a modifier or a support out of the build."""
        objects = self.model(self.root).objects
        runs, components = helpers(text for name, text in self._members.items() if name.endswith(SETTINGS))
        for name, each in objects.items():
            each.take_out({(first, last) for owner, first, last in runs if owner == name})
        for name, inside in components:
            if (item := objects.get(name)) is not None:
                kept = [
                    (key, place)
                    for key, place in item.components
                    if key[1] != inside or self.object(key).type in _HELPERS  # which is left out as it is
                ]
                item.marked += len(item.components) - len(kept)
                item.components = kept

    @property
    def units(self) -> set[Unit]:
        """Units that the models which have been asked for state."""
        return {model.unit for model in self._models.values()}

    def object(self, key: _Key) -> _Object:
        """Return an object."""
        part, name = key
        item = self.model(part).objects.get(name)
        if item is None:
            raise ReadError(f"it places object {shown(name)}, which it does not hold: export it again")
        return item

    def count(self, key: _Key) -> tuple[int, Counter[str]]:
        """Return the triangles that an object expands to, without expanding it, and the helpers in it, by their type.

        Every mesh has at least one triangle, but helpers have none, and components of nothing else are taken out.
        """
        if key in self._open or len(self._open) > _DEPTH_LIMIT:
            raise ReadError(
                f"object {shown(key[1])} is a component of itself or nested too deep: export it again", code="cycle"
            )
        if key not in self._counts:
            item = self.object(key)
            self._open.append(key)
            inside = [self.count(component) for component, _ in item.components]
            self._open.pop()
            helper = not inside and item.type in _HELPERS
            if not (item.corners or inside or helper or item.marked):
                raise ReadError(
                    f"object {shown(item.name or key[1])} has neither triangles nor components", code="empty"
                )
            triangles = 0 if helper else sum(count for count, _ in inside) + len(item.corners) // 3
            marked = Counter({_MARKED: item.marked})
            helpers = Counter([item.type]) if helper else sum((own for _, own in inside), marked)
            item.components = [each for each, (count, _) in zip(item.components, inside, strict=True) if count]
            self._counts[key] = triangles, helpers
        return self._counts[key]

    def pieces(self, key: _Key, place: Placement, inherited: str | None = None) -> Iterator[Piece]:
        """Yield every mesh in an object, put where `place` says."""
        item = self.object(key)
        name = item.name or inherited
        if item.corners:
            vertices, faces, own = item.mesh
            exact = partial(map, written, item.coordinates)
            yield Piece(name or f"object {key[1]}", *place.move(vertices, faces, exact, own))
        for component, inside in item.components:
            yield from self.pieces(component, place @ inside, name)


def _start_parts(relations: bytes) -> list[str]:
    """Return the targets of the relations that name a 3D model."""
    targets = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if attributes.get("Type", "").endswith("/3dmodel"):
            targets.append(_part_name(attributes["Target"]))

    _parse(expat.ParserCreate(namespace_separator=" "), relations, start, {})
    return targets


def _parse_model(part: str, data: bytes) -> _Model:
    model = _Model(length_unit("mm"))
    inside: list[_Object] = []  # the object that is being read
    core = ""
    spaces: dict[str, str] = {}
    parser = expat.ParserCreate(namespace_separator=" ")

    def reference(attributes: dict[str, str]) -> tuple[_Key, Placement]:
        other = next((value for name, value in attributes.items() if name.endswith(" path")), None)
        key = part if other is None else _part_name(other), attributes["objectid"]
        return key, _placement(attributes.get("transform"))

    def mark(text: str) -> None:
        if says := text.strip():
            parser.CharacterDataHandler = None
            inside[0].helpers |= {ALL} if says.lower() == "true" else set()

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal core
        space, _, name = tag.rpartition(" ")
        if name == "vertex" and inside and space == core:
            inside[0].coordinates += attributes["x"], attributes["y"], attributes["z"]
        elif name == "triangle" and inside and space == core:
            inside[0].corners += attributes["v1"], attributes["v2"], attributes["v3"]
        elif name == "object" and space == core:
            inside[:] = [_Object(attributes.get("name") or None, attributes.get("type", "model"))]
            if attributes["id"] in model.objects:
                raise ReadError(f"it has two objects with the id {shown(attributes['id'])}: export it again")
            model.objects[attributes["id"]] = inside[0]
        elif name == "component" and inside and space == core:
            inside[0].components.append(reference(attributes))
        elif name == "metadata" and inside and not model.items:
            parser.CharacterDataHandler = mark if is_helper(attributes.get("name", "")) else None
        elif name == "volume" and inside and "slic3r" in space.lower() and attributes.get("modifier") == "1":
            inside[0].helpers.add(run_of(attributes, "ts", "te"))
        elif name == "item" and space == core:
            model.items.append((*reference(attributes), attributes.get("printable") not in _FALSE))
        elif name == "model":
            core = space
            for prefix in attributes.get("requiredextensions", "").split():
                if not spaces.get(prefix, "").startswith(_UNDERSTOOD):
                    raise ReadError(
                        f"it requires the extension {shown(spaces.get(prefix, prefix), 80)}: export it without",
                        code="not_read",
                    )
            unit = attributes.get("unit", "millimeter")
            if unit not in _UNITS:
                raise ReadError(
                    f"its unit is {shown(unit)}, but 3MF knows {', '.join(_UNITS)}: export it again",
                    code="unknown_unit",
                )
            model.unit = length_unit(unit)
        elif name == "beamlattice":
            raise ReadError("it holds a beam lattice, which is not read: export the lattice as a mesh", code="not_read")

    _parse(parser, data, start, spaces)
    for item in model.objects.values():
        item.take_out(item.helpers)
    return model


def _parse(
    parser: expat.XMLParserType, data: bytes, start: Callable[[str, dict[str, str]], None], spaces: dict[str, str]
) -> None:
    """Hand each element to `start`, once the namespaces that it declares are in `spaces`, by their prefixes."""

    def declare(prefix: str | None, space: str | None) -> None:
        if prefix and space:
            spaces[prefix] = space

    def no_document_type(*_: object) -> None:
        raise ReadError("it declares a document type, which 3MF forbids: export it again")

    parser.StartElementHandler = start
    parser.StartNamespaceDeclHandler = declare
    parser.StartDoctypeDeclHandler = no_document_type
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise ReadError(f"its XML is damaged ({error}): export it again", code="damaged_xml") from None
    except KeyError as missing:
        raise ReadError(
            f"its XML lacks the attribute {missing} at line {parser.CurrentLineNumber}: export it again"
        ) from None
    except ReadError:  # it is a ValueError too
        raise
    except (LookupError, ValueError) as error:  # an encoding that Python does not know, or not for XML
        raise ReadError(f"its XML cannot be decoded ({error}): export it as UTF-8", code="encoding") from None


def _numbers(words: Sequence[str], kind: Callable[[str], T]) -> list[T]:
    """Return words as numbers, of which Python takes more for some than XML does; raise `ValueError` for those."""
    text = "".join(words)
    if "_" in text or not text.isascii():
        raise ValueError
    return list(map(kind, words))


def _part_name(target: str) -> str:
    return target.lstrip("/").lower()


def _placement(text: str | None) -> Placement:
    """Return the placement that acts on columns, from the twelve numbers of one that acts on rows."""
    if text is None:
        return Placement.identity()
    words = text.split()
    matrix = np.eye(4)
    try:
        matrix[:3] = np.array(_numbers(words, float)).reshape(4, 3).T
    except ValueError:
        raise ReadError(f"the transform {shown(text)} is not twelve numbers: export it again") from None

    def exact() -> Exact:
        rows = [[written(word) for word in words[axis::3]] for axis in range(3)]
        return [*rows, [written("0"), written("0"), written("0"), written("1")]]

    return Placement.of(matrix, exact)
