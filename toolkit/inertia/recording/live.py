"""Recordings that go to an open viewer of this machine, which may end or fall silent while they do."""

from __future__ import annotations

import contextlib
import os
import socket
import threading
from collections.abc import Iterator
from typing import TYPE_CHECKING

from inertia.errors import InertiaError
from inertia.recording.writer import Recording, prepare

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb

VIEWER = "127.0.0.1", 9876
"""Where an open viewer of this machine listens."""
PATIENCE = 20.0
"""Seconds for one block to reach the viewer."""


class ViewerError(InertiaError):
    """No viewer listens, or it ended or fell silent before it had all: what was shown on it is whole elsewhere."""

    code = "no_viewer"


def require_viewer() -> None:
    """Raise `ViewerError` where no viewer of this machine listens."""
    host, port = VIEWER
    try:
        socket.create_connection(VIEWER, timeout=5.0).close()
    except OSError:
        raise ViewerError(
            f"no viewer listens on {host}:{port}: open one first by `rerun --bind {host}`, or record to a file"
        ) from None


@contextlib.contextmanager
def to_viewer(application: str, blueprint: rrb.Blueprint, second: float = 1.0) -> Iterator[Recording]:
    """Open a recording that an open viewer of this machine shows as it is written.

    Raises `ViewerError` where the viewer ends, or takes nothing for `PATIENCE` seconds.
    """
    import rerun as rr

    require_viewer()
    host, port = VIEWER
    stream = rr.RecordingStream(application)
    prepare(stream)
    try:
        with _patience() as silence:
            stream.connect_grpc(f"rerun+http://{host}:{port}/proxy", default_blueprint=blueprint)
        if silence:
            raise _lost(silent=True)
        yield Recording(stream, second, _send)
        _send(stream)
    except BaseException:
        with _patience():
            stream.disconnect()
        raise
    with _patience() as silence:
        stream.disconnect()
    if silence:
        raise _lost(silent=True)


def _send(stream: rr.RecordingStream) -> None:
    """Wait until what was written is on its way; hang up on a viewer that does not take it."""
    try:
        stream.flush(timeout_sec=PATIENCE)
    except RuntimeError as error:
        _hang_up()
        raise _lost(silent="timed out" in str(error)) from None


@contextlib.contextmanager
def _patience() -> Iterator[list[float]]:
    """Hang up, as often as it takes, where what is done within waits for ever; the list says for how long it waited."""
    done, silence = threading.Event(), list[float]()

    def watch() -> None:
        while not done.wait(PATIENCE):
            silence.append(PATIENCE)
            _hang_up()

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield silence
    finally:
        done.set()
        watcher.join()


def _lost(*, silent: bool) -> ViewerError:
    host, port = VIEWER
    how = f"took nothing for {PATIENCE:g} s" if silent else "ended"
    return ViewerError(
        f"the viewer on {host}:{port} {how} before it had all; the result and its files are whole: open a viewer "
        f"again by `rerun --bind {host}`, or record to a file and play that"
    )


def _hang_up() -> None:
    """Shut the connections of this process to the viewer."""
    import psutil

    for each in psutil.Process().net_connections("tcp4"):
        if each.raddr == VIEWER and each.fd >= 0:
            with contextlib.suppress(OSError), socket.socket(fileno=os.dup(each.fd)) as connection:
                connection.shutdown(socket.SHUT_RDWR)
