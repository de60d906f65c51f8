"""Assemblies: ten thousand placed parts beside trimesh's scene, a budget of a thousand inputs, and interference.

    python -m tests.benchmarks.assembly [--parts 10000] [--distinct 100]

Each figure is the CPU time and the peak memory of a process of its own, imports and files included.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

_GRID = 12.0  # mm from one part to the next


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.assembly", description=__doc__)
    parser.add_argument("--parts", type=int, default=10_000)
    parser.add_argument("--distinct", type=int, default=100)
    parser.add_argument("--one", nargs=2, metavar=("WHAT", "FILE"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        _one(*options.one)
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write(folder, options.parts, options.distinct)
        rows = [
            ("mass properties, inertia", "inertia", "whole.toml"),
            ("mass properties, trimesh Scene", "trimesh", "whole.toml"),
            ("budget with 1,000 uncertain inputs", "budget", "uncertain.toml"),
            ("interference of 1,000 parts", "interference", "uncertain.toml"),
            ("interference of 1,000 that overlap", "interference", "crowded.toml"),
        ]
        print(f"{options.parts} parts of 1,000 triangles, {options.distinct} distinct\n")
        for label, what, file in rows:
            command = [sys.executable, "-m", "tests.benchmarks.assembly", "--one", what, str(folder / file)]
            run = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True).stdout)
            said = ", ".join(f"{name} {value:.6g}" for name, value in run["says"].items())
            print(f"{label:36} {run['cpu']:7.2f} CPU s {run['memory'] / 2**20:7.0f} MB   {said}")


def _write(folder: Path, count: int, distinct: int) -> None:
    import tomli_w
    import trimesh

    for k in range(distinct):
        mesh = trimesh.creation.uv_sphere(count=[22, 24])
        mesh.apply_scale(np.random.default_rng(k).uniform(2, 5.9, 3))
        mesh.export(folder / f"{k}.stl")
    files = (("whole", count, 7850.0, 1.0), ("uncertain", 1000, "7850±40", 1.0), ("crowded", 1000, 7850.0, 0.7))
    for name, number, density, near in files:
        rng, edge = np.random.default_rng(0), round(number ** (1 / 3) + 0.5)
        parts = []
        for k in range(number):
            turn = rng.normal(size=4)
            place = near * _GRID * np.array([k % edge, k // edge % edge, k // edge**2])
            part = {"name": f"part {k}", "file": f"{k % distinct}.stl", "density": density, "at": place.tolist()}
            parts.append(part | {"quaternion": (turn / np.linalg.norm(turn)).tolist()})
        (folder / f"{name}.toml").write_text(tomli_w.dumps({"unit": "mm", "part": parts}), encoding="utf-8")


def _one(what: str, file: str) -> None:
    says = {"trimesh": _trimesh, "inertia": _inertia, "budget": _budget, "interference": _interference}[what](file)
    cpu = time.process_time()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps({"cpu": cpu, "memory": memory, "says": says}))


def _inertia(file: str) -> dict[str, float]:
    import inertia

    properties = inertia.Assembly.load(file).mass_properties()
    return {"kg": properties.mass, "kg m²": float(properties.inertia[0, 0]), "bound": properties.error.inertia}


def _budget(file: str) -> dict[str, float]:
    import inertia

    sigma = inertia.Assembly.load(file).budget().total.sigma
    return {"inputs": len(sigma.labels), "u kg": sigma.mass}


def _interference(file: str) -> dict[str, float]:
    import inertia

    return {"pairs": len(inertia.Assembly.load(file).interferences())}


def _trimesh(file: str) -> dict[str, float]:
    import tomllib

    import trimesh

    meshes: dict[str, Any] = {}
    scene = trimesh.Scene()
    for part in tomllib.loads(Path(file).read_text(encoding="utf-8"))["part"]:
        name = part["file"]
        if name not in meshes:
            mesh = trimesh.load(Path(file).parent / name)
            mesh.apply_scale(1e-3)
            mesh.density = part["density"]
            meshes[name] = mesh
            scene.geometry[name] = mesh
        x, y, z, w = part["quaternion"]
        place = trimesh.transformations.quaternion_matrix([w, x, y, z])
        place[:3, 3] = np.array(part["at"]) * 1e-3
        scene.graph.update(frame_to=part["name"], matrix=place, geometry=name)
    mass = sum(meshes[scene.graph[node][1]].mass for node in scene.graph.nodes_geometry)
    return {"kg": mass, "kg m²": float(scene.moment_inertia[0, 0])}


if __name__ == "__main__":
    main()
