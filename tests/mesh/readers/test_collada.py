"""Collada: faces, nodes, units and digits, against the second reader."""

import re
import sys
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import CORNERS, QUADS, TRIANGLES, archive, dae, geometry_dae, words
from tests.mesh.readers.second_readers import shape_of

import inertia
from inertia.errors import ReadError
from inertia.mesh.part import Part
from inertia.mesh.read import read, read_tree
from inertia_meshes import catalogue
from inertia_meshes import path as sample_path

BOX = CORNERS[TRIANGLES]


def read_dae(folder: Path, data: str | bytes, name: str = "box.dae") -> Part:
    path = folder / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return read(path)


SCENES = {
    "matrix": "<node><matrix>0 -1 0 7 1 0 0 8 0 0 1 9 0 0 0 1</matrix>{box}</node>",
    "translate, rotate, scale": "<node><translate>1 2 3</translate><rotate>1 2 2 40</rotate><scale>2 3 4</scale>"
    "{box}</node>",
    "mirrored": "<node><scale>-1 1 1</scale>{box}</node>",
    "mirrored twice": "<node><scale>-1 1 1</scale><node><scale>1 1 -2</scale>{box}</node></node>",
    "instances": "<node><translate>9 0 0</translate>{box}<node><scale>0.5 1 1</scale>{box}{box}</node></node>{node}",
    "instances of a node": '{node}<node><scale>3 3 3</scale><instance_node url="#twins"/></node>',
    "an axis of any length": "<node><rotate>0 0 10 90</rotate>{box}</node>",
}
BOX_INSTANCE = '<instance_geometry url="#box"/>'
TWINS = (
    f'<library_nodes><node id="twins"><node><translate>5 0 0</translate>{BOX_INSTANCE}</node>'
    f"<node><scale>1 -1 1</scale>{BOX_INSTANCE}</node></node></library_nodes>"
)


@pytest.mark.parametrize("scene", SCENES)
def test_nodes_place_their_meshes(scene: str, tmp_path: Path) -> None:
    text = dae(
        nodes=SCENES[scene].format(box=BOX_INSTANCE, node='<node><instance_node url="#twins"/></node>'), library=TWINS
    )
    corners = read_dae(tmp_path, text).triangles.corners()
    expected = np.array(shape_of("dae", text.encode()))
    assert corners.shape == expected.shape
    assert np.abs(corners - expected).max() <= 8 * np.finfo(float).eps * np.abs(expected).max()


STRIPS = [[0, 1, 2, 3, 6, 7, 4, 5], [0, 4, 1, 5], [1, 5, 3, 7], [0, 2, 4, 6]]


def triangles_of(tag: str, face: list[int]) -> list[list[int]]:
    match tag:
        case "tristrips":
            return [
                [*face[i : i + 3]] if i % 2 == 0 else [face[i + 1], face[i], face[i + 2]] for i in range(len(face) - 2)
            ]
        case _:
            return [[face[0], *pair] for pair in pairwise(face[1:])]


@pytest.mark.parametrize(
    ("tag", "faces"),
    [
        ("triangles", TRIANGLES.tolist()),
        ("polylist", [*QUADS[:3].tolist(), *TRIANGLES[6:].tolist()]),
        ("polygons", QUADS.tolist()),
        ("tristrips", STRIPS),
        ("trifans", [[0, 4, 5, 1, 3, 2], [7, 3, 1]]),
    ],
)
def test_every_kind_of_face_becomes_triangles(tag: str, faces: list[list[int]], tmp_path: Path) -> None:
    corners = read_dae(tmp_path, dae(geometry_dae(faces=faces, tag=tag))).triangles.corners()
    expected = [triangle for face in faces for triangle in triangles_of(tag, face)]

    def as_set(triangles: np.ndarray) -> set[tuple[tuple[float, ...], ...]]:
        """The triangles, each from its least corner: strips are not read in order."""
        rolled = [np.roll(each, -min(range(3), key=lambda i: tuple(each[i])), axis=0) for each in triangles]
        return {tuple(map(tuple, each.tolist())) for each in rolled}

    assert len(corners) == len(expected)
    assert as_set(corners) == as_set(CORNERS[expected])


