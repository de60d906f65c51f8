"""Files that change while they are read, or are integrated: a sentence, never another part's numbers."""

import hashlib
import json
import os
import threading
from pathlib import Path

import numpy as np
import pytest

from inertia.errors import ReadError
from inertia.mass.analyse import analyse
from inertia.mesh.read import read
from inertia.mesh.readers import stl
from inertia.mesh.surface import FACET, Facets, FacetsInFile
from inertia.mesh.version import refer_to, unchanged
from inertia_meshes.shapes import box, moved

_BOXES = 200


def stl_of(size: float, count: int = _BOXES) -> bytes:
    """Return boxes in a row, so that the records come in several blocks."""
    records = np.zeros((count, 12), FACET)
    for k in range(count):
        Facets(records[k]).corners_f4()[...] = moved(box(size, size, size), 3.0 * size * k, 0, 0)
    return b"boxes".ljust(80) + (12 * count).to_bytes(4, "little") + records.tobytes()


@pytest.fixture
def in_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stl, "IN_MEMORY", 1000)


def rewrite(path: Path, content: bytes) -> None:
    """Write over a file in place, its size and its times as they were."""
    status = path.stat()
    with path.open("r+b") as file:
        file.write(content)
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


@pytest.mark.usefixtures("in_file")
def test_a_large_file_is_integrated_from_where_it_is(tmp_path: Path) -> None:
    path = tmp_path / "boxes.stl"
    path.write_bytes(stl_of(2.0))
    part = read(path)
    assert isinstance(part.geometry, FacetsInFile)
    whole = Facets(part.geometry.records)
    assert part.geometry.count == whole.count == 12 * _BOXES
    mask = np.arange(whole.count) % 7 == 3
    for index in (mask, np.flatnonzero(mask), np.array([2399, 0, 3, 3, 2000]), np.array([0, 0, 2]), np.arange(0)):
        assert np.array_equal(part.geometry.select(index).records, whole.select(index).records)
    assert np.array_equal(part.geometry.sample(50), whole.sample(50))
    path.unlink()  # it is open
    assert analyse(part).properties.volume == analyse(type(part)(whole)).properties.volume


@pytest.mark.skipif(not hasattr(os, "pread"), reason="such reads are simulated in it")
@pytest.mark.usefixtures("in_file")
def test_reads_that_return_less_than_was_asked_for_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Linux reads 2 GB at a time at most: 43 million triangles."""
    path, pread = tmp_path / "boxes.stl", os.pread
    path.write_bytes(stl_of(2.0))
    expected = Facets(np.frombuffer(path.read_bytes()[stl.HEADER :], FACET))
    monkeypatch.setattr(os, "pread", lambda file, size, at: pread(file, min(size, 1777), at))
    part = read(path)
    assert np.array_equal(part.triangles.corners(), expected.corners())
    path.write_bytes(stl_of(2.0)[:-50])
    with pytest.raises(ReadError, match="it changed while it was being read"):
        part.triangles.corners()


@pytest.mark.usefixtures("in_file")
@pytest.mark.parametrize("change", ["rewritten", "cut short", "grown"])
def test_a_large_file_that_changes_before_it_is_integrated_is_refused(change: str, tmp_path: Path) -> None:
    path = tmp_path / "boxes.stl"
    path.write_bytes(stl_of(2.0))
    part = read(path)
    if change == "rewritten":
        path.write_bytes(stl_of(3.0))
    else:
        os.truncate(path, 50_000 if change == "cut short" else 400_000)
    with pytest.raises(ReadError, match=r"cannot read .*boxes.stl: it changed while it was being read: wait"):
        analyse(part)


def test_a_small_part_keeps_the_hash_of_what_was_read(tmp_path: Path) -> None:
    path = tmp_path / "boxes.stl"
    path.write_bytes(before := stl_of(2.0))
    part = read(path)
    path.write_bytes(stl_of(3.0))
    assert analyse(part).properties.volume == pytest.approx(_BOXES * 8e-9)
    assert part.source.sha256 == hashlib.sha256(before).hexdigest()


def test_the_hash_of_a_text_that_changed_later_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "box.obj"
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    path.write_text(text + "# " + "comment " * 10_000 * 20)
    part = read(path)
    rewrite(path, text.replace("1 0 0", "2 0 0").encode())
    with pytest.raises(ReadError, match=r"cannot read .*box.obj: it changed while it was being read"):
        part.source.sha256  # noqa: B018  # the property reads


@pytest.mark.parametrize("size", [100, 2**21])
def test_a_change_with_size_and_times_as_before_is_noticed(size: int, tmp_path: Path) -> None:
    path = tmp_path / "part"
    path.write_bytes(bytes(size))
    with pytest.raises(ReadError, match="it changed"), unchanged(path):
        rewrite(path, b"x" * size)


def test_another_file_in_its_place_is_noticed(tmp_path: Path) -> None:
    path, other = tmp_path / "part", tmp_path / "other"
    path.write_bytes(b"x")
    other.write_bytes(b"x")
    with pytest.raises(ReadError, match="it changed"), unchanged(path):
        other.replace(path)


def test_damage_is_put_down_to_the_change(tmp_path: Path) -> None:
    path = tmp_path / "part"
    path.write_bytes(b"solid")

    def reads() -> None:
        with unchanged(path):
            path.write_bytes(b"")
            raise ReadError("it is empty")

    with pytest.raises(ReadError, match="it changed"):
        reads()


@pytest.mark.parametrize("limit", [1000, 2**24])
def test_hash_and_volume_belong_together_while_another_process_writes(
    limit: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stl, "IN_MEMORY", limit)
    path = tmp_path / "boxes.stl"
    contents = {hashlib.sha256(stl_of(k)).hexdigest(): (k, stl_of(k)) for k in (2.0, 3.0)}
    path.write_bytes(stl_of(2.0))
    done = threading.Event()

    def write() -> None:
        while not done.is_set():
            for _, content in contents.values():
                with path.open("r+b") as file:
                    file.write(content)
                done.wait(0.02)

    writer = threading.Thread(target=write)
    writer.start()
    answers = refusals = 0
    try:
        for _ in range(25):
            try:
                part = read(path)
                volume, digest = analyse(part, intersections=False).properties.volume, part.source.sha256
            except ReadError as error:
                refusals += "changed while it was being read" in str(error)
            else:
                assert digest is not None
                assert volume == pytest.approx(_BOXES * (contents[digest][0] * 1e-3) ** 3)
                answers += 1
    finally:
        done.set()
        writer.join()
    assert answers + refusals == 25


def test_a_file_that_is_referred_to_belongs_to_the_part(tmp_path: Path) -> None:
    corners = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 1]], np.float32)
    indices = np.array([0, 1, 2, 0, 2, 3, 0, 3, 1, 2, 1, 3], np.uint32)
    buffer = tmp_path / "box.bin"
    buffer.write_bytes(corners.tobytes() + indices.tobytes())
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48}]
    tree = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "box.bin", "byteLength": 96}],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    path = tmp_path / "box.gltf"
    path.write_text(json.dumps(tree))
    source = read(path).source
    digest = hashlib.sha256(buffer.read_bytes()).hexdigest()
    assert source.to_dict()["files"] == [{"path": "box.bin", "sha256": digest}]

    def reads() -> None:
        with unchanged(path):
            refer_to(buffer, "box.bin")
            rewrite(buffer, bytes(96))

    with pytest.raises(ReadError, match="it changed"):
        reads()
