"""MJCF against what MuJoCo compiles: stated inertials, shapes and where they lie."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.exchange import solid

import inertia
from inertia.errors import ReadError
from inertia.exchange.robots.links import Figures, Geometry, Primitive, Robot
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.tree import robot_tree, unweighed
from inertia.exchange.rotations import rotation_of_quaternion

ORIENTATIONS = [
    "",
    'quat="0.5 -0.1 0.7 0.3"',
    'axisangle="1 -2 0.5 40"',
    'euler="20 -50 75"',
    'xyaxes="1 0.2 0 0.3 1 0.4"',
    'zaxis="0.3 -0.2 -0.9"',
]
MODEL = """
<mujoco model="arm">
  <compiler meshdir="meshes" inertiafromgeom="auto"/>
  <include file="defaults.xml"/>
  <asset>
    <mesh name="upper" file="upper arm.obj" scale="0.5 0.5 0.5" refpos="0.1 -0.2 0.3" refquat="0.5 -0.1 0.7 0.3"/>
    <mesh file="upper arm.obj" class="tall" refpos="0.1 0.2 -0.1" name="tall"/>
  </asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="base" pos="0.1 0.2 0.3" childclass="visual">
      <freejoint/>
      <inertial pos="0.01 -0.02 0.03" mass="1.25" fullinertia="0.02 0.03 0.025 0.001 -0.002 0.003"/>
      <geom mesh="upper" type="mesh" pos="0.3 0.1 -0.2" euler="10 20 30"/>
      <geom class="collision" type="capsule" fromto="0.1 0.2 0.3 -0.4 0.5 0.1" size="0.05"/>
      <frame pos="0.5 0 0" euler="0 0 90">
        <geom name="tall" mesh="tall" type="mesh"/>
        <geom class="collision" type="box" size="0.1 0.2 0.3" pos="0 0.3 0"/>
        <body name="hand" pos="0 0 0.4" axisangle="0 1 0 30">
          <inertial pos="0 0.1 0" quat="0.9 0.1 -0.2 0.3" mass="0.5" diaginertia="0.01 0.02 0.025"/>
          <geom class="collision" type="ellipsoid" size="0.1 0.2 0.3" euler="30 0 0"/>
          <geom type="cylinder" size="0.05 0.2"/>
          <body name="finger" pos="0 0 0.1">
            <joint axis="1 0 0"/>
            <geom size="0.02"/>
          </body>
        </body>
      </frame>
    </body>
  </worldbody>
</mujoco>
"""
DEFAULTS = """
<mujocoinclude>
  <default>
    <geom density="500"/>
    <default class="visual">
      <geom contype="0" conaffinity="0" group="2"/>
      <default class="collision"><geom contype="1" group="3"/></default>
    </default>
    <default class="tall"><mesh scale="0.2 0.4 0.9"/></default>
  </default>
</mujocoinclude>
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "meshes").mkdir()
    solid.file(tmp_path / "meshes")
    (tmp_path / "defaults.xml").write_text(DEFAULTS)
    model = tmp_path / "arm.xml"
    model.write_text(MODEL)
    return model


def compile_model(file: Path) -> Any:
    return pytest.importorskip("mujoco").MjModel.from_xml_path(str(file))


