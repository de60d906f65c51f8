"""Mass properties that a stage states in part, against what OpenUSD makes of them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import inertia
from inertia.arrays import Float
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.tree import robot_tree, unweighed
from inertia_cli.main import main

STAGE = """#usda 1.0
(metersPerUnit = 1)
def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
{{
    {body}
    def Cube "one" (prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMassAPI"])
    {{
        double size = 1
        double3 xformOp:translate = (1, 0.5, 0)
        float xformOp:rotateZ = 25
        float3 xformOp:scale = (1, 2, 3)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ", "xformOp:scale"]
        {one}
    }}
    {two}
}}
"""
TWO = """def Cube "two" (prepend apiSchemas = ["PhysicsCollisionAPI"])
    {
        double size = 1
        double3 xformOp:translate = (-1, 2, 0.5)
        float3 xformOp:scale = (0.5, 0.5, 2)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
    }"""
MASS, CENTER = "float physics:mass = 6\n", "point3f physics:centerOfMass = (0.1, 0.2, 0.3)\n"
DENSITY, TENSOR = "float physics:density = 500\n", "float3 physics:diagonalInertia = (2, 2.25, 2.5)\n"
AXES = "quatf physics:principalAxes = (0.8, 0.6, 0, 0)\n"


@pytest.fixture(autouse=True)
def _usd() -> None:
    pytest.importorskip("pxr.Usd")


def _of_openusd(file: Path) -> tuple[float, Float, Float]:
    """Return mass, centre of mass and tensor about it that OpenUSD gives the body; what its boxes have it is told."""
    from pxr import Gf, Usd, UsdGeom, UsdPhysics

    stage = Usd.Stage.Open(str(file))
    body = UsdPhysics.RigidBodyAPI(stage.GetPrimAtPath("/a"))
    cache = UsdGeom.XformCache()

    def box(prim: Any) -> Any:
        told = UsdPhysics.RigidBodyAPI.MassInformation()
        x, y, z = (k * k for k in prim.GetAttribute("xformOp:scale").Get())
        told.volume = (x * y * z) ** 0.5
        told.inertia = Gf.Matrix3f(*(np.diag([y + z, x + z, x + y]) * told.volume / 12).ravel().tolist())
        place = cache.ComputeRelativeTransform(prim, body.GetPrim())[0]
        told.localPos = Gf.Vec3f(place.ExtractTranslation())
        told.localRot = Gf.Quatf(place.RemoveScaleShear().ExtractRotationQuat())
        return told

    mass, moments, center, axes = body.ComputeMassProperties(box)
    turn = np.array(Gf.Matrix3d(Gf.Quatd(axes))).T  # of rows
    return mass, np.array(center), turn @ np.diag(moments) @ turn.T


@pytest.mark.parametrize("two", ["", TWO], ids=["one", "two"])
@pytest.mark.parametrize("body", [CENTER, TENSOR, AXES, TENSOR + AXES, CENTER + AXES, ""])
@pytest.mark.parametrize("weight", [MASS, DENSITY, ""], ids=["mass", "density", "neither"])
def test_what_is_stated_in_part_is_taken_as_openusd_takes_it(tmp_path: Path, weight: str, body: str, two: str) -> None:
    _agrees(tmp_path, STAGE.format(body=weight + body, one="", two=two))


@pytest.mark.parametrize("one", [MASS, CENTER, TENSOR, AXES, MASS + TENSOR + AXES, DENSITY + CENTER + TENSOR])
@pytest.mark.parametrize("body", ["", MASS, CENTER, MASS + CENTER, CENTER + TENSOR])
def test_what_collides_is_taken_as_it_states_itself(tmp_path: Path, body: str, one: str) -> None:
    _agrees(tmp_path, STAGE.format(body=body, one=one, two=TWO))


def _agrees(folder: Path, text: str) -> None:
    file = folder / "s.usda"
    file.write_text(text)
    mass, center, tensor = _of_openusd(file)
    whole = inertia.Assembly.from_dict(robot_tree(read_robot(file))[0]).mass_properties()
    assert whole.mass == pytest.approx(mass, rel=1e-6)
    assert whole.center_of_mass == pytest.approx(center, abs=1e-6)
    assert np.abs(whole.inertia - tensor).max() < 5e-5 * np.abs(tensor).max()  # theirs is float32
    assert whole.error.inertia < 1e-12


def test_without_what_collides_the_centre_is_the_origin(tmp_path: Path) -> None:
    file = tmp_path / "s.usda"
    file.write_text(STAGE.format(body=MASS + TENSOR, one="", two="").replace('"PhysicsCollisionAPI", ', ""))
    (link,) = read_robot(file).links
    assert link.inertial is not None
    assert link.inertial.placement.origin.tolist() == [0, 0, 0]
    assert np.diag(link.inertial.inertia).tolist() == [2, 2.25, 2.5]


def test_an_audit_compares_what_is_completed_and_says_what_is_stated(tmp_path: Path) -> None:
    file = tmp_path / "s.usda"
    file.write_text(STAGE.format(body=MASS + CENTER, one="", two=""))
    audit = inertia.audit(file)
    (link,) = audit.links
    assert link.state == "inconsistent"
    assert link.stated is not None
    assert link.stated.center == pytest.approx([0.1, 0.2, 0.3])
    says = "states mass, centre of mass alone: what collides of it has its tensor, about the centre stated"
    assert audit.robot.notes == (f"link 'a' {says}",)


def test_what_collides_and_cannot_be_weighed_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "s.usda"
    capsule = STAGE.replace("Cube", "Capsule").replace("double size = 1", "")
    for body in (MASS + CENTER, MASS):
        file.write_text(capsule.format(body=body, one="", two=""))
        assert main(["assembly", str(file)]) == 4
        assert "link a, one is left out: a Capsule of different scale" in capsys.readouterr().err
    file.write_text(capsule.format(body=CENTER, one="", two=""))
    (finding, *_) = inertia.audit(file).links[0].findings[1:]
    assert finding.code == "mesh_unusable"
    assert "one: a Capsule of different scale" in finding.sentence


def test_a_mass_that_no_shape_has_is_missing_from_the_whole(tmp_path: Path) -> None:
    file = tmp_path / "s.usda"
    file.write_text(STAGE.format(body=MASS + CENTER, one="", two="").replace('"PhysicsCollisionAPI", ', ""))
    assert unweighed(read_robot(file)) == ("link a states a mass of 6 kg, but no shape that has it",)


def test_tensors_of_what_collides_that_no_body_has_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "s.usda"
    file.write_text(STAGE.format(body="", one=TENSOR.replace("2.5", "5"), two=""))
    with pytest.raises(inertia.GeometryError, match="a/one: the inertia tensor is not physical"):
        robot_tree(read_robot(file))
