"""Stages of OpenUSD: units, frames, meshes and primitives; what is written comes back."""

import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.exchange import solid

import inertia
from inertia.exchange.robots.links import Link, Primitive
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.tree import robot_tree
from inertia.mesh.part import Part
from inertia.mesh.tree import determinant
from inertia_cli.main import main

POINTS = "[(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), (0, 0, 3), (2, 0, 3), (2, 1, 3), (0, 1, 3)]"
QUADS = "[0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7]"
STAGE = f"""#usda 1.0
(
    defaultPrim = "arm"
    metersPerUnit = 0.01
    kilogramsPerUnit = 0.001
)
def Xform "arm"
{{
    double3 xformOp:translate = (5, 6, 7)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Xform "base" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {{
        double3 xformOp:scale = (2, 2, 2)
        double xformOp:rotateZ = 90
        uniform token[] xformOpOrder = ["xformOp:rotateZ", "xformOp:scale"]
        point3f physics:centerOfMass = (1, 0.5, 1.5)
        float3 physics:diagonalInertia = (2, 3, 4)
        float physics:mass = 500
        quatf physics:principalAxes = (0.5, 0.5, 0.5, 0.5)
        def Mesh "brick"
        {{
            int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
            int[] faceVertexIndices = {QUADS}
            point3f[] points = {POINTS}
            uniform token subdivisionScheme = "none"
        }}
        def Mesh "mirrored"
        {{
            double3 xformOp:scale = (-1, 1, 1)
            uniform token[] xformOpOrder = ["xformOp:scale"]
            int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
            int[] faceVertexIndices = {QUADS}
            point3f[] points = {POINTS}
        }}
        def Mesh "inside_out"
        {{
            uniform token orientation = "leftHanded"
            int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
            int[] faceVertexIndices = [1, 2, 3, 0, 7, 6, 5, 4, 4, 5, 1, 0, 5, 6, 2, 1, 6, 7, 3, 2, 7, 4, 0, 3]
            point3f[] points = {POINTS}
        }}
        def Xform "tip" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
        {{
            double3 xformOp:translate = (0, 0, 10)
            uniform token[] xformOpOrder = ["xformOp:translate"]
            def Cube "box" (prepend apiSchemas = ["PhysicsCollisionAPI"])
            {{
                double3 xformOp:translate = (1, 2, 3)
                double3 xformOp:scale = (1, 2, 3)
                uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
                double size = 1
            }}
            def Sphere "egg"
            {{
                double3 xformOp:scale = (1, 2, 3)
                uniform token[] xformOpOrder = ["xformOp:scale"]
                double radius = 0.5
            }}
            def Sphere "ball"
            {{
                double radius = 0.5
            }}
            def Cylinder "pin"
            {{
                uniform token axis = "X"
                double radius = 0.25
                double height = 4
            }}
            def Capsule "pill"
            {{
                double3 xformOp:scale = (1, 2, 3)
                uniform token[] xformOpOrder = ["xformOp:scale"]
            }}
            def Cone "hat"
            {{
            }}
            def Sphere "handle"
            {{
                uniform token purpose = "guide"
            }}
        }}
    }}
    def PhysicsFixedJoint "glue"
    {{
        rel physics:body0 = </arm/base>
        rel physics:body1 = </arm/base/tip>
    }}
}}
"""


@pytest.fixture(autouse=True)
def _usd() -> None:
    pytest.importorskip("pxr.Usd")


@pytest.fixture
def links(tmp_path: Path) -> list[Link]:
    file = tmp_path / "arm.usda"
    file.write_text(STAGE)
    return list(read_robot(file).links)


def test_what_is_stated_is_in_si(links: list[Link]) -> None:
    base, tip = links
    inertial = base.inertial
    assert inertial is not None
    assert inertial.mass == pytest.approx(0.5)
    assert inertial.placement.origin == pytest.approx([0.02, 0.01, 0.03])  # scaled by 2, in metres, not turned
    assert np.diag(inertial.inertia) == pytest.approx([2e-7, 3e-7, 4e-7])
    turned = inertial.placement.rotation
    assert np.allclose(turned, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-7)
    assert tip.inertial is None


