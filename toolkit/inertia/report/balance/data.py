"""`Balance` → `ReportData`: the figures of a balance in the shop's units, and what has to be said of them."""

from __future__ import annotations

import datetime
import math
from collections.abc import Iterator
from pathlib import Path

from inertia import __version__
from inertia.arrays import Float
from inertia.balancing.balance import Balance
from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody
from inertia.balancing.shop_units import GRAM_MILLIMETRE, GRAM_SQUARE_MILLIMETRE, in_gmm
from inertia.balancing.unbalance import Unbalance
from inertia.mesh.part import Source
from inertia.report.balance.sheet import (
    BearingRow,
    BodyRow,
    OperationRow,
    PlaneRow,
    ReportData,
    SensitivityRow,
    State,
)
from inertia.report.balance.words import KINDS
from inertia.report.numerals import fixed, plain, significant
from inertia.report.svg.silhouette import silhouette

_MM = 1e3
_METHODS = {
    "add": "masses added",
    "remove": "masses removed",
    "drill_radial": "radial holes",
    "drill_axial": "axial holes",
    "mill": "milled flats",
    "kit": "weights of a kit",
}
_KEYS = {"H": "half key", "F": "full key", "N": "no key"}
_LEAST_SHARE = 5e-4  # of the variance: below it an input does not matter


def report_data(balance: Balance, date: str | None = None) -> ReportData:
    """Return what the balancing report prints.

    Parameters
    ----------
    balance : what `inertia.balance` returned
    date : of the report; today without it
    """
    rotor, correction, said = balance.rotor, balance.correction, balance.rotor.fields.report
    operations = () if correction is None else correction.operations
    return ReportData(
        part=said.part or Path(rotor.name).stem,
        serial=said.serial,
        revision=said.revision,
        date=date or datetime.date.today().isoformat(),
        version=__version__,
        rotor_facts=tuple(_rotor_facts(balance)),
        service_facts=tuple(_service_facts(balance)),
        zero_mark=f"toward ({_listed(rotor.fields.axis.zero_mark)}) of the part's axes",
        rotation=balance.shaft.rotation,
        rpm=rotor.fields.service.rpm,
        bodies=tuple(map(_body, balance.bodies)),
        file=_file(rotor),
        standard=balance.tolerance.standard,
        rule=balance.tolerance.rule,
        total=None if balance.tolerance.total is None else in_gmm(balance.tolerance.total),
        bearings=(_bearing(balance, 0), _bearing(balance, 1)),
        planes=tuple(_planes(balance)),
        center=_MM * balance.initial.z,
        outline=_MM * silhouette([body.part for body in balance.bodies], balance.shaft),
        outcome=balance.verdict.outcome,
        why=balance.verdict.why,
        notes=tuple(_notes(balance)),
        states=_states(balance),
        operations=tuple(_operation(balance, work) for work in operations),
        no_operation="" if operations else _no_operation(balance),
        sensitivities=tuple(_sensitivities(balance)),
    )


def _rotor_facts(balance: Balance) -> Iterator[tuple[str, str]]:
    said, initial, tilt = balance.rotor.fields.report, balance.initial, balance.tilt
    yield "Part", said.part or Path(balance.rotor.name).stem
    yield "Serial", said.serial or ""
    yield "Revision", said.revision or ""
    if said.customer:
        yield "Customer", said.customer
    if said.remark:
        yield "Remark", said.remark
    yield "Mass", f"{plain(initial.mass, 4)} kg"
    yield "Centre of mass", f"z = {plain(_MM * initial.z, 3)} mm"
    if tilt.certain:
        leans = math.degrees(tilt.direction) % 360.0
        yield "Principal axis", f"{fixed(math.degrees(tilt.angle), 3)}° from the shaft, toward {fixed(leans, 1)}°"
    yield "Unbalance", f"{initial.kind} before, {balance.residual.kind} after"


