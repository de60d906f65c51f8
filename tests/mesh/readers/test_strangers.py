"""What is no mesh is called by its name, whatever it is named."""

from pathlib import Path

import pytest
from tests.mesh.readers.samples import volumes
from tests.mesh.readers.test_errors import refused

STRANGERS = {
    "LFS pointer": (b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n", "run `git lfs pull`"),
    "HTML page": (b"<!DOCTYPE html>\n<html><head><title>404</title>", "it is an HTML page: download the file itself"),
    "XHTML page": (b'<?xml version="1.0"?>\n<!-- x -->\n<html xmlns="http://www.w3.org/1999/xhtml">', "an HTML page"),
    "PDF": (b"%PDF-1.7\n%\xe2\xe3", "a PDF document: export the part"),
    "PNG": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "a picture"),
    "JPEG": (b"\xff\xd8\xff\xe0\0\x10JFIF", "a picture"),
    "ELF": (b"\x7fELF\x02\x01\x01" + bytes(90), "a program"),
    "OLE": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), "SolidWorks, Inventor"),
    "IGES": (b"comment".ljust(72) + b"S      1\n", "an IGES file"),
    "DXF": (b"  0\nSECTION\n  2\nHEADER\n", "a DXF drawing"),
    "Fluent": (b'(1 "made")\n(2 3)\n(10 (0 1 1b 0))\n', "a mesh of Fluent: export the mesh as Gmsh, VTU or MED"),
    "Fluent without a comment": (b"(2 3)\n(10 (0 1 1b 0))\n", "a mesh of Fluent"),
    "AMF": (b'<amf unit="inch"><object>', "an AMF file"),
    "AMF with comments": (b'<?xml version="1.0"?>' + b"<!-- x -->" * 60 + b"\n<amf>", "an AMF file"),
    "7z": (b"7z\xbc\xaf\x27\x1c\0\4", "a 7-Zip archive: unpack it"),
    "zstd": (b"\x28\xb5\x2f\xfd\x04\x00", "a file compressed by Zstandard"),
    "UTF-16": ("solid x\n".encode("utf-16"), "text in UTF-16: save it as UTF-8"),
    "zeros": (bytes(5000), "a file of zeros"),
    "recording": (b"RRF2\0\0", "a recording of Rerun"),
}


@pytest.mark.parametrize("name", ["a.stl", "a.bdf", "a.step", "a.3mf", "a.vtu", "a.msh", "a"])
@pytest.mark.parametrize("kind", STRANGERS)
def test_what_is_no_mesh_is_called_by_its_name(kind: str, name: str, tmp_path: Path) -> None:
    data, says = STRANGERS[kind]
    (tmp_path / name).write_bytes(data)
    message = refused(tmp_path / name, says)
    assert "BEGIN BULK" not in message
    assert "cut short" not in message


@pytest.mark.parametrize("format", ["stl", "obj", "off", "gltf", "abaqus", "3mf"])
@pytest.mark.parametrize("kind", STRANGERS)
def test_what_is_no_mesh_is_called_by_its_name_where_a_format_is_given(kind: str, format: str, tmp_path: Path) -> None:
    data, says = STRANGERS[kind]
    (tmp_path / "a").write_bytes(data)
    refused(tmp_path / "a", says, format=format)


def test_msh_4_0_is_called_by_its_name(tmp_path: Path) -> None:
    name, data = volumes(tmp_path)["gmsh 4.1"]
    (tmp_path / name).write_bytes(data.replace(b"4.1 0 8", b"4 0 8"))
    refused(tmp_path / name, "it is MSH '4.0', but 2.2 and 4.1 are read: save it as one of these")
