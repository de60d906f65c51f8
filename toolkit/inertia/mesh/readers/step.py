"""STEP: OpenCASCADE, through cascadio, puts triangles in the place of the exact faces and writes GLB.

It runs in a process of its own, because a damaged file can end the process, and because it prints.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from inertia.errors import ReadError
from inertia.mesh.readers.contents import Contents
from inertia.mesh.readers.gltf import read_gltf

_LINEAR, _ANGULAR = 0.001, 0.05  # sag relative to the length of an edge, angle in radians
_SECONDS = 900
_CONVERT = """
import sys, cascadio
source, target, linear, angular = sys.argv[1:]
status = cascadio.step_to_glb(source, target, float(linear), float(angular), True, use_parallel=False)
sys.exit(status != 0)
"""


def read_step(path: Path, coarser: float = 1.0) -> Contents:
    """Read a STEP file as triangles, in metres, by so much coarser than usual; its solids are regions."""
    if importlib.util.find_spec("cascadio") is None:
        raise ReadError("STEP needs the package cascadio: pip install 'inertia[step]'")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "part.glb"
        arguments = [str(path.absolute()), str(target), str(coarser**2 * _LINEAR), str(coarser * _ANGULAR)]
        try:
            process = subprocess.run(
                [sys.executable, "-P", "-c", _CONVERT, *arguments],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                check=False,
                timeout=_SECONDS,
            )
        except subprocess.TimeoutExpired:
            raise ReadError(f"OpenCASCADE took longer than {_SECONDS} s: export the part as STL or 3MF") from None
        if process.returncode or not target.is_file():
            raise ReadError(f"OpenCASCADE cannot convert it (status {process.returncode}): export the part again")
        contents = read_gltf(target)
    note = (
        f"curved STEP faces were replaced by triangles that turn by up to {coarser * _ANGULAR:g} rad "
        f"(a cylinder loses {coarser**2 * 1e-4:g} of its volume), with float32 coordinates"
    )
    return replace(contents, notes=(*contents.notes, note))
