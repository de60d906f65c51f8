"""Many files, a row for each: whatever is wrong with them, and whatever becomes of the processes that answer."""

import gzip
import hashlib
import importlib.util
import io
import math
import os
import re
import signal
import sys
import tarfile
import threading
import time
import warnings
import zipfile
from collections import Counter
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import inertia
from inertia.batching import table
from inertia.batching.answer import Answer, Setup, answer
from inertia.batching.sources import Task
from inertia.batching.table import Parts
from inertia_meshes import path

CUBE, HANDLE, OPEN, CUT = (
    path(name) for name in ("cube.stl", "t_handle.stl", "broken/missing_face.stl", "broken/truncated.stl")
)
BROKEN = sorted(path("broken/missing_face.stl").parent.glob("*.stl"))


def rows(*paths: Any, jobs: int = 1, **options: Any) -> list[dict[str, Any]]:
    return list(inertia.batch(paths, jobs=jobs, **options))


def test_a_row_says_what_the_analysis_says() -> None:
    (row,) = rows(HANDLE, density=7850.0, unit="mm")
    analysis = inertia.analyse(inertia.read(HANDLE, unit="mm"), 7850.0)
    properties = analysis.properties
    assert row["path"] == str(HANDLE)
    assert row["sha256"] == hashlib.sha256(HANDLE.read_bytes()).hexdigest()
    assert (row["state"], row["exit_code"], row["message"]) == ("answered", 0, None)
    assert (row["unit"], row["unit_from"], row["density"], row["density_from"]) == ("mm", "option", 7850.0, "option")
    assert (row["mass"], row["volume"], row["area"]) == (properties.mass, properties.volume, analysis.area)
    assert [row[f"com_{k}"] for k in "xyz"] == properties.center_of_mass.tolist()
    tensor = [[row[f"i{''.join(sorted(j + k))}"] for k in "xyz"] for j in "xyz"]
    assert tensor == properties.inertia.tolist()
    moments = np.array([row[f"i{k}"] for k in (1, 2, 3)])
    axes = Rotation.from_quat([row[f"axes_{k}"] for k in "xyzw"]).as_matrix()
    assert axes @ np.diag(moments) @ axes.T == pytest.approx(np.array(tensor), abs=1e-15 * moments[2])
    assert row["error_inertia"] == properties.error.inertia
    assert row["seconds"] > 0


def test_every_file_has_its_row_in_the_order_of_its_name_with_any_number_of_workers(tmp_path: Path) -> None:
    for number, file in enumerate([CUT, CUBE, path("broken/nan.stl"), HANDLE] * 4):
        (tmp_path / f"{number:02}.stl").write_bytes(file.read_bytes())
    (tmp_path / "deep/er").mkdir(parents=True)
    (tmp_path / "deep/er/last.stl").write_bytes(CUBE.read_bytes())
    (tmp_path / "words.stl").write_text("no mesh at all")
    one, two, four = (list(inertia.batch(f"{tmp_path}/**/*.stl", jobs=jobs)) for jobs in (1, 2, 4))
    for row in (*one, *two, *four):
        del row["seconds"]
    assert one == two == four
    assert [row["path"] for row in one] == sorted(map(str, tmp_path.glob("**/*.stl")))
    assert {row["state"] for row in one} == {"answered", "refused", "unreadable"}


@pytest.fixture(scope="module")
def refused() -> dict[str, dict[str, Any]]:
    return {row["path"]: row for row in rows(*BROKEN)}


@pytest.mark.parametrize("file", BROKEN, ids=lambda file: file.stem)
def test_what_is_refused_says_what_the_library_raises(file: Path, refused: dict[str, dict[str, Any]]) -> None:
    row = refused[str(file)]
    with pytest.raises(inertia.InertiaError) as raised:
        inertia.analyse(inertia.read(file))
    assert row["exit_code"] == raised.value.exit_code
    assert row["message"] == str(raised.value.sentence)
    assert row["state"] == ("unreadable" if row["exit_code"] == 3 else "refused")
    assert row["sha256"] == hashlib.sha256(file.read_bytes()).hexdigest()
    assert row["mass"] is None


def test_where_a_fault_is_stands_in_the_row() -> None:
    (row,) = rows(path("broken/flipped_face.stl"))
    assert [float(k) for k in row["place"].split(", ")] == [-5.0, 0.0, -5.0]


def test_what_is_not_there_has_a_row_too(tmp_path: Path) -> None:
    missing, folder = rows(tmp_path / "none.stl", tmp_path)
    assert (missing["state"], missing["exit_code"], missing["sha256"]) == ("unreadable", 3, None)
    assert "there is no such file" in missing["message"]
    assert "it is a directory" in folder["message"]


