"""Sample parts with known exact answers, scenes to let them move in, rotors to balance and readings of them.

`catalogue()` tells of each file what it is, the exact answer of the true solid and that of the stored mesh.
The files are written by `python -m inertia_meshes.make`.
"""

from __future__ import annotations

import json
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path
from typing import Any

__all__ = ["assemblies", "catalogue", "jobs", "names", "path", "robots", "rotors", "scenes"]

_FOLDER = Path(str(files(__name__)))


def catalogue() -> dict[str, dict[str, Any]]:
    """Return what is known of each sample, by file name.

    Each entry has its `unit` and number of `triangles` and, where they apply:

    * `description`, the number of `bodies` and, of a volume mesh, of `cells`;
    * `closed_form`: volume, center_of_mass and inertia of the true solid in SI units for a density of 1 kg/m³
      (the inertia about the centre of mass, with tensor signs), and the formula with its source;
    * `mesh`: the same three of the mesh as stored, in powers of the file's unit, correctly rounded;
    * `parts`: density (kg/m³) and both answers of each named part;
    * `assembly`: mass, center_of_mass and inertia of the true parts with these densities, in SI units;
    * `wrong`: what is wrong with a broken sample.

    >>> catalogue()["cube.stl"]["mesh"]["volume"]
    1000.0
    """
    text = (_FOLDER / "catalogue.json").read_text(encoding="utf-8")
    samples: dict[str, dict[str, Any]] = json.loads(text)["samples"]
    return samples


def names() -> tuple[str, ...]:
    """Return the file names of the samples, such as `"t_handle.stl"` and `"broken/nan.stl"`."""
    return tuple(catalogue())


def scenes() -> tuple[str, ...]:
    """Return the file names of the sample scenes, such as `"scenes/t_handle.toml"`."""
    return _in_folder("scenes")


def rotors() -> tuple[str, ...]:
    """Return the file names of the sample rotors, such as `"rotors/two_disc_rotor.toml"`."""
    return _in_folder("rotors")


def jobs() -> tuple[str, ...]:
    """Return the file names of the sample balancing jobs, such as `"jobs/fan.toml"`."""
    return _in_folder("jobs")


def assemblies() -> tuple[str, ...]:
    """Return the file names of the sample assemblies, such as `"assemblies/fan.toml"`."""
    return _in_folder("assemblies")


def robots() -> tuple[str, ...]:
    """Return the file names of the sample robots, such as `"robots/arm.urdf"`."""
    return _in_folder("robots", "*.urdf")


def _in_folder(folder: str, pattern: str = "*.toml") -> tuple[str, ...]:
    return tuple(sorted(f"{folder}/{file.name}" for file in (_FOLDER / folder).glob(pattern)))


def path(name: str) -> Path:
    """Return where the sample with this file name lies; raise `KeyError` for an unknown one.

    >>> path("t_handle.stl").name
    't_handle.stl'
    """
    known = (*names(), *scenes(), *rotors(), *jobs(), *robots(), *assemblies())
    if name not in known:
        close = get_close_matches(name, known, n=3, cutoff=0.5)
        hint = f"did you mean {' or '.join(close)}" if close else f"use one of {', '.join(known)}"
        raise KeyError(f"there is no sample part {name!r}: {hint}")
    return _FOLDER / name
