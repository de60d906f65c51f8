"""What the two sides of an edge leave open: ruled strips that close the faces of a solid, and what stays uncertain.

The two faces at an edge end in curves of their own, a gap g apart, seldom exactly in one. A ruled strip from each curve
to the mean of both makes the surface closed, so that its integrals do not depend on the origin. The true edge is
where the surfaces meet, at an angle θ: no farther than g/sin θ, or than the tolerance e that the file states where they
are almost tangent. Between the surfaces and the strip lies at most the area g/2 · min(g/sin θ, max(e, g)), on each
unit of length: it is of second order in the gap, but for tangent faces. What the strips leave open at a corner, of
gap g, has an area of at most g².
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mass.shapes import splines
from inertia.mass.shapes.faces import DIFFERENCE, NODES, WEIGHTS, flux, walk
from inertia.mass.shapes.surfaces import surface_jets
from inertia.mesh.shape import Face, Trim
from inertia.records import dataclass

_STRIP = ((0.5 - 0.5 / 3**0.5, 0.5), (0.5 + 0.5 / 3**0.5, 0.5))  # Gauss's rule of two points on 0 to 1
_POINT = 1e-6  # of the size, that an edge is long at most which has one side, as at a pole
_APART = 1e-4  # of the size, that the sides of an edge may be apart, if the file does not state more
_TOLERANCES = 10.0  # times what it states
_SINGULAR = 1e-12


@dataclass(frozen=True, eq=False)
class Closing:
    """What closes the edges of a solid.

    Attributes
    ----------
    values, errors : (11,) integrals over the strips, and how far they may be off
    volumes, places : (k,) and (k, 3), what volume stays uncertain, and where
    areas : (k,) what area stays uncertain, at the same places
    gap : the largest distance between two sides
    """

    values: Float
    errors: Float
    volumes: Float
    areas: Float
    places: Float
    gap: float


@dataclass(frozen=True, eq=False)
class _Sides:
    """The sides of all edges, at places that they share, 21 on each piece.

    For each side of each place (n,): the numbers of the `trim`, of its `edge` and of the `place`; the `sign` with which
    the face, seen from outside, runs along the edge, and the `weight` of its integral, signed; `points`, their `rates`
    of change along the edge, by the share of its range, and `normals` outward (n, 3). `trims` holds (face, trim).
    """

    trims: list[tuple[Face, Trim]]
    trim: Int
    edge: Int
    place: Int
    weight: Float
    sign: Float
    points: Float
    rates: Float
    normals: Float

    @classmethod
    def of(cls, faces: Sequence[Face]) -> _Sides:
        trims = [(face, trim) for face in faces for loop in face.loops for trim in loop if trim.edge >= 0]
        grids = _grids([trim for _, trim in trims])
        columns = []
        number = 0
        for face in faces:
            outward = -1.0 if face.inward else 1.0
            own = tuple(trim for loop in face.loops for trim in loop if trim.edge >= 0)
            shares, halves, places = (np.concatenate(k) for k in zip(*(grids[trim.edge] for trim in own), strict=True))
            which = np.repeat(np.arange(len(own)), [len(grids[trim.edge][0]) for trim in own])
            ends = np.array([[trim.start, trim.stop] for trim in own])
            low, span = ends.min(axis=1)[which], np.abs(ends[:, 1] - ends[:, 0])[which]
            sign = outward * np.where(ends[:, 1] >= ends[:, 0], 1.0, -1.0)[which]
            uv, rate = walk(own, which, low + span * shares)
            x, xu, xv = surface_jets(face.patch, uv[:, 0], uv[:, 1])
            normal = outward * np.cross(xu, xv)
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            pace = span[:, None] * (xu * rate[:, :1] + xv * rate[:, 1:])
            weight = sign * halves * np.tile(WEIGHTS, len(sign) // 21)
            columns.append((number + which, places, weight, sign, x, pace, normal / np.where(length > 0, length, 1.0)))
            number += len(own)
        trim, place, weight, sign, points, rates, normals = (np.concatenate(k) for k in zip(*columns, strict=True))
        edge = np.array([trim.edge for _, trim in trims])[trim]
        return cls(trims, trim, edge, place, weight, sign, points, rates, normals)


def _grids(trims: Sequence[Trim]) -> dict[int, tuple[Float, Float, Int]]:
    """Return for each edge the places that its sides share: shares of their ranges, half the pieces', and numbers."""
    knots: dict[int, list[Float]] = {}
    for trim in trims:
        low, high = sorted((trim.start, trim.stop))
        inner = np.empty(0) if trim.curve.spline is None else splines.breaks(trim.curve.spline, 0, low, high)
        knots.setdefault(trim.edge, []).append((inner - low) / (high - low) if high > low else inner)
    grids, first = {}, 0
    for edge, several in knots.items():
        cuts = np.unique(np.concatenate([[0.0], *several]))
        cuts = np.append(cuts[np.append(True, np.diff(cuts) > 1e-12) & (cuts < 1.0 - 1e-12)], 1.0)
        half = 0.5 * np.diff(cuts)
        shares = (cuts[:-1] + half)[:, None] + half[:, None] * NODES
        grids[edge] = shares.ravel(), np.repeat(half, 21), first + np.arange(shares.size)
        first += shares.size
    return grids


