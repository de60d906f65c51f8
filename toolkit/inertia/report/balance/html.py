"""`ReportData` → one HTML file that needs nothing else: no network, no script; it prints to A4 as three pages.

Page 1 says what was judged and how, page 2 the figures, page 3 what the shop does. A long list of operations goes on
over further pages, with its head repeated.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from markupsafe import Markup

from inertia.arrays import Float
from inertia.balancing.bounds import Source
from inertia.balancing.shop_digits import ShopDigits
from inertia.balancing.shop_units import (
    GRAM_MILLIMETRE,
    GRAM_SQUARE_MILLIMETRE,
    INCH,
    OUNCE_INCH,
    in_degrees,
    in_gmm,
)
from inertia.balancing.tolerance import Share
from inertia.output import require_writable, write_whole
from inertia.report.balance.data import KINDS, MM, TURNS, BodyRow, OperationRow, PlaneRow, ReportData
from inertia.report.numerals import decimals_of, direction, fixed, plain, scaled, significant
from inertia.report.svg.canvas import rectangular
from inertia.report.svg.convention import convention
from inertia.report.svg.end_view import end_view
from inertia.report.svg.polar import STYLES, Arrow, Mark, key, polar
from inertia.report.svg.sketch import sketch
from inertia.report.svg.strip import strip
from inertia.report.svg.wrap import wrap
from inertia.report.templates import templates

_IN_LINE = 3  # correction planes that the table has room for
_LISTED = 8  # lines of the sensitivity table
_FEW = 5  # steps that stand beside the views
_LEAST_SHARE = 5e-4  # of the variance: below it an input does not matter
_SIGN = {"add": 1, "remove": -1}
_METHODS = {
    "add": "masses added",
    "remove": "masses removed",
    "drill_radial": "radial holes",
    "drill_axial": "axial holes",
    "mill": "milled flats",
    "mill_arc": "milled arcs",
    "kit": "weights of a kit",
}
_KEYS = {"H": "half key", "F": "full key", "N": "no key"}


def balance_html(data: ReportData) -> str:
    """Return the report as the text of an HTML file.

    Parameters
    ----------
    data : what it prints (`inertia.report.balance.figures.report_data`)
    """
    environment = templates(
        "inertia.report.balance",
        significant=significant,
        fixed=fixed,
        plain=plain,
        direction=direction,
        grams=data.grams,
        angle=lambda angle: direction(angle, max(1, data.digits.angle)),
        place=lambda value: fixed(value, max(data.decimals, data.digits.place)),
        kilograms=_kilograms,
        millimetres=lambda value: fixed(value, data.decimals),
        magnitude=lambda value: significant(abs(value)),
        newtons=lambda value: scaled(abs(value), data.force_decimals),
        degrees=degrees,
        gmm=lambda value: scaled(in_gmm(value), data.gmm_decimals),
        gmm2=lambda value: scaled(abs(value) / GRAM_SQUARE_MILLIMETRE, data.gmm_decimals),
        ounces=lambda value: ounce_inches(value, data.gmm_decimals + 2),
        ounces2=lambda value: scaled(abs(value) / (OUNCE_INCH * INCH), data.gmm_decimals + 1),
        file_name=_file_name,
        share=_share,
        tool=lambda work: _tool(work, data.digits),
        what=lambda plane: _what(plane, max(data.decimals, data.digits.place)),
    )
    wraps = list(_wraps(data))
    unwrapped = [plane for plane, pieces in wraps if not pieces]
    sensitivities = [line for line in data.scatter.sensitivities if line.share.max() > _LEAST_SHARE]
    return environment.get_template("balance.html.j2").render(
        data=data,
        turned=[f"{degrees}°" for degrees in data.indexing.degrees] if data.indexing else [],
        rotor_facts=list(_rotor_facts(data)),
        service_facts=list(_service_facts(data)),
        zero_mark=f"toward ({_listed(data.zero_mark)}) of the part's axes",
        notes=list(_notes(data)),
        uncertainties=[_total(bounds) for bounds in data.residual.bearing_bounds],
        faces={plane.id: _face(plane) for plane in data.planes},
        no_operation=data.ending if data.corrected else "no plane has a method of correction",
        sensitivities=sensitivities[:_LISTED],
        unlisted=len(sensitivities[_LISTED:]),
        rotation=TURNS[data.axis.shaft.rotation],
        machine_sense=TURNS[data.machine.sense],
        convention=convention(data.axis.shaft.rotation),
        sketch=sketch(data.outline, data.initial.z, data.bearings, data.planes),
        plots=_plots(data),
        keys={style: key(style) for style in STYLES},
        few=_FEW,
        steps=[_step(work, data) for work in data.operations],
        end_views=[end_view(k, data.section(k), data.steps(k)) for k in data.planes if data.steps(k)],
        strip=strip(unwrapped, data.operations, max(1, data.digits.angle)) if unwrapped else None,
        wraps=[piece for _, pieces in wraps for piece in pieces],
        in_line=0 < len(data.planes) <= _IN_LINE,
        forbidden=any(plane.forbidden for plane in data.planes),
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
    file = require_writable(path, ".html", force=force)
    write_whole(file, balance_html(data).encode("utf-8", "replace"))


def degrees(vector: complex) -> str:
    """Return the angle of a vector, to 0.1°.

    >>> degrees(-1j), degrees(1 - 1e-9j)
    ('270.0°', '0.0°')
    """
    return f"{direction(in_degrees(vector))}°"


def ounce_inches(unbalance: complex, decimals: int = 5) -> str:
    """Return an unbalance (kg m) as oz·in.

    >>> ounce_inches(720.0778862e-6)
    '1.000'
    """
    return scaled(abs(unbalance) / OUNCE_INCH, decimals)


def _kilograms(mass: float) -> str:
    return plain(mass, decimals_of(mass, 4))


def _rotor_facts(data: ReportData) -> Iterator[tuple[str, str]]:
    """Yield what is said about the rotor: (label, text)."""
    head, tilt = data.head, data.tilt
    yield "Part", data.part
    yield "Serial", head.serial or ""
    yield "Revision", head.revision or ""
    if head.customer:
        yield "Customer", head.customer
    if head.remark:
        yield "Remark", head.remark
    yield "Mass", f"{_kilograms(data.initial.mass)} kg"
    yield "Centre of mass", f"z = {plain(data.initial.z, data.decimals + 1)} mm"
    if tilt.certain:
        leans = round(math.degrees(tilt.direction), 1) % 360.0
        yield "Principal axis", f"{fixed(math.degrees(tilt.angle), 3)}° from the shaft, toward {fixed(leans, 1)}°"
    yield "Unbalance", f"{data.initial.kind} before, {data.residual.kind} after"


def _service_facts(data: ReportData) -> Iterator[tuple[str, str]]:
    """Yield what is said about axis, speed and limits: (label, text)."""
    shaft, service, radius = data.axis.shaft, data.service, data.radial_uncertainty
    yield "Axis", data.axis.obtained
    for bearing, point in zip(data.bearings, (shaft.bearing_a, shaft.bearing_b), strict=True):
        yield f"Bearing {bearing.name}", f"({_listed(MM * point)}) mm; z = {plain(bearing.z, data.decimals + 1)} mm"
    if data.origin == "modelled":
        yield "Known to", f"{plain(radius, 4)} mm about each bearing centre" if radius else "taken as exact"
    yield "Key convention", "; ".join(_keys(data)) or "no keys"
    yield "Speed", f"{plain(service.rpm, 2)} r/min"
    if service.run_up is not None:
        a, b = map(significant, data.residual.forces_running_up)
        yield "Running up", f"{plain(service.run_up, 2)} (r/min)/s; {a} N on A, {b} N on B after correction"
    yield "Critical speed", "not given; the rotor counts as rigid" if data.rigid is None else data.rigid.text


def _keys(data: ReportData) -> Iterator[str]:
    for shaft_key in data.keys:
        where = f"z {plain(MM * data.metres * shaft_key.z, 2)} mm, {plain(shaft_key.angle % 360.0, 1)}°"
        yield f"{shaft_key.convention} ({_KEYS[shaft_key.convention]}, ISO 21940-32) at {where}"


def _notes(data: ReportData) -> Iterator[str]:
    yield from data.notes
    if data.corrected:
        yield f"correction: {data.ending}"
    if data.verdict.share:
        inputs = "the measurement" if data.origin == "measured" else "axis, tessellation, densities"
        yield (
            f"the share of parts within tolerance is that of {data.scatter.draws} draws over {inputs} and the shop's "
            "tolerances"
        )
    for candidate in data.axis.candidates:
        a, b = (_listed(MM * point) for point in (candidate.bearing_a, candidate.bearing_b))
        yield (
            f"candidate for the axis, to be confirmed: A ({a}), B ({b}) mm, {candidate.where}, radii "
            f"{' and '.join(plain(MM * k, 3) for k in candidate.radii)} mm"
        )


def _file_name(body: BodyRow) -> str:
    """Return the name of a body, and that of its file where it is another."""
    file = "" if body.path is None else Path(body.path).name
    return body.name if Path(body.name).name == file or not file else f"{body.name} ({file})"


def _share(share: Share | None) -> str:
    if share is None:
        return "–"
    limits = f"{share.limits[0]:g}–{share.limits[1]:g}"
    if share.clamped:
        return f"{share.allocated:.3f} → {share.used:.3f}, clamped to {limits}"
    return f"{share.allocated:.3f}, {limits} allowed"


def _what(plane: PlaneRow, decimals: int) -> str:
    """Return how a plane is corrected."""
    return f"{_METHODS[plane.method or '']} at radius {plain(plane.radius or 0.0, decimals)} mm"


def _face(plane: PlaneRow) -> str:
    """Return the face that the tools of a plane enter."""
    if plane.method == "drill_axial":
        return "to A" if plane.face == "a" else "to B"
    return "outside" if plane.method in ("drill_radial", "mill", "mill_arc") else "–"


def _tool(work: OperationRow, digits: ShopDigits) -> str:
    if work.item is not None:
        return f"{work.pieces} × {work.item}"
    width = "" if work.width is None else f", {plain(work.width, max(2, digits.tool))} mm wide"
    passes = f", {work.passes} passes" if work.passes > 1 else ""
    return f"{KINDS[work.kind]}{_from_to(work, digits)}{width}{passes}"


def _from_to(work: OperationRow, digits: ShopDigits) -> str:
    """Return where an arc begins and ends on the machine, and how long it is on the rim."""
    if work.machine_ends is None:
        return ""
    start, stop = (direction(end, max(1, digits.ends)) for end in work.machine_ends)
    return f" from {start}° to {stop}°, {fixed(work.along_rim, 1)} mm along the rim"


def _step(work: OperationRow, data: ReportData) -> str:
    """Return what is done in one step, in words, but for its angle."""
    decimals, digits = data.decimals, data.digits
    deep = "" if work.depth is None else f", {fixed(work.depth, max(decimals, digits.depth))} mm deep"
    if work.point_alone is not None:
        deep = f", its point alone, {fixed(work.point_alone, decimals)} mm deep at the tip"
    if work.method == "remove":
        bit = "" if work.diameter is None else f" Ø{plain(work.diameter, max(decimals, digits.tool))}"
        passes = f" in {work.passes} passes" if work.passes > 1 else ""
        what = f"{KINDS[work.kind]}{_from_to(work, digits)}{bit and f',{bit}' if work.ends else bit}{deep}{passes}"
    else:
        what = _tool(work, digits)
    radius, mass = fixed(work.radius, max(decimals, digits.place)), data.grams(work.mass)
    return f"{what}, radius {radius} mm, {mass} g"


def _wraps(data: ReportData) -> Iterator[tuple[PlaneRow, list[Markup]]]:
    """Yield the planes that are worked on, each with its strip in true size, where it is worked on from outside."""
    for plane in data.planes:
        if steps := data.steps(plane):
            outside = plane.method != "drill_axial"
            yield plane, wrap(plane, steps, data.machine.of, data.digits) if outside else []


def _total(bounds: Mapping[Source, float]) -> float:
    return math.fsum(bounds.values())


def _listed(values: Float) -> str:
    return ", ".join(plain(value, 4) for value in values.tolist())


def _plots(data: ReportData) -> list[Markup | None]:
    """Return the plots row by row, three a row: those of a tolerance plane, and beside and below correction planes."""
    beside: list[Markup | None] = [_of_plane(data, number) for number in range(len(data.planes))]
    ends = [*beside[:2], None, None]
    return [*_of_bearing(data, 0), ends[0], *_of_bearing(data, 1), ends[1], *beside[2:]]


def _of_bearing(data: ReportData, number: int) -> tuple[Markup, Markup]:
    """Return a tolerance plane before and after, and what is left at the scale of the tolerance."""
    bearing = data.bearings[number]
    limit, uncertainty = in_gmm(bearing.permissible), in_gmm(_total(data.residual.bearing_bounds[number]))
    before = Arrow(data.initial.bearings[number] / GRAM_MILLIMETRE, "before")
    after = Arrow(data.residual.bearings[number] / GRAM_MILLIMETRE, "after", uncertainty)
    return (
        polar(f"{bearing.name}, before and after", [before, after], tolerance=limit),
        polar(f"{bearing.name}, what is left", [after], tolerance=limit, scatter=in_gmm(bearing.residual_95)),
    )


def _of_plane(data: ReportData, number: int) -> Markup:
    """Return a correction plane: what is there, what its operations add, and where on the rim they are."""
    plane = data.planes[number]
    operations = [work for work in data.operations if work.plane == plane.id]
    added = sum((_SIGN[work.method] * rectangular(in_gmm(work.unbalance), work.angle) for work in operations), 0j)
    arrows = [Arrow(data.initial.planes[number] / GRAM_MILLIMETRE, "before"), Arrow(added, "correction")]
    marks = [Mark(work.angle, work.method == "add") for work in operations]
    return polar(f"plane {plane.id}, correction", arrows, marks=marks)