def test_the_page_lists_the_columns() -> None:
    docs = Path(__file__).parents[2] / "docs"
    spec = importlib.util.spec_from_file_location("list_columns", docs / "list_columns.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert (docs / "json.md").read_text(encoding="utf-8") == module.page(), "run python docs/list_columns.py"


def test_the_check_of_a_file_is_a_row() -> None:
    good, bad = rows(CUBE, OPEN, verb="check")
    assert (good["state"], good["exit_code"], good["fit"], good["closed"], good["errors"]) == (
        "answered", 0, True, True, 0,
    )  # fmt: skip
    assert (bad["state"], bad["exit_code"], bad["fit"], bad["closed"]) == ("refused", 4, False, False)
    assert bad["findings"].split()[0] == "open"
    assert bad["message"].startswith("open: ")


def test_what_the_orientation_forgives_is_no_error_of_a_row() -> None:
    turned = path("broken/inside_out.stl")
    for orientation, fit, errors in (("stored", False, 1), ("absolute", True, 0)):
        (row,) = rows(turned, verb="check", orientation=orientation)
        assert (row["fit"], row["errors"], row["findings"]) == (fit, errors, "inward")
        assert (row["message"] is None) is fit


def test_the_audit_of_a_robot_is_a_row() -> None:
    (row,) = rows(path("robots/arm.urdf"), verb="audit")
    audit = inertia.audit(path("robots/arm.urdf"))
    assert row["verdict"] == audit.verdict
    assert row["links"] == len(audit.links)
    assert row["inconsistent"] == sum(link.state == "inconsistent" for link in audit.links)
    assert row["worst_mass"] == max(link.difference.mass for link in audit.links if link.difference is not None)
    assert (row["state"], row["exit_code"]) == ("answered", {"consistent": 0, "inconsistent": 5}[audit.verdict])


def test_the_audit_of_a_robot_without_its_meshes_says_why_it_is_undecided(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_bytes(path("robots/arm.urdf").read_bytes())
    (row,) = rows(tmp_path / "arm.urdf", verb="audit")
    assert (row["verdict"], row["exit_code"]) == ("undecided", 4)
    assert row["message"] == "base: t_handle.stl: there is no such file"


def test_of_an_audit_that_is_undecided_what_could_not_be_compared_is_told(tmp_path: Path) -> None:
    arm = path("robots/arm.urdf").read_text(encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(arm.replace("<link ", '<link name="world"/><link ', 1))
    (row,) = rows(tmp_path / "arm.urdf", verb="audit")
    assert row["message"] == "base: t_handle.stl: there is no such file"


def test_the_first_note_of_an_audit_that_finds_nothing_is_its_message(tmp_path: Path) -> None:
    box = '<box size="1 1 1"/>'
    (tmp_path / "a.urdf").write_text(
        '<robot name="r"><link name="a"><inertial><mass value="6"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"'
        f' iyz="0"/></inertial><visual><geometry>{box}</geometry></visual></link><joint name="j" type="fixed">'
        '<parent link="a"/><child link="a"/></joint></robot>'
    )
    (row,) = rows(tmp_path / "a.urdf", verb="audit")
    assert (row["verdict"], row["exit_code"]) == ("consistent", 0)
    assert row["message"] == inertia.audit(tmp_path / "a.urdf").robot.notes[0]


@pytest.mark.parametrize(
    ("verb", "name", "other"),
    [("balance", "rotors/disc.toml", "disc.stl"), ("audit", "robots/arm.urdf", ".stl")],
)
def test_an_answer_rests_on_the_files_that_its_file_refers_to(verb: str, name: str, other: str) -> None:
    files = [used.path for used in answer(Task(str(path(name))), Setup(verb)).files]
    assert files[0] == str(path(name))
    assert any(other in file for file in files)
    assert all(Path(file).suffix in (".toml", ".urdf", ".stl", ".obj", ".dae", ".gltf", ".bin") for file in files)


def test_the_balance_of_a_rotor_is_a_row() -> None:
    (row,) = rows(path("rotors/disc.toml"), verb="balance")
    balance = inertia.balance(inertia.Rotor.load(path("rotors/disc.toml")))
    assert row["verdict"] == balance.verdict.outcome
    assert row["within"] == balance.scatter.within
    assert row["static_gmm"] == pytest.approx(abs(balance.initial.static) * 1e6, rel=1e-12)


@pytest.mark.parametrize(
    ("mass", "service", "verdict", "says"),
    [
        ("0.001", "", "pass", "plane A: .*: PASS"),
        ("0.006", "", "fail", "plane B: 59.4 .*: FAIL"),  # 6 g, 10 mm from the axis, at 0.99 of the span
        ('"0.0010±0.0006"', "", "undecided", "plane B: .*: UNDECIDED"),
        ("0.001", "critical_rpm = 3500", "undecided", r"the speed is 0\.857 of the critical one"),
    ],
)
def test_the_row_of_a_rotor_says_what_decides(mass: str, service: str, verdict: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(
        'schema = 1\nunit = "mm"\n[[part]]\nname = "disc"\nshape = "cylinder"\nsize = [80, 40]\nmass = 1.0\n'
        f'[[part]]\nname = "screw"\nshape = "point"\nat = [10, 0, 49]\nmass = {mass}'
    )
    (tmp_path / "r.toml").write_text(
        'schema = 1\nunit = "mm"\nassembly = "a.toml"\n[axis]\nbearing_a = [0, 0, -50]\nbearing_b = [0, 0, 50]\n'
        f"[service]\nrpm = 3000\n{service}\n[tolerance]\ngrade = 6.3"
    )
    (row,) = rows(tmp_path / "r.toml", verb="balance")
    assert row["verdict"] == verdict
    assert re.match(says, row["message"])


def test_the_row_of_a_rotor_within_tolerance_as_planned_alone_says_so(tmp_path: Path) -> None:
    rotor = path("rotors/two_disc_rotor.toml").read_text().replace("../", f"{path('cube.stl').parent}/")
    (tmp_path / "shop.toml").write_text(f"{rotor}[uncertainty]\ndepth = 3\nangle = 15\n")
    (row,) = rows(tmp_path / "shop.toml", verb="balance")
    assert row["verdict"] == "conditional"
    assert row["message"].startswith("as made, ")


def test_a_plan_that_was_cut_short_says_so() -> None:
    (row,) = rows(path("rotors/overhung_impeller.toml"), verb="balance", time=1e-9)
    assert row["message"].startswith(("plane ", "as made, "))
    assert row["message"].endswith("the best that was found in the time that it was given")


@pytest.mark.parametrize("name", ["parts.zip", "parts.tar", "parts.tar.gz"])
def test_each_mesh_in_an_archive_is_a_file(name: str, tmp_path: Path) -> None:
    archive, files = tmp_path / name, {"b/cube.stl": CUBE, "a/t.stl": HANDLE, "a/open.stl": OPEN, "README": __file__}
    if name.endswith("zip"):
        with zipfile.ZipFile(archive, "w") as packed:
            for inside, file in files.items():
                packed.write(file, inside)
    else:
        stream = io.BytesIO()
        with tarfile.open(fileobj=stream, mode="w") as tar:
            for inside, file in files.items():
                tar.add(file, inside)
        archive.write_bytes(gzip.compress(stream.getvalue()) if name.endswith("gz") else stream.getvalue())
    cube, handle, hole = rows(archive)
    assert [row["path"] for row in (cube, handle, hole)] == [f"{archive}/{inside}" for inside in [*files][:3]]
    assert cube["sha256"] == hashlib.sha256(CUBE.read_bytes()).hexdigest()
    assert handle["mass"] == rows(HANDLE)[0]["mass"]
    assert hole["message"].startswith(f"{archive}/a/open.stl: open: ")


def test_an_archive_in_an_archive_has_its_row_and_what_is_encrypted_says_so(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "two.zip", "w") as packed:
        packed.write(CUBE, "a.stl")
        packed.write(CUBE, "b.stl")
    with zipfile.ZipFile(tmp_path / "outer.zip", "w") as packed:
        packed.write(tmp_path / "two.zip", "two.zip")
    outer = (tmp_path / "two.zip").read_bytes()
    (row,) = rows(tmp_path / "outer.zip")
    assert row["message"].startswith(f"cannot read {tmp_path}/outer.zip/two.zip: it holds 2 meshes, a.stl, b.stl")
    data = bytearray((tmp_path / "two.zip").read_bytes())
    for signature, flags in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
        for place in (data.find(signature), data.rfind(signature)):
            data[place + flags] |= 1
    (tmp_path / "two.zip").write_bytes(data)
    one, other = rows(tmp_path / "two.zip")
    assert one["message"] == f"cannot read {tmp_path}/two.zip/a.stl: it is encrypted: unpack it and give the mesh in it"
    assert other["state"] == "unreadable"
    assert (row["sha256"], one["sha256"], other["sha256"]) == (hashlib.sha256(outer).hexdigest(), None, None)


def test_an_archive_with_one_mesh_is_a_file(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "part.zip", "w") as packed:
        packed.write(CUBE, "cube.stl")
    (tmp_path / "cut.zip").write_bytes((tmp_path / "part.zip").read_bytes()[:200])
    one, cut = rows(tmp_path / "part.zip", tmp_path / "cut.zip")
    assert (one["path"], one["state"]) == (str(tmp_path / "part.zip"), "answered")
    assert "damaged" in cut["message"]


def test_a_url_is_read_where_its_back_end_is_there(tmp_path: Path) -> None:
    pytest.importorskip("fsspec")
    (tmp_path / "b.stl").write_bytes(CUBE.read_bytes())
    (tmp_path / "a.stl").write_bytes(OPEN.read_bytes())
    (bad, good), (missing,) = rows(f"file://{tmp_path}/*.stl"), rows(f"file://{tmp_path}/none.stl")
    assert [bad["path"], good["path"]] == [f"file://{tmp_path}/{name}.stl" for name in "ab"]
    assert good["sha256"] == hashlib.sha256(CUBE.read_bytes()).hexdigest()
    assert bad["message"].startswith(f"file://{tmp_path}/a.stl: open: ")
    assert (missing["state"], missing["exit_code"]) == ("unreadable", 3)
    assert missing["message"] == f"cannot read file://{tmp_path}/none.stl: there is no such file: check the URL"
    with pytest.raises(inertia.UsageError, match="nowhere"):
        rows("nowhere://bucket/part.stl")


def test_a_manifest_has_options_for_each_row(tmp_path: Path) -> None:
    for name, file in (("cube.stl", CUBE), ("t.stl", HANDLE)):
        (tmp_path / name).write_bytes(file.read_bytes())
    manifest = tmp_path / "manifest.csv"
    manifest.write_text(
        "#order,path,unit,density,material,mass\n1,cube.stl,cm,7850±50,,\n2,t.stl,,,steel,\n3,t.stl,,,,2\n"
    )
    cube, steel, weighed = rows(manifest, unit="mm")
    assert (cube["path"], cube["unit"], cube["density"]) == (str(tmp_path / "cube.stl"), "cm", 7850.0)
    assert (steel["unit"], steel["density_from"]) == ("mm", "material")
    assert (weighed["mass"], weighed["density_from"]) == (2.0, "mass")


@pytest.mark.parametrize("between", [",", ";", "\t"])
def test_a_manifest_may_be_one_that_a_spreadsheet_wrote_in_another_country(between: str, tmp_path: Path) -> None:
    lines = ["Path", "UNIT", "Density"], [str(CUBE), "cm", '"1=7850; =3"'], [str(HANDLE), "", ""]
    manifest = tmp_path / "manifest.csv"
    manifest.write_text("".join(f"{between.join(line)}\r\n" for line in lines), encoding="utf-8-sig", newline="")
    cube, handle = rows(manifest)
    assert (cube["unit"], cube["density"], handle["unit"]) == ("cm", 7850.0, "mm")


def test_the_same_options_in_another_order_are_the_same(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"path,unit,density\n{CUBE},cm,1=2; =3\n")
    (tmp_path / "b.csv").write_text(f"density,path,unit\n=3; 1=2,{CUBE},cm\n")
    assert len(rows(tmp_path / "a.csv", tmp_path / "b.csv")) == 1


def test_what_a_row_says_of_its_mass_takes_the_place_of_what_is_said_for_all(tmp_path: Path) -> None:
    (tmp_path / "manifest.csv").write_text(f"path,material,mass\n{CUBE},steel,\n{HANDLE},,2\n{CUBE},,\n")
    steel, weighed, common = rows(tmp_path / "manifest.csv", density=5.0)
    assert (steel["density_from"], weighed["mass"], common["density"]) == ("material", 2.0, 5.0)


@pytest.mark.parametrize("missing", [None, math.nan])
def test_a_manifest_may_be_parquet(missing: float | None, tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    table = pyarrow.table({"path": [str(CUBE), str(HANDLE)], "density": [1.0, missing], "material": [None, "steel"]})
    parquet.write_table(table, tmp_path / "manifest.parquet")
    cube, handle = rows(tmp_path / "manifest.parquet")
    assert cube["density"] == 1.0
    assert handle["density_from"] == "material"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("part number,unit\n", "has no column 'path'"),
        ("path,densty\ncube.stl,7850\n", "'densty' is no option of analyse"),
        ("path,density\ncube.stl,heavy\n", "row 2: density is 'heavy'"),
        ("path,unit\n,mm\n", "row 2: the path is empty"),
        ("path|unit\ncube.stl|mm\n", "no column 'path', but 'path|unit': .* commas"),
        ("Unit,path,unit\nmm,cube.stl,in\n", "two columns 'unit'"),
        ("path;density\ncube.stl;7;85\n", "more cells than .* round a cell with a semicolon in it"),
        ("path,unit,unit\ncube.stl,mm,in\n", "two columns 'unit'"),
        ("path,density\ncube.stl,7,85\n", "line 2: it has more cells than there are columns"),
        ("path,unit\n", "names no file"),
        ("", "names no file"),
    ],
)
def test_a_manifest_that_cannot_be_meant_is_refused(text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "manifest.csv").write_text(text)
    if says == "has no column 'path'":
        (tmp_path / "manifest.csv").write_text(f"{text}1,mm\n")
    with pytest.raises(inertia.UsageError, match=says):
        rows(tmp_path / "manifest.csv")


def test_a_manifest_that_is_no_table_is_refused(tmp_path: Path) -> None:
    (tmp_path / "open.csv").write_text(f'path,unit\n"{CUBE},mm\n')
    with pytest.raises(inertia.ReadError, match="it is no CSV"):
        rows(tmp_path / "open.csv")
    pyarrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    (tmp_path / "junk.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(inertia.ReadError, match="no Parquet table"):
        rows(tmp_path / "junk.parquet")
    parquet.write_table(pyarrow.table({"path": [1, 2]}), tmp_path / "numbers.parquet")
    with pytest.raises(inertia.UsageError, match="row 1: the path is 1, which is no text"):
        rows(tmp_path / "numbers.parquet")
    parquet.write_table(pyarrow.table({"path": [str(CUBE), None]}), tmp_path / "empty.parquet")
    with pytest.raises(inertia.UsageError, match="row 2: the path is empty"):
        rows(tmp_path / "empty.parquet")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"verb": "weigh"}, "verb is 'weigh'"),
        ({"densty": 7850.0}, "densty is no option of analyse"),
        ({"verb": "check", "density": 7850.0}, "density is no option of check"),
        ({"jobs": 0}, "jobs is 0"),
        ({"timeout": 0.0}, "timeout is 0.0"),
        ({"memory": -1}, "memory is -1"),
        ({"shard": (3, 2)}, "shard 3 of 2"),
        ({"unit": "parsec"}, "unknown unit 'parsec'"),
        ({"density": -4.0}, "density is -4"),
        ({"density": 4.0, "material": "steel"}, "both a density and a material"),
        ({"material": "unobtainium"}, "unknown material"),
    ],
)
def test_arguments_that_cannot_be_meant_are_refused_at_once(arguments: dict[str, Any], says: str) -> None:
    with pytest.raises(inertia.UsageError, match=says):
        inertia.batch([CUBE], **arguments)


