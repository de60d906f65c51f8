"""``inertia balance measure`` as a user meets it."""

import cmath
import csv
import io
import json
import math
import re
import shutil
from pathlib import Path

import pytest

import inertia
from inertia.balancing.measured.job import json_schema
from inertia_cli.main import main
from inertia_meshes import jobs, path

FAN, ROTOR = str(path("jobs/fan.toml")), str(path("jobs/two_disc_rotor.toml"))
DOCS = Path(__file__).parents[2] / "docs"


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    try:
        code = main(["balance", "measure", *arguments])
    except SystemExit as leaving:
        code = leaving.code
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_the_grades_are_printed_as_by_balance(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, "--grades")
    assert (code, err) == (0, "")
    main(["balance", "--grades"])
    assert capsys.readouterr().out == out
    assert json.loads(run(capsys, "--grades", "--json")[1])["schema"] == "inertia/grades/1"


def test_grades_and_schema_leave_no_room_for_a_certificate(capsys: pytest.CaptureFixture[str]) -> None:
    for stops in ("--grades", "--schema"):
        code, out, err = run(capsys, stops, "--certificate", "a.html")
        assert (code, out, err) == (2, "", f"inertia: nothing is balanced with {stops}: leave --certificate out\n")


def test_the_verdict_stands_first(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, FAN)
    assert (code, err) == (0, "")
    assert out.startswith("Verdict           PASS\n")
    assert "16.99 g = 4247 g·mm at 219.3°" in out


