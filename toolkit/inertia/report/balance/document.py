"""`Balance` → the document ``inertia/balance/1``.

Unbalances are {"gmm", "deg"}: g·mm, and degrees of the heavy spot as `inertia.balancing.unbalance` has them. Lengths
are in mm, forces in N, masses in kg, of operations in g.
"""

from __future__ import annotations

import math
from typing import Any

from inertia.balancing.axis.rotor_axis import Candidate
from inertia.balancing.balance import Balance
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.rotor_bodies import RotorBody
from inertia.balancing.shop_units import GRAM_MILLIMETRE, GRAM_SQUARE_MILLIMETRE, in_degrees, in_gmm
from inertia.balancing.unbalance import Unbalance
from inertia.documents import plain

Document = dict[str, Any]

_MM = 1e3


def balance_document(balance: Balance) -> Document:
    """Return the balance as ``inertia/balance/1``.

    What has no value is null: in a correction plane nothing is judged, and no bearing is there.
    """
    rotor, initial, residual = balance.rotor, balance.initial, balance.residual
    shaft, service, correction = balance.shaft, rotor.fields.service, balance.correction
    tolerance = balance.tolerance
    return {
        "schema": "inertia/balance/1",
        "rotor": rotor.name,
        "report": plain(rotor.fields.report),
        "bodies": [_body(body) for body in balance.bodies],
        "axis": {
            "obtained": balance.axis.obtained,
            "confirmed": balance.axis.confirmed,
            "bearing_a_mm": _mm(shaft.bearing_a.tolist()),
            "bearing_b_mm": _mm(shaft.bearing_b.tolist()),
            "zero_mark": shaft.zero_mark.tolist(),
            "rotation": shaft.rotation,
            "radial_uncertainty_mm": _MM * rotor.radial_uncertainty,
            "candidates": [_candidate(candidate) for candidate in balance.axis.candidates],
        },
        "angles": "counter-clockwise seen from bearing B looking toward A, 0 at the zero mark, of the heavy spot",
        "rpm": service.rpm,
        "critical_rpm": service.critical_rpm,
        "run_up_rpm_per_s": service.run_up,
        "rigid": None
        if balance.rigid is None
        else {"ratio": balance.rigid.ratio, "level": balance.rigid.level, "text": balance.rigid.text},
        "mass": initial.mass,
        "z_mm": _MM * initial.z,
        **_whole(balance, initial),
        "class": initial.kind,
        "principal_axis": {
            "tilt_deg": math.degrees(balance.tilt.angle),
            "direction_deg": math.degrees(balance.tilt.direction) % 360.0,
            "bound_deg": math.degrees(balance.tilt.bound),
        },
        "tolerance": {
            "standard": tolerance.standard,
            "rule": tolerance.rule,
            "total_gmm": None if tolerance.total is None else in_gmm(tolerance.total),
            "shares": None
            if tolerance.shares is None
            else [
                {"allocated": k.allocated, "used": k.used, "limits": list(k.limits), "clamped": k.clamped}
                for k in tolerance.shares
            ],
        },
        "tolerance_planes": _tolerance_planes(balance, initial),
        "correction_planes": [_plane(plane.id, plane.z, plane.initial, None, None) for plane in balance.planes],
        "initial_verdict": balance.initial_verdict.outcome,
        "verdict": balance.verdict.outcome,
        "why": list(balance.verdict.why),
        "corrections": [] if correction is None else [_operation(k) for k in correction.operations],
        "correction": None
        if correction is None
        else {
            "why": correction.why,
            "within": correction.within,
            "limits_hit": list(correction.limits_hit),
            "cuts": correction.iterations,
        },
        "residual": {
            "mass": residual.mass,
            "z_mm": _MM * residual.z,
            **_whole(balance, residual),
            "tolerance_planes": _tolerance_planes(balance, residual),
            "correction_planes": [_plane(plane.id, plane.z, plane.residual, None, None) for plane in balance.planes],
        },
        "scatter": _scatter(balance),
        "notes": list(balance.notes),
    }