def test_meshes_are_in_the_axes_of_their_link(links: list[Link]) -> None:
    for geometry, low, high in zip(
        links[0].geometries, ([0, 0, 0], [-4, 0, 0], [0, 0, 0]), ([4, 2, 6], [0, 2, 6], [4, 2, 6]), strict=True
    ):
        assert isinstance(geometry.shape, Part)
        assert geometry.transform is not None
        corners = geometry.shape.triangles.corners().reshape(-1, 3)
        corners = corners @ np.array(geometry.transform.linear, float).T + np.array(geometry.transform.at, float)
        assert np.allclose([100 * corners.min(axis=0), 100 * corners.max(axis=0)], [low, high], atol=1e-12)
        assert inertia.mass_properties(geometry.shape, 1.0).volume == 6  # in its own axes, wound outwards
        assert abs(determinant(geometry.transform.linear)) == Fraction(8, 10**6)


def test_primitives_and_where_they_lie(links: list[Link]) -> None:
    box, egg, ball, pin, pill, hat = links[1].geometries
    assert [each.role for each in links[1].geometries] == ["collision", *["visual"] * 5]
    assert box.shape == Primitive("box", pytest.approx((0.02, 0.04, 0.06)))
    assert box.placement.origin == pytest.approx([0.02, 0.04, 0.06])
    assert egg.shape == Primitive("ellipsoid", pytest.approx((0.01, 0.02, 0.03)))
    assert ball.shape == Primitive("sphere", pytest.approx((0.01,)))
    assert pin.shape == Primitive("cylinder", pytest.approx((0.005, 0.08)))
    assert pin.placement.rotation[:, 2] == pytest.approx([1, 0, 0])
    assert pill.shape == "a Capsule of different scale along its axes cannot be weighed"
    assert hat.shape == Primitive(
        "cone", pytest.approx((0.02, 0.04))
    )  # of radius 1 and height 2, in a body twice as large


@pytest.mark.parametrize("hidden", ['uniform token purpose = "proxy"', 'token visibility = "invisible"'])
def test_what_is_not_shown_is_not_weighed(tmp_path: Path, hidden: str) -> None:
    stage = tmp_path / "s.usda"
    stage.write_text(STAGE.replace('uniform token purpose = "guide"', hidden))
    assert len(read_robot(stage).links[1].geometries) == 6


def test_a_cone_by_hand(tmp_path: Path) -> None:
    """Radius 1 and height 4: 3/20 m r² + 3/80 m h² across, 3/10 m r² along, the centre h/4 above the base."""
    stage = tmp_path / "s.usda"
    stage.write_text("""#usda 1.0
(metersPerUnit = 1)
def Xform "hat" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
{
    float physics:mass = 10
    point3f physics:centerOfMass = (-1, 0, 0)
    float3 physics:diagonalInertia = (3, 7.5, 7.5)
    quatf physics:principalAxes = (1, 0, 0, 0)
    def Cone "cone"
    {
        uniform token axis = "X"
        double height = 4
    }
    def Sphere "knob" (prepend apiSchemas = ["PhysicsMassAPI"])
    {
        uniform token purpose = "guide"
    }
}
""")
    result = inertia.audit(stage)
    assert result.links[0].state == "consistent"
    assert result.robot.notes == ("what 'knob' below 'hat' states of itself is not counted",)


