"""``inertia trade`` as a user meets it."""

import json
from pathlib import Path

import pytest

from inertia.dynamics.integrators import methods
from inertia_cli.main import main
from inertia_meshes import path

CUBE, TORUS = str(path("cube.stl")), str(path("torus.stl"))


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    try:
        code = main(["trade", *arguments])
    except SystemExit as leaving:
        code = leaving.code
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_the_document_has_every_method_and_a_recommendation(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--repeats", "1", "--unit", "m", "--material", "steel", "--accuracy", "0.03")
    code, out, err = run(capsys, TORUS, *options, "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert (result["schema"], result["source"]["path"]) == ("inertia/trade/1", TORUS)
    assert (result["unit"], result["unit_from"], result["density"]) == ("m", "option", 7850.0)
    assert [row["method"] for row in result["rows"] if row["mesh"] == "whole"] == ["float64", "double-double", "exact"]
    assert result["rows"][3]["triangles"] < result["mesh"]["triangles"]
    assert result["accuracy"] == 0.03
    assert len(result["recommendations"]) == 1
    assert result["rows"][0]["error"]["volume"] <= result["rows"][0]["bound"]["volume"]


def test_the_table_is_for_reading(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, TORUS, "--repeats", "1", "--density", "2")
    assert (code, err) == (0, "")
    assert "\ndouble-double " in out
    assert "Recommended" in out
    assert "2 kg/m³ (as given)" in out


def test_a_plot_is_written_beside_the_table(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "trade.svg"
    file.write_text("kept")
    code, out, err = run(capsys, CUBE, "--repeats", "1", "--plot", str(file))
    assert (code, out) == (2, "")
    assert "--force" in err
    assert file.read_text() == "kept"
    code, out, _ = run(capsys, CUBE, "--repeats", "1", "--plot", str(file), "--force")
    assert code == 0
    assert out.startswith("Part")
    assert "cube.stl" in file.read_text()


def test_a_scene_is_measured_by_the_same_command(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(methods, "METHODS", {"Taylor": methods.METHODS["Taylor"]})
    scene, file = tmp_path / "scene.toml", tmp_path / "trade.svg"
    scene.write_text(
        "[body]\nprincipal_moments = [1, 2, 3]\n[start]\nangular_velocity = [1, 2, 3]\n[run]\nduration = 0.1\n"
    )
    code, out, err = run(capsys, str(scene), "--repeats", "1", "--accuracy", "1e-6", "--json", "--plot", str(file))
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert (result["schema"], result["scene"], result["accuracy"]) == ("inertia/trade-scene/1", str(scene), 1e-6)
    assert {row["method"] for row in result["rows"]} == {"closed form: Jacobi elliptic functions", "Taylor"}
    assert "scene.toml" in file.read_text()
    code, out, err = run(capsys, str(scene), "--repeats", "1")
    assert (code, err) == (0, "")
    assert "\nTaylor " in out


def test_what_was_measured_is_told_where_the_plot_fails(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("inertia.output.os.fsync", full)
    code, out, err = run(capsys, CUBE, "--repeats", "1", "--plot", str(tmp_path / "trade.png"))
    assert code == 1
    assert "Recommended" in out
    assert "No space left" in err


def test_a_budget_that_is_used_up_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, TORUS, "--budget", "1e-9")
    assert code == 0
    assert out.count("Skipped") == 3
    assert "give a larger --budget" in " ".join(out.split())


@pytest.mark.parametrize(
    ("code", "arguments", "message"),
    [
        (2, ["cube.stl", "--accuracy", "0"], "accuracy is 0.0"),
        (2, ["cube.stl", "--accuracy", "nan"], "accuracy is nan"),
        (2, ["cube.stl", "--accuracy", "fine"], "'fine' is neither a number nor 'exact'"),
        (2, ["cube.stl", "--accuracy", "1e-17"], "1.2e-16"),
        (2, ["cube.stl", "--repeats", "0"], "repeats is 0"),
        (2, ["cube.stl", "--repeats", "2.5"], "invalid int value"),
        (2, ["cube.stl", "--budget", "nan"], "budget is nan"),
        (2, ["cube.stl", "--unit", "parsec"], "unknown unit"),
        (2, ["cube.stl", "--material", "unobtainium"], "unknown material"),
        (2, ["cube.stl", "--density", "5", "--material", "steel"], "give one"),
        (2, ["cube.stl", "--plot", "trade.pdf"], ".svg or .png"),
        (1, ["cube.stl", "--plot", "nowhere/trade.svg"], "cannot write"),
        (2, ["two_region_bar.vtk"], "mesh of cells"),
        (3, ["nosuch.stl"], "no such file"),
        (3, ["scene.toml"], "cannot read scene.toml"),
        (2, ["scenes/cube.toml", "--density", "5"], "--density goes with a part"),
        (2, ["scenes/cube.toml", "--accuracy", "exact"], "give an angle in rad"),
        (2, ["scenes/cube.toml", "--budget", "nan"], "budget is nan"),
        (2, ["scenes/cube.toml", "--plot", "trade.pdf"], ".svg or .png"),
        (4, ["broken/missing_face.stl"], "boundary loop"),
        (4, ["broken/missing_face.stl"], "or --repair (with `inertia analyse`"),
        (4, ["broken/inside_out.stl"], "inward"),
        (4, ["broken/zero_volume.stl"], "no volume"),
    ],
)
def test_a_fault_is_one_sentence_and_a_code(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, code: int, arguments: list[str], message: str
) -> None:
    monkeypatch.chdir(path("cube.stl").parent)
    status, out, err = run(capsys, *arguments)
    assert (status, out, err.count("\n")) == (code, "", 1)
    assert err.startswith("inertia")
    assert message in err


def test_a_density_may_have_an_uncertainty_that_no_row_depends_on(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, CUBE, "--repeats", "1", "--density", "7850±50", "--json")
    assert (code, err, json.loads(out)["density"]) == (0, "", 7850.0)
    code, _, err = run(capsys, CUBE, "--density", "heavy")
    assert (code, "'heavy' is no number of kg/m³, as 7850" in err) == (2, True)
