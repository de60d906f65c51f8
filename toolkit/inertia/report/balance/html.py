"""`Balance` → one HTML file that needs nothing else: no network, no script; it prints to A4 as three pages.

Page 1 says what was judged and how, page 2 the figures, page 3 what the shop does. A long list of operations goes on
over further pages, with its head repeated.
"""

from __future__ import annotations

import os

from markupsafe import Markup

from inertia.output import require_writable, write_whole
from inertia.report import numerals
from inertia.report.balance.sheet import ReportData
from inertia.report.balance.words import TURNS
from inertia.report.numerals import rectangular
from inertia.report.svg.convention import convention
from inertia.report.svg.polar import STYLES, Arrow, Mark, key, polar
from inertia.report.svg.sketch import sketch
from inertia.report.svg.strip import strip

_IN_LINE = 3  # correction planes that the table has room for
_LISTED = 8  # lines of the sensitivity table
_SIGN = {"ADD": 1, "REMOVE": -1}


def balance_html(data: ReportData) -> str:
    """Return the report as the text of an HTML file.

    Parameters
    ----------
    data : what it prints (`inertia.report.balance.data.report_data`)
    """
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("inertia.report.balance"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters.update(
        significant=numerals.significant,
        fixed=numerals.fixed,
        plain=numerals.plain,
        degrees=numerals.degrees,
        magnitude=lambda value: numerals.significant(abs(value)),
        ounces=numerals.ounce_inches,
        ounces2=numerals.ounce_square_inches,
    )
    return environment.get_template("balance.html.j2").render(
        data=data,
        rotation=TURNS[data.rotation],
        convention=convention(data.rotation),
        sketch=sketch(data.outline, data.center, data.bearings, data.planes),
        plots=_plots(data),
        keys={style: key(style) for style in STYLES},
        strip=strip(data.planes, data.operations),
        in_line=0 < len(data.planes) <= _IN_LINE,
        forbidden=any(plane.forbidden for plane in data.planes),
        listed=_LISTED,
    )


def save_balance_html(data: ReportData, path: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write the report to a file, which appears whole or not at all.

    Parameters
    ----------
    data : what it prints
    path : of the file
    force : replace a file that is there

    Raises `UsageError` where there is a file already, `InertiaError` where it cannot be written.
    """
    file = require_writable(path, suffix=".html", force=force)
    write_whole(file, balance_html(data).encode("utf-8", "replace"))


def _plots(data: ReportData) -> list[Markup | None]:
    """Return the plots row by row, three a row: those of a tolerance plane, and beside and below correction planes."""
    beside: list[Markup | None] = [_of_plane(data, number) for number in range(len(data.planes))]
    ends = [*beside[:2], None, None]
    return [*_of_bearing(data, 0), ends[0], *_of_bearing(data, 1), ends[1], *beside[2:]]


def _of_bearing(data: ReportData, number: int) -> tuple[Markup, Markup]:
    """Return a tolerance plane before and after, and what is left at the scale of the tolerance."""
    bearing, (initial, _, residual) = data.bearings[number], data.states
    limit = bearing.permissible
    before = Arrow(initial.bearings[number], "before")
    after = Arrow(residual.bearings[number], "after", bearing.uncertainty)
    return (
        polar(f"{bearing.name}, before and after", [before, after], tolerance=limit),
        polar(f"{bearing.name}, what is left", [after], tolerance=limit, scatter=bearing.residual_95),
    )


def _of_plane(data: ReportData, number: int) -> Markup:
    """Return a correction plane: what is there, what its operations add, and where on the rim they are."""
    plane = data.planes[number]
    works = [work for work in data.operations if work.plane == plane.id]
    added = sum((_SIGN[work.method] * rectangular(work.unbalance, work.angle) for work in works), 0j)
    arrows = [Arrow(data.states[0].planes[number], "before"), Arrow(added, "correction")]
    marks = [Mark(work.angle, work.method == "ADD") for work in works]
    return polar(f"plane {plane.id}, correction", arrows, marks=marks)
