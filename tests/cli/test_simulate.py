"""``inertia simulate`` and ``inertia tumble`` as a user meets them."""

import hashlib
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from inertia.mesh.readers.formats import EXTENSIONS
from inertia_cli.main import main
from inertia_meshes import path, scenes

HANDLE = str(path("t_handle.stl"))
SPIN = ("--spin", "0.001,10,0", "--for", "6")

PLAIN = """
[body]
principal_moments = [1.0, 2.0, 3.0]
[start]
angular_velocity = [0.1, 2.0, 0.3]
[run]
duration = 5.0
samples = 6
"""


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    try:
        code = main(arguments)
    except SystemExit as leaving:
        code = leaving.code
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def scene(tmp_path: Path, text: str = PLAIN) -> str:
    file = tmp_path / "scene.toml"
    file.write_text(text)
    return str(file)


def test_the_document_holds_the_contract(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, out, err = run(capsys, "simulate", scene(tmp_path), "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert (result["schema"], result["model"]) == ("inertia/run/1", "asymmetric top")
    assert all(sentence.endswith(".") for sentence in result["why"])
    assert set(result["accuracy"]) == {"requested", "reached", "method", "inputs", "until"}
    assert (result["accuracy"]["inputs"], result["accuracy"]["until"]) == (0.0, result["time"][-1])
    assert 0 < result["accuracy"]["reached"] <= result["accuracy"]["requested"] == 1e-10
    assert result["time"] == [0, 1, 2, 3, 4, 5]
    assert np.shape(result["attitude"]) == (6, 4)
    assert np.shape(result["angular_velocity"]) == np.shape(result["angular_momentum"]) == (6, 3)
    assert result["angular_velocity"][0] == pytest.approx([0.1, 2.0, 0.3], rel=1e-15)
    assert result["attitude"][0] == [0, 0, 0, 1]
    assert len(result["energy"]) == 6
    assert result["invariants"]["energy"]["initial"] == result["energy"][0]
    assert result["invariants"]["angular momentum"]["initial"] == result["angular_momentum"][0]
    assert 0 <= result["invariants"]["energy"]["largest_relative_drift"] < 1e-14


@pytest.mark.parametrize(
    ("stated", "moments"),
    [
        ("principal_moments = [3.0, 1.0, 2.5]", [3.0, 1.0, 2.5]),
        ("inertia = [[3, 0, 0], [0, 1, 0], [0, 0, 2.5]]", [1.0, 2.5, 3.0]),
    ],
)
def test_principal_moments_and_axes_are_those_of_the_tensor_numbered_as_the_frame(
    stated: str, moments: list[float], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = scene(tmp_path, PLAIN.replace("principal_moments = [1.0, 2.0, 3.0]", stated))
    for options in ((), ("--explain",)):
        body = json.loads(run(capsys, "simulate", file, "--json", *options)[1])["body"]
        axes = np.array(body["principal_axes"])
        assert body["principal_moments"] == moments
        assert (axes @ np.diag(moments) @ axes.T).tolist() == body["inertia"] == [[3, 0, 0], [0, 1, 0], [0, 0, 2.5]]


def test_numbers_read_back_as_they_were(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    from inertia.dynamics.scene.document import Scene
    from inertia.dynamics.simulate import simulate

    file = scene(tmp_path)
    result = json.loads(run(capsys, "simulate", file, "--json")[1])
    again = simulate(Scene.load(file))
    assert np.array_equal(result["attitude"], again.attitude)
    assert np.array_equal(result["angular_momentum"], again.angular_momentum)


def test_the_text_tells_what_ran_and_what_came_out(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, "simulate", str(path("scenes/t_handle.toml")))
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert max(map(len, lines)) <= 120
    labels = [line.split("  ")[0] for line in lines if line and not line.startswith(" ")]
    for label in ("Scene", "Part", "Mass", "Moments", "Spin", "Model", "Why", "Method", "Accuracy", "Kept", "Events"):
        assert label in labels
    assert re.search(r"^Flip period +2\.996935953 s$", out, re.MULTILINE)
    assert "flip: the spin about the intermediate axis changes sign" in out
    assert "… and 14 more" in out


@pytest.mark.parametrize("name", scenes())
def test_every_sample_scene_runs_to_its_accuracy(capsys: pytest.CaptureFixture[str], name: str) -> None:
    file = path(name)
    short = ("--for", "0.5") if file.stem == "tippe_top" else ()  # all of it is run in docs/simulating.md
    code, out, err = run(capsys, "simulate", str(file), "--json", "--samples", "21", *short)
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert result["accuracy"]["reached"] <= result["accuracy"]["requested"]
    assert (
        result["model"]
        == {
            "boom_satellite": "Euler equations",
            "cat": "deforming body",
            "cube": "spherical top",
            "detumbling": "Euler equations",
            "diver": "deforming body",
            "explorer_1": "Euler equations",
            "feynman_plate": "symmetric top",
            "flywheel": "scaled free motion",
            "gravity_gradient": "Euler equations",
            "heavy_top": "heavy symmetric top",
            "kovalevskaya_top": "Euler equations",
            "manoeuvre": "Euler equations",
            "pendulum": "hinged body",
            "rolling_disc": "rolling body",
            "skater": "deforming body",
            "sleeping_top": "heavy symmetric top",
            "spinning_top": "heavy symmetric top",
            "t_handle": "asymmetric top",
            "thrown_box": "asymmetric top",
            "tilted_disc": "hinged body",
            "tippe_top": "sliding ball",
        }[file.stem]
    )


def test_the_plate_wobbles_twice_as_fast_as_it_spins(capsys: pytest.CaptureFixture[str]) -> None:
    result = json.loads(run(capsys, "simulate", str(path("scenes/feynman_plate.toml")), "--json")[1])
    assert result["quantities"]["precession of the body"] == pytest.approx(2 * math.hypot(20, 0.25))


def test_explorer_ends_on_its_largest_axis(capsys: pytest.CaptureFixture[str]) -> None:
    out = run(capsys, "simulate", str(path("scenes/explorer_1.toml")), "--json", "--samples", "2")[1]
    momentum = math.hypot(0.0476 * 78.5, 4.79 * 0.8)
    np.testing.assert_allclose(np.abs(json.loads(out)["angular_velocity"][-1]), [0, 0, momentum / 4.81], atol=0.02)


def test_options_go_before_the_scene(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    changed = ("--for", "2", "--samples", "3", "--accuracy", "1e-8", "--method", "DOP853")
    result = json.loads(run(capsys, "simulate", scene(tmp_path), "--json", *changed)[1])
    assert result["time"] == [0, 1, 2]
    assert result["accuracy"]["requested"] == 1e-8
    assert (result["model"], result["accuracy"]["method"]) == ("Euler equations", "DOP853")
    assert result["steps"] > 0
    forced = json.loads(run(capsys, "simulate", scene(tmp_path), "--json", "--model", "Euler equations")[1])
    assert forced["why"][-1] == "The scene asks for this model."


def test_explaining_runs_nothing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delattr("inertia.dynamics.models.free.motion.solve_free")
    code, out, _ = run(capsys, "simulate", scene(tmp_path), "--explain")
    assert code == 0
    assert "Model             asymmetric top\n" in out
    assert "Jacobi's elliptic functions" in out
    assert "Accuracy" not in out
    result = json.loads(run(capsys, "simulate", scene(tmp_path), "--explain", "--json")[1])
    assert (result["schema"], result["model"], result["method"]) == ("inertia/plan/1", "asymmetric top", None)


def test_a_part_tumbles_about_its_principal_axes(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, "tumble", HANDLE, *SPIN, "--material", "steel", "--unit", "mm", "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert result["model"] == "asymmetric top"
    axes = np.array(result["body"]["principal_axes"])
    np.testing.assert_allclose(result["angular_velocity"][0], axes @ [0.001, 10, 0], atol=1e-15)
    assert result["warnings"] == []
    assert [event["name"] for event in result["events"]] == ["flip", "flip"]


def test_what_is_no_solid_tumbles_by_its_surface_or_its_lines(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    lines = tmp_path / "lines.obj"
    lines.write_text("v 0 0 0\nv 100 0 0\nv 100 50 0\nl 1 2 3\n")
    options = ("tumble", str(lines), "--spin", "1,2,3", "--for", "1", "--density", "1000")
    code, out, _ = run(capsys, *options, "--wire", "2±0.1", "--json")
    body = json.loads(out)["body"]
    assert (code, body["mass"]) == (0, pytest.approx(0.0003))
    assert body["principal_moments"][2] == pytest.approx(1.25e-7 + 2.5e-7, rel=0.3)
    code, _, err = run(capsys, *options)
    assert (code, err.count("use --wire AREA for lines, or export a solid\n")) == (4, 1)
    code, out, _ = run(capsys, "tumble", HANDLE, *SPIN, "--shell", "1", "--mass", "2", "--json")
    assert (code, json.loads(out)["body"]["mass"]) == (0, 2.0)
    sheet = tmp_path / "sheet.obj"
    sheet.write_text("v 0 0 0\nv 30 0 0\nv 0 40 0\nf 1 2 3\n")
    code, _, err = run(capsys, "tumble", str(sheet), *options[2:])
    own, _, foreign = err.partition(" (--repair with `inertia analyse`: tumbling takes a sound solid, or a surface by")
    assert (code, own.endswith("or use --shell THICKNESS or --repair"), bool(foreign)) == (4, True, True)


def test_a_negative_spin_is_no_option(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "tumble", HANDLE, "--spin", "-1,0,0", "--for", "1", "--explain")
    assert code == 0
    assert "Spin              -1, 0, 0 rad/s along the principal axes" in out


def test_density_does_not_change_how_a_part_tumbles(capsys: pytest.CaptureFixture[str]) -> None:
    light = json.loads(run(capsys, "tumble", HANDLE, *SPIN, "--density", "1", "--json")[1])
    heavy = json.loads(run(capsys, "tumble", HANDLE, *SPIN, "--density", "8192", "--json")[1])
    np.testing.assert_allclose(light["attitude"], heavy["attitude"], atol=1e-13)
    assert heavy["energy"][0] == pytest.approx(8192 * light["energy"][0])


@pytest.mark.parametrize(
    ("code", "change", "message"),
    [
        (2, ("duration = 5.0", "duration = -5.0"), "run.duration is -5.0"),
        (2, ("duration", "durations"), "run.durations is unknown: did you mean duration?"),
        (
            2,
            ("angular_velocity = [0.1, 2.0, 0.3]", "angular_velocity = [0.0, nan, 0.0]"),
            "start.angular_velocity[1] is nan",
        ),
        (2, ("angular_velocity = [0.1, 2.0, 0.3]", "angular_velocity = [0, 0, 0]"), "start.angular_velocity is zero"),
        (2, ("samples = 6", "accuracy = 1e-18"), "run.accuracy is 1e-18 rad"),
        (2, ("[run]", "[[load]]\nkind = 'gravity'\n[run]"), "body.mass is missing"),
        (3, ("[body]", "[body"), "it is not TOML"),
        (3, ("principal_moments = [1.0, 2.0, 3.0]", "part = 'nosuch.stl'"), "there is no such file"),
        (4, ("[1.0, 2.0, 3.0]", "[1.0, 2.0, 30.0]"), "break the triangle rule"),
        (4, ("samples = 6", "accuracy = 1e-15"), "run.accuracy asks for 1e-15 rad"),
    ],
)
def test_a_fault_in_a_scene_is_one_sentence_with_the_file_and_a_code(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, code: int, change: tuple[str, str], message: str
) -> None:
    assert change[0] in PLAIN
    file = scene(tmp_path, PLAIN.replace(*change))
    status, out, err = run(capsys, "simulate", file)
    assert (status, out, err.count("\n")) == (code, "", 1)
    assert message in err
    assert file in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("code", "arguments", "message"),
    [
        (2, ["simulate", "cube.stl"], "is a mesh and no scene"),
        (3, ["simulate", "nosuch.toml"], "cannot read nosuch.toml: there is no such file"),
        (3, ["simulate", "."], "cannot read .: it is a directory: give a file in it"),
        (2, ["simulate", "scenes/cube.toml", "--for", "-1"], "--for is -1.0: it must be positive"),
        (2, ["simulate", "scenes/cube.toml", "--model", "round"], "cube.toml: run.model is 'round', which is unknown"),
        (2, ["tumble", "cube.stl"], "required: --spin, --for"),
        (2, ["tumble", "cube.stl", "--spin", "1,2", "--for", "1"], "give three numbers as X,Y,Z"),
        (2, ["tumble", "cube.stl", "--spin", "0,0,0", "--for", "1"], "--spin is zero"),
        (2, ["tumble", "cube.stl", "--spin", "1,2,nan", "--for", "1"], "give three numbers as X,Y,Z"),
        (2, ["tumble", "cube.stl", "--spin", "1,2,3", "--for", "nan"], "--for is nan"),
        (2, ["tumble", "cube.stl", "--spin", "1,2,3", "--for", "1", "--accuracy", "1e-20"], "--accuracy is 1e-20"),
        (2, ["tumble", "cube.stl", "--spin", "1,2,3", "--for", "1", "--samples", "1"], "--samples is 1"),
        (2, ["tumble", "cube.stl", "--spin", "1,2,3", "--for", "1", "--density", "-1"], "density is -1"),
        (2, ["tumble", "cube.stl", "--spin", "1,2,3", "--for", "1", "--unit", "parsec"], "unknown unit"),
        (
            2,
            ["tumble", "t_handle.stl", "--spin", "1,2,3", "--for", "9", "--model", "spherical top"],
            "leave the model",
        ),
        (3, ["tumble", "nosuch.stl", "--spin", "1,2,3", "--for", "1"], "there is no such file"),
        (4, ["tumble", "broken/missing_face.stl", "--spin", "1,2,3", "--for", "1"], "boundary loop"),
        (4, ["tumble", "t_handle.stl", "--spin", "1,2,3", "--for", "9", "--accuracy", "1e-15"], "--accuracy asks for"),
    ],
)
def test_a_fault_on_the_command_line_is_one_sentence_and_a_code(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, code: int, arguments: list[str], message: str
) -> None:
    monkeypatch.chdir(path("cube.stl").parent)
    status, out, err = run(capsys, *arguments)
    assert (status, out, err.count("\n")) == (code, "", 1)
    assert err.startswith("inertia")
    assert message in err


@pytest.mark.parametrize("extension", [each for extensions in EXTENSIONS.values() for each in extensions])
def test_a_mesh_is_no_scene_whatever_its_format(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, extension: str
) -> None:
    mesh = tmp_path / f"part{extension.upper()}"
    mesh.touch()
    status, out, err = run(capsys, "simulate", str(mesh))
    assert (status, out) == (2, "")
    assert f"{mesh.name} is a mesh and no scene" in err
    mesh.unlink()
    status, out, err = run(capsys, "simulate", str(mesh))
    assert (status, out) == (3, "")
    assert "there is no such file" in err


def test_an_assembly_as_the_body_is_named(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    block = tmp_path / "block.toml"
    block.write_text('part = [{ name = "a", shape = "box", size = [10, 20, 30], density = 7850 }]\n')
    file = scene(tmp_path, PLAIN.replace("principal_moments = [1.0, 2.0, 3.0]", 'part = "block.toml"'))
    code, out, _ = run(capsys, "simulate", file, "-o", str(tmp_path / "run.csv"))
    assert code == 0
    assert re.search(rf"^Part +{re.escape(str(block))}$", out, re.MULTILINE)
    assert "from the bounds" not in out  # 1e-40 rad, which no float64 holds
    about = json.loads((tmp_path / "run.csv").read_text().splitlines()[0][2:])
    assert about["parts"] == {str(block): hashlib.sha256(block.read_bytes()).hexdigest()}
    assert json.loads(run(capsys, "simulate", file, "--json")[1])["body"]["part"] == str(block)


@pytest.mark.parametrize("law", ["0.1±0.01", "±0.01", "\udcc2\udcb10.01"])  # the last: ± in the locale C
def test_numbers_of_a_scene_are_drawn(law: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = scene(tmp_path)
    arguments = ("simulate", file, "--vary", f"start.angular_velocity[0]={law}", "--draws", "40", "--samples", "5")
    code, out, err = run(capsys, *arguments, "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert (result["schema"], result["draws"], result["states"]) == ("inertia/ensemble/1", 40, {"followed": 40})
    assert result["inputs"] == [{"path": "start.angular_velocity[0]", "law": "normal", "figures": [0.1, 0.01]}]
    assert list(result["quantities"]) == ["deviation", "tilt", "spin"]
    low, middle, high = (result["quantities"]["deviation"]["percentiles"][at] for at in ("5", "50", "95"))
    assert low[0] == middle[0] == high[0] == 0
    assert 0 < low[-1] < middle[-1] < high[-1]
    code, out, _ = run(capsys, *arguments, "--seed", "3")
    assert code == 0
    assert "seed 3: 40 followed" in out


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_draws_are_written_as_a_table(suffix: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file, table = scene(tmp_path), tmp_path / f"spread{suffix}"
    sweep = ("--vary", "body.principal_moments[2]=2.9,3.2", "--quantity", "energy", "-o", str(table))
    code, out, _ = run(capsys, "simulate", file, *sweep)
    assert code == 0
    assert "1 followed, 1 refused" in out
    if suffix == ".csv":
        head, first, second = (line.split(",") for line in table.read_text().splitlines())
    else:
        import pyarrow.parquet

        whole = pyarrow.parquet.read_table(table)
        head, (first, second) = whole.column_names, [list(row.values()) for row in whole.to_pylist()]
    assert head[:3] == ["draw", "state", "body.principal_moments[2]"]
    assert [str(cell) for cell in first[:4]] == ["0", "followed", "2.9", "asymmetric top"]
    assert float(first[head.index("energy")]) == pytest.approx(0.5 * (0.1**2 + 2 * 2.0**2 + 2.9 * 0.3**2))
    assert second[1] == "refused"
    assert second[head.index("energy")] in ("", None)
    code, _, err = run(capsys, "simulate", file, *sweep)
    assert (code, "--force" in err) == (2, True)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--draws", "5"), "--draws goes with many runs"),
        (("--vary", "body.mass"), "says no law"),
        (("--vary", "start.angular_velocity[0]=1..2", "--reaches", "tilt"), "names no level"),
        (
            ("--vary", "start.angular_velocity[0]=1..2", "--reaches", "tilt=1", "--reaches", "tilt=2"),
            "--reaches is given twice for tilt: give one level of a quantity",
        ),
        (("--vary", "body.mass=±1%"), "body.mass is not stated"),
        (("--vary", "start.angular_velocity[0]=1..2", "--vary", "start.angular_velocity[0]=1"), "given twice"),
        (("--vary", "start.angular_velocity[0]=1..2", "--live"), "--live is of one run"),
        (("--vary", "start.angular_velocity[0]=1..2", "-o", "a.rrd"), "must end in .csv, .npz or .parquet"),
        (("--vary", "start.angular_velocity[0]=1..2", "--samples", "1"), "--samples"),
    ],
)
def test_spreads_that_make_no_sense_are_refused(
    words: tuple[str, ...], sentence: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    code, out, err = run(capsys, "simulate", scene(tmp_path), *words)
    assert (code, out) == (2, "")
    assert sentence in err


def test_series_are_written_beside_a_recording_and_all_or_none(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    outputs = [str(tmp_path / f"run{ending}") for ending in (".csv", ".npz", ".parquet", ".rrd")]
    options = [word for output in outputs for word in ("-o", output)]
    code, out, err = run(capsys, "simulate", scene(tmp_path), "--json", *options)
    assert (code, err) == (0, "")
    result = json.loads(out)
    with np.load(outputs[1]) as archive:
        assert np.array_equal(archive["attitude"], result["attitude"])
    assert all(Path(output).stat().st_size for output in outputs)
    code, _, err = run(capsys, "simulate", scene(tmp_path), *options)
    assert (code, err) == (2, f"inertia: {outputs[0]} exists: give another name, or --force to write over it\n")
    assert run(capsys, "tumble", HANDLE, *SPIN, *options, "--force")[0] == 0
    assert json.loads(Path(outputs[0]).read_text().split("\n")[0][2:])["parts"].keys() == {HANDLE}


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (["run.txt"], "run.txt: its name must end in .rrd, .csv, .npz or .parquet"),
        (["run.csv", "./run.csv"], "run.csv is named twice: every result needs a file of its own"),
    ],
)
def test_a_file_of_an_unknown_kind_or_named_twice_is_refused(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, names: list[str], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = scene(tmp_path)
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, "simulate", file, *(word for name in names for word in ("-o", name)))
    assert (code, out) == (2, "")
    assert says in err
    assert [each.name for each in tmp_path.iterdir()] == ["scene.toml"]


def test_a_run_is_drawn_beside_its_files_or_nothing_is_written(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    drawn = tmp_path / "run.svg"
    code, _, err = run(capsys, "simulate", scene(tmp_path), "--plot", str(drawn), "-o", str(tmp_path / "run.csv"))
    assert (code, err) == (0, "")
    assert all(word in drawn.read_text() for word in ("Polhode", "rad/s", "kg m²/s", "scene.toml, asymmetric top, 5 s"))
    first = drawn.read_bytes()
    arguments = ("simulate", scene(tmp_path), "--plot", str(drawn))
    assert run(capsys, *arguments, "--force")[0] == 0
    assert drawn.read_bytes() == first
    code, _, err = run(capsys, *arguments)
    assert (code, "exists: give another name, or --force" in err) == (2, True)
    code, _, err = run(capsys, *arguments, "--force", "--plot-kind", "nutation", "-o", str(tmp_path / "new.csv"))
    assert (code, "'nutation' does not suit this run: use 'polhode'" in err) == (2, True)
    assert not (tmp_path / "new.csv").exists()
    picture = tmp_path / "handle.png"
    assert run(capsys, "tumble", HANDLE, *SPIN, "--plot", str(picture), "--plot-kind", "polhode")[0] == 0
    assert picture.read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--plot", "run.pdf"), "its name must end in .svg or .png"),
        (("--plot", "run.svg", "--plot-kind", "polhod"), "'polhod' is no kind of plot: did you mean 'polhode'?"),
        (("--plot-kind", "polhode"), "--plot-kind goes with a plot: name its file by --plot"),
        (("--plot", "run.svg", "--explain"), "--explain runs nothing"),
        (("--plot", "run.svg", "--vary", "run.duration=1..2"), "--plot is of one run"),
    ],
)
def test_a_plot_that_cannot_be_drawn_is_refused_before_the_run(
    words: tuple[str, ...],
    says: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file = scene(tmp_path)
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, "simulate", file, *words)
    assert (code, out) == (2, "")
    assert says in err


_HEAVY = 'mass = 2.0\ncenter_of_mass = [0.0, 0.0, 0.3]\n[[load]]\nkind = "gravity"\n[constraint]\n'
_NOTHING = {
    "zero energy, hanging at rest": ("0, 0, 0", "[1, 1, 1.5]", _HEAVY + 'kind = "fixed_point"', "[1, 0, 0, 0]"),
    "upright at rest": ("0, 0, 0", "[1, 1, 1.5]", _HEAVY + 'kind = "fixed_point"', "[0, 0, 0, 1]"),
    "a pendulum upright at rest": ("0, 0, 0", "[1, 2, 3]", _HEAVY + 'kind = "hinge"\naxis = [1, 0, 0]', "[0, 0, 0, 1]"),
    "an axle at rest": (
        "0, 0, 0",
        "[1, 2, 3]",
        _HEAVY + 'kind = "hinge"\naxis = [0, 0, 1]\nstiffness = 1',
        "[0, 0, 0, 1]",
    ),
    "a ball at rest": ("0, 0, 0", "[1, 1, 1]", _HEAVY + 'kind = "sliding"\nradius = 1\nfriction = 0.1', "[0, 0, 0, 1]"),
    "a spin that squares to nothing": ("1e-300, 0, 0", "[1, 2, 3]", "", "[0, 0, 0, 1]"),
    "a spin that is subnormal": ("0, 0, 1e-320", "[1, 1, 1]", "", "[0, 0, 0, 1]"),
    "a spin whose square is no float64": ("1e160, 0, 0", "[1, 2, 3]", "", "[0, 0, 0, 1]"),
    "damped away": ("0, 0, 1", "[1, 2, 3]", '[[load]]\nkind = "damping"\ncoefficient = 1e9', "[0, 0, 0, 1]"),
    "driven from rest": ("0, 0, 0", "[1, 2, 3]", '[[load]]\nkind = "torque"\ntorque = [0, 0, 1e-300]', "[0, 0, 0, 1]"),
    "an orbit at rest": (
        "0, 0, 0",
        "[1, 2, 3]",
        '[[load]]\nkind = "orbit"\nmu = 4e14\nsemi_major_axis = 7e6',
        "[0, 0, 0, 1]",
    ),
}


@pytest.mark.parametrize("name", _NOTHING)
def test_nothing_that_is_printed_or_written_is_not_a_number(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str
) -> None:
    """Where energy, momentum or spin are nothing, or no float64: a drift relative to it has no figure."""
    spin, moments, more, attitude = _NOTHING[name]
    start = f"[start]\nangular_velocity = [{spin}]\nattitude = {attitude}\n[run]\nduration = 0.5\nsamples = 3\n"
    file = scene(tmp_path, f"[body]\nprincipal_moments = {moments}\n{more}\n{start}")
    for form in ((), ("--json",)):
        code, out, err = run(capsys, "simulate", file, *form)
        assert code in (0, 2, 4)
        assert not re.search(r"\b(nan|inf|infinity)\b", out + err, re.IGNORECASE)


def test_draws_are_counted_as_one_writes_numbers_and_leave_as_arrays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, table = scene(tmp_path), tmp_path / "draws.npz"
    vary = ["simulate", file, "--vary", "start.angular_velocity[1]=2±0.01", "--samples", "3e0"]
    assert main([*vary, "--draws", "1e1", "-o", str(table)]) == 0
    capsys.readouterr()
    with np.load(table) as arrays:
        assert arrays["draw"].tolist() == list(range(10))
        assert arrays["start.angular_velocity[1]"].std() == pytest.approx(0.01, rel=0.9)
        assert set(arrays["state"].tolist()) == {"followed"}
    with pytest.raises(SystemExit):
        main([*vary, "--draws", "1.5"])
    assert "'1.5' is no whole number, as 1000 or 1e6" in capsys.readouterr().err
