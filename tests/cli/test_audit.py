"""`inertia audit` as a user meets it."""

import json
from pathlib import Path

import pytest

from inertia_cli.main import main
from inertia_meshes import path

ARM = str(path("robots/arm.urdf"))


def test_exit_codes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", ARM]) == 5
    frame = tmp_path / "frame.urdf"
    frame.write_text('<robot name="r"><link name="world"/></robot>')
    assert main(["audit", str(frame)]) == 4
    assert main(["audit", str(tmp_path / "nothing.urdf")]) == 3
    assert main(["audit", ARM, "--tolerance", "3"]) == 2
    capsys.readouterr()


def test_one_document_on_standard_output(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", ARM, "--json"]) == 5
    captured = capsys.readouterr()
    assert json.loads(captured.out)["schema"] == "inertia/audit/1"
    assert captured.err == ""


def test_fix_and_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("t_handle", "bent_wheel", "tetrahedron", "cone"):
        (tmp_path / f"{name}.stl").write_bytes(path(f"{name}.stl").read_bytes())
    robot = tmp_path / "robots" / "arm.urdf"
    robot.parent.mkdir()
    robot.write_bytes(Path(ARM).read_bytes())
    fixed, report = robot.with_name("fixed.urdf"), tmp_path / "audit.html"
    assert main(["audit", str(robot), "--fix", str(fixed), "--report", str(report)]) == 5
    assert report.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert main(["audit", str(fixed)]) == 0
    before, after = robot.read_text().splitlines(), fixed.read_text().splitlines()
    changed = [line for line in after if line not in before]
    assert all("<!-- mended: " in line or "<inertia " in line for line in changed)
    assert len(changed) == 8
    capsys.readouterr()
    assert main(["audit", str(robot), "--fix", str(fixed)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["audit", str(robot), "--lump", "--fix", str(fixed), "--force"]) == 2


def test_densities_are_taken(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", ARM, "--json", "--density", "2700", "--density", "cone.stl=1040"]) == 5
    links = {link["name"]: link for link in json.loads(capsys.readouterr().out)["links"]}
    assert links["base"]["state"] == "consistent"
    assert links["tool"]["difference"]["mass"] < 1e-5
    assert links["hand"]["state"] == "inconsistent"


@pytest.mark.parametrize("density", ["-1", "0", "nan", "inf", "-inf", "base.stl=-1"])
def test_a_density_that_is_none_is_refused(density: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", ARM, f"--density={density}"]) == 2
    captured = capsys.readouterr()
    assert "it must be positive and finite" in captured.err
    assert captured.out == ""


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        (
            "r.urdf",
            '<robot name="r"><link name="a">{}<visual><geometry><mesh filename="m.stl"/></geometry></visual></link>'
            "</robot>",
            "1 mesh file was not found from there: write it beside",
        ),
        ("r.xml", '<mujoco><worldbody><include file="more.xml"/></worldbody></mujoco>', "more.xml' is not there"),
    ],
)
def test_a_mended_file_in_another_folder_says_what_it_lacks(
    tmp_path: Path, name: str, text: str, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "m.stl").write_bytes(path("cone.stl").read_bytes())
    (tmp_path / "more.xml").write_text('<mujoco><body name="a"><joint/><geom size="1"/></body></mujoco>')
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    (tmp_path / name).write_text(text.format(inertial))
    (tmp_path / "other").mkdir()
    main(["audit", str(tmp_path / name), "--fix", str(tmp_path / f"beside_{name}")])
    assert capsys.readouterr().err == ""
    main(["audit", str(tmp_path / name), "--fix", str(tmp_path / "other" / name)])
    assert says in capsys.readouterr().err
