"""Collada 1.4 and 1.5 (`.dae`), also zipped (`.zae`): the triangles of the scene, node by node, through trimesh.

The unit is the file's, to the last digit; the axes are the file's own (`up_axis` turns nothing). pycollada, which
trimesh reads Collada with, rounds every number to float32; it is lent float64 instead. It also (0.9.3) turns NaN into
zero, takes every list of positions for x, y, z without gaps, reads the first list of triangles alone, passes over
polygons with holes, and takes the axis of a rotation for a unit vector, whatever it is.
Source: Khronos, "COLLADA Digital Asset Schema Release" 1.4.1 and 1.5.0, chapters 5 and 8.
"""

from __future__ import annotations

import contextlib
import importlib
import threading
from collections.abc import Hashable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any, TypeVar
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError, UsageError, visible
from inertia.mesh.readers.contents import (
    MOST_NODES,
    Contents,
    Layout,
    around_notches,
    check_indices,
    fan,
    fan_note,
    numbers,
    plural,
    quietly,
    shown,
    was,
)
from inertia.mesh.readers.decimals import written
from inertia.mesh.readers.trimesh import (
    Checked,
    Expansion,
    Extent,
    by_id,
    extent_of,
    farthest,
    finite_numbers,
    load,
    parse_xml,
    remove,
    xml_text,
)
from inertia.mesh.readers.zip import inflate
from inertia.mesh.tree import ONE, Matrix, MeshNode, Motion, rotation, times, unique
from inertia.mesh.turns import about
from inertia.units import METRE, Unit, multiple_of

T = TypeVar("T")

_APPEARANCE = (
    "extra", "bind_material", "instance_light", "instance_camera", "library_materials", "library_effects",
    "library_images", "library_lights", "library_cameras", "library_controllers", "library_physics_scenes",
    "library_physics_models", "library_physics_materials", "library_force_fields", "library_animation_clips",
)  # fmt: skip
_LINES = ("lines", "linestrips", "points")
_POLYGONS = ("triangles", "tristrips", "trifans", "polylist", "polygons")
_TRANSFORMS = {"translate": 3, "scale": 3, "rotate": 4, "matrix": 16}
_SCENE = "the-scene-of-one-geometry"
_LOCK = threading.Lock()


def read_collada(path: Path) -> Contents:
    """Read a Collada file, zipped or not."""
    return _load(_checked(parse_xml(_text(path))))


def collada_tree(path: Path) -> Layout:
    """Read the nodes of a Collada file, and each geometry in its own axes."""
    text = _text(path)
    checked = parse_xml(text)
    file = _checked(checked)  # which rounds the axes of rotations
    root = parse_xml(text)
    places = by_id([*root.iter("visual_scene"), *root.iter("node")])
    geometries = by_id(checked.findall("library_geometries/geometry"))
    shown_by = {name: each.get("name") or name for name, each in geometries.items()}
    titles = dict(zip(shown_by, unique(map(visible, shown_by.values())), strict=True))
    scene = root.find("scene/instance_visual_scene")
    assert scene is not None
    nodes: list[MeshNode] = []
    meshes: dict[str, Contents | None] = {}
    top = _target(scene, places)
    waiting: list[tuple[Element, int | None]] = [(each, None) for each in reversed(_nodes_in(top, places))]
    while waiting:
        node, above = waiting.pop()
        here, inner = len(nodes), _nodes_in(node, places)
        nodes.append(MeshNode(node.get("name") or node.get("id"), above, _motion(node)))
        shows = [_target(each, geometries).get("id", "") for each in node.findall("instance_geometry")]
        for geometry in shows:
            if geometry not in meshes:
                meshes[geometry] = _alone(checked, geometries[geometry], file)
            if meshes[geometry] is None:
                continue
            if shows == [geometry] and not inner:
                nodes[here] = replace(nodes[here], mesh=titles[geometry])
            else:
                nodes.append(MeshNode(shown_by[geometry], here, Motion(), titles[geometry]))
        waiting += [(each, here) for each in reversed(inner)]
        if len(nodes) > MOST_NODES:
            raise ReadError(f"its instances make more than {MOST_NODES} parts: split the scene", code="too_large")
    return Layout(nodes, {titles[name]: mesh for name, mesh in meshes.items() if mesh is not None}, file.notes)


