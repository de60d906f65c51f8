"""Measure what recording costs, each row in a process of its own, and write docs/recording.md (on Linux)."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .measure import ROOT, python_module

RATE = 120.0
"""Poses a second of the motion, as for playback at half its speed."""
ROUNDS = 5
MILLION = 1_000_000
ROWS = {
    "pose only": ("pose", MILLION),
    "full frame": ("full", MILLION),
    "full frame, ten times as many": ("full", 10 * MILLION),
    "a whole run, with its screen": ("run", MILLION),
}
TEXT = """# What recording costs

Frames a second of one process, bytes a frame in the file, and by how much the process grew while it wrote; the median
of {rounds} runs on {machine}, rerun-sdk {version}. A *pose* is a float32 quaternion and its time. A *full frame* is a
pose, two arrows (ω and L) and five scalars. A *whole run* is `inertia.record` of a tumbling T-handle: scalars at every
sample (three of ω, three angles from L, three Euler angles, two drifts), poses and arrows at the 60 instants a second
that are played.

| | frames | frames/s | bytes/frame | grew by |
|-|-:|-:|-:|-:|
{rows}

Columns are made and written in blocks of 65 536 rows, so that the memory does not grow with the run. The
files were on the disk (`fsync`) when the clock stopped.

Measured by `python -m tests.benchmarks.recording`.

## What looking at it costs

CPU time of the viewer, without a window and drawing in software, from opening a recording of {samples} samples until
two pictures in a row are the same.

| screen | s |
|-|-:|
{screens}