def extent(geometry: Geometry) -> np.ndarray:
    """Return the least and largest coordinates of a mesh in the axes of its body."""
    assert isinstance(geometry.shape, Path)
    assert geometry.scale is not None
    corners = inertia.read(geometry.shape, unit="m").triangles.corners().reshape(-1, 3)
    corners = corners * [float(k) for k in geometry.scale] @ geometry.placement.rotation.T + geometry.placement.origin
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def compare(robot: Robot, model: Any) -> None:
    for link in robot.links:
        body = model.body(link.name).id
        if link.inertial is not None:
            where = link.inertial.placement
            turn = rotation_of_quaternion(model.body_iquat[body].tolist())
            compiled = turn @ np.diag(model.body_inertia[body]) @ turn.T
            stated = where.rotation @ link.inertial.inertia @ where.rotation.T
            assert model.body_mass[body] == link.inertial.mass
            assert np.allclose(model.body_ipos[body], where.origin, rtol=1e-15, atol=0)
            assert np.linalg.norm(compiled - stated) < 1e-14 * np.linalg.norm(stated)
        numbers = [k for k in range(model.ngeom) if model.geom_bodyid[k] == body]
        assert len(numbers) == len(link.geometries)
        for k, geometry in zip(numbers, link.geometries, strict=True):
            turn, place = rotation_of_quaternion(model.geom_quat[k].tolist()), model.geom_pos[k]
            if isinstance(geometry.shape, Primitive):
                assert np.allclose(geometry.placement.origin, place, rtol=0, atol=1e-15)
                assert geometry.shape.kind == "sphere" or np.allclose(geometry.placement.rotation, turn, atol=1e-15)
                compare_sizes(geometry.shape, model.geom_size[k])
            else:
                mesh = model.geom_dataid[k]
                first = model.mesh_vertadr[mesh]
                vertices = model.mesh_vert[first : first + model.mesh_vertnum[mesh]] @ turn.T + place
                assert np.allclose([vertices.min(axis=0), vertices.max(axis=0)], extent(geometry), rtol=0, atol=3e-7)


def compare_sizes(shape: Primitive, size: np.ndarray) -> None:
    r, h = size[:2]
    expected = {"sphere": [r], "capsule": [r, 2 * h], "cylinder": [r, 2 * h], "box": 2 * size, "ellipsoid": size}
    assert shape.sizes == pytest.approx(list(expected[shape.kind]), rel=1e-15)


def test_a_model_with_everything_is_what_mujoco_makes_of_it(file: Path) -> None:
    robot = read_robot(file)
    assert [link.name for link in robot.links] == ["base", "hand", "finger"]
    compare(robot, compile_model(file))


def test_what_is_drawn_and_what_touches_are_told_apart(file: Path) -> None:
    base, hand, _ = read_robot(file).links
    assert [geometry.role for geometry in base.geometries] == ["visual", "collision", "visual", "collision"]
    assert [geometry.role for geometry in hand.geometries] == ["collision", "visual"]


def test_a_body_without_a_joint_hangs_from_its_parent(file: Path) -> None:
    base, hand, finger = read_robot(file).links
    assert (base.parent, hand.parent, finger.parent) == (None, "base", None)
    model = compile_model(file)
    body = model.body("hand").id
    assert np.allclose(hand.placement.origin, model.body_pos[body], atol=1e-15)
    assert np.allclose(hand.placement.rotation, rotation_of_quaternion(model.body_quat[body].tolist()), atol=1e-15)


def test_figures_are_those_written(file: Path) -> None:
    base, hand, _ = read_robot(file).links
    assert base.inertial is not None
    assert base.inertial.figures == (Figures(2, 1), Figures(3, 2))
    assert hand.inertial is not None
    assert hand.inertial.figures == (Figures(1, 1), Figures(3, 2))


@pytest.mark.parametrize("orientation", ORIENTATIONS)
@pytest.mark.parametrize("compiler", ['angle="degree"', 'angle="radian"', 'eulerseq="ZXy"', 'eulerseq="zyx"'])
def test_every_orientation_is_mujoco_s(tmp_path: Path, orientation: str, compiler: str) -> None:
    file = tmp_path / "turned.xml"
    file.write_text(
        f'<mujoco><compiler {compiler}/><worldbody><body name="a"><freejoint/>'
        f'<inertial pos="0 0 0" mass="1" diaginertia="1 2 2.5" {orientation}/>'
        f'<geom type="box" size="1 2 3" {orientation}/></body></worldbody></mujoco>'
    )
    compare(read_robot(file), compile_model(file))


def test_axes_close_together_make_a_rotation(tmp_path: Path) -> None:
    file = tmp_path / "turned.xml"
    file.write_text(body('<geom type="box" size="1 2 3" xyaxes="1 0.2 0 1 0.2003 0.0001"/>'))
    rotation = read_robot(file).links[0].geometries[0].placement.rotation
    assert np.abs(rotation.T @ rotation - np.eye(3)).max() < 1e-15
    normal = np.cross([1, 0.2, 0], [1, 0.2003, 0.0001])
    assert rotation[:, 2] == pytest.approx(normal / np.linalg.norm(normal), abs=1e-12)


