"""SDFormat against Drake, and against poses that are multiplied out by hand."""

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.exchange import solid
from tests.mesh import solids

import inertia
from inertia.exchange.robots.links import Figures, Link, Placement, Primitive
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.tree import robot_tree

MODEL = """<?xml version="1.0"?>
<!-- <robot> is not what this is -->
<sdf version="1.9">
  <model name="arm">
    <pose>9 9 9 0 0 1</pose>
    <plugin name="p" filename="p.so"><robotNamespace>x</robotNamespace></plugin>
    <frame name="bench"><pose>0 0 1 0 0 1.5707963267948966</pose></frame>
    <frame name="bracket" attached_to="upper"><pose>0.5 0 0 0.3 -0.2 0.1</pose></frame>
    <link name="base">
      <inertial>
        <pose>0.1 -0.02 0.3 0.4 -0.5 0.6</pose>
        <mass>2.5</mass>
        <inertia><ixx>0.01</ixx><ixy>0.001</ixy><ixz>-0.002</ixz><iyy>0.02</iyy><iyz>0.003</iyz><izz>0.025</izz></inertia>
      </inertial>
      <visual name="block"><geometry><box><size>0.1 0.2 0.3</size></box></geometry></visual>
    </link>
    <link name="upper">
      <pose relative_to="bench">1 2 3 0.1 0.2 0.3</pose>
      <inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.12</iyy><izz>0.14</izz></inertia></inertial>
      <visual name="on_bracket">
        <pose relative_to="bracket">0 0.1 0 0 0 0.2</pose>
        <geometry><cylinder><radius>0.05</radius><length>0.4</length></cylinder></geometry>
      </visual>
      <visual name="at_joint">
        <pose relative_to="weld" degrees="true">0 0 0 0 90 0</pose>
        <geometry><sphere><radius>0.07</radius></sphere></geometry>
      </visual>
      <collision name="turned">
        <pose rotation_format="quat_xyzw">0 0 1 0.1 -0.2 0.3 0.9</pose>
        <geometry><capsule><radius>0.02</radius><length>0.1</length></capsule></geometry>
      </collision>
      <collision name="egg">
        <geometry><ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid></geometry>
      </collision>
    </link>
    <joint name="weld" type="fixed">
      <pose>0 0 0.25 0 0 0</pose><parent>base</parent><child>upper</child>
    </joint>
    <joint name="hinge" type="revolute">
      <parent>upper</parent><child>hand::palm</child><axis><xyz>0 0 1</xyz></axis>
    </joint>
    <model name="hand">
      <pose relative_to="upper">0 0 1 0 0 0.5</pose>
      <link name="palm"><pose>0.1 0 0 0 0 0</pose></link>
      <link name="finger"><pose relative_to="palm">0 0.2 0 0.3 0 0</pose></link>
      <joint name="glue" type="fixed"><parent>palm</parent><child>finger</child></joint>
    </model>
  </model>
</sdf>
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "arm.sdf"
    path.write_text(MODEL)
    return path


def link(file: Path, name: str) -> Link:
    return next(link for link in read_robot(file).links if link.name == name)


def turn(axis: int, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.eye(4)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rotation[[i, i, j, j], [i, j, i, j]] = c, -s, s, c
    return rotation


def pose(x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Return the (4, 4) matrix of a pose: turns about the fixed x, y and z, then the shift."""
    shift = np.eye(4)
    shift[:3, 3] = x, y, z
    return shift @ turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)


def same(placement: Placement, matrix: np.ndarray) -> bool:
    return np.allclose(np.c_[placement.rotation, placement.origin], matrix[:3], rtol=0, atol=1e-15)


def test_names_are_those_within_the_model(file: Path) -> None:
    robot = read_robot(file)
    assert (robot.format, robot.name) == ("sdf", "arm")
    assert [link.name for link in robot.links] == ["base", "upper", "hand::palm", "hand::finger"]


