"""Surfaces: every format gives the box's corners, bit for bit, in the file's order."""

import io
import json
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.mesh.readers.samples import (
    CORNERS,
    QUADS,
    TRIANGLES,
    archive_3mf,
    binary_ply,
    binary_stl,
    glb,
    gltf_tree,
    mesh_3mf,
    model_3mf,
    obj,
    off,
    plain_3mf,
    ply_header,
    surfaces,
    text_ply,
    text_stl,
    words,
)
from tests.mesh.readers.step_sample import step_solid

from inertia.errors import ReadError
from inertia.mesh.part import Part
from inertia.mesh.read import read, read_tree
from inertia.mesh.surface import Facets

BOX = CORNERS[TRIANGLES]
FANS = CORNERS[QUADS[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)]
SINGLE = CORNERS.astype(np.float32).astype(np.float64)[TRIANGLES]
MIXED = np.concatenate([BOX[:10], FANS[10:]])
EXPECTED = {
    "stl binary": (SINGLE, "stl", "mm", "assumed"),
    "stl text": (BOX, "stl", "mm", "assumed"),
    "obj": (BOX, "obj", "mm", "assumed"),
    "obj quads": (FANS, "obj", "mm", "assumed"),
    "off": (BOX, "off", "mm", "assumed"),
    "off quads": (FANS, "off", "mm", "assumed"),
    "ply text": (BOX, "ply", "mm", "assumed"),
    "ply little": (BOX, "ply", "mm", "assumed"),
    "ply big, mixed": (MIXED, "ply", "mm", "assumed"),
    "glb": (SINGLE, "glb", "m", "file"),
    "gltf": (SINGLE, "gltf", "m", "file"),
    "3mf": (BOX, "3mf", "in", "file"),
    "3mf stored": ((CORNERS + 9)[TRIANGLES], "3mf", "in", "file"),
    "dae": (BOX, "dae", "in", "file"),
    "dae quads": (FANS, "dae", "m", "file"),
    "zae": (BOX, "zae", "m", "file"),
    "3dxml": (BOX, "3dxml", "mm", "assumed"),
    "xaml": (BOX, "xaml", "mm", "assumed"),
}


def read_bytes(folder: Path, name: str, data: bytes | str, **options: str) -> Part:
    path = folder / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return read(path, **options)


def names_of(part: Part) -> list[str]:
    assert part.regions is not None
    return [part.regions.names[i] for i in part.regions.index]


@pytest.mark.parametrize("sample", surfaces())
def test_the_corners_are_those_of_the_file(sample: str, tmp_path: Path) -> None:
    corners, kind, unit, unit_from = EXPECTED[sample]
    part = read_bytes(tmp_path, *surfaces()[sample])
    assert np.array_equal(part.triangles.corners(), corners)
    assert (part.source.format, part.unit.name, part.unit_from) == (kind, unit, unit_from)
    assert part.source.path == str(tmp_path / surfaces()[sample][0])


@pytest.mark.parametrize(
    ("sample", "count"),
    [("obj quads", "6 faces"), ("off quads", "6 faces"), ("ply big, mixed", "1 face"), ("dae quads", "6 faces")],
)
def test_a_note_says_how_many_polygons_were_split(sample: str, count: str, tmp_path: Path) -> None:
    (note,) = read_bytes(tmp_path, *surfaces()[sample]).notes
    assert note.startswith(f"{count} with more than three corners")


@pytest.mark.parametrize("sample", surfaces())
def test_contents_decide_where_the_name_says_otherwise(sample: str, tmp_path: Path) -> None:
    corners, kind, _, _ = EXPECTED[sample]
    for name in ("box.inp", "box", "box.txt"):
        part = read_bytes(tmp_path, name, surfaces()[sample][1])
        assert part.source.format == kind
        assert np.array_equal(part.triangles.corners(), corners)
        assert ("the name says abaqus" in " ".join(part.notes)) == (name == "box.inp")


# STL


