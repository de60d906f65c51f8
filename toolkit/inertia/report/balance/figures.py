"""`report_data`: the figures that are reported of a `Balance`, each computed once."""

from __future__ import annotations

import datetime
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from inertia import __version__
from inertia.balancing.balance import Balance
from inertia.balancing.correction_loop import Correction
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.machine_angles import MachineAngles
from inertia.balancing.monte_carlo_terms import operation_terms
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody
from inertia.balancing.shop_digits import shop_digits
from inertia.balancing.unbalance import Unbalance
from inertia.errors import ReadError
from inertia.mesh.version import CHANGED
from inertia.report.balance.data import (
    MM,
    BearingRow,
    BodyRow,
    OperationRow,
    PlaneRow,
    ReportData,
    State,
    Vectors,
)
from inertia.report.numerals import converted

_ROUNDED = 1e-9  # of the limit: what plan and bound differ by where they are one


def report_data(balance: Balance, date: str | None = None, machine: MachineAngles | None = None) -> ReportData:
    """Return what is reported of a balance.

    Parameters
    ----------
    balance : what `inertia.balance` returned
    date : of the report; today without it
    machine : how the machine that measured the unbalance counts angles; as the rotor file says without it
    """
    rotor, correction = balance.rotor, balance.correction
    machine = machine or MachineAngles(rotor.fields.report.machine_angles)
    initial = _state(balance, "initial", balance.initial)
    residual = _state(balance, "residual", balance.residual)
    return ReportData(
        rotor=rotor.name,
        head=rotor.fields.report,
        date=date or datetime.date.today().isoformat(),
        version=__version__,
        file=_digest(rotor.text, rotor.name),
        bodies=tuple(map(_body, balance.bodies)),
        parts=tuple(body.part for body in balance.bodies),
        axis=balance.axis,
        zero_mark=rotor.fields.axis.zero_mark,
        radial_uncertainty=converted(MM * rotor.radial_uncertainty),
        keys=rotor.fields.key,
        metres=float(rotor.unit.metres),
        service=rotor.fields.service,
        rigid=balance.rigid,
        tilt=balance.tilt,
        tolerance=balance.tolerance,
        bearings=(_bearing(balance, 0), _bearing(balance, 1)),
        planes=_planes(balance),
        initial=initial,
        correction=_change(initial, residual, balance.rotor.speed),
        residual=residual,
        operations=_operations(balance, machine),
        corrected=correction is not None,
        cuts=0 if correction is None else correction.iterations,
        within=correction is not None and correction.within,
        limits_hit=() if correction is None else correction.limits_hit,
        ending="" if correction is None else correction.why,
        plan=_plan(correction),
        worst=0.0 if correction is None else correction.worst,
        bound=0.0 if correction is None else correction.bound,
        fewest=0 if correction is None else correction.fewest,
        cut_short=correction is not None and correction.cut_short,
        scatter=balance.scatter,
        verdict=balance.verdict,
        notes=balance.notes,
        indexing=balance.indexing,
        assembled=rotor.assembly is not None,
        assembly_file=_assembly_file(rotor),
        machine=machine,
        digits=shop_digits(balance, machine),
    )


def _plan(correction: Correction | None) -> str:
    """Say how near to the best a plan is."""
    if correction is None or not correction.operations:
        return ""
    number = sum(work.pieces for work in correction.operations)
    plan = f"{number} {'places' if number > 1 else 'place'}"
    if correction.fewest:
        plan += ", the fewest there can be" if correction.fewest >= number else f", {correction.fewest} at least"
    plan += f"; {100 * correction.worst:.3g} % of the limit aimed at is left, and the bound for so many places is "
    gap = correction.worst - correction.bound
    plan += f"{100 * correction.bound:.3g} %: a gap of {100 * gap if gap > _ROUNDED else 0:.3g} %"
    return plan + ("; the time was up before all was tried" if correction.cut_short else "")


def _assembly_file(rotor: Rotor) -> tuple[str, str] | None:
    """Return the same of the file of the assembly that it names; None where that is the rotor's own."""
    tree = rotor.assembly
    if tree is None or tree.path == rotor.name:
        return None
    return _digest(tree.text, tree.path)


def _digest(text: str | None, name: str) -> tuple[str, str] | None:
    """Return a file's name and SHA-256; None where what it says was not read from one."""
    if text is None or not Path(name).is_file():
        return None
    import hashlib

    data = Path(name).read_bytes()
    if data.decode("utf-8-sig", "replace") != text:
        raise ReadError(f"cannot read {name}: {CHANGED}", code="changed")
    return Path(name).name, hashlib.sha256(data).hexdigest()


def _body(body: RotorBody) -> BodyRow:
    source, analysis = body.part.source, body.analysis
    return BodyRow(
        name=body.name,
        path=source.path,
        sha256=source.sha256,
        unit=body.part.unit.name,
        density=body.density,
        density_from=analysis.density_from,
        density_uncertainty=body.density * body.relative("density"),
        mass=analysis.properties.mass,
        mass_uncertainty=analysis.properties.mass * body.relative("mass"),
        triangles=analysis.triangles,
        chord=converted(MM * body.chord),
        chord_from=body.chord_from,
    )


