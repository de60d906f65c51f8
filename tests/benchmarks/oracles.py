"""What the figures of the README must be, by ways of their own: fractions, 50 digits, and geometry worked out here."""

from __future__ import annotations

import math
import struct
from collections import Counter
from functools import cache
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray
from tests.dynamics.models.free.free_oracle import angle, free_top, matrix

import inertia
from inertia_meshes import path

from .extremes.truth import Truth

DENSITY = 7850.0
SPIN, DURATION = (0.001, 10.0, 0.0), 60.0
"""Of the README's handle about its principal axes, rad/s, and for how long it is followed, s."""
Array = NDArray[np.float64]


def corners_of(name: str) -> Array:
    """Return the triangles (n, 3, 3) of a binary STL file, as stored."""
    data = path(name).read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    records = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("_", "<u2")]), count, 84)
    return records["corners"].astype(np.float64)


def rim(corners: Array) -> tuple[list[tuple[Any, Any]], int]:
    """Return the edges that no other triangle runs the other way, and the number of pieces that share vertices."""
    triangles = [[tuple(point) for point in triangle] for triangle in corners.tolist()]
    edges = Counter((t[k], t[k - 2]) for t in triangles for k in range(3))
    parent: dict[Any, Any] = {}

    def root(point: Any) -> Any:
        while (above := parent.setdefault(point, point)) != point:
            point = above
        return point

    for triangle in triangles:
        for point in triangle[1:]:
            parent[root(point)] = root(triangle[0])
    return [edge for edge in edges if edges[edge] != edges[edge[::-1]]], sum(root(p) == p for p in list(parent))


def loop(edges: list[tuple[Any, Any]]) -> tuple[float, Array]:
    """Return the length of edges and their centre."""
    ends = np.array(edges)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return float(lengths.sum()), lengths @ ends.mean(axis=1) / lengths.sum()


@cache
def handle() -> dict[str, Any]:
    """Return the figures of the T-handle in mm and kg, from fractions over its triangles, with 50 digits."""
    corners = corners_of("t_handle.stl")
    truth = Truth.of(corners)
    values, vectors = truth.spectrum
    volume = truth.moments.volume
    scale = DENSITY * 1e-15  # kg mm² per mm⁵, in kg m²
    mass = float(volume) * DENSITY * 1e-9
    with mpmath.workdps(50):
        largest = mpmath.mpf(truth.largest.numerator) / truth.largest.denominator
        moments = [value * largest * scale for value in values]
    axes = np.array([[float(vectors[i, k]) for k in range(3)] for i in range(3)])
    for k in (0, 2):  # the largest component of axis 1 and of axis 3 is positive
        axes[:, k] *= np.sign(axes[np.abs(axes[:, k]).argmax(), k])
    axes[:, 1] = np.cross(axes[:, 2], axes[:, 0])
    i = [float(moment) for moment in moments]
    edges, pieces = rim(corners)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return {
        "triangles": len(corners),
        "open edges": len(edges),
        "pieces": pieces,
        "size": np.ptp(corners.reshape(-1, 3), axis=0),
        "volume": float(volume),
        "area": 0.5 * math.fsum(np.linalg.norm(np.cross(u, v), axis=1).tolist()),
        "mass": mass,
        "centre": [float(x) for x in truth.moments.center_of_mass],
        "tensor": [[float(x) * scale for x in row] for row in truth.moments.inertia],
        "moments": i,
        "exact moments": moments,
        "axes": axes,
        "gyration": [math.sqrt(x / mass) for x in i],
        "semi-axes": [math.sqrt(2.5 / mass * (sum(i) - 2 * x)) for x in i],
        "truth": truth,
    }


def motion_error() -> tuple[float, float]:
    """Return the largest error of the attitude that the README's run has, rad, and what the run says that it is."""
    part = inertia.read(path("t_handle.stl"), unit="mm")
    body = inertia.SceneBody.of(inertia.mass_properties(part, material="steel", accuracy="exact"))
    run = inertia.simulate(inertia.Scene(body, inertia.Start(list(SPIN)), inertia.Settings(DURATION)))
    known = handle()
    rows = np.arange(0, len(run.time), 40)
    truth = free_top(known["exact moments"], list(SPIN), run.time[rows].tolist())
    turn = mpmath.matrix(np.array(body.axes).tolist())
    with mpmath.workdps(60):
        off = [
            angle(matrix(q), turn * true * turn.T)
            for q, (true, _) in zip(run.attitude[rows].tolist(), truth, strict=True)
        ]
    return max(off), float(run.error.reached)


