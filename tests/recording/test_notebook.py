"""Recordings in a notebook: the viewer gets what a file would have, or one sentence says what to install."""

import importlib.util
from typing import Any

import pytest

import inertia
from inertia_meshes import path


@pytest.fixture(scope="module")
def run() -> inertia.Run:
    return inertia.simulate(inertia.Scene.load(path("scenes/t_handle.toml")))


def test_without_the_package_a_sentence_says_so(run: inertia.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(
        "inertia.recording.record.find_spec", lambda name: None if name == "rerun_notebook" else find(name)
    )
    with pytest.raises(inertia.UsageError, match=r"install it by pip install rerun-notebook==\d") as caught:
        inertia.show(run)
    assert caught.value.code == "needs_package"


def test_the_viewer_gets_the_recording(run: inertia.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rerun_notebook", reason="rerun-notebook is not installed", exc_type=ImportError)
    from rerun.notebook import Viewer

    data: list[Any] = []
    monkeypatch.setattr(Viewer, "_flush_hook", lambda viewer, some: data.append(some))
    assert isinstance(inertia.show(run), Viewer)
    assert b"RRF" in b"".join(bytes(some) for some in data)[:16]
    assert len(b"".join(map(bytes, data))) > 10_000
