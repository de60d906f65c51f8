"""Moments of a solid of trimmed faces, with bounds: faces, strips between them, rounding, and what edges leave open."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction

import numpy as np

from inertia.arrays import Float
from inertia.errors import GeometryError
from inertia.mass.moments import PAIRS, Moments, six, vector
from inertia.mass.shapes.edges import EdgeError, closing
from inertia.mass.shapes.faces import Domain, Integrand, Pieces, flux, sheet, walk
from inertia.mass.shapes.surfaces import inner_of, moved, require_curve, require_patch, surface_jets
from inertia.mesh.shape import Curve, Face, Solid, Trim
from inertia.records import dataclass

_EPSILON = 2.0**-53
_OPERATIONS = 64.0  # roundings that a term of a sum may have been through
_SURFACE = {"turned": 8.0, "straight": 8.0, "spline": 32.0}  # roundings of a point, of its distance from the origin
_OPEN = 1e-3  # of the size of a solid, that the loops of its faces may be open in space
_LOST = 1e-3  # of the volume, that may be uncertain at the edges
_LARGEST = 1e100  # that coordinates may be: their fifth powers are summed


@dataclass(frozen=True, eq=False)
class SolidMoments:
    """The moments of a solid, or of its surface, in its own frame, with bounds.

    `area` is that of its faces, `gap` the largest distance between the two sides of an edge; `loose` says whether such
    gaps count more than rounding, `settled` whether finer quadrature would make the bounds little smaller.
    """

    moments: Moments
    area: float
    gap: float
    loose: bool
    settled: bool


def solid_moments(solid: Solid, tolerances: Float, accuracy: float, *, surface: bool = False) -> SolidMoments:
    """Integrate a solid, or with `surface` its faces alone, which may be open.

    Parameters
    ----------
    solid : where it is placed is of no account
    tolerances : (e,) how far faces may be apart at the edges of the shape
    accuracy : relative, that the quadrature is to reach; the bounds say what was reached

    Raises `GeometryError` where the faces do not bound a solid, or are not what they should be.
    """
    center, faces, size = _centred(solid)
    if max(trim.edge for face in faces for loop in face.loops for trim in loop) >= len(tolerances):
        raise GeometryError("it has edges without a tolerance")
    faces, corners = _with_loops_closed(faces, size)
    try:
        edges = closing(faces, tolerances, size, surface=surface)
    except EdgeError as fault:
        raise GeometryError(_at_edge(fault, center)) from None
    integrand: Integrand = sheet if surface else flux
    signs = np.array([-1.0 if face.inward and not surface else 1.0 for face in faces])
    begun = []
    for face in faces:
        with _naming(face):
            domain, pieces = Domain.of(face, integrand)
            begun.append((domain, domain.integrated(pieces)))
    strips = np.zeros(11) if surface else edges.values
    total = _sum(signs, [pieces for _, pieces in begun]) + strips
    if not surface and total[0] <= 0:
        raise GeometryError("its faces enclose no volume, or face inward")
    radius = math.sqrt(max(float(total[4:7].sum() / total[0]), 0.0))
    scale = total[0] * np.array([1.0, *(radius,) * 3, *(radius**2,) * 6, math.inf])
    share = 0.25 * accuracy * scale / max(1, sum(len(pieces.trim) for _, pieces in begun))
    done = []
    for face, (domain, pieces) in zip(faces, begun, strict=True):
        with _naming(face):
            done.append(domain.refined(pieces, share))
    total = _sum(signs, done) + strips
    places = np.abs(edges.places)
    open_measure = edges.areas if surface else edges.volumes
    lost = np.array([*_spread(open_measure, places), 0.0]) + corners
    if not surface and lost[0] > _LOST * total[0]:
        raise GeometryError(
            f"its faces fit together so badly (up to {edges.gap:.2g} apart) that {lost[0] / total[0]:.2g} of its "
            "volume is uncertain"
        )
    far = size + float(np.abs(center).max())
    sizes = np.sum([pieces.sizes for pieces in done], axis=0)
    rounding = _EPSILON * _OPERATIONS * sizes
    moved_by = [_EPSILON * (2.0 * far + _SURFACE[inner_of(face.patch)] * size) for face in faces]  # a point
    layer = sum(k * float(pieces.sizes[10]) for k, pieces in zip(moved_by, done, strict=True))
    rounding[:10] += layer / (size if surface else 1.0) * np.array([1.0, *(size,) * 3, *(size**2,) * 6])
    errors = np.sum([pieces.errors.sum(axis=0) for pieces in done], axis=0) + (0.0 if surface else edges.errors)
    bounds = [Fraction(k) for k in (errors + rounding + lost).tolist()]
    values = [Fraction(k) for k in total.tolist()]
    moments = Moments(
        vector(map(Fraction, center.tolist())),
        values[0],
        vector(values[1:4]),
        six(values[4:10]),
        bounds[0],
        vector(bounds[1:4]),
        six(bounds[4:10]),
    )
    settled = bool((errors[:10] <= 0.1 * (rounding + lost)[:10]).all())
    return SolidMoments(moments, float(total[10] - strips[10]), edges.gap, bool(lost[0] > rounding[0]), settled)


def _sum(signs: Float, several: Sequence[Pieces]) -> Float:
    """Return the sum over the faces; areas all count positive."""
    values = np.array([pieces.values.sum(axis=0) for pieces in several])
    total: Float = np.append(signs @ values[:, :10], values[:, 10].sum())
    return total


def _spread(measure: Float, places: Float) -> list[float]:
    """Return the largest moments that volumes at these places can have."""
    first = (measure @ places).tolist()
    return [float(measure.sum()), *first, *(float(measure @ (places[:, i] * places[:, j])) for i, j in PAIRS)]


def _centred(solid: Solid) -> tuple[Float, list[Face], float]:
    """Return a point in the middle, the faces about it, and how far they reach from it."""
    if not solid.faces:
        raise GeometryError("it has no faces")
    samples = []
    for face in solid.faces:
        with _naming(face):
            _require_face(face)
            samples.append(_samples(face))
    points = np.concatenate(samples)
    if not (np.abs(points) < _LARGEST).all():
        raise GeometryError("it reaches beyond the numbers that its moments can have")
    low, high = points.min(axis=0), points.max(axis=0)
    size = float((high - low).max())
    if not size > 0:
        raise GeometryError("it is a point")
    grid = 2.0 ** (math.floor(math.log2(size)) - 10)  # so that most coordinates lose no digit
    center: Float = np.round(0.5 * (low + high) / grid) * grid
    faces = [replace(face, patch=moved(face.patch, -center)) for face in solid.faces]
    return center, faces, float(np.linalg.norm(points - center, axis=1).max())


def _require_face(face: Face) -> None:
    require_patch(face.patch)
    if not any(face.loops):
        raise GeometryError("it has no boundary")
    for loop in face.loops:
        for trim in loop:
            require_curve(trim.curve)
            if not (math.isfinite(trim.start) and math.isfinite(trim.stop)):
                raise GeometryError("a trimming curve has an end that is not finite", code="non_finite")


def _samples(face: Face) -> Float:
    """Return points of a face: on its loops, and over the box of its parameters."""
    trims = tuple(trim for loop in face.loops for trim in loop)
    shares = np.linspace(0.0, 1.0, 5)
    t = np.array([trim.start + (trim.stop - trim.start) * shares for trim in trims])
    uv, _ = walk(trims, np.repeat(np.arange(len(trims)), 5), t.ravel())
    if not np.isfinite(uv).all():
        raise GeometryError("a trimming curve is not finite", code="non_finite")
    low, high = uv.min(axis=0), uv.max(axis=0)
    inner = low + (high - low) * np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2)
    both = np.concatenate([uv, inner])
    points: Float = surface_jets(face.patch, both[:, 0], both[:, 1])[0]
    if not np.isfinite(points).all():
        raise GeometryError("it has a point that is not finite", code="non_finite")
    return points


def _with_loops_closed(faces: Sequence[Face], size: float) -> tuple[list[Face], Float]:
    """Return the faces, a line in each gap between the trims of a loop, and what these leave open at the corners."""
    closed, left = [], np.zeros(11)
    for face in faces:
        loops = []
        for loop in filter(None, face.loops):
            ends = np.array([[trim.start, trim.stop] for trim in loop]).ravel()
            uv, _ = walk(loop, np.repeat(np.arange(len(loop)), 2), ends)
            here, there = uv[1::2], np.roll(uv[::2], -1, axis=0)
            points = surface_jets(face.patch, *np.concatenate([here, 0.5 * (here + there), there]).T)[0].reshape(
                3, -1, 3
            )
            gaps = np.linalg.norm(points[1:] - points[0], axis=2).max(axis=0)
            if (gaps > _OPEN * size).any():
                raise GeometryError(f"face {face.number}: its loop is open by {gaps.max():.2g}")
            extent = np.ptp(uv, axis=0)
            trims: list[Trim] = []
            for k, trim in enumerate(loop):
                trims.append(trim)
                if (np.abs(there[k] - here[k]) > 4.0 * _EPSILON * extent).any():
                    line = Curve("line", np.array([here[k], there[k] - here[k], [0.0, 0.0]]))
                    trims.append(Trim(line, 0.0, 1.0, -1))
            loops.append(tuple(trims))
            places = np.abs(points[0])
            left[:10] += 4.0 * np.array(_spread(size * gaps**2, places))
        closed.append(replace(face, loops=tuple(loops)))
    return closed, left


@contextmanager
def _naming(face: Face) -> Iterator[None]:
    try:
        with np.errstate(all="ignore"):
            yield
    except GeometryError as fault:
        raise GeometryError(f"face {face.number}: {fault}") from None


def _at_edge(fault: EdgeError, center: Float) -> str:
    numbers = [str(k) for k in fault.numbers]
    faces = f"face {numbers[0]}" if len(numbers) == 1 else f"faces {' and '.join(numbers)}"
    where = ", ".join(f"{k:.6g}" for k in (fault.place + center).tolist())
    return f"{faces} {fault} at ({where})"
