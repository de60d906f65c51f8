"""Signals, closed streams and full disks: what a command leaves behind, says and returns."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from inertia_meshes import path

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals and descriptors")

_RUN = "from inertia_cli.__main__ import run; run()"
_SLOWLY = """
import sys, time
import inertia.report.balance.figures as figures
from inertia.output import whole
from pathlib import Path
def slowly(*_):
    with whole(Path(sys.argv[-1])) as beside:
        beside.write_bytes(b"half")
        print("ready", flush=True)
        time.sleep(60)
figures.report_data = slowly
"""


def heard() -> None:
    """Let signals through that whoever runs the tests ignores: nohup, or a shell in the background."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def command(*arguments: str, code: str = _RUN) -> list[str]:
    return [sys.executable, "-c", code, *arguments]


@pytest.mark.parametrize(
    ("number", "code", "says"),
    [
        (signal.SIGINT, 130, "inertia: interrupted\n"),
        (signal.SIGTERM, 143, ""),
        (signal.SIGHUP, 129, ""),
    ],
)
def test_a_signal_ends_a_command_quietly_and_leaves_nothing(
    number: signal.Signals, code: int, says: str, tmp_path: Path
) -> None:
    arguments = ("balance", str(path("rotors/disc.toml")), "--csv", str(tmp_path / "planes.csv"))
    run = subprocess.Popen(
        command(*arguments, code=_SLOWLY + _RUN),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heard,
    )
    assert run.stdout
    assert run.stdout.readline() == "ready\n"
    assert len(list(tmp_path.iterdir())) == 1
    run.send_signal(number)
    assert run.communicate() == ("", says)
    assert run.returncode == code
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_is_quiet_whenever_it_comes() -> None:
    code = "from inertia_cli.interruption import interruption; interruption.install(); print(flush=True); " + _RUN
    for delay in (0, 0.01, 0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2):
        run = subprocess.Popen(
            command("analyse", str(path("sphere.stl")), code=code),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            preexec_fn=heard,
        )
        assert run.stdout
        run.stdout.readline()
        time.sleep(delay)
        run.send_signal(signal.SIGINT)
        _, error = run.communicate()
        assert (run.returncode, error) in [(130, b""), (130, b"inertia: interrupted\n"), (0, b"")]


def test_a_signal_is_quiet_after_a_command_of_the_same_process() -> None:
    code = f"""
import inertia_cli.main as cli, os, signal, sys
from inertia_cli.interruption import interruption
assert cli.main(["check", {str(path("cube.stl"))!r}]) == 0
interruption.install()
cli.build_parser = lambda: os.kill(os.getpid(), signal.SIGTERM)
cli.run()
"""
    run = subprocess.run(command(code=code), capture_output=True)
    assert (run.returncode, run.stderr) == (143, b"")


def test_a_signal_that_is_ignored_stays_so() -> None:
    run = subprocess.run(
        command("check", str(path("cube.stl")), code=f"import os; os.kill(os.getpid(), {signal.SIGHUP}); {_RUN}"),
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),
        capture_output=True,
    )
    assert run.returncode == 0


def test_a_signal_that_a_destructor_swallows_ends_the_command_all_the_same() -> None:
    code = """
import inertia.mesh.check, os, signal, time
class Late:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(1)
def check(*_, **__):
    Late()
    time.sleep(60)
inertia.mesh.check.check = check
"""
    run = subprocess.run(command("check", str(path("cube.stl")), code=code + _RUN), capture_output=True)
    assert (run.returncode, run.stdout, run.stderr) == (143, b"", b"")


@pytest.mark.parametrize("closed", [(0,), (1,), (2,), (0, 1, 2)])
def test_closed_streams(closed: tuple[int, ...], tmp_path: Path) -> None:
    def close() -> None:
        for number in closed:
            os.close(number)

    table = tmp_path / "planes.csv"
    arguments = ("balance", str(path("rotors/disc.toml")), "--csv", str(table))
    run = subprocess.run(command(*arguments), preexec_fn=close, capture_output=True)
    if 1 in closed:
        assert run.returncode == 1
        said = b"" if 2 in closed else b"inertia: cannot write the result: standard output is closed\n"
        assert run.stderr == said
    else:
        assert run.returncode == 0
        assert table.read_text().startswith("state,plane")
        assert run.stderr == b""


@pytest.mark.parametrize("arguments", [("--help",), ("--version",), ("balance", "--schema"), ("none",)])
def test_help_with_closed_streams(arguments: tuple[str, ...]) -> None:
    run = subprocess.run(command(*arguments), preexec_fn=lambda: os.close(1), capture_output=True)
    if arguments == ("none",):
        assert run.returncode == 2
    else:
        said = b"inertia: cannot write the result: standard output is closed\n"
        assert (run.returncode, run.stderr) == (1, said)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "arguments", [("check", str(path("cube.stl"))), ("--help",), ("--version",), ("analyse", "--help")]
)
def test_a_result_that_cannot_be_printed(arguments: tuple[str, ...], unbuffered: str) -> None:
    with Path("/dev/full").open("w") as full:
        variables = os.environ | {"PYTHONUNBUFFERED": unbuffered}
        run = subprocess.run(command(*arguments), stdout=full, stderr=subprocess.PIPE, env=variables)
    assert (run.returncode, run.stderr) == (
        1,
        b"inertia: cannot write the result: No space left on device\n",
    )


@pytest.mark.parametrize("json", [[], ["--json"]])
def test_a_full_disk_still_prints_the_result(json: list[str], tmp_path: Path) -> None:
    import resource

    files = {"--csv": "planes.csv", "--report": "report.html", "-o": "rotor.rrd"}
    outputs = [word for option, name in files.items() for word in (option, str(tmp_path / name))]
    (tmp_path / "planes.csv").write_text("old")

    def limit() -> None:  # of the size of a file: the table fits, the report does not
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    run = subprocess.run(
        command("balance", str(path("rotors/disc.toml")), *outputs, *json, "--force"),
        preexec_fn=limit,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert run.returncode == 1
    assert "verdict" in run.stdout.lower()
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith(f"inertia: cannot write {tmp_path / 'report.html'}: File too large: raise the limit")
    assert [file.name for file in tmp_path.iterdir()] == ["planes.csv"]
    assert (tmp_path / "planes.csv").read_text() == "old"
