"""Parts that take more memory than is allowed: the same answers and refusals, piece by piece."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.mesh.solids import as_ply, cube, facets, joined, ring, sphere

import inertia
from inertia.errors import GeometryError, ReadError, UsageError
from inertia.mesh.external.memory import RESERVE, WHOLE
from inertia.mesh.part import Part, Source
from inertia.mesh.surface import FacesInFile, Facets, Surface
from inertia_cli.main import main
from inertia_meshes import path

MEMORY = 4e9
"""What the tests' process stays below; that no part fits is said by `nothing_fits`."""


@pytest.fixture
def nothing_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inertia.mesh.external.memory.WHOLE", 10**12)


def stored(surface: Surface, shuffled: bool = True) -> Part:
    records = facets(surface).records
    if shuffled:
        records = records[np.random.default_rng(0).permutation(len(records))]
    return Part(Facets(records), source=Source(None, "stl"))


def turned(mesh: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    return mesh[0], mesh[1][:, ::-1]


def flattened(mesh: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    return mesh[0] * [1, 1, 1e-20], mesh[1]


SOUND = {
    "one body": lambda: joined(ring(60, 50)),
    "two bodies apart": lambda: joined(ring(60, 50), sphere((9, 9, 9))),
    "a cavity": lambda: joined(sphere((0, 0, 0), 5), turned(sphere((0, 0, 0), 2))),
    "a body in a ring's box": lambda: joined(ring(60, 50), sphere((0, 0, 0), 0.5)),
    "bodies in cavities": lambda: joined(
        sphere((0, 0, 0), 9), turned(sphere((0, 0, 0), 6)), sphere((0, 0, 0), 3), turned(sphere((0, 0, 0), 1))
    ),
}
RESULTS: list[dict[str, Any]] = [
    {},
    {"accuracy": 1e-14},
    {"accuracy": "exact"},
    {"density": inertia.Estimate(7850, 50)},
]


@pytest.mark.usefixtures("nothing_fits")
@pytest.mark.parametrize("options", RESULTS, ids=str)
@pytest.mark.parametrize("make", SOUND.values(), ids=SOUND)
def test_the_answer_has_the_same_bits(make: Callable[[], Surface], options: dict[str, Any]) -> None:
    part = stored(make())
    whole, external = inertia.analyse(part, **options), inertia.analyse(part, memory=MEMORY, **options)
    for name in ("volume", "mass", "center_of_mass", "inertia"):
        assert np.array_equal(getattr(external.properties, name), getattr(whole.properties, name)), name
    assert external.properties.error == whole.properties.error
    assert (external.closed, external.bodies, external.triangles) == (True, whole.bodies, whole.triangles)
    assert (external.area, external.extents.tolist()) == (whole.area, whole.extents.tolist())
    assert not external.crossings_examined
    assert "triangles that cross were not looked for" in external.notes[-1]


@pytest.mark.usefixtures("nothing_fits")
def test_an_open_shell_has_the_same_bits() -> None:
    part = stored(joined((ring()[0], ring()[1][:-7])))
    whole, external = inertia.analyse(part, shell=0.1), inertia.analyse(part, shell=0.1, memory=MEMORY)
    assert np.array_equal(external.properties.inertia, whole.properties.inertia)
    assert (external.closed, external.bodies) == (False, 1)


BROKEN = {
    "a hole": lambda: joined((ring()[0], ring()[1][:-1])),
    "holes": lambda: joined((ring()[0], np.delete(ring()[1], [3, 4, 5, 200, 300], axis=0))),
    "one turned": lambda: joined((ring()[0], np.concatenate([ring()[1][:1, ::-1], ring()[1][1:]]))),
    "a copy": lambda: joined((ring()[0], np.concatenate([ring()[1], ring()[1][7:8]]))),
    "a fin": lambda: joined(ring(), (np.array([*ring()[0][:2], [0, 0, 9]]), np.array([[0, 1, 2]]))),
    "inward": lambda: joined(turned(ring())),
    "one inward": lambda: joined(ring(), turned(sphere((9, 9, 9)))),
    "both inward": lambda: joined(turned(ring()), turned(sphere((9, 9, 9)))),
    "one inward on others": lambda: joined(cube(), turned(cube((0, 0, 1))), cube((0, 0, 2))),
    "one in another": lambda: joined(sphere((0, 0, 0), 5), sphere((0, 0, 0), 2)),
    "a sheet of two sides": lambda: joined(ring(), turned(ring())),
    "two such sheets": lambda: joined(ring(), turned(ring()), sphere((9, 9, 9), 2.5), turned(sphere((9, 9, 9), 2.5))),
    "next to no volume, inward": lambda: joined(turned(flattened(sphere()))),
    "not a number": lambda: joined((np.where(ring()[0] == ring()[0][5], np.nan, ring()[0]), ring()[1])),
}


@pytest.mark.usefixtures("nothing_fits")
@pytest.mark.parametrize("make", BROKEN.values(), ids=BROKEN)
def test_what_is_refused_is_refused_in_the_same_words(make: Callable[[], Surface]) -> None:
    part = stored(make(), shuffled=False)
    with pytest.raises(GeometryError) as external:
        inertia.analyse(part, memory=MEMORY)
    with pytest.raises(GeometryError) as whole:
        inertia.analyse(part)
    said = str(external.value).partition(" (inertia.check")[0].partition("; ")[0]
    assert str(whole.value).startswith(said)


@pytest.mark.usefixtures("nothing_fits")
@pytest.mark.parametrize(
    ("fault", "remedies"),
    [
        ("a hole", "inertia.repair(part) takes"),
        ("one turned", "inertia.repair(part) takes"),
        ("inward", "orientation='absolute' takes"),
        ("one in another", "union=True and orientation='absolute' take"),
    ],
)
def test_a_remedy_that_takes_the_whole_part_is_said_to(fault: str, remedies: str) -> None:
    with pytest.raises(GeometryError) as external:
        inertia.analyse(stored(BROKEN[fault](), shuffled=False), memory=MEMORY)
    behind = str(external.value).partition("; ")[2]
    assert re.fullmatch(
        rf"{re.escape(remedies)} the whole part in memory: allow [\d.e+]+ [MG]B by memory=BYTES", behind
    )
    assert len(external.value.remedies) == len(set(external.value.remedies))


def test_memory_that_is_enough_for_a_repair_is_enough_for_what_follows(monkeypatch: pytest.MonkeyPatch) -> None:
    repair, repaired = inertia.repair, []

    def repairing(part: Part, *_: object, **_named: object) -> Any:
        repaired.append(part)
        return repair(part)

    monkeypatch.setattr("inertia.mass.repair.repair", repairing)
    monkeypatch.setattr("inertia.mesh.external.memory.resident", lambda: 1e12 if repaired else 1e8)
    assert main(["analyse", str(path("broken/missing_face.stl")), "--repair", "--memory", "1GB"]) == 0
    assert repaired


SOUP = np.random.default_rng(2).normal(size=(69_000, 3)), np.arange(69_000).reshape(-1, 3)
MANY = {
    "open": ("open: 69000 edges of one triangle alone, too many to be looked at", lambda: joined(SOUP)),
    "inconsistent_winding": (
        "inconsistent winding: the two triangles run the same way at 90182 edges, too many",
        lambda: joined(_half_turned(ring(300, 200))),
    ),
}


def _half_turned(mesh: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = mesh
    turn = np.random.default_rng(0).integers(0, 2, len(faces)) == 1
    return vertices, np.where(turn[:, None], faces[:, ::-1], faces)


@pytest.fixture
def small_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """However much the tests before took: a share of it comes on top of the least memory that is asked for."""
    for module in ("inertia.mesh.external.memory", "inertia.mass.external"):
        monkeypatch.setattr(f"{module}.resident", lambda: 100_000_000)


def _in_little(part: Part) -> float:
    """Return the least memory in which a part is paired, in which few irregular edges are looked at."""
    with pytest.raises(UsageError, match="allow at least") as least:
        inertia.analyse(part, memory=1e6)
    size, unit = str(least.value).partition("at least ")[2].split()[:2]
    return float(size) * {"MB": 1e6, "GB": 1e9}[unit]


@pytest.mark.usefixtures("nothing_fits", "small_process")
@pytest.mark.parametrize("code", MANY)
def test_edges_at_fault_that_are_too_many_to_be_looked_at_are_told_apart(code: str) -> None:
    said, make = MANY[code]
    part = stored(make())
    sentences = set()
    for _ in range(2):  # the keys of the edges differ
        with pytest.raises(GeometryError) as fault:
            inertia.analyse(part, memory=_in_little(part))
        sentences.add(str(fault.value))
        assert fault.value.code == code
    assert len(sentences) == 1
    assert said in sentences.pop()


@pytest.mark.usefixtures("nothing_fits", "small_process")
def test_an_open_shell_needs_none_of_its_edges_looked_at() -> None:
    part = stored(joined(SOUP))
    assert inertia.analyse(part, shell=0.1, memory=_in_little(part)).bodies == 23_000


@pytest.mark.usefixtures("small_process")
@pytest.mark.parametrize("at_once", [False, True])
def test_edges_of_four_triangles_that_are_too_many_are_refused_with_the_memory_that_is_enough(
    at_once: bool, request: pytest.FixtureRequest
) -> None:
    if not at_once:
        request.getfixturevalue("nothing_fits")
    cubes = [cube(at) for at in np.ndindex(20, 20, 20) if sum(at) % 2 == 0]
    part = stored(joined(*cubes))
    little = _in_little(part)
    with pytest.raises(UsageError, match=r"edges of more than two triangles which .*: allow [\d.]+ [MG]B by") as fault:
        inertia.analyse(part, memory=little)
    size, unit = str(fault.value).partition("allow ")[2].split()[:2]
    enough = float(size) * {"MB": 1e6, "GB": 1e9}[unit]
    assert (enough < little + WHOLE * part.triangles.count) == at_once  # less than piece by piece
    analysis = inertia.analyse(part, memory=enough)
    assert (analysis.bodies, analysis.properties.volume) == (len(cubes), pytest.approx(1e-9 * len(cubes)))


@pytest.mark.usefixtures("nothing_fits")
def test_edges_of_four_triangles_are_named_as_what_was_not_looked_at() -> None:
    part = stored(joined(cube(), cube((1, 1, 0))))
    analysis = inertia.analyse(part, memory=MEMORY)
    assert (analysis.bodies, analysis.properties.volume) == (2, pytest.approx(2e-9))
    assert "nor whether material lies on material at 1 edge of more than two triangles" in analysis.notes[-1]


REFUSED: dict[str, dict[str, Any]] = {
    "a search for crossings": {"intersections": True},
    "a union": {"union": True},
    "separate bodies": {"parts": "separate"},
    "an absolute orientation": {"orientation": "absolute"},
    "an allowance for faults": {"allow_faults": 0.01},
    "a chord tolerance": {"chord": 0.1},
    "the uncertainty of each vertex": {"sigma": 0.1},
    "densities by name": {"density": {"1": 7850.0}},
}


@pytest.mark.usefixtures("nothing_fits")
@pytest.mark.parametrize("what", REFUSED)
def test_what_takes_the_whole_part_in_memory_is_refused(what: str) -> None:
    with pytest.raises(UsageError, match=rf"and {what} cannot be had otherwise: .* much by memory=BYTES"):
        inertia.analyse(stored(joined(ring())), memory=MEMORY, **REFUSED[what])


@pytest.mark.usefixtures("nothing_fits")
def test_other_formats_are_refused() -> None:
    vertices, faces = ring()
    with pytest.raises(UsageError, match="is no binary STL file, nor a binary PLY file of triangles alone"):
        inertia.analyse(Part.from_arrays(vertices, faces), memory=MEMORY)


def test_a_part_that_fits_is_analysed_as_ever() -> None:
    part = stored(joined(ring()))
    analysis = inertia.analyse(part, memory=MEMORY)
    assert analysis.crossings_examined
    assert analysis.notes == ()


@pytest.mark.usefixtures("nothing_fits")
@pytest.mark.parametrize("native", ["1", "0"])
@pytest.mark.parametrize(("kind", "order"), [("float", "little"), ("double", "big")])
def test_a_binary_ply_file_has_the_same_bits(
    kind: str, order: str, native: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("INERTIA_NATIVE", native)
    solid = joined(ring(60, 50), sphere((9, 9, 9)))
    file = as_ply(tmp_path / "two.ply", solid.vertices, solid.faces[::-1], kind, order)
    part = inertia.read(file, memory=MEMORY)
    assert isinstance(part.geometry, FacesInFile)
    whole, external = inertia.analyse(inertia.read(file)), inertia.analyse(part, memory=MEMORY)
    for name in ("volume", "mass", "center_of_mass", "inertia"):
        assert np.array_equal(getattr(external.properties, name), getattr(whole.properties, name)), name
    assert external.properties.error == whole.properties.error
    assert (external.closed, external.bodies, external.area) == (True, 2, whole.area)
    assert inertia.analyse(part).properties.volume == whole.properties.volume  # read at once after all


@pytest.mark.usefixtures("nothing_fits")
def test_an_open_binary_ply_file_is_refused_in_the_same_words(tmp_path: Path) -> None:
    vertices, faces = ring()
    file = as_ply(tmp_path / "open.ply", vertices, faces[5:])
    with pytest.raises(GeometryError) as external:
        inertia.analyse(inertia.read(file, memory=MEMORY), memory=MEMORY)
    with pytest.raises(GeometryError) as whole:
        inertia.analyse(inertia.read(file))
    assert str(whole.value).startswith(str(external.value).partition("; ")[0])


@pytest.mark.usefixtures("nothing_fits")
def test_a_face_of_a_ply_file_that_names_no_vertex_is_refused(tmp_path: Path) -> None:
    vertices, faces = ring()
    faces = faces.copy()
    faces[77, 1] = len(vertices)
    part = inertia.read(as_ply(tmp_path / "beyond.ply", vertices, faces), memory=MEMORY)
    with pytest.raises(ReadError, match=rf"face 77 names vertex {len(vertices)}, .* export the mesh") as beyond:
        inertia.analyse(part, memory=MEMORY)
    assert beyond.value.code == "node_out_of_range"


@pytest.mark.usefixtures("nothing_fits")
@pytest.mark.parametrize("used", [True, False])
def test_a_vertex_of_a_ply_file_that_is_not_finite_is_refused_whoever_uses_it(used: bool, tmp_path: Path) -> None:
    vertices, faces = ring()
    vertices = np.concatenate([vertices, [[np.nan, 0, 0]]])
    if used:
        vertices[5, 1] = np.inf
    file = as_ply(tmp_path / "odd.ply", vertices, faces)
    for memory in (None, MEMORY):
        with pytest.raises(ReadError, match=rf"vertex {5 if used else len(vertices) - 1}.* not finite") as odd:
            inertia.read(file, memory=memory)
        assert odd.value.code == "non_finite"


@pytest.mark.usefixtures("nothing_fits")
def test_line_ends_may_follow_the_rows_of_a_ply_file(tmp_path: Path) -> None:
    file = as_ply(tmp_path / "ring.ply", *ring())
    stored_in = inertia.analyse(inertia.read(file, memory=MEMORY), memory=MEMORY)
    file.write_bytes(file.read_bytes() + b"\r\n")
    part = inertia.read(file, memory=MEMORY)
    assert isinstance(part.geometry, FacesInFile)
    assert inertia.analyse(part, memory=MEMORY).properties.volume == stored_in.properties.volume


def test_what_was_read_whole_is_analysed_so_within_the_same_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process has grown since it was read: by the arrays, and by what is imported meanwhile."""
    vertices, faces = ring()
    file, before = as_ply(tmp_path / "ring.ply", vertices, faces), 1e8
    memory = WHOLE * len(faces) + RESERVE + before
    monkeypatch.setattr("inertia.mesh.external.memory.resident", lambda: before)
    assert isinstance(inertia.read(file, memory=memory - 1).geometry, FacesInFile)
    part = inertia.read(file, memory=memory)
    assert not isinstance(part.geometry, FacesInFile)
    monkeypatch.setattr("inertia.mesh.external.memory.resident", lambda: before + 2e7)
    assert inertia.analyse(part, memory=memory).crossings_examined


@pytest.mark.parametrize("memory", [-1, float("nan"), True, "2GB"])
def test_no_limit_of_memory_is_refused_where_a_file_is_read(memory: Any) -> None:
    with pytest.raises(UsageError, match="it must be positive and finite, in bytes"):
        inertia.read(path("t_handle.stl"), memory=memory)


@pytest.mark.usefixtures("nothing_fits")
def test_other_polygons_of_a_ply_file_are_refused(tmp_path: Path) -> None:
    vertices, _ = cube()
    quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
    part = inertia.read(as_ply(tmp_path / "quads.ply", vertices, quads), memory=MEMORY)
    with pytest.raises(UsageError, match="is no binary STL file, nor a binary PLY file of triangles alone"):
        inertia.analyse(part, memory=MEMORY)


def test_a_volume_mesh_that_fits_is_analysed_as_ever() -> None:
    part = inertia.read(path("two_region_bar.vtk"))
    assert inertia.analyse(part, memory=MEMORY).properties.mass == inertia.analyse(part).properties.mass


def test_the_command_refuses_to_mend_what_does_not_fit(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", str(path("t_handle.stl")), "--repair", "--memory", "1MB"]) == 2
    assert "beyond 1 MB, and a repair cannot be had otherwise: leave that out" in capsys.readouterr().err
    assert main(["analyse", str(path("t_handle.stl")), "--weld", "0.1", "--dask", "local"]) == 2
    assert "a repair cannot be had from Dask workers" in capsys.readouterr().err


def test_too_little_memory_is_refused_with_what_is_enough() -> None:
    with pytest.raises(
        UsageError, match=r"cannot be checked within 1 MB of memory: allow at least [\d.]+ [MG]B by memory"
    ):
        inertia.analyse(stored(joined(ring(200, 200))), memory=1e6)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is measured as Linux counts it")
def test_the_command_stays_below_the_limit(tmp_path: Path) -> None:
    """Two million triangles in an order that leaves half of all edges waiting take 165 MB at once."""
    file, limit = tmp_path / "ring.stl", 120
    records = stored(joined(ring(1000, 1000))).triangles.records  # type: ignore[union-attr]
    file.write_bytes(bytes(80) + np.uint32(len(records)).tobytes() + records.tobytes())
    program = (
        "import pathlib, re, sys\nfrom inertia_cli.main import main\ncode = main(sys.argv[1:])\n"
        "print(code, *re.findall(r'VmHWM:\\s*(\\d+) kB', pathlib.Path('/proc/self/status').read_text()))"
    )
    command = [sys.executable, "-c", program, "analyse", str(file), "--memory", f"{limit}MB"]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "2000000 triangles, closed, 1 body, crossings not examined" in output
    code, peak = output.splitlines()[-1].split()
    assert code == "0"
    assert 1024 * int(peak) < limit * 1_000_000