def _service_facts(balance: Balance) -> Iterator[tuple[str, str]]:
    rotor, shaft = balance.rotor, balance.shaft
    yield "Axis", balance.axis.obtained
    for name, point in (("A", shaft.bearing_a), ("B", shaft.bearing_b)):
        yield f"Bearing {name}", f"({_listed(_MM * point)}) mm; z = {plain(_MM * shaft.z_of(point), 3)} mm"
    radius = rotor.radial_uncertainty
    yield "Known to", f"{plain(_MM * radius, 4)} mm about each bearing centre" if radius else "taken as exact"
    yield "Key convention", "; ".join(_keys(balance)) or "no keys"
    yield "Speed", f"{plain(rotor.fields.service.rpm, 2)} r/min"
    if rotor.fields.service.run_up is not None:
        a, b = (significant(abs(force)) for force in balance.forces_running_up(balance.residual))
        rate = plain(rotor.fields.service.run_up, 2)
        yield "Running up", f"{rate} (r/min)/s; {a} N on A, {b} N on B after correction"
    yield "Critical speed", "not given; the rotor counts as rigid" if balance.rigid is None else balance.rigid.text


def _keys(balance: Balance) -> Iterator[str]:
    metres = float(balance.rotor.unit.metres)
    for key in balance.rotor.fields.key:
        where = f"z {plain(_MM * metres * key.z, 2)} mm, {plain(key.angle % 360.0, 1)}°"
        yield f"{key.convention} ({_KEYS[key.convention]}, ISO 21940-32) at {where}"


def _body(body: RotorBody) -> BodyRow:
    source, found = body.part.source, body.analysis
    file = "" if source.path is None else Path(source.path).name
    name = body.name if Path(body.name).name == file or not file else f"{body.name} ({file})"
    return BodyRow(name, source.sha256, body.density, found.properties.mass, found.triangles)


def _file(rotor: Rotor) -> tuple[str, str] | None:
    """Return the rotor file's name and SHA-256; None where the rotor was not read from one."""
    if rotor.text is None or not Path(rotor.name).is_file():
        return None
    return Path(rotor.name).name, Source(rotor.name, "toml").sha256 or ""


def _bearing(balance: Balance, number: int) -> BearingRow:
    judged, tolerance = balance.verdict.planes[number], balance.tolerance
    share = ""
    if tolerance.shares is not None:
        found = tolerance.shares[number]
        limits = f"{found.limits[0]:g}–{found.limits[1]:g}"
        share = f"{found.allocated:.3f}, {limits} allowed"
        if found.clamped:
            share = f"{found.allocated:.3f} → {found.used:.3f}, clamped to {limits}"
    return BearingRow(
        name=judged.name,
        z=_MM * balance.tolerance_planes[number],
        permissible=in_gmm(judged.permissible),
        share=share,
        uncertainty=in_gmm(math.fsum(judged.bounds.values())),
        residual_95=in_gmm(float(balance.scatter.residual_95[number])),
        outcome=judged.outcome,
    )


def _planes(balance: Balance) -> Iterator[PlaneRow]:
    worked = {plane.id: plane for plane in balance.correction_planes}
    for plane in balance.planes:
        work = worked.get(plane.id)
        if work is None:
            yield PlaneRow(plane.id, _MM * plane.z, None, "nothing is done here")
            continue
        sectors = tuple((math.degrees(k.start) % 360.0, math.degrees(k.stop) % 360.0) for k in work.forbidden)
        what = f"{_METHODS[work.method]} at radius {plain(_MM * work.radius, 2)} mm"
        yield PlaneRow(plane.id, _MM * plane.z, _MM * work.radius, what, sectors)


def _states(balance: Balance) -> tuple[State, State, State]:
    """Return the rows of the table; couples are about one plane, so that the first two rows make up the third."""
    initial, residual = balance.initial, balance.residual
    first = _state(balance, "initial", initial, tuple(plane.initial for plane in balance.planes))
    last = _state(balance, "residual", residual, tuple(plane.residual for plane in balance.planes))
    a, b = (after - before for before, after in zip(first.bearings, last.bearings, strict=True))
    newtons = GRAM_MILLIMETRE * balance.rotor.speed**2  # of a g·mm
    change = State(
        "correction",
        planes=tuple(after - before for before, after in zip(first.planes, last.planes, strict=True)),
        bearings=(a, b),
        static=last.static - first.static,
        couple=last.couple - first.couple,
        eccentricity=None,
        grade=None,
        forces=(newtons * abs(a), newtons * abs(b)),
    )
    return first, change, last


