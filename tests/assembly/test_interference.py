"""Parts that share space, against boxes whose common volume is known."""

import json
from pathlib import Path
from typing import Any

import pytest

from inertia.assembly.document import Assembly
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