def _text(path: Path) -> bytes:
    data = path.read_bytes()
    return _document(path) if data.startswith(b"PK") else data


def _load(file: Checked) -> Contents:
    with quietly("trimesh", "dae"), _float64_in_pycollada():
        return load(file)


def _nodes_in(element: Element, places: dict[str, Element]) -> list[Element]:
    return [*element.findall("node"), *(_target(each, places) for each in element.findall("instance_node"))]


def _alone(root: Element, geometry: Element, file: Checked) -> Contents | None:
    """Return a geometry in its own axes; None of one without faces."""
    triangles = int((_sizes_of_faces(geometry) - 2).sum())
    if not triangles:
        return None
    alone = Element(root.tag, root.attrib)
    alone.extend(root.findall("asset"))
    SubElement(alone, "library_geometries").append(geometry)
    scene = SubElement(SubElement(alone, "library_visual_scenes"), "visual_scene", id=_SCENE)
    SubElement(SubElement(scene, "node"), "instance_geometry", url=f"#{geometry.get('id')}")
    SubElement(SubElement(alone, "scene"), "instance_visual_scene", url=f"#{_SCENE}")
    arrays = (numbers((array.text or "").encode(), np.float64, "an array") for array in geometry.iter("float_array"))
    rounding = farthest(map(extent_of, arrays)).rounding
    return replace(_load(replace(file, data=xml_text(alone), triangles=triangles, rounding=rounding)), regions=None)


def _motion(node: Element) -> Motion:
    """Return the product of the transforms of a node: exact, but for what angles have beyond 57 digits."""
    linear: Matrix = ONE
    at: tuple[Fraction, ...] = (Fraction(0),) * 3
    for element in node:
        if element.tag not in _TRANSFORMS:
            continue
        values = [written(word) for word in (element.text or "").split()]
        one: Matrix = ONE
        shift = (Fraction(0),) * 3
        match element.tag:
            case "translate":
                shift = (values[0], values[1], values[2])
            case "scale":
                one = tuple(tuple(values[i] if i == j else Fraction(0) for j in range(3)) for i in range(3))
            case "rotate":
                w, *axis = about(values[:3], values[3])
                one = rotation([Fraction(k) for k in (*axis, w)])
            case _:
                one = tuple(tuple(values[4 * i : 4 * i + 3]) for i in range(3))
                shift = (values[3], values[7], values[11])
        x, y, z = shift
        at = tuple(t + a * x + b * y + c * z for t, (a, b, c) in zip(at, linear, strict=True))
        linear = times(linear, one)
    return Motion(at, linear)


def _document(path: Path) -> bytes:
    """Return the document of a ZAE archive: the one that its manifest names, else the only one."""
    members = inflate(path, lambda name: name.endswith(("manifest.xml", ".dae")))
    documents = [name for name in members if name.endswith(".dae")]
    if "manifest.xml" in members:
        root = (parse_xml(members["manifest.xml"]).text or "").strip().lower().removeprefix("./")
        documents = [name for name in documents if name == root] or documents
    if len(documents) != 1:
        raise ReadError(
            f"it holds {plural(len(documents), 'Collada document')}, but one is read: give a .dae file",
            code="several_meshes",
        )
    return members[documents[0]]


