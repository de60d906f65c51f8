"""Points and derivatives of the curves and surfaces of a shape, and how the integrand varies along their parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.errors import GeometryError
from inertia.mass.shapes import splines
from inertia.mesh.shape import Curve, Patch

Inner = Literal["turned", "straight", "spline"]
"""Along u the integrand is a trigonometric polynomial; along v it is a polynomial; neither is sure."""

_FIGURES = {"cylinder": 1, "cone": 2, "sphere": 1, "torus": 2, "offset": 1, "ellipse": 2, "parabola": 1, "hyperbola": 2}


def curve_jets(curve: Curve, t: Float, order: int) -> Float:
    """Return points and derivatives (order + 1, n, d) at the parameters t (n,), up to the second derivative."""
    if curve.kind == "spline":
        assert curve.spline is not None
        return splines.curve_jets(curve.spline, t, order)
    o, x, y = curve.frame
    a, b = (*curve.sizes, 0.0, 0.0)[:2]
    zero, one = np.zeros_like(t), np.ones_like(t)
    if curve.kind == "line":
        along, across = (t, one, zero), (zero, zero, zero)
    elif curve.kind == "ellipse":
        c, s = np.cos(t), np.sin(t)
        along, across = (a * c, -a * s, -a * c), (b * s, b * c, -b * s)
    elif curve.kind == "parabola":
        along, across = (t * t / (4 * a), t / (2 * a), one / (2 * a)), (t, one, zero)
    else:
        c, s = np.cosh(t), np.sinh(t)
        along, across = (a * c, a * s, a * c), (b * s, b * c, b * s)
    jets = np.stack([np.multiply.outer(p, x) + np.multiply.outer(q, y) for p, q in zip(along, across, strict=True)])
    jets[0] += o
    return jets[: order + 1]


def surface_jets(patch: Patch, u: Float, v: Float, order: int = 1) -> Float:
    """Return points and derivatives of a surface at (u, v) (n,): x, x_u, x_v, and for order 2 x_uu, x_uv, x_vv."""
    if patch.kind == "spline":
        assert patch.spline is not None
        return splines.surface_jets(patch.spline, u, v, order)
    if patch.kind == "offset":
        return _offset(patch, u, v)
    if patch.kind in ("plane", "extrusion"):
        return _straight(patch, u, v, order)
    return _turned(patch, u, v, order)


def _straight(patch: Patch, u: Float, v: Float, order: int) -> Float:
    o, x, y, z = patch.frame
    jets = np.zeros((len(splines.SURFACE_JETS[order]), len(u), 3))
    if patch.kind == "plane":
        jets[:3] = (
            o + np.multiply.outer(u, x) + np.multiply.outer(v, y),
            np.tile(x, (len(u), 1)),
            np.tile(y, (len(u), 1)),
        )
        return jets
    profile = curve_jets(profile_of(patch), u, order)
    jets[:3] = (profile[0] + np.multiply.outer(v, z), profile[1], np.tile(z, (len(u), 1)))
    if order > 1:
        jets[3] = profile[2]
    return jets


def _turned(patch: Patch, u: Float, v: Float, order: int) -> Float:
    """x = o + h(v) z + p(v) cos u + q(v) sin u, for all that is turned about an axis."""
    o, x, y, z = patch.frame
    if patch.kind == "revolution":
        z = z / np.linalg.norm(z)
        profile = curve_jets(profile_of(patch), v, order)
        profile[0] -= o
        h = profile @ z
        p = profile - h[..., None] * z
        q = np.cross(z, p)
    else:
        radius, h = _generatrix(patch, v)
        h, p, q = h[: order + 1], radius[: order + 1, :, None] * x, radius[: order + 1, :, None] * y
    c, s = np.cos(u)[:, None], np.sin(u)[:, None]
    jets = [o + h[0][:, None] * z + p[0] * c + q[0] * s, q[0] * c - p[0] * s, h[1][:, None] * z + p[1] * c + q[1] * s]
    if order > 1:
        jets += [-p[0] * c - q[0] * s, q[1] * c - p[1] * s, h[2][:, None] * z + p[2] * c + q[2] * s]
    return np.stack(jets)


def _generatrix(patch: Patch, v: Float) -> tuple[Float, Float]:
    """Return the radius and the height of a turned surface and their derivatives, (3, n) each."""
    a, b = (*patch.sizes, 0.0)[:2]
    zero, one = np.zeros_like(v), np.ones_like(v)
    if patch.kind == "cylinder":
        return np.stack([a * one, zero, zero]), np.stack([v, one, zero])
    if patch.kind == "cone":
        return np.stack([a + v * np.sin(b), np.sin(b) * one, zero]), np.stack([v * np.cos(b), np.cos(b) * one, zero])
    c, s = np.cos(v), np.sin(v)
    if patch.kind == "sphere":
        return a * np.stack([c, -s, -c]), a * np.stack([s, c, -s])
    radius = b * np.stack([c, -s, -c])
    radius[0] += a
    return radius, b * np.stack([s, c, -s])


def _offset(patch: Patch, u: Float, v: Float) -> Float:
    """x = b + a n with n = m/|m|, m = b_u × b_v, and n_u = (m_u − n (n · m_u))/|m|."""
    distance, basis = patch.sizes[0], patch.basis
    assert basis is not None
    while basis.kind == "offset":
        assert basis.basis is not None
        distance, basis = distance + basis.sizes[0], basis.basis
    x, xu, xv, xuu, xuv, xvv = surface_jets(basis, u, v, 2)
    m = np.cross(xu, xv)
    length = np.linalg.norm(m, axis=1, keepdims=True)
    n = m / length
    jets = [x + distance * n]
    for first, turning in ((xu, np.cross(xuu, xv) + np.cross(xu, xuv)), (xv, np.cross(xuv, xv) + np.cross(xu, xvv))):
        jets.append(first + distance * (turning - n * (n * turning).sum(axis=1, keepdims=True)) / length)
    return np.stack(jets)


def profile_of(patch: Patch) -> Curve:
    """Return the curve that an extrusion or revolution moves."""
    assert patch.profile is not None
    return patch.profile[0]


def root(patch: Patch) -> Patch:
    """Return the surface that offsets start from."""
    return patch if patch.basis is None else root(patch.basis)


def inner_of(patch: Patch) -> Inner:
    """Return how the integrand varies along the parameter that is integrated first; an offset is as its basis."""
    kind = root(patch).kind
    return "spline" if kind == "spline" else "straight" if kind in ("plane", "extrusion") else "turned"


def moved(patch: Patch, shift: Float) -> Patch:
    """Return the surface moved by `shift` (3,)."""
    frame = patch.frame + np.array([shift, *np.zeros((3, 3))])
    spline, profile = patch.spline, patch.profile
    if spline is not None:
        spline = replace(spline, poles=spline.poles + shift)
    if profile is not None:
        curve, first, last = profile
        bent = None if curve.spline is None else replace(curve.spline, poles=curve.spline.poles + shift)
        curve = replace(curve, frame=curve.frame + np.array([shift, *np.zeros((2, 3))]), spline=bent)
        profile = (curve, first, last)
    basis = None if patch.basis is None else moved(patch.basis, shift)
    return replace(patch, frame=frame, spline=spline, profile=profile, basis=basis)


def require_patch(patch: Patch) -> None:
    """Refuse a surface with numbers missing, not finite, or of no use."""
    _require(patch.kind, patch.frame, patch.sizes)
    if patch.kind == "spline":
        if patch.spline is None:
            raise GeometryError("its spline is missing")
        splines.require_spline(patch.spline)
    elif patch.kind in ("extrusion", "revolution"):
        if patch.profile is None:
            raise GeometryError("its profile is missing")
        require_curve(patch.profile[0])
        if not np.linalg.norm(patch.frame[3]) > 0:
            raise GeometryError("it has no direction")
    elif patch.kind == "offset":
        if patch.basis is None:
            raise GeometryError("its basis is missing")
        require_patch(patch.basis)


def require_curve(curve: Curve) -> None:
    """Refuse a curve with numbers missing, not finite, or of no use."""
    _require(curve.kind, curve.frame, curve.sizes)
    if curve.kind == "spline":
        if curve.spline is None:
            raise GeometryError("its spline is missing")
        splines.require_spline(curve.spline)


def _require(kind: str, frame: Float, sizes: tuple[float, ...]) -> None:
    if len(sizes) < _FIGURES.get(kind, 0):
        raise GeometryError(f"its {kind} lacks a size")
    if not (np.isfinite(frame).all() and np.isfinite(sizes).all()):
        raise GeometryError(f"its {kind} holds a number that is not finite", code="non_finite")
