"""Balancing jobs as files: what is refused, in one sentence with the field's path or the table's line."""

import copy
import shutil

import pytest

from inertia import Job, ReadError, UsageError, measure
from inertia_meshes import jobs, path

BASE = {
    "rpm": 1500,
    "conventions": {"angles": "with rotation", "phase": "lag"},
    "sensor": [{"id": "A", "unit": "mm/s"}],
    "plane": [{"id": "I", "radius": 100}],
    "run": [
        {"id": "0", "readings": [{"sensor": "A", "amplitude": 5.0, "phase": 30.0}]},
        {
            "id": "1",
            "weights": [{"plane": "I", "mass_g": 5.0, "angle": 0.0}],
            "readings": [{"sensor": "A", "amplitude": 8.0, "phase": 60.0}],
        },
    ],
}


def changed(*steps, value):
    table = copy.deepcopy(BASE)
    place = table
    for step in steps[:-1]:
        place = place[step]
    if value is None:
        del place[steps[-1]]
    else:
        place[steps[-1]] = value
    return table


@pytest.mark.parametrize(
    ("spelling", "unit"),
    [
        ("mm/s RMS", "mm/s rms"), ("MIL", "mil pp"), ("Mils P-P", "mil pp"), ("in/s pk", "in/s peak"),
        ("mm/s 0-p", "mm/s peak"), ("IPS", "in/s peak"), ("um pk-pk", "µm pp"), ("M/S2 0-pk", "m/s² peak"),
    ],
)  # fmt: skip
def test_units_of_vibration_are_spelt_as_shops_do(spelling, unit):
    assert Job.from_dict(changed("sensor", 0, "unit", value=spelling)).fields.sensor[0].unit == unit


@pytest.mark.parametrize("name", jobs())
def test_the_samples_say_the_same_after_a_round_trip(name):
    job = Job.load(path(name))
    again = Job.loads(job.to_toml(), job.folder)
    first, second = measure(job), measure(again)
    assert [plane.unbalance for plane in first.planes] == [plane.unbalance for plane in second.planes]
    assert first.why == second.why


@pytest.mark.parametrize(
    ("steps", "value", "words"),
    [
        (("conventions",), None, "conventions is missing"),
        (("conventions", "angles"), "cw", "conventions.angles is 'cw': use one of 'with rotation', 'against rotation'"),
        (("conventions", "phase"), None, 'conventions.phase is missing: say whether phases "lag" or "lead"'),
        (("conventions", "shows"), "unbalance", "conventions.shows is that of a balancing machine"),
        (("sensor",), None, "sensor is missing"),
        (("sensor", 0, "unit"), "furlong", r"sensor\[0\].unit is 'furlong': use one of µm, mil, mm/s"),
        (("sensor",), [{"id": "A", "unit": "mil"}] * 2, r"sensor\[1\].id is 'A', as that of sensor\[0\]"),
        (("run", 1, "id"), "0", r"run\[1\].id is '0', as that of run\[0\]"),
        (("run", 1, "weights", 0, "plane"), "X", r"run\[1\].weights\[0\].plane is 'X': use one of I"),
        (("run", 1, "weights", 0, "mass_g"), 0, r"run\[1\].weights\[0\].mass_g is 0: leave the weight out"),
        (("run", 1, "weights", 0, "angle"), None, r"run\[1\].weights\[0\].angle is missing"),
        (
            ("machine",),
            {"unit": "g·cm"},
            "machine.unit is 'g·cm': use one of 'g·mm', 'oz·in', and give the figures in it$",
        ),
        (("run", 1, "readings"), [], r"run\[1\].readings lack sensor A at 1500 r/min, which every run has to read"),
        (("run", 1, "readings", 0, "sensor"), "B", r"run\[1\].readings\[0\].sensor is 'B': use one of A"),
        (("run", 1, "readings", 0, "rpm"), 900, r"run\[1\].readings lack sensor A at 1500 r/min"),
        (("run", 1, "readings", 0, "phase"), None, r"run\[1\].readings\[0\].phase is missing"),
        (
            ("run", 1, "readings", 0, "amplitude"),
            -1,
            r"run\[1\].readings\[0\].amplitude is -1: it must not be",
        ),
        (("rpm",), None, r"run\[0\].readings\[0\].rpm is missing: give it, or rpm at the top"),
        (("plane", 0, "kit"), [{"mass_g": 5}], r"plane\[0\].kit goes with positions"),
        (("plane", 0, "kit"), [], r"plane\[0\].kit has 0 entries: give at least 1"),
        (
            ("plane",),
            [{"id": "I", "radius": 100, "positions": [0, 120, 240], "kit": [{"mass_g": 5, "radius": 120}]}],
            r"plane\[0\].kit\[0\].radius is another than the plane's, plane\[0\].radius",
        ),
        (("plane", 0, "bolt"), 5, r"plane\[0\].bolt is unknown"),
        (("plane",), [{"id": "I"}, {"id": "II"}], "2 runs cannot tell what a weight does in 2 planes"),
        (("tolerance",), {"grade": 6.3, "rpm": 3000}, "tolerance.mass is missing: a grade permits"),
        (("method",), "balancing machine", "sensor goes with no balancing machine"),
        (("coefficients",), "none.toml", "cannot read none.toml: there is no such file"),
        (("rotor",), "none.toml", "cannot read none.toml: there is no such file"),
        (("readings",), "none.csv", "cannot read none.csv: there is no such file"),
    ],
)
def test_what_is_wrong_is_named_by_its_path(steps, value, words):
    with pytest.raises((UsageError, ReadError), match=words):
        measure(Job.from_dict(changed(*steps, value=value)))