def test_a_glob_that_matches_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(inertia.UsageError, match=r"none\*\.stl matches no file"):
        inertia.batch(f"{tmp_path}/none*.stl")


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and symbolic links")
def test_pipes_and_links_that_lead_back_take_no_time(tmp_path: Path) -> None:
    (tmp_path / "in/deep").mkdir(parents=True)
    (tmp_path / "in/deep/cube.stl").write_bytes(CUBE.read_bytes())
    for name, target in (("back", ".."), ("again", "../.."), ("self.stl", "self.stl"), ("none.stl", "nowhere")):
        (tmp_path / "in/deep" / name).symlink_to(target)
    for name in ("pipe.stl", "pipe.csv", "pipe.parquet", "pipe.jsonl", "cube.csv.meta.json"):
        os.mkfifo(tmp_path / "in" / name)
    (tmp_path / "in/cube.csv").write_bytes(CUBE.read_bytes())
    found = [row["path"].rpartition("/")[2] for row in rows(f"{tmp_path}/in/*.[cjps]*")]
    assert found == ["cube.csv", "cube.csv.meta.json", "pipe.csv", "pipe.jsonl", "pipe.parquet", "pipe.stl"]
    with pytest.raises(inertia.ReadError, match=r"pipe.csv: it is not a regular file but a pipe"):
        inertia.batch(f"{tmp_path}/in/p*.csv")
    every = rows(f"{tmp_path}/**/*.stl")
    names = ["in/deep/cube.stl", "in/deep/none.stl", "in/deep/self.stl", "in/pipe.stl"]
    assert [row["path"] for row in every] == [f"{tmp_path}/{name}" for name in names]
    assert [row["state"] for row in every] == ["answered", "unreadable", "unreadable", "unreadable"]
    assert [row["path"] for row in rows(f"{tmp_path}/**/deep/cube*", f"{tmp_path}/i*/**/cube.stl")] == [
        f"{tmp_path}/{names[0]}"
    ]
    with pytest.raises(inertia.UsageError, match="the path of a file is empty"):
        inertia.batch("")


