"""Many files: throughput, workers that are killed, runs that are cut short, and whether the bytes stay the same.

Run as ``python -m tests.benchmarks.batch --parts 10000``; it prints a document of figures. The parts are star-shaped
surfaces of 1,000 triangles, 3 % of them broken in every way that `inertia check` knows of surfaces. (On Linux.)
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from inertia.arrays import Float, Int

_ROWS, _ALONG = 20, 25  # a surface has 2 · 20 · 25 triangles
_BROKEN = 0.03


def faces() -> Int:
    """Return the triangles of a sphere of latitudes and meridians, the poles last."""
    ring = np.arange(_ALONG)
    step = (ring + 1) % _ALONG
    low = (np.arange(_ROWS - 1) * _ALONG)[:, None]
    quads = [low + ring, low + _ALONG + ring, low + step, low + step, low + _ALONG + ring, low + _ALONG + step]
    last, north = (_ROWS - 1) * _ALONG, _ROWS * _ALONG
    top = np.column_stack([np.full(_ALONG, north), ring, step])
    bottom = np.column_stack([np.full(_ALONG, north + 1), last + step, last + ring])
    return np.vstack([np.stack(quads, -1).reshape(-1, 3), top, bottom])


def corners(rng: np.random.Generator, faces: Int) -> Float:
    """Return the corners (1000, 3, 3), mm, of a star-shaped part."""
    polar = np.linspace(0, np.pi, _ROWS + 2)[1:-1, None]
    turn = np.linspace(0, 2 * np.pi, _ALONG, endpoint=False)
    size, lobes = 10 * rng.uniform(0.5, 2, 3), rng.integers(2, 6)
    radius = 1 + rng.uniform(0, 0.2) * np.cos(lobes * turn + rng.uniform(0, 6)) * np.sin(polar) ** 2
    along = np.broadcast_to(np.cos(polar), radius.shape)
    points = np.stack([radius * np.sin(polar) * np.cos(turn), radius * np.sin(polar) * np.sin(turn), along], -1)
    return (size * np.vstack([points.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]]))[faces]


def stl(corners: Float, count: int | None = None) -> bytes:
    """Return a binary STL file."""
    facets = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("bytes", "<u2")]))
    facets["corners"] = corners
    return bytes(80) + np.uint32(len(corners) if count is None else count).tobytes() + facets.tobytes()


def _with_nan(corners: Float) -> Float:
    corners = corners.copy()
    corners[7, 1, 2] = np.nan
    return corners


def _flat(corners: Float) -> Float:
    return np.vstack([corners[:500], corners[:500, ::-1]])


def _tilted(corners: Float) -> Float:
    """Return a surface that crosses itself: one vertex is pulled through to the other side."""
    vertex = corners[100, 0]
    return np.where((corners == vertex).all(-1, keepdims=True), -1.5 * corners, corners)


_FAULTS: dict[str, Callable[[Float], bytes]] = {
    "empty": lambda corners: stl(corners[:0]),
    "no bytes": lambda _: b"",
    "no mesh": lambda _: b"<html>404 not found</html>",
    "truncated": lambda corners: stl(corners)[:-1234],
    "wrong count": lambda corners: stl(corners, 2**31),
    "not finite": lambda corners: stl(_with_nan(corners)),
    "open": lambda corners: stl(corners[3:]),
    "inconsistent winding": lambda corners: stl(np.vstack([corners[:1, ::-1], corners[1:]])),
    "duplicate face": lambda corners: stl(np.vstack([corners, corners[5:6]])),
    "opposite duplicate": lambda corners: stl(np.vstack([corners, corners[5:6, ::-1], corners[5:6]])),
    "non-manifold edge": lambda corners: stl(np.vstack([corners, 1.5 * corners[5:6]])),
    "degenerate": lambda corners: stl(np.vstack([corners, corners[5:6, [0, 0, 1]]])),
    "zero volume": lambda corners: stl(_flat(corners)),
    "inside out": lambda corners: stl(corners[:, ::-1]),
    "overlapping bodies": lambda corners: stl(np.vstack([corners, np.add(corners, [3, 1, 2])])),
    "inverted body": lambda corners: stl(np.vstack([corners, corners[:, ::-1] + 100])),
    "body in body": lambda corners: stl(np.vstack([corners, 0.3 * corners])),
    "cavity": lambda corners: stl(np.vstack([corners, 0.3 * corners[:, ::-1]])),
    "contact": lambda corners: stl(np.vstack([corners, corners * [-1, -1, 1] + [2 * corners[..., 0].max(), 0, 0]])),
    "crossing itself": lambda corners: stl(_tilted(corners)),
    "far away": lambda corners: stl(corners + 1e7),
    "huge": lambda corners: stl(corners * 1e36),
}


def generate(folder: Path, count: int) -> int:
    """Write parts, and return how many of them are broken."""
    triangles, rng, broken = faces(), np.random.default_rng(18), 0
    faults = list(_FAULTS.values())
    for number in range(count):
        if number % 1000 == 0:
            (folder / f"{number // 1000:03}").mkdir()
        surface = corners(rng, triangles)
        fault = rng.uniform() < _BROKEN
        content = faults[broken % len(faults)](surface) if fault else stl(surface)
        broken += fault
        (folder / f"{number // 1000:03}/part{number:05}.stl").write_bytes(content)
    return broken


def command(*arguments: str | Path) -> list[str]:
    """Return the command line of a batch."""
    return [sys.executable, "-m", "inertia_cli", "batch", *map(str, arguments), "--json"]


def timed(arguments: list[str]) -> dict[str, Any]:
    """Run a batch: wall time, CPU time of it and its workers, largest memory of a process, and its summary."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    run = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True)
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    summary = json.loads(run.stdout)
    return {
        "seconds": wall,
        "cpu_seconds": cpu,
        "cpu_ms_a_file": 1e3 * cpu / summary["files"],
        "states": summary["states"],
        "refusals": {each["message"]: each["count"] for each in summary["refusals"]},
    }