def _state(balance: Balance, name: str, found: Unbalance, planes: tuple[complex, ...]) -> State:
    a, b = found.in_planes(*balance.tolerance_planes)
    force_a, force_b = balance.forces(found)
    return State(
        name,
        planes=tuple(vector / GRAM_MILLIMETRE for vector in planes),
        bearings=(a / GRAM_MILLIMETRE, b / GRAM_MILLIMETRE),
        static=found.static / GRAM_MILLIMETRE,
        couple=found.couple_about(balance.initial.z) / GRAM_SQUARE_MILLIMETRE,
        eccentricity=1e6 * found.eccentricity,
        grade=balance.achieved_grade(found),
        forces=(abs(force_a), abs(force_b)),
    )


def _operation(balance: Balance, work: Operation) -> OperationRow:
    plane = next(k for k in balance.correction_planes if k.id == work.plane)
    rates = {line.name: in_gmm(float(line.per_step.max())) for line in balance.scatter.sensitivities}
    depth = rates.get(f"{work.id}: depth")
    return OperationRow(
        id=work.id,
        plane=work.plane,
        z=_MM * work.z,
        face=_face(plane),
        method="ADD" if work.method == "add" else "REMOVE",
        tool=_tool(work),
        angle=math.degrees(work.angle),
        radius=_MM * work.radius,
        diameter=_millimetres(work.tool_diameter),
        point=None if work.point_angle is None else math.degrees(work.point_angle),
        depth=_millimetres(work.depth),
        depth_tolerance=None if work.depth is None else _MM * balance.rotor.shop.depth,
        mass=1e3 * work.mass,
        unbalance=in_gmm(work.unbalance),
        wall=_millimetres(work.remaining_wall),
        per_tenth=rates.get(f"{work.id}: radius") if depth is None else depth,
        per_degree=rates.get(f"{work.id}: angle"),
    )


def _face(plane: CorrectionPlane) -> str:
    if plane.method == "drill_axial":
        return "to A" if plane.face == "a" else "to B"
    return "outside" if plane.cuts else "–"


def _tool(work: Operation) -> str:
    if work.item is not None:
        return f"{work.pieces} × {work.item}"
    width = "" if work.width is None else f", {plain(_MM * work.width, 2)} mm wide"
    return f"{KINDS[work.kind]}{width}"


def _no_operation(balance: Balance) -> str:
    if balance.correction is None:
        return "no plane has a method of correction"
    return balance.correction.why


def _notes(balance: Balance) -> Iterator[str]:
    yield from balance.notes
    if balance.correction is not None:
        yield f"correction: {balance.correction.why}"
    if balance.scatter.within is not None:
        share = plain(100.0 * balance.scatter.within, 2)
        yield (
            f"{share} % of {balance.scatter.draws} draws over axis, tessellation, densities and the shop's tolerances "
            "stay within what is permissible"
        )
    for found in balance.axis.candidates:
        a, b = (_listed(_MM * point) for point in (found.bearing_a, found.bearing_b))
        yield (
            f"candidate for the axis, to be confirmed: A ({a}), B ({b}) mm, {found.where}, radii "
            f"{' and '.join(plain(_MM * k, 3) for k in found.radii)} mm"
        )


def _sensitivities(balance: Balance) -> Iterator[SensitivityRow]:
    for line in balance.scatter.sensitivities:
        if line.share.max() > _LEAST_SHARE:
            a, b = (line.per_step / GRAM_MILLIMETRE).tolist()
            share_a, share_b = line.share.tolist()
            yield SensitivityRow(line.name, line.step_text, (a, b), (share_a, share_b))


def _millimetres(length: float | None) -> float | None:
    return None if length is None else _MM * length


def _listed(values: Float) -> str:
    return ", ".join(plain(value, 4) for value in values.tolist())
