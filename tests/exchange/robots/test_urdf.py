"""Links of a URDF file as its specification has them."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from inertia.errors import ReadError
from inertia.exchange.robots.links import Figures, Primitive
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
    assert inertial.figures == (Figures(2, 1), Figures(3, 2))
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
        ('xyz="0 0 0.5"', 'xyz="zero"', "joint 'fix', origin, xyz is 'zero': it must be numbers"),
        ('mass value="2.50"', 'mass value="${m}"', "holds macros of xacro"),
        ('<link name="base"/>', '<xacro:include filename="a"/>', "holds macros of xacro"),
        ("</robot>", "", "its XML is damaged"),
        ('<?xml version="1.0"?>', '<!-- first --><?xml version="1.0"?>', "stands before its XML declaration"),
        ("</robot>", "</robot> text", "its XML is damaged"),
        ('<mass value="2.50"/>', '<mass value="2.50" value="3"/>', "duplicate attribute"),
    ],
)
def test_faults(robot: Path, old: str, new: str, words: str) -> None:
    robot.write_text(ROBOT.replace(old, new))
    with pytest.raises(ReadError, match=f"cannot read {robot}") as fault:
        read_robot(robot)
    assert words in str(fault.value)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("</robot>", "</robot>\0"),
        ("</robot>", "</robot>\n<robot/>"),
        ("a comment", "a -- comment \x01"),
        ('name="pin"', 'name="p&n <1>"'),
        ('name="pin"', 'name="p\udce9"'),  # Latin-1
        ("</robot>", "<gazebo:reference of:x='1'/></robot>"),
        ('<?xml version="1.0"?>', '<?xml version="1.0" encoding="utf-16"?>'),
        ('<?xml version="1.0"?>', '<?xml version="1.0"?><?xml version="1.0"?>'),
    ],
)
def test_text_that_is_no_xml_is_read_where_the_parser_of_most_programs_reads_it(
    robot: Path, old: str, new: str
) -> None:
    """Tried with urdfdom 6.0, Bullet 3.2.7, MuJoCo 4.0 and Drake 1.51: all four read each of these."""
    sound = read_robot(robot)
    robot.write_bytes(ROBOT.replace(old, new).encode(errors="surrogateescape"))
    read = read_robot(robot)
    assert len(read.notes) == 1
    assert not sound.notes
    assert [link.name for link in read.links] == [link.name for link in sound.links]
    stated, before = read.links[1].inertial, sound.links[1].inertial
    assert stated is not None
    assert before is not None
    assert np.array_equal(stated.inertia, before.inertia)
    assert len(read.links[1].geometries) == 3


def test_a_document_type_without_contents_needs_no_note(robot: Path) -> None:
    robot.write_text(ROBOT.replace('<?xml version="1.0"?>', '<?xml version="1.0"?><!DOCTYPE robot SYSTEM "x">'))
    assert read_robot(robot).notes == ()


def test_a_byte_order_mark_and_utf_16(robot: Path) -> None:
    robot.write_bytes(ROBOT.encode("utf-8-sig"))
    assert read_robot(robot).notes == ()
    robot.write_bytes(ROBOT.encode("utf-16"))
    with pytest.raises(ReadError, match="text in UTF-16, which no program for robots reads: save it as UTF-8"):
        read_robot(robot)


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ('rpy="0 0 1.5707963267948966"', 'rpy="0 0 1.5707963267948966 9"', "read as 0 0 1.5708, as Bullet does"),
        ('xyz="0.1 -0.02 0.3"', 'xyz="0.1, -0.02, 0.3"', "inertial, origin, xyz is '0.1, -0.02, 0.3': read as 0.1"),
        ('value="2.50"', 'value="2.50kg"', "inertial, value is '2.50kg': read as 2.5"),
        ('ixx="0.010"', 'ixx="0.010f"', "ixx is '0.010f': read as 0.01"),
        ('scale="0.001 0.001 0.001"', 'scale="0.001"', "visual 1, scale is '0.001': read as 0.001 0.001 0.001"),
        ('scale="0.001 0.001 0.001"', 'scale="0.001 0.001 0.001 1"', "read as 0.001 0.001 0.001"),
        ('xyz="0 0 0.5" rpy="0 0 0"', 'xyz="0 0 0.5" rpy="0"', "joint 'fix', origin, rpy is '0': read as 0 0 0"),
    ],
)
def test_slips_are_read_as_bullet_reads_them(robot: Path, old: str, new: str, note: str) -> None:
    sound = read_robot(robot).links[1]
    robot.write_text(ROBOT.replace(old, new))
    read = read_robot(robot)
    assert len(read.notes) == 1
    assert note in read.notes[0]
    link = read.links[1]
    assert link.inertial is not None
    assert sound.inertial is not None
    assert link.inertial.mass == sound.inertial.mass
    assert np.array_equal(link.inertial.inertia, sound.inertial.inertia)
    assert np.array_equal(link.inertial.placement.origin, sound.inertial.placement.origin)
    assert np.array_equal(link.inertial.placement.rotation, sound.inertial.placement.rotation)
    assert link.geometries[0].scale == sound.geometries[0].scale


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('value="2.50"', 'value="two"', "link 'upper', inertial, value is 'two': it must be numbers"),
        ('ixx="0.010"', 'ixx="nan"', "link 'upper', inertial, ixx is 'nan': it must be finite"),
        ('<mass value="2.50"/>', "<mass>2.50</mass>", "link 'upper', inertial has no mass: state one"),
    ],
)
def test_what_no_program_reads_is_a_fault_of_the_link(robot: Path, old: str, new: str, words: str) -> None:
    robot.write_text(ROBOT.replace(old, new))
    base, upper = read_robot(robot).links
    assert (base.fault, upper.inertial, upper.fault) == ("", None, words)


def test_shapes_that_cannot_be_read_say_so(robot: Path) -> None:
    robot.write_text(ROBOT.replace("package://", "http://").replace('size="0.1 0.2 0.3"', 'size="0.1"'))
    mesh, pin, box = read_robot(robot).links[1].geometries
    assert "is not a file" in str(mesh.shape)
    assert pin.name == "pin"
    assert "size is '0.1': it must be 3 numbers" in str(box.shape)


def test_macros_in_comments_and_extensions_are_none_of_the_links(robot: Path) -> None:
    robot.write_text(
        ROBOT.replace("a comment", "from $(find arm)/arm.xacro <xacro:macro>").replace(
            "</robot>", "<gazebo><plugin>${prefix}</plugin></gazebo></robot>"
        )
    )
    assert len(read_robot(robot).links) == 2


def test_a_package_above_the_folder_one_stands_in(robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(robot.parent)
    shape = read_robot(robot.name).links[1].geometries[0].shape
    assert isinstance(shape, Path)
    assert shape.is_file()


def test_unknown_shapes_say_so(robot: Path) -> None:
    robot.write_text(ROBOT.replace("<box ", "<cone "))
    assert read_robot(robot).links[1].geometries[2].shape == "'cone' is no shape that can be weighed"


def test_other_files_are_no_robot(tmp_path: Path) -> None:
    (tmp_path / "part.stl").write_text("solid x")
    with pytest.raises(ReadError, match="no robot of a known format"):
        read_robot(tmp_path / "part.stl")
    with pytest.raises(ReadError, match="there is no such file"):
        read_robot(tmp_path / "nothing.urdf")


def test_two_links_of_one_name_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text('<robot name="r"><link name="a"/><link name="a"/></robot>')
    with pytest.raises(ReadError, match="more than one link is called 'a'"):
        read_robot(file)


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ('<mass value="2.50"/>', '<mass value="2.50"/><mass value="3"/>', "'upper', inertial has more than one <mass>"),
        ("</inertial>", '</inertial><inertial><mass value="9"/></inertial>', "inertial has more than one <inertial>"),
        ('<inertia ixx="0.010"', '<origin xyz="9 9 9"/><inertia ixx="0.010"', "inertial has more than one <origin>"),
        ('<box size="0.1 0.2 0.3"/>', '<box size="0.1 0.2 0.3"/><sphere radius="1"/>', "2 shapes in one <geometry>"),
        ('<link name="base"/>', '<link name="base"/><link/>', "1 link without a name was left out"),
        (
            '<parent link="base"/>',
            '<parent link="bass"/>',
            "joint 'fix' names the link 'bass', which is not in the",
        ),
        (
            "</robot>",
            '<joint name="k" type="fixed"><parent link="base"/><child link="upper"/></joint></robot>',
            "link 'upper' hangs from two joints, 'fix' and 'k': the last counts",
        ),
    ],
)
def test_what_is_there_twice_or_not_at_all_is_noted(robot: Path, old: str, new: str, note: str) -> None:
    robot.write_text(ROBOT.replace(old, new))
    read = read_robot(robot)
    assert len(read.notes) == 1
    assert note in read.notes[0]
    link = read.links[1]
    assert link.inertial is not None
    assert (link.inertial.mass, link.geometries[2].shape) == (2.5, Primitive("box", (0.1, 0.2, 0.3)))


def test_links_without_names_and_meshes_without_files_say_so(robot: Path) -> None:
    robot.write_text('<robot name="a"><link/></robot>')
    with pytest.raises(ReadError, match="it holds no link that has a name: name them"):
        read_robot(robot)
    robot.write_text(ROBOT.replace("package://arm/meshes/upper.stl", ""))
    assert "the mesh has no file name: name it by" in str(read_robot(robot).links[1].geometries[0].shape)


@pytest.fixture
def gripper(tmp_path: Path) -> Path:
    """A mesh of another package, in a folder that is not above the robot's, with the name of one of the robot's own."""
    mesh = tmp_path / "elsewhere" / "share" / "gripper" / "meshes" / "upper.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_bytes(b"")
    return mesh


def shape_of(robot: Path, package: str) -> object:
    robot.write_text(ROBOT.replace("package://arm/", f"package://{package}/"))
    return read_robot(robot).links[1].geometries[0].shape


def test_a_mesh_of_another_package_is_not_the_robot_s_own(robot: Path, gripper: Path) -> None:
    assert gripper.name == "upper.stl"
    (robot.parent.parent / "package.xml").write_text("<package><name>arm</name></package>")
    assert "there is no package 'gripper' above the file" in str(shape_of(robot, "gripper"))
    assert "there is no package ''" in str(shape_of(robot, ""))
    assert read_robot(robot).links[1].geometries[0].name == "upper.stl"


def test_a_package_that_nothing_is_called_is_taken_for_the_robot_s_own_with_a_note(robot: Path) -> None:
    assert shape_of(robot, "arm_description") == robot.parent.parent / "meshes" / "upper.stl"
    words = "no folder or package.xml is called 'arm_description': its files are taken from "
    assert read_robot(robot).notes == (words + str(robot.parent.parent),)
    robot.write_text(robot.read_text(encoding="utf-8").replace("upper.stl", "lower.stl"), encoding="utf-8")
    assert "there is no package 'arm_description'" in str(read_robot(robot).links[1].geometries[0].shape)


@pytest.mark.parametrize(
    ("variable", "up"),
    [("ROS_PACKAGE_PATH", 2), ("ROS_PACKAGE_PATH", 1), ("AMENT_PREFIX_PATH", 3), ("SDF_PATH", 2)],
)
def test_packages_lie_where_the_environment_says(
    robot: Path, gripper: Path, monkeypatch: pytest.MonkeyPatch, variable: str, up: int
) -> None:
    monkeypatch.setenv(variable, str(gripper.parents[up]))
    assert shape_of(robot, "gripper") == gripper


@pytest.mark.parametrize("reference", ["package:///", "model://arm/", "package://arm//", "package://empty/"])
def test_a_mesh_of_the_robot_s_own_is_found_however_it_is_named(robot: Path, reference: str) -> None:
    (robot.parent / "empty").mkdir()
    robot.write_text(ROBOT.replace("package://arm/", reference))
    assert read_robot(robot).links[1].geometries[0].shape == robot.parent.parent / "meshes" / "upper.stl"


def test_a_package_is_called_what_its_package_xml_says(robot: Path) -> None:
    """As in a folder that a repository was cloned or unpacked into."""
    mesh = robot.parent.parent / "meshes" / "upper.stl"
    (robot.parent.parent / "package.xml").write_text("<package><name> arm_description </name></package>")
    assert shape_of(robot, "arm_description") == mesh
    (robot.parent.parent / "package.xml").write_text("<package><name>arm_desc")
    assert shape_of(robot, "arm_description") == mesh  # a name that cannot be read is no other name
    assert "is called 'arm_description'" in read_robot(robot).notes[0]


QUATERNION = 'quat_xyzw="0 0 1.4 1.4"'
RPY = 'rpy="0 0 1.5707963267948966"'


def test_quaternions_of_version_1_1_turn(robot: Path) -> None:
    """By hand: (0, 0, k, k) is a quarter turn about z, as those angles are, for links, joints and shapes."""
    robot.write_text(ROBOT.replace(RPY, QUATERNION).replace('name="arm"', 'name="arm" version="1.1"', 1))
    read = read_robot(robot)
    inertial = read.links[1].inertial
    assert read.notes == ()
    assert inertial is not None
    assert inertial.placement.rotation.tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    robot.write_text(robot.read_text().replace('rpy="0 0 0"', QUATERNION))
    assert read_robot(robot).links[1].placement.rotation.tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]


@pytest.mark.parametrize("version", ["", ' version="1.0"', ' version="one"'])
def test_before_version_1_1_there_are_no_quaternions(robot: Path, version: str) -> None:
    robot.write_text(ROBOT.replace(RPY, QUATERNION).replace('name="arm"', f'name="arm"{version}', 1))
    read = read_robot(robot)
    (note,) = read.notes
    assert "link 'upper', inertial, origin has 'quat_xyzw': passed over, as in urdfdom" in note
    assert read.links[1].inertial is not None
    assert np.array_equal(read.links[1].inertial.placement.rotation, np.eye(3))


@pytest.mark.parametrize(
    ("origin", "words"),
    [
        (f"{RPY} {QUATERNION}", "link 'upper', inertial, origin has both rpy and quat_xyzw"),
        ('quat_xyzw="0 0 0 0"', "origin, quat_xyzw is zero"),
        ('quat_xyzw="0 0 1"', "origin, quat_xyzw is '0 0 1': it must be 4 numbers"),
    ],
)
def test_quaternions_that_no_program_reads_are_a_fault_of_the_link(robot: Path, origin: str, words: str) -> None:
    robot.write_text(ROBOT.replace(RPY, origin).replace('name="arm"', 'name="arm" version="1.1"', 1))
    assert words in read_robot(robot).links[1].fault


def test_what_an_origin_has_besides_is_noted(robot: Path) -> None:
    robot.write_text(ROBOT.replace(RPY, f'{RPY} wxyz="1 0 0 0"'))
    assert read_robot(robot).notes == (
        "link 'upper', inertial, origin has 'wxyz', which URDF does not know: passed over",
    )
