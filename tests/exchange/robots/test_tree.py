"""Robots as assemblies at stated positions of their joints, against MuJoCo."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.assembly.test_samples import together

import inertia
from inertia.assembly.document import Assembly
from inertia.errors import GeometryError, UsageError
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
SEVERAL = MJCF.replace('<joint name="jb" type="slide" axis="0 3 4"/>', "<joint/><joint/>").replace(
    '<joint name="ja"',
    '<joint name="jd" type="slide" ref="0.2"/><joint name="jb" axis="0 3 4" pos="0.1 0 0" ref="0.4"/><joint name="ja"',
)


@pytest.mark.parametrize(("text", "suffix"), [(MJCF, "xml"), (ON_WORLD, "xml"), (SEVERAL, "xml"), (URDF, "urdf")])
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


SDF_INERTIAL = (
    "<inertial><pose>{0} 0.02 0.03 0.1 0.2 0.3</pose><mass>{1}</mass><inertia><ixx>0.002</ixx><iyy>0.003</iyy>"
    "<izz>0.0025</izz><ixy>0.0002</ixy><ixz>-0.0003</ixz><iyz>0.0001</iyz></inertia></inertial>"
)
SDF = f"""<sdf version="{{version}}"><model name="m"><pose>1 2 3 0.3 0.2 0.1</pose>
<link name="base"><pose>0 0 1 0 0 0.5</pose>{SDF_INERTIAL.format(0.01, 2.0)}</link>
<link name="a"><pose relative_to="ja">0.05 0 0.02 0 0.4 0</pose>{SDF_INERTIAL.format(0.1, 1.5)}</link>
<joint name="ja" type="revolute"><pose relative_to="base">0.2 0 0.1 0.3 -0.2 0.1</pose><parent>base</parent>
<child>on_a</child><axis><xyz>0.6 0 0.8</xyz>{{where}}</axis></joint>
<frame name="on_a" attached_to="a"><pose>7 8 9 1 2 3</pose></frame>
<model name="hand"><pose relative_to="a">0 0.3 0 0 0 1</pose>
<link name="b">{SDF_INERTIAL.format(0.05, 0.5)}</link></model>
<joint name="jb" type="prismatic"><parent>a</parent><child>hand::b</child>
<axis><xyz expressed_in="base">0 3 4</xyz></axis></joint>
<joint name="loop" type="revolute"><parent>base</parent><child>hand::b</child><axis><xyz>0 0 1</xyz></axis></joint>
<link name="loose"><pose>-1 0 0 0 0 0</pose>{SDF_INERTIAL.format(0.0, 0.25)}</link></model></sdf>
"""


def pose(x: float, y: float, z: float, *rpy: float) -> np.ndarray:
    place = np.eye(4)
    place[:3, :3], place[:3, 3] = Rotation.from_euler("xyz", rpy or (0, 0, 0)).as_matrix(), (x, y, z)
    return place


def turned(axis: list[float], angle: float) -> np.ndarray:
    place = np.eye(4)
    place[:3, :3] = Rotation.from_rotvec(angle * np.array(axis) / np.linalg.norm(axis)).as_matrix()
    return place


def whole(links: list[tuple[np.ndarray, float, np.ndarray]]) -> tuple[float, np.ndarray, np.ndarray]:
    """Return mass, centre and tensor of links: where the axes at the centre lie, mass, and tensor in them."""
    return together([(mass, place[:3, 3], place[:3, :3] @ own @ place[:3, :3].T) for place, mass, own in links])


@pytest.mark.parametrize(
    ("version", "where", "in_model"),
    [("1.9", "", False), ("1.6", "<use_parent_model_frame>1</use_parent_model_frame>", True), ("1.4", "", True)],
)
def test_the_whole_of_sdformat_is_that_of_poses_multiplied_out(
    version: str, where: str, in_model: bool, tmp_path: Path
) -> None:
    file = tmp_path / "robot.sdf"
    file.write_text(SDF.format(version=version, where=where), encoding="utf-8")
    table, notes = robot_tree(read_robot(file), {"ja": 0.7, "jb": -0.05})
    assert notes == ("joint 'loop' closes a loop: it is left out of the tree",)
    properties = Assembly.from_dict(table).mass_properties()
    model, base = pose(1, 2, 3, 0.3, 0.2, 0.1), pose(0, 0, 1, 0, 0, 0.5)
    at_joint, on_joint = pose(0.2, 0, 0.1, 0.3, -0.2, 0.1), pose(0.05, 0, 0.02, 0, 0.4, 0)
    axis = np.array([0.6, 0, 0.8])
    if in_model:
        axis = (base @ at_joint)[:3, :3].T @ axis
    a = model @ base @ at_joint @ turned(axis.tolist(), 0.7) @ on_joint
    rest = base @ at_joint @ on_joint @ pose(0, 0.3, 0, 0, 0, 1)  # of b, in the model, where the joints are at 0
    along = rest[:3, :3].T @ base[:3, :3] @ [0, 0.6, 0.8] * -0.05
    b = a @ pose(0, 0.3, 0, 0, 0, 1) @ pose(*along.tolist())
    own = np.array([[0.002, 0.0002, -0.0003], [0.0002, 0.003, 0.0001], [-0.0003, 0.0001, 0.0025]])
    inertials = [(model @ base, 0.01, 2.0), (a, 0.1, 1.5), (b, 0.05, 0.5), (model @ pose(-1, 0, 0), 0.0, 0.25)]
    mass, center, tensor = whole([(place @ pose(x, 0.02, 0.03, 0.1, 0.2, 0.3), m, own) for place, x, m in inertials])
    assert properties.mass == pytest.approx(mass, rel=1e-14)
    assert properties.center_of_mass == pytest.approx(center, abs=1e-12)
    assert properties.inertia == pytest.approx(tensor, abs=1e-12)


BODY = """def Xform "{name}" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {{
  double3 xformOp:translate = {at}
  double xformOp:rotateZ = {turn}
  double3 xformOp:scale = (2, 2, 2)
  uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ", "xformOp:scale"]
  point3f physics:centerOfMass = (0.5, 1, 1.5)
  float3 physics:diagonalInertia = (2, 3, 4)
  quatf physics:principalAxes = (1, 0, 0, 0)
  float physics:mass = {mass}
}}
"""
STAGE = (
    "#usda 1.0\n(metersPerUnit = 0.01\n kilogramsPerUnit = 1)\n"
    + BODY.format(name="base", at="(10, 20, 30)", turn="90", mass="2")
    + BODY.format(name="arm", at="(14, 20, 30)", turn="90", mass="1.5")
    + BODY.format(name="slider", at="(0, 0, 50)", turn="0", mass="0.5")
    + BODY.format(name="free", at="(0, -50, 0)", turn="0", mass="0.25")
    + """def PhysicsRevoluteJoint "hinge" {
  rel physics:body0 = </base>
  rel physics:body1 = </arm>
  point3f physics:localPos0 = (0, -1, 0)
  point3f physics:localPos1 = (0, 1, 0)
  quatf physics:localRot0 = (0.5, 0.5, 0.5, 0.5)
  quatf physics:localRot1 = (0.5, 0.5, 0.5, 0.5)
  uniform token physics:axis = "Y"
}
def PhysicsPrismaticJoint "rail" {
  rel physics:body0 = </slider>
  point3f physics:localPos0 = (0, 0, 3)
  point3f physics:localPos1 = (0, 0, 60)
  uniform token physics:axis = "Z"
}
def PhysicsFixedJoint "off" {
  rel physics:body0 = </base>
  rel physics:body1 = </free>
  bool physics:jointEnabled = false
}
"""
)


def test_the_whole_of_usd_is_that_of_frames_multiplied_out(tmp_path: Path) -> None:
    pytest.importorskip("pxr")
    file = tmp_path / "robot.usda"
    file.write_text(STAGE, encoding="utf-8")
    robot = read_robot(file)
    table, notes = robot_tree(robot, {"hinge": 0.4, "rail": 0.1})
    assert notes == (
        "joint 'rail' is not at 0 in the stage: its link stands where its position puts it, at 0 without one",
    )
    assert [(part["name"], part.get("parent")) for part in table["part"]] == [
        ("base", None), ("arm", "base"), ("slider", None), ("free", None),
    ]  # fmt: skip
    properties = Assembly.from_dict(table).mass_properties()
    base = pose(0.1, 0.2, 0.3, 0, 0, math.pi / 2)
    # The points of a body, its joints too, are scaled by 2: the hinge is 0.02 m from both origins. The half turns of
    # the quaternions take the axis y to z. What stands on the world at z = 0.6 hangs 0.06 m below it, less 0.1 m.
    arm = base @ pose(0, -0.02, 0) @ turned([0, 0, 1], 0.4) @ pose(0, -0.02, 0)
    slider = pose(0, 0, 0.6 - 0.06 - 0.1)
    own = 1e-4 * np.diag([2, 3, 4])
    places = [(base, 2.0), (arm, 1.5), (slider, 0.5), (pose(0, -0.5, 0), 0.25)]
    mass, center, tensor = whole([(place @ pose(0.01, 0.02, 0.03), m, own) for place, m in places])
    assert properties.mass == pytest.approx(mass, rel=1e-14)
    assert properties.center_of_mass == pytest.approx(center, abs=1e-8)  # positions are float32 in the file
    assert properties.inertia == pytest.approx(tensor, abs=1e-8)


UNSCALED = BODY.replace("(2, 2, 2)", "(1, 1, 1)")


def hinge(name: str, ends: tuple[str, str], places: tuple[str, str], says: str = "") -> str:
    """Return a joint about x between two bodies at points of theirs."""
    (a, b), (p, q) = ends, places
    return (
        f'def PhysicsRevoluteJoint "{name}" {{ uniform token physics:axis = "X"\n{says}\n'
        f"rel physics:body0 = </{a}>\nrel physics:body1 = </{b}>\n"
        f"point3f physics:localPos0 = {p}\npoint3f physics:localPos1 = {q}\n}}\n"
    )


def stage(tmp_path: Path, names: str, joints: str) -> Path:
    """Return bodies of 1 kg, each 1 m above the one before, and joints."""
    pytest.importorskip("pxr")
    bodies = (UNSCALED.format(name=name, at=(0, 0, k), turn=0, mass=1) for k, name in enumerate(names))
    (tmp_path / "robot.usda").write_text("#usda 1.0\n(metersPerUnit = 1)\n" + "".join(bodies) + joints)
    return tmp_path / "robot.usda"


@pytest.mark.parametrize("swapped", [(False, False), (False, True), (True, False), (True, True)])
def test_a_chain_of_usd_moves_alike_whichever_body_a_joint_has_first(
    tmp_path: Path, swapped: tuple[bool, bool]
) -> None:
    weld = 'def PhysicsFixedJoint "w" {\nrel physics:body1 = </a>\n}\n'
    ends = [("ab", ("(0, 0, 1)", "(0, 0, 0)")), ("bc", ("(0, 0, 1)", "(0, 0, 0)"))]
    joints = "".join(
        hinge(f"j{k}", tuple(pair)[::way], places[::way])
        for k, ((pair, places), way) in enumerate(zip(ends, [-1 if each else 1 for each in swapped], strict=True))
    )
    # Body 1 turns in body 0: the other way round by the opposite angle.
    angles = {f"j{k}": -angle if swapped[k] else angle for k, angle in enumerate((0.4, -0.7))}
    table, notes = robot_tree(read_robot(stage(tmp_path, "abc", weld + joints)), angles)
    assert notes == ()
    b = pose(0, 0, 1) @ turned([1, 0, 0], 0.4)
    places = [np.eye(4), b, b @ pose(0, 0, 1) @ turned([1, 0, 0], -0.7)]
    own = np.diag([2, 3, 4])
    _, center, tensor = whole([(place @ pose(0.5, 1, 1.5), 1.0, own) for place in places])
    properties = Assembly.from_dict(table).mass_properties()
    assert properties.center_of_mass == pytest.approx(center, abs=1e-12)
    assert properties.inertia == pytest.approx(tensor, abs=1e-12)


def test_of_a_loop_of_usd_the_joint_is_left_out_that_no_articulation_has(tmp_path: Path) -> None:
    excluded = "uniform bool physics:excludeFromArticulation = true"
    ends = [("j0", "ab", excluded), ("j1", "bc", ""), ("j2", "ca", "")]
    places = ("(0, 0, 0)", "(0, 0, 0)")
    joints = "".join(hinge(name, (pair[0], pair[1]), places, says) for name, pair, says in ends)
    robot = read_robot(stage(tmp_path, "abc", joints))
    assert [link.joint and link.joint.parent for link in robot.links] == [None, "c", "a"]
    assert "joint 'j0' closes a loop: it is left out of the tree" in robot.notes


def test_the_root_of_an_articulation_stands_still(tmp_path: Path) -> None:
    file = stage(tmp_path, "ab", hinge("j", ("a", "b"), ("(0, 0, 1)", "(0, 0, 0)")))
    file.write_text(
        file.read_text().replace(
            '"b" (prepend apiSchemas = [', '"b" (prepend apiSchemas = ["PhysicsArticulationRootAPI", '
        )
    )
    assert [link.joint and link.joint.parent for link in read_robot(file).links] == ["b", None]


def test_a_second_parent_in_sdformat_hangs_on_its_child(tmp_path: Path) -> None:
    """A link b, 1 kg at its origin, turns about that of its child, by the opposite angle, as Drake has it."""
    bare = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
    links = [
        f'<link name="{name}"><pose>{at} 0 0 0</pose>{bare}</link>'
        for name, at in zip("abc", ["0 0 0", "1 0 0", "0 1 0"], strict=True)
    ]
    joints = [
        f'<joint name="{a}{b}" type="revolute"><parent>{a}</parent><child>{b}</child><axis><xyz>0 0 1</xyz></axis>'
        "</joint>"
        for a, b in ("ac", "bc")
    ]
    file = tmp_path / "robot.sdf"
    file.write_text(f'<sdf version="1.9"><model name="m">{"".join(links + joints)}</model></sdf>')
    table, notes = robot_tree(read_robot(file), {"bc": 1.0})
    assert notes == ()
    b = pose(0, 1, 0) @ turned([0, 0, 1], -1.0) @ pose(1, -1, 0)
    _, center, tensor = whole([(place, 1.0, np.eye(3)) for place in (np.eye(4), pose(0, 1, 0), b)])
    properties = Assembly.from_dict(table).mass_properties()
    assert properties.center_of_mass == pytest.approx(center, abs=1e-12)
    assert properties.inertia == pytest.approx(tensor, abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            'link="base"/><child',
            'link="ghost"/><child',
            "joint 'ja' hangs link 'a' on 'ghost', which is not in the file: check its name",
        ),
        (
            'link="base"/><child',
            'link="b"/><child',
            "link 'a' hangs from itself, by the joints ja, jb: turn one of them round",
        ),
    ],
)
def test_a_tree_that_is_none_is_not_written(
    old: str, new: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robot.urdf").write_text(URDF.replace(old, new), encoding="utf-8")
    assert main(["assembly", str(tmp_path / "robot.urdf"), "--to-toml", str(tmp_path / "out.toml")]) == 3
    assert f"robot.urdf: {says}" in capsys.readouterr().err
    assert not (tmp_path / "out.toml").exists()


ROBOTS = {
    "r.urdf": '<robot name="r"><link name="a"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="2"/><inertia '
    'ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>',
    "r.xml": '<mujoco><worldbody><body name="a"><joint/><inertial pos="0.1 0.2 0.3" mass="2" '
    'diaginertia="0.02 0.03 0.04"/></body></worldbody></mujoco>',
    "r.sdf": '<sdf version="1.9"><model name="m"><link name="a"><inertial><pose>0.1 0.2 0.3 0 0 0</pose><mass>2</mass>'
    "<inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link></model></sdf>",
    "r.usda": '#usda 1.0\n(metersPerUnit = 1)\ndef Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI", '
    '"PhysicsMassAPI"]) {\nfloat physics:mass = 2\npoint3f physics:centerOfMass = (0.1, 0.2, 0.3)\n'
    "float3 physics:diagonalInertia = (0.02, 0.03, 0.04)\n}\n",
}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_stands_in_place_of_an_assembly_file_alone_and_nested(name: str, tmp_path: Path) -> None:
    """A body of 2 kg, and beside a point of 1 kg, 1 m of x apart and turned by a quarter turn, by Steiner's theorem."""
    if name.endswith("usda"):
        pytest.importorskip("pxr")
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / name).write_text(ROBOTS[name])
    alone = Assembly.load(tmp_path / "robots" / name).mass_properties()
    assert alone.mass == 2.0
    assert alone.center_of_mass == pytest.approx([0.1, 0.2, 0.3], rel=1e-7)  # of float32 in USD
    assert alone.inertia == pytest.approx(np.diag([0.02, 0.03, 0.04]), rel=1e-7)
    (tmp_path / "whole.toml").write_text(
        f'unit = "mm"\n[[part]]\nname = "robot"\nassembly = "robots/{name}"\nat = [1000, 0, 0]\n'
        'euler = [90]\nsequence = "z"\n[[part]]\nname = "point"\nshape = "point"\nmass = 1.0\n'
    )
    properties = Assembly.load(tmp_path / "whole.toml").mass_properties()
    center, own = np.array([0.8, 0.1, 0.3]), np.diag([0.03, 0.02, 0.04])
    assert properties.mass == 3.0
    assert properties.center_of_mass == pytest.approx(2 / 3 * center, rel=1e-7)
    assert properties.inertia == pytest.approx(own + point_inertia(2 / 3, center), rel=1e-6)


