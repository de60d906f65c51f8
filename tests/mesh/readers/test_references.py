"""Files that a document refers to: none outside its folder is read, and of those beneath it no byte too many."""

import json
import os
import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import CORNERS, QUADS, TRIANGLES, by_meshio, glb, gltf_tree, volumes
from tests.mesh.readers.step_sample import step_solid

import inertia
from inertia.errors import ReadError

OUTSIDE = r"it refers to '.*', outside its folder, where nothing is read for it"
MISSING = r"it needs the file '.*' beside it, which is not there"


@pytest.fixture
def places(tmp_path: Path) -> tuple[Path, Path]:
    """A folder of documents, and a file outside it."""
    (tmp_path / "here" / "below").mkdir(parents=True)
    return tmp_path / "here", tmp_path / "secret.bin"


def refused(path: Path, reason: str) -> None:
    with pytest.raises(ReadError, match=reason) as caught:
        inertia.read(path)
    assert str(caught.value).count("cannot read") == 1


def gltf_that_names(folder: Path, uri: str) -> tuple[Path, bytes]:
    tree, binary = gltf_tree()
    tree["buffers"][0]["uri"] = uri
    (folder / "part.gltf").write_text(json.dumps(tree))
    return folder / "part.gltf", binary


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.bin",
        "below/../../secret.bin",
        "%2e%2e/secret.bin",
        "..%2Fsecret.bin",
        "{outside}",
        "/etc/passwd",
        "../../../../../../../../etc/passwd",
        "C:secret.bin",
        "link.bin",
        "linked/secret.bin",
        "below/link.bin",
    ],
)
def test_gltf_reads_no_buffer_outside_its_folder(places: tuple[Path, Path], uri: str) -> None:
    folder, outside = places
    path, binary = gltf_that_names(folder, uri.format(outside=outside))
    outside.write_bytes(binary)
    (folder / "link.bin").symlink_to(outside)
    (folder / "below" / "link.bin").symlink_to("../../secret.bin")
    (folder / "linked").symlink_to(folder.parent)
    refused(path, "which is not fetched" if uri.startswith("C:") else OUTSIDE)


@pytest.mark.parametrize("uri", ["file:///etc/passwd", "http://example.org/a.bin", "FILE:secret.bin"])
def test_gltf_fetches_nothing(places: tuple[Path, Path], uri: str) -> None:
    refused(gltf_that_names(places[0], uri)[0], "it needs the file '.*', which is not fetched: put it beside it")


@pytest.mark.parametrize("uri", ["pipe", "below", "nothing.bin", "circle", "a%00b", "%252e%252e/secret.bin", "a" * 300])
def test_gltf_waits_for_no_pipe_and_takes_no_folder(places: tuple[Path, Path], uri: str) -> None:
    folder, outside = places
    path, binary = gltf_that_names(folder, uri)
    outside.write_bytes(binary)
    os.mkfifo(folder / "pipe")
    (folder / "circle").symlink_to("circle")
    refused(path, MISSING)


@pytest.mark.parametrize("uri", ["part.bin", "below/part.bin", "below/../part.bin", "my%20part.bin", "link.bin"])
def test_gltf_reads_buffers_in_its_folder_and_beneath(places: tuple[Path, Path], uri: str) -> None:
    folder, _ = places
    path, binary = gltf_that_names(folder, uri)
    for name in ("part.bin", "below/part.bin", "my part.bin"):
        (folder / name).write_bytes(binary)
    (folder / "link.bin").symlink_to("below/part.bin")
    assert inertia.read(path).triangles.count == len(TRIANGLES)