SOUND = 'pos="0 0 0" mass="1" diaginertia="1 1 1"'


def mesh(attributes: str) -> str:
    return f'<asset><mesh name="m" file="m.stl" {attributes}/></asset>'


def body(inside: str, before: str = "") -> str:
    return f'<mujoco>{before}<worldbody><body name="a"><freejoint/>{inside}</body></worldbody></mujoco>'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (body('<body xyaxes="1 0.2 0 2 0.4 0"/>'), "an axis of no length, or along another one"),
        (body('<body xyaxes="1 0 0 5 9e-8 0"/>'), "an axis of no length, or along another one"),
        ("<mujoco><worldbody/></mujoco>", "it holds no body: export the robot again"),
        ("<mujoco><worldbody><frame><attach model='m'/></frame></worldbody></mujoco>", "attach is not read"),
        (body('<geom type="box" size="1 1 1" class="nix"/>'), "default class 'nix' is not there"),
        (body("", '<include file="nix.xml"/>'), "included file 'nix.xml' is not there"),
        (body("", '<include file="a.xml"/>'), "include one another"),
        ('<!DOCTYPE mujoco [<!ENTITY a "b">]>' + body(""), "document type"),
        (body("") + "x", "XML is damaged"),
        (body("<body name='a'/>"), "more than one link is called 'a'"),
        (body('<body quat="1 0 0 0" euler="1 0 0"/>'), "has both quat and euler"),
        (body("", '<compiler angle="rad"/>'), "angle is 'rad': it must be degree or radian"),
        (body("", '<compiler eulerseq="abc"/>'), "eulerseq is 'abc': it must be three of x, y, z, X, Y, Z"),
        (body("", '<compiler eulerseq="xy"/>'), "eulerseq is 'xy'"),
        (body("", mesh('scale="1/0 1 1"')), "mesh 'm', scale is '1/0 1 1': it must be numbers"),
        (body("", mesh('scale="1/3 1 1"')), "it must be numbers"),
        (body("", mesh('scale="1e999999999 1 1"')), "it must be finite"),
        (body("", mesh('scale="1 1"')), "it must be 3 numbers"),
        (body("", mesh('refquat="0 0 0 0"')), "mesh 'm', refquat is zero"),
        (body('<body><joint axis="0 0 0"/></body>'), "axis has no length"),
    ],
)
def test_what_is_no_model_is_refused(tmp_path: Path, text: str, says: str) -> None:
    file = tmp_path / "a.xml"
    file.write_text(text)
    with pytest.raises(inertia.ReadError, match=says):
        read_robot(file)


@pytest.mark.parametrize(
    ("attributes", "says"),
    [
        ('pos="0 0 0" diaginertia="1 1 1"', "body 'a', inertial has no mass: state one"),
        ('pos="0 0 0" mass="1"', "has no diaginertia"),
        ('pos="0 0 0" mass="x" diaginertia="1 1 1"', "mass is 'x': it must be numbers"),
        ('mass="1" diaginertia="1 1 1"', "inertial has no pos"),
        ('pos="0 0 0" mass="1" diaginertia="1 1 1" fullinertia="1 1 1 0 0 0"', "both fullinertia and diaginertia"),
        ('pos="0 0 0" mass="1" quat="1 0 0 0" fullinertia="1 1 1 0 0 0"', "both quat and fullinertia"),
        (f"{SOUND}/><inertial {SOUND}", "there 2 times"),
        ('pos="0 0 0" mass="-1" diaginertia="1 1 1"', None),
    ],
)
def test_an_inertial_that_mujoco_does_not_load_is_the_fault_of_its_body(
    tmp_path: Path, attributes: str, says: str | None
) -> None:
    file = tmp_path / "a.xml"
    file.write_text(body(f"<inertial {attributes}/><body name='b'><joint/><inertial {SOUND}/></body>"))
    with pytest.raises(ValueError, match=r"."):  # as MuJoCo has it
        compile_model(file)
    robot = read_robot(file)
    assert (says or "") in robot.links[0].fault
    assert robot.links[1].fault == ""
    with pytest.raises(inertia.GeometryError, match=says or "must not be negative"):
        robot_tree(robot)


