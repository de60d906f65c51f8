"""Pairing edges in bounded memory: against the pairing of coordinates, in memory and on disk."""

import os
import shutil
from collections import defaultdict
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from tests.mesh.solids import cube, facets, joined, ring, sphere
from tests.mesh.test_flush_bodies import block_in_blocks

from inertia.errors import UsageError, WriteError
from inertia.mesh.external import closure as external
from inertia.mesh.external.closure import closed_by_place, external_closure, room_for
from inertia.mesh.geometry import edge_buckets as buckets
from inertia.mesh.geometry.closure import paired_by_keys, vectorised_closure
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.irregular_edges import Irregular, TooMany
from inertia.mesh.geometry.leaves import BY_PLACE, Limits, paired_by_place, stored_at_most
from inertia.mesh.surface import FACET, Facets, Surface

AMPLE = 10**8


def soups() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    closed = joined(ring(40, 30), ring(40, 30, radius=20), sphere((0, 0, 30)))
    corners = facets(closed).corners().astype(np.float32)
    corners = corners[rng.permutation(len(corners))]
    point = corners[:9].copy()
    point[:, 2] = point[:, 0]
    return {
        "closed": corners,
        "a hole": corners[3:],
        "a copy": np.concatenate([corners, corners[:1]]),
        "one turned": np.concatenate([corners[:5], corners[5:6, ::-1], corners[6:]]),
        "all twice": np.concatenate([corners, corners]),
        "both ways": np.concatenate([corners, corners[:, ::-1]]),
        "repeated corners": np.concatenate([corners[:50], point, corners[50:]]),
        "loose triangles": rng.normal(size=(3000, 3, 3)).astype(np.float32),
        "cubes edge to edge": facets(joined(cube(), cube((1, 1, 0)), cube((2, 2, 0)))).corners().astype(np.float32),
        "bodies face on face": block_in_blocks(30, 2).corners().astype(np.float32),
        "bodies face on face, inside out": block_in_blocks(30, 2).corners()[:, ::-1].astype(np.float32),
        "zeros of both signs": np.where(corners == 0, -corners, corners),
        "one edge for all": np.stack([[[0, 0, 0], [0, 0, 1], [k, 1, 0]] for k in range(2500)]).astype(np.float32),
    }


SOUPS = soups()


def stored(corners: np.ndarray) -> Facets:
    surface = Facets(np.zeros(len(corners), FACET))
    surface.corners_f4()[:] = corners
    return surface