def by_trimesh(path: str) -> tuple[bool, Any]:
    """Do with trimesh what comes nearest: load, check that it is closed and wound, and integrate."""
    import trimesh

    try:
        mesh = trimesh.load_mesh(path)
        sound = mesh.is_watertight and mesh.is_winding_consistent
        properties = mesh.mass_properties
        np.linalg.eigh(properties.inertia)
        return sound, properties.mass
    except Exception:
        return False, None


def trimesh_loop(names: list[str], jobs: int) -> dict[str, Any]:
    """Run a loop of multiprocessing with trimesh, as users write it."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        sound = sum(ok for ok, _ in pool.imap(by_trimesh, names, chunksize=32))
        pool.close()
        pool.join()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    wall = time.perf_counter() - started
    return {"seconds": wall, "cpu_seconds": cpu, "cpu_ms_a_file": 1e3 * cpu / len(names), "sound": sound}


def children(number: int) -> list[int]:
    """Return the processes that a process has started."""
    texts = []
    for path in Path(f"/proc/{number}/task").glob("*/children"):
        try:
            texts.append(path.read_text())
        except OSError:
            continue
    return [int(each) for text in texts for each in text.split()]


def rss(number: int) -> float:
    """Return the memory of a process, MiB."""
    try:
        return int(Path(f"/proc/{number}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20
    except OSError:
        return 0.0


def with_kills(arguments: list[str], kills: int, table: Path) -> dict[str, Any]:
    """Kill random workers of a running batch, and count rows that are lost, or there twice."""
    run = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    done, rng = 0, random.Random(18)
    known: set[int] = set()
    while run.poll() is None and done < kills:
        time.sleep(rng.uniform(0.2, 0.6))
        workers = children(run.pid)
        if at_work := [worker for worker in workers if worker in known]:  # a machine under load starts them slowly
            os.kill(rng.choice(at_work), signal.SIGKILL)
            done += 1
        known = set(workers)
    run.communicate()
    paths = [json.loads(line)["path"] for line in table.read_text().splitlines()]
    states = {json.loads(line)["state"] for line in table.read_text().splitlines()}
    return {"kills": done, "rows": len(paths), "twice": len(paths) - len(set(paths)), "states": sorted(states)}


def with_a_kill(arguments: list[str], table: Path) -> dict[str, Any]:
    """Kill a whole batch in its midst, start it again, and say how many rows were there already."""
    run = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    parts = table.with_name(f"{table.name}.parts")
    while len([*parts.glob("*.jsonl")]) < 4 and run.poll() is None:
        time.sleep(0.01)
    run.kill()
    if run.wait() == 0:
        sys.exit("the run that was to be cut short was done before: give more parts by --few")
    again = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True)
    summary = json.loads(again.stdout)
    return {"files": summary["files"], "there_already": summary["stored"]}


def memory(arguments: list[str]) -> dict[str, Any]:
    """Return the memory of the command and of its largest worker, MiB, at a fifth and at the end of a run."""
    run = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    samples: list[tuple[float, float]] = []
    while run.poll() is None:
        samples.append((rss(run.pid), max(map(rss, children(run.pid)), default=0.0)))
        time.sleep(0.25)
    at_work = [sample for sample in samples if sample[1]]
    early, late = at_work[len(at_work) // 5], at_work[-1]
    return {"command_mib": [round(early[0]), round(late[0])], "worker_mib": [round(early[1]), round(late[1])]}


def main() -> int:
    """Measure, and print a document."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--parts", type=int, default=10_000)
    parser.add_argument("--few", type=int, default=3000, help="parts of what is run several times")
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="batch"))
    try:
        corpus, few = folder / "parts", folder / "few"
        corpus.mkdir()
        few.mkdir()
        result: dict[str, Any] = {"parts": options.parts, "triangles": 1000, "broken": generate(corpus, options.parts)}
        generate(few, options.few)
        every, some = f"{corpus}/**/*.stl", f"{few}/**/*.stl"
        result["batch_2_workers"] = timed(command(every, "-o", folder / "all.parquet", "--jobs", "2"))
        names = sorted(map(str, few.glob("**/*.stl")))
        result["few"] = len(names)
        result["few_1_worker"] = timed(command(some, "-o", folder / "one.jsonl", "--jobs", "1"))
        result["few_2_workers"] = timed(command(some, "-o", folder / "two.jsonl", "--jobs", "2"))
        result["few_4_workers"] = timed(command(some, "-o", folder / "four.jsonl", "--jobs", "4"))
        result["few_dask"] = timed(command(some, "-o", folder / "dask.jsonl", "--dask", "local"))
        result["few_trimesh_1"], result["few_trimesh_2"] = trimesh_loop(names, 1), trimesh_loop(names, 2)
        tables = [(folder / f"{name}.jsonl").read_bytes() for name in ("one", "two", "four", "dask")]
        result["same_bytes_with_1_2_4_workers_and_dask"] = len(set(tables)) == 1
        killed = folder / "killed.jsonl"
        result["workers_killed"] = with_kills(command(every, "-o", killed, "--jobs", "2"), 20, killed)
        cut = folder / "cut.jsonl"
        result["cut_short"] = with_a_kill(command(some, "-o", cut, "--jobs", "2"), cut)
        result["cut_short"]["same_bytes"] = cut.read_bytes() == tables[0]
        result["memory"] = memory(command(every, "-o", folder / "memory.parquet", "--jobs", "2"))
        print(json.dumps(result, indent=1))
    finally:
        shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
