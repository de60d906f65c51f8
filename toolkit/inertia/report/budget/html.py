"""`Budget` → one HTML file that needs nothing else: verdict, limits, what is uncertain, and the tree, to be folded."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from inertia.arrays import Float
from inertia.assembly.budget import Budget
from inertia.assembly.limits import COVERAGE, Limit
from inertia.output import require_writable, write_whole
from inertia.report.budget.text import figure, limit_figures, limit_unit
from inertia.report.numerals import cleared
from inertia.report.svg.canvas import Canvas
from inertia.report.templates import templates
from inertia.units import Unit

_BARS = 8
_LABEL = 28  # characters that fit beside a bar
_SIZE = 60.0  # mm
_VIEWS = ((0, 1), (0, 2), (1, 2))


def budget_html(budget: Budget) -> str:
    """Return the budget as the text of an HTML file."""
    unit, total, properties = budget.assembly.unit, budget.total, budget.properties
    metres = float(unit.metres)
    bound = properties.error.inertia * float(np.linalg.norm(properties.inertia))
    tensor = [
        [
            (f"{cleared(properties.inertia[i, j].item(), bound):.9g}", f"{COVERAGE * u:.2g}" if u else "")
            for j, u in enumerate(row)
        ]
        for i, row in enumerate(total.sigma.inertia.tolist())
    ]
    off = properties.error.center_of_mass
    center = [
        figure(cleared(k, off) / metres, cleared(u, off) / metres)
        for k, u in zip(properties.center_of_mass.tolist(), total.sigma.center_of_mass.tolist(), strict=True)
    ]
    environment = templates("inertia.report.budget", clear=lambda k: "0" if abs(k) < 1e-9 else f"{k:.5g}")
    return environment.get_template("budget.html.j2").render(
        budget=budget,
        total=total,
        metres=metres,
        unit=unit.name,
        mass=figure(properties.mass, total.sigma.mass),
        predicted=figure(total.predicted_mass, total.sigma.predicted_mass),
        center=center,
        tensor=tensor,
        tensor_is_zero=not math.isfinite(properties.error.inertia),
        limits=[_row(limit, unit) for limit in budget.limits],
        figures=list(_figures(budget)),
    )


def write_budget(budget: Budget, file: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Write the report; raise as `inertia.output.require_writable`."""
    path = require_writable(file, ".html", force=force)
    write_whole(path, budget_html(budget).encode())
    return path


def _row(limit: Limit, unit: Unit) -> dict[str, Any]:
    scale, name = limit_unit(limit, unit)
    low, value, high = limit_figures(limit, scale)
    return {
        "what": limit.what,
        "unit": name,
        "low": low,
        "high": high,
        "value": value.removesuffix(" (95 %)"),
        "margin": f"{scale * limit.margin:.4g}" if math.isfinite(limit.margin) else "",
        "verdict": limit.verdict,
        "picture": _gauge(limit),
    }


def _gauge(limit: Limit) -> Markup:
    """Return a line with the limits as marks, and on it the interval of 95 % around the value."""
    reach = COVERAGE * limit.uncertainty
    ends = [k for k in (limit.low, limit.high) if k is not None] + [limit.value - reach, limit.value + reach]
    low, high = min(ends), max(ends)
    if len(ends) == 3:  # one limit: the other side has room
        low, high = low - 0.3 * (high - low), high + 0.3 * (high - low)
    span = (high - low) or 1.0
    canvas = Canvas(46, 6, f"{limit.what}: {limit.verdict}")

    def at(value: float) -> float:
        return 3 + 40 * (value - low) / span

    canvas.line((1, 3), (45, 3), "axis")
    for mark in (limit.low, limit.high):
        if mark is not None:
            canvas.line((at(mark), 0.5), (at(mark), 5.5), "limit")
    canvas.line((at(limit.value - reach), 3), (at(limit.value + reach), 3), "interval")
    canvas.circle((at(limit.value), 3), 0.9, "value")
    return canvas.markup()