def test_the_first_run_alone_asks_for_a_trial_weight_of_a_size():
    # A tenth of 45 kg as force at 1480 r/min: 0.1 · 45 · 9.80665/154.985² kg m, at 250 mm 7.35 g.
    table = {**BASE, "rpm": 1480, "run": BASE["run"][:1], "plane": [{"id": "I", "radius": 250}]}
    table["tolerance"] = {"grade": 6.3, "mass": 45, "rpm": 1480}
    with pytest.raises(UsageError, match=r"one run cannot tell .* a tenth of the weight as force is 7.35 g in I"):
        measure(Job.from_dict(table))


def test_dates_may_be_those_of_toml():
    text = Job.from_dict(BASE).to_toml().replace("[conventions]", "[machine]\ndate = 2026-11-20\n\n[conventions]")
    assert Job.loads(text).fields.machine.date == "2026-11-20"


def test_a_plane_without_radius_has_no_limit_in_gmm():
    table = changed("plane", value=[{"id": "I", "permissible_gmm": 5.0}])
    with pytest.raises(UsageError, match=r"plane\[0\].radius is missing: what is permissible is in g·mm"):
        measure(Job.from_dict(table))
    (plane,) = measure(Job.from_dict(changed("plane", value=[{"id": "I"}]))).planes
    with_radius = measure(Job.from_dict(BASE)).planes[0]
    assert plane.unbalance * 0.1 == pytest.approx(with_radius.unbalance)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("run,sensor,amplitude,phase\n0,A,5,x\n", "line 2: phase is 'x': it must be a number, with a point"),
        ("run,sensor,amplitude,phase\n0,A,5\n", "line 2: it has 3 cells, and the first line 4"),
        ("run,sensor,phase\n", "no column amplitude"),
        ("run,sensor,amplitude,phase,colour\n", "the column 'colour' is unknown"),
        ("run,sensor,amplitude,phase\n7,A,5,6\n", "line 2: run is '7', which the job does not have"),
        ("run,sensor,amplitude,phase\n0,A,-5,6\n", "line 2: amplitude is -5.0: it must not be negative"),
        (
            "run,sensor,amplitude,phase\n0,A,5,6\n0,A,5,6\n",
            "line 3: it reads A at 1500 r/min a second time in run '0'",
        ),
        ("run,sensor,amplitude,phase\n0,A,5,6\n1,A,5,\n", "line 3: phase is missing: give it"),
        ("run,sensor,amplitude,phase\n0,A,5,6\n\n1,B,5,6\n", "line 4: sensor is 'B': use one of A"),
        ("run,sensor,amplitude,phase\n0,A,5,6\n", r"run\[1\].readings \(of run '1', in r.csv\) lack sensor A"),
        ("run,sensor,amplitude,phase,amplitude\n0,A,5,6,1\n", "names the column `amplitude` twice: leave one out"),
        ("run,sensor,amplitude,phase\n0,A,5_74,6\n", "line 2: amplitude is '5_74': it must be a number"),
        ("# a\nrun,sensor,amplitude,,phase\n0,A,5,x,6\n", "line 3 has 'x' in a column that the first line does not"),
        ("run,sensor,amplitude,phase\n0,A,5,6,7\n", "line 2 has 5 cells, and the first line 4 names"),
        ("run,sensor,amplitude,phase\n0,A,nan,6\n", "line 2: amplitude is nan: it must be finite"),
        ("run,sensor,amplitude,phase\n0," + 200_000 * "A" + ",5,6\n", "it is not CSV: field larger than field limit"),
        ("run;sensor;amplitude;phase\n0;A;5,5;6\n", "line 2: amplitude is '5,5': it must be a number, with a point"),
    ],
)
def test_tables_of_readings_name_the_line(text, words, tmp_path):
    table = copy.deepcopy(BASE)
    for run in table["run"]:
        del run["readings"]
    (tmp_path / "r.csv").write_text(text, encoding="utf-8")
    with pytest.raises((UsageError, ReadError), match=words):
        Job.from_dict(table | {"readings": "r.csv"}, tmp_path)