def _mm(values: list[float]) -> list[float]:
    return [_MM * value for value in values]


def _vector(value: complex) -> Document:
    return {"gmm": in_gmm(value), "deg": in_degrees(value)}


def _body(body: RotorBody) -> Document:
    source, found = body.part.source, body.analysis
    return {
        "name": body.name,
        "path": source.path,
        "sha256": source.sha256,
        "unit": body.part.unit.name,
        "density": body.density,
        "density_from": found.density_from,
        "mass": found.properties.mass,
        "triangles": found.triangles,
        "chord_tolerance_mm": _MM * body.chord,
        "chord_from": body.chord_from,
    }


def _candidate(candidate: Candidate) -> Document:
    return {
        "where": candidate.where,
        "bearing_a_mm": _mm(candidate.bearing_a.tolist()),
        "bearing_b_mm": _mm(candidate.bearing_b.tolist()),
        "radii_mm": _mm(list(candidate.radii)),
        "coverage": candidate.coverage,
        "rms_mm": _MM * candidate.rms,
        "uncertainty_mm": _MM * candidate.uncertainty,
    }


def _whole(balance: Balance, unbalance: Unbalance) -> Document:
    couple = unbalance.couple
    return {
        "static_unbalance": _vector(unbalance.static),
        "couple_unbalance": {"gmm2": abs(couple) / GRAM_SQUARE_MILLIMETRE, "deg": in_degrees(couple)},
        "static_bound_gmm": in_gmm(unbalance.static_bound),
        "couple_bound_gmm2": unbalance.couple_bound / GRAM_SQUARE_MILLIMETRE,
        "specific_unbalance_um": 1e6 * unbalance.eccentricity,
        "achieved_grade_mm_s": balance.achieved_grade(unbalance),
        "axle_torque_Nm": abs(balance.torque(unbalance)),
    }


def _plane(name: str, z: float, unbalance: complex, permissible: float | None, force: float | None) -> Document:
    return {
        "id": name,
        "z_mm": _MM * z,
        "unbalance": _vector(unbalance),
        "permissible_gmm": None if permissible is None else in_gmm(permissible),
        "bearing_force_N": force,
    }


def _tolerance_planes(balance: Balance, unbalance: Unbalance) -> list[Document]:
    at = balance.tolerance_planes
    vectors, forces = unbalance.in_planes(*at), balance.forces(unbalance)
    starting, bounds = balance.forces_running_up(unbalance), unbalance.bounds_in_planes(at)
    return [
        _plane(name, at[k], vectors[k], balance.tolerance.permissible[k], abs(forces[k]))
        | {
            "running_up_force_N": abs(starting[k]),
            "uncertainty_gmm": {source: in_gmm(bound) for source, bound in bounds[k].items()},
        }
        for k, name in enumerate("AB")
    ]


def _operation(work: Operation) -> Document:
    lengths = ("tool_diameter", "depth", "width", "remaining_wall")
    return {
        "id": work.id,
        "plane": work.plane,
        "method": work.method,
        "kind": work.kind,
        "z_mm": _MM * work.z,
        "angle_deg": math.degrees(work.angle),
        "radius_mm": _MM * work.radius,
        "mass_g": 1e3 * work.mass,
        "unbalance": _vector(work.unbalance),
        **{f"{name}_mm": None if (value := getattr(work, name)) is None else _MM * value for name in lengths},
        "point_angle_deg": None if work.point_angle is None else math.degrees(work.point_angle),
        "pieces": work.pieces,
        "item": work.item,
    }


def _scatter(balance: Balance) -> Document:
    found = balance.scatter
    return {
        "draws": found.draws,
        "residual_95_gmm": (found.residual_95 / GRAM_MILLIMETRE).tolist(),
        "within": found.within,
        "sensitivities": [
            {
                "name": line.name,
                "step": line.step_text,
                "per_step_gmm": (line.per_step / GRAM_MILLIMETRE).tolist(),
                "share": line.share.tolist(),
            }
            for line in found.sensitivities
        ],
    }
