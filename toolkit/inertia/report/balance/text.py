"""`ReportData` → lines of text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from inertia.arrays import Float
from inertia.balancing.bounds import Source
from inertia.balancing.shop_units import GRAM_MILLIMETRE, GRAM_SQUARE_MILLIMETRE, in_degrees, in_gmm
from inertia.report.balance.data import KINDS, MM, TURNS, BodyRow, OperationRow, ReportData
from inertia.report.numerals import direction, fixed, number, row, scaled, significant, wrapped

_ID = 12
_LISTED = 6  # lines of the sensitivity table
_DENSITY_FROM = {"option": "as given", "material": "of the material", "mass": "from the mass", "assumed": "assumed"}


def balance_text(data: ReportData) -> str:
    """Return the balance as lines of text; angles are those of heavy spots, but those of operations where they are."""
    blocks = [
        _head(data),
        _axis(data),
        _unbalance(data),
        _together(data),
        _planes(data),
        _operations(data),
        _sensitivities(data),
        _candidates(data),
        _closing(data),
    ]
    return "\n\n".join("\n".join(lines) for block in blocks if (lines := list(block)))


def _head(data: ReportData) -> Iterator[str]:
    head = data.head
    named = ((head.part, ""), (head.serial, "serial "), (head.revision, "revision "), (head.customer, "for "))
    names = ", ".join(f"{word}{value}" for value, word in named if value is not None)
    yield row("Rotor", data.rotor + (f" ({names})" if names else ""))
    yield from wrapped("Verdict", data.verdict.headline)
    for k, body in enumerate(data.bodies):
        yield from wrapped("" if k else "Bodies", _body(body))
        if body.sha256 is not None:
            yield row("", f"SHA-256 {body.sha256}")
    if head.remark:
        yield from wrapped("Remark", head.remark)


def _body(body: BodyRow) -> str:
    chords = {
        "given": f"chord tolerance {_mm(body.chord)}",
        "read": f"triangles made from STEP to {_mm(body.chord)}",
        "shape": "integrated on its own faces",
        "estimated": f"facets within {body.chord:.3g} mm of the true surface",
        "mesh": f"facets within {body.chord:.3g} mm of the true surface",
        "exact": "taken as the true shape",
    }
    mass = _uncertain(body.mass, body.mass_uncertainty)
    density = f"{_uncertain(body.density, body.density_uncertainty)} kg/m³ {_DENSITY_FROM[body.density_from]}"
    file = "" if body.path is None or Path(body.path).name == body.name else f" ({Path(body.path).name})"
    return f"{body.name}{file}: {mass} kg, {density}, {body.triangles} triangles, {chords[body.chord_from]}"


def _uncertain(value: float, uncertainty: float) -> str:
    """Return a value with its standard uncertainty, as it was given."""
    return number(value) + (f" ± {number(uncertainty)}" if uncertainty else "")


def _axis(data: ReportData) -> Iterator[str]:
    shaft = data.axis.shaft
    yield row("Axis", data.axis.obtained)
    yield row("", f"A at {_point(shaft.bearing_a)}, B at {_point(shaft.bearing_b)}, {_mm(MM * shaft.span)} apart")
    yield row("Places", "z along the shaft from A to B, counted from the origin of the part's coordinates")
    yield row("Angles", f"0° towards {_listed(shaft.axes[:, 0])}, counter-clockwise seen from B looking toward A")
    yield row("Speed", f"{number(data.service.rpm)} r/min, {TURNS[shaft.rotation]} seen from B looking toward A")
    if data.rigid is not None:
        yield from wrapped("", data.rigid.text)


def _unbalance(data: ReportData) -> Iterator[str]:
    state = data.initial
    static, couple = (
        _cleared(state.static, state.static_bounds),
        _cleared(state.couple_about_center, state.couple_bounds),
    )
    yield row("Mass", f"{number(state.mass)} kg, its centre at z = {_mm(state.z)}")
    yield row("Unbalance", state.kind)
    size = _gmm(data, static)
    where = "" if size == "0" or size.startswith("<") else f"{_at(static)}, e = {significant(state.eccentricity)} µm"
    yield row("  static", f"{size} g·mm{where}")
    size = scaled(abs(couple) / GRAM_SQUARE_MILLIMETRE, data.gmm_decimals)
    torque = f", which takes {scaled(state.torque, data.force_decimals)} N·m to turn" if couple else ""
    yield row("  couple", f"{size} g·mm²{_at(couple)}{torque}")
    tilt = data.tilt
    if not tilt.certain:
        leans = "no one axis is nearest the shaft, as moments of inertia are equal"
    elif tilt.angle <= tilt.bound:
        leans = "along the shaft"
    else:
        leans = f"{math.degrees(tilt.angle):.4g}° from the shaft"
    yield row("  principal axis", leans)
    tolerance = data.tolerance
    total = "" if tolerance.total is None else f" = {_gmm(data, tolerance.total)} g·mm"
    yield from wrapped("Permissible", f"{tolerance.standard}: {tolerance.rule}{total}")
    if tolerance.meant_for:
        yield from wrapped("", f"meant for {'; '.join(tolerance.meant_for)}")
    for name, share in zip("AB", tolerance.shares or (), strict=False):
        clamp = f", kept at {share.used:g} of {share.limits[0]:g} to {share.limits[1]:g}" if share.clamped else ""
        yield row("", f"share of plane {name} {share.allocated:.4g}{clamp}")


def _cleared(value: complex, bounds: Mapping[Source, float]) -> complex:
    """Return 0 for what the arithmetic cannot tell from zero."""
    return 0j if abs(value) <= bounds.get("arithmetic", 0.0) else value


def _together(data: ReportData) -> Iterator[str]:
    """Yield how the parts are put together, and what that does before any correction."""
    indexing = data.indexing
    if indexing is None:
        return
    width = max([_ID, *(len(name) + 2 for name in (*indexing.names, *dict(indexing.moves)))])
    yield "Put together"
    for name, degrees in zip(indexing.names, indexing.degrees, strict=True):
        yield f"  {name:<{width}}turned by {degrees}°"
    for part, other in indexing.moves:
        yield f"  {part:<{width}}" + ("stays in its place" if other == part else f"in the place of {other}")
    planes = zip(data.bearings, indexing.planes_as_filed, indexing.planes_left, strict=True)
    for bearing, before, after in planes:
        yield f"  {bearing.name:<{width}}{_gmm(data, before)} g·mm as filed, {_gmm(data, after)} g·mm so"
    yield from wrapped("", indexing.sentence)


def _planes(data: ReportData) -> Iterator[str]:
    """Yield the table: tolerance planes with limits and forces, then correction planes."""
    states = {data.origin: data.initial}
    if data.corrected:
        states["corrected"] = data.residual
    head = f"{'Plane':<{_ID}}{'z, mm':>9}{'limit, g·mm':>13}"
    head += "".join(f"{f'{state}, g·mm':>18}{'at':>8}{'force, N':>10}" for state in states)
    yield f"{head}{'95 % below':>12}"
    for k, bearing in enumerate(data.bearings):
        line = f"{bearing.name:<{_ID}}{fixed(bearing.z, data.decimals):>9} {_gmm(data, bearing.permissible):>12}"
        for state in states.values():
            vector = _cleared(state.bearings[k], state.bearing_bounds[k])
            force = state.forces[k] if vector else 0.0
            line += _cell(data, vector if force else 0j, scaled(force, data.force_decimals))
        yield f"{line} {_gmm(data, bearing.residual_95):>11}"
    for k, plane in enumerate(data.planes):
        cells = (_cell(data, state.planes[k], "") for state in states.values())
        yield f"{plane.id:<{_ID}}{fixed(plane.z, data.decimals):>9}{'':>13}{''.join(cells)}".rstrip()
    if data.service.run_up is not None:
        a, b = (scaled(k, data.force_decimals) for k in data.initial.forces_running_up)
        yield f"While it still runs up, as {data.origin}: A {a} N, B {b} N"


def _cell(data: ReportData, vector: complex, force: str) -> str:
    return f" {_gmm(data, vector):>17}{_degrees(vector) if vector else '':>8} {force:>9}"


def _operations(data: ReportData) -> Iterator[str]:
    if not data.corrected:
        return
    width = max([_ID, *(len(work.id) + 2 for work in data.operations)])
    if data.operations:
        names = f"{'z':>9}{'angle':>9}{'radius':>9}{'tool':>8}{'depth':>8}{'mass, g':>10}{'wall':>9}"
        yield f"{'Work, in mm':<{width + 21}}{names}"
    for work in data.operations:
        yield _operation(work, width, data)
    yield from wrapped("Correction", data.ending)
    if data.plan:
        yield from wrapped("Plan", data.plan)


def _operation(work: OperationRow, width: int, data: ReportData) -> str:
    decimals, digits = data.decimals, data.digits
    place, deep = max(decimals, digits.place), max(decimals, digits.depth)
    what = f"{work.method} {KINDS[work.kind]}" if work.item is None else f"add {work.pieces} × {work.item}"
    if work.ends is not None:
        what += f" of {fixed(work.span, max(1, digits.ends))}°"
    tool = "" if work.diameter is None else f"Ø{number(round(work.diameter, 6))}"
    depth = "" if work.depth is None else fixed(work.depth, deep)
    if work.point_alone is not None:
        depth = "point"
    wall = "" if work.wall is None else fixed(work.wall, decimals)
    return (
        f"{work.id:<{width}}{what:<21} {fixed(work.z, place):>8} {f'{direction(work.angle, max(2, digits.angle))}°':>8}"
        f" {fixed(work.radius, place):>8} {tool:>7} {depth:>7} {data.grams(work.mass):>9} {wall:>8}"
    ).rstrip()


def _sensitivities(data: ReportData) -> Iterator[str]:
    lines = [line for line in data.scatter.sensitivities if line.at_spread.any()][:_LISTED]
    if not (data.corrected or data.assembled) or not lines:
        return
    yield f"{'Hold tightest':<30}{'a step of':>12}{'moves A, g·mm':>16}{'B, g·mm':>12}{'share of A':>12}{'of B':>8}"
    for line in lines:
        a, b = (scaled(k, data.gmm_decimals) for k in (line.per_step / GRAM_MILLIMETRE).tolist())
        share_a, share_b = line.share.tolist()
        yield (f"{line.name:<30}{line.step_text:>12} {a:>15} {b:>11}{share_a:>12.0%}{share_b:>8.0%}")


def _candidates(data: ReportData) -> Iterator[str]:
    """Yield the candidates for the axis, as lines that can be copied into the rotor file."""
    for k, candidate in enumerate(data.axis.candidates):
        radii = " and ".join(_mm(MM * radius) for radius in candidate.radii)
        turn = f"{candidate.coverage:.0%} of the turn"
        yield row("" if k else "Candidates", f"# {candidate.where}, radius {radii}, {turn}")
        for name in ("bearing_a", "bearing_b"):
            point = [round(x / data.metres, 6) + 0.0 for x in getattr(candidate, name).tolist()]
            yield row("", f"{name} = {point}")


def _closing(data: ReportData) -> Iterator[str]:
    grades = [f"{significant(data.initial.grade)} as {data.origin}"]
    if data.corrected:
        grades.append(f"{significant(data.residual.grade)} as corrected")
    yield row("Achieved", f"balance quality grade G {', '.join(grades)} (mm/s)")
    yield from wrapped("Verdict", data.verdict.headline)
    for sentence in data.verdict.why:
        yield from wrapped("", sentence)
    if data.operations:
        yield row("", f"as {data.origin}, before any correction: {data.initial.outcome.upper()}")
    for k, note in enumerate(data.notes):
        yield from wrapped("" if k else "Notes", note)


def _gmm(data: ReportData, unbalance: complex) -> str:
    return scaled(in_gmm(unbalance), data.gmm_decimals)


def _degrees(vector: complex) -> str:
    return f"{direction(in_degrees(vector))}°"


def _at(vector: complex) -> str:
    return f" at {_degrees(vector)}" if vector else ""


def _mm(length: float) -> str:
    return f"{length:.6g} mm"


def _point(point: Float) -> str:
    return f"({_listed(MM * point)}) mm"


def _listed(values: Float) -> str:
    return ", ".join(f"{round(value, 6) + 0.0:.8g}" for value in values.tolist())


def grades_text(document: Mapping[str, Any]) -> str:
    """Return the grades, fan categories and standards of `inertia.balancing.standards` as lines of text."""
    at = "" if document["rpm"] is None else f" (e_per at {document['rpm']:g} r/min)"
    lines = [f"Balance quality grades G, mm/s, ISO 21940-11 table 1{at}; other grades may be agreed by contract"]
    for entry in document["grades"]:
        size = entry["specific_unbalance_um"]
        label = f"G{entry['grade_mm_s']:g}" + ("" if size is None else f"  {significant(size)} µm")
        lines += wrapped(label, "; ".join(entry["machines"]))
    lines += ["", "Fan application categories, ISO 14694"]
    for entry in document["categories"]:
        lines += wrapped(f"{entry['category']}  G{entry['grade_mm_s']:g}", "; ".join(entry["machines"]))
    lines += ["", "Standards of [tolerance]"]
    for entry in document["standards"]:
        lines += wrapped(entry["standard"], entry["rule"])
    return "\n".join(lines)
