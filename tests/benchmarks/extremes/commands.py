"""Single parts at the edge of what has an answer, each written to a file and asked about on the command line."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
from tests.mesh.prisms import moments
from tests.mesh.self_crossing import hairpin, ring, spring

from inertia_meshes import rational
from inertia_meshes.shapes import Corners, box, flipped, mapped, moved

from .cases import ball

_TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
_NODES = 20  # of the hexahedron


@dataclass(frozen=True, eq=False)
class Question:
    """A part, the name of its file, and what `inertia` is asked; `volume` is the true one, if there is one."""

    part: str
    name: str
    content: bytes
    options: tuple[str, ...] = ()
    volume: Fraction | None = None


def questions() -> Iterator[Question]:
    """Yield every part with its question; coordinates are in millimetres, as the command assumes."""
    yield _solid("a ball 10 diameters away", "away.ply", _ball() + 10, "--accuracy", "1e-15")
    yield _solid("the same 1e8 diameters away", "far.ply", _ball() + 1e8, "--accuracy", "1e-15")
    thin = [moved(mapped(box(1, 1e-7, 1e-7), _TURN), 0, 4 * k, 0)[:, [1, 2, 0]] for k in range(2)]
    yield _solid("two slanted bars of 1 × 1e-7 × 1e-7", "bars.ply", np.concatenate(thin))
    inward = flipped(mapped(box(1, 1e-9, 1e-9), _TURN))
    turned = _volume(flipped(inward))
    yield Question(
        "a bar of 1 × 1e-9 × 1e-9, inside out", "bar.ply", _ply(inward), ("--orientation", "absolute"), turned
    )
    plate = mapped(box(1, 1, 1e-12), _TURN)
    yield _solid("a slanted plate of 1 × 1 × 1e-12, nothing asked for", "plate.ply", plate)
    yield Question(
        "a ball's surface as a shell", "shell.ply", _ply(_ball()), ("--shell", "0.125", "--accuracy", "1.2e-16")
    )
    yield Question(
        "a hexahedron of 20 nodes with curved edges", "brick.vtk", _curved_brick(), ("--accuracy", "1.2e-16")
    )
    yield Question("a pentagram, extruded: its shell crosses itself", "pentagram.ply", _ply(_pentagram()))
    yield Question(
        "a box from 1000000.1 to 1000000.2, in decimals",
        "decimals.obj",
        _decimals("1000000.1", "1000000.2"),
        ("--accuracy", "1e-15"),
        Fraction(1, 1000),
    )
    ball_in_decimals, volume = _far_ball()
    yield Question(
        "the ball 1e8 diameters away, in decimals", "far.obj", ball_in_decimals, ("--accuracy", "1e-15"), volume
    )
    low, high = "1000000.1", "1000000.2"
    corner = [(low, low, low), (high, low, low), (low, high, low), (low, low, high)]
    yield Question(
        "a tetrahedron from 1000000.1 to 1000000.2, in decimals of Gmsh",
        "decimals.msh",
        _gmsh(corner, 4, [range(4)]),
        ("--accuracy", "1e-15"),
        Fraction(1, 6000),
    )
    tetra = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    two = [*tetra, *([x + 0.125 for x in point] for point in tetra)]
    yield Question("two tetrahedra that share space", "two.msh", _gmsh(two, 4, [range(4), range(4, 8)]))
    yield Question("a hexahedron inside a block of 64", "inside.msh", _block_with_a_brick_inside())
    yield Question("a hexahedron of 20 nodes that folds beside its corner", "folded.msh", _folded_brick())
    cube = moved(box(1, 1, 1), -0.5, 0.5, 0)
    cubes = np.concatenate([cube, mapped(cube, [[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])])
    order = np.argsort(cubes[:, :, 2].mean(axis=1), kind="stable")
    yield Question("two cubes, one turned about a shared edge, sorted by height", "edge.ply", _ply(cubes[order]))
    for power in (12, 15):
        walls = np.concatenate([_ball(), flipped(_ball() * (1 - 10.0**-power))])
        yield _solid(f"a ball with a wall of 1e-{power} of its size", f"wall{power}.ply", walls)
    sunk = 1 - 4e-7
    stack = np.concatenate([moved(box(1, 1, 1), 0, 0, -0.5), moved(box(1, 1, 1), 0, 0, sunk - 0.5)])
    union = _volume(stack) + Fraction(float(stack[12:, :, 2].min()))
    yield Question("a cube that is sunk 4e-7 into another; their union", "sunk.ply", _ply(stack), (), union)
    yield Question("the same, united", "sunk.ply", _ply(stack), ("--union",), union)
    speck = moved(box(1e-5, 1e-5, 1e-5), 3, 0, 0)
    yield Question(
        "a cube beside an inverted one of 1e-5",
        "speck.ply",
        _ply(np.concatenate([cube, flipped(speck)])),
        (),
        Fraction(1),
    )
    pin = _fitted(32)
    yield _solid("a pin in its bore, its facets turned", "pin.ply", pin, "--parts", "separate", "--chord", "0.01")
    middles = _ball().mean(axis=1)
    far = np.argsort(np.linalg.norm(middles - middles[0], axis=1), kind="stable")[24:]
    patched = Question(
        "a ball without 24 of its triangles, filled", "hole.ply", _ply(_ball()[np.sort(far)]), ("--repair",)
    )
    yield replace(patched, volume=_volume(_ball()))
    yield from _unions(cubes)
    cracked = box(1.0, 1.0, 1.0).copy()
    cracked[0, 0] += 1e-15
    yield Question("a cube with a crack of 1e-15", "crack.ply", _ply(cracked))


def _unions(turned: Corners) -> Iterator[Question]:
    """Yield parts that count places more than once, of which the union is asked for."""
    union = ("--union",)
    star = [(float(x), float(y)) for x, y in _pentagram()[:5, 0, :2]]
    yield Question("the pentagram", "pentagram.ply", _ply(_pentagram()), union, moments([(star, 0, 1)])["1"])
    for name, part, (vertices, faces), volume in (
        ("hairpin", "a bent bar whose end goes through its beginning", hairpin(6.0), Fraction(70)),
        ("ring", "a ring whose ends overlap", ring(6.6), _ring_volume(6.6)),
        ("spring", "a spring whose coils overlap", spring(1.7), None),
    ):
        yield Question(part, f"{name}.ply", _ply(vertices[faces]), union, volume)
    squares = [[(x, y) for x, y, _ in bottom] for bottom in (_bottom(turned[:12]), _bottom(turned[12:]))]
    volume = moments([(square, 0, 1) for square in squares])["1"]
    yield Question("the two cubes, one turned about a shared edge", "edge.ply", _ply(turned), union, volume)
    inside = [moved(box(size, size, size), place, place, place) for size, place in ((4, 0), (1, 0.5), (2, 1))]
    yield Question(
        "two inserts in a cube, one on a corner of the other",
        "inserts.ply",
        _ply(np.concatenate(inside)),
        union,
        Fraction(64),
    )
    cutter = flipped(moved(box(1, 1, 1), 1, 0, 0))
    cut = np.concatenate([box(2, 2, 2), cutter])
    yield Question("a cutter that faces inward and sticks out", "cutter.ply", _ply(cut), union, Fraction(15, 2))


def _bottom(corners: Corners) -> list[tuple[float, float, float]]:
    """Return the lowest corners of an upright prism, around their middle."""
    points = np.unique(corners.reshape(-1, 3), axis=0)
    points = points[points[:, 2] == points[:, 2].min()]
    x, y, _ = (points - points.mean(axis=0)).T
    return [(float(a), float(b), float(c)) for a, b, c in points[np.argsort(np.arctan2(y, x))]]


def _ring_volume(turn: float) -> Fraction:
    sections = ring(turn)[0].reshape(-1, 4, 3)[:, :2, :2].tolist()
    return moments([([*here, *there[::-1]], -1, 1) for here, there in pairwise(sections)])["1"]


def measured_command(question: Question, folder: Path) -> dict[str, Any]:
    """Return the command, its exit code, and the answer's volume, error and bounds, or the sentence that refuses."""
    (folder / question.name).write_bytes(question.content)
    command = ["analyse", question.name, *question.options]
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys; from inertia_cli.main import main; sys.exit(main(sys.argv[1:]))",
            *command,
            "--json",
        ],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    row: dict[str, Any] = {"part": question.part, "command": " ".join(["inertia", *command]), "code": done.returncode}
    if done.returncode:
        return row | {"sentence": done.stderr.strip().splitlines()[-1].removeprefix("inertia: ")}
    answer = json.loads(done.stdout)
    if question.volume is not None:
        true = question.volume / 10**9
        row["error"] = _short(abs(float((Fraction(answer["volume"]) - true) / true)))
    error = answer["error"].get("repair", answer["error"])
    row |= {name: _short(error[name]) for name in ("volume", "inertia")}
    row["centre"] = _short(error.get("center_of_mass_pair", error["center_of_mass"]))
    doubts = "".join(f"; in doubt: {doubt['code'].replace('_', ' ')}" for doubt in answer.get("doubts", []))
    return row | {"method": error["method"] + doubts}


