"""What a batch cannot use is refused in a sentence, and what it advises can be followed."""

import csv
import errno
import json
import math
import re
import sys
import threading
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import inertia
from inertia import Estimate
from inertia.batching import engines
from inertia.batching.answer import Setup, within
from inertia.batching.lot import Lot
from inertia.batching.sources import Task
from inertia.batching.summary import Summary
from inertia_cli import batch
from inertia_cli.main import build_parser, main
from inertia_meshes import path

CUBE, OPEN, FLIPPED = (path(name) for name in ("cube.stl", "broken/missing_face.stl", "broken/flipped_face.stl"))


def batch_options() -> set[str]:
    """Return the options of the command."""
    subparsers = next(action for action in build_parser()._actions if isinstance(action.choices, dict))
    assert isinstance(subparsers.choices, dict)
    return set(subparsers.choices["batch"]._option_string_actions)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"memory": "4GB"}, "memory is '4GB': it must be positive and finite, in bytes"),
        ({"memory": math.inf}, "memory is inf: it must be positive and finite, in bytes"),
        ({"memory": -1}, "memory is -1: it must be positive and finite, in bytes"),
        ({"timeout": "60"}, "timeout is '60': it must be positive and finite, in seconds"),
        ({"timeout": [60]}, r"timeout is \[60\]: it must be positive and finite, in seconds"),
        ({"jobs": "2"}, "jobs is '2': give the number of worker processes, 1 or more"),
        ({"jobs": 2.0}, "jobs is 2.0: give the number of worker processes, 1 or more"),
        ({"jobs": 0}, "jobs is 0: give the number of worker processes, 1 or more"),
        ({"shard": "1/2"}, r"shard is '1/2': give two whole numbers, as \(3, 8\)"),
        ({"shard": (1, 2, 3)}, r"shard is \(1, 2, 3\): give two whole numbers"),
        ({"shard": (1.0, 2.0)}, r"shard is \(1.0, 2.0\): give two whole numbers"),
        ({"shard": 1}, "shard is 1: give two whole numbers"),
        ({"paths": bytes(CUBE)}, "a path is b'.*cube.stl': give it as text or as a pathlib.Path"),
        ({"paths": [bytes(CUBE)]}, "a path is b'.*cube.stl': give it as text or as a pathlib.Path"),
        ({"paths": [CUBE, None]}, "a path is None: "),
        ({"paths": None}, "a path is None: "),
        ({"manifest": b"list.csv"}, "a path is b'list.csv': "),
        ({"unit": 1}, "unit is 1: give its name, as 'mm'"),
        ({"verb": ["analyse"]}, r"verb is \['analyse'\]: use one of analyse, "),
        ({"dask": 8786}, "8786 is no address of a Dask scheduler .*: give one as tcp://host:8786"),
        ({"densty": 7850.0}, "densty is no option of analyse: use density, or one of unit, "),
        ({"time": 3}, "time is no option of analyse: use one of unit, .*chord, "),
        ({"accuracy": 0}, "accuracy is 0: give a positive relative figure"),
        ({"accuracy": math.nan}, "accuracy is nan: give a positive relative figure"),
        ({"format": "foo"}, "unknown format 'foo': use one of stl, "),
        ({"format": ["stl"]}, r"format is \['stl'\]: give text"),
        ({"shell": 0.0}, "the shell thickness is 0.0 mm: it must be positive and finite"),
        ({"allow_faults": 2}, "faults are allowed for up to 2: "),
        ({"parts": "separate", "union": True}, "both separate bodies and their union are asked for: give one"),
        ({"shell": 1.0, "union": True}, "a union is one of the solids that a surface bounds: leave it out"),
        ({"shell": 1.0, "wire": 1.0}, "both a shell and a wire are asked for: give one"),
        ({"shell": 1.0, "chord": 0.1}, "a chord tolerance bounds the error of the surface of a solid only: "),
        ({"union": True, "orientation": "absolute"}, "a union and an absolute orientation are two answers to one"),
        ({"verb": "check", "parts": "each"}, "parts is 'each': use 'together' or 'separate'"),
        ({"verb": "audit", "tolerance": -1}, "the tolerance is -1: it must lie between 0 and 1"),
        ({"verb": "audit", "tolerance": "x"}, "tolerance is 'x': give a number"),
        ({"verb": "audit", "density": -1}, "the density is -1 kg/m³: "),
        ({"verb": "balance", "time": -1}, "plan.time is -1: it must be positive, a number of s"),
    ],
    ids=str,
)
def test_an_argument_that_is_not_usable_is_refused(
    arguments: dict[str, Any], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engines.Processes, "submit", lambda *_: pytest.fail("a worker is asked"))
    with pytest.raises(inertia.UsageError, match=f"^{says}"):
        list(inertia.batch(**{"paths": CUBE, "jobs": 1, **arguments}))


def test_what_is_none_is_not_asked_for() -> None:
    (row,) = inertia.batch(CUBE, jobs=1, unit=None, density=None, format=None, orientation=None)
    assert (row["state"], row["unit"], row["unit_from"]) == ("answered", "mm", "assumed")


