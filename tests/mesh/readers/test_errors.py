"""Files that cannot be read: one sentence with the path, what is wrong and the remedy, and nothing else."""

import importlib
import io
import json
import os
import re
import socket
import struct
import subprocess
import sys
import zipfile
import zlib
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from tests.mesh.readers.samples import (
    CORNERS,
    GMSH_22,
    GMSH_41,
    QUADS,
    TRIANGLES,
    VTK_TEXT,
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
    text_ply,
    text_stl,
)
from tests.mesh.readers.step_sample import step_solid

from inertia.errors import ReadError, UsageError
from inertia.mesh.read import read
from inertia.mesh.readers.formats import EXTENSIONS
from inertia.mesh.surface import Surface, first_non_finite

NAN = CORNERS.copy()
NAN[5, 1] = np.nan
OUT = TRIANGLES.copy()
OUT[3, 1] = 99


def refused(path: Path, reason: str, **options: str) -> str:
    """Check that reading `path` fails for `reason`, in one sentence that names it; return the message."""
    with pytest.raises(ReadError, match=reason) as caught:
        read(path, **options)
    message = str(caught.value)
    assert message.startswith(f"cannot read {path}: ")
    assert "\n" not in message
    assert caught.value.exit_code == 3
    return message


def build(resources: str, item: str = '<item objectid="1"/>') -> bytes:
    return archive_3mf(model_3mf(resources, item))


def changed_glb(**changes: object) -> bytes:
    tree, binary = gltf_tree()
    tree.update(changes)
    return glb(tree, binary)


def compressed_glb() -> bytes:
    tree, binary = gltf_tree()
    del tree["accessors"][0]["bufferView"]
    return glb(tree, binary)


def accessor(index: int, **changes: object) -> bytes:
    tree, binary = gltf_tree()
    tree["accessors"][index].update(changes)
    return glb(tree, binary)