def test_what_is_stated(file: Path) -> None:
    inertial = link(file, "base").inertial
    assert inertial is not None
    assert inertial.mass == 2.5
    assert same(inertial.placement, pose(0.1, -0.02, 0.3, 0.4, -0.5, 0.6))
    assert inertial.inertia.tolist() == [[0.01, 0.001, -0.002], [0.001, 0.02, 0.003], [-0.002, 0.003, 0.025]]
    assert inertial.figures == (Figures(2, 1), Figures(3, 2))
    assert link(file, "hand::palm").inertial is None


def test_shapes_lie_where_their_frames_are(file: Path) -> None:
    on_bracket, at_joint, turned, egg = link(file, "upper").geometries
    assert same(on_bracket.placement, pose(0.5, 0, 0, 0.3, -0.2, 0.1) @ pose(0, 0.1, 0, 0, 0, 0.2))
    assert same(at_joint.placement, pose(0, 0, 0.25, 0, np.pi / 2, 0))
    assert np.allclose(turned.placement.rotation @ [0.1, -0.2, 0.3], [0.1, -0.2, 0.3], atol=1e-15)
    assert egg.shape == Primitive("ellipsoid", (0.1, 0.2, 0.3))
    assert [each.role for each in (on_bracket, at_joint, turned, egg)] == ["visual"] * 2 + ["collision"] * 2


def test_fixed_joints_keep_the_links_where_they_are(file: Path) -> None:
    upper, finger = link(file, "upper"), link(file, "hand::finger")
    assert upper.parent == "base"
    assert same(upper.placement, pose(0, 0, 1, 0, 0, np.pi / 2) @ pose(1, 2, 3, 0.1, 0.2, 0.3))
    assert finger.parent == "hand::palm"
    assert same(finger.placement, pose(0, 0.2, 0, 0.3, 0, 0))
    assert link(file, "hand::palm").parent is None


def test_drake_agrees(file: Path) -> None:
    plants = pytest.importorskip("pydrake.multibody.plant")
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    graphs = pytest.importorskip("pydrake.geometry")
    plant, scene = plants.MultibodyPlant(0.0), graphs.SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene)
    parser = parsing.Parser(plant)
    parser.AddModels(str(file))
    plant.Finalize()
    inspector = scene.model_inspector()
    for each in read_robot(file).links:
        *models, name = each.name.split("::")
        body = plant.GetBodyByName(name, plant.GetModelInstanceByName("::".join(["arm", *models])))
        if each.inertial is not None:
            compare_inertial(each, body.default_spatial_inertia())
        for role, shapes in (
            ("visual", plant.GetVisualGeometriesForBody(body)),
            ("collision", plant.GetCollisionGeometriesForBody(body)),
        ):
            ours = [geometry for geometry in each.geometries if geometry.role == role]
            assert len(ours) == len(shapes)
            for geometry, shape in zip(ours, shapes, strict=True):
                assert same(geometry.placement, inspector.GetPoseInFrame(shape).GetAsMatrix4())


