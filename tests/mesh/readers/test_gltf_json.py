"""glTF whose JSON is of a wrong shape: one sentence that names the place and what must stand there."""

import copy
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.mesh.readers.samples import glb, gltf, gltf_tree

from inertia.errors import ReadError
from inertia.mesh.read import read, read_tree

NODES = [
    {"children": [1, 2], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0, 0, 1]},
    {"mesh": 0, "name": "a", "translation": [1, 2, 3], "rotation": [0, 0, 1, 0], "scale": [1, 1, 2]},
    {"mesh": 0, "weights": [], "extensions": {}},
]
STRANGE = [5, -1, 1.5, 10**400, float("nan"), "x", "", None, True, [], {}, [5], ["x"], [None], [[]], [{}], {"x": 5}]
PYTHON = re.compile(
    r"Error\b|NoneType|object is not|unhashable|subscriptable|argument|'int'|'str'|dtype|sequence|Traceback"
)


def whole_tree() -> tuple[dict[str, Any], bytes]:
    tree, binary = gltf_tree(nodes=copy.deepcopy(NODES))
    tree["scenes"], tree["scene"] = [{"nodes": [0]}], 0
    tree["extensionsRequired"] = ["KHR_materials_unlit"]
    primitive = tree["meshes"][0]["primitives"][0]
    primitive["mode"], primitive["targets"], tree["meshes"][0]["weights"] = 4, [], []
    for accessor in tree["accessors"]:
        accessor["byteOffset"] = 0
    for view in tree["bufferViews"]:
        view["byteStride"] = 0
    return tree, binary


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield where something stands in a tree: every property and entry."""
    for key, entry in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*path, key)
        if isinstance(entry, dict | list):
            yield from places(entry, (*path, key))


@pytest.mark.parametrize("place", list(places(whole_tree()[0])), ids=lambda place: ".".join(map(str, place)))
def test_whatever_stands_in_a_place_is_read_or_refused_in_a_sentence(place: tuple[Any, ...], tmp_path: Path) -> None:
    said = []
    for strange in [*STRANGE, ...]:
        tree, binary = whole_tree()
        holder: Any = tree
        for key in place[:-1]:
            holder = holder[key]
        if strange is ...:
            del holder[place[-1]]
        else:
            holder[place[-1]] = strange
        (tmp_path / "a.glb").write_bytes(glb(tree, binary))
        for verb in (read, read_tree):
            try:
                verb(tmp_path / "a.glb")
            except ReadError as error:
                said.append(str(error))
    assert not [sentence for sentence in said if PYTHON.search(sentence) or "\n" in sentence]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"meshes": 5}, "its JSON has 5 as meshes, where a list must stand"),
        ({"meshes": {}}, "its JSON has an object as meshes, where a list must stand"),
        ({"meshes": [[]]}, r"its JSON has a list of 0 as meshes\[0\], where an object must stand"),
        ({"meshes": [{}]}, r"its JSON has no meshes\[0\].primitives, where a list must stand"),
        ({"meshes": [{"primitives": [{"attributes": {}}]}]},
         r"its JSON has no meshes\[0\].primitives\[0\].attributes.POSITION, where a whole number that is not negative"),
        ({"nodes": [{"mesh": None}]}, r"its JSON has null as nodes\[0\].mesh, where a whole number"),
        ({"nodes": [{"mesh": True}]}, r"its JSON has true as nodes\[0\].mesh, where a whole number"),
        ({"nodes": [{"children": [0.5]}]}, r"its JSON has 0.5 as nodes\[0\].children\[0\], where a whole number"),
        ({"nodes": [{"mesh": 0, "scale": [1, "2", 3]}]},
         r"its JSON has '2' as nodes\[0\].scale\[1\], where a finite number must stand"),
        ({"nodes": [{"mesh": 0, "translation": [1, float("inf"), 3]}]},
         r"its JSON has Infinity as nodes\[0\].translation\[1\], where a finite number must stand"),
        ({"nodes": [{"mesh": 0, "matrix": 1}]}, r"its JSON has 1 as nodes\[0\].matrix, where 16 numbers must stand"),
        ({"nodes": [{"mesh": 0, "rotation": [0, 0, 0, 0]}]}, r"nodes\[0\].rotation is a quaternion of zero"),
        ({"accessors": "all"}, "its JSON has 'all' as accessors, where a list must stand"),
        ({"asset": None}, "its JSON has null as asset, where an object must stand"),
        ({"asset": {}}, "its JSON has no asset.version, where text must stand"),
        ({"buffers": [{}]}, r"its JSON has no buffers\[0\].byteLength, where a whole number"),
        ({"scene": 1}, r"scene refers to scenes\[1\], but the file holds"),
        ({"extensionsRequired": 1}, "its JSON has 1 as extensionsRequired, where a list must stand"),
    ],
)  # fmt: skip
def test_the_place_and_what_must_stand_there_are_named(changes: dict[str, Any], says: str, tmp_path: Path) -> None:
    tree, binary = gltf_tree()
    (tmp_path / "a.glb").write_bytes(glb({"scenes": [{"nodes": [0]}], **tree, **changes}, binary))
    with pytest.raises(ReadError, match=says + ".*: .*export it again"):
        read(tmp_path / "a.glb")


@pytest.mark.parametrize(
    ("kind", "text", "says"),
    [
        (
            "accessor type",
            {"type": "VEC5"},
            r"has 'VEC5' as accessors\[0\].type, where one of SCALAR, VEC2, VEC3, VEC4 ",
        ),
        (
            "accessor kind",
            {"componentType": 5124},
            r"has 5124 as accessors\[0\].componentType, where one of 5120, 5121",
        ),
    ],
)
def test_a_word_that_the_format_does_not_know_is_named(
    kind: str, text: dict[str, Any], says: str, tmp_path: Path
) -> None:
    tree, binary = gltf_tree()
    tree["accessors"][0].update(text)
    (tmp_path / "a.glb").write_bytes(glb(tree, binary))
    with pytest.raises(ReadError, match=says):
        read(tmp_path / "a.glb")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (b"[]", "its JSON has a list of 0 as a whole, where an object must stand"),
        (b'{"asset": {"version": "2.0"}, "meshes": [' + b"9" * 5000 + b"]}", "more digits than any length"),
        (b'{"asset": "\xff"}', "its JSON is not UTF-8 at byte 11"),
        (b'{"asset": }', r"it is not JSON, as glTF is \(line 1, column 11: expecting value\)"),
    ],
)
def test_what_is_no_object_of_json_is_refused(text: bytes, says: str, tmp_path: Path) -> None:
    (tmp_path / "a.gltf").write_bytes(text)
    with pytest.raises(ReadError, match=says):
        read(tmp_path / "a.gltf", format="gltf")


@pytest.mark.parametrize(
    ("uri", "says"),
    [("data:;base64,\u00e4", r"buffers\[0\].uri is not valid base64"), ("http://[", "which is not fetched")],
)
def test_a_strange_uri_is_refused(uri: str, says: str, tmp_path: Path) -> None:
    tree, binary = gltf_tree()
    tree["buffers"] = [{"uri": uri, "byteLength": len(binary)}]
    (tmp_path / "a.gltf").write_text(json.dumps(tree))
    with pytest.raises(ReadError, match=says):
        read(tmp_path / "a.gltf")


def test_the_tree_that_is_spoiled_is_sound(tmp_path: Path) -> None:
    tree, binary = whole_tree()
    for name, data in (("a.glb", glb(tree, binary)), ("a.gltf", gltf(tree, binary))):
        (tmp_path / name).write_bytes(data)
        assert read(tmp_path / name).triangles.count == 24