def _checked(root: Element) -> Checked:
    if root.tag != "COLLADA":
        raise ReadError(
            f"it begins with {shown(root.tag)}, not with COLLADA: give its format, or export it again",
            code="wrong_format",
        )
    root.attrib.setdefault("xmlns", "http://www.collada.org/2005/11/COLLADASchema")
    remove(root, _APPEARANCE)
    notes = []
    if remove(root, ["library_animations"]):
        notes.append("its animations were left out: it was read as it stands at their beginning")
    lines = remove(root, _LINES)
    for spline in root.findall("library_geometries/geometry/spline"):
        spline.clear()
        spline.tag = "mesh"
        lines += 1
    if lines:
        notes.append(f"{plural(lines, 'set')} of lines or points {was(lines)} left out")
    if next(root.iter("instance_controller"), None) is not None:
        raise ReadError(
            "it has a skin or a morph, whose shape a skeleton decides: export it as a plain mesh", code="not_read"
        )
    placed = {each.get("url") for each in root.iter("instance_geometry")}
    for geometry in root.findall("library_geometries/geometry"):
        if geometry.find("mesh") is None and f"#{geometry.get('id')}" in placed:
            kind = next((each.tag for each in geometry if each.tag != "asset"), "thing of no kind")
            raise ReadError(
                f"its geometry {shown(geometry.get('id', ''))} is a {kind}, which is not read: export it as a mesh",
                code="not_read",
            )
    unit = _unit(root)
    for node in root.iter("node"):
        _check_transforms(node)
    meshes = by_id(each for each in root.findall("library_geometries/geometry") if each.find("mesh") is not None)
    sizes = {name: _sizes_of_faces(geometry) for name, geometry in meshes.items()}
    notes += fan_note(sum(int((each > 3).sum()) for each in sizes.values()), how="into triangles")
    places = by_id([*root.iter("visual_scene"), *root.iter("node")])

    def inside(element: Hashable) -> tuple[int, Iterable[Hashable]]:
        assert isinstance(element, Element)
        own = sum(int((_target(each, sizes) - 2).sum()) for each in element.findall("instance_geometry"))
        return own, [*element.findall("node"), *(_target(each, places) for each in element.findall("instance_node"))]

    scene = root.find("scene/instance_visual_scene")
    if scene is None:
        raise ReadError("it has no scene, so that nothing says where its meshes stand: export it again")
    triangles = Expansion(inside)(_target(scene, places))
    rounding = _extent(root, scene, places).rounding
    return Checked("dae", xml_text(root), triangles, rounding, unit, tuple(notes), options={"ignore_broken": False})


def _extent(root: Element, scene: Element, places: dict[str, Element]) -> Extent:
    """Return the extent of a scene without cycles, every mesh taken for as large as the largest."""
    arrays = (numbers((array.text or "").encode(), np.float64, "an array") for array in root.iter("float_array"))
    mesh = farthest(map(extent_of, arrays))

    @cache
    def extent(element: Element) -> Extent:
        nodes = [*element.findall("node"), *(_target(each, places) for each in element.findall("instance_node"))]
        inner = farthest([mesh, *map(extent, nodes)])
        for each in reversed(element):
            if each.tag in _TRANSFORMS:
                inner = inner.placed(*_matrix_of(each))
        return inner

    return extent(_target(scene, places))


def _matrix_of(transform: Element) -> tuple[Float, Float, float]:
    """Return matrix, shift and roundings of a transform, of a rotation what no rotation is larger than."""
    values = numbers((transform.text or "").encode(), np.float64, f"a {transform.tag}")
    match transform.tag:
        case "translate":
            return np.eye(3), values, 1
        case "scale":
            return np.diag(values), np.zeros(3), 1
        case "rotate":  # the angle is rounded as it becomes radians, and its cosine, sine and axis
            return np.full((3, 3), 1.0), np.zeros(3), 20 + abs(float(values[3])) / 30
        case _:
            return values.reshape(4, 4)[:3, :3], values.reshape(4, 4)[:3, 3], 1


def _target(instance: Element, table: dict[str, T]) -> T:
    """Return what an instance refers to."""
    url = instance.get("url", "")
    if not url.startswith("#") or url[1:] not in table:
        raise ReadError(f"its {instance.tag} refers to {shown(url)}, which it does not hold: export it as one file")
    return table[url[1:]]


