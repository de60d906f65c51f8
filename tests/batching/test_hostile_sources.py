"""Files, archives and manifests that are damaged, odd or meant to do harm: a row or a sentence for each."""

import bz2
import errno
import gzip
import io
import json
import os
import shutil
import stat
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from tests.mesh.readers.samples import gltf_tree

import inertia
from inertia.batching.sources import tasks_of
from inertia.errors import visible
from inertia.tables import cell_text, csv_text, read_table
from inertia_cli.main import main
from inertia_meshes import path

CUBE, HANDLE, OPEN = (path(name).read_bytes() for name in ("cube.stl", "t_handle.stl", "broken/missing_face.stl"))
CUBE_MASS, HANDLE_MASS = (
    inertia.analyse(inertia.read(path(f"{name}.stl"))).properties.mass for name in ("cube", "t_handle")
)
NO_FILE = "there is no such file: check the path"
UNIX = pytest.mark.skipif(sys.platform == "win32", reason="pipes, and names that Windows does not have")


def rows(*paths: Any, **options: Any) -> list[dict[str, Any]]:
    return list(inertia.batch(paths, jobs=1, **options))


def unreadable(row: dict[str, Any], name: object, says: str) -> None:
    assert (row["path"], row["state"], row["exit_code"]) == (str(name), "unreadable", 3)
    assert says in row["message"]
    assert "\n" not in row["message"]


