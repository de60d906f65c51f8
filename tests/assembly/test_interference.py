"""Parts that share space, against boxes whose common volume is known."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.mesh import solids

import inertia
from inertia.assembly.document import Assembly
from inertia.errors import GeometryError
from inertia_cli.main import main
from inertia_meshes import path


def assembly(*parts: dict[str, Any]) -> Assembly:
    return Assembly.from_dict({"part": list(parts)})


def box(name: str, *at: float, **fields: Any) -> dict[str, Any]:
    return {"name": name, "shape": "box", "size": [10, 10, 10], "density": 1000.0, "at": list(at), **fields}


def test_boxes_share_their_common_box() -> None:
    (pair,) = assembly(box("a", 0, 0, 0), box("b", 8, 7, 9, density=500.0)).interferences()
    assert (pair.first, pair.second, pair.gap) == ("a", "b", 0.0)
    assert pair.volume == pytest.approx(2e-3 * 3e-3 * 1e-3)
    assert pair.mass == pytest.approx(500 * 6e-9)
    assert pair.place == pytest.approx([4e-3, 3.5e-3, 4.5e-3])


def test_boxes_that_touch_are_in_contact_and_within_no_clearance() -> None:
    touching = assembly(box("a", 0, 0, 0), box("b", 10, 0, 0, quaternion=[0, 0, 1, 1]))
    assert touching.interferences() == ()
    (pair,) = touching.interferences(1e-4)
    assert pair.gap == pytest.approx(0, abs=1e-9)
    apart = assembly(box("a", 0, 0, 0), box("b", 13, 14, 0))
    assert apart.interferences(4.9e-3) == ()
    (pair,) = apart.interferences(5.1e-3)
    assert (pair.volume, pair.gap) == (0.0, pytest.approx(5e-3))


def test_a_part_within_another_shares_all_of_itself() -> None:
    handle = {"name": "h", "file": str(path("t_handle.stl")), "density": 1000.0}
    small = {"name": "s", "file": str(path("cube.stl")), "density": 1000.0, "at": [-500, 0, 0], "mirror": "x"}
    around = box("around", 0, 0, 0, size=[2000, 2000, 2000])
    whole = assembly(handle, around, small)
    pairs = {(each.first, each.second): each for each in whole.interferences()}
    assert set(pairs) == {("h", "around"), ("around", "s")}
    assert pairs["around", "s"].volume == pytest.approx(1e-6)


def test_copies_are_told_apart() -> None:
    ring = box("r", 9, 0, 0, rows={"count": [3, 1, 1], "step": [9, 0, 0]})
    names = [(each.first, each.second) for each in assembly(ring).interferences()]
    assert names == [("r 1", "r 2"), ("r 2", "r 3")]


def test_parts_of_a_file_that_is_nested_twice_are_numbered_through(tmp_path: Path) -> None:
    (tmp_path / "inner.toml").write_text('[[part]]\nname = "b"\nshape = "box"\nsize = [10, 10, 10]\n')
    nested = [{"name": f"n{k}", "assembly": "inner.toml", "at": [9 * k, 0, 0]} for k in range(3)]
    pairs = Assembly.from_dict({"part": nested}, tmp_path).interferences()
    assert [(each.first[-1], each.second[-1]) for each in pairs] == [("1", "2"), ("2", "3")]


def test_a_nested_file_keeps_its_unit(tmp_path: Path) -> None:
    (tmp_path / "inner.toml").write_text('unit = "in"\n[[part]]\nname = "b"\nshape = "box"\nsize = [1, 1, 1]\n')
    nested = {"name": "n", "assembly": "inner.toml"}
    whole = Assembly.from_dict({"part": [nested, box("a", 17, 0, 0)]}, tmp_path)
    (pair,) = whole.interferences()
    assert pair.volume == pytest.approx(0.7e-3 * 1e-4)
    mesh = whole.mesh()
    assert mesh is not None
    corners = mesh.triangles.corners() * float(mesh.unit.metres)
    assert (corners.min(), corners.max()) == pytest.approx((-0.0127, 0.022))


def test_a_shaft_in_its_hub_is_in_contact(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fan = str(path("assemblies/fan.toml"))
    assert main(["assembly", fan, "--interference"]) == 0
    assert "Interference      none" in capsys.readouterr().out
    text = Path(fan).read_text(encoding="utf-8").replace("size = [6, 90]", "size = [7, 90]")
    (tmp_path / "fan.toml").write_text(text, encoding="utf-8")
    assert main(["assembly", str(tmp_path / "fan.toml"), "--interference", "--json"]) == 5
    (pair,) = json.loads(capsys.readouterr().out)["interferences"]
    assert pair["parts"] == ["hub", "shaft"]
    assert pair["volume"] == pytest.approx(3.14159 * (7**2 - 6**2) * 24e-9, rel=0.01)
    assert main(["assembly", fan, "--clearance", "-1"]) == 2


def obj(folder: Path, name: str, points: np.ndarray, faces: list[list[int]]) -> str:
    rows = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in points]
    rows += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    (folder / name).write_text("\n".join(rows))
    return str(folder / name)


CORNERS = np.array([[x, y, z] for x in (-10, 10) for y in (-10, 10) for z in (-10, 10)])
WALLS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
SQUARE = np.array([[0, 0, 3], [30, 0, 3], [30, 40, 3], [0, 40, 3]])


TEE = np.vstack([SQUARE, [[15, 0, 3], [15, 40, 3], [15, 40, 23], [15, 0, 23], [15, 0, -7], [15, 40, -7]]])


def sheet(file: str, **fields: Any) -> dict[str, Any]:
    return {"name": "sheet", "file": file, "shell": 1.0, "density": 2700.0, **fields}


@pytest.mark.parametrize("walls", [WALLS, WALLS[:5], [WALLS[0][::-1], *WALLS[1:]]], ids=["closed", "tray", "wound"])
@pytest.mark.parametrize(
    ("at", "side", "share"),
    [((0, 0, 0), 4, 0), ((9, 0, 0), 4, 16), ((9, 9, 0), 4, 23), ((0, 0, -8), 3, 0), ((0, 0, 0), 20, 20**3 - 19**3)],
)
def test_a_housing_of_sheet_holds_what_is_in_it(
    walls: list[list[int]], at: tuple[float, ...], side: float, share: float, tmp_path: Path
) -> None:
    pairs = assembly(
        sheet(obj(tmp_path, "housing.obj", CORNERS, walls)), box("board", *at, size=[side] * 3)
    ).interferences()
    if side == 20 and len(walls) < 6:
        share -= 0.5 * 19**2
    assert sum(pair.volume for pair in pairs) == pytest.approx(share * 1e-9, rel=1e-9)


def test_a_sheet_through_a_block_shares_its_thickness_with_it(tmp_path: Path) -> None:
    flat = sheet(obj(tmp_path, "flat.obj", SQUARE, [[0, 1, 2, 3]]))
    (pair,) = assembly(box("block", 0, 0, 0), flat).interferences()
    assert (pair.volume, pair.mass) == pytest.approx((25e-9, 25e-6))
    (pair,) = assembly(box("block", 0, 0, -2.6), flat).interferences(1e-3)
    assert pair.gap == pytest.approx(0.1e-3)


def test_sheets_that_are_welded_in_an_edge_are_looked_at(tmp_path: Path) -> None:
    tee = np.vstack([SQUARE, [[15, 0, 3], [15, 40, 3], [15, 40, 23], [15, 0, 23]]])
    file = obj(tmp_path, "tee.obj", tee, [[0, 4, 5, 3], [4, 1, 2, 5], [4, 5, 6, 7]])
    (pair,) = assembly(box("block", 15, 20, 15), sheet(file)).interferences()
    assert pair.volume == pytest.approx(100e-9)


def test_a_one_sided_sheet_is_looked_at(tmp_path: Path) -> None:
    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    arms = np.stack([np.cos(angles / 2) * np.cos(angles), np.cos(angles / 2) * np.sin(angles), np.sin(angles / 2)], 1)
    middle = 30 * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    strip = np.vstack([middle - 5 * arms, middle + 5 * arms])
    faces = [[k, k + 1, k + 13, k + 12] for k in range(11)] + [[11, 12, 0, 23]]  # half a turn
    file = obj(tmp_path, "moebius.obj", strip, faces)
    (pair,) = assembly(sheet(file), box("pin", 30, 0, 0, size=[0.1, 0.1, 0.1])).interferences()
    assert pair.volume == pytest.approx(1e-12)


@pytest.mark.parametrize("turn", [[1, 0, 0, 0], [0.8, 0.36, -0.48, 0], [0.1, -0.7, 0.1, 0.7]])
@pytest.mark.parametrize(
    ("points", "faces", "share"),
    [
        (TEE, [[0, 4, 5, 3], [4, 1, 2, 5], [4, 5, 6, 7]], (30 + 20 - 0.5) * 40),
        (TEE, [[0, 1, 2, 3], [4, 5, 6, 7]], (30 + 20 - 0.5) * 40),
        (TEE - [0, 0, 3], [[0, 4, 5, 3], [4, 1, 2, 5], [8, 9, 6, 7]], (30 + 30 - 1) * 40),
        (SQUARE, [[0, 1, 2, 3], [3, 2, 1, 0]], 1200),
        (SQUARE, [[0, 1, 2, 3], [1, 2, 3, 0]], 1200),
        (np.vstack([SQUARE, np.add(SQUARE, [0, 0, 0.5])]), [[0, 1, 2, 3], [4, 5, 6, 7]], 1800),
        (np.vstack([SQUARE, SQUARE[:1]]), [[0, 1, 2, 3], [0, 4, 1]], 1200),
    ],
    ids=["tee", "tee in a wall", "cross", "back", "copy", "lap", "no area"],
)
def test_walls_of_a_sheet_that_overlap_count_once(
    points: np.ndarray, faces: list[list[int]], share: float, turn: list[float], tmp_path: Path
) -> None:
    around = box("around", 0, 0, 0, size=[200] * 3)
    (pair,) = assembly(sheet(obj(tmp_path, "a.obj", points, faces), quaternion=turn), around).interferences()
    assert pair.volume == pytest.approx(share * 1e-9, rel=1e-8)


@pytest.mark.parametrize("degrees", [90, 150, 168, 170, 179])
def test_a_fold_neither_tapers_nor_grows(degrees: float, tmp_path: Path) -> None:
    x, z = 30 * (1 - math.cos(math.radians(180 - degrees))), 30 * math.sin(math.radians(degrees))
    fold = np.array([[0, 0, 0], [30, 0, 0], [30, 40, 0], [0, 40, 0], [x, 40, z], [x, 0, z]])
    file = obj(tmp_path, "fold.obj", fold, [[0, 1, 2, 3], [1, 5, 4, 2]])
    (pair,) = assembly(sheet(file), box("below", 15, 20, -5.1, size=[20, 20, 10])).interferences()
    assert pair.volume == pytest.approx(20 * 20 * 0.4e-9)
    if degrees > 90:
        assert assembly(sheet(file), box("beyond", 40.6, 20, -5, size=[20, 20, 10])).interferences() == ()


def test_a_sheet_thicker_than_what_it_encloses_fills_it(tmp_path: Path) -> None:
    radius, (vertices, faces) = 10.0, solids.sphere(radius=10.0, splits=2)
    ball = sheet(obj(tmp_path, "ball.obj", vertices, faces.tolist()))
    pin = box("pin", 0, 0, 0, size=[radius / 10] * 3)
    (pair,) = assembly({**ball, "shell": 3 * radius}, pin).interferences()
    assert pair.volume == pytest.approx((radius / 10) ** 3 * 1e-9)
    around = box("around", 0, 0, 0, size=[4 * radius] * 3)
    (pair,) = assembly({**ball, "shell": radius / 10}, around).interferences()
    sides = vertices[faces[:, 1:]] - vertices[faces[:, :1]]
    area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()
    assert pair.volume == pytest.approx(area * radius / 10 * 1e-9, rel=0.04)  # prisms share the inside of edges


def test_a_sheet_with_more_prisms_than_are_united_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inertia.assembly.interference.MOST_PRISMS", 2)
    flat = sheet(obj(tmp_path, "flat.obj", TEE, [[0, 4, 5, 3], [4, 1, 2, 5]]))
    whole = assembly(flat, box("block", 15, 20, 0), box("corner", 29, 1, 3, size=[2, 2, 2]))
    assert [each.second for each in whole.interferences()] == ["corner"]
    assert whole.unexamined() == {
        "sheet": "4 of its triangles are near block, more than the 2 that are united: simplify it"
    }
    with pytest.raises(GeometryError, match="the clearance of sheet cannot be had: 4 of its"):
        whole.interferences(1e-3)


def test_cells_are_looked_at_by_their_outside() -> None:
    bar = {"name": "bar", "file": str(path("two_region_bar.vtk")), "density": 1000.0, "unit": "mm"}
    points = inertia.read(path("two_region_bar.vtk"), unit="mm").geometry.points
    low, high = points.min(axis=0), points.max(axis=0)
    (pair,) = assembly(bar, box("around", *(low + high) / 2, size=list(high - low + 2))).interferences()
    assert pair.volume == pytest.approx(np.prod(high - low) * 1e-9)


@pytest.mark.parametrize(("raised", "count"), [(0.0, 1), (1.0, 0)])
def test_cells_with_flat_faces_are_judged_as_triangles_are(raised: float, count: int, tmp_path: Path) -> None:
    hexahedron = CORNERS[[0, 4, 6, 2, 1, 5, 7, 3]] + [0.0, 0.0, raised] * np.eye(8, 1, -7)
    rows = "\n".join(" ".join(map(repr, row)) for row in hexahedron.tolist())
    (tmp_path / "hex.vtk").write_text(
        f"# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n{rows}\n"
        "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n"
    )
    cells = {"name": "c", "file": str(tmp_path / "hex.vtk"), "density": 1000.0, "unit": "mm"}
    pairs = assembly(cells, box("deep", 0, 0, -19.96, size=[20] * 3)).interferences()
    assert [pair.volume for pair in pairs] == [pytest.approx(20 * 20 * 0.04e-9)] * count


def test_what_cannot_be_looked_at_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    weighed = 'name = "w"\nmass = 1\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n'
    (tmp_path / "a.toml").write_text(f'[[part]]\n{weighed}[[part]]\nname = "p"\nshape = "point"\nmass = 1\n')
    assert main(["assembly", str(tmp_path / "a.toml"), "--interference"]) == 0
    text = capsys.readouterr().out
    assert "Interference      none of the parts that were looked at" in text
    assert "Not looked at     w: only what it weighs is stated" in text
    assert main(["assembly", str(tmp_path / "a.toml"), "--interference", "--json"]) == 0
    assert [each["part"] for each in json.loads(capsys.readouterr().out)["unexamined"]] == ["w"]


def test_a_part_of_which_no_clearance_can_be_had_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: Any) -> None:
        raise GeometryError("manifold3d does not take it")

    monkeypatch.setattr("inertia.assembly.interference.solid", refused)
    whole = assembly(box("a", 0, 0, 0), box("b", 11, 0, 0))
    assert whole.interferences() == ()
    with pytest.raises(GeometryError, match="the clearance of a cannot be had"):
        whole.interferences(2e-3)