def test_fixed_joints_hang_links_together(links: list[Link]) -> None:
    base, tip = links
    assert (base.parent, tip.parent) == (None, "base")
    assert tip.placement.origin == pytest.approx([0, 0, 0.2])
    assert np.allclose(tip.placement.rotation, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd"])
def test_what_is_written_is_read(tmp_path: Path, suffix: str) -> None:
    body = solid.properties(tmp_path)
    text, file = tmp_path / "text.usda", tmp_path / f"arm{suffix}"
    text.write_text(inertia.export({"arm": body, "hand": body.with_mass(2.0)}, "usd"))
    pytest.importorskip("pxr.Usd").Stage.Open(str(text)).Export(str(file))
    arm, hand = read_robot(file).links
    assert arm.inertial is not None
    assert hand.inertial is not None
    where = arm.inertial.placement
    assert arm.inertial.mass == pytest.approx(float(solid.MASS), rel=1e-7)
    assert hand.inertial.mass == 2.0
    assert where.origin == pytest.approx([float(k) for k in solid.CENTRE], rel=1e-7)
    assert solid.error(where.rotation @ arm.inertial.inertia @ where.rotation.T) < 4e-7


def test_a_stage_goes_through_the_audit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # 2 × 1 × 3 units of 1 cm: 6 cm³; steel, doubled along each axis by the prim's scale: 0.3768 kg.
    m, a, b, c = 7850 * 48e-6, 0.04, 0.02, 0.06
    moments = [m / 12 * (b * b + c * c), m / 12 * (a * a + c * c), m / 12 * (a * a + b * b)]
    stated = STAGE.replace("(2, 3, 4)", f"({', '.join(repr(k * 1e7) for k in moments)})")
    stated = stated.replace("500", repr(m * 1000)).replace("(0.5, 0.5, 0.5, 0.5)", "(1, 0, 0, 0)")
    for name in ("mirrored", "inside_out"):
        stated = stated.replace(f'def Mesh "{name}"', f'def Xform "{name}"')
    file = tmp_path / "arm.usda"
    file.write_text(stated)
    assert main(["audit", str(file), "--density", "7850"]) == 0
    assert "base  0.3768 kg" in capsys.readouterr().out


def test_gaps_are_said(tmp_path: Path) -> None:
    file = tmp_path / "arm.usda"
    file.write_text(STAGE.replace("float3 physics:diagonalInertia = (2, 3, 4)", ""))
    robot = read_robot(file)
    assert robot.links[0].inertial is None
    assert "link 'base' states no tensor, and nothing collides of it" in robot.notes
    assert "meshes are taken as their points have them: no subdivision is applied" in robot.notes


def test_what_openusd_warns_of_is_a_note_that_is_the_same_in_every_run(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "arm.usda"
    arcs = [f'def "w{k}" (references = [</nix>, </arm/base>]) {{}}' for k in range(8)]
    file.write_text(STAGE.replace('def Mesh "brick"', "\n".join([*arcs, 'def Mesh "brick"'])))
    said = [note for note in read_robot(file).notes if note.startswith("OpenUSD warns: ")]
    assert len(said) == 16  # nothing is called so, and a prim that would hold itself
    assert said == sorted(said)
    assert "0x" not in "".join(said)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(\n    defaultPrim", "(\n    subLayers = [@./nix.usda@]\n    defaultPrim"),
        ('def Mesh "brick"', 'def "bolt" (references = @./nix.usda@) {}\ndef Mesh "brick"'),
        ('def Mesh "brick"', 'over "bolt" (payload = @./nix.usda@) {}\ndef Mesh "brick"'),
        ('def Mesh "brick"', 'def "bolt" (references = @./there.usda@\ninstanceable = true) {}\ndef Mesh "brick"'),
    ],
)
def test_what_a_stage_refers_to_has_to_be_there_where_it_is_active(tmp_path: Path, old: str, new: str) -> None:
    file, stage = tmp_path / "arm.usda", STAGE.replace(old, new, 1)
    there = '#usda 1.0\n(defaultPrim = "a")\ndef "a" {\ndef "b" (references = @./nix.usda@) {}\n}'
    (tmp_path / "there.usda").write_text(there)
    file.write_text(stage)
    with pytest.raises(inertia.ReadError, match=rf"cannot read {file}: OpenUSD says: .*{tmp_path}/nix.usda@.*put a "):
        read_robot(file)
    if "bolt" in new:
        file.write_text(stage.replace("usda@", "usda@\nactive = false", 1))
        assert read_robot(file).notes
    (tmp_path / "nix.usda").write_text('#usda 1.0\n(defaultPrim = "b")\ndef "b" {}')
    file.write_text(stage)
    assert not any("OpenUSD" in note for note in read_robot(file).notes)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (STAGE.replace("float physics:mass = 500", "float physics:mass = nan"), "what /arm/base states is not finite"),
        (STAGE.replace("float physics:mass = 500", 'string physics:mass = "x"'), "another type than its schema"),
        (STAGE.replace("}", "", 1), "OpenUSD cannot open it: "),
        ("#usda 1.0\n", "no prim of it has PhysicsRigidBodyAPI or PhysicsMassAPI: apply one to each body"),
        (STAGE.replace("metersPerUnit = 0.01", "metersPerUnit = 0"), "its units are 0 m"),
    ],
)
def test_faults(tmp_path: Path, capfd: pytest.CaptureFixture[str], text: str, says: str) -> None:
    file = tmp_path / "arm.usda"
    file.write_text(text)
    with pytest.raises(inertia.ReadError, match=f"cannot read {file}") as fault:
        read_robot(file)
    assert says in str(fault.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[4, 4, 4, 4, 4, 4]", "[4, 4, 4, 4, 4]", "do not add up"),
        ("[4, 4, 4, 4, 4, 4]", "[4, 4, 4, 4, 4, 2, 2]", "do not add up"),
        ("(2, 1, 3), (0, 1, 3)]", "(2, 1, 3)]", "beyond the 7 there are"),
    ],
)
def test_a_broken_mesh_says_why(tmp_path: Path, old: str, new: str, says: str) -> None:
    file = tmp_path / "arm.usda"
    file.write_text(STAGE.replace(old, new))
    shape = read_robot(file).links[0].geometries[0].shape
    assert isinstance(shape, str)
    assert says in shape


