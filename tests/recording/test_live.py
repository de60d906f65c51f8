"""Streaming to a viewer: one that is not there, ends, or never answers."""

import socket
from collections.abc import Iterator
from pathlib import Path
from subprocess import Popen

import pytest
from tests.recording.reading import verified
from tests.recording.scenes import t_handle

from inertia import record, simulate
from inertia.errors import InertiaError
from inertia.recording import live
from inertia.recording.viewer import listening
from inertia.recording.writer import Recording


def test_streaming_needs_an_open_viewer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "VIEWER", ("127.0.0.1", 1))
    with pytest.raises(InertiaError, match=r"no viewer listens on 127\.0\.0\.1:1: open one first"):
        live.require_viewer()


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator["Popen[str]"]:
    """Rerun's own server, which takes what a viewer takes."""
    with listening(tmp_path, "--serve-grpc", "--port", "0") as (address, process, _):
        host, port = address.split(":")
        monkeypatch.setattr(live, "VIEWER", (host, int(port)))
        yield process


@pytest.fixture
def mute(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A port that takes connections and never answers."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        monkeypatch.setattr(live, "VIEWER", listener.getsockname())
        monkeypatch.setattr(live, "PATIENCE", 0.2)
        yield


def killed_at(block: int, server: "Popen[str]", monkeypatch: pytest.MonkeyPatch) -> None:
    """Kill a server before so many blocks have been sent to it: others go to a file."""
    send, left = Recording.flush, [block]

    def flush(recording: Recording) -> None:
        if recording.live:
            left[0] -= 1
            if not left[0]:
                server.kill()
                server.wait()
        send(recording)

    monkeypatch.setattr(Recording, "flush", flush)


@pytest.mark.parametrize("block", [1, 8])
def test_a_viewer_that_ends_leaves_the_file_whole(
    server: "Popen[str]", block: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    killed_at(block, server, monkeypatch)
    with pytest.raises(live.ViewerError, match="ended before it had all; the result and its files are whole"):
        record(simulate(t_handle()), tmp_path / "run.rrd", live=True)
    assert verified(tmp_path / "run.rrd", tmp_path)


@pytest.mark.usefixtures("mute")
def test_a_viewer_that_never_answers_is_given_up(tmp_path: Path) -> None:
    with pytest.raises(live.ViewerError, match=r"took nothing for 0\.2 s before it had all"):
        record(simulate(t_handle()), tmp_path / "run.rrd", live=True)
    assert verified(tmp_path / "run.rrd", tmp_path)


@pytest.mark.usefixtures("mute")
def test_what_else_goes_wrong_is_told_though_the_viewer_is_mute() -> None:
    import rerun.blueprint as rrb

    def write(recording: Recording) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), live.to_viewer("inertia-test", rrb.Blueprint()) as recording:
        write(recording)
