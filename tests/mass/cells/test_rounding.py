"""Decimals of meshes of cells count as the file writes them: against fractions of the text, no bound is exceeded."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mass.test_rounding import Corners, random_corners, require_covered

import inertia
from inertia.errors import GeometryError

MIDDLES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
BIT = Fraction(2) ** -90


def gmsh_2(corners: Corners) -> str:
    nodes = "".join(f"{k} {' '.join(c)}\n" for k, c in enumerate(corners, 1))
    body = f"$Nodes\n4\n{nodes}$EndNodes\n$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n"
    return f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{body}"


def gmsh_4(corners: Corners) -> str:
    rows = [f"{' '.join(c)}" for c in corners]
    return (
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 4 1 4\n2 1 1 1\n1\n"
        f"{rows[0]} 0.3 0.7\n3 1 0 3\n2\n3\n4\n{rows[1]}\n{rows[2]}\n{rows[3]}\n$EndNodes\n"
        "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n"
    )


def vtk(corners: Corners, precision: str = "double") -> str:
    points = "".join(f"{' '.join(c)}\n" for c in corners)
    return (
        f"# vtk DataFile Version 3.0\npart\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 {precision}\n{points}"
        "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
    )


def vtu(corners: Corners) -> str:
    points = " ".join(word for c in corners for word in c)
    cells = "".join(
        f'<DataArray type="Int64" Name="{name}" format="ascii">{values}</DataArray>'
        for name, values in (("connectivity", "0 1 2 3"), ("offsets", "4"), ("types", "10"))
    )
    return (
        '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">'
        '<UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1"><Points>'
        f'<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>'
        f"<Cells>{cells}</Cells></Piece></UnstructuredGrid></VTKFile>"
    )


def abaqus(corners: Corners) -> str:
    nodes = "".join(f"{k}, {', '.join(c)}\n" for k, c in enumerate(corners, 1))
    return f"*NODE\n{nodes}*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n"


def medit(corners: Corners) -> str:
    points = "".join(f"{' '.join(c)} 0\n" for c in corners)
    return f"MeshVersionFormatted 2\nDimension 3\nVertices\n4\n{points}Tetrahedra\n1\n1 2 3 4 0\nEnd\n"


def su2(corners: Corners) -> str:
    points = "".join(f"{' '.join(c)} {k}\n" for k, c in enumerate(corners))
    return f"NDIME= 3\nNELEM= 1\n10 0 1 2 3 0\nNPOIN= 4\n{points}NMARK= 0\n"


FORMATS: dict[str, tuple[str, Callable[[Corners], str]]] = {
    "gmsh 2.2": ("msh", gmsh_2),
    "gmsh 4.1": ("msh", gmsh_4),
    "vtk": ("vtk", vtk),
    "vtu": ("vtu", vtu),
    "abaqus": ("inp", abaqus),
    "medit": ("mesh", medit),
    "su2": ("su2", su2),
}
EXACT = ["gmsh 2.2", "gmsh 4.1"]


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("accuracy", [None, 1e-12])
def test_no_bound_is_exceeded_by_what_the_text_writes(kind: str, accuracy: float | None, tmp_path: Path) -> None:
    rng = random.Random(f"{kind} {accuracy}")
    suffix, write = FORMATS[kind]
    file = tmp_path / f"part.{suffix}"
    answers = 0
    for _ in range(20):
        corners = random_corners(rng)
        file.write_text(write(corners))
        part = inertia.read(file)
        assert part.rounding is not None
        with contextlib.suppress(GeometryError):
            require_covered(part, [[Fraction(word) for word in corner] for corner in corners], accuracy)
            answers += 1
    assert answers > (15 if accuracy is None or kind in EXACT else 0)


@pytest.mark.parametrize("kind", FORMATS)
def test_a_small_corner_far_away_is_as_written(kind: str, tmp_path: Path) -> None:
    low, high = "1000000.1", "1000000.2"
    suffix, write = FORMATS[kind]
    file = tmp_path / f"part.{suffix}"
    file.write_text(write([(low, low, low), (high, low, low), (low, high, low), (low, low, high)]))
    plain = inertia.mass_properties(inertia.read(file, unit="mm"), accuracy=1e-3)
    assert plain.volume * 6e12 == pytest.approx(1.0, rel=1e-8)
    assert abs(plain.volume * 6e12 - 1) <= plain.error.volume
    assert plain.error.volume > 5e-10
    if kind in EXACT:
        fine = inertia.mass_properties(inertia.read(file, unit="mm"), accuracy=1e-15)
        assert Fraction(fine.volume) == Fraction(float(Fraction(1, 6 * 10**12)))
        assert fine.error.volume < 1e-15
    else:
        with pytest.raises(GeometryError, match="the file's decimals were rounded by up to"):
            inertia.mass_properties(inertia.read(file, unit="mm"), accuracy=1e-12)


@pytest.mark.parametrize("kind", FORMATS)
def test_decimals_that_float64_holds_are_taken_bit_for_bit(kind: str, tmp_path: Path) -> None:
    suffix, write = FORMATS[kind]
    file = tmp_path / f"part.{suffix}"
    file.write_text(
        write([("0.0", "0.0", "-2.5"), ("1.0", "0.0", "0.0"), ("0.0", "1.0", "0.0"), ("0.5", "0.0", "12.0")])
    )
    assert inertia.read(file).rounding is None


def test_points_that_a_file_declares_as_float32_are_off_by_as_much(tmp_path: Path) -> None:
    file = tmp_path / "part.vtk"
    corners: Corners = [("10.1", "0.1", "0.1"), ("11.3", "0.1", "0.1"), ("10.1", "0.7", "0.1"), ("10.1", "0.1", "0.9")]
    file.write_text(vtk(corners, "float"))
    part = inertia.read(file)
    assert part.rounding is not None
    assert part.rounding.distance > 4e-7
    require_covered(part, [[Fraction(word) for word in corner] for corner in corners], None)


def test_numbers_of_nastran_without_an_e_are_counted(tmp_path: Path) -> None:
    file = tmp_path / "part.bdf"
    grids = "GRID,1,,1.5-3,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n"
    file.write_text(f"BEGIN BULK\n{grids}CTETRA,1,1,1,2,3,4\nENDDATA\n")
    rounding = inertia.read(file).rounding
    assert rounding is not None
    assert rounding.distance > 1e-17


def test_binary_files_are_taken_bit_for_bit(tmp_path: Path) -> None:
    import meshio

    points = np.array([[0.1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    mesh = meshio.Mesh(points, [("tetra", np.array([[0, 1, 2, 3]]))])
    for name, kind in (("part.msh", "gmsh"), ("part.vtk", "vtk"), ("part.vtu", "vtu")):
        meshio.write(tmp_path / name, mesh, file_format=kind, binary=True)
        assert inertia.read(tmp_path / name).rounding is None


@pytest.mark.parametrize("seed", range(6))
def test_curved_cells_far_away_are_within_their_bounds(seed: int, tmp_path: Path) -> None:
    """Two cells of ten nodes, by regions: exact moments of the written numbers, from the determinant's polynomial."""
    rng = random.Random(seed)
    base = [(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    base += [tuple((a + b) / 2 for a, b in zip(base[i], base[j], strict=True)) for i, j in MIDDLES]
    far = 10.0 ** rng.uniform(0, 6)
    rows = [[f"{far + x + rng.uniform(-0.03, 0.03):.9f}" for x in point] for point in base]
    order = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]  # Gmsh's last two are the other way round
    nodes = "".join(f"{k} {' '.join(rows[at])}\n" for k, at in enumerate(order, 1))
    file = tmp_path / "part.msh"
    file.write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n{nodes}$EndNodes\n"
        "$Elements\n1\n1 11 2 7 7 1 2 3 4 5 6 7 8 9 10\n$EndElements\n"
    )
    true = tetra10_volume([[Fraction(word) for word in row] for row in rows])
    for options in ({}, {"accuracy": 1e-12}, {"density": {"7": 1.0}}):
        properties = inertia.mass_properties(inertia.read(file, unit="m"), **options)
        assert abs(Fraction(properties.volume) - true) <= Fraction(properties.error.volume) * true
        if "accuracy" in options:
            assert properties.error.volume < 1e-12