def _short(value: float) -> float:
    return float(f"{value:.1e}")


def _solid(part: str, name: str, corners: Corners, *options: str) -> Question:
    return Question(part, name, _ply(corners), options, _volume(corners))


def _volume(corners: Corners) -> Fraction:
    return rational.moments(corners).volume


def _ball() -> Corners:
    vertices, faces = ball()
    return vertices[faces]


def _fitted(sides: int) -> Corners:
    """Return a disc with a bore of half its radius, and a pin whose facets are turned by half of one."""
    step = 2 * np.pi / sides
    inner, outer, pin = (
        radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        for radius, angle in (
            (1, step * np.arange(sides)),
            (2, step * np.arange(sides)),
            (1, step * (np.arange(sides) + 0.5)),
        )
    )
    up = np.array([0, 0, 1.0])
    (a, b, c, d), (e, f, g, h), (i, j), (k, m) = (
        [turn(ring + height) for ring in rings for height in (0 * up, up)]
        for rings in ((inner, outer), (pin,))
        for turn in (lambda points: points, lambda points: np.roll(points, -1, axis=0))
    )
    low, high = np.zeros((sides, 3)), np.zeros((sides, 3)) + up
    disc = [(a, f, e), (a, b, f), (c, g, h), (c, h, d), (b, h, f), (b, d, h), (a, e, g), (a, g, c)]
    rod = [(k, i, low), (j, m, high), (i, k, m), (i, m, j)]
    return np.concatenate([np.stack(face, axis=1) for face in [*disc, *rod]])