WHOLE = f'<object id="1">{mesh_3mf()}</object>'
BAD = {
    # STL
    "wrong count": (
        "a.stl",
        binary_stl(count=13),
        r"says 13 triangles \(734 bytes\), but it holds 684 bytes",
    ),
    "cut short": ("a.stl", binary_stl()[:300], "12 triangles .* room for 4.32: it was cut short"),
    "no triangles": ("a.stl", binary_stl(faces=[]), "no triangles"),
    "less than a header": ("a.stl", b"\1\0" * 20, "40 bytes, but a binary STL begins with 84"),
    "text that is no STL": ("a.stl", "hello\n" * 100, "is text, but no STL"),
    "solid without facets": ("a.stl", "solid a\nendsolid a\n", "no triangles"),
    "text cut short": ("a.stl", text_stl()[:700], "no endsolid: it was cut short"),
    "second solid cut short": ("a.stl", text_stl() + text_stl()[:400], "no endsolid"),
    "four corners": (
        "a.stl",
        text_stl().replace("endloop", "vertex 5 5 5\nendloop", 1),
        "facet 0 has 'vertex'",
    ),
    "two corners": (
        "a.stl",
        text_stl().replace("  vertex 1.1 2.0 3.0\n", "", 1),
        "facet [0-9]+ has 'endloop'",
    ),
    "unfinished facet": (
        "a.stl",
        text_stl().replace("endfacet\nendsolid", "endsolid"),
        "the end of its solid",
    ),
    "STL garbage number": (
        "a.stl",
        text_stl().replace("1.1 2.0 3.0", "1.1 2,0 3.0", 1),
        "'2,0', which is not a number",
    ),
    "text after the solid": ("a.stl", text_stl() + "facet\n", "text outside its solids, after line 86"),
    "endsolid first": ("a.stl", "solid a\nsolid b\nendsolid b\n", "line 2 pairs solid with solid"),
    "STL in one line": (
        "a.stl",
        " ".join(text_stl().split()),
        "'.* facet .*' has endsolid within a line, and it needs",
    ),
    "STL endsolid behind a facet": (
        "a.stl",
        text_stl().replace("\nendsolid", " endsolid"),
        "has endsolid within a line",
    ),
    "STL padded with zeros": (
        "a.stl",
        text_stl().encode()[:900] + bytes(99),
        "a zero byte at byte 900: it is a damaged",
    ),
    "STL NaN": ("a.stl", text_stl(corners=NAN), r"vertex \d+ \(a corner of face \d+\) is \[1.1, nan, 3.0\]"),
    # OBJ
    "OBJ out of range": ("a.obj", obj(OUT), r"face 3 names vertex 100, but the vertices are 1 to 8"),
    "OBJ zero": (
        "a.obj",
        obj().replace("f 1 2 4", "f 0 2 4"),
        "face 0 names vertex 0, but OBJ counts from 1",
    ),
    "OBJ too far back": ("a.obj", obj() + "f -1 -2 -9\n", "face 12 names vertex -9, but 8 stand before it"),
    "OBJ infinity": (
        "a.obj",
        obj().replace("v 0.1 0.0 3.0", "v 0.1 inf 3.0"),
        r"vertex 1 \(a corner of face 0\).*inf",
    ),
    "OBJ two corners": ("a.obj", obj() + "f 1 2\n", "face 12 has 2 corners"),
    "OBJ old patch": ("a.obj", obj() + "bzp 1 2 3 4\n", "begins a free-form surface"),
    "OBJ call": ("a.obj", obj() + "call b.obj\n", "'call', which has another file or command put in: export"),
    "OBJ csh": ("a.obj", obj() + "csh -ls\n", "'csh', which has another file or command put in: export"),
    "OBJ points": ("a.obj", obj([]), "no faces, only points"),
    "OBJ short vertex": (
        "a.obj",
        obj().replace("v 0.1 0.0 3.0", "v 0.1 0.0"),
        "vertex 1 has fewer than three",
    ),
    "OBJ garbage": ("a.obj", obj().replace("f 1 2 4", "f 1 x 4"), "'x', which is not a whole number"),
    "OBJ half index": ("a.obj", obj().replace("f 1 2 4", "f 1 2.5 4"), "'2.5', which is not a whole number"),
    "OBJ missing index": ("a.obj", obj().replace("f 1 2 4", "f /1 2 4"), "no vertex before its slash"),
    "OBJ lone sign": ("a.obj", obj().replace("f 1 2 4", "f 1 - 4"), "'-', which is not a whole number"),
    "OBJ free form": ("a.obj", "v 0 0 0\nsurf 0 1 0 1 1\n", "line 2 begins a free-form surface"),
    "OBJ unknown word": ("a.obj", obj() + "wall 1 2 3\n", "line 21 begins with 'wall'"),
    # OFF
    "OFF cut short": ("a.off", off()[:-20], "8 vertices and 12 faces, but 1[89] lines follow"),
    "OFF too long": ("a.off", off() + "3 0 1 2\n", "8 vertices and 12 faces, but 21 lines follow"),
    "OFF short face": ("a.off", off().replace("3 0 1 3", "4 0 1 3"), "face 0 says '4' corners and names 3"),
    "OFF short vertex": ("a.off", off().replace("0.1 0.0 3.0", "0.1 0.0"), "vertex 1 has fewer than three"),
    "OFF no counts": ("a.off", "OFF\n", "no line with the counts"),
    "OFF binary": ("a.off", b"OFF BINARY\n\0\0\0\0", "'OFF BINARY' files are not read"),
    "OFF four dimensions": ("a.off", "4OFF\n1 0 0\n0 0 0 1\n", "'4OFF' files are not read"),
    "OFF in one line": ("a.off", " ".join(off().split()), "behind its counts stand 72 other numbers in the same line"),
    "OFF without its name": ("a.off", off().removeprefix("OFF\n"), "with the word OFF: write that before it, or give"),
    "OFF points": ("a.off", off([]), "no faces"),
    "OFF out of range": ("a.off", off(OUT), "face 3 names vertex 99"),
    "OFF NaN": ("a.off", off(corners=NAN), "vertex 5 .* is .1.1, nan, 3.0."),
    # PLY
    "PLY text cut short": ("a.ply", text_ply()[:-20], "ends within face|says that it has"),
    "PLY text too long": ("a.ply", text_ply() + "3 0 1 2\n", "4 numbers follow the rows"),
    "PLY binary cut short": ("a.ply", binary_ply()[:-5], "ends within face 11"),
    "PLY binary too long": ("a.ply", binary_ply() + b"abc", "3 bytes follow the rows"),
    "PLY huge count": (
        "a.ply",
        binary_ply().replace(b"face 12", b"face 999999999999"),
        "ends within face 12",
    ),
    "PLY huge list": (
        "a.ply",
        binary_ply().replace(b"list uchar", b"list uint"),
        "says that it has [0-9.e+]+ items",
    ),
    "PLY points": ("a.ply", text_ply([]), "no faces"),
    "PLY strips": (
        "a.ply",
        text_ply([[0, 1, 2]]).replace("element face", "element tristrips"),
        "its element 'tristrips' lists vertices too, which is not read",
    ),
    "PLY without z": ("a.ply", text_ply().replace("float z", "float w"), "no x, y and z"),
    "PLY without corners": (
        "a.ply",
        text_ply().replace("vertex_indices", "edges"),
        "no list named vertex_indices",
    ),
    "PLY header cut short": ("a.ply", ply_header("ascii", 8, 12)[:60], "no end_header"),
    "PLY unknown type": ("a.ply", text_ply().replace("float x", "real x"), "'property real x'"),
    "PLY without format": (
        "a.ply",
        text_ply().replace("format ascii 1.0\n", ""),
        "does not begin with ply and a format",
    ),
    "PLY out of range": ("a.ply", binary_ply(OUT), "face 3 names vertex 99"),
    "PLY NaN": ("a.ply", binary_ply(corners=NAN), "vertex 5"),
    "PLY half index": ("a.ply", text_ply().replace("3 0 1 3\n", "3 0 1.5 3\n"), "1.5, which is no index"),
    "PLY two corners": ("a.ply", text_ply([*TRIANGLES.tolist(), [0, 1]]), "face 12 has 2 corners"),
    # glTF
    "GLB cut short": ("a.glb", glb(*gltf_tree())[:-8], r"says \d+ bytes, but it holds \d+: it was cut short"),
    "GLB chunk too long": ("a.glb", glb(*gltf_tree()).replace(b"JSON", b"JUNK"), "no JSON chunk"),
    "glTF garbage": (
        "a.gltf",
        '{"asset": {"version": "2.0"}',
        r"is not JSON, as glTF is \(line 1, column 29: expecting",
    ),
    "glTF deep": ("a.gltf", '{"asset":' + "[" * 100_000, "its objects are nested too deeply"),
    "glTF 1": ("a.glb", changed_glb(asset={"version": "1.0"}), "it is glTF '1.0'"),
    "glTF of a later version": (
        "a.glb",
        changed_glb(asset={"version": "2.1", "minVersion": "2.1"}),
        "it needs glTF '2.1', but only version 2.0 is read",
    ),
    "glTF unaligned": ("a.glb", accessor(0, byteOffset=2, count=7), "begins at byte 2 of its buffer with a stride"),
    "glTF draco": (
        "a.glb",
        changed_glb(extensionsRequired=["KHR_materials_unlit", "KHR_draco_mesh_compression"]),
        "requires the extension 'KHR_draco_mesh_compression', which is not read: export it without",
    ),
    "glTF instancing": (
        "a.glb",
        changed_glb(nodes=[{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {}}}]),
        "EXT_mesh_gpu_instancing",
    ),
    "glTF sparse": ("a.glb", accessor(0, sparse={"count": 1}), r"JSON has no accessors\[0\].sparse.indices, where an"),
    "glTF compressed": (
        "a.glb",
        compressed_glb(),
        "accessor 0 is compressed, which is not read: export it uncompressed",
    ),
    "glTF quantised": ("a.glb", accessor(0, componentType=5122), "not three float32 numbers each"),
    "glTF count": ("a.glb", accessor(0, count=9_999_999), "accessor 0 does not fit in its buffer"),
    "glTF negative count": ("a.glb", accessor(0, count=-1), r"has -1 as accessors\[0\].count, where a whole number"),
    "glTF float index": ("a.glb", accessor(1, componentType=5126, count=18), "indices are not whole numbers"),
    "glTF not threes": ("a.glb", accessor(1, count=35), "35 corners, not a multiple of three"),
    "glTF wrong index": (
        "a.glb",
        changed_glb(nodes=[{"mesh": -1}]),
        r"has -1 as nodes\[0\].mesh, where a whole number",
    ),
    "glTF no such mesh": (
        "a.glb",
        changed_glb(nodes=[{"mesh": 7}]),
        r"mesh refers to meshes\[7\], but the file holds 1",
    ),
    "glTF loop": ("a.glb", changed_glb(nodes=[{"mesh": 0, "children": [0]}]), "node 0 hangs in two places"),
    "glTF perspective": (
        "a.glb",
        changed_glb(nodes=[{"mesh": 0, "matrix": [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]),
        "last row is not 0, 0, 0, 1",
    ),
    "glTF overflow": (
        "a.glb",
        changed_glb(nodes=[{"mesh": 0, "scale": [1e308, 1e308, 1e308]}]),
        r"vertex \d.*inf",
    ),
    "glTF empty scene": ("a.glb", changed_glb(scenes=[{"nodes": []}]), "no triangle mesh"),
    "glTF missing buffer": (
        "a.gltf",
        json.dumps({**gltf_tree()[0], "buffers": [{"uri": "no.bin", "byteLength": 1}]}),
        "needs the file 'no.bin'",
    ),
    "glTF remote buffer": (
        "a.gltf",
        json.dumps({**gltf_tree()[0], "buffers": [{"uri": "https://a.b/c", "byteLength": 1}]}),
        "needs the file 'https://a.b/c'",
    ),
    "glTF base64": (
        "a.gltf",
        json.dumps({**gltf_tree()[0], "buffers": [{"uri": "data:;base64,*", "byteLength": 1}]}),
        "not valid base64",
    ),
    "glTF NaN": ("a.glb", glb(*gltf_tree(NAN)), "vertex 5"),
    "glTF out of range": ("a.glb", glb(*gltf_tree(faces=OUT)), "face 3 names vertex 99"),
    # 3MF
    "3MF cut short": ("a.3mf", plain_3mf()[:-30], "damaged zip archive"),
    "3MF flipped bit": (
        "a.3mf",
        plain_3mf()[:200] + b"\0\0\0" + plain_3mf()[203:],
        "damaged zip archive|XML is damaged",
    ),
    "zip without a model": (
        "a.3mf",
        archive_3mf("").replace(b"3dmodel.model", b"3dmodel.trash"),
        "without a 3D model",
    ),
    "3MF no XML": ("a.3mf", archive_3mf("<model><resources>"), "XML is damaged"),
    "3MF unit": (
        "a.3mf",
        archive_3mf(model_3mf(WHOLE, '<item objectid="1"/>', "parsec")),
        "unit is 'parsec', but 3MF knows",
    ),
    "3MF undefined object": (
        "a.3mf",
        build(WHOLE, '<item objectid="1"/><item objectid="9"/>'),
        "places object '9'",
    ),
    "3MF empty object": ("a.3mf", build('<object id="1" name="a"/>'), "object 'a' has neither triangles nor"),
    "3MF nothing built": ("a.3mf", build(WHOLE, ""), "no triangle mesh"),
    "3MF loop": (
        "a.3mf",
        build('<object id="1"><components><component objectid="1"/></components></object>'),
        "component of itself",
    ),
    "3MF lattice": ("a.3mf", build(WHOLE.replace("</mesh>", "<beamlattice/></mesh>")), "beam lattice"),
    "3MF missing attribute": (
        "a.3mf",
        build(WHOLE.replace('z="3.0"', "", 1)),
        "lacks the attribute 'z' at line 2",
    ),
    "PLY strips beside faces": (
        "a.ply",
        text_ply().replace("end_header", "element tristrips 1\nproperty list int int vertex_indices\nend_header")
        + "4 0 1 2 3\n",
        "its element 'tristrips' lists vertices too, which is not read",
    ),
    **{
        f"MSH two sections of {name}": (
            "a.msh",
            text + text[text.index(f"${name}") :].partition(f"$End{name}")[0] + f"$End{name}\n",
            rf"the section \${name} twice",
        )
        for name, text in (("Nodes", GMSH_22), ("Elements", GMSH_41), ("Entities", GMSH_41))
    },
    "3MF garbage number": (
        "a.3mf",
        build(WHOLE.replace('z="3.0"', 'z="3,0"', 1)),
        "an object has '3,0' where a number must stand",
    ),
    **{
        f"3MF {text!r}": ("a.3mf", build(WHOLE.replace('z="3.0"', f'z="{text}"', 1)), "where a number must stand")
        for text in ("1_0", "\u0663", "")
    },
    "3MF index with a low line": (
        "a.3mf",
        build(WHOLE.replace('v1="', 'v1="0_', 1)),
        "where an index must stand",
    ),
    "3MF transform with a low line": (
        "a.3mf",
        build(WHOLE, '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 1_0 0 0"/>'),
        "is not twelve numbers",
    ),
    "3MF required extension": (
        "a.3mf",
        archive_3mf(
            model_3mf(WHOLE, '<item objectid="1"/>').replace("<model", '<model xmlns:q="q:a" requiredextensions="p q"')
        ),
        "requires the extension 'q:a'",
    ),
    "3MF required extension without a namespace": (
        "a.3mf",
        archive_3mf(model_3mf(WHOLE, '<item objectid="1"/>').replace("<model", '<model requiredextensions="s"')),
        "requires the extension 's'",
    ),
    "3MF half index": ("a.3mf", build(WHOLE.replace('v1="', 'v1="0.5', 1)), r"has '0.5\d+' where an index must stand"),
    "3MF huge index": (
        "a.3mf",
        build(WHOLE.replace('v1="', 'v1="99999999999999999999', 1)),
        "where an index must stand",
    ),
    "3MF transform": (
        "a.3mf",
        build(WHOLE, '<item objectid="1" transform="1 0 0"/>'),
        "'1 0 0' is not twelve numbers",
    ),
    "3MF missing part": (
        "a.3mf",
        build('<object id="1"><components><component objectid="1" p:path="/3D/b.model"/></components></object>'),
        "refers to the part '3d/b.model'",
    ),
    "3MF document type": (
        "a.3mf",
        archive_3mf('<!DOCTYPE m [<!ENTITY a "aaaa">]><model>&a;</model>'),
        "declares a document type",
    ),
    "3MF NaN": ("a.3mf", build(f'<object id="1">{mesh_3mf(NAN)}</object>'), "vertex 5"),
    "3MF out of range": (
        "a.3mf",
        build(f'<object id="1">{mesh_3mf(faces=OUT)}</object>'),
        "triangle 3 names vertex 99",
    ),
    # meshes of cells
    "MSH cut short": ("a.msh", GMSH_22[:-20], r"\$Elements has no \$EndElements"),
    "MSH elements missing": (
        "a.msh",
        GMSH_22.replace("2 4 2 7 1 1 2 3 4\n", ""),
        "ends after 2 of 3 elements",
    ),
    "MSH nodes missing": ("a.msh", GMSH_22.replace("4 0.1 0.1 1.1\n", ""), "section .Nodes ends too early"),
    "MSH 4 nodes missing": ("a.msh", GMSH_41.replace("0.1 1.1 0.1\n", ""), "section .Nodes ends too early"),
    "MSH 4 wrong count": ("a.msh", GMSH_41.replace("1 5 1 15", "1 6 1 15"), "says 6 nodes but holds 5"),
    "MSH wrong count": (
        "a.msh",
        GMSH_22.replace("$Nodes\n5", "$Nodes\n4"),
        "says 4 nodes but holds 4, with 4 numbers left",
    ),
    "MSH undefined node": (
        "a.msh",
        GMSH_22.replace("2 3 4 15\n", "2 3 4 16\n"),
        "name node 16, which it does not define",
    ),
    "MSH node twice": ("a.msh", GMSH_22.replace("15 1.1", "4 1.1"), "defines node 4 twice"),
    "MSH version": ("a.msh", GMSH_22.replace("2.2 0 8", "1.0 0 8"), "it is MSH '1.0', but 2.2 and 4.1"),
    "MSH parameters": (
        "a.msh",
        GMSH_22.replace("$Nodes", "$ParametricNodes").replace("$EndNodes", "$EndParametricNodes"),
        r"its nodes have parameters \(.ParametricNodes\), which are read in MSH 4.1 alone: save it without",
    ),
    "MSH NaN": ("a.msh", GMSH_22.replace("15 1.1", "15 nan"), r"point 4 is \[nan"),
    "MSH sparse tags": ("a.msh", GMSH_22.replace("15 1.1", "9999999999 1.1"), "name node 15"),
    "MSH no elements": (
        "a.msh",
        re.sub(r"\$Elements\n3.*\$End", "$Elements\n0\n$End", GMSH_22, flags=re.DOTALL),
        "no cells",
    ),
    "OFF a blank within a number": ("a.off", off().replace("1.1 2.0 3.0", "1.1 2 .0 3.0"), "vertex 7 has 4 numbers"),
    "PLY two lines in one": (
        "a.ply",
        text_ply().replace("hand\n", "hand\x1d"),
        "'property float x', which PLY does not",
    ),
    "VTK cut short": ("a.vtk", VTK_TEXT[:180], "meshio cannot read it as vtk"),
    "VTK count": (
        "a.vtk",
        VTK_TEXT.replace("POINTS 5", "POINTS 999999999"),
        "has 999999999 items, but it has 268 bytes",
    ),
    "VTK out of range": ("a.vtk", VTK_TEXT.replace("4 1 2 3 4", "4 1 2 3 9"), "tetra cell 1 names vertex 9"),
    "VTK NaN": ("a.vtk", VTK_TEXT.replace("1.1 1.1 1.1", "1.1 1.1 nan"), "point 4"),
    "PLY of one line": ("a.ply", "end_header\n", "its header does not begin with ply"),
    **{
        f"3MF in {name}": (
            "a.3mf",
            archive_3mf(model_3mf("", "").replace("utf-8", name).replace("UTF-8", name)),
            "its XML cannot be decoded .*: export it as UTF-8",
        )
        for name in ("gb2312", "shift_jis", "utf9", "idna", "rot13", "zlib")
    },
    # anything
    "text garbage": (
        "a.txt",
        "The quick brown fox\njumps over the lazy dog.\n",
        "neither its contents nor its name",
    ),
    "binary garbage": ("a.dat", np.random.default_rng(0).bytes(5000), "neither its contents nor its name"),
    "empty": ("a.stl", b"", "it is empty"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_is_refused_in_one_sentence(case: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    name, data, reason = BAD[case]
    path = tmp_path / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    refused(path, reason)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("kind", [kind for kind in EXTENSIONS if kind not in ("step", "med", "xdmf")])
@pytest.mark.parametrize("garbage", [b"\x93\x01\x7f garbage \xff" * 50, b"some words\nand numbers 1 2 3\n" * 20])
def test_garbage_is_refused_by_every_reader(kind: str, garbage: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"garbage{EXTENSIONS[kind][0]}"
    path.write_bytes(garbage)
    refused(path, "cannot read")
    refused(path, "cannot read", format=kind)


def test_an_unknown_kind_lists_what_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_bytes(b"1 2 3\n")
    message = refused(tmp_path / "a.xyz", "these are read")
    assert all(kind in message for kind in EXTENSIONS)


# The file system


def test_paths_that_lead_nowhere(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_bytes(binary_stl())
    (tmp_path / "loop.stl").symlink_to("loop.stl")
    refused(tmp_path / "no.stl", "no such file")
    refused(tmp_path / "a.stl" / "b.stl", "not a directory")
    refused(tmp_path, "it is a directory")
    refused(tmp_path / "loop.stl", "symbolic link that leads back to itself")
    refused(tmp_path / ("x" * 5000), "too long")


def test_pipes_sockets_and_devices_are_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.stl")
    refused(tmp_path / "pipe.stl", "not a regular file")
    refused(Path("/dev/zero"), "not a regular file")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "s"))
        refused(tmp_path / "s", "not a regular file")


def test_a_file_without_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.stl"
    path.write_bytes(binary_stl())
    path.chmod(0)
    if os.access(path, os.R_OK):  # the superuser may read anything

        def denied(*_: object, **__: object) -> None:
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(Path, "open", denied)
    refused(path, "permission is denied")


@pytest.mark.parametrize("name", ["ein Würfel.stl", "a\tb.stl", "100%{}.stl", "-rf.stl", "'\".stl", "部品.STL"])
def test_odd_names_are_read(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(binary_stl())
    assert read(tmp_path / name).triangles.count == 12


@pytest.mark.parametrize("name", ["no\nsuch.stl", "a\0b.stl", "a\ud800b.stl", ""])
def test_odd_names_stay_on_one_line(name: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError) as caught:
        read(f"{tmp_path}/{name}")
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("name", "begin", "megabytes"),
    [
        ("a.obj", "v 1 2 3\n#", 200),
        ("a.stl", "solid a\nfacet ", 20),
        ("a.off", "OFF\n", 20),
        ("a.inp", "*NODE\n1,", 20),
    ],
)
def test_an_endless_line_is_refused(name: str, begin: str, megabytes: int, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(begin.encode() + b"7" * (megabytes * 2**20))
    refused(tmp_path / name, "longer than 16 MiB")
    (tmp_path / name).unlink()


def test_unknown_units_and_formats_are_wrong_usage(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_bytes(binary_stl())
    with pytest.raises(UsageError, match="unknown unit 'furlong'"):
        read(tmp_path / "a.stl", unit="furlong")
    with pytest.raises(UsageError, match="unknown unit 1000: use one of m"):
        read(tmp_path / "a.stl", unit=cast(str, 1000))
    with pytest.raises(UsageError, match="unknown format 'dwg': use one of stl"):
        read(tmp_path / "a.stl", format="dwg")


# Archives that swell


def test_a_3mf_that_declares_a_bomb_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.3mf").write_bytes(archive_3mf(b" " * (80 * 2**20)))
    refused(tmp_path / "a.3mf", r"unpack to 83886080 or more, beyond the 67108864 allowed: .* zip bomb")


def test_a_3mf_that_hides_a_bomb_is_refused(tmp_path: Path) -> None:
    """The directory says 100 bytes; what comes out is counted as well."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = packer.compress(b" " * (80 * 2**20)) + packer.flush()
    name = b"3D/3dmodel.model"
    sizes = struct.pack("<III", 0, len(packed), 100)
    local = b"PK\x03\x04" + struct.pack("<5H", 20, 0, 8, 0, 0) + sizes + struct.pack("<2H", len(name), 0) + name
    central = (
        b"PK\x01\x02"
        + struct.pack("<6H", 20, 20, 0, 8, 0, 0)
        + sizes
        + struct.pack("<5H2I", len(name), 0, 0, 0, 0, 0, 0)
    )
    end = struct.pack("<4H2IH", 0, 0, 1, 1, len(central) + len(name), len(local) + len(packed), 0)
    (tmp_path / "a.3mf").write_bytes(local + packed + central + name + b"PK\x05\x06" + end)
    refused(tmp_path / "a.3mf", "zip bomb|damaged zip archive")


def test_components_that_multiply_are_refused_unexpanded(tmp_path: Path) -> None:
    def doubled(i: int) -> str:
        component = f'<component objectid="{i - 1}"/>'
        return f'<object id="{i}"><components>{component}{component}</components></object>'

    levels = "".join(doubled(i) for i in range(2, 60))
    (tmp_path / "a.3mf").write_bytes(build(WHOLE + levels, '<item objectid="59"/>'))
    refused(tmp_path / "a.3mf", "more than 100000000 triangles")
    deep = "".join(
        f'<object id="{i}"><components><component objectid="{i - 1}"/></components></object>' for i in range(2, 200)
    )
    (tmp_path / "a.3mf").write_bytes(build(WHOLE + deep, '<item objectid="199"/>'))
    refused(tmp_path / "a.3mf", "nested too deep")


# STEP


def test_step_without_opencascade_names_the_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.step").write_text("ISO-10303-21;\n")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    refused(tmp_path / "a.step", r"pip install 'inertia\[step\]'")


def test_a_damaged_step_file_is_refused_in_silence(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("OCP")
    text = step_solid(CORNERS, QUADS.tolist(), "Block")
    for damaged in (text[:60], text[: len(text) // 2]):
        (tmp_path / "a.step").write_text(damaged)
        refused(tmp_path / "a.step", "OpenCASCADE|no triangle mesh")
    assert capfd.readouterr() == ("", "")


# Whatever the reader does not look at


def test_the_first_coordinate_that_is_not_finite_is_found(tmp_path: Path) -> None:
    corners = np.tile(CORNERS, (20_000, 1))
    faces = np.concatenate([TRIANGLES + 8 * i for i in range(20_000)])
    records = np.zeros(len(faces), [("normal", "<f4", 3), ("corners", "<f4", 9), ("attribute", "<u2")])
    records["corners"] = corners[faces].reshape(-1, 9)
    path = tmp_path / "big.stl"

    def write() -> None:
        path.write_bytes(b"\0" * 80 + struct.pack("<I", len(faces)) + records.tobytes())

    write()
    assert first_non_finite(read(path).triangles) is None
    records["corners"][200_003, 5] = np.inf
    records["corners"][210_000, 0] = np.nan
    write()
    assert first_non_finite(read(path).triangles) == (200_003, 1)
    assert first_non_finite(Surface(NAN, TRIANGLES)) == (3, 2)


def test_importing_the_reader_imports_no_other_reader() -> None:
    others = ("trimesh", "meshio", "scipy", "h5py", "OCP", "numba", "json", "zipfile")
    code = "import sys, inertia.mesh.read; print([m for m in sys.argv[1:] if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code, *others], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_zip_with_directories_is_read(tmp_path: Path) -> None:
    file = io.BytesIO(plain_3mf())
    with zipfile.ZipFile(file, "a") as archive:
        archive.mkdir("3D/textures") if hasattr(archive, "mkdir") else archive.writestr("3D/textures/", "")
    (tmp_path / "a.3mf").write_bytes(file.getvalue())
    assert read(tmp_path / "a.3mf").triangles.count == 12
