"""Decimals count as the file writes them: against fractions of the text, no bound is exceeded."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import (
    INSTANCE_3DXML,
    PART_3DXML,
    archive_3mf,
    dae,
    geometry_dae,
    glb,
    gltf_tree,
    model_3mf,
    representation_3dxml,
    three_dxml,
    visual_xaml,
    xaml,
)

import inertia
from inertia.errors import GeometryError
from inertia.mesh.part import Rounding
from inertia.units import length_unit

TETRA = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
Corners = list[tuple[str, str, str]]


def obj(corners: Corners) -> str:
    return "".join(f"v {' '.join(c)}\n" for c in corners) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in TETRA)


def off(corners: Corners) -> str:
    faces = "".join(f"3 {a} {b} {c}\n" for a, b, c in TETRA)
    return f"OFF\n4 4 0\n{''.join(' '.join(c) + chr(10) for c in corners)}{faces}"


def ply(corners: Corners) -> str:
    header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty uchar red\nproperty float x\nproperty float y\n"
    header += "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    rows = "".join(f"7 {' '.join(c)}\n" for c in corners)
    return header + rows + "".join(f"3 {a} {b} {c}\n" for a, b, c in TETRA)


def stl(corners: Corners) -> str:
    facets = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {' '.join(corners[k])}\n" for k in face)
        + "endloop\nendfacet\n"
        for face in TETRA
    ]
    return f"solid vertex 1 2 3\n{''.join(facets)}endsolid vertex 1 2 3\n"


FORMATS: dict[str, Callable[[Corners], str]] = {"obj": obj, "off": off, "ply": ply, "stl": stl}


def true_tetrahedron(corners: list[list[Fraction]]) -> tuple[Fraction, list[Fraction], list[list[Fraction]]]:
    """Return volume, centroid and inertia tensor about it, for a density of one: S = V/20 Σ (v − c)(v − c)ᵀ."""
    a, b, c = ([p - q for p, q in zip(corners[k], corners[0], strict=True)] for k in (1, 2, 3))
    cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
    volume = sum((p * q for p, q in zip(a, cross, strict=True)), Fraction(0)) / 6
    center = [sum(column, Fraction(0)) / 4 for column in zip(*corners, strict=True)]
    arms = [[p - q for p, q in zip(corner, center, strict=True)] for corner in corners]
    s = [[volume / 20 * sum((arm[i] * arm[j] for arm in arms), Fraction(0)) for j in range(3)] for i in range(3)]
    trace = s[0][0] + s[1][1] + s[2][2]
    return volume, center, [[(trace if i == j else 0) - s[i][j] for j in range(3)] for i in range(3)]


def require_covered(part: inertia.Part, corners: list[list[Fraction]], accuracy: float | str | None) -> None:
    """Compare with the tetrahedron in fractions."""
    properties = inertia.mass_properties(part, 1.0, accuracy=accuracy)
    unit = part.unit.metres
    volume, center, tensor = true_tetrahedron([[unit * x for x in corner] for corner in corners])
    error = properties.error
    assert abs(Fraction(properties.volume) - volume) <= Fraction(error.volume) * volume
    squares = sum((Fraction(float(p)) - q) ** 2 for p, q in zip(properties.center_of_mass, center, strict=True))
    assert squares <= Fraction(error.center_of_mass) ** 2
    off = sum((Fraction(float(properties.inertia[i, j])) - tensor[i][j]) ** 2 for i in range(3) for j in range(3))
    assert off <= Fraction(error.inertia) ** 2 * sum(k * k for row in tensor for k in row)
    if accuracy == "exact" and part.rounding is not None:
        share = part.rounding.distance / float(np.ptp(part.triangles.corners(), axis=(0, 1)).max())
        assert error.volume < 1.2e-16 + 2e-9 * share
        assert error.inertia < 3e-16 + 2e-8 * share


def random_corners(rng: random.Random) -> Corners:
    """Return decimals of a tetrahedron that is right-handed, of any size and place."""
    size, far = 10.0 ** rng.uniform(-3, 4), 10.0 ** rng.uniform(-3, 7)
    style = rng.choice("fe")
    digits = rng.randint(4, 20) if style == "f" else rng.randint(12, 20)
    place = [rng.uniform(-far, far) for _ in range(3)]
    while True:
        corners = [tuple(f"{x + size * rng.uniform(-1, 1):.{digits}{style}}" for x in place) for _ in range(4)]
        volume, _, _ = true_tetrahedron([[Fraction(word) for word in corner] for corner in corners])
        if volume < 0:
            corners[0], corners[1] = corners[1], corners[0]
        if abs(volume) > Fraction(size / 30) ** 3:
            return corners  # type: ignore[return-value]


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("accuracy", [None, 1e-12, "exact"])
def test_no_bound_is_exceeded_by_what_the_text_writes(kind: str, accuracy: float | str | None, tmp_path: Path) -> None:
    rng = random.Random(f"{kind} {accuracy}")
    file = tmp_path / f"part.{kind}"
    rounded = 0
    for _ in range(60):
        corners = random_corners(rng)
        file.write_text(FORMATS[kind](corners))
        part = inertia.read(file)
        rounded += part.rounding is not None
        with contextlib.nullcontext() if accuracy == "exact" else contextlib.suppress(GeometryError):
            require_covered(part, [[Fraction(word) for word in corner] for corner in corners], accuracy)
    assert rounded > 50


@pytest.mark.parametrize("kind", FORMATS)
def test_a_small_box_far_away_is_as_written(kind: str, tmp_path: Path) -> None:
    low, high = "1000000.1", "1000000.2"
    corners = [(low, low, low), (high, low, low), (low, high, low), (low, low, high)]
    file = tmp_path / f"part.{kind}"
    file.write_text(FORMATS[kind](corners))
    part = inertia.read(file)
    plain = inertia.mass_properties(part, accuracy=1e-3)
    assert plain.volume * 6e12 == pytest.approx(1.0, rel=2e-9)
    assert abs(plain.volume * 6e12 - 1) <= plain.error.volume
    assert plain.error.volume > 5e-10
    for accuracy in (None, "exact"):
        properties = inertia.mass_properties(part, accuracy=accuracy)
        assert Fraction(properties.volume) == Fraction(float(Fraction(1, 6 * 10**12)))
        assert properties.error.volume < 2e-15


@pytest.mark.parametrize("far", ["1e8", "1e10", "1e11"])
@pytest.mark.parametrize("kind", FORMATS)
def test_digits_that_no_float64_holds_are_answered_where_asked(kind: str, far: str, tmp_path: Path) -> None:
    """A part of one unit, 1e8 to 1e11 units away: most of its shape is in what reading rounds."""
    rng = random.Random(f"{kind} {far}")
    file = tmp_path / f"part.{kind}"
    for _ in range(5):
        base = [(0.1, 0.2, 0.3), (1.3, 0.1, 0.2), (0.2, 1.4, 0.1), (0.3, 0.2, 1.2)]
        corners = [
            tuple(str(int(float(far)) + int(x)) + f"{x % 1 + rng.uniform(0, 0.01):.12f}"[1:] for x in corner)
            for corner in base
        ]
        file.write_text(FORMATS[kind](corners))
        part = inertia.read(file, unit="m")
        written = [[Fraction(word) for word in corner] for corner in corners]
        require_covered(part, written, 1e-15)
        assert inertia.mass_properties(part, 1.0, accuracy=1e-15).error.volume <= 1e-15


@pytest.mark.parametrize("text", ["0.5", "3", "-1.25e2", "8388608.5", "0.000", "7.5E-01", "1e3"])
def test_decimals_that_float64_holds_are_taken_bit_for_bit(text: str, tmp_path: Path) -> None:
    corners = [("0", "0", "0"), ("1", "0", "0"), ("0", "1", "0"), (text, "0", "2.5")]
    file = tmp_path / "part.obj"
    file.write_text(obj(corners))
    assert inertia.read(file).rounding is None


@pytest.mark.parametrize("text", ["0.1", "1e-3", "0.50000000000000000001", "9007199254740993", "1e-40"])
def test_decimals_that_float64_rounds_are_counted(text: str, tmp_path: Path) -> None:
    corners = [("0", "0", "0"), ("1", "0", "0"), ("0", "1", "0"), (text, "0", "2.5")]
    file = tmp_path / "part.obj"
    file.write_text(obj(corners))
    rounding = inertia.read(file).rounding
    assert rounding is not None
    assert rounding.remainder is not None
    true = Fraction(text) - Fraction(float(text))
    assert rounding.remainder()[3].tolist() == [float(true), 0, 0]
    assert abs(true) <= rounding.distance


def test_a_file_that_has_changed_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "part.obj"
    file.write_text(obj([("0", "0", "0"), ("0.1", "0", "0"), ("0", "0.1", "0"), ("0", "0", "0.1")]))
    part = inertia.read(file)
    file.write_text(obj([("0", "0", "0"), ("0.1", "0", "0"), ("0", "0.1", "0"), ("0", "0", "0.2")]))
    with pytest.raises(inertia.ReadError, match=r"part\.obj a second time: it has changed"):
        inertia.mass_properties(part, accuracy="exact")


Matrix = list[list[str]]
"""Three rows of four decimals."""


def random_matrix(rng: random.Random, digits: int = 9) -> Matrix:
    """Return a placement of an ordinary kind: turned, scaled a little, far away."""
    far = 10.0 ** rng.uniform(0, 6)
    quaternion = np.array([rng.gauss(0, 1) for _ in range(4)])
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return [[*(f"{1.3 * k:.{digits}f}" for k in row), f"{rng.uniform(-far, far):.3f}"] for row in turn]


def put(corners: list[list[Fraction]], matrix: Matrix) -> list[list[Fraction]]:
    rows = [[Fraction(word) for word in row] for row in matrix]
    return [[a * x + b * y + c * z + d for a, b, c, d in rows] for x, y, z in corners]


WRITTEN = ["0.1", "12.3", "-7.35", "31.4159", "0.001", "9.99"]


def written_corners(rng: random.Random) -> Corners:
    while True:
        corners = [tuple(rng.choice(WRITTEN) for _ in range(3)) for _ in range(4)]
        volume, _, _ = true_tetrahedron([[Fraction(word) for word in corner] for corner in corners])
        if volume > 10:
            return corners  # type: ignore[return-value]


def columns(matrix: Matrix) -> str:
    return " ".join(row[k] for k in range(4) for row in matrix)


def in_3mf(corners: Corners, inner: Matrix, outer: Matrix) -> bytes:
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in corners)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in TETRA)
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    resources = f'<object id="1" type="model">{mesh}</object><object id="2" type="model"><components>'
    resources += f'<component objectid="1" transform="{columns(inner)}"/></components></object>'
    return archive_3mf(model_3mf(resources, f'<item objectid="2" transform="{columns(outer)}"/>', "millimeter"))


def in_dae(corners: Corners, inner: Matrix, outer: Matrix) -> bytes:
    def node(matrix: Matrix, inside: str) -> str:
        return f"<node><matrix>{' '.join(word for row in matrix for word in row)} 0 0 0 1</matrix>{inside}</node>"

    text = dae(geometry_dae(corners=np.array(corners, float), faces=TETRA), "{nodes}")
    return text.replace("{nodes}", node(outer, node(inner, '<instance_geometry url="#box"/>'))).encode()


def in_xaml(corners: Corners, inner: Matrix, outer: Matrix) -> bytes:
    def rows(matrix: Matrix) -> str:
        return " ".join(word for k in range(4) for word in (*(row[k] for row in matrix), "1" if k == 3 else "0"))

    text = visual_xaml(np.array(corners, float), TETRA, rows(inner))
    place = f'<ModelVisual3D.Transform><MatrixTransform3D Matrix="{rows(outer)}"/></ModelVisual3D.Transform>'
    return xaml(f"<ModelVisual3D>{place}{text}</ModelVisual3D>").encode()


def in_3dxml(corners: Corners, inner: Matrix, outer: Matrix) -> bytes:
    parts = PART_3DXML + '<Reference3D id="10" name="pair"/>'
    parts += INSTANCE_3DXML.format(id=11, owner=10, target=2, matrix=columns(inner))
    parts += INSTANCE_3DXML.format(id=13, owner=1, target=10, matrix=columns(outer))
    face = f'triangles="{" ".join(str(k) for face in TETRA for k in face)}"'
    numbers = np.array(corners, float)
    return three_dxml(parts, representation_3dxml(numbers, face=face))


SCENES = {"3mf": in_3mf, "dae": in_dae, "xaml": in_xaml, "3dxml": in_3dxml}


@pytest.mark.parametrize("kind", SCENES)
@pytest.mark.parametrize("accuracy", [None, "exact"])
def test_no_bound_is_exceeded_by_where_a_scene_puts_a_body(kind: str, accuracy: str | None, tmp_path: Path) -> None:
    rng = random.Random(f"{kind} {accuracy}")
    file = tmp_path / f"part.{kind}"
    for _ in range(30):
        corners, inner, outer = written_corners(rng), random_matrix(rng), random_matrix(rng)
        file.write_bytes(SCENES[kind](corners, inner, outer))
        true = put(put([[Fraction(word) for word in corner] for corner in corners], inner), outer)
        part = inertia.read(file)
        assert part.rounding is not None
        if kind in ("xaml", "3dxml", "dae"):  # trimesh keeps no text: the bounds alone
            part = replace(part, unit=length_unit("mm"))
            require_covered(part, true, None)
        else:
            require_covered(part, true, accuracy)


def test_ordinary_placements_of_3mf_are_exact_where_asked(tmp_path: Path) -> None:
    corners: Corners = [("0", "0", "0"), ("1", "0", "0"), ("0", "1", "0"), ("0", "0", "1")]
    far = [["1", "0", "0", "1000000.1"], ["0", "1", "0", "0.1"], ["0", "0", "1", "-3.3"]]
    still = [["1", "0", "0", "0"], ["0", "1", "0", "0"], ["0", "0", "1", "0"]]
    file = tmp_path / "part.3mf"
    file.write_bytes(in_3mf(corners, still, far))
    properties = inertia.mass_properties(inertia.read(file), accuracy="exact")
    assert properties.volume == float(Fraction(1, 6 * 10**9))
    with pytest.raises(GeometryError, match=r"decimals were rounded by up to \S+ mm when it was read"):
        inertia.mass_properties(replace(inertia.read(file), rounding=Rounding(1e-9)), accuracy=1e-12)
    file.write_bytes(in_3mf(corners, still, still))
    assert inertia.read(file).rounding is None


@pytest.mark.parametrize("accuracy", [None, "exact"])
def test_nodes_of_gltf_are_placed_as_written(accuracy: str | None, tmp_path: Path) -> None:
    rng = random.Random(f"glb {accuracy}")
    points = np.array([[0, 0, 0], [1.1, 0.1, 0], [0.3, 1.7, 0], [0.2, 0.3, 1.9]], np.float32)
    file = tmp_path / "part.glb"
    for _ in range(30):
        matrix = random_matrix(rng)
        quaternion = [round(rng.gauss(0, 1), 5) for _ in range(4)]
        scale, shift = (
            [round(rng.uniform(0.5, 2), 4) for _ in range(3)],
            [round(rng.gauss(0, 1e4), 3) for _ in range(3)],
        )
        outer = [float(row[k]) for k in range(4) for row in [*matrix, ["0", "0", "0", "1"]]]
        nodes = [
            {"children": [1], "matrix": outer},
            {"mesh": 0, "rotation": quaternion, "scale": scale, "translation": shift},
        ]
        file.write_bytes(glb(*gltf_tree(points, TETRA, nodes)))
        x, y, z, w = (Fraction(repr(k)) for k in quaternion)
        n = x * x + y * y + z * z + w * w
        turn = [
            [w * w + x * x - y * y - z * z, 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), w * w - x * x + y * y - z * z, 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), w * w - x * x - y * y + z * z],
        ]
        s, t = ([Fraction(repr(k)) for k in values] for values in (scale, shift))
        inner = [
            [sum((turn[i][j] / n * s[j] * Fraction(float(p[j])) for j in range(3)), t[i]) for i in range(3)]
            for p in points
        ]
        require_covered(
            inertia.read(file), put(inner, [[repr(float(word)) for word in row] for row in matrix]), accuracy
        )


def test_a_shells_bound_covers_what_the_text_writes(tmp_path: Path) -> None:
    """A right triangle far away: the area is half the product of its legs, and the mass lies in its middle."""
    rng = random.Random(5)
    file = tmp_path / "sheet.obj"
    for _ in range(30):
        x, y = (f"{rng.uniform(1e5, 1e7):.3f}" for _ in range(2))
        a, b = (f"{float(k) + rng.uniform(1, 50):.3f}" for k in (x, y))
        file.write_text(f"v {x} {y} 0.1\nv {a} {y} 0.1\nv {x} {b} 0.1\nf 1 2 3\n")
        properties = inertia.mass_properties(inertia.read(file, unit="m"), 1.0, shell=1.0)
        area = (Fraction(a) - Fraction(x)) * (Fraction(b) - Fraction(y)) / 2
        assert abs(Fraction(properties.volume) - area) <= Fraction(properties.error.volume) * area
        middle = ((2 * Fraction(x) + Fraction(a)) / 3, (2 * Fraction(y) + Fraction(b)) / 3, Fraction("0.1"))
        off = sum((Fraction(float(p)) - q) ** 2 for p, q in zip(properties.center_of_mass, middle, strict=True))
        assert off <= Fraction(properties.error.center_of_mass) ** 2
