"""Polygons of text files: what splitting them decides is said, and places are those of the file."""

import math
from pathlib import Path

import pytest
from tests.mesh.readers.samples import archive_3mf, glb, gltf_tree, mesh_3mf, model_3mf

from inertia.errors import ReadError
from inertia.mass.analyse import analyse
from inertia.mesh.read import read

POINTS = [(x, y, z) for z in (0, 3) for y in (0, 2) for x in (0, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def obj(points=POINTS, faces=FACES) -> str:
    rows = [f"f {' '.join(str(k + 1) for k in face)}\n" for face in faces]
    return "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(rows)


def off(points=POINTS, faces=FACES) -> str:
    rows = [f"{len(face)} {' '.join(map(str, face))}\n" for face in faces]
    return f"OFF\n{len(points)} {len(faces)} 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in points) + "".join(rows)


def ply(points=POINTS, faces=FACES) -> str:
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n" + "".join(f"property double {k}\n" for k in "xyz")
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    return head + off(points, faces).split("\n", 2)[2]


KINDS = {"obj": obj, "off": off, "ply": ply}


def notes(tmp_path: Path, kind: str, text: str) -> tuple[str, ...]:
    (tmp_path / f"box.{kind}").write_text(text)
    return read(tmp_path / f"box.{kind}").notes


def refused(tmp_path: Path, name: str, text: str | bytes) -> str:
    (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ReadError) as raised:
        read(tmp_path / name)
    return str(raised.value)


@pytest.mark.parametrize("kind", KINDS)
def test_faces_that_are_not_flat_say_what_their_split_decides(tmp_path: Path, kind: str) -> None:
    split = "6 faces with more than three corners were split from the first corner"
    assert notes(tmp_path, kind, KINDS[kind]()) == (split,)
    lifted = [*POINTS[:-1], (1, 2, 3.5)]
    said = notes(tmp_path, kind, KINDS[kind](lifted))
    # The diagonals of the top bound a tetrahedron of 1/6: the volume is 6 + 1/3 or 6 + 1/6.
    assert analyse(read(tmp_path / f"box.{kind}")).properties.volume == pytest.approx((6 + 1 / 3) * 1e-9)
    assert said == (
        split,
        "face 1 is not flat: split along other diagonals the volume would differ by up to about 2.6 %, so export "
        "triangles",
    )
    turned = [FACES[0], (5, 7, 6, 4), *FACES[2:]]
    assert "face 1 is not flat" in notes(tmp_path, kind, KINDS[kind](lifted, turned))[1]
    assert analyse(read(tmp_path / f"box.{kind}")).properties.volume == pytest.approx((6 + 1 / 6) * 1e-9)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e4])
def test_faces_that_are_rounded_count_as_flat(tmp_path: Path, size: float) -> None:
    points = [tuple(round(size * k / 7, 8 if size < 1 else 4) for k in (x + y, y - x, z + x + y)) for x, y, z in POINTS]
    assert len(notes(tmp_path, "obj", obj(points))) == 1


@pytest.mark.parametrize(
    ("kind", "extent"), [("obj", "1 to 8"), ("off", "0 to 7 (counted from 0)"), ("ply", "0 to 7 (counted from 0)")]
)
def test_a_vertex_that_is_not_there_is_said_of_the_face_in_the_file(tmp_path: Path, kind: str, extent: str) -> None:
    faces = [*FACES[:4], (0, 4, 6, 8), FACES[5]]
    named = 9 if kind == "obj" else 8
    says = f"face 4 names vertex {named}, but the vertices are {extent}: export the mesh again"
    assert says in refused(tmp_path, f"box.{kind}", KINDS[kind](POINTS, faces))


def test_a_negative_index_is_refused_as_the_file_has_it(tmp_path: Path) -> None:
    text = obj().replace("f 2 4 8 6", "f -7 -5 -9 -3")
    assert "face 5 names vertex -9, but 8 stand before it: export" in refused(tmp_path, "box.obj", text)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("v 1 0 3", "v 1 0 3,0", "vertex 5 holds '3,0', which is not a number"),
        ("v 1 0 3", "v 1 0 3,0 0.5", "vertex 5 holds '3,0', which is not a number"),
        ("f 2 4 8 6", "f 2/1 4/x 8/2 6.0/3", "face 5 holds '6.0', which is not a whole number"),
    ],
)
def test_what_is_no_number_is_said_with_its_place(tmp_path: Path, old: str, new: str, says: str) -> None:
    assert says in refused(tmp_path, "box.obj", obj().replace(old, new))


@pytest.mark.parametrize(
    "text",
    [
        "# made from C:\\parts\\\n" + obj(),
        obj().replace("f 1 3 4 2", "# folder\\\nf 1 3 4 2"),
        obj().replace("f 1 3 4 2", "f 1 3 \\ \n4 \\\n2"),
        obj().replace("f 1 3 4 2", "f 1 3 \\\n4 2").replace("\n", "\r\n"),
        "\ufeff" + obj(),
    ],
)
def test_lines_are_continued_but_comments_are_not(tmp_path: Path, text: str) -> None:
    (tmp_path / "box.obj").write_bytes(text.encode())
    assert analyse(read(tmp_path / "box.obj")).properties.volume == pytest.approx(6e-9)