@pytest.mark.parametrize("tag", ["polygons", "polylist"])
@pytest.mark.parametrize("first", range(6))
def test_faces_that_are_not_convex_have_their_own_area(tag: str, first: int, tmp_path: Path) -> None:
    corners = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
    points = [(x, y, z) for z in (0, 2) for x, y in corners]
    order = [(first + k) % 6 for k in range(6)]
    sides = [[k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6] for k in range(6)]
    faces = [order[::-1], [k + 6 for k in order], *sides]
    part = read_dae(tmp_path, dae(geometry_dae(corners=points, faces=faces, tag=tag)))
    analysis = inertia.analyse(part)
    scale = float(part.unit.metres)
    assert analysis.area == pytest.approx(34 * scale**2, rel=1e-14)
    assert analysis.properties.volume == pytest.approx(10 * scale**3, rel=1e-14)
    assert part.notes == ("8 faces with more than three corners were split into triangles",)


def test_every_digit_of_a_coordinate_counts(tmp_path: Path) -> None:
    corners = CORNERS / 3 + 10_000
    nodes = f"<node><matrix>1 0 0 0.1 0 1 0 0 0 0 1 0 0 0 0 1</matrix>{BOX_INSTANCE}</node>"
    part = read_dae(tmp_path, dae(geometry_dae(corners=corners), nodes))
    assert np.array_equal(part.triangles.corners(), (corners + np.array([0.1, 0, 0]))[TRIANGLES])


@pytest.mark.parametrize(
    ("unit", "name", "metres"),
    [
        ("", "m", Fraction(1)),
        ('<unit name="centimeter" meter="0.01"/>', "cm", Fraction(1, 100)),
        ('<unit name="inch" meter="2.54e-2"/>', "in", Fraction(127, 5000)),
        ('<unit name="cubit" meter="0.3"/>', "0.3 m", Fraction(3, 10)),
    ],
)
def test_the_unit_is_the_files_to_the_last_digit(unit: str, name: str, metres: Fraction, tmp_path: Path) -> None:
    part = read_dae(tmp_path, dae(unit=unit))
    assert (part.unit.name, part.unit.metres, part.unit_from) == (name, metres, "file")
    volume = inertia.mass_properties(part, density=1.0).volume
    assert volume == pytest.approx(float(6 * metres**3), rel=1e-15)


@pytest.mark.parametrize("scale", ["1 1 1", "-1 1 1", "2 2 -2"])
def test_a_sample_body_weighs_what_the_catalogue_says(scale: str, tmp_path: Path) -> None:
    corners = inertia.read(sample_path("t_handle.stl")).triangles.corners()
    faces = np.arange(len(corners) * 3).reshape(-1, 3)
    nodes = f"<node><scale>{scale}</scale>{BOX_INSTANCE}</node>"
    part = read_dae(tmp_path, dae(geometry_dae(corners=corners.reshape(-1, 3), faces=faces), nodes))
    properties = inertia.mass_properties(part, density=1.0)
    exact = catalogue()["t_handle.stl"]["mesh"]
    factors = np.array(scale.split(), float)
    size, mirror = abs(factors[0]), np.diag(np.sign(factors))
    assert properties.volume == pytest.approx(exact["volume"] * size**3, rel=1e-14)
    expected = mirror @ np.array(exact["inertia"]) @ mirror * size**5
    assert np.abs(properties.inertia - expected).max() <= 1e-14 * expected.trace()


def test_what_is_no_body_is_noted_or_left_aside(tmp_path: Path) -> None:
    lines = geometry_dae().replace(
        "</mesh>",
        '<lines count="1"><input semantic="VERTEX" source="#box-vertices" offset="0"/><p>0 1</p></lines></mesh>',
    )
    library = (
        '<library_images><image id="i"><init_from>http://192.0.2.1/skin.png</init_from></image></library_images>'
        '<library_effects><effect id="e"><profile_COMMON><technique sid="t"><phong><shininess><float>dull</float>'
        "</shininess></phong></technique></profile_COMMON></effect></library_effects>"
        "<library_animations><animation/></library_animations>"
    )
    nodes = (
        '<node><instance_light url="#no"/><instance_geometry url="#box"><bind_material><technique_common>'
        '<instance_material symbol="m" target="#no"/></technique_common></bind_material></instance_geometry></node>'
    )
    part = read_dae(tmp_path, dae(lines, nodes, library=library))
    assert np.array_equal(part.triangles.corners(), BOX)
    assert part.notes == (
        "its animations were left out: it was read as it stands at their beginning",
        "1 set of lines or points was left out",
    )


