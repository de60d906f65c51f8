"""glTF 2.0, as one binary file (GLB) or as JSON with its buffers: the triangles of the scene, node by node.

Only positions, indices and the transforms of nodes matter here. Whatever would change the shape and is not
understood (compression, quantised positions) is refused, because leaving it out would give another body.
Source: Khronos, "glTF 2.0 Specification", 2021.
"""

from __future__ import annotations

import base64
import os
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar
from urllib.parse import unquote, urlsplit

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import ReadError, visible
from inertia.mesh.readers.contents import (
    EXPANDED_LIMIT,
    Contents,
    Layout,
    Piece,
    assemble,
    beneath,
    check_indices,
    plural,
    shown,
    was,
)
from inertia.mesh.readers.decimals import written
from inertia.mesh.readers.gltf_json import JsonObject, Written, parse
from inertia.mesh.readers.placement import Exact, Placement
from inertia.mesh.tree import MeshNode, Motion, unique
from inertia.units import METRE

T = TypeVar("T")

_MAGIC = b"glTF"
_JSON, _BINARY = b"JSON", b"BIN\0"
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_UNSIGNED = {number: _COMPONENTS[number] for number in (5121, 5123, 5125)}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_SLOPPY = 1e-3  # of the farthest coordinate, what a stated one may be off by: exporters round them
_MODES = {mode: mode for mode in range(7)}
_HARMLESS = (
    *("KHR_node_visibility", "KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_xmp"),
    *("EXT_texture_", "MSFT_texture_"),
)
"""Extensions, by how their names begin, that leave the shape alone even where a file requires them."""


def read_gltf(path: Path) -> Contents:
    """Read a glTF file of either kind; the unit is the metre, as the format has it."""
    pieces, notes = _read(path, lambda scene: list(scene.pieces()))
    whole, regions, rounding = assemble(pieces)
    return Contents(whole, METRE, regions, notes, rounding=rounding)


def gltf_tree(path: Path) -> Layout:
    """Read the nodes of a glTF file, and each mesh in its own axes."""
    (nodes, pieces), notes = _read(path, lambda scene: scene.layout())
    meshes = {}
    for name, own in pieces.items():
        whole, _, rounding = assemble(own)
        meshes[name] = Contents(whole, METRE, rounding=rounding)
    return Layout(nodes, meshes, notes)


def _read(path: Path, do: Callable[[Scene], T]) -> tuple[T, tuple[str, ...]]:
    """Return what is made of the scene of a file, and the notes."""
    text, binary = _chunks(path)
    scene = Scene(parse(text), binary, path.parent)
    result = do(scene)
    notes = []
    if left_out := scene.left_out:
        notes.append(f"{plural(left_out, 'set')} of lines or points {was(left_out)} left out")
    if hidden := scene.hidden:
        notes.append(f"{plural(hidden, 'node')} marked as not visible (KHR_node_visibility) {was(hidden)} counted")
    if "scene" not in scene.tree and (scenes := len(scene.tree.entries("scenes", []))) > 1:
        notes.append(f"of {scenes} scenes, none of which is named as the one to show, the first was read")
    if beyond := len(scene.beyond):
        notes.append(
            f"{plural(beyond, 'accessor')} of positions {'has' if beyond == 1 else 'have'} others than the min and max "
            "stated: make sure that the file and its buffers are of one export"
        )
    return result, tuple(notes)


class Stored(NamedTuple):
    """A buffer: its size, and what returns its bytes between two places; of a file, no others are read."""

    size: int
    between: Callable[[int, int], bytes | memoryview]


def _in_memory(content: bytes) -> Stored:
    view = memoryview(content)
    return Stored(len(view), lambda start, end: view[start:end])


def _in_file(path: Path, first: int, size: int) -> Stored:
    def between(start: int, end: int) -> bytes:
        with path.open("rb") as file:
            file.seek(first + start)
            content = file.read(end - start)
        if len(content) < end - start:
            raise ReadError(
                f"{path.name} became shorter while it was read: read it again once it is written", code="changed"
            )
        return content

    return Stored(size, between)


