"""The one mesh in a compressed file or an archive is read as it would be by itself; the rest is refused by name."""

import bz2
import gzip
import hashlib
import io
import lzma
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import binary_stl, off, plain_3mf, text_stl
from tests.mesh.readers.test_errors import refused

from inertia.errors import ReadError, Remedy, UsageError
from inertia.mesh.read import read
from inertia_cli.main import main

STREAMS = {"gz": gzip.compress, "bz2": bz2.compress, "xz": lzma.compress}


def zipped(**members: bytes) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return packed.getvalue()


def tarred(**members: bytes) -> bytes:
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w") as archive:
        for name, data in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(data)
            archive.addfile(info, io.BytesIO(data))
    return packed.getvalue()


PACKED = {
    **{f"part.off.{suffix}": pack(off().encode()) for suffix, pack in STREAMS.items()},
    **{f"part.tar.{suffix}": pack(tarred(**{"a/part.off": off().encode()})) for suffix, pack in STREAMS.items()},
    "part.tgz": gzip.compress(tarred(**{"part.off": off().encode(), "README": b"words"})),
    "part.zip": zipped(**{"__MACOSX/part.off": b"junk", "a/part.OFF": off().encode(), "licence.txt": b"words"}),
    "part.tar": tarred(**{"../../part.off": off().encode(), ".part.off": b"junk"}),
    "no name": gzip.compress(off().encode()),
    "part.stl.zip": zipped(**{"/etc/part": off().encode()}),
}


@pytest.mark.parametrize("name", PACKED)
def test_the_mesh_in_a_compressed_file_is_read(name: str, tmp_path: Path) -> None:
    file, plain = tmp_path / name, tmp_path / "plain.off"
    file.write_bytes(PACKED[name])
    plain.write_text(off())
    part, same = read(file), read(plain)
    assert part.source.format == "off"
    assert part.source.path == str(file)
    assert part.source.sha256 == hashlib.sha256(PACKED[name]).hexdigest()
    np.testing.assert_array_equal(part.triangles.corners(), same.triangles.corners())
    assert part.notes[0].startswith("unpacked from ")
    assert part.rounding is not None
    assert part.rounding.remainder is not None
    assert same.rounding is not None
    assert same.rounding.remainder is not None
    np.testing.assert_array_equal(part.rounding.remainder(), same.rounding.remainder())


def test_a_large_binary_stl_is_read_from_what_was_unpacked(tmp_path: Path) -> None:
    faces = np.tile([[0, 1, 2]], (400_000, 1))
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    data = np.zeros(len(faces), [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    data["v"] = corners[faces]
    file = tmp_path / "part.stl.gz"
    file.write_bytes(gzip.compress(bytes(80) + np.uint32(len(faces)).tobytes() + data.tobytes(), 1))
    part = read(file)
    assert part.triangles.count == 400_000
    assert part.triangles.corners(399_999).tolist() == corners[None].tolist()


def test_nothing_is_left_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(temporary))
    for name, data in PACKED.items():
        (tmp_path / name).write_bytes(data)
        read(tmp_path / name)
    assert list(temporary.iterdir()) == []
    assert not (tmp_path.parent / "part.off").exists()


MESH = off().encode()
REFUSED = {
    "several.zip": (zipped(**{"a.off": MESH, "b.stl": MESH}), "it holds 2 meshes, a.off, b.stl: unpack it and give"),
    "many.tar": (tarred(**{f"{k}.off": MESH for k in range(9)}), "9 meshes, 0.off, .*, 4.off and 4 more"),
    "none.zip": (zipped(**{"a.txt": b"words", "b.txt": b"words"}), "it holds no mesh, but a.txt, b.txt: give a mesh"),
    "empty.zip": (zipped(), "it holds no mesh at all: give a mesh"),
    "nested.off.gz": (
        gzip.compress(gzip.compress(MESH)),
        "nested.off, which is packed as gzip, and archives in archives are not opened",
    ),
    "nested.gz": (
        gzip.compress(zipped(**{"a.off": MESH})),
        "nested, which is packed as zip, and archives in archives are not opened",
    ),
    "inner.zip": (
        zipped(**{"a.off.gz": gzip.compress(MESH)}),
        "it holds a.off.gz, which is packed as gzip, and archives in",
    ),
    "cut.off.gz": (gzip.compress(MESH)[:-9], "it is a damaged gzip file"),
    "cut.off.bz2": (bz2.compress(MESH)[:-9], "it is a damaged bzip2 file"),
    "cut.off.xz": (lzma.compress(MESH)[:-9], "it is a damaged xz file"),
    "cut.zip": (PACKED["part.zip"][:200], "it is a damaged zip file"),
    "cut.tar": (PACKED["part.tar"][:700], "it is a damaged tar file"),
    "not.off.gz": (gzip.compress(b"OFF\n1 1 0\n"), "not.off in it: "),
    "void.stl.gz": (gzip.compress(b""), "void.stl in it: it is empty"),
    "a.stl": (zipped(**{"\x1b[31m.off": b"junk", "b.off": MESH}), r"it holds 2 meshes, .*u001b\[31m.off"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_other_archives_are_refused_by_name(name: str, tmp_path: Path) -> None:
    data, reason = REFUSED[name]
    file = tmp_path / name
    file.write_bytes(data)
    refused(file, reason)


@pytest.mark.parametrize("pack", [*STREAMS.values(), lambda data: zipped(**{"a.stl": data})])
def test_a_bomb_is_refused_at_the_limit(pack, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bomb"
    file.write_bytes(pack(bytes(8 * 2**20)))
    with pytest.raises(ReadError, match=r"it unpacks to more than 0.001 GiB: .*, or give unpack_limit=GIB") as caught:
        read(file, unpack_limit=0.001)
    assert caught.value.remedies == (Remedy("read", "unpack_limit", "GIB"),)
    assert main(["check", str(file), "--unpack-limit", "0.001"]) == 3
    assert "or give --unpack-limit GIB" in capsys.readouterr().err
    refused(file, "a file of zeros, which was not written to its end")
    with pytest.raises(UsageError, match="unpack_limit is 0"):
        read(file, unpack_limit=0)


def test_formats_that_are_archives_are_no_archives(tmp_path: Path) -> None:
    for name in ("part.3mf", "part.zip", "part"):
        (tmp_path / name).write_bytes(plain_3mf())
        assert read(tmp_path / name).source.format == "3mf"
    (tmp_path / "packed.zip").write_bytes(zipped(**{"part.3mf": plain_3mf()}))
    assert read(tmp_path / "packed.zip").source.format == "3mf"


def test_a_format_that_is_asked_for_is_that_of_the_mesh_within(tmp_path: Path) -> None:
    (tmp_path / "part.gz").write_bytes(gzip.compress(text_stl().encode()))
    (tmp_path / "other.gz").write_bytes(gzip.compress(binary_stl()))
    assert read(tmp_path / "part.gz", format="stl").source.format == "stl"
    assert read(tmp_path / "other.gz").source.format == "stl"
    refused(tmp_path / "part.gz", "part in it: ", format="off")
