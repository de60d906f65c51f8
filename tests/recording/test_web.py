"""Recordings in a browser: one page that plays from the disk, or from a server of this machine, and asks nobody."""

import base64
import gzip
import os
import re
import signal
import stat
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from tests.recording import browser

import inertia
from inertia.errors import InertiaError, ReadError, UsageError
from inertia.recording import viewer
from inertia_meshes import path

BROWSER = pytest.mark.skipif(browser.PROGRAM is None, reason="chromium is not installed")
PLAYING = "!!document.getElementById('screen') && !document.getElementById('state')"
RUNS_SCRIPTS = pytest.mark.skipif(sys.platform == "win32", reason="a program that is a script")


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("recording") / "run.rrd"
    inertia.record(inertia.simulate(inertia.Scene.load(path("scenes/t_handle.toml"))), file)
    return file


@pytest.fixture(scope="module")
def page(recording: Path) -> Path:
    file = recording.with_name("run.html")
    inertia.export_html(recording, file)
    return file


def held(page: str, name: str) -> bytes:
    """Return the bytes of a part that a page holds."""
    blocks = re.findall(rf'<script type="text/plain" data-part="{name}">(.*?)</script>', page)
    return gzip.decompress(b"".join(base64.b64decode(block) for block in blocks))


def test_one_file_holds_the_viewer_the_recording_and_the_licences(page: Path, recording: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert held(text, "recording") == recording.read_bytes()
    assert held(text, "viewer").startswith(b"\0asm")
    assert "<title>t_handle</title>" in text
    assert "Permission is hereby granted" in text
    assert "Apache License" in text
    assert not re.search(r"<(?:link|img|iframe)\b|\ssrc=", re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL))
    assert page.stat().st_size < 25e6


def test_its_policy_lets_it_ask_for_nothing(page: Path) -> None:
    with page.open(encoding="utf-8") as file:
        head = file.read(4000)
    (policy,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]*)"', head)
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    assert rules["default-src"] == "'none'"
    assert rules["connect-src"] == "data: blob:"
    assert re.fullmatch(r"('sha256-[^']*' ){2}'wasm-unsafe-eval'", rules["script-src"])
    assert head.index("Content-Security-Policy") < head.index("<title>")


@BROWSER
def test_it_moves_in_a_browser_that_reaches_nobody(page: Path, tmp_path: Path) -> None:
    with browser.opened(page.as_uri(), tmp_path) as shown:
        browser.until(lambda: shown.evaluate(PLAYING))
        width, height = browser.SIZE
        bodies = np.s_[: height // 2, : width // 3]
        first = shown.picture()[bodies]

        def turned() -> bool:
            """Whether more has changed where the body is than noise."""
            return int((np.abs(shown.picture()[bodies] - first).max(axis=2) > 40).sum()) > 300

        browser.until(turned)
        assert shown.requests() == [page.as_uri()]
        assert not [complaint for complaint in shown.complaints() if re.search("style|script-src|img-src", complaint)]


@BROWSER
def test_a_served_recording_is_played_without_asking_anybody_else(recording: Path, tmp_path: Path) -> None:
    with serving(recording) as (_, address), browser.opened(address, tmp_path) as shown:
        browser.until(lambda: shown.evaluate(PLAYING))
        assert shown.requests() == [address, f"{address}viewer", f"{address}recording"]


def heard() -> None:
    """Let signals through that whoever runs the tests ignores: nohup, or a shell in the background."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


class serving:
    """`inertia play --web`: its process and its address."""

    def __init__(self, recording: Path) -> None:
        environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "inertia_cli", "play", str(recording), "--web"],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            preexec_fn=None if sys.platform == "win32" else heard,
        )

    def __enter__(self) -> tuple["subprocess.Popen[str]", str]:
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        match = re.match(r"(http://127\.0\.0\.1:\d+/\S+/) plays run\.rrd", line)
        assert match, line
        return self.process, match[1]

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()


@pytest.mark.skipif("sys.platform != 'linux'", reason="signals, and groups of processes")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGINT, 0)])
def test_a_signal_ends_the_server_and_all_that_it_started(recording: Path, number: signal.Signals, code: int) -> None:
    with serving(recording) as (process, address):
        with urllib.request.urlopen(address) as answer:
            assert "connect-src 'self'" in answer.headers["Content-Security-Policy"]
            assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
        process.send_signal(number)
        out, err = process.communicate()
        assert (process.returncode, out, err) == (code, "", "")
        with pytest.raises(ProcessLookupError):
            os.killpg(process.pid, 0)
        with pytest.raises(urllib.error.URLError):
            urllib.request.urlopen(address)


def test_only_who_knows_the_address_is_answered(recording: Path) -> None:
    with serving(recording) as (_, address):
        with urllib.request.urlopen(f"{address}recording") as answer:
            assert answer.read() == recording.read_bytes()
        root = address.rsplit("/", 2)[0] + "/"
        elsewhere = urllib.request.Request(address, headers={"Host": "rebound.example"})
        for request in (root, f"{root}recording", f"{address}../../etc/passwd", elsewhere):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(request)


def test_a_run_is_exported_as_it_is(tmp_path: Path) -> None:
    file = tmp_path / "cube.html"
    scene = inertia.Scene.load(path("scenes/cube.toml"))
    inertia.export_html(inertia.simulate(scene), file)
    text = file.read_text(encoding="utf-8")
    assert "<title>cube</title>" in text
    assert held(text, "recording").startswith(b"RRF")


@RUNS_SCRIPTS
@pytest.mark.parametrize("script", ["exit 1", "echo the web viewer was left out"])
def test_a_viewer_that_is_missing_is_said(
    recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str
) -> None:
    program = tmp_path / "rerun"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(viewer, "program", lambda: program)
    with pytest.raises(InertiaError, match="without the viewer for browsers: install one with it by pip install"):
        inertia.export_html(recording, tmp_path / "run.html")
    assert [file.name for file in tmp_path.iterdir()] == ["rerun"]


def test_nothing_is_written_where_it_cannot_be(page: Path, recording: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="exists"):
        inertia.export_html(recording, page)
    with pytest.raises(UsageError, match=r"its name must end in \.html"):
        inertia.export_html(recording, tmp_path / "run.txt")
    with pytest.raises(ReadError, match="no Rerun recording"):
        inertia.export_html(path("t_handle.stl"), tmp_path / "run.html")
    assert list(tmp_path.iterdir()) == []
