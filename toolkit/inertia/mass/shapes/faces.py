"""Integrals over a trimmed face, by Green's theorem from its trimming curves, with adaptive Gauss–Kronrod quadrature.

Over the domain D of a face's parameters, to the left of its loops,

    ∫∫_D g du dv = ∮ G v' dt  with  ∂G/∂u = g,  and likewise  −∮ H u' dt  with  ∂H/∂v = g.

The inner antiderivative is closed where g permits it. On cylinders, cones, spheres, tori and all that is turned about
an axis, g is a trigonometric polynomial of degree three in u: seven samples determine it. On planes and extrusions it
is a polynomial of degree two in v. On splines it is a polynomial on each span of knots, of degree 5p − 1 in u, for
which Gauss's rule is exact; on rational ones and offsets it is integrated by Gauss's and Kronrod's rules, span by span.

The outer integrals run over pieces on which the integrand is smooth, by the 21-point rule of Kronrod; the 10-point
rule of Gauss within it says how far that may be off, and pieces are halved until it says little.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import GeometryError
from inertia.mass.moments import PAIRS
from inertia.mass.shapes import splines
from inertia.mass.shapes.surfaces import curve_jets, inner_of, profile_of, root, surface_jets
from inertia.mesh.shape import Face, Patch, Spline, Trim
from inertia.records import dataclass

Integrand = Callable[[Float], Float]
"""Jets (3, n, 3) of points → values (n, 11) for each unit of du dv."""

# R. Piessens et al., QUADPACK, Springer 1983: the rules of routine QK21, from the outermost node to the middle.
_NODES = (
    0.995657163025808080735527280689003, 0.973906528517171720077964012084452, 0.930157491355708226001207180059508,
    0.865063366688984510732096688423493, 0.780817726586416897063717578345042, 0.679409568299024406234327365114874,
    0.562757134668604683339000099272694, 0.433395394129247190799265943165784, 0.294392862701460198131126602103866,
    0.148874338981631210884826001129720, 0.0,
)  # fmt: skip
_KRONROD = (
    0.011694638867371874278064396062192, 0.032558162307964727478818972459390, 0.054755896574351996031381300244580,
    0.075039674810919952767043140916190, 0.093125454583697605535065465083366, 0.109387158802297641899210590325805,
    0.123491976262065851077958109585166, 0.134709217311473325928054001771707, 0.142775938577060080797094273138717,
    0.147739104901338491374841515972068, 0.149445554002916905664936468389821,
)  # fmt: skip
_GAUSS = (
    0.066671344308688137593568809893332, 0.149451349150580593145863396957658, 0.219086362515982043995534934228163,
    0.269266719309996355091226921569469, 0.295524224714752870173815619188769,
)  # fmt: skip
NODES = np.array([-k for k in _NODES] + list(_NODES[-2::-1]))
WEIGHTS = np.array([*_KRONROD, *_KRONROD[-2::-1]])
_COARSE = np.zeros(21)
_COARSE[1:11:2] = _GAUSS
_COARSE[11:21] = _COARSE[9::-1]
DIFFERENCE = WEIGHTS - _COARSE

_QUARTER = 0.5 * math.pi * (1 + 1e-9)
_CROSSING_SAMPLES = 16
_LEAST, _POINTS = 256, 1 << 24  # pieces of the loops of a face that are always allowed, and points of more of them
_FINEST = 64  # parts of a span of knots, in the inner integral
_CHUNK = 1 << 15
_ANGLES = 2.0 * math.pi / 7.0 * np.arange(7)
_WAVES = np.arange(1, 4)
_BY_PIECE = ("trim", "start", "stop", "parts", "values", "outer", "inner")


def flux(jets: Float) -> Float:
    """Return for each unit of du dv the flux x · m of f(x) x/(3 + k), f of degree k: 1, x, y, z, xx, ..., and |m|."""
    x, xu, xv = jets
    m = _cross(xu, xv)
    w = (x * m).sum(axis=1)
    values = np.empty((len(x), 11))
    values[:, 0] = w / 3.0
    values[:, 1:4] = x * (0.25 * w)[:, None]
    for k, (i, j) in enumerate(PAIRS):
        values[:, 4 + k] = 0.2 * w * x[:, i] * x[:, j]
    values[:, 10] = np.sqrt((m * m).sum(axis=1))
    return values


def sheet(jets: Float) -> Float:
    """Return for each unit of du dv the moments of the surface itself: |m|, x|m|, ..., xx|m|, ..., and |m| again."""
    x, xu, xv = jets
    m = _cross(xu, xv)
    area = np.sqrt((m * m).sum(axis=1))
    values = np.empty((len(x), 11))
    values[:, 0] = values[:, 10] = area
    values[:, 1:4] = x * area[:, None]
    for k, (i, j) in enumerate(PAIRS):
        values[:, 4 + k] = area * x[:, i] * x[:, j]
    return values


def _cross(a: Float, b: Float) -> Float:
    result = np.empty_like(a)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        result[:, k] = a[:, i] * b[:, j] - a[:, j] * b[:, i]
    return result


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of the loops of a face, and the integrals along them.

    Attributes
    ----------
    trim : (n,) number of the trim
    start, stop : (n,) its parameters
    parts : (n,) into how many parts the inner integral cuts each span of knots
    values : (n, 11)
    outer, inner : (n, 11) how far the outer and the inner rule may be off
    sizes : (11,) sums of the magnitudes that were added up
    """

    trim: Int
    start: Float
    stop: Float
    parts: Int
    values: Float
    outer: Float
    inner: Float
    sizes: Float

    @property
    def errors(self) -> Float:
        """How far each integral may be off, (n, 11)."""
        return self.outer + self.inner

    def subset(self, which: Int) -> Pieces:
        """Return some of the pieces."""
        return replace(self, **{name: getattr(self, name)[which] for name in _BY_PIECE})


