"""Files appear whole or not at all; blocks bound the memory; errors are one sentence."""

import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from tests.recording.reading import Recorded, verified

from inertia.recording import writer
from inertia.recording.writer import BLOCK, Recording, to_file

SCRIPT = """
import sys
from pathlib import Path
import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from inertia.errors import InertiaError
from inertia.recording.writer import to_file

def write(path, count):
    with to_file(Path(path), "inertia-test", rrb.Blueprint()) as recording:
        noise = np.random.default_rng(1).standard_normal((65536, 3)).astype(np.float32)
        for turn in range(count):
            recording.columns("a", np.arange(65536.0) + turn, lambda rows: rr.Arrows3D.columns(vectors=noise[rows]))
            print(turn, flush=True)
"""


def started(code: str, *arguments: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", SCRIPT + textwrap.dedent(code), *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def write(path: Path, rows: int = 3) -> None:
    import rerun.blueprint as rrb

    with to_file(path, "inertia-test", rrb.Blueprint()) as recording:
        fill(recording, rows)


def fill(recording: Recording, rows: int) -> None:
    seconds = np.arange(rows) / 3
    recording.scalars("plots/a", seconds, lambda at: np.sqrt(seconds[at, None]), ["a, m"], [(255, 0, 0)])


def test_rows_come_back_in_blocks_with_their_times(tmp_path: Path) -> None:
    write(tmp_path / "run.rrd", BLOCK + 5)
    recorded = Recorded(tmp_path / "run.rrd")
    assert sorted(recorded.rows["/plots/a"]) == [5, BLOCK]
    seconds = np.arange(BLOCK + 5) / 3
    np.testing.assert_allclose(np.sort(recorded.time("/plots/a")), seconds, atol=0.51e-9, rtol=1e-15)
    assert np.array_equal(np.sort(recorded.values("/plots/a", "Scalars:scalars")[:, 0]), np.sqrt(seconds))
    assert recorded.texts("/plots/a", "SeriesLines:names") == ["a, m"]
    assert verified(tmp_path / "run.rrd", tmp_path)


def test_nothing_is_left_beside_a_file(tmp_path: Path) -> None:
    write(tmp_path / "run.rrd")
    assert [file.name for file in tmp_path.iterdir()] == ["run.rrd"]


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    import rerun.blueprint as rrb

    path = tmp_path / "run.rrd"
    path.write_bytes(b"old")
    with pytest.raises(IndexError), to_file(path, "inertia-test", rrb.Blueprint()) as recording:
        recording.columns("a", np.arange(3.0), lambda rows: [][rows.stop])
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_it_writes_where_there_are_no_pipes_to_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "PIPES", tmp_path / "none")
    write(tmp_path / "run.rrd")
    assert verified(tmp_path / "run.rrd", tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("blocks", [0, 3])
def test_a_killed_process_leaves_no_half_file(tmp_path: Path, blocks: int) -> None:
    path = tmp_path / "run.rrd"
    path.write_bytes(b"old")
    with started("write(sys.argv[1], 10**6)", str(path)) as process:
        assert process.stdout is not None
        for _ in range(blocks + 1):
            assert process.stdout.readline()
        process.kill()
    assert path.read_bytes() == b"old"


@pytest.mark.skipif(sys.platform == "win32", reason="limits of the system")
def test_a_full_disk_is_one_sentence_and_leaves_no_file(tmp_path: Path) -> None:
    code = """
    import resource
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))
    try:
        write(sys.argv[1], 3)
    except InertiaError as error:
        print(error)
    """
    with started(code, str(tmp_path / "run.rrd")) as process:
        out, err = process.communicate()
    assert (process.returncode, err) == (0, "")
    message = out.splitlines()[-1]
    assert message.startswith(f"cannot write {tmp_path / 'run.rrd'}: File too large: raise the limit")
    assert list(tmp_path.iterdir()) == []