def test_binary_stl_stays_in_the_file(tmp_path: Path) -> None:
    facets = read_bytes(tmp_path, "box.stl", binary_stl()).geometry
    assert isinstance(facets, Facets)
    assert not facets.records.flags.owndata
    assert not facets.records.flags.writeable


def test_binary_stl_that_begins_with_solid_is_binary(tmp_path: Path) -> None:
    part = read_bytes(tmp_path, "box.stl", binary_stl(header=b"solid facet normal endsolid"))
    assert np.array_equal(part.triangles.corners(), SINGLE)
    assert isinstance(part.geometry, Facets)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: "\n\n \t" + text,
        lambda text: text.upper(),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace("solid box", "solid"),
        lambda text: text.rstrip("\n"),
        lambda text: text.replace("solid box", "solid endsolid vertex 1 2"),
    ],
)
def test_text_stl_in_all_its_dresses(change, tmp_path: Path) -> None:
    assert np.array_equal(read_bytes(tmp_path, "box.stl", change(text_stl())).triangles.corners(), BOX)


def test_text_stl_with_two_solids_has_two_regions(tmp_path: Path) -> None:
    part = read_bytes(tmp_path, "two.stl", text_stl("Left") + "\n" + text_stl("Right hand"))
    assert names_of(part) == ["Left"] * 12 + ["Right hand"] * 12
    assert np.array_equal(part.triangles.corners(), np.concatenate([BOX, BOX]))


def test_a_long_text_stl_is_read_in_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inertia.mesh.readers.stl.TEXT_BLOCK", 200)
    assert np.array_equal(read_bytes(tmp_path, "box.stl", text_stl()).triangles.corners(), BOX)


# OBJ


def test_negative_obj_indices_count_from_their_own_line(tmp_path: Path) -> None:
    body = "".join(f"f {words(face - 8)}\n" for face in TRIANGLES)
    points = "".join(f"v {words(p)}\n" for p in CORNERS)
    shifted = "".join(f"v {words(p)}\n" for p in CORNERS + 4)
    part = read_bytes(tmp_path, "two.obj", points + body + shifted + body)
    assert np.array_equal(part.triangles.corners(), np.concatenate([BOX, (CORNERS + 4)[TRIANGLES]]))


def test_obj_takes_the_position_and_leaves_texture_normal_and_colour(tmp_path: Path) -> None:
    text = "mtllib a.mtl\nvt 0 0\nvn 0 0 1\n" + obj().replace("v 1.1 0.0 0.0", "v 1.1 0.0 0.0 1 0.5 0.2")
    for corner in ("/1/1", "//1", "/1"):
        faces = "\n".join(
            line if line[:1] != "f" else " ".join(w if w == "f" else w + corner for w in line.split())
            for line in text.splitlines()
        )
        assert np.array_equal(read_bytes(tmp_path, "box.obj", faces).triangles.corners(), BOX)


def test_obj_lines_may_be_continued_indented_or_split_by_tabs(tmp_path: Path) -> None:
    text = obj().replace("f 1 2 4", "f 1 \\\n 2 4").replace("v 0.1 0.0 3.0", "  v\t0.1\t0.0  3.0  ") + "# end"
    assert np.array_equal(read_bytes(tmp_path, "box.obj", text).triangles.corners(), BOX)


def test_a_pentagon_becomes_a_fan(tmp_path: Path) -> None:
    points = np.array([[0, 0, 0], [2, 0, 0], [3, 2, 0], [1, 3, 0], [-1, 2, 0]], float)
    part = read_bytes(tmp_path, "five.obj", obj([np.arange(5)], points))
    assert np.array_equal(part.triangles.corners(), points[[[0, 1, 2], [0, 2, 3], [0, 3, 4]]])