def test_a_spline_beside_a_mesh_is_left_out(tmp_path: Path) -> None:
    spline = '<geometry id="path"><spline><source id="q"/><control_vertices/></spline></geometry>'
    nodes = f'<node>{BOX_INSTANCE}<instance_geometry url="#path"/></node>'
    part = read_dae(tmp_path, dae(geometry_dae() + spline + '<geometry id="unused"><brep/></geometry>', nodes))
    assert np.array_equal(part.triangles.corners(), BOX)
    assert part.notes == read_tree(tmp_path / "box.dae").notes == ("1 set of lines or points was left out",)


def test_geometries_are_regions(tmp_path: Path) -> None:
    geometries = geometry_dae("left") + geometry_dae("right")
    nodes = '<node><instance_geometry url="#left"/><instance_geometry url="#right"/></node>'
    part = read_dae(tmp_path, dae(geometries, nodes))
    assert part.regions is not None
    assert [part.regions.names[i] for i in part.regions.index] == ["left"] * 12 + ["right"] * 12


def test_the_manifest_of_an_archive_names_its_document(tmp_path: Path) -> None:
    other = dae(geometry_dae(corners=CORNERS + 5))
    manifest = "<dae_root>./Box.dae</dae_root>"
    part = read_dae(tmp_path, archive(other__dae=other, Box__dae=dae(), manifest__xml=manifest), "box.zae")
    assert np.array_equal(part.triangles.corners(), BOX)