def test_the_document_holds_what_was_read_and_found(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, FAN, "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert result["schema"] == "inertia/measurement/1"
    assert [entry["id"] for entry in result["runs"]] == ["initial", "trial I", "trial II", "corrected"]
    table = csv.DictReader(path("jobs/fan.toml").with_suffix(".csv").read_text(encoding="utf-8").splitlines())
    stated = [(float(row["amplitude"]), float(row["phase"])) for row in table]
    shown = [(k["amplitude"], k["phase_deg"]) for entry in result["runs"] for k in entry["readings"]]
    assert shown == stated
    assert result["verdict"] == "pass"
    assert len(result["coefficients"]) == 4
    assert all(plane["expanded_uncertainty_gmm"] > 0 for plane in result["planes"])


def test_what_was_measured_is_drilled_out_of_the_rotor(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    cut, report = tmp_path / "cut.stl", tmp_path / "shop.html"
    code, out, _ = run(capsys, ROTOR, "--json", "--cut-part", str(cut), "--report", str(report))
    result = json.loads(out)
    assert (code, result["verdict"]) == (5, "fail")
    assert [work["id"] for work in result["corrections"]] == ["I-1", "II-1"]
    for work, plane in zip(result["corrections"], result["planes"], strict=True):
        assert work["angle_deg"] == pytest.approx(plane["unbalance"]["deg"], abs=0.3)
        assert work["unbalance_gmm"] == pytest.approx(plane["unbalance"]["gmm"], rel=0.003)
    assert result["corrected"]["verdict"] == "pass"
    vectors = [cmath.rect(k["gmm"], math.radians(k["deg"])) for k in (one["unbalance"] for one in result["planes"])]
    bearings = [
        cmath.rect(k["gmm"], math.radians(k["deg"])) for k in (e["unbalance"] for e in result["tolerance_planes"])
    ]
    # A bearing at 20 and one at 280 mm see vectors at 90 and 215 mm by the lever rule.
    assert bearings[1] == pytest.approx((70 * vectors[0] + 195 * vectors[1]) / 260, rel=1e-9)
    assert bearings[0] == pytest.approx(sum(vectors) - bearings[1], rel=1e-9)
    page = report.read_text(encoding="utf-8")
    assert "unbalance as measured" in page
    assert "not a measurement" not in page
    mesh = inertia.read(cut, unit="mm")
    moment = inertia.mass_properties(mesh, density=7850.0)
    whole = inertia.mass_properties(inertia.read(path("two_disc_rotor.stl"), unit="mm"), density=7850.0)
    lost = whole.mass * whole.center_of_mass[:2] - moment.mass * moment.center_of_mass[:2]
    assert 1e6 * complex(*lost) == pytest.approx(sum(vectors), rel=3e-3)


def test_a_job_that_counts_against_rotation_drills_at_the_mirrored_angle(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    folder = shutil.copytree(path(jobs()[0]).parents[1], tmp_path / "samples")
    job = folder / "jobs" / "two_disc_rotor.toml"
    text = job.read_text(encoding="utf-8")
    text = (
        text.replace('"with rotation"', '"against rotation"\nzero = 30')
        .replace("211.0", "179.0")
        .replace("19.5", "10.5")
    )
    job.write_text(text, encoding="utf-8")
    mirrored = json.loads(run(capsys, str(job), "--json")[1])
    straight = json.loads(run(capsys, ROTOR, "--json")[1])
    for one, other in zip(mirrored["corrections"], straight["corrections"], strict=True):
        assert one["angle_deg"] == pytest.approx(other["angle_deg"], abs=0.3)
        assert one["job_angle_deg"] == pytest.approx((30 - other["angle_deg"]) % 360, abs=0.3)


def test_the_shop_sheet_counts_angles_as_the_job_does(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    folder = shutil.copytree(path(jobs()[0]).parents[1], tmp_path / "samples")
    job = folder / "jobs" / "two_disc_rotor.toml"
    text = job.read_text(encoding="utf-8").replace('"with rotation"', '"against rotation"\nzero = 30')
    job.write_text(text.replace("211.0", "179.0").replace("19.5", "10.5"), encoding="utf-8")
    rotor = folder / "rotors" / "two_disc_rotor.toml"
    for own in ("ccw", "cw"):  # of the rotor file, which says nothing of the machine that measured
        table = rotor.read_text(encoding="utf-8")
        table = table if own == "ccw" else table.replace("[report]", f'[report]\nmachine_angles = "{own}"')
        rotor.write_text(table, encoding="utf-8")
        report = tmp_path / f"{own}.html"
        result = json.loads(run(capsys, str(job), "--json", "--report", str(report))[1])
        page = report.read_text(encoding="utf-8")
        steps = re.findall(r"at <b>([\d.]+)°</b> of the machine \(([\d.]+)° in this report\)", page)
        # The heavy spots are at 179° and 10.5° of the machine, whose 0° is at 30° and which counts the other way.
        assert [float(one) for one, _ in steps] == pytest.approx([179.0, 10.5], abs=0.3)
        assert [float(one) for one, _ in steps] == [round(work["job_angle_deg"], 1) for work in result["corrections"]]
        assert [float(other) for _, other in steps] == pytest.approx([30 - 179 + 360, 30 - 10.5], abs=0.3)
        assert "The machine counts angles clockwise in this view, and its 0° is at 30.0° of it." in page
        strips = page[page.index('class="wraps"') :]
        assert "the ends meet at 30.0°" in strips
        assert all(f"{one}°</text>" in strips for one, _ in steps)
    capsys.readouterr()
    plain = tmp_path / "plain.html"
    run(capsys, ROTOR, "--report", str(plain))
    assert "of the machine" not in plain.read_text(encoding="utf-8")


def test_what_is_to_be_drilled_multiplies_out(capsys: pytest.CaptureFixture[str]) -> None:
    out = " ".join(run(capsys, ROTOR)[1].split())
    found = re.findall(r"remove ([\d.]+) g whose centre is at radius ([\d.]+) mm = ([\d.]+) g·mm at", out)
    assert len(found) == 2
    for mass, radius, unbalance in found:
        assert float(mass) * float(radius) == pytest.approx(float(unbalance), rel=1e-3)


JOB = """
method = "balancing machine"
rpm = 900
conventions = { angles = "with rotation", shows = "unbalance" }
plane = [{ id = "P", radius = 5, permissible_gmm = 0.0004 }]
run = [{ id = "r", readings = [{ sensor = "P", amplitude = 0.0021, phase = 359.99 }] }]
"""


def test_figures_of_a_rotor_of_milligrams_are_figures(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    job, page = tmp_path / "job.toml", tmp_path / "page.html"
    job.write_text(JOB, encoding="utf-8")
    out = run(capsys, str(job), "--certificate", str(page))[1]
    for text in (out, re.sub("<[^<>]*>", "", page.read_text(encoding="utf-8"))):
        assert "0.000420 g = 0.00210 g·mm at " in text
        assert "0.00210 ∠ 0.0°" in text
        assert "0.000400" in text
        assert "360.0°" not in text
        assert "<0.001" not in text


def test_two_weights_of_one_size_are_written_alike(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    text = JOB.replace("radius = 5", "radius = 100, positions = { count = 3 }").replace("0.0021", "1000")
    job.write_text(text.replace("359.99", "240"), encoding="utf-8")
    assert "plane P: 10.00 g at 0.0°, 10.00 g at 120.0°" in run(capsys, str(job))[1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("method =", 'readings = "empty.csv"\nmethod ='), "readings names empty.csv, which has none: add a line"),
        (("method =", "method ="), "run has no readings: give each run what was read"),
        (('id = "r"', 'id = ""'), "run[0].id is '': it must be text that is not empty"),
    ],
)
def test_what_is_empty_is_said_to_be(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, change: tuple[str, str], words: str
) -> None:
    (tmp_path / "empty.csv").write_text("run,sensor,rpm,amplitude,phase\n", encoding="utf-8")
    job = tmp_path / "job.toml"
    lines = JOB.replace(*change).splitlines()
    job.write_text("\n".join([*lines[:-1], lines[-1].partition(", readings")[0] + " }]"]), encoding="utf-8")
    code, _, err = run(capsys, str(job))
    assert code == 2
    assert words in err


def test_the_log_has_weights_in_gram_millimetres_too(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    job, log = tmp_path / "job.toml", tmp_path / "log.csv"
    weights = (
        'weights = [{ plane = "P", gmm = 4, angle = 30 }, { plane = "P", mass_g = -2, radius = 1.5, angle = 30 }], '
    )
    job.write_text(JOB.replace("radius = 5, ", "").replace("readings", weights + "readings"), encoding="utf-8")
    run(capsys, str(job), "--log", str(log))
    (row,) = csv.DictReader(io.StringIO(log.read_text(encoding="utf-8")))
    assert row["mounted"] == "P 1 g·mm at 30"


def test_a_run_after_the_work_verifies_it(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    folder = shutil.copytree(path(jobs()[0]).parents[1], tmp_path / "samples")
    job = folder / "jobs" / "two_disc_rotor.toml"
    text = job.read_text(encoding="utf-8").replace(
        "[report]",
        """[[run]]
id = "drilled"
weights = [
  { plane = "I", gmm = -869.1, angle = 211, stays = true },
  { plane = "II", gmm = -1610, angle = 19.5, stays = true },
]
readings = [
  { sensor = "I", amplitude = 6.1, phase = 80 },
  { sensor = "II", amplitude = 8.4, phase = 255 },
]

[report]""",
    )
    job.write_text(text, encoding="utf-8")
    code, out, _ = run(capsys, str(job))
    assert code == 0
    assert out.startswith("Verdict           PASS\n")
    assert "To do             nothing" in out


def test_the_certificate_says_who_what_and_with_what(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "certificate.html"
    assert run(capsys, FAN, "--certificate", str(file))[0] == 0
    page = file.read_text(encoding="utf-8")
    for words in (
        "PASS", "fan wheel 630", "two-channel analyser", "2026-03-02, valid for a year", "1480 r/min", "N. N.",
        "67.67 g·mm at 174.6°", "4197 g·mm at 39.8°", "25.24", "914.6", "trial I",
        "weights screwed on and secured", "0.042 ∠ 205.0°",
    ):  # fmt: skip
        assert words in re.sub("<[^<>]*>", "", page), words
    assert "<script" not in page
    assert 'scope="row"' in page
    code, _, err = run(capsys, FAN, "--certificate", str(file))
    assert (code, err.count("\n")) == (2, 1)


def test_log_and_coefficients_are_written(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    log, coefficients = tmp_path / "log.csv", tmp_path / "coefficients.toml"
    assert run(capsys, FAN, "--log", str(log), "--coefficients", str(coefficients))[0] == 0
    rows = list(csv.DictReader(io.StringIO(log.read_text(encoding="utf-8"))))
    assert [row["run"] for row in rows[::2]] == ["initial", "trial I", "trial II", "corrected"]
    folder = shutil.copytree(path(jobs()[0]).parent, tmp_path / "jobs")
    text = (folder / "fan.toml").read_text(encoding="utf-8")
    head, _, runs = text.partition('[[run]]\nid = "initial"')
    job = folder / "again.toml"
    job.write_text(
        head.replace('readings = "fan.csv"', f'coefficients = "{coefficients}"')
        + '[[run]]\nid = "a year later"\nreadings = [{ sensor = "A", amplitude = 2.1, phase = 300 }, '
        '{ sensor = "B", amplitude = 1.7, phase = 20 }]\n',
        encoding="utf-8",
    )
    assert runs
    code, out, err = run(capsys, str(job), "--json")
    assert (code, err) == (5, "")
    predicted = json.loads(out)["predicted"]
    assert max(reading["amplitude"] for reading in predicted) < 0.2


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ((), 2, "no job is named"),
        (("nothing.toml",), 3, "cannot read nothing.toml"),
        ((str(path("rotors/disc.toml")),), 2, "body is that of a rotor file, not of a job"),
        ((str(path("cube.stl")),), 3, "it is no text in UTF-8"),
        ((FAN, "--report", "x.html"), 2, "--report is of a rotor file, and the job names none"),
        ((FAN, "--log", "x.txt"), 2, "its name must end in .csv"),
        ((ROTOR, "--coefficients", "x.toml"), 2, "has no influence coefficients"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], code: int, words: str, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    status, _, err = run(capsys, *arguments)
    assert status == code
    assert words in err
    assert err.count("\n") == 1


def test_a_job_is_no_rotor(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["balance", FAN]) == 2
    assert "run is that of a job of readings, not of a rotor: it is for `measure`" in capsys.readouterr().err


def test_the_schema_is_the_one_in_the_documentation(capsys: pytest.CaptureFixture[str]) -> None:
    assert json.loads(run(capsys, "--schema")[1]) == json_schema()
    assert json.loads((DOCS / "job.schema.json").read_text(encoding="utf-8")) == json_schema()


def test_work_is_printed_to_the_digits_of_the_steps(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    folder = shutil.copytree(path(jobs()[0]).parents[1], tmp_path / "samples")
    rotor, job, certificate = folder / "rotors/two_disc_rotor.toml", folder / "jobs/two_disc_rotor.toml", "c.html"
    text = rotor.read_text(encoding="utf-8").replace("depth_step = 0.1", "depth_step = 0.003")
    text = text.replace("angle_step = 0.5", "angle_step = 0.03").replace("[8, 10, 12]", "[8, 10.3125]")
    rotor.write_text(text, encoding="utf-8")
    run(capsys, str(job), "--certificate", str(tmp_path / certificate))
    out, works = run(capsys, str(job))[1], json.loads(run(capsys, str(job), "--json")[1])["corrections"]
    page = (tmp_path / certificate).read_text(encoding="utf-8")
    printed = [
        re.findall(r"at (\d+\.\d+)°, from .*?Ø(\d+\.\d+),\s+(\d+\.\d+)\s+mm\s+deep", k, re.S) for k in (out, page)
    ]
    for found in printed:
        assert [tuple(map(float, each)) for each in found] == [
            tuple(round(work[key], 9) for key in ("job_angle_deg", "tool_diameter_mm", "depth_mm")) for work in works
        ]
    assert any(round(work["depth_mm"], 2) != round(work["depth_mm"], 9) for work in works)


def test_masses_to_mount_are_printed_to_the_digits_of_their_steps_and_places(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    folder = shutil.copytree(path(jobs()[0]).parents[1], tmp_path / "samples")
    job, table = folder / "jobs/fan.toml", folder / "jobs/fan.csv"
    text = job.read_text(encoding="utf-8").partition('[[run]]\nid = "corrected"')[0]
    text = text.replace("mass_step_g = 0.5", "mass_step_g = 0.0025").replace("{ count = 12 }", "{ count = 32 }")
    job.write_text(text, encoding="utf-8")
    lines = table.read_text(encoding="utf-8").splitlines()
    table.write_text("\n".join(k for k in lines if not k.startswith("corrected")), encoding="utf-8")
    out, planes = run(capsys, str(job))[1], json.loads(run(capsys, str(job), "--json")[1])["planes"]
    for plane in planes:
        masses = ", ".join(f"{piece['g']:.4f} g at {piece['deg']:.2f}°" for piece in plane["pieces"])
        assert f"plane {plane['id']}: {masses}" in out
        assert all(piece["g"] / 0.0025 == pytest.approx(round(piece["g"] / 0.0025)) for piece in plane["pieces"])
