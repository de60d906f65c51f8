"""Recordings in a browser: a page with the web viewer of the installed rerun-sdk, as a file or from a server.

The viewer's files are in Rerun's program, which serves them. The page forbids itself, by its content security policy,
to ask any host for anything.
"""

from __future__ import annotations

import base64
import hashlib
import html
import os
import re
import secrets
import shutil
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import distribution
from importlib.resources import files
from itertools import chain
from pathlib import Path
from typing import Any
from urllib.request import ProxyHandler, build_opener

from inertia.balancing.balance import Balance
from inertia.dynamics.run import Run
from inertia.errors import InertiaError, visible
from inertia.output import require_writable, temporary_folder, whole
from inertia.recording import viewer
from inertia.recording.provenance import properties
from inertia.recording.record import record
from inertia.records import dataclass

_NO_RECORDING = "http://127.0.0.1:9/none.rrd"
"""What the server is told to show, so that it does not listen for recordings."""
_BLOCK = 3 << 20  # bytes, a multiple of three: base64 of the blocks in a row is that of the whole
_PATIENCE = 60.0  # s, for an answer from this machine


@dataclass(frozen=True, eq=False)
class _Viewer:
    """The web viewer: its version, its script, its WebAssembly, and the licences of both."""

    version: str
    script: str
    module: bytes
    licences: str


def export_html(
    recording: str | os.PathLike[str] | Run | Balance, path: str | os.PathLike[str], *, force: bool = False
) -> None:
    """Write a recording as one HTML file that plays from the disk in a browser, without a server or a network.

    The file holds the web viewer of the installed rerun-sdk (14 MB compressed, 18 MB as text) with its licences, and
    the recording. Its content security policy lets it ask for nothing. It appears under its name when it is whole.

    Parameters
    ----------
    recording : of a file ending in .rrd; or a run, or a rotor, to be recorded first
    path : of the file, ending in .html
    force : write over a file that is there

    Raises
    ------
    UsageError : a path that is not usable, or a file that is there
    ReadError : the recording is not one, or not whole
    InertiaError : the installed rerun-sdk has no web viewer, or the place cannot be written to
    """
    target = require_writable(path, ".html", ".htm", force=force)
    if isinstance(recording, Run | Balance):
        with temporary_folder() as folder:
            record(recording, folder / "recording.rrd")
            _write(folder / "recording.rrd", target)
    else:
        _write(Path(recording), target)


@contextmanager
def served(recording: str | os.PathLike[str]) -> Iterator[tuple[str, ThreadingHTTPServer]]:
    """Yield the address at which browsers of this machine can play a recording, and the server, to be run.

    Whoever does not know the address is not answered, nor is a page of another host whose name leads here.
    Raises as `export_html`.
    """
    file = Path(recording)
    viewer_files = _web_viewer()
    policy = _policy(viewer_files, "'self'")
    page = b"".join(_page(_title(file), viewer_files, {}, policy))
    secret = f"/{secrets.token_urlsafe(9)}/"
    answers: dict[str, tuple[str, bytes | Path]] = {
        secret: ("text/html; charset=utf-8", page),
        f"{secret}viewer": ("application/wasm", viewer_files.module),
        f"{secret}recording": ("application/octet-stream", file),
    }

    kind = type("Answer", (_Answer,), {"content": answers, "policy": f"{policy}; frame-ancestors 'none'"})
    with ThreadingHTTPServer(("127.0.0.1", 0), kind) as server:
        server.daemon_threads = True
        yield f"http://127.0.0.1:{server.server_port}{secret}", server


class _Answer(BaseHTTPRequestHandler):
    """What is at an address of this server."""

    content: Mapping[str, tuple[str, bytes | Path]]
    policy: str

    def do_GET(self) -> None:
        """Answer with what is at the address."""
        host = self.headers.get("Host", "").rpartition(":")[0] or self.headers.get("Host", "")
        if host not in ("127.0.0.1", "localhost") or self.path not in self.content:
            self.send_error(404)
            return
        kind, content = self.content[self.path]
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(content.stat().st_size if isinstance(content, Path) else len(content)))
        self.send_header("Content-Security-Policy", self.policy)
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        with suppress(ConnectionError):  # the browser has what it wants, or was closed
            if isinstance(content, Path):
                with content.open("rb") as file:
                    shutil.copyfileobj(file, self.wfile)
            else:
                self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""


