"""STEP: OpenCASCADE, through cascadio, puts triangles in the place of the exact faces and writes GLB.

It runs in a process of its own, because a damaged file can end the process, and because it prints. That process has
limits of time and memory by the size of the file, as a damaged one may keep it busy for ever, and on Linux it ends with
the one that started it.

How far each triangle is from the face that it stands for follows from the face, where it is a plane, a cylinder, a
cone, a sphere or a torus; elsewhere it is the tolerance that OpenCASCADE was asked for.
"""

from __future__ import annotations

import importlib.util
import math
import os
import re
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError, UsageError
from inertia.mesh.part import Surface
from inertia.mesh.readers.contents import Contents, plural, was
from inertia.mesh.readers.gltf import Scene, read_gltf
from inertia.output import temporary_folder

_LINEAR, _ANGULAR = 0.001, 0.05  # sag relative to the length of an edge, angle in radians
_CONVERT = """
import os, sys
source, target, linear, angular, seconds, size, parent = sys.argv[1:]
try:
    import resource
    for name, most in (("CPU", int(seconds)), ("AS", int(size)), ("CORE", 0)):
        kind = getattr(resource, "RLIMIT_" + name)
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
except (ImportError, ValueError, OSError):  # Windows, and systems that do not limit one of them
    pass
if sys.platform == "linux":
    import ctypes
    ctypes.CDLL(None).prctl(1, 9)  # PR_SET_PDEATHSIG, SIGKILL
    if os.getppid() != int(parent):
        sys.exit(1)
import cascadio
options = {"use_parallel": False, "include_brep": True}
try:
    status = cascadio.step_to_glb(source, target, float(linear), float(angular), True, **options)
except TypeError:  # an older cascadio, which does not name the faces
    status = cascadio.step_to_glb(source, target, float(linear), float(angular), True, use_parallel=False)
sys.exit(status != 0)
"""
SECONDS = "INERTIA_STEP_SECONDS"
"""The variable of the environment that sets how long a conversion may take, in s of processor time."""
GIB = "INERTIA_STEP_GIB"
"""The variable of the environment that sets how much memory a conversion may take, in GiB."""
_SECONDS, _SECONDS_A_MB = 120, 120  # a torus, a file of 3 kB, takes 7 s
_GIB, _GIB_A_MB = (
    4,
    0.2,
)  # it begins with 0.5 GiB, and takes some 40 times the size of a file
_WAIT = 10  # times the processor time that may pass by the clock
_EXHAUSTED = re.compile(rb"bad_alloc|OutOfMemory|MemoryError")
_REFERENCE = re.compile(rb"\b(?:DOCUMENT_FILE|DCMFL)\b", re.IGNORECASE)
_STORED = 2.0**-23  # of the largest coordinate: three float32 coordinates are off by √3/2 of that, and a fifth to spare
_ON_FACE = 1e-5  # of the size: what lies farther from a face than this at its corners belongs to another one
_BETWEEN_SAMPLES = 9 / 8


def read_step(path: Path, coarser: float = 1.0) -> Contents:
    """Read a STEP file as triangles, in metres, by so much coarser than usual; its solids are regions."""
    if importlib.util.find_spec("cascadio") is None:
        raise ReadError("STEP needs the package cascadio: pip install 'inertia[step]'")
    with temporary_folder() as folder:
        source, left_out = _by_itself(path, folder)
        target = folder / "part.glb"
        _convert(source, target, coarser, path.stat().st_size / 1e6)
        contents = read_gltf(target, _distances)
    surface, chord = contents.geometry, contents.chord
    assert isinstance(surface, Surface)
    assert chord is not None
    size = float(np.ptp(surface.vertices, axis=0).max())
    # In proportion to an edge, OpenCASCADE asks for no more than half of this share of the whole shape.
    chord = np.where(np.isnan(chord), coarser**2 * _LINEAR * size, chord) + _STORED * np.abs(surface.vertices).max()
    note = (
        f"curved STEP faces were replaced by triangles that turn by up to {coarser * _ANGULAR:g} rad and are up to "
        f"{chord.max():.2g} m off (a cylinder loses {coarser**2 * 1e-4:g} of its volume), with float32 coordinates"
    )
    notes = (f"{plural(left_out, 'file')} that it refers to {was(left_out)} left out",) if left_out else ()
    return replace(contents, notes=(*contents.notes, *notes, note), chord=chord)