def _figures(budget: Budget) -> Iterator[tuple[str, Markup]]:
    sigma = budget.total.sigma
    if sigma.changes.size and sigma.changes.any():
        squares = np.zeros((len(sigma.labels), 11))
        np.add.at(squares, np.asarray(sigma.owner, dtype=np.intp), sigma.changes**2)
        for caption, columns in (
            ("Variance of the mass", [0]),
            ("Variance of the centre of mass", [1, 2, 3]),
            ("Variance of the moments xx, yy, zz", [4, 5, 6]),
        ):
            shares = squares[:, columns].sum(axis=1)
            if shares.any():
                yield caption, _pareto(sigma.labels, shares / shares.sum(), caption)
    named = {limit.what: limit for limit in budget.limits if limit.what.startswith("center_of_mass")}
    for pair in _VIEWS:
        limits = [named.get(f"center_of_mass.{'xyz'[k]}") for k in pair]
        if any(limits):
            across, up = ("xyz"[k] for k in pair)
            yield f"Centre of mass: {across} to the right, {up} up", _cloud(budget, pair, limits)


def _pareto(labels: tuple[str, ...], shares: Float, caption: str) -> Markup:
    """Return bars of the largest shares, and a line of their sum."""
    order = np.argsort(-shares, kind="stable")[:_BARS]
    order = order[shares[order] > 5e-4]
    height = 6.0 * len(order) + 6
    canvas = Canvas(124, height, f"{caption}: shares of the inputs")
    total, way = 0.0, []
    for k, index in enumerate(order.tolist()):
        top = 6.0 * k + 1
        share = float(shares[index])
        label = labels[index] if len(labels[index]) <= _LABEL else f"{labels[index][: _LABEL - 1]}…"
        canvas.text((48, top + 3.4), label, anchor="end", size=2.6)
        canvas.rectangle((50, top), 56 * share, 4, "bar")
        canvas.text((121, top + 3.2), f"{100 * share:.1f} %", anchor="end", size=2.6)
        total += share
        way.append((50 + 56 * total, top + 4.6))
    canvas.polyline(way, "sum")
    canvas.line((50, 0), (50, height - 5), "axis")
    canvas.line((106, 0), (106, height - 5), "axis")
    canvas.text((106, height - 1.5), "100 %, and the sum so far", size=2.4, anchor="end")
    return canvas.markup()


def _cloud(budget: Budget, pair: tuple[int, int], limits: list[Limit | None]) -> Markup:
    """Return the centre of mass with its ellipse of 95 %, and its box."""
    columns = [1 + k for k in pair]
    changes = budget.total.sigma.changes[:, columns]
    covariance = changes.T @ changes if len(changes) else np.zeros((2, 2))
    squares, axes = np.linalg.eigh(covariance)
    angles = np.linspace(0, 2 * np.pi, 73)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    coverage = math.sqrt(-2 * math.log(0.05))  # of 95 % in a plane
    middle = budget.properties.center_of_mass[list(pair)]
    ellipse = middle + coverage * circle * np.sqrt(np.maximum(squares, 0)) @ axes.T
    marks = [[k for k in (limit.low, limit.high) if k is not None] if limit else [] for limit in limits]
    ends = [[*ellipse[:, k].tolist(), *marks[k]] for k in range(2)]
    size = 1.25 * max(max(each) - min(each) for each in ends) or 1e-3
    corner = [(max(each) + min(each)) / 2 - size / 2 for each in ends]
    unit = budget.assembly.unit
    canvas = Canvas(_SIZE + 26, _SIZE + 10, "centre of mass and its limits")

    def at(x: float, y: float) -> tuple[float, float]:
        return 24 + (x - corner[0]) / size * _SIZE, 2 + _SIZE - (y - corner[1]) / size * _SIZE

    canvas.rectangle((24, 2), _SIZE, _SIZE, "sum axis")
    for mark in marks[0]:
        canvas.line(at(mark, corner[1]), at(mark, corner[1] + size), "limit")
        canvas.text((at(mark, 0)[0], _SIZE + 6), f"{mark / float(unit.metres):.4g}")
    for mark in marks[1]:
        canvas.line(at(corner[0], mark), at(corner[0] + size, mark), "limit")
        canvas.text((23, at(0, mark)[1] + 1), f"{mark / float(unit.metres):.4g}", anchor="end")
    canvas.polygon([at(float(x), float(y)) for x, y in ellipse], "cloud")
    canvas.circle(at(float(middle[0]), float(middle[1])), 0.9, "value")
    canvas.text((24 + _SIZE / 2, _SIZE + 9.5), unit.name)
    return canvas.markup()
