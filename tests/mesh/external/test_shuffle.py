"""A part on the workers of a Dask scheduler: the same bits and words as on one machine, whoever does what."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.mesh.solids import as_ply, facets, joined, ring, sphere

import inertia
from inertia.errors import GeometryError, InertiaError, ReadError, UsageError
from inertia.mesh.external.shuffle import StoredTriangles
from inertia.mesh.surface import Surface
from inertia_meshes import path

distributed = pytest.importorskip("distributed")


def written(path: Path, surface: Surface) -> Path:
    records = facets(surface).records
    records = records[np.random.default_rng(0).permutation(len(records))]
    path.write_bytes(bytes(80) + np.uint32(len(records)).tobytes() + records.tobytes())
    return path


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=":0"
    ) as cluster:
        yield cluster


@pytest.fixture
def in_small_ranges(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inertia.mesh.external.shuffle.RANGE", 1 << 14)
    monkeypatch.setattr("inertia.mesh.external.shuffle.SHARE", 1 << 19)


@pytest.mark.parametrize("length", [1024, 5120, 1 << 20])
def test_any_ranges_give_the_same_bits(
    length: int, cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("inertia.mesh.external.shuffle.RANGE", length)
    part = inertia.read(
        written(tmp_path / "bodies.stl", joined(ring(90, 60), sphere((9, 9, 9)), ring(50, 30, radius=20)))
    )
    whole, shared = inertia.analyse(part), inertia.analyse(part, dask=cluster.scheduler_address)
    for name in ("volume", "mass", "center_of_mass", "inertia"):
        assert np.array_equal(getattr(shared.properties, name), getattr(whole.properties, name)), name
    assert shared.properties.error == whole.properties.error
    assert (shared.area, shared.extents.tolist()) == (whole.area, whole.extents.tolist())
    assert "by the workers of a Dask scheduler" in shared.notes[-1]


@pytest.mark.usefixtures("in_small_ranges")
def test_a_binary_ply_file_has_the_same_bits(cluster: Any, tmp_path: Path) -> None:
    solid = joined(ring(250, 160), sphere((9, 9, 9)))
    file = as_ply(tmp_path / "bodies.ply", solid.vertices, solid.faces)
    shared = inertia.analyse(inertia.read(file, memory=0.0), dask=cluster.scheduler_address)
    whole = inertia.analyse(inertia.read(file))
    assert np.array_equal(shared.properties.inertia, whole.properties.inertia)
    assert (shared.closed, shared.bodies, shared.properties.error) == (True, 2, whole.properties.error)


@pytest.mark.usefixtures("in_small_ranges")
@pytest.mark.parametrize("native", ["1", "0"])
def test_a_hole_is_refused_in_the_same_words(
    native: str, cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("INERTIA_NATIVE", native)
    vertices, faces = ring(250, 160)
    part = inertia.read(written(tmp_path / "ring.stl", joined((vertices, faces[7:]))))
    with pytest.raises(GeometryError) as shared:
        inertia.analyse(part, dask=cluster.scheduler_address)
    with pytest.raises(GeometryError) as whole:
        inertia.analyse(part)
    said, _, takes = str(shared.value).partition("; ")
    assert str(whole.value).startswith(said)
    assert takes == "inertia.repair(part) takes the whole part in memory: leave dask out"
    assert "open: 1 boundary loop" in str(shared.value)


def test_a_scheduler_of_its_own_answers(tmp_path: Path) -> None:
    part = inertia.read(written(tmp_path / "ring.stl", joined(ring())))
    assert inertia.analyse(part, dask="local").properties.volume == inertia.analyse(part).properties.volume


def once(action: Callable[[], None]) -> Callable[[float], None]:
    left = [action]

    def progress(done: float) -> None:
        while left:
            left.pop()()

    return progress


@pytest.mark.usefixtures("in_small_ranges")
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes are killed")
def test_a_worker_that_is_killed_costs_nothing_but_time(tmp_path: Path) -> None:
    part = inertia.read(written(tmp_path / "ring.stl", joined(ring(250, 160))))
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
    ) as cluster:
        first = next(iter(cluster.workers.values()))
        kill = once(lambda: os.kill(first.pid, signal.SIGKILL))
        shared = inertia.analyse(part, dask=cluster.scheduler_address, progress=kill)
    assert np.array_equal(shared.properties.inertia, inertia.analyse(part).properties.inertia)


@pytest.mark.usefixtures("in_small_ranges")
def test_a_scheduler_that_ends_is_said(tmp_path: Path) -> None:
    part = inertia.read(written(tmp_path / "ring.stl", joined(ring(250, 160))))
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=":0", silence_logs=50
        ) as cluster,
        pytest.raises(InertiaError, match="the Dask scheduler does not answer any more"),
    ):
        inertia.analyse(part, dask=cluster.scheduler_address, progress=once(cluster.close))


@pytest.mark.parametrize("kind", ["stl", "ply"])
def test_a_file_that_took_the_place_of_another_is_read_anew(kind: str, cluster: Any, tmp_path: Path) -> None:
    """As `tar` and `rsync` leave it: of the same size, with the same time of change."""
    file, volumes = tmp_path / f"ring.{kind}", []
    for scale in (1.0, 2.0):
        vertices, faces = scale * ring()[0], ring()[1]
        made = tmp_path / "made"
        if kind == "stl":
            written(made, Surface(vertices, faces))
        else:
            as_ply(made, vertices, faces)
        os.utime(made, (1e9, 1e9))
        made.replace(file)
        part = inertia.read(file, memory=0)
        volumes.append(inertia.analyse(part, dask=cluster.scheduler_address).properties.volume)
    assert volumes[1] == pytest.approx(8 * volumes[0], rel=1e-6)


def test_a_small_part_has_the_same_bits_too(cluster: Any) -> None:
    part = inertia.read(path("box.stl"))
    whole, shared = inertia.analyse(part), inertia.analyse(part, dask=cluster.scheduler_address)
    assert shared.properties.error == whole.properties.error
    assert np.array_equal(shared.properties.inertia, whole.properties.inertia)


def test_standard_input_is_not_read_by_workers(tmp_path: Path) -> None:
    content = written(tmp_path / "ring.stl", joined(ring())).read_bytes()
    (tmp_path / "-").write_bytes(content)  # which is another file
    command = [sys.executable, "-m", "inertia_cli", "analyse", "-", "--dask", "local"]
    run = subprocess.run(command, input=content, capture_output=True, cwd=tmp_path, check=False)
    assert run.returncode == 2
    assert b"is no binary STL or PLY file as it is" in run.stderr


def test_a_scheduler_of_its_own_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    part = inertia.read(written(tmp_path / "ring.stl", joined(ring())))
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    inertia.analyse(part, dask="local")
    assert not [*folder.iterdir()]


def test_a_worker_with_another_file_says_so(tmp_path: Path) -> None:
    file = StoredTriangles.of(inertia.read(written(tmp_path / "ring.stl", joined(ring()))))
    assert file.read(3, 5).count == 2
    written(tmp_path / "ring.stl", joined(ring(20, 20)))
    with pytest.raises(ReadError, match=r"a Dask worker cannot read .*: it is not the file that the command has read"):
        file.read(0, 1)
    (tmp_path / "ring.stl").unlink()
    with pytest.raises(ReadError, match="give it the same file by that path"):
        file.read(0, 1)


def test_what_is_no_binary_stl_file_is_refused(cluster: Any) -> None:
    vertices, faces = ring()
    with pytest.raises(UsageError, match="is no binary STL file, nor a binary PLY file of triangles alone"):
        inertia.analyse(inertia.Part.from_arrays(vertices, faces), dask=cluster.scheduler_address)