@pytest.mark.skipif(sys.platform != "linux", reason="memory of a process is limited on Linux only")
def test_limits_may_be_numbers_of_any_kind() -> None:
    for memory in (4e9, 1e30):
        (row,) = inertia.batch(CUBE, jobs=1, memory=memory, timeout=60, shard=[1, 1])  # type: ignore[arg-type]
        assert row["state"] == "answered"


def test_a_time_without_end_is_waited_for() -> None:
    assert within(1e300, lambda: "answer", "none") == "answer"


def test_there_are_no_more_workers_than_files() -> None:
    threads = threading.active_count()
    with closing(engines.Processes(Setup("check"), 100)) as engine:
        engine.submit(0, Task(str(CUBE)))
        assert threading.active_count() <= threads + 1
        ((_, answer),) = engine.results()
    assert answer.row["state"] == "answered"


@pytest.mark.parametrize(
    ("what", "error"),
    [
        ("threading.Thread.start", RuntimeError("can't start new thread")),
        ("subprocess.Popen", BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable")),
    ],
)
def test_more_workers_than_the_system_has_room_for_are_refused(
    what: str, error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise error

    of, _, name = what.rpartition(".")
    monkeypatch.setattr(f"inertia.batching.engines.{of}.{name}", fails)
    why = getattr(error, "strerror", None) or error
    with pytest.raises(inertia.InertiaError, match=rf"could be started \({why}\): ask for fewer by jobs=N$"):
        list(inertia.batch(CUBE, jobs=2))


@pytest.mark.parametrize(
    "arguments", [("--time", "3"), ("--lump",), ("--tolerance", "0.1"), ("--verb", "check", "--allow-faults", "0.1")]
)
def test_the_command_lists_its_own_options(arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["batch", str(CUBE), *arguments]) == 2
    said = capsys.readouterr().err
    refused = next(word for word in reversed(arguments) if word.startswith("--"))
    assert said.startswith(f"inertia: {refused} is no option of ")
    listed = said.partition(": use one of ")[2].split(", ")
    assert "--unit" in listed
    assert {option.strip() for option in listed} <= batch_options()


def test_the_command_refuses_options_that_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["batch", str(CUBE), "--parts", "separate", "--union"]) == 2
    said = capsys.readouterr()
    assert said.err == "inertia: both separate bodies and their union are asked for: give one\n"
    assert not said.out


@pytest.mark.parametrize(
    ("option", "value"), [("--timeout", "0"), ("--memory", "-1"), ("--unpack-limit", "0"), ("--jobs", "0")]
)
def test_the_command_names_an_option_that_is_not_usable_as_it_is_given(
    option: str, value: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["batch", str(CUBE), f"{option}={value}"]) == 2
    assert capsys.readouterr().err.startswith(f"inertia: {option} is {value}")


def test_the_command_says_of_a_list_that_cannot_be_read_only_that(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["batch", "none.csv"]) == 3
    assert capsys.readouterr().err == "inertia: cannot read none.csv: there is no such file: check the path\n"
    assert main(["batch", "--manifest", ""]) == 2
    assert "the path of a file is empty" in capsys.readouterr().err


@pytest.mark.parametrize("verb", ["analyse", "check"])
def test_what_only_another_command_has_is_said_to_be_of_that_one(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "table.csv"
    assert main(["batch", str(OPEN), str(FLIPPED), "--verb", verb, "-o", str(table), "--jobs", "1"]) == 0
    with table.open() as file:
        messages = [row["message"] for row in csv.DictReader(file)]
    said = " ".join([*messages, capsys.readouterr().out]).replace(str(OPEN), "").replace(str(FLIPPED), "")
    assert said.count("`inertia analyse --repair`") == 4
    own = re.sub("`[^`]*`", "", said)
    assert set(re.findall(r"--[a-z-]+", own)) <= batch_options()


@pytest.mark.parametrize("stated", ["-0.1", "-0.1±0.01", "nan"])
@pytest.mark.parametrize(("option", "what"), [("shell", "shell thickness"), ("wire", "wire cross-section")])
def test_a_thickness_is_said_as_it_was_written(
    option: str, what: str, stated: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(inertia.UsageError, match=f"^the {what} is {stated} mm"):
        inertia.analyse(inertia.read(CUBE), **{option: Estimate.parse(stated)})  # type: ignore[arg-type]
    assert main(["analyse", str(CUBE), f"--{option}={stated}"]) == 2
    assert f"the {what} is {stated} mm" in capsys.readouterr().err
    if option == "shell":
        assert main(["batch", str(CUBE), f"--{option}={stated}", "--jobs", "1"]) == 2
        assert f"the {what} is {stated} mm" in capsys.readouterr().err


@pytest.mark.parametrize("argument", ["sigma", "coverage"])
def test_what_else_may_be_an_estimate_is_said_as_a_number(argument: str) -> None:
    with pytest.raises(inertia.UsageError, match=r" is -1.0\b"):
        inertia.analyse(inertia.read(CUBE), **{argument: Estimate(-1)})  # type: ignore[arg-type]


def test_workers_here_say_nothing_of_those_of_a_scheduler(capsys: pytest.CaptureFixture[str]) -> None:
    says = "says nothing of the workers of the scheduler tcp://host:8786: leave it out"
    with pytest.raises(inertia.UsageError, match=f"^jobs {says}"):
        inertia.batch(CUBE, jobs=2, dask="tcp://host:8786")
    assert main(["batch", str(CUBE), "--jobs", "2", "--dask", "tcp://host:8786"]) == 2
    assert capsys.readouterr().err == f"inertia: --jobs {says}\n"


@pytest.mark.parametrize("address", ["foo", "", "tcp://foo", "foo://host:8786", "host:port"])
def test_what_is_no_address_is_refused_at_once(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed.Client, "start", lambda *_, **__: pytest.fail("a scheduler is looked for"))
    said = f"^{address or repr(address)} is no address of a Dask scheduler .*: give one as tcp:"
    with pytest.raises(inertia.UsageError, match=said):
        list(inertia.batch(CUBE, dask=address))


def test_a_client_without_a_scheduler_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    clients = []

    async def fails(client: Any, **_: Any) -> None:
        clients.append(client)
        raise ValueError("half-made")

    monkeypatch.setattr(distributed.Client, "_ensure_connected", fails)
    with pytest.raises(inertia.UsageError, match=r"no Dask scheduler answers at tcp://.*: half-made"):
        list(inertia.batch(CUBE, dask="tcp://127.0.0.1:1"))
    assert [client.status for client in clients] == ["closed"]


@pytest.mark.parametrize(
    "arguments",
    [
        ("--manifest", "nosuch.csv"), ("--verb", "check"), ("--density", "3"), ("--jobs", "1"), ("--shard", "1/2"),
        ("--no-intersections",), ("--timings",), ("--memory", "4GB"), ("--orientation", "absolute"),
    ],
    ids=" ".join,
)  # fmt: skip
def test_options_without_a_meaning_for_a_merge_are_refused(
    arguments: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shard, merged = tmp_path / "shard.jsonl", tmp_path / "merged.jsonl"
    main(["batch", str(CUBE), "-o", str(shard), "--shard", "1/1", "--jobs", "1"])
    merge = ["batch", "--merge", str(shard), "-o", str(merged)]
    assert main([*merge, *arguments]) == 2
    assert f"{arguments[0].replace('--no-', '--')} has no meaning with --merge" in capsys.readouterr().err
    assert not merged.exists()
    assert main([*merge, "--strict", "--json", "--force"]) == 0


def rotor(number: int, size: float, upper: float, within: float) -> dict[str, Any]:
    """Return the row of a rotor, over a limit of 1 g mm."""
    row: dict[str, Any] = {"state": "answered", "exit_code": 0, "verdict": "fail", "path": f"{number}.toml"}
    for plane in "ab":
        row |= {f"permissible_{plane}_gmm": 1.0, f"residual_95_{plane}_gmm": upper}
        for name in ("initial", "residual"):
            row |= {f"{name}_{plane}_gmm": size, f"{name}_{plane}_deg": 90.0 * number}
    shares = json.dumps({"drill: depth": [1.0, 1.0]})
    return row | {"within": within, "shares": shares, "seconds": 4321.0}


def test_figures_of_a_summary_are_written_as_people_write_them() -> None:
    summary = Summary("balance", 3)
    for number in range(3):
        summary.count(rotor(number, 2500.0, 2500.0, 1.0 - 3e-7), stored=False)
    text = summary.text()
    assert not re.search(r"\d\.?e[+-]\d", text)
    assert "Variance          in plane A: between rotors 100 %" in text
    assert "Expected out      0.00003 % of parts" in text
    assert "100 % out (3 counted)" in text
    assert "4321 s  2.toml" in text


@pytest.mark.parametrize(
    ("message", "kind"),
    [
        ("unknown format 'x': use 3mf, 3dxml or su2", "unknown format 'x': use 3mf, 3dxml or su2"),
        ("not UTF-8 at line 12, column 3.", "not UTF-8 at line …, column …."),
        ("at -5.0, 1e-05, 10,000 of part-2.stl", "at …, …, … of part-2.stl"),
    ],
)
def test_a_refusal_is_counted_without_figures_but_with_names(message: str, kind: str) -> None:
    summary = Summary("analyse", 1)
    row = {"state": "refused", "exit_code": 2, "path": "a.stl", "message": f"a.stl: {message}", "seconds": None}
    summary.count(row, stored=False)
    assert list(summary.refusals) == [kind]


def test_a_lot_of_nothing_out_says_so() -> None:
    lot = Lot()
    for number in range(3):
        lot.count(rotor(number, 1e-3, 2e-3, 1.0))
    assert "0 % of parts" in "\n".join(lot.text())


def test_progress_is_written_as_people_write_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seconds = iter([0.0, 0.0005])
    monkeypatch.setattr(batch, "EVERY", 0.0)
    monkeypatch.setattr(batch, "time", SimpleNamespace(monotonic=lambda: next(seconds)))
    main(["batch", str(CUBE), "--jobs", "1"])
    assert "1 of 1 files, 2000 files/s, 0 s left: 1 answered" in capsys.readouterr().err
