"""Text that begins with a byte order mark, as editors of Windows write it, is read as if it had none."""

from codecs import BOM_UTF8
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import surfaces, volumes
from tests.mesh.readers.step_sample import step_sphere
from tests.mesh.readers.test_errors import refused

import inertia
from inertia_cli.main import main

TEXT = ["stl text", "obj", "off", "ply text", "ply little", "gltf", "dae", "xaml"]
CELLS = [
    "gmsh 2.2",
    "gmsh 4.1",
    "nastran",
    "abaqus",
    "vtk text",
    "vtu text",
    "xdmf",
    "medit",
    "netgen",
    "su2",
    "avsucd",
]


@pytest.mark.parametrize("kind", [*TEXT, *CELLS])
def test_a_byte_order_mark_is_passed_over(kind: str, tmp_path: Path) -> None:
    name, data = {**surfaces(), **volumes(tmp_path)}[kind]
    plain, marked = tmp_path / f"plain-{name}", tmp_path / f"marked-{name}"
    plain.write_bytes(data)
    marked.write_bytes(BOM_UTF8 + data)
    without, with_mark = (inertia.mass_properties(inertia.read(file, unit="m")) for file in (plain, marked))
    assert with_mark.mass == without.mass
    np.testing.assert_array_equal(with_mark.inertia, without.inertia)
    assert (inertia.read(plain).rounding is None) == (inertia.read(marked).rounding is None)


@pytest.mark.parametrize("kind", ["obj", "off", "ply text", "stl text"])
def test_decimals_behind_a_byte_order_mark_are_read_exactly(kind: str, tmp_path: Path) -> None:
    name, data = surfaces()[kind]
    (tmp_path / name).write_bytes(BOM_UTF8 + data)
    part = inertia.read(tmp_path / name, unit="m")
    assert part.rounding is not None
    assert part.rounding.remainder is not None
    assert 0 < np.abs(part.rounding.remainder()).max() < 1e-16


def test_a_large_ply_file_with_a_byte_order_mark_stays_in_the_file(tmp_path: Path) -> None:
    name, data = surfaces()["ply little"]
    (tmp_path / name).write_bytes(BOM_UTF8 + data)
    part = inertia.read(tmp_path / name, unit="m", memory=1.0)
    analysis = inertia.analyse(part, memory=4e9)  # what the tests' process stays below
    assert analysis.properties.volume == pytest.approx(6.0, rel=1e-6)


def test_step_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    file = tmp_path / "ball.step"
    file.write_text(step_sphere(2.0), encoding="utf-8-sig")
    assert inertia.mass_properties(inertia.read(file)).volume == pytest.approx(32 / 3 * np.pi * 1e-9, rel=1e-9)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("kind", [*TEXT, *CELLS])
def test_utf_16_is_called_so(kind: str, encoding: str, tmp_path: Path) -> None:
    name, data = {**surfaces(), **volumes(tmp_path)}[kind]
    if kind != "ply little":
        (tmp_path / name).write_bytes(data.decode().encode(encoding))
        refused(tmp_path / name, "it is text in UTF-16: save it as UTF-8")
        told = kind.split()[0]
        refused(tmp_path / name, "it is text in UTF-16: save it as UTF-8", format=told)


def test_a_document_with_a_byte_order_mark_is_cited(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name, data = surfaces()["stl text"]
    (tmp_path / name).write_bytes(data)
    main(["analyse", str(tmp_path / name), "--json"])
    (tmp_path / "answer.json").write_text(capsys.readouterr().out, encoding="utf-8-sig")
    assert main(["cite", str(tmp_path / "answer.json")]) == 0
    assert "@" in capsys.readouterr().out