def zipped(file: Path, members: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(file, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return file


def linked(name: str, target: str, kind: bytes = tarfile.SYMTYPE) -> tarfile.TarInfo:
    entry = tarfile.TarInfo(name)
    entry.type, entry.linkname = kind, target
    return entry


def tarred(file: Path, members: Sequence[tuple[str, bytes | str]], mode: Any = "w") -> Path:
    """Write a tar archive; a member with text in place of bytes is a hard link to what that names."""
    with tarfile.open(file, mode) as archive:
        for name, data in members:
            entry = tarfile.TarInfo(name)
            if isinstance(data, str):
                archive.addfile(linked(name, data, tarfile.LNKTYPE))
            else:
                entry.size = len(data)
                archive.addfile(entry, io.BytesIO(data))
    return file


@pytest.mark.parametrize(
    ("name", "old", "new", "says"),
    [
        ("ü.stl", b"\xc3\xbc", b"\xfc.", "codec can't decode"),
        ("a.stl", b"a.stl", b"\0.stl", "a file in it has no name"),
    ],
)
@pytest.mark.parametrize("beside", [{}, {"b.stl": CUBE, "c.stl": HANDLE}])
def test_a_damaged_name_in_a_zip_is_said_of_the_archive(
    name: str,
    old: bytes,
    new: bytes,
    says: str,
    beside: dict[str, bytes],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    file = zipped(tmp_path / "order.zip", {name: CUBE, **beside})
    file.write_bytes(file.read_bytes().replace(old, new))
    damaged, whole = rows(file, path("cube.stl"))
    unreadable(damaged, file, f"cannot read {file}: it is a damaged zip file (")
    assert says in damaged["message"]
    assert whole["state"] == "answered"
    assert main(["analyse", str(file)]) == 3
    assert "it is a damaged zip file" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["a\0b.zip", "a\0b.stl", "a\0*.stl", "a\0b.tar.gz"])
def test_a_zero_byte_in_a_path_has_its_row(name: str, tmp_path: Path) -> None:
    (tmp_path / "manifest.csv").write_text(f"path\n{name}\n")
    listed, given = rows(tmp_path / "manifest.csv", name)
    unreadable(listed, tmp_path / name, NO_FILE)
    unreadable(given, name, NO_FILE)


@pytest.mark.parametrize("verb", ["analyse", "check", "balance", "audit"])
def test_what_no_file_can_be_called_is_no_file_for_any_verb(verb: str) -> None:
    for row in rows("a\0b.urdf", "a\ud800b.urdf", verb=verb):
        assert (row["state"], row["exit_code"]) == ("unreadable", 3)
        assert NO_FILE in row["message"]


@pytest.mark.parametrize("name", ["a\0b.csv", "a\0*.csv"])
def test_a_zero_byte_in_the_path_of_a_manifest_is_said(name: str) -> None:
    with pytest.raises(inertia.ReadError, match=NO_FILE):
        rows(name)


def test_a_minus_in_a_list_is_a_file_of_that_name(tmp_path: Path) -> None:
    (tmp_path / "manifest.csv").write_text("path\n-\n")
    command = [sys.executable, "-m", "inertia_cli", "batch", "--jobs", "1", "-o", "table.csv", "--force"]

    def batch(*arguments: str, listed: str) -> list[str]:
        subprocess.run(
            [*command, *arguments], input=listed, text=True, cwd=tmp_path, check=True, timeout=60, capture_output=True
        )
        return (tmp_path / "table.csv").read_text().splitlines()[1:]

    for arguments, listed in ((["-"], "-\n"), (["manifest.csv"], "")):
        (missing,) = batch(*arguments, listed=listed)
        assert f"./-: {NO_FILE}" in missing
        (tmp_path / "-").write_bytes(CUBE)
        (there,) = batch(*arguments, listed=listed)
        assert ",answered,0," in there
        (tmp_path / "-").unlink()


@UNIX
@pytest.mark.parametrize("name", ["pipe.zip", "pipe.tar", "pipe.tar.gz"])
def test_a_pipe_that_is_called_as_an_archive_is_refused_at_once(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / name)
    os.mkfifo(tmp_path / "pipe.stl")
    code = f"import inertia; print([row['message'] for row in inertia.batch(['{name}', 'pipe.stl'], jobs=1)])"
    end = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=True
    )
    assert end.stdout.count("it is not a regular file but a pipe, socket or device") == 2


def test_paths_in_a_manifest_are_names_as_they_stand(tmp_path: Path) -> None:
    (tmp_path / "bracket1.stl").write_bytes(CUBE)
    (tmp_path / "manifest.csv").write_text("path\nbracket[1].stl\nnone*.stl\nbracket?.stl\nbracket1.stl\n")
    *missing, there = rows(tmp_path / "manifest.csv")
    for row, name in zip(missing, ["bracket[1].stl", "none*.stl", "bracket?.stl"], strict=True):
        unreadable(row, tmp_path / name, NO_FILE)
    assert there["state"] == "answered"


def test_a_glob_that_is_too_long_for_a_name_is_a_glob_still() -> None:
    with pytest.raises(inertia.UsageError, match="matches no file"):
        rows("[ab]" * 100)


@UNIX
def test_a_file_with_brackets_in_its_name_is_that_file(tmp_path: Path) -> None:
    (tmp_path / "bracket[1].stl").write_bytes(HANDLE)
    (tmp_path / "bracket1.stl").write_bytes(CUBE)
    (tmp_path / "manifest.csv").write_text("path\nbracket[1].stl\n")
    (row,) = rows(tmp_path / "manifest.csv")
    assert (row["path"], row["mass"]) == (str(tmp_path / "bracket[1].stl"), HANDLE_MASS)


@pytest.mark.parametrize("suffix", ["", ".gz"])
def test_a_hard_link_in_a_tar_archive_is_the_file_that_it_links_to(suffix: str, tmp_path: Path) -> None:
    members = [
        ("a/cube.stl", CUBE), ("data", HANDLE), ("link.stl", "a/cube.stl"), ("./again.stl", "link.stl"),
        ("handle.stl", "data"), ("a/cube.stl", "a/cube.stl"), ("nowhere.stl", "none.stl"), ("itself.stl", "itself.stl"),
    ]  # fmt: skip
    file = tarred(tmp_path / f"order.tar{suffix}", members, "w:gz" if suffix else "w")
    cube, link, again, handle, nowhere, itself = rows(file)
    names = ["a/cube.stl", "link.stl", "./again.stl", "handle.stl"]
    assert [row["path"] for row in (cube, link, again, handle)] == [f"{file}/{name}" for name in names]
    assert [row["mass"] for row in (cube, link, again, handle)] == [CUBE_MASS, CUBE_MASS, CUBE_MASS, HANDLE_MASS]
    for row, name in ((nowhere, "nowhere"), (itself, "itself")):
        says = f"cannot read {file}/{name}.stl: it is a hard link to a file that is not before it: pack it again"
        unreadable(row, f"{file}/{name}.stl", says)


def test_a_hard_link_that_is_the_only_mesh_is_read(tmp_path: Path) -> None:
    file = tarred(tmp_path / "part.tar", [("blob", HANDLE), ("part.stl", "blob")])
    assert inertia.analyse(inertia.read(file)).properties.mass == HANDLE_MASS
    assert rows(file)[0]["mass"] == HANDLE_MASS
    with pytest.raises(inertia.ReadError, match="it is a hard link to a file that is not before it"):
        inertia.read(tarred(tmp_path / "astray.tar", [("part.stl", "blob")]))


LINKS = [("first.stl", "d/b.stl"), ("d/up.stl", "../a.stl"), ("chain.stl", "d/up.stl"), ("blob.stl", "data")]
ASTRAY = [("out.stl", "/etc/passwd"), ("above.stl", "../a.stl"), ("self.stl", "self.stl"), ("folder.stl", "d")]


@pytest.mark.parametrize("kind", ["zip", "tar", "tar.gz"])
def test_a_symbolic_link_in_an_archive_is_the_file_in_it_that_it_leads_to(kind: str, tmp_path: Path) -> None:
    file, members = tmp_path / f"order.{kind}", {"a.stl": CUBE, "d/b.stl": HANDLE, "data": CUBE}
    if kind == "zip":
        with zipfile.ZipFile(file, "w") as archive:
            for name, target in [*LINKS, *ASTRAY]:
                entry = zipfile.ZipInfo(name)
                entry.create_system, entry.external_attr = 3, (stat.S_IFLNK | 0o777) << 16
                archive.writestr(entry, target)
            for name, data in members.items():
                archive.writestr(name, data)
    else:
        with tarfile.open(file, "w:gz" if kind.endswith("gz") else "w") as tar:
            for name, target in [*LINKS, *ASTRAY]:
                tar.addfile(linked(name, target))
            for name, data in members.items():
                entry = tarfile.TarInfo(name)
                entry.size = len(data)
                tar.addfile(entry, io.BytesIO(data))
    every = {row["path"].removeprefix(f"{file}/"): row for row in rows(file)}
    masses = {name: every.pop(name)["mass"] for name in ("a.stl", "d/b.stl", *dict(LINKS))}
    assert list(masses.values()) == [CUBE_MASS, HANDLE_MASS, HANDLE_MASS, CUBE_MASS, CUBE_MASS, CUBE_MASS]
    for name, target in ASTRAY:
        says = f"it is a link to {target}, which is no file in the archive: pack it again, with that file"
        unreadable(every.pop(name), f"{file}/{name}", says)
    assert every == {}


def test_what_else_is_in_a_tar_archive_has_its_row_or_is_hidden(tmp_path: Path) -> None:
    with tarfile.open(tmp_path / "order.tar", "w") as archive:
        for name in ("a.stl", "b.stl", ".c.stl", ".d/e.stl", ".f.stl.gz", ".g.zip"):
            entry = tarfile.TarInfo(name)
            entry.size = len(CUBE)
            archive.addfile(entry, io.BytesIO(CUBE))
        archive.addfile(linked("pipe.stl", "", tarfile.FIFOTYPE))
    *answered, pipe = rows(tmp_path / "order.tar")
    assert [row["path"] for row in answered] == [f"{tmp_path}/order.tar/{name}.stl" for name in "ab"]
    unreadable(pipe, f"{tmp_path}/order.tar/pipe.stl", "it is a pipe or a device, and no file: leave it out")


@pytest.mark.parametrize("name", [".c.stl", ".d/e.stl"])
def test_hidden_meshes_count_where_nothing_else_is_there(name: str, tmp_path: Path) -> None:
    (one,) = rows(zipped(tmp_path / "one.zip", {name: CUBE}))
    assert one["mass"] == CUBE_MASS
    (two,) = rows(zipped(tmp_path / "two.zip", {name: CUBE, ".x.stl": CUBE}))
    assert f"it holds 2 meshes, {name}, .x.stl: " in two["message"]
    (shown,) = rows(zipped(tmp_path / "shown.zip", {name: CUBE, "t.stl": HANDLE}))
    assert shown["mass"] == HANDLE_MASS


@pytest.mark.parametrize("kind", [tarfile.SYMTYPE, tarfile.LNKTYPE])
def test_a_mesh_and_a_link_to_it_are_one_mesh(kind: bytes, tmp_path: Path) -> None:
    file = tarred(tmp_path / "part.tar", [("v2.stl", CUBE)])
    with tarfile.open(file, "a") as archive:
        archive.addfile(linked("latest.stl", "v2.stl", kind))
    assert inertia.analyse(inertia.read(file)).properties.mass == CUBE_MASS


def test_a_hard_link_does_not_take_of_what_an_archive_may_unpack_to(tmp_path: Path) -> None:
    links: list[tuple[str, bytes | str]] = [(f"{number}.stl", "cube.stl") for number in range(99)]
    file = tarred(tmp_path / "order.tar", [("cube.stl", CUBE), *links])
    assert {row["mass"] for row in rows(file, unpack_limit=2 * len(CUBE) / 2**30)} == {CUBE_MASS}


def test_a_tar_archive_beyond_the_limit_is_refused_in_every_row(tmp_path: Path) -> None:
    file = tarred(tmp_path / "order.tar", [(f"{name}.stl", CUBE) for name in "abcd"])
    limit = 2.5 * len(CUBE) / 2**30
    every = rows(file, unpack_limit=limit)
    for row, name in zip(every, "abcd", strict=True):
        unreadable(row, f"{file}/{name}.stl", f"it unpacks to more than {limit:g} GiB")


def test_rows_of_a_manifest_are_counted_as_a_spreadsheet_does(tmp_path: Path) -> None:
    file = tmp_path / "manifest.csv"
    for text in (
        "path,density\n\n\ncube.stl,heavy\n",
        "\n\npath,density\ncube.stl,heavy\n",
        'path,density\n"a\nb",\n\na,heavy\n',
    ):
        file.write_text(text)
        with pytest.raises(inertia.UsageError, match="row 4: density is 'heavy'"):
            rows(file)
    file.write_text("unit,path\nmm,a\n\nmm\n")
    with pytest.raises(inertia.UsageError, match="row 4: the path is empty"):
        rows(file)


@UNIX
def test_a_manifest_may_come_out_of_a_pipe(tmp_path: Path) -> None:
    (tmp_path / "cube.stl").write_bytes(CUBE)
    command = [sys.executable, "-m", "inertia_cli", "batch", "--jobs", "1", "--manifest", "/dev/stdin"]
    listed = "path,unit\ncube.stl,in\n"
    end = subprocess.run(command, input=listed, capture_output=True, text=True, cwd=tmp_path, timeout=60, check=True)
    assert '"path": "cube.stl"' in end.stdout
    assert '"unit": "in"' in end.stdout


@pytest.mark.parametrize(
    ("column", "cell", "says"),
    [
        ("density", "heavy", "give a number, alone or with its standard uncertainty as 7850±50, or one for each"),
        ("accuracy", "fine", "give a number, or exact"),
        ("union", "maybe", "give yes or no"),
        ("allow_faults", "one %", "give a number, as 0.01 or 1%"),
        ("sigma", "1 mm", "give a number"),
        ("scale", "one", "give 1 with its standard uncertainty, as 1±0.001"),
    ],
)
def test_what_a_cell_may_hold_is_said(column: str, cell: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "manifest.csv").write_text(f"path,{column}\ncube.stl,{cell}\n", encoding="utf-8")
    with pytest.raises(inertia.UsageError, match=f"manifest.csv, row 2: {column} is '{cell}': {says}"):
        rows(tmp_path / "manifest.csv")


@pytest.mark.parametrize(
    ("column", "cells", "value"),
    [("allow_faults", ("5%", "0.05"), 0.05), ("scale", ("±0.1%", "1±0.001"), inertia.Estimate(1.0, 0.001))],
)
def test_shares_and_scales_are_written_as_on_the_command_line(
    column: str, cells: tuple[str, ...], value: float, tmp_path: Path
) -> None:
    files = [tmp_path / f"{number}.stl" for number in range(len(cells))]
    for file in files:
        shutil.copy(path("broken/missing_face.stl") if column == "allow_faults" else path("cube.stl"), file)
    listed = "".join(f"{file},{cell}\n" for file, cell in zip(files, cells, strict=True))
    (tmp_path / "manifest.csv").write_text(f"path,{column}\n{listed}", encoding="utf-8")
    for written, given in zip(rows(tmp_path / "manifest.csv"), rows(*files, **{column: value}), strict=True):
        assert {**written, "seconds": 0} == {**given, "seconds": 0}


def test_a_glob_of_manifests_stands_for_their_rows(tmp_path: Path) -> None:
    (tmp_path / "br").mkdir()
    for name, data in (("cube.stl", CUBE), ("t.stl", HANDLE)):
        (tmp_path / "br" / name).write_bytes(data)
    (tmp_path / "br/one.csv").write_text("path,unit\ncube.stl,in\n")
    (tmp_path / "br/two.csv").write_text("path,unit\nt.stl,m\n")
    assert [row["unit"] for row in rows(f"{tmp_path}/br/*.csv")] == ["in", "m"]
    with pytest.raises(inertia.UsageError, match=r"none\*.csv matches no file"):
        rows(f"{tmp_path}/none*.csv")


def test_a_table_is_not_written_over_a_manifest_of_a_glob(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "one.csv").write_text(f"path\n{path('cube.stl')}\n")
    file = tmp_path / "one.csv"
    assert main(["batch", f"{tmp_path}/o*.csv", "--jobs", "1", "-o", str(file), "--force"]) == 2
    assert "it is an input" in capsys.readouterr().err


@pytest.mark.parametrize("as_argument", [True, False])
@pytest.mark.parametrize("name", ["one.csv", "*.csv", "none.parquet"])
def test_the_url_of_a_manifest_is_called_so(as_argument: bool, name: str, tmp_path: Path) -> None:
    (tmp_path / "one.csv").write_text("path\n")
    url = f"file://{tmp_path}/{name}"
    with pytest.raises(inertia.UsageError) as raised:
        rows(url) if as_argument else rows(manifest=url)
    says = "is a URL, and a manifest is read from a file: copy it to this machine"
    assert str(raised.value) == f"{url} {says}"


def test_an_archive_in_an_archive_in_an_archive_is_called_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    inner = zipped(tmp_path / "inner.zip", {"cube.stl": CUBE})
    middle = zipped(tmp_path / "middle.zip", {"inner.zip": inner.read_bytes()})
    outer = zipped(tmp_path / "outer.zip", {"middle.zip": middle.read_bytes()})
    says = "it holds inner.zip, which is packed as zip, and archives in archives are not opened: unpack it first"
    (row,) = rows(outer)
    unreadable(row, f"{outer}/middle.zip", f"cannot read {outer}/middle.zip: {says}")
    assert main(["analyse", str(middle)]) == 3
    assert capsys.readouterr().err == f"inertia: cannot read {middle}: {says}\n"


@pytest.mark.parametrize("kind", ["zip", "tar"])
def test_compressed_meshes_in_an_archive_are_read(kind: str, tmp_path: Path) -> None:
    off = b"OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
    members = {
        "a/x.stl.gz": gzip.compress(CUBE),
        "y.stl": HANDLE,
        "z.OFF.bz2": bz2.compress(off),
        "README.gz": b"words",
    }
    file = tmp_path / f"order.{kind}"
    _ = zipped(file, members) if kind == "zip" else tarred(file, [*members.items()])
    one, other, last = rows(file)
    assert [row["path"] for row in (one, other, last)] == [f"{file}/{name}" for name in [*members][:3]]
    assert (one["mass"], other["mass"]) == (CUBE_MASS, HANDLE_MASS)
    assert last["volume"] == pytest.approx(1e-9 / 6, rel=1e-12)


def test_the_only_mesh_in_an_archive_may_be_compressed(tmp_path: Path) -> None:
    file = zipped(tmp_path / "part.zip", {"x.stl.gz": gzip.compress(CUBE)})
    (row,) = rows(file)
    assert (row["path"], row["mass"]) == (f"{file}/x.stl.gz", CUBE_MASS)


@pytest.mark.parametrize("verb", ["audit", "balance"])
def test_archives_are_opened_for_meshes_only(verb: str, tmp_path: Path) -> None:
    members = {"arm.urdf": path("robots/arm.urdf").read_bytes(), "a.stl": CUBE, "b.stl": CUBE}
    file = zipped(tmp_path / "robots.zip", members)
    (row,) = rows(file, verb=verb)
    says = f"cannot read {file}: archives are opened for meshes only: unpack it and give the files in it"
    unreadable(row, file, says)
    assert row["sha256"] is not None
    (missing,) = rows(tmp_path / "none.zip", verb=verb)
    unreadable(missing, tmp_path / "none.zip", NO_FILE)


@pytest.mark.parametrize("kind", ["gz", "xz"])
def test_an_archive_that_unpacks_to_too_much_is_not_read_to_its_end_for_its_names(kind: str, tmp_path: Path) -> None:
    zeros = bytes(5 * 2**20)
    members = [("a.stl", CUBE), ("b.stl", HANDLE), ("zeros.bin", zeros), ("c.stl", CUBE)]
    file = tarred(tmp_path / f"parts.tar.{kind}", members, mode=f"w:{kind}")
    with file.open("r+b") as stream:  # damage behind the zeros is not met
        stream.seek(-200, os.SEEK_END)
        stream.write(bytes(200))
    (row,) = rows(file, unpack_limit=0.001)
    unreadable(row, file, "it unpacks to more than 0.001 GiB: it is a decompression bomb, or give ")
    whole = tarred(tmp_path / "whole.tar.gz", members, mode="w:gz")
    assert [row["state"] for row in rows(whole)] == ["answered"] * 3
    plain = tarred(tmp_path / "parts.tar", members)
    assert [row["state"] for row in rows(plain, unpack_limit=0.001)] == ["answered"] * 3


@pytest.mark.parametrize(("verb", "name"), [("balance", "rotors/disc.toml"), ("audit", "robots/arm.urdf")])
def test_the_url_of_what_refers_to_files_is_refused(verb: str, name: str) -> None:
    pytest.importorskip("fsspec")
    url = f"file://{path(name)}"
    says = "URLs are read of meshes only: copy it to this machine, with the files that it refers to"
    unreadable(*rows(url, verb=verb), url, f"cannot read {url}: {says}")


@pytest.mark.parametrize("kind", ["one", "zip", "tar", "url"])
def test_a_mesh_out_of_an_archive_or_from_a_url_takes_no_file_from_beside_it(kind: str, tmp_path: Path) -> None:
    tree, binary = gltf_tree()
    tree["buffers"][0]["uri"] = "0.stl"  # as an unpacked member may be called
    members = {"cube.stl": CUBE, "t.gltf": json.dumps(tree).encode(), "0.stl": binary}
    for name, data in members.items():
        (tmp_path / name).write_bytes(data)
    if kind == "url":
        pytest.importorskip("fsspec")
        every = rows(file := f"file://{tmp_path}/t.gltf")
    elif kind == "one":
        file = tmp_path / "t.gltf.gz"
        file.write_bytes(gzip.compress(members["t.gltf"]))
        every = rows(file)
    else:
        archive = tmp_path / f"order.{kind}"
        _ = zipped(archive, members) if kind == "zip" else tarred(archive, [*members.items()])
        file, every = f"{archive}/t.gltf", rows(archive)[1:2]
    unreadable(*every, file, "it refers to '0.stl', and no other file is read out of an archive, from a URL or beside")
    assert rows(tmp_path / "t.gltf")[0]["state"] == "answered"


@pytest.mark.parametrize(("cell", "name"), [("shaft=7850; shaft=1", "'shaft'"), ("7850; shaft=1; 1", "the part")])
def test_a_cell_that_contradicts_itself_is_refused(cell: str, name: str, tmp_path: Path) -> None:
    (tmp_path / "manifest.csv").write_text(f"path,density\ncube.stl,{cell}\n")
    with pytest.raises(inertia.UsageError, match=f"row 2: density is given twice for {name}: give it once"):
        rows(tmp_path / "manifest.csv")


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (["path", "density", "density"], "manifest.parquet has two columns 'density': leave one out$"),
        (["x", "unit"], "has no column 'path', but 'x', 'unit': name the column of paths so$"),
    ],
)
def test_a_parquet_manifest_that_cannot_be_meant_is_refused(names: list[str], says: str, tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    table = pyarrow.Table.from_arrays([pyarrow.array(["1"])] * len(names), names)
    parquet.write_table(table, tmp_path / "manifest.parquet")
    with pytest.raises(inertia.UsageError, match=says):
        rows(tmp_path / "manifest.parquet")


@UNIX
@pytest.mark.parametrize("glob", ["**/*.stl", "**/d/*.stl", "b/*.stl", "*/*.stl", "*/c?be.stl", "[ab]/*/cube.stl"])
def test_a_folder_that_may_not_be_listed_is_said(glob: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("a", "b/d"):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "cube.stl").write_bytes(CUBE)
    scan = os.scandir

    def scandir(folder: Any) -> Any:
        if Path(folder) == tmp_path / "b":
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
        return scan(folder)

    monkeypatch.setattr(os, "scandir", scandir)  # root may list every folder
    with pytest.raises(inertia.ReadError, match=f"^cannot list {tmp_path}/b/?: permission is denied: ask its owner to"):
        rows(f"{tmp_path}/{glob}")
    assert [row["state"] for row in rows(f"{tmp_path}/a/*.stl")] == ["answered"]
    with pytest.raises(inertia.UsageError, match="matches no file"):
        rows(f"{tmp_path}/a/*/*.stl")


def test_a_glob_in_a_chained_url_is_one_for_the_files_in_the_chain(tmp_path: Path) -> None:
    pytest.importorskip("fsspec")
    file = zipped(tmp_path / "order.zip", {"b.stl": CUBE, "a.stl": HANDLE, "a.txt": b""})
    every = rows(f"zip://*.stl::file://{file}")
    assert [row["path"] for row in every] == [f"zip://{name}.stl::file://{file}" for name in "ab"]
    assert [row["mass"] for row in every] == [HANDLE_MASS, CUBE_MASS]


@pytest.mark.parametrize("chain", ["simplecache::file://", "simplecache::zip://a.stl::file://"])
def test_a_chained_url_may_begin_with_a_protocol_alone(chain: str, tmp_path: Path) -> None:
    pytest.importorskip("fsspec")
    (tmp_path / "a.stl").write_bytes(CUBE)
    file = zipped(tmp_path / "a.zip", {"a.stl": CUBE}) if "zip" in chain else tmp_path / "a.stl"
    (row,) = rows(f"{chain}{file}")
    assert (row["path"], row["state"], row["mass"]) == (f"{chain}{file}", "answered", CUBE_MASS)


def test_a_chain_that_cannot_be_listed_comes_with_a_remedy(tmp_path: Path) -> None:
    pytest.importorskip("fsspec")
    (tmp_path / "a.zip").write_bytes(CUBE)
    with pytest.raises(inertia.ReadError, match=r"cannot be listed: .*: copy the files to this machine, or name each$"):
        rows(f"zip://*.stl::file://{tmp_path}/a.zip")


@pytest.mark.parametrize("name", ["=x", "'=x", "'' =x", "''-x", "'-1", "-1", "'x", "'' '=x", "＝x"])
def test_text_in_a_table_reads_back_as_itself(name: str) -> None:
    assert cell_text(csv_text([[name]]).removesuffix("\n")) == name


@UNIX
@pytest.mark.parametrize("suffix", ["jsonl", "parquet", "csv"])
def test_a_path_in_a_table_is_that_of_the_file_or_in_csv_as_it_may_be_printed(suffix: str, tmp_path: Path) -> None:
    if suffix == "parquet":
        pytest.importorskip("pyarrow.parquet")
    names = ["a\r.stl", "a\\u000d.stl", "b\n\x9b.stl", "c\u202e\U000e0001.stl"]
    for name in names:
        (tmp_path / name).write_bytes(CUBE)
    table = tmp_path / f"table.{suffix}"
    assert main(["batch", *(str(tmp_path / name) for name in names), "-o", str(table), "--jobs", "1"]) == 0
    paths = [str(row["path"]) for row in read_table(table)[1]]
    if suffix == "csv":
        names = [visible(name) for name in names]
    assert paths == [f"{tmp_path}/{name}" for name in names]
    if suffix != "parquet":
        assert table.read_text(encoding="utf-8").replace("\n", "").isprintable()


@pytest.mark.skipif(sys.platform != "linux", reason="names of any bytes")
@pytest.mark.parametrize("suffix", ["jsonl", "parquet", "csv"])
def test_bytes_of_a_path_that_are_no_utf_8_are_written_out(suffix: str, tmp_path: Path) -> None:
    if suffix == "parquet":
        pytest.importorskip("pyarrow.parquet")
    name = os.fsdecode(b"a\xff.stl")
    (tmp_path / name).write_bytes(CUBE)
    table = tmp_path / f"table.{suffix}"
    assert main(["batch", str(tmp_path / name), "-o", str(table), "--jobs", "1"]) == 0
    assert [row["path"] for row in read_table(table)[1]] == [f"{tmp_path}/a\\udcff.stl"]
    assert [row["path"] for row in rows(tmp_path / name)] == [str(tmp_path / name)]


@UNIX
def test_the_apostrophe_before_a_path_is_its_own_where_that_file_is_there(tmp_path: Path) -> None:
    manifest = tmp_path / "manifest.csv"
    manifest.write_text("path\n'-dash.stl\n")
    (tmp_path / "-dash.stl").write_bytes(CUBE)
    assert [row["path"] for row in rows(manifest)] == [f"{tmp_path}/-dash.stl"]
    (tmp_path / "'-dash.stl").write_bytes(HANDLE)
    with pytest.raises(inertia.UsageError, match=r"row 2: the path '-dash.stl may be .* put \./ before the one"):
        rows(manifest)
    (tmp_path / "-dash.stl").unlink()
    assert [row["mass"] for row in rows(manifest)] == [HANDLE_MASS]
    manifest.write_text("path\n./'-dash.stl\n")
    assert [row["mass"] for row in rows(manifest)] == [HANDLE_MASS]


@UNIX
@pytest.mark.parametrize(("listed", "name"), [(b"a.stl\r\0b\0", "a.stl\r"), (b"a.stl\r\nb\r\n", "a.stl")])
def test_names_with_zero_bytes_behind_them_are_as_they_stand(
    listed: bytes, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(listed)))
    assert [task.path for task in tasks_of(["-"], "analyse")] == [name, "b"]


def test_a_url_that_nothing_reads_comes_with_a_remedy() -> None:
    pytest.importorskip("fsspec")
    with pytest.raises(inertia.UsageError, match=r"check how it begins, or copy the file to this machine$"):
        rows("foo://x.stl")
