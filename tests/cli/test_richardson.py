"""`inertia analyse --richardson`: what meshing a STEP file left out is estimated by meshing it twice."""

import json
import math
from pathlib import Path

import pytest
from tests.mesh.readers.step_sample import step_cone, step_sphere

from inertia_cli.main import main
from inertia_meshes import path


def test_the_estimate_is_near_the_error_of_the_ball(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("OCP")
    file = tmp_path / "ball.step"
    file.write_text(step_sphere(20.0))
    assert main(["analyse", str(file), "--density", "1000", "--richardson", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    true = 4 / 3 * math.pi * 0.02**3
    lost = (true - result["volume"]) / result["volume"]
    assert 0 < lost < 3e-3
    assert result["error"]["tessellation"]["volume"] == pytest.approx(lost, rel=0.5)
    file.write_text(step_cone(20.0, 20.0, 20.0))
    assert main(["analyse", str(file), "--richardson"]) == 0
    assert "Richardson estimate" in capsys.readouterr().out


def test_other_files_hold_the_only_mesh_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", str(path("cube.stl")), "--richardson"]) == 2
    assert "only STEP can be meshed coarser" in capsys.readouterr().err


def test_one_answer_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", str(path("cube.stl")), "--richardson", "--chord", "0.1"]) == 2
    assert "give one" in capsys.readouterr().err