def _convert(source: Path, target: Path, coarser: float, size: float) -> None:
    """Convert a STEP file of so many MB in a process of its own."""
    seconds = _limit(SECONDS, _SECONDS + _SECONDS_A_MB * size)
    gib = _limit(GIB, _GIB + _GIB_A_MB * size)
    figures = (coarser**2 * _LINEAR, coarser * _ANGULAR, math.ceil(seconds), math.ceil(gib * 2**30), os.getpid())
    try:
        process = subprocess.run(
            [sys.executable, "-P", "-c", _CONVERT, str(source), str(target), *map(str, figures)],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            timeout=_WAIT * seconds,
        )
        late = process.returncode == -getattr(signal, "SIGXCPU", 0) != 0
    except subprocess.TimeoutExpired:
        late = True
    if late:
        raise ReadError(
            f"OpenCASCADE took longer than {seconds:.0f} s of processor time, the limit for a file of its size: it may "
            f"be damaged; export the part as STL or 3MF, or set {SECONDS} to more"
        )
    if process.returncode and (
        _EXHAUSTED.search(process.stderr) or process.returncode == -getattr(signal, "SIGKILL", 0)
    ):
        raise ReadError(
            f"OpenCASCADE needs more than {gib:.3g} GiB of memory, the limit for a file of its size, or than there is: "
            f"it may be damaged; export the part as STL or 3MF, or set {GIB} to more"
        )
    if process.returncode or not target.is_file():
        raise ReadError(f"OpenCASCADE cannot convert it (status {process.returncode}): export the part again")


def _limit(name: str, usual: float) -> float:
    """Return a limit: that of the environment, or the usual one."""
    value = os.environ.get(name, "")
    try:
        limit = float(value) if value else usual
    except ValueError:
        limit = 0.0
    if not 0 < limit < 1e6:
        raise UsageError(f"{name} is {value!r}: it must be a positive number below 1e6")
    return limit


def _by_itself(path: Path, folder: Path) -> tuple[Path, int]:
    """Return a file without references to others, which OpenCASCADE would read from anywhere, and how many it had.

    The entity that names a file (ISO 10303-41 `document_file`, also under its short name) is given a name of the same
    length that OpenCASCADE does not know; what refers to it is passed over.
    """
    data = path.read_bytes()
    count = len(_REFERENCE.findall(data))
    if not count:
        return path.absolute(), 0
    alone = folder / "part.step"
    alone.write_bytes(_REFERENCE.sub(lambda name: name[0][:-1] + b"_", data))
    return alone, count


def _distances(scene: Scene, primitive: dict[str, Any], vertices: Float, faces: Int) -> Float:
    """Return how far each triangle is from the face that it stands for, NaN where the face is not one of the five.

    A triangle with corners on a surface is off by a quadratic form that vanishes at the corners, up to terms of higher
    order. Where the curvatures have one sign, an affine map makes the form that of a sphere: the largest distance, at
    the centre of the circumscribed circle or in the middle of the longest edge, is at most 9/8 of that at the centroid
    or there. Where they have two, it lies in the middle of an edge.
    """
    distances = np.full(len(faces), np.nan)
    own = primitive.get("extensions", {}).get("TM_brep_faces")
    owners = np.empty(0) if own is None else scene.accessor(own["faceIndices"]).reshape(-1)
    if len(owners) != len(faces):
        return distances
    size = float(np.ptp(vertices, axis=0).max())
    for number, face in enumerate(own["faces"]):
        triangles = np.flatnonzero(owners == number)
        if face is None or face.get("type") not in _SURFACES or not len(triangles):
            continue
        corners = vertices[faces[triangles]]
        middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
        points = np.concatenate([corners, middles, corners.mean(axis=1, keepdims=True)], axis=1)
        off = np.abs(_SURFACES[face["type"]](face, points))
        if off[:, :3].max() <= _ON_FACE * size:
            distances[triangles] = _BETWEEN_SAMPLES * off.max(axis=1)
    return distances


def _off_plane(face: dict[str, Any], points: Float) -> Float:
    off: Float = (points - face["origin"]) @ np.array(face["normal"])
    return off


def _off_sphere(face: dict[str, Any], points: Float) -> Float:
    off: Float = np.linalg.norm(points - face["center"], axis=-1) - face["radius"]
    return off


def _off_cylinder(face: dict[str, Any], points: Float) -> Float:
    across, _ = _about(face["axis"], points - face["origin"])
    return across - float(face["radius"])


def _off_cone(face: dict[str, Any], points: Float) -> Float:
    across, along = _about(face["axis"], points - face["apex"])
    angle = abs(float(face["semi_angle"]))
    off: Float = across * np.cos(angle) - np.abs(along) * np.sin(angle)
    return off


def _off_torus(face: dict[str, Any], points: Float) -> Float:
    across, along = _about(face["axis"], points - face["center"])
    off: Float = np.hypot(across - face["major_radius"], along) - face["minor_radius"]
    return off


def _about(axis: list[float], points: Float) -> tuple[Float, Float]:
    """Return the distances of points from an axis through the origin, and along it."""
    direction = np.array(axis)
    along = points @ direction
    return np.linalg.norm(points - along[..., None] * direction, axis=-1), along


_SURFACES = {
    "plane": _off_plane, "sphere": _off_sphere, "cylinder": _off_cylinder, "cone": _off_cone, "torus": _off_torus,
}  # fmt: skip