def test_what_frames_hold_lies_where_mujoco_has_it(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    file.write_text(
        "<mujoco><worldbody><body name='a'><freejoint/>"
        "<frame pos='1 0 0' euler='0 0 90'><frame euler='20 0 0' pos='0 0.1 0'>"
        "<inertial pos='0.1 0.2 0.3' quat='0.9 0.1 -0.2 0.3' mass='2' diaginertia='0.03 0.02 0.04'/>"
        "</frame></frame><body name='b' pos='0 0 1'>"
        "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>"
        "<frame pos='0 1 0' euler='0 90 0'><joint name='turn' axis='1 0.5 0' pos='0.5 0 0' ref='20'/></frame>"
        "</body></body></worldbody></mujoco>"
    )
    model = compile_model(file)
    robot = read_robot(file)
    compare(robot, model)
    joint = robot.links[1].joint
    assert joint is not None
    np.testing.assert_allclose(joint.axis / np.linalg.norm(joint.axis), model.jnt_axis[1], atol=1e-15)
    np.testing.assert_allclose(joint.point, model.jnt_pos[1], atol=1e-15)
    assert joint.rest == pytest.approx(model.qpos0[7], abs=1e-15)
    at_rest, turned = (robot_tree(robot, at)[0]["part"][1] for at in (None, {"turn": 0.0}))
    assert at_rest["at"] == [0, 0, 1]
    mujoco = pytest.importorskip("mujoco")
    data = mujoco.MjData(model)
    data.qpos[3], data.qpos[7] = 1, 0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(turned["at"], data.xpos[2], atol=1e-14)
    np.testing.assert_allclose(np.ravel(turned["matrix"]), data.xmat[2], atol=1e-14)


def test_a_default_of_another_name_at_the_top_counts_for_all(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    inner = '<default class="b"><geom size="4 5 6"/></default>'
    default = f'<default class="foo"><geom type="box" size="1 2 3"/>{inner}</default>'
    file.write_text(body('<geom/><geom class="foo"/><geom class="b"/>', default))
    robot = read_robot(file)
    assert [geometry.shape for geometry in robot.links[0].geometries] == [
        Primitive("box", sizes) for sizes in ((2, 4, 6), (2, 4, 6), (8, 10, 12))
    ]
    assert "called 'foo': MuJoCo 3 wants it called main" in " ".join(robot.notes)


USUAL = '<default><geom size="0.05 0.1 0.2"/><default class="c"><geom type="capsule"/></default></default>'


@pytest.mark.parametrize(
    ("default", "geom"),
    [
        (USUAL, '<geom type="box" size="0.1 0.05"/>'),
        (USUAL, '<geom type="ellipsoid" size="0.3"/>'),
        (USUAL, '<geom type="box" size=""/>'),
        (USUAL, '<geom class="c" size="0.03"/>'),
        (USUAL, '<geom class="c" size="0.03" fromto="0 0 0 0.1 0.2 0.3"/>'),
        (USUAL.replace('type="capsule"', 'size="0.7"'), '<geom class="c" type="box"/>'),
        (USUAL + '<default><geom size="0.5"/></default>', '<geom type="box"/>'),
        ("", '<geom type="capsule" size="0.1" fromto="0 0 0 1 1 1" pos="0 0 0"/>'),
    ],
)
def test_a_size_takes_the_place_of_as_many_numbers_as_it_has(tmp_path: Path, default: str, geom: str) -> None:
    file = tmp_path / "a.xml"
    file.write_text(body(geom, default))
    compare(read_robot(file), compile_model(file))


@pytest.mark.parametrize("above", ORIENTATIONS[1:])
@pytest.mark.parametrize("own", ORIENTATIONS)
def test_an_orientation_takes_the_place_of_any_in_a_class(tmp_path: Path, above: str, own: str) -> None:
    file = tmp_path / "a.xml"
    inner = f'<default class="b"><geom {own}/></default>'
    geoms = f'<geom type="box" size="1 2 3" {own}/><geom class="b" type="box" size="1 2 3"/>'
    file.write_text(body(geoms, f"<default><geom {above}/>{inner}</default>"))
    compare(read_robot(file), compile_model(file))


def test_an_orientation_over_that_of_a_class_turns_a_mesh_too(tmp_path: Path) -> None:
    solid.file(tmp_path)
    file = tmp_path / "a.xml"
    asset = '<asset><mesh name="m" file="upper arm.obj" scale="1 1 1"/></asset>'
    default = '<default><geom quat="0.7 0.7 0 0"/></default>'
    file.write_text(body('<geom type="mesh" mesh="m" euler="0 0 30"/>', default + asset))
    compare(read_robot(file), compile_model(file))


@pytest.mark.parametrize(
    ("quaternion", "says"),
    [
        ("1e-200 1e-200 0 0", "1.41e-200 long, which MuJoCo does not take for a rotation: scale it to the length 1"),
        ("0 1e-8 1e-8 0", "1.41e-08 long"),
        ("0 1e160 1e160 0", "1.41e+160 long"),
        ("0 1e-7 1e-7 0", None),
        ("0 1e150 1e150 0", None),
    ],
)
def test_a_quaternion_of_any_length_is_a_rotation_or_is_refused(
    tmp_path: Path, quaternion: str, says: str | None
) -> None:
    file = tmp_path / "a.xml"
    file.write_text(body(f'<geom type="box" size="1 2 3" quat="{quaternion}"/>'))
    model, robot = compile_model(file), read_robot(file)
    length = np.linalg.norm(model.geom_quat[0])
    if says is None:
        assert length == pytest.approx(1.0)
        compare(robot, model)
    else:
        assert length < 0.9
        assert says in str(robot.links[0].geometries[0].shape)


def test_names_that_are_made_are_not_those_given(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    box, named = '<geom type="box" size="1 1 1"/>', '<geom type="box" size="1 1 1" name="{}"/>'
    bodies = [
        f'<body name="body 2"><joint name="body 3"/>{box}</body>',
        f"<body><joint/>{box}</body>",
        f"<body><joint/>{box}</body>",
        f'<body name="a">{named.format("box 2")}{box}{named.format("box 2 2")}</body>',
        f'<body name="a/box 2">{box}</body>',
    ]
    file.write_text(f"<mujoco><worldbody>{''.join(bodies)}</worldbody></mujoco>")
    robot = read_robot(file)
    assert [link.name for link in robot.links] == ["body 2", "body 2 2", "body 3", "a", "a/box 2"]
    assert [link.joint and link.joint.name for link in robot.links] == [
        "body 3", "body 2 2", "body 3 2", "a", "a/box 2"
    ]  # fmt: skip
    tree, _ = robot_tree(robot)
    names = [part["name"] for part in tree["part"] if part.get("parent") == "a"]
    assert names == ["a/box 2 3", "a/box 2 4", "a/box 2 2"]
    assert inertia.Assembly.from_dict(tree).mass_properties().mass == pytest.approx(7 * 8000)
    assert compile_model(file).body_mass.sum() == pytest.approx(7 * 8000)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (body("", '<compiler inertiafromgeom="true"/>'), None),
        (body("", '<compiler fusestatic="true"/>'), "fusestatic is true"),
        (body('<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>', '<compiler inertiafromgeom="true"/>'), None),
        (body("", '<compiler boundmass="0.1"/>'), "boundmass is set"),
        (body("", '<compiler boundmass="0"/>'), None),
        (body('<composite type="cable"/>'), "composite is not read"),
        (body('<plugin instance="p"/>'), "plugin is not read"),
        (body("", '<compiler balanceinertia="true"/>'), "balanceinertia is set"),
    ],
)
def test_what_is_decided_is_said(tmp_path: Path, text: str, says: str | None) -> None:
    file = tmp_path / "a.xml"
    file.write_text(text)
    notes = read_robot(file).notes
    assert (says is None and notes == ()) or (says is not None and says in " ".join(notes))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (body('<geom type="mesh" mesh="m"/>', '<asset><mesh name="m" vertex="0 0 0"/></asset>'), "is flat"),
        (
            body('<geom type="mesh" mesh="m"/>', '<asset><mesh name="m" builtin="sphere"/></asset>'),
            "no file and no vertices",
        ),
        (body('<geom type="hfield" hfield="h"/>'), "a height field is not read"),
        (body('<geom type="mesh" mesh="m"/>'), "'m' is not among the assets"),
        (body('<geom type="cone" size="1"/>'), "'cone' is no type"),
        (body('<geom type="box" size="1 1 1" quat="0 0 0 0"/>'), "quat is zero"),
        (body('<geom type="box" size="1 1 1" zaxis="0 0 0"/>'), "an axis of no length"),
        (body('<geom type="box" size="1 1 x"/>'), "it must be numbers"),
        (body('<geom size="1" fromto="0 0 0 1 1 1"/>'), "a sphere with fromto"),
        (body('<geom type="box" size="1" fromto="0 0 0 1 1 1" pos="0 0 1"/>'), "both pos and fromto"),
        (body('<geom type="box" size="1" fromto="0 0 0 0 0 0"/>'), "an axis of no length"),
        (body('<geom type="box" mesh="m"/>'), "a box fitted to a mesh"),
        (body('<geom type="ellipsoid" mesh="m"/>'), "an ellipsoid fitted to a mesh"),
        (
            body(
                '<geom type="mesh" mesh="m"/>',
                '<asset><mesh name="m" file="m.stl" scale="1 2 3" refquat="1 1 0 0"/></asset>',
            ),
            "turned by refquat",
        ),
    ],
)
def test_a_shape_that_cannot_be_weighed_says_why(tmp_path: Path, text: str, says: str) -> None:
    file = tmp_path / "a.xml"
    file.write_text("\n" + text)
    (geometry,) = read_robot(file).links[0].geometries
    assert isinstance(geometry.shape, str)
    assert says in geometry.shape