def test_readings_of_the_job_beside_a_table_are_named_by_their_place(tmp_path):
    (tmp_path / "r.csv").write_text("run,sensor,amplitude,phase\n1,A,5,6\n", encoding="utf-8")
    for k, words in ((0, r"r.csv: line 2: it reads A"), (1, r"run\[0\].readings\[0\].phase is missing")):
        table = copy.deepcopy(BASE) | {"readings": "r.csv"}
        if k:
            del table["run"][0]["readings"][0]["phase"], table["run"][1]["readings"]
        with pytest.raises(UsageError, match=words):
            Job.from_dict(table, tmp_path)


@pytest.mark.parametrize(
    "text",
    [
        "\ufeffRun;Sensor;Amplitude;Phase\n# trial; 1, 2, 3, 4, 5\n0;A;5.0;30\n\n1;A;8.0;60\n",
        "# analyser export, 2026-11-20\r\nrun;sensor;amplitude;phase\r\n0;A;5.0;30\r\n1;A;8.0;60\r\n",
        "#\tanalyser export, 2026-11-20\nrun,sensor,amplitude,phase\n0,A,5.0,30\n#\tignored\n1,A,8.0,60\n",
        "#,analyser export,,\nrun,sensor,amplitude,phase\n#,0,A,7,30\n0,A,5.0,30\n1,A,8.0,60\n#,door was open,,\n",
        "run;sensor;amplitude;phase\n0;A;5.0;30\n1;A;8.0;60\n#;door was open in the last run;;\n",
        '\n"# export; rev 2"\nrun,sensor,amplitude,phase,\n0,A,5.0,30,\n1,A,8.0,60\n',
        "run\tsensor\tamplitude\tphase\r0\tA\t5.0\t30\r1\tA\t8.0\t60\r",
        "run, sensor, amplitude, phase\n0, A, 5.0, 30\n1, A, 8.0, 60\n",
    ],
)
def test_tables_are_read_with_any_separator_comments_and_a_separator_at_the_end(text, tmp_path):
    table = copy.deepcopy(BASE)
    for run in table["run"]:
        del run["readings"]
    (tmp_path / "r.csv").write_text(text, encoding="utf-8")
    job = Job.from_dict(table | {"readings": "r.csv"}, tmp_path)
    assert measure(job).planes[0].unbalance == measure(Job.from_dict(BASE)).planes[0].unbalance


def test_a_job_is_found_with_its_files(tmp_path):
    folder = shutil.copytree(path("jobs/fan.toml").parent, tmp_path / "jobs")
    assert measure(Job.load(folder / "fan.toml")).outcome == "pass"
