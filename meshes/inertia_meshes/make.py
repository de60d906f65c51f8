"""Write every sample part and the catalogue: `python -m inertia_meshes.make [FOLDER]`.

The files are the same bytes on every run. FOLDER is by default where the package lies.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np

from inertia_meshes import closed_forms, formats, shapes, solids
from inertia_meshes.entries import Entry, assembly, entry
from inertia_meshes.solids import Solid

Sample = tuple[str, bytes, Entry]
"""A file's name, its bytes, and what the catalogue says of it."""

_TABLE = "Wikipedia, List of moments of inertia"
_SLICES = "integrated over slices across the axis"
_DENSITIES = {"shaft": 7850, "impeller": 2700, "1": 7850, "2": 2700}


def main() -> None:
    """Write the samples into the folder named on the command line."""
    parser = argparse.ArgumentParser(prog="python -m inertia_meshes.make", description="Write the sample parts.")
    parser.add_argument("folder", nargs="?", type=Path, default=Path(__file__).parent)
    write(parser.parse_args().folder)


def write(folder: Path) -> None:
    """Write every sample and `catalogue.json` into `folder`, which is made if need be."""
    (folder / "broken").mkdir(parents=True, exist_ok=True)
    entries = []
    for name, content, about in (*_solids(), *_assemblies(), *_broken()):
        (folder / name).write_bytes(content)
        lines = (f'   "{key}": {json.dumps(value, ensure_ascii=False)}' for key, value in about.items())
        entries.append(f'  "{name}": {{\n' + ",\n".join(lines) + "\n  }")
    text = '{"schema": "inertia/samples/1",\n "samples": {\n' + ",\n".join(entries) + "\n}}\n"
    (folder / "catalogue.json").write_text(text, encoding="utf-8", newline="\n")


def _solids() -> Iterator[Sample]:
    cube = solids.box(10, 10, 10)
    yield _stl("cube", cube, "cube of edge 10 centred at the origin", "I = m a²/6", _TABLE)
    yield (
        "cube_ascii.stl",
        formats.ascii_stl(_stored(cube).corners, "cube"),
        entry("the cube as ASCII STL", _stored(cube), 1, "I = m a²/6", _TABLE),
    )
    box = solids.box(40, 20, 10, (20, 10, 5))
    yield _stl("box", box, "box 40 × 20 × 10 with a corner at the origin", "Ixx = m (b² + c²)/12", _TABLE)
    yield _stl(
        "tetrahedron",
        Solid(shapes.corner_tetrahedron(30, 20, 10), closed_forms.corner_tetrahedron(30, 20, 10)),
        "tetrahedron with corners at the origin and at 30, 20 and 10 on the axes",
        "V = abc/6, ∫x² = V a²/10, ∫xy = V ab/20 about the origin",
        "Tonon, J. Math. Stat. 1 (2005) 8–11",
    )
    yield _stl("sphere", solids.sphere(20, 48), "ball of radius 20", "I = 2/5 m R²", _TABLE)
    yield _stl(
        "ellipsoid",
        solids.ellipsoid(30, 20, 10, 48),
        "ellipsoid with semi-axes 30, 20, 10",
        "V = 4/3 π abc, Ixx = m (b² + c²)/5",
        _TABLE,
    )
    yield _stl(
        "cone",
        solids.revolution([(0, 0), (10, 0), (0, 30)], 96),
        "cone of radius 10 and height 30 on z = 0",
        "V = π R² h/3, z = h/4, Izz = 3/10 m R², Ixx = 3/20 m R² + 3/80 m h²",
        _TABLE,
    )
    yield _stl(
        "hollow_sphere",
        solids.hollow_ball(20, 16, (0, 0, 0), 48),
        "ball of radius 20 with a concentric cavity of radius 16, whose surface faces inwards",
        "I = 2/5 m (R⁵ − r⁵)/(R³ − r³)",
        _TABLE,
    )
    yield _stl(
        "sphere_cavity",
        solids.hollow_ball(20, 8, (6, 4, 2), 48),
        "ball of radius 20 with a cavity of radius 8 about (6, 4, 2), whose surface faces inwards",
        "ball minus ball, by Steiner's theorem",
        _TABLE,
    )
    yield _stl(
        "torus",
        solids.torus(20, 5, 72),
        "torus about z, ring radius 20, tube radius 5",
        "V = 2π² R r², Izz = m (R² + 3/4 r²), Ixx = m (R²/2 + 5/8 r²)",
        _TABLE,
    )
    yield _stl(
        "t_handle",
        solids.t_handle(48),
        "T-handle: cube of edge 10, round arms 8 × 25 along ±x, round stem 8 × 20 along −z; asymmetric",
        "box and three cylinders that share faces only, by Steiner's theorem",
        _TABLE,
    )
    yield _stl(
        "thin_plate",
        solids.box(128, 96, Fraction(1, 8)),
        "plate 128 × 96 × 0.125",
        "Ixx = m (b² + c²)/12",
        _TABLE,
    )
    yield _stl(
        "needle",
        solids.revolution([(0, 0), (Fraction(1, 4), 0), (Fraction(1, 4), 120), (0, 128)], 48),
        "needle along z: cylinder of radius 0.25 and length 120 with a conical tip of length 8",
        "cylinder and cone, by Steiner's theorem",
        _TABLE,
    )
    yield _stl(
        "disc",
        solids.revolution([(0, -1), (32, -1), (32, 1), (0, 1)], 128),
        "disc of radius 32 and thickness 2 about z, centred at the origin",
        "Izz = m R²/2, Ixx = m (3R² + h²)/12",
        _TABLE,
    )
    yield _stl(
        "spinning_top",
        solids.revolution([(0, 0), (4, 4), (24, 16), (24, 22), (4, 28), (3, 44), (0, 44)], 96),
        "spinning top about z with its tip at the origin",
        "conical frusta: V = π∫r² dz, Izz = π/2 ∫r⁴ dz, Ixx = Izz/2 + π∫r²z² dz − V z²",
        _SLICES,
    )
    yield _stl(
        "bent_wheel",
        solids.bent_wheel(96),
        "wheel turned from z towards x by asin(40/401) on a straight axle along z; Ixz is not zero",
        "wheel of revolution, Ixz = (Ip − It) sin cos, and two obliquely cut cylinders",
        _SLICES,
    )
    yield _stl(
        "two_disc_rotor",
        solids.two_disc_rotor(256),
        "shaft 30 × 300 along z, discs 200 × 20 at z 80–100 and 160 × 30 at z 200–230, axial holes of"
        " diameter 10 at radius 70, 30° through the first disc and 12 at radius 60, 200° through the second",
        "solid of revolution minus two cylinders, by Steiner's theorem",
        _SLICES,
    )