def compare_inertial(each: Link, spatial: Any) -> None:
    assert each.inertial is not None
    where = each.inertial.placement
    central = spatial.Shift(spatial.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    assert spatial.get_mass() == each.inertial.mass
    assert np.allclose(spatial.get_com(), where.origin, rtol=0, atol=1e-15)
    assert np.allclose(central, where.rotation @ each.inertial.inertia @ where.rotation.T, rtol=0, atol=1e-15)


def test_meshes_are_found_and_scaled(tmp_path: Path) -> None:
    (tmp_path / "arm" / "meshes").mkdir(parents=True)
    mesh = solid.file(tmp_path / "arm" / "meshes")
    file = tmp_path / "arm" / "model.sdf"
    file.write_text(
        '<sdf version="1.9"><world name="w"><model name="arm"><link name="a"><visual name="v"><geometry><mesh>'
        "<uri>model://arm/meshes/upper arm.obj</uri><scale>0.001 0.001 0.001</scale></mesh></geometry></visual>"
        '<visual name="part"><geometry><mesh><uri>nix.obj</uri><submesh><name>x</name></submesh></mesh></geometry>'
        '</visual><visual name="cone"><geometry><torus/></geometry></visual></link></model>'
        '<model name="b"><link name="a"/></model></world></sdf>'
    )
    robot = read_robot(file)
    assert [link.name for link in robot.links] == ["arm::a", "b::a"]
    geometry, part, cone = robot.links[0].geometries
    assert (geometry.shape, geometry.scale) == (mesh, (Fraction(1, 1000),) * 3)
    assert part.shape == "a part of a mesh's file cannot be weighed"
    assert cone.shape == "'torus' is no shape that can be weighed"


def text(inside: str) -> str:
    return f'<sdf version="1.9"><model name="m">{inside}</model></sdf>'


@pytest.mark.parametrize(
    ("inside", "says"),
    [
        ("", "it holds no link: export the robot again"),
        ('<link name="a"><inertial><mass>x</mass></inertial></link>', "mass is 'x': it must be numbers"),
        ('<link name="a"><pose>1 2 3</pose></link>', "link 'a', pose is '1 2 3': it must be 6 numbers"),
        ('<link name="a"><pose relative_to="b"/></link>', "there is no frame 'b' in the model 'm'"),
        (
            '<link name="a"><pose relative_to="b"/></link><link name="b"><pose relative_to="a"/>'
            '<visual name="v"><pose relative_to="a"/><geometry><sphere><radius>1</radius></sphere></geometry></visual>'
            "</link>",
            "counts from itself",
        ),
        ('<link name="a"><pose rotation_format="quat_xyzw">0 0 0 0 0 0 0</pose></link>', "quaternion of zero"),
    ],
)
def test_faults(tmp_path: Path, inside: str, says: str) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(text(inside))
    with pytest.raises(inertia.ReadError, match=f"cannot read {file}") as fault:
        read_robot(file)
    assert says in str(fault.value)


NO_MOMENTS = "link 'a', inertial has no ixx, iyy, izz: 1 kg m², as SDFormat has it"
NO_MASS = "link 'a', inertial has no mass: 1 kg, as SDFormat has it"


@pytest.mark.parametrize(
    ("inside", "mass", "moments", "notes"),
    [
        ("<mass>2</mass>", 2, [1, 1, 1], (NO_MOMENTS,)),
        ("", 1, [1, 1, 1], (NO_MASS, NO_MOMENTS)),
        ("<mass/><inertia><ixx/></inertia>", 1, [1, 1, 1], (NO_MASS, NO_MOMENTS)),
        ("<inertia><ixx>2</ixx><iyy>3</iyy><izz>4</izz></inertia>", 1, [2, 3, 4], (NO_MASS,)),
        ("<mass>5</mass><inertia><ixx>2</ixx><iyy>3</iyy><izz>4</izz></inertia>", 5, [2, 3, 4], ()),
    ],
)
def test_defaults_are_those_of_the_specification_and_said(
    tmp_path: Path, inside: str, mass: float, moments: list[float], notes: tuple[str, ...]
) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(text(f'<link name="a"><inertial>{inside}</inertial></link><link name="b"/>'))
    robot = read_robot(file)
    inertial = robot.links[0].inertial
    assert inertial is not None
    assert (inertial.mass, inertial.inertia.tolist()) == (mass, np.diag(moments).astype(float).tolist())
    assert robot.notes == notes


def test_an_automatic_inertia_is_not_stated(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(text('<link name="a"><inertial auto="true"><density>1</density></inertial></link>'))
    assert read_robot(file).links[0].inertial is None


@pytest.mark.parametrize(
    ("densities", "mass", "masses"),
    [(("", ""), "10", (5.0, 5.0)), (("300", "100"), "10", (7.5, 2.5)), (("300", "100"), "", (300.0, 100.0))],
)
def test_an_automatic_inertia_is_scaled_to_the_mass_that_is_stated(
    tmp_path: Path, densities: tuple[str, str], mass: str, masses: tuple[float, float]
) -> None:
    """Two cubes of 1 m side by side, one of them by a mesh in another scale; by hand, and as Drake has it."""
    vertices, faces = solids.box((-2, -0.5, -0.25), (2, 0.5, 0.25))
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "cube.obj").write_text("\n".join(lines))
    own = [f"<density>{density}</density>" if density else "" for density in densities]
    shapes = "<box><size>1 1 1</size></box>", "<mesh><uri>cube.obj</uri><scale>0.25 1 2</scale></mesh>"
    collisions = "".join(
        f'<collision name="c{k}"><pose>{k} 0 0 0 0 0</pose>{own[k]}<geometry>{shapes[k]}</geometry></collision>'
        for k in range(2)
    )
    inertial = f'<inertial auto="true">{f"<mass>{mass}</mass>" if mass else ""}</inertial>'
    file = tmp_path / "a.sdf"
    file.write_text(text(f'<link name="a">{inertial}{collisions}</link>'))
    tree, notes = robot_tree(read_robot(file))
    whole = inertia.Assembly.from_dict(tree).mass_properties()
    a, b = masses
    assert notes == ()
    assert whole.mass == pytest.approx(a + b, rel=1e-15)
    assert whole.center_of_mass == pytest.approx([b / (a + b), 0, 0], abs=1e-15)
    beside = (a + b) / 6 + a * b / (a + b)
    assert np.diag(whole.inertia) == pytest.approx([(a + b) / 6, beside, beside], rel=1e-14)


@pytest.fixture
def world(tmp_path: Path) -> Path:
    """A world that includes a model twice, which includes a hand; each lies in a folder of its own."""
    hand, arm = tmp_path / "models" / "hand", tmp_path / "models" / "arm"
    hand.mkdir(parents=True)
    arm.mkdir()
    (hand / "model.config").write_text("<model><name>hand</name><sdf version='1.9'>the hand.sdf</sdf></model>")
    (hand / "the hand.sdf").write_text(
        '<sdf version="1.9"><model name="hand"><link name="palm"><visual name="v"><geometry><mesh>'
        "<uri>model://hand/palm.stl</uri></mesh></geometry></visual></link></model></sdf>"
    )
    (hand / "palm.stl").write_bytes(b"")
    (arm / "model.sdf").write_text(
        '<sdf version="1.9"><model name="arm"><pose>9 9 9 0 0 0</pose><link name="upper"/>'
        "<include><uri>model://hand</uri><name>grip</name><pose relative_to='upper'>0 0 1 0 0 0</pose></include>"
        '<joint name="weld" type="fixed"><parent>upper</parent><child>grip::palm</child></joint></model></sdf>'
    )
    file = tmp_path / "models" / "world.sdf"
    file.write_text(
        '<sdf version="1.9"><world name="w"><include><uri>model://arm</uri><pose>1 0 0 0 0 0</pose></include>'
        "<include><uri>model://arm</uri><name>second</name></include><include><uri>model://nix</uri></include>"
        "<include merge='true'><uri>model://arm</uri></include></world></sdf>"
    )
    return file


def test_included_models_are_read(world: Path) -> None:
    robot = read_robot(world)
    names = ["arm::upper", "arm::grip::palm", "second::upper", "second::grip::palm"]
    assert [link.name for link in robot.links] == names
    palm = robot.links[1]
    assert palm.parent == "arm::upper"
    assert same(palm.placement, pose(0, 0, 1, 0, 0, 0))
    assert palm.geometries[0].shape == world.parent / "hand" / "palm.stl"
    assert "'model://nix' is not read: it is not there" in robot.notes[0]
    assert "'model://arm' is not read: it is merged" in robot.notes[1]


def test_models_that_include_themselves_are_refused(world: Path) -> None:
    arm = world.parent / "arm" / "model.sdf"
    arm.write_text(arm.read_text().replace("model://hand", "model://arm"))
    with pytest.raises(inertia.ReadError, match="include one another"):
        read_robot(world)


def test_models_that_include_two_others_each_end(tmp_path: Path) -> None:
    for k in range(30):
        twice = f"<include><uri>{k + 1}.sdf</uri></include>" * 2
        (tmp_path / f"{k}.sdf").write_text(f'<sdf version="1.9"><model name="m{k}">{twice}</model></sdf>')
    (tmp_path / "30.sdf").write_text(text('<link name="a"/>'))
    with pytest.raises(inertia.ReadError, match="more than 1000 models are included"):
        read_robot(tmp_path / "0.sdf")


@pytest.mark.parametrize("by_include", [False, True])
def test_a_model_is_placed_by_its_placement_frame(tmp_path: Path, by_include: bool) -> None:
    inside = (
        '<link name="a"><pose>0 0 1 0.3 0 0.5</pose></link><model name="grip" placement_frame="tip">'
        '<pose relative_to="a">0.1 0.2 0.3 0 0.7 0</pose><link name="b"/>'
        '<frame name="tip"><pose>0 0 2 0 0.4 0</pose></frame></model>'
        '<frame name="f" attached_to="grip::tip"><pose>1 0 0 0.4 0 0</pose></frame>'
    )
    placed = "<pose>1 2 3 0.1 0.2 0.3</pose>"
    file = tmp_path / "a.sdf"
    if by_include:
        (tmp_path / "m.sdf").write_text(text(f"<pose>7 7 7 0 0 0</pose>{inside}"))
        include = f"<include><uri>m.sdf</uri>{placed}<placement_frame>f</placement_frame></include>"
        file.write_text(f'<sdf version="1.9"><world name="w">{include}</world></sdf>')
    else:
        file.write_text(text(f"{placed}{inside}").replace("<model ", '<model placement_frame="f" ', 1))
    a, tip = pose(0, 0, 1, 0.3, 0, 0.5), pose(0, 0, 2, 0, 0.4, 0)
    b = a @ pose(0.1, 0.2, 0.3, 0, 0.7, 0) @ np.linalg.inv(tip)
    model = pose(1, 2, 3, 0.1, 0.2, 0.3) @ np.linalg.inv(b @ tip @ pose(1, 0, 0, 0.4, 0, 0))
    for name, where in (("a", a), ("grip::b", b)):
        joint = link(file, name).joint
        assert joint is not None
        assert np.allclose(np.c_[joint.placement.rotation, joint.placement.origin], (model @ where)[:3], atol=1e-14)


@pytest.mark.parametrize("placed_by", ["", "tip"])
def test_a_merged_model_lends_its_links_to_the_one_around_it(tmp_path: Path, placed_by: str) -> None:
    (tmp_path / "tool").mkdir()
    (tmp_path / "tool" / "tool.sdf").write_text(
        text(
            '<pose>7 7 7 0 0 0</pose><link name="upper"><pose>1 0 0 0 0.3 0</pose>'
            "<visual name='v'><geometry><mesh><uri>upper.stl</uri></mesh></geometry></visual></link>"
            '<link name="lower"/><model name="grip"><pose>0 0 1 0.2 0 0</pose><link name="finger"/></model>'
            '<frame name="tip"><pose>0 1 0 0 0 0.4</pose></frame>'
            '<frame name="own" attached_to="__model__"><pose relative_to="__model__">0 0 3 0.1 0 0</pose></frame>'
            '<link name="last"><pose relative_to="own">0 2 0 0 0 0</pose></link>'
            '<joint name="weld" type="fixed"><parent>__model__</parent><child>grip::finger</child></joint>'
            '<joint name="turn" type="revolute"><parent>upper</parent><child>last</child>'
            '<axis><xyz expressed_in="__model__">1 0 0</xyz></axis></joint>'
        )
    )
    (tmp_path / "tool" / "upper.stl").write_bytes(b"")
    frame = f"<placement_frame>{placed_by}</placement_frame>" if placed_by else ""
    file = tmp_path / "a.sdf"
    file.write_text(
        text(
            '<pose>0 0 5 0 0 0.7</pose><link name="base"><pose>1 1 0 0.5 0 0</pose></link><include merge="true">'
            f'<uri>tool/tool.sdf</uri>{frame}<pose relative_to="base">0 2 0 0 0 0.9</pose></include>'
        )
    )
    links = {link.name: link for link in read_robot(file).links}
    assert list(links) == ["base", "upper", "lower", "last", "grip::finger"]
    base = pose(0, 0, 5, 0, 0, 0.7) @ pose(1, 1, 0, 0.5, 0, 0)
    tool = base @ pose(0, 2, 0, 0, 0, 0.9)
    if placed_by:
        tool = tool @ np.linalg.inv(pose(0, 1, 0, 0, 0, 0.4))
    within = pose(1, 0, 0, 0, 0.3, 0)
    back, last = np.linalg.inv(within), pose(0, 0, 3, 0.1, 0, 0) @ pose(0, 2, 0, 0, 0, 0)
    for name, where in (("base", base), ("upper", tool @ within), ("lower", tool)):
        joint = links[name].joint
        assert joint is not None
        assert same(joint.placement, where)
    assert links["grip::finger"].parent == "upper"  # the first link, that a model goes with
    assert same(links["grip::finger"].placement, back @ pose(0, 0, 1, 0.2, 0, 0))
    turning = links["last"].joint
    assert turning is not None
    assert same(turning.placement, back @ last)
    assert np.abs(turning.axis - last[0, :3]).max() < 1e-15
    assert links["upper"].geometries[0].shape == tmp_path / "tool" / "upper.stl"


def test_models_in_a_world_count_from_its_frames_and_from_one_another(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(
        '<sdf version="1.9"><world name="w"><frame name="bench"><pose>1 2 3 0 0 1</pose></frame>'
        '<model name="m"><pose relative_to="bench">1 0 0 0.2 0 0</pose><link name="a"/></model>'
        '<model name="n"><pose relative_to="m::a">0 1 0 0 0.3 0</pose><link name="a"/></model>'
        '<joint name="weld" type="fixed"><parent>m::a</parent><child>n</child></joint></world></sdf>'
    )
    first, second = read_robot(file).links
    assert first.joint is not None
    assert same(first.joint.placement, pose(1, 2, 3, 0, 0, 1) @ pose(1, 0, 0, 0.2, 0, 0))
    assert second.parent == "m::a"
    assert same(second.placement, pose(0, 1, 0, 0, 0.3, 0))


@pytest.mark.parametrize(
    ("ends", "parent"),
    [
        (("a", "inner"), "a"),  # a model stands for its canonical link
        (("first", "inner::b"), "a"),  # a frame of the model, likewise
        (("__model__", "inner::tip"), "a"),
        (("early", "inner::b"), "a"),  # a joint goes with its child
        (("a", "named"), None),
    ],
)
def test_a_joint_joins_the_links_that_its_frames_go_with(
    tmp_path: Path, ends: tuple[str, str], parent: str | None
) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(
        text(
            '<link name="a"/><frame name="first"/><joint name="early" type="fixed"><parent>world</parent>'
            '<child>a</child></joint><model name="inner"><link name="b"/><frame name="tip" attached_to="b"/></model>'
            '<model name="named" canonical_link="d"><link name="c"/><link name="d"/></model>'
            f'<joint name="j" type="fixed"><parent>{ends[0]}</parent><child>{ends[1]}</child></joint>'
        )
    )
    robot = read_robot(file)
    assert robot.notes == ()
    assert {link.name: link.parent for link in robot.links} == {
        "a": None,
        "inner::b": parent,
        "named::c": None,
        "named::d": "a" if parent is None else None,
    }


def test_a_joint_that_closes_a_loop_or_lacks_an_end_is_left_out(tmp_path: Path) -> None:
    def joint(name: str, parent: str, child: str, kind: str = "fixed") -> str:
        return f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child></joint>'

    file = tmp_path / "a.sdf"
    ends = [("h", "a", "b", "revolute"), ("j", "a", "b"), ("k", "b", "c"), ("l", "c", "a"), ("m", "d", "d")]
    joints = "".join(joint(*each) for each in [*ends, ("n", "a", "")])
    file.write_text(text("".join(f'<link name="{name}"/>' for name in "abcd") + joints))
    robot = read_robot(file)
    assert [link.parent for link in robot.links] == [None, "a", "b", None]
    assert [note.partition(":")[0] for note in robot.notes] == [
        "joint 'n' has no child",
        *(f"joint {name!r} closes a loop" for name in "lmh"),
    ]


def test_links_that_a_nested_model_welds_stay_together(tmp_path: Path) -> None:
    def joint(name: str, parent: str, child: str, kind: str) -> str:
        return f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child></joint>'

    file = tmp_path / "a.sdf"
    inner = f'<model name="m"><link name="b"/><link name="c"/>{joint("weld", "b", "c", "fixed")}</model>'
    file.write_text(
        text('<link name="a"/>' + "".join(joint(f"to_{k}", "a", f"m::{k}", "revolute") for k in "bc") + inner)
    )
    robot = read_robot(file)
    assert [link.joint and link.joint.parent for link in robot.links] == [None, "a", "m::b"]
    assert robot.notes == ("joint 'to_c' closes a loop: it is left out of the tree",)


@pytest.mark.parametrize("word", ["true", "1", "True"])
def test_truth_is_read_as_sdformat_writes_it(tmp_path: Path, word: str) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(
        text(f'<link name="a"><pose degrees="{word}">1 2 3 10 20 30</pose><inertial auto="{word}"/></link>')
    )
    (a,) = read_robot(file).links
    assert a.joint is not None
    assert same(a.joint.placement, pose(1, 2, 3, *np.radians([10, 20, 30])))
    assert a.inertial is None


@pytest.mark.parametrize(
    ("attribute", "says"),
    [
        ('degrees="yes"', "link 'a', pose, degrees is 'yes': it must be true or false"),
        ('rotation_format="quat_wxyz"', "link 'a', pose, rotation_format is 'quat_wxyz': it must be euler_rpy or quat"),
    ],
)
def test_a_pose_that_says_what_it_cannot_is_refused(tmp_path: Path, attribute: str, says: str) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(text(f'<link name="a"><pose {attribute}>1 2 3 1 2 3</pose></link>'))
    with pytest.raises(inertia.ReadError) as fault:
        read_robot(file)
    assert says in str(fault.value)


def test_frames_of_poses_have_another_name_in_old_files(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(
        text(
            '<link name="a"><pose frame="">0 0 1 0 0 1</pose></link><link name="b"><pose frame="a">1 0 0 0 0 0</pose>'
            '</link><joint name="b" type="fixed"><parent>a</parent><child>b</child></joint>'
        )
    )
    b = read_robot(file).links[1]
    assert b.parent == "a"
    assert same(b.placement, pose(1, 0, 0, 0, 0, 0))


def test_a_shape_that_cannot_be_read_is_the_fault_of_that_shape(tmp_path: Path) -> None:
    shapes = [
        "<mesh><uri>https://fuel.gazebosim.org/x.stl</uri></mesh>",
        "<mesh/>",
        "<box/>",
        "<sphere><radius>1_0</radius></sphere>",
        "<cone><radius>1</radius><length>2</length></cone>",
    ]
    file = tmp_path / "a.sdf"
    file.write_text(
        text(f'<link name="a">{"".join(f"<visual><geometry>{each}</geometry></visual>" for each in shapes)}</link>')
    )
    (a,) = read_robot(file).links
    assert [each.shape for each in a.geometries] == [
        "the mesh 'https://fuel.gazebosim.org/x.stl' is not a file: name it by package://, file:// or a path",
        "the mesh has no file name: name it by package://, file:// or a path",
        "link 'a', visual 3, size is '': it must be 3 numbers",
        "link 'a', visual 4, radius is '1_0': it must be numbers",
        Primitive("cone", (1.0, 2.0)),
    ]


def test_included_models_that_cannot_be_had_are_named(tmp_path: Path) -> None:
    file, long = tmp_path / "a.sdf", "x" * 5000
    uris = ["https://fuel.gazebosim.org/1.0/x/models/y", "", long]
    file.write_text(text('<link name="a"/>' + "".join(f"<include><uri>{uri}</uri></include>" for uri in uris)))
    assert [note.rpartition(": ")[2] for note in read_robot(file).notes] == ["it is not there"] * 3
    (tmp_path / "arm.urdf").write_text('<robot name="arm"><link name="a"/></robot>')
    file.write_text(text('<link name="a"/><include><uri>arm.urdf</uri></include>'))
    assert read_robot(file).notes == (
        "the included model 'arm.urdf' is not read: 'arm.urdf' holds no model of SDFormat",
    )
    (tmp_path / "bad.sdf").write_text("<sdf><model")
    file.write_text(text('<link name="a"/><include><uri>bad.sdf</uri></include>'))
    with pytest.raises(inertia.ReadError, match=r"the included model 'bad.sdf': its XML is damaged"):
        read_robot(file)


def test_a_population_is_said_not_to_be_read(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    crowd = '<population name="crowd"><model name="can"><link name="a"/></model></population>'
    file.write_text(f'<sdf version="1.9"><world name="w">{crowd}<model name="m"><link name="b"/></model></world></sdf>')
    robot = read_robot(file)
    assert [link.name for link in robot.links] == ["b"]
    assert robot.notes == ("population 'crowd' is not read: where its models lie is drawn by chance",)


def test_what_is_there_twice_or_without_a_name_is_said(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    inertial = '<inertial><pose relative_to="x"/><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>'
    file.write_text(text(f'<link name="a">{inertial}</inertial><inertial/></link><link/>'))
    assert read_robot(file).notes == (
        "link 'a', inertial is there more than once: the first counts",
        "link 'a', inertial: its pose counts from the link, and relative_to is passed over, as in SDFormat",
        "a link without a name is left out",
    )
    file.write_text(text('<link name="a"/><link name="a"/>'))
    with pytest.raises(inertia.ReadError, match="more than one link is called 'a': give each a name of its own"):
        read_robot(file)


@pytest.mark.parametrize("exponent", ["+" + "0" * 5000, "-" + "0" * 5000 + "1", "0" * 5000])
def test_exponents_of_many_digits_are_read(tmp_path: Path, exponent: str) -> None:
    file = tmp_path / "a.sdf"
    stated = f"<inertial><mass>1</mass><inertia><ixx>1.5e{exponent}</ixx></inertia></inertial>"
    file.write_text(text(f'<link name="a">{stated}</link>'))
    inertial = read_robot(file).links[0].inertial
    assert inertial is not None
    assert inertial.figures[1] == (Figures(2, 2) if "1" in exponent else Figures(1, 2))
    assert inertial.inertia[0, 0] == (0.15 if "1" in exponent else 1.5)


@pytest.mark.parametrize("mass", ["1_000", "\u0661"])
def test_numbers_that_only_python_reads_are_refused(tmp_path: Path, mass: str) -> None:
    file = tmp_path / "a.sdf"
    file.write_text(text(f'<link name="a"><inertial><mass>{mass}</mass></inertial></link>'))
    with pytest.raises(inertia.ReadError, match="it must be numbers"):
        read_robot(file)


def test_a_file_without_a_link_says_what_was_not_read(tmp_path: Path) -> None:
    file = tmp_path / "a.sdf"
    file.write_text('<sdf version="1.9"><world name="w"><include><uri>model://nix</uri></include></world></sdf>')
    with pytest.raises(inertia.ReadError, match="it holds no link: the included model 'model://nix' is not read"):
        read_robot(file)


def test_a_model_that_is_not_there_is_not_the_one_that_includes_it(world: Path) -> None:
    arm = world.parent / "arm"
    (arm / "model.config").write_text("<model><name>arm</name><sdf>model.sdf</sdf></model>")
    (arm / "model.sdf").write_text(text('<link name="upper"/><include><uri>model://nix</uri></include>'))
    robot = read_robot(arm / "model.sdf")
    assert [link.name for link in robot.links] == ["upper"]
    assert "'model://nix' is not read: it is not there" in robot.notes[0]