def _write(recording: Path, target: Path) -> None:
    title, viewer_files = _title(recording), _web_viewer()
    with recording.open("rb") as file, whole(target) as beside, beside.open("wb") as page:
        blocks = iter(lambda: file.read(_BLOCK), b"")
        parts = {"viewer": _packed([viewer_files.module]), "recording": _packed(blocks)}
        page.writelines(_page(title, viewer_files, parts, _policy(viewer_files, "data: blob:")))


def _title(recording: Path) -> str:
    """Return what a recording is called: by its scene or rotor, or by its file. Raises `ReadError` if it is none."""
    sections = properties(recording)
    name = next(
        (sections[key]["name"] for key in ("scene", "rotor") if "name" in sections.get(key, {})), recording.name
    )
    return visible(Path(name).stem)


def _web_viewer() -> _Viewer:
    """Return the files of the web viewer that Rerun's program holds, as it serves them on this machine."""
    sdk = distribution("rerun-sdk")
    notices = viewer.program().with_name("THIRD_PARTY_NOTICES.md")
    texts = [sdk.read_text(f"licenses/LICENSE-{name}") for name in ("MIT", "APACHE")]
    if notices.is_file():
        texts.append(notices.read_text(encoding="utf-8"))
    options = ("--serve-web", "--web-viewer-port", "0", _NO_RECORDING)
    with temporary_folder() as home, viewer.listening(home, *options) as (address, _, _):
        if address:
            with suppress(OSError):
                script, module = (
                    _fetched(f"http://{address}/{name}") for name in ("re_viewer.js", "re_viewer_bg.wasm")
                )
                if module.startswith(b"\0asm") and b"wasm_bindgen" in script:
                    licences = "\n\n".join(text for text in texts if text)
                    return _Viewer(sdk.version, _inline(script.decode()), module, licences)
    raise InertiaError(
        f"the installed rerun-sdk {sdk.version} comes without the viewer for browsers: install one with it by "
        "pip install --force-reinstall 'rerun-sdk>=0.41,<0.42'",
        code="needs_package",
    )


def _fetched(address: str) -> bytes:
    content: bytes = build_opener(ProxyHandler({})).open(address, timeout=_PATIENCE).read()
    return content


def _inline(script: str) -> str:
    """Return a script, or text in an element of one, as it may stand in a page: it does not end the element."""
    return re.sub(r"<(?=/script|!--)", r"\\x3c", script, flags=re.IGNORECASE)


def _policy(viewer_files: _Viewer, connections: str) -> str:
    """Return the content security policy: these scripts, WebAssembly and this style; requests to nobody else."""
    scripts = " ".join(_hash(text) for text in (viewer_files.script, _own("player.js")))
    return (
        f"default-src 'none'; script-src {scripts} 'wasm-unsafe-eval'; style-src {_hash(_own('style.css'))}; "
        f"img-src data: blob:; connect-src {connections}; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _own(name: str) -> str:
    return files("inertia.recording").joinpath("page", name).read_text(encoding="utf-8")


def _page(title: str, viewer_files: _Viewer, parts: Mapping[str, Iterable[str]], policy: str) -> Iterator[bytes]:
    """Yield a page in pieces; those of `parts` that it does not hold, it fetches by their names."""
    yield f"""<!doctype html>
<!-- A recording of a motion, and Rerun's web viewer {viewer_files.version} (https://rerun.io), which plays it:
     copyright Rerun Technologies AB and contributors, MIT or Apache-2.0. The licences, and those of what the viewer is
     made of, are at the end. -->
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(title)}</title>
<style>{_own("style.css")}</style>
</head>
<body>
<p id="state">{html.escape(title)}: the viewer starts …</p>
<noscript><p>JavaScript has to be on.</p></noscript>
<canvas id="screen"></canvas>
""".encode()
    for name, blocks in parts.items():
        for block in blocks:
            yield f'<script type="text/plain" data-part="{name}">{block}</script>\n'.encode()
    for script in (viewer_files.script, _own("player.js")):
        yield f"<script>{script}</script>\n".encode()
    licences = _inline(viewer_files.licences)
    yield f'<script type="text/plain" id="licences">\n{licences}\n</script>\n</body>\n</html>\n'.encode()


def _packed(blocks: Iterable[bytes]) -> Iterator[str]:
    """Yield blocks compressed by gzip, as base64."""
    packer = zlib.compressobj(6, wbits=31)
    waiting = b""
    for block in chain(blocks, [None]):
        waiting += packer.flush() if block is None else packer.compress(block)
        while len(waiting) >= _BLOCK or (block is None and waiting):
            yield base64.b64encode(waiting[:_BLOCK]).decode()
            waiting = waiting[_BLOCK:]