def test_without_its_package_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "arm.usda"
    file.write_text(STAGE)
    monkeypatch.setitem(sys.modules, "pxr", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(inertia.ReadError, match=r"pip install 'inertia\[usd\]'"):
        read_robot(file)


@pytest.mark.parametrize("digits", [17, 9, 8, 7, 6, 5, 4])
def test_a_matrix_of_any_digits_places_a_body_as_a_rotation(tmp_path: Path, digits: int) -> None:
    rotation = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
    rows = [(*(round(k, digits) for k in row), 0) for row in rotation.T.tolist()]
    file = tmp_path / "s.usda"
    file.write_text(
        "#usda 1.0\n(metersPerUnit = 1)\n"
        'def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {\n'
        f"matrix4d xformOp:transform = ({rows[0]}, {rows[1]}, {rows[2]}, (1, 2, 3, 1))\n"
        'uniform token[] xformOpOrder = ["xformOp:transform"]\nfloat physics:mass = 2\n'
        "point3f physics:centerOfMass = (0.5, 0.25, -1)\nfloat3 physics:diagonalInertia = (1, 2, 2.5)\n}\n"
    )
    properties = inertia.Assembly.load(file).mass_properties()
    tolerance = 10.0**-digits + 1e-14
    assert properties.center_of_mass == pytest.approx(rotation @ [0.5, 0.25, -1] + [1, 2, 3], abs=tolerance)
    assert properties.inertia == pytest.approx(rotation @ np.diag([1, 2, 2.5]) @ rotation.T, abs=5 * tolerance)


TWO = """#usda 1.0
(metersPerUnit = 1)
def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {{
    {a}
}}
def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {{
    {b}
}}
def PhysicsFixedJoint "glue"
{{
    rel physics:body0 = </a>
    rel physics:body1 = </b>
    {joint}
}}
"""


@pytest.mark.parametrize(
    ("says", "parent"), [("", "a"), ("bool physics:jointEnabled = 1", "a"), ("bool physics:jointEnabled = 0", None)]
)
def test_a_joint_that_is_not_enabled_fixes_nothing(tmp_path: Path, says: str, parent: str | None) -> None:
    stage = tmp_path / "s.usda"
    stage.write_text(TWO.format(a="", b="", joint=says))
    assert [link.parent for link in read_robot(stage).links] == [None, parent]


def test_later_cylinders_and_capsules_are_read_where_their_ends_are_alike(tmp_path: Path) -> None:
    stage = tmp_path / "s.usda"
    radii = "double radiusTop = 0.25\ndouble radiusBottom = {}\ndouble height = 4\n"
    alike = radii.format(0.25)
    a = f'def Cylinder_1 "pin" {{\n{alike}}}\ndef Capsule_1 "pill" {{\n{alike}}}'
    stage.write_text(TWO.format(a=a, b=f'def Cylinder_1 "shaft" {{\n{radii.format(0.5)}}}', joint=""))
    a, b = read_robot(stage).links
    assert [each.shape for each in a.geometries] == [Primitive("cylinder", (0.25, 4)), Primitive("capsule", (0.25, 4))]
    assert b.geometries[0].shape == "a Cylinder_1 of two radii cannot be weighed"


def test_what_is_passed_over_is_said(tmp_path: Path) -> None:
    stage = tmp_path / "s.usda"
    stage.write_text(TWO.format(a='def TetMesh "gel" {}', b="bool physics:rigidBodyEnabled = 0", joint=""))
    assert read_robot(stage).notes == (
        "'gel' below 'a' is left out: a TetMesh is not read",
        "'b' is not enabled as a rigid body: it is counted as one",
    )


BODY = """#usda 1.0
(metersPerUnit = 0.01
 kilogramsPerUnit = 0.001)
def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
{{
    {body}
    def Cube "one" (prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMassAPI", "MaterialBindingAPI"])
    {{
        double size = 100
        {one}
    }}
    def Mesh "two" (prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMassAPI", "PhysicsMeshCollisionAPI"])
    {{
        point3f[] points = [(50, -50, -50), (150, -50, -50), (50, 50, -50), (150, 50, -50),
                            (50, -50, 50), (150, -50, 50), (50, 50, 50), (150, 50, 50)]
        int[] faceVertexCounts = {counts}
        int[] faceVertexIndices = {indices}
        uniform token subdivisionScheme = "none"
        {two}
    }}
    def Sphere "shown" {{
    }}
}}
def Material "steel" (prepend apiSchemas = ["PhysicsMaterialAPI"])
{{
    float physics:density = 0.3
}}
"""
CLOSED = {
    "counts": "[4, 4, 4, 4, 4, 4]",
    "indices": "[0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]",
}
POINTS = {
    "counts": "[4, 4]",
    "indices": "[0, 2, 3, 1, 4, 5, 7, 6]",
    "two": 'uniform token physics:approximation = "convexHull"',
}


@pytest.mark.parametrize(
    ("stated", "masses"),
    [
        ({}, (1000.0, 1000.0)),
        (POINTS, (1000.0, 1000.0)),
        ({"body": "float physics:mass = 10000"}, (5.0, 5.0)),
        ({"body": "float physics:density = 0.5"}, (500.0, 500.0)),
        ({"body": "float physics:density = 0.5", "one": "float physics:density = 0.1"}, (100.0, 500.0)),
        ({"body": "float physics:mass = 10000", "one": "float physics:density = 3"}, (7.5, 2.5)),
        ({"body": "float physics:mass = 10000", "one": "float physics:mass = 9000"}, (90 / 1009, 10000 / 1009)),
        ({"one": "float physics:mass = 9000", "two": "float physics:density = 0.2"}, (9.0, 200.0)),
        ({"one": "rel material:binding:physics = </steel>"}, (300.0, 1000.0)),
        ({"one": "rel material:binding:physics = </steel>\nfloat physics:density = 0.1"}, (100.0, 1000.0)),
    ],
)
def test_bodies_without_a_tensor_weigh_what_collides_of_them(
    tmp_path: Path, stated: dict[str, str], masses: tuple[float, float]
) -> None:
    """Two cubes of 1 m side by side, by the rules of UsdPhysics: lengths are in cm here, masses in g."""
    stage = tmp_path / "s.usda"
    stage.write_text(BODY.format(**{"body": "", "one": "", "two": "", **CLOSED, **stated}))
    tree, _ = robot_tree(read_robot(stage))
    whole = inertia.Assembly.from_dict(tree).mass_properties()
    a, b = masses
    assert whole.mass == pytest.approx(a + b, rel=1e-7)  # float32 in the file
    assert whole.center_of_mass == pytest.approx([b / (a + b), 0, 0], abs=1e-7)
    beside = (a + b) / 6 + a * b / (a + b)
    assert np.diag(whole.inertia) == pytest.approx([(a + b) / 6, beside, beside], rel=1e-7)


def test_what_cannot_be_weighed_is_refused_by_name_or_said(tmp_path: Path) -> None:
    stage = tmp_path / "s.usda"
    stage.write_text(BODY.format(body="", one="", **{**POINTS, "two": ""}))
    with pytest.raises(inertia.GeometryError, match=r"a/two: open: .*solids only"):
        robot_tree(read_robot(stage))
    stage.write_text(
        TWO.format(a="", b="float physics:mass = 3", joint="").replace("BodyAPI", 'BodyAPI", "PhysicsMassAPI')
    )
    notes = robot_tree(read_robot(stage))[1]
    assert "link b states a mass of 3 kg, but no shape that has it: it is a group; give it a file or a mass" in notes