def test_an_option_that_a_file_cannot_have_is_its_own_refusal() -> None:
    (row,) = rows(CUBE, density={"housing": 1.0})
    with pytest.raises(inertia.UsageError) as raised:
        inertia.analyse(inertia.read(CUBE), {"housing": 1.0})
    assert (row["state"], row["exit_code"]) == ("refused", 2)
    assert row["message"] == f"{CUBE}: {raised.value.sentence}"


def test_shards_are_the_whole_together() -> None:
    names = [f"{number}.stl" for number in range(5)]  # which are not there
    first, second = ([row["path"] for row in rows(*names, shard=(k, 2))] for k in (1, 2))
    assert (first, second) == (names[::2], names[1::2])


def workers() -> list[int]:
    """Return the workers that this process has started, whatever else other tests have."""
    numbers = []
    for each in Path("/proc/self/task").glob("*/children"):
        for number in each.read_text().split():
            with suppress(OSError):  # it ends meanwhile
                if b"batching.process" in Path(f"/proc/{number}/cmdline").read_bytes():
                    numbers.append(int(number))
    return numbers


LINUX = pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")


@pytest.fixture
def large(tmp_path: Path) -> Path:
    """A mesh that takes more than a few MiB to read: text with many triangles."""
    facet = "facet normal 0 0 0\nouter loop\nvertex {0} 0 0\nvertex {0} 1 0\nvertex {0} 0 1\nendloop\nendfacet\n"
    text = "solid large\n" + "".join(map(facet.format, range(400_000))) + "endsolid large\n"
    (tmp_path / "large.stl").write_text(text)
    return tmp_path / "large.stl"


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    (tmp_path / "bad.stl").write_bytes(CUBE.read_bytes())
    return tmp_path / "bad.stl"


