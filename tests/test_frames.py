"""Results become data frames, and data frames arguments: with pandas and polars themselves."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import inertia
from inertia_meshes import path

LIBRARIES = ("pandas", "polars")


@pytest.fixture(params=LIBRARIES)
def library(request: pytest.FixtureRequest) -> Any:
    return pytest.importorskip(request.param, reason=f"{request.param} is not installed")


def test_the_rows_of_a_batch_are_a_frame(library: Any) -> None:
    rows = inertia.batch([path("cube.stl"), path("broken/missing_face.stl")], jobs=1)
    frame = library.DataFrame(rows)
    assert [Path(name).name for name in frame["path"]] == ["cube.stl", "missing_face.stl"]
    assert frame["state"].to_list() == ["answered", "refused"]
    assert str(frame["volume"].dtype).lower() == "float64"


def test_many_bodies_are_a_frame(library: Any) -> None:
    corners = np.vstack([np.zeros(3), np.eye(3)])
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    densities = library.DataFrame({"density": [6.0, 12.0, 6.0]})["density"]
    many = inertia.many([corners, corners, -corners], faces, densities)
    frame = library.DataFrame(many.columns)
    assert len(frame) == 3
    assert frame["mass"].to_list()[:2] == [1.0, 2.0]
    assert [math.isnan(frame["mass"][2]), "inside out" in frame["refusal"][2]] == [True, True]
    assert frame["ixy"].to_numpy()[:2].tolist() == many.inertia[:2, 0, 1].tolist()
    assert frame["com_z"].to_numpy()[:2].tolist() == many.center_of_mass[:2, 2].tolist()


def test_the_samples_of_a_run_are_a_frame(library: Any, tmp_path: Path) -> None:
    run = inertia.simulate(inertia.Scene.load(path("scenes/t_handle.toml")))
    frame = library.DataFrame(run.columns)
    assert frame["time"].to_numpy().tolist() == run.time.tolist()
    assert frame["attitude_w"].to_numpy().tolist() == run.attitude[:, 3].tolist()
    run.to_csv(tmp_path / "run.csv")
    assert (tmp_path / "run.csv").read_text().splitlines()[1].split(",") == list(frame.columns)


def test_a_budget_is_a_frame(library: Any) -> None:
    budget = inertia.Assembly.load(path("assemblies/cubesat.toml")).budget()
    frame = library.DataFrame(budget.columns)
    assert len(frame) == sum(1 for _ in budget.total.lines())
    assert frame["predicted_mass"][0] == budget.total.predicted_mass
    assert frame["u_izz"].to_list() == [float(line.sigma.inertia[2, 2]) for line in budget.total.lines()]


def test_columns_of_a_frame_are_points_and_masses(library: Any) -> None:
    frame = library.DataFrame({"x": [0.0, 1.0], "y": [0.0, 0.0], "z": [2.0, 2.0], "m": [1, 3]})
    properties = inertia.point_masses(frame[["x", "y", "z"]], frame["m"])
    assert properties.mass == 4.0
    assert properties.center_of_mass.tolist() == [0.75, 0.0, 2.0]


def test_the_rows_of_a_frame_are_parts(library: Any) -> None:
    frame = library.DataFrame(
        {
            "name": ["hub", "bolt"],
            "shape": ["cylinder", "point"],
            "size": [[20, 30], None],
            "mass": [None, 0.25],
            "material": ["steel", None],
            "quantity": [1, 1],
        }
    )
    whole = inertia.Assembly.from_dict({"unit": "mm", "part": frame})
    assert [(part.name, part.mass, part.material) for part in whole.fields.part] == [
        ("hub", None, "steel"),
        ("bolt", 0.25, None),
    ]
    assert whole.mass_properties().mass == pytest.approx(0.25 + 7850 * math.pi * 0.02**2 * 0.03, rel=1e-12)
    bad = library.DataFrame({"name": ["a", "b"], "shape": ["point", "dot"], "mass": [1.0, 2.0]})
    with pytest.raises(inertia.UsageError, match=r"part\[1\].shape"):
        inertia.Assembly.from_dict({"unit": "mm", "part": bad})
