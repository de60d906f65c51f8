"""The shipped samples: their bytes, their shapes, and the exact answers of the stored meshes."""

import subprocess
import sys
from collections import Counter

import numpy as np
import pytest

import inertia_meshes
from inertia_meshes.rational import Moments, moments

SAMPLES = inertia_meshes.catalogue()
MESHES = [name for name in SAMPLES if "mesh" in SAMPLES[name] and not name.endswith(".vtk")]
GOOD = [name for name in MESHES if not name.startswith("broken/")]


def read_binary(name: str) -> np.ndarray:
    data = inertia_meshes.path(name).read_bytes()
    records = np.frombuffer(data, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")], offset=84)
    assert len(records) == int.from_bytes(data[80:84], "little")
    return records["corners"].astype(np.float64)


def read_ascii(name: str) -> np.ndarray:
    words = [line.split() for line in inertia_meshes.path(name).read_text().splitlines()]
    return np.array([line[1:] for line in words if line[0] == "vertex"], np.float64).reshape(-1, 3, 3)


def read_objects(name: str) -> dict[str, np.ndarray]:
    vertices, faces = [], {}
    for line in inertia_meshes.path(name).read_text().splitlines():
        key, *words = line.split()
        if key == "o":
            current = faces.setdefault(words[0], [])
        elif key == "v":
            vertices.append([float(word) for word in words])
        elif key == "f":
            current.append([int(word) - 1 for word in words])
    return {body: np.array(vertices)[np.array(index)] for body, index in faces.items()}


def read(name: str) -> np.ndarray:
    if name.endswith(".obj"):
        return np.concatenate([*read_objects(name).values()])
    return read_ascii(name) if "ascii" in name else read_binary(name)


def directed_edges(corners: np.ndarray) -> dict[tuple, list[int]]:
    edges: dict[tuple, list[int]] = {}
    for face, triangle in enumerate(corners.tolist()):
        points = [tuple(point) for point in triangle]
        for start, end in zip(points, points[1:] + points[:1], strict=True):
            edges.setdefault((start, end), []).append(face)
    return edges


def open_edges(corners: np.ndarray) -> int:
    surplus = Counter({edge: len(faces) for edge, faces in directed_edges(corners).items()})
    return sum(abs(count - surplus[edge[::-1]]) for edge, count in surplus.items())


def answers(computed: Moments) -> dict:
    return {
        "volume": float(computed.volume),
        "center_of_mass": [float(x) for x in computed.center_of_mass],
        "inertia": [[float(x) for x in row] for row in computed.inertia],
    }


def test_the_make_command_writes_the_shipped_bytes(tmp_path) -> None:
    subprocess.run([sys.executable, "-m", "inertia_meshes.make", str(tmp_path)], check=True)
    made = {str(file.relative_to(tmp_path).as_posix()) for file in tmp_path.rglob("*") if file.is_file()}
    assert made == {*SAMPLES, "catalogue.json"}
    shipped = inertia_meshes.path("cube.stl").parent
    assert [name for name in made if (shipped / name).read_bytes() != (tmp_path / name).read_bytes()] == []


def test_every_sample_is_small() -> None:
    assert max(inertia_meshes.path(name).stat().st_size for name in SAMPLES) < 300_000


def test_an_unknown_sample_is_refused_with_near_names() -> None:
    with pytest.raises(KeyError, match=r"no sample part 't_handel\.stl': did you mean t_handle\.stl"):
        inertia_meshes.path("t_handel.stl")


def test_importing_the_samples_imports_neither_numpy_nor_inertia() -> None:
    code = "import inertia_meshes, sys; inertia_meshes.names(); print({'numpy', 'inertia'} & {*sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "set()"


@pytest.mark.parametrize("name", MESHES)
def test_the_catalogue_gives_the_exact_answers_of_the_stored_mesh(name: str) -> None:
    corners = read(name)
    assert len(corners) == SAMPLES[name]["triangles"]
    assert answers(moments(corners)) == SAMPLES[name]["mesh"]


def test_the_parts_of_the_impeller_shaft_have_their_own_exact_answers() -> None:
    parts = SAMPLES["shaft_impeller.obj"]["parts"]
    objects = read_objects("shaft_impeller.obj")
    assert {name: answers(moments(corners)) for name, corners in objects.items()} == {
        name: part["mesh"] for name, part in parts.items()
    }


@pytest.mark.parametrize("name", GOOD)
def test_good_samples_are_closed_and_face_outwards(name: str) -> None:
    assert open_edges(read(name)) == 0
    assert SAMPLES[name]["mesh"]["volume"] > 0


@pytest.mark.parametrize("name", GOOD)
def test_no_triangle_is_folded_back_onto_its_neighbour(name: str) -> None:
    corners = read(name)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    edges = directed_edges(corners)
    assert min(normals[faces[0]] @ normals[edges[edge[::-1]][0]] for edge, faces in edges.items()) > -0.9


@pytest.mark.parametrize("name", GOOD)
def test_the_bodies_are_the_pieces_of_surface_that_hang_together(name: str) -> None:
    corners = read(name)
    label = list(range(len(corners)))

    def root(face: int) -> int:
        while label[face] != face:
            label[face] = label[label[face]]
            face = label[face]
        return face

    edges = directed_edges(corners)
    for edge, faces in edges.items():
        label[root(faces[0])] = root(edges[edge[::-1]][0])
    shells = len({root(face) for face in range(len(corners))})
    cavities = 1 if name in ("hollow_sphere.stl", "sphere_cavity.stl") else 0
    assert shells - cavities == SAMPLES[name]["bodies"]


@pytest.mark.parametrize("name", GOOD)
def test_true_solid_and_mesh_agree_within_the_tessellation(name: str) -> None:
    true, mesh = SAMPLES[name]["closed_form"], SAMPLES[name]["mesh"]
    assert mesh["volume"] * 1e-9 == pytest.approx(true["volume"], rel=0.01)
    size = true["volume"] ** (1 / 3)
    assert np.array(mesh["center_of_mass"]) * 1e-3 == pytest.approx(true["center_of_mass"], abs=1e-3 * size)
    inertia = np.array(true["inertia"])
    assert np.array(mesh["inertia"]) * 1e-15 == pytest.approx(inertia, abs=0.015 * np.trace(inertia))


def test_the_impeller_fits_its_shaft_without_overlap() -> None:
    bodies = {name: corners.reshape(-1, 3) for name, corners in read_objects("shaft_impeller.obj").items()}
    seat = {
        name: {(x, y) for x, y, _ in points.tolist() if 7.9 < np.hypot(x, y) < 8.1} for name, points in bodies.items()
    }
    assert seat["shaft"] == seat["impeller"]
    assert np.hypot(*bodies["impeller"].T[:2]).min() > 7.9
    assert bodies["impeller"][:, 2].min() == 70
    beyond = bodies["shaft"][bodies["shaft"][:, 2] > 70]
    assert np.hypot(*beyond.T[:2]).max() < 8.1


def test_the_bar_has_two_regions_of_hexahedra() -> None:
    text = inertia_meshes.path("two_region_bar.vtk").read_text()
    points = np.array(text.split("POINTS 20 double\n")[1].split("CELLS")[0].split(), float).reshape(-1, 3)
    cells = np.array(text.split("CELLS 4 36\n")[1].split("CELL_TYPES")[0].split(), int).reshape(-1, 9)
    regions = text.split("LOOKUP_TABLE default\n")[1].split()
    volume = {"1": 0.0, "2": 0.0}
    for cell, region in zip(points[cells[:, 1:]], regions, strict=True):
        edges = cell[[1, 3, 4]] - cell[0]  # VTK: 1, 3 and 4 are the neighbours of 0, right-handed
        volume[region] += np.linalg.det(edges)
    parts = SAMPLES["two_region_bar.vtk"]["parts"]
    assert volume == pytest.approx({name: part["mesh"]["volume"] for name, part in parts.items()})


@pytest.mark.parametrize(
    ("name", "open_count", "volume"),
    [
        ("missing_face", 3, None),
        ("flipped_face", 6, None),
        ("inside_out", 0, -1000),
        ("zero_volume", 0, 0),
        ("overlapping_cubes", 0, 2),
    ],
)
def test_broken_samples_are_broken_as_described(name: str, open_count: int, volume: int | None) -> None:
    corners = read_binary(f"broken/{name}.stl")
    assert SAMPLES[f"broken/{name}.stl"]["wrong"]
    assert open_edges(corners) == open_count
    assert volume is None or moments(corners).volume == volume


def test_one_coordinate_of_the_nan_sample_is_not_a_number() -> None:
    assert np.isnan(read_binary("broken/nan.stl")).sum() == 1


def test_the_truncated_sample_ends_within_a_record() -> None:
    data = inertia_meshes.path("broken/truncated.stl").read_bytes()
    whole, rest = divmod(len(data) - 84, 50)
    assert whole < int.from_bytes(data[80:84], "little") == 12
    assert rest > 0
