"""`inertia batch`: tables of three kinds, cut short and taken up again, in shards and merged."""

import csv
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from inertia.tables import read_table
from inertia_cli.main import main
from inertia_meshes import path

FILES = [str(path(name)) for name in ("broken/nan.stl", "cube.stl", "broken/truncated.stl", "t_handle.stl")]


def copies(folder: Path) -> str:
    """Write seven copies of sound and broken meshes, and return a glob of them."""
    for number, file in enumerate((FILES * 2)[:7]):
        (folder / f"part{number}.stl").write_bytes(Path(file).read_bytes())
    return f"{folder}/part*.stl"


@pytest.fixture
def parts(tmp_path: Path) -> str:
    return copies(tmp_path)


def batch(*arguments: str | Path) -> int:
    return main(["batch", *map(str, arguments), *(() if "--merge" in arguments else ("--jobs", "1"))])


@pytest.mark.parametrize("suffix", ["csv", "jsonl", "parquet"])
def test_a_table_reads_back_as_the_rows_and_says_what_its_columns_are(suffix: str, parts: str, tmp_path: Path) -> None:
    if suffix == "parquet":
        pytest.importorskip("pyarrow.parquet")
    import inertia

    assert batch(parts, "-o", tmp_path / f"table.{suffix}", "--material", "steel") == 0
    about, rows = read_table(tmp_path / f"table.{suffix}")
    expected = list(inertia.batch(parts, jobs=1, material="steel"))
    for row, same in zip(rows, expected, strict=True):
        assert row.pop("seconds") is None
        assert same.pop("seconds") > 0
        message, words = row.pop("message"), same.pop("message")
        assert (message is None) == (words is None)
        assert row == same
    assert about["schema"] == "inertia/batch-rows/1"
    units = {column["name"]: column["unit"] for column in about["columns"]}
    assert set(units) == {*expected[0], "message", "seconds"}
    assert (units["volume"], units["ixx"], units["com_x"]) == ("m3", "kg m2", "m")
    assert not (tmp_path / f"table.{suffix}.parts").exists()


def test_sentences_name_options_of_the_command(tmp_path: Path) -> None:
    batch(path("broken/missing_face.stl"), "-o", tmp_path / "table.csv")
    with (tmp_path / "table.csv").open() as file:
        first = next(csv.DictReader(file))
    assert "use --shell THICKNESS or `inertia analyse --repair`" in first["message"]


def test_the_exit_code_is_0_unless_asked_to_be_strict(parts: str, tmp_path: Path) -> None:
    assert batch(parts, "-o", tmp_path / "one.csv") == 0
    assert batch(parts, "-o", tmp_path / "two.csv", "--strict") == 4
    assert batch(path("cube.stl"), "-o", tmp_path / "three.csv", "--strict") == 0


