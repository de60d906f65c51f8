"""A recording holds what is needed to run it again."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.recording.scenes import FREE, scene_table

import inertia
from inertia import Scene, record, simulate
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.sections import Settings, Start
from inertia.errors import ReadError
from inertia.recording.provenance import properties, rotor_of, scene_of
from inertia_meshes import path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "scenes").mkdir()
    shutil.copy(path("t_handle.stl"), tmp_path)
    shutil.copy(path("scenes/t_handle.toml"), tmp_path / "scenes")
    (tmp_path / "runs").mkdir()
    return tmp_path


def recorded(folder: Path) -> tuple[inertia.Run, Path]:
    scene = Scene.load(folder / "scenes/t_handle.toml")
    run = simulate(replace(scene, run=replace(scene.run, duration=2.0, samples=50)))
    record(run, folder / "runs/run.rrd")
    return run, folder / "runs/run.rrd"


def test_properties_say_what_made_it_and_of_what(folder: Path) -> None:
    run, file = recorded(folder)
    sections = properties(file)
    assert sections["tool"] == {"name": "inertia", "version": inertia.__version__}
    assert sections["scene"]["text"] == (folder / "scenes/t_handle.toml").read_text()
    assert sections["scene"]["name"] == "t_handle.toml"
    assert sections["source"]["path"] == "t_handle.stl"
    assert sections["source"]["sha256"] == run.scene.body.part.source.sha256
    assert sections["accuracy"]["reached_rad"] == run.error.reached
    assert sections["accuracy"]["requested_rad"] == 1e-10
    assert sections["settings"]["samples"] == 50


def test_a_recording_runs_again_bit_for_bit(folder: Path) -> None:
    run, file = recorded(folder)
    again = simulate(scene_of(file))
    assert np.array_equal(again.time, run.time)
    assert np.array_equal(again.attitude, run.attitude)


def test_a_recording_runs_again_from_itself_alone(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    run, file = recorded(folder)
    moved = shutil.move(file, tmp_path_factory.mktemp("elsewhere"))
    shutil.rmtree(folder)
    again = simulate(scene_of(moved))
    assert again.scene.body.part.source.sha256 == run.scene.body.part.source.sha256
    assert np.array_equal(again.attitude, run.attitude)
    twice = Path(moved).with_name("again.rrd")
    record(again, twice)
    assert np.array_equal(simulate(scene_of(twice)).attitude, run.attitude)


def test_tables_and_absolute_paths_go_along(tmp_path: Path) -> None:
    away = tmp_path / "away"
    away.mkdir()
    shutil.copy(path("scenes/manoeuvre.toml").with_suffix(".csv"), away)
    table = (path("scenes/manoeuvre.toml")).read_text().replace("manoeuvre.csv", str(away / "manoeuvre.csv"))
    assert str(away) in table
    (tmp_path / "scene.toml").write_text(table)
    scene = Scene.load(tmp_path / "scene.toml")
    run = simulate(replace(scene, run=replace(scene.run, duration=1.0, samples=11)))
    record(run, tmp_path / "run.rrd")
    shutil.rmtree(away)
    (tmp_path / "scene.toml").unlink()
    assert np.array_equal(simulate(scene_of(tmp_path / "run.rrd")).attitude, run.attitude)
    assert not no_text_has("[[load]]", tmp_path / "run.rrd")
    assert no_text_has(str(tmp_path), tmp_path / "run.rrd")


def no_text_has(words: str, file: Path) -> bool:
    """Say that these words are nowhere in a recording, its blueprint and its own information included."""
    from rerun.chunk import RrdReader

    reader = RrdReader(str(file))
    chunks = [*reader.store().stream(), *(chunk for each in reader.blueprints() for chunk in reader.stream(store=each))]
    return not any(
        words.encode() in buffer.to_pybytes()
        for chunk in chunks
        for column in chunk.to_record_batch().columns
        for buffer in column.buffers()
        if buffer is not None
    )


def test_no_folder_of_this_machine_is_in_a_recording(folder: Path) -> None:
    _, file = recorded(folder)
    assert no_text_has(str(folder), file)
    record(inertia.balance(inertia.Rotor.load(path("rotors/disc.toml"))), folder / "rotor.rrd")
    assert no_text_has(str(path("rotors/disc.toml").parent), folder / "rotor.rrd")


def test_what_is_too_large_to_go_along_is_looked_for_beside(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inertia.recording.provenance.ENCLOSED", 100)
    run, file = recorded(folder)  # it names ../t_handle.stl
    assert np.array_equal(simulate(scene_of(file)).attitude, run.attitude)
    shutil.copy(path("cube.stl"), folder / "t_handle.stl")
    with pytest.raises(ReadError, match=r"run.rrd was made from another .*t_handle.stl: its SHA-256 was"):
        scene_of(file)
    (folder / "t_handle.stl").unlink()
    with pytest.raises(ReadError, match="there is no such file"):
        scene_of(file)


@pytest.mark.parametrize("look", FREE)
def test_a_scene_made_in_python_runs_again(look: str, tmp_path: Path) -> None:
    run = simulate(Scene.from_dict(scene_table(look)))
    record(run, tmp_path / "run.rrd")
    again = simulate(scene_of(tmp_path / "run.rrd"))
    np.testing.assert_allclose(again.attitude, run.attitude, atol=1e-8)
    assert again.model == run.model


def test_a_torque_along_principal_axes_comes_back(tmp_path: Path) -> None:
    body = SceneBody(np.array([[2.0, 0.3, 0.0], [0.3, 2.5, 0.1], [0.0, 0.1, 3.0]]), 1.0)
    loads = (Torque([0.1, 0.0, 0.2], frame="principal"),)
    run = simulate(Scene(body, Start([1.0, 2.0, 3.0]), Settings(2.0, 11, 1e-8), applied_loads=loads))
    record(run, tmp_path / "run.rrd")
    np.testing.assert_allclose(simulate(scene_of(tmp_path / "run.rrd")).attitude, run.attitude, atol=1e-7)


def test_a_torque_by_a_function_cannot_be_run_again(tmp_path: Path) -> None:
    body = SceneBody(np.diag([1.0, 2.0, 3.0]), 1.0)
    loads = (Gravity(), Torque(lambda t, q, w: -0.1 * w, longest_step=1.0))
    run = simulate(Scene(body, Start([1.0, 2.0, 3.0]), Settings(1.0, 11, 1e-6), applied_loads=loads))
    record(run, tmp_path / "run.rrd")
    with pytest.raises(ReadError, match="a torque that was given in Python"):
        scene_of(tmp_path / "run.rrd")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "there is no such file: check the path"),
        (b"", "it is empty: record it again"),
        (b"no recording", "it is no Rerun recording: name a file"),
        (b"RRF", "it is no Rerun recording: name a file|it was cut short, or is damaged"),
        (b"RRF2\0", "it was cut short, or is damaged: record it again"),
        (b"RRF2\0\x29\0\0", "it was cut short, or is damaged: record it again"),
        (b"RRF1\0\x14\0\0 of 0.20", "its format is not that of the installed Rerun 0.41"),
        (b"RRF2\0\xff\0\0 of 0.255", "it is by Rerun 0.255.0, and the installed one is 0.41"),
    ],
)
def test_what_is_no_recording_is_refused(tmp_path: Path, content: bytes | None, message: str) -> None:
    file = tmp_path / "run.rrd"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(ReadError, match=rf"cannot read .*run.rrd: {message}"):
        scene_of(file)


def test_a_folder_is_no_recording(tmp_path: Path) -> None:
    (tmp_path / "run.rrd").mkdir()
    with pytest.raises(ReadError, match="it is a folder: name a recording in it"):
        scene_of(tmp_path / "run.rrd")


def test_half_a_recording_is_refused(folder: Path) -> None:
    _, file = recorded(folder)
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.raises(ReadError, match="it was cut short, or is damaged"):
        scene_of(file)


def test_a_recording_of_something_else_is_refused(tmp_path: Path) -> None:
    import rerun as rr

    with rr.RecordingStream("other") as stream:
        stream.save(tmp_path / "run.rrd")
        stream.log("a", rr.Points3D([[0, 0, 0]]), static=True)
    with pytest.raises(ReadError, match="it is no recording of a run"):
        scene_of(tmp_path / "run.rrd")


def test_a_rotor_s_recording_says_how_it_was_judged_and_is_no_scene(tmp_path: Path) -> None:
    rotor = inertia.Rotor.load(path("rotors/two_disc_rotor.toml"))
    record(inertia.balance(rotor), tmp_path / "rotor.rrd")
    sections = properties(tmp_path / "rotor.rrd")
    assert sections["verdict"]["outcome"] == "pass"
    assert inertia.Rotor.loads(sections["rotor"]["text"], rotor.folder).to_dict() == rotor.to_dict()
    assert len(sections["source"]["sha256"]) == 64
    with pytest.raises(ReadError, match=r"it is no recording of a run"):
        scene_of(tmp_path / "rotor.rrd")


def test_each_part_of_a_deforming_body_that_has_a_mesh_is_named(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(
        """
        schema = 1
        [[part]]
        name = "a"
        part = "cube.stl"
        unit = "mm"
        [[part]]
        name = "b"
        part = "box.stl"
        unit = "mm"
        parent = "a"
        [[part.joint]]
        axis = [0, 0, 1]
        times = [0.0, 1.0]
        angles = [0.0, 1.0]
        [start]
        angular_velocity = [0, 0, 0]
        [run]
        duration = 1.0
        samples = 20
        """
    )
    for name in ("cube.stl", "box.stl"):
        shutil.copy(path(name), tmp_path)
    run = simulate(Scene.load(tmp_path / "two.toml"))
    record(run, tmp_path / "two.rrd")
    sections = properties(tmp_path / "two.rrd")
    hashes = [mesh.source.sha256 for mesh in run.scene.body.meshes if mesh is not None]
    assert [sections["source"]["sha256"], sections["source_2"]["sha256"]] == hashes
    (tmp_path / "box.stl").write_bytes((tmp_path / "cube.stl").read_bytes())
    again = scene_of(tmp_path / "two.rrd")
    assert [mesh.source.sha256 for mesh in again.body.meshes if mesh is not None] == hashes


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    """A folder of its own with all rotors and meshes."""
    shutil.copytree(path("rotors/disc.toml").parent.parent, tmp_path / "shop")
    return tmp_path / "shop"


@pytest.mark.parametrize("name", [each.name for each in sorted(path("rotors/disc.toml").parent.glob("*.toml"))])
def test_a_rotor_is_balanced_again_from_its_recording_alone(name: str, shop: Path, tmp_path: Path) -> None:
    rotor = shop / "rotors" / name
    rotor.write_text(f"{rotor.read_text(encoding='utf-8')}\n[plan]\ntime = 1e-9\n", encoding="utf-8")
    balance = inertia.balance(inertia.Rotor.load(rotor))
    record(balance, tmp_path / "rotor.rrd")
    shutil.rmtree(shop)
    again = inertia.balance(rotor_of(tmp_path / "rotor.rrd"))
    assert again.verdict.outcome == balance.verdict.outcome
    assert np.array_equal(again.properties.inertia, balance.properties.inertia)
    assert no_text_has(str(shop), tmp_path / "rotor.rrd")


def test_parts_are_called_by_the_folders_that_the_rotor_file_names(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "sub/scenes/deep").mkdir(parents=True)
    shutil.copy(path("two_disc_rotor.stl"), tmp_path / "parts")
    corners = "v 500 0 0\nv 510 0 0\nv 500 10 0\nv 500 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (tmp_path / "sub/scenes/deep/lug.obj").write_text(corners)
    text = path("rotors/two_disc_rotor.toml").read_text(encoding="utf-8")
    text = text.replace("../two_disc_rotor.stl", "../../parts/two_disc_rotor.stl")
    (tmp_path / "sub/scenes/two.toml").write_text(f"{text}\n[[body]]\nfile = 'deep/lug.obj'\ndensity = 1\n")
    record(inertia.balance(inertia.Rotor.load(tmp_path / "sub/scenes/two.toml")), tmp_path / "two.rrd")
    shutil.rmtree(tmp_path / "parts")
    names = [body.whole.source.path for body in inertia.balance(rotor_of(tmp_path / "two.rrd")).bodies]
    assert names == [f"{tmp_path}/two.rrd/{name}" for name in ("parts/two_disc_rotor.stl", "deep/lug.obj")]


def test_a_part_too_large_to_go_along_has_to_be_the_same(
    shop: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("inertia.recording.provenance.ENCLOSED", 100)
    file = shop / "rotors/rotor.rrd"
    balance = inertia.balance(inertia.Rotor.load(shop / "rotors/disc.toml"))
    record(balance, file)
    assert inertia.balance(rotor_of(file)).verdict == balance.verdict
    (part,) = [shop / "rotors" / body.file for body in balance.rotor.fields.body if body.file]
    shutil.copy(shop / "cube.stl", part)
    with pytest.raises(ReadError, match=r"rotor\.rrd was made from another .*: its SHA-256 was"):
        rotor_of(file)


def test_a_recording_says_what_runs_it_again(folder: Path) -> None:
    _, file = recorded(folder)
    with pytest.raises(ReadError, match="it is no recording of a rotor"):
        rotor_of(file)
    record(inertia.balance(inertia.Rotor.load(path("rotors/disc.toml"))), folder / "rotor.rrd")
    with pytest.raises(ReadError, match="it is no recording of a run: run it again by `balance`"):
        scene_of(folder / "rotor.rrd")