@pytest.mark.parametrize("native", ["1", "0"])
@pytest.mark.parametrize("name", SOUPS)
def test_the_pairing_is_that_of_the_coordinates(name: str, native: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INERTIA_NATIVE", native)
    surface = stored(SOUPS[name])
    expected, found = vectorised_closure(surface), external_closure(surface, AMPLE).closure
    assert (found.open_edges, found.components, found.repeated, found.crowded) == (
        expected.open_edges,
        expected.components,
        expected.repeated,
        expected.crowded,
    )
    assert found.labels.tolist() == expected.labels.tolist()
    assert found.at_crowded.tolist() == expected.at_crowded.tolist()


@pytest.mark.parametrize("over_vertices", [False, True])
@pytest.mark.parametrize("name", SOUPS)
def test_the_pairing_by_keys_in_memory_is_that_of_the_coordinates(
    name: str, over_vertices: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("inertia.native.SHIPPED_ABOVE", 0)
    surface, salt = stored(SOUPS[name]), np.random.default_rng(2).integers(1 << 60, size=15).astype(np.uint64)
    found = paired_by_keys(Surface(*merge_equal_vertices(surface)) if over_vertices else surface, salt)
    few = {"closed", "a hole", "a copy", "one turned", "repeated corners", "zeros of both signs"}
    assert (found is not None) == (name in few)
    monkeypatch.setattr("inertia.mesh.geometry.closure.SHARE", 0.1)
    known, expected = paired_by_keys(surface, salt), vectorised_closure(surface)
    assert known is not None
    found, _ = known
    assert found.labels.tolist() == expected.labels.tolist()
    assert found.at_crowded.tolist() == expected.at_crowded.tolist()
    assert len(found.at_crowded) or not found.crowded
    for name in ("open_edges", "components", "repeated", "crowded"):
        assert getattr(found, name) == getattr(expected, name)


@pytest.mark.parametrize("bytes_a_triangle", [100, 16])
@pytest.mark.parametrize("name", SOUPS)
def test_a_closed_surface_is_paired_by_place(
    name: str, bytes_a_triangle: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    for constant, value in (("_LEAF", 512), ("_FIXED", 0), ("_FEWEST", 1)):
        monkeypatch.setattr(external, constant, value)
    surface, written = stored(np.concatenate([SOUPS[name], SOUPS["closed"] + 100])), []
    salt = np.random.default_rng(6).integers(0, 2**64, buckets.SALTS, np.uint64)
    with ExitStack() as stack:
        found = closed_by_place(
            surface, bytes_a_triangle * surface.count, salt, stack, lambda done: written.append(temporary(tmp_path))
        )
    expected = vectorised_closure(surface)
    if expected.open_edges or expected.crowded:
        assert found is None
    else:
        assert found is not None
        assert (found.components, found.repeated) == (expected.components, expected.repeated)
        assert found.labels.tolist() == expected.labels.tolist()
        assert bool(written[-1]) == (bytes_a_triangle < 20)
    assert not temporary(tmp_path)


def test_irregular_edges_are_those_that_are_not_used_once_each_way() -> None:
    corners = SOUPS["a copy"]
    uses = defaultdict(list)
    for number, (a, b, c) in enumerate((corners + 0.0).tolist()):
        for tail, head in ((a, b), (b, c), (c, a)):
            uses[tuple(sorted((tuple(tail), tuple(head))))].append((number, tail < head))
    odd = {edge: users for edge, users in uses.items() if len(users) != 2 or users[0][1] == users[1][1]}
    irregular = external_closure(stored(corners), AMPLE).irregular
    assert isinstance(irregular, Irregular)
    ends = irregular.vertices[irregular.edges.ends]
    assert {tuple(sorted(map(tuple, edge))) for edge in ends.tolist()} == set(odd)
    assert sorted(irregular.edges.users.tolist()) == sorted(number for users in odd.values() for number, _ in users)


def test_too_many_irregular_edges_are_counted_only() -> None:
    count = 23_000  # 69,000 loose edges, and room to look at 65,536
    corners = np.random.default_rng(2).normal(size=(count, 3, 3)).astype(np.float32)
    pairing = external_closure(stored(corners), room_for(count))
    assert isinstance(pairing.irregular, TooMany)
    assert (pairing.closure.open_edges, pairing.closure.components) == (3 * count, count)
    assert vars(pairing.irregular) == {
        "triangle": 0, "once": 3 * count, "same_way": 0, "crowded": 0, "halves": 3 * count
    }  # fmt: skip


class OnDisk(NamedTuple):
    surface: Facets
    room: int
    folder: Path


@pytest.fixture
def on_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> OnDisk:
    """Return a shuffled ring whose edges take more than its room."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    corners = facets(joined(ring(500, 250))).corners()
    surface = stored(corners[np.random.default_rng(3).permutation(len(corners))].astype(np.float32))
    room = room_for(surface.count)
    assert 36 * surface.count > room // 2
    return OnDisk(surface, room, tmp_path)


def temporary(folder: Path) -> set[str]:
    return {file.name for file in folder.iterdir() if file.name.endswith(".inertia")}


def test_edges_that_do_not_fit_are_paired_on_disk_and_nothing_stays_there(on_disk: OnDisk) -> None:
    left_behind = on_disk.folder / ".killed.0123456789ab.inertia"
    left_behind.mkdir()
    (left_behind / "edges").write_bytes(bytes(1000))
    during: set[str] = set()

    def look(done: float) -> None:
        during.update(temporary(on_disk.folder))

    pairing = external_closure(on_disk.surface, on_disk.room, look)
    assert (pairing.closure.open_edges, pairing.closure.components) == (0, 1)
    assert len(during) == 1
    assert left_behind.name not in during or os.name == "nt"
    assert not temporary(on_disk.folder) - ({left_behind.name} if os.name == "nt" else set())


@pytest.mark.skipif(os.name == "nt", reason="there nobody holds locks")
def test_what_a_killed_run_has_left_is_removed_by_one_that_needs_no_file(on_disk: OnDisk) -> None:
    left_behind = on_disk.folder / ".killed.0123456789ab.inertia"
    left_behind.mkdir()
    external_closure(on_disk.surface, 1000 * on_disk.room)
    assert not temporary(on_disk.folder)


def test_an_interruption_leaves_nothing_on_disk(on_disk: OnDisk) -> None:
    def interrupt(done: float) -> None:
        if done > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        external_closure(on_disk.surface, on_disk.room, interrupt)
    assert not temporary(on_disk.folder)


def test_too_full_a_disk_is_refused_before_it_is_written_to(on_disk: OnDisk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: shutil._ntuple_diskusage(10**9, 10**9, 10**6))
    with pytest.raises(WriteError, match=r"temporary files of 9 MB are needed, and .* has room for 1 MB: set TMPDIR"):
        external_closure(on_disk.surface, on_disk.room)


class Stored:
    """A store in memory, and how large it has grown."""

    def __init__(self) -> None:
        self.content = bytearray()

    def reserve(self, size: int) -> int:
        self.content += bytes(size)
        return len(self.content) - size

    def write(self, array: np.ndarray, at: int) -> None:
        self.content[at : at + array.nbytes] = array.tobytes()

    def read(self, array: np.ndarray, at: int) -> None:
        array.view(np.uint8).reshape(-1)[:] = np.frombuffer(self.content, np.uint8, array.nbytes, at)


@pytest.mark.parametrize("parts", [1, 2])
@pytest.mark.parametrize("held", [0.3, 0.5, 0.9])
def test_no_more_is_stored_than_was_asked_for(held: float, parts: int, on_disk: OnDisk) -> None:
    if not all(kernel.worthwhile(on_disk.surface.count) for kernel in BY_PLACE):
        return
    count, store = on_disk.surface.count, Stored()
    rows, leaf = int(held * count), 1 << 13
    limits = Limits(rows, 1 << 10, 1 << 30, store)
    salt = np.random.default_rng(5).integers(0, 2**63, 15).astype(np.uint64)
    paired = paired_by_place(on_disk.surface, leaf, 16, parts, salt, limits=limits)
    assert paired is not None
    assert paired[:2] == (0, 1)
    assert 0 < len(store.content) <= stored_at_most(count, leaf, rows, parts)


def test_a_folder_that_is_not_there_is_refused(on_disk: OnDisk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(on_disk.folder / "no such"))
    with pytest.raises(WriteError, match=r"TMPDIR is .*no such, where no temporary files can be written: set it to"):
        external_closure(on_disk.surface, on_disk.room)


def test_too_little_room_is_refused() -> None:
    surface = stored(SOUPS["closed"])
    with pytest.raises(UsageError, match="allow more by memory=BYTES"):
        external_closure(surface, room_for(surface.count) - 1)


@pytest.mark.parametrize("steps", [buckets.Compiled, buckets.Vectorised])
def test_keys_of_edges_are_polynomials_of_those_of_their_ends(
    steps: type[buckets.Compiled] | type[buckets.Vectorised],
) -> None:
    surface = facets(Surface(*ring(20, 10)))
    salt = np.random.default_rng(5).integers(0, 2**64, buckets.SALTS, np.uint64)
    keys, counts = np.empty(3 * surface.count, np.uint64), np.zeros(16, np.int64)
    assert steps(salt).keys(surface, 0, surface.count, keys, counts, 4) == 0
    corners = surface.corners_f4(0, surface.count).astype("<f4") + np.float32(0)
    expected = []
    for words in corners.view(np.uint32).tolist():
        ends = [_key(corner, salt.tolist()) for corner in words]
        expected += [_edge(a, b, int(salt[14])) for a, b in zip(ends, ends[1:] + ends[:1], strict=True)]
    assert keys.tolist() == expected
    assert counts.sum() == len(keys)


def _key(words: list[int], salt: list[int]) -> int:
    one, other = (
        (part[0] + sum(word * random for word, random in zip(words, part[1:4], strict=True))) % 2**64
        for part in (salt[:7], salt[7:14])
    )
    return ((one >> 32) << 32 | other >> 32) >> 4


def _edge(a: int, b: int, salt: int) -> int:
    r = salt % 2**61
    return (r + a) * (r + b) % (2**61 - 1) << 3 | (a < b)
