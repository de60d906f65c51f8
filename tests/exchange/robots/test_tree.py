"""Robots as assemblies at stated positions of their joints, against MuJoCo."""

from pathlib import Path

import numpy as np
import pytest

import inertia
from inertia.assembly.document import Assembly
from inertia.errors import UsageError
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.tree import robot_tree
from inertia.mass.tensor import point_inertia
from inertia_cli.main import main
from inertia_meshes import path

INERTIAL = '<inertial pos="{0} 0.02 0.03" mass="{1}" fullinertia="0.002 0.003 0.0025 0.0002 -0.0003 0.0001"/>'
TURNED = '<inertial pos="{0} 0.02 0.03" quat="0.6 0 0.8 0" mass="{1}" diaginertia="0.002 0.003 0.0025"/>'
MJCF = f"""<mujoco model="m"><compiler angle="radian"/><worldbody>
<body name="base" pos="0.1 0.2 0.3"><freejoint/>{INERTIAL.format(0.01, 2.0)}
 <body name="a" pos="0.2 0 0.1" quat="0.8 0 0 0.6">
  <joint name="ja" axis="1 2 2" pos="0.01 -0.02 0.03"/>{TURNED.format(0.1, 1.5)}
  <body name="b" pos="0 0.3 0"><joint name="jb" type="slide" axis="0 3 4"/>{INERTIAL.format(0.05, 0.5)}
   <body name="c" pos="0.1 0 0" quat="0 1 0 0">{INERTIAL.format(0.0, 0.25)}</body></body></body></body>
</worldbody></mujoco>
"""
URDF_INERTIAL = (
    '<inertial><origin xyz="{0} 0.02 0.03" rpy="0.1 0.2 0.3"/><mass value="{1}"/>'
    '<inertia ixx="0.002" iyy="0.003" izz="0.0025" ixy="0.0002" ixz="-0.0003" iyz="0.0001"/></inertial>'
)
URDF = f"""<robot name="u"><link name="base">{URDF_INERTIAL.format(0.01, 2.0)}</link>
<link name="a">{URDF_INERTIAL.format(0.1, 1.5)}</link><link name="b">{URDF_INERTIAL.format(0.05, 0.5)}</link>
<joint name="ja" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0.2 0 0.1" rpy="0.3 -0.2 0.1"/>
<axis xyz="0.6 0 0.8"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="jb" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0 0.3 0"/>
<axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>
"""


ON_WORLD = MJCF.replace("<freejoint/>", '<joint name="ja" axis="0 1 0"/>').replace(
    'name="ja" axis="1', 'name="a" axis="1'
)
ON_WORLD = ON_WORLD.replace(
    "</worldbody>", f'<body name="d" pos="3 1 2">{INERTIAL.format(0.2, 0.7)}</body></worldbody>'
)


@pytest.mark.parametrize(("text", "suffix"), [(MJCF, "xml"), (ON_WORLD, "xml"), (URDF, "urdf")])
def test_the_whole_is_that_of_mujoco(text: str, suffix: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    file = tmp_path / f"robot.{suffix}"
    file.write_text(text, encoding="utf-8")
    positions = {"ja": 0.7, "jb": -0.05}
    table, notes = robot_tree(read_robot(file), positions)
    properties = Assembly.from_dict(table).mass_properties()

    model = mujoco.MjModel.from_xml_string(
        text.replace("<link", '<mujoco><compiler fusestatic="false"/></mujoco><link', 1)
    )
    data = mujoco.MjData(model)
    for name, value in positions.items():
        data.qpos[model.joint(name).qposadr[0]] = value
    mujoco.mj_kinematics(model, data)
    mass = model.body_mass.sum()
    center = model.body_mass @ data.xipos / mass
    tensor = np.zeros((3, 3))
    for k in range(model.nbody):
        axes = data.ximat[k].reshape(3, 3)
        tensor += axes @ np.diag(model.body_inertia[k]) @ axes.T + point_inertia(
            model.body_mass[k], data.xipos[k] - center
        )
    assert properties.mass == pytest.approx(mass, rel=1e-14)
    assert properties.center_of_mass == pytest.approx(center, abs=1e-12)
    assert properties.inertia == pytest.approx(tensor, abs=1e-12)
    assert notes == ()


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('link="base"/><child', 'link="ghost"/><child', "part[1].parent is 'ghost': there is no part of that name"),
        ('link="base"/><child', 'link="b"/><child', "part[1].parent is 'b', which hangs on this part itself"),
    ],
)
def test_a_tree_that_is_none_is_not_written(
    old: str, new: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robot.urdf").write_text(URDF.replace(old, new), encoding="utf-8")
    assert main(["assembly", str(tmp_path / "robot.urdf"), "--to-toml", str(tmp_path / "out.toml")]) == 2
    assert f"robot.urdf: {says}" in capsys.readouterr().err
    assert not (tmp_path / "out.toml").exists()


def test_joints_that_are_not_there_or_do_not_move_are_refused(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_text(URDF, encoding="utf-8")
    robot = read_robot(tmp_path / "robot.urdf")
    with pytest.raises(UsageError, match="joint 'jc' is none of the robot's: name one of ja, jb"):
        robot_tree(robot, {"jc": 1.0})
    arm = read_robot(path("robots/arm.urdf"))
    with pytest.raises(UsageError, match="joint 'forearm_drive' does not turn or slide"):
        robot_tree(arm, {"forearm_drive": 1.0})


def test_the_assembly_that_is_written_is_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "arm.toml"
    assert main(["assembly", str(path("robots/arm.urdf")), "--to-toml", str(out), "--joint", "hand_tool=0.5"]) == 0
    assert main(["assembly", str(out), "--json"]) == 0
    assert main(["assembly", str(path("robots/arm.urdf")), "--to-toml", str(out)]) == 2
    assert main(["assembly", str(out), "--joint", "hand_tool=0.5"]) == 2
    capsys.readouterr()


def test_the_regions_of_a_mesh_are_parts_to_fill_in(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "shaft_impeller.obj"
    file.write_bytes(path("shaft_impeller.obj").read_bytes())
    out = tmp_path / "whole.toml"
    assert main(["assembly", str(file), "--to-toml", str(out)]) == 0
    capsys.readouterr()
    text = out.read_text(encoding="utf-8")
    out.write_text(text.replace('"shaft_impeller.obj"', '"shaft_impeller.obj", density = 7850'), encoding="utf-8")
    whole = Assembly.load(out)
    assert [leaf.name for leaf in whole.root.leaves] == ["shaft", "impeller"]
    alone = inertia.mass_properties(inertia.read(file, unit="mm"), 7850.0)
    assert whole.mass_properties().inertia == pytest.approx(alone.inertia, rel=1e-12, abs=1e-18)