@pytest.mark.parametrize("comment", [" # c", "\t#", " # 1 2 3", "  #c # d", " # 1/2/3"])
def test_comments_behind_the_numbers_of_obj_are_left_aside(comment: str, tmp_path: Path) -> None:
    lines = [line + comment if line.startswith(("v", "f")) else line for line in obj().splitlines()]
    part = read_bytes(tmp_path, "box.obj", "\n".join(lines) + "\n")
    assert np.array_equal(part.triangles.corners(), BOX)
    plain = read_bytes(tmp_path, "plain.obj", obj()).rounding
    assert part.rounding is not None
    assert plain is not None
    assert part.rounding.distance == plain.distance
    assert part.rounding.remainder is not None
    assert plain.remainder is not None
    assert np.array_equal(part.rounding.remainder(), plain.remainder())
    with pytest.raises(ReadError, match="vertex 0 has fewer than three coordinates"):
        read_bytes(tmp_path, "short.obj", f"v 0 0{comment}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")


def test_a_number_sign_in_the_name_of_an_object_belongs_to_it(tmp_path: Path) -> None:
    rest = "".join(f"f {words(face + 1)} # 1\n" for face in TRIANGLES[5:])
    part = read_bytes(tmp_path, "box.obj", "o Body #1\n" + obj(TRIANGLES[:5]) + "o Body #2\n" + rest)
    assert names_of(part) == ["Body #1"] * 5 + ["Body #2"] * 7


def test_obj_regions_are_objects_or_else_groups(tmp_path: Path) -> None:
    half = obj(TRIANGLES[:5]), "".join(f"f {words(face + 1)}\n" for face in TRIANGLES[5:])
    grouped = read_bytes(tmp_path, "box.obj", "g side wall\n" + half[0] + "g\n" + half[1])
    assert names_of(grouped) == ["side wall"] * 5 + ["default"] * 7
    named = read_bytes(tmp_path, "box.obj", "o body\ng skin\n" + half[0] + "g other\n" + half[1])
    assert names_of(named) == ["body"] * 12
    quads = obj(QUADS[:2]) + "o lid\n" + "".join(f"f {words(face + 1)}\n" for face in QUADS[2:])
    assert names_of(read_bytes(tmp_path, "box.obj", quads)) == ["default"] * 4 + ["lid"] * 8


def test_obj_lines_beside_faces_are_noted(tmp_path: Path) -> None:
    part = read_bytes(tmp_path, "box.obj", obj() + "l 1 2\np 3\n")
    assert part.notes == ("2 line or point elements beside the faces were left out",)


# OFF and PLY


@pytest.mark.parametrize(
    "text",
    [
        off().replace("OFF\n", "OFF "),
        "# made by hand\n" + off().replace("OFF\n", "OFF\n# counts\n\n"),
        off().replace("OFF", "COFF").replace("2.0 3.0\n", "2.0 3.0 1 0 0 1\n"),
        off().replace("3 0 1 3\n", "3 0 1 3 255 0 0\n"),
        off().replace("8 12 0", "8 12"),
        off().replace("\n", "\r\n"),
    ],
)
def test_off_in_all_its_dresses(text: str, tmp_path: Path) -> None:
    assert np.array_equal(read_bytes(tmp_path, "box.off", text).triangles.corners(), BOX)


def test_ply_with_more_properties_and_elements(tmp_path: Path) -> None:
    head = (
        "ply\nformat binary_little_endian 1.0\nelement strand 2\nproperty list uchar short ids\n"
        "element vertex 8\nproperty uchar red\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 12\nproperty list uint uint vertex_index\nproperty double quality\nend_header\n"
    ).replace("\n", "\r\n")
    body = struct.pack("<BhBhhh", 1, 7, 3, 1, 2, 3)
    body += b"".join(struct.pack("<B3f", 9, *p) for p in CORNERS)
    body += b"".join(struct.pack("<4Id", 3, *face, 0.5) for face in TRIANGLES)
    assert np.array_equal(read_bytes(tmp_path, "box.ply", head.encode() + body).triangles.corners(), SINGLE)


