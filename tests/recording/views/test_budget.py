"""A recording of a budget holds the tree of parts in their places, with ellipsoids of their moments."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.recording.kinds import written
from tests.recording.reading import Recorded

from inertia.assembly.budget import Budget
from inertia.assembly.document import Assembly
from inertia.recording import entities
from inertia.recording.provenance import properties
from inertia.recording.record import record
from inertia.recording.views.budget import CENTER, ELLIPSOIDS, PARTS, screen
from inertia_cli.main import main
from inertia_meshes import path

TREE = {
    "unit": "m",
    "part": [
        {"name": "pair/of a", "at": [0, 0, 2], "position_uncertainty": 0.01},
        {
            "name": "brick",
            "parent": "pair/of a",
            "shape": "box",
            "size": [0.4, 0.2, 0.1],
            "density": 500,
            "mirror": "x",
            "rows": {"count": [2, 1, 1], "step": [3, 0, 0]},
            "euler": [90],
            "sequence": "x",
        },
        {"name": "dot", "shape": "point", "mass": 4, "at": [1.5, 0, -2]},
    ],
    "limit": [{"what": "center_of_mass.x", "min": 1.4, "max": 1.51}],
}


@pytest.fixture(scope="module")
def budget() -> Budget:
    return Assembly.from_dict(TREE).budget()


@pytest.fixture(scope="module")
def recording(budget: Budget, tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return written(screen(budget), tmp_path_factory.mktemp("budget") / "tree.rrd")


def test_entities_hang_as_the_parts_do(recording: Recorded) -> None:
    group = r"/the\ assembly/pair\/of\ a"
    names = {name for name in recording.columns if name.startswith((f"/{PARTS}", f"/{ELLIPSOIDS}"))}
    assert {f"/{PARTS}{group}/brick", f"/{ELLIPSOIDS}{group}/brick", f"/{ELLIPSOIDS}{group}/ellipsoid"} <= names
    assert rf"/{PARTS}/the\ assembly/dot" in names


def test_copies_are_where_the_tree_puts_them(recording: Recorded) -> None:
    brick = rf"/{PARTS}/the\ assembly/pair\/of\ a/brick"
    places = recording.values(brick, "InstancePoses3D:translations")[0]
    assert places.tolist() == [
        pytest.approx([-1.5, 0, 4 / 3]),
        pytest.approx([1.5, 0, 4 / 3]),
    ]  # from the centre of mass
    x, y, z, w = recording.values(brick, "InstancePoses3D:quaternions")[0][0]
    assert [abs(k) for k in (x, y, z, w)] == pytest.approx([math.sqrt(0.5), 0, 0, math.sqrt(0.5)], abs=1e-6)
    corners = recording.values(brick, "Mesh3D:vertex_positions")[0].reshape(-1, 3, 3)
    volume = np.linalg.det(corners.astype(float)).sum() / 6
    assert volume == pytest.approx(0.4 * 0.2 * 0.1, rel=1e-6)  # facing outwards, though mirrored


def test_ellipsoids_have_the_moments(recording: Recorded, budget: Budget) -> None:
    half = recording.values(rf"/{ELLIPSOIDS}/the\ assembly/pair\/of\ a/brick", "Ellipsoids3D:half_sizes")[0]
    box = np.sqrt(5 / 12) * np.array([0.4, 0.2, 0.1])  # ∫x² dm / m is a²/12 of a box, and a²/5 of an ellipsoid
    assert half.tolist() == [pytest.approx(box.tolist(), rel=1e-6)] * 2
    whole = recording.values(r"/ellipsoids/the\ assembly/ellipsoid", "Ellipsoids3D:half_sizes")[0][0].astype(float)
    squares = whole**2 / 5 * budget.total.basic_mass
    assert np.sort(squares.sum() - squares) == pytest.approx(np.linalg.eigvalsh(budget.total.inertia), rel=1e-5)


def test_the_centre_is_in_its_region(recording: Recorded, budget: Budget) -> None:
    """A place that is uncertain by u along each axis moves the centre by as much times its share of the mass."""
    half = recording.values(f"/{CENTER}/region", "Ellipsoids3D:half_sizes")[0][0]
    assert half == pytest.approx([1, 1, 1])
    reach = math.sqrt(7.8147279) * 0.01 * 8 / 12
    (text,) = recording.texts(f"/{entities.SUMMARY}", "TextDocument:text")
    assert f"{reach:.6g}" in text
    assert {f"/{CENTER}/limit_x_min", f"/{CENTER}/limit_x_max"} <= set(recording.columns)
    near = recording.values(f"/{CENTER}/limit_x_max", "LineStrips3D:strips")[0]
    assert np.ravel(near[0])[0] == pytest.approx(0.01 / reach, rel=1e-3)


def test_no_folder_of_this_machine_is_in_it(tmp_path: Path) -> None:
    part = {"name": "box", "file": str(path("box.stl")), "density": 1000}
    record(Assembly.from_dict({"part": [part]}).budget(), tmp_path / "box.rrd")
    text = properties(tmp_path / "box.rrd")["assembly"]["text"]
    assert 'file = "box.stl"' in text
    assert str(path("box.stl").parent) not in text


def test_the_command_records_and_replaces_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "arm.rrd"
    for command in ("assembly", "budget"):
        words = [command, str(path("assemblies/arm.toml")), "-o", str(file)]
        assert main([*words, "--force"]) == 0
        assert file.stat().st_size
        assert main(words) == 2
        assert "arm.rrd" in capsys.readouterr().err