def _chunks(path: Path) -> tuple[bytes, Stored | None]:
    """Return the JSON of a file, and the binary chunk where it has one."""
    with path.open("rb") as file:
        head = file.read(12)
        if not head.startswith(_MAGIC):
            return head + file.read(), None
        size = os.fstat(file.fileno()).st_size
        stated = int.from_bytes(head[8:12], "little")
        if stated != size:
            raise ReadError(
                f"its header says {stated} bytes, but it holds {size}: it was cut short or damaged", code="cut_short"
            )
        chunks: dict[bytes, tuple[int, int]] = {}
        at = 12
        while at < size:
            file.seek(at)
            head = file.read(8)
            length = int.from_bytes(head[:4], "little")
            if at + 8 + length > size:
                raise ReadError(
                    f"its chunk at byte {at} runs past the end of the file: it is damaged, export it again",
                    code="cut_short",
                )
            chunks.setdefault(head[4:], (at + 8, length))
            at += 8 + length
        if _JSON not in chunks:
            raise ReadError("it has no JSON chunk: it is damaged, export it again")
        start, length = chunks[_JSON]
        file.seek(start)
        return file.read(length), _in_file(path, *chunks[_BINARY]) if _BINARY in chunks else None


class Scene:
    """The default scene of a glTF document."""

    def __init__(self, tree: JsonObject, binary: Stored | None, folder: Path) -> None:
        self.tree = tree
        self.binary = binary
        self.folder = folder
        self.buffers: dict[int, Stored] = {}
        self.left_out = self.hidden = 0
        self.beyond: set[str] = set()
        asset = tree.object("asset")
        version = asset.label("version") or asset.text("version")
        if not version.startswith("2."):
            raise ReadError(
                f"it is glTF {shown(version)}, but only version 2 is read: export it as glTF 2.0", code="not_read"
            )
        least = asset.label("minVersion") or "2.0"
        if least != "2.0":
            raise ReadError(
                f"it needs glTF {shown(least)}, but only version 2.0 is read: export it as glTF 2.0", code="not_read"
            )
        required = map(str, tree.entries("extensionsRequired", []))
        unknown = [name for name in required if not name.startswith(_HARMLESS)]
        if unknown:
            raise ReadError(
                f"it requires the extension {shown(unknown[0])}, which is not read: export it without", code="not_read"
            )

    def pieces(self) -> Iterator[Piece]:
        """Yield every mesh of the scene, where its node puts it."""
        total = 0
        places = {-1: Placement.identity()}
        for index, above, node in self._walk():
            place = places[index] = places[above] @ _placement(node)
            if "mesh" not in node:
                continue
            mesh = self._item("meshes", node, "mesh")
            name = node.label() or mesh.label() or f"mesh {node.whole('mesh')}"
            for vertices, faces in self._surfaces(mesh):
                total += len(faces)
                if total > EXPANDED_LIMIT:
                    raise ReadError(
                        f"its instances make more than {EXPANDED_LIMIT} triangles: split the scene", code="too_large"
                    )
                yield Piece(name, *place.move(vertices, faces, partial(map, Fraction, vertices.ravel().tolist())))

    def layout(self) -> tuple[list[MeshNode], dict[str, list[Piece]]]:
        """Return the nodes, and the pieces of each mesh that they show, in its own axes."""
        nodes: list[MeshNode] = []
        pieces: dict[int, list[Piece]] = {}
        named = [(mesh.label(), f"mesh {k}") for k, mesh in enumerate(self.tree.objects("meshes", []))]
        keys = unique(visible(name or number) for name, number in named)
        places: dict[int, int] = {}
        for index, above, node in self._walk():
            shows = node.whole("mesh") if "mesh" in node else None
            if shows is not None and shows not in pieces:
                pieces[shows] = [Piece(None, *mesh) for mesh in self._surfaces(self._item("meshes", node, "mesh"))]
            _placement(node)  # refuses what cannot be one
            places[index] = len(nodes)
            key = keys[shows] if shows is not None and pieces[shows] else None
            name = node.label() or (None if shows is None else named[shows][0])
            nodes.append(MeshNode(name, places.get(above), _motion(node), key))
        return nodes, {keys[shows]: own for shows, own in pieces.items() if own}

    def _walk(self) -> Iterator[tuple[int, int, JsonObject]]:
        """Yield each node of the scene after the one above it, with the number of that, −1 at the top."""
        visited: set[int] = set()
        roots, where = self._roots()
        waiting = [(root, -1, where) for root in reversed(roots)]
        while waiting:
            index, above, where = waiting.pop()
            node = self._at("nodes", index, where)
            if index in visited:
                raise ReadError(f"node {index} hangs in two places: export it again")
            visited.add(index)
            extensions = node.object("extensions", {})
            self.hidden += extensions.object("KHR_node_visibility", {}).label("visible") == "False"
            if "EXT_mesh_gpu_instancing" in extensions:
                raise ReadError(
                    f"node {index} uses EXT_mesh_gpu_instancing: export it without instancing", code="not_read"
                )
            if "mesh" in node:
                mesh = self._item("meshes", node, "mesh")
                weights = (node if "weights" in node else mesh).entries("weights", [])
                morphs = any(weights) and any(each.entries("targets", []) for each in mesh.objects("primitives"))
                if "skin" in node or morphs:
                    what = "skin" if "skin" in node else "morph"
                    raise ReadError(
                        f"node {index} has a {what}, which moves its vertices: export it as a plain mesh",
                        code="not_read",
                    )
            yield index, above, node
            waiting += [(child, index, node.where("children")) for child in reversed(node.wholes("children"))]

    def _surfaces(self, mesh: JsonObject) -> Iterator[tuple[Float, Int]]:
        """Yield vertices and faces of each primitive of a mesh that has faces."""
        for primitive in mesh.objects("primitives"):
            if primitive.choice("mode", _MODES, _TRIANGLES) < _TRIANGLES:
                self.left_out += 1
            else:
                yield self._mesh(primitive)

    def _roots(self) -> tuple[list[int], str]:
        """Return the nodes at the top of the scene, and the place that names them."""
        if "scenes" in self.tree:
            scene = self._at("scenes", self.tree.whole("scene", 0), "scene")
            return scene.wholes("nodes"), scene.where("nodes")
        nodes = self.tree.objects("nodes", [])
        children = {child for node in nodes for child in node.wholes("children")}
        return [index for index in range(len(nodes)) if index not in children], "nodes"

    def _mesh(self, primitive: JsonObject) -> tuple[Float, Int]:
        positions = self._accessor(primitive.object("attributes"), "POSITION")
        if positions.dtype != np.float32 or positions.shape[1] != 3:
            raise ReadError(
                "its positions are not three float32 numbers each: export it without quantisation", code="not_read"
            )
        accessor = self._item("accessors", primitive.object("attributes"), "POSITION")
        if not _reaches_as_stated(positions, accessor):
            self.beyond.add(accessor.where("min"))
        if "indices" in primitive:
            corners = self._accessor(primitive, "indices")
            if corners.dtype.kind != "u" or corners.shape[1] != 1:
                raise ReadError("its indices are not whole numbers: export it again")
            corners = corners.reshape(-1).astype(np.int64)
        else:
            corners = np.arange(len(positions))
        faces = _triangles(corners, primitive.choice("mode", _MODES, _TRIANGLES))
        check_indices(faces, len(positions), "face")
        if len(positions) > 3 * len(faces):  # many primitives may share one array of positions
            used, corners = np.unique(faces, return_inverse=True)
            positions, faces = positions[used], corners.reshape(-1, 3)
        return positions.astype(np.float64), faces

    def _accessor(self, holder: JsonObject, name: str) -> NDArray[Any]:
        """Return the rows of an accessor, (count, components); no other bytes of its buffer are read."""
        index, accessor = holder.whole(name), self._item("accessors", holder, name)
        if "sparse" not in accessor and "bufferView" not in accessor:
            raise ReadError(
                f"accessor {index} is compressed, which is not read: export it uncompressed", code="not_read"
            )
        dtype = np.dtype(accessor.choice("componentType", _COMPONENTS))
        count, width = accessor.whole("count"), accessor.choice("type", _WIDTHS)
        if "bufferView" in accessor:
            rows = self._rows(f"accessor {index}", accessor, dtype, count, width)
        elif count > 3 * EXPANDED_LIMIT:
            raise ReadError(f"accessor {index} has more than {3 * EXPANDED_LIMIT} rows: split it", code="too_large")
        else:
            rows = np.zeros((count, width), dtype)
        if "sparse" not in accessor:
            return rows
        sparse = accessor.object("sparse")
        some, indices, values = sparse.whole("count"), sparse.object("indices"), sparse.object("values")
        kind = np.dtype(indices.choice("componentType", _UNSIGNED))
        at = self._rows(indices.place, indices, kind, some, 1)[:, 0].astype(np.int64)
        if (np.diff(at) <= 0).any() or at[-1] >= count:
            raise ReadError(
                f"{indices.place} do not rise, or go beyond the {count} rows: it is damaged, export it again"
            )
        rows = rows.copy()
        rows[at] = self._rows(values.place, values, dtype, some, width)
        return rows

    def _rows(self, what: str, place: JsonObject, dtype: np.dtype[Any], count: int, width: int) -> NDArray[Any]:
        """Return rows of a buffer (count, width), whose view and byte offset stand at a place of the JSON."""
        view = self._item("bufferViews", place, "bufferView")
        buffer = self._buffer(view)
        row = width * dtype.itemsize
        start = view.whole("byteOffset", 0)
        end = start + view.whole("byteLength")
        start += place.whole("byteOffset", 0)
        stride = view.whole("byteStride", 0) or row
        stop = start + (count - 1) * stride + row
        if start % dtype.itemsize or stride % dtype.itemsize:
            raise ReadError(
                f"{what} begins at byte {start} of its buffer with a stride of {stride}, not both multiples "
                f"of the {dtype.itemsize} bytes of its numbers: it is damaged, export it again"
            )
        if count == 0 or stride < row or stop > min(end, buffer.size):
            raise ReadError(
                f"{what} does not fit in its buffer: it was cut short or damaged, export it again", code="cut_short"
            )
        return np.ndarray((count, width), dtype, buffer.between(start, stop), 0, (stride, dtype.itemsize))

    def _buffer(self, view: JsonObject) -> Stored:
        index = view.whole("buffer")
        if index not in self.buffers:
            buffer = self._item("buffers", view, "buffer")
            inside = index == 0 and self.binary is not None and "uri" not in buffer
            content = self.binary if inside else self._fetch(buffer.text("uri"), buffer.where("uri"))
            if content is None or content.size < buffer.whole("byteLength"):
                raise ReadError(
                    f"buffer {index} is shorter than it says: it was cut short, export it again", code="cut_short"
                )
            self.buffers[index] = content
        return self.buffers[index]

    def _fetch(self, uri: str, where: str) -> Stored:
        if uri.startswith("data:"):
            header, _, payload = uri.partition(",")
            try:
                return _in_memory(base64.b64decode(payload, validate=True) if header.endswith(";base64") else b"")
            except ValueError:
                raise ReadError(f"{where} is not valid base64: it is damaged, export it again") from None
        try:
            elsewhere = bool(urlsplit(uri).scheme)
        except ValueError:  # brackets that hold no address
            elsewhere = True
        if elsewhere:
            raise ReadError(
                f"it needs the file {shown(uri)}, which is not fetched: put it beside it, named by its path",
                code="outside_folder",
            )
        beside = beneath(self.folder, unquote(uri))
        return _in_file(beside, 0, beside.stat().st_size)

    def _item(self, kind: str, holder: JsonObject, name: str) -> JsonObject:
        """Return the item of a list that a property refers to."""
        return self._at(kind, holder.whole(name), holder.where(name))

    def _at(self, kind: str, index: int, where: str) -> JsonObject:
        """Return an item of a list by its number, which stands at a place of the JSON."""
        items = self.tree.entries(kind, [])
        if index >= len(items):
            raise ReadError(
                f"{where} refers to {kind}[{index}], but the file holds {len(items)}: it is damaged, export it again"
            )
        return JsonObject(items[index], f"{kind}[{index}]")