Measured by `python -m tests.benchmarks.recording --screens`.
"""
SAMPLES = 100_000
SCREENS = {
    "a body that tumbles": "t_handle",
    "a body that is driven": "boom_satellite",
    "a top": "heavy_top",
    "a body that rolls": "rolling_disc",
    "a body that changes its shape": "diver",
    "a run that was interrupted, or is live": "live t_handle",
    "two runs over each other": "t_handle thrown_box",
}


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.recording", description=__doc__)
    parser.add_argument("--into", type=Path, default=ROOT / "docs", help="the folder to write to (docs)")
    parser.add_argument("--screens", action="store_true", help="print what looking at each screen costs, and no more")
    parser.add_argument("--one", nargs=2, metavar=("KIND", "FRAMES"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(measure(options.one[0], int(options.one[1]))))
        return
    screens = "\n".join(f"| {label} | {seconds_to_settle(name):.1f} |" for label, name in SCREENS.items())
    if options.screens:
        print(screens)
        return
    from importlib.metadata import version

    from .__main__ import _cpu

    lines = []
    for label, (kind, count) in ROWS.items():
        rounds = 1 if count > MILLION else ROUNDS
        done = [_one(kind, count) for _ in range(rounds)]
        rate = float(np.median([each["rate"] for each in done]))
        size, grown = done[0]["bytes"], max(each["grown_mb"] for each in done)
        lines.append(f"| {label} | {count:,} | {rate:,.0f} | {size:.1f} | {grown:.0f} MB |")
        print(lines[-1], file=sys.stderr, flush=True)
    text = TEXT.format(
        rounds=ROUNDS,
        machine=f"{_cpu()}, {os.cpu_count()} cores",
        version=version("rerun-sdk"),
        rows="\n".join(lines),
        samples=f"{SAMPLES:,}",
        screens=screens,
    )
    (options.into / "recording.md").write_text(text, encoding="utf-8")


def _one(kind: str, count: int) -> Any:
    return json.loads(python_module("tests.benchmarks.recording", "--one", kind, count, env={}))


def measure(kind: str, count: int) -> dict[str, float]:
    """Return the rate, the bytes a frame and the growth in MB of one recording."""
    prepared = run(count) if kind == "run" else frames(count, full=kind == "full")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.rrd"
        run(1000)(Path(folder) / "warm.rrd")  # imports
        Path("/proc/self/clear_refs").write_text("5")  # forget the peak until here (Linux)
        before = _memory("VmRSS")
        begin = time.perf_counter()
        prepared(path)
        duration = time.perf_counter() - begin
        return {"rate": count / duration, "bytes": path.stat().st_size / count, "grown_mb": _memory("VmHWM") - before}


def frames(count: int, *, full: bool) -> Callable[[Path], None]:
    """Return what writes the motion of a T-handle, evaluated block by block as it is written."""
    import rerun as rr
    import rerun.blueprint as rrb

    from inertia.dynamics.kinematics import quaternion
    from inertia.dynamics.models.free.motion import free_motion
    from inertia.recording.writer import to_file

    moments, omega = np.array([1.95835e-06, 7.32153e-06, 8.92934e-06]), np.array([0.001, 10.0, 0.0])
    period = 65_536
    attitude, spin = free_motion(moments, omega, np.arange(period) / RATE)
    arrows = [quaternion.to_space(attitude, each).astype(np.float32) for each in (spin, moments * spin)]
    rotation, scalars = attitude.astype(np.float32), np.concatenate([spin, spin[:, :2] ** 2], axis=1)
    seconds = np.arange(count) / RATE

    def write(path: Path) -> None:
        with to_file(path, "inertia-benchmark", rrb.Blueprint()) as recording:
            some = {count % period: slice(0, count % period), period: slice(0, period)}

            def rows(block: slice) -> slice:
                return some[block.stop - block.start]

            recording.columns("pose", seconds, lambda at: rr.Transform3D.columns(quaternion=rotation[rows(at)]))
            if full:
                for name, arrow in zip(("omega", "momentum"), arrows, strict=True):
                    recording.columns(
                        name, seconds, lambda at, arrow=arrow: rr.Arrows3D.columns(vectors=arrow[rows(at)])
                    )
                names = ["a", "b", "c", "d", "e"]
                recording.scalars("plots", seconds, lambda at: scalars[rows(at)], names, [(255, 255, 255)] * 5)

    return write


def run(count: int) -> Callable[[Path], None]:
    """Return what records a run of the sample scene with so many samples."""
    from dataclasses import replace

    from inertia import Scene, record, simulate
    from inertia_meshes import path as sample

    scene = Scene.load(sample("scenes/t_handle.toml"))
    followed = simulate(replace(scene, run=replace(scene.run, samples=count)))
    return lambda path: record(followed, path)


def seconds_to_settle(name: str) -> float:
    """Return the CPU time in s that the viewer takes until the picture of a scene with `SAMPLES` samples stands.

    `name` is that of a scene, of two, or "live" and that of one.
    """
    from dataclasses import replace

    from tests.recording.screenshot import open_viewer

    from inertia import Scene, record, simulate
    from inertia.recording.preview import Preview
    from inertia_meshes import path as sample

    live, names = name.startswith("live "), name.removeprefix("live ").split()
    scenes = [Scene.load(sample(f"scenes/{each}.toml")) for each in names]
    with tempfile.TemporaryDirectory() as folder, open_viewer(Path(folder)) as (client, _):
        file = Path(folder) / "run.rrd"
        run, *others = [simulate(replace(each, run=replace(each.run, samples=SAMPLES))) for each in scenes]
        if live:
            preview = Preview(run.scene)
            preview.take(run.time, run.attitude, run.angular_velocity)
            preview.save(file)
        else:
            record(run, file, other=others[0] if others else None)
        client.take_screenshot()
        before, last, picture = _cpu_of_children(), b"", b"-"
        client.open(str(file))
        while client.get_state().loading or not client.get_state().recordings:
            time.sleep(0.05)
        client.set_time(play_state="paused")
        while picture != last:
            last, picture = picture, client.take_screenshot()
        return _cpu_of_children() - before


def _cpu_of_children() -> float:
    """Return the CPU time in s of the processes that this one started and that still run."""
    ticks = 0
    for process in Path("/proc").glob("[0-9]*"):
        try:
            fields = (process / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == os.getpid():
            ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def _memory(name: str) -> float:
    """Return a line of /proc/self/status in MB."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(f"{name}:")) * 1024 / 1e6


if __name__ == "__main__":
    main()
