"""Trees that files carry against sums over their triangles, moved corner by corner in rational arithmetic."""

import json
import math
import struct
import zipfile
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.assembly.test_assembly import Matrix, assert_within_bounds, moved, then, turn
from tests.assembly.test_samples import body, box, together, tube, tube_mass
from tests.assembly.test_samples import moved as moved_bodies

import inertia
from inertia.assembly.document import Assembly
from inertia.assembly.outline import outline
from inertia.errors import GeometryError, ReadError, UsageError
from inertia_cli.main import main
from inertia_meshes import path

Triangles = list[list[list[Fraction]]]

BOX = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)]
BOX_FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
             (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
WEDGE_FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
MESHES = {0: (BOX, BOX_FACES), 1: (WEDGE, WEDGE_FACES)}


def triangles(kind: int) -> Triangles:
    points, faces = MESHES[kind]
    return [[[Fraction(k) for k in points[corner]] for corner in face] for face in faces]


def linear(rows: Sequence[Sequence[Any]], at: Sequence[Any] = (0, 0, 0)) -> Matrix:
    return [[*(Fraction(str(k)) for k in row), Fraction(str(t))] for row, t in zip(rows, at, strict=True)]


def scaled(x: Any, y: Any, z: Any) -> Matrix:
    return linear([[x, 0, 0], [0, y, 0], [0, 0, z]])


def instance(kind: int, placement: Matrix) -> tuple[Triangles, Fraction]:
    """Return a mesh where it is placed, facing outwards, and its density."""
    a, b, c = (row[:3] for row in placement)
    determinant = sum(a[i] * (b[j] * c[k] - b[k] * c[j]) for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)))
    corners = moved(triangles(kind), placement)
    return ([each[::-1] for each in corners] if determinant < 0 else corners), Fraction(1000)


def glb(file: Path, nodes: list[dict[str, Any]], names: Sequence[str | None] = (None, None)) -> Path:
    """Write the meshes, box and wedge, below nodes; those that are nobody's children are at the top."""
    blob, views, accessors = b"", [], []
    for points, faces in MESHES.values():
        for code, rows, kind in (("3f", points, 5126), ("3I", faces, 5125)):
            data = b"".join(struct.pack(f"<{code}", *row) for row in rows)
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
            count = len(rows) * (1 if kind == 5126 else 3)
            layout = {"componentType": kind, "count": count, "type": "VEC3" if kind == 5126 else "SCALAR"}
            accessors.append({"bufferView": len(views) - 1, **layout})
            blob += data
    meshes: list[dict[str, Any]] = [
        {"primitives": [{"attributes": {"POSITION": 2 * k}, "indices": 2 * k + 1}]} for k in (0, 1)
    ]
    for mesh, name in zip(meshes, names, strict=True):
        mesh |= {} if name is None else {"name": name}
    tree = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(blob)}], "bufferViews": views}
    text = json.dumps({**tree, "accessors": accessors, "meshes": meshes, "nodes": nodes}).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(blob)) + b"BIN\0" + blob
    file.write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body)
    return file


def package(file: Path, objects: str, items: str, unit: str = "millimeter") -> Path:
    """Write a 3MF file."""
    space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    model = f'<model unit="{unit}" xmlns="{space}"><resources>{objects}</resources><build>{items}</build></model>'
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
    return file


def collada(file: Path, scene: str, library: str = "", unit: str = "1") -> Path:
    """Write the meshes as the geometries `box` and `wedge`, below the nodes of a scene."""
    geometries = ""
    for name, (points, faces) in zip(("box", "wedge"), MESHES.values(), strict=True):
        numbers = " ".join(str(k) for point in points for k in point)
        corners = " ".join(str(k) for face in faces for k in face)
        accessor = (
            f'<accessor source="#{name}-a" count="{len(points)}" stride="3"><param name="X" type="float"/>'
            '<param name="Y" type="float"/><param name="Z" type="float"/></accessor>'
        )
        geometries += (
            f'<geometry id="{name}" name="{name} mesh"><mesh><source id="{name}-s">'
            f'<float_array id="{name}-a" count="{3 * len(points)}">{numbers}</float_array>'
            f"<technique_common>{accessor}</technique_common></source>"
            f'<vertices id="{name}-v"><input semantic="POSITION" source="#{name}-s"/></vertices>'
            f'<triangles count="{len(faces)}"><input semantic="VERTEX" source="#{name}-v" offset="0"/>'
            f"<p>{corners}</p></triangles></mesh></geometry>"
        )
    file.write_text(
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
        f'<asset><unit meter="{unit}"/></asset><library_geometries>{geometries}</library_geometries>{library}'
        f'<library_visual_scenes><visual_scene id="all">{scene}</visual_scene></library_visual_scenes>'
        '<scene><instance_visual_scene url="#all"/></scene></COLLADA>'
    )
    return file