def _reaches_as_stated(positions: NDArray[Any], accessor: JsonObject) -> bool:
    """Say whether positions (n, 3) reach as far as their accessor states, where it does; exporters round that."""
    try:
        stated = [accessor.numbers(name, 3) for name in ("min", "max")]
    except ReadError:
        return False
    farthest = np.abs(positions).max()
    return all(
        numbers is None or np.abs(np.subtract(numbers, has)).max() <= _SLOPPY * max(farthest, *map(abs, numbers))
        for numbers, has in zip(stated, (positions.min(axis=0), positions.max(axis=0)), strict=True)
    )


def _triangles(corners: Int, mode: int) -> Int:
    if mode == _TRIANGLES:
        if len(corners) % 3:
            raise ReadError(f"a mesh has {len(corners)} corners, not a multiple of three: export it again")
        return corners.reshape(-1, 3)
    if mode == _STRIP:
        faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
        faces[1::2] = faces[1::2, [0, 2, 1]]
        return faces
    return np.stack([corners[1:-1], corners[2:], np.broadcast_to(corners[:1], len(corners[2:]))], axis=1)


class _Steps(NamedTuple):
    """The translation, rotation and scale of a node, as the file writes them."""

    translation: list[float]
    rotation: list[float]
    scale: list[float]

    @classmethod
    def of(cls, node: JsonObject) -> _Steps | None:
        """Return those of a node, None where it has none; raise `ReadError` where one is no such thing."""
        move, turn, scale = node.numbers("translation", 3), node.numbers("rotation", 4), node.numbers("scale", 3)
        if turn is not None and not any(turn):
            raise ReadError(f"{node.where('rotation')} is a quaternion of zero: export it again")
        if move is turn is scale is None:
            return None
        return cls(move or [0, 0, 0], turn or [0, 0, 0, 1], scale or [1, 1, 1])