@dataclass(frozen=True, eq=False)
class Domain:
    """A face, ready to be integrated: its trims in one row, and from where its antiderivative counts."""

    patch: Patch
    trims: tuple[Trim, ...]
    base: float
    low: float
    high: float
    integrand: Integrand
    exact: bool  # whether Gauss's rule of the degree is, along spans of knots

    @classmethod
    def of(cls, face: Face, integrand: Integrand) -> tuple[Domain, Pieces]:
        """Return the domain of a face and the pieces to begin with."""
        trims = tuple(trim for loop in face.loops for trim in loop)
        pieces = [_cuts(face.patch, trim) for trim in trims]
        trim = np.concatenate([np.full(len(cuts) - 1, k) for k, cuts in enumerate(pieces)])
        start, stop = (np.concatenate([cuts[side] for cuts in pieces]) for side in (slice(None, -1), slice(1, None)))
        axis = 1 if inner_of(face.patch) == "straight" else 0
        t = 0.5 * (start + stop)[:, None] + 0.5 * (stop - start)[:, None] * NODES
        uv, _ = walk(trims, np.repeat(trim, 21), t.ravel())
        low, high = float(uv[:, axis].min()), float(uv[:, axis].max())
        base = low if inner_of(face.patch) == "spline" else 0.5 * (low + high)
        spline = root(face.patch).spline
        exact = face.patch.kind == "spline" and spline is not None and spline.weights is None and integrand is flux
        domain = cls(face.patch, trims, base, low, high, integrand, exact)
        across = np.array([k.curve.kind == "line" and k.curve.frame[1, 1 - axis] == 0 for k in trims])[trim]
        empty = np.zeros((0, 11))
        begin = Pieces(trim, start, stop, np.ones_like(trim), empty, empty, empty, np.zeros(11))
        return domain, replace(
            begin, trim=trim[~across], start=start[~across], stop=stop[~across], parts=begin.parts[~across]
        )

    def integrated(self, pieces: Pieces) -> Pieces:
        """Return the pieces with their integrals; `sizes` grow by theirs."""
        n = len(pieces.trim)
        values, outer, inner = np.zeros((3, n, 11))
        sizes = pieces.sizes.copy()
        for first in range(0, n, step := max(1, _CHUNK // (21 * self._cost(pieces)))):
            some = slice(first, first + step)
            half = 0.5 * (pieces.stop[some] - pieces.start[some])
            t = (0.5 * (pieces.start[some] + pieces.stop[some]))[:, None] + half[:, None] * NODES
            uv, rates = walk(self.trims, np.repeat(pieces.trim[some], 21), t.ravel())
            g, off = self._antiderivative(uv[:, 0], uv[:, 1], np.repeat(pieces.parts[some], 21))
            rate = -rates[:, :1] if inner_of(self.patch) == "straight" else rates[:, 1:]
            g, off = ((k * rate).reshape(len(half), 21, 11) * half[:, None, None] for k in (g, off))
            values[some] = np.einsum("k,nkc->nc", WEIGHTS, g)
            outer[some] = np.abs(np.einsum("k,nkc->nc", DIFFERENCE, g))
            inner[some] = np.einsum("k,nkc->nc", WEIGHTS, np.abs(off))
            sizes += np.einsum("k,nkc->c", WEIGHTS, np.abs(g))
        if not (np.isfinite(values).all() and np.isfinite(outer).all() and np.isfinite(inner).all()):
            raise GeometryError("its surface has a point with no normal or no finite place")
        return replace(pieces, values=values, outer=outer, inner=inner, sizes=sizes)

    def refined(self, pieces: Pieces, tolerance: Float) -> Pieces:
        """Return the pieces, cut until none is off by more than `tolerance` (11,), or cutting is no use."""
        bad = (pieces.errors > tolerance).any(axis=1)
        while bad.any() and len(pieces.trim) + bad.sum() <= max(_LEAST, _POINTS // (21 * self._cost(pieces))):
            again, rest = np.flatnonzero(bad), np.flatnonzero(~bad)
            coarse = pieces.subset(again)
            within = (coarse.inner > 0.5 * tolerance).any(axis=1) & (coarse.parts < _FINEST)
            finer = replace(coarse, parts=np.where(within, 2 * coarse.parts, coarse.parts))
            middle = 0.5 * (coarse.start + coarse.stop)
            halved = (coarse.outer > 0.5 * tolerance).any(axis=1) | ~within
            first, second = finer.subset(np.flatnonzero(halved)), finer.subset(np.flatnonzero(halved))
            first, second = replace(first, stop=middle[halved]), replace(second, start=middle[halved])
            parts = [finer.subset(np.flatnonzero(~halved)), first, second]
            new = self.integrated(_joined(parts, np.zeros(11)))
            if (new.errors.sum(axis=0) > 0.5 * coarse.errors.sum(axis=0))[
                (coarse.errors > tolerance).any(axis=0)
            ].all():
                return pieces  # rounding is all that is left
            sizes = pieces.sizes + new.sizes  # more than there is: what was cut counts twice
            pieces = _joined([pieces.subset(rest), new], sizes)
            bad = np.concatenate([np.zeros(len(rest), bool), (new.errors > tolerance).any(axis=1)])
        return pieces

    def _cost(self, pieces: Pieces) -> int:
        """Return how many points each value of the antiderivative takes."""
        inner = inner_of(self.patch)
        if inner != "spline":
            return 7
        spline = root(self.patch).spline
        assert spline is not None
        spans = len(splines.breaks(spline, 0, self.low, self.high)) + 1
        return 21 * spans * int(pieces.parts.max(initial=1))

    def _antiderivative(self, u: Float, v: Float, parts: Int) -> tuple[Float, Float]:
        """Return the antiderivatives (n, 11) at (u, v), and how far they may be off."""
        inner = inner_of(self.patch)
        if inner == "spline":
            return self._along_spans(u, v, parts)
        if inner == "turned":
            jets = surface_jets(self.patch, np.tile(_ANGLES, len(u)), np.repeat(v, 7))
            g = self.integrand(jets).reshape(len(u), 7, 11)
            waves = np.sin((u[:, None, None] - _ANGLES[:, None]) * _WAVES)
            waves -= np.sin((self.base - _ANGLES[:, None]) * _WAVES)
            kernel = ((u - self.base)[:, None] + 2.0 * (waves / _WAVES).sum(axis=2)) / 7.0
            total = np.einsum("nk,nkc->nc", kernel, g)
            return total, np.zeros_like(total)
        half = 0.5 * (v - self.base)
        total = np.zeros((len(u), 11))
        for node in (-math.sqrt(1 / 3), math.sqrt(1 / 3)):
            total += half[:, None] * self.integrand(surface_jets(self.patch, u, self.base + half * (1.0 + node)))
        return total, np.zeros_like(total)

    def _along_spans(self, u: Float, v: Float, parts: Int) -> tuple[Float, Float]:
        spline = root(self.patch).spline
        assert spline is not None
        if self.exact:
            nodes, weights = np.polynomial.legendre.leggauss((5 * spline.degrees[0] + 1) // 2)
            difference = np.zeros_like(weights)
        else:
            nodes, weights, difference = NODES, WEIGHTS, DIFFERENCE
        knots = np.concatenate([[self.base], splines.breaks(spline, 0, self.base, self.high)])
        here, low = np.nonzero((knots < u[:, None]) | (np.arange(len(knots)) == 0))
        ends = np.minimum(np.append(knots, np.inf)[low + 1], u[here])
        starts, cuts = knots[low], parts[here]
        here = np.repeat(here, cuts)
        number = np.arange(len(here)) - np.repeat(np.cumsum(cuts) - cuts, cuts)
        width = np.repeat((ends - starts) / cuts, cuts)
        starts = np.repeat(starts, cuts) + number * width
        half = 0.5 * width
        at = (starts + half)[:, None] + half[:, None] * nodes
        g = self.integrand(surface_jets(self.patch, at.ravel(), np.repeat(v[here], len(nodes))))
        g = g.reshape(len(here), len(nodes), 11) * half[:, None, None]
        first = np.searchsorted(here, np.arange(len(u)))
        total = np.add.reduceat(np.einsum("k,nkc->nc", weights, g), first)
        off = np.add.reduceat(np.abs(np.einsum("k,nkc->nc", difference, g)), first)
        return total, off


def _joined(several: list[Pieces], sizes: Float) -> Pieces:
    rows = {name: np.concatenate([getattr(one, name) for one in several]) for name in _BY_PIECE}
    return Pieces(**rows, sizes=sizes)


def walk(trims: tuple[Trim, ...], number: Int, t: Float) -> tuple[Float, Float]:
    """Return (u, v) and their rates of change, (n, 2) each, at t (n,) on the trims of these numbers (n,)."""
    lines = np.array([trim.curve.kind == "line" for trim in trims])[number]
    points, rates = np.zeros((2, len(t), 2))
    if lines.any():
        frames = np.array([trim.curve.frame if trim.curve.kind == "line" else np.zeros((3, 2)) for trim in trims])[
            number
        ]
        points, rates = frames[:, 0] + t[:, None] * frames[:, 1], frames[:, 1]
    if not lines.all():
        points, rates = points.copy(), rates.copy()
        for k in np.unique(number[~lines]):
            some = np.flatnonzero(number == k)
            points[some], rates[some] = curve_jets(trims[k].curve, t[some], 1)
    return points, rates


def _cuts(patch: Patch, trim: Trim) -> Float:
    """Return the parameters of a trim, from start to stop, between which the integrand is smooth, and bends little."""
    low, high = min(trim.start, trim.stop), max(trim.start, trim.stop)
    curve, base = trim.curve, root(patch)
    if curve.kind == "line" and base.kind == "plane":
        return np.array([trim.start, trim.stop])
    cuts = [np.array([low, high])]
    if curve.spline is not None:
        cuts.append(splines.breaks(curve.spline, 0, low, high))
    elif curve.kind == "ellipse":
        cuts.append(np.linspace(low, high, max(1, math.ceil((high - low) / _QUARTER)) + 1))
    if curve.kind == "line" and inner_of(patch) == "turned":
        turn = abs(curve.frame[1, 0]) if curve.frame[1, 1] else 0.0
        if base.kind in ("sphere", "torus"):
            turn = max(turn, abs(curve.frame[1, 1]))
        count = max(1, math.ceil(turn * (high - low) / _QUARTER))
        cuts.append(np.linspace(low, high, min(count, 64) + 1))
    knotted = [(axis, base.spline, axis) for axis in (0, 1)] if base.spline is not None else []
    if base.profile is not None and (profile := profile_of(base)).spline is not None:
        knotted = [(0 if base.kind == "extrusion" else 1, profile.spline, 0)]
    for axis, spline, its in knotted:
        cuts.append(_crossings(trim, np.unique(np.concatenate(cuts)), axis, spline, its))
    t = np.unique(np.clip(np.concatenate(cuts), low, high))
    t = t[np.append(True, np.diff(t) > 1e-14 * (abs(high) + abs(low)))]
    t[-1] = high
    way: Float = t if trim.start <= trim.stop else t[::-1]
    return way


def _crossings(trim: Trim, cuts: Float, axis: int, spline: Spline, its: int) -> Float:
    """Return where a trim crosses lines of knots."""
    fine = (cuts[:-1, None] + np.diff(cuts)[:, None] * np.linspace(0, 1, _CROSSING_SAMPLES, endpoint=False)).ravel()
    fine = np.append(fine, cuts[-1])
    if trim.curve.kind == "line":
        fine = cuts[[0, -1]]
    at = walk((trim,), np.zeros(len(fine), int), fine)[0][:, axis]
    knots = splines.breaks(spline, its, float(at.min()), float(at.max()))
    if not len(knots):
        return knots
    side = np.sign(at[:, None] - knots)
    piece, knot = np.nonzero(side[:-1] * side[1:] < 0)
    low, high, sign = fine[piece], fine[piece + 1], side[piece, knot]
    if trim.curve.kind == "line":
        o, x = trim.curve.frame[:2, axis]
        crossings: Float = (knots[knot] - o) / x
        return crossings
    for _ in range(50):
        middle = 0.5 * (low + high)
        before = np.sign(walk((trim,), np.zeros(len(middle), int), middle)[0][:, axis] - knots[knot]) == sign
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return np.concatenate([0.5 * (low + high), fine[np.any(side == 0, axis=1)]])