def mesh_object(number: int, kind: int, name: str = "") -> str:
    points, faces = MESHES[kind]
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in points)
    corners = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    called = f' name="{name}"' if name else ""
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{corners}</triangles></mesh>"
    return f'<object id="{number}"{called}>{mesh}</object>'


def names(table: dict[str, Any]) -> list[tuple[str, str | None]]:
    return [(part["name"], part.get("parent")) for part in table["part"]]


def test_nodes_of_gltf_are_parts_where_their_matrices_put_them(tmp_path: Path) -> None:
    file = glb(
        tmp_path / "scene.glb",
        [
            {"name": "root", "rotation": [0.6, 0, 0, 0.8], "translation": [1, 0.1, -3], "children": [1, 2, 4]},
            {"name": "box", "mesh": 0, "rotation": [0, 0, 0.38268343, 0.9238795]},
            {"name": "arm", "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1], "children": [3]},
            {"mesh": 1, "translation": [0.25, 0, 0]},
            {"name": "lamp", "children": []},
        ],
    )
    whole = Assembly.load(file)
    root = turn((3, 0, 0, 4), [Fraction(1), Fraction("0.1"), Fraction(-3)])
    arm = then(root, linear([[0, -1, 0], [1, 0, 0], [0, 0, 1]], (5, 6, 7)))
    box = then(root, turn((0, 0, 38268343, 92387950), [Fraction(0)] * 3))
    wedge = then(arm, linear([[1, 0, 0], [0, 1, 0], [0, 0, 1]], (0.25, 0, 0)))
    assert_within_bounds(whole.mass_properties(), [instance(0, box), instance(1, wedge)], 1e-13)
    table = outline(file, tmp_path).table
    assert names(table) == [("root", None), ("box", "root"), ("arm", "root"), ("mesh 1", "arm")]
    assert "stretch" not in str(table)


def test_what_scales_mirrors_or_shears_is_handed_down_to_the_meshes(tmp_path: Path) -> None:
    file = glb(
        tmp_path / "scene.glb",
        [
            {"scale": [0.001] * 3, "children": [1, 2]},
            {"mesh": 0, "rotation": [0.7071067690849304, 0, 0, 0.7071067690849304], "scale": [-2, 1, 3]},
            {"matrix": [1, 0.2, 0, 0, 0, 1, 0, 0, 0.1, 0, 1, 0, 4, 5, 6, 1], "children": [3, 4]},
            {"mesh": 1, "rotation": [0, 0.6, 0, 0.8], "translation": [1, 1, 1]},
            {"mesh": 1, "scale": [0, 1, 1]},
        ],
    )
    whole = Assembly.load(file)
    root = scaled("0.001", "0.001", "0.001")
    box = then(root, then(turn((1, 0, 0, 1), [Fraction(0)] * 3), scaled(-2, 1, 3)))
    sheared = then(root, linear([[1, 0, "0.1"], ["0.2", 1, 0], [0, 0, 1]], (4, 5, 6)))
    wedge = then(sheared, turn((0, 3, 0, 4), [Fraction(1)] * 3))
    assert_within_bounds(whole.mass_properties(), [instance(0, box), instance(1, wedge)])
    assert "mesh 1 2 is scaled to nothing: its mesh is left out" in whole.notes
    surfaces = sum(len(corners) for _, corners in whole.surfaces())
    assert surfaces == len(BOX_FACES) + len(WEDGE_FACES)
    drawn = whole.mesh()
    assert drawn is not None
    properties = inertia.mass_properties(drawn, 1000.0)  # all face outwards, also the mirrored
    assert properties.mass == pytest.approx(whole.mass_properties().mass, rel=1e-12)


def test_items_and_components_of_3mf_are_parts_where_their_transforms_put_them(tmp_path: Path) -> None:
    components = (
        '<components><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 10 0.1 0"/>'
        '<component objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 0"/><component objectid="2"/></components>'
    )
    objects = mesh_object(1, 0, "plate") + mesh_object(2, 1) + f'<object id="3" name="pair">{components}</object>'
    items = '<item objectid="3" transform="1 0 0 0 1 0 0 0 -1 0 0 5"/><item objectid="3"/><item objectid="1"/>'
    file = package(tmp_path / "plate.3mf", objects, items, "inch")
    whole = Assembly.load(file)
    parts = []
    for place in (linear([[1, 0, 0], [0, 1, 0], [0, 0, -1]], (0, 0, 5)), scaled(1, 1, 1)):
        parts.append(instance(0, then(place, linear([[0, -1, 0], [1, 0, 0], [0, 0, 1]], (10, 0.1, 0)))))
        parts += [instance(1, then(place, scaled(k, k, k))) for k in (2, 1)]
    parts.append(instance(0, scaled(1, 1, 1)))
    metres = Fraction("0.0254")
    parts = [([[[metres * k for k in p] for p in each] for each in corners], density) for corners, density in parts]
    assert_within_bounds(whole.mass_properties(), parts)
    table = outline(file, tmp_path).table
    assert table["unit"] == "in"
    assert names(table) == [
        ("pair", None), ("plate", "pair"), ("object 2", "pair"), ("object 2 2", "pair"),
        ("pair 2", None), ("plate 2", "pair 2"), ("object 2 3", "pair 2"), ("object 2 4", "pair 2"), ("plate 3", None),
    ]  # fmt: skip
    assert {part["mesh"] for part in table["part"] if "mesh" in part} == {"plate", "object 2"}


def test_nodes_of_collada_are_parts_where_their_transforms_put_them(tmp_path: Path) -> None:
    library = (
        '<library_nodes><node id="pair" name="pair"><translate>0.5 0 0</translate>'
        '<instance_geometry url="#box"/><instance_geometry url="#wedge"/></node></library_nodes>'
    )
    scene = (
        '<node id="n1" name="top"><translate>1 2 0.3</translate><rotate>0 0 2 90</rotate><rotate>1 0 0 -180</rotate>'
        '<scale>2 2 2</scale><instance_node url="#pair"/><node id="n2"><matrix>0.6 -0.8 0 4 0.8 0.6 0 5 0 0 1 6 0 0 0 1'
        '</matrix><instance_geometry url="#wedge"/></node></node><node name="other"><instance_node url="#pair"/></node>'
    )
    file = collada(tmp_path / "scene.dae", scene, library, "0.01")
    place = then(
        turn((0, 0, 1, 1), [Fraction(1), Fraction(2), Fraction("0.3")]), turn((-1, 0, 0, 0), [Fraction(0)] * 3)
    )
    top, pair = then(place, scaled(2, 2, 2)), linear([[1, 0, 0], [0, 1, 0], [0, 0, 1]], (0.5, 0, 0))
    turned = linear([["0.6", "-0.8", 0], ["0.8", "0.6", 0], [0, 0, 1]], (4, 5, 6))
    parts = [instance(kind, then(outer, pair)) for outer in (top, scaled(1, 1, 1)) for kind in (0, 1)]
    parts.append(instance(1, then(top, turned)))
    parts = [([[[k / 100 for k in p] for p in each] for each in corners], density) for corners, density in parts]
    assert_within_bounds(Assembly.load(file).mass_properties(), parts)
    table = outline(file, tmp_path).table
    assert names(table) == [
        ("top", None), ("n2", "top"), ("pair", "top"), ("box mesh", "pair"), ("wedge mesh", "pair"),
        ("other", None), ("pair 2", "other"), ("box mesh 2", "pair 2"), ("wedge mesh 2", "pair 2"),
    ]  # fmt: skip
    assert {part["mesh"] for part in table["part"] if "mesh" in part} == {"box mesh", "wedge mesh"}


def test_an_angle_of_collada_is_the_turn_to_its_last_digit(tmp_path: Path) -> None:
    scene = (
        '<node name="a"><rotate>0 3 4 37.5</rotate><translate>7 0 0</translate><instance_geometry url="#box"/></node>'
    )
    whole = Assembly.load(collada(tmp_path / "a.dae", scene)).mass_properties()
    turned = Rotation.from_rotvec(np.array([0, 0.6, 0.8]) * 37.5, degrees=True)
    assert whole.center_of_mass == pytest.approx(turned.apply([7.5, 1, 1.5]), rel=1e-15)
    own = np.diag([13, 10, 5]) * 500.0
    assert whole.inertia == pytest.approx(turned.as_matrix() @ own @ turned.as_matrix().T, rel=1e-14)


def test_products_of_step_are_parts_where_the_assembly_puts_them(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from tests.mesh.readers.kernel_solids import write_assembly

    write_assembly(tmp_path / "machine.step")
    file = tmp_path / "machine.step"
    tree = outline(file, tmp_path).table["part"]
    plate = ["bolted plate", *["bolt"] * 4, "plate"]
    assert [part["name"].rstrip(" 0123456789") for part in tree] == ["machine", *plate, *plate, *["pair"] * 3]
    assert [part.get("parent") for part in tree[1:7]] == ["machine", *["bolted plate"] * 5]
    assert len({part["mesh"] for part in tree if "mesh" in part}) == 4
    bolt = Rotation.identity(), (tube_mass(3, 0, 20, 1000), tube(3, 0, 20), (0, 0, 10))
    flat = [body(0.0125, box(50, 50, 5), (25, 25, 2.5))]
    for k in range(4):
        flat += moved_bodies([body(*bolt[1])], bolt[0], (10 + 30 * (k % 2), 10 + 30 * (k // 2), 6))
    leaning = Rotation.from_rotvec(np.array([1, 1, 0]) / math.sqrt(2))
    pair = [body(6e-6, box(1, 2, 3), (0.5, 1, 1.5)), body(tube_mass(2, 0, 2, 1000), tube(2, 0, 2), (20, 0, 1))]
    everything = [*flat, *moved_bodies(flat, leaning, (100, 0, 0)), *moved_bodies(pair, bolt[0], (0, 200, 0))]
    mass, center, tensor = together(everything)
    whole = Assembly.load(file).mass_properties()
    assert whole.mass == pytest.approx(mass, rel=1e-13)
    assert whole.center_of_mass == pytest.approx(center, rel=1e-13)
    assert whole.inertia == pytest.approx(tensor, rel=1e-12)


def test_a_mesh_is_integrated_once_however_often_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = [{"mesh": k % 2, "translation": [5 * k, 0, 0]} for k in range(20)]
    import inertia.assembly.bodies as bodies

    calls = []
    monkeypatch.setattr(
        bodies, "analyse", lambda *a, original=bodies.analyse, **b: calls.append(a) or original(*a, **b)
    )
    whole = Assembly.load(glb(tmp_path / "many.glb", nodes)).mass_properties()
    assert len(calls) == 2
    shift = [linear([[1, 0, 0], [0, 1, 0], [0, 0, 1]], (5 * k, 0, 0)) for k in range(20)]
    assert_within_bounds(whole, [instance(k % 2, place) for k, place in enumerate(shift)], 1e-12)


def test_what_is_written_reads_back_as_the_tree(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = glb(
        tmp_path / "scene.glb",
        [
            {"name": "wheel", "mesh": 0, "scale": [0.001, 0.002, 0.001], "translation": [0.1, 0.2, 1 / 3]},
            {"name": "wheel", "mesh": 0, "rotation": [0.1, 0.2, 0.3, 0.9]},
            {"mesh": 1, "name": "bolt \u2116 1\u202e", "matrix": [1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
        ],
        ("same", "same"),
    )
    written = tmp_path / "scene.toml"
    assert main(["assembly", str(file), "--to-toml", str(written)]) == 0
    again = Assembly.load(written)
    assert [part.name for part in again.fields.part] == ["wheel", "wheel 2", "bolt \u2116 1\\u202e"]
    assert [part.mesh for part in again.fields.part] == ["same", "same", "same 2"]
    one, other = (each.mass_properties() for each in (Assembly.load(file), again))
    assert one.inertia == pytest.approx(other.inertia, rel=1e-14)
    assert main(["budget", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["total"]["basic_mass"] == pytest.approx(one.mass)
    nested = Assembly.from_dict(
        {"densities": {"gum": 500}, "materials": {"wheel*": "gum"}, "part": [{"name": "a", "assembly": str(file)}]}
    )
    heavier = Assembly.from_dict(
        {**again.to_dict(), "densities": {"gum": 500}, "materials": {"wheel*": "gum"}}, tmp_path
    )
    assert nested.mass_properties().mass == pytest.approx(heavier.mass_properties().mass, rel=1e-14)


@pytest.mark.parametrize(
    ("nodes", "says"),
    [
        ([{"children": [1]}, {"children": [2]}, {"mesh": 0, "children": [1]}], "node 1 hangs in two places"),
        ([{"mesh": 0, "rotation": [0, 0, 0, 0]}], "quaternion of zero"),
        ([{"mesh": 7}], r"nodes\[0\].mesh refers to meshes\[7\], but the file holds 2"),
        ([{"mesh": 0, "translation": [1, 2]}], r"a list of 2 as nodes\[0\].translation, where 3 numbers must stand"),
    ],
)
def test_a_faulty_tree_is_refused_in_a_sentence(nodes: list[dict[str, Any]], says: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=says):
        Assembly.load(glb(tmp_path / "faulty.glb", nodes)).mass_properties()


def test_a_faulty_mesh_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(MESHES, 1, (WEDGE, WEDGE_FACES[:3]))
    file = glb(tmp_path / "open.glb", [{"name": "whole", "mesh": 0}, {"name": "gap", "mesh": 1}])
    with pytest.raises(GeometryError, match=r"open.glb: gap: 'mesh 1' of open.glb: open: 1 boundary loop"):
        Assembly.load(file).mass_properties()


@pytest.mark.parametrize("command", ["assembly", "budget"])
def test_a_faulty_mesh_is_named_once_and_no_field_of_a_file_that_nobody_wrote(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(path("broken/missing_face.stl"))
    assert main([command, file]) == 4
    said = capsys.readouterr().err
    assert said.startswith(f"inertia: {file}: open: 1 boundary loop")
    assert "part[0]" not in said


def test_an_object_that_holds_itself_is_refused(tmp_path: Path) -> None:
    objects = '<object id="1"><components><component objectid="1"/></components></object>'
    with pytest.raises(ReadError, match="component of itself"):
        Assembly.load(package(tmp_path / "ring.3mf", objects, '<item objectid="1"/>'))


def test_a_mesh_that_is_not_there_is_refused_with_those_that_are(tmp_path: Path) -> None:
    glb(tmp_path / "scene.glb", [{"mesh": 0}, {"mesh": 1}])
    part = {"name": "a", "file": "scene.glb", "mesh": "wheel"}
    with pytest.raises(UsageError, match=r"scene\.glb has no mesh 'wheel': it has 'mesh 0', 'mesh 1'"):
        Assembly.from_dict({"part": [part]}, tmp_path).mass_properties()
    part = {"name": "a", "file": str(path("box.stl")), "mesh": "wheel"}
    with pytest.raises(UsageError, match="of a format that places no meshes: leave mesh out"):
        Assembly.from_dict({"part": [part]}, tmp_path).mass_properties()


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"mesh": "a", "region": "b"}, "region is given beside mesh"),
        ({"stretch": [1, 0, 1]}, "leaves nothing of the part"),
        ({"stretch": [[1, 2, 3], [2, 4, 6], [0, 0, 1]]}, "leaves nothing of the part"),
        ({"stretch": 2}, "stretch"),
        ({"stretch": [[1, 0, 0], [0, 1, 0]]}, "stretch must be three numbers$"),
        ({"stretch": [2, 2, 2], "shell": 0.1}, "shell is given beside stretch"),
        ({"stretch": [2, 2, 2], "sigma": 0.1}, "sigma is given beside stretch"),
    ],
)
def test_what_cannot_be_of_a_mesh_is_refused(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        Assembly.from_dict({"part": [{"name": "a", "file": str(path("box.stl")), **fields}]})


def test_a_mesh_or_stretch_without_a_file_is_refused() -> None:
    for field in ({"mesh": "a"}, {"stretch": [2, 2, 2]}):
        with pytest.raises(UsageError, match="is that of a file, and the part has none"):
            Assembly.from_dict({"part": [{"name": "a", "shape": "box", "size": [1, 1, 1], **field}]})


def test_regions_of_cells_are_parts(tmp_path: Path) -> None:
    table, notes, *_ = outline(path("two_region_bar.vtk"), tmp_path)
    assert [part["region"] for part in table["part"]] == ["1", "2"]
    assert notes == ()
    parts = Assembly.from_dict(
        {**table, "densities": {"a": 2000, "b": 3000}, "materials": {"1": "a", "2": "b"}}, tmp_path
    )
    same = inertia.mass_properties(inertia.read(path("two_region_bar.vtk")), {"1": 2000.0, "2": 3000.0})
    whole = parts.mass_properties()
    assert whole.mass == pytest.approx(same.mass, rel=1e-15)
    assert whole.inertia == pytest.approx(same.inertia, rel=1e-14, abs=1e-20)
