"""Units in comments are not applied; where another one is assumed, a note quotes the comment."""

from pathlib import Path

import pytest
from tests.mesh.readers.samples import surfaces, volumes

import inertia
from inertia.mesh.readers.comments import commented_unit

LINES = {  # kind of sample, what is replaced in it, and by what; {} is the comment
    "stl text": (b"solid ", b"solid {} "),
    "obj": (b"", b"# {}\n"),
    "ply text": (b"element vertex", b"comment {}\nelement vertex"),
    "ply little": (b"element vertex", b"obj_info {}\nelement vertex"),
    "off": (b"OFF", b"# {}\nOFF"),
    "vtk text": (b"", b""),
    "gmsh 2.2": (b"", b"$Comments\n{}\n$EndComments\n"),
    "nastran": (b"", b"$ {}\n"),
    "abaqus": (b"", b"** {}\n"),
    "su2": (b"", b"% {}\n"),
    "netgen": (b"", b"# {}\n"),
}


def sample(kind: str, comment: str, folder: Path) -> Path:
    name, data = {**surfaces(), **volumes(folder)}[kind]
    if kind == "vtk text":
        lines = data.split(b"\n")
        data = b"\n".join([lines[0], comment.encode(), *lines[2:]])
    else:
        old, new = LINES[kind]
        data = data.replace(old, new.replace(b"{}", comment.encode()), 1)
    (folder / name).write_bytes(data)
    return folder / name


def notes(file: Path, **options: object) -> list[str]:
    return [note for note in inertia.read(file, **options).notes if "comment" in note]


@pytest.mark.parametrize("kind", LINES)
def test_another_unit_is_noted_and_not_applied(kind: str, tmp_path: Path) -> None:
    file = sample(kind, "File units = inches", tmp_path)
    part = inertia.read(file)
    assert (part.unit.name, part.unit_from) == ("mm", "assumed")
    (note,) = notes(file)
    assert "File units = inches" in note
    assert "' names another unit than mm, which is assumed" in note
    assert notes(file, unit="mm") == []
    assert notes(sample(kind, "File units = mm", tmp_path)) == []


def test_the_header_of_a_binary_stl_is_a_comment(tmp_path: Path) -> None:
    name, data = surfaces()["stl"] if "stl" in surfaces() else surfaces()["stl binary"]
    (tmp_path / name).write_bytes(b"made by CAD UNITS=CM".ljust(80, b"\0") + data[80:])
    assert notes(tmp_path / name) == [
        "its comment 'made by CAD UNITS=CM' names another unit than mm, which is assumed, as comments do not count: "
        "state the unit"
    ]


@pytest.mark.parametrize(
    ("comment", "unit"),
    [
        ("units: mm", "mm"),
        ("Units in cm", "cm"),
        ("all units are in inches", "in"),
        ("unit inch", "in"),
        ("units: in", "in"),
        ("1 unit = 1 cm", "cm"),
        ("length_units = 'm'", "m"),
        ("unit of length: ft", "ft"),
        ("UNITS=MILLIMETERS", "mm"),
        ("unit = 0.01 m", None),
        ("unit test of the writer", None),
        ("units of the drive: see the manual", None),
        ("communities: m", None),
        ("exported by a program", None),
    ],
)
def test_what_a_comment_says(comment: str, unit: str | None) -> None:
    said = commented_unit("obj", f"# made here\n# {comment}\nv 0 0 0\n".encode())
    assert (None if said is None else said[0].name) == unit
    assert commented_unit("obj", f"o {comment}\n".encode()) is None


def test_a_name_that_has_the_word_says_nothing() -> None:
    assert commented_unit("stl", b"solid Drive Unit M\n") is None
    assert commented_unit("stl", b"solid bracket units=m\n") is not None
    assert commented_unit("glb", b"units=m") is None


def test_a_comment_in_a_compressed_file_is_noted(tmp_path: Path) -> None:
    import gzip

    file = sample("obj", "File units = feet", tmp_path)
    (tmp_path / "box.obj.gz").write_bytes(gzip.compress(file.read_bytes()))
    assert len(notes(tmp_path / "box.obj.gz")) == 1