def test_the_command_refuses_in_one_sentence(places: tuple[Path, Path]) -> None:
    path, _ = gltf_that_names(places[0], "../../../../../../../../etc/passwd")
    run = subprocess.run(
        [sys.executable, "-c", "from inertia_cli.main import run; run()", "analyse", str(path)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (run.returncode, run.stdout) == (3, "")
    assert run.stderr == (
        f"inertia: cannot read {path}: it refers to '../../../../../../../../etc/passwd', outside its folder, where "
        "nothing is read for it: put that file beside it and export it again\n"
    )


def test_no_file_is_read_beside_standard_input(places: tuple[Path, Path]) -> None:
    path, binary = gltf_that_names(places[0], "part.bin")
    (path.parent / "part.bin").write_bytes(binary)
    run = subprocess.run(
        [sys.executable, "-m", "inertia_cli", "analyse", "-"],
        input=path.read_bytes(), capture_output=True, cwd=path.parent, check=False,
    )  # fmt: skip
    assert run.returncode == 3
    assert b"it refers to 'part.bin', and no other file is read out of an archive, from a URL or beside" in run.stderr


@pytest.mark.parametrize("kind", ["gltf", "glb"])
def test_no_more_bytes_than_the_accessors_need(tmp_path: Path, kind: str) -> None:
    size = 2 * 10**9
    tree, binary = gltf_tree()
    tree["buffers"][0]["byteLength"] = size
    shift = size - len(binary)
    for view in tree["bufferViews"]:
        view["byteOffset"] = view.get("byteOffset", 0) + shift
    if kind == "glb":
        start = glb(tree, b"")
        length = len(start) + size
        head = b"glTF" + (2).to_bytes(4, "little") + length.to_bytes(4, "little") + start[12:-8]
        (tmp_path / "part.glb").write_bytes(head + size.to_bytes(4, "little") + b"BIN\0")
        document = data = tmp_path / "part.glb"
    else:
        tree["buffers"][0]["uri"] = "part.bin"
        document, data = tmp_path / "part.gltf", tmp_path / "part.bin"
        document.write_text(json.dumps(tree))
        data.touch()
    with data.open("r+b") as file:  # a hole, which takes no room
        file.seek(data.stat().st_size + shift)
        file.write(binary)
    inertia.read(document)  # imports what it needs
    tracemalloc.start()
    part = inertia.read(document)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert np.array_equal(part.triangles.corners(), np.float32(CORNERS)[TRIANGLES])
    assert peak < 10**6


def test_a_buffer_that_gets_shorter_is_a_sentence(tmp_path: Path) -> None:
    path, binary = gltf_that_names(tmp_path, "part.bin")
    (tmp_path / "part.bin").write_bytes(binary[:-1])
    refused(path, "buffer 0 is shorter than it says")


def xdmf_that_names(folder: Path, name: str, form: str = "HDF") -> Path:
    """Write an XDMF file whose points are in an HDF5 file, and that file into the folder."""
    h5py = pytest.importorskip("h5py")
    text = volumes(folder)["xdmf"][1].decode()
    start = text.index(">", text.index("<DataItem", text.index("<Geometry"))) + 1
    end = text.index("</DataItem>", start)
    points = np.array(text[start:end].split(), np.float64)
    shape = next(part for part in text[:start].rsplit("<DataItem", 1)[1].split('"') if part[:1].isdigit())
    with h5py.File(folder / "data.h5", "w") as file:
        file["points"] = points.reshape([int(n) for n in shape.split()])
    head, tail = text[:start].rsplit('Format="XML"', 1)
    path = folder / "part.xdmf"
    path.write_text(f'{head}Format="{form}"{tail}{name}:/points{text[end:]}')
    return path


@pytest.mark.parametrize("form", ["HDF", "&#72;DF", "H&#x44;F"])
def test_xdmf_reads_no_file_outside_its_folder(places: tuple[Path, Path], form: str) -> None:
    folder, outside = places
    assert inertia.read(xdmf_that_names(folder, "data.h5", form)).source.format == "xdmf"
    (folder / "data.h5").rename(outside)
    (folder / "link.h5").symlink_to(outside)
    for name in ("../secret.bin", str(outside), "&#46;./secret.bin", "<!-- -->../secret.bin", "link.h5"):
        path = xdmf_that_names(folder, name, form)
        refused(path, OUTSIDE)
    elsewhere = folder / "below" / "linked.xdmf"  # names are taken from where the document itself lies
    elsewhere.symlink_to(xdmf_that_names(folder, "data.h5", form))
    assert inertia.read(elsewhere).source.format == "xdmf"


@pytest.mark.parametrize("form", ["Binary", "&#66;inary", "BINARY"])
def test_xdmf_reads_no_raw_file_however_it_is_spelt(tmp_path: Path, form: str) -> None:
    refused(xdmf_that_names(tmp_path, "/etc/passwd", form), "raw binary files, which are not read")


@pytest.mark.parametrize("how", ["link", "external", "virtual", "nested link"])
def test_hdf5_reads_no_other_file(tmp_path: Path, how: str) -> None:
    h5py = pytest.importorskip("h5py")
    path = xdmf_that_names(tmp_path, "data.h5")
    with h5py.File(tmp_path / "data.h5", "r+") as file:
        points = file["points"][()]
        del file["points"]
        (tmp_path / "raw").write_bytes(points.tobytes())
        with h5py.File(tmp_path / "other.h5", "w") as other:
            other["points"] = points
        if how == "link":
            file["points"] = h5py.ExternalLink("other.h5", "/points")
        elif how == "nested link":
            file.create_group("a")["points"] = h5py.ExternalLink("other.h5", "/points")
            file["points"] = h5py.SoftLink("/a/points")
        elif how == "external":
            raw = [(str(tmp_path / "raw"), 0, points.nbytes)]
            file.create_dataset("points", points.shape, points.dtype, external=raw)
        else:
            layout = h5py.VirtualLayout(points.shape, points.dtype)
            layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "points", points.shape)
            file.create_virtual_dataset("points", layout)
    refused(path, "lies in another file: write all of it into one HDF5 file")
    med = tmp_path / "part.med"
    (tmp_path / "data.h5").rename(med)
    refused(med, "lies in another file: write all of it into one HDF5 file")


@pytest.mark.parametrize(
    ("keyword", "heading"),  # what has no asterisk in front is text of the heading
    [
        *((each, False) for each in ("*INCLUDE", "*IN*CLUDE", "*\u0131nclude", " *INCLUDE", "*Include")),
        *((each, True) for each in ("INCLUDE", "\u00a0*include")),
    ],
)
def test_abaqus_includes_no_file(places: tuple[Path, Path], keyword: str, heading: bool) -> None:
    folder, outside = places
    mesh = by_meshio(folder, "a.inp", "abaqus")
    outside.with_suffix(".inp").write_bytes(mesh)
    path = folder / "part.inp"
    path.write_bytes(f"*HEADING\n{keyword}, INPUT=../secret.inp\n".encode() + mesh)
    if heading:
        assert inertia.mass_properties(inertia.read(path), 1).volume > 0
    else:
        refused(path, "INCLUDE.* is not read: write nodes and elements out in full")


@pytest.mark.parametrize("entity", ["DOCUMENT_FILE", "DOCUMENT_FILE/* */", "DCMFL", "document_file"])
def test_step_reads_no_other_file(places: tuple[Path, Path], entity: str) -> None:
    pytest.importorskip("OCP")
    folder, outside = places
    text = step_solid(CORNERS, QUADS, "box")
    outside.write_text("no part")
    definition = next(line for line in text.splitlines() if "PRODUCT_DEFINITION(" in line).split()[0].split("=")[0]
    more = [
        "DOCUMENT_TYPE('geometry')", f"{entity}('{outside}','',$,#9001,'',$)",
        f"APPLIED_DOCUMENT_REFERENCE(#9002,'',({definition}))", "OBJECT_ROLE('mandatory',$)",
        "ROLE_ASSOCIATION(#9004,#9003)", f"EXTERNAL_SOURCE(IDENTIFIER('{outside}'))",
        "IDENTIFICATION_ROLE('external document id and location',$)",
        f"APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('{outside}',#9007,#9006,(#9002))",
        "DOCUMENT_REPRESENTATION_TYPE('digital',#9002)",
    ]  # fmt: skip
    lines = "".join(f"#{9001 + k}={line};\n" for k, line in enumerate(more))
    at = text.rindex("ENDSEC;")
    (folder / "part.step").write_text(text[:at] + lines + text[at:])
    then = (1, 1)
    os.utime(outside, then)
    part = inertia.read(folder / "part.step")
    assert part.triangles.count == len(TRIANGLES)
    assert "1 file that it refers to was left out" in part.notes
    assert outside.stat().st_atime == 1