def _assemblies() -> Iterator[Sample]:
    # Six decimals are short in the file and far below the tessellation's own error.
    parts = {
        name: Solid(np.round(solid.corners, 6) + 0.0, solid.true)
        for name, solid in (("shaft", solids.impeller_shaft(96)), ("impeller", solids.impeller(96)))
    }
    yield (
        "shaft_impeller.obj",
        formats.obj({name: part.corners for name, part in parts.items()}, "shaft and impeller, mm"),
        assembly(
            "steel shaft and aluminium impeller, objects `shaft` and `impeller`, which touch along faces",
            parts,
            _DENSITIES,
            "frusta, and six boxes around the axis, by Steiner's theorem",
            _SLICES,
        ),
    )
    section = ((0, 0), (10, 0), (10, 10), (0, 10))
    points = np.array([(x, y, z) for x in (0, 5, 20, 30, 40) for y, z in section], np.float64)
    cells = np.arange(8) + 4 * np.arange(4)[:, None]
    about = assembly(
        "bar 40 × 10 × 10 along x of four hexahedra; region 1 (steel) to x = 20, 2 (aluminium) beyond",
        {"1": solids.box(20, 10, 10, (10, 5, 5)), "2": solids.box(20, 10, 10, (30, 5, 5))},
        _DENSITIES,
        "two boxes, by Steiner's theorem",
        _TABLE,
    )
    yield (
        "two_region_bar.vtk",
        formats.vtk_hexahedra(points, cells, "region", (1, 1, 2, 2), "bar of two regions, mm"),
        about | {"triangles": 0, "cells": len(cells)},
    )


def _broken() -> Iterator[Sample]:
    cube = solids.box(10, 10, 10).corners
    flipped = cube.copy()
    flipped[4] = cube[4, ::-1]
    nan = cube.copy()
    nan[4, 1, 2] = np.nan
    sheet = cube[cube[:, :, 2].min(axis=1) == 5]
    cases = (
        ("missing_face", np.delete(cube, 4, axis=0), "cube without its triangle 4: three open edges"),
        ("flipped_face", flipped, "cube whose triangle 4 is wound the other way"),
        ("inside_out", shapes.flipped(cube), "cube whose triangles all face inwards"),
        ("nan", nan, "cube with z of corner 1 of triangle 4 not a number"),
        (
            "zero_volume",
            np.concatenate([sheet, shapes.flipped(sheet)]),
            "square with two sides and no thickness",
        ),
    )
    for name, corners, wrong in cases:
        content = formats.binary_stl(corners, f"inertia sample {name}, mm")
        yield f"broken/{name}.stl", content, {"unit": "mm", "triangles": len(corners), "wrong": wrong}
    content = formats.binary_stl(cube, "inertia sample truncated, mm")[:-230]
    wrong = "cube whose file ends within triangle 7 of 0 to 11"
    yield "broken/truncated.stl", content, {"unit": "mm", "triangles": len(cube), "wrong": wrong}

    half = Fraction(1, 2)
    one, other = solids.box(1, 1, 1), solids.box(1, 1, 1, (half, half, half))
    shared = solids.box(half, half, half, (half / 2, half / 2, half / 2))
    union = Solid(np.concatenate([one.corners, other.corners]), one.true + other.true - shared.true)
    description = "two unit cubes, one shifted by half an edge along x, y and z; closed_form is their union"
    formula = "cube + cube − shared cube, by Steiner's theorem"
    name, content, about = _stl("broken/overlapping_cubes", union, description, formula, _TABLE, bodies=2)
    yield name, content, about | {"wrong": "the cubes overlap in an eighth of their volume"}


def _stl(name: str, solid: Solid, description: str, formula: str, source: str, bodies: int = 1) -> Sample:
    stored = _stored(solid)
    content = formats.binary_stl(stored.corners, f"inertia sample {Path(name).name}, mm")
    return f"{name}.stl", content, entry(description, stored, bodies, formula, source)


def _stored(solid: Solid) -> Solid:
    """The solid with corners as an STL file holds them, without negative zeros."""
    return Solid(solid.corners.astype(np.float32).astype(np.float64) + 0.0, solid.true)


if __name__ == "__main__":
    main()