def test_files_that_include_two_others_each_end(tmp_path: Path) -> None:
    for k in range(30):
        twice = f'<include file="{k + 1}.xml"/>' * 2
        (tmp_path / f"{k}.xml").write_text(f"<mujoco>{twice}<worldbody/></mujoco>")
    (tmp_path / "30.xml").write_text("<mujoco/>")
    with pytest.raises(inertia.ReadError, match="more than 1000 files are included"):
        read_robot(tmp_path / "0.xml")


def test_bodies_nested_through_many_files_are_refused(tmp_path: Path) -> None:
    for k in range(30):
        inside = f'<include file="{k + 1}.xml"/>'
        nest = "<body>" * 150 + inside + "</body>" * 150
        (tmp_path / f"{k}.xml").write_text(f"<mujoco>{nest if k else f'<worldbody>{nest}</worldbody>'}</mujoco>")
    (tmp_path / "30.xml").write_text("<mujoco/>")
    with pytest.raises(inertia.ReadError, match="nested deeper than 200"):
        read_robot(tmp_path / "0.xml")


def test_global_coordinates_are_refused_as_mujoco_refuses_them(tmp_path: Path) -> None:
    file = tmp_path / "m.xml"
    file.write_text('<mujoco><compiler coordinate="global"/><worldbody><body/></worldbody></mujoco>')
    with pytest.raises(ReadError, match="its coordinates are global"):
        read_robot(file)