def flip_period() -> float:
    """Return half the period of the spin about the intermediate axis: 2 K(m)/λ, s (Landau and Lifshitz, § 37)."""
    with mpmath.workdps(50):
        i, w = handle()["exact moments"], [mpmath.mpf(x) for x in SPIN]
        energy2 = mpmath.fsum(a * b * b for a, b in zip(i, w, strict=True))
        square = mpmath.fsum((a * b) ** 2 for a, b in zip(i, w, strict=True))
        i1, i2, i3 = i if square > energy2 * i[1] else i[::-1]
        rate = mpmath.sqrt((i3 - i2) * (square - energy2 * i1) / (i1 * i2 * i3))
        modulus = (i2 - i1) * (energy2 * i3 - square) / ((i3 - i2) * (square - energy2 * i1))
        return float(2 * mpmath.ellipk(modulus) / rate)


BEARINGS = 20.0, 280.0
RPM, GRADE = 3000.0, 6.3
HOLES = ((90.0, 210.0, 100.0, 10.0, 14.2), (215.0, 20.0, 80.0, 16.0, 12.4))
"""Of the rotor's plan: z, angle in degrees, radius, diameter, depth to the shoulder; mm."""
POINT, SIDES = 118.0, 256


def hole(radius: float, diameter: float, depth: float, degrees: float) -> tuple[float, float]:
    """Return mass and unbalance, g and g mm, of a radial hole into a prism of 256 sides: integrals over its width."""
    r, side = 0.5 * diameter, 2 * math.pi / SIDES
    across = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 4001)
    t = r * np.sin(across)
    turn = math.radians(degrees) + np.arctan2(t, np.sqrt(radius**2 - t**2))
    facet = (np.floor(turn / side) + 0.5) * side - math.radians(degrees)
    out = (radius * math.cos(0.5 * side) - t * np.sin(facet)) / np.cos(facet)
    chord, floor = 2 * r * np.cos(across), radius - depth
    height = r / math.tan(math.radians(0.5 * POINT))
    cone = math.pi * r**2 * height / 3
    volume = np.trapezoid(chord * (out - floor), t) + cone
    first = np.trapezoid(chord * (out**2 - floor**2) / 2, t) + cone * (floor - height / 4)
    return DENSITY * 1e-6 * float(volume), DENSITY * 1e-6 * float(first)


@cache
def rotor() -> tuple[float, Array, Array]:
    """Return mass in g, Σ m (x, y) in g mm and Σ m (x, y) z in g mm², of the rotor as modelled."""
    moments = Truth.of(corners_of("two_disc_rotor.stl")).moments
    grams = DENSITY * 1e-6
    _, _, _, yz, zx, _ = moments.second
    x, y, _ = moments.first
    return (
        float(moments.volume) * grams,
        np.array([float(x), float(y)]) * grams,
        np.array([float(zx), float(yz)]) * grams,
    )


def residual(turn: float = 0.0, deeper: tuple[float, float] = (0, 0), wider: tuple[float, float] = (0, 0)) -> Array:
    """Return the unbalance (2,) left in the bearings' planes, g mm, with holes turned, deeper and wider."""
    _, first, second = rotor()
    for k, (z, degrees, radius, diameter, depth) in enumerate(HOLES):
        _, unbalance = hole(radius, diameter + wider[k], depth + deeper[k], degrees)
        angle = math.radians(degrees + turn)
        taken = unbalance * np.array([math.cos(angle), math.sin(angle)])
        first, second = first - taken, second - z * taken
    low, high = BEARINGS
    at_high = (second - low * first) / (high - low)
    return np.linalg.norm([first - at_high, at_high], axis=1)


def limits() -> Array:
    """Return the permissible residual unbalance of the bearings' planes, g mm: G m/ω, shared by the centre's place."""
    corners = Truth.of(corners_of("two_disc_rotor.stl")).moments
    centre = float(corners.center_of_mass[2])
    total = GRADE * rotor()[0] / (RPM * math.pi / 30)
    low, high = BEARINGS
    return total * np.array([high - centre, centre - low]) / (high - low)


def share_within(draws: int = 2000) -> float:
    """Return the share of rotors within both limits, where zero mark, depths and diameters scatter evenly."""
    rng, most = np.random.default_rng(0), limits()
    inside = 0
    for turn, *rest in rng.uniform(-1, 1, (draws, 5)).tolist():
        left = residual(0.5 * turn, (0.1 * rest[0], 0.1 * rest[1]), (0.05 * rest[2], 0.05 * rest[3]))
        inside += bool((left < most).all())
    return inside / draws
