"""Links of a URDF file as its specification has them."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from inertia.errors import ReadError
from inertia.exchange.robots.links import Primitive
from inertia.exchange.robots.read import read_robot

ROBOT = """<?xml version="1.0"?>
<!-- a comment -->
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 -0.02 0.3" rpy="0 0 1.5707963267948966"/>
      <mass value="2.50"/>
      <inertia ixx="0.010" iyy="0.02" izz="0.025" ixy="0.001" ixz="-2e-3" iyz="0.003"/>
    </inertial>
    <visual><origin xyz="0 0 1"/>
      <geometry><mesh filename="package://arm/meshes/upper.stl" scale="0.001 0.001 0.001"/></geometry>
    </visual>
    <visual name="pin"><geometry><cylinder radius="0.01" length="0.2"/></geometry></visual>
    <collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>
  </link>
  <joint name="fix" type="fixed"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.5" rpy="0 0 0"/></joint>
</robot>
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "arm" / "urdf" / "arm.urdf"
    path.parent.mkdir(parents=True)
    mesh = tmp_path / "arm" / "meshes" / "upper.stl"
    mesh.parent.mkdir()
    mesh.write_bytes(b"")
    path.write_text(ROBOT)
    return path


def test_links(robot: Path) -> None:
    base, upper = read_robot(robot).links
    assert base.inertial is None
    inertial = upper.inertial
    assert inertial is not None
    assert inertial.mass == 2.5
    assert inertial.placement.origin.tolist() == [0.1, -0.02, 0.3]
    assert np.allclose(inertial.placement.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert inertial.inertia.tolist() == [[0.01, 0.001, -0.002], [0.001, 0.02, 0.003], [-0.002, 0.003, 0.025]]
    assert inertial.decimals == (2, 2, 3)
    assert upper.parent == "base"
    assert upper.placement.origin.tolist() == [0, 0, 0.5]


def test_geometries(robot: Path) -> None:
    mesh, pin, box = read_robot(robot).links[1].geometries
    assert mesh.shape == robot.parent.parent / "meshes" / "upper.stl"
    assert mesh.scale == (Fraction(1, 1000),) * 3
    assert mesh.placement.origin.tolist() == [0, 0, 1]
    assert pin.shape == Primitive("cylinder", (0.01, 0.2))
    assert (box.role, box.shape) == ("collision", Primitive("box", (0.1, 0.2, 0.3)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('value="2.50"', 'value="two"', "link 'upper', inertial, value is 'two': it must be numbers"),
        ('ixx="0.010"', 'ixx="nan"', "link 'upper', inertial, ixx is 'nan': it must be finite"),
        ('xyz="0.1 -0.02 0.3"', 'xyz="0.1 0.3"', "origin, xyz is '0.1 0.3': it must be 3 numbers"),
        ("package://", "http://", "is not a file"),
        ('<link name="base"/>', '<xacro:include filename="a"/>', "holds macros of xacro"),
        ("</robot>", "", "its XML is damaged"),
        ('<?xml version="1.0"?>', '<!DOCTYPE robot SYSTEM "x">', "document type"),
    ],
)
def test_faults(robot: Path, old: str, new: str, words: str) -> None:
    robot.write_text(ROBOT.replace(old, new))
    with pytest.raises(ReadError, match=f"cannot read {robot}") as fault:
        read_robot(robot)
    assert words in str(fault.value)


def test_unknown_shapes_say_so(robot: Path) -> None:
    robot.write_text(ROBOT.replace("<box ", "<cone "))
    assert read_robot(robot).links[1].geometries[2].shape == "'cone' is no shape that can be weighed"


def test_other_files_are_no_robot(tmp_path: Path) -> None:
    (tmp_path / "part.stl").write_text("solid x")
    with pytest.raises(ReadError, match="no robot of a known format"):
        read_robot(tmp_path / "part.stl")
    with pytest.raises(ReadError, match="No such file"):
        read_robot(tmp_path / "nothing.urdf")


def test_two_links_of_one_name_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text('<robot name="r"><link name="a"/><link name="a"/></robot>')
    with pytest.raises(ReadError, match="more than one link is called 'a'"):
        read_robot(file)
