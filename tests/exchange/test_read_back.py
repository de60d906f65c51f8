"""What is written, read back by the program that owns the format."""

import json
import math
import os
import subprocess
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.exchange import solid

import inertia
from inertia_cli.main import main

FINE = 1e-15  # of the norm: the rounding of six elements, and of a product with a rotation
CENTRE = [float(x) for x in solid.CENTRE]
MASS = float(solid.MASS)


@pytest.fixture
def body(tmp_path: Path) -> inertia.MassProperties:
    return solid.properties(tmp_path)


def rotation(w: float, x: float, y: float, z: float) -> np.ndarray:
    """Return the matrix of a quaternion (Goldstein, eq. 4.47 transposed)."""
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def test_the_body_is_the_exact_one(body: inertia.MassProperties) -> None:
    sizes = sorted(abs(solid.TENSOR[i, j]) for i in range(3) for j in range(i + 1))
    assert all(b > 1.02 * a for a, b in pairwise(sizes))
    assert body.mass == pytest.approx(MASS, rel=1e-15)
    assert solid.error(body.inertia) < FINE


def compiled(model: str, name: str) -> tuple[float, np.ndarray, np.ndarray]:
    """Return mass, centre of mass and tensor of a body as MuJoCo compiles it."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(model)
    number = model.body(name).id
    turn = rotation(*model.body_iquat[number])
    return model.body_mass[number], model.body_ipos[number], turn @ np.diag(model.body_inertia[number]) @ turn.T


def test_mujoco_reads_mjcf(body: inertia.MassProperties) -> None:
    mass, centre, tensor = compiled(inertia.export(body, "mjcf", name="arm"), "arm")
    assert mass == body.mass
    assert centre.tolist() == body.center_of_mass.tolist()
    assert solid.error(tensor) < FINE


def test_mujoco_keeps_the_principal_moments(body: inertia.MassProperties) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(inertia.export(body, "mjcf", name="arm"))
    assert sorted(model.body_inertia[1].tolist()) == body.principal_moments.tolist()


def test_what_mujoco_refuses_for_its_size_is_said(body: inertia.MassProperties) -> None:
    mujoco = pytest.importorskip("mujoco")
    for mass in (1e-12, 1e-14):
        text = inertia.export(body.with_mass(mass), "mjcf", name="dust")
        smallest = body.with_mass(mass).principal_moments[0]
        assert ("MuJoCo refuses dust" in text) == (smallest < 1e-15)
        if smallest < 1e-15:
            with pytest.raises(ValueError, match="mjMINVAL"):
                mujoco.MjModel.from_xml_string(text)
        else:
            mujoco.MjModel.from_xml_string(text)


def test_mujoco_reads_urdf(body: inertia.MassProperties) -> None:
    # A root becomes the world, and what is fixed to it is merged into it: let it float.
    text = inertia.export({"arm": body, "hand": body.with_mass(1.0)}, "urdf").replace('"fixed"', '"floating"')
    mass, centre, tensor = compiled(text, "arm")
    assert (mass, centre.tolist()) == (body.mass, body.center_of_mass.tolist())
    assert solid.error(tensor) < 1e-14  # it diagonalises by itself
    assert compiled(text, "hand")[0] == 1.0


@pytest.mark.parametrize("thickness", [1e-7, 1e-9, 1e-12])
def test_mujoco_takes_flat_bodies(thickness: float) -> None:
    i1, i2 = 1.0 + thickness**2, 0.7 + thickness**2
    third = math.nextafter(i1 + i2, 0.0) if thickness < 1e-8 else 1.7
    flat = inertia.MassProperties(1.0, 0.0, [0, 0, 0], np.diag([i1, i2, math.nextafter(third, 2.0)]))
    turned = flat.expressed_in(rotation(0.5, 0.5, -0.5, 0.5))
    assert compiled(inertia.export(turned, "mjcf"), "part")[0] == 1.0


@pytest.mark.parametrize("thickness", [0.1, 1e-6, 1e-8, 1e-9, 1e-12])
def test_flat_bodies_that_mujoco_may_refuse_in_urdf_are_said(thickness: float) -> None:
    mujoco = pytest.importorskip("mujoco")
    refused = 0
    for angle in range(20):
        sheet = np.diag([0.7 + thickness**2, 1.0 + thickness**2, 1.7])
        flat = inertia.MassProperties(1.0, 0.0, [0, 0, 0], sheet).expressed_in(
            Rotation.from_rotvec([angle, 1, 2]).as_matrix()
        )
        text = inertia.export(flat, "urdf", name="sheet")
        assert ("MuJoCo may refuse sheet" in text) == (thickness < 1e-7)
        try:
            mujoco.MjModel.from_xml_string(text)
        except ValueError:
            refused += 1
    assert (refused > 0) <= (thickness < 1e-7)


def test_pinocchio_reads_urdf(body: inertia.MassProperties) -> None:
    pin = pytest.importorskip("pinocchio")
    model = pin.buildModelFromXML(inertia.export(body, "urdf", name="arm"), pin.JointModelFreeFlyer())
    read = model.inertias[1]
    assert (read.mass, read.lever.tolist()) == (body.mass, body.center_of_mass.tolist())
    assert solid.error(read.inertia) < FINE


def test_pinocchio_takes_the_tensor_as_its_row_says(body: inertia.MassProperties) -> None:
    pin = pytest.importorskip("pinocchio")
    there = pin.Inertia(body.mass, body.center_of_mass, body.inertia).matrix()[3:, 3:]
    assert np.allclose(there, body.about([0, 0, 0]), rtol=0, atol=FINE * np.linalg.norm(there))


def test_yourdfpy_reads_urdf(body: inertia.MassProperties, tmp_path: Path) -> None:
    yourdfpy = pytest.importorskip("yourdfpy")
    file = tmp_path / "arm.urdf"
    file.write_text(inertia.export(body, "urdf", name="arm"))
    (link,) = yourdfpy.URDF.load(str(file), build_scene_graph=False, load_meshes=False).robot.links
    assert link.inertial.mass == body.mass
    assert link.inertial.origin.tolist() == [*np.c_[np.eye(3), body.center_of_mass].tolist(), [0, 0, 0, 1]]
    assert solid.error(link.inertial.inertia) < FINE


@pytest.mark.parametrize("target", ["urdf", "sdf"])
def test_drake_reads(body: inertia.MassProperties, target: str) -> None:
    plants = pytest.importorskip("pydrake.multibody.plant")
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    plant = plants.MultibodyPlant(0.0)
    parsing.Parser(plant).AddModelsFromString(inertia.export(body, target, name="arm"), target)
    spatial = plant.GetBodyByName("arm").default_spatial_inertia()
    assert spatial.get_mass() == body.mass
    assert np.allclose(spatial.get_com(), body.center_of_mass, rtol=1e-15, atol=0)
    central = spatial.Shift(spatial.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    assert solid.error(central) < 1e-13  # it keeps the tensor about the origin, per kg


def test_drake_runs_what_is_written_for_it(body: inertia.MassProperties) -> None:
    pytest.importorskip("pydrake.multibody.tree")
    names: dict = {}
    exec(inertia.export(body, "drake", name="upper arm"), names)
    spatial = names["upper_arm"]
    about_origin = spatial.CalcRotationalInertia().CopyToFullMatrix3()
    exact = body.about([0, 0, 0])
    assert spatial.get_mass() == body.mass
    assert np.linalg.norm(about_origin - exact) < FINE * np.linalg.norm(exact)


def test_openusd_reads(body: inertia.MassProperties) -> None:
    usd = pytest.importorskip("pxr.Usd")
    geometry, physics = pytest.importorskip("pxr.UsdGeom"), pytest.importorskip("pxr.UsdPhysics")
    stage = usd.Stage.CreateInMemory()
    assert stage.GetRootLayer().ImportFromString(inertia.export(body, "usd", name="upper arm"))
    assert geometry.GetStageMetersPerUnit(stage) == 1
    assert physics.GetStageKilogramsPerUnit(stage) == 1
    prim = stage.GetDefaultPrim()
    assert prim.HasAPI(physics.RigidBodyAPI)
    assert prim.HasAPI(physics.MassAPI)
    api = physics.MassAPI(prim)
    axes = api.GetPrincipalAxesAttr().Get()
    turn = rotation(axes.GetReal(), *axes.GetImaginary())
    assert api.GetMassAttr().Get() == np.float32(body.mass)
    assert list(api.GetCenterOfMassAttr().Get()) == body.center_of_mass.astype(np.float32).tolist()
    assert solid.error(turn @ np.diag(api.GetDiagonalInertiaAttr().Get()) @ turn.T) < 4e-7


def test_openusd_gets_a_flat_body_that_keeps_the_triangle_rule() -> None:
    usd, physics = pytest.importorskip("pxr.Usd"), pytest.importorskip("pxr.UsdPhysics")
    stage = usd.Stage.CreateInMemory()
    for k in range(1, 40):
        flat = inertia.MassProperties(1.0, 0.0, [0, 0, 0], np.diag([0.1 + k / 300, 0.7, 0.8 + k / 300]))
        assert stage.GetRootLayer().ImportFromString(inertia.export(flat, "usd"))
        first, second, third = sorted(physics.MassAPI(stage.GetDefaultPrim()).GetDiagonalInertiaAttr().Get())
        assert first + second >= third


def test_pynastran_reads(body: inertia.MassProperties, tmp_path: Path) -> None:
    python = os.environ.get("PYNASTRAN_PYTHON")
    if python is None:
        pytest.skip("pyNastran needs NumPy 1: name a Python that has it in PYNASTRAN_PYTHON")
    deck, script = tmp_path / "arm.bdf", tmp_path / "read.py"
    deck.write_text(inertia.export(body, "nastran", name="arm"))
    script.write_text(
        "import json, sys\n"
        "from pyNastran.bdf.bdf import BDF\n"
        "model = BDF(debug=None)\n"
        "model.read_bdf(sys.argv[1], punch=True)\n"
        "(card,) = model.masses.values()\n"
        "print(json.dumps([card.Mass(), list(card.Centroid()), [list(row) for row in card.Inertia()]]))\n"
    )
    done = subprocess.run([python, "-E", script, deck], check=True, capture_output=True, text=True)
    mass, centre, tensor = json.loads(done.stdout.splitlines()[-1])
    assert mass == pytest.approx(MASS, rel=1e-13)
    assert centre == pytest.approx(CENTRE, rel=1e-12)
    assert solid.error(tensor) < 1e-12


def test_a_mesh_goes_through_the_command_into_a_simulator(tmp_path: Path) -> None:
    model = tmp_path / "arm.xml"
    mesh = str(solid.file(tmp_path))
    arguments = ["analyse", mesh, "--unit", "m", "--density", "2700", "--as", "mjcf", "-o", str(model)]
    assert main(arguments) == 0
    mass, centre, tensor = compiled(model.read_text(), "upper arm")
    assert mass == pytest.approx(MASS, rel=1e-15)
    assert centre == pytest.approx(CENTRE, rel=1e-15)
    assert solid.error(tensor) < FINE