def _unit(root: Element) -> Unit:
    """Return the unit: exactly as many metres as the file says, and one where it says nothing."""
    own = root.find("asset")
    for asset in root.iter("asset"):
        if asset is not own and (asset.find("unit") is not None or asset.find("up_axis") is not None):
            raise ReadError("a part of it has a unit or an axis of its own: export it in one")
    unit = root.find("asset/unit")
    if unit is None:
        return METRE
    text = unit.get("meter", "")
    try:
        return multiple_of(text, METRE)
    except UsageError:
        raise ReadError(
            f"its unit is {shown(text)} metres, which is no length: export it again", code="unknown_unit"
        ) from None


def _check_transforms(node: Element) -> None:
    for element in node:
        count = _TRANSFORMS.get(element.tag)
        if element.tag in ("lookat", "skew"):
            raise ReadError(f"a node has a {element.tag}, which is not read: export it with matrices", code="not_read")
        if count is None:
            continue
        values = finite_numbers(element, f"the numbers of a {element.tag}")
        if len(values) != count:
            raise ReadError(f"a {element.tag} has {len(values)} numbers, not {count}: export it again")
        if element.tag == "matrix" and not np.array_equal(values[12:], [0, 0, 0, 1]):
            raise ReadError("a node has a matrix whose last row is not 0, 0, 0, 1: export it again")
        if element.tag == "rotate":  # pycollada takes the axis for a unit vector
            length = float(np.linalg.norm(values[:3]))
            if not 0 < length < np.inf:
                raise ReadError("a node turns about an axis without a direction: export it again")
            element.text = " ".join(repr(value) for value in [*(values[:3] / length).tolist(), float(values[3])])


def _sizes_of_faces(geometry: Element) -> Int:
    """Return the corners of each face of a geometry, whose numbers are checked on the way."""
    mesh = geometry.find("mesh")
    assert mesh is not None
    what = f"geometry {shown(geometry.get('id', ''))}"
    sources = by_id(mesh.findall("source"))
    points: dict[str, Float] = {}
    for vertices in mesh.findall("vertices"):
        positions = [each for each in vertices.findall("input") if each.get("semantic") == "POSITION"]
        source = sources.get(positions[0].get("source", "")[1:]) if len(positions) == 1 else None
        if source is None:
            raise ReadError(f"{what} has vertices without one source of positions: export it again")
        points[vertices.get("id", "")] = _points(source, what)
    sizes = [_faces(element, points, what) for element in mesh if element.tag in _POLYGONS]
    return np.concatenate([np.empty(0, np.int64), *sizes])


