"""`inertia assembly` and `inertia budget`: what they print, write and refuse."""

import csv
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from inertia_cli.main import main
from inertia_meshes import path

FAN = str(path("assemblies/fan.toml"))
BALL = '[[part]]\nname = "ball"\nshape = "point"\nmass = "1±0.1"\n[[limit]]\nwhat = "mass"\nmax = {}\n'


def test_the_budget_as_a_document(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["budget", FAN, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "inertia/budget/1"
    assert document["verdict"] == "pass"
    total = document["total"]
    assert sum(part["basic_mass"] for part in document["parts"]) == pytest.approx(total["mass"], rel=1e-14)
    assert total["predicted_mass"] == pytest.approx(total["mass"] + total["allowance"])
    impeller = document["parts"][0]
    assert [part["quantity"] for part in impeller["parts"]] == [1, 9]
    shares = [each["share"]["mass"] for each in total["contributors"]]
    assert sum(shares) == pytest.approx(1)
    assert [limit["verdict"] for limit in document["limits"]] == ["pass"] * 3


def test_the_assembly_as_a_document(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assembly", FAN, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "inertia/assembly/1"
    assert document["error"]["inertia"] < 1e-14
    assert main(["assembly", "--schema"]) == 0
    assert "part" in json.loads(capsys.readouterr().out)["properties"]


@pytest.mark.parametrize(("limit", "code", "verdict"), [(2.0, 0, "PASS"), (1.1, 4, "UNDECIDED"), (0.5, 5, "FAIL")])
def test_the_exit_code_is_the_verdict(
    limit: float, code: int, verdict: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.toml").write_text(BALL.format(limit), encoding="utf-8")
    assert main(["budget", str(tmp_path / "a.toml")]) == code
    assert capsys.readouterr().out.startswith(f"Budget            a: {verdict}\n")


def test_the_table_has_a_row_for_each_line(tmp_path: Path) -> None:
    assert main(["budget", FAN, "--csv", str(tmp_path / "fan.csv")]) == 0
    with (tmp_path / "fan.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["part"] for row in rows] == [
        "Fan",
        "impeller",
        "impeller/hub",
        "impeller/blade",
        "shaft",
        "motor",
        "screw",
    ]
    assert float(rows[0]["basic_mass"]) == pytest.approx(sum(float(row["basic_mass"]) for row in rows[2:]))
    assert main(["budget", FAN, "--csv", str(tmp_path / "fan.csv")]) == 2


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("[[part]]\nshape = 'point'\n", 2, "part[0].name is missing: it has to be given"),
        ("[[part]]\nname = 'g'\n", 2, "it has no part with a mass: give one a file, a shape or a mass"),
        ("[[part]]\nname = 'g'\nfile = 'no.stl'\n", 3, "no.stl: there is no such file: check the path"),
        ("[[limit]]\nwhat = 'mass'\nmax = 1\n", 2, "part is missing"),
        ("[[part]]\nname = 'g'\nmass = 1\n[[limit]]\nwhat = 'inertia.zx'\nmax = 1\n", 2, "did you mean inertia.xz?"),
        ("not toml", 3, "it is not TOML"),
    ],
)
def test_what_cannot_be_is_one_sentence(
    text: str, code: int, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    assert main(["budget", str(tmp_path / "a.toml")]) == code
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert "Traceback" not in error


def test_a_file_that_is_compared_is_named_where_it_cannot_be_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old = tmp_path / "old.toml"
    old.write_text('part = [{name = "sheet", file = "open.stl"}]')
    (tmp_path / "open.stl").write_bytes(path("broken/missing_face.stl").read_bytes())
    assert main(["budget", "--diff", str(old), FAN]) == 4
    assert capsys.readouterr().err.startswith(f"inertia: {old}: part[0]: ")
    assert main(["budget", "--diff", FAN, str(tmp_path / "none.toml")]) == 3
    assert capsys.readouterr().err.startswith(f"inertia: cannot read {tmp_path / 'none.toml'}: ")


def test_a_robot_is_compared_as_the_tree_that_it_carries(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, written = str(path("robots/arm.urdf")), str(tmp_path / "arm.toml")
    assert main(["assembly", robot, "--to-toml", written]) == 0
    assert main(["budget", "--diff", robot, written]) == 0
    assert "No part changed." in capsys.readouterr().out


def test_what_changed_is_told_part_by_part(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = Path(FAN).read_text(encoding="utf-8")
    text = text.replace("count = 9", "count = 7").replace('name = "screw"', 'name = "bolt"')
    (tmp_path / "new.toml").write_text(text, encoding="utf-8")
    assert main(["budget", "--diff", FAN, str(tmp_path / "new.toml"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "inertia/budget-diff/1"
    changes = {each["part"]: each for each in document["changes"]}
    kinds = {name: each["kind"] for name, each in changes.items()}
    assert kinds == {"impeller/blade": "changed", "bolt": "added", "screw": "removed"}
    blade = changes["impeller/blade"]
    assert blade["quantity"] == [9, 7]
    assert blade["effect"]["mass"] == pytest.approx(-2 * 0.07 * 0.024 * 0.002 * 1150)
    old, new = document["mass"]
    assert new - old == pytest.approx(sum(each["effect"]["mass"] for each in changes.values()))
    assert main(["budget", "--diff", FAN, FAN]) == 0
    assert "No part changed." in capsys.readouterr().out
    assert main(["budget", FAN, "--diff", FAN, FAN]) == 2


_PART = """[[part]]
name = "{name}"
shape = "point"
mass = "{mass}"
{more}
"""
_WHOLE = _PART.format(name="a", mass="1±0.01", more="{more}") + _PART.format(
    name="b", mass="2±{u}", more='parent = "a"'
)


def _changed(tmp_path: Path, limit: float = 4, more: str = "", u: float = 0.02) -> str:
    file = tmp_path / f"{limit}{more[:8]}{u}.toml"
    limits = f'[[limit]]\nwhat = "mass"\nmax = {limit}\n'
    file.write_text(_WHOLE.format(more=more, u=u) + limits, encoding="utf-8")
    return str(file)


@pytest.mark.parametrize(
    ("new", "code", "says"),
    [
        ({"limit": 2.5}, 5, ["New limit         mass ≤ 2.5 kg: 3.000 ± 0.044 (95 %) kg, margin -0.5: FAIL", "No part"]),
        ({"u": 2}, 4, ["3.000 ± 0.044 (95 %) → 3.0 ± 3.9 (95 %) kg (+0)", "a/b   changed", "u 0.02 → 2 kg"]),
        ({"more": "maturity = 'actual'"}, 0, ["a     changed", "maturity none → actual"]),
        ({"more": "position_uncertainty = 3"}, 0, ["a     changed", "u of position 0 → 3 mm"]),
        ({"more": "angle_uncertainty = 3"}, 0, ["a     changed", "u of angle 0 → 3°"]),
    ],
)
def test_what_flips_a_verdict_is_told_where_no_figure_changed(
    new: dict[str, Any], code: int, says: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = _changed(tmp_path), _changed(tmp_path, **new)
    assert main(["budget", "--diff", *files]) == code
    text = capsys.readouterr().out
    assert [word for word in says if word not in text] == []
    assert main(["budget", "--diff", *files, "--json"]) == code
    document = json.loads(capsys.readouterr().out)
    assert [limit["limit"][1] for limit in document["limits"][0]] == [4, new.get("limit", 4)]
    assert document["sigma"][1]["mass"] == pytest.approx(math.hypot(0.01, new.get("u", 0.02)))


def test_an_uncertainty_that_leaves_the_mass_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = [str(tmp_path / f"{k}.toml") for k in (1, 2)]
    for k, file in enumerate(files):
        part = "[[part]]\nname = 'a'\nmass = 1\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\ncenter_of_mass = [0, 0, 0]"
        Path(file).write_text(f"{part}\ncenter_of_mass_uncertainty = {k}\n", encoding="utf-8")
    assert main(["budget", "--diff", *files]) == 0
    assert capsys.readouterr().out.endswith("  its uncertainty\n")


def test_an_uncertainty_that_stays_is_not_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sample, file = path("assemblies/cubesat.toml"), tmp_path / "heavier.toml"
    file.write_text(sample.read_text().replace('mass = "0.038±0.002"', 'mass = "0.045±0.002"'))
    assert main(["budget", "--diff", str(sample), str(file)]) == 0
    assert re.search(r"(?m)^solar panel  changed .*e-05$", capsys.readouterr().out)


@pytest.mark.parametrize(
    ("more", "limit", "code", "says", "pair"),
    [
        ("position_uncertainty = 5", 'what = "center_of_mass.x"\nmax = 1.5', 4, "0.1 → 5 mm", [1e-4, 5e-3]),
        ("angle_uncertainty = 90", 'what = "center_of_mass.x"\nmax = 1.5', 4, "0 → 90°", [0, math.pi / 2]),
    ],
)
def test_a_group_that_is_surer_of_its_place_is_a_part_that_changed(
    more: str, limit: str, code: int, says: str, pair: list[float], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its own line alone: the part below it is as it was, also where that changes by itself."""
    name = more.partition(" ")[0]
    group = '[[part]]\nname = "g"\nquantity = 2\n{}\n' + _PART.format(
        name="x", mass="1±0.01", more='parent = "g"\nat = [1, 2, {}]'
    )
    before = {"position_uncertainty": "position_uncertainty = 0.1"}.get(name, "")
    for file, (own, z) in {"old": (before, 3), "new": (more, 3), "moved": (more, 4)}.items():
        (tmp_path / f"{file}.toml").write_text(f"{group.format(own, z)}[[limit]]\n{limit}\n", encoding="utf-8")
    files = [str(tmp_path / f"{file}.toml") for file in ("old", "new", "moved")]
    assert main(["budget", "--diff", *files[:2]]) == code
    (row,) = [line for line in capsys.readouterr().out.splitlines() if "changed" in line]
    assert row.split()[:4] == ["g", "changed", "2", "0"]
    assert says in row
    assert main(["budget", "--diff", *files[:2], "--json"]) == code
    (change,) = json.loads(capsys.readouterr().out)["changes"]
    assert change["part"] == "g"
    assert change[name] == pytest.approx(pair)
    assert main(["budget", "--diff", *files[1:], "--json"]) == code
    assert [change["part"] for change in json.loads(capsys.readouterr().out)["changes"]] == ["g/x"]


def test_what_parts_have_in_common_is_told_where_none_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = 'densities = {{alloy = "1000±100"}}\n' + "".join(
        f'[[part]]\nname = "{name}"\nshape = "box"\nsize = [100, 100, 100]\nat = [{x}, 0, 0]\n{{0}}\n'
        for name, x in (("a", 0), ("b", 200))
    )
    common, alone = tmp_path / "common.toml", tmp_path / "alone.toml"
    common.write_text(text.format('material = "alloy"'), encoding="utf-8")
    alone.write_text(text.format('density = "1000±100"'), encoding="utf-8")
    for files in ((common, alone), (alone, common)):
        assert main(["budget", "--diff", *map(str, files)]) == 0
        assert "No part changed by itself, but the uncertainty of the whole did: " in capsys.readouterr().out
    turned = 'part = [{{name = "g", angle_uncertainty = 1, at = [{}, 0, 0]}}, {{name = "x", parent = "g", mass = 1, '
    turned += 'shape = "point", at = [{}, 0, 0]}}]'
    for file, x in {"near": 0, "far": 50}.items():
        (tmp_path / f"{file}.toml").write_text(turned.format(x, 100 - x), encoding="utf-8")
    assert main(["budget", "--diff", *(str(tmp_path / f"{file}.toml") for file in ("near", "far"))]) == 0
    assert "groups turn about other places" in capsys.readouterr().out
    assert main(["budget", "--diff", str(common), str(common)]) == 0
    assert capsys.readouterr().out.endswith("No part changed.\n")


def test_limits_are_compared_with_those_that_they_equal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, most in {"old": (1.5, 2.5, 7), "new": (2.5, 9, 1.5, 8)}.items():
        limits = "".join(f'[[limit]]\nwhat = "mass"\nmax = {k}\n' for k in most)
        (tmp_path / f"{name}.toml").write_text(_PART.format(name="a", mass=1, more="") + limits, encoding="utf-8")
    assert main(["budget", "--diff", str(tmp_path / "old.toml"), str(tmp_path / "new.toml"), "--json"]) == 0
    pairs = json.loads(capsys.readouterr().out)["limits"]
    of = [tuple(limit and limit["limit"][1] for limit in pair) for pair in pairs]
    assert of == [(1.5, 1.5), (2.5, 2.5), (7, 9), (None, 8)]


def test_a_limit_of_one_file_alone_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = Path(_changed(tmp_path))
    new = tmp_path / "new.toml"
    new.write_text(old.read_text(encoding="utf-8").partition("[[limit]]")[0], encoding="utf-8")
    assert main(["budget", "--diff", str(old), str(new)]) == 0
    assert "New limit         none\n" in capsys.readouterr().out


def test_a_part_beside_one_of_its_name_in_a_nested_file_is_compared_by_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part = '[[part]]\nname = "m"\nshape = "point"\nmass = 1\n'
    (tmp_path / "inner.toml").write_text(part)
    (tmp_path / "old.toml").write_text(f'[[part]]\nname = "x"\nassembly = "inner.toml"\n{part}parent = "x"\n')
    (tmp_path / "new.toml").write_text(f'[[part]]\nname = "x"\n{part}parent = "x"\n')
    assert main(["budget", "--diff", str(tmp_path / "old.toml"), str(tmp_path / "new.toml"), "--json"]) == 0
    (change,) = json.loads(capsys.readouterr().out)["changes"]
    assert (change["part"], change["kind"], change["effect"]["mass"]) == ("x/m (2)", "removed", -1.0)


def test_a_bill_of_materials_is_the_same_as_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bill.csv").write_text(
        "# rev 2, of 2026-11-20\nName;Quantity;Mass;Shape;Size;At;Material;\n"
        "battery;2;0.35±0.01;box;[80, 60, 30];[5,0,0];\n"
        '"plate";;;box;[10, 20, 30.5];"[0, ""1/3"", 2]";aluminium;\n\n',
        encoding="utf-8",
    )
    (tmp_path / "bill.toml").write_text(
        '[[part]]\nname = "battery"\nquantity = 2\nmass = "0.35±0.01"\nshape = "box"\nsize = [80, 60, 30]\n'
        "at = [5, 0, 0]\n"
        '[[part]]\nname = "plate"\nshape = "box"\nsize = [10, 20, 30.5]\nat = [0, "1/3", 2]\nmaterial = "aluminium"\n',
        encoding="utf-8",
    )
    documents = []
    for name in ("bill.csv", "bill.toml"):
        assert main(["budget", str(tmp_path / name), "--json"]) == 0
        documents.append(json.loads(capsys.readouterr().out))
    assert documents[0] == documents[1]


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("part,mass\nx,1\n", 3, "its first line names no column `name`"),
        ("name,mass\nx,1,2\n", 3, "line 2 has 3 cells, and the first line 2 names"),
        ("name,mass,Name\nx,1,y\n", 3, "its first line names the column `name` twice"),
        ("#,name,mass\n1,x,1\n", 2, "part[0].# is unknown"),
        ("name,,mass\nx,2,1\n", 3, "line 2 has '2' in a column that the first line does not name"),
        ("name,mas\nx,1\n", 2, "part[0].mas is unknown: did you mean mass?"),
        ("name,mass\nx,one\n", 2, "part[0].mass is no number"),
    ],
)
def test_a_bill_that_is_none_is_refused(
    text: str, code: int, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bill.csv").write_text(text, encoding="utf-8")
    assert main(["budget", str(tmp_path / "bill.csv")]) == code
    assert says in capsys.readouterr().err


def test_a_part_of_a_bill_may_have_a_name_that_begins_with_a_number_sign(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bill.csv").write_text("# screws\nname,mass\n#10-32 screw,0.004\nplate,1\n", encoding="utf-8")
    assert main(["budget", str(tmp_path / "bill.csv"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["total"]["mass"] == pytest.approx(1.004)


def test_an_assembly_tumbles_and_is_the_body_of_a_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tumble", FAN, "--spin", "0,0.01,3", "--for", "2", "--json"]) == 0
    tumbled = json.loads(capsys.readouterr().out)
    scene = f"[body]\npart = '{FAN}'\n[start]\nangular_velocity = [0, 0.01, 3]\n[run]\nduration = 2\n"
    (tmp_path / "scene.toml").write_text(scene, encoding="utf-8")
    assert main(["simulate", str(tmp_path / "scene.toml"), "--json"]) == 0
    simulated = json.loads(capsys.readouterr().out)
    assert simulated["attitude"] == tumbled["attitude"]
    (tmp_path / "scene.toml").write_text(scene.replace("[start]", "density = 7850\n[start]"), encoding="utf-8")
    assert main(["simulate", str(tmp_path / "scene.toml")]) == 2
    assert "body.density goes with a mesh" in capsys.readouterr().err


def test_the_report_is_one_page_that_asks_nobody(tmp_path: Path) -> None:
    text = Path(FAN).read_text(encoding="utf-8").replace('name = "motor"', 'name = "<b>motor</b>"')
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    assert main(["budget", str(tmp_path / "a.toml"), "--report", str(tmp_path / "a.html")]) == 0
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert '<p class="verdict pass">PASS</p>' in page
    assert "http" not in page
    assert "<b>motor" not in page
    assert page.count("<details") == 2  # the whole, and the impeller
    limits = re.findall(r'<tr><th scope="row">(\S+)</th><td class="left">(.*?)</td>', page)
    assert limits == [("mass", "kg"), ("center_of_mass.x", "mm"), ("inertia.zz", "kg m²")]
    assert page.count("<svg") == 3 + 3 + 2  # limits, variances, views of the centre of mass
    assert main(["budget", str(tmp_path / "a.toml"), "--report", str(tmp_path / "a.html")]) == 2
    assert main(["budget", str(tmp_path / "a.toml"), "--report", str(tmp_path / "a.pdf")]) == 2


def test_the_tensor_of_one_point_is_zero_and_its_bound_no_infinity(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limit = '[[limit]]\nwhat = "inertia.xx"\nmax = 1e-9\n'
    (tmp_path / "ball.toml").write_text('[[part]]\nname = "ball"\nshape = "point"\nmass = 1\n' + limit)
    assert main(["budget", str(tmp_path / "ball.toml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["total"]["bound"]["inertia"] is None
    assert main(["assembly", str(tmp_path / "ball.toml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["error"]["inertia"] is None
    assert main(["assembly", str(tmp_path / "ball.toml")]) == 0
    assert "tensor zero, centre" in capsys.readouterr().out


def test_a_column_of_text_holds_part_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bill.csv").write_text("name,parent,shape,mass\n10,,,\n2024-01-01,10,point,1\n1e5,10,point,2\n")
    assert main(["budget", str(tmp_path / "bill.csv"), "--json"]) == 0
    (group,) = json.loads(capsys.readouterr().out)["parts"]
    assert (group["name"], [part["name"] for part in group["parts"]]) == ("10", ["2024-01-01", "1e5"])


def test_an_assembly_that_is_a_link_to_itself_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "loop.toml").symlink_to("loop.toml")
    (tmp_path / "outer.toml").write_text('[[part]]\nname = "x"\nassembly = "loop.toml"\n')
    assert main(["budget", str(tmp_path / "outer.toml")]) == 3
    assert "outer.toml: part[0]: cannot read" in capsys.readouterr().err


def test_rounding_is_no_uncertainty(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "ring.toml"
    file.write_text(
        'part = [{name = "hub", shape = "box", size = [10, 20, 30], material = "steel"}, {name = "pin", '
        'shape = "cylinder", size = [2, 10], density = "7850±40", at = [20, 0, 0], around = {count = 3, axis = "z"}}]'
    )
    assert main(["budget", str(file)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "Centre of mass    0, 0, 0 mm" in lines
    assert [line.split()[1:4].count("0") for line in lines if line.lstrip().startswith("±")] == [2, 2, 2]
    assert lines[-1].split()[-7:] == ["100.0", "0.0", "0.0", "0.0", "100.0", "100.0", "100.0"]


def test_what_a_file_does_not_take_is_said_in_its_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assembly", FAN, "--to-toml"]) == 2
    assert "--to-toml, --joint and --unit are for files that carry a tree" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["assembly", str(path("robots/arm.urdf")), "--joint", "shoulder=x"])
    assert "'x' is no number;" in capsys.readouterr().err