GEOMS = """
<mujoco><compiler inertiagrouprange="0 2"/>
  <default><geom density="700"/></default>
  <asset><mesh name="m" file="upper arm.obj" scale="0.5 0.4 -0.3" refpos="0.1 -0.2 0.3"/></asset>
  <worldbody><geom size="5"/>
    <body name="a" pos="0 0 1"><freejoint/>
      <geom size="0.1" mass="3"/><geom type="capsule" size="0.04" fromto="0 0 0 0.1 0.2 -0.4"/>
      <geom type="ellipsoid" size="0.1 0.2 0.3" pos="0.1 0 0" euler="10 20 30" density="500"/>
      <geom type="box" size="1 1 1" mass="0"/>
      <body name="b" pos="0 0.5 0" euler="0 40 0"><joint name="turn" axis="0 1 0.2"/>
        <geom type="cylinder" size="0.05 0.3"/><geom type="box" size="0.1 0.2 0.3" group="3"/>
        <frame pos="0.3 0 0" euler="30 0 0"><geom type="mesh" mesh="m" euler="0 0 20"/></frame>
        <body name="c"><joint/><inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/><geom size="1"/></body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_bodies_without_an_inertial_weigh_what_their_geoms_do(tmp_path: Path, turn: float) -> None:
    solid.file(tmp_path)
    file = tmp_path / "a.xml"
    file.write_text(GEOMS)
    model = compile_model(file)
    mujoco = pytest.importorskip("mujoco")
    data = mujoco.MjData(model)
    data.qpos[7] = turn
    mujoco.mj_forward(model, data)
    tree, notes = robot_tree(read_robot(file), {"turn": turn})
    whole = inertia.Assembly.from_dict(tree).mass_properties()
    assert notes == ()
    assert whole.mass == pytest.approx(model.body_subtreemass[0], rel=1e-7)  # the mesh is in float32 there
    np.testing.assert_allclose(whole.center_of_mass, data.subtree_com[0], atol=1e-7)
    tensor = np.zeros((3, 3))
    for k in range(1, model.nbody):
        turned = data.ximat[k].reshape(3, 3)
        d = data.xipos[k] - data.subtree_com[0]
        tensor += turned @ np.diag(model.body_inertia[k]) @ turned.T + model.body_mass[k] * (
            d @ d * np.eye(3) - np.outer(d, d)
        )
    np.testing.assert_allclose(whole.inertia, tensor, atol=1e-6 * np.linalg.norm(tensor))


def test_geoms_without_a_weight_make_no_mass(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    file.write_text(body('<geom size="1"/>', '<compiler inertiafromgeom="false"/>'))
    tree, notes = robot_tree(read_robot(file))
    assert [part["name"] for part in tree["part"]] == ["a"]
    assert "states no mass" in notes[0]
    file.write_text(body('<geom size="1" mass="2"/><geom name="s" size="0"/><geom type="cone" size="1"/>'))
    robot = read_robot(file)
    tree, notes = robot_tree(robot)
    assert [part.get("mass") for part in tree["part"]] == [None, 2.0]
    assert ["s is left out: it encloses nothing" in notes[0], "'cone' is no type" in notes[1]] == [True, True]
    assert unweighed(robot) == notes


STATED = '<inertial pos="0.1 0.2 0.3" mass="2" diaginertia="0.03 0.02 0.04"/>'


@pytest.mark.parametrize(
    ("inside", "mass"),
    [
        (STATED + '<geom size="0.1"/>', 4000 / 3 * np.pi * 1e-3),
        ('<inertial pos="0 0 0" mass="-2" diaginertia="1 1 9"/><geom size="0.1" mass="3"/>', 3.0),
        (STATED, 2.0),
        (STATED + '<geom size="0.1" group="3"/>', 2.0),
        (STATED + '<geom size="0.1" mass="0"/>', 2.0),
    ],
)
def test_inertias_from_geoms_take_the_place_of_stated_ones(tmp_path: Path, inside: str, mass: float) -> None:
    file = tmp_path / "a.xml"
    file.write_text(body(inside, '<compiler inertiafromgeom="true" inertiagrouprange="0 2"/>'))
    robot = read_robot(file)
    tree, _ = robot_tree(robot)
    assert inertia.Assembly.from_dict(tree).mass_properties().mass == pytest.approx(mass, rel=1e-15)
    assert [note for note in robot.notes if "inertiafromgeom" in note] == (
        [] if mass == 2.0 else ["inertiafromgeom is true: bodies weigh what their geoms do, whatever is stated of them"]
    )
    assert compile_model(file).body_mass[1] == pytest.approx(mass, rel=1e-12)


ANGLE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
SIDES = [(k, (k + 1) % 6, (k + 1) % 6 + 6) for k in range(6)] + [(k, (k + 1) % 6 + 6, k + 6) for k in range(6)]
ENDS = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]


@pytest.mark.parametrize(
    ("filling", "mass"),
    [("exact", 10 * 3.0), ("convex", 10 * 3.5), ("shell", 10 * (2 * 6.0 + 12 * 0.5))],
)
@pytest.mark.parametrize("weight", ['density="10"', 'mass="3"'])
def test_meshes_weigh_by_their_solid_surface_or_hull(tmp_path: Path, filling: str, mass: float, weight: str) -> None:
    """An angle with legs of 4 × 1 and 2 × 2, 0.5 high: of 3 m³ and 18 m² (12 around it), its hull of 3.5 m³."""
    corners = [(x, y, z) for z in (0, 0.5) for x, y in ANGLE]
    faces = [*SIDES, *((a, c, b) for a, b, c in ENDS), *((a + 6, b + 6, c + 6) for a, b, c in ENDS)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "angle.obj").write_text("\n".join(lines))
    file = tmp_path / "a.xml"
    mesh = f'<asset><mesh name="m" file="angle.obj" scale="2 1 1" inertia="{filling}"/></asset>'
    file.write_text(body(f'<geom type="mesh" mesh="m" {weight} pos="0.1 0.2 0.3" euler="10 20 30"/>', mesh))
    tree, notes = robot_tree(read_robot(file))
    whole = inertia.Assembly.from_dict(tree).mass_properties()
    assert whole.mass == pytest.approx(3.0 if "mass" in weight else mass, rel=1e-12)
    assert notes == ()
    model = compile_model(file)
    turned = rotation_of_quaternion(model.body_iquat[1].tolist())
    assert model.body_mass[1] == pytest.approx(whole.mass, rel=1e-6)
    np.testing.assert_allclose(whole.center_of_mass, model.body_ipos[1], atol=1e-6)
    np.testing.assert_allclose(
        whole.inertia, turned @ np.diag(model.body_inertia[1]) @ turned.T, atol=1e-5 * whole.mass
    )


def test_a_mesh_of_an_unknown_filling_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    file.write_text(body("", '<asset><mesh name="m" file="m.obj" inertia="hollow"/></asset>'))
    with pytest.raises(ReadError, match="mesh 'm', inertia is 'hollow': it must be legacy, exact, shell, convex"):
        read_robot(file)


def test_a_total_mass_that_is_set_scales_all(tmp_path: Path) -> None:
    solid.file(tmp_path)
    file = tmp_path / "a.xml"
    inner = f'<body name="b" pos="1 0 0">{STATED}</body><geom type="capsule" size="0.1 0.3" pos="0 1 0"/>'
    mesh = '<asset><mesh name="m" file="upper arm.obj" scale="2 1 1"/></asset>'
    before = f'<compiler settotalmass="14"/>{mesh}'
    file.write_text(body(f'<geom type="mesh" mesh="m" density="2"/><geom size="0.2" mass="3"/>{inner}', before))
    model = compile_model(file)
    robot = read_robot(file)
    whole = inertia.Assembly.from_dict(robot_tree(robot)[0]).mass_properties()
    assert whole.mass == pytest.approx(14.0, rel=1e-15)
    assert robot.notes == ("settotalmass is set: all weigh 14 kg together, for which masses and tensors are scaled",)
    tensor, centers = np.zeros((3, 3)), np.add(model.body_ipos[1:], [[0, 0, 0], [1, 0, 0]])
    center = np.average(centers, axis=0, weights=model.body_mass[1:])
    for k, d in zip((1, 2), centers - center, strict=True):
        turned = rotation_of_quaternion(model.body_iquat[k].tolist())
        tensor += turned @ np.diag(model.body_inertia[k]) @ turned.T
        tensor += model.body_mass[k] * (d @ d * np.eye(3) - np.outer(d, d))
    np.testing.assert_allclose(whole.center_of_mass, center, atol=1e-6)
    np.testing.assert_allclose(whole.inertia, tensor, atol=1e-5)
