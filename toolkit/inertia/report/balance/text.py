"""`Balance` → lines of text."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from pathlib import Path

from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.rotor_bodies import RotorBody
from inertia.balancing.shop_units import GRAM_MILLIMETRE, GRAM_SQUARE_MILLIMETRE, in_degrees
from inertia.balancing.unbalance import Unbalance
from inertia.report.balance.words import KINDS, TURNS
from inertia.report.layout import LABEL, number, row
from inertia.report.numerals import fixed, significant

_WIDTH = 120
_ID = 12
_LISTED = 6  # lines of the sensitivity table
_DENSITY_FROM = {"option": "as given", "material": "of the material", "mass": "from the mass", "assumed": "assumed"}


def balance_text(balance: Balance) -> str:
    """Return the balance as lines of text; angles are those of heavy spots, but those of operations where they are."""
    blocks = [
        _head(balance),
        _axis(balance),
        _unbalance(balance),
        _planes(balance),
        _work(balance),
        _sensitivities(balance),
        _candidates(balance),
        _closing(balance),
    ]
    return "\n\n".join("\n".join(lines) for block in blocks if (lines := list(block)))


def _head(balance: Balance) -> Iterator[str]:
    said = balance.rotor.fields.report
    named = ((said.part, ""), (said.serial, "serial "), (said.revision, "revision "), (said.customer, "for "))
    told = ", ".join(f"{word}{value}" for value, word in named if value is not None)
    yield row("Rotor", balance.rotor.name + (f" ({told})" if told else ""))
    for k, body in enumerate(balance.bodies):
        yield from _wrapped("" if k else "Bodies", _body(body))
        yield row("", f"SHA-256 {body.part.source.sha256}")
    if said.remark:
        yield from _wrapped("Remark", said.remark)


def _body(body: RotorBody) -> str:
    chords = {
        "given": f"chord tolerance {_mm(body.chord)}",
        "estimated": f"sag estimated at {_mm(body.chord)}",
        "exact": "taken as the true shape",
    }
    density = f"{number(body.density)} kg/m³ {_DENSITY_FROM[body.analysis.density_from]}"
    path = body.part.source.path
    file = "" if path is None or Path(path).name == body.name else f" ({Path(path).name})"
    return (
        f"{body.name}{file}: {number(body.analysis.properties.mass)} kg, {density}, {body.analysis.triangles} "
        f"triangles, {chords[body.chord_from]}"
    )


def _axis(balance: Balance) -> Iterator[str]:
    shaft, rotor = balance.shaft, balance.rotor
    yield row("Axis", balance.axis.obtained)
    yield row("", f"A at {_point(shaft.bearing_a)}, B at {_point(shaft.bearing_b)}, {_mm(shaft.span)} apart")
    yield row("Angles", f"0° towards {_listed(shaft.axes[:, 0])}, counter-clockwise seen from B looking toward A")
    service = rotor.fields.service
    yield row("Speed", f"{number(service.rpm)} r/min, {TURNS[shaft.rotation]} seen from B looking toward A")
    if balance.rigid is not None:
        yield from _wrapped("", balance.rigid.text)


def _unbalance(balance: Balance) -> Iterator[str]:
    found = balance.initial
    static, couple = (_cleared(found, k, p, q) for k, p, q in ((found.static, 1.0, 0.0), (found.couple, 0.0, 1.0)))
    yield row("Mass", f"{number(found.mass)} kg, its centre at z = {_mm(found.z)}")
    yield row("Unbalance", found.kind)
    size = _gmm(static)
    where = (
        "" if size == "0" or size.startswith("<") else f"{_at(static)}, e = {significant(1e6 * found.eccentricity)} µm"
    )
    yield row("  static", f"{size} g·mm{where}")
    size = significant(abs(couple) / GRAM_SQUARE_MILLIMETRE)
    torque = f", which takes {significant(abs(balance.torque(found)))} N·m to turn" if couple else ""
    yield row("  couple", f"{size} g·mm²{_at(couple)}{torque}")
    tilt = balance.tilt
    if not tilt.certain:
        leans = "no one axis is nearest the shaft, as moments of inertia are equal"
    elif tilt.angle <= tilt.bound:
        leans = "along the shaft"
    else:
        leans = f"{math.degrees(tilt.angle):.4g}° from the shaft"
    yield row("  principal axis", leans)
    tolerance = balance.tolerance
    total = "" if tolerance.total is None else f" = {_gmm(tolerance.total)} g·mm"
    yield from _wrapped("Permissible", f"{tolerance.standard}: {tolerance.rule}{total}")
    for name, share in zip("AB", tolerance.shares or (), strict=False):
        clamp = f", kept at {share.used:g} of {share.limits[0]:g} to {share.limits[1]:g}" if share.clamped else ""
        yield row("", f"share of plane {name} {share.allocated:.4g}{clamp}")


def _cleared(unbalance: Unbalance, value: complex, p: float, q: float) -> complex:
    """Return 0 for p U + q D where the arithmetic cannot tell it from zero."""
    return 0j if abs(value) <= unbalance.bounds_of(p, q).get("arithmetic", 0.0) else value


def _planes(balance: Balance) -> Iterator[str]:
    """Yield the table: tolerance planes with limits and forces, then correction planes."""
    states = ["modelled", "corrected"] if balance.correction is not None else ["modelled"]
    head = f"{'Plane':<{_ID}}{'z, mm':>9}{'limit, g·mm':>13}"
    head += "".join(f"{f'{state}, g·mm':>18}{'at':>8}{'force, N':>10}" for state in states)
    yield f"{head}{'95 % below':>12}"
    found = [balance.initial, balance.residual][: len(states)]
    at, draws = balance.tolerance_planes, (balance.scatter.residual_95 / GRAM_MILLIMETRE).tolist()
    rows = [(name, z, _gmm(limit)) for name, z, limit in zip("AB", at, balance.tolerance.permissible, strict=True)]
    for k, (name, z, limit) in enumerate(rows):
        line = f"{name:<{_ID}}{fixed(1e3 * z, 2):>9}{limit:>13}"
        for unbalance in found:
            bound = unbalance.bounds_in_planes(at)[k].get("arithmetic", 0.0)
            vector = unbalance.in_planes(*at)[k]
            force = balance.forces(unbalance)[k] if abs(vector) > bound else 0j
            line += _cell(vector if force else 0j, significant(abs(force)))
        yield f"{line}{significant(draws[k]):>12}"
    for plane in balance.planes:
        cells = (_cell(vector, "") for vector in (plane.initial, plane.residual)[: len(states)])
        yield f"{plane.id:<{_ID}}{fixed(1e3 * plane.z, 2):>9}{'':>13}{''.join(cells)}".rstrip()
    if balance.rotor.fields.service.run_up is not None:
        a, b = (significant(abs(k)) for k in balance.forces_running_up(balance.initial))
        yield f"While it still runs up, as modelled: A {a} N, B {b} N"


def _cell(vector: complex, force: str) -> str:
    return f"{_gmm(vector):>18}{_degrees(vector) if vector else '':>8}{force:>10}"


def _work(balance: Balance) -> Iterator[str]:
    correction = balance.correction
    if correction is None:
        return
    width = max([_ID, *(len(work.id) + 2 for work in correction.operations)])
    if correction.operations:
        names = f"{'z':>9}{'angle':>9}{'radius':>9}{'tool':>8}{'depth':>8}{'mass, g':>10}{'wall':>9}"
        yield f"{'Work, in mm':<{width + 21}}{names}"
    for work in correction.operations:
        yield _operation(work, width)
    yield from _wrapped("Correction", correction.why)


def _operation(work: Operation, width: int) -> str:
    what = f"{work.method} {KINDS[work.kind]}" if work.item is None else f"add {work.pieces} × {work.item}"
    tool = "" if work.tool_diameter is None else f"Ø{number(round(1e3 * work.tool_diameter, 6))}"
    depth = "" if work.depth is None else fixed(1e3 * work.depth, 2)
    wall = "" if work.remaining_wall is None else fixed(1e3 * work.remaining_wall, 2)
    return (
        f"{work.id:<{width}}{what:<21}{fixed(1e3 * work.z, 2):>9}{f'{math.degrees(work.angle):.2f}°':>9}"
        f"{fixed(1e3 * work.radius, 2):>9}{tool:>8}{depth:>8}{fixed(1e3 * work.mass, 3):>10}{wall:>9}"
    ).rstrip()


def _sensitivities(balance: Balance) -> Iterator[str]:
    lines = [line for line in balance.scatter.sensitivities if line.at_spread.any()][:_LISTED]
    if balance.correction is None or not lines:
        return
    yield f"{'Hold tightest':<30}{'a step of':>12}{'moves A, g·mm':>16}{'B, g·mm':>12}{'share of A':>12}{'of B':>8}"
    for line in lines:
        a, b = (line.per_step / GRAM_MILLIMETRE).tolist()
        share_a, share_b = line.share.tolist()
        yield (
            f"{line.name:<30}{line.step_text:>12}{significant(a):>16}{significant(b):>12}{share_a:>12.0%}{share_b:>8.0%}"
        )


def _candidates(balance: Balance) -> Iterator[str]:
    """Yield the candidates for the axis, as lines that can be copied into the rotor file."""
    metres = float(balance.rotor.unit.metres)
    for k, found in enumerate(balance.axis.candidates):
        radii = " and ".join(_mm(radius) for radius in found.radii)
        yield row("" if k else "Candidates", f"# {found.where}, radius {radii}, {found.coverage:.0%} of the turn")
        for name in ("bearing_a", "bearing_b"):
            point = [round(x / metres, 6) + 0.0 for x in getattr(found, name).tolist()]
            yield row("", f"{name} = {point}")


def _closing(balance: Balance) -> Iterator[str]:
    grades = [f"{significant(balance.achieved_grade(balance.initial))} as modelled"]
    if balance.correction is not None:
        grades.append(f"{significant(balance.achieved_grade(balance.residual))} as corrected")
    yield row("Achieved", f"balance quality grade G {', '.join(grades)} (mm/s)")
    yield row("Verdict", balance.verdict.outcome.upper())
    for sentence in balance.verdict.why:
        yield from _wrapped("", sentence)
    if balance.correction is not None and balance.correction.operations:
        yield row("", f"as modelled, before any correction: {balance.initial_verdict.outcome.upper()}")
    for k, note in enumerate(balance.notes):
        yield from _wrapped("" if k else "Notes", note)


def _gmm(unbalance: complex) -> str:
    return significant(abs(unbalance) / GRAM_MILLIMETRE)


def _degrees(vector: complex) -> str:
    return f"{fixed(in_degrees(vector), 1)}°"


def _at(vector: complex) -> str:
    return f" at {_degrees(vector)}" if vector else ""


def _mm(length: float) -> str:
    return f"{1e3 * length:.6g} mm"


def _point(point: Float) -> str:
    return f"({_listed(1e3 * point)}) mm"


def _listed(values: Float) -> str:
    return ", ".join(f"{round(value, 6) + 0.0:.8g}" for value in values.tolist())


def _wrapped(label: str, sentence: str) -> Iterator[str]:
    for k, line in enumerate(textwrap.wrap(sentence, _WIDTH - LABEL, break_long_words=False)):
        yield row("" if k else label, line)