def test_what_a_nested_robot_leaves_out_is_not_in_the_total(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    geoms = '<geom type="box" size="1 1 1" mass="2"/><geom name="bad" type="cone" size="1"/>'
    (tmp_path / "r.xml").write_text(f'<mujoco><worldbody><body name="a"><joint/>{geoms}</body></worldbody></mujoco>')
    (tmp_path / "whole.toml").write_text('[[part]]\nname = "robot"\nassembly = "r.xml"\n')
    for file in ("r.xml", "whole.toml"):
        assert main(["assembly", str(tmp_path / file)]) == 4
        said = capsys.readouterr()
        assert f"{file}: the total is not that of the whole: link a, bad is left out: body 'a'" in said.err
        assert "2 kg" in said.out


def test_a_link_that_no_body_can_be_is_said_with_its_file(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROBOTS["r.urdf"].replace('value="2"', 'value="-2"'))
    (tmp_path / "whole.toml").write_text('[[part]]\nname = "robot"\nassembly = "r.urdf"\n')
    for file, where in (("r.urdf", "r.urdf"), ("whole.toml", r"whole.toml: part\[0\]: .*r.urdf")):
        with pytest.raises(GeometryError, match=rf"{where}: link a: its mass is -2 kg"):
            Assembly.load(tmp_path / file).mass_properties()


def test_a_unit_or_joints_where_there_are_none_are_refused(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROBOTS["r.urdf"])
    with pytest.raises(UsageError, match=r"r\.urdf is a robot, whose lengths are in metres: it takes no unit"):
        Assembly.carried_by(tmp_path / "r.urdf", "mm")
    with pytest.raises(UsageError, match=r"cube\.stl is no robot, and has no joints"):
        Assembly.carried_by(tmp_path / "cube.stl", joints={"a": 1.0})


def test_joints_that_are_not_there_or_do_not_move_are_refused(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_text(URDF, encoding="utf-8")
    robot = read_robot(tmp_path / "robot.urdf")
    with pytest.raises(UsageError, match="joint 'jc' is none of the robot's: name one of ja, jb"):
        robot_tree(robot, {"jc": 1.0})
    arm = read_robot(path("robots/arm.urdf"))
    (tmp_path / "several.xml").write_text(SEVERAL)
    with pytest.raises(UsageError, match="joint 'jc' is none of the robot's: name one of jd, jb, ja, b, b 2"):
        robot_tree(read_robot(tmp_path / "several.xml"), {"jc": 1.0})
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


@pytest.mark.parametrize(
    ("inertial", "own", "masses"),
    [
        ("", "", (6000, 500 * np.pi)),
        ("<density>100</density>", "", (600, 50 * np.pi)),
        ("<density>100</density>", "<density>50</density>", (600, 25 * np.pi)),
        ("<mass>3</mass>", None, (3, 0)),
    ],
)
def test_links_of_automatic_inertia_weigh_by_their_collisions(
    tmp_path: Path, inertial: str, own: str | None, masses: tuple[float, float]
) -> None:
    rod = (
        f"<pose>0 3 0 0 0 0</pose>{own}<geometry><cylinder><radius>0.5</radius><length>2</length></cylinder></geometry>"
    )
    second = "" if own is None else f'<collision name="c">{rod}</collision>'
    file = tmp_path / "a.sdf"
    file.write_text(
        f'<sdf version="1.11"><model name="m"><link name="a"><inertial auto="true">{inertial}</inertial>'
        '<visual name="v"><geometry><box><size>9 9 9</size></box></geometry></visual><collision name="c">'
        f"<geometry><box><size>1 2 3</size></box></geometry></collision>{second}</link></model></sdf>"
    )
    whole = Assembly.from_dict(robot_tree(read_robot(file))[0]).mass_properties()
    box, rod_mass = masses
    total = box + rod_mass
    center = 3 * rod_mass / total
    xx = box * (13 / 12 + center**2) + rod_mass * (0.25 / 4 + 4 / 12 + (3 - center) ** 2)
    assert whole.mass == pytest.approx(total, rel=1e-14)
    assert whole.center_of_mass == pytest.approx([0, center, 0], abs=1e-14)
    assert whole.inertia[0, 0] == pytest.approx(xx, rel=1e-13)


def test_links_of_sdformat_without_an_inertial_are_said_to_weigh_elsewhere(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    file.write_text('<sdf version="1.9"><model name="m"><link name="a"/></model></sdf>')
    _, notes = robot_tree(read_robot(file))
    assert notes == (
        "link a states no mass: it is a group, where programs take 1 kg and 1 kg m² for it; give it a file or a mass",
    )


@pytest.mark.parametrize(("stated", "second"), [({}, 0.3), ({"j": 0.5}, 2 * 0.5 + 0.3), ({"j": 0.5, "k": 0.1}, 0.1)])
def test_a_joint_that_mimics_another_follows_it(tmp_path: Path, stated: dict[str, float], second: float) -> None:
    file = tmp_path / "a.urdf"
    file.write_text(
        '<robot name="r"><link name="a"/><link name="b"/><link name="c"/><joint name="j" type="revolute">'
        '<parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint><joint name="k" type="revolute">'
        '<parent link="b"/><child link="c"/><axis xyz="0 0 1"/><mimic joint="j" multiplier="2" offset="0.3"/></joint>'
        "</robot>"
    )
    tree, _ = robot_tree(read_robot(file), stated)
    cosine, sine = math.cos(second), math.sin(second)
    assert np.allclose(tree["part"][2]["matrix"], [[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]], atol=1e-15)


def test_joints_of_urdf_without_an_end_and_meshes_of_broken_addresses_are_said(tmp_path: Path) -> None:
    file = tmp_path / "a.urdf"
    mesh = '<visual><geometry><mesh filename="file://[x"/></geometry></visual>'
    file.write_text(f'<robot name="r"><link name="a">{mesh}</link><joint name="j"><child link="a"/></joint></robot>')
    robot = read_robot(file)
    assert robot.notes == ("joint 'j' has no parent: it is left out",)
    assert robot.links[0].geometries[0].shape == "the mesh 'file://[x' is not a file: write file:///path"


@pytest.mark.parametrize(
    ("moments", "sound"),
    [
        ("0.0033 0.0033 0.0067", True),  # of a square plate, rounded: each may be off by half of the last digit
        ("0.00330 0.00330 0.0067", False),  # a digit more, which the plate has not
        ("0.0001 0.0001 0.0003", False),  # what rounding leaves open here is more than 1 %
        ("-0.0001 0.0033 0.0033", False),
    ],
)
def test_a_triangle_rule_broken_by_rounding_counts_as_audit_has_it(
    tmp_path: Path, moments: str, sound: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "r.urdf"
    xx, yy, zz = moments.split()
    file.write_text(
        '<robot name="r"><link name="a"><inertial><mass value="1"/><inertia '
        f'ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    assert ("unphysical" not in {finding.code for finding in inertia.audit(file).links[0].findings}) == sound
    assert main(["assembly", str(file), "--to-toml", str(tmp_path / "r.toml")]) == (0 if sound else 4)
    said = capsys.readouterr().err
    if not sound:
        assert "link a: the principal moments" in said
        return
    assert "rounding to its last decimal explains that" in said
    for whole in (file, tmp_path / "r.toml"):
        properties = Assembly.load(whole).mass_properties()
        assert properties.inertia.diagonal().tolist() == [float(k) for k in moments.split()]
        # The tensor as stated may be off by half a unit in each element.
        assert 1.5e-4 / math.hypot(0.0033, 0.0033, 0.0067) <= properties.error.inertia < 0.02


def test_a_lamina_of_single_precision_counts(tmp_path: Path) -> None:
    """0.3 as float32 is above the sum of 0.1 and 0.2 as float32, by 1e-8."""
    pytest.importorskip("pxr")
    file = tmp_path / "r.usda"
    file.write_text(ROBOTS["r.usda"].replace("(0.02, 0.03, 0.04)", "(0.1, 0.2, 0.3)"))
    assert Assembly.load(file).mass_properties().inertia.diagonal() == pytest.approx([0.1, 0.2, 0.3], rel=1e-7)
    assert inertia.audit(file).links[0].state != "unphysical"


@pytest.mark.parametrize(("scale", "unit"), [("0.001 0.001 0.001", "mm"), ("1 1 1", "m")])
def test_a_mesh_that_cannot_be_weighed_says_so_in_the_unit_of_its_scale(tmp_path: Path, scale: str, unit: str) -> None:
    """A tetrahedron of 1/6 inside out."""
    (tmp_path / "in.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n")
    file = tmp_path / "r.xml"
    mesh = f'<asset><mesh name="m" file="in.obj" scale="{scale}" inertia="exact"/></asset>'
    file.write_text(f'<mujoco>{mesh}<worldbody><body><geom type="mesh" mesh="m"/></body></worldbody></mujoco>')
    with pytest.raises(inertia.GeometryError, match=f"the volume is -0.1667 {unit}³ around"):
        Assembly.load(file).mass_properties()