def closing(faces: Sequence[Face], tolerances: Float, size: float, *, surface: bool = False) -> Closing:
    """Close the gaps at the edges of a solid; or look at them, with `surface`, which may be open.

    Parameters
    ----------
    faces : about an origin near the solid
    tolerances : (e,) of the edges
    size : the largest distance from that origin

    Raises `EdgeError` where an edge has one side only, or sides that are far apart or run the same way.
    """
    sides = _Sides.of(faces)
    count = np.bincount(sides.place)
    balance = np.bincount(sides.place, sides.sign)
    mean, pace = _mean(sides.points, sides.place, count), _mean(sides.rates, sides.place, count)
    stated = tolerances[sides.edge]
    lone = count[sides.place] == 1
    if lone.any() and not surface:
        _close_poles(sides, lone, stated, mean, pace, size)
    if not surface and (unlike := (balance[sides.place] != 0) & ~lone).any():
        raise _fault(sides, unlike, "run the same way along an edge: they do not face alike")
    across, change = mean[sides.place] - sides.points, pace[sides.place] - sides.rates
    strips = np.zeros((len(across), 11))
    for s, share in _STRIP:
        strips += share * flux(np.stack([sides.points + s * across, across, sides.rates + s * change]))
    by_piece = (sides.weight / np.tile(WEIGHTS, len(across) // 21) * np.tile(DIFFERENCE, len(across) // 21))[
        :, None
    ] * strips
    distance = np.linalg.norm(across, axis=1)
    gaps, allowed, steps = np.zeros((3, len(count)))
    np.maximum.at(gaps, sides.place, 2.0 * distance)
    np.maximum.at(allowed, sides.place, stated)
    np.maximum.at(steps, sides.place, np.abs(sides.weight) * np.linalg.norm(sides.rates, axis=1))
    far = gaps[sides.place] > np.maximum(_TOLERANCES * stated, _APART * size)
    if far.any():
        worst = float(gaps[sides.place][far].max())
        raise _fault(sides, far, f"are up to {worst:.2g} apart at an edge, and the file allows {stated[far].max():.2g}")
    half = np.minimum(0.5 * np.linalg.norm(_mean(sides.normals, sides.place, np.ones_like(count)), axis=1), 1.0)
    sine = np.where(count == 2, 2.0 * half * np.sqrt(1.0 - half * half), 0.0)
    reach = np.minimum(gaps / np.maximum(sine, _SINGULAR), np.maximum(allowed, gaps))
    ends = np.flatnonzero(np.diff(sides.trim, prepend=-1) | np.diff(sides.trim, append=-1))
    corners = 4.0 * distance[ends] ** 2
    return Closing(
        np.einsum("n,nc->c", sides.weight, strips),
        np.abs(by_piece.reshape(-1, 21, 11).sum(axis=1)).sum(axis=0),
        np.concatenate([0.5 * gaps * reach * steps, corners * size]),
        np.concatenate([np.where(count == 1, allowed, gaps) * steps, corners]),
        np.concatenate([mean, sides.points[ends]]),
        float(gaps.max(initial=0.0)),
    )


def _mean(values: Float, place: Int, count: Int) -> Float:
    columns = [np.bincount(place, values[:, k]) for k in range(3)]
    mean: Float = np.stack(columns, axis=1) / count[:, None]
    return mean


def _close_poles(sides: _Sides, lone: Bool, stated: Float, mean: Float, pace: Float, size: float) -> None:
    """Draw edges with one side together to a point, which they must be."""
    for trim in np.unique(sides.trim[lone]):
        some = np.flatnonzero(sides.trim == trim)
        middle = sides.points[some].mean(axis=0)
        width = float(np.abs(sides.points[some] - middle).max())
        if width > max(_POINT * size, float(_TOLERANCES * stated[some[0]])):
            which = np.zeros_like(lone)
            which[some] = True
            raise _fault(sides, which, "has no other face beside it: the solid is open")
        mean[sides.place[some]], pace[sides.place[some]] = middle, 0.0


def _fault(sides: _Sides, which: Bool, what: str) -> EdgeError:
    edge = sides.edge[which][0]
    numbers = {sides.trims[k][0].number for k in np.unique(sides.trim[sides.edge == edge])}
    return EdgeError(what, sides.points[which][0], sorted(numbers))


class EdgeError(Exception):
    """What is wrong with the faces of these numbers at a `place` (3,), about the origin that they have."""

    def __init__(self, what: str, place: Float, numbers: Sequence[int]) -> None:
        super().__init__(what)
        self.place, self.numbers = place, numbers
