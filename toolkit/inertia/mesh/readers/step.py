"""STEP: OpenCASCADE reads the exact faces, and puts triangles in their place beside them.

It runs in a process of its own, because a damaged file can end the process, and because it prints. That process has
limits of time and memory by the size of the file, as a damaged one may keep it busy for ever, and on Linux it ends with
the one that started it.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import re
import signal
import subprocess
import sys
from codecs import BOM_UTF8
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError, UsageError, visible
from inertia.mesh.readers.contents import Contents, Layout, label, plural, shown, surface, was
from inertia.mesh.readers.opencascade.plain import shape_from_json
from inertia.mesh.shape import Shape
from inertia.mesh.surface import Surface
from inertia.mesh.tree import MeshNode, Motion, unique
from inertia.output import temporary_folder
from inertia.standard_input import FULL, reason_of
from inertia.units import Unit, length_unit, multiple_of

_LINEAR, _ANGULAR = 0.001, 0.05  # sag relative to the length of an edge, angle in radians
_CONVERT = "from inertia.mesh.readers.opencascade.convert import main; main()"
SECONDS = "INERTIA_STEP_SECONDS"
"""The variable of the environment that sets how long a conversion may take, in s of processor time."""
GIB = "INERTIA_STEP_GIB"
"""The variable of the environment that sets how much memory a conversion may take, in GiB."""
_SECONDS, _SECONDS_A_MB = 120, 120  # a torus, a file of 3 kB, takes 2 s
_GIB, _GIB_A_MB = 4, 0.2  # it begins with 0.7 GiB, and takes some 40 times the size of a file
_WAIT = 10  # times the processor time that may pass by the clock
_EXHAUSTED = re.compile(rb"bad_alloc|OutOfMemory|MemoryError")
_FULL = re.compile(rb"OSError: \[Errno (%s)\]" % b"|".join(b"%d" % number for number in FULL))
_REFERENCE = re.compile(rb"\b(?:DOCUMENT_FILE|DCMFL)\b", re.IGNORECASE)
_UNREAD = re.compile(
    rb"(?i)#\d+\s*=\s*(CSG_SOLID|(?:EXTRUDED|REVOLVED)_(?:AREA|FACE)_SOLID(?:_\w+)?|SWEPT_DISK_SOLID|SURFACE_CURVE_SWEPT_\w+"
    rb"|SOLID_REPLICA)\s*\("
)
_HIDDEN = re.compile(rb"(?i)=\s*INVISIBILITY\s*\(\s*\(([^()]*)\)")
_FLAT = 1e-12  # of the size: triangles no farther off than that are the faces themselves
_ROUNDING = 2.0**-50  # of the largest coordinate


def read_step(path: Path, coarser: float = 1.0) -> Contents:
    """Read a STEP file, in its own unit: its true shape, and triangles by so much coarser than usual."""
    own = _converted(path, coarser)
    runs = [(name and visible(name), length) for name, length in own.document["runs"]]
    return Contents(own.triangles, own.unit, label(runs), own.notes, own.chord, shape=own.shape)


def model_contents(model: Any, unit: str) -> Contents:
    """Take over a model of cadquery or build123d, or a shape of OpenCASCADE's binding, in this process.

    Parameters
    ----------
    model : see `inertia.mesh.readers.opencascade.models.bodies_in`
    unit : the name of its unit of length

    Raises `UsageError` where it has no face.
    """
    from inertia.mesh.readers.opencascade.models import bodies_in

    bodies, loose = bodies_in(model, _LINEAR, _ANGULAR)
    triangles, chord, notes = _stand_ins(bodies.surface(), 1.0, unit, "")
    notes += [*_gaps(loose, bodies.without_triangles), *_untrue(bodies.fault)]
    solids = tuple(replace(solid, name=visible(solid.name)) for solid in bodies.solids)
    shape = None if bodies.fault else Shape(solids, np.array(bodies.tolerances))
    regions = label((name and visible(name), length) for name, length in bodies.runs)
    return Contents(triangles, None, regions, tuple(notes), chord, shape=shape)


def step_tree(path: Path) -> Layout:
    """Read the tree of products in a STEP file, and each solid once, in its own frame."""
    own = _converted(path, 1.0, "tree")
    runs, sizes, instances = (own.document[key] for key in ("runs", "vertices", "instances"))
    names = unique(visible(name or f"solid {k + 1}") for k, (name, _) in enumerate(runs))
    meshes, vertex, face = {}, 0, 0
    for k, (name, (_, length), size) in enumerate(zip(names, runs, sizes, strict=True)):
        faces = slice(face, face + length)
        if length:
            shape = own.shape and Shape((replace(own.shape.solids[k], name=name),), own.shape.tolerances)
            part = surface(own.triangles.vertices[vertex : vertex + size], own.triangles.faces[faces] - vertex)
            meshes[name] = Contents(part, own.unit, None, (), own.chord[faces], shape=shape)
        vertex, face = vertex + size, face + length
    nodes = [MeshNode(name, above, _motion(place)) for name, above, place in own.document["nodes"]]
    counts = Counter(node for _, node, _, _ in instances)
    for title, node, place, body in instances:
        motion, mesh = _motion(place), names[body] if names[body] in meshes else None
        if counts[node] == 1 and motion == Motion():
            nodes[node] = replace(nodes[node], mesh=mesh)
        else:
            nodes.append(MeshNode(title, node, motion, mesh))
    return Layout(nodes, meshes, own.notes)


def _motion(rows: list[list[float]]) -> Motion:
    return Motion.of([[Fraction(k) for k in row] for row in rows])


class _Converted(NamedTuple):
    """What OpenCASCADE made of a file: its words, triangles and how far off these are, unit, notes, true shape."""

    document: dict[str, Any]
    triangles: Surface
    chord: Float
    unit: Unit
    notes: tuple[str, ...]
    shape: Shape | None


def _converted(path: Path, coarser: float, *how: str) -> _Converted:
    if importlib.util.find_spec("OCP") is None:
        raise ReadError("STEP needs the package cadquery-ocp-novtk: pip install 'inertia[step]'", code="needs_package")
    with temporary_folder() as folder:
        source, left_out, unread, hidden = _by_itself(path, folder)
        _convert(source, folder, coarser, path.stat().st_size / 1e6, *how)
        document = json.loads((folder / "part.json").read_text())
        with np.load(folder / "arrays.npz", allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    if unread and not document["runs"]:
        raise ReadError(
            f"its {next(iter(unread))} is not read by OpenCASCADE: export the part with its faces", code="not_read"
        )
    unit = _unit(document["millimetres"])
    triangles, chord, notes = _stand_ins((arrays["vertices"], arrays["faces"], arrays["distances"]), coarser, unit.name)
    if left_out:
        notes.insert(0, f"{plural(left_out, 'file')} that it refers to {was(left_out)} left out")
    notes += _gaps(document["loose"], document["without_triangles"])
    notes += [f"{plural(n, kind)} {was(n)} left out: OpenCASCADE does not read {kind}" for kind, n in unread.items()]
    if hidden:
        notes.append(f"{plural(hidden, 'item')} marked as hidden (INVISIBILITY) {was(hidden)} counted where solid")
    if document["units"] > 1:
        notes.append(f"it has {document['units']} units of length, and was read in that of most shapes, {unit.name}")
    if document["faults"]:
        first = shown(document["faults"][0], 120)
        notes.append(
            f"OpenCASCADE left out what has a fault ({plural(len(document['faults']), 'fault')}, first {first})"
        )
    notes += _untrue(document["untrue"])
    shape = None if document["untrue"] else shape_from_json(document["shape"], arrays["numbers"])
    return _Converted(document, triangles, chord, unit, tuple(notes), shape)


def _stand_ins(
    arrays: tuple[Float, Int, Float], coarser: float, unit: str, kind: str = "STEP "
) -> tuple[Surface, Float, list[str]]:
    """Return triangles, how far they are off, and what is said of that."""
    vertices, faces, distances = arrays
    triangles = surface(vertices, faces)
    size = float(np.ptp(triangles.vertices, axis=0).max())
    # In proportion to an edge, OpenCASCADE asks for no more than half of this share of the whole shape.
    chord = np.where(np.isnan(distances), coarser**2 * _LINEAR * size, distances)
    chord += _ROUNDING * np.abs(triangles.vertices).max()
    if chord.max() <= _FLAT * size:
        return triangles, chord, []
    note = (
        f"for pictures, checks and cuts, triangles stand for curved {kind}faces: they turn by up to "
        f"{coarser * _ANGULAR:g} rad and are up to {chord.max():.2g} {unit} off (those of a cylinder lose "
        f"{coarser**2 * 1e-4:g} of its volume)"
    )
    return triangles, chord, [note]


def _gaps(loose: int, without_triangles: int) -> list[str]:
    """Say what was left out: pieces of wire, and faces that could not be meshed."""
    notes = [f"{plural(loose, 'piece')} of wire {was(loose)} left out"] if loose else []
    if count := without_triangles:
        notes.append(f"{plural(count, 'face')} could not be meshed and {was(count)} left out")
    return notes


def _untrue(fault: str | None) -> list[str]:
    return [f"its true shape cannot be stated ({shown(fault, 120)})"] if fault else []


def _unit(millimetres: float) -> Unit:
    """Return the unit of a size that has been rounded a few times."""
    for name in ("mm", "m", "in", "cm", "um", "ft", "dm", "nm", "km", "mil", "yd"):
        unit = length_unit(name)
        if math.isclose(float(unit.metres) * 1000, millimetres, rel_tol=1e-12):
            return unit
    return multiple_of(repr(millimetres), length_unit("mm"))


def _convert(source: Path, folder: Path, coarser: float, size: float, *how: str) -> None:
    """Convert a STEP file of so many MB in a process of its own."""
    seconds = _limit(SECONDS, _SECONDS + _SECONDS_A_MB * size)
    gib = _limit(GIB, _GIB + _GIB_A_MB * size)
    figures = (coarser**2 * _LINEAR, coarser * _ANGULAR, math.ceil(seconds), math.ceil(gib * 2**30), os.getpid())
    try:
        process = subprocess.run(
            [sys.executable, "-P", "-c", _CONVERT, str(source), str(folder), *map(str, figures), *how],
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},  # each thread takes of the memory
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
            f"be damaged; export the part as STL or 3MF, or set {SECONDS} to more",
            code="too_large",
        )
    if process.returncode and (
        _EXHAUSTED.search(process.stderr) or process.returncode == -getattr(signal, "SIGKILL", 0)
    ):
        raise ReadError(
            f"OpenCASCADE needs more than {gib:.3g} GiB of memory, the limit for a file of its size, or than there is: "
            f"it may be damaged; export the part as STL or 3MF, or set {GIB} to more",
            code="too_large",
        )
    if process.returncode and (full := _FULL.search(process.stderr)):
        raise ReadError(reason_of(OSError(int(full[1]), "")))
    refusal = folder / "refusal.txt"
    if refusal.is_file():
        raise ReadError(refusal.read_text())
    if process.returncode or not (folder / "part.json").is_file():
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


def _by_itself(path: Path, folder: Path) -> tuple[Path, int, Counter[str], int]:
    """Return a file without references to others, which OpenCASCADE would read from anywhere, and how many it had.

    With them come the solids of kinds that it passes over without a word, by their kind, and how many items are hidden.

    The entity that names a file (ISO 10303-41 `document_file`, also under its short name) is given a name of the same
    length that OpenCASCADE does not know; what refers to it is passed over.
    """
    stored = path.read_bytes()
    data = stored.removeprefix(BOM_UTF8)  # which OpenCASCADE does not know
    count = len(_REFERENCE.findall(data))
    unread = Counter(kind.decode().upper() for kind in _UNREAD.findall(data))
    hidden = sum(items.count(b"#") for items in _HIDDEN.findall(data))
    if not count and data == stored:
        return path.absolute(), 0, unread, hidden
    alone = folder / "part.step"
    alone.write_bytes(_REFERENCE.sub(lambda name: name[0][:-1] + b"_", data))
    return alone, count, unread, hidden
