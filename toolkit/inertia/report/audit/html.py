"""`Audit` → one HTML file that needs nothing else: the verdict, a table, and a picture and sentences for each link."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

import numpy as np
from markupsafe import Markup

from inertia.arrays import Float
from inertia.auditing.audit import Audit
from inertia.auditing.bodies import Body, Shape
from inertia.auditing.judge import LinkAudit
from inertia.output import require_writable, write_whole
from inertia.report.audit.text import millimetres, percent, sentence
from inertia.report.svg.canvas import Canvas
from inertia.report.templates import templates

_VIEWS = (("x", "y"), ("x", "z"), ("y", "z"))
_SIZE = 46.0  # mm, of a view
_MARGIN = 5.0
_POINTS = 72


def audit_html(audit: Audit) -> str:
    """Return the audit as the text of an HTML file."""
    environment = templates("inertia.report.audit", percent=percent, sentence=sentence, millimetres=millimetres)
    counts = Counter(link.state for link in audit.links)
    return environment.get_template("audit.html.j2").render(
        audit=audit,
        counts=sorted(counts.items()),
        shown=[(link, picture(link)) for link in audit.links if link.state != "consistent" or link.findings],
    )


def write_audit(audit: Audit, file: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Write the report; raise as `inertia.output.require_writable`."""
    path = require_writable(file, ".html", force=force)
    write_whole(path, audit_html(audit).encode())
    return path


def picture(link: LinkAudit) -> Markup | None:
    """Return three views of a link: outlines of its shapes, ellipsoids of the stated and of the computed tensor.

    The ellipsoid is the solid one of the same mass, centre and tensor (half axes √(5 S/m), S = ∫ r rᵀ dm). What no body
    can have has none, in no view: seen along an axis it may seem to.
    """
    if link.stated is None or not link.shapes:
        return None
    bodies = [(link.stated, "stated")]
    if link.computed is not None:
        computed = link.computed
        bodies.append((Body(computed.mass, computed.center_of_mass, computed.inertia), "computed"))
    possible = bodies[1:] if link.state == "unphysical" else bodies
    canvas = Canvas(3 * _SIZE, _SIZE + 4, f"{link.name}: stated and computed ellipsoid")
    for number, (across, up) in enumerate(_VIEWS):
        pair = ["xyz".index(across), "xyz".index(up)]
        outlines = [_outline(shape, pair) for shape in link.shapes]
        curves = [(_ellipse(body, pair), style) for body, style in possible]
        every = np.concatenate([*outlines, *(curve for curve, _ in curves)])
        low, high = every.min(axis=0), every.max(axis=0)
        scale = (_SIZE - 2 * _MARGIN) / max(float((high - low).max()), 1e-300)
        corner = np.array([number * _SIZE + _SIZE / 2, _SIZE / 2])

        def at(
            points: Float, low: Float = low, high: Float = high, scale: float = scale, corner: Float = corner
        ) -> list[tuple[float, float]]:
            flipped = (points - (low + high) / 2) * scale * [1, -1] + corner
            return [(float(x), float(y)) for x, y in flipped]

        for outline in outlines:
            canvas.polygon(at(outline), "shape")
        for curve, style in curves:
            canvas.polygon(at(curve), style)
        for body, style in bodies:
            canvas.circle(at(body.center[pair][None])[0], 0.8, f"{style} center")
        canvas.text((number * _SIZE + _SIZE / 2, _SIZE + 2), f"{across} to the right, {up} up")
    return canvas.markup()


def _outline(shape: Shape, pair: list[int]) -> Float:
    """Return the convex outline (k, 2) of a shape, seen along an axis."""
    from scipy.spatial import ConvexHull, QhullError

    points = np.unique(shape.corners.reshape(-1, 3)[:, pair], axis=0)
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except (QhullError, ValueError):
        return points[[0, -1]]


def _ellipse(body: Body, pair: list[int]) -> Float:
    """Return the outline (k, 2) of the equivalent ellipsoid, seen along an axis: a line, of a sheet from its edge."""
    second = (np.trace(body.inertia) / 2 * np.eye(3) - body.inertia) / body.mass
    squares, axes = np.linalg.eigh(5 * second[np.ix_(pair, pair)])
    angles = np.linspace(0, 2 * np.pi, _POINTS, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.asarray(body.center[pair] + circle * np.sqrt(squares.clip(min=0.0)) @ axes.T)