BOMB = """<?xml version="1.0"?><!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]><COLLADA>&b;</COLLADA>"""
SECRET = """<?xml version="1.0"?><!DOCTYPE a [<!ENTITY a SYSTEM "file:///etc/passwd">]><COLLADA>&a;</COLLADA>"""
DOUBLING = (
    "<library_nodes>"
    + "".join(
        f'<node id="n{i}"><instance_node url="#n{i + 1}"/><instance_node url="#n{i + 1}"/></node>' for i in range(60)
    )
    + f'<node id="n60">{BOX_INSTANCE}</node></library_nodes>'
)
CIRCLE = (
    '<library_nodes><node id="a"><instance_node url="#b"/></node>'
    '<node id="b"><instance_node url="#a"/></node></library_nodes>'
)
ONE = geometry_dae()
WORDS = words(np.ravel(CORNERS))
BAD = {
    "entities": (BOMB, "declares a document type"),
    "external entity": (SECRET, "declares a document type"),
    "cut short": (dae()[:-100], "XML is damaged"),
    "unknown encoding": (dae().replace('"utf-8"', '"klingon"'), "decoded|damaged"),
    "nested": (dae(nodes="<node>" * 300 + BOX_INSTANCE + "</node>" * 300), "nested deeper"),
    "doubling": (dae(nodes='<node><instance_node url="#n0"/></node>', library=DOUBLING), "more than 100000000"),
    "circle": (dae(nodes='<node><instance_node url="#a"/></node>', library=CIRCLE), "part of itself"),
    "not a number": (dae(ONE.replace(WORDS, WORDS.replace("1.1", "nan", 1))), "not finite"),
    "no number": (dae(ONE.replace(WORDS, WORDS.replace("1.1", "1,1", 1))), "'1,1'"),
    "one number fewer": (dae(ONE.replace(WORDS, WORDS.rpartition(" ")[0])), "23 numbers"),
    "stride": (dae(ONE.replace('stride="3"', 'stride="4"')), "4 numbers apart"),
    "offset": (dae(ONE.replace('stride="3"', 'stride="3" offset="3"')), "from number 3"),
    "x and z": (dae(ONE.replace('name="Y"', 'name="Z"')), "no x, y and z"),
    "negative": (dae(ONE.replace("<p>0 0", "<p>-1 0")), "names vertex -1"),
    "beyond": (dae(ONE.replace("<p>0 0", "<p>8 0")), "names vertex 8"),
    "one triangle fewer": (dae(geometry_dae(faces=TRIANGLES[1:]).replace('"11"', '"12"')), "says 12 triangles"),
    "half a triangle": (dae(ONE.replace("<p>0 0", "<p>")), "corners, but holds 35"),
    "half a corner": (dae(ONE.replace("<p>0 0", "<p>0")), "fewer than 2 ind"),
    "two lists": (dae(ONE.replace("</p>", "</p><p>0 0 1 0 2 0</p>")), "2 lists of corners"),
    "two corners": (dae(geometry_dae(faces=[[0, 1]], tag="polylist")), "a face with 2 corners"),
    "hole": (dae(geometry_dae(faces=QUADS, tag="polygons").replace("</polygons>", "<ph/></polygons>")), "holes"),
    "hull": (dae('<geometry id="box"><convex_mesh/></geometry>'), "'box' is a convex_mesh, which is not read: export"),
    "shape": (dae('<geometry id="box"><asset/><brep/></geometry>'), "geometry 'box' is a brep, which is not read"),
    "no kind": (dae('<geometry id="box"/>'), "geometry 'box' is a thing of no kind"),
    "no mesh": (dae('<geometry id="other"/>'), "'#box', which it does not hold"),
    "spline": (dae('<geometry id="box"><spline/></geometry>'), "no triangle mesh"),
    "elsewhere": (dae(nodes='<node><instance_geometry url="other.dae#box"/></node>'), "export it as one file"),
    "no scene": (re.sub("<scene>.*</scene>", "", dae()), "has no scene"),
    "empty scene": (dae(nodes="<node/>"), "no triangle mesh"),
    "twins": (dae(ONE + ONE), "two of its elements have the id 'box'"),
    "skin": (dae(nodes='<node><instance_controller url="#skin"/></node>'), "a skin or a morph"),
    "look at": (dae(nodes=f"<node><lookat>0 0 0 1 0 0 0 0 1</lookat>{BOX_INSTANCE}</node>"), "a lookat"),
    "projection": (dae(nodes=f"<node><matrix>{'1 0 0 0 ' * 4}</matrix>{BOX_INSTANCE}</node>"), "last row"),
    "no axis": (dae(nodes=f"<node><rotate>0 0 0 1</rotate>{BOX_INSTANCE}</node>"), "axis without a direction"),
    "short": (dae(nodes=f"<node><scale>1 1</scale>{BOX_INSTANCE}</node>"), "2 numbers, not 3"),
    "unit": (dae(unit='<unit meter="0"/>'), "no length"),
    "unit without end": (dae(unit='<unit meter="1e999999999"/>'), "no length"),
    "unit without size": (dae(unit='<unit name="inch"/>'), "no length"),
    "own unit": (dae(ONE.replace("<mesh>", '<asset><unit meter="2"/></asset><mesh>')), "unit or an axis of its own"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_would_be_misread_is_refused(case: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    text, reason = BAD[case]
    with pytest.raises(ReadError, match=reason):
        read_dae(tmp_path, text)
    assert capfd.readouterr() == ("", "")


def test_a_package_that_is_missing_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "collada.source", None)
    with pytest.raises(ReadError, match=r"without another package \(import of collada\.source"):
        read_dae(tmp_path, dae())


def test_archives_with_several_documents_or_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="2 Collada documents"):
        read_dae(tmp_path, archive(a__dae=dae(), b__dae=dae()), "box.zae")
    with pytest.raises(ReadError, match="0 Collada documents"):
        read_dae(tmp_path, archive(a__txt=dae()), "box.zae")
    with pytest.raises(ReadError, match="zip bomb"):
        read_dae(tmp_path, archive(a__dae=dae() + " " * 70 * 2**20), "box.zae")