def _pentagram() -> Corners:
    """Return a prism over the five-pointed star that is drawn without lifting the pen."""
    angle = 4 * np.pi * np.arange(5) / 5
    low = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    up, middle = np.array([0, 0, 1]), np.zeros((5, 3))
    along = np.roll(low, -1, axis=0)
    high, after, top = low + up, along + up, middle + up
    sides = ((low, along, high), (high, along, after), (middle, along, low), (top, high, after))
    return np.concatenate([np.stack(side, axis=1) for side in sides])


def _ply(corners: Corners) -> bytes:
    """Return a binary file, in which the coordinates stand as they are: decimals would round them once more."""
    points, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = np.zeros(len(corners), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, numbers.reshape(-1, 3)
    coordinates = "".join(f"property double {axis}\n" for axis in "xyz")
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{coordinates}"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    return head.encode() + points.astype("<f8").tobytes() + faces.tobytes()


def _decimals(low: str, high: str) -> bytes:
    """Return a cube as text, its coordinates as they are given."""
    corners = box(1, 1, 1)
    points, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    lines = [f"v {' '.join(low if x < 0 else high for x in point)}" for point in points.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.reshape(-1, 3).tolist()]
    return "\n".join(lines).encode()


def _curved_brick() -> bytes:
    corners = [(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    ring = [(0, 1), (1, 2), (2, 3), (3, 0)]
    edges = [*ring, *((a + 4, b + 4) for a, b in ring), *((k, k + 4) for k in range(4))]
    nodes = np.array([*corners, *(np.mean([corners[a], corners[b]], axis=0) for a, b in edges)], float)
    # Coordinates whose decimals float64 holds: those of VTK's text are not read exactly.
    nodes += np.round(2**10 * 0.05 * np.sin(7.0 * np.arange(3 * _NODES))).reshape(-1, 3) / 2**10
    points = "\n".join(f"{x!r} {y!r} {z!r}" for x, y, z in nodes.tolist())
    numbers = " ".join(map(str, range(_NODES)))
    return (
        f"# vtk DataFile Version 3.0\nbrick\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {_NODES} double\n{points}\n"
        f"CELLS 1 {_NODES + 1}\n{_NODES} {numbers}\nCELL_TYPES 1\n25\n"
    ).encode()


def _far_ball() -> tuple[bytes, Fraction]:
    """Return a ball 1e8 diameters away as text with twelve digits after the point, and its volume."""
    whole = np.rint(_ball() * 1e12)
    points, faces = np.unique(whole.reshape(-1, 3), axis=0, return_inverse=True)
    lines = [f"v {' '.join(str(Decimal(10**20 + int(x)).scaleb(-12)) for x in point)}" for point in points.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.reshape(-1, 3).tolist()]
    return "\n".join(lines).encode(), _volume(whole) / 10**36


def _gmsh(points: Sequence[Sequence[float | str]], kind: int, cells: Sequence[Sequence[int]]) -> bytes:
    """Return cells of one of Gmsh's types as text."""
    nodes = "\n".join(f"{k} {' '.join(map(str, point))}" for k, point in enumerate(points, 1))
    rows = "\n".join(f"{k} {kind} 0 {' '.join(str(node + 1) for node in cell)}" for k, cell in enumerate(cells, 1))
    return (
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(points)}\n{nodes}\n$EndNodes\n"
        f"$Elements\n{len(cells)}\n{rows}\n$EndElements\n"
    ).encode()


def _bricks(steps: int) -> tuple[list[list[float]], list[list[int]]]:
    """Return the points and hexahedra of a cube of `steps`³ cubes."""
    side = steps + 1
    points = [[float(x), float(y), float(z)] for x in range(side) for y in range(side) for z in range(side)]
    at = {tuple(point): k for k, point in enumerate(points)}
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    cubes = product(range(steps), repeat=3)
    return points, [[at[x + a, y + b, z + c] for a, b, c in corners] for x, y, z in cubes]


def _block_with_a_brick_inside() -> bytes:
    points, bricks = _bricks(4)
    inner, (brick,) = _bricks(1)
    points += [[x / 2 + 1.25 for x in point] for point in inner]
    return _gmsh(points, 5, [*bricks, [node + 125 for node in brick]])


def _folded_brick() -> bytes:
    """Return a hexahedron of 20 nodes, one middle node pulled in: at all corners and Gauss points it looks sound."""
    corners = [(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    edges = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)]
    nodes = [*corners, *(np.mean([corners[a], corners[b]], axis=0).tolist() for a, b in edges)]
    nodes[8] = [0.0, 0.25, 0.25]
    return _gmsh(nodes, 17, [list(range(_NODES))])