def test_text_ply_may_mix_polygons_and_columns(tmp_path: Path) -> None:
    text = text_ply([*TRIANGLES[:10].tolist(), QUADS[5].tolist()]).replace(
        "end_header", "property uchar flag\nend_header"
    )
    lines = text.splitlines()
    faces = [line + " 1" if i >= len(lines) - 11 else line for i, line in enumerate(lines)]
    assert np.array_equal(read_bytes(tmp_path, "box.ply", "\n".join(faces)).triangles.corners(), MIXED)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_comment_of_ply_may_name_the_end_of_the_header(end: str, tmp_path: Path) -> None:
    text = text_ply().replace("comment made by hand", "comment end_header soon").replace("\n", end)
    assert np.array_equal(read_bytes(tmp_path, "box.ply", text).triangles.corners(), BOX)


def test_float32_is_widened_exactly(tmp_path: Path) -> None:
    corners = np.random.default_rng(1).normal(size=(8, 3)).astype(np.float32)
    body = corners.astype(">f4").tobytes() + b"".join(struct.pack(">B3i", 3, *face) for face in TRIANGLES)
    data = ply_header("binary_big_endian", 8, 12).encode() + body
    assert np.array_equal(read_bytes(tmp_path, "box.ply", data).triangles.corners(), corners.astype(float)[TRIANGLES])


# glTF


def test_gltf_nodes_place_their_meshes(tmp_path: Path) -> None:
    quarter = [0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)]
    nodes = [
        {"children": [1, 2], "translation": [10, 0, 0]},
        {"mesh": 0, "name": "first"},
        {"mesh": 0, "scale": [2, 2, 2], "rotation": quarter, "translation": [0, 5, 0]},
    ]
    part = read_bytes(tmp_path, "two.glb", glb(*gltf_tree(nodes=nodes)))
    assert names_of(part) == ["first"] * 12 + ["mesh 0"] * 12
    single = CORNERS.astype(np.float32).astype(float)
    turned = np.stack([10 - 2 * single[:, 1], 5 + 2 * single[:, 0], 2 * single[:, 2]], axis=1)
    assert np.array_equal(part.triangles.corners(0, 12), (single + np.array([10, 0, 0]))[TRIANGLES])
    assert np.allclose(part.triangles.corners(12), turned[TRIANGLES], rtol=1e-15, atol=1e-15)


def test_a_mirrored_mesh_still_faces_outwards(tmp_path: Path) -> None:
    matrix = np.diag([-1.0, 1, 1, 1]).ravel().tolist()
    mirrored = read_bytes(tmp_path, "box.glb", glb(*gltf_tree(nodes=[{"mesh": 0, "matrix": matrix}])))
    item = '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
    other = read_bytes(tmp_path, "box.3mf", archive_3mf(model_3mf(f'<object id="1">{mesh_3mf()}</object>', item)))
    for part in (mirrored, other):
        a, b, c = np.moveaxis(part.triangles.corners(), 1, 0)
        assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(6.0)
        assert part.triangles.corners()[..., 0].max() < 0


