"""Runs as tables: what is read back is what was written, with its units and what it is of."""

import csv
import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest
from tests.dynamics.scenes import PLAIN, TOP, scene

from inertia.dynamics.columns import unit_of
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.errors import UsageError
from inertia_meshes import path


def of(name: str) -> Run:
    return simulate(Scene.load(path(f"scenes/{name}.toml")))


@pytest.fixture(scope="module", params=["cat", "heavy_top", "tilted_disc", "rolling_disc", "manoeuvre"])
def run(request: pytest.FixtureRequest) -> Run:
    return of(request.param)


def read_csv(file: Path) -> tuple[dict[str, Any], list[str], np.ndarray]:
    with file.open(encoding="utf-8", newline="") as text:
        first = text.readline()
        names, *rows = csv.reader(text)
    assert first.startswith("# ")
    return json.loads(first[2:]), names, np.array(rows, dtype=np.float64)


def read_parquet(file: Path) -> tuple[dict[str, Any], list[str], np.ndarray]:
    table = pyarrow.parquet.read_table(file)
    about = json.loads(table.schema.metadata[b"inertia"])
    assert about["units"] == {field.name: field.metadata[b"unit"].decode() for field in table.schema}
    return about, table.schema.names, np.column_stack([column.to_numpy() for column in table.columns])


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_every_number_reads_back_as_it_was(run: Run, kind: str, tmp_path: Path) -> None:
    file = tmp_path / f"run.{kind}"
    getattr(run, f"to_{kind}")(file)
    about, names, values = {"csv": read_csv, "parquet": read_parquet}[kind](file)
    column = dict(zip(names, values.T, strict=True))
    assert np.array_equal(column["time"], run.time)
    for name, labels in (("attitude", "xyzw"), ("angular_velocity", "xyz"), ("angular_momentum", "xyz")):
        assert np.array_equal(np.column_stack([column[f"{name}_{k}"] for k in labels]), getattr(run, name))
    assert np.array_equal(column["energy"], run.energy)
    if run.position is None:
        assert "position_x" not in column
    else:
        assert np.array_equal(column["position_z"], run.position[:, 2])
    # Nothing of what goes with the time is left out, and every column has a unit.
    series = [run.time, run.attitude, run.angular_velocity, run.angular_momentum, run.energy, *run.series.values()]
    series += [] if run.position is None else [run.position]
    assert values.size == sum(each.size for each in series)
    assert list(about["units"]) == names
    assert all(about["units"].values())
    assert sum(np.sort(values.ravel())) == sum(np.sort(np.concatenate([each.ravel() for each in series])))


def test_arrays_read_back_as_they_were(run: Run, tmp_path: Path) -> None:
    run.to_npz(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as archive:
        about = json.loads(archive["metadata"].item())
        for name in ("time", "attitude", "angular_velocity", "angular_momentum", "energy"):
            assert np.array_equal(archive[name], getattr(run, name))
        for name, values in run.series.items():
            assert np.array_equal(archive[name.replace(" ", "_")], values)
        assert set(archive.files) == {"metadata", *about["units"]}
    assert (about["schema"], about["model"]) == ("inertia/run-table/1", run.model)


def test_the_metadata_says_what_the_table_is_of(tmp_path: Path) -> None:
    run, file = of("t_handle"), Path(str(path("scenes/t_handle.toml")))
    run.to_csv(tmp_path / "run.csv")
    about = read_csv(tmp_path / "run.csv")[0]
    assert about["scene_sha256"] == hashlib.sha256(file.read_bytes()).hexdigest()
    handle = Path(str(path("t_handle.stl")))
    assert list(about["parts"].values()) == [hashlib.sha256(handle.read_bytes()).hexdigest()]
    assert about["accuracy"] == {
        "requested": run.error.requested,
        "reached": run.error.reached,
        "method": run.error.method,
        "inputs": run.error.inputs,
        "until": run.scene.run.duration,
    }
    assert about["run"]["duration"] == run.scene.run.duration
    assert about["figures"]["flip period"] == run.quantities["flip period"]
    assert about["units"]["angular_momentum_y"] == "kg m²/s"


def test_figures_of_the_whole_run_are_no_columns(tmp_path: Path) -> None:
    run = simulate(scene(TOP, run__samples=2))
    run.to_csv(tmp_path / "run.csv")
    about, names, _ = read_csv(tmp_path / "run.csv")
    assert about["figures"]["turning theta"] == run.quantities["turning theta"].tolist()
    assert not [name for name in names if "turning" in name or "steady" in name]
    still = simulate(scene(PLAIN, start__angular_velocity=[0.0, 1.0, 0.0]))
    still.to_csv(tmp_path / "still.csv")  # the period of what never flips is infinite
    assert json.loads((tmp_path / "still.csv").read_text().split("\n")[0][2:])["schema"] == "inertia/run-table/1"


def test_joints_have_the_units_of_their_kinds(tmp_path: Path) -> None:
    of("skater").to_parquet(tmp_path / "run.parquet")
    units = read_parquet(tmp_path / "run.parquet")[0]["units"]
    assert {units[name] for name in units if name.startswith("joint_values")} <= {"rad", "m"}
    assert (units["part_poses_1_z"], units["part_poses_2_qw"]) == ("m", "1")
    assert units["inertia_xy"] == "kg m²"


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("theta of least energy", "rad"),
        ("turning theta", "rad"),
        ("energy of the spring", "J"),
        ("work of the joints", "J"),
        ("effective potential energy", "J"),
        ("phi rate", "rad/s"),
        ("precession of the body", "rad/s"),
        ("libration period in the plane", "s"),
        ("center of mass", "m"),
        ("internal angular momentum", "kg m²/s"),
        ("drive torque", "N m"),
        ("separatrix distance", ""),
    ],
)
def test_a_quantity_has_the_unit_of_what_it_is_and_not_of_what_it_is_of(name: str, unit: str) -> None:
    assert unit_of(name) == unit


def test_a_scene_that_no_file_can_hold_has_no_digest(tmp_path: Path) -> None:
    torque = Torque(lambda time, attitude, omega: -1e-3 * omega, longest_step=1.0)
    base = scene(PLAIN)
    simulate(Scene(base.body, base.start, base.run, applied_loads=[torque])).to_npz(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as archive:
        assert json.loads(archive["metadata"].item())["scene_sha256"] is None


def test_a_file_is_whole_and_of_the_kind_that_its_name_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = simulate(scene(PLAIN))
    with pytest.raises(UsageError, match=r"its name must end in \.parquet"):
        run.to_parquet(tmp_path / "run.csv")
    run.to_csv(tmp_path / "run.csv")
    with pytest.raises(UsageError, match="exists: give another name"):
        run.to_csv(tmp_path / "run.csv")
    run.to_csv(tmp_path / "run.csv", force=True)
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(UsageError, match=r"Parquet needs pyarrow: install it by pip install 'inertia\[parquet\]'"):
        run.to_parquet(tmp_path / "run.parquet")
    assert [file.name for file in tmp_path.iterdir()] == ["run.csv"]


def test_a_run_at_other_instants_is_written_as_any_other(tmp_path: Path) -> None:
    run = simulate(scene(PLAIN)).at([0.5, 0.25])
    run.to_csv(tmp_path / "run.csv")
    _, names, values = read_csv(tmp_path / "run.csv")
    assert values[:, names.index("time")].tolist() == [0.5, 0.25]
