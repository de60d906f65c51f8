"""MuJoCo's own meshes."""

from pathlib import Path

import numpy as np
import pytest
from tests.exchange import solid

import inertia
from inertia_meshes import path


def write(file: Path, vertices: np.ndarray, faces: np.ndarray, normals: int = 0, textures: int = 0) -> Path:
    counts = np.array([len(vertices), normals, textures, len(faces)], "<i4")
    rest = np.zeros(3 * normals + 2 * textures, "<f4")
    file.write_bytes(b"".join(np.ascontiguousarray(k).tobytes() for k in (
        counts, vertices.astype("<f4"), rest, faces.astype("<i4"),
    )))  # fmt: skip
    return file


@pytest.mark.parametrize(("normals", "textures"), [(0, 0), (4, 0), (0, 4), (4, 4)])
def test_vertices_and_faces_are_read_whatever_lies_between(tmp_path: Path, normals: int, textures: int) -> None:
    vertices, faces = np.array(solid.CORNERS), np.array(solid.FACES) - 1
    part = inertia.read(write(tmp_path / "arm.msh", vertices, faces, normals, textures), unit="m")
    assert part.source.format == "mujoco"
    assert np.array_equal(part.triangles.corners(), vertices.astype("<f4").astype(float)[faces])
    assert solid.error(inertia.mass_properties(part, solid.DENSITY).inertia) < 1e-6


def test_mujoco_reads_the_same(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    file = write(tmp_path / "arm.msh", np.array(solid.CORNERS), np.array(solid.FACES) - 1)
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="arm" file="{file}" inertia="exact"/></asset><worldbody><body><freejoint/>'
        f'<geom type="mesh" mesh="arm" density="{solid.DENSITY}"/></body></worldbody></mujoco>'
    )
    ours = inertia.mass_properties(inertia.read(file, unit="m"), solid.DENSITY)
    assert model.body_mass[1] == pytest.approx(ours.mass, rel=1e-9)
    assert sorted(model.body_inertia[1]) == pytest.approx(ours.principal_moments.tolist(), rel=1e-9)


def test_gmsh_stays_gmsh(tmp_path: Path) -> None:
    file = tmp_path / "part.msh"
    file.write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
    with pytest.raises(inertia.ReadError) as fault:
        inertia.read(file)
    assert "counts" not in str(fault.value)


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("part.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n0\n$ENDELM\n", "it is MSH 1, but 2.2 and 4.1 are read"),
        ("part.dat", "$NOD\n0\n$ENDNOD\n", "it is MSH 1, but 2.2 and 4.1 are read"),
        ("part.msh", "something else\n", "it has no section .MeshFormat: it is no MSH file of Gmsh, or was cut short"),
        ("part.msh", "$MeshFormat\nx\n", "its .MeshFormat section is damaged"),
    ],
)
def test_msh_of_another_version_is_called_so(name: str, text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(inertia.ReadError, match=says):
        inertia.read(tmp_path / name)


@pytest.mark.parametrize("change", [-1, 1])
def test_a_file_of_another_length_is_refused(tmp_path: Path, change: int) -> None:
    file = write(tmp_path / "arm.msh", np.array(solid.CORNERS), np.array(solid.FACES) - 1)
    data = file.read_bytes()
    file.write_bytes(data[:change] if change < 0 else data + b"\0")
    with pytest.raises(inertia.ReadError, match="its size is not what its counts"):
        inertia.read(file, format="mujoco")


def test_a_face_beyond_the_vertices_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path / "arm.msh", np.array(solid.CORNERS), np.array(solid.FACES))
    with pytest.raises(inertia.ReadError, match="names vertex 4"):
        inertia.read(file)


def test_binary_stl_is_known_first() -> None:
    assert inertia.read(path("cube.stl")).source.format == "stl"