@pytest.mark.parametrize(
    ("mode", "corners", "faces"),
    [
        (5, [0, 1, 2, 3, 4], [[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
        (6, [0, 1, 2, 3, 4], [[1, 2, 0], [2, 3, 0], [3, 4, 0]]),
    ],
)
def test_gltf_strips_and_fans(mode: int, corners: list[int], faces: list[list[int]], tmp_path: Path) -> None:
    tree, binary = gltf_tree(faces=corners)
    tree["accessors"][1]["count"] = len(corners)
    tree["meshes"][0]["primitives"][0]["mode"] = mode
    part = read_bytes(tmp_path, "strip.glb", glb(tree, binary))
    assert np.array_equal(part.triangles.corners(), CORNERS.astype(np.float32).astype(float)[faces])


def test_gltf_with_a_buffer_beside_it_and_interleaved_corners(tmp_path: Path) -> None:
    tree, _ = gltf_tree()
    row = np.zeros(8, [("position", "<f4", 3), ("normal", "<f4", 3)])
    row["position"] = CORNERS
    indices = TRIANGLES.astype("<u2").tobytes()
    (tmp_path / "the buffer.bin").write_bytes(row.tobytes() + indices)
    tree["buffers"] = [{"uri": "the%20buffer.bin", "byteLength": 192 + len(indices)}]
    tree["bufferViews"] = [
        {"buffer": 0, "byteLength": 192, "byteStride": 24},
        {"buffer": 0, "byteOffset": 192, "byteLength": len(indices)},
    ]
    part = read_bytes(tmp_path, "box.gltf", json.dumps(tree))
    assert np.array_equal(part.triangles.corners(), SINGLE)


def sparse_gltf(*places: int, positions: bool = True, kind: int = 5123) -> bytes:
    """The box, of whose corners a sparse accessor gives some; without `positions` the others are at 0."""
    base = np.where(np.isin(np.arange(8), places)[:, None], 9, CORNERS) if positions else CORNERS
    tree, binary = gltf_tree(base)
    own = np.array(places, {5121: "<u1", 5123: "<u2", 5125: "<u4"}[kind]).tobytes()
    start = len(binary) + 8
    tree["bufferViews"] += [
        {"buffer": 0, "byteOffset": len(binary), "byteLength": 8 + len(own)},
        {"buffer": 0, "byteOffset": start + 40, "byteLength": 12 * len(places)},
    ]
    tree["accessors"][0]["sparse"] = {
        "count": len(places),
        "indices": {"bufferView": 2, "byteOffset": 8, "componentType": kind},
        "values": {"bufferView": 3},
    }
    if not positions:
        del tree["accessors"][0]["bufferView"]
    values = CORNERS[[k % 8 for k in places]].astype("<f4").tobytes()
    binary += bytes(8) + own.ljust(40, b"\0") + values
    tree["buffers"][0]["byteLength"] = len(binary)
    return glb(tree, binary)


@pytest.mark.parametrize("kind", [5121, 5123, 5125])
def test_gltf_s_sparse_accessors_are_read(kind: int, tmp_path: Path) -> None:
    expected = CORNERS.astype("<f4").astype(float)
    for places, positions in (((0, 3, 7), True), (tuple(range(8)), True), (tuple(range(8)), False)):
        part = read_bytes(tmp_path, "box.glb", sparse_gltf(*places, positions=positions, kind=kind))
        assert np.array_equal(part.triangles.corners(), expected[TRIANGLES])
    part = read_bytes(tmp_path, "box.glb", sparse_gltf(4, 7, positions=False, kind=kind))
    kept = np.isin(np.arange(8), (4, 7))[:, None]
    assert np.array_equal(part.triangles.corners(), np.where(kept, expected, 0)[TRIANGLES])


@pytest.mark.parametrize("places", [(3, 0), (2, 2), (5, 8)])
def test_gltf_s_sparse_indices_rise(places: tuple[int, ...], tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"accessors\[0\].sparse.indices do not rise, or go beyond the 8 rows"):
        read_bytes(tmp_path, "box.glb", sparse_gltf(*places))


def test_gltf_points_beside_triangles_are_noted(tmp_path: Path) -> None:
    tree, binary = gltf_tree()
    tree["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 0})
    assert read_bytes(tmp_path, "box.glb", glb(tree, binary)).notes == ("1 set of lines or points was left out",)


def test_gltf_whose_accessor_rounds_what_it_states_is_read(tmp_path: Path) -> None:
    tree, binary = gltf_tree()
    tree["accessors"][0] |= {"min": [0.1, 0, 0], "max": [1.1001, 2, 3]}
    part = read_bytes(tmp_path, "box.glb", glb(tree, binary))
    assert np.array_equal(part.triangles.corners(), SINGLE)
    assert part.notes == ()


@pytest.mark.parametrize("stated", [{"min": [5, 5, 5]}, {"max": [1.1, 2, 3.1]}, {"min": [], "max": None}])
def test_gltf_whose_accessor_states_another_reach_is_read_with_a_note(stated: dict[str, Any], tmp_path: Path) -> None:
    tree, binary = gltf_tree()
    tree["accessors"][0] |= stated
    part = read_bytes(tmp_path, "box.glb", glb(tree, binary))
    assert np.array_equal(part.triangles.corners(), SINGLE)
    [note] = part.notes
    assert note.startswith("1 accessor of positions has others than the min and max stated")


def test_the_first_of_several_scenes_of_gltf_is_noted_where_none_is_named(tmp_path: Path) -> None:
    tree, binary = gltf_tree(nodes=[{"mesh": 0}, {"mesh": 0, "translation": [9, 0, 0]}])
    tree["scenes"] = [{"nodes": [0]}, {"nodes": [1]}]
    assert read_bytes(tmp_path, "box.glb", glb(tree, binary)).notes == ()
    del tree["scene"]
    part = read_bytes(tmp_path, "box.glb", glb(tree, binary))
    assert part.notes == ("of 2 scenes, none of which is named as the one to show, the first was read",)
    assert np.array_equal(part.triangles.corners(), SINGLE)


def test_nodes_of_gltf_that_are_not_visible_are_noted(tmp_path: Path) -> None:
    tree, binary = gltf_tree()
    for node, seen in zip(tree["nodes"], (False, True), strict=False):
        node["extensions"] = {"KHR_node_visibility": {"visible": seen}}
    tree["extensionsRequired"] = ["KHR_node_visibility"]
    part = read_bytes(tmp_path, "box.glb", glb(tree, binary))
    assert part.notes == ("1 node marked as not visible (KHR_node_visibility) was counted",)
    assert part.triangles.count == 12


def test_primitives_that_share_positions_take_what_they_use(tmp_path: Path) -> None:
    many = np.zeros((100, 3))
    many[:8] = CORNERS
    part = read_bytes(tmp_path, "one.glb", glb(*gltf_tree(many, TRIANGLES[:1])))
    assert np.array_equal(part.triangles.corners(), SINGLE[:1])
    assert len(part.triangles.vertices) == 3


# 3MF


@pytest.mark.parametrize(
    ("unit", "name"),
    [
        ("micron", "um"),
        ("millimeter", "mm"),
        ("centimeter", "cm"),
        ("inch", "in"),
        ("foot", "ft"),
        ("meter", "m"),
        (None, "mm"),
    ],
)
def test_the_unit_of_a_3mf_file_is_applied(unit: str | None, name: str, tmp_path: Path) -> None:
    part = read_bytes(tmp_path, "box.3mf", plain_3mf(unit))
    assert (part.unit.name, part.unit_from) == (name, "file")
    assert np.array_equal(part.triangles.corners(), BOX)


def components(of: int, step: str) -> str:
    moves = (f'<component objectid="{of}" transform="1 0 0 0 1 0 0 0 1 {step.format(10 * i)}"/>' for i in range(10))
    return f"<components>{''.join(moves)}</components>"


def test_every_instance_of_a_nested_assembly_is_there(tmp_path: Path) -> None:
    resources = (
        f'<object id="1" name="pin">{mesh_3mf()}</object>'
        f'<object id="2">{components(1, "{} 0 0")}</object>'
        f'<object id="3" name="bed">{components(2, "0 {} 0")}</object>'
    )
    part = read_bytes(tmp_path, "bed.3mf", archive_3mf(model_3mf(resources, '<item objectid="3"/>')))
    assert part.triangles.count == 1200
    lowest = part.triangles.corners().reshape(100, 36, 3).min(axis=1)
    expected = [[0.1 + x, y, 0] for y in range(0, 100, 10) for x in range(0, 100, 10)]
    assert np.allclose(lowest, expected, rtol=0, atol=1e-13)
    assert set(names_of(part)) == {"pin"}


def test_only_what_is_built_counts_and_supports_do_not(tmp_path: Path) -> None:
    resources = "".join(
        f'<object id="{i}" type="{kind}">{mesh_3mf()}</object>' for i, kind in enumerate(("model", "support", "model"))
    )
    part = read_bytes(
        tmp_path, "box.3mf", archive_3mf(model_3mf(resources, '<item objectid="0"/><item objectid="1"/>'))
    )
    assert names_of(part) == ["object 0"] * 12
    assert part.notes == ("1 support was left out",)


@pytest.mark.parametrize(
    ("kind", "note"),
    [
        ("support", "1 support was left out"),
        ("solidsupport", "1 support was left out"),
        ("other", "1 object of the type other, which is not built, was left out"),
        ("surface", None),
    ],
)
@pytest.mark.parametrize("assembly", ["model", "support", "other"])
def test_components_say_themselves_what_they_are(assembly: str, kind: str, note: str | None, tmp_path: Path) -> None:
    inner = '<components><component objectid="0"/><component objectid="1"/></components>'
    resources = (
        f'<object id="0">{mesh_3mf()}</object><object id="1" type="{kind}">{mesh_3mf()}</object>'
        f'<object id="2" type="{assembly}">{inner}</object><object id="3" type="{assembly}">'
        '<components><component objectid="2"/></components></object>'
        '<object id="4"><components><component objectid="1"/></components></object>'
    )
    (tmp_path / "a.3mf").write_bytes(archive_3mf(model_3mf(resources, '<item objectid="3"/>')))
    part, tree = read(tmp_path / "a.3mf"), read_tree(tmp_path / "a.3mf")
    assert part.triangles.count == (12 if note else 24)
    assert len(tree.nodes) == (3 if note else 4)
    assert part.notes == tree.notes == ((note,) if note else ())
    alone = archive_3mf(model_3mf(resources, '<item objectid="0"/><item objectid="4"/>'))
    assert read_bytes(tmp_path, "b.3mf", alone).triangles.count == (12 if note else 24)


@pytest.mark.parametrize("prefix", ["p", "m", "p m"])
def test_extensions_of_3mf_that_leave_the_shape_alone_may_be_required(prefix: str, tmp_path: Path) -> None:
    space = 'xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"'
    model = model_3mf(f'<object id="1">{mesh_3mf()}</object>', '<item objectid="1"/>')
    model = model.replace("<model", f'<model {space} requiredextensions="{prefix}"')
    assert read_bytes(tmp_path, "a.3mf", archive_3mf(model)).triangles.count == 12


def test_a_model_in_another_unit_than_the_build_is_noted(tmp_path: Path) -> None:
    component = '<component objectid="5" p:path="/3D/Sub.model"/>'
    root = model_3mf(f'<object id="1"><components>{component}</components></object>', '<item objectid="1"/>', "inch")
    sub = model_3mf(f'<object id="5">{mesh_3mf()}</object>', "", None)
    part = read_bytes(tmp_path, "a.3mf", archive_3mf(root, sub=sub))
    assert part.notes == ("a model in it states the unit mm, but was read in that of the build, in",)


@pytest.mark.parametrize("value", ["0", "false"])
def test_what_a_slicer_has_marked_as_not_to_be_printed_counts_with_a_note(value: str, tmp_path: Path) -> None:
    resources = "".join(
        f'<object id="{i}" type="{kind}">{mesh_3mf()}</object>' for i, kind in enumerate(("model", "support"))
    )
    marked = f'<item objectid="0" transform="1 0 0 0 1 0 0 0 1 9 9 9" printable="{value}"/>'
    items = f'<item objectid="0" printable="1"/>{marked}<item objectid="1" printable="{value}"/>'
    (tmp_path / "two.3mf").write_bytes(archive_3mf(model_3mf(resources, items)))
    says = 'build item that a slicer has marked as not to be printed (printable="0") was counted'
    part = read(tmp_path / "two.3mf")
    assert part.notes == ("1 support was left out", f"1 {says}")
    assert part.triangles.count == 24
    tree = read_tree(tmp_path / "two.3mf")
    assert (len(tree.nodes), tree.notes) == (2, part.notes)
    (tmp_path / "one.3mf").write_bytes(archive_3mf(model_3mf(resources, '<item objectid="0" printable="1"/>')))
    assert read(tmp_path / "one.3mf").notes == ()


def test_components_may_lie_in_another_model(tmp_path: Path) -> None:
    component = '<component objectid="5" p:path="/3D/Sub.model"/>'
    resources = f'<object id="1" name="wheel"><components>{component}</components></object>'
    sub = model_3mf(f'<object id="5">{mesh_3mf()}</object>', "")
    part = read_bytes(tmp_path, "box.3mf", archive_3mf(model_3mf(resources, '<item objectid="1"/>'), sub=sub))
    assert np.array_equal(part.triangles.corners(), BOX)
    assert names_of(part) == ["wheel"] * 12


def test_the_relations_name_the_root_model(tmp_path: Path) -> None:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("3D/other.model", model_3mf("", ""))
        archive.writestr("Parts/Root.model", model_3mf(f'<object id="1">{mesh_3mf()}</object>', '<item objectid="1"/>'))
        archive.writestr(
            "_rels/.rels",
            '<Relationships><Relationship Target="/Parts/Root.model" Id="a" '
            'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
        )
    assert np.array_equal(read_bytes(tmp_path, "box.3mf", file.getvalue()).triangles.corners(), BOX)


def test_trimesh_writes_a_3mf_that_reads_back(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    trimesh.Trimesh(CORNERS, TRIANGLES, process=False).export(tmp_path / "box.3mf")
    assert np.array_equal(read(tmp_path / "box.3mf").triangles.corners(), BOX)


@pytest.mark.parametrize("colour", [" 255 0 0", " 0.5 0.25 0.1 1.0"])
def test_off_vertices_may_be_coloured_or_not(colour: str, tmp_path: Path) -> None:
    lines = off().splitlines()
    first = lines.index(next(line for line in lines if line.startswith("0.1 ")))
    lines[first + 1] += colour
    lines[first + 3] += colour
    lines[-1] += colour
    part = read_bytes(tmp_path, "box.off", "\n".join(lines) + "\n")
    assert np.array_equal(part.triangles.corners(), BOX)


# STEP


@pytest.mark.parametrize(("inches", "unit"), [(False, "mm"), (True, "in")])
def test_step_solids_come_in_the_unit_of_the_file(inches: bool, unit: str, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    part = read_bytes(tmp_path, "box.stp", step_solid(CORNERS, QUADS.tolist(), "Block", inches))
    assert (part.unit.name, part.unit_from, part.source.format) == (unit, "file", "step")
    assert names_of(part) == ["Block"] * 12
    assert {tuple(corner) for corner in part.triangles.corners().reshape(-1, 3).tolist()} == set(map(tuple, CORNERS))
    assert part.notes == ()


# Units


def test_a_unit_that_is_given_counts_before_the_files_own(tmp_path: Path) -> None:
    part = read_bytes(tmp_path, "box.3mf", plain_3mf("inch"), unit="cm")
    assert (part.unit.name, part.unit_from) == ("cm", "option")
    assert part.notes == ("the file says that its unit is in, but it was read in cm as asked",)
    same = read_bytes(tmp_path, "box.3mf", plain_3mf("inch"), unit="inch")
    assert (same.unit_from, same.notes) == ("option", ())
    plain = read_bytes(tmp_path, "box.stl", binary_stl(), unit="m")
    assert (plain.unit.name, plain.unit_from, plain.notes) == ("m", "option", ())


def test_the_end_is_reported_as_progress(tmp_path: Path) -> None:
    (tmp_path / "box.ply").write_bytes(binary_ply())
    fractions: list[float] = []
    read(tmp_path / "box.ply", progress=fractions.append)
    assert fractions == [1.0]