def test_names_that_repeat_in_a_header_are_refused(tmp_path: Path) -> None:
    twice = ply().replace("property double z\n", "property double z\nproperty double x\n")
    assert "its header has two columns of vertex called 'x': export" in refused(tmp_path, "a.ply", twice)
    again = ply().replace("element face", "element vertex 1\nproperty double x\nelement face")
    assert "its header has two elements called 'vertex': export" in refused(tmp_path, "a.ply", again)


def test_objects_of_3mf_that_share_an_id_are_refused(tmp_path: Path) -> None:
    twice = archive_3mf(model_3mf(2 * f'<object id="1">{mesh_3mf()}</object>', '<item objectid="1"/>'))
    assert "it has two objects with the id '1': export" in refused(tmp_path, "a.3mf", twice)


@pytest.mark.parametrize(
    ("of_node", "of_mesh", "what"),
    [
        ({"skin": 0}, {}, "skin"),
        ({"weights": [0.5]}, {}, "morph"),
        ({}, {"weights": [1.0]}, "morph"),
        ({"weights": [0.0]}, {"weights": [1.0]}, None),
        ({}, {}, None),
    ],
)
def test_what_moves_the_vertices_of_gltf_is_refused(tmp_path: Path, of_node: dict, of_mesh: dict, what: str) -> None:
    tree, binary = gltf_tree()
    node = next(each for each in tree["nodes"] if "mesh" in each)
    mesh = tree["meshes"][node["mesh"]]
    node.update(of_node)
    mesh.update(of_mesh)
    mesh["primitives"][0]["targets"] = [{"POSITION": mesh["primitives"][0]["attributes"]["POSITION"]}]
    if what is None:
        (tmp_path / "a.glb").write_bytes(glb(tree, binary))
        assert read(tmp_path / "a.glb").notes == ()
    else:
        says = f"has a {what}, which moves its vertices: export it as a plain mesh"
        assert says in refused(tmp_path, "a.glb", glb(tree, binary))


def prism(
    outline: list[tuple[float, float]], first: int
) -> tuple[list[tuple[float, float, float]], list[tuple[int, ...]]]:
    """Return corners and faces of a prism of height 2, its caps given from their corner `first` on."""
    count = len(outline)
    order = [(first + k) % count for k in range(count)]
    sides = [(k, (k + 1) % count, (k + 1) % count + count, k + count) for k in range(count)]
    caps = [tuple(reversed(order)), tuple(k + count for k in order)]
    return [(x, y, z) for z in (0, 2) for x, y in outline], [*caps, *sides]


ELL = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
STAR = [
    ((3 - 2 * (k % 2)) * math.cos(math.pi * k / 12), (3 - 2 * (k % 2)) * math.sin(math.pi * k / 12)) for k in range(24)
]
BRIDGED = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]  # a square hole, by a bridge


def measured(outline: list[tuple[float, float]]) -> tuple[float, float]:
    """Return the area of an outline and its length (the shoelace formula)."""
    pairs = list(zip(outline, outline[1:] + outline[:1], strict=True))
    return sum(a * d - b * c for (a, b), (c, d) in pairs) / 2, sum(math.dist(*pair) for pair in pairs)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("outline", "steps"), [(ELL, 1), (STAR, 5), (ELL[::-1], 1)])
def test_faces_that_are_not_convex_have_their_own_area(
    tmp_path: Path, kind: str, outline: list[tuple[float, float]], steps: int
) -> None:
    area, around = measured(outline)
    for first in range(0, len(outline), steps):
        points, faces = prism(outline, first)
        for turn in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            turned = [tuple(point[k] for k in turn) for point in points]
            (tmp_path / f"prism.{kind}").write_text(KINDS[kind](turned, faces))
            part = read(tmp_path / f"prism.{kind}", unit="m")
            solid = analyse(part, orientation="absolute")
            assert solid.area == pytest.approx(2 * abs(area) + 2 * around, rel=1e-14)
            assert solid.properties.volume == pytest.approx(2 * abs(area), rel=1e-14)
            centre = analyse(part, shell=1.0).properties.center_of_mass
            assert centre[turn.index(2)] == pytest.approx(1.0, rel=1e-14)


def test_a_face_that_meets_itself_along_a_bridge_keeps_its_hole_open(tmp_path: Path) -> None:
    (tmp_path / "ring.off").write_text(off([(x, y, 0) for x, y in BRIDGED], [tuple(range(len(BRIDGED)))]))
    ring = analyse(read(tmp_path / "ring.off", unit="m"), shell=1.0)
    assert ring.area == pytest.approx(12.0, rel=1e-14)


def test_what_was_split_otherwise_is_said(tmp_path: Path) -> None:
    assert notes(tmp_path, "off", off(*prism(ELL, 0))) == (
        "8 faces with more than three corners were split from the first corner, 1 of them, which is not convex, along "
        "other diagonals",
    )