def test_the_summary_counts_and_names(parts: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    batch(parts, "-o", tmp_path / "table.csv", "--json")
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "inertia/batch/1"
    assert document["files"] == 7
    assert sum(document["states"].values()) == 7
    assert document["refusals"][0]["count"] == 2
    assert document["refusals"][0]["first"].endswith("part2.stl")
    assert document["assumed_units"] == sum(
        row["unit_from"] == "assumed" for row in read_table(tmp_path / "table.csv")[1]
    )
    batch(parts, "-o", tmp_path / "table.csv", "--force")
    text = capsys.readouterr().out
    assert "answered" in text
    assert "2 × " in text


def test_a_table_that_is_there_stays_without_force(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "table.csv").write_text("mine")
    assert batch(path("cube.stl"), "-o", tmp_path / "table.csv") == 2
    assert (tmp_path / "table.csv").read_text() == "mine"
    assert "--force" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", ["csv", "jsonl", "parquet"])
def test_what_a_batch_has_written_is_no_file_of_a_glob(
    suffix: str, parts: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if suffix == "parquet":
        pytest.importorskip("pyarrow.parquet")
    one, again = tmp_path / f"one.{suffix}", tmp_path / f"again.{suffix}"
    kept = tmp_path / f"again.{suffix}.parts"
    batch(parts, "-o", one)
    kept.mkdir()
    (kept / "0123456789abcdef.jsonl").write_text("{}\n")
    for force in ([], ["--force"]):
        assert batch(f"{tmp_path}/**/*", "-o", again, *force) == 0
        assert again.read_bytes() == one.read_bytes()
    capsys.readouterr()
    assert batch(one.with_suffix(".jsonl.txt"), f"{again}.meta.json") == 0  # what is named is asked for
    assert capsys.readouterr().out.count("unreadable") == 2


@pytest.mark.parametrize("suffix", ["csv", "jsonl", "parquet"])
def test_shards_merge_to_the_bytes_of_one_run(suffix: str, parts: str, tmp_path: Path) -> None:
    if suffix == "parquet":
        pytest.importorskip("pyarrow.parquet")
    one, merged = tmp_path / f"one.{suffix}", tmp_path / f"merged.{suffix}"
    shards = [tmp_path / f"shard{k}.{suffix}" for k in (1, 2, 3)]
    batch(parts, "-o", one)
    for number, shard in enumerate(shards, 1):
        batch(parts, "-o", shard, "--shard", f"{number}/3")
    assert batch("--merge", shards[2], shards[0], shards[1], "-o", merged) == 0
    assert merged.read_bytes() == one.read_bytes()
    if suffix != "parquet":
        beside = [file.with_name(f"{file.name}.meta.json").read_text() for file in (one, merged)]
        assert beside[0] == beside[1]
        assert json.loads(beside[0])["sha256"] == hashlib.sha256(one.read_bytes()).hexdigest()
    assert batch("--merge", shards[0], shards[2], "-o", tmp_path / f"two.{suffix}") == 2
    assert batch("--merge", *shards, shards[1], "-o", tmp_path / f"two.{suffix}") == 2


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
@pytest.mark.parametrize(("number", "endless"), [(signal.SIGKILL, 39), (signal.SIGTERM, 39), (signal.SIGKILL, 0)])
def test_a_run_that_was_killed_goes_on_where_it_was(number: signal.Signals, endless: int, tmp_path: Path) -> None:
    many = 40
    for k in range(many):
        (tmp_path / f"part{k:03}.stl").write_bytes(path("t_handle.stl").read_bytes())
    table = tmp_path / "table.jsonl"
    command = [sys.executable, "-c", "from inertia_cli.__main__ import run; run()", "batch", "--jobs", "2"]
    arguments = [f"{tmp_path}/part*.stl", "-o", str(table), "--json"]
    (tmp_path / "sitecustomize.py").write_text(  # rows are kept after a file in the middle; another one never ends
        "import os, sys, time\n"
        "def hook(event, arguments, parent=os.getppid()):\n"
        f"    if event == 'open' and str(arguments[0]) == {str(tmp_path / f'part{many // 2:03}.stl')!r}:\n"
        "        time.sleep(1)\n"
        f"    if event == 'open' and str(arguments[0]) == {str(tmp_path / f'part{endless:03}.stl')!r}:\n"
        "        while os.getppid() == parent:\n"
        "            time.sleep(0.02)\n"
        "        os._exit(1)\n"
        "sys.addaudithook(hook)\n"
    )
    parts = tmp_path / "table.jsonl.parts"
    waiting = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}
    run = subprocess.Popen([*command, *arguments], stdout=subprocess.DEVNULL, env=waiting)
    while sum(len(each.read_bytes().splitlines()) for each in parts.glob("*.jsonl")) < many // 2 and run.poll() is None:
        time.sleep(0.01)
    run.send_signal(number)
    run.wait()
    assert not table.exists()
    (tmp_path / "part000.stl").write_bytes(path("cube.stl").read_bytes())  # answered for, and then changed
    again = subprocess.run([*command, *arguments], stdout=subprocess.PIPE, check=True, text=True)
    assert 0 < json.loads(again.stdout)["stored"] < many
    one = tmp_path / "one.jsonl"
    subprocess.run([*command, arguments[0], "-o", str(one)], stdout=subprocess.DEVNULL, check=True)
    assert table.read_bytes() == one.read_bytes()
    assert not parts.exists()


def test_paths_come_on_standard_input_and_rows_go_to_standard_output() -> None:
    command = [sys.executable, "-m", "inertia_cli", "batch", "-", "--jobs", "1"]
    run = subprocess.run(command, input="\0".join(FILES[:2]), capture_output=True, text=True, check=True)
    assert [json.loads(line)["path"] for line in run.stdout.splitlines()] == FILES[:2]
    assert run.stderr.startswith("Files")


def test_a_list_that_windows_wrote_is_read_and_an_empty_one_refused() -> None:
    command = [sys.executable, "-m", "inertia_cli", "batch", "-", "--jobs", "1"]
    lines = "\r\n".join(["", *FILES[:2], ""])
    for text in (lines.encode("utf-8-sig"), lines.encode("utf-16")):
        run = subprocess.run(command, input=text, capture_output=True, check=True)
        assert [json.loads(line)["path"] for line in run.stdout.splitlines()] == FILES[:2]
    empty = subprocess.run(command, input=b"\r\n", capture_output=True, check=False)
    assert empty.returncode == 2
    assert b"standard input names no file" in empty.stderr


def test_parts_that_were_damaged_are_answered_for_again(tmp_path: Path) -> None:
    table = tmp_path / "table.jsonl"
    parts = tmp_path / "table.jsonl.parts"
    parts.mkdir()
    (parts / "0123456789abcdef.jsonl").write_text('junk\n{"no": "key"}\n3\n{"key": "cut sh')
    assert batch(path("cube.stl"), "-o", table) == 0
    assert json.loads(table.read_text())["state"] == "answered"
    assert not parts.exists()


def test_what_is_missing_of_a_table_to_be_merged_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    batch(path("cube.stl"), "-o", tmp_path / "one.csv", "--shard", "1/1")
    (tmp_path / "one.csv.meta.json").unlink()
    for name, says in (("one.csv", "one.csv.meta.json beside it"), ("none.csv", "cannot read ")):
        assert batch("--merge", tmp_path / name, "-o", tmp_path / "all.csv") == 3
        error = capsys.readouterr().err
        assert says in error
        assert "all.csv" not in error


def in_two(parts: str, folder: Path) -> list[Path]:
    """Write the tables of two shards, and return them."""
    tables = [folder / f"shard{k}.jsonl" for k in (1, 2)]
    for number, table in enumerate(tables, 1):
        batch(parts, "-o", table, "--shard", f"{number}/2")
    return tables


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("sound")
    return in_two(copies(folder), folder)


@pytest.fixture
def shards(sound: list[Path], tmp_path: Path) -> list[Path]:
    """Tables of two shards, to be damaged."""
    for table in sound:
        for file in (table, table.with_name(f"{table.name}.meta.json")):
            shutil.copy(file, tmp_path)
    return [tmp_path / table.name for table in sound]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"path": "x', "row 1: "),
        ("{}\n", "row 1: it has not the columns that the table has"),
        ("[1]\n", "row 1: it has not the columns that the table has"),
        ("", "it has 0 of 3 rows: run its shard again"),
    ],
)
def test_a_damaged_shard_is_named(
    text: str, says: str, shards: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shards[1].write_text(text)
    assert batch("--merge", *shards, "-o", tmp_path / "all.jsonl") == 3
    assert f"cannot read {shards[1]}" in (error := capsys.readouterr().err)
    assert says in error
    assert not (tmp_path / "all.jsonl").exists()


def test_what_stands_beside_a_damaged_shard_is_named_too(
    shards: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "shard2.jsonl.meta.json").write_text("[]")
    assert batch("--merge", *shards, "-o", tmp_path / "all.jsonl") == 3
    assert f"cannot read {shards[1]}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("shard", 3, "it is shard 3, and not one as [3, 8]: run its shard again"),
        ("shard", [1, "x"], "it is shard [1, 'x'], and not one as [3, 8]"),
        ("files", 7, "it does not say how many files there are"),
        ("verb", ["check"], "it is no table of a batch"),
    ],
)
def test_a_shard_that_says_nonsense_of_itself_is_named(
    key: str, value: object, says: str, shards: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    beside = tmp_path / "shard1.jsonl.meta.json"
    beside.write_text(json.dumps(json.loads(beside.read_text()) | {key: value}))
    assert batch("--merge", *shards, "-o", tmp_path / "all.jsonl") == 3
    assert f"cannot read {shards[0]}: {says}" in capsys.readouterr().err


def test_a_shard_that_does_not_say_what_it_is_of_is_named(
    shards: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    beside = tmp_path / "shard2.jsonl.meta.json"
    about = json.loads(beside.read_text())
    del about["files"]
    beside.write_text(json.dumps(about))
    assert batch("--merge", *shards, "-o", tmp_path / "all.jsonl") == 3
    assert f"cannot read {shards[1]}: it does not say how many files there are" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", ["csv", "jsonl"])
def test_a_shard_beside_what_another_says_of_itself_is_named(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    parts = copies(tmp_path).replace("*", "[0-5]")  # as many in each shard
    shards = [tmp_path / f"shard{number}.{suffix}" for number in (1, 2)]
    for number, shard in enumerate(shards, 1):
        batch(parts, "-o", shard, "--shard", f"{number}/2")
    shutil.copy(shards[0], shards[1])
    assert batch("--merge", *shards, "-o", tmp_path / f"all.{suffix}") == 3
    says = f"cannot read {shards[1]}: it is not the table that shard2.{suffix}.meta.json was written for"
    assert says in capsys.readouterr().err
    assert not (tmp_path / f"all.{suffix}").exists()


def test_shards_of_a_folder_that_grew_are_no_whole(
    parts: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shards = in_two(parts, tmp_path)
    assert batch("--merge", *shards, "-o", tmp_path / "whole.jsonl") == 0
    (tmp_path / "part00.stl").write_bytes(path("cube.stl").read_bytes())
    batch(parts, "-o", shards[1], "--shard", "2/2", "--force")
    assert batch("--merge", *shards, "-o", tmp_path / "all.jsonl") == 2
    assert "another list of files" in capsys.readouterr().err


def test_a_file_where_finished_rows_are_kept_is_refused_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "t.csv.parts").write_text("mine")
    assert batch(path("cube.stl"), "-o", tmp_path / "t.csv") == 2
    assert "t.csv.parts, where finished rows are kept, is no folder" in capsys.readouterr().err