def _bearing(balance: Balance, number: int) -> BearingRow:
    plane, shares = balance.verdict.planes[number], balance.tolerance.shares
    return BearingRow(
        name=plane.name,
        z=converted(MM * balance.tolerance_planes[number]),
        permissible=plane.permissible,
        share=None if shares is None else shares[number],
        residual_95=float(balance.scatter.residual_95[number]),
        outcome=plane.outcome,
    )


def _planes(balance: Balance) -> tuple[PlaneRow, ...]:
    rows = {plane.id: PlaneRow(plane.id, converted(MM * plane.z)) for plane in balance.planes}
    for plane in balance.correction_planes:
        sectors = tuple((_turned(k.start), _turned(k.stop)) for k in plane.forbidden)
        radius, entry = converted(MM * plane.radius), converted(MM * plane.entry)
        rows[plane.id] = PlaneRow(plane.id, rows[plane.id].z, plane.method, radius, plane.face, sectors, entry)
    return tuple(rows.values())


def _state(balance: Balance, name: str, unbalance: Unbalance) -> State:
    residual = name == "residual"
    verdict = balance.verdict if residual else balance.initial_verdict
    a, b = verdict.planes
    force_a, force_b = balance.forces(unbalance)
    starting_a, starting_b = balance.forces_running_up(unbalance)
    return State(
        name=name,
        planes=tuple(plane.residual if residual else plane.initial for plane in balance.planes),
        bearings=(a.residual, b.residual),
        static=unbalance.static,
        couple=unbalance.couple_about(balance.initial.z),
        forces=(abs(force_a), abs(force_b)),
        mass=unbalance.mass,
        z=MM * unbalance.z,
        kind=unbalance.kind,
        couple_about_center=unbalance.couple,
        static_bounds=unbalance.bounds_of(1.0, 0.0),
        couple_bounds=unbalance.bounds_of(0.0, 1.0),
        bearing_bounds=(a.bounds, b.bounds),
        eccentricity=1e6 * unbalance.eccentricity,
        grade=balance.achieved_grade(unbalance),
        torque=abs(balance.torque(unbalance)),
        forces_running_up=(abs(starting_a), abs(starting_b)),
        outcome=verdict.outcome,
    )


def _change(first: Vectors, last: Vectors, speed: float) -> Vectors:
    """Return what takes one to the other."""
    a, b = (after - before for before, after in zip(first.bearings, last.bearings, strict=True))
    return Vectors(
        "correction",
        planes=tuple(after - before for before, after in zip(first.planes, last.planes, strict=True)),
        bearings=(a, b),
        static=last.static - first.static,
        couple=last.couple - first.couple,
        forces=(speed**2 * abs(a), speed**2 * abs(b)),
    )


def _operations(balance: Balance, machine: MachineAngles) -> tuple[OperationRow, ...]:
    if balance.correction is None:
        return ()
    works, shop = balance.correction.operations, balance.rotor.shop.separately
    terms = operation_terms(works, balance.residual, balance.tolerance_planes, shop)
    rates = {term.name: float(np.abs(term.sensitivities).max()) * term.step for term in terms}
    return tuple(_operation(balance, work, rates, machine) for work in works)


def _operation(balance: Balance, work: Operation, rates: Mapping[str, float], machine: MachineAngles) -> OperationRow:
    angle = converted(math.degrees(work.angle))
    ends = None if work.half_angle is None else _ends(angle, math.degrees(work.half_angle))
    depth = rates.get(f"{work.id}: depth")
    return OperationRow(
        id=work.id,
        plane=work.plane,
        method=work.method,
        kind=work.kind,
        z=converted(MM * work.z),
        angle=angle,
        machine_angle=machine.of(angle),
        radius=converted(MM * work.radius),
        mass=converted(1e3 * work.mass),
        unbalance=work.unbalance,
        diameter=_mm(work.tool_diameter),
        point=None if work.point_angle is None else converted(math.degrees(work.point_angle)),
        depth=_mm(work.depth),
        depth_tolerance=None if work.depth is None else converted(MM * balance.rotor.shop.depth.total),
        width=_mm(work.width),
        arc=None if work.arc is None else converted(math.degrees(work.arc)),
        ends=ends,
        machine_ends=None if ends is None else machine.ends_of(ends),
        passes=work.passes,
        wall=_mm(work.remaining_wall),
        pieces=work.pieces,
        item=work.item,
        per_tenth=rates.get(f"{work.id}: radius") if depth is None else depth,
        per_degree=rates.get(f"{work.id}: angle"),
    )


def _ends(angle: float, half: float) -> tuple[float, float]:
    return converted(angle - half) % 360.0, converted(angle + half) % 360.0


def _turned(angle: float) -> float:
    return converted(math.degrees(angle)) % 360.0


def _mm(length: float | None) -> float | None:
    return None if length is None else converted(MM * length)