def tetra10_volume(points: list[list[Fraction]]) -> Fraction:
    """Return ∫ det J over the reference tetrahedron, by a rule that is exact for cubics (Stroud T3:3-1)."""
    total = Fraction(0)
    places = [(Fraction(1, 4),) * 4] + [
        tuple(Fraction(1, 2) if i == k else Fraction(1, 6) for i in range(4)) for k in range(4)
    ]
    for weight, l in zip([Fraction(-4, 5)] + [Fraction(9, 20)] * 4, places, strict=True):
        gradient = [(-1, -1, -1), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        slopes = [[(4 * l[i] - 1) * gradient[i][k] for k in range(3)] for i in range(4)]
        slopes += [[4 * (l[i] * gradient[j][k] + l[j] * gradient[i][k]) for k in range(3)] for i, j in MIDDLES]
        a, b, c = (
            [sum((s[k] * p[axis] for s, p in zip(slopes, points, strict=True)), Fraction(0)) for axis in range(3)]
            for k in range(3)
        )
        cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
        total += weight * sum((x * y for x, y in zip(a, cross, strict=True)), Fraction(0)) / 6
    return total


def test_a_mesh_of_many_cells_is_widened_by_its_outside_alone(tmp_path: Path) -> None:
    """The bound over what moving the outside can do is the same for coarse and fine meshes of one block."""
    import meshio
    from tests.mesh.checks.test_cells import grid

    bounds = []
    for steps in (2, 8):
        points, nodes = grid(steps, steps, steps)
        file = tmp_path / "part.vtk"
        meshio.write(file, meshio.Mesh(points / steps * 0.9 + 1000.1, [("hexahedron", nodes)]), binary=False)
        properties = inertia.mass_properties(inertia.read(file, unit="m"))
        bounds.append(properties.error.volume)
    assert bounds[1] == pytest.approx(bounds[0], rel=0.05)
    assert bounds[0] > 3e-13


def test_a_wire_is_as_long_as_its_file_writes_it(tmp_path: Path) -> None:
    file = tmp_path / "part.msh"
    start, end = "1000000.1", "1000000.3"
    file.write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 {start} 0 0\n2 {end} 0 0\n$EndNodes\n"
        "$Elements\n1\n1 1 0 1 2\n$EndElements\n"
    )
    true = (Fraction(end) - Fraction(start)) / 1000 * Fraction(1e-6)
    for accuracy in (None, 1e-15):
        properties = inertia.mass_properties(inertia.read(file, unit="mm"), wire=1.0, accuracy=accuracy)
        assert abs(Fraction(properties.volume) - true) <= Fraction(properties.error.volume) * true + BIT
    assert properties.error.volume < 1e-15