def _matrix(node: JsonObject) -> list[float] | None:
    """Return the matrix of a node, column by column, None where it has none."""
    matrix = node.numbers("matrix", 16)
    if matrix is not None and matrix[3::4] != [0, 0, 0, 1]:
        raise ReadError(f"{node.where('matrix')} is a matrix whose last row is not 0, 0, 0, 1: export it again")
    return matrix


def _placement(node: JsonObject) -> Placement:
    """Return the placement of a node: its matrix, or translation · rotation · scale."""
    if (entries := _matrix(node)) is not None:
        return Placement.of(np.array(entries, np.float64).reshape(4, 4).T, lambda: _columns(_fractions(entries)))
    if (steps := _Steps.of(node)) is None:
        return Placement.identity()
    matrix, size = np.eye(4), np.eye(4)
    with np.errstate(all="ignore"):
        x, y, z, w = np.array(steps.rotation, np.float64)
        squares = x * x + y * y + z * z + w * w
        matrix[:3, :3] = np.eye(3) + 2 / squares * np.array(
            [
                [-y * y - z * z, x * y - z * w, x * z + y * w],
                [x * y + z * w, -x * x - z * z, y * z - x * w],
                [x * z - y * w, y * z + x * w, -x * x - y * y],
            ]
        )
        scale = np.array(steps.scale, np.float64)
        matrix[:3, :3] *= scale
        matrix[:3, 3] = steps.translation
        size[:3, :3] = (np.eye(3) + 2) * np.abs(scale)  # |2 x y|, and the like, are at most the sum of the squares
        size[:3, 3] = np.abs(matrix[:3, 3])
    return Placement.of(matrix, lambda: _exactly(steps), roundings=20, size=size)