def upon_opening(bad: Path, action: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every process started from now on do something when it opens a file."""
    (bad.parent / "sitecustomize.py").write_text(
        "import os, sys, time\n"
        "def hook(event, arguments):\n"
        f"    if event == 'open' and str(arguments[0]) == {str(bad)!r}:\n"
        f"        {action}\n"
        "sys.addaudithook(hook)\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(bad.parent), prepend=os.pathsep)


def test_a_file_that_takes_too_long_has_a_row_that_says_so(bad: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    upon_opening(bad, "time.sleep(600)", monkeypatch)
    before, late, after = rows(CUBE, bad, HANDLE, timeout=4.0)
    assert (late["state"], late["exit_code"]) == ("timed_out", 4)
    assert "it took longer than the 4 s that a file may take" in late["message"]
    assert late["message"].endswith("allow it more by timeout=SECONDS")
    assert late["sha256"] == hashlib.sha256(bad.read_bytes()).hexdigest()
    assert 4.0 < late["seconds"] < 60.0
    assert before["state"] == after["state"] == "answered"


def test_a_limit_that_is_shorter_than_the_time_between_looks_holds(bad: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    upon_opening(bad, "time.sleep(0.02)", monkeypatch)
    (late,) = rows(bad, timeout=0.019)
    assert (late["state"], late["mass"]) == ("timed_out", None)
    assert late["seconds"] > 0.019  # a look may fall between the limit and the end


def _never_hashed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let hashing wait, as on a mount that hangs."""
    monkeypatch.setattr("inertia.batching.answer.sha256_of", lambda *_: threading.Event().wait(20))


def test_a_file_that_nothing_is_known_of_in_time_is_asked_for_again(bad: Path) -> None:
    late = Setup("analyse", timeout=0.1).failed(Task(str(bad)), "timed_out", "it took longer than the 0.1 s")
    assert [file.unchanged for file in late.files] == [False]


def test_hashing_what_took_too_long_waits_no_longer_than_mounts_take(
    bad: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("inertia.batching.answer.MOUNT", 0.1)
    _never_hashed(monkeypatch)
    late = Setup("analyse").failed(Task(str(bad)), "timed_out", "it took longer", 1.0, bad.stat())
    assert (late.row["state"], late.row["sha256"]) == ("timed_out", None)


def test_what_changed_meanwhile_is_not_hashed(bad: Path) -> None:
    before = bad.stat()
    bad.write_bytes(HANDLE.read_bytes())
    late = Setup("analyse").failed(Task(str(bad)), "crashed", "it died", 1.0, before)
    assert late.row["sha256"] is None
    assert [file.unchanged for file in late.files] == [False]


def test_a_kept_row_whose_file_cannot_be_hashed_in_time_is_asked_for_again(
    bad: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    setup, task, folder = Setup("analyse", timeout=0.1), Task(str(bad)), bad.parent / "a.csv.parts"
    with closing(Parts(folder, setup)) as parts:
        parts.add(task, answer(task, setup))
    assert Parts(folder, setup).answer(task) is not None
    os.utime(bad, (1, 1))  # so that its contents decide
    assert Parts(folder, setup).answer(task) is not None
    _never_hashed(monkeypatch)
    assert Parts(folder, setup).answer(task) is None


def test_a_kept_row_counts_for_the_same_question_alone(bad: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    setup, task, folder = Setup("analyse", {"density": 7850.0}), Task(str(bad)), bad.parent / "a.csv.parts"
    with closing(Parts(folder, setup)) as parts:
        parts.add(task, answer(task, setup))
    kept = Parts(folder, setup).answer(task)
    assert kept is not None
    assert kept.stored
    assert Parts(folder, Setup("analyse", {"density": 1000.0})).answer(task) is None
    assert Parts(folder, Setup("analyse", {"density": 7850.0, "unit": "m"})).answer(task) is None
    assert Parts(folder, Setup("check")).answer(task) is None
    assert Parts(folder, setup).answer(Task(str(bad), {"unit": "in"})) is None
    monkeypatch.setitem(vars(table), "__version__", "0.0.1")
    assert Parts(folder, setup).answer(task) is None


@pytest.mark.parametrize("kind", ["zip", "tar"])
@pytest.mark.parametrize("beside", [[], ["handle.stl"]])
def test_members_of_an_archive_that_share_a_name_are_refused(tmp_path: Path, kind: str, beside: list[str]) -> None:
    file = tmp_path / f"order.{kind}"
    members = [("cube.stl", CUBE), ("cube.stl", HANDLE), *((name, HANDLE) for name in beside)]
    with ExitStack() as stack:
        if kind == "zip":
            archive = stack.enter_context(zipfile.ZipFile(file, "w"))
            stack.enter_context(warnings.catch_warnings(action="ignore"))  # of the name that is there already
        else:
            archive = stack.enter_context(tarfile.open(file, "w"))
        for name, mesh in members:
            archive.write(mesh, name) if kind == "zip" else archive.add(mesh, name)
    refused, *others = rows(file)
    assert (refused["state"], refused["exit_code"], refused["mass"]) == ("unreadable", 3, None)
    says = (
        "the archive holds 2 files called cube.stl, and nothing says which is meant: pack it again, each under a name"
    )
    assert says in refused["message"]
    assert [row["state"] for row in others] == ["answered"] * len(beside)


@LINUX
def test_a_file_that_takes_too_much_memory_has_a_row_that_says_so(large: Path) -> None:
    refused, answered = rows(large, CUBE, memory=10_000_000)
    assert refused["state"] in ("refused", "unreadable")
    assert "needs more memory than a file may take, 10 MB: allow more by memory=BYTES" in refused["message"]
    assert answered["state"] == "answered"


@LINUX
def test_a_fault_that_shows_piece_by_piece_is_named_where_memory_is_short(tmp_path: Path) -> None:
    triangles = np.tile(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4"), (600_000, 1, 1))
    triangles[:, :, 2] = np.arange(600_000)[:, None]
    records = np.zeros(600_000, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    records["corners"] = triangles
    count = np.array(600_000, "<u4").tobytes()
    (tmp_path / "open.stl").write_bytes(bytes(80) + count + records.tobytes())
    (row, again) = rows(tmp_path / "open.stl", OPEN, memory=60_000_000)
    assert (row["state"], row["exit_code"]) == ("refused", 4)
    assert "open.stl: open: " in row["message"]
    assert "memory" not in row["message"]
    assert again["message"].startswith(f"{OPEN}: open: ")


@LINUX
def test_what_refusals_import_counts_for_no_file() -> None:
    (row,) = rows(OPEN, memory=15_000_000, timeout=60)
    assert (row["state"], row["message"]) == ("refused", rows(OPEN)[0]["message"])


@LINUX
def test_a_file_whose_process_dies_twice_has_a_row_and_all_others_too(
    bad: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    upon_opening(bad, "os.kill(os.getpid(), 9)", monkeypatch)
    before, dead, after = rows(CUBE, bad, HANDLE)
    assert (dead["state"], dead["exit_code"]) == ("crashed", 1)
    assert "died (signal 9), and so did the second one" in dead["message"]
    assert dead["sha256"] == hashlib.sha256(CUBE.read_bytes()).hexdigest()
    assert dead["seconds"] > 0
    assert before["state"] == after["state"] == "answered"


class Backwards:
    """An engine that answers for the last file first."""

    window = 9

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self.waiting: list[tuple[int, Task]] = []

    def submit(self, number: int, task: Task) -> None:
        self.waiting.append((number, task))

    def results(self) -> list[tuple[int, Answer]]:
        number, task = self.waiting.pop()
        return [(number, answer(task, self.setup))]

    def close(self) -> None:
        pass


def test_progress_counts_files_as_they_arrive() -> None:
    engine, counts = Backwards(Setup("check")), []
    tasks = [Task(str(file)) for file in (CUBE, HANDLE, OPEN)]
    table.write_batch(
        None, tasks, engine.setup, lambda: engine, progress=lambda s: counts.append((s.rows, len(engine.waiting)))
    )
    assert counts == [(1, 2), (2, 1), (3, 0)]


def test_the_table_of_another_run_is_not_replaced_and_the_parts_of_each_stay(tmp_path: Path) -> None:
    engine, file = Backwards(Setup("check")), tmp_path / "t.csv"
    parts, tasks = tmp_path / "t.csv.parts", [Task(str(CUBE))]
    parts.mkdir()
    (parts / "0123456789abcdef.jsonl").write_text("")
    with pytest.raises(inertia.UsageError, match=r"t.csv exists: give another name, or force=True"):
        table.write_batch(file, tasks, engine.setup, lambda: engine, progress=lambda _: file.write_text("theirs"))
    assert file.read_text() == "theirs"
    assert len(list(parts.iterdir())) == 2

    def others(_: object) -> None:
        (parts / "fedcba9876543210.jsonl").write_text("theirs")

    summary = table.write_batch(file, tasks, engine.setup, lambda: engine, force=True, progress=others)
    assert summary.stored == 1
    assert [each.name for each in parts.iterdir()] == ["fedcba9876543210.jsonl"]


def test_parts_that_another_run_removes_are_asked_for_again(tmp_path: Path) -> None:
    setup, task = Setup("check"), Task(str(CUBE))
    with closing(Parts(tmp_path, setup)) as parts:
        parts.add(task, answer(task, setup))
    again = Parts(tmp_path, setup)
    next(tmp_path.glob("*.jsonl")).unlink()
    assert again.answer(task) is None


def test_a_folder_that_parts_cannot_be_kept_in_is_said_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    says = "parts, where finished rows are kept, cannot be used"
    with pytest.raises(inertia.InertiaError, match=rf"{says} \(File name too long\): name another table$"):
        Parts(tmp_path / f"{250 * 'a'}.parts", Setup("check"))
    (tmp_path / "a.parts").mkdir()
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(inertia.InertiaError, match=rf"{says} \(Permission denied\): name another table, or remove it$"):
        Parts(tmp_path / "a.parts", Setup("check"))


def test_a_folder_that_goes_while_rows_are_kept_is_said(tmp_path: Path) -> None:
    (tmp_path / "gone").mkdir()
    task, setup = Task(str(CUBE)), Setup("check")
    parts = Parts(tmp_path / "gone" / "t.csv.parts", setup)
    parts.add(task, answer(task, setup))
    (tmp_path / "gone").rmdir()
    says = r"t.csv.parts, .* \(No such file or directory\): name a table in a folder that is there$"
    with pytest.raises(inertia.WriteError, match=says):
        parts.close()


def test_a_table_that_another_run_writes_is_left_to_it(tmp_path: Path) -> None:
    engine, file, said = Backwards(Setup("check")), tmp_path / "t.csv", []

    def again(_: object) -> None:
        for force in (False, True):
            with pytest.raises(inertia.UsageError) as refused:
                table.write_batch(file, [Task(str(CUBE))], engine.setup, lambda: pytest.fail("asked"), force=force)
            said.append(str(refused.value))

    table.write_batch(file, [Task(str(CUBE))], engine.setup, lambda: engine, progress=again)
    assert said == [f"another run writes {file}: wait until it ends, or name another table"] * 2
    assert sorted(each.name for each in tmp_path.iterdir()) == ["t.csv", "t.csv.meta.json"]
    with pytest.raises(inertia.UsageError, match=r"t.csv exists: give another name"):
        table.write_batch(file, [Task(str(CUBE))], engine.setup, lambda: pytest.fail("asked"))


@LINUX
def test_no_row_is_lost_and_none_comes_twice_when_workers_are_killed(tmp_path: Path) -> None:
    names = []
    for number in range(240):
        names.append(tmp_path / f"{number:03}.stl")
        names[-1].write_bytes(HANDLE.read_bytes())
    result, kills = [], 0
    for row in inertia.batch(names, jobs=2):
        result.append(row)
        if len(result) % 10 == 0 and (alive := workers()):  # what was done ahead comes when none is left
            with suppress(ProcessLookupError):  # it has gone meanwhile
                os.kill(alive[0], signal.SIGKILL)
                kills += 1
    assert kills >= 2
    assert [row["path"] for row in result] == list(map(str, names))
    states = Counter(row["state"] for row in result)
    assert states["answered"] + states["crashed"] == len(names)
    assert 2 * states["crashed"] <= kills  # of a file at which two were killed


@pytest.mark.skipif(sys.platform == "win32", reason="a run that ends finds what it has left by its locks")
def test_workers_leave_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a tar archive is unpacked to stays until the next one's turn."""
    with tarfile.open(tmp_path / "two.tar", "w") as archive:
        for name in ("a.stl", "b.stl"):
            archive.add(CUBE, name)
    (folder := tmp_path / "temporary").mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    assert [row["state"] for row in rows(tmp_path / "two.tar")] == ["answered", "answered"]
    assert not [*folder.iterdir()]


@LINUX
def test_workers_go_when_nobody_wants_more_rows() -> None:
    started = inertia.batch([CUBE] * 2 + [HANDLE], jobs=2)
    next(started)
    assert workers()
    started.close()  # type: ignore[attr-defined]
    until = time.monotonic() + 60
    while workers() and time.monotonic() < until:
        time.sleep(0.01)
    assert not workers()