def _points(source: Element, what: str) -> Float:
    """Return the points (k, 3) in a source, three numbers each and nothing between them."""
    array, accessor = source.find("float_array"), source.find("technique_common/accessor")
    if array is None or accessor is None:
        raise ReadError(f"{what} keeps its positions in another form than numbers: export it again")
    values = finite_numbers(array, f"the positions of {what}")
    count = len(values)
    names = [param.get("name") for param in accessor.findall("param")]
    if names not in (["X", "Y", "Z"], [None] * 3) or accessor.get("source") != f"#{array.get('id')}":
        raise ReadError(f"{what} has positions that are no x, y and z: export it again")
    stride, offset = accessor.get("stride"), accessor.get("offset", "0")
    if (stride, offset) != ("3", "0"):
        raise ReadError(
            f"{what} has positions {stride} numbers apart from number {offset}, which are not read: export it with "
            "x, y, z alone",
            code="not_read",
        )
    stated = array.get("count"), accessor.get("count")
    if stated != (str(count), str(count // 3)) or count % 3:
        raise ReadError(
            f"{what} has {plural(count, 'number')} of positions, but says {stated[0]} for {stated[1]} points: it was "
            "cut short, export it again",
            code="cut_short",
        )
    return values.reshape(-1, 3)


def _faces(element: Element, points: dict[str, Float], what: str) -> Int:
    """Return the corners of each face that an element of a mesh makes; those not convex are split in the element."""
    if element.find("ph") is not None:
        raise ReadError(f"{what} has polygons with holes: export it as triangles", code="not_read")
    inputs = element.findall("input")
    if any(not each.get("offset", "").isdecimal() or len(each.get("offset", "")) > 4 for each in inputs):
        raise ReadError(f"{what} has an input without an offset: export it again")
    vertex = [each for each in inputs if each.get("semantic") == "VERTEX" and each.get("source", "")[1:] in points]
    if len(vertex) != 1:
        raise ReadError(f"{what} has {element.tag} without vertices of their own: export it again")
    stride = 1 + max(int(each.get("offset", "")) for each in inputs)
    lists = [numbers((each.text or "").encode(), np.int64, f"the corners of {what}") for each in element.findall("p")]
    if any(len(each) % stride for each in lists):
        raise ReadError(
            f"{what} has a corner with fewer than {plural(stride, 'index')}: it was cut short", code="cut_short"
        )
    offset, positions = int(vertex[0].get("offset", "")), points[vertex[0].get("source", "")[1:]]
    for each in lists:
        check_indices(each.reshape(-1, stride)[:, offset, None], len(positions), f"{what}, corner")
    sizes = _sizes(element, [len(each) // stride for each in lists], what)
    if element.get("count", str(len(sizes))) != str(len(sizes)):
        raise ReadError(
            f"{what} says {element.get('count')} {element.tag}, but holds {len(sizes)}: "
            "it was cut short or its count is wrong, export it again",
            code="cut_short",
        )
    if len(sizes) and sizes.min() < 3:
        raise ReadError(f"{what} has a face with {sizes.min()} corners, but a face has at least 3: export it again")
    if element.tag in ("tristrips", "trifans"):
        return np.full((sizes - 2).sum(), 3)
    if len(sizes) and sizes.max() > 3:
        rows = np.concatenate(lists).reshape(-1, stride)
        faces, owner = fan(sizes, np.arange(len(rows)))
        faces, notched = around_notches(positions[rows[:, offset]], faces, owner)
        if notched:  # trimesh splits into fans
            for old in (*element.findall("vcount"), *element.findall("p")):
                element.remove(old)
            element.tag = "triangles"
            element.set("count", str(len(faces)))
            SubElement(element, "p").text = " ".join(map(str, rows[faces].ravel().tolist()))
    return sizes


def _sizes(element: Element, lengths: list[int], what: str) -> Int:
    """Return the corners of each polygon, strip or fan, from those of each list in the element."""
    if element.tag not in ("triangles", "polylist"):
        return np.array(lengths, np.int64)
    if len(lengths) != 1:  # trimesh reads the first alone
        raise ReadError(f"{what} has {element.tag} with {plural(len(lengths), 'list')} of corners: export it again")
    if element.tag == "triangles":
        sizes: Int = np.full(-(-lengths[0] // 3), 3)
    else:
        text = "" if (counts := element.find("vcount")) is None else counts.text or ""
        sizes = numbers(text.encode(), np.int64, f"the counts of corners of {what}")
    if sizes.sum() != lengths[0]:
        raise ReadError(
            f"{what} says {sizes.sum()} corners, but holds {lengths[0]}: it was cut short, export it again",
            code="cut_short",
        )
    return sizes


@contextlib.contextmanager
def _float64_in_pycollada() -> Iterator[None]:
    """Let the modules of pycollada that read coordinates and matrices find float64 where they ask for float32."""

    class Wide:
        def __getattr__(self, name: str) -> Any:
            return np.float64 if name == "float32" else getattr(np, name)

    modules = [importlib.import_module(f"collada.{name}") for name in ("source", "scene")]
    with _LOCK:
        try:
            for module in modules:
                module.numpy = Wide()  # type: ignore[attr-defined]
            yield
        finally:
            for module in modules:
                module.numpy = np  # type: ignore[attr-defined]