def _motion(node: JsonObject) -> Motion:
    if (entries := _matrix(node)) is not None:
        return Motion.of(_columns(_fractions(entries)))
    steps = _Steps.of(node) or _Steps([0, 0, 0], [0, 0, 0, 1], [1, 1, 1])
    move, turn, size = map(_fractions, steps)
    linear = tuple(tuple(size[k] if k == j else Fraction(0) for j in range(3)) for k in range(3))
    return Motion(tuple(move), linear, tuple(turn) if any(turn[:3]) else None)


def _fractions(values: list[float]) -> list[Fraction]:
    return [written(value.text) if isinstance(value, Written) else Fraction(value) for value in values]


def _columns(values: list[Fraction]) -> Exact:
    return [values[row::4] for row in range(4)]


def _exactly(steps: _Steps) -> Exact:
    """Return translation · rotation · scale in fractions; a quaternion is normalised as a ratio."""
    translation, (x, y, z, w), scale = map(_fractions, steps)
    twice = 2 / (x * x + y * y + z * z + w * w)
    rotation = [
        [1 - twice * (y * y + z * z), twice * (x * y - z * w), twice * (x * z + y * w)],
        [twice * (x * y + z * w), 1 - twice * (x * x + z * z), twice * (y * z - x * w)],
        [twice * (x * z - y * w), twice * (y * z + x * w), 1 - twice * (x * x + y * y)],
    ]
    rows = [
        [*(a * s for a, s in zip(row, scale, strict=True)), t] for row, t in zip(rotation, translation, strict=True)
    ]
    return [*rows, [Fraction(0), Fraction(0), Fraction(0), Fraction(1)]]
