"""What the bounds of parts do to the motion of a body that is made of them: against motions with other parts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import inertia
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint, JointedPart
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings, Start
from inertia_meshes import path

BOUNDS = (3e-7, 2e-7, 4e-7)


def scene_of(parts: list[JointedPart]) -> Scene:
    body = SceneBody.of_assembly(JointedBody(tuple(parts)))
    return Scene(body, Start([0.3, 2.0, 0.1], "part"), Settings(3.0, 4, 1e-4))


@pytest.mark.parametrize("turns", [2.5, 0.0])
def test_the_bounds_of_parts_are_a_bound_of_the_motion(turns: float) -> None:
    """Of a body whose joint moves, and of one whose joint stands still, which is rigid."""
    joint = Joint(axis=[1.0, 1.0, 0.0], times=[0.0, 2.0], angles=[0.5, 0.5 + turns], point=[0.2, 0.0, 0.0])
    parts = [
        JointedPart("trunk", 3.0, np.diag([1.0, 2.0, 2.5]), bounds=BOUNDS),
        JointedPart("arm", 1.0, np.diag([0.1, 0.2, 0.25]), [0.7, 0.1, 0.0], "trunk", (joint,), BOUNDS),
    ]
    run = inertia.simulate(scene_of(parts))
    random, largest = np.random.default_rng(3), 0.0
    for _ in range(12):
        others = []
        for part in parts:
            place, tensor = random.normal(size=3), random.normal(size=(3, 3))
            tensor = tensor + tensor.T
            others.append(
                replace(
                    part,
                    mass=part.mass + random.choice([-1.0, 1.0]) * BOUNDS[0],
                    center_of_mass=part.center_of_mass + BOUNDS[1] * place / np.linalg.norm(place),
                    inertia=part.inertia + BOUNDS[2] * tensor / np.linalg.norm(tensor),
                    bounds=(0.0, 0.0, 0.0),
                )
            )
        moved = inertia.simulate(scene_of(others)).attitude
        largest = max(largest, float(quaternion.angle_between(moved, run.attitude).max()))
    assert largest < run.error.inputs < 60.0 * largest


def test_a_mesh_on_a_joint_counts_with_its_bound(tmp_path: Path) -> None:
    table = {
        "part": [
            {"name": "body", "part": str(path("sphere.stl")), "density": 1000.0, "unit": "m"},
            {
                "name": "arm",
                "part": str(path("box.stl")),
                "density": 1000.0,
                "unit": "m",
                "parent": "body",
                "joint": [{"axis": [0.0, 1.0, 0.0], "times": [0.0, 1.0], "angles": [0.0, 1.0]}],
            },
        ],
        "start": {"angular_velocity": [0.1, 0.5, 1.0], "frame": "part"},
        "run": {"duration": 2.0, "samples": 3},
    }
    run = inertia.simulate(Scene.from_dict(table, tmp_path))
    assert 1e-17 < run.error.inputs < 1e-11


def test_an_assembly_has_bounds_and_standard_uncertainties_apart(tmp_path: Path) -> None:
    boxes = """unit = "m"
    [[part]]
    name = "a"
    shape = "box"
    size = [1, 2, 3]
    mass = "3±0.03"
    [[part]]
    name = "b"
    shape = "box"
    size = [1, 1, 1]
    mass = "1±0.04"
    at = [-3, 0, 0]
    """
    (tmp_path / "tree.toml").write_text(boxes, encoding="utf-8")
    table = {
        "body": {"part": "tree.toml"},
        "start": {"angular_velocity": [0.1, 5.0, 0.2], "frame": "part"},
        "run": {"duration": 4.0, "samples": 3},
    }
    scene = Scene.from_dict(table, tmp_path)
    covariance = scene.body.covariance
    assert covariance is not None
    assert np.sqrt(covariance[1, 1]) == pytest.approx(0.05, rel=1e-12)  # √(0.03² + 0.04²) kg
    # x = −3 m_b/(m_a + m_b): ∂x/∂m_a = 3/16, ∂x/∂m_b = −9/16
    assert np.sqrt(covariance[2, 2]) == pytest.approx(np.hypot(0.03 * 3 / 16, 0.04 * 9 / 16), rel=1e-12)
    # I_yy = own + (m_a m_b/(m_a + m_b)) 3²: ∂/∂m_a = 10/12 + 9/16, ∂/∂m_b = 2/12 + 81/16
    spread = np.hypot(0.03 * (10 / 12 + 9 / 16), 0.04 * (2 / 12 + 81 / 16))
    assert np.sqrt(covariance[6, 6]) == pytest.approx(spread, rel=1e-12)
    run = inertia.simulate(scene)
    assert run.error.inputs < 1e-20
    assert any("states standard uncertainties, which make 0.05 kg of its mass" in each for each in run.warnings)
